/* Readings of named tests and readings over the whole test, from curves with known results. */
#include "test.h"

#include "test_kinds/beginning.h"
#include "test_kinds/readings.h"

/* Columns by name, filled row by row. */
enum { MOST = 16 };
typedef struct table {
    gn_history h;
    size_t columns;
    double row[MOST];
} table;

static table table_of(const char *const names[], size_t count) {
    table t = {.columns = count};
    for (size_t c = 0; c < count; c++)
        assert_int_equal(gn_history_add_column(&t.h, names[c], "1", "", NULL), GNEISS_OK);
    return t;
}

static void put(table *t) {
    assert_int_equal(gn_history_append(&t->h, t->row, NULL), GNEISS_OK);
}

static gn_readings read_as(table *t, gn_tested tested) {
    gn_readings r;
    if (!tested.dimension) tested.dimension = 3;
    if (!tested.sign) tested.sign = gn_test_of(tested.kind)->sign;
    tested.axis = tested.dimension - 1;
    gn_readings_compute(&t->h, &tested, &r);
    gn_history_free(&t->h);
    return r;
}

static void absent_for(const gn_readings *r, gn_reading which, const char *reason) {
    if (!strstr(r->reason[which], reason)) fail_msg("'%s'", r->reason[which]);
}

/* The stress rises to 100 Pa over a strain of 1 in three straight lines (slopes 80, 120 and 100
 * with corners at 35 and 65 Pa), then falls to 20. One bond per row breaks from half of the rise
 * on; the volume is least at 0.75. */
static double stress_at(double e) {
    return e < 0.4375 ? 80 * e : e < 0.6875 ? 35 + 120 * (e - 0.4375) : 65 + 100 * (e - 0.6875);
}

static table course(void) {
    static const char *const names[] = {"strain",    "stress",         "strain_xx",   "strain_yy",
                                        "strain_zz", "broken_tension", "broken_shear"};
    enum { ROWS = 4000 };
    const double top = 0.6875 + 0.35;
    table t = table_of(names, 7);
    double broken = 0;
    for (int k = 0; k <= ROWS + 200; k++) {
        double e = top * k / ROWS, s = k > ROWS ? 100 - 0.4 * (k - ROWS) : stress_at(e);
        double lateral = e < 0.75 ? 0.2 * e : 0.15 + 0.8 * (e - 0.75);
        if (k >= ROWS / 2 && k <= ROWS) broken++;
        double row[] = {e, s, lateral, lateral, -e, broken, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    return t;
}

static void moduli_are_slopes_over_the_given_ranges(void **state) {
    (void)state;
    table t = course();
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    assert_close(r.tangent_modulus, 120, 1e-9); /* 40 to 60 Pa */
    /* The secant runs from 1 to 50 Pa: the corner lies at 35 Pa; rows are 1/4000 of the rise
     * apart. */
    assert_close(r.secant_modulus, 49 / (0.4375 + 15.0 / 120 - 1.0 / 80), 1e-3);
    assert_true(r.average_modulus > 80 && r.average_modulus < 120);
}

static void crack_initiation_is_where_a_hundredth_of_the_bonds_has_broken(void **state) {
    (void)state;
    table t = course();
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    /* 2001 bonds in rows 2000 to 4000: the 21st in row 2020. */
    assert_close(r.crack_initiation_stress, stress_at((0.6875 + 0.35) * 2020 / 4000.0), 1e-12);
}

static void crack_damage_is_where_the_volume_is_smallest(void **state) {
    (void)state;
    table t = course();
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    assert_close(r.crack_damage_stress, stress_at(0.75), 1e-3); /* a row */
}

/* The slopes are 1 and -3 before bonds break at 30 % of the load, 2 and -2 from there on. */
static void ratios_in_the_middle_of_a_disc_are_those_before_it_cracks(void **state) {
    (void)state;
    static const char *const names[] = {"strain",           "stress",         "centre_stress_xx",
                                        "centre_stress_yy", "broken_tension", "broken_shear"};
    table t = table_of(names, 6);
    for (int k = 0; k <= 220; k++) {
        const double load = k <= 200 ? k : 20, more = fmax(load - 60, 0);
        double row[] = {k, load, load + more, more - 3 * load, more, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_tested tested = {.kind = GN_TEST_BRAZILIAN, .dimension = 2, .sign = 1, .axis = 1};
    gn_readings r;
    gn_readings_compute(&t.h, &tested, &r);
    gn_history_free(&t.h);
    assert_close(r.elastic_stress, 61, 1e-12);
    assert_close(r.centre_ratio, 1, 1e-9);
    assert_close(r.centre_compression_ratio, 3, 1e-9);
}

/* A specimen that other parts have loaded at the start may expand as soon as it is sheared or
 * compressed. */
static void a_specimen_that_only_expands_has_no_onset_of_damage(void **state) {
    (void)state;
    static const char *const names[] = {"strain",    "stress",         "strain_xx",   "strain_yy",
                                        "strain_zz", "broken_tension", "broken_shear"};
    table t = table_of(names, 7);
    for (int k = 0; k <= 200; k++) {
        double row[] = {k, k < 150 ? k : 50, 0.2 * k, 0.2 * k, 0.1 * k, k, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    assert_close(r.peak_stress, 149, 1e-12);
    absent_for(&r, GN_READING_crack_damage_stress, "gains volume from the start of loading");
}

/* Breaks and pieces are counted for any motion of the ends. */
static void breaks_are_reported_though_the_stress_has_the_other_sense(void **state) {
    (void)state;
    int32_t size[] = {3, 1, 7};
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    table t = table_of(names, 4);
    for (int k = 0; k <= 10; k++) {
        double row[] = {k, -k, k, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_TENSION,
                                            .bursts = size,
                                            .burst_count = 3,
                                            .fragments = 4,
                                            .largest_fragment = 0.5});
    absent_for(&r, GN_READING_peak_stress, "never had the sense");
    absent_for(&r, GN_READING_b_value, "3 bursts, 50 are needed");
    assert_close(r.events, 3, 1e-12);
    assert_close(r.fragments, 4, 1e-12);
    assert_close(r.largest_fragment, 0.5, 1e-12);
}

/* A bonded block on a rough wall: stress grows over a path of 10, then friction dissipates `share`
 * of the work of the ends over a path of `on`. */
static gn_readings slid(double share, int on, gn_test_kind kind) {
    static const char *const names[] = {"strain",         "stress",        "force",
                                        "deflection",     "normal_stress", "energy_friction",
                                        "broken_tension", "broken_shear"};
    table t = table_of(names, 8);
    for (int k = 0; k <= 10 + on; k++) {
        double stress = k < 10 ? 3 * k : 30, dissipated = k < 10 ? 0 : 30 * share * (k - 10);
        double row[] = {k, stress, 2 * stress, k, 100, 2 * dissipated, 0, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    return read_as(&t, (gn_tested){.kind = kind, .fragments = NAN});
}

static void friction_that_slides_is_a_strength_of_shear(void **state) {
    (void)state;
    gn_readings r = slid(0.9, 20, GN_TEST_SHEAR);
    assert_close(r.shear_strength, 30, 1e-12);
    assert_close(r.normal_stress_at_peak, 100, 1e-12);
    r = slid(0.2, 20, GN_TEST_SHEAR);
    absent_for(&r, GN_READING_shear_strength, "no bond has broken");
    r = slid(0.9, 3, GN_TEST_SHEAR);
    absent_for(&r, GN_READING_shear_strength, "no bond has broken");
    r = slid(0.9, 20, GN_TEST_COMPRESSION);
    absent_for(&r, GN_READING_peak_stress, "no bond has broken");
    absent_for(&r, GN_READING_crack_initiation_stress, "the scene has no bonds");
}

static void brittleness_is_what_the_stress_lost_of_its_peak(void **state) {
    (void)state;
    table t = course();
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    assert_close(r.brittleness, 0.8, 1e-9);
}

static void brittleness_is_one_when_stress_falls_below_zero(void **state) {
    (void)state;
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    table t = table_of(names, 4);
    for (int k = 0; k <= 60; k++) {
        double row[] = {k, k < 50 ? k : 49 - 10 * (k - 49), k, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    assert_true(r.brittleness == 1);
    /* The row before the peak has 48 of 49 Pa; the adjacent rows have 48 and 50. */
    assert_close(r.peak_rise, 1.0 / 49, 1e-12);
    assert_true(r.peak_strain_least == 48 && r.peak_strain_most == 50);
}

static table few(void) {
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    table t = table_of(names, 4);
    for (int k = 0; k <= 60; k++) {
        double row[] = {k, k < 50 ? k : 20, k, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    return t;
}

static void too_few_broken_bonds_have_no_first_hundredth(void **state) {
    (void)state;
    table t = few();
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION, .no_bursts = "why"});
    absent_for(&r, GN_READING_crack_initiation_stress, "100 are needed (1 % is one)");
    absent_for(&r, GN_READING_events, "why");
}

static void few_bursts_have_no_slope(void **state) {
    (void)state;
    table t = few();
    static int32_t size[60] = {61};
    gn_tested tested = {.kind = GN_TEST_COMPRESSION, .bursts = size, .burst_count = 1};
    gn_readings r = read_as(&t, tested);
    absent_for(&r, GN_READING_b_value, "1 bursts, 50 are needed");
    assert_true(r.events == 1);
    for (int k = 0; k < 60; k++) size[k] = 1;
    tested.burst_count = 60;
    t = few();
    r = read_as(&t, tested);
    absent_for(&r, GN_READING_b_value, "every burst broke one bond");
}

/* The force rises to 10 N at 2 m and falls to 0.5 N at 6 m, over a section of 4 m2. */
static table bent(double last) {
    static const char *const names[] = {"strain",  "stress",         "force",       "deflection",
                                        "opening", "broken_tension", "broken_shear"};
    table t = table_of(names, 7);
    for (int k = 0; k <= 600; k++) {
        double way = 0.01 * k, force = way < 2 ? 5 * way : 10 - (10 - last) * (way - 2) / 4;
        double row[] = {way, force, force, way, 0.5 * way, way > 1, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    return t;
}

static void fracture_energy_is_the_area_under_the_curve_over_the_section(void **state) {
    (void)state;
    table t = bent(0.5);
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4});
    assert_close(r.fracture_energy, (10 + 0.5 * 4 * 10.5) / 4, 1e-12);
    assert_close(r.opening_at_peak, 1, 1e-12);
    assert_close(r.flexural_modulus, 5, 1e-12);
    t = bent(2);
    r = read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4, .notched = true});
    absent_for(&r, GN_READING_fracture_energy, "20 % of the largest load");
    absent_for(&r, GN_READING_flexural_modulus, "notch");
    t = bent(0.5);
    r = read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4, .under_gravity = true});
    absent_for(&r, GN_READING_fracture_energy, "gravity");
    t = bent(0.5);
    r = read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4, .conversion_halted = true});
    absent_for(&r, GN_READING_fracture_energy, "conversion ended the run");
    assert_close(r.opening_at_peak, 1, 1e-12);
}

/* A notched beam has this reading as well. */
static void peak_force_and_stiffness_of_a_beam_are_those_of_the_ends(void **state) {
    (void)state;
    table t = bent(0.5);
    gn_readings r =
        read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4, .notched = true});
    assert_close(r.peak_force, 10, 1e-12);
    assert_close(r.stiffness, 5, 1e-12);
    assert_true(!gn_reading_belongs(GN_READING_stiffness, GN_TEST_COMPRESSION, false));
}

static void readings_of_other_tests_are_absent_for_that(void **state) {
    (void)state;
    table t = bent(0.5);
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_BENDING, .section = 4});
    absent_for(&r, GN_READING_young_modulus, "a reading of other tests");
    absent_for(&r, GN_READING_centre_ratio, "a reading of other tests");
    assert_true(!gn_reading_belongs(GN_READING_centre_ratio, GN_TEST_BENDING, false));
    assert_true(gn_reading_belongs(GN_READING_peak_stress, GN_TEST_BENDING, false));
}

/* A size by its share of the sum of k^-a up to 100 000. */
static int drawn_size(double a) {
    static double sum;
    if (sum == 0)
        for (int k = 1; k <= 100000; k++) sum += pow(k, -a);
    double left = sum * (rand() / (RAND_MAX + 1.0));
    int size = 1;
    while (size < 100000 && (left -= pow(size, -a)) > 0) size++;
    return size;
}

static void the_slope_of_bursts_is_that_of_the_law_they_are_drawn_from(void **state) {
    (void)state;
    enum { BURSTS = 2000 };
    const double b = 1.2; /* N(>= n) ~ n^-b: sizes n^-(b + 1) */
    static int32_t size[BURSTS];
    table t = course();
    srand(3);
    for (int k = 0; k < BURSTS; k++) size[k] = drawn_size(b + 1);
    gn_readings r = read_as(
        &t, (gn_tested){.kind = GN_TEST_COMPRESSION, .bursts = size, .burst_count = BURSTS});
    assert_true(r.events == BURSTS);
    /* Three standard errors, b/sqrt(n) (Aki 1965). */
    assert_true(fabs(r.b_value - b) < 3 * b / sqrt(BURSTS));
}

static void an_oedometer_reads_its_modulus_and_lateral_ratio(void **state) {
    (void)state;
    static const char *const names[] = {"strain", "stress", "stress_xx", "stress_yy", "stress_zz"};
    table t = table_of(names, 5);
    for (int k = 0; k <= 100; k++) {
        double row[] = {0.01 * k, 5.0 * k, -1.0 * k, -2.0 * k, -5.0 * k};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_OEDOMETER});
    assert_close(r.oedometric_modulus, 500, 1e-12);
    assert_close(r.lateral_stress_ratio, 0.3, 1e-12);
}

static void a_confined_strength_adds_the_pressure_at_the_peak(void **state) {
    (void)state;
    static const char *const names[] = {
        "strain",         "stress",         "membrane_pressure", "volumetric_strain",
        "lateral_strain", "broken_tension", "broken_shear"};
    table t = table_of(names, 7);
    for (int k = 0; k <= 100; k++) {
        double row[] = {k, k < 80 ? k : 40, 7, 0.1 * k, -0.2 * k, k > 50, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_TRIAXIAL});
    assert_close(r.axial_strength, 86, 1e-12);
    assert_close(r.confinement, 7, 1e-12);
    assert_close(r.volumetric_strain_at_peak, 7.9, 1e-12);
    assert_close(r.lateral_strain_at_peak, -15.8, 1e-12);
}

/* --- the range of elastic constants --- */

/* A specimen that yields long before half of its largest stress: its slope is 100 Pa per unit
 * strain up to `from` Pa, and half of that up to the peak at 100 Pa; the transverse strain is 0.1
 * of the axial one, then 0.45, and with fixed sides the transverse stress is 0.2 and then 0.4 of
 * the axial one. From `from` on `column` grows. */
typedef struct weakening {
    double from;
    const char *column;
    int rows;           /* number of rows up to the peak */
    double sides_stand; /* 1 or 0 */
    int seated;         /* bonds that break at 2 Pa */
} weakening;

static table weakened(weakening of) {
    static const char *const names[] = {
        "strain",         "stress",       "strain_xx",         "strain_yy",
        "strain_zz",      "stress_xx",    "stress_yy",         "stress_zz",
        "force",          "deflection",   "bonds_intact",      "energy_elastic_normal",
        "broken_tension", "broken_shear", "energy_plasticity", "energy_damage"};
    table t = table_of(names, 16);
    for (int k = 0; k <= of.rows + of.rows / 10; k++) {
        const double at_peak = 100, s = fmin(at_peak * k / of.rows, at_peak),
                     beyond = fmax(s - of.from, 0), more = at_peak * k / of.rows - s,
                     e = (s + beyond + more) / 100,
                     lateral = (0.1 * (s - beyond) + 0.45 * 2 * beyond) / 100,
                     side = of.sides_stand * (0.2 * s + 0.2 * beyond), now = more > 0 ? 20 : s;
        double row[16] = {e,
                          now,
                          lateral,
                          lateral,
                          -e,
                          -side,
                          -side,
                          -now,
                          4 * now,
                          2 * e,
                          8000,
                          0.5 * s * s / 100,
                          s > 2 ? of.seated : 0};
        for (int c = 12; c < 16; c++)
            if (strcmp(names[c], of.column) == 0) row[c] += beyond;
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    return t;
}

static gn_readings read_weakened(weakening of, gn_test_kind kind) {
    table t = weakened(of);
    return read_as(&t, (gn_tested){.kind = kind, .section = 4});
}

static const char *const weakenings[] = {"broken_tension", "broken_shear", "energy_plasticity",
                                         "energy_damage"};

/* A hundredth of the work is lost within 1 Pa of where bonds yield or soften. */
static void elastic_constants_are_read_before_bonds_break_yield_or_soften(void **state) {
    (void)state;
    for (int c = 0; c < 4; c++)
        for (double from = 10; from < 45; from += 15) {
            weakening of = {.from = from, .column = weakenings[c], .rows = 1000};
            const double tolerance = c < 2 ? 1e-9 : 0.03;
            gn_readings r = read_weakened(of, GN_TEST_TRIAXIAL);
            assert_close(r.young_modulus, 100, tolerance);
            assert_close(r.young_modulus_average, 100, tolerance);
            assert_close(r.poisson_ratio, 0.1, 10 * tolerance);
            assert_true(fabs(r.elastic_stress - from) < 1.2);
            r = read_weakened(of, GN_TEST_SHEAR);
            assert_close(r.shear_modulus, 100, tolerance);
            r = read_weakened(of, GN_TEST_HYDROSTATIC);
            assert_close(r.bulk_modulus, 100, tolerance);
            r = read_weakened(of, GN_TEST_BENDING);
            assert_close(r.flexural_modulus, 100, tolerance);
            assert_close(r.stiffness, 200, tolerance);
            of.sides_stand = 1;
            r = read_weakened(of, GN_TEST_OEDOMETER);
            assert_close(r.oedometric_modulus, 100, tolerance);
            assert_close(r.lateral_stress_ratio, 0.2, 10 * tolerance);
        }
}

static void the_secant_at_half_the_peak_includes_broken_bonds(void **state) {
    (void)state;
    const weakening of = {.from = 20, .column = "broken_tension", .rows = 1000};
    /* Between 1 and 50 Pa the stress rises by 19 Pa at 100 Pa per unit strain and by 30 Pa at 50.
     */
    const double strain = 0.19 + 0.60;
    const gn_test_kind kinds[] = {GN_TEST_COMPRESSION, GN_TEST_SHEAR, GN_TEST_HYDROSTATIC,
                                  GN_TEST_OEDOMETER, GN_TEST_BENDING};
    for (int k = 0; k < 5; k++)
        assert_close(read_weakened(of, kinds[k]).secant_modulus, 49 / strain, 2e-3);
    assert_close(read_weakened(of, GN_TEST_COMPRESSION).secant_poisson_ratio,
                 (0.1 * 0.19 + 0.45 * 0.60) / strain, 2e-3);
}

static void too_few_rows_before_the_first_break_leave_no_constant(void **state) {
    (void)state;
    const weakening of = {.from = 20, .column = "broken_tension", .rows = 10};
    gn_readings r = read_weakened(of, GN_TEST_COMPRESSION);
    absent_for(&r, GN_READING_young_modulus,
               "bonds break at 30 % of the largest stress: 2 history rows before that, 3 are "
               "needed (output.history_rows)");
    absent_for(&r, GN_READING_poisson_ratio, "bonds break at 30 %");
    assert_false(isnan(r.secant_modulus));
    r = read_weakened(of, GN_TEST_HYDROSTATIC);
    absent_for(&r, GN_READING_bulk_modulus, "bonds break at 30 %");
}

/* A hundredth of a section of 8000^(2/3) bonds is 4. */
static void a_few_bonds_that_platens_break_do_not_end_the_elastic_rows(void **state) {
    (void)state;
    weakening of = {.from = 30, .column = "broken_tension", .rows = 1000, .seated = 3};
    gn_readings r = read_weakened(of, GN_TEST_COMPRESSION);
    assert_close(r.elastic_stress, 30.1, 1e-9);
    assert_close(r.poisson_ratio, 0.1, 1e-9);
    of.seated = 5;
    r = read_weakened(of, GN_TEST_COMPRESSION);
    assert_close(r.elastic_stress, 2.1, 1e-9);
}

/* y = x + x^2 up to 0.5 of the peak: slopes 1 + x1 + x2 between two points. */
static void the_change_of_a_slope_over_its_rows_is_its_nonlinearity(void **state) {
    (void)state;
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    table t = table_of(names, 4);
    for (int k = 0; k <= 1100; k++) {
        const double x = 1e-3 * k;
        double row[] = {x, k <= 1000 ? x + x * x : 0.1, k > 1000, 0};
        memcpy(t.row, row, sizeof row);
        put(&t);
    }
    gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
    const double first = 0.0196, last = 0.618; /* x + x^2 of 0.02 and 1 */
    assert_close(r.young_modulus, 1 + first + last, 3e-3);
    assert_close(r.nonlinearity[GN_READING_young_modulus],
                 0.5 * (last - first) / (1 + first + last), 1e-2);
}

static gn_beginning begun_by(const double *strain, const double *stress, size_t rows) {
    gn_beginning whole = {0}, one = {0};
    gn_beginning_update(&whole, strain, stress, rows);
    for (size_t k = 0; k <= rows; k++) gn_beginning_update(&one, strain, stress, k);
    assert_true(whole.least == one.least && whole.begun == one.begun && whole.moved == one.moved);
    return whole;
}

static void a_test_begins_when_its_ends_move_and_their_initial_load_has_vanished(void **state) {
    (void)state;
    const double grows[] = {0, 1, 2, 3, 4, 5}, late[] = {0, 0, 0, 1, 2, 3}, never[] = {0, 0, 0};
    const struct {
        const double *strain;
        double stress[6];
        size_t least;
        bool begun;
    } cases[] = {
        {grows, {0, 10, 20, 30, 20, 10}, 0, true},  /* the load grows from zero */
        {grows, {50, 60, 80, 99, 20, 10}, 0, true}, /* the load exists already */
        {grows, {50, 49, 50.1, 99, 9, 1}, 1, true}, /* a load with a small oscillation */
        {grows, {90, 30, 20, 23, 30, 60}, 2, true}, /* the load existed before it fell */
        {grows, {90, 91, 20, 10, 5, 1}, 0, true},   /* the load is near the strength */
        {grows, {90, 80, 60, 64, 30, 1}, 5, false}, /* too late: nothing is known */
        {late, {1, -4, 3, 8, 9, 2}, 2, true},       /* a normal stress precedes the motion */
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const gn_beginning b = begun_by(cases[k].strain, cases[k].stress, 6);
        assert_int_equal(b.least, cases[k].least);
        assert_int_equal(b.begun, cases[k].begun);
    }
    assert_false(begun_by(never, cases[0].stress, 3).moved);
    assert_true(begun_by(NULL, cases[0].stress, 3).begun);
}

static void the_initial_load_of_the_ends_is_no_peak(void **state) {
    (void)state;
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    for (int weak = 0; weak < 2; weak++) {
        table t = table_of(names, 4);
        for (int k = 0; k <= 100; k++) {
            const double rises = weak ? 0 : k < 80 ? k : 40;
            double row[] = {0.01 * k, fmax(rises, 100 - 30 * k), k > 50, 0};
            memcpy(t.row, row, sizeof row);
            put(&t);
        }
        gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
        assert_close(r.initial_stress, 100, 1e-12);
        if (weak) absent_for(&r, GN_READING_largest_stress, "has only fallen from the 100 Pa");
        if (weak) continue;
        assert_close(r.peak_stress, 79, 1e-12);
        assert_close(r.peak_strain, 0.79, 1e-12);
        assert_close(r.tangent_modulus, 100, 1e-9);
    }
}

/* Ends have no strength if they do not move while bonds break, unload, or are driven by a dead
 * load. */
static void ends_that_do_not_move_or_hold_a_load_have_no_strength(void **state) {
    (void)state;
    static const char *const names[] = {"strain", "stress", "broken_tension", "broken_shear"};
    for (int kind = 0; kind < 3; kind++) {
        table t = table_of(names, 4);
        for (int k = 0; k <= 100; k++) {
            double row[] = {kind == 0   ? 0
                            : kind == 1 ? -0.01 * k
                                        : 0.01 * k,
                            kind == 2 ? 100 - 0.02 * k : 100 + 20 * (k == 3) - 0.8 * k, k > 50, 0};
            memcpy(t.row, row, sizeof row);
            put(&t);
        }
        gn_readings r = read_as(&t, (gn_tested){.kind = GN_TEST_COMPRESSION});
        assert_close(r.largest_stress, kind == 2 ? 100 : 117.6, 1e-12);
        absent_for(&r, GN_READING_peak_stress,
                   kind == 2 ? "has not fallen by 5 %" : "never moved in the sense of the test");
    }
}

static void descriptors_of_kinds_do_not_contradict_themselves(void **state) {
    (void)state;
    for (int k = GN_TEST_NONE + 1; k < GN_TEST_KINDS; k++) {
        const gn_test_descriptor *d = gn_test_kinds[k];
        const bool along = d->prism || d->disc || d->beam || d->sheared;
        assert_true(d->shape && d->area_source && (d->sign == 1 || d->sign == -1));
        assert_int_equal(d->ends + d->isotropic + d->enclosed + d->tool, 1);
        assert_true(d->ends == along);
        assert_int_equal(d->needs & ~d->takes, 0);
        assert_true((d->sheared || d->tool) == (d->takes & GN_TAKES(normal) && true));
        assert_true(!d->dimension == !d->counterpart);
        assert_non_null(d->figures[0].name);
        for (int f = 0; f < 8 && d->figures[f].name; f++)
            assert_true(
                gn_reading_belongs((gn_reading)d->figures[f].reading, (gn_test_kind)k, false));
        for (int other = 0; other < k; other++)
            assert_string_not_equal(gn_test_kinds[other]->name, d->name);
    }
    assert_false(gn_test_of(GN_TEST_NONE)->ends || gn_test_of(GN_TEST_NONE)->isotropic);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(descriptors_of_kinds_do_not_contradict_themselves),
        cmocka_unit_test(ends_that_do_not_move_or_hold_a_load_have_no_strength),
        cmocka_unit_test(moduli_are_slopes_over_the_given_ranges),
        cmocka_unit_test(crack_initiation_is_where_a_hundredth_of_the_bonds_has_broken),
        cmocka_unit_test(crack_damage_is_where_the_volume_is_smallest),
        cmocka_unit_test(ratios_in_the_middle_of_a_disc_are_those_before_it_cracks),
        cmocka_unit_test(a_specimen_that_only_expands_has_no_onset_of_damage),
        cmocka_unit_test(breaks_are_reported_though_the_stress_has_the_other_sense),
        cmocka_unit_test(friction_that_slides_is_a_strength_of_shear),
        cmocka_unit_test(brittleness_is_what_the_stress_lost_of_its_peak),
        cmocka_unit_test(too_few_broken_bonds_have_no_first_hundredth),
        cmocka_unit_test(few_bursts_have_no_slope),
        cmocka_unit_test(brittleness_is_one_when_stress_falls_below_zero),
        cmocka_unit_test(fracture_energy_is_the_area_under_the_curve_over_the_section),
        cmocka_unit_test(peak_force_and_stiffness_of_a_beam_are_those_of_the_ends),
        cmocka_unit_test(readings_of_other_tests_are_absent_for_that),
        cmocka_unit_test(the_slope_of_bursts_is_that_of_the_law_they_are_drawn_from),
        cmocka_unit_test(an_oedometer_reads_its_modulus_and_lateral_ratio),
        cmocka_unit_test(a_confined_strength_adds_the_pressure_at_the_peak),
        cmocka_unit_test(elastic_constants_are_read_before_bonds_break_yield_or_soften),
        cmocka_unit_test(the_secant_at_half_the_peak_includes_broken_bonds),
        cmocka_unit_test(too_few_rows_before_the_first_break_leave_no_constant),
        cmocka_unit_test(a_few_bonds_that_platens_break_do_not_end_the_elastic_rows),
        cmocka_unit_test(the_change_of_a_slope_over_its_rows_is_its_nonlinearity),
        cmocka_unit_test(a_test_begins_when_its_ends_move_and_their_initial_load_has_vanished),
        cmocka_unit_test(the_initial_load_of_the_ends_is_no_peak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
