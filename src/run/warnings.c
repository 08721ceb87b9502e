/* Warnings about the validity of results, and the check that the energy ledger closes. */
#include "run/warnings.h"
#include "base/point.h"
#include "conversion/conversion.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "particles/bonds.h"
#include "particles/joints.h"
#include "particles/specimen.h"
#include "run/run.h"
#include "run/stages.h"
#include "scene/acts.h"
#include "timestep/indentation.h"
#include "timestep/timestep.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

double gn_run_residual(const gn_run *run) {
    const gn_world *w = &run->world;
    return w->ctx.effects & GN_FX_ENERGY ? fabs(gn_energy_residual(&w->ledger.reading)) : NAN;
}

/* Tells whether the residual exceeds a limit; NaN does. */
static bool beyond(const gn_run *run, double limit) {
    return run->world.ctx.effects & GN_FX_ENERGY && run->history.row_count > 0 && limit > 0.0 &&
           !(gn_run_residual(run) <= limit);
}

/* Number of steps for which the residual must persist to count. The first contacts of a run begin
 * between two steps, and for some steps the residual is that of their onset. */
enum { STEPS_OF_ONSET = 100 };

static gneiss_status fail(const gn_run *run, const char *since, gneiss_error *error) {
    const gn_world *w = &run->world;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: the energy ledger does not close: %.3g of the energy throughput of "
        "%.4g J is unexplained (run.residual_limit: %g)%s; try a smaller time.safety",
        (long long)w->ctx.step, w->ctx.time, gn_energy_residual(&w->ledger.reading),
        gn_energy_scale(&w->ledger.reading), w->ctx.scene.residual_limit, since);
}

gneiss_status gn_run_check_ledger(gn_run *run, gneiss_error *error) {
    char since[64];
    int64_t now = run->world.ctx.step - 1;
    if (!beyond(run, run->world.ctx.scene.residual_limit)) {
        run->bad_since = -1;
        return GNEISS_OK;
    }
    if (run->bad_since < 0) run->bad_since = now;
    if (now - run->bad_since < STEPS_OF_ONSET) return GNEISS_OK;
    snprintf(since, sizeof since, ", since step %lld", (long long)run->bad_since);
    return fail(run, since, error);
}

gneiss_status gn_run_check_final_ledger(const gn_run *run, gneiss_error *error) {
    if (!run->finished || !beyond(run, run->world.ctx.scene.residual_limit)) return GNEISS_OK;
    return fail(run, " at the end", error);
}

/* The list has room for all warnings (tests/test_coupling.py counts them); else the last one is
 * overwritten. */
gn_warning *gn_warn(gn_warnings *list, const char *name, const char *format, ...) {
    va_list args;
    if (list->count == GN_WARNINGS_MAX) list->count--;
    gn_warning *to = &list->warning[list->count++];
    to->name = name;
    va_start(args, format);
    vsnprintf(to->text, sizeof to->text, format, args);
    va_end(args);
    return to;
}

static void warn_of_residual(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!beyond(run, w->ctx.scene.residual_warning)) return;
    gn_warn(list, "energy_residual",
            "%.3g of the energy throughput of %.4g J is unexplained (run.residual_warning: %g); a "
            "smaller time.safety shows whether the step is the cause",
            gn_energy_residual(&w->ledger.reading), gn_energy_scale(&w->ledger.reading),
            w->ctx.scene.residual_warning);
}

/* Warns of energy from a step that was lowered while the model vibrated near the limit. */
static void warn_of_change(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_energy *e = &w->ledger.reading;
    double limit = w->ctx.scene.residual_warning;
    if (!(w->ctx.effects & GN_FX_ENERGY && limit > 0.0)) return;
    if (!(fabs(e->step_change) > limit * gn_energy_scale(e))) return;
    gn_warn(list, "energy_step_change",
            "%.3g of the energy throughput of %.4g J came from lowering the step while the model "
            "vibrated, or from masses raised later on (run.residual_warning: %g); a smaller "
            "time.safety from the start on, or less added mass, avoids this",
            e->step_change / gn_energy_scale(e), gn_energy_scale(e), limit);
}

/* Warns of a negative loss, that is, a gain: if a vibration passes through a large part of its
 * motion in one step, a bond that breaks keeps the velocity of half a step before
 * (docs/physics.md). The ledger includes the gain and closes, at the end and in earlier rows, so
 * that no other warning shows it. */
static void warn_of_gain(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    double limit = w->ctx.scene.residual_warning, least = 0.0;
    const char *name = NULL;
    if (!(w->ctx.effects & GN_FX_ENERGY && limit > 0.0)) return;
#define X(term, text) {#term, "energy_" #term, w->ledger.reading.term},
    const struct {
        const char *name, *column;
        double now;
    } losses[] = {GN_CONTACT_LOSSES(X)};
#undef X
    for (size_t k = 0; k < sizeof losses / sizeof *losses; k++) {
        const double *rows = gn_history_column(&run->history, losses[k].column);
        double lowest = losses[k].now;
        for (size_t r = 0; rows && r < run->history.row_count; r++) lowest = fmin(lowest, rows[r]);
        if (!(lowest < least)) continue;
        least = lowest;
        name = losses[k].name;
    }
    if (!(-least > limit * gn_energy_scale(&w->ledger.reading))) return;
    gn_warn(list, "energy_gain",
            "the loss by %s was negative, %.3g of the energy throughput of %.4g J: the step is "
            "too long for the vibrations at that time, which generated energy "
            "(run.residual_warning: %g); a smaller time.safety, 0.5 or less, avoids this",
            name, least / gn_energy_scale(&w->ledger.reading), gn_energy_scale(&w->ledger.reading),
            limit);
}

static void warn_of_step(const gn_run *run, gn_warnings *list) {
    char text[GNEISS_MESSAGE_SIZE];
    if (!*gn_timestep_warning(&run->world.ctx, text, sizeof text)) return;
    gn_warn(list, "time_step", "%s", text);
}

static void warn_of_skin(const gn_run *run, gn_warnings *list) {
    double widened = run->world.dem.verlet.widened;
    if (!(widened > 0.0)) return;
    gn_warn(list, "neighbours_skin",
            "neighbours.skin of %g m is less than the distance by which a contact may open in one "
            "step: lists were made with up to %.3g m",
            run->world.ctx.scene.skin, widened);
}

/* Warns of bonds that would soften over a smaller stretch than that of their own spring
 * (snap-back). */
static void warn_of_softening(const gn_run *run, gn_warnings *list) {
    const gn_contacts *b = &run->world.dem.bonds.contacts;
    if (run->world.ctx.scene.softening == GN_SOFTENING_NONE) return;
    size_t count = gn_softening_too_long(b);
    if (!count) return;
    gn_warn(list, "bonds_too_long",
            "%zu of %lld bonds hold more elastic energy at their tensile strength than they may "
            "dissipate (snap-back), and break at once: smaller particles, more fracture energy or "
            "less strength would let them soften",
            count, (long long)run->world.dem.bonds_at_start);
}

/* Tells whether every material specifies that its bonds soften in shear. */
static bool softens_in_shear(const gn_scene *scene) {
    if (scene->softening == GN_SOFTENING_RATIO) return true;
    for (size_t k = 0; k < scene->material_count; k++) {
        const gn_material *m = &scene->materials[k];
        if (scene->softening == GN_SOFTENING_ENERGY ? m->shear_fracture_energy == 0.0
                                                    : m->shear_fracture_strain == 0.0)
            return false;
    }
    return true;
}

static void warn_of_shear(const gn_run *run, gn_warnings *list) {
    const gn_contacts *b = &run->world.dem.bonds.contacts;
    const gn_scene *s = &run->world.ctx.scene;
    if (s->softening == GN_SOFTENING_NONE || !softens_in_shear(s)) return;
    size_t count = gn_softening_brittle_in_shear(b);
    if (!count) return;
    const char *cure = s->softening == GN_SOFTENING_STRAIN
                           ? "a larger shear_fracture_strain lets them soften in shear; without "
                             "one they are brittle by choice"
                           : "with shear_fracture_energy: auto they soften in shear as in tension; "
                             "without one they are brittle by choice";
    gn_warn(list, "bonds_brittle_in_shear",
            "%zu of %lld bonds hold more elastic energy at their shear strength than they may "
            "dissipate in shear, and break at once there: %s",
            count, (long long)run->world.dem.bonds_at_start, cure);
}

static void warn_of_mass_scaling(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_mass_scaling *s = &w->ctx.choice.scaling;
    if (!(w->ctx.effects & GN_FX_MASS_SCALING && s->step > 0.0 &&
          s->reached < (1.0 - 1e-9) * s->step))
        return;
    gn_warn(list, "mass_scaling",
            "time.mass_scaling requests a step of %.6g s; the step at the start was %.6g s with "
            "added mass and %.6g s without: its limit does not grow with the masses",
            s->step, s->reached, s->unscaled);
}

/* Warns of keys without effect, as recorded by the reader of the scene. */
static void warn_of_idle_keys(const gn_run *run, gn_warnings *list) {
    const gn_scene_notes *notes = &run->world.ctx.given.notes;
    size_t used = 0;
    gn_warning *to = NULL;
    for (size_t k = 0; k < notes->count; k++) {
        if (!notes->idle[k]) continue;
        if (!to) to = gn_warn(list, "key_without_effect", "%s", "");
        int more = snprintf(to->text + used, sizeof to->text - used, "%s%s", used ? "; " : "",
                            notes->text[k] + notes->key_at[k]);
        used += (size_t)more;
        if (used >= sizeof to->text) return;
    }
}

/* Warns of a run without steps. An automatic step is known only once there is a specimen; a given
 * one must be below the end. */
static void warn_of_no_steps(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!run->finished || w->ctx.step > 0 || w->outcome.halt[0]) return;
    if (w->ctx.time < w->ctx.scene.end - 0.5 * w->ctx.dt) /* stages without steps */
        gn_warn(list, "no_steps",
                "every stage ended by steps or time of 0: no step was taken, and the results are "
                "those of the start");
    else
        gn_warn(list, "no_steps",
                "time.end (%g s) is less than half a step of %.4g s: no step was taken, and the "
                "results are those of the start",
                w->ctx.scene.end, w->ctx.dt);
}

/* Warns that the model ended the run itself (conversion/conversion.c). */
static void warn_of_halt(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!run->finished || !w->outcome.halt[0]) return;
    const bool box = gn_conversion_ended_at_box(&w->outcome);
    gn_warning *to =
        gn_warn(list, "conversion_halted",
                "the run ended at %.4g s of %.4g s, and the further behaviour is not known: %s; ",
                w->ctx.time, w->ctx.scene.end, w->outcome.halt);
    const int told = (int)strlen(to->text);
    if (box)
        snprintf(
            to->text + told, sizeof to->text - (size_t)told,
            "couple.convert.box and the packing in it must extend beyond the converted elements on "
            "that side by the width of the zone, %g m (couple.convert.width), or more",
            w->ctx.scene.couple.convert.width);
    else if (gn_conversion_lacked_mass(&w->outcome))
        snprintf(to->text + told, sizeof to->text - (size_t)told,
                 "the zone must be wider than %g m (couple.convert.width), three elements and six "
                 "particles, or the elements larger there",
                 w->ctx.scene.couple.convert.width);
    else if (gn_conversion_reached_watched(&w->outcome))
        snprintf(to->text + told, sizeof to->text - (size_t)told,
                 "sets of particles, which may be dormant, can record there instead (sets: select "
                 "without motion)%s",
                 gn_conversion_left_light_nodes(&w->outcome)
                     ? ", or elements must be no smaller than particles"
                     : "");
    else
        snprintf(to->text + told, sizeof to->text - (size_t)told,
                 "driven or loaded elements must be farther from the converted ones, or "
                 "couple.convert.stress or .mohr_coulomb higher there%s",
                 gn_conversion_left_light_nodes(&w->outcome)
                     ? ", or elements there must be no smaller than particles"
                     : "");
}

/* Warns of a condition that was not fulfilled in time. */
static void warn_of_stages(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    if (!run->finished || w->outcome.halt[0] || !gn_run_stages_left(run)) return;
    gn_warn(list, "stages_left",
            "time.end (%g s) was reached in stage '%s' (%zu of %zu), before its end condition: "
            "use a later time.end, or another condition under its end",
            w->ctx.scene.end, w->ctx.scene.stages[w->stages.now].name, w->stages.now + 1,
            w->ctx.scene.stage_count);
}

/* Warns of much added mass; the inertia of a little affects no reading. */
static void warn_of_added_mass(const gn_run *run, gn_warnings *list) {
    const gn_dem *d = &run->world.dem;
    if (!(run->world.ctx.effects & GN_FX_MASS_SCALING && d->raised.added > d->mass)) return;
    gn_warn(list, "added_mass",
            "time.mass_scaling added %.3g times the particles' own mass: its effect was not "
            "measured to that extent, and waves may dominate the readings",
            d->raised.added / d->mass);
}

/* Warns of sources that are behind their rate. A delay of a hundredth of the time, or of one
 * particle, does not count. */
static void warn_of_sources(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    for (size_t k = 0; k < w->ctx.scene.source_count; k++) {
        const gn_source_def *d = &w->ctx.scene.sources[k];
        const gn_source_state *s = &w->dem.flow.sources[k];
        double behind = gn_flow_behind(&w->ctx, &w->dem, k);
        if (!gn_flow_is_behind(&w->ctx, &w->dem, k)) continue;
        const char *wall = gn_flow_wall_before(&w->ctx, &w->dem, &w->boundary, k);
        if (s->full == 0.0) {
            gn_warn(list, "source_behind",
                    "source '%s' is %.4g s behind its rate at the end: %.0f particles, %.4g kg "
                    "were inserted; particles are inserted when lists are made, up to 50 steps "
                    "late, and those due since then were not: a longer run%s inserts them",
                    d->name, behind, s->number, s->mass,
                    d->end > 0.0 && d->end < w->ctx.scene.end
                        ? ""
                        : ", or an end of the source before that of the run,");
            return;
        }
        gn_warn(list, "source_behind",
                "source '%s' found no space %.0f times and is %.4g s behind its rate: %.0f "
                "particles, %.4g kg were inserted; %s%s%s",
                d->name, s->full, behind, s->number, s->mass, wall ? "wall '" : "",
                wall ? wall : "",
                wall            ? "' has the whole region of the source behind it"
                : s->number > 0 ? "a larger region or a faster velocity gives more space"
                                : "walls, bodies or particles fill its region");
        return;
    }
}

static void warn_of_passing(const gn_run *run, gn_warnings *list,
                            bool (*passes)(const gn_step_context *, const gn_boundary *, size_t),
                            const char *name, const char *why) {
    const gn_world *w = &run->world;
    size_t count = 0, first = 0;
    for (size_t k = w->ctx.scene.body_count; k-- > 0;)
        if (passes(&w->ctx, &w->boundary, k)) {
            count++;
            first = k;
        }
    if (!count) return;
    gn_warn(list, name, "%zu bod%s, as '%.60s', pass%s through %s", count, count == 1 ? "y" : "ies",
            w->ctx.scene.bodies[first].name, count == 1 ? "es" : "", why);
}

/* Warns of bodies near walls and other bodies with which they have no contact because of their
 * shape or stiffness. */
static void warn_of_bodies(const gn_run *run, gn_warnings *list) {
    warn_of_passing(run, list, gn_body_passes_bodies, "bodies_pass",
                    "other bodies: a surface that is not closed and convex has contact with "
                    "particles and walls only");
    warn_of_passing(run, list, gn_body_lacks_stiffness, "bodies_without_stiffness",
                    "walls or other bodies: by Hertz's law those are rigid, and a free body has "
                    "contact with them only by a stiffness, kratio and friction of its own");
}

/* Warns of contacts of bodies beyond the range of their springs. */
static void warn_of_depth(const gn_run *run, gn_warnings *list) {
    const gn_body_pairs *p = &run->world.boundary.pairs;
    const gn_body_def *body = run->world.ctx.scene.bodies;
    if (p->pushed.value > 0.0) {
        gn_warn(list, "bodies_pushed",
                "bodies '%.60s' and '%.60s' overlapped at the start and were pushed apart with "
                "%.3g N, more than twice their weight",
                body[(size_t)p->pushed.first].name, body[(size_t)p->pushed.second].name,
                p->pushed.value);
    }
    if (!(p->deepest.value > 0.5)) return;
    gn_warn(list, "bodies_too_deep",
            "bodies '%.60s' and '%.60s' overlapped by %.3g of the thickness of the thinner one: "
            "from half of it on they may emerge on the other side; more stiffness prevents this",
            body[(size_t)p->deepest.first].name, body[(size_t)p->deepest.second].name,
            p->deepest.value);
}

/* Warns of contacts of particles beyond the range of their springs. */
static void warn_of_overlap(const gn_run *run, gn_warnings *list) {
    const gn_depth *d = &run->world.dem.depth;
    char contact[160];
    if (!(d->excess > 1.0)) return;
    gn_warn(list, "contacts_too_deep",
            "%s overlapped by %.3g m, %.3g of the smaller radius, at t = %.4g s: beyond %g of it "
            "no contact law is valid, and a particle deeper than a radius emerges on the other "
            "side; more stiffness, or less load or speed, keeps overlaps small",
            gn_depth_text(&run->world.ctx, &run->world.dem, contact, sizeof contact), d->overlap,
            d->share, d->time, d->share / d->excess);
}

static void warn_of_sizes(const gn_run *run, gn_warnings *list) {
    char text[GNEISS_MESSAGE_SIZE];
    if (!gn_specimen_is_narrow(&run->world.ctx, &run->world.dem, text, sizeof text)) return;
    gn_warn(list, "packing_sizes", "%s", text);
}

static void warn_of_geometry(const gn_run *run, gn_warnings *list) {
    char text[GNEISS_MESSAGE_SIZE];
    if (!gn_geometry_doubts(&run->world.ctx, &run->world.dem, &run->world.boundary,
                            &run->world.solids, text, sizeof text))
        return;
    gn_warn(list, "test_geometry", "%s", text);
}

static void warn_of_ends(const gn_run *run, gn_warnings *list) {
    char text[GNEISS_MESSAGE_SIZE];
    if (!gn_ends_doubts(&run->world.ctx, &run->world.dem, &run->world.solids, text, sizeof text))
        return;
    gn_warn(list, "test_ends", "%s", text);
}

/* Warns of a shear test without normal stress. With stages, the last one is checked. */
static void warn_of_normal(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    char text[GNEISS_MESSAGE_SIZE];
    if (gn_run_staged(run) && w->stages.now + 1 < w->ctx.scene.stage_count) return;
    if (!gn_shear_is_unsupported(&w->ctx, &w->dem, text, sizeof text)) return;
    gn_warn(list, "no_normal_stress", "%s", text);
}

/* Number of reversals of the factor from which the control counts as failed. It has also failed if
 * it moves the ends beyond their initial positions, which unloads ends without a load. */
enum { SWINGS = 10 };

static void warn_of_control(const gn_run *run, gn_warnings *list) {
    const gn_control *c = &run->world.ctx.scene.test.control;
    const double *factor = gn_history_column(&run->history, "control"),
                 *way = gn_history_column(&run->history, "deflection");
    size_t swings = 0, beyond_start = 0;
    if (!run->world.ctx.scene.test.has_control || !factor || !way) return;
    for (size_t r = 1; r < run->history.row_count; r++) {
        bool back = factor[r] <= -0.5 * c->reverse && c->reverse > 0.0;
        swings += back && factor[r - 1] >= 0.5;
        beyond_start += back && way[r] < 0.0;
    }
    if (swings < SWINGS && !beyond_start) return;
    gn_warn(list, "control",
            "%s: test.control.response of %g s is too short for the specimen (it must be several "
            "times the time that a wave needs to cross the specimen, times the prescribed speed "
            "over the rate)",
            beyond_start ? "the ends moved back beyond their initial position"
                         : "the motion of the ends alternated between forwards and backwards",
            c->response);
}

static double first_row(const gn_run *run, const char *column) {
    const double *rows = gn_history_column(&run->history, column);
    return rows && run->history.row_count ? rows[0] : 0.0;
}

static double first_force(const gn_run *run, const char *kind, const char *name) {
    double force[3] = {0.0};
    for (int a = 0; a < 3; a++) {
        char column[GN_COLUMN_NAME_SIZE];
        snprintf(column, sizeof column, "%s_%s_force_%c", kind, name, "xyz"[a]);
        force[a] = first_row(run, column);
    }
    return sqrt(gn_dot3(force, force));
}

/* Returns the energy (J) in contacts of particles with walls, bodies and elements in the first row,
 * without the share of the ends of a test, which is estimated as their share of all forces. */
static double stored_outside(const gn_run *run) {
    const gn_scene *s = &run->world.ctx.scene;
    double ends = 0.0, others = 0.0;
    for (size_t k = 0; k < s->wall_count; k++)
        *(gn_scene_is_end(s, s->walls[k].name) ? &ends : &others) +=
            first_force(run, "wall", s->walls[k].name);
    for (size_t k = 0; k < s->body_count; k++)
        *(gn_scene_is_end(s, s->bodies[k].name) ? &ends : &others) +=
            first_force(run, "body", s->bodies[k].name);
    return first_row(run, "energy_elastic_wall") * (ends > 0.0 ? others / (ends + others) : 1.0);
}

/* Warns of particles at rest that overlap under stress and whose contacts are not in balance, so
 * that they spring apart in the first steps. A specimen that another run brought to rest under load
 * is in balance, and an energy of less than a thousandth of the later throughput is harmless. The
 * initial load of the ends has its own warning (initial_stress). If walls and bodies store more
 * than the specimen, contacts inside it do not balance them; they touch N^((d - 1)/d) of N
 * particles, and the ratio is a mean over these. */
static void warn_of_burst(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const double balanced = 0.1, share = 1e-3,
                 inside = first_row(run, "energy_elastic_normal") +
                          first_row(run, "energy_elastic_shear") +
                          first_row(run, "energy_elastic_bending"),
                 outside = stored_outside(run), stored = inside + outside,
                 moving = first_row(run, "energy_kinetic"), ratio = first_row(run, "unbalanced");
    const bool pressed = outside > inside;
    const double particles = fmax(1.0, (double)w->dem.particles.soa.count),
                 most = pressed ? balanced * pow(particles, -1.0 / (double)w->ctx.scene.dimension)
                                : balanced;
    if (!w->ctx.scene.has_specimen || !(ratio > most)) return;
    if (!(stored > moving) || !gn_stored_matters(&w->ctx, &w->dem, stored)) return;
    if (!(stored > share * gn_energy_scale(&w->ledger.reading))) return;
    if (pressed)
        gn_warn(list, "stressed_at_start",
                "particles at rest stored %.3g J at the start, %.3g J of it in contacts with "
                "walls, bodies or elements that start inside particles and are not in balance "
                "(unbalanced force ratio %.3g): they push particles away, and may break bonds. A "
                "position farther out, or passive: true of walls, avoids this",
                stored, outside, ratio);
    else
        gn_warn(list, "stressed_at_start",
                "particles at rest stored %.3g J at the start in contacts that are not in balance "
                "(unbalanced force ratio %.3g): overlaps there push particles apart, and may "
                "break bonds. bonds.passive_gaps (the default of bonds) takes overlaps of a "
                "packing as free of stress; otherwise use a packing without overlaps, or the end "
                "of a run that came to rest (specimen.from)",
                stored, ratio);
}

static void warn_of_sinks(const gn_run *run, gn_warnings *list) {
    char text[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < run->world.ctx.scene.sink_count; k++) {
        if (!gn_sink_is_too_thin(&run->world.ctx, &run->world.dem, k, text, sizeof text)) continue;
        gn_warn(list, "sink_too_thin", "%s", text);
        return;
    }
}

static void warn_of_joints(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    char text[GNEISS_MESSAGE_SIZE];
    if (gn_joints_are_close(&w->ctx, &w->dem, text, sizeof text))
        gn_warn(list, "joints_close", "%s", text);
    if (gn_joints_lack_area(&w->ctx, &w->dem, text, sizeof text))
        gn_warn(list, "joints_area", "%s", text);
}

gneiss_status gn_run_warnings(const gn_run *run, gn_warnings *list, gneiss_error *error) {
    *list = (gn_warnings){0};
    warn_of_step(run, list);
    warn_of_residual(run, list);
    warn_of_change(run, list);
    warn_of_gain(run, list);
    GN_TRY(gn_warn_of_readings(run, list, error));
    warn_of_skin(run, list);
    warn_of_softening(run, list);
    warn_of_shear(run, list);
    warn_of_mass_scaling(run, list);
    warn_of_added_mass(run, list);
    warn_of_no_steps(run, list);
    warn_of_halt(run, list);
    warn_of_stages(run, list);
    gn_warn_of_servos(run, list);
    gn_warn_of_structure(run, list);
    gn_warn_of_membrane(run, list);
    warn_of_control(run, list);
    warn_of_bodies(run, list);
    warn_of_depth(run, list);
    warn_of_overlap(run, list);
    warn_of_burst(run, list);
    warn_of_sizes(run, list);
    warn_of_geometry(run, list);
    gn_warn_of_cut(run, list);
    warn_of_ends(run, list);
    warn_of_normal(run, list);
    warn_of_sources(run, list);
    warn_of_sinks(run, list);
    warn_of_joints(run, list);
    warn_of_idle_keys(run, list);
    return gn_warn_of_coupling(run, list, error);
}
