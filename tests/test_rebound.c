/* Collisions of loose particles with few steps per contact, and bonded clusters that spin. */
#include "world_helpers.h"

#include "kernels/dashpot.h"

/* --- restitution --- */

/* A colliding pair, or a particle and a wall. */
typedef struct meeting {
    double r1, r2, density, stiffness, depth, phase; /* depth: overlap over r2 */
    int dimension;
    enum { FREE, HELD, WALL } other;
} meeting;

static meeting draw(uint64_t *at) {
    meeting m = {.r1 = 1e-3 * pow(10.0, uniform(at, -0.5, 0.5)),
                 .r2 = 1e-3 * pow(10.0, uniform(at, -0.5, 0.5)),
                 .density = pow(10.0, uniform(at, 3.0, 4.0)),
                 .stiffness = pow(10.0, uniform(at, 4.0, 8.0)),
                 .depth = pow(10.0, uniform(at, -5.0, -1.3)),
                 .phase = uniform(at, 1.0, 3.0),
                 .dimension = uniform(at, 0.0, 1.0) < 0.5 ? 2 : 3,
                 .other = (int)uniform(at, 0.0, 3.0)};
    return m;
}

static double mass(const meeting *m, double r) {
    return m->dimension == 3 ? sphere_mass(m->density, r) : disc_mass(m->density, r);
}

/* Returns the speed of separation over that of approach. */
static double rebound(const meeting *m, double restitution, double steps) {
    double inverse = 1.0 / mass(m, m->r2) + (m->other == FREE ? 1.0 / mass(m, m->r1) : 0.0);
    double w0 = sqrt(m->stiffness * inverse), dt = pi / w0 / steps;
    double speed = m->depth * fmin(m->r1, m->r2) * w0, gap = m->phase * speed * dt;
    const char *zero = m->dimension == 3 ? "0, 0" : "0";
    text t = {0};
    add(&t, "dimension: %d\nspecimen: {particles: [", m->dimension);
    if (m->other != WALL) add(&t, "[%.17g, %s, %.17g], ", -m->r1, zero, m->r1);
    add(&t, "[%.17g, %s, %.17g]], group: 0}\n", m->r2 + gap, zero, m->r2);
    add(&t,
        "materials: [{name: m, density: %.17g, normal_stiffness: %.17g, kratio: 0}]\n"
        "law: {stiffness: uniform}\ndamping: {contact: {restitution: %.17g}}\n",
        m->density, m->stiffness, restitution);
    if (m->other == WALL)
        add(&t, "walls: [{name: w, point: [0, %s], normal: [1, %s], stiffness: %.17g}]\n", zero,
            zero, m->stiffness);
    int moving = m->other == WALL ? 0 : 1;
    add(&t, "sets:\n  - {name: b, select: {ids: [%d]}, initial_velocity: [%.17g, %s]}\n", moving,
        -speed, zero);
    if (m->other == HELD) add(&t, "  - {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0}}\n");
    add(&t, "time: {step: %.17g, end: 1, on_unstable: warn}\nrun: {threads: 1}\n", dt);
    gn_world *w = world_of("%s", t.s);
    /* At critical damping, the slowest separation, the particles are at 1 % of the speed after
     * eight times 1/w. */
    run_steps(w, (int64_t)(steps * 4.0 + m->phase + 2.0));
    double parts = vel_of(w, moving)[0] - (m->other == WALL ? 0.0 : vel_of(w, 0)[0]);
    world_end(w);
    return parts / speed;
}

/* The accuracy that the resolution rule of the automatic step guarantees: 1 % down to a restitution
 * of one half, 0.01 below. */
static void restitution_is_kept_at_the_steps_that_the_rule_gives(void **state) {
    (void)state;
    static const double asked[] = {0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0};
    uint64_t at = 16;
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
        double c = asked[k], worst = 0.0, sum = 0.0;
        enum { DRAWN = 50 };
        for (int n = 0; n < DRAWN; n++) {
            meeting m = draw(&at);
            double off = rebound(&m, c, GN_STEPS_PER_CONTACT) - c;
            worst = fmax(worst, fabs(off));
            sum += off;
        }
        print_message("# c_r %.2f: worst %.4f, mean %+.4f\n", c, worst, sum / DRAWN);
        assert_true(worst <= 0.01 * fmax(c >= 0.5 ? c : 1.0, 0.5));
    }
}

/* Two equal spheres that pass each other; `sideways`: tangential speed relative to the speed of
 * approach. Returns the speed of separation relative to the speed of approach, along the line of
 * their first contact. */
static double oblique(double restitution, double sideways, double depth, double phase,
                      double steps) {
    double r = 1e-3, m = sphere_mass(2500, r), k = 1e6, w0 = sqrt(2.0 * k / m),
           speed = depth * r * w0;
    double dt = pi / w0 / steps, start = phase * pi / w0 / GN_STEPS_PER_CONTACT;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [%.17g, %.17g, 0, 1e-3]], group: "
        "0}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\nlaw: "
        "{stiffness: uniform}\ndamping: {contact: {restitution: %.17g}}\nsets:\n"
        "  - {name: b, select: {ids: [1]}, initial_velocity: [%.17g, %.17g, 0]}\n"
        "time: {step: %.17g, end: 1, on_unstable: warn}\nrun: {threads: 1}\n",
        2.0 * r + speed * start, -sideways * speed * start, restitution, -speed, sideways * speed,
        dt);
    run_steps(w, (int64_t)((4.0 * steps / pi + phase * steps / GN_STEPS_PER_CONTACT) * 1.2));
    double parts = vel_of(w, 1)[0] - vel_of(w, 0)[0];
    world_end(w);
    return parts / speed;
}

/* While the path across the normal is as long as that along it, the distance does not change by the
 * speed along the normal alone: a contact that begins where a step does must not be missed. */
static void restitution_is_kept_beside_sideways_motion(void **state) {
    (void)state;
    static const double asked[] = {0.1, 0.5, 0.9};
    uint64_t at = 4;
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 40; n++) {
            double sideways = uniform(&at, 0.5, 8.0), depth = pow(10.0, uniform(&at, -5.0, -2.5));
            double phase = n < 4 ? n : n < 12 ? 1.0 + 0.005 * n : uniform(&at, 0.0, 2.0);
            double fine = oblique(asked[k], sideways, depth, phase, 20 * GN_STEPS_PER_CONTACT);
            double off = oblique(asked[k], sideways, depth, phase, GN_STEPS_PER_CONTACT) - fine;
            /* The normal turns by sideways depth pi/2 meanwhile. */
            if (fabs(off) > 0.01 + sideways * depth)
                fail_msg("c_r %g, %g times as fast sideways, depth %g, phase %g: off by %g",
                         asked[k], sideways, depth, phase, off);
        }
}

/* A sphere restrained along x only is hit along a normal at `angle` to x. Returns the speed of
 * separation along the normal relative to that of approach. */
static double held_along_x(double angle, double restitution) {
    double n[2] = {cos(angle), sin(angle)}, r = 1e-3, m = sphere_mass(2500, r);
    double w0 = sqrt(1e6 / m * (1.0 + n[1] * n[1])), dt = pi / w0 / GN_STEPS_PER_CONTACT;
    double speed = 1e-4 * r * w0, start = 2.0 * r + 1.5 * speed * dt;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [%.17g, %.17g, 0, 1e-3]], group: "
        "0}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\nlaw: "
        "{stiffness: uniform}\ndamping: {contact: {restitution: %.17g}}\nsets:\n"
        "  - {name: b, select: {ids: [1]}, initial_velocity: [%.17g, %.17g, 0]}\n"
        "  - {name: a, select: {ids: [0]}, motion: {vx: 0}}\n"
        "time: {step: %.17g, end: 1, on_unstable: warn}\nrun: {threads: 1}\n",
        start * n[0], start * n[1], restitution, -speed * n[0], -speed * n[1], dt);
    run_steps(w, 4 * GN_STEPS_PER_CONTACT);
    double parts = 0.0;
    for (int a = 0; a < 2; a++) parts += n[a] * (vel_of(w, 1)[a] - vel_of(w, 0)[a]);
    world_end(w);
    return parts / speed;
}

/* Only the part of the compliance along the normal counts: 1/m sin^2. */
static void restitution_is_kept_against_a_particle_held_along_one_axis(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++)
        for (double angle = 0.0; angle < 1.6; angle += 0.25) {
            double asked = (const double[]){0.1, 0.5, 0.8, 1.0}[k];
            assert_near(held_along_x(angle, asked), asked, 0.01);
        }
}

/* Five particles in a row, of which four touch, between two walls: the first hits the others, and
 * collisions follow along the row. */
static void a_cradle_keeps_its_energy_without_dashpots(void **state) {
    (void)state;
    double m = sphere_mass(2500, 1e-3), k = 1e6, dt = pi / sqrt(2.0 * k / m);
    dt /= GN_STEPS_PER_CONTACT;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[-3.05e-3, 0, 0, 1e-3], [0, 0, 0, 1e-3], [2e-3, 0, "
        "0, 1e-3], [4e-3, 0, 0, 1e-3], [6e-3, 0, 0, 1e-3]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 0}]\n"
        "law: {stiffness: uniform}\nsets: [{name: a, select: {ids: [0]}, initial_velocity: [1, 0, "
        "0]}]\nwalls: [{name: l, point: [-5e-3, 0, 0], normal: [1, 0, 0], stiffness: %g}, {name: "
        "r, point: [8e-3, 0, 0], normal: [-1, 0, 0], stiffness: %g}]\n"
        "time: {step: %.17g, end: 1}\nrun: {threads: 1}\n",
        k, k, k, dt);
    double start = 0.5 * m, most = 0.0;
    for (int n = 0; n < 20000; n++) {
        gn_energy e = measured_step(w);
        double now = gn_energy_stored(&e);
        most = fmax(most, fabs(now - start));
    }
    print_message("# cradle: energy within %.2g\n", most / start);
    assert_true(most < 1e-3 * start); /* hundreds of collisions */
    world_end(w);
}

/* --- spinning clusters --- */

/* Bonded spheres of 1 mm at rest in a frame that turns with `spin` about `axis`; relative change of
 * the energy after `steps` steps of w dt = `angle`. */
static double drift(const double (*at)[3], int count, const double axis[3], double spin,
                    double angle, double stiffness, int64_t steps) {
    text *t = calloc(1, sizeof *t);
    double centre[3] = {0, 0, 0}, w0[3];
    for (int k = 0; k < count; k++)
        for (int a = 0; a < 3; a++) centre[a] += at[k][a] / count;
    for (int a = 0; a < 3; a++) w0[a] = spin * axis[a] / length3(axis);
    add(t, "dimension: 3\nspecimen:\n  particles:\n");
    for (int k = 0; k < count; k++)
        add(t, "    - [%.17g, %.17g, %.17g, 1e-3]\n", at[k][0], at[k][1], at[k][2]);
    add(t,
        "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 2, "
        "bond_tension_limit: 1e30, bond_shear_limit: 1e30}]\nlaw: {stiffness: uniform}\n"
        "bonds: {interaction_range: 0.05}\ntime: {step: %.17g, end: 1}\nrun: {threads: 1}\n"
        "sets:\n",
        stiffness, angle / spin);
    for (int k = 0; k < count; k++) {
        double d[3], v[3];
        for (int a = 0; a < 3; a++) d[a] = at[k][a] - centre[a];
        v[0] = w0[1] * d[2] - w0[2] * d[1];
        v[1] = w0[2] * d[0] - w0[0] * d[2];
        v[2] = w0[0] * d[1] - w0[1] * d[0];
        add(t,
            "  - {name: s%d, select: {ids: [%d]}, initial_velocity: [%.17g, %.17g, %.17g], "
            "initial_spin: [%.17g, %.17g, %.17g]}\n",
            k, k, v[0], v[1], v[2], w0[0], w0[1], w0[2]);
    }
    gn_world *w = world_of("%s", t->s);
    free(t);
    gn_energy e = measured_step(w);
    double start = gn_energy_stored(&e);
    run_steps(w, steps - 1);
    e = measured_step(w);
    double change = gn_energy_stored(&e) / start - 1.0;
    world_end(w);
    return change;
}

/* The strain due to the spin builds up as a vibration about its mean, whose energy the scheme keeps
 * to (w dt)^2 of the share that is elastic; nothing grows. */
static void spinning_clusters_keep_their_energy(void **state) {
    (void)state;
    const double three[3][3] = {{0, 0, 0}, {2e-3, 0, 0}, {1e-3, 1.7320508075688772e-3, 0}};
    double ring[24][3], block[24][3];
    for (int k = 0; k < 24; k++) {
        double radius = 1e-3 / sin(pi / 24), angle = 2.0 * pi * k / 24;
        ring[k][0] = radius * cos(angle);
        ring[k][1] = radius * sin(angle);
        ring[k][2] = 0.0;
    }
    int filled = 0;
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++)
            for (int z = 0; z < 4; z++) {
                if ((x + y + z) % 2 || filled == 24) continue;
                const int at[3] = {x, y, z};
                for (int a = 0; a < 3; a++) block[filled][a] = sqrt(2.0) * 1e-3 * at[a];
                filled++;
            }
    const double up[3] = {0, 0, 1}, askew[3] = {0.3, 0.5, 1};
    const double off[] = {drift(three, 3, askew, 50.0, 1.2e-4, 5e5, 200000),
                          drift(ring, 24, up, 200.0, 2e-4, 4e6, 50000),
                          drift(block, 24, askew, 860.0, 5e-4, 4e6, 50000)};
    for (int k = 0; k < 3; k++) {
        print_message("# spinning cluster %d: energy changed by %.2g\n", k, off[k]);
        assert_true(fabs(off[k]) < 1e-6);
    }
}

/* Along the normal of the end of a step the ends of a rotating bond separate by d W^2 dt/2; the
 * distance does not change. With the former, 0.2 (W dt)^2 w/W of the energy is booked per radian: 8
 * % here. */
static void a_damped_cluster_that_turns_dissipates_nothing(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\nspecimen: {particles: [[0, 0, 1e-3], [2e-3, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
        "bond_tension_limit: "
        "1e9, bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\nbonds: {}\n"
        "damping: {contact: {restitution: 0.5}}\nsets:\n"
        "  - {name: a, select: {ids: [0]}, initial_velocity: [0, -33.85e-3], initial_spin: 33.85}\n"
        "  - {name: b, select: {ids: [1]}, initial_velocity: [0, 33.85e-3], initial_spin: 33.85}\n"
        "time: {end: 10}\nrun: {threads: 1}\n");
    gn_energy e = measured_step(w);
    double kinetic = e.kinetic + e.rotational;
    run_steps(w, 100000);
    e = measured_step(w);
    /* Starting without the centrifugal strain (W/w)^2 = 2e-6 excites a damped oscillation. */
    assert_true(e.contact_damping < 1e-5 * kinetic);
    assert_true(fabs(gn_energy_residual(&e)) * gn_energy_scale(&e) < 1e-5 * kinetic);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(restitution_is_kept_at_the_steps_that_the_rule_gives),
        cmocka_unit_test(restitution_is_kept_beside_sideways_motion),
        cmocka_unit_test(restitution_is_kept_against_a_particle_held_along_one_axis),
        cmocka_unit_test(a_cradle_keeps_its_energy_without_dashpots),
        cmocka_unit_test(spinning_clusters_keep_their_energy),
        cmocka_unit_test(a_damped_cluster_that_turns_dissipates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
