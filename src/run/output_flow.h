/* Sources, sinks and lost particles in files. */
#ifndef GN_RUN_OUTPUT_FLOW_H
#define GN_RUN_OUTPUT_FLOW_H

#include "io/files.h"
#include "io/h5.h"
#include "run/run.h"

/* Writes lost/<field> of results.h5 if particles left the domain. */
gneiss_status gn_output_lost(const gn_world *world, gn_h5 *file, gneiss_error *error);
/* Writes the objects `sources` and `sinks` of summary.json. */
void gn_output_flow(const gn_run *run, gn_json *json);

#endif
