/* Warnings about the coupling of particles and elements. */
#include "laboratory/laboratory.h"
#include "run/warnings.h"

#include "base/point.h"
#include "conversion/conversion.h"
#include "run/stages.h"
#include "scene/stages.h"
#include "solids/dormant_places.h"
#include "solids/element_walls.h"
#include "world/structure.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

static void warn_of_lost(const gn_run *run, gn_warnings *list) {
    size_t count = gn_coupled_removed_count(&run->world.ctx, &run->world.zones);
    if (!count) return;
    gn_warn(list, "zones_lost",
            "%zu particles left coupling zones; the elements there still represent only their "
            "share of the material",
            count);
}

static void warn_of_zones(const gn_run *run, gn_warnings *list) {
    size_t count = gn_coupled_broken(&run->world.dem);
    if (!count) return;
    gn_warn(list, "zones_broken",
            "%zu bonds broke in coupling zones, where elements remain intact: the zone must be "
            "farther away from the crack",
            count);
}

/* Warns of elements behind walls at the end of the run. */
static void warn_of_walls(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    size_t count = 0;
    gn_warning *to = NULL;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.wall_count; k++) {
        const gn_wall_passed passed = gn_wall_passed_now(&w->ctx, &w->boundary, &w->solids, k);
        if (!passed.behind || count++) continue;
        to = gn_warn(
            list, "elements_pass_walls",
            "%zu nodes of elements are behind wall '%.60s', by at most %.3g m: elements and "
            "walls have no contact with each other; support or load elements by a motion or a "
            "load of their own",
            passed.behind, w->ctx.scene.walls[k].name, passed.deepest);
    }
    const size_t used = to ? strlen(to->text) : 0;
    if (count > 1)
        snprintf(to->text + used, sizeof to->text - used, " (and behind %zu more walls)",
                 count - 1);
}

static void warn_of_zone_masses(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.couple.zone_count; k++) {
        gn_zone_figures f;
        gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, k, &f);
        if (!gn_zone_is_off(&f)) continue;
        gn_warn(list, "zones_masses",
                "the particles of couple.zones[%zu] have %.2f times the mass that the elements "
                "leave them: they must fill the zone from side to side, with the elements' "
                "density (density_basis bulk)",
                k, f.mass);
        return;
    }
}

static void warn_of_zone_ends(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    for (size_t k = 0; w->ctx.scene.has_couple && k < w->ctx.scene.couple.zone_count; k++) {
        gn_zone_figures f;
        gn_zone_measure(&w->ctx, &w->dem, &w->solids, &w->zones, k, &f);
        if (!f.beyond) continue;
        gn_warn(list, "zones_beyond",
                "%zu of the %zu particles of couple.zones[%zu] are beyond the plane through its "
                "`to`, where elements carry the whole load: the plane must pass through the "
                "outermost centres",
                f.beyond, f.particles, k);
        return;
    }
}

static void warn_of_packing(const gn_run *run, gn_warnings *list) {
    const gn_packing_differs *d = &run->world.converted.differs;
    if (!(d->modulus[0] > 0.0)) return;
    const bool space = run->world.ctx.scene.dimension == 3;
    char last[32] = "";
    if (space) snprintf(last, sizeof last, ", %.4g", d->tension[2]);
    gn_warn(list, "packing_differs",
            "the packing has a modulus of %.4g Pa (confined; along the axes with free sides %.4g, "
            "%.4g%s Pa) and a density of %.4g kg/m3, under an affine strain; elements that "
            "convert to it have %.4g Pa (%.4g Pa) and %.4g kg/m3: conversion changes the "
            "material; calibrate the particles to the elements' E and nu",
            d->modulus[0], d->tension[0], d->tension[1], last, d->density[0], d->modulus[1],
            d->tension[3], d->density[1]);
}

/* Largest share of the energy throughput that conversions may generate. The strain energy of
 * elements differs from the energy of the springs that replace them; the ledger contains this loss
 * or gain. */
static const double made_most = 0.03;

/* Writes the largest contribution to the gain. */
static void say_what_made(const gn_conversion_parts *booked, char *text, size_t size) {
    const double parts[] = {booked->stiffness, booked->sampled, booked->uneven, booked->motion,
                            booked->step};
    const char *const why[] = {
        "", "volume: particles represent more than the elements that they replace (a thin zone)",
        "strains that vary along a bond, or contacts that had slid or broken",
        "motion: masses and velocities differ from those before",
        "the step: the power of springs over half a step (a smaller time.safety)"};
    size_t worst = 0;
    for (size_t k = 1; k < sizeof parts / sizeof *parts; k++)
        if (parts[k] < parts[worst]) worst = k;
    if (worst > 0)
        snprintf(text, size, "%.3g J of it due to %s", -parts[worst], why[worst]);
    else
        snprintf(text, size,
                 "%.3g J of it due to stiffness: the particles stored %.3g times as much at the "
                 "same strain as the elements (calibrate their E and nu to those; small packings "
                 "vary between places and axes)",
                 -parts[0], booked->alike[1] / booked->alike[0]);
}

static void warn_of_conversion(const gn_run *run, gn_warnings *list) {
    const gn_energy *e = &run->world.ledger.reading;
    const double made = -e->conversion;
    if (!(run->world.ctx.effects & GN_FX_ENERGY && made > made_most * gn_energy_scale(e))) return;
    char what[320];
    say_what_made(&run->world.converted.parts, what, sizeof what);
    gn_warn(
        list, "energy_conversion",
        "conversion of elements to particles generated %.3g of the energy throughput of %.4g J: %s",
        made / gn_energy_scale(e), gn_energy_scale(e), what);
}

/* Largest change of angular momentum by conversions, relative to the largest angular momentum of
 * the body or to m v r of its vibration (gn_tally_turns). */
static const double turned_most = 0.01;

static void warn_of_jumps(const gn_run *run, gn_warnings *list) {
    const gn_corrections *c = &run->world.converted.corrected;
    if (!(c->most > turned_most * c->scale)) return;
    gn_warn(list, "conversion_missed",
            "conversion of elements to particles changed the body's angular momentum by up to "
            "%.3g kg m2/s in total, %.2g %% of its largest value (or of m v r of its vibration), "
            "its moment of inertia by %.2g %% and the position of its centre of mass by %.2g m, "
            "which the zones could not correct; zones of more elements (couple.convert.width), "
            "and elements of two particle diameters and more, reduce this",
            c->most, 100.0 * c->most / c->scale, 100.0 * c->inertia,
            sqrt(gn_dot3(c->centre, c->centre)));
}

static void warn_of_relaxation(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_relaxations *r = &w->converted.relaxed;
    const char *const why[] = {
        "bonds would have broken, so their ends were not moved (lower limits convert sooner)",
        "some particles had no support and were not moved",
        "couple.convert.relax_iterations were used up",
        "contacts close and open, and no step reduces the energy further"};
    const double times[] = {r->stopped_by_bond_failure, r->unsupported, r->hit_iteration_limit,
                            r->missed - r->stopped_by_bond_failure - r->unsupported -
                                r->hit_iteration_limit};
    if (!(r->missed > 0.0)) return;
    gn_warning *to =
        gn_warn(list, "relaxation",
                "%.0f of %.0f relaxations of converted particles left more than %g of the "
                "mean contact force out of balance, at most %.2g (t = %.4g s)",
                r->missed, r->count, w->ctx.scene.couple.convert.relax, r->worst, r->time);
    int used = (int)strlen(to->text);
    for (int k = 0; k < 4; k++)
        if (times[k] > 0.0 && used < (int)sizeof to->text)
            used += snprintf(to->text + used, sizeof to->text - (size_t)used, "; in %.0f %s",
                             times[k], why[k]);
}

/* Warns of a run without conversions, unless the model ended the run, which has a warning of its
 * own. */
static gneiss_status warn_of_rest(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    const gn_world *w = &run->world;
    char at[GN_POINT_SIZE];
    gn_most_loaded n;
    if (!gn_converts(&w->ctx) || !run->finished || w->outcome.halt[0] ||
        gn_elements_have_left(&w->solids))
        return GNEISS_OK;
    GN_TRY(gn_conversion_most_loaded(&w->ctx, &w->solids, &w->most_loaded, &n, error));
    char where[GN_POINT_SIZE + 96] = "";
    if (n.share > 0.0)
        snprintf(where, sizeof where, " in element %d at %.90s m at t = %.4g s", n.element,
                 gn_point_text(w->ctx.scene.origin, n.place, at), n.time);
    gn_warn(list, "nothing_converted",
            "no element was converted: the highest stress was %.3g %% of a limit%s; %s",
            100.0 * n.share, where,
            n.share < 1.0 ? "lower limits (couple.convert) or more load would convert some"
                          : "no check followed (couple.convert.every)");
    return GNEISS_OK;
}

gneiss_status gn_warn_of_coupling(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    if (!run->world.ctx.scene.has_couple) return GNEISS_OK;
    warn_of_zones(run, list);
    warn_of_lost(run, list);
    warn_of_walls(run, list);
    warn_of_zone_masses(run, list);
    warn_of_zone_ends(run, list);
    warn_of_packing(run, list);
    warn_of_conversion(run, list);
    warn_of_jumps(run, list);
    warn_of_relaxation(run, list);
    return warn_of_rest(run, list, error);
}

/* ---- warnings about a membrane ---- */

static void warn_of_ramp(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!run->finished) return;
    const double past = w->ctx.time - w->membrane.state->since;
    if (w->ctx.scene.membrane.ramp - past <= w->ctx.dt) return;
    gn_warn(list, "membrane_ramp",
            "the pressure had reached %.4g Pa, %.3g of its target, when the run ended after %.4g "
            "s: membrane.ramp is %.4g s",
            w->membrane.state->pressure, past / w->ctx.scene.membrane.ramp, past,
            w->ctx.scene.membrane.ramp);
}

/* Warns of patches whose stretch is bounded. */
static void warn_of_stretch(const gn_run *run, gn_warnings *list) {
    const double unlike = run->world.membrane.state->unlike;
    if (!(unlike > 0.0)) return;
    gn_warn(list, "membrane_stretch",
            "on up to %.3g of the area of the membrane the particles have moved such that it "
            "would be stretched three times more or less than the whole; it was moved with the "
            "whole there, and the pressure is not at its target",
            unlike);
}

static double in_row(const gn_run *run, const char *column, size_t row) {
    const double *values = gn_history_column(&run->history, column);
    return values ? values[row] : 0.0;
}

/* Returns the last row with the full pressure and with all bonds intact; SIZE_MAX: there is none.
 */
static size_t row_of_pressure(const gn_run *run) {
    const double *pressure = gn_history_column(&run->history, "membrane_pressure");
    double most = 0.0;
    size_t found = SIZE_MAX;
    for (size_t r = 0; pressure && r < run->history.row_count; r++) most = fmax(most, pressure[r]);
    for (size_t r = 0; most > 0.0 && r < run->history.row_count; r++) {
        const bool whole = in_row(run, "bonds_intact", r) > 0.0 &&
                           in_row(run, "broken_tension", r) + in_row(run, "broken_shear", r) == 0.0;
        if (pressure[r] >= 0.99 * most && whole) found = r;
    }
    return found;
}

static bool pushed_otherwise(const gn_scene *scene) {
    for (size_t k = 0; k < scene->set_count; k++)
        if (scene->sets[k].has_force) return true;
    return false;
}

/* Warns of work of the membrane that the specimen does not store. An intact specimen stores that
 * work, or half of it if the pressure is applied at once; the work on grains that roll under the
 * membrane is lost to background damping. */
static void warn_of_work(const gn_run *run, gn_warnings *list) {
    static const char *const takes_up[] = {
        "energy_elastic_normal", "energy_elastic_shear", "energy_elastic_bending",
        "energy_elastic_wall",   "energy_kinetic",       "energy_rotational",
        "energy_friction",       "energy_rolling",       "energy_damage",
        "energy_plasticity",     "energy_bond_breaking"};
    const double most = 3.0;
    const size_t row = row_of_pressure(run);
    double held = 0.0;
    if (row == SIZE_MAX || pushed_otherwise(&run->world.ctx.scene)) return;
    for (size_t k = 0; k < sizeof takes_up / sizeof *takes_up; k++)
        held += in_row(run, takes_up[k], row);
    const double work = in_row(run, "energy_work_applied", row);
    if (!(work > most * held)) return;
    gn_warn(list, "membrane_work",
            "the membrane has done %.3g J of work on an intact specimen at its pressure, of which "
            "%.3g J are stored or were dissipated in contacts: the rest was done on grains that "
            "roll or fly below the membrane, and the pressure on them is wrong",
            work, held);
}

void gn_warn_of_membrane(const gn_run *run, gn_warnings *list) {
    if (!(run->world.ctx.effects & GN_FX_MEMBRANE)) return;
    warn_of_ramp(run, list);
    warn_of_stretch(run, list);
    warn_of_work(run, list);
}

void gn_warn_of_structure(const gn_run *run, gn_warnings *list) {
    const gn_scene *s = &run->world.ctx.scene;
    if (!run->finished || !s->has_structure || !s->has_specimen) return;
    if (gn_structure_porosity(&run->world) < 1.0) return;
    gn_warn(list, "structure_empty",
            "at the end no particle is in the box output.structure, so that the porosity is 1 and "
            "the other columns of structure are 0");
}

/* ---- warnings about servos that miss their targets ---- */

/* Returns the means of force and target over `count` rows up to `last`. */
static gn_servo_row mean_of(const gn_run *run, int wall, int axis, size_t last, size_t count) {
    gn_servo_row mean = {0};
    for (size_t r = last + 1 - count; r <= last; r++) {
        gn_servo_row row =
            wall >= 0 ? gn_run_wall_servo(run, (size_t)wall, r) : gn_run_side_servo(run, axis, r);
        mean.found += row.found / (double)count;
        mean.wanted += row.wanted / (double)count;
    }
    return mean;
}

/* The largest relative error of a servo, and the largest share of the stage, since the target was
 * first reached, in which the error may be larger. */
static const double servo_limit = 0.1, share_limit = 0.1;

/* Tells whether a servo misses its target; a force without a target has no error. */
static bool is_off(gn_servo_row row) {
    return row.wanted != 0.0 && fabs(row.found - row.wanted) > servo_limit * fabs(row.wanted);
}

/* Returns the mean over the last rows of the present stage. *share: fraction of earlier means over
 * as many rows that miss the target, counted from the first that does not; 0: there is none. */
static gn_servo_row look_at_servo(const gn_run *run, int wall, int axis, double *share) {
    const size_t rows = run->history.row_count,
                 begun = gn_run_staged(run)
                             ? (size_t)run->world.stages.state[run->world.stages.now].row
                             : 0;
    const size_t count = rows - begun < GN_ROWS_HELD ? rows - begun : GN_ROWS_HELD;
    size_t means = 0, off = 0;
    gn_servo_row mean = {0};
    *share = 0.0;
    if (count == 0) return mean;
    for (size_t last = begun + count - 1; last < rows; last++) {
        mean = mean_of(run, wall, axis, last, count);
        off += means > 0 && is_off(mean);
        means += means > 0 || !is_off(mean);
    }
    if (means > 0) *share = (double)off / (double)means;
    return mean;
}

/* At most this number of servos is named. */
enum { SERVOS_NAMED = 2 };

static size_t tell_of_servo(const gn_run *run, int wall, int axis, gn_servo_row mean, double share,
                            char *text, size_t size) {
    const gn_scene *s = &run->world.ctx.scene;
    const char *name = axis >= 0 ? (const char *[]){"x", "y", "z"}[axis] : s->walls[wall].name;
    const bool of_mean = axis >= 0 ? s->box[axis].of_mean : s->walls[wall].servo.of_mean;
    const char *unit = axis >= 0 || of_mean ? "Pa" : "N";
    size_t used = (size_t)snprintf(
        text, size,
        "%s%s '%.40s' has %.4g %s in the mean of the last rows, and its target is %.4g %s",
        of_mean ? "the mean stress held by " : "", axis >= 0 ? "side" : "wall", name, mean.found,
        unit, mean.wanted, unit);
    if (share > share_limit && used < size)
        used += (size_t)snprintf(
            text + used, size - used,
            " (and was off by more than a tenth in %.0f %% of the %s since it was first reached)",
            100.0 * share, gn_run_staged(run) ? "stage" : "run");
    return used < size ? used : size - 1;
}

void gn_warn_of_servos(const gn_run *run, gn_warnings *list) {
    const gn_scene *s = &run->world.ctx.scene;
    char text[400] = "";
    size_t used = 0, count = 0;
    bool pulls = false;
    for (int k = 0; run->finished && k < 3 + (int)s->wall_count; k++) {
        const int wall = k - 3, axis = k < 3 ? k : -1;
        bool active = axis >= 0 ? s->box[axis].stress.count > 0 : s->walls[wall].servo.active;
        double share = 0.0;
        gn_servo_row mean = active ? look_at_servo(run, wall, axis, &share) : (gn_servo_row){0};
        if (!is_off(mean) && share <= share_limit) continue;
        pulls =
            pulls || (wall >= 0 && mean.wanted < 0.0 && !(run->world.ctx.effects & GN_FX_COHESION));
        if (count++ >= SERVOS_NAMED) continue;
        if (used) used += (size_t)snprintf(text + used, sizeof text - used, "; ");
        used += tell_of_servo(run, wall, axis, mean, share, text + used, sizeof text - used);
    }
    if (!count) return;
    gn_warning *to = gn_warn(list, "servo_not_held", "%s", text);
    size_t at = strlen(to->text);
    if (count > SERVOS_NAMED)
        at += (size_t)snprintf(to->text + at, sizeof to->text - at, "; and %zu more",
                               count - SERVOS_NAMED);
    snprintf(to->text + at, sizeof to->text - at, ": %s",
             pulls ? "a wall can only push, and its target is a pull"
                   : "there was too little time, or the loaded material yields faster than the "
                     "servo follows; use a later end, a larger max_velocity, max_rate or "
                     "relaxation, or a wall that is less stiff");
}

/* ---- warnings about the readings ---- */

/* Largest relative difference between the two ends. Waves, gravity and viscous damping cause a
 * small difference in a dynamic test; a support that is not included takes half of the load. */
static const double imbalance_limit = 0.1;

static void warn_of_balance(const gn_readings *readings, gn_warnings *list) {
    if (!(readings->end_imbalance > imbalance_limit)) return;
    gn_warn(
        list, "end_imbalance",
        "the forces of the two ends of the test differ by %.0f %% of their mean: because of "
        "inertia (fast loading) or background damping of a rigid motion, because something else "
        "loads or supports the specimen, or because an end omits a part (it may be a list)",
        100.0 * readings->end_imbalance);
}

/* Largest increase of the stress from one row to the next: that of a uniform increase over twenty
 * rows. */
static const double rise_limit = 0.05;

static void warn_of_rows(const gn_readings *readings, gn_warnings *list) {
    if (isnan(readings->peak_stress) || !(readings->peak_rise > rise_limit)) return;
    gn_warning *to =
        gn_warn(list, "peak_rows",
                "the peak was read from a row of the history whose stress is %.0f %% above that "
                "of the row before: between rows it may have been %.4g Pa instead of %.4g Pa",
                100.0 * readings->peak_rise / (1.0 - readings->peak_rise),
                (1.0 + readings->peak_rise) * readings->peak_stress, readings->peak_stress);
    int used = (int)strlen(to->text);
    if (readings->peak_rise >= 1.0)
        used = snprintf(to->text, sizeof to->text,
                        "the peak, %.4g Pa, was read from the first row of the history with a "
                        "load: before it and after it the stress may have been larger",
                        readings->peak_stress);
    if (!isnan(readings->peak_strain))
        used += snprintf(to->text + used, sizeof to->text - (size_t)used,
                         ", at a strain between %.4g and %.4g", readings->peak_strain_least,
                         readings->peak_strain_most);
    snprintf(to->text + used, sizeof to->text - (size_t)used,
             ": more output.history_rows resolve it better");
}

/* Largest vanished initial stress relative to the later peak; a larger one may have broken bonds.
 */
static const double initial_limit = 0.5;

static void warn_of_beginning(const gn_readings *readings, gn_warnings *list) {
    /* Without a peak the largest stress of the test is used. */
    const double most =
        isnan(readings->peak_stress) ? readings->largest_stress : readings->peak_stress;
    if (!(readings->initial_fall > initial_limit * most)) return;
    gn_warn(list, "initial_stress",
            "the ends carried %.4g Pa before they moved, and %.4g Pa of that vanished: it is not "
            "part of the readings, but may have broken bonds (ends that start inside particles "
            "push them away: use passive: true of walls, or ends farther out)",
            readings->initial_stress, readings->initial_fall);
}

/* Narrowest section over the one of the stress above which a body counts as a prism. */
static const double nearly_even = 0.9;

/* Warns of a body whose stresses differ from section to section. */
static void warn_of_stress(const gn_run *run, const gn_readings *readings, gn_warnings *list) {
    const gn_bar_section *x = &run->world.section;
    const double area = run->world.ctx.test_area;
    if (isnan(readings->largest_stress) || !(x->narrowest < nearly_even * area)) return;
    gn_warn(list, "uneven_section",
            "stresses and strengths are forces over %.4g m2, and the narrowest section across %c "
            "has %.4g m2: they are those of this body, not of a prism or of the material",
            area, "xyz"[run->world.ctx.scene.test.axis], x -> narrowest);
}

/* Warns of a body of varying section: of its moduli if no shape gives its volume, else of its
 * stresses. */
static void warn_of_section(const gn_run *run, const gn_readings *readings, gn_warnings *list) {
    const gn_bar_section *x = &run->world.section;
    if (!(x->mean > 0.0)) return;
    if (x->guessed == 0.0 || isnan(readings->young_modulus)) {
        warn_of_stress(run, readings, list);
        return;
    }
    gn_warn(list, "uneven_section",
            "the section varies along %c (%.3g of the mean at the narrowest section) and no shape "
            "gives it: moduli are those of a prism of %.4g m2, not of the material (pack a shape, "
            "or write a packing with `gneiss pack`)",
            "xyz"[run->world.ctx.scene.test.axis], x -> narrowest / x -> mean,
            run -> world.ctx.test_area);
}

/* Tells whether the stress of the test had its expected sign in some row. All rows of the run are
 * checked, because some stages unload the load of others. */
static bool measured(const gn_run *run, const gn_readings *readings) {
    const double *stress = gn_history_column(&run->history, "stress");
    if (!gn_run_staged(run) && !gn_scene_test(&run->world.ctx.scene)->tool)
        return !isnan(readings->largest_stress);
    if (run->world.stages.now + 1 < run->world.ctx.scene.stage_count)
        return true; /* the last stage was not reached */
    for (size_t k = 0; stress && k < run->history.row_count; k++)
        if (stress[k] > 0.0) return true;
    return false;
}

static void warn_of_nothing(const gn_run *run, const gn_readings *readings, gn_warnings *list) {
    const gn_scene *s = &run->world.ctx.scene;
    if (!gn_scene_tested(s) || !run->finished || run->history.row_count < 2) return;
    if (measured(run, readings)) return;
    if (gn_scene_test(s)->tool) {
        char text[GNEISS_MESSAGE_SIZE];
        gn_no_force_text(run, text, sizeof text);
        gn_warn(list, "nothing_measured", "the cut has no force: %s", text);
        return;
    }
    gn_warn(list, "nothing_measured", "the test has no strength and no modulus: %s%s",
            gn_run_staged(run) ? "the stress never had the sense of the test"
                               : readings->reason[GN_READING_largest_stress],
            gn_scene_test(s)->ends
                ? " (do the ends move, in the sense of the test, and reach the specimen in time?)"
                : "");
}

/* Warns that the model ended the run (conversion/conversion.c) before the end of the test. */
static void warn_of_halted_peak(const gn_run *run, const gn_readings *readings, gn_warnings *list) {
    const gn_world *w = &run->world;
    const double drop = gn_run_staged(run) ? w->ctx.scene.stages[w->stages.now].peak_drop
                                           : gn_scene_peak_drop(&w->ctx.scene);
    if (!run->finished || !w->outcome.halt[0] || isnan(readings->peak_stress)) return;
    if (!(readings->peak_fall < drop)) return;
    gn_warn(list, "peak_halted",
            "conversion ended the run (conversion_halted) with the stress %.1f %% below the %.4g "
            "Pa from which strengths were read, not the %.1f %% with which a test ends: it might "
            "have risen above that again",
            100.0 * readings->peak_fall, readings->peak_stress, 100.0 * drop);
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
