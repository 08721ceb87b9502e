#include "test.h"

#include "base/eigen.h"

#include <stdbool.h>

static const double pi = 3.14159265358979323846;

static void jacobi_finds_the_spectrum_of_a_path(void **state) {
    (void)state;
    enum { N = 24 };
    double a[N * N] = {0.0}, values[N], vectors[N * N];
    for (int k = 0; k < N; k++) {
        a[k * N + k] = 2.0;
        if (k) a[k * N + k - 1] = a[(k - 1) * N + k] = -1.0;
    }
    gn_eigen_symmetric(N, a, values, vectors);
    for (int k = 0; k < N; k++) {
        double s = sin(pi * (N - k) / (2.0 * (N + 1)));
        if (fabs(values[k] - 4.0 * s * s) > 1e-13) fail_msg("value %d: %.17g", k, values[k]);
        for (int i = 0; i < N; i++) {
            double left = i ? vectors[k * N + i - 1] : 0.0,
                   right = i < N - 1 ? vectors[k * N + i + 1] : 0.0;
            double residual =
                2.0 * vectors[k * N + i] - left - right - values[k] * vectors[k * N + i];
            if (fabs(residual) > 1e-13) fail_msg("vector %d misses by %g", k, residual);
        }
    }
}

static void path_product(const void *context, const double *x, double *y) {
    size_t n = *(const size_t *)context;
    for (size_t k = 0; k < n; k++)
        y[k] = 2.0 * x[k] - (k ? x[k - 1] : 0.0) - (k + 1 < n ? x[k + 1] : 0.0);
}

static gneiss_status largest_of(size_t n, gn_operator *apply, const void *context, double tolerance,
                                int threads, double *vector, gn_eigen_top *top,
                                gneiss_error *error) {
    const gn_eigen_system system = {.n = n, .apply = apply, .context = context, .threads = threads};
    return gn_eigen_largest(&system, tolerance, vector, top, error);
}

/* The top of this spectrum is dense, so that many restarts are needed. */
static void lanczos_converges_through_restarts(void **state) {
    (void)state;
    size_t n = 600;
    double *x = calloc(n, sizeof *x);
    for (size_t k = 0; k < n; k++) x[k] = (double)((k * k * 31 + 7 * k) % 101) - 50.0;
    gn_eigen_top top;
    assert_int_equal(largest_of(n, path_product, &n, 1e-6, 2, x, &top, NULL), GNEISS_OK);
    double s = sin(pi * (double)n / (2.0 * (n + 1.0)));
    assert_true(top.vectors > 100);
    assert_true(top.residual <= 1e-6 * top.value);
    assert_true(top.value <= 4.0 * s * s * (1.0 + 1e-14));
    assert_close(top.value, 4.0 * s * s, 1e-6);
    assert_close(gn_eigen_dot(n, x, x, 2), 1.0, 1e-12);
    free(x);
}

/* The path graph in other units: x = d y, with scales d from 1 to 1000; D^-1 T D is symmetric in
 * D^2. */
static double unit_of(size_t k) {
    return 1.0 + 999.0 * (double)(k % 7) / 6.0;
}

static void scaled_product(const void *context, const double *y, double *out) {
    size_t n = *(const size_t *)context;
    for (size_t k = 0; k < n; k++) {
        double left = k ? unit_of(k - 1) * y[k - 1] : 0.0;
        double right = k + 1 < n ? unit_of(k + 1) * y[k + 1] : 0.0;
        out[k] = 2.0 * y[k] - (left + right) / unit_of(k);
    }
}

static void scaled_metric(const void *context, const double *y, double *out) {
    size_t n = *(const size_t *)context;
    for (size_t k = 0; k < n; k++) out[k] = unit_of(k) * unit_of(k) * y[k];
}

static void lanczos_finds_the_same_in_a_metric(void **state) {
    (void)state;
    size_t n = 300;
    double *x = calloc(n, sizeof *x), *weighed = calloc(n, sizeof *weighed);
    for (size_t k = 0; k < n; k++) x[k] = (double)((k * k * 31 + 7 * k) % 101) - 50.0;
    gn_eigen_top top;
    const gn_eigen_system system = {
        .n = n, .apply = scaled_product, .metric = scaled_metric, .context = &n, .threads = 2};
    assert_int_equal(gn_eigen_largest(&system, 1e-6, x, &top, NULL), GNEISS_OK);
    double s = sin(pi * (double)n / (2.0 * (n + 1.0)));
    assert_true(top.vectors > 50);
    assert_true(top.value <= 4.0 * s * s * (1.0 + 1e-14));
    assert_close(top.value, 4.0 * s * s, 1e-6);
    scaled_metric(&n, x, weighed);
    assert_close(gn_eigen_dot(n, x, weighed, 1), 1.0, 1e-12);
    free(x);
    free(weighed);
}

/* Pairs at the first indices and one at the end, one of which is stiffer than all others. */
static void pairs_product(const void *context, const double *x, double *y) {
    size_t n = *(const size_t *)context;
    for (size_t k = 0; k < n; k++) {
        size_t other = n - 1 - k;
        int stiff = k == 3 || other == 3;
        y[k] = stiff ? 10.0 * x[k] + 5.0 * x[other] : x[k] + 0.5 * x[other];
    }
}

/* The start vector has components in the first unknowns only, products also in the last ones:
 * groups that are skipped because they are zero must not be skipped when they are not. */
static void lanczos_follows_where_products_lead(void **state) {
    (void)state;
    size_t n = 9000;
    double *x = calloc(n, sizeof *x);
    for (size_t k = 0; k < 100; k++) x[k] = 1.0 + 0.01 * (double)k;
    gn_eigen_top top;
    assert_int_equal(largest_of(n, pairs_product, &n, 1e-9, 2, x, &top, NULL), GNEISS_OK);
    assert_close(top.value, 15.0, 1e-9);
    assert_close(fabs(x[3]), sqrt(0.5), 1e-6);
    assert_close(fabs(x[n - 4]), sqrt(0.5), 1e-6);
    free(x);
}

/* A chain of which only some groups can move, by itself and as a part of the whole. */
enum { WHOLE = 9000 };

static bool is_loose(size_t k) {
    const size_t group = k / GN_EIGEN_GROUP;
    return k < 8600 && group % 3 == 1 && (group < 200 || group > 560);
}

static double stiffness_at(size_t k) {
    return 2.0 + 1e-3 * (double)(k % 611);
}

static void loose_product(const void *context, const double *x, double *y) {
    (void)context;
    for (size_t k = 0; k < WHOLE; k++)
        y[k] = is_loose(k) ? stiffness_at(k) * x[k] - (k ? x[k - 1] : 0.0) - x[k + 1] : 0.0;
}

typedef struct loose {
    size_t n, place[WHOLE];
} loose;

static void loose_product_by_itself(const void *context, const double *x, double *y) {
    const loose *l = context;
    for (size_t k = 0; k < l->n; k++) {
        const bool left = k && l->place[k - 1] + 1 == l->place[k];
        const bool right = k + 1 < l->n && l->place[k + 1] == l->place[k] + 1;
        y[k] =
            stiffness_at(l->place[k]) * x[k] - (left ? x[k - 1] : 0.0) - (right ? x[k + 1] : 0.0);
    }
}

static void entries_by_themselves_give_the_bits_of_the_whole(void **state) {
    (void)state;
    loose *l = calloc(1, sizeof *l);
    double *x = calloc(WHOLE, sizeof *x), *y = calloc(WHOLE, sizeof *y);
    for (size_t k = 0; k < WHOLE; k++) {
        x[k] = is_loose(k) ? (double)((k * k * 31 + 7 * k) % 101) - 50.0 : 0.0;
        if (!is_loose(k)) continue;
        y[l->n] = x[k];
        l->place[l->n++] = k;
    }
    assert_true(l->n > 1200 && 3 * l->n < WHOLE);
    gn_eigen_system system = {
        .n = l->n, .apply = loose_product_by_itself, .context = l, .place = l->place, .threads = 2};
    gn_eigen_top whole, part;
    assert_int_equal(largest_of(WHOLE, loose_product, NULL, 1e-6, 1, x, &whole, NULL), GNEISS_OK);
    assert_int_equal(gn_eigen_largest(&system, 1e-6, y, &part, NULL), GNEISS_OK);
    assert_true(whole.vectors > 40 && part.vectors == whole.vectors);
    assert_true(part.value == whole.value && part.residual == whole.residual);
    for (size_t k = 0; k < l->n; k++) assert_true(y[k] == x[l->place[k]]);
    for (size_t k = 0; k < WHOLE; k++) x[k] *= 1.0 + (double)(k % 13);
    for (size_t k = 0; k < l->n; k++) y[k] *= 1.0 + (double)(l->place[k] % 13);
    assert_true(gn_eigen_dot_of(&system, y, y) == gn_eigen_dot(WHOLE, x, x, 1));
    free(l);
    free(x);
    free(y);
}

static void lanczos_refuses_a_zero_start(void **state) {
    (void)state;
    size_t n = 3;
    double x[3] = {0.0};
    gn_eigen_top top;
    assert_int_equal(largest_of(n, path_product, &n, 1e-6, 1, x, &top, NULL),
                     GNEISS_ERROR_INTERNAL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jacobi_finds_the_spectrum_of_a_path),
        cmocka_unit_test(lanczos_converges_through_restarts),
        cmocka_unit_test(lanczos_finds_the_same_in_a_metric),
        cmocka_unit_test(lanczos_follows_where_products_lead),
        cmocka_unit_test(entries_by_themselves_give_the_bits_of_the_whole),
        cmocka_unit_test(lanczos_refuses_a_zero_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
