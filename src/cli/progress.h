/* What a run says while it goes and when it is over. */
#ifndef GN_CLI_PROGRESS_H
#define GN_CLI_PROGRESS_H

#include "cli/options.h"
#include "run/run.h"

/* Before the first step: when a test is foretold to end, by which the ETA is counted. */
gneiss_status gn_expect_end(const gn_options *options, gn_run *run, gneiss_error *error);

/* One line, rewritten in place on a terminal and as wide as that, one line a call elsewhere. */
void gn_print_progress(const gn_options *options, const gn_run *run);

/* What follows on a terminal stands below the line. */
void gn_leave_progress(const gn_options *options);

/* The step and its limits, at the start; whatever the options, particles on the wrong side of walls
 * and bodies. */
gneiss_status gn_print_start(const gn_options *options, const gn_run *run, gneiss_error *error);

/* With time.start: first_break finds where the steps begin, and says what it finds. */
gneiss_status gn_print_beginning(const gn_options *options, gn_run *run, gneiss_error *error);
void gn_print_first_break(const gn_world *world, const gn_first_break *first_break);

/* Readings and counts, also when quiet, and the profile. */
gneiss_status gn_print_summary(const gn_options *options, const gn_run *run, gneiss_error *error);

/* On standard error, also when quiet. */
gneiss_status gn_print_warnings(const gn_run *run, gneiss_error *error);

/* What a scene may not mean as it says it; on standard error, also when quiet. */
void gn_print_notes(const gn_scene_notes *notes);

/* "2 h 03 min", "12.4 s" into text. */
const char *gn_format_seconds(double seconds, char *text, size_t size);

/* 1234567 -> "1.23 M" */
const char *gn_format_count(double value, char *text, size_t size);

#endif
