/* Output of a run during its steps and at its end. */
#ifndef GN_CLI_PROGRESS_H
#define GN_CLI_PROGRESS_H

#include "cli/options.h"
#include "run/run.h"

/* Predicts before the first step when a test ends, for the remaining time in the progress line. */
gneiss_status gn_predict_end(const gn_options *options, gn_run *run, gneiss_error *error);

/* Prints one line, rewritten in place on a terminal and as wide as it, otherwise one line per call.
 */
void gn_print_progress(const gn_options *options, const gn_run *run);

/* Moves to the line below the progress line of a terminal. */
void gn_end_progress_line(const gn_options *options);

/* Prints the step and its limits at the start. Also with --quiet, warns of particles on the wrong
 * side of walls and bodies. */
gneiss_status gn_print_start(const gn_options *options, const gn_run *run, gneiss_error *error);

/* With time.start: first_break, finds the initial equilibrium and prints it. */
gneiss_status gn_print_initial_state(const gn_options *options, gn_run *run, gneiss_error *error);
void gn_print_first_break(const gn_world *world, const gn_first_break *first_break);

/* Prints readings and counts, also when quiet, and the profile. */
gneiss_status gn_print_summary(const gn_options *options, const gn_run *run, gneiss_error *error);

/* Returns the names of the readings that a plan can concern, the best first, NULL at the end. */
const char *const *gn_planned_names(const char *reading);

/* Prints whether the error of a reading (a fraction) is at most the requested one; `reason` says
 * why the error is not known. `name` NULL and `reason` "": no reading has an error. */
void gn_print_reached(const gn_options *options, const char *name, double error,
                      const char *reason);

/* Prints warnings on standard error, also when quiet. */
gneiss_status gn_print_warnings(const gn_run *run, gneiss_error *error);

/* Prints the notes on a scene on standard error, also when quiet. */
void gn_print_notes(const gn_scene_notes *notes);

/* Writes "2 h 03 min", "12.4 s" into text. */
const char *gn_format_seconds(double seconds, char *text, size_t size);

/* Writes 1234567 as "1.23 M". */
const char *gn_format_count(double value, char *text, size_t size);

/* Divisor of a printed reading and the resulting unit. All moduli of a run are printed in the unit
 * of Young's modulus, and all stresses in that of the largest stress. */
typedef struct gn_shown {
    double factor;
    const char *unit; /* "" for a plain number */
} gn_shown;

/* Rounds `value` to two digits so that %.6g prints it without an exponent. */
double gn_two_digits(double value);

#endif
