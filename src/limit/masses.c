/* Masses at which a given step is stable. */
#include "base/memory.h"
#include "limit/springs.h"

#include <math.h>

enum { PARTICLE_BLOCK = 256 };

/* Relative difference of blocks whose springs rotate. */
static const double nearly = 1.0 + 1e-6;

/* Returns the needed mass over a particle's own. A particle that needs no more, or with `more` no
 * more than it has, is not examined further. */
static double needed(const gn_springs *system, size_t p, double tau, bool more) {
    const gn_particles *q = system->spectrum->assembly->particles;
    double s[GN_DOFS_MAX * GN_DOFS_MAX], vector[GN_DOFS_MAX], most = 4.0 * tau * tau;
    double own = q->own_share ? q->own_share[gn_springs_place(system, p)] : 1.0;
    gn_block m;
    if (!gn_springs_can_move(system, (int32_t)p)) return 1.0;
    gn_block_of(system, p, &m);
    double trace = gn_block_at(&m, tau, s);
    if (more && gn_block_below(m.n, s, nearly * most)) return 1.0;
    if (gn_block_upper(m.n, s, trace) <= own * most) return 1.0;
    return fmax(1.0, gn_block_largest(&m, tau, vector) / (own * most));
}

static gneiss_status masses_of(const gn_spectrum *spectrum, double step, const uint8_t *inside,
                               double *factor, gneiss_error *error) {
    gn_springs y;
    gneiss_status status = gn_springs_build(spectrum, inside, &y, error);
    if (status == GNEISS_OK) {
#pragma omp parallel for num_threads(y.threads) schedule(dynamic, PARTICLE_BLOCK)
        for (size_t p = 0; p < y.particles; p++)
            factor[gn_springs_place(&y, p)] = needed(&y, p, 1.0 / step, inside);
    }
    gn_springs_free(&y);
    return status;
}

gneiss_status gn_step_masses(const gn_spectrum *spectrum, double step, const uint8_t *changed,
                             double *factor, gneiss_error *error) {
    size_t n = spectrum->assembly->particles->soa.count;
    if (!changed) return masses_of(spectrum, step, NULL, factor, error);
    uint8_t *inside = gn_alloc(n + 1);
    if (!inside) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    for (size_t p = 0; p < n; p++) {
        inside[p] = changed[p] != 0;
        factor[p] = 1.0;
    }
    gn_springs_mark_neighbours(spectrum, 1, inside);
    gneiss_status status = masses_of(spectrum, step, inside, factor, error);
    gn_free(inside);
    return status;
}
