/* Faces of a mesh that belong to one element only. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>

/* Faces of an element of positive volume, counter-clockwise seen from outside; for a triangle its
 * edges with the triangle on the left. */
static const int tetrahedron_face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
static const int triangle_face[3][2] = {{0, 1}, {1, 2}, {2, 0}};

typedef struct boundary {
    gn_mesh *mesh;
    const char *name;
    gneiss_error *error;
    int dimension;           /* also the nodes of a face */
    gn_mesh_elements *inner; /* tetrahedra or triangles */
    gn_mesh_elements *faces; /* triangles or lines, which are replaced */
    gn_mesh_table table;     /* face -> row of owner */
    size_t face_count;
    int32_t *owner;     /* [face_count][2]: element, its face */
    unsigned char *use; /* [face_count] 1 or 2 elements */
} boundary;

static gneiss_status no_memory(const boundary *b) {
    return gn_fail(b->error, GNEISS_ERROR_MEMORY, "%s: no memory for the faces of %zu elements",
                   b->name, b->inner->count);
}

static const double *node_of(const boundary *b, size_t element, int k) {
    size_t at = (size_t)b->inner->nodes * element + (size_t)k;
    return b->mesh->node + 3 * (size_t)b->inner->node[at];
}

static void face_nodes(const boundary *b, size_t element, int face, int32_t node[3]) {
    const int *local = b->dimension == 3 ? tetrahedron_face[face] : triangle_face[face];
    for (int k = 0; k < b->dimension; k++)
        node[k] = b->inner->node[(size_t)b->inner->nodes * element + (size_t)local[k]];
}

/* Computes twice the area or six times the volume, and the power of the longest edge to which it is
 * compared. */
static double measure(const boundary *b, size_t element, double *scale) {
    double edge[3][3], normal[3], longest = 0.0;
    for (int k = 0; k < b->dimension; k++) {
        gn_mesh_between(node_of(b, element, 0), node_of(b, element, k + 1), edge[k]);
        for (int m = 0; m <= k; m++) {
            double other[3];
            gn_mesh_between(node_of(b, element, m), node_of(b, element, k + 1), other);
            longest = fmax(longest, sqrt(gn_mesh_dot(other, other)));
        }
    }
    *scale = pow(longest, b->dimension);
    if (b->dimension == 2) return edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    gn_mesh_cross(edge[0], edge[1], normal);
    return gn_mesh_dot(normal, edge[2]);
}

static gneiss_status turn_elements(boundary *b) {
    for (size_t e = 0; e < b->inner->count; e++) {
        double scale, size = measure(b, e, &scale);
        /* Coordinates with 16 digits make flat elements of about this size. */
        if (!(fabs(size) > 1e-12 * scale)) {
            const double *x = node_of(b, e, 0);
            return gn_fail(b->error, GNEISS_ERROR_INPUT,
                           "%s: expected elements with %s, found %s number %zu with none at "
                           "(%.9g %.9g %.9g)",
                           b->name, b->dimension == 3 ? "a volume" : "an area",
                           b->dimension == 3 ? "tetrahedron" : "triangle", e + 1, x[0], x[1], x[2]);
        }
        if (size > 0.0) continue;
        int32_t *node = b->inner->node + (size_t)b->inner->nodes * e, swap = node[1];
        node[1] = node[2];
        node[2] = swap;
    }
    return GNEISS_OK;
}

static gneiss_status check_plane(const boundary *b) {
    double least = INFINITY, most = -INFINITY, extent = 0.0;
    const double *origin = node_of(b, 0, 0);
    for (size_t e = 0; e < b->inner->count; e++) {
        for (int k = 0; k < b->inner->nodes; k++) {
            const double *x = node_of(b, e, k);
            least = fmin(least, x[2]);
            most = fmax(most, x[2]);
            extent = fmax(extent, fmax(fabs(x[0] - origin[0]), fabs(x[1] - origin[1])));
        }
    }
    /* Meshes that were rotated into the plane have lost the last digits. */
    if (most - least <= 1e-9 * extent) return GNEISS_OK;
    return gn_fail(b->error, GNEISS_ERROR_INPUT,
                   "%s: expected triangles in a plane z = constant (two dimensions), found z from "
                   "%.9g to %.9g",
                   b->name, least, most);
}

/* Tells whether two lists of the same nodes have the same orientation. */
static bool same_sense(const boundary *b, const int32_t *p, const int32_t *q) {
    if (b->dimension == 2) return p[0] == q[0];
    int k = 0;
    while (q[k] != p[0]) k++;
    return q[(k + 1) % 3] == p[1];
}

static gneiss_status refuse_face(const boundary *b, const int32_t *node, const char *what) {
    char ends[256];
    size_t used = 0;
    for (int k = 0; k < b->dimension; k++) {
        const double *x = b->mesh->node + 3 * (size_t)node[k];
        used += (size_t)snprintf(ends + used, sizeof ends - used, "%s(%.9g %.9g %.9g)",
                                 k ? " " : "", x[0], x[1], x[2]);
    }
    return gn_fail(b->error, GNEISS_ERROR_INPUT, "%s: expected %s, found %s at %s", b->name,
                   "faces with an element on each side or one", what, ends);
}

static gneiss_status add_face(boundary *b, size_t element, int face) {
    int32_t node[3], first[3];
    int64_t row;
    face_nodes(b, element, face, node);
    if (!gn_mesh_table_add(&b->table, gn_mesh_face_key(node, b->dimension), (int64_t)b->face_count,
                           &row))
        return no_memory(b);
    if ((size_t)row == b->face_count) {
        b->owner[2 * row] = (int32_t)element;
        b->owner[2 * row + 1] = face;
        b->use[row] = 1;
        b->face_count++;
        return GNEISS_OK;
    }
    if (++b->use[row] > 2) return refuse_face(b, node, "three elements");
    face_nodes(b, (size_t)b->owner[2 * row], b->owner[2 * row + 1], first);
    if (same_sense(b, node, first)) return refuse_face(b, node, "two elements on the same side");
    return GNEISS_OK;
}

static gneiss_status find_faces(boundary *b) {
    size_t most = b->inner->count * (size_t)b->inner->nodes;
    b->owner = gn_alloc_array(most, 2 * sizeof *b->owner);
    b->use = gn_alloc_array(most, sizeof *b->use);
    if (!b->owner || !b->use) return no_memory(b);
    for (size_t e = 0; e < b->inner->count; e++)
        for (int face = 0; face < b->inner->nodes; face++) GN_TRY(add_face(b, e, face));
    return GNEISS_OK;
}

/* Indexes the file's faces by nodes: the boundary inherits their groups. */
static bool index_old_faces(const boundary *b, gn_mesh_table *old) {
    int64_t held;
    for (size_t k = 0; k < b->faces->count; k++) {
        const int32_t *node = b->faces->node + (size_t)b->dimension * k;
        if (!gn_mesh_table_add(old, gn_mesh_face_key(node, b->dimension), (int64_t)k, &held))
            return false;
    }
    return true;
}

/* Finds the first membership of `element` by bisection; memberships are sorted by element. */
static size_t first_membership(const gn_mesh_elements *e, size_t element) {
    size_t low = 0, high = e->also_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (e->also[middle].element < element)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool add_boundary_face(const boundary *b, const gn_mesh_table *old, size_t row,
                              gn_mesh_list *list) {
    const gn_mesh_elements *faces = b->faces;
    int32_t node[3], group = 0;
    face_nodes(b, (size_t)b->owner[2 * row], b->owner[2 * row + 1], node);
    int64_t was = gn_mesh_table_find(old, gn_mesh_face_key(node, b->dimension));
    if (was >= 0) group = faces->group[was];
    size_t number = list->elements->count;
    if (!gn_mesh_add_element(list, node, &group, 1)) return false;
    if (was < 0) return true;
    for (size_t k = first_membership(faces, (size_t)was);
         k < faces->also_count && faces->also[k].element == (size_t)was; k++)
        if (!gn_mesh_add_membership(list, number, faces->also[k].group)) return false;
    return true;
}

static gneiss_status replace_faces(boundary *b) {
    gn_mesh_elements found = {.nodes = b->dimension};
    gn_mesh_list list = {.elements = &found};
    gn_mesh_table old = {0};
    bool room = index_old_faces(b, &old);
    for (size_t row = 0; row < b->face_count && room; row++)
        if (b->use[row] == 1) room = add_boundary_face(b, &old, row, &list);
    gn_mesh_table_free(&old);
    gn_mesh_elements_free(room ? b->faces : &found);
    if (!room) return no_memory(b);
    *b->faces = found;
    return GNEISS_OK;
}

static gneiss_status find_boundary(boundary *b) {
    const char *what = b->dimension == 3 ? "tetrahedra" : "triangles";
    size_t most = INT32_MAX / 4;
    if (b->inner->count == 0)
        return gn_fail(b->error, GNEISS_ERROR_INPUT, "%s: expected a mesh of %s, found none",
                       b->name, what);
    if (b->inner->count > most)
        return gn_fail(b->error, GNEISS_ERROR_INPUT, "%s: expected at most %zu %s, found %zu",
                       b->name, most, what, b->inner->count);
    if (b->dimension == 2) GN_TRY(check_plane(b));
    GN_TRY(turn_elements(b));
    GN_TRY(find_faces(b));
    return replace_faces(b);
}

gneiss_status gn_mesh_boundary(gn_mesh *mesh, int dimension, const char *name,
                               gneiss_error *error) {
    if (dimension != 2 && dimension != 3)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "%s: expected 2 or 3 dimensions, found %d",
                       name, dimension);
    boundary b = {.mesh = mesh, .name = name, .error = error, .dimension = dimension};
    b.inner = dimension == 3 ? &mesh->tetrahedra : &mesh->triangles;
    b.faces = dimension == 3 ? &mesh->triangles : &mesh->lines;
    gneiss_status status = find_boundary(&b);
    gn_mesh_table_free(&b.table);
    gn_free(b.owner);
    gn_free(b.use);
    return status;
}
