/* Warnings about the readings. */
#include "laboratory/laboratory.h"
#include "run/stages.h"
#include "run/warnings.h"
#include "scene/stops.h"

#include <math.h>

/* Waves, gravity and viscous damping cause a small difference between the ends of a dynamic test; a
 * support that is not included accounts for half of the load. */
static const double imbalance_limit = 0.1;

static void warn_of_balance(const gn_readings *r, gn_warnings *list) {
    if (!(r->end_imbalance > imbalance_limit)) return;
    gn_warning *to = gn_warnings_add(list, "end_imbalance");
    snprintf(
        to->text, sizeof to->text,
        "the forces of the two ends of the test differ by %.0f %% of their mean: because of "
        "inertia (fast loading) or background damping of a rigid motion, because something else "
        "loads or supports the specimen, or because an end omits a part (it may be a list)",
        100.0 * r->end_imbalance);
}

/* The largest rise from one row to the next, that of twenty rows of a stress that rises evenly. */
static const double rise_limit = 0.05;

static void warn_of_rows(const gn_readings *r, gn_warnings *list) {
    if (isnan(r->peak_stress) || !(r->peak_rise > rise_limit)) return;
    gn_warning *to = gn_warnings_add(list, "peak_rows");
    int used =
        snprintf(to->text, sizeof to->text,
                 "the peak was read from a row of the history whose stress is %.0f %% above that "
                 "of the row before: between rows it may have been %.4g Pa instead of %.4g Pa",
                 100.0 * r->peak_rise / (1.0 - r->peak_rise), (1.0 + r->peak_rise) * r->peak_stress,
                 r->peak_stress);
    if (r->peak_rise >= 1.0)
        used = snprintf(to->text, sizeof to->text,
                        "the peak, %.4g Pa, was read from the first row of the history with a "
                        "load: before it and after it the stress may have been larger",
                        r->peak_stress);
    if (!isnan(r->peak_strain))
        used += snprintf(to->text + used, sizeof to->text - (size_t)used,
                         ", at a strain between %.4g and %.4g", r->peak_strain_least,
                         r->peak_strain_most);
    snprintf(to->text + used, sizeof to->text - (size_t)used,
             ": more output.history_rows resolve it better");
}

/* The largest initial stress that vanished, relative to the later peak: as much may break bonds. */
static const double initial_limit = 0.5;

static void warn_of_beginning(const gn_readings *r, gn_warnings *list) {
    /* Without a peak the largest stress of the test is used. */
    const double most = isnan(r->peak_stress) ? r->largest_stress : r->peak_stress;
    if (!(r->initial_fall > initial_limit * most)) return;
    gn_warning *to = gn_warnings_add(list, "initial_stress");
    snprintf(to->text, sizeof to->text,
             "the ends carried %.4g Pa before they moved, and %.4g Pa of that vanished: it is not "
             "part of the readings, but may have broken bonds (ends that start inside particles "
             "push them away: use passive: true of walls, or ends farther out)",
             r->initial_stress, r->initial_fall);
}

/* Warns of a body of varying section without a shape that gives its volume. */
static void warn_of_section(const gn_run *run, const gn_readings *r, gn_warnings *list) {
    const gn_bar_section *x = &run->world.section;
    if (!(x->mean > 0.0) || x->guessed == 0.0 || isnan(r->young_modulus)) return;
    gn_warning *to = gn_warnings_add(list, "uneven_section");
    snprintf(to->text, sizeof to->text,
             "the section varies along %c (%.3g of the mean at the narrowest section) and no shape "
             "gives it: moduli are those of a prism of %.4g m2, not of the material (pack a shape, "
             "or write a packing with `gneiss pack`)",
             "xyz"[run->world.ctx.scene.test.axis], x -> narrowest / x -> mean,
             run -> world.ctx.test_area);
}

/* Tells whether the test had a stress in its sense. Some stages unload the load of others, so all
 * rows of the run are checked. */
static bool measured(const gn_run *run, const gn_readings *r) {
    const double *stress = gn_history_column(&run->history, "stress");
    if (!gn_run_staged(run)) return !isnan(r->largest_stress);
    if (run->world.stages.now + 1 < run->world.ctx.scene.stage_count)
        return true; /* the last stage was not reached */
    for (size_t k = 0; stress && k < run->history.row_count; k++)
        if (stress[k] > 0.0) return true;
    return false;
}

static void warn_of_nothing(const gn_run *run, const gn_readings *r, gn_warnings *list) {
    const gn_scene *s = &run->world.ctx.scene;
    if (!gn_scene_tested(s) || !run->finished || run->history.row_count < 2) return;
    if (measured(run, r)) return;
    gn_warning *to = gn_warnings_add(list, "nothing_measured");
    snprintf(to->text, sizeof to->text, "the test has no strength and no modulus: %s%s",
             gn_run_staged(run) ? "the stress never had the sense of the test"
                                : r->reason[GN_READING_largest_stress],
             gn_scene_test(s)->ends
                 ? " (do the ends move, in the sense of the test, and reach the specimen in time?)"
                 : "");
}

/* Warns that the model ended the run (conversion/conversion.c) before the end of the test. */
static void warn_of_halted_peak(const gn_run *run, const gn_readings *r, gn_warnings *list) {
    const double drop = gn_scene_peak_drop(&run->world.ctx.scene);
    if (!run->finished || !run->world.outcome.halt[0] || isnan(r->peak_stress)) return;
    if (!(r->peak_fall < drop)) return;
    gn_warning *to = gn_warnings_add(list, "peak_halted");
    snprintf(to->text, sizeof to->text,
             "conversion ended the run (conversion_halted) with the stress %.1f %% below the %.4g "
             "Pa from which strengths were read, not the %.1f %% with which a test ends: it might "
             "have risen above that again",
             100.0 * r->peak_fall, r->peak_stress, 100.0 * drop);
}

gneiss_status gn_warn_of_readings(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    const gn_readings *r;
    GN_TRY(gn_run_readings(run, &r, error));
    warn_of_balance(r, list);
    warn_of_rows(r, list);
    warn_of_halted_peak(run, r, list);
    warn_of_beginning(r, list);
    warn_of_section(run, r, list);
    warn_of_nothing(run, r, list);
    return GNEISS_OK;
}
