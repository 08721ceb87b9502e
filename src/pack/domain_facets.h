/* The boundary of a body as facets: straight segments in 2D, triangles in 3D. Private to pack. */
#ifndef GN_PACK_DOMAIN_FACETS_H
#define GN_PACK_DOMAIN_FACETS_H

#include "pack/domain.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Flags of a facet; for edge or corner k (0 to 2) flags with _0 are shifted by k. A re-entrant edge
 * or corner is flagged in only one of its facets. */
enum {
    GN_FACET_CREASE_0 = 1, /* re-entrant edge, which can be nearer to a point than its facets */
    GN_FACET_TIP_0 =
        8, /* corner with a re-entrant edge, which can be nearer to a point than its facets */
    GN_FACET_PINCHED_0 =
        64,               /* corner that is the only common point of two sheets of the boundary */
    GN_FACET_NEEDLE = 512 /* facet with almost no area, which its edges replace */
};

/* A facet. Edge k runs from corner k to corner k + 1. A segment has corners 0 and 1 and no
 * neighbours. */
typedef struct gn_facet {
    double corner[3][3];
    double normal[3]; /* unit, out of the body */
    int32_t node[3];
    int32_t neighbour[3]; /* across edge k: 4 * facet + edge of that facet */
    int32_t id;           /* number in the caller's order, base 0 */
    uint32_t flags;
} gn_facet;
_Static_assert(sizeof(gn_facet) == 128, "a facet fills two cache lines");

/* A node of the bounding box tree of facets, parents before children. Inner node: count 0, children
 * at own index + 1 and `first`. Leaf: facets first .. first + count - 1. */
typedef struct gn_tree_node {
    double lower[3], upper[3];
    int32_t first, count;
} gn_tree_node;

typedef struct gn_facets {
    int corners; /* corners per facet: 2 or 3, which is also the dimension of the body */
    size_t count, node_count, tree_count;
    gn_facet *facet; /* [facet_count] in the order of the tree */
    gn_tree_node *tree;
    double *node_normal; /* [node_count][3], sums of normals weighted by angle, not unit vectors */
    int32_t *star_first; /* [node_count + 1] first entry in `star` of a node */
    int32_t *star;       /* facets around the nodes, as 4 * facet + corner */
    double lower[3], upper[3];
    double size; /* m, longest side of the bounding box */
    double volume;
    /* Depths at the centres of a grid of cubes, for fast answers far from the boundary. */
    float *known;
    int cells[3];
    double cell, origin[3];
} gn_facets;

/* The nearest point of the boundary. feature: 0 inside the facet, 1 + k on edge k, 4 + k corner
 * k. */
typedef struct gn_foot {
    double at[3];
    double distance2;
    int32_t facet;
    int feature;
} gn_foot;

/* Makes facets from element [count][corners]: node indices from 0, normals outward (2D: the body on
 * the left). `name` is the prefix of messages. */
gneiss_status gn_facets_create(const double *node, size_t node_count, const int32_t *element,
                               size_t count, int corners, const char *name, gn_facets **facets,
                               gneiss_error *error);
void gn_facets_free(gn_facets *facets);
double gn_facets_depth(const gn_facets *facets, const double x[3]);
int gn_facets_planes(const gn_facets *facets, const double point[3], double reach,
                     gn_domain_plane planes[GN_DOMAIN_PLANES]);

/* Sorts the facets into the tree (domain_tree.c). */
gneiss_status gn_tree_build(gn_facets *facets, gneiss_error *error);
/* Finds the nearest point of the boundary within `limit`; facet -1 if there is none. */
gn_foot gn_tree_nearest(const gn_facets *facets, const double x[3], double limit);
/* Calls `visit` for runs of facets that include all whose boxes are within `reach` of the given
 * box, until `visit` returns true; this is then the result. */
typedef bool gn_tree_visit(const gn_facets *facets, int32_t first, int32_t count, void *context);
bool gn_tree_within(const gn_facets *facets, const double lower[3], const double upper[3],
                    double reach, gn_tree_visit *visit, void *context);

/* Checks that facets do not intersect. */
gneiss_status gn_facets_check_cuts(const gn_facets *facets, const char *name, gneiss_error *error);

/* Computes the grid of known depths. */
gneiss_status gn_facets_know(gn_facets *surface, gneiss_error *error);

static inline double gn_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void gn_minus(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[k] - b[k];
}

static inline void gn_cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline int gn_next(int k) {
    return k == 2 ? 0 : k + 1;
}

/* Tells whether the projection of x onto the facet's plane is in the facet, enlarged by `slack`. */
static inline bool gn_facet_faces(const gn_facet *facet, int corners, const double x[3],
                                  double slack) {
    double edge[3], inward[3], v[3];
    if (corners == 2) {
        gn_minus(facet->corner[1], facet->corner[0], edge);
        gn_minus(x, facet->corner[0], v);
        double along = gn_dot(v, edge), length2 = gn_dot(edge, edge), over = along - length2;
        return !(along < 0 && along * along > slack * slack * length2) &&
               !(over > 0 && over * over > slack * slack * length2);
    }
    for (int k = 0; k < 3; k++) {
        gn_minus(facet->corner[gn_next(k)], facet->corner[k], edge);
        gn_cross(facet->normal, edge, inward);
        gn_minus(x, facet->corner[k], v);
        double s = gn_dot(inward, v);
        if (s < 0 && s * s > slack * slack * gn_dot(edge, edge)) return false;
    }
    return true;
}

#endif
