/* Several bodies under a membrane: each is in balance and followed separately. */
#include "world_helpers.h"

#include "membrane/membrane.h"

static const double pitch = 2e-3;
static const double rotation[9] = {0.6, 0, 0.8, 0.64, 0.6, -0.48, -0.48, 0.8, 0.36};

static void press_at(gn_world *w, int64_t step) {
    gneiss_error error = {0};
    w->ctx.step = step;
    if (gn_membrane_apply(&w->ctx, &w->dem, &w->membrane, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
}

/* Two blocks of 4 x 4 x 4 without contact; one is stretched, the other bent and shifted. Their
 * surfaces are closed separately and together. */
static gn_world *two_blocks(double pressure, double ramp) {
    char blocks[8000];
    size_t used = 0;
    for (int p = 0; p < 128; p++)
        used += (size_t)snprintf(blocks + used, sizeof blocks - used, "%s[%g, %g, %g, 1e-3]",
                                 p ? ", " : "", 2e-3 * (p % 4) + 0.03 * (p / 64),
                                 2e-3 * (p / 4 % 4), 2e-3 * (p / 16 % 4));
    return world_of("dimension: 3\nspecimen: {particles: [%s]}\n"
                    "materials: [{name: m, density: 2650, contact_modulus: 1e10, kratio: 2, "
                    "friction: 0.5, tensile_strength: 3e11, shear_strength: 3e11}]\n"
                    "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.01}\n"
                    "membrane: {pressure: %g, ramp: %g}\ntime: {end: 1}\nrun: {threads: 1}\n",
                    blocks, pressure, ramp);
}

/* Areas rotate between two updates as well. */
static void areas_turn_with_the_body_that_they_are_of(void **state) {
    (void)state;
    gn_world *w = two_blocks(7e6, 0);
    gn_particles *q = &w->dem.particles;
    press_at(w, 100);
    double *start = calloc(4 * q->soa.count, sizeof *start);
    assert_non_null(start);
    memcpy(start, q->skin, 4 * q->soa.count * sizeof *start);
    assert_true(w->membrane.state->bodies == 2);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            if (q->id[p] < 64) q->pos[4 * p + a] = gn_dot3(rotation + 3 * a, q->start + 4 * p);
    press_at(w, 150);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) {
            double turned_area = gn_dot3(rotation + 3 * a, start + 4 * p);
            double want = q->id[p] < 64 ? turned_area : start[4 * p + a];
            assert_near(q->applied[4 * p + a], -7e6 * want, 1e-9 * 7e6 * pitch * pitch);
        }
    free(start);
    world_end(w);
}

/* At any distance between the bodies the patches of each follow their own surroundings, and the
 * stretch of a patch is limited by that of its own body. */
static void bodies_that_drift_apart_keep_their_areas(void **state) {
    (void)state;
    gn_world *w = two_blocks(7e6, 0);
    gn_particles *q = &w->dem.particles;
    const double face = pitch * pitch;
    press_at(w, 100); /* finds two bodies */
    for (size_t p = 0; p < q->soa.count; p++)
        if (q->id[p] >= 64) q->pos[4 * p] += 0.3;
    double *start = calloc(4 * q->soa.count, sizeof *start);
    assert_non_null(start);
    memcpy(start, q->skin, 4 * q->soa.count * sizeof *start);
    for (int look = 2; look <= 41; look++) press_at(w, 100 * look);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            assert_near(q->applied[4 * p + a], -7e6 * start[4 * p + a], 1e-9 * 7e6 * face);
    assert_true(w->membrane.state->unlike == 0);
    free(start);
    world_end(w);
}

/* The pressure has the potential energy p V: bodies that oscillate and rotate under it without
 * damping conserve their energy. (With areas constant for 100 steps it grew by a factor of a
 * million.) */
static void two_bodies_that_swing_and_turn_gain_no_energy(void **state) {
    (void)state;
    gn_world *w = two_blocks(3e7, 1e-4);
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (q->id[p] >= 64 || q->start[4 * p + 2] > 3e-3) continue;
        q->vel[4 * p] = 1.0;
        q->vel[4 * p + 1] = 0.3;
    }
    run_steps(w, 1);
    const double given = 0.5 * 32 * (1.0 + 0.09) * sphere_mass(2650, 1e-3);
    double most = 0;
    for (int k = 0; k < 40; k++) {
        run_steps(w, 99);
        const gn_energy e = measured_step(w);
        most = fmax(most, e.kinetic + e.rotational);
    }
    assert_true(most > 0.2 * given && most < 10 * given);
    world_end(w);
}

static void bodies_that_are_apart_do_not_push_or_turn_one_another(void **state) {
    (void)state;
    gn_world *w = two_blocks(7e6, 0);
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        double *x = q->pos + 4 * p;
        const double *from = q->start + 4 * p;
        if (q->id[p] < 64)
            x[1] *= 1.2;
        else
            x[0] += 1e-3 + 60 * from[2] * from[2], x[1] += 40 * from[2] * from[1];
    }
    press_at(w, 100);
    for (int body = 0; body < 2; body++) {
        double force[3] = {0}, moment[3] = {0}, size = 0;
        for (size_t p = 0; p < q->soa.count; p++) {
            double turn[3];
            if ((q->id[p] >= 64) != body) continue;
            gn_cross3(q->pos + 4 * p, q->applied + 4 * p, turn);
            for (int a = 0; a < 3; a++) force[a] += q->applied[4 * p + a], moment[a] += turn[a];
            size += sqrt(gn_dot3(q->applied + 4 * p, q->applied + 4 * p));
        }
        assert_true(size > 7e6 * 6 * 36e-6); /* the pressure acts on faces of at least 6 mm */
        for (int a = 0; a < 3; a++) {
            assert_near(force[a], 0, 1e-12 * size);
            assert_near(moment[a], 0, 1e-12 * size * 0.04);
        }
    }
    world_end(w);
}

/* Pairs, rows and layers have no shape that could be followed: they are not loaded, and refused if
 * there is nothing else. */
static void bodies_without_volume_are_not_loaded_by_the_membrane(void **state) {
    (void)state;
    static const char rest[] =
        "\nmaterials: [{name: m, density: 2650, contact_modulus: 10 GPa, kratio: 3, friction: 0.5, "
        "tensile_strength: 1e90, shear_strength: 1e90}]\nlaw: {stiffness: harmonic}\nbonds: "
        "{interaction_range: 0.05}\nmembrane: {pressure: 10 MPa}\ntime: {end: 1 ms}\nrun: "
        "{threads: 1}\n";
    static const char *const alone[] = {
        "[[0, 0, 0, 1e-3], [1.2e-3, 1.6e-3, 0, 1e-3]]",
        "[[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [4e-3, 0, 0, 1e-3]]",
        "[[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [0, 2e-3, 0, 1e-3], [2e-3, 2e-3, 0, 1e-3]]"};
    for (int k = 0; k < 3; k++) {
        char yaml[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(yaml, sizeof yaml, "dimension: 3\nspecimen: {particles: %s}%s", alone[k], rest);
        assert_int_equal(world_try(&w, yaml, "/tmp", &error), GNEISS_ERROR_INPUT);
        assert_non_null(
            strstr(error.message, "membrane: expected particles that enclose a volume"));
    }
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [1e-3, 1.7e-3, "
        "0, "
        "1e-3], [1e-3, 0.6e-3, 1.6e-3, 1e-3], [20e-3, 0, 0, 1e-3], [21.2e-3, 1.6e-3, 0, 1e-3]]}%s",
        rest);
    const gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        assert_true(q->id[p] < 4 ? q->skin[4 * p + 3] > 0.0 : q->skin[4 * p + 3] == 0.0);
    world_end(w);
}

/* Angular momentum about the centre of mass, of velocities and of spins. */
static void angular_momentum(const gn_world *w, double sum[3]) {
    const gn_particles *q = &w->dem.particles;
    double mass = 0, centre[3] = {0}, velocity[3] = {0};
    for (int round = 0; round < 2; round++)
        for (size_t p = 0; p < q->soa.count; p++) {
            const double m = 1 / q->vel[4 * p + 3], r = q->pos[4 * p + 3];
            double x[3], v[3], turn[3];
            mass += round ? 0 : m;
            for (int a = 0; a < 3; a++) {
                x[a] = q->pos[4 * p + a] - centre[a] / mass;
                v[a] = q->vel[4 * p + a] - velocity[a] / mass;
                centre[a] += round ? 0 : m * q->pos[4 * p + a];
                velocity[a] += round ? 0 : m * q->vel[4 * p + a];
            }
            gn_cross3(x, v, turn);
            for (int a = 0; a < 3 && round; a++)
                sum[a] += m * (turn[a] + 0.4 * r * r * q->spin[4 * p + a]);
        }
}

/* An undamped block rotates under 100 MPa, 1 % of its modulus: the membrane exerts no moment,
 * between updates as well and with any waves in the block. (The error was 1 % after 3 000
 * steps.) */
static void a_block_that_turns_keeps_its_angular_momentum(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {box: {size: [0.01, 0.012, 0.014]}, particles: 300, packing: "
        "{size_ratio: 2}}\nmaterials: [{name: m, density: 2650, contact_modulus: 1e10, kratio: 2, "
        "friction: 0.5, tensile_strength: 1e12, shear_strength: 1e12}]\nlaw: {stiffness: "
        "harmonic}\nbonds: {interaction_range: 0.05}\nmembrane: {pressure: 100 MPa, ramp: 0.2 "
        "ms}\ntime: {end: 1}\nrun: {threads: 1}\n");
    gn_particles *q = &w->dem.particles;
    const double spin[3] = {150, 100, 500};
    double before[3] = {0}, after[3] = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        gn_cross3(spin, q->pos + 4 * p, q->vel + 4 * p);
        memcpy(q->spin + 4 * p, spin, sizeof spin);
    }
    angular_momentum(w, before);
    run_steps(w, 3050);
    angular_momentum(w, after);
    for (int a = 0; a < 3; a++) assert_near(after[a], before[a], 1e-9 * length3(before));
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_turn_with_the_body_that_they_are_of),
        cmocka_unit_test(bodies_that_drift_apart_keep_their_areas),
        cmocka_unit_test(two_bodies_that_swing_and_turn_gain_no_energy),
        cmocka_unit_test(bodies_that_are_apart_do_not_push_or_turn_one_another),
        cmocka_unit_test(bodies_without_volume_are_not_loaded_by_the_membrane),
        cmocka_unit_test(a_block_that_turns_keeps_its_angular_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
