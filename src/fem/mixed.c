/* The mixed form: pressures at nodes, stabilised by orthogonal sub-scales.
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
            lumped[2 * n] += share / gn_fem_bulk(q, e);
            lumped[2 * n + 1] += share * q->tau[e];
        }
    }
    for (size_t k = 0; k < 2 * body->nodes.soa.count; k++) lumped[k] = 1.0 / lumped[k];
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

gneiss_status gn_fem_mixed_prepare(gn_fem_body *body, gneiss_error *error) {
    size_t rows = (size_t)body->partials.first[body->partials.blocks] + 1;
    body->dilation_kernel = body->kernels->dilation[body->dimension == 3];
    body->growth_row = gn_alloc_array(rows, 2 * sizeof *body->growth_row);
    body->gradient_row = gn_alloc_array(rows, 4 * sizeof *body->gradient_row);
    body->pressure_sums = gn_alloc_array(body->motion_blocks + 1, sizeof *body->pressure_sums);
    body->pressure = gn_alloc_array(body->nodes.soa.count + 1, sizeof *body->pressure);
    if (!body->growth_row || !body->gradient_row || !body->pressure_sums || !body->pressure)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for the pressures of %zu nodes",
                       body->name, body->nodes.soa.count);
    weigh(body);
    return choose_rate(body, error);
}

/* --- a step
 * ---------------------------------------------------------------------------------------- */

gn_dilation_args gn_fem_dilation_args(const gn_fem_body *body) {
    return (gn_dilation_args){body->nodes.pos, body->nodes.smooth, &body->elements, &body->partials,
                              body->growth_row};
}

/* Growth and stabilising term of a block of nodes. */
static void gather_growth(const gn_fem_body *body, size_t block, double sum[][2]) {
    const gn_partials *q = &body->partials;
    memset(sum, 0, GN_PARTICLE_BLOCK * sizeof *sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        double *to = sum[q->share[k].particle - (int32_t)(block * GN_PARTICLE_BLOCK)];
        const double *row = body->growth_row + 2 * (int64_t)q->share[k].row;
        to[0] += row[0];
        to[1] += row[1];
    }
}

static size_t end_of(const gn_fem_body *body, size_t block) {
    size_t end = (block + 1) * GN_PARTICLE_BLOCK;
    return end < body->nodes.soa.count ? end : body->nodes.soa.count;
}

void gn_fem_pressure_block(gn_fem_body *body, size_t block) {
    gn_particles *q = &body->nodes;
    const size_t begin = block * GN_PARTICLE_BLOCK, end = end_of(body, block);
    const double per_time = body->dt_past > 0.0 ? 1.0 / body->dt_past : 0.0;
    double sum[GN_PARTICLE_BLOCK][2], elastic = 0.0;
    gather_growth(body, block, sum);
    for (size_t n = begin; n < end; n++) {
        const double growth = sum[n - begin][0], term = sum[n - begin][1];
        const double pressure = q->lumped[2 * n] * (growth - term);
        double *kept = q->stabiliser + 3 * n;
        kept[1] = (term - kept[0]) * per_time;
        kept[0] = term;
        memcpy(q->placed_p + 4 * n, q->pos + 4 * n, 3 * sizeof(double));
        q->placed_p[4 * n + 3] = pressure;
        elastic += pressure * (growth - term) + q->smooth[4 * n + 3] * term;
    }
    body->pressure_sums[block] = (gn_fem_pressure_sums){.elastic = 0.5 * elastic};
}

/* With viscous damping q is damped at the same rate; other kinds damp a mode of frequency w by
 * about a/pi of the critical value. */
static double damping_rate(const gn_fem_body *body) {
    const double pi = 3.14159265358979323846;
    if (body->effects & GN_FX_VISCOUS) return body->damping_coefficient;
    if (!(body->effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT))) return 0.0;
    return 2.0 / pi * body->damping_coefficient * sqrt(body->rate2);
}

/* Energies of the inertia S/w^2: S times the rate of the past interval is known from the change of
 * the stabilising term. A loss is booked when its interval has passed: its second half (with the
 * mean rate of the instant at which it began) before its first one. */
static void book(const gn_fem_body *body, size_t n, double before, double after, double damping,
                 gn_fem_pressure_sums *s) {
    double *kept = body->nodes.stabiliser + 3 * n, mean = 0.5 * (before + after);
    double momentum = kept[1] / body->rate2;
    s->elastic += 0.5 * after * momentum;
    s->damping += 0.5 * body->dt_past * damping * (kept[2] + mean) * momentum;
    kept[2] = mean;
}

void gn_fem_smooth_block(gn_fem_body *body, size_t block, double dt) {
    gn_particles *p = &body->nodes;
    const gn_partials *q = &body->partials;
    const size_t begin = block * GN_PARTICLE_BLOCK, end = end_of(body, block);
    const double interval = 0.5 * (body->dt_past + dt), damping = damping_rate(body);
    const double half = 0.5 * damping * interval, kick = interval * body->rate2;
    double sum[GN_PARTICLE_BLOCK][4];
    memset(sum, 0, sizeof sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        double *to = sum[q->share[k].particle - (int32_t)begin];
        const double *row = body->gradient_row + 4 * (int64_t)q->share[k].row;
        for (int c = 0; c < 4; c++) to[c] += row[c];
    }
    for (size_t n = begin; n < end; n++) {
        double *value = p->smooth + 4 * n, *rate = p->smooth_rate + 4 * n, before = rate[3];
        double *target = sum[n - begin];
        for (int c = 0; c < 3; c++) target[c] *= p->lumped[2 * n + 1];
        target[3] = p->placed_p[4 * n + 3];
        for (int c = 0; c < 4; c++) {
            rate[c] = ((1.0 - half) * rate[c] + kick * (target[c] - value[c])) / (1.0 + half);
            value[c] += dt * rate[c];
        }
        book(body, n, before, rate[3], damping, &body->pressure_sums[block]);
    }
}

/* --- reading
 * --------------------------------------------------------------------------------------- */

/* Of the mixed form: one serial pass over all blocks; the rows are made anew in every step. */
static void find_pressures(const gn_fem_body *body, double *pressure) {
    const gn_dilation_args args = gn_fem_dilation_args(body);
    const gn_partials *q = &body->partials;
    double sum[GN_PARTICLE_BLOCK][2];
    for (size_t b = 0; b < q->blocks; b++) {
        size_t end = (b + 1) * q->length;
        if (end > body->elements.soa.count) end = body->elements.soa.count;
        body->dilation_kernel(&args, b * q->length, end);
    }
    for (size_t b = 0; b < body->motion_blocks; b++) {
        gather_growth(body, b, sum);
        for (size_t n = b * GN_PARTICLE_BLOCK; n < end_of(body, b); n++) {
            const double *s = sum[n % GN_PARTICLE_BLOCK];
            pressure[n] = body->nodes.lumped[2 * n] * (s[0] - s[1]);
        }
    }
}

void gn_fem_find_pressures(const gn_fem_body *body) {
    find_pressures(body, body->pressure);
}
