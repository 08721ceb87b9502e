/* The element kernel in mixed precision: displacement form, forces in single precision, their sums
 * in double. It is compiled per instruction set and has the equations of element_template.c.
 *
 * Single precision resolves neither positions nor F^T F - I. Neither is needed with the
 * displacements u since the start (differences that motion kernels compute in double): with H =
 * sum_a (u_a - u_0) (x) dN_a/dX the strain is 2 E = H + H^T + H^T H, and small terms are sums of
 * small ones. The rounding of u remains: the relative error of a force is some 6e-8 |u|/(h |E|), h
 * the size of the element. Energies and det F are computed by the kernel in double.
 *
 * It has no stages as in element_template.c: with twice the lanes they gain nothing. */
#include "kernels/element_internal.h"

/* Columns of H and F, and strain c = 2 E and stress s = -V0 S in the order 00 11 22 01 12 20. */
typedef struct state {
    gn_v3 h[3], gradient[3]; /* gradient: of nodes 1 2 3 */
    gn_v c[6], s[6];
} state;

/* Loads the displacements of nodes 1 2 3 relative to node 0. */
GN_INLINE void load_travel(const gn_element_args *args, size_t e, gn_v3 moved[3], int space) {
    gn_v first[4], x[4];
    gn_gather4(args->travel, gn_node_column(args->elements, 0) + e, first);
    for (int n = 0; n < 2 + space; n++) {
        gn_rows4_beyond(args->travel, gn_node_column(args->elements, n + 1) + e, first, x);
        moved[n] = (gn_v3){x[0], x[1], gn_pick(space, x[2], gn_set(0.0))};
    }
}

GN_INLINE void deform(const gn_element_args *args, size_t e, state *now, int space) {
    const gn_elements *q = args->elements;
    const size_t stride = q->soa.capacity, dimension = 2 + (size_t)space;
    const float *column = (space ? q->gradient3_f : q->gradient2_f) + e;
    gn_v3 moved[3];
    load_travel(args, e, moved, space);
    for (size_t n = 0; n < dimension; n++)
        now->gradient[n] = gn_load3(column + n * dimension * stride, stride, space);
    for (int k = 0; k < 2 + space; k++) {
        now->h[k] = gn_scale(gn_component(now->gradient[0], k), moved[0], space);
        now->h[k] = gn_axpy(now->h[k], gn_component(now->gradient[1], k), moved[1], space);
        if (space) now->h[k] = gn_axpy(now->h[k], gn_component(now->gradient[2], k), moved[2], 1);
    }
}

/* Returns 2 E of the columns k and l. */
GN_INLINE gn_v strain(const state *now, int k, int l, int space) {
    return (gn_component(now->h[k], l) + gn_component(now->h[l], k)) +
           gn_dot(now->h[k], now->h[l], space);
}

/* Computes the strain; from here on now->h is F. */
GN_INLINE void find_strain(state *now, int space) {
    const gn_v one = gn_set(1.0);
    now->c[0] = strain(now, 0, 0, space);
    now->c[1] = strain(now, 1, 1, space);
    now->c[3] = strain(now, 0, 1, space);
    if (space) {
        now->c[2] = strain(now, 2, 2, 1);
        now->c[4] = strain(now, 1, 2, 1);
        now->c[5] = strain(now, 2, 0, 1);
        now->h[2].z = now->h[2].z + one;
    }
    now->h[0].x = now->h[0].x + one;
    now->h[1].y = now->h[1].y + one;
}

GN_INLINE void find_stress(const gn_element_args *args, size_t e, state *now, int space) {
    const gn_elements *q = args->elements;
    gn_v minus = gn_set(0.0) - gn_load(q->volume_f + e);
    gn_v mu = minus * gn_load(q->mu_f + gn_column_at(e, args->uniform.mu));
    gn_v lambda = minus * gn_load(q->lambda_f + gn_column_at(e, args->uniform.lambda));
    gn_v trace = now->c[0] + now->c[1];
    if (space) trace = trace + now->c[2];
    gn_v mean = gn_set(0.5) * lambda * trace;
    now->s[0] = gn_fma(mu, now->c[0], mean);
    now->s[1] = gn_fma(mu, now->c[1], mean);
    now->s[3] = mu * now->c[3];
    if (!space) return;
    now->s[2] = gn_fma(mu, now->c[2], mean);
    now->s[4] = mu * now->c[4];
    now->s[5] = mu * now->c[5];
}

GN_INLINE void write_row(gn_real *row, gn_v3 force) {
    gn_v columns[4] = {force.x, force.y, force.z, gn_set(0.0)};
    gn_store_rows4(row, columns);
}

/* Computes rows of forces from the strain. */
GN_INLINE void resist(const gn_element_args *args, size_t e, state *now, gn_element_rows *out,
                      int space) {
    const gn_v zero = gn_set(0.0);
    gn_v3 piola[3], first = {zero, zero, zero};
    find_strain(now, space);
    find_stress(args, e, now, space);
    for (int k = 0; k < 2 + space; k++) piola[k] = gn_first_piola(now->h, now->s, k, space);
    for (int n = 0; n < 2 + space; n++) {
        gn_v3 force = gn_scale(now->gradient[n].x, piola[0], space);
        force = gn_axpy(force, now->gradient[n].y, piola[1], space);
        if (space) force = gn_axpy(force, now->gradient[n].z, piola[2], 1);
        first = gn_sub(first, force, space);
        write_row(out->row[n + 1], force);
    }
    write_row(out->row[0], first);
}

GN_INLINE void element_core(const gn_element_args *args, size_t begin, size_t end, int space) {
    double *partial =
        gn_clear_block_rows(args->partials, begin, 4 * sizeof(double), args->partials->row);
    gn_block_particles ahead = gn_block_particles_of(args->partials, begin);
    state t;
    gn_element_rows rows;
    for (size_t e = begin; e < end; e += GN_W) {
        gn_fetch_ahead(&ahead, &args->travel, 1, gn_nodes_ahead(space));
        deform(args, e, &t, space);
        resist(args, e, &t, &rows, space);
        gn_add_element_rows(args, e, end, &rows, partial, space);
    }
}

static void triangle(const gn_element_args *args, size_t begin, size_t end, gn_element_sums *sums) {
    (void)sums;
    element_core(args, begin, end, 0);
}
static void tetrahedron(const gn_element_args *args, size_t begin, size_t end,
                        gn_element_sums *sums) {
    (void)sums;
    element_core(args, begin, end, 1);
}
gn_element_kernel *const GN_TABLE(element)[2] = {triangle, tetrahedron};
