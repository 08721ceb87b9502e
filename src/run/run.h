/* A run: a world with its history, its output folder, its stop conditions and checkpoints. */
#ifndef GN_RUN_RUN_H
#define GN_RUN_RUN_H

#include "base/version.h"
#include "io/snapshot.h"
#include "run/history_rows.h"
#include "static/first_break.h"
#include "test_kinds/beginning.h"
#include "test_kinds/readings.h"

#include <signal.h>

/* Stress (Pa) and strain of the rows at which stop conditions are evaluated (run/spacing.h). */
typedef struct gn_looks {
    size_t count, capacity;
    double *stress, *strain;
} gn_looks;

/* Snapshots of the run, or of its stage, that may be removed again (run/kept.h). */
typedef struct gn_kept_snapshot {
    double step;
    double part;   /* of the interval between those that are wanted up to the end; 0: one of them */
    double stress; /* Pa, at the last row of the history */
    double kind;   /* gn_kept_kind */
} gn_kept_snapshot;
typedef struct gn_kept {
    int64_t halvings; /* of the interval, as of now */
    int64_t base;     /* step of the last one that is wanted up to the end */
    int64_t part;     /* of the next one */
    double peak;      /* largest stress since the test began, Pa */
    int64_t fell;     /* the stress has been below the peak since: 0, 1 */
    int64_t halved;   /* it has been at half of it, 0, 1 */
    int64_t due;      /* kinds (gn_kept_kind) of what the next step is to begin with */
    size_t count, capacity;
    gn_kept_snapshot *list;
    gn_beginning beginning; /* of the test, by the looks */
} gn_kept;

typedef struct gn_run {
    gn_world world;
    gn_history history;
    struct gn_run_read *read; /* what was read off it last (readings.c) */
    char directory[GN_PATH_SIZE];
    int64_t history_interval; /* steps */
    int64_t history_halvings; /* of the interval, as of now (run/spacing.h) */
    int64_t history_begin;    /* row from which on there may be too many */
    gn_looks looks;
    int64_t snapshot_interval; /* steps, 0: none */
    int64_t snapshot_next;     /* step of the next ones */
    double snapshot_span;      /* s, in which as many are wanted as the scene says */
    gn_kept kept;
    double wall_before;     /* s of wall time in earlier sittings */
    double wall_start;      /* gn_now() at the start of this one */
    double cpu_before;      /* s of processors, all threads, in earlier sittings */
    double cpu_start;       /* gn_process_time() at the start of this one */
    double next_checkpoint; /* gn_now() */
    double peak;            /* largest stress since the test began, Pa */
    gn_beginning beginning; /* of the test, by the history so far */
    int64_t bad_since;      /* step since which the ledger has not closed, -1: it does */
    bool finished;
    double expected_end; /* s, of the test, as foretold by its specimen; 0: not known */
    char stop_reason[256];
    gn_snapshot_times snapshot_times; /* of the output folder */
    size_t series_length;             /* of them, those that the series files list */
    int folder_lock;            /* descriptor that keeps other runs out of the folder; 0: none */
    gn_first_break first_break; /* what the run began with; steps 0: it began at rest */
    char note[GNEISS_MESSAGE_SIZE]; /* of gn_run_resume: which checkpoint was damaged; "": none */
} gn_run;

/* How far a run is. */
typedef struct gn_progress {
    int64_t step;
    double time, end;                                           /* s */
    double seconds;                                             /* wall, all sittings */
    double cpu_seconds;                                         /* of all threads, all sittings */
    double particle_steps_per_second, contact_steps_per_second; /* of all sittings */
    double element_steps_per_second;                            /* the same */
    double eta;       /* s, to the end that is expected, or at most to `end` */
    bool eta_at_most; /* a stop condition may end it at any time before */
    double unbalanced, residual;
    int64_t broken;
    double stress, strain;      /* NaN without a test */
    size_t stages, stage_index; /* 0: none; base 0 */
    const char *stage;          /* its name; the run's */
    bool finished;
} gn_progress;

/* A run without an output folder: `directory` is "" and nothing is written while it goes. Takes
 * over the contents of `scene`. On failure nothing is held. */
gneiss_status gn_run_create(gn_scene *scene, gn_run *run, gneiss_error *error);

/* Scene -> world -> output folder. Nothing is written before the world stands. `directory` NULL or
 * "": from the scene. What an earlier run of the same scene file left there is removed; results of
 * another scene are GNEISS_ERROR_INPUT, and unless `force` is given so are files of somebody else
 * where the run's would go. Takes over the contents of `scene`. */
gneiss_status gn_run_start(gn_scene *scene, const char *directory, bool force, gn_run *run,
                           gneiss_error *error);

/* Goes on from the newest checkpoint in `directory` that can be read; everything is in it, the
 * scene and specimen files need not be there. Overrides: time.*, output.*, run.*. The intervals of
 * history and snapshots stay what they were unless overridden. On failure nothing is held. */
gneiss_status gn_run_resume(const char *directory, const gn_override *overrides,
                            size_t override_count, gn_run *run, gneiss_error *error);

/* Goes on from one checkpoint file, without an output folder; overrides as in gn_run_resume. */
gneiss_status gn_run_load(const char *path, const gn_override *overrides, size_t override_count,
                          gn_run *run, gneiss_error *error);

/* With time.start: first_break takes a world at its start to where it begins; else, and of a run
 * that has begun, nothing. What comes next would do it without telling. `watch`, may be NULL: told
 * of the states on the way. */
gneiss_status gn_run_begin(gn_run *run, const gn_first_break_watch *watch, gneiss_error *error);

/* Takes `steps` steps, also past the end and the stop conditions. Outputs that fall due are
 * written; errors as with gn_run_advance. */
gneiss_status gn_run_steps(gn_run *run, int64_t steps, gneiss_error *error);

/* Runs for about `seconds` of wall time or until the run ends. *interrupt != 0 stops it between
 * steps. Outputs that fall due are written. GNEISS_ERROR_UNSTABLE: the state is kept for
 * gn_run_write_failure. */
gneiss_status gn_run_advance(gn_run *run, double seconds, const volatile sig_atomic_t *interrupt,
                             gneiss_error *error);

gn_progress gn_run_progress(const gn_run *run);

/* Writes the last snapshot, a checkpoint, results.h5 and summary.json. */
gneiss_status gn_run_finish(gn_run *run, gneiss_error *error);

/* readings.c. Of the history; with stages of the rows of the last one that has any, strain counted
 * from its start. Then their error budget. Both are found once for a state, belong to the run and
 * hold until it goes on. */
gneiss_status gn_run_readings(const gn_run *run, const gn_readings **readings, gneiss_error *error);
/* Whether it is one of those that the scene has. */
bool gn_run_reads(const gn_run *run, gn_reading which);
struct gn_budget;
gneiss_status gn_run_budget(const gn_run *run, const struct gn_budget **budget,
                            gneiss_error *error);
/* Begins the history of a world, and makes room for what is read off it; and ends both. */
gneiss_status gn_run_watch(gn_run *run, gneiss_error *error);
void gn_run_unwatch(gn_run *run);

/* After GNEISS_ERROR_UNSTABLE: snapshots of the bad state (failed_*.hdf) and results.h5 with the
 * message. The checkpoints on disk are left as they are. */
gneiss_status gn_run_write_failure(gn_run *run, const char *message, gneiss_error *error);

gneiss_status gn_run_checkpoint(gn_run *run, gneiss_error *error);

void gn_run_free(gn_run *run);

/* verdict.c: |residual| of the ledger at the last history row; NaN without the ledger. */
double gn_run_residual(const gn_run *run);
/* After every row. GNEISS_ERROR_UNSTABLE: the residual stays beyond run.residual_limit. */
gneiss_status gn_run_check_ledger(gn_run *run, gneiss_error *error);
/* When all is written. GNEISS_ERROR_UNSTABLE: it ended beyond that limit. */
gneiss_status gn_run_verdict(const gn_run *run, gneiss_error *error);

/* output_flow.c: kg/s, of what a sink has taken, between the rows at which a quarter and three
 * quarters of it had gone; NaN: too few rows. */
double gn_sink_steady_rate(const gn_history *history, const char *sink);

/* What is to be said beside the results, each by a name that scripts can look for. */
typedef struct gn_warning {
    const char *name;
    char text[640]; /* lists are on the stack */
} gn_warning;
enum { GN_WARNINGS_MAX = 48 };
typedef struct gn_warnings {
    size_t count;
    gn_warning warning[GN_WARNINGS_MAX];
} gn_warnings;
gneiss_status gn_run_warnings(const gn_run *run, gn_warnings *list, gneiss_error *error);

/* rescue.c: after an output that could not be written (GNEISS_ERROR_IO or _MEMORY, between steps)
 * tries a checkpoint if `save`, into whatever space is there, and adds to the message which
 * checkpoint stands. Returns `status`. */
gneiss_status gn_run_rescue(gn_run *run, bool save, gneiss_status status, gneiss_error *error);

/* checkpoint.c */
gneiss_status gn_checkpoint_save(const gn_run *run, gneiss_error *error);
/* To any file, under a temporary name first; gn_checkpoint_save uses the run's folder. */
gneiss_status gn_checkpoint_write(const gn_run *run, const char *path, gneiss_error *error);
gneiss_status gn_checkpoint_load(const char *path, const gn_override *overrides,
                                 size_t override_count, gn_run *run, gneiss_error *error);

/* output.c. Snapshots of what particles are part of, `before` in front of their names. */
gneiss_status gn_output_snapshot(const gn_run *run, const char *before, gneiss_error *error);
gneiss_status gn_output_series(gn_run *run, gneiss_error *error);
gneiss_status gn_output_results(const gn_run *run, gneiss_error *error);
gneiss_status gn_output_summary(const gn_run *run, gneiss_error *error);

#endif
