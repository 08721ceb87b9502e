/* Steps from one row of the history to the next. The end of a test is not known before it comes,
 * and time.end is only its bound. So rows of a run that can end before its time are first closer
 * than time.end asks for, by a power of two, and every second one is removed when there are twice
 * as many as are wanted: whenever the run ends, it has as many rows as are wanted to twice as many,
 * and at time.end those that are wanted. The rule depends on steps and rows alone.
 *
 * Rows at multiples of `history_interval` are never removed. They are the looks: stop conditions
 * and the limit of the ledger are evaluated at them alone, so that the step at which a run ends
 * does not depend on the rows between them. */
#ifndef GN_RUN_SPACING_H
#define GN_RUN_SPACING_H

#include "run/run.h"

/* Tells whether a condition that is not a time can end the run, or the stage that it is in. */
bool gn_run_may_end_early(const gn_run *run);

/* Rows of the history that are to be expected: those that are wanted, of the run or of each stage.
 * A quarter more of what can end early, less where it ends, at an eighth of its time, before so
 * many have come. */
double gn_run_rows_expected(const gn_world *world);

/* Halvings of the interval, at most. */
enum { GN_ROW_HALVINGS = 5, GN_SNAPSHOT_HALVINGS = 7 };

/* How often `interval` (steps) is halved to begin with: up to `most` times, so that `least` steps
 * are left. */
int64_t gn_halvings(int64_t interval, int64_t least, int64_t most);

/* Of rows that are `interval` steps apart. */
int64_t gn_row_halvings(int64_t interval);

/* Of the rows of the scene, or of the stage, which begin with the next one. */
void gn_run_space_rows(gn_run *run, int64_t interval);

/* Tells whether the step to come is one of a row by the interval. */
bool gn_run_row_is_due(const gn_run *run);

/* Tells whether the last step of the run has a row although none is due: particles that came and
 * went until then are in it. */
bool gn_run_has_end_row(const gn_run *run);
/* Before a step: a run that goes on after such a row does so without it, as if it had never ended.
 */
gneiss_status gn_run_drop_end_row(gn_run *run, gneiss_error *error);

/* Tells whether a row of the history is a look. */
bool gn_run_is_look(const gn_run *run, size_t row);
/* The number of looks from row `begin` on, at most `most`. */
size_t gn_run_looks(const gn_run *run, size_t begin, size_t most);
/* The row of the `back`-th last look; 1: the last one. There are so many. */
size_t gn_run_look(const gn_run *run, size_t back);

/* Stress and strain of the looks so far, for those who go through all of them. */
gneiss_status gn_run_note_look(gn_run *run, size_t row, gneiss_error *error);
/* After a checkpoint was read. */
gneiss_status gn_run_note_looks(gn_run *run, gneiss_error *error);
void gn_looks_free(gn_looks *looks);

/* After a row: removes every second one where there are too many. */
gneiss_status gn_run_thin_rows(gn_run *run, gneiss_error *error);

#endif
