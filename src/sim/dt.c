/* Choosing the step and watching it. */
#include "base/memory.h"
#include "base/timer.h"
#include "sim/parts.h"

#include <float.h>
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

static gneiss_status make_data(const gn_world *w, double reach, spectrum_data *d,
                               gneiss_error *error) {
    size_t walls = w->scene.wall_count, n = w->dem.particles.soa.count;
    d->point = gn_alloc_array(walls + 1, 4 * sizeof(double));
    d->stiffness = gn_alloc_array(walls + 1, 2 * sizeof(double));
    d->damping = gn_alloc_array(walls + 1, sizeof(double));
    d->fixed = w->dem.prescribed.count ? gn_alloc(n + 1) : NULL;
    if (!d->point || !d->stiffness || !d->damping || (w->dem.prescribed.count && !d->fixed)) {
        free_data(d);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stability estimate");
    }
    for (size_t k = 0; k < walls; k++) {
        const gn_wall_def *def = &w->scene.walls[k];
        memcpy(d->point + 4 * k, w->boundary.walls[k].point, 3 * sizeof(double));
        d->stiffness[2 * k] = def->stiffness;
        bool shear = w->effects & GN_FX_WALL_SHEAR && def->friction > 0.0 && def->kratio > 0.0;
        d->stiffness[2 * k + 1] = shear ? def->stiffness / def->kratio : 0.0;
        d->damping[k] = w->dem.damping_fraction;
    }
    for (size_t p = 0; d->fixed && p < n; p++)
        d->fixed[p] =
            w->dem.particles.slot[p] >= 0 ? w->dem.prescribed.mask[w->dem.particles.slot[p]] : 0;
    gneiss_status status = gn_surface_springs(w, reach, &d->surface, &d->surface_count, error);
    if (status != GNEISS_OK) free_data(d);
    return status;
}

static gn_spectrum spectrum_of(const gn_world *w, double reach, const gn_assembly *assembly,
                               const spectrum_data *d) {
    gn_spectrum s = {.reach = reach};
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
    return w->dem.damping_fraction > 0.0 ? 1.0 / (1.0 / p + 1.0 / s)
                                         : 1.0 / sqrt(1.0 / (p * p) + 1.0 / (s * s));
}

static double limit_of(double rate) {
    return rate > 0.0 ? 1.0 / rate : (double)INFINITY;
}

/* What particles are coupled to: free bodies, and finite elements that they touch. */
static double partner_limit(const gn_world *w) {
    double bodies = limit_of(w->boundary.surface_rate);
    if (!(w->boundary.vertex_rate > 0.0)) return bodies;
    double elements = gn_world_nonviscous_share(w) * gn_elements_stable(w);
    return fmin(bodies, together(w, elements, limit_of(w->boundary.vertex_rate)));
}

/* Of all, from the limit of the particles alone; bodies and elements only meet particles. */
static double all_together(const gn_world *w, double particles) {
    double share = gn_world_nonviscous_share(w);
    double elements = share * gn_elements_stable(w);
    return fmin(together(w, share * particles, partner_limit(w)), elements);
}

/* The other way round: the limit of the particles at which `step` is that of all; INFINITY: none
 * would do. */
static double particles_needed(const gn_world *w, double step) {
    double other = partner_limit(w), left = 1.0 / step;
    if (w->dem.damping_fraction > 0.0)
        left -= 1.0 / other;
    else
        left = sqrt(fmax(0.0, left * left - 1.0 / (other * other)));
    return left > 0.0 ? 1.0 / (left * gn_world_nonviscous_share(w)) : (double)INFINITY;
}

/* --- the particles --- */

/* Relative residual of Lanczos. */
static double tolerance_of(const gn_world *w) {
    return w->scene.estimate == GN_STEP_BOUND ? 0.0 : 1e-3;
}

/* What is asked of the springs that act now, or that may before the lists are made again. */
typedef struct question {
    double step;          /* s; 0: what is the limit? else: does it hold? */
    double tolerance;     /* of Lanczos; 0: bounds alone */
    gn_step_limit *limit; /* answers */
    gn_step_verdict *verdict;
    bool changed;          /* only what has others than at the last look needs to be looked at */
    const uint8_t *turned; /* [particles] only these and their neighbours; NULL: see `changed` */
} question;

/* Between two lists contacts turn by some more: by the skin over a diameter, at most. */
static const double turned_by = 0.05, turned_share = 0.95;

/* Which particles have other springs than at the last look; keeps in mind what they have. `which`
 * 0: that act, 1: that are near. */
static gneiss_status find_changed(const gn_spectrum *spectrum, int which, uint8_t *changed,
                                  size_t *count, gneiss_error *error) {
    const gn_particles *q = spectrum->assembly->particles;
    size_t n = q->soa.count;
    int32_t *marks = gn_alloc_array(n + 1, sizeof *marks);
    if (!marks) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    gn_step_marks(spectrum, marks);
    *count = 0;
    for (size_t p = 0; p < n; p++) {
        changed[p] = q->marks[2 * p + (size_t)which] != marks[p];
        *count += changed[p];
        q->marks[2 * p + (size_t)which] = marks[p];
    }
    gn_free(marks);
    return GNEISS_OK;
}

static gneiss_status holds(const gn_spectrum *spectrum, const question *q, gneiss_error *error) {
    size_t count = 0, n = spectrum->assembly->particles->soa.count;
    uint8_t *changed = gn_alloc(n + 1);
    if (!changed) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    gneiss_status status = find_changed(spectrum, spectrum->reach > 0.0, changed, &count, error);
    *q->verdict = (gn_step_verdict){.holds = true};
    if (status == GNEISS_OK && (!q->changed || count > 0))
        status = gn_step_holds(spectrum, q->step, q->tolerance, q->changed ? changed : NULL,
                               q->verdict, error);
    gn_free(changed);
    return status;
}

static gneiss_status answer(const gn_spectrum *spectrum, const question *q, gneiss_error *error) {
    if (q->turned)
        return gn_step_holds(spectrum, q->step, q->tolerance, q->turned, q->verdict, error);
    if (q->step > 0.0) return holds(spectrum, q, error);
    return gn_step_limits(spectrum, q->tolerance, q->limit, error);
}

static gneiss_status ask(const gn_world *w, bool listed, const question *q, gneiss_error *error) {
    gn_assembly assembly = gn_world_assembly(w);
    spectrum_data data = {0};
    double reach = listed ? w->dem.verlet.skin : 0.0;
    GN_TRY(make_data(w, reach, &data, error));
    gn_spectrum spectrum = spectrum_of(w, reach, &assembly, &data);
    gneiss_status status = answer(&spectrum, q, error);
    free_data(&data);
    return status;
}

/* Whether the rigorous bound settles it without Lanczos: the scene asks for it, or a given step is
 * below. */
static bool bound_suffices(const gn_world *w, double bound) {
    if (w->scene.estimate == GN_STEP_BOUND || bound == INFINITY) return true;
    double limit = together(w, gn_world_nonviscous_share(w) * bound,
                            limit_of(fmax(w->boundary.surface_rate, w->boundary.vertex_rate)));
    return w->scene.step > 0.0 && w->scene.step <= limit;
}

static gneiss_status find_limit(gn_world *w, gneiss_error *error) {
    gn_step_limit quick = {0};
    GN_TRY(ask(w, false, &(question){.limit = &quick}, error));
    if (!bound_suffices(w, quick.bound))
        return ask(w, false, &(question){.tolerance = 1e-3, .limit = &w->dem.limit}, error);
    w->dem.limit = quick;
    w->dem.limit.sharp = quick.bound;
    w->dem.limit.sharp_id = quick.bound_id;
    w->dem.limit.iterations = 0;
    return GNEISS_OK;
}

static double trusted(const gn_world *w, const gn_step_limit *limit) {
    return w->scene.estimate == GN_STEP_BOUND ? limit->bound : limit->sharp;
}

/* The limit that the scene trusts, of the springs that act. Without any, of all that the lists
 * hold; without any of those, of one contact of the pair of particles, or particle and wall, that
 * is worst of all. The last only has to give a step to start with: whatever comes near is listed,
 * and looked at as it is, before it touches (gn_world_check_lists). */
static gneiss_status usable_limit(const gn_world *w, double *limit, gneiss_error *error) {
    gn_step_limit listed = {0};
    gn_resolution unused;
    *limit = trusted(w, &w->dem.limit);
    if (*limit < INFINITY) return GNEISS_OK;
    GN_TRY(ask(w, true, &(question){.tolerance = tolerance_of(w), .limit = &listed}, error));
    *limit = trusted(w, &listed);
    if (*limit < INFINITY) return GNEISS_OK;
    return gn_flight_limits(w, limit, &unused, error);
}

/* What sets the limit. */
static const char *culprit(const gn_world *w, char *text, size_t size) {
    const gn_element_model *lead = gn_elements_lead(w);
    if (lead) return gn_elements_culprit(w, lead, text, size);
    int32_t id = w->scene.estimate == GN_STEP_BOUND ? w->dem.limit.bound_id : w->dem.limit.sharp_id;
    if (id >= 0)
        snprintf(text, size, "particle %d", id);
    else
        snprintf(text, size, "a contact that may form");
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
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "%s:%d:%d: time.step: required, because nothing can move that would limit it",
                w->scene.source, w->scene.time_where.line, w->scene.time_where.column);
        double wanted = w->scene.safety * limit;
        /* Small changes of the stiffest mode are what the safety factor is for. */
        if (w->step > 0 && wanted > 0.97 * w->dt) return GNEISS_OK;
        if (w->step > 0) w->dt_lowered++;
        set_step(w, wanted);
        return GNEISS_OK;
    }
    set_step(w, w->scene.step);
    if (w->dt <= limit || w->scene.on_unstable == GN_POLICY_WARN) return GNEISS_OK;
    return gn_fail(error, w->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
                   "%s:%d:%d: time.step: expected at most %.6g s (stability limit at step %lld, "
                   "set by %s; the "
                   "rigorous bound without damping is %.6g s), found %.6g s = %.3f of the limit "
                   "(time.on_unstable: warn runs it all the same)",
                   w->scene.source, w->scene.time_where.line, w->scene.time_where.column, limit,
                   (long long)w->step, culprit(w, text, sizeof text), gn_world_bound(w), w->dt,
                   w->dt / limit);
}

/* Whether springs that have come to act since the last look take the limit down. Without any at
 * that look, any will do. */
static gneiss_status limit_fell(gn_world *w, bool *fell, gneiss_error *error) {
    double known = trusted(w, &w->dem.limit);
    gn_step_verdict verdict = {0};
    question q = {
        .step = known < INFINITY ? 0.95 * known : DBL_MAX, .verdict = &verdict, .changed = true};
    GN_TRY(ask(w, false, &q, error));
    *fell = !verdict.holds;
    return GNEISS_OK;
}

/* *due: the limit of the particles has changed. */
static gneiss_status particle_limit(gn_world *w, bool full, bool *due, gneiss_error *error) {
    double bodies = 0.0, vertices = 0.0;
    bool fell = full;
    if (!full) GN_TRY(limit_fell(w, &fell, error));
    GN_TRY(gn_surfaces_rate(w, &bodies, &vertices, error));
    *due = fell || bodies > 1.02 * w->boundary.surface_rate ||
           vertices > 1.02 * w->boundary.vertex_rate;
    if (!*due) return GNEISS_OK;
    w->boundary.surface_rate = bodies;
    w->boundary.vertex_rate = vertices;
    if (fell) GN_TRY(find_limit(w, error));
    return usable_limit(w, &w->dem.stable, error);
}

/* --- what may happen before the lists are made again --- */

static void lower(gn_world *w, double dt) {
    if (w->scene.step > 0.0 || w->dt <= dt) return;
    if (w->step > 0) w->dt_lowered++;
    set_step(w, dt);
}

/* Whether the step holds with everything in touch that the lists hold; a hundredth is left for
 * normals and arms that turn until then. An automatic step is lowered at once, to two hundredths so
 * that the next lists need not lower it again. */
static gneiss_status listed_limit(gn_world *w, bool full, bool *fine, gneiss_error *error) {
    gn_step_limit limit = {0};
    gn_step_verdict verdict = {0};
    double needed = particles_needed(w, w->dt / 0.99);
    *fine = false; /* of a given step it is known for good */
    if (!full && w->scene.step > 0.0 && w->dt > w->dem.listed) return GNEISS_OK;
    /* More is asked of the particles than they have been found to hold, since bodies give way more.
     */
    bool all = full || needed > w->dem.listed_holds, finite = needed < INFINITY;
    question q = {.tolerance = all || !finite ? tolerance_of(w) : 0.0};
    if (finite) {
        q.step = needed;
        q.verdict = &verdict;
        q.changed = !all;
    } else {
        q.limit = &limit;
    }
    GN_TRY(ask(w, true, &q, error));
    *fine = finite && verdict.holds;
    if (*fine && all) w->dem.listed_holds = needed;
    if (*fine) return GNEISS_OK;
    w->dem.listed_holds = finite ? verdict.limit : trusted(w, &limit);
    w->dem.listed = all_together(w, w->dem.listed_holds);
    lower(w, 0.98 * w->dem.listed);
    return GNEISS_OK;
}

static void resolve(gn_world *w, gn_resolution r) {
    if (r.step >= w->dem.resolution.step) return;
    w->dem.resolution = r;
    lower(w, r.step);
}

static gneiss_status resolve_listed(gn_world *w, gneiss_error *error) {
    gn_resolution resolution;
    GN_TRY(gn_loose_find(w, error));
    GN_TRY(gn_resolution_listed(w, &resolution, error));
    resolve(w, resolution);
    return GNEISS_OK;
}

/* Marks the particles whose contacts with others have turned since the step was last looked at. */
static size_t find_turned(const gn_world *w, uint8_t *turned) {
    gn_assembly assembly = gn_world_assembly(w);
    gn_spectrum spectrum = spectrum_of(w, 0.0, &assembly, &(spectrum_data){0});
    return gn_step_turned(&spectrum, turned_by, turned);
}

/* Whether the step holds for what has turned, with a reserve for what turns until the next lists.
 */
static gneiss_status turned_hold(const gn_world *w, const uint8_t *turned, bool *hold,
                                 gneiss_error *error) {
    gn_step_verdict verdict = {0};
    double needed = particles_needed(w, w->dt / turned_share);
    question q = {.step = needed < INFINITY ? needed : DBL_MAX,
                  .tolerance = tolerance_of(w),
                  .verdict = &verdict,
                  .turned = turned};
    gneiss_status status = ask(w, false, &q, error);
    *hold = verdict.holds;
    return status;
}

/* Springs that turn against each other have another limit though they are the same: a bonded chain
 * that is stretched out needs a smaller step than one at a right angle. Where the step does not
 * hold for sure, the limit of all is found anew. */
static gneiss_status look_at_turned(gn_world *w, gneiss_error *error) {
    bool hold = true;
    double limit;
    uint8_t *turned = gn_alloc(w->dem.particles.soa.count + 1);
    if (!turned) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stability estimate");
    gneiss_status status = GNEISS_OK;
    if (find_turned(w, turned)) status = turned_hold(w, turned, &hold, error);
    gn_free(turned);
    if (status != GNEISS_OK || hold) return status;
    GN_TRY(find_limit(w, error));
    GN_TRY(usable_limit(w, &limit, error));
    w->dem.stable = limit;
    w->stable = all_together(w, limit);
    if (w->dt <= turned_share * w->stable) return GNEISS_OK;
    return react(w, w->stable, error);
}

static gneiss_status check_lists(gn_world *w, bool full, bool *fine, gneiss_error *error) {
    *fine = true;
    if (!w->scene.has_specimen) return GNEISS_OK;
    GN_TRY(resolve_listed(w, error));
    GN_TRY(look_at_turned(w, error));
    return listed_limit(w, full, fine, error);
}

gneiss_status gn_world_check_lists(gn_world *w, gneiss_error *error) {
    double start = gn_now();
    bool fine = true;
    gneiss_status status = check_lists(w, false, &fine, error);
    w->seconds[GN_PHASE_step_limit] += gn_now() - start;
    /* A given step is not held against what may form, but then against what has. */
    if (status != GNEISS_OK || fine || w->scene.step == 0.0) return status;
    return gn_world_check_step(w, false, error);
}

/* As at the start: from what is near, or from what the scene holds when there is nothing near. */
static gneiss_status check_anew(gn_world *w, gneiss_error *error) {
    bool fine;
    w->dem.listed = INFINITY;
    w->dem.resolution = (gn_resolution){INFINITY, INFINITY, -1, -1};
    GN_TRY(check_lists(w, true, &fine, error));
    if (!w->scene.has_specimen || w->dem.resolution.step < INFINITY) return GNEISS_OK;
    gn_resolution flight;
    double unused;
    GN_TRY(gn_flight_limits(w, &unused, &flight, error));
    resolve(w, flight);
    return GNEISS_OK;
}

gneiss_status gn_world_check_step(gn_world *w, bool full, gneiss_error *error) {
    double start = gn_now();
    bool due = false, elements_due = false;
    gneiss_status status = GNEISS_OK;
    if (w->scene.has_specimen) GN_TRY(gn_loose_find(w, error));
    if (w->scene.has_specimen) status = particle_limit(w, full, &due, error);
    if (status == GNEISS_OK) status = gn_elements_limit(w, full, &elements_due, error);
    if (status == GNEISS_OK && (due || elements_due)) {
        if (!w->scene.has_specimen) w->dem.stable = INFINITY;
        w->stable = all_together(w, w->dem.stable);
        status = react(w, w->stable, error);
    }
    /* What rattles or has come apart in lists that stand for long. */
    if (status == GNEISS_OK && !full && w->scene.has_specimen) status = resolve_listed(w, error);
    /* A step of next to nothing is no step to look at lists with. */
    if (status == GNEISS_OK && full) status = gn_world_check_duration(w, error);
    if (status == GNEISS_OK && full) status = check_anew(w, error);
    w->seconds[GN_PHASE_step_limit] += gn_now() - start;
    return status;
}

double gn_world_sharp_limit(const gn_world *w) {
    double limit = w->scene.has_specimen ? w->dem.limit.sharp : INFINITY;
    for (size_t k = 0; k < w->element_count; k++) limit = fmin(limit, w->elements[k]->limit.sharp);
    return limit;
}

double gn_world_bound(const gn_world *w) {
    double limit = w->scene.has_specimen ? w->dem.limit.bound : INFINITY;
    for (size_t k = 0; k < w->element_count; k++) limit = fmin(limit, w->elements[k]->limit.bound);
    return limit;
}

const char *gn_world_step_warning(const gn_world *w, char *text, size_t size) {
    char who[160];
    *text = '\0';
    if (w->scene.step == 0.0) return text;
    if (w->dt > w->dem.resolution.step)
        snprintf(text, size,
                 "time.step: %.6g s does not resolve collisions: that of %s lasts %.6g s = %.1f "
                 "steps, expected at least %.1f (time.contact_steps)",
                 w->dt, gn_resolution_text(w, who, sizeof who), w->dem.resolution.contact,
                 w->dem.resolution.contact / w->dt,
                 w->dem.resolution.contact / w->dem.resolution.step);
    else if (w->dt > w->dem.listed)
        snprintf(text, size,
                 "time.step: %.6g s is above %.6g s, the stability limit with all contacts in "
                 "touch that are near",
                 w->dt, w->dem.listed);
    return text;
}
