/* `gneiss sweep`, and `gneiss run` of a scene with several seeds or confinements. */
#ifndef GN_CLI_SWEEP_H
#define GN_CLI_SWEEP_H

#include "cli/options.h"

gneiss_status gn_command_sweep(const gn_options *options, gneiss_error *error);

/* Runs the scene of `gneiss run` if it has several seeds or confinements; *wanted: it has them. */
gneiss_status gn_command_several(const gn_options *options, bool *wanted, gneiss_error *error);

#endif
