/* Pages of the manual and completions of shells, from the tables of commands and options. */
#ifndef GN_CLI_GENERATE_H
#define GN_CLI_GENERATE_H

#include "cli/help.h"
#include "cli/options.h"

/* Prints the page of a command, or of the program (NULL), in the format of man. */
void gn_print_manual(FILE *out, const gn_command *command);

/* Prints the completions for options->target: bash, zsh or fish; or the paths of all keys: keys. */
gneiss_status gn_command_completion(const gn_options *options, gneiss_error *error);

#endif
