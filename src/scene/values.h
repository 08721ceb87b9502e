/* What the structs of a scene are made of. */
#ifndef GN_SCENE_VALUES_H
#define GN_SCENE_VALUES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_NAME_SIZE = 64, GN_PATH_SIZE = 4096 };

/* Where a value stands in the scene file, for messages raised after parsing. Line 0: not in a file.
 */
typedef struct gn_scene_place {
    int line, column; /* base 1 */
} gn_scene_place;

/* Piecewise linear in time; held constant before the first and after the last point. `count` 1 is a
 * constant, 0 means the channel is free (not prescribed). */
typedef struct gn_table {
    size_t count;
    double *time;  /* [count], s, strictly increasing */
    double *value; /* [count] */
} gn_table;

/* Motion of a set, a wall or a body. Walls use the first three channels only. */
typedef struct gn_motion {
    gn_table velocity[3]; /* m/s */
    gn_table spin[3];     /* rad/s */
} gn_motion;

#endif
