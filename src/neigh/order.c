#include "base/memory.h"
#include "neigh/neigh.h"

#include <math.h>
#include <stdlib.h>

typedef struct keyed {
    uint64_t key;
    int32_t id, place;
} keyed;

static int by_key(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

/* Spreads the low `bits` bits of v, with `gap` zero bits between neighbouring ones. */
static uint64_t spread(uint64_t v, int bits, int gap) {
    uint64_t r = 0;
    for (int b = 0; b < bits; b++) r |= (v >> b & 1) << (b * (gap + 1));
    return r;
}

gneiss_status gn_morton_order(const gn_particles *particles, int dimension, int32_t *order,
                              gneiss_error *error) {
    size_t n = particles->soa.count;
    keyed *keys = gn_alloc_array(n + 1, sizeof *keys);
    if (!keys) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu particles", n);
    double lower[3] = {INFINITY, INFINITY, INFINITY}, span = 0.0;
    for (size_t k = 0; k < n; k++)
        for (int a = 0; a < dimension; a++) lower[a] = fmin(lower[a], particles->pos[4 * k + a]);
    for (size_t k = 0; k < n; k++)
        for (int a = 0; a < dimension; a++) span = fmax(span, particles->pos[4 * k + a] - lower[a]);
    const int bits = 20;
    double scale = span > 0.0 ? (double)((1 << bits) - 1) / span : 0.0;
    for (size_t k = 0; k < n; k++) {
        uint64_t key = 0;
        for (int a = 0; a < dimension; a++) {
            uint64_t cell = (uint64_t)((particles->pos[4 * k + a] - lower[a]) * scale);
            key |= spread(cell, bits, dimension - 1) << a;
        }
        keys[k] = (keyed){key, particles->id[k], (int32_t)k};
    }
    qsort(keys, n, sizeof *keys, by_key);
    for (size_t k = 0; k < n; k++) order[k] = keys[k].place;
    gn_free(keys);
    return GNEISS_OK;
}
