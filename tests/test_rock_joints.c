/* Joints in bonded particles: their faces, areas and networks, and contacts across them. */
#include "surface_helpers.h"

#include "run_helpers.h"

#include "particles/joint_faces.h"
#include "particles/joints.h"

/* Spheres of 1 mm in a box of about 12 mm; JOINTS follow. */
static const char *const block =
    "dimension: 3\nspecimen: {lattice: {kind: hcp, radius: 0.001, cells: [6, 7, 7], jitter: "
    "0.05}}\nmaterials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, friction: 0.3, "
    "tensile_strength: 1e9, shear_strength: 1e9}]\nlaw: {stiffness: harmonic}\n"
    "bonds: {interaction_range: 0.1}\ntime: {end: 1}\nrun: {threads: 1, seed: %d}\n"
    "joints:\n- {name: a, normal_stiffness: 1e11, shear_stiffness: 1e11, %s}\n";

#define PLACE "point: [0.006, 0.006, 0.006]"

static double patch_area(const gn_world *w) {
    double sum = 0.0;
    for (size_t k = 0; k < w->dem.joint_faces->patch_count; k++)
        sum += w->dem.joint_faces->patch[k].area;
    return sum;
}

/* The contacts of a patch have its area together. */
static void check_shares(const gn_world *w) {
    const gn_contacts *list = &w->dem.joints.contacts;
    const gn_joint_faces *f = w->dem.joint_faces;
    double *sum = calloc(f->patch_count, sizeof *sum);
    for (size_t c = 0; c < list->soa.count; c++)
        sum[f->face[list->joint[c]].patch] += list->patch[c];
    for (size_t k = 0; k < f->patch_count; k++)
        if (sum[k] > 0.0) assert_close(sum[k], f->patch[k].area, 1e-12);
    free(sum);
}

/* Returns the area of a face in a packed shape, which needs no particles. */
static double area_in(const gn_scene *scene, const double normal[3], double radius) {
    const double middle[3] = {0.01, 0.02, 0.03};
    gn_outline *outline = calloc(1, sizeof *outline);
    gn_joint_faces faces = {0};
    gn_particles none = {0};
    double area;
    gn_outline_find(scene, &none, outline);
    gn_joint_face *face = gn_joint_faces_add(&faces, middle, normal, (int)scene->dimension);
    face->radius = radius;
    assert_int_equal(gn_joint_face_area(&faces, face, outline, &area, NULL), GNEISS_OK);
    gn_free(faces.face);
    free(outline);
    return area;
}

static void areas_are_those_of_sections_of_the_specimen(void **state) {
    (void)state;
    const double endless = GN_JOINT_ENDLESS, c = cos(0.5), s = sin(0.5), t = 0.3, r = 0.005;
    gn_scene *scene = calloc(1, sizeof *scene);
    scene->dimension = 3;
    scene->specimen.pack = (gn_pack_def){.shape = GN_SHAPE_BOX, .size = {0.02, 0.04, 0.06}};
    assert_close(area_in(scene, (double[3]){0, 0, 1}, endless), 0.02 * 0.04, 1e-12);
    assert_close(area_in(scene, (double[3]){s, 0, c}, endless), 0.02 * 0.04 / c, 1e-12);
    assert_close(area_in(scene, (double[3]){c, s, 0}, endless), 0.06 * fmin(0.04 / c, 0.02 / s),
                 1e-12);
    /* A disc inside, and one of which the sides cut a square. */
    assert_close(area_in(scene, (double[3]){s, 0, c}, r), pi * r * r, 1e-12);
    assert_close(area_in(scene, (double[3]){0, 0, 1}, 1.0), 0.02 * 0.04, 1e-12);
    scene->specimen.pack = (gn_pack_def){
        .shape = GN_SHAPE_CYLINDER, .diameter = 0.02, .height = 0.06, .origin = {0.01, 0.02, 0.0}};
    assert_close(area_in(scene, (double[3]){s, 0, c}, endless), pi * 1e-4 / c, 1e-3);
    scene->dimension = 2;
    scene->specimen.pack = (gn_pack_def){.shape = GN_SHAPE_RECTANGLE, .size = {0.02, 0.04}};
    assert_close(area_in(scene, (double[3]){sin(t), cos(t), 0}, endless), 0.02 / cos(t), 1e-12);
    assert_close(area_in(scene, (double[3]){sin(t), cos(t), 0}, r), 2.0 * r, 1e-12);
    free(scene);
}

static void contacts_share_out_the_area_of_the_joint(void **state) {
    (void)state;
    static const char *const cases[] = {
        PLACE ", normal: [0, 0, 2]", PLACE ", dip: 70 deg, dip_direction: 20 deg, radius: 0.004",
        PLACE ", dip: 90 deg, polygon: [[-0.004, -0.005], [0.004, -0.005], [0.0, 0.005]]"};
    const double areas[] = {0.0, pi * 16e-6, 40e-6};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_world *w = world_of(block, 0, cases[k]);
        if (areas[k] > 0.0) assert_close(patch_area(w), areas[k], 1e-9);
        check_shares(w);
        world_end(w);
    }
}

/* A pair is in one list alone, and normals point from the side of the first particle. */
static void contacts_across_a_joint_are_neither_bonds_nor_pairs(void **state) {
    (void)state;
    gn_world *w = world_of(block, 0, PLACE ", dip: 40 deg");
    const gn_joint_face *face = w->dem.joint_faces->face;
    const double *x = w->dem.particles.pos;
    size_t crossing = 0;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &w->dem.list[l].contacts;
        for (size_t c = 0; c < list->soa.count; c++) {
            double side[2];
            for (int e = 0; e < 2; e++) {
                const double *at = x + 4 * (size_t)(e ? list->j : list->i)[c];
                const double d[3] = {at[0] - face->point[0], at[1] - face->point[1],
                                     at[2] - face->point[2]};
                side[e] = gn_dot3(d, face->normal);
            }
            assert_int_equal(side[0] * side[1] < 0.0, l == GN_LIST_JOINTS);
            if (l != GN_LIST_JOINTS) continue;
            crossing++;
            assert_true(list->plane[c + 2 * list->soa.capacity] * (side[1] - side[0]) > 0.0);
        }
    }
    assert_in_range(crossing, 50, 1000);
    world_end(w);
}

/* --- networks --- */

#define NETWORK "dip: 50 deg, dip_direction: 30 deg, radius: 0.0006, network: {intensity: 2000, %s}"

static gn_world *network_of(int seed, const char *more) {
    char joint[400];
    snprintf(joint, sizeof joint, NETWORK, more);
    return world_of(block, seed, joint);
}

static void a_network_has_its_intensity(void **state) {
    (void)state;
    for (int seed = 0; seed < 3; seed++) {
        gn_world *w = network_of(seed, "fisher: 10, radius_max: 0.003");
        /* Within half of the largest disc. */
        assert_near(patch_area(w), 2000.0 * w->ctx.volume, 0.5 * pi * 0.003 * 0.003);
        check_shares(w);
        world_end(w);
    }
}

/* The mean of the cosines of the angles to the mean normal is coth(kappa) - 1/kappa, their variance
 * 1/kappa^2 - 1/sinh^2(kappa). */
static void normals_of_a_network_follow_fisher(void **state) {
    (void)state;
    static const double kappas[] = {2.0, 20.0, 200.0};
    for (int k = 0; k < 3; k++) {
        char more[40];
        snprintf(more, sizeof more, "fisher: %g", kappas[k]);
        gn_world *w = network_of(1, more);
        const gn_joint_faces *f = w->dem.joint_faces;
        const double *mean = w->ctx.scene.joints[0].normal, count = (double)f->count;
        double sum[3] = {0}, kappa = kappas[k];
        for (size_t c = 0; c < f->count; c++)
            for (int a = 0; a < 3; a++) sum[a] += f->face[c].normal[a] / count;
        double along = gn_dot3(sum, mean), wanted = 1.0 / tanh(kappa) - 1.0 / kappa;
        double deviation = sqrt((1.0 / (kappa * kappa) - pow(sinh(kappa), -2.0)) / count);
        assert_true(count > 1000.0);
        assert_near(along, wanted, 4.0 * deviation);
        /* Across the mean the sum is that of independent directions: sin^2 has the mean 2
         * wanted/kappa. */
        assert_true(gn_dot3(sum, sum) - along * along < 16.0 * 2.0 * wanted / kappa / count);
        world_end(w);
    }
}

/* N(> r) ~ r^-D between a and b: the mean of r is D/(D - 1) (a^(1-D) - b^(1-D))/(a^-D - b^-D). */
static void radii_of_a_network_follow_the_power_law(void **state) {
    (void)state;
    gn_world *w = network_of(2, "radius_max: 0.0018, exponent: 2.5");
    const gn_joint_faces *f = w->dem.joint_faces;
    const double a = 0.0006, b = 0.0018, d = 2.5;
    double sum = 0.0, square = 0.0;
    for (size_t c = 0; c < f->count; c++) {
        double r = f->face[c].radius;
        assert_true(r >= a && r <= b);
        sum += r;
        square += r * r;
    }
    const double count = (double)f->count, mean = sum / count;
    const double wanted =
        d / (d - 1.0) * (pow(a, 1.0 - d) - pow(b, 1.0 - d)) / (pow(a, -d) - pow(b, -d));
    /* Discs that do not meet the specimen are left out, which more of the small ones are: those
     * drawn are within a reach of the specimen, and 1 mm of 20 mm is the error. */
    assert_near(mean, wanted, 4.0 * sqrt((square / count - mean * mean) / count) + 0.05 * wanted);
    world_end(w);
}

static void another_seed_draws_another_network(void **state) {
    (void)state;
    gn_world *a = network_of(1, "fisher: 5"), *b = network_of(1, "fisher: 5"),
             *c = network_of(2, "fisher: 5");
    assert_int_equal(a->dem.joint_faces->count, b->dem.joint_faces->count);
    assert_memory_equal(a->dem.joint_faces->face, b->dem.joint_faces->face, sizeof(gn_joint_face));
    assert_true(a->dem.joint_faces->face[0].point[0] != c->dem.joint_faces->face[0].point[0]);
    world_end(a);
    world_end(b);
    world_end(c);
}

/* --- mechanics --- */

/* Two rows of discs on each other, offset by half a disc; the lower one is held, the upper one
 * pushed along and pressed down. */
static const char *const rows =
    "dimension: 2\nspecimen: {particles: [[0, 0, 0.001], [0.002, 0, 0.001], [0.004, 0, 0.001], "
    "[0.006, 0, 0.001], [0.001, 0.0016, 0.001], [0.003, 0.0016, 0.001]]}\n"
    "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, friction: 0.3, "
    "tensile_strength: 1e12, shear_strength: 1e12}]\nlaw: {stiffness: harmonic}\n"
    "bonds: {interaction_range: 0.01}\n"
    "sets: [{name: low, select: {ids: [0, 1, 2, 3]}, motion: {vx: 0, vy: 0, wz: 0}}, {name: up, "
    "select: {ids: [4, 5]}, group: 2, motion: {vx: 1, wz: 0}, force: [0, -100]}]\n"
    "damping: {background: {model: viscous, coefficient: 2e5}}\n"
    "time: {end: 1}\nrun: {threads: 1}\n%s";
static const char *const between =
    "joints:\n- {name: a, point: [0, 0.0008], normal: [0, 1], normal_stiffness: 1e12, "
    "shear_stiffness: 1e12, friction: 0.2}\n";

static double lift(gn_world *w, double path) {
    double most = -1.0;
    while (w->ctx.time < path) {
        run_steps(w, 1);
        const double *x = w->dem.particles.pos + 4 * (size_t)w->dem.index_of_id[4];
        most = fmax(most, x[1] - 0.0016);
    }
    return most;
}

static void particles_slide_along_a_joint_without_riding_over_others(void **state) {
    (void)state;
    gn_world *smooth = world_of(rows, between);
    assert_true(lift(smooth, 1.5e-3) < 1e-6);
    world_end(smooth);
    gn_world *rough = world_of(rows, "");
    assert_true(lift(rough, 1.5e-3) > 2e-4);
    world_end(rough);
}

/* A joint that is far stiffer than the bonds sets the step, and the ledger closes. */
static void a_stiff_joint_limits_the_step(void **state) {
    (void)state;
    gn_world *soft = world_of(block, 0, PLACE ", normal: [0, 0, 1], tensile_strength: 1e9");
    const double step = soft->ctx.dt;
    world_end(soft);
    gn_world *w = world_of("gravity: [1, 2, -3]\ninitial: {random_velocity: 0.01}\n"
                           "dimension: 3\nspecimen: {lattice: {kind: hcp, radius: 0.001, cells: "
                           "[5, 5, 6]}}\nmaterials: [{name: m, density: 2500, contact_modulus: "
                           "1e9, kratio: 2, friction: 0.3, tensile_strength: 1e12, "
                           "shear_strength: 1e12}]\nlaw: {stiffness: harmonic}\n"
                           "bonds: {interaction_range: 0.1}\ntime: {end: 1}\n"
                           "joints: [{name: a, point: [0.005, 0.005, 0.005], dip: 30 deg, "
                           "normal_stiffness: 1e16, shear_stiffness: 1e15, tensile_strength: "
                           "1e12, cohesion: 1e12}]\n");
    assert_true(w->ctx.dt < 0.2 * step);
    measured_step(w);
    run_steps(w, 1000);
    gn_energy e = measured_step(w);
    /* The works of rotating arms are of the second order of the step. */
    assert_near(gn_energy_residual(&e), 0.0, 1e-6);
    assert_int_equal(gn_joint_read(&w->dem, 0).broken > 0.0, 0);
    world_end(w);
}

/* A block that slides over its base, with dilation, while contacts begin and end. */
static const char *const sliding =
    "dimension: 3\nspecimen: {lattice: {kind: hcp, radius: 0.001, cells: [5, 5, 6], jitter: 0.05}}"
    "\nmaterials: [{name: m, density: 2500, contact_modulus: 1e8, kratio: 2, friction: 0.3, "
    "tensile_strength: 1e12, shear_strength: 1e12}]\nlaw: {stiffness: harmonic}\n"
    "bonds: {interaction_range: 0.1}\ntime: {end: 1}\nrun: {threads: %d}\n"
    "joints: [{name: a, point: [0, 0, 0.0045], dip: 3 deg, normal_stiffness: 1e11, "
    "shear_stiffness: 1e11, friction: 0.4, cohesion: 1e4, dilation: 0.05}]\n"
    "sets: [{name: low, select: {box: {min: [-1, -1, -1], max: [1, 1, 0.003]}}, motion: {vx: 0, "
    "vy: 0, vz: 0}}, {name: up, select: {box: {min: [-1, -1, 0.006], max: [1, 1, 1]}}, motion: "
    "{vx: 3}, force: [0, 0, -10]}]\n";

static void bits_depend_on_neither_threads_nor_interruptions(void **state) {
    (void)state;
    const gn_energy e = end_alike(run_of(sliding, 1), run_of(sliding, 2), 500, 1500, 1e-3);
    assert_true(e.friction > 0.0 && e.bond_breaking > 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_are_those_of_sections_of_the_specimen),
        cmocka_unit_test(contacts_share_out_the_area_of_the_joint),
        cmocka_unit_test(contacts_across_a_joint_are_neither_bonds_nor_pairs),
        cmocka_unit_test(a_network_has_its_intensity),
        cmocka_unit_test(normals_of_a_network_follow_fisher),
        cmocka_unit_test(radii_of_a_network_follow_the_power_law),
        cmocka_unit_test(another_seed_draws_another_network),
        cmocka_unit_test(particles_slide_along_a_joint_without_riding_over_others),
        cmocka_unit_test(a_stiff_joint_limits_the_step),
        cmocka_unit_test(bits_depend_on_neither_threads_nor_interruptions),
    };
    return cmocka_run_group_tests_name("rock_joints", tests, NULL, NULL);
}
