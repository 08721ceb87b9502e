#include "run/status.h"

#include "base/version.h"
#include "io/atomic_file.h"
#include "io/io.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

void gn_status_path(const char *directory, char path[GN_PATH_SIZE + 32]) {
    snprintf(path, GN_PATH_SIZE + 32, "%.*s/status.json", GN_PATH_SIZE, directory);
}

bool gn_status_is_own(const char *directory) {
    char path[GN_PATH_SIZE + 32], first[64] = "";
    gn_status_path(directory, path);
    FILE *file = fopen(path, "r");
    if (!file) return true;
    const size_t size = fread(first, 1, sizeof first - 1, file);
    fclose(file);
    first[size] = '\0';
    return strstr(first, "\"gneiss\"") != NULL;
}

/* Field 22 of /proc/PID/stat; the name of the program, field 2, may contain blanks. */
int64_t gn_process_start(int64_t pid) {
    char path[64], text[1024];
    snprintf(path, sizeof path, "/proc/%lld/stat", (long long)pid);
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    const size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[size] = '\0';
    const char *at = strrchr(text, ')');
    for (int field = 2; at && field < 22; field++) at = strchr(at + 1, ' ');
    return at ? strtoll(at, NULL, 10) : 0;
}

static const char *state_of(const gn_progress *progress, gneiss_status code) {
    return code == GNEISS_INTERRUPTED ? "stopped"
           : code != GNEISS_OK        ? "failed"
           : progress->finished       ? "finished"
                                      : "running";
}

static void put_progress(gn_json *json, const gn_progress *p) {
    const bool known = isfinite(p->eta) && p->seconds + p->eta > 0.0;
    const double share = p->finished  ? 1.0
                         : known      ? p->seconds / (p->seconds + p->eta)
                         : p->end > 0 ? p->time / p->end
                                      : 0.0;
    gn_json_integer(json, "step", p->step);
    GN_JSON_NUMBERS(json, {"time", p->time}, {"end", p->end}, {"share", share},
                    {"seconds", p->seconds}, {"seconds_left", p->finished ? 0.0 : p->eta});
    gn_json_bool(json, "at_most", p->eta_at_most && !p->finished);
    if (p->stages) gn_json_text(json, "stage", p->stage);
}

static void put_process(gn_json *json) {
    char host[256] = "", now[32];
    const time_t seconds = time(NULL);
    struct tm utc;
    gmtime_r(&seconds, &utc);
    strftime(now, sizeof now, "%Y-%m-%dT%H:%M:%SZ", &utc);
    (void)gethostname(host, sizeof host - 1);
    gn_json_integer(json, "pid", getpid());
    gn_json_integer(json, "pid_start", gn_process_start(getpid()));
    gn_json_text(json, "host", host);
    gn_json_text(json, "heartbeat", now);
    gn_json_integer(json, "heartbeat_unix", (int64_t)seconds);
    gn_json_integer(json, "heartbeat_every", GN_STATUS_EVERY);
}

void gn_status_write(const gn_run *run, gneiss_status code, const char *message) {
    if (!gn_rank_writes()) return;
    const gn_progress progress = gn_run_progress(run);
    char path[GN_PATH_SIZE + 32];
    gn_atomic_file file;
    gn_json *json = gn_json_begin();
    gn_json_text(json, "program", "gneiss");
    gn_json_text(json, "version", gn_version());
    gn_json_text(json, "state", state_of(&progress, code));
    gn_json_integer(json, "code", code);
    gn_json_text(json, "message", code == GNEISS_OK ? "" : message);
    put_progress(json, &progress);
    put_process(json);
    char *text = gn_json_finish(json, true);
    gn_status_path(run->directory, path);
    if (text && gn_atomic_create(&file, path, NULL) == GNEISS_OK) {
        if (gn_atomic_write(&file, text, strlen(text), NULL) == GNEISS_OK)
            (void)gn_atomic_commit(&file, GN_RENAMED, NULL);
        else
            gn_atomic_abort(&file);
    }
    free(text);
}
