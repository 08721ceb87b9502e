/* Whether the two ends of a test are what its kind asks for: one below, one above. */
#include "base/point.h"
#include "scene/acts.h"
#include "sim/bending.h"
#include "sim/ends.h"
#include "sim/laboratory.h"

#include <math.h>
#include <stdio.h>

/* Where an end is along a direction at the start: centres of particles, nodes, corners of bodies,
 * points of walls across it. */
typedef struct reach {
    double low, high, sum; /* m */
    size_t count;          /* 0: nothing is known */
    bool bodies;           /* alone */
} reach;

static void add(reach *r, double x) {
    r->low = fmin(r->low, x);
    r->high = fmax(r->high, x);
    r->sum += x;
    r->count++;
}

static double middle(const reach *r) {
    return r->sum / (double)r->count;
}

static void add_wall(const gn_wall_def *wall, int way, reach *r) {
    if (fabs(wall->normal[way]) > 0.9) add(r, wall->point[way]);
    r->bodies = false;
}

static void add_body(const gn_world *w, size_t body, int way, reach *r) {
    size_t first = 0;
    for (size_t k = 0; k < body; k++) first += (size_t)w->boundary.body_shape[k][0];
    for (size_t n = first; n < first + (size_t)w->boundary.body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&w->boundary.bodies[body], w->boundary.body_vertex + 4 * n, corner);
        add(r, corner[way]);
    }
}

static void add_set(const gn_world *w, size_t set, int way, reach *r) {
    const gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_set_selected(w, set, p)) add(r, q->start[4 * p + (size_t)way]);
    r->bodies = false;
}

static void add_motion(const gn_world *w, size_t motion, int way, reach *r) {
    const gn_particles *nodes;
    const gn_fem_set *set = gn_elements_motion_set(w, motion, &nodes);
    for (size_t k = 0; k < set->count; k++)
        add(r, nodes->start[4 * (size_t)set->node[k] + (size_t)way]);
    r->bodies = false;
}

static const reach nowhere = {.low = INFINITY, .high = -INFINITY, .bodies = true};

static void add_part(const gn_world *w, const char *name, int way, reach *r) {
    const gn_scene *s = &w->scene;
    const int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
              set = gn_scene_find_set(s, name), motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) add_wall(&s->walls[wall], way, r);
    if (body >= 0) add_body(w, (size_t)body, way, r);
    if (set >= 0) add_set(w, (size_t)set, way, r);
    if (motion >= 0) add_motion(w, (size_t)motion, way, r);
}

static reach reach_of(const gn_world *w, const gn_test_end *end, int way) {
    reach r = nowhere;
    for (size_t k = 0; k < end->count; k++) add_part(w, end->name[k], way, &r);
    return r;
}

/* --- what is wrong --- */

static gneiss_status fail(const gn_world *w, int way, const reach *lower, const reach *upper,
                          const char *what, gneiss_error *error) {
    const gn_test *t = &w->scene.test;
    const double origin = w->scene.origin[way];
    const gn_scene_place where = t->upper.where.line ? t->upper.where : t->where;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected an end above the lower one along %c, found %s: lower is at %.4g "
                   "to %.4g m, upper at %.4g to %.4g m",
                   gn_scene_at(&w->scene, where, "test.upper").text, "xyz"[way], what,
                   gn_point_out(origin, lower->low), gn_point_out(origin, lower->high),
                   gn_point_out(origin, upper->low), gn_point_out(origin, upper->high));
}

static int64_t shared_particles(const gn_world *w, size_t one, size_t other) {
    int64_t shared = 0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        shared += gn_set_selected(w, one, p) && gn_set_selected(w, other, p);
    return shared;
}

static int64_t shared_nodes(const gn_world *w, size_t one, size_t other) {
    const gn_particles *nodes;
    const gn_fem_set *a = gn_elements_motion_set(w, one, &nodes),
                     *b = gn_elements_motion_set(w, other, &nodes);
    int64_t shared = 0;
    for (size_t k = 0, m = 0; k < a->count; k++) {
        while (m < b->count && b->node[m] < a->node[k]) m++;
        shared += m < b->count && b->node[m] == a->node[k];
    }
    return shared;
}

/* What is in both ends is loaded by neither against the other. */
static gneiss_status check_shared(const gn_world *w, const char *lower, const char *upper,
                                  gneiss_error *error) {
    const gn_scene *s = &w->scene;
    int sets[] = {gn_scene_find_set(s, lower), gn_scene_find_set(s, upper)},
        motions[] = {gn_scene_find_element_motion(s, lower),
                     gn_scene_find_element_motion(s, upper)};
    int64_t shared = 0;
    if (sets[0] >= 0 && sets[1] >= 0)
        shared = shared_particles(w, (size_t)sets[0], (size_t)sets[1]);
    else if (motions[0] >= 0 && motions[1] >= 0)
        shared = shared_nodes(w, (size_t)motions[0], (size_t)motions[1]);
    if (!shared) return GNEISS_OK;
    const gn_scene_place where = s->test.upper.where.line ? s->test.upper.where : s->test.where;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected another part of the specimen than the lower end, found '%s' and "
                   "'%s' with %lld %s in common",
                   gn_scene_at(s, where, "test.upper").text, lower, upper, (long long)shared,
                   sets[0] >= 0 ? "particles" : "nodes");
}

static bool at_one_height(const gn_world *w, int way, const reach *lower, const reach *upper) {
    return fabs(middle(upper) - middle(lower)) < (w->upper[way] - w->lower[way]) / 3.0;
}

/* Neither is above the other, and both are in the same outer third of the specimen. */
static bool on_one_side(const gn_world *w, int way, const reach *lower, const reach *upper) {
    const double low = w->lower[way], high = w->upper[way], third = (high - low) / 3.0;
    const double l = middle(lower), u = middle(upper);
    return u <= lower->high && l >= upper->low &&
           ((l < low + third && u < low + third) || (l > high - third && u > high - third));
}

/* Below everything, or above it. */
static bool beside(const gn_world *w, int way, const reach *r) {
    return r->bodies && (r->high <= w->lower[way] || r->low >= w->upper[way]);
}

/* Bits of a face: the lower one, the upper one. */
enum { LOWER_FACE = 1, UPPER_FACE = 2 };

/* The faces across a direction that a part of an end is at: in the outer third, and as far out as
 * the outermost particles there, or beyond all of them. */
static int face_of(const gn_world *w, int way, const char *name) {
    const double low = w->lower[way], high = w->upper[way], third = (high - low) / 3.0,
                 slack = w->dem.particles.soa.count ? 2.0 * gn_world_mean_radius(w)
                                                    : 1e-6 * (high - low);
    reach r = nowhere;
    add_part(w, name, way, &r);
    if (!r.count) return 0;
    return (r.low <= low + slack && r.high < low + third ? LOWER_FACE : 0) |
           (r.high >= high - slack && r.low > high - third ? UPPER_FACE : 0);
}

/* All parts of both ends are at the same face: nothing is between them. */
static bool on_one_face(const gn_world *w, int way) {
    const gn_test_end *ends[] = {&w->scene.test.lower, &w->scene.test.upper};
    int faces = LOWER_FACE | UPPER_FACE;
    for (int e = 0; e < 2; e++)
        for (size_t k = 0; k < ends[e]->count; k++) faces &= face_of(w, way, ends[e]->name[k]);
    return faces != 0;
}

/* A test of compression or tension may be a beam that its ends bend across themselves, clamped here
 * and pushed there, or something that is pulled out of what it sits in: these are only refused
 * where they are upside down, at one face or press from one side alone. */
static const char *wrong(const gn_world *w, int way, const reach *lower, const reach *upper) {
    const gn_test_kind kind = w->scene.test.kind;
    const bool opposite =
        gn_test_in(kind, GN_TESTS_SHEARED | GN_TESTS_CONFINED | GN_TESTS(OEDOMETER) |
                             GN_TESTS(BRAZILIAN) | GN_TESTS(BENDING));
    if (kind == GN_TEST_BENDING && at_one_height(w, way, lower, upper) && gn_bending_outside(w))
        return "supports and load side by side along the beam";
    if (upper->high < lower->low) return "them the other way round";
    if (opposite && on_one_side(w, way, lower, upper)) return "both on one side of the specimen";
    if (on_one_face(w, way)) return "both at one face of the specimen";
    const bool pressed = gn_test_sign(kind) < 0 && beside(w, way, lower) && beside(w, way, upper);
    if (pressed && (middle(lower) > w->lower[way]) == (middle(upper) > w->lower[way]))
        return "both on one side of the specimen";
    return NULL;
}

/* Whether a wall beside the ends lies on the specimen and presses there, or stands. */
static bool wall_bears(const gn_world *w, size_t wall, double sense) {
    const gn_scene *s = &w->scene;
    const gn_wall_def *def = &s->walls[wall];
    const int way = (int)s->test.normal;
    const double face = sense < 0.0 ? w->upper[way] : w->lower[way];
    if (!(sense * def->normal[way] > 0.9)) return false;
    return def->servo.active || fabs(def->point[way] - face) < gn_world_mean_radius(w);
}

/* Of either end that nothing holds or presses; particles alone meet walls. */
static bool walls_bear(const gn_world *w) {
    bool below = gn_scene_end_has_normal_load(&w->scene, &w->scene.test.lower),
         above = gn_scene_end_has_normal_load(&w->scene, &w->scene.test.upper);
    for (size_t k = 0; w->dem.particles.soa.count && k < w->scene.wall_count; k++) {
        below = below || wall_bears(w, k, 1.0);
        above = above || wall_bears(w, k, -1.0);
    }
    return below && above;
}

bool gn_shear_is_loose(const gn_world *w, char *text, size_t size) {
    const gn_test *t = &w->scene.test;
    if (!gn_scene_shear_ends_may_separate(&w->scene) || walls_bear(w)) return false;
    snprintf(text, size,
             "%s: nothing presses the ends together along %c, and one of them is free there: the "
             "strength is that without a normal stress (a force of its set, a wall with a servo "
             "or, for a constant height, v%c: 0)",
             gn_scene_at(&w->scene, t->where, "test").text, "xyz"[t->normal], "xyz"[t->normal]);
    return true;
}

gneiss_status gn_ends_check(const gn_world *w, gneiss_error *error) {
    const gn_test *t = &w->scene.test;
    const int way = (int)(gn_test_in(t->kind, GN_TESTS_SHEARED) ? t->normal : t->axis);
    if (t->kind == GN_TEST_NONE || t->kind == GN_TEST_HYDROSTATIC) return GNEISS_OK;
    for (size_t k = 0; k < t->lower.count; k++)
        for (size_t m = 0; m < t->upper.count; m++)
            GN_TRY(check_shared(w, t->lower.name[k], t->upper.name[m], error));
    const reach lower = reach_of(w, &t->lower, way), upper = reach_of(w, &t->upper, way);
    if (!lower.count || !upper.count) return GNEISS_OK;
    const char *what = wrong(w, way, &lower, &upper);
    return what ? fail(w, way, &lower, &upper, what, error) : GNEISS_OK;
}
