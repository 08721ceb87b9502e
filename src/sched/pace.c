#include "sched/pace.h"

static void begin_period(gn_pace *p, bool trying) {
    p->trying = trying;
    p->rounds = 0;
    p->seconds = p->work = p->waiting = 0.0;
}

static void lengthen(gn_pace *p) {
    p->interval = 2 * p->interval < p->longest ? 2 * p->interval : p->longest;
}

/* A thread waits a little in the best of worlds: shares are never quite equal. */
static const double waiting_enough = 0.3;

void gn_pace_note(gn_pace *p, double seconds, double work, double waiting) {
    if (p->all < 2) return;
    p->seconds += seconds;
    p->work += work;
    p->waiting += waiting;
    p->rounds++;
    if (!p->trying) {
        if (p->rounds < p->interval) return;
        bool idle = p->waiting > waiting_enough * p->rounds;
        p->cost = p->seconds / p->work;
        if (!p->one && !idle) lengthen(p);
        begin_period(p, p->one || idle);
        return;
    }
    if (p->rounds < p->trial) return;
    if (p->seconds / p->work < p->cost) {
        p->one = !p->one;
        p->interval = p->shortest;
    } else {
        lengthen(p);
    }
    begin_period(p, false);
}
