/* Helpers that the parts of a checkpoint share: arrays of a size that the scene or the file
 * gives. */
#ifndef GN_RUN_CHECKPOINT_INTERNAL_H
#define GN_RUN_CHECKPOINT_INTERNAL_H

#include "frame/parts.h"
#include "io/h5.h"
#include "io/h5_pieces.h"
#include "soa/field.h"
#include "world/world.h"

#include <stddef.h>

/* One data set of the group `arrays`, and the array that it fills. The array may also consist of
 * members of structs, the same ones in each struct of an array of structs; the entry with `offset`
 * 0 comes first. */
typedef struct gn_checkpoint_array {
    const char *name;
    gn_type type;
    size_t rows, components;
    void **data;
    size_t size,
        offset; /* size of a struct and offset of the members in it, bytes; 0: no structs */
} gn_checkpoint_array;

/* A whole array of numbers at *data. */
#define GN_CHECKPOINT_ARRAY(NAME, TYPE, ROWS, COMPONENTS, DATA)                                    \
    ((gn_checkpoint_array){NAME, TYPE, ROWS, COMPONENTS, (void **)(DATA), 0, 0})
/* Members of one type, beginning with `first`, in the structs at *data. */
#define GN_CHECKPOINT_MEMBERS(NAME, TYPE, ROWS, COMPONENTS, DATA, STRUCT, first)                   \
    ((gn_checkpoint_array){NAME, TYPE, ROWS, COMPONENTS, (void **)(DATA), sizeof(STRUCT),          \
                           offsetof(STRUCT, first)})

gneiss_status gn_checkpoint_put_arrays(gn_h5 *file, const gn_checkpoint_array *arrays, size_t count,
                                       gneiss_error *error);
/* Allocates and reads the arrays. */
gneiss_status gn_checkpoint_get_arrays(const gn_h5 *file, const gn_checkpoint_array *arrays,
                                       size_t count, gneiss_error *error);

/* checkpoint_flow.c */
gneiss_status gn_checkpoint_put_flow(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_flow(gn_world *world, const gn_h5 *file, const char *path,
                                     gneiss_error *error);

/* checkpoint_joints.c; read after the contacts of particles */
gneiss_status gn_checkpoint_put_joints(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_joints(gn_world *world, const gn_h5 *file, const char *path,
                                       gneiss_error *error);

/* events.c */
gneiss_status gn_checkpoint_put_events(const gn_world *world, gn_h5 *file, gneiss_error *error);
gneiss_status gn_checkpoint_get_events(gn_world *world, const gn_h5 *file, const char *path,
                                       gneiss_error *error);

/* checkpoint_ranges.c: checks that the values of a record that index, count or bound something are
 * within their ranges, and that ids below `most` occur once. GNEISS_ERROR_INPUT names the data
 * set. */
gneiss_status gn_checkpoint_check_record(const char *group, const gn_record *record,
                                         const void *soa, const char *path, gneiss_error *error);
gneiss_status gn_checkpoint_check_numbers(const char *group, const int32_t *number, size_t count,
                                          size_t most, const char *path, gneiss_error *error);

#endif
