/* What the study of accuracy measured (docs/accuracy.md): errors of readings over dimensionless
 * groups, and a few ratios of its own tests. The tables are made from validate/accuracy/slopes.csv
 * and base.csv when the program is built. */
#ifndef GN_ACCURACY_SLOPES_H
#define GN_ACCURACY_SLOPES_H

#include <stdbool.h>
#include <stddef.h>

typedef enum gn_slope_form {
    GN_SLOPE_POWER,       /* coefficient (group/reference)^exponent */
    GN_SLOPE_LINEAR,      /* coefficient (group - reference) */
    GN_SLOPE_EXPONENTIAL, /* coefficient exp(-group/reference) */
    GN_SLOPE_RATIO,       /* (group/reference)^exponent - 1 */
    GN_SLOPE_CONSTANT     /* coefficient */
} gn_slope_form;

/* A law of relative errors. Of a bias the sign says which way (positive: read too large); a scatter
 * is a standard deviation. Numbers that it does not have are NaN. */
typedef struct gn_slope {
    const char *study; /* the case of the study: compression, tension, ... */
    const char *reading, *effect, *group;
    bool scatter;
    gn_slope_form form;
    double coefficient, coefficient_error, exponent, exponent_error, reference;
    double low, high; /* the group's range that was measured */
} gn_slope;

extern const gn_slope gn_slopes[];
extern const size_t gn_slope_count;

/* A number of the tests of the study that says how a foretold quantity becomes a found one. */
typedef struct gn_slope_base {
    const char *study, *quantity;
    double value;
} gn_slope_base;

extern const gn_slope_base gn_slope_bases[];
extern const size_t gn_slope_base_count;

/* NULL: the study has no such law. */
const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter);
/* The error at a group, and the standard error of that. */
double gn_slope_at(const gn_slope *slope, double group);
double gn_slope_error_at(const gn_slope *slope, double group);
/* NaN: the study has none. */
double gn_slope_base_of(const char *study, const char *quantity);

#endif
