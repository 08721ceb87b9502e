/* Zones in which particles and elements are at the same places as one body, and what part of it the
 * elements are there: alpha, 0 at the edge where they end among the particles, 1 at the edge where
 * the particles end. Particles have 1 - alpha. Virtual work is shared out by these weights (Xiao &
 * Belytschko 2004; Ben Dhia & Rateau 2005).
 *
 * With d0 and d1 the distances of a place to both edges, alpha = d0/(d0 + d1), which between
 * parallel planes is linear. Of several edges of one zone the largest counts: the particles are
 * what lies before all of them. Of several zones the least. */
#ifndef GN_COUPLE_ZONE_H
#define GN_COUPLE_ZONE_H

#include "scene/scene.h"

/* Within this part of its width a place is on an edge. */
#define GN_ZONE_ROUNDING 1e-9

/* alpha of one zone, not cut off: below 0 beyond the end of the elements, above 1 beyond that of
 * the particles. */
double gn_zone_place(const gn_couple_zone *zone, int dimension, const double x[3]);

/* alpha at a place; 1 outside of all zones. `scene`: a gn_scene. As gn_fem_spec.share. */
double gn_zones_share(const void *scene, const double *x);

/* m: the least width of a zone, and of all. */
double gn_zone_width(const gn_couple_zone *zone, int dimension);
double gn_zones_width(const gn_scene *scene);

/* Unit vector from where the elements end into the particles, of the first edge of a zone. */
void gn_zone_direction(const gn_couple_zone *zone, int dimension, double n[3]);

#endif
