/* The pair search compared with all pairs, and the effect of rebuilds and reorderings on a run. */
#include "world_helpers.h"

static gn_particles particles(size_t count, int dimension) {
    gn_particles p;
    gn_effects effects = dimension == 3 ? GN_FX_SPACE : 0;
    assert_int_equal(gn_soa_create(&gn_particle_record, &p, count, effects, NULL), GNEISS_OK);
    for (size_t k = 0; k < count; k++) {
        p.id[k] = (int32_t)k;
        p.vel[4 * k + 3] = 1.0;
    }
    return p;
}

/* `count` particles in a box of `size`, radii from 1 to `ratio` (many small ones). */
static gn_particles scattered(size_t count, int dimension, double size, double ratio,
                              uint64_t seed) {
    gn_particles p = particles(count, dimension);
    for (size_t k = 0; k < count; k++) {
        for (int a = 0; a < dimension; a++)
            p.pos[4 * k + a] = uniform(&seed, -0.3 * size, 0.7 * size);
        p.pos[4 * k + 3] = pow(ratio, pow(uniform(&seed, 0.0, 1.0), 3.0));
    }
    return p;
}

static bool wanted(const gn_pair_query *q, size_t i, size_t j) {
    const double *a = q->particles->pos + 4 * i, *b = q->particles->pos + 4 * j;
    if (q->particles->vel[4 * i + 3] == 0.0 || q->particles->vel[4 * j + 3] == 0.0) return false;
    double d2 = 0.0;
    for (int k = 0; k < q->dimension; k++) {
        double d = fabs(b[k] - a[k]);
        if (q->periodic) d = fmin(fmod(d, q->period[k]), q->period[k] - fmod(d, q->period[k]));
        d2 += d * d;
    }
    return sqrt(d2) - a[3] - b[3] <= q->margin + q->range * (a[3] + b[3]);
}

/* Compares the list with that of a search over all pairs, in order, for 1 to 4 threads. Returns the
 * number of pairs. */
static size_t check(const gn_pair_query *query) {
    size_t n = query->particles->soa.count, most = n * n / 2 + 1, count = 0;
    int32_t(*all)[2] = calloc(most, sizeof *all);
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n; j++)
            if (wanted(query, i, j)) {
                all[count][0] = (int32_t)i;
                all[count++][1] = (int32_t)j;
            }
    for (int threads = 1; threads <= 4; threads++) {
        gn_pair_query q = *query;
        gn_pair_list list = {0};
        gneiss_error error = {0};
        q.threads = threads;
        if (gn_pairs_find(&q, &list, &error) != GNEISS_OK) fail_msg("%s", error.message);
        assert_int_equal(list.count, count);
        if (count) assert_memory_equal(list.pair, all, count * sizeof *all);
        gn_pair_list_free(&list);
    }
    free(all);
    return count;
}

static void pairs_of_any_size_ratio_are_all_found(void **state) {
    (void)state;
    static const double ratios[] = {1.0, 1.9, 3.0, 10.0, 100.0};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (size_t k = 0; k < 5; k++) {
            double size = (dimension == 2 ? 40.0 : 14.0) * fmax(1.0, 0.2 * ratios[k]);
            gn_particles p = scattered(700, dimension, size, ratios[k], 1000 * k);
            gn_pair_query q = {&p, dimension, 0.3, 0.0, false, {0}, 1};
            assert_true(check(&q) > 300);
            q.margin = 0.0;
            q.range = 0.07;
            check(&q);
            gn_soa_destroy(&gn_particle_record, &p);
        }
}

static void pairs_across_a_periodic_box_are_all_found(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 4; k++) {
            double ratio = k % 2 ? 6.0 : 1.0, size = dimension == 2 ? 50.0 : 26.0;
            if (k >= 2)
                size =
                    2.02 * (2.0 * ratio + 0.4); /* the box is just wide enough: one or two cells */
            gn_particles p = scattered(500, dimension, size, ratio, 77 + (uint64_t)k);
            for (int a = 0; a < dimension; a++)
                p.pos[a] += 3.0 * size; /* positions are not wrapped yet */
            gn_pair_query q = {&p, dimension, 0.4, 0.0, true, {size, 1.1 * size, 1.2 * size}, 1};
            assert_true(check(&q) > 100);
            gn_soa_destroy(&gn_particle_record, &p);
        }
}

static void a_periodic_box_that_is_too_narrow_is_refused(void **state) {
    (void)state;
    gn_particles p = scattered(20, 3, 3.0, 1.0, 5);
    gn_pair_query q = {&p, 3, 0.1, 0.0, true, {3.0, 30.0, 30.0}, 1};
    gn_pair_list list = {0};
    gneiss_error error = {0};
    assert_int_equal(gn_pairs_find(&q, &list, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "periodic"));
    gn_soa_destroy(&gn_particle_record, &p);
}

/* Dense clusters far apart: grids that are mostly empty. */
static void pairs_in_clusters_are_all_found(void **state) {
    (void)state;
    gn_particles p = scattered(600, 3, 4.0, 2.0, 9);
    for (size_t k = 0; k < 600; k++)
        for (int a = 0; a < 3; a++) p.pos[4 * k + (size_t)a] += 1e4 * (double)(k % 5) * (a + 1);
    gn_pair_query q = {&p, 3, 0.2, 0.0, false, {0}, 1};
    assert_true(check(&q) > 5000);
    gn_soa_destroy(&gn_particle_record, &p);
}

static void coincident_centres_are_pairs(void **state) {
    (void)state;
    gn_particles p = particles(40, 3);
    for (size_t k = 0; k < 40; k++)
        p.pos[4 * k + 3] = 1.0 + (double)(k % 3); /* all particles are at the origin */
    gn_pair_query q = {&p, 3, 0.0, 0.0, false, {0}, 1};
    assert_int_equal(check(&q), 40 * 39 / 2);
    gn_soa_destroy(&gn_particle_record, &p);
}

static void a_large_sphere_in_a_bed_of_small_ones_finds_them_all(void **state) {
    (void)state;
    enum { BED = 2500 };
    gn_particles p = scattered(BED, 3, 30.0, 1.0, 4);
    p.pos[4 * 1200 + 3] = 12.0;
    for (int a = 0; a < 3; a++) p.pos[4 * 1200 + a] = 6.0;
    gn_pair_query q = {&p, 3, 0.1, 0.0, false, {0}, 1};
    check(&q);
    gn_pair_list list = {0};
    assert_int_equal(gn_pairs_find(&q, &list, NULL), GNEISS_OK);
    size_t of_large = 0;
    for (size_t c = 0; c < list.count; c++)
        of_large += list.pair[c][0] == 1200 || list.pair[c][1] == 1200;
    assert_true(of_large > 300);
    gn_pair_list_free(&list);
    gn_soa_destroy(&gn_particle_record, &p);
}

static void removed_particles_and_empty_lists_have_no_pairs(void **state) {
    (void)state;
    gn_particles p = scattered(200, 2, 20.0, 2.0, 3), none = particles(0, 2);
    for (size_t k = 0; k < 200; k += 3) p.vel[4 * k + 3] = 0.0;
    gn_pair_query q = {&p, 2, 0.2, 0.0, false, {0}, 1};
    assert_true(check(&q) > 50);
    for (size_t k = 0; k < 200; k++) p.vel[4 * k + 3] = 0.0;
    assert_int_equal(check(&q), 0);
    q.particles = &none;
    assert_int_equal(check(&q), 0);
    gn_soa_destroy(&gn_particle_record, &p);
    gn_soa_destroy(&gn_particle_record, &none);
}

static void morton_order_is_a_permutation_that_keeps_neighbours_near(void **state) {
    (void)state;
    enum { SIDE = 16 };
    gn_particles p = particles(SIDE * SIDE, 2);
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        size_t at = k * 89 % (SIDE * SIDE);
        p.pos[4 * k] = (double)(at % SIDE);
        p.pos[4 * k + 1] = (double)(at / SIDE);
    }
    int32_t order[SIDE * SIDE];
    bool seen[SIDE * SIDE] = {false};
    assert_int_equal(gn_morton_order(&p, 2, order, NULL), GNEISS_OK);
    for (size_t k = 0; k < SIDE * SIDE; k++) {
        assert_false(seen[order[k]]);
        seen[order[k]] = true;
    }
    for (size_t k = 0; k < SIDE * SIDE; k += 16) { /* 16 in a row fill a square of four by four */
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (size_t e = k; e < k + 16; e++)
            for (int a = 0; a < 2; a++) {
                low[a] = fmin(low[a], p.pos[4 * order[e] + a]);
                high[a] = fmax(high[a], p.pos[4 * order[e] + a]);
            }
        assert_true(high[0] - low[0] == 3.0 && high[1] - low[1] == 3.0);
    }
    gn_soa_destroy(&gn_particle_record, &p);
}

/* --- runs --- */

/* Discs that fall into a box and slide over each other; `skin` of the lists. `glued`: the lower
 * rows are bonded to one another, so that the particles of the model keep their order. */
static gn_world *tumble(double skin, bool glued) {
    return world_of(
        "dimension: 2\nspecimen:\n  lattice: {kind: hexagonal, radius: 1e-3, cells: [8, 5], "
        "origin: [0, 0], spacing: 1.05, jitter: 0.05}\n  group: 0\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.4, "
        "bond_tension_limit: 2e3, bond_shear_limit: 2e3}]\nlaw: {stiffness: uniform}\n%s"
        "damping: {contact: {restitution: 0.4}}\ngravity: [3, -9.81]\n"
        "initial: {random_velocity: 0.4}\n"
        "sets: [{name: low, select: {box: {min: [-1, -1], max: [1, 6e-3]}}, group: 1}]\n"
        "walls:\n"
        "  - {name: floor, point: [0, 0], normal: [0, 1], stiffness: 1e6, kratio: 2, friction: "
        "0.3}\n"
        "  - {name: left, point: [-1e-3, 0], normal: [1, 0], stiffness: 1e6}\n"
        "  - {name: right, point: [24e-3, 0], normal: [-1, 0], stiffness: 1e6}\n"
        "neighbours: {skin: %g}\ntime: {step: 2e-6, end: 1}\nrun: {threads: 1}\n",
        glued ? "bonds: {interaction_range: 0.2}\n" : "", skin);
}

/* Pairs that do not touch add zeros, but shift contacts between blocks, whose sums round on their
 * own: the same motion, to rounding and its growth. */
static void the_skin_does_not_change_the_motion(void **state) {
    (void)state;
    gn_world *a = tumble(3e-5, true), *b = tumble(1e-3, true);
    assert_true(a->dem.bonds.contacts.soa.count > 5);
    run_steps(a, 2000);
    run_steps(b, 2000);
    double *x = positions(a), *y = positions(b), largest = 0.0;
    for (size_t k = 0; k < 3 * a->dem.particles.soa.count; k++)
        largest = fmax(largest, fabs(x[k] - y[k]));
    print_message("# largest difference %g m\n", largest);
    assert_true(largest < 1e-12); /* paths are some 1e-3 m */
    free(x);
    free(y);
    assert_true(a->dem.verlet.rebuilds > 10 * b->dem.verlet.rebuilds);
    assert_true(a->ledger.energy.friction > 0.0);
    assert_close(a->ledger.energy.friction, b->ledger.energy.friction, 1e-6);
    world_end(a);
    world_end(b);
}

/* Two spheres that collide, and one that hits a wall, all at 2 m/s and thus 5e-6 m per step; the
 * remaining speed of the pair and of the third. */
static void rebound(const char *skin, const char *damping, double phase, double left[2]) {
    double gap = 1e-5 + phase * 5e-6;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [%.17g, 0, 0, 1e-3], "
                 "[0, 0.1, 0, 1e-3]], group: 0}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 0}]\n"
                 "law: {stiffness: uniform}\n%s"
                 "walls: [{name: w, point: [0, 0, %.17g], normal: [0, 0, -1], stiffness: 1e5}]\n"
                 "sets: [{name: a, select: {ids: [0]}, initial_velocity: [1, 0, 0]}, "
                 "{name: b, select: {ids: [1]}, initial_velocity: [-1, 0, 0]}, "
                 "{name: c, select: {ids: [2]}, initial_velocity: [0, 0, 2]}]\n"
                 "neighbours: {skin: %s}\ntime: {step: 2.5e-6, end: 1}\nrun: {threads: 1}\n",
                 2e-3 + gap, damping, 1e-3 + gap, skin);
    run_steps(w, 60);
    left[0] = 0.5 * (vel_of(w, 1)[0] - vel_of(w, 0)[0]);
    left[1] = -0.5 * vel_of(w, 2)[2];
    world_end(w);
}

/* A contact that opens by more than the skin in one step is listed nevertheless: it acted for a
 * part of that step. For a single contact no bit depends on the skin. */
static void a_skin_below_the_path_of_a_step_does_not_change_a_rebound(void **state) {
    (void)state;
    static const char *const skins[] = {"1e-12", "1e-9", "1e-7", "1e-6", "3e-6", "1e-5", "1e-4"};
    static const char *const damping[] = {"", "damping: {contact: {restitution: 0.5}}\n"};
    for (int k = 0; k < 16; k++) {
        double want[2], got[2];
        rebound("auto", damping[k % 2], 0.125 * (k / 2), want);
        for (int kind = 0; kind < 2; kind++)
            assert_near(want[kind], k % 2 ? 0.5 : 1.0,
                        0.01); /* the step is a tenth of the duration of a contact */
        for (size_t s = 0; s < sizeof skins / sizeof *skins; s++) {
            rebound(skins[s], damping[k % 2], 0.125 * (k / 2), got);
            assert_true(got[0] == want[0]);
            assert_true(got[1] == want[1]);
        }
    }
}

/* Without bonds the particles are sorted again every 16 rebuilds. That changes the order of sums
 * and so their round-off (which collisions amplify), but a lost shear force would be an error of
 * its own size at once. */
static void shear_forces_survive_reorderings(void **state) {
    (void)state;
    gn_world *a = tumble(3e-5, false), *b = tumble(1e-3, false);
    for (int64_t before = 0; before < 10;) {
        run_steps(a, 1);
        run_steps(b, 1);
        if (a->dem.verlet.rebuilds / 16 > before) before = a->dem.verlet.rebuilds / 16;
    }
    assert_true(b->dem.verlet.rebuilds < 16);
    double *x = positions(a), *y = positions(b), worst = 0.0;
    for (size_t k = 0; k < 3 * a->dem.particles.soa.count; k++)
        worst = fmax(worst, fabs(x[k] - y[k]));
    assert_true(worst < 1e-9 * 1e-3);
    assert_close(a->ledger.energy.friction, b->ledger.energy.friction, 1e-9);
    bool moved = false; /* the order has changed */
    for (size_t k = 0; k < a->dem.particles.soa.count; k++)
        moved = moved || a->dem.particles.id[k] != b->dem.particles.id[k];
    assert_true(moved);
    free(x);
    free(y);
    world_end(a);
    world_end(b);
}

/* Two spheres in sliding contact. Rotated by 180 degrees about z in the middle of the run, they
 * have the other order along the Morton curve: their contact exchanges its ends. The run must
 * continue as the rotated one, bit for bit. */
static gn_world *rubbing(void) {
    return world_of(
        "dimension: 3\nspecimen: {particles: [[-1e-3, 0, 0, 1e-3], [1e-3, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.9}]\n"
        "law: {stiffness: uniform}\ndamping: {contact: {restitution: 0.6}}\n"
        "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [1, 0.2, 0.1], "
        "initial_spin: [5, 100, 40]}\n"
        "  - {name: b, select: {ids: [1]}, initial_velocity: [-1, -0.1, 0.2]}\n"
        "time: {step: 1e-7, end: 1}\nrun: {threads: 1}\n");
}

static void turn_by_180_degrees(gn_world *w) {
    for (int p = 0; p < 2; p++)
        for (int a = 0; a < 2; a++) {
            pos_of(w, p)[a] *= -1.0;
            vel_of(w, p)[a] *= -1.0;
            spin_of(w, p)[a] *= -1.0;
        }
    for (size_t a = 0; a < 2; a++)
        w->dem.pairs.contacts.shear[a * w->dem.pairs.contacts.soa.capacity] *= -1.0;
}

static void a_contact_is_unchanged_if_its_ends_change_places(void **state) {
    (void)state;
    gn_world *a = rubbing(), *b = rubbing();
    gneiss_error error = {0};
    double t[3];
    run_steps(a, 25);
    run_steps(b, 25);
    assert_true(shear_of(&b->dem.pairs.contacts, 0, t) > 0.01);
    turn_by_180_degrees(b);
    b->dem.verlet.rebuilds = 16; /* the sixteenth sorts */
    int32_t first = b->dem.particles.id[0];
    assert_int_equal(gn_world_rebuild(b, &error), GNEISS_OK);
    assert_true(b->dem.particles.id[0] != first);
    run_steps(a, 25);
    run_steps(b, 25);
    assert_true(shear_of(&a->dem.pairs.contacts, 0, t) > 0.01);
    for (int p = 0; p < 2; p++)
        for (int k = 0; k < 3; k++) {
            double sign = k < 2 ? -1.0 : 1.0;
            assert_true(pos_of(b, p)[k] == sign * pos_of(a, p)[k]);
            assert_true(vel_of(b, p)[k] == sign * vel_of(a, p)[k]);
            assert_true(spin_of(b, p)[k] == sign * spin_of(a, p)[k]);
        }
    world_end(a);
    world_end(b);
}

/* The lists of fast particles are short-lived, and their skin grows; a box of 4.4 mm allows 0.2 mm
 * of it. */
static void the_skin_grows_no_wider_than_a_periodic_box_allows(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [4, 4, 2]}, group: "
        "0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\nlaw: {stiffness: "
        "uniform}\ndamping: {contact: {restitution: 0.9}}\ninitial: {random_velocity: 100}\n"
        "periodic: {min: [0, 0, 0], max: [8.2e-3, 8.2e-3, 4.4e-3]}\ntime: {end: 1}\nrun: {threads: "
        "1}\n");
    double start = w->dem.verlet.skin_start;
    run_steps(w, 200);
    assert_true(w->dem.verlet.skin > start && w->dem.verlet.skin <= 0.2e-3);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs_of_any_size_ratio_are_all_found),
        cmocka_unit_test(pairs_across_a_periodic_box_are_all_found),
        cmocka_unit_test(a_periodic_box_that_is_too_narrow_is_refused),
        cmocka_unit_test(pairs_in_clusters_are_all_found),
        cmocka_unit_test(coincident_centres_are_pairs),
        cmocka_unit_test(a_large_sphere_in_a_bed_of_small_ones_finds_them_all),
        cmocka_unit_test(removed_particles_and_empty_lists_have_no_pairs),
        cmocka_unit_test(morton_order_is_a_permutation_that_keeps_neighbours_near),
        cmocka_unit_test(the_skin_does_not_change_the_motion),
        cmocka_unit_test(a_skin_below_the_path_of_a_step_does_not_change_a_rebound),
        cmocka_unit_test(shear_forces_survive_reorderings),
        cmocka_unit_test(a_contact_is_unchanged_if_its_ends_change_places),
        cmocka_unit_test(the_skin_grows_no_wider_than_a_periodic_box_allows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
