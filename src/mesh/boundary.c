/* Faces of a mesh that belong to one element only. */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>

/* Faces of an element of positive volume, counter-clockwise as seen from outside; for a triangle
 * its edges, with the triangle on their left. */
static const int tetrahedron_face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
static const int triangle_face[3][2] = {{0, 1}, {1, 2}, {2, 0}};

typedef struct boundary {
    gn_mesh *mesh;
    const char *name;
    gneiss_error *error;
    int dimension;           /* dimension, which is also the number of nodes of a face */
    gn_mesh_elements *inner; /* tetrahedra or triangles */
    gn_mesh_elements *faces; /* triangles or lines, which are replaced */
    gn_mesh_table table;     /* face -> row of owner */
    size_t face_count;
    int32_t *owner;     /* [face_count][2]: element, its face */
    unsigned char *use; /* [face_count] 1 or 2 elements */
} boundary;

static gneiss_status no_memory(const boundary *faces) {
    return gn_fail(faces->error, GNEISS_ERROR_MEMORY, "%s: no memory for the faces of %zu elements",
                   faces->name, faces->inner->count);
}

static const double *node_of(const boundary *faces, size_t element, int k) {
    size_t at = (size_t)faces->inner->nodes * element + (size_t)k;
    return faces->mesh->node + 3 * (size_t)faces->inner->node[at];
}

static void face_nodes(const boundary *faces, size_t element, int face, int32_t node[3]) {
    const int *local = faces->dimension == 3 ? tetrahedron_face[face] : triangle_face[face];
    for (int k = 0; k < faces->dimension; k++)
        node[k] = faces->inner->node[(size_t)faces->inner->nodes * element + (size_t)local[k]];
}

/* Returns twice the area (3D: six times the volume) of an element; *scale: the square (3D: the
 * cube) of its longest edge, with which it is compared. */
static double measure(const boundary *faces, size_t element, double *scale) {
    double edge[3][3], normal[3], longest = 0.0;
    for (int k = 0; k < faces->dimension; k++) {
        gn_mesh_between(node_of(faces, element, 0), node_of(faces, element, k + 1), edge[k]);
        for (int m = 0; m <= k; m++) {
            double other[3];
            gn_mesh_between(node_of(faces, element, m), node_of(faces, element, k + 1), other);
            longest = fmax(longest, sqrt(gn_mesh_dot(other, other)));
        }
    }
    *scale = pow(longest, faces->dimension);
    if (faces->dimension == 2) return edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    gn_mesh_cross(edge[0], edge[1], normal);
    return gn_mesh_dot(normal, edge[2]);
}

static gneiss_status turn_elements(boundary *faces) {
    for (size_t e = 0; e < faces->inner->count; e++) {
        double scale, size = measure(faces, e, &scale);
        /* With coordinates of 16 digits, flat elements have about this size. */
        if (!(fabs(size) > 1e-12 * scale)) {
            const double *x = node_of(faces, e, 0);
            return gn_fail(faces->error, GNEISS_ERROR_INPUT,
                           "%s: expected elements with %s, found %s number %zu with none at "
                           "(%.9g %.9g %.9g)",
                           faces->name, faces->dimension == 3 ? "a volume" : "an area",
                           faces->dimension == 3 ? "tetrahedron" : "triangle", e + 1, x[0], x[1],
                           x[2]);
        }
        if (size > 0.0) continue;
        int32_t *node = faces->inner->node + (size_t)faces->inner->nodes * e, swap = node[1];
        node[1] = node[2];
        node[2] = swap;
    }
    return GNEISS_OK;
}

static gneiss_status check_plane(const boundary *faces) {
    double least = INFINITY, most = -INFINITY, extent = 0.0;
    const double *origin = node_of(faces, 0, 0);
    for (size_t e = 0; e < faces->inner->count; e++) {
        for (int k = 0; k < faces->inner->nodes; k++) {
            const double *x = node_of(faces, e, k);
            least = fmin(least, x[2]);
            most = fmax(most, x[2]);
            extent = fmax(extent, fmax(fabs(x[0] - origin[0]), fabs(x[1] - origin[1])));
        }
    }
    /* Meshes that were rotated into the plane have lost their last digits. */
    if (most - least <= 1e-9 * extent) return GNEISS_OK;
    return gn_fail(faces->error, GNEISS_ERROR_INPUT,
                   "%s: expected triangles in a plane z = constant (two dimensions), found z from "
                   "%.9g to %.9g",
                   faces->name, least, most);
}

/* Tells whether two lists of the same nodes have the same orientation. */
static bool same_sense(const boundary *faces, const int32_t *p, const int32_t *q) {
    if (faces->dimension == 2) return p[0] == q[0];
    int k = 0;
    while (q[k] != p[0]) k++;
    return q[(k + 1) % 3] == p[1];
}

static gneiss_status refuse_face(const boundary *faces, const int32_t *node, const char *what) {
    char ends[256];
    size_t used = 0;
    for (int k = 0; k < faces->dimension; k++) {
        const double *x = faces->mesh->node + 3 * (size_t)node[k];
        used += (size_t)snprintf(ends + used, sizeof ends - used, "%s(%.9g %.9g %.9g)",
                                 k ? " " : "", x[0], x[1], x[2]);
    }
    return gn_fail(faces->error, GNEISS_ERROR_INPUT, "%s: expected %s, found %s at %s", faces->name,
                   "faces with an element on each side or one", what, ends);
}

static gneiss_status add_face(boundary *faces, size_t element, int face) {
    int32_t node[3], first[3];
    int64_t row;
    face_nodes(faces, element, face, node);
    if (!gn_mesh_table_add(&faces->table, gn_mesh_face_key(node, faces->dimension),
                           (int64_t)faces->face_count, &row))
        return no_memory(faces);
    if ((size_t)row == faces->face_count) {
        faces->owner[2 * row] = (int32_t)element;
        faces->owner[2 * row + 1] = face;
        faces->use[row] = 1;
        faces->face_count++;
        return GNEISS_OK;
    }
    if (++faces->use[row] > 2) return refuse_face(faces, node, "three elements");
    face_nodes(faces, (size_t)faces->owner[2 * row], faces->owner[2 * row + 1], first);
    if (same_sense(faces, node, first))
        return refuse_face(faces, node, "two elements on the same side");
    return GNEISS_OK;
}

static gneiss_status find_faces(boundary *faces) {
    size_t most = faces->inner->count * (size_t)faces->inner->nodes;
    faces->owner = gn_alloc_array(most, 2 * sizeof *faces->owner);
    faces->use = gn_alloc_array(most, sizeof *faces->use);
    if (!faces->owner || !faces->use) return no_memory(faces);
    for (size_t e = 0; e < faces->inner->count; e++)
        for (int face = 0; face < faces->inner->nodes; face++) GN_TRY(add_face(faces, e, face));
    return GNEISS_OK;
}

/* Indexes the file's faces by their nodes, because the boundary inherits their groups. */
static bool index_old_faces(const boundary *faces, gn_mesh_table *old) {
    int64_t held;
    for (size_t k = 0; k < faces->faces->count; k++) {
        const int32_t *node = faces->faces->node + (size_t)faces->dimension * k;
        if (!gn_mesh_table_add(old, gn_mesh_face_key(node, faces->dimension), (int64_t)k, &held))
            return false;
    }
    return true;
}

/* Finds the first membership of `element` by bisection; memberships are sorted by element. */
static size_t first_membership(const gn_mesh_elements *elements, size_t element) {
    size_t low = 0, high = elements->also_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (elements->also[middle].element < element)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool add_boundary_face(const boundary *bounds, const gn_mesh_table *old, size_t row,
                              gn_mesh_list *list) {
    const gn_mesh_elements *faces = bounds->faces;
    int32_t node[3], group = 0;
    face_nodes(bounds, (size_t)bounds->owner[2 * row], bounds->owner[2 * row + 1], node);
    int64_t was = gn_mesh_table_find(old, gn_mesh_face_key(node, bounds->dimension));
    if (was >= 0) group = faces->group[was];
    size_t number = list->elements->count;
    if (!gn_mesh_add_element(list, node, &group, 1)) return false;
    if (was < 0) return true;
    for (size_t k = first_membership(faces, (size_t)was);
         k < faces->also_count && faces->also[k].element == (size_t)was; k++)
        if (!gn_mesh_add_membership(list, number, faces->also[k].group)) return false;
    return true;
}

static gneiss_status replace_faces(boundary *faces) {
    gn_mesh_elements found = {.nodes = faces->dimension};
    gn_mesh_list list = {.elements = &found};
    gn_mesh_table old = {0};
    bool room = index_old_faces(faces, &old);
    for (size_t row = 0; row < faces->face_count && room; row++)
        if (faces->use[row] == 1) room = add_boundary_face(faces, &old, row, &list);
    gn_mesh_table_free(&old);
    gn_mesh_elements_free(room ? faces->faces : &found);
    if (!room) return no_memory(faces);
    *faces->faces = found;
    return GNEISS_OK;
}

static gneiss_status find_boundary(boundary *faces) {
    const char *what = faces->dimension == 3 ? "tetrahedra" : "triangles";
    size_t most = INT32_MAX / 4;
    if (faces->inner->count == 0)
        return gn_fail(faces->error, GNEISS_ERROR_INPUT, "%s: expected a mesh of %s, found none",
                       faces->name, what);
    if (faces->inner->count > most)
        return gn_fail(faces->error, GNEISS_ERROR_INPUT, "%s: expected at most %zu %s, found %zu",
                       faces->name, most, what, faces->inner->count);
    if (faces->dimension == 2) GN_TRY(check_plane(faces));
    GN_TRY(turn_elements(faces));
    GN_TRY(find_faces(faces));
    return replace_faces(faces);
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
