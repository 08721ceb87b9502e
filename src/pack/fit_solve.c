/* The linear system of one iteration: matrix-free normal equations, block Jacobi preconditioner,
 * conjugate gradients in one parallel region. Every particle forms its own rows from its own terms,
 * so that there is no scatter. */
#include "pack/fit_private.h"

#include <math.h>
#include <omp.h>
#include <string.h>

static const gn_d4 mirror = {-1.0, -1.0, -1.0, 1.0};

static inline gn_d4 widen(gn_f4 a) {
    return __builtin_convertvector(a, gn_d4);
}

/* Inverts a symmetric positive definite 4 x 4 matrix by Gauss-Jordan; the result is symmetric also
 * in single precision, as conjugate gradients need it. */
static void invert(double a[16], float out[16]) {
    for (int c = 0; c < 4; c++) {
        double pivot = 1.0 / a[5 * c];
        a[5 * c] = 1.0;
        for (int k = 0; k < 4; k++) a[4 * c + k] *= pivot;
        for (int i = 0; i < 4; i++) {
            if (i == c) continue;
            double factor = a[4 * i + c];
            a[4 * i + c] = 0.0;
            for (int k = 0; k < 4; k++) a[4 * i + k] -= factor * a[4 * c + k];
        }
    }
    for (int i = 0; i < 4; i++)
        for (int k = 0; k <= i; k++) out[4 * i + k] = out[4 * k + i] = (float)a[4 * i + k];
}

/* Computes the diagonal block of particle i, damped in proportion to its trace (Marquardt's
 * scaling, per particle). */
static void precondition(gn_fit *fit, const gn_fit_law *law, size_t i) {
    double block[16] = {0};
    for (int32_t k = 0; k < fit->terms[i]; k++) {
        gn_fit_term t = fit->term[fit->first_term[i] + (size_t)k];
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) block[4 * a + b] += (double)t[a] * (double)t[b];
    }
    double spring = fit->local[2 * i + 1];
    double trace = (block[0] + block[5] + block[10] + block[15] + spring) / 4.0;
    double damp = fit->damping * trace;
    fit->local[2 * i] = damp;
    fit->local[2 * i + 1] = spring + damp;
    for (int a = 0; a < 3; a++) block[5 * a] += damp;
    block[15] += spring + damp;
    if (law->fixed_radii) {
        for (int a = 0; a < 4; a++) block[12 + a] = block[4 * a + 3] = 0.0;
        block[15] = 1.0;
    }
    float *inverse = fit->inverse + 16 * i;
    invert(block, inverse);
    if (law->fixed_radii) inverse[15] = 0.0f;
}

static inline gn_d4 apply_inverse(const gn_fit *fit, size_t i, gn_d4 r) {
    const gn_f4 *row = (const gn_f4 *)(fit->inverse + 16 * i);
    return (r[0] * widen(row[0]) + r[1] * widen(row[1])) +
           (r[2] * widen(row[2]) + r[3] * widen(row[3]));
}

/* Returns p . (A p) over one block; A p is stored in ap. */
static double multiply(gn_fit *fit, size_t block, const gn_d4 free_part) {
    double sum = 0.0;
    for (size_t i = block * GN_FIT_BLOCK; i < gn_fit_block_end(fit, block); i++) {
        gn_d4 p = fit->p[i];
        double centre = fit->local[2 * i], radius = fit->local[2 * i + 1];
        gn_d4 y = (gn_d4){centre, centre, centre, radius} * p;
        const gn_fit_term *term = fit->term + fit->first_term[i];
        const int32_t *partner = fit->partner + fit->first_term[i];
        for (int32_t k = 0; k < fit->terms[i]; k++) {
            gn_d4 t = widen(term[k]);
            y += gn_d4_sum(t * (p + mirror * fit->p[partner[k]])) * t;
        }
        y *= free_part;
        fit->ap[i] = y;
        sum += gn_d4_sum(p * y);
    }
    return sum;
}

static double start_block(gn_fit *fit, const gn_fit_law *law, size_t block, const gn_d4 free_part) {
    double sum = 0.0;
    for (size_t i = block * GN_FIT_BLOCK; i < gn_fit_block_end(fit, block); i++) {
        precondition(fit, law, i);
        fit->step[i] = (gn_d4){0};
        fit->r[i] = -fit->gradient[i] * free_part;
        fit->p[i] = apply_inverse(fit, i, fit->r[i]);
        sum += gn_d4_sum(fit->r[i] * fit->p[i]);
    }
    return sum;
}

static double descend_block(gn_fit *fit, size_t block, double alpha) {
    double sum = 0.0;
    for (size_t i = block * GN_FIT_BLOCK; i < gn_fit_block_end(fit, block); i++) {
        fit->step[i] += alpha * fit->p[i];
        fit->r[i] -= alpha * fit->ap[i];
        fit->z[i] = apply_inverse(fit, i, fit->r[i]);
        sum += gn_d4_sum(fit->r[i] * fit->z[i]);
    }
    return sum;
}

static double total(const gn_fit *fit, int slot) {
    double sum = 0.0;
    for (size_t b = 0; b < fit->blocks; b++) sum += fit->partial[GN_FIT_SUMS * b + (size_t)slot];
    return sum;
}

/* Every thread forms the same sums, so that all take the same path through the loop. Sums of one
 * kind keep their slot until the next barrier but one. */
int gn_fit_solve(gn_fit *fit, const gn_fit_law *law, int products, double tolerance) {
    const gn_d4 free_part = law->fixed_radii ? (gn_d4){1, 1, 1, 0} : (gn_d4){1, 1, 1, 1};
    int done = 0;
#pragma omp parallel num_threads(fit->threads)
    {
#pragma omp for schedule(static)
        for (size_t b = 0; b < fit->blocks; b++)
            fit->partial[GN_FIT_SUMS * b] = start_block(fit, law, b, free_part);
        double rz = total(fit, 0), goal = tolerance * tolerance * rz;
        int k = 0;
        for (; k < products && rz > goal; k++) {
#pragma omp for schedule(static)
            for (size_t b = 0; b < fit->blocks; b++)
                fit->partial[GN_FIT_SUMS * b + 1] = multiply(fit, b, free_part);
            double curvature = total(fit, 1);
            if (!(curvature > 0.0)) break;
            double alpha = rz / curvature;
#pragma omp for schedule(static)
            for (size_t b = 0; b < fit->blocks; b++)
                fit->partial[GN_FIT_SUMS * b + 2] = descend_block(fit, b, alpha);
            double next = total(fit, 2), beta = next / rz;
            rz = next;
#pragma omp for schedule(static)
            for (size_t b = 0; b < fit->blocks; b++)
                for (size_t i = b * GN_FIT_BLOCK; i < gn_fit_block_end(fit, b); i++)
                    fit->p[i] = fit->z[i] + beta * fit->p[i];
        }
#pragma omp single
        done = k;
    }
    return done;
}
