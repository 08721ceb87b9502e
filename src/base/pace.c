#include "base/pace.h"

#include <math.h>

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

void gn_pace_follow(int threads, const gn_busy *busy, double *share) {
    double mean = 0.0, total = 0.0, part[GN_THREADS_MAX];
    for (int t = 0; t < threads; t++) mean += busy[t].seconds / threads;
    for (int t = 0; t < threads; t++) {
        double now = t + 1 < threads ? share[t + 1] : 1.0;
        double off = mean > 0.0 ? busy[t].seconds / mean - 1.0 : 0.0;
        part[t] = (now - share[t]) * (1.0 - 0.05 * fmax(-0.5, fmin(0.5, off)));
        total += part[t];
    }
    double before = 0.0;
    for (int t = 0; t < threads; t++) {
        share[t] = before;
        before += part[t] / total;
    }
}
