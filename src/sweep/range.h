/* The values of one parameter of a sweep: private to the room. */
#ifndef GN_SWEEP_RANGE_H
#define GN_SWEEP_RANGE_H

#include "sweep/sweep.h"

/* Driven by gn_range_section. */
typedef struct gn_range_def {
    double from, to, mean, deviation; /* in the unit of the key */
    int64_t count;
    gn_spacing spacing;
    const gn_node *of;
} gn_range_def;

/* How a parameter is drawn: as gn_range_def says, or one of a list. */
typedef struct gn_drawing {
    gn_sampling method;
    uint64_t seed;
    size_t dimension, count;
} gn_drawing;

/* Fills parameter->values from what stands at the node; key and `meant` are there. `drawing` is for
 * distributions, its dimension of the next one. What is wrong is kept in reader->problems. */
gneiss_status gn_parameter_read(gn_reader *reader, const gn_node *node, const gn_drawing *drawing,
                                gn_sweep_parameter *parameter);

/* A number as short as it can be read back. */
void gn_number_text(double value, char *text, size_t size);

#endif
