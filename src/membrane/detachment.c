/* Transfers the surface of detached particles to those beneath. The faces of the cell of a detached
 * particle towards the remaining particles become surface. Their vector sum is the area that the
 * particle carried, so that the surface remains closed, encloses the remaining particles, and
 * follows them. All positions are those at the start. */
#include "base/new.h"
#include "membrane/membrane.h"

#include "base/error.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "membrane/cells.h"
#include "particles/fragments.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* Sizes in mean radii: cells of grids, largest distance of a point of a cell from its particle,
 * voxels. */
static const double cell_size = 2.5, around = 1.0, voxel = 0.25;

/* Markers in the size column of q->skin for detached particles: inside the body, without surface,
 * and to be detached now. A loose particle that others covered until now is marked as inside: the
 * membrane does not reach into closed cavities. Its share of the surface passes to particles
 * beneath. */
static const double inside = -1.0, bare = -2.0, going = -3.0;

enum { NONE = -1, PLANES = 8 };

/* Patches during their transfer, as lists for each particle. */
typedef struct transfer {
    const gn_step_context *ctx;
    gn_dem *dem;
    gn_membrane *membrane;
    gn_start_grid left, all;
    bool *of; /* [particles] true: remains */
    gn_cell cell;
    gn_patch *patch;
    int32_t *next, *head; /* [capacity] next patch of the particle, [particles] its first patch */
    size_t count, capacity;
} transfer;

/* Tells whether a particle is farther than its radius from its position on the moving skin. By this
 * condition a particle that was never supported is detached, and a gap of the packing does not
 * detach one. */
static bool has_left(const gn_dem *dem, const double mean[3], size_t p) {
    const gn_particles *q = &dem->particles;
    double way[3];
    for (int a = 0; a < 3; a++) way[a] = q->pos[4 * p + a] - q->start[4 * p + a] - mean[a];
    return gn_dot3(way, way) > q->pos[4 * p + 3] * q->pos[4 * p + 3];
}

/* Computes the mean displacement of the particles of the skin. */
static void mean_way(const gn_particles *q, double mean[3]) {
    double count = 0.0;
    for (int a = 0; a < 3; a++) mean[a] = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_loaded(q, p)) continue;
        for (int a = 0; a < 3; a++) mean[a] += q->pos[4 * p + a] - q->start[4 * p + a];
        count += 1.0;
    }
    for (int a = 0; a < 3 && count > 0.0; a++) mean[a] /= count;
}

/* Marks detached particles, permanently: none of them is loaded again. Returns whether there are
 * newly detached ones. */
static bool mark_detached(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    const int32_t *members = gn_dem_body_sizes(ctx, dem);
    const bool loosened = gn_dem_has_loosened(dem);
    int32_t largest = 0;
    bool found = false;
    double mean[3];
    mean_way(q, mean);
    for (size_t p = 0; members && p < q->soa.count; p++)
        largest = members[p] > largest ? members[p] : largest;
    for (size_t p = 0; p < q->soa.count; p++) {
        bool off = !gn_particle_is_active(q, p) || (members && GN_CHIP * members[p] < largest &&
                                                    (loosened || has_left(dem, mean, p)));
        if (!off || gn_is_detached(q, p)) continue;
        memset(q->skin + 4 * p, 0, 3 * sizeof *q->skin);
        q->skin[4 * p + 3] = going;
        memcpy(q->applied + 4 * p, q->load + 4 * p, 4 * sizeof *q->load);
        found = true;
    }
    return found;
}

/* --- transfer of patches --- */

static void free_transfer(transfer *h) {
    gn_start_grid_free(&h->left);
    gn_start_grid_free(&h->all);
    gn_cell_free(&h->cell);
    gn_free(h->patch);
    gn_free(h->next);
    gn_free(h->head);
    gn_free(h->of);
}

static gneiss_status make_room(transfer *h, size_t capacity, gneiss_error *error) {
    if (!gn_widen(&h->patch, h->count, capacity, sizeof *h->patch) ||
        !gn_widen(&h->next, h->count, capacity, sizeof *h->next))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a membrane of %zu patches",
                       capacity);
    h->capacity = capacity;
    return GNEISS_OK;
}

static double length(const double a[3]) {
    return sqrt(gn_dot3(a, a));
}

static void put_in(transfer *h, int32_t p, size_t k) {
    h->next[k] = h->head[p];
    h->head[p] = (int32_t)k;
}

/* Adds a patch to particle p, which then belongs to the skin. */
static gneiss_status add_patch(transfer *h, int32_t p, const gn_patch *patch, gneiss_error *error) {
    double *size = &h->dem->particles.skin[4 * (size_t)p + 3];
    if (*size == 0.0) *size = length(patch->area);
    if (h->count == h->capacity) GN_TRY(make_room(h, 2 * h->capacity + 64, error));
    h->patch[h->count] = *patch;
    put_in(h, p, h->count++);
    return GNEISS_OK;
}

static gneiss_status collect_patches(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                     transfer *h, gneiss_error *error) {
    const gn_dem *d = dem;
    const size_t n = d->particles.soa.count;
    const double radius = gn_dem_mean_radius(dem);
    GN_TRY(gn_new(&h->of, n + 1, "the skin of particles", error));
    for (size_t p = 0; p < n; p++) h->of[p] = !gn_is_detached(&d->particles, p);
    GN_TRY(gn_start_grid_make(ctx, dem, cell_size * radius, h->of, &h->left, error));
    GN_TRY(gn_start_grid_make(ctx, dem, cell_size * radius, NULL, &h->all, error));
    h->cell = (gn_cell){.all = &h->all, .around = around * radius, .width = voxel * radius};
    GN_TRY(gn_new(&h->head, n + 1, "the skin of particles", error));
    GN_TRY(make_room(h, membrane->patch_count + 64, error));
    for (size_t p = 0; p < n; p++) h->head[p] = NONE;
    for (size_t k = membrane->patch_count; k-- > 0;) {
        const int32_t at = gn_patch_bearer(d, &membrane->patches[k]);
        if (at >= 0) GN_TRY(add_patch(h, at, &membrane->patches[k], error));
    }
    return GNEISS_OK;
}

/* Stores the patches in the world, sorted by particles. */
static gneiss_status store_patches(const transfer *h, gneiss_error *error) {
    const gn_particles *q = &h->dem->particles;
    gn_membrane *membrane = h->membrane;
    gn_patch *patches = NULL;
    GN_TRY(gn_new(&patches, h->count + 1, "a membrane", error));
    membrane->patch_count = 0;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int32_t k = h->head[p]; k != NONE; k = h->next[k]) {
            patches[membrane->patch_count] = h->patch[k];
            patches[membrane->patch_count++].owner = q->id[p];
        }
    gn_free(membrane->patches);
    membrane->patches = patches;
    return GNEISS_OK;
}

/* --- particles that receive patches --- */

static gneiss_status give(transfer *h, int32_t p, const gn_patch *patch, gneiss_error *error) {
    if (h->dem->particles.skin[4 * (size_t)p + 3] == inside)
        p = gn_start_grid_nearest(&h->left, patch->point, patch->area);
    return p < 0 ? GNEISS_OK : add_patch(h, p, patch, error);
}

/* Finds the planes of the surface at a particle, from its original patches. */
static size_t planes_at(const transfer *h, size_t p, double (*plane)[4]) {
    size_t count = 0;
    for (int32_t k = h->head[p]; k != NONE && count < PLANES; k = h->next[k]) {
        const gn_patch *patch = &h->patch[k];
        const double size = length(patch->area);
        if (!(patch->size > 0.0 && size > 0.0)) continue;
        for (int a = 0; a < 3; a++) plane[count][a] = patch->area[a] / size;
        plane[count][3] = gn_dot3(plane[count], patch->point);
        count++;
    }
    return count;
}

/* Adds an area, and area times position. */
static void add_sums(const gn_patch *patch, double sign, double area[3], double arms[9]) {
    for (int a = 0; a < 3; a++) area[a] += sign * patch->area[a];
    for (int k = 0; k < 9; k++)
        arms[k] += sign * (patch->area[k / 3] * patch->point[k % 3] + patch->rest[k]);
}

/* Transfers the faces to the neighbours, except to those whose own cell is exposed; `area` and
 * `arms` are reduced by the transferred ones. */
static gneiss_status give_faces(transfer *h, double area[3], double arms[9], gneiss_error *error) {
    const double *skin = h->dem->particles.skin;
    for (size_t f = 0; f < h->cell.count; f++) {
        const gn_cell_face *face = &h->cell.face[f];
        gn_patch patch = {.size = 0.0};
        if (!(face->sum > 0.0) || skin[4 * (size_t)face->particle + 3] == bare) continue;
        if (!gn_membrane_covers(h->ctx, face->area)) continue;
        for (int a = 0; a < 3; a++) {
            patch.area[a] = -face->area[a];
            patch.point[a] = face->point[a];
        }
        add_sums(&patch, -1.0, area, arms);
        GN_TRY(give(h, face->particle, &patch, error));
    }
    return GNEISS_OK;
}

/* Distributes the remaining area and moment over the skin. The faces of a cell are closed, so that
 * the area of its particle equals the sum and the moment of the faces that become surface, except
 * for differences due to voxels and a non-planar surface. */
static void keep_sums(gn_membrane_state *m, const double area[3], const double arms[9]) {
    for (int a = 0; a < 3; a++) m->missing[a] += area[a];
    for (int k = 0; k < 9; k++) m->rest[k] += 0.5 * (arms[k] - arms[k % 3 * 3 + k / 3]);
}

static gneiss_status expose_faces(transfer *h, size_t p, gneiss_error *error) {
    gn_particles *q = &h->dem->particles;
    double plane[PLANES][4], area[3] = {0}, arms[9] = {0};
    const size_t planes = planes_at(h, p, plane);
    for (int32_t k = h->head[p]; k != NONE; k = h->next[k]) add_sums(&h->patch[k], 1.0, area, arms);
    GN_TRY(gn_cell_find(&h->cell, (int)h->ctx->scene.dimension, p, planes, plane, error));
    h->head[p] = NONE;
    q->skin[4 * p + 3] = bare;
    GN_TRY(give_faces(h, area, arms, error));
    keep_sums(h->membrane->state, area, arms);
    return GNEISS_OK;
}

/* Transfers the patches of detached particles in the order of their indices, repeatedly while one
 * of them has received a patch. */
static gneiss_status transfer_patches(transfer *h, gneiss_error *error) {
    gn_dem *d = h->dem;
    double *skin = d->particles.skin;
    for (bool more = true; more;) {
        more = false;
        for (int64_t id = 0; id < d->ids; id++) {
            const int32_t p = d->index_of_id[id];
            if (p < 0 || skin[4 * (size_t)p + 3] != going || h->head[p] == NONE) continue;
            GN_TRY(expose_faces(h, (size_t)p, error));
            more = true;
        }
    }
    for (size_t p = 0; p < d->particles.soa.count; p++)
        if (skin[4 * p + 3] == going) skin[4 * p + 3] = inside;
    return GNEISS_OK;
}

gneiss_status gn_membrane_detach(const gn_step_context *ctx, gn_dem *dem, gn_membrane *membrane,
                                 bool *dropped, gneiss_error *error) {
    transfer h = {.ctx = ctx, .dem = dem, .membrane = membrane};
    *dropped = mark_detached(ctx, dem);
    if (!*dropped) return GNEISS_OK;
    gneiss_status status = collect_patches(ctx, dem, membrane, &h, error);
    if (status == GNEISS_OK) status = transfer_patches(&h, error);
    if (status == GNEISS_OK) status = store_patches(&h, error);
    free_transfer(&h);
    return status;
}
