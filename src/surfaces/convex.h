/* Overlaps of convex bodies.
 *
 * With f_A(x) the depth of a point below the nearest face of A, V the common volume of two bodies
 * and W the integral over it of f_A + f_B, the depth of the overlap is h = W/V, the mean of the sum
 * of both depths: between two faces at distance d it is d; under a corner it is a fraction of the
 * corner's depth. h is a length and depends on the relative position of the bodies alone, so that k
 * h^2/2 is a potential: its forces and moments balance for any contact of faces, edges or corners.
 * Its derivatives need only integrals over the faces of the overlap, since where one body moves, V
 * grows by the volume that its surface sweeps, and W by that times the depth in the other body. */
#ifndef GN_SURFACES_CONVEX_H
#define GN_SURFACES_CONVEX_H

#include "surfaces/facet.h"

#include <stdbool.h>

/* A closed convex surface in its frame; in 2D a prism from z = -1/2 to 1/2 without ends. */
typedef struct gn_convex {
    size_t planes;   /* number of planes; 0: the body is not convex, or not closed */
    double *plane;   /* [planes][4]: outward unit normal n, and n.x on the plane, m */
    size_t polygons; /* number of facets; if vertices were rounded, the facets are those of the body
                        that the planes bound */
    int corners;     /* number of corners of each polygon: 3, in 2D 4 */
    double *corner;  /* [polygons][corners][3], m */
    int32_t *on;     /* [polygons] index of the plane that contains each */
} gn_convex;

/* Makes the convex body of a facet set; its first `vertices` vertices belong to it. */
gneiss_status gn_convex_make(const gn_facet_set *set, size_t vertices, gn_convex *convex,
                             gneiss_error *error);
void gn_convex_free(gn_convex *convex);

/* Cuts a polygon of `count` points at the plane n.x = at and writes the part with n.x <= at to
 * `to`, which must have room for one more corner. Returns the number of corners of this part. */
size_t gn_polygon_cut(const double *from, size_t count, const double n[3], double at, double *to);

/* The pose of a body: x = position + axes X, with the matrix `axes` stored by rows. */
typedef struct gn_convex_pose {
    double place[3], axes[9];
} gn_convex_pose;

/* Work space for two bodies with up to these numbers of planes and facets. */
typedef struct gn_convex_room {
    size_t planes, polygons;
    double *memory;
} gn_convex_room;
gneiss_status gn_convex_room_make(size_t planes, size_t polygons, gn_convex_room *room,
                                  gneiss_error *error);
void gn_convex_room_free(gn_convex_room *room);

/* The overlap of two bodies; vectors are in space, positions relative to the first body. */
typedef struct gn_convex_overlap {
    double volume, depth; /* m3, m: V, h */
    double along[3];      /* derivative of h by displacement of the second body; in 2D in x and y */
    double about[3];      /* m, derivative of h by rotation of the second body about `point` */
    double point[3];      /* m, a point on the line of the contact force */
    double spread[9];     /* m2, mean of r r^T over the faces, r from `point`, weighted by depth */
} gn_convex_overlap;

/* Tells whether two bodies overlap by more than `least`, m, and computes the overlap. */
bool gn_convex_meet(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                    const gn_convex_pose *at_b, double least, gn_convex_room *room,
                    gn_convex_overlap *overlap);

/* Returns the largest distance, m, by which a plane of one body separates the two, which is at most
 * their true distance; negative: no plane separates them. */
double gn_convex_apart(const gn_convex *a, const gn_convex_pose *at_a, const gn_convex *b,
                       const gn_convex_pose *at_b);

#endif
