/* A run as a process of its own: one that crashes takes no other with it. Private to the room. */
#ifndef GN_SWEEP_CHILD_H
#define GN_SWEEP_CHILD_H

#include "sweep/outcome.h"

#include <sched.h>
#include <signal.h>
#include <sys/types.h>

typedef struct gn_child {
    pid_t pid;
    size_t run;
    int threads;       /* processors that it takes up */
    int core;          /* that it is pinned to, as a place in the list; -1: none */
    bool resumed;      /* from a checkpoint */
    bool stepping;     /* past its packing and set-up */
    int64_t from_step; /* newest checkpoint when it was started, -1: none */
    double start;      /* gn_now() */
    char folder[GN_PATH_SIZE];
} gn_child;

typedef struct gn_child_way {
    const char *program;     /* path of gneiss */
    const sigset_t *signals; /* that the child blocks */
    const cpu_set_t *pinned; /* NULL: wherever its parent may run */
    bool own_threads;        /* as many as its scene says, not child->threads */
    bool allow_gmsh;         /* --allow-gmsh */
} gn_child_way;

/* Starts `gneiss run` on scene.yaml in child->folder, or `gneiss resume`; what it prints goes to
 * progress.jsonl and messages.txt there. It gets SIGTERM when its parent dies, however. */
gneiss_status gn_child_start(gn_child *child, const gn_child_way *way, gneiss_error *error);

/* Newest checkpoint in a folder, -1: none. */
int64_t gn_newest_checkpoint(const char *folder);

/* Seconds that a child still takes by its own account; NaN: not known. Sets child->stepping. */
double gn_child_remaining(gn_child *child);

/* What the wait status of a child says, with its last words. */
void gn_child_outcome(const gn_child *child, int wait_status, gn_outcome *outcome);

#endif
