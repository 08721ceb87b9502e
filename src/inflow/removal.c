/* Particles that leave the domain, which stop the run, or leave the model with all they hold; and
 * those that sinks take. */
#include "inflow/removal.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "frame/ledger.h"
#include "frame/step_context.h"
#include "kernels/law.h"
#include "laboratory/strain_gauge.h"
#include "particles/dem.h"
#include "particles/flow.h"
#include "scene/scene.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "world/origin.h"
#include "world/world.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

/* --- who --- */

/* Beyond the reach of its coordinates a particle has left the domain, however large that is. */
static bool in_domain(const gn_step_context *ctx, const double *x, double reach) {
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        if (!(x[a] >= ctx->scene.domain_min[a] && x[a] <= ctx->scene.domain_max[a] &&
              fabs(x[a]) <= reach))
            return false;
    return true;
}

static gneiss_status left_domain(const gn_step_context *ctx, const gn_dem *dem, size_t p,
                                 double reach, gneiss_error *error) {
    const double *x = dem->particles.pos + 4 * p, *v = dem->particles.vel + 4 * p;
    char at[GN_POINT_SIZE], why[160] = "";
    if (in_domain(ctx, x, INFINITY))
        snprintf(
            why, sizeof why,
            "; beyond %g m from the origin places are too coarse for the smallest radius, %g m",
            reach, dem->radius_min);
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "step %lld, t = %g s: particle %d left the domain at %s m with (%g, %g, %g) m/s "
                   "(domain.lost: remove lets a run go on without it)%s",
                   (long long)ctx->step, ctx->time, dem->particles.id[p],
                   gn_point_text(ctx->scene.origin, x, at), v[0], v[1], v[2], why);
}

/* How a particle goes: 0 it stays, LEFT the domain, from 1 on by a sink, base 1. */
enum { LEFT = -1 };

static int32_t way_out(const gn_step_context *ctx, const gn_dem *dem, size_t p, double reach) {
    const gn_particles *q = &dem->particles;
    const double *x = q->pos + 4 * p;
    if (!gn_particle_is_active(q, p)) return 0;
    for (size_t k = 0; k < ctx->scene.sink_count; k++)
        if (gn_sink_takes(ctx, dem, k, p)) return (int32_t)k + 1;
    return ctx->scene.has_domain && !in_domain(ctx, x, reach) ? LEFT : 0;
}

/* Marks those that go in `gone` (NULL: only counted). */
static size_t mark_gone(const gn_step_context *ctx, const gn_dem *dem, int32_t *gone) {
    double reach = gn_finest_reach(dem->radius_min);
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        int32_t way = way_out(ctx, dem, p, reach);
        if (gone) gone[p] = way;
        count += way != 0;
        if (way == LEFT && ctx->scene.lost == GN_LOST_STOP) return count;
    }
    return count;
}

/* --- what their contacts held --- */

/* A particle leaves at the end of a step, when velocities are those of the half step before and its
 * contacts will never be looked at where they are now. So what a contact takes with it is what its
 * springs stored at the last instant, and the work that its force of that instant took up over half
 * of the step, which the velocities have had: `power`, at which the two sides move apart against
 * it. That closes the ledger exactly. The dashpot's part of the power is dissipated. */
static void book_contact(const gn_step_context *ctx, gn_ledger *ledger, double stored, double power,
                         double viscous) {
    ledger->energy.removed += stored + 0.5 * ctx->dt_past * (power - viscous);
    ledger->energy.contact_damping += 0.5 * ctx->dt_past * viscous;
}

/* Power of the moments, whose arms are those of the last instant. */
static double turning_power(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                            double length, const double n[3], const double t[3]) {
    const gn_particles *q = &dem->particles;
    double moment[3], ri = q->pos[4 * i + 3], rj = q->pos[4 * j + 3];
    double half = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 * (length - (ri + rj)) : 0.0;
    if (!q->spin) return 0.0;
    gn_cross3(n, t, moment);
    return (ri + half) * gn_dot3(moment, q->spin + 4 * i) +
           (rj + half) * gn_dot3(moment, q->spin + 4 * j);
}

/* A contact between particles, where they were at the last instant. */
static void book_pair(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                      const gn_contacts *k, size_t c) {
    const gn_particles *q = &dem->particles;
    size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
    double n[3], v[3], force[3];
    gn_branch(ctx, q->pos + 4 * i, q->pos + 4 * j, n);
    for (size_t a = 0; a < 3; a++) {
        v[a] = q->vel[4 * j + a] - q->vel[4 * i + a];
        n[a] -= ctx->dt_past * v[a];
    }
    double length = sqrt(gn_dot3(n, n));
    if (!(length > 0.0)) return;
    double free = k->length0 ? k->length0[c] : q->pos[4 * i + 3] + q->pos[4 * j + 3];
    gn_law_held h = gn_law_of(k->soa.effects)->held(k, c, length, length - free);
    for (size_t a = 0; a < 3; a++) {
        n[a] /= length;
        force[a] = (h.normal + h.viscous) * n[a] + h.shear[a];
    }
    double power = gn_dot3(force, v) - turning_power(ctx, dem, i, j, length, n, h.shear);
    const gn_law *law = gn_law_of(k->soa.effects);
    gn_law_moments m = {0};
    if (law->moments && q->spin) m = law->moments(k, c, n);
    for (size_t a = 0; q->spin && a < 3; a++)
        power += m.couple[a] * (q->spin[4 * j + a] - q->spin[4 * i + a]);
    book_contact(ctx, ledger, h.stored + m.stored, power, h.viscous * gn_dot3(n, v));
}

/* A contact with a wall or a facet: its row holds the force of the last instant. */
static void book_wall_contact(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                              gn_ledger *ledger, size_t c) {
    const gn_wall_contacts *k = &boundary->contacts;
    const gn_particles *q = &dem->particles;
    size_t p = (size_t)k->i[c];
    const double *force = k->row + 8 * c, *moment = force + 4;
    gn_row_side s = gn_row_side_of(ctx, dem, boundary, c);
    if (gn_dot3(s.n, s.n) == 0.0) return;
    double v[3], t2 = 0.0, viscous = k->fd ? k->fd[c] : 0.0;
    for (size_t a = 0; a < 3; a++) {
        double t = k->shear ? k->shear[c + a * k->soa.capacity] : 0.0;
        v[a] = s.v[a] - q->vel[4 * p + a];
        t2 += t * t;
    }
    double pressed = fmin(0.0, gn_dot3(force, s.n) - viscous), power = gn_dot3(force, v);
    double stored = gn_law_of(ctx->effects)->touch_stored(&s.law, pressed, t2);
    if (q->spin) power -= gn_dot3(moment, q->spin + 4 * p);
    book_contact(ctx, ledger, stored, power, viscous * gn_dot3(s.n, v));
}

static void book_pairs(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                       const gn_contacts *k, const int32_t *gone) {
    for (size_t c = 0; c < k->soa.count; c++)
        if (gone[k->i[c]] || gone[k->j[c]]) book_pair(ctx, dem, ledger, k, c);
}

static void book_contacts(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          gn_ledger *ledger, const int32_t *gone) {
    for (int l = 0; l < GN_LIST_COUNT; l++)
        book_pairs(ctx, dem, ledger, &dem->list[l].contacts, gone);
    for (size_t c = 0; c < boundary->contacts.soa.count; c++)
        if (gone[boundary->contacts.i[c]]) book_wall_contact(ctx, dem, boundary, ledger, c);
}

/* --- leaving --- */

/* What a sink took. */
static void note_taken(gn_dem *dem, size_t sink, size_t p, double energy) {
    gn_sink_state *s = &dem->flow.sinks[sink];
    const double *v = dem->particles.vel + 4 * p;
    s->number += 1.0;
    s->mass += 1.0 / v[3];
    s->energy += energy;
    for (int a = 0; a < 3; a++) s->momentum[a] += v[a] / v[3];
}

/* It stays where it was last seen, at rest, without mass. Its energy is booked as carried away. */
static gneiss_status take_out(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger, size_t p,
                              int32_t way, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    double *v = q->vel + 4 * p, *o = q->spin ? q->spin + 4 * p : NULL;
    double energy = 0.5 * gn_dot3(v, v) / v[3] + (o ? 0.5 * gn_dot3(o, o) / o[3] : 0.0);
    ledger->energy.removed += energy;
    if (way == LEFT)
        GN_TRY(gn_flow_note_lost(ctx, dem, p, error));
    else
        note_taken(dem, (size_t)way - 1, p, energy);
    dem->lost += way == LEFT;
    memset(v, 0, 4 * sizeof *v);
    if (o) memset(o, 0, 4 * sizeof *o);
    if (q->slot) q->slot[p] = -1;
    return GNEISS_OK;
}

/* Contacts of persistent lists stay in them. The work of their dashpots has been booked. */
static void release_contacts(const gn_step_context *ctx, gn_contacts *b, const int32_t *gone) {
    for (size_t c = 0; c < b->soa.count; c++) {
        if (!gone[b->i[c]] && !gone[b->j[c]]) continue;
        if (gn_contact_bonded(b, c)) {
            b->cause[c] = GN_BOND_LEFT;
            b->broken_time[c] = ctx->time;
        }
        gn_law_of(b->soa.effects)->release(b, c);
    }
}

static gneiss_status remove_gone(gn_world *w, const int32_t *gone, gneiss_error *error) {
    book_contacts(&w->ctx, &w->dem, &w->boundary, &w->ledger, gone);
    gn_coupled_leave(&w->ctx, &w->dem, &w->solids, &w->zones, &w->ledger, gone);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        if (gone[p]) GN_TRY(take_out(&w->ctx, &w->dem, &w->ledger, p, gone[p], error));
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_kinds[l]->persistent) release_contacts(&w->ctx, &w->dem.list[l].contacts, gone);
    return gn_gauge_leave(&w->ctx, &w->dem, &w->gauge, error);
}

gneiss_status gn_dem_check_domain(gn_world *w, gneiss_error *error) {
    size_t n = w->dem.particles.soa.count, p = 0;
    gn_flow_count(&w->ctx, &w->dem);
    if ((!w->ctx.scene.has_domain && !w->ctx.scene.sink_count) ||
        !mark_gone(&w->ctx, &w->dem, NULL))
        return GNEISS_OK;
    int32_t *gone = gn_alloc_array(n + 1, sizeof *gone);
    if (!gone) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at %zu particles", n);
    mark_gone(&w->ctx, &w->dem, gone);
    while (w->ctx.scene.lost == GN_LOST_STOP && p < n && gone[p] != LEFT) p++;
    gneiss_status status =
        w->ctx.scene.lost == GN_LOST_STOP && p < n
            ? left_domain(&w->ctx, &w->dem, p, gn_finest_reach(w->dem.radius_min), error)
            : remove_gone(w, gone, error);
    gn_free(gone);
    return status;
}
