/* Paths in one step. A particle and the object that it touches may each move by half the smallest
 * radius: the two then approach by at most a radius, and neither passes the other before the
 * contact acts. An automatic step is lowered for bodies in every step, because springs do not limit
 * it where nothing is near, and falling or driven bodies gain speed between two constructions of
 * the lists. Driven bodies are checked with the velocities of their tables, free ones with at most
 * twice the gain of speed of the last step or of free fall. */
#include "base/error.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/overlap.h"
#include "frame/frame.h"
#include "kernels/motion.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/values.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"

#include <math.h>

static const char advice[] = "a smaller time.step or a slower motion can be followed";

static double length(const double v[3]) {
    return sqrt(gn_dot3(v, v));
}

/* --- particles --- */

/* Names a body that contains the centres of particles: it was pushed over particles that it could
 * not push aside, and they leave it with the energy of that overlap. */
static void describe_pierced(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, char *text, size_t size) {
    for (size_t b = 0; b < ctx->scene.body_count && !*text; b++) {
        size_t count = 0, first;
        if (gn_body_holds(dem, boundary, b, &count, &first, NULL) != GNEISS_OK || !count) continue;
        snprintf(
            text, size,
            "; body '%.40s' was pushed over the centre%s of %zu particle%s, which its contacts "
            "cannot push aside: its stiffness must be higher%s",
            ctx->scene.bodies[b].name, count == 1 ? "" : "s", count, count == 1 ? "" : "s",
            ctx->effects & GN_FX_BONDS ? ", or bonds that hold the particles weaker" : "");
    }
}

static gneiss_status fail_particle(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, size_t p, const char *what,
                                   const char *remedy, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
    char at[GN_POINT_SIZE], behind[GN_NAME_SIZE + 256] = "";
    gn_ranks_whole(ctx->ranks);
    for (size_t k = 0; k < ctx->scene.wall_count && !*behind; k++)
        if (!ctx->scene.walls[k].passive && gn_wall_distance(&boundary->walls[k], x) < 0.0)
            snprintf(behind, sizeof behind,
                     "; its centre is behind wall '%s', which pushes it out (gneiss check says how "
                     "many are)",
                     ctx->scene.walls[k].name);
    if (!*behind) describe_pierced(ctx, dem, boundary, behind, sizeof behind);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: particle %d %s: position %s m, velocity (%g, %g, %g) m/s, radius %g "
        "m; the step is %.3g s, its stability limit was estimated as %.3g s%s%s",
        (long long)ctx->step, ctx->time, q->id[p], what, gn_point_text(ctx->scene.origin, x, at),
        v[0], v[1], v[2], x[3], ctx->dt, ctx->stable, behind, *behind ? "" : remedy);
}

/* Returns the row of four whose vector is the longest. */
static size_t largest(const double *rows, size_t count) {
    size_t worst = 0;
    double most = -1.0;
    for (size_t p = 0; p < count; p++) {
        double size2 = gn_dot3(rows + 4 * p, rows + 4 * p);
        if (size2 > most) {
            most = size2;
            worst = p;
        }
    }
    return worst;
}

static gneiss_status check_motion(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, gneiss_error *error) {
    const gn_motion_sums *m = &dem->done.motion;
    if (m->bad >= 0)
        return fail_particle(ctx, dem, boundary, (size_t)m->bad,
                             "has a velocity that is not finite", "", error);
    double path = ctx->dt * sqrt(m->speed2);
    if (path <= 0.5 * dem->radius_min) return GNEISS_OK;
    gn_ranks_whole(ctx->ranks);
    size_t worst = largest(dem->particles.vel, dem->particles.soa.count);
    char remedy[sizeof advice + 2];
    snprintf(remedy, sizeof remedy, "; %s", advice);
    return fail_particle(ctx, dem, boundary, worst,
                         "moved farther in one step than half the smallest radius", remedy, error);
}

/* Checks in measured steps that no particle rotated by more than half a radian. */
static gneiss_status check_spins(const gn_step_context *ctx, const gn_dem *dem,
                                 gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    if (ctx->dt * sqrt(dem->done.motion.spin2) <= 0.5) return GNEISS_OK;
    gn_ranks_whole(ctx->ranks);
    size_t worst = largest(q->spin, q->soa.count);
    const double *o = q->spin + 4 * worst, *x = q->pos + 4 * worst;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: particle %d turned in one step by more than half a radian: "
        "position (%g, %g, %g) m, spin (%g, %g, %g) rad/s; the step is %.3g s, its "
        "stability limit was estimated as %.3g s; %s",
        (long long)ctx->step, ctx->time, q->id[worst], x[0], x[1], x[2], o[0], o[1], o[2], ctx->dt,
        ctx->stable, advice);
}

gneiss_status gn_timestep_check_particle_paths(const gn_step_context *ctx, const gn_dem *dem,
                                               const gn_boundary *boundary, bool measure,
                                               gneiss_error *error) {
    GN_TRY(check_motion(ctx, dem, boundary, error));
    return measure ? check_spins(ctx, dem, error) : GNEISS_OK;
}

/* --- surfaces and walls --- */

/* Checks the path of the farthest vertex of a body; a path that is NaN fails the comparison. */
static gneiss_status check_body(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k, gneiss_error *error) {
    const gn_rigid *b = &boundary->bodies[k];
    const double *v = b->velocity, *o = b->spin;
    double path = ctx->dt * (length(v) + length(o) * b->reach);
    if (path <= 0.5 * dem->radius_min) return GNEISS_OK;
    bool finite = isfinite(v[0] + v[1] + v[2]) && isfinite(o[0] + o[1] + o[2]);
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "step %lld, t = %g s: body '%s' %s: velocity (%g, %g, %g) m/s, spin (%g, %g, "
                   "%g) rad/s, farthest vertex %g m from its reference point, smallest radius %g "
                   "m; the step is %.3g s, its stability limit was estimated as %.3g s; %s",
                   (long long)ctx->step, ctx->time, ctx->scene.bodies[k].name,
                   finite ? "moved farther in one step than half the smallest radius"
                          : "has a velocity that is not finite",
                   v[0], v[1], v[2], o[0], o[1], o[2], b->reach, dem->radius_min, ctx->dt,
                   ctx->stable, advice);
}

/* Checks the path of a wall. A plane that moves within itself does not come closer to any particle,
 * and one that moves away from all particles passes none. */
static gneiss_status check_wall(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k, gneiss_error *error) {
    const gn_wall *wall = &boundary->walls[k];
    double along = gn_dot3(wall->velocity, wall->normal);
    if (ctx->dt * along <= 0.5 * dem->radius_min) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: wall '%s' moved farther in one step than half the smallest "
        "radius: %g m/s along its normal, smallest radius %g m; the step is %.3g s; %s",
        (long long)ctx->step, ctx->time, ctx->scene.walls[k].name, along, dem->radius_min, ctx->dt,
        ctx->scene.walls[k].servo.active ? "servo.max_velocity bounds it" : advice);
}

gneiss_status gn_timestep_check_boundary_paths(const gn_step_context *ctx, const gn_dem *dem,
                                               const gn_boundary *boundary, gneiss_error *error) {
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        GN_TRY(check_body(ctx, dem, boundary, k, error));
    for (size_t k = 0; k < ctx->scene.wall_count; k++)
        GN_TRY(check_wall(ctx, dem, boundary, k, error));
    return GNEISS_OK;
}

gneiss_status gn_timestep_check_element_paths(const gn_step_context *ctx, const gn_dem *dem,
                                              const gn_solids *solids, gneiss_error *error) {
    double most = 0.0;
    for (size_t k = 0; k < solids->count; k++)
        most = fmax(most, gn_element_contact_speed(solids->elements[k]));
    if (!(most > 0.0) || ctx->dt * most <= 0.5 * dem->radius_min) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "step %lld, t = %g s: elements: a node moved farther in one step than half the "
                   "smallest radius: %g m/s, smallest radius %g m; the step is %.3g s; %s",
                   (long long)ctx->step, ctx->time, most, dem->radius_min, ctx->dt, advice);
}

/* Largest path of a vertex over the smallest radius, and largest rotation, rad. If the step exceeds
 * one of them, it is lowered to half of it, so that it is not lowered again soon. */
static const double path_most = 0.25, turn_most = 0.25;
/* Largest path, over the smallest radius, of a body with particles near it. A corner that passes a
 * pressed particle rotates the normal by this much in a step, and the works of the step miss a
 * share of the contact's energy that grows with its square: a gate that left grains at a quarter of
 * a radius per step lost 20 %, at 0.06 1.4 %, at 0.03 0.3 %. */
static const double path_near = 0.05;

/* Returns the largest magnitude of a table's values. */
static double largest_value(const gn_table *t) {
    double most = 0.0;
    for (size_t k = 0; k < t->count; k++) most = fmax(most, fabs(t->value[k]));
    return most;
}

static double change(const double now[3], const double past[3]) {
    const double d[3] = {now[0] - past[0], now[1] - past[1], now[2] - past[2]};
    return length(d);
}

/* rad: largest rotation per step of a body that is held about some axes and free about others. With
 * two free axes, or with axes that rotate, a step is of second order in the rotation (rotate_held
 * of bodies.c), which leaves an error of 6e-4 rad after ten turns (largest of four bodies); with
 * one free axis it is exact. */
static const double turn_held = 0.01;

static double largest_turn(const gn_step_context *ctx, const gn_boundary *boundary, size_t k) {
    const gn_rigid *b = &boundary->bodies[k];
    double axes = 0.0, led = 0.0;
    for (int a = 0; a < 3; a++) {
        axes += b->held[a];
        if (b->held[a] > 0.0) led = fmax(led, largest_value(&ctx->scene.bodies[k].motion.spin[a]));
    }
    return axes == 1.0 || (axes == 2.0 && led > 0.0) ? turn_held : turn_most;
}

/* Returns the acceleration of a free body by gravity and its applied force, m/s2. */
static double dead_load(const gn_step_context *ctx, size_t k, const gn_rigid *b) {
    return length(ctx->scene.gravity) + length(ctx->scene.bodies[k].force) / b->mass;
}

/* Computes speed (m/s) and spin (rad/s) of a body in a coming step of `dt`. */
static void speeds_in(const gn_step_context *ctx, const gn_boundary *boundary, size_t k, double dt,
                      double *speed, double *spin) {
    const gn_rigid *b = &boundary->bodies[k];
    const gn_motion *m = &ctx->scene.bodies[k].motion;
    double v[3], turn[3], middle = ctx->time + 0.5 * dt;
    bool falls = false, turns = false;
    for (int a = 0; a < 3; a++) {
        const gn_table *t = &m->velocity[a], *s = &m->spin[a];
        double factor = gn_control_of(ctx, ctx->scene.bodies[k].name, a);
        v[a] = t->count ? factor * gn_table_at(t, middle) : b->velocity[a];
        turn[a] = s->count ? gn_table_at(s, middle) : b->spin[a];
        falls = falls || b->inverse_mass[a] > 0.0;
        turns = turns || b->inverse_inertia[a] > 0.0;
    }
    *speed = length(v);
    *spin = length(turn);
    double gain = ctx->dt_past > 0.0 ? 2.0 * change(b->velocity, b->velocity_past) : 0.0;
    if (falls) *speed += fmax(gain, dt * dead_load(ctx, k, &boundary->bodies[k]));
    if (turns && ctx->dt_past > 0.0) *spin += 2.0 * change(b->spin, b->spin_past);
}

/* Tells whether the lists hold a particle that is near a body. */
static bool has_particles(const gn_step_context *ctx, const gn_boundary *boundary, size_t body) {
    const gn_wall_contacts *q = &boundary->contacts;
    const gn_surface *s = &boundary->surfaces[body];
    const int32_t begin = (int32_t)ctx->scene.wall_count + s->first;
    const int32_t end = begin + (int32_t)s->facets.count;
    for (size_t c = 0; c < q->soa.count; c++)
        if (q->wall[c] >= begin && q->wall[c] < end) return true;
    return false;
}

/* Returns the path, m, that is allowed to a body which would move by `path` in a step. */
static double path_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      size_t body, double path) {
    const double radius = dem->radius_min;
    if (path <= path_near * radius) return path;
    return (has_particles(ctx, boundary, body) ? path_near : path_most) * radius;
}

void gn_bodies_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      double *dt) {
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const double turn = largest_turn(ctx, boundary, k);
        /* A table may have a larger value at the middle of a shorter step, so that the step is
         * lowered repeatedly. */
        for (bool far = true; far;) {
            double speed, spin;
            speeds_in(ctx, boundary, k, *dt, &speed, &spin);
            speed += spin * boundary->bodies[k].reach;
            const double most = path_of(ctx, dem, boundary, k, *dt * speed);
            far = *dt * speed > most || *dt * spin > turn;
            if (far) *dt = 0.5 * fmin(most / speed, spin > 0.0 ? turn / spin : INFINITY);
        }
    }
}

/* Tells whether a particle overlaps a wall, or did so before the last step, in which case its
 * contact acts once more. */
static bool is_pressed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       size_t wall) {
    const gn_wall_contacts *q = &boundary->contacts;
    const gn_wall *of = &boundary->walls[wall];
    gn_ranks_whole(ctx->ranks);
    for (size_t c = 0; c < q->soa.count; c++) {
        if ((size_t)q->wall[c] != wall) continue;
        const double *x = dem->particles.pos + 4 * (int64_t)q->i[c],
                     *v = dem->particles.vel + 4 * (int64_t)q->i[c];
        const double gap = gn_wall_distance(of, x) - x[3] - q->gap0[c];
        const double apart = gn_dot3(v, of->normal) - gn_dot3(of->velocity, of->normal);
        if (gap < fmax(0.0, ctx->dt_past * apart) - GN_OVERLAP_ROUNDING * x[3]) return true;
    }
    return false;
}

/* Returns the speed, m/s, of a wall along its normal in a coming step of `dt`. */
static double wall_speed_in(const gn_step_context *ctx, const gn_boundary *boundary, size_t k,
                            double dt) {
    const gn_wall *wall = &boundary->walls[k];
    const gn_wall_def *def = &ctx->scene.walls[k];
    double along = 0.0;
    for (int a = 0; a < 3; a++) {
        const gn_table *t = &def->motion.velocity[a];
        const double led = gn_control_of(ctx, def->name, a) * gn_table_at(t, ctx->time + 0.5 * dt);
        along += wall->normal[a] * (t->count ? led : wall->velocity[a]);
    }
    return along;
}

void gn_walls_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     double *dt) {
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        for (bool far = true; far;) {
            const double speed = -wall_speed_in(ctx, boundary, k, *dt),
                         most = path_near * dem->radius_min;
            far = speed * *dt > most && is_pressed(ctx, dem, boundary, k);
            if (far) *dt = 0.5 * most / speed;
        }
    }
}

/* Returns the larger root of fall t^2 + speed t = way, s. */
static double time_for(double way, double speed, double fall) {
    double root = speed + sqrt(speed * speed + 4.0 * fall * way);
    return root > 0.0 ? 2.0 * way / root : (double)INFINITY;
}

double gn_bodies_step(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary) {
    double step = INFINITY;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_rigid *b = &boundary->bodies[k];
        const gn_motion *m = &ctx->scene.bodies[k].motion;
        double v[3], turn[3], fall = 0.0;
        for (int a = 0; a < 3; a++) {
            const gn_table *t = &m->velocity[a], *s = &m->spin[a];
            v[a] = t->count ? largest_value(t) : b->velocity[a];
            turn[a] = s->count ? largest_value(s) : b->spin[a];
            if (b->inverse_mass[a] > 0.0) fall = dead_load(ctx, k, b);
        }
        double spin = length(turn), speed = length(v) + spin * b->reach;
        step = fmin(step, time_for(0.5 * path_most * dem->radius_min, speed, fall));
        if (spin > 0.0) step = fmin(step, 0.5 * largest_turn(ctx, boundary, k) / spin);
    }
    /* The rest of the run has at least a hundred steps. */
    return isfinite(step) ? fmin(step, 0.01 * (ctx->scene.end - ctx->time)) : step;
}

/* m/s; the bound GN_SPEEDS of scenes. */
static const double light = 3e8;

static gneiss_status check_speed(const gn_step_context *ctx, const gn_boundary *boundary, size_t k,
                                 double spin, const char *of, gneiss_error *error) {
    const double reach = boundary->bodies[k].reach;
    char key[64];
    if (spin * reach <= light) return GNEISS_OK;
    snprintf(key, sizeof key, "bodies[%zu].%s", k, of);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected at most %.4g rad/s, with which the farthest vertex, %.4g m from "
                   "the point about which the body turns, goes at %g m/s; found %.4g rad/s",
                   gn_scene_at(&ctx->scene, ctx->scene.bodies[k].where, key).text, light / reach,
                   reach, light, spin);
}

gneiss_status gn_bodies_check_speeds(const gn_step_context *ctx, const gn_boundary *boundary,
                                     gneiss_error *error) {
    static const char *const channel[] = {"motion.wx", "motion.wy", "motion.wz"};
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_body_def *def = &ctx->scene.bodies[k];
        if (def->has_initial_spin)
            GN_TRY(check_speed(ctx, boundary, k, length(def->initial_spin), "initial_spin", error));
        for (int a = 0; a < 3; a++)
            GN_TRY(check_speed(ctx, boundary, k, largest_value(&def->motion.spin[a]), channel[a],
                               error));
    }
    return GNEISS_OK;
}
