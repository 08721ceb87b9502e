/* Pressures at nodes: see pressure.h, and docs/fem.md for the equations. One body, compiled per
 * instruction set. */
#include "kernels/pressure.h"
#include "kernels/simd.h"

#include <string.h>

/* A row of four doubles in a register. */
typedef double four __attribute__((vector_size(32), aligned(8)));
typedef double two __attribute__((vector_size(16), aligned(8)));

/* --- first pass --- */

static void gather_growth(const gn_pressure_args *a, size_t begin, double sum[][2]) {
    const gn_partials *q = a->partials;
    const size_t block = begin / GN_PARTICLE_BLOCK;
    memset(sum, 0, GN_PARTICLE_BLOCK * sizeof *sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        const gn_share s = q->share[k];
        *(two *)sum[(size_t)s.particle - begin] +=
            *(const two *)(a->growth_row + 2 * (int64_t)s.row);
    }
}

/* Books the energies of node n: that of the pressures, and S times the past rate, from the change
 * of the stabilising term S q. */
static void book_term(const gn_pressure_args *a, size_t n, const double sum[2],
                      gn_pressure_sums *s) {
    const gn_particles *q = a->nodes;
    double *own = q->lumped + 4 * n;
    own[3] = a->dt_past > 0.0 ? (sum[1] - own[2]) / a->dt_past : 0.0;
    s->elastic +=
        0.5 * (own[0] * (sum[0] - sum[1]) * (sum[0] - sum[1]) + q->smooth[4 * n + 3] * sum[1]);
}

static void find_pressures(const gn_pressure_args *a, size_t begin, size_t end,
                           gn_pressure_sums *sums) {
    const gn_particles *q = a->nodes;
    double sum[GN_PARTICLE_BLOCK][2];
    gather_growth(a, begin, sum);
    for (size_t n = begin; n < end; n++) {
        const double *s = sum[n - begin];
        if (a->book) book_term(a, n, s, sums);
        q->lumped[4 * n + 2] = s[1];
        q->placed_p[4 * n + 3] = q->lumped[4 * n] * (s[0] - s[1]);
    }
}

/* --- second pass --- */

static void gather_slopes(const gn_pressure_args *a, size_t begin, double *sum) {
    const gn_partials *q = a->partials;
    const size_t block = begin / GN_PARTICLE_BLOCK;
    const bool space = a->nodes->soa.effects & GN_FX_SPACE;
    memset(sum, 0, (size_t)4 * GN_PARTICLE_BLOCK * sizeof *sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        const gn_share s = q->share[k];
        double *to = sum + 4 * ((size_t)s.particle - begin);
        const double *row = q->row + 4 * (int64_t)s.row;
        if (space) {
            to[0] += row[3];
            *(two *)(to + 1) += *(const two *)(a->slope_row + 2 * (int64_t)s.row);
        } else
            *(two *)to += *(const two *)(row + 2);
    }
}

/* Books the energies of the inertia S/w^2 of the stabilising pressure. A loss is booked after its
 * interval: its second half (with the mean rate of the instant at which it began) and its first. */
static void book_rate(const gn_pressure_args *a, size_t n, double before, double after,
                      gn_pressure_sums *s) {
    double *past = a->nodes->mean_rate + n, mean = 0.5 * (before + after);
    double momentum = a->nodes->lumped[4 * n + 3] / a->rate2;
    s->elastic += 0.5 * after * momentum;
    s->damping += 0.5 * a->dt_past * a->damping * (*past + mean) * momentum;
    *past = mean;
}

/* Integrates the row of a node: projected gradient and value of the stabilising pressure q follow
 * those of the pressure; damping uses the mean over the kick as in motion_template.c. */
static void follow(const gn_pressure_args *a, size_t begin, size_t end, gn_pressure_sums *sums) {
    const gn_particles *p = a->nodes;
    const double interval = 0.5 * (a->dt_past + a->dt), half = 0.5 * a->damping * interval;
    const double keep = (1.0 - half) / (1.0 + half), kick = interval * a->rate2 / (1.0 + half);
    double sum[4 * GN_PARTICLE_BLOCK];
    gather_slopes(a, begin, sum);
    for (size_t n = begin; n < end; n++) {
        four *value = (four *)(p->smooth + 4 * n), *rate = (four *)(p->smooth_rate + 4 * n);
        const double weight = p->lumped[4 * n + 1], before = (*rate)[3];
        four target = *(four *)(sum + 4 * (n - begin)) * (four){weight, weight, weight, weight};
        target[3] = p->placed_p[4 * n + 3];
        *rate = (four){keep, keep, keep, keep} * *rate +
                (four){kick, kick, kick, kick} * (target - *value);
        *value = *value + (four){a->dt, a->dt, a->dt, a->dt} * *rate;
        if (a->book) book_rate(a, n, before, (*rate)[3], sums);
        four place = *(const four *)(p->pos + 4 * n);
        place[3] = (*value)[3];
        *(four *)(p->placed_p + 4 * n) = place;
    }
}

gn_pressure_kernel *const GN_TABLE(pressure)[GN_PRESSURE_PASSES] = {find_pressures, follow};
