/* Neighbour lists of the particles, and how contacts keep their history. */
#include "particles/lists.h"
#include "base/error.h"
#include "base/memory.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "kernels/partials.h"
#include "neigh/neigh.h"
#include "particles/active_pairs.h"
#include "particles/bridges.h"
#include "particles/dormant.h"
#include "particles/joint_faces.h"
#include "particles/joints.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "soa/single.h"

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

/* Tells whether the list contains (i, j). *at advances; both lists are sorted. */
static bool walk_to(const gn_contacts *list, size_t *at, int32_t i, int32_t j) {
    while (*at < list->soa.count && comes_before(list, *at, i, j)) (*at)++;
    return *at < list->soa.count && list->i[*at] == i && list->j[*at] == j;
}

/* Removes pairs with a bond, pairs of one clump and, where elements convert, pairs of two dormant
 * particles: their bonds are stored, and their overlap is no contact. */
static void drop_bonded(const gn_step_context *ctx, const gn_dem *dem, gn_pair_list *pairs) {
    if (!dem->bonds.contacts.soa.count && !dem->clumps.count) return;
    size_t kept = 0, at = 0;
    for (size_t c = 0; c < pairs->count; c++) {
        int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        if (walk_to(&dem->bonds.contacts, &at, i, j) || gn_is_hidden_pair(ctx, dem, i, j) ||
            gn_clump_binds(dem, i, j))
            continue;
        pairs->pair[kept][0] = i;
        pairs->pair[kept++][1] = j;
    }
    pairs->count = kept;
}

enum { PART = 512 };

/* Fills up to PART pairs. Parameters depend on the two particles alone, so that a pair of the old
 * list keeps them together with its history. */
static void fill_part(const gn_step_context *ctx, const gn_dem *dem, const gn_pair_list *found,
                      gn_contacts *now, size_t begin, size_t end, size_t *at) {
    int32_t from[PART], *first = now->i, *second = now->j;
    size_t place = *at; /* local copies stay in registers, those of the ends as well */
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

gneiss_status gn_pairs_make(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                            gneiss_error *error) {
    gn_pair_query query = {&dem->particles,
                           (int)ctx->scene.dimension,
                           dem->verlet.skin,
                           fmax(dem->verlet.reach, dem->joint_faces
                                                       ? gn_joint_reach(ctx, dem->joint_faces) - 1.0
                                                       : 0.0),
                           ctx->effects & GN_FX_PERIODIC,
                           {ctx->period[0], ctx->period[1], ctx->period[2]},
                           ctx->threads};
    gn_pair_list found = {0};
    GN_TRY(gn_box_narrowed(ctx, box, gn_pairs_find(&query, &found, error), error));
    gn_contacts now = {0};
    gneiss_status status = gn_joints_renew(ctx, dem, &found, error);
    drop_bonded(ctx, dem, &found);
    if (status == GNEISS_OK)
        status = gn_soa_create(&gn_contact_record, &now, found.count,
                               gn_contact_list_effects(ctx->effects, false), error);
    if (status == GNEISS_OK) {
        fill_pairs(ctx, dem, &found, &now);
        gn_soa_destroy(&gn_contact_record, &dem->pairs.contacts);
        dem->pairs.contacts = now;
        dem->verlet.reach = gn_bridges_reach(ctx, dem);
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

/* Writes the new ends of contacts, which are sorted by their keys, and mirrors contacts whose ends
 * exchanged places; `swapped` [count] is scratch. */
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

/* Returns all bits set if all contacts share the first one's value, else 0. */
static size_t uniform(const double *column, size_t count) {
    if (!column) return 0;
    for (size_t c = 1; c < count; c++)
        if (column[c] != column[0]) return 0;
    return ~(size_t)0;
}

gn_uniform gn_list_find_uniform(const gn_contacts *contacts) {
    size_t n = contacts->soa.count;
#define X(name) .name = uniform(contacts->name, n),
    return (gn_uniform){GN_UNIFORM_COLUMNS(X)};
#undef X
}

void gn_dem_step_changed(const gn_step_context *ctx, gn_dem *dem) {
    if (!(ctx->effects & GN_FX_CONTACT_DAMPING)) return;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_kinds[l]->of_materials)
            gn_contacts_set_dashpots(ctx, dem, &dem->list[l].contacts);
    gn_active_pairs_repack(ctx, dem);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        dem->list[l].uniform = gn_list_find_uniform(&dem->list[l].contacts);
}

void gn_dem_masses_changed(const gn_step_context *ctx, gn_dem *dem) {
    gn_dem_sum_masses(dem);
    gn_dem_step_changed(ctx, dem); /* dashpots */
    gn_particles_to_single(&dem->particles, dem->particles.ref, ctx->threads);
}

void gn_dem_sum_masses(gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    gn_raised_masses *s = &dem->raised;
    dem->mass = s->added = s->largest = 0.0;
    s->count = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_particle_is_active(q, p)) continue; /* removed */
        if (q->clump && q->clump[p] >= 0) continue;
        double own = gn_own_share(q, p), mass = 1.0 / q->vel[4 * p + 3];
        dem->mass += own < 1.0 ? own * mass : mass;
        s->added += (1.0 - own) * mass;
        s->largest = fmax(s->largest, 1.0 / own);
        s->count += own < 1.0;
    }
    for (size_t k = 0; k < dem->clumps.count; k++)
        dem->mass += dem->clumps.clump[k].present * dem->clumps.clump[k].mass;
}
