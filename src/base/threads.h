/* The number of threads of parallel regions. */
#ifndef GN_BASE_THREADS_H
#define GN_BASE_THREADS_H

#include "base/error.h"

#include <stdint.h>

/* The largest number of threads that is ever used. */
enum { GN_THREADS_MAX = 1024 };

/* Returns the number of threads for `run.threads` = `asked` (0: one for each processor), limited by
 * the OpenMP library (OMP_THREAD_LIMIT). A parallel region may get fewer. */
int gn_threads_of(int64_t asked);

/* Returns the number of threads like gn_threads_of, but at most as many as the system allows this
 * process to have at once, because the OpenMP library ends the program if it cannot create one.
 * With `asked` 0 it is the largest available number; fewer threads than `asked` are an error:
 * GNEISS_ERROR_MEMORY if there is no memory for their stacks, else GNEISS_ERROR_INPUT. To be called
 * before the first parallel region. */
gneiss_status gn_threads_find(int64_t asked, int *threads, gneiss_error *error);

#endif
