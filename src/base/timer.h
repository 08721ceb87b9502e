/* Wall clock for measuring; never decides what is computed. */
#ifndef GN_BASE_TIMER_H
#define GN_BASE_TIMER_H

#include <time.h>

/* Seconds on a clock that only goes forward. */
static inline double gn_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* s of a processor that the calling thread has had: stands still while another program has it. */
static inline double gn_thread_time(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* s of processors that all threads of the process have had so far. */
static inline double gn_process_time(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
