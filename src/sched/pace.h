/* The choice between all threads and one, whichever is cheaper at present. On a busy machine,
 * threads that meet at barriers many thousand times a second can be much slower than one thread
 * alone, because each waits for one that is not running. Results must not depend on the number of
 * threads. */
#ifndef GN_SCHED_PACE_H
#define GN_SCHED_PACE_H

#include <stdbool.h>

typedef struct gn_pace {
    int most_threads;      /* largest number of threads */
    int trial_rounds;      /* rounds of a trial of the alternative */
    int shortest, longest; /* rounds between two trials; doubled while trials change nothing */
    bool single;           /* one thread is used outside of trials */
    bool trying;
    int rounds, interval;          /* number of rounds done in the present period, and its length */
    double seconds, work, waiting; /* sums over the rounds of the period */
    double cost;                   /* s per unit of work in the last period that was no trial */
    double single_seconds;         /* s of the last trial of one thread; 0: none yet */
} gn_pace;

static inline gn_pace gn_pace_start(int all, int trial, int shortest, int longest) {
    return (gn_pace){.most_threads = all,
                     .trial_rounds = trial,
                     .shortest = shortest,
                     .longest = longest,
                     .interval = shortest};
}

/* Returns the number of threads of the next round. */
static inline int gn_pace_threads(const gn_pace *pace) {
    return pace->single != pace->trying ? 1 : pace->most_threads;
}

/* Records a round: its wall time, its amount of work (any unit), and the fraction of the threads'
 * time spent waiting (< 0: unknown). One thread is not tried while threads wait little. */
void gn_pace_note(gn_pace *pace, double seconds, double work, double waiting);

#endif
