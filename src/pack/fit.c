#include "pack/fit_private.h"

#include "base/memory.h"
#include "base/timer.h"
#include "pack/fit.h"
#include "pack/spheres.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* ---- neighbours of every particle in both directions, and the residuals of the fit ---- */

/* ---- lists ---- */

static gneiss_status grow(gn_fit *fit, size_t entries, size_t terms, gneiss_error *error) {
    /* A packing may have no pairs; its lists are then empty, but allocated. */
    if (!fit->neighbour || !fit->held || entries > fit->capacity) {
        gn_free(fit->neighbour);
        gn_free(fit->held);
        fit->capacity = entries + entries / 4;
        fit->neighbour = gn_alloc_array(fit->capacity + 1, sizeof *fit->neighbour);
        fit->held = gn_alloc_array(fit->capacity + 1, sizeof *fit->held);
    }
    if (!fit->term || !fit->partner || terms > fit->term_capacity) {
        gn_free(fit->term);
        gn_free(fit->partner);
        fit->term_capacity = terms + terms / 4;
        fit->term = gn_alloc_array(fit->term_capacity + 1, sizeof *fit->term);
        fit->partner = gn_alloc_array(fit->term_capacity + 1, sizeof *fit->partner);
    }
    if (fit->neighbour && fit->held && fit->term && fit->partner) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu pairs of a packing", entries / 2);
}

static bool pair_before(const int32_t a[2], const int32_t b[2]) {
    return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]);
}

/* Fills the rows in the order of the sorted pairs: first the partners below i, then those above,
 * both ascending. */
static void fill(gn_fit *fit, const gn_pair_list *pairs, size_t *next) {
    size_t h = 0;
    memcpy(next, fit->first, fit->count * sizeof *next);
    for (size_t k = 0; k < pairs->count; k++) {
        const int32_t *pair = pairs->pair[k];
        while (fit->holding && h < fit->hold.count && pair_before(fit->hold.pair[h], pair)) h++;
        bool held = fit->holding && h < fit->hold.count && !pair_before(pair, fit->hold.pair[h]);
        for (int side = 0; side < 2; side++) {
            size_t at = next[pair[side]]++;
            fit->neighbour[at] = pair[1 - side];
            fit->held[at] = held;
        }
    }
}

gneiss_status gn_fit_lists(gn_fit *fit, double reach, gneiss_error *error) {
    gn_pair_list pairs = {0};
    memcpy(fit->particles.pos, fit->x, fit->count * sizeof *fit->x);
    gn_pair_query query = {.particles = &fit->particles,
                           .dimension = fit->dimension,
                           .range = reach,
                           .threads = fit->threads};
    GN_TRY(gn_pairs_find(&query, &pairs, error));
    memset(fit->first, 0, (fit->count + 1) * sizeof *fit->first);
    for (size_t k = 0; k < pairs.count; k++)
        for (int side = 0; side < 2; side++) fit->first[pairs.pair[k][side] + 1]++;
    size_t planes = 0;
#pragma omp parallel for schedule(static) num_threads(fit->threads)
    for (size_t i = 0; i < fit->count; i++) {
        const double *x = (const double *)&fit->x[i];
        fit->near_wall[i] = gn_domain_depth(fit->domain, x) < 1.8 * x[3];
    }
    for (size_t i = 0; i < fit->count; i++) {
        fit->first_term[i] = fit->first[i] + planes;
        planes += fit->near_wall[i] ? GN_DOMAIN_PLANES : 0;
        fit->first[i + 1] += fit->first[i];
    }
    gneiss_status status =
        grow(fit, fit->first[fit->count], fit->first[fit->count] + planes, error);
    if (status == GNEISS_OK) fill(fit, &pairs, (size_t *)fit->ap);
    gn_pair_list_free(&pairs);
    return status;
}

/* ---- residuals ---- */

/* Returns r^(d-2). */
static inline double size_weight(int dimension, double length) {
    return dimension == 3 ? length : 1.0;
}

/* Sums over one particle or one block. */
typedef struct sums {
    double energy, scale, squares, pairs, overlap;
} sums;

typedef struct fit_row {
    gn_d4 gradient;
    int32_t count;
    gn_fit_term *term;
    int32_t *partner;
} fit_row;

/* Adds weight, residual and direction to the row. */
static inline void add_term(fit_row *out, double weight, double gap, gn_d4 direction,
                            int32_t partner) {
    out->gradient += weight * gap * direction;
    gn_d4 scaled = sqrt(weight) * direction;
    out->term[out->count] = __builtin_convertvector(scaled, gn_fit_term);
    out->partner[out->count++] = partner;
}

enum { HARD = 20 };

static void pair_terms(const gn_fit *fit, const gn_fit_law *law, const gn_d4 *x, size_t i,
                       bool terms, fit_row *out, sums *total) {
    const double shrink = 1.0 - law->overlap;
    for (size_t k = fit->first[i]; k < fit->first[i + 1]; k++) {
        int32_t j = fit->neighbour[k];
        gn_d4 u = x[i] - x[j];
        double reach = x[i][3] + x[j][3], touch = shrink * reach;
        double square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        double far = touch + law->gap * reach;
        bool pulled = fit->held[k] && law->pull > 0.0;
        if (!pulled && square >= (law->pull > 0.0 ? far * far : touch * touch)) continue;
        double length = sqrt(square), gap = length - touch;
        double weight = size_weight(fit->dimension, reach) * (gap < 0.0 ? 1.0 : law->pull);
        double relative = gap / reach;
        double excess = law->most > 0.0 ? fmin(0.0, length - (1.0 - law->most) * reach) : 0.0;
        double stiff = excess < 0.0 ? HARD * weight : 0.0;
        total->energy += 0.25 * (weight * gap * gap + stiff * excess * excess);
        total->squares += 0.5 * relative * relative;
        total->pairs += 0.5;
        total->overlap = fmax(total->overlap, -relative);
        if (!terms) continue;
        double inverse = length > 0.0 ? 1.0 / length : 0.0;
        gn_d4 n = {u[0] * inverse, u[1] * inverse, u[2] * inverse, -shrink};
        add_term(out, weight + stiff, weight / (weight + stiff) * gap, n, j);
        if (stiff == 0.0) continue;
        /* The second residual uses the row of the first. Its slope along the radii differs a
         * little; the gradient includes the difference and the matrix neglects it. */
        n[3] = -(1.0 - law->most);
        out->gradient += stiff * excess * n;
    }
}

/* Planes count four times, because a plane represents the mirror image of the particle at twice the
 * distance. */
static void plane_terms(const gn_fit *fit, const gn_fit_law *law, gn_d4 x, bool terms, fit_row *out,
                        sums *total) {
    enum { PLANE_WEIGHT = 4 };
    gn_domain_plane plane[GN_DOMAIN_PLANES];
    const double place[3] = {x[0], x[1], x[2]};
    double reach = fmin(fmax(2.0 * law->gap, 0.0), 0.3);
    int count = gn_domain_planes(fit->domain, place, x[3] * (1.0 + reach), plane);
    for (int k = 0; k < count; k++) {
        double gap = plane[k].depth - x[3];
        double weight =
            PLANE_WEIGHT * size_weight(fit->dimension, 2.0 * x[3]) * (gap < 0.0 ? 1.0 : law->pull);
        if (weight == 0.0) continue;
        total->energy += 0.5 * weight * gap * gap;
        if (!terms) continue;
        gn_d4 n = {plane[k].normal[0], plane[k].normal[1], plane[k].normal[2], -1.0};
        add_term(out, weight, gap, n, (int32_t)fit->count);
    }
}

static void spring_terms(gn_fit *fit, const gn_fit_law *law, size_t i, double radius, bool terms,
                         fit_row *out, sums *total) {
    double volume = size_weight(fit->dimension, 2.0 * radius) * 4.0;
    total->scale += 0.5 * volume * radius * radius;
    if (law->fixed_radii) {
        fit->local[2 * i + 1] = 0.0;
        return;
    }
    double weight = law->stiffness * 4.0 * size_weight(fit->dimension, 2.0 * fit->wanted[i]);
    double extra = radius - fit->wanted[i];
    total->energy += 0.5 * weight * extra * extra;
    if (!terms) return;
    out->gradient[3] += weight * extra;
    fit->local[2 * i + 1] = weight;
}

static sums assemble_block(gn_fit *fit, const gn_fit_law *law, const gn_d4 *x, bool terms,
                           size_t block) {
    sums s = {0};
    for (size_t i = block * GN_FIT_BLOCK; i < gn_fit_block_end(fit, block); i++) {
        fit_row out = {.term = fit->term + fit->first_term[i],
                       .partner = fit->partner + fit->first_term[i]};
        pair_terms(fit, law, x, i, terms, &out, &s);
        if (fit->near_wall[i]) plane_terms(fit, law, x[i], terms, &out, &s);
        spring_terms(fit, law, i, x[i][3], terms, &out, &s);
        if (!terms) continue;
        fit->gradient[i] = out.gradient;
        fit->terms[i] = out.count;
    }
    return s;
}

void gn_fit_assemble(gn_fit *fit, const gn_fit_law *law, const gn_d4 *x, bool terms,
                     gn_fit_state *state) {
    _Static_assert(sizeof(sums) == GN_FIT_SUMS * sizeof(double), "a block's sums fill its slots");
#pragma omp parallel for schedule(static) num_threads(fit->threads)
    for (size_t b = 0; b < fit->blocks; b++) {
        sums s = assemble_block(fit, law, x, terms, b);
        memcpy(fit->partial + GN_FIT_SUMS * b, &s, sizeof s);
    }
    sums all = {0};
    for (size_t b = 0; b < fit->blocks; b++) {
        const double *s = fit->partial + GN_FIT_SUMS * b;
        all.energy += s[0];
        all.scale += s[1];
        all.squares += s[2];
        all.pairs += s[3];
        all.overlap = fmax(all.overlap, s[4]);
    }
    state->energy = all.energy / all.scale;
    state->pairs = (size_t)(all.pairs + 0.5);
    state->gap_rms = all.pairs > 0.0 ? sqrt(all.squares / all.pairs) : 0.0;
    state->overlap_max = all.overlap;
}

/* ---- the linear system of one iteration: matrix-free normal equations, block Jacobi
 * preconditioner, and conjugate gradients in one parallel region. Every particle forms its own rows
 * from its own terms, so that nothing is scattered ---- */

static const gn_d4 mirror = {-1.0, -1.0, -1.0, 1.0};

static inline gn_d4 widen(gn_f4 a) {
    return __builtin_convertvector(a, gn_d4);
}

/* Inverts a symmetric positive definite 4 x 4 matrix by Gauss-Jordan; the result is symmetric in
 * single precision too, which conjugate gradients require. */
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

/* Returns p . (A p) over one block and stores A p in ap. */
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
 * kind stay in their slot until the next barrier but one. */
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

/* ---- making ---- */

static gneiss_status no_memory(size_t count, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to pack %zu particles", count);
}

static bool allocate(gn_fit *fit) {
    size_t n = fit->count + 1;
    fit->x = gn_alloc_array(n, sizeof *fit->x);
    fit->trial = gn_alloc_array(n, sizeof *fit->trial);
    fit->first = gn_alloc_array(n, sizeof *fit->first);
    fit->first_term = gn_alloc_array(n, sizeof *fit->first_term);
    fit->terms = gn_alloc_array(n, sizeof *fit->terms);
    fit->near_wall = gn_alloc_array(n, sizeof *fit->near_wall);
    fit->gradient = gn_alloc_array(n, sizeof *fit->gradient);
    fit->local = gn_alloc_array(n, 2 * sizeof *fit->local);
    fit->inverse = gn_alloc_array(n, 16 * sizeof *fit->inverse);
    fit->step = gn_alloc_array(n, sizeof *fit->step);
    fit->r = gn_alloc_array(n, sizeof *fit->r);
    fit->z = gn_alloc_array(n, sizeof *fit->z);
    fit->p = gn_alloc_array(n, sizeof *fit->p);
    fit->ap = gn_alloc_array(n, sizeof *fit->ap);
    fit->partial = gn_alloc_array(fit->blocks, GN_FIT_SUMS * sizeof *fit->partial);
    return fit->x && fit->trial && fit->first && fit->first_term && fit->terms && fit->near_wall &&
           fit->gradient && fit->local && fit->inverse && fit->step && fit->r && fit->z && fit->p &&
           fit->ap && fit->partial;
}

gneiss_status gn_fit_create(const gn_domain *domain, size_t count, const double *row,
                            const double *wanted, const double *least, const double *most,
                            int threads, gn_fit **out, gneiss_error *error) {
    gn_fit *f = calloc(1, sizeof *f);
    *out = f;
    if (!f) return no_memory(count, error);
    f->domain = domain;
    f->dimension = gn_domain_dimension(domain);
    f->count = count;
    f->blocks = (count + GN_FIT_BLOCK - 1) / GN_FIT_BLOCK;
    f->threads = threads;
    f->pace = gn_pace_start(threads, 1, 16, 256);
    f->wanted = wanted;
    f->least = least;
    f->most = most;
    gneiss_status status = allocate(f) ? gn_particles_of_spheres(row, count, &f->particles, error)
                                       : no_memory(count, error);
    if (status != GNEISS_OK) {
        gn_fit_free(f);
        *out = NULL;
        return status;
    }
    memcpy(f->x, row, count * sizeof *f->x);
    return GNEISS_OK;
}

void gn_fit_free(gn_fit *fit) {
    if (!fit) return;
    void *blocks[] = {fit->x,         fit->trial,    fit->first, fit->first_term, fit->terms,
                      fit->near_wall, fit->gradient, fit->local, fit->inverse,    fit->step,
                      fit->r,         fit->z,        fit->p,     fit->ap,         fit->partial,
                      fit->neighbour, fit->held,     fit->term,  fit->partner};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_pair_list_free(&fit->hold);
    gn_soa_destroy(&gn_particle_record, &fit->particles);
    free(fit);
}

const double *gn_fit_rows(const gn_fit *fit) {
    return (const double *)fit->x;
}

gneiss_status gn_fit_hold(gn_fit *fit, gneiss_error *error) {
    gn_fit_release(fit);
    memcpy(fit->particles.pos, fit->x, fit->count * sizeof *fit->x);
    gn_pair_query query = {
        .particles = &fit->particles, .dimension = fit->dimension, .threads = fit->threads};
    GN_TRY(gn_pairs_find(&query, &fit->hold, error));
    fit->holding = true;
    return GNEISS_OK;
}

void gn_fit_release(gn_fit *fit) {
    gn_pair_list_free(&fit->hold);
    fit->holding = false;
}

/* ---- iterations ---- */

/* Computes x + step; the step of each particle is limited to a fifth of its radius, and radii stay
 * within their bounds. */
static void make_trial(gn_fit *fit, const gn_fit_law *law) {
    const double longest = 0.2;
#pragma omp parallel for schedule(static) num_threads(fit->threads)
    for (size_t i = 0; i < fit->count; i++) {
        gn_d4 step = fit->step[i];
        double length = sqrt(gn_d4_sum(step * step)), limit = longest * fit->x[i][3];
        gn_d4 row = fit->x[i] + (length > limit ? limit / length : 1.0) * step;
        if (law->fixed_radii)
            row[3] = fit->x[i][3];
        else
            row[3] = fmin(fmax(row[3], fit->least[i]), fit->most[i]);
        fit->trial[i] = row;
    }
}

static const int products_worth =
    5; /* cost of an iteration without its products, in units of a product */
static const double damping_first = 1e-2, damping_least = 1e-6, damping_most = 1e4;

/* Performs one step of Levenberg-Marquardt and adapts the damping to its success. */
static bool iterate(gn_fit *fit, const gn_fit_law *law, const gn_fit_goal *goal) {
    double begin = gn_now();
    fit->threads = gn_pace_threads(&fit->pace);
    gn_fit_state now = fit->state, then = fit->state;
    gn_fit_assemble(fit, law, fit->x, true, &now);
    int products = gn_fit_solve(fit, law, goal->products, goal->solve);
    make_trial(fit, law);
    gn_fit_assemble(fit, law, fit->trial, false, &then);
    bool better = then.energy < now.energy;
    if (better) {
        gn_d4 *spare = fit->x;
        fit->x = fit->trial;
        fit->trial = spare;
        fit->damping = fmax(fit->damping / 3.0, damping_least);
    } else {
        fit->damping = fmin(fit->damping * 5.0, damping_most);
    }
    gn_pace_note(&fit->pace, gn_now() - begin, products + products_worth, -1.0);
    fit->state = better ? then : now;
    fit->state.iteration++;
    return better;
}

gneiss_status gn_fit_run(gn_fit *fit, const gn_fit_law *law, const gn_fit_goal *goal,
                         gn_fit_watch *watch, void *context, bool *go_on, gneiss_error *error) {
    enum { WINDOW = 5 };
    double before[WINDOW]; /* energies of the last successful steps */
    int successes = 0;
    fit->damping = damping_first;
    for (int k = 0; k < goal->iterations && *go_on && fit->damping < damping_most; k++) {
        if (k % goal->renew == 0) GN_TRY(gn_fit_lists(fit, goal->reach, error));
        bool better = iterate(fit, law, goal);
        *go_on = !watch || watch(context, &fit->state);
        if (!better) continue;
        double energy = fit->state.energy, *old = &before[successes % WINDOW];
        if (successes++ >= WINDOW && *old - energy < goal->decrease * energy) break;
        *old = energy;
    }
    return GNEISS_OK;
}
