/* Neighbour lists of the particles, and how contacts keep their history. */
#include "particles/lists.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/surface.h"
#include "boundary/walls.h"
#include "conversion/conversion.h"
#include "frame/ledger.h"
#include "frame/periodic_box.h"
#include "frame/step_context.h"
#include "inflow/removal.h"
#include "kernels/contact.h"
#include "kernels/partials.h"
#include "neigh/pairs.h"
#include "particles/active_pairs.h"
#include "particles/dem.h"
#include "particles/flow.h"
#include "particles/fragments.h"
#include "particles/particles_private.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/field.h"
#include "soa/records.h"
#include "soa/single.h"
#include "timestep/mass_scaling.h"
#include "world/world.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

size_t gn_blocks(size_t count, size_t block) {
    return (count + block - 1) / block;
}

/* --- unbonded pairs --- */

static bool comes_before(const gn_contacts *list, size_t c, int32_t i, int32_t j) {
    return list->i[c] < i || (list->i[c] == i && list->j[c] < j);
}

size_t gn_contacts_from(const gn_contacts *list, int32_t i, int32_t j) {
    size_t low = 0, high = list->soa.count;
    while (low < high) {
        size_t mid = (low + high) / 2;
        if (comes_before(list, mid, i, j))
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

/* Tells whether the list has (i, j), advancing from *at: both lists are sorted. */
static bool walk_to(const gn_contacts *list, size_t *at, int32_t i, int32_t j) {
    while (*at < list->soa.count && comes_before(list, *at, i, j)) (*at)++;
    return *at < list->soa.count && list->i[*at] == i && list->j[*at] == j;
}

/* Those without bonds; where elements convert, those of which one has a part of the body at least:
 * bonds of others sleep, and their overlap, which is all theirs, is no contact. */
static void drop_bonded(const gn_step_context *ctx, const gn_dem *dem, gn_pair_list *pairs) {
    if (!dem->bonds.contacts.soa.count) return;
    size_t kept = 0, at = 0;
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        if (walk_to(&dem->bonds.contacts, &at, i, j) || gn_conversion_hides(ctx, dem, i, j))
            continue;
        pairs->pair[kept][0] = i;
        pairs->pair[kept++][1] = j;
    }
    pairs->count = kept;
}

enum { PART = 512 };

/* Up to PART pairs found. Parameters depend on the two particles alone: a pair that was there keeps
 * them, and its history. */
static void fill_part(const gn_step_context *ctx, const gn_dem *dem, const gn_pair_list *found,
                      gn_contacts *now, size_t begin, size_t end, size_t *at) {
    int32_t from[PART], *first = now->i, *second = now->j;
    size_t place = *at; /* in a register, as the ends are */
    for (size_t c = begin; c < end; c++) {
        int32_t i = first[c] = found->pair[c][0], j = second[c] = found->pair[c][1];
        bool known = walk_to(&dem->pairs.contacts, &place, i, j);
        from[c - begin] = known ? (int32_t)place : -1;
        if (!known) gn_contact_set(ctx, dem, now, c);
    }
    *at = place;
    gn_soa_keep(&gn_contact_record, now, begin, end - begin, &dem->pairs.contacts, from);
}

/* Fills the list from the pairs found; every thread walks through its part of the old list. */
static void fill_pairs(const gn_step_context *ctx, const gn_dem *dem, const gn_pair_list *found,
                       gn_contacts *now) {
#pragma omp parallel num_threads(ctx->threads)
    {
        size_t t = (size_t)omp_get_thread_num(), of = (size_t)omp_get_num_threads();
        size_t begin = found->count * t / of, end = found->count * (t + 1) / of, at = 0;
        if (begin < end)
            at = gn_contacts_from(&dem->pairs.contacts, found->pair[begin][0],
                                  found->pair[begin][1]);
        for (size_t c = begin; c < end; c += PART)
            fill_part(ctx, dem, found, now, c, end - c < PART ? end : c + PART, &at);
    }
}

static gneiss_status make_pairs(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                                gneiss_error *error) {
    gn_pair_query query = {&dem->particles,
                           (int)ctx->scene.dimension,
                           dem->verlet.skin,
                           0.0,
                           ctx->effects & GN_FX_PERIODIC,
                           {ctx->period[0], ctx->period[1], ctx->period[2]},
                           ctx->threads};
    gn_pair_list found = {0};
    GN_TRY(gn_box_narrowed(ctx, box, gn_pairs_find(&query, &found, error), error));
    drop_bonded(ctx, dem, &found);
    gn_contacts now = {0};
    gneiss_status status = gn_soa_create(&gn_contact_record, &now, found.count,
                                         gn_contact_list_effects(ctx->effects, false), error);
    if (status == GNEISS_OK) {
        fill_pairs(ctx, dem, &found, &now);
        gn_soa_destroy(&gn_contact_record, &dem->pairs.contacts);
        dem->pairs.contacts = now;
        status = gn_list_changed(ctx, dem, &dem->pairs, error);
    }
    gn_pair_list_free(&found);
    return status;
}

static gn_effects pair_effects(gn_effects scene_effects) {
    return gn_contact_list_effects(scene_effects, false);
}

const gn_list_kind gn_list_kind_pairs = {
    .record = "pairs", .of_materials = true, .effects_of = pair_effects};

/* --- order --- */

static int by_pair(const void *a, const void *b) {
    const gn_renamed *x = a, *y = b;
    if (x->i != y->i) return x->i < y->i ? -1 : 1;
    return (x->j > y->j) - (x->j < y->j);
}

gneiss_status gn_sort_renamed(const gn_record *record, void *list, void *now, gn_renamed *keys,
                              gneiss_error *error) {
    const gn_soa head = *(const gn_soa *)list;
    int32_t *order = gn_alloc_array(head.count + 1, sizeof *order);
    if (!order)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu contacts", head.count);
    gneiss_status status = gn_soa_create(record, now, head.count, head.effects, error);
    if (status == GNEISS_OK) {
        qsort(keys, head.count, sizeof *keys, by_pair);
        for (size_t c = 0; c < head.count; c++) order[c] = keys[c].place;
        gn_soa_permute(record, now, list, order);
        gn_soa_destroy(record, list);
    }
    gn_free(order);
    return status;
}

/* Contacts sorted by their new keys take these, and those whose ends changed places are mirrored;
 * `swapped` [count] is scratch. */
static void take_keys(gn_contacts *list, const gn_renamed *keys, int32_t *swapped) {
    size_t turned = 0;
    for (size_t c = 0; c < list->soa.count; c++) {
        list->i[c] = keys[c].i;
        list->j[c] = keys[c].j;
        swapped[turned] = (int32_t)c;
        turned += keys[c].swapped;
    }
    gn_soa_mirror(&gn_contact_record, list, swapped, turned);
}

gneiss_status gn_contacts_rename(gn_contacts *list, const int32_t *place, gneiss_error *error) {
    size_t count = list->soa.count;
    gn_renamed *keys = gn_alloc_array(count + 1, sizeof *keys);
    int32_t *swapped = gn_alloc_array(count + 1, sizeof *swapped);
    gneiss_status status = GNEISS_OK;
    if (!keys || !swapped)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu contacts", count);
    for (size_t c = 0; status == GNEISS_OK && c < count; c++) {
        int32_t i = list->i[c], j = list->j[c];
        if (place) i = place[i], j = place[j];
        keys[c] = (gn_renamed){i < j ? i : j, i < j ? j : i, (int32_t)c, i > j};
    }
    gn_contacts now = {0};
    if (status == GNEISS_OK) status = gn_sort_renamed(&gn_contact_record, list, &now, keys, error);
    if (status == GNEISS_OK) {
        take_keys(&now, keys, swapped);
        *list = now;
    }
    gn_free(keys);
    gn_free(swapped);
    return status;
}

void gn_dem_null_particles(const gn_step_context *ctx, gn_dem *dem) {
    double apart = INFINITY;
    for (int a = 0; a < 2; a++)
        if (gn_scene_periodic_along(&ctx->scene, a)) apart = fmin(apart, ctx->period[a]);
    gn_particles_set_null(&dem->particles, isfinite(apart) ? 0.25 * apart : 1.0);
}

void gn_dem_number_ids(gn_dem *dem) {
    for (int64_t k = 0; k < dem->ids; k++) dem->index_of_id[k] = -1;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        dem->index_of_id[dem->particles.id[p]] = (int32_t)p;
}

/* Sorts particles along the Morton curve and renumbers everything that points at them. */
static gneiss_status reorder(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gneiss_error *error) {
    size_t n = dem->particles.soa.count;
    int32_t *order = gn_alloc_array(n + 1, sizeof *order),
            *place = gn_alloc_array(n + 1, sizeof *place);
    gn_particles now = {0};
    gneiss_status status =
        order && place ? gn_morton_order(&dem->particles, (int)ctx->scene.dimension, order, error)
                       : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu particles", n);
    if (status == GNEISS_OK)
        status = gn_soa_create(&gn_particle_record, &now, n, ctx->effects, error);
    if (status == GNEISS_OK) {
        gn_soa_permute(&gn_particle_record, &now, &dem->particles, order);
        gn_soa_destroy(&gn_particle_record, &dem->particles);
        dem->particles = now;
        gn_dem_null_particles(ctx, dem);
        for (size_t p = 0; p < n; p++) place[order[p]] = (int32_t)p;
        gn_dem_number_ids(dem);
    }
    if (status == GNEISS_OK) status = gn_lists_follow_rows(ctx, dem, place, error);
    if (status == GNEISS_OK) status = gn_boundary_renumber(boundary, place, error);
    gn_free(order);
    gn_free(place);
    return status;
}

/* --- periodic box --- */

static void wrap(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            if (!gn_scene_periodic_along(&ctx->scene, a)) continue;
            double shift = floor((q->pos[4 * p + a] - ctx->scene.periodic_min[a]) / ctx->period[a]);
            q->pos[4 * p + a] -= shift * ctx->period[a];
            q->start[4 * p + a] -= shift * ctx->period[a]; /* displacements stay continuous */
        }
}

/* --- the lists --- */

/* Allocates the sums of blocks and distributes the blocks of the lists among threads. */
static gneiss_status ready_blocks(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    bool held = true;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        gn_contact_list *list = &dem->list[l];
        if (!list->sums) list->sums = gn_alloc_array(list->partials.blocks + 1, sizeof *list->sums);
        held = held && list->sums;
    }
    if (!dem->motion_sums) {
        dem->motion_blocks = gn_blocks(dem->particles.soa.count, GN_PARTICLE_BLOCK);
        dem->motion_sums = gn_alloc_array(dem->motion_blocks + 1, sizeof *dem->motion_sums);
        GN_TRY(gn_hold_create(&dem->hold, dem->motion_blocks, error));
    }
    bool confined = ctx->effects & GN_FX_CONFINED;
    if (confined && !dem->around)
        dem->around = gn_alloc_array(dem->particles.soa.count + 1, 2 * sizeof(double));
    if (!held || !dem->motion_sums || (confined && !dem->around))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for block sums");
    gn_dem_sum_masses(dem);
    if (gn_converts(ctx)) GN_TRY(gn_conversion_find_still(dem, error));
    return gn_dem_deal(dem, error);
}

/* Particles that flow are sorted again now and then; a bonded specimen by itself keeps its order.
 * The decision rests on counts alone, so that it falls at the same step in every run. */
static bool order_is_old(const gn_step_context *ctx, const gn_dem *dem) {
    enum { REBUILDS_PER_SORT = 16 };
    return (!(ctx->effects & GN_FX_BONDS) || gn_scene_has_flow(&ctx->scene)) &&
           dem->verlet.rebuilds > 0 && dem->verlet.rebuilds % REBUILDS_PER_SORT == 0;
}

/* A particle must not have two images of another within reach. */
static double widest_skin(const gn_step_context *ctx, const gn_dem *dem) {
    double radius = 0.0, widest = INFINITY;
    if (!(ctx->effects & GN_FX_PERIODIC)) return widest;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        radius = fmax(radius, dem->particles.pos[4 * p + 3]);
    for (int a = 0; a < 3; a++)
        if (ctx->period[a] > 0.0)
            widest = fmin(widest, (0.5 * ctx->period[a] - 2.0 * radius) * (1.0 - 1e-9));
    return fmax(widest, dem->verlet.skin);
}

/* A rebuild costs about as much as fifteen steps, so lists that live for less than 150 cost more
 * than a tenth of the run: the skin grows. Lists that live long may be needlessly wide: it shrinks
 * again. Steps and not seconds decide, so that every run does the same; forces do not depend on the
 * skin at all. */
static void tune_skin(const gn_step_context *ctx, gn_dem *dem) {
    enum { SHORT_LIFE = 160, LONG_LIFE = 2000 };
    if (ctx->scene.skin > 0.0 || dem->verlet.rebuilds == 0 || dem->flow.forced) return;
    int64_t life = ctx->step - dem->verlet.last_step;
    double most = fmin(6.0 * dem->verlet.skin_start, widest_skin(ctx, dem));
    if (life < SHORT_LIFE) dem->verlet.skin = fmin(1.25 * dem->verlet.skin, most);
    if (life > LONG_LIFE) dem->verlet.skin = fmax(0.8 * dem->verlet.skin, dem->verlet.skin_start);
}

static double largest_speed(const double *rows, size_t count) {
    double most = 0.0;
    for (size_t p = 0; p < count; p++) most = fmax(most, gn_dot3(rows + 4 * p, rows + 4 * p));
    return sqrt(most);
}

static double surface_speed(const gn_boundary *boundary, const gn_surface *s) {
    if (s->body < 0) return largest_speed(s->velocity, s->vertices);
    const gn_rigid *b = &boundary->bodies[s->body];
    return sqrt(gn_dot3(b->velocity, b->velocity)) + b->reach * sqrt(gn_dot3(b->spin, b->spin));
}

/* By how much two things that may touch moved apart in the last step, at most. */
static double widest_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_periodic_box *box) {
    double own = largest_speed(dem->particles.vel, dem->particles.soa.count), other = own;
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        const gn_wall *wall = &boundary->walls[k];
        other = fmax(other, fabs(gn_dot3(wall->velocity, wall->normal)));
    }
    for (size_t k = 0; k < boundary->surface_count; k++)
        other = fmax(other, surface_speed(boundary, &boundary->surfaces[k]));
    return ctx->dt_past * (own + other + gn_box_speed(box)) * (1.0 + 1e-6);
}

/* Whatever was in touch a step ago has to be listed: its contact acted for a part of the step. */
static void widen_skin(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                       const gn_periodic_box *box) {
    gn_verlet *q = &dem->verlet;
    bool given = ctx->scene.skin > 0.0;
    if (given) q->skin = ctx->scene.skin;
    double needed = fmin(widest_gap(ctx, dem, boundary, box), widest_skin(ctx, dem));
    if (!(needed > q->skin)) return;
    q->skin = needed;
    if (given) q->widened = fmax(q->widened, needed);
}

/* All ones if all contacts share the first one's value. */
static size_t uniform(const double *column, size_t count) {
    if (!column) return 0;
    for (size_t c = 1; c < count; c++)
        if (column[c] != column[0]) return 0;
    return ~(size_t)0;
}

static gn_uniform find_uniform(const gn_contacts *k) {
    size_t n = k->soa.count;
#define X(name) .name = uniform(k->name, n),
    return (gn_uniform){GN_UNIFORM_COLUMNS(X)};
#undef X
}

void gn_dem_step_changed(const gn_step_context *ctx, gn_dem *dem) {
    if (!(ctx->effects & GN_FX_CONTACT_DAMPING)) return;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_kinds[l]->of_materials)
            gn_contacts_set_dashpots(ctx, dem, &dem->list[l].contacts);
    gn_near_repack(ctx, dem);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        dem->list[l].uniform = find_uniform(&dem->list[l].contacts);
}

/* Prepares the data that kernels read besides the records, once lists and `ref` are complete. */
static void ready_kernels(const gn_step_context *ctx, gn_dem *dem) {
    double period[3] = {0, 0, 0};
    if (ctx->effects & GN_FX_PERIODIC) memcpy(period, ctx->period, sizeof period);
    gn_particles_to_single(&dem->particles, dem->particles.ref, ctx->threads);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        dem->list[l].uniform = find_uniform(&dem->list[l].contacts);
        gn_contacts_to_single(&dem->list[l].contacts, &dem->particles, period, ctx->threads);
    }
}

void gn_dem_masses_changed(const gn_step_context *ctx, gn_dem *dem) {
    gn_dem_sum_masses(dem);
    gn_dem_step_changed(ctx, dem); /* dashpots */
    gn_particles_to_single(&dem->particles, dem->particles.ref, ctx->threads);
}

gneiss_status gn_dem_arrange(gn_world *w, gneiss_error *error) {
    GN_TRY(gn_dem_check_domain(w, error));
    if (w->ctx.effects & GN_FX_PERIODIC) wrap(&w->ctx, &w->dem);
    GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_lists_form(&w->ctx, &w->dem, error));
    return gn_converts(&w->ctx) ? gn_conversion_lay_down(&w->ctx, &w->dem, &w->boundary, &w->solids,
                                                         &w->zones, error)
                                : GNEISS_OK;
}

gneiss_status gn_dem_refresh(gn_world *w, gneiss_error *error) {
    gn_near_repack(&w->ctx, &w->dem);
    tune_skin(&w->ctx, &w->dem);
    widen_skin(&w->ctx, &w->dem, &w->boundary, &w->box);
    GN_TRY(gn_dem_drop(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_dem_check_domain(w, error));
    if (w->ctx.effects & GN_FX_PERIODIC) wrap(&w->ctx, &w->dem);
    GN_TRY(gn_flow_arrive(&w->ctx, &w->dem, &w->boundary, &w->ledger, false, error));
    if (order_is_old(&w->ctx, &w->dem)) GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(make_pairs(&w->ctx, &w->dem, &w->box, error));
    GN_TRY(ready_blocks(&w->ctx, &w->dem, error));
    memcpy(w->dem.particles.ref, w->dem.particles.pos,
           w->dem.particles.soa.count * 4 * sizeof(double));
    ready_kernels(&w->ctx, &w->dem);
    GN_TRY(gn_near_lists(&w->ctx, &w->dem, &w->box, error));
    w->dem.verlet.drift = w->dem.verlet.closed = 0.0;
    w->dem.verlet.rebuilds++;
    w->dem.verlet.last_step = w->ctx.step;
    gn_sinks_listed(&w->ctx, &w->dem);
    gn_box_listed(&w->ctx, &w->dem, &w->box);
    gn_walls_listed(&w->ctx, &w->dem, &w->boundary);
    return GNEISS_OK;
}

gneiss_status gn_dem_restore(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                             gneiss_error *error) {
    gn_dem_null_particles(ctx, dem);
    dem->index_of_id = gn_alloc_array((size_t)dem->ids + 1, sizeof *dem->index_of_id);
    if (!dem->index_of_id)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for particle numbers");
    GN_TRY(gn_pieces_create(ctx, dem, error));
    gn_dem_number_ids(dem);
    for (int l = 0; l < GN_LIST_COUNT; l++) GN_TRY(gn_list_changed(ctx, dem, &dem->list[l], error));
    ready_kernels(ctx, dem);
    GN_TRY(ready_blocks(ctx, dem, error));
    gn_sinks_listed(ctx, dem);
    GN_TRY(gn_near_lists(ctx, dem, box, error));
    return gn_near_resume(dem, error);
}
