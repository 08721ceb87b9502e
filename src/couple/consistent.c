#include "couple/consistent.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* --- which nodes have a particle together --- */

static size_t place_of(const gn_consistent *y, size_t node, int32_t other) {
    size_t k = (size_t)y->row[node];
    while (k < (size_t)y->row[node + 1] && y->column[k] != other) k++;
    return k;
}

/* Lists the neighbours of each node in the order in which ties have them. */
static void list_neighbours(gn_consistent *y) {
    const gn_ties *t = y->ties;
    y->row[0] = 0;
    for (size_t n = 0; n < t->nodes; n++) {
        y->row[n + 1] = y->row[n];
        for (int32_t s = t->first[n]; s < t->first[n + 1]; s++)
            for (int a = 0; a < t->corners; a++) {
                const int32_t other = t->tie[t->share[s].tie].own[a];
                if (other == (int32_t)n || place_of(y, n, other) < (size_t)y->row[n + 1]) continue;
                y->column[y->row[n + 1]++] = other;
            }
    }
}

void gn_consistent_weigh(gn_consistent *y, const double *mass) {
    const gn_ties *t = y->ties;
    memset(y->weight, 0, (size_t)y->row[t->nodes] * sizeof *y->weight);
    for (size_t n = 0; n < t->nodes; n++)
        for (int32_t s = t->first[n]; s < t->first[n + 1]; s++) {
            const gn_tie_share *share = &t->share[s];
            const gn_tie *tie = &t->tie[share->tie];
            for (int a = 0; a < t->corners; a++)
                if (tie->own[a] != (int32_t)n)
                    y->weight[place_of(y, n, tie->own[a])] +=
                        tie->shape[a] * tie->shape[share->corner] * mass[share->tie];
        }
}

gneiss_status gn_consistent_create(const gn_ties *t, gn_consistent *y, gneiss_error *error) {
    const size_t n = t->nodes + 1, room = t->count * (size_t)(t->corners * (t->corners - 1)) + 1;
    *y = (gn_consistent){.ties = t, .threads = 1};
    y->row = gn_alloc_array(n, sizeof *y->row);
    y->column = gn_alloc_array(room, sizeof *y->column);
    y->weight = gn_alloc_array(room, sizeof *y->weight);
    y->whole = gn_alloc_array(n, sizeof *y->whole);
    y->load = gn_alloc_array(n, 3 * sizeof *y->load);
    y->rate = gn_alloc_array(n, 3 * sizeof *y->rate);
    y->fixed = gn_alloc_array(n, 3 * sizeof *y->fixed);
    bool held = y->row && y->column && y->weight && y->whole && y->load && y->rate && y->fixed;
    for (int k = 0; k < 5; k++)
        held = (y->work[k] = gn_alloc_array(n, 3 * sizeof *y->work[k])) && held;
    if (held) {
        list_neighbours(y);
        return GNEISS_OK;
    }
    gn_consistent_free(y);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes of zones", t->nodes);
}

void gn_consistent_free(gn_consistent *y) {
    void *blocks[] = {y->row,   y->column,  y->weight,  y->whole,   y->load,    y->rate,
                      y->fixed, y->work[0], y->work[1], y->work[2], y->work[3], y->work[4]};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *y = (gn_consistent){0};
}

/* --- products --- */

/* Below this number of nodes, loops are not distributed over threads. */
enum { FEW = 1000 };

static inline __attribute__((always_inline)) void
spread_at(const gn_consistent *y, size_t n, const double *x, double *out, size_t dimension) {
    double sum[3] = {0.0};
    for (int32_t k = y->row[n]; k < y->row[n + 1]; k++)
        for (size_t c = 0; c < dimension; c++)
            sum[c] += y->weight[k] * (x[3 * n + c] - x[3 * (size_t)y->column[k] + c]);
    memcpy(out + 3 * n, sum, sizeof sum);
}

/* out_a = sum_b W_ab (x_a - x_b), W = N^T M N, whose rows add up to the lump. */
static void spread(const gn_consistent *y, const double *x, double *out) {
    const size_t nodes = y->ties->nodes;
    const bool flat = y->ties->corners == 3;
#pragma omp parallel for num_threads(y->threads) schedule(static) if (nodes > FEW)
    for (size_t n = 0; n < nodes; n++)
        if (flat)
            spread_at(y, n, x, out, 2);
        else
            spread_at(y, n, x, out, 3);
}

static void multiply(const gn_consistent *y, const double *x, double *out) {
    spread(y, x, out);
    for (size_t n = 0; n < y->ties->nodes; n++)
        for (size_t c = 0; c < 3; c++) out[3 * n + c] = y->whole[n] * x[3 * n + c] - out[3 * n + c];
}

static double dot(const gn_consistent *y, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t k = 0; k < 3 * y->ties->nodes; k++) sum += a[k] * b[k];
    return sum;
}

/* Sets the initial guess (the rates of the lumped mass) and the residual; returns the norm to which
 * residuals are compared. */
static double begin(gn_consistent *y) {
    double *r = y->work[0], *p = y->work[2], *q = y->work[3], *inverse = y->work[4], scale = 0.0;
    for (size_t n = 0; n < y->ties->nodes; n++)
        for (size_t k = 3 * n; k < 3 * n + 3; k++) {
            inverse[k] = y->fixed[k] ? 0.0 : 1.0 / y->whole[n];
            if (!y->fixed[k]) y->rate[k] = y->load[k] * inverse[k];
            scale += y->load[k] * y->load[k] / y->whole[n];
        }
    multiply(y, y->rate, q);
    for (size_t k = 0; k < 3 * y->ties->nodes; k++) {
        r[k] = y->load[k] - q[k];
        p[k] = y->work[1][k] = r[k] * inverse[k];
    }
    return scale;
}

/* Fixed components have no inverse mass: their residual is ignored, and search directions vanish
 * there. */
int gn_consistent_solve(gn_consistent *y) {
    enum { ROUNDS = 60 };
    const size_t count = 3 * y->ties->nodes;
    const double scale = begin(y), *inverse = y->work[4];
    double *x = y->rate, *r = y->work[0], *z = y->work[1], *p = y->work[2], *q = y->work[3];
    double size = dot(y, r, z);
    int round = 0;
    for (; round < ROUNDS && size > 1e-26 * scale; round++) {
        multiply(y, p, q);
        const double step = size / dot(y, p, q), before = size;
        for (size_t k = 0; k < count; k++) {
            x[k] += step * p[k];
            r[k] -= step * q[k];
            z[k] = r[k] * inverse[k];
        }
        size = dot(y, r, z);
        for (size_t k = 0; k < count; k++) p[k] = z[k] + size / before * p[k];
    }
    return round;
}

void gn_consistent_difference(const gn_consistent *y, const double *rate, double *out) {
    spread(y, rate, out);
}
