/* How far things move in one step. Particles and what they touch may each move half the smallest
 * radius: then the two have come closer by at most a radius, and neither is behind the other before
 * it was seen to press. */
#include "base/error.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/surface.h"
#include "frame/step_context.h"
#include "kernels/motion.h"
#include "particles/dem.h"
#include "scene/values.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "timestep/body_paths.h"

#include <math.h>

static const char advice[] = "a smaller time.step or a slower motion can be followed";

static double speed(const double v[3]) {
    return sqrt(gn_dot3(v, v));
}

/* --- particles --- */

static gneiss_status fail_particle(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, size_t p, const char *what,
                                   const char *remedy, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const double *x = q->pos + 4 * p, *v = q->vel + 4 * p;
    char at[GN_POINT_SIZE], behind[GN_NAME_SIZE + 128] = "";
    for (size_t k = 0; k < ctx->scene.wall_count && !*behind; k++)
        if (!ctx->scene.walls[k].passive && gn_wall_distance(&boundary->walls[k], x) < 0.0)
            snprintf(behind, sizeof behind,
                     "; its centre is behind wall '%s', which pushes it out (gneiss check says how "
                     "many are)",
                     ctx->scene.walls[k].name);
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: particle %d %s: position %s m, velocity (%g, %g, %g) m/s, radius %g "
        "m; the step is %.3g s, its stability limit was estimated as %.3g s%s%s",
        (long long)ctx->step, ctx->time, q->id[p], what, gn_point_text(ctx->scene.origin, x, at),
        v[0], v[1], v[2], x[3], ctx->dt, ctx->stable, behind, remedy);
}

/* The particle with the largest of vectors in rows of four. */
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
    size_t worst = largest(dem->particles.vel, dem->particles.soa.count);
    char remedy[sizeof advice + 2];
    snprintf(remedy, sizeof remedy, "; %s", advice);
    return fail_particle(ctx, dem, boundary, worst,
                         "moved farther in one step than half the smallest radius", remedy, error);
}

/* That the surface of no particle turned farther than half its radius, in measured steps. */
static gneiss_status check_spins(const gn_step_context *ctx, const gn_dem *dem,
                                 gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    if (ctx->dt * sqrt(dem->done.motion.spin2) <= 0.5) return GNEISS_OK;
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

gneiss_status gn_dem_check(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, bool measure, gneiss_error *error) {
    GN_TRY(check_motion(ctx, dem, boundary, error));
    return measure ? check_spins(ctx, dem, error) : GNEISS_OK;
}

/* --- what they touch --- */

/* Of the farthest vertex. Written so that a path that is not a number is none that may pass. */
static gneiss_status check_body(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k, gneiss_error *error) {
    const gn_rigid *b = &boundary->bodies[k];
    const double *v = b->velocity, *o = b->spin;
    double path = ctx->dt * (speed(v) + speed(o) * b->reach);
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

/* A plane that moves along itself stays where it is, and what moves away from all particles is
 * behind none of them. */
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

gneiss_status gn_boundary_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, gneiss_error *error) {
    for (size_t k = 0; k < ctx->scene.body_count; k++)
        GN_TRY(check_body(ctx, dem, boundary, k, error));
    for (size_t k = 0; k < ctx->scene.wall_count; k++)
        GN_TRY(check_wall(ctx, dem, boundary, k, error));
    return GNEISS_OK;
}

gneiss_status gn_elements_check(const gn_step_context *ctx, const gn_dem *dem,
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
