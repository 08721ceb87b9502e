/* Bonds that soften and yield (src/kernels/law_softening.h): one bond on given paths compared with
 * formulas and an independent integrator, and scenes. */
#include "particles/bond_sections.h"
#include "softening_bond.h"

static const double uf = 6e-6, us = 9e-6, mu1 = 0.8, mu2 = 0.3;

/* --- tension --- */

/* The force of a bond that has been stretched up to `most`, from the line alone. */
static double pulled(double u, double most) {
    double limit = rn / kn;
    if (u < 0.0) return kn * u;
    if (most <= limit) return kn * u;
    if (most >= uf) return 0.0;
    double top = rn * (uf - most) / (uf - limit);
    return u >= most ? top : top * u / most;
}

static void softening_in_tension_is_linear_and_unloads_on_the_secant(void **state) {
    (void)state;
    bond *t = make(&concrete, 0);
    const double path[] = {1e-6, 2e-6, 3e-6, 1e-6, 0.0, 2e-6, 3e-6, 4e-6, 5e-6, 0.5e-6, 5.9e-6};
    double most = 0.0;
    for (size_t k = 0; k < sizeof path / sizeof *path; k++) {
        move(t, path[k], 0.0, 0.0);
        most = fmax(most, t->u);
        assert_near(t->force[0], pulled(t->u, most), force_rounding);
        double d = most > 2e-6 ? uf * (most - 2e-6) / (most * (uf - 2e-6)) : 0.0;
        assert_near(1.0 - t->k.soft[0], d, 1e-12);
    }
    assert_int_equal(t->k.cause[0], GN_INTACT);
    move(t, 6.1e-6, 0.0, 0.0);
    assert_int_equal(t->k.cause[0], GN_BROKEN_TENSION);
    assert_near(t->force[0], 0.0, 0.0);
    end(t);
}

/* Steps end where the line has a kink: trapezoids are then the exact areas. */
static void linear_softening_dissipates_the_fracture_energy(void **state) {
    (void)state;
    for (int steps = 1; steps <= 64; steps *= 8) {
        bond *t = make(&concrete, 0);
        for (int k = 1; k <= steps; k++) move(t, 2e-6 * k / steps, 0.0, 0.0);
        for (int k = 1; k <= steps; k++) move(t, 2e-6 + 4e-6 * k / steps, 0.0, 0.0);
        move(t, 6.001e-6, 0.0, 0.0);
        assert_int_equal(t->k.cause[0], GN_BROKEN_TENSION);
        assert_near(t->lost, 15.0 * area, 1e-12 * 15.0 * area + 1e-11 * 1e-5);
        assert_near(t->work, t->lost, 1e-16);
        end(t);
    }
}

/* In compression the damaged bond has the full k_n again. */
static void a_damaged_bond_closes_with_all_of_its_stiffness(void **state) {
    (void)state;
    bond *t = make(&concrete, 0);
    move(t, 5e-6, 0.0, 0.0);
    move(t, 0.0, 0.0, 0.0);
    move(t, -3e-6, 0.0, 0.0);
    move(t, -4e-6, 0.0, 0.0);
    assert_near(t->force[0], kn * t->u, force_rounding);
    end(t);
}

/* Random paths back and forth until past u_f, in steps of any size that end where the spring is
 * free of force. (A step from compression to beyond the strength has a trapezoidal work below the
 * energy that the damaged spring loses, as for bonds that break in one step.) */
static void random_pulls_follow_the_line(void **state) {
    (void)state;
    uint64_t at = 5;
    size_t checked = 0;
    for (int path = 0; path < 1000; path++) {
        bond *t = make(&concrete, 0);
        double most = 0.0, lost = 0.0;
        for (int k = 0; k < 60 && !t->k.cause[0]; k++) {
            double to = uniform(&at, -3e-6, 1e-6 + 1e-7 * k);
            move(t, to * t->u < 0.0 ? 0.0 : to, 0.0, 0.0);
            most = fmax(most, t->u);
            assert_true(t->lost >= lost - energy_rounding);
            lost = t->lost;
            if (t->k.cause[0]) break;
            assert_near(t->force[0], pulled(t->u, most), force_rounding);
            double stored = t->u * t->force[0] / 2.0;
            assert_near(t->work, stored + t->lost, 1e-12 * (stored + t->lost) + 1e-17);
            checked++;
        }
        assert_true((most < uf) == (t->k.cause[0] == GN_INTACT));
        end(t);
    }
    assert_true(checked > 30000);
}

/* --- shear --- */

/* The tangential force after the step to the trial force `size`, by halving the slip. */
static double slipped(double size, double n, double d, double *kappa) {
    double low = 0.0, high = us * (1.0 - *kappa), k = *kappa;
#define SURFACE(s)                                                                                 \
    ((1.0 - fmax(d, k + (s) / us)) * cohesion +                                                    \
     ((1.0 - k - (s) / us) * mu1 + (k + (s) / us) * mu2) * (n))
    if (size <= SURFACE(0.0)) return size;
    if (size - kt * high > SURFACE(high)) {
        *kappa = 1.0;
        return fmin(size, mu2 * n);
    }
    for (int turn = 0; turn < 200; turn++) {
        double middle = 0.5 * (low + high);
        if (size - kt * middle > SURFACE(middle))
            low = middle;
        else
            high = middle;
    }
    *kappa = k + high / us;
    return size - kt * high;
}

static double across(const bond *t) {
    return hypot(t->force[1], t->force[2]);
}

/* 1000 paths, each under its own pressure or tension: shear in all directions, to and fro; and
 * occasionally normal motion, which the surface follows. */
static void random_shear_follows_the_surface(void **state) {
    (void)state;
    uint64_t at = 17;
    size_t checked = 0, broken = 0, damaged = 0;
    for (int path = 0; path < 1000; path++) {
        bond *t = make(&concrete, 0);
        double kappa = 0.0, most = 0.0, f[2] = {0, 0}, u = 0.0;
        for (int k = 0; k < 60 && !t->k.cause[0]; k++) {
            double y = 0.0, z = 0.0;
            if (k % 5 == 0) {
                double to = uniform(&at, -5e-6, path % 2 ? -1e-7 : 3.5e-6);
                if (to * u < 0.0)
                    to = 1e-9 * copysign(1.0, u); /* a step does not lead past zero stretch */
                move(t, to, 0.0, 0.0);
            } else {
                y = uniform(&at, -1.5e-6, 2e-6);
                z = uniform(&at, -1e-6, 1e-6);
                move(t, u, y, z);
            }
            u = t->u;
            most = fmax(most, u);
            double d = most > 2e-6 ? uf * (most - 2e-6) / (most * (uf - 2e-6)) : 0.0;
            double trial[2] = {f[0] + kt * y, f[1] + kt * z}, size = hypot(trial[0], trial[1]);
            double n = fmax(0.0, -pulled(u, most)), left = slipped(size, n, d, &kappa);
            bool onward = f[0] * trial[0] + f[1] * trial[1] >= 0.0;
            for (int a = 0; a < 2; a++) f[a] = size > 0.0 ? trial[a] * left / size : 0.0;
            damaged += d > 0.0;
            /* The tangential speed is divided by dt; the slope of the surface amplifies rounding by
             * k_t/(k_t - H) < 3. */
            assert_near(t->force[1], f[0], 1e-11 * (1.0 + size));
            assert_near(t->force[2], f[1], 1e-11 * (1.0 + size));
            /* The damage never decreases, except where a step reverses the force. */
            if (onward) assert_true(t->sums.damage >= -energy_rounding);
            if (kappa < 1.0)
                assert_near(t->k.kappa[0], kappa, 1e-11);
            else
                assert_int_equal(t->k.cause[0], GN_BROKEN_SHEAR);
            checked++;
        }
        broken += t->k.cause[0] == GN_BROKEN_SHEAR;
        end(t);
    }
    assert_true(checked > 20000 && broken > 300 && damaged > 1000);
}

/* Without pressure the slip from C down to 0 dissipates C u_s/2, whatever the steps. */
static void softening_in_shear_dissipates_its_fracture_energy(void **state) {
    (void)state;
    for (int steps = 1; steps <= 64; steps *= 8) {
        bond *t = make(&concrete, 0);
        for (int k = 0; k < steps; k++) move(t, 0.0, 3e-6 / steps, 0.0);
        for (int k = 0; k < steps; k++) move(t, 0.0, 0.9999999 * 6e-6 / steps, 0.0);
        assert_int_equal(t->k.cause[0], GN_INTACT);
        assert_near(across(t), 12.0 * 1e-7, 1e-9);
        move(t, 0.0, 1e-11, 0.0);
        assert_int_equal(t->k.cause[0], GN_BROKEN_SHEAR);
        assert_near(t->lost, 13.5 * area, 1e-12 * 13.5 * area + 1e-11 * 1e-5);
        end(t);
    }
}

/* Under pressure the softening ends at the friction of the broken bond without a jump. */
static void under_pressure_shear_softens_to_friction(void **state) {
    (void)state;
    bond *t = make(&concrete, 0);
    move(t, -3e-6, 0.0, 0.0);
    double before = 0.0, largest = 0.0, n = -t->force[0];
    double slope = (cohesion + (mu1 - mu2) * n) / us; /* slope of the strength over the slip */
    for (int k = 0; k < 4000; k++) {
        move(t, -3e-6, 1e-8, 0.0);
        assert_true(fabs(across(t) - before) <= kt / (kt / slope - 1.0) * 1e-8 * (1.0 + 1e-6));
        before = across(t);
        largest = fmax(largest, before);
    }
    assert_near(largest, cohesion + mu1 * n, kt * 1e-8);
    assert_near(before, mu2 * n, 1e-9);
    assert_int_equal(t->k.cause[0], GN_BROKEN_SHEAR);
    end(t);
}

/* --- pressure --- */

static const gn_material crushed = {.normal_stiffness = 1e7,
                                    .kratio = 2.5,
                                    .friction = 0.3,
                                    .bond_tension_limit = 20.0,
                                    .bond_shear_limit = 12.0,
                                    .fracture_energy = 15.0,
                                    .yield_stress = {15e6, 25e6, 30e6},
                                    .yield_ratio = {3.0, 7.0, 15.0}};

/* N, at the path c (m) from the start: k, k/3, k/7, k/15 between 60, 100 and 120 N. */
static double line_at(double c) {
    const double kink[] = {60.0, 100.0, 120.0, INFINITY}, ratio[] = {1.0, 3.0, 7.0, 15.0};
    double force = 0.0, at = 0.0;
    for (int k = 0; k < 4; k++) {
        double width = (kink[k] - force) * ratio[k] / kn;
        if (c <= at + width) return force + (c - at) * kn / ratio[k];
        at += width;
        force = kink[k];
    }
    return force;
}

/* The oracle does not depend on the form of the kernel: the state is the largest compression so
 * far. */
static void random_presses_follow_the_three_slopes(void **state) {
    (void)state;
    uint64_t at = 23;
    for (int path = 0; path < 1000; path++) {
        bond *t = make(&crushed, GN_FX_YIELD);
        double most = 0.0;
        for (int k = 0; k < 40; k++) {
            move(t, -uniform(&at, 0.0, 1e-6 + 1.5e-6 * k), 0.0, 0.0);
            most = fmax(most, -t->u);
            double top = line_at(most), rest = most - top / kn;
            double want = -kn * (-t->u - rest);
            if (want < 1.0) assert_near(t->force[0], want, force_rounding);
            assert_near(t->k.plastic[0], -rest, 1e-17);
            assert_true(t->sums.plasticity >= -energy_rounding);
            if (want > 0.0) break; /* the bond is pulled */
        }
        end(t);
    }
}

/* Tension counts from the permanent stretch; plastic work is the area between the loading line and
 * the unloading line. */
static void pressing_leaves_a_permanent_stretch(void **state) {
    (void)state;
    bond *t = make(&crushed, GN_FX_YIELD);
    const double kinks[] = {6e-6, 18e-6, 32e-6, 50e-6};
    double area_under = 0.0, last = 0.0, force = 0.0;
    for (int k = 0; k < 4; k++) {
        move(t, -kinks[k], 0.0, 0.0);
        area_under += 0.5 * (force + line_at(kinks[k])) * (kinks[k] - last);
        force = line_at(kinks[k]);
        last = kinks[k];
        assert_near(t->force[0], -force, force_rounding);
    }
    double rest = kinks[3] - force / kn;
    move(t, -rest, 0.0, 0.0);
    assert_near(t->force[0], 0.0, force_rounding);
    assert_near(t->plasticity, area_under - 0.5 * force * force / kn, 1e-12 * area_under);
    assert_near(t->lost, t->plasticity, 1e-18);
    move(t, -rest + 1.5e-6, 0.0, 0.0);
    assert_near(t->force[0], 15.0, force_rounding);
    move(t, -rest + 4e-6, 0.0, 0.0);
    assert_near(t->force[0], 10.0, force_rounding);
    end(t);
}

/* --- energy ledger --- */

/* All modes at once, in steps of all sizes: work is stored or lost up to rounding, except for the
 * steps in which the compressive part of a damaged bond closes or opens, whose error is small. */
static void work_is_stored_or_lost(void **state) {
    (void)state;
    gn_material both = concrete;
    memcpy(both.yield_stress, crushed.yield_stress, sizeof both.yield_stress);
    memcpy(both.yield_ratio, crushed.yield_ratio, sizeof both.yield_ratio);
    uint64_t at = 41;
    for (int path = 0; path < 1000; path++) {
        bond *t = make(&both, GN_FX_YIELD);
        double u = 0.0;
        for (int k = 0; k < 60; k++) {
            double to = uniform(&at, -12e-6, 4e-6), stop = t->k.plastic[0];
            if ((to - stop) * (u - stop) < 0.0)
                to = stop; /* a step does not lead past the point of zero force */
            if (k % 2)
                move(t, to, 0.0, 0.0);
            else
                move(t, u, uniform(&at, -2e-6, 2e-6), uniform(&at, -2e-6, 2e-6));
            u = t->u;
            if (t->k.cause[0]) break;
            double stored = t->sums.elastic_normal + t->sums.elastic_shear;
            assert_near(t->work, stored + t->lost, 1e-11 * (1e-6 + t->lost + stored));
        }
        end(t);
    }
}

/* --- parameters and readings of a bond --- */

/* The bond is pulled (sheared) to just below the end of softening and just beyond it. */
static void check_end(const gn_material *m, gn_softening softening, bool sheared, double at_end) {
    bond *t = make(m, 0);
    set_again(t, softening);
    for (int k = 1; k <= 100; k++)
        move(t, sheared ? 0.0 : at_end * k / 100.1, sheared ? at_end / 100.1 : 0.0, 0.0);
    assert_int_equal(t->k.cause[0], GN_INTACT);
    move(t, sheared ? 0.0 : at_end * 1.001, sheared ? at_end * 0.002 : 0.0, 0.0);
    assert_int_equal(t->k.cause[0], sheared ? GN_BROKEN_SHEAR : GN_BROKEN_TENSION);
    end(t);
}

static void softening_ends_by_energy_strain_or_ratio(void **state) {
    (void)state;
    gn_material m = concrete;
    m.fracture_strain = 4e-3;       /* 4e-3 of 2 mm: 8 um */
    m.shear_fracture_strain = 6e-3; /* 6e-3 of the root of the area, 2 mm: 12 um */
    m.fracture_ratio = 1.5;
    check_end(&m, GN_SOFTENING_ENERGY, false, 6e-6);
    check_end(&m, GN_SOFTENING_ENERGY, true, 9e-6);
    check_end(&m, GN_SOFTENING_STRAIN, false, 8e-6);
    check_end(&m, GN_SOFTENING_STRAIN, true, 12e-6);
    check_end(&m, GN_SOFTENING_RATIO, false, 2.5 * 2e-6);
    check_end(&m, GN_SOFTENING_RATIO, true, 2.5 * 3e-6);
}

/* Without softening the law breaks bonds in one step, at R_n and C + mu_1 N. */
static void without_softening_bonds_that_yield_are_brittle(void **state) {
    (void)state;
    gn_material m = crushed;
    m.bond_friction = 0.8;
    bond *t = make(&m, GN_FX_YIELD);
    set_again(t, GN_SOFTENING_NONE);
    move(t, 1.9999e-6, 0.0, 0.0);
    assert_near(t->force[0], 19.999, 1e-9);
    move(t, 2.0001e-6, 0.0, 0.0);
    assert_int_equal(t->k.cause[0], GN_BROKEN_TENSION);
    end(t);
    t = make(&m, GN_FX_YIELD);
    set_again(t, GN_SOFTENING_NONE);
    move(t, -5e-6, 0.0, 0.0);
    for (int k = 0; k < 1299; k++) move(t, -5e-6, 1e-8, 0.0);
    assert_int_equal(t->k.cause[0], GN_INTACT); /* 51.96 N of 52 N */
    for (int k = 0; k < 2; k++) move(t, -5e-6, 1e-8, 0.0);
    assert_int_equal(t->k.cause[0], GN_BROKEN_SHEAR);
    assert_near(across(t), 0.3 * 50.0, 1e-9);
    end(t);
}

static void linear_coupling_takes_from_the_surface_in_tension(void **state) {
    (void)state;
    bond *t = make(&concrete, GN_FX_COUPLED_LINEAR);
    move(t, 1e-6, 0.0, 0.0);
    for (int k = 0; k < 100; k++) move(t, 1e-6, 1e-8, 0.0);
    assert_near(across(t), 4.0, 1e-9); /* C - mu_1 f_n = 12 N - 0.8 x 10 N */
    assert_near(t->k.kappa[0], 0.0, 1e-9);
    move(t, 1e-6, 1e-7, 0.0);
    double slope = (cohesion + (mu1 - mu2) * -10.0) / us;
    assert_near(t->k.kappa[0], kt * 1e-7 / (kt - slope) / us, 1e-9);
    end(t);
}

static void the_damage_of_a_bond_is_reported(void **state) {
    (void)state;
    bond *t = make(&crushed, GN_FX_YIELD);
    move(t, -18e-6, 0.0, 0.0);
    gn_bond_condition is = gn_softening_condition(&t->k, 0);
    assert_near(is.permanent, -8e-6, 1e-15);
    assert_true(is.tension == 0.0 && is.shear == 0.0);
    move(t, -8e-6, 0.0, 0.0);
    move(t, -4e-6, 0.0, 0.0);
    is = gn_softening_condition(&t->k, 0);
    assert_near(is.tension, 0.75, 1e-9); /* u_f (u - u_l)/(u (u_f - u_l)) at 4 um */
    assert_near(gn_law_softening.criterion(&t->k, 0, t->force[0], 0.0, 0.0), 4.0 / 6.0, 1e-9);
    end(t);
}

/* --- scenes --- */

/* A bar of a cubic lattice, one end held, the other pulled: all bonds along it are cut at a right
 * angle, and their areas (2 r)^2 add up to the section. */
static double dissipated_by_bar(int across_bar, double r, const char *precision,
                                const char *curve) {
    int layers = 6;
    gn_world *w = world_of(
        "dimension: 3\n"
        "specimen: {lattice: {kind: cubic, radius: %g, cells: [%d, %d, %d]}}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, tensile_strength: "
        "1e6, shear_strength: 1e6, fracture_energy: 20}]\n"
        "law: {stiffness: arithmetic, softening: energy, softening_curve: %s}\n"
        "bonds: {interaction_range: 0.05}\n"
        "damping: {background: {model: viscous, coefficient: 3e4}}\n"
        "sets:\n"
        "  - {name: low, select: {end: {axis: x, side: lower, depth: %g}}, motion: {vx: 0}}\n"
        "  - {name: high, select: {end: {axis: x, side: upper, depth: %g}}, motion: {vx: 0.02}}\n"
        "time: {end: 1}\nrun: {threads: 1, precision: %s}\n",
        r, layers, across_bar, across_bar, curve, 1.1 * r, 1.1 * r, precision);
    int64_t bonds = (int64_t)across_bar * across_bar;
    for (int k = 0; k < 40 && w->dem.broken_tension < bonds; k++) run_steps(w, 400);
    assert_int_equal(w->dem.broken_tension, bonds);
    run_steps(w, 400);
    gn_energy e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-3);
    world_end(w);
    double section = across_bar * 2.0 * r * across_bar * 2.0 * r;
    return (e.damage + e.bond_breaking) / (20.0 * section);
}

static void a_bar_dissipates_its_fracture_energy_whatever_the_size_of_its_particles(void **state) {
    (void)state;
    for (int half = 0; half < 3; half++) {
        double share = dissipated_by_bar(2 << half, 1e-3 / (1 << half), "double", "linear");
        print_message("# radius 1 mm/%d: %.4f of the fracture energy of the section\n", 1 << half,
                      share);
        assert_near(share, 1.0, 0.03);
    }
    double whole = dissipated_by_bar(2, 1e-3, "double", "linear");
    assert_near(dissipated_by_bar(2, 1e-3, "mixed", "linear"), whole, 1e-3);
    assert_near(dissipated_by_bar(2, 1e-3, "double", "bilinear"), 1.0, 0.03);
}

/* The damaged bond oscillates undamped through 0, stiffer in compression: 700 periods of 30 steps
 * each. The fraction of a step for which its compressive part acts is accurate to a high order of
 * the step: half the step gives a thirtieth of the residual. */
static void a_damaged_bond_keeps_its_energy_while_it_swings(void **state) {
    (void)state;
    const double mass = sphere_mass(2650, 1e-3), speed = 5e-6 * sqrt(1e7 / mass);
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 2650, normal_stiffness: 1e7, kratio: 2, "
                 "bond_tension_limit: 20, bond_shear_limit: 12, fracture_energy: 300}]\n"
                 "law: {stiffness: uniform, softening: energy}\nbonds: {}\n"
                 "sets:\n  - {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
                 "  - {name: thrown, select: {ids: [1]}, initial_velocity: [%.17g, 0, 0]}\n"
                 "time: {end: 10, safety: 0.2}\nrun: {threads: 1}\n",
                 speed);
    run_steps(w, 60);
    gn_energy first = measured_step(w);
    run_steps(w, 20000);
    gn_energy last = measured_step(w);
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
    assert_true(1.0 - w->dem.bonds.contacts.soft[0] > 0.3 && first.damage > 0.0);
    assert_near(last.damage, first.damage, 1e-3 * first.damage);
    assert_true(fabs(gn_energy_residual(&last)) < 2e-4);
    world_end(w);
}

/* A lattice that swings until most of its bonds are damaged, each of which opens and closes like a
 * contact. Undamped a bond lasts half the steps of one, or the ledger misses 2 to 5 %; with
 * dashpots the step is that of stability. */
static void damaged_bodies_that_swing_on_keep_their_energy(void **state) {
    (void)state;
    for (int damped = 0; damped < 2; damped++) {
        gn_world *w = world_of(
            "dimension: 2\nspecimen: {lattice: {kind: square, radius: 1e-3, cells: [8, 8]}}\n"
            "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 3, friction: 0.4, "
            "tensile_strength: 1e6, shear_strength: 1e6, fracture_energy: 20, "
            "shear_fracture_energy: 20}]\n"
            "law: {stiffness: harmonic, softening: energy}\nbonds: {interaction_range: 0.05}\n"
            "initial: {random_velocity: 0.8}\n"
            "damping: {contact: {restitution: %g}}\ntime: {end: 1}\nrun: {threads: 1, seed: 5}\n",
            damped ? 0.5 : 1.0);
        double frequency = sqrt(2.0 * w->dem.bonds.contacts.kn[0] * w->dem.particles.vel[3]);
        run_steps(w, 1000);
        gn_energy e = measured_step(w);
        double steps = pi / (frequency * w->ctx.dt), damaged = 0.0;
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++)
            damaged += w->dem.bonds.contacts.soft[c] < 0.9;
        print_message("# damped %d: %.2f steps, residual %.1e, %.0f of %zu damaged\n", damped,
                      steps, gn_energy_residual(&e), damaged, w->dem.bonds.contacts.soa.count);
        assert_true(damped ? steps < 4.0 : steps >= 5.0 - 1e-9);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-2);
        assert_true(damped || damaged > 30.0);
        world_end(w);
    }
}

/* Two spheres with a bond broken at the start collide undamped and yield, mostly in the very step
 * in which they come into contact: at 20 phases within a step. Their loss of energy is that of
 * yielding. */
static void yielding_on_closure_is_in_the_ledger(void **state) {
    (void)state;
    const double mass = sphere_mass(2650, 1e-3), w2 = 2.0 * 1e7 / mass;
    double worst = 0.0;
    for (int k = 0; k < 60; k++) {
        double step = (k / 20 == 0 ? 0.1 : k / 20 == 1 ? 0.25 : 0.5) / sqrt(w2), speed = 0.5;
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [%.17g, 0, 0, 1e-3]]}\n"
            "materials: [{name: m, density: 2650, normal_stiffness: 1e7, kratio: 2, "
            "bond_tension_limit: 1e-6, bond_shear_limit: 1, yield_stress_1: 5e4, yield_ratio_1: 3, "
            "yield_stress_2: 2e5, yield_ratio_2: 8}]\n"
            "law: {stiffness: uniform}\nbonds: {passive_gaps: false, interaction_range: 0.01}\n"
            "sets: [{name: thrown, select: {ids: [1]}, initial_velocity: [%.17g, 0, 0]}]\n"
            "time: {end: 1, step: %.17g, on_unstable: warn}\nrun: {threads: 1, precision: %s}\n",
            2e-3 + speed * step * (3.0 + k % 20 / 20.0), -speed, step, k % 2 ? "mixed" : "double");
        double start = 0.5 * mass * speed * speed;
        run_steps(w, 80);
        gn_energy e = measured_step(w);
        assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_TENSION);
        assert_true(e.plasticity > 0.1 * start && e.plasticity < 0.5 * start);
        assert_near(e.elastic_normal, 0.0, 0.0);
        double off =
            fabs(gn_energy_stored(&e) - e.stored_at_start + e.bond_breaking + e.plasticity);
        worst = fmax(worst, off / start / (step * step * w2));
        world_end(w);
    }
    print_message("# off by %.3f of the energy times the square of the step\n", worst);
    assert_true(worst < 0.05);
}

/* A scene with all features that the law allows. */
static const char *const busy =
    "dimension: %d\n"
    "specimen: {lattice: {kind: %s, radius: 1e-3, cells: [4, 4, 5], spacing: 0.99, jitter: 0.02},"
    " material: a}\n"
    "materials:\n"
    "  - {name: a, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 1e6, shear_strength: 1e6, bond_friction: 0.9, fracture_energy: 20, "
    "shear_fracture_energy: 30, yield_stress_1: 1 MPa, yield_ratio_1: 3, yield_stress_2: 2 MPa, "
    "yield_ratio_2: 7}\n"
    "  - {name: b, density: 2650, contact_modulus: 2e9, kratio: 3, friction: 0.3, "
    "tensile_strength: 2e6, shear_strength: 1e6, bond_friction: 0.2, fracture_energy: 10}\n"
    "law: {stiffness: harmonic, coupling: %s, confinement: %s, softening: energy, softening_curve: "
    "%s}\n"
    "bonds: {interaction_range: 0.05}\n"
    "damping: {contact: {restitution: 0.8}, background: {model: viscous, coefficient: 100}}\n"
    "gravity: [0, -9.81, 0]\n"
    "periodic: {min: [0, -1%s], max: [1.12e-2, 1%s]}\n"
    "sets:\n"
    "  - {name: some, select: {ids: [3, 14, 15, 16, 20]}, material: b}\n"
    "walls:\n"
    "  - {name: low, point: [0, -1e-3, 0], normal: [0, 1, 0], stiffness: 1e6, kratio: 2, "
    "friction: 0.4, motion: {vy: 4}}\n"
    "  - {name: high, point: [0, 12e-3, 0], normal: [0, -1, 0], stiffness: 1e6, motion: {vy: -4}}\n"
    "time: {end: 1}\noutput: {orientation: on}\nrun: {threads: %d, precision: %s}\n";

static gn_run *busy_run(int dimension, int threads, const char *precision, bool together) {
    return run_of(busy, dimension, dimension == 3 ? "fcc" : "hexagonal",
                  together ? "quadratic" : "linear", together && dimension == 3 ? "mean" : "own",
                  dimension == 3 ? "bilinear" : "linear", dimension == 3 ? ", -1" : "",
                  dimension == 3 ? ", 1" : "", threads, precision);
}

static void beside_all_else_threads_and_resumption_give_the_same_bits(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        const char *precision = k % 2 ? "mixed" : "double";
        int dimension = 2 + k / 2 % 2;
        gn_run *a = busy_run(dimension, 1, precision, k / 4);
        gn_run *b = busy_run(dimension, 2, precision, k / 4);
        gn_energy e = end_alike(a, b, k < 4 ? 300 : 600, 200, 1e-2);
        assert_true(e.damage > 0.0 && e.plasticity > 0.0);
    }
}

static void bonds_that_store_more_than_they_may_dissipate_cause_a_warning(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [0, 3e-3, 0, "
        "2e-3]]}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, tensile_strength: "
        "1e6, shear_strength: 1e6, fracture_energy: 1.2}]\n"
        "law: {stiffness: arithmetic, softening: energy}\nbonds: {}\ntime: {end: 1}\n");
    /* u_l = 2 r sigma/E: 2 um and, between radii of 1 and 2 mm, 3 um; u_f = 2 G_f/sigma = 2.4 um.
     */
    assert_int_equal(w->dem.bonds.contacts.soa.count, 2);
    assert_int_equal(gn_softening_too_long(&w->dem.bonds.contacts), 1);
    world_end(w);
}

/* R_n u_f/2 is G_f times the section of the bond: also by area, and whatever was drawn for the
 * bond. */
static void sections_are_those_of_the_law(void **state) {
    (void)state;
    const char *laws[] = {"stiffness: dempack, gamma: 0.7", "stiffness: arithmetic"};
    const char *drawn[] = {"", ", strength_scatter: {distribution: weibull, modulus: 5}"};
    const double harmonic = 2.0 * 1e-3 * 2e-3 / 3e-3,
                 section[] = {0.7 * M_PI * harmonic * harmonic, 4.0 * 1.5e-3 * 1.5e-3};
    for (int k = 0; k < 4; k++) {
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [3e-3, 0, 0, 2e-3]]}\n"
            "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, young: 1e9, "
            "poisson: 0.2, tensile_strength: 1e6, shear_strength: 1e6, fracture_energy: 30%s}]\n"
            "law: {%s, softening: energy}\nbonds: {}\ntime: {end: 1}\n",
            drawn[k / 2], laws[k % 2]);
        const gn_contacts *b = &w->dem.bonds.contacts;
        double end = b->fade[GN_FADE_END * b->soa.capacity];
        assert_float_equal(0.5 * b->rn[0] * end / (30.0 * section[k % 2]), 1.0, 1e-13);
        assert_true((b->rn[0] == 1e6 * section[k % 2]) == (k < 2));
        world_end(w);
    }
}

/* A periodic lattice whose sections fill it: a plane of any direction cuts 3/2 of its own area in
 * bonds on average, 4/pi in 2D; 2 mm of disc or (2 mm)^2 of a cube's face each. */
static void a_fracture_energy_of_the_body_is_shared_out_by_the_area_that_planes_cut(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++)
        for (int body = 0; body < 2; body++) {
            gn_world *w = world_of(
                "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: %s}}\n"
                "materials: [{name: m, density: 2650, young: 1e9, poisson: 0.2, tensile_strength: "
                "1e6, shear_strength: 1e6, fracture_energy: 30, shear_fracture_energy: 60}]\n"
                "law: {stiffness: polyhedron, softening: energy, fracture_energy_of: %s}\nbonds: "
                "{}\n"
                "periodic: {min: [0, 0%s], max: [10e-3, 10e-3%s]}\ntime: {end: 1}\n",
                2 + space, space ? "cubic" : "square", space ? "[5, 5, 5]" : "[5, 5]",
                body ? "body" : "contact", space ? ", 0" : "", space ? ", 10e-3" : "");
            const gn_contacts *b = &w->dem.bonds.contacts;
            const size_t stride = b->soa.capacity;
            double cut = space ? 1.5 : 4.0 / pi, share = body ? 1.0 / cut : 1.0;
            assert_float_equal(gn_law_cut(&w->ctx, &w->dem), cut, 1e-12);
            assert_float_equal(b->fade[GN_FADE_END * stride], 2.0 * 30.0 / 1e6 * share, 1e-16);
            assert_float_equal(b->fade[GN_FADE_SLIP * stride], 2.0 * 60.0 / 1e6 * share, 1e-16);
            world_end(w);
        }
}

static void a_pair_of_materials_has_a_fracture_energy_of_its_own(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, tensile_strength: "
        "1e6, shear_strength: 1e6, fracture_energy: 30}]\n"
        "contacts: [{between: m, fracture_energy: 70, shear_fracture_energy: 90}]\n"
        "law: {stiffness: arithmetic, softening: energy}\nbonds: {}\ntime: {end: 1}\n");
    const gn_contacts *b = &w->dem.bonds.contacts;
    assert_float_equal(b->fade[GN_FADE_END * b->soa.capacity], 2.0 * 70.0 / 1e6, 1e-18);
    assert_float_equal(b->fade[GN_FADE_SLIP * b->soa.capacity], 2.0 * 90.0 / 1e6, 1e-18);
    world_end(w);
}

/* --- coupled by squares --- */

/* Each component alone equals the softening of uncoupled bonds. */
static void coupled_by_squares_either_alone_softens_as_uncoupled(void **state) {
    (void)state;
    for (int sheared = 0; sheared < 2; sheared++) {
        bond *one = make(&concrete, 0), *both = make(&concrete, GN_FX_COUPLED_QUADRATIC);
        uint64_t at = 3;
        for (int k = 0; k < 80; k++) {
            double to = uniform(&at, 0.0, 1e-6 + 1e-7 * k), side = uniform(&at, -1e-6, 2e-6);
            move(one, sheared ? 0.0 : to, sheared ? side : 0.0, 0.0);
            move(both, sheared ? 0.0 : to, sheared ? side : 0.0, 0.0);
            assert_int_equal(one->k.cause[0], both->k.cause[0]);
            if (one->k.cause[0]) break;
            for (int a = 0; a < 2; a++) assert_near(both->force[a], one->force[a], 1e-10);
            assert_near(both->lost, one->lost, 1e-12 * one->lost + 1e-17);
        }
        assert_int_equal(both->k.cause[0], sheared ? GN_BROKEN_SHEAR : GN_BROKEN_TENSION);
        end(one);
        end(both);
    }
}

static pure begin_pure(void) {
    bond *t = make(&concrete, GN_FX_COUPLED_QUADRATIC);
    pure p = {.b = gn_softening_bond_of(&t->k, 0)};
    end(t);
    return p;
}

/* The bond opens and slips along a straight line from the ellipse to (a u_f, b u_s): the forces
 * keep their ratio and fall linearly with the path, so that a^2 G_n + b^2 G_t is dissipated,
 * whatever the steps. */
static void a_fixed_mix_of_both_dissipates_its_share_of_both_energies(void **state) {
    (void)state;
    for (int k = 1; k < 12; k++) {
        double a = sin(0.125 * k), b = cos(0.125 * k),
               made = 0.5 * (rn * a * a * uf + cohesion * b * b * us);
        double from[2] = {a * rn / kn, b * cohesion / kt}, to[2] = {a * uf, b * us};
        for (int steps = 1; steps <= 1000; steps *= 10) {
            pure p = begin_pure();
            const double nearly = 1.0 - 1e-6;
            go(&p, from[0], from[1]);
            for (int n = 1; n <= steps; n++) {
                double share = nearly * n / steps;
                go(&p, from[0] + share * (to[0] - from[0]), nearly / steps * (to[1] - from[1]));
                assert_near(p.f, a * rn * (1.0 - share), 1e-11);
                assert_near(p.t, b * cohesion * (1.0 - share), 1e-11);
                assert_near(p.b.kappa, share, 1e-12);
            }
            const double beyond = 1.0 + 1e-9;
            go(&p, from[0] + beyond * (to[0] - from[0]), (beyond - nearly) * (to[1] - from[1]));
            assert_int_equal(p.cause, a > b ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR);
            assert_near(p.work, made, 1e-10 * made);
        }
    }
}

/* Fractions of both strengths that remain after kappa has grown from `from` to `to`, with the
 * stretch u and the trial force across: openings and slips are a u_f and b u_s a kappa. */
static double shares2(double from, double to, double u, double across_trial) {
    double a = kn * u / (rn + (kn * uf - rn) * to);
    double b = across_trial / ((1.0 - to) * cohesion + kt * us * (to - from));
    return a * a + b * b;
}

/* 1000 random paths, opening and slipping at the same time, back and forth, in part under
 * compression: kappa by bisection, the forces from it. */
static void random_paths_coupled_by_squares_follow_the_ellipse(void **state) {
    (void)state;
    uint64_t at = 29;
    size_t together = 0, pressed = 0, broken = 0;
    for (int path = 0; path < 1000; path++) {
        pure p = begin_pure();
        double kappa = 0.0, t = 0.0;
        for (int k = 0; k < 60 && !p.cause; k++) {
            double u = uniform(&at, path % 3 ? 0.0 : -3e-6, 1e-6 + 1e-7 * k);
            double slip = uniform(&at, -1e-6, 1.5e-6), trial = t + kt * slip, before = kappa;
            go(&p, u, slip);
            bool breaks = false;
            if (u <= 0.0) {
                t = copysign(slipped(fabs(trial), -kn * u, 0.0, &kappa), trial);
                breaks = kappa >= 1.0;
            } else if (shares2(kappa, kappa, u, trial) >= 1.0) {
                double low = kappa, high = 1.0;
                breaks = shares2(kappa, 1.0, u, trial) >= 1.0;
                for (int turn = 0; turn < 200 && !breaks; turn++) {
                    kappa = 0.5 * (low + high);
                    *(shares2(before, kappa, u, trial) >= 1.0 ? &low : &high) = kappa;
                }
                double left = cohesion * (1.0 - kappa);
                t = trial * left / (left + kt * us * (kappa - before));
            } else {
                t = trial;
            }
            assert_int_equal(p.cause != GN_INTACT, breaks);
            broken += breaks;
            if (breaks) break;
            double f = kn * u;
            if (u > 0.0) f *= (1.0 - kappa) / (1.0 + (kn * uf / rn - 1.0) * kappa);
            assert_near(p.b.kappa, kappa, 1e-12);
            assert_near(p.f, f, 1e-11 * (1.0 + fabs(f)));
            assert_near(p.t, t, 1e-11 * (1.0 + fabs(trial)));
            together += u > 0.0 && kappa > before;
            pressed += u <= 0.0 && kappa > before;
        }
    }
    assert_true(together > 5000 && pressed > 300 && broken > 300);
}

/* For any path in tension and compression the state is never outside the remaining ellipse, and
 * dissipated energy is never recovered except where a step leads from compression past the strength
 * or reverses a force. Damage in shear is damage in tension. */
static void coupled_by_squares_forces_stay_within_what_is_left(void **state) {
    (void)state;
    uint64_t at = 29;
    size_t softened = 0, steps = 0;
    for (int path = 0; path < 1000; path++) {
        pure p = begin_pure();
        double lost = 0.0;
        for (int k = 0; k < 60; k++) {
            double to = uniform(&at, -2e-6, 3e-6), slip = uniform(&at, -1e-6, 1.5e-6);
            bool onward = p.t * (p.t + kt * slip) >= 0.0;
            if (to * p.u < 0.0) to = 0.0; /* a step does not lead past the point of zero force */
            go(&p, to, slip);
            if (p.cause) break;
            double left = 1.0 - p.b.kappa, friction = left * mu1 + p.b.kappa * mu2;
            double pull = fmax(0.0, p.f) / (left * rn);
            double push = fabs(p.t) / (left * cohesion + friction * fmax(0.0, -p.f));
            assert_true(hypot(pull, push) <= 1.0 + 1e-12);
            assert_near(p.b.rn, left * rn, 1e-12 * rn);
            assert_near(p.b.rt, left * cohesion, 1e-12 * cohesion);
            assert_near(p.b.soft, left / (1.0 + 2.0 * p.b.kappa), 1e-12);
            double now = p.work - 0.5 * p.f * p.u - 0.5 * p.t * p.t / kt;
            if (onward) assert_true(now >= lost - energy_rounding);
            lost = now;
            softened += left < 1.0;
            steps++;
        }
    }
    assert_true(steps > 5000 && softened > 2000);
}

/* --- the cause of a break --- */

/* A straight path from zero until the bond breaks: opening and slip per unit of it, each relative
 * to its own value at failure (u_f and u_s, brittle R_n/k_n and C/k_t), or slip under compression.
 * */
typedef struct way_to_break {
    gn_effects coupling;
    double tension_energy, shear_energy; /* J/m2; 0: brittle */
    double friction, along, across, pressed;
    gn_cause cause;
} way_to_break;

static const way_to_break ways_to_break[] = {
    /* Uncoupled: the component that fails first is the cause. */
    {0, 15, 13.5, 0.8, 1.0, 0.0, 0.0, GN_BROKEN_TENSION},
    {0, 15, 13.5, 0.8, 0.0, 1.0, 0.0, GN_BROKEN_SHEAR},
    {0, 15, 13.5, 0.8, 1.0, 0.5, 0.0, GN_BROKEN_TENSION},
    {0, 15, 13.5, 0.8, 0.5, 1.0, 0.0, GN_BROKEN_SHEAR},
    {0, 15, 13.5, 0.8, 0.0, 1.0, 2e-6, GN_BROKEN_SHEAR},
    {0, 0, 0, 0.8, 1.0, 0.5, 0.0, GN_BROKEN_TENSION},
    {0, 0, 0, 0.8, 0.5, 1.0, 0.0, GN_BROKEN_SHEAR},
    {0, 0, 13.5, 0.8, 1.0, 0.3, 0.0, GN_BROKEN_TENSION},
    {0, 0, 13.5, 0.8, 0.3, 1.0, 0.0, GN_BROKEN_SHEAR},
    /* Softening in shear removes the cohesion, C (1 - x)/(2 x) at the part x of the way: 0.3 x C of
     * a brittle bond is reached at 0.70. */
    {0, 15, 0, 0.8, 1.0, 0.3, 0.0, GN_BROKEN_SHEAR},
    /* Linear: C - mu_1 f_n with mu_1 R_n = C/2. Brittle at x (across + along/2) = 1 or x along = 1;
     * with softening the remaining slip ends at u_s for any surface. */
    {GN_FX_COUPLED_LINEAR, 0, 0, 0.3, 3.0, 1.0, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_LINEAR, 0, 0, 0.3, 1.0, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_LINEAR, 15, 13.5, 0.3, 1.0, 0.0, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_LINEAR, 15, 13.5, 0.3, 1.0, 0.5, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_LINEAR, 15, 13.5, 0.3, 0.5, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_LINEAR, 15, 13.5, 0.3, 0.0, 1.0, 2e-6, GN_BROKEN_SHEAR},
    /* Coupled by squares: with u_f k_n/R_n = u_s k_t/C the shares keep their ratio all the way. */
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 1.0, 0.0, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 0.0, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 1.0, 0.2, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 1.0, 0.95, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 0.95, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 0.2, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_QUADRATIC, 15, 13.5, 0.8, 0.0, 1.0, 2e-6, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_QUADRATIC, 0, 0, 0.8, 1.0, 0.9, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 0, 0, 0.8, 0.9, 1.0, 0.0, GN_BROKEN_SHEAR},
    /* One component is brittle: at a third of the other's displacement at failure its share remains
     * the smaller one, sqrt(1 - x^2) at the end. */
    {GN_FX_COUPLED_QUADRATIC, 15, 0, 0.8, 1.0, 0.3, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 15, 0, 0.8, 0.1, 1.0, 0.0, GN_BROKEN_SHEAR},
    {GN_FX_COUPLED_QUADRATIC, 0, 13.5, 0.8, 1.0, 0.1, 0.0, GN_BROKEN_TENSION},
    {GN_FX_COUPLED_QUADRATIC, 0, 13.5, 0.8, 0.3, 1.0, 0.0, GN_BROKEN_SHEAR},
};

/* The steps have any size and end anywhere: the cause is determined by the whole path, however
 * small the remainder at the start of the last step. */
static void check_cause(const way_to_break *way, gn_effects softening, uint64_t *at) {
    gn_material m = concrete;
    m.bond_friction = way->friction;
    m.fracture_energy = way->tension_energy;
    m.shear_fracture_energy = way->shear_energy;
    const double pull = fmax(rn / kn, 2.0 * way->tension_energy * area / rn);
    const double slide = fmax(cohesion / kt, 2.0 * way->shear_energy * area / cohesion);
    for (int turn = 0; turn < 60; turn++) {
        double most = pow(10.0, uniform(at, -2.5, -0.7)), done = 0.0;
        bond *t = make_of(&m, softening | way->coupling);
        move(t, -way->pressed, 0.0, 0.0);
        while (!t->k.cause[0] && done < 20.0) {
            double step = most * uniform(at, 0.0, 1.0);
            done += step;
            move(t, way->pressed > 0.0 ? -way->pressed : done * way->along * pull,
                 step * way->across * slide, 0.0);
        }
        if (t->k.cause[0] != way->cause)
            fail_msg("way %d, steps to %g: cause %d at %.6f", (int)(way - ways_to_break), most,
                     t->k.cause[0], done);
        end(t);
    }
}

static void breaks_are_named_by_their_last_mode(void **state) {
    (void)state;
    uint64_t at = 37;
    for (size_t k = 0; k < sizeof ways_to_break / sizeof *ways_to_break; k++) {
        const way_to_break *way = ways_to_break + k;
        bool brittle = way->tension_energy == 0.0 && way->shear_energy == 0.0;
        check_cause(way, GN_FX_SOFTENING, &at);
        if (brittle) check_cause(way, 0, &at);
    }
}

static void bad_values_are_refused_at_their_place(void **state) {
    (void)state;
    static const struct {
        const char *material, *law, *says;
    } bad[] = {
        {"fracture_energy: -1", "", "materials[0].fracture_energy: expected"},
        {"fracture_energy: 5 N", "", "materials[0].fracture_energy: expected"},
        {"friction: 1", ", softening: energy",
         "fracture_energy: required by softening energy, but not given"},
        {"fracture_energy: 5", ", softening: strain",
         "fracture_strain: required by softening strain, but not given"},
        {"fracture_energy: 5", ", softening: ratio",
         "fracture_ratio: required by softening ratio, but not given"},
        {"fracture_ratio: 5", ", softening: ratio, fracture_energy_of: body",
         "law.fracture_energy_of: expected softening energy beside body"},
        {"fracture_ratio: 5", ", softening: ratio, softening_curve: bilinear",
         "law.softening_curve: expected softening energy beside bilinear"},
        {"fracture_energy: 5", ", softening: energy, kink_stress: 0.2",
         "law.kink_stress: needs softening_curve bilinear"},
        {"fracture_energy: 5", ", softening: energy, initial_energy: 0.5",
         "law.initial_energy: needs softening_curve bilinear"},
        {"fracture_energy: 5", ", softening: energy, softening_curve: bilinear, initial_energy: 1",
         "law.initial_energy: expected a value in [0.01, 0.99]"},
        {"friction: 1", ", softening: soft", "law.softening: expected one of none, energy"},
        {"yield_stress_1: 5e6", "", "yield_ratio_1: required beside its yield_stress"},
        {"yield_ratio_1: 5", "", "yield_stress_1: required beside its yield_ratio"},
        {"yield_stress_1: 5e6, yield_ratio_1: 0.5", "", "yield_ratio_1: expected a value in [1, "},
        {"yield_stress_1: 5e6, yield_ratio_1: 2, yield_stress_2: 4e6, yield_ratio_2: 3", "",
         "yield_stress_2: expected more than yield_stress_1, found 4e+06 Pa and 5e+06 Pa"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char words[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(words, sizeof words,
                 "specimen: {particles: [[0, 0, 0, 1e-3]]}\nbonds: {}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, "
                 "bond_tension_limit: 1, bond_shear_limit: 1, %s}]\n"
                 "law: {stiffness: uniform%s}\ntime: {end: 1}\n",
                 bad[k].material, bad[k].law);
        assert_int_equal(world_try(&w, words, NULL, &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, bad[k].says) || strncmp(error.message, "s.yaml:", 7) != 0)
            fail_msg("%s", error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(softening_in_tension_is_linear_and_unloads_on_the_secant),
        cmocka_unit_test(linear_softening_dissipates_the_fracture_energy),
        cmocka_unit_test(a_damaged_bond_closes_with_all_of_its_stiffness),
        cmocka_unit_test(random_pulls_follow_the_line),
        cmocka_unit_test(random_shear_follows_the_surface),
        cmocka_unit_test(softening_in_shear_dissipates_its_fracture_energy),
        cmocka_unit_test(under_pressure_shear_softens_to_friction),
        cmocka_unit_test(random_presses_follow_the_three_slopes),
        cmocka_unit_test(pressing_leaves_a_permanent_stretch),
        cmocka_unit_test(work_is_stored_or_lost),
        cmocka_unit_test(softening_ends_by_energy_strain_or_ratio),
        cmocka_unit_test(without_softening_bonds_that_yield_are_brittle),
        cmocka_unit_test(linear_coupling_takes_from_the_surface_in_tension),
        cmocka_unit_test(the_damage_of_a_bond_is_reported),
        cmocka_unit_test(a_bar_dissipates_its_fracture_energy_whatever_the_size_of_its_particles),
        cmocka_unit_test(a_damaged_bond_keeps_its_energy_while_it_swings),
        cmocka_unit_test(damaged_bodies_that_swing_on_keep_their_energy),
        cmocka_unit_test(yielding_on_closure_is_in_the_ledger),
        cmocka_unit_test(beside_all_else_threads_and_resumption_give_the_same_bits),
        cmocka_unit_test(bonds_that_store_more_than_they_may_dissipate_cause_a_warning),
        cmocka_unit_test(sections_are_those_of_the_law),
        cmocka_unit_test(a_pair_of_materials_has_a_fracture_energy_of_its_own),
        cmocka_unit_test(a_fracture_energy_of_the_body_is_shared_out_by_the_area_that_planes_cut),
        cmocka_unit_test(coupled_by_squares_either_alone_softens_as_uncoupled),
        cmocka_unit_test(a_fixed_mix_of_both_dissipates_its_share_of_both_energies),
        cmocka_unit_test(random_paths_coupled_by_squares_follow_the_ellipse),
        cmocka_unit_test(coupled_by_squares_forces_stay_within_what_is_left),
        cmocka_unit_test(breaks_are_named_by_their_last_mode),
        cmocka_unit_test(bad_values_are_refused_at_their_place),
    };
    return cmocka_run_group_tests_name("softening", tests, NULL, NULL);
}
