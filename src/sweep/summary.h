/* Summary of a sweep: every reading of every run, and its mean and scatter over seeds. */
#ifndef GN_SWEEP_SUMMARY_H
#define GN_SWEEP_SUMMARY_H

#include "sweep/outcome.h"
#include "sweep/statistics.h"

typedef struct gn_summary_reading {
    char name[GN_NAME_SIZE], unit[GN_NAME_SIZE], text[256];
} gn_summary_reading;

typedef struct gn_summary_run {
    gn_outcome outcome;
    double seconds, dt; /* s; NaN: unknown */
    int64_t steps;
    char state_hash[24], build[64];
} gn_summary_run;

typedef struct gn_summary {
    const gn_sweep *sweep;
    const char *directory; /* borrowed */
    size_t reading_count;
    gn_summary_reading *readings;
    double *value; /* [run_count][reading_count]; NaN: absent, or the run is not completed */
    double
        *rest; /* [run_count][reading_count]; errors that more seeds do not reduce (run/budget.h) */
    gn_summary_run *runs;      /* [run_count] */
    gn_statistics *statistics; /* [combination_count][reading_count] */
    size_t done, failed;       /* over all rows */
    bool several_builds;       /* runs were made by differently compiled programs */
} gn_summary;

/* Reads the folders of all runs. */
gneiss_status gn_summary_make(const gn_sweep *sweep, const char *directory, gn_summary *summary,
                              gneiss_error *error);
/* Returns the largest `rest` of the runs of a combination; NaN: none. */
double gn_summary_rest(const gn_summary *summary, size_t combination, size_t reading);
void gn_summary_free(gn_summary *summary);

/* Writes sweep.csv (a row for every run), sweep-means.csv (for every combination) and sweep.h5. */
gneiss_status gn_summary_write(const gn_summary *summary, gneiss_error *error);

/* Fails with GNEISS_ERROR_INPUT if files of these names are not from a sweep, or if the folder
 * holds the results of a run. */
gneiss_status gn_summary_check_folder(const char *directory, gneiss_error *error);

#endif
