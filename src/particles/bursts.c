/* Groups breaks of bonds into bursts. Breaks are visited in the order of time. Earlier breaks that
 * are close enough in time are linked within each cell of a grid, the latest first, so that few are
 * visited however many there are. */
#include "particles/bursts.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "frame/frame.h"
#include "particles/events.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* --- length and duration of a burst --- */

/* Computes two means over the bonds: the diameter, and the time per length of a wave in a chain of
 * equal masses m and springs k of length L, sqrt(m/k)/L. */
static void find_windows(const gn_step_context *ctx, const gn_dem *dem, gn_bursts *bursts) {
    const gn_contacts *list = &dem->bonds.contacts;
    const double *pos = dem->particles.pos, *vel = dem->particles.vel;
    double across = 0.0, slow = 0.0;
    size_t count = 0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const size_t i = (size_t)list->i[c], j = (size_t)list->j[c];
        const double inverse = 0.5 * (vel[4 * i + 3] + vel[4 * j + 3]);
        if (!(list->kn[c] > 0.0) || !(inverse > 0.0) || !(list->length0[c] > 0.0)) continue;
        across += pos[4 * i + 3] + pos[4 * j + 3];
        slow += 1.0 / (sqrt(list->kn[c] * inverse) * list->length0[c]);
        count++;
    }
    if (!count) return;
    bursts->reach = ctx->scene.burst_reach * across / (double)count;
    bursts->window = bursts->reach * slow / (double)count;
}

/* --- events that belong together --- */

typedef struct grid {
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_event *events;
    const gn_bursts *bursts;
    int32_t *parent, *before; /* [events] first event of the burst; previous event in the cell */
    int32_t *latest;          /* [mask + 1] latest event of a cell */
    size_t mask;
    double size[3];  /* m, of a cell */
    int64_t most[3]; /* number of cells along a periodic side; 0: not limited */
} grid;

static void cell_of(const grid *g, const double place[3], int64_t cell[3]) {
    for (int a = 0; a < 3; a++) cell[a] = (int64_t)floor(place[a] / g->size[a]);
}

static size_t bucket_of(const grid *g, const int64_t cell[3]) {
    uint64_t h = 0;
    for (int a = 0; a < 3; a++) {
        int64_t k = cell[a];
        if (g->most[a]) k = ((k % g->most[a]) + g->most[a]) % g->most[a];
        h = (h ^ (uint64_t)k) * 0x9e3779b97f4a7c15U;
        h ^= h >> 29;
    }
    return (size_t)h & g->mask;
}

static void look_into(const grid *g, const int64_t cell[3], int32_t k) {
    const gn_event *e = &g->events[k];
    for (int32_t m = g->latest[bucket_of(g, cell)]; m >= 0; m = g->before[m]) {
        const gn_event *of = &g->events[m];
        double d[3];
        if (e->time - of->time > g->bursts->window)
            return; /* all earlier ones are outside of the time window too */
        if (gn_branch(g->ctx, of->place, e->place, d) <= g->bursts->reach * g->bursts->reach)
            gn_set_unite(g->parent, m, k);
    }
}

static void join(grid *g, int32_t k) {
    int64_t own[3], cell[3];
    cell_of(g, g->events[k].place, own);
    for (int near = 0; near < 27; near++) {
        cell[0] = own[0] + near % 3 - 1;
        cell[1] = own[1] + near / 3 % 3 - 1;
        cell[2] = own[2] + near / 9 - 1;
        look_into(g, cell, k);
    }
    size_t bucket = bucket_of(g, own);
    g->before[k] = g->latest[bucket];
    g->latest[bucket] = k;
}

static bool is_break(const gn_event *event) {
    return gn_broken((uint8_t)event->cause);
}

static gneiss_status join_all(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_bursts *bursts, int32_t *parent, gneiss_error *error) {
    const gn_events *list = &dem->events;
    grid g = {.ctx = ctx,
              .dem = dem,
              .events = list->rows,
              .bursts = bursts,
              .parent = parent,
              .mask = 1023};
    while (g.mask < list->count) g.mask = 2 * g.mask + 1;
    for (int a = 0; a < 3; a++) {
        const double period = ctx->period[a];
        if (period > 0.0) g.most[a] = (int64_t)fmax(1.0, floor(period / bursts->reach));
        g.size[a] = period > 0.0 ? period / (double)g.most[a] : bursts->reach;
    }
    g.before = gn_alloc_array(list->count + 1, sizeof *g.before);
    g.latest = gn_alloc_array(g.mask + 1, sizeof *g.latest);
    const bool held = g.before && g.latest;
    if (held) memset(g.latest, -1, (g.mask + 1) * sizeof *g.latest);
    for (size_t k = 0; k < list->count; k++) parent[k] = (int32_t)k;
    for (size_t k = 0; held && bursts->reach > 0.0 && k < list->count; k++)
        if (is_break(&list->rows[k])) join(&g, (int32_t)k);
    gn_free(g.before);
    gn_free(g.latest);
    if (held) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu events", list->count);
}

/* --- sums of bursts --- */

static void add(const gn_step_context *ctx, const gn_dem *dem, gn_burst *burst,
                const gn_event *event) {
    const gn_event *first = &dem->events.rows[burst->first];
    double d[3];
    gn_branch(ctx, first->place, event->place, d);
    for (int a = 0; a < 3; a++) burst->place[a] += d[a];
    burst->duration = event->time - first->time;
    burst->energy += ctx->effects & GN_FX_ENERGY ? event->energy : NAN;
    burst->tension += event->cause == GN_BROKEN_TENSION;
    burst->size++;
}

static void sum_up(const gn_step_context *ctx, const gn_dem *dem, int32_t *parent,
                   gn_bursts *bursts) {
    const gn_events *list = &dem->events;
    for (size_t k = 0; k < list->count; k++) {
        const gn_event *e = &list->rows[k];
        bursts->of[k] = -1;
        if (!is_break(e)) continue;
        const int32_t root = gn_set_root(parent, (int32_t)k);
        if (root == (int32_t)k)
            bursts->row[bursts->count++] = (gn_burst){.time = e->time, .first = (int64_t)k};
        bursts->of[k] = root == (int32_t)k ? (int32_t)bursts->count - 1 : bursts->of[root];
        add(ctx, dem, &bursts->row[bursts->of[k]], e);
    }
    for (size_t k = 0; k < bursts->count; k++)
        for (int a = 0; a < 3; a++)
            bursts->row[k].place[a] = list->rows[bursts->row[k].first].place[a] +
                                      bursts->row[k].place[a] / bursts->row[k].size;
}

gneiss_status gn_bursts_find(const gn_step_context *ctx, const gn_dem *dem, gn_bursts *bursts,
                             gneiss_error *error) {
    const size_t events = dem->events.count;
    *bursts = (gn_bursts){0};
    if (!(ctx->effects & GN_FX_EVENTS)) return GNEISS_OK;
    find_windows(ctx, dem, bursts);
    int32_t *parent = gn_alloc_array(events + 1, sizeof *parent);
    bursts->row = gn_alloc_array(events + 1, sizeof *bursts->row);
    bursts->of = gn_alloc_array(events + 1, sizeof *bursts->of);
    gneiss_status status =
        parent && bursts->row && bursts->of
            ? join_all(ctx, dem, bursts, parent, error)
            : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu events", events);
    if (status == GNEISS_OK) sum_up(ctx, dem, parent, bursts);
    gn_free(parent);
    return status;
}

void gn_bursts_free(gn_bursts *bursts) {
    gn_free(bursts->row);
    gn_free(bursts->of);
    *bursts = (gn_bursts){0};
}

double gn_burst_magnitude(const gn_burst *burst) {
    return burst->energy > 0.0 ? 2.0 / 3.0 * log10(burst->energy) - 3.2 : NAN;
}
