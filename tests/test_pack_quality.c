/* The measures of a packing, compared with known packings. */
#include "test.h"

#include "measure/measure.h"

#include "cloud.h"
#include "domain_help.h"
#include "pack/quality.h"

/* ---- helpers ---- */

static gn_pack_quality measured(const double *sphere, size_t count, int dimension,
                                const gn_domain *domain, double volume) {
    gn_packing packing = {.count = count, .sphere = (double *)sphere};
    gn_pack_quality q;
    make_ok(gn_pack_measure(&packing, dimension, domain, volume, 1, &q, &failure));
    return q;
}

static gn_pack_quality measured_cloud(int dimension) {
    return measured(points.row[0], points.count, dimension, NULL, 1000);
}

/* Volume shared by two balls: a cap (segment) of each, cut off by the plane of their common
 * circle. */
static double cap(int dimension, double r, double to_plane) {
    if (dimension == 3) return M_PI * pow(r - to_plane, 2) * (2 * r + to_plane) / 3;
    double half = sqrt(fmax(r * r - to_plane * to_plane, 0));
    return r * r * atan2(half, to_plane) - to_plane * half;
}

static double shared(int dimension, double a, double b, double d) {
    double to_plane = (d * d + a * a - b * b) / (2 * d);
    return cap(dimension, a, to_plane) + cap(dimension, b, d - to_plane);
}

static double ball(int dimension, double r) {
    return dimension == 3 ? 4 * M_PI / 3 * r * r * r : M_PI * r * r;
}

static double lens_of(int dimension, double a, double b, double d) {
    const double row[2][4] = {{0, 0, 0, a}, {d, 0, 0, b}};
    gn_pack_quality q = measured(row[0], 2, dimension, NULL, 1);
    assert_close(q.porosity, 1 - ball(dimension, a) - ball(dimension, b), 1e-13);
    double found = q.porosity_net - q.porosity;
    gn_pack_quality_free(&q);
    return found;
}

/* ---- lattices ---- */

static void inner_particles_of_touching_lattices_have_their_coordination(void **state) {
    (void)state;
    for (int l = 0; l < LATTICES; l++) {
        cloud_lattice(&lattices[l], 2, true);
        gn_pack_quality q = measured_cloud(lattices[l].dimension);
        int *contacts = calloc(points.count, sizeof *contacts), inner = 0;
        for (size_t k = 0; k < q.pair_count; k++)
            for (int side = 0; side < 2; side++) contacts[q.pair[k][side]]++;
        for (size_t k = 0; k < points.count; k++) {
            bool is_inner = true;
            for (int a = 0; a < lattices[l].dimension; a++) {
                double x = points.row[k][a] / 2 / lattices[l].cell[a];
                is_inner = is_inner && x > 0.9 && x < lattices[l].cells - 0.9;
            }
            if (!is_inner) continue;
            assert_int_equal(contacts[k], lattices[l].coordination);
            inner++;
        }
        assert_true(inner > 5);
        free(contacts);
        gn_pack_quality_free(&q);
    }
}

static void coordination_is_twice_the_pairs_over_the_particles(void **state) {
    (void)state;
    cloud_lattice(&lattices[2], 2, true);
    gn_pack_quality q = measured_cloud(3);
    double mean = 2.0 * (double)q.pair_count / (double)points.count;
    assert_close(q.coordination_01, mean, 1e-14);
    assert_close(q.coordination_1, mean, 1e-14);
    assert_close(q.coordination_5, mean, 1e-14);
    gn_pack_quality_free(&q);
}

static void coordination_goes_by_the_gap_over_both_radii(void **state) {
    (void)state;
    /* Pairs of r_i + r_j = 3 with gaps of 0.05 %, 0.5 %, 3 % and 6 %, far from each other. */
    const double gap[4] = {0.0005, 0.005, 0.03, 0.06};
    double row[8][4] = {{0}};
    for (int k = 0; k < 4; k++) {
        row[2 * k][1] = row[2 * k + 1][1] = 10 * k;
        row[2 * k + 1][0] = 3 * (1 + gap[k]);
        row[2 * k][3] = 1, row[2 * k + 1][3] = 2;
    }
    gn_pack_quality q = measured(row[0], 8, 3, NULL, 1000);
    assert_close(q.coordination_01, 2.0 / 8, 1e-14);
    assert_close(q.coordination_1, 4.0 / 8, 1e-14);
    assert_close(q.coordination_5, 6.0 / 8, 1e-14);
    assert_close(q.distance_mean, 1 + (gap[0] + gap[1] + gap[2]) / 3, 1e-12);
    assert_true(q.overlaps == 0 && q.overlap_max == 0);
    assert_true(q.porosity == q.porosity_net);
    gn_pack_quality_free(&q);
}

static void the_fabric_of_a_cubic_lattice_is_isotropic(void **state) {
    (void)state;
    for (int l = 0; l < LATTICES; l++) {
        if (strcmp(lattices[l].name, "hexagonal") == 0)
            continue; /* the patch of a hexagonal lattice is not isotropic */
        int d = lattices[l].dimension;
        cloud_lattice(&lattices[l], 2, true);
        gn_pack_quality q = measured_cloud(d);
        for (int a = 0; a < d; a++)
            for (int b = 0; b < d; b++)
                assert_near(q.fabric[3 * a + b], a == b ? 1.0 / d : 0, 1e-12, "fabric", 3 * a + b);
        assert_near(q.anisotropy, 0, 1e-12, "anisotropy", l);
        gn_pack_quality_free(&q);
    }
}

static void the_fabric_of_a_chain_is_its_direction(void **state) {
    (void)state;
    const double n[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    double row[9][4] = {{0}};
    for (int k = 0; k < 9; k++) {
        for (int a = 0; a < 3; a++) row[k][a] = 2 * k * n[a];
        row[k][3] = 1;
    }
    gn_pack_quality q = measured(row[0], 9, 3, NULL, 1000);
    for (int a = 0; a < 9; a++) assert_near(q.fabric[a], n[a / 3] * n[a % 3], 1e-12, "fabric", a);
    assert_close(q.fabric_max, 1, 1e-12);
    assert_near(q.fabric_min, 0, 1e-12, "smallest eigenvalue", 0);
    assert_close(q.anisotropy, 2, 1e-12);
    assert_close(q.coordination_1, 2.0 * 8 / 9, 1e-14);
    gn_pack_quality_free(&q);
}

/* ---- overlaps ---- */

static void lenses_have_their_closed_form(void **state) {
    (void)state;
    const double radii[][2] = {{0.1, 0.1}, {0.1, 0.03}, {0.02, 0.15}};
    const double depth[] = {1e-3, 0.1, 0.5, 0.9, 0.999}; /* 0: touching, 1: just contained */
    for (int d = 2; d <= 3; d++)
        for (int k = 0; k < 3; k++)
            for (int m = 0; m < 5; m++) {
                double a = radii[k][0], b = radii[k][1];
                double apart = a + b - depth[m] * 2 * fmin(a, b);
                /* Differences of porosities near 1 have an error of 1e-16. */
                assert_near(lens_of(d, a, b, apart), shared(d, a, b, apart), 1e-14, "lens", m);
            }
}

static void a_contained_ball_counts_once(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        const double apart[] = {0, 0.01, 0.05, 0.0699};
        for (int k = 0; k < 4; k++) {
            assert_near(lens_of(d, 0.1, 0.03, apart[k]), ball(d, 0.03), 1e-15, "contained", k);
            assert_near(lens_of(d, 0.03, 0.1, apart[k]), ball(d, 0.03), 1e-15, "contained", k);
        }
        assert_near(lens_of(d, 0.1, 0.1, 0), ball(d, 0.1), 1e-15, "coincident", 0);
    }
}

static void a_ball_that_touches_from_inside_counts_once(void **state) {
    (void)state;
    /* The last bits of the distance on both sides of a - b must not break the closed form. */
    for (int d = 2; d <= 3; d++)
        for (uint64_t k = 0; k < 300; k++) {
            double a = uniform(1, 2 * k, 0.05, 0.2), b = a * uniform(1, 2 * k + 1, 0.05, 0.95);
            double apart = a - b;
            for (int m = 0; m < 4; m++, apart = nextafter(apart, 1))
                assert_near(lens_of(d, a, b, apart), ball(d, b), 1e-9, "touching", (int)k);
        }
}

static void overlaps_have_median_mean_and_largest(void **state) {
    (void)state;
    const double overlap[5] = {0.01, 0.02, 0.03, 0.1, 0};
    double row[10][4] = {{0}};
    for (int k = 0; k < 5; k++) {
        row[2 * k][1] = row[2 * k + 1][1] = 10 * k;
        row[2 * k + 1][0] = 3 * (1 - overlap[k]);
        row[2 * k][3] = 1, row[2 * k + 1][3] = 2;
    }
    /* Without the deepest the median is the second of three; the touching pair is no overlap. */
    gn_pack_quality q = measured(row[0], 6, 3, NULL, 1000);
    assert_close(q.overlap_median, 0.02, 1e-12);
    gn_pack_quality_free(&q);
    q = measured(row[0], 10, 3, NULL, 1000);
    assert_close(q.overlap_mean, 0.04, 1e-12);
    assert_close(q.overlap_max, 0.1, 1e-12);
    assert_close(q.overlaps, 4.0 / 10, 1e-14);
    gn_pack_quality_free(&q);
}

/* ---- radii ---- */

static void radii_have_their_statistics(void **state) {
    (void)state;
    enum { COUNT = 201 };
    double row[COUNT][4] = {{0}}, sum = 0, squares = 0, volumes[2] = {0};
    for (int k = 0; k < COUNT; k++) {
        row[k][0] = 10.0 * k;
        row[k][3] = 1 + ((k * 37) % COUNT) * 0.01; /* 1 to 3 in steps, shuffled */
        sum += row[k][3];
        for (int d = 2; d <= 3; d++) volumes[d - 2] += ball(d, row[k][3]);
    }
    for (int k = 0; k < COUNT; k++) squares += pow(row[k][3] - sum / COUNT, 2);
    for (int d = 2; d <= 3; d++) {
        gn_pack_quality q = measured(row[0], COUNT, d, NULL, 1e5);
        assert_close(q.radius_mean, 2, 1e-12);
        assert_close(q.radius_min, 1, 1e-14);
        assert_close(q.radius_max, 3, 1e-14);
        assert_close(q.radius_ratio, 3, 1e-14);
        assert_close(q.radius_ratio_98, 2.98 / 1.02,
                     1e-12); /* two of 201 values at either end are left out */
        assert_close(q.radius_variation, sqrt(squares / COUNT) / 2, 1e-12);
        assert_close(ball(d, q.radius_volume) * COUNT, volumes[d - 2], 1e-12);
        assert_close(q.porosity, 1 - volumes[d - 2] / 1e5, 1e-12);
        assert_close(q.void_ratio, q.porosity / (1 - q.porosity), 1e-12);
        gn_pack_quality_free(&q);
    }
}

static void the_histogram_of_radii_counts_every_particle_in_its_bin(void **state) {
    (void)state;
    cloud_random(900, 3);
    gn_pack_quality q = measured_cloud(3);
    int64_t count[GN_PACK_RADIUS_BINS] = {0}, sum = 0;
    assert_true(q.radius_edge[0] == q.radius_min);
    assert_close(q.radius_edge[GN_PACK_RADIUS_BINS], q.radius_max, 1e-14);
    double width = (q.radius_max - q.radius_min) / GN_PACK_RADIUS_BINS;
    for (size_t k = 0; k < points.count; k++) {
        int bin = (int)((points.row[k][3] - q.radius_min) / width);
        count[bin < GN_PACK_RADIUS_BINS ? bin : GN_PACK_RADIUS_BINS - 1]++;
    }
    for (int k = 0; k < GN_PACK_RADIUS_BINS; k++) {
        assert_close(q.radius_edge[k + 1] - q.radius_edge[k], width, 1e-9);
        assert_true(llabs(count[k] - q.radius_count[k]) <= 1); /* radii on an edge */
        sum += q.radius_count[k];
    }
    assert_int_equal(sum, points.count);
    gn_pack_quality_free(&q);
}

static void equal_radii_have_a_histogram(void **state) {
    (void)state;
    cloud_lattice(&lattices[0], 2, true);
    gn_pack_quality q = measured_cloud(3);
    int64_t sum = 0;
    for (int k = 0; k < GN_PACK_RADIUS_BINS; k++) sum += q.radius_count[k];
    assert_int_equal(sum, points.count);
    assert_near(q.radius_variation, 0, 1e-14, "variation", 0);
    gn_pack_quality_free(&q);
}

static void the_histograms_of_directions_count_every_contact_both_ways(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        cloud_random(900, d);
        gn_pack_quality q = measured_cloud(d);
        int64_t contacts = 0, angles = 0, polar = 0;
        for (size_t k = 0; k < q.pair_count; k++) contacts += q.gap[k] <= 0.01;
        for (int k = 0; k < GN_PACK_ANGLE_BINS; k++) {
            angles += q.angle_count[k];
            polar += q.polar_count[k];
            int across = (k + GN_PACK_ANGLE_BINS / 2) % GN_PACK_ANGLE_BINS;
            assert_int_equal(q.angle_count[k], q.angle_count[across]);
        }
        assert_true(contacts > 300);
        assert_int_equal(angles, 2 * contacts);
        assert_int_equal(polar, 2 * contacts);
        gn_pack_quality_free(&q);
    }
}

static void a_direction_falls_into_its_bins(void **state) {
    (void)state;
    /* 25 degrees in the plane; |cos| with z of 0.6, the 22nd of 36 steps. */
    double t = 25 * M_PI / 180;
    const double row[2][4] = {{0, 0, 0, 1}, {2 * 0.8 * cos(t), 2 * 0.8 * sin(t), -2 * 0.6, 1}};
    gn_pack_quality q = measured(row[0], 2, 3, NULL, 100);
    for (int k = 0; k < GN_PACK_ANGLE_BINS; k++) {
        assert_int_equal(q.angle_count[k], k == 2 || k == 20);
        assert_int_equal(q.polar_count[k], k == 21 ? 2 : 0);
    }
    gn_pack_quality_free(&q);
}

/* ---- walls ---- */

static gn_domain *box_of(double side) {
    const double zero[3] = {0, 0, 0}, upper[3] = {side, side, side};
    gn_domain *d = NULL;
    make_ok(gn_domain_box(zero, upper, &d, &failure));
    return d;
}

static void a_sphere_has_a_contact_with_every_face_it_touches(void **state) {
    (void)state;
    gn_domain *domain = box_of(10);
    /* A sphere that touches `faces` faces and has further neighbours is held by four contacts. */
    for (int faces = 1; faces <= 3; faces++)
        for (int neighbours = 0; neighbours <= 3; neighbours++) {
            double row[4][4] = {{5, 5, 5, 1}};
            for (int a = 0; a < faces; a++) row[0][2 - a] = 1;
            for (int k = 0; k < neighbours; k++) {
                memcpy(row[1 + k], row[0], sizeof row[0]);
                row[1 + k][k] += 1.5;
                row[1 + k][3] =
                    0.5; /* the sphere touches no wall beside a sphere of radius 1 on it */
            }
            size_t count = 1 + (size_t)neighbours;
            gn_pack_quality q = measured(row[0], count, 3, domain, 1000);
            size_t held = faces + neighbours >= 4;
            assert_close(q.floating, (double)(count - held) / (double)count, 1e-14);
            assert_close(q.wall_contacts, 1.0 / (double)count, 1e-14);
            assert_near(q.wall_gap_rms, 0, 1e-14, "gap", faces);
            assert_near(q.wall_protrusion, 0, 1e-14, "protrusion", faces);
            gn_pack_quality_free(&q);
        }
    gn_domain_free(domain);
}

static void gaps_and_protrusions_at_walls_are_over_the_radius(void **state) {
    (void)state;
    gn_domain *domain = box_of(20);
    /* Gaps of 2 % and 4 %, one of 7 % which is no contact, and a sphere that protrudes by 3 %. */
    const double row[4][4] = {
        {5, 5, 2.04, 2}, {15, 5, 1.04, 1}, {5, 15, 1.07, 1}, {15, 15, 2 * 0.97, 2}};
    gn_pack_quality q = measured(row[0], 4, 3, domain, 8000);
    assert_close(q.wall_contacts, 0.75, 1e-14);
    assert_close(q.wall_gap_rms, sqrt((0.02 * 0.02 + 0.04 * 0.04 + 0.03 * 0.03) / 3), 1e-9);
    assert_close(q.wall_protrusion, 0.03, 1e-9);
    gn_pack_quality_free(&q);
    q = measured(row[0], 4, 3, NULL, 8000);
    assert_true(q.wall_contacts == 0 && q.wall_protrusion == 0);
    gn_pack_quality_free(&q);
    gn_domain_free(domain);
}

static void figures_do_not_depend_on_the_number_of_threads(void **state) {
    (void)state;
    cloud_random(2000, 3);
    gn_packing packing = {.count = points.count, .sphere = points.row[0]};
    gn_pack_quality one, more;
    make_ok(gn_pack_measure(&packing, 3, NULL, 1, 1, &one, &failure));
    make_ok(gn_pack_measure(&packing, 3, NULL, 1, 3, &more, &failure));
#define SAME(name, unit, text) assert_memory_equal(&one.name, &more.name, sizeof one.name);
    GN_PACK_FIGURES(SAME)
#undef SAME
    gn_pack_quality_free(&one);
    gn_pack_quality_free(&more);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inner_particles_of_touching_lattices_have_their_coordination),
        cmocka_unit_test(coordination_is_twice_the_pairs_over_the_particles),
        cmocka_unit_test(coordination_goes_by_the_gap_over_both_radii),
        cmocka_unit_test(the_fabric_of_a_cubic_lattice_is_isotropic),
        cmocka_unit_test(the_fabric_of_a_chain_is_its_direction),
        cmocka_unit_test(lenses_have_their_closed_form),
        cmocka_unit_test(a_contained_ball_counts_once),
        cmocka_unit_test(a_ball_that_touches_from_inside_counts_once),
        cmocka_unit_test(overlaps_have_median_mean_and_largest),
        cmocka_unit_test(radii_have_their_statistics),
        cmocka_unit_test(the_histogram_of_radii_counts_every_particle_in_its_bin),
        cmocka_unit_test(equal_radii_have_a_histogram),
        cmocka_unit_test(the_histograms_of_directions_count_every_contact_both_ways),
        cmocka_unit_test(a_direction_falls_into_its_bins),
        cmocka_unit_test(a_sphere_has_a_contact_with_every_face_it_touches),
        cmocka_unit_test(gaps_and_protrusions_at_walls_are_over_the_radius),
        cmocka_unit_test(figures_do_not_depend_on_the_number_of_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
