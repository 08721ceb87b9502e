/* Loads and formulas that vary over time. At the beginning of a step gravity and the forces of sets
 * and bodies take their values at the instant of the step, so that their works are trapezoidal like
 * those of constant forces; motions and servos read their tables where they need them. A formula
 * that gave a value that is not finite in the step ends the run. */
#include "base/error.h"
#include "frame/feature.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/formula.h"
#include "scene/scene.h"
#include "solids/solids.h"
#include "world/world.h"

static bool varies(const gn_table over_time[3]) {
    return over_time[0].count || over_time[1].count || over_time[2].count;
}

static bool sets_vary(const gn_scene *scene) {
    bool any = false;
    for (size_t k = 0; k < scene->set_count; k++)
        any = any || varies(scene->sets[k].force_over_time);
    return any;
}

static bool loads_used(const gn_world *world) {
    return world->ctx.scene.loads_vary || world->ctx.scene.formulas;
}

GN_HOOK(loads_take) {
    gn_step_context *ctx = &world->ctx;
    gn_formulas_forget(ctx->scene.formulas);
    gn_scene_set_time(&ctx->scene, ctx->time);
    if (sets_vary(&ctx->scene)) gn_sets_push(ctx, &world->dem);
    return varies(ctx->scene.gravity_over_time)
               ? gn_elements_set_gravity(ctx, &world->solids, error)
               : GNEISS_OK;
}

GN_HOOK(loads_check) {
    gneiss_error own = {0};
    const gneiss_status status = gn_formulas_check(world->ctx.scene.formulas, &own);
    /* Outputs between steps have the loads of their instant. */
    if (status == GNEISS_OK) return loads_take(NULL, world, error);
    return gn_fail(error, status, "step %lld: %s", (long long)(world->ctx.step - 1), own.message);
}

const gn_feature gn_feature_loads = {
    .name = "loads",
    .used = loads_used,
    .hook = {[GN_HOOK_BEFORE_LISTS] = loads_take, [GN_HOOK_AFTER_STEP] = loads_check}};
