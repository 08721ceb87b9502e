/* Closed surfaces: two triangles at every edge, normals outward, cavities detected. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A part of the surface that is connected through edges: rows [first, past) of surface.order. */
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

static gneiss_status no_memory(const surface *shell) {
    return gn_fail(shell->error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu triangles",
                   shell->name, shell->count);
}

static int32_t corner(const surface *shell, size_t triangle, int k) {
    return shell->triangle[3 * triangle + (size_t)(k % 3)];
}

/* Reverses a triangle; its edges move with its corners. */
static void turn(surface *shell, size_t triangle) {
    int32_t *node = shell->triangle + 3 * triangle, *edge = shell->edge_of + 3 * triangle, swap;
    swap = node[1], node[1] = node[2], node[2] = swap;
    swap = edge[0], edge[0] = edge[2], edge[2] = swap;
}

static gneiss_status allocate(surface *shell) {
    shell->edge_of = gn_alloc_array(shell->count, 3 * sizeof *shell->edge_of);
    shell->edge_triangle = gn_alloc_array(3 * shell->count, 2 * sizeof *shell->edge_triangle);
    shell->edge_use = gn_alloc_array(3 * shell->count, sizeof *shell->edge_use);
    shell->edge_corner = gn_alloc_array(3 * shell->count, sizeof *shell->edge_corner);
    shell->order = gn_alloc_array(shell->count, sizeof *shell->order);
    shell->seen = gn_alloc_array(shell->count, sizeof *shell->seen);
    bool room = shell->edge_of && shell->edge_triangle && shell->edge_use && shell->edge_corner &&
                shell->order && shell->seen;
    return room ? GNEISS_OK : no_memory(shell);
}

static gneiss_status find_edges(surface *shell) {
    gn_mesh_table table = {0};
    bool room = true;
    for (size_t k = 0; k < 3 * shell->count && room; k++) {
        size_t triangle = k / 3;
        int side = (int)(k % 3);
        int32_t ends[2] = {corner(shell, triangle, side), corner(shell, triangle, side + 1)};
        int64_t edge;
        room =
            gn_mesh_table_add(&table, gn_mesh_face_key(ends, 2), (int64_t)shell->edge_count, &edge);
        if (!room) break;
        if ((size_t)edge == shell->edge_count) shell->edge_corner[shell->edge_count++] = (int32_t)k;
        shell->edge_of[k] = (int32_t)edge;
        int32_t use = shell->edge_use[edge]++;
        if (use < 2) shell->edge_triangle[2 * edge + use] = (int32_t)triangle;
    }
    gn_mesh_table_free(&table);
    return room ? GNEISS_OK : no_memory(shell);
}

static gneiss_status refuse_edge(const surface *shell, size_t edge, const char *what) {
    size_t at = (size_t)shell->edge_corner[edge];
    const double *a = shell->node + 3 * (size_t)corner(shell, at / 3, (int)(at % 3));
    const double *b = shell->node + 3 * (size_t)corner(shell, at / 3, (int)(at % 3) + 1);
    return gn_fail(shell->error, GNEISS_ERROR_INPUT,
                   "%s: the edge from (%.9g %.9g %.9g) to (%.9g %.9g %.9g) %s", shell->name, a[0],
                   a[1], a[2], b[0], b[1], b[2], what);
}

static gneiss_status check_closed(const surface *shell) {
    size_t open = 0, overfull = 0, first = shell->edge_count;
    for (size_t e = 0; e < shell->edge_count; e++) {
        if (shell->edge_use[e] == 2) continue;
        if (first == shell->edge_count) first = e;
        if (shell->edge_use[e] == 1)
            open++;
        else
            overfull++;
    }
    if (first == shell->edge_count) return GNEISS_OK;
    char why[256];
    snprintf(why, sizeof why,
             "belongs to %d triangle%s: expected a closed surface (two at every edge), found %zu "
             "open edges and %zu with more than two triangles",
             (int)shell->edge_use[first], shell->edge_use[first] == 1 ? "" : "s", open, overfull);
    return refuse_edge(shell, first, why);
}

/* Tells whether the two triangles of an edge traverse it in opposite senses. */
static bool same_sense(const surface *shell, size_t edge) {
    int32_t start[2] = {-1, -1};
    for (int t = 0; t < 2; t++) {
        size_t triangle = (size_t)shell->edge_triangle[2 * edge + (size_t)t];
        for (int k = 0; k < 3; k++)
            if (shell->edge_of[3 * triangle + (size_t)k] == (int32_t)edge)
                start[t] = corner(shell, triangle, k);
    }
    return start[0] == start[1];
}

/* Visits the component of order[first] through edges, and reverses triangles that are not oriented
 * like their neighbours. */
static gneiss_status spread(surface *shell, size_t first, size_t *past) {
    *past = first + 1;
    for (size_t at = first; at < *past; at++) {
        size_t triangle = (size_t)shell->order[at];
        for (size_t k = 0; k < 3; k++) {
            size_t edge = (size_t)shell->edge_of[3 * triangle + k];
            const int32_t *two = shell->edge_triangle + 2 * edge;
            size_t other = (size_t)(two[0] == (int32_t)triangle ? two[1] : two[0]);
            if (!shell->seen[other]) {
                if (same_sense(shell, edge)) turn(shell, other);
                shell->seen[other] = true;
                shell->order[(*past)++] = (int32_t)other;
            } else if (same_sense(shell, edge)) {
                return refuse_edge(shell, edge,
                                   "is where the surface meets its own other side: expected a "
                                   "surface with an inside, found a one-sided one");
            }
        }
    }
    return GNEISS_OK;
}

/* Computes the volume by the divergence theorem with an apex on the surface, so that no digits are
 * lost if the origin is distant. */
static gneiss_status measure(surface *shell, component *part) {
    const double *apex =
        shell->node + 3 * (size_t)corner(shell, (size_t)shell->order[part->first], 0);
    double area = 0.0, extent = 0.0;
    memcpy(part->lower, apex, sizeof part->lower);
    memcpy(part->upper, apex, sizeof part->upper);
    part->volume = 0.0;
    for (size_t row = part->first; row < part->past; row++) {
        double at[3][3], u[3], v[3], normal[3];
        for (int k = 0; k < 3; k++) {
            const double *x = shell->node + 3 * (size_t)corner(shell, (size_t)shell->order[row], k);
            gn_mesh_between(apex, x, at[k]);
            for (int d = 0; d < 3; d++) {
                part->lower[d] = fmin(part->lower[d], x[d]);
                part->upper[d] = fmax(part->upper[d], x[d]);
            }
        }
        gn_mesh_between(at[0], at[1], u);
        gn_mesh_between(at[0], at[2], v);
        gn_mesh_cross(u, v, normal);
        area += sqrt(gn_mesh_dot(normal, normal)) / 2.0;
        part->volume += gn_mesh_dot(at[0], normal) / 6.0;
    }
    for (int d = 0; d < 3; d++) extent = fmax(extent, part->upper[d] - part->lower[d]);
    /* By rounding alone, volumes are about 1e-16 of this product. */
    if (isfinite(area * extent) && fabs(part->volume) > 1e-13 * area * extent) return GNEISS_OK;
    return gn_fail(shell->error, GNEISS_ERROR_INPUT,
                   "%s: expected surfaces that enclose a volume, found one of %zu triangles at "
                   "(%.9g %.9g %.9g) that encloses %g m3",
                   shell->name, part->past - part->first, apex[0], apex[1], apex[2], part->volume);
}

static void turn_component(surface *shell, const component *part) {
    for (size_t row = part->first; row < part->past; row++) turn(shell, (size_t)shell->order[row]);
}

static gneiss_status find_components(surface *shell) {
    size_t done = 0;
    for (size_t t = 0; t < shell->count; t++) {
        if (shell->seen[t]) continue;
        component one = {.first = done};
        shell->seen[t] = true;
        shell->order[done] = (int32_t)t;
        GN_TRY(spread(shell, one.first, &one.past));
        GN_TRY(measure(shell, &one));
        if (one.volume < 0.0) {
            turn_component(shell, &one);
            one.volume = -one.volume;
        }
        void *components = shell->components;
        if (!gn_mesh_grow(&components, &shell->component_capacity, shell->component_count,
                          shell->component_count + 1, sizeof one))
            return no_memory(shell);
        shell->components = components;
        shell->components[shell->component_count++] = one;
        done = one.past;
    }
    return GNEISS_OK;
}

/* Returns the solid angle of all triangles (van Oosterom and Strackee 1983, eq. 8) divided by 4 pi:
 * 1 inside, 0 outside, NaN on the surface. */
static double winding(const surface *shell, const component *part, const double x[3]) {
    double sum = 0.0;
    for (size_t row = part->first; row < part->past; row++) {
        double r[3][3], length[3], normal[3];
        for (int k = 0; k < 3; k++) {
            gn_mesh_between(
                x, shell->node + 3 * (size_t)corner(shell, (size_t)shell->order[row], k), r[k]);
            length[k] = sqrt(gn_mesh_dot(r[k], r[k]));
        }
        gn_mesh_cross(r[1], r[2], normal);
        double above = gn_mesh_dot(r[0], normal);
        double below = length[0] * length[1] * length[2] + gn_mesh_dot(r[0], r[1]) * length[2] +
                       gn_mesh_dot(r[1], r[2]) * length[0] + gn_mesh_dot(r[2], r[0]) * length[1];
        /* For a point in the plane of the triangle and within it, rounding would decide the side.
         */
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

/* Tests centroids of triangles and not corners, because bodies may touch at corners. */
static gneiss_status lies_in(const surface *shell, const component *inner, const component *outer,
                             bool *inside) {
    enum { TRIES = 16 };
    *inside = false;
    if (!box_inside(inner, outer)) return GNEISS_OK;
    double x[3] = {0};
    for (size_t row = inner->first; row < inner->past && row < inner->first + TRIES; row++) {
        for (int d = 0; d < 3; d++) {
            x[d] = 0.0;
            for (int k = 0; k < 3; k++)
                x[d] += shell->node[3 * (size_t)corner(shell, (size_t)shell->order[row], k) +
                                    (size_t)d] /
                        3.0;
        }
        double turns = winding(shell, outer, x);
        if (!(fabs(turns - nearbyint(turns)) < 1e-3)) continue;
        *inside = fabs(turns) > 0.5;
        return GNEISS_OK;
    }
    return gn_fail(shell->error, GNEISS_ERROR_INPUT,
                   "%s: expected bodies and cavities apart from each other, found two surfaces "
                   "that lie on each other at (%.9g %.9g %.9g)",
                   shell->name, x[0], x[1], x[2]);
}

static gneiss_status turn_cavities(surface *shell, double *volume) {
    *volume = 0.0;
    for (size_t i = 0; i < shell->component_count; i++) {
        const component *c = &shell->components[i];
        bool cavity = false, inside;
        for (size_t j = 0; j < shell->component_count; j++) {
            if (j == i) continue;
            GN_TRY(lies_in(shell, c, &shell->components[j], &inside));
            cavity = cavity != inside;
        }
        if (cavity) turn_component(shell, c);
        shell->cavities += cavity;
        *volume += cavity ? -c->volume : c->volume;
    }
    if (isfinite(*volume) && *volume > 0.0) return GNEISS_OK;
    return gn_fail(shell->error, GNEISS_ERROR_INPUT, "%s: expected a volume > 0, found %g m3",
                   shell->name, *volume);
}

static gneiss_status close_surface(surface *shell, double *volume) {
    if (shell->count == 0)
        return gn_fail(shell->error, GNEISS_ERROR_INPUT,
                       "%s: expected a surface, found no triangles", shell->name);
    if (shell->count > INT32_MAX / 3)
        return gn_fail(shell->error, GNEISS_ERROR_INPUT,
                       "%s: expected at most %d triangles, found %zu", shell->name, INT32_MAX / 3,
                       shell->count);
    GN_TRY(allocate(shell));
    GN_TRY(find_edges(shell));
    GN_TRY(check_closed(shell));
    GN_TRY(find_components(shell));
    return turn_cavities(shell, volume);
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
