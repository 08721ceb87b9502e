/* Files of one run with a step in their names: PREFIX_<step, 10 digits or more>SUFFIX. */
#ifndef GN_IO_LISTING_H
#define GN_IO_LISTING_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Returns DIRECTORY/PREFIX_<step>SUFFIX, malloc'ed; NULL: out of memory. */
char *gn_step_path(const char *directory, const char *prefix, int64_t step, const char *suffix);
/* Removes that file; it may be missing. */
gneiss_status gn_step_remove(const char *directory, const char *prefix, int64_t step,
                             const char *suffix, gneiss_error *error);

/* Lists the steps on disk in ascending order; *steps is malloc'ed. Temporary files of the same form
 * that no process holds, as a run killed while writing leaves them, are removed. */
gneiss_status gn_step_list(const char *directory, const char *prefix, const char *suffix,
                           int64_t **steps, size_t *count, gneiss_error *error);

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
 * inspection, but not listed any more. */
gneiss_status gn_checkpoint_set_aside(const char *directory, int64_t step, gneiss_error *error);

#endif
