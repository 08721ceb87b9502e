/* Warnings of parts of a run, for warnings.c. */
#ifndef GN_RUN_WARNINGS_H
#define GN_RUN_WARNINGS_H

#include "run/run.h"

/* Appends a warning; the caller may append to its text. */
gn_warning *gn_warn(gn_warnings *list, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Warnings about the readings. */
gneiss_status gn_warn_of_readings(const gn_run *run, gn_warnings *list, gneiss_error *error);

/* Warnings about servos of walls and sides. */
void gn_warn_of_servos(const gn_run *run, gn_warnings *list);
void gn_warn_of_structure(const gn_run *run, gn_warnings *list);

/* Warnings about a cutting test. */
void gn_warn_of_cut(const gn_run *run, gn_warnings *list);
/* Tells why a finished cutting test measured no force. */
void gn_no_force_text(const gn_run *run, char *text, size_t size);

/* Warnings about a membrane. */
void gn_warn_of_membrane(const gn_run *run, gn_warnings *list);
/* Warnings about zones, elements behind walls, and conversion. */
gneiss_status gn_warn_of_coupling(const gn_run *run, gn_warnings *list, gneiss_error *error);

#endif
