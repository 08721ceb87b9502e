#include "run/folder.h"

#include "base/new.h"
#include "io/h5.h"
#include "io/listing.h"
#include "io/snapshot.h"
#include "run/status.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Checks that names of files and prefixes of messages fit behind the path. */
static gneiss_status check_length(int length, const char *path, gneiss_error *error) {
    const int most = GN_PATH_SIZE - 64;
    if (length >= 0 && length < most) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.200s...: expected an output folder of less than %d characters, found %d",
                   path, most, length);
}

/* Refuses a dangling link, which can neither be created as a folder nor be written to. */
static gneiss_status check_link(const char *path, gneiss_error *error) {
    char target[256];
    struct stat there;
    ssize_t length = readlink(path, target, sizeof target);
    if (length < 0 || stat(path, &there) == 0 || errno != ENOENT) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected an output folder, found a symbolic link to '%.*s', which does not exist",
        path, (int)length, target);
}

gneiss_status gn_folder_choose(const gn_scene *scene, const char *wanted, char out[GN_PATH_SIZE],
                               gneiss_error *error) {
    if (!wanted || !*wanted) wanted = scene->output_directory;
    if (*wanted) {
        GN_TRY(check_length(snprintf(out, GN_PATH_SIZE, "%s", wanted), wanted, error));
        return check_link(out, error);
    }
    const char *slash = strrchr(scene->source, '/'), *name = slash ? slash + 1 : scene->source;
    const char *dot = strrchr(name, '.');
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    return check_length(snprintf(out, GN_PATH_SIZE, "runs/%.*s", length, name), name, error);
}

static gneiss_status lock_as(const char *directory, int kind, int *lock, gneiss_error *error) {
    *lock = 0;
    int descriptor = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    /* A missing folder is an error of the input, as a missing scene is. */
    bool absent = descriptor < 0 && (errno == ENOENT || errno == ENOTDIR);
    if (descriptor < 0)
        return gn_fail(error, absent ? GNEISS_ERROR_INPUT : GNEISS_ERROR_IO,
                       "%s: cannot be opened: %s", directory, strerror(errno));
    if (flock(descriptor, kind | LOCK_NB) == 0) {
        *lock = descriptor;
        return GNEISS_OK;
    }
    int code = errno;
    close(descriptor);
    if (code != EWOULDBLOCK) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected a folder of its own, found another run or packing that writes into it",
        directory);
}

gneiss_status gn_folder_lock(const char *directory, int *lock, gneiss_error *error) {
    return lock_as(directory, LOCK_EX, lock, error);
}

gneiss_status gn_folder_share(const char *directory, int *lock, gneiss_error *error) {
    return lock_as(directory, LOCK_SH, lock, error);
}

/* Compares files by identity; a file that no longer exists is compared by its name. */
static bool same_file(const char *a, const char *b) {
    char real_a[PATH_MAX], real_b[PATH_MAX];
    if (strcmp(a, b) == 0) return true;
    return realpath(a, real_a) && realpath(b, real_b) && strcmp(real_a, real_b) == 0;
}

static gneiss_status check_owner(const char *path, const char *directory, const gn_scene *scene,
                                 gneiss_error *error) {
    char *owner;
    gneiss_error reading = {0};
    gneiss_status status = gn_h5_peek_text(path, "/", "scene_file", &owner, &reading);
    if (status == GNEISS_ERROR_IO || status == GNEISS_ERROR_MEMORY)
        status = gn_fail(error, status, "%s", reading.message);
    else if (status != GNEISS_OK)
        status = gn_fail(error, GNEISS_ERROR_INPUT,
                         "%.300s: expected no results or those of %.300s, found an unreadable file "
                         "(%.500s); remove it or choose another folder with --out",
                         path, scene->source, reading.message);
    else if (!same_file(owner, scene->source))
        status = gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%.300s: expected no results or those of %.300s, found those of %.300s; remove them or "
            "choose another folder with --out",
            directory, scene->source, owner);
    free(owner);
    return status;
}

gneiss_status gn_folder_finished(const char *directory, double *seconds, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    gn_h5 *file = NULL;
    int64_t finished = 0;
    gneiss_error reading = {0};
    *seconds = 0.0;
    snprintf(path, sizeof path, "%s/results.h5", directory);
    if (access(path, F_OK) != 0) return GNEISS_OK;
    gneiss_status status = gn_h5_open(path, &file, &reading);
    if (status == GNEISS_OK)
        status = gn_h5_get_attribute_i64(file, "/", "finished", &finished, 1, &reading);
    if (status == GNEISS_OK)
        status = gn_h5_get_attribute_f64(file, "/", "seconds", seconds, 1, &reading);
    gn_h5_close(file);
    if (!finished || status != GNEISS_OK) *seconds = 0.0;
    /* A file without this information is refused later, when the folder is cleared. */
    return status == GNEISS_OK || status == GNEISS_ERROR_INPUT
               ? GNEISS_OK
               : gn_fail(error, status, "%s", reading.message);
}

static gneiss_status remove_file(const char *path, gneiss_error *error) {
    if (unlink(path) == 0 || errno == ENOENT) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be removed: %s", path, strerror(errno));
}

static gneiss_status remove_snapshots(const char *directory, const char *name,
                                      gneiss_error *error) {
    GN_FREED int64_t *steps = NULL;
    size_t count;
    GN_TRY(gn_step_list(directory, name, ".hdf", &steps, &count, error));
    for (size_t k = 0; k < count; k++) {
        GN_FREED char *path = gn_step_path(directory, name, steps[k], ".hdf");
        if (!path) return gn_no_memory(error, "a name");
        GN_TRY(remove_file(path, error));
    }
    return GNEISS_OK;
}

/* Each of these series has files NAME_<step>.hdf, and the first ones also NAME.hdf.series. */
static const char *const series[] = {"particles",        "bonds",           "elements",
                                     "bodies",           "contacts",        "failed_bonds",
                                     "failed_particles", "failed_elements", "failed_bodies",
                                     "failed_contacts"};
enum { SERIES = sizeof series / sizeof *series, LISTED = 5 };

/* Files that only the end of a run writes. */
static const char *const single[] = {"results.h5", "summary.json",      "report.html",
                                     "report.csv", "report_bursts.csv", "report_fragments.csv",
                                     "view.html",  "paraview_state.py", "run.vtkhdf"};
enum { SINGLE = sizeof single / sizeof *single };

/* --- foreign files --- */

static gneiss_status not_ours(const char *directory, const char *name, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.300s: expected an empty folder or one of an earlier run, found %.300s in it, "
                   "which the run would replace, and no results.h5 or checkpoint that gneiss "
                   "wrote: choose another folder with --out, or --force replaces it",
                   directory, name);
}

/* Checks that gneiss wrote a series. A run that was killed early leaves snapshots only, and a
 * packing has one snapshot. A snapshot names gneiss as its writer; the list of a series is accepted
 * if its snapshots are. */
static gneiss_status check_series(const char *directory, const char *name, bool listed,
                                  gneiss_error *error) {
    GN_FREED int64_t *steps = NULL;
    size_t count;
    GN_TRY(gn_step_list(directory, name, ".hdf", &steps, &count, error));
    for (size_t k = 0; k < count; k++) {
        GN_FREED char *path = gn_step_path(directory, name, steps[k], ".hdf");
        bool own = false;
        if (!path) return gn_no_memory(error, "a name");
        GN_TRY(gn_snapshot_is_own(path, &own, error));
        if (!own) return not_ours(directory, strrchr(path, '/') + 1, error);
    }
    if (!listed || count > 0) return GNEISS_OK;
    char list[64], path[GN_PATH_SIZE + 32];
    snprintf(list, sizeof list, "%s.hdf.series", name);
    snprintf(path, sizeof path, "%s/%s", directory, list);
    return access(path, F_OK) == 0 ? not_ours(directory, list, error) : GNEISS_OK;
}

/* Tells whether gneiss wrote a list: its first line ends with the version. */
static bool own_list(const char *path) {
    char line[256] = "";
    FILE *file = fopen(path, "r");
    bool own =
        file && fgets(line, sizeof line, file) && line[0] == '#' && strstr(line, "; gneiss ");
    if (file) fclose(file);
    return own;
}

static bool own_packing(const char *path) {
    char *kind = NULL;
    bool own = gn_h5_peek_text(path, "/", "kind", &kind, NULL) == GNEISS_OK &&
               strcmp(kind, "packing") == 0;
    free(kind);
    return own;
}

gneiss_status gn_folder_check_packing(const char *directory, gneiss_error *error) {
    static const char *const names[] = {GN_PACKING_FILE, "packing.txt"};
    struct stat there;
    char path[GN_PATH_SIZE + 32];
    for (size_t k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%.*s/%s", GN_PATH_SIZE, directory, names[k]);
        const bool file = stat(path, &there) == 0 && S_ISREG(there.st_mode);
        if (file && !(k ? own_list : own_packing)(path))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%.300s: expected an empty folder or one of an earlier packing, found "
                           "%s in it, which gneiss did not write: choose another folder with "
                           "--out, or --force replaces it",
                           directory, names[k]);
    }
    return check_series(directory, series[0], true, error);
}

/* Tells whether the folder holds a sweep: the folder of one of its runs is named by 16 hex digits
 * and contains the run's outcome or scene. */
bool gn_folder_holds_sweep(const char *directory) {
    static const char *const marks[] = {"outcome.json", "scene.yaml"};
    char path[GN_PATH_SIZE + 64], *kind = NULL;
    snprintf(path, sizeof path, "%s/sweep.h5", directory);
    if (access(path, F_OK) == 0) (void)gn_h5_peek_text(path, "/", "kind", &kind, NULL);
    bool found = kind && strcmp(kind, "sweep") == 0;
    free(kind);
    DIR *folder = found ? NULL : opendir(directory);
    for (struct dirent *entry; !found && folder && (entry = readdir(folder));) {
        const char *name = entry->d_name;
        if (strlen(name) != 16 || strspn(name, "0123456789abcdef") != 16) continue;
        for (size_t k = 0; k < 2; k++) {
            snprintf(path, sizeof path, "%s/%.16s/%s", directory, name, marks[k]);
            found |= access(path, F_OK) == 0;
        }
    }
    if (folder) closedir(folder);
    return found;
}

gneiss_status gn_folder_check_use(const char *directory, gn_folder_use use, gneiss_error *error) {
    static const char *const uses[] = {"one run", "several runs", "a packing"};
    char path[GN_PATH_SIZE + 32];
    size_t checkpoints = 0;
    int64_t step;
    const char *found = NULL;
    if (access(directory, F_OK) != 0) return GNEISS_OK;
    snprintf(path, sizeof path, "%s/results.h5", directory);
    if (use != GN_FOLDER_OF_RUNS && gn_folder_holds_sweep(directory)) found = "several runs";
    if (use != GN_FOLDER_OF_RUN && access(path, F_OK) == 0) found = "a run";
    if (use != GN_FOLDER_OF_RUN && !found) {
        GN_TRY(gn_checkpoint_list(directory, &step, 1, &checkpoints, error));
        if (checkpoints) found = "a run";
    }
    if (!found) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.300s: expected a folder for %s, found %s in it: choose another with --out",
                   directory, uses[use], found);
}

gneiss_status gn_folder_check(const char *directory, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    int64_t step;
    size_t checkpoints;
    struct stat there;
    if (stat(directory, &there) != 0 || !S_ISDIR(there.st_mode)) return GNEISS_OK;
    GN_TRY(gn_folder_check_use(directory, GN_FOLDER_OF_RUN, error));
    GN_TRY(gn_checkpoint_list(directory, &step, 1, &checkpoints, error));
    if (checkpoints > 0) return GNEISS_OK;
    for (size_t k = 0; k < SINGLE; k++) {
        snprintf(path, sizeof path, "%s/%s", directory, single[k]);
        if (access(path, F_OK) != 0) continue;
        return k == 0 ? GNEISS_OK : not_ours(directory, single[k], error);
    }
    for (size_t k = 0; k < SERIES; k++)
        GN_TRY(check_series(directory, series[k], k < LISTED, error));
    return gn_status_is_own(directory) ? GNEISS_OK : not_ours(directory, "status.json", error);
}

/* --- removal of earlier files --- */

gneiss_status gn_folder_clear(const char *directory, const gn_scene *scene, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    int64_t step;
    size_t checkpoints;
    snprintf(path, sizeof path, "%s/results.h5", directory);
    if (access(path, F_OK) == 0) GN_TRY(check_owner(path, directory, scene, error));
    GN_TRY(gn_checkpoint_list(directory, &step, 1, &checkpoints, error));
    if (checkpoints) {
        char *newest = NULL;
        GN_TRY(gn_checkpoint_path(directory, step, &newest, error));
        gneiss_status status =
            access(path, F_OK) == 0 ? GNEISS_OK : check_owner(newest, directory, scene, error);
        free(newest);
        GN_TRY(status);
    }
    GN_TRY(gn_checkpoint_prune(directory, 0, error));
    gn_status_path(directory, path);
    GN_TRY(remove_file(path, error));
    for (size_t k = 0; k < SINGLE; k++) {
        snprintf(path, sizeof path, "%s/%s", directory, single[k]);
        GN_TRY(remove_file(path, error));
    }
    for (size_t k = 0; k < SERIES; k++) {
        snprintf(path, sizeof path, "%s/%s.hdf.series", directory, series[k]);
        if (k < LISTED) GN_TRY(remove_file(path, error));
        GN_TRY(remove_snapshots(directory, series[k], error));
    }
    return GNEISS_OK;
}

/* --- resume --- */

/* The run that wrote a file: its scene file, and the scene as it was read. */
typedef struct origin {
    char *source, *scene;
} origin;

static bool read_origin(const char *path, origin *from) {
    gn_h5 *file = NULL;
    *from = (origin){0};
    if (access(path, F_OK) != 0 || gn_h5_open(path, &file, NULL) != GNEISS_OK) return false;
    bool read =
        gn_h5_get_attribute_text(file, "/", "scene_file", &from->source, NULL) == GNEISS_OK &&
        gn_h5_get_text(file, "scene", &from->scene, NULL) == GNEISS_OK;
    gn_h5_close(file);
    return read;
}

static void free_origin(origin *from) {
    free(from->source);
    free(from->scene);
}

/* Tells whether a resumed run may change a line of this section (check_overrides in run.c); the
 * seed is excluded, because it determines the model. */
static bool may_change(const char *section, const char *line) {
    static const char *const names[] = {"time:", "output:", "run:", "stages:"};
    if (strncmp(line, "  seed:", 7) == 0) return false;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (strncmp(section, names[k], strlen(names[k])) == 0) return true;
    return false;
}

/* Returns the first line at or after `line` that identifies the run; *section is its section. */
static const char *deciding_line(const char *line, const char **section) {
    for (; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        if (*line != ' ') *section = line;
        if (!may_change(*section, line)) break;
    }
    return line;
}

static bool same_scene(const char *a, const char *b) {
    const char *section_a = a, *section_b = b;
    for (;;) {
        a = deciding_line(a, &section_a);
        b = deciding_line(b, &section_b);
        const size_t length = strcspn(a, "\n");
        if (length != strcspn(b, "\n") || memcmp(a, b, length) != 0) return false;
        if (!*a) return true;
        a += length + (a[length] == '\n');
        b += length + (b[length] == '\n');
    }
}

static gneiss_status check_same(const char *path, const origin *own, const char *other,
                                gneiss_error *error) {
    origin found;
    gneiss_status status = GNEISS_OK;
    if (read_origin(other, &found)) {
        const bool source = strcmp(own->source, found.source) == 0;
        if (!source || !same_scene(own->scene, found.scene))
            status = gn_fail(error, GNEISS_ERROR_INPUT,
                             "%.400s: expected a checkpoint of the run that wrote %.400s, found "
                             "one of another run (%.200s, there %.200s%s): move the file of the "
                             "other run away",
                             path, other, own->source, found.source,
                             source ? " with other values of its keys" : "");
    }
    free_origin(&found);
    return status;
}

gneiss_status gn_folder_check_checkpoint(const char *directory, int64_t step, const int64_t *others,
                                         size_t count, gneiss_error *error) {
    char results[GN_PATH_SIZE + 32];
    GN_FREED char *path = NULL;
    GN_FREED_BY(free_origin) origin own = {0};
    snprintf(results, sizeof results, "%.*s/results.h5", GN_PATH_SIZE, directory);
    GN_TRY(gn_checkpoint_path(directory, step, &path, error));
    if (!read_origin(path, &own)) return GNEISS_OK;
    GN_TRY(check_same(path, &own, results, error));
    for (size_t k = 0; k < count; k++) {
        GN_FREED char *other = NULL;
        if (others[k] == step) continue;
        GN_TRY(gn_checkpoint_path(directory, others[k], &other, error));
        GN_TRY(check_same(path, &own, other, error));
    }
    return GNEISS_OK;
}
