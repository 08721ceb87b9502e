/* Output of `plan` and `check` on elements that turn into particles. */
#ifndef GN_CLI_PLAN_CONVERT_H
#define GN_CLI_PLAN_CONVERT_H

#include "conversion/conversion.h"

void gn_print_conversion(gn_world *world, int *warnings);
/* Returns the seconds of a whole run and, with `print`, prints all their parts. The world
 * must not be run on afterwards. */
gneiss_status gn_plan_converting(gn_world *world, bool print, double *seconds, gneiss_error *error);

#endif
