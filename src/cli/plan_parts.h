/* Output of `plan` and `check` on materials, elements, zones and idle effects. Nothing is printed
 * about parts that a scene lacks. */
#ifndef GN_CLI_PLAN_PARTS_H
#define GN_CLI_PLAN_PARTS_H

#include "frame/parts.h"
#include "world/world.h"
#include "zones/zones.h"

void gn_print_element_kernels(const gn_world *world);
void gn_print_element_limits(const gn_world *world);
/* Prints unused nodes and reoriented elements; `indent` precedes each line. */
void gn_print_element_notes(const gn_world *world, const char *indent);
void gn_print_element_check(const gn_world *world, int *warnings);

/* Returns the recommended width, m, of a zone between elements and particles of these sizes;
 * docs/coupling.md states how much such a zone reflects. */
double gn_zone_advised_width(double element, double diameter);

/* True if the width is less than the recommended one by more than rounding. */
bool gn_zone_is_thin(double width, double advised);

/* Prints the limit of the step for particles and elements together, for `plan`. */
void gn_print_whole_limit(const gn_world *world);

/* Prints moduli and densities of particles and elements side by side; `several`: with the name of
 * the material. */
void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings);
void gn_print_zones(const gn_world *world, int *warnings);

/* Warns of walls that pass through elements. */
gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error);
gneiss_status gn_print_law(const gn_world *world, int *warnings, gneiss_error *error);

/* Prints the idle effects for `gneiss plan`: only those that are certain from the scene and the
 * first lists of neighbours. */
void gn_print_idle(const gn_world *world);

/* Prints contacts and area of each joint, and doubts about them. */
void gn_print_joint_check(const gn_world *world, int *warnings);

#endif
