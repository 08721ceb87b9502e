#include "plan/propose.h"

#include "plan/setting.h"
#include "timestep/timestep.h"

#include <math.h>
#include <string.h>

/* s that the start of the program, results and summary take for any scene */
static const double fixed_seconds = 0.03;

/* --- cost of a proposal --- */

static bool packs(const gn_step_context *ctx) {
    return ctx->given.specimen.pack.shape != GN_SHAPE_NONE;
}

/* Returns the ratio of the step to that of the scene. The stable step is proportional to the
 * particle size. Added mass has less effect after bonds have broken than before. */
static double step_ratio(const gn_step_context *ctx, const gn_plan *plan,
                         const gn_proposal *proposal, bool breaks) {
    double finer = proposal->particles / plan->groups.particles;
    double gain = breaks ? gn_slope_base_of(plan->estimate.study, "power of added mass") : 1.0;
    return proposal->safety / plan->groups.safety *
           pow(proposal->step_ratio / plan->groups.step_ratio, gain) *
           pow(finer, -1.0 / (double)ctx->scene.dimension);
}

/* Returns the time from the start to the predicted end, s, including the time in which the ends
 * reach their speed, which is proportionally longer. */
static double duration(const gn_step_context *ctx, const gn_plan *plan, double pace) {
    const gn_estimate *estimate = &plan->estimate;
    double length = ctx->test_length,
           before = ctx->scene.end - estimate->path_strain * length / estimate->closing_velocity;
    return (estimate->end_strain * length / estimate->closing_velocity + before) / pace;
}

/* Returns the cost of a static start in steps. Statics replace the steps up to 0.9 of the first
 * break and cost as many steps as in the study's specimen; their iterations are proportional to the
 * number of particles across. */
static double steps_of_start(const gn_step_context *ctx, const gn_plan *plan,
                             const gn_proposal *proposal, double dt) {
    const double fraction = 0.9;
    const gn_estimate *estimate = &plan->estimate;
    double saved = fmin(fraction * estimate->first_break * ctx->test_length /
                            (estimate->closing_velocity * proposal->pace) / dt,
                        proposal->steps);
    double cost = gn_slope_base_of(estimate->study, "statics in steps");
    double of = gn_slope_base_of(estimate->study, "particles");
    return cost * pow(proposal->particles / of, 1.0 / (double)ctx->scene.dimension) - saved;
}

static double rows_of(const gn_step_context *ctx, const gn_plan *plan,
                      const gn_proposal *proposal) {
    double share =
        duration(ctx, plan, proposal->pace) / gn_plan_end(plan, &ctx->scene, proposal->pace);
    return fmin(gn_plan_history_rows(plan, &ctx->scene, proposal->pace) * share, proposal->steps);
}

/* Returns the time that one particle takes in a step, its contacts included, s. */
static double particle_step(const gn_dem *dem, const gn_cost *cost) {
    double contacts = (double)gn_lists_count(dem);
    return cost->particle + cost->contact * contacts / (double)dem->particles.soa.count;
}

static void price_particles(const gn_step_context *ctx, const gn_dem *dem, const gn_plan *plan,
                            gn_proposal *proposal) {
    const gn_estimate *estimate = &plan->estimate;
    const gn_cost *cost = &plan->cost[proposal->mixed];
    bool breaks = estimate->end_strain >= estimate->strain;
    double each = particle_step(dem, cost), dt = ctx->dt * step_ratio(ctx, plan, proposal, breaks);
    double longer =
        breaks ? gn_slope_base_of(estimate->study, "steps over those of the first") : 1.0;
    proposal->steps = ceil(duration(ctx, plan, proposal->pace) / dt * longer);
    double work = proposal->steps;
    if (proposal->first_break) work += steps_of_start(ctx, plan, proposal, dt);
    double run = proposal->particles * (work * each + rows_of(ctx, plan, proposal) * cost->row);
    run *= gn_slope_base_of(estimate->study, "run over lattice");
    double packing = packs(ctx) ? each * gn_slope_base_of("packing", "particle steps") : 0.0;
    proposal->seconds =
        proposal->packings * (fixed_seconds + run + proposal->particles * packing +
                              plan->setup * proposal->particles / plan->groups.particles);
}

static void price_elements(const gn_step_context *ctx, const gn_plan *plan, gn_proposal *proposal,
                           double elements, double dt) {
    const gn_cost *cost = &plan->cost[proposal->mixed];
    proposal->steps = ceil(duration(ctx, plan, proposal->pace) / dt);
    proposal->seconds =
        fixed_seconds + plan->setup +
        elements * (proposal->steps * cost->element + rows_of(ctx, plan, proposal) * cost->row);
}

static void price(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                  const gn_plan *plan, gn_proposal *proposal) {
    if (plan->groups.mesh)
        price_elements(ctx, plan, proposal,
                       (double)gn_elements_totals(solids).elements *
                           pow(proposal->cell, -(double)ctx->scene.dimension),
                       ctx->dt * proposal->cell * proposal->safety / plan->groups.safety);
    else
        price_particles(ctx, dem, plan, proposal);
}

void gn_plan_correct(const gn_step_context *ctx, const gn_solids *solids, const gn_plan *plan,
                     gn_proposal *proposal) {
    if (plan->groups.mesh)
        price_elements(ctx, plan, proposal, (double)gn_elements_totals(solids).elements, ctx->dt);
}

/* --- error of a proposal --- */

static void judge(const gn_plan *plan, const gn_step_context *ctx, gn_proposal *proposal) {
    gn_test_groups g = plan->groups;
    /* Waves are delayed by at most the root of the mass (docs/evidence/mass-scaling.md). */
    g.speed = plan->estimate.speed * proposal->pace * sqrt(1.0 + proposal->added_mass);
    g.safety = proposal->safety;
    g.mixed = proposal->mixed;
    g.step_ratio = proposal->bound_step_ratio;
    g.first_break = proposal->first_break;
    g.packings = proposal->packings;
    g.across *= pow(proposal->particles / g.particles, 1.0 / (double)ctx->scene.dimension);
    g.particles = proposal->particles;
    g.cell *= proposal->cell;
    gn_causes_predict(&g, plan->reading, &proposal->causes);
    proposal->error = gn_causes_total(&proposal->causes);
}

/* --- trials --- */

static const double safeties[] = {0.9, 0.7, 0.5, 0.3};
static const double factors[GN_PLAN_FACTORS] = {1.0, 1.3, 1.5, 1.75, 2.0};
/* Largest ratio of added to own mass. Runs warn above 1. Debris requires another 0.3 to 0.4, and
 * other packings slightly more than this one. */
static const double added_most = 0.5;
static const double numbers[] = {250, 500, 1000, 2000, 4000, 8000, 16000};
static const int packings[] = {1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 40};
#define COUNT(array) (sizeof(array) / sizeof *(array))
enum { PACES = 25 }; /* from 1/64 to 64 in factors of the square root of 2 */

/* The cheapest proposal within the error or, until there is one, the proposal with the least error.
 */
typedef struct setting_search {
    const gn_world *world;
    gn_plan *plan;
    double target;
    gn_proposal best, least;
    bool any, reached;
} setting_search;

static bool slower_than_known(const gn_plan *plan, double pace) {
    const gn_slope *law = gn_slope_find(plan->groups.study, plan->reading, "velocity", false);
    return !law || plan->estimate.speed * pace <= law->high;
}

static void consider(setting_search *search, gn_proposal proposal) {
    judge(search->plan, &search->world->ctx, &proposal);
    price(&search->world->ctx, &search->world->dem, &search->world->solids, search->plan,
          &proposal);
    bool right = proposal.error <= search->target;
    if (right && (!search->reached || proposal.seconds < search->best.seconds))
        search->best = proposal;
    if (!search->any || proposal.error < search->least.error) search->least = proposal;
    search->any = true;
    search->reached |= right;
}

/* Tries mixed precision, mass scaling and a static start where they are known to help and are
 * allowed. */
static void try_ways(setting_search *search, gn_proposal proposal) {
    const gn_plan *plan = search->plan;
    bool masses = gn_slope_find(plan->groups.study, plan->reading, "mass scaling", false) &&
                  !gn_scene_has_gravity(&search->world->ctx.scene);
    bool start = !plan->statics_refusal && plan->estimate.first_break < plan->estimate.end_strain &&
                 gn_slope_find(plan->groups.study, plan->reading, "start", false);
    const int precisions = plan->mixed_known ? 2 : 1, starts = start ? 2 : 1;
    for (int mixed = 0; mixed < precisions; mixed++)
        for (int first = 0; first < starts; first++)
            for (size_t m = 0; m < (masses ? COUNT(factors) : 1); m++) {
                proposal.mixed = mixed;
                proposal.first_break = first;
                proposal.step_ratio = factors[m];
                proposal.bound_step_ratio = m ? plan->bound_step_ratio[m] : 1.0;
                proposal.added_mass = m ? plan->added_mass[m] : 0.0;
                if (proposal.added_mass <= added_most) consider(search, proposal);
            }
}

static void try_numbers(setting_search *search, gn_proposal proposal) {
    const gn_world *world = search->world;
    bool shape = packs(&world->ctx), any = shape && search->plan->wanted.any_particles;
    for (size_t n = 0; n < (any ? COUNT(numbers) : 1); n++)
        for (size_t k = 0; k < (shape ? COUNT(packings) : 1); k++) {
            proposal.particles = any ? numbers[n] : search->plan->groups.particles;
            proposal.packings = packings[k];
            try_ways(search, proposal);
        }
}

/* Returns the centre of the tried speeds: that of the scene or, if it is above the fastest known
 * one, the latter. */
static double middle_pace(const gn_plan *plan, const gn_step_context *ctx) {
    const gn_slope *law = gn_slope_find(plan->groups.study, plan->reading, "velocity", false);
    double speed = plan->estimate.speed;
    bool beyond = law && speed > law->high && !gn_plan_pace_refusal(&ctx->scene);
    return beyond ? law->high / speed * (1.0 - 1e-9) : 1.0;
}

static void try_all(setting_search *search, gn_proposal proposal) {
    enum { MIDDLE = PACES / 2 };
    const double middle = middle_pace(search->plan, &search->world->ctx);
    for (size_t s = 0; s < COUNT(safeties); s++)
        for (int k = 0; k < PACES; k++) {
            proposal.safety = safeties[s];
            proposal.pace = middle * pow(2.0, 0.5 * (double)(k - MIDDLE));
            bool free = proposal.pace == 1.0 || !gn_plan_pace_refusal(&search->world->ctx.scene);
            if (free && slower_than_known(search->plan, proposal.pace))
                try_numbers(search, proposal);
        }
}

/* Tries finer cells; the loading speed of elements is kept, because the study has no law for it. */
static void try_cells(setting_search *search, gn_proposal proposal) {
    double layers = search->plan->groups.cell > 0.0 ? 1.0 / search->plan->groups.cell : 0.0;
    bool whole = search->world->ctx.scene.elements.has_rectangle;
    for (int k = 0; k < 15; k++) {
        proposal.cell = pow(2.0, 0.5 * (4 - k));
        if (whole) proposal.cell = layers / fmax(1.0, round(layers / proposal.cell));
        proposal.pace = 1.0;
        proposal.mixed = false;
        proposal.safety = 0.9;
        consider(search, proposal);
    }
}

/* --- the plan --- */

/* Returns the settings of the scene, with one packing. */
static gn_proposal current_settings(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_plan *plan) {
    gn_proposal p = {.pace = 1.0, .particles = plan->groups.particles, .packings = 1, .cell = 1.0};
    p.safety = plan->groups.safety;
    p.step_ratio = p.bound_step_ratio = plan->groups.step_ratio;
    p.added_mass = dem->mass > 0.0 ? dem->raised.added / dem->mass : 0.0;
    p.mixed = plan->groups.mixed;
    p.first_break = plan->groups.first_break;
    judge(plan, ctx, &p);
    price(ctx, dem, solids, plan, &p);
    return p;
}

static void search_settings(const gn_world *world, gn_plan *plan, double target,
                            setting_search *search) {
    *search = (setting_search){.world = world, .plan = plan, .target = target};
    if (plan->groups.mesh)
        try_cells(search, plan->current);
    else
        try_all(search, plan->current);
}

/* Returns the study's name of the requested reading of this test. */
static const char *name_of_reading(const gn_plan *plan) {
    bool stiffness = strcmp(plan->wanted.reading, "stiffness") == 0;
    if (!plan->groups.mesh) return stiffness ? "E" : "strength";
    return strcmp(plan->groups.study, "cantilever") == 0 ? "deflection" : "stiffness";
}

static const char *cannot(const gn_plan *plan) {
    const gn_estimate *estimate = &plan->estimate;
    bool strength = strcmp(plan->wanted.reading, "strength") == 0;
    if (estimate->absent) return estimate->absent;
    if (strength && plan->groups.mesh)
        return "finite elements have no strength: --reading stiffness";
    if (strength && !isfinite(estimate->strain))
        return "there are no breakable bonds in this scene: --reading stiffness";
    if (strength && estimate->strain > estimate->path_strain)
        return "no peak is predicted before time.end: --reading stiffness, or a later end";
    return NULL;
}

static gneiss_status measure_costs(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_solids *solids, gn_plan *plan, gneiss_error *error) {
    gneiss_error refused = {0};
    GN_TRY(gn_cost_measure(ctx, dem, solids, false, &plan->cost[0], error));
    if (ctx->effects & GN_FX_PRESSURE)
        return GNEISS_OK; /* the pressure form is always in double precision */
    gneiss_status status = gn_cost_measure(ctx, dem, solids, true, &plan->cost[1], &refused);
    plan->mixed_known = status == GNEISS_OK;
    if (status == GNEISS_OK || status == GNEISS_ERROR_INPUT) return GNEISS_OK;
    return gn_fail(error, status, "%s", refused.message);
}

/* Returns the reason why a run cannot begin at the first break: spheres that roll about two others
 * (discs about one) have no static equilibrium. */
static const char *cannot_start(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const char *reason = gn_scene_statics_refusal(&ctx->scene);
    for (size_t p = 0; !reason && q->bonds0 && p < q->soa.count; p++)
        if (q->bonds0[p] < ctx->scene.dimension)
            reason = "enough bonds to hold each particle, found particles with fewer";
    return reason;
}

/* Computes added masses by the bound, whatever estimate the scene uses: with masses chosen in this
 * way each particle satisfies the limit by itself, so that debris can be scaled as well, and checks
 * during the run need no iterations. */
static gneiss_status measure_masses(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, gn_plan *plan, gneiss_error *error) {
    plan->unscaled_step = plan->groups.step_ratio > 1.0 ? ctx->choice.scaling.unscaled : ctx->dt;
    for (size_t m = 1; !plan->groups.mesh && m < COUNT(factors); m++)
        GN_TRY(gn_timestep_predict_masses(ctx, dem, boundary, solids, zones,
                                          factors[m] * plan->unscaled_step,
                                          &plan->bound_step_ratio[m], &plan->added_mass[m], error));
    return GNEISS_OK;
}

gneiss_status gn_plan_make(const gn_world *world, const gn_wanted *wanted, double setup,
                           gn_plan *plan, gneiss_error *error) {
    setting_search q;
    *plan = (gn_plan){.wanted = *wanted,
                      .setup = setup,
                      .statics_refusal = cannot_start(&world->ctx, &world->dem)};
    gn_study_find_case(&world->ctx, &world->dem, &plan->groups);
    GN_TRY(gn_estimate_make(&world->ctx, &world->dem, &world->solids, &plan->estimate, error));
    plan->absent = cannot(plan);
    if (plan->absent) return GNEISS_OK;
    plan->reading = name_of_reading(plan);
    GN_TRY(measure_costs(&world->ctx, &world->dem, &world->solids, plan, error));
    GN_TRY(measure_masses(&world->ctx, &world->dem, &world->boundary, &world->solids, &world->zones,
                          plan, error));
    plan->current = current_settings(&world->ctx, &world->dem, &world->solids, plan);
    search_settings(world, plan, wanted->error, &q);
    plan->reached = q.reached;
    /* If the error cannot be reached, the search looks for settings within a tenth of the least
     * one. */
    if (!q.reached) search_settings(world, plan, 1.1 * q.least.error, &q);
    plan->best = q.reached ? q.best : plan->current; /* otherwise there are no alternatives */
    return GNEISS_OK;
}
