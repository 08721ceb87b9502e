/* Packings of every shape: required properties, and requested sizes. */
#include "pack_help.h"

static int setup(void **state) {
    return make_fixture(state, "packing.txt");
}

/* ---- shapes ---- */

/* Contacts at gaps of 1 % with particles and walls. */
static double contacts_with_walls(const gn_scene *scene, const gn_pack_result *r,
                                  const gn_pack_quality *q) {
    gn_pack_shape body;
    size_t walls = 0;
    ok(gn_pack_shape_create(scene, &body, error));
    for (size_t k = 0; k < r->packing.count; k++) {
        const double *x = r->packing.sphere + 4 * k;
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        walls += (size_t)gn_domain_planes(body.domain, x, 1.01 * x[3], plane);
    }
    gn_pack_shape_free(&body);
    return q->coordination_1 + (double)walls / (double)r->packing.count;
}

/* A triangulation of N points of which b are on its hull has 3 N - 3 - b edges. */
static double contacts_over_triangulation(const gn_pack_result *r, const gn_pack_quality *q) {
    double n = (double)r->packing.count, hull = q->wall_contacts * n;
    return 0.5 * q->coordination_1 * n / (3 * n - 3 - hull);
}

/* A few hundred particles, a third of them at walls: far looser than a large body, yet dense. */
static void check_dense(const gn_scene *scene, size_t count) {
    gn_pack_result r = packed(scene);
    gn_pack_quality q = quality_of(scene, &r);
    assert_int_equal(r.packing.count, count);
    assert_true(r.in_time && !r.from_cache && r.trace_count > 20 && r.seconds > 0);
    check_whole(scene, &r);
    assert_true(q.wall_contacts > 0.05);
    if (scene->dimension == 2) {
        if (!(q.porosity > 0.08 && q.porosity < 0.17)) fail_msg("porosity %g", q.porosity);
        double share = contacts_over_triangulation(&r, &q);
        if (!(share >= 0.95)) fail_msg("contacts over those of a triangulation: %g", share);
    } else {
        if (!(q.porosity > 0.26 && q.porosity < 0.42)) fail_msg("porosity %g", q.porosity);
        double contacts = contacts_with_walls(scene, &r, &q);
        if (!(contacts >= 6.5)) fail_msg("contacts with particles and walls: %g", contacts);
    }
    gn_pack_quality_free(&q);
    gn_pack_result_free(&r);
}

static void check_shape(void **state, int dimension, const char *shape, int count) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, dimension, "%s\n  particles: %d", shape, count);
    check_dense(&s, (size_t)count);
    gn_scene_free(&s);
}

static void a_rectangle_is_packed(void **state) {
    check_shape(state, 2, "rectangle: {width: 20 mm, height: 10 mm}\n  origin: [3 mm, -4 mm]", 300);
}

static void a_disc_is_packed(void **state) {
    check_shape(state, 2, "disc: {diameter: 20 mm}\n  origin: [0, 5 mm]", 300);
}

static void a_polygon_with_a_notch_is_packed(void **state) {
    check_shape(state, 2,
                "polygon: [[0, 0], [9 mm, 0], [10 mm, 5 mm], [11 mm, 0], [20 mm, 0], "
                "[20 mm, 12 mm], [0, 12 mm]]",
                400);
}

static void a_polygon_of_either_sense_is_packed(void **state) {
    check_shape(state, 2, "polygon: [[0, 0], [0, 1], [2, 1], [2, 0]]", 200);
}

static void a_box_is_packed(void **state) {
    check_shape(state, 3, "box: {size: [20 mm, 15 mm, 10 mm]}\n  origin: [-1, 2, 5 mm]", 300);
}

static void a_cylinder_is_packed(void **state) {
    check_shape(state, 3, "cylinder: {diameter: 20 mm, height: 30 mm}\n  origin: [0, 0, 1]", 400);
}

static void a_surface_from_an_stl_file_is_packed_to_its_scale(void **state) {
    write_cube(*state, "cube.stl", 10, 12);
    check_shape(state, 3, "surface: cube.stl\n  scale: 1e-3", 300);
}

static void a_mesh_of_triangles_is_packed(void **state) {
    write_mesh(*state, "square.msh", 2, 30, 6);
    check_shape(state, 2, "mesh: square.msh\n  scale: 1e-3", 300);
}

static void a_mesh_of_tetrahedra_is_packed(void **state) {
    write_mesh(*state, "cube.msh", 3, 2, 3);
    check_shape(state, 3, "mesh: cube.msh", 300);
}

static void the_volume_is_that_of_the_body(void **state) {
    const fixture *f = *state;
    write_cube(f, "cube.stl", 10, 12);
    write_mesh(f, "cube.msh", 3, 2, 3);
    const struct {
        int dimension;
        const char *shape;
        double volume;
    } cases[] = {{2, "rectangle: {width: 20 mm, height: 10 mm}", 2e-4},
                 {2, "disc: {diameter: 2}", M_PI},
                 {2, "polygon: [[0, 0], [3, 0], [0, 2]]", 3},
                 {3, "box: {size: [1, 2, 3]}", 6},
                 {3, "cylinder: {diameter: 2, height: 3}", 3 * M_PI},
                 {3, "surface: cube.stl\n  scale: 1e-3", 1e-6},
                 {3, "mesh: cube.msh", 8}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_scene s = scene_in(f->dir, cases[k].dimension,
                              "%s\n  particles: 20\n  packing: {iterations: 1}", cases[k].shape);
        gn_pack_result r = packed(&s);
        assert_close(r.volume, cases[k].volume, 1e-9);
        gn_pack_result_free(&r);
        gn_scene_free(&s);
    }
}

static void four_particles_are_enough(void **state) {
    const fixture *f = *state;
    for (int d = 2; d <= 3; d++) {
        gn_scene s = scene_in(f->dir, d, "%s\n  particles: 4",
                              d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}");
        gn_pack_result r = packed(&s);
        assert_int_equal(r.packing.count, 4);
        check_whole(&s, &r);
        gn_pack_result_free(&r);
        gn_scene_free(&s);
    }
}

/* ---- requested properties ---- */

static gn_pack_quality figures_of(const fixture *f, int dimension, const char *specimen) {
    gn_scene s = scene_in(f->dir, dimension, "%s", specimen);
    gn_pack_result r = packed(&s);
    gn_pack_quality q = quality_of(&s, &r);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
    return q;
}

static void passive_overlaps_have_the_size_asked_for_as_median(void **state) {
    const double size[] = {0.02, 0.04, 0.06};
    for (int d = 2; d <= 3; d++)
        for (int k = 0; k < 3; k++) {
            char text[256];
            snprintf(text, sizeof text,
                     "%s\n  particles: 400\n  packing: {overlap: passive, overlap_size: %g}",
                     d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}", size[k]);
            gn_pack_quality q = figures_of(*state, d, text);
            if (!(fabs(q.overlap_median / size[k] - 1) <= 0.2))
                fail_msg("%dD: median overlap %g, expected %g", d, q.overlap_median, size[k]);
            assert_true(q.porosity_net > q.porosity);
            gn_pack_quality_free(&q);
        }
}

static void passive_overlaps_make_a_packing_denser(void **state) {
    static const char box[] = "box: {size: [1, 1, 1]}\n  particles: 300";
    static const char passive[] =
        "box: {size: [1, 1, 1]}\n  particles: 300\n  packing: {overlap: passive}";
    gn_pack_quality none = figures_of(*state, 3, box), some = figures_of(*state, 3, passive);
    assert_true(some.porosity < none.porosity - 0.05);
    assert_true(some.overlaps > 1 && none.overlaps == 0);
    gn_pack_quality_free(&none);
    gn_pack_quality_free(&some);
}

static void the_bits_do_not_depend_on_the_number_of_threads(void **state) {
    const fixture *f = *state;
    static const char *const shapes[] = {
        "disc: {diameter: 1}\n  particles: 600", "box: {size: [1, 1, 1]}\n  particles: 600",
        "box: {size: [1, 1, 1]}\n  particles: 600\n  packing: {overlap: passive}"};
    for (int k = 0; k < 3; k++) {
        gn_scene s = scene_in(f->dir, k == 0 ? 2 : 3, "%s", shapes[k]);
        gn_pack_result one = packed(&s);
        s.threads = 2;
        gn_pack_result two = packed(&s);
        assert_true(same_bits(&one, &two));
        assert_int_equal(one.trace_count, two.trace_count);
        gn_pack_result_free(&one);
        gn_pack_result_free(&two);
        gn_scene_free(&s);
    }
}

static void another_seed_gives_another_packing_as_good(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 3, "box: {size: [1, 1, 1]}\n  particles: 300");
    gn_pack_result one = packed(&s), again = packed(&s);
    s.seed++;
    gn_pack_result other = packed(&s);
    assert_true(same_bits(&one, &again));
    assert_false(same_bits(&one, &other));
    gn_pack_quality a = quality_of(&s, &one), b = quality_of(&s, &other);
    assert_true(fabs(a.porosity - b.porosity) < 0.03);
    gn_pack_quality_free(&a);
    gn_pack_quality_free(&b);
    gn_pack_result_free(&one);
    gn_pack_result_free(&again);
    gn_pack_result_free(&other);
    gn_scene_free(&s);
}

static void the_mean_radius_asked_for_comes_out(void **state) {
    static const struct {
        int dimension;
        const char *specimen;
        double radius;
    } cases[] = {
        {2, "rectangle: {width: 20 mm, height: 10 mm}\n  mean_radius: 0.3 mm", 3e-4},
        {2, "disc: {diameter: 2}\n  mean_radius: 0.04\n  packing: {size_ratio: 2}", 0.04},
        {3, "box: {size: [1, 1, 1]}\n  mean_radius: 0.05", 0.05},
        {3, "box: {size: [1, 1, 1]}\n  mean_radius: 0.05\n  packing: {size_ratio: 2}", 0.05},
        {3, "cylinder: {diameter: 23 mm, height: 30 mm}\n  mean_radius: 1.1 mm", 1.1e-3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_pack_quality q = figures_of(*state, cases[k].dimension, cases[k].specimen);
        if (!(fabs(q.radius_mean / cases[k].radius - 1) <= 0.05))
            fail_msg("%s: mean radius %g", cases[k].specimen, q.radius_mean);
        gn_pack_quality_free(&q);
    }
}

/* Mean ratio of radius to requested size, of the particles with y (3D: z) in that range. */
static double mean_size(const gn_scene *s, const gn_pack_result *r, double from, double to,
                        bool relative) {
    gn_pack_shape body;
    double sum = 0;
    int count = 0;
    ok(gn_pack_shape_create(s, &body, error));
    for (size_t k = 0; k < r->packing.count; k++) {
        const double *x = r->packing.sphere + 4 * k;
        double place = x[s->dimension - 1];
        if (place < from || place > to) continue;
        sum += relative ? x[3] / gn_pack_shape_size(&body, x) : x[3];
        count++;
    }
    gn_pack_shape_free(&body);
    assert_true(count > 20);
    return sum / count;
}

static void refinement_towards_a_face_makes_smaller_particles_there(void **state) {
    const fixture *f = *state;
    static const char *const cases[] = {
        "rectangle: {width: 1, height: 1}\n  particles: 700\n  packing: "
        "{refine: [{from: [0, 1], to: [1, 1], size: 0.4, distance: 0.4}]}",
        "box: {size: [1, 1, 1]}\n  particles: 1500\n  packing: "
        "{refine: [{from: [0, 0, 1], to: [1, 1, 1], size: 0.4, distance: 0.4}]}"};
    for (int d = 2; d <= 3; d++) {
        gn_scene s = scene_in(f->dir, d, "%s", cases[d - 2]);
        gn_pack_result r = packed(&s);
        check_whole(&s, &r);
        double near = mean_size(&s, &r, 0.9, 1, false), far = mean_size(&s, &r, 0, 0.6, false);
        assert_true(near / far > 0.3 && near / far < 0.65);
        near = mean_size(&s, &r, 0.9, 1, true), far = mean_size(&s, &r, 0, 0.6, true);
        if (!(fabs(near / far - 1) < 0.25))
            fail_msg("%dD: radii over the size asked for, near over far: %g", d, near / far);
        gn_pack_result_free(&r);
        gn_scene_free(&s);
    }
}

static void refinement_towards_the_boundary_makes_smaller_particles_there(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 2,
                          "disc: {diameter: 2}\n  particles: 600\n  packing: {refine: [{boundary: "
                          "true, size: 0.4, distance: 0.3}]}");
    gn_pack_result r = packed(&s);
    double sum[2] = {0};
    int count[2] = {0};
    for (size_t k = 0; k < r.packing.count; k++) {
        const double *x = r.packing.sphere + 4 * k;
        double away = hypot(x[0], x[1]);
        if (away > 0.7 && away < 0.9) continue;
        sum[away > 0.8] += x[3];
        count[away > 0.8]++;
    }
    double ratio = sum[1] / count[1] / (sum[0] / count[0]);
    assert_true(ratio > 0.35 && ratio < 0.65);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
}

static void a_mesh_gives_its_sizes_to_the_particles(void **state) {
    const fixture *f = *state;
    FILE *out = open_beside(f, "graded.msh");
    enum { COLUMNS = 32 };
    int tag = 0;
    fprintf(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", (COLUMNS + 1) * 21);
    /* Spacings grow upward; the body is a trapezium. */
    double y = 0;
    for (int j = 0; j <= 20; j++) {
        for (int i = 0; i <= COLUMNS; i++)
            fprintf(out, "%d %.17g %.17g 0\n", j * (COLUMNS + 1) + i + 1,
                    (i - COLUMNS / 2) * (0.25 + 0.05 * y), y);
        y += 0.25 + 0.05 * y;
    }
    fprintf(out, "$EndNodes\n$Elements\n%d\n", 2 * COLUMNS * 20);
    for (int j = 0; j < 20; j++)
        for (int i = 0; i < COLUMNS; i++) {
            int a = j * (COLUMNS + 1) + i + 1, b = a + COLUMNS + 1;
            fprintf(out, "%d 2 2 1 1 %d %d %d\n", ++tag, a, a + 1, b + 1);
            fprintf(out, "%d 2 2 1 1 %d %d %d\n", ++tag, a, b + 1, b);
        }
    fprintf(out, "$EndElements\n");
    fclose(out);
    gn_scene s = scene_in(f->dir, 2, "mesh: graded.msh\n  particles: 600");
    gn_pack_result r = packed(&s);
    check_whole(&s, &r);
    /* Sizes 0.25 + 0.05 y: at y = 0.5 and 7 they are as 0.275 to 0.6. */
    double low = mean_size(&s, &r, 0, 1, false), high = mean_size(&s, &r, 6, 8, false);
    assert_close(low / high, 0.275 / 0.6, 0.25);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
}

static void the_nodes_of_a_mesh_give_one_particle_each_that_is_inside(void **state) {
    const fixture *f = *state;
    write_mesh(f, "square.msh", 2, 1, 16);
    write_mesh(f, "cube.msh", 3, 1, 7);
    static const char *const packings[] = {"{start: nodes}", "{start: nodes, jiggle: 0}"};
    for (int d = 2; d <= 3; d++)
        for (int k = 0; k < 2; k++) {
            gn_scene s = scene_in(f->dir, d, "mesh: %s.msh\n  packing: %s",
                                  d == 2 ? "square" : "cube", packings[k]);
            gn_pack_result r = packed(&s);
            assert_int_equal(r.packing.count, d == 2 ? 15 * 15 : 6 * 6 * 6);
            check_whole(&s, &r);
            gn_pack_result_free(&r);
            gn_scene_free(&s);
        }
}

static void the_size_ratio_widens_the_radii(void **state) {
    for (int d = 2; d <= 3; d++) {
        double before = 0;
        static const char *const ratio[] = {"1.2", "4", "20"};
        for (int k = 0; k < 3; k++) {
            char text[256];
            snprintf(text, sizeof text, "%s\n  particles: 400\n  packing: {size_ratio: %s}",
                     d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}", ratio[k]);
            gn_pack_quality q = figures_of(*state, d, text);
            assert_true(q.radius_ratio_98 > 1.2 * before);
            before = q.radius_ratio_98;
            gn_pack_quality_free(&q);
        }
    }
}

static void the_size_variation_widens_the_radii(void **state) {
    static const char *const packings[] = {"{size_variation: 0.05, size_ratio: 10}",
                                           "{size_variation: 0.6, size_ratio: 10}"};
    for (int d = 2; d <= 3; d++) {
        double variation[2];
        for (int k = 0; k < 2; k++) {
            char text[256];
            snprintf(text, sizeof text, "%s\n  particles: 400\n  packing: %s",
                     d == 2 ? "disc: {diameter: 1}" : "box: {size: [1, 1, 1]}", packings[k]);
            gn_pack_quality q = figures_of(*state, d, text);
            variation[k] = q.radius_variation;
            gn_pack_quality_free(&q);
        }
        assert_true(variation[1] > 1.5 * variation[0]);
    }
}

static void particles_are_in_an_order_of_neighbours(void **state) {
    const fixture *f = *state;
    gn_scene s = scene_in(f->dir, 3, "box: {size: [1, 1, 1]}\n  particles: 500");
    gn_pack_result r = packed(&s);
    double sum = 0;
    for (size_t k = 1; k < r.packing.count; k++) {
        const double *a = r.packing.sphere + 4 * k, *b = a - 4;
        sum += sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
    }
    /* Two random points of a unit cube are 0.66 apart on the average. */
    assert_true(sum / (double)r.packing.count < 0.3);
    gn_pack_result_free(&r);
    gn_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rectangle_is_packed),
        cmocka_unit_test(a_disc_is_packed),
        cmocka_unit_test(a_polygon_with_a_notch_is_packed),
        cmocka_unit_test(a_polygon_of_either_sense_is_packed),
        cmocka_unit_test(a_box_is_packed),
        cmocka_unit_test(a_cylinder_is_packed),
        cmocka_unit_test(a_surface_from_an_stl_file_is_packed_to_its_scale),
        cmocka_unit_test(a_mesh_of_triangles_is_packed),
        cmocka_unit_test(a_mesh_of_tetrahedra_is_packed),
        cmocka_unit_test(the_volume_is_that_of_the_body),
        cmocka_unit_test(four_particles_are_enough),
        cmocka_unit_test(passive_overlaps_have_the_size_asked_for_as_median),
        cmocka_unit_test(passive_overlaps_make_a_packing_denser),
        cmocka_unit_test(the_bits_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(another_seed_gives_another_packing_as_good),
        cmocka_unit_test(the_mean_radius_asked_for_comes_out),
        cmocka_unit_test(refinement_towards_a_face_makes_smaller_particles_there),
        cmocka_unit_test(refinement_towards_the_boundary_makes_smaller_particles_there),
        cmocka_unit_test(a_mesh_gives_its_sizes_to_the_particles),
        cmocka_unit_test(the_nodes_of_a_mesh_give_one_particle_each_that_is_inside),
        cmocka_unit_test(the_size_ratio_widens_the_radii),
        cmocka_unit_test(the_size_variation_widens_the_radii),
        cmocka_unit_test(particles_are_in_an_order_of_neighbours),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
