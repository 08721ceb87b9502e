/* Elements, their faces and their boundary. Private to joints*.c. */
#ifndef GN_MESH_JOINTS_PRIVATE_H
#define GN_MESH_JOINTS_PRIVATE_H

#include "mesh/joints.h"
#include "mesh/mesh_private.h"

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
static inline bool gn_box_is_near(const gn_box *a, const gn_box *b, double reach) {
    for (int k = 0; k < 3; k++)
        if (a->lower[k] > b->upper[k] + reach || b->lower[k] > a->upper[k] + reach) return false;
    return true;
}

typedef struct gn_joint_search {
    const gn_mesh *mesh;
    const gn_mesh_elements *solids;
    int dimension; /* dimension, which is also the number of nodes of a face */
    const double *origin;
    const char *name;
    gneiss_error *error;
    gn_mesh_joints *joints;

    size_t face_count;
    int32_t *owner; /* [faces] element that the face belongs to */
    /* [faces] local face, or -1 - local face if the element is on the other side; number of its
     * elements */
    int8_t *side, *use;
    int32_t *part; /* [nodes] parent in the tree of nodes that elements connect */

    size_t facet_count;   /* number of faces that belong to one element only */
    int32_t *facet;       /* [facets][3] nodes */
    int32_t *facet_owner; /* [facets] element */
    gn_box *box;          /* [facets] */
    gn_box_tree tree;
    double extent;   /* m, longest side of the bounding box of the mesh */
    double shortest; /* m, shortest edge of a facet */
} gn_joint_search;

static inline const double *gn_joint_place(const gn_joint_search *search, int32_t node) {
    return search->mesh->node + 3 * (size_t)node;
}

static inline const int32_t *gn_joint_nodes(const gn_joint_search *search, size_t element) {
    return search->solids->node + (size_t)search->solids->nodes * element;
}

/* Returns the root of a node's part. */
int32_t gn_joint_part(const gn_joint_search *search, int32_t node);

/* Fails with "NAME: expected ..., found ...; the first is at PLACE". */
gneiss_status gn_joint_refuse(const gn_joint_search *search, const double at[3], const char *format,
                              ...) __attribute__((format(printf, 3, 4)));

/* joints_touch.c: overlapping elements; coincident nodes, nodes on sides. */
gneiss_status gn_joints_check_overlap(gn_joint_search *search);
gneiss_status gn_joints_check_touch(gn_joint_search *search);

#endif
