/* A step with consistent masses, which couple the nodes of zones (couple/consistent.h): the
 * correction of the lumped motion, the difference of its energy, and the inertia of nodes against a
 * force at the position of a particle. */
#include "couple/consistent.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "sched/hold.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

void gn_masses_store(const gn_solids *solids, gn_coupled *q) {
    const gn_particles *nodes = &gn_coupled_solid(solids)->nodes;
    for (size_t n = 0; n < q->ties.nodes; n++)
        memcpy(q->before + 3 * n, nodes->vel + 4 * (size_t)q->ties.node[n], 3 * sizeof(double));
}

/* Sets up the system with all loads except gravity and background damping, which the lumped motion
 * adds: gravity is exact there, and damping is proportional to the lumped mass. */
static void set_system(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const double interval = 0.5 * (ctx->dt_past + ctx->dt);
    gn_consistent *y = &q->consistent;
    y->threads = ctx->threads;
    for (size_t n = 0; n < q->ties.nodes; n++) {
        const size_t node = (size_t)q->ties.node[n];
        const int32_t slot = b->prescribed.count ? b->nodes.slot[node] : -1;
        const double *row = gn_hold_load(&b->hold, 4, node), *v = b->nodes.vel + 4 * node;
        y->whole[n] = 1.0 / v[3];
        for (size_t a = 0; a < 3; a++) {
            const bool there = a < (size_t)ctx->scene.dimension;
            y->fixed[3 * n + a] = !there || (slot >= 0 && b->prescribed.mask[slot] >> a & 1);
            y->load[3 * n + a] = there ? row[a] + b->nodes.applied[4 * node + a] : 0.0;
            y->rate[3 * n + a] =
                there && y->fixed[3 * n + a] && ctx->dt_past > 0.0
                    ? (b->prescribed.velocity[6 * (size_t)slot + a] - v[a]) / interval
                    : 0.0;
        }
    }
}

void gn_masses_correct(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    gn_consistent *y = &q->consistent;
    set_system(ctx, solids, q);
    gn_consistent_solve(y);
    gn_consistent_difference(y, y->rate, y->work[0]);
    for (size_t n = 0; n < q->ties.nodes; n++) {
        double *row = gn_hold_load(&b->hold, 4, (size_t)q->ties.node[n]);
        for (int a = 0; a < (int)ctx->scene.dimension; a++) row[a] += y->work[0][3 * n + a];
    }
}

/* Books the difference of the damping. Viscous damping of the lumped motion, -a lump (v(-) +
 * v(+))/2, is added to the accelerations r that the masses have without it, f = M r: lump dv/dt = f
 * + (lump - M) r - a lump v gives dv/dt = r - a v, so that with the consistent masses M dv/dt = f -
 * a M v. The dissipation is that of M, in the halves before and after the instant, as for nodes. */
static void book_damping(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    gn_consistent *y = &q->consistent;
    double *mean = y->work[1], *over = y->work[0], past = 0.0, coming = 0.0;
    if (!(ctx->effects & GN_FX_VISCOUS)) return;
    for (size_t n = 0; n < q->ties.nodes; n++)
        for (size_t a = 0; a < 3; a++)
            mean[3 * n + a] =
                0.5 * (q->before[3 * n + a] + b->nodes.vel[4 * (size_t)q->ties.node[n] + a]);
    gn_consistent_difference(y, mean, over);
    for (size_t n = 0; n < q->ties.nodes; n++)
        for (size_t a = 0; a < 3; a++) {
            past += over[3 * n + a] * q->before[3 * n + a];
            coming += over[3 * n + a] * b->nodes.vel[4 * (size_t)q->ties.node[n] + a];
        }
    past *= -0.5 * ctx->dt_past * b->damping_coefficient;
    b->energy.damping += past - 0.5 * ctx->dt * b->damping_coefficient * coming;
    if (b->measured) b->reading.damping += past;
}

/* Computes the difference of the kinetic energies, 1/2 v(-) (N^T M N - lump) v(+). */
static void find_kinetic(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q) {
    const gn_particles *nodes = &gn_coupled_solid(solids)->nodes;
    gn_consistent *y = &q->consistent;
    double *now = y->work[1];
    q->kinetic = 0.0;
    for (size_t n = 0; n < q->ties.nodes; n++)
        for (size_t a = 0; a < 3; a++) {
            now[3 * n + a] = nodes->vel[4 * (size_t)q->ties.node[n] + a];
            if (!(ctx->dt_past > 0.0))
                q->before[3 * n + a] = 2.0 * q->before[3 * n + a] - now[3 * n + a];
        }
    gn_consistent_difference(y, now, y->work[0]);
    for (size_t k = 0; k < 3 * q->ties.nodes; k++) q->kinetic -= 0.5 * q->before[k] * y->work[0][k];
    if (ctx->step > 0) return;
    gn_coupled_solid(solids)->energy.stored_at_start += q->kinetic;
    gn_coupled_solid(solids)->reading.stored_at_start += q->kinetic;
}

void gn_masses_book(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q) {
    book_damping(ctx, solids, q);
    find_kinetic(ctx, solids, q);
}

/* Sets the inverse masses of particles of zones. Since v_i = N_a v_a, a force at the position of
 * particle i accelerates it by y = N_a N_a/m_a times the force. With consistent masses, the masses
 * of the nodes alone and the particle's own mass m resist at least: with y of the nodes alone, (D +
 * m N N^T)^-1 gives y/(1 + m y). Driven nodes count as free. */
void gn_coupled_inverse_masses(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, const gn_zones *zones, double *inverse) {
    const gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    if (!q || q->stiffness) return;
    const gn_fem_solid *b = gn_coupled_solid(solids);
    for (size_t k = 0; k < q->ties.count; k++) {
        const gn_tie *t = &q->ties.tie[k];
        const int32_t p = dem->index_of_id[t->id];
        double give = 0.0;
        if (p < 0 || !(inverse[p] > 0.0)) continue;
        for (int a = 0; a < q->ties.corners; a++) {
            const size_t node = (size_t)t->node[a];
            const double whole = 1.0 / b->nodes.vel[4 * node + 3];
            const double mass = q->before && b->carried ? whole - b->carried[node] : whole;
            give += t->shape[a] * t->shape[a] / fmax(mass, 1e-9 * whole);
        }
        inverse[p] = q->before ? give / (1.0 + give / inverse[p]) : give;
    }
}
