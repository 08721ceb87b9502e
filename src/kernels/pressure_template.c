/* Pressures at nodes: see pressure.h, and docs/fem.md for the equations. One body, compiled per
 * instruction set. */
#include "kernels/pressure.h"
#include "kernels/simd.h"

#include <string.h>

/* A row of four doubles in a register. */
typedef double four __attribute__((vector_size(32), aligned(8)));
typedef double two __attribute__((vector_size(16), aligned(8)));

/* --- first pass --- */

static void gather_growth(const gn_pressure_args *args, size_t begin, double sum[][2]) {
    const gn_partials *q = args->partials;
    const size_t block = begin / GN_PARTICLE_BLOCK;
    memset(sum, 0, GN_PARTICLE_BLOCK * sizeof *sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        const gn_share s = q->share[k];
        *(two *)sum[(size_t)s.particle - begin] +=
            *(const two *)(args->growth_row + 2 * (int64_t)s.row);
    }
}

/* Books the energies of node n: that of the pressures, and the product of S and the past rate, from
 * the change of the stabilising term S q. */
static void book_term(const gn_pressure_args *args, size_t n, const double sum[2],
                      gn_pressure_sums *sums) {
    const gn_particles *q = args->nodes;
    double *own = q->lumped + 4 * n;
    own[3] = args->dt_past > 0.0 ? (sum[1] - own[2]) / args->dt_past : 0.0;
    sums->elastic +=
        0.5 * (own[0] * (sum[0] - sum[1]) * (sum[0] - sum[1]) + q->smooth[4 * n + 3] * sum[1]);
}

static void find_pressures(const gn_pressure_args *args, size_t begin, size_t end,
                           gn_pressure_sums *sums) {
    const gn_particles *q = args->nodes;
    double sum[GN_PARTICLE_BLOCK][2];
    gather_growth(args, begin, sum);
    for (size_t n = begin; n < end; n++) {
        const double *s = sum[n - begin];
        if (args->book) book_term(args, n, s, sums);
        q->lumped[4 * n + 2] = s[1];
        q->placed_p[4 * n + 3] = q->lumped[4 * n] * (s[0] - s[1]);
    }
}

/* --- second pass --- */

static void gather_slopes(const gn_pressure_args *args, size_t begin, double *sum) {
    const gn_partials *q = args->partials;
    const size_t block = begin / GN_PARTICLE_BLOCK;
    const bool space = args->nodes->soa.effects & GN_FX_SPACE;
    memset(sum, 0, (size_t)4 * GN_PARTICLE_BLOCK * sizeof *sum);
    for (int32_t k = q->start[block]; k < q->start[block + 1]; k++) {
        const gn_share s = q->share[k];
        double *to = sum + 4 * ((size_t)s.particle - begin);
        const double *row = q->row + 4 * (int64_t)s.row;
        if (space) {
            to[0] += row[3];
            *(two *)(to + 1) += *(const two *)(args->slope_row + 2 * (int64_t)s.row);
        } else
            *(two *)to += *(const two *)(row + 2);
    }
}

/* Books the energies of the inertia S/w^2 of the stabilising pressure. A loss is booked after its
 * interval: first its second half (with the mean rate of the instant at which it began), then its
 * first half. */
static void book_rate(const gn_pressure_args *args, size_t n, double before, double after,
                      gn_pressure_sums *sums) {
    double *past = args->nodes->mean_rate + n, mean = 0.5 * (before + after);
    double momentum = args->nodes->lumped[4 * n + 3] / args->rate2;
    sums->elastic += 0.5 * after * momentum;
    sums->damping += 0.5 * args->dt_past * args->damping * (*past + mean) * momentum;
    *past = mean;
}

/* Integrates the stabilising pressure q of each node and its projected gradient, which follow those
 * of the pressure; damping uses the mean over the kick, as in motion_template.c. */
static void follow(const gn_pressure_args *args, size_t begin, size_t end, gn_pressure_sums *sums) {
    const gn_particles *p = args->nodes;
    const double interval = 0.5 * (args->dt_past + args->dt), half = 0.5 * args->damping * interval;
    const double keep = (1.0 - half) / (1.0 + half), kick = interval * args->rate2 / (1.0 + half);
    double sum[4 * GN_PARTICLE_BLOCK];
    gather_slopes(args, begin, sum);
    for (size_t n = begin; n < end; n++) {
        four *value = (four *)(p->smooth + 4 * n), *rate = (four *)(p->smooth_rate + 4 * n);
        const double weight = p->lumped[4 * n + 1], before = (*rate)[3];
        four target = *(four *)(sum + 4 * (n - begin)) * (four){weight, weight, weight, weight};
        target[3] = p->placed_p[4 * n + 3];
        *rate = (four){keep, keep, keep, keep} * *rate +
                (four){kick, kick, kick, kick} * (target - *value);
        *value = *value + (four){args->dt, args->dt, args->dt, args->dt} * *rate;
        if (args->book) book_rate(args, n, before, (*rate)[3], sums);
        four place = *(const four *)(p->pos + 4 * n);
        place[3] = (*value)[3];
        *(four *)(p->placed_p + 4 * n) = place;
    }
}

gn_pressure_kernel *const GN_TABLE(pressure)[GN_PRESSURE_PASSES] = {find_pressures, follow};
