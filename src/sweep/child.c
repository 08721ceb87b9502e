#define _GNU_SOURCE /* cpu_set_t */
#include "sweep/child.h"

#include "base/timer.h"
#include "io/checkpoint_files.h"
#include "io/files.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- starting ---- */

/* Creates a new file in place of any existing one; an existing link is not followed. */
static int open_log(const char *folder, const char *name) {
    char path[GN_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (unlink(path) != 0 && errno != ENOENT) return -1;
    return open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/* Runs in the child between fork and exec, with system calls only. A separate process group keeps
 * the terminal's Ctrl-C from it: the parent passes signals on, once. */
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

gneiss_status gn_child_start(gn_child *child, const gn_child_way *way, gneiss_error *error) {
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
    child->from_step = gn_newest_checkpoint(child->folder);
    child->stepping = false;
    return fork_into(child, way, arguments, error);
}

int64_t gn_newest_checkpoint(const char *folder) {
    int64_t step = -1;
    size_t count = 0;
    if (gn_checkpoint_list(folder, &step, 1, &count, NULL) != GNEISS_OK || !count) return -1;
    return step;
}

/* ---- watching ---- */

/* Reads the last `size` - 1 bytes of a file; "" if it cannot be read. */
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

/* Reads the last complete line: {"step":12, ..., "eta":3.5, ...}. */
double gn_child_remaining(gn_child *child) {
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

/* Reads from the last "gneiss: ..." that is no warning to the end, without line breaks. */
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

void gn_child_outcome(const gn_child *child, int wait_status, gn_outcome *outcome) {
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
