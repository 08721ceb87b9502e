/* Pieces that bonds hold together. */
#ifndef GN_SIM_FRAGMENTS_H
#define GN_SIM_FRAGMENTS_H

#include "sim/world.h"

typedef struct gn_fragments {
    double count;   /* of two or more particles; NaN: no bonds */
    double largest; /* share of the particles' volume that the largest has */
} gn_fragments;
/* Once the particles are there. */
gneiss_status gn_pieces_create(gn_world *world, gneiss_error *error);
gn_fragments gn_world_fragments(const gn_world *world);

#endif
