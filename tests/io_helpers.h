/* Helpers of the tests of src/io: a folder of their own, and calls that must succeed or fail in a
 * stated way. */
#ifndef GN_TESTS_IO_HELPERS_H
#define GN_TESTS_IO_HELPERS_H

#include "test.h"

#include "base/error.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <unistd.h>

/* A folder of the test's own and a path in it. */
typedef struct fixture {
    char dir[64], path[96];
} fixture;

static inline int make_fixture(void **state, const char *file) {
    fixture *f = calloc(1, sizeof *f);
    strcpy(f->dir, "/tmp/gneiss-io-XXXXXX");
    if (!mkdtemp(f->dir)) return -1;
    snprintf(f->path, sizeof f->path, "%s/%s", f->dir, file);
    *state = f;
    return 0;
}

/* Number of entries; with `remove_them` the folder is emptied, folders in it too. */
static inline int entries(const char *dir, bool remove_them) {
    int count = 0;
    DIR *d = opendir(dir);
    for (struct dirent *e; (e = readdir(d));) {
        if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
        count++;
        if (!remove_them || unlinkat(dirfd(d), e->d_name, 0) == 0) continue;
        char inner[512];
        if (snprintf(inner, sizeof inner, "%s/%s", dir, e->d_name) >= (int)sizeof inner) continue;
        entries(inner, true);
        rmdir(inner);
    }
    closedir(d);
    return count;
}

static inline int teardown(void **state) {
    fixture *f = *state;
    entries(f->dir, true);
    rmdir(f->dir);
    free(f);
    return 0;
}

#define ok(call)                                                                                   \
    do {                                                                                           \
        gneiss_error ok_error = {0};                                                               \
        gneiss_error *error = &ok_error;                                                           \
        if ((call) != GNEISS_OK) fail_msg("%s: %s", #call, ok_error.message);                      \
    } while (0)

/* The call fails with this status and its message has this text. */
#define fails(call, wanted, text)                                                                  \
    do {                                                                                           \
        gneiss_error fails_error = {0};                                                            \
        gneiss_error *error = &fails_error;                                                        \
        int fails_status = (call);                                                                 \
        if (fails_status != (wanted) || !strstr(fails_error.message, text))                        \
            fail_msg("%s: status %d, message '%s', expected '%s'", #call, fails_status,            \
                     fails_error.message, text);                                                   \
    } while (0)

#endif
