/* Overlapping elements, and parts that touch without shared nodes. */
#include "mesh/joints_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* ---- a bounding box tree for queries near a box ---- */

enum { LEAF = 8, DEPTH_MOST = 64 };

static double middle_of(const gn_box *box, int axis) {
    return 0.5 * (box->lower[axis] + box->upper[axis]);
}

/* Computes the box of items, and the axis along which the extent of their centres is largest. */
static gn_box bounds_of(const gn_box *box, const int32_t *item, size_t count, int *axis) {
    gn_box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}, middles = all;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const gn_box *b = &box[item[i]];
            all.lower[k] = fmin(all.lower[k], b->lower[k]);
            all.upper[k] = fmax(all.upper[k], b->upper[k]);
            middles.lower[k] = fmin(middles.lower[k], middle_of(b, k));
            middles.upper[k] = fmax(middles.upper[k], middle_of(b, k));
        }
    *axis = 0;
    for (int k = 1; k < 3; k++)
        if (middles.upper[k] - middles.lower[k] > middles.upper[*axis] - middles.lower[*axis])
            *axis = k;
    return all;
}

/* Sorts by quickselect (Hoare 1961): item[place] has the rank `place`, and no earlier item has a
 * higher one. */
static void put_at(const gn_box *box, int axis, int32_t *item, size_t count, size_t place) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        double pivot = middle_of(&box[item[low + (high - low) / 2]], axis);
        size_t i = low, j = high;
        for (;;) {
            while (middle_of(&box[item[i]], axis) < pivot) i++;
            while (middle_of(&box[item[j]], axis) > pivot) j--;
            if (i >= j) break;
            int32_t swap = item[i];
            item[i++] = item[j];
            item[j--] = swap;
        }
        if (place <= j)
            high = j;
        else
            low = j + 1;
    }
}

static void build(gn_box_tree *tree, const gn_box *box, size_t first, size_t count) {
    size_t own = tree->node_count++, half = count / 2;
    gn_box_node *node = &tree->node[own];
    int axis;
    node->box = bounds_of(box, tree->item + first, count, &axis);
    if (count <= LEAF) {
        node->first = (int32_t)first;
        node->count = (int32_t)count;
        return;
    }
    put_at(box, axis, tree->item + first, count, half);
    build(tree, box, first, half);
    node->right = (int32_t)tree->node_count;
    build(tree, box, first + half, count - half);
}

bool gn_box_tree_build(const gn_box *box, size_t count, gn_box_tree *tree) {
    *tree = (gn_box_tree){0};
    /* Leaves have more than half of LEAF items. */
    tree->node = gn_alloc_array(count / (LEAF / 4) + 2, sizeof *tree->node);
    tree->item = gn_alloc_array(count + 1, sizeof *tree->item);
    if (!tree->node || !tree->item) {
        gn_box_tree_free(tree);
        return false;
    }
    for (size_t i = 0; i < count; i++) tree->item[i] = (int32_t)i;
    if (count) build(tree, box, 0, count);
    return true;
}

void gn_box_tree_free(gn_box_tree *tree) {
    gn_free(tree->node);
    gn_free(tree->item);
    *tree = (gn_box_tree){0};
}

static void box_tree_near(const gn_box_tree *tree, const gn_box *box, double reach,
                          gn_box_visit *visit, void *context) {
    int32_t waiting[DEPTH_MOST];
    int count = 0;
    if (tree->node_count) waiting[count++] = 0;
    while (count) {
        int32_t at = waiting[--count];
        const gn_box_node *node = &tree->node[at];
        if (!gn_box_is_near(&node->box, box, reach)) continue;
        for (int32_t i = node->first; i < node->first + node->count; i++)
            if (visit(context, tree->item[i])) return;
        if (node->count) continue;
        waiting[count++] = node->right;
        waiting[count++] = at + 1;
    }
}

/* Error of coordinates written with six or seven digits, as a fraction of the extent. The tolerance
 * for coincident nodes is at most `edge_part` of the shortest edge. */
static const double digits = 1e-6, edge_part = 1e-3;

/* ---- overlap ---- */

typedef struct overlap_search {
    const gn_joint_search *s;
    size_t element;
    gn_box box;
    int32_t found; /* facet; -1: none yet */
} overlap_search;

/* Tells whether the axis separates facet and element, or shows that they only touch within the
 * tolerance. */
static bool apart(const overlap_search *search, const int32_t *facet, const double axis[3],
                  double scale, double tolerance) {
    const gn_joint_search *s = search->s;
    const int32_t *node = gn_joint_nodes(s, search->element);
    const double *from = gn_joint_place(s, facet[0]);
    const double length = sqrt(gn_mesh_dot(axis, axis));
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, v[3];
    if (length <= 1e-9 * scale) return false;
    for (int k = 0; k <= 2 * s->dimension; k++) {
        const int of = k >= s->dimension;
        gn_mesh_between(from, gn_joint_place(s, of ? node[k - s->dimension] : facet[k]), v);
        const double at = gn_mesh_dot(axis, v);
        low[of] = fmin(low[of], at);
        high[of] = fmax(high[of], at);
    }
    return fmin(high[0] - low[1], high[1] - low[0]) <= tolerance * length;
}

/* Lists the edges of a face or element; returns their number. */
static int edges_of(const gn_joint_search *search, const int32_t *node, int count,
                    double edge[6][3]) {
    int edges = 0;
    for (int k = 1; k < count; k++)
        for (int m = 0; m < k; m++)
            gn_mesh_between(gn_joint_place(search, node[m]), gn_joint_place(search, node[k]),
                            edge[edges++]);
    return edges;
}

/* Tells whether an element and a facet are separate, by separating axes (Gottschalk, Lin and
 * Manocha 1996): convex bodies are separate if a normal of one of them separates them, or in space
 * a cross product of two of their edges. */
static bool apart_in_plane(const overlap_search *search, const int32_t *facet, double tolerance) {
    double edge[6][3];
    for (int of = 0; of < 2; of++) {
        int count = of ? edges_of(search->s, gn_joint_nodes(search->s, search->element), 3, edge)
                       : edges_of(search->s, facet, 2, edge);
        for (int k = 0; k < count; k++) {
            const double normal[3] = {-edge[k][1], edge[k][0], 0.0};
            if (apart(search, facet, normal, 0.0, tolerance)) return true;
        }
    }
    return false;
}

static bool apart_in_space(const overlap_search *search, const int32_t *facet, double tolerance) {
    static const int sides[5][2] = {{0, 1}, {0, 1}, {0, 3}, {1, 3}, {2, 4}};
    double own[6][3], other[6][3], axis[3];
    const int own_count = edges_of(search->s, facet, 3, own),
              other_count =
                  edges_of(search->s, gn_joint_nodes(search->s, search->element), 4, other);
    /* Edges of an element in the order 01 02 12 03 13 23; each face has two of the first five. */
    for (int k = 0; k < 5; k++) {
        const double *u = k ? other[sides[k][0]] : own[0], *v = k ? other[sides[k][1]] : own[1];
        gn_mesh_cross(u, v, axis);
        if (apart(search, facet, axis, sqrt(gn_mesh_dot(u, u) * gn_mesh_dot(v, v)), tolerance))
            return true;
    }
    for (int k = 0; k < own_count; k++)
        for (int m = 0; m < other_count; m++) {
            const double *u = own[k], *v = other[m];
            gn_mesh_cross(u, v, axis);
            if (apart(search, facet, axis, sqrt(gn_mesh_dot(u, u) * gn_mesh_dot(v, v)), tolerance))
                return true;
        }
    return false;
}

static bool visit_overlap(void *context, int32_t item) {
    overlap_search *o = context;
    const gn_joint_search *s = o->s;
    const int32_t *facet = s->facet + 3 * (size_t)item;
    double edge[6][3], shortest = INFINITY;
    if (s->facet_owner[item] == (int32_t)o->element || !gn_box_is_near(&s->box[item], &o->box, 0.0))
        return false;
    const int count = edges_of(s, facet, s->dimension, edge);
    for (int k = 0; k < count; k++) shortest = fmin(shortest, gn_mesh_dot(edge[k], edge[k]));
    const double tolerance = fmax(digits * s->extent, edge_part * sqrt(shortest));
    if (s->dimension == 2 ? apart_in_plane(o, facet, tolerance)
                          : apart_in_space(o, facet, tolerance))
        return false;
    o->found = item;
    return true;
}

static gn_box box_of(const gn_joint_search *search, size_t element) {
    const int32_t *node = gn_joint_nodes(search, element);
    gn_box box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int k = 0; k <= search->dimension; k++)
        for (int a = 0; a < 3; a++) {
            box.lower[a] = fmin(box.lower[a], gn_joint_place(search, node[k])[a]);
            box.upper[a] = fmax(box.upper[a], gn_joint_place(search, node[k])[a]);
        }
    return box;
}

/* If elements overlap, the boundary of the mesh intersects some element. */
gneiss_status gn_joints_check_overlap(gn_joint_search *search) {
    size_t count = 0, first = 0;
    int32_t facet = -1;
    for (size_t e = 0; e < search->solids->count; e++) {
        overlap_search o = {.s = search, .element = e, .box = box_of(search, e), .found = -1};
        box_tree_near(&search->tree, &o.box, 0.0, visit_overlap, &o);
        if (o.found < 0) continue;
        if (!count++) first = e, facet = o.found;
    }
    if (!count) return GNEISS_OK;
    double at[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < search->dimension; k++)
        for (int a = 0; a < 3; a++)
            at[a] += gn_joint_place(search, search->facet[3 * (size_t)facet + (size_t)k])[a] /
                     search->dimension;
    return gn_joint_refuse(search, at,
                           "expected elements beside each other, found %zu of %zu that others lie "
                           "over: what two parts fill would count double in mass and stiffness; "
                           "the first is number %zu, which number %d goes into",
                           count, search->solids->count, first + 1, search->facet_owner[facet] + 1);
}

/* ---- touching ---- */

typedef enum touch_kind { TOUCH_NONE, TOUCH_SIDE, TOUCH_NODE } touch_kind;

typedef struct touch_search {
    const gn_joint_search *s;
    int32_t node;
    double reach;
    touch_kind own, across; /* kinds of contact with the node's own part and with other parts */
    bool first;             /* the first of the nodes at its position */
} touch_search;

static double distance2(const double *x, const double *y) {
    double v[3];
    gn_mesh_between(x, y, v);
    return gn_mesh_dot(v, v);
}

/* Tells whether x is within the tolerance of a facet, but not near its corners. */
static bool on_facet(const gn_joint_search *search, const int32_t *facet, const double *x,
                     double reach) {
    const double *corner = gn_joint_place(search, facet[0]);
    double v[3], edge[3][3] = {{0}}, normal[3], inward[3];
    for (int k = 0; k < search->dimension; k++)
        gn_mesh_between(gn_joint_place(search, facet[k]),
                        gn_joint_place(search, facet[(k + 1) % search->dimension]), edge[k]);
    gn_mesh_between(corner, x, v);
    if (search->dimension == 2) {
        const double length = sqrt(gn_mesh_dot(edge[0], edge[0])), along = gn_mesh_dot(v, edge[0]);
        const double off = fabs(edge[0][0] * v[1] - edge[0][1] * v[0]);
        return along >= 0.0 && along <= length * length && off <= reach * length;
    }
    gn_mesh_cross(edge[0], edge[1], normal);
    const double area = sqrt(gn_mesh_dot(normal, normal));
    if (!(area > 0.0) || fabs(gn_mesh_dot(normal, v)) > reach * area) return false;
    for (int k = 0; k < 3; k++) {
        gn_mesh_between(gn_joint_place(search, facet[k]), x, v);
        gn_mesh_cross(normal, edge[k], inward);
        if (gn_mesh_dot(inward, v) < -reach * area * sqrt(gn_mesh_dot(edge[k], edge[k])))
            return false;
    }
    return true;
}

static bool visit_touch(void *context, int32_t item) {
    touch_search *t = context;
    const gn_joint_search *s = t->s;
    const int32_t *facet = s->facet + 3 * (size_t)item;
    const double *x = gn_joint_place(s, t->node);
    touch_kind kind = TOUCH_NONE;
    for (int k = 0; k < s->dimension; k++)
        if (facet[k] == t->node) return false;
    for (int k = 0; k < s->dimension; k++) {
        if (distance2(x, gn_joint_place(s, facet[k])) > t->reach * t->reach) continue;
        kind = TOUCH_NODE;
        t->first = t->first && t->node < facet[k];
    }
    if (kind == TOUCH_NONE && on_facet(s, facet, x, t->reach)) kind = TOUCH_SIDE;
    touch_kind *most =
        gn_joint_part(s, facet[0]) == gn_joint_part(s, t->node) ? &t->own : &t->across;
    if (kind > *most) *most = kind;
    return false;
}

/* Counts of touching parts. */
typedef struct touch_count {
    size_t nodes, sides;
    double node_at[3], side_at[3];
} touch_count;

static void count_at(size_t *count, double at[3], const double *x) {
    if (!(*count)++) memcpy(at, x, 3 * sizeof *at);
}

static void count_touch(gn_joint_search *search, int32_t node, double reach, touch_count *across) {
    const double *x = gn_joint_place(search, node);
    touch_search t = {.s = search, .node = node, .reach = reach, .first = true};
    gn_box box;
    memcpy(box.lower, x, sizeof box.lower);
    memcpy(box.upper, x, sizeof box.upper);
    box_tree_near(&search->tree, &box, reach, visit_touch, &t);
    if (t.across == TOUCH_NODE && t.first) count_at(&across->nodes, across->node_at, x);
    if (t.across == TOUCH_SIDE) count_at(&across->sides, across->side_at, x);
    if (t.across != TOUCH_NONE) return;
    if (t.own == TOUCH_NODE && t.first)
        count_at(&search->joints->together, search->joints->together_at, x);
    if (t.own == TOUCH_SIDE) count_at(&search->joints->hanging, search->joints->hanging_at, x);
}

gneiss_status gn_joints_check_touch(gn_joint_search *search) {
    static const char advice[] =
        "no force goes through there: merge the nodes (gmsh: Coherence "
        "Mesh, or BooleanFragments before it meshes), or move the parts away";
    const double reach = fmin(digits * search->extent, edge_part * search->shortest);
    bool *seen = gn_alloc_array(search->mesh->node_count + 1, sizeof *seen);
    touch_count across = {0};
    if (!seen)
        return gn_fail(search->error, GNEISS_ERROR_MEMORY, "%s: no memory to check %zu nodes",
                       search->name, search->mesh->node_count);
    for (size_t k = 0; k < 3 * search->facet_count; k++) {
        int32_t node = search->facet[k];
        if ((int)(k % 3) >= search->dimension || seen[node]) continue;
        seen[node] = true;
        count_touch(search, node, reach, &across);
    }
    gn_free(seen);
    if (across.nodes)
        return gn_joint_refuse(search, across.node_at,
                               "expected parts that share the nodes where they touch, found %zu "
                               "parts with two nodes at one place in %zu places, not joined (%s); "
                               "the first is",
                               search->joints->parts, across.nodes, advice);
    if (across.sides)
        return gn_joint_refuse(search, across.side_at,
                               "expected parts that share the nodes where they touch, found %zu "
                               "parts with %zu hanging nodes, on a side of an element of another "
                               "part, not joined (%s); the first is",
                               search->joints->parts, across.sides, advice);
    return GNEISS_OK;
}
