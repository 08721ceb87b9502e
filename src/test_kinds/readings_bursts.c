/* Bursts of breaking bonds, which correspond to acoustic events: their number and the slope of the
 * distribution of their sizes. */
#include "test_kinds/curves.h"

#include <math.h>

/* Computes zeta(a) and -d zeta/da = sum ln k k^-a, by the first terms and Euler-Maclaurin. */
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

/* Returns the power a of sizes k^-a/zeta(a) with the given mean logarithm, which decreases with
 * a. */
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

/* Least number of events for a slope: the standard error of a slope b of n events is b/sqrt(n) (Aki
 * 1965), 14 % for 50 events. */
enum { EVENTS_LEAST = 50 };

void gn_readings_of_bursts(const gn_tested *tested, gn_readings *readings) {
    double logs = 0.0;
    int32_t most = 0;
    if (!tested->bursts) {
        const char *why =
            tested->no_bursts ? tested->no_bursts : "no list of broken bonds was recorded";
        gn_reading_absent(readings, GN_READING_events, "%s", why);
        gn_reading_absent(readings, GN_READING_b_value, "%s", why);
        return;
    }
    for (size_t k = 0; k < tested->burst_count; k++) {
        logs += log(tested->bursts[k]);
        most = tested->bursts[k] > most ? tested->bursts[k] : most;
    }
    readings->events = (double)tested->burst_count;
    if (tested->burst_count < EVENTS_LEAST)
        gn_reading_absent(readings, GN_READING_b_value, "%zu bursts, %d are needed",
                          tested->burst_count, EVENTS_LEAST);
    else if (most < 2)
        gn_reading_absent(readings, GN_READING_b_value, "every burst broke one bond");
    else
        readings->b_value = power_of(logs / (double)tested->burst_count) - 1;
}
