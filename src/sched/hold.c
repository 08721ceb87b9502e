#include "sched/hold.h"

#include "base/new.h"

#include <string.h>

gneiss_status gn_hold_create(gn_hold *hold, size_t blocks, gneiss_error *error) {
    *hold = (gn_hold){.blocks = blocks};
    GN_TRY(gn_new(&hold->slot, blocks + 1, "blocks", error));
    GN_TRY(gn_new(&hold->block, blocks + 1, "blocks", error));
    gn_hold_clear(hold);
    return GNEISS_OK;
}

void gn_hold_free(gn_hold *hold) {
    gn_free(hold->slot);
    gn_free(hold->block);
    gn_free(hold->load);
    *hold = (gn_hold){0};
}

void gn_hold_clear(gn_hold *hold) {
    for (size_t b = 0; b < hold->blocks; b++) hold->slot[b] = -1;
    hold->count = 0;
}

/* Enlarges the storage. Loads are those of one step, so that they need not be copied. */
static gneiss_status make_room(gn_hold *hold, gneiss_error *error) {
    size_t room = 2 * hold->count + 4;
    double *load = NULL;
    GN_TRY(gn_new(&load, room * GN_BLOCK_LOAD, "held blocks", error));
    gn_free(hold->load);
    hold->load = load;
    hold->room = room;
    return GNEISS_OK;
}

gneiss_status gn_hold_particle(gn_hold *hold, size_t particle, gneiss_error *error) {
    size_t block = particle / GN_PARTICLE_BLOCK;
    if (hold->slot[block] >= 0) return GNEISS_OK;
    if (hold->count == hold->room) GN_TRY(make_room(hold, error));
    hold->block[hold->count] = (int32_t)block;
    hold->slot[block] = (int32_t)hold->count++;
    return GNEISS_OK;
}
