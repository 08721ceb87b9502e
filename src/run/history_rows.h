/* Rows of the history: the quantities that are read while the world advances. */
#ifndef GN_RUN_HISTORY_ROWS_H
#define GN_RUN_HISTORY_ROWS_H

#include "frame/parts.h"
#include "test_kinds/history.h"
#include "world/world.h"

/* Creates the columns that the scene requires (docs/results.md). */
gneiss_status gn_history_create_columns(const gn_world *world, gn_history *history,
                                        gneiss_error *error);

/* Takes one step and appends the row of the instant at which it starts: positions are read before
 * the step, forces and energies after it. */
gneiss_status gn_history_record_step(gn_world *world, gn_history *history, gneiss_error *error);

/* Takes the last step of a run and reads the ledger at its instant, with a row if there is a
 * history. A run that is continued later does not depend on this row. */
gneiss_status gn_history_record_last_step(gn_world *world, gn_history *history,
                                          gneiss_error *error);

/* Appends the row of a given state of the world, with the energies as last read. */
gneiss_status gn_history_record_state(gn_world *world, gn_history *history, gneiss_error *error);

#endif
