/* Checks of a mesh: faces with too many elements, duplicate elements, unconnected parts. */
#include "mesh/joints_private.h"

#include "base/memory.h"
#include "base/point.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Nodes of a face: all but the first listed, which is opposite to it. */
static const int opposite[4][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {2, 0, 1, 3}, {3, 0, 1, 2}};

static gneiss_status no_memory(const gn_joint_search *s) {
    return gn_fail(s->error, GNEISS_ERROR_MEMORY, "%s: no memory to look at %zu elements", s->name,
                   s->solids->count);
}

static const char *kind_of(const gn_joint_search *s) {
    return s->dimension == 3 ? "tetrahedron" : "triangle";
}

gneiss_status gn_joint_refuse(const gn_joint_search *s, const double at[3], const char *format,
                              ...) {
    char what[700], place[GN_POINT_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return gn_fail(s->error, GNEISS_ERROR_INPUT, "%s: %s at %s m", s->name, what,
                   gn_point_text(s->origin, at, place));
}

static void middle_of(const gn_joint_search *s, size_t element, double at[3]) {
    const int32_t *node = gn_joint_nodes(s, element);
    memset(at, 0, 3 * sizeof *at);
    for (int k = 0; k <= s->dimension; k++)
        for (int a = 0; a < 3; a++)
            at[a] += gn_joint_place(s, node[k])[a] / (double)(s->dimension + 1);
}

/* ---- faces ---- */

static void face_nodes(const gn_joint_search *s, size_t element, int face, int32_t node[3]) {
    const int32_t *all = gn_joint_nodes(s, element);
    for (int k = 0; k < s->dimension; k++) node[k] = all[opposite[face][k + 1]];
}

/* Returns the side of its face on which an element is, by the order of the face's nodes alone; 0:
 * it has no volume. */
static int side_of(const gn_joint_search *s, size_t element, int face) {
    int32_t node[3];
    double edge[3][3], normal[3], volume;
    face_nodes(s, element, face, node);
    for (int k = 1; k < s->dimension; k++)
        for (int m = k; m > 0 && node[m] < node[m - 1]; m--) {
            int32_t swap = node[m];
            node[m] = node[m - 1];
            node[m - 1] = swap;
        }
    const double *x = gn_joint_place(s, node[0]);
    for (int k = 1; k < s->dimension; k++)
        gn_mesh_between(x, gn_joint_place(s, node[k]), edge[k - 1]);
    gn_mesh_between(x, gn_joint_place(s, gn_joint_nodes(s, element)[face]), edge[s->dimension - 1]);
    if (s->dimension == 2) {
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

static bool add_face(gn_joint_search *s, gn_mesh_table *table, size_t element, int face,
                     crowded_faces *crowded) {
    int32_t node[3];
    int64_t row;
    face_nodes(s, element, face, node);
    if (!gn_mesh_table_add(table, gn_mesh_face_key(node, s->dimension), (int64_t)s->face_count,
                           &row))
        return false;
    const int side = side_of(s, element, face);
    if ((size_t)row == s->face_count) {
        s->owner[row] = (int32_t)element;
        s->side[row] = (int8_t)(side < 0 ? -1 - face : face);
        s->use[row] = 1;
        s->face_count++;
        return true;
    }
    bool same = side && (side < 0) == (s->side[row] < 0);
    if (s->use[row] < 3) s->use[row]++;
    if (!same && s->use[row] < 3) return true;
    if (crowded->count++) return true;
    crowded->element = element;
    crowded->other = (size_t)s->owner[row];
    return true;
}

/* Counts elements with the nodes of an earlier one, and finds the first pair. */
static bool count_doubles(const gn_joint_search *s, crowded_faces *twice) {
    gn_mesh_table table = {0};
    bool room = true;
    *twice = (crowded_faces){0};
    for (size_t e = 0; e < s->solids->count && room; e++) {
        int64_t held;
        room = gn_mesh_table_add(
            &table, gn_mesh_element_key(gn_joint_nodes(s, e), s->solids->nodes), (int64_t)e, &held);
        if (!room || held == (int64_t)e || twice->count++) continue;
        twice->element = e;
        twice->other = (size_t)held;
    }
    gn_mesh_table_free(&table);
    return room;
}

static gneiss_status refuse_crowded(const gn_joint_search *s, const crowded_faces *crowded) {
    crowded_faces twice;
    double at[3];
    if (!count_doubles(s, &twice)) return no_memory(s);
    const crowded_faces *found = twice.count ? &twice : crowded;
    middle_of(s, found->element, at);
    if (twice.count)
        return gn_joint_refuse(s, at,
                               "expected every element once, found %zu of %zu that have the nodes "
                               "of another one and would count double in mass and stiffness; the "
                               "first is %s number %zu, the same as number %zu,",
                               twice.count, s->solids->count, kind_of(s), found->element + 1,
                               found->other + 1);
    return gn_joint_refuse(s, at,
                           "expected faces with an element on each side or one, found %zu with two "
                           "elements on the same side, which lie over each other; the first is "
                           "that of %ss number %zu and %zu,",
                           crowded->count, kind_of(s), found->other + 1, found->element + 1);
}

static gneiss_status find_faces(gn_joint_search *s) {
    const size_t most = s->solids->count * (size_t)s->solids->nodes;
    gn_mesh_table table = {0};
    crowded_faces crowded = {0};
    s->owner = gn_alloc_array(most + 1, sizeof *s->owner);
    s->side = gn_alloc_array(most + 1, sizeof *s->side);
    s->use = gn_alloc_array(most + 1, sizeof *s->use);
    bool room = s->owner && s->side && s->use;
    for (size_t e = 0; e < s->solids->count && room; e++)
        for (int face = 0; face <= s->dimension && room; face++)
            room = add_face(s, &table, e, face, &crowded);
    gn_mesh_table_free(&table);
    if (!room) return no_memory(s);
    return crowded.count ? refuse_crowded(s, &crowded) : GNEISS_OK;
}

/* ---- parts ---- */

int32_t gn_joint_part(const gn_joint_search *s, int32_t node) {
    int32_t *part = s->part;
    while (part[node] != node) node = part[node] = part[part[node]];
    return node;
}

static gneiss_status find_parts(gn_joint_search *s) {
    const size_t nodes = s->mesh->node_count;
    gn_mesh_joints *j = s->joints;
    s->part = gn_alloc_array(nodes + 1, sizeof *s->part);
    size_t *size = gn_alloc_array(nodes + 1, sizeof *size);
    if (!s->part || !size) {
        gn_free(size);
        return no_memory(s);
    }
    for (size_t n = 0; n < nodes; n++) s->part[n] = (int32_t)n;
    for (size_t e = 0; e < s->solids->count; e++) {
        const int32_t *node = gn_joint_nodes(s, e);
        for (int k = 1; k <= s->dimension; k++)
            s->part[gn_joint_part(s, node[k])] = gn_joint_part(s, node[0]);
    }
    for (size_t e = 0; e < s->solids->count; e++) size[gn_joint_part(s, gn_joint_nodes(s, e)[0])]++;
    for (size_t n = 0; n < nodes; n++) {
        if (!size[n]) continue;
        if (j->parts++ && size[n] >= j->least) continue;
        j->least = size[n];
        memcpy(j->least_at, gn_joint_place(s, (int32_t)n), sizeof j->least_at);
    }
    gn_free(size);
    return GNEISS_OK;
}

/* ---- boundary ---- */

static void add_facet(gn_joint_search *s, size_t row) {
    int32_t *node = s->facet + 3 * s->facet_count;
    gn_box *box = &s->box[s->facet_count];
    const int face = s->side[row] < 0 ? -1 - s->side[row] : s->side[row];
    face_nodes(s, (size_t)s->owner[row], face, node);
    for (int a = 0; a < 3; a++) box->lower[a] = INFINITY, box->upper[a] = -INFINITY;
    for (int k = 0; k < s->dimension; k++) {
        const double *x = gn_joint_place(s, node[k]),
                     *y = gn_joint_place(s, node[(k + 1) % s->dimension]);
        double edge[3];
        gn_mesh_between(x, y, edge);
        s->shortest = fmin(s->shortest, sqrt(gn_mesh_dot(edge, edge)));
        for (int a = 0; a < 3; a++) {
            box->lower[a] = fmin(box->lower[a], x[a]);
            box->upper[a] = fmax(box->upper[a], x[a]);
        }
    }
    s->facet_owner[s->facet_count++] = s->owner[row];
}

static gneiss_status find_boundary(gn_joint_search *s) {
    size_t count = 0;
    for (size_t row = 0; row < s->face_count; row++) count += s->use[row] == 1;
    s->facet = gn_alloc_array(count + 1, 3 * sizeof *s->facet);
    s->facet_owner = gn_alloc_array(count + 1, sizeof *s->facet_owner);
    s->box = gn_alloc_array(count + 1, sizeof *s->box);
    if (!s->facet || !s->facet_owner || !s->box) return no_memory(s);
    s->shortest = INFINITY;
    for (size_t row = 0; row < s->face_count; row++)
        if (s->use[row] == 1) add_facet(s, row);
    if (!gn_box_tree_build(s->box, s->facet_count, &s->tree)) return no_memory(s);
    for (int a = 0; a < 3 && s->facet_count; a++)
        s->extent = fmax(s->extent, s->tree.node->box.upper[a] - s->tree.node->box.lower[a]);
    return GNEISS_OK;
}

static gneiss_status look(gn_joint_search *s, bool touching) {
    if (s->solids->count > INT32_MAX / 4)
        return gn_fail(s->error, GNEISS_ERROR_INPUT, "%s: expected at most %d elements, found %zu",
                       s->name, INT32_MAX / 4, s->solids->count);
    GN_TRY(find_faces(s));
    GN_TRY(find_parts(s));
    GN_TRY(find_boundary(s));
    GN_TRY(gn_joints_check_overlap(s));
    return touching ? gn_joints_check_touch(s) : GNEISS_OK;
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
