/* Files that appear under their names completely or not at all: written to a temporary file in the
 * same folder, synced, renamed. */
#ifndef GN_IO_ATOMIC_FILE_H
#define GN_IO_ATOMIC_FILE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_atomic_file {
    int descriptor;
    char *path;      /* owned */
    char *temporary; /* owned: path + ".tmp", or ".2.tmp" while another process writes that file */
} gn_atomic_file;

/* State of a committed file after a power failure. */
typedef enum gn_durability {
    GN_DURABLE, /* present; for results and checkpoints */
    GN_SYNCED,  /* complete, but possibly absent; for snapshots, which a resumed run writes again */
    GN_RENAMED, /* possibly truncated; for files that are regenerated from others */
} gn_durability;

/* Opens path.tmp and locks it (a file left by a killed process is emptied). GNEISS_ERROR_IO: the
 * folder is missing, permission is lacking, or `path` exists and is not a regular file. After a
 * failure there is nothing to free. */
gneiss_status gn_atomic_create(gn_atomic_file *file, const char *path, gneiss_error *error);

/* Appends bytes. On failure (disk full) the caller still has to call gn_atomic_abort. */
gneiss_status gn_atomic_write(gn_atomic_file *file, const void *bytes, size_t size,
                              gneiss_error *error);

/* Syncs and renames the file, then syncs the folder, as `durability` requires; frees. On failure
 * the temporary file is removed. */
gneiss_status gn_atomic_commit(gn_atomic_file *file, gn_durability durability, gneiss_error *error);

/* Removes the temporary file and frees; no effect after commit or a failed create. */
void gn_atomic_abort(gn_atomic_file *file);

/* Locks an open temporary file until it is closed. Returns false if another process writes it, or
 * `path` is another file by now. On file systems without locks the file counts as locked. */
bool gn_lock_temporary(int descriptor, const char *path);

/* Syncs the folder that contains `path`; otherwise a power failure may undo a new name. Some file
 * systems cannot do this. */
void gn_sync_folder_of(const char *path);

/* Formats into a malloc'ed string; NULL: out of memory. */
char *gn_text_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
