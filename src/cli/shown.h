/* Units of printed readings. */
#ifndef GN_CLI_SHOWN_H
#define GN_CLI_SHOWN_H

#include "run/run.h"

/* Divisor of a reading and the resulting unit. All moduli of a run have the unit of Young's
 * modulus, and all stresses that of the largest stress. */
typedef struct gn_shown {
    double factor;
    const char *unit; /* "" for a plain number */
} gn_shown;
gn_shown gn_shown_unit(const gn_readings *readings, const char *name, const char *unit,
                       double value);

/* Rounds `value` to two digits that %.6g prints without an exponent. */
double gn_two_digits(double value);

#endif
