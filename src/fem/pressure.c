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
#include "base/memory.h"
#include "fem/internal.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

/* tau = c h^2/(2 G). */
static const double c_stabilising = 1.0;
/* Fraction of the squared frequency at which q would determine the bound of the time step; a larger
 * one would shorten steps, a smaller one makes q lag behind. */
static const double rate_share = 0.25;

/* Returns the squared size of an element: the side of a regular element of that volume. */
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

/* Returns the eigenvalue of M_p^-1 S of a single element with its own M_p: nodes K tau times the
 * largest eigenvalue of sum_a grad N_a (x) grad N_a. */
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

/* Chooses the rate at which q does not change the bound of the time step. */
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
    size_t rows = (size_t)solid->partials.first[solid->partials.blocks] + 1;
    solid->dilation_kernel = solid->kernels->dilation[solid->dimension == 3];
    solid->pressure_kernel = solid->kernels->pressure;
    solid->growth_row = gn_alloc_array(rows, 2 * sizeof *solid->growth_row);
    solid->slope_row = gn_alloc_array(rows, 2 * sizeof *solid->slope_row);
    solid->pressure_sums = gn_alloc_array(solid->motion_blocks + 1, sizeof *solid->pressure_sums);
    solid->pressure = gn_alloc_array(solid->nodes.soa.count + 1, sizeof *solid->pressure);
    if (!solid->growth_row || !solid->slope_row || !solid->pressure_sums || !solid->pressure)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for the pressures of %zu nodes",
                       solid->name, solid->nodes.soa.count);
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
 * mode of frequency w by about a/pi of the critical value. */
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

/* Computes pressures in one serial pass over all blocks; rows are overwritten in every step, and no
 * energy is needed. */
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
