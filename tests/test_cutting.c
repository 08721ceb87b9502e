/* Readings of a cut from curves whose answer is known, and closed forms of forces on tools. */
#include "test.h"

#include "test_kinds/readings.h"

static const double degree = 3.14159265358979323846 / 180.0;

/* --- closed forms --- */

static gn_cut ring(double diameter, double tip, double depth, double spacing) {
    return (gn_cut){.tool = GN_CUT_DISC,
                    .radius = 0.5 * diameter,
                    .tip_width = tip,
                    .depth = depth,
                    .spacing = spacing,
                    .compressive = 147.3e6,
                    .tensile = 10.2e6};
}

/* The values were computed by hand for a rock of 147.3 and 10.2 MPa and a uniform pressure, with
 * the digits that are listed. */
static void the_model_of_disc_cutters_gives_the_worked_table(void **state) {
    (void)state;
    static const struct {
        double diameter, tip, depth, spacing, arc, pressure, total, normal, rolling, energy;
    } row[] = {
        {0.4826, 0.016, 0.004, 0.040, 10.447, 195.3, 137.5, 136.9, 12.51, 21.7},
        {0.4826, 0.016, 0.004, 0.080, 10.447, 246.0, 173.2, 172.5, 15.77, 13.7},
        {0.4826, 0.016, 0.004, 0.120, 10.447, 281.6, 198.3, 197.4, 18.05, 10.4},
        {0.4826, 0.016, 0.008, 0.080, 14.795, 219.1, 218.4, 216.6, 28.12, 12.2},
        {0.4826, 0.019, 0.004, 0.080, 10.447, 239.1, 199.9, 199.0, 18.19, 15.8},
        {0.4318, 0.016, 0.004, 0.080, 11.05, 246.0, 163.8, 163.1, 15.77, 13.7},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        const gn_cut cut = ring(row[k].diameter, row[k].tip, row[k].depth, row[k].spacing);
        const gn_csm f = gn_csm_of(&cut);
        assert_close(f.arc / degree, row[k].arc, 5e-4);
        assert_close(f.pressure / 1e6, row[k].pressure, 5e-4);
        assert_close(f.total / 1e3, row[k].total, 5e-4);
        assert_close(f.normal / 1e3, row[k].normal, 5e-4);
        assert_close(f.rolling / 1e3, row[k].rolling, 5e-4);
        assert_close(f.rolling / (cut.depth * cut.spacing) / 3.6e6, row[k].energy, 5e-3);
        assert_close(f.coefficient, f.rolling / f.normal, 1e-12);
    }
}

/* The force to first order in the angle of the arc is F_r = 2^(-1/6) C (T p)^(5/6) (sigma_c^2
 * sigma_t s)^(1/3). */
static void the_rolling_force_does_not_depend_on_the_diameter(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        const gn_cut cut = ring(k ? 0.4826 : 0.4318, 0.016, 0.0005, 0.08);
        const double wanted = pow(2, -1.0 / 6) * 2.12 * pow(0.016 * 0.0005, 5.0 / 6) *
                              cbrt(147.3e6 * 147.3e6 * 10.2e6 * 0.08);
        assert_close(gn_csm_of(&cut).rolling, wanted, cut.depth / cut.radius);
    }
}

static void an_exponent_of_the_pressure_divides_the_force(void **state) {
    (void)state;
    gn_cut cut = ring(0.4826, 0.016, 0.004, 0.08);
    const double flat = gn_csm_of(&cut).normal;
    cut.exponent = 0.2;
    assert_close(gn_csm_of(&cut).normal, flat / 1.2, 1e-12);
}

/* --- readings --- */

enum { ROWS = 401, COLUMNS = 9 };

/* 1 m at 2 m/s. The normal force is 100 N up to 0.2 m, then 300 N with a peak of 700 N over 0.01 m
 * at 0.6 m; the rolling force is a tenth of it. The side force alternates by the tenth of a metre.
 * Rock comes off at 1e-6 m3 per metre. */
static double normal_at(double s) {
    return s < 0.2 ? 100 : s >= 0.6 && s < 0.61 ? 700 : 300;
}

static double side_at(double s) {
    return (int)floor(10 * s + 1e-9) % 2 ? -50 : 50;
}

static gn_history course(double reached) {
    static const char *const names[COLUMNS] = {"time",         "strain",         "stress",
                                               "cut_path",     "normal_impulse", "rolling_impulse",
                                               "side_impulse", "removed_volume", "broken_tension"};
    gn_history h = {0};
    for (int c = 0; c < COLUMNS; c++)
        assert_int_equal(gn_history_add_column(&h, names[c], "1", "", NULL), GNEISS_OK);
    double impulse[3] = {0, 0, 0}, step = 1.0 / (ROWS - 1) / 2.0;
    for (int k = 0; k < ROWS; k++) {
        const double s = (double)k / (ROWS - 1), middle = s + 0.5 / (ROWS - 1);
        const double row[COLUMNS] = {0.5 * s,    s,          1,        s, impulse[0],
                                     impulse[1], impulse[2], 1e-6 * s, 0};
        if (s <= reached) assert_int_equal(gn_history_append(&h, row, NULL), GNEISS_OK);
        impulse[0] += step * normal_at(middle);
        impulse[1] += step * 0.1 * normal_at(middle);
        impulse[2] += step * side_at(middle);
    }
    return h;
}

static gn_readings read_cut(double reached, gn_tested tested) {
    gn_history h = course(reached);
    gn_readings r;
    tested.kind = GN_TEST_CUTTING;
    if (!tested.dimension) tested.dimension = 3;
    gn_readings_compute(&h, &tested, &r);
    gn_history_free(&h);
    return r;
}

static const gn_tested whole = {.sign = 1,
                                .cut = {.tool = GN_CUT_DISC,
                                        .radius = 0.2,
                                        .depth = 0.01,
                                        .spacing = 0.1,
                                        .begin = 0.2,
                                        .end = 1.0,
                                        .blocks = 4,
                                        .window = 0.01,
                                        .damage_depth = NAN,
                                        .removed = 0.8e-6}};

static void forces_are_means_over_the_path_after_the_run_in(void **state) {
    (void)state;
    const gn_readings r = read_cut(1.0, whole);
    assert_close(r.normal_force, 305,
                 1e-9); /* an increase by 300 N and 400 N over an eightieth of the path */
    assert_close(r.rolling_force, 30.5, 1e-9);
    assert_true(fabs(r.side_force) < 1e-9);
    assert_close(r.cutting_coefficient, 0.1, 1e-9);
    assert_close(r.peak_normal_force, 700, 1e-9);
    assert_close(r.peak_rolling_force, 70, 1e-9);
    assert_close(fabs(r.peak_side_force), 50, 1e-9);
    /* Four blocks of 0.2 m: one has 320, three 300. */
    assert_close(r.normal_force_deviation, 10, 1e-9);
    assert_true(fabs(r.side_force_deviation) < 1e-9);
}

static void energies_refer_to_the_section_and_to_what_came_off(void **state) {
    (void)state;
    const gn_readings r = read_cut(1.0, whole);
    assert_close(r.specific_energy, 30.5 / (0.01 * 0.1), 1e-9);
    assert_close(r.removed_volume, 0.8e-6, 1e-9);
    assert_close(r.specific_energy_removed, 30.5 * 0.8 / 0.8e-6, 1e-9);
    gn_tested chisel = whole;
    chisel.cut.tool = GN_CUT_CHISEL;
    chisel.cut.spacing = 0;
    chisel.cut.width = 0.02;
    assert_close(read_cut(1.0, chisel).specific_energy, 30.5 / (0.01 * 0.02), 1e-9);
}

static void a_tool_that_did_not_come_so_far_has_no_means(void **state) {
    (void)state;
    const gn_readings r = read_cut(0.25, whole);
    assert_true(isnan(r.normal_force) && isnan(r.specific_energy) && isnan(r.removed_volume));
    if (!strstr(r.reason[GN_READING_normal_force], "the tool came 0.25 m far"))
        fail_msg("%s", r.reason[GN_READING_normal_force]);
    assert_close(r.predicted_coefficient, tan(0.5 * acos(0.95)), 1e-12);
    /* Halfway a cut has the readings of the part that is cut. */
    assert_close(read_cut(0.5, whole).normal_force, 300, 1e-9);
}

static void predictions_say_what_they_lack(void **state) {
    (void)state;
    gn_tested t = whole;
    gn_readings r = read_cut(1.0, t);
    assert_non_null(strstr(r.reason[GN_READING_predicted_normal_force], "tensile_strength"));
    t.cut.tensile = 1e7;
    t.cut.compressive = 1e8;
    t.cut.spacing = 0;
    r = read_cut(1.0, t);
    assert_non_null(strstr(r.reason[GN_READING_predicted_normal_force], "spacing"));
    assert_non_null(strstr(r.reason[GN_READING_specific_energy], "spacing"));
    assert_non_null(strstr(r.reason[GN_READING_predicted_peak_evans], "no closed form"));
}

static void a_chisel_and_a_pick_have_their_closed_forms(void **state) {
    (void)state;
    gn_tested t = whole;
    t.cut.tool = GN_CUT_CHISEL;
    t.cut.depth = 0.005;
    t.cut.width = 1;
    t.cut.tensile = 12.3e6;
    assert_close(read_cut(1.0, t).predicted_peak_evans, 297e3, 1e-3); /* rake 0: q = 45 degrees */
    t.cut = (gn_cut){.tool = GN_CUT_PICK,
                     .depth = 0.01,
                     .tensile = 10e6,
                     .compressive = 100e6,
                     .half_angle = 60 * degree,
                     .friction = 0.0};
    const gn_readings r = read_cut(1.0, t);
    assert_close(r.predicted_peak_evans, 16 * 180 * degree * 1e14 * 1e-4 / (1e8 * 0.25), 1e-12);
    assert_close(r.predicted_peak_goktan, 4 * 180 * degree * 1e-4 * 1e7 * 0.75 / 0.5, 1e-12);
}

static void a_plane_cut_has_no_side_force(void **state) {
    (void)state;
    gn_tested t = whole;
    t.dimension = 2;
    const gn_readings r = read_cut(1.0, t);
    assert_true(isnan(r.side_force) && isnan(r.peak_side_force));
    assert_close(r.normal_force, 305, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_model_of_disc_cutters_gives_the_worked_table),
        cmocka_unit_test(the_rolling_force_does_not_depend_on_the_diameter),
        cmocka_unit_test(an_exponent_of_the_pressure_divides_the_force),
        cmocka_unit_test(a_chisel_and_a_pick_have_their_closed_forms),
        cmocka_unit_test(forces_are_means_over_the_path_after_the_run_in),
        cmocka_unit_test(energies_refer_to_the_section_and_to_what_came_off),
        cmocka_unit_test(a_tool_that_did_not_come_so_far_has_no_means),
        cmocka_unit_test(predictions_say_what_they_lack),
        cmocka_unit_test(a_plane_cut_has_no_side_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
