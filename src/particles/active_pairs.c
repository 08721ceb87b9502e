#include "particles/active_pairs.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "kernels/near.h"
#include "kernels/partials.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "soa/field.h"
#include "soa/records.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* --- columns --- */

static bool is_uniform(const gn_field *field, const gn_uniform *uniform) {
#define X(column)                                                                                  \
    if (strcmp(field->name, #column) == 0) return uniform->column != 0;
    GN_UNIFORM_COLUMNS(X)
#undef X
    return false;
}

static bool is_written(const gn_field *field) {
    return field->role == GN_STATE || field->care & GN_WRITTEN;
}

/* Finds the columns to pack. A parameter that all pairs share is read from the list itself. */
static void find_columns(gn_active_pairs *near, const gn_contacts *list,
                         const gn_uniform *uniform) {
    size_t stream = 0;
    near->uniform = *uniform;
    near->columns = 0;
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        if (!gn_field_active(field, list->soa.effects) || field->layout != GN_COLUMNS) continue;
        if (field->type != GN_F64 || is_uniform(field, uniform)) continue;
        assert(near->columns < GN_ACTIVE_PAIRS_COLUMNS);
        near->column[near->columns++] =
            (gn_active_pairs_column){field->offset, field->components, is_written(field), stream};
        stream += (size_t)field->components;
    }
}

/* Returns the number of doubles per pair. */
static size_t streams_of(const gn_active_pairs *near) {
    if (!near->columns) return 0;
    const gn_active_pairs_column *last = &near->column[near->columns - 1];
    return last->stream + (size_t)last->components;
}

static double *column_of(const gn_contacts *list, const gn_active_pairs_column *column) {
    return *(double *const *)(const void *)((const char *)list + column->offset);
}

/* --- whether packing pays --- */

static void nearest(const gn_step_context *ctx, double d[3]) {
    for (int a = 0; a < 3; a++)
        if (ctx->period[a] > 0.0) d[a] -= ctx->period[a] * rint(d[a] / ctx->period[a]);
}

/* Tells whether few enough pairs touch: if three of five do, the search costs as much as it saves.
 */
static bool sparse(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *list = &dem->pairs.contacts;
    const double *ref = dem->particles.ref, *pos = dem->particles.pos;
    size_t touching = 0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = 4 * (size_t)list->i[c], j = 4 * (size_t)list->j[c];
        double d[3] = {ref[j] - ref[i], ref[j + 1] - ref[i + 1], ref[j + 2] - ref[i + 2]};
        if (ctx->effects & GN_FX_PERIODIC) nearest(ctx, d);
        const double reach = pos[i + 3] + pos[j + 3];
        touching += d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach;
    }
    return 5 * touching < 3 * list->soa.count;
}

/* Tells whether active pairs may be used. With bonds, unbonded pairs are few; if other parts move
 * particles (a box, finite elements), the path of a step exceeds velocity times dt; in mixed
 * precision positions would be read in both precisions. */
static bool worth_while(const gn_step_context *ctx, const gn_dem *dem, const gn_periodic_box *box) {
    const gn_effects against = GN_FX_BONDS | GN_FX_CONTACT_FORCES | GN_FX_MIXED;
    return !dem->near.disabled && !(ctx->effects & against) && !ctx->scene.has_couple &&
           !gn_box_moves(ctx, box) && dem->pairs.contacts.soa.count && sparse(ctx, dem);
}

/* --- allocation --- */

enum { STEPS_AT_FIRST = 4 };

static void free_room(gn_active_pairs *near) {
    gn_free(near->i);
    gn_free(near->j);
    gn_free(near->place);
    gn_free(near->data);
    gn_free(near->act);
    gn_free(near->count);
    near->i = near->j = near->count = NULL;
    near->place = NULL;
    near->data = NULL;
    near->act = NULL;
    near->room = 0;
}

void gn_active_pairs_free(gn_active_pairs *near) {
    free_room(near);
    gn_free(near->kept_act);
    gn_free(near->kept_paths);
    gn_free(near->paths);
    *near = (gn_active_pairs){0};
}

/* Allocates the arrays. Every block ends with padding for vectors that extend past its last pair.
 */
static gneiss_status make_room(gn_dem *dem, gneiss_error *error) {
    gn_active_pairs *n = &dem->near;
    const gn_partials *q = &dem->pairs.partials;
    n->stride = q->length + GN_LANES_MAX;
    n->blocks = q->blocks;
    const size_t needed = n->blocks * n->stride, streams = streams_of(n);
    if (needed <= n->room && streams <= n->streams) return GNEISS_OK;
    free_room(n);
    n->room = needed + needed / 8; /* rebuilt lists differ little in length */
    n->streams = streams;
    n->i = gn_alloc_array_raw(n->room, sizeof *n->i);
    n->j = gn_alloc_array_raw(n->room, sizeof *n->j);
    n->place = gn_alloc_array_raw(n->room, 2 * sizeof *n->place);
    n->data = gn_alloc_array_raw(n->room, (streams + 1) * sizeof *n->data);
    n->act = gn_alloc_array_raw(n->room / GN_NEAR_GROUP + 1, sizeof *n->act);
    n->count = gn_alloc_array_raw(n->room / GN_CONTACT_BLOCK_LEAST + 1, sizeof *n->count);
    if (n->i && n->j && n->place && n->data && n->act && n->count) return GNEISS_OK;
    free_room(n);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for pairs that touch");
}

static gneiss_status make_paths(gn_dem *dem, gneiss_error *error) {
    gn_active_pairs *n = &dem->near;
    if (n->paths && n->path_count == dem->motion_blocks) return GNEISS_OK;
    gn_free(n->paths);
    n->path_count = dem->motion_blocks;
    n->paths = gn_alloc_array(n->path_count + 1, sizeof *n->paths);
    if (n->paths) return GNEISS_OK;
    n->path_count = 0;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for pairs that touch");
}

gneiss_status gn_active_pairs_choose(const gn_step_context *ctx, gn_dem *dem,
                                     const gn_periodic_box *box, gneiss_error *error) {
    gn_active_pairs *n = &dem->near;
    n->on = n->packed = false;
    if (!worth_while(ctx, dem, box)) return GNEISS_OK;
    GN_TRY(make_paths(dem, error));
    find_columns(n, &dem->pairs.contacts,
                 &(gn_uniform){0}); /* more columns than these are never needed */
    GN_TRY(make_room(dem, error));
    find_columns(n, &dem->pairs.contacts, &dem->pairs.uniform);
    n->listed = (double)dem->pairs.contacts.soa.count;
    n->cost = INFINITY;
    if (!n->steps) n->steps = STEPS_AT_FIRST;
    if (!n->towards) n->towards = 1;
    n->on = n->fresh = true;
    return GNEISS_OK;
}

size_t gn_active_pairs_bytes(const gn_dem *dem) {
    const gn_active_pairs *n = &dem->near;
    const size_t each = sizeof *n->i + sizeof *n->j + 2 * sizeof *n->place;
    return n->room * (each + n->streams * sizeof *n->data) + n->room / GN_NEAR_GROUP;
}

/* --- times of searches --- */

/* Factor that covers rounding. */
static const double more = 1.0 + 1e-6;

/* Returns the path in `steps` steps if the path per step continues to grow by `change` per step. */
static double drift(const gn_active_pairs_past *past, double change, int steps) {
    return past->dt[0] * change * (1.0 + 0.5 * steps * (steps + 1.0));
}

static double largest_change(const gn_active_pairs *near) {
    double most = 0.0;
    for (size_t b = 0; b < near->path_count; b++) most = fmax(most, near->paths[b].last);
    return most;
}

/* Begins a span: the pairs found now must be valid for `steps` steps, under the assumption that
 * velocities change per step by up to 1.5 times as much as in the last one. In a quiet system a
 * collision may begin, but rarely with the largest change of all. */
static void begin_span(gn_active_pairs *near, int steps) {
    static const double reserve = 1.5, of_largest = 0.2;
    const double least = of_largest * largest_change(near);
    const gn_active_pairs_past *past = &near->past;
    for (size_t b = 0; b < near->path_count; b++) {
        const double last = near->paths[b].last, before = past->dt[1] * last;
        const double soon = reserve * drift(past, fmax(last, least), steps);
        near->paths[b] = (gn_near_path){.margin = more * fmax(soon, before), .last = last};
    }
    near->span = (gn_active_pairs_span){.ahead = more * steps * past->dt[0]};
}

/* A search costs about half as much as the kernel for the same number of pairs; the longer its
 * result has to be valid, the more of the pairs found do not touch. The number of steps with the
 * least total cost is found by increasing and decreasing it. Cost is counted in pairs, not in
 * seconds. */
static void tune_steps(gn_active_pairs *near) {
    enum { MOST = 64 };
    static const double look = 0.5; /* relative cost of the search for a pair, the kernel being 1 */
    double act = 0.0;
    for (size_t b = 0; b < near->blocks; b++) act += near->count[b];
    const double cost = act + look * near->listed / fmax(near->span.steps, 1.0);
    if (cost > near->cost) near->towards = -near->towards;
    near->cost = cost;
    near->steps += near->towards;
    if (near->steps < 1) near->steps = 1;
    if (near->steps > MOST) near->steps = MOST;
}

/* If velocities were set otherwise, they do not show which pairs touched a step ago, and all pairs
 * are processed. So are all pairs of new lists once: it makes zeros positive whose sign changed
 * when the ends were exchanged, see put. */
void gn_active_pairs_begin(const gn_step_context *ctx, gn_dem *dem, const gn_contact_args *pairs) {
    gn_active_pairs *n = &dem->near;
    if (pairs->speed_most <= 0.0) gn_active_pairs_forget(ctx, dem);
    if (!n->on) return;
    if (memcmp(&n->uniform, &pairs->uniform, sizeof n->uniform) != 0) {
        if (!n->again) gn_active_pairs_repack(ctx, dem); /* otherwise no pair is packed yet */
        find_columns(n, pairs->contacts, &pairs->uniform);
    }
    const gn_active_pairs_span *s = &n->span;
    const bool over = s->elapsed > s->ahead || s->over;
    n->whole = n->fresh || n->past.known < 2;
    n->fresh = false;
    n->look = n->whole || !n->packed || over;
    n->move = n->unsettled && n->look;
    if (n->packed && over) tune_steps(n);
    if (n->look) begin_span(n, n->steps);
    n->take = n->again && !n->look;
    n->again = false;
    n->packed = !n->whole;
    n->unsettled = true;
    n->span.steps++;
}

void gn_active_pairs_moved(const gn_step_context *ctx, gn_dem *dem) {
    gn_active_pairs *n = &dem->near;
    gn_active_pairs_span *s = &n->span;
    if (!n->on) {
        n->past.known = 0;
        return;
    }
    s->elapsed += ctx->dt;
    for (size_t b = 0; b < n->path_count; b++) {
        gn_near_path *p = &n->paths[b];
        p->last = sqrt(dem->motion_sums[b].change2) * more;
        p->change += p->last;
        p->drift += ctx->dt * p->change * more;
        s->over = s->over || p->drift > p->margin;
    }
    n->past.dt[1] = n->past.dt[0];
    n->past.dt[0] = ctx->dt;
    if (n->past.known < 2) n->past.known++;
}

/* --- search --- */

/* A block of pairs: its range in the list, and its position in the packed arrays. */
typedef struct block_of_pairs {
    size_t number, begin, end, groups, at;
    uint8_t *act;
} block_of_pairs;

static block_of_pairs block_at(const gn_active_pairs *near, const gn_contacts *list, size_t length,
                               size_t block) {
    const size_t count = list->soa.count;
    block_of_pairs b = {.number = block, .begin = block * length, .at = block * near->stride};
    b.end = b.begin + length < count ? b.begin + length : count;
    b.groups = gn_blocks(b.end - b.begin, GN_NEAR_GROUP);
    b.act = near->act + b.at / GN_NEAR_GROUP;
    return b;
}

static size_t take_all(const block_of_pairs *block) {
    const size_t count = block->end - block->begin;
    memset(block->act, 0xff, block->groups);
    if (count % GN_NEAR_GROUP)
        block->act[block->groups - 1] = (uint8_t)((1u << count % GN_NEAR_GROUP) - 1u);
    return count;
}

/* Finds the active pairs of a block. */
static void find(const gn_step_context *ctx, gn_dem *dem, const gn_contact_args *pairs,
                 const block_of_pairs *block) {
    const gn_partials *q = pairs->partials;
    const gn_near_kernels *kernels = ctx->kernels->near;
    gn_active_pairs *n = &dem->near;
    gn_near_args args = {.pos = pairs->pos,
                         .vel = pairs->vel,
                         .prefetched = pairs->spin,
                         .i = pairs->contacts->i + block->begin,
                         .j = pairs->contacts->j + block->begin,
                         .particle = q->particle + q->first[block->number],
                         .count = block->end - block->begin,
                         .particles =
                             (size_t)(q->first[block->number + 1] - q->first[block->number]),
                         .widening = 1.0 + 1e-9 + dem->verlet.reach,
                         .paths = n->paths,
                         .ahead = n->span.ahead,
                         .behind = more * (n->past.dt[0] + n->past.dt[1]),
                         .periodic = ctx->effects & GN_FX_PERIODIC};
    memcpy(args.period, pairs->period, sizeof args.period);
    memcpy(args.inverse_period, pairs->inverse_period, sizeof args.inverse_period);
    n->count[block->number] =
        (int32_t)(n->whole ? take_all(block) : kernels->find(&args, block->act));
}

/* Packs the ends and the indices of pairs. */
static void pack_ends(const gn_step_context *ctx, const gn_dem *dem, const gn_contact_args *pairs,
                      const block_of_pairs *block) {
    const gn_near_kernels *kernels = ctx->kernels->near;
    const gn_active_pairs *n = &dem->near;
    int32_t *i = n->i + block->at, *j = n->j + block->at;
    kernels->pack32(i, pairs->contacts->i + block->begin, block->act, block->groups);
    kernels->pack32(j, pairs->contacts->j + block->begin, block->act, block->groups);
    kernels->pack32(n->place + 2 * block->at, pairs->partials->place + 2 * block->begin, block->act,
                    block->groups);
    for (size_t k = (size_t)n->count[block->number]; k % GN_LANES_MAX; k++) {
        i[k] = gn_null_first(&dem->particles);
        j[k] = gn_null_second(&dem->particles);
    }
}

/* Positions of the packed pairs before the present search. */
typedef struct packed_before {
    size_t count;
    uint8_t act[GN_CONTACT_BLOCK / GN_NEAR_GROUP];
} packed_before;

/* Moves packed columns to their new positions. Pairs that were not packed before get zeros; see
 * put. */
static void move_packed(const gn_step_context *ctx, double *data, const packed_before *was,
                        const block_of_pairs *block) {
    double old[GN_CONTACT_BLOCK + GN_LANES_MAX];
    memcpy(old, data, (was->count + GN_NEAR_GROUP) * sizeof *old);
    ctx->kernels->near->repack(data, old, was->act, block->act, block->groups);
}

/* Packs the columns of the block, with zeros after the last pair. Columns that the kernel writes
 * come from their packed positions in `was`, if it is given, else from the list. */
static void fetch(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                  const packed_before *was, const block_of_pairs *block) {
    const gn_active_pairs *n = &dem->near;
    for (int k = 0; k < n->columns; k++)
        for (size_t a = 0; a < (size_t)n->column[k].components; a++) {
            double *to = n->data + (n->column[k].stream + a) * n->room + block->at;
            const double *from =
                column_of(list, &n->column[k]) + a * list->soa.capacity + block->begin;
            if (was && n->column[k].written)
                move_packed(ctx, to, was, block);
            else
                ctx->kernels->near->pack(to, from, block->act, block->groups);
            memset(to + n->count[block->number], 0, GN_LANES_MAX * sizeof *to);
        }
}

/* Writes packed columns back into the list. The columns of unpacked pairs are zero, because these
 * pairs did not touch when they were last packed. Negative zeros become positive, so that the
 * result does not depend on which pairs without contact were processed. */
static void put(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                const block_of_pairs *block) {
    const gn_active_pairs *n = &dem->near;
    for (int k = 0; k < n->columns; k++)
        for (size_t a = 0; n->column[k].written && a < (size_t)n->column[k].components; a++)
            ctx->kernels->near->unpack(column_of(list, &n->column[k]) + a * list->soa.capacity +
                                           block->begin,
                                       n->data + (n->column[k].stream + a) * n->room + block->at,
                                       block->act, block->groups);
}

/* --- kernel calls --- */

/* Returns the list that the kernel works on: the packed columns of a block. */
static gn_contacts packed(const gn_active_pairs *near, const gn_contacts *list,
                          const block_of_pairs *block) {
    gn_contacts part = *list;
    for (int k = 0; k < near->columns; k++)
        *(double **)(void *)((char *)&part + near->column[k].offset) =
            near->data + near->column[k].stream * near->room + block->at;
    part.soa.count = (size_t)near->count[block->number];
    part.soa.capacity = near->room;
    part.i = near->i + block->at;
    part.j = near->j + block->at;
    return part;
}

void gn_active_pairs_work(const gn_step_context *ctx, gn_dem *dem, const gn_contact_args *pairs,
                          size_t block, gn_contact_sums *sums) {
    const gn_active_pairs *n = &dem->near;
    const gn_contacts *list = pairs->contacts;
    const block_of_pairs b = block_at(n, list, pairs->partials->length, block);
    packed_before was;
    if (n->move) {
        was.count = (size_t)n->count[block];
        memcpy(was.act, b.act, b.groups);
    }
    if (n->look) find(ctx, dem, pairs, &b);
    if (n->look || n->take) {
        pack_ends(ctx, dem, pairs, &b);
        fetch(ctx, dem, list, n->move ? &was : NULL, &b);
    }
    const gn_contacts part = packed(n, list, &b);
    gn_partials partials = *pairs->partials;
    partials.first += block;
    partials.place = n->place + 2 * b.at;
    gn_contact_args args = *pairs;
    args.contacts = &part;
    args.partials = &partials;
    dem->pairs.kernel(&args, 0, part.soa.count, sums);
}

/* --- access by other code --- */

gn_contacts gn_active_pairs_block(const gn_dem *dem, size_t block) {
    const gn_contacts *list = &dem->pairs.contacts;
    const block_of_pairs b = block_at(&dem->near, list, dem->pairs.partials.length, block);
    if (dem->near.unsettled) return packed(&dem->near, list, &b);
    gn_contacts part = *list;
    part.i += b.begin;
    part.j += b.begin;
    part.soa.count = b.end - b.begin;
    for (size_t f = 0; f < gn_contact_record.field_count; f++) {
        const gn_field *field = &gn_contact_record.fields[f];
        if (!gn_field_active(field, list->soa.effects) || field->layout != GN_COLUMNS) continue;
        if (field->type == GN_F64) *(double **)(void *)((char *)&part + field->offset) += b.begin;
    }
    return part;
}

void gn_active_pairs_settle(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_active_pairs *n = &dem->near;
    if (!n->unsettled) return;
    for (size_t k = 0; k < n->blocks; k++) {
        const block_of_pairs b = block_at(n, &dem->pairs.contacts, dem->pairs.partials.length, k);
        put(ctx, dem, &dem->pairs.contacts, &b);
    }
    ((gn_active_pairs *)(uintptr_t)n)->unsettled = false; /* see active_pairs.h */
}

void gn_active_pairs_repack(const gn_step_context *ctx, gn_dem *dem) {
    gn_active_pairs_settle(ctx, dem);
    dem->near.packed = false;
}

void gn_active_pairs_forget(const gn_step_context *ctx, gn_dem *dem) {
    gn_active_pairs_repack(ctx, dem);
    dem->near.past.known = 0;
}

/* --- checkpoints --- */

/* Clears the marks after the last pair of a block. */
static void clear_ends(gn_active_pairs *near, const gn_contacts *list, size_t length) {
    for (size_t k = 0; k < near->blocks; k++) {
        const block_of_pairs b = block_at(near, list, length, k);
        memset(b.act + b.groups, 0, near->stride / GN_NEAR_GROUP - b.groups);
    }
}

gn_active_pairs_kept gn_active_pairs_keep(const gn_step_context *ctx, gn_dem *dem, size_t *groups) {
    gn_active_pairs *n = &dem->near;
    gn_active_pairs_settle(ctx, dem);
    n->again = n->packed;
    if (n->packed) clear_ends(n, &dem->pairs.contacts, dem->pairs.partials.length);
    *groups = n->packed ? n->blocks * n->stride / GN_NEAR_GROUP : 0;
    return (gn_active_pairs_kept){.known = n->past.known,
                                  .dt = {n->past.dt[0], n->past.dt[1]},
                                  .ahead = n->span.ahead,
                                  .elapsed = n->span.elapsed,
                                  .over = n->span.over,
                                  .worked = n->span.steps,
                                  .steps = n->steps,
                                  .towards = n->towards,
                                  .cost = isfinite(n->cost) ? n->cost : -1.0,
                                  .fresh = n->fresh,
                                  .packed = n->packed};
}

/* Counts the marked pairs of a block; false if a mark is after its last pair. */
static bool count_block(gn_active_pairs *near, const block_of_pairs *block) {
    int32_t count = 0;
    bool good = true;
    for (size_t k = 0; k < near->stride; k++) {
        const int marked = block->act[k / GN_NEAR_GROUP] >> k % GN_NEAR_GROUP & 1;
        count += marked;
        good = good && (!marked || k < block->end - block->begin);
    }
    near->count[block->number] = count;
    return good;
}

static bool take_marks(gn_dem *dem) {
    gn_active_pairs *n = &dem->near;
    if (n->kept_groups != n->blocks * n->stride / GN_NEAR_GROUP) return false;
    memcpy(n->act, n->kept_act, n->kept_groups);
    bool good = true;
    for (size_t k = 0; k < n->blocks; k++) {
        const block_of_pairs b = block_at(n, &dem->pairs.contacts, dem->pairs.partials.length, k);
        good = count_block(n, &b) && good;
    }
    return good;
}

static bool take_paths(gn_active_pairs *near) {
    bool good = near->kept_path_count == near->path_count;
    if (!good) return false;
    memcpy(near->paths, near->kept_paths, near->path_count * sizeof *near->paths);
    for (size_t b = 0; b < near->path_count; b++) {
        const gn_near_path *p = &near->paths[b];
        good = good && p->margin >= 0.0 && p->last >= 0.0 && p->change >= 0.0 && p->drift >= 0.0;
    }
    return good;
}

gneiss_status gn_active_pairs_resume(gn_dem *dem, gneiss_error *error) {
    gn_active_pairs *n = &dem->near;
    const gn_active_pairs_kept *k = &n->kept;
    if (!n->kept_act) return GNEISS_OK;
    n->past = (gn_active_pairs_past){(int)k->known, {k->dt[0], k->dt[1]}};
    n->span = (gn_active_pairs_span){k->ahead, k->elapsed, k->over > 0.0, (int)k->worked};
    n->steps = (int)k->steps;
    n->towards = (int)k->towards;
    n->cost = k->cost < 0.0 ? INFINITY : k->cost;
    bool good = true;
    if (n->on) {
        n->fresh = k->fresh > 0.0;
        n->packed = n->again = k->packed > 0.0;
        good = take_paths(n) && (!n->packed || take_marks(dem));
    }
    gn_free(n->kept_act);
    gn_free(n->kept_paths);
    n->kept_act = NULL;
    n->kept_paths = NULL;
    return good ? GNEISS_OK
                : gn_fail(
                      error, GNEISS_ERROR_INPUT,
                      "expected marks of the pairs and paths of the particles that the checkpoint "
                      "has, found others");
}
