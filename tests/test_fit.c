/* The fit of touching spheres: energy, gradient, linear system, iterations. */
#include "fit_help.h"

#include "base/memory.h"

/* ---- samples ---- */

/* Random discs in a unit square or spheres in a unit box, dense enough that most of them overlap
 * others and some protrude. */
static sample *crowd(int dimension, size_t count, double radius, const gn_fit_law *law,
                     uint64_t seed) {
    const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    double row[FIT_MOST][4] = {{0}};
    sample *s = calloc(1, sizeof *s);
    assert_true(count <= FIT_MOST);
    s->count = count;
    s->law = *law;
    make_ok(dimension == 2 ? gn_domain_rectangle(zero, one, &s->domain, &failure)
                           : gn_domain_box(zero, one, &s->domain, &failure));
    for (size_t k = 0; k < count; k++) {
        for (int a = 0; a < dimension; a++)
            row[k][a] = uniform(seed, 8 * k + (size_t)a, 0.02, 0.98);
        row[k][3] = radius * uniform(seed, 8 * k + 4, 0.6, 1.4);
        s->wanted[k] = radius * uniform(seed, 8 * k + 5, 0.8, 2.0);
        s->least[k] = 0.1 * radius;
        s->most[k] = 10 * radius;
    }
    make_ok(gn_fit_create(s->domain, count, row[0], s->wanted, s->least, s->most, 1, &s->fit,
                          &failure));
    return s;
}

static void forget(sample *s) {
    gn_fit_free(s->fit);
    gn_domain_free(s->domain);
    free(s);
}

static const double (*rows_of(const sample *s))[4] {
    return (const double(*)[4])gn_fit_rows(s->fit);
}

/* Holds the pairs that overlap now, then moves all centres apart so that gaps open in some. */
static void hold_and_spread(sample *s) {
    make_ok(gn_fit_hold(s->fit, &failure));
    const double(*row)[4] = rows_of(s);
    for (size_t i = 0; i < s->count; i++)
        for (size_t j = 0; j < i; j++)
            s->held[i][j] = distance(row[i], row[j]) <= row[i][3] + row[j][3];
    for (size_t k = 0; k < s->count; k++) s->fit->x[k][3] *= 0.75;
}

static gn_fit_state assemble(sample *s) {
    gn_fit_state state = {0};
    make_ok(gn_fit_lists(s->fit, 1.0, &failure));
    gn_fit_assemble(s->fit, &s->law, s->fit->x, true, &state);
    return state;
}

/* ---- energy and gradient ---- */

/* The energy is compared with that of the oracle; the gradient with central differences of the
 * oracle's energy with the weights held, as Gauss-Newton takes them. The sum of squares is smooth
 * over a step this small, so that differences are good to about the square of it and the rounding
 * of energies over it. */
static void check_gradient(sample *s) {
    assemble(s);
    double row[FIT_MOST][4], most = 0;
    memcpy(row, rows_of(s), s->count * sizeof *row);
    weights w = weights_at(s, (const double(*)[4])row);
    assert_close(energy_of_fit(s->fit), energy_of(s, &w, (const double(*)[4])row), 1e-12);
    for (size_t i = 0; i < s->count; i++)
        for (int a = 0; a < 4; a++) most = fmax(most, fabs(s->fit->gradient[i][a]));
    assert_true(most > 0);
    for (size_t i = 0; i < s->count; i++)
        for (int a = 0; a < 4; a++) {
            if (s->fit->dimension == 2 && a == 2) continue;
            const double step = 1e-6, middle = row[i][a];
            row[i][a] = middle + step;
            double above = energy_of(s, &w, (const double(*)[4])row);
            row[i][a] = middle - step;
            double below = energy_of(s, &w, (const double(*)[4])row);
            row[i][a] = middle;
            double slope = (above - below) / (2 * step), found = s->fit->gradient[i][a];
            if (fabs(slope - found) > 1e-7 * most)
                fail_msg("particle %zu, unknown %d: gradient %.12g, differences %.12g", i, a, found,
                         slope);
        }
}

/* Numbers of the residuals of each kind, so that no test passes because there are none. */
typedef struct census {
    int overlaps, pulls, holds, planes, gaps_at_planes;
} census;

static census count_kinds(const sample *s) {
    census c = {0};
    const double(*row)[4] = rows_of(s);
    weights w = weights_at(s, row);
    for (size_t i = 0; i < s->count; i++) {
        gn_domain_plane plane[GN_DOMAIN_PLANES];
        int planes = planes_near(s, row[i], plane);
        for (int k = 0; k < planes; k++)
            if (w.plane[i][k] > 0)
                (*(plane[k].depth < row[i][3] ? &c.planes : &c.gaps_at_planes))++;
        for (size_t j = 0; j < i; j++) {
            double relative, gap = pair_gap(s, row[i], row[j], &relative);
            if (w.pair[i][j] == 0) continue;
            (*(gap < 0 ? &c.overlaps : relative < s->law.gap ? &c.pulls : &c.holds))++;
        }
    }
    return c;
}

static void gradient_of(int dimension, const gn_fit_law *law, bool held) {
    sample *s = crowd(dimension, FIT_MOST, dimension == 2 ? 0.09 : 0.17, law, 7);
    if (held) hold_and_spread(s);
    census c = count_kinds(s);
    assert_true(c.overlaps > 10 && c.planes > 3);
    assert_true(!held || c.holds > 10);
    assert_true(law->gap == 0 || (c.pulls > 5 && c.gaps_at_planes > 1));
    check_gradient(s);
    forget(s);
}

static void the_gradient_of_overlaps_and_walls_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) gradient_of(d, &(gn_fit_law){.fixed_radii = true}, false);
}

static void the_gradient_of_springs_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) gradient_of(d, &(gn_fit_law){.stiffness = 3}, false);
}

static void the_gradient_of_wanted_overlaps_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        gradient_of(d, &(gn_fit_law){.stiffness = 0.5, .overlap = 0.06}, false);
}

static void the_gradient_of_overlaps_beyond_the_most_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        gradient_of(d, &(gn_fit_law){.stiffness = 0.5, .overlap = 0.04, .most = 0.1}, false);
}

static void the_gradient_of_pulled_gaps_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        gradient_of(d, &(gn_fit_law){.stiffness = 0.1, .overlap = 0.02, .gap = 0.2, .pull = 0.3},
                    false);
}

static void the_gradient_of_held_pairs_is_that_of_the_energy(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) gradient_of(d, &(gn_fit_law){.stiffness = 0.1, .pull = 0.7}, true);
}

static void the_energy_is_one_half_when_every_sphere_overlaps_another_by_its_size(void **state) {
    (void)state;
    /* Two coincident discs or spheres of radius r: one residual of 2 r. */
    for (int d = 2; d <= 3; d++) {
        sample *s = crowd(d, 2, 0.1, &(gn_fit_law){.fixed_radii = true}, 1);
        for (int k = 0; k < 2; k++)
            s->fit->x[k] = (gn_d4){0.5 + 1e-9 * k, 0.5, d == 3 ? 0.5 : 0, 0.1};
        gn_fit_state state_now = assemble(s);
        double pair = 0.5 * (d == 3 ? 0.2 : 1) * 0.2 * 0.2;
        double scale = 2 * 0.5 * 4 * (d == 3 ? 0.2 : 1) * 0.1 * 0.1;
        assert_close(state_now.energy, pair / scale, 1e-6);
        assert_close(state_now.overlap_max, 1, 1e-6);
        assert_close(state_now.gap_rms, 1, 1e-6);
        assert_int_equal(state_now.pairs, 1);
        forget(s);
    }
}

static void coincident_centres_give_finite_steps(void **state) {
    (void)state;
    sample *s = crowd(3, 12, 0.2, &(gn_fit_law){.stiffness = 1}, 3);
    s->fit->x[1] = s->fit->x[0];
    gn_fit_goal goal = {20, 30, 0.05, 1e-4, 0.3, 4};
    bool go_on = true;
    make_ok(gn_fit_run(s->fit, &s->law, &goal, NULL, NULL, &go_on, &failure));
    for (size_t k = 0; k < s->count; k++)
        for (int a = 0; a < 4; a++) assert_true(isfinite(rows_of(s)[k][a]));
    forget(s);
}

static void a_sphere_without_neighbours_is_a_packing(void **state) {
    (void)state;
    sample *s = crowd(3, 1, 0.01, &(gn_fit_law){.stiffness = 1}, 3);
    gn_fit_goal goal = {20, 30, 0.05, 1e-4, 0.3, 4};
    bool go_on = true;
    make_ok(gn_fit_run(s->fit, &s->law, &goal, NULL, NULL, &go_on, &failure));
    for (int a = 0; a < 4; a++) assert_true(isfinite(rows_of(s)[0][a]));
    forget(s);
}

/* ---- the linear system ---- */

/* Rows of the Jacobian are kept in single precision (6e-8), and damping of 1 % bounds the condition
 * of the preconditioned matrix by some hundreds. */
static void check_solve(int dimension, const gn_fit_law *law, bool held) {
    sample *s = crowd(dimension, FIT_MOST, dimension == 2 ? 0.09 : 0.17, law, 11);
    if (held) hold_and_spread(s);
    assemble(s);
    size_t n = 4 * s->count;
    double *matrix = gn_alloc_array(n * n, sizeof *matrix), *b = gn_alloc_array(n, sizeof *b);
    weights w = weights_at(s, rows_of(s));
    normal_matrix(s, &w, rows_of(s), matrix);
    s->fit->damping = 1e-2;
    for (size_t i = 0; i < s->count; i++) {
        double trace = 0;
        for (size_t a = 0; a < 4; a++) trace += matrix[(n + 1) * (4 * i + a)];
        for (size_t a = 0; a < 4; a++) {
            matrix[(n + 1) * (4 * i + a)] += s->fit->damping * trace / 4;
            b[4 * i + a] = -s->fit->gradient[i][a];
        }
    }
    for (size_t i = 3; i < n && law->fixed_radii; i += 4) {
        for (size_t k = 0; k < n; k++) matrix[n * i + k] = matrix[n * k + i] = 0;
        matrix[(n + 1) * i] = 1;
        b[i] = 0;
    }
    solve_dense(matrix, b, n);
    assert_true(gn_fit_solve(s->fit, law, 1000, 1e-10) < 1000);
    double error = 0, length = 0;
    for (size_t k = 0; k < n; k++) {
        error += pow(s->fit->step[k / 4][k % 4] - b[k], 2);
        length += b[k] * b[k];
    }
    assert_true(length > 0);
    if (sqrt(error / length) > 1e-4)
        fail_msg("relative error of the step: %g", sqrt(error / length));
    gn_free(matrix);
    gn_free(b);
    forget(s);
}

static void the_step_solves_the_damped_normal_equations(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        check_solve(d, &(gn_fit_law){.stiffness = 3}, false);
        check_solve(d, &(gn_fit_law){.stiffness = 0.1, .overlap = 0.03, .gap = 0.2, .pull = 0.3},
                    false);
        check_solve(d, &(gn_fit_law){.stiffness = 0.1, .pull = 0.7}, true);
    }
}

static void the_step_of_fixed_radii_solves_the_equations_of_the_centres(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) check_solve(d, &(gn_fit_law){.fixed_radii = true}, false);
}

static void a_solve_does_no_more_products_than_allowed(void **state) {
    (void)state;
    sample *s = crowd(3, FIT_MOST, 0.17, &(gn_fit_law){.stiffness = 3}, 5);
    assemble(s);
    s->fit->damping = 1e-4;
    assert_int_equal(gn_fit_solve(s->fit, &s->law, 7, 1e-12), 7);
    forget(s);
}

/* ---- iterations ---- */

static void held_pairs_of_a_triangulation_end_as_touching_discs(void **state) {
    (void)state;
    /* A patch of jittered triangular lattice: every pair of neighbours overlaps, no other pair. */
    const double lower[2] = {-9, -9}, upper[2] = {9, 9};
    double row[FIT_MOST][4] = {{0}}, wanted[FIT_MOST], least[FIT_MOST], most[FIT_MOST];
    int pair[3 * FIT_MOST][2], pairs = 0, count = 0;
    for (int i = -3; i <= 3; i++)
        for (int j = -3; j <= 3; j++) {
            if (abs(i + j) > 3) continue;
            uint64_t k = (uint64_t)count;
            row[count][0] = i + 0.5 * j + uniform(4, 2 * k, -0.05, 0.05);
            row[count][1] = sqrt(0.75) * j + uniform(4, 2 * k + 1, -0.05, 0.05);
            row[count][3] = 0.6;
            wanted[count] = 0.6, least[count] = 0.1, most[count] = 3;
            count++;
        }
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++)
            if (distance(row[i], row[j]) < 1.2) pair[pairs][0] = i, pair[pairs++][1] = j;
    assert_int_equal(count, 37);
    assert_int_equal(pairs, 3 * 37 - 3 - 18);
    gn_domain *domain = NULL;
    gn_fit *fit = NULL;
    make_ok(gn_domain_rectangle(lower, upper, &domain, &failure));
    make_ok(gn_fit_create(domain, (size_t)count, row[0], wanted, least, most, 1, &fit, &failure));
    make_ok(gn_fit_hold(fit, &failure));
    gn_fit_law law = {.pull = 1};
    gn_fit_goal goal = {300, 300, 1e-4, 0, 0.5, 5};
    bool go_on = true;
    make_ok(gn_fit_run(fit, &law, &goal, NULL, NULL, &go_on, &failure));
    const double(*now)[4] = (const double(*)[4])gn_fit_rows(fit);
    for (int k = 0; k < pairs; k++) {
        const double *a = now[pair[k][0]], *b = now[pair[k][1]];
        assert_true(fabs(distance(a, b) / (a[3] + b[3]) - 1) <= 1e-6);
    }
    gn_fit_free(fit);
    gn_domain_free(domain);
}

enum { MANY = 700 }; /* three blocks of sums */

/* Runs three stages on as many threads and gives the rows; the caller frees them. */
static double *many(int dimension, int threads) {
    const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    gn_domain *domain = NULL;
    gn_fit *fit = NULL;
    double *rows = gn_alloc_array(MANY, 4 * sizeof *rows), *bound = gn_alloc_array(3 * MANY, 8);
    double radius = dimension == 2 ? 0.021 : 0.061;
    make_ok(dimension == 2 ? gn_domain_disc(one, 1, &domain, &failure)
                           : gn_domain_box(zero, one, &domain, &failure));
    for (size_t k = 0; k < MANY; k++) {
        for (int a = 0; a < dimension; a++)
            rows[4 * k + (size_t)a] = uniform(9, 4 * k + (size_t)a, 0.3, 0.99);
        rows[4 * k + 3] = radius;
        bound[k] = 1.5 * radius;
        bound[MANY + k] = 0.3 * radius;
        bound[2 * MANY + k] = 3 * radius;
    }
    make_ok(gn_fit_create(domain, MANY, rows, bound, bound + MANY, bound + 2 * MANY, threads, &fit,
                          &failure));
    const gn_fit_law laws[] = {
        {.fixed_radii = true}, {.stiffness = 2}, {.stiffness = 0.01, .gap = 0.05, .pull = 0.5}};
    gn_fit_goal goal = {12, 30, 0.05, 1e-4, 0.3, 4};
    bool go_on = true;
    for (int k = 0; k < 3; k++) {
        if (k == 2) make_ok(gn_fit_hold(fit, &failure));
        make_ok(gn_fit_run(fit, &laws[k], &goal, NULL, NULL, &go_on, &failure));
    }
    memcpy(rows, gn_fit_rows(fit), MANY * 4 * sizeof *rows);
    gn_fit_free(fit);
    gn_free(bound);
    gn_domain_free(domain);
    return rows;
}

static void the_bits_do_not_depend_on_the_number_of_threads(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        double *one = many(d, 1);
        for (int threads = 2; threads <= 3; threads++) {
            double *more = many(d, threads);
            assert_memory_equal(one, more, MANY * 4 * sizeof *one);
            gn_free(more);
        }
        gn_free(one);
    }
}

static bool never_rises(void *context, const gn_fit_state *state) {
    double *before = context;
    assert_true(state->energy <= *before * (1 + 1e-12));
    *before = state->energy;
    return true;
}

static void the_energy_never_rises_within_a_stage(void **state) {
    (void)state;
    sample *s = crowd(3, FIT_MOST, 0.17, &(gn_fit_law){.stiffness = 1}, 21);
    gn_fit_goal goal = {40, 30, 0.05, 1e-6, 1.0, 1000}; /* neighbours are searched once */
    double before = INFINITY;
    bool go_on = true;
    make_ok(gn_fit_run(s->fit, &s->law, &goal, never_rises, &before, &go_on, &failure));
    assert_true(before < INFINITY);
    forget(s);
}

static void fixed_radii_stay_and_centres_move(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        sample *s = crowd(d, FIT_MOST, d == 2 ? 0.09 : 0.17, &(gn_fit_law){.fixed_radii = true}, 2);
        double before[FIT_MOST][4];
        memcpy(before, rows_of(s), s->count * sizeof *before);
        gn_fit_goal goal = {20, 30, 0.05, 1e-4, 0.5, 3};
        bool go_on = true;
        make_ok(gn_fit_run(s->fit, &s->law, &goal, NULL, NULL, &go_on, &failure));
        double moved = 0;
        for (size_t k = 0; k < s->count; k++) {
            assert_true(rows_of(s)[k][3] == before[k][3]);
            moved = fmax(moved, distance(rows_of(s)[k], before[k]));
        }
        assert_true(moved > 0.01);
        forget(s);
    }
}

static void radii_stay_within_their_bounds(void **state) {
    (void)state;
    sample *s = crowd(3, FIT_MOST, 0.1, &(gn_fit_law){.stiffness = 1}, 17);
    for (size_t k = 0; k < s->count; k++) {
        s->least[k] = 0.9 * s->fit->x[k][3];
        s->most[k] = 1.1 * s->fit->x[k][3];
        s->wanted[k] = (k % 2 ? 5.0 : 0.2) * s->fit->x[k][3];
    }
    gn_fit_goal goal = {30, 30, 0.05, 1e-6, 0.5, 5};
    bool go_on = true;
    make_ok(gn_fit_run(s->fit, &s->law, &goal, NULL, NULL, &go_on, &failure));
    int bound = 0;
    for (size_t k = 0; k < s->count; k++) {
        double r = rows_of(s)[k][3];
        assert_true(r >= s->least[k] && r <= s->most[k]);
        bound += r == s->least[k] || r == s->most[k];
    }
    assert_true(bound > 10);
    forget(s);
}

static bool stop_at_third(void *context, const gn_fit_state *state) {
    *(int *)context = state->iteration;
    return state->iteration < 3;
}

static void the_watch_ends_a_stage(void **state) {
    (void)state;
    sample *s = crowd(2, FIT_MOST, 0.09, &(gn_fit_law){.stiffness = 1}, 2);
    gn_fit_goal goal = {20, 30, 0.05, 0, 0.5, 3};
    bool go_on = true;
    int last = 0;
    make_ok(gn_fit_run(s->fit, &s->law, &goal, stop_at_third, &last, &go_on, &failure));
    assert_false(go_on);
    assert_int_equal(last, 3);
    forget(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gradient_of_overlaps_and_walls_is_that_of_the_energy),
        cmocka_unit_test(the_gradient_of_springs_is_that_of_the_energy),
        cmocka_unit_test(the_gradient_of_wanted_overlaps_is_that_of_the_energy),
        cmocka_unit_test(the_gradient_of_overlaps_beyond_the_most_is_that_of_the_energy),
        cmocka_unit_test(the_gradient_of_pulled_gaps_is_that_of_the_energy),
        cmocka_unit_test(the_gradient_of_held_pairs_is_that_of_the_energy),
        cmocka_unit_test(the_energy_is_one_half_when_every_sphere_overlaps_another_by_its_size),
        cmocka_unit_test(coincident_centres_give_finite_steps),
        cmocka_unit_test(a_sphere_without_neighbours_is_a_packing),
        cmocka_unit_test(the_step_solves_the_damped_normal_equations),
        cmocka_unit_test(the_step_of_fixed_radii_solves_the_equations_of_the_centres),
        cmocka_unit_test(a_solve_does_no_more_products_than_allowed),
        cmocka_unit_test(held_pairs_of_a_triangulation_end_as_touching_discs),
        cmocka_unit_test(the_bits_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(the_energy_never_rises_within_a_stage),
        cmocka_unit_test(fixed_radii_stay_and_centres_move),
        cmocka_unit_test(radii_stay_within_their_bounds),
        cmocka_unit_test(the_watch_ends_a_stage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
