/* Ends of a test that move as fast as a reading is to grow: past a peak where the axial motion
 * alone would release more than breaking takes. */
#ifndef GN_LABORATORY_CONTROL_H
#define GN_LABORATORY_CONTROL_H

#include "frame/parts.h"
#include "frame/step_context.h"

#include <stddef.h>

void gn_control_create(gn_step_context *ctx);
/* Looks at the reading every so many steps; before the forces of a step. */
void gn_control_look(gn_world *world);

#endif
