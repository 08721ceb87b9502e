/* The two ends of a test: their forces, their displacements, their first contact with the specimen,
 * and the control of their motion. An end may have several parts (two supports under a beam):
 * forces are summed, displacements averaged. */
#include "laboratory/ends.h"
#include "base/memory.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "laboratory/laboratory.h"
#include "laboratory/strain_gauge.h"
#include "measure/measure.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "solids/solids.h"

#include <math.h>
#include <string.h>

/* Returns the displacement of a part since the start along the axis. */
static double part_travel(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids, const char *name,
                          int axis) {
    const gn_scene *s = &ctx->scene;
    int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
        motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) return boundary->walls[wall].point[axis] - boundary->walls[wall].start[axis];
    if (body >= 0)
        return boundary->bodies[body].position[axis] - boundary->bodies[body].start[axis];
    if (motion < 0)
        return gn_set_travel(ctx, dem, solids, (size_t)gn_scene_find_set(s, name), axis);
    double travel[3];
    gn_elements_travel(solids, (size_t)motion, travel);
    return travel[axis];
}

static double end_travel(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_solids *solids, const gn_test_end *end, int axis) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++)
        sum += part_travel(ctx, dem, boundary, solids, end->name[k], axis);
    return sum / (double)end->count;
}

/* Tells whether a part only presses: a wall along the sheared plane that does not move along it,
 * such as a lid with a servo, does not count for the shear displacement. */
static bool only_presses(const gn_step_context *ctx, const char *name, int axis) {
    const int wall = gn_scene_find_wall(&ctx->scene, name);
    if (wall < 0 || !gn_scene_test(&ctx->scene)->sheared) return false;
    const gn_wall_def *def = &ctx->scene.walls[wall];
    return !def->motion.velocity[axis].count && fabs(def->normal[axis]) < 0.1;
}

/* Returns the displacement of an end of the test along its axis: the mean over the parts that do
 * not only press, or over all parts if every part only presses. */
static double loaded_travel(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            const gn_test_end *end) {
    const int axis = (int)ctx->scene.test.axis;
    double sum = 0.0, count = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        if (only_presses(ctx, end->name[k], axis)) continue;
        sum += part_travel(ctx, dem, boundary, solids, end->name[k], axis);
        count += 1.0;
    }
    return count > 0.0 ? sum / count : end_travel(ctx, dem, boundary, solids, end, axis);
}

/* Returns the force with which a part loads the specimen along the axis. */
static double part_force(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_solids *solids, const char *name, int axis) {
    const gn_scene *s = &ctx->scene;
    int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
        motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) return -boundary->walls[wall].force[axis];
    if (body >= 0) return -boundary->bodies[body].force[axis];
    if (motion >= 0) {
        double force[3];
        gn_elements_reaction(solids, (size_t)motion, force);
        return force[axis];
    }
    int set = gn_scene_find_set(s, name);
    if (s->sets[set].motion.velocity[axis].count) return dem->set_reaction[6 * set + axis];
    return s->sets[set].has_force ? s->sets[set].force[axis] : 0.0;
}

static double end_force(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, const gn_test_end *end, int axis) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++)
        sum += part_force(ctx, dem, boundary, solids, end->name[k], axis);
    return sum;
}

static double test_sign(const gn_step_context *ctx) {
    return gn_scene_test(&ctx->scene)->sign;
}

double gn_ends_deflection(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    return test_sign(ctx) * (loaded_travel(ctx, dem, boundary, solids, &t->upper) -
                             loaded_travel(ctx, dem, boundary, solids, &t->lower));
}

double gn_ends_opening(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids) {
    const gn_opening *o = &ctx->scene.test.opening;
    int axis = (int)o->axis;
    return end_travel(ctx, dem, boundary, solids, &o->upper, axis) -
           end_travel(ctx, dem, boundary, solids, &o->lower, axis);
}

void gn_ends_forces(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    const gn_solids *solids, double *lower, double *upper) {
    double sign = test_sign(ctx);
    const gn_test *t = &ctx->scene.test;
    *lower = -sign * end_force(ctx, dem, boundary, solids, &t->lower, (int)t->axis);
    *upper = sign * end_force(ctx, dem, boundary, solids, &t->upper, (int)t->axis);
    if (!gn_scene_end_drives(&ctx->scene, &ctx->scene.test.lower)) *lower = *upper;
    if (!gn_scene_end_drives(&ctx->scene, &ctx->scene.test.upper)) *upper = *lower;
}

/* Tells whether a part can carry a load along an axis. */
static bool acts_along(const gn_scene *s, const char *name, int axis) {
    int set = gn_scene_find_set(s, name);
    if (gn_scene_find_wall(s, name) >= 0 || gn_scene_find_body(s, name) >= 0 || set < 0)
        return true;
    return s->sets[set].motion.velocity[axis].count || s->sets[set].has_force;
}

static bool end_acts_along(const gn_step_context *ctx, const gn_test_end *end, int axis) {
    bool acts = false;
    for (size_t k = 0; k < end->count; k++) acts |= acts_along(&ctx->scene, end->name[k], axis);
    return acts;
}

void gn_ends_normals(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, double *lower, double *upper) {
    const gn_test *t = &ctx->scene.test;
    const int normal = (int)t->normal;
    *lower = end_force(ctx, dem, boundary, solids, &t->lower, normal);
    *upper = -end_force(ctx, dem, boundary, solids, &t->upper, normal);
    if (!end_acts_along(ctx, &t->lower, normal)) *lower = *upper;
    if (!end_acts_along(ctx, &t->upper, normal)) *upper = *lower;
}

double gn_ends_dilation(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    int normal = (int)t->normal;
    return end_travel(ctx, dem, boundary, solids, &t->upper, normal) -
           end_travel(ctx, dem, boundary, solids, &t->lower, normal);
}

/* Returns the position farthest in the direction `sense` (+1, -1) along the normal, times `sense`;
 * -infinity: it is not known yet. */
static double body_reach(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                         double sense) {
    const int normal = (int)ctx->scene.test.normal;
    double reach = -INFINITY;
    size_t first = 0;
    if (!boundary->body_vertex) return reach;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++)
        reach = fmax(reach, sense * (boundary->bodies[body].start[normal] +
                                     boundary->body_vertex[4 * n + (size_t)normal]));
    return reach;
}

static double set_reach(const gn_step_context *ctx, const gn_dem *dem, size_t set, double sense) {
    const gn_particles *q = &dem->particles;
    double reach = -INFINITY;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_set_selected(ctx, dem, set, p))
            reach = fmax(reach, sense * q->start[4 * p + (size_t)ctx->scene.test.normal]);
    return reach;
}

static double motion_reach(const gn_step_context *ctx, const gn_solids *solids, size_t motion,
                           double sense) {
    double reach = -INFINITY;
    const gn_particles *nodes;
    if (ctx->scene.has_specimen) return reach; /* the particles are the sheared specimen */
    const gn_fem_set *set = gn_elements_motion_set(solids, motion, &nodes);
    for (size_t k = 0; k < set->count; k++)
        reach = fmax(
            reach, sense * nodes->start[4 * (size_t)set->node[k] + (size_t)ctx->scene.test.normal]);
    return reach;
}

static double end_reach(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, const gn_test_end *end, double sense) {
    const gn_scene *s = &ctx->scene;
    double reach = -INFINITY;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(s, end->name[k]),
                  set = gn_scene_find_set(s, end->name[k]),
                  body = gn_scene_find_body(s, end->name[k]),
                  motion = gn_scene_find_element_motion(s, end->name[k]);
        if (wall >= 0) reach = fmax(reach, sense * s->walls[wall].point[s->test.normal]);
        if (set >= 0) reach = fmax(reach, set_reach(ctx, dem, (size_t)set, sense));
        if (body >= 0) reach = fmax(reach, body_reach(ctx, boundary, (size_t)body, sense));
        if (motion >= 0) reach = fmax(reach, motion_reach(ctx, solids, (size_t)motion, sense));
    }
    return reach;
}

double gn_ends_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    return -end_reach(ctx, dem, boundary, solids, &t->upper, -1.0) -
           end_reach(ctx, dem, boundary, solids, &t->lower, 1.0);
}

double gn_ends_free(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    const gn_solids *solids) {
    const int normal = (int)ctx->scene.test.normal;
    const double height = gn_tested_side(ctx, solids, normal),
                 gap = gn_ends_gap(ctx, dem, boundary, solids),
                 least = dem->particles.soa.count ? 2.0 * gn_dem_mean_radius(dem) : 0.0;
    return gap > least && gap < height ? gap : height;
}

/* --- ends that start away from the specimen, whose approach is no strain --- */

/* Distance at which an end counts as touching, as a fraction of a mean radius (without particles:
 * of the length). */
static const double touching = 1e-3, touching_elements = 1e-6;

/* Returns the gap, m, from the specimen to a wall across the axis. `sense` +1: the lower end. */
static double wall_gap(const gn_step_context *ctx, const gn_wall_def *wall, double sense,
                       double surface) {
    const int axis = (int)ctx->scene.test.axis;
    return sense * wall->normal[axis] > 0.99 ? sense * (surface - wall->point[axis]) : 0.0;
}

/* Returns the gap, m, to the plane across the axis that touches a body, which is never above the
 * gap to the body. */
static double body_gap(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                       double sense, double surface) {
    const int axis = (int)ctx->scene.test.axis;
    size_t first = 0;
    double gap = INFINITY;
    if (!boundary->body_vertex) return 0.0;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&boundary->bodies[body], boundary->body_vertex + 4 * n, corner);
        gap = fmin(gap, sense * (surface - corner[axis]));
    }
    return gap;
}

/* Returns the smallest gap of all parts; sets and motions are in the specimen. */
static double end_gap(const gn_step_context *ctx, const gn_boundary *boundary,
                      const gn_solids *solids, const gn_test_end *end, double sense) {
    const gn_scene *s = &ctx->scene;
    double lower[3], upper[3], gap = INFINITY;
    gn_tested_extent(ctx, solids, lower, upper);
    const double surface = sense > 0.0 ? lower[s->test.axis] : upper[s->test.axis];
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(s, end->name[k]),
                  body = gn_scene_find_body(s, end->name[k]);
        double part = 0.0;
        if (wall >= 0) part = wall_gap(ctx, &s->walls[wall], sense, surface);
        if (body >= 0) part = body_gap(ctx, boundary, (size_t)body, sense, surface);
        gap = fmin(gap, part);
    }
    if (gap > 0.0 && s->has_specimen && !s->specimen_given)
        return INFINITY; /* particles flow in later */
    return gap;
}

/* Returns the largest gap, m, that counts as contact. Loose grains fill the space between their
 * walls: their gap to the nearest wall is about that to each other. */
static double allowed_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids) {
    const double count = (double)dem->particles.soa.count, d = (double)ctx->scene.dimension;
    if (!(count > 0.0))
        return touching_elements * gn_tested_side(ctx, solids, (int)ctx->scene.test.axis);
    if (ctx->effects & GN_FX_BONDS) return touching * gn_dem_mean_radius(dem);
    return pow(ctx->volume / count, 1.0 / d);
}

void gn_ends_gaps(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                  const gn_solids *solids, double *lower, double *upper, bool away[2]) {
    const gn_test *t = &ctx->scene.test;
    *lower = *upper = 0.0;
    away[0] = away[1] = false;
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    if (!d->ends || d->sign > 0) return;
    const double allowed = allowed_gap(ctx, dem, solids);
    *lower = fmax(0.0, end_gap(ctx, boundary, solids, &t->lower, 1.0));
    *upper = fmax(0.0, end_gap(ctx, boundary, solids, &t->upper, -1.0));
    away[0] = *lower > allowed;
    away[1] = *upper > allowed;
}

void gn_ends_begin(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids, gn_approach *approach) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(ctx, dem, boundary, solids, &lower, &upper, away);
    *approach = (gn_approach){.away = {away[0], away[1]},
                              .gap = (away[0] ? lower : 0.0) + (away[1] ? upper : 0.0)};
}

void gn_ends_note_contact(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          gn_solids *solids, gn_approach *approach, bool still) {
    gn_approach *a = approach;
    double lower, upper;
    if (a->away[0] == 0.0 && a->away[1] == 0.0) return;
    gn_ends_forces(ctx, dem, boundary, solids, &lower, &upper);
    /* Both ends must touch in one step, because a specimen that one end pushes moves towards the
     * other. */
    if ((a->away[0] != 0.0 && lower == 0.0) || (a->away[1] != 0.0 && upper == 0.0)) return;
    a->away[0] = a->away[1] = 0.0;
    gn_ranks_whole(ctx->ranks);
    a->way = gn_ends_deflection(ctx, dem, boundary, solids);
    if (still) a->way = fmin(a->way, a->gap);
}

double gn_ends_shortening(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids,
                          const gn_approach *approach) {
    const gn_approach *a = approach;
    return a->away[0] != 0.0 || a->away[1] != 0.0
               ? 0.0
               : gn_ends_deflection(ctx, dem, boundary, solids) - a->way;
}

/* Number of steps between two readings. */
enum { LOOK_INTERVAL = 10 };

/* Returns the strain across the axis, extension positive. */
static double lateral_strain(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             const gn_gauge *gauge) {
    double gradient[9], g[9], sum = 0.0;
    int dimension = (int)ctx->scene.dimension;
    gn_gauge_gradient(ctx, dem, solids, gauge, gradient);
    gn_strain_of(gradient, g);
    for (int a = 0; a < dimension; a++)
        if (a != (int)ctx->scene.test.axis) sum += g[4 * a];
    return sum / (dimension - 1);
}

static double reading(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids, const gn_gauge *gauge) {
    return ctx->scene.test.control.opening > 0.0 ? gn_ends_opening(ctx, dem, boundary, solids)
                                                 : lateral_strain(ctx, dem, solids, gauge);
}

static double rate(const gn_control *c) {
    return c->opening > 0.0 ? c->opening : c->lateral_strain;
}

/* The control starts at full speed: both readings begin at 0. */
void gn_control_create(gn_step_context *ctx) {
    const gn_control *c = &ctx->scene.test.control;
    ctx->machine = (gn_machine){.wanted = rate(c) * c->response, .factor = 1.0};
}

/* The target grows at the given rate, but is never ahead of the reading by more than the motion
 * makes up at full speed, so that a reading that lags during elastic loading leaves no backlog for
 * the moment of failure. The factor is the ratio of the distance from the target to this largest
 * distance: it is 1 while the reading lags, decreases as the reading approaches, and is bounded on
 * both sides for any reading. */
void gn_control_update(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, gn_solids *solids,
                       gn_gauge *gauge) {
    const gn_control *c = &ctx->scene.test.control;
    gn_machine *m = &ctx->machine;
    if (!ctx->scene.test.has_control || ctx->step % LOOK_INTERVAL != 0) return;
    gn_ranks_whole(ctx->ranks);
    const double now = reading(ctx, dem, boundary, solids, gauge), most = rate(c) * c->response;
    if (isnan(now)) return; /* too little of the specimen is left for a reading */
    m->wanted = fmin(m->wanted + rate(c) * (ctx->time - m->looked), now + most);
    m->looked = ctx->time;
    m->factor = fmax(-c->reverse, fmin(1.0, (m->wanted - now) / most));
}

/* Tells whether a particle counts for the displacement of a set: if the set prescribes the
 * velocity, the particles whose velocity it prescribes, else all that were selected at the start.
 */
static bool travels(const gn_step_context *ctx, const gn_dem *dem, size_t set, int axis, size_t p) {
    const gn_particles *q = &dem->particles;
    const gn_set_def *s = &ctx->scene.sets[set];
    if (s->motion.velocity[axis].count == 0) return gn_set_selected(ctx, dem, set, p);
    int32_t slot = q->slot[p];
    return slot >= 0 && dem->channel_set[6 * slot + axis] == (int32_t)set;
}

double gn_set_travel(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     size_t set, int axis) {
    const gn_set_def *s = &ctx->scene.sets[set];
    int32_t *places = gn_element_places(ctx, solids);
    double sum = 0.0;
    size_t count = 0, all = s->id_count ? s->id_count : (size_t)dem->made;
    for (size_t k = 0; k < all; k++) {
        int32_t place = dem->index_of_id[s->id_count ? (size_t)s->ids[k] : k];
        size_t p = (size_t)place;
        if (place < 0 || !travels(ctx, dem, set, axis, p)) continue;
        double u[3];
        gn_particle_travel(dem, solids, places, p, u);
        sum += u[axis];
        count++;
    }
    gn_free(places);
    return count ? sum / (double)count : 0.0;
}
