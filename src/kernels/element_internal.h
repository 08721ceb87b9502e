/* Declarations shared by the element kernels of both precisions. */
#ifndef GN_KERNELS_ELEMENT_INTERNAL_H
#define GN_KERNELS_ELEMENT_INTERNAL_H

#include "kernels/block_rows.h"
#include "kernels/element.h"
#include "kernels/simd.h"

/* Rows of forces, node after node. */
typedef struct gn_element_rows {
    gn_real row[4][4 * GN_W];
} gn_element_rows;

GN_INLINE const int32_t *gn_node_column(const gn_elements *elements, int n) {
    return n == 3 ? elements->node3 : elements->node + (size_t)n * elements->soa.capacity;
}

/* Returns the number of nodes to prefetch per vector: tetrahedra share more of them than
 * triangles. */
GN_INLINE int gn_nodes_ahead(int space) {
    return space ? (GN_W + 1) / 2 : GN_W;
}

GN_INLINE gn_v gn_component(gn_v3 a, int k) {
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/* Returns column k of F s, from the columns of F and the stress components in the order 00 11 22 01
 * 12 20. */
GN_INLINE gn_v3 gn_first_piola(const gn_v3 f[3], const gn_v s[6], int k, int space) {
    static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    gn_v3 p = gn_scale(s[at[k][0]], f[0], space);
    p = gn_axpy(p, s[at[k][1]], f[1], space);
    return space ? gn_axpy(p, s[at[k][2]], f[2], 1) : p;
}

GN_INLINE void gn_add_element_rows(const gn_element_args *args, size_t e, size_t end,
                                   const gn_element_rows *rows, double *sums, int space) {
    const size_t nodes = 3 + (size_t)space, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = args->partials->place + nodes * e;
    for (size_t k = 0; k < count; k++)
        for (size_t n = 0; n < nodes; n++)
            gn_add_plain4(sums + place[nodes * k + n], rows->row[n] + 4 * k);
}

#endif
