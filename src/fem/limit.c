/* The largest stable step of the solid linearised at its start: dt = 2/w_max, w_max^2 the largest
 * eigenvalue of M^-1 K.
 *
 * Bound: let the mass of every node be dealt out to its elements in any way, M = sum_e M_e. Then
 * u.K u = sum_e u.K_e u <= max_e lambda_max(M_e^-1 K_e) sum_e u.M_e u, so that the largest element
 * eigenvalue bounds w_max^2 (Irons & Treharne 1971; Hughes 1987, The Finite Element Method, sec.
 * 9.1). It holds for every way of dealing; two are taken and the better result counts: each element
 * has its own mass, or each node gives to its elements by their stiffness at it, which is what a
 * small element among large ones needs. Prescribed components have infinite mass.
 *
 * With the strains' matrix B and the stiffness D of the material K_e = V B^T D B, and K_e has the
 * eigenvalues of V D^1/2 B M_e^-1 B^T D^1/2: three in 2D, six in 3D. Strains are in Mandel's
 * notation (shear times sqrt 2), in which D = 2 mu I + lambda m m^T with m = (1 1 1 0 0 0). */
#include "base/eigen.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/internal.h"

#include <math.h>
#include <string.h>

typedef gn_fem_linear linear_system;

void gn_fem_gradients(const gn_elements *q, size_t e, double gradient[4][3]) {
    const int d = gn_elements_dimension(q);
    memset(gradient, 0, 12 * sizeof(double));
    for (int a = 1; a <= d; a++)
        for (int k = 0; k < d; k++) {
            gradient[a][k] = gn_elements_gradient(q, a, k)[e];
            gradient[0][k] -= gradient[a][k];
        }
}

/* --- bound --- */

/* Trace of an element's stiffness at a node: V [(lambda + mu) G (x) G + mu |G|^2 I]. */
static double node_stiffness(const gn_elements *q, size_t e, int d, const double gradient[3]) {
    double size2 = 0.0;
    for (int k = 0; k < d; k++) size2 += gradient[k] * gradient[k];
    return q->volume[e] * size2 * (q->lambda[e] + (1 + d) * q->mu[e]);
}

static void sum_stiffness(linear_system *y) {
    const gn_elements *q = &y->solid->elements;
    double gradient[4][3];
    for (size_t e = 0; e < q->soa.count; e++) {
        gn_fem_gradients(q, e, gradient);
        for (int a = 0; a <= y->dimension; a++)
            y->stiffness[gn_elements_node(q, a)[e]] +=
                node_stiffness(q, e, y->dimension, gradient[a]);
    }
}

/* The column of Mandel strains of component i of a node. */
static void strain_column(int d, int i, const double gradient[3], double column[6]) {
    static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    static const int plane[3] = {0, 1, 3};
    for (int s = 0; s < (d == 3 ? 6 : 3); s++) {
        const int *p = pair[d == 3 ? s : plane[s]];
        double shear = p[0] == p[1] ? 1.0 : sqrt(0.5);
        column[s] = p[0] == i ? shear * gradient[p[1]] : p[1] == i ? shear * gradient[p[0]] : 0.0;
    }
}

/* a <- V D^1/2 a D^1/2: the root of D scales the mean of the normal strains and what differs from
 * it by the roots of 2 mu + d lambda and 2 mu. */
static void scale_by_material(const gn_elements *q, size_t e, int d, int n, double *a) {
    double shear = sqrt(2.0 * q->mu[e] * q->volume[e]);
    double bulk = sqrt((2.0 * q->mu[e] + d * q->lambda[e]) * q->volume[e]);
    for (int side = 0; side < 2; side++) {
        int along = side ? 1 : n, across = side ? n : 1; /* strides */
        for (int r = 0; r < n; r++) {
            double *v = a + r * across, mean = 0.0;
            for (int k = 0; k < d; k++) mean += v[k * along] / d;
            for (int k = 0; k < n; k++) v[k * along] *= shear;
            for (int k = 0; k < d; k++) v[k * along] += (bulk - shear) * mean;
        }
    }
}

/* Whether the largest eigenvalue of a positive semi-definite matrix may exceed `known`: the sum of
 * 8th powers of its eigenvalues, which is the square of Frobenius' norm of (a/known)^4, is then
 * above one. Spares most elements of an irregular mesh the search for eigenvalues. */
static bool may_exceed(int n, const double *a, double known) {
    double power[3][36], norm2 = 0.0;
    if (!(known > 0.0)) return true;
    for (int k = 0; k < n * n; k++) power[0][k] = a[k] / known;
    for (int k = 0; k < n * n; k++) norm2 += power[0][k] * power[0][k];
    if (norm2 < 1.0 - 1e-12) return false; /* so is the norm of its 4th power */
    norm2 = 0.0;
    for (int p = 1; p < 3; p++)
        for (int r = 0; r < n; r++)
            for (int s = 0; s < n; s++) {
                double sum = 0.0;
                for (int k = 0; k < n; k++)
                    sum += power[p - 1][n * r + k] * power[p - 1][n * k + s];
                power[p][n * r + s] = sum;
            }
    for (int k = 0; k < n * n; k++) norm2 += power[2][k] * power[2][k];
    return !(norm2 < 1.0 - 1e-12);
}

/* Largest eigenvalue of M_e^-1 K_e for one way of dealing out the masses; 0 if it is not above
 * `known`. */
static double element_eigenvalue(const linear_system *y, size_t e, bool by_stiffness,
                                 double known) {
    const gn_elements *q = &y->solid->elements;
    const gn_fem_solid *solid = y->solid;
    const int d = y->dimension, n = y->strains;
    double gradient[4][3], a[36] = {0.0}, values[6], vectors[36];
    gn_fem_gradients(q, e, gradient);
    for (int c = 0; c <= d; c++) {
        size_t node = (size_t)gn_elements_node(q, c)[e];
        double inverse = (d + 1) / (solid->density[q->material[e]] * q->volume[e]);
        if (by_stiffness)
            inverse = gn_fem_own_inverse(solid, node) * y->stiffness[node] /
                      node_stiffness(q, e, d, gradient[c]);
        for (int i = 0; i < d; i++) {
            if (y->scale[node * (size_t)d + (size_t)i] == 0.0) continue;
            double column[6];
            strain_column(d, i, gradient[c], column);
            for (int r = 0; r < n; r++)
                for (int s = 0; s < n; s++) a[n * r + s] += inverse * column[r] * column[s];
        }
    }
    scale_by_material(q, e, d, n, a);
    if (!may_exceed(n, a, known)) return 0.0;
    gn_eigen_symmetric(n, a, values, vectors);
    return values[0];
}

enum { ELEMENT_BLOCK = 1024 };

typedef struct worst {
    double value;
    int64_t element;
} worst;

/* Pressure form: what the stabilising pressure alone would do, see linear_pressure.c. */
static double stabiliser_eigenvalue(const linear_system *y, size_t e) {
    if (y->solid->form != GN_FEM_PRESSURE) return 0.0;
    return y->solid->rate2 * (1.0 + gn_fem_stabiliser_eigenvalue(&y->solid->elements, e));
}

static worst worst_of_block(const linear_system *y, size_t begin, size_t end, bool by_stiffness,
                            double known) {
    worst w = {known, -1};
    for (size_t e = begin; e < end; e++) {
        double value = element_eigenvalue(y, e, by_stiffness, w.value);
        value = fmax(value, stabiliser_eigenvalue(y, e));
        if (value > w.value) w = (worst){value, (int64_t)e};
    }
    return w;
}

/* Of all elements, if it is above `known`; else -1 and that. */
static worst worst_of_all(const linear_system *y, bool by_stiffness, double known, worst *all) {
    const size_t count = y->solid->elements.soa.count;
    const size_t blocks = (count + ELEMENT_BLOCK - 1) / ELEMENT_BLOCK;
    worst w = {known, -1};
#pragma omp parallel for num_threads(y->solid->threads) schedule(static)
    for (size_t b = 0; b < blocks; b++) {
        size_t end = (b + 1) * ELEMENT_BLOCK < count ? (b + 1) * ELEMENT_BLOCK : count;
        all[b] = worst_of_block(y, b * ELEMENT_BLOCK, end, by_stiffness, known);
    }
    for (size_t b = 0; b < blocks; b++)
        if (all[b].value > w.value) w = all[b];
    return w;
}

/* `guess`: an eigenvalue that some element will be above; if none is, all are looked at again. */
static gneiss_status find_bound(const linear_system *y, double guess, gn_fem_limit *limit,
                                gneiss_error *error) {
    const size_t blocks = (y->solid->elements.soa.count + ELEMENT_BLOCK - 1) / ELEMENT_BLOCK;
    worst *all = gn_alloc_array(blocks + 1, sizeof *all), best = {INFINITY, -1};
    if (!all) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the time step's bound");
    for (int way = 0; way < 2; way++) {
        worst w = worst_of_all(y, way == 1, guess, all);
        if (w.element < 0 && guess > 0.0) w = worst_of_all(y, way == 1, 0.0, all);
        if (w.value < best.value) best = w;
    }
    gn_free(all);
    limit->bound = best.value > 0.0 ? 2.0 / sqrt(best.value) : INFINITY;
    limit->bound_element = best.element >= 0 ? y->solid->elements.id[best.element] : -1;
    return GNEISS_OK;
}

/* --- sharp --- */

/* Forces K u of one element and its energy u.K u/2. */
static double linear_element(const linear_system *y, size_t e, const double *u,
                             double force[4][3]) {
    const gn_elements *q = &y->solid->elements;
    const int d = y->dimension;
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

static void linear_block(const linear_system *y, size_t block) {
    const gn_partials *q = &y->solid->partials;
    const size_t nodes = (size_t)y->dimension + 1;
    double *row = q->row + 4 * (size_t)q->first[block], force[4][3];
    memset(row, 0, 4 * (size_t)(q->first[block + 1] - q->first[block]) * sizeof *row);
    size_t end = (block + 1) * q->length;
    if (end > y->solid->elements.soa.count) end = y->solid->elements.soa.count;
    for (size_t e = block * q->length; e < end; e++) {
        linear_element(y, e, y->moved, force);
        for (size_t a = 0; a < nodes; a++)
            for (int i = 0; i < y->dimension; i++) row[q->place[nodes * e + a] + i] += force[a][i];
    }
}

/* So few nodes are no work to share out. */
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

static void find_culprits(const linear_system *y, const double *mode, gn_fem_limit *limit) {
    const size_t d = (size_t)y->dimension;
    double most = -1.0, force[4][3];
    for (size_t n = 0; n < y->solid->nodes.soa.count; n++) {
        double share = 0.0;
        for (size_t i = 0; i < d; i++) {
            share += mode[d * n + i] * mode[d * n + i];
            y->moved[d * n + i] = y->scale[d * n + i] * mode[d * n + i];
        }
        if (share <= most) continue;
        most = share;
        limit->sharp_node = y->solid->nodes.id[n];
    }
    most = -1.0;
    for (size_t e = 0; e < y->solid->elements.soa.count; e++) {
        double energy = linear_element(y, e, y->moved, force);
        if (energy <= most) continue;
        most = energy;
        limit->sharp_element = y->solid->elements.id[e];
    }
}

static gneiss_status find_sharp(const linear_system *y, double tolerance, gn_fem_limit *limit,
                                gneiss_error *error) {
    const bool pressure = y->solid->form == GN_FEM_PRESSURE;
    size_t n = y->solid->nodes.soa.count * (size_t)(y->dimension + pressure);
    double *mode = gn_alloc_array(n + 1, sizeof *mode);
    if (!mode) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the fastest mode");
    /* What cannot move stays out of it. */
    for (size_t k = 0; k < n; k++) mode[k] = gn_random_symmetric(1, k);
    for (size_t k = 0; k < y->solid->nodes.soa.count * (size_t)y->dimension; k++)
        if (!(y->scale[k] > 0.0)) mode[k] = 0.0;
    gn_eigen_top top;
    gneiss_status status = gn_eigen_largest_in(
        n, pressure ? gn_fem_linear_pressure : gn_fem_linear_apply,
        pressure ? gn_fem_linear_metric : NULL, y, tolerance, y->solid->threads, mode, &top, error);
    if (status == GNEISS_OK) {
        limit->iterations = top.vectors;
        limit->frequency = sqrt(top.value);
        limit->sharp = fmax(2.0 / limit->frequency, limit->bound);
        limit->sharp_low = fmax(2.0 / sqrt(top.value + top.residual), limit->bound);
        find_culprits(y, mode, limit);
    }
    gn_free(mode);
    return status;
}

/* --- both --- */

static void set_scale(linear_system *y, bool whole) {
    const gn_fem_solid *solid = y->solid;
    const size_t d = (size_t)y->dimension;
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (size_t i = 0; i < d; i++) {
            int32_t slot = solid->nodes.slot[n];
            bool fixed = slot >= 0 && solid->prescribed.mask[slot] >> i & 1;
            double inverse = whole ? solid->nodes.vel[4 * n + 3] : gn_fem_own_inverse(solid, n);
            y->scale[d * n + i] = fixed ? 0.0 : sqrt(inverse);
        }
}

static bool make_pressure(linear_system *y) {
    size_t nodes = y->solid->nodes.soa.count;
    if (y->solid->form != GN_FEM_PRESSURE) return true;
    y->gradient = gn_alloc_array(nodes + 1, 4 * sizeof *y->gradient);
    y->pressure = gn_alloc_array(nodes + 1, sizeof *y->pressure);
    return y->gradient && y->pressure;
}

gneiss_status gn_fem_linear_make(gn_fem_solid *solid, bool whole, linear_system *y,
                                 gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count, d = (size_t)solid->dimension;
    *y = (linear_system){.solid = solid, .dimension = solid->dimension};
    y->strains = solid->dimension == 3 ? 6 : 3;
    y->scale = gn_alloc_array(nodes + 1, d * sizeof *y->scale);
    y->moved = gn_alloc_array(nodes + 1, d * sizeof *y->moved);
    y->stiffness = gn_alloc_array(nodes + 1, sizeof *y->stiffness);
    if (!y->scale || !y->moved || !y->stiffness || !make_pressure(y)) {
        gn_fem_linear_free(y);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the time step of %zu nodes",
                       nodes);
    }
    set_scale(y, whole);
    sum_stiffness(y);
    return GNEISS_OK;
}

void gn_fem_linear_free(linear_system *y) {
    void *blocks[] = {y->scale, y->moved, y->stiffness, y->gradient, y->pressure};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *y = (linear_system){0};
}

static gneiss_status limits(gn_fem_solid *solid, bool sharp, double tolerance, double guess,
                            gn_fem_limit *limit, gneiss_error *error) {
    linear_system y;
    *limit = (gn_fem_limit){.bound = INFINITY,
                            .bound_element = -1,
                            .sharp = INFINITY,
                            .sharp_low = INFINITY,
                            .sharp_element = -1,
                            .sharp_node = -1};
    GN_TRY(gn_fem_linear_make(solid, false, &y, error));
    gneiss_status status = find_bound(&y, guess, limit, error);
    if (status == GNEISS_OK && sharp && limit->bound < INFINITY)
        status = find_sharp(&y, tolerance, limit, error);
    gn_fem_linear_free(&y);
    return status;
}

gneiss_status gn_fem_limits(gn_fem_solid *solid, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error) {
    return limits(solid, true, tolerance, 0.0, limit, error);
}

gneiss_status gn_fem_bound(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error) {
    return limits(solid, false, 0.0, 0.0, limit, error);
}

gneiss_status gn_fem_bound_again(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error) {
    const bool known = limit->bound > 0.0 && limit->bound < INFINITY;
    const double guess = known ? 0.999 * 4.0 / (limit->bound * limit->bound) : 0.0;
    return limits(solid, false, 0.0, guess, limit, error);
}
