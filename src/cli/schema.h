/* JSON Schemas of the files that the program reads, for editors and other programs. */
#ifndef GN_CLI_SCHEMA_H
#define GN_CLI_SCHEMA_H

#include "cli/options.h"

/* Prints the schema of options->target: scene (NULL: this one), pack, sweep or calibrate. */
gneiss_status gn_command_schema(const gn_options *options, gneiss_error *error);

#endif
