/* Reading scenes: values, units, defaults, overrides, and every way to refuse. */
#include "scene_text.h"

#include "scene/units.h"

#include <unistd.h>

static void refuses(const char *text, const char *message) {
    gn_scene scene;
    gneiss_error error = {0};
    gneiss_status status = gn_scene_parse(text, "s.yaml", NULL, NULL, 0, &scene, &error);
    if (status == GNEISS_OK) gn_scene_free(&scene);
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    assert_int_equal(error.status, GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, message);
}

static void refuses_set(const char *key, const char *value, const char *message) {
    gn_scene scene;
    gneiss_error error = {0};
    gn_override override = {key, value};
    gneiss_status status = gn_scene_parse(small, "s.yaml", NULL, &override, 1, &scene, &error);
    if (status == GNEISS_OK) gn_scene_free(&scene);
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, message);
}

/* ---- values ---- */

static void the_rock_scene_reads_as_written(void **state) {
    (void)state;
    gn_scene s = loaded("scenes/ucs-rock.yaml");
    assert_string_equal(s.title, "UCS of rock-a, harmonic law");
    assert_string_equal(s.specimen.file, "specimens/rock-a.txt");
    assert_int_equal(s.specimen.path[0], '/');
    assert_int_equal(access(s.specimen.path, R_OK), 0);
    assert_int_equal(s.material_count, 1);
    assert_true(s.materials[0].contact_modulus == 10e9);
    assert_true(s.materials[0].tensile_strength == 40e6);
    assert_int_equal(s.stiffness, GN_STIFFNESS_HARMONIC);
    assert_int_equal(s.bonds, GN_SWITCH_ON);
    assert_int_equal(s.background, GN_BACKGROUND_NONVISCOUS_VECTOR);
    assert_true(s.walls[1].point[2] == 0.046);
    assert_true(gn_table_at(&s.walls[1].motion.velocity[2], 1.0) == -0.1);
    assert_int_equal(s.walls[1].motion.velocity[0].count, 0);
    assert_int_equal(s.test.axis, 2);
    assert_true(s.step == 0 && s.end == 0.006 && s.safety == 0.9);
    assert_true(s.checkpoint_wall == 300);
    assert_int_equal(s.history_rows, 2000);
    assert_int_equal(s.threads, 0);
    assert_int_equal(s.walls[0].where.line, 31);
    gn_scene_free(&s);
}

static void units_are_converted_to_si(void **state) {
    (void)state;
    static const struct {
        const char *text, *unit;
        double value;
    } cases[] = {{"23 mm", "m", 0.023},
                 {"46mm", "m", 0.046},
                 {"10 GPa", "Pa", 1e10},
                 {"15 MN/m", "N/m", 15e6},
                 {"2650 kg/m3", "kg/m3", 2650},
                 {"2.65 g/cm3", "kg/m3", 2650},
                 {"5 min", "s", 300},
                 {"7 %", "1", 0.07},
                 {"-.5e1 us", "s", -5e-6},
                 {"9.81 m/s2", "m/s2", 9.81},
                 {"4 cm2", "m2", 4e-4},
                 {"50 1/s", "1/s", 50},
                 {"180 deg/s", "rad/s", 3.14159265358979324},
                 {"60 rpm", "rad/s", 6.28318530717958648},
                 {"3", "N", 3},
                 {"2 kg m s-2", "N", 2},
                 {"2 kg*m/s^2", "N", 2},
                 {"2 m³/m2", "m", 2},
                 {"1.5 µm", "m", 1.5e-6},
                 {"20", GN_PLAIN_NUMBER, 20},
                 {"600 1/min", GN_EVENT_RATE, 10},
                 {"2 kHz", GN_EVENT_RATE, 2000},
                 {"5 %/s", "1/s", 0.05},
                 {"90 deg", "rad", 1.57079632679489662},
                 {"1 cps", "rad/s", 6.28318530717958648}};
    gn_units *units = gn_units_new();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double value;
        char reason[96];
        if (!gn_units_read(units, cases[k].text, cases[k].unit, &value, reason, sizeof reason))
            fail_msg("'%s' refused%s", cases[k].text, reason);
        assert_close(value, cases[k].value, 1e-15);
    }
    gn_units_free(units);
}

static void a_value_that_is_no_quantity_is_refused(void **state) {
    (void)state;
    static const char *const cases[][2] = {{"23 kg", "m"},
                                           {"", "m"},
                                           {"mm", "m"},
                                           {"nan", "m"},
                                           {".inf", "m"},
                                           {"1e999", "m"},
                                           {"0x10", "m"},
                                           {"1 2 mm", "m"},
                                           {"5 %", "m"},
                                           {"5 mm", "1"},
                                           {"5 deg", "1"},
                                           {"3 Hz", "rad/s"},
                                           {"3 Hz", "s"},
                                           {"5 degC", "m"},
                                           {"1,5 mm", "m"},
                                           {"5 frob", "m"},
                                           {"1e308 Gm", "m"},
                                           {"3 m since 2000-01-01", "m"},
                                           {"--3", "m"},
                                           {"3 m^", "m"},
                                           {"3 m2/", "m"},
                                           {"3 /m", "m"},
                                           {"3 m after s", "m"},
                                           {"3 mm mm", "m"},
                                           {"3 hertz", "rad/s"},
                                           {"3 1/s", "rad/s"},
                                           {"3 kBq", "rad/s"},
                                           {"0.5 m/m", "rad"},
                                           {"50 ppm", "rad"},
                                           {"2 sr", "rad"},
                                           {"600 rpm", "1/s"},
                                           {"3 rad/s", "1/s"},
                                           {"3 Hz", "1/s"},
                                           {"3 kHz", "1/s"},
                                           {"3 becquerel", "1/s"},
                                           {"2 m rad", "m"},
                                           {"2 m/deg", "m"},
                                           {"2 N/rad", "N"},
                                           {"600 rpm", GN_EVENT_RATE},
                                           {"10 cps", GN_EVENT_RATE},
                                           {"10 %/s", GN_EVENT_RATE},
                                           {"10 percent/s", GN_EVENT_RATE},
                                           {"50 %", GN_PLAIN_NUMBER}};
    gn_units *units = gn_units_new();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double value;
        char reason[96];
        if (gn_units_read(units, cases[k][0], cases[k][1], &value, reason, sizeof reason))
            fail_msg("'%s' as %s gave %g", cases[k][0], cases[k][1], value);
    }
    gn_units_free(units);
}

static void a_coefficient_of_friction_is_a_number_or_an_angle_and_no_slope(void **state) {
    (void)state;
    static const char *const refused[] = {"0.5 m/m", "500 ppm", "2 sr", "90 deg", "0.5 rad/m"};
    gn_units *units = gn_units_new();
    double value;
    char reason[96];
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++)
        if (gn_units_read_slope(units, refused[k], &value, reason, sizeof reason))
            fail_msg("'%s' gave %g", refused[k], value);
    assert_true(gn_units_read_slope(units, "45 deg", &value, reason, sizeof reason));
    assert_close(value, 1.0, 1e-15);
    assert_true(gn_units_read_slope(units, "50 %", &value, reason, sizeof reason));
    assert_close(value, 0.5, 1e-15);
    gn_units_free(units);
}

static void a_strain_is_a_number_or_a_ratio_of_lengths(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
    } cases[] = {{"0.005", 0.005},
                 {"0.5 %", 0.005},
                 {"1 mm/m", 0.001},
                 {"5 um/m", 5e-6},
                 {"500 ppm", 500e-6}};
    static const char *const refused[] = {"1 mm", "1 deg", "1 1/s"};
    static const char *const keys[] = {"time.stop.strain", "materials.rock.fracture_strain"};
    gn_units *units = gn_units_new();
    double value;
    char reason[96];
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++)
        if (gn_units_read(units, refused[k], "m/m", &value, reason, sizeof reason))
            fail_msg("'%s' gave %g", refused[k], value);
    gn_units_free(units);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (size_t n = 0; n < 2; n++) {
            gn_override set = {keys[n], cases[k].text};
            gneiss_error error = {0};
            gn_scene s;
            const char *text = with("test: {kind: compression, axis: z, lower: floor, upper: lid}\n"
                                    "sets: [{name: lid, select: {all: true}}]\n");
            if (gn_scene_parse(text, "s.yaml", NULL, &set, 1, &s, &error) != GNEISS_OK)
                fail_msg("%s: %s", cases[k].text, error.message);
            assert_close(n ? s.materials[0].fracture_strain : s.stop_strain, cases[k].value, 1e-14);
            gn_scene_free(&s);
        }
    refuses_set("time.stop.strain", "1 mm",
                "--set time.stop.strain: expected a strain such as '0.005', '0.5 %' or '5 mm/m' or "
                "'off', found '1 mm' (another dimension)");
}

static void a_rate_of_damping_needs_the_viscous_model(void **state) {
    (void)state;
    refuses_set(
        "damping.background", "{model: viscous, coefficient: 50 Hz}",
        "--set damping.background: damping.background.coefficient: expected a rate such as "
        "'50 1/s' with model viscous, a fraction such as '0.5' or '50 %' with others, found "
        "'50 Hz' (write 1/s)");
}

static void a_short_ton_is_noted_and_a_tonne_is_not(void **state) {
    (void)state;
    gn_scene s = parsed(variant("2650 kg/m3", "2.65 ton/m3"));
    assert_close(s.materials[0].density, 2.65 * 907.18474, 1e-12);
    assert_int_equal(s.notes.count, 1);
    assert_non_null(strstr(s.notes.text[0], "materials[0].density: ton is the short ton of"));
    gn_scene_free(&s);
    s = parsed(variant("2650 kg/m3", "2.65 t/m3"));
    assert_close(s.materials[0].density, 2650, 1e-12);
    assert_int_equal(s.notes.count, 0);
    gn_scene_free(&s);
    assert_null(gn_unit_note("3 tonne"));
    assert_null(gn_unit_note("3 metric_ton"));
    assert_non_null(gn_unit_note("3 kton"));
    assert_non_null(gn_unit_note("3e2 kN tons"));
    assert_non_null(gn_unit_note("3 ton_force"));
}

static void friction_without_a_tangential_spring_is_refused(void **state) {
    (void)state;
    static const char spring[] =
        "needs kratio above 0; found 0: without a tangential spring contacts have no friction";
    char message[256];
    snprintf(message, sizeof message, "s.yaml:9:15: materials[0].friction: %s", spring);
    refuses(variant("kratio: 2", "kratio: 0"), message);
    snprintf(message, sizeof message, "s.yaml:20:49: contacts[0].friction: %s", spring);
    refuses(with("contacts: [{between: rock, kratio: 0, friction: 0.2}]\n"), message);
    refuses(
        with("contacts: [{between: rock, kratio: 0}]\n"),
        "s.yaml:20:36: contacts[0].kratio: expected a value above 0, or friction: 0, found 0 and a "
        "friction of 0.5 by the materials: without a tangential spring contacts have no friction");
    gn_scene smooth = parsed(with("contacts: [{between: rock, kratio: 0, friction: 0}]\n"));
    gn_scene_free(&smooth);
    /* Friction of a stage needs a spring in that stage. */
    static const char stages[] = "stages: [{name: a, end: {time: 1 ms}, materials: {rock: "
                                 "{friction: 0.3}}}, {name: b}]\n";
    char text[8704];
    snprintf(text, sizeof text, "%s%s", variant("kratio: 2\n    friction: 0.5", "kratio: 0"),
             stages);
    snprintf(message, sizeof message, "s.yaml:19:68: stages[0].materials[0].friction: %s", spring);
    refuses(text, message);
    /* A pair may have a spring that the material does not have. */
    gn_override none = {"materials.rock.kratio", "0"};
    gn_scene s;
    gneiss_error error = {0};
    const char *pair = with("contacts: [{between: rock, kratio: 3}]\n");
    assert_int_equal(gn_scene_parse(pair, "s.yaml", NULL, &none, 1, &s, &error), GNEISS_OK);
    gn_scene_free(&s);
}

/* A scene with one more key in its material or behind its end has exactly one note, about it. */
static void keys_that_change_nothing_are_noted(void **state) {
    (void)state;
    static const char *const keys[][2] = {
        {"materials.rock.young", "1 GPa"},
        {"materials.rock.normal_stiffness", "1e6"},
        {"materials.rock.beta", "2"},
        {"materials.rock.tensile_strength", "1 MPa"},
        {"materials.rock.fracture_energy", "10"},
        {"materials.rock.yield_stress_1", "1 MPa"},
        {"materials.rock.strength_scatter", "{distribution: weibull, modulus: 9}"},
        {"law.coupling", "quadratic"},
        {"bonds", "{enabled: off, interaction_range: 0.2}"},
        {"specimen.from_velocities", "rest"},
        {"time", "{end: 1, step: 1e-9, contact_steps: 20}"},
        {"time", "{end: 1, step: 1e-9, safety: 0.5}"},
        {"output", "{energy: off}\nrun: {residual_limit: 0.5}"},
        {"output.burst_reach", "3"},
        {"walls.floor.motion.vx", "1"},
    };
    gn_scene s = parsed(small);
    assert_int_equal(s.notes.count, 0);
    bool uniform = s.stiffness == GN_STIFFNESS_UNIFORM;
    gn_scene_free(&s);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        gneiss_error error = {0};
        gn_override set = {keys[k][0], keys[k][1]};
        if (strchr(keys[k][1], '\n') || (uniform && strstr(keys[k][0], "normal_stiffness")))
            continue;
        if (gn_scene_parse(small, "s.yaml", NULL, &set, 1, &s, &error) != GNEISS_OK)
            fail_msg("%s: %s", keys[k][0], error.message);
        if (s.notes.count != 1 || !s.notes.idle[0])
            fail_msg("%s: %zu notes, %s", keys[k][0], s.notes.count, s.notes.text[0]);
        gn_scene_free(&s);
    }
}

/* Each key alone in a scene in which it has no effect, after the changes that this requires. */
static void keys_that_need_particles_spins_or_damping_are_noted(void **state) {
    (void)state;
    static const char elements[] = "dimension: 2\n"
                                   "elements:\n"
                                   "  rectangle: {size: [1, 1], cells: [2, 2]}\n"
                                   "  materials: [{young: 1 GPa, poisson: 0.2, density: 2000}]\n"
                                   "damping: {background: {model: viscous, coefficient: 1}}\n"
                                   "time: {end: 1}\n";
    static const char hertz[] =
        "dimension: 3\n"
        "specimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]}\n"
        "materials: [{name: m, density: 2000, young: 1 GPa, poisson: 0.2, restitution: 0.5}]\n"
        "law: {stiffness: hertz, rotation: on}\n"
        "time: {end: 1}\n";
    static const char block[] = "dimension: 3\n"
                                "specimen: {box: {size: [1, 1, 1]}, particles: 9, packing: "
                                "{start: random}}\n"
                                "materials: [{name: m, density: 2000, normal_stiffness: 1, "
                                "kratio: 0}]\n"
                                "law: {stiffness: uniform, rotation: off}\n"
                                "time: {end: 1}\n";
    static const struct {
        const char *text, *key, *value;
    } cases[] = {
        {elements, "elements.contact", "{stiffness: 1e6}"},
        {elements, "damping.contact.restitution", "0.5"},
        {elements, "damping.contact.fraction", "0.5"},
        {elements, "damping.background.rotation", "2"},
        {elements, "neighbours.skin", "1 mm"},
        {elements, "time.contact_steps", "20"},
        {elements, "output.events", "on"},
        {elements, "output.burst_reach", "3"},
        {elements, "output.orientation", "on"},
        {hertz, "damping.contact.restitution", "0.9"},
        {hertz, "damping.contact.fraction", "0.1"},
        {block, "specimen.packing.jiggle", "0.1"},
        {block, "output.orientation", "on"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_scene s = parsed(cases[k].text);
        gn_override set = {cases[k].key, cases[k].value};
        gneiss_error error = {0};
        assert_int_equal(s.notes.count, 0);
        gn_scene_free(&s);
        if (gn_scene_parse(cases[k].text, "s.yaml", NULL, &set, 1, &s, &error) != GNEISS_OK)
            fail_msg("%s: %s", cases[k].key, error.message);
        if (s.notes.count != 1 || !s.notes.idle[0] || !strstr(s.notes.text[0], cases[k].key))
            fail_msg("%s: %zu notes, %s", cases[k].key, s.notes.count, s.notes.text[0]);
        gn_scene_free(&s);
    }
}

static void an_unused_material_is_noted_and_needs_its_keys(void **state) {
    (void)state;
    static const char text[] = "dimension: 3\n"
                               "specimen: {particles: [[0, 0, 0, 1 mm]], material: rock}\n"
                               "materials:\n"
                               "  - {name: rock, density: 1, normal_stiffness: 1, kratio: 1}\n"
                               "  - {name: spare, density: 1, kratio: 1%s}\n"
                               "law: {stiffness: uniform}\n"
                               "time: {end: 1}\n";
    char spare[512];
    snprintf(spare, sizeof spare, text, ", normal_stiffness: 1");
    gn_scene s = parsed(spare);
    assert_int_equal(s.notes.count, 1);
    assert_non_null(strstr(s.notes.text[0], "no particle, wall or body is of this material"));
    gn_scene_free(&s);
    snprintf(spare, sizeof spare, text, "");
    refuses(spare, "s.yaml:5:5: materials[1].normal_stiffness: required by the uniform law, but "
                   "not given");
}

static void a_key_that_some_stage_reads_is_not_noted(void **state) {
    (void)state;
    static const char *const bonds[] = {"", "bonds: {enabled: on}, "};
    for (int k = 0; k < 2; k++) {
        char stages[128];
        snprintf(stages, sizeof stages, "stages: [{name: a, end: {time: 1 ms}}, {%sname: b}]\n",
                 bonds[k]);
        const char *limits = "friction: 0.5\n    bond_tension_limit: 1\n    bond_shear_limit: 2";
        char text[8704];
        snprintf(text, sizeof text, "%s%s", variant("friction: 0.5", limits), stages);
        gn_scene s = parsed(text);
        assert_int_equal(s.notes.count, k ? 0 : 2);
        gn_scene_free(&s);
    }
}

static void defaults_fill_what_is_left_out(void **state) {
    (void)state;
    gn_scene s = parsed(small);
    assert_string_equal(s.specimen.material, "rock");
    assert_int_equal(s.specimen.group, 1);
    assert_true(s.specimen.porosity == -1 && s.specimen.scale == 1);
    assert_int_equal(s.bonds, GN_SWITCH_OFF);
    assert_true(s.restitution == -1 && s.damping_fraction == 0);
    assert_true(s.overlap_range == 1 && s.passive_gaps);
    assert_int_equal(s.history_rows, 1000);
    assert_int_equal(s.snapshots, 10);
    assert_true(s.checkpoint_wall == 300);
    assert_int_equal(s.seed, 1);
    assert_false(s.has_domain || s.has_periodic);
    assert_int_equal(s.test.kind, GN_TEST_NONE);
    gn_scene_free(&s);
}

static void a_normal_becomes_a_unit_vector(void **state) {
    (void)state;
    gn_scene s = parsed(variant("[0, 0, 4]", "[3e200, 0, 4e200]"));
    assert_close(s.walls[0].normal[0], 0.6, 1e-15);
    assert_close(s.walls[0].normal[2], 0.8, 1e-15);
    gn_scene_free(&s);
}

static void a_2d_scene_has_short_vectors(void **state) {
    (void)state;
    gn_scene s = loaded("tests/scenes/plane.yaml");
    assert_int_equal(s.dimension, 2);
    assert_int_equal(s.specimen.lattice.cells[2], 1);
    assert_true(s.gravity[1] == -9.81 && s.gravity[2] == 0);
    assert_close(s.sets[0].initial_spin[2], 0.523598775598298873, 1e-15);
    assert_int_equal(s.sets[1].end_upper, 1);
    assert_int_equal(s.sets[1].group, -1);
    gn_scene_free(&s);
}

static void a_table_is_linear_between_and_constant_outside(void **state) {
    (void)state;
    double time[] = {1, 2, 4}, value[] = {10, 20, 0};
    gn_table table = {.count = 3, .time = time, .value = value}, none = {0};
    assert_true(gn_table_at(&table, 0) == 10 && gn_table_at(&table, 1) == 10);
    assert_true(gn_table_at(&table, 1.5) == 15 && gn_table_at(&table, 2) == 20);
    assert_true(gn_table_at(&table, 3) == 10 && gn_table_at(&table, 5) == 0);
    assert_true(gn_table_at(&none, 1) == 0);
    table.count = 1;
    assert_true(gn_table_at(&table, -1) == 10 && gn_table_at(&table, 9) == 10);
}

/* ---- refusals ---- */

static void every_typing_error_is_reported_at_its_place(void **state) {
    (void)state;
    static const char *const cases[][3] = {
        {"2650 kg/m3", "23 mm",
         "s.yaml:6:14: materials[0].density: expected a density such as '2650 kg/m3', found '23 "
         "mm' "
         "(another dimension)"},
        {"2650 kg/m3", "2650 kgg",
         "s.yaml:6:14: materials[0].density: expected a density such as '2650 kg/m3', found '2650 "
         "kgg' (unknown unit)"},
        {"2650 kg/m3", "-1",
         "s.yaml:6:14: materials[0].density: expected a value in [1e-9, 1e15] kg/m3, found '-1'"},
        {"2650 kg/m3", ".nan",
         "s.yaml:6:14: materials[0].density: expected a density such as '2650 kg/m3', found "
         "'.nan'"},
        {"friction:", "frction:",
         "s.yaml:9:5: materials[0].frction: unknown key 'frction'; did you mean 'friction'?"},
        {"law:\n", "lawwwwwwwww: 1\nlaw:\n",
         "s.yaml:10:1: lawwwwwwwww: unknown key 'lawwwwwwwww'; expected one of title, dimension, "
         "origin, specimen, materials, contacts, law, elements, couple, bonds, damping, gravity, "
         "initial, "
         "periodic, "
         "domain, sets, walls, bodies, joints, sources, sinks, clumps, membrane, test, time, "
         "stages, "
         "output, "
         "neighbours, run"},
        {"    kratio: 2\n", "",
         "s.yaml:5:5: materials[0].kratio: required by this law.stiffness, but not given"},
        {"  end: 5 ms", "  safety: 1", "s.yaml:18:1: time.end: required, but not given"},
        {"    friction: 0.5\n", "    density: 1\n",
         "s.yaml:9:5: materials[0].density: expected once, found again; first given in line 6"},
        {"stiffness: uniform", "stiffness: unifrom",
         "s.yaml:11:14: law.stiffness: expected one of uniform, arithmetic, harmonic, mean_radius, "
         "mean_arithmetic, mean_harmonic, dempack, polyhedron, hertz, found 'unifrom'; did you "
         "mean "
         "'uniform'?"},
        {"dimension: 3", "dimension: 4",
         "s.yaml:1:12: dimension: expected a whole number in [2, 3], found '4'"},
        {"  end: 5 ms", "  end: [5 ms]",
         "s.yaml:19:8: time.end: expected a time such as '5 ms', found a list"},
        {"[0, 0, -1 mm]", "[0, 0, -1 mN]",
         "s.yaml:14:19: walls[0].point[2]: expected a length such as '23 mm', found '-1 mN' "
         "(another "
         "dimension)"},
        {"[0, 0, -1 mm]", "[0, 0]",
         "s.yaml:14:12: walls[0].point: expected a list of 3 components, found a list of another "
         "length"},
        {"vz: 1 mm/s", "vz: [[0, 0], [0, 1]]",
         "s.yaml:17:28: walls[0].motion.vz[1]: expected a time after that of the previous row, "
         "found "
         "'0'"},
        {"vz: 1 mm/s", "vz: [[0, 0, 0]]",
         "s.yaml:17:19: walls[0].motion.vz[0]: expected a row [time, value], found a list"},
        {"dimension: 3", "origin: [0, 0, 1e308]",
         "s.yaml:1:16: origin[2]: expected a value in [-1e9, 1e9] m, found '1e308'"},
        {"name: rock", "name: a.b",
         "s.yaml:5:11: materials[0].name: expected a name (not empty, not a number, without . / "
         "[ ] = and control characters), found 'a.b'"},
        {"dimension: 3", "dimension:\n  a: 1\n - b",
         "s.yaml:3:2: not valid YAML: wrong indentation in sequence while in mapping"},
        {"stiffness: uniform", "stiffness: [uniform",
         "s.yaml:13:3: not valid YAML: did not find expected node content"},
        {"dimension: 3", "dimension: *three",
         "s.yaml:1:12: YAML aliases are not part of a scene; repeat the value"},
        {"dimension: 3", "dimension: !!int 3", "s.yaml:1:18: YAML tags are not part of a scene"},
        {"time:\n  end: 5 ms", "---\ntime: 1",
         "s.yaml:18:1: expected one YAML document, found a second one"},
        {"[[0, 0, 0, 1 mm], ", "[[0, 0, 0, 0], ",
         "s.yaml:3:25: specimen.particles[0]: expected a value in [1e-9, 1e9] m, found '0'"},
        {"law:", "law: 3\nrun:",
         "s.yaml:10:6: law: expected a section, found '3'\n"
         "s.yaml:12:3: run.stiffness: unknown key 'stiffness'; expected one of seed, threads, "
         "precision, isa, residual_warning, residual_limit"},
        {"- name: rock\n    density", "- name: rock\n  - density",
         "s.yaml:5:5: materials[0].density: required, but not given\n"
         "s.yaml:6:5: materials[1].name: required, but not given"},
        {"dimension: 3", "title: \"a\\0b\"",
         "s.yaml:1:8: expected text, found a NUL character in it"},
        {"rock", "r\xff",
         "s.yaml:5:12: expected UTF-8 text, found the byte 0xff: is this a scene file?"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        refuses(variant(cases[k][0], cases[k][1]), cases[k][2]);
}

static void keys_that_contradict_each_other_are_refused(void **state) {
    (void)state;
    static const char *const changes[][3] = {
        {"  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n", "  group: 1\n",
         "s.yaml:2:1: specimen: expected one of file, a list of particles, lattice, box, cylinder, "
         "surface, mesh, found none"},
        {"specimen:\n", "specimen:\n  lattice: {kind: fcc, radius: 1, cells: [1, 1, 1]}\n",
         "s.yaml:2:1: specimen: expected one of file, a list of particles, lattice, box, cylinder, "
         "surface, mesh, found a list of particles, lattice"},
        {"  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n",
         "  lattice: {kind: square, radius: 1, cells: [1, 1, 1]}\n",
         "s.yaml:3:19: specimen.lattice.kind: expected a lattice of a 3D scene: cubic, fcc, hcp"},
        {"  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n", "  file: no/such\n",
         "s.yaml:3:9: specimen.file: cannot open 'no/such': No such file or directory"},
        {"specimen:\n", "specimen:\n  material: rok\n",
         "s.yaml:3:13: specimen.material: expected the name of a material, found 'rok'; did you "
         "mean 'rock'?"},
        {"specimen:\n", "specimen:\n  porosity: 0.3\n",
         "s.yaml:3:13: specimen.porosity: needs density_basis bulk; found particle"},
        {"uniform", "harmonic",
         "s.yaml:5:5: materials[0].contact_modulus: required by this law.stiffness, but not given"},
        {"    normal_stiffness: 1 MN/m\n", "",
         "s.yaml:5:5: materials[0].normal_stiffness: required by the uniform law, but not given"},
        {"law:", "bonds:\nlaw:",
         "s.yaml:5:5: materials[0].bond_tension_limit: required by bonds of the uniform law, but "
         "not given\n"
         "s.yaml:5:5: materials[0].bond_shear_limit: required by bonds of the uniform law, but "
         "not "
         "given"},
        {"[0, 0, 4]", "[0, -0, 0]",
         "s.yaml:15:13: walls[0].normal: expected a direction, found [0, 0, 0]"},
        {"    stiffness: 2 MN/m\n", "    stiffness: 2 MN/m\n    friction: 0.2\n",
         "s.yaml:13:5: walls[0].kratio: required by friction, but not given"},
        {"    motion:", "    servo: {force: 1 kN, max_velocity: 1}\n    motion:",
         "s.yaml:17:5: walls[0].servo: expected motion or servo, found both"},
        {"time:\n", "time:\n  step: 1 s\n",
         "s.yaml:19:9: time.step: expected a step below the end, found 1 s and 0.005 s"},
    };
    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++)
        refuses(variant(changes[k][0], changes[k][1]), changes[k][2]);
    static const char *const additions[][2] = {
        {"damping: {contact: {restitution: 0.5, fraction: 0.1}}",
         "s.yaml:20:49: damping.contact.fraction: expected restitution or fraction, found both"},
        {"damping: {background: {model: nonviscous_vector, coefficient: 1}}",
         "s.yaml:20:63: damping.background.coefficient: expected a fraction in [0, 1), found 1"},
        {"damping: {background: {model: nonviscous_vector, coefficient: 0.5 1/s}}",
         "s.yaml:20:63: damping.background.coefficient: expected a number such as '0.5' or '50 %' "
         "for "
         "this model, found '0.5 1/s' (another dimension: expected no unit or %)"},
        {"damping: {background: {model: viscous, coefficient: 5 %}}",
         "s.yaml:20:53: damping.background.coefficient: expected a rate such as '50 1/s' for this "
         "model, found '5 %' (another dimension)"},
        {"damping: {background: {model: viscous}}",
         "s.yaml:20:11: damping.background.coefficient: required by the model, but not given"},
        {"damping: {background: {model: viscous, coefficient: 5, velocity: instant}}",
         "s.yaml:20:66: damping.background.velocity: instant needs the model nonviscous_component, "
         "found another one"},
        {"periodic: {min: [0, 0, 0], max: [1, 0, 1]}",
         "s.yaml:20:33: periodic.max: expected a corner above min in every direction, found y: 0 "
         "to 0"},
        {"output: {snapshots: }",
         "s.yaml:20:10: output.snapshots: expected a whole number in [0, 1000000], found "
         "nothing"},
        {"domain: {min: [0, 0, 0]}", "s.yaml:20:1: domain.max: required beside min, but not given"},
        {"sets:\n  - {name: a, select: {}}",
         "s.yaml:21:15: sets[0].select: expected all, box, ids or end, found none"},
        {"sets:\n  - {name: floor, select: {all: true}}",
         "s.yaml:21:12: sets[0].name: expected a unique name, found 'floor' a second time"},
        {"sets:\n  - {name: a, select: {all: true}}\n  - {name: a, select: {ids: [0]}}",
         "s.yaml:22:12: sets[1].name: expected a unique name, found 'a' a second time"},
        {"sets:\n  - {name: a, material: b, select: {all: true}}",
         "s.yaml:21:25: sets[0].material: expected the name of a material, found 'b'; there is "
         "rock"},
        {"test: {kind: tension, axis: z, lower: floor, upper: roof}",
         "s.yaml:20:53: test.upper: expected the name of a wall, a body or a set, found 'roof'; "
         "there is floor"},
        {"test: {kind: tension, axis: z, lower: floor, upper: floor}",
         "s.yaml:20:53: test.upper: expected another end than lower, found 'floor'"},
        {"test: {kind: none, axis: z, lower: floor, upper: floor}",
         "s.yaml:20:14: test.kind: expected one of compression, tension, brazilian, bending, "
         "triaxial, biaxial, hydrostatic, polyaxial, oedometer, shear, simple_shear, cutting, "
         "found 'none'"},
    };
    for (size_t k = 0; k < sizeof additions / sizeof *additions; k++)
        refuses(with(additions[k][0]), additions[k][1]);
}

static void a_2d_scene_stays_in_its_plane(void **state) {
    (void)state;
    static const char *const changes[][2] = {
        {"gravity=[0, 0, 1]",
         "--set gravity: expected nothing out of the plane of a 2D scene, found a list"},
        {"sets.left.motion.vz=0", "--set sets.left.motion.vz: sets[0].motion.vz: expected no "
                                  "motion out of the plane of a 2D scene: only vx, vy and wz"},
        {"sets.left.initial_spin=[1, 0]",
         "--set sets.left.initial_spin: sets[0].initial_spin: expected a "
         "spin about z such as '30 deg/s', found a list of another length"},
        {"test.axis=z", "--set test.axis: expected x or y in a 2D scene, found z"},
        {"specimen.lattice.kind=hcp",
         "--set specimen.lattice.kind: expected a lattice of a 2D scene: square, hexagonal"},
        {"law.rotation=off", "%s/tests/scenes/plane.yaml:15:52: sets[0].motion.wz: expected "
                             "law.rotation on beside a spin, found "
                             "off"},
    };
    char path[4096], key[64], message[5000];
    snprintf(path, sizeof path, "%s/tests/scenes/plane.yaml", test_source());
    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        const char *equals = strchr(changes[k][0], '=');
        snprintf(key, sizeof key, "%.*s", (int)(equals - changes[k][0]), changes[k][0]);
        gn_override override = {key, equals + 1};
        gn_scene scene;
        gneiss_error error = {0};
        assert_int_equal(gn_scene_load(path, &override, 1, &scene, &error), GNEISS_ERROR_INPUT);
        bool place = strncmp(changes[k][1], "%s", 2) == 0;
        snprintf(message, sizeof message, "%s%s", place ? test_source() : "",
                 changes[k][1] + 2 * place);
        assert_string_equal(error.message, message);
    }
}

/* ---- files ---- */

static gneiss_status load_text(const char *text, size_t length, gneiss_error *error) {
    char path[] = "/tmp/gneiss-scene-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, length), (ssize_t)length);
    close(file);
    gn_scene scene;
    gneiss_status status = gn_scene_load(path, NULL, 0, &scene, error);
    gn_scene_free(&scene);
    unlink(path);
    return status;
}

static void files_that_are_no_scenes_are_refused(void **state) {
    (void)state;
    gn_scene scene;
    gneiss_error error = {0};
    assert_int_equal(gn_scene_load("/nowhere/x.yaml", NULL, 0, &scene, &error), GNEISS_ERROR_INPUT);
    assert_string_equal(error.message,
                        "/nowhere/x.yaml: cannot open the scene: No such file or directory");
    assert_int_equal(gn_scene_load("/", NULL, 0, &scene, &error), GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, "/: expected a scene file, found a folder");
    assert_int_equal(load_text("", 0, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, ":1:1: expected a scene, found an empty file"));
    assert_int_equal(load_text(" \n\n", 3, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "found an empty file"));
    assert_int_equal(load_text("# x\n", 4, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "found an empty file"));
    assert_int_equal(load_text("a: 1\0b\n", 7, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, ":1:5: expected UTF-8 text, found the byte 0x00"));
}

static void a_file_above_the_limit_is_refused(void **state) {
    (void)state;
    size_t size = ((size_t)64 << 20) + 1;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, '#', size);
    gneiss_error error = {0};
    assert_int_equal(load_text(text, size, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "expected a scene of at most 64 MB, found more"));
    free(text);
}

static void a_refused_scene_holds_nothing(void **state) {
    (void)state;
    gn_scene scene, nothing;
    memset(&nothing, 0, sizeof nothing);
    gneiss_error error = {0};
    assert_int_not_equal(
        gn_scene_parse(variant("5 ms", "5 kg"), "s", NULL, NULL, 0, &scene, &error), 0);
    assert_memory_equal(&scene, &nothing, sizeof scene);
}

/* ---- overrides ---- */

static void overrides_reach_keys_lists_and_names(void **state) {
    (void)state;
    gn_override overrides[] = {{"time.end", "2ms"},
                               {"materials[0].friction", "10 %"},
                               {"materials.0.kratio", "3"},
                               {"walls.floor.motion.vz", "[[0, 0], [1 ms, -1 m/s]]"},
                               {"walls[0].point[2]", "7 mm"},
                               {"title", "a: b # c"},
                               {"output.snapshots", "3"},
                               {"damping.contact.restitution", " 0.5 "},
                               {"damping", "{background: {model: viscous, coefficient: 2}}"},
                               {"run.seed", "5"},
                               {"run.seed", "6"}};
    gn_scene s;
    gneiss_error error = {0};
    if (gn_scene_parse(small, "s", NULL, overrides, sizeof overrides / sizeof *overrides, &s,
                       &error))
        fail_msg("%s", error.message);
    assert_true(s.end == 0.002 && s.materials[0].friction == 0.1 && s.materials[0].kratio == 3);
    assert_int_equal(s.walls[0].motion.velocity[2].count, 2);
    assert_true(s.walls[0].point[2] == 0.007);
    assert_string_equal(s.title, "a: b # c");
    assert_int_equal(s.snapshots, 3);
    assert_true(s.restitution == -1 && s.background_coefficient == 2);
    assert_int_equal(s.seed, 6);
    gn_scene_free(&s);
}

static void overrides_without_a_target_are_reported_by_their_key(void **state) {
    (void)state;
    refuses_set("time.end", "2 kg",
                "--set time.end: expected a time such as '5 ms', found '2 kg' (another dimension)");
    refuses_set("time.ned", "2", "--set time.ned: unknown key 'ned'; did you mean 'end'?");
    refuses_set("walls.roof.friction", "1",
                "--set walls.roof.friction: no element 'roof' in this list (index base 0, or "
                "name); there is floor");
    refuses_set("materials[1].friction", "1",
                "--set materials[1].friction: no element '1' in this list (index base 0, or name); "
                "there is rock");
    refuses_set("time.end.x", "1", "--set time.end.x: 'x' is below a value, not in a section");
    refuses_set("time.end", "", "--set time.end: expected a time such as '5 ms', found nothing");
    refuses_set("bodies[0].density", "2",
                "--set bodies[0].density: expected an existing list, such as by --set "
                "bodies=[...]");
    refuses_set("gravity", "[0, 0",
                "--set gravity: not valid YAML: flow sequence without a closing bracket");
    static const char *const bad[] = {"time.",       ".time", "time..end", "materials[0",
                                      "materials[]", "a]b",   "["};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char message[256];
        snprintf(message, sizeof message,
                 "--set %s: expected a key such as walls.top.motion.vz or materials[0].density",
                 bad[k]);
        refuses_set(bad[k], "1", message);
    }
    refuses_set("", "1", "--set: expected key=value such as time.end=2ms");
}

/* Names become parts of overrides and of the paths of data sets. */
static void names_that_no_path_can_hold_are_refused(void **state) {
    (void)state;
    static const char *const bad[] = {"a/b", "/",    "-1",         "1e5",       ".5",
                                      "nan", "-inf", "0x1f",       "\"a\\eb\"", "\"a\\x7f\"",
                                      "a.b", "\"\"", "\"a\\x85\"", "\"a\\nb\""};
    static const char *const good[] = {"1a", "nano", "e5", "rock-1", "Wand 2", "fu\u00df", "-"};
    for (int list = 0; list < 2; list++)
        for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
            char name[64];
            gn_scene scene;
            gneiss_error error = {0};
            snprintf(name, sizeof name, "name: %s\n", bad[k]);
            const char *text = variant(list ? "name: floor\n" : "name: rock\n", name);
            int status = gn_scene_parse(text, "s.yaml", NULL, NULL, 0, &scene, &error);
            assert_int_equal(status, GNEISS_ERROR_INPUT);
            assert_non_null(strstr(error.message, list ? "s.yaml:13:11: walls[0].name: "
                                                       : "s.yaml:5:11: materials[0].name: "));
        }
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        char name[64];
        snprintf(name, sizeof name, "name: \"%s\"\n", good[k]);
        gn_scene scene = parsed(variant("name: floor\n", name));
        assert_string_equal(scene.walls[0].name, good[k]);
        gn_scene_free(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rock_scene_reads_as_written),
        cmocka_unit_test(units_are_converted_to_si),
        cmocka_unit_test(a_value_that_is_no_quantity_is_refused),
        cmocka_unit_test(a_coefficient_of_friction_is_a_number_or_an_angle_and_no_slope),
        cmocka_unit_test(a_strain_is_a_number_or_a_ratio_of_lengths),
        cmocka_unit_test(a_rate_of_damping_needs_the_viscous_model),
        cmocka_unit_test(a_short_ton_is_noted_and_a_tonne_is_not),
        cmocka_unit_test(keys_that_change_nothing_are_noted),
        cmocka_unit_test(keys_that_need_particles_spins_or_damping_are_noted),
        cmocka_unit_test(friction_without_a_tangential_spring_is_refused),
        cmocka_unit_test(an_unused_material_is_noted_and_needs_its_keys),
        cmocka_unit_test(a_key_that_some_stage_reads_is_not_noted),
        cmocka_unit_test(defaults_fill_what_is_left_out),
        cmocka_unit_test(a_normal_becomes_a_unit_vector),
        cmocka_unit_test(a_2d_scene_has_short_vectors),
        cmocka_unit_test(a_table_is_linear_between_and_constant_outside),
        cmocka_unit_test(every_typing_error_is_reported_at_its_place),
        cmocka_unit_test(names_that_no_path_can_hold_are_refused),
        cmocka_unit_test(keys_that_contradict_each_other_are_refused),
        cmocka_unit_test(a_2d_scene_stays_in_its_plane),
        cmocka_unit_test(files_that_are_no_scenes_are_refused),
        cmocka_unit_test(a_file_above_the_limit_is_refused),
        cmocka_unit_test(a_refused_scene_holds_nothing),
        cmocka_unit_test(overrides_reach_keys_lists_and_names),
        cmocka_unit_test(overrides_without_a_target_are_reported_by_their_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
