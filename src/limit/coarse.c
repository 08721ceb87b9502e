#include "limit/coarse.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

enum { N = 6, GROUP_LEAST = 96, GROUPS_MOST = 64 };

/* Pivots below this fraction of their diagonal are excluded from the coarse level: such a motion
 * has almost no stiffness (a disc that rolls between plates), and the residual load of an iteration
 * would displace it far. */
static const double no_pivot = 1e-4;

static size_t group_of(const gn_coarse *coarse, size_t p) {
    size_t g = p * coarse->groups / coarse->particles;
    while (p < gn_coarse_first(coarse, g)) g--;
    while (p >= gn_coarse_first(coarse, g + 1)) g++;
    return g;
}

static void take_arms(gn_coarse *coarse, size_t g, const double *pos) {
    size_t first = gn_coarse_first(coarse, g), end = gn_coarse_first(coarse, g + 1);
    for (size_t a = 0; a < 3; a++) {
        double sum = 0.0;
        for (size_t p = first; p < end; p++) sum += pos[4 * p + a];
        for (size_t p = first; p < end; p++)
            coarse->arm[3 * p + a] = pos[4 * p + a] - sum / (double)(end - first);
    }
}

gneiss_status gn_coarse_create(gn_coarse *coarse, size_t particles, const double *pos,
                               gneiss_error *error) {
    size_t groups = particles / GROUP_LEAST, most = GROUPS_MOST;
    groups = groups < most ? groups : most;
    *coarse = (gn_coarse){.particles = particles, .groups = groups, .n = N * groups};
    if (!groups) return GNEISS_OK;
    coarse->arm = gn_alloc_array(particles, 3 * sizeof *coarse->arm);
    coarse->factor = gn_alloc_array(coarse->n * coarse->n, sizeof *coarse->factor);
    coarse->x = gn_alloc_array(coarse->n, sizeof *coarse->x);
    if (!coarse->arm || !coarse->factor || !coarse->x)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu groups of particles", groups);
    for (size_t g = 0; g < groups; g++) take_arms(coarse, g, pos);
    return GNEISS_OK;
}

void gn_coarse_free(gn_coarse *coarse) {
    gn_free(coarse->arm);
    gn_free(coarse->factor);
    gn_free(coarse->x);
    *coarse = (gn_coarse){0};
}

/* Computes the displacement e of a spring for each of the six rigid motions of p's group: along
 * each axis, then about each axis. */
static void motions(const gn_coarse *coarse, size_t p, const double by[6][3], double e[6][3]) {
    const double *d = coarse->arm + 3 * p;
    for (int k = 0; k < 3; k++) {
        e[0][k] = by[0][k];
        e[1][k] = by[1][k];
        e[2][k] = by[2][k];
        e[3][k] = by[3][k] + d[1] * by[2][k] - d[2] * by[1][k];
        e[4][k] = by[4][k] + d[2] * by[0][k] - d[0] * by[2][k];
        e[5][k] = by[5][k] + d[0] * by[1][k] - d[1] * by[0][k];
    }
}

/* Computes the forces with which a spring resists displacements e of these motions. */
static void pulls(const gn_coarse_spring *spring, const double e[6][3], double q[6][3]) {
    for (int m = 0; m < N; m++) {
        double along = (spring->kn - spring->kt) * gn_dot3(e[m], spring->n);
        for (int k = 0; k < 3; k++) q[m][k] = spring->kt * e[m][k] + along * spring->n[k];
    }
}

static void add_block(gn_coarse *coarse, size_t g, size_t h, const double e[6][3],
                      const double q[6][3]) {
    for (size_t a = 0; a < N; a++) {
        double *row = coarse->factor + (N * g + a) * coarse->n + N * h;
        for (size_t b = 0; b < N; b++) row[b] += gn_dot3(e[a], q[b]);
    }
}

void gn_coarse_add(gn_coarse *coarse, const gn_coarse_spring *spring) {
    size_t g = group_of(coarse, (size_t)spring->p),
           h = spring->q < 0 ? g : group_of(coarse, (size_t)spring->q);
    double e[6][3], q[6][3], other[6][3], other_q[6][3];
    motions(coarse, (size_t)spring->p, spring->by_p, e);
    if (spring->q >= 0) motions(coarse, (size_t)spring->q, spring->by_q, other);
    for (int m = 0; m < N && spring->q >= 0 && g == h; m++)
        for (int k = 0; k < 3; k++) e[m][k] += other[m][k];
    pulls(spring, e, q);
    add_block(coarse, g, g, e, q);
    if (g == h) return;
    pulls(spring, other, other_q);
    add_block(coarse, h, h, other, other_q);
    if (g > h)
        add_block(coarse, g, h, e, other_q);
    else
        add_block(coarse, h, g, other, q);
}

void gn_coarse_ground(gn_coarse *coarse, size_t p, const double ground[6]) {
    size_t g = group_of(coarse, p);
    for (int axis = 0; axis < N; axis++) {
        double by[6][3] = {{0}}, e[6][3], q[6][3];
        by[axis][0] = 1.0;
        motions(coarse, p, by, e);
        for (int m = 0; m < N; m++)
            for (int k = 0; k < 3; k++) q[m][k] = ground[axis] * e[m][k];
        add_block(coarse, g, g, e, q);
    }
}

/* Forms four sums at a time, because a single sum would wait for each of its additions. */
static double dot(const double *x, const double *y, size_t n) {
    double sum[4] = {0.0};
    size_t k = 0;
    for (; k + 4 <= n; k += 4)
        for (size_t m = 0; m < 4; m++) sum[m] += x[k + m] * y[k + m];
    for (; k < n; k++) sum[0] += x[k] * y[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Factors row by row, so that the inner loops run along memory. */
void gn_coarse_factor(gn_coarse *coarse) {
    const size_t n = coarse->n;
    for (size_t k = 0; k < n; k++) {
        double *row = coarse->factor + k * n, diagonal = row[k];
        for (size_t a = 0; a < k; a++) {
            const double *above = coarse->factor + a * n;
            row[a] = above[a] > 0.0 ? (row[a] - dot(row, above, a)) / above[a] : 0.0;
        }
        double pivot = diagonal - dot(row, row, k);
        row[k] = pivot > no_pivot * diagonal ? sqrt(pivot) : 0.0;
    }
}

void gn_coarse_gather(const gn_coarse *coarse, size_t g, const double *r, const uint8_t *free) {
    double sum[N] = {0.0};
    for (size_t p = gn_coarse_first(coarse, g); p < gn_coarse_first(coarse, g + 1); p++) {
        double f[N], turn[3];
        for (size_t a = 0; a < N; a++) f[a] = free[p] >> a & 1 ? r[N * p + a] : 0.0;
        gn_cross3(coarse->arm + 3 * p, f, turn);
        for (size_t a = 0; a < 3; a++) {
            sum[a] += f[a];
            sum[3 + a] += f[3 + a] + turn[a];
        }
    }
    memcpy(coarse->x + N * g, sum, sizeof sum);
}

void gn_coarse_solve(const gn_coarse *coarse) {
    const size_t n = coarse->n;
    for (size_t k = 0; k < n; k++) {
        const double *row = coarse->factor + k * n;
        coarse->x[k] = row[k] > 0.0 ? (coarse->x[k] - dot(row, coarse->x, k)) / row[k] : 0.0;
    }
    for (size_t k = n; k-- > 0;) {
        const double *row = coarse->factor + k * n;
        double x = row[k] > 0.0 ? coarse->x[k] / row[k] : 0.0;
        for (size_t b = 0; b < k; b++) coarse->x[b] -= row[b] * x;
        coarse->x[k] = x;
    }
}

void gn_coarse_spread(const gn_coarse *coarse, size_t p, unsigned free, double *z) {
    const double *x = coarse->x + N * group_of(coarse, p), *w = x + 3;
    double turn[3];
    gn_cross3(w, coarse->arm + 3 * p, turn);
    for (int a = 0; a < 3; a++) {
        if (free >> a & 1) z[a] += x[a] + turn[a];
        if (free >> (3 + a) & 1) z[3 + a] += w[a];
    }
}
