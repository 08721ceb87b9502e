/* Values over time. */
#ifndef GN_SCENE_TABLE_H
#define GN_SCENE_TABLE_H

#include "scene/place.h"

#include <stddef.h>

struct gn_formula;

/* Values over time, piecewise linear, constant before the first and after the last point. `count` 1
 * is a constant; 0 means that the channel is free (not prescribed). */
typedef struct gn_table {
    size_t count;
    double *time;  /* [count], s, strictly increasing */
    double *value; /* [count] */
    size_t stage; /* number of the stage, from 1, from whose start times count; 0: from the start of
                     the run */
    struct gn_formula *formula; /* gives the values; the points are samples of it. NULL: none */
    double start;               /* s: time at which t of the formula is 0 */
} gn_table;

/* Motion of a set, a wall or a body. Walls use the first three channels only. */
typedef struct gn_motion {
    gn_table velocity[3]; /* m/s */
    gn_table spin[3];     /* rad/s */
} gn_motion;

/* Returns the value of a table at a time; 0 for an empty table. */
double gn_table_at(const gn_table *table, double time);
/* Returns the integral of a table over time: exact for points; of a formula by the three-point rule
 * of Gauss on intervals of a thousandth of the time of the scene. */
double gn_table_between(const gn_table *table, double from, double to);
/* Makes a table constant; it must have a point. */
void gn_table_set_constant(gn_table *table, double value);
/* Shifts the times of a table to a later start, s. */
void gn_table_delay(gn_table *table, double start);

#endif
