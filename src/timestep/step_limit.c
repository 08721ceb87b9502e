/* Choice and supervision of the step that all parts allow together. */
#include "base/effects.h"
#include "base/error.h"
#include "base/timer.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>

/* Returns the limit of two parts with limits p and s (s), each found with the other one fixed, and
 * with contacts between them. The energy of a contact is |D^1/2 (x + y)|^2 <= (1 + e) |D^1/2 x|^2 +
 * (1 + 1/e) |D^1/2 y|^2 for any e > 0; with e = w_s^2/w_p^2 the square of the largest frequency of
 * both is at most w_p^2 + w_s^2. With dashpots, whose part of 4/dt^2 grows with 2/dt, the rates
 * 1/dt add up. */
static double together(const gn_dem *dem, double p, double s) {
    if (!isfinite(s)) return p;
    return dem->damping_fraction > 0.0 ? 1.0 / (1.0 / p + 1.0 / s)
                                       : 1.0 / sqrt(1.0 / (p * p) + 1.0 / (s * s));
}

static double limit_of(double rate) {
    return rate > 0.0 ? 1.0 / rate : (double)INFINITY;
}

/* Returns the limit due to slaved spins. These add to the square of the largest frequency of either
 * side a share of the square of the particles' frequency (zone_spins.c). Dashpots resist rotation
 * as well: if K + C r is at most r^2 for the rate r = 1/dt, then the rate (1 + share) r suffices
 * for both multiplied by 1 + share, and the rate r_F + share r together with elements of rate r_F.
 */
static double turned_limit(const gn_dem *dem, const gn_zones *zones, double particles) {
    const double share = zones->state.turned;
    if (!(share > 0.0)) return INFINITY;
    return particles / (dem->damping_fraction > 0.0 ? share : sqrt(share));
}

/* Returns the limit of the objects coupled to the particles: free bodies, finite elements that they
 * touch, springs of zones. */
static double partner_limit(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_zones *zones) {
    double bodies =
        together(dem, limit_of(ctx->choice.surface_rate), limit_of(zones->state.rate[0]));
    if (!(ctx->choice.vertex_rate > 0.0)) return bodies;
    double elements = gn_nonviscous_share(ctx) * gn_elements_stable(solids);
    return fmin(bodies, together(dem, elements, limit_of(ctx->choice.vertex_rate)));
}

/* Bodies and elements do not touch each other, so that each is combined with the particles alone.
 */
double gn_limit_of_all(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_zones *zones, double particles) {
    double share = gn_nonviscous_share(ctx), turned = turned_limit(dem, zones, share * particles);
    double elements =
        together(dem, share * gn_elements_stable(solids), limit_of(zones->state.rate[1]));
    return fmin(together(dem,
                         together(dem, share * particles, partner_limit(ctx, dem, solids, zones)),
                         turned),
                together(dem, elements, turned));
}

double gn_limit_beside_surfaces(const gn_step_context *ctx, const gn_dem *dem, double particles) {
    double rate = fmax(ctx->choice.surface_rate, ctx->choice.vertex_rate);
    return together(dem, gn_nonviscous_share(ctx) * particles, limit_of(rate));
}

/* Returns the part of a rate, 1/s, that remains if another object has the limit `other`. */
static double without(const gn_dem *dem, double rate, double other) {
    if (dem->damping_fraction > 0.0) return fmax(0.0, rate - 1.0 / other);
    return sqrt(fmax(0.0, rate * rate - 1.0 / (other * other)));
}

/* With slaved spins elements also limit the step, unless the limit of the coupled system is known.
 */
double gn_limit_needed(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_zones *zones, double step) {
    const double share = gn_nonviscous_share(ctx), own = turned_limit(dem, zones, 1.0);
    double left = without(dem, 1.0 / step, partner_limit(ctx, dem, solids, zones));
    if (isfinite(own)) left /= 1.0 / together(dem, 1.0, own);
    if (isfinite(own) && !(ctx->choice.whole > 0.0))
        left = fmin(left, own * without(dem, 1.0 / step, share * gn_elements_stable(solids)));
    return left > 0.0 ? 1.0 / (left * share) : (double)INFINITY;
}

/* Returns the limit of particles and elements as one system (coupled_limit.c), reduced by free
 * bodies, which yield to them, and by the largest factor by which strain has stiffened elements. */
static double limit_of_whole(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             double whole) {
    double stiffer = 1.0;
    for (size_t k = 0; k < solids->count; k++)
        stiffer = fmax(stiffer, solids->elements[k]->stiffening);
    return together(dem, gn_nonviscous_share(ctx) * whole / stiffer,
                    limit_of(ctx->choice.surface_rate));
}

/* Finds the limit of the active springs. The smaller one of the limits of the two separate systems
 * is a lower bound of that of the coupled system, which is computed where the step may exceed the
 * bound. Without an active spring the particles' limit is that of future contacts, which the
 * coupled system does not contain. */
static gneiss_status limit_now(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                               const gn_solids *solids, gn_zones *zones, double *limit,
                               gneiss_error *error) {
    *limit = gn_limit_of_all(ctx, dem, solids, zones,
                             ctx->scene.has_specimen ? ctx->choice.stable : INFINITY);
    if (!gn_coupled_has_limit(ctx, solids) || !(ctx->choice.limit.bound < INFINITY))
        return GNEISS_OK;
    if (ctx->scene.step > 0.0 && ctx->scene.step <= *limit) return GNEISS_OK;
    gn_whole_limit *whole = &zones->coupled->whole;
    GN_TRY(gn_coupled_limit(ctx, dem, boundary, solids, zones, false, whole, error));
    ctx->choice.whole = whole->sharp;
    *limit = fmax(*limit, limit_of_whole(ctx, dem, solids, whole->sharp));
    /* With slaved spins elements may be much smaller than the particles that rotate with them. */
    if (zones->state.turned > 0.0) *limit = fmin(*limit, gn_nonviscous_share(ctx) * whole->sharp);
    return GNEISS_OK;
}

/* --- choice of the step --- */

/* Names the particle, element or zone that sets the limit. */
static const char *name_limiting_part(const gn_step_context *ctx, const gn_solids *solids,
                                      const gn_zones *zones, char *text, size_t size) {
    const gn_element_model *lead = gn_timestep_elements_lead(ctx, solids, zones);
    const gn_whole_limit *whole = gn_coupled_whole(ctx, zones);
    if (whole) return gn_whole_culprit(whole, text, size);
    if (lead) return gn_elements_culprit(ctx, lead, text, size);
    int32_t id = ctx->scene.estimate == GN_STEP_BOUND ? ctx->choice.limit.bound_id
                                                      : ctx->choice.limit.sharp_id;
    if (id >= 0)
        snprintf(text, size, "particle %d", id);
    else
        snprintf(text, size, "a contact that may form");
    return text;
}

static void set_step(gn_step_context *ctx, gn_dem *dem, double dt) {
    if (ctx->dt == dt) return;
    ctx->dt = dt;
    gn_dem_step_changed(ctx, dem);
}

/* Reports that nothing determines an automatic step. */
static gneiss_status refuse_endless(const gn_step_context *ctx, const gn_dem *dem,
                                    gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    const gn_flow *f = &dem->flow;
    size_t source = 0, sink = 0;
    char key[48];
    while (source < s->source_count && !(f->sources[source].number > 0.0)) source++;
    while (sink < s->sink_count && !(f->sinks[sink].number > 0.0)) sink++;
    if (source == s->source_count || sink == s->sink_count || gn_dem_present_count(dem) > 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: required, because no moving part of the model limits it",
                       gn_scene_at(s, s->time_where, "time.step").text);
    snprintf(key, sizeof key, "sources[%zu]", source);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected particles that no sink removes on entry, found that sink '%s' "
                   "removes those of source '%s', so that no particle limits time.step",
                   gn_scene_at(s, s->sources[source].where, key).text, s->sinks[sink].name,
                   s->sources[source].name);
}

/* Returns the step of moving bodies, which limit it if there are no springs; INFINITY: there are no
 * bodies. It never increases during a run. */
static double step_of_bodies(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary) {
    double step = ctx->scene.has_specimen ? gn_bodies_step(ctx, dem, boundary) : (double)INFINITY;
    return ctx->step > 0 && isfinite(step) ? fmin(step, ctx->dt) : step;
}

/* Refuses a step below the precision of the time, with which the run would never end.
 * gn_check_duration is stricter at the start. */
static gneiss_status check_advance(const gn_step_context *ctx, const gn_solids *solids,
                                   const gn_zones *zones, gneiss_error *error) {
    char text[160];
    if (ctx->step == 0 || ctx->time + ctx->dt > ctx->time) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %.6g s: expected a time step that changes the time, found %.3g s "
        "(set by %s): check stiffnesses and masses",
        (long long)ctx->step, ctx->time, ctx->dt,
        name_limiting_part(ctx, solids, zones, text, sizeof text));
}

static gneiss_status react(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                           const gn_solids *solids, const gn_zones *zones, double limit,
                           gneiss_error *error) {
    char text[160], bound[96] = "";
    if (ctx->scene.step == 0.0) {
        double wanted = ctx->scene.safety * limit, raised_for = ctx->choice.scaling.step;
        if (!isfinite(limit)) wanted = step_of_bodies(ctx, dem, boundary);
        if (!isfinite(wanted)) return refuse_endless(ctx, dem, error);
        if (raised_for > 0.0) wanted = fmin(wanted, raised_for);
        /* The safety factor covers small changes of the fastest mode. */
        if (ctx->step > 0 && wanted > 0.97 * ctx->dt) return GNEISS_OK;
        if (ctx->step > 0) ctx->dt_lowered++;
        set_step(ctx, dem, wanted);
        return check_advance(ctx, solids, zones, error);
    }
    set_step(ctx, dem, ctx->scene.step);
    if (ctx->dt <= limit || ctx->scene.on_unstable == GN_POLICY_WARN) return GNEISS_OK;
    if (isfinite(gn_timestep_bound(ctx, dem, solids, zones)))
        snprintf(bound, sizeof bound, "; the rigorous bound without damping is %.6g s",
                 gn_timestep_bound(ctx, dem, solids, zones));
    return gn_fail(error, ctx->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
                   "%s: expected at most %.6g s (stability limit at step %lld, "
                   "set by %s%s), found %.6g s = %.3f of the limit "
                   "(time.on_unstable: warn runs it all the same)",
                   gn_scene_at(&ctx->scene, ctx->scene.time_where, "time.step").text, limit,
                   (long long)ctx->step, name_limiting_part(ctx, solids, zones, text, sizeof text),
                   bound, ctx->dt, ctx->dt / limit);
}

/* --- events before the next lists --- */

void gn_timestep_lower(gn_step_context *ctx, gn_dem *dem, double dt) {
    if (ctx->scene.step > 0.0 || ctx->dt <= dt) return;
    if (ctx->step > 0) ctx->dt_lowered++;
    set_step(ctx, dem, dt);
}

void gn_timestep_follow_bodies(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary) {
    double dt = ctx->dt;
    if (ctx->scene.step > 0.0 || !ctx->scene.has_specimen) return;
    gn_bodies_follow(ctx, dem, boundary, &dt);
    gn_walls_follow(ctx, dem, boundary, &dt);
    gn_timestep_lower(ctx, dem, dt);
}

static gneiss_status resolve_listed(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                                    const gn_solids *solids, const gn_zones *zones,
                                    gneiss_error *error) {
    bool shorter;
    GN_TRY(gn_timestep_resolve_listed(ctx, dem, boundary, solids, zones, &shorter, error));
    if (shorter) gn_timestep_lower(ctx, dem, ctx->choice.resolution.step);
    return check_advance(ctx, solids, zones, error);
}

static gneiss_status check_rotated(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                   gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                   gneiss_error *error) {
    bool due;
    GN_TRY(gn_timestep_limit_turned(ctx, dem, boundary, solids, zones, ledger, &due, error));
    if (!due) return GNEISS_OK;
    GN_TRY(limit_now(ctx, dem, boundary, solids, zones, &ctx->stable, error));
    if (ctx->dt <= GN_TURNED_SHARE * ctx->stable) return GNEISS_OK;
    return react(ctx, dem, boundary, solids, zones, ctx->stable, error);
}

/* Returns the largest squared speed before the first step, which computes it itself later. */
static double fastest2(const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double most = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        most = fmax(most, gn_dot3(q->vel + 4 * p, q->vel + 4 * p));
    return most;
}

/* Returns the largest speed, m/s, of the farthest vertices of bodies; prescribed velocities count
 * before the first step too. */
static double fastest_body(const gn_step_context *ctx, const gn_boundary *boundary) {
    double most = 0.0;
    for (size_t k = 0; k < ctx->scene.body_count; k++) {
        const gn_rigid *b = &boundary->bodies[k];
        const gn_motion *m = &ctx->scene.bodies[k].motion;
        double v[3], spin[3];
        for (int a = 0; a < 3; a++) {
            v[a] = m->velocity[a].count ? gn_table_at(&m->velocity[a], ctx->time) : b->velocity[a];
            spin[a] = m->spin[a].count ? gn_table_at(&m->spin[a], ctx->time) : b->spin[a];
        }
        most = fmax(most, sqrt(gn_dot3(v, v)) + sqrt(gn_dot3(spin, spin)) * b->reach);
    }
    return most;
}

/* Lowers the step so that particles move by at most a tenth of the smallest radius in it, including
 * particles that begin to fall. By Hertz's law springs do not limit an automatic step before
 * contact, and speeds may have grown since the last lists. */
static void follow_flight(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary) {
    const double most = 0.1 * dem->radius_min;
    double speed = sqrt(ctx->step > 0 ? dem->done.motion.speed2 : fastest2(dem));
    if (ctx->effects & GN_FX_HERTZ)
        speed = fmax(speed, fastest_body(ctx, boundary)) + ctx->choice.gain;
    if (!(ctx->effects & GN_FX_HERTZ)) return;
    double fall = sqrt(gn_dot3(ctx->scene.gravity, ctx->scene.gravity));
    if (ctx->dt * ctx->dt * fall > most) gn_timestep_lower(ctx, dem, sqrt(0.5 * most / fall));
    if (ctx->dt * speed > most) gn_timestep_lower(ctx, dem, 0.5 * most / speed);
}

/* Called if the step is not stable for the particles alone with all listed contacts: checks it for
 * the coupled system, where it may be. */
static gneiss_status check_whole(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                                 const gn_solids *solids, gn_zones *zones, bool *fine,
                                 gneiss_error *error) {
    gn_whole_limit whole;
    if (!gn_coupled_has_limit(ctx, solids) || !(ctx->choice.whole > 0.0)) return GNEISS_OK;
    GN_TRY(gn_coupled_limit(ctx, dem, boundary, solids, zones, true, &whole, error));
    ctx->choice.listed = fmax(ctx->choice.listed, limit_of_whole(ctx, dem, solids, whole.sharp));
    double needed = gn_limit_needed(ctx, dem, solids, zones, ctx->dt / 0.99);
    *fine = ctx->dt <= 0.99 * ctx->choice.listed;
    if (*fine && isfinite(needed))
        ctx->choice.listed_holds = needed; /* from now on only changes have to be checked */
    return GNEISS_OK;
}

/* Computes the limit again after nodes have lost mass because particles were removed. */
static gneiss_status check_lighter(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                                   const gn_solids *solids, gn_zones *zones, gneiss_error *error) {
    if (!(ctx->choice.whole < 0.0)) return GNEISS_OK;
    ctx->choice.whole = 0.0;
    GN_TRY(limit_now(ctx, dem, boundary, solids, zones, &ctx->stable, error));
    return react(ctx, dem, boundary, solids, zones, ctx->stable, error);
}

static gneiss_status check_lists(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                 gn_solids *solids, gn_zones *zones, gn_ledger *ledger, bool full,
                                 bool *fine, gneiss_error *error) {
    *fine = true;
    if (!ctx->scene.has_specimen) return GNEISS_OK;
    GN_TRY(check_lighter(ctx, dem, boundary, solids, zones, error));
    gn_pressed_update(ctx, dem, boundary);
    follow_flight(ctx, dem, boundary);
    gn_timestep_follow_bodies(ctx, dem, boundary);
    GN_TRY(resolve_listed(ctx, dem, boundary, solids, zones, error));
    if (!full) GN_TRY(gn_timestep_limit_far(ctx, dem, boundary, solids, zones, fine, error));
    if (!full && *fine) return GNEISS_OK; /* the springs of the last check remain the reference */
    GN_TRY(check_rotated(ctx, dem, boundary, solids, zones, ledger, error));
    GN_TRY(gn_timestep_limit_listed(ctx, dem, boundary, solids, zones, ledger, full, fine, error));
    if (!*fine) GN_TRY(check_whole(ctx, dem, boundary, solids, zones, fine, error));
    /* Leaves a margin of two hundredths, so that the next lists need not lower the step again. */
    if (!*fine) gn_timestep_lower(ctx, dem, 0.98 * ctx->choice.listed);
    return check_advance(ctx, solids, zones, error);
}

gneiss_status gn_timestep_check_lists(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                      gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                      gneiss_error *error) {
    double start = gn_now();
    gn_ranks_whole(ctx->ranks);
    bool fine = true;
    gneiss_status status =
        check_lists(ctx, dem, boundary, solids, zones, ledger, false, &fine, error);
    ctx->seconds[GN_PHASE_step_limit] += gn_now() - start;
    /* A given step is compared only with contacts that have formed, not with those that may form.
     */
    if (status != GNEISS_OK || fine || ctx->scene.step == 0.0) return status;
    return gn_timestep_check(ctx, dem, boundary, solids, zones, ledger, false, error);
}

/* Chooses the step as at the start: by listed contacts, or by the whole scene if there are none. */
static gneiss_status check_anew(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                gneiss_error *error) {
    bool fine, shorter;
    gn_timestep_limit_anew(ctx);
    GN_TRY(check_lists(ctx, dem, boundary, solids, zones, ledger, true, &fine, error));
    if (!ctx->scene.has_specimen) return GNEISS_OK;
    GN_TRY(gn_timestep_resolve_flight(ctx, dem, boundary, &shorter, error));
    if (shorter) gn_timestep_lower(ctx, dem, ctx->choice.resolution.step);
    return GNEISS_OK;
}

gneiss_status gn_timestep_check(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                gn_solids *solids, gn_zones *zones, gn_ledger *ledger, bool full,
                                gneiss_error *error) {
    double start = gn_now();
    gn_ranks_whole(ctx->ranks);
    bool due = false, elements_due = false, turn_faster = false;
    gneiss_status status = GNEISS_OK;
    if (ctx->scene.has_specimen) gn_pressed_update(ctx, dem, boundary);
    if (ctx->scene.has_specimen)
        status = gn_timestep_particle_limit(ctx, dem, boundary, solids, zones, ledger, full, &due,
                                            error);
    if (status == GNEISS_OK) status = gn_elements_limit(ctx, solids, full, &elements_due, error);
    if (status == GNEISS_OK && full && ctx->step == 0) gn_coupled_stiffen(ctx, dem, solids, zones);
    if (status == GNEISS_OK)
        status = gn_coupled_turn_faster(ctx, dem, solids, zones, &turn_faster, error);
    due |= turn_faster;
    if (status == GNEISS_OK && (due || elements_due)) {
        status = limit_now(ctx, dem, boundary, solids, zones, &ctx->stable, error);
        if (status == GNEISS_OK)
            status = react(ctx, dem, boundary, solids, zones, ctx->stable, error);
    }
    /* Collisions of loose particles are resolved here too, because the lists may stay for long. */
    if (status == GNEISS_OK && !full && ctx->scene.has_specimen)
        status = resolve_listed(ctx, dem, boundary, solids, zones, error);
    /* Lists are not checked with a vanishing step. */
    if (status == GNEISS_OK && full) status = gn_check_duration(ctx, error);
    if (status == GNEISS_OK && full)
        status = check_anew(ctx, dem, boundary, solids, zones, ledger, error);
    ctx->seconds[GN_PHASE_step_limit] += gn_now() - start;
    return status;
}

static gneiss_status check_again(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                 gn_solids *solids, gn_zones *zones, gneiss_error *error) {
    double start = gn_now();
    gn_ranks_whole(ctx->ranks);
    gneiss_status status = resolve_listed(ctx, dem, boundary, solids, zones, error);
    ctx->seconds[GN_PHASE_step_limit] += gn_now() - start;
    return status;
}

gneiss_status gn_timestep_check_debris(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       gneiss_error *error) {
    if (!gn_debris_exceeds_ledger(ledger)) return GNEISS_OK;
    ctx->choice.debris_reported = true;
    gneiss_status status = check_again(ctx, dem, boundary, solids, zones, error);
    ctx->choice.debris_reported = false;
    return status;
}

/* Called because lists that stay for long would notice unbonded debris late. If collisions are not
 * damped, the step is checked whenever another sixteenth of the bonds has broken, beginning with
 * half of them. */
gneiss_status gn_timestep_check_after_breaks(gn_step_context *ctx, gn_dem *dem,
                                             gn_boundary *boundary, gn_solids *solids,
                                             gn_zones *zones, int64_t broken_before,
                                             gneiss_error *error) {
    const int64_t all = dem->bonds_at_start, now = dem->broken_tension + dem->broken_shear;
    if (now == broken_before || 2 * now < all || !gn_timestep_is_underdamped(ctx, dem))
        return GNEISS_OK;
    if (now < all && 16 * now / all == 16 * broken_before / all) return GNEISS_OK;
    return check_again(ctx, dem, boundary, solids, zones, error);
}

gneiss_status gn_timestep_update_reported_limit(gn_step_context *ctx, gn_dem *dem,
                                                gn_boundary *boundary, gn_solids *solids,
                                                gn_zones *zones, gn_ledger *ledger,
                                                gneiss_error *error) {
    bool due;
    if (!ctx->scene.has_specimen || solids->count || ctx->effects & GN_FX_BONDS) return GNEISS_OK;
    GN_TRY(
        gn_timestep_particle_limit(ctx, dem, boundary, solids, zones, ledger, true, &due, error));
    return limit_now(ctx, dem, boundary, solids, zones, &ctx->stable, error);
}

double gn_timestep_sharp_limit(const gn_step_context *ctx, const gn_solids *solids) {
    if (ctx->choice.whole > 0.0) return ctx->choice.whole;
    double limit = ctx->scene.has_specimen ? ctx->choice.limit.sharp : INFINITY;
    for (size_t k = 0; k < solids->count; k++)
        limit = fmin(limit, solids->elements[k]->limit.sharp);
    return limit;
}

double gn_timestep_bound(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                         const gn_zones *zones) {
    double limit = ctx->scene.has_specimen ? ctx->choice.limit.bound : INFINITY,
           elements = INFINITY;
    for (size_t k = 0; k < solids->count; k++)
        elements = fmin(elements, solids->elements[k]->limit.bound);
    const double turned = turned_limit(dem, zones, limit);
    return fmin(together(dem, together(dem, limit, limit_of(zones->state.rate[0])), turned),
                together(dem, together(dem, elements, limit_of(zones->state.rate[1])), turned));
}

const char *gn_timestep_warning(const gn_step_context *ctx, char *text, size_t size) {
    char contact[160];
    *text = '\0';
    if (ctx->scene.step == 0.0) return text;
    if (ctx->dt > ctx->choice.resolution.step)
        snprintf(text, size,
                 "time.step: %.6g s does not resolve collisions: that of %s lasts %.6g s = %.1f "
                 "steps, expected at least %.1f (time.contact_steps)",
                 ctx->dt, gn_resolution_text(ctx, contact, sizeof contact),
                 ctx->choice.resolution.contact, ctx->choice.resolution.contact / ctx->dt,
                 ctx->choice.resolution.contact / ctx->choice.resolution.step);
    else if (ctx->dt > ctx->choice.listed)
        snprintf(text, size,
                 "time.step: %.6g s is above %.6g s, the stability limit with all contacts in "
                 "touch that are near",
                 ctx->dt, ctx->choice.listed);
    return text;
}
