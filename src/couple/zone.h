/* Coupling zones, in which particles and elements share the material. The weight of the elements is
 * alpha: 0 at the edge of the elements, 1 at the edge of the particles, whose weight is 1 - alpha.
 * Virtual work is divided by these weights (Xiao & Belytschko 2004; Ben Dhia & Rateau 2005).
 *
 * With the distances d0 and d1 of a point to both edges, alpha = d0/(d0 + d1), which is linear
 * between parallel planes. Of several edges of one zone the largest alpha applies: the particles
 * are in the intersection of the half spaces. Of several zones the least applies. */
#ifndef GN_COUPLE_ZONE_H
#define GN_COUPLE_ZONE_H

#include "scene/scene.h"

/* A point within this fraction of the width is on an edge. */
#define GN_ZONE_ROUNDING 1e-9

/* Returns alpha of one zone without limits: it is below 0 beyond the edge of the elements and above
 * 1 beyond that of the particles. */
double gn_zone_place(const gn_couple_zone *zone, int dimension, const double x[3]);

/* Returns alpha at a point; 1 outside of all zones. `scene` is a gn_scene; the signature is that of
 * gn_fem_spec.share. */
double gn_zones_share(const void *scene, const double *x);

/* Return the least width of a zone, and the least width of all zones, m. */
double gn_zone_width(const gn_couple_zone *zone, int dimension);
double gn_zones_width(const gn_scene *scene);

/* Computes the unit vector from the edge of the elements towards the particles, at the first edge
 * of a zone. */
void gn_zone_direction(const gn_couple_zone *zone, int dimension, double n[3]);

#endif
