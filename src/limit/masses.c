/* How heavy particles would have to be for a step to hold. */
#include "limit/springs.h"

#include <math.h>

enum { PARTICLE_BLOCK = 256 };

/* Over its own mass. Whoever needs no more is not looked at closely. */
static double needed(const gn_springs *y, size_t p, double tau) {
    const gn_particles *q = y->spectrum->assembly->particles;
    double s[GN_DOFS_MAX * GN_DOFS_MAX], vector[GN_DOFS_MAX], most = 4.0 * tau * tau;
    if (q->own_share) most *= q->own_share[gn_springs_place(y, p)];
    gn_block m;
    if (!gn_springs_can_move(y, (int32_t)p)) return 1.0;
    gn_block_of(y, p, &m);
    double trace = gn_block_at(&m, tau, s);
    if (gn_block_upper(m.n, s, trace) <= most) return 1.0;
    return fmax(1.0, gn_block_top(&m, tau, vector) / most);
}

gneiss_status gn_step_masses(const gn_spectrum *spectrum, double step, double *factor,
                             gneiss_error *error) {
    gn_springs y;
    gneiss_status status = gn_springs_build(spectrum, NULL, &y, error);
    if (status == GNEISS_OK) {
#pragma omp parallel for num_threads(y.threads) schedule(dynamic, PARTICLE_BLOCK)
        for (size_t p = 0; p < y.particles; p++) factor[p] = needed(&y, p, 1.0 / step);
    }
    gn_springs_free(&y);
    return status;
}
