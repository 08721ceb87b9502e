#define _GNU_SOURCE /* sched_getaffinity */
#include "sweep/work.h"

#include "base/memory.h"
#include "base/timer.h"
#include "io/checkpoint_files.h"
#include "io/files.h"
#include "run/folder.h"
#include "sweep/child.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Kills in a row without a new checkpoint in between, after which a run counts as failed. */
enum { KILLS_MOST = 5 };

typedef struct task {
    size_t run;
    gn_outcome outcome;
    bool over; /* nothing more to do in this call */
    bool running;
    bool afresh;   /* its checkpoints are of no use */
    int kills;     /* without getting on */
    double wanted; /* gn_now() before which it is not looked at again: its folder was in use */
} task;

typedef struct work {
    const gn_sweep *sweep;
    const gn_sweep_way *way;
    size_t task_count;
    task *tasks;
    size_t child_count;
    gn_child *children; /* [jobs] */
    size_t *child_task; /* [jobs] */
    int cores, jobs;
    bool pins;
    int core[CPU_SETSIZE]; /* numbers of the processors */
    sigset_t signals;      /* as they were, for children */
    double start;
    double own_seconds; /* of runs that came to their end here */
    size_t own_count;
    size_t done, failed, found;
    bool stopping;
} work;

/* ---- what there is to do ---- */

bool gn_sweep_mine(const gn_sweep *s, const gn_sweep_way *way, size_t run) {
    return s->runs[run].original == run && (!way->shards || run % way->shards == way->shard);
}

gneiss_status gn_sweep_look(const gn_sweep *s, const char *directory, gn_outcome *outcome,
                            gneiss_error *error) {
    char folder[GN_PATH_SIZE];
    for (size_t k = 0; k < s->run_count; k++) {
        size_t original = s->runs[k].original;
        if (original != k) {
            outcome[k] = outcome[original];
            continue;
        }
        if (!gn_run_folder(directory, s->runs[k].hash, folder))
            return gn_fail(error, GNEISS_ERROR_INPUT, "%.200s...: the path is too long", directory);
        GN_TRY(gn_outcome_read(folder, &outcome[k], error));
    }
    return GNEISS_OK;
}

static gneiss_status list_tasks(work *w, gneiss_error *error) {
    const gn_sweep *s = w->sweep;
    gn_outcome *outcome = gn_alloc_array(s->run_count, sizeof *outcome);
    w->tasks = gn_alloc_array(s->run_count, sizeof *w->tasks);
    gneiss_status status = outcome && w->tasks ? GNEISS_OK
                                               : gn_fail(error, GNEISS_ERROR_MEMORY,
                                                         "no memory for %zu runs", s->run_count);
    if (status == GNEISS_OK) status = gn_sweep_look(s, w->way->directory, outcome, error);
    for (size_t k = 0; status == GNEISS_OK && k < s->run_count; k++) {
        if (!gn_sweep_mine(s, w->way, k)) continue;
        task *t = &w->tasks[w->task_count++];
        *t = (task){.run = k, .outcome = outcome[k]};
        t->over = !w->way->force && gn_outcome_stands(&t->outcome);
        t->afresh = w->way->force || outcome[k].replaced;
        w->found += t->over;
        w->done += t->over && t->outcome.state == GN_RUN_DONE;
        w->failed += t->over && t->outcome.state == GN_RUN_FAILED;
    }
    gn_free(outcome);
    return status;
}

/* Processors of this process, in their order. */
static void list_cores(work *w) {
    cpu_set_t set;
    int count = 0;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) CPU_SET(0, &set);
    for (int k = 0; k < CPU_SETSIZE; k++)
        if (CPU_ISSET(k, &set)) w->core[count++] = k;
    int left = (int)(w->task_count - w->found);
    w->cores = w->way->threads > 0 ? w->way->threads : count;
    w->jobs = w->way->jobs > 0 ? w->way->jobs : w->cores;
    /* A part of the machine may be what another sweep was given as well. */
    w->pins = w->cores == count && w->jobs == count && left >= count;
    if (w->jobs > left) w->jobs = left > 0 ? left : 1;
}

/* ---- telling ---- */

/* What is left of the running ones, and for each of the others the mean of those that were done, or
 * else of those that run. */
static double remaining(work *w) {
    double sum = 0.0, longest = 0.0, expected = 0.0, now = gn_now();
    size_t known = 0, waiting = 0;
    for (size_t k = 0; k < w->child_count; k++) {
        double left = gn_child_remaining(&w->children[k]);
        if (!isfinite(left)) continue;
        sum += left;
        longest = fmax(longest, left);
        expected += left + now - w->children[k].start;
        known++;
    }
    for (size_t k = 0; k < w->task_count; k++) waiting += !w->tasks[k].over && !w->tasks[k].running;
    waiting += w->child_count - known;
    if (waiting == 0) return longest;
    if (w->own_count + known == 0) return NAN;
    double each = (w->own_seconds + expected) / (double)(w->own_count + known);
    return fmax(longest, (sum + each * (double)waiting) / w->jobs);
}

static void tell(work *w, const char *what, size_t run, const gn_outcome *outcome) {
    if (!w->way->watch) return;
    gn_sweep_progress p = {.total = w->task_count,
                           .done = w->done,
                           .failed = w->failed,
                           .running = w->child_count,
                           .found = w->found,
                           .seconds = gn_now() - w->start,
                           .eta = remaining(w),
                           .last = run,
                           .what = what,
                           .outcome = outcome};
    w->way->watch(w->way->context, &p);
}

/* ---- starting ---- */

/* One packing is made by one run; the others find it in the cache. */
static bool waits_for_packing(work *w, uint64_t packing) {
    const char *cache = getenv("GNEISS_CACHE");
    if (!packing || (cache && strcmp(cache, "off") == 0)) return false;
    for (size_t k = 0; k < w->child_count; k++) {
        gn_child *c = &w->children[k];
        if (w->sweep->runs[c->run].packing != packing) continue;
        if (!c->stepping) (void)gn_child_remaining(c);
        if (!c->stepping) return true;
    }
    return false;
}

/* By a run that outlives a sweep that was killed, until it has written its checkpoint. */
static bool in_use(const char *folder) {
    int lock = 0;
    gneiss_error error = {0};
    if (access(folder, F_OK) != 0) return false;
    bool used = gn_folder_lock(folder, &lock, &error) == GNEISS_ERROR_INPUT;
    if (lock > 0) close(lock);
    return used;
}

static gneiss_status write_scene(const work *w, const task *t, const char *folder,
                                 gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    gn_scene *scene = gn_alloc(sizeof *scene);
    if (!scene) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a scene");
    gneiss_status status = gn_sweep_scene(w->sweep, t->run, scene, error);
    if (status == GNEISS_OK) {
        char *text = gn_scene_write(scene);
        snprintf(path, sizeof path, "%s/scene.yaml", folder);
        status = text ? gn_write_text_file(path, text, GN_RENAMED, error)
                      : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the text of a scene");
        free(text);
        gn_scene_free(scene);
    }
    gn_free(scene);
    return status;
}

/* Processors for the next run: what is free, shared with those that start beside it. */
static int share(const work *w, const task *t) {
    int taken = 0, waiting = 0;
    for (size_t k = 0; k < w->child_count; k++) taken += w->children[k].threads;
    for (size_t k = 0; k < w->task_count; k++) waiting += !w->tasks[k].over && !w->tasks[k].running;
    int places = w->jobs - (int)w->child_count, most = (int)w->sweep->runs[t->run].threads;
    if (waiting < places) places = waiting;
    int threads = (w->cores - taken) / (places > 0 ? places : 1);
    if (most > 0 && threads > most) threads = most;
    return threads > 0 ? threads : 1;
}

static int free_core(const work *w) {
    for (int k = 0; k < w->cores; k++) {
        bool taken = false;
        for (size_t c = 0; c < w->child_count; c++) taken |= w->children[c].core == k;
        if (!taken) return k;
    }
    return -1;
}

static bool varies_threads(const gn_sweep *s) {
    for (size_t p = 0; p < s->parameter_count; p++)
        if (strcmp(s->parameters[p].key, "run.threads") == 0) return true;
    return false;
}

/* The folder as the run wants it: what is of no use is gone, its scene is there. */
static gneiss_status prepare(const work *w, task *t, gn_child *child, gneiss_error *error) {
    const char *folder = child->folder;
    char target[8];
    if (readlink(folder, target, sizeof target) >= 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a folder for a run, found a symbolic link, which is not "
                       "followed: remove it",
                       folder);
    GN_TRY(gn_make_directory(folder, error));
    gn_outcome_forget(folder, t->outcome.lost);
    if (t->afresh) GN_TRY(gn_checkpoint_prune(folder, 0, error));
    GN_TRY(gn_outcome_set_aside(folder, error));
    child->resumed = !t->afresh && gn_newest_checkpoint(folder) >= 0;
    t->afresh = false;
    return child->resumed ? GNEISS_OK : write_scene(w, t, folder, error);
}

/* *started is false when the folder is in use. */
static gneiss_status start(work *w, task *t, bool *started, gneiss_error *error) {
    gn_child *child = &w->children[w->child_count];
    cpu_set_t set;
    *child = (gn_child){.run = t->run, .core = -1};
    *started = false;
    gn_run_folder(w->way->directory, w->sweep->runs[t->run].hash, child->folder);
    if (in_use(child->folder)) {
        t->wanted = gn_now() + 0.2;
        return GNEISS_OK;
    }
    gn_child_way way = {.program = w->way->program, .signals = &w->signals};
    way.own_threads = varies_threads(w->sweep);
    way.allow_gmsh = w->way->allow_gmsh;
    child->threads = share(w, t);
    if (w->pins && child->threads == 1 && !way.own_threads) child->core = free_core(w);
    if (child->core >= 0) {
        CPU_ZERO(&set);
        CPU_SET(w->core[child->core], &set);
        way.pinned = &set;
    }
    GN_TRY(prepare(w, t, child, error));
    GN_TRY(gn_child_start(child, &way, error));
    *started = t->running = true;
    w->child_task[w->child_count++] = (size_t)(t - w->tasks);
    tell(w, child->resumed ? "resumed" : "started", t->run, NULL);
    return GNEISS_OK;
}

/* *held: something waits that could run but for a packing or a folder in use. */
static gneiss_status start_more(work *w, bool *held, gneiss_error *error) {
    *held = false;
    for (size_t k = 0; k < w->task_count && w->child_count < (size_t)w->jobs; k++) {
        task *t = &w->tasks[k];
        bool started;
        if (t->over || t->running) continue;
        if (t->wanted > gn_now() || waits_for_packing(w, w->sweep->runs[t->run].packing)) {
            *held = true;
            continue;
        }
        GN_TRY(start(w, t, &started, error));
        *held |= !started;
    }
    return GNEISS_OK;
}

/* ---- ends ---- */

static bool was_killed(const gn_outcome *o) {
    int number = o->code - 128;
    return number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP ||
           o->code == GNEISS_INTERRUPTED;
}

/* A run that somebody ended goes on, unless that happens again and again without its getting on. */
static bool goes_on(task *t, const gn_child *child) {
    if (gn_newest_checkpoint(child->folder) > child->from_step) t->kills = 0;
    return ++t->kills < KILLS_MOST;
}

static gneiss_status take_in(work *w, size_t place, int wait_status, gneiss_error *error) {
    gn_child child = w->children[place];
    task *t = &w->tasks[w->child_task[place]];
    w->child_count--;
    w->children[place] = w->children[w->child_count];
    w->child_task[place] = w->child_task[w->child_count];
    t->running = false;
    gn_child_outcome(&child, wait_status, &t->outcome);
    bool killed = was_killed(&t->outcome);
    if (killed && w->stopping) return GNEISS_OK;
    if (killed && goes_on(t, &child)) {
        tell(w, "killed", t->run, &t->outcome);
        return GNEISS_OK;
    }
    if (t->outcome.code == GNEISS_ERROR_INPUT && child.resumed) { /* no checkpoint can be used */
        t->afresh = true;
        return GNEISS_OK;
    }
    t->over = true;
    bool done = t->outcome.state == GN_RUN_DONE;
    w->done += done;
    w->failed += !done;
    w->own_seconds += gn_now() - child.start;
    w->own_count++;
    GN_TRY(gn_outcome_write(child.folder, &t->outcome, error));
    tell(w, done ? "done" : "failed", t->run, &t->outcome);
    return GNEISS_OK;
}

static gneiss_status reap(work *w, gneiss_error *error) {
    gneiss_status first = GNEISS_OK;
    for (size_t k = 0; k < w->child_count;) {
        int wait_status;
        pid_t ended = waitpid(w->children[k].pid, &wait_status, WNOHANG);
        if (ended != w->children[k].pid) {
            k++;
            continue;
        }
        gneiss_status status = take_in(w, k, wait_status, first == GNEISS_OK ? error : NULL);
        if (first == GNEISS_OK) first = status;
    }
    return first;
}

/* Until a child ends or a signal comes, no longer than so many seconds. */
static void wait_a_while(double seconds) {
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    struct timespec most = {(time_t)seconds, (long)(1e9 * fmod(seconds, 1.0))};
    (void)sigtimedwait(&child, NULL, &most);
}

/* Once: a second signal would end them at once. */
static void stop(work *w) {
    if (w->stopping) return;
    w->stopping = true;
    for (size_t k = 0; k < w->child_count; k++) kill(w->children[k].pid, SIGTERM);
}

/* ---- the whole ---- */

static bool all_over(const work *w) {
    return w->child_count == 0 && (w->stopping || w->done + w->failed == w->task_count);
}

static gneiss_status carry_out(work *w, gneiss_error *error) {
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k < w->task_count; k++)
        if (w->tasks[k].outcome.lost && !w->way->force)
            tell(w, "lost", w->tasks[k].run, &w->tasks[k].outcome);
    while (!all_over(w)) {
        bool held = false;
        if (w->way->interrupted && *w->way->interrupted) stop(w);
        if (!w->stopping) {
            gneiss_status more = start_more(w, &held, error);
            if (more != GNEISS_OK) status = more, stop(w);
        }
        wait_a_while(held ? 0.05 : 0.5);
        gneiss_status more = reap(w, status == GNEISS_OK ? error : NULL);
        if (more != GNEISS_OK && status == GNEISS_OK) status = more, stop(w);
        tell(w, NULL, 0, NULL);
    }
    GN_TRY(status);
    if (w->done + w->failed == w->task_count) return GNEISS_OK;
    return gn_fail(error, GNEISS_INTERRUPTED,
                   "%zu of %zu runs are done; the same command goes on with the rest", w->done,
                   w->task_count);
}

gneiss_status gn_sweep_work(const gn_sweep *sweep, const gn_sweep_way *way, gneiss_error *error) {
    work w = {.sweep = sweep, .way = way, .start = gn_now()};
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    sigprocmask(SIG_BLOCK, &child, &w.signals);
    gneiss_status status = list_tasks(&w, error);
    if (status == GNEISS_OK) {
        list_cores(&w);
        w.children = gn_alloc_array((size_t)w.jobs, sizeof *w.children);
        w.child_task = gn_alloc_array((size_t)w.jobs, sizeof *w.child_task);
        status = w.children && w.child_task
                     ? carry_out(&w, error)
                     : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %d runs", w.jobs);
    }
    sigprocmask(SIG_SETMASK, &w.signals, NULL);
    gn_free(w.tasks);
    gn_free(w.children);
    gn_free(w.child_task);
    return status;
}
