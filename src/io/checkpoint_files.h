/* The checkpoints of a run: DIRECTORY/checkpoint_<step, 10 digits or more>.h5. */
#ifndef GN_IO_CHECKPOINT_FILES_H
#define GN_IO_CHECKPOINT_FILES_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Makes the name of a checkpoint; *path is malloc'ed. step >= 0. */
gneiss_status gn_checkpoint_path(const char *directory, int64_t step, char **path,
                                 gneiss_error *error);

/* Lists the steps of up to `max` checkpoints, newest first, and their number in *count. Names are
 * examined, not contents. Temporary files that no process writes are removed. */
gneiss_status gn_checkpoint_list(const char *directory, int64_t *steps, size_t max, size_t *count,
                                 gneiss_error *error);

/* Removes all but the newest `keep` checkpoints. */
gneiss_status gn_checkpoint_prune(const char *directory, size_t keep, gneiss_error *error);

/* Appends ".damaged" to the name (".damaged-2", ... if that exists): the file is kept for
 * inspection, but no longer listed. */
gneiss_status gn_checkpoint_set_aside(const char *directory, int64_t step, gneiss_error *error);

#endif
