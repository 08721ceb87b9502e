/* Files and folders that are given to the wrong command. */
#ifndef GN_CLI_WRONG_FILE_H
#define GN_CLI_WRONG_FILE_H

#include "cli/options.h"

/* After an input error: where the file or folder is one for another command, the message says so
 * instead, with the command that takes it. */
void gn_name_wrong_file(const gn_options *options, gneiss_error *error);

#endif
