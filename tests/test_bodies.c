/* Rigid bodies: mass, motion, and contact with particles. */
#include "surface_helpers.h"

#include "boundary/overlap.h"
#include "boundary/surface.h"
#include "run/run.h"

/* One far particle, so that there is a specimen. */
static const char head[] =
    "dimension: 3\nspecimen: {particles: [[50, 0, 0, 1]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
    "run: {threads: 1}\n";
static const char head2[] =
    "dimension: 2\nspecimen: {particles: [[50, 0, 1]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-99, -99], max: [99, 99]}\nrun: {threads: 1}\n";

static void step(gn_world *w) {
    measured_step(w);
}

/* --- mass and inertia --- */

static int by_size(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

static void weighs(const gn_rigid *b, double mass, double ix, double iy, double iz) {
    double want[3] = {ix, iy, iz}, got[3];
    memcpy(got, b->inertia, sizeof got);
    qsort(want, 3, sizeof *want, by_size);
    qsort(got, 3, sizeof *got, by_size);
    assert_close(b->mass, mass, 1e-12);
    for (int k = 0; k < 3; k++) assert_close(got[k], want[k], 1e-12);
}

static void a_box_weighs_what_it_should(void **state) {
    (void)state;
    gn_world *w = world_of("%sbodies: [{name: b, box: {size: [1, 2, 3]}, origin: [5, 6, 7], "
                           "rotation: [0.3, 0.4, -0.7], stiffness: 1, free: true, density: 10}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head);
    const gn_rigid *b = &w->boundary.bodies[0];
    double m = 60.0, turn[9], half[3] = {0.5, 1.0, 1.5}, rotation[3] = {0.3, 0.4, -0.7};
    weighs(b, m, m * 13 / 12, m * 10 / 12, m * 5 / 12);
    gn_rotation_matrix(rotation, turn);
    for (int a = 0; a < 3; a++)
        assert_close(b->position[a], 5.0 + a + dot3(turn + 3 * a, half), 1e-12);
    assert_close(b->reach, length3(half), 1e-12);
    world_end(w);
}

/* A regular prism: I_z = m R^2 (2 + cos(2 pi/n))/6; across I = I_z/2 + m h^2/12. */
static void a_prism_weighs_what_it_should(void **state) {
    (void)state;
    gn_world *w = world_of("%sbodies: [{name: b, cylinder: {diameter: 2, height: 3, sides: 7}, "
                           "stiffness: 1, free: true, density: 10}]\ntime: {step: 1e-3, end: 1}\n",
                           head);
    double area = 3.5 * sin(2 * pi / 7), m = 10 * 3 * area, iz = m * (2 + cos(2 * pi / 7)) / 6;
    weighs(&w->boundary.bodies[0], m, iz, iz / 2 + m * 9 / 12, iz / 2 + m * 9 / 12);
    assert_close(w->boundary.bodies[0].position[2], 1.5, 1e-12);
    world_end(w);
}

/* An L of three unit squares: centre (5/6, 5/6), polar moment 3/6 + 3 squares' distances. */
static void a_polygon_weighs_what_it_should(void **state) {
    (void)state;
    const char *const senses[] = {"[[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]",
                                  "[[0, 2], [1, 2], [1, 1], [2, 1], [2, 0], [0, 0]]"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of("%sbodies: [{name: b, polygon: %s, stiffness: 1, free: true, "
                               "density: 10}]\ntime: {step: 1e-3, end: 1}\n",
                               head2, senses[k]);
        const gn_rigid *b = &w->boundary.bodies[0];
        assert_close(b->mass, 30.0, 1e-12);
        assert_close(b->position[0], 5. / 6, 1e-12);
        assert_close(b->position[1], 5. / 6, 1e-12);
        double centres[3][2] = {{.5, .5}, {1.5, .5}, {.5, 1.5}}, polar = 0.5;
        for (int s = 0; s < 3; s++)
            for (int a = 0; a < 2; a++) polar += pow(centres[s][a] - 5. / 6, 2);
        assert_close(b->inertia[2], 10 * polar, 1e-12);
        world_end(w);
    }
}

/* --- how they move --- */

static void a_free_body_falls_exactly(void **state) {
    (void)state;
    gn_world *w = world_of("%sgravity: [1, 2, -10]\nbodies: [{name: b, box: {size: [1, 1, 1]}, "
                           "stiffness: 1, free: true, density: 10, initial_velocity: [3, 0, 4]}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head);
    for (int k = 0; k < 1000; k++) step(w);
    const double g[3] = {1, 2, -10}, v[3] = {3, 0, 4};
    for (int a = 0; a < 3; a++)
        assert_close(w->boundary.bodies[0].position[a], 0.5 + v[a] + 0.5 * g[a], 1e-12);
    assert_true(fabs(gn_energy_residual(&w->ledger.reading)) < 1e-12);
    world_end(w);
}

static void a_channel_may_be_prescribed(void **state) {
    (void)state;
    gn_world *w = world_of("%sgravity: [1, 2, -10]\nbodies: [{name: b, box: {size: [1, 1, 1]}, "
                           "stiffness: 1, free: true, density: 10, motion: {vz: 0.5, wx: 0, wy: "
                           "0, wz: 2}}]\ntime: {step: 1e-3, end: 1}\n",
                           head);
    for (int k = 0; k < 1000; k++) step(w);
    const gn_rigid *b = &w->boundary.bodies[0];
    assert_close(b->position[0], 0.5 + 0.5, 1e-12);
    assert_close(b->position[1], 0.5 + 1.0, 1e-12);
    assert_close(b->position[2], 0.5 + 0.5, 1e-12);
    assert_close(2.0 * atan2(b->turn[3], b->turn[0]), 2.0, 1e-12);
    assert_true(fabs(gn_energy_residual(&w->ledger.reading)) < 1e-12);
    world_end(w);
}

static void prescribed_spin_turns_about_the_reference_point(void **state) {
    (void)state;
    gn_world *w = world_of("%sbodies: [{name: b, box: {size: [1, 1, 1]}, reference: [2, 0, 0], "
                           "stiffness: 1, motion: {vy: 1, wz: 0.5}}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head);
    for (int k = 0; k < 1000; k++) step(w);
    double x[3];
    const gn_surface *s = &w->boundary.surfaces[0];
    gn_rigid_place(&w->boundary.bodies[0], s->facets.pos,
                   x); /* position of the corner that was at the origin */
    assert_close(x[0], 2.0 - 2.0 * cos(0.5), 1e-9);
    assert_close(x[1], 1.0 - 2.0 * sin(0.5), 1e-9);
    world_end(w);
}

/* A vertex relative to the reference point, rotated by the orientation in results.h5. */
static void turned_vertex(const gn_rigid *b, const double at_start[3], double out[3]) {
    double q[4], t[3], once[3];
    gn_rigid_orientation(b, q);
    assert_true(q[0] >= 0.0);
    cross3(q + 1, at_start, t);
    for (int a = 0; a < 3; a++) t[a] = 2.0 * t[a];
    cross3(q + 1, t, once);
    for (int a = 0; a < 3; a++) out[a] = at_start[a] + q[0] * t[a] + once[a];
}

/* The orientation of prescribed and free bodies, up to several rotations: the error is a few ulp of
 * each of at most 700 products. */
static void orientation_is_the_turn_from_the_start_at_every_angle(void **state) {
    (void)state;
    const char *const bodies[] = {"motion: {wx: 3, wy: -2, wz: 4}",
                                  "free: true, density: 10, initial_spin: [3, -2, 4]"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of("%sbodies: [{name: b, box: {size: [1, 2, 3]}, rotation: [0.3, 0.4, "
                               "-0.7], stiffness: 1, %s}]\ntime: {step: 5e-3, end: 100}\n",
                               head, bodies[k]);
        const gn_rigid *b = &w->boundary.bodies[0];
        double start[3], now[3], got[3];
        gn_rigid_direct(b, w->boundary.surfaces[0].facets.pos, start);
        for (int n = 0; n < 700; n++) {
            step(w);
            gn_rigid_direct(b, w->boundary.surfaces[0].facets.pos, now);
            turned_vertex(b, start, got);
            for (int a = 0; a < 3; a++) assert_true(fabs(got[a] - now[a]) < 1e-12);
        }
        world_end(w);
    }
}

static gn_world *top(const char *size, const char *spin, double dt) {
    return world_of("%sbodies: [{name: b, box: {size: [%s]}, stiffness: 1, free: true, density: "
                    "10, initial_spin: [%s]}]\ntime: {step: %.17g, end: 1000}\n",
                    head, size, spin, dt);
}

/* The largest deviation of the energy over a time, over the energy. */
static double energy_error(double dt, double time, double *late) {
    gn_world *w = top("1, 2, 3", "3, 0.01, 2", dt);
    double momentum[3], start = 0.0, worst = 0.0, before = 0.0;
    memcpy(momentum, w->boundary.bodies[0].momentum, sizeof momentum);
    int64_t steps = (int64_t)(time / dt + 0.5);
    for (int64_t k = 0; k < steps; k++) {
        gn_energy e = measured_step(w);
        if (k == 0) start = e.rotational;
        worst = fmax(worst, fabs(e.rotational / start - 1.0));
        if (k == steps / 2) before = worst;
    }
    *late = worst / before;
    for (int a = 0; a < 3; a++) assert_true(w->boundary.bodies[0].momentum[a] == momentum[a]);
    world_end(w);
    return worst;
}

/* The error is of second order for steps of less than 0.005 rad and of fourth order for longer
 * ones; that of the first half of 100 and 600 turns equals that of the second half. */
static void an_asymmetric_top_keeps_momentum_and_energy(void **state) {
    (void)state;
    const double dt[] = {1.25e-3, 0.02}, time[] = {30.0, 200.0}, most[] = {1e-5, 1e-6};
    for (int k = 0; k < 2; k++) {
        double late, coarse = energy_error(dt[k], time[k], &late);
        print_message("# %g s: %.3g\n", dt[k], coarse);
        assert_true(coarse < most[k] && late < 1.05);
        double fine = energy_error(0.5 * dt[k], time[k], &late);
        assert_true(late < 1.05);
        assert_near(coarse / fine, k == 0 ? 4.0 : 16.0, k == 0 ? 0.2 : 0.8);
    }
}

/* The axis of a symmetric top rotates about the momentum with L/I; returns the error of its
 * direction after a time. */
static double precession_error(double dt) {
    gn_world *w = top("1, 1, 3", "1, 0, 4", dt);
    const gn_rigid *b = &w->boundary.bodies[0];
    double l[3], size, axis[3], turned[3], vector[3], matrix[9];
    memcpy(l, b->momentum, sizeof l);
    size = length3(l);
    int heavy = 0; /* the axis of the least moment is that of symmetry */
    for (int k = 1; k < 3; k++)
        if (b->inertia[k] < b->inertia[heavy]) heavy = k;
    double across = b->inertia[(heavy + 1) % 3];
    for (int a = 0; a < 3; a++) axis[a] = b->axes[3 * a + heavy];
    int64_t steps = (int64_t)(5.0 / dt + 0.5);
    for (int64_t k = 0; k < steps; k++) measured_step(w);
    for (int a = 0; a < 3; a++) vector[a] = l[a] / size * (size / across) * 5.0;
    gn_rotation_matrix(vector, matrix);
    for (int a = 0; a < 3; a++) turned[a] = dot3(matrix + 3 * a, axis) - b->axes[3 * a + heavy];
    world_end(w);
    return length3(turned);
}

static void a_symmetric_top_precesses_as_it_should(void **state) {
    (void)state;
    double coarse = precession_error(0.01), fine = precession_error(0.005);
    assert_true(coarse < 1e-2);
    assert_true(coarse < 1e-9 || fabs(coarse / fine - 4.0) < 0.3);
}

/* --- particles and bodies --- */

/* Sums over particles and bodies, and the sizes of their terms. */
typedef struct momentum {
    double linear[3], angular[3], linear_size, angular_size;
} momentum;

static void add_turn(momentum *m, const double *x, const double *v, double mass) {
    double turn[3];
    cross3(x, v, turn);
    for (int a = 0; a < 3; a++) {
        m->linear[a] += mass * v[a];
        m->angular[a] += mass * turn[a];
    }
    m->linear_size += mass * length3(v);
    m->angular_size += mass * length3(x) * length3(v);
}

static momentum momentum_of(const gn_world *w) {
    momentum m = {0};
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double *v = w->dem.particles.vel + 4 * p, *o = w->dem.particles.spin + 4 * p;
        add_turn(&m, w->dem.particles.pos + 4 * p, v, 1.0 / v[3]);
        for (int a = 0; a < 3; a++) m.angular[a] += o[a] / o[3];
        m.angular_size += length3(o) / o[3];
    }
    for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
        const gn_rigid *b = &w->boundary.bodies[k];
        add_turn(&m, b->position, b->velocity, b->mass);
        for (int a = 0; a < 3; a++) m.angular[a] += b->momentum[a];
        m.angular_size += length3(b->momentum);
    }
    return m;
}

/* Spheres fly at a box from all sides. */
static gn_world *swarm(const char *more) {
    text t = {0}, s = {0};
    uint64_t at = 5;
    add(&t, "dimension: 3\nspecimen:\n  group: 0\n  particles:\n");
    add(&s, "sets:\n");
    for (int k = 0; k < 24; k++) {
        /* Twelve directions, evenly distributed over the sphere. */
        double z = (2 * k + 1) / 24.0 - 1.0, turn = 2.4 * k, r = 1e-3, far = 9e-3;
        double d[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        add(&t, "    - [%.17g, %.17g, %.17g, %g]\n", far * d[0], far * d[1], far * d[2],
            r * uniform(&at, 0.5, 1.0));
        add(&s,
            "  - {name: s%d, select: {ids: [%d]}, initial_velocity: [%.17g, %.17g, %.17g], "
            "initial_spin: [%.17g, 100, -200]}\n",
            k, k, -d[0], -d[1], -d[2], uniform(&at, -300, 300));
    }
    return world_of(
        "%s%s"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\n"
        "bodies: [{name: b, box: {size: [6e-3, 8e-3, 5e-3]}, origin: [-3e-3, -4e-3, -2.5e-3], "
        "stiffness: 1e6, kratio: 2, friction: 0.4, free: true, density: 2000, initial_spin: [20, "
        "-50, 30]}]\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\nrun: {threads: 1}\n%s",
        t.s, s.s, more);
}

/* Forces are equal and opposite and act at one point: a few roundings per step. */
static void particles_and_a_body_keep_momentum(void **state) {
    (void)state;
    gn_world *w = swarm("damping: {contact: {restitution: 0.6}}\ntime: {step: 5e-7, end: 1}\n");
    momentum before = momentum_of(w);
    int64_t steps = 20000;
    gn_energy e = measured_step(w);
    double kinetic = e.kinetic + e.rotational;
    run_steps(w, steps);
    momentum after = momentum_of(w);
    for (int a = 0; a < 3; a++) {
        double allowed = 4.0 * 2.2e-16 * (double)steps;
        assert_near(after.linear[a], before.linear[a], allowed * before.linear_size);
        assert_near(after.angular[a], before.angular[a], allowed * before.angular_size);
    }
    e = measured_step(w);
    assert_true(e.friction > 0.005 * kinetic); /* the bodies were in contact */
    assert_true(e.contact_damping > 0.05 * kinetic);
    world_end(w);
}

/* The residual is the error of the integration: of second order in the step. */
static void the_ledger_of_particles_and_a_body_closes(void **state) {
    (void)state;
    double residual[2];
    for (int k = 0; k < 2; k++) {
        char more[96];
        snprintf(more, sizeof more, "time: {step: %g, end: 1}\n", k ? 2.5e-8 : 1e-7);
        gn_world *w = swarm(more);
        gn_energy e = measured_step(w);
        double start = e.kinetic + e.rotational, worst = 0.0;
        for (int64_t n = 0; n < (k ? 320000 : 80000); n++) {
            e = measured_step(w);
            worst = fmax(worst, fabs(gn_energy_stored(&e) + e.friction - e.stored_at_start));
        }
        assert_true(e.friction > 0.005 * start);
        residual[k] = worst / start;
        world_end(w);
    }
    assert_true(residual[0] < 1e-3);
    assert_true(residual[1] < 0.35 * residual[0]);
}

/* The dashpot uses the effective mass of a body: central and off-centre impacts rebound with the
 * restitution coefficient, relative to the contact. */
static void a_sphere_rebounds_from_a_free_body(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        double off = k % 2 ? 1.5e-3 : 0.0, restitution = k / 2 ? 0.4 : 1.0;
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[%g, 0, 3.05e-3, 1e-3]], group: 0}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
            "law: {stiffness: uniform}\ndamping: {contact: {restitution: %g}}\n"
            "bodies: [{name: b, box: {size: [6e-3, 4e-3, 4e-3]}, origin: [-3e-3, -2e-3, -2e-3], "
            "stiffness: 1e6, free: true, density: 2500}]\n"
            "sets: [{name: a, select: {all: true}, initial_velocity: [0, 0, -1]}]\n"
            "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {step: 2e-8, end: 9}\n"
            "run: {threads: 1}\n",
            off, restitution);
        run_steps(w, 10000);
        const gn_rigid *b = &w->boundary.bodies[0];
        /* Velocity along z at the contact point; the body has hardly rotated by then. */
        double at = b->velocity[2] - off * b->spin[1];
        assert_near(vel_of(w, 0)[2] - at, restitution, 0.01);
        assert_true(b->velocity[2] < -0.01);
        world_end(w);
    }
}

/* --- stability --- */

/* A light plate on a bed of spheres on a wall, under strong gravity so that all contacts stay
 * closed, in balance except for small random velocities. */
static gn_world *bed(const char *damping, const char *step) {
    return world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [8, 8, 1], "
        "spacing: 1.05}, group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: "
        "0.5}]\nlaw: {stiffness: uniform}\n%sgravity: [0, 0, -1e5]\n"
        "walls: [{name: w, point: [0, 0, 5.116e-5], normal: [0, 0, 1], stiffness: 1e6}]\n"
        "bodies: [{name: p, box: {size: [17e-3, 17e-3, 5e-4]}, origin: [0, 0, 2.0499e-3], "
        "stiffness: 1e6, kratio: 2, friction: 0.5, free: true, density: 500}]\n"
        "initial: {random_velocity: 1e-4}\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {%s, end: 9}\nrun: {threads: 1}\n",
        damping, step);
}

static double fastest(const gn_world *w) {
    double most = length3(w->boundary.bodies[0].velocity);
    for (int k = 0; k < 64; k++) most = fmax(most, length3(vel_of(w, k)));
    return most;
}

/* At the automatic step the energy does not grow; at the step that is stable for the spheres alone
 * it grows. */
static void the_limit_includes_free_bodies(void **state) {
    (void)state;
    const char *const damping[] = {"", "damping: {contact: {fraction: 0.3}}\n"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = bed(damping[k], "step: auto");
        double particles = w->ctx.choice.stable;
        assert_true(w->ctx.choice.surface_rate * particles > 0.5);
        assert_true(w->ctx.dt < 0.9 * particles);
        measured_step(w);
        double start = fastest(w), most = 0.0;
        for (int n = 0; n < 20000; n++) {
            measured_step(w);
            most = fmax(most, fastest(w));
        }
        assert_true(most < 20.0 * start);
        world_end(w);
        char step_text[64];
        snprintf(step_text, sizeof step_text, "step: %.17g, on_unstable: warn", 0.999 * particles);
        w = bed(damping[k], step_text);
        gneiss_error error = {0};
        most = 0.0;
        for (int n = 0; n < 2000 && gn_world_step(w, false, &error) == GNEISS_OK; n++)
            most = fmax(most, fastest(w));
        assert_true(most > 20.0 * start);
        world_end(w);
    }
}

/* --- the same bits --- */

static uint64_t swarm_hash(int threads, int64_t steps) {
    char more[160];
    snprintf(more, sizeof more,
             "damping: {contact: {restitution: 0.6}}\ntime: {step: 5e-7, end: 1}");
    gn_world *w = swarm(more);
    w->ctx.threads = threads;
    assert_int_equal(gn_dem_use_threads(&w->ctx, &w->dem, NULL), GNEISS_OK);
    run_steps(w, steps);
    uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    world_end(w);
    return hash;
}

static void any_number_of_threads_gives_the_same_bits(void **state) {
    (void)state;
    uint64_t one = swarm_hash(1, 6000);
    assert_true(swarm_hash(2, 6000) == one);
    assert_true(swarm_hash(3, 6000) == one);
}

static void a_resumed_run_gives_the_same_bits(void **state) {
    (void)state;
    soup *s = calloc(1, sizeof *s);
    char path[32], saved[64], scene_text[2048];
    random_plane(s, 3, 6, 0.01);
    write_soup(s, path);
    snprintf(saved, sizeof saved, "%s.h5", path);
    snprintf(scene_text, sizeof scene_text,
             "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [4, 4, 2], "
             "origin: [-4.5e-3, -4.5e-3, 1e-4], jitter: 0.2, spacing: 1.1}, group: 0}\n"
             "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: "
             "0.3}]\nlaw: {stiffness: uniform}\ngravity: [1, 2, -10]\n"
             "damping: {contact: {restitution: 0.5}}\n"
             "bodies:\n  - {name: a, surface: %s, stiffness: 1e6, kratio: 2, friction: 0.3, "
             "motion: {vx: 0.05, wz: 3}}\n"
             "  - {name: b, box: {size: [4e-3, 4e-3, 2e-3]}, origin: [-2e-3, -2e-3, 6e-3], "
             "stiffness: 1e6, kratio: 2, friction: 0.3, free: true, density: 2000}\n"
             "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {end: 1}\n"
             "run: {threads: 1}\n",
             path);
    gn_scene scene;
    gneiss_error error = {0};
    gn_run straight, stopped, resumed;
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, &straight, &error), &error);
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, &stopped, &error), &error);
    unlink(path); /* a resumed run does not need it */
    run_steps(&straight.world, 6000);
    run_steps(&stopped.world, 2777);
    assert_ok(gn_checkpoint_write(&stopped, saved, &error), &error);
    assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
    run_steps(&resumed.world, 6000 - 2777);
    assert_true(straight.world.dem.verlet.rebuilds > 2);
    assert_true(gn_world_hash(&straight.world.ctx, &straight.world.dem, &straight.world.boundary,
                              &straight.world.solids, &straight.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    assert_true(straight.world.ctx.dt == resumed.world.ctx.dt);
    assert_true(memcmp(&straight.world.ledger.energy, &resumed.world.ledger.energy,
                       sizeof(gn_energy)) == 0);
    gn_run_free(&straight);
    gn_run_free(&stopped);
    gn_run_free(&resumed);
    unlink(saved);
    free(s);
}

/* --- refused input --- */

static void refuse(const char *bodies, const char *const *parts, int count) {
    char scene_text[2048];
    gn_world w;
    gneiss_error error = {0};
    snprintf(scene_text, sizeof scene_text, "%stime: {step: 1e-3, end: 1}\n%s\n", head, bodies);
    if (world_try(&w, scene_text, "/tmp", &error) == GNEISS_OK)
        fail_msg("expected an error: %s", bodies);
    for (int k = 0; k < count; k++)
        if (!strstr(error.message, parts[k]))
            fail_msg("expected '%s' in '%s'", parts[k], error.message);
}
#define REFUSE(bodies, ...)                                                                        \
    refuse(bodies, (const char *const[]){__VA_ARGS__},                                             \
           (int)(sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *)))

static void errors_say_where_and_what(void **state) {
    (void)state;
    REFUSE("bodies:\n  - {name: b, surface: not-there.stl, stiffness: 1}",
           "s.yaml:9:", "bodies[0].surface", "not-there.stl", "No such file");
    REFUSE("bodies: [{name: b, stiffness: 1}]", "expected one of surface, box, cylinder", "none");
    REFUSE("bodies: [{name: b, box: {size: [1, 1, 1]}}]", "stiffness", "required");
    REFUSE("bodies: [{name: b, box: {size: [1, 1, 1]}, stiffness: 1, friction: 0.1}]", "kratio");
    REFUSE("bodies: [{name: b, box: {size: [1, 1, 1]}, stiffness: 1, free: true}]", "density");
    REFUSE("bodies: [{name: b, box: {size: [1, 1, 1]}, stiffness: 1, free: true, density: 3, "
           "initial_spin: [0, 3, 0], motion: {wx: 1, wy: 0, wz: 0}}]",
           "initial_spin", "without a prescribed spin");
    REFUSE("bodies: [{name: b, box: {size: [1, 1, 1]}, stiffness: 1, density: 3}]", "density",
           "free");
    REFUSE("bodies: [{name: b, polygon: [[0, 0], [1, 0], [0, 1]], stiffness: 1}]",
           "bodies[0].polygon", "2D");
    REFUSE("bodies: [{name: b, cylinder: {diameter: 1, height: 1, open: true}, stiffness: 1, free: "
           "true, density: 1}]",
           "bodies[0].free", "closed");
    soup *s = calloc(1, sizeof *s);
    char path[32], scene_text[256];
    random_plane(s, 1, 2, 1.0);
    write_soup(s, path);
    snprintf(scene_text, sizeof scene_text,
             "bodies:\n  - {name: sheet, surface: %s, stiffness: 1, free: true, density: 1}", path);
    REFUSE(scene_text, "s.yaml:9:", "bodies[0]", "sheet", "expected a closed surface",
           "the edge from (");
    unlink(path);
    free(s);
}

static void add_box(soup *s, const double low[3], const double high[3]) {
    static const int side[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    double x[8][3];
    for (int k = 0; k < 8; k++)
        for (int a = 0; a < 3; a++) x[k][a] = k >> a & 1 ? high[a] : low[a];
    for (int k = 0; k < 6; k++) {
        add_corners(s, x[side[k][0]], x[side[k][1]], x[side[k][2]]);
        add_corners(s, x[side[k][0]], x[side[k][2]], x[side[k][3]]);
    }
}

/* A cube of 1 m and a block that penetrates it by half a metre have a volume of 1.32 m3, not 1.64.
 * */
static void a_free_surface_that_cuts_itself_is_refused(void **state) {
    (void)state;
    static const double corners[4][3] = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.1, 0.1}, {1.5, 0.9, 0.9}};
    soup *s = calloc(1, sizeof *s);
    char path[32], scene_text[256];
    add_box(s, corners[0], corners[1]);
    add_box(s, corners[2], corners[3]);
    write_soup(s, path);
    snprintf(scene_text, sizeof scene_text,
             "bodies: [{name: b, surface: %s, stiffness: 1, free: true, density: 1}]", path);
    REFUSE(scene_text,
           "s.yaml:8:10: bodies[0] (b): ", "expected a surface that does not cut itself",
           "mass, inertia and reference");
    snprintf(scene_text, sizeof scene_text,
             "bodies: [{name: b, surface: %s, stiffness: 1, free: true, mass: 1}]", path);
    REFUSE(scene_text, "expected a surface that does not cut itself");
    /* Bodies that are only touched, or have a given mass, may be open. */
    static const char *const may[] = {
        "", ", free: true, mass: 2, inertia: [1, 1, 1], reference: [0.5, 0.5, 0.5]"};
    for (int k = 0; k < 2; k++)
        world_end(world_of("%sbodies: [{name: b, surface: %s, stiffness: 1%s}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head, path, may[k]));
    unlink(path);
    free(s);
}

static void closed_parts_in_others_are_counted_as_cavities(void **state) {
    (void)state;
    static const double corners[4][3] = {{0, 0, 0}, {1, 1, 1}, {0.3, 0.3, 0.3}, {0.6, 0.6, 0.6}};
    soup *s = calloc(1, sizeof *s);
    char path[32];
    for (int inner = 0; inner < 2; inner++) {
        add_box(s, corners[2 * inner], corners[2 * inner + 1]);
        write_soup(s, path);
        gn_world *w = world_of("%sbodies: [{name: b, surface: %s, stiffness: 1, free: true, "
                               "density: 10}]\ntime: {step: 1e-3, end: 1}\n",
                               head, path);
        assert_int_equal(gn_body_cavities(&w->ctx.scene, 0), inner);
        assert_close(w->boundary.bodies[0].mass, inner ? 9.73 : 10.0, 1e-12);
        world_end(w);
        unlink(path);
    }
    free(s);
}

static void a_free_polygon_that_crosses_itself_is_refused(void **state) {
    (void)state;
    static const char bow_tie[] = "[[0, 0], [2, 2], [2, 0], [0, 1]]",
                      star[] = "[[0, 1], [0.588, -0.809], [-0.951, 0.309], [0.951, 0.309], "
                               "[-0.588, -0.809]]";
    static const char *const shapes[] = {bow_tie, star};
    for (int k = 0; k < 2; k++) {
        char scene_text[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(scene_text, sizeof scene_text,
                 "%sbodies: [{name: b, polygon: %s, stiffness: 1, free: true, density: 1}]\n"
                 "time: {step: 1e-3, end: 1}\n",
                 head2, shapes[k]);
        assert_int_equal(world_try(&w, scene_text, "/tmp", &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, "bodies[0] (b): ") ||
            !strstr(error.message, "does not cross or touch itself"))
            fail_msg("%s", error.message);
        world_end(world_of("%sbodies: [{name: b, polygon: %s, stiffness: 1}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head2, shapes[k]));
    }
}

/* Many lists of points name the first again at the end. */
static void a_free_polygon_may_name_its_first_point_again(void **state) {
    (void)state;
    gn_world *w = world_of("%sbodies: [{name: b, polygon: [[0, 0], [3, 0], [3, 0], [0, 2], [0, "
                           "0]], rotation: [0, 0, 0.3], stiffness: 1, free: true, density: 10}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head2);
    assert_close(w->boundary.bodies[0].mass, 30.0, 1e-12);
    world_end(w);
}

/* A triangle whose corners lie on a line, beside good ones. */
static void facets_without_area_are_dropped_and_counted(void **state) {
    (void)state;
    soup *s = calloc(1, sizeof *s);
    char path[32];
    const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, d[3] = {0.5, 0, 0};
    add_corners(s, a, b, c);
    add_corners(s, a, d, b);
    write_soup(s, path);
    gn_world *w = world_of("%sbodies: [{name: b, surface: %s, stiffness: 1}]\n"
                           "time: {step: 1e-3, end: 1}\n",
                           head, path);
    assert_int_equal(w->boundary.body_shape[0][1], 1);
    assert_int_equal(w->boundary.body_shape[0][2], 1);
    world_end(w);
    unlink(path);
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_weighs_what_it_should),
        cmocka_unit_test(a_prism_weighs_what_it_should),
        cmocka_unit_test(a_polygon_weighs_what_it_should),
        cmocka_unit_test(a_free_body_falls_exactly),
        cmocka_unit_test(a_channel_may_be_prescribed),
        cmocka_unit_test(prescribed_spin_turns_about_the_reference_point),
        cmocka_unit_test(orientation_is_the_turn_from_the_start_at_every_angle),
        cmocka_unit_test(an_asymmetric_top_keeps_momentum_and_energy),
        cmocka_unit_test(a_symmetric_top_precesses_as_it_should),
        cmocka_unit_test(particles_and_a_body_keep_momentum),
        cmocka_unit_test(the_ledger_of_particles_and_a_body_closes),
        cmocka_unit_test(a_sphere_rebounds_from_a_free_body),
        cmocka_unit_test(the_limit_includes_free_bodies),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_resumed_run_gives_the_same_bits),
        cmocka_unit_test(errors_say_where_and_what),
        cmocka_unit_test(a_free_surface_that_cuts_itself_is_refused),
        cmocka_unit_test(closed_parts_in_others_are_counted_as_cavities),
        cmocka_unit_test(a_free_polygon_that_crosses_itself_is_refused),
        cmocka_unit_test(a_free_polygon_may_name_its_first_point_again),
        cmocka_unit_test(facets_without_area_are_dropped_and_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
