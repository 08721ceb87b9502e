/* Pressures at the nodes of finite elements in the pressure form: the two passes over nodes that
 * follow those over elements. */
#ifndef GN_KERNELS_PRESSURE_H
#define GN_KERNELS_PRESSURE_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"
#include "soa/records.h"

#include <stdbool.h>

typedef struct gn_pressure_args {
    gn_particles *nodes;
    const gn_partials *partials; /* partial sums of nodes, for the elements */
    const double *growth_row;    /* output of the dilation kernel */
    const double *slope_row;     /* output of the element kernel in addition to the partial sums */
    double dt_past, dt; /* s: the interval that led here (0 at the start), the coming one */
    double rate2;       /* 1/s2: squared rate at which the stabilising pressure follows */
    double damping;     /* 1/s, damping coefficient of the stabilising pressure */
    bool book;          /* energies are requested */
} gn_pressure_args;

/* Energies of the pressures, J: stored, and lost by damping of the stabilising one. */
typedef struct gn_pressure_sums {
    double elastic, damping;
} gn_pressure_sums;

/* Process nodes [begin, end) of one block. The first pass computes pressures from growth and
 * stabilising term. The second, after the nodes have moved, integrates the stabilising pressure
 * over the coming interval. Both add to *sums, with `book`. */
typedef void gn_pressure_kernel(const gn_pressure_args *args, size_t begin, size_t end,
                                gn_pressure_sums *sums);

enum { GN_PRESSURE_PASSES = 2 };

#define X(set, lanes, has)                                                                         \
    extern gn_pressure_kernel *const gn_pressure_table_##set[GN_PRESSURE_PASSES];
GN_INSTRUCTION_SETS(X)
#undef X

#endif
