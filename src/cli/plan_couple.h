/* What `gneiss check` says of zones that particles and elements share. */
#ifndef GN_CLI_PLAN_COUPLE_H
#define GN_CLI_PLAN_COUPLE_H

#include "zones/zones.h"

/* m: of a zone of elements and particles of these sizes: zones as wide return what docs/coupling.md
 * says. */
double gn_zone_advised(double element, double diameter);
/* Whether it is less: not by the rounding of a width that is given as so many. */
bool gn_zone_is_thin(double width, double advised);
/* Of `plan`: the limit of particles and elements as one. */
void gn_print_whole_limit(const gn_world *world);
/* Moduli and densities of particles beside those of elements; `several`: said of which material. */
void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings);
void gn_print_zones(const gn_world *world, int *warnings);
/* Warns of walls that elements go through. */
gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error);

#endif
