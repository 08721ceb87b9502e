/* Static solutions of the explicit elements against quadratic elements of another program
 * (validate/references/fem.json, made by validate/fem_references.py). */
#include "test.h"

#include "fem_cases.h"

#include <libfyaml.h>
#include <string.h>

/* A reading of a reference; JSON is YAML. */
static double reference(const char *name, const char *material, const char *reading) {
    char path[4096];
    snprintf(path, sizeof path, "%s/validate/references/fem.json", test_source());
    struct fy_document *document = fy_document_build_from_file(NULL, path);
    if (!document) fail_msg("%s: expected JSON", path);
    const char *const keys[] = {"cases", name, material, "reference", reading, "value"};
    struct fy_node *node = fy_document_root(document);
    for (size_t k = 0; node && k < sizeof keys / sizeof *keys; k++)
        node = fy_node_mapping_lookup_by_string(node, keys[k], strlen(keys[k]));
    if (!node) fail_msg("%s: no %s of %s, %s", path, reading, name, material);
    const double value = strtod(fy_node_get_scalar0(node), NULL);
    fy_document_destroy(document);
    assert_true(isfinite(value) && value != 0.0);
    return value;
}

/* Relative error of a reading at rest. */
static double error_of(const fem_case_spec *spec, const char *reading) {
    fem_case c;
    gneiss_error error = {0};
    if (fem_case_create(spec, &c, &error) != GNEISS_OK) fail_msg("%s", error.message);
    if (fem_case_relax(&c, 1e-5, 1000000, &error) != GNEISS_OK) fail_msg("%s", error.message);
    double found = NAN;
    for (int k = 0; k < c.count; k++)
        if (!strcmp(c.reading[k], reading)) found = c.value[k];
    fem_case_free(&c);
    const double off = found / reference(spec->name, spec->material, reading) - 1.0;
    print_message("# %s, %s, %s form, %d cells%s: %s %.6g, %+.2f %%\n", spec->name, spec->material,
                  spec->form == GN_FEM_PRESSURE ? "mixed" : "plain", spec->cells,
                  spec->slanted ? ", parallel diagonals" : "", reading, found, 100.0 * off);
    return off;
}

/* A conforming displacement method stores too little energy under given forces: the work of the
 * load converges from below. Its error falls as h^2 where the solution is smooth; the corners of
 * the clamped side leave somewhat less. */
static void plain_triangles_converge_to_the_reference_from_below(void **state) {
    (void)state;
    fem_case_spec spec = {"cook", "compressible", GN_FEM_DISPLACEMENT, 8, false, 1};
    double off[3];
    for (int k = 0; k < 3; k++, spec.cells *= 2) off[k] = error_of(&spec, "mean right");
    assert_true(off[0] < off[1] && off[1] < off[2] && off[2] < 0.0);
    assert_true(log2(off[0] / off[1]) > 1.5 && log2(off[1] / off[2]) > 1.5);
}

static void plain_tetrahedra_converge_to_the_reference_from_below(void **state) {
    (void)state;
    fem_case_spec spec = {"block", "compressible", GN_FEM_DISPLACEMENT, 6, false, 1};
    double coarse = error_of(&spec, "mean");
    spec.cells = 12;
    double fine = error_of(&spec, "mean");
    assert_true(coarse < fine && fine < 0.0);
    assert_true(log2(coarse / fine) > 1.5);
}

/* With parallel diagonals triangles of the displacement form have almost no isochoric motions:
 * refinement does not help as long as K/G h^2 is large. */
static void plain_triangles_lock_when_nearly_incompressible(void **state) {
    (void)state;
    fem_case_spec spec = {"cook", "incompressible", GN_FEM_DISPLACEMENT, 8, true, 1};
    double coarse = error_of(&spec, "mean right");
    spec.cells = 16;
    double fine = error_of(&spec, "mean right");
    assert_true(coarse < -0.5 && fine < -0.5);
    assert_true(fine - coarse < 0.02);
}

static void mixed_triangles_converge_when_nearly_incompressible(void **state) {
    (void)state;
    for (int slanted = 0; slanted < 2; slanted++) {
        fem_case_spec spec = {"cook", "incompressible", GN_FEM_PRESSURE, 8, slanted == 1, 1};
        double coarse = fabs(error_of(&spec, "mean right"));
        spec.cells = 16;
        double fine = fabs(error_of(&spec, "mean right"));
        assert_true(log2(coarse / fine) > 1.09); /* limit set by the singular corners */
    }
}

static void mixed_tetrahedra_reach_the_reference_where_plain_ones_lock(void **state) {
    (void)state;
    fem_case_spec spec = {"block", "incompressible", GN_FEM_PRESSURE, 12, false, 1};
    assert_true(fabs(error_of(&spec, "mean")) < 0.02);
    assert_true(fabs(error_of(&spec, "centre")) < 0.02);
    spec.form = GN_FEM_DISPLACEMENT;
    assert_true(error_of(&spec, "mean") < -0.1);
}

static void unknown_cases_are_refused(void **state) {
    (void)state;
    const fem_case_spec wrong[] = {{"cook", "soft", GN_FEM_DISPLACEMENT, 8, false, 1},
                                   {"beam", "compressible", GN_FEM_DISPLACEMENT, 8, false, 1},
                                   {"cook", "compressible", GN_FEM_DISPLACEMENT, 7, false, 1}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        fem_case c;
        gneiss_error error = {0};
        assert_int_equal(fem_case_create(&wrong[k], &c, &error), GNEISS_ERROR_INPUT);
        assert_non_null(strstr(error.message, "expected"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_triangles_converge_to_the_reference_from_below),
        cmocka_unit_test(plain_tetrahedra_converge_to_the_reference_from_below),
        cmocka_unit_test(plain_triangles_lock_when_nearly_incompressible),
        cmocka_unit_test(mixed_triangles_converge_when_nearly_incompressible),
        cmocka_unit_test(mixed_tetrahedra_reach_the_reference_where_plain_ones_lock),
        cmocka_unit_test(unknown_cases_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
