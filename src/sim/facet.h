/* Geometry of a particle that touches facets: triangles in space, segments in the plane.
 *
 * A facet's nearest point to the centre lies inside it, on an edge or at a corner. Where facets
 * share that feature and one of them comes nearer, the point is no minimum of the distance to the
 * surface and no contact: a face suppresses its edges and corners, an edge its corners, and nothing
 * counts twice (the hierarchy of Horner et al. 2001 and Santasusana et al. 2016, here by the
 * corners that facets share).
 *
 * Minima whose normals are less than GN_FACET_JOIN apart (shallow concave edges, overlapping
 * layers, plates) act as one contact: its overlap vector is the shortest translation of the
 * particle that resolves all of their overlaps. That is the projection onto a convex set: it does
 * not jump where a contact joins or leaves, it is the one overlap where normals agree, and k/2 of
 * its square is a potential of the force. Steeper concave edges are two contacts, like two walls.
 */
#ifndef GN_SIM_FACET_H
#define GN_SIM_FACET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_FACET_TOUCHES = 96 };          /* that a particle can have with a surface */
static const double GN_FACET_JOIN = 0.9; /* cosine of 25.8 degrees */

/* The nearest point of a facet. */
typedef struct gn_facet_near {
    double away[3];    /* m, from the centre to the point */
    double distance;   /* m */
    double weight[3];  /* of the corners in the point */
    int32_t corner[3]; /* vertices */
    unsigned feature;  /* bit k: corner k belongs to the feature that holds the point */
    size_t row;        /* the caller's */
} gn_facet_near;

/* Some minima that act as one. */
typedef struct gn_facet_contact {
    double n[3];    /* unit, from the centre into the surface */
    double overlap; /* m, negative */
    double arm[3];  /* m, from the centre to the point of contact, on the surface */
    int members;    /* that press: one to three */
    int member[3];  /* places among the minima */
    double share[3];
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

/* Joins minima of a particle of this radius (all overlap) into contacts, deepest first; returns
 * their number, at most `count`. */
size_t gn_facet_contacts(const gn_facet_near *minima, size_t count, double radius,
                         gn_facet_contact *contacts);

#endif
