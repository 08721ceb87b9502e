/* Preconditioned conjugate gradients (Hestenes & Stiefel 1952) on the springs of the stability
 * limit. The preconditioner adds the inverse 6 x 6 blocks of single particles (Golub & Van Loan,
 * Matrix Computations, 11.5) and a coarse level of groups (limit/coarse.h).
 *
 * A spring between i and j with normal n resists the relative displacement of its contact point, e
 * = u_j - u_i - (a_i w_i + a_j w_j) x n, by q = k_t e + (k_n - k_t)(e.n) n: force q on i, -q on j,
 * and the moments a_i n x q and a_j n x q. One pass computes q of all springs, a second one gathers
 * them particle by particle in the order of the springs, so that no sum depends on the threads.
 *
 * If K is singular (a free rigid motion, a sphere that rolls about its only bond), a small fraction
 * of the diagonal is added to every component: all unresisted motions then have that one
 * eigenvalue, which costs an iteration or two. They stay at rest without a load; a load moves them
 * far, which the caller has to detect. */
#include "limit/equilibrium.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "limit/springs.h"

#include <math.h>
#include <string.h>

enum { N = GN_COMPONENTS, CHUNK = 256, ITERATIONS_MOST = 20000, USES = 8 };

/* Regularisation, relative to the diagonal. A body that is a hundred particles long has eigenvalues
 * of some 1e-4 of it, and Newton's method corrects the effect. With 1e-9, rounding prevented
 * convergence in specimens with many loosely held particles. */
static const double everywhere = 1e-6;
/* A pivot of a block below this fraction of its diagonal is rounding. */
static const double no_pivot = 1e-12;

/* A spring in single precision, which saves memory traffic; Newton's method corrects the effect on
 * K. */
typedef struct link {
    float n[3], kn, kt, arm_i, arm_j;
    int32_t i, j;
} link;

/* Sums of a chunk of particles: the curvature p.Kp, or r.z and |r|^2 in the metric of the diagonal,
 * in which unresisted components have no more weight than others. */
typedef struct part {
    double curvature, rz, left;
} part;

typedef struct cg {
    gn_springs y;
    size_t n; /* components of all particles */
    int threads;
    link *link;        /* [springs] */
    double (*pull)[3]; /* [springs] q */
    gn_preconditioner *made;
    uint8_t *free; /* [particles] bit k: component k is free */
    gn_viscosity viscosity;
    double *r, *z, *p, *kp;
    part *parts; /* [chunks of particles], merged in their order */
} cg;

static void free_cg(cg *c) {
    gn_springs_free(&c->y);
    gn_free(c->link);
    gn_free(c->pull);
    gn_free(c->free);
    gn_free(c->r);
    gn_free(c->z);
    gn_free(c->p);
    gn_free(c->kp);
    gn_free(c->parts);
}

void gn_preconditioner_free(gn_preconditioner *made) {
    gn_coarse_free(&made->coarse);
    gn_free(made->inverse);
    gn_free(made->ground);
    gn_free(made->weight);
    *made = (gn_preconditioner){0};
}

static gneiss_status allocate(cg *c, gneiss_error *error) {
    size_t particles = c->y.particles;
    c->n = particles * N;
    c->link = gn_alloc_array(c->y.springs + 1, sizeof *c->link);
    c->pull = gn_alloc_array(c->y.springs + 1, sizeof *c->pull);
    c->free = gn_alloc(particles + 1);
    c->r = gn_alloc_array(c->n + 1, sizeof *c->r);
    c->z = gn_alloc_array(c->n + 1, sizeof *c->z);
    c->p = gn_alloc_array(c->n + 1, sizeof *c->p);
    c->kp = gn_alloc_array(c->n + 1, sizeof *c->kp);
    c->parts = gn_alloc_array(particles / CHUNK + 1, sizeof *c->parts);
    if (c->parts && c->link && c->pull && c->free && c->r && c->z && c->p && c->kp)
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the equilibrium of %zu particles",
                   particles);
}

static void take_links(cg *c) {
    for (size_t s = 0; s < c->y.springs; s++) {
        const gn_spring *from = &c->y.spring[s];
        c->link[s] = (link){{(float)from->n[0], (float)from->n[1], (float)from->n[2]},
                            (float)(from->kn + c->viscosity.rate * from->cn),
                            (float)from->kt,
                            (float)from->arm_i,
                            (float)from->arm_j,
                            from->i,
                            from->j};
    }
    for (size_t p = 0; p < c->y.particles; p++) {
        c->free[p] = 0;
        for (int d = 0; d < c->y.dofs; d++)
            if (c->y.scale[p * (size_t)c->y.dofs + (size_t)d] > 0.0)
                c->free[p] |= (uint8_t)(1u << gn_springs_component(&c->y, d));
    }
}

/* --- the operator --- */

static inline void pull_of(const link *l, const double *u, double q[3]) {
    const double n[3] = {l->n[0], l->n[1], l->n[2]}, ai = l->arm_i, aj = l->arm_j;
    const double *a = u + N * (size_t)l->i;
    double e[3] = {-a[0], -a[1], -a[2]}, w[3] = {ai * a[3], ai * a[4], ai * a[5]};
    if (l->j >= 0) {
        const double *b = u + N * (size_t)l->j;
        for (int k = 0; k < 3; k++) {
            e[k] += b[k];
            w[k] += aj * b[3 + k];
        }
    }
    double kt = l->kt, along = (l->kn - kt) * (e[0] * n[0] + e[1] * n[1] + e[2] * n[2]);
    e[0] -= w[1] * n[2] - w[2] * n[1];
    e[1] -= w[2] * n[0] - w[0] * n[2];
    e[2] -= w[0] * n[1] - w[1] * n[0];
    for (int k = 0; k < 3; k++) q[k] = kt * e[k] + along * n[k];
}

/* Returns the resistance of drag to component k of a particle, N/m, N m. */
static inline double drag_of(const cg *c, size_t p, int k) {
    const gn_particles *q = c->y.spectrum->assembly->particles;
    double inverse = k < 3 ? q->vel[4 * p + 3] : q->spin ? q->spin[4 * p + 3] : 0.0;
    return inverse > 0.0 ? c->viscosity.rate * c->viscosity.drag / inverse : 0.0;
}

/* Computes K u of a particle; returns u . K u. */
static inline double gather(const cg *c, const double *u, size_t p, double *out) {
    double f[N], sum = 0.0;
    for (size_t k = 0; k < N; k++) f[k] = c->made->ground[N * p + k] * u[N * p + k];
    for (size_t e = c->y.first[p]; e < c->y.first[p + 1]; e++) {
        size_t s = c->y.entry[e] / 2;
        bool second = c->y.entry[e] & 1;
        const link *l = &c->link[s];
        const double *q = c->pull[s], n[3] = {l->n[0], l->n[1], l->n[2]};
        double side = second ? 1.0 : -1.0, arm = second ? l->arm_j : l->arm_i;
        for (int k = 0; k < 3; k++) f[k] += side * q[k];
        f[3] -= arm * (n[1] * q[2] - n[2] * q[1]);
        f[4] -= arm * (n[2] * q[0] - n[0] * q[2]);
        f[5] -= arm * (n[0] * q[1] - n[1] * q[0]);
    }
    for (size_t k = 0; k < N; k++) {
        out[k] = c->free[p] >> k & 1 ? f[k] : 0.0;
        sum += u[N * p + k] * out[k];
    }
    return sum;
}

/* --- the preconditioner --- */

/* Sums over the springs of a particle that give its block, with all neighbours fixed. Symmetric
 * parts as xx yy zz xy yz zx. */
typedef struct block_sums {
    double kt, normal[6];        /* k_t; (k_n - k_t) n n^T */
    double turn, turn_normal[6]; /* arm^2 k_t; arm^2 k_t n n^T */
    double cross[3];             /* side arm k_t n */
} block_sums;

static void block_of(const cg *c, size_t p, double k[36]) {
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    block_sums b = {0};
    for (size_t e = c->y.first[p]; e < c->y.first[p + 1]; e++) {
        const link *l = &c->link[c->y.entry[e] / 2];
        const double n[3] = {l->n[0], l->n[1], l->n[2]};
        const double nn[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                              n[0] * n[1], n[1] * n[2], n[2] * n[0]};
        const double arm = c->y.entry[e] & 1 ? l->arm_j : l->arm_i;
        const double side = c->y.entry[e] & 1 ? 1.0 : -1.0, turn = arm * arm * l->kt;
        b.kt += l->kt;
        b.turn += turn;
        for (int a = 0; a < 6; a++) b.normal[a] += ((double)l->kn - l->kt) * nn[a];
        for (int a = 0; a < 6; a++) b.turn_normal[a] += turn * nn[a];
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

/* Factors a block by Cholesky; components that are fixed, or without resistance once those before
 * them are fixed, are left out. */
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

static void make_blocks(cg *c) {
#pragma omp parallel for num_threads(c->threads) schedule(static)
    for (size_t p = 0; p < c->y.particles; p++) {
        double k[36];
        bool in[N] = {false};
        block_of(c, p, k);
        for (size_t a = 0; a < N; a++) {
            double *diagonal = &k[(N + 1) * a];
            c->made->ground[N * p + a] = everywhere * *diagonal + drag_of(c, p, (int)a);
            *diagonal += c->made->ground[N * p + a];
            bool moves = (c->free[p] >> a & 1) && *diagonal > 0.0;
            c->made->weight[N * p + a] = moves ? 1.0 / *diagonal : 0.0;
        }
        factor(k, c->free[p], in);
        invert(k, in, c->made->inverse[p]);
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

static void make_coarse(cg *c) {
    if (!c->made->coarse.groups) return;
    for (size_t k = 0; k < c->y.springs; k++) {
        const link *l = &c->link[k];
        gn_coarse_spring s = {l->i, l->j, {l->n[0], l->n[1], l->n[2]}, l->kn, l->kt, {{0}}, {{0}}};
        end_moves(c->free[l->i], -1.0, l->arm_i, l->n, s.by_p);
        if (l->j >= 0) end_moves(c->free[l->j], 1.0, l->arm_j, l->n, s.by_q);
        gn_coarse_add(&c->made->coarse, &s);
    }
    for (size_t p = 0; p < c->y.particles; p++) {
        double ground[N];
        for (size_t a = 0; a < N; a++)
            ground[a] = c->free[p] >> a & 1 ? c->made->ground[N * p + a] : 0.0;
        gn_coarse_ground(&c->made->coarse, p, ground);
    }
    gn_coarse_factor(&c->made->coarse);
}

/* Computes z of a particle; returns its contribution to r.z. */
static inline double precondition(const cg *c, size_t p) {
    const double *r = c->r + N * p;
    double *z = c->z + N * p, sum = 0.0;
    for (int a = 0; a < N; a++) z[a] = 0.0;
    for (int b = 0; b < N; b++)
        for (int a = 0; a < N; a++) z[a] += (double)c->made->inverse[p][N * b + a] * r[b];
    if (c->made->coarse.groups) gn_coarse_spread(&c->made->coarse, p, c->free[p], z);
    for (int a = 0; a < N; a++) sum += r[a] * z[a];
    return sum;
}

/* --- the iteration --- */

static size_t chunks_of(const cg *c) {
    return (c->y.particles + CHUNK - 1) / CHUNK;
}

static size_t end_of(const cg *c, size_t chunk) {
    size_t end = (chunk + 1) * CHUNK;
    return end < c->y.particles ? end : c->y.particles;
}

static part add_up(const cg *c) {
    part sum = {0};
    for (size_t k = 0; k < chunks_of(c); k++) {
        sum.curvature += c->parts[k].curvature;
        sum.rz += c->parts[k].rz;
        sum.left += c->parts[k].left;
    }
    return sum;
}

/* Computes Kp and returns p.Kp. */
static double apply(const cg *c) {
#pragma omp parallel num_threads(c->threads) if (c->y.particles > CHUNK)
    {
#pragma omp for schedule(static)
        for (size_t s = 0; s < c->y.springs; s++) pull_of(&c->link[s], c->p, c->pull[s]);
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(c); k++) {
            c->parts[k] = (part){0};
            for (size_t p = k * CHUNK; p < end_of(c, k); p++)
                c->parts[k].curvature += gather(c, c->p, p, c->kp + N * p);
        }
    }
    return add_up(c).curvature;
}

/* u += step p, r -= step Kp; computes z from r. */
static part go(const cg *c, double step, double *u) {
#pragma omp parallel num_threads(c->threads) if (c->y.particles > CHUNK)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(c); k++) {
            c->parts[k] = (part){0};
            for (size_t a = N * k * CHUNK; a < N * end_of(c, k); a++) {
                u[a] += step * c->p[a];
                c->r[a] -= step * c->kp[a];
                c->parts[k].left += c->made->weight[a] * c->r[a] * c->r[a];
            }
        }
#pragma omp for schedule(static)
        for (size_t g = 0; g < c->made->coarse.groups; g++)
            gn_coarse_gather(&c->made->coarse, g, c->r, c->free);
#pragma omp single
        gn_coarse_solve(&c->made->coarse);
#pragma omp for schedule(static)
        for (size_t k = 0; k < chunks_of(c); k++)
            for (size_t p = k * CHUNK; p < end_of(c, k); p++) c->parts[k].rz += precondition(c, p);
    }
    return add_up(c);
}

/* p = z + factor p */
static void turn(const cg *c, double factor) {
#pragma omp parallel for num_threads(c->threads) schedule(static) if (c->y.particles > CHUNK)
    for (size_t k = 0; k < c->n; k++) c->p[k] = c->z[k] + factor * c->p[k];
}

/* Returns a particle with a load but without contacts. */
static int32_t untouched(const cg *c) {
    for (size_t p = 0; p < c->y.particles; p++) {
        bool loaded = false;
        for (size_t a = 0; a < N; a++) loaded = loaded || c->r[N * p + a] != 0.0;
        if (loaded && c->y.first[p] == c->y.first[p + 1])
            return c->y.spectrum->assembly->particles->id[p];
    }
    return -1;
}

/* Returns the number of iterations without progress that are allowed. The effect of a load advances
 * by one particle in each iteration, so that this is some lengths of the specimen in diameters.
 * Motions that only the regularisation resists may never converge because of rounding. */
static int patience_of(const cg *c) {
    const gn_particles *q = c->y.spectrum->assembly->particles;
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

static void iterate(cg *c, double tolerance, double *u, gn_equilibrium *found) {
    memset(u, 0, c->n * sizeof *u);
    part now = go(c, 0.0, u);
    const double first = now.left;
    const int patience = patience_of(c);
    double least = first;
    int since = 0;
    turn(c, 0.0);
    for (found->iterations = 0; now.left > tolerance * tolerance * first; found->iterations++) {
        if (since++ > patience || found->iterations == ITERATIONS_MOST) break;
        double curvature = apply(c);
        if (!(curvature > 0.0)) break;
        part next = go(c, now.rz / curvature, u);
        turn(c, next.rz / now.rz);
        now = next;
        if (now.left > 0.5 * least) continue;
        least = now.left;
        since = 0;
    }
    found->residual = first > 0.0 ? sqrt(now.left / first) : 0.0;
}

/* --- what was made before --- */

/* Tells whether a particle has contacts that the blocks do not include. */
static bool touches_more(const cg *c) {
    const double *weight = c->made->weight;
    for (size_t p = 0; p < c->y.particles; p++)
        for (size_t a = 0; a < N && c->y.first[p] < c->y.first[p + 1]; a++)
            if ((c->free[p] >> a & 1) && weight[N * p + a] == 0.0) return true;
    return false;
}

/* Rebuilds the preconditioner if the system changed or may have, since contacts open and slide.
 * Drag, which is part of the diagonal, has another rate every time. */
static gneiss_status make_preconditioner(cg *c, gneiss_error *error) {
    gn_preconditioner *m = c->made;
    const size_t n = c->y.particles;
    bool good = m->particles == n && c->viscosity.drag == 0.0 && m->uses++ < USES;
    if (good && !touches_more(c)) return GNEISS_OK;
    gn_preconditioner_free(m);
    m->inverse = gn_alloc_array(n + 1, sizeof *m->inverse);
    m->ground = gn_alloc_array(c->n + 1, sizeof *m->ground);
    m->weight = gn_alloc_array(c->n + 1, sizeof *m->weight);
    if (!m->inverse || !m->ground || !m->weight)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the equilibrium of %zu particles",
                       n);
    GN_TRY(gn_coarse_create(&m->coarse, n, c->y.spectrum->assembly->particles->pos, error));
    make_blocks(c);
    make_coarse(c);
    m->particles = n;
    return GNEISS_OK;
}

gneiss_status gn_equilibrium_solve(const gn_spectrum *spectrum, gn_viscosity viscosity,
                                   const double *load, double tolerance, gn_preconditioner *made,
                                   double *u, gn_equilibrium *found, gneiss_error *error) {
    cg c = {.threads = spectrum->threads > 0 ? spectrum->threads : 1,
            .viscosity = viscosity,
            .made = made};
    *found = (gn_equilibrium){.loose = -1};
    gneiss_status status = gn_springs_build(spectrum, NULL, &c.y, error);
    if (status == GNEISS_OK) status = allocate(&c, error);
    if (status == GNEISS_OK) {
        take_links(&c);
        status = make_preconditioner(&c, error);
    }
    if (status == GNEISS_OK) {
        for (size_t k = 0; k < c.n; k++) c.r[k] = c.free[k / N] >> k % N & 1 ? load[k] : 0.0;
        found->loose = untouched(&c);
        if (found->loose < 0) iterate(&c, tolerance, u, found);
    }
    free_cg(&c);
    return status;
}
