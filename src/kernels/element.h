/* Linear finite elements: arguments and results of a kernel, and the table of variants. */
#ifndef GN_KERNELS_ELEMENT_H
#define GN_KERNELS_ELEMENT_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"
#include "soa/records.h"

#include <math.h>

/* Per parameter: all bits are set if all elements share its value, else 0 (see gn_uniform). */
typedef struct gn_element_uniform {
    size_t lambda, mu;
} gn_element_uniform;

typedef struct gn_element_args {
    const double *pos; /* node rows [n][4]; pressure form: x y z and the pressure */
    const gn_elements *elements;
    gn_element_uniform uniform;
    /* partial sums of `elements`, in which forces are summed; rows are written. In the pressure
     * form the slope, the integral of tau N_a times the pressure's gradient, is stored in the
     * numbers of a row that forces do not use: force xy, slope xy or force xyz, slope x */
    const gn_partials *partials;
    double *slope_row;   /* pressure form in space: rows of two numbers, ordered as those of
                            `partials`, which receive slope yz */
    const float *travel; /* kernels in single precision: node rows [n][4], displacement */
} gn_element_args;

/* Arguments of the first pass of the pressure form. */
typedef struct gn_dilation_args {
    const double *place;  /* node rows [n][4]: x y z and the stabilising pressure q */
    const double *smooth; /* node rows [n][4]: projected gradient of q xyz */
    const gn_elements *elements;
    const gn_partials *partials; /* partial sums of `elements`, with the numbers of the rows */
    /* rows of two numbers, ordered as those of `partials`, which receive shares of the growth in
     * volume and of the stabilising term (both m3) */
    double *row;
} gn_dilation_args;

/* Sums of measuring variants; they start from GN_ELEMENT_SUMS_ZERO. */
typedef struct gn_element_sums {
    double elastic;   /* J */
    double stress[9]; /* N m: sum of current volume x Cauchy stress */
    double volume;    /* m3, current */
    double least;     /* smallest det F */
    int64_t element;  /* the element with the smallest det F, the first one of equals; -1: none */
} gn_element_sums;

#define GN_ELEMENT_SUMS_ZERO ((gn_element_sums){.least = INFINITY, .element = -1})

/* Processes elements [begin, end) of one block of the partial sums; vectors may extend past `end`
 * into padding. Sets the block's partial sums; measuring variants add to *sums. */
typedef void gn_element_kernel(const gn_element_args *args, size_t begin, size_t end,
                               gn_element_sums *sums);

enum { GN_ELEMENT_VARIANTS = 8 };

/* Returns the number of a variant. Bit 0: tetrahedra in space instead of triangles in plane strain;
 * bit 1: measures; bit 2: pressure form, whose energy is that of the deviator. */
static inline unsigned gn_element_variant(bool space, bool measure, bool pressure) {
    return (space ? 1u : 0u) | (measure ? 2u : 0u) | (pressure ? 4u : 0u);
}

/* Processes elements like gn_element_kernel; for triangles or tetrahedra. */
typedef void gn_dilation_kernel(const gn_dilation_args *args, size_t begin, size_t end);

/* Tables called _mixed have kernels of the displacement form in which forces are in single
 * precision and summed in double. They read `travel` instead of `pos`, and columns ending in _f;
 * they do not change *sums, because energies are computed by the kernels in double. */
#define X(set, lanes, has)                                                                         \
    extern gn_element_kernel *const gn_element_table_##set[GN_ELEMENT_VARIANTS];                   \
    extern gn_element_kernel *const gn_element_table_##set##_mixed[2];                             \
    extern gn_dilation_kernel *const gn_dilation_table_##set[2];
GN_INSTRUCTION_SETS(X)
#undef X

#endif
