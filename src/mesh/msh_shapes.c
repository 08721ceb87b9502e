/* Elements of gmsh that are neither triangles nor tetrahedra: of higher order, and those that are
 * split. Numbering: Gmsh reference manual, "Node ordering". */
#include "base/memory.h"
#include "mesh/mesh_private.h"

#include <stdio.h>
#include <string.h>

enum { FACES = 6 };

static const gn_msh_type types[] = {
    [1] = {"line", 1, 2, 2},
    [2] = {"triangle", 2, 3, 3},
    [3] = {"quadrangle", 2, 4, 4},
    [4] = {"tetrahedron", 3, 4, 4},
    [5] = {"hexahedron", 3, 8, 8},
    [6] = {"prism", 3, 6, 6},
    [7] = {"pyramid", 3, 5, 5},
    [8] = {"3-node line", 1, 2, 3},
    [9] = {"6-node triangle", 2, 3, 6},
    [10] = {"9-node quadrangle", 2, 4, 9},
    [11] = {"10-node tetrahedron", 3, 4, 10},
    [12] = {"27-node hexahedron", 3, 8, 27},
    [13] = {"18-node prism", 3, 6, 18},
    [14] = {"14-node pyramid", 3, 5, 14},
    [15] = {"point", 0, 1, 1},
    [16] = {"8-node quadrangle", 2, 4, 8},
    [17] = {"20-node hexahedron", 3, 8, 20},
    [18] = {"15-node prism", 3, 6, 15},
    [19] = {"13-node pyramid", 3, 5, 13},
    [20] = {"9-node triangle", 2, 3, 9},
    [21] = {"10-node triangle", 2, 3, 10},
    [22] = {"12-node triangle", 2, 3, 12},
    [23] = {"15-node triangle", 2, 3, 15},
    [24] = {"15-node triangle", 2, 3, 15},
    [25] = {"21-node triangle", 2, 3, 21},
    [26] = {"4-node line", 1, 2, 4},
    [27] = {"5-node line", 1, 2, 5},
    [28] = {"6-node line", 1, 2, 6},
    [29] = {"20-node tetrahedron", 3, 4, 20},
    [30] = {"35-node tetrahedron", 3, 4, 35},
    [31] = {"56-node tetrahedron", 3, 4, 56},
    [36] = {"16-node quadrangle", 2, 4, 16},
    [37] = {"25-node quadrangle", 2, 4, 25},
    [92] = {"64-node hexahedron", 3, 8, 64},
    [93] = {"125-node hexahedron", 3, 8, 125},
};

const gn_msh_type *gn_msh_type_of(int64_t number) {
    bool known = number > 0 && number < (int64_t)(sizeof types / sizeof *types);
    return known && types[number].name ? &types[number] : NULL;
}

/* The faces of a solid with their corners seen anticlockwise from outside; -1: three corners. */
static const int pyramid_faces[FACES][4] = {{0, 3, 2, 1},  {0, 1, 4, -1}, {1, 2, 4, -1},
                                            {2, 3, 4, -1}, {3, 0, 4, -1}, {-1}};
static const int prism_faces[FACES][4] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3},
                                          {1, 2, 5, 4},  {2, 0, 3, 5},  {-1}};
static const int hexahedron_faces[FACES][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

/* Divides a face into triangles by the diagonal of its first node in the file; returns their
 * number, 0: it contains `without`. */
static int divide(const int32_t *node, const int face[4], int32_t without, int32_t out[2][3]) {
    int count = face[0] < 0 ? 0 : face[3] < 0 ? 3 : 4, first = 0;
    for (int k = 0; k < count; k++) {
        if (node[face[k]] == without) return 0;
        if (node[face[k]] < node[face[first]]) first = k;
    }
    for (int t = 0; t < count - 2; t++)
        for (int k = 0; k < 3; k++) out[t][k] = node[face[(first + (k ? k + t : 0)) % count]];
    return count > 2 ? count - 2 : 0;
}

/* Splits a solid into tetrahedra: from its first node in the file to the triangles of all faces
 * that do not contain it. Every face is thereby divided as its neighbour divides it. */
static bool split_solid(gn_mesh_list *list, const gn_msh_type *type, const int32_t *node,
                        const int32_t *groups, size_t group_count) {
    const int(*faces)[4] = type->corners == 8   ? hexahedron_faces
                           : type->corners == 6 ? prism_faces
                                                : pyramid_faces;
    int32_t apex = node[0], part[2][3];
    for (int k = 1; k < type->corners; k++) apex = node[k] < apex ? node[k] : apex;
    for (int f = 0; f < FACES; f++)
        for (int t = divide(node, faces[f], apex, part); t-- > 0;) {
            const int32_t tetrahedron[4] = {part[t][0], part[t][2], part[t][1], apex};
            if (!gn_mesh_add_element(list, tetrahedron, groups, group_count)) return false;
        }
    return true;
}

bool gn_msh_add(gn_msh *msh, const gn_msh_type *type, const int32_t *node, const int32_t *groups,
                size_t group_count) {
    static const int square[4] = {0, 1, 2, 3};
    gn_mesh_list *list = &msh->list[type->dimension];
    gn_mesh_changes *changes = &msh->mesh->changes;
    int32_t part[2][3];
    changes->higher_order += type->nodes > type->corners;
    if (type->corners == type->dimension + 1)
        return gn_mesh_add_element(list, node, groups, group_count);
    changes->split[type->dimension == 2 ? 0
                   : type->corners == 8 ? 1
                   : type->corners == 6 ? 2
                                        : 3]++;
    if (type->dimension == 3) return split_solid(list, type, node, groups, group_count);
    divide(node, square, -1, part);
    return gn_mesh_add_element(list, part[0], groups, group_count) &&
           gn_mesh_add_element(list, part[1], groups, group_count);
}

static void exchange(int32_t *node, int a, int b) {
    int32_t swap = node[a];
    node[a] = node[b];
    node[b] = swap;
}

void gn_msh_reverse(const gn_msh_type *type, int32_t *node) {
    const int n = type->corners;
    if (type->dimension == 2)
        exchange(node, 1, n - 1);
    else if (n == 8)
        exchange(node, 0, 2), exchange(node, 4, 6);
    else if (n == 6)
        exchange(node, 0, 1), exchange(node, 3, 4);
    else if (n == 5)
        exchange(node, 0, 2);
    else if (type->dimension)
        exchange(node, 0, 1);
}

bool gn_msh_mark_inner(gn_msh *msh, int32_t node) {
    if (!msh->inner) msh->inner = gn_alloc_array(msh->mesh->node_count + 1, 1);
    if (!msh->inner) return false;
    msh->inner[node] = 1;
    return true;
}

bool gn_msh_drop_inner(gn_msh *msh) {
    gn_mesh *mesh = msh->mesh;
    if (!msh->inner) return true;
    for (int d = 0; d <= 3; d++) {
        const gn_mesh_elements *e = msh->list[d].elements;
        for (size_t k = 0; k < (size_t)e->nodes * e->count; k++) msh->inner[e->node[k]] = 0;
    }
    int32_t *place = gn_alloc_array(mesh->node_count + 1, sizeof *place), kept = 0;
    if (!place) return false;
    for (size_t n = 0; n < mesh->node_count; n++) {
        place[n] = kept;
        if (msh->inner[n]) continue;
        memmove(mesh->node + 3 * (size_t)kept++, mesh->node + 3 * n, 3 * sizeof *mesh->node);
    }
    for (int d = 0; d <= 3; d++) {
        gn_mesh_elements *e = msh->list[d].elements;
        for (size_t k = 0; k < (size_t)e->nodes * e->count; k++) e->node[k] = place[e->node[k]];
    }
    mesh->changes.nodes = mesh->node_count - (size_t)kept;
    mesh->node_count = (size_t)kept;
    gn_free(place);
    return true;
}

bool gn_mesh_changed(const gn_mesh *mesh, char *text, size_t size) {
    static const char *const names[] = {"quadrangles", "hexahedra", "prisms", "pyramids"};
    const gn_mesh_changes *c = &mesh->changes;
    size_t used = 0;
    *text = '\0';
    for (int k = 0; k < 4; k++)
        if (c->split[k] && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%zu %s split into %s",
                                     used ? ", " : "", c->split[k], names[k],
                                     k ? "tetrahedra" : "triangles");
    if (c->polygons && used < size)
        used += (size_t)snprintf(text + used, size - used,
                                 "%zu faces of more than three corners split into triangles",
                                 c->polygons);
    if (c->higher_order && used < size)
        used += (size_t)snprintf(text + used, size - used,
                                 "%sonly the corners of %zu elements of higher order used (%zu "
                                 "nodes left out)",
                                 used ? ", " : "", c->higher_order, c->nodes);
    if (c->degenerate && used < size)
        used += (size_t)snprintf(text + used, size - used, "%s%zu triangles without area left out",
                                 used ? ", " : "", c->degenerate);
    return used > 0;
}
