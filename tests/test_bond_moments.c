/* Bonds that carry moments: closed forms of bent and twisted chains, strength of the extreme fibre,
 * conservation in rotating bodies, the stable step. */
#include "kernels/law.h"
#include "run/run.h"
#include "world_helpers.h"

#include <unistd.h>

static const double r = 1e-3, kn = 1e7, kt = 4e6, multiplier = 0.8;

/* Stiffness of a bond against bending and twist: k_n I/A, k_t J/A of a circle or of a slice. */
static double bend_stiffness(int dimension) {
    double R = multiplier * r;
    return kn * R * R / (dimension == 3 ? 4.0 : 3.0);
}
static double twist_stiffness(void) {
    return kt * multiplier * multiplier * r * r / 2.0;
}

/* A chain of touching particles along x, the first `bonds` contacts bonded, the first particle
 * held, the last one with the motion `tip`; `more`: further sections. */
static gn_world *chain(int dimension, int bonds, const char *tip, const char *more) {
    text t = {0};
    add(&t, "dimension: %d\nspecimen: {particles: [", dimension);
    for (int k = 0; k <= bonds; k++)
        add(&t, "%s[%.17g, 0, %s1e-3]", k ? ", " : "", 2.0 * r * k, dimension == 3 ? "0, " : "");
    add(&t,
        "]}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, "
        "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\n"
        "bonds: {radius_multiplier: %g}\nsets:\n"
        "  - {name: held, select: {ids: [0]}, motion: {%s}}\n"
        "  - {name: tip, select: {ids: [%d]}, %s}\n%srun: {threads: 1}\n",
        multiplier,
        dimension == 3 ? "vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0" : "vx: 0, vy: 0, wz: 0", bonds,
        tip, more);
    return world_of("%s", t.s);
}

/* The moment of a bond on its particle with the smaller number; returns the other's number. */
static int moment_of(const gn_world *w, size_t c, double m[3]) {
    const gn_contacts *b = &w->dem.bonds.contacts;
    int i = w->dem.particles.id[b->i[c]], j = w->dem.particles.id[b->j[c]];
    for (size_t a = 0; a < 3; a++)
        m[a] = (i < j ? 1.0 : -1.0) * (b->moment ? b->moment[c + a * b->soa.capacity]
                                                 : b->moment_f[c + a * b->soa.capacity]);
    return i < j ? j : i;
}

/* --- closed forms --- */

/* A force P across the tip: the contact of bond k, at (k - 1/2) d, carries the shear P and the
 * moment P d (N - k + 1/2); with the rotations th_k = sum of moments/k_b the deflection is the sum
 * of P/k_t + d/2 (th_k + th_k-1). The error is the square of deflection over length, 1e-5 here;
 * positions of 1e-2 m are rounded to 1e-18, for a deflection of 1e-7. */
static void bends_as_a_cantilever(int dimension, int axis, double force) {
    enum { BONDS = 6 };
    char tip[80];
    if (dimension == 3)
        snprintf(tip, sizeof tip, "force: [0, %.17g, %.17g]", axis == 1 ? force : 0.0,
                 axis == 2 ? force : 0.0);
    else
        snprintf(tip, sizeof tip, "force: [0, %.17g]", force);
    char more[120]; /* about critical for the slowest mode; discs are 750 times as heavy */
    snprintf(more, sizeof more,
             "damping: {background: {model: viscous, coefficient: %g}}\ntime: {end: 1}\n",
             dimension == 3 ? 4e4 : 1.5e3);
    gn_world *w = chain(dimension, BONDS, tip, more);
    run_steps(w, 8000);
    double kb = bend_stiffness(dimension), d = 2.0 * r, turn = 0.0, deflection = 0.0;
    double sign = axis == 1 ? 1.0 : -1.0; /* z decreases where y rotates upwards */
    int turned = axis == 1 ? 2 : 1;
    for (size_t c = 0; c < BONDS; c++) {
        double m[3];
        int k = moment_of(w, c, m);
        assert_near(m[turned], sign * force * d * (BONDS - k + 0.5),
                    1e-8 * fabs(force) * d * BONDS);
    }
    for (int k = 1; k <= BONDS; k++) {
        double next = turn + force * d * (BONDS - k + 0.5) / kb;
        deflection += force / kt + 0.5 * d * (turn + next);
        turn = next;
    }
    assert_true(fabs(deflection) < 1e-4 * BONDS * d && fabs(deflection) > 1e-8);
    assert_near(pos_of(w, BONDS)[axis], deflection, 1e-8 * fabs(deflection));
    world_end(w);
}

static void a_chain_bends_as_a_cantilever_with_shear(void **state) {
    (void)state;
    bends_as_a_cantilever(3, 1, 1e-3);
    bends_as_a_cantilever(3, 1, -1e-3);
    bends_as_a_cantilever(3, 2, 1e-3);
    bends_as_a_cantilever(2, 1, 1e-3);
    bends_as_a_cantilever(2, 1, -1e-3);
}

/* The tip is rotated by an angle about the axis and held: every bond has an equal part of it,
 * whatever the angle. */
static void a_chain_twists_by_the_same_angle_in_every_bond(void **state) {
    (void)state;
    enum { BONDS = 5 };
    const double dt = 4e-7;
    gn_world *w =
        chain(3, BONDS, "motion: {wx: [[0, 2000], [4e-4, 2000], [4.000001e-4, 0], [1, 0]]}",
              "damping: {background: {model: viscous, coefficient: 1e5}}\n"
              "time: {step: 4e-7, end: 1}\n");
    double angle = 0.0, kw = twist_stiffness();
    for (int k = 0; k < 6000; k++) {
        run_steps(w, 1);
        angle += dt * spin_of(w, BONDS)[0];
    }
    assert_near(angle, 0.8, 1e-2);
    gn_energy e = measured_step(w);
    for (size_t c = 0; c < BONDS; c++) {
        double m[3];
        moment_of(w, c, m);
        assert_close(m[0], kw * angle / BONDS, 1e-10);
        assert_near(m[1], 0.0, 1e-18);
    }
    assert_close(e.elastic_bending, 0.5 * kw * angle * angle / BONDS, 1e-10);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-12);
    world_end(w);
}

/* --- strength --- */

static const double limit_n = 20.0, limit_t = 12.0, share = 0.7;

/* Two touching particles, both driven: the first rotates relative to the second about y or z
 * (`bend`, rad/s each; no slip, as the arms are equal), the second is pulled and rotated about x.
 * */
static gn_world *driven_by(const char *law, const char *more, int dimension, double bend,
                           double pull, double twist, double slide) {
    bool space = dimension == 3;
    text t = {0};
    add(&t,
        "dimension: %d\nspecimen: {particles: [[0, 0, %s1e-3], [2e-3, 0, %s1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, friction: 0.3, "
        "bond_tension_limit: %g, bond_shear_limit: %g%s}]\nlaw: {stiffness: uniform%s}\n"
        "bonds: {radius_multiplier: %g, moment_share: %g}\nsets:\n",
        dimension, space ? "0, " : "", space ? "0, " : "", limit_n, limit_t, more, law, multiplier,
        share);
    add(&t, "  - {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0, %swz: %.17g}}\n",
        space ? "vz: 0, wx: 0, wy: 0, " : "", -bend);
    add(&t, "  - {name: b, select: {ids: [1]}, motion: {vx: %.17g, vy: %.17g, ", pull, slide);
    if (space) add(&t, "vz: 0, wx: %.17g, wy: 0, ", twist);
    add(&t, "wz: %.17g}}\ntime: {step: 1e-8, end: 1, on_unstable: warn}\nrun: {threads: 1}\n",
        bend);
    return world_of("%s", t.s);
}

static gn_world *driven(int dimension, double bend, double pull, double twist, double slide) {
    return driven_by("", "", dimension, bend, pull, twist, slide);
}

/* Returns the number of steps until the bond breaks, the ledger at that time, and the released
 * energy. */
static int64_t steps_to_break(gn_world *w, gn_energy *e) {
    measured_step(w);
    while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.step < 100000) run_steps(w, 1);
    int64_t steps = w->ctx.step - 1; /* the instant at which it broke */
    assert_close(w->dem.bonds.contacts.broken_time[0], (double)steps * 1e-8, 1e-9);
    *e = measured_step(w);
    assert_true(e->elastic_bending == 0.0);
    assert_true(fabs(gn_energy_residual(e)) < 1e-9);
    for (size_t a = 0; a < 3; a++)
        assert_true(w->dem.bonds.contacts.moment[a * w->dem.bonds.contacts.soa.capacity] == 0.0);
    world_end(w);
    return steps;
}

/* The first instant at which `rate` of load in a step reaches 1. */
static void reached(int64_t steps, double rate) {
    double exact = 1.0 / rate;
    assert_true(fabs(exact - round(exact)) >
                1e-6); /* the break is not on the boundary between two steps */
    assert_int_equal(steps, (int64_t)ceil(exact));
}

static void a_bond_breaks_by_bending_at_its_extreme_fibre(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int sign = -1; sign <= 1; sign += 2) {
            gn_energy e;
            gn_world *w = driven(dimension, sign * 317.3, 0.0, 0.0, 0.0);
            double k = bend_stiffness(dimension), z = dimension == 3 ? 4.0 : 3.0;
            double moment = k * 2.0 * 317.3 * 1e-8, limit = limit_n * multiplier * r / (z * share);
            int64_t steps = steps_to_break(w, &e);
            reached(steps, moment / limit);
            double last = moment * (double)steps;
            assert_near(e.bond_breaking, 0.5 * last * last / k, 1.01 * last * moment / k);
        }
}

static void a_bond_breaks_by_twist_at_its_rim(void **state) {
    (void)state;
    gn_energy e;
    gn_world *w = driven(3, 0.0, 0.0, 731.9, 0.0);
    double moment = twist_stiffness() * 731.9 * 1e-8,
           limit = limit_t * multiplier * r / (2.0 * share);
    int64_t steps = steps_to_break(w, &e);
    reached(steps, moment / limit);
}

static void a_bond_breaks_by_pull_and_bending_together(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_energy e;
        double speed = 0.0713, z = dimension == 3 ? 4.0 : 3.0;
        gn_world *w = driven(dimension, 217.3, speed, 0.0, 0.0);
        double pull = kn * speed * 1e-8;
        double moment = bend_stiffness(dimension) * 2.0 * 217.3 * 1e-8;
        int64_t steps = steps_to_break(w, &e);
        reached(steps, (pull + z * share * moment / (multiplier * r)) / limit_n);
    }
}

/* A bond compressed by as much as its fibre is bent holds; twice that bend breaks it. */
static void pressure_reduces_the_tension_of_bending(void **state) {
    (void)state;
    double bend = 317.3, moment = bend_stiffness(3) * 2.0 * bend * 1e-8;
    double fibre = 4.0 * share * moment / (multiplier * r);
    gn_world *w = driven(3, bend, -fibre / (kn * 1e-8), 0.0, 0.0);
    run_steps(w, 20000);
    assert_true(20000 * fibre > 5.0 * limit_n);
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
    world_end(w);
    w = driven(3, 2.0 * bend, -fibre / (kn * 1e-8), 0.0, 0.0);
    gn_energy e;
    reached(steps_to_break(w, &e), fibre / limit_n);
}

static void twist_and_bending_add_to_their_own_stress_only(void **state) {
    (void)state;
    gn_energy e;
    double bend = 317.3, twist = 211.0;
    double moment = bend_stiffness(3) * 2.0 * bend * 1e-8,
           limit = limit_n * multiplier * r / (4.0 * share);
    gn_world *w = driven(3, bend, 0.0, twist, 0.0);
    reached(steps_to_break(w, &e), moment / limit);
    w = driven(3, bend, 0.0, 6.0 * twist, 0.0);
    moment = twist_stiffness() * 6.0 * twist * 1e-8;
    reached(steps_to_break(w, &e), moment * 2.0 * share / (multiplier * r * limit_t));
}

/* The bond is sheared across the normal as well: the normal rotates by 1e-4, which tilts the
 * increment. */
static void shear_and_twist_add_up(void **state) {
    (void)state;
    gn_energy e;
    double speed = 0.0713, twist = 331.9;
    gn_world *w = driven(3, 0.0, 0.0, twist, speed);
    double shear = kt * speed * 1e-8;
    double moment = twist_stiffness() * twist * 1e-8 * 2.0 * share / (multiplier * r);
    double exact = limit_t / (shear + moment), turn = speed * exact * 1e-8 / (2.0 * r);
    assert_near((double)steps_to_break(w, &e), ceil(exact), 1.0 + 2.0 * turn * turn * exact);
}

/* A bond is bent and twisted, in 2D bent and sheared, with increments a and b per step relative to
 * the strengths of the fibre: it breaks at the first n with n^2 (a^2 + b^2) >= 1, by the larger of
 * the two. */
static void coupled_by_squares_the_shares_of_the_fibre_add_up(void **state) {
    (void)state;
    const double ratio[] = {0.4, 0.9, 1.6};
    for (int k = 0; k < 6; k++) {
        int dimension = 2 + k % 2;
        double z = dimension == 3 ? 4.0 : 3.0, bend = 117.3, pull = 0.0113;
        double a = z * share * bend_stiffness(dimension) * 2.0 * bend * 1e-8 / (multiplier * r);
        a = (a + kn * pull * 1e-8) / limit_n;
        double b = ratio[k / 2] * a, turn = 0.0, slide = 0.0;
        if (dimension == 3)
            turn = b * limit_t * multiplier * r / (2.0 * share * twist_stiffness() * 1e-8);
        else
            slide = b * limit_t / (kt * 1e-8);
        gn_world *w = driven_by(", coupling: quadratic", "", dimension, bend, pull, turn, slide);
        gn_energy e;
        double exact = 1.0 / hypot(a, b), tilt = slide * exact * 1e-8 / (2.0 * r);
        measured_step(w);
        run_steps(w, (int64_t)(0.9 * exact));
        assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
        while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.step < 100000) run_steps(w, 1);
        assert_int_equal(w->dem.bonds.contacts.cause[0],
                         b > a ? GN_BROKEN_SHEAR : GN_BROKEN_TENSION);
        assert_near((double)(w->ctx.step - 1), ceil(exact), 1.0 + 2.0 * tilt * exact);
        e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-9);
        world_end(w);
    }
}

/* The tension that bending adds at one fibre does not reduce the pressure for friction: under
 * pressure, bending and sliding the bond breaks when its strength is reached, and not before. */
static void the_criterion_of_a_bent_bond_is_one_where_it_breaks(void **state) {
    (void)state;
    const char *const couplings[] = {", coupling: none", ", coupling: quadratic",
                                     ", coupling: linear"};
    for (int k = 0; k < 9; k++) {
        const double pull[] = {-0.1, -0.05, 0.02}, n[] = {1.0, 0.0, 0.0};
        gn_world *w =
            driven_by(couplings[k % 3], ", bond_friction: 0.6", 3, 217.3, pull[k / 3], 331.9, 0.0);
        double last = 0.0;
        run_steps(w, 1);
        while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.step < 100000) {
            const gn_contacts *b = &w->dem.bonds.contacts;
            const gn_law *law = gn_law_of(b->soa.effects);
            const double *at = w->dem.particles.pos;
            gn_law_moments m = law->moments(b, 0, n);
            /* stretch at the positions for which the last forces were computed, one step before */
            double u = hypot(at[4] - at[0], at[5] - at[1]) - 2.0 * r - pull[k / 3] * 1e-8;
            last = law->criterion(b, 0, kn * u, m.normal, m.shear);
            run_steps(w, 1);
        }
        int64_t steps = w->ctx.step;
        assert_in_range(steps, 500, 99999);
        assert_near(last, 1.0, 2.0 / (double)steps);
        world_end(w);
    }
}

/* --- bodies that turn --- */

static void sum_up(const gn_world *w, double momentum[3], double turning[3]) {
    memset(momentum, 0, 3 * sizeof *momentum);
    memset(turning, 0, 3 * sizeof *turning);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double *x = w->dem.particles.pos + 4 * p, *v = w->dem.particles.vel + 4 * p,
                     *s = w->dem.particles.spin + 4 * p;
        double l[3], middle[3];
        /* The particle's position half a step earlier, the time of that velocity. */
        for (int a = 0; a < 3; a++) middle[a] = x[a] - 0.5 * w->ctx.dt_past * v[a];
        cross3(middle, v, l);
        for (int a = 0; a < 3; a++) {
            momentum[a] += v[a] / v[3];
            turning[a] += l[a] / v[3] + (s[3] > 0.0 ? s[a] / s[3] : 0.0);
        }
    }
}

/* A ring of twelve spheres (discs), with random velocities superposed on a rotation about an
 * oblique axis. */
static gn_world *ring(int dimension, double speed, const char *more) {
    text t = {0};
    bool space = dimension == 3;
    double radius = r / sin(pi / 12.0);
    add(&t, "dimension: %d\nspecimen: {particles: [", dimension);
    for (int k = 0; k < 12; k++)
        add(&t, "%s[%.17g, %.17g, %s1e-3]", k ? ", " : "", radius * cos(pi * k / 6.0),
            radius * sin(pi * k / 6.0), space ? "0, " : "");
    add(&t,
        "]}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, "
        "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\n"
        "bonds: {radius_multiplier: %g}\nsets:\n",
        multiplier);
    double w[3] = {space ? 700.0 : 0.0, space ? -300.0 : 0.0, speed};
    for (int k = 0; k < 12; k++) {
        double x[3] = {radius * cos(pi * k / 6.0), radius * sin(pi * k / 6.0), 0.0}, v[3];
        cross3(w, x, v);
        for (int a = 0; a < 3; a++) v[a] += 2.5e-5 * speed * gn_random_symmetric(5, 3 * k + a);
        if (space)
            add(&t,
                "  - {name: p%d, select: {ids: [%d]}, initial_velocity: [%.17g, %.17g, %.17g], "
                "initial_spin: [%.17g, %.17g, %.17g]}\n",
                k, k, v[0], v[1], v[2], w[0], w[1], w[2] + 5e-3 * speed * k);
        else
            add(&t,
                "  - {name: p%d, select: {ids: [%d]}, initial_velocity: [%.17g, %.17g], "
                "initial_spin: %.17g}\n",
                k, k, v[0], v[1], w[2] + 5e-3 * speed * k);
    }
    add(&t, "%srun: {threads: 1}\n", more);
    return world_of("%s", t.s);
}

/* Sums of 1e5 additions with random rounding: about 1e-16 x sqrt(1e5) of the largest number, plus a
 * margin. */
static void a_bent_ring_keeps_momentum_and_energy(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        const double spin = dimension == 3 ? 2000.0 : 75.0; /* discs are 750 times as heavy */
        gn_world *w = ring(dimension, spin, "time: {end: 100}\n");
        double p0[3], l0[3], p1[3], l1[3], most = 0.0;
        gn_energy first = measured_step(w);
        sum_up(w, p0, l0);
        gn_energy e = first;
        for (int k = 0; k < 100; k++) {
            run_steps(w, 999);
            e = measured_step(w);
            most = fmax(most, e.elastic_bending / gn_energy_stored(&e));
        }
        sum_up(w, p1, l1);
        double speed = spin * r / sin(pi / 12.0), mass = mass_of(w, 0);
        for (int a = 0; a < 3; a++) {
            assert_near(p1[a], p0[a], 1e-11 * 12.0 * mass * speed);
            assert_near(l1[a], l0[a], 1e-11 * 12.0 * mass * speed * r / sin(pi / 12.0));
        }
        print_message("# ring in %dD: %.2g of the energy is bending, residual %.2g\n", dimension,
                      most, gn_energy_residual(&e));
        /* Without moments the residual is equally large: the normal rotates by 2e-3 rad in a step,
         * and the relative error of the tangential force is the square of half of that. */
        assert_true(most > 1e-6);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
        world_end(w);
    }
}

/* A pair with bending and twist rotates as a whole about an axis, with equal spins: the bond is not
 * strained further, so its moment rotates with it and keeps its magnitude, whatever the angle of a
 * step. */
static void a_moment_turns_with_its_bond(void **state) {
    (void)state;
    const double axes[3][3] = {{1, 0, 0}, {0, 0, 1}, {0.48, 0.6, 0.64}};
    for (int k = 0; k < 3; k++) {
        const double *axis = axes[k], dt = 1e-6, angle = 2.0 * pi / 2000.0, w = angle / dt;
        gn_effects fx = GN_FX_SPACE | GN_FX_ROTATION | GN_FX_SHEAR | GN_FX_BONDS |
                        GN_FX_BOND_MOMENTS | GN_FX_ENERGY;
        gn_particles p;
        gn_contacts c;
        assert_int_equal(gn_soa_create(&gn_particle_record, &p, 2, fx, NULL), GNEISS_OK);
        assert_int_equal(gn_soa_create(&gn_contact_record, &c, 1, fx, NULL), GNEISS_OK);
        gn_particles_set_null(&p, 1.0);
        gn_contacts_pad(&c, &p);
        c.i[0] = 0;
        c.j[0] = 1;
        c.kn[0] = kn;
        c.kt[0] = kt;
        c.rn[0] = c.rt[0] = 1e30;
        c.length0[0] = 2.0 * r;
        c.beam[0] = multiplier * r;
        const double start[3] = {2e-3, 3e-3, -1e-3};
        for (size_t a = 0; a < 3; a++) c.moment[a * c.soa.capacity] = start[a];
        p.pos[3] = p.pos[7] = r;
        gn_contact_args args = {.pos = p.pos,
                                .vel = p.vel,
                                .spin = p.spin,
                                .contacts = &c,
                                .dt = dt,
                                .arm_factor = 0.5,
                                .measure = true};
        double arm[3] = {r, 0, 0}, first = 0.0, stored = 0.0;
        for (int step = 0; step < 2000; step++) {
            double now[3], side[3], along = dot3(axis, arm) * (1.0 - cos(angle));
            cross3(axis, arm, side);
            for (int a = 0; a < 3; a++)
                now[a] = arm[a] * cos(angle) + side[a] * sin(angle) + axis[a] * along;
            for (int a = 0; a < 3; a++) {
                p.pos[a] = -now[a];
                p.pos[4 + a] = now[a];
                p.vel[a] = -(now[a] - arm[a]) / dt;
                p.vel[4 + a] = (now[a] - arm[a]) / dt;
                p.spin[a] = p.spin[4 + a] = axis[a] * w;
            }
            memcpy(arm, now, sizeof arm);
            gn_contact_sums sums = {0};
            gn_kernel_set_at(0)->contact[gn_contact_variant(fx)](&args, 0, 1, &sums);
            stored = sums.elastic_bending;
            if (step == 0) first = stored;
        }
        /* The twist is included to second order: directions have an error of angle^3/6 per step,
         * magnitudes of angle^4/8; the mean of both spins is projected on the middle normal. */
        double off = 0.0, allowed = 2.0 * pi * angle * angle / 6.0 * 1.1;
        for (size_t a = 0; a < 3; a++) off += pow(c.moment[a * c.soa.capacity] - start[a], 2.0);
        assert_true(sqrt(off) / length3(start) < allowed);
        assert_close(stored, first, 2.0 * pi * pow(angle, 3.0) / 4.0 * 1.1 + 1e-11);
        gn_soa_destroy(&gn_particle_record, &p);
        gn_soa_destroy(&gn_contact_record, &c);
    }
}

/* --- the step --- */

/* A lattice or rock whose bonds carry moments, shaken; `dt` 0: automatic. */
static gn_world *shaken(int dimension, double times, double dt) {
    char step[40] = "auto";
    if (dt > 0.0) snprintf(step, sizeof step, "%.17g", dt);
    return world_of("dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: %s}}\n"
                    "materials: [{name: m, density: 2650, contact_modulus: 1e10, kratio: 1.5, "
                    "tensile_strength: 1e30, shear_strength: 1e30}]\nlaw: {stiffness: arithmetic}\n"
                    "bonds: {radius_multiplier: %g}\n"
                    "initial: {random_velocity: 1e-4}\n"
                    "time: {step: %s, on_unstable: warn, end: 100}\nrun: {threads: 1}\n",
                    dimension, dimension == 3 ? "fcc" : "hexagonal",
                    dimension == 3 ? "[3, 3, 3]" : "[8, 5]", times, step);
}

static double growth(int dimension, double times, double dt, int64_t steps) {
    gn_world *w = shaken(dimension, times, dt);
    gneiss_error error = {0};
    double start = 0.0, largest = 0.0;
    for (int64_t k = 0; k < steps && largest <= 1e3; k++) {
        bool measure = k % 20 == 0;
        if (gn_world_step(w, measure, &error) != GNEISS_OK) {
            largest = INFINITY;
            break;
        }
        if (!measure) continue;
        double stored = gn_energy_stored(&w->ledger.reading);
        if (k == 0) start = stored;
        largest = isfinite(stored) ? fmax(largest, stored / start) : INFINITY;
    }
    world_end(w);
    return largest;
}

/* Multipliers with which the moments are negligible, matter, and set the step. */
static void bodies_are_stable_up_to_the_limit_with_moments(void **state) {
    (void)state;
    double before = INFINITY;
    for (int dimension = 2; dimension <= 3; dimension++, before = INFINITY)
        for (double times = 0.5; times < 5.0; times *= 2.5) {
            gn_world *w = shaken(dimension, times, 0.0);
            double limit = w->ctx.stable;
            world_end(w);
            assert_true(limit < before);
            before = limit;
            assert_true(growth(dimension, times, 0.99 * limit, 3000) < 1.0 + 1e-5);
            assert_true(growth(dimension, times, 1.05 * limit, 2000) > 1e3);
        }
}

/* --- with all other options --- */

/* A block hits a floor with all options of contacts. Its bonds break in every mode, and some of its
 * particles leave the domain. */
static const char *const thrown =
    "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: %s, jitter: 0.02}}\n"
    "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2.5, friction: 0.4, "
    "tensile_strength: %g, shear_strength: %g}]\nlaw: {stiffness: harmonic, coupling: %s}\n"
    "bonds: {radius_multiplier: 0.9, moment_share: 0.8}\n"
    "damping: {background: {model: nonviscous_vector, coefficient: 0.02}, contact: {restitution: "
    "0.7}}\ngravity: %s\nwalls: [{name: floor, point: %s, normal: %s, stiffness: 1e6, kratio: 2, "
    "friction: 0.3}]\ninitial: {random_velocity: %g}\n"
    "domain: {min: %s, max: %s, lost: remove}\n"
    "time: {end: 1, safety: 0.3}\nrun: {threads: %d, precision: %s}\n";

static const char *coupling = "none";

static char *thrown_text(int dimension, double strength, double speed, int threads,
                         const char *precision) {
    static char made[4096];
    bool space = dimension == 3;
    snprintf(made, sizeof made, thrown, dimension, space ? "fcc" : "hexagonal",
             space ? "[5, 5, 5]" : "[10, 8]", strength, 0.4 * strength, coupling,
             space ? "[0, 0, -9.81]" : "[0, -9.81]", space ? "[0, 0, -1e-3]" : "[0, -1e-3]",
             space ? "[0, 0, 1]" : "[0, 1]", speed,
             space ? "[-3e-3, -3e-3, -3e-3]" : "[-3e-3, -3e-3]",
             space ? "[0.02, 0.02, 0.02]" : "[0.035, 0.035]", threads, precision);
    return made;
}

static void bits_are_the_same_for_any_number_of_threads(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 3; k++) {
            const int mixed = k % 2;
            uint64_t hash[2];
            coupling = k / 2 ? "quadratic" : "none";
            for (int threads = 1; threads <= 2; threads++) {
                gn_world *w = world_of(
                    "%s", thrown_text(dimension, 3e6, 4.0, threads, mixed ? "mixed" : "double"));
                run_steps(w, 1200);
                hash[threads - 1] =
                    gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
                assert_true(w->dem.broken_tension > 5 && w->dem.broken_shear > 5);
                world_end(w);
            }
            assert_true(hash[0] == hash[1]);
        }
    coupling = "none";
}

/* In short steps the residual comes from normals that rotate within a step and from contacts that
 * close or break, and is of second order; without moments it is as large. */
static void the_ledger_closes_while_bonds_break(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 3; k++) {
            const int mixed = k % 2;
            coupling = k / 2 ? "quadratic" : "none";
            gn_world *w =
                world_of("%s", thrown_text(dimension, 3e6, 4.0, 1, mixed ? "mixed" : "double"));
            double most = 0.0;
            measured_step(w);
            for (int turn = 0; turn < 30; turn++) {
                run_steps(w, 99);
                gn_energy e = measured_step(w);
                most = fmax(most, fabs(gn_energy_residual(&e)));
            }
            print_message("# %dD %s, coupling %s: %lld + %lld of %lld bonds broken, residual "
                          "%.2g\n",
                          dimension, mixed ? "mixed" : "double", coupling,
                          (long long)w->dem.broken_tension, (long long)w->dem.broken_shear,
                          (long long)w->dem.bonds_at_start, most);
            assert_true(most < 1e-4);
            world_end(w);
        }
    coupling = "none";
}

/* Three spheres leave the domain one after another with bent and twisted bonds: the energy of their
 * bonds leaves with them, and the work of the last half step. The residual comes from normals that
 * rotate by 1e-4 in a step. */
static void the_energy_of_bent_bonds_leaves_with_their_particles(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        text t = {0};
        add(&t, "dimension: %d\nspecimen: {particles: [", dimension);
        for (int k = 0; k < 5; k++)
            add(&t, "%s[%.17g, 0, %s1e-3]", k ? ", " : "", 2.0 * r * k, space ? "0, " : "");
        add(&t,
            "]}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, "
            "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\n"
            "bonds: {radius_multiplier: 1}\ndomain: {min: [-1, -1%s], max: [8.3e-3, 1%s], lost: "
            "remove}\nsets:\n",
            space ? ", -1" : "", space ? ", 1" : "");
        for (int k = 0; k < 5; k++)
            if (space)
                add(&t,
                    "  - {name: p%d, select: {ids: [%d]}, initial_velocity: [10, 0, 0], "
                    "initial_spin: "
                    "[%g, %g, %g]}\n",
                    k, k, 900.0 * (k % 2), 700.0 * (k % 3), -800.0 * (k % 2));
            else
                add(&t,
                    "  - {name: p%d, select: {ids: [%d]}, initial_velocity: [10, 0], initial_spin: "
                    "%g}\n",
                    k, k, 900.0 * (k % 2));
        add(&t, "time: {end: 1, safety: 0.1}\nrun: {threads: 1}\n");
        gn_world *w = world_of("%s", t.s);
        double bent = 0.0;
        gn_energy e = measured_step(w);
        for (int k = 0; k < 100000 && w->dem.lost < 3; k++) {
            run_steps(w, 1);
            if (k % 20) continue;
            e = measured_step(w);
            bent = fmax(bent, e.elastic_bending);
        }
        e = measured_step(w);
        assert_int_equal(w->dem.lost, 3);
        assert_true(e.removed > 100.0 * bent && bent > 1e-9);
        print_message("# %dD: %.2g J in bending, ledger open by %.2g J\n", dimension, bent,
                      gn_energy_residual(&e) * gn_energy_scale(&e));
        assert_true(fabs(gn_energy_residual(&e)) * gn_energy_scale(&e) < 1e-4 * bent);
        world_end(w);
    }
}

static void ok(gneiss_status status, const gneiss_error *error) {
    if (status != GNEISS_OK) fail_msg("%s", error->message);
}

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        gneiss_error error = {0};
        gn_scene scene;
        gn_run whole, run;
        char path[] = "/tmp/bond_moments_XXXXXX";
        int file = mkstemp(path);
        assert_true(file >= 0);
        close(file);
        coupling = mixed ? "quadratic" : "none";
        const char *thrown_block = thrown_text(3, 3e6, 4.0, 1, mixed ? "mixed" : "double");
        coupling = "none";
        ok(gn_scene_parse(thrown_block, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
        ok(gn_run_create(&scene, &whole, &error), &error);
        ok(gn_run_steps(&whole, 300, &error), &error);
        ok(gn_checkpoint_write(&whole, path, &error), &error);
        ok(gn_run_load(path, NULL, 0, &run, &error), &error);
        assert_true(gn_world_hash(&run.world.ctx, &run.world.dem, &run.world.boundary,
                                  &run.world.solids, &run.world.box) ==
                    gn_world_hash(&whole.world.ctx, &whole.world.dem, &whole.world.boundary,
                                  &whole.world.solids, &whole.world.box));
        ok(gn_run_steps(&whole, 300, &error), &error);
        ok(gn_run_steps(&run, 300, &error), &error);
        assert_true(gn_world_hash(&run.world.ctx, &run.world.dem, &run.world.boundary,
                                  &run.world.solids, &run.world.box) ==
                    gn_world_hash(&whole.world.ctx, &whole.world.dem, &whole.world.boundary,
                                  &whole.world.solids, &whole.world.box));
        gn_run_free(&whole);
        gn_run_free(&run);
        unlink(path);
    }
}

/* The system is elastic, so that small differences stay small: forces in single precision are off
 * by some 1e-6. */
static void moments_in_single_precision_follow_the_double_ones(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_world *w[2];
        double most = 0.0, off = 0.0;
        for (int mixed = 0; mixed < 2; mixed++) {
            w[mixed] =
                world_of("%s", thrown_text(dimension, 1e20, 0.1, 1, mixed ? "mixed" : "double"));
            run_steps(w[mixed], 200);
        }
        for (size_t c = 0; c < w[0]->dem.bonds.contacts.soa.count; c++) {
            double a[3], b[3];
            moment_of(w[0], c, a);
            moment_of(w[1], c, b);
            for (int k = dimension == 3 ? 0 : 2; k < 3; k++) {
                most = fmax(most, fabs(a[k]));
                off = fmax(off, fabs(a[k] - b[k]));
            }
        }
        print_message("# %dD: moments off by %.2g of the largest\n", dimension, off / most);
        assert_true(off > 0.0 && off < 1e-4 * most);
        world_end(w[0]);
        world_end(w[1]);
    }
}

/* With a share of 0 the strength depends on forces only, and a thin beam hardly bends: the results
 * are those without moments. */
static void thin_beams_are_no_beams(void **state) {
    (void)state;
    gn_world *w[2];
    for (int k = 0; k < 2; k++) {
        w[k] = world_of(
            "dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1e-3, cells: [3, 3, 3]}}\n"
            "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2.5, friction: "
            "0.4, "
            "tensile_strength: 3e6, shear_strength: 2e6}]\nlaw: {stiffness: harmonic}\n"
            "bonds: {%s}\ninitial: {random_velocity: 3}\ntime: {step: 1e-6, end: 1}\n"
            "run: {threads: 1}\n",
            k ? "radius_multiplier: 1e-9, moment_share: 0" : "enabled: on");
        run_steps(w[k], 100);
    }
    assert_true(w[1]->ctx.effects & GN_FX_BOND_MOMENTS &&
                !(w[0]->ctx.effects & GN_FX_BOND_MOMENTS));
    assert_int_equal(w[0]->dem.broken_tension, w[1]->dem.broken_tension);
    assert_int_equal(w[0]->dem.broken_shear, w[1]->dem.broken_shear);
    assert_true(w[0]->dem.broken_tension > 0);
    for (int p = 0; p < 100; p++)
        for (int a = 0; a < 3; a++) assert_near(pos_of(w[0], p)[a], pos_of(w[1], p)[a], 1e-15);
    world_end(w[0]);
    world_end(w[1]);
}

/* --- keys --- */

static void expect_refusal(const char *law, const char *bonds, const char *kratio,
                           const char *place, const char *words) {
    char scene[1024];
    gneiss_error error = {0};
    gn_world w;
    snprintf(scene, sizeof scene,
             "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]}\n"
             "materials: [{name: m, density: 2500, normal_stiffness: 1e5, bond_tension_limit: 70, "
             "bond_shear_limit: 90, kratio: %s}]\n"
             "law: {stiffness: uniform%s}\nbonds: {%s}\ntime: {end: 1}\nrun: {threads: 1}\n",
             kratio, law, bonds);
    assert_int_equal(world_try(&w, scene, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, place) || !strstr(error.message, words))
        fail_msg("%s: expected %s and %s", error.message, place, words);
}

/* Forces and moments on a particle with several bonds add up in one order. */
static void bits_are_the_same_for_any_width_of_vectors(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        uint64_t hash[2];
        for (int set = 0; set < 2; set++) {
            gn_world *w =
                world_of("dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: %s}}\n"
                         "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2, "
                         "bond_tension_limit: 1e90, bond_shear_limit: 1e90}]\n"
                         "law: {stiffness: uniform}\nbonds: {radius_multiplier: 1}\n"
                         "initial: {random_velocity: 1}\ntime: {end: 1}\n"
                         "run: {threads: 1, isa: %s, precision: %s}\n",
                         2 + k / 2, k / 2 ? "fcc" : "hexagonal", k / 2 ? "[3, 2, 2]" : "[4, 3]",
                         set ? "auto" : "scalar", k % 2 ? "mixed" : "double");
            run_steps(w, 40);
            hash[set] = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
            world_end(w);
        }
        assert_int_equal(hash[0], hash[1]);
    }
}

static void bad_values_are_refused_at_their_place(void **state) {
    (void)state;
    expect_refusal("", "radius_multiplier: -1", "2", "s.yaml:5:", "bonds.radius_multiplier");
    expect_refusal("", "radius_multiplier: nan", "2", "s.yaml:5:", "bonds.radius_multiplier");
    expect_refusal("", "radius_multiplier: 101", "2", "s.yaml:5:", "found");
    expect_refusal("", "radius_multiplier: 1, moment_share: 1.5", "2",
                   "s.yaml:5:", "bonds.moment_share");
    expect_refusal("", "radius_multiplier: 1", "0", "s.yaml:3:", "materials[0].kratio");
    expect_refusal(", rotation: off", "radius_multiplier: 1", "2", "s.yaml:5:", "law.rotation");
    expect_refusal("", "moment_share: 0.5", "2", "s.yaml:5:", "needs a radius_multiplier");
    expect_refusal(", rotation: off", "radius_multiplier: 1", "2",
                   "s.yaml:5:", "expected 0 with law.rotation: off");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_bends_as_a_cantilever_with_shear),
        cmocka_unit_test(a_chain_twists_by_the_same_angle_in_every_bond),
        cmocka_unit_test(a_bond_breaks_by_bending_at_its_extreme_fibre),
        cmocka_unit_test(a_bond_breaks_by_twist_at_its_rim),
        cmocka_unit_test(a_bond_breaks_by_pull_and_bending_together),
        cmocka_unit_test(pressure_reduces_the_tension_of_bending),
        cmocka_unit_test(twist_and_bending_add_to_their_own_stress_only),
        cmocka_unit_test(shear_and_twist_add_up),
        cmocka_unit_test(coupled_by_squares_the_shares_of_the_fibre_add_up),
        cmocka_unit_test(the_criterion_of_a_bent_bond_is_one_where_it_breaks),
        cmocka_unit_test(a_bent_ring_keeps_momentum_and_energy),
        cmocka_unit_test(a_moment_turns_with_its_bond),
        cmocka_unit_test(bodies_are_stable_up_to_the_limit_with_moments),
        cmocka_unit_test(bits_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(the_ledger_closes_while_bonds_break),
        cmocka_unit_test(the_energy_of_bent_bonds_leaves_with_their_particles),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(moments_in_single_precision_follow_the_double_ones),
        cmocka_unit_test(thin_beams_are_no_beams),
        cmocka_unit_test(bits_are_the_same_for_any_width_of_vectors),
        cmocka_unit_test(bad_values_are_refused_at_their_place),
    };
    return cmocka_run_group_tests_name("bond_moments", tests, NULL, NULL);
}
