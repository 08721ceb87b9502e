#include "plan/propose.h"

#include "plan/setting.h"

#include <math.h>
#include <string.h>

/* Program start, results and summary: s, whatever the scene. */
static const double fixed_seconds = 0.03;

/* --- what a proposal costs --- */

static bool packs(const gn_step_context *ctx) {
    return ctx->given.specimen.pack.shape != GN_SHAPE_NONE;
}

/* The length of a step against that of the scene: the stable step goes as the size of particles.
 * Added mass gives less than it did at the start once bonds have broken. */
static double step_ratio(const gn_step_context *ctx, const gn_plan *plan, const gn_proposal *p,
                         bool breaks) {
    double finer = p->particles / plan->groups.particles;
    double gain = breaks ? gn_slope_base_of(plan->estimate.study, "power of added mass") : 1.0;
    return p->safety / plan->groups.safety * pow(p->masses / plan->groups.masses, gain) *
           pow(finer, -1.0 / (double)ctx->scene.dimension);
}

/* s from the start to where the run is foretold to end: what comes before the ends have their speed
 * is as much longer. */
static double duration(const gn_step_context *ctx, const gn_plan *plan, double pace) {
    const gn_estimate *e = &plan->estimate;
    double length = ctx->test_length, before = ctx->scene.end - e->path * length / e->closing;
    return (e->end * length / e->closing + before) / pace;
}

/* Statics take the place of the steps up to 0.9 of the first break, and cost as much as so many
 * steps of the study's specimen; their iterations go as the particles across. */
static double steps_of_start(const gn_step_context *ctx, const gn_plan *plan, const gn_proposal *p,
                             double dt) {
    const double fraction = 0.9;
    const gn_estimate *e = &plan->estimate;
    double saved = fraction * e->first_break * ctx->test_length / (e->closing * p->pace) / dt;
    double cost = gn_slope_base_of(e->study, "statics in steps");
    double of = gn_slope_base_of(e->study, "particles");
    return cost * pow(p->particles / of, 1.0 / (double)ctx->scene.dimension) - saved;
}

static double rows_of(const gn_step_context *ctx, const gn_plan *plan, const gn_proposal *p) {
    double share = duration(ctx, plan, p->pace) / gn_plan_end(plan, &ctx->scene, p->pace);
    return fmin(gn_plan_history_rows(plan, &ctx->scene, p->pace) * share, p->steps);
}

/* s of one particle in a step, its contacts included. */
static double particle_step(const gn_dem *dem, const gn_cost *c) {
    double contacts = (double)(dem->bonds.soa.count + dem->pairs.soa.count);
    return c->particle + c->contact * contacts / (double)dem->particles.soa.count;
}

static void price_particles(const gn_step_context *ctx, const gn_dem *dem, const gn_plan *plan,
                            gn_proposal *p) {
    const gn_estimate *e = &plan->estimate;
    const gn_cost *c = &plan->cost[p->mixed];
    bool breaks = e->end >= e->strain;
    double each = particle_step(dem, c), dt = ctx->dt * step_ratio(ctx, plan, p, breaks);
    double longer = breaks ? gn_slope_base_of(e->study, "steps over those of the first") : 1.0;
    p->steps = ceil(duration(ctx, plan, p->pace) / dt * longer);
    double work = p->steps;
    if (p->first_break) work += steps_of_start(ctx, plan, p, dt);
    double run = p->particles * (work * each + rows_of(ctx, plan, p) * c->row);
    run *= gn_slope_base_of(e->study, "run over lattice");
    double packing = packs(ctx) ? each * gn_slope_base_of("packing", "particle steps") : 0.0;
    p->seconds = p->packings * (fixed_seconds + run + p->particles * packing +
                                plan->setup * p->particles / plan->groups.particles);
}

static void price_elements(const gn_step_context *ctx, const gn_plan *plan, gn_proposal *p,
                           double elements, double dt) {
    const gn_cost *c = &plan->cost[p->mixed];
    p->steps = ceil(duration(ctx, plan, p->pace) / dt);
    p->seconds = fixed_seconds + plan->setup +
                 elements * (p->steps * c->element + rows_of(ctx, plan, p) * c->row);
}

static void price(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                  const gn_plan *plan, gn_proposal *p) {
    if (plan->groups.mesh)
        price_elements(ctx, plan, p,
                       (double)gn_elements_totals(solids).elements *
                           pow(p->cell, -(double)ctx->scene.dimension),
                       ctx->dt * p->cell * p->safety / plan->groups.safety);
    else
        price_particles(ctx, dem, plan, p);
}

void gn_plan_correct(const gn_step_context *ctx, const gn_solids *solids, const gn_plan *plan,
                     gn_proposal *p) {
    if (plan->groups.mesh)
        price_elements(ctx, plan, p, (double)gn_elements_totals(solids).elements, ctx->dt);
}

/* --- what it may be off by --- */

static void judge(const gn_plan *plan, const gn_step_context *ctx, gn_proposal *p) {
    gn_test_groups g = plan->groups;
    /* A wave is late by the root of the mass at most (docs/evidence/mass-scaling.md). */
    g.speed = plan->estimate.speed * p->pace * sqrt(1.0 + p->added);
    g.safety = p->safety;
    g.mixed = p->mixed;
    g.masses = p->of_bound;
    g.first_break = p->first_break;
    g.packings = p->packings;
    g.across *= pow(p->particles / g.particles, 1.0 / (double)ctx->scene.dimension);
    g.particles = p->particles;
    g.cell *= p->cell;
    gn_causes_predict(&g, plan->reading, &p->causes);
    p->error = gn_causes_total(&p->causes);
}

/* --- what is tried --- */

static const double safeties[] = {0.9, 0.7, 0.5, 0.3};
static const double factors[GN_PLAN_FACTORS] = {1.0, 1.3, 1.5, 1.75, 2.0};
/* Runs warn of more than particles' own mass. Debris take another 0.3 to 0.4 of it, and other
 * packings a little more than this one. */
static const double added_most = 0.5;
static const double numbers[] = {250, 500, 1000, 2000, 4000, 8000, 16000};
static const int packings[] = {1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 40};
#define COUNT(array) (sizeof(array) / sizeof *(array))
enum { PACES = 25 }; /* from 1/64 to 64, by roots of 2 */

/* The cheapest that is right; the nearest to it while none is. */
typedef struct search {
    const gn_world *world;
    gn_plan *plan;
    double target;
    gn_proposal best, least;
    bool any, reached;
} search;

static bool slower_than_known(const gn_plan *plan, double pace) {
    const gn_slope *law = gn_slope_find(plan->groups.study, plan->reading, "velocity", false);
    return !law || plan->estimate.speed * pace <= law->high;
}

static void consider(search *q, gn_proposal p) {
    judge(q->plan, &q->world->ctx, &p);
    price(&q->world->ctx, &q->world->dem, &q->world->solids, q->plan, &p);
    bool right = p.error <= q->target;
    if (right && (!q->reached || p.seconds < q->best.seconds)) q->best = p;
    if (!q->any || p.error < q->least.error) q->least = p;
    q->any = true;
    q->reached |= right;
}

/* Precision, masses and start are taken where they are known to be of use and allowed. */
static void try_ways(search *q, gn_proposal p) {
    const gn_plan *plan = q->plan;
    bool masses = gn_slope_find(plan->groups.study, plan->reading, "mass scaling", false) &&
                  q->world->ctx.scene.gravity[0] == 0.0 && q->world->ctx.scene.gravity[1] == 0.0 &&
                  q->world->ctx.scene.gravity[2] == 0.0;
    bool start = !plan->no_statics && isfinite(plan->estimate.strain) &&
                 gn_slope_find(plan->groups.study, plan->reading, "start", false);
    const int precisions = plan->mixed_known ? 2 : 1, starts = start ? 2 : 1;
    for (int mixed = 0; mixed < precisions; mixed++)
        for (int first = 0; first < starts; first++)
            for (size_t m = 0; m < (masses ? COUNT(factors) : 1); m++) {
                p.mixed = mixed;
                p.first_break = first;
                p.masses = factors[m];
                p.of_bound = m ? plan->of_bound[m] : 1.0;
                p.added = m ? plan->added[m] : 0.0;
                if (p.added <= added_most) consider(q, p);
            }
}

static void try_numbers(search *q, gn_proposal p) {
    const gn_world *w = q->world;
    bool shape = packs(&w->ctx), any = shape && q->plan->wanted.any_particles;
    for (size_t n = 0; n < (any ? COUNT(numbers) : 1); n++)
        for (size_t k = 0; k < (shape ? COUNT(packings) : 1); k++) {
            p.particles = any ? numbers[n] : q->plan->groups.particles;
            p.packings = packings[k];
            try_ways(q, p);
        }
}

/* About the scene's own pace; about the fastest that is known where that one is beyond it. */
static double middle_pace(const gn_plan *plan, const gn_step_context *ctx) {
    const gn_slope *law = gn_slope_find(plan->groups.study, plan->reading, "velocity", false);
    double speed = plan->estimate.speed;
    bool beyond = law && speed > law->high && !gn_plan_no_pace(&ctx->scene);
    return beyond ? law->high / speed * (1.0 - 1e-9) : 1.0;
}

static void try_all(search *q, gn_proposal p) {
    enum { MIDDLE = PACES / 2 };
    const double middle = middle_pace(q->plan, &q->world->ctx);
    for (size_t s = 0; s < COUNT(safeties); s++)
        for (int k = 0; k < PACES; k++) {
            p.safety = safeties[s];
            p.pace = middle * pow(2.0, 0.5 * (double)(k - MIDDLE));
            bool free = p.pace == 1.0 || !gn_plan_no_pace(&q->world->ctx.scene);
            if (free && slower_than_known(q->plan, p.pace)) try_numbers(q, p);
        }
}

/* Finer and finer cells; the loading of elements stays as it is, as the study has no law of it. */
static void try_cells(search *q, gn_proposal p) {
    double layers = q->plan->groups.cell > 0.0 ? 1.0 / q->plan->groups.cell : 0.0;
    bool whole = q->world->ctx.scene.elements.has_rectangle;
    for (int k = 0; k < 15; k++) {
        p.cell = pow(2.0, 0.5 * (4 - k));
        if (whole) p.cell = layers / fmax(1.0, round(layers / p.cell));
        p.pace = 1.0;
        p.mixed = false;
        p.safety = 0.9;
        consider(q, p);
    }
}

/* --- the plan --- */

/* With what the scene says, one packing. */
static gn_proposal as_it_is(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_plan *plan) {
    gn_proposal p = {.pace = 1.0, .particles = plan->groups.particles, .packings = 1, .cell = 1.0};
    p.safety = plan->groups.safety;
    p.masses = p.of_bound = plan->groups.masses;
    p.added = dem->mass > 0.0 ? dem->scaling.added / dem->mass : 0.0;
    p.mixed = plan->groups.mixed;
    p.first_break = plan->groups.first_break;
    judge(plan, ctx, &p);
    price(ctx, dem, solids, plan, &p);
    return p;
}

static void look(const gn_world *w, gn_plan *plan, double target, search *q) {
    *q = (search){.world = w, .plan = plan, .target = target};
    if (plan->groups.mesh)
        try_cells(q, plan->as_is);
    else
        try_all(q, plan->as_is);
}

/* What the study calls the reading that is wanted of such a test. */
static const char *name_of_reading(const gn_plan *plan) {
    bool stiffness = strcmp(plan->wanted.reading, "stiffness") == 0;
    if (!plan->groups.mesh) return stiffness ? "E" : "strength";
    return strcmp(plan->groups.study, "cantilever") == 0 ? "deflection" : "stiffness";
}

static const char *cannot(const gn_plan *plan) {
    const gn_estimate *e = &plan->estimate;
    bool strength = strcmp(plan->wanted.reading, "strength") == 0;
    if (e->absent) return e->absent;
    if (strength && plan->groups.mesh)
        return "finite elements have no strength: --reading stiffness";
    if (strength && !isfinite(e->strain))
        return "nothing in this scene can break: --reading stiffness";
    if (strength && e->strain > e->path)
        return "no peak is foretold before time.end: --reading stiffness, or a later end";
    return NULL;
}

static gneiss_status measure_costs(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_solids *solids, gn_plan *plan, gneiss_error *error) {
    gneiss_error refused = {0};
    GN_TRY(gn_cost_measure(ctx, dem, solids, false, &plan->cost[0], error));
    if (ctx->effects & GN_FX_PRESSURE) return GNEISS_OK; /* is in double whatever is said */
    gneiss_status status = gn_cost_measure(ctx, dem, solids, true, &plan->cost[1], &refused);
    plan->mixed_known = status == GNEISS_OK;
    if (status == GNEISS_OK || status == GNEISS_ERROR_INPUT) return GNEISS_OK;
    return gn_fail(error, status, "%s", refused.message);
}

/* Spheres that roll about two others (discs about one) have no equilibrium to be found. */
static const char *cannot_start(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const char *reason = gn_scene_no_statics(&ctx->scene);
    for (size_t p = 0; !reason && q->bonds0 && p < q->soa.count; p++)
        if (q->bonds0[p] < ctx->scene.dimension)
            reason = "particles that bonds hold in place, found some with fewer than it takes";
    return reason;
}

/* By the bound, whatever the scene says: masses chosen by it hold the step particle by particle, so
 * that those of debris can follow, and no look at the run takes iterations. */
static gneiss_status measure_masses(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, gn_plan *plan, gneiss_error *error) {
    plan->unscaled = plan->groups.masses > 1.0 ? dem->scaling.unscaled : ctx->dt;
    for (size_t m = 1; !plan->groups.mesh && m < COUNT(factors); m++)
        GN_TRY(gn_dem_foretell_masses(ctx, dem, boundary, solids, zones,
                                      factors[m] * plan->unscaled, &plan->of_bound[m],
                                      &plan->added[m], error));
    return GNEISS_OK;
}

gneiss_status gn_plan_make(const gn_world *w, const gn_wanted *wanted, double setup, gn_plan *plan,
                           gneiss_error *error) {
    search q;
    *plan =
        (gn_plan){.wanted = *wanted, .setup = setup, .no_statics = cannot_start(&w->ctx, &w->dem)};
    gn_study_covers(&w->ctx, &w->dem, &plan->groups);
    GN_TRY(gn_estimate_make(&w->ctx, &w->dem, &w->solids, &plan->estimate, error));
    plan->absent = cannot(plan);
    if (plan->absent) return GNEISS_OK;
    plan->reading = name_of_reading(plan);
    GN_TRY(measure_costs(&w->ctx, &w->dem, &w->solids, plan, error));
    GN_TRY(measure_masses(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, plan, error));
    plan->as_is = as_it_is(&w->ctx, &w->dem, &w->solids, plan);
    look(w, plan, wanted->error, &q);
    plan->reached = q.reached;
    /* What cannot be reached is come as near to as makes a difference. */
    if (!q.reached) look(w, plan, 1.1 * q.least.error, &q);
    plan->best = q.reached ? q.best : plan->as_is; /* nothing to choose from */
    return GNEISS_OK;
}
