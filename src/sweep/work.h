/* The runs of a sweep, side by side on the processors there are. */
#ifndef GN_SWEEP_WORK_H
#define GN_SWEEP_WORK_H

#include "sweep/outcome.h"

#include <signal.h>

/* How far a sweep, or its shard, is. Runs that are the same count once. */
typedef struct gn_sweep_progress {
    size_t total, done, failed, running;
    size_t found;              /* of those done or failed: by an earlier sweep */
    double seconds;            /* since the start */
    double eta;                /* s; NaN: not known */
    size_t last;               /* run that this is about */
    const char *what;          /* "started", "resumed", "done", "failed", "killed", "lost" (it is
                                  computed again); NULL: time has passed */
    const gn_outcome *outcome; /* of "done", "failed", "killed" and "lost" */
} gn_sweep_progress;

typedef void gn_sweep_watch(void *context, const gn_sweep_progress *progress);

typedef struct gn_sweep_way {
    const char *directory;
    const char *program;   /* path of gneiss */
    int threads;           /* processors to use; 0: all */
    int jobs;              /* runs at a time; 0: as many as processors */
    size_t shard, shards;  /* this one of so many, base 0; shards 0: the whole */
    bool force;            /* compute everything anew */
    bool allow_gmsh;       /* every run may let gmsh mesh a geometry */
    gn_sweep_watch *watch; /* may be NULL */
    void *context;
    const volatile sig_atomic_t *interrupted;
} gn_sweep_way;

/* How many runs of the shard are where; `outcome` [run_count] is filled for all runs of the sweep.
 */
gneiss_status gn_sweep_look(const gn_sweep *sweep, const char *directory, gn_outcome *outcome,
                            gneiss_error *error);

/* Whether a run is the shard's: runs that are the same belong to one. */
bool gn_sweep_mine(const gn_sweep *sweep, const gn_sweep_way *way, size_t run);

/* Runs what is not done yet, each with `gneiss run` or `resume` in its folder. Runs that fail are
 * no failure of the sweep. GNEISS_INTERRUPTED: children have written their checkpoints; calling
 * again goes on. The folder is there, and locked by the caller. */
gneiss_status gn_sweep_work(const gn_sweep *sweep, const gn_sweep_way *way, gneiss_error *error);

#endif
