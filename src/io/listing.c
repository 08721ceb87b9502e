#include "io/listing.h"

#include "base/error.h"
#include "base/new.h"
#include "io/atomic_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

char *gn_step_path(const char *directory, const char *prefix, int64_t step, const char *suffix) {
    return gn_text_format("%s/%s_%010" PRId64 "%s", directory, prefix, step, suffix);
}

gneiss_status gn_step_remove(const char *directory, const char *prefix, int64_t step,
                             const char *suffix, gneiss_error *error) {
    GN_FREED char *path = gn_step_path(directory, prefix, step, suffix);
    if (!path) return gn_no_memory(error, "a name");
    if (unlink(path) == 0 || errno == ENOENT) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be removed: %s", path, strerror(errno));
}

/* Returns the step in `name`; -1: it does not have the form of gn_step_path. *rest is the suffix.
 */
static int64_t parse_step(const char *name, const char *prefix, const char **rest) {
    size_t length = strlen(prefix);
    if (strncmp(name, prefix, length) != 0 || name[length] != '_') return -1;
    const char *digits = name + length + 1;
    size_t count = strspn(digits, "0123456789");
    if (count < 10 || count > 18 || (count > 10 && digits[0] == '0')) return -1;
    *rest = digits + count;
    return strtoll(digits, NULL, 10);
}

static int compare_steps(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static gneiss_status push(int64_t **steps, size_t *count, int64_t step) {
    /* The array is enlarged at powers of two. */
    if ((*count & (*count - 1)) == 0) {
        size_t capacity = *count ? 2 * *count : 1;
        int64_t *more = realloc(*steps, capacity * sizeof *more);
        if (!more) return GNEISS_ERROR_MEMORY;
        *steps = more;
    }
    (*steps)[(*count)++] = step;
    return GNEISS_OK;
}

/* Tells whether a name ends with ".tmp" or ".2.tmp". */
static bool is_temporary(const char *ending) {
    size_t length = strlen(ending);
    return ending[0] == '.' && length >= 4 && strcmp(ending + length - 4, ".tmp") == 0;
}

/* Removes a temporary file unless a process still writes it. */
static void remove_abandoned(const char *directory, const char *name) {
    char *path = gn_text_format("%s/%s", directory, name);
    int descriptor = path ? open(path, O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK) : -1;
    if (descriptor >= 0) {
        if (gn_lock_temporary(descriptor, path)) (void)unlink(path);
        close(descriptor);
    }
    free(path);
}

static gneiss_status collect(DIR *folder, const char *directory, const char *prefix,
                             const char *suffix, int64_t **steps, size_t *count) {
    size_t suffix_length = strlen(suffix);
    for (struct dirent *entry; errno = 0, (entry = readdir(folder));) {
        const char *rest;
        int64_t step = parse_step(entry->d_name, prefix, &rest);
        if (step < 0 || strncmp(rest, suffix, suffix_length) != 0) continue;
        if (rest[suffix_length] == '\0')
            GN_TRY(push(steps, count, step));
        else if (is_temporary(rest + suffix_length))
            remove_abandoned(directory, entry->d_name);
    }
    return errno ? GNEISS_ERROR_IO : GNEISS_OK;
}

gneiss_status gn_step_list(const char *directory, const char *prefix, const char *suffix,
                           int64_t **steps, size_t *count, gneiss_error *error) {
    *steps = NULL;
    *count = 0;
    DIR *folder = opendir(directory);
    if (!folder)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be listed: %s", directory,
                       strerror(errno));
    gneiss_status status = collect(folder, directory, prefix, suffix, steps, count);
    int code = errno;
    closedir(folder);
    if (status == GNEISS_OK) {
        if (*count > 0) qsort(*steps, *count, sizeof **steps, compare_steps);
        return GNEISS_OK;
    }
    free(*steps);
    *steps = NULL;
    *count = 0;
    if (status == GNEISS_ERROR_MEMORY)
        return gn_fail(error, status, "%s: no memory to list it", directory);
    return gn_fail(error, status, "%s: cannot be listed: %s", directory, strerror(code));
}

/* ---- the checkpoints of a run: DIRECTORY/checkpoint_<step, 10 digits or more>.h5 ---- */

static const char prefix[] = "checkpoint", suffix[] = ".h5";

gneiss_status gn_checkpoint_path(const char *directory, int64_t step, char **path,
                                 gneiss_error *error) {
    *path = NULL;
    if (step < 0)
        return gn_fail(error, GNEISS_ERROR_INTERNAL, "checkpoint of step %" PRId64 " < 0", step);
    *path = gn_step_path(directory, prefix, step, suffix);
    return *path ? GNEISS_OK : gn_no_memory(error, "a name");
}

gneiss_status gn_checkpoint_list(const char *directory, int64_t *steps, size_t max, size_t *count,
                                 gneiss_error *error) {
    int64_t *all;
    size_t found;
    *count = 0;
    GN_TRY(gn_step_list(directory, prefix, suffix, &all, &found, error));
    *count = found < max ? found : max;
    for (size_t k = 0; k < *count; k++) steps[k] = all[found - 1 - k];
    free(all);
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_prune(const char *directory, size_t keep, gneiss_error *error) {
    int64_t *steps;
    size_t count;
    GN_TRY(gn_step_list(directory, prefix, suffix, &steps, &count, error));
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k + keep < count && status == GNEISS_OK; k++)
        status = gn_step_remove(directory, prefix, steps[k], suffix, error);
    free(steps);
    return status;
}

/* Returns an unused name, because a checkpoint of this step may have been damaged before. NULL: out
 * of memory. */
static char *free_name(const char *path) {
    char *name = gn_text_format("%s.damaged", path);
    for (int k = 2; name && access(name, F_OK) == 0; k++) {
        free(name);
        name = gn_text_format("%s.damaged-%d", path, k);
    }
    return name;
}

gneiss_status gn_checkpoint_set_aside(const char *directory, int64_t step, gneiss_error *error) {
    GN_FREED char *path = NULL;
    GN_TRY(gn_checkpoint_path(directory, step, &path, error));
    GN_FREED char *name = free_name(path);
    if (!name) return gn_no_memory(error, "a name");
    if (rename(path, name) == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be renamed to %s: %s", path, name,
                   strerror(errno));
}
