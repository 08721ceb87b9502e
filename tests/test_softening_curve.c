/* Bonds that soften along two lines (law.softening_curve: bilinear), compared with the published
 * curve over the opening and its dissipation. */
#include "softening_bond.h"

/* Petersson (1981): a third of the strength R is left at the opening 0.8 G/R, nothing at 3.6 G/R.
 * With G = 15 J/m2 and 13.5 J/m2 on 4e-6 m2 and strengths of 20 and 12 N. */
static const double opening[2] = {2.4e-6, 10.8e-6}, slip[2] = {3.6e-6, 16.2e-6};

static bond *make_bent(gn_effects more) {
    bond *t = make(&concrete, more);
    t->scene.softening_curve = GN_SOFTENING_BILINEAR;
    t->scene.kink_stress = 1.0 / 3.0;
    t->scene.initial_energy = 0.6;
    set_again(t, GN_SOFTENING_ENERGY);
    return t;
}

/* Returns the remaining strength at an opening w > 0. */
static double left_at(double w, const double at[2]) {
    if (w < at[0]) return 1.0 - 2.0 / 3.0 * w / at[0];
    return w < at[1] ? (at[1] - w) / (at[1] - at[0]) / 3.0 : 0.0;
}

/* The force of a bond at the largest stretch u so far: the stretch is the opening plus the elastic
 * stretch under the force, found by bisection. */
static double first_pull(double u) {
    if (u <= rn / kn) return kn * u;
    double low = 0.0, high = opening[1];
    for (int turn = 0; turn < 200; turn++) {
        double w = 0.5 * (low + high);
        *(w + rn * left_at(w, opening) / kn < u ? &low : &high) = w;
    }
    return rn * left_at(low, opening);
}

static double stretch_at(double w) {
    return w + rn * left_at(w, opening) / kn;
}

static void random_pulls_follow_both_lines(void **state) {
    (void)state;
    uint64_t at = 7;
    size_t steep = 0, flat = 0, broken = 0;
    for (int path = 0; path < 600; path++) {
        bond *t = make_bent(path % 2 ? GN_FX_COUPLED_QUADRATIC : 0);
        double most = 0.0;
        for (int k = 0; k < 80; k++) {
            double to = uniform(&at, -2e-6, 1e-6 + 1.6e-7 * k);
            move(t, to * t->u < 0.0 ? 0.0 : to, 0.0, 0.0);
            most = fmax(most, t->u);
            if (t->k.cause[0]) break;
            double force = t->u > 0.0 ? fmin(kn, first_pull(most) / most) * t->u : kn * t->u;
            assert_near(t->force[0], force, 10.0 * force_rounding);
            double stored = t->u * t->force[0] / 2.0;
            assert_near(t->work, stored + t->lost, 1e-12 * (stored + t->lost) + 1e-17);
            steep += most > rn / kn && most < stretch_at(opening[0]);
            flat += most > stretch_at(opening[0]);
        }
        assert_true((most < opening[1]) == (t->k.cause[0] == GN_INTACT));
        broken += t->k.cause[0] == GN_BROKEN_TENSION;
        end(t);
    }
    assert_true(steep > 1000 && flat > 5000 && broken > 300);
}

/* The steps end where the lines bend; both kinds of coupling are tested. */
static void both_lines_dissipate_the_fracture_energies(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        bond *t = make_bent(k / 2 ? GN_FX_COUPLED_QUADRATIC : 0);
        const double pulls[] = {rn / kn, stretch_at(opening[0]), opening[1] * 1.0000001};
        const double slips[] = {cohesion / kt, slip[0] - 2.0 / 3.0 * cohesion / kt,
                                (slip[1] - slip[0]) * 1.0000001 - 1.0 / 3.0 * cohesion / kt};
        for (int n = 0; n < 3; n++) move(t, k % 2 ? 0.0 : pulls[n], k % 2 ? slips[n] : 0.0, 0.0);
        assert_int_equal(t->k.cause[0], k % 2 ? GN_BROKEN_SHEAR : GN_BROKEN_TENSION);
        double made = (k % 2 ? 13.5 : 15.0) * area;
        assert_near(t->lost, made, 1e-6 * made);
        end(t);
    }
}

/* The bond opens and slips in a fixed ratio of the fractions of the strengths: the forces keep this
 * ratio, and a^2 G_n + b^2 G_t is dissipated, in any number of steps along each line. */
static void a_fixed_mix_dissipates_its_share_of_both_energies(void **state) {
    (void)state;
    for (int k = 1; k < 12; k++) {
        const double a = sin(0.125 * k), b = cos(0.125 * k);
        const double made = (a * a * 15.0 + b * b * 13.5) * area;
        for (int steps = 1; steps <= 100; steps *= 10) {
            bond *t = make_bent(GN_FX_COUPLED_QUADRATIC);
            pure p = {.b = gn_softening_bond_of(&t->k, 0)};
            end(t);
            go(&p, a * rn / kn, b * cohesion / kt);
            double lost = 0.0;
            for (int n = 1; n <= 2 * steps; n++) {
                double now = n <= steps
                                 ? 2.0 / 3.0 * n / steps
                                 : 2.0 / 3.0 + 1.0 / 3.0 * (1.0 - 1e-9) * (n - steps) / steps;
                double ends[2][2]; /* opening and slip before and after */
                for (int x = 0; x < 2; x++) {
                    double gone = x ? now : lost, first = fmin(gone, 2.0 / 3.0) * 1.5;
                    double second = fmax(gone - 2.0 / 3.0, 0.0) * 3.0;
                    ends[x][0] = opening[0] * first + (opening[1] - opening[0]) * second;
                    ends[x][1] = slip[0] * first + (slip[1] - slip[0]) * second;
                }
                go(&p, a * (ends[1][0] + rn * (1.0 - now) / kn),
                   b * (ends[1][1] - ends[0][1] - cohesion * (now - lost) / kt));
                lost = now;
                assert_int_equal(p.cause, GN_INTACT);
                assert_near(p.f, a * rn * (1.0 - now), 1e-9);
                assert_near(p.t, b * cohesion * (1.0 - now), 1e-9);
            }
            assert_near(p.work, made, 1e-7 * made);
        }
    }
}

/* A single step across the kink: the force is on the ellipse of the remaining strengths, no
 * dissipated energy is recovered, and the bond continues along the second line. */
static void steps_across_the_kink_stay_on_the_ellipse(void **state) {
    (void)state;
    uint64_t at = 23;
    size_t across = 0;
    for (int path = 0; path < 2000; path++) {
        bond *t = make_bent(GN_FX_COUPLED_QUADRATIC);
        pure p = {.b = gn_softening_bond_of(&t->k, 0)};
        end(t);
        for (int k = 0; k < 30 && !p.cause; k++) {
            double before = p.b.kappa;
            go(&p, uniform(&at, 0.0, 1e-6 + 3e-7 * k), uniform(&at, -2e-6, 3e-6));
            if (p.cause) break;
            double left = 1.0 - p.b.kappa, shares = hypot(p.f / rn, p.t / cohesion);
            assert_true(p.b.kappa >= before && shares <= left * (1.0 + 1e-11));
            if (p.b.kappa > before) assert_near(shares, left, 1e-10);
            across += before < 2.0 / 3.0 && p.b.kappa > 2.0 / 3.0;
        }
    }
    assert_true(across > 300);
}

/* Where the first line would have to lead back the bond breaks in one step, as along a single line.
 * */
static void a_bond_with_too_much_stored_energy_breaks_at_once(void **state) {
    (void)state;
    for (int quadratic = 0; quadratic < 2; quadratic++) {
        gn_material m = concrete;
        m.fracture_energy = 8.0; /* w_1 = 1.92 um of a limit of 2 um */
        bond *t = make(&m, quadratic ? GN_FX_COUPLED_QUADRATIC : 0);
        t->scene.softening_curve = GN_SOFTENING_BILINEAR;
        t->scene.kink_stress = 1.0 / 3.0;
        t->scene.initial_energy = 0.6;
        set_again(t, GN_SOFTENING_ENERGY);
        assert_int_equal(gn_softening_too_long(&t->k), 1);
        move(t, 1.99e-6, 0.0, 0.0);
        assert_int_equal(t->k.cause[0], GN_INTACT);
        move(t, 2.01e-6, 0.0, 0.0);
        assert_int_equal(t->k.cause[0], GN_BROKEN_TENSION);
        end(t);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_pulls_follow_both_lines),
        cmocka_unit_test(both_lines_dissipate_the_fracture_energies),
        cmocka_unit_test(a_fixed_mix_dissipates_its_share_of_both_energies),
        cmocka_unit_test(steps_across_the_kink_stay_on_the_ellipse),
        cmocka_unit_test(a_bond_with_too_much_stored_energy_breaks_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
