/* Clocks for measurements; results never depend on them. */
#ifndef GN_BASE_TIMER_H
#define GN_BASE_TIMER_H

#include <time.h>

/* Returns the seconds of a monotonic clock. */
static inline double gn_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the processor time of the calling thread, s; it excludes time when the thread does not
 * run. */
static inline double gn_thread_time(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the processor time of all threads of the process, s. */
static inline double gn_process_time(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
