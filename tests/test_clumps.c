/* Rigid clumps: mass, free motion, collisions, ledger, and what is refused. */
#include "clump_helpers.h"

#include "base/rotation.h"
#include "particles/clumps.h"
#include "run/run.h"

/* --- clumps in a scene --- */

#define HEAD                                                                                       \
    "dimension: 3\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "        \
    "friction: %g}]\nlaw: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"     \
    "run: {threads: %d}\n"
#define SHAPES                                                                                     \
    "clumps:\n  shapes:\n    - {name: a, spheres: [[0, 0, 0, 0.01], [0.012, 0, 0, 0.008], [0, "    \
    "0.009, 0.004, 0.007]]}\n    - {name: b, spheres: [[0, 0, 0, 0.01], [0.013, 0, 0, 0.01]]}\n"

static const gn_clump *clump(const gn_world *w, int k) {
    return &w->dem.clumps.clump[k];
}

static void add_momenta(const gn_world *w, double linear[3], double angular[3]) {
    memset(linear, 0, 3 * sizeof *linear);
    memset(angular, 0, 3 * sizeof *angular);
    for (size_t k = 0; k < w->dem.clumps.count; k++) {
        const gn_clump *c = &w->dem.clumps.clump[k];
        double p[3], l[3];
        for (int a = 0; a < 3; a++) p[a] = c->mass * c->velocity[a];
        cross3(c->position, p, l);
        for (int a = 0; a < 3; a++) {
            linear[a] += p[a];
            angular[a] += l[a] + c->momentum[a];
        }
    }
}

static void the_mass_of_a_clump_is_that_of_the_union(void **state) {
    (void)state;
    gn_world *w = world_of(HEAD SHAPES "  placed: [{shape: b, centre: [0, 0, 0], rotation: [0, 0, "
                                       "1.5707963267948966]}]\ntime: {end: 1}\n",
                           0.5, 1);
    double sum[4];
    chain(2, (const double[][2]){{0.0, 0.01}, {0.013, 0.01}}, sum);
    assert_close(clump(w, 0)->mass, 2500 * sum[0], 1e-12);
    assert_close(w->dem.mass, 2500 * sum[0], 1e-12);
    assert_int_equal(w->dem.particles.soa.count, 2);
    assert_int_equal(w->dem.pairs.contacts.soa.count, 0); /* no contact within the clump */
    for (int k = 0; k < 2; k++) {
        assert_near(pos_of(w, k)[0], 0.0, 1e-17);
        assert_near(pos_of(w, k)[1], k ? 0.0065 : -0.0065, 1e-16);
    }
    world_end(w);
}

/* The quadratic form of the members' shares is at most that of the clump, in any rigid motion, and
 * equal in one of them. */
static void shares_of_members_are_below_the_clump(void **state) {
    (void)state;
    gn_world *w =
        world_of(HEAD SHAPES "  placed: [{shape: a, centre: [0, 0, 0]}]\ntime: {end: 1}\n", 0.5, 1);
    const gn_clump *c = clump(w, 0);
    uint64_t at = 0;
    double most = 0.0;
    for (int n = 0; n < 20000; n++) {
        double v[3], s[3], local[3], members = 0.0, whole = 0.0;
        for (int a = 0; a < 3; a++) {
            v[a] = uniform(&at, -1, 1);
            s[a] = uniform(&at, -200, 200);
        }
        gn_axes_local(c->axes, s, local);
        for (int a = 0; a < 3; a++)
            whole += c->mass * v[a] * v[a] + c->inertia[a] * local[a] * local[a];
        for (int k = 0; k < 3; k++) {
            double arm[3], u[3];
            for (int a = 0; a < 3; a++) arm[a] = pos_of(w, k)[a] - c->position[a];
            cross3(s, arm, u);
            for (int a = 0; a < 3; a++) u[a] += v[a];
            members += dot3(u, u) / vel_of(w, k)[3] + dot3(s, s) / spin_of(w, k)[3];
        }
        most = fmax(most, members / whole);
    }
    assert_true(most <= 1.0 + 1e-12 && most > 0.95);
    world_end(w);
}

static void a_free_clump_keeps_energy_and_momentum(void **state) {
    (void)state;
    gn_world *w =
        world_of(HEAD SHAPES "  placed: [{shape: a, centre: [0, 0, 0], velocity: [0.1, "
                             "0.2, 0], spin: [30, -20, 45]}]\ntime: {step: 5e-5, end: 9}\n",
                 0.5, 1);
    double start[2][3], now[2][3], apart[3];
    add_momenta(w, start[0], start[1]);
    gn_energy e = measured_step(w);
    const double first = e.rotational;
    assert_true(first > 0.0);
    for (int n = 0; n < 20000; n++) {
        e = measured_step(w);
        assert_near(e.rotational / first, 1.0, 2e-6);
    }
    add_momenta(w, now[0], now[1]);
    for (int a = 0; a < 3; a++) {
        assert_near(now[0][a], start[0][a], 1e-15 * length3(start[0]));
        assert_near(clump(w, 0)->momentum[a], start[1][a], 0.0);
        apart[a] = pos_of(w, 0)[a] - pos_of(w, 1)[a];
    }
    assert_close(length3(apart), 0.012, 1e-12);
    world_end(w);
}

/* Two clumps, each with spin, hit each other off the centre, with friction. */
static gn_world *collision(double dt, const char *more, int threads) {
    return world_of(HEAD SHAPES
                    "  placed:\n    - {shape: a, centre: [-0.02, 0, 0], velocity: [1, 0.1, 0], "
                    "spin: [10, -5, 20], rotation: [0.3, 0.2, 0.1]}\n    - {shape: b, centre: "
                    "[0.02, 0.006, 0.002], velocity: [-1, 0, 0.05], spin: [0, 8, -9], rotation: "
                    "[0, 0.4, -0.8]}\n%stime: {step: %g, end: 9}\n",
                    0.5, threads, more, dt);
}

static void a_collision_keeps_momentum(void **state) {
    (void)state;
    gn_world *w = collision(2e-6, "damping: {contact: {restitution: 0.6}}\n", 1);
    double start[2][3], now[2][3];
    add_momenta(w, start[0], start[1]);
    const double speed = clump(w, 0)->velocity[0], linear = clump(w, 0)->mass,
                 angular = 0.02 * linear;
    double residual = 0.0;
    bool touched = false;
    for (int n = 0; n < 10000; n++) {
        gn_energy e = measured_step(w);
        touched |= e.elastic_normal > 0.0;
        residual = fmax(residual, fabs(gn_energy_residual(&e)));
    }
    add_momenta(w, now[0], now[1]);
    for (int a = 0; a < 3; a++) {
        assert_near(now[0][a], start[0][a], 1e-13 * linear);
        assert_near(now[1][a], start[1][a], 1e-13 * angular);
    }
    assert_true(touched && fabs(clump(w, 0)->velocity[0] - speed) > 0.1);
    assert_true(residual < 1e-3);
    world_end(w);
}

/* Errors of the energy are of second order in the step. */
static void the_ledger_closes_with_the_square_of_the_step(void **state) {
    (void)state;
    double worst[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        const double dt = k ? 1e-6 : 4e-6;
        gn_world *w = collision(dt, "", 1);
        for (int n = 0; n < (int)(0.02 / dt); n++) {
            gn_energy e = measured_step(w);
            worst[k] = fmax(worst[k], fabs(gn_energy_residual(&e)));
        }
        world_end(w);
    }
    assert_true(worst[0] < 1e-3);
    assert_true(worst[1] < worst[0] / 6.0);
}

static void gravity_damping_and_walls_close_the_ledger(void **state) {
    (void)state;
    static const char *const damping[] = {
        "", "damping: {background: {model: viscous, coefficient: 20}}\n",
        "damping: {background: {model: nonviscous_vector, coefficient: 0.2}}\n",
        ("damping: {background: {model: nonviscous_component, coefficient: 0.2, velocity: "
         "instant}, contact: {restitution: 0.5}}\n")};
    for (int k = 0; k < 4; k++) {
        gn_world *w = world_of(
            HEAD SHAPES "  placed: [{shape: a, centre: [0, 0, 0.03], spin: [3, 40, 1]}, {shape: b, "
                        "centre: [0.003, 0, 0.07]}]\n%sgravity: [0, 0, -9.81]\nwalls: [{name: f, "
                        "point: [0, 0, 0], normal: [0.1, 0, 1], stiffness: 1e6, kratio: 2, "
                        "friction: 0.4}]\ntime: {end: 9}\n",
            0.5, 1, damping[k]);
        double residual = 0.0;
        while (w->ctx.time < 0.15) {
            gn_energy e = measured_step(w);
            residual = fmax(residual, fabs(gn_energy_residual(&e)));
        }
        assert_true(fabs(w->ledger.reading.work_gravity) > 0.0);
        assert_true(residual < 5e-3);
        world_end(w);
    }
}

static void threads_do_not_change_a_bit(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of(
            HEAD SHAPES "  filled: [{shapes: [a, b], box: {min: [0, 0, 0], max: [0.16, 0.16, "
                        "0.4]}, count: 150}]\ngravity: [0, 0, -9.81]\nwalls: [{name: f, point: "
                        "[0, 0, 0], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, friction: "
                        "0.4}]\ntime: {end: 9}\n",
            0.5, k ? 3 : 1);
        run_steps(w, 400);
        hash[k] = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
        world_end(w);
    }
    assert_true(hash[0] == hash[1]);
}

static void random_clumps_do_not_touch(void **state) {
    (void)state;
    gn_world *w = world_of(HEAD SHAPES "  filled: [{shapes: [a, b], box: {min: [0, 0, 0], max: "
                                       "[0.16, 0.16, 0.4]}, count: 150}]\ntime: {end: 9}\n",
                           0.5, 1);
    const gn_particles *q = &w->dem.particles;
    assert_int_equal(w->dem.clumps.count, 150);
    for (size_t i = 0; i < q->soa.count; i++)
        for (size_t j = i + 1; j < q->soa.count; j++) {
            double d[3];
            if (q->clump[i] == q->clump[j]) continue;
            for (size_t a = 0; a < 3; a++) d[a] = q->pos[4 * i + a] - q->pos[4 * j + a];
            assert_true(length3(d) >= q->pos[4 * i + 3] + q->pos[4 * j + 3]);
        }
    world_end(w);
}

/* A clump that crosses the sides of a periodic box again and again stays in one piece, and hits
 * another one as it does without a box. */
static void a_periodic_box_does_not_tear_clumps(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
        "friction: 0.5}]\nlaw: {stiffness: uniform}\nperiodic: {min: [0, 0, 0], max: [0.1, 0.1, "
        "0.1]}\nrun: {threads: 1}\n" SHAPES "  placed: [{shape: a, centre: [0.09, 0.05, 0.05], "
        "velocity: [9, 0, 0], spin: [0, 100, 0]}, {shape: b, centre: [0.04, 0.052, 0.05]}]\n"
        "time: {step: 2e-6, end: 9}\n");
    double start[2][3], now[2][3], residual = 0.0;
    add_momenta(w, start[0], start[1]);
    for (int n = 0; n < 20000; n++) {
        gn_energy e = measured_step(w);
        residual = fmax(residual, fabs(gn_energy_residual(&e)));
    }
    add_momenta(w, now[0], now[1]);
    for (int a = 0; a < 3; a++) assert_near(now[0][a], start[0][a], 1e-12 * length3(start[0]));
    assert_true(residual < 2e-3 && clump(w, 1)->velocity[0] != 0.0);
    for (int a = 0; a < 3; a++) {
        const double d = pos_of(w, 0)[a] - pos_of(w, 1)[a];
        now[0][a] = d - 0.1 * nearbyint(d / 0.1);
    }
    assert_close(length3(now[0]), 0.012, 1e-10);
    world_end(w);
}

/* --- a clump and a body of the same shape --- */

enum { RINGS = 80, SIDES = 48 };

/* Writes the surface of two equal balls on the x axis as a closed surface of revolution. */
static void write_dumbbell(const char *path, double r, double d) {
    FILE *f = fopen(path, "w");
    double x[RINGS + 1], y[RINGS + 1];
    assert_non_null(f);
    const double most = pi - acos(0.5 * d / r);
    for (int k = 0; k <= RINGS; k++) {
        const int half = RINGS / 2;
        const double angle = most * (k <= half ? k : RINGS - k) / half;
        x[k] = (k <= half ? -0.5 * d - r * cos(angle) : 0.5 * d + r * cos(angle));
        y[k] = r * sin(angle);
    }
    y[0] = y[RINGS] = 0.0;
    fprintf(f, "solid s\n");
    for (int k = 0; k < RINGS; k++)
        for (int s = 0; s < SIDES; s++)
            for (int half = 0; half < 2; half++) {
                const int ring[2][3] = {{k, k + 1, k + 1}, {k, k + 1, k}},
                          side[2][3] = {{s, s, s + 1}, {s, s + 1, s + 1}};
                if ((half == 0 && k == RINGS - 1) || (half == 1 && k == 0)) continue;
                fprintf(f, "facet normal 0 0 0\nouter loop\n");
                for (int c = 0; c < 3; c++) {
                    const double a = 2.0 * pi * (side[half][c] % SIDES) / SIDES;
                    const int n = ring[half][c];
                    fprintf(f, "vertex %.17g %.17g %.17g\n", x[n], y[n] * cos(a), y[n] * sin(a));
                }
                fprintf(f, "endloop\nendfacet\n");
            }
    fprintf(f, "endsolid s\n");
    fclose(f);
}

#define DROP                                                                                       \
    "dimension: 3\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e9, kratio: 2}]\n"      \
    "law: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\nrun: {threads: 1}\n"  \
    "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e9}]\n"

/* A dumbbell hits a wall with one end; the impulse on a rigid body without friction is 2 v/(1/m +
 * x2/I), x the horizontal distance of the lowest point from the centre. */
static void a_clump_and_a_body_rebound_alike(void **state) {
    (void)state;
    const double r = 0.01, d = 0.014, tilt = 0.5, v = 1.0;
    char folder[] = "/tmp/gneiss-clumps-XXXXXX", path[64], scene[2048];
    gneiss_error error = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/dumbbell.stl", folder);
    write_dumbbell(path, r, d);
    double sum[4];
    chain(2, (const double[][2]){{0.0, r}, {d, r}}, sum);
    const double mass = 2500 * sum[0], middle = sum[1] / sum[0],
                 inertia = 2500 * (sum[2] - sum[1] * middle + sum[3]), x = 0.5 * d * cos(tilt),
                 impulse = 2.0 * v / (1.0 / mass + x * x / inertia);
    gn_world *w = world_of(DROP "clumps:\n  shapes: [{name: a, spheres: [[0, 0, 0, %g], [%g, 0, 0, "
                                "%g]]}]\n  placed: [{shape: a, centre: [0, 0, 0.014], rotation: "
                                "[0, %g, 0], velocity: [0, 0, %g]}]\ntime: {end: 9}\n",
                           r, d, r, tilt, -v);
    run_until(w, 2e-3);
    assert_near(clump(w, 0)->velocity[2], impulse / mass - v, 0.01);
    assert_near(clump(w, 0)->spin[1] * inertia, -x * impulse, 0.01 * x * impulse);
    snprintf(scene, sizeof scene,
             DROP
             "specimen: {particles: [[5, 0, 0.01, 0.01]], group: 0}\nbodies: [{name: b, "
             "surface: dumbbell.stl, origin: [0, 0, 0.014], rotation: [0, %g, 0], density: "
             "2500, free: true, stiffness: 1e10, initial_velocity: [0, 0, %g]}]\ntime: {end: 9}\n",
             tilt, -v);
    gn_world *other = calloc(1, sizeof *other);
    assert_ok(world_try(other, scene, folder, &error), &error);
    run_until(other, 2e-3);
    const gn_rigid *b = &other->boundary.bodies[0];
    assert_near(b->velocity[2], clump(w, 0)->velocity[2], 0.01);
    assert_near(b->spin[1], clump(w, 0)->spin[1], 0.01 * fabs(b->spin[1]));
    world_end(w);
    world_end(other);
    unlink(path);
    rmdir(folder);
}

/* A filled surface has the mass of the surface, and its spheres are inside. */
static void a_filled_surface_keeps_its_mass(void **state) {
    (void)state;
    char folder[] = "/tmp/gneiss-clumps-XXXXXX", path[64];
    gneiss_error error = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/dumbbell.stl", folder);
    write_dumbbell(path, 1.0, 1.4);
    gn_world *w = calloc(1, sizeof *w);
    assert_ok(world_try(w,
                        "dimension: 3\nmaterials: [{name: m, density: 1000, normal_stiffness: 1e6, "
                        "kratio: 2}]\nlaw: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: "
                        "[9, 9, 9]}\nclumps:\n  shapes: [{name: a, surface: dumbbell.stl, scale: "
                        "0.01, spheres: 6}]\n  placed: [{shape: a, centre: [0, 0, 0]}]\ntime: "
                        "{end: 1}\n",
                        folder, &error),
              &error);
    double sum[4], covered[6][4];
    chain(2, (const double[][2]){{0.0, 0.01}, {0.014, 0.01}}, sum);
    assert_near(clump(w, 0)->mass / (1000 * sum[0]), 1.0, 0.01); /* of the facets */
    assert_int_equal(w->dem.particles.soa.count, 6);
    for (int k = 0; k < 6; k++) {
        memcpy(covered[k], pos_of(w, k), sizeof covered[k]);
        const double out = fmax(0.0, fabs(covered[k][0]) - 0.007),
                     at[3] = {out, covered[k][1], covered[k][2]};
        assert_true(length3(at) + covered[k][3] < 0.01 * (1.0 + 1e-9) || out == 0.0);
    }
    assert_true(union_of(covered[0], 6, 3).volume > 0.97 * sum[0]);
    world_end(w);
    unlink(path);
    rmdir(folder);
}

/* --- the plane --- */

static void clumps_of_discs_move_in_the_plane(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
        "friction: 0.5}]\nlaw: {stiffness: uniform}\ndomain: {min: [-9, -9], max: [9, 9]}\nrun: "
        "{threads: 1}\nclumps:\n  shapes: [{name: a, spheres: [[0, 0, 0.01], [0.012, 0, 0.008]]}]\n"
        "  placed: [{shape: a, centre: [-0.02, 0], velocity: [1, 0], spin: 10}, {shape: a, centre: "
        "[0.02, 0.004], rotation: 1}]\ntime: {step: 2e-6, end: 9}\n");
    double start[2][3], now[2][3], residual = 0.0;
    add_momenta(w, start[0], start[1]);
    for (int n = 0; n < 10000; n++) {
        gn_energy e = measured_step(w);
        residual = fmax(residual, fabs(gn_energy_residual(&e)));
    }
    add_momenta(w, now[0], now[1]);
    for (int a = 0; a < 2; a++) assert_near(now[0][a], start[0][a], 1e-13 * length3(start[0]));
    assert_near(now[1][2], start[1][2], 1e-13 * fabs(clump(w, 0)->mass * 0.02));
    assert_true(clump(w, 1)->velocity[0] > 0.1 && residual < 1e-3);
    assert_true(clump(w, 0)->position[2] == 0.0 && clump(w, 0)->momentum[0] == 0.0);
    world_end(w);
}

/* --- what is refused --- */

static void what_clumps_cannot_be_combined_with_is_named(void **state) {
    (void)state;
    static char scene[4096];
    snprintf(scene, sizeof scene,
             HEAD SHAPES "  placed: [{shape: a, centre: [0, 0, 0]}]\ntime: {end: 1}\n", 0.5, 1);
    static const char *const cases[][2] = {
        {"time: {end: 1}\nsets: [{name: s, select: {all: true}}]\n", "without sets"},
        {"time: {end: 1}\nsinks: [{name: s, plane: {point: [0, 0, -5], normal: [0, 0, -1]}}]\n",
         "without sinks"},
        {"time: {end: 1, mass_scaling: {factor: 2}}\n", "without time.mass_scaling"},
        {"time: {end: 1}\ninitial: {random_velocity: 1}\n", "without initial.random_velocity"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        assert_change_refused(scene, "time: {end: 1}\n", cases[k][0], cases[k][1]);
    assert_change_refused(scene, "stiffness: uniform", "stiffness: uniform, rotation: off",
                          "without law.rotation: off");
    assert_change_refused(scene, "shape: a", "shape: c", "name of a shape of clumps, found 'c'");
    assert_change_refused(scene, "name: b", "name: a", "unique name");
    assert_change_refused(scene, "placed: [{shape: a, centre: [0, 0, 0]}]", "placed: []",
                          "expected placed, filled or file in it");
    assert_change_refused(scene, "placed: [{shape: a, centre: [0, 0, 0]}]",
                          "filled: [{shapes: a, box: {min: [0, 0, 0], max: [0.05, 0.05, 0.05]}, "
                          "count: 900}]",
                          "clumps.filled[0].count: expected at most some");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mass_of_a_clump_is_that_of_the_union),
        cmocka_unit_test(shares_of_members_are_below_the_clump),
        cmocka_unit_test(a_free_clump_keeps_energy_and_momentum),
        cmocka_unit_test(a_collision_keeps_momentum),
        cmocka_unit_test(the_ledger_closes_with_the_square_of_the_step),
        cmocka_unit_test(gravity_damping_and_walls_close_the_ledger),
        cmocka_unit_test(threads_do_not_change_a_bit),
        cmocka_unit_test(random_clumps_do_not_touch),
        cmocka_unit_test(a_periodic_box_does_not_tear_clumps),
        cmocka_unit_test(a_clump_and_a_body_rebound_alike),
        cmocka_unit_test(a_filled_surface_keeps_its_mass),
        cmocka_unit_test(clumps_of_discs_move_in_the_plane),
        cmocka_unit_test(what_clumps_cannot_be_combined_with_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
