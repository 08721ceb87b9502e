/* Neighbours of every particle in both directions, and the residuals of the fit. */
#include "base/memory.h"
#include "pack/fit_private.h"

#include <math.h>
#include <string.h>

/* ---- lists ---- */

static gneiss_status grow(gn_fit *fit, size_t entries, size_t terms, gneiss_error *error) {
    /* A packing may have no pairs: its lists are empty but allocated. */
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

/* Fills the rows in the order of the sorted pairs: the partners below i come first, both
 * ascending. */
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

/* r^(d-2) */
static inline double size_weight(int dimension, double length) {
    return dimension == 3 ? length : 1.0;
}

/* Sums of one particle or block. */
typedef struct sums {
    double energy, scale, squares, pairs, overlap;
} sums;

typedef struct row {
    gn_d4 gradient;
    int32_t count;
    gn_fit_term *term;
    int32_t *partner;
} row;

/* Adds weight, residual and direction to the row. */
static inline void add_term(row *out, double weight, double gap, gn_d4 direction, int32_t partner) {
    out->gradient += weight * gap * direction;
    gn_d4 scaled = sqrt(weight) * direction;
    out->term[out->count] = __builtin_convertvector(scaled, gn_fit_term);
    out->partner[out->count++] = partner;
}

enum { HARD = 20 };

static void pair_terms(const gn_fit *fit, const gn_fit_law *law, const gn_d4 *x, size_t i,
                       bool terms, row *out, sums *total) {
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
        /* The second residual uses the row of the first: its slope along the radii differs a
         * little, which the gradient includes and the matrix neglects. */
        n[3] = -(1.0 - law->most);
        out->gradient += stiff * excess * n;
    }
}

/* Planes count four times: one of them represents the mirror image of the particle, at twice the
 * distance. */
static void plane_terms(const gn_fit *fit, const gn_fit_law *law, gn_d4 x, bool terms, row *out,
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
                         row *out, sums *total) {
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
        row out = {.term = fit->term + fit->first_term[i],
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
