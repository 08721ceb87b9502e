/* Preconditioned conjugate gradients (Hestenes & Stiefel 1952) on the springs of the stability
 * limit. The preconditioner adds the inverse 6 x 6 blocks of single particles (Golub & Van Loan,
 * Matrix Computations, 11.5) and a coarse level of groups (limit/coarse.h).
 *
 * A spring between i and j with normal n resists the relative displacement of its contact point, e
 * = u_j - u_i - (a_i w_i + a_j w_j) x n, by q = k_t e + (k_n - k_t)(e.n) n: force q on i, -q on j,
 * and the moments a_i n x q and a_j n x q. Bonds with moments also resist the relative rotation w =
 * w_j - w_i by m = k_b w + (k_w - k_b)(w.n) n: m on i, -m on j. One pass computes q of all springs,
 * a second one gathers them particle by particle in the order of the springs, so that no sum
 * depends on the threads.
 *
 * If K is singular (a free rigid motion, a sphere that rolls about its only bond), a small fraction
 * of the diagonal is added to every component: all unresisted motions then have that one
 * eigenvalue, which costs an iteration or two. They stay at rest without a load; a load moves them
 * far, which the caller has to detect. */
#include "limit/equilibrium.h"

#include "base/new.h"
#include "base/vec3.h"
#include "limit/springs.h"

#include <math.h>
#include <string.h>

enum { N = GN_COMPONENTS, CHUNK = 256, ITERATIONS_MOST = 20000, USES = 8 };

/* Regularisation, relative to the diagonal. A body that is a hundred particles long has eigenvalues
 * of some 1e-4 of the diagonal; Newton's method corrects the effect. With 1e-9, rounding prevented
 * convergence in specimens with many loosely held particles. */
static const double everywhere = 1e-6;
/* A pivot of a block below this fraction of its diagonal is rounding. */
static const double no_pivot = 1e-12;

/* A spring in single precision, which saves memory traffic; Newton's method corrects the effect on
 * K. */
typedef struct link {
    float n[3], kn, kt, arm_i, arm_j;
    float bend, twist; /* 0: no moments */
    int32_t i, j;
} link;

/* Sums over a chunk of particles: the curvature p.Kp, or r.z and |r|^2. Scalar products are
 * weighted with the diagonal, so that components without resistance have no more weight than
 * others. */
typedef struct part {
    double curvature, rz, left;
} part;

typedef struct cg {
    gn_springs y;
    size_t n; /* number of components of all particles */
    int threads;
    link *link;        /* [springs] */
    double (*pull)[3]; /* [springs] q, see above */
    gn_preconditioner *made;
    uint8_t *free; /* [particles] bit k: component k is free */
    gn_viscosity viscosity;
    double *r, *z, *p, *kp;
    part *parts; /* [chunks of particles], merged in their order */
} cg;

static void free_cg(cg *solver) {
    gn_springs_free(&solver->y);
    gn_free(solver->link);
    gn_free(solver->pull);
    gn_free(solver->free);
    gn_free(solver->r);
    gn_free(solver->z);
    gn_free(solver->p);
    gn_free(solver->kp);
    gn_free(solver->parts);
}

void gn_preconditioner_free(gn_preconditioner *made) {
    gn_coarse_free(&made->coarse);
    gn_free(made->inverse);
    gn_free(made->ground);
    gn_free(made->weight);
    *made = (gn_preconditioner){0};
}

static gneiss_status allocate(cg *solver, gneiss_error *error) {
    size_t particles = solver->y.particles;
    solver->n = particles * N;
    solver->link = gn_alloc_array(solver->y.springs + 1, sizeof *solver->link);
    solver->pull = gn_alloc_array(solver->y.springs + 1, sizeof *solver->pull);
    solver->free = gn_alloc(particles + 1);
    solver->r = gn_alloc_array(solver->n + 1, sizeof *solver->r);
    solver->z = gn_alloc_array(solver->n + 1, sizeof *solver->z);
    solver->p = gn_alloc_array(solver->n + 1, sizeof *solver->p);
    solver->kp = gn_alloc_array(solver->n + 1, sizeof *solver->kp);
    solver->parts = gn_alloc_array(particles / CHUNK + 1, sizeof *solver->parts);
    if (solver->parts && solver->link && solver->pull && solver->free && solver->r && solver->z &&
        solver->p && solver->kp)
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the equilibrium of %zu particles",
                   particles);
}

static void take_links(cg *solver) {
    for (size_t s = 0; s < solver->y.springs; s++) {
        const gn_spring *from = &solver->y.spring[s];
        solver->link[s] = (link){{(float)from->n[0], (float)from->n[1], (float)from->n[2]},
                                 (float)(from->kn + solver->viscosity.rate * from->cn),
                                 (float)from->kt,
                                 (float)from->arm_i,
                                 (float)from->arm_j,
                                 (float)from->bend,
                                 (float)from->twist,
                                 from->i,
                                 from->j};
    }
    for (size_t p = 0; p < solver->y.particles; p++) {
        solver->free[p] = 0;
        for (int d = 0; d < solver->y.dofs; d++)
            if (solver->y.scale[p * (size_t)solver->y.dofs + (size_t)d] > 0.0)
                solver->free[p] |= (uint8_t)(1u << gn_springs_component(&solver->y, d));
    }
}

/* --- the operator --- */

static inline void pull_of(const link *spring, const double *u, double q[3]) {
    const double n[3] = {spring->n[0], spring->n[1], spring->n[2]}, ai = spring->arm_i,
                 aj = spring->arm_j;
    const double *a = u + N * (size_t)spring->i;
    double e[3] = {-a[0], -a[1], -a[2]}, w[3] = {ai * a[3], ai * a[4], ai * a[5]};
    if (spring->j >= 0) {
        const double *b = u + N * (size_t)spring->j;
        for (int k = 0; k < 3; k++) {
            e[k] += b[k];
            w[k] += aj * b[3 + k];
        }
    }
    double kt = spring->kt, along = (spring->kn - kt) * (e[0] * n[0] + e[1] * n[1] + e[2] * n[2]);
    e[0] -= w[1] * n[2] - w[2] * n[1];
    e[1] -= w[2] * n[0] - w[0] * n[2];
    e[2] -= w[0] * n[1] - w[1] * n[0];
    for (int k = 0; k < 3; k++) q[k] = kt * e[k] + along * n[k];
}

/* Returns the resistance of drag to component k of a particle, N/m, N m. */
static inline double drag_of(const cg *solver, size_t p, int k) {
    const gn_particles *q = solver->y.spectrum->assembly->particles;
    double inverse = k < 3 ? q->vel[4 * p + 3] : q->spin ? q->spin[4 * p + 3] : 0.0;
    return inverse > 0.0 ? solver->viscosity.rate * solver->viscosity.drag / inverse : 0.0;
}

/* Adds the moments that a spring exerts on one of its ends by relative rotation. */
static void add_bending(const link *l, const double *u, double side, double f[N]) {
    const double n[3] = {l->n[0], l->n[1], l->n[2]}, bend = l->bend, twist = l->twist;
    double w[3];
    for (int k = 0; k < 3; k++)
        w[k] = (l->j < 0 ? 0.0 : u[N * (size_t)l->j + 3 + (size_t)k]) -
               u[N * (size_t)l->i + 3 + (size_t)k];
    double along = (twist - bend) * gn_dot3(w, n);
    for (int k = 0; k < 3; k++) f[3 + k] += side * (bend * w[k] + along * n[k]);
}

/* Computes the entries of K u of a particle; returns its part of u . K u. */
static inline double gather(const cg *solver, const double *u, size_t p, double *out) {
    double f[N], sum = 0.0;
    for (size_t k = 0; k < N; k++) f[k] = solver->made->ground[N * p + k] * u[N * p + k];
    for (size_t e = solver->y.first[p]; e < solver->y.first[p + 1]; e++) {
        size_t s = solver->y.entry[e] / 2;
        bool second = solver->y.entry[e] & 1;
        const link *l = &solver->link[s];
        const double *q = solver->pull[s], n[3] = {l->n[0], l->n[1], l->n[2]};
        double side = second ? 1.0 : -1.0, arm = second ? l->arm_j : l->arm_i;
        for (int k = 0; k < 3; k++) f[k] += side * q[k];
        f[3] -= arm * (n[1] * q[2] - n[2] * q[1]);
        f[4] -= arm * (n[2] * q[0] - n[0] * q[2]);
        f[5] -= arm * (n[0] * q[1] - n[1] * q[0]);
        if (l->bend != 0.0f || l->twist != 0.0f) add_bending(l, u, side, f);
    }
    for (size_t k = 0; k < N; k++) {
        out[k] = solver->free[p] >> k & 1 ? f[k] : 0.0;
        sum += u[N * p + k] * out[k];
    }
    return sum;
}

/* --- the preconditioner --- */

/* Sums over the springs of a particle that give its block, with all neighbours fixed. Symmetric
 * parts as xx yy zz xy yz zx. */
typedef struct block_sums {
    double kt, normal[6]; /* k_t; (k_n - k_t) n n^T */
    /* arm^2 k_t + k_b; (arm^2 k_t + k_b - k_w) n n^T */
    double turn, turn_normal[6];
    double cross[3]; /* the sum of side arm k_t n */
} block_sums;

static void block_of(const cg *solver, size_t p, double k[36]) {
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    block_sums b = {0};
    for (size_t e = solver->y.first[p]; e < solver->y.first[p + 1]; e++) {
        const link *l = &solver->link[solver->y.entry[e] / 2];
        const double n[3] = {l->n[0], l->n[1], l->n[2]};
        const double nn[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                              n[0] * n[1], n[1] * n[2], n[2] * n[0]};
        const double arm = solver->y.entry[e] & 1 ? l->arm_j : l->arm_i;
        const double side = solver->y.entry[e] & 1 ? 1.0 : -1.0, turn = arm * arm * l->kt;
        b.kt += l->kt;
        b.turn += turn + (double)l->bend;
        for (int a = 0; a < 6; a++) b.normal[a] += ((double)l->kn - l->kt) * nn[a];
        for (int a = 0; a < 6; a++) b.turn_normal[a] += (turn + (double)l->bend - l->twist) * nn[a];
        for (int a = 0; a < 3; a++) b.cross[a] += side * arm * l->kt * n[a];
    }
    const double *x = b.cross;
    const double cross[3][3] = {{0.0, -x[2], x[1]}, {x[2], 0.0, -x[0]}, {-x[1], x[0], 0.0}};
    for (int a = 0; a < 3; a++)
        for (int d = 0; d < 3; d++) {
            double one = a == d ? 1.0 : 0.0;
            k[N * a + d] = b.kt * one + b.normal[place[a][d]];
            k[N * (a + 3) + d + 3] = b.turn * one - b.turn_normal[place[a][d]];
            k[N * a + d + 3] = k[N * (d + 3) + a] = cross[a][d];
        }
}

/* Computes the Cholesky factor of a block, without components that are fixed or have no resistance
 * once the previous ones are fixed. */
static void factor(double k[36], unsigned free, bool in[N]) {
    double diagonal[N];
    for (int a = 0; a < N; a++) diagonal[a] = k[N * a + a];
    for (int a = 0; a < N; a++) {
        for (int b = 0; b < a; b++) {
            double sum = k[N * a + b];
            for (int m = 0; m < b; m++) sum -= k[N * a + m] * k[N * b + m];
            k[N * a + b] = in[b] ? sum / k[N * b + b] : 0.0;
        }
        double pivot = k[N * a + a];
        for (int m = 0; m < a; m++) pivot -= k[N * a + m] * k[N * a + m];
        in[a] = (free >> a & 1) && pivot > no_pivot * diagonal[a];
        k[N * a + a] = in[a] ? sqrt(pivot) : 0.0;
        for (int b = 0; b < a && !in[a]; b++) k[N * a + b] = 0.0;
    }
}

static void invert(const double l[36], const bool in[N], float inverse[36]) {
    memset(inverse, 0, 36 * sizeof *inverse);
    for (int column = 0; column < N; column++) {
        double x[N] = {0.0};
        if (!in[column]) continue;
        for (int a = 0; a < N; a++) {
            double sum = a == column ? 1.0 : 0.0;
            for (int m = 0; m < a; m++) sum -= l[N * a + m] * x[m];
            x[a] = in[a] ? sum / l[N * a + a] : 0.0;
        }
        for (int a = N - 1; a >= 0; a--) {
            double sum = x[a];
            for (int m = a + 1; m < N; m++) sum -= l[N * m + a] * x[m];
            x[a] = in[a] ? sum / l[N * a + a] : 0.0;
        }
        for (int a = 0; a < N; a++) inverse[N * a + column] = (float)x[a];
    }
}

static void make_blocks(cg *solver) {
#pragma omp parallel for num_threads(solver->threads) schedule(static)
    for (size_t p = 0; p < solver->y.particles; p++) {
        double k[36];
        bool in[N] = {false};
        block_of(solver, p, k);
        for (size_t a = 0; a < N; a++) {
            double *diagonal = &k[(N + 1) * a];
            solver->made->ground[N * p + a] = everywhere * *diagonal + drag_of(solver, p, (int)a);
            *diagonal += solver->made->ground[N * p + a];
            bool moves = (solver->free[p] >> a & 1) && *diagonal > 0.0;
            solver->made->weight[N * p + a] = moves ? 1.0 / *diagonal : 0.0;
        }
        factor(k, solver->free[p], in);
        invert(k, in, solver->made->inverse[p]);
    }
}

/* Computes the effect of each component of one end on the relative displacement of the contact
 * point. */
static void end_moves(unsigned free, double side, double arm, const float n[3], double by[6][3]) {
    memset(by, 0, 18 * sizeof by[0][0]);
    for (int k = 0; k < 3; k++) {
        const double normal[3] = {n[0], n[1], n[2]};
        double axis[3] = {0.0};
        axis[k] = -arm;
        if (free >> k & 1) by[k][k] = side;
        if (free >> (3 + k) & 1) gn_cross3(axis, normal, by[3 + k]);
    }
}

/* Adds the resistance to relative rotation, whose displacement is e = w_j - w_i. */
static void add_coarse_bending(cg *solver, const link *l) {
    gn_coarse_spring s = {l->i, l->j, {l->n[0], l->n[1], l->n[2]}, l->twist, l->bend, {{0}}, {{0}}};
    for (int k = 0; k < 3; k++) {
        s.by_p[3 + k][k] = solver->free[l->i] >> (3 + k) & 1 ? -1.0 : 0.0;
        s.by_q[3 + k][k] = l->j >= 0 && solver->free[l->j] >> (3 + k) & 1 ? 1.0 : 0.0;
    }
    gn_coarse_add(&solver->made->coarse, &s);
}

static void make_coarse(cg *solver) {
    if (!solver->made->coarse.groups) return;
    for (size_t k = 0; k < solver->y.springs; k++) {
        const link *l = &solver->link[k];
        gn_coarse_spring s = {l->i, l->j, {l->n[0], l->n[1], l->n[2]}, l->kn, l->kt, {{0}}, {{0}}};
        end_moves(solver->free[l->i], -1.0, l->arm_i, l->n, s.by_p);
        if (l->j >= 0) end_moves(solver->free[l->j], 1.0, l->arm_j, l->n, s.by_q);
        gn_coarse_add(&solver->made->coarse, &s);
        if (l->bend != 0.0f || l->twist != 0.0f) add_coarse_bending(solver, l);
    }
    for (size_t p = 0; p < solver->y.particles; p++) {
        double ground[N];
        for (size_t a = 0; a < N; a++)
            ground[a] = solver->free[p] >> a & 1 ? solver->made->ground[N * p + a] : 0.0;
        gn_coarse_ground(&solver->made->coarse, p, ground);
    }
    gn_coarse_factor(&solver->made->coarse);
}

/* Computes the entries of z of a particle; returns its part of r.z. */
static inline double precondition(const cg *solver, size_t p) {
    const double *r = solver->r + N * p;
    double *z = solver->z + N * p, sum = 0.0;
    for (int a = 0; a < N; a++) z[a] = 0.0;
    for (int b = 0; b < N; b++)
        for (int a = 0; a < N; a++) z[a] += (double)solver->made->inverse[p][N * b + a] * r[b];
    if (solver->made->coarse.groups) gn_coarse_spread(&solver->made->coarse, p, solver->free[p], z);
    for (int a = 0; a < N; a++) sum += r[a] * z[a];
    return sum;
}

/* --- the iteration --- */

static size_t chunks_of(const cg *solver) {
    return (solver->y.particles + CHUNK - 1) / CHUNK;
}

static size_t end_of(const cg *solver, size_t chunk) {
    size_t end = (chunk + 1) * CHUNK;
    return end < solver->y.particles ? end : solver->y.particles;
}

static part add_up(const cg *solver) {
    part sum = {0};
    for (size_t k = 0; k < chunks_of(solver); k++) {
        sum.curvature += solver->parts[k].curvature;
        sum.rz += solver->parts[k].rz;
        sum.left += solver->parts[k].left;
    }
    return sum;
}

/* Computes K p and returns p . K p. */
static double apply(const cg *solver) {
#pragma omp parallel num_threads(solver->threads) if (solver->y.particles > CHUNK)
    {
#pragma omp for schedule(static)
        for (size_t s = 0; s < solver->y.springs; s++)
            pull_of(&solver->link[s], solver->p, solver->pull[s]);
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(solver); k++) {
            solver->parts[k] = (part){0};
            for (size_t p = k * CHUNK; p < end_of(solver, k); p++)
                solver->parts[k].curvature += gather(solver, solver->p, p, solver->kp + N * p);
        }
    }
    return add_up(solver).curvature;
}

/* Updates u += step p and r -= step K p, and computes z from r. */
static part go(const cg *solver, double step, double *u) {
#pragma omp parallel num_threads(solver->threads) if (solver->y.particles > CHUNK)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(solver); k++) {
            solver->parts[k] = (part){0};
            for (size_t a = N * k * CHUNK; a < N * end_of(solver, k); a++) {
                u[a] += step * solver->p[a];
                solver->r[a] -= step * solver->kp[a];
                solver->parts[k].left += solver->made->weight[a] * solver->r[a] * solver->r[a];
            }
        }
#pragma omp for schedule(static)
        for (size_t g = 0; g < solver->made->coarse.groups; g++)
            gn_coarse_gather(&solver->made->coarse, g, solver->r, solver->free);
#pragma omp single
        gn_coarse_solve(&solver->made->coarse);
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(solver); k++)
            for (size_t p = k * CHUNK; p < end_of(solver, k); p++)
                solver->parts[k].rz += precondition(solver, p);
    }
    return add_up(solver);
}

/* Updates p = z + factor p. */
static void turn(const cg *solver, double factor) {
#pragma omp parallel for num_threads(solver->threads)                                              \
    schedule(static) if (solver->y.particles > CHUNK)
    for (size_t k = 0; k < solver->n; k++) solver->p[k] = solver->z[k] + factor * solver->p[k];
}

/* Returns a particle that has a load but no contacts; -1: there is none. */
static int32_t untouched(const cg *solver) {
    for (size_t p = 0; p < solver->y.particles; p++) {
        bool loaded = false;
        for (size_t a = 0; a < N; a++) loaded = loaded || solver->r[N * p + a] != 0.0;
        if (loaded && solver->y.first[p] == solver->y.first[p + 1])
            return solver->y.spectrum->assembly->particles->id[p];
    }
    return -1;
}

/* Returns the allowed number of iterations without progress. Each iteration carries the effect of a
 * load one particle further, so that this is the length of the specimen in diameters, several
 * times. Motions that only the regularisation resists may never converge because of rounding. */
static int patience_of(const cg *solver) {
    const gn_particles *q = solver->y.spectrum->assembly->particles;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double radius = 0.0, length = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        for (size_t a = 0; a < 3; a++) {
            low[a] = fmin(low[a], q->pos[4 * p + a]);
            high[a] = fmax(high[a], q->pos[4 * p + a]);
        }
        radius += q->pos[4 * p + 3] / (double)q->soa.count;
    }
    for (int a = 0; a < 3; a++) length = fmax(length, high[a] - low[a]);
    return 100 + (int)fmin(2.0 * length / radius, (double)ITERATIONS_MOST);
}

static void iterate(cg *solver, double tolerance, double *u, gn_equilibrium *found) {
    memset(u, 0, solver->n * sizeof *u);
    part now = go(solver, 0.0, u);
    const double first = now.left;
    const int patience = patience_of(solver);
    double least = first;
    int since = 0;
    turn(solver, 0.0);
    for (found->iterations = 0; now.left > tolerance * tolerance * first; found->iterations++) {
        if (since++ > patience || found->iterations == ITERATIONS_MOST) break;
        double curvature = apply(solver);
        if (!(curvature > 0.0)) break;
        part next = go(solver, now.rz / curvature, u);
        turn(solver, next.rz / now.rz);
        now = next;
        if (now.left > 0.5 * least) continue;
        least = now.left;
        since = 0;
    }
    found->residual = first > 0.0 ? sqrt(now.left / first) : 0.0;
}

/* --- reuse of the preconditioner --- */

/* Tells whether a particle has contacts that are missing in the blocks. */
static bool touches_more(const cg *solver) {
    const double *weight = solver->made->weight;
    for (size_t p = 0; p < solver->y.particles; p++)
        for (size_t a = 0; a < N && solver->y.first[p] < solver->y.first[p + 1]; a++)
            if ((solver->free[p] >> a & 1) && weight[N * p + a] == 0.0) return true;
    return false;
}

/* Rebuilds the preconditioner if the system has changed, or may have because contacts open and
 * slide. Drag, which is part of the diagonal, changes with the rate. */
static gneiss_status make_preconditioner(cg *solver, gneiss_error *error) {
    gn_preconditioner *m = solver->made;
    const size_t n = solver->y.particles;
    bool good = m->particles == n && solver->viscosity.drag == 0.0 && m->uses++ < USES;
    if (good && !touches_more(solver)) return GNEISS_OK;
    gn_preconditioner_free(m);
    GN_TRY(gn_new(&m->inverse, n + 1, "the equilibrium of particles", error));
    GN_TRY(gn_new(&m->ground, solver->n + 1, "the equilibrium of particles", error));
    GN_TRY(gn_new(&m->weight, solver->n + 1, "the equilibrium of particles", error));
    GN_TRY(gn_coarse_create(&m->coarse, n, solver->y.spectrum->assembly->particles->pos, error));
    make_blocks(solver);
    make_coarse(solver);
    m->particles = n;
    return GNEISS_OK;
}

gneiss_status gn_equilibrium_solve(const gn_spectrum *spectrum, gn_viscosity viscosity,
                                   const double *load, double tolerance, gn_preconditioner *made,
                                   double *u, gn_equilibrium *found, gneiss_error *error) {
    cg c = {.threads = spectrum->threads > 0 ? spectrum->threads : 1,
            .viscosity = viscosity,
            .made = made};
    *found = (gn_equilibrium){.unsupported = -1};
    gneiss_status status = gn_springs_build(spectrum, NULL, &c.y, error);
    if (status == GNEISS_OK) status = allocate(&c, error);
    if (status == GNEISS_OK) {
        take_links(&c);
        status = make_preconditioner(&c, error);
    }
    if (status == GNEISS_OK) {
        for (size_t k = 0; k < c.n; k++) c.r[k] = c.free[k / N] >> k % N & 1 ? load[k] : 0.0;
        found->unsupported = untouched(&c);
        if (found->unsupported < 0) iterate(&c, tolerance, u, found);
    }
    free_cg(&c);
    return status;
}
