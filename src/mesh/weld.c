/* Welding: coincident corners of triangles become shared nodes. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

static const double weld_distance = 1e-6; /* relative to the longest side of the bounding box */
/* in weld distances; a corner then reaches into one or two cells */
static const double cell_size = 8.0;

typedef struct weld {
    double origin[3];
    double reach, cell; /* m */
    double *node;       /* [count][3] */
    int32_t *next;      /* [count] the next node in the same cell, -1: none */
    size_t count;
    gn_mesh_table cells; /* cell -> its first node */
} weld;

static gneiss_status measure(weld *welding, const double *corner, size_t count, const char *name,
                             gneiss_error *error) {
    double extent = 0.0;
    for (int d = 0; d < 3; d++) {
        double least = corner[d], most = corner[d];
        for (size_t k = 1; k < count; k++) {
            least = fmin(least, corner[3 * k + (size_t)d]);
            most = fmax(most, corner[3 * k + (size_t)d]);
        }
        welding->origin[d] = least;
        extent = fmax(extent, most - least);
    }
    welding->reach = weld_distance * extent;
    welding->cell = cell_size * welding->reach;
    /* Products of lengths must not overflow or underflow. */
    if (extent > 1e-60 && extent < 1e60) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a surface with an extent of 1e-60 to 1e60 m, found %g m", name,
                   extent);
}

static int64_t cell_index(const weld *welding, double x, int d) {
    return (int64_t)floor((x - welding->origin[d]) / welding->cell);
}

static gn_mesh_key cell_key(const int64_t cell[3]) {
    return (gn_mesh_key){(uint64_t)cell[0] << 32 ^ (uint64_t)cell[1], (uint64_t)cell[2]};
}

/* Finds the earliest node within reach of x, in the cells that a cube of this size around x
 * intersects; -1: there is none. */
static int64_t find_node(const weld *welding, const double x[3]) {
    int64_t lower[3], upper[3], cell[3], found = -1;
    for (int d = 0; d < 3; d++) {
        lower[d] = cell_index(welding, x[d] - welding->reach, d);
        upper[d] = cell_index(welding, x[d] + welding->reach, d);
    }
    for (cell[0] = lower[0]; cell[0] <= upper[0]; cell[0]++)
        for (cell[1] = lower[1]; cell[1] <= upper[1]; cell[1]++)
            for (cell[2] = lower[2]; cell[2] <= upper[2]; cell[2]++) {
                int64_t k = gn_mesh_table_find(&welding->cells, cell_key(cell));
                for (; k >= 0; k = welding->next[k]) {
                    double apart[3];
                    gn_mesh_between(welding->node + 3 * k, x, apart);
                    bool near = gn_mesh_dot(apart, apart) <= welding->reach * welding->reach;
                    if (near && (found < 0 || k < found)) found = k;
                }
            }
    return found;
}

/* Adds a node; returns false without memory. */
static bool add_node(weld *welding, const double x[3]) {
    int64_t cell[3], first, k = (int64_t)welding->count;
    for (int d = 0; d < 3; d++) {
        welding->node[3 * k + d] = x[d];
        cell[d] = cell_index(welding, x[d], d);
    }
    if (!gn_mesh_table_add(&welding->cells, cell_key(cell), k, &first)) return false;
    welding->next[k] = -1;
    if (first != k) { /* inserted after the first node, to which the table refers */
        welding->next[k] = welding->next[first];
        welding->next[first] = (int32_t)k;
    }
    welding->count++;
    return true;
}

/* Finds the nodes [count] of the corners; returns false without memory. */
static bool weld_corners(weld *welding, const double *corner, size_t count, int32_t *node) {
    for (size_t k = 0; k < count; k++) {
        int64_t found = find_node(welding, corner + 3 * k);
        if (found < 0) {
            found = (int64_t)welding->count;
            if (!add_node(welding, corner + 3 * k)) return false;
        }
        node[k] = (int32_t)found;
    }
    return true;
}

/* Removes, in place, triangles that do not have three different nodes, and the nodes that only they
 * used. */
static size_t drop_degenerate(weld *welding, int32_t *node, size_t triangles) {
    size_t kept = 0, used = 0;
    for (size_t t = 0; t < triangles; t++) {
        int32_t a = node[3 * t], b = node[3 * t + 1], c = node[3 * t + 2];
        if (a == b || b == c || c == a) continue;
        node[3 * kept] = a;
        node[3 * kept + 1] = b;
        node[3 * kept + 2] = c;
        kept++;
    }
    int32_t *renumbered = welding->next; /* the chains are not needed any more */
    for (size_t k = 0; k < welding->count; k++) renumbered[k] = -1;
    for (size_t k = 0; k < 3 * kept; k++) renumbered[node[k]] = 0;
    for (size_t k = 0; k < welding->count; k++) {
        if (renumbered[k] < 0) continue;
        for (size_t d = 0; d < 3; d++) welding->node[3 * used + d] = welding->node[3 * k + d];
        renumbered[k] = (int32_t)used++;
    }
    for (size_t k = 0; k < 3 * kept; k++) node[k] = renumbered[node[k]];
    welding->count = used;
    return kept;
}

gneiss_status gn_mesh_weld(const double *corner, size_t count, const char *name, gn_mesh *mesh,
                           gneiss_error *error) {
    weld w = {0};
    GN_TRY(measure(&w, corner, count, name, error));
    gn_mesh_elements *triangles = &mesh->triangles;
    w.node = gn_alloc_array(count, 3 * sizeof *w.node);
    w.next = gn_alloc_array(count, sizeof *w.next);
    triangles->node = gn_alloc_array(count, sizeof *triangles->node);
    triangles->group = gn_alloc_array(count / 3, sizeof *triangles->group);
    bool room = w.node && w.next && triangles->node && triangles->group &&
                weld_corners(&w, corner, count, triangles->node);
    if (room) triangles->count = drop_degenerate(&w, triangles->node, count / 3);
    mesh->changes.degenerate = count / 3 - triangles->count;
    mesh->node = room ? gn_alloc_array(w.count, 3 * sizeof *w.node) : NULL;
    room = room && mesh->node;
    if (room) memcpy(mesh->node, w.node, 3 * sizeof *w.node * w.count);
    mesh->node_count = w.count;
    gn_free(w.node);
    gn_free(w.next);
    gn_mesh_table_free(&w.cells);
    if (!room) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for this mesh", name);
    if (triangles->count == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected triangles with three corners apart, found none in %zu", name,
                       count / 3);
    return GNEISS_OK;
}
