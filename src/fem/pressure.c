/* The pressure form: pressures at nodes, stabilised by orthogonal sub-scales.
 *
 * The potential energy of a body whose nodes have grown by e = sum_e (V - V0)/(nodes of an element)
 * and whose stabilising pressure is q is that of the deviator plus
 *   1/2 p.M_p p + 1/2 q.S q   with   p = M_p^-1 (e - S q),
 * M_p the lumped mass over K and S = L - Q Gh^-1 Q^T the orthogonal sub-scales: q.S q is the least
 * sum over pi of tau |grad q - pi|^2, taken at the corners of the elements. Its minimum over q is
 * the static method, q = p and (M_p + S) p = e. Here q has an inertia S/w^2 instead, so that
 *   q'' = w^2 (p - q),
 * which asks for no solution of equations: everything is local, q moves by the leap-frog of the
 * nodes, and energy is conserved as in the displacement form. Its mean gradient pi obeys the same
 * equation and need not be projected anew: pi'' = w^2 (Gh^-1 Q^T p - pi). docs/fem.md derives it.
 */
#include "base/memory.h"
#include "fem/parts.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

/* tau = c h^2/(2 G). */
static const double c_stabilising = 1.0;
/* Of the squared frequency at which the bound of the time step would feel q; more would make steps
 * shorter, less lets q lag behind. */
static const double rate_share = 0.25;

/* Squared size of an element: the side of a regular one, whatever the shape. */
static double size2(const gn_elements *q, size_t e) {
    const int d = gn_elements_dimension(q);
    double sum = 0.0, rest[3] = {0.0};
    for (int a = 1; a <= d; a++)
        for (int k = 0; k < d; k++) {
            double g = gn_elements_gradient(q, a, k)[e];
            rest[k] -= g;
            sum += g * g;
        }
    for (int k = 0; k < d; k++) sum += rest[k] * rest[k];
    return 2.0 * d / sum;
}

double gn_fem_bulk(const gn_elements *q, size_t e) {
    return q->lambda[e] + 2.0 / 3.0 * q->mu[e];
}

static void weigh(gn_fem_body *body) {
    gn_elements *q = &body->elements;
    const int nodes = body->dimension + 1;
    double *lumped = body->nodes.lumped;
    for (size_t e = 0; e < q->soa.count; e++) {
        q->tau[e] = c_stabilising * size2(q, e) / (2.0 * q->mu[e]);
        double share = q->volume[e] / nodes;
        for (int a = 0; a < nodes; a++) {
            size_t n = (size_t)gn_elements_node(q, a)[e];
            lumped[4 * n] += share / gn_fem_bulk(q, e);
            lumped[4 * n + 1] += share * q->tau[e];
        }
    }
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        for (size_t k = 0; k < 2; k++) lumped[4 * n + k] = 1.0 / lumped[4 * n + k];
}

/* M_p^-1 S, element by element, with the element's own M_p: nodes K tau times the largest
 * eigenvalue of sum_a grad N_a (x) grad N_a. */
double gn_fem_stabiliser_eigenvalue(const gn_elements *q, size_t e) {
    const int d = gn_elements_dimension(q);
    double a[9] = {0.0}, rest[3] = {0.0}, values[3], vectors[9];
    for (int n = 1; n <= d + 1; n++)
        for (int i = 0; i < d; i++) {
            double gi = n <= d ? gn_elements_gradient(q, n, i)[e] : rest[i];
            if (n <= d) rest[i] -= gi;
            for (int k = 0; k < d; k++)
                a[d * i + k] += gi * (n <= d ? gn_elements_gradient(q, n, k)[e] : rest[k]);
        }
    gn_eigen_symmetric(d, a, values, vectors);
    return (d + 1) * gn_fem_bulk(q, e) * q->tau[e] * values[0];
}

/* The rate that leaves the bound on the time step where it is without q. */
static gneiss_status choose_rate(gn_fem_body *body, gneiss_error *error) {
    gn_fem_limit limit;
    double most = 0.0;
    for (size_t e = 0; e < body->elements.soa.count; e++)
        most = fmax(most, gn_fem_stabiliser_eigenvalue(&body->elements, e));
    GN_TRY(gn_fem_bound(body, &limit, error));
    body->rate2 = rate_share * 4.0 / (limit.bound * limit.bound) / (1.0 + most);
    return GNEISS_OK;
}

gneiss_status gn_fem_pressure_prepare(gn_fem_body *body, gneiss_error *error) {
    size_t rows = (size_t)body->partials.first[body->partials.blocks] + 1;
    body->dilation_kernel = body->kernels->dilation[body->dimension == 3];
    body->pressure_kernel = body->kernels->pressure;
    body->growth_row = gn_alloc_array(rows, 2 * sizeof *body->growth_row);
    body->slope_row = gn_alloc_array(rows, 2 * sizeof *body->slope_row);
    body->pressure_sums = gn_alloc_array(body->motion_blocks + 1, sizeof *body->pressure_sums);
    body->pressure = gn_alloc_array(body->nodes.soa.count + 1, sizeof *body->pressure);
    if (!body->growth_row || !body->slope_row || !body->pressure_sums || !body->pressure)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for the pressures of %zu nodes",
                       body->name, body->nodes.soa.count);
    weigh(body);
    gn_fem_moved(body);
    return choose_rate(body, error);
}

/* --- a step --- */

static void copy_places(const gn_fem_body *body) {
    const gn_particles *q = &body->nodes;
    for (size_t n = 0; n < q->soa.count; n++) {
        memcpy(q->placed_p + 4 * n, q->pos + 4 * n, 3 * sizeof *q->pos);
        q->placed_p[4 * n + 3] = q->smooth[4 * n + 3];
    }
}

void gn_fem_moved(gn_fem_body *body) {
    if (body->form == GN_FEM_PRESSURE) copy_places(body);
    gn_particles_to_single(&body->nodes, body->nodes.start, body->threads);
}

gn_dilation_args gn_fem_dilation_args(const gn_fem_body *body) {
    return (gn_dilation_args){body->nodes.placed_p, body->nodes.smooth, &body->elements,
                              &body->partials, body->growth_row};
}

/* With viscous damping q is damped at the same rate; other kinds damp a mode of frequency w by
 * about a/pi of the critical value. */
static double damping_rate(const gn_fem_body *body) {
    const double pi = 3.14159265358979323846;
    if (body->effects & GN_FX_VISCOUS) return body->damping_coefficient;
    if (!(body->effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT))) return 0.0;
    return 2.0 / pi * body->damping_coefficient * sqrt(body->rate2);
}

gn_pressure_args gn_fem_pressure_args(gn_fem_body *body, double dt, bool measure) {
    const double damping = damping_rate(body);
    return (gn_pressure_args){.nodes = &body->nodes,
                              .partials = &body->partials,
                              .growth_row = body->growth_row,
                              .slope_row = body->slope_row,
                              .dt_past = body->dt_past,
                              .dt = dt,
                              .rate2 = body->rate2,
                              .damping = damping,
                              .book = measure || damping > 0.0};
}

/* --- reading --- */

/* One serial pass over all blocks; rows are made anew in every step, and no energy is asked for. */
void gn_fem_find_pressures(const gn_fem_body *body) {
    const gn_dilation_args args = gn_fem_dilation_args(body);
    const gn_partials *q = &body->partials;
    const size_t nodes = body->nodes.soa.count;
    double *pressure = body->pressure;
    copy_places(body);
    memset(pressure, 0, nodes * sizeof *pressure);
    for (size_t b = 0; b < q->blocks; b++) {
        size_t end = (b + 1) * q->length;
        if (end > body->elements.soa.count) end = body->elements.soa.count;
        body->dilation_kernel(&args, b * q->length, end);
    }
    for (int32_t s = 0; s < q->first[q->blocks]; s++) {
        const double *row = body->growth_row + 2 * (int64_t)q->share[s].row;
        pressure[q->share[s].particle] += row[0] - row[1];
    }
    for (size_t n = 0; n < nodes; n++) pressure[n] *= body->nodes.lumped[4 * n];
}
