/* What the runs of a sweep say: every reading of every run, and its mean and scatter over seeds. */
#ifndef GN_SWEEP_SUMMARY_H
#define GN_SWEEP_SUMMARY_H

#include "sweep/outcome.h"
#include "sweep/statistics.h"

typedef struct gn_summary_reading {
    char name[GN_NAME_SIZE], unit[GN_NAME_SIZE], text[256];
} gn_summary_reading;

typedef struct gn_summary_run {
    gn_outcome outcome;
    double seconds, dt; /* s; NaN: not known */
    int64_t steps;
    char state_hash[24], build[64];
} gn_summary_run;

typedef struct gn_summary {
    const gn_sweep *sweep;
    const char *directory; /* borrowed */
    size_t reading_count;
    gn_summary_reading *readings;
    double *value;        /* [run_count][reading_count]; NaN: absent, or the run is not done */
    double *rest;         /* the same: errors that no number of seeds takes off (run/budget.h) */
    gn_summary_run *runs; /* [run_count] */
    gn_statistics *statistics; /* [combination_count][reading_count] */
    size_t done, failed;       /* of all rows */
    bool several_builds;       /* runs of programs that were compiled in different ways */
} gn_summary;

/* Reads the folders of all runs. */
gneiss_status gn_summary_make(const gn_sweep *sweep, const char *directory, gn_summary *summary,
                              gneiss_error *error);
/* The largest such error of the runs of a combination; NaN: they have none. */
double gn_summary_rest(const gn_summary *summary, size_t combination, size_t reading);
void gn_summary_free(gn_summary *summary);

/* sweep.csv (a row for every run), sweep-means.csv (for every combination), sweep.h5. */
gneiss_status gn_summary_write(const gn_summary *summary, gneiss_error *error);

/* Files under these names that are not a sweep's: GNEISS_ERROR_INPUT. A folder with results of a
 * run in it is not for a sweep either. */
gneiss_status gn_summary_check_folder(const char *directory, gneiss_error *error);

#endif
