/* Tests whether a step is stable without computing the limit: for most particles local estimates
 * suffice. */
#include "base/eigen.h"
#include "base/new.h"
#include "limit/damped.h"
#include "limit/springs.h"
#include "limit/step_limits.h"

#include <math.h>
#include <string.h>

enum { DOFS_MAX = GN_DOFS_MAX };

/* Adds the largest eigenvalue of one spring's block to the particle's sums [2] of stiffness and of
 * dashpots. */
static void add_end(const gn_spectrum *spectrum, const gn_spring *spring, bool second,
                    double *sums) {
    int32_t i = second ? spring->j : spring->i, other = second ? spring->i : spring->j;
    if (i < 0) return;
    const gn_particles *p = spectrum->assembly->particles;
    double arm = second ? spring->arm_j : spring->arm_i, mass = p->vel[4 * (size_t)i + 3];
    double inertia = p->spin ? p->spin[4 * (size_t)i + 3] : 0.0, turn = arm * arm * inertia;
    double factor = gn_spectrum_can_move(spectrum, other) ? 2.0 : 1.0;
    double top = spring->kn * mass, across = spring->kt * (mass + turn) + spring->bend * inertia;
    if (spring->twist * inertia > top) top = spring->twist * inertia;
    /* fmax would hide a NaN, and an undefined normal has to be detected as well. */
    sums[2 * (size_t)i] += factor * (across > top ? across : top) + 0.0 * spring->n[0];
    sums[2 * (size_t)i + 1] += factor * spring->cn * mass;
}

/* Tells whether contact k may have an end among the marked particles, by a cheap test. */
static bool may_reach(const gn_spectrum *spectrum, size_t k, const uint8_t *marked) {
    int32_t i, j;
    if (k >= gn_spring_pairs(spectrum)) return true;
    gn_spring_ends(spectrum, k, &i, &j);
    return marked[i] || marked[j];
}

/* Keeps only the marks of particles that sums over their springs do not prove stable. The largest
 * eigenvalue of a sum of matrices is at most the sum of their largest eigenvalues. */
static size_t leave_by_sums(const gn_spectrum *spectrum, double tau, double *sums,
                            uint8_t *marked) {
    size_t contacts = gn_spring_count(spectrum), found = 0;
    for (size_t k = 0; k < contacts; k++) {
        gn_spring s;
        if (!may_reach(spectrum, k, marked) || !gn_spring_make(spectrum, k, &s)) continue;
        add_end(spectrum, &s, false, sums);
        add_end(spectrum, &s, true, sums);
    }
    for (size_t p = 0; p < spectrum->assembly->particles->soa.count; p++) {
        if (!marked[p]) continue;
        double most = (sums[2 * p] + 2.0 * tau * sums[2 * p + 1]) * (1.0 + 1e-12);
        marked[p] = gn_spectrum_can_move(spectrum, (int32_t)p) && !(most <= 4.0 * tau * tau);
        found += marked[p];
    }
    return found;
}

/* Returns an upper bound of the ratio by which a particle's block exceeds what the step allows; 1:
 * it does not. */
static double block_over(const gn_springs *system, size_t p, double tau) {
    double s[DOFS_MAX * DOFS_MAX], most = 4.0 * tau * tau;
    gn_block m;
    if (system->first[p] == system->first[p + 1])
        return 1.0; /* there are no springs, as for all dormant particles */
    gn_block_of(system, p, &m);
    double trace = gn_block_at(&m, tau, s);
    if (trace <= most || gn_block_below(m.n, s, most)) return 1.0;
    return fmax(gn_block_upper(m.n, s, trace) / most, 1.0 + 1e-9);
}

/* Marks [particles of the specimen] the members whose own block exceeds what the step 1/tau allows,
 * and unmarks the others; returns the number of marked ones. */
static size_t springs_mark_above(const gn_springs *system, double tau, uint8_t *marked) {
    size_t found = 0;
    for (size_t p = 0; p < system->particles; p++) {
        bool above = !(block_over(system, p, tau) <= 1.0);
        marked[gn_springs_place(system, p)] = above;
        found += above;
    }
    return found;
}

/* Also marks the neighbours [of the specimen] of marked particles, with one more than the highest
 * mark so far. */
static void springs_mark_neighbours(const gn_spectrum *spectrum, uint8_t highest, uint8_t *marked) {
    size_t pairs = gn_spring_pairs(spectrum);
    uint8_t next = (uint8_t)(highest + 1);
    for (size_t k = 0; k < pairs; k++) {
        int32_t i, j;
        gn_spring s;
        gn_spring_ends(spectrum, k, &i, &j);
        bool one = marked[i] && marked[i] < next, two = marked[j] && marked[j] < next;
        if (one == two || !gn_spring_make(spectrum, k, &s)) continue;
        marked[one ? j : i] = next;
    }
}

/* Schedules the particle and its neighbours for the next round. */
static void look_again(const gn_springs *system, size_t p, uint8_t *next) {
    next[p] = 1;
    for (size_t e = system->first[p]; e < system->first[p + 1]; e++) {
        const gn_spring *s = &system->spring[system->entry[e] / 2];
        if (s->j >= 0) next[system->entry[e] & 1 ? s->i : s->j] = 1;
    }
}

/* Adjusts the weights of all scheduled particles once. A particle whose block is too large, or
 * which has neighbours outside of the system, gets no weight: it is marked in `left` and excluded;
 * without `left` the function returns false. */
static bool settle_round(gn_springs *system, double tau, const uint8_t *marked, uint8_t highest,
                         const uint8_t *due, uint8_t *next, uint8_t *left) {
    for (size_t p = 0; p < system->particles; p++) {
        if (!due[p] || (left && left[p])) continue;
        double over = block_over(system, p, tau);
        if (over <= 1.0) continue;
        if (!(over < 1.95) || marked[gn_springs_place(system, p)] == highest) {
            if (!left) return false;
            left[p] = 1;
            continue;
        }
        system->weight[p] *= 1.02 * over / (2.0 - over);
        look_again(system, p, next);
    }
    return true;
}

/* Finds weights, system->weight, with which every block of the system stays below what the step
 * 1/tau allows; the caller or gn_springs_free frees them. A particle whose block exceeds it gets a
 * larger weight, which transfers more of its springs to its neighbours. At first only particles
 * with mark 1 [particles of the specimen] exceed it; those with the highest mark have neighbours
 * outside. Returns whether weights were found. With `left` [particles, zero] the function marks the
 * particles for which there are none, and returns false only if memory is lacking; all others then
 * stay below, for any weights of the marked ones up to their present weights. */
static bool springs_find_weights(gn_springs *system, double tau, const uint8_t *marked,
                                 uint8_t highest, uint8_t *left) {
    enum { ROUNDS = 24 };
    size_t n = system->particles;
    uint8_t *due = gn_alloc(n + 1), *next = gn_alloc(n + 1);
    system->weight = gn_alloc_array(n + 1, sizeof *system->weight);
    bool going = due && next && system->weight, settled = false;
    for (size_t p = 0; going && p < n; p++) {
        system->weight[p] = 1.0;
        due[p] = marked[gn_springs_place(system, p)] == 1;
    }
    for (int round = 0; going && !settled && round < ROUNDS; round++) {
        going = settle_round(system, tau, marked, highest, due, next, left);
        settled = going && !memchr(next, 1, n);
        memcpy(due, next, n);
        memset(next, 0, n);
    }
    for (size_t p = 0; going && !settled && left && p < n; p++) left[p] |= due[p];
    gn_free(due);
    gn_free(next);
    return left ? going : settled;
}

static bool weights_settle(gn_springs *system, double tau, const uint8_t *marked, uint8_t highest) {
    bool settled = springs_find_weights(system, tau, marked, highest, NULL);
    gn_free(system->weight);
    system->weight = NULL;
    return settled;
}

static gneiss_status judge_by_blocks(const gn_spectrum *spectrum, double step, uint8_t *marked,
                                     gn_step_verdict *verdict, gneiss_error *error) {
    gn_springs y = {0};
    gneiss_status status = gn_springs_build(spectrum, marked, &y, error);
    if (status == GNEISS_OK) verdict->holds = !springs_mark_above(&y, 1.0 / step, marked);
    gn_springs_free(&y);
    return status;
}

/* Arguments of gn_step_holds. */
typedef struct inquiry {
    double step, tolerance;
    bool limit;
} inquiry;

/* Decides by weights or, with a tolerance, by Lanczos. If the step is not stable and there is no
 * tolerance, the function searches for the largest smaller step for which there are weights, in
 * steps of 3 %, but not below the limit of single blocks. */
static gneiss_status judge_system(gn_springs *system, const inquiry *question,
                                  const uint8_t *marked, uint8_t highest, gn_step_verdict *verdict,
                                  gneiss_error *error) {
    const double step = question->step, tolerance = question->tolerance;
    verdict->holds = weights_settle(system, 1.0 / step, marked, highest);
    if (verdict->holds) return GNEISS_OK;
    gn_step_limit limit;
    GN_TRY(gn_springs_limits(system, tolerance, &limit, error));
    verdict->limit = tolerance > 0.0 ? limit.sharp : limit.bound;
    verdict->holds = verdict->limit >= step;
    if (tolerance > 0.0 || !question->limit) return GNEISS_OK;
    for (double less = 0.97 * step; less > verdict->limit; less *= 0.97)
        if (weights_settle(system, 1.0 / less, marked, highest)) verdict->limit = less;
    return GNEISS_OK;
}

static gneiss_status step_holds(const gn_spectrum *spectrum, const inquiry *question, double *sums,
                                uint8_t *marked, gn_step_verdict *verdict, gneiss_error *error) {
    enum { LAYERS = 3 };
    gn_springs y = {0};
    if (!leave_by_sums(spectrum, 1.0 / question->step, sums, marked)) return GNEISS_OK;
    verdict->holds =
        question->step < INFINITY; /* some motion has a resistance, which answers the question */
    if (!verdict->holds) return GNEISS_OK;
    GN_TRY(judge_by_blocks(spectrum, question->step, marked, verdict, error));
    if (verdict->holds) return GNEISS_OK;
    for (int layer = 1; layer <= LAYERS; layer++)
        springs_mark_neighbours(spectrum, (uint8_t)layer, marked);
    gneiss_status status = gn_springs_build(spectrum, marked, &y, error);
    if (status == GNEISS_OK)
        status = judge_system(&y, question, marked, LAYERS + 1, verdict, error);
    gn_springs_free(&y);
    return status;
}

gneiss_status gn_step_holds(const gn_spectrum *spectrum, double step, double tolerance, bool limit,
                            const uint8_t *changed, gn_step_verdict *verdict, gneiss_error *error) {
    size_t n = spectrum->assembly->particles->soa.count;
    double *sums = gn_alloc_array(n + 1, 2 * sizeof *sums);
    uint8_t *marked = gn_alloc(n + 1);
    const inquiry q = {step, tolerance, limit};
    *verdict = (gn_step_verdict){.holds = true, .limit = INFINITY};
    gneiss_status status = GNEISS_OK;
    if (sums && marked) {
        for (size_t p = 0; p < n; p++) marked[p] = !changed || changed[p];
        if (changed) springs_mark_neighbours(spectrum, 1, marked);
        status = step_holds(spectrum, &q, sums, marked, verdict, error);
    } else {
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    }
    gn_free(sums);
    gn_free(marked);
    return status;
}

gneiss_status gn_step_holds_by_sums(const gn_spectrum *spectrum, double step, bool *holds,
                                    gneiss_error *error) {
    size_t n = spectrum->assembly->particles->soa.count;
    double *sums = gn_alloc_array(n + 1, 2 * sizeof *sums);
    uint8_t *marked = gn_alloc_array_raw(n + 1, 1);
    bool held = sums && marked;
    if (held) memset(marked, 1, n);
    *holds = held && leave_by_sums(spectrum, 1.0 / step, sums, marked) == 0;
    gn_free(sums);
    gn_free(marked);
    return held ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
}

void gn_step_contact_hashes(const gn_spectrum *spectrum, int32_t *marks) {
    const gn_assembly *a = spectrum->assembly;
    const size_t contacts = gn_spring_count(spectrum);
    const int32_t *id = a->particles->id;
    memset(marks, 0, a->particles->soa.count * sizeof *marks);
    for (size_t k = 0; k < contacts; k++) {
        gn_spring s;
        size_t c = k;
        const gn_contacts *list = gn_spring_list(spectrum, &c);
        if (list && gn_contact_bonded(list, c)) continue;
        if (!gn_spring_make(spectrum, k, &s)) continue;
        size_t wall = k - gn_spring_pairs(spectrum);
        uint64_t bits;
        memcpy(&bits, &s.kn, sizeof bits);
        uint64_t i = (uint64_t)id[s.i], j = s.j < 0 ? 0 : (uint64_t)id[s.j];
        uint64_t z = s.j < 0 ? i << 32 | UINT32_MAX : i < j ? i << 32 | j : j << 32 | i;
        if (s.j < 0 && a->wall_contacts && wall < a->wall_contacts->soa.count)
            z -= 1 + (uint64_t)a->wall_contacts->wall[wall];
        else if (s.j < 0) /* a surface contact is identified by its stiffness and position */
            z = gn_hash_place(z) + bits +
                (uint64_t)(lround(4.0 * s.n[0]) + 16 * lround(4.0 * s.n[1]) +
                           256 * lround(4.0 * s.n[2]) + 4096);
        if (a->particles->pressed)
            z = gn_hash_place(z) + bits; /* changes also if the contact becomes stiffer */
        uint32_t mark = (uint32_t)(gn_hash_place(z) >> 32);
        marks[s.i] = (int32_t)((uint32_t)marks[s.i] + mark);
        if (s.j >= 0) marks[s.j] = (int32_t)((uint32_t)marks[s.j] + mark);
    }
}

size_t gn_step_rotated_contacts(const gn_spectrum *spectrum, double most, uint8_t *turned) {
    const gn_assembly *a = spectrum->assembly;
    size_t found = 0, k = 0;
    for (int l = 0; l < GN_LISTS_MOST; l++) {
        const gn_contacts *list = a->list[l];
        for (size_t c = 0; list && c < list->soa.count; c++, k++) {
            gn_spring s;
            if (!gn_spring_make(spectrum, k, &s)) continue;
            float *looked[3];
            double way2 = 0.0, size2 = 0.0;
            for (size_t d = 0; d < 3; d++) {
                looked[d] = &list->looked[c + d * list->soa.capacity];
                way2 += (s.n[d] - *looked[d]) * (s.n[d] - *looked[d]);
                size2 += *looked[d] * *looked[d];
            }
            bool first = size2 == 0.0f;
            if (!first && !(way2 > most * most)) continue;
            for (size_t d = 0; d < 3; d++) *looked[d] = (float)s.n[d];
            if (first) continue;
            turned[s.i] = turned[s.j] = 1;
            found++;
        }
    }
    return found;
}

/* The sharp limit of many particles from the few that can determine it. In a packing of unequal
 * spheres the fastest mode is around a small particle with stiff contacts; nearly all others are
 * slower by their own blocks, whatever the rest does. The few, with some layers around them, form a
 * system of its own. With weighted springs to the outside its largest rate is an upper bound of
 * that of the whole system; its mode, extended by zeros, has a quotient in the whole system that is
 * a lower bound. If both agree, they are the limit of the whole; if not, as in lattices, where all
 * particles are alike, there is no result. */

enum { LOCAL_LAYERS = 3, LAYERS_MORE = 2, LOCAL_ROUNDS = 3, SHARE = 4 };

typedef struct local_search {
    gn_springs *whole;
    gn_spring_operator of_whole;
    double tolerance;
    double *mode, *image; /* [particles][dofs] mode in the whole system, 0 outside; product of the
                             operator with it */
    uint8_t *core, *inside;
    double low, high; /* 1/s: bounds of the rate of the whole system */
} local_search;

static double quotient(local_search *local, double stiffness, double viscosity) {
    const size_t count = local->whole->particles * (size_t)local->whole->dofs;
    gn_springs_apply(&local->of_whole, stiffness, viscosity, local->mode, local->image);
    return gn_eigen_dot(count, local->mode, local->image, local->whole->threads);
}

/* Extends a mode of the members to the whole system by zeros; the norm stays the same. */
static void spread_mode(local_search *local, const gn_springs *members, const double *x) {
    const size_t dofs = (size_t)members->dofs;
    memset(local->mode, 0, local->whole->particles * dofs * sizeof *local->mode);
    for (size_t p = 0; p < members->particles; p++)
        memcpy(local->mode + gn_springs_place(members, p) * dofs, x + p * dofs, dofs * sizeof *x);
}

static gneiss_status solve_members(local_search *local, const gn_springs *members,
                                   gn_step_limit *limit, gneiss_error *error) {
    double *x = NULL;
    GN_TRY(
        gn_new(&x, members->particles * (size_t)members->dofs + 1, "a mode of particles", error));
    gneiss_status status = gn_springs_mode(members, local->tolerance, x, limit, error);
    if (status == GNEISS_OK) {
        spread_mode(local, members, x);
        double a = quotient(local, 1.0, 0.0), b = members->damped ? quotient(local, 0.0, 1.0) : 0.0;
        local->low = fmax(local->low, gn_damped_rate(a, b));
    }
    gn_free(x);
    return status;
}

/* Computes the limit of the core with `layers` layers around it. */
static gneiss_status solve_around(local_search *local, int layers, gn_step_limit *limit,
                                  gneiss_error *error) {
    gn_springs members = {0};
    memcpy(local->inside, local->core, local->whole->particles);
    for (int layer = 1; layer <= layers; layer++)
        springs_mark_neighbours(local->whole->spectrum, (uint8_t)layer, local->inside);
    gneiss_status status = gn_springs_build_weighed(local->whole->spectrum, local->inside,
                                                    local->whole->weight, &members, error);
    if (status == GNEISS_OK) status = solve_members(local, &members, limit, error);
    gn_springs_free(&members);
    return status;
}

/* Keeps in the core those particles that no weights bring below `high`. */
static gneiss_status leave_unsettled(local_search *local, size_t *count, gneiss_error *error) {
    gn_springs *y = local->whole;
    const size_t n = y->particles;
    springs_mark_above(y, local->high, local->core);
    memset(local->inside, 0, n);
    if (!springs_find_weights(y, local->high, local->core, UINT8_MAX, local->inside))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the weights of %zu particles", n);
    for (size_t p = 0; p < n; p++) {
        local->core[p] = local->inside[p];
        if (local->core[p]) y->weight[p] = 1.0;
        *count += local->core[p];
    }
    return GNEISS_OK;
}

static gneiss_status search(local_search *local, size_t first, gn_step_limit *limit, bool *found,
                            gneiss_error *error) {
    size_t count = 0;
    memset(local->core, 0, local->whole->particles);
    local->core[first] = 1;
    GN_TRY(solve_around(local, LOCAL_LAYERS, limit,
                        error)); /* accurate enough to exclude most others */
    local->high = local->low * (1.0 + 0.5 * local->tolerance);
    GN_TRY(leave_unsettled(local, &count, error));
    const double others = local->high;
    *found = count == 0; /* if no core remains, as for loose grains in single contacts, no other
                            motion is faster */
    for (int round = 0; !*found && count <= local->whole->particles / SHARE && round < LOCAL_ROUNDS;
         round++) {
        gn_step_limit around = *limit;
        GN_TRY(solve_around(local, LOCAL_LAYERS + round * LAYERS_MORE, &around, error));
        local->high = fmax(others, 1.0 / around.sharp_low);
        *found = local->high <= local->low * (1.0 + local->tolerance);
        if (*found) *limit = around;
    }
    return GNEISS_OK;
}

gneiss_status gn_springs_local_limit(gn_springs *system, size_t first, double tolerance,
                                     gn_step_limit *limit, bool *found, gneiss_error *error) {
    local_search s = {.whole = system, .tolerance = tolerance};
    const size_t count = system->particles * (size_t)system->dofs + 1;
    gn_step_limit sharp = *limit;
    *found = false;
    GN_TRY(gn_spring_operator_make(system, &s.of_whole, error));
    s.mode = gn_alloc_array(count, sizeof *s.mode);
    s.image = gn_alloc_array(count, sizeof *s.image);
    s.core = gn_alloc(system->particles + 1);
    s.inside = gn_alloc(system->particles + 1);
    gneiss_status status =
        s.mode && s.image && s.core && s.inside
            ? search(&s, first, &sharp, found, error)
            : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a mode of %zu particles",
                      system->particles);
    if (status == GNEISS_OK && *found) {
        *limit = sharp;
        limit->sharp = 1.0 / s.low;
        limit->sharp_low = fmax(limit->bound, 1.0 / s.high);
    }
    gn_free(s.mode);
    gn_free(s.image);
    gn_free(s.core);
    gn_free(s.inside);
    gn_spring_operator_free(&s.of_whole);
    return status;
}

/* Masses with which a given step is stable. */

enum { PARTICLE_BLOCK = 256 };

/* Relative change of a block below which a rotation of its springs is ignored. */
static const double nearly = 1.0 + 1e-6;

/* Returns the ratio of the needed mass to a particle's own mass. A particle that needs no more than
 * its own (with `more`: than its present one) is not examined further. */
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
    springs_mark_neighbours(spectrum, 1, inside);
    gneiss_status status = masses_of(spectrum, step, inside, factor, error);
    gn_free(inside);
    return status;
}
