/* Summary of a sweep: every reading of every run, and its mean and scatter over seeds. */
#ifndef GN_SWEEP_SUMMARY_H
#define GN_SWEEP_SUMMARY_H

#include "sweep/sweep.h"

#include <stddef.h>

typedef enum gn_run_state {
    GN_RUN_NEW,         /* nothing usable */
    GN_RUN_INTERRUPTED, /* there is a checkpoint from which to resume */
    GN_RUN_DONE,
    GN_RUN_FAILED
} gn_run_state;
const char *gn_run_state_name(gn_run_state state);

enum { GN_OUTCOME_MESSAGE = 600 };
typedef struct gn_outcome {
    gn_run_state state;
    bool lost;     /* the results are damaged, or those of another run */
    bool replaced; /* the results are intact, but not those with which the run ended: they and the
                      checkpoints in its folder come from other computations */
    int code;      /* exit code of the run; 128 + n: signal n ended it */
    char message[GN_OUTCOME_MESSAGE]; /* reason of a failure; in a summary also warnings of a
                                         completed run */
} gn_outcome;

/* Writes DIRECTORY/<hash, 16 hex digits>; returns false if it is too long. */
bool gn_run_folder(const char *directory, uint64_t hash, char folder[GN_PATH_SIZE]);

/* Reads the outcome from outcome.json, else from the files of the run. An unreadable outcome.json
 * counts as missing. So does that of a completed run whose results are missing, damaged, of another
 * run, or not those with which it ended; `lost` and the message state this. Checkpoints of another
 * run do not count. */
gneiss_status gn_outcome_read(const char *folder, gn_outcome *outcome, gneiss_error *error);
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *outcome, gneiss_error *error);

/* Renames checkpoints of another run in the folder, as damaged ones are renamed. */
gneiss_status gn_outcome_rename_foreign(const char *folder, gneiss_error *error);

/* Removes outcome.json, and unreadable results. */
void gn_outcome_remove(const char *folder, bool lost);

/* True if the run would end in the same way again, because it became invalid. The next sweep
 * repeats runs that failed for lack of memory or disk space, or that a signal ended. */
bool gn_outcome_is_final(const gn_outcome *outcome);

/* Mean, scatter and confidence of a reading over runs. */
typedef struct gn_statistics {
    size_t count;     /* number of finite values; others are ignored */
    double mean;      /* NaN: there are no values */
    double deviation; /* standard deviation of one run, with count - 1; NaN below 2 */
    double interval;  /* half the width of the 95 % interval of the mean; NaN below 2 */
} gn_statistics;

/* Computes the statistics of values[k * stride]. */
gn_statistics gn_statistics_of(const double *values, size_t count, size_t stride);

/* Returns the t for which Student's t lies within +- t with the probability `within`, in (0, 1). */
double gn_student_quantile(double within, size_t freedom);

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
        *rest; /* [run_count][reading_count] errors that more seeds do not reduce (run/budget.h) */
    gn_summary_run *runs;      /* [run_count] */
    gn_statistics *statistics; /* [combination_count][reading_count] */
    size_t done, failed;       /* counts over all rows */
    bool several_builds;       /* runs were made by differently compiled programs */
} gn_summary;

/* Reads the folders of all runs. */
gneiss_status gn_summary_make(const gn_sweep *sweep, const char *directory, gn_summary *summary,
                              gneiss_error *error);
/* Returns the largest `rest` of the runs of a combination; NaN: there is none. */
double gn_summary_rest(const gn_summary *summary, size_t combination, size_t reading);
void gn_summary_free(gn_summary *summary);

/* Writes sweep.csv (a row for every run), sweep-means.csv (for every combination) and sweep.h5. */
gneiss_status gn_summary_write(const gn_summary *summary, gneiss_error *error);

/* Fails with GNEISS_ERROR_INPUT if files of these names are not from a sweep, or if the folder
 * holds the results of a run. */
gneiss_status gn_summary_check_folder(const char *directory, gneiss_error *error);

#endif
