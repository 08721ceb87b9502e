/* What slaved spins take of the step. Such particles bring the springs that turn them without their
 * inertia: their energy is at most w_D^2 (sum m v^2 + sum I w^2), w_D being the largest frequency
 * of the particles by themselves, and the second sum is none of the whole. With it at most s times
 * v M v, M what the nodes have with all that they carry, the square of the largest frequency is at
 * most max(w_D^2, w_F^2) + s w_D^2.
 *
 * s is the largest of the elements, each with its particles and a part of the masses of its nodes,
 * as the sums over elements are those of all: of w = 1/2 sum_a g_a x v_a in one element, sum I w^2
 * is at most that of v M_e v times
 *     I_e |1/4 (tr G - G)|,   G = sum_ab (M_e^-1)_ab g_a g_b^T,
 * in the plane 1/4 I_e tr G. M_e is diagonal where masses are lumped; consistent ones are N^T m N
 * of the element's particles beside the part of what nodes have by themselves, which a motion that
 * leaves the particles where they are but turns them has alone. Nodes are shared out by the
 * inertias in the elements at them. */
#include "base/eigen.h"
#include "base/error.h"
#include "base/memory.h"
#include "couple/ties.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>

enum { CORNERS = 4 };

/* An element and its particles. */
typedef struct turned {
    size_t tie;                    /* one of these */
    double inertia;                /* kg m2, their sum */
    double mass[CORNERS][CORNERS]; /* kg, N^T m N, where masses are consistent */
} turned;

typedef struct turned_list {
    size_t count;
    turned *of;       /* [count] */
    int32_t *at;      /* [elements] in it, -1 */
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

/* kg: of the masses of its nodes. */
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

/* x of m x = g, three columns; m is positive and destroyed. */
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

/* Changes that are left to the safety factor of a step. */
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
