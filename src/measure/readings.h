/* Declarations shared by the files of the readings (readings_curves.c). */
#ifndef GN_MEASURE_READINGS_H
#define GN_MEASURE_READINGS_H

#include "measure/measure.h"

/* Rows [first, last) of the history. */
typedef struct gn_row_span {
    size_t first, last;
} gn_row_span;

/* A least-squares line of y over x, and the standard error of the slope. */
typedef struct gn_line_fit {
    double slope, error;
} gn_line_fit;

typedef struct gn_curves {
    const gn_tested *tested;
    const gn_history *history;
    const double *strain, *stress;
    const double *average[3]; /* strain, by axis */
    size_t begin;             /* row at which the test begins (beginning.h) */
    bool never_strained;      /* the strain never grew in the sense of the test */
    size_t largest;           /* row of the largest stress since */
    gn_row_span loading;      /* from 1 to 50 % of the largest stress */
    gn_row_span elastic;      /* the rows of `loading` before bonds break, yield or soften */
    /* the reason why they end before 50 %, e.g. "bonds break"; NULL: they do not */
    const char *cut_reason;
    const double *time; /* s */
    double interval;    /* s between rows of time steps; 0: unknown */
} gn_curves;

/* A slope is a reading if its standard error is below this fraction of it. */
static const double gn_scatter_allowed = 0.1;

/* Makes a reading absent with a reason, unless it has one. */
void gn_reading_absent(gn_readings *readings, gn_reading which, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
char *gn_reason_of(gn_readings *readings, gn_reading which);

/* Fits a line; NaN for fewer than 3 points, or all at the same x. A start at the first failure has
 * few rows where time steps would have had many: straight lines between them count as the missing
 * rows. */
gn_line_fit gn_line(const gn_curves *curves, const double *x, const double *y, gn_row_span span);

/* Returns the number of bonds broken up to a row. */
double gn_breaks_until(const gn_curves *curves, size_t row);

/* Finds the rows to which elastic constants are fitted, within `loading`. */
void gn_find_elastic_rows(gn_curves *curves);

/* Returns the relative difference of the slopes over the first and the second half of the rows from
 * the slope over all of them; 0 for fewer than 6 rows. `slope` is that of a line or a quotient of
 * two. */
typedef double gn_slope_of(const gn_curves *curves, gn_row_span span);
double gn_nonlinearity(const gn_curves *curves, gn_slope_of *slope);

/* Computes the modulus of a specimen with a varying section from a slope: gn_tested.by_ends or
 * .by_mean. */
double gn_modulus_by(double factor, double slope, gn_reading which, gn_readings *readings);

/* Requires enough rows for a slope. */
void gn_need_rows(const gn_curves *curves, gn_reading which, gn_readings *readings);
void gn_need_elastic_rows(const gn_curves *curves, gn_reading which, gn_readings *readings);
/* Requires that over these rows only the stress along the axis grows, and the mean strain is that
 * of the ends. */
void gn_need_axial(const gn_curves *curves, gn_row_span span, gn_reading which,
                   gn_readings *readings);
void gn_need_modulus(gn_line_fit line, gn_reading which, gn_readings *readings);

/* Returns the reason why the largest stress is no strength; NULL: it is one. */
const char *gn_no_peak(const gn_curves *curves);

/* Returns the reason why a column of average strain has no number in a row; NULL: it has one. */
const char *gn_no_average_strain(const double *strain, size_t row);

/* Computes the readings of single test kinds (readings_by_kind.c). */
void gn_readings_by_kind(const gn_curves *curves, gn_readings *readings);

/* Computes the readings of bursts of breaking bonds (readings_bursts.c); these and fragments do not
 * depend on the stress. */
void gn_readings_of_bursts(const gn_tested *tested, gn_readings *readings);
void gn_readings_of_breaks(const gn_tested *tested, gn_readings *readings);

#endif
