/* What the parts of a checkpoint share: arrays of a size that the scene or the file says. */
#ifndef GN_RUN_CHECKPOINT_INTERNAL_H
#define GN_RUN_CHECKPOINT_INTERNAL_H

#include "io/h5_pieces.h"
#include "sim/world.h"

/* A data set in the group `arrays`, and the place of the array. */
typedef struct gn_checkpoint_array {
    const char *name;
    gn_type type;
    size_t rows, components;
    void **data;
} gn_checkpoint_array;

gneiss_status gn_checkpoint_put_arrays(gn_h5 *file, const gn_checkpoint_array *arrays, size_t count,
                                       gneiss_error *error);
/* Allocates them. */
gneiss_status gn_checkpoint_get_arrays(const gn_h5 *file, const gn_checkpoint_array *arrays,
                                       size_t count, gneiss_error *error);

/* checkpoint_flow.c */
gneiss_status gn_checkpoint_put_flow(const gn_world *w, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_flow(gn_world *w, const gn_h5 *file, gneiss_error *error);

/* events.c */
gneiss_status gn_checkpoint_put_events(const gn_world *w, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_events(gn_world *w, const gn_h5 *file, gneiss_error *error);

#endif
