#include "accuracy/slopes.h"

#include <math.h>
#include <string.h>

const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter) {
    for (size_t k = 0; k < gn_slope_count; k++) {
        const gn_slope *s = &gn_slopes[k];
        if (strcmp(s->study, study) == 0 && strcmp(s->reading, reading) == 0 &&
            strcmp(s->effect, effect) == 0 && s->scatter == scatter)
            return s;
    }
    return NULL;
}

double gn_slope_at(const gn_slope *s, double group) {
    switch (s->form) {
    case GN_SLOPE_POWER:
        return s->coefficient * pow(group / s->reference, s->exponent);
    case GN_SLOPE_LINEAR:
        return s->coefficient * (group - s->reference);
    case GN_SLOPE_EXPONENTIAL:
        return s->coefficient * exp(-group / s->reference);
    case GN_SLOPE_RATIO:
        return pow(group / s->reference, s->exponent) - 1.0;
    case GN_SLOPE_CONSTANT:
        break;
    }
    return s->coefficient;
}

static double or_none(double x) {
    return isnan(x) ? 0.0 : x;
}

/* Coefficient and exponent of a power were fitted about the reference, where they are independent.
 */
double gn_slope_error_at(const gn_slope *s, double group) {
    double coefficient = or_none(s->coefficient_error), exponent = or_none(s->exponent_error);
    switch (s->form) {
    case GN_SLOPE_POWER:
        return fabs(gn_slope_at(s, group)) *
               hypot(coefficient, exponent * log(group / s->reference));
    case GN_SLOPE_LINEAR:
        return coefficient * fabs(group - s->reference);
    case GN_SLOPE_EXPONENTIAL:
        return coefficient * exp(-group / s->reference);
    case GN_SLOPE_RATIO:
        return (1.0 + gn_slope_at(s, group)) * exponent * fabs(log(group / s->reference));
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
