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

/* Lists the steps on disk, ascending; *steps is malloc'ed. Temporary files of the same form that no
 * process holds (of a run killed while writing) are removed. */
gneiss_status gn_step_list(const char *directory, const char *prefix, const char *suffix,
                           int64_t **steps, size_t *count, gneiss_error *error);

#endif
