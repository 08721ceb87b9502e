#include "couple/consistent.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

gneiss_status gn_consistent_create(const gn_ties *t, int dimension, gn_consistent *y,
                                   gneiss_error *error) {
    const size_t n = t->nodes + 1;
    *y = (gn_consistent){.ties = t, .dimension = dimension, .threads = 1};
    y->mass = gn_alloc_array(t->count + 1, sizeof *y->mass);
    y->moved = gn_alloc_array(t->count + 1, 3 * sizeof *y->moved);
    y->own = gn_alloc_array(n, sizeof *y->own);
    y->whole = gn_alloc_array(n, sizeof *y->whole);
    y->load = gn_alloc_array(n, 3 * sizeof *y->load);
    y->rate = gn_alloc_array(n, 3 * sizeof *y->rate);
    y->fixed = gn_alloc_array(n, 3 * sizeof *y->fixed);
    bool held = y->mass && y->moved && y->own && y->whole && y->load && y->rate && y->fixed;
    for (int k = 0; k < 4; k++)
        held = (y->work[k] = gn_alloc_array(n, 3 * sizeof *y->work[k])) && held;
    if (held) return GNEISS_OK;
    gn_consistent_free(y);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes of zones", t->nodes);
}

void gn_consistent_free(gn_consistent *y) {
    void *blocks[] = {y->mass,  y->moved,   y->own,     y->whole,   y->load,   y->rate,
                      y->fixed, y->work[0], y->work[1], y->work[2], y->work[3]};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *y = (gn_consistent){0};
}

/* So few particles are no work to share out. */
enum { FEW = 1000 };

/* out = N^T M N x. */
static void carry(gn_consistent *y, const double *x, double *out) {
    const gn_ties *t = y->ties;
#pragma omp parallel num_threads(y->threads) if (t->count > FEW)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < t->count; k++)
            for (size_t c = 0; c < 3; c++) {
                double sum = 0.0;
                for (int a = 0; a < t->corners; a++)
                    sum += t->tie[k].shape[a] * x[3 * (size_t)t->tie[k].own[a] + c];
                y->moved[3 * k + c] = y->mass[k] * sum;
            }
#pragma omp for schedule(static)
        for (size_t n = 0; n < t->nodes; n++)
            for (size_t c = 0; c < 3; c++) {
                double sum = 0.0;
                for (int32_t s = t->first[n]; s < t->first[n + 1]; s++)
                    sum += t->tie[t->share[s].tie].shape[t->share[s].corner] *
                           y->moved[3 * (size_t)t->share[s].tie + c];
                out[3 * n + c] = sum;
            }
    }
}

static void multiply(gn_consistent *y, const double *x, double *out) {
    carry(y, x, out);
    for (size_t k = 0; k < 3 * y->ties->nodes; k++) out[k] += y->own[k / 3] * x[k];
}

static double dot(const gn_consistent *y, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t k = 0; k < 3 * y->ties->nodes; k++) sum += a[k] * b[k];
    return sum;
}

int gn_consistent_solve(gn_consistent *y) {
    enum { ROUNDS = 60 };
    const size_t count = 3 * y->ties->nodes;
    double *x = y->rate, *r = y->work[0], *z = y->work[1], *p = y->work[2], *q = y->work[3];
    double scale = 0.0;
    for (size_t k = 0; k < count; k++) {
        if (!y->fixed[k]) x[k] = y->load[k] / y->whole[k / 3];
        scale += y->load[k] * y->load[k] / y->whole[k / 3];
    }
    multiply(y, x, q);
    for (size_t k = 0; k < count; k++) {
        r[k] = y->fixed[k] ? 0.0 : y->load[k] - q[k];
        p[k] = z[k] = r[k] / y->whole[k / 3];
    }
    double size = dot(y, r, z);
    int round = 0;
    for (; round < ROUNDS && size > 1e-26 * scale; round++) {
        multiply(y, p, q);
        double step = size / dot(y, p, q), before = size;
        for (size_t k = 0; k < count; k++) {
            x[k] += step * p[k];
            r[k] -= y->fixed[k] ? 0.0 : step * q[k];
            z[k] = y->fixed[k] ? 0.0 : r[k] / y->whole[k / 3];
        }
        size = dot(y, r, z);
        for (size_t k = 0; k < count; k++) p[k] = z[k] + size / before * p[k];
    }
    return round;
}

void gn_consistent_difference(gn_consistent *y, const double *rate, double *out) {
    carry(y, rate, out);
    for (size_t k = 0; k < 3 * y->ties->nodes; k++)
        out[k] = (y->whole[k / 3] - y->own[k / 3]) * rate[k] - out[k];
}
