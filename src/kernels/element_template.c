/* The element kernel: linear triangles in plane strain and tetrahedra, total Lagrangian. One body,
 * compiled per instruction set and expanded per variant, as contact_template.c.
 *
 * Per element: deformation gradient F = sum_a x_a (x) dN_a/dX from the rows of its nodes, Green
 * strain E = (F^T F - I)/2, St Venant-Kirchhoff stress S = lambda tr(E) I + 2 mu E, nodal forces
 * f_a = -V0 F S dN_a/dX (Belytschko, Liu & Moran 2000, Nonlinear Finite Elements, sec. 4.9). E is
 * zero under any rotation, and S derives from an energy, V0 (lambda/2 tr(E)^2 + mu E:E). For small
 * strains it is linear elasticity.
 *
 * Pressure form: S = 2 mu dev(E) + p J C^-1 with p the mean of the nodes' pressures, that is lambda
 * = -2 mu/3 and V0 p cof(F) added to V0 F S: the work of p on the growth in volume. The first pass,
 * below, computes the pressures (docs/fem.md has the equations). */
#include "kernels/element_internal.h"
#include "kernels/expand.h"

#include <math.h>

typedef struct variant {
    int space, measure, pressure;
} variant;

/* The state of GN_W elements. Columns of F are the deformed base vectors; the strain is c = F^T F -
 * I = 2 E in the order 00 11 22 01 12 20, the stress s = -V0 S. */
typedef struct state {
    gn_v3 f[3], gradient[3]; /* gradient: of nodes 1 2 3 */
    gn_v c[6], s[6];
    gn_v volume;
    gn_v pressure[4]; /* pressure form: of node 0, and differences of nodes 1 2 3 from it */
    gn_v3 slope;      /* pressure form: every node's share of tau times the pressure's gradient */
} state;

GN_INLINE void load_nodes(const gn_element_args *a, size_t e, gn_v3 edge[3], state *t, variant w) {
    gn_v first[4], x[4];
    gn_gather4(a->pos, gn_node_column(a->elements, 0) + e, first);
    if (w.pressure) {
        gn_columns4(first, x);
        t->pressure[0] = x[3];
    }
    for (int n = 0; n < 2 + w.space; n++) {
        gn_rows4_beyond(a->pos, gn_node_column(a->elements, n + 1) + e, first, x);
        edge[n] = (gn_v3){x[0], x[1], gn_pick(w.space, x[2], gn_set(0.0))};
        if (w.pressure) t->pressure[n + 1] = x[3];
    }
}

GN_INLINE void load_gradients(const gn_elements *q, size_t e, state *t, variant w) {
    const size_t stride = q->soa.capacity, dimension = 2 + (size_t)w.space;
    const double *column = (w.space ? q->gradient3 : q->gradient2) + e;
    for (size_t n = 0; n < dimension; n++)
        t->gradient[n] = gn_load3(column + n * dimension * stride, stride, w.space);
    t->volume = gn_load(q->volume + e);
}

/* Returns |f|^2 - 1; the component that is near one for small rotations comes first, which then
 * cancels without rounding. */
GN_INLINE gn_v stretched(gn_v near_one, gn_v a, gn_v b, variant w) {
    gn_v c = gn_fma(a, a, gn_fma(near_one, near_one, gn_set(-1.0)));
    return w.space ? gn_fma(b, b, c) : c;
}

GN_INLINE void find_strain(const gn_v3 edge[3], state *t, variant w) {
    for (int k = 0; k < 2 + w.space; k++) {
        t->f[k] = gn_scale(gn_component(t->gradient[0], k), edge[0], w.space);
        t->f[k] = gn_axpy(t->f[k], gn_component(t->gradient[1], k), edge[1], w.space);
        if (w.space) t->f[k] = gn_axpy(t->f[k], gn_component(t->gradient[2], k), edge[2], 1);
    }
    t->c[0] = stretched(t->f[0].x, t->f[0].y, t->f[0].z, w);
    t->c[1] = stretched(t->f[1].y, t->f[1].x, t->f[1].z, w);
    t->c[3] = gn_dot(t->f[0], t->f[1], w.space);
    if (!w.space) return;
    t->c[2] = stretched(t->f[2].z, t->f[2].x, t->f[2].y, w);
    t->c[4] = gn_dot(t->f[1], t->f[2], 1);
    t->c[5] = gn_dot(t->f[2], t->f[0], 1);
}

GN_INLINE void find_stress(const gn_element_args *a, size_t e, state *t, variant w) {
    const gn_elements *q = a->elements;
    gn_v minus = gn_set(0.0) - t->volume;
    gn_v mu = minus * gn_load(q->mu + gn_column_at(e, a->uniform.mu));
    gn_v lambda = gn_set(-2.0 / 3.0) * mu;
    if (!w.pressure) lambda = minus * gn_load(q->lambda + gn_column_at(e, a->uniform.lambda));
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

/* Adds the contribution of the pressure to column k of F s: -V0 p cof(F). */
GN_INLINE gn_v3 add_pressure(const state *t, int k, gn_v3 piola, variant w) {
    gn_v sum = t->pressure[1] + t->pressure[2];
    if (w.space) sum = sum + t->pressure[3];
    gn_v mean = gn_fma(gn_set(w.space ? 0.25 : 1.0 / 3.0), sum, t->pressure[0]);
    gn_v factor = gn_set(0.0) - t->volume * mean;
    if (w.space)
        return gn_axpy(piola, factor, gn_cross(t->f[(k + 1) % 3], t->f[(k + 2) % 3], 1), 1);
    const gn_v3 *other = &t->f[1 - k];
    if (k) factor = gn_set(0.0) - factor;
    piola.x = gn_fma(factor, other->y, piola.x);
    piola.y = gn_fnma(factor, other->x, piola.y);
    return piola;
}

/* Returns the row of two for a row of four at `place`. */
GN_INLINE double *row_of_two(double *rows, uint16_t place) {
    return (double *)((char *)rows + sizeof(double) / 2 * (size_t)place);
}

/* Returns sum_n gradient_n d_n over nodes 1 2 3. */
GN_INLINE gn_v3 gradient_of(const gn_v3 gradient[3], const gn_v d[3], int space) {
    gn_v3 g = gn_axpy(gn_scale(d[0], gradient[0], space), d[1], gradient[1], space);
    return space ? gn_axpy(g, d[2], gradient[2], 1) : g;
}

GN_INLINE void find_slope(const gn_element_args *a, size_t e, state *t, variant w) {
    gn_v share = gn_set(w.space ? 0.25 : 1.0 / 3.0) * t->volume * gn_load(a->elements->tau + e);
    t->slope = gn_scale(share, gradient_of(t->gradient, t->pressure + 1, w.space), w.space);
}

/* In the pressure form, the slope uses the numbers of a row that the force leaves free. */
GN_INLINE void write_row(gn_real *row, gn_v3 force, const state *t, variant w) {
    const gn_v zero = gn_set(0.0);
    gn_v columns[4] = {force.x, force.y, force.z, zero};
    if (w.pressure && w.space) columns[3] = t->slope.x;
    if (w.pressure && !w.space) {
        columns[2] = t->slope.x;
        columns[3] = t->slope.y;
    }
    gn_store_rows4(row, columns);
}

GN_INLINE void find_forces(const state *t, gn_v3 piola[3], gn_element_rows *out, variant w) {
    const gn_v zero = gn_set(0.0);
    gn_v3 first = {zero, zero, zero};
    for (int k = 0; k < 2 + w.space; k++) {
        piola[k] = gn_first_piola(t->f, t->s, k, w.space);
        if (w.pressure) piola[k] = add_pressure(t, k, piola[k], w);
    }
    for (int n = 0; n < 2 + w.space; n++) {
        gn_v3 force = gn_scale(t->gradient[n].x, piola[0], w.space);
        force = gn_axpy(force, t->gradient[n].y, piola[1], w.space);
        if (w.space) force = gn_axpy(force, t->gradient[n].z, piola[2], 1);
        first = gn_sub(first, force, w.space);
        write_row(out->row[n + 1], force, t, w);
    }
    write_row(out->row[0], first, t, w);
}

/* Adds the rest of the slope of tetrahedra. */
GN_INLINE void add_slopes(const gn_element_args *a, size_t e, size_t end, const state *t,
                          double *sums) {
    const size_t nodes = 4, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = a->partials->place + nodes * e;
    gn_real row[4 * GN_W];
    gn_v columns[4] = {t->slope.y, t->slope.z, t->slope.y, t->slope.z};
    gn_store_rows4(row, columns);
    for (size_t k = 0; k < count; k++)
        for (size_t n = 0; n < nodes; n++)
            gn_add_two(row_of_two(sums, place[nodes * k + n]), row + 4 * k);
}

/* --- measuring --- */

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

/* Padding has no volume, and its det F is ignored. */
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
            gn_v sum = gn_component(piola[0], i) * gn_component(t->f[0], j) +
                       gn_component(piola[1], i) * gn_component(t->f[1], j);
            if (w.space) sum = sum + gn_component(piola[2], i) * gn_component(t->f[2], j);
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

/* --- a block --- */

/* Computes the strain from the nodes. */
GN_INLINE void deform(const gn_element_args *a, size_t e, state *t, variant w) {
    gn_v3 edge[3];
    load_nodes(a, e, edge, t, w);
    load_gradients(a->elements, e, t, w);
    find_strain(edge, t, w);
}

/* Computes rows of forces from the strain. `slopes`: those of the block, pressure form in space. */
GN_INLINE void resist(const gn_element_args *a, size_t e, size_t end, state *t,
                      gn_element_rows *rows, double *slopes, lane_sums *s, variant w) {
    gn_v3 piola[3];
    find_stress(a, e, t, w);
    if (w.pressure) find_slope(a, e, t, w);
    find_forces(t, piola, rows, w);
    if (w.pressure && w.space) add_slopes(a, e, end, t, slopes);
    if (w.measure) measure(t, piola, e, end, s, w);
}

/* Tetrahedra of the displacement form pass through three stages, one vector in each per iteration:
 * the chain of one vector is longer than the instruction window of a core (see contact_template.c).
 * Other variants gain nothing by it. */
GN_INLINE void element_core(const gn_element_args *a, size_t begin, size_t end,
                            gn_element_sums *sums, variant w) {
    double *partial = gn_clear_block_rows(a->partials, begin, 4 * sizeof(double), a->partials->row),
           *slopes = NULL;
    if (w.pressure && w.space)
        slopes = gn_clear_block_rows(a->partials, begin, 2 * sizeof(double), a->slope_row);
    gn_block_particles ahead = gn_block_particles_of(a->partials, begin);
    lane_sums s = no_sums();
    state ring[2];
    gn_element_rows rows[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    const bool staged = w.space && !w.pressure;
    for (size_t v = 0; !staged && v < vectors; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, &a->pos, 1, gn_nodes_ahead(w.space));
        deform(a, e, &ring[0], w);
        resist(a, e, end, &ring[0], &rows[0], slopes, &s, w);
        gn_add_element_rows(a, e, end, &rows[0], partial, w.space);
    }
    for (size_t v = 0; staged && v < vectors + 2; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, &a->pos, 1, gn_nodes_ahead(w.space));
        state *before = &ring[(v + 1) % 2];
        gn_element_rows *out = &rows[(v + 1) % 2];
        if (v >= 2) gn_add_element_rows(a, e - 2 * GN_W, end, &rows[v % 2], partial, w.space);
        if (v >= 1 && v < vectors + 1) resist(a, e - GN_W, end, before, out, slopes, &s, w);
        if (v < vectors) deform(a, e, &ring[v % 2], w);
    }
    if (w.measure) fold_sums(&s, sums);
}

/* --- first pass of the pressure form --- */

/* An element's first pass: growth in volume V - V0, from the edges, and g = grad q - mean of the
 * nodes' projected gradients; node a receives (V - V0)/nodes and tau V0 grad N_a . g. */
typedef struct dilation {
    gn_v growth, term[4];
} dilation;

/* Loads edges, and the differences of q at nodes 1 2 3 from node 0. */
GN_INLINE void load_places(const gn_dilation_args *a, size_t e, gn_v3 edge[3], gn_v dq[3],
                           int space) {
    gn_v first[4], x[4];
    gn_gather4(a->place, gn_node_column(a->elements, 0) + e, first);
    for (int n = 0; n < 2 + space; n++) {
        gn_rows4_beyond(a->place, gn_node_column(a->elements, n + 1) + e, first, x);
        edge[n] = (gn_v3){x[0], x[1], gn_pick(space, x[2], gn_set(0.0))};
        dq[n] = x[3];
    }
}

/* Returns the sum of the projected gradients over the nodes. */
GN_INLINE gn_v3 load_gradient_sum(const gn_dilation_args *a, size_t e, int space) {
    const int32_t *node[4];
    gn_v sum[4];
    for (int n = 0; n < 3 + space; n++) node[n] = gn_node_column(a->elements, n) + e;
    gn_rows4_sum(a->smooth, node, 3 + space, sum);
    return (gn_v3){sum[0], sum[1], gn_pick(space, sum[2], gn_set(0.0))};
}

GN_INLINE dilation find_dilation(const gn_dilation_args *a, size_t e, int space) {
    const double nodes = 3 + space, factorial = space ? 6.0 : 2.0;
    gn_v dq[3];
    gn_v3 edge[3];
    state t;
    dilation out;
    load_places(a, e, edge, dq, space);
    load_gradients(a->elements, e, &t, (variant){.space = space});
    gn_v3 normal = gn_cross(edge[0], edge[1], space);
    gn_v det = space ? gn_dot(normal, edge[2], 1) : normal.z;
    out.growth = gn_fma(gn_set(1.0 / (factorial * nodes)), det, gn_set(-1.0 / nodes) * t.volume);
    gn_v3 g = gradient_of(t.gradient, dq, space);
    g = gn_axmy(g, gn_set(1.0 / nodes), load_gradient_sum(a, e, space), space);
    g = gn_scale(t.volume * gn_load(a->elements->tau + e), g, space);
    out.term[0] = gn_set(0.0);
    for (int n = 0; n < 2 + space; n++) {
        out.term[n + 1] = gn_dot(t.gradient[n], g, space);
        out.term[0] = out.term[0] - out.term[n + 1];
    }
    if (!space) out.term[3] = gn_set(0.0);
    return out;
}

/* Rows of two for each node. */
typedef struct dilation_rows {
    gn_real row[2][4 * GN_W];
} dilation_rows;

GN_INLINE void write_dilation(const dilation *d, dilation_rows *rows) {
    for (int n = 0; n < 2; n++) {
        gn_v columns[4] = {d->growth, d->term[2 * n], d->growth, d->term[2 * n + 1]};
        gn_store_rows4(rows->row[n], columns);
    }
}

GN_INLINE void add_dilation(const gn_dilation_args *a, size_t e, size_t end,
                            const dilation_rows *rows, double *sums, int space) {
    const size_t nodes = 3 + (size_t)space, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = a->partials->place + nodes * e;
    for (size_t k = 0; k < count; k++)
        for (size_t n = 0; n < nodes; n++)
            gn_add_two(row_of_two(sums, place[nodes * k + n]),
                       rows->row[n / 2] + 4 * k + n % 2 * 2);
}

/* Tetrahedra pass through three stages, as in element_core. */
GN_INLINE void dilation_core(const gn_dilation_args *a, size_t begin, size_t end, int space) {
    double *sums = gn_clear_block_rows(a->partials, begin, 2 * sizeof(double), a->row);
    const double *const read[2] = {a->place, a->smooth};
    gn_block_particles ahead = gn_block_particles_of(a->partials, begin);
    dilation found[2];
    dilation_rows rows[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    for (size_t v = 0; !space && v < vectors; v++) {
        gn_fetch_ahead(&ahead, read, 2, gn_nodes_ahead(0));
        found[0] = find_dilation(a, begin + v * GN_W, 0);
        write_dilation(&found[0], &rows[0]);
        add_dilation(a, begin + v * GN_W, end, &rows[0], sums, 0);
    }
    for (size_t v = 0; space && v < vectors + 2; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, read, 2, gn_nodes_ahead(1));
        if (v >= 2) add_dilation(a, e - 2 * GN_W, end, &rows[v % 2], sums, 1);
        if (v >= 1 && v < vectors + 1) write_dilation(&found[(v - 1) % 2], &rows[(v - 1) % 2]);
        if (v < vectors) found[v % 2] = find_dilation(a, e, 1);
    }
}

/* --- the variants --- */

#define GN_EACH_8(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7)

#define WRAPPER(v)                                                                                 \
    static void element_##v(const gn_element_args *a, size_t begin, size_t end,                    \
                            gn_element_sums *sums) {                                               \
        if (!GN_BUILT(ELEMENTS)) return;                                                           \
        element_core(a, begin, end, sums, (variant){GN_BIT(v, 0), GN_BIT(v, 1), GN_BIT(v, 2)});    \
    }
GN_EACH_8(WRAPPER)

#define ENTRY(v) GN_BUILT(ELEMENTS) ? element_##v : 0,
gn_element_kernel *const GN_TABLE(element)[GN_ELEMENT_VARIANTS] = {GN_EACH_8(ENTRY)};

static void dilation_triangle(const gn_dilation_args *a, size_t begin, size_t end) {
    if (GN_BUILT(PRESSURE)) dilation_core(a, begin, end, 0);
}
static void dilation_tetrahedron(const gn_dilation_args *a, size_t begin, size_t end) {
    if (GN_BUILT(PRESSURE)) dilation_core(a, begin, end, 1);
}
gn_dilation_kernel *const GN_TABLE(dilation)[2] = {dilation_triangle, dilation_tetrahedron};
