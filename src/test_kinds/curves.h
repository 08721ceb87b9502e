/* Readings from curves: functions that the files of this folder share and that the kinds of tests
 * use (readings_curves.c). */
#ifndef GN_TEST_KINDS_CURVES_H
#define GN_TEST_KINDS_CURVES_H

#include "test_kinds/readings.h"

/* A set of readings, for a descriptor. */
#define GN_READS(name) ((gn_reading_set)1 << GN_READING_##name)
#define GN_READS_PEAK                                                                              \
    (GN_READS(peak_stress) | GN_READS(peak_strain) | GN_READS(largest_stress) |                    \
     GN_READS(largest_strain))
/* Sets of readings: of every test, of a test with two ends, of a prism, of a prism that is loaded
 * along its axis alone. */
#define GN_READS_TEST                                                                              \
    (GN_READS_PEAK | GN_READS(elastic_stress) | GN_READS(events) | GN_READS(b_value) |             \
     GN_READS(fragments) | GN_READS(largest_fragment))
#define GN_READS_LOADED (GN_READS_TEST | GN_READS(end_imbalance))
#define GN_READS_PRISM                                                                             \
    (GN_READS(young_modulus) | GN_READS(young_modulus_average) | GN_READS(poisson_ratio) |         \
     GN_READS(plane_young_modulus) | GN_READS(plane_poisson_ratio))
#define GN_READS_AXIAL                                                                             \
    (GN_READS_LOADED | GN_READS_PRISM | GN_READS(secant_modulus) | GN_READS(tangent_modulus) |     \
     GN_READS(average_modulus) | GN_READS(secant_poisson_ratio) |                                  \
     GN_READS(crack_initiation_stress) | GN_READS(brittleness))

#define GN_FIGURES_ELASTIC                                                                         \
    {GN_READING_young_modulus, "Young's modulus"}, {                                               \
        GN_READING_poisson_ratio, "Poisson's ratio"                                                \
    }
#define GN_FIGURES_PEAK                                                                            \
    {GN_READING_peak_stress, "peak stress"}, {                                                     \
        GN_READING_peak_strain, "strain at the peak"                                               \
    }

/* Rows [first, last) of the history. */
typedef struct gn_row_span {
    size_t first, last;
} gn_row_span;

/* A line of y over x by least squares, and the standard error of its slope. */
typedef struct gn_line_fit {
    double slope, error;
} gn_line_fit;

typedef struct gn_curves {
    const gn_tested *tested;
    const gn_history *history;
    const double *strain, *stress;
    const double *average[3]; /* average strain along each axis */
    size_t begin;             /* row with which the test begins (beginning.h) */
    bool never_strained;      /* the strain never grew in the sense of the test */
    size_t largest;           /* row of the largest stress since */
    gn_row_span loading;      /* rows from 1 to 50 % of the largest stress */
    gn_row_span elastic;      /* those rows of `loading` before bonds break, yield or soften */
    const char
        *cut_reason; /* why these rows end before 50 %, such as "bonds break"; NULL: they do not */
    const double *time; /* s */
    double interval;    /* s, interval between rows of time steps; 0: unknown */
} gn_curves;

/* Largest ratio of a slope's standard error to the slope with which it is a reading. */
static const double gn_scatter_allowed = 0.1;

/* Record the reason for the absence of a reading; the first one that applies is reported. */
void gn_reading_absent(gn_readings *readings, gn_reading which, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
char *gn_reason_of(gn_readings *readings, gn_reading which);

/* Fits a line; NaN for fewer than 3 points, or if all have the same x. With a start at the first
 * break there are few rows where time steps would have given many; straight lines between them
 * replace the missing rows. */
gn_line_fit gn_line(const gn_curves *curves, const double *x, const double *y, gn_row_span span);

/* Returns the number of bonds and contacts across joints that have broken up to a row. */
double gn_breaks_until(const gn_curves *curves, size_t row);

/* Finds the rows from which elastic constants are fitted, among those of `loading`. */
void gn_find_elastic_rows(gn_curves *curves);

/* Returns the relative difference of the slopes over the first and the second half of the rows from
 * the slope over all of them; 0 for fewer than 6 rows. `slope`: computes a slope, or a quotient of
 * two. */
typedef double gn_slope_of(const gn_curves *curves, gn_row_span span);
double gn_nonlinearity(const gn_curves *curves, gn_slope_of *slope);

/* Returns the modulus of a specimen whose section varies from a slope; `factor`: gn_tested.by_ends
 * or .by_mean. */
double gn_modulus_by(double factor, double slope, gn_reading which, gn_readings *readings);

/* Conditions for a slope to be a reading; if one is not met, the reading becomes absent. */
void gn_need_elastic_rows(const gn_curves *curves, gn_reading which, gn_readings *readings);
/* Over these rows only the stress along the axis may grow, and the mean strain must equal that of
 * the ends. */
void gn_need_axial(const gn_curves *curves, gn_row_span span, gn_reading which,
                   gn_readings *readings);
void gn_need_modulus(gn_line_fit fit, gn_reading which, gn_readings *readings);

/* Returns the reason why the largest stress is no strength; NULL: it is one. */
const char *gn_no_peak(const gn_curves *curves);

/* Returns the reason why a column of average strain has no number in a row; NULL: it has one. */
const char *gn_no_average_strain(const double *strain, size_t row);

/* For the functions `read` of descriptors (curves_loading.c): read a column at the peak, and a
 * component of the average strain at the peak. NULL: there is no such column. */
void gn_read_at_peak(const gn_curves *curves, gn_reading which, const double *column, double factor,
                     double *value, gn_readings *readings);
void gn_read_strain_at_peak(const gn_curves *curves, gn_reading which, const char *name,
                            double *value, gn_readings *readings);
/* Reads the slope of stress over strain in the elastic rows. */
void gn_read_slope(const gn_curves *curves, gn_reading which, double *value, gn_readings *readings);
/* An angle of friction follows from one test only if the specimen has no cohesion, that is neither
 * bonds nor contacts that attract each other. */
void gn_need_no_cohesion(const gn_curves *curves, gn_readings *readings);
void gn_read_fracture_energy(const gn_curves *curves, gn_readings *readings);
/* Returns the column of a tensor's component along an axis; NULL: there is none. */
const double *gn_curves_tensor(const gn_curves *curves, const char *name, int axis);

/* Computes the readings of any loading along an axis. */
void gn_readings_of_loading(const gn_curves *curves, gn_readings *readings);

/* gn_readings_of_bursts computes the readings of bursts of breaking bonds (readings_bursts.c);
 * gn_readings_of_breaks calls it and adds the readings of fragments. */
void gn_readings_of_bursts(const gn_tested *tested, gn_readings *readings);
void gn_readings_of_breaks(const gn_tested *tested, gn_readings *readings);

#endif
