#include "measure/stiffness.h"

#include <math.h>
#include <string.h>

enum { MOST = GN_VOIGT_MOST };

/* Gives the indices i, j of a row of Voigt matrices. */
static void voigt_pair(int dimension, int row, int *i, int *j) {
    static const int space[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    static const int plane[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    const int(*pair)[2] = dimension == 3 ? space : plane;
    *i = pair[row][0];
    *j = pair[row][1];
}

/* Multiplies the unit tensor of a row by a vector; shear components are `part`. */
static void times(int dimension, int row, double part, const double x[3], double y[3]) {
    int i, j;
    voigt_pair(dimension, row, &i, &j);
    y[0] = y[1] = y[2] = 0.0;
    y[i] = (i == j ? 1.0 : part) * x[j];
    if (i != j) y[j] = part * x[i];
}

void gn_voigt_stretch(int dimension, int row, const double l[3], double e[3]) {
    times(dimension, row, 0.5, l, e);
}

gn_bond_fabric gn_bond_fabric_of(int dimension, const gn_stiff_bond *bond, size_t count,
                                 double volume) {
    const int n = gn_voigt_size(dimension);
    gn_bond_fabric f = {.bonds = count};
    const double share = count ? 1.0 / (double)count : 0.0;
    for (size_t c = 0; c < count; c++) {
        const gn_stiff_bond *b = &bond[c];
        double square = 0.0, pair[MOST];
        for (int a = 0; a < 3; a++) square += b->l[a] * b->l[a];
        for (int a = 0; a < 9; a++) f.second[a] += share * b->n[a / 3] * b->n[a % 3];
        for (int a = 0, i, j; a < n; a++) {
            voigt_pair(dimension, a, &i, &j);
            pair[a] = b->n[i] * b->n[j];
        }
        for (int a = 0; a < n * n; a++) f.fourth[a] += share * pair[a / n] * pair[a % n];
        f.length += share * sqrt(square);
        f.square += share * square;
        f.kn += share * b->kn;
        f.kt += share * b->kt;
        f.modulus += b->kn * square / volume;
    }
    return f;
}

gn_elastic gn_stiffness_by_strain(int dimension, const gn_stiff_bond *bond, size_t count,
                                  double volume) {
    const int n = gn_voigt_size(dimension);
    gn_elastic found = {.dimension = dimension};
    for (size_t c = 0; c < count; c++) {
        const gn_stiff_bond *b = &bond[c];
        double e[MOST][3], along[MOST];
        for (int a = 0; a < n; a++) {
            gn_voigt_stretch(dimension, a, b->l, e[a]);
            along[a] = e[a][0] * b->n[0] + e[a][1] * b->n[1] + e[a][2] * b->n[2];
        }
        for (int a = 0; a < n; a++)
            for (int d = 0; d < n; d++) {
                double dot = e[a][0] * e[d][0] + e[a][1] * e[d][1] + e[a][2] * e[d][2];
                found.c[n * a + d] += (b->kt * dot + (b->kn - b->kt) * along[a] * along[d]);
            }
    }
    for (int a = 0; a < n * n; a++) found.c[a] /= volume;
    return found;
}

/* Inverts a symmetric positive definite matrix [n][n] by Gauss-Jordan; returns false if it is
 * singular to rounding. */
static bool invert(int n, double *a) {
    const double rounding = 1e-13;
    double scale = 0.0;
    for (int k = 0; k < n; k++) scale = fmax(scale, fabs(a[(n + 1) * k]));
    for (int k = 0; k < n; k++) {
        const double pivot = a[(n + 1) * k];
        if (!(pivot > rounding * scale)) return false;
        a[(n + 1) * k] = 1.0;
        for (int j = 0; j < n; j++) a[n * k + j] /= pivot;
        for (int i = 0; i < n; i++) {
            const double factor = a[n * i + k];
            if (i == k) continue;
            a[n * i + k] = 0.0;
            for (int j = 0; j < n; j++) a[n * i + j] -= factor * a[n * k + j];
        }
    }
    return true;
}

/* Computes b = A l for all bonds' tensor A = ((1/V) sum l l)^-1, as its matrix [d][d]. */
static bool branch_inverse(int dimension, const gn_stiff_bond *bond, size_t count, double volume,
                           double *inverse) {
    const int d = dimension;
    memset(inverse, 0, 9 * sizeof *inverse);
    for (size_t c = 0; c < count; c++)
        for (int a = 0; a < d * d; a++) inverse[a] += bond[c].l[a / d] * bond[c].l[a % d] / volume;
    return count > 0 && invert(d, inverse);
}

bool gn_stiffness_by_stress(int dimension, const gn_stiff_bond *bond, size_t count, double volume,
                            gn_elastic *found) {
    const int n = gn_voigt_size(dimension), d = dimension;
    double inverse[9], soft[MOST * MOST] = {0.0};
    *found = (gn_elastic){.dimension = dimension};
    if (!branch_inverse(dimension, bond, count, volume, inverse)) return false;
    for (size_t c = 0; c < count; c++) {
        const gn_stiff_bond *b = &bond[c];
        double arm[3] = {0.0}, f[MOST][3], along[MOST];
        if (!(b->kn > 0.0 && b->kt > 0.0)) return false;
        for (int a = 0; a < d * d; a++) arm[a / d] += inverse[a] * b->l[a % d];
        for (int a = 0; a < n; a++) {
            times(dimension, a, 1.0, arm, f[a]);
            along[a] = f[a][0] * b->n[0] + f[a][1] * b->n[1] + f[a][2] * b->n[2];
        }
        for (int a = 0; a < n * n; a++) {
            const double *p = f[a / n], *q = f[a % n];
            double dot = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            soft[a] +=
                (dot / b->kt + (1.0 / b->kn - 1.0 / b->kt) * along[a / n] * along[a % n]) / volume;
        }
    }
    if (!invert(n, soft)) return false;
    memcpy(found->c, soft, sizeof soft);
    return true;
}

/* Returns the factor of a pair of rows in sums over all four indices, because shear rows stand for
 * two index pairs. */
static double weight(int dimension, int row) {
    return row < dimension ? 1.0 : 2.0;
}

gn_isotropic gn_isotropic_of(const gn_elastic *tensor) {
    const int n = gn_voigt_size(tensor->dimension), d = tensor->dimension;
    double normal = 0.0, both = 0.0, norm = 0.0, apart = 0.0;
    for (int a = 0; a < n; a++) both += weight(d, a) * tensor->c[(n + 1) * a];
    for (int a = 0; a < d; a++)
        for (int b = 0; b < d; b++) normal += tensor->c[n * a + b];
    /* C_iijj = l d^2 + 2 m d and C_ijij = l d + m (d + d^2) with Lame's l and m. */
    const double m = (d * both - normal) / (d * (d * d + d - 2)),
                 l = (normal - 2.0 * m * d) / (d * d);
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            double iso = (a < d && b < d ? l : 0.0) + (a == b ? (a < d ? 2.0 : 1.0) * m : 0.0);
            double of = weight(d, a) * weight(d, b), value = tensor->c[n * a + b];
            norm += of * value * value;
            apart += of * (value - iso) * (value - iso);
        }
    return (gn_isotropic){m * (3.0 * l + 2.0 * m) / (l + m), l / (2.0 * (l + m)),
                          sqrt(apart / norm)};
}
