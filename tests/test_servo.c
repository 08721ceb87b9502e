/* A wall with a servo: for any requested relaxation the loop of wall and particles is stable, also
 * near the limit of the step. */
#include "boundary/boundary.h"
#include "world_helpers.h"

/* Particles between a floor and a servo wall with a target of 5 N, all slightly compressed at the
 * start, so that the automatic step includes their contacts. */
static gn_world *driven(const char *particles, double top, const char *damping, double relaxation,
                        double safety, double speed) {
    return world_of("dimension: 3\nspecimen: {%s, group: 0}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
                    "law: {stiffness: uniform}\ndamping: {%s}\n"
                    "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\nwalls:\n"
                    "- {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5, "
                    "motion: {vz: %g}}\n"
                    "- {name: lid, point: [0, 0, %.17g], normal: [0, 0, -1], stiffness: 1e5, "
                    "servo: {force: 5, max_velocity: 10, relaxation: %g}}\n"
                    "time: {safety: %g, end: 1}\nrun: {threads: 1}\n",
                    particles, damping, speed, top, relaxation, safety);
}

static gn_world *pressed(const char *particles, double top, const char *damping, double relaxation,
                         double safety) {
    return driven(particles, top, damping, relaxation, safety, 0.0);
}

static const char one[] = "particles: [[0, 0, 0.99999 mm, 1 mm]]";
static const char cubes[] =
    "lattice: {kind: cubic, radius: 1 mm, cells: [3, 3, 3], spacing: 0.9999}";

/* The largest deviation of the force from 5 N in the last quarter of the time. */
static double unrest(gn_world *w, double time) {
    double most = 0.0;
    gneiss_error error = {0};
    while (w->ctx.time < time) {
        if (gn_world_step(w, false, &error) != GNEISS_OK) fail_msg("%s", error.message);
        if (w->ctx.time > 0.75 * time) most = fmax(most, fabs(w->boundary.walls[1].force[2] - 5.0));
    }
    world_end(w);
    return most;
}

/* The force settles at the rate of the slowest damping; after 10 ms (about 200 periods of a sphere
 * between its walls, 40 of a column of three) less than 1 % of the initial deviation is left. An
 * unstable loop oscillates between no contact and twice the force. */
static void settles(const char *particles, double top, double time) {
    const char *const dampings[] = {"", "contact: {restitution: 0.9}",
                                    "contact: {restitution: 0.5}", "contact: {restitution: 0.05}"};
    bool lattice = particles == cubes;
    for (int d = lattice; d < 4; d++)
        for (int r = 1; r < 4; r++)
            for (int s = 0; s < 3; s++) {
                double relaxation = (const double[]){0.1, 0.3, 0.5, 1.0}[r];
                double safety = (const double[]){0.5, 0.9, 0.99}[s];
                double most =
                    unrest(pressed(particles, top, dampings[d], relaxation, safety), time);
                if (most > 0.05)
                    fail_msg("'%s', relaxation %g, safety %g: 5 N missed by %g N", dampings[d],
                             relaxation, safety, most);
            }
}

static void one_sphere_settles_at_any_relaxation(void **state) {
    (void)state;
    settles(one, 1.99998e-3, 10e-3);
}

static void a_lattice_settles_at_any_relaxation(void **state) {
    (void)state;
    settles(cubes, 3 * 2e-3 * 0.9999, 10e-3);
}

/* A small relaxation is used unchanged: the first step moves the wall accordingly. */
static void the_default_is_not_touched(void **state) {
    (void)state;
    const char *const dampings[] = {"", "contact: {restitution: 0.5}"};
    for (int d = 0; d < 2; d++) {
        gn_world *w = pressed(one, 1.99998e-3, dampings[d], 0.1, 0.9);
        run_steps(w, 1);
        double missing = 5.0 - w->boundary.walls[1].force[2];
        assert_close(-w->boundary.walls[1].velocity[2] * w->ctx.dt,
                     0.1 * missing / w->boundary.walls[1].stiffness, 1e-12);
        world_end(w);
    }
}

/* 36 spheres side by side come into contact in one step. Their reaction is at most the fraction of
 * the missing force that one step corrects, 0.1 of 5 N: the path of the wall is this force over the
 * sum of k (and of c/dt of dashpots) of all contacts, and the dashpot of a closing contact acts for
 * at most 1.5 steps. A path computed for one contact would give up to 36 times as much. */
static void a_servo_approaches_a_crowd_of_grains_softly(void **state) {
    (void)state;
    const char layer[] = "lattice: {kind: cubic, radius: 1 mm, cells: [6, 6, 1], spacing: 1.01}";
    for (int damped = 0; damped < 2; damped++)
        for (int phase = 1; phase < 10; phase++) {
            const char *damping = damped ? "contact: {restitution: 0.5}" : "";
            /* the gap is one tenth and so on of the path of one contact, 0.1 x 5 N/k = 5 um */
            gn_world *w = pressed(layer, 2.01e-3 + 0.5e-6 * phase, damping, 0.1, 0.5);
            for (int k = 0; k < 100 && w->boundary.walls[1].force[2] == 0.0; k++) run_steps(w, 1);
            double first = w->boundary.walls[1].force[2];
            assert_true(first > 0.0);
            if (first > 0.5 * (damped ? 1.5 : 1.0 + 1e-9))
                fail_msg("%s, gap %d: %g N at once", damping, phase, first);
            world_end(w);
        }
}

/* A box of spheres between six walls, three of which are held at a stress: in the end all walls
 * have it, relative to their present sections, and so does the mean stress. */
static gn_world *box_of(const char *servos) {
    return world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1 mm, cells: [4, 3, 3], "
        "spacing: 0.999, origin: [0, 0, 0]}}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
        "law: {stiffness: uniform}\n"
        "damping: {background: {model: nonviscous_vector, coefficient: 0.7}}\n"
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\nwalls:\n"
        "- {name: x0, point: [0, 0, 0], normal: [1, 0, 0], stiffness: 1e5}\n"
        "- {name: y0, point: [0, 0, 0], normal: [0, 1, 0], stiffness: 1e5}\n"
        "- {name: z0, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5}\n%s"
        "time: {end: 1}\nrun: {threads: 1}\n",
        servos);
}

static void a_stress_is_held_over_the_section_of_the_box(void **state) {
    (void)state;
    gn_world *w = box_of("- {name: x1, point: [8 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5, "
                         "servo: {stress: 10 kPa, max_velocity: 1}}\n"
                         "- {name: y1, point: [0, 6 mm, 0], normal: [0, -1, 0], stiffness: 1e5, "
                         "servo: {stress: 20 kPa, max_velocity: 1}}\n"
                         "- {name: z1, point: [0, 0, 6 mm], normal: [0, 0, -1], stiffness: 1e5, "
                         "servo: {stress: 30 kPa, max_velocity: 1}}\n");
    run_steps(w, 20000);
    measured_step(w);
    double side[3], volume = 1.0;
    for (int a = 0; a < 3; a++) {
        side[a] = w->boundary.walls[3 + a].point[a] - w->boundary.walls[a].point[a];
        volume *= side[a];
    }
    for (int a = 0; a < 3; a++) {
        double area = volume / side[a], wanted = 1e4 * (a + 1) * area;
        assert_near(w->boundary.walls[3 + a].force[a], wanted, 1e-4 * wanted);
        assert_near(w->boundary.walls[a].force[a], -wanted, 1e-4 * wanted);
        assert_near(w->ledger.stress[4 * a], -1e4 * (a + 1), 1e-2 * 1e4 * (a + 1));
    }
    assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-3);
    world_end(w);
}

/* Loads in steady motion: a floor at V under one sphere or a lattice of them, at any share and
 * step. With the share alone the lid would miss V dt K/rho permanently, here at least a tenth of
 * its target; with the integral part the lid moves at V, and the error vanishes. */
static void follows(const char *particles, double top, const char *damping) {
    const double shares[] = {0.05, 0.1, 1.0}, safeties[] = {0.3, 0.9, 0.99}, v = 0.2;
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++) {
            gneiss_error error = {0};
            gn_world *w = driven(particles, top, damping, shares[r], safeties[s], v);
            double most = 0.0, behind = 0.0, droop = 0.0;
            while (w->ctx.time < 0.12) {
                if (gn_world_step(w, false, &error) != GNEISS_OK) fail_msg("%s", error.message);
                const gn_wall *lid = &w->boundary.walls[1];
                double share =
                    fmin(shares[r], gn_wall_servo_relaxation(&w->ctx, &w->dem, &w->boundary, 1));
                if (w->ctx.time < 0.11) continue;
                droop = v * w->ctx.dt * lid->stiffness / share;
                most = fmax(most, fabs(lid->force[2] - 5.0));
                behind = fmax(behind, fabs(lid->velocity[2] - v));
            }
            if (most > 1e-3 * droop || behind > 1e-3 * v)
                fail_msg("relaxation %g, safety %g: 5 N missed by %g N, %g m/s by %g; the share "
                         "alone misses %g N",
                         shares[r], safeties[s], most, v, behind, droop);
            world_end(w);
        }
}

static void a_lid_holds_its_force_on_grains_in_motion(void **state) {
    (void)state;
    const char damped[] = "contact: {restitution: 0.3}";
    follows(one, 1.99998e-3, damped);
    follows(cubes, 3 * 2e-3 * 0.9999, damped);
}

static void refused(const char *servo, const char *expected) {
    text t = {0};
    gneiss_error error = {0};
    gn_world w;
    add(&t,
        "specimen: {particles: [[0, 0, 0, 1 mm]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
        "law: {stiffness: uniform}\ntime: {end: 1}\nwalls:\n"
        "- {name: lid, point: [0, 0, 1 mm], normal: [0, 0, -1], stiffness: 1e5, servo: {%s}}\n"
        "- {name: x0, point: [-1 mm, 0, 0], normal: [1, 0, 0], stiffness: 1e5}\n"
        "- {name: x1, point: [1 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5}\n",
        servo);
    assert_int_equal(world_try(&w, t.s, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, expected)) fail_msg("'%s' is not in '%s'", expected, error.message);
}

static void impossible_servos_are_refused(void **state) {
    (void)state;
    refused("max_velocity: 1", "s.yaml:6:72: walls[0].servo: expected force or stress, found none");
    refused("max_velocity: 1, force: 1, stress: 1", "expected force or stress, found both");
    refused("max_velocity: 1, force: 1, area: 1", "servo.area: needs stress");
    refused("max_velocity: 1, stress: 1 kPa",
            "walls[0].servo.area: required beside stress without two pairs of walls");
    refused("max_velocity: 1, stress: 1 N", "walls[0].servo.stress: expected a stress");
}

/* --- the mean stress --- */

/* A cubic lattice whose side along z is shortened at a constant rate, while the walls across x and
 * y hold the mean stress p. Along z a row of three grains has four springs k in series, so that its
 * stress is known: s_z = k/4 u/d^2 with the approach u of the walls since contact. Each of the
 * others then carries (3 p - s_z)/2. */
static void walls_hold_the_mean_stress_while_one_side_is_driven(void **state) {
    (void)state;
    gn_world *w = box_of("- {name: x1, point: [8 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5, "
                         "servo: {stress: 20 kPa, stress_of: mean, max_velocity: 1}}\n"
                         "- {name: y1, point: [0, 6 mm, 0], normal: [0, -1, 0], stiffness: 1e5, "
                         "servo: {stress: 20 kPa, stress_of: mean, max_velocity: 1}}\n"
                         "- {name: z1, point: [0, 0, 6 mm], normal: [0, 0, -1], stiffness: 1e5, "
                         "motion: {vz: '-2e-4*min(t/0.005, 1)'}}\n");
    double wrong = 0.0, most = 0.0;
    while (w->ctx.time < 0.03) {
        run_steps(w, 1);
        if (w->ctx.time < 0.01) continue;
        double side[3], stress[3], mean = 0.0;
        for (int a = 0; a < 3; a++)
            side[a] = w->boundary.walls[3 + a].point[a] - w->boundary.walls[a].point[a];
        for (int a = 0; a < 3; a++) {
            stress[a] = 0.5 * (w->boundary.walls[3 + a].force[a] - w->boundary.walls[a].force[a]) *
                        side[a] / (side[0] * side[1] * side[2]);
            mean += stress[a] / 3.0;
        }
        const double springs = 12.0 * 0.25 * 1e5 * (6e-3 - side[2]) / (side[0] * side[1]);
        wrong = fmax(wrong, fabs(mean - 2e4));
        most = fmax(most, fabs(stress[2] - springs) / springs);
        for (int a = 0; a < 2; a++) assert_near(stress[a], 0.5 * (6e4 - stress[2]), 1e-2 * 2e4);
    }
    if (wrong > 5e-3 * 2e4) fail_msg("the mean stress was missed by %g Pa", wrong);
    if (most > 1e-2) fail_msg("the driven side deviates from its springs by %g", most);
    world_end(w);
}

/* Face-centred grains between six walls: axes are coupled. One, two or three axes hold the mean
 * stress of 20 kPa, at the ends of the range of `relaxation`, `safety` and dashpots; axis z carries
 * 24 kPa unless it belongs to them. (Stresses of 1 to 2 would unload contacts of the lattice.) */
static void a_mean_stress_settles_at_any_relaxation(void **state) {
    (void)state;
    for (int k = 0; k < 12; k++) {
        const double share = k % 2 ? 1.0 : 0.1, safety = k / 2 % 2 ? 0.99 : 0.5;
        const int held = 1 + k / 4;
        const char *const damping[] = {"", "contact: {restitution: 0.5}, "};
        char servo[3][128];
        for (int a = 0; a < 3; a++)
            snprintf(servo[a], sizeof servo[a], "stress: %s, max_velocity: 1, relaxation: %g",
                     a < held ? "20 kPa, stress_of: mean"
                     : a == 1 ? "18 kPa"
                              : "24 kPa",
                     share);
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1 mm, cells: [2, 2, 2], "
            "spacing: 0.9995, origin: [0, 0, 0]}}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
            "law: {stiffness: uniform}\n"
            "damping: {%sbackground: {model: viscous, coefficient: 3000}}\n"
            "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\nwalls:\n"
            "- {name: x0, point: [0, 0, 0], normal: [1, 0, 0], stiffness: 1e5}\n"
            "- {name: y0, point: [0, 0, 0], normal: [0, 1, 0], stiffness: 1e5}\n"
            "- {name: z0, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5}\n"
            "- {name: x1, point: [7 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5, servo: {%s}}\n"
            "- {name: y1, point: [0, 7 mm, 0], normal: [0, -1, 0], stiffness: 1e5, servo: {%s}}\n"
            "- {name: z1, point: [0, 0, 7 mm], normal: [0, 0, -1], stiffness: 1e5, servo: {%s}}\n"
            "time: {end: 1, safety: %g}\nrun: {threads: 1}\n",
            damping[k / 4 % 2], servo[0], servo[1], servo[2], safety);
        double worst = 0.0;
        while (w->ctx.time < 40e-3) {
            double side[3], mean = 0.0;
            run_steps(w, 1);
            if (w->ctx.time < 30e-3) continue;
            for (int a = 0; a < 3; a++)
                side[a] = w->boundary.walls[3 + a].point[a] - w->boundary.walls[a].point[a];
            for (int a = 0; a < 3; a++) mean += w->boundary.walls[3 + a].force[a] * side[a] / 3.0;
            worst = fmax(worst, fabs(mean / (side[0] * side[1] * side[2]) - 2e4));
        }
        if (worst > 5e-3 * 2e4)
            fail_msg("%d axes, relaxation %g, safety %g: 20 kPa missed by %g Pa", held, share,
                     safety, worst);
        world_end(w);
    }
}

static void a_mean_stress_needs_a_box_of_walls(void **state) {
    (void)state;
    static const char scene_text[] =
        "dimension: 3\nspecimen: {particles: [[0, 0, 1 mm, 1 mm]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
        "law: {stiffness: uniform}\nwalls:\n"
        "- {name: z0, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5}\n"
        "- {name: z1, point: [0, 0, 2 mm], normal: [0, 0, -1], stiffness: 1e5, "
        "servo: {force: 1, max_velocity: 1}}\n"
        "time: {end: 1}\nrun: {threads: 1}\n";
    assert_change_refused(scene_text, "force: 1", "stress: 1, area: 1, stress_of: mean",
                          "expected a wall of a box");
    assert_change_refused(scene_text, "force: 1", "force: 1, stress_of: mean",
                          "expected stress beside it");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_sphere_settles_at_any_relaxation),
        cmocka_unit_test(a_lattice_settles_at_any_relaxation),
        cmocka_unit_test(the_default_is_not_touched),
        cmocka_unit_test(a_servo_approaches_a_crowd_of_grains_softly),
        cmocka_unit_test(a_stress_is_held_over_the_section_of_the_box),
        cmocka_unit_test(walls_hold_the_mean_stress_while_one_side_is_driven),
        cmocka_unit_test(a_mean_stress_settles_at_any_relaxation),
        cmocka_unit_test(a_mean_stress_needs_a_box_of_walls),
        cmocka_unit_test(a_lid_holds_its_force_on_grains_in_motion),
        cmocka_unit_test(impossible_servos_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
