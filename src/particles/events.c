/* Kernels mark the events of bonds (columns happened, released). Here the marks of a step become
 * rows of the list. Only blocks whose sums report an event are visited. */
#include "particles/events.h"

#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <stdlib.h>
#include <string.h>

enum { MARKS = 3 }; /* most events of a bond in one step */

/* Returns the position of the contact at the instant of the forces, before the last motion. */
static void place_of(const gn_step_context *ctx, const gn_dem *dem, size_t c, double place[3]) {
    const gn_particles *q = &dem->particles;
    const size_t i = (size_t)dem->bonds.contacts.i[c], j = (size_t)dem->bonds.contacts.j[c];
    double d[3], at[3];
    gn_branch(ctx, q->pos + 4 * i, q->pos + 4 * j, d);
    for (size_t a = 0; a < 3; a++) {
        at[a] = q->pos[4 * i + a] - ctx->dt * q->vel[4 * i + a];
        d[a] -= ctx->dt * (q->vel[4 * j + a] - q->vel[4 * i + a]);
    }
    double length = sqrt(gn_dot3(d, d));
    double arm = 0.5 * (length + q->pos[4 * i + 3] - q->pos[4 * j + 3]);
    for (size_t a = 0; a < 3 && length > 0.0; a++) at[a] += arm / length * d[a];
    gn_user_point(ctx, at, place);
}

static void add_event(const gn_step_context *ctx, gn_dem *dem, size_t c, int cause, double energy) {
    const gn_dem *d = dem;
    int32_t a = d->particles.id[d->bonds.contacts.i[c]],
            b = d->particles.id[d->bonds.contacts.j[c]];
    gn_event *e = &dem->events.rows[dem->events.count++];
    *e = (gn_event){.step = ctx->step, .time = ctx->time, .energy = energy, .cause = cause};
    e->i = a < b ? a : b;
    e->j = a < b ? b : a;
    place_of(ctx, dem, c, e->place);
}

static void take_marks(const gn_step_context *ctx, gn_dem *dem, size_t c) {
    const gn_contacts *b = &dem->bonds.contacts;
    const int what = b->happened[c];
    b->happened[c] = 0;
    if (what & GN_HAPPENED_SOFTENING) add_event(ctx, dem, c, GN_EVENT_SOFTENING, 0.0);
    if (what & GN_HAPPENED_YIELD) add_event(ctx, dem, c, GN_EVENT_YIELD, 0.0);
    if (what & GN_HAPPENED_BREAK && gn_broken(b->cause[c]))
        add_event(ctx, dem, c, b->cause[c], b->released ? b->released[c] : 0.0);
}

/* Sorts the events of one step, so that their order does not depend on that of the lists. */
static int by_ends(const void *a, const void *b) {
    const gn_event *x = a, *y = b;
    if (x->i != y->i) return x->i < y->i ? -1 : 1;
    if (x->j != y->j) return x->j < y->j ? -1 : 1;
    return (x->cause < y->cause) - (x->cause > y->cause);
}

/* Adds the events of other ranks to those from row `first` on. */
static gneiss_status add_others(const gn_ranks *ranks, gn_events *list, size_t first,
                                gneiss_error *error) {
    const size_t ranks_count = (size_t)ranks->count, own = list->count - first;
    GN_FREED size_t *count = NULL;
    GN_FREED size_t *range = NULL;
    GN_TRY(gn_new(&count, ranks_count, "events of other ranks", error));
    GN_TRY(gn_new(&range, ranks_count + 1, "events of other ranks", error));
    for (size_t k = 0; k <= ranks_count; k++) range[k] = k * sizeof *count;
    count[ranks->rank] = own;
    ranks->transport->gather(count, range);
    for (size_t k = 0; k < ranks_count; k++)
        range[k + 1] = range[k] + count[k] * sizeof *list->rows;
    const size_t before = range[ranks->rank] / sizeof *list->rows,
                 all = range[ranks_count] / sizeof *list->rows;
    GN_TRY(gn_grow(&list->rows, list->count, first + all, &list->capacity, "events", error));
    if (own) memmove(list->rows + first + before, list->rows + first, own * sizeof *list->rows);
    if (all) ranks->transport->gather(list->rows + first, range);
    list->count = first + all;
    return GNEISS_OK;
}

gneiss_status gn_events_note(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const gn_contacts *b = &dem->bonds.contacts;
    const gn_contact_sums *all = &dem->done.list[GN_LIST_BONDS];
    if (!b->happened || !(all->broken_tension + all->broken_shear + all->began)) return GNEISS_OK;
    const size_t first = dem->events.count, length = dem->bonds.partials.length;
    for (size_t k = 0; k < dem->bonds.partials.blocks; k++) {
        const gn_contact_sums *s = &dem->bonds.sums[k];
        size_t end = (k + 1) * length < b->soa.count ? (k + 1) * length : b->soa.count;
        if (!(s->broken_tension + s->broken_shear + s->began)) continue;
        for (size_t c = k * length; c < end; c++) {
            if (!b->happened[c]) continue;
            GN_TRY(gn_grow(&dem->events.rows, dem->events.count, dem->events.count + MARKS,
                           &dem->events.capacity, "events", error));
            take_marks(ctx, dem, c);
        }
    }
    if (ctx->ranks) GN_TRY(add_others(ctx->ranks, &dem->events, first, error));
    qsort(dem->events.rows + first, dem->events.count - first, sizeof(gn_event), by_ends);
    return GNEISS_OK;
}

void gn_events_free(gn_events *events) {
    gn_free(events->rows);
    *events = (gn_events){0};
}
