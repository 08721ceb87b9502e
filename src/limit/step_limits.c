/* With C the contact damping, K the stiffness, x = M^1/2 u and tau = 1/dt, a step is stable exactly
 * if lambda_max(A + 2 tau B) <= 4 tau^2, where A = M^-1/2 K M^-1/2 and B = M^-1/2 C M^-1/2: every
 * eigenvector of the amplification problem obeys the scalar recurrence
 *     z^2 - (2 - c dt - k dt^2) z + 1 - c dt = 0
 * of its own Rayleigh quotients k and c, whose roots leave the unit circle at z = -1. A and B need
 * not commute. The tau from the quotients of any vector is a lower bound with an error of second
 * order in that of the vector; this solves both the blocks of single particles and the whole
 * system.
 *
 * Neglected are the geometric stiffness of the contact forces (force over length, small against k_n
 * while overlaps are small against radii) and background damping. Sliding contacts count as
 * sticking. */
#include "limit/step_limits.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "limit/damped.h"
#include "limit/local.h"
#include "limit/springs.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    DOFS_MAX = GN_DOFS_MAX,
    PARTICLE_BLOCK = 1024,
    LOCAL_FROM = 32768, /* particles; fewer take less than a second by Lanczos */
};

/* --- the rigorous bound --- */

/* Sums over the springs of a particle that give its block: B^T D B for B = [side I, arm N], N w = n
 * x w, D = k_t I + (k_n - k_t) n n^T; with bonds that carry moments, k_b (I - n n^T) + k_w n n^T on
 * the spins as well. Symmetric parts as xx yy zz xy yz zx. */
typedef struct block_sums {
    double kt, normal[6];        /* k_t; (k_n - k_t) n n^T */
    double turn, turn_normal[6]; /* arm^2 k_t + k_b; (arm^2 k_t + k_b - k_w) n n^T */
    double cross[3];             /* side arm k_t n */
    double damp[6];              /* c_n n n^T */
} block_sums;

static void add_spring(block_sums *b, const gn_spring *s, double side, double arm, double factor) {
    const double *n = s->n;
    const double nn[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                          n[0] * n[1], n[1] * n[2], n[2] * n[0]};
    double kt = factor * s->kt, along = factor * (s->kn - s->kt);
    double turn = arm * arm * kt + factor * s->bend, twist = factor * s->twist;
    double cn = factor * s->cn;
    b->kt += kt;
    b->turn += turn;
    for (int k = 0; k < 6; k++) {
        b->normal[k] += along * nn[k];
        b->turn_normal[k] += (turn - twist) * nn[k];
        b->damp[k] += cn * nn[k];
    }
    for (int k = 0; k < 3; k++) b->cross[k] += side * arm * kt * n[k];
}

/* Expands to the full 6 x 6 blocks. */
static void spread(const block_sums *b, double *k, double *c) {
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    const double *n = b->cross;
    const double cross[3][3] = {{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}};
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
            double one = p == q ? 1.0 : 0.0;
            k[6 * p + q] = b->kt * one + b->normal[place[p][q]];
            k[6 * (p + 3) + q + 3] = b->turn * one - b->turn_normal[place[p][q]];
            k[6 * p + q + 3] = k[6 * (q + 3) + p] = cross[p][q];
            c[6 * p + q] = b->damp[place[p][q]];
        }
}

void gn_block_of(const gn_springs *y, size_t p, gn_block *m) {
    double k[36] = {0.0}, c[36] = {0.0};
    block_sums sums = {0};
    *m = (gn_block){.n = y->dofs, .contacts = (int)(y->first[p + 1] - y->first[p])};
    for (size_t e = y->first[p]; e < y->first[p + 1]; e++) {
        const gn_spring *s = &y->spring[y->entry[e] / 2];
        bool second = y->entry[e] & 1;
        int32_t other = second ? s->i : s->j;
        double factor = gn_springs_can_move(y, other) ? 2.0 : 1.0;
        if (y->weight && factor == 2.0) factor = 1.0 + y->weight[other] / y->weight[p];
        add_spring(&sums, s, second ? 1.0 : -1.0, second ? s->arm_j : s->arm_i, factor);
        m->kn_max = fmax(m->kn_max, s->kn);
    }
    spread(&sums, k, c);
    const double *scale = y->scale + p * (size_t)y->dofs;
    for (int r = 0; r < m->n; r++)
        for (int q = 0; q < m->n; q++) {
            int at = 6 * gn_springs_component(y, r) + gn_springs_component(y, q);
            m->a[r * m->n + q] = scale[r] * k[at] * scale[q];
            m->b[r * m->n + q] = scale[r] * c[at] * scale[q];
        }
}

double gn_block_at(const gn_block *m, double tau, double *out) {
    double trace = 0.0;
    for (int k = 0; k < m->n * m->n; k++) out[k] = m->a[k] + 2.0 * tau * m->b[k];
    for (int k = 0; k < m->n; k++) trace += out[k * m->n + k];
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

/* Returns the round-off of the sums and of Jacobi. */
static double round_off(const gn_block *m, double trace) {
    return 4.0 * (m->contacts + 32) * DBL_EPSILON * trace;
}

double gn_block_top(const gn_block *m, double tau, double *vector) {
    double s[DOFS_MAX * DOFS_MAX], values[DOFS_MAX], vectors[DOFS_MAX * DOFS_MAX];
    double trace = gn_block_at(m, tau, s);
    gn_eigen_symmetric(m->n, s, values, vectors);
    memcpy(vector, vectors, (size_t)m->n * sizeof *vector);
    return values[0] + round_off(m, trace);
}

static double quadratic_form(int n, const double *s, const double *x) {
    double sum = 0.0;
    for (int p = 0; p < n; p++)
        for (int q = 0; q < n; q++) sum += x[p] * s[p * n + q] * x[q];
    return sum;
}

/* Returns the tau with lambda_max(A + 2 tau B) <= 4 tau^2, as small as round-off allows but at
 * least `least`. Quotients converge to it from below; the last steps exceed it until the inequality
 * holds. */
static double block_rate(const gn_block *m, double least) {
    double x[DOFS_MAX], tau = least;
    for (int k = 0; k < m->n; k++)
        tau = fmax(tau, gn_damped_rate(m->a[k * m->n + k], m->b[k * m->n + k]));
    if (gn_block_top(m, tau, x) <= 4.0 * tau * tau) return tau;
    for (int round = 0; round < 50; round++) {
        tau =
            fmax(tau, gn_damped_rate(quadratic_form(m->n, m->a, x), quadratic_form(m->n, m->b, x)));
        if (!(gn_block_top(m, tau, x) > 4.0 * tau * tau * (1.0 + 1e-12))) break;
    }
    for (double past = 1e-13; past < 1.0; past *= 2.0) {
        double raised = tau * (1.0 + past);
        if (gn_block_top(m, raised, x) <= 4.0 * raised * raised) return raised;
    }
    return NAN;
}

/* The result of a block of particles; blocks are merged in their order. */
typedef struct bound_part {
    double rate, kn_over_m; /* largest tau, largest k_n/m */
    size_t particle;        /* the particle that determines the rate */
} bound_part;

static void merge_part(bound_part *sum, double rate, double kn_over_m, size_t particle) {
    /* A NaN must not be lost: it takes precedence, and the first one is kept. */
    if (!isnan(sum->rate) && !(rate <= sum->rate)) {
        sum->rate = rate;
        sum->particle = particle;
    }
    sum->kn_over_m = fmax(sum->kn_over_m, kn_over_m);
}

static bound_part bound_of_block(const gn_springs *y, size_t begin, size_t end) {
    bound_part part = {0.0, 0.0, SIZE_MAX};
    double s[DOFS_MAX * DOFS_MAX] = {0.0};
    for (size_t p = begin; p < end; p++) {
        gn_block m;
        if (!gn_springs_can_move(y, (int32_t)p)) continue;
        gn_block_of(y, p, &m);
        double trace = gn_block_at(&m, part.rate, s);
        double rate = part.rate;
        double most = 4.0 * rate * rate; /* the trace alone decides for many */
        bool slower = rate > 0.0 && (trace <= most || gn_block_upper(m.n, s, trace) <= most ||
                                     gn_block_below(m.n, s, most - 2.0 * round_off(&m, trace)));
        if (!slower) rate = block_rate(&m, rate);
        double inverse = y->spectrum->assembly->particles->vel[4 * gn_springs_place(y, p) + 3];
        merge_part(&part, rate, m.kn_max * inverse, p);
    }
    return part;
}

/* Sets the bound; `first` is the particle that determines it. */
static gneiss_status set_bound(const gn_springs *y, gn_step_limit *limit, size_t *first,
                               gneiss_error *error) {
    size_t blocks = (y->particles + PARTICLE_BLOCK - 1) / PARTICLE_BLOCK;
    bound_part *parts = gn_alloc_array(blocks, sizeof *parts), sum = {0.0, 0.0, SIZE_MAX};
    if (!parts)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu blocks of particles", blocks);
#pragma omp parallel for num_threads(y->threads) schedule(dynamic) if (blocks > 1)
    for (size_t b = 0; b < blocks; b++) {
        size_t end = (b + 1) * PARTICLE_BLOCK;
        parts[b] = bound_of_block(y, b * PARTICLE_BLOCK, end < y->particles ? end : y->particles);
    }
    for (size_t b = 0; b < blocks; b++)
        merge_part(&sum, parts[b].rate, parts[b].kn_over_m, parts[b].particle);
    gn_free(parts);
    *first = sum.particle;
    *limit = (gn_step_limit){
        .bound = 1.0 / sum.rate, .bound_id = -1, .sharp_id = -1, .springs = y->springs};
    limit->sharp = limit->sharp_low = sum.rate == 0.0 ? INFINITY : NAN;
    limit->frequency = sum.rate == 0.0 ? 0.0 : NAN;
    limit->literature = 2.0 / sqrt(sum.kn_over_m);
    if (sum.particle != SIZE_MAX)
        limit->bound_id = y->spectrum->assembly->particles->id[gn_springs_place(y, sum.particle)];
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

/* Finds the parts of the two ends of a spring, each once. */
static int parts_of(const gn_spring *s, const int32_t *home, int32_t at[2]) {
    at[0] = home[s->i];
    if (s->j < 0 || home[s->j] == at[0]) return 1;
    at[1] = home[s->j];
    return 2;
}

/* Counts the springs of each part, then lists them. */
static bool list_springs(const gn_springs *y, const int32_t *home, gn_spring_part *part,
                         int parts) {
    int32_t at[2];
    for (size_t s = 0; s < y->springs; s++)
        for (int k = parts_of(&y->spring[s], home, at); k-- > 0;) part[at[k]].springs++;
    for (int b = 0; b < parts; b++) {
        part[b].spring = gn_alloc_array(part[b].springs + 1, sizeof *part[b].spring);
        if (!part[b].spring) return false;
        part[b].springs = 0;
    }
    for (size_t s = 0; s < y->springs; s++)
        for (int k = parts_of(&y->spring[s], home, at); k-- > 0;)
            part[at[k]].spring[part[at[k]].springs++] = (uint32_t)s;
    return true;
}

/* Makes parts with about the same number of springs, several per thread to balance the load. */
static gneiss_status make_parts(const gn_springs *y, gn_spring_part **out, int *parts,
                                gneiss_error *error) {
    const size_t most = y->particles / PARTICLE_BLOCK, wanted = 4 * (size_t)y->threads;
    *parts = y->threads == 1 || most < 2 ? 1 : (int)(most < wanted ? most : wanted);
    gn_spring_part *part = *out = gn_alloc_array((size_t)*parts, sizeof *part);
    int32_t *home = *parts > 1 ? gn_alloc_array(y->particles, sizeof *home) : NULL;
    bool made = part && (*parts == 1 || home);
    for (int b = 0; made && b < *parts; b++) {
        const size_t share = y->first[y->particles] / (size_t)*parts;
        part[b].begin = part[b].end = b ? part[b - 1].end : 0;
        while (part[b].end < y->particles &&
               (b == *parts - 1 || y->first[part[b].end] < share * (size_t)(b + 1))) {
            if (home) home[part[b].end] = b;
            part[b].end++;
        }
    }
    if (made && *parts == 1) part->springs = y->springs;
    if (made && *parts > 1) made = list_springs(y, home, part, *parts);
    gn_free(home);
    if (made) return GNEISS_OK;
    free_parts(part, *parts);
    *out = NULL;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the springs of %zu particles",
                   y->particles);
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
static inline __attribute__((always_inline)) void pull(const gn_spring *s, const scaled_operator *o,
                                                       const gn_spring_part *part, double *sums,
                                                       bool space, bool rotation) {
    const double *moved = o->system->moved;
    const double n[3] = {s->n[0], s->n[1], space ? s->n[2] : 0.0};
    const int dofs = space ? (rotation ? 6 : 3) : (rotation ? 3 : 2), dim = space ? 3 : 2;
    const double *ui = moved + (size_t)s->i * (size_t)dofs;
    double kn = o->stiffness * s->kn + o->viscosity * s->cn, kt = o->stiffness * s->kt;
    double v[3] = {0.0}, w[3] = {0.0}, force[3] = {0.0};
    for (int k = 0; k < dim; k++) v[k] = -ui[k];
    for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] = s->arm_i * ui[k];
    if (s->j >= 0) {
        const double *uj = moved + (size_t)s->j * (size_t)dofs;
        for (int k = 0; k < dim; k++) v[k] += uj[k];
        for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] += s->arm_j * uj[k];
    }
    double vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    v[0] -= w[1] * n[2] - w[2] * n[1];
    v[1] -= w[2] * n[0] - w[0] * n[2];
    v[2] -= w[0] * n[1] - w[1] * n[0];
    for (int k = 0; k < dim; k++) force[k] = kt * v[k] + (kn - kt) * vn * n[k];
    const double turn[3] = {n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2],
                            n[0] * v[1] - n[1] * v[0]};
    for (int end = 0; end < 2; end++) {
        const int32_t p = end ? s->j : s->i;
        if (p < 0 || (size_t)p < part->begin || (size_t)p >= part->end) continue;
        double *out = sums + (size_t)p * (size_t)dofs, arm = (end ? s->arm_j : s->arm_i) * kt;
        for (int k = 0; k < dim; k++) out[k] += end ? force[k] : -force[k];
        for (int k = dim; k < dofs; k++) out[k] -= arm * turn[space ? k - 3 : 2];
    }
}

/* Adds the moments of one spring likewise. */
static inline __attribute__((always_inline)) void bend(const gn_spring *s, const scaled_operator *o,
                                                       const gn_spring_part *part, double *sums,
                                                       bool space) {
    const size_t dofs = space ? 6 : 3, first = space ? 3 : 2;
    const double *moved = o->system->moved;
    double turn[3] = {0.0}, along = 0.0;
    for (size_t k = first; k < dofs; k++) {
        double *of = &turn[space ? k - 3 : 2];
        *of = -moved[(size_t)s->i * dofs + k];
        if (s->j >= 0) *of += moved[(size_t)s->j * dofs + k];
    }
    for (int k = 0; k < 3; k++) along += turn[k] * s->n[k];
    for (int end = 0; end < 2; end++) {
        const int32_t p = end ? s->j : s->i;
        if (p < 0 || (size_t)p < part->begin || (size_t)p >= part->end) continue;
        double *out = sums + (size_t)p * dofs, side = end ? o->stiffness : -o->stiffness;
        for (size_t k = first; k < dofs; k++) {
            size_t a = space ? k - 3 : 2;
            out[k] += side * (s->bend * turn[a] + (s->twist - s->bend) * along * s->n[a]);
        }
    }
}

/* Applies one part. A particle's springs are added in their order, whatever the parts are. */
static inline __attribute__((always_inline)) void apply_in(const scaled_operator *o,
                                                           const gn_spring_part *part, double *out,
                                                           bool space, bool rotation, bool bends) {
    for (size_t k = 0; k < part->springs; k++) {
        const gn_spring *s = &o->system->spring[part->spring ? part->spring[k] : k];
        pull(s, o, part, out, space, rotation);
        if (bends) bend(s, o, part, out, space);
    }
}

/* The variant is chosen inside of the parallel region, because arguments from outside are no
 * constants there. */
static void apply_to_part(const scaled_operator *o, const gn_spring_part *part, double *out) {
    const gn_springs *y = o->system;
    const size_t begin = part->begin * (size_t)y->dofs, end = part->end * (size_t)y->dofs;
    memset(out + begin, 0, (end - begin) * sizeof *out);
    if (y->space && y->bends)
        apply_in(o, part, out, true, true, true);
    else if (y->bends)
        apply_in(o, part, out, false, true, true);
    else if (y->space && y->rotation)
        apply_in(o, part, out, true, true, false);
    else if (y->space)
        apply_in(o, part, out, true, false, false);
    else if (y->rotation)
        apply_in(o, part, out, false, true, false);
    else
        apply_in(o, part, out, false, false, false);
    for (size_t k = begin; k < end; k++) out[k] *= y->scale[k];
}

void gn_springs_apply(const gn_spring_operator *of, double stiffness, double viscosity,
                      const double *x, double *out) {
    const gn_springs *y = of->system;
    const scaled_operator o = {y, of->part, of->parts, stiffness, viscosity};
#pragma omp parallel num_threads(y->threads) if (o.parts > 1)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < y->particles * (size_t)y->dofs; k++)
            y->moved[k] = y->scale[k] * x[k];
#pragma omp for schedule(dynamic)
        for (int b = 0; b < o.parts; b++) apply_to_part(&o, &o.part[b], out);
    }
}

gneiss_status gn_spring_operator_make(const gn_springs *y, gn_spring_operator *o,
                                      gneiss_error *error) {
    *o = (gn_spring_operator){.system = y};
    return make_parts(y, &o->part, &o->parts, error);
}

void gn_spring_operator_free(gn_spring_operator *o) {
    free_parts(o->part, o->parts);
    *o = (gn_spring_operator){0};
}

static void apply_all(const void *context, double stiffness, double viscosity, const double *x,
                      double *out) {
    gn_springs_apply(context, stiffness, viscosity, x, out);
}

static int32_t fastest_particle(const gn_springs *y, const double *x) {
    size_t best = 0, dofs = (size_t)y->dofs;
    double most = -1.0;
    for (size_t p = 0; p < y->particles; p++) {
        double share = 0.0;
        for (size_t d = 0; d < dofs; d++) share += x[p * dofs + d] * x[p * dofs + d];
        if (share > most) {
            most = share;
            best = p;
        }
    }
    return y->spectrum->assembly->particles->id[gn_springs_place(y, best)];
}

/* Sets the sharp limit. `place` has the entries among those of all particles (base/eigen.h); NULL:
 * all. */
static gneiss_status set_sharp(const gn_spring_operator *o, const size_t *place, double tolerance,
                               double *x, gn_step_limit *limit, gneiss_error *error) {
    const gn_springs *y = o->system;
    const gn_damped system = {.count = y->particles * (size_t)y->dofs,
                              .apply = apply_all,
                              .context = o,
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

static gneiss_status find_mode(const gn_springs *y, const size_t *place, double tolerance,
                               double *x, gn_step_limit *limit, gneiss_error *error) {
    gn_spring_operator o;
    GN_TRY(gn_spring_operator_make(y, &o, error));
    gneiss_status status = set_sharp(&o, place, tolerance, x, limit, error);
    gn_spring_operator_free(&o);
    return status;
}

gneiss_status gn_springs_mode(const gn_springs *y, double tolerance, double *x,
                              gn_step_limit *limit, gneiss_error *error) {
    return find_mode(y, NULL, tolerance, x, limit, error);
}

static gneiss_status no_mode(const gn_springs *y, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu particles",
                   y->particles);
}

static gneiss_status set_sharp_among(const gn_springs *y, const size_t *place, double tolerance,
                                     gn_step_limit *limit, gneiss_error *error) {
    double *x = gn_alloc_array(y->particles * (size_t)y->dofs, sizeof *x);
    gneiss_status status = x ? find_mode(y, place, tolerance, x, limit, error) : no_mode(y, error);
    gn_free(x);
    return status;
}

/* Marks particles that move or have springs, in groups that preserve sums (base/eigen.h). */
static size_t mark_awake(const gn_springs *y, uint8_t *awake) {
    size_t count = 0;
    for (size_t begin = 0; begin < y->particles; begin += GN_EIGEN_GROUP) {
        const size_t left = y->particles - begin;
        const size_t size = left < GN_EIGEN_GROUP ? left : GN_EIGEN_GROUP;
        bool any = false;
        for (size_t p = begin; p < begin + size && !any; p++)
            any = y->first[p] < y->first[p + 1] || gn_springs_can_move(y, (int32_t)p);
        if (any) memset(awake + begin, 1, size);
        if (any) count += size;
    }
    return count;
}

static gneiss_status set_sharp_of_awake(const gn_springs *y, const uint8_t *awake, double tolerance,
                                        gn_step_limit *limit, gneiss_error *error) {
    gn_springs members = {0};
    size_t *place = NULL;
    gneiss_status status = gn_springs_pick(y, awake, &members, error);
    const size_t dofs = (size_t)y->dofs;
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
static gneiss_status set_sharp_of_all(const gn_springs *y, double tolerance, gn_step_limit *limit,
                                      gneiss_error *error) {
    enum { FEW = 64 };
    if (y->local || y->particles < FEW) return set_sharp_among(y, NULL, tolerance, limit, error);
    uint8_t *awake = gn_alloc(y->particles);
    if (!awake) return no_mode(y, error);
    const size_t count = mark_awake(y, awake);
    gneiss_status status = count >= FEW && 2 * count <= y->particles
                               ? set_sharp_of_awake(y, awake, tolerance, limit, error)
                               : set_sharp_among(y, NULL, tolerance, limit, error);
    gn_free(awake);
    return status;
}

/* --- public --- */

gneiss_status gn_springs_limits(gn_springs *y, double tolerance, gn_step_limit *limit,
                                gneiss_error *error) {
    size_t first = SIZE_MAX;
    bool found = false;
    GN_TRY(set_bound(y, limit, &first, error));
    if (limit->bound == INFINITY || tolerance == 0.0) return GNEISS_OK;
    if (y->particles >= LOCAL_FROM && !y->local)
        GN_TRY(gn_springs_local_limit(y, first, tolerance, limit, &found, error));
    return found ? GNEISS_OK : set_sharp_of_all(y, tolerance, limit, error);
}

gneiss_status gn_step_bound(const gn_spectrum *spectrum, gn_step_limit *limit,
                            gneiss_error *error) {
    return gn_step_limits(spectrum, 0.0, limit, error);
}

gneiss_status gn_step_limits(const gn_spectrum *spectrum, double tolerance, gn_step_limit *limit,
                             gneiss_error *error) {
    gn_springs y;
    gneiss_status status = gn_springs_build(spectrum, NULL, &y, error);
    if (status == GNEISS_OK) status = gn_springs_limits(&y, tolerance, limit, error);
    gn_springs_free(&y);
    return status;
}
