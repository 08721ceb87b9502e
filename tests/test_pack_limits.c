/* Packings that end early, are interrupted, or cannot be made. */
#include "pack_help.h"

static int setup(void **state) {
    return make_fixture(state, "packing.txt");
}

/* ---- limits ---- */

static gn_pack_result packing_of(const fixture *f, int dimension, const char *specimen) {
    gn_scene s = scene_in(f->dir, dimension, "%s", specimen);
    gn_pack_result r = packed(&s);
    gn_scene_free(&s);
    return r;
}

static size_t searched(const gn_pack_result *r) {
    size_t count = 0;
    while (count < r->trace_count && r->trace[count].stage != GN_PACK_SEPARATE) count++;
    return count;
}

static void a_limit_of_iterations_leaves_a_packing_without_overlaps(void **state) {
    const fixture *f = *state;
    static const int limits[] = {1, 17, 60};
    for (int d = 2; d <= 3; d++)
        for (int k = 0; k < 3; k++) {
            gn_scene s =
                scene_in(f->dir, d, "%s\n  particles: 300\n  packing: {iterations: %d}",
                         d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}", limits[k]);
            for (s.seed = 1; s.seed <= 3; s.seed++) {
                gn_pack_result r = packed(&s);
                assert_int_equal(searched(&r), limits[k]);
                assert_true(r.in_time);
                check_whole(&s, &r);
                gn_pack_result_free(&r);
            }
            gn_scene_free(&s);
        }
}

static void a_limit_of_time_ends_the_search_and_says_so(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 3,
                          "box: {size: [1, 1, 1]}\n  particles: 300\n  packing: "
                          "{time: 1e-9}");
    gn_pack_result r = packed(&s);
    assert_false(r.in_time);
    assert_int_equal(searched(&r), 1);
    check_whole(&s, &r);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
    s = scene_in(f->dir, 3, "box: {size: [1, 1, 1]}\n  particles: 50\n  packing: {time: 1e6}");
    r = packed(&s);
    assert_true(r.in_time);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
}

static void a_residual_that_is_enough_ends_the_search(void **state) {
    const fixture *f = *state;
    static const char box[] = "box: {size: [1, 1, 1]}\n  particles: 300";
    gn_pack_result whole = packing_of(f, 3, box);
    gn_scene s = scene_in(f->dir, 3, "%s\n  packing: {residual: 0.5}", box);
    gn_pack_result r = packed(&s);
    assert_true(r.trace_count < whole.trace_count && r.in_time);
    check_whole(&s, &r);
    gn_pack_result_free(&whole);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
}

typedef struct watcher {
    int calls, limit;
    double fraction;
    gn_pack_stage stage;
} watcher;

static bool watch(void *context, const gn_pack_progress *p) {
    watcher *w = context;
    assert_true(p->fraction >= w->fraction && p->fraction <= 1);
    assert_true(p->stage >= w->stage && p->stage < GN_PACK_STAGES);
    assert_int_equal(p->particles, 300);
    w->fraction = p->fraction;
    w->stage = p->stage;
    return ++w->calls != w->limit;
}

static void progress_goes_through_all_stages_to_the_end(void **state) {
    const fixture *f = *state;
    for (int d = 2; d <= 3; d++) {
        gn_scene s = scene_in(f->dir, d, "%s\n  particles: 300",
                              d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}");
        watcher w = {0};
        gn_pack_result r, unwatched = packed(&s);
        ok(gn_pack_make(&s, watch, &w, &r, error));
        assert_int_equal(w.calls, r.trace_count);
        assert_int_equal(w.stage, GN_PACK_SEPARATE);
        assert_true(same_bits(&r, &unwatched));
        for (size_t k = 0; k < r.trace_count; k++)
            assert_int_equal(r.trace[k].state.iteration, k + 1);
        gn_pack_result_free(&r);
        gn_pack_result_free(&unwatched);
        gn_scene_free(&s);
    }
}

static void a_watch_can_end_the_packing_at_any_iteration(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 2, "disc: {diameter: 1}\n  particles: 300");
    gn_pack_result whole = packed(&s);
    for (int limit = 1; limit <= (int)whole.trace_count; limit += 9) {
        watcher w = {.limit = limit};
        gn_pack_result r;
        fails(gn_pack_make(&s, watch, &w, &r, error), GNEISS_INTERRUPTED, "interrupted");
        assert_int_equal(w.calls, limit);
        assert_null(r.packing.sphere);
        assert_null(r.trace);
    }
    gn_pack_result_free(&whole);
    gn_scene_free(&s);
}

/* ---- requests that cannot be met ---- */

static void refused(const fixture *f, int dimension, const char *specimen, gneiss_status status,
                    const char *file, const char *text) {
    gn_scene s = scene_in(f->dir, dimension, "%s", specimen);
    gn_pack_result r;
    fails(gn_pack_make(&s, NULL, NULL, &r, error), (int)status, text);
    fails(gn_pack_make(&s, NULL, NULL, &r, error), (int)status, file);
    assert_null(r.packing.sphere);
    assert_null(r.trace);
    gn_scene_free(&s);
}

static void more_particles_than_memory_are_refused_with_both_sizes(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 3, "box: {size: [1, 1, 1]}\n  mean_radius: 1e-9");
    gn_pack_result r;
    gneiss_error error = {0};
    double number, need, have;
    assert_int_equal(gn_pack_make(&s, NULL, NULL, &r, &error), GNEISS_ERROR_MEMORY);
    const char *text = strstr(error.message, "specimen: ");
    assert_ptr_equal(strstr(error.message, "scene.yaml"), error.message);
    assert_non_null(text);
    assert_int_equal(sscanf(text,
                            "specimen: %lf particles need about %lf GB to be packed; "
                            "this machine has %lf GB",
                            &number, &need, &have),
                     3);
    double have_now = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 1e9;
    assert_close(have, have_now, 0.01);
    assert_true(number > 1e25 && need > have);
    gn_scene_free(&s);
}

static void a_mean_radius_too_large_for_the_body_is_refused(void **state) {
    refused(*state, 3, "box: {size: [1, 1, 1]}\n  mean_radius: 0.7", GNEISS_ERROR_INPUT,
            "scene.yaml", "the mean radius is too large");
    refused(*state, 2, "disc: {diameter: 1}\n  mean_radius: 3", GNEISS_ERROR_INPUT, "scene.yaml",
            "the mean radius is too large");
}

static void a_mesh_without_inner_nodes_cannot_start_from_them(void **state) {
    for (int d = 2; d <= 3; d++) {
        write_mesh(*state, "coarse.msh", d, 1, 1);
        refused(*state, d, "mesh: coarse.msh\n  packing: {start: nodes}", GNEISS_ERROR_INPUT,
                "coarse.msh", "at least 4 inner nodes to start from, found 0");
    }
}

static void a_mesh_with_fewer_than_four_inner_nodes_is_refused(void **state) {
    write_mesh(*state, "coarse.msh", 3, 1, 2);
    refused(*state, 3, "mesh: coarse.msh\n  packing: {start: nodes}", GNEISS_ERROR_INPUT,
            "coarse.msh", "at least 4 inner nodes to start from, found 1");
}

static void an_open_surface_is_refused(void **state) {
    write_cube(*state, "open.stl", 1, 11);
    refused(*state, 3, "surface: open.stl\n  particles: 100", GNEISS_ERROR_INPUT, "open.stl",
            "expected a closed surface");
}

static void a_polygon_that_crosses_itself_is_refused(void **state) {
    refused(*state, 2, "polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]\n  particles: 100",
            GNEISS_ERROR_INPUT, "scene.yaml", "cross");
}

static void a_mesh_without_elements_of_volume_is_refused(void **state) {
    write_mesh(*state, "flat.msh", 2, 1, 4);
    refused(*state, 3, "mesh: flat.msh\n  particles: 100", GNEISS_ERROR_INPUT, "flat.msh",
            "expected a mesh of tetrahedra, found none");
}

static void a_file_that_is_no_mesh_is_refused(void **state) {
    fclose(open_beside(*state, "empty.stl"));
    fclose(open_beside(*state, "empty.msh"));
    refused(*state, 3, "surface: empty.stl\n  particles: 100", GNEISS_ERROR_INPUT, "empty.stl",
            "expected");
    refused(*state, 3, "mesh: empty.msh\n  particles: 100", GNEISS_ERROR_INPUT, "empty.msh",
            "expected");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_limit_of_iterations_leaves_a_packing_without_overlaps),
        cmocka_unit_test(a_limit_of_time_ends_the_search_and_says_so),
        cmocka_unit_test(a_residual_that_is_enough_ends_the_search),
        cmocka_unit_test(progress_goes_through_all_stages_to_the_end),
        cmocka_unit_test(a_watch_can_end_the_packing_at_any_iteration),
        cmocka_unit_test(more_particles_than_memory_are_refused_with_both_sizes),
        cmocka_unit_test(a_mean_radius_too_large_for_the_body_is_refused),
        cmocka_unit_test(a_mesh_without_inner_nodes_cannot_start_from_them),
        cmocka_unit_test(a_mesh_with_fewer_than_four_inner_nodes_is_refused),
        cmocka_unit_test(an_open_surface_is_refused),
        cmocka_unit_test(a_polygon_that_crosses_itself_is_refused),
        cmocka_unit_test(a_mesh_without_elements_of_volume_is_refused),
        cmocka_unit_test(a_file_that_is_no_mesh_is_refused),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
