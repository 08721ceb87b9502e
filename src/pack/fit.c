#include "pack/fit.h"

#include "base/memory.h"
#include "base/timer.h"
#include "pack/fit_private.h"
#include "pack/spheres.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- making ---- */

static gneiss_status no_memory(size_t count, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to pack %zu particles", count);
}

static bool allocate(gn_fit *f) {
    size_t n = f->count + 1;
    f->x = gn_alloc_array(n, sizeof *f->x);
    f->trial = gn_alloc_array(n, sizeof *f->trial);
    f->first = gn_alloc_array(n, sizeof *f->first);
    f->first_term = gn_alloc_array(n, sizeof *f->first_term);
    f->terms = gn_alloc_array(n, sizeof *f->terms);
    f->near_wall = gn_alloc_array(n, sizeof *f->near_wall);
    f->gradient = gn_alloc_array(n, sizeof *f->gradient);
    f->local = gn_alloc_array(n, 2 * sizeof *f->local);
    f->inverse = gn_alloc_array(n, 16 * sizeof *f->inverse);
    f->step = gn_alloc_array(n, sizeof *f->step);
    f->r = gn_alloc_array(n, sizeof *f->r);
    f->z = gn_alloc_array(n, sizeof *f->z);
    f->p = gn_alloc_array(n, sizeof *f->p);
    f->ap = gn_alloc_array(n, sizeof *f->ap);
    f->partial = gn_alloc_array(f->blocks, GN_FIT_SUMS * sizeof *f->partial);
    return f->x && f->trial && f->first && f->first_term && f->terms && f->near_wall &&
           f->gradient && f->local && f->inverse && f->step && f->r && f->z && f->p && f->ap &&
           f->partial;
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

void gn_fit_free(gn_fit *f) {
    if (!f) return;
    void *blocks[] = {f->x,         f->trial,    f->first, f->first_term, f->terms,
                      f->near_wall, f->gradient, f->local, f->inverse,    f->step,
                      f->r,         f->z,        f->p,     f->ap,         f->partial,
                      f->neighbour, f->held,     f->term,  f->partner};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_pair_list_free(&f->hold);
    gn_soa_destroy(&gn_particle_record, &f->particles);
    free(f);
}

const double *gn_fit_rows(const gn_fit *f) {
    return (const double *)f->x;
}

gneiss_status gn_fit_hold(gn_fit *f, gneiss_error *error) {
    gn_fit_release(f);
    memcpy(f->particles.pos, f->x, f->count * sizeof *f->x);
    gn_pair_query query = {
        .particles = &f->particles, .dimension = f->dimension, .threads = f->threads};
    GN_TRY(gn_pairs_find(&query, &f->hold, error));
    f->holding = true;
    return GNEISS_OK;
}

void gn_fit_release(gn_fit *f) {
    gn_pair_list_free(&f->hold);
    f->holding = false;
}

/* ---- iterations ---- */

/* Computes x + step with the step of each particle limited to a fifth of its radius, and radii
 * within their bounds. */
static void make_trial(gn_fit *f, const gn_fit_law *law) {
    const double longest = 0.2;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t i = 0; i < f->count; i++) {
        gn_d4 step = f->step[i];
        double length = sqrt(gn_d4_sum(step * step)), limit = longest * f->x[i][3];
        gn_d4 row = f->x[i] + (length > limit ? limit / length : 1.0) * step;
        if (law->fixed_radii)
            row[3] = f->x[i][3];
        else
            row[3] = fmin(fmax(row[3], f->least[i]), f->most[i]);
        f->trial[i] = row;
    }
}

static const int products_worth = 5; /* cost of an iteration without its products, in products */
static const double damping_first = 1e-2, damping_least = 1e-6, damping_most = 1e4;

/* Does one step of Levenberg-Marquardt and adapts the damping to its success. */
static bool iterate(gn_fit *f, const gn_fit_law *law, const gn_fit_goal *goal) {
    double begin = gn_now();
    f->threads = gn_pace_threads(&f->pace);
    gn_fit_state now = f->state, then = f->state;
    gn_fit_assemble(f, law, f->x, true, &now);
    int products = gn_fit_solve(f, law, goal->products, goal->solve);
    make_trial(f, law);
    gn_fit_assemble(f, law, f->trial, false, &then);
    bool better = then.energy < now.energy;
    if (better) {
        gn_d4 *spare = f->x;
        f->x = f->trial;
        f->trial = spare;
        f->damping = fmax(f->damping / 3.0, damping_least);
    } else {
        f->damping = fmin(f->damping * 5.0, damping_most);
    }
    gn_pace_note(&f->pace, gn_now() - begin, products + products_worth, -1.0);
    f->state = better ? then : now;
    f->state.iteration++;
    return better;
}

gneiss_status gn_fit_run(gn_fit *f, const gn_fit_law *law, const gn_fit_goal *goal,
                         gn_fit_watch *watch, void *context, bool *go_on, gneiss_error *error) {
    enum { WINDOW = 5 };
    double before[WINDOW]; /* energies of the last successful steps */
    int successes = 0;
    f->damping = damping_first;
    for (int k = 0; k < goal->iterations && *go_on && f->damping < damping_most; k++) {
        if (k % goal->renew == 0) GN_TRY(gn_fit_lists(f, goal->reach, error));
        bool better = iterate(f, law, goal);
        *go_on = !watch || watch(context, &f->state);
        if (!better) continue;
        double energy = f->state.energy, *old = &before[successes % WINDOW];
        if (successes++ >= WINDOW && *old - energy < goal->decrease * energy) break;
        *old = energy;
    }
    return GNEISS_OK;
}
