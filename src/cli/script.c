#include "cli/script.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char python[] = "/usr/bin/python3";

/* A script, with the environment variable that replaces its path, its path below share/gneiss of an
 * installation, and its path in the source tree. */
typedef struct script {
    const char *variable, *installed, *source;
} script;

enum { SELF_SIZE = GN_PATH_SIZE, SCRIPT_SIZE = 2 * GN_PATH_SIZE };

/* Finds the path of this program; "" if unknown. */
static void find_self(char self[SELF_SIZE]) {
    ssize_t n = readlink("/proc/self/exe", self, SELF_SIZE - 1);
    self[n > 0 ? n : 0] = 0;
}

/* Finds a script in the place of installation, in the source tree of the program, or beside a
 * program that was moved with its files. A folder `tools` beside an installed program may belong to
 * something else. */
static gneiss_status find(const script *wanted, const char *self, char path[SCRIPT_SIZE],
                          gneiss_error *error) {
    const char *given = getenv(wanted->variable), *slash = strrchr(self, '/');
    if (given) {
        snprintf(path, SCRIPT_SIZE, "%s", given);
        return GNEISS_OK;
    }
    const struct {
        const char *between, *name;
    } places[] = {
        {"../share/gneiss/", wanted->installed}, {"../", wanted->source}, {"", wanted->source}};
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        snprintf(path, SCRIPT_SIZE, "%.*s/%s%s", slash ? (int)(slash - self) : 0, self,
                 places[k].between, places[k].name);
        if (access(path, R_OK) == 0) return GNEISS_OK;
    }
    return gn_fail(error, GNEISS_ERROR_IO,
                   "beside the program there is neither ../share/gneiss/%s nor ../%s nor %s "
                   "(%s gives another place)",
                   wanted->installed, wanted->source, wanted->source, wanted->variable);
}

/* Copies what a child writes to the streams of this program until it closes both pipes. */
static void relay(const int from[2]) {
    FILE *const to[2] = {stdout, stderr};
    char bytes[4096];
    struct pollfd watched[2] = {{from[0], POLLIN, 0}, {from[1], POLLIN, 0}};
    while (watched[0].fd >= 0 || watched[1].fd >= 0) {
        if (poll(watched, 2, -1) < 0 && errno != EINTR) return;
        for (int k = 0; k < 2; k++) {
            if (watched[k].fd < 0 || !watched[k].revents) continue;
            const ssize_t count = read(from[k], bytes, sizeof bytes);
            if (count > 0)
                fwrite(bytes, 1, (size_t)count, to[k]);
            else if (count == 0 || errno != EINTR)
                watched[k].fd = -1;
        }
    }
}

/* Runs a script as a child process whose output passes through the streams of this one. A signal
 * that reaches both is left to the child, with which this process ends. */
static gneiss_status run_beside(char *const *arguments, gneiss_error *error) {
    int out[2], errors[2], status = 0;
    if (pipe(out) != 0 || pipe(errors) != 0)
        return gn_fail(error, GNEISS_ERROR_IO, "no pipe for %s", python);
    const pid_t child = fork();
    if (child == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (dup2(out[1], 1) < 0 || dup2(errors[1], 2) < 0) _exit(GNEISS_ERROR_IO);
        for (int k = 0; k < 2; k++) close(out[k]), close(errors[k]);
        execv(python, arguments);
        _exit(GNEISS_ERROR_IO);
    }
    close(out[1]);
    close(errors[1]);
    if (child < 0) return gn_fail(error, GNEISS_ERROR_MEMORY, "no process for %s", python);
    signal(SIGINT, SIG_IGN);
    relay((const int[]){out[0], errors[0]});
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    /* The child has printed the reason. */
    return WIFEXITED(status) ? (gneiss_status)WEXITSTATUS(status) : GNEISS_INTERRUPTED;
}

/* Starts a script with a full path of Python, by which it finds its modules: a bare name would lead
 * to an active virtual environment. */
static gneiss_status start(const gn_options *options, char *const *arguments, gneiss_error *error) {
    if (options->log) return run_beside(arguments, error);
    execv(python, arguments);
    return gn_fail(error, GNEISS_ERROR_IO, "%s could not be started", python);
}

/* Checks that the target is not a file, and finds a script that reads a folder of results. */
static gneiss_status find_reader(const gn_options *options, const script *wanted,
                                 char path[SCRIPT_SIZE], gneiss_error *error) {
    char self[SELF_SIZE];
    struct stat target;
    if (stat(options->target, &target) == 0 && !S_ISDIR(target.st_mode))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a folder of results, found a file",
                       options->target);
    find_self(self);
    return find(wanted, self, path, error);
}

gneiss_status gn_command_report(const gn_options *options, gneiss_error *error) {
    static const script report = {"GNEISS_REPORT", "report.py", "tools/report.py"};
    char path[SCRIPT_SIZE];
    GN_TRY(find_reader(options, &report, path, error));
    return start(options, (char *[]){(char *)python, path, (char *)options->target, NULL}, error);
}

gneiss_status gn_command_view(const gn_options *options, gneiss_error *error) {
    static const script view = {"GNEISS_VIEW", "view.py", "tools/view.py"};
    char path[SCRIPT_SIZE], *arguments[10] = {(char *)python, path};
    size_t n = 2;
    GN_TRY(find_reader(options, &view, path, error));
    const struct {
        const char *name, *value;
    } given[] = {{"--instants", options->instants}, {"--fields", options->fields}};
    for (size_t k = 0; k < 2; k++)
        if (given[k].value) {
            arguments[n++] = (char *)given[k].name;
            arguments[n++] = (char *)given[k].value;
        }
    if (options->paraview) arguments[n++] = "--paraview";
    arguments[n++] = "--";
    arguments[n] = (char *)options->target;
    return start(options, arguments, error);
}

static const script calibrate = {"GNEISS_CALIBRATE", "calibrate/__main__.py",
                                 "calibrate/__main__.py"};

gneiss_status gn_command_convert(const gn_options *options, gneiss_error *error) {
    static const script convert = {"GNEISS_CONVERT", "convert/__main__.py", "convert/__main__.py"};
    char self[SELF_SIZE], path[SCRIPT_SIZE], *arguments[GN_MAX_OVERRIDES + 8];
    size_t n = 0;
    find_self(self);
    GN_TRY(find(&convert, self, path, error));
    arguments[n++] = (char *)python;
    arguments[n++] = path;
    for (size_t k = 0; k < options->passed_count; k++) arguments[n++] = (char *)options->passed[k];
    if (options->force) arguments[n++] = "--force";
    if (options->quiet) arguments[n++] = "--quiet";
    arguments[n++] = "--";
    arguments[n++] = options->words[0];
    arguments[n++] = options->words[1];
    arguments[n] = NULL;
    return start(options, arguments, error);
}

gneiss_status gn_calibrate_schema(const gn_options *options, gneiss_error *error) {
    char self[SELF_SIZE], path[SCRIPT_SIZE];
    find_self(self);
    GN_TRY(find(&calibrate, self, path, error));
    return start(options, (char *[]){(char *)python, path, (char *)"--schema", NULL}, error);
}

gneiss_status gn_command_calibrate(const gn_options *options, gneiss_error *error) {
    enum { MOST = 16 };
    char self[SELF_SIZE], path[SCRIPT_SIZE], *arguments[MOST];
    const char *threads = NULL;
    for (size_t k = 0; k < options->override_count; k++) {
        if (strcmp(options->overrides[k].key, "run.threads") != 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "gneiss calibrate: expected values in the file of targets, found an "
                           "option for %s",
                           options->overrides[k].key);
        threads = options->overrides[k].value;
    }
    find_self(self);
    GN_TRY(find(&calibrate, self, path, error));
    size_t n = 0;
    const char *const fixed[] = {python, path, "--program", self};
    for (; n < 4; n++) arguments[n] = (char *)fixed[n];
    const struct {
        const char *name, *value;
    } given[] = {{"--out", options->out}, {"--seeds", options->seeds}, {"--threads", threads}};
    for (size_t k = 0; k < 3; k++)
        if (given[k].value) {
            arguments[n++] = (char *)given[k].name;
            arguments[n++] = (char *)given[k].value;
        }
    if (options->quiet) arguments[n++] = "--quiet";
    if (options->force) arguments[n++] = "--force";
    arguments[n++] = "--";
    arguments[n++] = (char *)options->target;
    arguments[n] = NULL;
    return start(options, arguments, error);
}
