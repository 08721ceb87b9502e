/* Geometry of a particle that touches facets: triangles in space, segments in the plane.
 *
 * A facet's nearest point to the centre lies inside it, on an edge or at a corner. Where facets
 * share that feature and one of them comes nearer, the point is no minimum of the distance to the
 * surface and no contact: a face suppresses its edges and corners, an edge its corners, and nothing
 * counts twice (the hierarchy of Horner et al. 2001 and Santasusana et al. 2016, here by the
 * corners that facets share).
 *
 * Minima whose normals are less than GN_FACET_SHARE apart (shallow concave edges, overlapping
 * layers, plates) press on parts of the particle that overlap, and share its stiffness there. With
 * the unit normals m_i, the overlaps d_i and f_ij = f(angle of m_i, m_j) that falls from 1 for
 * equal normals to 0 at GN_FACET_SHARE, the overlaps are made by lambda_i >= 0 with d_i <= sum_j
 * f_ij lambda_j, equal where lambda_i > 0, and the forces are k lambda_i. That is the maximum of
 * d.lambda - 1/2 lambda.f lambda; k times it is a potential. f is C2-Wendland's (1 + 4 x)(1 - x)^4,
 * which is positive definite on the sphere (Gneiting 2013, Bernoulli 19, 1327, table 1), so that
 * the lambda are unique and continuous, whatever the number of contacts: nothing jumps where one
 * joins or leaves or the angle between facets changes. Equal normals act as the deepest of them
 * alone; steeper concave edges are two contacts, like two walls.
 */
#ifndef GN_SURFACES_FACET_H
#define GN_SURFACES_FACET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_FACET_TOUCHES = 96 };           /* that a particle can have with a surface */
static const double GN_FACET_SHARE = 0.6; /* rad, 34 degrees */

/* The nearest point of a facet. */
typedef struct gn_facet_near {
    double away[3];    /* m, from the centre to the point */
    double distance;   /* m */
    double weight[3];  /* of the corners in the point */
    double along[3];   /* m, along the edge that holds the point */
    int32_t corner[3]; /* vertices */
    unsigned feature;  /* bit k: corner k belongs to the feature that holds the point */
    size_t row;        /* the caller's */
} gn_facet_near;

/* A minimum that presses. */
typedef struct gn_facet_contact {
    double n[3];    /* unit, from the centre into the surface: the force is against it */
    double overlap; /* m, negative */
    double arm[3];  /* m, from the centre to the point of contact, on the surface */
    double part;  /* of the surface's stiffness that it has: lambda/d, 1 where nothing is shared */
    double crowd; /* sum of f over all that press, its own 1 included; of a patch (patch.h) the sum
                     of parts, 1 at least */
    int member;   /* place among the minima */
} gn_facet_contact;

/* Nearest point to `centre` of the facet with `corners` (2, 3) vertices at x; fills all but
 * `corner` and `row`. */
void gn_facet_nearest(int corners, const double *const x[3], const double centre[3],
                      gn_facet_near *near);

/* Adds to the list, which keeps the nearest GN_FACET_TOUCHES. */
void gn_facet_add(gn_facet_near *list, size_t *count, const gn_facet_near *item);

/* Keeps the minima, nearest first; returns their number. */
size_t gn_facet_minima(gn_facet_near *list, size_t count);

/* Minimum k by itself. */
void gn_facet_single(const gn_facet_near *minima, size_t k, double radius, gn_facet_contact *out);

/* Which minima of a particle of this radius (all overlap) press, and with what part of the
 * stiffness, deepest first; returns their number, at most `count`. */
size_t gn_facet_contacts(const gn_facet_near *minima, size_t count, double radius,
                         gn_facet_contact *contacts);

#endif
