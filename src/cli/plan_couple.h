/* Output of `gneiss check` on coupling zones. */
#ifndef GN_CLI_PLAN_COUPLE_H
#define GN_CLI_PLAN_COUPLE_H

#include "zones/zones.h"

/* Returns the advised width, m, of a zone of elements and particles of these sizes: such zones
 * reflect as docs/coupling.md states. */
double gn_zone_advised_width(double element, double diameter);
/* True if the width is less than advised, beyond the rounding of a given width. */
bool gn_zone_is_thin(double width, double advised);
/* Prints the limit of particles and elements together, for `plan`. */
void gn_print_whole_limit(const gn_world *world);
/* Prints moduli and densities of particles beside those of elements; `several`: with the material.
 */
void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings);
void gn_print_zones(const gn_world *world, int *warnings);
/* Warns of walls that pass through elements. */
gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error);

#endif
