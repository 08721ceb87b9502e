/* Convex bodies that lie in each other.
 *
 * With f_A(x) the depth of a point below the nearest face of A, V the volume that two bodies share
 * and W the integral over it of f_A + f_B, the depth of the overlap is h = W/V, the mean of the sum
 * of both depths: between two faces, d apart, it is d; under a corner a part of what that is deep.
 * h has the dimension of a length and is a function of how the bodies lie to each other alone, so
 * that k h^2/2 is a potential: forces and moments of it balance, whatever touches, faces, edges or
 * corners. Its derivatives need no more than integrals over the faces of the overlap, since where
 * one body moves, V grows by what its surface sweeps, and W by that times the depth in the other.
 */
#ifndef GN_SURFACES_CONVEX_H
#define GN_SURFACES_CONVEX_H

#include "surfaces/facet_tree.h"

#include <stdbool.h>

/* Of a closed convex surface, in its frame; in the plane a prism from z = -1/2 to 1/2 without ends.
 */
typedef struct gn_convex {
    size_t planes;   /* 0: not convex, or not closed */
    double *plane;   /* [planes][4]: unit normal outward, m: n.x on it */
    size_t polygons; /* the facets; of rounded vertices those of the planes' own body */
    int corners;     /* of each: 3, in the plane 4 */
    double *corner;  /* [polygons][corners][3], m */
    int32_t *on;     /* [polygons] its plane */
} gn_convex;

/* `vertices` of them belong to the set. */
gneiss_status gn_convex_make(const gn_facet_set *set, size_t vertices, gn_convex *convex,
                             gneiss_error *error);
void gn_convex_free(gn_convex *convex);

/* What of a polygon, `count` places one behind the other, has n.x <= at: into `to`, with room for
 * one corner more; returns how many there are. */
size_t gn_polygon_cut(const double *from, size_t count, const double n[3], double at, double *to);

/* Where a body is: x = place + axes X, rows of the matrix. */
typedef struct gn_convex_pose {
    double place[3], axes[9];
} gn_convex_pose;

/* Room to work in, for two bodies of so many planes and facets at most. */
typedef struct gn_convex_room {
    size_t planes, polygons;
    double *memory;
} gn_convex_room;
gneiss_status gn_convex_room_make(size_t planes, size_t polygons, gn_convex_room *room,
                                  gneiss_error *error);
void gn_convex_room_free(gn_convex_room *room);

/* Vectors are in space, places from that of the first body. */
typedef struct gn_convex_overlap {
    double volume, depth; /* m3, m: V, h */
    double along[3];      /* of h, per path of the second body; in the plane of x and y */
    double about[3];      /* m, per turn of it about `point` */
    double point[3];      /* m, on the line along which it is pushed */
    double spread[9];     /* m2, mean of r r^T over the faces, r from `point`, weighed by depth */
} gn_convex_overlap;

/* Whether they overlap by more than `least`, m; then how. */
bool gn_convex_meet(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                    const gn_convex_pose *at_b, double least, gn_convex_room *room,
                    gn_convex_overlap *overlap);

/* m: a plane of one of them keeps them apart by so much, or more; negative: none does. Not larger
 * than the distance. */
double gn_convex_apart(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                       const gn_convex_pose *at_b);

#endif
