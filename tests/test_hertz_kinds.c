/* By Hertz's law restitution and resistance to rolling hold for every object that a sphere can
 * touch: other spheres, rigid walls, walls with a material, a fixed body, a free one, finite
 * elements. */
#include "world_helpers.h"

/* --- restitution --- */

typedef enum kind { PAIR, RIGID, MATERIAL, FACE, FREE, ELEMENTS, KINDS } kind;
static const char *const kind_name[] = {"pair",           "rigid wall", "wall of a material",
                                        "face of a body", "free body",  "finite elements"};

static const double r = 2.5e-3, density = 4000.0, young = 1e10, poisson = 0.23;

/* Effective Hertz parameters of the sphere and the other object: E*, R and 1/m of both. */
static void pair_of(kind k, double *modulus, double *radius, double *inverse) {
    double alone = young / (1.0 - poisson * poisson), mass = sphere_mass(density, r);
    *modulus = k == RIGID ? alone : 0.5 * alone;
    *radius = k == PAIR ? 0.5 * r : r;
    *inverse = 1.0 / mass;
    if (k == PAIR) *inverse *= 2.0;
    if (k == FREE) *inverse += 1.0 / (density * 1e-6); /* a cube of 10 mm */
}

/* Half a wave of the stiffness at the deepest point of an undamped impact: an automatic step is a
 * twelfth of that, or less. */
static double wave_of(kind k, double v) {
    double modulus, radius, inverse;
    pair_of(k, &modulus, &radius, &inverse);
    double u = pow(15.0 * v * v / (16.0 * modulus * sqrt(radius) * inverse), 0.4);
    return pi / sqrt(2.0 * modulus * sqrt(radius * u) * inverse);
}

static void add_other(text *t, kind k) {
    const char *wall = "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1]";
    if (k == RIGID) add(t, "%s}]\n", wall);
    if (k == MATERIAL) add(t, "%s, material: s}]\n", wall);
    if (k == FACE || k == FREE)
        add(t,
            "bodies: [{name: b, box: {size: [10 mm, 10 mm, 10 mm]}, origin: [-5 mm, -5 mm, -10 "
            "mm], material: s%s}]\n",
            k == FREE ? ", free: true, density: 4000" : "");
    if (k == ELEMENTS)
        add(t, "elements: {box: {size: [12 mm, 12 mm, 4 mm], cells: [2, 2, 1], origin: [-5 mm, -5 "
               "mm, -4 mm]}, materials: [{young: 1e3, poisson: 0.2, density: 1000}], contact: "
               "{material: s}, motions: [{name: all, group: body, motion: {vx: 0, vy: 0, vz: "
               "0}}]}\n");
}

/* Returns the speed of separation over that of approach (v, m/s). `steps` per half wave; 0:
 * automatic. */
static double rebound(kind k, double v, double mine, double other, const char *contacts,
                      double steps) {
    text t = {0};
    double wave = wave_of(k, v), gap = 1e-3 * r, step = steps > 0.0 ? wave / steps : 0.0;
    if (steps > 0.0) gap = 1.3 * v * step;
    add(&t, "dimension: 3\nspecimen: {particles: [[0, 0, %.17g, %.17g]", r + gap, r);
    if (k == PAIR) add(&t, ", [0, 0, %.17g, %.17g]", -r, r);
    add(&t,
        "], group: 0, material: m}\nmaterials: [{name: m, density: %g, young: %g, poisson: %g, "
        "restitution: %g}, {name: s, density: %g, young: %g, poisson: %g, restitution: %g}]\n"
        "%slaw: {stiffness: hertz}\nsets: [{name: a, select: {ids: [0]}, initial_velocity: [0, 0, "
        "%.17g]}%s]\n",
        density, young, poisson, mine, density, young, poisson, other, contacts, -v,
        k == PAIR ? ", {name: b, select: {ids: [1]}, material: s}" : "");
    add_other(&t, k);
    add(&t, "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {");
    if (steps > 0.0) add(&t, "step: %.17g, ", step);
    add(&t, "end: 1000}\nrun: {threads: 1}\n");
    gn_world *w = world_of("%s", t.s);
    double end = gap / v + 6.0 * wave; /* the slowest case needs 3 */
    while (w->ctx.time < end) run_steps(w, 1);
    double back = vel_of(w, 0)[2];
    if (k == PAIR) back -= vel_of(w, 1)[2];
    if (k == FREE) back -= w->boundary.bodies[0].velocity[2];
    world_end(w);
    return back / v;
}

/* The speeds cover three decades, with steps so short that their error is negligible. */
static void restitution_is_as_requested_for_any_pair(void **state) {
    (void)state;
    const double asked[] = {0.5, 0.9};
    for (int k = 0; k < KINDS; k++)
        for (int e = 0; e < 2; e++)
            for (double v = 0.01; v < 20.0; v *= 10.0) {
                double got = rebound(k, v, asked[e], asked[e], "", 400);
                if (!(fabs(got - asked[e]) < 5e-4 * asked[e]))
                    fail_msg("%s at %g m/s: %g for %g", kind_name[k], v, got, asked[e]);
            }
}

/* Errors: 1 % from a restitution of 0.5 on, 0.01 below. */
static void restitution_is_kept_by_automatic_steps(void **state) {
    (void)state;
    const double asked[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.9};
    double worst = 0.0;
    for (int k = 0; k < KINDS; k++)
        for (int e = 0; e < 6; e++)
            for (double v = 0.01; v < 20.0; v *= 31.0) {
                double got = rebound(k, v, asked[e], asked[e], "", 0), off = fabs(got - asked[e]);
                worst = fmax(worst, off);
                if (!(off < (asked[e] < 0.5 ? 0.01 : 0.01 * asked[e])))
                    fail_msg("%s at %g m/s: %g for %g", kind_name[k], v, got, asked[e]);
            }
    print_message("# restitution off by %.2g at most\n", worst);
}

/* The smaller value of two materials, or that of the pair. */
static void restitution_of_a_pair_goes_over_that_of_materials(void **state) {
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        double lower = rebound(k, 1.0, 0.9, 0.6, "", 400), want = k == RIGID ? 0.9 : 0.6;
        assert_near(lower, want, 5e-4);
        double own =
            rebound(k, 1.0, 0.9, 0.6, "contacts: [{between: [m, s], restitution: 0.3}]\n", 400);
        assert_near(own, k == RIGID ? 0.9 : 0.3, 5e-4);
    }
}

/* --- rolling --- */

/* m: the overlap at rest of a sphere (disc) of 10 mm, loaded by its weight along the normal on 1e6
 * N/m, or by Hertz's law on an equal one. */
static double rest(bool hertz, bool space, double along) {
    double mass = space ? sphere_mass(2500, 0.01) : 2500 * pi * 1e-4, force = mass * along;
    double modulus = 0.5 * 1e8 / (1.0 - 0.09);
    return hertz ? pow(0.75 * force / (modulus * 0.1), 2.0 / 3.0) : force / 1e6;
}

/* A sphere (disc) on a plane, by Hertz's law or (also a disc) by the linear one. */
static gn_world *roller(bool hertz, int dimension, double friction, double rolling, double v0,
                        double slope) {
    const double turn = atan(slope), along = 9.81 * sin(turn), down = -9.81 * cos(turn);
    const bool space = dimension == 3;
    text t = {0};
    add(&t, "dimension: %d\nspecimen: {particles: [[0, %s%.17g, 0.01]], group: 0}\n", dimension,
        space ? "0, " : "", 0.01 - rest(hertz, space, -down));
    add(&t,
        "materials: [{name: m, density: 2500, %s, friction: %.17g, rolling_friction: %.17g}]\n"
        "law: {stiffness: %s}\n%sgravity: [%.17g, %s%.17g]\n"
        "walls: [{name: w, point: [0, 0%s], normal: [0, %s1], ",
        hertz ? "young: 1e8, poisson: 0.3, restitution: 0.3" : "normal_stiffness: 1e6, kratio: 2",
        friction, rolling, hertz ? "hertz" : "uniform",
        hertz ? "" : "damping: {contact: {restitution: 0.3}}\n", along, space ? "0, " : "", down,
        space ? ", 0" : "", space ? "0, " : "");
    if (hertz)
        add(&t, "material: m}]\n");
    else
        add(&t, "stiffness: 1e6, kratio: 2, friction: %.17g, rolling_friction: %.17g}]\n", friction,
            rolling);
    add(&t,
        "sets: [{name: a, select: {all: true}, initial_velocity: [%.17g, 0%s], initial_spin: "
        "%s%.17g%s}]\ntime: {end: 10}\nrun: {threads: 1}\n",
        v0, space ? ", 0" : "", space ? "[0, " : "", space ? v0 / 0.01 : -v0 / 0.01,
        space ? ", 0]" : "");
    return world_of("%s", t.s);
}

/* On a slope a hundredth below the resistance a sphere rests, except for the oscillation of the
 * spring; a hundredth above it the sphere rolls with the remaining part of its weight, which is so
 * small that the overlap, by which its arm is reduced, matters. */
static void a_sphere_on_an_incline_is_held_up_to_the_resistance(void **state) {
    (void)state;
    const double mu = 0.1;
    for (int hertz = 0; hertz < 2; hertz++)
        for (int above = 0; above < 2; above++) {
            double slope = (above ? 1.01 : 0.99) * mu, x[3];
            gn_world *w = roller(hertz, 3, 0.5, mu, 0.0, slope);
            for (int k = 0; k < 3; k++) {
                run_until(w, 0.2 + 0.3 * k);
                x[k] = pos_of(w, 0)[0];
            }
            double pull = (x[2] - 2.0 * x[1] + x[0]) / 0.09;
            double c = cos(atan(slope)), arm = 1.0 - rest(hertz, true, 9.81 * c) / 0.01;
            double want = 5.0 / 7.0 * 9.81 * c * (arm * slope - mu);
            print_message("# incline %.3g: pull %.4g of %.4g, way %.3g\n", slope, pull, want,
                          x[2] - x[1]);
            if (above) assert_near(pull, want, 0.02 * want);
            if (!above) assert_near(x[2] - x[1], 0.0, 1e-6);
            world_end(w);
        }
}

/* A sphere slips from tan = 3.5 mu - 2.5 mu_r on: below that it rolls with (5/7) g (sin - mu_r
 * cos), beyond it slides with g (sin - mu cos) while friction accelerates its spin with 2.5 (mu -
 * mu_r) g cos. */
static void a_sphere_rolls_or_slips_down_an_incline(void **state) {
    (void)state;
    const double mu = 0.3, mu_r = 0.1, limit = 3.5 * mu - 2.5 * mu_r;
    for (int hertz = 0; hertz < 2; hertz++)
        for (int slips = 0; slips < 2; slips++) {
            double slope = (slips ? 1.02 : 0.98) * limit, c = cos(atan(slope)), v[2], s[2];
            gn_world *w = roller(hertz, 3, mu, mu_r, 0.0, slope);
            for (int k = 0; k < 2; k++) {
                run_until(w, 0.1 + 0.2 * k);
                v[k] = vel_of(w, 0)[0];
                s[k] = 0.01 * spin_of(w, 0)[1];
            }
            double pull = (v[1] - v[0]) / 0.2, spun = (s[1] - s[0]) / 0.2;
            double rolls = 5.0 / 7.0 * 9.81 * c * (slope - mu_r);
            assert_near(pull, slips ? 9.81 * c * (slope - mu) : rolls, 2e-3 * pull);
            assert_near(spun, slips ? 2.5 * 9.81 * c * (mu - mu_r) : rolls, 2e-3 * pull);
            if (slips) assert_true(v[1] - s[1] > 0.01);
            world_end(w);
        }
}

/* With dv/dt = -(2/3) mu_r g it stops after 3 v0^2/(4 mu_r g). */
static void a_rolling_disc_stops_where_resistance_says(void **state) {
    (void)state;
    const double mu = 0.05, v0 = 0.2, way = 3.0 * v0 * v0 / (4.0 * mu * 9.81);
    gn_world *w = roller(false, 2, 0.5, mu, v0, 0.0);
    run_until(w, 0.3);
    assert_near(vel_of(w, 0)[0], v0 - 2.0 / 3.0 * mu * 9.81 * 0.3, 0.01 * v0);
    run_until(w, 1.2 * 2.0 * way / v0);
    assert_near(pos_of(w, 0)[0], way, 0.01 * way);
    world_end(w);
}

/* After the sphere has stopped, the moment spring continues to oscillate, damped by nothing but
 * other dissipation. Both springs then store at most their energy at the limit, (mu_r m g)^2/(2
 * k_t) and 25/49 of that: 1/2 m v^2 is smaller. */
static void the_moment_spring_oscillates_after_rolling_stops(void **state) {
    (void)state;
    const double mu = 0.05, v0 = 0.2, kt = 0.5e6;
    gn_world *w = roller(false, 3, 0.5, mu, v0, 0.0);
    double most[2] = {0, 0}, mass = mass_of(w, 0);
    run_until(w, 1.0);
    for (int k = 0; k < 2; k++) {
        double end = w->ctx.time + 0.5;
        while (w->ctx.time < end) {
            run_steps(w, 1);
            most[k] = fmax(most[k], fabs(vel_of(w, 0)[0]));
        }
    }
    double bound = mu * 9.81 * sqrt(74.0 / 49.0 * mass / kt);
    print_message("# swings on at %.3g, then %.3g m/s; at most %.3g\n", most[0], most[1], bound);
    assert_true(most[0] > 0.0 && most[0] < bound);
    assert_near(most[1], most[0], 0.1 * most[0]);
    world_end(w);
}

/* --- momentum --- */

/* Spheres of two sizes that fly at each other, with friction, rolling and twisting resistance. */
static void momentum_stays_in_collisions_that_resist_rolling(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 2e-3, cells: [3, 3, 3], spacing: "
        "1.05, jitter: 0.04}, group: 0, material: m}\n"
        "materials: [{name: m, density: 2500, young: 1e8, poisson: 0.2, friction: 0.5, "
        "restitution: "
        "0.6, rolling_friction: 0.2, twisting_friction: 0.1}]\nlaw: {stiffness: hertz}\n"
        "initial: {random_velocity: 1}\n"
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {end: 9}\nrun: {threads: 1}\n");
    double p[2][3], l[2][3], size = 0.0, turn = 0.0;
    for (int k = 0; k < 2; k++) {
        run_steps(w, k ? 5000 : 1);
        for (int a = 0; a < 3; a++) p[k][a] = l[k][a] = 0.0;
        size = turn = 0.0;
        for (int id = 0; id < 27; id++) {
            double m = mass_of(w, id), round[3], spin = 0.4 * m * 4e-6;
            cross3(pos_of(w, id), vel_of(w, id), round);
            for (int a = 0; a < 3; a++) {
                p[k][a] += m * vel_of(w, id)[a];
                l[k][a] += m * round[a] + spin * spin_of(w, id)[a];
            }
            size += m * length3(vel_of(w, id));
            turn += m * length3(round);
        }
    }
    gn_energy e = measured_step(w);
    assert_true(e.rolling > 0.0 && e.friction > 0.0 && e.contact_damping > 0.0);
    for (int a = 0; a < 3; a++) {
        assert_near(p[1][a], p[0][a], 1e-12 * size);
        assert_near(l[1][a], l[0][a], 1e-12 * turn);
    }
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(restitution_is_as_requested_for_any_pair),
        cmocka_unit_test(restitution_is_kept_by_automatic_steps),
        cmocka_unit_test(restitution_of_a_pair_goes_over_that_of_materials),
        cmocka_unit_test(a_sphere_on_an_incline_is_held_up_to_the_resistance),
        cmocka_unit_test(a_sphere_rolls_or_slips_down_an_incline),
        cmocka_unit_test(a_rolling_disc_stops_where_resistance_says),
        cmocka_unit_test(the_moment_spring_oscillates_after_rolling_stops),
        cmocka_unit_test(momentum_stays_in_collisions_that_resist_rolling),
    };
    return cmocka_run_group_tests_name("hertz_kinds", tests, NULL, NULL);
}
