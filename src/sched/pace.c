#include "sched/pace.h"

static void begin_period(gn_pace *pace, bool trying) {
    pace->trying = trying;
    pace->rounds = 0;
    pace->seconds = pace->work = pace->waiting = 0.0;
}

static void lengthen(gn_pace *pace) {
    pace->interval = 2 * pace->interval < pace->longest ? 2 * pace->interval : pace->longest;
}

/* Fraction of the threads' time from which waiting is long. Threads always wait a little, since
 * shares are never equal. */
static const double waiting_enough = 0.3;

/* Tells whether a trial of all threads has already taken twice the time that all its rounds take on
 * one thread: on a busy machine a single round may take as long as a hundred. */
static bool is_lost(const gn_pace *pace) {
    return pace->single &&
           pace->seconds > 2.0 * pace->cost * pace->work / pace->rounds * pace->trial_rounds;
}

/* Tells whether one thread should be tried again. If threads wait for long, this requires that the
 * time since the last trial, which may have been disturbed, is that of sixteen trials, because all
 * threads together can be a hundred times as slow as one. */
static bool is_long(const gn_pace *pace) {
    return !pace->single && pace->single_seconds > 0.0 && pace->rounds >= pace->shortest &&
           pace->waiting > waiting_enough * pace->rounds &&
           pace->seconds > 16.0 * pace->single_seconds;
}

void gn_pace_note(gn_pace *pace, double seconds, double work, double waiting) {
    if (pace->most_threads < 2) return;
    pace->seconds += seconds;
    pace->work += work;
    pace->waiting += waiting;
    pace->rounds++;
    if (!pace->trying) {
        if (pace->rounds < pace->interval && !is_long(pace)) return;
        bool known = pace->waiting >= 0.0,
             idle = !known || pace->waiting > waiting_enough * pace->rounds;
        pace->cost = pace->seconds / pace->work;
        if (!pace->single && !idle) lengthen(pace);
        begin_period(pace, pace->single || idle);
        return;
    }
    if (pace->rounds < pace->trial_rounds && !is_lost(pace)) return;
    if (!pace->single) pace->single_seconds = pace->seconds;
    if (pace->seconds / pace->work < pace->cost) {
        pace->single = !pace->single;
        pace->interval = pace->shortest;
    } else {
        lengthen(pace);
    }
    begin_period(pace, false);
}
