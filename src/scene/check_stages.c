/* Checks that stages can begin and end. */
#include "base/vec3.h"
#include "scene/acts.h"
#include "scene/check.h"
#include "scene/stages.h"
#include "scene/stages_check.h"

#include <math.h>
#include <string.h>

static bool by_time_alone(const gn_stage *stage) {
    gn_stage other = *stage;
    other.time = -1;
    return stage->time >= 0 && !gn_stage_has_end(&other);
}

static gneiss_status check_name(const check *section, const gn_scene *scene, size_t stage) {
    for (size_t k = 0; k < stage; k++)
        GN_TRY(gn_check_name(section, strcmp(scene->stages[k].name, scene->stages[stage].name) == 0,
                             scene->stages[stage].name));
    return GNEISS_OK;
}

/* Returns the earliest start of a stage, s: the sum of the stages before it that end by time alone.
 */
static double least_start(const gn_scene *scene, size_t stage) {
    double sum = 0.0;
    for (size_t k = 0; k < stage; k++)
        if (by_time_alone(&scene->stages[k])) sum += scene->stages[k].time;
    return sum;
}

static gneiss_status check_end(const check *section, const gn_scene *scene, size_t stage) {
    const gn_stage *e = &scene->stages[stage];
    bool last = stage + 1 == scene->stage_count;
    if (!gn_stage_has_end(e) && !last)
        return gn_check_fail(section, gn_check_given(section, "end") ? "end" : "name",
                             "expected a condition under end (time, steps, strain, stress, "
                             "peak_drop, unbalanced, held), found none: the stage would never end");
    const bool tested = gn_scene_tested(scene);
    const char *reads = e->strain > 0      ? "end.strain"
                        : e->stress > 0    ? "end.stress"
                        : e->peak_drop > 0 ? "end.peak_drop"
                                           : NULL;
    if (reads && !tested)
        return gn_check_fail(section, reads,
                             "expected a test section that reads it, found none: the "
                             "stage would never end");
    double least = least_start(scene, stage) + fmax(e->time, 0.0);
    if (by_time_alone(e) && least > scene->end * (1.0 + 1e-9))
        return gn_check_fail(section, "end.time",
                             "expected an end before time.end, %g s, which ends the run, found at "
                             "least %g s: the stage would never end",
                             scene->end, least);
    return GNEISS_OK;
}

static gneiss_status check_base(const check *section, const gn_scene *scene) {
    if (scene->start == GN_START_FIRST_BREAK)
        return gn_check_fail(section, "time.start",
                             "expected rest beside stages, found first_break: statics follow the "
                             "loads of one stage");
    const char *stop = gn_check_stop(scene);
    if (!stop) return GNEISS_OK;
    return gn_check_fail(section, stop, "expected under end of a stage, found beside stages");
}

static gneiss_status check_given(const check *section, const gn_scene *scene, size_t index) {
    GN_TRY(gn_check_keep_problem(section, check_name(section, scene, index)));
    return check_end(section, scene, index);
}

gneiss_status gn_check_stages(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    check c = {.reader = reader, .map = root};
    GN_TRY(gn_check_keep_problem(&c, check_base(&c, scene)));
    return gn_check_list(&c, "stages", scene->stage_count, check_given);
}

/* ---- a stage as a whole ---- */

static bool given(const gn_table table[3]) {
    return table[0].count || table[1].count || table[2].count;
}

static bool prescribed(const gn_motion *motion) {
    return given(motion->velocity) || given(motion->spin);
}

/* True if contacts may have a force at the start: bonds that are free of stress at another
 * distance, or loaded bonds of another run. */
static bool prestressed(const gn_scene *scene) {
    return scene->specimen.from_bonds || (scene->bonds == GN_SWITCH_ON && !scene->passive_gaps);
}

/* True if anything other than a load could change a specimen at rest. */
static bool anything_else_acts(const gn_scene *scene) {
    bool acts = prestressed(scene) || scene->source_count || scene->has_pulse ||
                scene->random_velocity != 0;
    acts = acts || gn_scene_has_gravity(scene);
    for (size_t k = 0; k < scene->set_count; k++)
        acts = acts || scene->sets[k].has_initial_velocity || scene->sets[k].has_initial_spin;
    return acts;
}

static bool anything_acts(const gn_scene *scene) {
    return gn_scene_has_load(scene) || anything_else_acts(scene);
}

/* True if particles listed in the scene overlap each other, or overlap a wall for which the overlap
 * is not free of stress. */
static bool rows_overlap(const gn_scene *scene) {
    const gn_specimen *specimen = &scene->specimen;
    for (size_t i = 0; i < specimen->particle_count; i++) {
        const double *x = specimen->particles + 4 * i;
        for (size_t j = 0; j < i; j++) {
            const double *y = specimen->particles + 4 * j, sum = x[3] + y[3],
                         d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
            if (gn_dot3(d, d) < sum * sum * (1.0 - 1e-9)) return true;
        }
        for (size_t k = 0; k < scene->wall_count; k++) {
            const gn_wall_def *wall = &scene->walls[k];
            const double d[3] = {x[0] - wall->point[0], x[1] - wall->point[1],
                                 x[2] - wall->point[2]};
            if (!wall->passive && gn_dot3(d, wall->normal) < x[3] * (1.0 - 1e-9)) return true;
        }
    }
    return false;
}

/* True if a stage that begins at rest may find loaded contacts. Particles that are not listed in
 * the scene are checked once they exist (gn_stages_check_first). */
static bool may_overlap(const gn_scene *scene) {
    return !scene->specimen.particle_count || scene->body_count || scene->has_elements ||
           rows_overlap(scene);
}

/* True if the stage gives any motion. After an earlier stage the specimen may still move, so that a
 * prescribed velocity of zero has an effect as well. */
static bool anything_given(const gn_scene *scene) {
    bool any = anything_acts(scene);
    for (size_t k = 0; k < scene->wall_count; k++) any = any || prescribed(&scene->walls[k].motion);
    for (size_t k = 0; k < scene->set_count; k++) any = any || prescribed(&scene->sets[k].motion);
    for (size_t k = 0; k < scene->body_count; k++)
        any = any || prescribed(&scene->bodies[k].motion);
    for (size_t k = 0; k < scene->elements.motion_count; k++)
        any = any || prescribed(&scene->elements.motions[k].motion);
    return any;
}

/* ---- ends that only separate ---- */

/* Returns the largest value of `sign` times the table from a time on; 0 for an empty table. */
static double most(const gn_table *table, double sign, double from) {
    double found = table->count ? sign * table->value[table->count - 1] : 0.0;
    for (size_t k = 0; k + 1 < table->count; k++)
        if (table->time[k + 1] > from) found = fmax(found, sign * table->value[k]);
    return found;
}

/* Returns the velocity of a part of an end along the axis; NULL: the part follows forces. */
static const gn_table *velocity_of(const gn_scene *scene, const char *name) {
    const int axis = (int)scene->test.axis, wall = gn_scene_find_wall(scene, name),
              body = gn_scene_find_body(scene, name), set = gn_scene_find_set(scene, name),
              motion = gn_scene_find_element_motion(scene, name);
    const gn_motion *m = wall >= 0     ? &scene->walls[wall].motion
                         : body >= 0   ? &scene->bodies[body].motion
                         : set >= 0    ? &scene->sets[set].motion
                         : motion >= 0 ? &scene->elements.motions[motion].motion
                                       : NULL;
    const bool stands =
        wall >= 0 ? !scene->walls[wall].servo.active : body >= 0 && !scene->bodies[body].free;
    return m && (stands || m->velocity[axis].count) ? &m->velocity[axis] : NULL;
}

/* Returns the largest velocity of an end in the sense of `sign` along the axis in a stage or later;
 * infinity if a part of it follows forces. */
static double fastest(const gn_scene *scene, size_t stage, const gn_test_end *end, double sign) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const gn_table *velocity = velocity_of(scene, end->name[k]);
        if (!velocity) return INFINITY;
        const double given = velocity->stage ? least_start(scene, velocity->stage - 1) : 0.0;
        sum += most(velocity, sign, least_start(scene, stage) - given);
    }
    return sum / (double)end->count;
}

/* True if the strain of a test with prescribed motions of the ends can never grow. */
static bool never_strains(const gn_scene *scene, size_t stage) {
    const gn_test *test = &scene->test;
    if (!gn_scene_test(scene)->ends || test->has_control) return false;
    const double sign = gn_scene_test(scene)->sign;
    return fastest(scene, stage, &test->upper, sign) + fastest(scene, stage, &test->lower, -sign) <=
           0.0;
}

static const char *strains_by(const gn_scene *scene) {
    const gn_test_descriptor *d = gn_scene_test(scene);
    return d->sheared ? "shear the specimen" : d->sign < 0 ? "close" : "come apart";
}

/* True if the motion of each part of an end is prescribed and none of them ever moves in the sense
 * of `sign`; *against counts the parts that move in the opposite sense. */
static bool only_against(const gn_scene *scene, const gn_test_end *end, double sign, int *against) {
    for (size_t k = 0; k < end->count; k++) {
        const gn_table *velocity = velocity_of(scene, end->name[k]);
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        if (!velocity || most(velocity, sign, -INFINITY) > 0.0) return false;
        for (int a = 0; a < 3; a++)
            if (gn_table_is_nonzero(&motion->spin[a])) return false;
        *against += gn_table_is_nonzero(velocity);
    }
    return true;
}

gneiss_status gn_check_separating_ends(const check *section, const gn_scene *scene) {
    const gn_test *test = &scene->test;
    const gn_test_descriptor *d = gn_scene_test(scene);
    const double sign = d->sign;
    int against = 0;
    if (d->beam || d->sheared || d->confined) return GNEISS_OK;
    if (scene->has_elements || test->has_control || *scene->specimen.from ||
        gn_scene_has_other_load(scene, false) || anything_else_acts(scene) || rows_overlap(scene))
        return GNEISS_OK;
    if (!only_against(scene, &test->upper, sign, &against) ||
        !only_against(scene, &test->lower, -sign, &against))
        return GNEISS_OK;
    if (!against) return GNEISS_OK; /* fixed ends may be there to observe only */
    return gn_check_fail(
        section, "test.upper",
        "expected ends that %s, found ends that only %s: the test would measure nothing",
        strains_by(scene), sign < 0.0 ? "come apart" : "close");
}

static double largest_pressure(const gn_scene *scene) {
    return scene ? fmax(0.0, most(&scene->membrane.pressure, 1.0, -INFINITY)) : 0.0;
}

/* Tells whether a stress cannot be reached by a membrane alone: the mean stress of the specimen is
 * then its pressure, and at most twice the pressure if that is applied at once. */
static bool never_so_pressed(const gn_scene *before, const gn_scene *scene, double stress) {
    if (!gn_scene_test(scene)->isotropic || gn_scene_has_other_load(scene, true) ||
        anything_else_acts(scene))
        return false;
    return stress > 2.0 * fmax(largest_pressure(before), largest_pressure(scene));
}

static bool servo(const gn_scene *scene) {
    for (size_t k = 0; k < scene->wall_count; k++)
        if (scene->walls[k].servo.active) return true;
    for (int a = 0; a < 3; a++)
        if (scene->has_periodic && scene->box[a].stress.count) return true;
    return false;
}

/* Returns the first condition that is evaluated in rows of the history only. */
static const char *end_by_rows(const gn_stage *stage) {
    return stage->strain > 0       ? "end.strain"
           : stage->stress > 0     ? "end.stress"
           : stage->peak_drop > 0  ? "end.peak_drop"
           : stage->unbalanced > 0 ? "end.unbalanced"
           : stage->held > 0       ? "end.held"
                                   : NULL;
}

static const char nothing[] =
    "expected a motion or load in this stage, found none: it would never end";

static const char parting[] = "expected ends that %s in this stage, found none: it would never end";

/* Checks a given step, which later stages cannot change. */
static gneiss_status check_steps(const check *section, const gn_scene *scene,
                                 const gn_stage *stage) {
    gn_stage other = *stage;
    other.steps = -1;
    if (stage->steps < 0 || gn_stage_has_end(&other) || !(scene->step > 0)) return GNEISS_OK;
    const double duration = (double)stage->steps * scene->step;
    if (duration <= scene->end * (1.0 + 1e-9)) return GNEISS_OK;
    return gn_check_fail(section, "end.steps",
                         "expected an end before time.end, %g s, which ends the run, found %.10g s "
                         "(steps of time.step, %g s): the stage would never end",
                         scene->end, duration, scene->step);
}

/* Refuses a stage that only strain or stress can end if neither can develop. */
static gneiss_status check_growth(const check *section, const gn_scene *before,
                                  const gn_scene *scene, size_t stage, bool first) {
    const gn_stage *e = &scene->stages[stage];
    const bool parts = never_strains(scene, stage), idle = !gn_scene_has_other_load(scene, false) &&
                                                           !anything_else_acts(scene) &&
                                                           !may_overlap(scene);
    const char *key = end_by_rows(e);
    const bool waits = e->strain > 0 && !(e->stress > 0) && !(e->peak_drop > 0);
    if (parts && waits && first && !anything_acts(scene))
        return gn_check_fail(section, key, nothing);
    if (parts && (waits || (first && idle)))
        return gn_check_fail(section, key, parting, strains_by(scene));
    if (e->stress > 0 && !(e->strain > 0) && !(e->peak_drop > 0) &&
        never_so_pressed(before, scene, e->stress))
        return gn_check_fail(section, "end.stress",
                             "expected at most twice the pressure of the membrane, %g Pa, the only "
                             "load, found %g Pa: the stage would never end",
                             largest_pressure(scene), e->stress);
    return GNEISS_OK;
}

static gneiss_status check_can_end(const check *section, const gn_scene *before,
                                   const gn_scene *scene, size_t stage, bool first) {
    const gn_stage *e = &scene->stages[stage];
    if (scene->history_rows < 2 && end_by_rows(e))
        return gn_check_fail(section, end_by_rows(e),
                             "expected output.history_rows above 1, as it is evaluated in rows of "
                             "the history, found %lld: the stage would never end by it",
                             (long long)scene->history_rows);
    gn_stage others = *e;
    others.held = 0.0;
    /* A stage may give a pressure of 0 as part of a series of pressures; otherwise the membrane may
     * begin later. */
    const bool pressed = scene->has_membrane && (scene->membrane_stage > 0 ||
                                                 gn_table_is_nonzero(&scene->membrane.pressure));
    if (e->held > 0 && !servo(scene) && !pressed && !gn_stage_has_end(&others))
        return gn_check_fail(
            section, "end.held",
            "expected a wall or a periodic box with a servo, or a membrane with a pressure, in "
            "this stage, found none: the stage would never end");
    GN_TRY(check_steps(section, scene, e));
    if (!gn_stage_has_end(e) || e->time >= 0 || e->steps >= 0 || e->held > 0) return GNEISS_OK;
    const bool acts = first ? anything_acts(scene) || may_overlap(scene)
                            : anything_given(scene) || e->unbalanced > 0;
    if (!acts) return gn_check_fail(section, end_by_rows(e), nothing);
    return e->unbalanced > 0 ? GNEISS_OK : check_growth(section, before, scene, stage, first);
}

const char *gn_stage_never_ends(const gn_scene *scene, size_t stage, char *why, size_t size) {
    const gn_stage *e = &scene->stages[stage];
    const bool by_rows = gn_stage_has_end(e) && e->time < 0 && e->steps < 0 && !(e->held > 0);
    if (!by_rows || stage != 0 || *scene->specimen.from) return NULL;
    if (!anything_acts(scene)) {
        snprintf(why, size, "%s", nothing);
        return end_by_rows(e);
    }
    if (e->unbalanced > 0 || !never_strains(scene, stage) ||
        gn_scene_has_other_load(scene, false) || anything_else_acts(scene))
        return NULL;
    snprintf(why, size, parting, strains_by(scene));
    return end_by_rows(e);
}

static unsigned channels(const gn_motion *motion) {
    unsigned mask = 0;
    for (int a = 0; a < 3; a++) {
        mask |= motion->velocity[a].count ? 1u << a : 0;
        mask |= motion->spin[a].count ? 8u << a : 0;
    }
    return mask;
}

static const char fewer[] = "expected the same prescribed components as before this stage, %s "
                            "'%s': they are fixed for the whole run (a velocity may be 0)";

/* True if two materials are equal except for friction. */
static bool same_bonds(const gn_material *first, const gn_material *second) {
    gn_material now = *second;
    now.friction = first->friction;
    now.where = first->where;
    /* Both were zeroed before they were read. */
    return memcmp(first, &now, sizeof now) == 0; // NOLINT(bugprone-suspicious-memory-comparison)
}

static gneiss_status check_damage(const check *section, const gn_scene *before,
                                  const gn_scene *now) {
    for (size_t k = 0; k < now->material_count; k++) {
        if (now->materials[k].kratio == 0.0 && before->materials[k].kratio > 0.0)
            return gn_check_fail(section, "materials",
                                 "expected a tangential spring of '%s' in this stage too, for the "
                                 "forces of its contacts, found kratio 0",
                                 now->materials[k].name);
        const gn_material *is = &now->materials[k], *was = &before->materials[k];
        if (now->cohesion != GN_COHESION_NONE && now->wall_count &&
            (is->young != was->young || is->poisson != was->poisson))
            return gn_check_fail(section, "materials",
                                 "expected unchanged young and poisson of '%s' beside law.cohesion "
                                 "and walls, found others",
                                 is->name);
        bool damaged = now->softening != GN_SOFTENING_NONE || now->materials[k].yield_stress[0] > 0;
        if (damaged && !same_bonds(&before->materials[k], &now->materials[k]))
            return gn_check_fail(section, "materials",
                                 "expected unchanged stiffness and strength of '%s', whose bonds "
                                 "soften or yield: their damage is relative to these",
                                 now->materials[k].name);
    }
    return GNEISS_OK;
}

/* Refuses changes of the skin, which is determined once at the beginning of the run. */
static gneiss_status check_skin(const check *section, const gn_scene *before, const gn_scene *now) {
    const gn_membrane_def *was = &before->membrane, *is = &now->membrane;
    const char *other = was->faces != is->faces       ? "membrane.faces"
                        : was->axis != is->axis       ? "membrane.axis"
                        : was->follow != is->follow   ? "membrane.follow"
                        : was->surface != is->surface ? "membrane.surface"
                                                      : NULL;
    if (!other) return GNEISS_OK;
    return gn_check_fail(
        section, other,
        "expected the value before this stage: only pressure and ramp of a membrane may change");
}

/* Refuses changes of values that parts of a world read only when they are created. */
static gneiss_status check_kept(const check *section, const gn_scene *before, const gn_scene *now) {
    GN_TRY(check_skin(section, before, now));
    for (size_t k = 0; k < now->body_count; k++) {
        const gn_body_def *body = &now->bodies[k];
        if (body->free && channels(&body->motion) != channels(&before->bodies[k].motion))
            return gn_check_fail(section, "bodies", fewer, "free body", body->name);
    }
    for (size_t k = 0; k < now->elements.motion_count; k++) {
        const gn_element_motion *motion = &now->elements.motions[k];
        if (channels(&motion->motion) != channels(&before->elements.motions[k].motion))
            return gn_check_fail(section, "elements", fewer, "motion of elements", motion->name);
    }
    return GNEISS_OK;
}

/* Dormant particles have no contacts; their bonds are stored separately. */
gneiss_status gn_check_stage_dormant(const gn_reader *reader, const gn_node *root, size_t stage) {
    static const char *const keys[] = {"bonds", "materials", "contacts", "damping.contact"};
    const check c = gn_check_element(reader, root, "stages", stage);
    const gn_scene *base = reader->scene;
    if (!base->has_couple || !base->couple.has_convert) return GNEISS_OK;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (gn_check_given(&c, keys[k]))
            GN_TRY(gn_check_keep_problem(
                &c, gn_check_fail(&c, keys[k],
                                  "expected the value before this stage beside couple.convert, as "
                                  "dormant particles have stored bonds (gravity, "
                                  "damping.background, elements, time and output may change)")));
    return GNEISS_OK;
}

gneiss_status gn_check_stage(const gn_reader *reader, const gn_node *root, const gn_scene *before,
                             const gn_scene *now, size_t stage) {
    check c = gn_check_element(reader, root, "stages", stage);
    GN_TRY(gn_check_keep_problem(
        &c, check_can_end(&c, before, now, stage, !before && !*now->specimen.from)));
    if (!before && now->specimen.from_bonds && now->bonds != GN_SWITCH_ON)
        return gn_check_keep_problem(
            &c, gn_check_fail(&c, "name",
                              "expected bonds in the first stage beside specimen.from_bonds: keep, "
                              "found none"));
    if (!before) return GNEISS_OK;
    GN_TRY(gn_check_keep_problem(&c, check_damage(&c, before, now)));
    return gn_check_keep_problem(&c, check_kept(&c, before, now));
}
