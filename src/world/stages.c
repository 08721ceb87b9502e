/* Transition from one stage of the scene to the next: the scene of the stage replaces the former
 * one, and each part of the world updates what it holds of it. */
#include "scene/stages.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "membrane/membrane.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/origin.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Shifts the times of a table, which a stage counts from its own start. */
static void start_table(void *context, gn_table *table) {
    const gn_world *w = context;
    gn_table_delay(table, table->stage ? w->stages.state[table->stage - 1].time : 0.0);
}

static gneiss_status stages_create(const gn_step_context *ctx, gn_stages *stages,
                                   gneiss_error *error) {
    size_t count = ctx->given.stage_count;
    if (!count || stages->state) return GNEISS_OK;
    stages->state = gn_alloc_array(count, sizeof *stages->state);
    return stages->state ? GNEISS_OK
                         : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu stages", count);
}

gneiss_status gn_stages_scene(gn_world *world, gn_scene *scene, gneiss_error *error) {
    GN_TRY(stages_create(&world->ctx, &world->stages, error));
    GN_TRY(gn_scene_stage(&world->ctx.given, world->stages.now, scene, error));
    gn_scene_shift(scene);
    gn_scene_tables(scene, start_table, world);
    return GNEISS_OK;
}

/* Chooses the step as at the start of a run: it may also become longer. */
gneiss_status gn_world_choose_step(gn_world *world, gneiss_error *error) {
    int64_t lowered = world->ctx.dt_lowered;
    world->ctx.dt = INFINITY;
    gneiss_status status =
        gn_timestep_check(&world->ctx, &world->dem, &world->boundary, &world->solids, &world->zones,
                          &world->ledger, true, error);
    world->ctx.dt_lowered = lowered;
    GN_TRY(status);
    return gn_origin_check(&world->ctx, &world->dem, &world->boundary, &world->solids, error);
}

gneiss_status gn_world_enter(gn_world *world, size_t stage, gneiss_error *error) {
    gn_scene *next = calloc(1, sizeof *next); /* too large for a stack */
    if (!next) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a stage");
    gn_ranks_whole(world->ctx.ranks);
    const double pressure = gn_membrane_pressure_now(&world->ctx, &world->membrane);
    world->stages.now = stage;
    world->stages.state[stage].time = world->ctx.time;
    world->stages.state[stage].step = world->ctx.step;
    gneiss_status status = gn_stages_scene(world, next, error);
    if (status == GNEISS_OK) {
        gn_scene_free(&world->ctx.scene);
        world->ctx.scene = *next; /* pointers of parts into the scene stay valid */
    }
    free(next);
    if (status != GNEISS_OK) return status;
    world->ctx.effects = gn_scene_effects(&world->ctx.scene);
    gn_features_choose(world);
    gn_membrane_enter(&world->ctx, &world->membrane, world->stages.now, pressure);
    GN_TRY(gn_world_enter_particles(world, error));
    gn_boundary_enter(&world->ctx, &world->boundary);
    GN_TRY(gn_bodies_check_speeds(&world->ctx, &world->boundary, error));
    GN_TRY(gn_elements_enter(&world->ctx, &world->solids, error));
    if (world->ctx.scene.has_specimen) GN_TRY(gn_world_rebuild(world, error));
    const bool forms =
        world->ctx.scene.bonds_stage == stage + 1 && world->ctx.scene.bonds == GN_SWITCH_ON;
    if (forms)
        GN_TRY(gn_membrane_update_bearers(&world->ctx, &world->dem, &world->membrane,
                                          &world->boundary, &world->solids, error));
    return gn_world_choose_step(world, error);
}

/* --- a first stage in which nothing happens --- */

static bool pairs_press(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_contacts *pairs = &dem->pairs.contacts;
    for (size_t c = 0; c < pairs->soa.count; c++) {
        const double *x = dem->particles.pos + 4 * (size_t)pairs->i[c],
                     *y = dem->particles.pos + 4 * (size_t)pairs->j[c], sum = x[3] + y[3];
        double d[3];
        if (gn_branch(ctx, x, y, d) < sum * sum * (1.0 - 1e-9)) return true;
    }
    return false;
}

static bool wall_presses(const gn_dem *dem, const gn_wall_def *wall) {
    const gn_particles *q = &dem->particles;
    for (size_t p = 0; !wall->passive && p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p,
                     d[3] = {x[0] - wall->point[0], x[1] - wall->point[1], x[2] - wall->point[2]};
        if (gn_dot3(d, wall->normal) < x[3] * (1.0 - 1e-9)) return true;
    }
    return false;
}

/* Contacts of bodies and elements are not considered. */
static bool contacts_press(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids) {
    bool press = ctx->scene.body_count || solids->count || pairs_press(ctx, dem);
    for (size_t k = 0; !press && k < ctx->scene.wall_count; k++)
        press = wall_presses(dem, &ctx->scene.walls[k]);
    return press;
}

gneiss_status gn_stages_check_first(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_stages *stages,
                                    gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    char key[64], why[160];
    const char *end =
        s->stage_count && stages->now == 0 ? gn_stage_never_ends(s, 0, why, sizeof why) : NULL;
    if (!end || contacts_press(ctx, dem, solids)) return GNEISS_OK;
    snprintf(key, sizeof key, "stages[0].%s", end);
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s (and no contact is pressed)",
                   gn_scene_at(s, s->stages[0].where, key).text, why);
}
