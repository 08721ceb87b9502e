/* The element kernels: every variant of every instruction set against the scalar one, and the
 * scalar one against an independent computation in plain doubles. */
#include "fem_helpers.h"
#include "neigh/neigh.h"

#include <float.h>

enum { ELEMENTS = 1211, NODES = 400 }; /* several blocks, a part of a block, a part of a vector */

typedef struct bench {
    gn_particles nodes;
    gn_elements elements;
    gn_partials sums;
    gn_element_args args;
    int dimension;
    double reference[NODES][3];
    double *slope_row, *growth_row; /* rows of the pressure form */
    double allowed;                 /* N: round-off of a node's force */
} bench;

static void edges(const bench *b, const double *rows, size_t stride, size_t e, double out[3][3]) {
    const double *first = rows + stride * (size_t)gn_elements_node(&b->elements, 0)[e];
    memset(out, 0, 9 * sizeof(double));
    out[2][2] = b->dimension == 2 ? 1.0 : 0.0;
    for (int a = 1; a <= b->dimension; a++) {
        const double *x = rows + stride * (size_t)gn_elements_node(&b->elements, a)[e];
        for (int k = 0; k < b->dimension; k++) out[k][a - 1] = x[k] - first[k];
    }
}

/* Nodes of an element of a decent shape. */
static void pick_nodes(bench *b, size_t e, uint64_t *at) {
    double edge[3][3], size = b->dimension == 3 ? 0.2 : 0.3;
    do
        for (int a = 0; a <= b->dimension; a++)
            gn_elements_node(&b->elements, a)[e] = (int32_t)uniform(at, 0.0, NODES - 1e-9);
    while (edges(b, &b->reference[0][0], 3, e, edge), determinant(edge) < size);
}

static void make_element(bench *b, size_t e, uint64_t *at) {
    double edge[3][3], inverse[3][3];
    pick_nodes(b, e, at);
    edges(b, &b->reference[0][0], 3, e, edge);
    invert(edge, inverse);
    for (int a = 1; a <= b->dimension; a++)
        for (int k = 0; k < b->dimension; k++)
            gn_elements_gradient(&b->elements, a, k)[e] = inverse[a - 1][k];
    b->elements.volume[e] = determinant(edge) / (b->dimension == 3 ? 6.0 : 2.0);
    b->elements.lambda[e] = uniform(at, 1e9, 3e9);
    b->elements.mu[e] = uniform(at, 1e9, 3e9);
    b->elements.tau[e] = uniform(at, 1e-12, 3e-12);
    b->elements.id[e] = (int32_t)e;
}

/* Random elements over nodes in a unit box, strained by some 10 % and rotated; pressures at the
 * nodes, stored where particles have their radius, and a stabilising pressure of any gradient. */
static bench make_bench(int dimension, uint64_t seed) {
    bench b = {.dimension = dimension, .allowed = 1e-12 * 3e9};
    gn_effects effects = GN_FX_PRESSURE | (dimension == 3 ? GN_FX_SPACE : 0);
    double turn[3][3], stretch[3][3] = {{0.0}}, f[3][3];
    const double axis[3] = {dimension == 3 ? 0.3 : 0.0, dimension == 3 ? -0.5 : 0.0, 1.0};
    assert_int_equal(gn_soa_create(&gn_particle_record, &b.nodes, NODES, effects, NULL), GNEISS_OK);
    assert_int_equal(gn_soa_create(&gn_element_record, &b.elements, ELEMENTS, effects, NULL),
                     GNEISS_OK);
    for (int i = 0; i < dimension; i++)
        for (int k = 0; k < dimension; k++)
            stretch[i][k] = (i == k ? 1.0 : 0.0) + uniform(&seed, -0.1, 0.1);
    rotation(axis, 2.0, turn);
    multiply(turn, stretch, f);
    for (size_t n = 0; n < NODES; n++) {
        for (int k = 0; k < dimension; k++) b.reference[n][k] = uniform(&seed, 0.0, 1.0);
        for (int k = 0; k < dimension; k++)
            b.nodes.pos[4 * n + (size_t)k] =
                dot3(f[k], b.reference[n]) + uniform(&seed, -0.01, 0.01);
        b.nodes.pos[4 * n + 3] = uniform(&seed, -1e9, 1e9);
        for (size_t k = 0; k < 4; k++) b.nodes.smooth[4 * n + k] = uniform(&seed, -1e9, 1e9);
    }
    for (size_t e = 0; e < ELEMENTS; e++) make_element(&b, e, &seed);
    gn_particles_set_null(&b.nodes, 1.0);
    gn_elements_pad(&b.elements, &b.nodes);
    assert_int_equal(gn_element_partials_build(&b.elements, NODES, 1, &b.sums, NULL), GNEISS_OK);
    size_t rows = (size_t)b.sums.first[b.sums.blocks];
    b.slope_row = calloc(rows, 2 * sizeof(double));
    b.growth_row = calloc(rows, 2 * sizeof(double));
    b.args = (gn_element_args){
        .pos = b.nodes.pos, .elements = &b.elements, .partials = &b.sums, .slope_row = b.slope_row};
    return b;
}

static void free_bench(bench *b) {
    gn_soa_destroy(&gn_particle_record, &b->nodes);
    gn_soa_destroy(&gn_element_record, &b->elements);
    gn_partials_free(&b->sums);
    free(b->slope_row);
    free(b->growth_row);
}

/* Positions are those of make_bench, even after the struct was copied. */
static gn_element_sums run(bench *b, gn_element_kernel *kernel) {
    gn_element_sums sums = GN_ELEMENT_SUMS_ZERO;
    b->args.elements = &b->elements;
    b->args.partials = &b->sums;
    assert_true(b->sums.blocks > 2);
    for (size_t k = 0; k < b->sums.blocks; k++) {
        size_t begin = k * b->sums.length, end = begin + b->sums.length;
        kernel(&b->args, begin, end < ELEMENTS ? end : ELEMENTS, &sums);
    }
    return sums;
}

/* --- the oracle: F from the matrices of edges, forces from tractions on the reference faces --- */

typedef struct expected {
    double force[NODES][3], elastic, stress[9], volume, least;
    double gradient[NODES][3], growth[NODES][2]; /* pressure form */
    int64_t element;
} expected;

/* Area times outward normal of the face opposite to node a, of positions in rows. */
static void face(const bench *b, const double *rows, size_t stride, size_t e, int a,
                 double normal[3]) {
    const double *x[4] = {0}, *own = rows + stride * (size_t)gn_elements_node(&b->elements, a)[e];
    int others = 0;
    for (int c = 0; c <= b->dimension; c++)
        if (c != a) x[others++] = rows + stride * (size_t)gn_elements_node(&b->elements, c)[e];
    double u[3] = {0}, v[3] = {0.0, 0.0, 2.0}, inward[3] = {0}, side = 0.0;
    for (int k = 0; k < 3; k++) {
        if (k == b->dimension) break; /* the fourth number of a row is no coordinate */
        u[k] = x[1][k] - x[0][k];
        if (b->dimension == 3) v[k] = x[2][k] - x[0][k];
        inward[k] = own[k] - x[0][k];
    }
    for (int k = 0; k < 3; k++) {
        normal[k] = 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        side += normal[k] * inward[k];
    }
    for (int k = 0; side > 0.0 && k < 3; k++) normal[k] = -normal[k];
}

/* Gradient, in the initial configuration, of a field with the values v at the nodes. */
static void slope(const bench *b, size_t e, const double *v, size_t stride, double g[3]) {
    double before[3][3], inverse[3][3];
    size_t first = stride * (size_t)gn_elements_node(&b->elements, 0)[e];
    edges(b, &b->reference[0][0], 3, e, before);
    invert(before, inverse);
    for (int k = 0; k < 3; k++) g[k] = 0.0;
    for (int a = 1; a <= b->dimension; a++)
        for (int k = 0; k < b->dimension; k++)
            g[k] += inverse[a - 1][k] *
                    (v[stride * (size_t)gn_elements_node(&b->elements, a)[e]] - v[first]);
}

/* Adds the forces of the nodes' pressures in an element, which act on its present faces. */
static void expect_pressure(const bench *b, size_t e, double volume, double det, expected *out) {
    const gn_elements *q = &b->elements;
    const int nodes = b->dimension + 1;
    double mean = 0.0, normal[3], g[3];
    for (int a = 0; a < nodes; a++) mean += b->nodes.pos[4 * gn_elements_node(q, a)[e] + 3] / nodes;
    slope(b, e, b->nodes.pos + 3, 4, g);
    for (int a = 0; a < nodes; a++) {
        int32_t n = gn_elements_node(q, a)[e];
        face(b, b->nodes.pos, 4, e, a, normal);
        for (int k = 0; k < b->dimension; k++) {
            out->force[n][k] += mean * normal[k] / b->dimension;
            out->gradient[n][k] += q->tau[e] * volume / nodes * g[k];
        }
    }
    for (int k = 0; k < b->dimension; k++) out->stress[4 * k] += mean * volume * det;
}

/* Growth in volume, and tau V0 grad N_a . (grad q - mean of the projected gradients); the gradient
 * of N_a is minus the area of the opposite face over d V0. */
static void expect_growth(const bench *b, size_t e, double volume, double det, expected *out) {
    const gn_elements *q = &b->elements;
    const int nodes = b->dimension + 1;
    double g[3], normal[3];
    slope(b, e, b->nodes.pos + 3, 4, g);
    for (int a = 0; a < nodes; a++)
        for (int k = 0; k < b->dimension; k++)
            g[k] -= b->nodes.smooth[4 * gn_elements_node(q, a)[e] + k] / nodes;
    for (int a = 0; a < nodes; a++) {
        int32_t n = gn_elements_node(q, a)[e];
        face(b, &b->reference[0][0], 3, e, a, normal);
        out->growth[n][0] += volume * (det - 1.0) / nodes;
        out->growth[n][1] -= q->tau[e] * dot3(normal, g) / b->dimension;
    }
}

static void expect_element(const bench *b, size_t e, bool mixed, expected *out) {
    double before[3][3], now[3][3], inverse[3][3], f[3][3], s[3][3], p[3][3], normal[3];
    const gn_elements *q = &b->elements;
    edges(b, &b->reference[0][0], 3, e, before);
    edges(b, b->nodes.pos, 4, e, now);
    invert(before, inverse);
    multiply(now, inverse, f);
    double lambda = mixed ? -2.0 / 3.0 * q->mu[e] : q->lambda[e];
    double density = kirchhoff(f, lambda, q->mu[e], s), det = determinant(f);
    double volume = determinant(before) / (b->dimension == 3 ? 6.0 : 2.0);
    multiply(f, s, p);
    for (int a = 0; a <= b->dimension; a++) {
        face(b, &b->reference[0][0], 3, e, a, normal);
        for (int k = 0; k < b->dimension; k++)
            out->force[gn_elements_node(q, a)[e]][k] += dot3(p[k], normal) / b->dimension;
    }
    for (int i = 0; i < b->dimension; i++)
        for (int k = 0; k < b->dimension; k++)
            out->stress[3 * i + k] += volume * (p[i][0] * f[k][0] + p[i][1] * f[k][1] +
                                                (b->dimension == 3 ? p[i][2] * f[k][2] : 0.0));
    out->elastic += volume * density;
    out->volume += volume * det;
    if (mixed) expect_pressure(b, e, volume, det, out);
    if (mixed) expect_growth(b, e, volume, det, out);
    if (det >= out->least) return;
    out->least = det;
    out->element = (int64_t)e;
}

static expected *expect(const bench *b, bool mixed) {
    expected *want = calloc(1, sizeof *want);
    want->least = INFINITY;
    for (size_t e = 0; e < ELEMENTS; e++) expect_element(b, e, mixed, want);
    return want;
}

static void scalar_kernels_agree_with_long_hand_mechanics(void **state) {
    (void)state;
    for (int v = 0; v < 4; v++) {
        const int d = v & 1 ? 3 : 2;
        const bool mixed = v & 2;
        bench b = make_bench(d, 11);
        expected *want = expect(&b, mixed);
        gn_element_sums got =
            run(&b, gn_element_table_scalar[gn_element_variant(d == 3, true, mixed)]);
        for (int32_t n = 0; n < NODES; n++) {
            double force[3];
            fem_force(&b.sums, n, force);
            for (int k = 0; k < d; k++) assert_near(force[k], want->force[n][k], b.allowed);
        }
        assert_close(got.elastic, want->elastic, 1e-12);
        assert_close(got.volume, want->volume, 1e-12);
        assert_close(got.least, want->least, 1e-12);
        assert_int_equal(got.element, want->element);
        for (int k = 0; k < 9; k++)
            assert_near(got.stress[k], want->stress[k], 1e-12 * want->elastic * 10.0);
        free(want);
        free_bench(&b);
    }
}

/* Sums the rows of a node, of the given width. */
static double row_sum(const bench *b, const double *row, size_t width, int32_t node, size_t k) {
    const gn_partials *q = &b->sums;
    double sum = 0.0;
    for (int32_t s = q->start[node / GN_PARTICLE_BLOCK]; s < q->start[node / GN_PARTICLE_BLOCK + 1];
         s++)
        if (q->share[s].particle == node) sum += row[width * (size_t)q->share[s].row + k];
    return sum;
}

/* Slopes are stored in components that forces do not use, and other quantities in rows of their
 * own. */
static double slope_sum(const bench *b, int32_t node, size_t k) {
    if (b->dimension == 2) return row_sum(b, b->sums.row, 4, node, 2 + k);
    return k ? row_sum(b, b->slope_row, 2, node, k - 1) : row_sum(b, b->sums.row, 4, node, 3);
}

static void gradients_of_pressures_agree_with_long_hand_mechanics(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        bench b = make_bench(d, 12);
        expected *want = expect(&b, true);
        run(&b, gn_element_table_scalar[gn_element_variant(d == 3, false, true)]);
        /* Some ten elements meet at a node, with edges from 0.3 m: tau V dp/dx. */
        for (int32_t n = 0; n < NODES; n++)
            for (size_t k = 0; k < (size_t)d; k++)
                assert_near(slope_sum(&b, n, k), want->gradient[n][k], 1e-14);
        free(want);
        free_bench(&b);
    }
}

static void run_dilation(bench *b, gn_dilation_kernel *kernel) {
    const gn_dilation_args args = {b->nodes.pos, b->nodes.smooth, &b->elements, &b->sums,
                                   b->growth_row};
    for (size_t k = 0; k < b->sums.blocks; k++) {
        size_t begin = k * b->sums.length, end = begin + b->sums.length;
        kernel(&args, begin, end < ELEMENTS ? end : ELEMENTS);
    }
}

static void dilation_kernels_agree_with_long_hand_mechanics(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        bench b = make_bench(d, 13);
        expected *want = expect(&b, true);
        run_dilation(&b, gn_dilation_table_scalar[d == 3]);
        for (int32_t n = 0; n < NODES; n++)
            for (size_t k = 0; k < 2; k++)
                assert_near(row_sum(&b, b.growth_row, 2, n, k), want->growth[n][k],
                            k ? 1e-13 : 1e-15);
        free(want);
        free_bench(&b);
    }
}

static void every_dilation_kernel_has_the_bits_of_the_scalar_one(void **state) {
    (void)state;
    for (int s = 1; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        for (int d = 2; d <= 3 && runs_here(set); d++) {
            bench a = make_bench(d, 14), b = make_bench(d, 14);
            run_dilation(&a, gn_dilation_table_scalar[d == 3]);
            run_dilation(&b, set->dilation[d == 3]);
            assert_memory_equal(a.growth_row, b.growth_row,
                                2 * (size_t)a.sums.first[a.sums.blocks] * sizeof(double));
            free_bench(&a);
            free_bench(&b);
        }
    }
}

static void assert_same_rows(const bench *a, const bench *b) {
    size_t size = 4 * (size_t)a->sums.first[a->sums.blocks] * sizeof *a->sums.row;
    assert_memory_equal(a->sums.row, b->sums.row, size);
    assert_memory_equal(a->slope_row, b->slope_row, size / 2);
}

static void every_element_kernel_has_the_bits_of_the_scalar_one(void **state) {
    (void)state;
    for (int s = 1; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!runs_here(set)) continue;
        for (unsigned v = 0; v < GN_ELEMENT_VARIANTS; v++) {
            bench a = make_bench(v & 1 ? 3 : 2, 100 + v), b = make_bench(v & 1 ? 3 : 2, 100 + v);
            gn_element_sums want = run(&a, gn_element_table_scalar[v]);
            gn_element_sums got = run(&b, set->element[v]);
            assert_same_rows(&a, &b);
            assert_true(want.least == got.least);
            assert_int_equal(want.element, got.element);
            assert_close(want.elastic, got.elastic, 1e-13);
            assert_close(want.volume, got.volume, 1e-13);
            for (int k = 0; k < 9; k++)
                assert_near(want.stress[k], got.stress[k], 1e-13 * 10.0 * want.elastic);
            free_bench(&a);
            free_bench(&b);
        }
    }
}

static void measuring_changes_no_force(void **state) {
    (void)state;
    for (int v = 0; v < 4; v++) {
        const int d = v & 1 ? 3 : 2;
        bench a = make_bench(d, 5), b = make_bench(d, 5);
        run(&a, gn_element_table_scalar[gn_element_variant(d == 3, false, v & 2)]);
        run(&b, gn_element_table_scalar[gn_element_variant(d == 3, true, v & 2)]);
        assert_same_rows(&a, &b);
        free_bench(&a);
        free_bench(&b);
    }
}

static void shared_parameters_give_the_bits_of_columns(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        bench a = make_bench(d, 6), b = make_bench(d, 6);
        for (size_t e = 0; e < ELEMENTS; e++) {
            a.elements.lambda[e] = a.elements.lambda[0];
            a.elements.mu[e] = a.elements.mu[0];
        }
        b.args.uniform = (gn_element_uniform){~(size_t)0, ~(size_t)0};
        b.elements.lambda[100] = b.elements.mu[100] = NAN; /* not read */
        for (size_t k = 0; k < GN_LANES_MAX; k++) {        /* one vector of shared values is read */
            b.elements.lambda[k] = a.elements.lambda[0];
            b.elements.mu[k] = a.elements.mu[0];
        }
        run(&a, gn_element_table_scalar[gn_element_variant(d == 3, false, false)]);
        run(&b, gn_element_table_scalar[gn_element_variant(d == 3, false, false)]);
        assert_same_rows(&a, &b);
        free_bench(&a);
        free_bench(&b);
    }
}

static void forces_of_an_element_have_no_resultant_and_no_moment(void **state) {
    (void)state;
    for (int v = 0; v < 4; v++) {
        const int d = v & 1 ? 3 : 2;
        bench b = make_bench(d, 21);
        gn_element_sums none = GN_ELEMENT_SUMS_ZERO;
        for (size_t e = 0; e < ELEMENTS; e += b.sums.length) {
            double force[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
            b.args.elements = &b.elements;
            b.args.partials = &b.sums;
            b.args.pos = b.nodes.pos;
            gn_element_table_scalar[gn_element_variant(d == 3, false, v & 2)](&b.args, e, e + 1,
                                                                              &none);
            for (int a = 0; a <= d; a++) {
                const double *x = b.nodes.pos + 4 * (size_t)gn_elements_node(&b.elements, a)[e];
                const uint16_t place = b.sums.place[(size_t)(d + 1) * e + (size_t)a];
                const int32_t first = b.sums.first[e / b.sums.length];
                assert_int_equal(b.sums.particle[first + place / 4],
                                 gn_elements_node(&b.elements, a)[e]);
                const double *f = b.sums.row + 4 * (size_t)first + place;
                const double own[3] = {f[0], f[1], d == 3 ? f[2] : 0.0};
                for (int k = 0; k < 3; k++) {
                    force[k] += own[k];
                    moment[k] +=
                        x[(k + 1) % 3] * own[(k + 2) % 3] - x[(k + 2) % 3] * own[(k + 1) % 3];
                    size += fabs(own[k]);
                }
            }
            assert_true(size > 1e6); /* N: the element is strained */
            for (int k = 0; k < 3; k++) assert_near(force[k], 0.0, 1e-14 * size);
            for (int k = 0; k < 3; k++) assert_near(moment[k], 0.0, 1e-14 * size);
        }
        free_bench(&b);
    }
}

/* f = -dU/dx: the energy in the ledger is the potential of the forces. */
static void forces_are_the_slope_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        bench b = make_bench(d, 31);
        gn_element_kernel *kernel =
            gn_element_table_scalar[gn_element_variant(d == 3, true, false)];
        const double step = 1e-4;
        double scale = run(&b, kernel).elastic;
        for (int32_t n = 0; n < 10; n++)
            for (int k = 0; k < d; k++) {
                double force[3], *x = &b.nodes.pos[4 * n + k], at = *x;
                run(&b, kernel);
                fem_force(&b.sums, n, force);
                *x = at + step;
                double above = run(&b, kernel).elastic;
                *x = at - step;
                double below = run(&b, kernel).elastic;
                *x = at;
                /* A quartic in x: the difference has an error of step^2 times third derivatives. */
                assert_near(-(above - below) / (2.0 * step), force[k], 1e-6 * scale);
            }
        free_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scalar_kernels_agree_with_long_hand_mechanics),
        cmocka_unit_test(gradients_of_pressures_agree_with_long_hand_mechanics),
        cmocka_unit_test(dilation_kernels_agree_with_long_hand_mechanics),
        cmocka_unit_test(every_dilation_kernel_has_the_bits_of_the_scalar_one),
        cmocka_unit_test(every_element_kernel_has_the_bits_of_the_scalar_one),
        cmocka_unit_test(measuring_changes_no_force),
        cmocka_unit_test(shared_parameters_give_the_bits_of_columns),
        cmocka_unit_test(forces_of_an_element_have_no_resultant_and_no_moment),
        cmocka_unit_test(forces_are_the_slope_of_the_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
