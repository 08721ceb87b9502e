/* Commands that are Python programs beside this one. */
#ifndef GN_CLI_SCRIPT_H
#define GN_CLI_SCRIPT_H

#include "cli/options.h"

/* Makes the page of a folder of results; returns only if the script cannot be started. */
gneiss_status gn_command_report(const gn_options *options, gneiss_error *error);

/* Makes a page that shows a run in a browser, or files for ParaView; returns only if the script
 * cannot be started. */
gneiss_status gn_command_view(const gn_options *options, gneiss_error *error);

/* Finds the parameters that meet a file of targets; returns only if the script cannot be started.
 */
gneiss_status gn_command_calibrate(const gn_options *options, gneiss_error *error);

/* Writes particles or a mesh in another format; returns only if the script cannot be started. */
gneiss_status gn_command_convert(const gn_options *options, gneiss_error *error);

/* Prints the JSON Schema of a file of targets; returns only if the script cannot be started. */
gneiss_status gn_calibrate_schema(const gn_options *options, gneiss_error *error);

#endif
