/* A bounding box tree for queries near a box. */
#ifndef GN_MESH_BOX_TREE_H
#define GN_MESH_BOX_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_box {
    double lower[3], upper[3];
} gn_box;

/* The children of an inner node are the next node and `right`; a leaf has `count` > 0 items from
 * `first` on in gn_box_tree.item. */
typedef struct gn_box_node {
    gn_box box;
    int32_t first, count, right;
} gn_box_node;

typedef struct gn_box_tree {
    size_t node_count;
    gn_box_node *node;
    int32_t *item; /* [boxes] */
} gn_box_tree;

/* Builds a tree in n log n; returns false without memory. */
bool gn_box_tree_build(const gn_box *box, size_t count, gn_box_tree *tree);
void gn_box_tree_free(gn_box_tree *tree);

/* Calls `visit` for the items of all leaves within `reach` of the box, which include all items
 * within reach, until it returns true. */
typedef bool gn_box_visit(void *context, int32_t item);
void gn_box_tree_near(const gn_box_tree *tree, const gn_box *box, double reach, gn_box_visit *visit,
                      void *context);

static inline bool gn_box_is_near(const gn_box *a, const gn_box *b, double reach) {
    for (int k = 0; k < 3; k++)
        if (a->lower[k] > b->upper[k] + reach || b->lower[k] > a->upper[k] + reach) return false;
    return true;
}

#endif
