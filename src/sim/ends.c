/* The two ends of a test: what loads the specimen there and how far it went. An end may have
 * several parts (two supports under a beam); their forces add up, their travel is the mean over the
 * parts.
 */
#include "sim/ends.h"

/* From where it stood at the start, along the axis. */
static double part_travel(const gn_world *w, const char *name, int axis) {
    const gn_scene *s = &w->scene;
    int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
        motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) return w->boundary.walls[wall].point[axis] - w->boundary.walls[wall].start[axis];
    if (body >= 0)
        return w->boundary.bodies[body].position[axis] - w->boundary.bodies[body].start[axis];
    if (motion < 0) return gn_set_travel(w, (size_t)gn_scene_find_set(s, name), axis);
    double travel[3];
    gn_elements_travel(w, (size_t)motion, travel);
    return travel[axis];
}

static double end_travel(const gn_world *w, const gn_test_end *end, int axis) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) sum += part_travel(w, end->name[k], axis);
    return sum / (double)end->count;
}

/* Force with which a part loads the specimen along the axis. */
static double part_force(const gn_world *w, const char *name, int axis) {
    const gn_scene *s = &w->scene;
    int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
        motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) return -w->boundary.walls[wall].force[axis];
    if (body >= 0) return -w->boundary.bodies[body].force[axis];
    if (motion >= 0) {
        double force[3];
        gn_elements_reaction(w, (size_t)motion, force);
        return force[axis];
    }
    int set = gn_scene_find_set(s, name);
    if (s->sets[set].motion.velocity[axis].count) return w->dem.set_reaction[6 * set + axis];
    return s->sets[set].has_force ? s->sets[set].force[axis] : 0.0;
}

static double end_force(const gn_world *w, const gn_test_end *end) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++)
        sum += part_force(w, end->name[k], (int)w->scene.test.axis);
    return sum;
}

static double test_sign(const gn_world *w) {
    return gn_test_sign(w->scene.test.kind);
}

double gn_ends_deflection(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    int axis = (int)t->axis;
    return test_sign(w) * (end_travel(w, &t->upper, axis) - end_travel(w, &t->lower, axis));
}

double gn_ends_opening(const gn_world *w) {
    const gn_opening *o = &w->scene.test.opening;
    int axis = (int)o->axis;
    return end_travel(w, &o->upper, axis) - end_travel(w, &o->lower, axis);
}

void gn_ends_forces(const gn_world *w, double *lower, double *upper) {
    double sign = test_sign(w);
    *lower = -sign * end_force(w, &w->scene.test.lower);
    *upper = sign * end_force(w, &w->scene.test.upper);
    if (!gn_scene_end_drives(&w->scene, &w->scene.test.lower)) *lower = *upper;
    if (!gn_scene_end_drives(&w->scene, &w->scene.test.upper)) *upper = *lower;
}

double gn_ends_normal(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    double sum = 0.0;
    for (size_t k = 0; k < t->upper.count; k++)
        sum -= part_force(w, t->upper.name[k], (int)t->normal);
    return sum;
}

double gn_ends_dilation(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    int normal = (int)t->normal;
    return end_travel(w, &t->upper, normal) - end_travel(w, &t->lower, normal);
}
