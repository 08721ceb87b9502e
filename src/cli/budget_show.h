/* The error budget at the end of a run. */
#ifndef GN_CLI_BUDGET_SHOW_H
#define GN_CLI_BUDGET_SHOW_H

#include "run/run.h"

/* A line for each reading that has one; why there is none, if there is a test. */
gneiss_status gn_print_budget(const gn_run *run, gneiss_error *error);

#endif
