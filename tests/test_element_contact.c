/* Particles on the surface of finite elements. */
#include "parts.h"
#include "surface_helpers.h"

#include "run/run.h"

/* Spheres (discs) hit a free block of elements. */
static gn_world *shower(int dimension, const char *more) {
    text t = {0}, s = {0};
    uint64_t at = 11;
    add(&t, "dimension: %d\nspecimen:\n  group: 0\n  particles:\n", dimension);
    add(&s, "sets:\n");
    for (int k = 0; k < 9; k++) {
        double x = 2.2e-3 * (k % 3 - 1) + uniform(&at, -2e-4, 2e-4);
        double y = dimension == 3 ? 2.2e-3 * (k / 3 - 1) + uniform(&at, -2e-4, 2e-4) : 0.0;
        double z = (k % 2 ? -1 : 1) * (dimension == 3 ? 3.2e-3 : 3.2e-3 + 2.1e-3 * (k / 3));
        double r = uniform(&at, 0.6e-3, 1e-3), v = z < 0 ? 1.0 : -1.0;
        if (dimension == 3) {
            add(&t, "    - [%.17g, %.17g, %.17g, %.17g]\n", x, y, z, r);
            add(&s,
                "  - {name: s%d, select: {ids: [%d]}, initial_velocity: [0.3, -0.2, %g], "
                "initial_spin: [100, 50, 200]}\n",
                k, k, v);
        } else {
            add(&t, "    - [%.17g, %.17g, %.17g]\n", x, z, r);
            add(&s,
                "  - {name: s%d, select: {ids: [%d]}, initial_velocity: [0.3, %g], initial_spin: "
                "100}\n",
                k, k, v);
        }
    }
    const char *block = dimension == 3
                            ? "box: {size: [8e-3, 8e-3, 4e-3], origin: [-4e-3, -4e-3, -2e-3], "
                              "cells: [6, 6, 3], distortion: 0.1}"
                            : "rectangle: {size: [8e-3, 4e-3], origin: [-4e-3, -2e-3], cells: [8, "
                              "4], distortion: 0.2}";
    return world_of(
        "%s%s"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\n"
        "elements: {%s, materials: [{young: %g, poisson: 0.2, density: 2000}], contact: "
        "{stiffness: 1e6, kratio: 2, friction: 0.4}}\n"
        "domain: {min: [-9, -9%s], max: [9, 9%s]}\nrun: {threads: 1}\n%s",
        t.s, s.s, block, dimension == 3 ? 1e9 : 1e7, dimension == 3 ? ", -9" : "",
        dimension == 3 ? ", 9" : "", more);
}

typedef struct momentum {
    double linear[3], angular[3], linear_size, angular_size;
} momentum;

static void add_all(momentum *m, const gn_particles *q) {
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p, *v = q->vel + 4 * p,
                     *o = q->spin ? q->spin + 4 * p : NULL;
        double turn[3];
        cross3(x, v, turn);
        for (int a = 0; a < 3; a++) {
            m->linear[a] += v[a] / v[3];
            m->angular[a] += turn[a] / v[3] + (o ? o[a] / o[3] : 0.0);
        }
        m->linear_size += length3(v) / v[3];
        m->angular_size += length3(x) * length3(v) / v[3] + (o ? length3(o) / o[3] : 0.0);
    }
}

static momentum momentum_of(const gn_world *w) {
    momentum m = {0};
    add_all(&m, &w->dem.particles);
    add_all(&m, &w->solids.elements[0]->solid.nodes);
    return m;
}

/* Particles and nodes exchange equal forces at one point; internal forces of elements preserve both
 * momenta too. */
static void keeps_momentum(int dimension) {
    gn_world *w = shower(dimension, "damping: {contact: {restitution: 0.7}}\ntime: {end: 1}\n");
    momentum before = momentum_of(w);
    gn_energy e = measured_step(w);
    double kinetic = e.kinetic + e.rotational;
    int64_t steps = 20000;
    run_steps(w, steps);
    momentum after = momentum_of(w);
    double nodes = (double)w->solids.elements[0]->solid.nodes.soa.count;
    for (int a = 0; a < 3; a++) {
        /* The elements' forces are large and cancel: each node's forces are rounded in every
         * step. */
        double allowed = 2.2e-16 * (double)steps * sqrt(nodes) * 4.0;
        assert_near(after.linear[a], before.linear[a], allowed * before.linear_size);
        assert_near(after.angular[a], before.angular[a], allowed * before.angular_size);
    }
    e = measured_step(w);
    assert_true(e.friction > 1e-3 * kinetic && e.contact_damping > 0.05 * kinetic);
    world_end(w);
}

static void particles_and_nodes_keep_momentum(void **state) {
    (void)state;
    keeps_momentum(3);
    keeps_momentum(2);
}

static void the_ledger_of_particles_and_elements_closes(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        double residual[2];
        for (int k = 0; k < 2; k++) {
            char more[96];
            snprintf(more, sizeof more, "time: {step: %g, end: 1}\n", k ? 2.5e-8 : 1e-7);
            gn_world *w = shower(dimension, more);
            gn_energy e = measured_step(w);
            double start = e.kinetic + e.rotational, worst = 0.0, stored = 0.0;
            for (int64_t n = 0; n < (k ? 60000 : 15000); n++) {
                e = measured_step(w);
                stored = fmax(stored, e.elastic_elements);
                worst = fmax(worst, fabs(gn_energy_residual(&e)) * gn_energy_scale(&e));
            }
            assert_true(e.friction > 1e-3 * start && stored > 1e-3 * start);
            residual[k] = worst / start;
            world_end(w);
        }
        assert_true(residual[0] < 3e-3);
        assert_true(residual[1] < 0.35 * residual[0]);
    }
}

/* A light, soft block on a bed of spheres on a wall, pressed by gravity. */
static gn_world *bed(const char *step) {
    return world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [4, 4, 1], "
        "spacing: 1.05}, group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: "
        "0.5}]\nlaw: {stiffness: uniform}\ngravity: [0, 0, -1e3]\n"
        "walls: [{name: w, point: [0, 0, 5e-5], normal: [0, 0, 1], stiffness: 1e6}]\n"
        "elements: {box: {size: [8.4e-3, 8.4e-3, 1e-3], origin: [0, 0, 2.05e-3], cells: [16, 16, "
        "2]}, materials: [{young: 1e7, poisson: 0.2, density: 500}], contact: {stiffness: 1e6, "
        "kratio: 2, friction: 0.5}}\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {%s, end: 9}\nrun: {threads: 1}\n",
        step);
}

/* Contacts are far stiffer than the elements: if the limit did not include them, the run would be
 * unstable. */
static void the_limit_includes_contacts_with_nodes(void **state) {
    (void)state;
    gn_world *w = bed("step: auto");
    double alone = fmin(w->ctx.choice.stable, w->solids.elements[0]->stable), most = 0.0,
           work = 0.0;
    assert_true(w->ctx.choice.vertex_rate * alone > 2.0 && w->ctx.dt < 0.5 * alone);
    for (int n = 0; n < 20000; n++) {
        gn_energy e = measured_step(w);
        most = fmax(most, fabs(gn_energy_residual(&e)) * gn_energy_scale(&e));
        work = fmax(work, e.work_gravity);
    }
    assert_true(w->ctx.choice.vertex_rate > 0.0);
    assert_true(most < 0.05 * work); /* contacts open and close within steps near the limit */
    world_end(w);
    char step_text[64];
    snprintf(step_text, sizeof step_text, "step: %.17g, on_unstable: warn", 0.99 * alone);
    w = bed(step_text);
    gneiss_error error = {0};
    double speed = 0.0;
    for (int n = 0; n < 2000 && gn_world_step(w, false, &error) == GNEISS_OK; n++)
        for (size_t v = 0; v < w->solids.elements[0]->solid.nodes.soa.count; v++)
            speed = fmax(speed, fabs(w->solids.elements[0]->solid.nodes.vel[4 * v + 2]));
    /* Free fall over the whole time would lead to a much smaller speed. */
    assert_true(speed > 10.0 * 1e3 * 2000 * alone);
    world_end(w);
}

/* --- restitution --- */

enum { BOUNCE_HELD, BOUNCE_ROLLER, BOUNCE_FREE };

/* Ratio of the speed after to that before the impact of a grain of radius r (m) on a block of 20 mm
 * with cells of 2 mm, which is held at its base, along its normal alone, or free; a restitution of
 * 0.5 is requested. By Hertz's law if `young` (Pa) of the grain is not 0. */
static double rebound(int dimension, double r, int hold, double young, bool platen) {
    const char *rest = dimension == 3 ? "[10.6e-3, 10.4e-3" : "[10.6e-3";
    char motion[128] = "", top[256], grain[64];
    const bool hertz = young > 0.0;
    snprintf(grain, sizeof grain, "young: %g, poisson: 0.2", young);
    const char axis = dimension == 3 ? 'z' : 'y';
    if (hold != BOUNCE_FREE)
        snprintf(motion, sizeof motion,
                 "motions: [{name: b, group: %c_lower, motion: {%sv%c: 0}}], ", axis,
                 hold == BOUNCE_ROLLER ? ""
                 : dimension == 3      ? "vx: 0, vy: 0, "
                                       : "vx: 0, ",
                 axis);
    if (platen) /* every node is held: like a wall */
        snprintf(motion, sizeof motion,
                 "motions: [{name: a, group: z_upper, motion: {vx: 0, vy: 0, vz: 0}}], ");
    snprintf(top, sizeof top, "%s",
             dimension == 3 ? "box: {size: [20e-3, 20e-3, 10e-3], cells: [10, 10, 5]}"
                            : "rectangle: {size: [20e-3, 10e-3], cells: [10, 5]}");
    gn_world *w = world_of(
        "dimension: %d\nelements: {%s, %smaterials: [{young: 30e9, poisson: 0.2, density: 2400}], "
        "contact: {%s}}\nspecimen: {particles: [%s, %.17g, %.17g]], group: 0}\n"
        "materials: [{name: g, density: 2500, %s}]\nlaw: {stiffness: %s}\n"
        "damping: {contact: {restitution: 0.5}}\n"
        "sets: [{name: s, select: {all: true}, initial_velocity: [0, %s-0.5]}]\n"
        "domain: {min: [-9, -9%s], max: [9, 9%s]}\ntime: {end: 1}\nrun: {threads: 1}\n",
        dimension, top, motion, hertz ? "material: g" : "stiffness: 1.2e6", rest, 10.002e-3 + r, r,
        hertz ? grain : "normal_stiffness: 1e9, kratio: 2", hertz ? "hertz" : "uniform",
        dimension == 3 ? "0, " : "", dimension == 3 ? ", -9" : "", dimension == 3 ? ", 9" : "");
    const size_t up = (size_t)dimension - 1;
    for (int n = 0; n < 40000; n++) {
        run_steps(w, 20);
        if (vel_of(w, 0)[up] > 0.0 && pos_of(w, 0)[up] > 10.001e-3 + r) break;
    }
    double e = vel_of(w, 0)[up] / 0.5;
    world_end(w);
    return e;
}

/* The dashpot uses the mass of the block, not that of the touched nodes. */
static void restitution_does_not_depend_on_the_mesh(void **state) {
    (void)state;
    const double radius[] = {0.5e-3, 2e-3, 6e-3};
    for (int k = 0; k < 3; k++) {
        assert_near(rebound(3, radius[k], BOUNCE_HELD, 0.0, false), 0.5, 0.01);
        assert_near(rebound(3, radius[k], BOUNCE_HELD, 5e8, false), 0.5, 0.01);
        assert_near(rebound(2, radius[k], BOUNCE_HELD, 0.0, false), 0.5, 0.01);
    }
    assert_near(rebound(3, 2e-3, BOUNCE_ROLLER, 0.0, false), 0.5, 0.01);
    assert_near(rebound(3, 2e-3, BOUNCE_HELD, 0.0, true), 0.5, 0.005);
}

/* A grain that is stiffer than the elements rebounds faster than requested (docs/physics.md). */
static void a_stiff_hertz_grain_rebounds_a_little_faster(void **state) {
    (void)state;
    assert_near(rebound(3, 0.5e-3, BOUNCE_HELD, 50e9, false), 0.505, 0.006);
    assert_near(rebound(3, 2e-3, BOUNCE_HELD, 50e9, false), 0.512, 0.006);
}

/* A block that nothing holds moves away like a free mass at its centre. */
static void a_free_block_of_elements_is_hit_as_a_whole(void **state) {
    (void)state;
    const double m = 2500.0 * M_PI * 1e-6, mass = 2400.0 * 20e-3 * 10e-3;
    const double lever = 0.6e-3, inertia = mass * (4e-4 + 1e-4) / 12.0;
    const double give = 1.0 / m + 1.0 / mass + lever * lever / inertia;
    assert_near(rebound(2, 1e-3, BOUNCE_FREE, 0.0, false), 1.5 / (m * give) - 1.0, 0.003);
}

/* --- particles that are large beside the facets --- */

/* A sphere (disc) of 20 mm on a block with cells of 1.25 mm, softer than the contact. `what`: the
 * motion of the particle; `step`: with steps of 2e-7 s instead of the automatic one. */
static gn_world *large(int dimension, const char *block, const char *contact, const char *what,
                       bool step) {
    return world_of(
        "dimension: %d\nspecimen: {particles: [[0.31e-3, %s 20e-3, 20e-3]], group: 0}\n"
        "materials: [{name: g, density: 2000, normal_stiffness: 1e12, kratio: 2}]\n"
        "law: {stiffness: uniform}\nelements: {%s, %s materials: [{young: 1e9, poisson: 0.25, "
        "density: 2000}], contact: {stiffness: %s, %s}}\n"
        "domain: {min: [-9, -9%s], max: [9, 9%s]}\nrun: {threads: 1}\ntime: {%send: 1}\n%s",
        dimension, dimension == 3 ? "0.22e-3," : "",
        dimension == 3 ? "box: {size: [10e-3, 10e-3, 5e-3], cells: [8, 8, 4], origin: [-5e-3, "
                         "-5e-3, -5e-3]}"
                       : "rectangle: {size: [40e-3, 20e-3], cells: [32, 16], origin: [-20e-3, "
                         "-20e-3]}",
        block, dimension == 3 ? "1e7" : "1e9", contact, dimension == 3 ? ", -9" : "",
        dimension == 3 ? ", 9" : "", step ? "step: 2e-7, " : "", what);
}

static const char *const held_base[] = {
    "motions: [{name: b, group: y_lower, motion: {vx: 0, vy: 0}}],",
    "motions: [{name: b, group: z_lower, motion: {vx: 0, vy: 0, vz: 0}}],"};

/* Returns the largest residual up to a time, over the energy throughput. */
static double worst_residual(gn_world *w, double end) {
    double worst = 0.0, pressed = 0.0, scale = 0.0;
    while (w->ctx.time < end) {
        run_steps(w, 20);
        gn_energy e = measured_step(w);
        scale = gn_energy_scale(&e);
        worst = fmax(worst, fabs(gn_energy_residual(&e)) * scale);
        pressed = fmax(pressed, e.elastic_elements);
    }
    assert_true(pressed > 1e-4);
    world_end(w);
    return worst / scale;
}

/* Contacts at the nearest points of facets would generate energy in each of these cases and stop
 * the run. The error of a pressure that stretches its facet is excluded: for the disc, which
 * strains the surface by a tenth, it is 2e-3 during the contact. */
static void a_large_particle_makes_no_energy(void **state) {
    (void)state;
    const char *const plain = "", *const rough = "kratio: 2, friction: 0.3";
    const char *const falls =
        "sets: [{name: s, select: {all: true}, initial_velocity: [0, 0, -0.2]}]";
    const char *const falls2 = "sets: [{name: s, select: {all: true}, initial_velocity: [0, -10]}]";
    const char *const pressed = "sets: [{name: s, select: {all: true}, motion: {vx: 0, vy: 0, vz: "
                                "[[0, 0], [20 us, -0.1], [0.2 ms, -0.1]]}}]";
    const char *const rolls = "sets: [{name: s, select: {all: true}, initial_velocity: [0.1, 0, "
                              "-0.2]}]\ndamping: {contact: {restitution: 0.6}}";
    assert_true(worst_residual(large(3, held_base[1], plain, falls, false), 0.5e-3) < 1e-3);
    assert_true(worst_residual(large(3, held_base[1], plain, pressed, false), 0.3e-3) < 1e-3);
    assert_true(worst_residual(large(2, held_base[0], plain, falls2, false), 0.25e-3) < 3e-3);
    assert_true(worst_residual(large(3, held_base[1], rough, rolls, false), 0.5e-3) < 2e-3);
}

/* Velocity and spin of a sphere that has bounced and slid on a plane. */
static void bounce_and_roll(bool wall, double out[4]) {
    const char *what = "sets: [{name: s, select: {all: true}, "
                       "initial_velocity: [0.3, 0.1, -0.2], initial_spin: [0, -5, 3]}]\ndamping: "
                       "{contact: {restitution: 0.5}}\n";
    const char *held = "motions: [{name: b, box: {min: [-1, -1, -1], max: [1, 1, 1]}, motion: {vx: "
                       "0, vy: 0, vz: 0}}],";
    char both[512];
    snprintf(both, sizeof both, "%s%s", what,
             wall ? "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e7, "
                    "kratio: 2, friction: 0.3}]\n"
                  : "");
    gn_world *w = large(3, held, wall ? "group: z_lower" : "kratio: 2, friction: 0.3", both, true);
    run_until(w, 0.5e-3);
    for (int a = 0; a < 2; a++) out[a] = vel_of(w, 0)[a];
    for (int a = 0; a < 2; a++) out[2 + a] = spin_of(w, 0)[a] * 20e-3;
    world_end(w);
}

static void a_large_particle_moves_on_a_plane_as_on_a_wall(void **state) {
    (void)state;
    double wall[4], elements[4];
    bounce_and_roll(true, wall);
    bounce_and_roll(false, elements);
    for (int a = 0; a < 4; a++) assert_near(elements[a], wall[a], 0.0005);
}

/* Momentum of a sphere that hits a free block is conserved to rounding. */
static void a_large_particle_keeps_momentum(void **state) {
    (void)state;
    const char *what = "sets: [{name: s, select: {all: true}, initial_velocity: [0.1, 0, -0.2], "
                       "initial_spin: [0, -5, 3]}]\ndamping: {contact: {restitution: 0.6}}";
    gn_world *w = large(3, "", "kratio: 2, friction: 0.3", what, false);
    const momentum before = momentum_of(w);
    run_until(w, 0.4e-3);
    const momentum after = momentum_of(w);
    assert_true(fabs(vel_of(w, 0)[2] + 0.2) > 1e-3);
    for (int a = 0; a < 3; a++) {
        assert_near(after.linear[a], before.linear[a], 1e-10 * before.linear_size);
        assert_near(after.angular[a], before.angular[a], 1e-10 * before.angular_size);
    }
    world_end(w);
}

/* A sphere of 4 mm that falls at 0.5 m/s onto a block with cells of 1 mm, at x, y (mm) of its upper
 * face, and slides at `slide` m/s along both directions. Returns the residual after it has
 * separated, relative to its initial energy, and its velocity. */
static double bounce_at(double x, double y, const char *law, double slide, double velocity[3]) {
    const bool hertz = strcmp(law, "hertz") == 0;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[%.17ge-3, %.17ge-3, 4e-3, 4e-3]], group: 0}\n"
        "materials: [{name: g, density: %s}]\nlaw: {stiffness: %s}\n"
        "elements: {box: {size: [10e-3, 10e-3, 4e-3], cells: [10, 10, 4], origin: [-5e-3, -5e-3, "
        "-4e-3]}, materials: [{young: 30e9, poisson: 0.25, density: 2000}], motions: [{name: b, "
        "group: z_lower, motion: {vx: 0, vy: 0, vz: 0}}], contact: {%s}}\n"
        "sets: [{name: s, select: {all: true}, initial_velocity: [%g, %g, -0.5]}]\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\nrun: {threads: 1}\ntime: {end: 1}\n",
        x, y,
        hertz ? "7850, young: 210e9, poisson: 0.3, restitution: 1"
              : "2000, normal_stiffness: 1e12, kratio: 2",
        law, hertz ? "material: g" : "stiffness: 1e6", slide, slide);
    const gn_energy before = measured_step(w);
    for (int n = 0; n < 2000 && !(vel_of(w, 0)[2] > 0.0 && pos_of(w, 0)[2] > 4.001e-3); n++)
        run_steps(w, 20);
    const gn_energy after = measured_step(w);
    memcpy(velocity, vel_of(w, 0), 3 * sizeof *velocity);
    world_end(w);
    return fabs(gn_energy_residual(&after)) * gn_energy_scale(&after) / before.kinetic;
}

/* The particle hits over a node, an edge, a diagonal, the middle of a cell, and along a
 * diagonal. */
static void a_large_particle_bounces_wherever_its_centre_is(void **state) {
    (void)state;
    const double places[][3] = {{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.5, 0.5, 0.0},
                                {1.0, 1.0, 0.0}, {0.3, 0.3, 0.0}, {-0.1, -0.1, 1.0}};
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        double v[3];
        assert_true(bounce_at(places[k][0], places[k][1], "uniform", places[k][2], v) < 1e-5);
        assert_near(v[2], 0.5, 1e-3);
        for (int a = 0; a < 2; a++) assert_near(v[a], places[k][2], 1e-3);
    }
}

/* A sphere by Hertz's law bounces near edges and corners, where a facet that is touched at its rim
 * only has a potential within rounding of 0. */
static void a_large_hertz_sphere_bounces_near_edges_and_corners(void **state) {
    (void)state;
    const double gaps[] = {0.0, 0.2, 0.5, 1.1, 2.3};
    for (size_t k = 0; k < sizeof gaps / sizeof *gaps; k++)
        for (int corner = 0; corner < 2; corner++) {
            const double x = 5.0 - gaps[k], y = corner ? 5.0 - 1.13 * gaps[k] : 0.31;
            double v[3];
            assert_true(bounce_at(x, y, "hertz", 0.0, v) < 1e-5);
            assert_near(sqrt(gn_dot3(v, v)), 0.5, 2e-3);
        }
}

/* --- the same bits --- */

static gn_world *make_shower(void) {
    return shower(3, "damping: {contact: {restitution: 0.7}}\ntime: {end: 1}\n");
}

static gn_world *make_large(void) {
    return large(3, "", "kratio: 2, friction: 0.3",
                 "sets: [{name: s, select: {all: true}, initial_velocity: [0.1, 0, -0.2], "
                 "initial_spin: [0, -5, 3]}]\ndamping: {contact: {restitution: 0.6}}",
                 false);
}

static void compare_bits(gn_world *make(void), int64_t steps, int64_t rebuilds) {
    char saved[64];
    snprintf(saved, sizeof saved, "/tmp/gneiss-contact-%d.h5", (int)getpid());
    gn_world *one = make(), *two = make();
    two->ctx.threads = 2;
    assert_int_equal(gn_dem_use_threads(&two->ctx, &two->dem, NULL), GNEISS_OK);
    run_steps(one, steps);
    run_steps(two, steps);
    assert_true(gn_world_hash(&one->ctx, &one->dem, &one->boundary, &one->solids, &one->box) ==
                gn_world_hash(&two->ctx, &two->dem, &two->boundary, &two->solids, &two->box));
    gn_run stopped = {0}, resumed;
    gneiss_error error = {0};
    stopped.world = *two;
    stopped.history_interval = 1;
    stopped.snapshot_span = 1.0;
    if (gn_history_create_columns(&stopped.world, &stopped.history, &error) != GNEISS_OK ||
        gn_checkpoint_write(&stopped, saved, &error) != GNEISS_OK ||
        gn_checkpoint_load(saved, NULL, 0, &resumed, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    gn_history_free(&stopped.history);
    unlink(saved);
    run_steps(one, steps);
    run_steps(&resumed.world, steps);
    assert_true(one->dem.verlet.rebuilds > rebuilds);
    assert_true(gn_world_hash(&one->ctx, &one->dem, &one->boundary, &one->solids, &one->box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    world_end(one);
    world_end(two);
    gn_run_free(&resumed);
}

static void threads_and_resume_give_the_same_bits(void **state) {
    (void)state;
    compare_bits(make_shower, 4000, 3);
    compare_bits(make_large, 1500, 0);
}

/* More facets inside a particle than its list can hold must not cause an unreported loss of force.
 * */
static void too_many_facets_at_once_are_refused(void **state) {
    (void)state;
    gn_world w;
    gneiss_error error = {0};
    const char *scene_text =
        "dimension: 3\nspecimen: {particles: [[0, 0, 99e-3, 100e-3]], group: 0}\n"
        "materials: [{name: g, density: 2000, normal_stiffness: 1e6, kratio: 2}]\n"
        "law: {stiffness: uniform}\nelements: {box: {size: [24e-3, 24e-3, 1e-3], cells: [24, 24, "
        "1], origin: [-12e-3, -12e-3, -1e-3]}, materials: [{young: 1e9, poisson: 0.2, density: "
        "2000}], contact: {stiffness: 1e6}}\ntime: {end: 1}\n";
    if (world_try(&w, scene_text, NULL, &error) == GNEISS_OK) fail_msg("made");
    if (!strstr(error.message, "512 facets")) fail_msg("%s", error.message);
}

/* The overlap that exceeds the available list of facets is known before the run. */
static void too_many_facets_are_announced(void **state) {
    (void)state;
    const double radius[] = {5e-3, 20e-3};
    for (int k = 0; k < 2; k++) {
        char doubts[GNEISS_MESSAGE_SIZE];
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, %g, %g]], group: 0}\n"
            "materials: [{name: g, density: 2000, normal_stiffness: 1e6, kratio: 2}]\n"
            "law: {stiffness: uniform}\nelements: {box: {size: [4e-3, 4e-3, 0.4e-3], cells: [20, "
            "20, 2], origin: [-2e-3, -2e-3, -0.4e-3]}, materials: [{young: 1e9, poisson: 0.2, "
            "density: 2000}], contact: {stiffness: 1e6}}\ndomain: {min: [-9, -9, -9], max: [9, 9, "
            "9]}\ntime: {end: 1}\n",
            radius[k], radius[k]);
        gn_elements_doubts(&w->ctx, &w->dem, &w->boundary, &w->solids, doubts, sizeof doubts);
        assert_true(k == (strstr(doubts, "512 facets of the elements at once") != NULL));
        assert_true(k == (strstr(doubts, "overlap of some 7.2e-05 m") != NULL));
        world_end(w);
    }
}

static void errors_say_where_and_what(void **state) {
    (void)state;
    const char *const scenes[][2] = {
        {"contact: {group: nowhere, stiffness: 1}", "nowhere"},
        {"contact: {stiffness: 1, friction: 0.3}", "elements.contact.kratio"},
        {"contact: {}", "elements.contact.stiffness"},
    };
    for (int k = 0; k < 3; k++) {
        char scene_text[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(scene_text, sizeof scene_text,
                 "dimension: 3\nspecimen: {particles: [[50, 0, 0, 1e-3]]}\nmaterials: [{name: m, "
                 "density: 2500, normal_stiffness: 1, kratio: 2}]\nlaw: {stiffness: uniform}\n"
                 "elements: {box: {size: [1, 1, 1], cells: [1, 1, 1]}, materials: [{young: 1e9, "
                 "poisson: 0.2, density: 2000}], %s}\ntime: {end: 1}\n",
                 scenes[k][0]);
        if (world_try(&w, scene_text, NULL, &error) == GNEISS_OK) fail_msg("%s", scenes[k][0]);
        if (!strstr(error.message, scenes[k][1]) || !strstr(error.message, "s.yaml:"))
            fail_msg("%s", error.message);
    }
}

/* Errors that only the mesh or the machine reveals are reported at their key, as errors of the
 * scene are. */
static void errors_of_the_mesh_are_reported_at_their_key(void **state) {
    (void)state;
    const char *const scenes[][3] = {
        {"contact: {stiffness: 1, group: nowhere}", "", "s.yaml:2:34: elements.contact.group: "},
        {"contact: {stiffness: 1,\n     group: nowhere}", "",
         "s.yaml:3:13: elements.contact.group: "},
        {"motions: [{name: a, group: no}]", "", "s.yaml:2:30: elements.motions[0].group: "},
        {"loads: [{force: {fx: 1}, group: no}]", "", "s.yaml:2:35: elements.loads[0].group: "},
        {"loads: [{force: {fx: 1}, box: {min: [5, 5, 5], max: [6, 6, 6]}}]", "",
         "s.yaml:2:11: elements.loads[0]: "},
        {"materials: [{young: 1e9, poisson: 0.2, density: 2000}, {young: 1e9, poisson: 0.2, "
         "density: 2000, group: no}]",
         "", "s.yaml:2:107: elements.materials[1].group: "},
        {"scale: 1", "run: {isa: ISA}", "run.isa: expected an instruction set that this machine"},
    };
    const char *away = NULL; /* a set that this machine lacks */
    for (int s = 1; s < GN_ISA_COUNT && !away; s++) {
        bool here = false;
        for (int k = 0; k < GN_KERNEL_SETS; k++)
            here = here || (strcmp(gn_kernel_set_at(k)->name, gn_isa_name((gn_isa)s)) == 0 &&
                            gn_kernel_set_supported(gn_kernel_set_at(k)));
        if (!here) away = gn_isa_name((gn_isa)s);
    }
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        char scene_text[1024], run[64] = "", want[128];
        gn_world w;
        gneiss_error error = {0};
        bool isa = *scenes[k][1];
        if (isa && !away) continue;
        if (isa) snprintf(run, sizeof run, "run: {isa: %s}", away);
        snprintf(scene_text, sizeof scene_text,
                 "elements:\n  %s\n  box: {size: [1, 1, 1], cells: [1, 1, 1]}\n%stime: {end: 1}\n"
                 "specimen: {particles: [[50, 0, 0, 1e-3]]}\nmaterials: [{name: m, "
                 "density: 2500, normal_stiffness: 1, kratio: 2}]\nlaw: {stiffness: uniform}\n%s\n",
                 isa ? "" : scenes[k][0],
                 strstr(scenes[k][0], "materials")
                     ? ""
                     : "  materials: [{young: 1e9, poisson: 0.2, density: 2000}]\n",
                 run);
        snprintf(want, sizeof want, "%s%s", isa ? "s.yaml:9:12: " : "", scenes[k][2]);
        if (world_try(&w, scene_text, NULL, &error) == GNEISS_OK) fail_msg("%s", scenes[k][0]);
        if (strncmp(error.message, want, strlen(want)) != 0)
            fail_msg("expected %s, found %s", want, error.message);
    }
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(particles_and_nodes_keep_momentum),
        cmocka_unit_test(threads_and_resume_give_the_same_bits),
        cmocka_unit_test(a_free_block_of_elements_is_hit_as_a_whole),
        cmocka_unit_test(a_large_particle_keeps_momentum),
        cmocka_unit_test(too_many_facets_at_once_are_refused),
        cmocka_unit_test(too_many_facets_are_announced),
        cmocka_unit_test(errors_say_where_and_what),
        cmocka_unit_test(errors_of_the_mesh_are_reported_at_their_key),
    };
    const struct CMUnitTest long_tests[] = {
        cmocka_unit_test(the_limit_includes_contacts_with_nodes),
        cmocka_unit_test(the_ledger_of_particles_and_elements_closes),
        cmocka_unit_test(restitution_does_not_depend_on_the_mesh),
        cmocka_unit_test(a_stiff_hertz_grain_rebounds_a_little_faster),
        cmocka_unit_test(a_large_particle_makes_no_energy),
        cmocka_unit_test(a_large_particle_moves_on_a_plane_as_on_a_wall),
        cmocka_unit_test(a_large_particle_bounces_wherever_its_centre_is),
        cmocka_unit_test(a_large_hertz_sphere_bounces_near_edges_and_corners),
    };
    return run_part(argc, tests, long_tests);
}
