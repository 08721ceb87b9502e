#include "accuracy/causes.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void add(gn_error_causes *causes, gn_error_cause cause) {
    if (causes->count < GN_CAUSES_MAX) causes->cause[causes->count++] = cause;
}

void gn_causes_add(gn_error_causes *causes, const char *name, double error, bool measured) {
    add(causes, (gn_error_cause){name, error, measured, 0.0});
}

void gn_causes_note(gn_error_causes *causes, const char *format, ...) {
    va_list args;
    if (causes->note_count == GN_CAUSE_NOTES_MAX) return;
    va_start(args, format);
    vsnprintf(causes->note[causes->note_count++], GN_CAUSE_NOTE_SIZE, format, args);
    va_end(args);
}

gn_error_cause *gn_causes_find(gn_error_causes *causes, const char *name) {
    for (size_t k = 0; k < causes->count; k++)
        if (strcmp(causes->cause[k].name, name) == 0) return &causes->cause[k];
    return NULL;
}

static bool of_packings(const gn_error_cause *cause) {
    return strcmp(cause->name, "packing") == 0 || strcmp(cause->name, "round-off") == 0;
}

static double total(const gn_error_causes *causes, bool scatter) {
    double high = 0.0, low = 0.0, squares = 0.0;
    for (size_t k = 0; k < causes->count; k++) {
        const gn_error_cause *cause = &causes->cause[k];
        if (!scatter && of_packings(cause)) continue;
        high += fmax(cause->bias, 0.0);
        low += fmax(-cause->bias, 0.0);
        squares += cause->error * cause->error - cause->bias * cause->bias;
    }
    return hypot(fmax(high, low), sqrt(fmax(squares, 0.0)));
}

double gn_causes_total(const gn_error_causes *causes) {
    return total(causes, true);
}

double gn_causes_without_scatter(const gn_error_causes *causes) {
    return total(causes, false);
}

/* --- laws --- */

/* Two standard errors in addition to the bias. */
static double width(const gn_slope *law, double group) {
    return hypot(gn_slope_at(law, group), 2.0 * gn_slope_error_at(law, group));
}

/* Adds the value of a law, with a note if the group is beyond the measured range. */
static bool add_bias(gn_error_causes *causes, const gn_test_groups *groups, const char *reading,
                     const char *effect, const char *name, double group) {
    const gn_slope *law = gn_slope_find(groups->study, reading, effect, false);
    if (!law || isnan(group)) return false;
    add(causes, (gn_error_cause){name, width(law, group), false, gn_slope_at(law, group)});
    if (group > 1.001 * law->high)
        gn_causes_note(causes, "%s: %s of %.2g is beyond the range of the study (up to %.2g)", name,
                       law->group, group, law->high);
    return true;
}

/* Adds two standard deviations of the mean over the packings, `more` times the law. */
static void add_scatter(gn_error_causes *causes, const gn_test_groups *groups, const char *reading,
                        const char *effect, const char *name, double group, double more) {
    const gn_slope *law = gn_slope_find(groups->floors, reading, effect, true);
    if (!law) law = gn_slope_find(groups->study, reading, effect, true);
    if (!law) return;
    double deviation = more * gn_slope_at(law, group);
    gn_causes_add(causes, name, 2.0 * deviation / sqrt(fmax(1.0, groups->packings)), false);
}

/* Returns the scatter of many packings of one size over that of the law, which has five packings of
 * each size; with these bonds if they were studied. */
static double of_many(const gn_test_groups *groups, const char *reading) {
    char quantity[96];
    double ratio = NAN;
    if (groups->bonds) {
        snprintf(quantity, sizeof quantity, "scatter over its law: %s, %s", reading, groups->bonds);
        ratio = gn_slope_base_of(groups->floors, quantity);
    }
    snprintf(quantity, sizeof quantity, "scatter over its law: %s", reading);
    if (!isfinite(ratio)) ratio = gn_slope_base_of(groups->floors, quantity);
    return isfinite(ratio) ? fmax(1.0, ratio) : 1.0;
}

/* In planar cases scatter is a law of 1/particles. */
static double packing_group(const gn_test_groups *groups, const char *reading,
                            const char **effect) {
    *effect = "particles";
    if (gn_slope_find(groups->floors, reading, "particles", true)) return 1.0 / groups->particles;
    *effect = "packing";
    return groups->particles;
}

/* --- model choices, which are no errors --- */

/* A reading that does not converge with the number of particles has no error, only a drift; neither
 * has a converging one, as contacts are calibrated for a number of particles. */
static void note_size(gn_error_causes *causes, const gn_test_groups *groups, const char *reading) {
    const double converged = 0.05;
    const gn_slope *law = gn_slope_find(groups->study, reading, "size", false);
    if (!law || isnan(groups->across)) return;
    double off = gn_slope_at(law, groups->across), last = gn_slope_at(law, law->high),
           drift = law->exponent * off / (1.0 + off);
    if (fabs(last) > converged)
        gn_causes_note(causes,
                       "size: not in the sum, because it does not converge: with constant contacts "
                       "it still goes as n^%.2f (n: %.3g particles across); calibrate with this "
                       "number",
                       drift, groups->across);
    else
        gn_causes_note(causes,
                       "size: not in the sum: with constant contacts %+.1f %% against many "
                       "particles; calibrate with this number",
                       100.0 * off);
}

static void note_damping(gn_error_causes *causes, const gn_test_groups *groups,
                         const char *reading) {
    const double from = 0.4; /* above it strength hardly depends on it */
    const gn_slope *little = gn_slope_find(groups->study, reading, "little damping", false);
    if (groups->damping < 0.0)
        gn_causes_note(causes,
                       "damping: a choice of model; the study covers only non-viscous ones");
    else if (groups->damping < from && little)
        gn_causes_note(causes, "damping: a choice of model: %+.1f %% with %g against 0.7",
                       100.0 * gn_slope_at(little, groups->damping), groups->damping);
}

/* --- a test --- */

static void predict_particles(const gn_test_groups *groups, const char *reading,
                              gn_error_causes *causes) {
    const char *effect;
    double group = packing_group(groups, reading, &effect);
    if (!add_bias(causes, groups, reading, "velocity", "velocity", groups->speed))
        gn_causes_note(causes, "velocity: unknown for this test");
    add_bias(causes, groups, reading, "safety", "step", groups->safety);
    add_scatter(causes, groups, reading, effect, "packing", group, of_many(groups, reading));
    add_scatter(causes, groups, reading, "round-off", "round-off", 0.0, 1.0);
    if (groups->mixed) add_bias(causes, groups, reading, "precision", "precision", 0.0);
    if (groups->step_ratio > 1.0 &&
        !add_bias(causes, groups, reading, "mass scaling", "mass scaling", groups->step_ratio))
        gn_causes_note(causes, "mass scaling: the study has no law of it");
    if (groups->first_break && !add_bias(causes, groups, reading, "start", "start", 0.0))
        gn_causes_note(causes, "start: the study has no law of it");
    note_size(causes, groups, reading);
    note_damping(causes, groups, reading);
}

/* Loads and supports are nodes, under which the deflection of a continuum diverges (Flamant):
 * measured on two beams of other sizes than the study's (docs/evidence/planner.md). */
static void note_points(gn_error_causes *causes, const gn_test_groups *groups,
                        const char *reading) {
    if (strcmp(groups->study, "notched-elements") != 0 || strcmp(reading, "stiffness") != 0) return;
    gn_causes_note(causes, "load and supports are points: not in the sum, as the stiffness between "
                           "them does not converge: 2 to 5 %% less for each halving of cells; "
                           "compare equal cells, or read the opening of the notch");
}

static void predict_elements(const gn_test_groups *groups, const char *reading,
                             gn_error_causes *causes) {
    if (!add_bias(causes, groups, reading, groups->mesh, "mesh", groups->cell))
        gn_causes_note(causes, "mesh: the study has no law of it");
    if (groups->tip > 0.0)
        add_bias(causes, groups, reading, "cells at the tip", "notch", groups->tip);
    if (groups->mixed) add_bias(causes, groups, reading, "precision", "precision", 0.0);
    note_points(causes, groups, reading);
}

bool gn_causes_predict(const gn_test_groups *groups, const char *reading, gn_error_causes *causes) {
    bool known = false;
    *causes = (gn_error_causes){0};
    for (size_t k = 0; k < gn_slope_count; k++)
        known |= strcmp(gn_slopes[k].study, groups->study) == 0 &&
                 strcmp(gn_slopes[k].reading, reading) == 0;
    if (!known) return false;
    if (groups->mesh)
        predict_elements(groups, reading, causes);
    else
        predict_particles(groups, reading, causes);
    return true;
}
