/* The largest stable step of the solid linearised at its start: dt = 2/w_max, with w_max^2 the
 * largest eigenvalue of M^-1 K. bound.c has its bound. */
#include "base/eigen.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/internal.h"

#include <math.h>
#include <string.h>

typedef gn_fem_linear linear_system;

void gn_fem_gradients(const gn_elements *elements, size_t e, double gradient[4][3]) {
    const int d = gn_elements_dimension(elements);
    memset(gradient, 0, 12 * sizeof(double));
    for (int a = 1; a <= d; a++)
        for (int k = 0; k < d; k++) {
            gradient[a][k] = gn_elements_gradient(elements, a, k)[e];
            gradient[0][k] -= gradient[a][k];
        }
}

/* --- sharp --- */

/* Computes the forces K u of one element and returns its energy u.K u/2. */
static double linear_element(const linear_system *system, size_t e, const double *u,
                             double force[4][3]) {
    const gn_elements *q = &system->solid->elements;
    const int d = system->dimension;
    double gradient[4][3], strain[3][3] = {{0.0}}, trace = 0.0, energy = 0.0;
    gn_fem_gradients(q, e, gradient);
    for (int a = 0; a <= d; a++) {
        const double *v = u + (size_t)d * (size_t)gn_elements_node(q, a)[e];
        for (int i = 0; i < d; i++)
            for (int k = 0; k < d; k++) {
                strain[i][k] += 0.5 * v[i] * gradient[a][k];
                strain[k][i] += 0.5 * v[i] * gradient[a][k];
            }
    }
    for (int k = 0; k < d; k++) trace += strain[k][k];
    memset(force, 0, 12 * sizeof(double));
    for (int i = 0; i < d; i++)
        for (int k = 0; k < d; k++) {
            double stress = 2.0 * q->mu[e] * strain[i][k] + (i == k ? q->lambda[e] * trace : 0.0);
            energy += 0.5 * q->volume[e] * stress * strain[i][k];
            for (int a = 0; a <= d; a++) force[a][i] += q->volume[e] * stress * gradient[a][k];
        }
    return energy;
}

static void linear_block(const linear_system *system, size_t block) {
    const gn_partials *q = &system->solid->partials;
    const size_t nodes = (size_t)system->dimension + 1;
    double *row = q->row + 4 * (size_t)q->first[block], force[4][3];
    memset(row, 0, 4 * (size_t)(q->first[block + 1] - q->first[block]) * sizeof *row);
    size_t end = (block + 1) * q->length;
    if (end > system->solid->elements.soa.count) end = system->solid->elements.soa.count;
    for (size_t e = block * q->length; e < end; e++) {
        linear_element(system, e, system->moved, force);
        for (size_t a = 0; a < nodes; a++)
            for (int i = 0; i < system->dimension; i++)
                row[q->place[nodes * e + a] + i] += force[a][i];
    }
}

/* Below this number of nodes, loops are not distributed over threads. */
enum { FEW = 1000 };

void gn_fem_linear_apply(const void *system, const double *x, double *out) {
    const linear_system *y = system;
    const gn_partials *q = &y->solid->partials;
    const size_t d = (size_t)y->dimension, nodes = y->solid->nodes.soa.count;
#pragma omp parallel num_threads(y->solid->threads) if (nodes > FEW)
    {
#pragma omp for schedule(static)
        for (size_t k = 0; k < nodes * d; k++) {
            y->moved[k] = y->scale[k] * x[k];
            out[k] = 0.0;
        }
#pragma omp for schedule(static)
        for (size_t b = 0; b < q->blocks; b++) linear_block(y, b);
#pragma omp for schedule(static)
        for (size_t b = 0; b < y->solid->motion_blocks; b++)
            for (int32_t s = q->start[b]; s < q->start[b + 1]; s++)
                for (size_t i = 0; i < d; i++) {
                    size_t k = d * (size_t)q->share[s].particle + i;
                    out[k] += y->scale[k] * q->row[4 * (size_t)q->share[s].row + i];
                }
    }
}

static void find_culprits(const linear_system *system, const double *mode, gn_fem_limit *limit) {
    const size_t d = (size_t)system->dimension;
    double most = -1.0, force[4][3];
    for (size_t n = 0; n < system->solid->nodes.soa.count; n++) {
        double share = 0.0;
        for (size_t i = 0; i < d; i++) {
            share += mode[d * n + i] * mode[d * n + i];
            system->moved[d * n + i] = system->scale[d * n + i] * mode[d * n + i];
        }
        if (share <= most) continue;
        most = share;
        limit->sharp_node = system->solid->nodes.id[n];
    }
    most = -1.0;
    for (size_t e = 0; e < system->solid->elements.soa.count; e++) {
        double energy = linear_element(system, e, system->moved, force);
        if (energy <= most) continue;
        most = energy;
        limit->sharp_element = system->solid->elements.id[e];
    }
}

static gneiss_status find_sharp(const linear_system *linear, double tolerance, gn_fem_limit *limit,
                                gneiss_error *error) {
    const bool pressure = linear->solid->form == GN_FEM_PRESSURE;
    size_t n = linear->solid->nodes.soa.count * (size_t)(linear->dimension + pressure);
    double *mode = gn_alloc_array(n + 1, sizeof *mode);
    if (!mode) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the fastest mode");
    /* Fixed components have no part in the mode. */
    for (size_t k = 0; k < n; k++) mode[k] = gn_random_symmetric(1, k);
    for (size_t k = 0; k < linear->solid->nodes.soa.count * (size_t)linear->dimension; k++)
        if (!(linear->scale[k] > 0.0)) mode[k] = 0.0;
    gn_eigen_top top;
    const gn_eigen_system system = {.n = n,
                                    .apply =
                                        pressure ? gn_fem_linear_pressure : gn_fem_linear_apply,
                                    .metric = pressure ? gn_fem_linear_metric : NULL,
                                    .context = linear,
                                    .threads = linear->solid->threads};
    gneiss_status status = gn_eigen_largest_of(&system, tolerance, mode, &top, error);
    if (status == GNEISS_OK) {
        limit->iterations = top.vectors;
        limit->frequency = sqrt(top.value);
        limit->sharp = fmax(2.0 / limit->frequency, limit->bound);
        limit->sharp_low = fmax(2.0 / sqrt(top.value + top.residual), limit->bound);
        find_culprits(linear, mode, limit);
    }
    gn_free(mode);
    return status;
}

/* --- both --- */

static void set_scale(linear_system *system, bool whole) {
    const gn_fem_solid *solid = system->solid;
    const size_t d = (size_t)system->dimension;
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (size_t i = 0; i < d; i++) {
            int32_t slot = solid->nodes.slot[n];
            bool fixed = slot >= 0 && solid->prescribed.mask[slot] >> i & 1;
            double inverse = whole ? solid->nodes.vel[4 * n + 3] : gn_fem_own_inverse(solid, n);
            system->scale[d * n + i] = fixed ? 0.0 : sqrt(inverse);
        }
}

static bool make_pressure(linear_system *system) {
    size_t nodes = system->solid->nodes.soa.count;
    if (system->solid->form != GN_FEM_PRESSURE) return true;
    system->gradient = gn_alloc_array(nodes + 1, 4 * sizeof *system->gradient);
    system->pressure = gn_alloc_array(nodes + 1, sizeof *system->pressure);
    return system->gradient && system->pressure;
}

gneiss_status gn_fem_linear_begin(gn_fem_solid *solid, bool whole, linear_system *system,
                                  gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count, d = (size_t)solid->dimension;
    *system = (linear_system){.solid = solid, .dimension = solid->dimension};
    system->strains = solid->dimension == 3 ? 6 : 3;
    system->scale = gn_alloc_array(nodes + 1, d * sizeof *system->scale);
    system->moved = gn_alloc_array(nodes + 1, d * sizeof *system->moved);
    system->stiffness = gn_alloc_array(nodes + 1, sizeof *system->stiffness);
    if (!system->scale || !system->moved || !system->stiffness || !make_pressure(system)) {
        gn_fem_linear_free(system);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the time step of %zu nodes",
                       nodes);
    }
    set_scale(system, whole);
    return GNEISS_OK;
}

gneiss_status gn_fem_linear_make(gn_fem_solid *solid, bool whole, linear_system *system,
                                 gneiss_error *error) {
    GN_TRY(gn_fem_linear_begin(solid, whole, system, error));
    gn_fem_sum_stiffness(system);
    return GNEISS_OK;
}

void gn_fem_linear_free(linear_system *system) {
    void *blocks[] = {system->scale, system->moved, system->stiffness, system->gradient,
                      system->pressure};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *system = (linear_system){0};
}

gn_fem_limit gn_fem_limit_none(void) {
    return (gn_fem_limit){.bound = INFINITY,
                          .bound_element = -1,
                          .sharp = INFINITY,
                          .sharp_low = INFINITY,
                          .sharp_element = -1,
                          .sharp_node = -1};
}

static gneiss_status limits(gn_fem_solid *solid, bool sharp, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error) {
    linear_system y;
    *limit = gn_fem_limit_none();
    GN_TRY(gn_fem_linear_make(solid, false, &y, error));
    gneiss_status status = gn_fem_find_bound(&y, limit, error);
    if (status == GNEISS_OK && sharp && limit->bound < INFINITY)
        status = find_sharp(&y, tolerance, limit, error);
    gn_fem_linear_free(&y);
    return status;
}

gneiss_status gn_fem_limits(gn_fem_solid *solid, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error) {
    return limits(solid, true, tolerance, limit, error);
}

gneiss_status gn_fem_bound(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error) {
    return limits(solid, false, 0.0, limit, error);
}
