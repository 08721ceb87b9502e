/* The stable step if most particles are dormant: no vector has an entry for every particle. */
#include "limit/springs.h"
#include "timestep_specimen.h"

/* Makes particles outside of two slabs dormant: without mass and springs. Returns the number of
 * active ones. */
static size_t lull(specimen *s, double low, double high) {
    size_t active = 0;
    for (size_t i = 0; i < s->p.soa.count; i++) {
        const double z = s->p.pos[4 * i + 2];
        if (fabs(z - low) < 1e-3 || fabs(z - high) < 1e-3) {
            active++;
            continue;
        }
        s->p.vel[4 * i + 3] = 0.0;
        if (s->p.spin) s->p.spin[4 * i + 3] = 0.0;
    }
    return active;
}

/* Computes the limit with vectors that have entries for all particles. */
static gn_step_limit full_limit(const specimen *s, double tolerance) {
    gn_springs all;
    gn_step_limit limit;
    assert_int_equal(gn_step_limits(&s->spectrum, 0.0, &limit, NULL), GNEISS_OK);
    assert_int_equal(gn_springs_build(&s->spectrum, NULL, &all, NULL), GNEISS_OK);
    double *mode = calloc(all.particles * (size_t)all.dofs, sizeof *mode);
    assert_int_equal(gn_springs_mode(&all, tolerance, mode, &limit, NULL), GNEISS_OK);
    gn_springs_free(&all);
    free(mode);
    return limit;
}

static int by_height(const void *a, const void *b) {
    const double x = ((const double *)a)[2], y = ((const double *)b)[2];
    return (x > y) - (x < y);
}

/* A specimen sorted in space, as in a run, so that active particles are together. */
static specimen *sleeping_rock(int k) {
    const double alphas[] = {0.0, 0.4}, kratios[] = {3.7, 0.0};
    specimen *any = rock(0.012, all_effects);
    qsort(any->p.pos, any->p.soa.count, 4 * sizeof *any->p.pos, by_height);
    specimen *s = make(3, any->p.soa.count, any->p.pos,
                       k < 2 ? all_effects : all_effects & ~(gn_effects)GN_FX_ROTATION);
    destroy(any);
    bond(s, 0.05, kratios[k / 2], alphas[k % 2]);
    for (size_t i = 0; i < s->p.soa.count; i += 7) s->fixed[i] = (uint8_t)(i % 64);
    s->fixed[70] = 63;
    const size_t active = lull(s, 3e-3, 8e-3);
    assert_true(active > 100 && 2 * active < s->p.soa.count);
    return s;
}

static void active_particles_have_the_limit_of_the_full_operator(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        specimen *s = sleeping_rock(k);
        const gn_step_limit all = full_limit(s, 1e-3), sharp = full_limit(s, 1e-8);
        for (int threads = 1; threads <= 3; threads++) {
            s->spectrum.threads = threads;
            const gn_step_limit active = limits_of(s, 1e-3);
            assert_int_equal(active.iterations, all.iterations);
            assert_int_equal(active.sharp_id, all.sharp_id);
            assert_true(active.sharp == all.sharp && active.sharp_low == all.sharp_low);
            assert_true(active.frequency == all.frequency);
            assert_true(sharp.sharp <= active.sharp * (1.0 + 1e-12));
            assert_close(active.sharp, sharp.sharp, 1e-3);
        }
        destroy(s);
    }
}

/* The operator of the active particles has their springs, and no others. */
static void selected_particles_keep_all_springs(void **state) {
    (void)state;
    specimen *s = sleeping_rock(0);
    gn_springs all, active;
    uint8_t *inside = calloc(s->p.soa.count, 1);
    size_t count = 0;
    for (size_t i = 0; i < s->p.soa.count; i++) count += inside[i] = inverse_mass(s, i) > 0.0;
    assert_int_equal(gn_springs_build(&s->spectrum, NULL, &all, NULL), GNEISS_OK);
    assert_int_equal(gn_springs_pick(&all, inside, &active, NULL), GNEISS_OK);
    assert_int_equal(active.particles, count);
    assert_int_equal(active.springs, all.springs);
    for (size_t k = 0; k < all.springs; k++) {
        assert_int_equal(gn_springs_place(&active, (size_t)active.spring[k].i), all.spring[k].i);
        assert_int_equal(gn_springs_place(&active, (size_t)active.spring[k].j), all.spring[k].j);
        assert_true(active.spring[k].kn == all.spring[k].kn);
    }
    gn_springs_free(&all);
    gn_springs_free(&active);
    free(inside);
    destroy(s);
}

static void a_step_without_end_holds_where_nothing_resists(void **state) {
    (void)state;
    gn_step_verdict v;
    specimen *s = chain(20, 3.7, 0.1, all_effects);
    uint8_t changed[20] = {0};
    for (int near = 0; near < 2; near++) {
        for (int p = 0; p < 20; p++) changed[p] = p == (near ? 5 : 17);
        for (int c = 10; c < 19; c++) s->bonds.cause[c] = GN_BROKEN_TENSION; /* just touching */
        assert_int_equal(gn_step_holds(&s->spectrum, INFINITY, 0.0, false, changed, &v, NULL),
                         GNEISS_OK);
        assert_int_equal(v.holds, !near);
    }
    destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(active_particles_have_the_limit_of_the_full_operator),
        cmocka_unit_test(selected_particles_keep_all_springs),
        cmocka_unit_test(a_step_without_end_holds_where_nothing_resists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
