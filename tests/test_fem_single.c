/* Finite elements with forces in single precision: difference from the kernels in double, effect on
 * the energy, identical bits. */
#include "fem_helpers.h"

static const double cell = 0.1; /* m */

/* Twelve by six (by six) distorted cells. */
static gn_fem_solid *block(int d, bool single, int threads, const char *isa) {
    const double size[3] = {12 * cell, 6 * cell, d == 3 ? 6 * cell : 0.0};
    const int cells[3] = {12, 6, d == 3 ? 6 : 0};
    gn_fem_spec spec = spec_of(d, &rock);
    spec.single = single;
    spec.threads = threads;
    spec.isa = isa;
    return body_of(&spec, mesh_of(size, cells, 0.15));
}

/* --- forces --- */

/* Moves nodes by a strain of that size, random in every element, and a rigid motion. */
static void displace(gn_fem_solid *solid, double strain, double travel, double angle) {
    const int d = solid->dimension;
    const double axis[3] = {d == 3 ? 0.3 : 0.0, d == 3 ? -0.5 : 0.0, 1.0},
                 along[3] = {0.6, -0.8, 0.0};
    double turn[3][3];
    uint64_t at = 5;
    rotation(axis, angle, turn);
    for (size_t n = 0; n < solid->nodes.soa.count; n++) {
        const double *x = solid->nodes.start + 4 * n;
        double place[3] = {0.0};
        for (int k = 0; k < d; k++)
            place[k] = x[k] + strain * (x[(k + 1) % d] + cell * uniform(&at, -1.0, 1.0));
        for (int k = 0; k < d; k++)
            solid->nodes.pos[4 * n + (size_t)k] = dot3(turn[k], place) + travel * along[k];
    }
}

/* Bounds the effect of rounding on the force of every node, in first order. With r = 2^-24 the
 * largest relative rounding, an element's H is off by at most r sum_a |grad N_a| |u_a| because the
 * displacement is rounded and by some r sum_a |grad N_a| |u_a - u_0| for every operation on the way
 * from there to the force, of which the longest chain has 20 (a column, a difference, 3 of H, 6 of
 * 2 E, 3 of the stress, 3 of F S, 3 of the force). F S then is off by (d lambda + 2 mu) |F|^2 times
 * that, with |F| <= 1 + |H|. */
static void bounds(const gn_fem_solid *solid, double *bound) {
    const gn_elements *q = &solid->elements;
    const int d = solid->dimension;
    const double round = ldexp(1.0, -24), stiffness = d * lame_lambda(&rock) + 2.0 * lame_mu(&rock);
    memset(bound, 0, solid->nodes.soa.count * sizeof *bound);
    for (size_t e = 0; e < q->soa.count; e++) {
        double size[4] = {0.0}, rest[3] = {0.0}, first[3] = {0.0}, travelled = 0.0, moved = 0.0;
        for (int a = 1; a <= d + 1; a++) { /* in the last round: node 0 */
            double g2 = 0.0;
            for (int k = 0; k < d; k++) {
                double g = a <= d ? gn_elements_gradient(q, a, k)[e] : rest[k];
                rest[k] -= g;
                g2 += g * g;
            }
            size[a % (d + 1)] = sqrt(g2);
        }
        for (int a = 0; a <= d; a++) {
            size_t n = 4 * (size_t)gn_elements_node(q, a)[e];
            double u2 = 0.0, du2 = 0.0;
            for (int k = 0; k < d; k++) {
                double u = solid->nodes.pos[n + (size_t)k] - solid->nodes.start[n + (size_t)k];
                if (a == 0) first[k] = u;
                u2 += u * u;
                du2 += (u - first[k]) * (u - first[k]);
            }
            travelled += size[a] * sqrt(u2);
            moved += size[a] * sqrt(du2);
        }
        double off = q->volume[e] * stiffness * (1.0 + moved) * (1.0 + moved) * round *
                     (travelled + 20.0 * moved);
        for (int a = 0; a <= d; a++) bound[gn_elements_node(q, a)[e]] += off * size[a];
    }
}

/* Root mean square error over root mean square force; every node within its bound. */
static double force_error(gn_fem_solid *exact, gn_fem_solid *single, double strain, double travel,
                          double angle) {
    const size_t nodes = exact->nodes.soa.count;
    double *bound = calloc(nodes, sizeof *bound), off = 0.0, all = 0.0;
    displace(exact, strain, travel, angle);
    displace(single, strain, travel, angle);
    fem_evaluate(exact);
    fem_evaluate(single);
    bounds(exact, bound);
    for (size_t n = 0; n < nodes; n++) {
        double want[3], got[3], off2 = 0.0;
        fem_force(&exact->partials, (int32_t)n, want);
        fem_force(&single->partials, (int32_t)n, got);
        for (int k = 0; k < 3; k++) off2 += (got[k] - want[k]) * (got[k] - want[k]);
        assert_true(sqrt(off2) <= bound[n]);
        off += off2;
        all += dot3(want, want);
    }
    free(bound);
    return sqrt(off / all);
}

static void forces_are_off_by_the_rounding_of_the_travel(void **state) {
    (void)state;
    const double travels[] = {0.0, 1.0, 100.0, 10000.0};
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *exact = block(d, false, 1, NULL), *single = block(d, true, 1, NULL);
        for (double strain = 1e-7; strain < 2e-2; strain *= 10.0)
            for (size_t k = 0; k < 4; k++) {
                double travel = travels[k] * cell;
                double error = force_error(exact, single, strain, travel, 0.0);
                print_message("# %dD: strain %.0e after %5g cells: force off by %.1e = %.2g times "
                              "6e-8 |u|/(h strain)\n",
                              d, strain, travels[k], error,
                              travel > 0.0 ? error * cell * strain / (6e-8 * travel) : NAN);
            }
        body_end(exact);
        body_end(single);
    }
}

/* If single precision started from F, nothing would remain of strains below 6e-8. */
static void small_strains_have_the_relative_error_of_large_ones(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *exact = block(d, false, 1, NULL), *single = block(d, true, 1, NULL);
        double small = force_error(exact, single, 1e-7, 0.0, 0.0),
               large = force_error(exact, single, 1e-4, 0.0, 0.0);
        print_message("# %dD: strain 1e-7: off by %.2g, 1e-4: %.2g\n", d, small, large);
        assert_true(small < 1e-6 && small < 2.0 * large);
        body_end(exact);
        body_end(single);
    }
}

static void the_error_grows_as_the_travel(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *exact = block(d, false, 1, NULL), *single = block(d, true, 1, NULL);
        double near = force_error(exact, single, 1e-4, 10.0 * cell, 0.0),
               far = force_error(exact, single, 1e-4, 10000.0 * cell, 0.0);
        /* Rounding errors grow by powers of two: at 1000 times the distance the error is 512 or
         * 1024 times as large. */
        assert_true(far > 250.0 * near && far < 2000.0 * near);
        body_end(exact);
        body_end(single);
    }
}

static void forces_of_a_turned_body_are_within_the_bound(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *exact = block(d, false, 1, NULL), *single = block(d, true, 1, NULL);
        for (double angle = 1e-4; angle < 4.0; angle *= 10.0)
            print_message("# %dD: strain 1e-4, turned by %.0e: force off by %.1e\n", d, angle,
                          force_error(exact, single, 1e-4, 0.0, angle));
        body_end(exact);
        body_end(single);
    }
}

/* --- bits --- */

/* Returns the hash after some steps, every `measured`-th of them measured. */
static uint64_t hash_after(gn_fem_solid *solid, int steps, int measured) {
    gn_fem_limit limit;
    assert_int_equal(gn_fem_bound(solid, &limit, NULL), GNEISS_OK);
    stir(solid, 0.1);
    for (int s = 0; s < steps; s++) fem_step(solid, 0.9 * limit.bound, s % measured == 0);
    uint64_t hash = gn_fem_hash(solid);
    body_end(solid);
    return hash;
}

static void threads_and_instruction_sets_give_the_same_bits(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        uint64_t want = hash_after(block(d, true, 1, "scalar"), 300, 1000);
        for (int s = 0; s < GN_KERNEL_SETS; s++)
            for (int threads = 1; threads <= 3 && runs_here(gn_kernel_set_at(s)); threads++) {
                const char *isa = gn_kernel_set_at(s)->name;
                assert_true(hash_after(block(d, true, threads, isa), 300, 1000) == want);
            }
        assert_true(hash_after(block(d, false, 1, NULL), 300, 1000) != want);
    }
}

static void measuring_changes_nothing(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        assert_true(hash_after(block(d, true, 1, NULL), 200, 1) ==
                    hash_after(block(d, true, 1, NULL), 200, 1000));
}

/* Copies in single precision are computed again from the state, as after a checkpoint was read. */
static void copies_follow_from_the_state(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_fem_solid *a = block(d, true, 1, NULL);
        gn_fem_limit limit;
        assert_int_equal(gn_fem_bound(a, &limit, NULL), GNEISS_OK);
        stir(a, 0.1);
        for (int s = 0; s < 100; s++) fem_step(a, 0.9 * limit.bound, false);
        size_t count = a->nodes.soa.count, size = 4 * count * sizeof(float);
        float *travel = malloc(size);
        memcpy(travel, a->nodes.travel_f, size);
        memset(a->nodes.travel_f, 0, size);
        gn_fem_to_single(a);
        assert_memory_equal(travel, a->nodes.travel_f, size);
        free(travel);
        body_end(a);
    }
}

/* The list of contacts with a solid's surface has a `ref` of its own. */
static void travel_is_counted_from_the_start_whatever_ref_is(void **state) {
    (void)state;
    gn_fem_solid *a = block(3, true, 1, NULL), *b = block(3, true, 1, NULL);
    for (size_t k = 0; k < 4 * b->nodes.soa.count; k++) b->nodes.ref[k] = (double)k;
    for (int s = 0; s < 50; s++) {
        if (s == 0) stir(a, 0.1);
        if (s == 0) stir(b, 0.1);
        fem_step(a, 1e-6, false);
        fem_step(b, 1e-6, false);
    }
    assert_memory_equal(a->nodes.pos, b->nodes.pos, 4 * a->nodes.soa.count * sizeof(double));
    body_end(a);
    body_end(b);
}

/* --- energy --- */

static void hold(gn_fem_solid *solid, const char *group) {
    const double rest[3] = {0.0};
    gn_fem_set set;
    int32_t motion;
    assert_int_equal(gn_fem_nodes_of_group(solid, group, &set, NULL), GNEISS_OK);
    assert_int_equal(gn_fem_prescribe(solid, &set, 7, rest, &motion, NULL), GNEISS_OK);
    gn_fem_set_free(&set);
}

/* Returns the largest relative change of kinetic and elastic energy. The energy is computed in
 * double from positions in double, so that it shows the work that rounding of forces did. */
static double energy_change(gn_fem_solid *solid, double dt, int steps) {
    double most = 0.0;
    for (int s = 0; s < steps; s++) {
        fem_step(solid, dt, s % 100 == 0);
        if (s % 100) continue;
        double stored = solid->reading.kinetic + solid->reading.elastic;
        most = fmax(most, fabs(stored / solid->reading.stored_at_start - 1.0));
    }
    return most;
}

/* A clamped bar that swings to and fro, first mode of a rod, strains of 1e-6. */
static void energy_of_a_vibrating_bar_stays_within_1e_6_for_1e5_steps(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        for (int single = 0; single < 2; single++) {
            const double size[3] = {8 * cell, cell, d == 3 ? cell : 0.0};
            const int cells[3] = {16, 2, d == 3 ? 2 : 0};
            gn_fem_spec spec = spec_of(d, &rock);
            spec.single = single;
            gn_fem_solid *solid = body_of(&spec, mesh_of(size, cells, 0.0));
            hold(solid, "x_lower");
            for (size_t n = 0; n < solid->nodes.soa.count; n++) {
                double *v = solid->nodes.vel + 4 * n, x = solid->nodes.start[4 * n] / size[0];
                if (x > 0.0) v[0] = 3.4e-3 * sin(0.5 * pi * x); /* m/s: 1e-6 c */
            }
            double change = energy_change(solid, 0.5 * fem_limits(solid).sharp, 100000);
            print_message("# %dD, %s: within %.2g\n", d, single ? "single" : "double", change);
            assert_true(change < 1e-6);
            body_end(solid);
        }
}

/* --- limits --- */

static void the_mixed_form_is_refused(void **state) {
    (void)state;
    const double size[3] = {1.0, 1.0, 0.0};
    const int cells[3] = {2, 2, 0};
    gn_fem_spec spec = spec_of(2, &rock);
    gn_mesh mesh = mesh_of(size, cells, 0.0);
    gn_fem_solid solid;
    gneiss_error error = {0};
    spec.single = true;
    spec.form = GN_FEM_PRESSURE;
    assert_int_equal(gn_fem_solid_create(&spec, &mesh, &solid, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "only the displacement form"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_off_by_the_rounding_of_the_travel),
        cmocka_unit_test(small_strains_have_the_relative_error_of_large_ones),
        cmocka_unit_test(the_error_grows_as_the_travel),
        cmocka_unit_test(forces_of_a_turned_body_are_within_the_bound),
        cmocka_unit_test(threads_and_instruction_sets_give_the_same_bits),
        cmocka_unit_test(measuring_changes_nothing),
        cmocka_unit_test(copies_follow_from_the_state),
        cmocka_unit_test(travel_is_counted_from_the_start_whatever_ref_is),
        cmocka_unit_test(energy_of_a_vibrating_bar_stays_within_1e_6_for_1e5_steps),
        cmocka_unit_test(the_mixed_form_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
