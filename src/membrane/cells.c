#include "membrane/cells.h"

#include "base/error.h"
#include "base/new.h"
#include "base/random.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* --- particles by cells of a grid --- */

static int64_t cell_along(const gn_start_grid *g, double x, int a) {
    double k = floor((x - g->lower[a]) / g->cell), last = (double)(g->n[a] - 1);
    return (int64_t)(k < 0.0 ? 0.0 : k > last ? last : k);
}

static int64_t cell_at(const gn_start_grid *g, const double *x) {
    return (cell_along(g, x[2], 2) * g->n[1] + cell_along(g, x[1], 1)) * g->n[0] +
           cell_along(g, x[0], 0);
}

void gn_start_grid_free(gn_start_grid *g) {
    gn_free(g->first);
    gn_free(g->item);
}

/* At the start all particles were between w->lower and w->upper. */
gneiss_status gn_start_grid_make(const gn_step_context *ctx, const gn_dem *dem, double cell,
                                 const bool *of, gn_start_grid *g, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    *g = (gn_start_grid){.particles = q, .cell = cell};
    size_t cells = 1;
    for (int a = 0; a < 3; a++) {
        g->lower[a] = ctx->lower[a];
        g->n[a] = 1 + (int64_t)((ctx->upper[a] - ctx->lower[a]) / cell);
        cells *= (size_t)g->n[a];
    }
    g->first = gn_alloc_array(cells + 2, sizeof *g->first);
    g->item = gn_alloc_array(q->soa.count + 1, sizeof *g->item);
    if (!g->first || !g->item) {
        gn_start_grid_free(g);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the skin of the specimen");
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        if (of && !of[p]) continue;
        g->first[cell_at(g, q->start + 4 * p) + 2]++;
        g->radius_max = fmax(g->radius_max, q->pos[4 * p + 3]);
    }
    for (size_t k = 0; k < cells; k++) g->first[k + 2] += g->first[k + 1];
    for (size_t p = 0; p < q->soa.count; p++)
        if (!of || of[p]) g->item[g->first[cell_at(g, q->start + 4 * p) + 1]++] = (int32_t)p;
    return GNEISS_OK;
}

/* Factor on squared distances across the direction `along`. */
static const double across = 4.0;

/* Returns a distance that is at least the length of d. */
static double far_away(const double d[3], const double *along) {
    double square = gn_dot3(d, d), size = along ? gn_dot3(along, along) : 0.0;
    if (!(size > 0.0)) return sqrt(square);
    double way = gn_dot3(d, along), straight = way * way / size;
    return sqrt(straight + across * across * fmax(square - straight, 0.0));
}

/* Searches a cell for the particle whose surface is nearest to x, nearer than *least. */
static void look_in(const gn_start_grid *g, int64_t cell, const double x[3], const double *along,
                    double *least, int32_t *found) {
    const gn_particles *q = g->particles;
    for (int32_t k = g->first[cell]; k < g->first[cell + 1]; k++) {
        const size_t p = (size_t)g->item[k];
        const double *y = q->start + 4 * p;
        double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
        double distance = far_away(d, along) - q->pos[4 * p + 3];
        bool first = distance == *least && *found >= 0 && q->id[p] < q->id[*found];
        if (distance >= *least && !first) continue;
        *least = distance;
        *found = g->item[k];
    }
}

/* Visits shells of cells until no particle in an outer one can be nearer. */
int32_t gn_start_grid_nearest(const gn_start_grid *g, const double x[3], const double *along) {
    int64_t at[3], far = 0;
    double least = INFINITY;
    int32_t found = -1;
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
                        look_in(g, (k * g->n[1] + j) * g->n[0] + i, x, along, &least, &found);
                }
    }
    return found;
}

void gn_start_grid_visit(const gn_start_grid *g, const double x[3], double reach,
                         void (*see)(void *context, int32_t particle), void *context) {
    int64_t from[3], to[3];
    for (int a = 0; a < 3; a++) {
        from[a] = cell_along(g, x[a] - reach, a);
        to[a] = cell_along(g, x[a] + reach, a);
    }
    for (int64_t k = from[2]; k <= to[2]; k++)
        for (int64_t j = from[1]; j <= to[1]; j++)
            for (int64_t i = from[0]; i <= to[0]; i++) {
                int64_t cell = (k * g->n[1] + j) * g->n[0] + i;
                for (int32_t s = g->first[cell]; s < g->first[cell + 1]; s++)
                    see(context, g->item[s]);
            }
}

/* Largest number of voxels along a side. */
enum { MOST = 48 };

typedef struct view {
    gn_cell *cell;
    size_t particle;
    bool full;
} view;

void gn_cell_free(gn_cell *cell) {
    gn_free(cell->face);
    gn_free(cell->owner);
    *cell = (gn_cell){0};
}

/* --- neighbours --- */

static double way_to(const gn_particles *q, size_t p, const double x[3]) {
    const double *y = q->start + 4 * p;
    const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    return sqrt(gn_dot3(d, d));
}

/* Tells whether a point of the cell may be nearer to the other particle. */
static bool is_near(const gn_cell *cell, size_t particle, size_t other) {
    const gn_particles *q = cell->all->particles;
    const double reach = q->pos[4 * particle + 3] + 2.0 * cell->around;
    return way_to(q, other, q->start + 4 * particle) - q->pos[4 * other + 3] < reach;
}

static void see(void *context, int32_t other) {
    view *v = context;
    gn_cell *cell = v->cell;
    if ((size_t)other == v->particle || v->full) return;
    if (!is_near(cell, v->particle, (size_t)other)) return;
    v->full = gn_grow(&cell->face, cell->count, cell->count + 1, &cell->capacity, "faces", NULL) !=
              GNEISS_OK;
    if (v->full) return;
    cell->face[cell->count++] = (gn_cell_face){.particle = other};
}

/* --- voxels --- */

typedef struct cube {
    double width;    /* m, side of a voxel */
    double first[3]; /* m, middle of the first voxel */
    size_t n[3];
} cube;

/* Places the voxels about a particle. Their origin is random, so that the errors in a lattice do
 * not all have the same sign. */
static cube cube_about(const gn_cell *cell, int dimension, size_t particle) {
    const gn_particles *q = cell->all->particles;
    const double radius = q->pos[4 * particle + 3], side = 2.0 * (radius + cell->around);
    double along = ceil(side / fmin(cell->width, 0.25 * radius) - 1e-6) + 1.0;
    const size_t n = along < MOST ? (size_t)along : MOST;
    cube c = {.width = side / (double)(n - 1), .n = {n, n, dimension == 3 ? n : 1}};
    for (int a = 0; a < 3; a++) {
        double shift = gn_random_symmetric(1, 3 * (uint64_t)q->id[particle] + (uint64_t)a);
        c.first[a] = q->start[4 * particle + a];
        if (a < dimension) c.first[a] -= 0.5 * c.width * ((double)(n - 1) + shift);
    }
    return c;
}

static void middle(const cube *c, size_t i, size_t j, size_t k, double x[3]) {
    const size_t at[3] = {i, j, k};
    for (int a = 0; a < 3; a++) x[a] = c->first[a] + c->width * (double)at[a];
}

/* Returns the owner of a voxel; of two particles at equal distance, that with the smaller id. */
static int32_t owner_of(const gn_cell *cell, size_t particle, const double x[3], size_t planes,
                        const double (*plane)[4]) {
    const gn_particles *q = cell->all->particles;
    double least = way_to(q, particle, x) - q->pos[4 * particle + 3];
    int32_t found = GN_CELL_OWN, id = q->id[particle];
    if (least > cell->around) return GN_CELL_OUTSIDE;
    for (size_t k = 0; k < planes; k++)
        if (gn_dot3(plane[k], x) > plane[k][3]) return GN_CELL_OUTSIDE;
    for (size_t k = 0; k < cell->count; k++) {
        const size_t p = (size_t)cell->face[k].particle;
        const double distance = way_to(q, p, x) - q->pos[4 * p + 3];
        if (distance > least || (distance == least && q->id[p] > id)) continue;
        least = distance;
        found = (int32_t)k;
        id = q->id[p];
    }
    return found;
}

/* Adds the face between a voxel and the next one along an axis if exactly one of them belongs to
 * the cell. */
static void add_between(gn_cell *cell, int32_t one, int32_t next, int axis, double area,
                        const double x[3]) {
    const bool out = one == GN_CELL_OWN;
    const int32_t other = out ? next : one;
    if ((one == GN_CELL_OWN) == (next == GN_CELL_OWN) || other == GN_CELL_OUTSIDE) return;
    gn_cell_face *face = &cell->face[other];
    face->area[axis] += out ? area : -area;
    face->sum += area;
    for (int a = 0; a < 3; a++) face->point[a] += area * x[a];
}

static void add_faces(gn_cell *cell, const cube *c, int dimension) {
    const double area = dimension == 3 ? c->width * c->width : c->width;
    const size_t stride[3] = {1, c->n[0], c->n[0] * c->n[1]};
    for (size_t k = 0; k < c->n[2]; k++)
        for (size_t j = 0; j < c->n[1]; j++)
            for (size_t i = 0; i < c->n[0]; i++) {
                const size_t at[3] = {i, j, k}, v = i + stride[1] * j + stride[2] * k;
                for (int a = 0; a < dimension; a++) {
                    double x[3];
                    if (at[a] + 1 == c->n[a]) continue;
                    middle(c, i, j, k, x);
                    x[a] += 0.5 * c->width;
                    add_between(cell, cell->owner[v], cell->owner[v + stride[a]], a, area, x);
                }
            }
    for (size_t f = 0; f < cell->count; f++)
        for (int a = 0; a < 3 && cell->face[f].sum > 0.0; a++)
            cell->face[f].point[a] /= cell->face[f].sum;
}

gneiss_status gn_cell_find(gn_cell *cell, int dimension, size_t particle, size_t plane_count,
                           const double (*plane)[4], gneiss_error *error) {
    const double *start = cell->all->particles->start + 4 * particle;
    const double radius = cell->all->particles->pos[4 * particle + 3];
    const cube c = cube_about(cell, dimension, particle);
    const size_t voxels = c.n[0] * c.n[1] * c.n[2];
    view v = {cell, particle, false};
    cell->count = 0;
    gn_start_grid_visit(cell->all, start, radius + 2.0 * cell->around + cell->all->radius_max, see,
                        &v);
    if (voxels > cell->voxels) {
        gn_free(cell->owner);
        cell->owner = gn_alloc_array(voxels, sizeof *cell->owner);
        cell->voxels = cell->owner ? voxels : 0;
    }
    if (!cell->owner || v.full)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the cell of a particle");
    for (size_t k = 0, at = 0; k < c.n[2]; k++)
        for (size_t j = 0; j < c.n[1]; j++)
            for (size_t i = 0; i < c.n[0]; i++, at++) {
                double x[3];
                middle(&c, i, j, k, x);
                cell->owner[at] = owner_of(cell, particle, x, plane_count, plane);
            }
    add_faces(cell, &c, dimension);
    return GNEISS_OK;
}
