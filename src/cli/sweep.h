/* `gneiss sweep`, and `gneiss run` of a scene with several seeds or confinements. */
#ifndef GN_CLI_SWEEP_H
#define GN_CLI_SWEEP_H

#include "cli/options.h"

gneiss_status gn_command_sweep(const gn_options *options, gneiss_error *error);

/* The scene of `gneiss run` with several seeds or confinements; *wanted: whether it is one. */
gneiss_status gn_command_several(const gn_options *options, bool *wanted, gneiss_error *error);

#endif
