/* Packed specimens: shapes, numbers and sizes of particles, and scenes read for their specimen
 * only. */
#include "scene_text.h"

#include <unistd.h>

/* The rest of a scene after its specimen; a shape is in line 3, its keys in the lines below. */
static const char rest[] = "materials:\n"
                           "  - {name: rock, density: 1, normal_stiffness: 1, kratio: 0}\n"
                           "law: {stiffness: uniform}\n"
                           "time: {end: 1}\n";

static const char *scene_of(int dimension, const char *specimen) {
    static char text[8192];
    snprintf(text, sizeof text, "dimension: %d\nspecimen:\n%s\n%s", dimension, specimen, rest);
    return text;
}

static gn_scene body(int dimension, const char *specimen) {
    gn_scene scene;
    gneiss_error error = {0};
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/tests", test_source());
    if (gn_scene_parse(scene_of(dimension, specimen), "s.yaml", folder, NULL, 0, &scene, &error))
        fail_msg("refused: %s", error.message);
    return scene;
}

static void refused(int dimension, const char *specimen, const char *message) {
    gn_scene scene;
    gneiss_error error = {0};
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/tests", test_source());
    gneiss_status status =
        gn_scene_parse(scene_of(dimension, specimen), "s.yaml", folder, NULL, 0, &scene, &error);
    if (status == GNEISS_OK) gn_scene_free(&scene);
    assert_string_equal(error.message, message);
    assert_int_equal(status, GNEISS_ERROR_INPUT);
}

/* ---- shapes ---- */

static void a_rectangle_has_width_and_height(void **state) {
    (void)state;
    gn_scene s = body(2, "  rectangle: {width: 20 mm, height: 5 cm}\n  particles: 100");
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_RECTANGLE);
    assert_true(s.specimen.pack.size[0] == 0.02 && s.specimen.pack.size[1] == 0.05);
    gn_scene_free(&s);
}

static void a_disc_has_a_diameter(void **state) {
    (void)state;
    gn_scene s = body(2, "  disc: {diameter: 20 mm}\n  particles: 100");
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_DISC);
    assert_true(s.specimen.pack.diameter == 0.02);
    gn_scene_free(&s);
}

static void a_polygon_has_corners(void **state) {
    (void)state;
    gn_scene s = body(2, "  polygon: [[0, 0], [1 mm, 0], [0, -2 mm]]\n  particles: 100");
    const double corners[] = {0, 0, 0.001, 0, 0, -0.002};
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_POLYGON);
    assert_int_equal(s.specimen.pack.corner_count, 3);
    for (int k = 0; k < 6; k++) assert_true(s.specimen.pack.corners[k] == corners[k]);
    gn_scene_free(&s);
}

static void a_box_has_three_sides(void **state) {
    (void)state;
    gn_scene s = body(3, "  box: {size: [1 mm, 2, 3]}\n  particles: 100");
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_BOX);
    const double *size = s.specimen.pack.size;
    assert_true(size[0] == 0.001 && size[1] == 2 && size[2] == 3);
    gn_scene_free(&s);
}

static void a_cylinder_has_diameter_and_height(void **state) {
    (void)state;
    gn_scene s = body(3, "  cylinder: {diameter: 23 mm, height: 46 mm}\n  particles: 100");
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_CYLINDER);
    assert_true(s.specimen.pack.diameter == 0.023 && s.specimen.pack.height == 0.046);
    gn_scene_free(&s);
}

static void a_surface_is_a_file_beside_the_scene(void **state) {
    (void)state;
    gn_scene s = body(3, "  surface: test.h\n  scale: 1e-3\n  particles: 100");
    char path[4096];
    assert_non_null(realpath(test_source(), path));
    strcat(path, "/tests/test.h");
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_SURFACE);
    assert_string_equal(s.specimen.pack.surface, "test.h");
    assert_string_equal(s.specimen.pack.surface_path, path);
    assert_true(s.specimen.scale == 0.001);
    gn_scene_free(&s);
}

static void a_mesh_is_a_shape_of_both_dimensions(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_scene s = body(dimension, "  mesh: test.h\n  particles: 100");
        assert_int_equal(s.specimen.pack.shape, GN_SHAPE_MESH);
        assert_string_equal(s.specimen.pack.mesh, "test.h");
        assert_int_equal(access(s.specimen.pack.mesh_path, R_OK), 0);
        gn_scene_free(&s);
    }
}

static void a_shape_stands_at_its_origin(void **state) {
    (void)state;
    static const char cylinder[] = "  cylinder: {diameter: 1, height: 1}\n  particles: 100";
    gn_scene s = body(3, cylinder);
    for (int k = 0; k < 3; k++) assert_true(s.specimen.pack.origin[k] == 0);
    gn_scene_free(&s);
    s = body(3, "  cylinder: {diameter: 1, height: 1}\n  particles: 9\n  origin: [1 mm, 2, 3]");
    const double *origin = s.specimen.pack.origin;
    assert_true(origin[0] == 0.001 && origin[1] == 2 && origin[2] == 3);
    gn_scene_free(&s);
}

/* ---- how many, and how ---- */

static void particles_are_rows_or_their_number(void **state) {
    (void)state;
    gn_scene s = body(3, "  box: {size: [1, 1, 1]}\n  particles: 4");
    assert_true(s.specimen.pack.count == 4 && s.specimen.particle_count == 0);
    assert_null(s.specimen.particles);
    gn_scene_free(&s);
    s = body(3, "  particles: [[0, 0, 0, 1]]");
    assert_true(s.specimen.pack.count == 0 && s.specimen.particle_count == 1);
    gn_scene_free(&s);
}

static void a_mean_radius_stands_instead_of_a_number(void **state) {
    (void)state;
    gn_scene s = body(3, "  box: {size: [1, 1, 1]}\n  mean_radius: 2 mm");
    assert_true(s.specimen.pack.count == 0 && s.specimen.pack.mean_radius == 0.002);
    gn_scene_free(&s);
}

static void mesh_nodes_need_no_number(void **state) {
    (void)state;
    gn_scene s = body(3, "  mesh: test.h\n  packing: {start: nodes}");
    assert_int_equal(s.specimen.pack.start, GN_START_NODES);
    assert_true(s.specimen.pack.count == 0 && s.specimen.pack.mean_radius == 0);
    gn_scene_free(&s);
}

static void packing_has_defaults(void **state) {
    (void)state;
    static const char *const specimens[] = {
        "  box: {size: [1, 1, 1]}\n  particles: 9",
        "  box: {size: [1, 1, 1]}\n  particles: 9\n  packing: {}"};
    for (int k = 0; k < 2; k++) {
        gn_scene s = body(3, specimens[k]);
        const gn_pack_def *pack = &s.specimen.pack;
        assert_true(pack->size_ratio == 6 && pack->size_variation == -1);
        assert_int_equal(pack->overlap, GN_OVERLAP_NONE);
        assert_true(pack->overlap_size == -1 && pack->gap == -1);
        assert_int_equal(pack->start, GN_START_RANDOM);
        assert_true(pack->jiggle == 0.3 && pack->refinement_count == 0);
        assert_true(pack->iterations == 0 && pack->residual == 0 && pack->time_limit == 0);
        gn_scene_free(&s);
    }
}

static void packing_reads_as_written(void **state) {
    (void)state;
    gn_scene s = loaded("tests/scenes/everything.yaml");
    const gn_pack_def *pack = &s.specimen.pack;
    assert_true(pack->count == 10000);
    assert_true(pack->size_ratio == 3 && pack->size_variation == 0.3);
    assert_int_equal(pack->overlap, GN_OVERLAP_PASSIVE);
    assert_true(pack->overlap_size == 0.02 && pack->gap == 0.01 && pack->jiggle == 0.1);
    assert_true(pack->iterations == 50 && pack->residual == 1e-4 && pack->time_limit == 60);
    gn_scene_free(&s);
}

static void a_refinement_is_a_box_or_the_boundary(void **state) {
    (void)state;
    gn_scene s = loaded("tests/scenes/everything.yaml");
    assert_int_equal(s.specimen.pack.refinement_count, 2);
    const gn_refinement *r = s.specimen.pack.refinements;
    assert_true(r[0].has_region && !r[0].boundary && !r[1].has_region && r[1].boundary);
    assert_true(r[0].lower[0] == -0.01 && r[0].lower[2] == 0.023 && r[0].upper[0] == 0.01);
    assert_true(r[0].size == 0.5 && r[0].distance == 0.005);
    assert_true(r[1].size == 0.4 && r[1].distance == 0.002);
    assert_int_equal(r[1].where.line, 19);
    gn_scene_free(&s);
}

/* ---- refusals ---- */

static void a_shape_of_the_other_dimension_is_refused(void **state) {
    (void)state;
    static const char *const space[] = {"box: {size: [1, 1, 1]}",
                                        "cylinder: {diameter: 1, height: 1}", "surface: test.h"};
    static const char *const plane[] = {"rectangle: {width: 1, height: 1}", "disc: {diameter: 1}",
                                        "polygon: [[0, 0], [1, 0], [0, 1]]"};
    char specimen[128], message[256];
    for (int k = 0; k < 6; k++) {
        const char *shape = k < 3 ? space[k] : plane[k - 3];
        snprintf(specimen, sizeof specimen, "  %s\n  particles: 9", shape);
        int length = (int)strcspn(shape, ":");
        snprintf(message, sizeof message,
                 "s.yaml:3:3: specimen.%.*s: expected a shape of a %s, found %.*s", length, shape,
                 k < 3 ? "2D scene: rectangle, disc, polygon, mesh"
                       : "3D scene: box, cylinder, surface, mesh",
                 length, shape);
        refused(k < 3 ? 2 : 3, specimen, message);
    }
}

static void two_sources_of_a_specimen_are_named_in_the_error(void **state) {
    (void)state;
    refused(2, "  disc: {diameter: 1}\n  rectangle: {width: 1, height: 1}\n  particles: 9",
            "s.yaml:2:1: specimen: expected one of file, a list of particles, lattice, rectangle, "
            "disc, polygon, mesh, found rectangle, disc");
    refused(3, "  box: {size: [1, 1, 1]}\n  particles: [[0, 0, 0, 1]]",
            "s.yaml:2:1: specimen: expected one of file, a list of particles, lattice, box, "
            "cylinder, surface, mesh, found a list of particles, box");
}

static void a_number_of_particles_needs_a_shape(void **state) {
    (void)state;
    refused(3, "  particles: 9",
            "s.yaml:2:1: specimen: expected one of file, a list of particles, lattice, box, "
            "cylinder, surface, mesh, found a number of particles only");
    refused(
        3, "  file: test.h\n  particles: 9",
        "s.yaml:4:14: specimen.particles: needs one of box, cylinder, surface, mesh; found file");
}

static void a_number_of_particles_has_limits(void **state) {
    (void)state;
    static const char *const values[] = {"3", "100000001", "4.5", "many", "-9"};
    for (int k = 0; k < 5; k++) {
        char specimen[128], message[256];
        snprintf(specimen, sizeof specimen, "  box: {size: [1, 1, 1]}\n  particles: %s", values[k]);
        snprintf(message, sizeof message,
                 "s.yaml:4:14: specimen.particles: expected a list of particles or a whole number "
                 "in [4, 1e8], found '%s'",
                 values[k]);
        refused(3, specimen, message);
    }
}

static void a_shape_needs_a_number_or_a_mean_radius(void **state) {
    (void)state;
    refused(3, "  box: {size: [1, 1, 1]}",
            "s.yaml:2:1: specimen: expected particles (a number) or mean_radius beside box, found "
            "none");
    refused(3, "  box: {size: [1, 1, 1]}\n  particles: 9\n  mean_radius: 1",
            "s.yaml:5:16: specimen.mean_radius: expected particles or mean_radius, found both");
}

static void mesh_nodes_leave_no_choice_of_number(void **state) {
    (void)state;
    static const char *const keys[] = {"particles: 9", "mean_radius: 1"};
    for (int k = 0; k < 2; k++) {
        char specimen[128], message[256];
        int length = (int)strcspn(keys[k], ":");
        snprintf(specimen, sizeof specimen, "  mesh: test.h\n  packing: {start: nodes}\n  %s",
                 keys[k]);
        snprintf(message, sizeof message,
                 "s.yaml:5:%d: specimen.%.*s: expected to be left out beside packing.start nodes "
                 "(each inner node of the mesh becomes a particle), found it given",
                 length + 5, length, keys[k]);
        refused(3, specimen, message);
    }
}

static void only_a_mesh_has_nodes(void **state) {
    (void)state;
    refused(2, "  disc: {diameter: 1}\n  particles: 9\n  packing: {start: nodes}",
            "s.yaml:5:20: specimen.packing.start: expected mesh beside nodes, found disc");
}

static void shapes_with_coordinates_refuse_an_origin(void **state) {
    (void)state;
    refused(2, "  polygon: [[0, 0], [1, 0], [0, 1]]\n  particles: 9\n  origin: [0, 1]",
            "s.yaml:5:11: specimen.origin: needs rectangle, disc, box or cylinder; found polygon");
    refused(3, "  surface: test.h\n  particles: 9\n  origin: [0, 1, 0]",
            "s.yaml:5:11: specimen.origin: needs rectangle, disc, box or cylinder; found surface");
    refused(3, "  mesh: test.h\n  particles: 9\n  origin: [0, 1, 0]",
            "s.yaml:5:11: specimen.origin: needs rectangle, disc, box or cylinder; found mesh");
}

static void keys_of_packing_are_refused_for_specimens_from_files(void **state) {
    (void)state;
    static const char shapes[] = "needs one of box, cylinder, surface, mesh; found file";
    static const char *const cases[][2] = {
        {"origin: [0, 0, 1]", "s.yaml:4:11: specimen.origin: "},
        {"mean_radius: 1", "s.yaml:4:16: specimen.mean_radius: "},
        {"packing: {gap: 0}", "s.yaml:4:3: specimen.packing: "}};
    for (int k = 0; k < 3; k++) {
        char specimen[128], message[256];
        snprintf(specimen, sizeof specimen, "  file: test.h\n  %s", cases[k][0]);
        snprintf(message, sizeof message, "%s%s", cases[k][1], shapes);
        refused(3, specimen, message);
    }
}

static void a_polygon_of_bad_corners_is_refused(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"[[0, 0], [1, 0]]", "12: specimen.polygon: expected a list of at least 3 points [x, y], "
                             "found a list of 2"},
        {"5", "12: specimen.polygon: expected a list of at least 3 points [x, y], found '5'"},
        {"[[0, 0], [1, 0, 0], [0, 1]]",
         "21: specimen.polygon[1]: expected a point [x, y], found a list"},
        {"[[0, 0], [1, 0], [0, 1 kg]]", "33: specimen.polygon[2]: expected a length such as '23 mm'"
                                        ", found '1 kg' (another dimension)"}};
    for (int k = 0; k < 4; k++) {
        char specimen[128], message[256];
        snprintf(specimen, sizeof specimen, "  polygon: %s\n  particles: 9", cases[k][0]);
        snprintf(message, sizeof message, "s.yaml:3:%s", cases[k][1]);
        refused(2, specimen, message);
    }
}

static void an_overlap_size_needs_passive_overlaps(void **state) {
    (void)state;
    refused(2, "  disc: {diameter: 1}\n  particles: 9\n  packing: {overlap_size: 2 %}",
            "s.yaml:5:27: specimen.packing.overlap_size: needs overlap passive; found none");
}

static void a_refinement_says_where_once(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"from: [0, 0]", "22: specimen.packing.refine[0].to: required beside from, but not given"},
        {"to: [0, 0]", "22: specimen.packing.refine[0].from: required beside to, but not given"},
        {"boundary: false", "33: specimen.packing.refine[0].boundary: expected from and to, or "
                            "boundary: true, found none"},
        {"boundary: true, from: [0, 0], to: [1, 1]",
         "33: specimen.packing.refine[0].boundary: expected from and to, or boundary: true, found "
         "both"},
        {"from: [0, 1], to: [1, 0]", "41: specimen.packing.refine[0].to: expected a corner not "
                                     "below from, found y: 1 to 0"}};
    for (int k = 0; k < 5; k++) {
        char specimen[256], message[256];
        snprintf(specimen, sizeof specimen,
                 "  disc: {diameter: 1}\n  particles: 9\n"
                 "  packing: {refine: [{%s, size: 1, distance: 1}]}",
                 cases[k][0]);
        snprintf(message, sizeof message, "s.yaml:5:%s", cases[k][1]);
        refused(2, specimen, message);
    }
}

static void a_size_ratio_beside_a_sieve_is_refused(void **state) {
    (void)state;
    for (int ratio = 3; ratio <= 6;
         ratio += 3) { /* the key is refused also if the value is the default */
        char specimen[128];
        snprintf(specimen, sizeof specimen,
                 "  disc: {diameter: 1}\n  particles: 9\n"
                 "  packing: {sizes: sieve, sieve: [[0.5, 0], [1, 1]], size_ratio: %d}",
                 ratio);
        refused(2, specimen,
                "s.yaml:5:66: specimen.packing.size_ratio: needs sizes: fitted, uniform or normal; "
                "found sieve, whose first row has the smallest size");
    }
}

/* ---- the specimen only ---- */

enum { MESSAGE_SIZE = sizeof((gneiss_error *)0)->message };

/* The name in messages is that of a temporary file; the text after it is compared. */
static gneiss_status load_specimen(const char *text, const gn_override *override, gn_scene *scene,
                                   char message[MESSAGE_SIZE]) {
    char path[] = "/tmp/gneiss-specimen-XXXXXX";
    gneiss_error error = {0};
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    gneiss_status status = gn_scene_load_specimen(path, override, override ? 1 : 0, scene, &error);
    unlink(path);
    bool named = strncmp(error.message, path, strlen(path)) == 0;
    snprintf(message, MESSAGE_SIZE, "%s", error.message + (named ? strlen(path) : 0));
    return status;
}

static gn_scene specimen_of(const char *text, const gn_override *override) {
    gn_scene scene;
    char message[MESSAGE_SIZE];
    if (load_specimen(text, override, &scene, message)) fail_msg("refused: %s", message);
    return scene;
}

static void refuses_specimen(const char *text, const char *expected) {
    gn_scene scene;
    char message[MESSAGE_SIZE];
    assert_int_equal(load_specimen(text, NULL, &scene, message), GNEISS_ERROR_INPUT);
    assert_string_equal(message, expected);
}

static void a_specimen_alone_is_enough_to_pack(void **state) {
    (void)state;
    gn_scene s = specimen_of("specimen:\n  box: {size: [1, 2, 3]}\n  particles: 50\n", NULL);
    assert_int_equal(s.dimension, 3);
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_BOX);
    assert_true(s.specimen.pack.count == 50 && s.specimen.pack.size_ratio == 6);
    assert_true(s.seed == 1 && s.material_count == 0 && s.wall_count == 0);
    gn_scene_free(&s);
}

static void a_full_scene_gives_its_specimen(void **state) {
    (void)state;
    char path[4096];
    snprintf(path, sizeof path, "%s/tests/scenes/everything.yaml", test_source());
    gn_scene s;
    gneiss_error error = {0};
    if (gn_scene_load_specimen(path, NULL, 0, &s, &error)) fail_msg("%s", error.message);
    assert_int_equal(s.specimen.pack.shape, GN_SHAPE_CYLINDER);
    assert_int_equal(s.specimen.pack.refinement_count, 2);
    assert_true(s.seed == UINT64_MAX && s.threads == 4);
    assert_string_equal(s.output_directory, "out dir");
    gn_scene_free(&s);
}

static const char half_done[] = "title: beam\n"
                                "specimen: {box: {size: [1, 2, 3]}, particles: 9, material: x}\n"
                                "materials: 5\n"
                                "walls: [{nome: a}]\n"
                                "time:\n";

static void other_sections_are_not_looked_at(void **state) {
    (void)state;
    gn_scene s = specimen_of(half_done, NULL);
    assert_string_equal(s.title, "beam");
    assert_string_equal(s.specimen.material, "x");
    gn_scene_free(&s);
}

static void overrides_reach_the_specimen(void **state) {
    (void)state;
    gn_override override = {"specimen.particles", "70"};
    gn_scene s = specimen_of(half_done, &override);
    assert_int_equal(s.specimen.pack.count, 70);
    gn_scene_free(&s);
}

static void unknown_sections_are_refused_all_the_same(void **state) {
    (void)state;
    refuses_specimen("specimen: {box: {size: [1, 2, 3]}, particles: 9}\nwals: []\n",
                     ":2:1: wals: unknown key 'wals'; did you mean 'walls'?");
}

static void sections_that_are_read_are_checked(void **state) {
    (void)state;
    refuses_specimen("specimen: {box: {size: [1, 2, 3]}, particles: 9}\nrun: {threads: -1}\n",
                     ":2:16: run.threads: expected a whole number in [0, 1024] or 'auto', found "
                     "'-1'");
    refuses_specimen("specimen: {box: {size: [1, 2, 3]}}\n",
                     ":1:1: specimen: expected particles (a number) or mean_radius beside box, "
                     "found none");
    refuses_specimen("title: t\n", ":1:1: specimen: required, but not given");
}

static void only_a_shape_can_be_packed(void **state) {
    (void)state;
    refuses_specimen("specimen: {particles: [[0, 0, 0, 1]]}\n",
                     ":1:1: specimen: expected one of box, cylinder, surface, mesh, found a list "
                     "of particles");
    refuses_specimen("dimension: 2\nspecimen: {group: 1}\n",
                     ":2:1: specimen: expected one of rectangle, disc, polygon, mesh, found none");
}

static void a_refused_specimen_holds_nothing(void **state) {
    (void)state;
    gn_scene scene, nothing;
    char message[MESSAGE_SIZE];
    memset(&nothing, 0, sizeof nothing);
    const char *text = "dimension: 2\nspecimen: {polygon: [[0, 0], [1, 0], [0, 1]]}\n";
    assert_int_equal(load_specimen(text, NULL, &scene, message), GNEISS_ERROR_INPUT);
    assert_memory_equal(&scene, &nothing, sizeof scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rectangle_has_width_and_height),
        cmocka_unit_test(a_disc_has_a_diameter),
        cmocka_unit_test(a_polygon_has_corners),
        cmocka_unit_test(a_box_has_three_sides),
        cmocka_unit_test(a_cylinder_has_diameter_and_height),
        cmocka_unit_test(a_surface_is_a_file_beside_the_scene),
        cmocka_unit_test(a_mesh_is_a_shape_of_both_dimensions),
        cmocka_unit_test(a_shape_stands_at_its_origin),
        cmocka_unit_test(particles_are_rows_or_their_number),
        cmocka_unit_test(a_mean_radius_stands_instead_of_a_number),
        cmocka_unit_test(mesh_nodes_need_no_number),
        cmocka_unit_test(packing_has_defaults),
        cmocka_unit_test(packing_reads_as_written),
        cmocka_unit_test(a_refinement_is_a_box_or_the_boundary),
        cmocka_unit_test(a_size_ratio_beside_a_sieve_is_refused),
        cmocka_unit_test(a_shape_of_the_other_dimension_is_refused),
        cmocka_unit_test(two_sources_of_a_specimen_are_named_in_the_error),
        cmocka_unit_test(a_number_of_particles_needs_a_shape),
        cmocka_unit_test(a_number_of_particles_has_limits),
        cmocka_unit_test(a_shape_needs_a_number_or_a_mean_radius),
        cmocka_unit_test(mesh_nodes_leave_no_choice_of_number),
        cmocka_unit_test(only_a_mesh_has_nodes),
        cmocka_unit_test(shapes_with_coordinates_refuse_an_origin),
        cmocka_unit_test(keys_of_packing_are_refused_for_specimens_from_files),
        cmocka_unit_test(a_polygon_of_bad_corners_is_refused),
        cmocka_unit_test(an_overlap_size_needs_passive_overlaps),
        cmocka_unit_test(a_refinement_says_where_once),
        cmocka_unit_test(a_specimen_alone_is_enough_to_pack),
        cmocka_unit_test(a_full_scene_gives_its_specimen),
        cmocka_unit_test(other_sections_are_not_looked_at),
        cmocka_unit_test(overrides_reach_the_specimen),
        cmocka_unit_test(unknown_sections_are_refused_all_the_same),
        cmocka_unit_test(sections_that_are_read_are_checked),
        cmocka_unit_test(only_a_shape_can_be_packed),
        cmocka_unit_test(a_refused_specimen_holds_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
