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

/* Computes x + step with the step of each particle limited to a fifth of its radius, and radii
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

static const int products_worth = 5; /* cost of an iteration without its products, in products */
static const double damping_first = 1e-2, damping_least = 1e-6, damping_most = 1e4;

/* Does one step of Levenberg-Marquardt and adapts the damping to its success. */
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
