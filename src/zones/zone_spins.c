/* Slaved spins: their part of a step, and their effect on its limit.
 *
 * Such particles add the springs that resist their rotation without their inertia: their energy is
 * at most w_D^2 (sum m v^2 + sum I w^2), where w_D is the largest frequency of the particles alone,
 * but the second sum is no part of the kinetic energy of the whole. If it is at most s times v M v,
 * M the masses of the nodes with all that they carry, the square of the largest frequency is at
 * most max(w_D^2, w_F^2) + s w_D^2.
 *
 * s is the largest value of the elements, each taken with its particles and a share of the masses
 * of its nodes, because all sums are sums over elements: with w = 1/2 sum_a g_a x v_a in one
 * element, sum I w^2 is at most v M_e v times
 *     I_e |1/4 (tr G - G)|,   G = sum_ab (M_e^-1)_ab g_a g_b^T,
 * in the plane 1/4 I_e tr G. M_e is diagonal for lumped masses; for consistent masses it is N^T m N
 * of the element's particles plus a share of the nodes' own masses, which alone resist a motion
 * that rotates the particles without moving them. Nodes are divided among their elements by the
 * inertias in these. */
#include "base/eigen.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/motion.h"
#include "particles/particles.h"
#include "sched/hold.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>

/* --- part in a step --- */

/* If the spin is half the curl of the elements' velocity, w = 1/2 sum_a grad N_a x v_a, the power
 * T.w of a moment is that of forces 1/2 T x grad N_a on the nodes, which have no resultant and,
 * with gradients at the present positions, the moment T. Such particles have no rotational inertia.
 */
void gn_spins_take_moment(gn_dem *dem, const gn_solids *solids, gn_coupled *q, int width,
                          size_t k) {
    const size_t p = (size_t)q->place[k], at = width == 8 ? 4 : 0;
    const bool space = width == 8;
    double *row = gn_hold_load(&dem->hold, width, p), *spin = dem->particles.spin + 4 * p;
    double moment[3] = {0.0}, g[4][3];
    for (size_t a = space ? 0 : 2; a < 3; a++) {
        moment[a] = 0.5 * row[at + a];
        row[at + a] = spin[a] = 0.0;
    }
    gn_dem_clear_past(dem, p, true);
    gn_tie_gradients(&q->ties, k, &gn_coupled_solid(solids)->nodes, g);
    for (int a = 0; a < q->ties.corners; a++) gn_cross3(moment, g[a], q->turn[k][a]);
}

void gn_spins_set(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                  const gn_coupled *q, size_t k) {
    const gn_particles *nodes = &gn_coupled_solid(solids)->nodes, *a = &dem->particles;
    const size_t p = 4 * (size_t)q->place[k];
    double g[4][3], sum[3] = {0.0};
    gn_tie_gradients(&q->ties, k, nodes, g);
    for (int c = 0; c < q->ties.corners; c++) {
        double of[3];
        gn_cross3(g[c], nodes->vel + 4 * (size_t)q->ties.tie[k].node[c], of);
        for (int d = 0; d < 3; d++) sum[d] += 0.5 * of[d];
    }
    for (size_t d = ctx->scene.dimension == 3 ? 0 : 2; d < 3; d++) {
        a->spin[p + d] = sum[d];
        if (a->spin_f) a->spin_f[p + d] = (float)sum[d];
    }
}

/* --- the limit of the step --- */

enum { CORNERS = 4 };

/* An element and its particles. */
typedef struct turned {
    size_t tie;                    /* tie of one of the particles */
    double inertia;                /* kg m2, sum of the particles */
    double mass[CORNERS][CORNERS]; /* kg, N^T m N, where masses are consistent */
} turned;

typedef struct turned_list {
    size_t count;
    turned *of;       /* [count] */
    int32_t *at;      /* [elements] index into `of`, -1: not listed */
    double *inertias; /* [nodes of ties] kg m2, sum of the elements at a node */
} turned_list;

static void collect(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q,
                    turned_list *y) {
    const gn_particles *a = &dem->particles;
    for (size_t e = 0; e < gn_coupled_solid(solids)->elements.soa.count; e++) y->at[e] = -1;
    for (size_t k = 0; k < q->ties.count; k++) {
        const gn_tie *t = &q->ties.tie[k];
        if (q->place[k] < 0) continue;
        const size_t p = 4 * (size_t)q->place[k] + 3;
        if (y->at[t->element] < 0) {
            y->of[y->count] = (turned){.tie = k};
            y->at[t->element] = (int32_t)y->count++;
        }
        turned *e = &y->of[y->at[t->element]];
        e->inertia += 1.0 / a->spin[p];
        for (int r = 0; r < q->ties.corners; r++) {
            y->inertias[t->own[r]] += 1.0 / a->spin[p];
            for (int c = 0; q->before && c < q->ties.corners; c++)
                e->mass[r][c] += t->shape[r] * t->shape[c] / a->vel[p];
        }
    }
}

/* Adds the share of an element in the masses of its nodes, kg. */
static void add_nodes(const gn_solids *solids, const gn_coupled *q, const double *inertias,
                      turned *e) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_tie *t = &q->ties.tie[e->tie];
    for (int r = 0; r < q->ties.corners; r++) {
        const double all = 1.0 / b->nodes.vel[4 * (size_t)t->node[r] + 3];
        const double carried = q->before && b->carried ? b->carried[t->node[r]] : 0.0;
        e->mass[r][r] += fmax(all - carried, 1e-12 * all) * e->inertia / inertias[t->own[r]];
    }
}

/* Solves m x = g for three columns; x holds g on entry. m is positive definite and is overwritten.
 */
static void solve(int n, double m[CORNERS][CORNERS], double x[CORNERS][3]) {
    for (int k = 0; k < n; k++)
        for (int r = k + 1; r < n; r++) {
            const double factor = m[r][k] / m[k][k];
            for (int c = k; c < n; c++) m[r][c] -= factor * m[k][c];
            for (int c = 0; c < 3; c++) x[r][c] -= factor * x[k][c];
        }
    for (int k = n; k-- > 0;)
        for (int c = 0; c < 3; c++) {
            for (int r = k + 1; r < n; r++) x[k][c] -= m[k][r] * x[r][c];
            x[k][c] /= m[k][k];
        }
}

static double share_of(const gn_solids *solids, const gn_coupled *q, turned *e) {
    const int n = q->ties.corners;
    double g[CORNERS][3], x[CORNERS][3], sum[9] = {0.0}, values[3], vectors[9];
    gn_tie_gradients(&q->ties, e->tie, &gn_coupled_solid(solids)->nodes, g);
    for (int r = 0; r < n; r++)
        for (int c = 0; c < 3; c++) x[r][c] = c < n - 1 ? g[r][c] : 0.0;
    solve(n, e->mass, x);
    for (int a = 0; a < n - 1; a++)
        for (int c = 0; c < n - 1; c++)
            for (int r = 0; r < n; r++) sum[3 * a + c] += g[r][a] * x[r][c];
    const double trace = sum[0] + sum[4] + sum[8];
    if (n == 3) return 0.25 * e->inertia * trace;
    gn_eigen_symmetric(3, sum, values, vectors);
    return 0.25 * e->inertia * (trace - values[2]);
}

static double largest_share(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q,
                            turned_list *y) {
    double most = 0.0;
    collect(dem, solids, q, y);
    for (size_t k = 0; k < y->count; k++) {
        add_nodes(solids, q, y->inertias, &y->of[k]);
        most = fmax(most, share_of(solids, q, &y->of[k]));
    }
    return most;
}

/* Relative change that the safety factor of the step covers. */
static const double small = 0.01;

gneiss_status gn_coupled_turn_faster(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_solids *solids, gn_zones *zones, bool *more,
                                     gneiss_error *error) {
    const gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    *more = false;
    if (!q || !q->turn) return GNEISS_OK;
    const size_t elements = gn_coupled_solid(solids)->elements.soa.count, ties = q->ties.count;
    turned_list y = {0};
    y.of = gn_alloc_array((ties < elements ? ties : elements) + 1, sizeof *y.of);
    y.at = gn_alloc_array(elements + 1, sizeof *y.at);
    y.inertias = gn_alloc_array(q->ties.nodes + 1, sizeof *y.inertias);
    const bool room = y.of && y.at && y.inertias;
    const double before = zones->state.turned, now = room ? largest_share(dem, solids, q, &y) : 0.0;
    *more = now > (1.0 + small) * before;
    if (*more || now < (1.0 - small) * before) zones->state.turned = now;
    gn_free(y.of);
    gn_free(y.at);
    gn_free(y.inertias);
    return room ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles of zones", ties);
}
