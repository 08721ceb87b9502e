/* The step that the particles allow: with the active springs, with those that may become active
 * before the lists are rebuilt, and for collisions. */
#include "base/error.h"
#include "base/new.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "frame/frame.h"
#include "limit/equilibrium.h"
#include "limit/step_limits.h"
#include "measure/measure.h"
#include "particles/depth.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"
#include "zones/zone_state.h"

#include <math.h>
#include <string.h>

/* Arrays to which the spectrum refers. */
typedef struct spectrum_data {
    double *point, *damping;
    gn_touch_side *side;
    uint8_t *fixed;
    gn_extra_spring *surface;
    size_t surface_count;
} spectrum_data;

static void free_data(spectrum_data *d) {
    gn_free(d->point);
    gn_free(d->side);
    gn_free(d->damping);
    gn_free(d->fixed);
    gn_free(d->surface);
}

static gneiss_status make_data(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double reach, spectrum_data *d,
                               gneiss_error *error) {
    size_t walls = ctx->scene.wall_count, n = dem->particles.soa.count;
    size_t materials = ctx->scene.material_count;
    d->point = gn_alloc_array(walls + 1, 4 * sizeof(double));
    d->side = gn_alloc_array(materials * walls + 1, sizeof *d->side);
    d->damping = gn_alloc_array(walls + 1, sizeof(double));
    d->fixed = dem->prescribed.count ? gn_alloc(n + 1) : NULL;
    if (!d->point || !d->side || !d->damping || (dem->prescribed.count && !d->fixed)) {
        free_data(d);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stability estimate");
    }
    for (size_t k = 0; k < walls; k++) {
        memcpy(d->point + 4 * k, boundary->walls[k].point, 3 * sizeof(double));
        for (size_t m = 0; m < materials; m++)
            d->side[m * walls + k] = gn_wall_side_of(ctx, dem, k, (int32_t)m);
        d->damping[k] = dem->damping_fraction;
    }
    for (size_t p = 0; d->fixed && p < n; p++)
        d->fixed[p] =
            dem->particles.slot[p] >= 0 ? dem->prescribed.mask[dem->particles.slot[p]] : 0;
    gneiss_status status =
        gn_surface_springs(ctx, dem, boundary, reach, &d->surface, &d->surface_count, error);
    if (status != GNEISS_OK) free_data(d);
    return status;
}

static gn_spectrum spectrum_of(const gn_step_context *ctx, double reach,
                               const gn_assembly *assembly, const spectrum_data *d) {
    gn_spectrum s = {.reach = reach};
    s.assembly = assembly;
    s.arm_factor = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    s.wall_point = d->point;
    s.wall_side = d->side;
    s.wall_damping = d->damping;
    s.extra = d->surface;
    s.extra_count = d->surface_count;
    s.fixed = d->fixed;
    s.dashpots = 1.0 / gn_nonviscous_share(ctx);
    s.threads = ctx->threads;
    return s;
}

/* --- checks of springs --- */

/* Returns the relative residual at which Lanczos stops. */
static double tolerance_of(const gn_step_context *ctx) {
    return ctx->scene.estimate == GN_STEP_BOUND ? 0.0 : 1e-3;
}

/* A check of the springs that are active now, or that may be before the lists are rebuilt. */
typedef struct question {
    double step;          /* s; 0: computes the limit, else tests whether this step is stable */
    double tolerance;     /* tolerance of Lanczos; 0: bounds only */
    gn_step_limit *limit; /* results */
    gn_step_verdict *verdict;
    bool whether;          /* tests only, without a search for a stable step */
    bool changed;          /* limits the check to particles whose springs have changed since the
                            * last one */
    const uint8_t *turned; /* [particles] limits the check to these and their neighbours; NULL: see
                            * `changed` */
    double *masses;   /* [particles] receives the factors of masses with which the step is stable;
                         NULL: not requested */
    uint8_t **others; /* [particles] receives the marks of the particles whose springs have changed
                         since the last check, and nothing else is done; the caller frees it; NULL:
                         not requested */
} question;

/* rad: rotation after which a contact is checked again; the lists are rebuilt before contacts
 * rotate by more than the skin over a diameter. */
static const double turned_by = 0.05;

/* Marks the particles whose springs have changed since the last check and stores their present
 * hashes. `which` 0: active springs, 1: listed ones. */
static gneiss_status find_changed(const gn_spectrum *spectrum, int which, uint8_t *changed,
                                  size_t *count, gneiss_error *error) {
    const gn_particles *q = spectrum->assembly->particles;
    size_t n = q->soa.count;
    int32_t *marks = NULL;
    GN_TRY(gn_new(&marks, n + 1, "particles", error));
    gn_step_contact_hashes(spectrum, marks);
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
    if (q->others) {
        *q->others = changed;
        return status;
    }
    if (status == GNEISS_OK && (!q->changed || count > 0))
        status = gn_step_holds(spectrum, q->step, q->tolerance, !q->whether,
                               q->changed ? changed : NULL, q->verdict, error);
    gn_free(changed);
    return status;
}

static gneiss_status answer(const gn_spectrum *spectrum, void *context, gneiss_error *error) {
    const question *q = context;
    if (q->masses) return gn_step_masses(spectrum, q->step, q->turned, q->masses, error);
    if (q->turned)
        return gn_step_holds(spectrum, q->step, q->tolerance, !q->whether, q->turned, q->verdict,
                             error);
    if (q->step > 0.0) return holds(spectrum, q, error);
    return gn_step_limits(spectrum, q->tolerance, q->limit, error);
}

gneiss_status gn_timestep_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, bool listed,
                                        gn_spectrum_user *use, void *context, gneiss_error *error) {
    gn_assembly assembly = gn_assembly_of(ctx, dem, boundary);
    spectrum_data data = {0};
    double reach = listed ? dem->verlet.skin : 0.0;
    GN_TRY(make_data(ctx, dem, boundary, reach, &data, error));
    gn_spectrum spectrum = spectrum_of(ctx, reach, &assembly, &data);
    gneiss_status status = use(&spectrum, context, error);
    free_data(&data);
    return status;
}

static gneiss_status ask(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         bool listed, const question *q, gneiss_error *error) {
    question copy = *q;
    return gn_timestep_with_spectrum(ctx, dem, boundary, listed, answer, &copy, error);
}

gneiss_status gn_timestep_masses(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, bool listed, double step,
                                 const uint8_t *changed, double *factor, gneiss_error *error) {
    question q = {.step = step, .turned = changed, .masses = factor};
    return ask(ctx, dem, boundary, listed, &q, error);
}

gneiss_status gn_timestep_relax(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const uint8_t *slips, double rate,
                                const double *load, double tolerance, gn_preconditioner *made,
                                double *u, gn_equilibrium *found, gneiss_error *error) {
    gn_assembly assembly = gn_assembly_of(ctx, dem, boundary);
    spectrum_data data = {0};
    GN_TRY(make_data(ctx, dem, boundary, 0.0, &data, error));
    gn_spectrum spectrum = spectrum_of(ctx, 0.0, &assembly, &data);
    spectrum.slips = slips;
    spectrum.dashpots = 0.0;
    double drag = ctx->effects & GN_FX_VISCOUS ? ctx->scene.background_coefficient : 0.0;
    gneiss_status status = gn_equilibrium_solve(&spectrum, (gn_viscosity){rate, drag}, load,
                                                tolerance, made, u, found, error);
    free_data(&data);
    return status;
}

/* Tells whether the rigorous bound suffices without Lanczos: the scene asks for it, or a given step
 * is below it. */
static bool bound_suffices(const gn_step_context *ctx, const gn_dem *dem, double bound) {
    if (ctx->scene.estimate == GN_STEP_BOUND || bound == INFINITY) return true;
    /* With springs in zones the sharp limit is needed in any case, because it determines these
     * springs. */
    if (ctx->scene.has_couple && ctx->scene.couple.constraint == GN_COUPLE_PENALTY) return false;
    return ctx->scene.step > 0.0 && ctx->scene.step <= gn_limit_beside_surfaces(ctx, dem, bound);
}

static gneiss_status find_limit(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                                gneiss_error *error) {
    gn_step_limit quick = {0};
    const question sharp = {.tolerance = 1e-3, .limit = &ctx->choice.limit};
    if (ctx->scene.estimate != GN_STEP_BOUND && !(ctx->scene.step > 0.0))
        return ask(ctx, dem, boundary, false, &sharp,
                   error); /* the bound is not needed: the springs are assembled only once */
    GN_TRY(ask(ctx, dem, boundary, false, &(question){.limit = &quick}, error));
    if (!bound_suffices(ctx, dem, quick.bound))
        return ask(ctx, dem, boundary, false, &sharp, error);
    ctx->choice.limit = quick;
    ctx->choice.limit.sharp = quick.bound;
    ctx->choice.limit.sharp_id = quick.bound_id;
    ctx->choice.limit.iterations = 0;
    return GNEISS_OK;
}

static double trusted(const gn_step_context *ctx, const gn_step_limit *limit) {
    return ctx->scene.estimate == GN_STEP_BOUND ? limit->bound : limit->sharp;
}

/* Returns the limit that the scene requests: of the active springs; without any, of all listed
 * contacts; without any, of one contact of the stiffest pair of particles, or of particle and wall.
 * The last one only gives an initial step: an approaching particle is listed and checked before it
 * touches (gn_timestep_check_lists). */
static gneiss_status usable_limit(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, double *limit, gneiss_error *error) {
    gn_step_limit listed = {0};
    gn_resolution unused;
    *limit = trusted(ctx, &ctx->choice.limit);
    if (*limit < INFINITY) return GNEISS_OK;
    GN_TRY(ask(ctx, dem, boundary, true,
               &(question){.tolerance = tolerance_of(ctx), .limit = &listed}, error));
    *limit = trusted(ctx, &listed);
    if (*limit < INFINITY) return GNEISS_OK;
    return gn_flight_limits(ctx, dem, boundary, limit, &unused, error);
}

/* Checks the springs of the particles `of`. If the scene requests the bound, the masses of these
 * particles are raised first, as far as their springs require it. With the sharp limit all masses
 * are closer to their limits than the bound shows, and a check of few of them proves nothing. */
static gneiss_status follow_and_ask(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                    gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                    bool listed, const uint8_t *of, const question *q,
                                    gneiss_error *error) {
    question about = *q;
    about.turned = of;
    double held = 0.0;
    if (ctx->scene.estimate == GN_STEP_BOUND)
        GN_TRY(gn_timestep_follow_masses(ctx, dem, boundary, solids, zones, ledger, listed, of,
                                         &held, error));
    *q->verdict = (gn_step_verdict){.holds = true};
    /* Masses were raised for a slightly larger step, by the tolerance with which blocks are left
     * unchanged. */
    if (q->step * (1.0 + 1e-6) <= held) return GNEISS_OK;
    return ask(ctx, dem, boundary, listed, &about, error);
}

/* Checks the particles whose springs have changed since the last check. */
static gneiss_status ask_of_others(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                   gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                   bool listed, const question *q, gneiss_error *error) {
    uint8_t *others = NULL;
    if (!(ctx->effects & GN_FX_MASS_SCALING)) return ask(ctx, dem, boundary, listed, q, error);
    question find_others = {.step = q->step, .verdict = q->verdict, .others = &others};
    gneiss_status status = ask(ctx, dem, boundary, listed, &find_others, error);
    if (status == GNEISS_OK)
        status =
            follow_and_ask(ctx, dem, boundary, solids, zones, ledger, listed, others, q, error);
    gn_free(others);
    return status;
}

/* Tells whether springs that have become active since the last check lower the limit. If there were
 * none at that check, any spring does. */
static gneiss_status limit_fell(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                gn_solids *solids, gn_zones *zones, gn_ledger *ledger, bool *fell,
                                gneiss_error *error) {
    /* In a coupled system the limit may be larger than that of the particles alone. */
    double known = fmax(trusted(ctx, &ctx->choice.limit), ctx->choice.whole);
    gn_step_verdict verdict = {0};
    question q = {.step = 0.95 * known, .verdict = &verdict, .whether = true, .changed = true};
    GN_TRY(ask_of_others(ctx, dem, boundary, solids, zones, ledger, false, &q, error));
    *fell = !verdict.holds;
    return GNEISS_OK;
}

gneiss_status gn_timestep_particle_limit(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                         gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                         bool full, bool *due, gneiss_error *error) {
    bool fell = full;
    GN_TRY(gn_loose_find(ctx, dem, error));
    if (!full) GN_TRY(limit_fell(ctx, dem, boundary, solids, zones, ledger, &fell, error));
    GN_TRY(gn_timestep_boundary_limit(ctx, dem, boundary, fell, due, error));
    if (!*due) return GNEISS_OK;
    if (fell) GN_TRY(find_limit(ctx, dem, boundary, error));
    return usable_limit(ctx, dem, boundary, &ctx->choice.stable, error);
}

/* --- events before the next lists --- */

/* A margin of one hundredth is left for normals and arms that rotate until the lists are rebuilt.
 */
gneiss_status gn_timestep_limit_listed(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       bool full, bool *fine, gneiss_error *error) {
    gn_step_limit limit = {0};
    gn_step_verdict verdict = {0};
    double needed = gn_limit_needed(ctx, dem, solids, zones, ctx->dt / 0.99);
    *fine = false; /* the verdict on a given step does not change */
    if (!full && ctx->scene.step > 0.0 && ctx->dt > ctx->choice.listed) return GNEISS_OK;
    /* The particles must be stable at a larger step than was proved, because bodies yield more. */
    bool all = full || needed > ctx->choice.listed_holds, finite = needed < INFINITY;
    question q = {.tolerance = all || !finite ? tolerance_of(ctx) : 0.0};
    if (finite) {
        q.step = needed;
        q.verdict = &verdict;
        q.changed = !all;
    } else {
        q.limit = &limit;
    }
    if (q.changed)
        GN_TRY(ask_of_others(ctx, dem, boundary, solids, zones, ledger, true, &q, error));
    else
        GN_TRY(ask(ctx, dem, boundary, true, &q, error));
    *fine = finite && verdict.holds;
    if (*fine && all) ctx->choice.listed_holds = needed;
    if (*fine) return GNEISS_OK;
    ctx->choice.listed_holds = finite ? verdict.limit : trusted(ctx, &limit);
    ctx->choice.listed = gn_limit_of_all(ctx, dem, solids, zones, ctx->choice.listed_holds);
    return GNEISS_OK;
}

static gneiss_status by_sums(const gn_spectrum *spectrum, void *context, gneiss_error *error) {
    const question *q = context;
    return gn_step_holds_by_sums(spectrum, q->step, &q->verdict->holds, error);
}

/* If collisions are resolved, steps are far below the limit; row sums then prove the step stable
 * without a search for changes. */
gneiss_status gn_timestep_limit_far(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, bool *far, gneiss_error *error) {
    gn_step_verdict verdict = {0};
    question q = {.step = gn_limit_needed(ctx, dem, solids, zones, ctx->dt / 0.99),
                  .verdict = &verdict};
    *far = false;
    if (ctx->dt > 0.5 * ctx->choice.stable || !(q.step < INFINITY)) return GNEISS_OK;
    GN_TRY(gn_timestep_with_spectrum(ctx, dem, boundary, true, by_sums, &q, error));
    *far = verdict.holds;
    return GNEISS_OK;
}

static bool resolve(gn_step_context *ctx, gn_resolution r) {
    bool shorter = r.step < ctx->choice.resolution.step;
    if (shorter) ctx->choice.resolution = r;
    return shorter;
}

gneiss_status gn_timestep_resolve_listed(gn_step_context *ctx, gn_dem *dem,
                                         const gn_boundary *boundary, const gn_solids *solids,
                                         const gn_zones *zones, bool *shorter,
                                         gneiss_error *error) {
    gn_resolution resolution;
    GN_TRY(gn_loose_find(ctx, dem, error));
    GN_TRY(gn_resolution_listed(ctx, dem, boundary, solids, zones, &resolution, error));
    *shorter = resolve(ctx, resolution);
    return GNEISS_OK;
}

gneiss_status gn_timestep_resolve_flight(gn_step_context *ctx, gn_dem *dem,
                                         const gn_boundary *boundary, bool *shorter,
                                         gneiss_error *error) {
    gn_resolution flight;
    double unused;
    *shorter = false;
    if (ctx->choice.resolution.step < INFINITY) return GNEISS_OK;
    GN_TRY(gn_flight_limits(ctx, dem, boundary, &unused, &flight, error));
    *shorter = resolve(ctx, flight);
    return GNEISS_OK;
}

void gn_timestep_limit_anew(gn_step_context *ctx) {
    ctx->choice.listed = INFINITY;
    ctx->choice.resolution = (gn_resolution){INFINITY, INFINITY, -1, -1};
}

/* Marks the particles whose contacts with others have rotated since the last check. */
static size_t find_turned(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, uint8_t *turned) {
    gn_assembly assembly = gn_assembly_of(ctx, dem, boundary);
    gn_spectrum spectrum = spectrum_of(ctx, 0.0, &assembly, &(spectrum_data){0});
    return gn_step_rotated_contacts(&spectrum, turned_by, turned);
}

/* Tells whether the step is stable for the rotated contacts, with a margin for further rotation
 * until the lists are rebuilt. */
static gneiss_status turned_hold(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                 gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                 const uint8_t *turned, bool *hold, gneiss_error *error) {
    gn_step_verdict verdict = {0};
    question q = {.step = gn_limit_needed(ctx, dem, solids, zones, ctx->dt / GN_TURNED_SHARE),
                  .tolerance = tolerance_of(ctx),
                  .verdict = &verdict,
                  .whether = true,
                  .turned = turned};
    gneiss_status status =
        follow_and_ask(ctx, dem, boundary, solids, zones, ledger, false, turned, &q, error);
    *hold = verdict.holds;
    return status;
}

/* If springs rotate relative to each other, their limit changes although they stay the same: a
 * bonded chain that is stretched straight needs a smaller step than one with a right angle. If the
 * step is not proved stable, the limit of all particles is computed again. */
gneiss_status gn_timestep_limit_turned(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                       gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                       bool *due, gneiss_error *error) {
    bool hold = true;
    uint8_t *turned = gn_alloc(dem->particles.soa.count + 1);
    if (!turned) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stability estimate");
    gneiss_status status = GNEISS_OK;
    if (find_turned(ctx, dem, boundary, turned))
        status = turned_hold(ctx, dem, boundary, solids, zones, ledger, turned, &hold, error);
    gn_free(turned);
    *due = status == GNEISS_OK && !hold;
    if (!*due) return status;
    GN_TRY(find_limit(ctx, dem, boundary, error));
    return usable_limit(ctx, dem, boundary, &ctx->choice.stable, error);
}
