#include "io/io.h"

#include "base/new.h"

#include "io/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The folder is looked for, because an automounter or a read-only parent may return EACCES or EROFS
 * for an existing one. */
static int make_one(const char *path, bool *made) {
    *made = mkdir(path, 0777) == 0;
    if (*made) {
        gn_sync_folder_of(path); /* without it, synced files in the folder may be lost */
        return 0;
    }
    int code = errno;
    struct stat info;
    if (stat(path, &info) != 0) return code;
    return S_ISDIR(info.st_mode) ? 0 : ENOTDIR;
}

/* Creates the parents of a path. *first is the length of the path of the first folder that did not
 * exist; 0: all existed. */
static gneiss_status make_parents(char *path, size_t *first, gneiss_error *error) {
    for (char *end = path + 1;; end++) {
        if (*end != '/' && *end != '\0') continue;
        char saved = *end;
        bool made;
        *end = '\0';
        int code = make_one(path, &made);
        if (made && !*first) *first = (size_t)(end - path);
        if (code)
            return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be made a folder: %s", path,
                           code == ENOTDIR ? "there is a file of this name" : strerror(code));
        *end = saved;
        if (saved == '\0') return GNEISS_OK;
    }
}

/* Removes folders, innermost first; those that are no longer empty stay. */
static void remove_parents(char *path, size_t first) {
    for (size_t length = strlen(path); first && length >= first; length--) {
        if (path[length] != '\0' && path[length] != '/') continue;
        path[length] = '\0';
        (void)rmdir(path);
    }
}

/* Tests whether a folder is writable by creating a file in it: access() does not detect quotas,
 * missing inodes, and network file systems that map the user. */
static gneiss_status check_writable(const char *path, gneiss_error *error) {
    GN_FREED char *probe = gn_text_format("%s/.gneiss-XXXXXX", path);
    if (!probe) return gn_no_memory(error, path);
    int descriptor = mkstemp(probe);
    if (descriptor < 0)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: nothing can be written there: %s", path,
                       strerror(errno));
    close(descriptor);
    unlink(probe);
    return GNEISS_OK;
}

gneiss_status gn_make_directory(const char *path, gneiss_error *error) {
    if (path[0] == '\0')
        return gn_fail(error, GNEISS_ERROR_INPUT, "expected the name of a folder, found nothing");
    char *copy = strdup(path);
    if (!copy) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for its name", path);
    size_t first = 0;
    gneiss_status status = make_parents(copy, &first, error);
    if (status == GNEISS_OK) status = check_writable(path, error);
    if (status != GNEISS_OK) remove_parents(copy, first);
    free(copy);
    return status;
}

gneiss_status gn_write_text_file(const char *path, const char *text, gn_durability durability,
                                 gneiss_error *error) {
    gn_atomic_file file;
    GN_TRY(gn_atomic_create(&file, path, error));
    gneiss_status status = gn_atomic_write(&file, text, strlen(text), error);
    if (status == GNEISS_OK) return gn_atomic_commit(&file, durability, error);
    gn_atomic_abort(&file);
    return status;
}

static int open_to_read(const char *path) {
    int descriptor;
    do {
        descriptor = open(path, O_RDONLY | O_CLOEXEC);
    } while (descriptor < 0 && errno == EINTR);
    return descriptor;
}

/* Reads to the end, but at most limit + 1 bytes; errno is set on failure. */
static char *read_all(int descriptor, size_t limit, size_t *size) {
    size_t capacity = 4096, used = 0;
    char *text = malloc(capacity);
    while (text && used <= limit) {
        if (used + 1 >= capacity) {
            capacity *= 2;
            char *more = realloc(text, capacity);
            if (!more) break;
            text = more;
        }
        size_t most = capacity - 1 - used;
        if (most > limit + 1 - used) most = limit + 1 - used;
        ssize_t got = read(descriptor, text + used, most);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) break;
        if (got == 0 || (used += (size_t)got) > limit) {
            text[used] = '\0';
            *size = used;
            return text;
        }
    }
    int code = text && errno ? errno : ENOMEM;
    free(text);
    errno = code;
    return NULL;
}

gneiss_status gn_read_text_file(const char *path, size_t limit, char **text, gneiss_error *error) {
    *text = NULL;
    int descriptor = open_to_read(path);
    if (descriptor < 0)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    size_t size = 0;
    char *read_text = read_all(descriptor, limit, &size);
    int code = errno;
    close(descriptor);
    if (!read_text && code == EISDIR)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a file, found a folder", path);
    if (!read_text && code == ENOMEM)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read it", path);
    if (!read_text)
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be read: %s", path, strerror(code));
    gneiss_status status = GNEISS_OK;
    if (size > limit)
        status = gn_fail(error, GNEISS_ERROR_INPUT,
                         "%s: expected a text of at most %zu bytes, found more", path, limit);
    else if (strlen(read_text) != size)
        status = gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected text, found a zero byte at %zu",
                         path, strlen(read_text));
    if (status == GNEISS_OK)
        *text = read_text;
    else
        free(read_text);
    return status;
}

static gneiss_status read_bytes(int descriptor, const char *path, char *bytes, size_t size,
                                gneiss_error *error) {
    for (size_t used = 0; used < size;) {
        size_t most = (size_t)1 << 30, left = size - used; /* one call transfers less than 2 GB */
        ssize_t got = read(descriptor, bytes + used, left < most ? left : most);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
        if (got == 0)
            return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected %zu bytes, found %zu", path,
                           size, used);
        used += (size_t)got;
    }
    return GNEISS_OK;
}

gneiss_status gn_read_bytes(const char *path, void **bytes, size_t *size, gneiss_error *error) {
    struct stat info;
    *bytes = NULL;
    int descriptor = open_to_read(path);
    if (descriptor < 0 || fstat(descriptor, &info) != 0) {
        int code = errno;
        if (descriptor >= 0) close(descriptor);
        return gn_fail(error, GNEISS_ERROR_IO, "%s: cannot be opened: %s", path, strerror(code));
    }
    gneiss_status status = GNEISS_OK;
    size_t found = S_ISREG(info.st_mode) ? (size_t)info.st_size : 0;
    void *block = found ? malloc(found) : NULL;
    if (!found)
        status = gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a file with contents", path);
    else if (!block)
        status =
            gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory to read %zu bytes", path, found);
    else
        status = read_bytes(descriptor, path, block, found, error);
    close(descriptor);
    if (status != GNEISS_OK) {
        free(block);
        return status;
    }
    *bytes = block;
    *size = found;
    return GNEISS_OK;
}

gneiss_status gn_text_open(char **text, size_t *size, FILE **out, const char *what,
                           gneiss_error *error) {
    *out = open_memstream(text, size);
    return *out ? GNEISS_OK : gn_no_memory(error, what);
}

gneiss_status gn_text_close(FILE *out, const char *what, gneiss_error *error) {
    const bool failed = ferror(out) != 0;
    return fclose(out) == 0 && !failed ? GNEISS_OK : gn_no_memory(error, what);
}
