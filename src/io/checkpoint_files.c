#include "io/checkpoint_files.h"

#include "io/atomic_file.h"
#include "io/listing.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char prefix[] = "checkpoint", suffix[] = ".h5";

gneiss_status gn_checkpoint_path(const char *directory, int64_t step, char **path,
                                 gneiss_error *error) {
    *path = NULL;
    if (step < 0) {
        gn_fail(error, GNEISS_ERROR_INTERNAL, "checkpoint of step %" PRId64 " < 0", step);
        return GNEISS_ERROR_INTERNAL;
    }
    *path = gn_step_path(directory, prefix, step, suffix);
    if (*path) return GNEISS_OK;
    gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for a name", directory);
    return GNEISS_ERROR_MEMORY;
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

/* Returns an unused name, as a checkpoint of this step may have been damaged before. NULL: out of
 * memory. */
static char *free_name(const char *path) {
    char *name = gn_text_format("%s.damaged", path);
    for (int k = 2; name && access(name, F_OK) == 0; k++) {
        free(name);
        name = gn_text_format("%s.damaged-%d", path, k);
    }
    return name;
}

gneiss_status gn_checkpoint_set_aside(const char *directory, int64_t step, gneiss_error *error) {
    char *path;
    GN_TRY(gn_checkpoint_path(directory, step, &path, error));
    char *name = free_name(path);
    gneiss_status status = GNEISS_OK;
    if (!name)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for a name", directory);
    else if (rename(path, name) != 0)
        status = gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be renamed to %s: %s", path, name,
                         strerror(errno));
    free(name);
    free(path);
    return status;
}
