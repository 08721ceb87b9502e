#include "test.h"

#include "base/memory.h"
#include "scene/read.h"

#include <sys/stat.h>
#include <unistd.h>

/* ---- scenes to start from ---- */

static const char small[] = "dimension: 3\n"                                       /* line 1 */
                            "specimen:\n"                                          /* 2 */
                            "  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n" /* 3 */
                            "materials:\n"                                         /* 4 */
                            "  - name: rock\n"                                     /* 5 */
                            "    density: 2650 kg/m3\n"                            /* 6 */
                            "    normal_stiffness: 1 MN/m\n"                       /* 7 */
                            "    kratio: 2\n"                                      /* 8 */
                            "    friction: 0.5\n"                                  /* 9 */
                            "law:\n"                                               /* 10 */
                            "  stiffness: uniform\n"                               /* 11 */
                            "walls:\n"                                             /* 12 */
                            "  - name: floor\n"                                    /* 13 */
                            "    point: [0, 0, -1 mm]\n"                           /* 14 */
                            "    normal: [0, 0, 4]\n"                              /* 15 */
                            "    stiffness: 2 MN/m\n"                              /* 16 */
                            "    motion: {vz: 1 mm/s}\n"                           /* 17 */
                            "time:\n"                                              /* 18 */
                            "  end: 5 ms\n";                                       /* 19 */

/* The small scene with the first `from` turned into `to`. */
static char *variant(const char *from, const char *to) {
    static char text[8192];
    const char *at = strstr(small, from);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - small), small, to, at + strlen(from));
    return text;
}

static char *with(const char *more) {
    static char text[8192];
    snprintf(text, sizeof text, "%s%s", small, more);
    return text;
}

static gn_scene parsed(const char *text) {
    gn_scene scene;
    gneiss_error error = {0};
    if (gn_scene_parse(text, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("refused: %s", error.message);
    return scene;
}

static gn_scene loaded(const char *file) {
    char path[4096];
    gn_scene scene;
    gneiss_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_source(), file);
    if (gn_scene_load(path, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("refused: %s", error.message);
    return scene;
}

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

static void units_turn_into_si(void **state) {
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
                 {"1.5 µm", "m", 1.5e-6}};
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

static void what_is_no_quantity_is_refused(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"23 kg", "m"},  {"", "m"},         {"mm", "m"},
        {"nan", "m"},    {".inf", "m"},     {"1e999", "m"},
        {"0x10", "m"},   {"1 2 mm", "m"},   {"5 %", "m"},
        {"5 mm", "1"},   {"5 deg", "1"},    {"3 Hz", "rad/s"},
        {"3 Hz", "s"},   {"5 degC", "m"},   {"1,5 mm", "m"},
        {"5 frob", "m"}, {"1e308 Gm", "m"}, {"3 m since 2000-01-01", "m"},
        {"--3", "m"}};
    gn_units *units = gn_units_new();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double value;
        char reason[96];
        if (gn_units_read(units, cases[k][0], cases[k][1], &value, reason, sizeof reason))
            fail_msg("'%s' as %s gave %g", cases[k][0], cases[k][1], value);
    }
    gn_units_free(units);
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
    gn_table table = {3, time, value}, none = {0};
    assert_true(gn_table_at(&table, 0) == 10 && gn_table_at(&table, 1) == 10);
    assert_true(gn_table_at(&table, 1.5) == 15 && gn_table_at(&table, 2) == 20);
    assert_true(gn_table_at(&table, 3) == 10 && gn_table_at(&table, 5) == 0);
    assert_true(gn_table_at(&none, 1) == 0);
    table.count = 1;
    assert_true(gn_table_at(&table, -1) == 10 && gn_table_at(&table, 9) == 10);
}

/* ---- refusals ---- */

static void every_slip_is_told_with_its_place(void **state) {
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
         "s.yaml:6:14: materials[0].density: expected a value in (0, inf) kg/m3, found '-1'"},
        {"2650 kg/m3", ".nan",
         "s.yaml:6:14: materials[0].density: expected a density such as '2650 kg/m3', found "
         "'.nan'"},
        {"friction:", "frction:",
         "s.yaml:9:5: materials[0].frction: unknown key 'frction'; did you mean 'friction'?"},
        {"law:\n", "lawwwwwwwww: 1\nlaw:\n",
         "s.yaml:10:1: lawwwwwwwww: unknown key 'lawwwwwwwww'; expected one of title, dimension, "
         "specimen, materials, law, bonds, damping, gravity, initial, periodic, domain, sets, "
         "walls, "
         "test, time, output, neighbours, run"},
        {"    kratio: 2\n", "", "s.yaml:5:5: materials[0].kratio: required, but not given"},
        {"  end: 5 ms", "  safety: 1", "s.yaml:18:1: time.end: required, but not given"},
        {"    friction: 0.5\n", "    density: 1\n",
         "s.yaml:9:5: materials[0].density: expected once, found again; first given in line 6"},
        {"stiffness: uniform", "stiffness: unifrom",
         "s.yaml:11:14: law.stiffness: expected one of uniform, arithmetic, harmonic, mean_radius, "
         "mean_arithmetic, mean_harmonic, found 'unifrom'"},
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
         "s.yaml:17:28: walls[0].motion.vz[1]: expected a time after that of the row before, found "
         "'0'"},
        {"vz: 1 mm/s", "vz: [[0, 0, 0]]",
         "s.yaml:17:19: walls[0].motion.vz[0]: expected a row [time, value], found a list"},
        {"name: rock", "name: a.b",
         "s.yaml:5:11: materials[0].name: expected a name (not empty, not a number, without . [ ] "
         "=), "
         "found 'a.b'"},
        {"stiffness: uniform", "stiffness: [uniform",
         "s.yaml:13:3: not valid YAML: did not find expected node content"},
        {"dimension: 3", "dimension: *three",
         "s.yaml:1:12: YAML aliases are not part of a scene; repeat the value"},
        {"dimension: 3", "dimension: !!int 3", "s.yaml:1:18: YAML tags are not part of a scene"},
        {"time:\n  end: 5 ms", "---\ntime: 1",
         "s.yaml:18:1: expected one YAML document, found a second one"},
        {"[[0, 0, 0, 1 mm], ", "[[0, 0, 0, 0], ",
         "s.yaml:3:25: specimen.particles[0]: expected a radius above 0, found '0'"},
        {"law:", "law: 3\nrun:", "s.yaml:10:6: law: expected a section, found '3'"},
        {"- name: rock\n    density", "- name: rock\n  - density",
         "s.yaml:5:5: materials[0].density: required, but not given"},
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
         "s.yaml:2:1: specimen: expected one of file, particles and lattice, found none"},
        {"specimen:\n", "specimen:\n  lattice: {kind: fcc, radius: 1, cells: [1, 1, 1]}\n",
         "s.yaml:2:1: specimen: expected one of file, particles and lattice, found several"},
        {"  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n",
         "  lattice: {kind: square, radius: 1, cells: [1, 1, 1]}\n",
         "s.yaml:3:19: specimen.lattice.kind: expected a lattice of a 3D scene: cubic, fcc, hcp"},
        {"  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]\n", "  file: no/such\n",
         "s.yaml:3:9: specimen.file: cannot open 'no/such': No such file or directory"},
        {"specimen:\n", "specimen:\n  material: rok\n",
         "s.yaml:3:13: specimen.material: expected the name of a material, found 'rok'"},
        {"specimen:\n", "specimen:\n  porosity: 0.3\n",
         "s.yaml:3:13: specimen.porosity: expected density_basis bulk beside it, found particle"},
        {"uniform", "harmonic",
         "s.yaml:5:5: materials[0].contact_modulus: required by this law.stiffness, but not given"},
        {"    normal_stiffness: 1 MN/m\n", "",
         "s.yaml:5:5: materials[0].normal_stiffness: required by the uniform law, but not given"},
        {"law:", "bonds:\nlaw:",
         "s.yaml:5:5: materials[0].bond_tension_limit: required by bonds of the uniform law, but "
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
        {"periodic: {min: [0, 0, 0], max: [1, 0, 1]}",
         "s.yaml:20:33: periodic.max: expected a corner above min in every direction, found y: 0 "
         "to 0"},
        {"domain: {min: [0, 0, 0]}", "s.yaml:20:1: domain.max: required beside min, but not given"},
        {"sets:\n  - {name: a, select: {}}",
         "s.yaml:21:15: sets[0].select: expected all, box, ids or end, found none"},
        {"sets:\n  - {name: floor, select: {all: true}}",
         "s.yaml:21:12: sets[0].name: expected a name of its own, found 'floor' a second time"},
        {"sets:\n  - {name: a, select: {all: true}}\n  - {name: a, select: {ids: [0]}}",
         "s.yaml:22:12: sets[1].name: expected a name of its own, found 'a' a second time"},
        {"sets:\n  - {name: a, material: b, select: {all: true}}",
         "s.yaml:21:25: sets[0].material: expected the name of a material, found 'b'"},
        {"test: {kind: tension, axis: z, lower: floor, upper: roof}",
         "s.yaml:20:53: test.upper: expected the name of a wall or a set, found 'roof'"},
        {"test: {kind: tension, axis: z, lower: floor, upper: floor}",
         "s.yaml:20:53: test.upper: expected another end than lower, found 'floor'"},
        {"test: {kind: none, axis: z, lower: floor, upper: floor}",
         "s.yaml:20:14: test.kind: expected one of compression, tension, found 'none'"},
    };
    for (size_t k = 0; k < sizeof additions / sizeof *additions; k++)
        refuses(with(additions[k][0]), additions[k][1]);
}

static void a_2d_scene_stays_in_its_plane(void **state) {
    (void)state;
    static const char *const changes[][2] = {
        {"gravity=[0, 0, 1]",
         "--set gravity: expected nothing out of the plane of a 2D scene, found a list"},
        {"sets.left.motion.vz=0",
         "--set sets.left.motion.vz: sets[0].motion.vz: expected nothing out of "
         "the plane of a 2D scene: only vx, vy and wz move"},
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
    assert_int_equal(gn_scene_load("/nowhere/x.yaml", NULL, 0, &scene, &error), GNEISS_ERROR_IO);
    assert_string_equal(error.message,
                        "/nowhere/x.yaml: cannot open the scene: No such file or directory");
    assert_int_equal(gn_scene_load("/", NULL, 0, &scene, &error), GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, "/: expected a scene file, found a folder");
    assert_int_equal(load_text("", 0, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, ":1:1: expected a scene, found an empty file"));
    assert_int_equal(load_text(" \n\n", 3, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "found an empty file"));
    assert_int_equal(load_text("# x\n", 4, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "found an empty scene"));
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

static void overrides_that_miss_are_told_by_their_key(void **state) {
    (void)state;
    refuses_set("time.end", "2 kg",
                "--set time.end: expected a time such as '5 ms', found '2 kg' (another dimension)");
    refuses_set("time.ned", "2", "--set time.ned: unknown key 'ned'; did you mean 'end'?");
    refuses_set(
        "walls.roof.friction", "1",
        "--set walls.roof.friction: no element 'roof' in this list (index base 0, or name)");
    refuses_set("materials[1].friction", "1",
                "--set materials[1].friction: no element '1' in this list (index base 0, or name)");
    refuses_set("time.end.x", "1", "--set time.end.x: 'x' is below a value, not in a section");
    refuses_set("time.end", "", "--set time.end: expected a time such as '5 ms', found nothing");
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

/* ---- writing ---- */

static void same_section(const gn_section *section, const char *a, const char *b);

static void same_bits(const gn_key *key, const char *a, const char *b, size_t size) {
    if (memcmp(a, b, size) != 0) fail_msg("'%s' changed on its way through a file", key->name);
}

static void same_array(const gn_key *key, const char *a, const char *b, size_t size) {
    const char *first, *second;
    size_t count = *(const size_t *)(a + key->second);
    assert_int_equal(count, *(const size_t *)(b + key->second));
    memcpy(&first, a + key->offset, sizeof first);
    memcpy(&second, b + key->offset, sizeof second);
    for (size_t k = 0; k < count; k++)
        if (key->section)
            same_section(key->section, first + k * size, second + k * size);
        else
            same_bits(key, first + k * size, second + k * size, size);
}

static void same_key(const gn_key *key, const char *a, const char *b) {
    const char *x = a + key->offset, *y = b + key->offset;
    const gn_table *t = (const gn_table *)x, *u = (const gn_table *)y;
    switch (key->type) {
    case GN_KEY_TEXT:
    case GN_KEY_NAME:
        assert_string_equal(x, y);
        break;
    case GN_KEY_FILE:
        assert_string_equal(a + key->second, b + key->second);
        break;
    case GN_KEY_SECTION:
        same_section(key->section, x, y);
        break;
    case GN_KEY_LIST:
        same_array(key, a, b, key->section->size);
        break;
    case GN_KEY_IDS:
        same_array(key, a, b, sizeof(int64_t));
        break;
    case GN_KEY_PARTICLES:
        same_array(key, a, b, 4 * sizeof(double));
        break;
    case GN_KEY_TABLE:
        assert_int_equal(t->count, u->count);
        if (t->count) same_bits(key, (char *)t->time, (char *)u->time, t->count * sizeof(double));
        if (t->count) same_bits(key, (char *)t->value, (char *)u->value, t->count * sizeof(double));
        break;
    default:
        same_bits(key, x, y, key->size);
    }
}

static void same_section(const gn_section *section, const char *a, const char *b) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        assert_int_equal(gn_key_present(key, a), gn_key_present(key, b));
        same_key(key, a, b);
    }
}

static void comes_back(gn_scene *scene) {
    gneiss_error error = {0};
    gn_scene again;
    char *text = gn_scene_write(scene);
    assert_non_null(text);
    if (gn_scene_parse(text, "echo", "/", NULL, 0, &again, &error))
        fail_msg("%s\n%s", error.message, text);
    same_section(&gn_scene_section, (char *)scene, (char *)&again);
    char *twice = gn_scene_write(&again);
    assert_string_equal(text, twice);
    free(text);
    free(twice);
    gn_scene_free(&again);
    gn_scene_free(scene);
}

static void a_written_scene_comes_back_bit_for_bit(void **state) {
    (void)state;
    static const char *const files[] = {"scenes/ucs-rock.yaml", "tests/scenes/everything.yaml",
                                        "tests/scenes/plane.yaml"};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        gn_scene scene = loaded(files[k]);
        comes_back(&scene);
    }
    gn_scene scene = parsed(small);
    comes_back(&scene);
}

static void awkward_numbers_come_back_bit_for_bit(void **state) {
    (void)state;
    uint64_t draw = 1;
    for (int k = 0; k < 200; k++) {
        char normal[96], velocity[96];
        double v[4];
        for (int c = 0; c < 4; c++) {
            draw = draw * 6364136223846793005u + 1442695040888963407u;
            v[c] = ldexp((double)(draw >> 11) - 0x1p52, (int)(draw % 40) - 70);
        }
        snprintf(normal, sizeof normal, "[%.17g, %.17g, %.17g]", v[0], v[1], v[2]);
        snprintf(velocity, sizeof velocity, "[[%.17g, -0.0]]", v[3]);
        gn_override overrides[] = {{"walls.floor.normal", normal},
                                   {"walls.floor.motion.vz", velocity}};
        gn_scene scene;
        gneiss_error error = {0};
        if (gn_scene_parse(small, "s", NULL, overrides, 2, &scene, &error))
            fail_msg("%s", error.message);
        comes_back(&scene);
    }
}

/* ---- effects ---- */

static gn_effects effects_of(gn_scene scene) {
    gn_effects mask = gn_scene_effects(&scene);
    gn_scene_free(&scene);
    return mask;
}

static void effects_are_what_the_scene_calls_for(void **state) {
    (void)state;
    assert_int_equal(effects_of(loaded("scenes/ucs-rock.yaml")),
                     GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_BONDS | GN_FX_NONVISCOUS_VECTOR | GN_FX_WALLS | GN_FX_ENERGY);
    assert_int_equal(effects_of(loaded("tests/scenes/everything.yaml")),
                     GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_BONDS | GN_FX_CONTACT_DAMPING | GN_FX_VISCOUS | GN_FX_GRAVITY |
                         GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_WALLS | GN_FX_WALL_SHEAR |
                         GN_FX_PERIODIC | GN_FX_ORIENTATION);
    assert_int_equal(effects_of(loaded("tests/scenes/plane.yaml")),
                     GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_NONVISCOUS_COMPONENT | GN_FX_GRAVITY |
                         GN_FX_APPLIED | GN_FX_PRESCRIBED | GN_FX_WALLS | GN_FX_ENERGY);
    gn_effects base = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_PAIRS | GN_FX_WALLS | GN_FX_ENERGY;
    assert_int_equal(effects_of(parsed(small)), base | GN_FX_SHEAR | GN_FX_FRICTION);
    assert_int_equal(effects_of(parsed(variant("friction: 0.5", "friction: 0"))), base);
    assert_int_equal(effects_of(parsed(variant("kratio: 2", "kratio: 0"))), base);
    assert_int_equal(effects_of(parsed(with("output: {energy: off, orientation: on}\n"))),
                     (base & ~(gn_effects)GN_FX_ENERGY) | GN_FX_SHEAR | GN_FX_FRICTION |
                         GN_FX_ORIENTATION);
}

static void bonds_need_a_group(void **state) {
    (void)state;
    const char *bonded =
        "    friction: 0\n    bond_tension_limit: 1\n    bond_shear_limit: 1\nbonds:\n";
    gn_effects mask = effects_of(parsed(variant("    friction: 0.5\n", bonded)));
    assert_true((mask & GN_FX_BONDS) && (mask & GN_FX_SHEAR) && !(mask & GN_FX_FRICTION));
    gn_override none = {"specimen.group", "0"}, off = {"bonds.enabled", "off"};
    const gn_override *each[] = {&none, &off};
    for (int k = 0; k < 2; k++) {
        gn_scene scene;
        gneiss_error error = {0};
        assert_int_equal(gn_scene_parse(variant("    friction: 0.5\n", bonded), "s", NULL, each[k],
                                        1, &scene, &error),
                         0);
        assert_false(effects_of(scene) & (GN_FX_BONDS | GN_FX_SHEAR));
    }
}

/* ---- the manifest ---- */

typedef void (*key_check)(const gn_key *key, const char *path, void *context);

static size_t each_key(const gn_section *section, const char *above, key_check check,
                       void *context) {
    size_t count = 0;
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char path[256];
        snprintf(path, sizeof path, "%s%s%s", above, *above ? "." : "", key->name);
        check(key, path, context);
        count++;
        if (!key->section) continue;
        if (key->type == GN_KEY_LIST) strcat(path, "[0]");
        count += each_key(key->section, path, check, context);
    }
    return count;
}

static void is_documented(const gn_key *key, const char *path, void *context) {
    (void)context;
    if (!key->text || strlen(key->text) < 8) fail_msg("%s has no text", path);
    bool optional = key->fallback || key->presence != GN_PRESENT_ALWAYS ||
                    key->type == GN_KEY_SECTION || key->type == GN_KEY_LIST;
    if (key->required == optional && key->type != GN_KEY_SECTION && key->type != GN_KEY_LIST)
        fail_msg("%s is neither required nor has a default, or both", path);
    bool numeric =
        key->type == GN_KEY_REAL || key->type == GN_KEY_TABLE || key->type == GN_KEY_VECTOR;
    if (numeric && !key->unit) fail_msg("%s has no unit", path);
    if (key->type == GN_KEY_CHOICE && !key->choices) fail_msg("%s has no choices", path);
}

static void every_key_is_documented(void **state) {
    (void)state;
    assert_true(gn_scene_section.key_count <= GN_SECTION_KEYS_MAX);
    assert_true(each_key(&gn_scene_section, "", is_documented, NULL) > 100);
}

/* Values just outside the interval, as the scene file would have them. */
static int outside(const char *range, bool whole, char values[2][32]) {
    gn_range r = gn_range_read(range);
    int count = 0;
    double step = whole ? 1 : fmax(1e-9, fabs(r.low) * 1e-9);
    if (isfinite(r.low))
        snprintf(values[count++], 32, whole ? "%.0f" : "%.17g", r.low_open ? r.low : r.low - step);
    if (isfinite(r.high))
        snprintf(values[count++], 32, whole ? "%.0f" : "%.17g",
                 r.high_open ? r.high : r.high + step);
    return count;
}

static void refuses_outside_values(const gn_key *key, const char *path, void *context) {
    size_t *checked = context;
    bool whole =
        key->type == GN_KEY_INTEGER || key->type == GN_KEY_CELLS || key->type == GN_KEY_IDS;
    if (!key->range || key->type == GN_KEY_LIST) return;
    char at[256];
    bool servo = strstr(path, ".servo.") != NULL; /* the second wall has one */
    snprintf(at, sizeof at, servo ? "walls[1]%s" : "%s", path + (servo ? 8 : 0));
    char values[2][32], text[128], file[4096];
    bool plane = strncmp(path, "specimen.lattice", 16) == 0;
    snprintf(file, sizeof file, "%s/tests/scenes/%s.yaml", test_source(),
             plane ? "plane" : "everything");
    int count = outside(key->range, whole, values);
    assert_true(count > 0);
    for (int k = 0; k < count; k++) {
        snprintf(text, sizeof text,
                 key->type == GN_KEY_CELLS ? "[%s, %s]"
                 : key->type == GN_KEY_IDS ? "[%s]"
                                           : "%s",
                 values[k], values[k]);
        gn_override overrides[] = {{at, text}};
        gn_scene scene;
        gneiss_error error = {0};
        gneiss_status status = gn_scene_load(file, overrides, 1, &scene, &error);
        if (status == GNEISS_OK) fail_msg("%s = %s was accepted, range %s", path, text, key->range);
        if (!strstr(error.message, key->range)) fail_msg("%s = %s: %s", path, text, error.message);
        (*checked)++;
    }
}

static void every_range_is_checked(void **state) {
    (void)state;
    size_t checked = 0;
    each_key(&gn_scene_section, "", refuses_outside_values, &checked);
    assert_true(checked > 50);
}

static void words_are_accepted_and_written(void **state) {
    (void)state;
    gn_scene s =
        parsed(with("output: {checkpoint: off}\nrun: {threads: auto}\nneighbours: {skin: auto}\n"));
    assert_true(s.checkpoint_wall == 0 && s.threads == 0 && s.skin == 0);
    char *text = gn_scene_write(&s);
    assert_non_null(strstr(text, "checkpoint: off"));
    free(text);
    gn_scene_free(&s);
}

/* ---- the key reference ---- */

static char *key_text(bool markdown, const char *prefix, size_t *count) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    *count = gn_scene_print_keys(out, markdown, prefix);
    fclose(out);
    return text;
}

static void the_key_reference_has_every_key(void **state) {
    (void)state;
    size_t all, some;
    char *text = key_text(false, NULL, &all), *part = key_text(false, "time.s", &some);
    assert_non_null(strstr(text, "materials[].density\n"));
    assert_non_null(strstr(text, "walls[].servo.max_velocity\n"));
    assert_int_equal(some, 6); /* step, safety, stop and its three */
    assert_null(strstr(part, "time.end"));
    assert_true(all > 100);
    free(text);
    free(part);
}

static void docs_keys_md_is_up_to_date(void **state) {
    (void)state;
    size_t count;
    char path[4096], *text = key_text(true, NULL, &count);
    snprintf(path, sizeof path, "%s/docs/keys.md", test_source());
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s is missing: gneiss keys --markdown > docs/keys.md", path);
    char *there = calloc(1, 1 << 20);
    size_t length = fread(there, 1, (1 << 20) - 1, file);
    fclose(file);
    assert_true(length > 0);
    if (strcmp(text, there) != 0) fail_msg("stale: gneiss keys --markdown > docs/keys.md");
    free(there);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rock_scene_reads_as_written),
        cmocka_unit_test(units_turn_into_si),
        cmocka_unit_test(what_is_no_quantity_is_refused),
        cmocka_unit_test(defaults_fill_what_is_left_out),
        cmocka_unit_test(a_normal_becomes_a_unit_vector),
        cmocka_unit_test(a_2d_scene_has_short_vectors),
        cmocka_unit_test(a_table_is_linear_between_and_constant_outside),
        cmocka_unit_test(every_slip_is_told_with_its_place),
        cmocka_unit_test(keys_that_contradict_each_other_are_refused),
        cmocka_unit_test(a_2d_scene_stays_in_its_plane),
        cmocka_unit_test(files_that_are_no_scenes_are_refused),
        cmocka_unit_test(a_file_above_the_limit_is_refused),
        cmocka_unit_test(a_refused_scene_holds_nothing),
        cmocka_unit_test(overrides_reach_keys_lists_and_names),
        cmocka_unit_test(overrides_that_miss_are_told_by_their_key),
        cmocka_unit_test(a_written_scene_comes_back_bit_for_bit),
        cmocka_unit_test(awkward_numbers_come_back_bit_for_bit),
        cmocka_unit_test(effects_are_what_the_scene_calls_for),
        cmocka_unit_test(bonds_need_a_group),
        cmocka_unit_test(every_key_is_documented),
        cmocka_unit_test(every_range_is_checked),
        cmocka_unit_test(words_are_accepted_and_written),
        cmocka_unit_test(the_key_reference_has_every_key),
        cmocka_unit_test(docs_keys_md_is_up_to_date),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
