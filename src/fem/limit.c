/* The largest stable step of the solid linearised at its start: dt = 2/w_max, with w_max^2 the
 * largest eigenvalue of M^-1 K. Its bound follows. */
#include "fem/internal.h"

#include "base/eigen.h"
#include "base/new.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

/* ---- a bound of the largest stable step, 2/w_max, of the solid linearised at its start.  Let the
 * mass of every node be distributed to its elements in any way, M = sum_e M_e. Then u.K u = sum_e
 * u.K_e u <= max_e lambda_max(M_e^-1 K_e) sum_e u.M_e u, so that the largest element eigenvalue
 * bounds w_max^2 (Irons & Treharne 1971; Hughes 1987, The Finite Element Method, sec. 9.1). It
 * holds for every distribution; two are evaluated and the better result is used: each element has
 * its own mass, or each node's mass is distributed by the elements' stiffnesses at it, which serves
 * a small element among large ones. Prescribed components have infinite mass.  With the strain
 * matrix B and the stiffness D of the material, K_e = V B^T D B, and K_e has the eigenvalues of V
 * D^1/2 B M_e^-1 B^T D^1/2: three in 2D, six in 3D. Strains are in Mandel's notation (shear times
 * sqrt 2), in which D = 2 mu I + lambda m m^T with m = (1 1 1 0 0 0) ---- */

typedef gn_fem_linear linear_system;

/* Returns the trace of an element's stiffness at a node, V [(lambda + mu) G (x) G + mu |G|^2 I]. */
static double node_stiffness(const gn_elements *elements, size_t e, int d,
                             const double gradient[3]) {
    double size2 = 0.0;
    for (int k = 0; k < d; k++) size2 += gradient[k] * gradient[k];
    return elements->volume[e] * size2 * (elements->lambda[e] + (1 + d) * elements->mu[e]);
}

/* Fills system->stiffness. */
static void sum_stiffness(linear_system *system) {
    const gn_elements *q = &system->solid->elements;
    double gradient[4][3];
    for (size_t e = 0; e < q->soa.count; e++) {
        gn_fem_gradients(q, e, gradient);
        for (int a = 0; a <= system->dimension; a++)
            system->stiffness[gn_elements_node(q, a)[e]] +=
                node_stiffness(q, e, system->dimension, gradient[a]);
    }
}

/* Computes the column of Mandel strains of component i of a node. */
static void strain_column(int d, int i, const double gradient[3], double column[6]) {
    static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
    static const int plane[3] = {0, 1, 3};
    for (int s = 0; s < (d == 3 ? 6 : 3); s++) {
        const int *p = pair[d == 3 ? s : plane[s]];
        double shear = p[0] == p[1] ? 1.0 : sqrt(0.5);
        column[s] = p[0] == i ? shear * gradient[p[1]] : p[1] == i ? shear * gradient[p[0]] : 0.0;
    }
}

/* Replaces a by V D^1/2 a D^1/2: the root of D multiplies the mean of the normal strains by the
 * root of 2 mu + d lambda, and the rest by the root of 2 mu. */
static void scale_by_material(const gn_elements *elements, size_t e, int d, int n, double *a) {
    double shear = sqrt(2.0 * elements->mu[e] * elements->volume[e]);
    double bulk = sqrt((2.0 * elements->mu[e] + d * elements->lambda[e]) * elements->volume[e]);
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

/* Tells whether the largest eigenvalue of a positive semi-definite matrix may exceed `known`: in
 * that case the sum of the 8th powers of the eigenvalues of a/known, which is the squared Frobenius
 * norm of (a/known)^4, is above one. This saves the search for eigenvalues for most elements of an
 * irregular mesh. */
static bool may_exceed(int n, const double *a, double known) {
    double power[3][36], norm2 = 0.0;
    if (!(known > 0.0)) return true;
    for (int k = 0; k < n * n; k++) power[0][k] = a[k] / known;
    for (int k = 0; k < n * n; k++) norm2 += power[0][k] * power[0][k];
    if (norm2 < 1.0 - 1e-12) return false; /* then the norm of the 4th power is below 1 as well */
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

/* Returns the largest eigenvalue of M_e^-1 K_e for one distribution of the masses; 0 if it is not
 * above `known`. */
static double element_eigenvalue(const linear_system *system, size_t e, bool by_stiffness,
                                 double known) {
    const gn_elements *q = &system->solid->elements;
    const gn_fem_solid *solid = system->solid;
    const int d = system->dimension, n = system->strains;
    double gradient[4][3], a[36] = {0.0}, values[6], vectors[36];
    gn_fem_gradients(q, e, gradient);
    for (int c = 0; c <= d; c++) {
        size_t node = (size_t)gn_elements_node(q, c)[e];
        double inverse = (d + 1) / (solid->density[q->material[e]] * q->volume[e]);
        if (by_stiffness)
            inverse = gn_fem_own_inverse(solid, node) * system->stiffness[node] /
                      node_stiffness(q, e, d, gradient[c]);
        for (int i = 0; i < d; i++) {
            if (system->scale[node * (size_t)d + (size_t)i] == 0.0) continue;
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

/* Returns the eigenvalue of the stabilising pressure alone, in the pressure form; see pressure.c.
 */
static double stabiliser_eigenvalue(const linear_system *system, size_t e) {
    if (system->solid->form != GN_FEM_PRESSURE) return 0.0;
    return system->solid->rate2 * (1.0 + gn_fem_stabiliser_eigenvalue(&system->solid->elements, e));
}

static worst worst_of_block(const linear_system *system, size_t begin, size_t end,
                            bool by_stiffness, double known) {
    worst w = {known, -1};
    for (size_t e = begin; e < end; e++) {
        double value = element_eigenvalue(system, e, by_stiffness, w.value);
        value = fmax(value, stabiliser_eigenvalue(system, e));
        if (value > w.value) w = (worst){value, (int64_t)e};
    }
    return w;
}

static worst worst_of_all(const linear_system *system, bool by_stiffness, worst *all) {
    const size_t count = system->solid->elements.soa.count;
    const size_t blocks = (count + ELEMENT_BLOCK - 1) / ELEMENT_BLOCK;
    worst w = {0.0, -1};
#pragma omp parallel for num_threads(system->solid->threads) schedule(static)
    for (size_t b = 0; b < blocks; b++) {
        size_t end = (b + 1) * ELEMENT_BLOCK < count ? (b + 1) * ELEMENT_BLOCK : count;
        all[b] = worst_of_block(system, b * ELEMENT_BLOCK, end, by_stiffness, 0.0);
    }
    for (size_t b = 0; b < blocks; b++)
        if (all[b].value > w.value) w = all[b];
    return w;
}

static void set_limit(const linear_system *system, worst best, gn_fem_limit *limit) {
    limit->bound = best.value > 0.0 ? 2.0 / sqrt(best.value) : INFINITY;
    limit->bound_element = best.element >= 0 ? system->solid->elements.id[best.element] : -1;
}

/* Computes the bound and the element that determines it. */
static gneiss_status find_bound(const linear_system *system, gn_fem_limit *limit,
                                gneiss_error *error) {
    const size_t blocks = (system->solid->elements.soa.count + ELEMENT_BLOCK - 1) / ELEMENT_BLOCK;
    worst best = {INFINITY, -1};
    GN_FREED worst *all = NULL;
    GN_TRY(gn_new(&all, blocks, "blocks of elements", error));
    for (int way = 0; way < 2; way++) {
        worst w = worst_of_all(system, way == 1, all);
        if (w.value < best.value) best = w;
    }
    set_limit(system, best, limit);
    return GNEISS_OK;
}

/* --- repeated bounds ---
 *
 * When elements are removed from a body now and then, a few at a time, the
 * eigenvalues of the elements near the largest are stored, and the others are known to be below.
 * Only elements with a node whose mass or stiffness has changed are evaluated again. The result is
 * the same number as if all were evaluated. */

struct gn_fem_bound_cache {
    double floor[2]; /* 1/s2, for each distribution of masses: eigenvalues that are not stored are
                        at most this */
    double (*value)[2]; /* [elements of the mesh] stored eigenvalues; 0: not above `floor` */
    double *volume;     /* [elements of the mesh] m3 at the last evaluation; 0: removed */
    double *inverse;    /* [nodes] 1/kg at the last evaluation */
    double *stiffness;  /* [nodes] as in gn_fem_linear */
    uint8_t *seen;      /* [elements of the mesh] scratch */
    uint8_t *marked;    /* [nodes] scratch: nodes with a change */
};

void gn_fem_known_free(struct gn_fem_bound_cache *known) {
    if (!known) return;
    void *blocks[] = {known->value, known->volume, known->inverse, known->stiffness,
                      known->seen,  known->marked, known};
    for (size_t b = 0; b < sizeof blocks / sizeof *blocks; b++) gn_free(blocks[b]);
}

static struct gn_fem_bound_cache *known_create(gn_fem_solid *solid) {
    const size_t nodes = solid->nodes.soa.count + 1;
    const size_t elements = gn_fem_elements_of(&solid->mesh, solid->dimension)->count + 1;
    struct gn_fem_bound_cache *k = gn_alloc_array(1, sizeof *k);
    if (!k) return NULL;
    k->value = gn_alloc_array(elements, sizeof *k->value);
    k->volume = gn_alloc_array(elements, sizeof *k->volume);
    k->inverse = gn_alloc_array(nodes, sizeof *k->inverse);
    k->stiffness = gn_alloc_array(nodes, sizeof *k->stiffness);
    k->seen = gn_alloc(elements);
    k->marked = gn_alloc(nodes);
    if (k->value && k->volume && k->inverse && k->stiffness && k->seen && k->marked) return k;
    gn_fem_known_free(k);
    return NULL;
}

static void mark_corners(gn_fem_solid *solid, size_t id, uint8_t *marked) {
    const size_t corners = (size_t)solid->dimension + 1;
    const int32_t *node = gn_fem_elements_of(&solid->mesh, solid->dimension)->node + corners * id;
    for (size_t a = 0; a < corners; a++) marked[node[a]] = 1;
}

/* Marks the nodes of elements that were removed or have changed their volume, and nodes whose mass
 * has changed. */
static void mark_others(gn_fem_solid *solid, struct gn_fem_bound_cache *known) {
    const gn_elements *q = &solid->elements;
    const size_t nodes = solid->nodes.soa.count;
    const size_t all = gn_fem_elements_of(&solid->mesh, solid->dimension)->count;
    memset(known->marked, 0, nodes);
    memset(known->seen, 0, all);
    for (size_t e = 0; e < q->soa.count; e++) {
        const size_t id = (size_t)q->id[e];
        known->seen[id] = 1;
        if (known->volume[id] == q->volume[e]) continue;
        known->volume[id] = q->volume[e];
        mark_corners(solid, id, known->marked);
    }
    for (size_t id = 0; id < all; id++) {
        if (known->seen[id] || known->volume[id] == 0.0) continue;
        known->volume[id] = 0.0;
        mark_corners(solid, id, known->marked);
    }
    for (size_t n = 0; n < nodes; n++) {
        const double inverse = gn_fem_own_inverse(solid, n);
        if (known->inverse[n] != inverse) known->marked[n] = 1;
        known->inverse[n] = inverse;
    }
}

static bool is_marked(const gn_elements *elements, size_t e, int d, const uint8_t *marked) {
    bool any = false;
    for (int a = 0; a <= d; a++) any = any || marked[gn_elements_node(elements, a)[e]];
    return any;
}

/* Sums up the stiffness at nodes in the order of sum_stiffness. */
static void renew_stiffness(const gn_fem_solid *solid, struct gn_fem_bound_cache *known) {
    const gn_elements *q = &solid->elements;
    const int d = solid->dimension;
    double gradient[4][3];
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        if (known->marked[n]) known->stiffness[n] = 0.0;
    for (size_t e = 0; e < q->soa.count; e++) {
        if (!is_marked(q, e, d, known->marked)) continue;
        gn_fem_gradients(q, e, gradient);
        for (int a = 0; a <= d; a++) {
            const size_t n = (size_t)gn_elements_node(q, a)[e];
            if (known->marked[n]) known->stiffness[n] += node_stiffness(q, e, d, gradient[a]);
        }
    }
}

/* Computes the eigenvalues of all elements, or of those with a marked node. */
static void renew_values(const linear_system *system, struct gn_fem_bound_cache *known, int way,
                         bool all) {
    const gn_elements *q = &system->solid->elements;
#pragma omp parallel for num_threads(system->solid->threads) schedule(dynamic, ELEMENT_BLOCK)
    for (size_t e = 0; e < q->soa.count; e++) {
        if (!all && !is_marked(q, e, system->dimension, known->marked)) continue;
        const double value = element_eigenvalue(system, e, way == 1, known->floor[way]);
        known->value[q->id[e]][way] = value > known->floor[way] ? value : 0.0;
    }
}

static worst worst_known(const gn_fem_solid *solid, const struct gn_fem_bound_cache *known,
                         int way) {
    worst w = {0.0, -1};
    for (size_t e = 0; e < solid->elements.soa.count; e++) {
        const double value = known->value[solid->elements.id[e]][way];
        if (value > w.value) w = (worst){value, (int64_t)e};
    }
    return w;
}

/* Returns the largest eigenvalue for one distribution of masses. If all stored elements were
 * removed, `floor` is too high, and all other elements are evaluated. */
static worst renew_worst(const linear_system *system, struct gn_fem_bound_cache *known, int way,
                         bool all) {
    const double lower = 0.9, least = 1e-3 * known->floor[way];
    renew_values(system, known, way, all);
    worst w = worst_known(system->solid, known, way);
    while (w.element < 0 && known->floor[way] > 0.0 && system->solid->elements.soa.count) {
        known->floor[way] = known->floor[way] > least ? lower * known->floor[way] : 0.0;
        renew_values(system, known, way, true);
        w = worst_known(system->solid, known, way);
    }
    return w;
}

/* Returns a limit without a result. */
static gn_fem_limit limit_none(void) {
    return (gn_fem_limit){.bound = INFINITY,
                          .bound_element = -1,
                          .sharp = INFINITY,
                          .sharp_low = INFINITY,
                          .sharp_element = -1,
                          .sharp_node = -1};
}

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

/* Does the same as gn_fem_linear_make, but leaves `stiffness` zero. */
static gneiss_status linear_begin(gn_fem_solid *solid, bool whole, linear_system *system,
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

gneiss_status gn_fem_bound_update(gn_fem_solid *solid, gn_fem_limit *limit, gneiss_error *error) {
    if (solid->form == GN_FEM_PRESSURE || !(limit->bound < INFINITY))
        return gn_fem_bound(solid, limit, error);
    const bool first = !solid->bound_cache;
    if (first) solid->bound_cache = known_create(solid);
    linear_system y;
    struct gn_fem_bound_cache *k = solid->bound_cache;
    if (!k) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the time step's bound");
    for (int way = 0; first && way < 2; way++)
        k->floor[way] = 0.9 * 4.0 / (limit->bound * limit->bound);
    GN_TRY(linear_begin(solid, false, &y, error));
    mark_others(solid, k);
    renew_stiffness(solid, k);
    memcpy(y.stiffness, k->stiffness, solid->nodes.soa.count * sizeof *y.stiffness);
    worst best = {INFINITY, -1};
    for (int way = 0; way < 2; way++) {
        const worst w = renew_worst(&y, k, way, first);
        if (w.value < best.value) best = w;
    }
    *limit = limit_none();
    set_limit(&y, best, limit);
    gn_fem_linear_free(&y);
    return GNEISS_OK;
}

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

/* Number of nodes below which loops are not distributed over threads. */
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
    const size_t nodes = linear->solid->nodes.soa.count, d = (size_t)linear->dimension,
                 n = nodes * (d + pressure);
    GN_FREED double *mode = NULL;
    GN_TRY(gn_new(&mode, n, "components of the fastest mode", error));
    /* Fixed components have no part in the mode. */
    for (size_t k = 0; k < n; k++) mode[k] = gn_random_symmetric(1, k);
    for (size_t k = 0; k < nodes * d; k++)
        if (!(linear->scale[k] > 0.0)) mode[k] = 0.0;
    gn_eigen_top top;
    const gn_eigen_system system = {.n = n,
                                    .apply =
                                        pressure ? gn_fem_linear_pressure : gn_fem_linear_apply,
                                    .metric = pressure ? gn_fem_linear_metric : NULL,
                                    .context = linear,
                                    .threads = linear->solid->threads};
    GN_TRY(gn_eigen_largest(&system, tolerance, mode, &top, error));
    limit->iterations = top.vectors;
    limit->frequency = sqrt(top.value);
    limit->sharp = fmax(2.0 / limit->frequency, limit->bound);
    limit->sharp_low = fmax(2.0 / sqrt(top.value + top.residual), limit->bound);
    find_culprits(linear, mode, limit);
    return GNEISS_OK;
}

/* --- both --- */

gneiss_status gn_fem_linear_make(gn_fem_solid *solid, bool whole, linear_system *system,
                                 gneiss_error *error) {
    GN_TRY(linear_begin(solid, whole, system, error));
    sum_stiffness(system);
    return GNEISS_OK;
}

void gn_fem_linear_free(linear_system *system) {
    void *blocks[] = {system->scale, system->moved, system->stiffness, system->gradient,
                      system->pressure};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *system = (linear_system){0};
}

static gneiss_status limits(gn_fem_solid *solid, bool sharp, double tolerance, gn_fem_limit *limit,
                            gneiss_error *error) {
    linear_system y;
    *limit = limit_none();
    GN_TRY(gn_fem_linear_make(solid, false, &y, error));
    gneiss_status status = find_bound(&y, limit, error);
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
