/* Expected overlap of Hertz contacts. */
#ifndef GN_TIMESTEP_INDENTATION_H
#define GN_TIMESTEP_INDENTATION_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* Updates the expected overlaps and the step if a kernel has found a larger overlap. */
gneiss_status gn_pressed_check(gn_world *world, gneiss_error *error);

#endif
