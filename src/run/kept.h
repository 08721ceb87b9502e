/* Which snapshots of a run are kept. As rows of the history (run/spacing.h) those at regular
 * intervals are first closer than time.end asks for and are thinned out while the run goes on.
 * Beside them one near the peak of a test is kept, and those nearest to half of it before and
 * after. The peak is not known before it is over: one is written whenever the stress has grown by a
 * few per cent, and where it begins to fall, and takes the place of the one before. All follows
 * from steps and rows of the history alone. */
#ifndef GN_RUN_KEPT_H
#define GN_RUN_KEPT_H

#include "run/run.h"

typedef enum gn_kept_kind {
    GN_KEPT_PEAK = 1,
    GN_KEPT_HALF = 2,
    GN_KEPT_REGULAR = 4,
    GN_KEPT_BEFORE = 8 /* was one of the peak: may be that at half of a higher one */
} gn_kept_kind;        /* bits of gn_kept.due */

/* Begins anew, of the run or of a stage, with those that run->snapshot_interval asks for; `closer`:
 * with more of them, to be thinned out. */
void gn_kept_begin(gn_run *run, bool closer);
/* After a checkpoint was read, and its looks are known. */
void gn_kept_resume(gn_run *run);

/* After a row of the history; `look`: stop conditions are evaluated at it. */
void gn_kept_row(gn_run *run, bool look);

/* Tells whether the step to come begins with snapshots; `first`: of the run or of a stage. Regular
 * ones that the thinning would remove at once are left out. */
bool gn_kept_is_due(gn_run *run, bool first);

/* Snapshots of the present step were written: notes them and removes those whose place they take.
 */
gneiss_status gn_kept_note(gn_run *run, gneiss_error *error);

/* The step of the next regular ones, after those of this step. */
void gn_kept_plan(gn_run *run);

/* At the end: no more regular ones than are wanted are left. */
gneiss_status gn_kept_finish(gn_run *run, gneiss_error *error);

void gn_kept_free(gn_kept *kept);

#endif
