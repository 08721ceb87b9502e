#include "run/budget.h"

#include "accuracy/accuracy.h"
#include "base/new.h"
#include "base/sort.h"
#include "laboratory/laboratory.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Returns the accuracy study's name of a reading; NULL: the study has no laws of it. Nothing breaks
 * in elements, and the stress at a given displacement has the error of their stiffness. */
static const char *name_of(gn_reading which, const gn_test_groups *g) {
    switch (which) {
    case GN_READING_young_modulus:
    case GN_READING_young_modulus_average:
        return g->mesh ? NULL : "E";
    case GN_READING_poisson_ratio:
        return g->mesh ? NULL : "nu";
    case GN_READING_peak_stress:
        return g->mesh ? NULL : "strength";
    case GN_READING_peak_strain:
        return g->mesh ? NULL : "strain at the peak";
    case GN_READING_largest_stress:
        return !g->mesh ? NULL : strcmp(g->study, "cantilever") == 0 ? "deflection" : "stiffness";
    default:
        return NULL;
    }
}

static double value_of(const gn_readings *r, gn_reading which) {
    return (&r->young_modulus)[which];
}

/* --- errors measured in the run --- */

static size_t row_of_largest(const gn_history *h, const double *stress) {
    size_t largest = 0;
    for (size_t k = 1; k < h->row_count; k++)
        if (stress[k] > stress[largest]) largest = k;
    return largest;
}

/* Computes the median over the second half of the rise to the largest stress, because waves
 * dominate its start. */
static gneiss_status kinetic_share(const gn_history *h, double *found, gneiss_error *error) {
    const double *stress = gn_history_column(h, "stress"),
                 *kinetic = gn_history_column(h, "energy_kinetic");
    GN_FREED double *share = NULL;
    *found = NAN;
    if (!stress || !kinetic || !h->row_count) return GNEISS_OK;
    size_t last = row_of_largest(h, stress), first = last / 2, count = last + 1 - first;
    GN_TRY(gn_new(&share, count, "rows of the error budget", error));
    for (size_t k = 0; k < count; k++) {
        double stored = 0.0;
        for (size_t c = 0; c < h->column_count; c++)
            if (strncmp(h->columns[c].name, "energy_elastic_", 15) == 0)
                stored += h->columns[c].value[first + k];
        share[k] = stored > 0.0 ? kinetic[first + k] / stored : 0.0;
    }
    gn_sort_numbers(share, count);
    *found = share[count / 2];
    return GNEISS_OK;
}

/* Returns the closing speed over wave speed and strain, as measured in this run. */
static double speed_of(const gn_world *w, const gn_history *h, const gn_readings *r) {
    const double *stress = gn_history_column(h, "stress"), *time = gn_history_column(h, "time");
    double modulus = isnan(r->young_modulus_average) ? r->young_modulus : r->young_modulus_average;
    if (!stress || !time || !h->row_count) return NAN;
    double closing = gn_test_closing(&w->ctx.scene, time[row_of_largest(h, stress)]);
    return closing /
           (sqrt(modulus / gn_test_bulk_density(&w->ctx, &w->dem, &w->solids)) * r->largest_strain);
}

/* Sets a cause to the measured error if that exceeds the estimate of the law. */
static void raise(gn_error_causes *c, const char *name, double found) {
    gn_error_cause *cause = gn_causes_find(c, name);
    if (!isfinite(found)) return;
    if (!cause)
        gn_causes_add(c, name, found, true);
    else if (found > cause->error)
        *cause = (gn_error_cause){name, found, true, 0.0};
}

/* The stress is the mean of both ends, so its error is at most half of their difference; kinetic
 * energy is energy that a static test would have stored or never supplied. */
static void measure(const gn_world *w, const gn_budget *b, gn_error_causes *c) {
    raise(c, "velocity",
          fmax(isnan(b->imbalance) ? 0.0 : 0.5 * b->imbalance,
               isnan(b->kinetic) ? 0.0 : 0.5 * b->kinetic));
    if (w->ctx.effects & GN_FX_ENERGY)
        raise(c, "step", fabs(gn_energy_residual(&w->ledger.reading)));
}

/* Bounds the largest stress between its row and the next: it may have risen by as much as from the
 * row before. */
static void measure_rows(const gn_history *h, gn_reading which, gn_error_causes *c) {
    const double *stress = gn_history_column(h, "stress"),
                 *value = which == GN_READING_peak_stress   ? stress
                          : which == GN_READING_peak_strain ? gn_history_column(h, "strain")
                                                            : NULL;
    size_t row = stress ? row_of_largest(h, stress) : 0;
    if (value && row > 0) raise(c, "rows", (value[row] - value[row - 1]) / value[row]);
}

/* The ends of a body of fast varying section approach each other more than those of a slender
 * bar. */
static void add_section(const gn_world *w, gn_reading which, gn_error_causes *c) {
    const gn_bar_section *x = &w->section;
    if (which != GN_READING_young_modulus || x->guessed != 0.0 || !(x->spread > 0.0)) return;
    gn_causes_add(c, "section", x->spread, false);
    gn_error_cause *cause = gn_causes_find(c, "section");
    if (cause) cause->bias = -x->spread;
}

/* A peak lies between two rows: with at least this many rows up to it its error is below one per
 * cent. */
enum { ROWS_LEAST = 20 };

static const char *untold(const gn_budget *b, const gn_history *h) {
    const double *stress = gn_history_column(h, "stress");
    if (!stress || row_of_largest(h, stress) < ROWS_LEAST)
        return "the history has fewer than 20 rows up to the largest stress";
    if (!isfinite(b->speed))
        return "there is no reading of the modulus, which the speed of loading is relative to";
    return NULL;
}

static gneiss_status make(const gn_world *w, const gn_history *h, const gn_readings *r,
                          gn_budget *b, gneiss_error *error) {
    gn_test_groups g;
    *b = (gn_budget){.speed = NAN, .imbalance = r->end_imbalance, .kinetic = NAN};
    const char *reason = gn_study_find_case(&w->ctx, &w->dem, &g);
    if (reason) {
        snprintf(b->absent, sizeof b->absent, "%s", reason);
        return GNEISS_OK;
    }
    GN_TRY(kinetic_share(h, &b->kinetic, error));
    b->speed = g.speed = g.mesh ? NAN : speed_of(w, h, r);
    reason = g.mesh ? NULL : untold(b, h);
    if (reason) {
        snprintf(b->absent, sizeof b->absent, "%s", reason);
        return GNEISS_OK;
    }
    for (int k = 0; k < GN_READING_COUNT; k++) {
        const char *name = name_of((gn_reading)k, &g);
        if (!name || isnan(value_of(r, (gn_reading)k))) continue;
        if (!gn_causes_predict(&g, name, &b->of[k])) continue;
        measure(w, b, &b->of[k]);
        measure_rows(h, (gn_reading)k, &b->of[k]);
        add_section(w, (gn_reading)k, &b->of[k]);
        if (r->nonlinearity[k] > 0.0) raise(&b->of[k], "nonlinearity", r->nonlinearity[k]);
    }
    return GNEISS_OK;
}

gneiss_status gn_budget_create(const gn_world *w, const gn_history *h, const gn_readings *r,
                               gn_budget **budget, gneiss_error *error) {
    gn_budget *b = calloc(1, sizeof *b);
    if (!b) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the error budget");
    gneiss_status status = make(w, h, r, b, error);
    if (status == GNEISS_OK)
        *budget = b;
    else
        free(b);
    return status;
}

/* --- text and attributes --- */

static int by_error(const void *a, const void *b) {
    const gn_error_cause *x = a, *y = b;
    return (x->error < y->error) - (x->error > y->error);
}

/* Writes a number without an exponent, which "%.2g" has from 100 on. */
static double two_digits(double value) {
    if (!isfinite(value) || value == 0.0) return value;
    const double unit = pow(10.0, floor(log10(fabs(value))) - 1.0);
    return round(value / unit) * unit;
}

const char *gn_budget_text(const gn_error_causes *c, double value, char *text, size_t size) {
    const double worth_saying = 0.02 * gn_causes_total(c);
    gn_error_causes sorted = *c;
    size_t used = 0;
    text[0] = 0;
    qsort(sorted.cause, sorted.count, sizeof *sorted.cause, by_error);
    for (size_t k = 0; k < sorted.count && used < size; k++) {
        const gn_error_cause *cause = &sorted.cause[k];
        if (cause->error < worth_saying) break;
        used += (size_t)snprintf(text + used, size - used, "%s%s %.6g %s", k ? ", " : "(",
                                 cause->name, two_digits(fabs(value) * cause->error),
                                 cause->measured ? "measured" : "estimated");
    }
    if (used && used < size) snprintf(text + used, size - used, ")");
    return text;
}

static const char *const names[] = {
#define X(name, unit, text) #name,
    GN_READINGS(X)
#undef X
};

static void summary_of(const gn_error_causes *c, const char *name, double value, gn_json *j) {
    gn_json_object(j, name);
    gn_json_number(j, "error", fabs(value) * gn_causes_total(c));
    gn_json_array(j, "causes");
    for (size_t k = 0; k < c->count; k++) {
        gn_json_object(j, NULL);
        gn_json_text(j, "name", c->cause[k].name);
        GN_JSON_NUMBERS(j, {"error", fabs(value) * c->cause[k].error},
                        {"bias", fabs(value) * c->cause[k].bias});
        gn_json_text(j, "is", c->cause[k].measured ? "measured" : "estimated");
        gn_json_end(j);
    }
    gn_json_end(j);
    gn_json_array(j, "notes");
    for (size_t k = 0; k < c->note_count; k++) gn_json_text(j, NULL, c->note[k]);
    gn_json_end(j);
    gn_json_end(j);
}

void gn_budget_summary(const gn_budget *b, const gn_readings *r, gn_json *j) {
    gn_json_object(j, "error_budget");
    if (b->absent[0]) gn_json_text(j, "absent", b->absent);
    if (!b->absent[0]) {
        GN_JSON_NUMBERS(j, {"speed", b->speed}, {"end_imbalance", b->imbalance},
                        {"kinetic_over_elastic", b->kinetic});
    }
    for (int k = 0; k < GN_READING_COUNT; k++)
        if (b->of[k].count) summary_of(&b->of[k], names[k], value_of(r, (gn_reading)k), j);
    gn_json_end(j);
}

gneiss_status gn_budget_results(const gn_budget *b, const gn_readings *r, gn_h5 *file,
                                gneiss_error *error) {
    char set[96], text[512];
    for (int k = 0; k < GN_READING_COUNT; k++) {
        const gn_error_causes *c = &b->of[k];
        double value = value_of(r, (gn_reading)k), of_all = fabs(value) * gn_causes_total(c),
               besides = fabs(value) * gn_causes_without_scatter(c);
        if (!c->count) continue;
        snprintf(set, sizeof set, "readings/%s", names[k]);
        GN_TRY(gn_h5_attribute_f64(file, set, "error", &of_all, 1, error));
        GN_TRY(gn_h5_attribute_f64(file, set, "error_besides_scatter", &besides, 1, error));
        GN_TRY(gn_h5_attribute_text(file, set, "error_causes",
                                    gn_budget_text(c, value, text, sizeof text), error));
    }
    return GNEISS_OK;
}
