/* The skin of a packed specimen: its surface is cut into pieces, and every piece goes to the
 * particle whose surface is nearest (a Voronoi share), so that the areas add up to the surface. */
#include "sim/membrane.h"

#include "base/memory.h"
#include "pack/boundary.h"
#include "sim/internal.h"

#include <math.h>
#include <string.h>

/* Of a mean radius: shares are then of some fifty pieces. */
static const double piece_size = 0.25;

/* --- the nearest particle --- */

/* Particles by cells of a grid: those of cell k are item[first[k] .. first[k + 1]). */
typedef struct grid {
    double lower[3], cell, radius_max;
    int64_t n[3];
    int32_t *first, *item;
} grid;

static int64_t cell_along(const grid *g, double x, int a) {
    int64_t k = (int64_t)floor((x - g->lower[a]) / g->cell);
    return k < 0 ? 0 : k >= g->n[a] ? g->n[a] - 1 : k;
}

static int64_t cell_at(const grid *g, const double *x) {
    return (cell_along(g, x[2], 2) * g->n[1] + cell_along(g, x[1], 1)) * g->n[0] +
           cell_along(g, x[0], 0);
}

static void free_grid(grid *g) {
    gn_free(g->first);
    gn_free(g->item);
}

static gneiss_status make_grid(const gn_world *w, double cell, grid *g, gneiss_error *error) {
    const gn_particles *q = &w->dem.particles;
    *g = (grid){.cell = cell};
    size_t cells = 1;
    for (int a = 0; a < 3; a++) {
        g->lower[a] = w->lower[a];
        g->n[a] = 1 + (int64_t)((w->upper[a] - w->lower[a]) / cell);
        cells *= (size_t)g->n[a];
    }
    g->first = gn_alloc_array(cells + 2, sizeof *g->first);
    g->item = gn_alloc_array(q->soa.count + 1, sizeof *g->item);
    if (!g->first || !g->item) {
        free_grid(g);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the skin of the specimen");
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        g->first[cell_at(g, q->pos + 4 * p) + 2]++;
        g->radius_max = fmax(g->radius_max, q->pos[4 * p + 3]);
    }
    for (size_t k = 0; k < cells; k++) g->first[k + 2] += g->first[k + 1];
    for (size_t p = 0; p < q->soa.count; p++)
        g->item[g->first[cell_at(g, q->pos + 4 * p) + 1]++] = (int32_t)p;
    return GNEISS_OK;
}

/* The particle of a cell whose surface is nearest to x, if nearer than *least. */
static void look_in(const gn_particles *q, const grid *g, int64_t cell, const double x[3],
                    double *least, int32_t *found) {
    for (int32_t k = g->first[cell]; k < g->first[cell + 1]; k++) {
        const double *y = q->pos + 4 * (size_t)g->item[k];
        double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
        double distance = sqrt(gn_dot3(d, d)) - y[3];
        if (distance >= *least) continue;
        *least = distance;
        *found = g->item[k];
    }
}

/* Shells of cells, until no particle further out can be nearer. */
static int32_t nearest(const gn_particles *q, const grid *g, const double x[3]) {
    int64_t at[3], far = 0;
    double least = INFINITY;
    int32_t found = 0;
    for (int a = 0; a < 3; a++) {
        at[a] = cell_along(g, x[a], a);
        far = g->n[a] > far ? g->n[a] : far;
    }
    for (int64_t r = 0; r <= far; r++) {
        if ((double)(r - 1) * g->cell - g->radius_max > least) break;
        for (int64_t k = at[2] - r; k <= at[2] + r; k++)
            for (int64_t j = at[1] - r; j <= at[1] + r; j++)
                for (int64_t i = at[0] - r; i <= at[0] + r; i++) {
                    bool shell = i == at[0] - r || i == at[0] + r || j == at[1] - r ||
                                 j == at[1] + r || k == at[2] - r || k == at[2] + r;
                    bool inside =
                        i >= 0 && j >= 0 && k >= 0 && i < g->n[0] && j < g->n[1] && k < g->n[2];
                    if (shell && inside)
                        look_in(q, g, (k * g->n[1] + j) * g->n[0] + i, x, &least, &found);
                }
    }
    return found;
}

/* --- shares --- */

/* Sides face across the axis more than along it. */
static bool covered(const gn_world *w, const double area[3]) {
    const gn_membrane_def *m = &w->scene.membrane;
    if (m->faces == GN_FACES_ALL) return true;
    double along = area[gn_scene_membrane_axis(&w->scene)], size = gn_dot3(area, area);
    return along * along < 0.5 * size;
}

/* What the pieces exert together: moment of areas about 0. */
static void share_out(gn_world *w, const gn_boundary_pieces *pieces, const grid *g,
                      double moment[3]) {
    gn_particles *q = &w->dem.particles;
    double *arms = w->dem.membrane->arms, turn[3];
    for (size_t k = 0; k < pieces->count; k++) {
        const gn_piece_of_boundary *piece = &pieces->piece[k];
        if (!covered(w, piece->area)) continue;
        size_t p = (size_t)nearest(q, g, piece->point);
        for (int a = 0; a < 3; a++) q->skin[4 * p + a] += piece->area[a];
        double size = sqrt(gn_dot3(piece->area, piece->area));
        q->skin[4 * p + 3] += size;
        w->dem.membrane->area += size;
        gn_cross3(piece->point, piece->area, turn);
        for (int a = 0; a < 3; a++) moment[a] += turn[a];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                arms[3 * a + b] += piece->area[a] * (piece->point[b] - q->pos[4 * p + b]);
    }
}

static void solve3(const double k[9], const double b[3], double x[3]) {
    double c[9];
    gn_cofactor3(k, c);
    double det = gn_dot3(k, c);
    for (int a = 0; a < 3; a++) {
        x[a] = 0.0;
        for (int d = 0; d < 3; d++) x[a] += c[3 * d + a] * b[d];
        x[a] = det != 0.0 ? x[a] / det : 0.0;
    }
}

/* Areas act at centres, not where the pieces are: together they would turn the specimen. The least
 * change that restores the moment of the surface, A_i b x (x_i - mean), changes no force. Places
 * are those of the start, as the areas are; what has broken off has a negative share. */
void gn_membrane_balance(gn_world *w, const double moment[3]) {
    gn_particles *q = &w->dem.particles;
    double mean[3] = {0}, sum = 0.0, missing[3], k[9] = {0}, b[3], turn[3];
    memcpy(missing, moment, sizeof missing);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->skin[4 * p + 3] > 0.0)) continue;
        sum += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) mean[a] += q->skin[4 * p + 3] * q->start[4 * p + a];
        gn_cross3(q->start + 4 * p, q->skin + 4 * p, turn);
        for (int a = 0; a < 3; a++) missing[a] -= turn[a];
    }
    for (int a = 0; a < 3; a++) mean[a] /= sum;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, weight = fmax(q->skin[4 * p + 3], 0.0);
        for (int a = 0; a < 3; a++) d[a] = q->start[4 * p + a] - mean[a];
        for (int a = 0; a < 9; a++)
            k[a] += weight * ((a % 4 == 0 ? gn_dot3(d, d) : 0.0) - d[a / 3] * d[a % 3]);
    }
    if (w->scene.dimension == 2) missing[0] = missing[1] = 0.0;
    solve3(k, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, change[3];
        if (!(q->skin[4 * p + 3] > 0.0)) continue;
        for (int a = 0; a < 3; a++) d[a] = q->start[4 * p + a] - mean[a];
        gn_cross3(b, d, change);
        for (int a = 0; a < 3; a++) q->skin[4 * p + a] += q->skin[4 * p + 3] * change[a];
    }
}

static double mean_radius(const gn_particles *q) {
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += q->pos[4 * p + 3];
    return sum / (double)q->soa.count;
}

/* Shares of the surface of the shape. */
static gneiss_status skin_of_shape(gn_world *w, double radius, gneiss_error *error) {
    double moment[3] = {0};
    gn_boundary_pieces pieces;
    grid g;
    GN_TRY(gn_boundary_pieces_make(&w->scene, piece_size * radius, &pieces, error));
    gneiss_status status = make_grid(w, 3.0 * radius, &g, error);
    if (status == GNEISS_OK) {
        share_out(w, &pieces, &g, moment);
        free_grid(&g);
    }
    gn_boundary_pieces_free(&pieces);
    if (status == GNEISS_OK && w->dem.membrane->area > 0.0) gn_membrane_balance(w, moment);
    return status;
}

gneiss_status gn_membrane_create(gn_world *w, gneiss_error *error) {
    gn_particles *q = &w->dem.particles;
    const gn_scene *s = &w->scene;
    if (!(w->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    const double radius = mean_radius(q);
    w->dem.membrane = gn_alloc_array(1, sizeof *w->dem.membrane);
    if (!w->dem.membrane) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    memcpy(q->load, q->applied, 4 * q->soa.count * sizeof *q->load);
    GN_TRY(s->specimen.pack.shape != GN_SHAPE_NONE ? skin_of_shape(w, radius, error)
                                                   : gn_membrane_free_skin(w, radius, error));
    if (w->dem.membrane->area > 0.0) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT, "%s: expected a surface that faces across %c, found none",
        gn_scene_at(s, s->membrane.where, "membrane").text, "xyz"[gn_scene_membrane_axis(s)]);
}
