/* Moving sides of a periodic box: particles move with it without a discontinuity, the mean stress
 * is held, the ledger closes, and nothing depends on threads or on an interruption. */
#include "boundary/boundary.h"
#include "drive/servo.h"
#include "run_helpers.h"

/* 108 spheres of 1 mm in a face-centred lattice that is compressed by 0.1 %: three cells of side
 * 2 sqrt(2) 0.999 mm. */
#define SIDE 8.476796092864333e-3
static const char lattice[] =
    "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 0.999, jitter: %g, "
    "origin: [%g, %g, 0]}}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3}]\n"
    "law: {stiffness: uniform}\nrun: {threads: 1}\n"
    "periodic: {min: [0, 0, 0], max: [%.17g, %.17g, %.17g], %s}\ntime: {end: 1%s}\n";

static gn_world *crystal(double jitter, double x, double y, const char *sides, const char *time) {
    return world_of(lattice, jitter, x, y, SIDE, SIDE, SIDE, sides, time);
}

static double speed_most(const gn_world *w) {
    double most = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double *v = w->dem.particles.vel + 4 * p;
        most = fmax(most, sqrt(gn_dot3(v, v)));
    }
    return most;
}

/* --- the convention --- */

/* By symmetry the motion is a uniform strain. Of twelve neighbours at d a sphere has half: 24
 * contacts in a cell of 2 sqrt(2) d^3, and the mean stress is 24 k (2 r - d) d/(3 a^3). Other
 * speeds are rounding of forces over masses, 1e-16 k r/m for a millisecond. */
static void a_lattice_follows_a_uniform_strain_as_a_whole(void **state) {
    (void)state;
    gn_world *w = crystal(0, 0, 0, "x: {rate: -5}, y: {rate: -5}, z: {rate: -5}", "");
    run_steps(w, 1000);
    double edge = w->ctx.period[0] / 3.0, d = edge / sqrt(2.0);
    gn_energy e = measured_step(w);
    double stress = 8.0 * 1e5 * (2e-3 - d) * d / (edge * edge * edge);
    assert_true(edge < 0.995 * SIDE / 3.0);
    for (int a = 0; a < 3; a++) assert_near(-w->ledger.stress[4 * a], stress, 1e-9 * stress);
    assert_near(speed_most(w), 0.0, 1e-9);
    /* The trapezoidal rule is exact for a force that grows in proportion, up to the change of
     * lengths in a step, 1e-5 of itself squared. */
    assert_near(gn_energy_residual(&e), 0.0, 1e-8);
    world_end(w);
}

/* One crystal is perturbed at the sides of the box and elsewhere. The results differ by rounding,
 * and because the fixed corner is at another particle. */
static void there_is_no_seam(void **state) {
    (void)state;
    const char *sides = "x: {rate: -8}, y: {rate: 3}, z: {rate: -2}";
    gn_world *a = crystal(0.02, 0, 0, sides, ""), *b = crystal(0.02, 3e-3, -2e-3, sides, "");
    run_steps(a, 300);
    run_steps(b, 300);
    measured_step(a);
    measured_step(b);
    for (int k = 0; k < 9; k++)
        assert_near(a->ledger.stress[k], b->ledger.stress[k], 1e-7 * fabs(a->ledger.stress[0]));
    assert_near(a->ledger.energy.friction, b->ledger.energy.friction,
                1e-7 * a->ledger.energy.friction);
    world_end(a);
    world_end(b);
}

/* c L is conserved for a free particle under any motion of the box; the work is the change of its
 * energy. */
static void a_free_particle_keeps_its_speed_in_units_of_the_box(void **state) {
    (void)state;
    gn_world *w = world_of(
        "specimen: {particles: [[3 mm, 4 mm, 5 mm, 1 mm]]}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0}]\n"
        "law: {stiffness: uniform}\nrun: {threads: 1}\ntime: {step: 1 us, end: 1}\n"
        "sets: [{name: s, select: {all: true}, initial_velocity: [3, -2, 1]}]\n"
        "periodic: {min: [0, 0, 0], max: [10 mm, 11 mm, 12 mm], x: {rate: -20}, y: {rate: [[0, 0], "
        "[5 ms, 60]]}}\n");
    const double action[3] = {3 * 10e-3, -2 * 11e-3, 1 * 12e-3};
    run_steps(w, 10000);
    gn_energy e = measured_step(w);
    assert_true(w->ctx.period[0] < 0.0083 && w->ctx.period[1] > 0.013);
    for (int a = 0; a < 3; a++)
        assert_near(vel_of(w, 0)[a] * w->ctx.period[a], action[a], 1e-11 * fabs(action[a]));
    assert_near(gn_energy_residual(&e), 0.0, 1e-12);
    world_end(w);
}

/* --- the servo --- */

/* Grains without contacts at the start, with extreme settings of a servo. */
static gn_world *grains(const char *relaxation, const char *more) {
    return world_of(
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 1.01, jitter: "
        "0.02}}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\nrun: {threads: 1}\n"
        "periodic: {min: [0, 0, 0], max: [8.57 mm, 8.57 mm, 8.57 mm],\n"
        "  x: {stress: 100 kPa, max_rate: 50, relaxation: %s},\n"
        "  y: {stress: 100 kPa, max_rate: 50, relaxation: %s},\n"
        "  z: {stress: 200 kPa, max_rate: 50, relaxation: %s}}\n%s",
        relaxation, relaxation, relaxation, more);
}

static void stress_is_held(const char *relaxation, const char *more) {
    gn_world *w = grains(relaxation, more);
    const double wanted[3] = {1e5, 1e5, 2e5};
    run_steps(w, 8000);
    double moving = speed_most(w);
    for (int k = 0; k < 500; k++) {
        gn_energy e = measured_step(w);
        for (int a = 0; a < 3; a++)
            assert_near(-w->ledger.stress[4 * a], wanted[a], 0.01 * wanted[a]);
        assert_near(gn_energy_residual(&e), 0.0, 0.01);
    }
    assert_true(moving < 1e-3 && speed_most(w) < 1e-3);
    world_end(w);
}

static void a_mean_stress_is_held_whatever_the_relaxation(void **state) {
    (void)state;
    static const char *const relaxations[] = {"0.01", "0.1", "1"};
    for (int k = 0; k < 3; k++)
        stress_is_held(relaxations[k],
                       "damping: {background: {model: nonviscous_component, coefficient: 0.3}}\n"
                       "time: {end: 1}\n");
}

static void a_servo_is_stable_at_the_limit_of_the_step(void **state) {
    (void)state;
    stress_is_held("1", "damping: {contact: {fraction: 0.5}}\ntime: {end: 1, safety: 1}\n");
    stress_is_held("1", "damping: {background: {model: viscous, coefficient: 3000}}\n"
                        "time: {end: 1, safety: 1}\n");
}

/* In an fcc lattice without friction the lateral stress response to axial strain is half (C12/C11 =
 * 1/2): while z shrinks at E, sides that are held at a stress continue to grow at E/3. With the
 * share only, the stress would permanently be too large by E/3 dt D/(rho V). */
static void a_stress_is_held_while_another_side_moves_on(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double share = (const double[]){0.05, 0.1, 1.0}[k], rate = 0.1;
        char sides[256];
        snprintf(sides, sizeof sides,
                 "x: {stress: 50 kPa, max_rate: 50, relaxation: %g}, y: {stress: 50 kPa, max_rate: "
                 "50, relaxation: %g}, z: {rate: %g}",
                 share, share, -rate);
        gn_world *w =
            crystal(0, 0, 0, sides, "}\ndamping: {background: {model: viscous, coefficient: 3000}");
        while (w->ctx.time < 25e-3) run_steps(w, 100);
        measured_step(w);
        const double taken = fmin(share, gn_servo_share(&w->ctx, &w->dem)),
                     droop = rate / 3.0 * w->ctx.dt * w->box.spring[0] / (taken * w->ctx.volume);
        for (int a = 0; a < 2; a++) {
            double missing = fabs(w->ledger.stress[4 * a] + 5e4);
            if (missing > 0.02 * droop + 2.0)
                fail_msg("relaxation %g: 50 kPa missed by %g Pa, by the share alone %g", share,
                         missing, droop);
        }
        world_end(w);
    }
}

/* The sides across x and y hold the mean stress p while z shrinks. In an fcc lattice whose contacts
 * stick, stress_zz - stress_xx is (C11 - C12) (e_z - e_x), with C11 - C12 = (2 k_n + 6 k_t) d^2/a^3
 * from the sums over 24 contacts in a cell of a = sqrt(2) d (of k_n: 16/4 - 8/4, of k_t: 16/4 +
 * 8/4). */
static void sides_hold_the_mean_stress_while_another_one_moves(void **state) {
    (void)state;
    gn_world *w = crystal(0, 0, 0,
                          "x: {stress: 140 kPa, stress_of: mean, max_rate: 50}, y: {stress: 140 "
                          "kPa, stress_of: mean, max_rate: 50}, z: {rate: -0.02}",
                          "}\ndamping: {background: {model: viscous, coefficient: 3000}");
    while (w->ctx.time < 25e-3) {
        run_steps(w, 100);
        measured_step(w);
        const double *s = w->ledger.stress, mean = (s[0] + s[4] + s[8]) / 3.0;
        if (w->ctx.time > 5e-3) assert_near(mean, -1.4e5, 2e-3 * 1.4e5);
    }
    double strain[3];
    for (int a = 0; a < 3; a++) strain[a] = w->ctx.period[a] / SIDE - 1.0;
    const double d = 2e-3, edge = sqrt(2.0) * d,
                 modulus = (2.0 * 1e5 + 6.0 * 0.5e5) * d * d / (edge * edge * edge);
    const double *s = w->ledger.stress;
    assert_near(strain[2], -0.02 * 25e-3, 1e-5);
    assert_near(s[0], s[4], 10.0);
    assert_near((s[8] - s[0]) / (modulus * (strain[2] - strain[0])), 1.0, 1e-2);
    assert_true(fabs(strain[0] + strain[1] + strain[2]) < 0.1 * fabs(strain[2]));
    world_end(w);
}

/* --- whole runs --- */

static void steps(gn_run *run, int64_t count) {
    gneiss_error error = {0};
    if (gn_run_steps(run, count, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

/* The specimen compacts, bonds, is held, and is then sheared along z, with all features that a box
 * allows. */
static const char *programme(const char *run) {
    static char s[4096];
    snprintf(
        s, sizeof s,
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 1.02, "
        "jitter: 0.05}, group: 1}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: "
        "0.3, bond_tension_limit: 0.05, bond_shear_limit: 0.1}]\n"
        "law: {stiffness: uniform}\nbonds: {enabled: off}\ngravity: [0, 0, -1]\n"
        "damping: {background: {model: nonviscous_vector, coefficient: 0.4}, contact: "
        "{restitution: 0.5}}\n"
        "periodic: {min: [0, 0, 0], max: [8.66 mm, 8.66 mm, 8.66 mm],\n"
        "  x: {stress: 50 kPa, max_rate: 20, relaxation: 1},\n"
        "  y: {stress: 50 kPa, max_rate: 20, relaxation: 1}, z: {stress: 50 kPa, max_rate: 20}}\n"
        "test: {kind: hydrostatic}\n"
        "time: {end: 1}\noutput: {history_rows: 100000, snapshots: 0}\nrun: {%s}\nstages:\n"
        "- {name: compact, end: {held: 5 %%, time: 6 ms}}\n"
        "- {name: bond, bonds: {enabled: on, interaction_range: 0.02}, end: {time: 0.5 ms}}\n"
        "- {name: load, periodic: {z: {rate: -2}}, end: {time: 10 ms}}\n",
        run);
    return s;
}

static void a_box_is_compacted_bonded_and_loaded(void **state) {
    (void)state;
    gn_run *run = run_of("%s", programme("threads: 1"));
    gneiss_error error = {0};
    while (!run->finished)
        if (gn_run_advance(run, 1e3, NULL, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const gn_history *h = &run->history;
    const double *residual = gn_history_column(h, "energy_residual"),
                 *strain = gn_history_column(h, "strain"), *box = gn_history_column(h, "box_z"),
                 *xx = gn_history_column(h, "stress_xx");
    size_t last = h->row_count - 1, loaded = (size_t)run->world.stages.state[2].row;
    for (size_t r = 0; r < h->row_count; r++) assert_near(residual[r], 0.0, 0.01);
    assert_true(run->world.dem.broken_tension + run->world.dem.broken_shear > 0);
    /* 10 ms at -2 1/s. */
    assert_near(box[last] / box[loaded], exp(-0.02), 1e-4);
    /* The mean stress on the lateral sides over the stage: a servo lags behind the strain of the
     * box by at most the response of the listed contacts to one step, 1e9 Pa times 5e-6. */
    double sum = 0.0;
    for (size_t r = loaded; r <= last; r++) sum -= xx[r] / (double)(last + 1 - loaded);
    assert_near(sum, 5e4, 5e3);
    double left = 1.0;
    for (int a = 0; a < 3; a++) left *= run->world.ctx.period[a] / 8.66e-3;
    assert_near(strain[last], 1.0 - left, 1e-4);
    assert_int_equal(run->world.stages.now, 2);
    run_end(run);
}

/* Runs a scene and checks that over the last tenth of the rows the mean stress along x has the
 * target value to 2 % of the lag and the oscillation. */
static void stress_held_to_the_end(const char *scene, double wanted) {
    gneiss_error error = {0};
    gn_run *run = run_of("%s", scene);
    while (!run->finished)
        if (gn_run_advance(run, 1e3, NULL, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const double *residual = gn_history_column(&run->history, "energy_residual"),
                 *xx = gn_history_column(&run->history, "stress_xx");
    const size_t rows = run->history.row_count;
    for (size_t r = 0; r < rows; r++) assert_near(residual[r], 0.0, 0.01);
    double mean = 0.0;
    for (size_t r = rows - rows / 10; r < rows; r++) mean -= xx[r] / (double)(rows / 10);
    assert_near(mean, wanted, 0.02 * wanted);
    run_end(run);
}

/* Contacts that stiffen with the overlap, with dashpots and rolling resistance, under gravity. */
static void a_box_holds_the_stress_of_hertzian_grains(void **state) {
    (void)state;
    stress_held_to_the_end(
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 1.01, jitter: "
        "0.02}}\n"
        "materials: [{name: m, density: 2000, young: 70 MPa, poisson: 0.25, friction: 0.3, "
        "restitution: 0.5, rolling_friction: 0.1}]\n"
        "law: {stiffness: hertz}\nrun: {threads: 1}\ngravity: [0, 0, -9.81]\n"
        "periodic: {min: [0, 0, 0], max: [8.57 mm, 8.57 mm, 8.57 mm], x: {stress: 50 kPa, "
        "max_rate: 50, relaxation: 1}, y: {stress: 50 kPa, max_rate: 50, relaxation: 1}, z: {rate: "
        "-2}}\ntime: {end: 20 ms}\noutput: {history_rows: 400, snapshots: 0}\n",
        5e4);
}

/* Discs with bonds that resist bending, pulled apart along y at 35 ms. Breaking bonds cause
 * vibrations. */
static void a_box_holds_the_stress_of_bonded_discs_while_they_break(void **state) {
    (void)state;
    stress_held_to_the_end(
        "dimension: 2\n"
        "specimen: {lattice: {kind: hexagonal, radius: 1 mm, cells: [8, 5], spacing: 1.01, jitter: "
        "0.03}, group: 1}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 50, bond_shear_limit: 100}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.05, radius_multiplier: 0.5}\n"
        "damping: {contact: {fraction: 0.2}}\nrun: {threads: 1}\n"
        "periodic: {min: [0, 0], max: [16.16 mm, 17.4937 mm], x: {stress: 10 kPa, max_rate: 50, "
        "relaxation: 1}, y: {rate: 1}}\n"
        "time: {end: 60 ms}\noutput: {history_rows: 400, snapshots: 0}\n",
        1e4);
}

static uint64_t hash_after(const char *scene, int64_t count) {
    gn_run *run = run_of("%s", scene);
    steps(run, count);
    uint64_t hash = gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                                  &run->world.solids, &run->world.box);
    assert_int_equal(run->world.stages.now, 2); /* all stages were run */
    run_end(run);
    return hash;
}

static void threads_do_not_matter(void **state) {
    (void)state;
    uint64_t one = hash_after(programme("threads: 1"), 6000);
    assert_true(one == hash_after(programme("threads: 2"), 6000));
}

/* The box's servo uses sums that are formed contact by contact. */
static void instruction_sets_do_not_matter(void **state) {
    (void)state;
    const uint64_t plain = hash_after(programme("threads: 1, isa: scalar"), 6000);
    assert_true(plain == hash_after(programme("threads: 3"),
                                    6000)); /* the instruction set is the best available one */
}

static void a_resumed_box_has_the_same_bits(void **state) {
    (void)state;
    char path[] = "/tmp/gneiss_box_XXXXXX";
    gneiss_error error = {0};
    close(mkstemp(path));
    gn_run *run = run_of("%s", programme("threads: 1"));
    for (int k = 0; k < 5; k++) {
        steps(run, 1187);
        if (gn_checkpoint_write(run, path, &error) != GNEISS_OK) fail_msg("%s", error.message);
        run_end(run);
        run = calloc(1, sizeof *run);
        if (gn_run_load(path, NULL, 0, run, &error) != GNEISS_OK) fail_msg("%s", error.message);
    }
    assert_true(gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                              &run->world.solids,
                              &run->world.box) == hash_after(programme("threads: 1"), 5 * 1187));
    run_end(run);
    unlink(path);
}

/* --- an axis without sides --- */

/* Two discs near opposite sides, both pressed through the open side and, with the two exchanged,
 * through the other one. */
static void along_an_open_axis_there_are_no_images(void **state) {
    (void)state;
    static const char *const open[] = {"none", "y"}, *const precision[] = {"double", "mixed"};
    for (int k = 0; k < 4; k++) {
        gn_world *w = world_of(
            "dimension: 2\n"
            "specimen: {particles: [[2 mm, 0.5 mm, 1 mm], [2 mm, 9.8 mm, 1 mm], [9.6 mm, 5 mm, 1 "
            "mm], [0.5 mm, 5 mm, 1 mm]]}\n"
            "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0}]\n"
            "law: {stiffness: uniform}\nrun: {threads: 1, precision: %s}\ntime: {end: 1}\n"
            "periodic: {min: [0, 0], max: [10 mm, 10 mm], open: %s}\n",
            precision[k / 2], open[k % 2]);
        run_steps(w, 10);
        assert_true((vel_of(w, 0)[1] > 0.0) == (k % 2 == 0));
        assert_true(vel_of(w, 2)[0] < 0.0 && vel_of(w, 3)[0] > 0.0);
        assert_near(w->ctx.volume, k % 2 ? 10e-3 * 11.3e-3 : 1e-4, 1e-15);
        world_end(w);
    }
}

/* Grains that fall into a chute with periodic sides pass through them any number of times. */
static void a_seam_is_none_where_the_box_is_open_across_it(void **state) {
    (void)state;
    gn_world *w[2];
    for (int k = 0; k < 2; k++) {
        w[k] = world_of(
            "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 1.02, "
            "jitter: "
            "0.02, origin: [%g, 0, 1 mm]}}\n"
            "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: "
            "0.3}]\n"
            "law: {stiffness: uniform}\nrun: {threads: 1}\ngravity: [300, 0, -900]\n"
            "walls: [{name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5}]\n"
            "periodic: {min: [0, 0, 0], max: [8.66 mm, 8.66 mm, 1], open: z}\ntime: {end: 1}\n",
            k ? 3e-3 : 0.0);
        run_steps(w[k], 1000);
        measured_step(w[k]);
    }
    assert_true(w[0]->boundary.walls[0].force[2] != 0.0);
    for (size_t p = 0; p < w[0]->dem.particles.soa.count; p++)
        for (int a = 0; a < 3; a++)
            assert_near(vel_of(w[0], (int)p)[a], vel_of(w[1], (int)p)[a], 1e-9);
    for (int k = 0; k < 2; k++) world_end(w[k]);
}

/* A layer between a driven one and a loaded one: friction, slip through the periodic sides, in
 * double and in single precision; threads, an interruption. */
static void a_layer_that_is_sheared_has_the_same_bits(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        gn_run *run[2];
        for (int k = 0; k < 2; k++)
            run[k] = run_of(
                "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 4], spacing: 1.01, "
                "jitter: 0.05}}\n"
                "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: "
                "0.3}]\nlaw: {stiffness: uniform}\n"
                "damping: {background: {model: nonviscous_vector, coefficient: 0.3}}\n"
                "periodic: {min: [0, 0, 0], max: [8.57 mm, 8.57 mm, 1], open: z}\n"
                "sets: [{name: below, select: {end: {axis: z, side: lower, depth: 1.5 mm}}, "
                "motion: "
                "{vx: 0, vy: 0, vz: 0}}, {name: above, select: {end: {axis: z, side: upper, depth: "
                "1.5 mm}}, force: [0, 0, -5], motion: {vx: 5, vy: 0}}]\n"
                "test: {kind: simple_shear, axis: x, normal: z, lower: below, upper: above}\n"
                "time: {end: 1}\nrun: {threads: %d, precision: %s}\n",
                1 + k, mixed ? "mixed" : "double");
        end_alike(run[0], run[1], 1500, 500, 0.01);
    }
}

/* --- refused input --- */

static void expect_refused(const char *sides, const char *more, const char *message) {
    text *t = calloc(1, sizeof *t);
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    add(t,
        "specimen: {particles: [[3 mm, 4 mm, 5 mm, 1 mm]]}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0}]\n"
        "law: {stiffness: uniform}\ntime: {end: 1}\n%s\n"
        "periodic: {min: [0, 0, 0], max: [10 mm, 11 mm, 12 mm], %s}\n",
        more, sides);
    assert_int_equal(world_try(w, t->s, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, message)) fail_msg("%s", error.message);
    free(t);
    free(w);
}

static void keys_of_a_box_that_exclude_each_other_are_refused(void **state) {
    (void)state;
    expect_refused("x: {stress: 1 MPa}", "", "periodic.x.max_rate: required beside stress");
    expect_refused("x: {stress: 1 MPa, max_rate: 1, rate: 3}", "",
                   "periodic.x: expected stress or rate, found both");
    expect_refused("x: {stress: 1 m, max_rate: 1}", "", "periodic.x.stress");
    expect_refused("x: {stress: 1, max_rate: 0}", "", "periodic.x.max_rate");
    expect_refused("x: {stress: 1, max_rate: 1, relaxation: 2}", "", "periodic.x.relaxation");
    expect_refused("x: {max_rate: 1}", "",
                   "periodic.x.max_rate: expected stress (a servo) for this side");
    expect_refused("x: {rate: 1, max_rate: 1}", "",
                   "periodic.x.max_rate: expected stress (a servo) for this side, found a rate");
    expect_refused("y: {relaxation: 0.1}", "",
                   "periodic.y.relaxation: expected stress (a servo) for this side, found none");
    expect_refused("y: {rate: 1, relaxation: 0.5}", "",
                   "periodic.y.relaxation: expected stress (a servo) for this side, found a rate");
    expect_refused("z: {}", "", "periodic.z: expected stress or rate, found neither");
    expect_refused("x: {rate: 1e9}", "", "periodic.x.rate");
    expect_refused("z: {rate: 1}",
                   "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5}]",
                   "s.yaml:6:1: periodic: expected only particles in a box whose sides move, "
                   "found walls");
    expect_refused("z: {rate: 1}", "sets: [{name: s, select: {all: true}, motion: {vx: 1}}]",
                   "found a set whose motion is prescribed");
    expect_refused("z: {rate: 1}", "run: {precision: mixed}", "run.precision: expected double");
}

static void a_rate_that_a_step_cannot_resolve_stops_the_run(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world *w = crystal(0, 0, 0, "x: {rate: -1e4}", "");
    assert_int_equal(gn_world_step(w, true, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "periodic.x.rate: expected a strain of at most 0.001"));
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lattice_follows_a_uniform_strain_as_a_whole),
        cmocka_unit_test(there_is_no_seam),
        cmocka_unit_test(a_free_particle_keeps_its_speed_in_units_of_the_box),
        cmocka_unit_test(a_mean_stress_is_held_whatever_the_relaxation),
        cmocka_unit_test(a_stress_is_held_while_another_side_moves_on),
        cmocka_unit_test(sides_hold_the_mean_stress_while_another_one_moves),
        cmocka_unit_test(a_servo_is_stable_at_the_limit_of_the_step),
        cmocka_unit_test(a_box_is_compacted_bonded_and_loaded),
        cmocka_unit_test(a_box_holds_the_stress_of_hertzian_grains),
        cmocka_unit_test(a_box_holds_the_stress_of_bonded_discs_while_they_break),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(instruction_sets_do_not_matter),
        cmocka_unit_test(a_resumed_box_has_the_same_bits),
        cmocka_unit_test(along_an_open_axis_there_are_no_images),
        cmocka_unit_test(a_seam_is_none_where_the_box_is_open_across_it),
        cmocka_unit_test(a_layer_that_is_sheared_has_the_same_bits),
        cmocka_unit_test(keys_of_a_box_that_exclude_each_other_are_refused),
        cmocka_unit_test(a_rate_that_a_step_cannot_resolve_stops_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
