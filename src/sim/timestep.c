/* With C the contact damping, K the stiffness, x = M^1/2 u and tau = 1/dt, a step is stable exactly
 * if lambda_max(A + 2 tau B) <= 4 tau^2, where A = M^-1/2 K M^-1/2 and B = M^-1/2 C M^-1/2: every
 * eigenvector of the amplification problem sees the scalar recurrence
 *     z^2 - (2 - c dt - k dt^2) z + 1 - c dt = 0
 * of its own Rayleigh quotients k and c, whose roots leave the unit circle at z = -1. A and B need
 * not commute. The tau that follows from the quotients of any vector is a lower bound with an error
 * of second order in that of the vector: so both the blocks of single particles and the whole
 * system are solved.
 *
 * Left out: the geometric stiffness of the contact forces (force over length, small against k_n
 * while overlaps are small against radii) and background damping. Sliding contacts count as
 * sticking. */
#include "sim/timestep.h"

#include "base/eigen.h"
#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { DOFS_MAX = 6, CONTACT_BLOCK = 8192, PARTICLE_BLOCK = 1024 };

/* An active contact. The normal points from i to j; j < 0: a wall. */
typedef struct spring {
    int32_t i, j;
    double n[3], arm_i, arm_j, kn, kt, cn;
} spring;

typedef struct spring_system {
    const gn_spectrum *spectrum;
    int threads, dofs;
    bool space, rotation, damped;
    size_t particles, springs;
    spring *spring; /* [springs] */
    size_t *first;  /* [particles + 1] into entry */
    uint32_t
        *entry; /* 2 * spring + (0: the particle is i, 1: it is j), ascending for each particle */
    double *scale; /* [particles][dofs]: M^-1/2, 0 for what cannot move */
    double *moved; /* [particles][dofs]: scratch of the operator, M^-1/2 x */
} spring_system;

/* --- the springs ----------------------------------------------------------------------------- */

static bool removed(const gn_particles *p, int32_t i) {
    return p->vel[4 * (size_t)i + 3] == 0.0;
}

static void nearest_image(const gn_assembly *a, double d[3]) {
    for (int k = 0; a->periodic && k < a->dimension; k++)
        d[k] -= a->period[k] * round(d[k] / a->period[k]);
}

static bool contact_spring(const gn_spectrum *spectrum, const gn_contacts *list, size_t c,
                           spring *s) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    *s = (spring){.i = list->i[c], .j = list->j[c], .kn = list->kn[c]};
    if (removed(p, s->i) || removed(p, s->j)) return false;
    const double *x = p->pos + 4 * (size_t)s->i, *y = p->pos + 4 * (size_t)s->j;
    double d[3] = {y[0] - x[0], y[1] - x[1], a->dimension == 3 ? y[2] - x[2] : 0.0};
    nearest_image(a, d);
    double distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    bool intact = list->rn && list->rn[c] > 0.0;
    double rest = list->length0 ? list->length0[c] : x[3] + y[3];
    /* Not (distance >= rest), so that a NaN is an active spring and gets noticed. */
    if (!intact && distance >= rest) return false;
    double half = spectrum->arm_factor * (distance - x[3] - y[3]);
    s->arm_i = x[3] + half;
    s->arm_j = y[3] + half;
    /* Coincident centres have no direction and, as in the kernel, no normal force. */
    for (int k = 0; k < 3; k++) s->n[k] = distance == 0.0 ? 0.0 : d[k] / distance;
    bool holds = intact || (list->mu && list->mu[c] > 0.0);
    s->kt = holds && list->kt ? list->kt[c] : 0.0;
    s->cn = list->cn ? list->cn[c] : 0.0;
    return true;
}

static bool wall_spring(const gn_spectrum *spectrum, const gn_wall_contacts *list, size_t c,
                        spring *s) {
    const gn_assembly *a = spectrum->assembly;
    const gn_particles *p = a->particles;
    size_t wall = (size_t)list->wall[c];
    if (list->touch && wall >= a->wall_count) return false; /* a facet: see `extra` */
    *s = (spring){.i = list->i[c], .j = -1, .kn = spectrum->wall_stiffness[2 * wall]};
    if (removed(p, s->i)) return false;
    const double *x = p->pos + 4 * (size_t)s->i;
    const double *normal = a->wall_normals + 4 * wall, *point = spectrum->wall_point + 4 * wall;
    double gap = -x[3];
    for (int k = 0; k < a->dimension; k++) {
        s->n[k] = -normal[k];
        gap += normal[k] * (x[k] - point[k]);
    }
    if (gap > list->gap0[c]) return false; /* a passive contact starts at gap0 and counts */
    /* The wall is rigid: its contact point is on the plane, or at r as between particles. */
    s->arm_i = x[3] + 2.0 * spectrum->arm_factor * gap;
    s->kt = list->shear ? spectrum->wall_stiffness[2 * wall + 1] : 0.0;
    double alpha = spectrum->wall_damping ? spectrum->wall_damping[wall] : 0.0;
    s->cn = 2.0 * alpha * sqrt(s->kn / p->vel[4 * (size_t)s->i + 3]);
    return true;
}

static bool extra_spring(const gn_spectrum *spectrum, size_t k, spring *s) {
    const gn_extra_spring *e = &spectrum->extra[k];
    *s =
        (spring){.i = e->particle, .j = -1, .arm_i = e->arm, .kn = e->kn, .kt = e->kt, .cn = e->cn};
    memcpy(s->n, e->n, sizeof s->n);
    return !removed(spectrum->assembly->particles, s->i);
}

static size_t wall_contact_count(const gn_assembly *a) {
    return a->wall_contacts ? a->wall_contacts->soa.count : 0;
}

static size_t list_count(const gn_contacts *list) {
    return list ? list->soa.count : 0;
}

/* Contact k of bonds, pairs, wall contacts and further springs counted through. */
static bool make_spring(const gn_spectrum *spectrum, size_t k, spring *s) {
    const gn_assembly *a = spectrum->assembly;
    if (k < list_count(a->bonds)) return contact_spring(spectrum, a->bonds, k, s);
    k -= list_count(a->bonds);
    if (k < list_count(a->pairs)) return contact_spring(spectrum, a->pairs, k, s);
    k -= list_count(a->pairs);
    if (k < wall_contact_count(a)) return wall_spring(spectrum, a->wall_contacts, k, s);
    return extra_spring(spectrum, k - wall_contact_count(a), s);
}

/* Counts the active springs of each block of contacts, then writes them in order. */
static gneiss_status collect_springs(spring_system *y, gneiss_error *error) {
    const gn_assembly *a = y->spectrum->assembly;
    size_t contacts = list_count(a->bonds) + list_count(a->pairs) + wall_contact_count(a) +
                      y->spectrum->extra_count;
    size_t blocks = (contacts + CONTACT_BLOCK - 1) / CONTACT_BLOCK;
    size_t *start = gn_alloc_array(blocks + 1, sizeof *start);
    if (!start)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu blocks of contacts", blocks);
    for (int pass = 0; pass < 2; pass++) {
#pragma omp parallel for num_threads(y->threads) schedule(static) if (blocks > 1)
        for (size_t b = 0; b < blocks; b++) {
            size_t end = (b + 1) * CONTACT_BLOCK < contacts ? (b + 1) * CONTACT_BLOCK : contacts;
            size_t at = pass ? start[b] : 0;
            for (size_t k = b * CONTACT_BLOCK; k < end; k++) {
                spring s;
                if (!make_spring(y->spectrum, k, &s)) continue;
                if (pass) y->spring[at] = s;
                at++;
            }
            if (!pass) start[b] = at;
        }
        if (pass) break;
        for (size_t b = 0; b < blocks; b++) {
            size_t found = start[b];
            start[b] = y->springs;
            y->springs += found;
        }
        y->spring = gn_alloc_array(y->springs, sizeof *y->spring);
        if (!y->spring) break;
    }
    gn_free(start);
    if (!y->spring || y->springs > INT32_MAX)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu active contacts", y->springs);
    return GNEISS_OK;
}

/* For each particle the springs it carries, in their order. */
static gneiss_status list_incidence(spring_system *y, gneiss_error *error) {
    y->first = gn_alloc_array(y->particles + 2, sizeof *y->first);
    y->entry = gn_alloc_array(2 * y->springs, sizeof *y->entry);
    if (!y->first || !y->entry)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the contacts of %zu particles",
                       y->particles);
    /* Shifted by two, so that the cursors of the second loop end as the starts. */
    for (size_t s = 0; s < y->springs; s++) {
        y->first[y->spring[s].i + 2]++;
        if (y->spring[s].j >= 0) y->first[y->spring[s].j + 2]++;
    }
    for (size_t p = 2; p < y->particles + 2; p++) y->first[p] += y->first[p - 1];
    for (size_t s = 0; s < y->springs; s++) {
        y->entry[y->first[y->spring[s].i + 1]++] = (uint32_t)(2 * s);
        if (y->spring[s].j >= 0) y->entry[y->first[y->spring[s].j + 1]++] = (uint32_t)(2 * s + 1);
    }
    return GNEISS_OK;
}

/* --- degrees of freedom ---------------------------------------------------------------------- */

/* Place of a particle's degree of freedom in v x y z, w x y z. */
static int component_of(const spring_system *y, int dof) {
    if (y->space) return dof;
    return dof < 2 ? dof : 5;
}

static gneiss_status scale_dofs(spring_system *y, gneiss_error *error) {
    const gn_particles *p = y->spectrum->assembly->particles;
    const uint8_t *fixed = y->spectrum->fixed;
    size_t count = y->particles * (size_t)y->dofs;
    y->scale = gn_alloc_array(count, sizeof *y->scale);
    y->moved = gn_alloc_array(count, sizeof *y->moved);
    if (!y->scale || !y->moved)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu degrees of freedom", count);
    for (size_t i = 0; i < y->particles; i++)
        for (int d = 0; d < y->dofs; d++) {
            int component = component_of(y, d);
            double inverse = component < 3 ? p->vel[4 * i + 3] : p->spin[4 * i + 3];
            bool free = !fixed || !(fixed[i] >> component & 1);
            y->scale[i * (size_t)y->dofs + (size_t)d] = free ? sqrt(inverse) : 0.0;
        }
    return GNEISS_OK;
}

static bool can_move(const spring_system *y, int32_t i) {
    for (int d = 0; i >= 0 && d < y->dofs; d++)
        if (y->scale[(size_t)i * (size_t)y->dofs + (size_t)d] > 0.0) return true;
    return false;
}

static void system_free(spring_system *y) {
    gn_free(y->spring);
    gn_free(y->first);
    gn_free(y->entry);
    gn_free(y->scale);
    gn_free(y->moved);
}

static gneiss_status system_build(const gn_spectrum *spectrum, spring_system *y,
                                  gneiss_error *error) {
    const gn_assembly *a = spectrum->assembly;
    *y = (spring_system){.spectrum = spectrum,
                         .threads = spectrum->threads > 0 ? spectrum->threads : 1};
    y->space = a->dimension == 3;
    y->rotation = a->particles->spin != NULL;
    y->dofs = y->space ? (y->rotation ? 6 : 3) : (y->rotation ? 3 : 2);
    y->particles = a->particles->soa.count;
    GN_TRY(collect_springs(y, error));
    GN_TRY(list_incidence(y, error));
    GN_TRY(scale_dofs(y, error));
    for (size_t s = 0; s < y->springs && !y->damped; s++) y->damped = y->spring[s].cn != 0.0;
    return GNEISS_OK;
}

/* --- the rigorous bound ---------------------------------------------------------------------- */

/* The scaled diagonal blocks of one particle, [n][n]. Springs with two movable ends
 * count twice (|a - b|^2 <= 2|a|^2 + 2|b|^2). */
typedef struct block {
    int n, contacts;
    double a[DOFS_MAX * DOFS_MAX], b[DOFS_MAX * DOFS_MAX];
    double kn_max;
} block;

/* B^T D B for B = [side I, arm N], N w = n x w, D = k_t I + (k_n - k_t) n n^T; 3 x 3 parts, k
 * [6][6]. */
static void add_spring(double *k, const double n[3], double side, double arm, double kn,
                       double kt) {
    const double cross[3][3] = {{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}};
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
            double nn = n[p] * n[q], one = p == q ? 1.0 : 0.0;
            k[6 * p + q] += kt * one + (kn - kt) * nn;
            k[6 * (p + 3) + q + 3] += arm * arm * kt * (one - nn);
            k[6 * p + q + 3] += side * arm * kt * cross[p][q];
            k[6 * (q + 3) + p] += side * arm * kt * cross[p][q];
        }
}

static void particle_block(const spring_system *y, size_t p, block *m) {
    double k[36] = {0.0}, c[36] = {0.0};
    *m = (block){.n = y->dofs, .contacts = (int)(y->first[p + 1] - y->first[p])};
    for (size_t e = y->first[p]; e < y->first[p + 1]; e++) {
        const spring *s = &y->spring[y->entry[e] / 2];
        bool second = y->entry[e] & 1;
        double factor = can_move(y, second ? s->i : s->j) ? 2.0 : 1.0;
        double arm = second ? s->arm_j : s->arm_i, side = second ? 1.0 : -1.0;
        add_spring(k, s->n, side, arm, factor * s->kn, factor * s->kt);
        if (s->cn != 0.0) add_spring(c, s->n, side, arm, factor * s->cn, 0.0);
        m->kn_max = fmax(m->kn_max, s->kn);
    }
    const double *scale = y->scale + p * (size_t)y->dofs;
    for (int r = 0; r < m->n; r++)
        for (int q = 0; q < m->n; q++) {
            int at = 6 * component_of(y, r) + component_of(y, q);
            m->a[r * m->n + q] = scale[r] * k[at] * scale[q];
            m->b[r * m->n + q] = scale[r] * c[at] * scale[q];
        }
}

/* out = A + 2 tau B; returns the trace. */
static double block_at(const block *m, double tau, double *out) {
    double trace = 0.0;
    for (int k = 0; k < m->n * m->n; k++) out[k] = m->a[k] + 2.0 * tau * m->b[k];
    for (int k = 0; k < m->n; k++) trace += out[k * m->n + k];
    return trace;
}

/* |S^4|_F^(1/4) or the trace, whichever is smaller: not below the largest eigenvalue of S >= 0, and
 * cheap. */
static double upper_estimate(int n, const double *s, double trace) {
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

/* Largest eigenvalue of the block at tau from above (round-off of the sums and of Jacobi included),
 * and its vector. */
static double block_top(const block *m, double tau, double *vector) {
    double s[DOFS_MAX * DOFS_MAX], values[DOFS_MAX], vectors[DOFS_MAX * DOFS_MAX];
    double trace = block_at(m, tau, s);
    gn_eigen_symmetric(m->n, s, values, vectors);
    memcpy(vector, vectors, (size_t)m->n * sizeof *vector);
    return values[0] + 4.0 * (m->contacts + 32) * DBL_EPSILON * trace;
}

static double quadratic_form(int n, const double *s, const double *x) {
    double sum = 0.0;
    for (int p = 0; p < n; p++)
        for (int q = 0; q < n; q++) sum += x[p] * s[p * n + q] * x[q];
    return sum;
}

/* The root of 4 tau^2 = a + 2 tau b. */
static double rate_of(double a, double b) {
    return (b + sqrt(b * b + 4.0 * a)) / 4.0;
}

/* tau with lambda_max(A + 2 tau B) <= 4 tau^2, as small as round-off allows but not below the given
 * one. The quotients climb to it from below; the last steps go past it until the inequality holds.
 */
static double block_rate(const block *m, double least) {
    double x[DOFS_MAX], tau = least;
    for (int k = 0; k < m->n; k++) tau = fmax(tau, rate_of(m->a[k * m->n + k], m->b[k * m->n + k]));
    if (block_top(m, tau, x) <= 4.0 * tau * tau) return tau;
    for (int round = 0; round < 50; round++) {
        tau = fmax(tau, rate_of(quadratic_form(m->n, m->a, x), quadratic_form(m->n, m->b, x)));
        if (!(block_top(m, tau, x) > 4.0 * tau * tau * (1.0 + 1e-12))) break;
    }
    for (double past = 1e-13; past < 1.0; past *= 2.0) {
        double raised = tau * (1.0 + past);
        if (block_top(m, raised, x) <= 4.0 * raised * raised) return raised;
    }
    return NAN;
}

/* What a block of particles comes to; merged in their order. */
typedef struct bound_part {
    double rate, kn_over_m; /* largest tau, largest k_n/m */
    size_t particle;        /* that sets the rate */
} bound_part;

static void merge_part(bound_part *sum, double rate, double kn_over_m, size_t particle) {
    /* A NaN must not be lost: it wins, and the first one stays. */
    if (!isnan(sum->rate) && !(rate <= sum->rate)) {
        sum->rate = rate;
        sum->particle = particle;
    }
    sum->kn_over_m = fmax(sum->kn_over_m, kn_over_m);
}

static bound_part bound_of_block(const spring_system *y, size_t begin, size_t end) {
    bound_part part = {0.0, 0.0, SIZE_MAX};
    double s[DOFS_MAX * DOFS_MAX] = {0.0};
    for (size_t p = begin; p < end; p++) {
        block m;
        if (!can_move(y, (int32_t)p)) continue;
        particle_block(y, p, &m);
        double trace = block_at(&m, part.rate, s);
        double rate = part.rate;
        bool slower = rate > 0.0 && upper_estimate(m.n, s, trace) <= 4.0 * rate * rate;
        if (!slower) rate = block_rate(&m, rate);
        merge_part(&part, rate, m.kn_max * y->spectrum->assembly->particles->vel[4 * p + 3], p);
    }
    return part;
}

static gneiss_status set_bound(const spring_system *y, gn_step_limit *limit, gneiss_error *error) {
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
    *limit = (gn_step_limit){
        .bound = 1.0 / sum.rate, .bound_id = -1, .sharp_id = -1, .springs = y->springs};
    limit->sharp = limit->sharp_low = sum.rate == 0.0 ? INFINITY : NAN;
    limit->frequency = sum.rate == 0.0 ? 0.0 : NAN;
    limit->literature = 2.0 / sqrt(sum.kn_over_m);
    if (sum.particle != SIZE_MAX)
        limit->bound_id = y->spectrum->assembly->particles->id[sum.particle];
    if (!isfinite(sum.rate))
        return gn_fail(
            error, GNEISS_ERROR_UNSTABLE,
            "particle %d: its contacts have no finite stiffness over mass (position, mass or "
            "stiffness is not a number)",
            (int)limit->bound_id);
    return GNEISS_OK;
}

/* --- the sharp limit ------------------------------------------------------------------------- */

/* S = stiffness A + viscosity B. */
typedef struct step_operator {
    const spring_system *system;
    double stiffness, viscosity;
} step_operator;

/* Adds what one spring pulls at its first or second particle, B^T D v_r, to out [dofs]. */
static inline void pull(const spring *s, bool second, const step_operator *o, const double *moved,
                        bool space, bool rotation, double *out) {
    const int dofs = space ? (rotation ? 6 : 3) : (rotation ? 3 : 2), dim = space ? 3 : 2;
    const double *ui = moved + (size_t)s->i * (size_t)dofs;
    double kn = o->stiffness * s->kn + o->viscosity * s->cn, kt = o->stiffness * s->kt;
    double v[3] = {0.0}, w[3] = {0.0};
    for (int k = 0; k < dim; k++) v[k] = -ui[k];
    for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] = s->arm_i * ui[k];
    if (s->j >= 0) {
        const double *uj = moved + (size_t)s->j * (size_t)dofs;
        for (int k = 0; k < dim; k++) v[k] += uj[k];
        for (int k = dim; k < dofs; k++) w[space ? k - 3 : 2] += s->arm_j * uj[k];
    }
    const double *n = s->n;
    double vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    v[0] -= w[1] * n[2] - w[2] * n[1];
    v[1] -= w[2] * n[0] - w[0] * n[2];
    v[2] -= w[0] * n[1] - w[1] * n[0];
    double side = second ? 1.0 : -1.0, arm = (second ? s->arm_j : s->arm_i) * kt;
    for (int k = 0; k < dim; k++) out[k] += side * (kt * v[k] + (kn - kt) * vn * n[k]);
    if (space && rotation) {
        out[3] -= arm * (n[1] * v[2] - n[2] * v[1]);
        out[4] -= arm * (n[2] * v[0] - n[0] * v[2]);
        out[5] -= arm * (n[0] * v[1] - n[1] * v[0]);
    }
    if (!space && rotation) out[2] -= arm * (n[0] * v[1] - n[1] * v[0]);
}

static inline __attribute__((always_inline)) void
apply_core(const step_operator *o, const double *x, double *out, bool space, bool rotation) {
    const spring_system *y = o->system;
    const size_t dofs = (size_t)(space ? (rotation ? 6 : 3) : (rotation ? 3 : 2));
#pragma omp parallel num_threads(y->threads) if (y->particles > PARTICLE_BLOCK)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < y->particles * dofs; k++) y->moved[k] = y->scale[k] * x[k];
#pragma omp for schedule(dynamic, PARTICLE_BLOCK)
        for (size_t p = 0; p < y->particles; p++) {
            double sum[DOFS_MAX] = {0.0};
            for (size_t e = y->first[p]; e < y->first[p + 1]; e++)
                pull(&y->spring[y->entry[e] / 2], y->entry[e] & 1, o, y->moved, space, rotation,
                     sum);
            for (size_t d = 0; d < dofs; d++) out[p * dofs + d] = y->scale[p * dofs + d] * sum[d];
        }
    }
}

static void apply_step(const void *context, const double *x, double *out) {
    const step_operator *o = context;
    const spring_system *y = o->system;
    if (y->space && y->rotation) apply_core(o, x, out, true, true);
    if (y->space && !y->rotation) apply_core(o, x, out, true, false);
    if (!y->space && y->rotation) apply_core(o, x, out, false, true);
    if (!y->space && !y->rotation) apply_core(o, x, out, false, false);
}

/* Uniform in [-1, 1), from the place alone (splitmix64, Steele, Lea & Flood 2014). */
static double noise(size_t place) {
    uint64_t z = ((uint64_t)place + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((int64_t)(z ^ z >> 31) >> 11) * 0x1p-52;
}

static int32_t fastest_particle(const spring_system *y, const double *x) {
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
    return y->spectrum->assembly->particles->id[best];
}

/* x . S x for S = stiffness A + viscosity B and unit x. */
static double quotient(const spring_system *y, double stiffness, double viscosity, const double *x,
                       double *scratch) {
    step_operator o = {y, stiffness, viscosity};
    apply_step(&o, x, scratch);
    return gn_eigen_dot(y->particles * (size_t)y->dofs, x, scratch, y->threads);
}

/* One search at tau = viscosity/2 from the start in x. Keeps what is known in `limit`, returns the
 * new tau. */
static gneiss_status search(const spring_system *y, double tau, double tolerance, double *x,
                            double *scratch, gn_step_limit *limit, double *rate,
                            gneiss_error *error) {
    size_t n = y->particles * (size_t)y->dofs;
    step_operator o = {y, 1.0, 2.0 * tau};
    gn_eigen_top top;
    GN_TRY(gn_eigen_largest(n, apply_step, &o, tolerance, y->threads, x, &top, error));
    double a = top.value, b = 0.0;
    if (y->damped) {
        a = tau == 0.0 ? top.value : quotient(y, 1.0, 0.0, x, scratch);
        b = quotient(y, 0.0, 1.0, x, scratch);
    }
    if (tau == 0.0) limit->frequency = sqrt(top.value);
    limit->iterations += top.vectors;
    limit->sharp_id = fastest_particle(y, x);
    *rate = rate_of(a, b);
    limit->sharp = 1.0 / *rate;
    limit->sharp_low = fmax(limit->bound, 1.0 / rate_of(a + top.residual, b));
    return GNEISS_OK;
}

static gneiss_status set_sharp(const spring_system *y, double tolerance, double *x, double *scratch,
                               gn_step_limit *limit, gneiss_error *error) {
    size_t n = y->particles * (size_t)y->dofs;
    double tau = 0.0, rate;
    for (size_t k = 0; k < n; k++) x[k] = y->scale[k] > 0.0 ? noise(k) : 0.0;
    GN_TRY(search(y, 0.0, tolerance, x, scratch, limit, &rate, error));
    /* The rate climbs and its error is squared each time; a dozen rounds are never needed. */
    for (int round = 0; y->damped && round < 12 && fabs(rate - tau) > 0.1 * tolerance * rate;
         round++) {
        tau = rate;
        /* A little of everything: another mode may overtake the one found so far. */
        for (size_t k = 0; k < n; k++)
            x[k] += y->scale[k] > 0.0 ? 1e-2 / sqrt((double)n) * noise(k + n * (size_t)(round + 1))
                                      : 0.0;
        GN_TRY(search(y, tau, tolerance, x, scratch, limit, &rate, error));
    }
    return GNEISS_OK;
}

/* --- public ---------------------------------------------------------------------------------- */

gneiss_status gn_step_bound(const gn_spectrum *spectrum, gn_step_limit *limit,
                            gneiss_error *error) {
    spring_system y;
    gneiss_status status = system_build(spectrum, &y, error);
    if (status == GNEISS_OK) status = set_bound(&y, limit, error);
    system_free(&y);
    return status;
}

gneiss_status gn_step_limits(const gn_spectrum *spectrum, double tolerance, gn_step_limit *limit,
                             gneiss_error *error) {
    spring_system y;
    double *x = NULL, *scratch = NULL;
    gneiss_status status = system_build(spectrum, &y, error);
    if (status == GNEISS_OK) status = set_bound(&y, limit, error);
    if (status == GNEISS_OK && limit->bound < INFINITY) {
        size_t n = y.particles * (size_t)y.dofs;
        x = gn_alloc_array(n, sizeof *x);
        scratch = gn_alloc_array(n, sizeof *scratch);
        status = x && scratch ? set_sharp(&y, tolerance, x, scratch, limit, error)
                              : gn_fail(error, GNEISS_ERROR_MEMORY,
                                        "no memory for a mode of %zu components", n);
    }
    gn_free(x);
    gn_free(scratch);
    system_free(&y);
    return status;
}
