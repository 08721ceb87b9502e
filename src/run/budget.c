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
static const char *name_of(gn_reading which, const gn_test_groups *groups) {
    switch (which) {
    case GN_READING_young_modulus:
    case GN_READING_young_modulus_average:
        return groups->mesh ? NULL : "E";
    case GN_READING_poisson_ratio:
        return groups->mesh ? NULL : "nu";
    case GN_READING_peak_stress:
        return groups->mesh ? NULL : "strength";
    case GN_READING_peak_strain:
        return groups->mesh ? NULL : "strain at the peak";
    case GN_READING_largest_stress:
        return !groups->mesh                              ? NULL
               : strcmp(groups->study, "cantilever") == 0 ? "deflection"
                                                          : "stiffness";
    default:
        return NULL;
    }
}

static double value_of(const gn_readings *readings, gn_reading which) {
    return (&readings->young_modulus)[which];
}

/* --- errors measured in the run --- */

static size_t row_of_largest(const gn_history *history, const double *stress) {
    size_t largest = 0;
    for (size_t k = 1; k < history->row_count; k++)
        if (stress[k] > stress[largest]) largest = k;
    return largest;
}

/* Computes the median of the kinetic share over the second half of the rise to the largest stress;
 * waves dominate the first half. */
static gneiss_status kinetic_share(const gn_history *history, double *found, gneiss_error *error) {
    const double *stress = gn_history_column(history, "stress"),
                 *kinetic = gn_history_column(history, "energy_kinetic");
    GN_FREED double *share = NULL;
    *found = NAN;
    if (!stress || !kinetic || !history->row_count) return GNEISS_OK;
    size_t last = row_of_largest(history, stress), first = last / 2, count = last + 1 - first;
    GN_TRY(gn_new(&share, count, "rows of the error budget", error));
    for (size_t k = 0; k < count; k++) {
        double stored = 0.0;
        for (size_t c = 0; c < history->column_count; c++)
            if (strncmp(history->columns[c].name, "energy_elastic_", 15) == 0)
                stored += history->columns[c].value[first + k];
        share[k] = stored > 0.0 ? kinetic[first + k] / stored : 0.0;
    }
    gn_sort_numbers(share, count);
    *found = share[count / 2];
    return GNEISS_OK;
}

/* Returns the closing speed divided by wave speed and strain, as measured in this run. */
static double speed_of(const gn_world *world, const gn_history *history,
                       const gn_readings *readings) {
    const double *stress = gn_history_column(history, "stress"),
                 *time = gn_history_column(history, "time");
    double modulus = isnan(readings->young_modulus_average) ? readings->young_modulus
                                                            : readings->young_modulus_average;
    if (!stress || !time || !history->row_count) return NAN;
    double closing = gn_test_closing(&world->ctx.scene, time[row_of_largest(history, stress)]);
    return closing /
           (sqrt(modulus / gn_test_bulk_density(&world->ctx, &world->dem, &world->solids)) *
            readings->largest_strain);
}

/* Sets a cause to the measured error if that exceeds the estimate of the law. */
static void raise(gn_error_causes *causes, const char *name, double found) {
    gn_error_cause *cause = gn_causes_find(causes, name);
    if (!isfinite(found)) return;
    if (!cause)
        gn_causes_add(causes, name, found, true);
    else if (found > cause->error)
        *cause = (gn_error_cause){name, found, true, 0.0};
}

/* Sets causes to their measured errors. The stress is the mean of both ends, so that its error is
 * at most half of their difference. Kinetic energy is energy that a static test would have stored,
 * or would not have supplied. */
static void measure(const gn_world *world, const gn_budget *budget, gn_error_causes *causes) {
    raise(causes, "velocity",
          fmax(isnan(budget->imbalance) ? 0.0 : 0.5 * budget->imbalance,
               isnan(budget->kinetic) ? 0.0 : 0.5 * budget->kinetic));
    if (world->ctx.effects & GN_FX_ENERGY)
        raise(causes, "step", fabs(gn_energy_residual(&world->ledger.reading)));
}

/* Estimates the error of the largest stress between its row and the next: the stress may have risen
 * by as much as from the row before. */
static void measure_rows(const gn_history *history, gn_reading which, gn_error_causes *causes) {
    const double *stress = gn_history_column(history, "stress"),
                 *value = which == GN_READING_peak_stress   ? stress
                          : which == GN_READING_peak_strain ? gn_history_column(history, "strain")
                                                            : NULL;
    size_t row = stress ? row_of_largest(history, stress) : 0;
    if (value && row > 0) raise(causes, "rows", (value[row] - value[row - 1]) / value[row]);
}

/* Adds the error of a varying section: the ends of such a body approach each other more than those
 * of a slender bar. */
static void add_section(const gn_world *world, gn_reading which, gn_error_causes *causes) {
    const gn_bar_section *x = &world->section;
    if (which != GN_READING_young_modulus || x->guessed != 0.0 || !(x->spread > 0.0)) return;
    gn_causes_add(causes, "section", x->spread, false);
    gn_error_cause *cause = gn_causes_find(causes, "section");
    if (cause) cause->bias = -x->spread;
}

/* A peak lies between two rows: with at least this many rows up to it its error is below one per
 * cent. */
enum { ROWS_LEAST = 20 };

static const char *untold(const gn_budget *budget, const gn_history *history) {
    const double *stress = gn_history_column(history, "stress");
    if (!stress || row_of_largest(history, stress) < ROWS_LEAST)
        return "the history has fewer than 20 rows up to the largest stress";
    if (!isfinite(budget->speed))
        return "there is no reading of the modulus, which the speed of loading is relative to";
    return NULL;
}

static gneiss_status make(const gn_world *world, const gn_history *history,
                          const gn_readings *readings, gn_budget *budget, gneiss_error *error) {
    gn_test_groups g;
    *budget = (gn_budget){.speed = NAN, .imbalance = readings->end_imbalance, .kinetic = NAN};
    const char *reason = gn_study_find_case(&world->ctx, &world->dem, &g);
    if (reason) {
        snprintf(budget->absent, sizeof budget->absent, "%s", reason);
        return GNEISS_OK;
    }
    GN_TRY(kinetic_share(history, &budget->kinetic, error));
    budget->speed = g.speed = g.mesh ? NAN : speed_of(world, history, readings);
    reason = g.mesh ? NULL : untold(budget, history);
    if (reason) {
        snprintf(budget->absent, sizeof budget->absent, "%s", reason);
        return GNEISS_OK;
    }
    for (int k = 0; k < GN_READING_COUNT; k++) {
        const char *name = name_of((gn_reading)k, &g);
        if (!name || isnan(value_of(readings, (gn_reading)k))) continue;
        if (!gn_causes_predict(&g, name, &budget->of[k])) continue;
        measure(world, budget, &budget->of[k]);
        measure_rows(history, (gn_reading)k, &budget->of[k]);
        add_section(world, (gn_reading)k, &budget->of[k]);
        if (readings->nonlinearity[k] > 0.0)
            raise(&budget->of[k], "nonlinearity", readings->nonlinearity[k]);
    }
    return GNEISS_OK;
}

gneiss_status gn_budget_create(const gn_world *world, const gn_history *history,
                               const gn_readings *readings, gn_budget **budget,
                               gneiss_error *error) {
    gn_budget *b = calloc(1, sizeof *b);
    if (!b) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the error budget");
    gneiss_status status = make(world, history, readings, b, error);
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

/* Writes a number with two digits and without an exponent, which "%.2g" has from 100 on. */
static double two_digits(double value) {
    if (!isfinite(value) || value == 0.0) return value;
    const double unit = pow(10.0, floor(log10(fabs(value))) - 1.0);
    return round(value / unit) * unit;
}

const char *gn_budget_text(const gn_error_causes *causes, double value, char *text, size_t size) {
    const double worth_saying = 0.02 * gn_causes_total(causes);
    gn_error_causes sorted = *causes;
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

static void summary_of(const gn_error_causes *causes, const char *name, double value,
                       gn_json *json) {
    gn_json_object(json, name);
    gn_json_number(json, "error", fabs(value) * gn_causes_total(causes));
    gn_json_array(json, "causes");
    for (size_t k = 0; k < causes->count; k++) {
        gn_json_object(json, NULL);
        gn_json_text(json, "name", causes->cause[k].name);
        GN_JSON_NUMBERS(json, {"error", fabs(value) * causes->cause[k].error},
                        {"bias", fabs(value) * causes->cause[k].bias});
        gn_json_text(json, "is", causes->cause[k].measured ? "measured" : "estimated");
        gn_json_end(json);
    }
    gn_json_end(json);
    gn_json_array(json, "notes");
    for (size_t k = 0; k < causes->note_count; k++) gn_json_text(json, NULL, causes->note[k]);
    gn_json_end(json);
    gn_json_end(json);
}

void gn_budget_summary(const gn_budget *budget, const gn_readings *readings, gn_json *json) {
    gn_json_object(json, "error_budget");
    if (budget->absent[0]) gn_json_text(json, "absent", budget->absent);
    if (!budget->absent[0]) {
        GN_JSON_NUMBERS(json, {"speed", budget->speed}, {"end_imbalance", budget->imbalance},
                        {"kinetic_over_elastic", budget->kinetic});
    }
    for (int k = 0; k < GN_READING_COUNT; k++)
        if (budget->of[k].count)
            summary_of(&budget->of[k], names[k], value_of(readings, (gn_reading)k), json);
    gn_json_end(json);
}

gneiss_status gn_budget_results(const gn_budget *budget, const gn_readings *readings, gn_h5 *file,
                                gneiss_error *error) {
    char set[96], text[512];
    for (int k = 0; k < GN_READING_COUNT; k++) {
        const gn_error_causes *c = &budget->of[k];
        double value = value_of(readings, (gn_reading)k), of_all = fabs(value) * gn_causes_total(c),
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
