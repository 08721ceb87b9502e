/* Selects the snapshots of a run that are kept. As with rows of the history (run/spacing.h),
 * regular snapshots are first closer than time.end requires and are thinned out while the run
 * advances. In addition one snapshot near the peak of a test is kept, and those nearest to half of
 * the peak before and after it. The peak is known only after it has passed: a candidate is written
 * whenever the stress has grown by a few per cent, and where it begins to fall, and replaces the
 * previous candidate. The selection depends on steps and rows of the history alone. */
#ifndef GN_RUN_KEPT_H
#define GN_RUN_KEPT_H

#include "run/run.h"

typedef enum gn_kept_kind {
    GN_KEPT_PEAK = 1,
    GN_KEPT_HALF = 2,
    GN_KEPT_REGULAR = 4,
    GN_KEPT_BEFORE = 8 /* former candidate for the peak, which may be near half of a higher peak */
} gn_kept_kind;        /* bits of gn_kept.due */

/* Starts the selection for a run or a stage with the spacing of run->snapshot_interval; `closer`:
 * with more snapshots, which are thinned out later. */
void gn_kept_begin(gn_run *run, bool closer);
/* Restores the selection after a checkpoint and its samples were read. */
void gn_kept_resume(gn_run *run);

/* Updates the selection after a row of the history; `sample`: stop conditions are evaluated at the
 * row. */
void gn_kept_row(gn_run *run, bool sample);

/* Tells whether the next step begins with snapshots; `first`: it is the first step of the run or of
 * a stage. Regular snapshots that the thinning would remove at once are left out. */
bool gn_kept_is_due(gn_run *run, bool first);

/* Records the snapshots that were written at the present step, and removes those that they
 * replace. */
gneiss_status gn_kept_note(gn_run *run, gneiss_error *error);

/* Sets the step of the next regular snapshots, after those of this step. */
void gn_kept_plan(gn_run *run);

/* Thins the regular snapshots at the end of the run to the requested number. */
gneiss_status gn_kept_finish(gn_run *run, gneiss_error *error);

void gn_kept_free(gn_kept *kept);

#endif
