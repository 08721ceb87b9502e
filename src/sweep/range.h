/* Values of one parameter of a sweep, private to src/sweep. */
#ifndef GN_SWEEP_RANGE_H
#define GN_SWEEP_RANGE_H

#include "sweep/sweep.h"

/* A range or distribution as written in the file, read by gn_range_section. */
typedef struct gn_range_def {
    double from, to, mean, deviation; /* in the unit of the key */
    int64_t count;
    gn_spacing spacing;
    const gn_node *of;
} gn_range_def;

/* Distribution of a parameter: a gn_range_def, or one of a list. */
typedef struct gn_drawing {
    gn_sampling method;
    uint64_t seed;
    size_t dimension, count;
} gn_drawing;

/* Fills parameter->values from the node; key and `meant` must be set. `drawing` is used for
 * distributions; its dimension is that of the next one. Problems are kept in reader->problems. */
gneiss_status gn_parameter_read(gn_reader *reader, const gn_node *node, const gn_drawing *drawing,
                                gn_sweep_parameter *parameter);

/* Writes the shortest text of a number that reads back to the same value. */
void gn_number_text(double value, char *text, size_t size);

#endif
