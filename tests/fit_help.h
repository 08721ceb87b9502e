/* A dense oracle of the fit of touching spheres: all pairs, all planes, everything in double. */
#ifndef GN_TESTS_FIT_HELP_H
#define GN_TESTS_FIT_HELP_H

#include "domain_help.h"
#include "pack/fit_private.h"

enum { FIT_MOST = 48 };

/* A fit of few particles and the data that it borrows. */
typedef struct sample {
    gn_domain *domain;
    gn_fit *fit;
    gn_fit_law law;
    size_t count;
    double wanted[FIT_MOST], least[FIT_MOST], most[FIT_MOST];
    bool held[FIT_MOST][FIT_MOST];
} sample;

/* The residuals that count at a state, and their weights. */
typedef struct weights {
    double pair[FIT_MOST][FIT_MOST];
    double plane[FIT_MOST][GN_DOMAIN_PLANES];
    double spring[FIT_MOST];
} weights;

static inline double distance(const double *a, const double *b) {
    return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* r^(d-2) */
static inline double weight_of_size(const sample *s, double length) {
    return s->fit->dimension == 3 ? length : 1;
}

/* Residual of a pair and its gap relative to r_i + r_j. */
static inline double pair_gap(const sample *s, const double *a, const double *b, double *relative) {
    double reach = a[3] + b[3], gap = distance(a, b) - (1 - s->law.overlap) * reach;
    *relative = gap / reach;
    return gap;
}

static inline int planes_near(const sample *s, const double *x, gn_domain_plane *plane) {
    return gn_domain_planes(s->domain, x, x[3] * (1 + fmin(2 * s->law.gap, 0.3)), plane);
}

static inline weights weights_at(const sample *s, const double (*row)[4]) {
    weights w = {0};
    for (size_t i = 0; i < s->count; i++) {
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int planes = planes_near(s, row[i], plane);
        for (int k = 0; k < planes; k++)
            w.plane[i][k] = 4 * weight_of_size(s, 2 * row[i][3]) *
                            (plane[k].depth < row[i][3] ? 1 : s->law.pull);
        if (!s->law.fixed_radii)
            w.spring[i] = s->law.stiffness * 4 * weight_of_size(s, 2 * s->wanted[i]);
        for (size_t j = 0; j < i; j++) {
            double relative, gap = pair_gap(s, row[i], row[j], &relative);
            double size = weight_of_size(s, row[i][3] + row[j][3]);
            bool pulled = s->held[i][j] || relative < s->law.gap;
            w.pair[i][j] = gap < 0 ? size : pulled ? s->law.pull * size : 0;
        }
    }
    return w;
}

/* The sum of squares with the weights given. */
static inline double energy_of(const sample *s, const weights *w, const double (*row)[4]) {
    double sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int planes = planes_near(s, row[i], plane);
        for (int k = 0; k < planes; k++)
            sum += 0.5 * w->plane[i][k] * pow(plane[k].depth - row[i][3], 2);
        sum += 0.5 * w->spring[i] * pow(row[i][3] - s->wanted[i], 2);
        for (size_t j = 0; j < i; j++) {
            double relative, gap = pair_gap(s, row[i], row[j], &relative), most = s->law.most;
            double reach = row[i][3] + row[j][3];
            double excess = most > 0 ? fmin(distance(row[i], row[j]) - (1 - most) * reach, 0) : 0;
            sum += 0.5 * w->pair[i][j] * (gap * gap + 20 * excess * excess);
        }
    }
    return sum;
}

/* Returns the energy as the fit sums it, before it is made relative. */
static inline double energy_of_fit(const gn_fit *f) {
    double sum = 0;
    for (size_t b = 0; b < f->blocks; b++) sum += f->partial[GN_FIT_SUMS * b];
    return sum;
}

/* Adds weight u u^T of a residual with the derivatives `u` by its `unknowns`. */
static inline void add_square(double *matrix, size_t n, double weight, const double *u,
                              const size_t *unknown, int unknowns) {
    for (int a = 0; a < unknowns; a++)
        for (int b = 0; b < unknowns; b++)
            matrix[n * unknown[a] + unknown[b]] += weight * u[a] * u[b];
}

/* J^T J [4 count][4 count]. */
static inline void normal_matrix(const sample *s, const weights *w, const double (*row)[4],
                                 double *matrix) {
    size_t n = 4 * s->count;
    memset(matrix, 0, n * n * sizeof *matrix);
    for (size_t i = 0; i < s->count; i++) {
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int planes = planes_near(s, row[i], plane);
        size_t unknown[8];
        for (size_t a = 0; a < 4; a++) unknown[a] = 4 * i + a;
        for (int k = 0; k < planes; k++) {
            double u[4] = {plane[k].normal[0], plane[k].normal[1], plane[k].normal[2], -1};
            add_square(matrix, n, w->plane[i][k], u, unknown, 4);
        }
        matrix[n * (4 * i + 3) + 4 * i + 3] += w->spring[i];
        for (size_t j = 0; j < i; j++) {
            double u[8], length = distance(row[i], row[j]);
            for (size_t a = 0; a < 4; a++) unknown[4 + a] = 4 * j + a;
            for (size_t a = 0; a < 3; a++) u[a] = (row[i][a] - row[j][a]) / length;
            for (size_t a = 0; a < 3; a++) u[4 + a] = -u[a];
            u[3] = u[7] = -(1 - s->law.overlap);
            add_square(matrix, n, w->pair[i][j], u, unknown, 8);
        }
    }
}

/* Solves matrix x = b in place by elimination with pivots; b becomes x. */
static inline void solve_dense(double *matrix, double *b, size_t n) {
    for (size_t c = 0; c < n; c++) {
        size_t best = c;
        for (size_t i = c + 1; i < n; i++)
            if (fabs(matrix[n * i + c]) > fabs(matrix[n * best + c])) best = i;
        for (size_t k = 0; k < n && best != c; k++) {
            double spare = matrix[n * c + k];
            matrix[n * c + k] = matrix[n * best + k];
            matrix[n * best + k] = spare;
        }
        double spare = b[c];
        b[c] = b[best], b[best] = spare;
        for (size_t i = c + 1; i < n; i++) {
            double factor = matrix[n * i + c] / matrix[n * c + c];
            for (size_t k = c; k < n; k++) matrix[n * i + k] -= factor * matrix[n * c + k];
            b[i] -= factor * b[c];
        }
    }
    for (size_t c = n; c-- > 0;) {
        for (size_t k = c + 1; k < n; k++) b[c] -= matrix[n * c + k] * b[k];
        b[c] /= matrix[n * c + c];
    }
}

#endif
