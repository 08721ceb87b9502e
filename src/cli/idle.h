/* Effects that a scene carries although they change nothing in it. */
#ifndef GN_CLI_IDLE_H
#define GN_CLI_IDLE_H

#include "world/world.h"

/* Prints them, for `gneiss plan`: only what is certain from the scene and its first lists. */
void gn_print_idle(const gn_world *world);

#endif
