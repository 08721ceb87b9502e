/* Public API: calls between steps and fields of force of a program. All hooks of a world are one
 * feature (frame/feature.h): it notes that a call is due, and the advance then stops between two
 * steps for it; forces join the loads of held particles. */
#include "api/handles.h"
#include "base/memory.h"
#include "base/new.h"
#include "drive/box.h"
#include "sched/hold.h"
#include "soa/particle_state.h"
#include "timestep/timestep.h"

#include <math.h>
#include <string.h>

static bool has_forces(const gn_api_hooks *hooks) {
    for (size_t k = 0; k < hooks->count; k++)
        if (hooks->hook[k].force) return true;
    return false;
}

/* N/m: of all fields together on one particle, at most. */
static double stiffness_of(const gn_api_hooks *hooks) {
    double sum = 0.0;
    for (size_t k = 0; k < hooks->count; k++)
        if (hooks->hook[k].force) sum += hooks->hook[k].stiffness;
    return sum;
}

/* --- places of a step --- */

static gneiss_status make_room(gn_api_hooks *hooks, size_t count, gneiss_error *error) {
    if (hooks->load_count == count && hooks->load) return GNEISS_OK;
    gn_free(hooks->load);
    gn_free(hooks->force);
    gn_free(hooks->moment);
    hooks->force = hooks->moment = NULL;
    hooks->load_count = count;
    GN_TRY(gn_new(&hooks->load, 6 * count + 1, "forces of programs", error));
    GN_TRY(gn_new(&hooks->force, 3 * count + 1, "forces of programs", error));
    return gn_new(&hooks->moment, 3 * count + 1, "forces of programs", error);
}

GN_HOOK(hold_particles) {
    gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    const gn_particles *q = &world->dem.particles;
    if (!has_forces(h)) return GNEISS_OK;
    GN_TRY(make_room(h, q->soa.count, error));
    double most = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        GN_TRY(gn_hold_particle(&world->dem.hold, p, error));
        most = fmax(most, q->vel[4 * p + 3]);
    }
    h->lightest = 1.0 / most;
    return GNEISS_OK;
}

/* s: the limit of the step with springs of that stiffness to fixed points on all particles: they
 * add k/m to the square of a frequency 2/limit, at most. */
static double limit_with(const gn_step_context *ctx, double stiffness, double lightest) {
    const double rate2 = isfinite(ctx->stable) ? 1.0 / (ctx->stable * ctx->stable) : 0.0;
    return 1.0 / sqrt(rate2 + 0.25 * stiffness / lightest);
}

GN_HOOK(limit_step) {
    const gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    const double stiffness = stiffness_of(h);
    if (stiffness > 0.0)
        gn_timestep_lower(&world->ctx, &world->dem,
                          world->ctx.scene.safety *
                              limit_with(&world->ctx, stiffness, h->lightest));
    return GNEISS_OK;
}

static gneiss_status evaluate(gn_api_hooks *h, const gn_api_hook *hook, const gn_world *w,
                              gneiss_error *error) {
    const gn_particles *q = &w->dem.particles;
    const size_t n = q->soa.count;
    memset(h->force, 0, 3 * n * sizeof *h->force);
    memset(h->moment, 0, 3 * n * sizeof *h->moment);
    const gneiss_points points = {n,       w->ctx.time, q->pos,   q->vel,
                                  q->spin, q->id,       h->force, q->spin ? h->moment : NULL};
    if (hook->force(hook->context, &points) != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "step %lld, t = %.6g s: the field of force %lld failed",
                       (long long)w->ctx.step, w->ctx.time, (long long)hook->number);
    for (size_t p = 0; p < n; p++)
        for (size_t a = 0; a < 3 && gn_particle_is_active(q, p); a++) {
            if (!isfinite(h->force[3 * p + a]) || !isfinite(h->moment[3 * p + a]))
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "step %lld, t = %.6g s: the field of force %lld: expected finite "
                               "numbers, found others on particle %d",
                               (long long)w->ctx.step, w->ctx.time, (long long)hook->number,
                               q->id[p]);
            h->load[6 * p + a] += h->force[3 * p + a];
            h->load[6 * p + 3 + a] += h->moment[3 * p + a];
        }
    return GNEISS_OK;
}

/* In a plane: forces along x and y, moments about z. */
static void keep_to_plane(const gn_world *w, double *load) {
    if (w->ctx.scene.dimension == 3) return;
    load[2] = load[3] = load[4] = 0.0;
}

static double power(const gn_particles *q, size_t p, const double *load) {
    double sum = gn_dot3(load, q->vel + 4 * p);
    if (q->spin) sum += gn_dot3(load + 3, q->spin + 4 * p);
    return sum;
}

static double power_of_all(const gn_api_hooks *h, const gn_particles *q) {
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += power(q, p, h->load + 6 * p);
    return sum;
}

GN_HOOK(act) {
    gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    const gn_particles *q = &world->dem.particles;
    const bool space = world->ctx.scene.dimension == 3, turns = world->ctx.effects & GN_FX_ROTATION;
    const int width = gn_row_width(space, turns);
    if (!has_forces(h)) return GNEISS_OK;
    memset(h->load, 0, 6 * q->soa.count * sizeof *h->load);
    for (size_t k = 0; k < h->count; k++)
        if (h->hook[k].force) GN_TRY(evaluate(h, &h->hook[k], world, error));
    for (size_t p = 0; p < q->soa.count; p++) {
        double *row = gn_hold_load(&world->dem.hold, width, p), *load = h->load + 6 * p;
        keep_to_plane(world, load);
        for (int a = 0; a < (int)world->ctx.scene.dimension; a++) row[a] += load[a];
        if (width == 8)
            for (int a = 0; a < 3; a++) row[4 + a] += load[3 + a];
        else if (turns)
            row[2] += load[5];
    }
    world->ledger.energy.work_user += 0.5 * world->ctx.dt_past * power_of_all(h, q);
    return GNEISS_OK;
}

GN_HOOK(book_work) {
    const gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    if (has_forces(h))
        world->ledger.energy.work_user +=
            0.5 * world->ctx.dt * power_of_all(h, &world->dem.particles);
    return GNEISS_OK;
}

/* A run ends at the step nearest to its end in the same way. */
static bool has_passed(const gn_api_hook *hook, const gn_step_context *ctx) {
    return hook->next < hook->time_count && ctx->time >= hook->times[hook->next] - 0.5 * ctx->dt;
}

static bool is_due(const gn_api_hook *hook, const gn_step_context *ctx) {
    if (!hook->call) return false;
    return (hook->every > 0 && ctx->step % hook->every == 0) || has_passed(hook, ctx);
}

GN_HOOK(note_calls) {
    gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    for (size_t k = 0; k < h->count && !h->due; k++) h->due = is_due(&h->hook[k], &world->ctx);
    return GNEISS_OK;
}

static const gn_feature feature = {
    .name = "hooks of a program",
    .hook = {[GN_HOOK_LISTS] = hold_particles,
             [GN_HOOK_LIMIT] = limit_step,
             [GN_HOOK_ACT] = act,
             [GN_HOOK_MOVED] = book_work,
             [GN_HOOK_AFTER_STEP] = note_calls},
};

/* --- calls --- */

/* Removed hooks keep their place until no call is running. */
static void drop_removed(gn_api_hooks *h) {
    size_t kept = 0;
    for (size_t k = 0; k < h->count; k++) {
        if (h->hook[k].call || h->hook[k].force)
            h->hook[kept++] = h->hook[k];
        else
            gn_free(h->hook[k].times);
    }
    h->count = kept;
}

/* A call may add hooks, so that the list may have another place after it. Those begin later. */
gneiss_status gn_api_hooks_call(gneiss_world *world, gneiss_error *error) {
    gn_api_hooks *h = &world->hooks;
    const gn_step_context *ctx = &world->run.world.ctx;
    int64_t stopped = -1;
    if (!h->due) return GNEISS_OK;
    h->due = 0;
    h->inside = true;
    for (size_t k = 0, count = h->count; k < count; k++) {
        gn_api_hook *hook = &h->hook[k];
        if (!is_due(hook, ctx)) continue;
        while (has_passed(hook, ctx)) hook->next++;
        const int64_t number = hook->number;
        if (hook->call(hook->context, world) != 0) stopped = number;
    }
    h->inside = false;
    drop_removed(h);
    if (stopped < 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_INTERRUPTED, "step %lld, t = %.6g s: stopped by the call %lld",
                   (long long)ctx->step, ctx->time, (long long)stopped);
}

/* --- adding and removing --- */

static gneiss_status add_feature(gneiss_world *world, gneiss_error *error) {
    if (world->hooks.added) return GNEISS_OK;
    gn_feature own = feature;
    own.context = world;
    GN_TRY(gn_feature_add(&world->run.world, own, error));
    world->hooks.added = true;
    return GNEISS_OK;
}

void gn_api_hooks_free(gn_api_hooks *hooks) {
    for (size_t k = 0; k < hooks->count; k++) gn_free(hooks->hook[k].times);
    gn_free(hooks->hook);
    gn_free(hooks->load);
    gn_free(hooks->force);
    gn_free(hooks->moment);
}

/* Appends a hook, which is the caller's to fill with what cannot fail. */
static gneiss_status append(gneiss_world *world, gn_api_hook **hook, int64_t *number,
                            gneiss_error *error) {
    gn_api_hooks *h = &world->hooks;
    gn_api_hook *list = NULL;
    GN_TRY(add_feature(world, error));
    GN_TRY(gn_new(&list, h->count + 1, "hooks", error));
    if (h->hook) memcpy(list, h->hook, h->count * sizeof *list);
    gn_free(h->hook);
    h->hook = list;
    *hook = &list[h->count++];
    (*hook)->number = *number = h->numbers++;
    return GNEISS_OK;
}

static gneiss_status check_times(const double *times, size_t count, gneiss_error *error) {
    if (count) GN_TRY(gn_api_require(times, "times", error));
    for (size_t k = 0; k < count; k++)
        if (!isfinite(times[k]) || (k && !(times[k] > times[k - 1])))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "argument times: expected finite numbers that rise, found %g at %zu",
                           times[k], k);
    return GNEISS_OK;
}

gneiss_status gneiss_world_add_call(gneiss_world *world, int64_t every, const double *times,
                                    size_t time_count, gneiss_call *call, void *context,
                                    int64_t *hook, gneiss_error *error) {
    GN_FREED double *own = NULL;
    gn_api_hook *added;
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require((const void *)(uintptr_t)call, "call", error));
    GN_TRY(gn_api_require(hook, "hook", error));
    if (every < 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument every: expected a number of steps of at least 0, found %lld",
                       (long long)every);
    GN_TRY(check_times(times, time_count, error));
    GN_TRY(gn_new(&own, time_count + 1, "times of a call", error));
    if (time_count) memcpy(own, times, time_count * sizeof *own);
    GN_TRY(append(world, &added, hook, error));
    added->call = call;
    added->every = every;
    added->times = own;
    added->time_count = time_count;
    added->context = context;
    while (added->next < time_count && own[added->next] <= world->run.world.ctx.time) added->next++;
    own = NULL;
    return GNEISS_OK;
}

static gneiss_status check_field(const gneiss_world *world, double stiffness, gneiss_error *error) {
    const gn_world *w = &world->run.world;
    if (!(stiffness >= 0.0) || !isfinite(stiffness))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument stiffness: expected a finite number of at least 0, found %g",
                       stiffness);
    if (!w->ctx.scene.has_specimen || w->ctx.scene.has_couple || gn_box_moves(&w->ctx, &w->box))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected particles for a field of force, not coupled to elements and "
                       "in no periodic box that moves, found %s",
                       w->ctx.scene.source,
                       !w->ctx.scene.has_specimen ? "no particles"
                       : w->ctx.scene.has_couple  ? "such a coupling"
                                                  : "such a box");
    return GNEISS_OK;
}

/* A given step is not lowered. */
static gneiss_status check_given_step(const gneiss_world *world, gneiss_error *error) {
    const gn_step_context *ctx = &world->run.world.ctx;
    const double stiffness = stiffness_of(&world->hooks);
    if (ctx->scene.step == 0.0 || stiffness == 0.0) return GNEISS_OK;
    const double most = limit_with(ctx, stiffness, world->hooks.lightest);
    if (ctx->dt <= most || ctx->scene.on_unstable == GN_POLICY_WARN) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected at most %.6g s (stability limit with fields of force of %g N/m), "
                   "found %.6g s",
                   gn_scene_at(&ctx->scene, ctx->scene.time_where, "time.step").text, most,
                   stiffness, ctx->dt);
}

gneiss_status gneiss_world_add_force(gneiss_world *world, double stiffness, gneiss_force *force,
                                     void *context, int64_t *hook, gneiss_error *error) {
    gn_api_hook *added;
    GN_TRY(gn_api_require_good(world, error));
    GN_TRY(gn_api_require((const void *)(uintptr_t)force, "force", error));
    GN_TRY(gn_api_require(hook, "hook", error));
    GN_TRY(check_field(world, stiffness, error));
    GN_TRY(append(world, &added, hook, error));
    added->force = force;
    added->stiffness = stiffness;
    added->context = context;
    gneiss_status status = gn_features_follow_lists(&world->run.world, error);
    if (status == GNEISS_OK) status = check_given_step(world, error);
    if (status != GNEISS_OK) (void)gneiss_world_remove_hook(world, *hook, NULL);
    return status;
}

gneiss_status gneiss_world_remove_hook(gneiss_world *world, int64_t hook, gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    gn_api_hooks *h = &world->hooks;
    for (size_t k = 0; k < h->count; k++) {
        gn_api_hook *found = &h->hook[k];
        if (found->number != hook || (!found->call && !found->force)) continue;
        const bool forces = found->force != NULL;
        found->call = NULL;
        found->force = NULL;
        if (!h->inside) drop_removed(h);
        return forces ? gn_features_follow_lists(&world->run.world, error) : GNEISS_OK;
    }
    return gn_fail(error, GNEISS_ERROR_INPUT, "expected the number of a hook, found %lld",
                   (long long)hook);
}
