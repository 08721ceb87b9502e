#include "mesh/box_tree.h"

#include "base/memory.h"

#include <math.h>

enum { LEAF = 8, DEPTH_MOST = 64 };

static double middle_of(const gn_box *box, int axis) {
    return 0.5 * (box->lower[axis] + box->upper[axis]);
}

/* Computes the box of items, and the axis along which their centres extend farthest. */
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

/* Quickselect (Hoare 1961): item[place] has the rank `place`; earlier items are not above it. */
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

void gn_box_tree_near(const gn_box_tree *tree, const gn_box *box, double reach, gn_box_visit *visit,
                      void *context) {
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
