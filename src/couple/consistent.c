#include "couple/consistent.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* --- nodes that share a particle --- */

static size_t place_of(const gn_consistent *system, size_t node, int32_t other) {
    size_t k = (size_t)system->row[node];
    while (k < (size_t)system->row[node + 1] && system->column[k] != other) k++;
    return k;
}

/* Lists the neighbours of each node in the order of the ties. */
static void list_neighbours(gn_consistent *system) {
    const gn_ties *t = system->ties;
    system->row[0] = 0;
    for (size_t n = 0; n < t->nodes; n++) {
        system->row[n + 1] = system->row[n];
        for (int32_t s = t->first[n]; s < t->first[n + 1]; s++)
            for (int a = 0; a < t->corners; a++) {
                const int32_t other = t->tie[t->share[s].tie].own[a];
                if (other == (int32_t)n || place_of(system, n, other) < (size_t)system->row[n + 1])
                    continue;
                system->column[system->row[n + 1]++] = other;
            }
    }
}

void gn_consistent_assemble(gn_consistent *system, const double *mass) {
    const gn_ties *t = system->ties;
    memset(system->weight, 0, (size_t)system->row[t->nodes] * sizeof *system->weight);
    for (size_t n = 0; n < t->nodes; n++)
        for (int32_t s = t->first[n]; s < t->first[n + 1]; s++) {
            const gn_tie_share *share = &t->share[s];
            const gn_tie *tie = &t->tie[share->tie];
            for (int a = 0; a < t->corners; a++)
                if (tie->own[a] != (int32_t)n)
                    system->weight[place_of(system, n, tie->own[a])] +=
                        tie->shape[a] * tie->shape[share->corner] * mass[share->tie];
        }
}

gneiss_status gn_consistent_create(const gn_ties *ties, gn_consistent *system,
                                   gneiss_error *error) {
    const size_t n = ties->nodes + 1,
                 room = ties->count * (size_t)(ties->corners * (ties->corners - 1)) + 1;
    *system = (gn_consistent){.ties = ties, .threads = 1};
    system->row = gn_alloc_array(n, sizeof *system->row);
    system->column = gn_alloc_array(room, sizeof *system->column);
    system->weight = gn_alloc_array(room, sizeof *system->weight);
    system->whole = gn_alloc_array(n, sizeof *system->whole);
    system->load = gn_alloc_array(n, 3 * sizeof *system->load);
    system->rate = gn_alloc_array(n, 3 * sizeof *system->rate);
    system->fixed = gn_alloc_array(n, 3 * sizeof *system->fixed);
    bool held = system->row && system->column && system->weight && system->whole && system->load &&
                system->rate && system->fixed;
    for (int k = 0; k < 5; k++)
        held = (system->work[k] = gn_alloc_array(n, 3 * sizeof *system->work[k])) && held;
    if (held) {
        list_neighbours(system);
        return GNEISS_OK;
    }
    gn_consistent_free(system);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes of zones", ties->nodes);
}

void gn_consistent_free(gn_consistent *system) {
    void *blocks[] = {system->row,     system->column,  system->weight,  system->whole,
                      system->load,    system->rate,    system->fixed,   system->work[0],
                      system->work[1], system->work[2], system->work[3], system->work[4]};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *system = (gn_consistent){0};
}

/* --- products --- */

/* Number of nodes below which loops are not distributed over threads. */
enum { FEW = 1000 };

static inline __attribute__((always_inline)) void
spread_at(const gn_consistent *system, size_t n, const double *x, double *out, size_t dimension) {
    double sum[3] = {0.0};
    for (int32_t k = system->row[n]; k < system->row[n + 1]; k++)
        for (size_t c = 0; c < dimension; c++)
            sum[c] += system->weight[k] * (x[3 * n + c] - x[3 * (size_t)system->column[k] + c]);
    memcpy(out + 3 * n, sum, sizeof sum);
}

/* Computes out_a = sum_b W_ab (x_a - x_b) with W = N^T M N, whose row sums are the lumped masses.
 */
static void spread(const gn_consistent *system, const double *x, double *out) {
    const size_t nodes = system->ties->nodes;
    const bool flat = system->ties->corners == 3;
#pragma omp parallel for num_threads(system->threads) schedule(static) if (nodes > FEW)
    for (size_t n = 0; n < nodes; n++)
        if (flat)
            spread_at(system, n, x, out, 2);
        else
            spread_at(system, n, x, out, 3);
}

static void multiply(const gn_consistent *system, const double *x, double *out) {
    spread(system, x, out);
    for (size_t n = 0; n < system->ties->nodes; n++)
        for (size_t c = 0; c < 3; c++)
            out[3 * n + c] = system->whole[n] * x[3 * n + c] - out[3 * n + c];
}

static double dot(const gn_consistent *system, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t k = 0; k < 3 * system->ties->nodes; k++) sum += a[k] * b[k];
    return sum;
}

/* Sets the initial guess (the accelerations with lumped masses) and the residual; returns the norm
 * to which residuals are compared. */
static double begin(gn_consistent *system) {
    double *r = system->work[0], *p = system->work[2], *q = system->work[3],
           *inverse = system->work[4], scale = 0.0;
    for (size_t n = 0; n < system->ties->nodes; n++)
        for (size_t k = 3 * n; k < 3 * n + 3; k++) {
            inverse[k] = system->fixed[k] ? 0.0 : 1.0 / system->whole[n];
            if (!system->fixed[k]) system->rate[k] = system->load[k] * inverse[k];
            scale += system->load[k] * system->load[k] / system->whole[n];
        }
    multiply(system, system->rate, q);
    for (size_t k = 0; k < 3 * system->ties->nodes; k++) {
        r[k] = system->load[k] - q[k];
        p[k] = system->work[1][k] = r[k] * inverse[k];
    }
    return scale;
}

/* The inverse mass of fixed components is 0: their residual is ignored, and search directions
 * vanish there. */
int gn_consistent_solve(gn_consistent *system) {
    enum { ROUNDS = 60 };
    const size_t count = 3 * system->ties->nodes;
    const double scale = begin(system), *inverse = system->work[4];
    double *x = system->rate, *r = system->work[0], *z = system->work[1], *p = system->work[2],
           *q = system->work[3];
    double size = dot(system, r, z);
    int round = 0;
    for (; round < ROUNDS && size > 1e-26 * scale; round++) {
        multiply(system, p, q);
        const double step = size / dot(system, p, q), before = size;
        for (size_t k = 0; k < count; k++) {
            x[k] += step * p[k];
            r[k] -= step * q[k];
            z[k] = r[k] * inverse[k];
        }
        size = dot(system, r, z);
        for (size_t k = 0; k < count; k++) p[k] = z[k] + size / before * p[k];
    }
    return round;
}

void gn_consistent_difference(const gn_consistent *system, const double *rate, double *out) {
    spread(system, rate, out);
}
