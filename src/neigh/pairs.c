#include "neigh/neigh.h"

#include "base/memory.h"
#include "soa/particle_state.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LEVELS = 32 };

/* One cell grid for particles with radii in (r/2, r]. */
typedef struct grid {
    double cell[3];    /* width of a cell */
    int64_t cells[3];  /* along each axis */
    size_t count;      /* particles */
    int32_t *start;    /* [cells + 1] */
    int32_t *particle; /* [count] sorted by cell, ascending within a cell */
    /* [count] x, y, z and r of these particles, so that a cell is tested in vectors */
    double *column[4];
} grid;

typedef struct search {
    const gn_pair_query *query;
    double lower[3], extent[3];
    double radius_max;
    grid grids[MAX_LEVELS];
    uint8_t *level; /* [particles] */
} search;

/* The pairs found by one thread. */
typedef struct bucket {
    size_t count, capacity;
    int32_t (*pair)[2];
} bucket;

static bool removed(const gn_particles *particles, size_t k) {
    return !gn_particle_is_active(particles, k);
}

/* Tells whether the box is periodic along axis a, so that its two sides there are one plane. */
static bool has_sides(const gn_pair_query *query, int a) {
    return query->periodic && a < query->dimension && query->period[a] > 0.0;
}

static int level_of(double radius_max, double radius) {
    int level = (int)floor(log2(radius_max / radius));
    return level < 0 ? 0 : level < MAX_LEVELS ? level : MAX_LEVELS - 1;
}

static void bounding_box(search *state) {
    const gn_particles *p = state->query->particles;
    double upper[3];
    for (int a = 0; a < 3; a++) {
        state->lower[a] = INFINITY;
        upper[a] = -INFINITY;
    }
    state->radius_max = 0.0;
    for (size_t k = 0; k < p->soa.count; k++) {
        if (removed(p, k)) continue;
        state->radius_max = fmax(state->radius_max, p->pos[4 * k + 3]);
        for (int a = 0; a < 3; a++) {
            state->lower[a] = fmin(state->lower[a], p->pos[4 * k + a]);
            upper[a] = fmax(upper[a], p->pos[4 * k + a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        state->extent[a] = upper[a] - state->lower[a];
        if (has_sides(state->query, a)) state->extent[a] = state->query->period[a];
    }
}

static gneiss_status size_grid(search *state, grid *cells, double radius, gneiss_error *error) {
    const gn_pair_query *q = state->query;
    double reach = 2.0 * radius * (1.0 + q->range) + q->margin;
    double total = 1.0;
    for (int a = 0; a < 3; a++) {
        cells->cells[a] = 1;
        cells->cell[a] = fmax(state->extent[a], reach);
        if (a == 2 && q->dimension == 2) continue;
        if (has_sides(q, a) && q->period[a] < 2.0 * reach)
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "periodic box: expected a length of at least %g m along %c (twice the reach of "
                "the largest particles), found %g m",
                2.0 * reach, "xyz"[a], q -> period[a]);
        total *= fmax(1.0, floor(state->extent[a] / reach));
    }
    /* A few large cells do no harm, but more cells than particles would waste memory. */
    double limit = 2.0 * (double)cells->count + 64.0;
    double widen = total > limit ? pow(total / limit, 1.0 / q->dimension) : 1.0;
    for (int a = 0; a < q->dimension; a++) {
        double n = fmax(1.0, floor(state->extent[a] / (reach * widen)));
        cells->cells[a] = (int64_t)n;
        cells->cell[a] = n > 1.0 ? state->extent[a] / n : cells->cell[a];
    }
    return GNEISS_OK;
}

static int64_t cell_along(const search *state, const grid *cells, const double *x, int a) {
    double c = floor((x[a] - state->lower[a]) / cells->cell[a]);
    int64_t n = cells->cells[a];
    if (has_sides(state->query, a)) {
        int64_t k = (int64_t)c % n;
        return k < 0 ? k + n : k;
    }
    return c < 0.0 ? 0 : c >= (double)n ? n - 1 : (int64_t)c;
}

static int64_t cell_index(const grid *cells, const int64_t c[3]) {
    return (c[2] * cells->cells[1] + c[1]) * cells->cells[0] + c[0];
}

/* Wraps a position into the box, so that all positions lie within one period of each other. */
static void inside_box(const search *state, const double *x, double out[4]) {
    memcpy(out, x, 4 * sizeof *out);
    for (int a = 0; a < state->query->dimension; a++)
        if (has_sides(state->query, a))
            out[a] -=
                state->query->period[a] * floor((x[a] - state->lower[a]) / state->query->period[a]);
}

static gneiss_status fill_grid(search *state, int level, gneiss_error *error) {
    const gn_particles *p = state->query->particles;
    grid *g = &state->grids[level];
    size_t cells = (size_t)(g->cells[0] * g->cells[1] * g->cells[2]);
    g->start = gn_alloc_array(cells + 2, sizeof *g->start);
    g->particle = gn_alloc_array(g->count + 1, sizeof *g->particle);
    bool columns = true;
    for (int a = 0; a < 4; a++)
        columns = (g->column[a] = gn_alloc_array(g->count + 1, sizeof(double))) && columns;
    int32_t *home = gn_alloc_array(p->soa.count + 1, sizeof *home);
    if (!g->start || !g->particle || !columns || !home) {
        gn_free(home);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a grid of %zu cells", cells);
    }
    for (size_t k = 0; k < p->soa.count; k++) {
        if (state->level[k] != level) continue;
        const double *x = p->pos + 4 * k;
        int64_t c[3] = {cell_along(state, g, x, 0), cell_along(state, g, x, 1),
                        cell_along(state, g, x, 2)};
        home[k] = (int32_t)cell_index(g, c);
        g->start[home[k] + 2]++;
    }
    for (size_t c = 2; c < cells + 2; c++) g->start[c] += g->start[c - 1];
    for (size_t k = 0; k < p->soa.count; k++) {
        if (state->level[k] != level) continue;
        int32_t place = g->start[home[k] + 1]++;
        g->particle[place] = (int32_t)k;
        double x[4];
        inside_box(state, p->pos + 4 * k, x);
        for (int a = 0; a < 4; a++) g->column[a][place] = x[a];
    }
    gn_free(home);
    return GNEISS_OK;
}

static bool bucket_push(bucket *found, int32_t i, int32_t j) {
    if (found->count == found->capacity) {
        size_t capacity = found->capacity ? 2 * found->capacity : 4096;
        void *grown = realloc(found->pair, capacity * sizeof *found->pair);
        if (!grown) return false;
        found->pair = grown;
        found->capacity = capacity;
    }
    found->pair[found->count][0] = i < j ? i : j;
    found->pair[found->count][1] = i < j ? j : i;
    found->count++;
    return true;
}

enum { BATCH = 64 };

static inline double wrapped(double d, double period) {
    d = d > 0.5 * period ? d - period : d;
    return d < -0.5 * period ? d + period : d;
}

/* Computes, for places [begin, begin + count), the squared distance from x minus the squared reach.
 * A pair is near if that is not positive. */
static void test_batch(const gn_pair_query *query, const grid *cells, const double *restrict x,
                       int32_t begin, int32_t count, double *restrict excess) {
    const double *restrict cx = cells->column[0] + begin, *restrict cy = cells->column[1] + begin;
    const double *restrict cz = cells->column[2] + begin, *restrict cr = cells->column[3] + begin;
    const double stretch = 1.0 + query->range, margin = query->margin, x0 = x[0], x1 = x[1],
                 x2 = x[2];
    const double own = x[3];
    if (!query->periodic) {
        for (int32_t e = 0; e < count; e++) {
            double dx = cx[e] - x0, dy = cy[e] - x1, dz = cz[e] - x2;
            double reach = (cr[e] + own) * stretch + margin;
            excess[e] = dx * dx + dy * dy + dz * dz - reach * reach;
        }
        return;
    }
    double period[3];
    for (int a = 0; a < 3; a++) period[a] = has_sides(query, a) ? query->period[a] : INFINITY;
    const double px = period[0], py = period[1], pz = period[2];
    for (int32_t e = 0; e < count; e++) {
        double dx = wrapped(cx[e] - x0, px), dy = wrapped(cy[e] - x1, py);
        double dz = wrapped(cz[e] - x2, pz), reach = (cr[e] + own) * stretch + margin;
        excess[e] = dx * dx + dy * dy + dz * dz - reach * reach;
    }
}

/* Finds the first cell and the number of cells to visit along an axis around cell c. */
static void cell_span(const search *state, const grid *cells, int64_t c, int a, int64_t *first,
                      int *count) {
    int64_t n = cells->cells[a];
    if (has_sides(state->query, a)) {
        *first = n >= 3 ? (c + n - 1) % n : 0;
        *count = n >= 3 ? 3 : (int)n;
        return;
    }
    int64_t last = c + 1 < n ? c + 1 : n - 1;
    *first = c > 0 ? c - 1 : 0;
    *count = (int)(last - *first + 1);
}

/* Finds the partners of particle k among places [begin, end) of a grid. */
static bool search_places(const search *state, size_t k, const grid *cells, int32_t begin,
                          int32_t end, bool own_level, bucket *out) {
    double x[4], excess[BATCH];
    inside_box(state, state->query->particles->pos + 4 * k, x);
    for (int32_t b = begin; b < end; b += BATCH) {
        int32_t count = end - b < BATCH ? end - b : BATCH;
        test_batch(state->query, cells, x, b, count, excess);
        for (int32_t e = 0; e < count; e++) {
            if (excess[e] > 0.0) continue;
            int32_t other = cells->particle[b + e];
            if (own_level && other <= (int32_t)k) continue;
            if (!bucket_push(out, (int32_t)k, other)) return false;
        }
    }
    return true;
}

/* Finds the partners of particle k in one grid: in the grid of its own level the particles after
 * it, in coarser grids all. Consecutive cells along x are one range of places, unless the box wraps
 * around between them. */
static bool search_level(const search *state, size_t k, int level, bucket *out) {
    const grid *g = &state->grids[level];
    const double *x = state->query->particles->pos + 4 * k;
    bool own = level == state->level[k];
    int64_t first[3];
    int count[3];
    for (int a = 0; a < 3; a++)
        cell_span(state, g, cell_along(state, g, x, a), a, &first[a], &count[a]);
    bool wraps = first[0] + count[0] > g->cells[0];
    int stretches = wraps ? count[0] : 1, width = wraps ? 1 : count[0];
    for (int cz = 0; cz < count[2]; cz++)
        for (int cy = 0; cy < count[1]; cy++)
            for (int cx = 0; cx < stretches; cx++) {
                int64_t c[3] = {(first[0] + cx) % g->cells[0], (first[1] + cy) % g->cells[1],
                                (first[2] + cz) % g->cells[2]};
                int64_t cell = cell_index(g, c);
                if (!search_places(state, k, g, g->start[cell], g->start[cell + width], own, out))
                    return false;
            }
    return true;
}

static bool search_range(const search *state, size_t begin, size_t end, bucket *out) {
    for (size_t k = begin; k < end; k++) {
        if (state->level[k] >= MAX_LEVELS) continue;
        for (int level = state->level[k]; level >= 0; level--)
            if (state->grids[level].count && !search_level(state, k, level, out)) return false;
    }
    return true;
}

/* Rows are short and nearly sorted: insertion sort is faster than a call of qsort. */
static void sort_row(int32_t (*pair)[2], int32_t count) {
    for (int32_t k = 1; k < count; k++) {
        int32_t second = pair[k][1], m = k;
        for (; m > 0 && pair[m - 1][1] > second; m--) pair[m][1] = pair[m - 1][1];
        pair[m][1] = second;
    }
}

/* Sorts pairs by the first index (counting sort), then each short row by the second, so that the
 * order does not depend on which thread found a pair. */
static gneiss_status merge_buckets(const bucket *buckets, int count, size_t particles,
                                   gn_pair_list *list, gneiss_error *error) {
    size_t total = 0;
    for (int b = 0; b < count; b++) total += buckets[b].count;
    if (total > INT32_MAX / 2 - 64) /* 2 contact + side must be a number too */
        return gn_fail(error, GNEISS_ERROR_INPUT, "%zu pairs are more than the engine can number",
                       total);
    int32_t *start = gn_alloc_array(particles + 2, sizeof *start);
    list->pair = gn_alloc_array(total + 1, sizeof *list->pair);
    list->count = total;
    if (!start || !list->pair) {
        gn_free(start);
        gn_pair_list_free(list);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu pairs", total);
    }
    for (int b = 0; b < count; b++)
        for (size_t k = 0; k < buckets[b].count; k++) start[buckets[b].pair[k][0] + 2]++;
    for (size_t p = 2; p < particles + 2; p++) start[p] += start[p - 1];
    for (int b = 0; b < count; b++)
        for (size_t k = 0; k < buckets[b].count; k++) {
            int32_t *slot = list->pair[start[buckets[b].pair[k][0] + 1]++];
            memcpy(slot, buckets[b].pair[k], sizeof *list->pair);
        }
    for (size_t p = 0; p < particles; p++) sort_row(list->pair + start[p], start[p + 1] - start[p]);
    gn_free(start);
    return GNEISS_OK;
}

static gneiss_status assign_levels(search *state, gneiss_error *error) {
    const gn_particles *p = state->query->particles;
    state->level = gn_alloc(p->soa.count + 1);
    if (!state->level) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for particle levels");
    double largest[MAX_LEVELS] = {0};
    for (size_t k = 0; k < p->soa.count; k++) {
        state->level[k] = MAX_LEVELS; /* removed */
        if (removed(p, k)) continue;
        int level = level_of(state->radius_max, p->pos[4 * k + 3]);
        state->level[k] = (uint8_t)level;
        state->grids[level].count++;
        largest[level] = fmax(largest[level], p->pos[4 * k + 3]);
    }
    for (int level = 0; level < MAX_LEVELS; level++) {
        if (!state->grids[level].count) continue;
        GN_TRY(size_grid(state, &state->grids[level], largest[level], error));
        GN_TRY(fill_grid(state, level, error));
    }
    return GNEISS_OK;
}

static gneiss_status search_all(const search *state, bucket *buckets, int threads,
                                gneiss_error *error) {
    size_t n = state->query->particles->soa.count;
    bool complete = true;
#pragma omp parallel num_threads(threads) reduction(&& : complete)
    {
        size_t t = (size_t)omp_get_thread_num(), of = (size_t)omp_get_num_threads();
        complete = search_range(state, n * t / of, n * (t + 1) / of, &buckets[t]);
    }
    return complete ? GNEISS_OK
                    : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the pair list");
}

gneiss_status gn_pairs_find(const gn_pair_query *query, gn_pair_list *list, gneiss_error *error) {
    size_t n = query->particles->soa.count;
    int threads = query->threads > 0 ? query->threads : 1;
    search *s = calloc(1, sizeof *s);
    bucket *buckets = calloc((size_t)threads, sizeof *buckets);
    list->count = 0;
    list->pair = NULL;
    gneiss_status status = GNEISS_OK;
    if (!s || !buckets)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the pair search");
    if (status == GNEISS_OK) {
        s->query = query;
        bounding_box(s);
        if (s->radius_max > 0.0) status = assign_levels(s, error);
    }
    if (status == GNEISS_OK && s->radius_max > 0.0) status = search_all(s, buckets, threads, error);
    if (status == GNEISS_OK) status = merge_buckets(buckets, threads, n, list, error);
    for (int t = 0; buckets && t < threads; t++) free(buckets[t].pair);
    free(buckets);
    for (int level = 0; s && level < MAX_LEVELS; level++) {
        gn_free(s->grids[level].start);
        gn_free(s->grids[level].particle);
        for (int a = 0; a < 4; a++) gn_free(s->grids[level].column[a]);
    }
    if (s) gn_free(s->level);
    free(s);
    return status;
}

void gn_pair_list_free(gn_pair_list *list) {
    gn_free(list->pair);
    list->pair = NULL;
    list->count = 0;
}
