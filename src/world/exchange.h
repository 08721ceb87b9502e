/* The seam between force and motion. Blocks of particles and nodes that an exchange needs wait
 * until all forces of the instant are known; it adds to their loads (gn_hold_load), and they move.
 * All other blocks move as soon as their forces are done. Exchanges act in the order in which they
 * were added; they are not saved with the world: what a scene asks for is added in
 * gn_world_prepare, which resume calls as well. */
#ifndef GN_WORLD_EXCHANGE_H
#define GN_WORLD_EXCHANGE_H

#include "base/error.h"
#include "frame/parts.h"
#include "frame/step_context.h"
#include "measure/energy.h"

#include <stddef.h>

typedef struct gn_exchange {
    void *context; /* the caller's */
    /* Has the blocks wait that `act` will need (gn_hold_particle on world->dem.hold and on the hold
     * of a body of elements): now, and whenever lists were made, when particles may have changed
     * places. */
    gneiss_status (*mark)(void *context, gn_world *world, gneiss_error *error);
    /* Adds to the loads of what waits. Loads are forces of contacts, walls, elements and earlier
     * exchanges; gravity, applied forces and background damping join them in the motion. Velocities
     * are those of the last half step. */
    gneiss_status (*act)(void *context, gn_world *world, gneiss_error *error);
    void (*end)(void *context); /* when the world is freed; NULL: nothing to do */
    /* Once particles and nodes have moved; NULL: nothing to do. */
    gneiss_status (*follow)(void *context, gn_world *world, gneiss_error *error);
    /* Adds to a reading what the parts know nothing of; NULL: nothing to do. */
    void (*book)(void *context, const gn_world *world, gn_energy *reading);
} gn_exchange;

struct gn_features {
    gn_exchange *exchange; /* [count] */
    size_t count;
};

/* On failure the context is still the caller's. Before there are lists nothing is marked yet. */
gneiss_status gn_exchange_add(gn_world *world, gn_exchange exchange, gneiss_error *error);

void gn_exchanges_free(gn_features *features);

gneiss_status gn_exchanges_mark(gn_world *world, gneiss_error *error);
gneiss_status gn_exchanges_act(gn_world *world, gneiss_error *error);
gneiss_status gn_exchanges_follow(gn_world *world, gneiss_error *error);
void gn_exchanges_book(gn_world *world, gn_energy *reading);

#endif
