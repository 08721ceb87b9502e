/* Friction angle, cohesion and Hoek-Brown's parameters from strengths at several confinements: both
 * laws are straight lines for the fit, which recovers given parameters to rounding. */
#include "test.h"

#include "sweep/envelope.h"

static double coulomb(double s3) {
    double k = (1 + sin(35 * M_PI / 180)) / (1 - sin(35 * M_PI / 180));
    return 2 * 12e6 * sqrt(k) + k * s3;
}

static double hoek_brown(double s3) {
    return s3 + 100e6 * sqrt(15 * s3 / 100e6 + 1);
}

/* Fits the rows as a summary has them: with other readings in between, and a run that reached no
 * strength. */
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
    assert_string_equal(e.no_coulomb, "the fitted line has a slope of -10 (at least 1 needed) and "
                                      "an intercept of 3e+07 Pa (at least 0 needed)");
}

/* ---- sweeps ---- */

/* Two frictions, three pressures, two seeds; a speed that changes with the pressure. */
enum { FRICTIONS = 2, PRESSURES = 3, SEEDS = 2, RUNS = FRICTIONS * PRESSURES * SEEDS };
typedef struct small_sweep {
    gn_sweep sweep;
    gn_summary summary;
    gn_sweep_run runs[RUNS];
    uint32_t chosen[RUNS * 3];
    gn_sweep_value friction[FRICTIONS], pressure[PRESSURES], third[PRESSURES];
    gn_summary_reading readings[2];
    double value[RUNS * 2];
} small_sweep;

static double line(double angle, double cohesion, double s3) {
    double sine = sin(angle * M_PI / 180), k = (1 + sine) / (1 - sine);
    return 2 * cohesion * sqrt(k) + k * s3;
}

/* Friction 0.1 gives 20 degrees and 1 MPa, friction 0.5 40 degrees and 3 MPa. */
static gn_envelopes envelopes_of(small_sweep *q, const char *third) {
    static char texts[3][8] = {"0", "1", "2"};
    memset(q, 0, sizeof *q);
    snprintf(q->sweep.parameters[0].key, GN_KEY_PATH_SIZE, "materials.rock.friction");
    snprintf(q->sweep.parameters[1].key, GN_KEY_PATH_SIZE, "membrane.pressure");
    snprintf(q->sweep.parameters[2].key, GN_KEY_PATH_SIZE, "%s", third);
    gn_sweep_value *values[3] = {q->friction, q->pressure, q->third};
    for (size_t p = 0; p < 3; p++) {
        gn_sweep_parameter *to = &q->sweep.parameters[p];
        to->values = values[p];
        to->count = p ? PRESSURES : FRICTIONS;
        to->numeric = true;
        to->unit = "";
        for (size_t k = 0; k < to->count; k++)
            to->values[k] = (gn_sweep_value){.text = texts[k], .number = (double)k};
    }
    for (size_t k = 0; k < RUNS; k++) {
        size_t friction = k / (PRESSURES * SEEDS), pressure = k / SEEDS % PRESSURES;
        const uint32_t chosen[3] = {(uint32_t)friction, (uint32_t)pressure, (uint32_t)pressure};
        q->runs[k].first_value = 3 * k;
        memcpy(&q->chosen[3 * k], chosen, sizeof chosen);
        q->value[2 * k] = (double)pressure * 5e6;
        q->value[2 * k + 1] =
            friction ? line(40, 3e6, q->value[2 * k]) : line(20, 1e6, q->value[2 * k]);
    }
    snprintf(q->readings[0].name, GN_NAME_SIZE, "confinement");
    snprintf(q->readings[1].name, GN_NAME_SIZE, "axial_strength");
    q->sweep.parameter_count = 3;
    q->sweep.run_count = RUNS;
    q->sweep.runs = q->runs;
    q->sweep.chosen = q->chosen;
    q->summary = (gn_summary){
        .sweep = &q->sweep, .reading_count = 2, .readings = q->readings, .value = q->value};
    gn_envelopes e;
    assert_int_equal(gn_envelopes_make(&q->summary, &e, NULL), GNEISS_OK);
    return e;
}

static void every_material_of_a_sweep_has_an_envelope_of_its_own(void **state) {
    (void)state;
    small_sweep q;
    char label[64];
    gn_envelopes e = envelopes_of(&q, "walls.top.motion.vz");
    assert_int_equal(e.count, 2);
    assert_close(e.of[0].friction_angle, 20, 1e-12);
    assert_close(e.of[0].cohesion, 1e6, 1e-12);
    assert_close(e.of[1].friction_angle, 40, 1e-12);
    assert_close(e.of[1].cohesion, 3e6, 1e-12);
    assert_string_equal(gn_envelope_label(&q.summary, &e, 1, label, sizeof label),
                        "materials.rock.friction = 1");
    for (size_t k = 0; k < RUNS; k++) assert_int_equal(e.of_run[k], k >= RUNS / 2);
    gn_envelopes_free(&e);
}

static void a_material_that_changes_with_the_confinement_makes_no_envelope(void **state) {
    (void)state;
    small_sweep q;
    gn_envelopes e = envelopes_of(&q, "materials.rock.bond_friction");
    assert_true(e.confined);
    assert_int_equal(e.count, 0);
    for (size_t k = 0; k < RUNS; k++) assert_int_equal(e.of_run[k], -1);
    gn_envelopes_free(&e);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coulombs_line_is_found),
        cmocka_unit_test(hoek_and_browns_curve_is_found),
        cmocka_unit_test(two_confinements_are_too_few),
        cmocka_unit_test(one_confinement_makes_no_envelope),
        cmocka_unit_test(strengths_that_fall_have_no_angle),
        cmocka_unit_test(every_material_of_a_sweep_has_an_envelope_of_its_own),
        cmocka_unit_test(a_material_that_changes_with_the_confinement_makes_no_envelope),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
