/* The command `gneiss stiffness SCENE`: elastic constants of a bonded packing without a time
 * step. */
#ifndef GN_CLI_STIFFNESS_H
#define GN_CLI_STIFFNESS_H

#include "cli/options.h"

/* Prints a table, or with options->one_json one JSON object on standard output. */
gneiss_status gn_command_stiffness(const gn_options *options, gneiss_error *error);

#endif
