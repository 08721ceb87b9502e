/* Execution of the runs of a sweep side by side on the available processors. */
#ifndef GN_SWEEP_WORK_H
#define GN_SWEEP_WORK_H

#include "sweep/summary.h"

#include <signal.h>

/* Progress of a sweep or its shard. Equal runs count once. */
typedef struct gn_sweep_progress {
    size_t total, done, failed, running;
    size_t found;     /* number of runs completed, or failed, in an earlier sweep */
    double seconds;   /* time since the start */
    double eta;       /* s; NaN: unknown */
    size_t last;      /* run of this event */
    const char *what; /* "started", "resumed", "done", "failed", "killed", "lost" (to be computed
                         again); NULL: no event, only the time has changed */
    const gn_outcome *outcome; /* for "done", "failed", "killed" and "lost" */
} gn_sweep_progress;

typedef void gn_sweep_watch(void *context, const gn_sweep_progress *progress);

typedef struct gn_sweep_way {
    const char *directory;
    const char *program; /* path of gneiss */
    int threads;         /* number of processors to use; 0: all */
    int jobs;            /* number of runs at a time; 0: one for each processor */
    size_t shard,
        shards; /* index of this shard, from 0, and number of shards; shards 0: there are none */
    bool force; /* computes all runs again */
    bool allow_gmsh;       /* every run may mesh a geometry with gmsh */
    gn_sweep_watch *watch; /* may be NULL */
    void *context;
    const volatile sig_atomic_t *interrupted;
} gn_sweep_way;

/* True if a run belongs to the shard; equal runs belong to the same shard. */
bool gn_sweep_run_in_shard(const gn_sweep *sweep, const gn_sweep_way *way, size_t run);

/* Runs the incomplete runs, each with `gneiss run` or `resume` in its folder. Failed runs are not a
 * failure of the sweep. GNEISS_INTERRUPTED: children have written their checkpoints, and another
 * call continues. The folder must exist and be locked by the caller. */
gneiss_status gn_sweep_work(const gn_sweep *sweep, const gn_sweep_way *way, gneiss_error *error);

#endif
