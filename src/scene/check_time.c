/* Checks of steps, of mass scaling, and of the start of steps. */
#include "scene/check.h"

static gneiss_status check_step(const check *section, const gn_scene *scene) {
    if (scene->step <= scene->end) return GNEISS_OK;
    return gn_check_fail(section, "time.step", "expected a step below the end, found %g s and %g s",
                         scene->step, scene->end);
}

static gneiss_status check_mass_scaling(const check *section, const gn_scene *scene) {
    bool falls = scene->gravity[0] != 0.0 || scene->gravity[1] != 0.0 || scene->gravity[2] != 0.0;
    if (!scene->has_mass_scaling || !gn_check_is_valid(section, "gravity")) return GNEISS_OK;
    if ((scene->scaled_step > 0.0) == (scene->scaled_factor > 0.0))
        return gn_check_fail(section, "time.mass_scaling",
                             "expected either step or factor, found %s",
                             scene->scaled_step > 0.0 ? "both" : "neither");
    if (scene->step > 0.0)
        return gn_check_fail(section, "time.mass_scaling",
                             "expected time.step: auto, which takes the target step of mass "
                             "scaling, found a step of %g s",
                             scene->step);
    if (!scene->has_specimen)
        return gn_check_fail(section, "time.mass_scaling",
                             "expected a specimen: the masses of finite elements are not raised, "
                             "found elements only");
    if (scene->scaled_step >= scene->end)
        return gn_check_fail(section, "time.mass_scaling.step",
                             "expected a step below the end, found %g s and %g s",
                             scene->scaled_step, scene->end);
    if (falls && scene->scaled_gravity == GN_GRAVITY_REFUSED)
        return gn_check_fail(
            section, "time.mass_scaling",
            "expected no gravity, as scaled masses would change weights, or gravity: own_mass, "
            "which keeps each weight and lets particles fall more slowly, found gravity and %s",
            gn_check_given(section, "time.mass_scaling.gravity") ? "gravity: refuse"
                                                                 : "no such key");
    return GNEISS_OK;
}

/* Statics assume that loads are linear in time: a load that reverses between two states would be
 * missed. */
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

const char *gn_scene_statics_refusal(const gn_scene *scene) {
    if (!scene->has_specimen || scene->bonds != GN_SWITCH_ON) return "bonded particles, found none";
    if (scene->bond_radius_multiplier > 0)
        return "bonds without moments, found bonds.radius_multiplier";
    if (scene->softening != GN_SOFTENING_NONE)
        return "bonds that break at once, found law.softening";
    for (size_t k = 0; k < scene->material_count; k++)
        if (scene->materials[k].yield_stress[0] > 0)
            return "bonds that break at once, found a material with yield_stress_1";
    if (scene->has_elements) return "particles alone, found elements";
    if (scene->body_count) return "walls and sets, found bodies";
    if (scene->has_membrane) return "walls and sets, found a membrane";
    if (gn_scene_box_moves(scene)) return "a fixed periodic box, found sides that move";
    if (scene->background == GN_BACKGROUND_VISCOUS &&
        gn_scene_spin_damping(scene) != scene->background_coefficient &&
        scene->rotation != GN_SWITCH_OFF)
        return "equal damping of spins and velocities, found damping.background.rotation";
    if (scene->random_velocity > 0) return "a specimen at rest, found initial.random_velocity";
    if (scene->has_pulse) return "a specimen at rest, found initial.pulse";
    for (size_t k = 0; k < scene->wall_count; k++) {
        if (scene->walls[k].servo.active) return "walls with prescribed motion, found a servo";
        if (motion_changes(&scene->walls[k].motion))
            return "motions at constant velocity, found a wall whose velocity changes";
    }
    for (size_t k = 0; k < scene->set_count; k++)
        if (motion_changes(&scene->sets[k].motion))
            return "motions at constant velocity, found a set whose velocity changes";
    if (scene->stop_unbalanced > 0)
        return "conditions that count from the start of steps, found time.stop.unbalanced";
    for (size_t k = 0; k < scene->set_count; k++)
        for (int a = 0; a < 3; a++) {
            const gn_set_def *set = &scene->sets[k];
            bool moves = set->initial_velocity[a] != 0 && !set->motion.velocity[a].count;
            bool spins = set->initial_spin[a] != 0 && !set->motion.spin[a].count;
            if (moves || spins) return "a specimen at rest, found a set with an initial velocity";
        }
    return NULL;
}

static gneiss_status check_start_of_steps(const check *section, const gn_scene *scene) {
    const char *reason =
        scene->start == GN_START_FIRST_BREAK ? gn_scene_statics_refusal(scene) : NULL;
    if (reason) return gn_check_fail(section, "time.start", "first_break: expected %s", reason);
    /* A written scene contains the default of every key. */
    if (scene->start == GN_START_REST && scene->start_fraction != 0.9)
        return gn_check_fail(section, "time.start_fraction",
                             "expected time.start: first_break beside it, found rest");
    return GNEISS_OK;
}

const char *gn_check_stop(const gn_scene *scene) {
    return scene->stop_peak_drop > 0    ? "time.stop.peak_drop"
           : scene->stop_strain > 0     ? "time.stop.strain"
           : scene->stop_unbalanced > 0 ? "time.stop.unbalanced"
                                        : NULL;
}

/* Stop conditions are evaluated in rows of the history. */
static gneiss_status check_stops(const check *section, const gn_scene *scene) {
    const char *stop = gn_check_stop(scene);
    if (!stop || scene->history_rows > 0) return GNEISS_OK;
    return gn_check_fail(section, stop,
                         "expected output.history_rows above 0, as it is evaluated in rows of the "
                         "history, found 0: it would never stop the run");
}

gneiss_status gn_check_time(const check *section, const gn_scene *scene) {
    GN_TRY(gn_check_keep_problem(section, check_stops(section, scene)));
    GN_TRY(gn_check_keep_problem(section, check_start_of_steps(section, scene)));
    GN_TRY(gn_check_keep_problem(section, check_step(section, scene)));
    return gn_check_keep_problem(section, check_mass_scaling(section, scene));
}
