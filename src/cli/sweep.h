/* `gneiss sweep`, and `gneiss run SCENE --seeds N`. */
#ifndef GN_CLI_SWEEP_H
#define GN_CLI_SWEEP_H

#include "cli/options.h"

gneiss_status gn_command_sweep(const gn_options *options, gneiss_error *error);

/* The scene of `gneiss run` with several seeds. */
gneiss_status gn_command_seeds(const gn_options *options, gneiss_error *error);

#endif
