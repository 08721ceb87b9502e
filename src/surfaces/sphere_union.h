/* Volume, centre and moments of a union of balls (2D: discs), whose overlaps count once. */
#ifndef GN_SURFACES_SPHERE_UNION_H
#define GN_SURFACES_SPHERE_UNION_H

#include "base/error.h"

#include <stddef.h>

typedef struct gn_sphere_union {
    double volume;    /* m3; 2D: m2, for a thickness of 1 m */
    double centre[3]; /* m */
    double moment[9]; /* m5: inertia about the centre over density; 2D: m4, the last entry alone */
    double error;     /* bound that the refinement reached, relative to size^3 and size^5; rounding
                         adds some 1e-14 */
} gn_sphere_union;

/* Computes the properties of `count` spheres [count][4] (x y z r, m). Volume, first and second
 * moments are integrals over the height z of those of a union of discs, which are exact sums over
 * the arcs of its boundary (Green's theorem). Between the heights where the pattern of arcs changes
 * (poles of spheres, poles of the circles in which two spheres meet, points on three spheres; those
 * inside another sphere change nothing) the
 * integrand is smooth but for half-integer powers at both ends, which a change of variable removes;
 * Gauss panels are halved until two orders agree to 1e-13. GNEISS_ERROR_MEMORY. */
gneiss_status gn_sphere_union_measure(const double *sphere, size_t count, int dimension,
                                      gn_sphere_union *out, gneiss_error *error);

#endif
