/* Contact of a particle that is large compared with the facets of a deformable surface: pressure
 * over the surface that is in the particle, instead of contacts at the nearest points.
 *
 * The nearest points of nearly parallel facets change places at small motions of nodes, for any
 * time step: a potential of the deepest facet has a kink there, at which leap-frog gains energy.
 * Here the potential is an integral over the surface, U = k int G(s) dA with the distance s from
 * the centre. It has no kink, and no stiffness beyond k against nodes. G is chosen so that a plane
 * at the distance R - d has U = k d^2/2 exactly for any division into facets: in space       G = (R
 * - s)/(2 pi s),  -G' = R/(2 pi s^2): the force on a facet is k R/(2 pi) times the integral of
 * x/s^3, along the normal the solid angle; in the plane   G = (R acosh(R/s) - sqrt(R^2 - s^2))/pi,
 * -G' = sqrt(R^2 - s^2)/(pi s), the solution of Abel's equation for the same condition. All
 * integrals have closed forms. The force acts along the line from the centre through `point`. The
 * moments of the pressure within one facet about that point, which stretch the facet, are
 * neglected, and so is the change of U by its area, which balances them in uniform strain. */
#ifndef GN_SURFACES_PATCH_H
#define GN_SURFACES_PATCH_H

#include "surfaces/facet.h"

enum { GN_PATCH_FACETS = 512 }; /* largest number of facets in contact with a particle */

/* The part of a facet that is inside the particle. */
typedef struct gn_patch_facet {
    double force;     /* m, force over k */
    double potential; /* m2, potential over k */
} gn_patch_facet;

/* Computes the pressure of the facet with `corners` (2, 3) vertices at x. Sets all members of *near
 * but `corner` and `row`, for the point of the force; its feature is the whole facet. Returns false
 * if the facet is outside the particle. */
bool gn_patch_press(int corners, const double *const x[3], const double centre[3], double radius,
                    gn_facet_near *near, gn_patch_facet *facet);

/* Makes the contacts of a particle with these facets from the forces and potentials of all of them:
 * facets of about the same direction have a common overlap. `hertz`: forces are proportional to the
 * overlap's power 3/2. */
void gn_patch_contacts(const gn_facet_near *near, const gn_patch_facet *facet, size_t count,
                       bool hertz, gn_facet_contact *contacts);

/* Returns the degree, 0 to 1, to which two directions belong to one contact, from the cosine of
 * their angle: 1 for angles up to GN_FACET_SHARE, 0 from 60 degrees on. */
double gn_patch_share(double cosine);

#endif
