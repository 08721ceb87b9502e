/* How far particles came since the lists were made.
 *
 * What flows comes far as a whole, and little past its neighbours: it is that which lists have to
 * be wide enough for. Cells over the places of then, wider than two particles can come together
 * across one, have the box of the ways of their particles; two that can have met were in cells that
 * are next to each other, so that the diagonal of the ways of two by two by two cells bounds by how
 * much they closed in. */
#include "base/memory.h"
#include "sim/internal.h"

#include <math.h>

/* Of all particles of a cell, m. */
typedef struct ways {
    double low[3], high[3];
} ways;

typedef struct grid {
    double low[3], scale[3]; /* scale: cells per m */
    size_t count[3];
    bool closed[3]; /* the last cell is beside the first */
    ways *cell;
} grid;

static const ways none = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* Places and ways are finite: there is nothing to ask of fmin. */
static void merge(ways *to, const double low[3], const double high[3]) {
    for (int a = 0; a < 3; a++) {
        to->low[a] = low[a] < to->low[a] ? low[a] : to->low[a];
        to->high[a] = high[a] > to->high[a] ? high[a] : to->high[a];
    }
}

/* Room that the places of then take up; *radius: the largest. */
static ways extent(const gn_particles *q, double *radius) {
    ways room = none;
    *radius = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->ref + 4 * p;
        merge(&room, x, x);
        *radius = fmax(*radius, q->pos[4 * p + 3]);
    }
    return room;
}

/* Cells of at least `width`, not many more than particles. */
static void lay(const gn_world *w, double width, const ways *room, grid *g) {
    const double most = cbrt((double)w->dem.particles.soa.count) + 1.0;
    for (int a = 0; a < 3; a++) {
        const double side = w->effects & GN_FX_PERIODIC ? w->period[a] : 0.0;
        const double size = side > 0.0 ? side : room->high[a] - room->low[a];
        const double cells = floor(fmin(size / width, 4.0 * most));
        g->closed[a] = side > 0.0;
        g->low[a] = side > 0.0 ? w->scene.periodic_min[a] : room->low[a];
        g->count[a] = cells >= 1.0 ? (size_t)cells : 1;
        g->scale[a] = size > 0.0 ? (double)g->count[a] / size : 0.0;
    }
}

static ways *cell_of(const grid *g, const double x[3]) {
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        const double k = (x[a] - g->low[a]) * g->scale[a];
        at[a] = k > 0.0 ? (size_t)k : 0;
        if (at[a] >= g->count[a]) at[a] = g->count[a] - 1;
    }
    return &g->cell[(at[2] * g->count[1] + at[1]) * g->count[0] + at[0]];
}

static void fill(const gn_particles *q, grid *g) {
    const size_t cells = g->count[0] * g->count[1] * g->count[2];
    for (size_t k = 0; k < cells; k++) g->cell[k] = none;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        const double *x = q->pos + 4 * p, *from = q->ref + 4 * p;
        const double d[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
        merge(cell_of(g, from), d, d);
    }
}

/* Every cell gets the ways of the next one along an axis; behind the last one is the first, or
 * none.
 */
static void spread(grid *g, int axis) {
    const size_t step = axis == 0 ? 1 : axis == 1 ? g->count[0] : g->count[0] * g->count[1];
    const size_t of = g->count[axis] ? g->count[axis] : 1;
    const size_t all = g->count[0] * g->count[1] * g->count[2];
    for (size_t k = 0; k < all / of; k++) {
        ways *c = g->cell + k / step * step * of + k % step;
        const ways first = c[0];
        for (size_t n = 0; n + 1 < of; n++)
            merge(&c[n * step], c[(n + 1) * step].low, c[(n + 1) * step].high);
        if (g->closed[axis]) merge(&c[(of - 1) * step], first.low, first.high);
    }
}

/* The square of the longest diagonal. */
static double longest2(const grid *g) {
    double most = 0.0;
    for (size_t k = 0; k < g->count[0] * g->count[1] * g->count[2]; k++) {
        const ways *c = &g->cell[k];
        double sum = 0.0;
        for (int a = 0; a < 3; a++) sum += (c->high[a] - c->low[a]) * (c->high[a] - c->low[a]);
        if (c->low[0] <= c->high[0]) most = fmax(most, sum);
    }
    return most;
}

/* m, by which any two closed in that were not near; at most twice the way of one. */
static double closed_in(const gn_world *w, double most) {
    grid g;
    double radius;
    const ways room = extent(&w->dem.particles, &radius);
    lay(w, 1.001 * (2.0 * radius + w->dem.verlet.skin + 2.0 * most), &room, &g);
    g.cell = gn_alloc_array_raw(g.count[0] * g.count[1] * g.count[2], sizeof *g.cell);
    if (!g.cell) return 2.0 * most; /* which is as true */
    fill(&w->dem.particles, &g);
    for (int a = 0; a < 3; a++) spread(&g, a);
    const double most2 = longest2(&g);
    gn_free(g.cell);
    return fmin(2.0 * most, sqrt(most2) * (1.0 + 1e-12));
}

/* Bonded specimens keep the bits of their runs; where a box or elements move particles, so do their
 * ways. */
static bool looks_at_neighbours(const gn_world *w) {
    return !(w->effects & GN_FX_BONDS) && !w->scene.has_couple && !gn_box_moves(w);
}

void gn_dem_look_at_travel(gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double most = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d2 = 0.0;
        for (int a = 0; a < 3; a++) {
            double d = q->pos[4 * p + a] - q->ref[4 * p + a];
            d2 += d * d;
        }
        most = fmax(most, d2);
    }
    gn_verlet *v = &w->dem.verlet;
    v->drift = sqrt(most);
    v->closed = looks_at_neighbours(w) && v->drift > 0.0 ? closed_in(w, v->drift) : 2.0 * v->drift;
}
