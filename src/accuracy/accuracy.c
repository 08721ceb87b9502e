#include "accuracy/accuracy.h"

#include "frame/parts.h"
#include "scene/acts.h"
#include "scene/scene.h"
#include "world/world.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* ---- results of the study of accuracy (docs/evidence/accuracy.md): errors of readings over
 * dimensionless groups, and some ratios of its tests. The tables are made from
 * validate/accuracy/slopes.csv and base.csv when the program is built ---- */

const gn_slope *gn_slope_find(const char *study, const char *reading, const char *effect,
                              bool scatter) {
    for (size_t k = 0; k < gn_slope_count; k++) {
        const gn_slope *slope = &gn_slopes[k];
        if (strcmp(slope->study, study) == 0 && strcmp(slope->reading, reading) == 0 &&
            strcmp(slope->effect, effect) == 0 && slope->scatter == scatter)
            return slope;
    }
    return NULL;
}

double gn_slope_at(const gn_slope *slope, double group) {
    switch (slope->form) {
    case GN_SLOPE_POWER:
        return slope->coefficient * pow(group / slope->reference, slope->exponent);
    case GN_SLOPE_LINEAR:
        return slope->coefficient * (group - slope->reference);
    case GN_SLOPE_EXPONENTIAL:
        return slope->coefficient * exp(-group / slope->reference);
    case GN_SLOPE_RATIO:
        return pow(group / slope->reference, slope->exponent) - 1.0;
    case GN_SLOPE_CONSTANT:
        break;
    }
    return slope->coefficient;
}

static double or_none(double value) {
    return isnan(value) ? 0.0 : value;
}

/* Coefficient and exponent of a power law were fitted about the reference, so that their errors are
 * independent. */
double gn_slope_error_at(const gn_slope *slope, double group) {
    double coefficient = or_none(slope->coefficient_error),
           exponent = or_none(slope->exponent_error);
    switch (slope->form) {
    case GN_SLOPE_POWER:
        return fabs(gn_slope_at(slope, group)) *
               hypot(coefficient, exponent * log(group / slope->reference));
    case GN_SLOPE_LINEAR:
        return coefficient * fabs(group - slope->reference);
    case GN_SLOPE_EXPONENTIAL:
        return coefficient * exp(-group / slope->reference);
    case GN_SLOPE_RATIO:
        return (1.0 + gn_slope_at(slope, group)) * exponent * fabs(log(group / slope->reference));
    case GN_SLOPE_CONSTANT:
        break;
    }
    return coefficient;
}

double gn_slope_base_of(const char *study, const char *quantity) {
    for (size_t k = 0; k < gn_slope_base_count; k++)
        if (strcmp(gn_slope_bases[k].study, study) == 0 &&
            strcmp(gn_slope_bases[k].quantity, quantity) == 0)
            return gn_slope_bases[k].value;
    return NAN;
}

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

/* Returns two standard errors, which are added to the bias. */
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

/* Adds two standard deviations of the mean over the packings: those of the law times `more`. */
static void add_scatter(gn_error_causes *causes, const gn_test_groups *groups, const char *reading,
                        const char *effect, const char *name, double group, double more) {
    const gn_slope *law = gn_slope_find(groups->floors, reading, effect, true);
    if (!law) law = gn_slope_find(groups->study, reading, effect, true);
    if (!law) return;
    double deviation = more * gn_slope_at(law, group);
    gn_causes_add(causes, name, 2.0 * deviation / sqrt(fmax(1.0, groups->packings)), false);
}

/* Returns the ratio of the scatter over many packings of one size to that of the law, which has
 * five packings of each size; for these bonds if they were studied. */
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

/* Returns the group of the packing; in planar cases the scatter is a power law of 1/particles. */
static double packing_group(const gn_test_groups *groups, const char *reading,
                            const char **effect) {
    *effect = "particles";
    if (gn_slope_find(groups->floors, reading, "particles", true)) return 1.0 / groups->particles;
    *effect = "packing";
    return groups->particles;
}

/* --- model choices, which are not errors --- */

/* Adds a note about the number of particles. A reading that does not converge with it has no error,
 * only a drift; a reading that converges has no error either, because contacts are calibrated for a
 * number of particles. */
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
    const double from = 0.4; /* above this value strength hardly depends on the argument */
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

/* Adds a note about loads and supports at single nodes, under which the deflection of a continuum
 * diverges (Flamant): measured on two beams of other sizes than the study's
 * (docs/evidence/planner.md). */
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

/* ---- the case of the study of accuracy that represents a scene, and the groups of its laws ----
 */

/* --- ends --- */

/* Returns the mean over the parts of an end. */
static double end_of(const gn_scene *scene, const gn_test_end *end, double time, bool path) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        if (!motion) continue;
        const gn_table *table = &motion->velocity[scene->test.axis];
        sum += path ? gn_table_between(table, 0.0, time) : gn_table_at(table, time);
    }
    return end->count ? sum / (double)end->count : 0.0;
}

static double apart(const gn_scene *scene, double time, bool path) {
    const double sign = (double)gn_scene_test(scene)->sign;
    return sign * (end_of(scene, &scene->test.upper, time, path) -
                   end_of(scene, &scene->test.lower, time, path));
}

double gn_test_closing(const gn_scene *scene, double time) {
    return apart(scene, time, false);
}

/* Tables are linear between points, so that the largest value is at a point. */
static double fastest_at_points(const gn_scene *scene, const gn_test_end *end, double fastest) {
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        const gn_table *table = motion ? &motion->velocity[scene->test.axis] : NULL;
        for (size_t p = 0; table && p < table->count; p++)
            if (table->time[p] <= scene->end)
                fastest = fmax(fastest, gn_test_closing(scene, table->time[p]));
    }
    return fastest;
}

double gn_test_fastest(const gn_scene *scene) {
    double fastest = gn_test_closing(scene, scene->end);
    fastest = fastest_at_points(scene, &scene->test.lower, fastest);
    return fastest_at_points(scene, &scene->test.upper, fastest);
}

double gn_test_path(const gn_scene *scene, double time) {
    return apart(scene, time, true);
}

double gn_test_bulk_density(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_solids *solids) {
    return gn_world_mass(dem, solids) / ctx->volume;
}

/* --- particles --- */

/* Returns the number of particles along the shortest side across the axis of the test. */
static double particles_across(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double shortest = INFINITY, radii = 0.0;
    for (int a = 0; a < ctx->scene.dimension; a++)
        if (a != ctx->scene.test.axis) shortest = fmin(shortest, ctx->upper[a] - ctx->lower[a]);
    for (size_t p = 0; p < q->soa.count; p++) radii += q->pos[4 * p + 3];
    return shortest * (double)q->soa.count / (2.0 * radii);
}

static double damping_of(const gn_scene *scene) {
    switch (scene->background) {
    case GN_BACKGROUND_NONE:
        return 0.0;
    case GN_BACKGROUND_NONVISCOUS_VECTOR:
    case GN_BACKGROUND_NONVISCOUS_COMPONENT:
        return scene->background_coefficient;
    case GN_BACKGROUND_VISCOUS:
        break;
    }
    return -1.0;
}

/* Returns the law of bonds whose packings the study covers (validate/accuracy/scatter.py): all
 * uniform laws count as mean_radius, and both laws by area as dempack. */
static const char *bonds_of(const gn_scene *scene) {
    switch (scene->stiffness) {
    case GN_STIFFNESS_HARMONIC:
        return "harmonic";
    case GN_STIFFNESS_ARITHMETIC:
        return "arithmetic";
    case GN_STIFFNESS_UNIFORM:
    case GN_STIFFNESS_MEAN_RADIUS:
    case GN_STIFFNESS_MEAN_ARITHMETIC:
    case GN_STIFFNESS_MEAN_HARMONIC:
        return "mean_radius";
    case GN_STIFFNESS_DEMPACK:
    case GN_STIFFNESS_POLYHEDRON:
        return "dempack";
    case GN_STIFFNESS_HERTZ:
        break;
    }
    return NULL;
}

static const char *cover_particles(const gn_step_context *ctx, const gn_dem *dem,
                                   gn_test_groups *groups) {
    const gn_scene *scene = &ctx->scene;
    const gn_test_descriptor *d = gn_scene_test(scene);
    const bool plane = scene->dimension == 2, crushed = d->sign < 0;
    if (scene->bonds != GN_SWITCH_ON || !dem->bonds_at_start)
        return "the study has no test of unbonded particles";
    if (ctx->effects & (GN_FX_SOFTENING | GN_FX_YIELD | GN_FX_BOND_MOMENTS))
        return "the study has no bonds that soften, yield or carry moments";
    if (!d->study) return "for particles the study covers compression and tension";
    if (scene->has_membrane) return "the study has no test under a membrane";
    if (scene->has_elements) return "the study has no test of coupled particles and elements";
    if (scene->body_count) return "the study has no test with bodies";
    if (scene->has_periodic) return "the study has no periodic test";
    if (plane && scene->specimen.pack.shape == GN_SHAPE_DISC && crushed)
        return "the study predicts no peak of a Brazilian disc";
    groups->study = d->study;
    /* Discs scatter more than spheres, particularly in compression. */
    groups->floors = !plane ? groups->study : crushed ? "compression-plane" : "brazilian";
    groups->bonds = bonds_of(scene);
    groups->particles = (double)dem->particles.soa.count;
    groups->across = particles_across(ctx, dem);
    groups->step_ratio = ctx->choice.scaling.step > 0.0
                             ? ctx->choice.scaling.step / ctx->choice.scaling.unscaled
                             : 1.0;
    groups->first_break = scene->start == GN_START_FIRST_BREAK;
    groups->damping = damping_of(scene);
    return NULL;
}

/* --- elements --- */

static const char *cover_elements(const gn_scene *scene, gn_test_groups *groups) {
    const gn_element_def *elements = &scene->elements;
    bool mixed_form = elements->formulation == GN_FORMULATION_PRESSURE;
    if (elements->has_beam && elements->beam.notch_depth > 0.0) {
        *groups = (gn_test_groups){.study = "notched-elements", .mesh = "cell"};
        groups->cell = elements->beam.cell / elements->beam.height;
        groups->tip = 1.0 / (double)elements->beam.notch_cells;
    } else if (elements->has_rectangle &&
               elements->size[1 - scene->test.axis] >= 4.0 * elements->size[scene->test.axis]) {
        *groups = (gn_test_groups){.study = "cantilever",
                                   .mesh = mixed_form ? "elements, mixed form" : "elements"};
        groups->cell = 1.0 / (double)elements->cells[scene->test.axis];
    } else {
        return "for elements the study covers notched beams and rectangles in bending";
    }
    groups->floors = groups->study;
    groups->packings = 1.0;
    return NULL;
}

const char *gn_study_find_case(const gn_step_context *ctx, const gn_dem *dem,
                               gn_test_groups *groups) {
    const gn_scene *scene = &ctx->scene;
    *groups = (gn_test_groups){.packings = 1.0, .step_ratio = 1.0, .speed = NAN, .across = NAN};
    if (!gn_scene_tested(scene)) return "the scene has no test";
    if (scene->stage_count) return "the study has no test in stages";
    const char *reason =
        scene->has_specimen ? cover_particles(ctx, dem, groups) : cover_elements(scene, groups);
    groups->speed = NAN;
    /* A later reduction of an automatic step does not affect its safety. */
    groups->safety = ctx->step > 0 && scene->step == 0.0 ? scene->safety : ctx->dt / ctx->stable;
    groups->mixed = ctx->effects & GN_FX_MIXED;
    return reason;
}
