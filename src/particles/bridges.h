/* Attraction of unbonded particles at a distance, and liquid bridges: their volumes, and the films
 * of the particles that they come from (with law.cohesion). */
#ifndef GN_PARTICLES_BRIDGES_H
#define GN_PARTICLES_BRIDGES_H

#include "frame/parts.h"
#include "scene/scene.h"

#include <stdint.h>

/* Returns (1 + theta/2)^3, where theta is the contact angle: the cube of the rupture distance over
 * the volume of a bridge (Lian, Thornton and Adams 1993). */
double gn_bridge_rupture(const gn_scene *scene);

/* Gives all particles their liquid at the start. */
void gn_bridges_begin(const gn_step_context *ctx, gn_dem *dem);

/* Returns the largest gap at which a listed pair may attract each other, over the sum of their
 * radii. */
double gn_bridges_reach(const gn_step_context *ctx, const gn_dem *dem);

/* Forms the bridges of pairs that touched for the first time in the last step, and gives the liquid
 * of ruptured ones back to the particles, half to each. Returns the energy that new bridges lose,
 * J. */
double gn_bridges_settle(const gn_step_context *ctx, gn_dem *dem);

/* Forms bridges between all pairs that touch and have none, among them pairs that had no liquid
 * before; returns the energy as above. */
double gn_bridges_form(const gn_step_context *ctx, gn_dem *dem);

/* Liquid in bridges between particles, and on the particles. */
typedef struct gn_liquid {
    int64_t bridges;
    double bridged, films; /* m3 */
} gn_liquid;
gn_liquid gn_bridges_sum(const gn_step_context *ctx, const gn_dem *dem);

#endif
