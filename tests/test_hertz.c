/* Hertz-Mindlin contacts against closed forms: impacts, restitution, oblique and spinning ones, the
 * closed loop that must not gain energy, stacks; and scenes with these. Impacts 1 to 8 are those of
 * Chung and Ooi 2011 (Granular Matter 13, 643-656), the walls rigid. */
#include "run/run.h"
#include "world_helpers.h"

#include <unistd.h>

typedef struct matter {
    double r, young, poisson, density, friction, restitution;
} matter;

static double modulus_alone(const matter *m) {
    return m->young / (1.0 - m->poisson * m->poisson);
}

/* The impact of a mass m at v on a spring 4/3 E* sqrt(R) u^1.5. */
typedef struct impact {
    double overlap, force, time;
} impact;

static impact impact_of(double modulus, double radius, double mass, double v) {
    impact i;
    i.overlap = pow(15.0 * mass * v * v / (16.0 * modulus * sqrt(radius)), 0.4);
    i.force = 4.0 / 3.0 * modulus * sqrt(radius) * pow(i.overlap, 1.5);
    i.time = 2.9432750 * i.overlap / v; /* 4 sqrt(pi) gamma(2/5)/(5 gamma(9/10)) */
    return i;
}

static void add_matter(text *t, const matter *m) {
    add(t,
        "materials: [{name: m, density: %.17g, young: %.17g, poisson: %.17g, friction: %.17g, "
        "restitution: %.17g}]\n",
        m->density, m->young, m->poisson, m->friction, m->restitution);
}

/* A sphere just above the plane z = 0 (rigid), or two that approach along z. */
static gn_world *meeting(const matter *m, bool two, const double v[3], const double spin[3],
                         double step, const char *more) {
    text t = {0};
    double gap = 1.5 * fabs(v[2]) * step;
    add(&t, "dimension: 3\nspecimen: {particles: [[0, 0, %.17g, %.17g]", m->r + gap, m->r);
    if (two) add(&t, ", [0, 0, %.17g, %.17g]", -m->r - gap, m->r);
    add(&t, "], group: 0}\n");
    add_matter(&t, m);
    add(&t, "law: {stiffness: hertz%s}\n", strstr(more, "no_pull") ? ", pull: false" : "");
    add(&t,
        "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [%.17g, %.17g, %.17g], "
        "initial_spin: [%.17g, %.17g, %.17g]}\n",
        v[0], v[1], v[2], spin[0], spin[1], spin[2]);
    if (two)
        add(&t,
            "  - {name: b, select: {ids: [1]}, initial_velocity: [%.17g, %.17g, %.17g], "
            "initial_spin: [%.17g, %.17g, %.17g]}\n",
            -v[0], -v[1], -v[2], -spin[0], -spin[1], -spin[2]);
    if (!two)
        add(&t, "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], friction: %.17g}]\n",
            m->friction);
    add(&t, "time: {step: %.17g, end: 1}\nrun: {threads: 1}\n", step);
    return world_of("%s", t.s);
}

static const double none[3] = {0, 0, 0};

/* --- along the normal --- */

static double overlap_now(const gn_world *w, bool two, double r) {
    double z = pos_of(w, 0)[2];
    return two ? 2.0 * r - (z - pos_of(w, 1)[2]) : r - z;
}

static void check_impact(const matter *m, bool two, double v) {
    double modulus = modulus_alone(m) / (two ? 2.0 : 1.0), radius = two ? 0.5 * m->r : m->r;
    double mass = sphere_mass(m->density, m->r) / (two ? 2.0 : 1.0);
    impact want = impact_of(modulus, radius, mass, two ? 2.0 * v : v);
    const double velocity[3] = {0, 0, -v};
    enum { STEPS = 1000 };
    gn_world *w = meeting(m, two, velocity, none, want.time / STEPS, "");
    double deepest = 0.0, most = 0.0, first = 0.0, last = 0.0, before = vel_of(w, 0)[2];
    for (int k = 0; k < STEPS + 10; k++) {
        double u = overlap_now(w, two, m->r), speed = two ? 2.0 * v : v;
        run_steps(w, 1);
        double force = (vel_of(w, 0)[2] - before) / (w->ctx.dt * vel_of(w, 0)[3]);
        before = vel_of(w, 0)[2];
        deepest = fmax(deepest, u);
        most = fmax(most, force);
        double next = overlap_now(w, two, m->r);
        if (u <= 0.0 && next > 0.0) first = w->ctx.time - next / speed;
        if (u > 0.0 && next <= 0.0) last = w->ctx.time - next / -speed;
    }
    /* The error is of second order of a thousandth of the contact; the extremes are up to half a
     * step away. */
    assert_near(deepest, want.overlap, 1e-5 * want.overlap);
    assert_near(most, want.force, 1e-5 * want.force);
    assert_near(last - first, want.time, 1e-4 * want.time);
    assert_near(vel_of(w, 0)[2], v, 1e-4 * v);
    world_end(w);
}

/* The largest fraction of its energy that an undamped impact resolved by a number of steps gains or
 * loses, over the phases of its first step. */
static double most_missed(const matter *m, int steps) {
    enum { PHASES = 16 };
    const double v = 1.0, velocity[3] = {0, 0, -v};
    const impact want = impact_of(modulus_alone(m), m->r, sphere_mass(m->density, m->r), v);
    double most = 0.0;
    for (int k = 0; k < PHASES; k++) {
        gn_world *w = meeting(m, false, velocity, none, want.time / steps, "");
        w->dem.particles.pos[2] += k * v * w->ctx.dt / PHASES;
        run_steps(w, steps + 6);
        assert_true(overlap_now(w, false, m->r) < 0.0);
        most = fmax(most, fabs(pow(vel_of(w, 0)[2] / v, 2.0) - 1.0));
        world_end(w);
    }
    return most;
}

/* The steps in which a contact begins and ends have errors of at most 0.064 (2.94/N)^(5/2), mostly
 * of one sign. */
static void impacts_in_few_steps_have_the_error_of_the_sum_over_steps(void **state) {
    (void)state;
    const matter glass = {.01, 4.8e10, .20, 2800, 0, 1};
    for (int steps = 12; steps <= 48; steps *= 2) {
        const double bound = 0.11 * pow(2.943275 / steps, 2.5), most = most_missed(&glass, steps);
        assert_true(most < bound);
        assert_true(most > 0.85 * bound);
    }
}

static void impacts_reach_the_overlap_and_the_force_of_hertz(void **state) {
    (void)state;
    const matter glass = {.01, 4.8e10, .20, 2800, .35, 1},
                 limestone = {.01, 2e10, .25, 2500, .35, 1};
    const matter aluminium = {.1, 7e10, .30, 2699, 0, 1}, magnesium = {.1, 4e10, .35, 1800, 0, 1};
    const matter alumina = {.0025, 3.8e11, .23, 4000, 0, 1}, iron = {.0025, 1e11, .25, 7000, 0, 1};
    check_impact(&glass, true, 10.0);
    check_impact(&limestone, true, 10.0);
    check_impact(&aluminium, false, 0.2);
    check_impact(&magnesium, false, 0.2);
    check_impact(&alumina, false, 3.9);
    check_impact(&iron, false, 3.9);
}

static double rebound(const matter *m, double v, double steps, bool pull) {
    double mass = sphere_mass(m->density, m->r);
    impact want = impact_of(modulus_alone(m), m->r, mass, v);
    /* S_n is at most that of the overlap want.overlap. */
    double w2 = 2.0 * modulus_alone(m) * sqrt(m->r * want.overlap) / mass;
    const double velocity[3] = {0, 0, -v};
    gn_world *w = meeting(m, false, velocity, none, pi / sqrt(w2) / steps, pull ? "" : "no_pull");
    run_steps(w, (int64_t)(8.0 * steps) + 10);
    double ratio = vel_of(w, 0)[2] / v;
    world_end(w);
    return ratio;
}

/* The closed form: in u^(5/4) the collision is a damped oscillator, for which 200 steps have a
 * second-order error of (pi/200)^2: 2e-4. */
static void restitution_is_as_requested_at_any_speed(void **state) {
    (void)state;
    const double asked[] = {0.2, 0.5, 0.8, 0.95};
    for (int k = 0; k < 4; k++) {
        const matter m = {.0025, 3.8e11, .23, 4000, 0, asked[k]};
        double first = rebound(&m, 0.01, 200, true);
        assert_near(first, asked[k], 1e-3 * asked[k]);
        for (double v = 0.1; v < 20.0; v *= 10.0)
            assert_near(rebound(&m, v, 200, true), first, 1e-3 * first);
    }
}

/* The restitution by the fit of Thornton, Cummins and Cleary 2013, integrated: see law_hertz.c. */
static void restitution_without_pull_is_that_of_the_fit_at_any_speed(void **state) {
    (void)state;
    const double asked[] = {0.2, 0.5, 0.8, 0.95}, given[] = {0.2002, 0.5, 0.7999, 0.948};
    for (int k = 0; k < 4; k++) {
        const matter m = {.0025, 3.8e11, .23, 4000, 0, asked[k]};
        double first = rebound(&m, 0.01, 200, false);
        assert_near(first, given[k], 1.5e-3 * given[k]);
        for (double v = 0.1; v < 20.0; v *= 10.0)
            assert_near(rebound(&m, v, 200, false), first, 1e-3 * first);
    }
}

/* The collision has as many steps as with an automatic step, at any phase: without the share of the
 * step in which the dashpot begins (gn_hertz_closing) the results are off by up to 3 %. */
static void restitution_hardly_depends_on_the_step(void **state) {
    (void)state;
    for (int k = 0; k < 40; k++) {
        const matter m = {.0025, 3.8e11, .23, 4000, 0, 0.5};
        assert_near(rebound(&m, 3.0 + 0.05 * k, 10.0 + 0.13 * k, true), 0.5, 0.005);
    }
}

/* --- tangential forces --- */

/* The surface slides throughout: impulses mu (1 + e) m v_n across. */
static void oblique_impacts_slide_by_coulomb(void **state) {
    (void)state;
    const matter alumina = {.0025, 3.8e11, .23, 4000, .092, .98},
                 aluminium = {.0025, 7e10, .33, 2700, .092, .98};
    const matter *const both[] = {&alumina, &aluminium};
    for (int which = 0; which < 2; which++)
        for (int degrees = 40; degrees <= 80; degrees += 10) {
            const matter *m = both[which];
            double angle = degrees * pi / 180.0, vn = 3.9 * cos(angle), vt = 3.9 * sin(angle);
            impact i = impact_of(modulus_alone(m), m->r, sphere_mass(m->density, m->r), vn);
            const double v[3] = {vt, 0, -vn};
            gn_world *w = meeting(m, false, v, none, i.time / 400, "");
            run_steps(w, 460);
            /* The dashpot pulls at the end, and friction does not act then: e of both impulses
             * agrees to 1 %. */
            double slip = m->friction * (1.0 + m->restitution) * vn;
            assert_near(vel_of(w, 0)[0], vt - slip, 0.01 * slip);
            assert_near(spin_of(w, 0)[1] * m->r, 2.5 * slip, 0.01 * 2.5 * slip);
            world_end(w);
        }
}

/* Test 6: a sphere that spins, mu 0.4, e 0.5. Where the surface slides throughout it loses 3.5 mu
 * (1 + e) v_n, with e* = 0.5503 in place of e if the dashpot pulls (friction follows the pressing
 * part alone). It slides as soon as the tangential spring is stretched enough: the dashpot, which
 * grows with u^(1/4), contributes 0.6 % of the impulse before that. */
static void a_spinning_sphere_slides_by_coulomb(void **state) {
    (void)state;
    for (int pull = 0; pull < 2; pull++) {
        const matter m = {.1, 7e10, .33, 2700, .4, .5};
        impact i = impact_of(modulus_alone(&m), m.r, sphere_mass(m.density, m.r), 0.2);
        const double v[3] = {0, 0, -0.2}, spin[3] = {0, 14, 0};
        gn_world *w = meeting(&m, false, v, spin, i.time / 400, pull ? "" : "no_pull");
        run_steps(w, 700);
        double e = pull ? 0.5503 : 0.5, slip = 0.4 * (1.0 + e) * 0.2;
        assert_near(vel_of(w, 0)[0], slip, 0.01 * slip);
        assert_near(14.0 - spin_of(w, 0)[1], 2.5 * slip / m.r, 0.01 * 2.5 * slip / m.r);
        world_end(w);
    }
}

/* Test 7: surfaces with equal velocities have no friction. */
static void spheres_that_roll_on_each_other_keep_their_spins(void **state) {
    (void)state;
    const matter m = {.1, 7e10, .33, 2700, .4, .5};
    impact i = impact_of(0.5 * modulus_alone(&m), 0.05, 0.5 * sphere_mass(m.density, m.r), 0.4);
    const double v[3] = {0, 0, -0.2}, spin[3] = {0, 10, 0};
    gn_world *w = meeting(&m, true, v, spin, i.time / 400, "");
    run_steps(w, 700);
    assert_near(vel_of(w, 0)[0], 0.0, 1e-12);
    assert_near(spin_of(w, 0)[1], 10.0, 1e-10);
    world_end(w);
}

/* Two spheres moved through loading, shear, half of unloading, reverse shear, separation. */
static gn_world *loop(double friction) {
    return world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 0.01], [0.02, 0, 0, 0.01]], group: 0}\n"
        "materials: [{name: m, density: 2500, young: 1e9, poisson: 0.3, friction: %g}]\n"
        "law: {stiffness: hertz}\nsets:\n"
        "  - {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
        "  - {name: b, select: {ids: [1]}, motion: {\n"
        "      vx: [[0, -1], [1e-4, -1], [1.000001e-4, 0], [2e-4, 0], [2.000001e-4, 1], [2.5e-4, "
        "1], [2.500001e-4, 0], [3.5e-4, 0], [3.500001e-4, 1], [4.5e-4, 1]],\n"
        "      vy: [[0, 0], [1e-4, 0], [1.000001e-4, 0.1], [2e-4, 0.1], [2.000001e-4, 0], [2.5e-4, "
        "0], [2.500001e-4, -0.1], [3.5e-4, -0.1], [3.500001e-4, 0]],\n"
        "      vz: 0, wx: 0, wy: 0, wz: 0}}\n"
        "time: {step: 1e-7, end: 1}\nrun: {threads: 1}\n",
        friction);
}

/* The work done on a closed loop is dissipated, and no energy gained: with increments alone,
 * without rescaling, unloading would return 0.2 of the work of shear. */
static void a_loop_of_load_and_shear_gains_no_energy(void **state) {
    (void)state;
    gn_world *w = loop(100.0); /* the sphere does not slide */
    measured_step(w);
    for (int k = 0; k < 4600; k++) run_steps(w, 1);
    gn_energy e = measured_step(w);
    assert_true(w->dem.pairs.contacts.shear[1 * w->dem.pairs.contacts.soa.capacity] == 0.0);
    assert_true(e.elastic_normal == 0.0 && e.elastic_shear == 0.0);
    assert_true(e.friction > 0.0);
    /* The kinetic energy is that of the motion at the end. */
    assert_near(e.friction, e.work_prescribed - e.kinetic + e.stored_at_start, 1e-3 * e.friction);
    world_end(w);
}

/* Sliding or not, the ledger closes: the spring's energy is exact (8/15 E* sqrt(R) u^(5/2)), works
 * of a step have errors of second order. */
static void the_ledger_of_a_loop_closes(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        gn_world *w = loop(k ? 100.0 : 0.05);
        measured_step(w);
        double worst = 0.0, size = 0.0;
        for (int step = 0; step < 4600; step++) {
            gn_energy e = measured_step(w);
            worst = fmax(worst, fabs(gn_energy_residual(&e)) * gn_energy_scale(&e));
            size = fmax(size, e.elastic_normal + e.elastic_shear);
        }
        assert_true(size > 0.0);
        assert_true(worst < 1e-5 * size);
        world_end(w);
    }
}

/* --- rest --- */

static void a_stack_rests_on_the_overlaps_of_its_weight(void **state) {
    (void)state;
    enum { COUNT = 4 };
    const double r = 2e-3, young = 1e8, poisson = 0.3, density = 2500, g = 10.0;
    text t = {0};
    add(&t, "dimension: 3\nspecimen: {particles: [");
    for (int k = 0; k < COUNT; k++)
        add(&t, "%s[0, 0, %.17g, %g]", k ? ", " : "", r * (1.0 + 2.0 * k), r);
    add(&t,
        "], group: 0}\nmaterials: [{name: m, density: 2500, young: 1e8, poisson: 0.3, friction: "
        "0.5, restitution: 0.3}]\nlaw: {stiffness: hertz}\ngravity: [0, 0, -10]\n"
        "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], material: m}]\n"
        "damping: {background: {model: viscous, coefficient: 200}}\n"
        "time: {end: 100}\nrun: {threads: 1}\n");
    gn_world *w = world_of("%s", t.s);
    run_steps(w, 100000);
    double before = pos_of(w, COUNT - 1)[2], modulus = young / (2.0 * (1.0 - poisson * poisson));
    for (int k = 0; k < COUNT; k++) {
        double weight = (COUNT - k) * g * sphere_mass(density, r), radius = k ? 0.5 * r : r;
        double u = pow(0.75 * weight / (modulus * sqrt(radius)), 2.0 / 3.0);
        double below = k ? pos_of(w, k - 1)[2] + r : 0.0;
        /* The error is limited by the rounding of positions: 1e-16 of 1e-2 m. */
        assert_near(below - (pos_of(w, k)[2] - r), u, 1e-6 * u);
    }
    run_steps(w, 100000);
    assert_near(pos_of(w, COUNT - 1)[2], before, 1e-17);
    world_end(w);
}

/* --- rolling --- */

/* A sphere that rolls over the plane at v0, and spins about its normal. */
static gn_world *roller(bool hertz, double v0, double rolling, double twisting, double spin,
                        const double g[3], double end) {
    text t = {0};
    const char *rest =
        hertz ? "young: 1e8, poisson: 0.3, restitution: 0.3" : "normal_stiffness: 1e6, kratio: 2";
    add(&t,
        "dimension: 3\nspecimen: {particles: [[0, 0, 0.00999, 0.01]], group: 0}\n"
        "materials: [{name: m, density: 2500, %s, friction: 0.5, rolling_friction: %.17g, "
        "twisting_friction: %.17g}]\nlaw: {stiffness: %s}\n%s"
        "gravity: [%.17g, %.17g, %.17g]\n"
        "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], ",
        rest, rolling, twisting, hertz ? "hertz" : "uniform",
        hertz ? "" : "damping: {contact: {restitution: 0.3}}\n", g[0], g[1], g[2]);
    if (hertz)
        add(&t, "material: m}]\n");
    else
        add(&t,
            "stiffness: 1e6, kratio: 2, friction: 0.5, rolling_friction: %.17g, "
            "twisting_friction: %.17g}]\n",
            rolling, twisting);
    add(&t,
        "sets: [{name: a, select: {all: true}, initial_velocity: [%.17g, 0, 0], initial_spin: [0, "
        "%.17g, %.17g]}]\ntime: {end: %.17g}\nrun: {threads: 1}\n",
        v0, v0 / 0.01, spin, end);
    return world_of("%s", t.s);
}

static const double down[3] = {0, 0, -9.81};

/* With dv/dt = -(5/7) mu_r g the sphere stops after 7 v0^2/(10 mu_r g). The sphere settles into the
 * plane first, which changes the pressing force for some milliseconds; the spring of the moment
 * then oscillates by less than a thousandth of the way. */
static void a_rolling_sphere_stops_where_resistance_says(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        const double mu = 0.05, v0 = 0.2, way = 7.0 * v0 * v0 / (10.0 * mu * 9.81);
        gn_world *w = roller(hertz, v0, mu, 0.0, 0.0, down, 10.0);
        run_until(w, 0.3);
        double v = v0 - 5.0 / 7.0 * mu * 9.81 * 0.3;
        assert_near(vel_of(w, 0)[0], v, 0.01 * v0);
        run_until(w, 1.2 * 2.0 * way / v0);
        assert_near(pos_of(w, 0)[0], way, 0.01 * way);
        gn_energy e = measured_step(w);
        double energy = 0.7 * mass_of(w, 0) * v0 * v0;
        assert_near(e.rolling, energy, 0.02 * energy);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-3);
        world_end(w);
    }
}

/* On an incline the sphere rests if tan phi <= mu_r, else it rolls with (5/7) g (sin phi - mu_r cos
 * phi). */
static void resistance_holds_a_sphere_on_an_incline(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++)
        for (int rolls = 0; rolls < 2; rolls++) {
            const double mu = 0.1, phi = atan(rolls ? 0.2 : 0.09);
            const double g[3] = {9.81 * sin(phi), 0, -9.81 * cos(phi)};
            gn_world *w = roller(hertz, 0.0, mu, 0.0, 0.0, g, 10.0);
            run_until(w, 0.2);
            double v = rolls ? 5.0 / 7.0 * (g[0] + mu * g[2]) * 0.2 : 0.0;
            /* The spring first yields by mu_r f/(k_t r), some micrometres, and oscillates. */
            assert_near(vel_of(w, 0)[0], v, 0.01 * 9.81 * 0.2);
            world_end(w);
        }
}

/* A sphere that spins about the normal: I dw/dt = -mu_t r m g. */
static void twisting_resistance_stops_a_top(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        const double mu = 0.05, w0 = 60.0, slow = 2.5 * mu * 9.81 / 0.01;
        gn_world *w = roller(hertz, 0.0, 0.0, mu, w0, down, 10.0);
        run_until(w, 0.3);
        assert_near(spin_of(w, 0)[2], w0 - slow * 0.3, 0.01 * w0);
        run_until(w, 0.8);
        assert_near(spin_of(w, 0)[2], 0.0, 0.01 * w0);
        gn_energy e = measured_step(w);
        double energy = 0.2 * mass_of(w, 0) * 1e-4 * w0 * w0;
        assert_near(e.rolling, energy, 0.01 * energy);
        world_end(w);
    }
}

/* --- all together --- */

/* Grains of two materials and sizes in a box, with a fixed body and a falling one. */
static const char *crowd_text(const char *law, const char *run) {
    static text t;
    t.used = 0;
    add(&t,
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 2e-3, cells: [4, 4, 4], spacing: "
        "1.1, jitter: 0.09, origin: [3e-3, 3e-3, 12e-3]}, group: 0, material: g}\n"
        "materials:\n"
        "  - {name: g, density: 2500, young: 1e9, poisson: 0.2, friction: 0.4, restitution: 0.5, "
        "rolling_friction: 0.1}\n"
        "  - {name: s, density: 7200, young: 2e10, poisson: 0.3, friction: 0.2, restitution: 0.8, "
        "rolling_friction: 0.2, twisting_friction: 0.1}\n"
        "contacts: [{between: [g, s], restitution: 0.6, friction: 0.3, twisting_friction: 0.05}]\n"
        "law: {stiffness: hertz%s}\ngravity: [0, 0, -9.81]\ninitial: {random_velocity: 1}\n"
        "sets: [{name: heavy, select: {ids: [3, 40]}, material: s}]\nwalls:\n"
        "  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], material: s}\n"
        "  - {name: a, point: [0, 0, 0], normal: [1, 0, 0], friction: 0.3}\n"
        "  - {name: b, point: [0, 0, 0], normal: [0, 1, 0], material: g}\n"
        "  - {name: c, point: [26e-3, 0, 0], normal: [-1, 0, 0], material: g}\n"
        "  - {name: d, point: [0, 26e-3, 0], normal: [0, -1, 0], material: g}\n"
        "bodies:\n"
        "  - {name: ramp, box: {size: [10e-3, 10e-3, 3e-3]}, origin: [10e-3, 12e-3, 4e-3], "
        "rotation: [0.4, 0.3, 0], material: s}\n"
        "  - {name: brick, box: {size: [6e-3, 6e-3, 6e-3]}, origin: [13e-3, 13e-3, 40e-3], "
        "material: s, free: true, density: 3000}\n"
        "time: {end: 1}\noutput: {orientation: on}\nrun: {%s}\n",
        law, run);
    return t.s;
}

static gn_world *crowd(const char *law, const char *run) {
    return world_of("%s", crowd_text(law, run));
}

static void the_bits_do_not_depend_on_threads_or_instruction_sets(void **state) {
    (void)state;
    const char *const precision[] = {"double", "mixed"};
    for (int p = 0; p < (GN_BUILT(MIXED) ? 2 : 1); p++) {
        char one[80], two[80], plain[80];
        snprintf(one, sizeof one, "threads: 1, precision: %s", precision[p]);
        snprintf(two, sizeof two, "threads: 2, precision: %s", precision[p]);
        snprintf(plain, sizeof plain, "threads: 1, isa: scalar, precision: %s", precision[p]);
        gn_world *a = crowd("", one), *b = crowd("", two), *c = crowd("", plain);
        gn_world *const all[] = {a, b, c};
        for (int k = 0; k < 3; k++) run_steps(all[k], 3000);
        assert_true(a->dem.pairs.contacts.soa.count > 0 && a->ledger.energy.friction > 0.0);
        assert_true(a->ledger.energy.rolling > 0.0 && a->ledger.energy.contact_damping > 0.0);
        for (int k = 1; k < 3; k++) {
            assert_true(gn_world_hash(&all[k]->ctx, &all[k]->dem, &all[k]->boundary,
                                      &all[k]->solids, &all[k]->box) ==
                        gn_world_hash(&a->ctx, &a->dem, &a->boundary, &a->solids, &a->box));
            assert_true(all[k]->ctx.dt == a->ctx.dt);
            world_end(all[k]);
        }
        world_end(a);
    }
}

static void ok(gneiss_status status, const gneiss_error *error) {
    if (status != GNEISS_OK) fail_msg("%s", error->message);
}

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene;
    gn_run whole, resumed;
    char path[] = "/tmp/hertz_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    ok(gn_scene_parse(crowd_text("", "threads: 1"), "s.yaml", NULL, NULL, 0, &scene, &error),
       &error);
    ok(gn_run_create(&scene, &whole, &error), &error);
    ok(gn_run_steps(&whole, 2777, &error), &error);
    ok(gn_checkpoint_write(&whole, path, &error), &error);
    ok(gn_run_load(path, NULL, 0, &resumed, &error), &error);
    ok(gn_run_steps(&whole, 1500, &error), &error);
    ok(gn_run_steps(&resumed, 1500, &error), &error);
    assert_true(gn_world_hash(&whole.world.ctx, &whole.world.dem, &whole.world.boundary,
                              &whole.world.solids, &whole.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    assert_true(whole.world.ctx.dt == resumed.world.ctx.dt);
    assert_true(
        memcmp(&whole.world.ledger.energy, &resumed.world.ledger.energy, sizeof(gn_energy)) == 0);
    gn_run_free(&whole);
    gn_run_free(&resumed);
    unlink(path);
}

/* Speed increases in flight, and so the step decreases with every rebuild of the lists: a run
 * resumed just before a rebuild must know the speed. */
static void a_step_that_follows_flight_does_so_after_resume(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_run run, resumed;
    char path[] = "/tmp/flight_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    int64_t step = -1, lowered = 0;
    for (int k = 0; k < 2; k++) { /* this run is the first to find the step */
        gn_scene scene;
        ok(gn_scene_parse("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm]], group: 0}\n"
                          "materials: [{name: m, density: 2500, young: 1e5, poisson: 0.2}]\n"
                          "law: {stiffness: hertz}\ngravity: [0, 0, -100]\n"
                          "walls: [{name: w, point: [0, 0, -9], normal: [0, 0, 1]}]\n"
                          "domain: {min: [-10, -10, -10], max: [10, 10, 10]}\n"
                          "time: {end: 1}\nrun: {threads: 1}\n",
                          "s.yaml", NULL, NULL, 0, &scene, &error),
           &error);
        ok(gn_run_create(&scene, &run, &error), &error);
        while (run.world.ctx.step != step && run.world.ctx.step < 100000) {
            lowered = run.world.ctx.dt_lowered;
            ok(gn_run_steps(&run, 1, &error), &error);
            if (k == 0 && run.world.ctx.step > 1 && run.world.ctx.dt_lowered > lowered) break;
        }
        step = run.world.ctx.step - 1;
        if (k == 0) gn_run_free(&run);
        if (k == 0) continue;
        step = run.world.ctx.step;
        ok(gn_checkpoint_write(&run, path, &error), &error);
        ok(gn_run_load(path, NULL, 0, &resumed, &error), &error);
        lowered = run.world.ctx.dt_lowered;
        ok(gn_run_steps(&run, 1, &error), &error);
        ok(gn_run_steps(&resumed, 1, &error), &error);
    }
    assert_true(run.world.ctx.dt_lowered > lowered);
    assert_true(run.world.ctx.dt == resumed.world.ctx.dt);
    assert_true(gn_world_hash(&run.world.ctx, &run.world.dem, &run.world.boundary,
                              &run.world.solids, &run.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    gn_run_free(&run);
    gn_run_free(&resumed);
    unlink(path);
}

/* For a sphere that bounces and rolls, a plane wall and the face of a box of the same material are
 * equivalent to rounding, although contacts are found differently. */
static void a_wall_and_a_facet_are_the_same(void **state) {
    (void)state;
    double end[2][3], spin[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, 0.0101, 0.01]], group: 0, material: m}\n"
            "materials: [{name: m, density: 2500, young: 1e8, poisson: 0.3, friction: 0.3, "
            "restitution: 0.6, rolling_friction: 0.1, twisting_friction: 0.1},\n"
            "  {name: s, density: 1, young: 1e9, poisson: 0.2, friction: 0.4, restitution: 0.8, "
            "rolling_friction: 0.2, twisting_friction: 0.1}]\n"
            "law: {stiffness: hertz}\ngravity: [0, 0, -9.81]\n%s\n"
            "sets: [{name: a, select: {all: true}, initial_velocity: [0.3, 0.1, -0.2], "
            "initial_spin: [0, 0, 30]}]\ntime: {end: 1}\nrun: {threads: 1}\n",
            k ? "bodies: [{name: w, box: {size: [1, 1, 0.1]}, origin: [-0.41, -0.43, -0.1], "
                "material: "
                "s}]"
              : "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], material: s}]");
        run_steps(w, 3000);
        memcpy(end[k], pos_of(w, 0), sizeof end[k]);
        spin[k] = spin_of(w, 0)[2];
        world_end(w);
    }
    for (int a = 0; a < 3; a++) assert_near(end[0][a], end[1][a], 1e-12);
    assert_near(spin[0], spin[1], 1e-7);
}

/* A sphere that falls on a bar of finite elements, which acts differently from a rigid wall: both
 * ledgers together. */
static void the_ledger_closes_when_a_hertzian_sphere_hits_elements(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0.02, 0.02, 0.0501, 0.01]], group: 0}\n"
        "materials: [{name: m, density: 2500, young: 1e8, poisson: 0.3, friction: 0.3, "
        "restitution: "
        "0.6}]\nlaw: {stiffness: hertz}\n"
        "elements: {box: {size: [0.04, 0.04, 0.04], cells: [4, 4, 4]}, materials: [{young: 1e9, "
        "poisson: 0.3, density: 2000}], contact: {material: m}}\n"
        "sets: [{name: a, select: {all: true}, initial_velocity: [0.1, 0.05, -1]}]\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    gn_energy e = measured_step(w);
    double start = e.kinetic;
    run_until(w, 1e-3);
    e = measured_step(w);
    assert_true(vel_of(w, 0)[2] > 0.2);
    assert_true(e.contact_damping > 0.1 * start);
    assert_true(fabs(gn_energy_residual(&e)) < 0.01);
    world_end(w);
}

static void the_ledger_of_a_crowd_closes(void **state) {
    (void)state;
    const char *const laws[] = {"", ", pull: false"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = crowd(laws[k], "threads: 1");
        for (int step = 0; step < 40; step++) {
            run_steps(w, 250);
            gn_energy e = measured_step(w);
            assert_true(fabs(gn_energy_residual(&e)) <
                        0.005); /* half of the limit of the warning of a run */
        }
        world_end(w);
    }
}

/* A step that must be lowered: a plate presses a sphere at rest on the ground with increasing
 * force. The step follows the overlap, and never exceeds the limit of the present contact. */
static void the_step_follows_the_overlap(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0.01, 0.01]], group: 0}\n"
        "materials: [{name: m, density: 2500, young: 1e8, poisson: 0.3, restitution: 0.3}]\n"
        "law: {stiffness: hertz}\nwalls:\n"
        "  - {name: low, point: [0, 0, 0], normal: [0, 0, 1]}\n"
        "  - {name: top, point: [0, 0, 0.02], normal: [0, 0, -1], motion: {vz: -1e-3}}\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    double first = w->ctx.dt, modulus = 1e8 / (1.0 - 0.09);
    while (w->ctx.time < 0.5) {
        run_steps(w, 1);
        double u = fmax(0.01 - pos_of(w, 0)[2], pos_of(w, 0)[2] + 0.01 - 0.02 + 1e-3 * w->ctx.time);
        double w2 = 4.0 * modulus * sqrt(0.01 * fmax(u, 0.0)) / mass_of(w, 0); /* two contacts */
        assert_true(w->ctx.dt * sqrt(w2) < 1.0);
    }
    assert_true(w->ctx.dt < 0.3 * first); /* the overlap grows from 1e-6 to 2.5e-2 of the radius:
                                             the step falls to 1/12 */
    assert_in_range(w->ctx.dt_lowered, 1, 60);
    world_end(w);
}

/* The example: grains in a tube that is lifted, until they have settled in it. */
static void the_example_runs(void **state) {
    (void)state;
    char path[4096];
    gn_scene scene;
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    const gn_override fewer[] = {{"run.threads", "1"}, {"specimen.lattice.cells", "[8, 5, 2]"}};
    snprintf(path, sizeof path, "%s/scenes/repose.yaml", test_source());
    ok(gn_scene_load(path, fewer, 2, &scene, &error), &error);
    ok(gn_world_create(&scene, w, &error), &error);
    run_until(w, 0.05);
    gn_energy e = measured_step(w);
    assert_int_equal(w->dem.lost, 0);
    assert_true(e.friction > 0.0 && e.rolling > 0.0);
    assert_true(fabs(gn_energy_residual(&e)) < 0.005);
    world_end(w);
}

/* --- slips --- */

static void refuses(const char *from, const char *to, const char *message) {
    static const char scene[] =
        "dimension: 3\n"
        "specimen: {particles: [[0, 0, 0, 1 mm]], group: 0, material: m}\n"
        "materials:\n"
        "  - {name: m, density: 1, young: 1 GPa, poisson: 0.3, rolling_friction: 0.1}\n"
        "  - {name: s, density: 1, young: 1 GPa, poisson: 0.3}\n"
        "law: {stiffness: hertz}\n"
        "walls: [{name: w, point: [0, 0, -1], normal: [0, 0, 1], material: s}]\n"
        "time: {end: 1}\n";
    char changed[sizeof scene + 256];
    const char *at = strstr(scene, from);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - scene), scene, to, at + strlen(from));
    gn_scene read;
    gneiss_error error = {0};
    gneiss_status status = gn_scene_parse(changed, "s.yaml", NULL, NULL, 0, &read, &error);
    if (status == GNEISS_OK) gn_scene_free(&read);
    if (!message) {
        if (status != GNEISS_OK) fail_msg("%s", error.message);
        return;
    }
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    if (!strstr(error.message, message)) fail_msg("%s\nexpected %s", error.message, message);
}

static void keys_that_exclude_hertz_are_refused(void **state) {
    (void)state;
    refuses("walls", "walls", NULL);
    refuses("young: 1 GPa, ", "",
            "s.yaml:4:5: materials[0].young: required by law.stiffness hertz, but not given");
    refuses("poisson: 0.3, ", "",
            "s.yaml:4:5: materials[0].poisson: required by law.stiffness hertz, but not given");
    refuses("rolling_friction: 0.1", "restitution: 1.1",
            "s.yaml:4:68: materials[0].restitution: expected a value in [0, 1]");
    refuses("rolling_friction: 0.1", "rolling_friction: -1",
            "s.yaml:4:73: materials[0].rolling_friction: expected a value in [0, 1e30]");
    refuses("dimension: 3\nspecimen: {particles: [[0, 0, 0,",
            "dimension: 2\nspecimen: "
            "{particles: [[0, 0,",
            "law.stiffness: expected a 3D scene beside hertz");
    refuses("law: {stiffness: hertz}", "law: {stiffness: hertz}\nbonds: {}",
            "bonds: expected no bonds beside rolling_friction or twisting_friction");
    refuses("rolling_friction: 0.1}\n  - {name: s, density: 1, young: 1 GPa, poisson: 0.3}\n"
            "law: {stiffness: hertz}",
            "}\n  - {name: s, density: 1, young: 1 GPa, poisson: 0.3}\n"
            "law: {stiffness: hertz}\nbonds: {}",
            "s.yaml:6:18: law.stiffness: expected a law with tension beside bonds, found hertz");
    refuses("law: {stiffness: hertz}", "law: {stiffness: hertz, rotation: off}",
            "s.yaml:6:35: law.rotation: expected spins beside rolling_friction");
    refuses("material: s}]", "material: t}]",
            "s.yaml:7:67: walls[0].material: expected the name of a material, found 't'");
    refuses("material: s}]", "material: s, stiffness: 1}]",
            "s.yaml:7:81: walls[0].stiffness: expected none beside law.stiffness hertz");
    refuses("material: s}]", "material: s, friction: 0.2}]",
            "s.yaml:7:80: walls[0].friction: expected none beside a material");
    refuses("material: s}]", "material: s, rolling_friction: 0.2}]",
            "s.yaml:7:88: walls[0].rolling_friction: expected none beside a material");
    refuses("law:", "contacts: [{between: [m, s], kratio: 2}]\nlaw:",
            "s.yaml:6:38: contacts[0].kratio: expected a value that this law.stiffness");
    refuses("stiffness: hertz}", "stiffness: uniform, pull: false}",
            "law.pull: needs law.stiffness hertz");
    refuses("stiffness: hertz}", "stiffness: uniform}", "materials[0].kratio: required");
}

/* k_r = k_t r^2 of a large sphere is large for a small body: (1 + 6 r^2/l^2) times the value of its
 * own arm with k_t, for a cube of side l. */
static void the_limit_of_a_free_body_includes_rolling_resistance(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 20 mm]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 1}]\n"
        "law: {stiffness: uniform}\ngravity: [0, 0, -9.81]\n"
        "sets: [{name: s, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: "
        "0}}]\n"
        "bodies: [{name: b, box: {size: [4 mm, 4 mm, 4 mm]}, origin: [-2 mm, -1.9 mm, 20.0001 mm], "
        "free: true, density: 2500, stiffness: 1e5, kratio: 1, friction: 0.5, "
        "rolling_friction: 0.5, twisting_friction: 0.5}]\n"
        "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 100);
    double side = 4e-3, mass = 2500 * side * side * side, inertia = mass * side * side / 6;
    double square = 1e5 * 20e-3 * 20e-3 / inertia;
    assert_true(w->ctx.stable <= 2.0 / sqrt(square));
    assert_true(w->ctx.stable >= 1.0 / sqrt(square)); /* the limit is not needlessly low */
    world_end(w);
}

/* The resistance follows from the tangential stiffness: without one there would be no resistance.
 */
static void resistance_to_rolling_asks_for_a_tangential_spring(void **state) {
    (void)state;
    static const char *const key[] = {"rolling_friction", "twisting_friction"};
    for (int k = 0; k < 4; k++) {
        char scene[512], wanted[256];
        gn_scene read;
        gneiss_error error = {0};
        bool spring = k >= 2;
        snprintf(scene, sizeof scene,
                 "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm]]}\nmaterials:\n"
                 "  - {name: m, density: 1, normal_stiffness: 1e5, kratio: %d, %s: 0.1}\n"
                 "law: {stiffness: uniform}\ntime: {end: 1}\n",
                 spring ? 2 : 0, key[k % 2]);
        gneiss_status status = gn_scene_parse(scene, "s.yaml", NULL, NULL, 0, &read, &error);
        if (status == GNEISS_OK) gn_scene_free(&read);
        assert_int_equal(status, spring ? GNEISS_OK : GNEISS_ERROR_INPUT);
        snprintf(wanted, sizeof wanted,
                 "s.yaml:4:%d: materials[0].%s: needs kratio above 0, which its stiffness follows "
                 "from; found 0",
                 61 + (int)strlen(key[k % 2]) + 2, key[k % 2]);
        if (!spring && strncmp(error.message, wanted, strlen(wanted)) != 0)
            fail_msg("%s\nexpected %s", error.message, wanted);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(impacts_reach_the_overlap_and_the_force_of_hertz),
        cmocka_unit_test(impacts_in_few_steps_have_the_error_of_the_sum_over_steps),
        cmocka_unit_test(restitution_is_as_requested_at_any_speed),
        cmocka_unit_test(restitution_without_pull_is_that_of_the_fit_at_any_speed),
        cmocka_unit_test(restitution_hardly_depends_on_the_step),
        cmocka_unit_test(oblique_impacts_slide_by_coulomb),
        cmocka_unit_test(a_spinning_sphere_slides_by_coulomb),
        cmocka_unit_test(spheres_that_roll_on_each_other_keep_their_spins),
        cmocka_unit_test(a_loop_of_load_and_shear_gains_no_energy),
        cmocka_unit_test(the_ledger_of_a_loop_closes),
        cmocka_unit_test(a_stack_rests_on_the_overlaps_of_its_weight),
        cmocka_unit_test(a_rolling_sphere_stops_where_resistance_says),
        cmocka_unit_test(resistance_holds_a_sphere_on_an_incline),
        cmocka_unit_test(twisting_resistance_stops_a_top),
        cmocka_unit_test(the_bits_do_not_depend_on_threads_or_instruction_sets),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(a_step_that_follows_flight_does_so_after_resume),
        cmocka_unit_test(a_wall_and_a_facet_are_the_same),
        cmocka_unit_test(the_ledger_closes_when_a_hertzian_sphere_hits_elements),
        cmocka_unit_test(the_ledger_of_a_crowd_closes),
        cmocka_unit_test(the_step_follows_the_overlap),
        cmocka_unit_test(the_example_runs),
        cmocka_unit_test(the_limit_of_a_free_body_includes_rolling_resistance),
        cmocka_unit_test(resistance_to_rolling_asks_for_a_tangential_spring),
        cmocka_unit_test(keys_that_exclude_hertz_are_refused),
    };
    return cmocka_run_group_tests_name("hertz", tests, NULL, NULL);
}
