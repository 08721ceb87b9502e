#include "scene/acts.h"

#include "base/vec3.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* ---- section of a box of walls, on which a servo that prescribes a stress acts ---- */

/* Tolerance of the cosine of the angle between orthogonal normals, and between opposite normals. */
static const double slack = 1e-6;

static bool across(const double *first, const double *second) {
    return fabs(gn_dot3(first, second)) < slack;
}

/* Finds two walls that face each other and are orthogonal to `normal` and, if given, `other`. */
static bool find_pair(const gn_scene *scene, const double *normal, const double *other,
                      gn_facing *facing) {
    for (size_t i = 0; i < scene->wall_count; i++) {
        const double *n = scene->walls[i].normal;
        if (!across(n, normal) || (other && !across(n, other))) continue;
        for (size_t j = i + 1; j < scene->wall_count; j++) {
            if (gn_dot3(n, scene->walls[j].normal) > -1.0 + slack) continue;
            facing->pair[facing->count][0] = i;
            facing->pair[facing->count++][1] = j;
            return true;
        }
    }
    return false;
}

int gn_scene_wall_facing(const gn_scene *scene, int axis, double sense) {
    for (size_t k = 0; k < scene->wall_count; k++)
        if (sense * scene->walls[k].normal[axis] > 0.999) return (int)k;
    return -1;
}

bool gn_wall_covers_open_axis(const gn_scene *scene, size_t wall) {
    const double *n = scene->walls[wall].normal;
    return gn_scene_half_periodic(scene) && fabs(n[scene->periodic_open]) > 1.0 - slack;
}

bool gn_facing_find(const gn_scene *scene, size_t wall, gn_facing *facing) {
    const double *normal = scene->walls[wall].normal;
    *facing = (gn_facing){0};
    if (!find_pair(scene, normal, NULL, facing)) return false;
    return scene->dimension == 2 ||
           find_pair(scene, normal, scene->walls[facing->pair[0][0]].normal, facing);
}

bool gn_table_is_nonzero(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return true;
    return false;
}

static bool moves(const gn_motion *motion) {
    bool acts = false;
    for (int a = 0; a < 3; a++)
        acts = acts || gn_table_is_nonzero(&motion->velocity[a]) ||
               gn_table_is_nonzero(&motion->spin[a]);
    return acts;
}

static bool has_force(const gn_set_def *set) {
    return set->has_force && (set->force[0] != 0 || set->force[1] != 0 || set->force[2] != 0);
}

/* Tells whether anything may load the specimen; `ends`: motions of the ends of the test count as
 * well. */
static bool has_load(const gn_scene *scene, bool ends) {
    bool acts = scene->elements.load_count > 0 || gn_scene_box_moves(scene);
    for (size_t k = 0; k < scene->wall_count; k++) {
        const gn_wall_def *wall = &scene->walls[k];
        acts = acts || wall->servo.active ||
               ((ends || !gn_scene_is_end(scene, wall->name)) && moves(&wall->motion));
    }
    for (size_t k = 0; k < scene->set_count; k++) {
        const gn_set_def *set = &scene->sets[k];
        acts = acts || has_force(set) ||
               ((ends || !gn_scene_is_end(scene, set->name)) && moves(&set->motion));
    }
    for (size_t k = 0; k < scene->body_count; k++) {
        const gn_body_def *body = &scene->bodies[k];
        acts = acts || body->free ||
               ((ends || !gn_scene_is_end(scene, body->name)) && moves(&body->motion));
    }
    for (size_t k = 0; k < scene->elements.motion_count; k++) {
        const gn_element_motion *motion = &scene->elements.motions[k];
        acts = acts || ((ends || !gn_scene_is_end(scene, motion->name)) && moves(&motion->motion));
    }
    return acts;
}

bool gn_scene_has_load(const gn_scene *scene) {
    return gn_table_is_nonzero(&scene->membrane.pressure) || has_load(scene, true);
}

bool gn_scene_has_other_load(const gn_scene *scene, bool membrane) {
    return (!membrane && gn_table_is_nonzero(&scene->membrane.pressure)) ||
           has_load(scene, membrane);
}

const gn_motion *gn_scene_end_motion(const gn_scene *scene, const char *name) {
    const int wall = gn_scene_find_wall(scene, name), body = gn_scene_find_body(scene, name),
              set = gn_scene_find_set(scene, name),
              nodes = gn_scene_find_element_motion(scene, name);
    return wall >= 0    ? &scene->walls[wall].motion
           : body >= 0  ? &scene->bodies[body].motion
           : set >= 0   ? &scene->sets[set].motion
           : nodes >= 0 ? &scene->elements.motions[nodes].motion
                        : NULL;
}

bool gn_scene_end_moves(const gn_scene *scene, const gn_test_end *end) {
    bool any = false;
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        any = any || (motion && gn_table_is_nonzero(&motion->velocity[scene->test.axis]));
    }
    return any;
}

/* True if a wall ever moves along its normal, towards the specimen. */
static bool approaches(const gn_wall_def *wall) {
    bool closes = false;
    for (int a = 0; a < 3; a++) {
        const gn_table *table = &wall->motion.velocity[a];
        for (size_t k = 0; k < table->count; k++)
            closes = closes || table->value[k] * wall->normal[a] > 0.0;
    }
    return closes;
}

static bool side_closes(const gn_box_side *side) {
    bool closes = gn_table_is_nonzero(&side->stress);
    for (size_t k = 0; k < side->rate.count; k++) closes = closes || side->rate.value[k] < 0.0;
    return closes;
}

bool gn_scene_may_compress(const gn_scene *scene) {
    bool squeezes =
        gn_table_is_nonzero(&scene->membrane.pressure) || scene->elements.load_count > 0;
    for (int a = 0; a < 3; a++)
        squeezes = squeezes || (scene->has_periodic && side_closes(&scene->box[a]));
    for (size_t k = 0; k < scene->wall_count; k++)
        squeezes = squeezes || scene->walls[k].servo.active || approaches(&scene->walls[k]);
    for (size_t k = 0; k < scene->set_count; k++)
        squeezes = squeezes || has_force(&scene->sets[k]) || moves(&scene->sets[k].motion);
    for (size_t k = 0; k < scene->body_count; k++)
        squeezes = squeezes || scene->bodies[k].free || moves(&scene->bodies[k].motion);
    for (size_t k = 0; k < scene->elements.motion_count; k++)
        squeezes = squeezes || moves(&scene->elements.motions[k].motion);
    return squeezes;
}

/* --- fixed sides --- */

bool gn_test_end_has(const gn_test_end *end, size_t parts, const char *name) {
    for (size_t k = 0; k < parts; k++)
        if (strcmp(end->name[k], name) == 0) return true;
    return false;
}

bool gn_scene_is_end(const gn_scene *scene, const char *name) {
    const gn_test *test = &scene->test;
    return gn_test_end_has(&test->lower, test->lower.count, name) ||
           gn_test_end_has(&test->upper, test->upper.count, name);
}

bool gn_scene_wall_is_fixed(const gn_scene *scene, size_t wall, int axis) {
    const gn_wall_def *w = &scene->walls[wall];
    return !gn_scene_is_end(scene, w->name) &&
           (scene->stage_count ||
            (!w->servo.active && !gn_table_is_nonzero(&w->motion.velocity[axis])));
}

/* Tells whether any wall that faces in a direction is fixed. A wall counts if its normal has any
 * component in this direction, because few walls of a tube face it exactly. */
static bool any_wall_is_fixed(const gn_scene *scene, int axis, double sense) {
    for (size_t k = 0; k < scene->wall_count; k++) {
        const gn_wall_def *wall = &scene->walls[k];
        if (sense * wall->normal[axis] > 0.1 && gn_scene_wall_is_fixed(scene, k, axis)) return true;
    }
    return false;
}

/* True if the specimen may stand inside the body, which is then both an end and a lateral support.
 */
static bool may_contain_specimen(const gn_body_def *body) {
    return !body->has_box;
}

/* True for a component that is prescribed and zero. */
static bool is_held(const gn_table *velocity) {
    return velocity->count && !gn_table_is_nonzero(velocity);
}

bool gn_scene_body_is_fixed(const gn_scene *scene, size_t body, int axis) {
    const gn_body_def *b = &scene->bodies[body];
    const gn_table *velocity = &b->motion.velocity[axis];
    const bool still = b->free ? is_held(velocity) : !gn_table_is_nonzero(velocity);
    return (!gn_scene_is_end(scene, b->name) || may_contain_specimen(b)) &&
           (still || scene->stage_count);
}

bool gn_scene_set_is_fixed(const gn_scene *scene, size_t set, int axis) {
    return !gn_scene_is_end(scene, scene->sets[set].name) &&
           is_held(&scene->sets[set].motion.velocity[axis]);
}

bool gn_scene_motion_is_fixed(const gn_scene *scene, size_t motion, int axis) {
    const gn_element_motion *m = &scene->elements.motions[motion];
    return !gn_scene_is_end(scene, m->name) && is_held(&m->motion.velocity[axis]);
}

bool gn_scene_is_held_along(const gn_scene *scene, int axis) {
    if (gn_scene_periodic_along(scene, axis) ||
        (any_wall_is_fixed(scene, axis, 1.0) && any_wall_is_fixed(scene, axis, -1.0)))
        return true;
    for (size_t k = 0; k < scene->body_count; k++)
        if (gn_scene_body_is_fixed(scene, k, axis)) return true;
    for (size_t k = 0; k < scene->set_count; k++)
        if (scene->stage_count ? !gn_scene_is_end(scene, scene->sets[k].name)
                               : gn_scene_set_is_fixed(scene, k, axis))
            return true;
    for (size_t k = 0; k < scene->elements.motion_count; k++)
        if (scene->stage_count ? !gn_scene_is_end(scene, scene->elements.motions[k].name)
                               : gn_scene_motion_is_fixed(scene, k, axis))
            return true;
    return scene->has_specimen &&
           scene->has_elements; /* the specimen or the elements may be the container of the other */
}

/* --- ends of a shear test --- */

static bool has_normal_load(const gn_scene *scene, const char *name, int normal) {
    int set = gn_scene_find_set(scene, name), motion = gn_scene_find_element_motion(scene, name);
    if (set >= 0)
        return scene->sets[set].motion.velocity[normal].count ||
               (scene->sets[set].has_force && scene->sets[set].force[normal] != 0.0);
    if (motion >= 0)
        return scene->elements.load_count ||
               scene->elements.motions[motion].motion.velocity[normal].count;
    return true; /* the end is a wall or a body; a free body has a weight */
}

bool gn_scene_end_has_normal_load(const gn_scene *scene, const gn_test_end *end) {
    for (size_t k = 0; k < end->count; k++)
        if (has_normal_load(scene, end->name[k], (int)scene->test.normal)) return true;
    return false;
}

bool gn_scene_shear_ends_may_separate(const gn_scene *scene) {
    if (!gn_scene_test(scene)->sheared || scene->has_membrane) return false;
    if (scene->gravity[scene->test.normal] != 0.0) return false;
    return !gn_scene_end_has_normal_load(scene, &scene->test.lower) ||
           !gn_scene_end_has_normal_load(scene, &scene->test.upper);
}
