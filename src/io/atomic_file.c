#include "io/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char *gn_text_format(const char *format, ...) {
    va_list args;
    va_start(args, format);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length < 0) return NULL;
    char *text = malloc((size_t)length + 1);
    if (!text) return NULL;
    va_start(args, format);
    vsnprintf(text, (size_t)length + 1, format, args);
    va_end(args);
    return text;
}

static int open_again(const char *path, int flags) {
    int descriptor;
    do {
        descriptor = open(path, flags | O_CLOEXEC, 0666);
    } while (descriptor < 0 && errno == EINTR);
    return descriptor;
}

static int fsync_again(int descriptor) {
    int result;
    do {
        result = fsync(descriptor);
    } while (result < 0 && errno == EINTR);
    return result;
}

/* Renaming onto /dev/null or a pipe would replace it; a folder would only fail at the very end. */
static gneiss_status check_target(const char *path, gneiss_error *error) {
    struct stat info;
    if (stat(path, &info) != 0 || S_ISREG(info.st_mode)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be written: expected a file, found %s", path,
                   S_ISDIR(info.st_mode) ? "a folder" : "a device or pipe");
}

gneiss_status gn_atomic_create(gn_atomic_file *file, const char *path, gneiss_error *error) {
    *file = (gn_atomic_file){.descriptor = -1};
    GN_TRY(check_target(path, error));
    file->path = strdup(path);
    file->temporary = gn_text_format("%s.tmp", path);
    if (!file->path || !file->temporary) {
        gn_atomic_abort(file);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for its name", path);
    }
    file->descriptor = open_again(file->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW);
    if (file->descriptor < 0) {
        gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be created: %s", file->temporary,
                strerror(errno));
        gn_atomic_abort(file);
        return GNEISS_ERROR_IO;
    }
    return GNEISS_OK;
}

gneiss_status gn_atomic_write(gn_atomic_file *file, const void *bytes, size_t size,
                              gneiss_error *error) {
    const size_t most = (size_t)1 << 30; /* one write call moves less than 2 GB */
    const char *from = bytes;
    while (size > 0) {
        ssize_t written = write(file->descriptor, from, size < most ? size : most);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be written: %s", file->path,
                           strerror(errno));
        from += written;
        size -= (size_t)written;
    }
    return GNEISS_OK;
}

/* Without this a power cut after the rename may bring the old name back. Some file systems cannot
 * do it. */
static void sync_folder(const char *path) {
    const char *slash = strrchr(path, '/');
    char *folder = !slash          ? strdup(".")
                   : slash == path ? strdup("/")
                                   : strndup(path, (size_t)(slash - path));
    if (!folder) return;
    int descriptor = open_again(folder, O_RDONLY | O_DIRECTORY);
    if (descriptor >= 0) {
        (void)fsync_again(descriptor);
        close(descriptor);
    }
    free(folder);
}

gneiss_status gn_atomic_commit(gn_atomic_file *file, gn_durability durability,
                               gneiss_error *error) {
    const char *failed = NULL;
    if (durability != GN_RENAMED && fsync_again(file->descriptor) != 0) failed = "flushed to disk";
    int code = errno;
    /* close may be the call that reports a full disk (network file systems); Linux frees the
     * descriptor even then, so it is not repeated. */
    if (close(file->descriptor) != 0 && errno != EINTR && !failed) {
        failed = "closed";
        code = errno;
    }
    file->descriptor = -1;
    if (!failed && rename(file->temporary, file->path) != 0) {
        failed = "renamed from its temporary name";
        code = errno;
    }
    gneiss_status status = GNEISS_OK;
    if (failed) {
        unlink(file->temporary);
        status = gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be %s: %s", file->path, failed,
                         strerror(code));
    } else if (durability == GN_DURABLE) {
        sync_folder(file->path);
    }
    gn_atomic_abort(file);
    return status;
}

void gn_atomic_abort(gn_atomic_file *file) {
    if (file->descriptor >= 0) {
        close(file->descriptor);
        if (file->temporary) unlink(file->temporary);
    }
    free(file->path);
    free(file->temporary);
    *file = (gn_atomic_file){.descriptor = -1};
}
