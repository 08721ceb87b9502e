/* Bodies of finite elements as rigid wholes: their effective mass in a collision with a particle.
 */
#ifndef GN_SOLIDS_ELEMENT_BODIES_H
#define GN_SOLIDS_ELEMENT_BODIES_H

#include "base/error.h"
#include "boundary/surface.h"
#include "solids/solids.h"

#include <stdint.h>

/* Elements connected by nodes, as a rigid body at the start. */
typedef struct gn_element_body {
    double centre[3];          /* m, centre of mass at the start */
    double inverse_mass[3];    /* 1/kg along x y z; 0: a motion drives this component of a node */
    double inverse_inertia[9]; /* 1/(kg m2), symmetric; 0: a motion drives a node */
} gn_element_body;

/* Finds the bodies; the caller frees contact.bodies and contact.body. */
gneiss_status gn_element_bodies_find(struct gn_element_model *q, gneiss_error *error);

/* Returns the inverse mass, 1/kg, of the body of a facet, as a rigid whole, along a unit vector at
 * the point of the facet with the shape functions `weight`. */
double gn_element_body_inverse_mass(const gn_surface *surface, int32_t facet,
                                    const double weight[3], const double n[3]);

#endif
