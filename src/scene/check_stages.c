/* Whether stages can begin and end. */
#include "base/vec3.h"
#include "scene/acts.h"
#include "scene/check.h"
#include "scene/stages.h"
#include "scene/stages_check.h"

#include <math.h>
#include <string.h>

static bool by_time_alone(const gn_stage *e) {
    gn_stage other = *e;
    other.time = -1;
    return e->time >= 0 && !gn_stage_has_end(&other);
}

static gneiss_status check_name(const check *c, const gn_scene *s, size_t stage) {
    for (size_t k = 0; k < stage; k++)
        if (strcmp(s->stages[k].name, s->stages[stage].name) == 0)
            return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                                 s->stages[stage].name);
    return GNEISS_OK;
}

/* s, by which stages that end by time alone are over. */
static double least_start(const gn_scene *s, size_t stage) {
    double sum = 0.0;
    for (size_t k = 0; k < stage; k++)
        if (by_time_alone(&s->stages[k])) sum += s->stages[k].time;
    return sum;
}

static gneiss_status check_end(const check *c, const gn_scene *s, size_t stage) {
    const gn_stage *e = &s->stages[stage];
    bool last = stage + 1 == s->stage_count;
    if (!gn_stage_has_end(e) && !last)
        return gn_check_fail(c, gn_check_given(c, "end") ? "end" : "name",
                             "expected a condition under end (time, steps, strain, stress, "
                             "peak_drop, unbalanced, held), found none: the stage would never end");
    const bool tested = gn_scene_tested(s);
    const char *reads = e->strain > 0      ? "end.strain"
                        : e->stress > 0    ? "end.stress"
                        : e->peak_drop > 0 ? "end.peak_drop"
                                           : NULL;
    if (reads && !tested)
        return gn_check_fail(c, reads,
                             "expected a test section that reads it, found none: the "
                             "stage would never end");
    double least = least_start(s, stage) + fmax(e->time, 0.0);
    if (by_time_alone(e) && least > s->end * (1.0 + 1e-9))
        return gn_check_fail(c, "end.time",
                             "expected an end before time.end, %g s, which ends the run, found at "
                             "least %g s: the stage would never end",
                             s->end, least);
    return GNEISS_OK;
}

static gneiss_status check_base(const check *c, const gn_scene *s) {
    if (s->start == GN_START_FIRST_BREAK)
        return gn_check_fail(c, "time.start",
                             "expected rest beside stages, found first_break: statics follow the "
                             "loads of one stage");
    const char *stop = gn_check_stop(s);
    if (!stop) return GNEISS_OK;
    return gn_check_fail(c, stop, "expected under end of a stage, found beside stages");
}

gneiss_status gn_check_stages(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    check c = {.reader = reader, .map = root};
    GN_TRY(gn_check_keep(&c, check_base(&c, s)));
    for (size_t k = 0; k < s->stage_count; k++) {
        check element = gn_check_element(reader, root, "stages", k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(&c, check_name(&element, s, k)));
        GN_TRY(gn_check_keep(&c, check_end(&element, s, k)));
    }
    return GNEISS_OK;
}

/* ---- a stage as a whole ---- */

static bool given(const gn_table table[3]) {
    return table[0].count || table[1].count || table[2].count;
}

static bool prescribed(const gn_motion *motion) {
    return given(motion->velocity) || given(motion->spin);
}

/* Whether contacts may begin with a force: bonds that are free of stress at another distance, or
 * that another run had loaded. */
static bool prestressed(const gn_scene *s) {
    return s->specimen.from_bonds || (s->bonds == GN_SWITCH_ON && !s->passive_gaps);
}

/* Whether anything could change a specimen that is at rest, besides what presses it. */
static bool anything_else_acts(const gn_scene *s) {
    bool acts = prestressed(s) || s->source_count || s->has_pulse || s->random_velocity != 0;
    for (int a = 0; a < 3; a++) acts = acts || s->gravity[a] != 0;
    for (size_t k = 0; k < s->set_count; k++)
        acts = acts || s->sets[k].has_initial_velocity || s->sets[k].has_initial_spin;
    return acts;
}

static bool anything_acts(const gn_scene *s) {
    return gn_scene_presses(s) || anything_else_acts(s);
}

/* Whether rows of a scene reach into each other or into a wall that does not take that for free of
 * stress. */
static bool rows_overlap(const gn_scene *s) {
    const gn_specimen *p = &s->specimen;
    for (size_t i = 0; i < p->particle_count; i++) {
        const double *x = p->particles + 4 * i;
        for (size_t j = 0; j < i; j++) {
            const double *y = p->particles + 4 * j, sum = x[3] + y[3],
                         d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
            if (gn_dot3(d, d) < sum * sum * (1.0 - 1e-9)) return true;
        }
        for (size_t k = 0; k < s->wall_count; k++) {
            const gn_wall_def *w = &s->walls[k];
            const double d[3] = {x[0] - w->point[0], x[1] - w->point[1], x[2] - w->point[2]};
            if (!w->passive && gn_dot3(d, w->normal) < x[3] * (1.0 - 1e-9)) return true;
        }
    }
    return false;
}

/* Whether a stage that begins at rest may find contacts that are pressed: what is not in the scene
 * itself is looked at once it stands (gn_world_stage_check). */
static bool may_overlap(const gn_scene *s) {
    return !s->specimen.particle_count || s->body_count || s->has_elements || rows_overlap(s);
}

/* After a stage before it may still be on the move: what is held, too, has a reason to be there. */
static bool anything_given(const gn_scene *s) {
    bool any = anything_acts(s);
    for (size_t k = 0; k < s->wall_count; k++) any = any || prescribed(&s->walls[k].motion);
    for (size_t k = 0; k < s->set_count; k++) any = any || prescribed(&s->sets[k].motion);
    for (size_t k = 0; k < s->body_count; k++) any = any || prescribed(&s->bodies[k].motion);
    for (size_t k = 0; k < s->elements.motion_count; k++)
        any = any || prescribed(&s->elements.motions[k].motion);
    return any;
}

/* ---- ends that only part ---- */

/* The most of a table, or of minus it, from a time on; 0 of an empty one. */
static double most(const gn_table *table, double sign, double from) {
    double found = table->count ? sign * table->value[table->count - 1] : 0.0;
    for (size_t k = 0; k + 1 < table->count; k++)
        if (table->time[k + 1] > from) found = fmax(found, sign * table->value[k]);
    return found;
}

/* The velocity of a part of an end along the axis; NULL: it follows forces. */
static const gn_table *velocity_of(const gn_scene *s, const char *name) {
    const int axis = (int)s->test.axis, wall = gn_scene_find_wall(s, name),
              body = gn_scene_find_body(s, name), set = gn_scene_find_set(s, name),
              motion = gn_scene_find_element_motion(s, name);
    const gn_motion *m = wall >= 0     ? &s->walls[wall].motion
                         : body >= 0   ? &s->bodies[body].motion
                         : set >= 0    ? &s->sets[set].motion
                         : motion >= 0 ? &s->elements.motions[motion].motion
                                       : NULL;
    const bool stands =
        wall >= 0 ? !s->walls[wall].servo.active : body >= 0 && !s->bodies[body].free;
    return m && (stands || m->velocity[axis].count) ? &m->velocity[axis] : NULL;
}

/* The fastest that an end ever moves in the sense of `sign` along the axis in a stage or later;
 * infinity where parts of it follow forces. */
static double fastest(const gn_scene *s, size_t stage, const gn_test_end *end, double sign) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const gn_table *velocity = velocity_of(s, end->name[k]);
        if (!velocity) return INFINITY;
        const double given = velocity->stage ? least_start(s, velocity->stage - 1) : 0.0;
        sum += most(velocity, sign, least_start(s, stage) - given);
    }
    return sum / (double)end->count;
}

/* Whether the strain of a test whose ends are moved as given can never grow. */
static bool never_strains(const gn_scene *s, size_t stage) {
    const gn_test *t = &s->test;
    if (!gn_scene_test(s)->ends || t->has_control) return false;
    const double sign = gn_scene_test(s)->sign;
    return fastest(s, stage, &t->upper, sign) + fastest(s, stage, &t->lower, -sign) <= 0.0;
}

static const char *strains_by(const gn_scene *s) {
    const gn_test_descriptor *d = gn_scene_test(s);
    return d->sheared ? "shear the specimen" : d->sign < 0 ? "close" : "come apart";
}

/* Whether each part of an end is moved as given, and none of them ever in the sense of `sign`; the
 * others are counted. */
static bool only_against(const gn_scene *s, const gn_test_end *end, double sign, int *against) {
    for (size_t k = 0; k < end->count; k++) {
        const gn_table *velocity = velocity_of(s, end->name[k]);
        const gn_motion *m = gn_scene_end_motion(s, end->name[k]);
        if (!velocity || most(velocity, sign, -INFINITY) > 0.0) return false;
        for (int a = 0; a < 3; a++)
            if (gn_table_acts(&m->spin[a])) return false;
        *against += gn_table_acts(velocity);
    }
    return true;
}

gneiss_status gn_check_parting(const check *c, const gn_scene *s) {
    const gn_test *t = &s->test;
    const gn_test_descriptor *d = gn_scene_test(s);
    const double sign = d->sign;
    int against = 0;
    if (d->beam || d->sheared || d->confined) return GNEISS_OK;
    if (s->has_elements || t->has_control || *s->specimen.from ||
        gn_scene_presses_beside(s, false) || anything_else_acts(s) || rows_overlap(s))
        return GNEISS_OK;
    if (!only_against(s, &t->upper, sign, &against) || !only_against(s, &t->lower, -sign, &against))
        return GNEISS_OK;
    if (!against) return GNEISS_OK; /* what stands may be there to be watched */
    return gn_check_fail(c, "test.upper",
                         "expected ends that %s, found ends that only %s: the test would measure "
                         "nothing",
                         strains_by(s), sign < 0.0 ? "come apart" : "close");
}

static double largest_pressure(const gn_scene *s) {
    return s ? fmax(0.0, most(&s->membrane.pressure, 1.0, -INFINITY)) : 0.0;
}

/* A specimen on which nothing but a membrane presses has its pressure as mean stress, at most twice
 * that where it comes at once. */
static bool never_so_pressed(const gn_scene *before, const gn_scene *s, double stress) {
    if (!gn_scene_test(s)->isotropic || gn_scene_presses_beside(s, true) || anything_else_acts(s))
        return false;
    return stress > 2.0 * fmax(largest_pressure(before), largest_pressure(s));
}

static bool servo(const gn_scene *s) {
    for (size_t k = 0; k < s->wall_count; k++)
        if (s->walls[k].servo.active) return true;
    for (int a = 0; a < 3; a++)
        if (s->has_periodic && s->box[a].stress.count) return true;
    return false;
}

/* What is looked at in rows of the history alone. */
static const char *end_by_rows(const gn_stage *e) {
    return e->strain > 0       ? "end.strain"
           : e->stress > 0     ? "end.stress"
           : e->peak_drop > 0  ? "end.peak_drop"
           : e->unbalanced > 0 ? "end.unbalanced"
           : e->held > 0       ? "end.held"
                               : NULL;
}

static const char nothing[] = "expected something that moves or acts in this stage, found nothing: "
                              "it would never end";

static const char parting[] = "expected ends that %s in this stage, found none that do: it would "
                              "never end";

/* Of a given step, which stays what it is. */
static gneiss_status check_steps(const check *c, const gn_scene *s, const gn_stage *e) {
    gn_stage other = *e;
    other.steps = -1;
    if (e->steps < 0 || gn_stage_has_end(&other) || !(s->step > 0)) return GNEISS_OK;
    const double duration = (double)e->steps * s->step;
    if (duration <= s->end * (1.0 + 1e-9)) return GNEISS_OK;
    return gn_check_fail(c, "end.steps",
                         "expected an end before time.end, %g s, which ends the run, found %.10g s "
                         "(steps of time.step, %g s): the stage would never end",
                         s->end, duration, s->step);
}

/* What can only end by strain or stress, where neither comes. */
static gneiss_status check_growth(const check *c, const gn_scene *before, const gn_scene *s,
                                  size_t stage, bool first) {
    const gn_stage *e = &s->stages[stage];
    const bool parts = never_strains(s, stage), idle = !gn_scene_presses_beside(s, false) &&
                                                       !anything_else_acts(s) && !may_overlap(s);
    const char *key = end_by_rows(e);
    const bool waits = e->strain > 0 && !(e->stress > 0) && !(e->peak_drop > 0);
    if (parts && waits && first && !anything_acts(s)) return gn_check_fail(c, key, nothing);
    if (parts && (waits || (first && idle))) return gn_check_fail(c, key, parting, strains_by(s));
    if (e->stress > 0 && !(e->strain > 0) && !(e->peak_drop > 0) &&
        never_so_pressed(before, s, e->stress))
        return gn_check_fail(c, "end.stress",
                             "expected at most twice the pressure of the membrane, %g Pa, as "
                             "nothing else presses, found %g Pa: it would never end",
                             largest_pressure(s), e->stress);
    return GNEISS_OK;
}

static gneiss_status check_can_end(const check *c, const gn_scene *before, const gn_scene *s,
                                   size_t stage, bool first) {
    const gn_stage *e = &s->stages[stage];
    if (s->history_rows == 0 && end_by_rows(e))
        return gn_check_fail(c, end_by_rows(e),
                             "expected output.history_rows above 0, as it is looked at in rows of "
                             "the history, found 0: the stage would never end by it");
    gn_stage others = *e;
    others.held = 0.0;
    /* A pressure of 0 that a stage gives is one of a series; else the membrane may begin later. */
    const bool pressed =
        s->has_membrane && (s->membrane_stage > 0 || gn_table_acts(&s->membrane.pressure));
    if (e->held > 0 && !servo(s) && !pressed && !gn_stage_has_end(&others))
        return gn_check_fail(
            c, "end.held",
            "expected a wall or a periodic box with a servo, or a membrane with a pressure, in "
            "this stage, found none: the stage would never end");
    GN_TRY(check_steps(c, s, e));
    if (!gn_stage_has_end(e) || e->time >= 0 || e->steps >= 0 || e->held > 0) return GNEISS_OK;
    const bool acts =
        first ? anything_acts(s) || may_overlap(s) : anything_given(s) || e->unbalanced > 0;
    if (!acts) return gn_check_fail(c, end_by_rows(e), nothing);
    return e->unbalanced > 0 ? GNEISS_OK : check_growth(c, before, s, stage, first);
}

const char *gn_stage_waits(const gn_scene *s, size_t stage, char *why, size_t size) {
    const gn_stage *e = &s->stages[stage];
    const bool by_rows = gn_stage_has_end(e) && e->time < 0 && e->steps < 0 && !(e->held > 0);
    if (!by_rows || stage != 0 || *s->specimen.from) return NULL;
    if (!anything_acts(s)) {
        snprintf(why, size, "%s", nothing);
        return end_by_rows(e);
    }
    if (e->unbalanced > 0 || !never_strains(s, stage) || gn_scene_presses_beside(s, false) ||
        anything_else_acts(s))
        return NULL;
    snprintf(why, size, parting, strains_by(s));
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

static const char fewer[] =
    "expected the channels that it has before this stage, %s '%s': which are prescribed holds for "
    "all of the run (a velocity may be 0)";

/* Whether a material has what bonds that soften or yield have damage over. */
static bool same_bonds(const gn_material *a, const gn_material *b) {
    gn_material now = *b;
    now.friction = a->friction;
    now.where = a->where;
    /* Both were zeroed before they were read. */
    return memcmp(a, &now, sizeof now) == 0; // NOLINT(bugprone-suspicious-memory-comparison)
}

static gneiss_status check_damage(const check *c, const gn_scene *before, const gn_scene *now) {
    for (size_t k = 0; k < now->material_count; k++) {
        if (now->materials[k].kratio == 0.0 && before->materials[k].kratio > 0.0)
            return gn_check_fail(c, "materials",
                                 "expected a tangential spring of '%s' in this stage too, for what "
                                 "its contacts hold, found kratio 0",
                                 now->materials[k].name);
        bool damaged = now->softening != GN_SOFTENING_NONE || now->materials[k].yield_stress[0] > 0;
        if (damaged && !same_bonds(&before->materials[k], &now->materials[k]))
            return gn_check_fail(
                c, "materials",
                "expected no other stiffness and strength of '%s', whose bonds "
                "soften or yield: what they have gone through is relative to these",
                now->materials[k].name);
    }
    return GNEISS_OK;
}

/* The skin is found once, when the run begins. */
static gneiss_status check_skin(const check *c, const gn_scene *before, const gn_scene *now) {
    const gn_membrane_def *was = &before->membrane, *is = &now->membrane;
    const char *other = was->faces != is->faces       ? "membrane.faces"
                        : was->axis != is->axis       ? "membrane.axis"
                        : was->follow != is->follow   ? "membrane.follow"
                        : was->surface != is->surface ? "membrane.surface"
                                                      : NULL;
    if (!other) return GNEISS_OK;
    return gn_check_fail(c, other,
                         "expected what holds before this stage too: of a membrane pressure and "
                         "ramp may change");
}

/* What the parts decide once, when they are made. */
static gneiss_status check_kept(const check *c, const gn_scene *before, const gn_scene *now) {
    GN_TRY(check_skin(c, before, now));
    for (size_t k = 0; k < now->body_count; k++) {
        const gn_body_def *b = &now->bodies[k];
        if (b->free && channels(&b->motion) != channels(&before->bodies[k].motion))
            return gn_check_fail(c, "bodies", fewer, "free body", b->name);
    }
    for (size_t k = 0; k < now->elements.motion_count; k++) {
        const gn_element_motion *m = &now->elements.motions[k];
        if (channels(&m->motion) != channels(&before->elements.motions[k].motion))
            return gn_check_fail(c, "elements", fewer, "motion of elements", m->name);
    }
    return GNEISS_OK;
}

/* Who sleeps has its bonds put by, and no contacts. */
gneiss_status gn_check_stage_asleep(const gn_reader *reader, const gn_node *root, size_t stage) {
    static const char *const keys[] = {"bonds", "materials", "contacts", "damping.contact"};
    const check c = gn_check_element(reader, root, "stages", stage);
    const gn_scene *base = reader->scene;
    if (!base->has_couple || !base->couple.has_convert) return GNEISS_OK;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (gn_check_given(&c, keys[k]))
            GN_TRY(gn_check_keep(
                &c,
                gn_check_fail(&c, keys[k],
                              "expected what holds before this stage too beside couple.convert, "
                              "as particles sleep with bonds that are put by (gravity, "
                              "damping.background, elements, time and output may change)")));
    return GNEISS_OK;
}

gneiss_status gn_check_stage(const gn_reader *reader, const gn_node *root, const gn_scene *before,
                             const gn_scene *now, size_t stage) {
    check c = gn_check_element(reader, root, "stages", stage);
    GN_TRY(
        gn_check_keep(&c, check_can_end(&c, before, now, stage, !before && !*now->specimen.from)));
    if (!before && now->specimen.from_bonds && now->bonds != GN_SWITCH_ON)
        return gn_check_keep(
            &c, gn_check_fail(&c, "name",
                              "expected bonds in the first stage beside specimen.from_bonds: keep, "
                              "found none"));
    if (!before) return GNEISS_OK;
    GN_TRY(gn_check_keep(&c, check_damage(&c, before, now)));
    return gn_check_keep(&c, check_kept(&c, before, now));
}
