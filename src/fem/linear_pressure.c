/* The pressure form linearised at the start: of the displacements u and the stabilising pressure q,
 *   u'' = -M^-1 (K_dev u + C p),   q'' = w^2 (p - q),   p = M_p^-1 (C^T u - S q),
 * which is -B^-1 A (u, q) with the energy A, u.K_dev u + p.M_p p + q.S q, and the inertia
 * B = diag(M, S/w^2): symmetric in the metric of B.
 *
 * Bound. Let r = C^T u - S q have the part r_ae = V div u/nodes - s_ae in element e at its node a,
 * s_ae = tau V grad N_a . (grad q - mean pi), whose sum over the nodes is zero. By Cauchy's
 * inequality p.M_p p = sum_a (sum_e r_ae)^2/sum_e m_ae <= sum_e sum_a r_ae^2/m_ae,   m_ae =
 * V/(nodes K), and sum_a r_ae^2/m_ae = K V (div u)^2 + nodes K/V sum_a s_ae^2: u and q part. The u
 * part is in the displacement form's element energy; q.S q is the sum of tau V/nodes |grad q -
 * pi_a|^2 over the corners, at least tau V |grad q - mean pi|^2, so that the rest is at most (1 +
 * x) q.S q with x the largest of nodes K tau lambda_max(sum_a grad N_a (x) grad N_a). Hence w_max^2
 * is at most the larger of the displacement form's bound and w^2 (1 + x). */
#include "fem/internal.h"

#include <string.h>

typedef gn_fem_linear linear_system;

/* Adds an element's contribution in a pass to the partial sums of its block. */
typedef void add_element(const linear_system *system, size_t e, double *sums[4]);

/* Receives a node's sum of a pass, added up in block order. */
typedef void take_node(const linear_system *system, size_t node, const double *sum, double *out);

typedef struct pass {
    add_element *add;
    take_node *take;
    size_t width;
    double *row;
} pass;

static void add_block(const linear_system *system, const pass *kind, size_t block) {
    const gn_partials *q = &system->solid->partials;
    const size_t nodes = (size_t)system->dimension + 1;
    double *row = kind->row + kind->width * (size_t)q->first[block], *sums[4];
    memset(row, 0, kind->width * (size_t)(q->first[block + 1] - q->first[block]) * sizeof *row);
    size_t end = (block + 1) * q->length;
    if (end > system->solid->elements.soa.count) end = system->solid->elements.soa.count;
    for (size_t e = block * q->length; e < end; e++) {
        for (size_t a = 0; a < nodes; a++)
            sums[a] = row + q->place[nodes * e + a] * kind->width / 4;
        kind->add(system, e, sums);
    }
}

static void take_block(const linear_system *system, const pass *kind, size_t block, double *out) {
    const gn_partials *q = &system->solid->partials;
    const size_t begin = block * GN_PARTICLE_BLOCK;
    double sum[GN_PARTICLE_BLOCK][4];
    memset(sum, 0, sizeof sum);
    for (int32_t s = q->start[block]; s < q->start[block + 1]; s++)
        for (size_t k = 0; k < kind->width; k++)
            sum[(size_t)q->share[s].particle - begin][k] +=
                kind->row[kind->width * (size_t)q->share[s].row + k];
    for (size_t n = begin; n < begin + GN_PARTICLE_BLOCK && n < system->solid->nodes.soa.count; n++)
        kind->take(system, n, sum[n - begin], out);
}

static void run(const linear_system *system, pass kind, double *out) {
#pragma omp parallel num_threads(system->solid->threads)
    {
#pragma omp for schedule(static)
        for (size_t b = 0; b < system->solid->partials.blocks; b++) add_block(system, &kind, b);
#pragma omp for schedule(static)
        for (size_t b = 0; b < system->solid->motion_blocks; b++) take_block(system, &kind, b, out);
    }
}

/* --- passes --- */

/* Integrates grad q over tau and distributes it to the nodes. */
static void gradient_of(const linear_system *system, size_t e, double gradient[4][3], double g[3]) {
    const gn_elements *q = &system->solid->elements;
    gn_fem_gradients(q, e, gradient);
    for (int k = 0; k < 3; k++) g[k] = 0.0;
    for (int a = 0; a <= system->dimension; a++)
        for (int k = 0; k < system->dimension; k++)
            g[k] += gradient[a][k] * system->gradient[4 * (size_t)gn_elements_node(q, a)[e] + 3];
}

static void add_gradient(const linear_system *system, size_t e, double *sums[4]) {
    const gn_elements *q = &system->solid->elements;
    double gradient[4][3], g[3], share = q->tau[e] * q->volume[e] / (system->dimension + 1);
    gradient_of(system, e, gradient, g);
    for (int a = 0; a <= system->dimension; a++)
        for (int k = 0; k < 3; k++) sums[a][k] += share * g[k];
}

static void take_gradient(const linear_system *system, size_t n, const double *sum, double *out) {
    (void)out;
    for (int k = 0; k < 3; k++)
        system->gradient[4 * n + (size_t)k] = system->solid->nodes.lumped[4 * n + 1] * sum[k];
}

/* Adds growth and stabilising term. */
static void add_growth(const linear_system *system, size_t e, double *sums[4]) {
    const gn_elements *q = &system->solid->elements;
    const int d = system->dimension;
    double gradient[4][3], g[3], dilation = 0.0;
    gradient_of(system, e, gradient, g);
    for (int a = 0; a <= d; a++) {
        size_t n = (size_t)gn_elements_node(q, a)[e];
        for (int k = 0; k < d; k++) {
            g[k] -= system->gradient[4 * n + (size_t)k] / (d + 1);
            dilation += gradient[a][k] * system->moved[n * (size_t)d + (size_t)k];
        }
    }
    for (int a = 0; a <= d; a++) {
        sums[a][0] += q->volume[e] * dilation / (d + 1);
        for (int k = 0; k < d; k++) sums[a][1] += q->tau[e] * q->volume[e] * gradient[a][k] * g[k];
    }
}

static void take_pressure(const linear_system *system, size_t n, const double *sum, double *out) {
    const size_t at = system->solid->nodes.soa.count * (size_t)system->dimension + n;
    system->pressure[n] = system->solid->nodes.lumped[4 * n] * (sum[0] - sum[1]);
    out[at] = system->solid->rate2 * (system->gradient[4 * n + 3] - system->pressure[n]);
}

static void take_term(const linear_system *system, size_t n, const double *sum, double *out) {
    const size_t at = system->solid->nodes.soa.count * (size_t)system->dimension + n;
    out[at] = sum[1] / system->solid->rate2;
}

static void add_force(const linear_system *system, size_t e, double *sums[4]) {
    const gn_elements *q = &system->solid->elements;
    const int d = system->dimension;
    double gradient[4][3], slope[3][3] = {{0.0}}, pressure = 0.0, trace = 0.0;
    gn_fem_gradients(q, e, gradient);
    for (int a = 0; a <= d; a++) {
        size_t n = (size_t)gn_elements_node(q, a)[e];
        pressure += system->pressure[n] / (d + 1);
        for (int i = 0; i < d; i++)
            for (int k = 0; k < d; k++)
                slope[i][k] += system->moved[n * (size_t)d + (size_t)i] * gradient[a][k];
    }
    for (int k = 0; k < d; k++) trace += slope[k][k];
    for (int i = 0; i < d; i++)
        for (int k = 0; k < d; k++) {
            double stress = q->mu[e] * (slope[i][k] + slope[k][i]);
            if (i == k) stress += pressure - 2.0 / 3.0 * q->mu[e] * trace;
            for (int a = 0; a <= d; a++) sums[a][i] += q->volume[e] * stress * gradient[a][k];
        }
}

static void take_force(const linear_system *system, size_t n, const double *sum, double *out) {
    const size_t d = (size_t)system->dimension;
    for (size_t i = 0; i < d; i++) out[d * n + i] = system->scale[d * n + i] * sum[i];
}

/* --- operators --- */

static void set_fields(const linear_system *system, const double *x) {
    const size_t d = (size_t)system->dimension, nodes = system->solid->nodes.soa.count;
    for (size_t k = 0; k < nodes * d; k++) system->moved[k] = system->scale[k] * x[k];
    for (size_t n = 0; n < nodes; n++) system->gradient[4 * n + 3] = x[nodes * d + n];
}

void gn_fem_linear_pressure(const void *system, const double *x, double *out) {
    const linear_system *y = system;
    gn_fem_solid *solid = y->solid;
    set_fields(y, x);
    run(y, (pass){add_gradient, take_gradient, 4, solid->partials.row}, out);
    run(y, (pass){add_growth, take_pressure, 2, solid->growth_row}, out);
    run(y, (pass){add_force, take_force, 4, solid->partials.row}, out);
}

void gn_fem_linear_metric(const void *system, const double *x, double *out) {
    const linear_system *y = system;
    gn_fem_solid *solid = y->solid;
    set_fields(y, x);
    run(y, (pass){add_gradient, take_gradient, 4, solid->partials.row}, out);
    run(y, (pass){add_growth, take_term, 2, solid->growth_row}, out);
    memcpy(out, x, solid->nodes.soa.count * (size_t)y->dimension * sizeof *out);
}
