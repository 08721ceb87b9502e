/* Bursts of breaking bonds, as they are heard in a laboratory: their number and the slope of their
 * sizes. */
#include "measure/readings.h"

#include <math.h>

/* zeta(a) and -d zeta/da = sum ln k k^-a, by the first terms and Euler-Maclaurin. */
static void zeta(double a, double *value, double *logs) {
    enum { TERMS = 20 };
    const double n = TERMS, l = log(n), power = pow(n, -a);
    *value = *logs = 0;
    for (int k = 1; k < TERMS; k++) {
        *value += pow(k, -a);
        *logs += log(k) * pow(k, -a);
    }
    *value += n * power / (a - 1) + 0.5 * power + a * power / (12 * n);
    *logs += n * power * (l / (a - 1) + 1 / ((a - 1) * (a - 1))) + 0.5 * l * power +
             (a * l - 1) * power / (12 * n);
}

/* The power a of sizes k^-a/zeta(a) whose mean logarithm is the one given; it falls with a. */
static double power_of(double mean_log) {
    double low = 1.01, high = 20;
    for (int k = 0; k < 60; k++) {
        double a = 0.5 * (low + high), value, logs;
        zeta(a, &value, &logs);
        if (logs / value > mean_log)
            low = a;
        else
            high = a;
    }
    return 0.5 * (low + high);
}

typedef struct bursts {
    size_t count;
    double logs, most;
} bursts;

static void end_burst(bursts *b, double *size) {
    if (!(*size > 0)) return;
    b->count++;
    b->logs += log(*size);
    b->most = fmax(b->most, *size);
    *size = 0;
}

static bursts count_bursts(const double *tension, const double *shear, size_t rows) {
    bursts b = {0};
    double size = 0;
    for (size_t k = 1; k < rows; k++) {
        double broke = tension[k] + shear[k] - tension[k - 1] - shear[k - 1];
        if (!(broke > 0)) end_burst(&b, &size);
        size += fmax(broke, 0);
    }
    end_burst(&b, &size);
    return b;
}

/* The standard error of a slope b of n events is b/sqrt(n) (Aki 1965): 50 leave 14 %. */
enum { EVENTS_LEAST = 50 };

void gn_readings_of_bursts(const gn_curves *c, gn_readings *r) {
    const double *tension = gn_history_column(c->history, "broken_tension"),
                 *shear = gn_history_column(c->history, "broken_shear");
    if (!tension || !shear) {
        gn_reading_absent(r, GN_READING_events, "the scene has no bonds");
        gn_reading_absent(r, GN_READING_b_value, "the scene has no bonds");
        return;
    }
    bursts b = count_bursts(tension, shear, c->history->row_count);
    r->events = (double)b.count;
    if (b.count < EVENTS_LEAST)
        gn_reading_absent(r, GN_READING_b_value, "%zu bursts, %d are needed", b.count,
                          EVENTS_LEAST);
    else if (!(b.most > 1))
        gn_reading_absent(r, GN_READING_b_value, "every burst broke one bond");
    else
        r->b_value = power_of(b.logs / (double)b.count) - 1;
}
