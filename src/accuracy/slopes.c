#include "accuracy/slopes.h"

#include <math.h>
#include <string.h>

const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter) {
    for (size_t k = 0; k < gn_slope_count; k++) {
        const gn_slope *slope = &gn_slopes[k];
        if (strcmp(slope->study, study) == 0 && strcmp(slope->reading, reading) == 0 &&
            strcmp(slope->effect, effect) == 0 && slope->scatter == scatter)
            return slope;
    }
    return NULL;
}

double gn_slope_at(const gn_slope *slope, double group) {
    switch (slope->form) {
    case GN_SLOPE_POWER:
        return slope->coefficient * pow(group / slope->reference, slope->exponent);
    case GN_SLOPE_LINEAR:
        return slope->coefficient * (group - slope->reference);
    case GN_SLOPE_EXPONENTIAL:
        return slope->coefficient * exp(-group / slope->reference);
    case GN_SLOPE_RATIO:
        return pow(group / slope->reference, slope->exponent) - 1.0;
    case GN_SLOPE_CONSTANT:
        break;
    }
    return slope->coefficient;
}

static double or_none(double value) {
    return isnan(value) ? 0.0 : value;
}

/* Coefficient and exponent of a power law were fitted about the reference, where their errors are
 * independent. */
double gn_slope_error_at(const gn_slope *slope, double group) {
    double coefficient = or_none(slope->coefficient_error),
           exponent = or_none(slope->exponent_error);
    switch (slope->form) {
    case GN_SLOPE_POWER:
        return fabs(gn_slope_at(slope, group)) *
               hypot(coefficient, exponent * log(group / slope->reference));
    case GN_SLOPE_LINEAR:
        return coefficient * fabs(group - slope->reference);
    case GN_SLOPE_EXPONENTIAL:
        return coefficient * exp(-group / slope->reference);
    case GN_SLOPE_RATIO:
        return (1.0 + gn_slope_at(slope, group)) * exponent * fabs(log(group / slope->reference));
    case GN_SLOPE_CONSTANT:
        break;
    }
    return coefficient;
}

double gn_slope_base_of(const char *study, const char *quantity) {
    for (size_t k = 0; k < gn_slope_base_count; k++)
        if (strcmp(gn_slope_bases[k].study, study) == 0 &&
            strcmp(gn_slope_bases[k].quantity, quantity) == 0)
            return gn_slope_bases[k].value;
    return NAN;
}
