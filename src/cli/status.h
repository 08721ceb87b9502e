/* `gneiss status DIR`: how far the run in a folder is, also after its process has died. */
#ifndef GN_CLI_STATUS_H
#define GN_CLI_STATUS_H

#include "cli/options.h"

gneiss_status gn_command_status(const gn_options *options, gneiss_error *error);

#endif
