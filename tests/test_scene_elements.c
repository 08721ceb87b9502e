/* The section `elements` of a scene: its keys, refused values and their places. */
#include "scene_text.h"

#include "scene/read.h"

static const char bar[] = "dimension: 2\n"                                              /* line 1 */
                          "elements:\n"                                                 /* 2 */
                          "  rectangle: {size: [4 cm, 1 cm], cells: [8, 2]}\n"          /* 3 */
                          "  materials:\n"                                              /* 4 */
                          "    - {young: 30 GPa, poisson: 0.2, density: 2400 kg/m3}\n"  /* 5 */
                          "  motions:\n"                                                /* 6 */
                          "    - {name: left, group: x_lower, motion: {vx: 0}}\n"       /* 7 */
                          "    - {name: right, group: x_upper, motion: {vx: 1 mm/s}}\n" /* 8 */
                          "  loads:\n"                                                  /* 9 */
                          "    - {group: y_upper, traction: {ty: -1 kPa}}\n"            /* 10 */
                          "test: {kind: tension, axis: x, lower: left, upper: right}\n" /* 11 */
                          "time: {end: 5 ms}\n";                                        /* 12 */

static const char solid[] = "elements:\n" /* 1 */
                            "  beam: {length: 1 m, height: 10 cm, thickness: 5 cm, "
                            "cell: 1 cm, notch_depth: 2 cm, notch_width: 4 mm}\n"        /* 2 */
                            "  materials:\n"                                             /* 3 */
                            "    - {young: 30 GPa, poisson: 0.2, density: 2400 kg/m3}\n" /* 4 */
                            "time: {end: 5 ms}\n";                                       /* 5 */

static const char *changed(const char *text, const char *from, const char *to) {
    static char out[8192];
    const char *at = strstr(text, from);
    if (!at) fail_msg("'%s' is not in the scene", from);
    snprintf(out, sizeof out, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    return out;
}

static void refuses(const char *text, const char *message) {
    gn_scene scene;
    gneiss_error error = {0};
    gneiss_status status = gn_scene_parse(text, "s.yaml", "/nowhere", NULL, 0, &scene, &error);
    if (status != GNEISS_ERROR_INPUT || !strstr(error.message, message))
        fail_msg("status %d, '%s'; expected '%s'", status, error.message, message);
}

static void a_scene_of_elements_alone_is_read(void **state) {
    (void)state;
    gn_scene s = parsed(bar);
    const gn_element_def *e = &s.elements;
    assert_true(s.has_elements && !s.has_specimen && !s.has_law && e->has_rectangle);
    assert_true(e->size[0] == 0.04 && e->size[1] == 0.01 && e->cells[0] == 8 && e->cells[1] == 2);
    assert_int_equal(e->formulation, GN_FORMULATION_DISPLACEMENT);
    assert_true(e->materials[0].young == 30e9 && e->materials[0].group[0] == 0);
    assert_string_equal(e->motions[1].region.group, "x_upper");
    assert_int_equal(e->motions[1].motion.velocity[0].count, 1);
    assert_int_equal(e->motions[1].motion.velocity[1].count, 0);
    assert_true(e->loads[0].has_traction && e->loads[0].traction[1].value[0] == -1000.0);
    assert_int_equal(gn_scene_effects(&s), GN_FX_PAIRS | GN_FX_ENERGY | GN_FX_ELEMENTS);
    gn_scene_free(&s);
}

static void it_comes_back_from_its_echo(void **state) {
    (void)state;
    const char *const texts[] = {bar, solid};
    for (int k = 0; k < 2; k++) {
        gn_scene s = parsed(texts[k]), again;
        gneiss_error error = {0};
        char *echo = gn_scene_write(&s);
        if (gn_scene_parse_saved(echo, "echo", NULL, 0, &again, &error))
            fail_msg("%s in\n%s", error.message, echo);
        char *second = gn_scene_write(&again);
        assert_string_equal(echo, second);
        free(echo);
        free(second);
        gn_scene_free(&s);
        gn_scene_free(&again);
    }
}

static void typing_errors_are_reported_at_their_place(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *message;
    } cases[] = {
        {"  rectangle: {size: [4 cm, 1 cm], cells: [8, 2]}\n", "",
         "s.yaml:2:1: elements: expected one of mesh, rectangle, beam, found none"},
        {"  materials", "  mesh: none.msh\n  materials",
         "s.yaml:4:9: elements.mesh: cannot open 'none.msh'"},
        {"  materials", "  beam: {length: 1, height: 1, cell: 1}\n  materials",
         "s.yaml:2:1: elements: expected one of mesh, rectangle, beam, found several"},
        {"rectangle: {size: [4 cm, 1 cm]", "box: {size: [4 cm, 1 cm]",
         "s.yaml:3:3: elements.box: expected in a 3D scene only, found in a 2D one"},
        {"4 cm", "0", "s.yaml:3:21: elements.rectangle.size: expected lengths in [1e-9, 1e9] m"},
        {"cells: [8", "cells: [0",
         "elements.rectangle.cells[0]: expected a whole number in [1, 1e6]"},
        {"  materials", "  scale: 2\n  materials",
         "s.yaml:4:10: elements.scale: needs a mesh file; found none"},
        {"poisson: 0.2", "poisson: 0.5",
         "s.yaml:5:32: elements.materials[0].poisson: expected a value below 0.5, because an "
         "explicit scheme has no stable step for an incompressible material, found 0.5"},
        {"poisson: 0.2", "poisson: -1", "expected a value in (-1, 0.5]"},
        {"young: 30 GPa, ", "", "s.yaml:5:7: elements.materials[0].young: required, but not given"},
        {"group: x_lower, ", "",
         "s.yaml:7:7: elements.motions[0].group: expected group or box, "
         "found none"},
        {"group: x_lower,", "group: '', box: {min: [0, 0], max: [1, 1]},",
         "elements.motions[0].group: expected a name, or the key left out, found ''"},
        {"poisson: 0.2", "poisson: 0.2, group: ''",
         "elements.materials[0].group: expected a name, or the key left out, found ''"},
        {"group: x_lower,", "group: x_lower, box: {min: [0, 0], max: [1, 1]},",
         "s.yaml:7:27: elements.motions[0].group: expected group or box, found both"},
        {"group: x_lower,", "box: {min: [0, 2], max: [1, 1]},",
         "elements.motions[0].box.max: expected a corner not below min, found y: 2 to 1"},
        {"name: right", "name: left",
         "s.yaml:8:14: elements.motions[1].name: expected a unique name, found 'left' a second "
         "time"},
        {"{vx: 0}", "{vz: 0}",
         "elements.motions[0].motion.vz: expected no motion out of the plane"},
        {"traction: {ty: -1 kPa}", "force: {fz: 1 N}",
         "elements.loads[0].force.fz: expected nothing out of the plane"},
        {"traction: {ty: -1 kPa}", "force: {fy: 1 N}, traction: {ty: 1 Pa}",
         "elements.loads[0].force: expected traction or force, found both"},
        {", traction: {ty: -1 kPa}", "",
         "elements.loads[0].force: expected traction or force, found "
         "none"},
        {"{ty: -1 kPa}", "{}",
         "s.yaml:10:24: elements.loads[0].traction: expected at least one component, found none"},
        {"{ty: -1 kPa}", "{ty: -1 kN}", "elements.loads[0].traction.ty: expected a stress"},
        {"lower: left", "lower: lfet",
         "s.yaml:11:39: test.lower: expected the name of a wall, a body or a set or a motion of "
         "elements, "
         "found 'lfet'"},
        {"{vx: 0}}\n    - {name: right, group: x_upper, motion: {vx: 1 mm/s}}",
         "{vy: 0}}\n    - {name: right, group: x_upper}",
         "s.yaml:11:52: test.upper: expected at least one end with a prescribed velocity along x"},
        {"time:", "walls: [{name: w, point: [0, 0], normal: [1, 0], stiffness: 1}]\ntime:",
         "s.yaml:12:8: walls: needs a specimen; found elements only"},
        {"time:", "law: {stiffness: uniform}\ntime:", "s.yaml:12:1: law: needs a specimen"},
        {"  loads", "  laods",
         "s.yaml:9:3: elements.laods: unknown key 'laods'; did you mean 'loads'?"},
        {"elements:", "elemnts:",
         "s.yaml:2:1: elemnts: unknown key 'elemnts'; did you mean "
         "'elements'?"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        refuses(changed(bar, cases[k].from, cases[k].to), cases[k].message);
}

static void a_beam_must_be_one(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *message;
    } cases[] = {
        {"thickness: 5 cm, ", "", "elements.beam.thickness: required in a 3D scene"},
        {"length: 1 m", "length: 1 m, span: 1.1 m",
         "elements.beam.span: expected at most the length of 1 m, found 1.1 m"},
        {"notch_depth: 2 cm", "notch_depth: 10 cm",
         "elements.beam.notch_depth: expected a depth below the height of 0.1 m, found 0.1 m"},
        {"notch_width: 4 mm", "notch_width: 1 m",
         "elements.beam.notch_width: expected a width below the distance of the supports, 1 m, "
         "found 1 m"},
        {", notch_width: 4 mm", "", "elements.beam.notch_width: required by notch_depth"},
        {"notch_depth: 2 cm, ", "", "elements.beam.notch_width: needs notch_depth"},
        {"cell: 1 cm", "cell: 1 um",
         "elements.beam.cell: expected a size that gives at most 1e8 cells"},
        {"elements:", "dimension: 2\nelements:",
         "elements.beam.thickness: expected none in a 2D scene, which is 1 m thick"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        refuses(changed(solid, cases[k].from, cases[k].to), cases[k].message);
}

static void a_scene_needs_particles_or_elements(void **state) {
    (void)state;
    refuses("time: {end: 1 s}\n", "specimen: required, but not given; expected a specimen, "
                                  "sources, elements or several of them");
    refuses("specimen: {lattice: {kind: fcc, radius: 1, cells: [1, 1, 1]}}\ntime: {end: 1 s}\n",
            "s.yaml:1:1: materials: required, but not given");
    refuses("specimen: {lattice: {kind: fcc, radius: 1, cells: [1, 1, 1]}}\n"
            "materials: [{name: a, density: 1, normal_stiffness: 1, kratio: 1}]\n"
            "time: {end: 1 s}\n",
            "s.yaml:1:1: law: required, but not given");
}

static void overrides_reach_motions_by_name(void **state) {
    (void)state;
    gn_override overrides[] = {{"elements.motions.right.motion.vx", "[[0, 0], [1 ms, 2 mm/s]]"},
                               {"elements.materials[0].young", "10 GPa"}};
    gn_scene s;
    gneiss_error error = {0};
    if (gn_scene_parse(bar, "s", NULL, overrides, 2, &s, &error)) fail_msg("%s", error.message);
    assert_int_equal(s.elements.motions[1].motion.velocity[0].count, 2);
    assert_true(s.elements.materials[0].young == 10e9);
    gn_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_of_elements_alone_is_read),
        cmocka_unit_test(it_comes_back_from_its_echo),
        cmocka_unit_test(typing_errors_are_reported_at_their_place),
        cmocka_unit_test(a_beam_must_be_one),
        cmocka_unit_test(a_scene_needs_particles_or_elements),
        cmocka_unit_test(overrides_reach_motions_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
