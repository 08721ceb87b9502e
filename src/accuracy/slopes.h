/* Results of the study of accuracy (docs/accuracy.md): errors of readings over dimensionless
 * groups, and some ratios of its tests. The tables are made from validate/accuracy/slopes.csv and
 * base.csv when the program is built. */
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

/* A law of relative errors. A bias has a sign (positive: the reading is too large); a scatter is a
 * standard deviation. Missing numbers are NaN. */
typedef struct gn_slope {
    const char *study; /* case of the study: compression, tension, ... */
    const char *reading, *effect, *group;
    bool scatter;
    gn_slope_form form;
    double coefficient, coefficient_error, exponent, exponent_error, reference;
    double low, high; /* measured range of the group */
} gn_slope;

extern const gn_slope gn_slopes[];
extern const size_t gn_slope_count;

/* A ratio from the tests of the study that turns an estimated quantity into a predicted one. */
typedef struct gn_slope_base {
    const char *study, *quantity;
    double value;
} gn_slope_base;

extern const gn_slope_base gn_slope_bases[];
extern const size_t gn_slope_base_count;

/* Finds a law; NULL: the study has none. */
const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter);
/* The error at a group, and its standard error. */
double gn_slope_at(const gn_slope *slope, double group);
double gn_slope_error_at(const gn_slope *slope, double group);
/* Returns a ratio; NaN: the study has none. */
double gn_slope_base_of(const char *study, const char *quantity);

#endif
