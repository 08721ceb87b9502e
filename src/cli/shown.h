/* Units that readings are shown in. */
#ifndef GN_CLI_SHOWN_H
#define GN_CLI_SHOWN_H

#include "run/run.h"

/* What a reading is divided by, and the unit that it is shown in then. All moduli of a run have one
 * unit, that of Young's modulus, and all stresses that of the largest stress. */
typedef struct gn_shown {
    double factor;
    const char *unit; /* "" of a number */
} gn_shown;
gn_shown gn_shown_unit(const gn_readings *readings, const char *name, const char *unit,
                       double value);

/* `value` to two digits without an exponent, for %.6g. */
double gn_two_digits(double value);

#endif
