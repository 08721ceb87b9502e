/* A run as a separate process, so that a crash affects no other run. Private to src/sweep. */
#ifndef GN_SWEEP_CHILD_H
#define GN_SWEEP_CHILD_H

#include "sweep/outcome.h"

#include <sched.h>
#include <signal.h>
#include <sys/types.h>

typedef struct gn_child {
    pid_t pid;
    size_t run;
    int threads;       /* processors that it uses */
    int core;          /* index of the processor that it is pinned to; -1: none */
    bool resumed;      /* started from a checkpoint */
    bool stepping;     /* past packing and set-up */
    int64_t from_step; /* step of the newest checkpoint when it was started; -1: none */
    double start;      /* gn_now() */
    char folder[GN_PATH_SIZE];
} gn_child;

typedef struct gn_child_way {
    const char *program;     /* path of gneiss */
    const sigset_t *signals; /* signals that the child blocks */
    const cpu_set_t *pinned; /* NULL: any processor of the parent */
    bool own_threads;        /* threads as in its scene, not child->threads */
    bool allow_gmsh;         /* --allow-gmsh */
} gn_child_way;

/* Starts `gneiss run` on scene.yaml in child->folder, or `gneiss resume`; its output goes to
 * progress.jsonl and messages.txt there. The child gets SIGTERM when its parent dies in any way. */
gneiss_status gn_child_start(gn_child *child, const gn_child_way *way, gneiss_error *error);

/* Returns the step of the newest checkpoint in a folder; -1: none. */
int64_t gn_newest_checkpoint(const char *folder);

/* Returns the remaining seconds by the child's own estimate; NaN: unknown. Sets child->stepping. */
double gn_child_remaining(gn_child *child);

/* Translates the wait status of a child, with its last message, into an outcome. */
void gn_child_outcome(const gn_child *child, int wait_status, gn_outcome *outcome);

#endif
