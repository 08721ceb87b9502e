#include "scene/read.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *gn_find_file(const char *folder, const char *file, const char *in_folder, char *path) {
    if (!*file) return "no name";
    if (!folder) {
        memcpy(path, file, strlen(file) + 1);
        return NULL;
    }
    char joined[2 * GN_PATH_SIZE], resolved[PATH_MAX];
    const bool absolute = *file == '/';
    snprintf(joined, sizeof joined, "%s%s%s", absolute ? "" : folder, absolute ? "" : "/", file);
    struct stat status;
    size_t used = strlen(joined);
    if (in_folder && stat(joined, &status) == 0 && S_ISDIR(status.st_mode)) {
        snprintf(joined + used, sizeof joined - used, "/sweep.h5");
        bool sweep = access(joined, F_OK) == 0;
        snprintf(joined + used, sizeof joined - used, "/%s", in_folder);
        bool missing = access(joined, F_OK) && errno == ENOENT;
        if (missing && !sweep) {
            snprintf(joined + used, sizeof joined - used, "/" GN_PACKING_FILE);
            missing = access(joined, F_OK) && errno == ENOENT;
        }
        if (missing)
            return sweep ? "it is the folder of a sweep, expected that of one of its runs"
                         : "it is a folder without results.h5, which a run writes, and without "
                           "packing.h5, which gneiss pack writes";
    }
    if (!realpath(joined, resolved) || stat(resolved, &status)) return strerror(errno);
    if (S_ISDIR(status.st_mode)) return "it is a folder";
    if (access(resolved, R_OK)) return strerror(errno);
    if (strlen(resolved) >= GN_PATH_SIZE) return "the path is too long";
    memcpy(path, resolved, strlen(resolved) + 1);
    return NULL;
}
