/* Meshes with duplicate, overlapping or separate elements. */
#include "mesh_files.h"

#include "fem/structured.h"
#include "mesh/joints.h"

#include <math.h>
#include <stdlib.h>

static const double none[3] = {0.0, 0.0, 0.0};

static int set_up(void **state) {
    return make_fixture(state, "m.msh");
}

/* A mesh of format 2.2 from its two sections. */
static gneiss_status read_mesh(const fixture *f, const char *nodes, const char *elements,
                               gn_mesh *mesh, gneiss_error *error) {
    char text[1 << 14];
    snprintf(text, sizeof text,
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%s$EndNodes\n$Elements\n%s"
             "$EndElements\n",
             nodes, elements);
    spill_text(f, text);
    return gn_mesh_read_msh(f->path, 1.0, mesh, error);
}

static gn_mesh mesh_of(const fixture *f, const char *nodes, const char *elements) {
    gneiss_error error = {0};
    gn_mesh mesh;
    gneiss_status status = read_mesh(f, nodes, elements, &mesh, &error);
    if (status != GNEISS_OK) fail_msg("%s", error.message);
    return mesh;
}

static gn_mesh_joints joints_of(gn_mesh mesh, int dimension) {
    gneiss_error error = {0};
    gn_mesh_joints joints;
    if (gn_mesh_check_joints(&mesh, dimension, none, "m", &joints, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    gn_mesh_free(&mesh);
    return joints;
}

static void refused(gn_mesh mesh, int dimension, const char *wanted) {
    gneiss_error error = {0};
    gn_mesh_joints joints;
    assert_int_equal(gn_mesh_check_joints(&mesh, dimension, none, "m", &joints, &error),
                     GNEISS_ERROR_INPUT);
    if (!strstr(error.message, wanted)) fail_msg("expected '%s' in: %s", wanted, error.message);
    gn_mesh_free(&mesh);
}

static bool is_in(const gn_mesh_elements *e, size_t element, int32_t group) {
    bool in = e->group[element] == group;
    for (size_t k = 0; k < e->also_count; k++)
        in = in || (e->also[k].element == element && e->also[k].group == group);
    return in;
}

/* ---- named again ---- */

static const char square[] = "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n";

static void elements_named_again_for_another_group_count_once(void **state) {
    gn_mesh m = mesh_of(*state, square,
                        "5\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 5 1 2 3 1\n4 2 2 7 1 1 3 2\n"
                        "5 2 2 7 1 4 1 3\n");
    assert_int_equal(m.triangles.count, 2);
    assert_int_equal(m.triangles.also_count, 3);
    assert_true(is_in(&m.triangles, 0, 1) && is_in(&m.triangles, 0, 5) &&
                is_in(&m.triangles, 0, 7));
    assert_true(is_in(&m.triangles, 1, 1) && is_in(&m.triangles, 1, 7));
    assert_false(is_in(&m.triangles, 1, 5));
    for (size_t k = 1; k < m.triangles.also_count; k++)
        assert_true(m.triangles.also[k - 1].element <= m.triangles.also[k].element);
    assert_int_equal(joints_of(m, 2).parts, 1);
}

/* A load in a box, or on a group, is assigned by the facets that the mesh lists. */
static void facets_that_are_listed_twice_count_once(void **state) {
    gn_mesh m = mesh_of(*state, square,
                        "6\n1 1 2 3 1 1 2\n2 1 2 4 1 3 2\n3 1 2 3 1 2 1\n4 1 2 4 1 1 2\n"
                        "5 2 2 1 1 1 2 3\n6 2 2 1 1 1 3 4\n");
    assert_int_equal(m.lines.count, 2);
    assert_true(is_in(&m.lines, 0, 3) && is_in(&m.lines, 0, 4) && is_in(&m.lines, 1, 4));
    assert_false(is_in(&m.lines, 1, 3));
    gn_mesh_free(&m);
}

static const char unit[] = "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";

static void repeated_elements_are_refused(void **state) {
    refused(mesh_of(*state, square, "3\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 1 1 3 1 2\n"), 2,
            "found 1 of 3 that have the nodes of another one");
    refused(mesh_of(*state, square, "3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 1 2 3\n"), 2,
            "triangle number 3, the same as number 1, at (0.666667, 0.333333, 0) m");
    refused(mesh_of(*state, unit, "3\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 1 2 3 4\n3 4 2 1 1 1 2 3 4\n"),
            3, "found 2 of 3");
}

/* ---- over each other ---- */

static void elements_on_one_side_of_a_face_are_refused(void **state) {
    refused(mesh_of(*state, "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.2 0.3 0\n",
                    "2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 2 4\n"),
            2, "found 1 with two elements on the same side");
}

static const char inclusion[] = "7\n1 0 0 0\n2 4 0 0\n3 4 4 0\n4 0 4 0\n"
                                "5 2.1 0.4 0\n6 2.6 0.4 0\n7 2.3 0.9 0\n";

static void an_inclusion_that_was_not_cut_out_is_refused(void **state) {
    refused(mesh_of(*state, inclusion, "3\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 2 1 5 6 7\n"), 2,
            "found 1 of 3 that others lie over");
    refused(mesh_of(*state,
                    "8\n1 0 0 0\n2 4 0 0\n3 0 4 0\n4 0 0 4\n"
                    "5 0.5 0.5 0.5\n6 1 0.5 0.5\n7 0.5 1 0.5\n8 0.5 0.5 1\n",
                    "2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 5 6 7 8\n"),
            3, "the first is number 1, which number 2 goes into at");
}

static void parts_that_are_pushed_into_each_other_are_refused(void **state) {
    refused(mesh_of(*state, "6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.4 0.4 0\n5 2 0.4 0\n6 2 2 0\n",
                    "2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 4 5 6\n"),
            2, "found 2 of 2 that others lie over");
}

/* ---- not joined ---- */

static const char two_squares[] = "8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
                                  "5 1 0 0\n6 2 0 0\n7 2 1 0\n8 1 1 0\n",
                  two_parts[] =
                      "4\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 1 1 5 6 7\n4 2 2 1 1 5 7 8\n";

static void parts_with_nodes_at_one_place_are_refused(void **state) {
    refused(mesh_of(*state, two_squares, two_parts), 2,
            "found 2 parts with two nodes at one place in 2 places");
    /* Coordinates in a text file may be rounded. */
    refused(mesh_of(*state,
                    "8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1.0000003 0 0\n6 2 0 0\n7 2 1 0\n"
                    "8 0.9999998 1 0\n",
                    two_parts),
            2, "at one place in 2 places");
    refused(mesh_of(*state,
                    "8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 0\n6 0 1 0\n7 1 0 0\n8 0 0 -1\n",
                    "2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 5 6 7 8\n"),
            3, "at one place in 3 places");
}

static void parts_with_hanging_nodes_are_refused(void **state) {
    refused(mesh_of(*state, "7\n1 0 0 0\n2 1 0 0\n3 1 3 0\n4 0 3 0\n5 1 1 0\n6 2 1 0\n7 1 2 0\n",
                    "3\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 1 1 5 6 7\n"),
            2, "found 2 parts with 2 hanging nodes");
    refused(mesh_of(*state,
                    "8\n1 0 0 0\n2 4 0 0\n3 0 4 0\n4 0 0 4\n5 1 1 0\n6 1.5 1 0\n7 1 1.5 0\n8 1 1 "
                    "-1\n",
                    "2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 5 6 7 8\n"),
            3, "found 2 parts with 3 hanging nodes");
}

static void separate_blocks_are_counted_and_nothing_else(void **state) {
    gn_mesh_joints j = joints_of(
        mesh_of(*state, "7\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1.01 0 0\n6 2 0 0\n7 2 1 0\n",
                "3\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 1 1 5 6 7\n"),
        2);
    assert_int_equal(j.parts, 2);
    assert_int_equal(j.least, 1);
    assert_int_equal(j.elements, 3);
    assert_float_equal(j.least_at[0], 1.01, 0.0);
    assert_int_equal(j.together + j.hanging, 0);
}

/* Two squares of triangles, one above the other; the middle node exists twice, and both sides share
 * the outer ones: a crack of zero width that ends inside the body. */
static void a_crack_of_no_width_is_counted(void **state) {
    gn_mesh_joints j = joints_of(
        mesh_of(*state,
                "8\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 2 1 0\n6 1 -1 0\n7 1 0 0\n8 1 1 0\n",
                "5\n1 2 2 1 1 1 6 2\n2 2 2 1 1 2 6 3\n3 2 2 1 1 1 7 4\n4 2 2 1 1 7 3 5\n"
                "5 2 2 1 1 7 5 4\n"),
        2);
    assert_int_equal(j.parts, 1);
    assert_int_equal(j.together, 1);
    assert_float_equal(j.together_at[0], 1.0, 0.0);
    assert_int_equal(j.hanging, 0);
}

/* A side of the lower triangle contains the middle node of the two above, without having it as a
 * corner. */
static void a_hanging_node_is_counted(void **state) {
    gn_mesh_joints j =
        joints_of(mesh_of(*state, "5\n1 0 0 0\n2 2 0 0\n3 1 -1 0\n4 1 0 0\n5 1 1 0\n",
                          "3\n1 2 2 1 1 1 3 2\n2 2 2 1 1 1 4 5\n3 2 2 1 1 4 2 5\n"),
                  2);
    assert_int_equal(j.parts, 1);
    assert_int_equal(j.together, 0);
    assert_int_equal(j.hanging, 1);
    assert_float_equal(j.hanging_at[0], 1.0, 0.0);
}

/* ---- sound meshes ---- */

static void sound_meshes_are_taken(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int parallel = 0; parallel < 2; parallel++) {
            gneiss_error error = {0};
            gn_mesh mesh;
            gn_structured spec = {.lower = {4e5, -3.0, 0.1},
                                  .size = {1.0, 20.0, 0.3},
                                  .cells = {7, 30, 5},
                                  .distortion = 0.15,
                                  .seed = 5,
                                  .parallel = parallel};
            assert_int_equal(dimension == 3 ? gn_mesh_box(&spec, &mesh, &error)
                                            : gn_mesh_rectangle(&spec, &mesh, &error),
                             GNEISS_OK);
            /* Elements that are turned inside out get the right orientation later. */
            gn_mesh_elements *e = dimension == 3 ? &mesh.tetrahedra : &mesh.triangles;
            for (size_t k = 0; k < e->count; k += 3) {
                int32_t *node = e->node + (size_t)e->nodes * k, swap = node[0];
                node[0] = node[1];
                node[1] = swap;
            }
            gn_mesh_joints j = joints_of(mesh, dimension);
            assert_int_equal(j.parts, 1);
            assert_int_equal(j.together + j.hanging, 0);
        }
}

/* A beam with a notch is graded: its cells differ in size by orders of magnitude. */
static void a_graded_mesh_is_taken(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_mesh mesh;
    gn_structured_beam spec = {.length = 0.5,
                               .height = 0.1,
                               .thickness = 0.1,
                               .span = 0.4,
                               .notch_width = 1e-4,
                               .notch_depth = 0.05,
                               .cell = 0.03,
                               .notch_cells = 2,
                               .growth = 1.6};
    assert_int_equal(gn_mesh_beam(&spec, &mesh, &error), GNEISS_OK);
    gn_mesh_joints j = joints_of(mesh, 3);
    assert_int_equal(j.parts, 1);
    assert_int_equal(j.together + j.hanging, 0);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, set_up, teardown)
    const struct CMUnitTest tests[] = {
        WITH(elements_named_again_for_another_group_count_once),
        WITH(facets_that_are_listed_twice_count_once),
        WITH(repeated_elements_are_refused),
        WITH(elements_on_one_side_of_a_face_are_refused),
        WITH(an_inclusion_that_was_not_cut_out_is_refused),
        WITH(parts_that_are_pushed_into_each_other_are_refused),
        WITH(parts_with_nodes_at_one_place_are_refused),
        WITH(parts_with_hanging_nodes_are_refused),
        WITH(separate_blocks_are_counted_and_nothing_else),
        WITH(a_crack_of_no_width_is_counted),
        WITH(a_hanging_node_is_counted),
        cmocka_unit_test(sound_meshes_are_taken),
        cmocka_unit_test(a_graded_mesh_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
