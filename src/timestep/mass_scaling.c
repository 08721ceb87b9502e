/* Masses raised for a longer step. Each particle's mass and moment of inertia are multiplied by the
 * factor that its springs need at the wanted step: active springs, springs that may become active
 * before the lists are rebuilt, and collisions that must be resolved. A rigorous bound needs larger
 * masses than the sharp limit does; the bound is therefore evaluated at a smaller step, which is
 * varied until the sharp limit is the wanted step. */
#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"

#include <math.h>

double gn_timestep_added_kinetic(const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double all = 0.0, added = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *v = q->vel + 4 * p, *o = q->spin ? q->spin + 4 * p : NULL;
        double twice = v[3] > 0.0 ? gn_dot3(v, v) / v[3] : 0.0;
        if (o && o[3] > 0.0) twice += gn_dot3(o, o) / o[3];
        all += twice;
        added += (1.0 - q->own_share[p]) * twice;
    }
    return all > 0.0 ? added / all : 0.0;
}

/* --- raising masses --- */

/* Ratio of the step to the limit of listed contacts; slightly below the ratio with which they are
 * checked. */
static const double listed_share = 0.989;

/* Requirements at the step of the run: active springs must be stable with the safety factor, listed
 * ones without it. */
typedef struct wanted {
    double step;          /* s, step of the run */
    double limit, listed; /* s, limits of the particles alone */
    bool sharp;
    double *factor, *also; /* [particles] factors of own masses */
    double *own;           /* [particles][2] unraised inverse mass and moment of inertia */
} wanted;

static gneiss_status find_factors(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  const gn_zones *zones, const wanted *q, double part,
                                  gneiss_error *error) {
    GN_TRY(gn_timestep_masses(ctx, dem, boundary, false, part * q->limit, NULL, q->factor, error));
    GN_TRY(gn_timestep_masses(ctx, dem, boundary, true, part * q->listed, NULL, q->also, error));
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        q->factor[p] = fmax(q->factor[p], q->also[p]);
    return gn_resolution_masses(ctx, dem, boundary, solids, zones, q->step, q->factor, error);
}

/* Returns the largest change of a mass. */
static double set_masses(const gn_step_context *ctx, gn_dem *dem, const wanted *q) {
    const gn_particles *a = &dem->particles;
    double most = 0.0;
    for (size_t p = 0; p < a->soa.count; p++) {
        double share = 1.0 / q->factor[p];
        most = fmax(most, fabs(share / a->own_share[p] - 1.0));
        a->own_share[p] = share;
        a->vel[4 * p + 3] = share * q->own[2 * p];
        if (a->spin) a->spin[4 * p + 3] = share * q->own[2 * p + 1];
    }
    gn_dem_masses_changed(ctx, dem);
    return most;
}

/* Raises the masses. Dashpots grow with the root of the masses, so that the iteration converges. */
static gneiss_status raise(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                           const gn_solids *solids, const gn_zones *zones, const wanted *q,
                           double part, gneiss_error *error) {
    enum { ROUNDS = 20 };
    double change = 1.0;
    ctx->dt = q->step;
    for (int round = 0; round < ROUNDS && change > 1e-4; round++) {
        GN_TRY(find_factors(ctx, dem, boundary, solids, zones, q, part, error));
        change = set_masses(ctx, dem, q);
        if (dem->damping_fraction == 0.0) break;
    }
    return GNEISS_OK;
}

/* --- changes of masses during a run --- */

/* Raises the mass and moment of inertia of a particle at its present velocities; returns the
 * kinetic energy that this adds. */
static double make_heavier(const gn_particles *a, size_t p, double share) {
    const double ratio = share / a->own_share[p];
    double *v = a->vel + 4 * p, *o = a->spin ? a->spin + 4 * p : NULL;
    double twice = gn_dot3(v, v) / v[3];
    if (o && o[3] > 0.0) twice += gn_dot3(o, o) / o[3];
    a->own_share[p] = share;
    v[3] *= ratio;
    if (o) o[3] *= ratio;
    return 0.5 * (1.0 / ratio - 1.0) * twice;
}

static bool follow_once(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                        const double *factor) {
    const gn_particles *a = &dem->particles;
    bool any = false;
    for (size_t p = 0; p < a->soa.count; p++) {
        if (!(factor[p] * a->own_share[p] > 1.0)) continue;
        ledger->energy.step_change += make_heavier(a, p, 1.0 / factor[p]);
        any = true;
    }
    if (any) gn_dem_masses_changed(ctx, dem);
    return any;
}

gneiss_status gn_timestep_follow_masses(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                        gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                        bool listed, const uint8_t *changed, double *held,
                                        gneiss_error *error) {
    enum { ROUNDS = 8 }; /* dashpots require several rounds */
    const gn_mass_scaling *s = &ctx->choice.scaling;
    *held = 0.0;
    if (!(ctx->effects & GN_FX_MASS_SCALING && s->reached > 0.0 && ctx->step > 0)) return GNEISS_OK;
    double step = gn_limit_needed(ctx, dem, solids, zones,
                                  s->reached / (listed ? listed_share : ctx->scene.safety));
    if (!isfinite(step)) return GNEISS_OK; /* other parts do not allow such a step */
    double *factor = NULL;
    GN_TRY(gn_new(&factor, dem->particles.soa.count + 1, "masses", error));
    gneiss_status status = GNEISS_OK;
    for (int round = 0; round < ROUNDS; round++) {
        status = gn_timestep_masses(ctx, dem, boundary, listed, step, changed, factor, error);
        if (status != GNEISS_OK || !follow_once(ctx, dem, ledger, factor)) break;
        if (dem->damping_fraction == 0.0) break;
    }
    gn_free(factor);
    /* With dashpots the masses may not have converged. */
    if (dem->damping_fraction == 0.0) *held = step;
    return status;
}

/* --- amount --- */

/* Finds the smallest fraction of the step at which the bound must be evaluated, to half a percent;
 * it is 0.8 to 0.9 in packings. */
static gneiss_status search(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                            gn_solids *solids, gn_zones *zones, gn_ledger *ledger, const wanted *q,
                            gneiss_error *error) {
    enum { TRIES = 10 };
    double low = 0.5, high = 1.0, part = q->sharp ? 0.85 : 1.0, added = -1.0;
    for (int k = 1;; k++) {
        GN_TRY(raise(ctx, dem, boundary, solids, zones, q, part, error));
        GN_TRY(gn_timestep_check(ctx, dem, boundary, solids, zones, ledger, true, error));
        double beyond = ctx->scene.safety * ctx->stable / q->step;
        bool reached = ctx->dt >= (1.0 - 1e-9) * q->step;
        if (part == 1.0 || (reached && beyond < 1.005)) return GNEISS_OK;
        if (reached && dem->raised.added == added)
            return GNEISS_OK; /* the step that was reached resolves collisions too */
        added = reached ? dem->raised.added : added;
        *(reached ? &high : &low) = part;
        bool close = high - low < 0.004 || k >= TRIES;
        if (close && reached) return GNEISS_OK;
        part *= 1.002 / beyond;
        if (close)
            part = high;
        else if (!(part > low && part < high))
            part = 0.5 * (low + high);
    }
}

static gneiss_status refuse(const gn_step_context *ctx, const gn_solids *solids, double step,
                            gneiss_error *error) {
    double elements = ctx->scene.safety * gn_nonviscous_share(ctx) * gn_elements_stable(solids);
    gn_scene_place at = ctx->scene.scaling_where;
    if (elements < step)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected a step of at most %.6g s, which the "
                       "finite elements allow (their masses are not raised), found %.6g s",
                       gn_scene_at(&ctx->scene, at, "time.mass_scaling").text, elements, step);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a step that bodies and elements touched by particles allow (their "
                   "masses are not raised), found %.6g s",
                   gn_scene_at(&ctx->scene, at, "time.mass_scaling").text, step);
}

static gneiss_status make_room(const gn_dem *dem, wanted *q, gneiss_error *error) {
    const gn_particles *a = &dem->particles;
    size_t n = a->soa.count;
    q->factor = gn_alloc_array(n + 1, sizeof *q->factor);
    q->also = gn_alloc_array(n + 1, sizeof *q->also);
    q->own = gn_alloc_array(n + 1, 2 * sizeof *q->own);
    if (!q->factor || !q->also || !q->own)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu masses", n);
    for (size_t p = 0; p < n; p++) {
        q->own[2 * p] = a->vel[4 * p + 3];
        if (a->spin) q->own[2 * p + 1] = a->spin[4 * p + 3];
    }
    return GNEISS_OK;
}

/* The largest factor of a mass is the square of the ratio of the step to that of the bound. */
gneiss_status gn_timestep_predict_masses(const gn_step_context *ctx, const gn_dem *dem,
                                         const gn_boundary *boundary, const gn_solids *solids,
                                         const gn_zones *zones, double step, double *of_bound,
                                         double *added, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const double limit = gn_limit_needed(ctx, dem, solids, zones, step / ctx->scene.safety);
    *of_bound = *added = INFINITY;
    if (!isfinite(limit)) return GNEISS_OK;
    double *factor = gn_alloc_array(q->soa.count + 1, sizeof *factor), most = 1.0, sum = 0.0;
    if (!factor)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu masses", q->soa.count);
    gneiss_status status =
        gn_timestep_masses(ctx, dem, boundary, false, limit, NULL, factor, error);
    for (size_t p = 0; status == GNEISS_OK && p < q->soa.count; p++) {
        if (!(q->vel[4 * p + 3] > 0.0)) continue;
        most = fmax(most, factor[p]);
        sum += (factor[p] - 1.0) * gn_own_share(q, p) / q->vel[4 * p + 3];
    }
    *of_bound = sqrt(most);
    *added = sum / dem->mass;
    gn_free(factor);
    return status;
}

gneiss_status gn_timestep_scale_masses(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    if (!(ctx->effects & GN_FX_MASS_SCALING)) return GNEISS_OK;
    wanted q = {.step = s->scaled_step > 0.0 ? s->scaled_step : s->scaled_factor * ctx->dt,
                .sharp = s->estimate == GN_STEP_SHARP};
    ctx->choice.scaling.unscaled = ctx->dt;
    if (q.step <= ctx->dt) return GNEISS_OK;
    double elements = gn_nonviscous_share(ctx) * gn_elements_stable(solids);
    q.limit = gn_limit_needed(ctx, dem, solids, zones, q.step / s->safety);
    q.listed = gn_limit_needed(ctx, dem, solids, zones, q.step / listed_share);
    if (s->safety * elements < q.step || !isfinite(q.limit))
        return refuse(ctx, solids, q.step, error);
    ctx->choice.scaling.step = q.step;
    gneiss_status status = make_room(dem, &q, error);
    if (status == GNEISS_OK) status = search(ctx, dem, boundary, solids, zones, ledger, &q, error);
    ctx->choice.scaling.reached = ctx->dt;
    gn_free(q.factor);
    gn_free(q.also);
    gn_free(q.own);
    return status;
}
