/* Disjoint sets (union-find). `parent` of an element is another element of its set; the root is the
 * smallest element and its own parent. */
#ifndef GN_BASE_UNION_FIND_H
#define GN_BASE_UNION_FIND_H

#include <stdint.h>

/* Returns the smallest element of the set of k; the path to it is halved. */
static inline int32_t gn_set_root(int32_t *parent, int32_t k) {
    while (parent[k] != k) {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    return k;
}

static inline void gn_set_unite(int32_t *parent, int32_t i, int32_t j) {
    const int32_t a = gn_set_root(parent, i), b = gn_set_root(parent, j);
    if (a != b) parent[a > b ? a : b] = a < b ? a : b;
}

#endif
