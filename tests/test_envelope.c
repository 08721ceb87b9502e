/* Friction angle, cohesion and Hoek-Brown's numbers from strengths at several confinements: both
 * laws are lines to the fit, so that what it is given back is exact but for rounding. */
#include "test.h"

#include "sweep/envelope.h"

static double coulomb(double s3) {
    double k = (1 + sin(35 * M_PI / 180)) / (1 - sin(35 * M_PI / 180));
    return 2 * 12e6 * sqrt(k) + k * s3;
}

static double hoek_brown(double s3) {
    return s3 + 100e6 * sqrt(15 * s3 / 100e6 + 1);
}

/* As a summary has them: other readings stand between, and a run that reached no strength. */
static gn_envelope fitted(double (*law)(double s3)) {
    const double s3[] = {0, 5e6, 5e6, 10e6, 20e6, 40e6};
    double rows[6][3];
    for (size_t k = 0; k < 6; k++) {
        rows[k][0] = s3[k];
        rows[k][1] = -1;
        rows[k][2] = k == 3 ? NAN : law(s3[k]);
    }
    return gn_envelope_fit(&rows[0][0], &rows[0][2], 6, 3);
}

static void coulombs_line_is_found(void **state) {
    (void)state;
    gn_envelope e = fitted(coulomb);
    assert_true(e.there && !*e.no_coulomb);
    assert_close(e.friction_angle, 35, 1e-12);
    assert_close(e.cohesion, 12e6, 1e-12);
}

static void hoek_and_browns_curve_is_found(void **state) {
    (void)state;
    gn_envelope e = fitted(hoek_brown);
    assert_true(e.there && !*e.no_hoek_brown);
    assert_close(e.hoek_brown_mi, 15, 1e-12);
    assert_close(e.hoek_brown_strength, 100e6, 1e-12);
}

static void two_confinements_are_too_few(void **state) {
    (void)state;
    const double s3[] = {0, 1e6, 1e6 + 0.1}, s1[] = {1e7, 2e7, 2.1e7};
    gn_envelope e = gn_envelope_fit(s3, s1, 3, 1);
    assert_true(e.there);
    assert_true(isnan(e.friction_angle) && isnan(e.cohesion));
    assert_true(isnan(e.hoek_brown_mi) && isnan(e.hoek_brown_strength));
    assert_string_equal(e.no_coulomb, "2 different confinements with a strength, 3 are needed");
    assert_string_equal(e.no_hoek_brown, e.no_coulomb);
}

static void one_confinement_makes_no_envelope(void **state) {
    (void)state;
    const double s3[] = {1e6, 1e6, NAN}, s1[] = {1e7, 2e7, 2.1e7};
    assert_false(gn_envelope_fit(s3, s1, 3, 1).there);
    assert_false(gn_envelope_fit(s3, s1, 0, 1).there);
}

static void strengths_that_fall_have_no_angle(void **state) {
    (void)state;
    const double s3[] = {0, 1e6, 2e6}, s1[] = {3e7, 2e7, 1e7};
    gn_envelope e = gn_envelope_fit(s3, s1, 3, 1);
    assert_true(e.there && isnan(e.friction_angle) && isnan(e.hoek_brown_mi));
    assert_string_equal(e.no_coulomb, "the line has a slope of -10 (at least 1) and begins at "
                                      "3e+07 Pa (at least 0)");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coulombs_line_is_found),
        cmocka_unit_test(hoek_and_browns_curve_is_found),
        cmocka_unit_test(two_confinements_are_too_few),
        cmocka_unit_test(one_confinement_makes_no_envelope),
        cmocka_unit_test(strengths_that_fall_have_no_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
