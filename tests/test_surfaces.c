/* Particles on surfaces of triangles and segments. */
#include "surface_helpers.h"

static const double kn = 1e6, radius = 1e-3;

/* One sphere or disc over a support, `walls: [...]` or `bodies: [...]`. */
static gn_world *over(int dimension, double height, const char *support, const char *more) {
    const char *zero = dimension == 3 ? "0, 0, " : "0, ";
    return world_of("dimension: %d\nspecimen: {particles: [[%s%.17g, %g]], group: 0}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
                    "law: {stiffness: uniform}\ndomain: {min: [%s-9], max: [%s]}\n%s\n%s\n"
                    "time: {step: 1e-6, end: 9}\nrun: {threads: 1}\n",
                    dimension, zero, height, radius, dimension == 3 ? "-9, -9, " : "-9, ",
                    dimension == 3 ? "9, 9, 9" : "9, 9", more, support);
}

/* --- a plane of triangles is a plane --- */

/* Largest deviations so far of the quantities compared step by step. */
typedef struct deviation {
    double force, force_size, shear_size, speed, speed_size;
} deviation;

static void compare_step(gn_world *flat, gn_world *facets, deviation *d) {
    measured_step(flat);
    measured_step(facets);
    double off = 0.0, size = 0.0, speed = 0.0, speed_off = 0.0;
    for (int a = 0; a < 3; a++) {
        double f = flat->boundary.walls[0].force[a], g = facets->boundary.bodies[0].force[a];
        off += (f - g) * (f - g);
        size += f * f;
        double v = vel_of(flat, 0)[a], o = radius * spin_of(flat, 0)[a];
        speed += v * v + o * o;
        double dv = v - vel_of(facets, 0)[a], dw = o - radius * spin_of(facets, 0)[a];
        speed_off += dv * dv + dw * dw;
    }
    d->force = fmax(d->force, sqrt(off));
    d->force_size = fmax(d->force_size, sqrt(size));
    d->shear_size = fmax(d->shear_size, fabs(flat->boundary.walls[0].force[0]));
    d->speed = fmax(d->speed, sqrt(speed_off));
    d->speed_size = fmax(d->speed_size, sqrt(speed));
}

/* Returns true if a contact begins or ends with a step, to rounding: then one of the two has it a
 * step later. The effect of its dashpot in such a bounce differs by some hundredths. */
static bool are_split(const gn_world *flat, const gn_world *facets) {
    const double *f = flat->boundary.walls[0].force, *g = facets->boundary.bodies[0].force;
    return (gn_dot3(f, f) > 0.0) != (gn_dot3(g, g) > 0.0);
}

/* A series of bounces that become smaller and smaller amplifies rounding. The amplification is
 * measured by a second `shaken` particle over the same wall that starts a few roundings higher;
 * NULL: there is no amplification. One of the last bounces, of less than a thousandth of the force,
 * may separate them. */
static void same_run(gn_world *flat, gn_world *facets, gn_world *shaken, int64_t steps) {
    deviation d = {0};
    double grown = 0.0;
    for (int64_t k = 0; k < steps; k++) {
        deviation before = d;
        compare_step(flat, facets, &d);
        if (shaken && are_split(flat, facets)) {
            assert_true(k > steps / 3 && d.force < 1e-3 * d.force_size);
            run_steps(flat, steps - k - 1);
            run_steps(facets, steps - k - 1);
            d = before;
            break;
        }
        if (shaken) {
            run_steps(shaken, 1);
            grown = fmax(
                grown, fabs(flat->boundary.walls[0].force[2] - shaken->boundary.walls[0].force[2]));
        }
        assert_true(d.force <= 1e-6 * d.force_size + 30.0 * grown);
        if (k == steps / 3) assert_true(grown < 1e-8 * d.force_size); /* many bounces later */
    }
    assert_true(d.force_size > 0.0 && d.shear_size > 0.01 * d.force_size);
    double allowed = fmax(1e-6, 30.0 * grown / d.force_size);
    assert_true(d.speed <= allowed * d.speed_size);
    gn_energy a = flat->ledger.reading, b = facets->ledger.reading;
    double work = fabs(a.work_walls) + fabs(a.work_gravity);
    assert_near(a.work_walls, b.work_walls, allowed * work);
    assert_near(a.friction, b.friction, allowed * work);
    assert_near(a.contact_damping, b.contact_damping, allowed * work);
    assert_near(a.elastic_wall, b.elastic_wall, allowed * work);
    assert_near(a.rotational, b.rotational, allowed * work);
}

/* A particle bounces, slides and rolls over many facets of a plate that moves as well; gravity is
 * inclined. */
static void plane_of_triangles(uint64_t seed, const char *damping) {
    soup *s = calloc(1, sizeof *s);
    char path[32], support[512], wall[512], more[512];
    random_plane(s, seed, 16, 0.03);
    write_soup(s, path);
    snprintf(more, sizeof more,
             "gravity: [2, 3, -10]\n%s\nsets: [{name: a, select: {all: true}, initial_velocity: "
             "[0.2, -0.35, -0.1], initial_spin: [100, 50, 200]}]",
             damping);
    const char *law = "stiffness: 1e6, kratio: 2, friction: 0.3, motion: {vx: 0.1, vz: 0.05}";
    snprintf(wall, sizeof wall, "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], %s}]", law);
    gn_world *flat = over(3, 1.05e-3, wall, more);
    snprintf(support, sizeof support, "bodies: [{name: w, surface: %s, %s}]", path, law);
    gn_world *facets = over(3, 1.05e-3, support, more);
    gn_world *shaken = over(3, 1.05e-3 * (1.0 + 4e-16), wall, more);
    same_run(flat, facets, shaken, 60000);
    world_end(shaken);
    /* The sphere has moved from one end of the plate to the other. */
    assert_true(length3(pos_of(flat, 0)) > 0.01);
    world_end(flat);
    world_end(facets);
    unlink(path);
    free(s);
}

static void a_plane_of_random_triangles_is_a_plane(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) plane_of_triangles(seed, "");
}

static void it_is_a_plane_with_damping_too(void **state) {
    (void)state;
    for (uint64_t seed = 5; seed <= 8; seed++)
        plane_of_triangles(seed, "damping: {contact: {restitution: 0.5}}");
}

static void a_line_of_random_segments_is_a_line(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        text t = {0};
        uint64_t at = 77 * seed;
        char support[256];
        const char *more =
            "gravity: [3, -10]\ndamping: {contact: {restitution: 0.7}}\nsets: [{name: a, select: "
            "{all: true}, initial_velocity: [0.2, -0.1], initial_spin: -30}]";
        const char *law = "stiffness: 1e6, kratio: 2, friction: 0.3, motion: {vx: 0.1, vy: 0.05}";
        add(&t, "bodies: [{name: w, polyline: [[-0.06, 0]");
        for (double x = -0.06; x < 0.06;) {
            x += uniform(&at, 1e-4, 2e-3);
            add(&t, ", [%.17g, 0]", x);
        }
        add(&t, "], %s}]", law);
        snprintf(support, sizeof support, "walls: [{name: w, point: [0, 0], normal: [0, 1], %s}]",
                 law);
        gn_world *flat = over(2, 1.05e-3, support, more), *facets = over(2, 1.05e-3, t.s, more);
        same_run(flat, facets, NULL, 60000);
        world_end(flat);
        world_end(facets);
    }
}

/* Planes of three times the angle of rounding, folded along a random line that the particle crosses
 * at an angle: the two planes agree with the one up to the fold. */
static void a_nearly_flat_fold_is_nearly_flat(void **state) {
    (void)state;
    const double folds[] = {1e-12, 1e-9, 1e-7, -1e-12, -1e-9, -1e-7};
    const char *more = "gravity: [0, -10]\nsets: [{name: a, select: {all: true}, "
                       "initial_velocity: [0.5, 0], initial_spin: -10}]";
    const char *law = "stiffness: 1e6, kratio: 2, friction: 0.3";
    char support[256];
    for (int k = 0; k < 6; k++) {
        double h = radius - disc_mass(2500, radius) * 10.0 /
                                kn; /* overlap at which the disc is in balance */
        snprintf(support, sizeof support,
                 "bodies: [{name: w, polyline: [[-0.05, 0], [2e-3, 0], [0.05, %.17g]], %s}]",
                 0.048 * folds[k], law);
        gn_world *bent = over(2, h, support, more);
        snprintf(support, sizeof support, "walls: [{name: w, point: [0, 0], normal: [0, 1], %s}]",
                 law);
        gn_world *flat = over(2, h, support, more);
        deviation d = {0};
        for (int step = 0; step < 10000; step++) compare_step(flat, bent, &d);
        assert_true(pos_of(flat, 0)[0] > 3e-3);
        /* At the kink the sphere hits with the velocity v fold, which causes a force of kn v
         * fold/w, w^2 = kn/m. */
        double hit = 0.5 * fabs(folds[k]) * sqrt(kn * disc_mass(2500, radius));
        assert_true(d.force <= 1e-6 * d.force_size + 2.0 * hit);
        world_end(bent);
        world_end(flat);
    }
}

/* --- faces, edges, corners --- */

/* Rebound velocity along `away` (unit) of a sphere that comes at 1 m/s against a body. */
static double rebound(const char *shape, const double away[3], double restitution) {
    double start = radius + 100.5 * 1e-7,
           r3 = radius; /* the sphere touches in the middle of a step */
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[%.17g, %.17g, %.17g, %.17g]], group: 0}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\ndamping: {contact: {restitution: %g}}\n%s\n"
                 "sets: [{name: a, select: {all: true}, initial_velocity: [%.17g, %.17g, %.17g]}]\n"
                 "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {step: 1e-7, end: 9}\n"
                 "run: {threads: 1}\n",
                 start * away[0], start * away[1], start * away[2], r3, restitution, shape,
                 -away[0], -away[1], -away[2]);
    for (int k = 0; k < 12000; k++) measured_step(w);
    double speed = dot3(vel_of(w, 0), away), v[3];
    memcpy(v, vel_of(w, 0), sizeof v);
    for (int a = 0; a < 3; a++) v[a] -= speed * away[a];
    assert_true(length3(v) < 1e-9); /* straight back */
    world_end(w);
    return speed;
}

static void faces_edges_and_corners_rebound_as_walls_do(void **state) {
    (void)state;
    const double face[3] = {0, 0, 1}, edge[3] = {0, sqrt(0.5), sqrt(0.5)},
                 corner[3] = {sqrt(1. / 3), sqrt(1. / 3), sqrt(1. / 3)};
    for (int k = 0; k < 3; k++) {
        double e = (double[]){0.3, 0.7, 1.0}[k];
        double wall = rebound(
            "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6}]", face, e);
        assert_near(wall, e, 0.01);
        /* the force law is the same, so that only rounding differs */
        assert_near(rebound("bodies: [{name: w, box: {size: [0.1, 0.1, 0.1]}, origin: [-0.05, "
                            "-0.05, -0.1], stiffness: 1e6}]",
                            face, e),
                    wall, 1e-9);
        assert_near(rebound("bodies: [{name: w, box: {size: [0.1, 0.1, 0.1]}, origin: [-0.05, "
                            "-0.1, -0.1], stiffness: 1e6}]",
                            edge, e),
                    wall, 1e-9);
        assert_near(rebound("bodies: [{name: w, box: {size: [0.1, 0.1, 0.1]}, origin: [-0.1, "
                            "-0.1, -0.1], stiffness: 1e6}]",
                            corner, e),
                    wall, 1e-9);
    }
}

/* --- concave corners --- */

/* A disc that falls into a groove whose sides rise at the two angles. */
static void groove_is_two_walls(double left, double right) {
    text t = {0};
    const char *more = "gravity: [0, -10]\ndamping: {contact: {restitution: 0.6}}\nsets: [{name: "
                       "a, select: {all: true}, initial_velocity: [0.02, 0], initial_spin: 20}]";
    const char *law = "stiffness: 1e6, kratio: 2, friction: 0.3";
    add(&t, "bodies: [{name: w, polyline: [[%.17g, %.17g], [0, 0], [%.17g, %.17g]], %s}]",
        -0.1 * cos(left), 0.1 * sin(left), 0.1 * cos(right), 0.1 * sin(right), law);
    double height = 1.05 * radius / sin(0.5 * (pi - left - right));
    gn_world *groove = over(2, height, t.s, more);
    t.used = 0;
    add(&t,
        "walls: [{name: p, point: [0, 0], normal: [%.17g, %.17g], %s}, {name: q, point: [0, 0], "
        "normal: [%.17g, %.17g], %s}]",
        sin(left), cos(left), law, -sin(right), cos(right), law);
    gn_world *walls = over(2, height, t.s, more);
    double most = 0.0, worst = 0.0;
    for (int k = 0; k < 40000; k++) {
        measured_step(groove);
        measured_step(walls);
        for (int a = 0; a < 2; a++) {
            double f = walls->boundary.walls[0].force[a] + walls->boundary.walls[1].force[a];
            most = fmax(most, fabs(f));
            worst = fmax(worst, fabs(f - groove->boundary.bodies[0].force[a]));
        }
    }
    assert_true(most > 0.0 && worst <= 1e-6 * most);
    assert_near(spin_of(walls, 0)[2], spin_of(groove, 0)[2], 1e-5);
    world_end(groove);
    world_end(walls);
}

static void a_groove_is_two_walls(void **state) {
    (void)state;
    groove_is_two_walls(pi / 4, pi / 4);
    groove_is_two_walls(pi / 6, pi / 3);
    groove_is_two_walls(0.3, 0.3);
    groove_is_two_walls(1.2, 0.9);
}

/* A sphere is in a box, and at the three walls of its corner. While it alternates between sliding
 * and sticking, each bounce in the corner amplifies rounding by about 30: the total is measured by
 * a sphere at the same walls that starts a few roundings higher. */
static void the_corner_of_a_box_is_three_walls(void **state) {
    (void)state;
    const char *more = "gravity: [-3, -4, -10]\ndamping: {contact: {restitution: 0.1}}\nsets: "
                       "[{name: a, select: {all: true}, "
                       "initial_velocity: [0.01, 0.02, 0]}]";
    const char *box = "bodies: [{name: w, box: {size: [0.02, 0.02, 0.02]}, origin: [-1.02e-3, "
                      "-1.01e-3, 0], stiffness: 1e6, kratio: 2, friction: 0.3}]";
    const char *walls =
        "walls: [{name: p, point: [-1.02e-3, 0, 0], normal: [1, 0, 0], stiffness: 1e6, kratio: 2, "
        "friction: 0.3}, {name: q, point: [0, -1.01e-3, 0], normal: [0, 1, 0], stiffness: 1e6, "
        "kratio: 2, friction: 0.3}, {name: r, point: [0, 0, 0], normal: [0, 0, 1], stiffness: "
        "1e6, kratio: 2, friction: 0.3}]";
    gn_world *a = over(3, 1.03e-3, box, more), *b = over(3, 1.03e-3, walls, more);
    gn_world *shaken = over(3, 1.03e-3 * (1.0 + 4e-16), walls, more);
    double most = 0.0, grown = 0.0;
    for (int k = 0; k < 30000; k++) {
        measured_step(a);
        measured_step(b);
        measured_step(shaken);
        for (int d = 0; d < 3; d++) {
            double f = 0.0, g = 0.0;
            for (int s = 0; s < 3; s++) {
                f += b->boundary.walls[s].force[d];
                g += shaken->boundary.walls[s].force[d];
            }
            most = fmax(most, fabs(f));
            grown = fmax(grown, fabs(f - g));
            assert_near(f, a->boundary.bodies[0].force[d], 1e-9 * most + 30.0 * grown);
        }
        if (k == 9000) assert_true(most > 0.0 && grown < 1e-8 * most); /* many bounces later */
    }
    world_end(shaken);
    for (int d = 0; d < 3; d++)
        assert_true(b->boundary.walls[d].force[d] < 0.0); /* the sphere is in the corner */
    world_end(a);
    world_end(b);
}

/* --- no jumps, no energy from nowhere --- */

/* A disc slides without friction over a profile; the force changes in a step by at most its bound,
 * and the energy is constant. */
static void slide_over(const char *profile, double speed, double dt_allowed) {
    char more[256];
    snprintf(more, sizeof more,
             "gravity: [0, -10]\nsets: [{name: a, select: {all: true}, initial_velocity: [%g, 0]}]",
             speed);
    double m = disc_mass(2500, radius);
    gn_world *w = over(2, radius - m * 10.0 / kn, profile, more);
    double before[2] = {0, 0}, jump = 0.0, most = 0.0;
    gn_energy e = measured_step(w);
    double scale = e.kinetic;
    for (int k = 0; k < 60000; k++) {
        memcpy(before, w->boundary.bodies[0].force, sizeof before);
        e = measured_step(w);
        if (k == 0) continue;
        for (int a = 0; a < 2; a++) {
            jump = fmax(jump, fabs(w->boundary.bodies[0].force[a] - before[a]));
            most = fmax(most, fabs(w->boundary.bodies[0].force[a]));
        }
        double now = e.kinetic + e.elastic_wall - e.work_gravity;
        assert_near(now, scale, 1e-3 * scale);
    }
    assert_true(pos_of(w, 0)[0] > 8e-3);
    /* k v dt is the change of the force of a spring in a step. */
    assert_true(jump <= dt_allowed * kn * 2.0 * speed * w->ctx.dt);
    assert_true(most > 0.0);
    world_end(w);
}

static void shallow_folds_make_no_jump(void **state) {
    (void)state;
    /* Concave and convex by 0.5, 3, 10 and 20 degrees. */
    const char *const profiles[] = {
        "[[-0.05, 0], [2e-3, 0], [4e-3, 1.75e-5], [6e-3, 0], [0.1, 0]]",
        "[[-0.05, 0], [2e-3, 0], [4e-3, 1.05e-4], [6e-3, 1.05e-4], [0.1, 0.003]]",
        "[[-0.05, 0], [2e-3, 0], [4e-3, 3.5e-4], [6e-3, 4e-4], [0.1, 4e-4]]",
        "[[-0.05, 0], [2e-3, 0], [4e-3, 7.3e-4], [6e-3, 7.5e-4], [0.1, 7.5e-4]]",
    };
    for (int k = 0; k < 4; k++) {
        char support[256];
        snprintf(support, sizeof support, "bodies: [{name: w, polyline: %s, stiffness: 1e6}]",
                 profiles[k]);
        slide_over(support, 0.6, 1.5);
    }
}

static void a_convex_edge_and_a_step_keep_energy(void **state) {
    (void)state;
    slide_over("bodies: [{name: w, polyline: [[-0.05, 0], [2e-3, 0], [3e-3, -1e-3], [5e-3, -1e-3], "
               "[0.1, -1e-3]], stiffness: 1e6}]",
               0.3, 1e9);
}

/* --- plates --- */

/* A plate thinner than the overlap that its spheres make, one above and one below: each feels one
 * plate. */
static void a_thin_plate_is_touched_from_both_sides(void **state) {
    (void)state;
    const char *const plates[] = {"box: {size: [0.04, 0.04, 2e-6]}, origin: [-0.02, -0.02, -1e-6]",
                                  "box: {size: [0.04, 0.04, 2e-4]}, origin: [-0.02, -0.02, -1e-4]"};
    for (int k = 0; k < 2; k++) {
        double half = k ? 1e-4 : 1e-6, gap = -1e-5; /* overlap 10 um, thickness 2 um, 200 um */
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0.3e-3, 0.1e-3, %.17g, 1e-3], [5e-3, 0, %.17g, "
            "1e-3], [20e-3, 0, %.17g, 1e-3]], group: 0}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
            "law: {stiffness: uniform}\nbodies: [{name: p, %s, stiffness: 1e6}]\n"
            "time: {step: 1e-9, end: 1}\nrun: {threads: 1}\n",
            1e-3 + half + gap, -1e-3 - half - gap, 1e-3 + half + gap, plates[k]);
        measured_step(w);
        double f = kn * 1e-5; /* v after the first half step is F dt/(2 m) */
        double unit = 0.5 * w->ctx.dt / mass_of(w, 0);
        assert_close(vel_of(w, 0)[2], f * unit, 1e-6);
        assert_close(vel_of(w, 1)[2], -f * unit, 1e-6);
        /* The centre is above the rim: the contact is with the edge, straight below it. */
        assert_close(vel_of(w, 2)[2], f * unit, 1e-6);
        world_end(w);
    }
}

/* --- a centre on a surface --- */

static void a_centre_on_a_surface_is_refused_by_name(void **state) {
    (void)state;
    const char *const scenes[][2] = {
        {"bodies: [{name: slab, stiffness: 1e6, box: {size: [1, 1, 1]}, origin: [-0.5, -0.5, -1]}]",
         "particle 0: centre on the surface of body 'slab'"},
        {"elements: {box: {size: [1, 1, 1], origin: [-0.5, -0.5, -1], cells: [1, 1, 1]}, "
         "materials: [{young: 1e9, poisson: 0.2, density: 2000}], contact: {stiffness: 1e6}}",
         "particle 0: centre on the surface of the elements"},
    };
    for (int k = 0; k < 2; k++) {
        char scene_text[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(scene_text, sizeof scene_text,
                 "dimension: 3\nspecimen: {particles: [[0.1, 0.2, 0, 1e-3]], group: 0}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
                 "law: {stiffness: uniform}\n%s\ntime: {end: 1}\nrun: {threads: 1}\n",
                 scenes[k][0]);
        assert_int_equal(world_try(&w, scene_text, NULL, &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, scenes[k][1])) fail_msg("'%s'", error.message);
    }
}

static void a_centre_that_comes_to_a_surface_stops_the_run_by_name(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world *w = over(3, 0.5 * radius,
                       "bodies: [{name: slab, stiffness: 1e6, box: {size: [1, 1, 1]}, "
                       "origin: [-0.4, -0.4, -1]}]",
                       "");
    measured_step(w);
    w->dem.particles.pos[2] = w->boundary.bodies[0].position[2];
    assert_int_equal(gn_world_rebuild(w, &error), GNEISS_ERROR_UNSTABLE);
    if (!strstr(error.message, "surface of body 'slab'")) fail_msg("'%s'", error.message);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_of_random_triangles_is_a_plane),
        cmocka_unit_test(it_is_a_plane_with_damping_too),
        cmocka_unit_test(a_line_of_random_segments_is_a_line),
        cmocka_unit_test(a_nearly_flat_fold_is_nearly_flat),
        cmocka_unit_test(faces_edges_and_corners_rebound_as_walls_do),
        cmocka_unit_test(a_groove_is_two_walls),
        cmocka_unit_test(the_corner_of_a_box_is_three_walls),
        cmocka_unit_test(shallow_folds_make_no_jump),
        cmocka_unit_test(a_convex_edge_and_a_step_keep_energy),
        cmocka_unit_test(a_thin_plate_is_touched_from_both_sides),
        cmocka_unit_test(a_centre_on_a_surface_is_refused_by_name),
        cmocka_unit_test(a_centre_that_comes_to_a_surface_stops_the_run_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
