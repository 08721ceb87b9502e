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

bool gn_scene_presses(const gn_scene *s) {
    bool acts =
        gn_table_acts(&s->membrane.pressure) || s->elements.load_count > 0 || gn_scene_box_moves(s);
    for (size_t k = 0; k < s->wall_count; k++)
        acts = acts || s->walls[k].servo.active || moves(&s->walls[k].motion);
    for (size_t k = 0; k < s->set_count; k++)
        acts = acts || pushed(&s->sets[k]) || moves(&s->sets[k].motion);
    for (size_t k = 0; k < s->body_count; k++)
        acts = acts || s->bodies[k].free || moves(&s->bodies[k].motion);
    for (size_t k = 0; k < s->elements.motion_count; k++)
        acts = acts || moves(&s->elements.motions[k].motion);
    return acts;
}

/* --- sides that stand --- */

bool gn_scene_in_end(const gn_test_end *end, size_t parts, const char *name) {
    for (size_t k = 0; k < parts; k++)
        if (strcmp(end->name[k], name) == 0) return true;
    return false;
}

static bool is_end(const gn_scene *s, const char *name) {
    const gn_test *t = &s->test;
    return gn_scene_in_end(&t->lower, t->lower.count, name) ||
           gn_scene_in_end(&t->upper, t->upper.count, name);
}

/* Any that leans against the direction will do: a tube of many walls has few that face it. */
static bool wall_stands(const gn_scene *s, int axis, double sense) {
    for (size_t k = 0; k < s->wall_count; k++) {
        const gn_wall_def *w = &s->walls[k];
        if (!is_end(s, w->name) && sense * w->normal[axis] > 0.1 &&
            (!w->servo.active || s->stage_count))
            return true;
    }
    return false;
}

/* Whether the specimen may stand in it, so that it is an end and what holds the sides in one. */
static bool may_be_cup(const gn_body_def *b) {
    return !b->has_box;
}

bool gn_scene_stands(const gn_scene *s, int axis) {
    if (gn_scene_periodic_along(s, axis) ||
        (wall_stands(s, axis, 1.0) && wall_stands(s, axis, -1.0)))
        return true;
    for (size_t k = 0; k < s->body_count; k++)
        if (!is_end(s, s->bodies[k].name) || may_be_cup(&s->bodies[k])) return true;
    for (size_t k = 0; k < s->set_count; k++)
        if (!is_end(s, s->sets[k].name) &&
            (s->stage_count || s->sets[k].motion.velocity[axis].count))
            return true;
    for (size_t k = 0; k < s->elements.motion_count; k++)
        if (!is_end(s, s->elements.motions[k].name) &&
            (s->stage_count || s->elements.motions[k].motion.velocity[axis].count))
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

static bool end_bears(const gn_scene *s, const gn_test_end *end) {
    for (size_t k = 0; k < end->count; k++)
        if (bears(s, end->name[k], (int)s->test.normal)) return true;
    return false;
}

bool gn_scene_shears_loose(const gn_scene *s) {
    if (!gn_test_in(s->test.kind, GN_TESTS_SHEARED) || s->has_membrane) return false;
    if (s->gravity[s->test.normal] != 0.0) return false;
    return !end_bears(s, &s->test.lower) || !end_bears(s, &s->test.upper);
}
