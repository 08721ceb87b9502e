/* Statistics over several runs of one kind. */
#ifndef GN_SWEEP_STATISTICS_H
#define GN_SWEEP_STATISTICS_H

#include <stddef.h>

typedef struct gn_statistics {
    size_t count;     /* number of finite values; others are left out */
    double mean;      /* NaN: none */
    double deviation; /* standard deviation of one run, from count - 1; NaN below 2 */
    double interval;  /* half the width of the 95 % interval of the mean; NaN below 2 */
} gn_statistics;

/* Value k is values[k * stride]. */
gn_statistics gn_statistics_of(const double *values, size_t count, size_t stride);

/* Returns the probability that Student's t lies within +- t, for `freedom` degrees of freedom
 * (Abramowitz & Stegun 26.7.3 and 26.7.4). */
double gn_student_within(double t, size_t freedom);

/* Returns the t for which that probability is `within`, in (0, 1). */
double gn_student_quantile(double within, size_t freedom);

#endif
