#include "scene/acts.h"

#include <string.h>

bool gn_table_acts(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return true;
    return false;
}

static bool moves(const gn_motion *motion) {
    bool acts = false;
    for (int a = 0; a < 3; a++)
        acts = acts || gn_table_acts(&motion->velocity[a]) || gn_table_acts(&motion->spin[a]);
    return acts;
}

static bool pushed(const gn_set_def *set) {
    return set->has_force && (set->force[0] != 0 || set->force[1] != 0 || set->force[2] != 0);
}

/* `ends`: what moves of the ends of the test counts. */
static bool presses(const gn_scene *s, bool ends) {
    bool acts = s->elements.load_count > 0 || gn_scene_box_moves(s);
    for (size_t k = 0; k < s->wall_count; k++) {
        const gn_wall_def *w = &s->walls[k];
        acts = acts || w->servo.active ||
               ((ends || !gn_scene_is_end(s, w->name)) && moves(&w->motion));
    }
    for (size_t k = 0; k < s->set_count; k++) {
        const gn_set_def *set = &s->sets[k];
        acts = acts || pushed(set) ||
               ((ends || !gn_scene_is_end(s, set->name)) && moves(&set->motion));
    }
    for (size_t k = 0; k < s->body_count; k++) {
        const gn_body_def *b = &s->bodies[k];
        acts = acts || b->free || ((ends || !gn_scene_is_end(s, b->name)) && moves(&b->motion));
    }
    for (size_t k = 0; k < s->elements.motion_count; k++) {
        const gn_element_motion *m = &s->elements.motions[k];
        acts = acts || ((ends || !gn_scene_is_end(s, m->name)) && moves(&m->motion));
    }
    return acts;
}

bool gn_scene_presses(const gn_scene *s) {
    return gn_table_acts(&s->membrane.pressure) || presses(s, true);
}

bool gn_scene_presses_beside(const gn_scene *s, bool membrane) {
    return (!membrane && gn_table_acts(&s->membrane.pressure)) || presses(s, membrane);
}

const gn_motion *gn_scene_end_motion(const gn_scene *s, const char *name) {
    const int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
              set = gn_scene_find_set(s, name), nodes = gn_scene_find_element_motion(s, name);
    return wall >= 0    ? &s->walls[wall].motion
           : body >= 0  ? &s->bodies[body].motion
           : set >= 0   ? &s->sets[set].motion
           : nodes >= 0 ? &s->elements.motions[nodes].motion
                        : NULL;
}

bool gn_scene_end_moves(const gn_scene *s, const gn_test_end *end) {
    bool any = false;
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *m = gn_scene_end_motion(s, end->name[k]);
        any = any || (m && gn_table_acts(&m->velocity[s->test.axis]));
    }
    return any;
}

/* Whether a wall ever comes towards the specimen, to which its normal points. */
static bool approaches(const gn_wall_def *wall) {
    bool closes = false;
    for (int a = 0; a < 3; a++) {
        const gn_table *v = &wall->motion.velocity[a];
        for (size_t k = 0; k < v->count; k++)
            closes = closes || v->value[k] * wall->normal[a] > 0.0;
    }
    return closes;
}

static bool side_closes(const gn_box_side *side) {
    bool closes = gn_table_acts(&side->stress);
    for (size_t k = 0; k < side->rate.count; k++) closes = closes || side->rate.value[k] < 0.0;
    return closes;
}

bool gn_scene_squeezes(const gn_scene *s) {
    bool squeezes = gn_table_acts(&s->membrane.pressure) || s->elements.load_count > 0;
    for (int a = 0; a < 3; a++) squeezes = squeezes || (s->has_periodic && side_closes(&s->box[a]));
    for (size_t k = 0; k < s->wall_count; k++)
        squeezes = squeezes || s->walls[k].servo.active || approaches(&s->walls[k]);
    for (size_t k = 0; k < s->set_count; k++)
        squeezes = squeezes || pushed(&s->sets[k]) || moves(&s->sets[k].motion);
    for (size_t k = 0; k < s->body_count; k++)
        squeezes = squeezes || s->bodies[k].free || moves(&s->bodies[k].motion);
    for (size_t k = 0; k < s->elements.motion_count; k++)
        squeezes = squeezes || moves(&s->elements.motions[k].motion);
    return squeezes;
}

/* --- sides that stand --- */

bool gn_scene_in_end(const gn_test_end *end, size_t parts, const char *name) {
    for (size_t k = 0; k < parts; k++)
        if (strcmp(end->name[k], name) == 0) return true;
    return false;
}

bool gn_scene_is_end(const gn_scene *s, const char *name) {
    const gn_test *t = &s->test;
    return gn_scene_in_end(&t->lower, t->lower.count, name) ||
           gn_scene_in_end(&t->upper, t->upper.count, name);
}

bool gn_scene_wall_stands(const gn_scene *s, size_t wall, int axis) {
    const gn_wall_def *w = &s->walls[wall];
    return !gn_scene_is_end(s, w->name) &&
           (s->stage_count || (!w->servo.active && !gn_table_acts(&w->motion.velocity[axis])));
}

/* Any that leans against the direction will do: a tube of many walls has few that face it. */
static bool wall_stands(const gn_scene *s, int axis, double sense) {
    for (size_t k = 0; k < s->wall_count; k++) {
        const gn_wall_def *w = &s->walls[k];
        if (sense * w->normal[axis] > 0.1 && gn_scene_wall_stands(s, k, axis)) return true;
    }
    return false;
}

/* Whether the specimen may stand in it, so that it is an end and what holds the sides in one. */
static bool may_be_cup(const gn_body_def *b) {
    return !b->has_box;
}

/* A channel that is prescribed and stays at rest. */
static bool held(const gn_table *velocity) {
    return velocity->count && !gn_table_acts(velocity);
}

bool gn_scene_body_stands(const gn_scene *s, size_t body, int axis) {
    const gn_body_def *b = &s->bodies[body];
    const gn_table *velocity = &b->motion.velocity[axis];
    const bool still = b->free ? held(velocity) : !gn_table_acts(velocity);
    return (!gn_scene_is_end(s, b->name) || may_be_cup(b)) && (still || s->stage_count);
}

bool gn_scene_set_stands(const gn_scene *s, size_t set, int axis) {
    return !gn_scene_is_end(s, s->sets[set].name) && held(&s->sets[set].motion.velocity[axis]);
}

bool gn_scene_motion_stands(const gn_scene *s, size_t motion, int axis) {
    const gn_element_motion *m = &s->elements.motions[motion];
    return !gn_scene_is_end(s, m->name) && held(&m->motion.velocity[axis]);
}

bool gn_scene_stands(const gn_scene *s, int axis) {
    if (gn_scene_periodic_along(s, axis) ||
        (wall_stands(s, axis, 1.0) && wall_stands(s, axis, -1.0)))
        return true;
    for (size_t k = 0; k < s->body_count; k++)
        if (gn_scene_body_stands(s, k, axis)) return true;
    for (size_t k = 0; k < s->set_count; k++)
        if (s->stage_count ? !gn_scene_is_end(s, s->sets[k].name) : gn_scene_set_stands(s, k, axis))
            return true;
    for (size_t k = 0; k < s->elements.motion_count; k++)
        if (s->stage_count ? !gn_scene_is_end(s, s->elements.motions[k].name)
                           : gn_scene_motion_stands(s, k, axis))
            return true;
    return s->has_specimen && s->has_elements; /* a container, or what stands in one */
}

/* --- ends of a shear test --- */

static bool bears(const gn_scene *s, const char *name, int normal) {
    int set = gn_scene_find_set(s, name), motion = gn_scene_find_element_motion(s, name);
    if (set >= 0)
        return s->sets[set].motion.velocity[normal].count ||
               (s->sets[set].has_force && s->sets[set].force[normal] != 0.0);
    if (motion >= 0)
        return s->elements.load_count || s->elements.motions[motion].motion.velocity[normal].count;
    return true; /* a wall or a body, which has a weight if it is free */
}

bool gn_scene_end_bears(const gn_scene *s, const gn_test_end *end) {
    for (size_t k = 0; k < end->count; k++)
        if (bears(s, end->name[k], (int)s->test.normal)) return true;
    return false;
}

bool gn_scene_shears_loose(const gn_scene *s) {
    if (!gn_scene_test(s)->sheared || s->has_membrane) return false;
    if (s->gravity[s->test.normal] != 0.0) return false;
    return !gn_scene_end_bears(s, &s->test.lower) || !gn_scene_end_bears(s, &s->test.upper);
}
