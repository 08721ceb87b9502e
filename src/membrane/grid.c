#include "membrane/grid.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "soa/records.h"

#include <math.h>

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

/* Where they were at the start lies within w->lower and w->upper. */
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

/* How much further away it is across than along. */
static const double across = 4.0;

/* Never less than the length of d. */
static double far_away(const double d[3], const double *along) {
    double square = gn_dot3(d, d), size = along ? gn_dot3(along, along) : 0.0;
    if (!(size > 0.0)) return sqrt(square);
    double way = gn_dot3(d, along), straight = way * way / size;
    return sqrt(straight + across * across * fmax(square - straight, 0.0));
}

/* The particle of a cell whose surface is nearest to x, if nearer than *least. */
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

/* Shells of cells, until no particle further out can be nearer. */
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
