/* Sorting of plain numbers. */
#ifndef GN_BASE_SORT_H
#define GN_BASE_SORT_H

#include <stddef.h>
#include <stdlib.h>

static inline int gn_by_value(const void *left, const void *right) {
    const double *x = left, *y = right;
    return (*x > *y) - (*x < *y);
}

/* Sorts numbers from the least to the largest. */
static inline void gn_sort_numbers(double *values, size_t count) {
    qsort(values, count, sizeof *values, gn_by_value);
}

#endif
