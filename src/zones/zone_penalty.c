/* Springs between particles of zones and the points of the elements at which the particles started.
 * Stiffnesses are proportional to masses, so that a particle of little mass does not shorten the
 * step:
 *     k_i = kappa w^2 mu_i,   mu_i = m_i M_i/(m_i + M_i),   M_i = sum_a N_a m_a/(sum_j N_a(X_j)),
 * where w is the largest frequency of the particles and M_i the share of the nodes' mass that holds
 * the particle. A dashpot 2 xi sqrt(k_i mu_i) may act in parallel.
 *
 * Step: with |a - b|^2 <= (1 + e) |a|^2 + (1 + 1/e) |b|^2 for any e > 0 the square of the largest
 * frequency of the whole is at most
 *     max( w_D^2 + (1 + e) max_i k_i/m_i, w_F^2 + (1 + 1/e) max_a sum_i k_i N_a(X_i)/m_a ). */
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "sched/hold.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>

gneiss_status gn_penalty_create(gn_coupled *q, gneiss_error *error) {
    const size_t n = q->ties.count + 1;
    q->stiffness = gn_alloc_array(n, sizeof *q->stiffness);
    q->viscosity = gn_alloc_array(n, sizeof *q->viscosity);
    q->stored = gn_alloc_array(n, sizeof *q->stored);
    q->lost = gn_alloc_array(n, sizeof *q->lost);
    q->drag = gn_alloc_array(n, sizeof *q->drag);
    q->twist = gn_alloc_array(n, sizeof *q->twist);
    q->sum = gn_alloc_array(q->ties.nodes + 1, sizeof *q->sum);
    if (q->stiffness && q->viscosity && q->stored && q->lost && q->drag && q->twist && q->sum)
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu springs of zones", n - 1);
}

/* Sets `gap`, m, to the vector from a particle to its point in the elements. */
static void gap_of(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q, size_t k,
                   double gap[3]) {
    const gn_particles *a = &dem->particles, *nodes = &gn_coupled_solid(solids)->nodes;
    const size_t p = 4 * (size_t)q->place[k];
    gn_tie_travel(&q->ties, k, nodes, gap);
    for (size_t c = 0; c < 3; c++) gap[c] -= a->pos[p + c] - a->start[p + c];
}

/* Sets `slip`, m/s, to the velocity of that point less that of the particle's centre. */
static void slip_of(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q, size_t k,
                    double slip[3]) {
    const double *v = dem->particles.vel + 4 * (size_t)q->place[k];
    gn_tie_mean(&q->ties, k, gn_coupled_solid(solids)->nodes.vel, slip);
    for (size_t c = 0; c < 3; c++) slip[c] -= v[c];
}

/* Sets `spin`, rad/s, to that of the particle; 0 if particles do not rotate. */
static void spin_of(const gn_dem *dem, const gn_coupled *q, size_t k, double spin[3]) {
    const double *all = dem->particles.spin;
    for (size_t c = 0; c < 3; c++) spin[c] = all ? all[4 * (size_t)q->place[k] + c] : 0.0;
}

/* --- stiffnesses --- */

/* Sets `sum` [nodes of ties] to sums of N_a(X_i) times the factor of each tie; NULL: 1. */
static void sum_over_ties(const gn_ties *t, const double *factor, double *sum) {
    for (size_t n = 0; n < t->nodes; n++) {
        sum[n] = 0.0;
        for (int32_t s = t->first[n]; s < t->first[n + 1]; s++)
            sum[n] += t->tie[t->share[s].tie].shape[t->share[s].corner] *
                      (factor ? factor[t->share[s].tie] : 1.0);
    }
}

static double node_mass(const gn_solids *solids, const gn_coupled *q, size_t n) {
    return 1.0 / gn_coupled_solid(solids)->nodes.vel[4 * (size_t)q->ties.node[n] + 3];
}

void gn_penalty_set(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    const gn_zones *zones, gn_coupled *q) {
    const gn_ties *t = &q->ties;
    const double w2 = zones->state.frequency * zones->state.frequency;
    double *sum = q->sum;
    sum_over_ties(t, NULL, sum);
    for (size_t k = 0; k < t->count; k++) {
        double mass = 0.0, own = 0.0;
        for (int a = 0; a < t->corners; a++) {
            size_t n = (size_t)t->tie[k].own[a];
            /* For a particle on a face of an element, rounding may give the opposite corner a share
             * of either sign. */
            if (!(t->tie[k].shape[a] > 1e-9)) continue;
            mass += t->tie[k].shape[a] * node_mass(solids, q, n) / sum[n];
        }
        double inverse = q->place[k] >= 0 ? dem->particles.vel[4 * (size_t)q->place[k] + 3] : 0.0;
        own = inverse > 0.0 ? 1.0 / inverse : 0.0;
        double both = own > 0.0 && mass > 0.0 ? own * mass / (own + mass) : 0.0;
        q->stiffness[k] = ctx->scene.couple.penalty * w2 * both;
        q->viscosity[k] = 2.0 * ctx->scene.couple.penalty_damping * sqrt(q->stiffness[k] * both);
    }
}

/* Computes what springs add to w_D^2 and w_F^2, without the factors that depend on e. */
static void find_added(const gn_dem *dem, const gn_solids *solids, gn_coupled *q, double most[2]) {
    const gn_ties *t = &q->ties;
    most[0] = most[1] = 0.0;
    for (size_t k = 0; k < t->count; k++)
        if (q->place[k] >= 0)
            most[0] =
                fmax(most[0], q->stiffness[k] * dem->particles.vel[4 * (size_t)q->place[k] + 3]);
    sum_over_ties(t, q->stiffness, q->sum);
    for (size_t n = 0; n < t->nodes; n++)
        most[1] = fmax(most[1], q->sum[n] / node_mass(solids, q, n));
}

void gn_coupled_stiffen(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                        gn_zones *zones) {
    double most[2], particles, elements, low = 1e-6, high = 1e6;
    gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    if (!q || !q->stiffness) return;
    particles = 2.0 / ctx->choice.stable;
    elements = 2.0 / gn_elements_stable(solids);
    zones->state.frequency = particles;
    gn_penalty_set(ctx, dem, solids, zones, q);
    find_added(dem, solids, q, most);
    for (int round = 0; round < 60; round++) { /* one side grows with e, the other decreases */
        double e = sqrt(low * high);
        bool above = particles * particles + (1.0 + e) * most[0] >
                     elements * elements + (1.0 + 1.0 / e) * most[1];
        *(above ? &high : &low) = e;
    }
    /* With the fraction xi of critical damping, the dashpot multiplies the step of its spring by
     * sqrt(1 + xi^2) - xi. */
    double xi = ctx->scene.couple.penalty_damping, faster = sqrt(1.0 + xi * xi) + xi;
    zones->state.rate[0] = 0.5 * sqrt((1.0 + high) * most[0]) * faster;
    zones->state.rate[1] = 0.5 * sqrt((1.0 + 1.0 / high) * most[1]) * faster;
}

/* --- part in a step --- */

/* Adds the moment, N m, of the dashpot. A dashpot acts across the gap as well. On a particle that
 * rotates, it acts at the particle's point in the elements, at the end of the gap, so that the
 * forces on both sides are on one line. */
static void add_twist(gn_dem *dem, gn_coupled *q, size_t k, int width, const double gap[3],
                      const double drag[3]) {
    const size_t at = width == 8 ? 4 : 0;
    double *row = gn_hold_load(&dem->hold, width, (size_t)q->place[k]);
    gn_cross3(gap, drag, q->twist[k]);
    for (size_t a = width == 8 ? 0 : 2; dem->particles.spin && a < 3; a++)
        row[at + a] += q->twist[k][a];
}

static void pull(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_coupled *q,
                 size_t k, int width) {
    double gap[3], slip[3], spin[3], with[3];
    q->stored[k] = q->lost[k] = 0.0;
    q->load[k][0] = q->load[k][1] = q->load[k][2] = 0.0;
    if (q->place[k] < 0) return;
    gap_of(dem, solids, q, k, gap);
    slip_of(dem, solids, q, k, slip);
    spin_of(dem, q, k, spin);
    gn_cross3(spin, gap, with);
    double *row = gn_hold_load(&dem->hold, width, (size_t)q->place[k]);
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        slip[a] -= with[a];
        double viscous = q->viscosity[k] * slip[a], force = q->stiffness[k] * gap[a] + viscous;
        q->stored[k] += 0.5 * q->stiffness[k] * gap[a] * gap[a];
        q->lost[k] += 0.5 * ctx->dt_past * viscous * slip[a];
        q->drag[k][a] = viscous;
        row[a] += force;
        q->load[k][a] = -force;
    }
    if (q->viscosity[k] > 0.0) add_twist(dem, q, k, width, gap, q->drag[k]);
}

static double total(const double *value, size_t count) {
    double sum = 0.0;
    for (size_t k = 0; k < count; k++) sum += value[k];
    return sum;
}

void gn_penalty_act(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_coupled *q,
                    gn_ledger *ledger) {
    const int width = gn_row_width(ctx->scene.dimension == 3, ctx->effects & GN_FX_ROTATION);
#pragma omp parallel for schedule(static) num_threads(gn_coupled_team(ctx, dem, q->ties.count))
    for (size_t k = 0; k < q->ties.count; k++) pull(ctx, dem, solids, q, k, width);
    gn_coupled_add_to_nodes(ctx, dem, solids, q);
    ledger->energy.coupling_damping += total(q->lost, q->ties.count);
}

/* Books the second half of the work of dashpots. */
void gn_penalty_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       gn_coupled *q, gn_ledger *ledger) {
    for (size_t k = 0; k < q->ties.count; k++) {
        double slip[3], spin[3];
        q->lost[k] = 0.0;
        if (q->place[k] < 0 || !(q->viscosity[k] > 0.0)) continue;
        slip_of(dem, solids, q, k, slip);
        spin_of(dem, q, k, spin);
        for (int a = 0; a < (int)ctx->scene.dimension; a++)
            q->lost[k] += 0.5 * ctx->dt * q->drag[k][a] * slip[a];
        q->lost[k] -= 0.5 * ctx->dt * gn_dot3(q->twist[k], spin);
    }
    ledger->energy.coupling_damping += total(q->lost, q->ties.count);
}

void gn_penalty_book(const gn_coupled *coupled, gn_energy *reading) {
    reading->elastic_coupling += total(coupled->stored, coupled->ties.count);
}

/* --- springs at walls --- */

/* Returns the tie of a particle that is held by a spring; q->ties.count: no spring holds it. */
static size_t spring_of(const gn_zones *zones, size_t particle) {
    const gn_coupled *q = zones->coupled;
    const gn_tie *tie = gn_coupled_tie(q, zones->dem->particles.id[particle]);
    return tie ? (size_t)(tie - q->ties.tie) : q->ties.count;
}

static double held_stiffness(const void *context, size_t particle) {
    const gn_zones *zones = context;
    const gn_coupled *q = zones->coupled;
    const size_t k = spring_of(zones, particle);
    return k < q->ties.count ? q->stiffness[k] : 0.0;
}

/* Returns the acceleration by spring and dashpot, which act at the present positions. */
static double held_acceleration(const void *context, size_t particle, const double n[3]) {
    const gn_zones *zones = context;
    const gn_coupled *q = zones->coupled;
    const size_t k = spring_of(zones, particle);
    double gap[3], slip[3], spin[3], with[3], sum = 0.0;
    if (k == q->ties.count) return 0.0;
    gap_of(zones->dem, zones->solids, q, k, gap);
    slip_of(zones->dem, zones->solids, q, k, slip);
    spin_of(zones->dem, q, k, spin);
    gn_cross3(spin, gap, with);
    for (size_t a = 0; a < 3; a++)
        sum -= n[a] * (q->stiffness[k] * gap[a] + q->viscosity[k] * (slip[a] - with[a]));
    return sum * zones->dem->particles.vel[4 * particle + 3];
}

void gn_penalty_hold(const gn_dem *dem, gn_boundary *boundary, const gn_solids *solids,
                     gn_zones *zones) {
    zones->dem = dem;
    zones->solids = solids;
    gn_boundary_set_holder(boundary, (gn_holder){zones, held_stiffness, held_acceleration});
}
