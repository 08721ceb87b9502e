/* Porosity, coordination, fabric and sliding contacts of arrangements whose values are known. */
#include "measure/structure.h"
#include "run/quantities.h"
#include "world/structure.h"
#include "world_helpers.h"

typedef struct figures {
    double porosity, coordination, sliding, fabric[9];
    gn_anisotropy anisotropy;
} figures;

static figures figures_of(gn_world *w) {
    figures f;
    measured_step(w);
    f.porosity = gn_structure_porosity(w);
    f.coordination = gn_structure_coordination(w);
    f.sliding = gn_structure_sliding(w);
    gn_structure_fabric(w, f.fabric);
    f.anisotropy = gn_fabric_anisotropy((int)w->ctx.scene.dimension, f.fabric);
    return f;
}

static void assert_isotropic(const figures *f, int dimension) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            assert_near(f->fabric[3 * a + b], a == b && a < dimension ? 1.0 / dimension : 0.0,
                        1e-12);
    assert_near(f->anisotropy.degree, 0.0, 1e-12);
}

#define MATTER                                                                                     \
    "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.3, friction: 0.5}]\n"             \
    "law: {stiffness: hertz}\ntime: {step: 1e-8, end: 1}\n"

/* A periodic lattice of `cells` cells of width `side`, pressed by 1e-6 of the distance. */
static gn_world *lattice(const char *kind, int cells, double side, const char *more) {
    return world_of("dimension: 3\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: [%d, %d, "
                    "%d], spacing: 0.999999}, group: 0}\n" MATTER
                    "periodic: {min: [0, 0, 0], max: [%.17g, %.17g, %.17g]}\n%s",
                    kind, cells, cells, cells, cells * side, cells * side, cells * side, more);
}

static const double shrunk = 0.999999;

static void a_cubic_lattice_has_six_contacts(void **state) {
    (void)state;
    gn_world *w = lattice("cubic", 4, 2e-3 * shrunk, "");
    const figures f = figures_of(w);
    assert_near(f.coordination, 6.0, 0.0);
    assert_near(f.porosity, 1.0 - pi / 6.0 / pow(shrunk, 3.0), 1e-12);
    assert_isotropic(&f, 3);
    assert_near(f.sliding, 0.0, 0.0);
    world_end(w);
}

static void a_face_centred_lattice_has_twelve(void **state) {
    (void)state;
    gn_world *w = lattice("fcc", 3, 2e-3 * sqrt(2.0) * shrunk, "");
    const figures f = figures_of(w);
    assert_near(f.coordination, 12.0, 0.0);
    assert_near(f.porosity, 1.0 - pi / (3.0 * sqrt(2.0)) / pow(shrunk, 3.0), 1e-12);
    assert_isotropic(&f, 3);
    world_end(w);
}

/* A box of whole cells has the porosity of the lattice wherever it lies, though its faces, edges
 * and corners cut particles; also across the sides of the period. */
static void a_box_of_whole_cells_has_the_porosity_of_the_lattice(void **state) {
    (void)state;
    const double side = 2e-3 * shrunk;
    const double from[][3] = {{1, 1, 1}, {0.5, 0.5, 0.5}, {0.7, 1.2, 0.31}, {2.4, -0.3, 1.9}};
    for (int k = 0; k < 4; k++) {
        text t = {0};
        add(&t, "output: {structure: {min: [%.17g, %.17g, %.17g], max: [%.17g, %.17g, %.17g]}}\n",
            from[k][0] * side, from[k][1] * side, from[k][2] * side, (from[k][0] + 2) * side,
            (from[k][1] + 2) * side, (from[k][2] + 2) * side);
        gn_world *w = lattice("cubic", 4, side, t.s);
        const figures f = figures_of(w);
        assert_near(f.porosity, 1.0 - pi / 6.0 / pow(shrunk, 3.0), 1e-4);
        assert_near(f.coordination, 6.0, 0.0);
        assert_isotropic(&f, 3);
        world_end(w);
    }
}

/* Three columns of four particles each in their own directions, far apart; the box has the one
 * along (1, 1, 0). */
static void columns_point_their_way(void **state) {
    (void)state;
    const double turn = 2e-3 * shrunk / sqrt(2.0);
    for (int boxed = 0; boxed < 2; boxed++) {
        text t = {0};
        add(&t, "dimension: 3\nspecimen: {particles: [");
        for (int k = 0; k < 4; k++)
            add(&t, "%s[%.17g, %.17g, 0, 1e-3], [0.1, 0, %.17g, 1e-3], [0.2, %.17g, 0, 1e-3]",
                k ? ", " : "", k * turn, k * turn, k * 2e-3 * shrunk, k * 2e-3 * shrunk);
        add(&t, "], group: 0}\n" MATTER);
        if (boxed)
            add(&t, "output: {structure: {min: [-0.01, -0.01, -0.01], max: [0.02, 0.02, 0.01]}}\n");
        gn_world *w = world_of("%s", t.s);
        const figures f = figures_of(w);
        assert_near(f.coordination, 1.5, 0.0); /* three contacts of four particles */
        if (boxed) {
            assert_near(f.anisotropy.degree, 1.0, 1e-12);
            assert_near(f.anisotropy.direction[0], sqrt(0.5), 1e-12);
            assert_near(f.anisotropy.direction[1], sqrt(0.5), 1e-12);
            assert_near(f.anisotropy.direction[2], 0.0, 1e-12);
            assert_near(f.porosity, 1.0 - 4.0 * sphere_mass(1.0, 1e-3) / (0.03 * 0.03 * 0.02),
                        1e-12);
        } else {
            /* n n: (1/2, 1/2, 0; 1/2 across), (0, 0, 1) and (0, 1, 0), a third each. */
            assert_near(f.fabric[0], 1.0 / 6.0, 1e-12);
            assert_near(f.fabric[4], 0.5, 1e-12);
            assert_near(f.fabric[8], 1.0 / 3.0, 1e-12);
            assert_near(f.fabric[1], 1.0 / 6.0, 1e-12);
            assert_near(f.anisotropy.degree, sqrt(2.0) / 3.0, 1e-12);
        }
        world_end(w);
    }
}

/* Four discs in a square, one of them pulled across its neighbour: one contact of four slides. */
static void discs_in_the_plane(void **state) {
    (void)state;
    for (int pulled = 0; pulled < 2; pulled++) {
        gn_world *w = world_of(
            "dimension: 2\nspecimen: {particles: [[0, 0, 1e-3], [1.9999e-3, 0, 1e-3], [0, "
            "1.9999e-3, 1e-3], [1.9999e-3, 1.9999e-3, 1e-3]], group: 0}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2, friction: "
            "0.3}]\nlaw: {stiffness: uniform}\ntime: {step: 1e-8, end: 1}\nsets:\n"
            "  - {name: a, select: {ids: [0, 1, 2]}, motion: {vx: 0, vy: 0, wz: 0}}\n"
            "  - {name: b, select: {ids: [3]}, motion: {vx: %s, vy: 0, wz: 0}}\n",
            pulled ? "0.016" : "0");
        run_steps(w, 500);
        const figures f = figures_of(w);
        assert_near(f.coordination, 2.0, 0.0);
        /* Sideways it slides on the one below; from the one beside it only moves away. */
        assert_near(f.sliding, pulled ? 0.25 : 0.0, 0.0);
        if (!pulled) assert_isotropic(&f, 2);
        world_end(w);
    }
}

/* Areas of discs and volumes of spheres in boxes against counting points, and exact caps. */
static void parts_of_balls_are_those_of_points(void **state) {
    (void)state;
    enum { POINTS = 400000 };
    const double r = 1.3, at[3] = {0.2, -0.1, 0.4};
    const double low[][3] = {{-9, -9, 0.9}, {-0.4, -0.5, -0.3}, {0.1, -9, 0.2}, {-9, 0.7, -9}};
    const double high[][3] = {{9, 9, 9}, {0.9, 0.3, 1.1}, {9, 0.4, 9}, {0.6, 9, 9}};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 4; k++) {
            double in = 0.0, all = dimension == 3 ? 8.0 * r * r * r : 4.0 * r * r;
            uint64_t stream = 77;
            for (int n = 0; n < POINTS; n++) {
                double x[3] = {0}, d2 = 0.0;
                bool inside = true;
                for (int a = 0; a < dimension; a++) {
                    x[a] = uniform(&stream, -r, r);
                    d2 += x[a] * x[a];
                    inside = inside && low[k][a] <= at[a] + x[a] && at[a] + x[a] <= high[k][a];
                }
                in += inside && d2 < r * r;
            }
            /* Four standard deviations. */
            assert_near(gn_ball_in_box(dimension, at, r, low[k], high[k]), all * in / POINTS,
                        4.0 * all * 0.5 / sqrt(POINTS));
        }
    const double cap = 1.3 - 0.5;
    assert_near(gn_ball_in_box(3, at, r, low[0], high[0]), pi * cap * cap * (r - cap / 3.0), 1e-14);
    assert_near(gn_ball_in_box(3, at, r, (double[3]){-9, -9, -9}, (double[3]){9, 9, 9}),
                4.0 / 3.0 * pi * r * r * r, 1e-14);
    /* A quarter of a sphere, cut by two faces through its centre: slices of discs. */
    assert_near(gn_ball_in_box(3, at, r, (double[3]){0.2, -0.1, -9}, (double[3]){9, 9, 9}),
                pi / 3.0 * r * r * r, 1e-4 * r * r * r);
}

static void boxes_without_particles_and_below_their_min_are_refused(void **state) {
    (void)state;
    static const char scene[] =
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3]], group: 0}\n" MATTER
        "output: {structure: {min: [0, 0, 0], max: [1, 1, 1]}}\n";
    assert_change_refused(scene, "max: [1, 1, 1]", "max: [1, -1, 1]", "output.structure.max");
    assert_change_refused(scene, ", max: [1, 1, 1]", "", "output.structure.max");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cubic_lattice_has_six_contacts),
        cmocka_unit_test(a_face_centred_lattice_has_twelve),
        cmocka_unit_test(a_box_of_whole_cells_has_the_porosity_of_the_lattice),
        cmocka_unit_test(columns_point_their_way),
        cmocka_unit_test(discs_in_the_plane),
        cmocka_unit_test(parts_of_balls_are_those_of_points),
        cmocka_unit_test(boxes_without_particles_and_below_their_min_are_refused),
    };
    return cmocka_run_group_tests_name("structure", tests, NULL, NULL);
}
