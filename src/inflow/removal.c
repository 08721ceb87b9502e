/* Particles that leave the domain stop the run or are removed with their energy; sinks remove
 * particles. */
#include "inflow/removal.h"
#include "base/ball.h"
#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "pack/domain.h"
#include "particles/flow.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/flow_def.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- leaving particles --- */

/* Tells whether a particle is in the domain; beyond the range of coordinates it has left, whatever
 * its size. */
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

/* --- thin sinks: particles that pass through them between two lists --- */

/* Returns the least extent of the region of a sink, m; for a polygon an upper bound; INFINITY: a
 * plane. */
static double sink_width(const gn_step_context *ctx, const gn_dem *dem, size_t sink) {
    const gn_flow_region *r = &ctx->scene.sinks[sink].region;
    const gn_domain *region = dem->flow.region[ctx->scene.source_count + sink];
    double lower[3], upper[3], width = INFINITY, around = 0.0;
    if (!region) return INFINITY;
    gn_domain_bounds(region, lower, upper);
    for (int a = 0; a < gn_domain_dimension(region); a++) width = fmin(width, upper[a] - lower[a]);
    for (size_t k = 0; k < r->corner_count; k++) {
        const double *x = r->corners + 2 * k, *y = r->corners + 2 * ((k + 1) % r->corner_count);
        around += hypot(y[0] - x[0], y[1] - x[1]);
    }
    /* This is twice the area over the perimeter, the width of a long strip and less than that of
     * other polygons. */
    return around > 0.0 ? fmin(width, 2.0 * gn_domain_volume(region) / around) : width;
}

/* Tells whether a sink is thin: a particle is entirely inside for hardly longer than lists may
 * last. The skin may grow to six times its value at the start. */
static bool is_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink) {
    return ctx->scene.sinks[sink].remove &&
           sink_width(ctx, dem, sink) - 2.0 * dem->flow.largest < 12.0 * dem->verlet.skin_start;
}

enum { PLACES = 16, HALVINGS = 40 };
/* Fraction of a radius by which a particle may protrude, within rounding, and count as inside. */
static const double rounding = 1e-9;

/* Returns the depth, m, of a particle's centre in a region at a fraction of its last step, counted
 * backwards. */
static double depth_before(const gn_step_context *ctx, const gn_dem *dem, const gn_domain *region,
                           size_t particle, double share) {
    const gn_particles *q = &dem->particles;
    double at[3];
    for (int a = 0; a < 3; a++)
        at[a] = q->pos[4 * particle + a] - share * ctx->dt_past * q->vel[4 * particle + a];
    return gn_domain_depth(region, at);
}

/* Returns the largest depth between two fractions of the last step; along a line through a convex
 * region depth has one maximum. */
static double deepest_between(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_domain *region, size_t particle, double from, double to) {
    for (int k = 0; k < HALVINGS; k++) {
        const double low = from + 0.382 * (to - from), high = to - 0.382 * (to - from);
        if (depth_before(ctx, dem, region, particle, low) >
            depth_before(ctx, dem, region, particle, high))
            to = high;
        else
            from = low;
    }
    return depth_before(ctx, dem, region, particle, 0.5 * (from + to));
}

/* Tells whether a particle was entirely inside at any instant of the last step. The depth changes
 * by at most the path, which is at most half of the smallest radius (paths.c). */
static bool passed(const gn_step_context *ctx, const gn_dem *dem, size_t sink, size_t particle) {
    const gn_domain *region = dem->flow.region[ctx->scene.source_count + sink];
    const double *v = dem->particles.vel + 4 * particle,
                 needed = (1.0 - rounding) * dem->particles.pos[4 * particle + 3],
                 part = ctx->dt_past * sqrt(gn_dot3(v, v)) / PLACES;
    double deepest = -INFINITY;
    int best = 0;
    for (int k = 0; k <= PLACES; k++) {
        const double depth = depth_before(ctx, dem, region, particle, (double)k / PLACES);
        if (depth > deepest) {
            deepest = depth;
            best = k;
        }
    }
    if (deepest >= needed || deepest + part < needed) return deepest >= needed;
    return deepest_between(ctx, dem, region, particle, fmax(0, best - 1) / PLACES,
                           fmin(PLACES, best + 1) / PLACES) >= needed;
}

/* Tells whether a particle is in a sink, or was there at any time of the last step if the sink is
 * thin. */
static bool sink_takes(const gn_step_context *ctx, const gn_dem *dem, size_t sink,
                       size_t particle) {
    return gn_sink_has(ctx, dem, sink, dem->particles.pos + 4 * particle) ||
           (is_thin(ctx, dem, sink) && passed(ctx, dem, sink, particle));
}

/* --- particles that leave --- */

/* Fates of a particle: 0: it stays; LEFT: it has left the domain; k > 0: sink k - 1 removes it. */
enum { LEFT = -1 };

static int32_t way_out(const gn_step_context *ctx, const gn_dem *dem, size_t p, double reach) {
    const gn_particles *q = &dem->particles;
    const double *x = q->pos + 4 * p;
    if (!gn_particle_is_active(q, p)) return 0;
    for (size_t k = 0; k < ctx->scene.sink_count; k++)
        if (sink_takes(ctx, dem, k, p)) return (int32_t)k + 1;
    return ctx->scene.has_domain && !in_domain(ctx, x, reach) ? LEFT : 0;
}

/* Marks leaving particles in `gone` (NULL: only counts them). */
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

/* --- energy of their contacts --- */

/* Books the energy of the contact of a particle that leaves. It leaves at the end of a step, when
 * velocities are those of half a step before, and its contacts will not be evaluated at the present
 * positions. The contact therefore removes the energy that its springs stored at the last instant,
 * and the work that its force of that instant did over half of the step, which the velocities
 * contain: `power` is that with which the two sides separate against the force. This closes the
 * ledger exactly. The dashpot's part of the power is dissipated. */
static void book_contact(const gn_step_context *ctx, gn_ledger *ledger, double stored, double power,
                         double viscous) {
    ledger->energy.removed += stored + 0.5 * ctx->dt_past * (power - viscous);
    ledger->energy.contact_damping += 0.5 * ctx->dt_past * viscous;
}

/* Returns the power of the moments; their arms are those of the last instant. */
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

/* Books a contact between particles at their positions of the last instant. */
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

/* Books a contact with a wall or a facet, whose row contains the force of the last instant. */
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

/* --- removal --- */

/* Records a particle that a sink has taken. */
static void note_taken(gn_dem *dem, size_t sink, size_t p, double energy) {
    gn_sink_state *s = &dem->flow.sinks[sink];
    const double *v = dem->particles.vel + 4 * p;
    s->number += 1.0;
    s->mass += 1.0 / v[3];
    s->energy += energy;
    for (int a = 0; a < 3; a++) s->momentum[a] += v[a] / v[3];
}

/* Takes a particle out: it stays at its last position, at rest and without mass, and its energy is
 * booked as carried away. */
static gneiss_status take_out(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger, size_t p,
                              int32_t way, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    double *v = q->vel + 4 * p, *o = q->spin ? q->spin + 4 * p : NULL;
    double energy = gn_clump_of(dem, p)
                        ? gn_clumps_remove(dem, p)
                        : 0.5 * gn_dot3(v, v) / v[3] + (o ? 0.5 * gn_dot3(o, o) / o[3] : 0.0);
    ledger->energy.removed += energy;
    if (way == LEFT)
        GN_TRY(gn_flow_note_lost(ctx, dem, p, error));
    else
        note_taken(dem, (size_t)way - 1, p, energy);
    memset(v, 0, 4 * sizeof *v);
    if (o) memset(o, 0, 4 * sizeof *o);
    if (q->slot) q->slot[p] = -1;
    return GNEISS_OK;
}

/* Releases contacts, which stay in persistent lists. The work of their dashpots has been booked. */
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

gneiss_status gn_particles_find_gone(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                     gn_ledger *ledger, int32_t **gone, gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    size_t p = 0;
    *gone = NULL;
    gn_flow_count(ctx, dem);
    if ((!ctx->scene.has_domain && !ctx->scene.sink_count) || !mark_gone(ctx, dem, NULL))
        return GNEISS_OK;
    *gone = gn_alloc_array(n + 1, sizeof **gone);
    if (!*gone) return gn_no_memory(error, "removed particles");
    mark_gone(ctx, dem, *gone);
    if (dem->clumps.count) gn_clumps_leave_whole(dem, *gone);
    while (ctx->scene.lost == GN_LOST_STOP && p < n && (*gone)[p] != LEFT) p++;
    if (ctx->scene.lost == GN_LOST_STOP && p < n)
        return left_domain(ctx, dem, p, gn_finest_reach(dem->radius_min), error);
    book_contacts(ctx, dem, boundary, ledger, *gone);
    return GNEISS_OK;
}

gneiss_status gn_particles_take_out(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                                    const int32_t *gone, gneiss_error *error) {
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        if (gone[p]) GN_TRY(take_out(ctx, dem, ledger, p, gone[p], error));
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_kinds[l]->persistent) release_contacts(ctx, &dem->list[l].contacts, gone);
    return GNEISS_OK;
}

/* Tells whether the centre of a particle is in the box around the region, extended by the last
 * path. */
static bool is_near(const gn_step_context *ctx, const gn_dem *dem, const double lower[3],
                    const double upper[3], size_t p) {
    const double *x = dem->particles.pos + 4 * p, *v = dem->particles.vel + 4 * p;
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        const double way = ctx->dt_past * fabs(v[a]);
        if (x[a] + way < lower[a] || x[a] - way > upper[a]) return false;
    }
    return gn_particle_is_active(&dem->particles, p);
}

bool gn_sinks_are_due(const gn_step_context *ctx, const gn_dem *dem) {
    for (size_t k = 0; k < ctx->scene.sink_count; k++) {
        const gn_domain *region = dem->flow.region[ctx->scene.source_count + k];
        double lower[3], upper[3];
        if (!region || !is_thin(ctx, dem, k)) continue;
        gn_ranks_whole(ctx->ranks);
        gn_domain_bounds(region, lower, upper);
        for (size_t p = 0; p < dem->particles.soa.count; p++)
            if (is_near(ctx, dem, lower, upper, p) && sink_takes(ctx, dem, k, p)) return true;
    }
    return false;
}

bool gn_sink_is_too_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink, char *text,
                         size_t size) {
    const double width = sink_width(ctx, dem, sink), most = 2.0 * gn_flow_widest_radius(ctx, dem),
                 least = 2.0 * dem->radius_min;
    if (!ctx->scene.sinks[sink].remove || !(width < (1.0 - rounding) * most)) return false;
    snprintf(text, size, "sink '%s' is %.4g m thick, and removes what is wholly inside: %s",
             ctx->scene.sinks[sink].name, width,
             width < (1.0 - rounding) * least
                 ? "it is thinner than any particle, and never removes one"
                 : "it is thinner than the largest particles, and never removes these");
    if (strlen(text) + 40 < size)
        snprintf(text + strlen(text), size - strlen(text), " (diameters of %.4g to %.4g m)", least,
                 most);
    return true;
}
