/* Closed surfaces: two triangles at every edge, normals outward, cavities detected. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A surface connected through edges: rows [first, past) of surface.order. */
typedef struct component {
    size_t first, past;
    double lower[3], upper[3];
    double volume; /* m3, > 0 once oriented */
} component;

typedef struct surface {
    const char *name;
    gneiss_error *error;
    const double *node;
    int32_t *triangle; /* [count][3] */
    size_t count;
    int32_t *edge_of; /* [count][3]: edge from corner k to k + 1 */
    size_t edge_count;
    int32_t *edge_triangle; /* [edge_count][2] */
    int32_t *edge_use;      /* [edge_count] number of triangles */
    int32_t *edge_corner;   /* [edge_count] 3 * triangle + k of its first triangle */
    int32_t *order;         /* [count] triangles, by component */
    bool *seen;             /* [count] */
    component *components;
    size_t component_count, component_capacity;
    size_t cavities;
} surface;

static gneiss_status no_memory(const surface *s) {
    return gn_fail(s->error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu triangles", s->name,
                   s->count);
}

static int32_t corner(const surface *s, size_t triangle, int k) {
    return s->triangle[3 * triangle + (size_t)(k % 3)];
}

/* Reverses a triangle; edges move with their corners. */
static void turn(surface *s, size_t triangle) {
    int32_t *node = s->triangle + 3 * triangle, *edge = s->edge_of + 3 * triangle, swap;
    swap = node[1], node[1] = node[2], node[2] = swap;
    swap = edge[0], edge[0] = edge[2], edge[2] = swap;
}

static gneiss_status allocate(surface *s) {
    s->edge_of = gn_alloc_array(s->count, 3 * sizeof *s->edge_of);
    s->edge_triangle = gn_alloc_array(3 * s->count, 2 * sizeof *s->edge_triangle);
    s->edge_use = gn_alloc_array(3 * s->count, sizeof *s->edge_use);
    s->edge_corner = gn_alloc_array(3 * s->count, sizeof *s->edge_corner);
    s->order = gn_alloc_array(s->count, sizeof *s->order);
    s->seen = gn_alloc_array(s->count, sizeof *s->seen);
    bool room =
        s->edge_of && s->edge_triangle && s->edge_use && s->edge_corner && s->order && s->seen;
    return room ? GNEISS_OK : no_memory(s);
}

static gneiss_status find_edges(surface *s) {
    gn_mesh_table table = {0};
    bool room = true;
    for (size_t k = 0; k < 3 * s->count && room; k++) {
        size_t triangle = k / 3;
        int side = (int)(k % 3);
        int32_t ends[2] = {corner(s, triangle, side), corner(s, triangle, side + 1)};
        int64_t edge;
        room = gn_mesh_table_add(&table, gn_mesh_face_key(ends, 2), (int64_t)s->edge_count, &edge);
        if (!room) break;
        if ((size_t)edge == s->edge_count) s->edge_corner[s->edge_count++] = (int32_t)k;
        s->edge_of[k] = (int32_t)edge;
        int32_t use = s->edge_use[edge]++;
        if (use < 2) s->edge_triangle[2 * edge + use] = (int32_t)triangle;
    }
    gn_mesh_table_free(&table);
    return room ? GNEISS_OK : no_memory(s);
}

static gneiss_status refuse_edge(const surface *s, size_t edge, const char *what) {
    size_t at = (size_t)s->edge_corner[edge];
    const double *a = s->node + 3 * (size_t)corner(s, at / 3, (int)(at % 3));
    const double *b = s->node + 3 * (size_t)corner(s, at / 3, (int)(at % 3) + 1);
    return gn_fail(s->error, GNEISS_ERROR_INPUT,
                   "%s: the edge from (%.9g %.9g %.9g) to (%.9g %.9g %.9g) %s", s->name, a[0], a[1],
                   a[2], b[0], b[1], b[2], what);
}

static gneiss_status check_closed(const surface *s) {
    size_t open = 0, overfull = 0, first = s->edge_count;
    for (size_t e = 0; e < s->edge_count; e++) {
        if (s->edge_use[e] == 2) continue;
        if (first == s->edge_count) first = e;
        if (s->edge_use[e] == 1)
            open++;
        else
            overfull++;
    }
    if (first == s->edge_count) return GNEISS_OK;
    char why[256];
    snprintf(why, sizeof why,
             "belongs to %d triangle%s: expected a closed surface (two at every edge), found %zu "
             "open edges and %zu with more than two triangles",
             (int)s->edge_use[first], s->edge_use[first] == 1 ? "" : "s", open, overfull);
    return refuse_edge(s, first, why);
}

/* Tells whether both triangles of an edge traverse it in opposite senses. */
static bool same_sense(const surface *s, size_t edge) {
    int32_t start[2] = {-1, -1};
    for (int t = 0; t < 2; t++) {
        size_t triangle = (size_t)s->edge_triangle[2 * edge + (size_t)t];
        for (int k = 0; k < 3; k++)
            if (s->edge_of[3 * triangle + (size_t)k] == (int32_t)edge)
                start[t] = corner(s, triangle, k);
    }
    return start[0] == start[1];
}

/* Visits the component of order[first] over edges and reverses triangles against their
 * neighbours. */
static gneiss_status spread(surface *s, size_t first, size_t *past) {
    *past = first + 1;
    for (size_t at = first; at < *past; at++) {
        size_t triangle = (size_t)s->order[at];
        for (size_t k = 0; k < 3; k++) {
            size_t edge = (size_t)s->edge_of[3 * triangle + k];
            const int32_t *two = s->edge_triangle + 2 * edge;
            size_t other = (size_t)(two[0] == (int32_t)triangle ? two[1] : two[0]);
            if (!s->seen[other]) {
                if (same_sense(s, edge)) turn(s, other);
                s->seen[other] = true;
                s->order[(*past)++] = (int32_t)other;
            } else if (same_sense(s, edge)) {
                return refuse_edge(s, edge,
                                   "is where the surface meets its own other side: expected a "
                                   "surface with an inside, found a one-sided one");
            }
        }
    }
    return GNEISS_OK;
}

/* Computes the volume by the divergence theorem with an apex on the surface, so that a far origin
 * costs no digits. */
static gneiss_status measure(surface *s, component *c) {
    const double *apex = s->node + 3 * (size_t)corner(s, (size_t)s->order[c->first], 0);
    double area = 0.0, extent = 0.0;
    memcpy(c->lower, apex, sizeof c->lower);
    memcpy(c->upper, apex, sizeof c->upper);
    c->volume = 0.0;
    for (size_t row = c->first; row < c->past; row++) {
        double at[3][3], u[3], v[3], normal[3];
        for (int k = 0; k < 3; k++) {
            const double *x = s->node + 3 * (size_t)corner(s, (size_t)s->order[row], k);
            gn_mesh_between(apex, x, at[k]);
            for (int d = 0; d < 3; d++) {
                c->lower[d] = fmin(c->lower[d], x[d]);
                c->upper[d] = fmax(c->upper[d], x[d]);
            }
        }
        gn_mesh_between(at[0], at[1], u);
        gn_mesh_between(at[0], at[2], v);
        gn_mesh_cross(u, v, normal);
        area += sqrt(gn_mesh_dot(normal, normal)) / 2.0;
        c->volume += gn_mesh_dot(at[0], normal) / 6.0;
    }
    for (int d = 0; d < 3; d++) extent = fmax(extent, c->upper[d] - c->lower[d]);
    /* Rounding alone gives volumes of about 1e-16 of this product. */
    if (isfinite(area * extent) && fabs(c->volume) > 1e-13 * area * extent) return GNEISS_OK;
    return gn_fail(s->error, GNEISS_ERROR_INPUT,
                   "%s: expected surfaces that enclose a volume, found one of %zu triangles at "
                   "(%.9g %.9g %.9g) that encloses %g m3",
                   s->name, c->past - c->first, apex[0], apex[1], apex[2], c->volume);
}

static void turn_component(surface *s, const component *c) {
    for (size_t row = c->first; row < c->past; row++) turn(s, (size_t)s->order[row]);
}

static gneiss_status find_components(surface *s) {
    size_t done = 0;
    for (size_t t = 0; t < s->count; t++) {
        if (s->seen[t]) continue;
        component one = {.first = done};
        s->seen[t] = true;
        s->order[done] = (int32_t)t;
        GN_TRY(spread(s, one.first, &one.past));
        GN_TRY(measure(s, &one));
        if (one.volume < 0.0) {
            turn_component(s, &one);
            one.volume = -one.volume;
        }
        void *components = s->components;
        if (!gn_mesh_grow(&components, &s->component_capacity, s->component_count,
                          s->component_count + 1, sizeof one))
            return no_memory(s);
        s->components = components;
        s->components[s->component_count++] = one;
        done = one.past;
    }
    return GNEISS_OK;
}

/* Returns the solid angle of a triangle (van Oosterom and Strackee 1983, eq. 8) summed over the
 * surface and divided by 4 pi: 1 inside, 0 outside, NaN on it. */
static double winding(const surface *s, const component *c, const double x[3]) {
    double sum = 0.0;
    for (size_t row = c->first; row < c->past; row++) {
        double r[3][3], length[3], normal[3];
        for (int k = 0; k < 3; k++) {
            gn_mesh_between(x, s->node + 3 * (size_t)corner(s, (size_t)s->order[row], k), r[k]);
            length[k] = sqrt(gn_mesh_dot(r[k], r[k]));
        }
        gn_mesh_cross(r[1], r[2], normal);
        double above = gn_mesh_dot(r[0], normal);
        double below = length[0] * length[1] * length[2] + gn_mesh_dot(r[0], r[1]) * length[2] +
                       gn_mesh_dot(r[1], r[2]) * length[0] + gn_mesh_dot(r[2], r[0]) * length[1];
        /* In the plane of the triangle and within it, rounding would decide the side. */
        if (below <= 0.0 && fabs(above) <= 1e-12 * length[0] * length[1] * length[2]) return NAN;
        sum += 2.0 * atan2(above, below);
    }
    return sum / (4.0 * pi);
}

static bool box_inside(const component *inner, const component *outer) {
    for (int d = 0; d < 3; d++)
        if (inner->lower[d] < outer->lower[d] || inner->upper[d] > outer->upper[d]) return false;
    return true;
}

/* Tests centroids of triangles and not corners, since bodies may touch in corners. */
static gneiss_status lies_in(const surface *s, const component *inner, const component *outer,
                             bool *inside) {
    enum { TRIES = 16 };
    *inside = false;
    if (!box_inside(inner, outer)) return GNEISS_OK;
    double x[3] = {0};
    for (size_t row = inner->first; row < inner->past && row < inner->first + TRIES; row++) {
        for (int d = 0; d < 3; d++) {
            x[d] = 0.0;
            for (int k = 0; k < 3; k++)
                x[d] += s->node[3 * (size_t)corner(s, (size_t)s->order[row], k) + (size_t)d] / 3.0;
        }
        double turns = winding(s, outer, x);
        if (!(fabs(turns - nearbyint(turns)) < 1e-3)) continue;
        *inside = fabs(turns) > 0.5;
        return GNEISS_OK;
    }
    return gn_fail(s->error, GNEISS_ERROR_INPUT,
                   "%s: expected bodies and cavities apart from each other, found two surfaces "
                   "that lie on each other at (%.9g %.9g %.9g)",
                   s->name, x[0], x[1], x[2]);
}

static gneiss_status turn_cavities(surface *s, double *volume) {
    *volume = 0.0;
    for (size_t i = 0; i < s->component_count; i++) {
        const component *c = &s->components[i];
        bool cavity = false, inside;
        for (size_t j = 0; j < s->component_count; j++) {
            if (j == i) continue;
            GN_TRY(lies_in(s, c, &s->components[j], &inside));
            cavity = cavity != inside;
        }
        if (cavity) turn_component(s, c);
        s->cavities += cavity;
        *volume += cavity ? -c->volume : c->volume;
    }
    if (isfinite(*volume) && *volume > 0.0) return GNEISS_OK;
    return gn_fail(s->error, GNEISS_ERROR_INPUT, "%s: expected a volume > 0, found %g m3", s->name,
                   *volume);
}

static gneiss_status close_surface(surface *s, double *volume) {
    if (s->count == 0)
        return gn_fail(s->error, GNEISS_ERROR_INPUT, "%s: expected a surface, found no triangles",
                       s->name);
    if (s->count > INT32_MAX / 3)
        return gn_fail(s->error, GNEISS_ERROR_INPUT, "%s: expected at most %d triangles, found %zu",
                       s->name, INT32_MAX / 3, s->count);
    GN_TRY(allocate(s));
    GN_TRY(find_edges(s));
    GN_TRY(check_closed(s));
    GN_TRY(find_components(s));
    return turn_cavities(s, volume);
}

gneiss_status gn_mesh_close_surface(gn_mesh *mesh, const char *name, double *volume,
                                    gneiss_error *error) {
    surface s = {.name = name, .error = error, .node = mesh->node};
    s.triangle = mesh->triangles.node;
    s.count = mesh->triangles.count;
    gneiss_status status = close_surface(&s, volume);
    mesh->cavities = s.cavities;
    gn_free(s.edge_of);
    gn_free(s.edge_triangle);
    gn_free(s.edge_use);
    gn_free(s.edge_corner);
    gn_free(s.order);
    gn_free(s.seen);
    gn_free(s.components);
    return status;
}
