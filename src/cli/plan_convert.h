/* What `plan` and `check` say of elements that turn into particles. */
#ifndef GN_CLI_PLAN_CONVERT_H
#define GN_CLI_PLAN_CONVERT_H

#include "conversion/conversion.h"

void gn_print_conversion(gn_world *world, int *warnings);
/* Of a whole run, with `print` said with all that it is made of; s. The world is of no use after
 * it. */
gneiss_status gn_plan_converting(gn_world *world, bool print, double *seconds, gneiss_error *error);

#endif
