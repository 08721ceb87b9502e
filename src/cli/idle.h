/* Effects that a scene uses although they change nothing in it. */
#ifndef GN_CLI_IDLE_H
#define GN_CLI_IDLE_H

#include "frame/parts.h"
#include "world/world.h"

/* Prints these effects for `gneiss plan`: only those that are certain from the scene and its first
 * lists. */
void gn_print_idle(const gn_world *world);

#endif
