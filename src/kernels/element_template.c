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

GN_INLINE void load_nodes(const gn_element_args *args, size_t e, gn_v3 edge[3], state *now,
                          variant with) {
    gn_v first[4], x[4];
    gn_gather4(args->pos, gn_node_column(args->elements, 0) + e, first);
    if (with.pressure) {
        gn_columns4(first, x);
        now->pressure[0] = x[3];
    }
    for (int n = 0; n < 2 + with.space; n++) {
        gn_rows4_beyond(args->pos, gn_node_column(args->elements, n + 1) + e, first, x);
        edge[n] = (gn_v3){x[0], x[1], gn_pick(with.space, x[2], gn_set(0.0))};
        if (with.pressure) now->pressure[n + 1] = x[3];
    }
}

GN_INLINE void load_gradients(const gn_elements *elements, size_t e, state *now, variant with) {
    const size_t stride = elements->soa.capacity, dimension = 2 + (size_t)with.space;
    const double *column = (with.space ? elements->gradient3 : elements->gradient2) + e;
    for (size_t n = 0; n < dimension; n++)
        now->gradient[n] = gn_load3(column + n * dimension * stride, stride, with.space);
    now->volume = gn_load(elements->volume + e);
}

/* Returns |f|^2 - 1. The component that is near one for small rotations comes first, so that 1 is
 * subtracted from it without rounding. */
GN_INLINE gn_v stretched(gn_v near_one, gn_v a, gn_v b, variant with) {
    gn_v c = gn_fma(a, a, gn_fma(near_one, near_one, gn_set(-1.0)));
    return with.space ? gn_fma(b, b, c) : c;
}

GN_INLINE void find_strain(const gn_v3 edge[3], state *now, variant with) {
    for (int k = 0; k < 2 + with.space; k++) {
        now->f[k] = gn_scale(gn_component(now->gradient[0], k), edge[0], with.space);
        now->f[k] = gn_axpy(now->f[k], gn_component(now->gradient[1], k), edge[1], with.space);
        if (with.space)
            now->f[k] = gn_axpy(now->f[k], gn_component(now->gradient[2], k), edge[2], 1);
    }
    now->c[0] = stretched(now->f[0].x, now->f[0].y, now->f[0].z, with);
    now->c[1] = stretched(now->f[1].y, now->f[1].x, now->f[1].z, with);
    now->c[3] = gn_dot(now->f[0], now->f[1], with.space);
    if (!with.space) return;
    now->c[2] = stretched(now->f[2].z, now->f[2].x, now->f[2].y, with);
    now->c[4] = gn_dot(now->f[1], now->f[2], 1);
    now->c[5] = gn_dot(now->f[2], now->f[0], 1);
}

GN_INLINE void find_stress(const gn_element_args *args, size_t e, state *now, variant with) {
    const gn_elements *q = args->elements;
    gn_v minus = gn_set(0.0) - now->volume;
    gn_v mu = minus * gn_load(q->mu + gn_column_at(e, args->uniform.mu));
    gn_v lambda = gn_set(-2.0 / 3.0) * mu;
    if (!with.pressure) lambda = minus * gn_load(q->lambda + gn_column_at(e, args->uniform.lambda));
    gn_v trace = now->c[0] + now->c[1];
    if (with.space) trace = trace + now->c[2];
    gn_v mean = gn_set(0.5) * lambda * trace;
    now->s[0] = gn_fma(mu, now->c[0], mean);
    now->s[1] = gn_fma(mu, now->c[1], mean);
    now->s[3] = mu * now->c[3];
    if (!with.space) return;
    now->s[2] = gn_fma(mu, now->c[2], mean);
    now->s[4] = mu * now->c[4];
    now->s[5] = mu * now->c[5];
}

/* Adds the contribution of the pressure to column k of F s: -V0 p cof(F). */
GN_INLINE gn_v3 add_pressure(const state *now, int k, gn_v3 piola, variant with) {
    gn_v sum = now->pressure[1] + now->pressure[2];
    if (with.space) sum = sum + now->pressure[3];
    gn_v mean = gn_fma(gn_set(with.space ? 0.25 : 1.0 / 3.0), sum, now->pressure[0]);
    gn_v factor = gn_set(0.0) - now->volume * mean;
    if (with.space)
        return gn_axpy(piola, factor, gn_cross(now->f[(k + 1) % 3], now->f[(k + 2) % 3], 1), 1);
    const gn_v3 *other = &now->f[1 - k];
    if (k) factor = gn_set(0.0) - factor;
    piola.x = gn_fma(factor, other->y, piola.x);
    piola.y = gn_fnma(factor, other->x, piola.y);
    return piola;
}

/* Returns the row of two numbers that belongs to the row of four at `place`. */
GN_INLINE double *row_of_two(double *rows, uint16_t place) {
    return (double *)((char *)rows + sizeof(double) / 2 * (size_t)place);
}

/* Returns sum_n gradient_n d_n over nodes 1 2 3. */
GN_INLINE gn_v3 gradient_of(const gn_v3 gradient[3], const gn_v d[3], int space) {
    gn_v3 g = gn_axpy(gn_scale(d[0], gradient[0], space), d[1], gradient[1], space);
    return space ? gn_axpy(g, d[2], gradient[2], 1) : g;
}

GN_INLINE void find_slope(const gn_element_args *args, size_t e, state *now, variant with) {
    gn_v share =
        gn_set(with.space ? 0.25 : 1.0 / 3.0) * now->volume * gn_load(args->elements->tau + e);
    now->slope =
        gn_scale(share, gradient_of(now->gradient, now->pressure + 1, with.space), with.space);
}

/* Writes a row. In the pressure form the slope uses the numbers of a row that the force leaves
 * free. */
GN_INLINE void write_row(gn_real *row, gn_v3 force, const state *now, variant with) {
    const gn_v zero = gn_set(0.0);
    gn_v columns[4] = {force.x, force.y, force.z, zero};
    if (with.pressure && with.space) columns[3] = now->slope.x;
    if (with.pressure && !with.space) {
        columns[2] = now->slope.x;
        columns[3] = now->slope.y;
    }
    gn_store_rows4(row, columns);
}

GN_INLINE void find_forces(const state *now, gn_v3 piola[3], gn_element_rows *out, variant with) {
    const gn_v zero = gn_set(0.0);
    gn_v3 first = {zero, zero, zero};
    for (int k = 0; k < 2 + with.space; k++) {
        piola[k] = gn_first_piola(now->f, now->s, k, with.space);
        if (with.pressure) piola[k] = add_pressure(now, k, piola[k], with);
    }
    for (int n = 0; n < 2 + with.space; n++) {
        gn_v3 force = gn_scale(now->gradient[n].x, piola[0], with.space);
        force = gn_axpy(force, now->gradient[n].y, piola[1], with.space);
        if (with.space) force = gn_axpy(force, now->gradient[n].z, piola[2], 1);
        first = gn_sub(first, force, with.space);
        write_row(out->row[n + 1], force, now, with);
    }
    write_row(out->row[0], first, now, with);
}

/* Adds the remaining components of the slope of tetrahedra. */
GN_INLINE void add_slopes(const gn_element_args *args, size_t e, size_t end, const state *now,
                          double *sums) {
    const size_t nodes = 4, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = args->partials->place + nodes * e;
    gn_real row[4 * GN_W];
    gn_v columns[4] = {now->slope.y, now->slope.z, now->slope.y, now->slope.z};
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

GN_INLINE gn_v determinant(const state *now, variant with) {
    gn_v3 normal = gn_cross(now->f[0], now->f[1], with.space);
    return with.space ? gn_dot(normal, now->f[2], 1) : normal.z;
}

/* Padding has no volume, and its det F is ignored. */
GN_INLINE void measure(const state *now, const gn_v3 piola[3], size_t e, size_t end,
                       lane_sums *sums, variant with) {
    static const double lanes[8] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    gn_v own = now->s[0] * now->c[0] + now->s[1] * now->c[1], shear = now->s[3] * now->c[3];
    if (with.space) {
        own = own + now->s[2] * now->c[2];
        shear = shear + (now->s[4] * now->c[4] + now->s[5] * now->c[5]);
    }
    sums->elastic = sums->elastic - gn_set(0.25) * (own + gn_set(2.0) * shear);
    for (int i = 0; i < 2 + with.space; i++)
        for (int j = 0; j < 2 + with.space; j++) {
            gn_v sum = gn_component(piola[0], i) * gn_component(now->f[0], j) +
                       gn_component(piola[1], i) * gn_component(now->f[1], j);
            if (with.space) sum = sum + gn_component(piola[2], i) * gn_component(now->f[2], j);
            sums->stress[3 * i + j] = sums->stress[3 * i + j] - sum;
        }
    gn_v det = determinant(now, with), element = gn_set((double)e) + gn_load(lanes);
    sums->volume = sums->volume + now->volume * det;
    gn_m less = gn_and(gn_less(det, sums->least), gn_less(element, gn_set((double)end)));
    sums->least = gn_where(less, det, sums->least);
    sums->element = gn_where(less, element, sums->element);
}

GN_INLINE void fold_sums(const lane_sums *sums, gn_element_sums *out) {
    double least[GN_W], element[GN_W];
    out->elastic += gn_fold(sums->elastic);
    out->volume += gn_fold(sums->volume);
    for (int k = 0; k < 9; k++) out->stress[k] += gn_fold(sums->stress[k]);
    gn_store(least, sums->least);
    gn_store(element, sums->element);
    for (int k = 0; k < GN_W; k++) {
        bool first = least[k] == out->least && element[k] < (double)out->element;
        if (!(least[k] < out->least || first)) continue;
        out->least = least[k];
        out->element = (int64_t)element[k];
    }
}

/* --- a block --- */

/* Computes the strain from the nodes. */
GN_INLINE void deform(const gn_element_args *args, size_t e, state *now, variant with) {
    gn_v3 edge[3];
    load_nodes(args, e, edge, now, with);
    load_gradients(args->elements, e, now, with);
    find_strain(edge, now, with);
}

/* Computes rows of forces from the strain. `slopes`: those of the block, pressure form in space. */
GN_INLINE void resist(const gn_element_args *args, size_t e, size_t end, state *now,
                      gn_element_rows *rows, double *slopes, lane_sums *sums, variant with) {
    gn_v3 piola[3];
    find_stress(args, e, now, with);
    if (with.pressure) find_slope(args, e, now, with);
    find_forces(now, piola, rows, with);
    if (with.pressure && with.space) add_slopes(args, e, end, now, slopes);
    if (with.measure) measure(now, piola, e, end, sums, with);
}

/* Tetrahedra of the displacement form pass through three stages, with one vector in each per
 * iteration, because the chain of operations of one vector is longer than the instruction window of
 * a core (see contact_template.c). Other variants gain nothing by it. */
GN_INLINE void element_core(const gn_element_args *args, size_t begin, size_t end,
                            gn_element_sums *sums, variant with) {
    double *partial =
               gn_clear_block_rows(args->partials, begin, 4 * sizeof(double), args->partials->row),
           *slopes = NULL;
    if (with.pressure && with.space)
        slopes = gn_clear_block_rows(args->partials, begin, 2 * sizeof(double), args->slope_row);
    gn_block_particles ahead = gn_block_particles_of(args->partials, begin);
    lane_sums s = no_sums();
    state ring[2];
    gn_element_rows rows[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    const bool staged = with.space && !with.pressure;
    for (size_t v = 0; !staged && v < vectors; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, &args->pos, 1, gn_nodes_ahead(with.space));
        deform(args, e, &ring[0], with);
        resist(args, e, end, &ring[0], &rows[0], slopes, &s, with);
        gn_add_element_rows(args, e, end, &rows[0], partial, with.space);
    }
    for (size_t v = 0; staged && v < vectors + 2; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, &args->pos, 1, gn_nodes_ahead(with.space));
        state *before = &ring[(v + 1) % 2];
        gn_element_rows *out = &rows[(v + 1) % 2];
        if (v >= 2) gn_add_element_rows(args, e - 2 * GN_W, end, &rows[v % 2], partial, with.space);
        if (v >= 1 && v < vectors + 1) resist(args, e - GN_W, end, before, out, slopes, &s, with);
        if (v < vectors) deform(args, e, &ring[v % 2], with);
    }
    if (with.measure) fold_sums(&s, sums);
}

/* --- first pass of the pressure form --- */

/* First pass over an element: growth in volume V - V0, from the edges, and g = grad q - mean of the
 * nodes' projected gradients. Node a receives (V - V0)/nodes and tau V0 grad N_a . g. */
typedef struct dilation {
    gn_v growth, term[4];
} dilation;

/* Loads edges, and the differences of q at nodes 1 2 3 from node 0. */
GN_INLINE void load_places(const gn_dilation_args *args, size_t e, gn_v3 edge[3], gn_v dq[3],
                           int space) {
    gn_v first[4], x[4];
    gn_gather4(args->place, gn_node_column(args->elements, 0) + e, first);
    for (int n = 0; n < 2 + space; n++) {
        gn_rows4_beyond(args->place, gn_node_column(args->elements, n + 1) + e, first, x);
        edge[n] = (gn_v3){x[0], x[1], gn_pick(space, x[2], gn_set(0.0))};
        dq[n] = x[3];
    }
}

/* Returns the sum of the projected gradients over the nodes. */
GN_INLINE gn_v3 load_gradient_sum(const gn_dilation_args *args, size_t e, int space) {
    const int32_t *node[4];
    gn_v sum[4];
    for (int n = 0; n < 3 + space; n++) node[n] = gn_node_column(args->elements, n) + e;
    gn_rows4_sum(args->smooth, node, 3 + space, sum);
    return (gn_v3){sum[0], sum[1], gn_pick(space, sum[2], gn_set(0.0))};
}

GN_INLINE dilation find_dilation(const gn_dilation_args *args, size_t e, int space) {
    const double nodes = 3 + space, factorial = space ? 6.0 : 2.0;
    gn_v dq[3];
    gn_v3 edge[3];
    state t;
    dilation out;
    load_places(args, e, edge, dq, space);
    load_gradients(args->elements, e, &t, (variant){.space = space});
    gn_v3 normal = gn_cross(edge[0], edge[1], space);
    gn_v det = space ? gn_dot(normal, edge[2], 1) : normal.z;
    out.growth = gn_fma(gn_set(1.0 / (factorial * nodes)), det, gn_set(-1.0 / nodes) * t.volume);
    gn_v3 g = gradient_of(t.gradient, dq, space);
    g = gn_axmy(g, gn_set(1.0 / nodes), load_gradient_sum(args, e, space), space);
    g = gn_scale(t.volume * gn_load(args->elements->tau + e), g, space);
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

GN_INLINE void write_dilation(const dilation *values, dilation_rows *rows) {
    for (int n = 0; n < 2; n++) {
        gn_v columns[4] = {values->growth, values->term[2 * n], values->growth,
                           values->term[2 * n + 1]};
        gn_store_rows4(rows->row[n], columns);
    }
}

GN_INLINE void add_dilation(const gn_dilation_args *args, size_t e, size_t end,
                            const dilation_rows *rows, double *sums, int space) {
    const size_t nodes = 3 + (size_t)space, count = end - e < GN_W ? end - e : GN_W;
    const uint16_t *place = args->partials->place + nodes * e;
    for (size_t k = 0; k < count; k++)
        for (size_t n = 0; n < nodes; n++)
            gn_add_two(row_of_two(sums, place[nodes * k + n]),
                       rows->row[n / 2] + 4 * k + n % 2 * 2);
}

/* Tetrahedra pass through three stages, as in element_core. */
GN_INLINE void dilation_core(const gn_dilation_args *args, size_t begin, size_t end, int space) {
    double *sums = gn_clear_block_rows(args->partials, begin, 2 * sizeof(double), args->row);
    const double *const read[2] = {args->place, args->smooth};
    gn_block_particles ahead = gn_block_particles_of(args->partials, begin);
    dilation found[2];
    dilation_rows rows[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    for (size_t v = 0; !space && v < vectors; v++) {
        gn_fetch_ahead(&ahead, read, 2, gn_nodes_ahead(0));
        found[0] = find_dilation(args, begin + v * GN_W, 0);
        write_dilation(&found[0], &rows[0]);
        add_dilation(args, begin + v * GN_W, end, &rows[0], sums, 0);
    }
    for (size_t v = 0; space && v < vectors + 2; v++) {
        const size_t e = begin + v * GN_W;
        gn_fetch_ahead(&ahead, read, 2, gn_nodes_ahead(1));
        if (v >= 2) add_dilation(args, e - 2 * GN_W, end, &rows[v % 2], sums, 1);
        if (v >= 1 && v < vectors + 1) write_dilation(&found[(v - 1) % 2], &rows[(v - 1) % 2]);
        if (v < vectors) found[v % 2] = find_dilation(args, e, 1);
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

static void dilation_triangle(const gn_dilation_args *args, size_t begin, size_t end) {
    if (GN_BUILT(PRESSURE)) dilation_core(args, begin, end, 0);
}
static void dilation_tetrahedron(const gn_dilation_args *args, size_t begin, size_t end) {
    if (GN_BUILT(PRESSURE)) dilation_core(args, begin, end, 1);
}
gn_dilation_kernel *const GN_TABLE(dilation)[2] = {dilation_triangle, dilation_tetrahedron};
