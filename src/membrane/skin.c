/* The skin of a packed specimen. Its surface is cut into pieces, and every piece is assigned to the
 * particle whose surface is nearest (a Voronoi share), so that the areas add up to the surface. */
#include "base/eigen.h"
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "membrane/cells.h"
#include "membrane/membrane.h"
#include "pack/boundary.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- particles that bear the membrane --- */

/* Selects the particles that carry a membrane. Bonds without moments are pinned joints: a grain on
 * one of them (2D), or on one or two (3D), rotates about its neighbours under a force that does not
 * pass through them, and so do grains attached to it. Such grains, at edges and corners, carry no
 * load; their part of the surface passes to the nearest supported particle. */
/* Sums over the contacts of a particle with supported ones, for a normal stiffness of 1. */
typedef struct footing {
    double normal[3];   /* sum of the normals n */
    double straight[9]; /* sum of n n^T */
    double count;
} footing;

/* Ratio of tangential to normal stiffness; least stiffness of a supported particle over that of one
 * contact. One contact has no stiffness across it, two in 3D none across their plane. The corner of
 * a hexagonal lattice has 0.50, of a face-centred one 0.54, of a square 1.0, of a cubic one 1.2.
 * Narrow tripods have less. */
static const double slant = 0.4, least = 0.45;

static void add_contact(footing *f, const double n[3], double sign) {
    for (int a = 0; a < 3; a++) f->normal[a] += sign * n[a];
    for (int k = 0; k < 9; k++) f->straight[k] += n[k / 3] * n[k % 3];
    f->count += 1.0;
}

static void add_list(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                     const bool *held, footing *all) {
    const double *pos = dem->particles.pos;
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
        double d[3];
        if (!held[i] && !held[j]) continue;
        const double far = sqrt(gn_branch(ctx, pos + 4 * i, pos + 4 * j, d));
        const double free = list->length0 ? list->length0[c] : pos[4 * i + 3] + pos[4 * j + 3];
        if (!gn_contact_bonded(list, c) && !(far < free)) continue;
        for (int a = 0; a < 3; a++) d[a] /= far;
        if (held[j]) add_contact(&all[i], d, 1.0);
        if (held[i]) add_contact(&all[j], d, -1.0);
    }
}

/* Computes the resistance to a push of a particle that is free to rotate. The resistance to
 * rotation over the square of the radius is turn = t (count I - n n^T); that to the push is
 * straight + t across - t^2 N^T turn^-1 N, with N the cross product with the sum of the normals. */
static void push_of(const footing *f, int dimension, double t, double push[9]) {
    double turn[9], inverse[9], half[9], cross[9] = {0};
    for (int k = 0; k < 9; k++) {
        const double across = (k % 4 == 0 ? f->count : 0.0) - f->straight[k];
        push[k] = f->straight[k] + t * across;
        turn[k] = across;
    }
    if (!(t > 0.0)) return;
    for (int a = 0; a < 3; a++) {
        cross[3 * a + (a + 1) % 3] = -f->normal[(a + 2) % 3];
        cross[3 * a + (a + 2) % 3] = f->normal[(a + 1) % 3];
    }
    if (dimension == 2) {
        for (int k = 0; k < 9; k++) inverse[k] = k == 8 ? 1.0 / f->count : 0.0;
    } else {
        /* Avoids a singular matrix if all contacts are on one axis: rotation about it has no
         * stiffness. */
        for (int a = 0; a < 3; a++) turn[4 * a] += 1e-9 * f->count;
        gn_cofactor3(turn, inverse);
        const double det = gn_dot3(turn, inverse);
        for (int k = 0; k < 9; k++) inverse[k] /= det;
    }
    gn_product3_at(cross, inverse, half);
    gn_product3(half, cross, inverse);
    for (int k = 0; k < 9; k++) push[k] -= t * inverse[k];
}

static bool is_supported(const gn_step_context *ctx, const footing *f) {
    const int d = (int)ctx->scene.dimension;
    double push[9], small[9], values[3], vectors[9];
    if (!(f->count > 0.0)) return false;
    const bool shear = ctx->effects & GN_FX_SHEAR, turns = ctx->effects & GN_FX_ROTATION;
    if (ctx->effects & GN_FX_BOND_MOMENTS || (shear && !turns)) return true;
    push_of(f, d, shear ? slant : 0.0, push);
    for (int k = 0; k < d * d; k++) small[k] = push[k / d * 3 + k % d];
    gn_eigen_symmetric(d, small, values, vectors);
    return values[d - 1] > least;
}

/* Tells whether a particle belongs to a body whose particles may pivot. */
static bool can_pivot(const gn_dem *dem, size_t p) {
    return dem->particles.group[p] != 0;
}

/* Removes unsupported particles repeatedly, because each removal may leave others unsupported. The
 * result does not depend on the order. */
static void remove_unsupported(const gn_step_context *ctx, const gn_dem *dem, footing *all,
                               bool *held) {
    const size_t n = dem->particles.soa.count;
    for (bool more = true; more;) {
        more = false;
        memset(all, 0, n * sizeof *all);
        for (int l = 0; l < GN_LIST_COUNT; l++)
            add_list(ctx, dem, &dem->list[l].contacts, held, all);
        for (size_t p = 0; p < n; p++) {
            if (!held[p] || !can_pivot(dem, p) || is_supported(ctx, &all[p])) continue;
            held[p] = false;
            more = true;
        }
    }
}

gneiss_status gn_membrane_find_supported(const gn_step_context *ctx, const gn_dem *dem, bool *held,
                                         gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const size_t n = q->soa.count;
    bool any = false;
    for (size_t p = 0; p < n; p++) held[p] = !gn_is_detached(q, p);
    if (!(ctx->effects & GN_FX_BONDS) || !dem->bonds.contacts.soa.count) return GNEISS_OK;
    footing *all = NULL;
    GN_TRY(gn_new(&all, n + 1, "the skin of particles", error));
    remove_unsupported(ctx, dem, all, held);
    gn_free(all);
    for (size_t p = 0; p < n; p++) any = any || held[p];
    for (size_t p = 0; p < n && !any; p++) held[p] = !gn_is_detached(q, p);
    return GNEISS_OK;
}

/* Size of the pieces of the surface in mean radii; a particle gets about fifty pieces. */
static const double piece_size = 0.25;

/* Largest number of patches of a particle: three in the corner of a box. */
enum { SIDES = 3 };

/* --- shares --- */

/* A side is covered if its area faces across the axis more than along it. */
bool gn_membrane_covers(const gn_step_context *ctx, const double area[3]) {
    const gn_membrane_def *m = &ctx->scene.membrane;
    if (m->faces == GN_FACES_ALL) return true;
    double along = area[gn_scene_membrane_axis(&ctx->scene)], size = gn_dot3(area, area);
    return along * along < 0.5 * size;
}

/* Returns the patch of a particle to which a piece belongs: that on the same side of the body. */
static gn_patch *side_of(gn_patch *patches, const double area[3], double size) {
    const double same = 0.7;
    for (int k = 0; k < SIDES - 1; k++) {
        const double *had = patches[k].area, length = sqrt(gn_dot3(had, had));
        if (!(patches[k].size > 0.0) || gn_dot3(had, area) > same * length * size)
            return &patches[k];
    }
    return &patches[SIDES - 1];
}

/* Adds a piece of the surface to the patch of a particle. Arms are relative to the particle's
 * centre here. */
static void distribute(const gn_step_context *ctx, const gn_dem *dem,
                       const gn_boundary_pieces *pieces, const gn_start_grid *g,
                       gn_patch *patches) {
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
    if (!(det > 1e-12 * size * size * size)) det = 0.0; /* all points are in a line: no moment */
    for (int a = 0; a < 3; a++) {
        x[a] = 0.0;
        for (int d = 0; d < 3; d++) x[a] += c[3 * d + a] * b[d];
        x[a] = det != 0.0 ? x[a] / det : 0.0;
    }
}

/* Areas act at the centres of particles and not at the positions of the pieces, so that together
 * they would exert a moment on the specimen. The smallest change that restores the moment of the
 * surface, A_i b x (x_i - mean), changes no resultant. */
void gn_membrane_balance(const gn_step_context *ctx, const gn_dem *dem, gn_skin_body body,
                         const double *place, const double moment[3], double *area) {
    const gn_particles *q = &dem->particles;
    double mean[3] = {0}, sum = 0.0, missing[3], k[9] = {0}, b[3], turn[3];
    memcpy(missing, moment, sizeof missing);
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_loaded_of(q, body, p)) continue;
        sum += q->skin[4 * p + 3];
        for (int a = 0; a < 3; a++) mean[a] += q->skin[4 * p + 3] * place[4 * p + a];
        gn_cross3(place + 4 * p, area + 4 * p, turn);
        for (int a = 0; a < 3; a++) missing[a] -= turn[a];
    }
    for (int a = 0; a < 3; a++) mean[a] /= sum;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, weight = q->skin[4 * p + 3];
        if (!gn_is_loaded_of(q, body, p)) continue;
        for (int a = 0; a < 3; a++) d[a] = place[4 * p + a] - mean[a];
        for (int a = 0; a < 9; a++)
            k[a] += weight * ((a % 4 == 0 ? gn_dot3(d, d) : 0.0) - d[a / 3] * d[a % 3]);
    }
    if (ctx->scene.dimension == 2) missing[0] = missing[1] = 0.0;
    solve3(k, missing, b);
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3] = {0}, change[3];
        if (!gn_is_loaded_of(q, body, p)) continue;
        for (int a = 0; a < 3; a++) d[a] = place[4 * p + a] - mean[a];
        gn_cross3(b, d, change);
        for (int a = 0; a < 3; a++) area[4 * p + a] += q->skin[4 * p + 3] * change[a];
    }
}

/* --- patches --- */

/* Keeps the patches of each particle that have a size. */
static gneiss_status keep_patches(gn_dem *dem, gn_membrane *membrane, const gn_patch *all,
                                  gneiss_error *error) {
    gn_dem *d = dem;
    const size_t most = SIDES * d->particles.soa.count;
    for (size_t k = 0; k < most; k++) membrane->patch_count += all[k].size > 0.0;
    GN_TRY(gn_new(&membrane->patches, membrane->patch_count + 1, "a membrane", error));
    size_t at = 0;
    for (size_t k = 0; k < most; k++)
        if (all[k].size > 0.0) {
            const size_t p = k / SIDES;
            membrane->patches[at] = all[k];
            membrane->patches[at++].owner = d->particles.id[p];
        }
    return GNEISS_OK;
}

/* Sets the middle of a patch by an arm from the particle's centre, and `rest` to the remaining sum
 * of areas times arms. */
static void set_middle(gn_patch *patch, const double centre[3], const double way[3]) {
    for (int k = 0; k < 9; k++) patch->rest[k] -= patch->area[k / 3] * way[k % 3];
    for (int a = 0; a < 3; a++) patch->point[a] = centre[a] + way[a];
}

/* Divides the surface of the given shape among particles. */
static gneiss_status skin_of_shape(const gn_step_context *ctx, gn_dem *dem, double radius,
                                   const bool *held, gn_patch *all, gneiss_error *error) {
    gn_boundary_pieces pieces;
    gn_start_grid g;
    GN_TRY(gn_boundary_pieces_make(&ctx->scene, piece_size * radius, &pieces, error));
    gneiss_status status = gn_start_grid_make(ctx, dem, 3.0 * radius, held, &g, error);
    if (status == GNEISS_OK) {
        distribute(ctx, dem, &pieces, &g, all);
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

/* Makes a patch. Its middle is in the direction of its area from the centre, at most at the surface
 * of the particle; the remaining product of area and distance is the same along all axes. */
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

/* Makes the skin of particles without a given shape. As for any closed surface, the sum of areas
 * times positions is the enclosed volume times the identity and exerts no moment, however the
 * surface deforms. */
static void skin_of_particles(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                              const double *arms, gn_patch *all) {
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
    for (int a = 0; a < d; a++) sum[4 * a] -= membrane->state->enclosed;
    for (size_t p = 0; p < n; p++)
        for (int k = 0; k < 9 && sizes > 0.0; k++)
            all[SIDES * p].rest[k] -= all[SIDES * p].size / sizes * sum[k];
}

static gneiss_status find_patches(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const bool *held, gn_patch *all, gneiss_error *error) {
    const double radius = gn_dem_mean_radius(dem);
    if (gn_scene_membrane_on_shape(&ctx->scene))
        return skin_of_shape(ctx, dem, radius, held, all, error);
    double *arms = NULL;
    GN_TRY(gn_new(&arms, dem->particles.soa.count + 1, "a membrane", error));
    gneiss_status status =
        gn_membrane_free_skin(ctx, dem, membrane, boundary, solids, radius, arms, error);
    if (status == GNEISS_OK) skin_of_particles(ctx, dem, membrane, arms, all);
    gn_free(arms);
    return status;
}

static gneiss_status make_patches(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const bool *held, gneiss_error *error) {
    gn_patch *all = NULL;
    GN_TRY(gn_new(&all, SIDES * dem->particles.soa.count + 1, "a membrane", error));
    gneiss_status status = find_patches(ctx, dem, membrane, boundary, solids, held, all, error);
    if (status == GNEISS_OK) status = keep_patches(dem, membrane, all, error);
    gn_free(all);
    return status;
}

gneiss_status gn_membrane_create(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const gn_scene *s = &ctx->scene;
    if (!(ctx->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    GN_TRY(gn_new(&membrane->state, 1, "a membrane", error));
    for (int a = 0; a < 3; a++) membrane->state->gradient[4 * a] = 1.0;
    memcpy(q->load, q->applied, 4 * q->soa.count * sizeof *q->load);
    GN_TRY(make_patches(ctx, dem, membrane, boundary, solids, NULL, error));
    gn_dem_number_ids(dem);
    GN_TRY(gn_membrane_update_areas(ctx, dem, membrane, true, error));
    if (gn_membrane_area(dem) > 0.0) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT, "%s: expected a surface that faces across %c, found none",
        gn_scene_at(s, s->membrane.where, "membrane").text, "xyz"[gn_scene_membrane_axis(s)]);
}

/* --- bearers --- */

/* Moves the patches of unsupported particles to the nearest supported particle of their body, if it
 * has any; without a given shape. `body` [particles]: representative of each body. */
static gneiss_status reassign_patches(const gn_step_context *ctx, gn_dem *dem,
                                      gn_membrane *membrane, const bool *held, const int32_t *body,
                                      gneiss_error *error) {
    gn_dem *d = dem;
    gn_start_grid g;
    GN_TRY(gn_start_grid_make(ctx, dem, 3.0 * gn_dem_mean_radius(dem), held, &g, error));
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const int32_t at = gn_patch_bearer(d, &membrane->patches[k]);
        if (at < 0 || held[at]) continue;
        const int32_t to = gn_start_grid_nearest(&g, membrane->patches[k].point, NULL);
        if (to >= 0 && body[to] == body[at]) membrane->patches[k].owner = d->particles.id[to];
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

static gneiss_status redistribute(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const bool *held, int32_t *body, gneiss_error *error) {
    gn_dem *d = dem;
    if (!gn_scene_membrane_on_shape(&ctx->scene)) {
        gn_dem_body_groups(ctx, dem, INT32_MAX, body);
        GN_TRY(reassign_patches(ctx, dem, membrane, held, body, error));
        qsort(membrane->patches, membrane->patch_count, sizeof *membrane->patches, by_owner);
    } else {
        gn_free(membrane->patches);
        membrane->patches = NULL;
        membrane->patch_count = 0;
        GN_TRY(make_patches(ctx, dem, membrane, boundary, solids, held, error));
    }
    GN_TRY(gn_membrane_update_areas(ctx, dem, membrane, true, error));
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (!gn_is_loaded(&d->particles, p))
            memcpy(d->particles.applied + 4 * p, d->particles.load + 4 * p,
                   4 * sizeof *d->particles.load);
    return GNEISS_OK;
}

/* Tells whether the patches can stay: all bearers are supported, or a particle has been detached,
 * so that patches are no longer those of the start. */
static bool is_unchanged(const gn_dem *dem, const gn_membrane *membrane, const bool *held) {
    const gn_dem *d = dem;
    bool all = true;
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (gn_is_detached(&d->particles, p)) return true;
    for (size_t k = 0; k < membrane->patch_count; k++) {
        const int32_t at = gn_patch_bearer(d, &membrane->patches[k]);
        all = all && (at < 0 || held[at]);
    }
    return all;
}

gneiss_status gn_membrane_update_bearers(const gn_step_context *ctx, gn_dem *dem,
                                         gn_membrane *membrane, const gn_boundary *boundary,
                                         const gn_solids *solids, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    if (!(ctx->effects & GN_FX_MEMBRANE)) return GNEISS_OK;
    bool *held = gn_alloc_array(n + 1, sizeof *held);
    int32_t *body = gn_alloc_array(n + 1, sizeof *body);
    gneiss_status status = held && body
                               ? gn_membrane_find_supported(ctx, dem, held, error)
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane");
    if (status == GNEISS_OK && !is_unchanged(dem, membrane, held))
        status = redistribute(ctx, dem, membrane, boundary, solids, held, body, error);
    gn_free(held);
    gn_free(body);
    return status;
}
