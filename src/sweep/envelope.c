#include "sweep/envelope.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct points {
    const double *x, *y;
    size_t count, stride;
} points;

static bool has(const points *p, size_t k) {
    return isfinite(p->x[k * p->stride]) && isfinite(p->y[k * p->stride]);
}

/* Confinements that differ by more than a millionth of the largest. */
static size_t different(const points *p) {
    double largest = 0.0;
    size_t count = 0;
    for (size_t k = 0; k < p->count; k++)
        if (has(p, k)) largest = fmax(largest, fabs(p->x[k * p->stride]));
    for (size_t k = 0; k < p->count; k++) {
        bool found = !has(p, k);
        for (size_t q = 0; q < k && !found; q++)
            found = has(p, q) && fabs(p->x[q * p->stride] - p->x[k * p->stride]) <= 1e-6 * largest;
        count += !found;
    }
    return count;
}

static double strength(double s3, double s1) {
    (void)s3;
    return s1;
}
static double squared_deviator(double s3, double s1) {
    return (s1 - s3) * (s1 - s3);
}

/* Least squares about the means, so that large pressures lose nothing. */
static void fit_line(const points *p, double (*of)(double s3, double s1), double *slope,
                     double *start) {
    double n = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
    for (size_t k = 0; k < p->count; k++) {
        if (!has(p, k)) continue;
        double x = p->x[k * p->stride], y = of(x, p->y[k * p->stride]);
        n += 1.0;
        mx += (x - mx) / n;
        my += (y - my) / n;
    }
    for (size_t k = 0; k < p->count; k++) {
        if (!has(p, k)) continue;
        double x = p->x[k * p->stride] - mx;
        xx += x * x;
        xy += x * (of(p->x[k * p->stride], p->y[k * p->stride]) - my);
    }
    *slope = xy / xx;
    *start = my - *slope * mx;
}

static void fit_coulomb(const points *p, gn_envelope *e) {
    double k, c;
    fit_line(p, strength, &k, &c);
    if (!(k >= 1.0 && c >= 0.0)) {
        snprintf(e->no_coulomb, sizeof e->no_coulomb,
                 "the line has a slope of %.3g (at least 1) and begins at %.3g Pa (at least 0)", k,
                 c);
        return;
    }
    e->friction_angle = asin((k - 1.0) / (k + 1.0)) * 180.0 / M_PI;
    e->cohesion = c / (2.0 * sqrt(k));
}

static void fit_hoek_brown(const points *p, gn_envelope *e) {
    double slope, start;
    fit_line(p, squared_deviator, &slope, &start);
    if (!(slope > 0.0 && start > 0.0)) {
        snprintf(e->no_hoek_brown, sizeof e->no_hoek_brown,
                 "the square of the deviator does not grow from above zero along a line");
        return;
    }
    e->hoek_brown_strength = sqrt(start);
    e->hoek_brown_mi = slope / e->hoek_brown_strength;
}

gn_envelope gn_envelope_fit(const double *confinement, const double *axial, size_t count,
                            size_t stride) {
    const points p = {confinement, axial, count, stride};
    gn_envelope e = {
#define X(name, unit, text) .name = NAN,
        GN_ENVELOPE_READINGS(X)
#undef X
    };
    size_t found = different(&p);
    e.there = found > 1;
    if (found >= GN_ENVELOPE_LEAST) {
        fit_coulomb(&p, &e);
        fit_hoek_brown(&p, &e);
        return e;
    }
    snprintf(e.no_coulomb, sizeof e.no_coulomb,
             "%zu different confinement%s with a strength, %d are needed", found,
             found == 1 ? "" : "s", GN_ENVELOPE_LEAST);
    memcpy(e.no_hoek_brown, e.no_coulomb, sizeof e.no_hoek_brown);
    return e;
}

/* The place of a reading; the number of readings: it is not there. */
static size_t place_of(const gn_summary *m, const char *name) {
    size_t r = 0;
    while (r < m->reading_count && strcmp(m->readings[r].name, name) != 0) r++;
    return r;
}

gn_envelope gn_envelope_of(const gn_summary *m) {
    size_t at = place_of(m, "confinement"), of = place_of(m, "axial_strength");
    if (at == m->reading_count || of == m->reading_count) return (gn_envelope){.there = false};
    return gn_envelope_fit(m->value + at, m->value + of, m->sweep->run_count, m->reading_count);
}
