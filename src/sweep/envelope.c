#define _GNU_SOURCE /* qsort_r */
#include "sweep/envelope.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
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

/* ---- groups of runs ---- */

static bool ends_with(const char *key, const char *end) {
    size_t length = strlen(key), own = strlen(end);
    return length >= own && strcmp(key + length - own, end) == 0;
}

/* Tells whether a parameter is what confines the specimen. */
static bool is_confinement(const char *key) {
    static const char *const ends[] = {"membrane.pressure", "servo.stress",
                                       "servo.force",       "periodic.x.stress",
                                       "periodic.y.stress", "periodic.z.stress"};
    for (size_t k = 0; k < sizeof ends / sizeof *ends; k++)
        if (ends_with(key, ends[k])) return true;
    return false;
}

/* Tells whether a parameter says how a test is carried out, and nothing of the specimen. */
static bool is_procedure(const char *key) {
    static const char *const lists[] = {"walls", "sets",   "bodies", "membrane", "time",
                                        "test",  "output", "run",    "stages",   "periodic"};
    size_t length = strcspn(key, ".[");
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        if (strlen(lists[k]) == length && strncmp(key, lists[k], length) == 0) return true;
    return false;
}

static int compare_values(const gn_sweep *s, size_t a, size_t b, size_t p) {
    const gn_sweep_value *x = gn_sweep_value_of(s, a, p), *y = gn_sweep_value_of(s, b, p);
    if (!s->parameters[p].numeric) return strcmp(x->text, y->text);
    return (x->number > y->number) - (x->number < y->number);
}

typedef struct run_order {
    const gn_sweep *sweep;
    const bool *counts; /* [parameter_count] */
} run_order;

static int compare_groups(const run_order *o, size_t a, size_t b) {
    int order = 0;
    for (size_t p = 0; p < o->sweep->parameter_count && !order; p++)
        if (o->counts[p]) order = compare_values(o->sweep, a, b, p);
    return order;
}

/* Runs of a group stand together, in the order of the sweep. */
static int compare_runs(const void *a, const void *b, void *context) {
    size_t x = *(const size_t *)a, y = *(const size_t *)b;
    int order = compare_groups(context, x, y);
    return order ? order : (x > y) - (x < y);
}

static void sort_runs(const gn_sweep *s, const bool *counts, size_t *runs) {
    run_order order = {s, counts};
    for (size_t k = 0; k < s->run_count; k++) runs[k] = k;
    qsort_r(runs, s->run_count, sizeof *runs, compare_runs, &order);
}

/* Envelopes differ in every parameter but the confinement and what goes along with it in the
 * procedure of the test, as a speed that is zipped with the pressure. */
static void choose_grouping(const gn_sweep *s, size_t *runs, bool *confines, bool *grouping) {
    const run_order order = {s, confines};
    for (size_t p = 0; p < s->parameter_count; p++)
        confines[p] = is_confinement(s->parameters[p].key);
    sort_runs(s, confines, runs);
    for (size_t p = 0; p < s->parameter_count; p++) {
        const char *key = s->parameters[p].key;
        bool follows = is_procedure(key);
        for (size_t k = 1; follows && k < s->run_count; k++)
            follows = compare_groups(&order, runs[k - 1], runs[k]) != 0 ||
                      compare_values(s, runs[k - 1], runs[k], p) == 0;
        grouping[p] = !confines[p] && !follows && strcmp(key, "run.seed") != 0;
    }
}

/* The place of a reading; the number of readings: it is not there. */
static size_t place_of(const gn_summary *m, const char *name) {
    size_t r = 0;
    while (r < m->reading_count && strcmp(m->readings[r].name, name) != 0) r++;
    return r;
}

/* Fits group by group; those without confinements that differ are left out. */
static void fit_groups(const gn_summary *m, gn_envelopes *e, const size_t *runs, double *pairs,
                       size_t at, size_t of) {
    const gn_sweep *s = m->sweep;
    const run_order order = {s, e->grouping};
    size_t width = m->reading_count;
    for (size_t first = 0, end; first < s->run_count; first = end) {
        for (end = first; end < s->run_count; end++) {
            if (compare_groups(&order, runs[first], runs[end]) != 0) break;
            pairs[2 * end] = m->value[runs[end] * width + at];
            pairs[2 * end + 1] = m->value[runs[end] * width + of];
        }
        gn_envelope fit = gn_envelope_fit(pairs + 2 * first, pairs + 2 * first + 1, end - first, 2);
        for (size_t k = first; k < end; k++)
            e->of_run[runs[k]] = fit.there ? (int64_t)e->count : -1;
        if (!fit.there) continue;
        e->first[e->count] = runs[first];
        e->of[e->count++] = fit;
    }
}

static gneiss_status make_envelopes(const gn_summary *m, gn_envelopes *e, size_t at, size_t of,
                                    gneiss_error *error) {
    const gn_sweep *s = m->sweep;
    size_t *runs = gn_alloc_array(s->run_count, sizeof *runs);
    double *pairs = gn_alloc_array(2 * s->run_count, sizeof *pairs);
    bool *confines = gn_alloc_array(s->parameter_count + 1, sizeof *confines);
    e->of = gn_alloc_array(s->run_count, sizeof *e->of);
    e->first = gn_alloc_array(s->run_count, sizeof *e->first);
    e->of_run = gn_alloc_array(s->run_count, sizeof *e->of_run);
    e->grouping = gn_alloc_array(s->parameter_count + 1, sizeof *e->grouping);
    bool held = runs && pairs && confines && e->of && e->first && e->of_run && e->grouping;
    if (held) {
        choose_grouping(s, runs, confines, e->grouping);
        sort_runs(s, e->grouping, runs);
        fit_groups(m, e, runs, pairs, at, of);
    }
    gn_free(runs);
    gn_free(pairs);
    gn_free(confines);
    return held ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the envelopes");
}

gneiss_status gn_envelopes_make(const gn_summary *m, gn_envelopes *e, gneiss_error *error) {
    size_t at = place_of(m, "confinement"), of = place_of(m, "axial_strength");
    *e = (gn_envelopes){0};
    if (at == m->reading_count || of == m->reading_count) return GNEISS_OK;
    const points all = {m->value + at, m->value + of, m->sweep->run_count, m->reading_count};
    e->confined = different(&all) > 1;
    if (!e->confined) return GNEISS_OK;
    gneiss_status status = make_envelopes(m, e, at, of, error);
    if (status != GNEISS_OK) gn_envelopes_free(e);
    return status;
}

void gn_envelopes_free(gn_envelopes *e) {
    gn_free(e->of);
    gn_free(e->first);
    gn_free(e->of_run);
    gn_free(e->grouping);
    *e = (gn_envelopes){0};
}

const char *gn_envelope_label(const gn_summary *m, const gn_envelopes *e, size_t which, char *text,
                              size_t size) {
    return gn_sweep_label_of(m->sweep, e->first[which], e->grouping, text, size);
}
