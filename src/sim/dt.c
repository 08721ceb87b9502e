/* Choosing the step and watching it. */
#include "base/memory.h"
#include "base/timer.h"
#include "sim/parts.h"

#include <math.h>
#include <string.h>

/* Arrays that the spectrum borrows. */
typedef struct spectrum_data {
    double *point, *stiffness, *damping;
    uint8_t *fixed;
    gn_extra_spring *surface;
    size_t surface_count;
} spectrum_data;

static void free_data(spectrum_data *d) {
    gn_free(d->point);
    gn_free(d->stiffness);
    gn_free(d->damping);
    gn_free(d->fixed);
    gn_free(d->surface);
}

static gneiss_status make_data(const gn_world *w, spectrum_data *d, gneiss_error *error) {
    size_t walls = w->scene.wall_count, n = w->particles.soa.count;
    d->point = gn_alloc_array(walls + 1, 4 * sizeof(double));
    d->stiffness = gn_alloc_array(walls + 1, 2 * sizeof(double));
    d->damping = gn_alloc_array(walls + 1, sizeof(double));
    d->fixed = w->prescribed.count ? gn_alloc(n + 1) : NULL;
    if (!d->point || !d->stiffness || !d->damping || (w->prescribed.count && !d->fixed)) {
        free_data(d);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stability estimate");
    }
    for (size_t k = 0; k < walls; k++) {
        const gn_wall_def *def = &w->scene.walls[k];
        memcpy(d->point + 4 * k, w->walls[k].point, 3 * sizeof(double));
        d->stiffness[2 * k] = def->stiffness;
        bool shear = w->effects & GN_FX_WALL_SHEAR && def->friction > 0.0 && def->kratio > 0.0;
        d->stiffness[2 * k + 1] = shear ? def->stiffness / def->kratio : 0.0;
        d->damping[k] = w->damping_fraction;
    }
    for (size_t p = 0; d->fixed && p < n; p++)
        d->fixed[p] = w->particles.slot[p] >= 0 ? w->prescribed.mask[w->particles.slot[p]] : 0;
    gneiss_status status = gn_surface_springs(w, &d->surface, &d->surface_count, error);
    if (status != GNEISS_OK) free_data(d);
    return status;
}

static gn_spectrum spectrum_of(const gn_world *w, const gn_assembly *assembly,
                               const spectrum_data *d) {
    gn_spectrum s = {0};
    s.assembly = assembly;
    s.arm_factor = w->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    s.wall_point = d->point;
    s.wall_stiffness = d->stiffness;
    s.wall_damping = d->damping;
    s.extra = d->surface;
    s.extra_count = d->surface_count;
    s.fixed = d->fixed;
    s.threads = w->threads;
    return s;
}

/* Without any spring in touch there is nothing to resolve yet: the stiffest possible contact of
 * each particle with its like sets the step (two ends, so 2 sqrt(m/2k) of the pair). */
static double free_flight_limit(const gn_world *w) {
    double least = INFINITY;
    const gn_particles *q = &w->particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (q->vel[4 * p + 3] == 0.0) continue;
        gn_contact_parameters c = gn_contact_law(w, (int32_t)p, (int32_t)p);
        double k = fmax(c.kn, 3.5 * c.kt); /* pair modes: 2 k_n/m, and 7 k_t/m with rolling */
        if (k > 0.0) least = fmin(least, 2.0 * sqrt(0.5 / (k * q->vel[4 * p + 3])));
        for (size_t s = 0; s < w->scene.wall_count; s++)
            least =
                fmin(least, 2.0 * sqrt(1.0 / (w->scene.walls[s].stiffness * q->vel[4 * p + 3])));
        for (size_t s = 0; s < w->surface_count; s++)
            least = fmin(least, 2.0 * sqrt(1.0 / (w->surfaces[s].stiffness * q->vel[4 * p + 3])));
    }
    double alpha = w->damping_fraction;
    return least * (sqrt(1.0 + alpha * alpha) - alpha);
}

/* Non-viscous damping of coefficient a multiplies the resultant by 1 + a while it slows a particle
 * down and by 1 - a while it speeds it up. In the fastest mode, whose displacement changes sign
 * from step to step, the resultant always slows down: its stiffness is 1 + a times the undamped
 * one, and the limit falls by sqrt(1 + a). (Seen in practice: at 0.9 of the undamped limit and a =
 * 0.7 the kinetic energy 1/2 m v(-) v(+) turns negative and bonds break before any load.) */
double gn_world_nonviscous_share(const gn_world *w) {
    bool active = w->effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT);
    return active ? 1.0 / sqrt(1.0 + w->scene.background_coefficient) : 1.0;
}

/* Of two parts with limits p and s (s), of which each is found with the other held fast, and
 * contacts between them. The energy of a contact |D^1/2 (x + y)|^2 <= (1 + e) |D^1/2 x|^2 + (1 +
 * 1/e) |D^1/2 y|^2 for any e > 0; with e = w_s^2/w_p^2 the square of the largest frequency of all
 * is at most w_p^2 + w_s^2. With dashpots, whose part of 4/dt^2 grows with 2/dt, the rates 1/dt add
 * up.
 */
static double together(const gn_world *w, double p, double s) {
    if (!isfinite(s)) return p;
    return w->damping_fraction > 0.0 ? 1.0 / (1.0 / p + 1.0 / s)
                                     : 1.0 / sqrt(1.0 / (p * p) + 1.0 / (s * s));
}

static double limit_of(double rate) {
    return rate > 0.0 ? 1.0 / rate : (double)INFINITY;
}

/* Particles, free bodies and finite elements; bodies and elements only meet particles. */
static double all_together(const gn_world *w, double share) {
    double particles = share * w->stable_particles, bodies = limit_of(w->surface_rate);
    double elements = w->elements ? share * w->elements->stable : (double)INFINITY;
    if (w->vertex_rate > 0.0) /* they touch */
        return together(w, particles,
                        fmin(bodies, together(w, elements, limit_of(w->vertex_rate))));
    return fmin(together(w, particles, bodies), elements);
}

/* The limit that the scene trusts: sharp, or the rigorous bound. Contacts that may still form are
 * covered by never going above what a single pair would need. */
static double usable_limit(gn_world *w) {
    double limit = w->scene.estimate == GN_STEP_BOUND ? w->limit.bound : w->limit.sharp;
    w->stable_particles =
        w->scene.has_specimen ? fmin(limit, free_flight_limit(w)) : (double)INFINITY;
    return all_together(w, gn_world_nonviscous_share(w));
}

/* Only the rigorous bound, or Lanczos as well; the former leaves the sharp value unknown. */
static gneiss_status estimate(const gn_world *w, bool sharp, gn_step_limit *limit,
                              gneiss_error *error) {
    gn_assembly assembly = gn_world_assembly(w);
    spectrum_data data = {0};
    GN_TRY(make_data(w, &data, error));
    gn_spectrum spectrum = spectrum_of(w, &assembly, &data);
    gneiss_status status = sharp ? gn_step_limits(&spectrum, 1e-3, limit, error)
                                 : gn_step_bound(&spectrum, limit, error);
    free_data(&data);
    return status;
}

/* Whether the rigorous bound settles it without Lanczos: the scene asks for it, or a given step is
 * below. */
static bool bound_suffices(const gn_world *w, double bound) {
    if (w->scene.estimate == GN_STEP_BOUND) return true;
    double limit = together(w, gn_world_nonviscous_share(w) * fmin(bound, free_flight_limit(w)),
                            limit_of(fmax(w->surface_rate, w->vertex_rate)));
    return w->scene.step > 0.0 && w->scene.step <= limit;
}

static gneiss_status find_limit(gn_world *w, const gn_step_limit *quick, gneiss_error *error) {
    if (!bound_suffices(w, quick->bound)) return estimate(w, true, &w->limit, error);
    w->limit = *quick;
    w->limit.sharp = quick->bound;
    w->limit.sharp_id = quick->bound_id;
    w->limit.iterations = 0;
    return GNEISS_OK;
}

/* What sets the limit. */
static const char *culprit(const gn_world *w, char *text, size_t size) {
    if (gn_elements_lead(w)) return gn_elements_culprit(w, text, size);
    snprintf(text, size, "particle %d",
             w->scene.estimate == GN_STEP_BOUND ? w->limit.bound_id : w->limit.sharp_id);
    return text;
}

static void set_step(gn_world *w, double dt) {
    if (w->dt == dt) return;
    w->dt = dt;
    gn_world_refresh_dashpots(w);
}

static gneiss_status react(gn_world *w, double limit, gneiss_error *error) {
    char text[160];
    if (w->scene.step == 0.0) {
        if (!isfinite(limit))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: time.step: required, because nothing can move that would limit it",
                           w->scene.source);
        double wanted = w->scene.safety * limit;
        /* Small changes of the stiffest mode are what the safety factor is for. */
        if (w->step > 0 && wanted > 0.97 * w->dt) return GNEISS_OK;
        if (w->step > 0) w->dt_lowered++;
        set_step(w, wanted);
        return GNEISS_OK;
    }
    set_step(w, w->scene.step);
    if (w->dt <= limit || w->scene.on_unstable == GN_POLICY_WARN) return GNEISS_OK;
    return gn_fail(
        error, w->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
        "%s: time.step: expected at most %.6g s (stability limit at step %lld, set by %s; the "
        "rigorous bound without damping is %.6g s), found %.6g s = %.3f of the limit "
        "(time.on_unstable: warn runs it all the same)",
        w->scene.source, limit, (long long)w->step, culprit(w, text, sizeof text),
        gn_world_bound(w), w->dt, w->dt / limit);
}

/* *due: the limit of the particles has changed. */
static gneiss_status particle_limit(gn_world *w, bool full, bool *due, gneiss_error *error) {
    gn_step_limit quick = {0};
    gneiss_status status = estimate(w, false, &quick, error);
    /* The rigorous bound falls with every contact that makes a particle stiffer. As long as it is
     * where it was when the limit was found, that limit holds within the safety factor. */
    double bodies = 0.0, vertices = 0.0;
    if (status == GNEISS_OK) status = gn_surfaces_rate(w, &bodies, &vertices, error);
    *due = full || quick.bound < 0.98 * w->limit.bound || bodies > 1.02 * w->surface_rate ||
           vertices > 1.02 * w->vertex_rate;
    if (*due) {
        w->surface_rate = bodies;
        w->vertex_rate = vertices;
    }
    if (status == GNEISS_OK && *due) status = find_limit(w, &quick, error);
    w->bound = quick.bound;
    return status;
}

gneiss_status gn_world_check_step(gn_world *w, bool full, gneiss_error *error) {
    double start = gn_now();
    bool due = false, elements_due = false;
    gneiss_status status = GNEISS_OK;
    if (w->scene.has_specimen) status = particle_limit(w, full, &due, error);
    if (status == GNEISS_OK && w->elements)
        status = gn_elements_limit(w, full, &elements_due, error);
    if (status == GNEISS_OK && (due || elements_due)) {
        w->stable = usable_limit(w);
        status = react(w, w->stable, error);
    }
    w->seconds[GN_PHASE_step_limit] += gn_now() - start;
    return status;
}
