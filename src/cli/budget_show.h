/* Output of the error budget at the end of a run. */
#ifndef GN_CLI_BUDGET_SHOW_H
#define GN_CLI_BUDGET_SHOW_H

#include "run/run.h"

/* Prints a line for each reading with a budget; if there is a test but no budget, the reason. */
gneiss_status gn_print_budget(const gn_run *run, gneiss_error *error);

#endif
