/* With C the contact damping, K the stiffness, x = M^1/2 u and tau = 1/dt, a step is stable exactly
 * if lambda_max(A + 2 tau B) <= 4 tau^2, where A = M^-1/2 K M^-1/2 and B = M^-1/2 C M^-1/2: every
 * eigenvector of the amplification problem obeys the scalar recurrence
 *     z^2 - (2 - c dt - k dt^2) z + 1 - c dt = 0
 * of its own Rayleigh quotients k and c, whose roots leave the unit circle at z = -1. A and B need
 * not commute. The quotients of any vector give a tau that is a lower bound, with an error of
 * second order in the error of the vector; both the blocks of single particles and the whole system
 * are solved in this way.
 *
 * The geometric stiffness of the contact forces (force over length, small relative to k_n while
 * overlaps are small relative to radii) and background damping are neglected. Sliding contacts
 * count as sticking. */
#include "limit/step_limits.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "limit/damped.h"
#include "limit/springs.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    DOFS_MAX = GN_DOFS_MAX,
    PARTICLE_BLOCK = 1024,
    LOCAL_FROM = 32768, /* particles from which local searches are tried; fewer take less than a
                           second by Lanczos */
};

/* --- the rigorous bound --- */

/* Sums over the springs of a particle that give its block: B^T D B for B = [side I, arm N], N w = n
 * x w, D = k_t I + (k_n - k_t) n n^T; with bonds that carry moments, k_b (I - n n^T) + k_w n n^T on
 * the spins as well. Symmetric parts as xx yy zz xy yz zx. */
typedef struct block_sums {
    double kt, normal[6];        /* k_t; (k_n - k_t) n n^T */
    double turn, turn_normal[6]; /* arm^2 k_t + k_b; (arm^2 k_t + k_b - k_w) n n^T */
    double cross[3];             /* sum of side arm k_t n */
    double damp[6];              /* c_n n n^T */
} block_sums;

static void add_spring(block_sums *totals, const gn_spring *spring, double side, double arm,
                       double factor) {
    const double *n = spring->n;
    const double nn[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                          n[0] * n[1], n[1] * n[2], n[2] * n[0]};
    double kt = factor * spring->kt, along = factor * (spring->kn - spring->kt);
    double turn = arm * arm * kt + factor * spring->bend, twist = factor * spring->twist;
    double cn = factor * spring->cn;
    totals->kt += kt;
    totals->turn += turn;
    for (int k = 0; k < 6; k++) {
        totals->normal[k] += along * nn[k];
        totals->turn_normal[k] += (turn - twist) * nn[k];
        totals->damp[k] += cn * nn[k];
    }
    for (int k = 0; k < 3; k++) totals->cross[k] += side * arm * kt * n[k];
}

/* Expands the sums to full 6 x 6 blocks. */
static void spread(const block_sums *totals, double *k, double *c) {
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    const double *n = totals->cross;
    const double cross[3][3] = {{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}};
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
            double one = p == q ? 1.0 : 0.0;
            k[6 * p + q] = totals->kt * one + totals->normal[place[p][q]];
            k[6 * (p + 3) + q + 3] = totals->turn * one - totals->turn_normal[place[p][q]];
            k[6 * p + q + 3] = k[6 * (q + 3) + p] = cross[p][q];
            c[6 * p + q] = totals->damp[place[p][q]];
        }
}

void gn_block_of(const gn_springs *system, size_t p, gn_block *block) {
    double k[36] = {0.0}, c[36] = {0.0};
    block_sums sums = {0};
    *block =
        (gn_block){.n = system->dofs, .contacts = (int)(system->first[p + 1] - system->first[p])};
    for (size_t e = system->first[p]; e < system->first[p + 1]; e++) {
        const gn_spring *s = &system->spring[system->entry[e] / 2];
        bool second = system->entry[e] & 1;
        int32_t other = second ? s->i : s->j;
        double factor = gn_springs_can_move(system, other) ? 2.0 : 1.0;
        if (system->weight && factor == 2.0)
            factor = 1.0 + system->weight[other] / system->weight[p];
        add_spring(&sums, s, second ? 1.0 : -1.0, second ? s->arm_j : s->arm_i, factor);
        block->kn_max = fmax(block->kn_max, s->kn);
    }
    spread(&sums, k, c);
    const double *scale = system->scale + p * (size_t)system->dofs;
    for (int r = 0; r < block->n; r++)
        for (int q = 0; q < block->n; q++) {
            int at = 6 * gn_springs_component(system, r) + gn_springs_component(system, q);
            block->a[r * block->n + q] = scale[r] * k[at] * scale[q];
            block->b[r * block->n + q] = scale[r] * c[at] * scale[q];
        }
}

double gn_block_at(const gn_block *block, double tau, double *out) {
    double trace = 0.0;
    for (int k = 0; k < block->n * block->n; k++) out[k] = block->a[k] + 2.0 * tau * block->b[k];
    for (int k = 0; k < block->n; k++) trace += out[k * block->n + k];
    return trace;
}

double gn_block_upper(int n, const double *s, double trace) {
    if (!(trace > 0.0)) return trace;
    double power[DOFS_MAX * DOFS_MAX] = {0.0}, square[DOFS_MAX * DOFS_MAX] = {0.0}, sum = 0.0;
    for (int k = 0; k < n * n; k++) power[k] = s[k] / trace;
    for (int round = 0; round < 2; round++) {
        for (int p = 0; p < n; p++)
            for (int q = 0; q < n; q++) {
                double dot = 0.0;
                for (int k = 0; k < n; k++) dot += power[p * n + k] * power[k * n + q];
                square[p * n + q] = dot;
            }
        memcpy(power, square, (size_t)(n * n) * sizeof *power);
    }
    for (int k = 0; k < n * n; k++) sum += power[k] * power[k];
    return fmin(1.0, sqrt(sqrt(sqrt(sum))) * (1.0 + 1e-12)) * trace;
}

bool gn_block_below(int n, const double *s, double most) {
    double l[DOFS_MAX * DOFS_MAX] = {0.0};
    for (int p = 0; p < n; p++)
        for (int q = 0; q <= p; q++) {
            double sum = (p == q ? most : 0.0) - s[p * n + q];
            for (int k = 0; k < q; k++) sum -= l[p * n + k] * l[q * n + k];
            if (p == q && !(sum > 1e-12 * most)) return false;
            l[p * n + q] = p == q ? sqrt(sum) : sum / l[q * n + q];
        }
    return true;
}

/* Returns a bound of the round-off of the sums and of the Jacobi method. */
static double round_off(const gn_block *block, double trace) {
    return 4.0 * (block->contacts + 32) * DBL_EPSILON * trace;
}

double gn_block_largest(const gn_block *block, double tau, double *vector) {
    double s[DOFS_MAX * DOFS_MAX], values[DOFS_MAX], vectors[DOFS_MAX * DOFS_MAX];
    double trace = gn_block_at(block, tau, s);
    gn_eigen_symmetric(block->n, s, values, vectors);
    memcpy(vector, vectors, (size_t)block->n * sizeof *vector);
    return values[0] + round_off(block, trace);
}

static double quadratic_form(int n, const double *s, const double *x) {
    double sum = 0.0;
    for (int p = 0; p < n; p++)
        for (int q = 0; q < n; q++) sum += x[p] * s[p * n + q] * x[q];
    return sum;
}

/* Returns the smallest tau, but at least `least`, with lambda_max(A + 2 tau B) <= 4 tau^2,
 * round-off included. Quotients converge to it from below; the last iterations increase it until
 * the inequality holds. */
static double block_rate(const gn_block *block, double least) {
    double x[DOFS_MAX], tau = least;
    for (int k = 0; k < block->n; k++)
        tau = fmax(tau, gn_damped_rate(block->a[k * block->n + k], block->b[k * block->n + k]));
    if (gn_block_largest(block, tau, x) <= 4.0 * tau * tau) return tau;
    for (int round = 0; round < 50; round++) {
        tau = fmax(tau, gn_damped_rate(quadratic_form(block->n, block->a, x),
                                       quadratic_form(block->n, block->b, x)));
        if (!(gn_block_largest(block, tau, x) > 4.0 * tau * tau * (1.0 + 1e-12))) break;
    }
    for (double past = 1e-13; past < 1.0; past *= 2.0) {
        double raised = tau * (1.0 + past);
        if (gn_block_largest(block, raised, x) <= 4.0 * raised * raised) return raised;
    }
    return NAN;
}

/* Result for a block of particles; blocks are merged in their order. */
typedef struct bound_part {
    double rate, kn_over_m; /* largest tau, largest k_n/m */
    size_t particle;        /* the particle that determines the rate */
} bound_part;

static void merge_part(bound_part *sum, double rate, double kn_over_m, size_t particle) {
    /* A NaN must not be lost: it replaces any other rate, and the first one is kept. */
    if (!isnan(sum->rate) && !(rate <= sum->rate)) {
        sum->rate = rate;
        sum->particle = particle;
    }
    sum->kn_over_m = fmax(sum->kn_over_m, kn_over_m);
}

static bound_part bound_of_block(const gn_springs *system, size_t begin, size_t end) {
    bound_part part = {0.0, 0.0, SIZE_MAX};
    double s[DOFS_MAX * DOFS_MAX] = {0.0};
    for (size_t p = begin; p < end; p++) {
        gn_block m;
        if (!gn_springs_can_move(system, (int32_t)p)) continue;
        gn_block_of(system, p, &m);
        double trace = gn_block_at(&m, part.rate, s);
        double rate = part.rate;
        double most = 4.0 * rate * rate; /* for many particles the trace proves enough */
        bool slower = rate > 0.0 && (trace <= most || gn_block_upper(m.n, s, trace) <= most ||
                                     gn_block_below(m.n, s, most - 2.0 * round_off(&m, trace)));
        if (!slower) rate = block_rate(&m, rate);
        double inverse =
            system->spectrum->assembly->particles->vel[4 * gn_springs_place(system, p) + 3];
        merge_part(&part, rate, m.kn_max * inverse, p);
    }
    return part;
}

/* Computes the bound; `first` is the particle that determines it. */
static gneiss_status set_bound(const gn_springs *system, gn_step_limit *limit, size_t *first,
                               gneiss_error *error) {
    size_t blocks = (system->particles + PARTICLE_BLOCK - 1) / PARTICLE_BLOCK;
    bound_part *parts = gn_alloc_array(blocks, sizeof *parts), sum = {0.0, 0.0, SIZE_MAX};
    if (!parts)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu blocks of particles", blocks);
#pragma omp parallel for num_threads(system->threads) schedule(dynamic) if (blocks > 1)
    for (size_t b = 0; b < blocks; b++) {
        size_t end = (b + 1) * PARTICLE_BLOCK;
        parts[b] = bound_of_block(system, b * PARTICLE_BLOCK,
                                  end < system->particles ? end : system->particles);
    }
    for (size_t b = 0; b < blocks; b++)
        merge_part(&sum, parts[b].rate, parts[b].kn_over_m, parts[b].particle);
    gn_free(parts);
    *first = sum.particle;
    *limit = (gn_step_limit){
        .bound = 1.0 / sum.rate, .bound_id = -1, .sharp_id = -1, .springs = system->springs};
    limit->sharp = limit->sharp_low = sum.rate == 0.0 ? INFINITY : NAN;
    limit->frequency = sum.rate == 0.0 ? 0.0 : NAN;
    limit->literature = 2.0 / sqrt(sum.kn_over_m);
    if (sum.particle != SIZE_MAX)
        limit->bound_id =
            system->spectrum->assembly->particles->id[gn_springs_place(system, sum.particle)];
    if (!isfinite(sum.rate))
        return gn_fail(
            error, GNEISS_ERROR_UNSTABLE,
            "particle %d: its contacts have no finite stiffness over mass (position, mass or "
            "stiffness is not a number)",
            (int)limit->bound_id);
    return GNEISS_OK;
}

/* --- the sharp limit --- */

static void free_parts(gn_spring_part *part, int parts) {
    for (int b = 0; part && b < parts; b++) gn_free(part[b].spring);
    gn_free(part);
}

/* Finds the parts that contain the ends of a spring, without repetition. */
static int parts_of(const gn_spring *spring, const int32_t *home, int32_t at[2]) {
    at[0] = home[spring->i];
    if (spring->j < 0 || home[spring->j] == at[0]) return 1;
    at[1] = home[spring->j];
    return 2;
}

/* Counts the springs of each part, then lists them. */
static bool list_springs(const gn_springs *system, const int32_t *home, gn_spring_part *part,
                         int parts) {
    int32_t at[2];
    for (size_t s = 0; s < system->springs; s++)
        for (int k = parts_of(&system->spring[s], home, at); k-- > 0;) part[at[k]].springs++;
    for (int b = 0; b < parts; b++) {
        part[b].spring = gn_alloc_array(part[b].springs + 1, sizeof *part[b].spring);
        if (!part[b].spring) return false;
        part[b].springs = 0;
    }
    for (size_t s = 0; s < system->springs; s++)
        for (int k = parts_of(&system->spring[s], home, at); k-- > 0;)
            part[at[k]].spring[part[at[k]].springs++] = (uint32_t)s;
    return true;
}

/* Makes parts with about the same number of springs, several per thread to balance the load. */
static gneiss_status make_parts(const gn_springs *system, gn_spring_part **out, int *parts,
                                gneiss_error *error) {
    const size_t most = system->particles / PARTICLE_BLOCK, wanted = 4 * (size_t)system->threads;
    *parts = system->threads == 1 || most < 2 ? 1 : (int)(most < wanted ? most : wanted);
    gn_spring_part *part = *out = gn_alloc_array((size_t)*parts, sizeof *part);
    int32_t *home = *parts > 1 ? gn_alloc_array(system->particles, sizeof *home) : NULL;
    bool made = part && (*parts == 1 || home);
    for (int b = 0; made && b < *parts; b++) {
        const size_t share = system->first[system->particles] / (size_t)*parts;
        part[b].begin = part[b].end = b ? part[b - 1].end : 0;
        while (part[b].end < system->particles &&
               (b == *parts - 1 || system->first[part[b].end] < share * (size_t)(b + 1))) {
            if (home) home[part[b].end] = b;
            part[b].end++;
        }
    }
    if (made && *parts == 1) part->springs = system->springs;
    if (made && *parts > 1) made = list_springs(system, home, part, *parts);
    gn_free(home);
    if (made) return GNEISS_OK;
    free_parts(part, *parts);
    *out = NULL;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the springs of %zu particles",
                   system->particles);
}

/* The operator stiffness A + viscosity B. */
typedef struct scaled_operator {
    const gn_springs *system;
    const gn_spring_part *part;
    int parts;
    double stiffness, viscosity;
} scaled_operator;

/* Adds the forces of one spring, B^T D v_r, to the sums of its particles in the part,
 * [particles][dofs]. */
static inline __attribute__((always_inline)) void pull(const gn_spring *spring,
                                                       const scaled_operator *matrix,
                                                       const gn_spring_part *part, double *sums,
                                                       bool space, bool rotation) {
    const double *moved = matrix->system->moved;
    const double n[3] = {spring->n[0], spring->n[1], space ? spring->n[2] : 0.0};
    const int dofs = space ? (rotation ? 6 : 3) : (rotation ? 3 : 2), dim = space ? 3 : 2;
    const double *ui = moved + (size_t)spring->i * (size_t)dofs;
    double kn = matrix->stiffness * spring->kn + matrix->viscosity * spring->cn,
           kt = matrix->stiffness * spring->kt;
    double v[3] = {0.0}, w[3] = {0.0}, force[3] = {0.0};
    for (int k = 0; k < dim; k++) v[k] = -ui[k];
    for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] = spring->arm_i * ui[k];
    if (spring->j >= 0) {
        const double *uj = moved + (size_t)spring->j * (size_t)dofs;
        for (int k = 0; k < dim; k++) v[k] += uj[k];
        for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] += spring->arm_j * uj[k];
    }
    double vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    v[0] -= w[1] * n[2] - w[2] * n[1];
    v[1] -= w[2] * n[0] - w[0] * n[2];
    v[2] -= w[0] * n[1] - w[1] * n[0];
    for (int k = 0; k < dim; k++) force[k] = kt * v[k] + (kn - kt) * vn * n[k];
    const double turn[3] = {n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2],
                            n[0] * v[1] - n[1] * v[0]};
    for (int end = 0; end < 2; end++) {
        const int32_t p = end ? spring->j : spring->i;
        if (p < 0 || (size_t)p < part->begin || (size_t)p >= part->end) continue;
        double *out = sums + (size_t)p * (size_t)dofs,
               arm = (end ? spring->arm_j : spring->arm_i) * kt;
        for (int k = 0; k < dim; k++) out[k] += end ? force[k] : -force[k];
        for (int k = dim; k < dofs; k++) out[k] -= arm * turn[space ? k - 3 : 2];
    }
}

/* Adds the moments of one spring, as `pull` adds the forces. */
static inline __attribute__((always_inline)) void bend(const gn_spring *spring,
                                                       const scaled_operator *matrix,
                                                       const gn_spring_part *part, double *sums,
                                                       bool space) {
    const size_t dofs = space ? 6 : 3, first = space ? 3 : 2;
    const double *moved = matrix->system->moved;
    double turn[3] = {0.0}, along = 0.0;
    for (size_t k = first; k < dofs; k++) {
        double *of = &turn[space ? k - 3 : 2];
        *of = -moved[(size_t)spring->i * dofs + k];
        if (spring->j >= 0) *of += moved[(size_t)spring->j * dofs + k];
    }
    for (int k = 0; k < 3; k++) along += turn[k] * spring->n[k];
    for (int end = 0; end < 2; end++) {
        const int32_t p = end ? spring->j : spring->i;
        if (p < 0 || (size_t)p < part->begin || (size_t)p >= part->end) continue;
        double *out = sums + (size_t)p * dofs, side = end ? matrix->stiffness : -matrix->stiffness;
        for (size_t k = first; k < dofs; k++) {
            size_t a = space ? k - 3 : 2;
            out[k] += side * (spring->bend * turn[a] +
                              (spring->twist - spring->bend) * along * spring->n[a]);
        }
    }
}

/* Applies one part. A particle's springs are added in their order, whatever the parts are. */
static inline __attribute__((always_inline)) void apply_in(const scaled_operator *matrix,
                                                           const gn_spring_part *part, double *out,
                                                           bool space, bool rotation, bool bends) {
    for (size_t k = 0; k < part->springs; k++) {
        const gn_spring *s = &matrix->system->spring[part->spring ? part->spring[k] : k];
        pull(s, matrix, part, out, space, rotation);
        if (bends) bend(s, matrix, part, out, space);
    }
}

/* The variant is chosen inside of the parallel region, because values from outside are not
 * constants there. */
static void apply_to_part(const scaled_operator *matrix, const gn_spring_part *part, double *out) {
    const gn_springs *y = matrix->system;
    const size_t begin = part->begin * (size_t)y->dofs, end = part->end * (size_t)y->dofs;
    memset(out + begin, 0, (end - begin) * sizeof *out);
    if (y->space && y->bends)
        apply_in(matrix, part, out, true, true, true);
    else if (y->bends)
        apply_in(matrix, part, out, false, true, true);
    else if (y->space && y->rotation)
        apply_in(matrix, part, out, true, true, false);
    else if (y->space)
        apply_in(matrix, part, out, true, false, false);
    else if (y->rotation)
        apply_in(matrix, part, out, false, true, false);
    else
        apply_in(matrix, part, out, false, false, false);
    for (size_t k = begin; k < end; k++) out[k] *= y->scale[k];
}

void gn_springs_apply(const gn_spring_operator *matrix, double stiffness, double viscosity,
                      const double *x, double *out) {
    const gn_springs *y = matrix->system;
    const scaled_operator o = {y, matrix->part, matrix->parts, stiffness, viscosity};
#pragma omp parallel num_threads(y->threads) if (o.parts > 1)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < y->particles * (size_t)y->dofs; k++)
            y->moved[k] = y->scale[k] * x[k];
#pragma omp for schedule(dynamic)
        for (int b = 0; b < o.parts; b++) apply_to_part(&o, &o.part[b], out);
    }
}

gneiss_status gn_spring_operator_make(const gn_springs *system, gn_spring_operator *matrix,
                                      gneiss_error *error) {
    *matrix = (gn_spring_operator){.system = system};
    return make_parts(system, &matrix->part, &matrix->parts, error);
}

void gn_spring_operator_free(gn_spring_operator *matrix) {
    free_parts(matrix->part, matrix->parts);
    *matrix = (gn_spring_operator){0};
}

static void apply_all(const void *context, double stiffness, double viscosity, const double *x,
                      double *out) {
    gn_springs_apply(context, stiffness, viscosity, x, out);
}

static int32_t fastest_particle(const gn_springs *system, const double *x) {
    size_t best = 0, dofs = (size_t)system->dofs;
    double most = -1.0;
    for (size_t p = 0; p < system->particles; p++) {
        double share = 0.0;
        for (size_t d = 0; d < dofs; d++) share += x[p * dofs + d] * x[p * dofs + d];
        if (share > most) {
            most = share;
            best = p;
        }
    }
    return system->spectrum->assembly->particles->id[gn_springs_place(system, best)];
}

/* Computes the sharp limit. `place` has the indices of the entries among those of all particles
 * (base/eigen.h); NULL: all entries. */
static gneiss_status set_sharp(const gn_spring_operator *matrix, const size_t *place,
                               double tolerance, double *x, gn_step_limit *limit,
                               gneiss_error *error) {
    const gn_springs *y = matrix->system;
    const gn_damped system = {.count = y->particles * (size_t)y->dofs,
                              .apply = apply_all,
                              .context = matrix,
                              .moves = y->scale,
                              .damped = y->damped,
                              .place = place,
                              .whole =
                                  y->spectrum->assembly->particles->soa.count * (size_t)y->dofs,
                              .threads = y->threads};
    gn_damped_top top;
    GN_TRY(gn_damped_largest(&system, tolerance, x, &top, error));
    limit->frequency = top.frequency;
    limit->iterations = top.vectors;
    limit->sharp_id = fastest_particle(y, x);
    limit->sharp = 1.0 / top.rate;
    limit->sharp_low = fmax(limit->bound, 1.0 / top.rate_most);
    return GNEISS_OK;
}

static gneiss_status find_mode(const gn_springs *system, const size_t *place, double tolerance,
                               double *x, gn_step_limit *limit, gneiss_error *error) {
    gn_spring_operator o;
    GN_TRY(gn_spring_operator_make(system, &o, error));
    gneiss_status status = set_sharp(&o, place, tolerance, x, limit, error);
    gn_spring_operator_free(&o);
    return status;
}

gneiss_status gn_springs_mode(const gn_springs *system, double tolerance, double *x,
                              gn_step_limit *limit, gneiss_error *error) {
    return find_mode(system, NULL, tolerance, x, limit, error);
}

static gneiss_status no_mode(const gn_springs *system, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu particles",
                   system->particles);
}

static gneiss_status set_sharp_among(const gn_springs *system, const size_t *place,
                                     double tolerance, gn_step_limit *limit, gneiss_error *error) {
    double *x = gn_alloc_array(system->particles * (size_t)system->dofs, sizeof *x);
    gneiss_status status =
        x ? find_mode(system, place, tolerance, x, limit, error) : no_mode(system, error);
    gn_free(x);
    return status;
}

/* Marks particles that move or have springs, in groups that preserve sums (base/eigen.h). */
static size_t mark_awake(const gn_springs *system, uint8_t *awake) {
    size_t count = 0;
    for (size_t begin = 0; begin < system->particles; begin += GN_EIGEN_GROUP) {
        const size_t left = system->particles - begin;
        const size_t size = left < GN_EIGEN_GROUP ? left : GN_EIGEN_GROUP;
        bool any = false;
        for (size_t p = begin; p < begin + size && !any; p++)
            any =
                system->first[p] < system->first[p + 1] || gn_springs_can_move(system, (int32_t)p);
        if (any) memset(awake + begin, 1, size);
        if (any) count += size;
    }
    return count;
}

static gneiss_status set_sharp_of_awake(const gn_springs *system, const uint8_t *awake,
                                        double tolerance, gn_step_limit *limit,
                                        gneiss_error *error) {
    gn_springs members = {0};
    size_t *place = NULL;
    gneiss_status status = gn_springs_pick(system, awake, &members, error);
    const size_t dofs = (size_t)system->dofs;
    if (status == GNEISS_OK) {
        place = gn_alloc_array(members.particles * dofs, sizeof *place);
        for (size_t k = 0; place && k < members.particles * dofs; k++)
            place[k] = gn_springs_place(&members, k / dofs) * dofs + k % dofs;
        status = place ? set_sharp_among(&members, place, tolerance, limit, error)
                       : no_mode(&members, error);
    }
    gn_free(place);
    gn_springs_free(&members);
    return status;
}

/* If most particles are dormant (src/conversion/conversion.c), vectors contain only the others: the
 * limit is the same to the bit. */
static gneiss_status set_sharp_of_all(const gn_springs *system, double tolerance,
                                      gn_step_limit *limit, gneiss_error *error) {
    enum { FEW = 64 };
    if (system->local || system->particles < FEW)
        return set_sharp_among(system, NULL, tolerance, limit, error);
    uint8_t *awake = gn_alloc(system->particles);
    if (!awake) return no_mode(system, error);
    const size_t count = mark_awake(system, awake);
    gneiss_status status = count >= FEW && 2 * count <= system->particles
                               ? set_sharp_of_awake(system, awake, tolerance, limit, error)
                               : set_sharp_among(system, NULL, tolerance, limit, error);
    gn_free(awake);
    return status;
}

/* --- public --- */

gneiss_status gn_springs_limits(gn_springs *system, double tolerance, gn_step_limit *limit,
                                gneiss_error *error) {
    size_t first = SIZE_MAX;
    bool found = false;
    GN_TRY(set_bound(system, limit, &first, error));
    if (limit->bound == INFINITY || tolerance == 0.0) return GNEISS_OK;
    if (system->particles >= LOCAL_FROM && !system->local)
        GN_TRY(gn_springs_local_limit(system, first, tolerance, limit, &found, error));
    return found ? GNEISS_OK : set_sharp_of_all(system, tolerance, limit, error);
}

gneiss_status gn_step_limits(const gn_spectrum *spectrum, double tolerance, gn_step_limit *limit,
                             gneiss_error *error) {
    gn_springs y;
    gneiss_status status = gn_springs_build(spectrum, NULL, &y, error);
    if (status == GNEISS_OK) status = gn_springs_limits(&y, tolerance, limit, error);
    gn_springs_free(&y);
    return status;
}
