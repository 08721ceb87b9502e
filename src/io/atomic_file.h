/* A file that appears under its name whole or not at all: written beside it, synced, renamed. */
#ifndef GN_IO_ATOMIC_FILE_H
#define GN_IO_ATOMIC_FILE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_atomic_file {
    int descriptor;
    char *path;      /* own */
    char *temporary; /* own: path + ".tmp", ".2.tmp" while another process writes that */
} gn_atomic_file;

/* What a file withstands once it is committed, if the power fails. */
typedef enum gn_durability {
    GN_DURABLE, /* it is there: results, checkpoints */
    GN_SYNCED,  /* it is whole, but may be gone: snapshots, which a resumed run writes again */
    GN_RENAMED, /* it may be cut: what is made anew from other files */
} gn_durability;

/* Opens path.tmp and locks it (one left by a killed process is emptied). GNEISS_ERROR_IO: folder
 * missing, no permission, or `path` is there and is not a regular file. After a failure there is
 * nothing to free. */
gneiss_status gn_atomic_create(gn_atomic_file *file, const char *path, gneiss_error *error);

/* On failure (disk full) the caller still has to call gn_atomic_abort. */
gneiss_status gn_atomic_write(gn_atomic_file *file, const void *bytes, size_t size,
                              gneiss_error *error);

/* Syncs and renames the file, then syncs the folder, as far as asked for; frees. On failure the
 * temporary file is removed. */
gneiss_status gn_atomic_commit(gn_atomic_file *file, gn_durability durability, gneiss_error *error);

/* Removes the temporary file and frees; harmless after commit or a failed create. */
void gn_atomic_abort(gn_atomic_file *file);

/* Locks an open temporary file until it is closed. False: another process writes it, or `path` is
 * by now another file. Where the file system cannot lock, the file counts as one's own. */
bool gn_own_temporary(int descriptor, const char *path);

/* Syncs the folder that holds `path`: without it a power cut may undo a new name. Some file systems
 * cannot do it. */
void gn_sync_folder_of(const char *path);

/* printf into a malloc'ed string; NULL: out of memory. */
char *gn_text_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
