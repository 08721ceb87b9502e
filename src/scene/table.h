/* Values over time. */
#ifndef GN_SCENE_TABLE_H
#define GN_SCENE_TABLE_H

#include "scene/place.h"

#include <stddef.h>

/* Values over time, piecewise linear, constant before the first and after the last point. `count` 1
 * is a constant; 0 means that the channel is free (not prescribed). */
typedef struct gn_table {
    size_t count;
    double *time;  /* [count], s, strictly increasing */
    double *value; /* [count] */
    size_t stage; /* number of the stage, from 1, from whose start times count; 0: from the start of
                     the run */
} gn_table;

/* Motion of a set, a wall or a body. Walls use the first three channels only. */
typedef struct gn_motion {
    gn_table velocity[3]; /* m/s */
    gn_table spin[3];     /* rad/s */
} gn_motion;

/* Returns the value of a table at a time; 0 for an empty table. */
double gn_table_at(const gn_table *table, double time);
/* Returns the integral of a table over time. */
double gn_table_between(const gn_table *table, double from, double to);

#endif
