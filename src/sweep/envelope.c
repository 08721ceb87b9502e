#define _GNU_SOURCE /* qsort_r */
#include "sweep/envelope.h"

#include "base/new.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct point_set {
    const double *x, *y;
    size_t count, stride;
} point_set;

static bool has(const point_set *points, size_t k) {
    return isfinite(points->x[k * points->stride]) && isfinite(points->y[k * points->stride]);
}

/* Counts confinements that differ from each other by more than a millionth of the largest. */
static size_t different(const point_set *points) {
    double largest = 0.0;
    size_t count = 0;
    for (size_t k = 0; k < points->count; k++)
        if (has(points, k)) largest = fmax(largest, fabs(points->x[k * points->stride]));
    for (size_t k = 0; k < points->count; k++) {
        bool found = !has(points, k);
        for (size_t q = 0; q < k && !found; q++)
            found = has(points, q) && fabs(points->x[q * points->stride] -
                                           points->x[k * points->stride]) <= 1e-6 * largest;
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

/* Fits a line by least squares about the means, so that large pressures lose no precision. */
static void fit_line(const point_set *points, double (*of)(double s3, double s1), double *slope,
                     double *start) {
    double n = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
    for (size_t k = 0; k < points->count; k++) {
        if (!has(points, k)) continue;
        double x = points->x[k * points->stride], y = of(x, points->y[k * points->stride]);
        n += 1.0;
        mx += (x - mx) / n;
        my += (y - my) / n;
    }
    for (size_t k = 0; k < points->count; k++) {
        if (!has(points, k)) continue;
        double x = points->x[k * points->stride] - mx;
        xx += x * x;
        xy += x * (of(points->x[k * points->stride], points->y[k * points->stride]) - my);
    }
    *slope = xy / xx;
    *start = my - *slope * mx;
}

static void fit_coulomb(const point_set *points, gn_envelope *envelope) {
    double k, c;
    fit_line(points, strength, &k, &c);
    if (!(k >= 1.0 && c >= 0.0)) {
        snprintf(envelope->no_coulomb, sizeof envelope->no_coulomb,
                 "the fitted line has a slope of %.3g (at least 1 needed) and an intercept of %.3g "
                 "Pa (at least 0 needed)",
                 k, c);
        return;
    }
    envelope->friction_angle = asin((k - 1.0) / (k + 1.0)) * 180.0 / M_PI;
    envelope->cohesion = c / (2.0 * sqrt(k));
}

static void fit_hoek_brown(const point_set *points, gn_envelope *envelope) {
    double slope, start;
    fit_line(points, squared_deviator, &slope, &start);
    if (!(slope > 0.0 && start > 0.0)) {
        snprintf(envelope->no_hoek_brown, sizeof envelope->no_hoek_brown,
                 "the fitted line of the squared deviator has no positive slope and intercept");
        return;
    }
    envelope->hoek_brown_strength = sqrt(start);
    envelope->hoek_brown_mi = slope / envelope->hoek_brown_strength;
}

gn_envelope gn_envelope_fit(const double *confinement, const double *axial, size_t count,
                            size_t stride) {
    const point_set p = {confinement, axial, count, stride};
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

/* True if a parameter is the confinement of the specimen. */
static bool is_confinement(const char *key) {
    static const char *const ends[] = {"membrane.pressure", "servo.stress",
                                       "servo.force",       "periodic.x.stress",
                                       "periodic.y.stress", "periodic.z.stress"};
    for (size_t k = 0; k < sizeof ends / sizeof *ends; k++)
        if (ends_with(key, ends[k])) return true;
    return false;
}

/* True if a parameter belongs to the test procedure and not to the specimen. */
static bool is_procedure(const char *key) {
    static const char *const lists[] = {"walls", "sets",   "bodies", "membrane", "time",
                                        "test",  "output", "run",    "stages",   "periodic"};
    size_t length = strcspn(key, ".[");
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        if (strlen(lists[k]) == length && strncmp(key, lists[k], length) == 0) return true;
    return false;
}

static int compare_values(const gn_sweep *sweep, size_t first, size_t second, size_t p) {
    const gn_sweep_value *x = gn_sweep_value_of(sweep, first, p),
                         *y = gn_sweep_value_of(sweep, second, p);
    if (!sweep->parameters[p].numeric) return strcmp(x->text, y->text);
    return (x->number > y->number) - (x->number < y->number);
}

typedef struct run_order {
    const gn_sweep *sweep;
    const bool *counts; /* [parameter_count] */
} run_order;

static int compare_groups(const run_order *o, size_t first, size_t second) {
    int order = 0;
    for (size_t p = 0; p < o->sweep->parameter_count && !order; p++)
        if (o->counts[p]) order = compare_values(o->sweep, first, second, p);
    return order;
}

/* Orders runs by group, and within a group as in the sweep. */
static int compare_runs(const void *left, const void *right, void *context) {
    size_t x = *(const size_t *)left, y = *(const size_t *)right;
    int order = compare_groups(context, x, y);
    return order ? order : (x > y) - (x < y);
}

static void sort_runs(const gn_sweep *sweep, const bool *counts, size_t *runs) {
    run_order order = {sweep, counts};
    for (size_t k = 0; k < sweep->run_count; k++) runs[k] = k;
    qsort_r(runs, sweep->run_count, sizeof *runs, compare_runs, &order);
}

/* Chooses the parameters that distinguish envelopes: all but the confinement and those parameters
 * of the procedure that vary with it, such as a speed that is zipped with the pressure. */
static void choose_grouping(const gn_sweep *sweep, size_t *runs, bool *confines, bool *grouping) {
    const run_order order = {sweep, confines};
    for (size_t p = 0; p < sweep->parameter_count; p++)
        confines[p] = is_confinement(sweep->parameters[p].key);
    sort_runs(sweep, confines, runs);
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        const char *key = sweep->parameters[p].key;
        bool follows = is_procedure(key);
        for (size_t k = 1; follows && k < sweep->run_count; k++)
            follows = compare_groups(&order, runs[k - 1], runs[k]) != 0 ||
                      compare_values(sweep, runs[k - 1], runs[k], p) == 0;
        grouping[p] = !confines[p] && !follows && strcmp(key, "run.seed") != 0;
    }
}

/* Returns the index of a reading; the number of readings: it is not among them. */
static size_t place_of(const gn_summary *summary, const char *name) {
    size_t r = 0;
    while (r < summary->reading_count && strcmp(summary->readings[r].name, name) != 0) r++;
    return r;
}

/* Fits each group; groups with a single confinement are skipped. */
static void fit_groups(const gn_summary *summary, gn_envelopes *envelopes, const size_t *runs,
                       double *pairs, size_t at, size_t of) {
    const gn_sweep *sweep = summary->sweep;
    const run_order order = {sweep, envelopes->grouping};
    size_t width = summary->reading_count;
    for (size_t first = 0, end; first < sweep->run_count; first = end) {
        for (end = first; end < sweep->run_count; end++) {
            if (compare_groups(&order, runs[first], runs[end]) != 0) break;
            pairs[2 * end] = summary->value[runs[end] * width + at];
            pairs[2 * end + 1] = summary->value[runs[end] * width + of];
        }
        gn_envelope fit = gn_envelope_fit(pairs + 2 * first, pairs + 2 * first + 1, end - first, 2);
        for (size_t k = first; k < end; k++)
            envelopes->of_run[runs[k]] = fit.there ? (int64_t)envelopes->count : -1;
        if (!fit.there) continue;
        envelopes->first[envelopes->count] = runs[first];
        envelopes->of[envelopes->count++] = fit;
    }
}

static gneiss_status make_envelopes(const gn_summary *summary, gn_envelopes *envelopes, size_t at,
                                    size_t of, gneiss_error *error) {
    const gn_sweep *sweep = summary->sweep;
    const size_t count = sweep->run_count, parameters = sweep->parameter_count;
    GN_FREED size_t *runs = NULL;
    GN_FREED double *pairs = NULL;
    GN_FREED bool *confines = NULL;
    GN_TRY(gn_new(&runs, count, "runs", error));
    GN_TRY(gn_new(&pairs, 2 * count, "pairs of stresses", error));
    GN_TRY(gn_new(&confines, parameters, "parameters", error));
    GN_TRY(gn_new(&envelopes->of, count, "envelopes", error));
    GN_TRY(gn_new(&envelopes->first, count, "envelopes", error));
    GN_TRY(gn_new(&envelopes->of_run, count, "runs", error));
    GN_TRY(gn_new(&envelopes->grouping, parameters, "parameters", error));
    choose_grouping(sweep, runs, confines, envelopes->grouping);
    sort_runs(sweep, envelopes->grouping, runs);
    fit_groups(summary, envelopes, runs, pairs, at, of);
    return GNEISS_OK;
}

gneiss_status gn_envelopes_make(const gn_summary *summary, gn_envelopes *envelopes,
                                gneiss_error *error) {
    size_t at = place_of(summary, "confinement"), of = place_of(summary, "axial_strength");
    *envelopes = (gn_envelopes){0};
    if (at == summary->reading_count || of == summary->reading_count) return GNEISS_OK;
    const point_set all = {summary->value + at, summary->value + of, summary->sweep->run_count,
                           summary->reading_count};
    envelopes->confined = different(&all) > 1;
    if (!envelopes->confined) return GNEISS_OK;
    gneiss_status status = make_envelopes(summary, envelopes, at, of, error);
    if (status != GNEISS_OK) gn_envelopes_free(envelopes);
    return status;
}

void gn_envelopes_free(gn_envelopes *envelopes) {
    gn_free(envelopes->of);
    gn_free(envelopes->first);
    gn_free(envelopes->of_run);
    gn_free(envelopes->grouping);
    *envelopes = (gn_envelopes){0};
}

const char *gn_envelope_label(const gn_summary *summary, const gn_envelopes *envelopes,
                              size_t which, char *text, size_t size) {
    return gn_sweep_label_of(summary->sweep, envelopes->first[which], envelopes->grouping, text,
                             size);
}
