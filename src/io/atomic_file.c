#include "io/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
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

/* Refuses a target that is not a regular file: renaming onto /dev/null or a pipe would replace it;
 * onto a folder it would fail only at the end. */
static gneiss_status check_target(const char *path, gneiss_error *error) {
    struct stat info;
    if (stat(path, &info) != 0 || S_ISREG(info.st_mode)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be written: expected a file, found %s", path,
                   S_ISDIR(info.st_mode) ? "a folder" : "a device or pipe");
}

bool gn_lock_temporary(int descriptor, const char *path) {
    struct stat mine, there;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    return fstat(descriptor, &mine) == 0 && lstat(path, &there) == 0 &&
           mine.st_dev == there.st_dev && mine.st_ino == there.st_ino && S_ISREG(mine.st_mode) &&
           mine.st_nlink == 1;
}

/* Opens an empty file under this name that no other process writes; returns -1 if it cannot (errno:
 * reason). A file left by a killed process is taken over. A file that another process holds, or has
 * just renamed, is not touched; nor is a link or pipe of that name. */
static int open_temporary(const char *name) {
    int descriptor = open_again(name, O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0 && (errno == ELOOP || errno == ENXIO)) errno = EWOULDBLOCK;
    if (descriptor < 0) return -1;
    if (!gn_lock_temporary(descriptor, name))
        errno = EWOULDBLOCK;
    else if (ftruncate(descriptor, 0) == 0)
        return descriptor;
    int code = errno;
    close(descriptor);
    errno = code;
    return -1;
}

enum { MOST_WRITERS = 64 }; /* number of processes that may write the same file at a time */

static gneiss_status begin_temporary(gn_atomic_file *file, gneiss_error *error) {
    for (int k = 1; k <= MOST_WRITERS; k++) {
        free(file->temporary);
        file->temporary = k == 1 ? gn_text_format("%s.tmp", file->path)
                                 : gn_text_format("%s.%d.tmp", file->path, k);
        if (!file->temporary)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for its name", file->path);
        file->descriptor = open_temporary(file->temporary);
        if (file->descriptor >= 0) return GNEISS_OK;
        if (errno != EWOULDBLOCK) break;
    }
    return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be created: %s", file->temporary,
                   errno == EWOULDBLOCK ? "others write it" : strerror(errno));
}

gneiss_status gn_atomic_create(gn_atomic_file *file, const char *path, gneiss_error *error) {
    *file = (gn_atomic_file){.descriptor = -1};
    GN_TRY(check_target(path, error));
    file->path = strdup(path);
    if (!file->path) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for its name", path);
    gneiss_status status = begin_temporary(file, error);
    if (status != GNEISS_OK) gn_atomic_abort(file);
    return status;
}

gneiss_status gn_atomic_write(gn_atomic_file *file, const void *bytes, size_t size,
                              gneiss_error *error) {
    const size_t most = (size_t)1 << 30; /* one write call transfers less than 2 GB */
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

void gn_sync_folder_of(const char *path) {
    char folder[PATH_MAX]; /* on the stack, because this must work without free memory */
    const char *slash = strrchr(path, '/');
    size_t length = !slash ? 0 : slash == path ? 1 : (size_t)(slash - path);
    if (length >= sizeof folder) return;
    memcpy(folder, length ? path : ".", length ? length : 1);
    folder[length ? length : 1] = '\0';
    int descriptor = open_again(folder, O_RDONLY | O_DIRECTORY);
    if (descriptor < 0) return;
    (void)fsync_again(descriptor);
    close(descriptor);
}

gneiss_status gn_atomic_commit(gn_atomic_file *file, gn_durability durability,
                               gneiss_error *error) {
    const char *failed = NULL;
    if (durability != GN_RENAMED && fsync_again(file->descriptor) != 0) failed = "flushed to disk";
    int code = errno;
    /* close may be the call that reports a full disk (network file systems). A copy of the
     * descriptor is closed, because the descriptor itself locks the temporary file until it has its
     * name. Linux frees a descriptor even if close fails, so that the call is not repeated. */
    int copy = dup(file->descriptor);
    if (copy >= 0 && close(copy) != 0 && errno != EINTR && !failed) {
        failed = "closed";
        code = errno;
    }
    if (!failed && rename(file->temporary, file->path) != 0) {
        failed = "renamed from its temporary name";
        code = errno;
    }
    gneiss_status status = GNEISS_OK;
    if (failed) {
        status = gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be %s: %s", file->path, failed,
                         strerror(code));
    } else {
        if (durability == GN_DURABLE) gn_sync_folder_of(file->path);
        close(file->descriptor);
        file->descriptor = -1;
    }
    gn_atomic_abort(file);
    return status;
}

void gn_atomic_abort(gn_atomic_file *file) {
    if (file->descriptor >= 0) {
        unlink(file->temporary);
        close(file->descriptor); /* releases the lock on the name */
    }
    free(file->path);
    free(file->temporary);
    *file = (gn_atomic_file){.descriptor = -1};
}
