/* Functions of a run that its resume shares. */
#ifndef GN_RUN_RUN_PRIVATE_H
#define GN_RUN_RUN_PRIVATE_H

#include "run/run.h"

/* Sets the intervals of rows and of snapshots, those that are asked for, from the numbers in the
 * scene. `begins`: a run or a stage begins, and rows and snapshots may be closer at first. */
void gn_run_set_intervals(gn_run *run, bool history, bool snapshots, bool begins);

/* Begins to count the time of this session, and that to the next checkpoint. */
void gn_run_set_clock(gn_run *run);

/* Evaluates the stop conditions at the last row. A run that had ended remains ended unless the
 * overrides change that. */
void gn_run_take_up(gn_run *run);

#endif
