/* Samples, statistics and keys of sweeps. */
#include "test.h"

#include "scene/manifest.h"
#include "sweep/sample.h"
#include "sweep/summary.h"
#include "sweep/sweep.h"

/* ---- Latin hypercube ---- */

static void every_stratum_of_a_latin_hypercube_holds_one_point(void **state) {
    (void)state;
    static const size_t counts[] = {1, 2, 3, 10, 97, 1000};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
        for (size_t dimension = 0; dimension < 40; dimension++) {
            size_t n = counts[c], held[1000] = {0};
            double points[1000];
            gn_sample_latin(7, dimension, n, points);
            for (size_t k = 0; k < n; k++) {
                assert_true(points[k] > 0.0 && points[k] < 1.0);
                held[(size_t)(points[k] * (double)n)]++;
            }
            for (size_t k = 0; k < n; k++) assert_int_equal(held[k], 1);
        }
}

static double correlation(const double *a, const double *b, size_t count) {
    double sum = 0.0;
    for (size_t k = 0; k < count; k++) sum += (a[k] - 0.5) * (b[k] - 0.5);
    return 12.0 * sum / (double)count; /* the variance of a uniform number is 1/12 */
}

/* For independent coordinates the correlation has the standard deviation 1/sqrt(n): 0.01 here, and
 * none of 190 exceeds five of them except once in ten thousand seeds. */
static void coordinates_of_a_latin_hypercube_are_independent(void **state) {
    (void)state;
    enum { N = 10000, D = 20 };
    double *points = malloc(sizeof(double) * N * D);
    assert_non_null(points);
    for (size_t d = 0; d < D; d++) gn_sample_latin(1, d, N, points + d * N);
    for (size_t a = 0; a < D; a++)
        for (size_t b = 0; b < a; b++)
            assert_true(fabs(correlation(points + a * N, points + b * N, N)) < 0.05);
    free(points);
}

static void another_seed_gives_another_sample(void **state) {
    (void)state;
    double a[50], b[50], c[50];
    gn_sample_latin(1, 0, 50, a);
    gn_sample_latin(2, 0, 50, b);
    gn_sample_latin(1, 0, 50, c);
    assert_memory_not_equal(a, b, sizeof a);
    assert_memory_equal(a, c, sizeof a);
    gn_sample_sobol(1, 3, 50, a);
    gn_sample_sobol(2, 3, 50, b);
    gn_sample_sobol(1, 3, 50, c);
    assert_memory_not_equal(a, b, sizeof a);
    assert_memory_equal(a, c, sizeof a);
}

/* ---- Sobol's sequence ---- */

/* The first ten points of three coordinates as Joe & Kuo print them with their table (their program
 * sobol.cc, `sobol 10 3 new-joe-kuo-6.21201`). */
static void the_first_points_of_sobol_are_the_published_ones(void **state) {
    (void)state;
    static const double published[10][3] = {{0, 0, 0},
                                            {0.5, 0.5, 0.5},
                                            {0.75, 0.25, 0.25},
                                            {0.25, 0.75, 0.75},
                                            {0.375, 0.375, 0.625},
                                            {0.875, 0.875, 0.125},
                                            {0.625, 0.125, 0.875},
                                            {0.125, 0.625, 0.375},
                                            {0.1875, 0.3125, 0.9375},
                                            {0.6875, 0.8125, 0.4375}};
    for (uint32_t k = 0; k < 10; k++)
        for (size_t d = 0; d < 3; d++)
            assert_true((double)gn_sobol_bits(d, k) * 0x1p-32 == published[k][d]);
}

/* Points 1 and 1000 of every coordinate, over 2^32, as scipy.stats.qmc.Sobol (1.10, not scrambled,
 * 32 bits), which has the same table, gives them. */
static void far_points_of_every_coordinate_are_those_of_scipy(void **state) {
    (void)state;
    static const uint32_t point_1000[GN_SOBOL_DIMENSIONS] = {
        943718400u,  415236096u,  2227175424u, 2906652672u, 1203765248u, 3896508416u, 197132288u,
        3862953984u, 2151677952u, 297795584u,  364904448u,  1094713344u, 692060160u,  1648361472u,
        616562688u,  1589641216u, 3091202048u, 1480589312u, 4257218560u, 3116367872u, 2243952640u};
    for (size_t d = 0; d < GN_SOBOL_DIMENSIONS; d++) {
        assert_int_equal(gn_sobol_bits(d, 1), UINT32_C(1) << 31);
        assert_int_equal(gn_sobol_bits(d, 1000), point_1000[d]);
    }
}

/* The sequence is even because every one of 2^m equal parts of each axis contains one of 2^m
 * points, and a shift of digits preserves that. */
static void two_to_the_m_points_of_sobol_fill_as_many_strata(void **state) {
    (void)state;
    enum { N = 256 };
    for (size_t d = 0; d < GN_SOBOL_DIMENSIONS; d++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            double points[N];
            size_t held[N] = {0};
            gn_sample_sobol(seed, d, N, points);
            for (size_t k = 0; k < N; k++) {
                assert_true(points[k] > 0.0 && points[k] < 1.0);
                held[(size_t)(points[k] * N)]++;
            }
            for (size_t k = 0; k < N; k++) assert_int_equal(held[k], 1);
        }
}

/* The first two coordinates are a (0, 2)-sequence: every box of sides 2^-a and 2^-b with a + b = 8
 * holds one of the first 256 points (Sobol 1967). */
static void the_first_two_coordinates_of_sobol_fill_every_box(void **state) {
    (void)state;
    enum { M = 8, N = 1 << M };
    for (int a = 0; a <= M; a++) {
        size_t held[N] = {0};
        for (uint32_t k = 0; k < N; k++) {
            uint64_t x = gn_sobol_bits(0, k), y = gn_sobol_bits(1, k);
            held[(x << a >> 32) << (M - a) | (y << (M - a) >> 32)]++;
        }
        for (size_t k = 0; k < N; k++) assert_int_equal(held[k], 1);
    }
}

/* ---- quantiles ---- */

/* Rounding of the probability moves the quantile by eps p/(density), less than eps x elsewhere. */
static void the_normal_quantile_inverts_the_probability(void **state) {
    (void)state;
    assert_true(gn_normal_quantile(0.5) == 0.0);
    for (double x = -37.0; x < -0.01; x += 0.37)
        assert_close(gn_normal_quantile(0.5 * erfc(-x * 0.70710678118654752)), x, 1e-14);
    for (double p = 0.01; p < 0.5; p += 0.01)
        assert_close(gn_normal_quantile(p), -gn_normal_quantile(1.0 - p), 1e-13);
    assert_close(gn_normal_quantile(0.975), 1.959963984540054,
                 1e-14); /* Abramowitz & Stegun 26.5 */
}

/* Closed forms: 1, 2 and 4 degrees of freedom (Student's t is Cauchy's distribution, and rational
 * in a root). */
static void student_quantiles_are_those_of_closed_forms(void **state) {
    (void)state;
    for (double within = 0.01; within < 0.9995; within += 0.033) {
        double a = 1.0 - within * within; /* 4 p (1 - p) with p = (1 + within)/2 */
        double q = cos(acos(sqrt(a)) / 3.0) / sqrt(a);
        assert_close(gn_student_quantile(within, 1), tan(0.5 * M_PI * within), 1e-13);
        assert_close(gn_student_quantile(within, 2), within * sqrt(2.0 / a), 1e-13);
        assert_close(gn_student_quantile(within, 4), 2.0 * sqrt(q - 1.0), 1e-11);
    }
}

/* Table 26.10 of Abramowitz & Stegun, column A = 0.95: three decimals. */
static void student_quantiles_are_those_of_the_table(void **state) {
    (void)state;
    static const struct {
        size_t freedom;
        double t;
    } table[] = {{1, 12.706}, {2, 4.303},  {3, 3.182},  {4, 2.776},  {5, 2.571},  {7, 2.365},
                 {9, 2.262},  {10, 2.228}, {19, 2.093}, {30, 2.042}, {60, 2.000}, {120, 1.980}};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        assert_true(fabs(gn_student_quantile(0.95, table[k].freedom) - table[k].t) <= 0.0005);
}

/* 1 + (z^3 + z)/(4 z n) and so on (Abramowitz & Stegun 26.7.5): the next term is below 3/n^2. */
static void many_degrees_of_freedom_are_normal(void **state) {
    (void)state;
    double z = gn_normal_quantile(0.975), n = 1e5;
    assert_close(gn_student_quantile(0.95, 100000), z * (1.0 + (z * z + 1.0) / (4.0 * n)), 1e-9);
}

/* ---- statistics ---- */

static void mean_deviation_and_interval_are_the_textbook_ones(void **state) {
    (void)state;
    const double values[] = {1, -9, 2, -9, 3, -9, 4, -9, 5, -9};
    gn_statistics s = gn_statistics_of(values, 5, 2);
    assert_int_equal(s.count, 5);
    assert_true(s.mean == 3.0);
    assert_close(s.deviation, sqrt(2.5), 1e-15);
    assert_close(s.interval, 2.7764451051977987 * sqrt(0.5), 1e-12);
}

static void values_that_are_not_finite_are_left_out(void **state) {
    (void)state;
    const double values[] = {NAN, 2, INFINITY, 4}, one[] = {NAN, 7}, none[] = {NAN};
    gn_statistics s = gn_statistics_of(values, 4, 1);
    assert_int_equal(s.count, 2);
    assert_true(s.mean == 3.0 && fabs(s.deviation - sqrt(2.0)) < 1e-15);
    s = gn_statistics_of(one, 2, 1);
    assert_int_equal(s.count, 1);
    assert_true(s.mean == 7.0 && isnan(s.deviation) && isnan(s.interval));
    s = gn_statistics_of(none, 1, 1);
    assert_int_equal(s.count, 0);
    assert_true(isnan(s.mean));
}

/* ---- keys ---- */

static void a_path_leads_to_its_key(void **state) {
    (void)state;
    static const char *const found[][2] = {{"time.end", "end"},
                                           {"walls.top.motion.vz", "vz"},
                                           {"materials[0].friction", "friction"},
                                           {"materials.rock.friction", "friction"},
                                           {"gravity[2]", "gravity"},
                                           {"gravity", "gravity"},
                                           {"specimen.particles", "particles"},
                                           {"damping.background.coefficient", "coefficient"},
                                           {"run.seed", "seed"},
                                           {"specimen.cylinder.height", "height"}};
    static const char *const absent[] = {"tme.end", "walls.top.speed", "x",
                                         "materials.rock.frictio", "materials.rock.frictions"};
    for (size_t k = 0; k < sizeof found / sizeof *found; k++) {
        const gn_key *key = gn_scene_key_at(found[k][0]);
        if (!key) fail_msg("%s was not found", found[k][0]);
        assert_string_equal(key->name, found[k][1]);
    }
    for (size_t k = 0; k < sizeof absent / sizeof *absent; k++)
        assert_null(gn_scene_key_at(absent[k]));
}

/* The tables of docs/sweep.md are those of the reader. */
static void docs_sweep_md_has_the_keys(void **state) {
    (void)state;
    char path[4096], *docs = calloc(1, 1 << 20), *table = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/docs/sweep.md", test_source());
    FILE *file = fopen(path, "rb");
    assert_non_null(docs);
    if (!file) fail_msg("%s is missing", path);
    assert_true(fread(docs, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    const gn_section *const sections[] = {&gn_sweep_section, &gn_range_section};
    for (size_t k = 0; k < 2; k++) {
        FILE *out = open_memstream(&table, &size);
        gn_section_print_keys(out, sections[k]);
        fclose(out);
        if (!strstr(docs, table)) fail_msg("docs/sweep.md: expected the table\n%s", table);
        free(table);
    }
    free(docs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_stratum_of_a_latin_hypercube_holds_one_point),
        cmocka_unit_test(coordinates_of_a_latin_hypercube_are_independent),
        cmocka_unit_test(another_seed_gives_another_sample),
        cmocka_unit_test(the_first_points_of_sobol_are_the_published_ones),
        cmocka_unit_test(far_points_of_every_coordinate_are_those_of_scipy),
        cmocka_unit_test(two_to_the_m_points_of_sobol_fill_as_many_strata),
        cmocka_unit_test(the_first_two_coordinates_of_sobol_fill_every_box),
        cmocka_unit_test(the_normal_quantile_inverts_the_probability),
        cmocka_unit_test(student_quantiles_are_those_of_closed_forms),
        cmocka_unit_test(student_quantiles_are_those_of_the_table),
        cmocka_unit_test(many_degrees_of_freedom_are_normal),
        cmocka_unit_test(mean_deviation_and_interval_are_the_textbook_ones),
        cmocka_unit_test(values_that_are_not_finite_are_left_out),
        cmocka_unit_test(a_path_leads_to_its_key),
        cmocka_unit_test(docs_sweep_md_has_the_keys),
    };
    return cmocka_run_group_tests_name("sweep", tests, NULL, NULL);
}
