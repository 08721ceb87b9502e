/* A bounding box tree over facets for queries near a point. */
#ifndef GN_SURFACES_FACET_TREE_H
#define GN_SURFACES_FACET_TREE_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_facet_box {
    double lower[3], upper[3];
    /* range of `order` in a leaf; count 0: the children are the next box and `right` */
    int32_t begin, count;
    int32_t right;
} gn_facet_box;

typedef struct gn_facet_tree {
    size_t boxes;
    gn_facet_box *box;
    int32_t *order; /* [facets] */
} gn_facet_tree;

/* The facets of a tree (borrowed). */
typedef struct gn_facet_set {
    int corners; /* of a facet: 2 segments in the plane, 3 triangles */
    size_t count;
    const int32_t *corner; /* [count][corners] */
    const double *pos;     /* [vertices][4] */
} gn_facet_set;

gneiss_status gn_facet_tree_build(const gn_facet_set *set, gn_facet_tree *tree,
                                  gneiss_error *error);
/* Updates the boxes after vertices moved. */
void gn_facet_tree_refit(const gn_facet_set *set, gn_facet_tree *tree);
void gn_facet_tree_free(gn_facet_tree *tree);

/* Finds the facets nearer to the centre than `reach`, ascending; `found` NULL only counts them. */
size_t gn_facet_tree_near(const gn_facet_tree *tree, const gn_facet_set *set,
                          const double centre[3], double reach, int32_t *found);

#endif
