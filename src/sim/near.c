#include "sim/near.h"

#include "base/memory.h"
#include "sim/internal.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <string.h>

/* --- columns --- */

/* Those that kernels write of pairs. */
#define GN_WRITTEN_COLUMNS(X) X(shear) X(fd) X(closeness) X(roll)

static bool is_uniform(const gn_field *field, const gn_uniform *uniform) {
#define X(column)                                                                                  \
    if (strcmp(field->name, #column) == 0) return uniform->column != 0;
    GN_UNIFORM_COLUMNS(X)
#undef X
    return false;
}

static bool is_written(const gn_field *field) {
#define X(column)                                                                                  \
    if (strcmp(field->name, #column) == 0) return true;
    GN_WRITTEN_COLUMNS(X)
#undef X
    return false;
}

/* What all pairs share is read where it is. */
static void find_columns(gn_near *n, const gn_contacts *list, const gn_uniform *uniform) {
    n->uniform = *uniform;
    n->columns = 0;
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        if (!gn_field_active(field, list->soa.effects) || field->layout != GN_COLUMNS) continue;
        if (field->type != GN_F64 || is_uniform(field, uniform)) continue;
        assert(n->columns < GN_NEAR_COLUMNS);
        n->column[n->columns++] =
            (gn_near_column){field->offset, field->components, is_written(field)};
    }
}

static double *column_of(const gn_contacts *list, const gn_near_column *column) {
    return *(double *const *)(const void *)((const char *)list + column->offset);
}

/* --- whether --- */

static void nearest(const gn_world *w, double d[3]) {
    for (int a = 0; a < 3; a++)
        if (w->period[a] > 0.0) d[a] -= w->period[a] * rint(d[a] / w->period[a]);
}

/* Where three of five touch, finding them costs what it saves. */
static bool sparse(const gn_world *w) {
    const gn_contacts *list = &w->dem.pairs;
    const double *ref = w->dem.particles.ref, *pos = w->dem.particles.pos;
    size_t touching = 0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = 4 * (size_t)list->i[c], j = 4 * (size_t)list->j[c];
        double d[3] = {ref[j] - ref[i], ref[j + 1] - ref[i + 1], ref[j + 2] - ref[i + 2]};
        if (w->effects & GN_FX_PERIODIC) nearest(w, d);
        const double reach = pos[i + 3] + pos[j + 3];
        touching += d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach;
    }
    return 5 * touching < 3 * list->soa.count;
}

/* Where bonds are, unbonded pairs are few. Where something else moves particles (a box, finite
 * elements) the way of a step is more than its velocities. In mixed precision places would be read
 * twice, in either precision. */
static bool worth_while(const gn_world *w) {
    const gn_effects against = GN_FX_BONDS | GN_FX_CONTACT_FORCES | GN_FX_MIXED;
    return !w->dem.near.barred && !(w->effects & against) && !w->scene.has_couple &&
           !gn_box_moves(w) && w->dem.pairs.soa.count && sparse(w);
}

/* --- room --- */

static void free_room(gn_near *n) {
    for (int t = 0; t < n->threads; t++) {
        gn_soa_destroy(&gn_contact_record, &n->room[t].pairs);
        gn_free(n->room[t].act);
        gn_free(n->room[t].place);
    }
    gn_free(n->room);
    n->room = NULL;
    n->threads = 0;
}

void gn_near_free(gn_near *n) {
    free_room(n);
    gn_free(n->touched);
    *n = (gn_near){0};
}

static gneiss_status make_room(gn_world *w, gneiss_error *error) {
    gn_near *n = &w->dem.near;
    const gn_effects effects = w->dem.pairs.soa.effects;
    const size_t most = GN_CONTACT_BLOCK + GN_LANES_MAX;
    if (n->threads == w->threads && n->room[0].pairs.soa.effects == effects) return GNEISS_OK;
    free_room(n);
    n->room = gn_alloc_array((size_t)w->threads, sizeof *n->room);
    if (!n->room) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for pairs that touch");
    n->threads = w->threads;
    for (int t = 0; t < w->threads; t++) {
        gn_near_room *r = &n->room[t];
        GN_TRY(gn_soa_create(&gn_contact_record, &r->pairs, GN_CONTACT_BLOCK, effects, error));
        r->act = gn_alloc_array(most / GN_NEAR_GROUP, sizeof *r->act);
        r->place = gn_alloc_array(most, 2 * sizeof *r->place);
        if (!r->act || !r->place)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for pairs that touch");
    }
    return GNEISS_OK;
}

gneiss_status gn_near_lists(gn_world *w, gneiss_error *error) {
    gn_near *n = &w->dem.near;
    n->on = false;
    if (!worth_while(w)) return GNEISS_OK;
    gn_free(n->touched);
    n->touched =
        gn_alloc_array(w->dem.pairs.soa.capacity / GN_NEAR_GROUP + 1, 2 * sizeof *n->touched);
    if (!n->touched) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for pairs that touch");
    GN_TRY(make_room(w, error));
    find_columns(n, &w->dem.pairs, &w->dem.pair_uniform);
    n->on = n->fresh = true;
    return GNEISS_OK;
}

size_t gn_near_bytes(const gn_world *w) {
    return w->dem.near.on ? 2 * (w->dem.pairs.soa.capacity / GN_NEAR_GROUP) : 0;
}

/* --- which --- */

void gn_near_begin(gn_world *w, const gn_contact_args *pairs) {
    gn_near *n = &w->dem.near;
    if (!n->on) return;
    n->whole = n->fresh || pairs->speed_most <= 0.0;
    n->fresh = false;
    if (memcmp(&n->uniform, &pairs->uniform, sizeof n->uniform) != 0)
        find_columns(n, pairs->contacts, &pairs->uniform);
}

/* Which of the block, into the room; how many. */
static size_t find(gn_world *w, const gn_contact_args *pairs, size_t block, size_t begin,
                   size_t end, const gn_near_room *room) {
    const gn_partials *q = pairs->partials;
    const gn_near_kernels *kernels = w->kernels->near;
    gn_near_args args = {.pos = pairs->pos,
                         .soon = {pairs->vel, pairs->spin},
                         .i = pairs->contacts->i + begin,
                         .j = pairs->contacts->j + begin,
                         .particle = q->particle + q->first[block],
                         .count = end - begin,
                         .particles = (size_t)(q->first[block + 1] - q->first[block]),
                         .wider = 1.0 + 1e-9,
                         .periodic = w->effects & GN_FX_PERIODIC};
    memcpy(args.period, pairs->period, sizeof args.period);
    memcpy(args.inverse_period, pairs->inverse_period, sizeof args.inverse_period);
    const size_t groups = gn_blocks(args.count, GN_NEAR_GROUP);
    uint8_t *touched = w->dem.near.touched + 2 * (begin / GN_NEAR_GROUP);
    if (w->dem.near.whole) memset(touched, 0xff, 2 * groups);
    if (w->dem.near.whole && args.count % GN_NEAR_GROUP)
        memset(touched + 2 * groups - 2, (1 << args.count % GN_NEAR_GROUP) - 1, 2);
    const size_t count = kernels->find(&args, touched, room->act);
    int32_t *i = room->pairs.i, *j = room->pairs.j;
    kernels->pack32(i, args.i, room->act, groups);
    kernels->pack32(j, args.j, room->act, groups);
    kernels->pack32(room->place, q->place + 2 * begin, room->act, groups);
    for (size_t k = count; k % GN_LANES_MAX; k++) {
        i[k] = gn_null_first(&w->dem.particles);
        j[k] = gn_null_second(&w->dem.particles);
    }
    return count;
}

/* --- the kernel on them --- */

/* Columns of the block to the room, with zeros behind them. */
static void fetch(const gn_world *w, const gn_contacts *list, const gn_near_room *room,
                  size_t begin, size_t groups, size_t count) {
    const gn_near *n = &w->dem.near;
    for (int k = 0; k < n->columns; k++)
        for (int a = 0; a < n->column[k].components; a++) {
            double *to =
                column_of(&room->pairs, &n->column[k]) + (size_t)a * room->pairs.soa.capacity;
            const double *from =
                column_of(list, &n->column[k]) + (size_t)a * list->soa.capacity + begin;
            w->kernels->near->pack(to, from, room->act, groups);
            memset(to + count, 0, GN_LANES_MAX * sizeof *to);
        }
}

/* And back. Zeros lose their sign: whether a pair that does not touch was worked on must not show.
 */
static void put(const gn_world *w, const gn_contacts *list, const gn_near_room *room, size_t begin,
                size_t groups) {
    const gn_near *n = &w->dem.near;
    for (int k = 0; k < n->columns; k++)
        for (int a = 0; n->column[k].written && a < n->column[k].components; a++)
            w->kernels->near->unpack(
                column_of(list, &n->column[k]) + (size_t)a * list->soa.capacity + begin,
                column_of(&room->pairs, &n->column[k]) + (size_t)a * room->pairs.soa.capacity,
                room->act, groups);
}

void gn_near_work(gn_world *w, const gn_contact_args *pairs, size_t block, gn_contact_sums *sums) {
    const gn_near *n = &w->dem.near;
    const gn_contacts *list = pairs->contacts;
    const gn_near_room *room = &n->room[omp_get_thread_num()];
    const size_t length = pairs->partials->length, begin = block * length;
    const size_t end = begin + length < list->soa.count ? begin + length : list->soa.count;
    const size_t groups = gn_blocks(end - begin, GN_NEAR_GROUP);
    const size_t count = find(w, pairs, block, begin, end, room);
    gn_contacts part = *list;
    for (int k = 0; k < n->columns; k++)
        *(double **)(void *)((char *)&part + n->column[k].offset) =
            column_of(&room->pairs, &n->column[k]);
    part.soa.count = count;
    part.soa.capacity = room->pairs.soa.capacity;
    part.i = room->pairs.i;
    part.j = room->pairs.j;
    gn_partials partials = *pairs->partials;
    partials.first += block;
    partials.place = room->place;
    gn_contact_args args = *pairs;
    args.contacts = &part;
    args.partials = &partials;
    fetch(w, list, room, begin, groups, count);
    w->dem.pair_kernel(&args, 0, count, sums);
    put(w, list, room, begin, groups);
}
