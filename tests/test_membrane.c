/* The forces of a membrane: Nanson's formula under any affine motion, balance, and what breaks off.
 */
#include "world_helpers.h"

#include "sim/membrane.h"

static const char scene[] =
    "dimension: %d\nspecimen: {%s, particles: 80, packing: {size_ratio: 2}}\n"
    "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
    "sets: [{name: s, select: {ids: [5]}, force: [3, 0%s]}]\n"
    "membrane: {pressure: 7 MPa, follow: %s}\ntime: {end: 1}\nrun: {threads: 1}\n";

static gn_world *specimen(int dimension, bool follow) {
    return world_of(scene, dimension,
                    dimension == 2 ? "rectangle: {width: 0.03, height: 0.02}"
                                   : "box: {size: [0.02, 0.03, 0.02]}",
                    dimension == 2 ? "" : ", 0", follow ? "true" : "false");
}

static void move(gn_world *w, const double f[9]) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            q->pos[4 * p + a] = 0.004 + gn_dot3(f + 3 * a, q->start + 4 * p);
}

/* Applied forces are those of the sets less the pressure times J F^-T A. */
static void expect_forces(const gn_world *w, const double f[9], double pressure) {
    const gn_particles *q = &w->dem.particles;
    double area[9], size = 0;
    gn_cofactor3(f, area);
    for (size_t p = 0; p < q->soa.count; p++) size = fmax(size, pressure * q->skin[4 * p + 3]);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) {
            double load = a == 0 && q->id[p] == 5 ? 3 : 0;
            double want = load - pressure * gn_dot3(area + 3 * a, q->skin + 4 * p);
            assert_near(q->applied[4 * p + a], want, 1e-9 * size);
        }
}

static const double turned[2][9] = {{0.2, -1.1, 0, 0.9, 0.3, 0, 0, 0, 1},
                                    {1.1, 0.2, 0, -0.3, 0.9, 0.1, 0, 0.05, 1.2}};

static void areas_follow_an_affine_motion_as_nanson_says(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = specimen(d, true);
        move(w, turned[d - 2]);
        if (d == 2)
            for (size_t p = 0; p < w->dem.particles.soa.count; p++)
                w->dem.particles.pos[4 * p + 2] = 0;
        gn_membrane_press(w);
        expect_forces(w, turned[d - 2], 7e6);
        world_end(w);
    }
}

static void dead_loads_stay_what_they_are(void **state) {
    (void)state;
    const double none[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    gn_world *w = specimen(3, false);
    move(w, turned[1]);
    gn_membrane_press(w);
    expect_forces(w, none, 7e6);
    world_end(w);
}

/* Over a closed surface areas and their moments add up to nothing. */
static void forces_and_moments_are_in_balance(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = specimen(d, true);
        const gn_particles *q = &w->dem.particles;
        double sum[3] = {0}, moment[3] = {0}, size = 0, turn[3];
        for (size_t p = 0; p < q->soa.count; p++) {
            size += q->skin[4 * p + 3];
            gn_cross3(q->pos + 4 * p, q->skin + 4 * p, turn);
            for (int a = 0; a < 3; a++) sum[a] += q->skin[4 * p + a], moment[a] += turn[a];
        }
        for (int a = 0; a < 3; a++) {
            assert_near(sum[a], 0, 1e-12 * size);
            assert_near(moment[a], 0, 1e-12 * size * 0.03);
        }
        world_end(w);
    }
}

static void a_particle_without_bonds_loses_its_share_for_good(void **state) {
    (void)state;
    gn_world *w = specimen(3, true);
    gn_particles *q = &w->dem.particles;
    gn_contacts *bonds = &w->dem.bonds;
    size_t p = 0;
    while (!(q->skin[4 * p + 3] > 0 && q->bonds0[p] > 0)) p++;
    double share = q->skin[4 * p + 3], before = gn_membrane_area(w);
    for (size_t c = 0; c < bonds->soa.count; c++)
        if (bonds->i[c] == (int32_t)p || bonds->j[c] == (int32_t)p)
            bonds->cause[c] = GN_BROKEN_TENSION, w->dem.broken_tension++;
    w->step = 101; /* not looked at yet */
    gn_membrane_press(w);
    assert_close(gn_membrane_area(w), before, 1e-14);
    w->step = 200;
    gn_membrane_press(w);
    assert_close(gn_membrane_area(w), before - share, 1e-12);
    double force = q->id[p] == 5 ? 3 : 0;
    assert_true(q->applied[4 * p] == force && q->applied[4 * p + 1] == 0);
    w->step = 300;
    gn_membrane_press(w);
    assert_close(gn_membrane_area(w), before - share, 1e-12);
    world_end(w);
}

/* A cell presses on what lay beneath a particle that came off: the others go on without a force or
 * a moment of their own. */
static void what_is_left_is_in_balance_when_particles_break_off(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = specimen(d, true);
        gn_particles *q = &w->dem.particles;
        gn_contacts *bonds = &w->dem.bonds;
        double sum[3] = {0}, moment[3] = {0}, turn[3];
        int off = 0;
        for (size_t p = 0; p < q->soa.count && off < 3; p++) {
            if (!(q->skin[4 * p + 3] > 0 && q->bonds0[p] > 0)) continue;
            off++;
            for (size_t c = 0; c < bonds->soa.count; c++)
                if (bonds->i[c] == (int32_t)p || bonds->j[c] == (int32_t)p)
                    bonds->cause[c] = GN_BROKEN_TENSION, w->dem.broken_tension++;
        }
        double before = gn_membrane_area(w);
        w->step = 100;
        gn_membrane_press(w);
        double size = gn_membrane_area(w);
        assert_true(off == 3 && size < 0.99 * before);
        for (size_t p = 0; p < q->soa.count; p++) {
            if (!(q->skin[4 * p + 3] > 0)) continue;
            gn_cross3(q->start + 4 * p, q->skin + 4 * p, turn);
            for (int a = 0; a < 3; a++) sum[a] += q->skin[4 * p + a], moment[a] += turn[a];
        }
        for (int a = 0; a < 3; a++) {
            assert_near(sum[a], 0, 1e-12 * size);
            assert_near(moment[a], 0, 1e-12 * size * 0.03);
        }
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_follow_an_affine_motion_as_nanson_says),
        cmocka_unit_test(dead_loads_stay_what_they_are),
        cmocka_unit_test(forces_and_moments_are_in_balance),
        cmocka_unit_test(a_particle_without_bonds_loses_its_share_for_good),
        cmocka_unit_test(what_is_left_is_in_balance_when_particles_break_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
