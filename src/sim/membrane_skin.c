/* The skin of a packed specimen: its surface is cut into pieces, and every piece goes to the
 * particle whose surface is nearest (a Voronoi share), so that the areas add up to the surface. */
#include "sim/membrane.h"

#include "base/memory.h"
#include "pack/boundary.h"
#include "sim/internal.h"
#include "sim/membrane_grid.h"

#include <math.h>
#include <string.h>

/* Of a mean radius: shares are then of some fifty pieces. */
static const double piece_size = 0.25;

/* --- shares --- */

/* Sides face across the axis more than along it. */
static bool covered(const gn_world *w, const double area[3]) {
    const gn_membrane_def *m = &w->scene.membrane;
    if (m->faces == GN_FACES_ALL) return true;
    double along = area[gn_scene_membrane_axis(&w->scene)], size = gn_dot3(area, area);
    return along * along < 0.5 * size;
}

/* A piece of the surface goes to the patch of a particle; sums over the pieces of area times place
 * go to `tensor`. */
static void share_out(const gn_world *w, const gn_boundary_pieces *pieces, const gn_start_grid *g,
                      gn_patch *patches, double tensor[9]) {
    for (size_t k = 0; k < pieces->count; k++) {
        const gn_piece_of_boundary *piece = &pieces->piece[k];
        if (!covered(w, piece->area)) continue;
        gn_patch *patch = &patches[gn_start_grid_nearest(g, piece->point, NULL)];
        double size = sqrt(gn_dot3(piece->area, piece->area));
        patch->size += size;
        for (int a = 0; a < 3; a++) patch->area[a] += piece->area[a];
        for (int a = 0; a < 3; a++) patch->point[a] += size * piece->point[a];
        for (int a = 0; a < 9; a++) tensor[a] += piece->area[a / 3] * piece->point[a % 3];
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
 * change that restores the moment of the surface, A_i b x (x_i - mean), changes no force. */
void gn_membrane_balance(gn_world *w, gn_skin_body body, const double *place,
                         const double moment[3]) {
    gn_particles *q = &w->dem.particles;
    double mean[3] = {0}, sum = 0.0, missing[3], k[9] = {0}, b[3], turn[3];
    memcpy(missing, moment, sizeof missing);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_pressed_of(q, body, p)) continue;
        sum += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) mean[a] += q->skin[4 * p + 3] * place[4 * p + a];
        gn_cross3(place + 4 * p, q->skin + 4 * p, turn);
        for (int a = 0; a < 3; a++) missing[a] -= turn[a];
    }
    for (int a = 0; a < 3; a++) mean[a] /= sum;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, weight = q->skin[4 * p + 3];
        if (!gn_is_pressed_of(q, body, p)) continue;
        for (int a = 0; a < 3; a++) d[a] = place[4 * p + a] - mean[a];
        for (int a = 0; a < 9; a++)
            k[a] += weight * ((a % 4 == 0 ? gn_dot3(d, d) : 0.0) - d[a / 3] * d[a % 3]);
    }
    if (w->scene.dimension == 2) missing[0] = missing[1] = 0.0;
    solve3(k, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, change[3];
        if (!gn_is_pressed_of(q, body, p)) continue;
        for (int a = 0; a < 3; a++) d[a] = place[4 * p + a] - mean[a];
        gn_cross3(b, d, change);
        for (int a = 0; a < 3; a++) q->skin[4 * p + a] += q->skin[4 * p + 3] * change[a];
    }
}

/* --- patches --- */

/* One of each particle's room that has a size; `tensor` loses what they have, so that what is left
 * is what a patch cannot tell of its pieces. */
static gneiss_status keep_patches(gn_world *w, const gn_patch *all, double tensor[9],
                                  gneiss_error *error) {
    gn_dem *d = &w->dem;
    for (size_t p = 0; p < d->particles.soa.count; p++) d->patch_count += all[p].size > 0.0;
    d->patches = gn_alloc_array(d->patch_count + 1, sizeof *d->patches);
    if (!d->patches) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    size_t at = 0;
    for (size_t p = 0; p < d->particles.soa.count; p++) {
        if (!(all[p].size > 0.0)) continue;
        gn_patch *patch = &d->patches[at++];
        *patch = all[p];
        patch->owner = d->particles.id[p];
        for (int k = 0; k < 9; k++) tensor[k] -= patch->area[k / 3] * patch->point[k % 3];
    }
    memcpy(d->membrane->rest, tensor, sizeof d->membrane->rest);
    return GNEISS_OK;
}

/* Shares of the surface of the shape. */
static gneiss_status skin_of_shape(gn_world *w, double radius, gn_patch *all, double tensor[9],
                                   gneiss_error *error) {
    gn_boundary_pieces pieces;
    gn_start_grid g;
    GN_TRY(gn_boundary_pieces_make(&w->scene, piece_size * radius, &pieces, error));
    gneiss_status status = gn_start_grid_make(w, 3.0 * radius, &g, error);
    if (status == GNEISS_OK) {
        share_out(w, &pieces, &g, all, tensor);
        gn_start_grid_free(&g);
    }
    gn_boundary_pieces_free(&pieces);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        for (int a = 0; a < 3 && all[p].size > 0.0; a++) all[p].point[a] /= all[p].size;
    return status;
}

/* Without a shape: areas act on the surfaces of the particles, and as those of any closed surface
 * they turn nothing, however it deforms. */
static gneiss_status skin_of_particles(gn_world *w, double radius, gn_patch *all, double tensor[9],
                                       gneiss_error *error) {
    gn_particles *q = &w->dem.particles;
    double arms[9] = {0};
    GN_TRY(gn_membrane_free_skin(w, radius, arms, error));
    for (int a = 0; a < 3; a++) tensor[4 * a] = arms[4 * a];
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *area = q->skin + 4 * p;
        all[p].size = area[3];
        for (int a = 0; a < 3 && area[3] > 0.0; a++) {
            all[p].area[a] = area[a];
            all[p].point[a] = q->start[4 * p + a] + q->pos[4 * p + 3] * area[a] / area[3];
        }
        for (int a = 0; a < 3; a++) tensor[4 * a] += area[a] * q->start[4 * p + a];
    }
    return GNEISS_OK;
}

static gneiss_status make_patches(gn_world *w, gneiss_error *error) {
    gn_particles *q = &w->dem.particles;
    const double radius = gn_world_mean_radius(w);
    double tensor[9] = {0};
    gn_patch *all = gn_alloc_array(q->soa.count + 1, sizeof *all);
    if (!all) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    gneiss_status status = w->scene.specimen.pack.shape != GN_SHAPE_NONE
                               ? skin_of_shape(w, radius, all, tensor, error)
                               : skin_of_particles(w, radius, all, tensor, error);
    if (status == GNEISS_OK) status = keep_patches(w, all, tensor, error);
    gn_free(all);
    return status;
}

gneiss_status gn_membrane_create(gn_world *w, gneiss_error *error) {
    gn_particles *q = &w->dem.particles;
    const gn_scene *s = &w->scene;
    if (!(w->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    w->dem.membrane = gn_alloc_array(1, sizeof *w->dem.membrane);
    if (!w->dem.membrane) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    for (int a = 0; a < 3; a++) w->dem.membrane->gradient[4 * a] = 1.0;
    memcpy(q->load, q->applied, 4 * q->soa.count * sizeof *q->load);
    GN_TRY(make_patches(w, error));
    for (size_t p = 0; p < q->soa.count; p++) w->dem.index_of_id[q->id[p]] = (int32_t)p;
    GN_TRY(gn_membrane_lay(w, error));
    if (gn_membrane_area(w) > 0.0) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT, "%s: expected a surface that faces across %c, found none",
        gn_scene_at(s, s->membrane.where, "membrane").text, "xyz"[gn_scene_membrane_axis(s)]);
}
