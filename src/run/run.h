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
typedef struct gn_samples {
    size_t count, capacity;
    double *stress, *strain;
} gn_samples;

/* Snapshots of the run, or of its stage, that may be removed again (run/kept.h). */
typedef struct gn_kept_snapshot {
    double step;
    double part;   /* time since the last requested snapshot over the requested interval; 0: a
                      requested one */
    double stress; /* Pa, at the last row of the history */
    double kind;   /* gn_kept_kind */
} gn_kept_snapshot;
typedef struct gn_kept {
    int64_t halvings; /* present halvings of the interval */
    int64_t base;     /* step of the last requested snapshot */
    int64_t part;     /* number of the next snapshot among those after the last requested one */
    double peak;      /* largest stress since the test began, Pa */
    int64_t fell;     /* 1: the stress has been below the peak since then, else 0 */
    int64_t halved;   /* 1: the stress has been at half of the peak, else 0 */
    int64_t due;      /* kinds (gn_kept_kind) of the snapshots with which the next step begins */
    size_t count, capacity;
    gn_kept_snapshot *list;
    gn_beginning beginning; /* beginning of the test, by the samples */
} gn_kept;

typedef struct gn_run {
    gn_world world;
    gn_history history;
    struct gn_run_read *read; /* the readings that were computed last (readings.c) */
    char directory[GN_PATH_SIZE];
    int64_t history_interval; /* steps from one sample to the next */
    double history_spacing;   /* s between rows that are never removed, 0: unset */
    int64_t history_end_row; /* 1: the last row is an extra one at the end, not at a regular time */
    int64_t history_halvings; /* present halvings of the interval (run/spacing.h) */
    int64_t history_begin;    /* first row that the thinning may remove */
    gn_samples samples;
    int64_t snapshot_interval; /* number of steps, 0: none */
    int64_t snapshot_next;     /* step of the next snapshots */
    double snapshot_span; /* s, duration over which the scene's number of snapshots is requested */
    gn_kept kept;
    double wall_before;     /* s of wall time in earlier sessions */
    double wall_start;      /* gn_now() at the start of this session */
    double cpu_before;      /* s of processor time of all threads in earlier sessions */
    double cpu_start;       /* gn_process_time() at the start of this session */
    double next_checkpoint; /* gn_now() at which the next checkpoint is due */
    double peak;            /* largest stress since the test began, Pa */
    gn_beginning beginning; /* beginning of the test, by the history so far */
    int64_t bad_since;      /* step since which the ledger has not closed; -1: it closes */
    bool finished;
    bool interrupted;    /* gn_run_advance stopped on a signal, with ranks on that of any rank */
    double expected_end; /* s, end of the test predicted from its specimen; 0: unknown */
    char stop_reason[256];
    gn_snapshot_times snapshot_times; /* times of snapshots of the output folder */
    size_t series_length;             /* number of snapshots that the series files list */
    int folder_lock;            /* descriptor that excludes other runs from the folder; 0: none */
    gn_first_break first_break; /* the initial equilibrium; steps 0: the run began at rest */
    char note[GNEISS_MESSAGE_SIZE]; /* set by gn_run_resume: the damaged checkpoint; "": none */
} gn_run;

/* The progress of a run. */
typedef struct gn_progress {
    int64_t step;
    double time, end;                                           /* s */
    double seconds;                                             /* wall time, all sessions */
    double cpu_seconds;                                         /* of all threads in all sessions */
    double particle_steps_per_second, contact_steps_per_second; /* mean of all sessions */
    double element_steps_per_second;                            /* mean of all sessions */
    double eta;       /* s, remaining time to the expected end, or at most to `end` */
    bool eta_at_most; /* a stop condition may end the run before */
    double unbalanced, residual;
    int64_t broken;
    double stress, strain;      /* NaN without a test */
    size_t stages, stage_index; /* number of stages, 0: none; index of the present one, from 0 */
    const char *stage;          /* name of the stage; the run owns it */
    bool finished;
} gn_progress;

/* Creates a run without an output folder: `directory` is "" and nothing is written while it
 * advances. Takes over the contents of `scene`. After a failure there is nothing to free. */
gneiss_status gn_run_create(gn_scene *scene, gn_run *run, gneiss_error *error);

/* Creates the world of a scene and its output folder. Nothing is written before the world exists.
 * `directory` NULL or "": taken from the scene. Files of an earlier run of the same scene file are
 * removed; results of another scene are GNEISS_ERROR_INPUT, and unless `force` is given so are
 * foreign files where files of the run are to be written. Takes over the contents of `scene`. */
gneiss_status gn_run_start(gn_scene *scene, const char *directory, bool force, gn_run *run,
                           gneiss_error *error);

/* Continues from the newest checkpoint in `directory` that can be read; the scene and specimen
 * files are not needed. Overrides: time.*, output.*, run.*. The intervals of history and snapshots
 * stay the same unless overridden. On failure nothing is held. */
gneiss_status gn_run_resume(const char *directory, const gn_override *overrides,
                            size_t override_count, gn_run *run, gneiss_error *error);

/* Continues from one checkpoint file, without an output folder; overrides as in gn_run_resume. */
gneiss_status gn_run_load(const char *path, const gn_override *overrides, size_t override_count,
                          gn_run *run, gneiss_error *error);

/* With time.start: first_break, advances a world from its start to the state in which the first
 * bond breaks. Does nothing in other cases, and in a run that has begun. Functions that advance the
 * run call it themselves, but without `watch`, which (unless NULL) is called with the states in
 * between. */
gneiss_status gn_run_begin(gn_run *run, const gn_first_break_watch *watch, gneiss_error *error);

/* Takes `steps` steps, also beyond the end and the stop conditions. Outputs that fall due are
 * written; errors as with gn_run_advance. */
gneiss_status gn_run_steps(gn_run *run, int64_t steps, gneiss_error *error);

/* Does the same as gn_run_steps, but stops between steps if *interrupt != 0; *steps is then the
 * number of steps left. */
gneiss_status gn_run_some_steps(gn_run *run, int64_t *steps, const volatile sig_atomic_t *interrupt,
                                gneiss_error *error);

/* Runs for about `seconds` of wall time or until the run ends. *interrupt != 0 stops it between
 * steps. Outputs that fall due are written. GNEISS_ERROR_UNSTABLE: the state is kept for
 * gn_run_write_failure. */
gneiss_status gn_run_advance(gn_run *run, double seconds, const volatile sig_atomic_t *interrupt,
                             gneiss_error *error);

gn_progress gn_run_progress(const gn_run *run);

/* Writes the last snapshot, a checkpoint, results.h5 and summary.json. */
gneiss_status gn_run_finish(gn_run *run, gneiss_error *error);

/* readings.c. Computes the readings of the history; with stages, of the rows of the last stage that
 * has any, with strain counted from its start. Then computes their error budget. Both are computed
 * once for a state, belong to the run and are valid until it advances. */
gneiss_status gn_run_readings(const gn_run *run, const gn_readings **readings, gneiss_error *error);
/* Tells whether the scene has this reading. */
bool gn_run_reads(const gn_run *run, gn_reading which);
struct gn_budget;
gneiss_status gn_run_budget(const gn_run *run, const struct gn_budget **budget,
                            gneiss_error *error);
/* gn_run_begin_history begins the history of a world and allocates the readings; gn_run_end_history
 * frees both. */
gneiss_status gn_run_begin_history(gn_run *run, gneiss_error *error);
void gn_run_end_history(gn_run *run);

/* After GNEISS_ERROR_UNSTABLE: writes snapshots of the failed state (failed_*.hdf) and results.h5
 * with the message. The checkpoints on disk are kept. */
gneiss_status gn_run_write_failure(gn_run *run, const char *message, gneiss_error *error);

gneiss_status gn_run_checkpoint(gn_run *run, gneiss_error *error);

void gn_run_free(gn_run *run);

/* warnings.c: |residual| of the ledger at the last history row; NaN without the ledger. */
double gn_run_residual(const gn_run *run);
/* Called after every row. GNEISS_ERROR_UNSTABLE: the residual stays above run.residual_limit. */
gneiss_status gn_run_check_ledger(gn_run *run, gneiss_error *error);
/* Called after all outputs were written. GNEISS_ERROR_UNSTABLE: the run ended above that limit. */
gneiss_status gn_run_check_final_ledger(const gn_run *run, gneiss_error *error);

/* output_bodies.c: returns the rate of a sink, kg/s, between the rows at which a quarter and three
 * quarters of its mass had passed; NaN: too few rows. */
double gn_sink_steady_rate(const gn_history *history, const char *sink);

/* Warnings about the validity of the results, each under a name that scripts can look for. */
typedef struct gn_warning {
    const char *name;
    char text[640]; /* short enough for lists on the stack */
} gn_warning;
enum { GN_WARNINGS_MAX = 54 };
typedef struct gn_warnings {
    size_t count;
    gn_warning warning[GN_WARNINGS_MAX];
} gn_warnings;
gneiss_status gn_run_warnings(const gn_run *run, gn_warnings *list, gneiss_error *error);

/* rescue.c: after an output that could not be written (GNEISS_ERROR_IO or _MEMORY, between steps),
 * tries to write a checkpoint if `save`, and adds to the message which checkpoint remains. Returns
 * `status`. */
gneiss_status gn_run_rescue(gn_run *run, bool save, gneiss_status status, gneiss_error *error);

/* checkpoint.c */
gneiss_status gn_checkpoint_save(const gn_run *run, gneiss_error *error);
/* Writes to any file, under a temporary name first; gn_checkpoint_save writes into the run's
 * folder. */
gneiss_status gn_checkpoint_write(const gn_run *run, const char *path, gneiss_error *error);
gneiss_status gn_checkpoint_load(const char *path, const gn_override *overrides,
                                 size_t override_count, gn_run *run, gneiss_error *error);

/* output.c. Writes snapshots of the particles and of everything that refers to them; `before` is
 * the prefix of their names. */
gneiss_status gn_output_snapshot(const gn_run *run, const char *before, gneiss_error *error);
gneiss_status gn_output_series(gn_run *run, gneiss_error *error);
gneiss_status gn_output_results(const gn_run *run, gneiss_error *error);
gneiss_status gn_output_summary(const gn_run *run, gneiss_error *error);

#endif
