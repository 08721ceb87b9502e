#include "inflow/free_space.h"

#include "base/error.h"
#include "base/new.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "surfaces/facet.h"

#include <string.h>

/* Tolerance of contact, as a fraction of the sum of the radii. */
static const double apart = 1e-9;

static gneiss_status no_memory(gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to find room for particles");
}

static gneiss_status reserve(gn_room *r, size_t space, gneiss_error *error) {
    if (space <= r->space) return GNEISS_OK;
    if (space > INT32_MAX || !gn_widen(&r->sphere, 4 * r->count, 4 * (space + 1), sizeof(double)) ||
        !gn_widen(&r->next, r->count, space + 1, sizeof *r->next))
        return no_memory(error);
    r->space = space;
    return GNEISS_OK;
}

/* --- cells --- */

static int64_t place(const gn_room *r, int a, double x) {
    double at = floor((x - r->lower[a]) / r->cell);
    return at < 0.0 ? 0 : at >= (double)r->cells[a] ? r->cells[a] - 1 : (int64_t)at;
}

static size_t cell_of(const gn_room *r, const double *x) {
    int64_t at = 0;
    for (int a = 2; a >= 0; a--) at = at * r->cells[a] + place(r, a, x[a]);
    return (size_t)at;
}

static void file(gn_room *r, size_t k) {
    size_t cell = cell_of(r, r->sphere + 4 * k);
    r->next[k] = r->first[cell];
    r->first[cell] = (int32_t)k;
}

/* Makes cells, not more than are useful. */
static gneiss_status make_cells(gn_room *r, const double lower[3], const double upper[3],
                                double radius, gneiss_error *error) {
    const int dimension = (int)r->ctx->scene.dimension;
    double number = INFINITY, most = 8.0 * (double)r->count + 4096.0;
    r->cell = 2.0 * fmax(radius, r->most);
    for (int a = 0; a < 3; a++) r->cells[a] = 1;
    for (; number > most; r->cell *= 1.25) {
        number = 1.0;
        for (int a = 0; a < dimension; a++) number *= floor((upper[a] - lower[a]) / r->cell) + 1.0;
        if (number <= most) break;
    }
    for (int a = 0; a < dimension; a++)
        r->cells[a] = (int64_t)floor((upper[a] - lower[a]) / r->cell) + 1;
    size_t count = (size_t)(r->cells[0] * r->cells[1] * r->cells[2]);
    r->first = gn_alloc_array(count + 1, sizeof *r->first);
    if (!r->first) return no_memory(error);
    for (size_t c = 0; c < count; c++) r->first[c] = -1;
    memcpy(r->lower, lower, sizeof r->lower);
    for (size_t k = 0; k < r->count; k++) file(r, k);
    return GNEISS_OK;
}

/* --- existing spheres --- */

/* Adds a sphere, and those of its images that are within `reach` of the box. */
static gneiss_status collect(gn_room *r, const double *x, const double lower[3],
                             const double upper[3], double reach, gneiss_error *error) {
    int64_t least[3] = {0}, most[3] = {0};
    for (int a = 0; a < (int)r->ctx->scene.dimension; a++) {
        double wide = reach + x[3],
               period = r->ctx->effects & GN_FX_PERIODIC ? r->ctx->period[a] : 0.0;
        if (period > 0.0) {
            least[a] = (int64_t)ceil((lower[a] - wide - x[a]) / period);
            most[a] = (int64_t)floor((upper[a] + wide - x[a]) / period);
        } else if (x[a] < lower[a] - wide || x[a] > upper[a] + wide) {
            return GNEISS_OK;
        }
    }
    for (int64_t i = least[0]; i <= most[0]; i++)
        for (int64_t j = least[1]; j <= most[1]; j++)
            for (int64_t k = least[2]; k <= most[2]; k++) {
                if (r->count == r->space) GN_TRY(reserve(r, 2 * r->space + 64, error));
                double *image = r->sphere + 4 * r->count++;
                image[0] = x[0] + (double)i * r->ctx->period[0];
                image[1] = x[1] + (double)j * r->ctx->period[1];
                image[2] = x[2] + (double)k * r->ctx->period[2];
                image[3] = x[3];
                r->most = fmax(r->most, x[3]);
            }
    return GNEISS_OK;
}

gneiss_status gn_room_open(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const double lower[3],
                           const double upper[3], double radius, gn_room *r, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    *r = (gn_room){.ctx = ctx, .dem = dem, .boundary = boundary};
    gneiss_status status = reserve(r, 64, error);
    for (size_t p = 0; status == GNEISS_OK && p < q->soa.count; p++)
        if (gn_particle_is_active(q, p))
            status = collect(r, q->pos + 4 * p, lower, upper, radius, error);
    if (status == GNEISS_OK) status = make_cells(r, lower, upper, radius, error);
    if (status != GNEISS_OK) gn_room_close(r);
    return status;
}

void gn_room_close(gn_room *r) {
    gn_free(r->sphere);
    gn_free(r->first);
    gn_free(r->next);
    *r = (gn_room){0};
}

static bool touches(const double *a, const double *b) {
    double d2 = 0.0, reach = (a[3] + b[3]) * (1.0 + apart);
    for (int k = 0; k < 3; k++) d2 += (a[k] - b[k]) * (a[k] - b[k]);
    return d2 < reach * reach;
}

/* Spheres outside of the box are stored in its outermost cells. */
static bool meets_particle(const gn_room *r, const double *s) {
    int64_t low[3], high[3];
    double reach = s[3] + r->most;
    for (int a = 0; a < 3; a++) {
        low[a] = place(r, a, s[a] - reach * (1.0 + apart));
        high[a] = place(r, a, s[a] + reach * (1.0 + apart));
    }
    for (int64_t z = low[2]; z <= high[2]; z++)
        for (int64_t y = low[1]; y <= high[1]; y++)
            for (int64_t x = low[0]; x <= high[0]; x++) {
                int32_t k = r->first[x + r->cells[0] * (y + r->cells[1] * z)];
                for (; k >= 0; k = r->next[k])
                    if (touches(s, r->sphere + 4 * (int64_t)k)) return true;
            }
    return false;
}

/* Boxes of the tree around nodes are those of the last construction of the lists; nodes have moved
 * by less than the skin since. */
static bool meets_surface(const gn_dem *dem, const gn_boundary *boundary, const gn_surface *f,
                          const double *s) {
    double d[3], centre[3], reach = s[3] * (1.0 + apart);
    if (f->body < 0)
        return gn_facet_tree_near(&f->tree, &f->facets, s, reach + dem->verlet.skin, NULL) > 0;
    const gn_rigid *b = &boundary->bodies[f->body];
    for (int a = 0; a < 3; a++) d[a] = s[a] - b->position[a];
    gn_rigid_local(b, d, centre);
    return gn_facet_tree_near(&f->tree, &f->facets, centre, reach, NULL) > 0;
}

bool gn_room_free(const gn_room *r, const double s[4]) {
    for (size_t k = 0; k < r->ctx->scene.wall_count; k++)
        if (gn_wall_distance(&r->boundary->walls[k], s) < s[3] * (1.0 + apart)) return false;
    if (meets_particle(r, s)) return false;
    for (size_t k = 0; k < r->boundary->surface_count; k++)
        if (meets_surface(r->dem, r->boundary, &r->boundary->surfaces[k], s)) return false;
    return true;
}

gneiss_status gn_room_take(gn_room *r, const double sphere[4], gneiss_error *error) {
    size_t before = r->count;
    const double *x = sphere;
    /* Images are included if they are near enough. */
    double lower[3], upper[3];
    for (int a = 0; a < 3; a++) {
        lower[a] = r->lower[a];
        upper[a] = r->lower[a] + r->cell * (double)r->cells[a];
    }
    GN_TRY(collect(r, x, lower, upper, sphere[3], error));
    for (size_t k = before; k < r->count; k++) file(r, k);
    return GNEISS_OK;
}
