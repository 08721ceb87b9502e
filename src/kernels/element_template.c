/* The element kernel: linear triangles in plane strain and tetrahedra, total Lagrangian. One body,
 * compiled per instruction set and expanded per variant, as contact_template.c.
 *
 * Per element: deformation gradient F = sum_a x_a (x) dN_a/dX from the rows of its nodes, Green
 * strain E = (F^T F - I)/2, St Venant-Kirchhoff stress S = lambda tr(E) I + 2 mu E, nodal forces
 * f_a = -V0 F S dN_a/dX (Belytschko, Liu & Moran 2000, Nonlinear Finite Elements, sec. 4.9). E is
 * zero under any rotation, and S derives from an energy, V0 (lambda/2 tr(E)^2 + mu E:E). For small
 * strains it is linear elasticity. */
#include "kernels/element.h"
#include "kernels/expand.h"
#include "kernels/simd.h"

#include <math.h>
#include <string.h>

typedef struct variant {
    int space, measure;
} variant;

/* GN_W elements. Columns of F are the deformed base vectors; the strain is c = F^T F - I = 2 E in
 * the order 00 11 22 01 12 20, the stress s = -V0 S. */
typedef struct state {
    gn_v3 f[3], gradient[3]; /* gradient: of nodes 1 2 3 */
    gn_v c[6], s[6];
    gn_v volume;
} state;

GN_INLINE void load_nodes(const gn_element_args *a, size_t e, gn_v3 edge[3], variant w) {
    gn_v first[4], x[4];
    gn_rows4(a->pos, gn_elements_node(a->elements, 0) + e, first);
    for (int n = 0; n < 2 + w.space; n++) {
        const int32_t *node = a->elements->node + (size_t)(n + 1) * a->elements->soa.capacity;
        if (n == 2) node = a->elements->node3;
        gn_rows4(a->pos, node + e, x);
        edge[n] = (gn_v3){x[0] - first[0], x[1] - first[1],
                          gn_pick(w.space, x[2] - first[2], gn_set(0.0))};
    }
}

GN_INLINE void load_gradients(const gn_elements *q, size_t e, state *t, variant w) {
    const size_t stride = q->soa.capacity, dimension = 2 + (size_t)w.space;
    const double *column = (w.space ? q->gradient3 : q->gradient2) + e;
    for (size_t n = 0; n < dimension; n++)
        t->gradient[n] = gn_load3(column + n * dimension * stride, stride, w.space);
    t->volume = gn_load(q->volume + e);
}

GN_INLINE gn_v component(gn_v3 a, int k) {
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/* |f|^2 - 1; first the component that is near one while rotations are small, which then cancels
 * without a rounding. */
GN_INLINE gn_v stretched(gn_v near_one, gn_v a, gn_v b, variant w) {
    gn_v c = gn_fma(a, a, gn_fma(near_one, near_one, gn_set(-1.0)));
    return w.space ? gn_fma(b, b, c) : c;
}

GN_INLINE void find_strain(const gn_v3 edge[3], state *t, variant w) {
    for (int k = 0; k < 2 + w.space; k++) {
        t->f[k] = gn_scale(component(t->gradient[0], k), edge[0], w.space);
        t->f[k] = gn_axpy(t->f[k], component(t->gradient[1], k), edge[1], w.space);
        if (w.space) t->f[k] = gn_axpy(t->f[k], component(t->gradient[2], k), edge[2], 1);
    }
    t->c[0] = stretched(t->f[0].x, t->f[0].y, t->f[0].z, w);
    t->c[1] = stretched(t->f[1].y, t->f[1].x, t->f[1].z, w);
    t->c[3] = gn_dot(t->f[0], t->f[1], w.space);
    if (!w.space) return;
    t->c[2] = stretched(t->f[2].z, t->f[2].x, t->f[2].y, w);
    t->c[4] = gn_dot(t->f[1], t->f[2], 1);
    t->c[5] = gn_dot(t->f[2], t->f[0], 1);
}

/* Where a parameter that may be the same everywhere is read. */
GN_INLINE size_t same(size_t e, size_t uniform) {
    return e & ~uniform;
}

GN_INLINE void find_stress(const gn_element_args *a, size_t e, state *t, variant w) {
    const gn_elements *q = a->elements;
    gn_v minus = gn_set(0.0) - t->volume;
    gn_v mu = minus * gn_load(q->mu + same(e, a->uniform.mu));
    gn_v lambda = minus * gn_load(q->lambda + same(e, a->uniform.lambda));
    gn_v trace = t->c[0] + t->c[1];
    if (w.space) trace = trace + t->c[2];
    gn_v mean = gn_set(0.5) * lambda * trace;
    t->s[0] = gn_fma(mu, t->c[0], mean);
    t->s[1] = gn_fma(mu, t->c[1], mean);
    t->s[3] = mu * t->c[3];
    if (!w.space) return;
    t->s[2] = gn_fma(mu, t->c[2], mean);
    t->s[4] = mu * t->c[4];
    t->s[5] = mu * t->c[5];
}

/* Column k of F s. */
GN_INLINE gn_v3 first_piola(const state *t, int k, variant w) {
    static const int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    gn_v3 p = gn_scale(t->s[at[k][0]], t->f[0], w.space);
    p = gn_axpy(p, t->s[at[k][1]], t->f[1], w.space);
    return w.space ? gn_axpy(p, t->s[at[k][2]], t->f[2], 1) : p;
}

/* Rows of forces, node after node. */
typedef struct element_rows {
    gn_real row[4][4 * GN_W];
} element_rows;

GN_INLINE void write_row(gn_real *row, gn_v3 force) {
    gn_v columns[4] = {force.x, force.y, force.z, gn_set(0.0)};
    gn_store_rows4(row, columns);
}

GN_INLINE void find_forces(const state *t, gn_v3 piola[3], element_rows *out, variant w) {
    const gn_v zero = gn_set(0.0);
    gn_v3 first = {zero, zero, zero};
    for (int k = 0; k < 2 + w.space; k++) piola[k] = first_piola(t, k, w);
    for (int n = 0; n < 2 + w.space; n++) {
        gn_v3 force = gn_scale(t->gradient[n].x, piola[0], w.space);
        force = gn_axpy(force, t->gradient[n].y, piola[1], w.space);
        if (w.space) force = gn_axpy(force, t->gradient[n].z, piola[2], 1);
        first = gn_sub(first, force, w.space);
        write_row(out->row[n + 1], force);
    }
    write_row(out->row[0], first);
}

GN_INLINE void add_rows(const gn_element_args *a, size_t e, size_t end, const element_rows *rows,
                        double *sums, variant w) {
    const size_t nodes = 3 + (size_t)w.space, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = a->partials->place + nodes * e;
    for (size_t k = 0; k < count; k++)
        for (size_t n = 0; n < nodes; n++)
            gn_add_plain4(sums + place[nodes * k + n], rows->row[n] + 4 * k);
}

/* --- measuring
 * -------------------------------------------------------------------------------- */

typedef struct lane_sums {
    gn_v elastic, stress[9], volume, least, element;
} lane_sums;

GN_INLINE lane_sums no_sums(void) {
    const gn_v zero = gn_set(0.0);
    lane_sums s = {.elastic = zero, .volume = zero};
    for (int k = 0; k < 9; k++) s.stress[k] = zero;
    s.least = gn_set(INFINITY);
    s.element = gn_set(-1.0);
    return s;
}

GN_INLINE gn_v determinant(const state *t, variant w) {
    gn_v3 normal = gn_cross(t->f[0], t->f[1], w.space);
    return w.space ? gn_dot(normal, t->f[2], 1) : normal.z;
}

/* Padding has no volume, and its det F does not count. */
GN_INLINE void measure(const state *t, const gn_v3 piola[3], size_t e, size_t end, lane_sums *s,
                       variant w) {
    static const double lanes[8] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    gn_v own = t->s[0] * t->c[0] + t->s[1] * t->c[1], shear = t->s[3] * t->c[3];
    if (w.space) {
        own = own + t->s[2] * t->c[2];
        shear = shear + (t->s[4] * t->c[4] + t->s[5] * t->c[5]);
    }
    s->elastic = s->elastic - gn_set(0.25) * (own + gn_set(2.0) * shear);
    for (int i = 0; i < 2 + w.space; i++)
        for (int j = 0; j < 2 + w.space; j++) {
            gn_v sum = component(piola[0], i) * component(t->f[0], j) +
                       component(piola[1], i) * component(t->f[1], j);
            if (w.space) sum = sum + component(piola[2], i) * component(t->f[2], j);
            s->stress[3 * i + j] = s->stress[3 * i + j] - sum;
        }
    gn_v det = determinant(t, w), element = gn_set((double)e) + gn_load(lanes);
    s->volume = s->volume + t->volume * det;
    gn_m less = gn_and(gn_less(det, s->least), gn_less(element, gn_set((double)end)));
    s->least = gn_where(less, det, s->least);
    s->element = gn_where(less, element, s->element);
}

GN_INLINE void fold_sums(const lane_sums *s, gn_element_sums *out) {
    double least[GN_W], element[GN_W];
    out->elastic += gn_fold(s->elastic);
    out->volume += gn_fold(s->volume);
    for (int k = 0; k < 9; k++) out->stress[k] += gn_fold(s->stress[k]);
    gn_store(least, s->least);
    gn_store(element, s->element);
    for (int k = 0; k < GN_W; k++) {
        bool first = least[k] == out->least && element[k] < (double)out->element;
        if (!(least[k] < out->least || first)) continue;
        out->least = least[k];
        out->element = (int64_t)element[k];
    }
}

/* --- a block
 * ---------------------------------------------------------------------------------- */

/* The rows of the block that begins with element `begin`, zeroed. */
GN_INLINE double *clear_partials(const gn_partials *q, size_t begin) {
    size_t block = begin / q->length, first = (size_t)q->first[block];
    size_t rows = (size_t)q->first[block + 1] - first;
    return memset(q->row + 4 * first, 0, 4 * rows * sizeof *q->row);
}

GN_INLINE void element_core(const gn_element_args *a, size_t begin, size_t end,
                            gn_element_sums *sums, variant w) {
    double *partial = clear_partials(a->partials, begin);
    lane_sums s = no_sums();
    for (size_t e = begin; e < end; e += GN_W) {
        gn_v3 edge[3], piola[3];
        state t;
        element_rows rows;
        load_nodes(a, e, edge, w);
        load_gradients(a->elements, e, &t, w);
        find_strain(edge, &t, w);
        find_stress(a, e, &t, w);
        find_forces(&t, piola, &rows, w);
        add_rows(a, e, end, &rows, partial, w);
        if (w.measure) measure(&t, piola, e, end, &s, w);
    }
    if (w.measure) fold_sums(&s, sums);
}

/* --- the variants
 * ---------------------------------------------------------------------------------- */

#define GN_EACH_4(X) X(0) X(1) X(2) X(3)

#define WRAPPER(v)                                                                                 \
    static void element_##v(const gn_element_args *a, size_t begin, size_t end,                    \
                            gn_element_sums *sums) {                                               \
        element_core(a, begin, end, sums, (variant){GN_BIT(v, 0), GN_BIT(v, 1)});                  \
    }
GN_EACH_4(WRAPPER)

#define ENTRY(v) element_##v,
gn_element_kernel *const GN_TABLE(element)[GN_ELEMENT_VARIANTS] = {GN_EACH_4(ENTRY)};
