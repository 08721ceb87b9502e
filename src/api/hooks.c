/* Public API: calls between steps and fields of force of a program. All hooks of a world are one
 * feature (frame/feature.h). It records that a call is due, for which the advance stops between two
 * steps; forces are added to the loads of held particles. */
#include "api/handles.h"
#include "base/memory.h"
#include "base/new.h"
#include "drive/box.h"
#include "sched/hold.h"
#include "soa/particle_state.h"
#include "timestep/timestep.h"

#include <math.h>
#include <string.h>

/* Points on which fields act: particles, or the nodes of the body of elements that the API
 * provides. */
typedef struct points {
    const gn_particles *list;
    gn_hold *hold;
    int width;    /* width of a row of loads */
    size_t first; /* place in gn_api_hooks.load */
} points;

static points points_of(gn_world *w, gneiss_record record) {
    const bool space = w->ctx.scene.dimension == 3;
    if (record == GNEISS_PARTICLES)
        return (points){&w->dem.particles, &w->dem.hold,
                        gn_row_width(space, w->ctx.effects & GN_FX_ROTATION), 0};
    gn_fem_solid *body = &w->solids.elements[0]->solid;
    return (points){&body->nodes, &body->hold, gn_row_width(space, false),
                    w->dem.particles.soa.count};
}

static bool has_forces(const gn_api_hooks *hooks, gneiss_record record) {
    for (size_t k = 0; k < hooks->count; k++)
        if (hooks->hook[k].force && hooks->hook[k].record == record) return true;
    return false;
}

/* Returns the largest value, 1/s2, that all fields together add to the square of a frequency. */
static double added_square(const gn_api_hooks *hooks) {
    double sum[2] = {0.0, 0.0};
    for (size_t k = 0; k < hooks->count; k++)
        if (hooks->hook[k].force)
            sum[hooks->hook[k].record == GNEISS_NODES] += hooks->hook[k].stiffness;
    return fmax(sum[0] * hooks->lightest[0], sum[1] * hooks->lightest[1]);
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

static gneiss_status hold_all(const points *p, double *lightest, gneiss_error *error) {
    *lightest = 0.0;
    for (size_t k = 0; k < p->list->soa.count; k++) {
        GN_TRY(gn_hold_particle(p->hold, k, error));
        *lightest = fmax(*lightest, p->list->vel[4 * k + 3]);
    }
    return GNEISS_OK;
}

GN_HOOK(hold_points) {
    gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    const bool particles = has_forces(h, GNEISS_PARTICLES), nodes = has_forces(h, GNEISS_NODES);
    if (!particles && !nodes) return GNEISS_OK;
    size_t count = world->dem.particles.soa.count;
    if (nodes) count += points_of(world, GNEISS_NODES).list->soa.count;
    GN_TRY(make_room(h, count, error));
    for (int k = 0; k < 2; k++) {
        if (!(k ? nodes : particles)) continue;
        const points p = points_of(world, k ? GNEISS_NODES : GNEISS_PARTICLES);
        GN_TRY(hold_all(&p, &h->lightest[k], error));
    }
    return GNEISS_OK;
}

/* Returns the limit of the step, s, with springs to fixed points, which add at most `square` to the
 * square of the frequency 2/limit. */
static double limit_with(const gn_step_context *ctx, double square) {
    const double rate2 = isfinite(ctx->stable) ? 1.0 / (ctx->stable * ctx->stable) : 0.0;
    return 1.0 / sqrt(rate2 + 0.25 * square);
}

GN_HOOK(limit_step) {
    const double square = added_square(&((gneiss_world *)context)->hooks);
    if (square > 0.0)
        gn_timestep_lower(&world->ctx, &world->dem,
                          world->ctx.scene.safety * limit_with(&world->ctx, square));
    return GNEISS_OK;
}

static gneiss_status evaluate(gn_api_hooks *h, const gn_api_hook *hook, const points *on,
                              const gn_world *w, gneiss_error *error) {
    const gn_particles *q = on->list;
    const size_t n = q->soa.count;
    memset(h->force, 0, 3 * n * sizeof *h->force);
    memset(h->moment, 0, 3 * n * sizeof *h->moment);
    const gneiss_points seen = {n,       w->ctx.time, q->pos,   q->vel,
                                q->spin, q->id,       h->force, q->spin ? h->moment : NULL};
    h->acting = true;
    const int result = hook->force(hook->context, &seen);
    h->acting = false;
    if (result != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "step %lld, t = %.6g s: the field of force %lld failed",
                       (long long)w->ctx.step, w->ctx.time, (long long)hook->number);
    for (size_t p = 0; p < n; p++)
        for (size_t a = 0; a < 3 && gn_particle_is_active(q, p); a++) {
            if (!isfinite(h->force[3 * p + a]) || !isfinite(h->moment[3 * p + a]))
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "step %lld, t = %.6g s: the field of force %lld: expected finite "
                               "numbers, found others on %s %d",
                               (long long)w->ctx.step, w->ctx.time, (long long)hook->number,
                               hook->record == GNEISS_NODES ? "node" : "particle", q->id[p]);
            double *load = h->load + 6 * (on->first + p);
            load[a] += h->force[3 * p + a];
            load[3 + a] += h->moment[3 * p + a];
        }
    return GNEISS_OK;
}

/* Keeps loads in the plane: forces along x and y, moments about z. */
static void keep_to_plane(const gn_world *w, double *load) {
    if (w->ctx.scene.dimension == 3) return;
    load[2] = load[3] = load[4] = 0.0;
}

/* Returns the power of all fields on these points, W. */
static double power_on(const gn_api_hooks *h, const points *on) {
    const gn_particles *q = on->list;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *load = h->load + 6 * (on->first + p);
        sum += gn_dot3(load, q->vel + 4 * p);
        if (q->spin) sum += gn_dot3(load + 3, q->spin + 4 * p);
    }
    return sum;
}

static void add_loads(const gn_world *w, gn_api_hooks *h, const points *on) {
    for (size_t p = 0; p < on->list->soa.count; p++) {
        double *row = gn_hold_load(on->hold, on->width, p), *load = h->load + 6 * (on->first + p);
        keep_to_plane(w, load);
        for (int a = 0; a < (int)w->ctx.scene.dimension; a++) row[a] += load[a];
        for (int a = 0; a < 3 && on->width == 8; a++) row[4 + a] += load[3 + a];
        if (on->list->spin && on->width == 4) row[2] += load[5];
    }
}

static gneiss_status act_on(gn_world *w, gn_api_hooks *h, gneiss_record record,
                            gneiss_error *error) {
    if (!has_forces(h, record)) return GNEISS_OK;
    const points on = points_of(w, record);
    memset(h->load + 6 * on.first, 0, 6 * on.list->soa.count * sizeof *h->load);
    for (size_t k = 0; k < h->count; k++)
        if (h->hook[k].force && h->hook[k].record == record)
            GN_TRY(evaluate(h, &h->hook[k], &on, w, error));
    add_loads(w, h, &on);
    w->ledger.energy.work_user += 0.5 * w->ctx.dt_past * power_on(h, &on);
    return GNEISS_OK;
}

GN_HOOK(act) {
    gn_api_hooks *h = &((gneiss_world *)context)->hooks;
    GN_TRY(act_on(world, h, GNEISS_PARTICLES, error));
    return act_on(world, h, GNEISS_NODES, error);
}

static void book_after(gn_world *w, const gn_api_hooks *h, gneiss_record record) {
    if (!has_forces(h, record)) return;
    const points on = points_of(w, record);
    w->ledger.energy.work_user += 0.5 * w->ctx.dt * power_on(h, &on);
}

GN_HOOK(book_particles) {
    book_after(world, &((gneiss_world *)context)->hooks, GNEISS_PARTICLES);
    return GNEISS_OK;
}

GN_HOOK(book_nodes) {
    book_after(world, &((gneiss_world *)context)->hooks, GNEISS_NODES);
    return GNEISS_OK;
}

/* Tells whether a time has passed; as at the end of a run, the step that ends nearest to it counts.
 */
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
    .hook = {[GN_HOOK_LISTS] = hold_points,
             [GN_HOOK_LIMIT] = limit_step,
             [GN_HOOK_ACT] = act,
             [GN_HOOK_MOVED] = book_particles,
             [GN_HOOK_ELEMENTS_MOVED] = book_nodes,
             [GN_HOOK_AFTER_STEP] = note_calls},
};

/* --- calls --- */

/* Drops removed hooks, which keep their place until no call is running. */
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

/* A call may add hooks, after which the list may be at another address. New hooks begin later. */
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

/* Appends a hook, which the caller completes with members whose setting cannot fail. */
static gneiss_status append(gneiss_world *world, gn_api_hook **hook, int64_t *number,
                            gneiss_error *error) {
    gn_api_hooks *h = &world->hooks;
    GN_TRY(add_feature(world, error));
    if (!gn_widen(&h->hook, h->count, h->count + 1, sizeof *h->hook))
        return gn_no_memory(error, "hooks");
    *hook = &h->hook[h->count++];
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
    GN_TRY(gn_api_require_whole(world, error));
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

static gneiss_status check_field(const gneiss_world *world, gneiss_record record, double stiffness,
                                 gneiss_error *error) {
    const gn_world *w = &world->run.world;
    if (!(stiffness >= 0.0) || !isfinite(stiffness))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument stiffness: expected a finite number of at least 0, found %g",
                       stiffness);
    if (record != GNEISS_PARTICLES && record != GNEISS_NODES)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument record: expected particles or nodes, found %d", (int)record);
    const bool there = record == GNEISS_NODES ? w->solids.count > 0 : w->ctx.scene.has_specimen;
    if (there && !w->ctx.scene.has_couple && !gn_box_moves(&w->ctx, &w->box)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected %s for a field of force, particles and elements that are not "
                   "coupled, and no periodic box that moves, found %s",
                   w->ctx.scene.source, gneiss_record_name(record),
                   !there                    ? "none"
                   : w->ctx.scene.has_couple ? "a coupling"
                                             : "such a box");
}

/* Checks a given step, which is not lowered. */
static gneiss_status check_given_step(const gneiss_world *world, gneiss_error *error) {
    const gn_step_context *ctx = &world->run.world.ctx;
    const double square = added_square(&world->hooks);
    if (ctx->scene.step == 0.0 || square == 0.0) return GNEISS_OK;
    const double most = limit_with(ctx, square);
    if (ctx->dt <= most || ctx->scene.on_unstable == GN_POLICY_WARN) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected at most %.6g s (stability limit with the stiffness of fields of "
                   "force), found %.6g s",
                   gn_scene_at(&ctx->scene, ctx->scene.time_where, "time.step").text, most,
                   ctx->dt);
}

gneiss_status gneiss_world_add_force(gneiss_world *world, gneiss_record record, double stiffness,
                                     gneiss_force *force, void *context, int64_t *hook,
                                     gneiss_error *error) {
    gn_api_hook *added;
    GN_TRY(gn_api_require_good(world, error));
    GN_TRY(gn_api_require((const void *)(uintptr_t)force, "force", error));
    GN_TRY(gn_api_require(hook, "hook", error));
    GN_TRY(check_field(world, record, stiffness, error));
    GN_TRY(append(world, &added, hook, error));
    added->force = force;
    added->record = record;
    added->stiffness = stiffness;
    added->context = context;
    gneiss_status status = gn_features_follow_lists(&world->run.world, error);
    if (status == GNEISS_OK) status = check_given_step(world, error);
    if (status != GNEISS_OK) (void)gneiss_world_remove_hook(world, *hook, NULL);
    return status;
}

gneiss_status gneiss_world_remove_hook(gneiss_world *world, int64_t hook, gneiss_error *error) {
    GN_TRY(gn_api_require_whole(world, error));
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
