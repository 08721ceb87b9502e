/* What is read off the world while it runs: rows of the history. */
#ifndef GN_RUN_HISTORY_ROWS_H
#define GN_RUN_HISTORY_ROWS_H

#include "frame/parts.h"
#include "test_kinds/history.h"
#include "world/world.h"

/* Creates the columns that the scene has (docs/results.md). */
gneiss_status gn_history_begin(const gn_world *world, gn_history *history, gneiss_error *error);

/* Takes one step and appends the row of the instant at which it starts: positions are read before
 * the step, forces and energies after it. */
gneiss_status gn_history_step(gn_world *world, gn_history *history, gneiss_error *error);

/* Takes the last step of a run and reads the ledger at its instant, with a row if there is a
 * history: nothing of it is in what a run that is prolonged goes on with. */
gneiss_status gn_history_last(gn_world *world, gn_history *history, gneiss_error *error);

/* Appends the row of a state that the world was put in, with the reading as it stands. */
gneiss_status gn_history_still(gn_world *world, gn_history *history, gneiss_error *error);

#endif
