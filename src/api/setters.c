/* Public API: velocities, motions and ends of stages that a program sets between two steps. */
#include "api/handles.h"
#include "particles/velocities.h"
#include "run/stages.h"

#include <math.h>
#include <string.h>

static const double most_speed = 3e8; /* m/s, rad/s */

static gneiss_status check_rows(const double *rows, size_t count, const char *what,
                                gneiss_error *error) {
    for (size_t k = 0; rows && k < 3 * count; k++)
        if (!(fabs(rows[k]) <= most_speed))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "argument %s: expected finite numbers up to %g, found %g in row %zu",
                           what, most_speed, rows[k], k / 3);
    return GNEISS_OK;
}

gneiss_status gneiss_world_set_velocities(gneiss_world *world, const double *velocity,
                                          const double *spin, size_t count, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    GN_TRY(gn_api_require(velocity, "velocity", error));
    gn_world *w = &world->run.world;
    if (count != w->dem.particles.soa.count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument count: expected %zu, the particles, found %zu",
                       w->dem.particles.soa.count, count);
    if (spin && !(w->ctx.effects & GN_FX_ROTATION))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument spin: expected a scene with rotation (law.rotation), found one "
                       "without");
    if (w->ctx.scene.has_couple)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected particles that do not follow elements, found a coupling",
                       w->ctx.scene.source);
    GN_TRY(check_rows(velocity, count, "velocity", error));
    GN_TRY(check_rows(spin, count, "spin", error));
    const double gained = gn_dem_set_velocities(&w->ctx, &w->dem, velocity, spin);
    if (w->ctx.step > 0) w->ledger.energy.work_user += gained;
    /* The skin must be at least the distance by which two particles can approach each other in a
     * step. */
    const double path = 2.0 * w->ctx.dt * sqrt(w->dem.done.motion.speed2);
    return path > 0.5 * w->dem.verlet.skin ? gn_world_renew_lists(w, error) : GNEISS_OK;
}

/* Returns the motion of a wall, set or body; NULL: none has the name. */
static gn_motion *motion_of(gn_scene *scene, const char *name) {
    const int wall = gn_scene_find_wall(scene, name), set = gn_scene_find_set(scene, name),
              body = gn_scene_find_body(scene, name);
    return wall >= 0   ? &scene->walls[wall].motion
           : set >= 0  ? &scene->sets[set].motion
           : body >= 0 ? &scene->bodies[body].motion
                       : NULL;
}

static gneiss_status set_component(gn_scene *scene, const char *name, int component, double value,
                                   gneiss_error *error) {
    gn_motion *motion = motion_of(scene, name);
    if (!motion)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected the name of a wall, set or body, found '%.80s'", scene->source,
                       name);
    const int wall = gn_scene_find_wall(scene, name);
    gn_table *table = component < 3 ? &motion->velocity[component] : &motion->spin[component - 3];
    if (!table->count || (wall >= 0 && scene->walls[wall].servo.active))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: motion of '%.80s': expected a component that the scene prescribes "
                       "(0 suffices), found %c%c %s",
                       scene->source, name, component < 3 ? 'v' : 'w', "xyz"[component % 3],
                       table -> count ? "under a servo" : "free");
    gn_table_set_constant(table, value);
    return GNEISS_OK;
}

gneiss_status gneiss_world_set_motion(gneiss_world *world, const char *name, int component,
                                      double value, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    GN_TRY(gn_api_require(name, "name", error));
    gn_step_context *ctx = &world->run.world.ctx;
    if (component < 0 || component > 5)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument component: expected one in [0, 5], found %d", component);
    if (!(fabs(value) <= most_speed))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument value: expected a finite number up to %g, found %g", most_speed,
                       value);
    if (ctx->scene.stage_count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a scene without stages, which state motions themselves",
                       ctx->scene.source);
    const double path = component < 3 ? ctx->dt * fabs(value) : 0.0,
                 most = 0.05 * world->run.world.dem.radius_min;
    if (ctx->scene.has_specimen && path > most)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument value: expected at most %.6g m/s, a twentieth of the smallest "
                       "radius in a step, found %g",
                       most / ctx->dt, value);
    GN_TRY(set_component(&ctx->scene, name, component, value, error));
    return set_component(&ctx->given, name, component, value, error);
}

gneiss_status gneiss_world_end_stage(gneiss_world *world, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    if (!gn_run_staged(&world->run))
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a scene with stages, found none",
                       world->run.world.ctx.scene.source);
    gn_run_end_stage(&world->run);
    return GNEISS_OK;
}
