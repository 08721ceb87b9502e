#include "sched/pace.h"

static void begin_period(gn_pace *p, bool trying) {
    p->trying = trying;
    p->rounds = 0;
    p->seconds = p->work = p->waiting = 0.0;
}

static void lengthen(gn_pace *p) {
    p->interval = 2 * p->interval < p->longest ? 2 * p->interval : p->longest;
}

/* Threads always wait a little, since shares are never equal. */
static const double waiting_enough = 0.3;

/* Tells whether a trial of all threads has already cost twice what all its rounds would cost on one
 * thread: on a busy machine a single round may take as long as a hundred. */
static bool is_lost(const gn_pace *p) {
    return p->one && p->seconds > 2.0 * p->cost * p->work / p->rounds * p->trial;
}

/* Tells whether one thread is to be tried again: while threads wait much, sixteen such trials must
 * fit into the time since the last, which may have been disturbed; all threads can be a hundred
 * times as slow. */
static bool is_long(const gn_pace *p) {
    return !p->one && p->alone > 0.0 && p->rounds >= p->shortest &&
           p->waiting > waiting_enough * p->rounds && p->seconds > 16.0 * p->alone;
}

void gn_pace_note(gn_pace *p, double seconds, double work, double waiting) {
    if (p->all < 2) return;
    p->seconds += seconds;
    p->work += work;
    p->waiting += waiting;
    p->rounds++;
    if (!p->trying) {
        if (p->rounds < p->interval && !is_long(p)) return;
        bool known = p->waiting >= 0.0, idle = !known || p->waiting > waiting_enough * p->rounds;
        p->cost = p->seconds / p->work;
        if (!p->one && !idle) lengthen(p);
        begin_period(p, p->one || idle);
        return;
    }
    if (p->rounds < p->trial && !is_lost(p)) return;
    if (!p->one) p->alone = p->seconds;
    if (p->seconds / p->work < p->cost) {
        p->one = !p->one;
        p->interval = p->shortest;
    } else {
        lengthen(p);
    }
    begin_period(p, false);
}
