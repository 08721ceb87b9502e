/* The number of threads of parallel regions. */
#ifndef GN_BASE_THREADS_H
#define GN_BASE_THREADS_H

#include <stdint.h>

/* The largest number of threads that is ever used. */
enum { GN_THREADS_MAX = 1024 };

/* Returns the number of threads for `run.threads` = `asked` (0: one for each processor), limited by
 * the OpenMP library (OMP_THREAD_LIMIT). A parallel region may get fewer. */
int gn_threads_of(int64_t asked);

#endif
