/* The sharp limit of particles and elements as one system, by Lanczos on an operator that contains
 * both and their coupling. The unknowns are M^1/2 v of the particles outside of zones and of the
 * nodes, with all mass that the nodes carry; particles of zones follow by N v and return the forces
 * N^T f. With consistent masses these, divided by the lumped masses that scale the unknowns, are
 * the metric. */
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "couple/consistent.h"
#include "fem/fem.h"
#include "fem/linear.h"
#include "frame/frame.h"
#include "limit/damped.h"
#include "limit/springs.h"
#include "limit/step_limits.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

typedef struct whole {
    gn_coupled *q;
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_solids *solids;
    gn_springs springs;
    gn_spring_operator pull;
    gn_fem_linear linear;
    size_t dim, dofs, own, count; /* number of unknowns of the particles, which come first */
    double *moved;                /* [own] velocities of all particles */
    double *moves;                /* [count] above 0: an unknown */
    double *mode;                 /* [count] the fastest mode */
    gn_whole_limit *limit;        /* the result */
    double (*gradient)[4][3];     /* [ties] with slaved spins: at the present positions */
} whole;

static void whole_free(whole *y) {
    gn_spring_operator_free(&y->pull);
    gn_springs_free(&y->springs);
    gn_fem_linear_free(&y->linear);
    gn_free(y->moved);
    gn_free(y->moves);
    gn_free(y->mode);
    gn_free(y->gradient);
}

/* --- coupling --- */

/* Returns the velocity component, m/s, of a corner of a tie. */
static double corner_speed(const whole *y, const gn_tie *t, int a, size_t c, const double *x) {
    const size_t k = y->dim * (size_t)t->node[a] + c;
    return y->linear.scale[k] * x[y->own + k];
}

/* Sets `spin`, the components that the dimension has, to half the curl of the nodes' velocity. */
static void spin_of(const whole *y, size_t k, const double *x, double *spin) {
    const gn_tie *t = &y->q->ties.tie[k];
    double sum[3] = {0.0};
    for (int a = 0; a < y->q->ties.corners; a++) {
        double v[3] = {0.0}, of[3];
        for (size_t c = 0; c < y->dim; c++) v[c] = corner_speed(y, t, a, c, x);
        gn_cross3(y->gradient[k][a], v, of);
        for (int c = 0; c < 3; c++) sum[c] += 0.5 * of[c];
    }
    memcpy(spin, sum + (y->dim == 3 ? 0 : 2), (y->dofs - y->dim) * sizeof *spin);
}

/* Sets the velocities of particles of zones from those of the nodes. */
static void follow(const whole *y, const double *x) {
    const gn_ties *ties = &y->q->ties;
    memcpy(y->moved, x, y->own * sizeof *x);
    for (size_t k = 0; k < ties->count; k++) {
        if (y->q->place[k] < 0) continue;
        double *at = y->moved + y->dofs * (size_t)y->q->place[k];
        for (size_t c = 0; c < y->dim; c++) {
            at[c] = 0.0;
            for (int a = 0; a < ties->corners; a++)
                at[c] += ties->tie[k].shape[a] * corner_speed(y, &ties->tie[k], a, c, x);
        }
        if (y->gradient) spin_of(y, k, x, at + y->dim);
    }
}

/* Adds N^T times the forces on particles of zones, and their moments if spins are slaved. */
static void hand_back(const whole *y, double *out) {
    const gn_ties *ties = &y->q->ties;
    for (size_t k = 0; k < ties->count; k++) {
        if (y->q->place[k] < 0) continue;
        const gn_tie *t = &ties->tie[k];
        double *force = out + y->dofs * (size_t)y->q->place[k], moment[3] = {0.0};
        if (y->gradient)
            memcpy(moment + (y->dim == 3 ? 0 : 2), force + y->dim,
                   (y->dofs - y->dim) * sizeof *moment);
        for (int a = 0; a < ties->corners; a++) {
            double turn[3] = {0.0};
            if (y->gradient) gn_cross3(moment, y->gradient[k][a], turn);
            for (size_t c = 0; c < y->dim; c++) {
                const size_t at = y->dim * (size_t)t->node[a] + c;
                out[y->own + at] += y->linear.scale[at] * (t->shape[a] * force[c] + 0.5 * turn[c]);
            }
        }
        memset(force, 0, (y->gradient ? y->dofs : y->dim) * sizeof *force);
    }
}

/* Adds the springs that pull particles of zones to their points in the elements. */
static void pull_together(const whole *y, double stiffness, double viscosity, const double *x,
                          double *out) {
    const gn_ties *ties = &y->q->ties;
    for (size_t k = 0; k < ties->count; k++) {
        if (y->q->place[k] < 0) continue;
        const gn_tie *t = &ties->tie[k];
        const size_t at = y->dofs * (size_t)y->q->place[k];
        const double hold = stiffness * y->q->stiffness[k] + viscosity * y->q->viscosity[k];
        for (size_t c = 0; c < y->dim; c++) {
            const double own = y->springs.scale[at + c];
            double gap = -own * x[at + c];
            for (int a = 0; a < ties->corners; a++)
                gap += t->shape[a] * corner_speed(y, t, a, c, x);
            out[at + c] -= own * hold * gap;
            for (int a = 0; a < ties->corners; a++) {
                const size_t node = y->dim * (size_t)t->node[a] + c;
                out[y->own + node] += y->linear.scale[node] * t->shape[a] * hold * gap;
            }
        }
    }
}

/* Multiplies `out`, which is scaled by lumped masses, by the inverse of the consistent mass matrix.
 */
static void solve_masses(const whole *y, double *out) {
    gn_consistent *c = &y->q->consistent;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t n = 0; n < y->q->ties.nodes; n++)
            for (size_t a = 0; a < y->dim; a++) {
                const size_t k = y->dim * (size_t)y->q->ties.node[n] + a;
                double *at = &out[y->own + k], scale = y->linear.scale[k];
                if (!(scale > 0.0)) continue;
                if (pass)
                    *at = c->rate[3 * n + a] / scale;
                else
                    c->load[3 * n + a] = *at / scale;
            }
        if (!pass) gn_consistent_solve(c);
    }
}

static void apply(const void *context, double stiffness, double viscosity, const double *x,
                  double *out) {
    const whole *y = context;
    const bool springs = y->q->stiffness;
    if (!springs) follow(y, x);
    gn_springs_apply(&y->pull, stiffness, viscosity, springs ? x : y->moved, out);
    gn_fem_linear_apply(&y->linear, x + y->own, out + y->own);
    for (size_t k = y->own; k < y->count; k++) out[k] *= stiffness;
    if (springs)
        pull_together(y, stiffness, viscosity, x, out);
    else
        hand_back(y, out);
    if (y->q->before) solve_masses(y, out);
}

static void metric(const void *context, const double *x, double *out) {
    const whole *y = context;
    gn_consistent *c = &y->q->consistent;
    memcpy(out, x, y->count * sizeof *x);
    for (size_t n = 0; n < y->q->ties.nodes; n++)
        for (size_t a = 0; a < 3; a++)
            c->rate[3 * n + a] = a < y->dim
                                     ? y->linear.scale[y->dim * (size_t)y->q->ties.node[n] + a] *
                                           x[y->own + y->dim * (size_t)y->q->ties.node[n] + a]
                                     : 0.0;
    gn_consistent_difference(c, c->rate, c->work[0]);
    for (size_t n = 0; n < y->q->ties.nodes; n++)
        for (size_t a = 0; a < y->dim; a++) {
            const size_t k = y->dim * (size_t)y->q->ties.node[n] + a;
            out[y->own + k] -= y->linear.scale[k] * c->work[0][3 * n + a];
        }
}

/* --- the operator --- */

/* Sets the masses of nodes; only components that cannot move are fixed. */
static void set_masses(const whole *y) {
    gn_consistent *c = &y->q->consistent;
    const gn_fem_solid *b = gn_coupled_solid(y->solids);
    c->threads = y->ctx->threads;
    for (size_t n = 0; n < y->q->ties.nodes; n++) {
        const size_t node = (size_t)y->q->ties.node[n];
        c->whole[n] = 1.0 / b->nodes.vel[4 * node + 3];
        for (size_t a = 0; a < 3; a++) {
            c->fixed[3 * n + a] = a >= y->dim || !(y->linear.scale[y->dim * node + a] > 0.0);
            c->load[3 * n + a] = c->rate[3 * n + a] = 0.0;
        }
    }
}

/* Selects the unknowns. Particles of zones only have unknowns of their own if springs hold them,
 * and for their spins if these are free. */
static void set_unknowns(const whole *y) {
    memcpy(y->moves, y->springs.scale, y->own * sizeof *y->moves);
    memcpy(y->moves + y->own, y->linear.scale, (y->count - y->own) * sizeof *y->moves);
    for (size_t k = 0; k < y->q->ties.count && !y->q->stiffness; k++) {
        if (y->q->place[k] < 0) continue;
        const size_t at = y->dofs * (size_t)y->q->place[k];
        for (size_t c = 0; c < (y->gradient ? y->dofs : y->dim); c++) {
            y->moves[at + c] = 0.0;
            y->springs.scale[at + c] =
                1.0; /* in the springs' terms these unknowns are velocities */
        }
    }
}

static gneiss_status make(const gn_spectrum *spectrum, whole *y, gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(y->solids);
    GN_TRY(gn_springs_build(spectrum, NULL, &y->springs, error));
    GN_TRY(gn_spring_operator_make(&y->springs, &y->pull, error));
    GN_TRY(gn_fem_linear_make(b, true, &y->linear, error));
    y->dim = (size_t)b->dimension;
    y->dofs = (size_t)y->springs.dofs;
    y->own = y->dofs * y->springs.particles;
    y->count = y->own + y->dim * b->nodes.soa.count;
    y->moved = gn_alloc_array(y->own + 1, sizeof *y->moved);
    y->moves = gn_alloc_array(y->count + 1, sizeof *y->moves);
    y->mode = gn_alloc_array(y->count + 1, sizeof *y->mode);
    if (y->q->turn) y->gradient = gn_alloc_array(y->q->ties.count + 1, sizeof *y->gradient);
    if (!y->moved || !y->moves || !y->mode || (y->q->turn && !y->gradient))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu unknowns of a zone",
                       y->count);
    for (size_t k = 0; y->gradient && k < y->q->ties.count; k++)
        gn_tie_gradients(&y->q->ties, k, &b->nodes, y->gradient[k]);
    set_unknowns(y);
    if (y->q->before) set_masses(y);
    return GNEISS_OK;
}

/* --- results --- */

/* Tells whether a particle is tied to the node. */
static bool carries(const gn_ties *t, int32_t node) {
    size_t low = 0, high = t->nodes;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (t->node[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    return low < t->nodes && t->node[low] == node;
}

static double size2(const double *x, size_t count) {
    double sum = 0.0;
    for (size_t k = 0; k < count; k++) sum += x[k] * x[k];
    return sum;
}

/* Finds the side, particle and node with the largest share of the fastest mode. */
static void find_side(const whole *y, const double *mode, gn_whole_limit *limit) {
    const gn_particles *q = &y->dem->particles, *nodes = &gn_coupled_solid(y->solids)->nodes;
    double most[2] = {-1.0, -1.0};
    for (size_t p = 0; p < y->springs.particles; p++) {
        const bool zone = gn_coupled_has(y->q, q->id[p]);
        const double part = size2(mode + y->dofs * p, y->dofs);
        limit->share[zone ? GN_SIDE_ZONE : GN_SIDE_PARTICLES] += part;
        if (part > most[0]) limit->particle = q->id[p];
        most[0] = fmax(most[0], part);
    }
    for (size_t n = 0; n < nodes->soa.count; n++) {
        const bool zone = carries(&y->q->ties, (int32_t)n);
        const double part = size2(mode + y->own + y->dim * n, y->dim);
        limit->share[zone ? GN_SIDE_ZONE : GN_SIDE_ELEMENTS] += part;
        if (part > most[1]) limit->node = nodes->id[n];
        most[1] = fmax(most[1], part);
    }
    if (most[0] >= most[1])
        limit->node = -1;
    else
        limit->particle = -1;
    limit->side = GN_SIDE_PARTICLES;
    double all = 0.0;
    for (int k = 0; k < GN_SIDES; k++) {
        all += limit->share[k];
        if (limit->share[k] > limit->share[limit->side]) limit->side = (gn_side)k;
    }
    for (int k = 0; k < GN_SIDES && all > 0.0; k++) limit->share[k] /= all;
}

static gneiss_status find(const gn_spectrum *spectrum, void *context, gneiss_error *error) {
    whole *y = context;
    gn_whole_limit *limit = y->limit;
    gn_damped_top top;
    GN_TRY(make(spectrum, y, error));
    const gn_damped system = {.count = y->count,
                              .apply = apply,
                              .metric = y->q->before ? metric : NULL,
                              .context = y,
                              .moves = y->moves,
                              .damped =
                                  y->springs.damped ||
                                  (y->q->stiffness && y->ctx->scene.couple.penalty_damping > 0.0),
                              .threads = y->ctx->threads};
    GN_TRY(gn_damped_largest(&system, 1e-3, y->mode, &top, error));
    *limit = (gn_whole_limit){.sharp = 1.0 / top.rate,
                              .low = 1.0 / top.rate_most,
                              .iterations = top.vectors,
                              .particle = -1,
                              .node = -1};
    find_side(y, y->mode, limit);
    return GNEISS_OK;
}

bool gn_coupled_has_limit(const gn_step_context *ctx, const gn_solids *solids) {
    /* With conversions the limit would change at each of them. */
    return ctx->scene.has_couple && !gn_converts(ctx) && ctx->scene.estimate == GN_STEP_SHARP &&
           gn_coupled_solid(solids)->form == GN_FEM_DISPLACEMENT;
}

gneiss_status gn_coupled_limit(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids,
                               const gn_zones *zones, bool listed, gn_whole_limit *limit,
                               gneiss_error *error) {
    whole y = {.q = zones->coupled, .ctx = ctx, .dem = dem, .solids = solids, .limit = limit};
    gneiss_status status = gn_timestep_with_spectrum(ctx, dem, boundary, listed, find, &y, error);
    whole_free(&y);
    return status;
}

const gn_whole_limit *gn_coupled_whole(const gn_step_context *ctx, const gn_zones *zones) {
    const gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    return q && q->whole.iterations ? &q->whole : NULL;
}

const char *gn_side_text(gn_side side) {
    static const char *const names[] = {"particles", "elements", "zone"};
    return names[side];
}

const char *gn_whole_culprit(const gn_whole_limit *limit, char *text, size_t size) {
    char place[64];
    if (limit->node >= 0)
        snprintf(place, sizeof place, "node %d", limit->node);
    else
        snprintf(place, sizeof place, "particle %d", limit->particle);
    snprintf(text, size, "the %s, %s", gn_side_text(limit->side), place);
    return text;
}

const gn_element_model *gn_timestep_elements_lead(const gn_step_context *ctx,
                                                  const gn_solids *solids, const gn_zones *zones) {
    const gn_element_model *lead = NULL;
    for (size_t k = 0; k < solids->count; k++)
        if (!lead || solids->elements[k]->stable < lead->stable) lead = solids->elements[k];
    const gn_whole_limit *found = gn_coupled_whole(ctx, zones);
    if (found) return found->side == GN_SIDE_ELEMENTS ? lead : NULL;
    bool after = lead && ctx->scene.has_specimen && ctx->choice.stable < lead->stable;
    return after ? NULL : lead;
}
