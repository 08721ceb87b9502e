/* Displacements of particles since the lists were made. Flowing particles move far together, but
 * little relative to their neighbours, and lists have to cover the relative motion only. The former
 * positions are divided into cells wider than the distance by which two particles can approach each
 * other; each cell has the bounding box of the displacements of its particles. Two particles that
 * may have come into contact were in the same or in adjacent cells, so that the diagonal of the
 * bounding box over two by two by two cells limits their approach. */
#include "base/memory.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>

/* Bounding box of the displacements of the particles in a cell, m. */
typedef struct ways {
    double low[3], high[3];
} ways;

typedef struct grid {
    double low[3], scale[3]; /* scale: cells per m */
    size_t count[3];
    bool closed[3];    /* periodic: the last cell is next to the first */
    size_t begin, end; /* range of layers along the last axis that contain particles or precede a
                          layer that does; other cells are unused */
    ways *cell;
} grid;

static size_t cells_of_layer(const grid *g) {
    return g->count[0] * g->count[1];
}

static const ways none = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* Extends a box by another one. Positions and displacements are finite, so that fmin is not needed.
 */
static void merge(ways *to, const double low[3], const double high[3]) {
    for (int a = 0; a < 3; a++) {
        to->low[a] = low[a] < to->low[a] ? low[a] : to->low[a];
        to->high[a] = high[a] > to->high[a] ? high[a] : to->high[a];
    }
}

/* Returns the bounding box of the former positions; *radius: the largest. */
static ways extent(const gn_particles *particles, double *radius) {
    ways room = none;
    *radius = 0.0;
    for (size_t p = 0; p < particles->soa.count; p++) {
        const double *x = particles->ref + 4 * p;
        merge(&room, x, x);
        *radius = fmax(*radius, particles->pos[4 * p + 3]);
    }
    return room;
}

/* Divides space into cells of at least `width`, not many more of them than particles. */
static void lay(const gn_step_context *ctx, const gn_dem *dem, double width, const ways *room,
                grid *g) {
    const double most = cbrt((double)dem->particles.soa.count) + 1.0;
    for (int a = 0; a < 3; a++) {
        const double side = ctx->effects & GN_FX_PERIODIC ? ctx->period[a] : 0.0;
        const double size = side > 0.0 ? side : room->high[a] - room->low[a];
        const double cells = floor(fmin(size / width, 4.0 * most));
        g->closed[a] = side > 0.0;
        g->low[a] = side > 0.0 ? ctx->scene.periodic_min[a] : room->low[a];
        g->count[a] = cells >= 1.0 ? (size_t)cells : 1;
        g->scale[a] = size > 0.0 ? (double)g->count[a] / size : 0.0;
    }
}

static size_t place_of(const grid *g, double x, int axis) {
    const double k = (x - g->low[axis]) * g->scale[axis];
    const size_t at = k > 0.0 ? (size_t)k : 0;
    return at < g->count[axis] ? at : g->count[axis] - 1;
}

static ways *cell_of(const grid *g, const double x[3]) {
    const size_t row = place_of(g, x[2], 2) * g->count[1] + place_of(g, x[1], 1);
    return &g->cell[row * g->count[0] + place_of(g, x[0], 0)];
}

/* Finds the used layers: in a box that is high relative to its contents most layers are empty. If
 * the lowest layer is not, all are used, because the highest may be adjacent to it. */
static void find_layers(const ways *room, grid *g) {
    const size_t low = place_of(g, room->low[2], 2);
    g->begin = low > 0 ? low - 1 : 0;
    g->end = low > 0 ? place_of(g, room->high[2], 2) + 1 : g->count[2];
}

static void fill(const gn_particles *particles, grid *g) {
    const size_t layer = cells_of_layer(g);
    for (size_t k = layer * g->begin; k < layer * g->end; k++) g->cell[k] = none;
    for (size_t p = 0; p < particles->soa.count; p++) {
        if (!gn_particle_is_active(particles, p)) continue;
        const double *x = particles->pos + 4 * p, *from = particles->ref + 4 * p;
        const double d[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
        merge(cell_of(g, from), d, d);
    }
}

/* Merges the box of the next cell into each of `count` cells, which begin at `c` and are `step`
 * apart; if the axis is periodic, the first cell follows the last one. */
static void spread_line(ways *c, size_t step, size_t count, bool closed) {
    const ways first = c[0];
    for (size_t n = 0; n + 1 < count; n++)
        merge(&c[n * step], c[(n + 1) * step].low, c[(n + 1) * step].high);
    if (closed) merge(&c[(count - 1) * step], first.low, first.high);
}

/* Merges along all axes. */
static void spread(grid *g) {
    const size_t layer = cells_of_layer(g), row = g->count[0];
    for (size_t z = g->begin; z < g->end; z++) {
        ways *c = g->cell + layer * z;
        for (size_t y = 0; y < g->count[1]; y++) spread_line(c + row * y, 1, row, g->closed[0]);
        for (size_t x = 0; x < row; x++) spread_line(c + x, row, g->count[1], g->closed[1]);
    }
    const size_t layers = g->end - g->begin;
    for (size_t k = 0; k < layer; k++)
        spread_line(g->cell + layer * g->begin + k, layer, layers,
                    g->closed[2] && layers == g->count[2]);
}

/* Returns the square of the longest diagonal. */
static double longest2(const grid *g) {
    const size_t layer = cells_of_layer(g);
    double most = 0.0;
    for (size_t k = layer * g->begin; k < layer * g->end; k++) {
        const ways *c = &g->cell[k];
        double sum = 0.0;
        for (int a = 0; a < 3; a++) sum += (c->high[a] - c->low[a]) * (c->high[a] - c->low[a]);
        if (c->low[0] <= c->high[0]) most = fmax(most, sum);
    }
    return most;
}

/* Returns scratch for the cells, which is kept between checks: new memory costs more than a check.
 * */
static ways *room_for(gn_dem *dem, size_t cells) {
    if (cells <= dem->ways_room) return dem->ways;
    gn_free(dem->ways);
    dem->ways = gn_alloc_array_raw(cells, sizeof(ways));
    dem->ways_room = dem->ways ? cells : 0;
    return dem->ways;
}

/* Returns the largest distance, m, by which two particles that were not listed may have approached
 * each other; at most twice the longest displacement. */
static double closed_in(const gn_step_context *ctx, gn_dem *dem, double most) {
    grid g;
    double radius;
    const ways room = extent(&dem->particles, &radius);
    lay(ctx, dem, 1.001 * (2.0 * radius + dem->verlet.skin + 2.0 * most), &room, &g);
    g.cell = room_for(dem, g.count[0] * g.count[1] * g.count[2]);
    if (!g.cell) return 2.0 * most; /* this bound holds without cells too */
    find_layers(&room, &g);
    fill(&dem->particles, &g);
    spread(&g);
    const double most2 = longest2(&g);
    return fmin(2.0 * most, sqrt(most2) * (1.0 + 1e-12));
}

/* Tells whether relative displacements are used. Bonded specimens do not use them, so that the bits
 * of their runs stay the same; nor do models in which a box or elements move particles. */
static bool looks_at_neighbours(const gn_step_context *ctx, const gn_periodic_box *box) {
    return !(ctx->effects & GN_FX_BONDS) && !ctx->scene.has_couple && !gn_box_moves(ctx, box);
}

void gn_dem_look_at_travel(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box) {
    const gn_particles *q = &dem->particles;
    double most = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d2 = 0.0;
        for (int a = 0; a < 3; a++) {
            double d = q->pos[4 * p + a] - q->ref[4 * p + a];
            d2 += d * d;
        }
        most = fmax(most, d2);
    }
    gn_verlet *v = &dem->verlet;
    v->drift = sqrt(most);
    v->closed = looks_at_neighbours(ctx, box) && v->drift > 0.0 ? closed_in(ctx, dem, v->drift)
                                                                : 2.0 * v->drift;
}
