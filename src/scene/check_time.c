/* Steps, what masses are raised for, and where steps begin. */
#include "scene/check.h"

static gneiss_status check_step(const check *c, const gn_scene *s) {
    if (s->step <= s->end) return GNEISS_OK;
    return gn_check_fail(c, "time.step", "expected a step below the end, found %g s and %g s",
                         s->step, s->end);
}

static gneiss_status check_mass_scaling(const check *c, const gn_scene *s) {
    bool falls = s->gravity[0] != 0.0 || s->gravity[1] != 0.0 || s->gravity[2] != 0.0;
    if (!s->has_mass_scaling || !gn_check_sound(c, "gravity")) return GNEISS_OK;
    if ((s->scaled_step > 0.0) == (s->scaled_factor > 0.0))
        return gn_check_fail(c, "time.mass_scaling", "expected either step or factor, found %s",
                             s->scaled_step > 0.0 ? "both" : "neither");
    if (s->step > 0.0)
        return gn_check_fail(c, "time.mass_scaling",
                             "expected time.step: auto, which takes the step that masses are "
                             "raised for, found a step of %g s",
                             s->step);
    if (!s->has_specimen)
        return gn_check_fail(c, "time.mass_scaling",
                             "expected a specimen: the masses of finite elements are not raised, "
                             "found elements only");
    if (s->scaled_step >= s->end)
        return gn_check_fail(c, "time.mass_scaling.step",
                             "expected a step below the end, found %g s and %g s", s->scaled_step,
                             s->end);
    if (falls && s->scaled_gravity == GN_GRAVITY_REFUSED)
        return gn_check_fail(c, "time.mass_scaling",
                             "expected no gravity, in which heavier particles fall more slowly, or "
                             "gravity: own_mass, which leaves each its weight, found gravity and "
                             "%s",
                             gn_check_given(c, "time.mass_scaling.gravity") ? "gravity: refuse"
                                                                            : "no such key");
    return GNEISS_OK;
}

/* Forces are followed in straight lines in time: a path that turns back between two states would be
 * passed over. */
static bool changes(const gn_table *table) {
    for (size_t k = 1; k < table->count; k++)
        if (table->value[k] != table->value[0]) return true;
    return false;
}

static bool motion_changes(const gn_motion *motion) {
    bool found = false;
    for (int a = 0; a < 3; a++)
        found = found || changes(&motion->velocity[a]) || changes(&motion->spin[a]);
    return found;
}

const char *gn_scene_no_statics(const gn_scene *s) {
    if (!s->has_specimen || s->bonds != GN_SWITCH_ON) return "bonded particles, found none";
    if (s->bond_radius_multiplier > 0)
        return "bonds without moments, found bonds.radius_multiplier";
    if (s->softening != GN_SOFTENING_NONE) return "bonds that break at once, found law.softening";
    for (size_t k = 0; k < s->material_count; k++)
        if (s->materials[k].yield_stress[0] > 0)
            return "bonds that break at once, found a material with yield_stress_1";
    if (s->has_elements) return "particles alone, found elements";
    if (s->body_count) return "walls and sets, found bodies";
    if (s->has_membrane) return "walls and sets, found a membrane";
    if (gn_scene_box_moves(s)) return "a periodic box that stands, found sides that move";
    if (s->background == GN_BACKGROUND_VISCOUS &&
        gn_scene_spin_damping(s) != s->background_coefficient && s->rotation != GN_SWITCH_OFF)
        return "spins that are damped as velocities are, found damping.background.rotation";
    if (s->random_velocity > 0) return "a specimen at rest, found initial.random_velocity";
    if (s->has_pulse) return "a specimen at rest, found initial.pulse";
    for (size_t k = 0; k < s->wall_count; k++) {
        if (s->walls[k].servo.active) return "walls that move as given, found a servo";
        if (motion_changes(&s->walls[k].motion))
            return "motions at constant velocity, found a wall whose velocity changes";
    }
    for (size_t k = 0; k < s->set_count; k++)
        if (motion_changes(&s->sets[k].motion))
            return "motions at constant velocity, found a set whose velocity changes";
    if (s->stop_unbalanced > 0)
        return "conditions that count from the start of steps, found time.stop.unbalanced";
    for (size_t k = 0; k < s->set_count; k++)
        for (int a = 0; a < 3; a++) {
            const gn_set_def *set = &s->sets[k];
            bool moves = set->initial_velocity[a] != 0 && !set->motion.velocity[a].count;
            bool spins = set->initial_spin[a] != 0 && !set->motion.spin[a].count;
            if (moves || spins) return "a specimen at rest, found a set with an initial velocity";
        }
    return NULL;
}

static gneiss_status check_start_of_steps(const check *c, const gn_scene *s) {
    const char *reason = s->start == GN_START_FIRST_BREAK ? gn_scene_no_statics(s) : NULL;
    if (reason) return gn_check_fail(c, "time.start", "first_break: expected %s", reason);
    /* A scene that was written out has the default of every key. */
    if (s->start == GN_START_REST && s->start_fraction != 0.9)
        return gn_check_fail(c, "time.start_fraction",
                             "expected time.start: first_break beside it, found rest");
    return GNEISS_OK;
}

const char *gn_check_stop(const gn_scene *s) {
    return s->stop_peak_drop > 0    ? "time.stop.peak_drop"
           : s->stop_strain > 0     ? "time.stop.strain"
           : s->stop_unbalanced > 0 ? "time.stop.unbalanced"
                                    : NULL;
}

/* Stops are looked at in rows of the history. */
static gneiss_status check_stops(const check *c, const gn_scene *s) {
    const char *stop = gn_check_stop(s);
    if (!stop || s->history_rows > 0) return GNEISS_OK;
    return gn_check_fail(c, stop,
                         "expected output.history_rows above 0, as it is looked at in rows of the "
                         "history, found 0: it would never stop the run");
}

gneiss_status gn_check_time(const check *c, const gn_scene *s) {
    GN_TRY(gn_check_keep(c, check_stops(c, s)));
    GN_TRY(gn_check_keep(c, check_start_of_steps(c, s)));
    GN_TRY(gn_check_keep(c, check_step(c, s)));
    return gn_check_keep(c, check_mass_scaling(c, s));
}
