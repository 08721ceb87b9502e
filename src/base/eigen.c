#include "base/eigen.h"

#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* --- small and dense --- */

/* Zeroes a[p][q] by a plane rotation; v holds eigenvectors as rows. */
static void rotate(int n, double *a, double *v, int p, int q) {
    double theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
    double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
    double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    for (int k = 0; k < n; k++) {
        double x = a[k * n + p], y = a[k * n + q];
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        double x = a[p * n + k], y = a[q * n + k];
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        double x = v[p * n + k], y = v[q * n + k];
        v[p * n + k] = c * x - s * y;
        v[q * n + k] = s * x + c * y;
    }
    a[p * n + q] = a[q * n + p] = 0.0;
}

static double off_diagonal(int n, const double *a) {
    double sum = 0.0;
    for (int p = 0; p < n; p++)
        for (int q = p + 1; q < n; q++) sum += 2.0 * a[p * n + q] * a[p * n + q];
    return sum;
}

static void sort_descending(int n, double *values, double *vectors) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (values[i] > values[best]) best = i;
        if (best == k) continue;
        double value = values[k];
        values[k] = values[best];
        values[best] = value;
        for (int i = 0; i < n; i++) {
            double x = vectors[k * n + i];
            vectors[k * n + i] = vectors[best * n + i];
            vectors[best * n + i] = x;
        }
    }
}

void gn_eigen_symmetric(int n, double *a, double *values, double *vectors) {
    memset(vectors, 0, (size_t)n * (size_t)n * sizeof *vectors);
    double norm = off_diagonal(n, a);
    for (int k = 0; k < n; k++) {
        vectors[k * n + k] = 1.0;
        norm += a[k * n + k] * a[k * n + k];
    }
    double enough = DBL_EPSILON * DBL_EPSILON * norm;
    /* Convergence is quadratic: ten sweeps suffice for any matrix. The limit guards against NaN. */
    for (int sweep = 0; sweep < 50 && off_diagonal(n, a) > enough; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                if (a[p * n + q] != 0.0) rotate(n, a, vectors, p, q);
    for (int k = 0; k < n; k++) values[k] = a[k * n + k];
    sort_descending(n, values, vectors);
}

/* --- huge and implicit --- */

enum {
    BLOCK = 2048, /* number of elements in a partial sum; fixed, so that sums do not depend on the
                     threads */
    LANES = 8,
    BASIS_MIN = 12,
    BASIS_MAX = 40,
    CHECK_EVERY = 8,
    PRODUCTS_MAX = 4000,
};
/* target size of the basis of a large problem */
static const size_t basis_bytes = (size_t)512 << 20;

/* The blocks of a vector of n entries, each of which is summed separately. */
typedef struct vector_blocks {
    size_t n, count;
    size_t *start; /* [count + 1]; NULL: blocks of BLOCK entries */
} vector_blocks;

static size_t start_of(const vector_blocks *blocks, size_t b) {
    if (blocks->start) return blocks->start[b];
    return b * BLOCK < blocks->n ? b * BLOCK : blocks->n;
}
static size_t size_of(const vector_blocks *blocks, size_t b) {
    return start_of(blocks, b + 1) - start_of(blocks, b);
}

/* Finds the blocks of the longer vector that contain at least one entry of this one. */
static bool find_blocks(const gn_eigen_system *system, vector_blocks *blocks) {
    *blocks = (vector_blocks){.n = system->n, .count = (system->n + BLOCK - 1) / BLOCK};
    if (!system->place) return true;
    blocks->count = 0;
    blocks->start = gn_alloc_array(system->n / GN_EIGEN_GROUP + 2, sizeof *blocks->start);
    for (size_t k = 0; blocks->start && k < system->n; k += GN_EIGEN_GROUP)
        if (k == 0 || system->place[k] / BLOCK != system->place[k - 1] / BLOCK)
            blocks->start[blocks->count++] = k;
    if (blocks->start) blocks->start[blocks->count] = system->n;
    return blocks->start;
}

static double dot_block(size_t n, const double *x, const double *y) {
    double lane[LANES] = {0.0}, rest = 0.0;
    size_t k = 0;
    for (; k + LANES <= n; k += LANES)
        for (size_t l = 0; l < LANES; l++) lane[l] += x[k + l] * y[k + l];
    for (; k < n; k++) rest += x[k] * y[k];
    return ((lane[0] + lane[4]) + (lane[1] + lane[5])) +
           ((lane[2] + lane[6]) + (lane[3] + lane[7])) + rest;
}

static double dot_of_blocks(const vector_blocks *blocks, const double *x, const double *y,
                            int threads) {
    enum { GROUP = 64 }; /* number of partial sums stored at a time */
    double sum = 0.0, partial[GROUP];
    for (size_t first = 0; first < blocks->count; first += GROUP) {
        size_t count = blocks->count - first < GROUP ? blocks->count - first : GROUP;
#pragma omp parallel for num_threads(threads) schedule(static) if (count > 4)
        for (size_t b = 0; b < count; b++) {
            size_t at = start_of(blocks, first + b);
            partial[b] = dot_block(size_of(blocks, first + b), x + at, y + at);
        }
        for (size_t b = 0; b < count; b++) sum += partial[b];
    }
    return sum;
}

double gn_eigen_dot(size_t n, const double *x, const double *y, int threads) {
    const vector_blocks all = {.n = n, .count = (n + BLOCK - 1) / BLOCK};
    return dot_of_blocks(&all, x, y, threads);
}

typedef struct lanczos {
    const gn_eigen_system *system;
    size_t n;
    vector_blocks blocks;
    int size; /* capacity of the basis, without the next vector */
    int threads;
    double *weighed;                 /* [n] B w, if there is a metric */
    double *basis;                   /* [size + 1][n] */
    double *partial;                 /* [blocks][size + 1] */
    uint8_t *used;                   /* [blocks] nonzero if some vector has an entry in the block */
    double h[BASIS_MAX * BASIS_MAX]; /* [size][size] projection of S */
    double values[BASIS_MAX];        /* Ritz values */
    double vectors[BASIS_MAX * BASIS_MAX]; /* Ritz vectors in terms of the basis, as rows */
    double work[BASIS_MAX * BASIS_MAX];
} lanczos;

/* Records the blocks in use. Components of vectors are zero where nothing moves, as in most of a
 * body at rest; blocks of zeros need neither products nor orthogonalisation. */
static void note_used(const lanczos *state, const double *w) {
#pragma omp parallel for num_threads(state->threads) schedule(static) if (state->blocks.count > 4)
    for (size_t b = 0; b < state->blocks.count; b++) {
        const size_t end = start_of(&state->blocks, b + 1);
        for (size_t i = start_of(&state->blocks, b); !state->used[b] && i < end; i++)
            state->used[b] = !(w[i] == 0.0);
    }
}

static void weigh(const lanczos *state, const double *w) {
    if (state->weighed) state->system->metric(state->system->context, w, state->weighed);
}

/* Returns |w| and stores B w in `weighed`. */
static double length_of(const lanczos *state, const double *w) {
    weigh(state, w);
    return sqrt(
        dot_of_blocks(&state->blocks, w, state->weighed ? state->weighed : w, state->threads));
}

/* Computes c[k] = basis[k] . w for from <= k < count. */
static void project(const lanczos *state, int from, int count, const double *w, double *c) {
    const size_t blocks = state->blocks.count, width = (size_t)state->size + 1;
#pragma omp parallel for num_threads(state->threads) schedule(static) if (blocks > 4)
    for (size_t b = 0; b < blocks; b++)
        for (int k = from; k < count; k++)
            state->partial[b * width + (size_t)k] =
                state->used[b]
                    ? dot_block(size_of(&state->blocks, b),
                                state->basis + (size_t)k * state->n + start_of(&state->blocks, b),
                                w + start_of(&state->blocks, b))
                    : 0.0;
    for (int k = from; k < count; k++) {
        c[k] = 0.0;
        for (size_t b = 0; b < blocks; b++) c[k] += state->partial[b * width + (size_t)k];
    }
}

/* Computes w -= c[0] v[0] + c[1] v[1] + ..., in this order, for `count` vectors at a distance of
 * `stride`. Four vectors are subtracted at a time, which saves reading and writing w for each. */
static void subtract_block(size_t size, int count, const double *c, const double *v, size_t stride,
                           double *w) {
    int k = 0;
    for (; k + 4 <= count; k += 4, v += 4 * stride) {
        const double *v1 = v + stride, *v2 = v1 + stride, *v3 = v2 + stride;
        for (size_t i = 0; i < size; i++)
            w[i] =
                (((w[i] - c[k] * v[i]) - c[k + 1] * v1[i]) - c[k + 2] * v2[i]) - c[k + 3] * v3[i];
    }
    for (; k < count; k++, v += stride)
        for (size_t i = 0; i < size; i++) w[i] -= c[k] * v[i];
}

/* Computes w -= sum_k c[k] basis[k] over from <= k < count. */
static void subtract(const lanczos *state, int from, int count, const double *c, double *w) {
    const size_t blocks = state->blocks.count;
#pragma omp parallel for num_threads(state->threads) schedule(static) if (blocks > 4)
    for (size_t b = 0; b < blocks; b++)
        if (state->used[b])
            subtract_block(size_of(&state->blocks, b), count - from, c + from,
                           state->basis + (size_t)from * state->n + start_of(&state->blocks, b),
                           state->n, w + start_of(&state->blocks, b));
}

static void scale_vector(size_t n, double factor, double *w, int threads) {
#pragma omp parallel for num_threads(threads) schedule(static) if (n > 4 * BLOCK)
    for (size_t i = 0; i < n; i++) w[i] *= factor;
}

/* Orthogonalises w against the basis, stores the coefficients as column `count - 1` of h and
 * returns |w|. The first round is the three-term recurrence. Full rounds follow until one of them
 * changes w only little, so that the loss of orthogonality does not accumulate (Daniel, Gragg,
 * Kaufman & Stewart 1976). */
static double orthogonalise(lanczos *state, int count, double *w) {
    double c[BASIS_MAX], sum[BASIS_MAX] = {0.0}, before, after = 0.0;
    const double *weighed = state->weighed ? state->weighed : w;
    weigh(state, w);
    for (int round = 0; round < 5; round++) {
        int from = round == 0 && count > 2 ? count - 2 : 0;
        before = after;
        project(state, from, count, weighed, c);
        subtract(state, from, count, c, w);
        for (int k = from; k < count; k++) sum[k] += c[k];
        after = length_of(state, w);
        if (round > 0 && after > 0.7 * before) break;
    }
    for (int k = 0; k < count; k++)
        state->h[k * state->size + count - 1] = state->h[(count - 1) * state->size + k] = sum[k];
    return after;
}

static void ritz(lanczos *state, int count) {
    for (int p = 0; p < count; p++)
        for (int q = 0; q < count; q++) state->work[p * count + q] = state->h[p * state->size + q];
    gn_eigen_symmetric(count, state->work, state->values, state->vectors);
}

/* Computes basis[k] = sum_q vectors[k][q] basis[q] for k < keep, q < count. */
static void combine(const lanczos *state, int keep, int count) {
    enum { CHUNK = 32 }; /* thread stacks may be small */
#pragma omp parallel for num_threads(state->threads) schedule(static) if (state->n > 4 * BLOCK)
    for (size_t start = 0; start < state->n; start += CHUNK) {
        double out[BASIS_MAX][CHUNK];
        size_t size = state->n - start < CHUNK ? state->n - start : CHUNK;
        for (int k = 0; k < keep; k++) {
            for (size_t i = 0; i < size; i++) out[k][i] = 0.0;
            for (int q = 0; q < count; q++) {
                const double *v = state->basis + (size_t)q * state->n + start,
                             y = state->vectors[k * count + q];
                for (size_t i = 0; i < size; i++) out[k][i] += y * v[i];
            }
        }
        for (int k = 0; k < keep; k++)
            memcpy(state->basis + (size_t)k * state->n + start, out[k], size * sizeof(double));
    }
}

/* Restarts the search from the upper Ritz vectors and the direction of the residual. */
static int restart(lanczos *state, int count) {
    int keep = 2 * count / 5;
    combine(state, keep, count);
    memmove(state->basis + (size_t)keep * state->n, state->basis + (size_t)count * state->n,
            state->n * sizeof(double));
    memset(state->h, 0, sizeof state->h);
    for (int k = 0; k < keep; k++) state->h[k * state->size + k] = state->values[k];
    return keep;
}

/* Performs the search; returns the number of basis vectors of which the last Ritz pairs consist. */
static int iterate(lanczos *state, double tolerance, gn_eigen_top *top) {
    for (int count = 0;;) {
        double *next = state->basis + (size_t)(count + 1) * state->n;
        state->system->apply(state->system->context, next - state->n, next);
        note_used(state, next);
        top->vectors++;
        double beta = orthogonalise(state, ++count, next);
        bool full = count == state->size;
        bool done = !(beta > DBL_EPSILON * state->h[0]) || top->vectors >= PRODUCTS_MAX;
        if (!done && !full && top->vectors % CHECK_EVERY) {
            scale_vector(state->n, 1.0 / beta, next, state->threads);
            continue;
        }
        ritz(state, count);
        top->value = state->values[0];
        top->residual = beta * fabs(state->vectors[count - 1]);
        if (done || top->residual <= tolerance * top->value) return count;
        scale_vector(state->n, 1.0 / beta, next, state->threads);
        if (full) count = restart(state, count);
    }
}

static gneiss_status allocate(lanczos *state, gneiss_error *error) {
    const bool weighs = state->system->metric, placed = find_blocks(state->system, &state->blocks);
    state->basis = gn_alloc_array_raw((size_t)state->size + 1, state->n * sizeof(double));
    state->partial =
        gn_alloc_array(state->blocks.count, ((size_t)state->size + 1) * sizeof(double));
    state->used = gn_alloc(state->blocks.count);
    if (weighs) state->weighed = gn_alloc_array(state->n, sizeof(double));
    if (placed && state->basis && state->partial && state->used && (state->weighed || !weighs))
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %d Lanczos vectors of length %zu",
                   state->size + 1, state->n);
}

static gneiss_status search(lanczos *state, double tolerance, double *vector, gn_eigen_top *top,
                            gneiss_error *error) {
    GN_TRY(allocate(state, error));
    memcpy(state->basis, vector, state->n * sizeof(double));
    note_used(state, state->basis);
    double length = length_of(state, state->basis);
    if (!(length > 0.0 && length < INFINITY))
        return gn_fail(error, GNEISS_ERROR_INTERNAL,
                       "Lanczos needs a start vector of positive length, found %g", length);
    scale_vector(state->n, 1.0 / length, state->basis, state->threads);
    /* A smaller residual would be round-off. */
    int count = iterate(state, fmax(tolerance, 1e-13), top);
    combine(state, 1, count);
    memcpy(vector, state->basis, state->n * sizeof(double));
    return GNEISS_OK;
}

gneiss_status gn_eigen_largest(const gn_eigen_system *system, double tolerance, double *vector,
                               gn_eigen_top *top, gneiss_error *error) {
    const size_t n = system->n;
    *top = (gn_eigen_top){0};
    size_t size = basis_bytes / (n * sizeof(double));
    size = size < BASIS_MIN ? BASIS_MIN : size > BASIS_MAX ? BASIS_MAX : size;
    lanczos *l = gn_alloc(sizeof *l); /* too large for a small stack */
    if (!l) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for Lanczos vectors");
    l->system = system;
    l->n = n;
    l->size = (int)(size < n ? size : n);
    l->threads = system->threads;
    gneiss_status status = search(l, tolerance, vector, top, error);
    gn_free(l->blocks.start);
    gn_free(l->basis);
    gn_free(l->partial);
    gn_free(l->used);
    gn_free(l->weighed);
    gn_free(l);
    return status;
}

double gn_eigen_dot_of(const gn_eigen_system *system, const double *x, const double *y) {
    const size_t n = system->n, *place = system->place;
    double sum = 0.0;
    if (!place) return gn_eigen_dot(n, x, y, system->threads);
    for (size_t from = 0, to = 0; from < n; from = to) {
        while (to < n && place[to] / BLOCK == place[from] / BLOCK) to++;
        sum += dot_block(to - from, x + from, y + from);
    }
    return sum;
}
