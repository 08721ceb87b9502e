/* Preconditioned conjugate gradients (Hestenes & Stiefel 1952). */
#include "couple/held_springs.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

enum { N = GN_HELD_DOFS };

/* Regularisation relative to the diagonal. A particle on one bond can roll about it; displacements
 * along such a mechanism must stay small relative to those of the springs. Repeated solutions
 * remove the residual error. */
static const double everywhere = 1e-3;

/* Adds the contribution of one end's displacement to e. */
static void add_end(const gn_held_spring *spring, double side, double arm, const double *u,
                    double e[3]) {
    double turned[3];
    gn_cross3(u + 3, spring->n, turned);
    for (int a = 0; a < 3; a++) e[a] += side * u[a] - arm * turned[a];
}

static void pull(const gn_held_spring *spring, double side, double arm, const double q[3],
                 double *f) {
    double moment[3];
    gn_cross3(spring->n, q, moment);
    for (int a = 0; a < 3; a++) {
        f[a] -= side * q[a];
        f[3 + a] += arm * moment[a];
    }
}

/* Computes out = K u, where K includes the regularisation; returns u . K u. `diagonal` is from
 * find_diagonal. */
static double apply(const gn_held_system *system, const double *diagonal, const double *u,
                    double *out) {
    double sum = 0.0;
    memset(out, 0, N * system->particles * sizeof *out);
    for (size_t k = 0; k < system->springs; k++) {
        const gn_held_spring *s = &system->spring[k];
        double e[3] = {0.0}, q[3];
        if (s->i >= 0) add_end(s, -1.0, s->arm_i, u + N * (size_t)s->i, e);
        if (s->j >= 0) add_end(s, 1.0, s->arm_j, u + N * (size_t)s->j, e);
        const double along = (s->kn - s->kt) * gn_dot3(e, s->n);
        for (int a = 0; a < 3; a++) q[a] = -(s->kt * e[a] + along * s->n[a]);
        if (s->i >= 0) pull(s, -1.0, s->arm_i, q, out + N * (size_t)s->i);
        if (s->j >= 0) pull(s, 1.0, s->arm_j, q, out + N * (size_t)s->j);
    }
    for (size_t k = 0; k < N * system->particles; k++) {
        out[k] = diagonal[k] > 0.0 ? out[k] + everywhere * diagonal[k] * u[k] : 0.0;
        sum += u[k] * out[k];
    }
    return sum;
}

/* Computes the diagonal; 0 for a component that is fixed or has no resistance. */
static void find_diagonal(const gn_held_system *system, double *diagonal) {
    memset(diagonal, 0, N * system->particles * sizeof *diagonal);
    for (size_t k = 0; k < system->springs; k++) {
        const gn_held_spring *s = &system->spring[k];
        for (int end = 0; end < 2; end++) {
            const int32_t p = end ? s->j : s->i;
            const double arm = end ? s->arm_j : s->arm_i;
            for (int a = 0; p >= 0 && a < 3; a++) {
                const double n2 = s->n[a] * s->n[a];
                diagonal[N * p + a] += s->kt + (s->kn - s->kt) * n2;
                diagonal[N * p + 3 + a] += arm * arm * s->kt * (1.0 - n2);
            }
        }
    }
    for (size_t k = 0; k < N * system->particles; k++)
        if (!(system->moves[k / N] >> k % N & 1)) diagonal[k] = 0.0;
}

/* Computes z = r/diagonal; returns r . z, the squared norm of the residual in that metric. */
static double precondition(const gn_held_system *system, const double *diagonal, const double *r,
                           double *z) {
    double sum = 0.0;
    for (size_t k = 0; k < N * system->particles; k++) {
        z[k] = diagonal[k] > 0.0 ? r[k] / diagonal[k] : 0.0;
        sum += r[k] * z[k];
    }
    return sum;
}

int gn_held_solve(const gn_held_system *system, const double *load, double tolerance, int most,
                  double *u) {
    const size_t n = N * system->particles;
    double *diagonal = system->work, *r = diagonal + n, *z = r + n, *p = z + n, *kp = p + n;
    int done = 0;
    find_diagonal(system, diagonal);
    for (size_t k = 0; k < n; k++) {
        r[k] = diagonal[k] > 0.0 ? load[k] : 0.0;
        u[k] = 0.0;
    }
    double rz = precondition(system, diagonal, r, z);
    const double enough = tolerance * tolerance * rz;
    memcpy(p, z, n * sizeof *p);
    while (rz > enough && done < most) {
        const double curvature = apply(system, diagonal, p, kp);
        if (!(curvature > 0.0)) break;
        const double step = rz / curvature;
        for (size_t k = 0; k < n; k++) {
            u[k] += step * p[k];
            r[k] -= step * kp[k];
        }
        const double next = precondition(system, diagonal, r, z);
        for (size_t k = 0; k < n; k++) p[k] = z[k] + next / rz * p[k];
        rz = next;
        done++;
    }
    return done;
}
