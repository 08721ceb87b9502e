/* Loaded before the C library (LD_PRELOAD) by tests: calls fail on demand, and what reaches the
 * disk is recorded.
 *
 *   GNEISS_FAULT_ALLOC=N          allocation N (counted from 1) of the program itself fails
 *   GNEISS_FAULT_ALLOC=N+         it and all after it
 *   GNEISS_FAULT_COUNT=FILE       their number is written to FILE at exit
 *   GNEISS_FAULT_ALL=1            those of libraries count and fail as well
 *   GNEISS_FAULT_THREAD=N         thread N and all after it cannot be created
 *   GNEISS_FAULT_OPEN=TEXT:ERRNO  opening a file fails whose name holds TEXT
 *   GNEISS_FAULT_READ, _WRITE     the same for reading from it, writing into it
 *   GNEISS_RECORD=FILE            opens, writes, syncs, renames, removals, in order */
#define _GNU_SOURCE
#undef _FILE_OFFSET_BITS /* both open and open64 are defined here */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#pragma GCC visibility push(default) /* these replace the functions of the C library */

/* The allocator of glibc under its own names: dlsym would allocate. */
extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

static atomic_long allocations;
static uintptr_t program_begin, program_end;
static long fail_at;
static bool fail_on, everybody, begun;
static int record = -1;

/* --- allocations --- */

static int find_program(struct dl_phdr_info *info, size_t size, void *data) {
    (void)size, (void)data;
    for (int k = 0; k < info->dlpi_phnum; k++) {
        const ElfW(Phdr) *p = &info->dlpi_phdr[k];
        if (p->p_type != PT_LOAD || !(p->p_flags & PF_X)) continue;
        program_begin = info->dlpi_addr + p->p_vaddr;
        program_end = program_begin + p->p_memsz;
    }
    return 1; /* the program comes first */
}

static bool refused(void *caller) {
    uintptr_t from = (uintptr_t)caller;
    if (!begun || (!everybody && (from < program_begin || from >= program_end))) return false;
    long number = atomic_fetch_add(&allocations, 1) + 1;
    if (!fail_at || (fail_on ? number < fail_at : number != fail_at)) return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size) {
    return refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    return refused(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
    return refused(__builtin_return_address(0)) ? NULL : __libc_realloc(block, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return refused(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

static char *copy_text(const char *text, size_t length, void *caller) {
    char *copy = refused(caller) ? NULL : __libc_malloc(length + 1);
    if (!copy) return NULL;
    memcpy(copy, text, length);
    copy[length] = '\0';
    return copy;
}

char *strdup(const char *text) {
    return copy_text(text, strlen(text), __builtin_return_address(0));
}

char *strndup(const char *text, size_t most) {
    return copy_text(text, strnlen(text, most), __builtin_return_address(0));
}

/* --- files --- */

enum { FILES = 1024 };
static char *name_of[FILES]; /* [descriptor] name of the open file */
static long serial_of[FILES], serials;

/* errno to fail with, 0: none. */
static int fault(const char *variable, const char *name) {
    const char *rule = getenv(variable), *colon = rule ? strrchr(rule, ':') : NULL;
    if (!colon || !name) return 0;
    char text[256];
    snprintf(text, sizeof text, "%.*s", (int)(colon - rule), rule);
    return strstr(name, text) ? atoi(colon + 1) : 0;
}

__attribute__((format(printf, 1, 2))) static void note(const char *format, ...) {
    char line[8192];
    va_list args;
    if (record < 0) return;
    va_start(args, format);
    int length = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    syscall(SYS_write, record, line, (size_t)length);
}

static int open_as(const char *path, int flags, mode_t mode) {
    int code = fault("GNEISS_FAULT_OPEN", path);
    if (code) {
        errno = code;
        return -1;
    }
    int descriptor = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    if (descriptor < 0 || descriptor >= FILES) return descriptor;
    free(name_of[descriptor]);
    name_of[descriptor] = __libc_malloc(strlen(path) + 1);
    strcpy(name_of[descriptor], path);
    serial_of[descriptor] = ++serials;
    if ((flags & O_ACCMODE) != O_RDONLY || flags & O_DIRECTORY)
        note("open\t%ld\t%d\t%s\n", serials,
             flags & O_DIRECTORY ? 2
             : flags & O_TRUNC   ? 1
                                 : 0,
             path);
    return descriptor;
}

static mode_t mode_of(int flags, va_list args) {
    return flags & O_CREAT ? va_arg(args, mode_t) : 0;
}

int open(const char *path, int flags, ...) {
    va_list args;
    va_start(args, flags);
    mode_t mode = mode_of(flags, args);
    va_end(args);
    return open_as(path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    va_list args;
    va_start(args, flags);
    mode_t mode = mode_of(flags, args);
    va_end(args);
    return open_as(path, flags, mode);
}

static const char *known(int descriptor) {
    return descriptor >= 0 && descriptor < FILES ? name_of[descriptor] : NULL;
}

int close(int descriptor) {
    if (known(descriptor)) {
        free(name_of[descriptor]);
        name_of[descriptor] = NULL;
    }
    return (int)syscall(SYS_close, descriptor);
}

ssize_t read(int descriptor, void *to, size_t size) {
    int code = fault("GNEISS_FAULT_READ", known(descriptor));
    if (!code) return syscall(SYS_read, descriptor, to, size);
    errno = code;
    return -1;
}

ssize_t write(int descriptor, const void *from, size_t size) {
    int code = fault("GNEISS_FAULT_WRITE", known(descriptor));
    if (code) {
        errno = code;
        return -1;
    }
    ssize_t written = syscall(SYS_write, descriptor, from, size);
    if (written > 0 && known(descriptor) && record >= 0) {
        note("write\t%ld\t%zd\n", serial_of[descriptor], written);
        syscall(SYS_write, record, from, (size_t)written);
    }
    return written;
}

static int truncate_as(int descriptor, off_t size) {
    if (known(descriptor)) note("cut\t%ld\t%lld\n", serial_of[descriptor], (long long)size);
    return (int)syscall(SYS_ftruncate, descriptor, size);
}

int ftruncate(int descriptor, off_t size) {
    return truncate_as(descriptor, size);
}

int ftruncate64(int descriptor, off_t size) {
    return truncate_as(descriptor, size);
}

int fsync(int descriptor) {
    int result = (int)syscall(SYS_fsync, descriptor);
    if (known(descriptor)) note("sync\t%ld\n", serial_of[descriptor]);
    return result;
}

int rename(const char *from, const char *to) {
    int result = (int)syscall(SYS_rename, from, to);
    if (result == 0) note("rename\t%s\t%s\n", from, to);
    return result;
}

int unlink(const char *path) {
    int result = (int)syscall(SYS_unlink, path);
    if (result == 0) note("unlink\t%s\n", path);
    return result;
}

int mkdir(const char *path, mode_t mode) {
    int result = (int)syscall(SYS_mkdir, path, mode);
    if (result == 0) note("mkdir\t%s\n", path);
    return result;
}

/* --- threads --- */

int pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*start)(void *),
                   void *argument) {
    static atomic_long created;
    int (*next)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) = NULL;
    const char *limit = getenv("GNEISS_FAULT_THREAD");
    if (limit && atomic_fetch_add(&created, 1) + 1 >= atol(limit)) return EAGAIN;
    *(void **)&next = dlsym(RTLD_NEXT, "pthread_create");
    return next(thread, how, start, argument);
}

/* --- beginning and end --- */

__attribute__((constructor)) static void begin(void) {
    const char *at = getenv("GNEISS_FAULT_ALLOC"), *file = getenv("GNEISS_RECORD");
    dl_iterate_phdr(find_program, NULL);
    everybody = getenv("GNEISS_FAULT_ALL") != NULL;
    begun = true;
    if (at) {
        fail_at = atol(at);
        fail_on = strchr(at, '+') != NULL;
    }
    if (file)
        record = (int)syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC,
                              0666);
}

__attribute__((destructor)) static void end(void) {
    const char *file = getenv("GNEISS_FAULT_COUNT");
    FILE *out = file ? fopen(file, "w") : NULL;
    if (!out) return;
    fprintf(out, "%ld\n", atomic_load(&allocations));
    fclose(out);
}
