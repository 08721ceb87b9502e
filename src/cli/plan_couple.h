/* What `gneiss check` says of zones that particles and elements share. */
#ifndef GN_CLI_PLAN_COUPLE_H
#define GN_CLI_PLAN_COUPLE_H

#include "sim/coupling.h"

/* Of `plan`: the limit of particles and elements as one. */
void gn_print_whole_limit(const gn_world *world);
/* Moduli and densities of particles beside those of elements; `several`: said of which material. */
void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings);
void gn_print_zones(const gn_world *world, int *warnings);
/* Warns of walls that elements go through. */
gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error);

#endif
