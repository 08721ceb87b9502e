/* All threads or one: whichever is cheaper at present. On a machine that is busy with other things
 * threads that meet at barriers many thousand times a second can be many times slower than one
 * thread alone, because each waits for one that is not running. Only for work whose result does not
 * depend on the number of threads. */
#ifndef GN_SCHED_PACE_H
#define GN_SCHED_PACE_H

#include <stdbool.h>

typedef struct gn_pace {
    int all;               /* threads that may be used */
    int trial;             /* rounds of a trial of the other way */
    int shortest, longest; /* rounds between two trials; doubled as long as trials change nothing */
    bool one;              /* the way taken outside of trials is one thread */
    bool trying;
    int rounds, interval;          /* of the present period: done, and its length */
    double seconds, work, waiting; /* sums over its rounds */
    double cost;                   /* s per work of the last period that was no trial */
    double alone;                  /* s, of the last trial of one thread; 0: none yet */
} gn_pace;

static inline gn_pace gn_pace_start(int all, int trial, int shortest, int longest) {
    return (gn_pace){
        .all = all, .trial = trial, .shortest = shortest, .longest = longest, .interval = shortest};
}

/* Threads for the next round. */
static inline int gn_pace_threads(const gn_pace *pace) {
    return pace->one != pace->trying ? 1 : pace->all;
}

/* After a round: its wall time, how much work it was (any unit), and which part of the threads'
 * time was spent waiting (< 0: not known). Trials of one thread are left out while all wait
 * little. */
void gn_pace_note(gn_pace *pace, double seconds, double work, double waiting);

#endif
