#define _GNU_SOURCE /* cpu_set_t */
#include "sweep/work.h"

#include "base/new.h"
#include "base/timer.h"
#include "io/io.h"
#include "io/listing.h"
#include "run/folder.h"
#include "sweep/summary.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

typedef struct gn_child {
    pid_t pid;
    size_t run;
    int threads;       /* number of processors that the run uses */
    int core;          /* number of the processor on which the run must stay; -1: any */
    bool resumed;      /* started from a checkpoint */
    bool stepping;     /* packing and set-up are finished */
    int64_t from_step; /* step of the newest checkpoint when the run was started; -1: none */
    double start;      /* gn_now() */
    char folder[GN_PATH_SIZE];
} gn_child;

typedef struct gn_child_way {
    const char *program;     /* path of gneiss */
    const sigset_t *signals; /* signals that the child blocks */
    const cpu_set_t *pinned; /* NULL: any processor of the parent */
    bool own_threads;        /* number of threads as in the scene, not child->threads */
    bool allow_gmsh;         /* --allow-gmsh */
} gn_child_way;

/* ---- a run as a separate process, so that a crash affects no other run. Private to src/sweep ----
 */

/* ---- starting ---- */

/* Creates a new file in place of any existing one; if that is a link, it is not followed. */
static int open_log(const char *folder, const char *name) {
    char path[GN_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (unlink(path) != 0 && errno != ENOENT) return -1;
    return open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/* Runs in the child between fork and exec, with system calls only. A separate process group keeps
 * the terminal's Ctrl-C from it; the parent passes signals on, once. */
static void become(const gn_child_way *way, char *const *arguments, const int descriptor[3],
                   pid_t parent) {
    setpgid(0, 0);
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) != 0 || getppid() != parent) _exit(GNEISS_INTERRUPTED);
    for (int k = 0; k < 3; k++)
        if (dup2(descriptor[k], k) < 0) _exit(GNEISS_ERROR_IO);
    if (way->pinned) (void)sched_setaffinity(0, sizeof *way->pinned, way->pinned);
    sigprocmask(SIG_SETMASK, way->signals, NULL);
    execv(way->program, arguments);
    _exit(GNEISS_ERROR_IO);
}

static gneiss_status fork_into(gn_child *child, const gn_child_way *way, char *const *arguments,
                               gneiss_error *error) {
    int descriptor[3] = {open("/dev/null", O_RDONLY | O_CLOEXEC),
                         open_log(child->folder, "progress.jsonl"),
                         open_log(child->folder, "messages.txt")};
    gneiss_status status = GNEISS_OK;
    pid_t parent = getpid();
    if (descriptor[0] < 0 || descriptor[1] < 0 || descriptor[2] < 0) {
        status = gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be written: %s", child->folder,
                         strerror(errno));
    } else {
        child->pid = fork();
        if (child->pid == 0) become(way, arguments, descriptor, parent);
        if (child->pid < 0)
            status =
                gn_fail(error, GNEISS_ERROR_MEMORY, "no process for a run: %s", strerror(errno));
    }
    for (int k = 0; k < 3; k++)
        if (descriptor[k] >= 0) close(descriptor[k]);
    child->start = gn_now();
    return status;
}

/* Returns the step of the newest checkpoint in a folder; -1: none. */
static int64_t newest_checkpoint(const char *folder) {
    int64_t step = -1;
    size_t count = 0;
    if (gn_checkpoint_list(folder, &step, 1, &count, NULL) != GNEISS_OK || !count) return -1;
    return step;
}

/* Starts `gneiss run` on scene.yaml in child->folder, or `gneiss resume`; its output goes to
 * progress.jsonl and messages.txt there. The child gets SIGTERM when its parent ends in any way. */
static gneiss_status child_start(gn_child *child, const gn_child_way *way, gneiss_error *error) {
    char scene[GN_PATH_SIZE + 32], threads[16];
    snprintf(scene, sizeof scene, "%s/scene.yaml", child->folder);
    snprintf(threads, sizeof threads, "%d", child->threads);
    char *const run[] = {"gneiss", "run", scene, "--out", child->folder, "--force"},
                *const resume[] = {"gneiss", "resume", child->folder};
    char *arguments[16];
    size_t count = child->resumed ? sizeof resume / sizeof *resume : sizeof run / sizeof *run;
    memcpy(arguments, child->resumed ? resume : run, count * sizeof *arguments);
    arguments[count++] = "--log";
    arguments[count++] = "json";
    if (way->allow_gmsh) arguments[count++] = "--allow-gmsh";
    if (!way->own_threads) {
        arguments[count++] = "--threads";
        arguments[count++] = threads;
    }
    arguments[count] = NULL;
    child->from_step = newest_checkpoint(child->folder);
    child->stepping = false;
    return fork_into(child, way, arguments, error);
}

/* ---- watching ---- */

/* Reads the last `size` - 1 bytes of a file; the result is "" if it cannot be read. */
static void read_tail(const char *folder, const char *name, char *text, size_t size) {
    char path[GN_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    text[0] = '\0';
    int descriptor = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return;
    off_t end = lseek(descriptor, 0, SEEK_END), from = end - (off_t)(size - 1);
    ssize_t got = pread(descriptor, text, size - 1, from > 0 ? from : 0);
    text[got > 0 ? got : 0] = '\0';
    close(descriptor);
}

/* Returns the remaining time, s, from the last complete line: {"step":12, ..., "eta":3.5, ...}. */
static double child_remaining(gn_child *child) {
    char text[1 << 10];
    read_tail(child->folder, "progress.jsonl", text, sizeof text);
    char *last = strrchr(text, '\n');
    if (!last) return NAN;
    *last = '\0';
    char *line = strrchr(text, '\n');
    line = line ? line + 1 : text;
    child->stepping |= strstr(line, "\"step\"") != NULL;
    const char *eta = strstr(line, "\"eta\"");
    if (!eta || !(eta = strchr(eta, ':'))) return NAN;
    eta += 1 + strspn(eta + 1, " ");
    return *eta == 'n' ? NAN : strtod(eta, NULL); /* null */
}

/* ---- the end ---- */

/* Copies the text from the last "gneiss: ..." that is not a warning up to the end, without line
 * breaks. */
static void last_message(const char *folder, char *message, size_t size) {
    char text[1 << 13];
    read_tail(folder, "messages.txt", text, sizeof text);
    const char *from = NULL;
    for (char *at = text; (at = strstr(at, "gneiss: ")); at++)
        if ((at == text || at[-1] == '\n') && strncmp(at, "gneiss: warning", 15) != 0)
            from = at + 8;
    size_t used = 0;
    for (; from && *from && used + 1 < size; from++)
        message[used++] = (unsigned char)*from < 0x20 || *from == 0x7f ? ' ' : *from;
    while (used && message[used - 1] == ' ') used--;
    message[used] = '\0';
}

/* Converts the wait status of a child, with its last message, to an outcome. */
static void child_outcome(const gn_child *child, int wait_status, gn_outcome *outcome) {
    *outcome = (gn_outcome){.state = GN_RUN_FAILED};
    if (WIFSIGNALED(wait_status)) {
        int number = WTERMSIG(wait_status);
        outcome->code = 128 + number;
        snprintf(outcome->message, sizeof outcome->message, "ended by signal %d (%s)", number,
                 strsignal(number));
        return;
    }
    outcome->code = WEXITSTATUS(wait_status);
    if (outcome->code == GNEISS_OK) {
        outcome->state = GN_RUN_DONE;
        return;
    }
    last_message(child->folder, outcome->message, sizeof outcome->message);
    if (!outcome->message[0])
        snprintf(outcome->message, sizeof outcome->message, "exit code %d without a message",
                 outcome->code);
}

/* Number of consecutive kills without a new checkpoint after which a run counts as failed. */
enum { KILLS_MOST = 5 };

typedef struct run_task {
    size_t run;
    gn_outcome outcome;
    bool over; /* the calling process has no more work to do for it */
    bool running;
    bool afresh;   /* the checkpoints are unusable */
    int kills;     /* number of kills without progress in between */
    double wanted; /* gn_now() from which on the run may be started again, after its folder was in
                      use */
} run_task;

typedef struct run_pool {
    const gn_sweep *sweep;
    const gn_sweep_way *way;
    size_t task_count;
    run_task *tasks;
    size_t child_count;
    gn_child *children; /* [jobs] */
    size_t *child_task; /* [jobs] */
    int cores, jobs;
    bool pins;
    int core[CPU_SETSIZE]; /* numbers of the processors */
    sigset_t signals;      /* original mask, for children */
    double start;
    double own_seconds; /* s of the runs that this call has completed */
    size_t own_count;
    size_t done, failed, found;
    bool stopping;
} run_pool;

/* ---- tasks ---- */

bool gn_sweep_run_in_shard(const gn_sweep *sweep, const gn_sweep_way *way, size_t run) {
    return sweep->runs[run].original == run && (!way->shards || run % way->shards == way->shard);
}

/* Counts the runs of the shard by state; `outcome` [run_count] is set for all runs of the sweep. */
static gneiss_status read_outcomes(const gn_sweep *sweep, const char *directory,
                                   gn_outcome *outcome, gneiss_error *error) {
    char folder[GN_PATH_SIZE];
    for (size_t k = 0; k < sweep->run_count; k++) {
        size_t original = sweep->runs[k].original;
        if (original != k) {
            outcome[k] = outcome[original];
            continue;
        }
        if (!gn_run_folder(directory, sweep->runs[k].hash, folder))
            return gn_fail(error, GNEISS_ERROR_INPUT, "%.200s...: the path is too long", directory);
        GN_TRY(gn_outcome_read(folder, &outcome[k], error));
    }
    return GNEISS_OK;
}

static gneiss_status list_tasks(run_pool *pool, gneiss_error *error) {
    const gn_sweep *sweep = pool->sweep;
    GN_FREED gn_outcome *outcome = NULL;
    GN_TRY(gn_new(&outcome, sweep->run_count, "runs", error));
    GN_TRY(gn_new(&pool->tasks, sweep->run_count, "runs", error));
    GN_TRY(read_outcomes(sweep, pool->way->directory, outcome, error));
    for (size_t k = 0; k < sweep->run_count; k++) {
        if (!gn_sweep_run_in_shard(sweep, pool->way, k)) continue;
        run_task *task = &pool->tasks[pool->task_count++];
        *task = (run_task){.run = k, .outcome = outcome[k]};
        task->over = !pool->way->force && gn_outcome_is_final(&task->outcome);
        task->afresh = pool->way->force || outcome[k].replaced;
        pool->found += task->over;
        pool->done += task->over && task->outcome.state == GN_RUN_DONE;
        pool->failed += task->over && task->outcome.state == GN_RUN_FAILED;
    }
    return GNEISS_OK;
}

/* Lists the processors of this process, in ascending order. */
static void list_cores(run_pool *pool) {
    cpu_set_t set;
    int count = 0;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) CPU_SET(0, &set);
    for (int k = 0; k < CPU_SETSIZE; k++)
        if (CPU_ISSET(k, &set)) pool->core[count++] = k;
    int left = (int)(pool->task_count - pool->found);
    pool->cores = pool->way->threads > 0 ? pool->way->threads : count;
    pool->jobs = pool->way->jobs > 0 ? pool->way->jobs : pool->cores;
    /* Runs are bound to processors only if the sweep uses the whole machine; otherwise it may share
     * processors with another sweep. */
    pool->pins = pool->cores == count && pool->jobs == count && left >= count;
    if (pool->jobs > left) pool->jobs = left > 0 ? left : 1;
}

/* ---- progress ---- */

/* Returns the remaining time: that of the running runs, plus for each other run the mean time of
 * the completed runs, or else of the running ones. */
static double remaining(run_pool *pool) {
    double sum = 0.0, longest = 0.0, expected = 0.0, now = gn_now();
    size_t known = 0, waiting = 0;
    for (size_t k = 0; k < pool->child_count; k++) {
        double left = child_remaining(&pool->children[k]);
        if (!isfinite(left)) continue;
        sum += left;
        longest = fmax(longest, left);
        expected += left + now - pool->children[k].start;
        known++;
    }
    for (size_t k = 0; k < pool->task_count; k++)
        waiting += !pool->tasks[k].over && !pool->tasks[k].running;
    waiting += pool->child_count - known;
    if (waiting == 0) return longest;
    if (pool->own_count + known == 0) return NAN;
    double each = (pool->own_seconds + expected) / (double)(pool->own_count + known);
    return fmax(longest, (sum + each * (double)waiting) / pool->jobs);
}

static void report_event(run_pool *pool, const char *what, size_t run, const gn_outcome *outcome) {
    if (!pool->way->watch) return;
    gn_sweep_progress p = {.total = pool->task_count,
                           .done = pool->done,
                           .failed = pool->failed,
                           .running = pool->child_count,
                           .found = pool->found,
                           .seconds = gn_now() - pool->start,
                           .eta = remaining(pool),
                           .last = run,
                           .what = what,
                           .outcome = outcome};
    pool->way->watch(pool->way->context, &p);
}

/* ---- starting ---- */

/* Tells whether a run has to wait until another one has made its packing, which it then finds in
 * the cache. */
static bool waits_for_packing(run_pool *pool, uint64_t packing) {
    const char *cache = getenv("GNEISS_CACHE");
    if (!packing || (cache && strcmp(cache, "off") == 0)) return false;
    for (size_t k = 0; k < pool->child_count; k++) {
        gn_child *c = &pool->children[k];
        if (pool->sweep->runs[c->run].packing != packing) continue;
        if (!c->stepping) (void)child_remaining(c);
        if (!c->stepping) return true;
    }
    return false;
}

/* True if a folder is still in use by a run that outlives a killed sweep, until it has written its
 * checkpoint. */
static bool in_use(const char *folder) {
    int lock = 0;
    gneiss_error error = {0};
    if (access(folder, F_OK) != 0) return false;
    bool used = gn_folder_lock(folder, &lock, &error) == GNEISS_ERROR_INPUT;
    if (lock > 0) close(lock);
    return used;
}

static gneiss_status write_scene(const run_pool *pool, const run_task *task, const char *folder,
                                 gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(gn_sweep_scene(pool->sweep, task->run, scene, error));
    GN_FREED char *text = gn_scene_write(scene);
    if (!text) return gn_no_memory(error, "the text of a scene");
    snprintf(path, sizeof path, "%s/scene.yaml", folder);
    return gn_write_text_file(path, text, GN_RENAMED, error);
}

/* Returns the number of processors for the next run: a share of the free ones. */
static int share(const run_pool *pool, const run_task *task) {
    int taken = 0, waiting = 0;
    for (size_t k = 0; k < pool->child_count; k++) taken += pool->children[k].threads;
    for (size_t k = 0; k < pool->task_count; k++)
        waiting += !pool->tasks[k].over && !pool->tasks[k].running;
    int places = pool->jobs - (int)pool->child_count,
        most = (int)pool->sweep->runs[task->run].threads;
    if (waiting < places) places = waiting;
    int threads = (pool->cores - taken) / (places > 0 ? places : 1);
    if (most > 0 && threads > most) threads = most;
    return threads > 0 ? threads : 1;
}

static int free_core(const run_pool *pool) {
    for (int k = 0; k < pool->cores; k++) {
        bool taken = false;
        for (size_t c = 0; c < pool->child_count; c++) taken |= pool->children[c].core == k;
        if (!taken) return k;
    }
    return -1;
}

static bool varies_threads(const gn_sweep *sweep) {
    for (size_t p = 0; p < sweep->parameter_count; p++)
        if (strcmp(sweep->parameters[p].key, "run.threads") == 0) return true;
    return false;
}

/* Prepares the folder of a run: removes unusable files and writes the scene. */
static gneiss_status prepare(const run_pool *pool, run_task *task, gn_child *child,
                             gneiss_error *error) {
    const char *folder = child->folder;
    char target[8];
    if (readlink(folder, target, sizeof target) >= 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a folder for a run, found a symbolic link, which is not "
                       "followed: remove it",
                       folder);
    GN_TRY(gn_make_directory(folder, error));
    gn_outcome_remove(folder, task->outcome.lost);
    if (task->afresh) GN_TRY(gn_checkpoint_prune(folder, 0, error));
    GN_TRY(gn_outcome_rename_foreign(folder, error));
    child->resumed = !task->afresh && newest_checkpoint(folder) >= 0;
    task->afresh = false;
    return child->resumed ? GNEISS_OK : write_scene(pool, task, folder, error);
}

/* Starts a run; *started is false if the folder is in use. */
static gneiss_status start(run_pool *pool, run_task *task, bool *started, gneiss_error *error) {
    gn_child *child = &pool->children[pool->child_count];
    cpu_set_t set;
    *child = (gn_child){.run = task->run, .core = -1};
    *started = false;
    gn_run_folder(pool->way->directory, pool->sweep->runs[task->run].hash, child->folder);
    if (in_use(child->folder)) {
        task->wanted = gn_now() + 0.2;
        return GNEISS_OK;
    }
    gn_child_way way = {.program = pool->way->program, .signals = &pool->signals};
    way.own_threads = varies_threads(pool->sweep);
    way.allow_gmsh = pool->way->allow_gmsh;
    child->threads = share(pool, task);
    if (pool->pins && child->threads == 1 && !way.own_threads) child->core = free_core(pool);
    if (child->core >= 0) {
        CPU_ZERO(&set);
        CPU_SET(pool->core[child->core], &set);
        way.pinned = &set;
    }
    GN_TRY(prepare(pool, task, child, error));
    GN_TRY(child_start(child, &way, error));
    *started = task->running = true;
    pool->child_task[pool->child_count++] = (size_t)(task - pool->tasks);
    report_event(pool, child->resumed ? "resumed" : "started", task->run, NULL);
    return GNEISS_OK;
}

/* Starts runs on free processors; *held: a run waits for a packing, or for a folder that is in use.
 */
static gneiss_status start_more(run_pool *pool, bool *held, gneiss_error *error) {
    *held = false;
    for (size_t k = 0; k < pool->task_count && pool->child_count < (size_t)pool->jobs; k++) {
        run_task *task = &pool->tasks[k];
        bool started;
        if (task->over || task->running) continue;
        if (task->wanted > gn_now() ||
            waits_for_packing(pool, pool->sweep->runs[task->run].packing)) {
            *held = true;
            continue;
        }
        GN_TRY(start(pool, task, &started, error));
        *held |= !started;
    }
    return GNEISS_OK;
}

/* ---- ends ---- */

static bool was_killed(const gn_outcome *outcome) {
    int number = outcome->code - 128;
    return number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP ||
           outcome->code == GNEISS_INTERRUPTED;
}

/* Tells whether a run that was killed may be resumed: not if this happens repeatedly without
 * progress. */
static bool may_resume(run_task *task, const gn_child *child) {
    if (newest_checkpoint(child->folder) > child->from_step) task->kills = 0;
    return ++task->kills < KILLS_MOST;
}

static gneiss_status take_in(run_pool *pool, size_t place, int wait_status, gneiss_error *error) {
    gn_child child = pool->children[place];
    run_task *task = &pool->tasks[pool->child_task[place]];
    pool->child_count--;
    pool->children[place] = pool->children[pool->child_count];
    pool->child_task[place] = pool->child_task[pool->child_count];
    task->running = false;
    child_outcome(&child, wait_status, &task->outcome);
    bool killed = was_killed(&task->outcome);
    if (killed && pool->stopping) return GNEISS_OK;
    if (killed && may_resume(task, &child)) {
        report_event(pool, "killed", task->run, &task->outcome);
        return GNEISS_OK;
    }
    if (task->outcome.code == GNEISS_ERROR_INPUT &&
        child.resumed) { /* there is no usable checkpoint */
        task->afresh = true;
        return GNEISS_OK;
    }
    task->over = true;
    bool done = task->outcome.state == GN_RUN_DONE;
    pool->done += done;
    pool->failed += !done;
    pool->own_seconds += gn_now() - child.start;
    pool->own_count++;
    GN_TRY(gn_outcome_write(child.folder, &task->outcome, error));
    report_event(pool, done ? "done" : "failed", task->run, &task->outcome);
    return GNEISS_OK;
}

static gneiss_status reap(run_pool *pool, gneiss_error *error) {
    gneiss_status first = GNEISS_OK;
    for (size_t k = 0; k < pool->child_count;) {
        int wait_status;
        pid_t ended = waitpid(pool->children[k].pid, &wait_status, WNOHANG);
        if (ended != pool->children[k].pid) {
            k++;
            continue;
        }
        gneiss_status status = take_in(pool, k, wait_status, first == GNEISS_OK ? error : NULL);
        if (first == GNEISS_OK) first = status;
    }
    return first;
}

/* Waits until a child ends or a signal arrives, but at most the given number of seconds. */
static void wait_a_while(double seconds) {
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    struct timespec most = {(time_t)seconds, (long)(1e9 * fmod(seconds, 1.0))};
    (void)sigtimedwait(&child, NULL, &most);
}

/* Sends a signal to the children once; a second one would end them without checkpoints. */
static void stop(run_pool *pool) {
    if (pool->stopping) return;
    pool->stopping = true;
    for (size_t k = 0; k < pool->child_count; k++) kill(pool->children[k].pid, SIGTERM);
}

/* ---- all runs ---- */

static bool all_over(const run_pool *pool) {
    return pool->child_count == 0 &&
           (pool->stopping || pool->done + pool->failed == pool->task_count);
}

static gneiss_status carry_out(run_pool *pool, gneiss_error *error) {
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k < pool->task_count; k++)
        if (pool->tasks[k].outcome.lost && !pool->way->force)
            report_event(pool, "lost", pool->tasks[k].run, &pool->tasks[k].outcome);
    while (!all_over(pool)) {
        bool held = false;
        if (pool->way->interrupted && *pool->way->interrupted) stop(pool);
        if (!pool->stopping) {
            gneiss_status more = start_more(pool, &held, error);
            if (more != GNEISS_OK) status = more, stop(pool);
        }
        wait_a_while(held ? 0.05 : 0.5);
        gneiss_status more = reap(pool, status == GNEISS_OK ? error : NULL);
        if (more != GNEISS_OK && status == GNEISS_OK) status = more, stop(pool);
        report_event(pool, NULL, 0, NULL);
    }
    GN_TRY(status);
    if (pool->done + pool->failed == pool->task_count) return GNEISS_OK;
    return gn_fail(error, GNEISS_INTERRUPTED,
                   "%zu of %zu runs are done; repeat the command to run the rest", pool->done,
                   pool->task_count);
}

gneiss_status gn_sweep_work(const gn_sweep *sweep, const gn_sweep_way *way, gneiss_error *error) {
    run_pool w = {.sweep = sweep, .way = way, .start = gn_now()};
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
