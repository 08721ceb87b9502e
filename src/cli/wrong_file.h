/* Files and folders that are given to the wrong command. */
#ifndef GN_CLI_WRONG_FILE_H
#define GN_CLI_WRONG_FILE_H

#include "cli/options.h"

/* After an input error: if the file or folder belongs to another command, replaces the message by
 * one that names this command. */
void gn_name_wrong_file(const gn_options *options, gneiss_error *error);

#endif
