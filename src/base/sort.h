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

/* Returns the value that would stand at `rank` < count after sorting, and reorders the values. Its
 * cost grows in proportion to their number (Hoare 1961, "find"). */
static inline double gn_ranked_number(double *values, size_t count, size_t rank) {
    size_t low = 0, high = count;
    while (high - low > 1) {
        const double pivot = values[low + (high - low) / 2];
        size_t below = low, at = low;
        for (size_t above = high; at < above;) {
            const double value = values[at];
            if (value < pivot) {
                values[at++] = values[below];
                values[below++] = value;
            } else if (value > pivot) {
                values[at] = values[--above];
                values[above] = value;
            } else {
                at++;
            }
        }
        if (rank < below)
            high = below;
        else if (rank >= at)
            low = at;
        else
            return pivot;
    }
    return values[low];
}

#endif
