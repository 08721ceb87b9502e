/* Warnings of parts of a run, for verdict.c. */
#ifndef GN_RUN_VERDICT_H
#define GN_RUN_VERDICT_H

#include "run/run.h"

/* One more, whose text is to be filled in. */
gn_warning *gn_warnings_add(gn_warnings *list, const char *name);

/* Of what was read off the history (verdict_readings.c). */
gneiss_status gn_warn_of_readings(const gn_run *run, gn_warnings *list, gneiss_error *error);

/* Of servos of walls and sides (verdict_servos.c). */
void gn_warn_of_servos(const gn_run *run, gn_warnings *list);

/* Of a membrane (verdict_membrane.c). */
void gn_warn_of_membrane(const gn_run *run, gn_warnings *list);
/* Of zones, walls that elements pass and conversion (verdict_couple.c). */
gneiss_status gn_warn_of_coupling(const gn_run *run, gn_warnings *list, gneiss_error *error);

#endif
