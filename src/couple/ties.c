#include "couple/ties.h"

#include "base/memory.h"
#include "base/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static gneiss_status no_memory(size_t count, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to find %zu particles in elements",
                   count);
}

/* --- elements by cells of a grid --- */

typedef struct grid {
    int dimension;
    double lower[3], cell; /* m */
    int64_t cells[3];
    int32_t *first, *element; /* [cells + 1]; elements whose boxes intersect a cell, ascending */
} grid;

typedef struct extent {
    double lower[3], upper[3];
} extent;

static extent extent_of(const gn_fem_solid *solid, size_t e) {
    extent x = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int a = 0; a <= solid->dimension; a++) {
        const double *p = solid->nodes.start + 4 * (size_t)gn_elements_node(&solid->elements, a)[e];
        for (int k = 0; k < solid->dimension; k++) {
            x.lower[k] = fmin(x.lower[k], p[k]);
            x.upper[k] = fmax(x.upper[k], p[k]);
        }
    }
    return x;
}

static int64_t cell_of(const grid *cells, int axis, double x) {
    double at = floor((x - cells->lower[axis]) / cells->cell);
    if (!(at > 0.0)) return 0;
    return at < (double)cells->cells[axis] ? (int64_t)at : cells->cells[axis] - 1;
}

static size_t index_of(const grid *cells, int64_t x, int64_t y, int64_t z) {
    return (size_t)((z * cells->cells[1] + y) * cells->cells[0] + x);
}

/* Chooses the size of the cells by the mean size of an element, so that few elements are in a cell
 * and an element is in few cells; cells are larger if there would be many more cells than elements.
 */
static void lay_out(const gn_fem_solid *solid, grid *cells) {
    const size_t count = solid->elements.soa.count;
    double upper[3] = {0.0}, sum = 0.0;
    for (int k = 0; k < 3; k++) cells->lower[k] = INFINITY;
    for (size_t e = 0; e < count; e++) {
        extent x = extent_of(solid, e);
        for (int k = 0; k < cells->dimension; k++) {
            cells->lower[k] = fmin(cells->lower[k], x.lower[k]);
            upper[k] = e ? fmax(upper[k], x.upper[k]) : x.upper[k];
            sum += (x.upper[k] - x.lower[k]) / (double)(count * (size_t)cells->dimension);
        }
    }
    double volume = 1.0;
    for (int k = 0; k < cells->dimension; k++) volume *= upper[k] - cells->lower[k] + sum;
    cells->cell = fmax(sum, pow(volume / (4.0 * (double)count), 1.0 / cells->dimension));
    for (int k = 0; k < 3; k++)
        cells->cells[k] = k < cells->dimension
                              ? 1 + (int64_t)floor((upper[k] - cells->lower[k]) / cells->cell)
                              : 1;
}

/* Counts the elements of each cell, or, with `fill`, lists them. */
static void visit(const gn_fem_solid *solid, grid *cells, bool fill) {
    for (size_t e = 0; e < solid->elements.soa.count; e++) {
        extent x = extent_of(solid, e);
        int64_t from[3] = {0}, to[3] = {0};
        for (int k = 0; k < cells->dimension; k++) {
            from[k] = cell_of(cells, k, x.lower[k] - 1e-6 * cells->cell);
            to[k] = cell_of(cells, k, x.upper[k] + 1e-6 * cells->cell);
        }
        for (int64_t i = from[2]; i <= to[2]; i++)
            for (int64_t j = from[1]; j <= to[1]; j++)
                for (int64_t k = from[0]; k <= to[0]; k++) {
                    size_t at = index_of(cells, k, j, i);
                    if (fill)
                        cells->element[cells->first[at + 1]++] = (int32_t)e;
                    else
                        cells->first[at + 2]++;
                }
    }
}

static void free_grid(grid *cells) {
    gn_free(cells->first);
    gn_free(cells->element);
}

static gneiss_status make_grid(const gn_fem_solid *solid, grid *lattice, gneiss_error *error) {
    *lattice = (grid){.dimension = solid->dimension};
    lay_out(solid, lattice);
    size_t cells = (size_t)(lattice->cells[0] * lattice->cells[1] * lattice->cells[2]);
    lattice->first = gn_alloc_array(cells + 3, sizeof *lattice->first);
    if (!lattice->first) return no_memory(cells, error);
    visit(solid, lattice, false);
    for (size_t k = 2; k < cells + 2; k++) lattice->first[k] += lattice->first[k - 1];
    lattice->element =
        gn_alloc_array((size_t)lattice->first[cells + 1] + 1, sizeof *lattice->element);
    if (!lattice->element) {
        free_grid(lattice);
        return no_memory(cells, error);
    }
    visit(solid, lattice,
          true); /* counted two places ahead, so that filling leaves the starts in their places */
    return GNEISS_OK;
}

/* --- a particle in an element --- */

/* Evaluates the shape functions of an element at a position; returns the smallest one, which is
 * negative outside. */
static double shapes_at(const gn_fem_solid *solid, size_t e, const double *x, double shape[4]) {
    const gn_elements *q = &solid->elements;
    const double *origin = solid->nodes.start + 4 * (size_t)gn_elements_node(q, 0)[e];
    double least;
    shape[0] = 1.0;
    shape[3] = 0.0;
    for (int a = 1; a <= solid->dimension; a++) {
        shape[a] = 0.0;
        for (int k = 0; k < solid->dimension; k++)
            shape[a] += gn_elements_gradient(q, a, k)[e] * (x[k] - origin[k]);
        shape[0] -= shape[a];
    }
    least = shape[0];
    for (int a = 1; a <= solid->dimension; a++) least = fmin(least, shape[a]);
    return least;
}

/* Tolerance of rounding within which points count as inside. */
static const double inside_rounding = -1e-9;

/* Finds the element whose smallest shape function at a position is the largest; returns false if no
 * element contains the position. */
static bool find(const gn_fem_solid *solid, const grid *cells, const double *x, gn_tie *tie) {
    int64_t at[3] = {0};
    double deepest = -INFINITY;
    for (int k = 0; k < cells->dimension; k++) at[k] = cell_of(cells, k, x[k]);
    size_t cell = index_of(cells, at[0], at[1], at[2]);
    for (int32_t c = cells->first[cell]; c < cells->first[cell + 1]; c++) {
        double shape[4];
        double depth = shapes_at(solid, (size_t)cells->element[c], x, shape);
        if (depth < inside_rounding || depth <= deepest) continue;
        deepest = depth;
        tie->element = cells->element[c];
        memcpy(tie->shape, shape, sizeof shape);
    }
    if (!(deepest >= inside_rounding)) return false;
    for (int a = 0; a <= solid->dimension; a++)
        tie->node[a] = gn_elements_node(&solid->elements, a)[tie->element];
    return true;
}

/* --- all ties --- */

static int by_id(const void *a, const void *b) {
    const gn_tie *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static gneiss_status list_nodes(const gn_fem_solid *solid, gn_ties *ties, gneiss_error *error) {
    const size_t all = solid->nodes.soa.count;
    int32_t *count = gn_alloc_array(all + 2, sizeof *count);
    ties->node = gn_alloc_array(all + 1, sizeof *ties->node);
    ties->first = gn_alloc_array(all + 2, sizeof *ties->first);
    ties->share = gn_alloc_array(ties->count * (size_t)ties->corners + 1, sizeof *ties->share);
    if (!count || !ties->node || !ties->first || !ties->share) {
        gn_free(count);
        return no_memory(ties->count, error);
    }
    for (size_t k = 0; k < ties->count; k++)
        for (int a = 0; a < ties->corners; a++) count[ties->tie[k].node[a]]++;
    for (size_t n = 0; n < all; n++) {
        if (!count[n]) continue;
        ties->first[ties->nodes + 1] = ties->first[ties->nodes] + count[n];
        count[n] = ties->first[ties->nodes];
        ties->node[ties->nodes++] = (int32_t)n;
    }
    for (size_t k = 0; k < ties->count; k++)
        for (int a = 0; a < ties->corners; a++)
            ties->share[count[ties->tie[k].node[a]]++] = (gn_tie_share){(int32_t)k, a};
    for (size_t n = 0; n < ties->nodes; n++)
        for (int32_t s = ties->first[n]; s < ties->first[n + 1]; s++)
            ties->tie[ties->share[s].tie].own[ties->share[s].corner] = (int32_t)n;
    gn_free(count);
    return GNEISS_OK;
}

gneiss_status gn_ties_find(const gn_fem_solid *solid, const gn_particles *particles, gn_ties *ties,
                           gneiss_error *error) {
    grid g;
    *ties = (gn_ties){.corners = solid->dimension + 1};
    GN_TRY(make_grid(solid, &g, error));
    ties->tie = gn_alloc_array(particles->soa.count + 1, sizeof *ties->tie);
    for (size_t p = 0; ties->tie && p < particles->soa.count; p++) {
        gn_tie tie = {.id = particles->id[p]};
        if (find(solid, &g, particles->start + 4 * p, &tie)) ties->tie[ties->count++] = tie;
    }
    free_grid(&g);
    if (!ties->tie) return no_memory(particles->soa.count, error);
    qsort(ties->tie, ties->count, sizeof *ties->tie, by_id);
    gneiss_status status = list_nodes(solid, ties, error);
    if (status != GNEISS_OK) gn_ties_free(ties);
    return status;
}

gn_tie gn_tie_at(const gn_fem_solid *solid, int32_t element, const double *place) {
    gn_tie tie = {.id = -1, .element = element};
    shapes_at(solid, (size_t)element, place, tie.shape);
    for (int a = 0; a <= solid->dimension; a++)
        tie.node[a] = gn_elements_node(&solid->elements, a)[element];
    return tie;
}

gneiss_status gn_ties_take(const gn_fem_solid *solid, const gn_particles *particles,
                           const int32_t *element, gn_ties *ties, gneiss_error *error) {
    const size_t count = particles->soa.count;
    size_t ids = 0, tied = 0;
    *ties = (gn_ties){.corners = solid->dimension + 1};
    for (size_t p = 0; p < count; p++) {
        tied += element[p] >= 0;
        if (element[p] >= 0 && (size_t)particles->id[p] >= ids) ids = (size_t)particles->id[p] + 1;
    }
    ties->tie = gn_alloc_array(tied + 1, sizeof *ties->tie);
    int32_t *after = gn_alloc_array(ids + 1, sizeof *after); /* [id] 1 + index of the particle */
    if (!ties->tie || !after) {
        gn_free(after);
        gn_ties_free(ties);
        return no_memory(tied, error);
    }
    for (size_t p = 0; p < count; p++)
        if (element[p] >= 0) after[particles->id[p]] = (int32_t)p + 1;
    for (size_t id = 0; id < ids; id++) {
        const size_t p = (size_t)after[id] - 1;
        if (!after[id]) continue;
        ties->tie[ties->count] = gn_tie_at(solid, element[p], particles->start + 4 * p);
        ties->tie[ties->count++].id = (int32_t)id;
    }
    gn_free(after);
    gneiss_status status = list_nodes(solid, ties, error);
    if (status != GNEISS_OK) gn_ties_free(ties);
    return status;
}

/* The gradient of node a is normal to the opposite face: the gradients are rows of the inverse
 * matrix of edges. */
void gn_tie_gradients(const gn_ties *ties, size_t k, const gn_particles *nodes, double g[4][3]) {
    double edge[3][3] = {{0.0}, {0.0}, {0.0, 0.0, 1.0}}, det = 0.0;
    const double *first = nodes->pos + 4 * (size_t)ties->tie[k].node[0];
    for (int a = 1; a < ties->corners; a++)
        for (int c = 0; c < ties->corners - 1; c++)
            edge[a - 1][c] = nodes->pos[4 * (size_t)ties->tie[k].node[a] + (size_t)c] - first[c];
    memset(g, 0, 12 * sizeof(double));
    for (int a = 0; a < 3; a++) gn_cross3(edge[(a + 1) % 3], edge[(a + 2) % 3], g[a + 1]);
    for (int c = 0; c < 3; c++) det += edge[0][c] * g[1][c];
    for (int a = 1; a <= 3; a++)
        for (int c = 0; c < 3; c++) {
            g[a][c] = a < ties->corners ? g[a][c] / det : 0.0;
            g[0][c] -= g[a][c];
        }
}

void gn_ties_free(gn_ties *ties) {
    gn_free(ties->tie);
    gn_free(ties->node);
    gn_free(ties->first);
    gn_free(ties->share);
    *ties = (gn_ties){0};
}
