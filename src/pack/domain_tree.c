#include "base/new.h"
#include "pack/domain_facets.h"

#include <math.h>
#include <stdlib.h>

/* Number of facets in a leaf. Halving keeps the depth of the tree below log2(2^31 / 2) + 1. */
enum { LEAF = 4, STACK = 64 };

/* Twice the centre of a facet's box, and the index of the facet. */
typedef struct tree_item {
    double middle[3];
    int32_t facet;
} tree_item;

static void facet_box(const gn_facet *facet, int corners, double lower[3], double upper[3]) {
    for (int k = 0; k < 3; k++) {
        lower[k] = upper[k] = facet->corner[0][k];
        for (int c = 1; c < corners; c++) {
            lower[k] = fmin(lower[k], facet->corner[c][k]);
            upper[k] = fmax(upper[k], facet->corner[c][k]);
        }
    }
}

static bool item_before(const tree_item *a, const tree_item *b, int axis) {
    if (a->middle[axis] != b->middle[axis]) return a->middle[axis] < b->middle[axis];
    return a->facet < b->facet;
}

/* Selects by Hoare's method: along the axis the items before `nth` are at most that one, and the
 * others at least. The order is total, so that the result depends on the items alone. */
static void select_nth(tree_item *items, int32_t count, int32_t nth, int axis) {
    int32_t low = 0, high = count - 1;
    while (low < high) {
        tree_item pivot = items[low + (high - low) / 2];
        int32_t i = low, j = high;
        while (i <= j) {
            while (item_before(&items[i], &pivot, axis)) i++;
            while (item_before(&pivot, &items[j], axis)) j--;
            if (i > j) break;
            tree_item swap = items[i];
            items[i++] = items[j];
            items[j--] = swap;
        }
        if (nth <= j)
            high = j;
        else if (nth >= i)
            low = i;
        else
            return;
    }
}

static int longest_axis(const tree_item *items, int32_t count) {
    int axis = 0;
    double longest = -1;
    for (int k = 0; k < 3; k++) {
        double lower = INFINITY, upper = -INFINITY;
        for (int32_t i = 0; i < count; i++) {
            lower = fmin(lower, items[i].middle[k]);
            upper = fmax(upper, items[i].middle[k]);
        }
        if (upper - lower > longest) longest = upper - lower, axis = k;
    }
    return axis;
}

/* Makes the subtree of items first .. first + count - 1; returns its index. */
static int32_t lay_out(gn_facets *facets, tree_item *items, int32_t first, int32_t count) {
    int32_t index = (int32_t)facets->tree_count++;
    gn_tree_node *node = &facets->tree[index];
    if (count <= LEAF) {
        node->first = first;
        node->count = count;
        return index;
    }
    int32_t half = count / 2;
    select_nth(items + first, count, half, longest_axis(items + first, count));
    lay_out(facets, items, first, half);
    node->first = lay_out(facets, items, first + half, count - half);
    return index;
}

/* Sets all boxes in a single pass from the end, because children have higher indices than their
 * parents. */
static void set_boxes(gn_facets *facets) {
    for (size_t i = facets->tree_count; i-- > 0;) {
        gn_tree_node *node = &facets->tree[i];
        if (!node->count) {
            const gn_tree_node *a = node + 1, *b = &facets->tree[node->first];
            for (int k = 0; k < 3; k++) {
                node->lower[k] = fmin(a->lower[k], b->lower[k]);
                node->upper[k] = fmax(a->upper[k], b->upper[k]);
            }
            continue;
        }
        facet_box(&facets->facet[node->first], facets->corners, node->lower, node->upper);
        for (int32_t f = 1; f < node->count; f++) {
            double lower[3], upper[3];
            facet_box(&facets->facet[node->first + f], facets->corners, lower, upper);
            for (int k = 0; k < 3; k++) {
                node->lower[k] = fmin(node->lower[k], lower[k]);
                node->upper[k] = fmax(node->upper[k], upper[k]);
            }
        }
    }
}

gneiss_status gn_tree_build(gn_facets *facets, gneiss_error *error) {
    const size_t count = facets->count;
    GN_FREED tree_item *items = NULL;
    GN_FREED gn_facet *unsorted = facets->facet;
    facets->facet = NULL;
    GN_TRY(gn_new(&items, count, "facets", error));
    GN_TRY(gn_new(&facets->tree, count + 1, "nodes of a tree", error));
    for (size_t i = 0; i < count; i++) {
        double lower[3], upper[3];
        facet_box(&unsorted[i], facets->corners, lower, upper);
        items[i].facet = (int32_t)i;
        for (int k = 0; k < 3; k++) items[i].middle[k] = lower[k] + upper[k];
    }
    lay_out(facets, items, 0, (int32_t)count);
    GN_TRY(gn_new(&facets->facet, count, "facets", error));
    for (size_t i = 0; i < count; i++) facets->facet[i] = unsorted[items[i].facet];
    set_boxes(facets);
    return GNEISS_OK;
}

static double boxes_distance2(const gn_tree_node *node, const double lower[3],
                              const double upper[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double below = node->lower[k] - upper[k], above = lower[k] - node->upper[k];
        double d = below > above ? below : above;
        if (d > 0) sum += d * d;
    }
    return sum;
}

static void foot_between(const double a[3], const double b[3], double t, double at[3]) {
    for (int k = 0; k < 3; k++) at[k] = a[k] + t * (b[k] - a[k]);
}

/* Finds the foot of x on a segment and returns its feature. */
static int segment_foot(const gn_facet *facet, const double x[3], double at[3]) {
    double edge[3], v[3];
    gn_minus(facet->corner[1], facet->corner[0], edge);
    gn_minus(x, facet->corner[0], v);
    double along = gn_dot(v, edge), length2 = gn_dot(edge, edge);
    if (along <= 0 || along >= length2) {
        int corner = along > 0;
        for (int k = 0; k < 3; k++) at[k] = facet->corner[corner][k];
        return 4 + corner;
    }
    foot_between(facet->corner[0], facet->corner[1], along / length2, at);
    return 0;
}

/* Finds the closest point of a triangle by its Voronoi regions (Ericson 2005, Real-Time Collision
 * Detection, 5.1.5). */
static int triangle_foot(const gn_facet *facet, const double x[3], double at[3]) {
    const double *a = facet->corner[0], *b = facet->corner[1], *c = facet->corner[2];
    double ab[3], ac[3], v[3];
    gn_minus(b, a, ab);
    gn_minus(c, a, ac);
    gn_minus(x, a, v);
    double d1 = gn_dot(ab, v), d2 = gn_dot(ac, v);
    if (d1 <= 0 && d2 <= 0) return foot_between(a, a, 0, at), 4;
    gn_minus(x, b, v);
    double d3 = gn_dot(ab, v), d4 = gn_dot(ac, v);
    if (d3 >= 0 && d4 <= d3) return foot_between(b, b, 0, at), 5;
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return foot_between(a, b, d1 / (d1 - d3), at), 1;
    gn_minus(x, c, v);
    double d5 = gn_dot(ab, v), d6 = gn_dot(ac, v);
    if (d6 >= 0 && d5 <= d6) return foot_between(c, c, 0, at), 6;
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return foot_between(a, c, d2 / (d2 - d6), at), 3;
    double va = d3 * d6 - d5 * d4, p = d4 - d3, q = d5 - d6;
    if (va <= 0 && p >= 0 && q >= 0) return foot_between(b, c, p / (p + q), at), 2;
    /* On slivers the projection along the unit normal is more accurate than the barycentric sum. */
    double height = gn_dot(facet->normal, v);
    for (int k = 0; k < 3; k++) at[k] = x[k] - height * facet->normal[k];
    return 0;
}

static void try_facet(const gn_facets *facets, int32_t index, const double x[3], gn_foot *best) {
    const gn_facet *f = &facets->facet[index];
    double v[3], at[3];
    gn_minus(x, f->corner[0], v);
    double height = gn_dot(f->normal, v);
    if (height * height >= best->distance2 || (f->flags & GN_FACET_NEEDLE)) return;
    int feature = facets->corners == 2 ? segment_foot(f, x, at) : triangle_foot(f, x, at);
    gn_minus(x, at, v);
    double distance2 = feature ? gn_dot(v, v) : height * height;
    if (distance2 >= best->distance2) return;
    best->distance2 = distance2;
    best->facet = index;
    best->feature = feature;
    for (int k = 0; k < 3; k++) best->at[k] = at[k];
}

gn_foot gn_tree_nearest(const gn_facets *facets, const double x[3], double limit) {
    gn_foot best = {.distance2 = limit * limit, .facet = -1};
    struct {
        int32_t node;
        double distance2;
    } stack[STACK];
    int depth = 0;
    stack[depth].node = 0;
    stack[depth++].distance2 = 0;
    while (depth) {
        depth--;
        if (stack[depth].distance2 >= best.distance2) continue;
        const gn_tree_node *node = &facets->tree[stack[depth].node];
        if (node->count) {
            for (int32_t f = 0; f < node->count; f++) try_facet(facets, node->first + f, x, &best);
            continue;
        }
        int32_t near = stack[depth].node + 1, far = node->first;
        double near2 = boxes_distance2(&facets->tree[near], x, x),
               far2 = boxes_distance2(&facets->tree[far], x, x);
        if (far2 < near2) {
            int32_t node_swap = near;
            double swap = near2;
            near = far, near2 = far2;
            far = node_swap, far2 = swap;
        }
        stack[depth].node = far;
        stack[depth++].distance2 = far2;
        stack[depth].node = near;
        stack[depth++].distance2 = near2;
    }
    return best;
}

bool gn_tree_within(const gn_facets *facets, const double lower[3], const double upper[3],
                    double reach, gn_tree_visit *visit, void *context) {
    int32_t stack[STACK];
    int depth = 0;
    stack[depth++] = 0;
    while (depth) {
        int32_t index = stack[--depth];
        const gn_tree_node *node = &facets->tree[index];
        if (boxes_distance2(node, lower, upper) > reach * reach) continue;
        if (node->count) {
            if (visit(facets, node->first, node->count, context)) return true;
            continue;
        }
        stack[depth++] = node->first;
        stack[depth++] = index + 1;
    }
    return false;
}
