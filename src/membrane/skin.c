/* The skin of a packed specimen: its surface is cut into pieces, and every piece goes to the
 * particle whose surface is nearest (a Voronoi share), so that the areas add up to the surface. */
#include "membrane/membrane.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "frame/step_context.h"
#include "membrane/grid.h"
#include "membrane/support.h"
#include "pack/boundary.h"
#include "particles/dem.h"
#include "particles/fragments.h"
#include "particles/observe.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a mean radius: shares are then of some fifty pieces. */
static const double piece_size = 0.25;

/* Patches that a particle may have: three in the corner of a box. */
enum { SIDES = 3 };

/* --- shares --- */

/* Sides face across the axis more than along it. */
bool gn_membrane_covers(const gn_step_context *ctx, const double area[3]) {
    const gn_membrane_def *m = &ctx->scene.membrane;
    if (m->faces == GN_FACES_ALL) return true;
    double along = area[gn_scene_membrane_axis(&ctx->scene)], size = gn_dot3(area, area);
    return along * along < 0.5 * size;
}

/* Of the patches of a particle the one that a piece joins: of the side of the body that it is of.
 */
static gn_patch *side_of(gn_patch *patches, const double area[3], double size) {
    const double same = 0.7;
    for (int k = 0; k < SIDES - 1; k++) {
        const double *had = patches[k].area, length = sqrt(gn_dot3(had, had));
        if (!(patches[k].size > 0.0) || gn_dot3(had, area) > same * length * size)
            return &patches[k];
    }
    return &patches[SIDES - 1];
}

/* A piece of the surface goes to a patch of a particle. Ways are from its centre as yet. */
static void share_out(const gn_step_context *ctx, const gn_dem *dem,
                      const gn_boundary_pieces *pieces, const gn_start_grid *g, gn_patch *patches) {
    for (size_t k = 0; k < pieces->count; k++) {
        const gn_piece_of_boundary *piece = &pieces->piece[k];
        if (!gn_membrane_covers(ctx, piece->area)) continue;
        const size_t p = (size_t)gn_start_grid_nearest(g, piece->point, NULL);
        double size = sqrt(gn_dot3(piece->area, piece->area)), way[3];
        gn_patch *patch = side_of(patches + SIDES * p, piece->area, size);
        patch->size += size;
        for (int a = 0; a < 3; a++) {
            way[a] = piece->point[a] - dem->particles.start[4 * p + a];
            patch->area[a] += piece->area[a];
            patch->point[a] += size * way[a];
        }
        for (int a = 0; a < 9; a++) patch->rest[a] += piece->area[a / 3] * way[a % 3];
    }
}

static void solve3(const double k[9], const double b[3], double x[3]) {
    const double size = k[0] + k[4] + k[8];
    double c[9];
    gn_cofactor3(k, c);
    double det = gn_dot3(k, c);
    if (!(det > 1e-12 * size * size * size)) det = 0.0; /* all in a line: no moment */
    for (int a = 0; a < 3; a++) {
        x[a] = 0.0;
        for (int d = 0; d < 3; d++) x[a] += c[3 * d + a] * b[d];
        x[a] = det != 0.0 ? x[a] / det : 0.0;
    }
}

/* Areas act at centres, not where the pieces are: together they would turn the specimen. The least
 * change that restores the moment of the surface, A_i b x (x_i - mean), changes no force. */
void gn_membrane_balance(const gn_step_context *ctx, const gn_dem *dem, gn_skin_body body,
                         const double *place, const double moment[3], double *area) {
    const gn_particles *q = &dem->particles;
    double mean[3] = {0}, sum = 0.0, missing[3], k[9] = {0}, b[3], turn[3];
    memcpy(missing, moment, sizeof missing);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_pressed_of(q, body, p)) continue;
        sum += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) mean[a] += q->skin[4 * p + 3] * place[4 * p + a];
        gn_cross3(place + 4 * p, area + 4 * p, turn);
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
    if (ctx->scene.dimension == 2) missing[0] = missing[1] = 0.0;
    solve3(k, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, change[3];
        if (!gn_is_pressed_of(q, body, p)) continue;
        for (int a = 0; a < 3; a++) d[a] = place[4 * p + a] - mean[a];
        gn_cross3(b, d, change);
        for (int a = 0; a < 3; a++) area[4 * p + a] += q->skin[4 * p + 3] * change[a];
    }
}

/* --- patches --- */

/* Those of each particle's room that have a size. */
static gneiss_status keep_patches(gn_dem *dem, const gn_patch *all, gneiss_error *error) {
    gn_dem *d = dem;
    const size_t most = SIDES * d->particles.soa.count;
    for (size_t k = 0; k < most; k++) d->patch_count += all[k].size > 0.0;
    d->patches = gn_alloc_array(d->patch_count + 1, sizeof *d->patches);
    if (!d->patches) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    size_t at = 0;
    for (size_t k = 0; k < most; k++)
        if (all[k].size > 0.0) {
            const size_t p = k / SIDES;
            d->patches[at] = all[k];
            d->patches[at++].owner = d->particles.id[p];
        }
    return GNEISS_OK;
}

/* The middle of a patch at a way from the particle's centre, and what it cannot tell of `rest`, the
 * sum of areas times ways from there. */
static void set_middle(gn_patch *patch, const double centre[3], const double way[3]) {
    for (int k = 0; k < 9; k++) patch->rest[k] -= patch->area[k / 3] * way[k % 3];
    for (int a = 0; a < 3; a++) patch->point[a] = centre[a] + way[a];
}

/* Shares of the surface of the shape. */
static gneiss_status skin_of_shape(const gn_step_context *ctx, gn_dem *dem, double radius,
                                   const bool *held, gn_patch *all, gneiss_error *error) {
    gn_boundary_pieces pieces;
    gn_start_grid g;
    GN_TRY(gn_boundary_pieces_make(&ctx->scene, piece_size * radius, &pieces, error));
    gneiss_status status = gn_start_grid_make(ctx, dem, 3.0 * radius, held, &g, error);
    if (status == GNEISS_OK) {
        share_out(ctx, dem, &pieces, &g, all);
        gn_start_grid_free(&g);
    }
    gn_boundary_pieces_free(&pieces);
    for (size_t k = 0; k < SIDES * dem->particles.soa.count; k++) {
        double way[3];
        if (!(all[k].size > 0.0)) continue;
        for (int a = 0; a < 3; a++) way[a] = all[k].point[a] / all[k].size;
        set_middle(&all[k], dem->particles.start + 4 * (k / SIDES), way);
    }
    return status;
}

/* Of a patch the middle is along its area, on the particle at most; what areas times ways are
 * beside that are the same along all axes. */
static void set_patch(gn_patch *patch, const double area[3], double size, const double *at,
                      double radius, int dimension, double arms) {
    const double along = size > 0.0 ? fmin(fmax(arms / size, 0.0), radius) : 0.0;
    double way[3] = {0};
    patch->size = size;
    for (int a = 0; a < dimension; a++) {
        patch->area[a] = area[a];
        way[a] = size > 0.0 ? along * area[a] / size : 0.0;
        patch->rest[4 * a] = (arms - along * size) / dimension;
        for (int b = 0; b < dimension; b++) patch->rest[3 * a + b] += area[a] * way[b];
    }
    set_middle(patch, at, way);
}

/* Without a shape. As of any closed surface the areas times places add up to what they enclose,
 * alike along all axes, and turn nothing, however it deforms. */
static void skin_of_particles(const gn_step_context *ctx, gn_dem *dem, const double *arms,
                              gn_patch *all) {
    const gn_particles *q = &dem->particles;
    const size_t n = q->soa.count;
    const int d = (int)ctx->scene.dimension;
    double sum[9] = {0}, sizes = 0.0;
    for (size_t p = 0; p < n; p++) {
        gn_patch *patch = &all[SIDES * p];
        if (!(q->skin[4 * p + 3] > 0.0)) continue;
        set_patch(patch, q->skin + 4 * p, q->skin[4 * p + 3], q->start + 4 * p, q->pos[4 * p + 3],
                  d, arms[p]);
        sizes += patch->size;
        for (int k = 0; k < 9; k++)
            sum[k] += patch->area[k / 3] * patch->point[k % 3] + patch->rest[k];
    }
    for (int a = 0; a < d; a++) sum[4 * a] -= dem->membrane->enclosed;
    for (size_t p = 0; p < n; p++)
        for (int k = 0; k < 9 && sizes > 0.0; k++)
            all[SIDES * p].rest[k] -= all[SIDES * p].size / sizes * sum[k];
}

static gneiss_status find_patches(const gn_step_context *ctx, gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const bool *held, gn_patch *all, gneiss_error *error) {
    const double radius = gn_dem_mean_radius(dem);
    if (gn_scene_membrane_on_shape(&ctx->scene))
        return skin_of_shape(ctx, dem, radius, held, all, error);
    double *arms = gn_alloc_array(dem->particles.soa.count + 1, sizeof *arms);
    if (!arms) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    gneiss_status status = gn_membrane_free_skin(ctx, dem, boundary, solids, radius, arms, error);
    if (status == GNEISS_OK) skin_of_particles(ctx, dem, arms, all);
    gn_free(arms);
    return status;
}

static gneiss_status make_patches(const gn_step_context *ctx, gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const bool *held, gneiss_error *error) {
    gn_patch *all = gn_alloc_array(SIDES * dem->particles.soa.count + 1, sizeof *all);
    if (!all) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    gneiss_status status = find_patches(ctx, dem, boundary, solids, held, all, error);
    if (status == GNEISS_OK) status = keep_patches(dem, all, error);
    gn_free(all);
    return status;
}

gneiss_status gn_membrane_create(const gn_step_context *ctx, gn_dem *dem,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const gn_scene *s = &ctx->scene;
    if (!(ctx->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    dem->membrane = gn_alloc_array(1, sizeof *dem->membrane);
    if (!dem->membrane) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    for (int a = 0; a < 3; a++) dem->membrane->gradient[4 * a] = 1.0;
    memcpy(q->load, q->applied, 4 * q->soa.count * sizeof *q->load);
    GN_TRY(make_patches(ctx, dem, boundary, solids, NULL, error));
    for (size_t p = 0; p < q->soa.count; p++) dem->index_of_id[q->id[p]] = (int32_t)p;
    GN_TRY(gn_membrane_lay(ctx, dem, true, error));
    if (gn_membrane_area(dem) > 0.0) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT, "%s: expected a surface that faces across %c, found none",
        gn_scene_at(s, s->membrane.where, "membrane").text, "xyz"[gn_scene_membrane_axis(s)]);
}

/* --- who bears them --- */

/* Without a shape: patches of those that are not held, where any of their body is, go to what is
 * nearest of it. `body` [particles]: who stands for that of each. */
static gneiss_status hand_over(const gn_step_context *ctx, gn_dem *dem, const bool *held,
                               const int32_t *body, gneiss_error *error) {
    gn_dem *d = dem;
    gn_start_grid g;
    GN_TRY(gn_start_grid_make(ctx, dem, 3.0 * gn_dem_mean_radius(dem), held, &g, error));
    for (size_t k = 0; k < d->patch_count; k++) {
        const int32_t at = gn_patch_bearer(d, &d->patches[k]);
        if (at < 0 || held[at]) continue;
        const int32_t to = gn_start_grid_nearest(&g, d->patches[k].point, NULL);
        if (to >= 0 && body[to] == body[at]) d->patches[k].owner = d->particles.id[to];
    }
    gn_start_grid_free(&g);
    return GNEISS_OK;
}

static int by_owner(const void *a, const void *b) {
    const gn_patch *x = a, *y = b;
    if (x->owner != y->owner) return x->owner < y->owner ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->point[k] != y->point[k]) return x->point[k] < y->point[k] ? -1 : 1;
    return 0;
}

static gneiss_status share_again(const gn_step_context *ctx, gn_dem *dem,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 const bool *held, int32_t *body, gneiss_error *error) {
    gn_dem *d = dem;
    if (!gn_scene_membrane_on_shape(&ctx->scene)) {
        gn_world_body_groups(ctx, dem, INT32_MAX, body);
        GN_TRY(hand_over(ctx, dem, held, body, error));
        qsort(d->patches, d->patch_count, sizeof *d->patches, by_owner);
    } else {
        gn_free(d->patches);
        d->patches = NULL;
        d->patch_count = 0;
        GN_TRY(make_patches(ctx, dem, boundary, solids, held, error));
    }
    GN_TRY(gn_membrane_lay(ctx, dem, true, error));
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (!gn_is_pressed(&d->particles, p))
            memcpy(d->particles.applied + 4 * p, d->particles.load + 4 * p,
                   4 * sizeof *d->particles.load);
    return GNEISS_OK;
}

/* Whether all that bear are held, or something has come off, so that patches are no longer those of
 * the start. */
static bool may_stay(const gn_dem *dem, const bool *held) {
    const gn_dem *d = dem;
    bool all = true;
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (gn_came_off(&d->particles, p)) return true;
    for (size_t k = 0; k < d->patch_count; k++) {
        const int32_t at = gn_patch_bearer(d, &d->patches[k]);
        all = all && (at < 0 || held[at]);
    }
    return all;
}

gneiss_status gn_membrane_bear(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                               const gn_solids *solids, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    if (!(ctx->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    bool *held = gn_alloc_array(n + 1, sizeof *held);
    int32_t *body = gn_alloc_array(n + 1, sizeof *body);
    gneiss_status status = held && body
                               ? gn_membrane_held(ctx, dem, held, error)
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    if (status == GNEISS_OK && !may_stay(dem, held))
        status = share_again(ctx, dem, boundary, solids, held, body, error);
    gn_free(held);
    gn_free(body);
    return status;
}
