#include "membrane/rolling_ball.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "neigh/neigh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double turn = 2.0 * M_PI;

/* The possible centres of a ball that touches a particle form a sphere (2D: a circle), of which the
 * spheres of neighbours hide parts. Features smaller than these relative tolerances are ignored:
 * tangency of spheres, and gaps (rad) that rounding leaves between hidden parts. */
static const double contact = 1e-9, gap = 1e-9;

/* Hidden angles of a circle, starting at `begin` in [0, 2 pi). */
typedef struct hidden {
    double begin, width;
} hidden;

typedef struct roll {
    const gn_rolled *rolled;
    size_t *start; /* [particles + 1] first index in `neighbour` */
    int32_t *neighbour;
    hidden *hidden; /* hidden arcs of the present circle */
    size_t hidden_count;
    bool *bounded; /* [particles] neighbours hide parts of its sphere */
    bool *touched; /* [particles] true: the ball touches the particle */
    double
        *direction; /* [particles] sr, solid angle of directions from which the ball can touch it */
} roll;

static double reach_of(const roll *v, size_t p) {
    return v->rolled->particles->pos[4 * p + 3] + v->rolled->ball;
}

/* Returns the distance of a layer from the ball's centre, m. */
static double layer_of(const roll *v, int k) {
    return gn_rolled_layer[k] * v->rolled->ball;
}

static const double *place_of(const roll *v, size_t p) {
    return v->rolled->particles->pos + 4 * p;
}

static void way_between(const roll *v, size_t from, size_t to, double way[3]) {
    for (int a = 0; a < 3; a++) way[a] = place_of(v, to)[a] - place_of(v, from)[a];
}

/* --- hidden angles --- */

/* Hides the angles for which cos(angle - at) > limit. */
static void hide(roll *v, double at, double limit) {
    if (limit >= 1.0) return;
    const double half = limit <= -1.0 ? M_PI : acos(limit);
    double begin = fmod(at - half, turn);
    if (begin < 0.0) begin += turn;
    v->hidden[v->hidden_count++] = (hidden){begin, limit <= -1.0 ? turn : 2.0 * half};
}

static int by_begin(const void *a, const void *b) {
    const hidden *one = a, *two = b;
    return (one->begin > two->begin) - (one->begin < two->begin);
}

/* A free arc, from `from` to `to` > from. */
typedef struct arc {
    double from, to;
    bool whole; /* the arc is the whole circle */
} arc;

/* Finds the next free arc after the k-th hidden part; all hidden parts before it end at or before
 * *end. */
static bool next_arc(const roll *v, size_t *k, double *end, arc *free) {
    while (*k < v->hidden_count) {
        const hidden *h = &v->hidden[(*k + 1) % v->hidden_count];
        const double begin = h->begin + (*k + 1 == v->hidden_count ? turn : 0.0);
        *free = (arc){*end, begin, false};
        *end = fmax(*end, begin + h->width);
        (*k)++;
        if (free->to - free->from > gap) return true;
    }
    return false;
}

/* Calls `see` for every free arc of the present circle. */
static void each_arc(roll *v, void (*see)(roll *v, const void *circle, const arc *free),
                     const void *circle) {
    const size_t n = v->hidden_count;
    arc free = {0.0, turn, true};
    if (!n) {
        see(v, circle, &free);
        return;
    }
    qsort(v->hidden, n, sizeof *v->hidden, by_begin);
    size_t k = 0;
    double end = v->hidden[0].begin + v->hidden[0].width;
    for (size_t i = 0; i < n; i++) /* arcs that extend beyond 2 pi */
        end = fmax(end, v->hidden[i].begin + v->hidden[i].width - turn);
    while (next_arc(v, &k, &end, &free)) see(v, circle, &free);
}

/* --- in space --- */

/* The circle of ball centres that touch particles i and j, about `axis`, from i to j. */
typedef struct circle {
    size_t member[2];
    double axis[3], e1[3], e2[3], radius;
    double height[2]; /* m, from each particle towards the other */
    double angle[2];  /* rad, between the direction from each particle to the ball and the plane of
                         the circle */
} circle;

static void frame_of(circle *c) {
    const double *l = c->axis;
    const int least = fabs(l[0]) < fabs(l[1]) ? (fabs(l[0]) < fabs(l[2]) ? 0 : 2)
                                              : (fabs(l[1]) < fabs(l[2]) ? 1 : 2);
    double across[3] = {0};
    across[least] = 1.0;
    gn_cross3(l, across, c->e2);
    const double size = sqrt(gn_dot3(c->e2, c->e2));
    for (int a = 0; a < 3; a++) c->e2[a] /= size;
    gn_cross3(c->e2, l, c->e1);
}

/* Finds the plane in which the sphere of j cuts that of i; false: they do not intersect. */
static bool cuts(const roll *v, size_t i, size_t j, double *length, double *height) {
    const double s = reach_of(v, i), t = reach_of(v, j);
    double way[3];
    way_between(v, i, j, way);
    *length = sqrt(gn_dot3(way, way));
    *height = (*length * *length + s * s - t * t) / (2.0 * *length);
    return s * s - *height * *height > contact * s * s;
}

static bool circle_of(const roll *v, size_t i, size_t j, circle *c) {
    double length;
    c->member[0] = i;
    c->member[1] = j;
    if (!cuts(v, i, j, &length, &c->height[0])) return false;
    c->height[1] = length - c->height[0];
    c->radius = sqrt(reach_of(v, i) * reach_of(v, i) - c->height[0] * c->height[0]);
    way_between(v, i, j, c->axis);
    for (int a = 0; a < 3; a++) c->axis[a] /= length;
    for (int k = 0; k < 2; k++) c->angle[k] = atan2(c->height[k], c->radius);
    frame_of(c);
    return true;
}

static void hide_circle(roll *v, const circle *c) {
    const size_t i = c->member[0], j = c->member[1];
    v->hidden_count = 0;
    for (size_t n = v->start[i]; n < v->start[i + 1]; n++) {
        const size_t k = (size_t)v->neighbour[n];
        double way[3];
        if (k == j) continue;
        way_between(v, i, k, way);
        for (int a = 0; a < 3; a++) way[a] -= c->height[0] * c->axis[a];
        const double x = gn_dot3(way, c->e1), y = gn_dot3(way, c->e2), far = hypot(x, y);
        const double left =
            gn_dot3(way, way) + c->radius * c->radius - reach_of(v, k) * reach_of(v, k);
        const double most = 2.0 * c->radius * far;
        if (left <= -most && left < 0.0) {
            v->hidden[0] = (hidden){0.0, turn};
            v->hidden_count = 1;
            return;
        }
        if (most > 0.0) hide(v, atan2(y, x), left / most);
    }
}

static void radial(const circle *c, double angle, double e[3]) {
    for (int a = 0; a < 3; a++) e[a] = cos(angle) * c->e1[a] + sin(angle) * c->e2[a];
}

/* Computes the unit vector from one of the two particles to the ball at an angle of the circle. */
static void to_ball(const circle *c, int side, double angle, double n[3]) {
    double e[3];
    radial(c, angle, e);
    for (int a = 0; a < 3; a++)
        n[a] = sin(c->angle[side]) * (side ? -c->axis[a] : c->axis[a]) + cos(c->angle[side]) * e[a];
}

/* Returns the solid angle of a triangle of unit vectors, positive if they are anticlockwise seen
 * from outside (van Oosterom & Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125-126). */
static double triangle(const double a[3], const double b[3], const double c[3]) {
    double across[3];
    gn_cross3(b, c, across);
    return 2.0 * atan2(gn_dot3(a, across), 1.0 + gn_dot3(a, b) + gn_dot3(b, c) + gn_dot3(c, a));
}

/* Returns the solid angle between a pole and an arc that bounds the free part of one particle's
 * sphere. */
static double edge_direction(const circle *c, int side, const arc *free) {
    static const double pole[3] = {0.48, 0.36, 0.8};
    const int parts = 1 + (int)((free->to - free->from) / 2.0);
    const double step = (free->to - free->from) / parts, cosine = sin(c->angle[side]);
    double l[3], sum = -(free->to - free->from) * (1.0 - cosine);
    for (int a = 0; a < 3; a++) l[a] = side ? -c->axis[a] : c->axis[a];
    for (int k = 0; k < parts; k++) {
        double one[3], next[3];
        to_ball(c, side, free->from + step * (k + (side ? 0 : 1)), one);
        to_ball(c, side, free->from + step * (k + (side ? 1 : 0)), next);
        sum += triangle(pole, one, next) - triangle(l, one, next);
    }
    return sum;
}

/* Computes the mean of the unit vectors from the touched particles to a ball; `first`: that from i.
 * */
static void middle_of_cap(const roll *v, size_t i, const double first[3], double middle[3]) {
    const double near = 1e-6;
    memcpy(middle, first, 3 * sizeof *middle);
    for (size_t n = v->start[i]; n < v->start[i + 1]; n++) {
        const size_t k = (size_t)v->neighbour[n];
        double way[3];
        way_between(v, k, i, way);
        for (int a = 0; a < 3; a++) way[a] += reach_of(v, i) * first[a];
        const double far = sqrt(gn_dot3(way, way));
        if (fabs(far - reach_of(v, k)) > near * far) continue;
        for (int a = 0; a < 3; a++) middle[a] += way[a] / far;
    }
    const double size = sqrt(gn_dot3(middle, middle));
    for (int a = 0; a < 3; a++) middle[a] = size > near ? middle[a] / size : first[a];
}

/* Adds the flat sector from a to b of a circle of radius 1. */
static void add_sector(const double a[3], const double b[3], double area[3]) {
    double across[3];
    gn_cross3(a, b, across);
    const double sine = sqrt(gn_dot3(across, across)), angle = atan2(sine, gn_dot3(a, b));
    for (int k = 0; k < 3; k++) area[k] += 0.5 * (sine > 1e-12 ? angle / sine : 1.0) * across[k];
}

/* Adds a part of the cap at an end of an arc, between the cap's middle and the arc, to the nearer
 * one of the two particles. Its area vector is that of the sectors between its edge and the ball's
 * centre; the sectors from its middle to the touched particles cancel with those of the next arc.
 */
static void add_cap(roll *v, const circle *c, double angle, bool begins) {
    double n[2][3], middle[3], between[3], size = 0.0;
    for (int side = 0; side < 2; side++) to_ball(c, side, angle, n[side]);
    middle_of_cap(v, c->member[0], n[0], middle);
    for (int a = 0; a < 3; a++) {
        between[a] = n[0][a] + n[1][a];
        size += between[a] * between[a];
    }
    if (!(size > 0.0)) return; /* the ball just passes between the two particles */
    for (int a = 0; a < 3; a++) between[a] /= sqrt(size);
    for (int side = 0; side < 2; side++) {
        const size_t p = c->member[side];
        const double sign = (side == 0) != begins
                                ? 1.0
                                : -1.0; /* sense in which the edge of the arc is traversed */
        const double solid = triangle(middle, between, n[side]);
        double area[3] = {0};
        add_sector(middle, between, area);
        add_sector(between, n[side], area);
        for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
            const double t = layer_of(v, k), scale = sign * t * t;
            for (int a = 0; a < 3; a++) v->rolled->area[k][p][a] += scale * area[a];
            v->rolled->arms[k][p] += scale * (reach_of(v, p) * gn_dot3(n[side], area) - t * solid);
        }
    }
}

/* Computes integrals over the meridian of a ring up to an angle: of areas along the radius and
 * along the axis, and of areas times arms from the centre. */
static void meridian(const circle *c, int side, double t, double angle, double sign,
                     double sum[3]) {
    const double r = c->radius, h = c->height[side], x = cos(angle), y = sin(angle);
    const double square = 0.5 * (angle + x * y);
    sum[0] += sign * t * (r * y - t * square);
    sum[1] += sign * t * (0.5 * t * x * x - r * x);
    sum[2] +=
        sign * t *
        (r * r * y - r * h * x - r * t * angle + 0.5 * t * h * x * x - r * t * square + t * t * y);
}

/* Adds the contribution of an arc to one of its particles: touched surface and ring. */
static void add_side(roll *v, const circle *c, const arc *free, int side) {
    const size_t p = c->member[side];
    const double width = free->to - free->from, r = c->radius;
    const double middle = 0.5 * (c->angle[side] - c->angle[!side]);
    double e0[3], e1[3], between[3], across[3];
    radial(c, free->from, e0);
    radial(c, free->to, e1);
    for (int a = 0; a < 3; a++) between[a] = e1[a] - e0[a];
    gn_cross3(c->axis, between, across);
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        const double t = layer_of(v, k), share = 1.0 - t / reach_of(v, p);
        double ring[3] = {0};
        meridian(c, side, t, c->angle[side], 1.0, ring);
        meridian(c, side, t, middle, -1.0, ring);
        for (int a = 0; a < 3; a++) {
            const double along = side ? -c->axis[a] : c->axis[a];
            const double touched = c->height[side] * r * across[a] + r * r * width * along;
            v->rolled->area[k][p][a] +=
                -0.5 * share * share * touched - ring[0] * across[a] + ring[1] * width * along;
        }
        v->rolled->arms[k][p] += width * ring[2];
    }
    v->direction[p] += edge_direction(c, side, free);
    v->touched[p] = true;
}

static void add_arc(roll *v, const void *of, const arc *free) {
    const circle *c = of;
    for (int side = 0; side < 2; side++) add_side(v, c, free, side);
    if (free->whole) return;
    add_cap(v, c, free->from, true);
    add_cap(v, c, free->to, false);
}

static void roll_in_space(roll *v, size_t i) {
    circle c;
    for (size_t n = v->start[i]; n < v->start[i + 1]; n++) {
        const size_t j = (size_t)v->neighbour[n];
        double length, height;
        v->bounded[i] = v->bounded[i] || cuts(v, i, j, &length, &height);
        if (j < i || !circle_of(v, i, j, &c)) continue;
        hide_circle(v, &c);
        each_arc(v, add_arc, &c);
    }
}

/* Tells whether the sphere of a larger neighbour encloses that of a particle. */
static bool is_enclosed(const roll *v, size_t p) {
    for (size_t n = v->start[p]; n < v->start[p + 1]; n++) {
        const size_t k = (size_t)v->neighbour[n];
        double way[3];
        way_between(v, p, k, way);
        if (sqrt(gn_dot3(way, way)) + reach_of(v, p) <= reach_of(v, k)) return true;
    }
    return false;
}

/* Adds the touched part of a sphere, which its edges determine unless the whole sphere is free. */
static void add_touched(roll *v, size_t p) {
    const double sphere = 2.0 * turn;
    double sum = v->bounded[p] || is_enclosed(v, p) ? v->direction[p] : sphere;
    sum -= sphere * floor((sum + contact) / sphere);
    for (int k = 0; k < GN_ROLLED_LAYERS; k++)
        v->rolled->arms[k][p] += pow(reach_of(v, p) - layer_of(v, k), 3.0) * sum;
    v->touched[p] = v->touched[p] || sum > 0.5 * sphere;
}

/* --- in the plane --- */

/* Computes the unit vector to the ball from the middle of its arc between two points of contact;
 * the ball is at an end (`angle`) of the touched part of i. Adds the share of i in that arc to its
 * arms. */
static void middle_of_arc(roll *v, size_t i, double angle, double middle[3]) {
    const double n[3] = {cos(angle), sin(angle), 0.0};
    middle_of_cap(v, i, n, middle);
    const double half = acos(fmin(gn_dot3(n, middle), 1.0));
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        const double t = layer_of(v, k);
        v->rolled->arms[k][i] += t * (reach_of(v, i) * sin(half) - t * half);
    }
}

static void add_plane_arc(roll *v, const void *of, const arc *free) {
    const size_t i = *(const size_t *)of;
    const double reach = reach_of(v, i), width = free->to - free->from;
    double from[3], to[3];
    v->touched[i] = true;
    for (int k = 0; k < GN_ROLLED_LAYERS; k++)
        v->rolled->arms[k][i] += pow(reach - layer_of(v, k), 2.0) * width;
    if (free->whole) return;
    middle_of_arc(v, i, free->from, from);
    middle_of_arc(v, i, free->to, to);
    for (int k = 0; k < GN_ROLLED_LAYERS; k++) {
        const double t = layer_of(v, k);
        const double x = reach * (cos(free->to) - cos(free->from)) - t * (to[0] - from[0]);
        const double y = reach * (sin(free->to) - sin(free->from)) - t * (to[1] - from[1]);
        v->rolled->area[k][i][0] += y;
        v->rolled->area[k][i][1] -= x;
    }
}

static void roll_in_plane(roll *v, size_t i) {
    v->hidden_count = 0;
    if (is_enclosed(v, i)) return;
    for (size_t n = v->start[i]; n < v->start[i + 1]; n++) {
        const size_t j = (size_t)v->neighbour[n];
        double length, height, way[3];
        if (!cuts(v, i, j, &length, &height)) continue;
        way_between(v, i, j, way);
        hide(v, atan2(way[1], way[0]), height / reach_of(v, i));
    }
    each_arc(v, add_plane_arc, &i);
}

/* --- cells --- */

/* Number of directions in which a cell is measured; largest number of cells; number of deep cells
 * that is enough. */
enum { DIRECTIONS = 256, CELLS = 20000, FEW = 8 };

/* Returns direction k of a set that is evenly distributed over the sphere (Fibonacci's spiral) or
 * the circle. */
static void direction_of(int k, int dimension, double u[3]) {
    const double golden = M_PI * (3.0 - sqrt(5.0));
    const double z = dimension == 3 ? 1.0 - (2.0 * k + 1.0) / DIRECTIONS : 0.0;
    const double angle = dimension == 3 ? golden * k : turn * (k + 0.5) / DIRECTIONS;
    u[0] = sqrt(1.0 - z * z) * cos(angle);
    u[1] = sqrt(1.0 - z * z) * sin(angle);
    u[2] = z;
}

/* Returns the extent of a cell in a direction: the distance at which the surface of a neighbour is
 * as near as its own, and at most the particle's reach, because another particle would have room
 * farther out. */
static double extent(const roll *v, size_t i, const double u[3]) {
    double least = reach_of(v, i);
    for (size_t n = v->start[i]; n < v->start[i + 1]; n++) {
        const size_t j = (size_t)v->neighbour[n];
        const double more = place_of(v, j)[3] - place_of(v, i)[3];
        double way[3];
        way_between(v, i, j, way);
        const double along = 2.0 * (gn_dot3(u, way) + more);
        const double square = gn_dot3(way, way) - more * more;
        if (square < least * along) least = square / along;
    }
    return fmax(least, 0.0);
}

/* Tells whether the ball touches neither a particle nor its neighbours; cells of particles just
 * beneath the skin extend up to the ball. */
static bool is_deep(const roll *v, size_t p) {
    const double next = 1.05;
    bool deep = !v->touched[p];
    for (size_t n = v->start[p]; deep && n < v->start[p + 1]; n++) {
        const size_t k = (size_t)v->neighbour[n];
        double way[3];
        way_between(v, p, k, way);
        deep = !v->touched[k] ||
               sqrt(gn_dot3(way, way)) > next * (place_of(v, p)[3] + place_of(v, k)[3]);
    }
    return deep;
}

static void measure_cells(const roll *v) {
    const gn_rolled *r = v->rolled;
    const size_t n = r->particles->soa.count;
    size_t inside = 0, deep = 0, at = 0;
    for (size_t p = 0; p < n; p++) inside += !v->touched[p], deep += is_deep(v, p);
    const size_t every = 1 + (deep < FEW ? inside : deep) / CELLS;
    for (size_t p = 0; p < n; p++) {
        double sum = 0.0, u[3];
        if (deep < FEW ? v->touched[p] : !is_deep(v, p)) continue;
        if (at++ % every != 0) continue;
        for (int k = 0; k < DIRECTIONS; k++) {
            direction_of(k, r->dimension, u);
            const double far = extent(v, p, u);
            sum += r->dimension == 3 ? 2.0 / 3.0 * far * far * far : far * far;
        }
        r->cell[p] = M_PI * sum * (r->dimension == 3 ? 2.0 : 1.0) / DIRECTIONS;
    }
}

/* --- all parts --- */

static void list_neighbours(roll *v) {
    const gn_pair_list *pairs = v->rolled->pairs;
    const size_t n = v->rolled->particles->soa.count;
    for (size_t c = 0; c < pairs->count; c++)
        for (int side = 0; side < 2; side++) v->start[pairs->pair[c][side] + 2]++;
    for (size_t p = 0; p < n; p++) v->start[p + 2] += v->start[p + 1];
    for (size_t c = 0; c < pairs->count; c++)
        for (int side = 0; side < 2; side++)
            v->neighbour[v->start[pairs->pair[c][side] + 1]++] = pairs->pair[c][!side];
}

gneiss_status gn_rolled_find(const gn_rolled *rolled, gneiss_error *error) {
    const size_t n = rolled->particles->soa.count;
    roll v = {.rolled = rolled,
              .start = gn_alloc_array(n + 2, sizeof(size_t)),
              .neighbour = gn_alloc_array(2 * rolled->pairs->count + 1, sizeof(int32_t)),
              .bounded = gn_alloc_array(n + 1, sizeof(bool)),
              .touched = gn_alloc_array(n + 1, sizeof(bool)),
              .direction = gn_alloc_array(n + 1, sizeof(double))};
    gneiss_status status = GNEISS_OK;
    size_t most = 0;
    if (v.start && v.neighbour) {
        list_neighbours(&v);
        for (size_t p = 0; p < n; p++)
            most = v.start[p + 1] - v.start[p] > most ? v.start[p + 1] - v.start[p] : most;
        v.hidden = gn_alloc_array(most + 1, sizeof *v.hidden);
    }
    if (!v.hidden || !v.bounded || !v.touched || !v.direction)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the skin of %zu particles", n);
    for (size_t p = 0; p < n && status == GNEISS_OK; p++)
        rolled->dimension == 3 ? roll_in_space(&v, p) : roll_in_plane(&v, p);
    for (size_t p = 0; p < n && status == GNEISS_OK && rolled->dimension == 3; p++)
        add_touched(&v, p);
    if (status == GNEISS_OK) measure_cells(&v);
    gn_free(v.start);
    gn_free(v.neighbour);
    gn_free(v.hidden);
    gn_free(v.bounded);
    gn_free(v.touched);
    gn_free(v.direction);
    return status;
}
