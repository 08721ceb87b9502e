/* Partial sums of either precision. */
#ifndef GN_TESTS_PARTIALS_HELP_H
#define GN_TESTS_PARTIALS_HELP_H

#include "kernels/partials.h"

/* Number k of all rows. */
static inline double partial_sum(const gn_partials *q, size_t k) {
    return q->row_f ? (double)q->row_f[k] : q->row[k];
}

/* Returns the numbers of row r, and zeros up to eight. */
static inline void partial_row(const gn_partials *q, size_t r, double row[8]) {
    const size_t width = (size_t)q->width;
    for (size_t a = 0; a < 8; a++) row[a] = a < width ? partial_sum(q, width * r + a) : 0.0;
}

static inline void set_partial_sum(const gn_partials *q, size_t k, double value) {
    if (q->row_f)
        q->row_f[k] = (float)value;
    else
        q->row[k] = value;
}

#endif
