/* How many threads are asked for in parallel regions. */
#ifndef GN_BASE_THREADS_H
#define GN_BASE_THREADS_H

#include <stdint.h>

/* More are not used by anything. */
enum { GN_THREADS_MAX = 1024 };

/* Threads for a `run.threads` of `asked` (0: one for each processor): no more than the OpenMP
 * library gives to anybody (OMP_THREAD_LIMIT). A parallel region may get fewer. */
int gn_threads_of(int64_t asked);

#endif
