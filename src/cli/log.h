/* --log json: all that the program prints becomes one JSON object a line on standard output
 * (docs/log.md). Messages remain on standard error as text. */
#ifndef GN_CLI_LOG_H
#define GN_CLI_LOG_H

#include "base/error.h"

#include <stdbool.h>

typedef struct gn_log gn_log;

/* Replaces the streams stdout and stderr from now on; NULL: no memory. `command` is borrowed. */
gn_log *gn_log_begin(const char *command);

/* Writes the last object, with the exit code, and returns to the former streams. Returns false if
 * something could not be written. NULL: no effect. */
bool gn_log_end(gn_log *log, gneiss_status status);

/* Prints a JSON object as one line, {"progress": {...}} or {"result": {...}}; frees `text`. */
void gn_print_object(const char *kind, char *text);

/* Returns the exit codes with their meanings, by number; NULL: there is none. */
const char *gn_exit_code_text(int code);

#endif
