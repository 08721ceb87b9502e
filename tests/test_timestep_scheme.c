/* The predicted limit against the explicit scheme: steady just below, growing just above. */
#include "timestep_specimen.h"

static void bond_forces(const specimen *s, double dt, const double *v, double *elastic,
                        double *force) {
    memset(force, 0, s->p.soa.count * 6 * sizeof *force);
    for (size_t c = 0; c < s->bonds.soa.count; c++) {
        size_t i = (size_t)s->bonds.i[c], j = (size_t)s->bonds.j[c];
        double n[3], distance = separation(s, i, j, n), f[3], along = 0.0;
        double gap = distance - s->p.pos[4 * i + 3] - s->p.pos[4 * j + 3];
        double ai = s->p.pos[4 * i + 3] + 0.5 * gap, aj = s->p.pos[4 * j + 3] + 0.5 * gap;
        for (int k = 0; k < 3; k++) n[k] /= distance;
        const double *vi = v + 6 * i, *vj = v + 6 * j;
        double relative[3];
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            relative[k] = vj[k] - vi[k] -
                          ((ai * vi[3 + p] + aj * vj[3 + p]) * n[q] -
                           (ai * vi[3 + q] + aj * vj[3 + q]) * n[p]);
            along += relative[k] * n[k];
        }
        for (int k = 0; k < 3; k++) {
            elastic[3 * c + k] += dt * (s->bonds.kt[c] * (relative[k] - along * n[k]) +
                                        s->bonds.kn[c] * along * n[k]);
            f[k] = elastic[3 * c + k] + s->bonds.cn[c] * along * n[k];
        }
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            double moment = n[p] * f[q] - n[q] * f[p];
            force[6 * i + k] += f[k];
            force[6 * j + k] -= f[k];
            force[6 * i + 3 + k] += ai * moment;
            force[6 * j + 3 + k] += aj * moment;
        }
    }
}

/* Leap-frog of the linear system from random velocities. The largest kinetic energy in the second
 * half of the steps over that in the first half; INFINITY once it has grown beyond 1e30. */
static double growth(const specimen *s, double dt, int steps) {
    size_t count = s->p.soa.count;
    double *v = calloc(6 * count, sizeof *v), *force = calloc(6 * count, sizeof *force);
    double *elastic = calloc(3 * s->bonds.soa.count, sizeof *elastic), most[2] = {0.0, 0.0};
    srand(7);
    for (size_t k = 0; k < 6 * count; k++) {
        bool flat = s->assembly.dimension == 2 && (k % 6 == 2 || k % 6 == 3 || k % 6 == 4);
        v[k] = flat ? 0.0 : (rand() / (double)RAND_MAX - 0.5) * (k % 6 < 3 ? 1.0 : 1e3);
    }
    for (int step = 0; step < steps && most[1] < 1e30; step++) {
        double energy = 0.0;
        bond_forces(s, dt, v, elastic, force);
        for (size_t k = 0; k < 6 * count; k++) {
            double inverse = k % 6 < 3 ? s->p.vel[4 * (k / 6) + 3] : s->p.spin[4 * (k / 6) + 3];
            if (s->fixed[k / 6] >> (k % 6) & 1)
                v[k] = 0.0;
            else
                v[k] += dt * inverse * force[k];
            energy += 0.5 * v[k] * v[k] / inverse;
        }
        double *slot = &most[step >= steps / 2];
        *slot = fmax(*slot, energy);
        if (most[0] > 1e30) break;
    }
    free(v);
    free(force);
    free(elastic);
    return most[0] > 1e30 || most[1] > 1e30 ? INFINITY : most[1] / most[0];
}

/* The predicted limit separates steady from growing motion within a thousandth on either side. */
static void assert_separates(const specimen *s, int steps) {
    gn_step_limit limit = limits_of(s, 1e-6);
    double below = growth(s, 0.999 * limit.sharp, steps),
           above = growth(s, 1.001 * limit.sharp, steps);
    if (!(below < 1.5)) fail_msg("0.999 of the limit grows by %g", below);
    if (above < INFINITY) fail_msg("1.001 of the limit does not blow up: %g", above);
    assert_true(growth(s, 0.999 * limit.bound, steps) <
                1.5); /* the bound may be the limit itself */
}

static const double alphas[] = {0.0, 0.1, 0.9};

static void the_scheme_turns_unstable_at_the_limit_for_two_particles(void **state) {
    (void)state;
    for (int a = 0; a < 3; a++) {
        specimen *s = chain(2, 0.0, alphas[a], all_effects);
        double w = sqrt(2.0 * s->bonds.kn[0] * inverse_mass(s, 0));
        double step = 2.0 / w * (sqrt(1.0 + alphas[a] * alphas[a]) - alphas[a]);
        assert_close(limits_of(s, 1e-6).sharp, step, 1e-9);
        assert_separates(s, 20000);
        destroy(s);
    }
}

static void the_scheme_turns_unstable_at_the_limit_for_chains(void **state) {
    (void)state;
    for (int a = 0; a < 3; a++) {
        specimen *s = chain(20, 2.0, alphas[a], all_effects);
        s->fixed[0] = 0x3f;
        s->fixed[19] = 0x21;
        assert_separates(s, 20000);
        destroy(s);
    }
}

/* Here the damping and the stiffness do not commute. */
static void the_scheme_turns_unstable_at_the_limit_in_a_packing(void **state) {
    (void)state;
    for (int a = 0; a < 3; a++) {
        specimen *s = rock(0.0035, all_effects);
        bond(s, 0.05, 3.7, alphas[a]);
        assert_true(s->bonds.soa.count > s->p.soa.count);
        s->fixed[3] = 0x07;
        assert_separates(s, 20000);
        destroy(s);
    }
}

static void the_scheme_turns_unstable_at_the_limit_in_a_packing_of_discs(void **state) {
    (void)state;
    double x[4 * 49];
    srand(3);
    for (int i = 0; i < 49; i++) {
        x[4 * i] = 2e-3 * (i % 7) + 2e-4 * rand() / RAND_MAX;
        x[4 * i + 1] = 2e-3 * (i / 7) + 2e-4 * rand() / RAND_MAX;
        x[4 * i + 2] = 0.0;
        x[4 * i + 3] = 1e-3 * (0.8 + 0.3 * rand() / RAND_MAX);
    }
    for (int a = 0; a < 3; a++) {
        specimen *s = make(2, 49, x, all_effects);
        bond(s, 0.05, 2.0, alphas[a]);
        assert_true(s->bonds.soa.count > 20);
        assert_separates(s, 20000);
        destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_scheme_turns_unstable_at_the_limit_for_two_particles),
        cmocka_unit_test(the_scheme_turns_unstable_at_the_limit_for_chains),
        cmocka_unit_test(the_scheme_turns_unstable_at_the_limit_in_a_packing),
        cmocka_unit_test(the_scheme_turns_unstable_at_the_limit_in_a_packing_of_discs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
