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

static double end_force(const gn_world *w, const gn_test_end *end, int axis) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) sum += part_force(w, end->name[k], axis);
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
    const gn_test *t = &w->scene.test;
    *lower = -sign * end_force(w, &t->lower, (int)t->axis);
    *upper = sign * end_force(w, &t->upper, (int)t->axis);
    if (!gn_scene_end_drives(&w->scene, &w->scene.test.lower)) *lower = *upper;
    if (!gn_scene_end_drives(&w->scene, &w->scene.test.upper)) *upper = *lower;
}

/* Whether a part can bear or load along an axis. */
static bool acts_along(const gn_scene *s, const char *name, int axis) {
    int set = gn_scene_find_set(s, name);
    if (gn_scene_find_wall(s, name) >= 0 || gn_scene_find_body(s, name) >= 0 || set < 0)
        return true;
    return s->sets[set].motion.velocity[axis].count || s->sets[set].has_force;
}

static bool end_acts_along(const gn_world *w, const gn_test_end *end, int axis) {
    bool acts = false;
    for (size_t k = 0; k < end->count; k++) acts |= acts_along(&w->scene, end->name[k], axis);
    return acts;
}

void gn_ends_normals(const gn_world *w, double *lower, double *upper) {
    const gn_test *t = &w->scene.test;
    const int normal = (int)t->normal;
    *lower = end_force(w, &t->lower, normal);
    *upper = -end_force(w, &t->upper, normal);
    if (!end_acts_along(w, &t->lower, normal)) *lower = *upper;
    if (!end_acts_along(w, &t->upper, normal)) *upper = *lower;
}

double gn_ends_dilation(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    int normal = (int)t->normal;
    return end_travel(w, &t->upper, normal) - end_travel(w, &t->lower, normal);
}

/* The place of an end that is farthest along `sense` (+1, -1) times the normal, times `sense`. */
static double end_reach(const gn_world *w, const gn_test_end *end, double sense) {
    const gn_particles *q = &w->dem.particles;
    const int normal = (int)w->scene.test.normal;
    double reach = -INFINITY;
    for (size_t k = 0; k < end->count; k++) {
        int wall = gn_scene_find_wall(&w->scene, end->name[k]),
            set = gn_scene_find_set(&w->scene, end->name[k]);
        if (wall >= 0) reach = fmax(reach, sense * w->scene.walls[wall].point[normal]);
        for (size_t p = 0; set >= 0 && p < q->soa.count; p++)
            if (gn_set_selected(w, (size_t)set, p))
                reach = fmax(reach, sense * q->start[4 * p + (size_t)normal]);
    }
    return reach;
}

double gn_ends_gap(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    return -end_reach(w, &t->upper, -1.0) - end_reach(w, &t->lower, 1.0);
}
