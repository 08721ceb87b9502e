/* The pressure form: pressures at nodes, stabilised by orthogonal sub-scales.
 *
 * The potential energy of a solid whose nodes have grown by e = sum_e (V - V0)/(nodes of an
 * element) and whose stabilising pressure is q is that of the deviator plus 1/2 p.M_p p + 1/2 q.S q
 * with   p = M_p^-1 (e - S q), M_p the lumped mass over K and S = L - Q Gh^-1 Q^T the orthogonal
 * sub-scales: q.S q is the least sum over pi of tau |grad q - pi|^2, taken at the corners of the
 * elements. Its minimum over q is the static method, q = p and (M_p + S) p = e. Here q has an
 * inertia S/w^2 instead, so that q'' = w^2 (p - q), which needs no solution of equations:
 * everything is local, q is integrated by the leap-frog of the nodes, and energy is conserved as in
 * the displacement form. Its mean gradient pi obeys the same equation and needs no projection of
 * its own: pi'' = w^2 (Gh^-1 Q^T p - pi). docs/fem.md derives it.
 */
#include "fem/internal.h"

#include "base/new.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

/* tau = c h^2/(2 G). */
static const double c_stabilising = 1.0;
/* Ratio of the squared frequency of q to that at which q would determine the bound of the time
 * step. A larger ratio would shorten steps; with a smaller one q lags behind. */
static const double rate_share = 0.25;

/* Returns the square of the size of an element, which is the side of a regular element of the same
 * volume. */
static double size2(const gn_elements *elements, size_t e) {
    const int d = gn_elements_dimension(elements);
    double sum = 0.0, rest[3] = {0.0};
    for (int a = 1; a <= d; a++)
        for (int k = 0; k < d; k++) {
            double g = gn_elements_gradient(elements, a, k)[e];
            rest[k] -= g;
            sum += g * g;
        }
    for (int k = 0; k < d; k++) sum += rest[k] * rest[k];
    return 2.0 * d / sum;
}

/* Returns the bulk modulus, Pa. */
static double bulk_modulus(const gn_elements *elements, size_t e) {
    return elements->lambda[e] + 2.0 / 3.0 * elements->mu[e];
}

static void weigh(gn_fem_solid *solid) {
    gn_elements *q = &solid->elements;
    const int nodes = solid->dimension + 1;
    double *lumped = solid->nodes.lumped;
    for (size_t e = 0; e < q->soa.count; e++) {
        q->tau[e] = c_stabilising * size2(q, e) / (2.0 * q->mu[e]);
        double share = q->volume[e] / nodes;
        for (int a = 0; a < nodes; a++) {
            size_t n = (size_t)gn_elements_node(q, a)[e];
            lumped[4 * n] += share / bulk_modulus(q, e);
            lumped[4 * n + 1] += share * q->tau[e];
        }
    }
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (size_t k = 0; k < 2; k++) lumped[4 * n + k] = 1.0 / lumped[4 * n + k];
}

/* Returns the largest eigenvalue of M_p^-1 S for a single element with its own M_p: K tau nodes
 * times the largest eigenvalue of sum_a grad N_a (x) grad N_a. */
double gn_fem_stabiliser_eigenvalue(const gn_elements *elements, size_t e) {
    const int d = gn_elements_dimension(elements);
    double a[9] = {0.0}, rest[3] = {0.0}, values[3], vectors[9];
    for (int n = 1; n <= d + 1; n++)
        for (int i = 0; i < d; i++) {
            double gi = n <= d ? gn_elements_gradient(elements, n, i)[e] : rest[i];
            if (n <= d) rest[i] -= gi;
            for (int k = 0; k < d; k++)
                a[d * i + k] += gi * (n <= d ? gn_elements_gradient(elements, n, k)[e] : rest[k]);
        }
    gn_eigen_symmetric(d, a, values, vectors);
    return (d + 1) * bulk_modulus(elements, e) * elements->tau[e] * values[0];
}

/* Chooses the rate of q such that q does not change the bound of the time step. */
static gneiss_status choose_rate(gn_fem_solid *solid, gneiss_error *error) {
    gn_fem_limit limit;
    double most = 0.0;
    for (size_t e = 0; e < solid->elements.soa.count; e++)
        most = fmax(most, gn_fem_stabiliser_eigenvalue(&solid->elements, e));
    GN_TRY(gn_fem_bound(solid, &limit, error));
    solid->rate2 = rate_share * 4.0 / (limit.bound * limit.bound) / (1.0 + most);
    return GNEISS_OK;
}

gneiss_status gn_fem_pressure_prepare(gn_fem_solid *solid, gneiss_error *error) {
    const size_t rows = (size_t)solid->partials.first[solid->partials.blocks];
    solid->dilation_kernel = solid->kernels->dilation[solid->dimension == 3];
    solid->pressure_kernel = solid->kernels->pressure;
    GN_TRY(gn_new(&solid->growth_row, 2 * (rows + 1), "partial sums of volumes", error));
    GN_TRY(gn_new(&solid->slope_row, 2 * (rows + 1), "partial sums of pressures", error));
    GN_TRY(gn_new(&solid->pressure_sums, solid->motion_blocks + 1, "blocks of nodes", error));
    GN_TRY(gn_new(&solid->pressure, solid->nodes.soa.count + 1, "pressures of nodes", error));
    weigh(solid);
    gn_fem_positions_changed(solid);
    return choose_rate(solid, error);
}

/* --- a step --- */

static void copy_places(const gn_fem_solid *solid) {
    const gn_particles *q = &solid->nodes;
    for (size_t n = 0; n < q->soa.count; n++) {
        memcpy(q->placed_p + 4 * n, q->pos + 4 * n, 3 * sizeof *q->pos);
        q->placed_p[4 * n + 3] = q->smooth[4 * n + 3];
    }
}

void gn_fem_positions_changed(gn_fem_solid *solid) {
    if (solid->form == GN_FEM_PRESSURE) copy_places(solid);
    gn_particles_to_single(&solid->nodes, solid->nodes.start, solid->threads);
}

gn_dilation_args gn_fem_dilation_args(const gn_fem_solid *solid) {
    return (gn_dilation_args){solid->nodes.placed_p, solid->nodes.smooth, &solid->elements,
                              &solid->partials, solid->growth_row};
}

/* Returns the damping rate of q. With viscous damping it is that of the motion; other kinds damp a
 * mode of frequency w at about a/pi of the critical value. */
static double damping_rate(const gn_fem_solid *solid) {
    const double pi = 3.14159265358979323846;
    if (solid->effects & GN_FX_VISCOUS) return solid->damping_coefficient;
    if (!(solid->effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT))) return 0.0;
    return 2.0 / pi * solid->damping_coefficient * sqrt(solid->rate2);
}

gn_pressure_args gn_fem_pressure_args(gn_fem_solid *solid, double dt, bool measure) {
    const double damping = damping_rate(solid);
    return (gn_pressure_args){.nodes = &solid->nodes,
                              .partials = &solid->partials,
                              .growth_row = solid->growth_row,
                              .slope_row = solid->slope_row,
                              .dt_past = solid->dt_past,
                              .dt = dt,
                              .rate2 = solid->rate2,
                              .damping = damping,
                              .book = measure || damping > 0.0};
}

/* --- reading --- */

/* Computes pressures in a single serial pass over all blocks; rows are overwritten in every step,
 * and no energies are needed. */
void gn_fem_find_pressures(const gn_fem_solid *solid) {
    const gn_dilation_args args = gn_fem_dilation_args(solid);
    const gn_partials *q = &solid->partials;
    const size_t nodes = solid->nodes.soa.count;
    double *pressure = solid->pressure;
    copy_places(solid);
    memset(pressure, 0, nodes * sizeof *pressure);
    for (size_t b = 0; b < q->blocks; b++) {
        size_t end = (b + 1) * q->length;
        if (end > solid->elements.soa.count) end = solid->elements.soa.count;
        solid->dilation_kernel(&args, b * q->length, end);
    }
    for (int32_t s = 0; s < q->first[q->blocks]; s++) {
        const double *row = solid->growth_row + 2 * (int64_t)q->share[s].row;
        pressure[q->share[s].particle] += row[0] - row[1];
    }
    for (size_t n = 0; n < nodes; n++) pressure[n] *= solid->nodes.lumped[4 * n];
}

/* ---- the pressure form linearised at the start: of the displacements u and the stabilising
 * pressure q,   u'' = -M^-1 (K_dev u + C p),   q'' = w^2 (p - q),   p = M_p^-1 (C^T u - S q), which
 * is -B^-1 A (u, q) with the energy A, u.K_dev u + p.M_p p + q.S q, and the inertia B = diag(M,
 * S/w^2): symmetric in the metric of B.  Bound. Let r = C^T u - S q have the part r_ae = V div
 * u/nodes - s_ae in element e at its node a, s_ae = tau V grad N_a . (grad q - mean pi), whose sum
 * over the nodes is zero. By Cauchy's inequality p.M_p p = sum_a (sum_e r_ae)^2/sum_e m_ae <= sum_e
 * sum_a r_ae^2/m_ae,   m_ae = V/(nodes K), and sum_a r_ae^2/m_ae = K V (div u)^2 + nodes K/V sum_a
 * s_ae^2: u and q part. The u part is in the displacement form's element energy; q.S q is the sum
 * of tau V/nodes |grad q - pi_a|^2 over the corners, at least tau V |grad q - mean pi|^2, so that
 * the rest is at most (1 + x) q.S q with x the largest of nodes K tau lambda_max(sum_a grad N_a (x)
 * grad N_a). Hence w_max^2 is at most the larger of the displacement form's bound and w^2 (1 + x)
 * ---- */

typedef gn_fem_linear linear_system;

/* Adds an element's contribution in a pass to the partial sums of its block. */
typedef void add_element(const linear_system *system, size_t e, double *sums[4]);

/* Receives the sum of a pass at a node, added up in block order. */
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

/* Computes grad q in an element; add_gradient integrates it times tau and distributes it to the
 * nodes. */
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

/* Adds the growth of the volume and the stabilising term. */
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
