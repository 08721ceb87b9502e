/* The number of steps from one row of the history to the next. The end of a test is not known in
 * advance, and time.end is only its bound. Rows of a run that can end early are therefore first
 * closer than time.end requires, by a power of two, and every second one is removed when there are
 * twice as many as requested. At its end the run has between one and two times the requested number
 * of rows, and the requested number if it ends at time.end. The rule depends on steps and rows
 * alone. Rows at multiples of `history_interval` are never removed. They are the samples: stop
 * conditions and the limit of the ledger are evaluated at them alone, so that the step at which a
 * run ends does not depend on the rows between them. */
#ifndef GN_RUN_SPACING_H
#define GN_RUN_SPACING_H

#include "run/run.h"

/* Tells whether a condition other than time can end the run, or its present stage. */
bool gn_run_may_end_early(const gn_run *run);

/* Returns the expected number of rows of the history, summed over stages: the requested number for
 * each; for a stage that can end early a quarter more, or the number at an eighth of its time if
 * that is less. */
double gn_run_rows_expected(const gn_world *world);

/* The largest numbers of halvings of an interval. */
enum { GN_ROW_HALVINGS = 5, GN_SNAPSHOT_HALVINGS = 7 };

/* Returns how often `interval` (steps) is halved at first: at most `most` times, and only while at
 * least `least` steps remain. */
int64_t gn_halvings(int64_t interval, int64_t least, int64_t most);

/* Returns the halvings of the interval between rows, in steps. */
int64_t gn_row_halvings(int64_t interval);

/* Sets the spacing of the rows of the scene, or of the stage, that begins with the next row. */
void gn_run_space_rows(gn_run *run, int64_t interval);

/* Tells whether a row is due at the next step by the interval. */
bool gn_run_row_is_due(const gn_run *run);

/* Tells whether the last step of the run has a row although none is due, so that the history
 * includes all particles that entered and left. */
bool gn_run_has_end_row(const gn_run *run);
/* Removes such a row before a step, so that a run that continues gives the same rows as one that
 * did not stop there. */
gneiss_status gn_run_drop_end_row(gn_run *run, gneiss_error *error);

/* Tells whether a row of the history is a sample. */
bool gn_run_is_sample(const gn_run *run, size_t row);
/* Returns the number of samples from row `begin` on, at most `most`. */
size_t gn_run_sample_count(const gn_run *run, size_t begin, size_t most);
/* Returns the row of the `back`-th last sample (1: the last one), which must exist. */
size_t gn_run_sample_row(const gn_run *run, size_t back);

/* Appends stress and strain of a sample to the list of samples. */
gneiss_status gn_run_add_sample(gn_run *run, size_t row, gneiss_error *error);
/* Rebuilds the list of samples after a checkpoint was read. */
gneiss_status gn_run_rebuild_samples(gn_run *run, gneiss_error *error);
void gn_samples_free(gn_samples *samples);

/* Removes every second row, after a row was appended, if there are too many. */
gneiss_status gn_run_thin_rows(gn_run *run, gneiss_error *error);

#endif
