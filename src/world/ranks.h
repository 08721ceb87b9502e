/* A world whose work is shared by ranks (ranks/ranks.h): what the engine hands to the other ranks
 * in a step and between steps. Without ranks none of these functions is called, except the first.
 */
#ifndef GN_WORLD_RANKS_H
#define GN_WORLD_RANKS_H

#include "base/error.h"
#include "frame/parts.h"

/* Refuses, by the place in the scene, what ranks cannot do yet: GNEISS_ERROR_INPUT. Does nothing
 * without ranks. */
gneiss_status gn_world_check_ranks(const gn_step_context *ctx, gneiss_error *error);

/* Finds the items that every rank knows in a step, after lists were made or read. */
gneiss_status gn_world_share_lists(gn_world *world, gneiss_error *error);

/* A step: begin, early blocks, gn_ranks_send_rows, other own blocks, take_rows, own blocks of
 * particles that awaited rows, share_step, which gives the positions that others read and the sums
 * of own blocks to the other ranks. */
void gn_world_begin_exchange(gn_world *world);
void gn_world_take_rows(gn_world *world);
void gn_world_share_step(gn_world *world);

#endif
