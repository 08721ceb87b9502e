/* Checks of a mesh: faces with too many elements, duplicate elements, unconnected parts. */
#include "mesh/joints_private.h"

#include "base/memory.h"
#include "base/point.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Nodes of a face: all but the first, which is opposite to it. */
static const int opposite[4][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {2, 0, 1, 3}, {3, 0, 1, 2}};

static gneiss_status no_memory(const gn_joint_search *search) {
    return gn_fail(search->error, GNEISS_ERROR_MEMORY, "%s: no memory to check %zu elements",
                   search->name, search->solids->count);
}

static const char *kind_of(const gn_joint_search *search) {
    return search->dimension == 3 ? "tetrahedron" : "triangle";
}

gneiss_status gn_joint_refuse(const gn_joint_search *search, const double at[3], const char *format,
                              ...) {
    char what[700], place[GN_POINT_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return gn_fail(search->error, GNEISS_ERROR_INPUT, "%s: %s at %s m", search->name, what,
                   gn_point_text(search->origin, at, place));
}

static void middle_of(const gn_joint_search *search, size_t element, double at[3]) {
    const int32_t *node = gn_joint_nodes(search, element);
    memset(at, 0, 3 * sizeof *at);
    for (int k = 0; k <= search->dimension; k++)
        for (int a = 0; a < 3; a++)
            at[a] += gn_joint_place(search, node[k])[a] / (double)(search->dimension + 1);
}

/* ---- faces ---- */

static void face_nodes(const gn_joint_search *search, size_t element, int face, int32_t node[3]) {
    const int32_t *all = gn_joint_nodes(search, element);
    for (int k = 0; k < search->dimension; k++) node[k] = all[opposite[face][k + 1]];
}

/* Returns the side of a face on which an element lies, with an orientation that depends on the
 * order of the face's nodes alone; 0: the element has no volume. */
static int side_of(const gn_joint_search *search, size_t element, int face) {
    int32_t node[3];
    double edge[3][3], normal[3], volume;
    face_nodes(search, element, face, node);
    for (int k = 1; k < search->dimension; k++)
        for (int m = k; m > 0 && node[m] < node[m - 1]; m--) {
            int32_t swap = node[m];
            node[m] = node[m - 1];
            node[m - 1] = swap;
        }
    const double *x = gn_joint_place(search, node[0]);
    for (int k = 1; k < search->dimension; k++)
        gn_mesh_between(x, gn_joint_place(search, node[k]), edge[k - 1]);
    gn_mesh_between(x, gn_joint_place(search, gn_joint_nodes(search, element)[face]),
                    edge[search->dimension - 1]);
    if (search->dimension == 2) {
        volume = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    } else {
        gn_mesh_cross(edge[0], edge[1], normal);
        volume = gn_mesh_dot(normal, edge[2]);
    }
    return (volume > 0.0) - (volume < 0.0);
}

/* Faces with three elements, or with two on one side. */
typedef struct crowded_faces {
    size_t count, element, other;
} crowded_faces;

static bool add_face(gn_joint_search *search, gn_mesh_table *table, size_t element, int face,
                     crowded_faces *crowded) {
    int32_t node[3];
    int64_t row;
    face_nodes(search, element, face, node);
    if (!gn_mesh_table_add(table, gn_mesh_face_key(node, search->dimension),
                           (int64_t)search->face_count, &row))
        return false;
    const int side = side_of(search, element, face);
    if ((size_t)row == search->face_count) {
        search->owner[row] = (int32_t)element;
        search->side[row] = (int8_t)(side < 0 ? -1 - face : face);
        search->use[row] = 1;
        search->face_count++;
        return true;
    }
    bool same = side && (side < 0) == (search->side[row] < 0);
    if (search->use[row] < 3) search->use[row]++;
    if (!same && search->use[row] < 3) return true;
    if (crowded->count++) return true;
    crowded->element = element;
    crowded->other = (size_t)search->owner[row];
    return true;
}

/* Counts the elements that have the same nodes as an earlier one, and finds the first pair. */
static bool count_doubles(const gn_joint_search *search, crowded_faces *twice) {
    gn_mesh_table table = {0};
    bool room = true;
    *twice = (crowded_faces){0};
    for (size_t e = 0; e < search->solids->count && room; e++) {
        int64_t held;
        room = gn_mesh_table_add(
            &table, gn_mesh_element_key(gn_joint_nodes(search, e), search->solids->nodes),
            (int64_t)e, &held);
        if (!room || held == (int64_t)e || twice->count++) continue;
        twice->element = e;
        twice->other = (size_t)held;
    }
    gn_mesh_table_free(&table);
    return room;
}

static gneiss_status refuse_crowded(const gn_joint_search *search, const crowded_faces *crowded) {
    crowded_faces twice;
    double at[3];
    if (!count_doubles(search, &twice)) return no_memory(search);
    const crowded_faces *found = twice.count ? &twice : crowded;
    middle_of(search, found->element, at);
    if (twice.count)
        return gn_joint_refuse(search, at,
                               "expected every element once, found %zu of %zu that have the nodes "
                               "of another one and would count double in mass and stiffness; the "
                               "first is %s number %zu, the same as number %zu,",
                               twice.count, search->solids->count, kind_of(search),
                               found->element + 1, found->other + 1);
    return gn_joint_refuse(search, at,
                           "expected faces with an element on each side or one, found %zu with two "
                           "elements on the same side, which lie over each other; the first is "
                           "that of %ss number %zu and %zu,",
                           crowded->count, kind_of(search), found->other + 1, found->element + 1);
}

static gneiss_status find_faces(gn_joint_search *search) {
    const size_t most = search->solids->count * (size_t)search->solids->nodes;
    gn_mesh_table table = {0};
    crowded_faces crowded = {0};
    search->owner = gn_alloc_array(most + 1, sizeof *search->owner);
    search->side = gn_alloc_array(most + 1, sizeof *search->side);
    search->use = gn_alloc_array(most + 1, sizeof *search->use);
    bool room = search->owner && search->side && search->use;
    for (size_t e = 0; e < search->solids->count && room; e++)
        for (int face = 0; face <= search->dimension && room; face++)
            room = add_face(search, &table, e, face, &crowded);
    gn_mesh_table_free(&table);
    if (!room) return no_memory(search);
    return crowded.count ? refuse_crowded(search, &crowded) : GNEISS_OK;
}

/* ---- parts ---- */

int32_t gn_joint_part(const gn_joint_search *search, int32_t node) {
    int32_t *part = search->part;
    while (part[node] != node) node = part[node] = part[part[node]];
    return node;
}

static gneiss_status find_parts(gn_joint_search *search) {
    const size_t nodes = search->mesh->node_count;
    gn_mesh_joints *j = search->joints;
    search->part = gn_alloc_array(nodes + 1, sizeof *search->part);
    size_t *size = gn_alloc_array(nodes + 1, sizeof *size);
    if (!search->part || !size) {
        gn_free(size);
        return no_memory(search);
    }
    for (size_t n = 0; n < nodes; n++) search->part[n] = (int32_t)n;
    for (size_t e = 0; e < search->solids->count; e++) {
        const int32_t *node = gn_joint_nodes(search, e);
        for (int k = 1; k <= search->dimension; k++)
            search->part[gn_joint_part(search, node[k])] = gn_joint_part(search, node[0]);
    }
    for (size_t e = 0; e < search->solids->count; e++)
        size[gn_joint_part(search, gn_joint_nodes(search, e)[0])]++;
    for (size_t n = 0; n < nodes; n++) {
        if (!size[n]) continue;
        if (j->parts++ && size[n] >= j->least) continue;
        j->least = size[n];
        memcpy(j->least_at, gn_joint_place(search, (int32_t)n), sizeof j->least_at);
    }
    gn_free(size);
    return GNEISS_OK;
}

/* ---- boundary ---- */

static void add_facet(gn_joint_search *search, size_t row) {
    int32_t *node = search->facet + 3 * search->facet_count;
    gn_box *box = &search->box[search->facet_count];
    const int face = search->side[row] < 0 ? -1 - search->side[row] : search->side[row];
    face_nodes(search, (size_t)search->owner[row], face, node);
    for (int a = 0; a < 3; a++) box->lower[a] = INFINITY, box->upper[a] = -INFINITY;
    for (int k = 0; k < search->dimension; k++) {
        const double *x = gn_joint_place(search, node[k]),
                     *y = gn_joint_place(search, node[(k + 1) % search->dimension]);
        double edge[3];
        gn_mesh_between(x, y, edge);
        search->shortest = fmin(search->shortest, sqrt(gn_mesh_dot(edge, edge)));
        for (int a = 0; a < 3; a++) {
            box->lower[a] = fmin(box->lower[a], x[a]);
            box->upper[a] = fmax(box->upper[a], x[a]);
        }
    }
    search->facet_owner[search->facet_count++] = search->owner[row];
}

static gneiss_status find_boundary(gn_joint_search *search) {
    size_t count = 0;
    for (size_t row = 0; row < search->face_count; row++) count += search->use[row] == 1;
    search->facet = gn_alloc_array(count + 1, 3 * sizeof *search->facet);
    search->facet_owner = gn_alloc_array(count + 1, sizeof *search->facet_owner);
    search->box = gn_alloc_array(count + 1, sizeof *search->box);
    if (!search->facet || !search->facet_owner || !search->box) return no_memory(search);
    search->shortest = INFINITY;
    for (size_t row = 0; row < search->face_count; row++)
        if (search->use[row] == 1) add_facet(search, row);
    if (!gn_box_tree_build(search->box, search->facet_count, &search->tree))
        return no_memory(search);
    for (int a = 0; a < 3 && search->facet_count; a++)
        search->extent =
            fmax(search->extent, search->tree.node->box.upper[a] - search->tree.node->box.lower[a]);
    return GNEISS_OK;
}

static gneiss_status look(gn_joint_search *search, bool touching) {
    if (search->solids->count > INT32_MAX / 4)
        return gn_fail(search->error, GNEISS_ERROR_INPUT,
                       "%s: expected at most %d elements, found %zu", search->name, INT32_MAX / 4,
                       search->solids->count);
    GN_TRY(find_faces(search));
    GN_TRY(find_parts(search));
    GN_TRY(find_boundary(search));
    GN_TRY(gn_joints_check_overlap(search));
    return touching ? gn_joints_check_touch(search) : GNEISS_OK;
}

static gneiss_status check(const gn_mesh *mesh, int dimension, const double origin[3],
                           const char *name, bool touching, gn_mesh_joints *joints,
                           gneiss_error *error) {
    *joints = (gn_mesh_joints){0};
    gn_joint_search s = {.mesh = mesh,
                         .solids = dimension == 3 ? &mesh->tetrahedra : &mesh->triangles,
                         .dimension = dimension,
                         .origin = origin,
                         .name = name,
                         .error = error,
                         .joints = joints};
    joints->elements = s.solids->count;
    gneiss_status status = look(&s, touching);
    void *blocks[] = {s.owner, s.side, s.use, s.part, s.facet, s.facet_owner, s.box};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_box_tree_free(&s.tree);
    return status;
}

gneiss_status gn_mesh_check_joints(const gn_mesh *mesh, int dimension, const double origin[3],
                                   const char *name, gn_mesh_joints *joints, gneiss_error *error) {
    return check(mesh, dimension, origin, name, true, joints, error);
}

gneiss_status gn_mesh_check_overlap(const gn_mesh *mesh, int dimension, const double origin[3],
                                    const char *name, gneiss_error *error) {
    gn_mesh_joints unused;
    return check(mesh, dimension, origin, name, false, &unused, error);
}
