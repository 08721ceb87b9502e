/* Parallel regions that get fewer threads than requested, as under OMP_THREAD_LIMIT. */
#ifndef GN_TESTS_SMALLER_TEAM_H
#define GN_TESTS_SMALLER_TEAM_H

/* Calls `act` where no parallel region has more than `most` threads. */
static inline void in_teams_of(int most, void (*act)(void *context), void *context) {
#pragma omp teams num_teams(1) thread_limit(most)
    act(context);
}

/* Calls `act` within a region of others, so that every region that it begins has one thread; the
 * limit is not lowered. */
static inline void in_a_region(void (*act)(void *context), void *context) {
#pragma omp parallel num_threads(2)
#pragma omp single
    act(context);
}

#endif
