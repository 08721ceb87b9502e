/* Output of `plan` and `check` on finite elements; without elements nothing is printed. */
#ifndef GN_CLI_PLAN_ELEMENTS_H
#define GN_CLI_PLAN_ELEMENTS_H

#include "frame/parts.h"
#include "world/world.h"

void gn_print_element_kernels(const gn_world *world);
void gn_print_element_limits(const gn_world *world);
/* Prints unused nodes and reoriented elements; `indent` precedes each line. */
void gn_print_element_notes(const gn_world *world, const char *indent);
void gn_print_element_check(const gn_world *world, int *warnings);

#endif
