/* Surfaces of cutting tools: bodies of revolution from a profile, and prisms from an outline. Both
 * are chains of points, some corners of which are rounded. */
#include "surfaces/tool_shape.h"

#include "base/memory.h"
#include "base/new.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
/* Ratio of the lengths of successive facets with increasing distance from the tip. */
static const double growth = 1.3;
enum { ARC_LEAST = 3, CORNERS = 8, LARGEST = 1 << 18 };

/* A point of an outline: distance from the axis and coordinate along it, or x and height. */
typedef struct point {
    double x, y;
} point;

/* A corner of a chain before it is rounded. */
typedef struct corner {
    point at;
    double radius; /* m, radius of its rounding */
    bool tip;      /* the edge to the next corner belongs to the tip, with facets of one size */
} corner;

typedef struct chain {
    point *at;
    size_t count;
} chain;

static double distance(point a, point b) {
    return hypot(b.x - a.x, b.y - a.y);
}

static point between(point a, point b, double share) {
    return (point){a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

/* Returns half of the angle between the two edges of a corner. */
static double half_angle(point before, point at, point after) {
    const double a = distance(at, before), b = distance(at, after);
    const double cosine =
        ((before.x - at.x) * (after.x - at.x) + (before.y - at.y) * (after.y - at.y)) / (a * b);
    return 0.5 * acos(fmax(-1.0, fmin(1.0, cosine)));
}

/* Returns the length that the rounding of a corner takes from each of its edges. */
static double taken(const corner *list, size_t count, size_t k) {
    if (!(list[k].radius > 0.0)) return 0.0;
    return list[k].radius /
           tan(half_angle(list[(k + count - 1) % count].at, list[k].at, list[(k + 1) % count].at));
}

static void put(chain *c, point at) {
    c->at[c->count++] = at;
}

/* Adds the arc that rounds a corner, or the corner itself. */
static void put_corner(const corner *list, size_t count, size_t k, double facet, chain *c) {
    const point at = list[k].at, before = list[(k + count - 1) % count].at,
                after = list[(k + 1) % count].at;
    const double length = taken(list, count, k), half = half_angle(before, at, after);
    if (!(length > 0.0)) {
        put(c, at);
        return;
    }
    const point first = between(at, before, length / distance(at, before)),
                last = between(at, after, length / distance(at, after)),
                centre = between(at, between(first, last, 0.5), 1.0 / (cos(half) * cos(half)));
    const double turn = pi - 2.0 * half, steps = ceil(list[k].radius * turn / facet);
    const int n = (int)fmax(ARC_LEAST, fmin(steps, LARGEST));
    const double cross =
        (at.x - before.x) * (after.y - at.y) - (at.y - before.y) * (after.x - at.x);
    const point arm = {first.x - centre.x, first.y - centre.y};
    for (int i = 0; i <= n; i++) {
        const double angle = copysign(turn, cross) * i / n, cosine = cos(angle), sine = sin(angle);
        put(c, (point){centre.x + cosine * arm.x - sine * arm.y,
                       centre.y + sine * arm.x + cosine * arm.y});
    }
}

/* Adds the points within an edge: equally spaced at the tip, elsewhere with spacing that grows away
 * from the tip. */
static void put_edge(point from, point to, bool tip, double facet, chain *c) {
    const double length = distance(from, to);
    if (tip) {
        const int n = (int)fmin(ceil(length / facet - 1e-9), LARGEST);
        for (int i = 1; i < n; i++) put(c, between(from, to, (double)i / n));
        return;
    }
    double sum = 0.0;
    int n = 0;
    for (double step = facet; sum < length && n < 64; step *= growth, n++) sum += step;
    double at = 0.0, step = facet * length / sum;
    for (int i = 1; i < n; i++, step *= growth) put(c, between(from, to, (at += step) / length));
}

static point reversed_edge(chain *c, size_t begin, point from, point to) {
    for (size_t k = begin; k < c->count; k++)
        c->at[k] = (point){from.x + to.x - c->at[k].x, from.y + to.y - c->at[k].y};
    for (size_t i = begin, j = c->count; i + 1 < j; i++) {
        const point swap = c->at[i];
        c->at[i] = c->at[--j];
        c->at[j] = swap;
    }
    return to;
}

/* Rounds the corners and divides the edges of a closed chain. On an edge that leads towards the
 * tip, spacing decreases. `split`: edges are divided. */
static gneiss_status make_chain(const corner *list, size_t count, double facet, bool split,
                                chain *c, gneiss_error *error) {
    size_t most = 0;
    for (size_t k = 0; k < count; k++) {
        const double edge = distance(list[k].at, list[(k + 1) % count].at);
        if (taken(list, count, k) + taken(list, count, (k + 1) % count) > edge * (1.0 + 1e-9))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "tip_radius: expected a rounding that fits into the edges of the tip, "
                           "found %g m",
                           fmax(list[k].radius, list[(k + 1) % count].radius));
        most += (size_t)fmin(edge / facet + 2.0 * pi * list[k].radius / facet, LARGEST) + 80;
    }
    GN_TRY(gn_new(&c->at, most, "the outline of a tool", error));
    for (size_t k = 0; k < count; k++) {
        const size_t next = (k + 1) % count;
        put_corner(list, count, k, facet, c);
        const double edge = distance(list[k].at, list[next].at), end = taken(list, count, next);
        const point from = c->at[c->count - 1], to = between(list[next].at, list[k].at, end / edge);
        const size_t begin = c->count;
        if (!split || distance(from, to) < 1e-9 * edge) {
            if (distance(from, to) < 1e-9 * edge)
                c->count--; /* the roundings of two corners overlap */
            continue;
        }
        put_edge(from, to, list[k].tip, facet, c);
        if (list[next].tip && !list[k].tip) reversed_edge(c, begin, from, to);
    }
    return GNEISS_OK;
}

/* --- surfaces --- */

static gneiss_status allocate(gn_mesh *mesh, size_t nodes, size_t triangles, gneiss_error *error) {
    *mesh = (gn_mesh){.triangles.nodes = 3};
    if (nodes > INT32_MAX / 4 || triangles > INT32_MAX / 4)
        return gn_fail(error, GNEISS_ERROR_INPUT, "facet: expected fewer than %d facets, found %zu",
                       INT32_MAX / 4, triangles);
    mesh->node = gn_alloc_array(nodes, 3 * sizeof *mesh->node);
    mesh->triangles.node = gn_alloc_array(triangles, 3 * sizeof *mesh->triangles.node);
    mesh->triangles.group = gn_alloc_array(triangles, sizeof *mesh->triangles.group);
    if (mesh->node && mesh->triangles.node && mesh->triangles.group) return GNEISS_OK;
    gn_mesh_free(mesh);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a tool of %zu facets", triangles);
}

static void put_node(gn_mesh *mesh, double x, double y, double z) {
    double *at = mesh->node + 3 * mesh->node_count++;
    at[0] = x;
    at[1] = y;
    at[2] = z;
}

static void put_triangle(gn_mesh *mesh, size_t a, size_t b, size_t c) {
    int32_t *t = mesh->triangles.node + 3 * mesh->triangles.count++;
    t[0] = (int32_t)a;
    t[1] = (int32_t)b;
    t[2] = (int32_t)c;
}

static void put_quadrangle(gn_mesh *mesh, size_t a, size_t b, size_t c, size_t d) {
    put_triangle(mesh, a, b, c);
    put_triangle(mesh, a, c, d);
}

/* Revolves a chain: a closed one about y (`axis` 1), or one between two points of the axis about z
 * (2). On the outside the chain runs upward along the axis. */
static gneiss_status revolve(const chain *c, int axis, size_t sides, gn_mesh *mesh,
                             gneiss_error *error) {
    const size_t n = c->count, closed = c->at[0].x > 0.0;
    GN_TRY(allocate(mesh, n * sides + 2, 2 * n * sides, error));
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    for (size_t k = 0; k < n; k++)
        for (size_t s = 0; s < (c->at[k].x > 0.0 ? sides : 1); s++) {
            const double angle = 2.0 * pi * (double)s / (double)sides;
            double x[3];
            x[first] = c->at[k].x * cos(angle);
            x[second] = c->at[k].x * sin(angle);
            x[axis] = c->at[k].y;
            put_node(mesh, x[0], x[1], x[2]);
        }
    size_t below = 0;
    for (size_t k = 0; k + !closed < n; k++) {
        const size_t next = (k + 1) % n, own = c->at[k].x > 0.0 ? sides : 1,
                     above = next ? below + own : 0;
        for (size_t s = 0; s < sides; s++) {
            const size_t t = (s + 1) % sides;
            if (own == 1)
                put_triangle(mesh, below, above + t, above + s);
            else if (!(c->at[next].x > 0.0))
                put_triangle(mesh, below + s, below + t, above);
            else
                put_quadrangle(mesh, below + s, below + t, above + t, above + s);
        }
        below += own;
    }
    return GNEISS_OK;
}

/* Extrudes a convex outline, which is anticlockwise in (x, z), along y. */
static gneiss_status extrude(const chain *c, double width, gn_mesh *mesh, gneiss_error *error) {
    const size_t n = c->count;
    GN_TRY(allocate(mesh, 2 * n, 4 * n, error));
    for (size_t k = 0; k < n; k++) put_node(mesh, c->at[k].x, -0.5 * width, c->at[k].y);
    for (size_t k = 0; k < n; k++) put_node(mesh, c->at[k].x, 0.5 * width, c->at[k].y);
    for (size_t k = 0; k < n; k++) {
        const size_t next = (k + 1) % n;
        put_quadrangle(mesh, k, n + k, n + next, next);
        if (k == 0 || next == 0) continue;
        put_triangle(mesh, 0, k, next);
        put_triangle(mesh, n, n + next, n + k);
    }
    return GNEISS_OK;
}

/* --- tools --- */

static double facet_of(const gn_tool_def *t) {
    if (t->facet > 0.0) return t->facet;
    return t->tip_width > 0.0 ? t->tip_width / 6.0 : t->diameter / 12.0;
}

/* Makes the profile of a ring in (radius, y). Rounding lowers its ridge by r (1/sin(bevel/2) - 1).
 */
static gneiss_status ring_profile(const gn_tool_def *t, chain *c, gneiss_error *error) {
    const bool ridge = t->bevel_angle < pi * (1.0 - 1e-9);
    const double half = 0.5 * t->tip_width, bevel = ridge ? half / tan(0.5 * t->bevel_angle) : 0.0;
    const double top =
        0.5 * t->diameter + (ridge ? t->tip_radius * (1.0 / sin(0.5 * t->bevel_angle) - 1.0) : 0.0);
    const double bore = 0.5 * (t->bore > 0.0 ? t->bore : 0.5 * t->diameter);
    if (!(bore < top - bevel))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "bore: expected less than the diameter at the edges of the tip, %g m, found "
                       "%g m",
                       2.0 * (top - bevel), 2.0 * bore);
    const double wide = half + (top - bevel - bore) * tan(t->flank_angle);
    const corner low[2] = {{{bore, -wide}, 0.0, false},
                           {{top - bevel, -half}, t->tip_radius, true}},
                 high[2] = {{{top - bevel, half}, t->tip_radius, false},
                            {{bore, wide}, 0.0, false}};
    corner list[CORNERS];
    size_t count = 0;
    for (size_t k = 0; k < 2; k++) list[count++] = low[k];
    if (ridge) list[count++] = (corner){{top, 0.0}, t->tip_radius, true};
    for (size_t k = 0; k < 2; k++) list[count++] = high[k];
    return make_chain(list, count, facet_of(t), true, c, error);
}

/* Makes the profile of a cone on a cylinder in (radius, z), from the tip on the axis to the upper
 * face. */
static gneiss_status pick_profile(const gn_tool_def *t, chain *c, gneiss_error *error) {
    const double half = 0.5 * t->angle, radius = 0.5 * t->diameter;
    /* The rounded tip is the lowest point. */
    const double sunk = t->tip_radius * (1.0 / sin(half) - 1.0), edge = radius / tan(half) - sunk;
    const double round = t->tip_radius * cos(half), facet = facet_of(t);
    if (!(edge < t->height))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "height: expected more than that of the cone, %g m, found %g m", edge,
                       t->height);
    if (round >= radius)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "tip_radius: expected less than %g m, at which the rounding is as wide as "
                       "the pick, found %g m",
                       radius / cos(half), t->tip_radius);
    const double from = t->tip_radius * (1.0 - sin(half));
    const int n = (int)fmax(ARC_LEAST, ceil(t->tip_radius * (0.5 * pi - half) / facet));
    GN_TRY(gn_new(&c->at, (size_t)n + 80, "the outline of a tool", error));
    put(c, (point){0.0, 0.0});
    for (int i = 1; t->tip_radius > 0.0 && i <= n; i++) {
        const double angle = (0.5 * pi - half) * i / n;
        put(c, (point){t->tip_radius * sin(angle), t->tip_radius * (1.0 - cos(angle))});
    }
    put_edge((point){round, from}, (point){radius, edge}, false, facet, c);
    put(c, (point){radius, edge});
    put(c, (point){radius, t->height});
    put(c, (point){0.0, t->height});
    return GNEISS_OK;
}

/* Makes the outline of a chisel, anticlockwise from the rear of its upper end: the lower face rises
 * backward by the clearance angle, the rake face leans backward by the rake angle. Rounding raises
 * the edge, so that the outline is lowered until its lowest point is at 0. */
static gneiss_status chisel_outline(const gn_tool_def *t, chain *c, gneiss_error *error) {
    const double rise = t->length * tan(t->clearance), lean = t->height * tan(t->rake);
    if (t->rake + t->clearance >= 0.5 * pi)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "clearance_angle: expected less than 90 degrees together with the rake "
                       "angle, found %g degrees",
                       (t->rake + t->clearance) * 180.0 / pi);
    if (!(rise < t->height))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "height: expected more than the rise of the lower face, %g m, found %g m",
                       rise, t->height);
    if (!(lean < t->length))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "length: expected more than the rake face leans back, %g m, found %g m",
                       lean, t->length);
    const corner list[] = {{{-t->length, t->height}, 0.0, false},
                           {{-t->length, rise}, 0.0, false},
                           {{0.0, 0.0}, t->tip_radius, false},
                           {{-lean, t->height}, 0.0, false}};
    return make_chain(list, 4, 1e-2 * t->height, false, c, error);
}

static gneiss_status wedge_outline(const gn_tool_def *t, chain *c, gneiss_error *error) {
    const double wide = t->height * tan(0.5 * t->angle);
    const corner list[] = {{{-wide, t->height}, 0.0, false},
                           {{0.0, 0.0}, t->tip_radius, false},
                           {{wide, t->height}, 0.0, false}};
    return make_chain(list, 3, 1e-2 * t->height, false, c, error);
}

static gneiss_status outline(gn_tool_kind kind, const gn_tool_def *t, chain *c,
                             gneiss_error *error) {
    GN_TRY(kind == GN_TOOL_CHISEL ? chisel_outline(t, c, error) : wedge_outline(t, c, error));
    double low = INFINITY;
    for (size_t k = 0; k < c->count; k++) low = fmin(low, c->at[k].y);
    for (size_t k = 0; k < c->count; k++) c->at[k].y -= low;
    return GNEISS_OK;
}

gneiss_status gn_tool_mesh(gn_tool_kind kind, const gn_tool_def *t, gn_mesh *mesh,
                           gneiss_error *error) {
    chain c = {0};
    const bool ring = kind == GN_TOOL_DISC_CUTTER, round = ring || kind == GN_TOOL_PICK;
    const double sides = fmax(12.0, ceil(pi * t->diameter / facet_of(t)));
    *mesh = (gn_mesh){0};
    if (round && sides > LARGEST)
        return gn_fail(error, GNEISS_ERROR_INPUT, "facet: expected at least %g m, found %g m",
                       pi * t->diameter / LARGEST, facet_of(t));
    gneiss_status status = ring                   ? ring_profile(t, &c, error)
                           : kind == GN_TOOL_PICK ? pick_profile(t, &c, error)
                                                  : outline(kind, t, &c, error);
    if (status == GNEISS_OK)
        status = round ? revolve(&c, ring ? 1 : 2, (size_t)sides, mesh, error)
                       : extrude(&c, t->width, mesh, error);
    gn_free(c.at);
    return status;
}

gneiss_status gn_tool_outline(gn_tool_kind kind, const gn_tool_def *t, double **points,
                              size_t *count, gneiss_error *error) {
    chain c = {0};
    gneiss_status status = outline(kind, t, &c, error);
    if (status == GNEISS_OK) status = gn_new(points, 2 * c.count, "the outline of a tool", error);
    for (size_t k = 0; status == GNEISS_OK && k < c.count; k++) {
        (*points)[2 * k] = c.at[k].x;
        (*points)[2 * k + 1] = c.at[k].y;
    }
    *count = c.count;
    gn_free(c.at);
    return status;
}
