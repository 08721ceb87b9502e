/* The list of events: its content for one bond and for many, and that it changes nothing else. Also
 * the warning of energy created by a break, for the same bonds. */
#include "io/h5.h"
#include "run/run.h"
#include "world_helpers.h"

#include <unistd.h>

/* A lattice whose upper row is pulled up and sideways, so that bonds break in tension and in shear.
 * */
static const char *const pulled =
    "dimension: %d\n"
    "specimen: {lattice: {kind: %s, radius: 1e-3, cells: [6, 6%s]%s}}\n"
    "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, friction: 0.3,\n"
    "  tensile_strength: 1e6, shear_strength: 0.7e6, strength_scatter: {distribution: weibull, "
    "modulus: "
    "6}%s}]\n"
    "law: {stiffness: harmonic%s}\nbonds: {}\n%s"
    "sets:\n"
    "  - {name: low, select: {box: {min: [-1, -1%s], max: [1, 1e-3%s]}}, motion: {v%c: 0}}\n"
    "  - {name: top, select: {box: {min: [-1, 0.0109%s], max: [1, 1%s]}}, motion: {vx: 0.4, vy: "
    "0.4}}\n"
    "time: {end: 1}\noutput: {snapshots: 0, checkpoint: off%s}\nrun: {threads: %d, precision: "
    "%s}\n";

typedef struct settings {
    int dimension, threads;
    const char *material, *law, *sections, *output, *precision;
} settings;
static const settings plain = {2, 1, "", "", "", "", "double"};

static gn_world *lattice(settings s) {
    bool space = s.dimension == 3;
    const char *low = space ? ", -1" : "", *high = space ? ", 1" : "";
    return world_of(pulled, s.dimension, space ? "cubic" : "square", space ? ", 3" : "", "",
                    s.material, s.law, s.sections, low, high, 'y', low, high, s.output, s.threads,
                    s.precision);
}

static const gn_event *event_of(const gn_world *w, size_t c, int32_t cause, size_t *count) {
    const gn_events *list = &w->dem.events;
    int32_t a = w->dem.particles.id[w->dem.bonds.contacts.i[c]],
            b = w->dem.particles.id[w->dem.bonds.contacts.j[c]];
    const gn_event *found = NULL;
    *count = 0;
    for (size_t k = 0; k < list->count; k++) {
        const gn_event *e = &list->rows[k];
        if (e->i != (a < b ? a : b) || e->j != (a < b ? b : a) || e->cause != cause) continue;
        found = e;
        ++*count;
    }
    return found;
}

/* The position is that of the contact when its bond broke: no particle has moved by as much as a
 * radius since. */
static void check_break(const gn_world *w, size_t c) {
    size_t count;
    const gn_contacts *b = &w->dem.bonds.contacts;
    const gn_event *e = event_of(w, c, b->cause[c], &count);
    assert_int_equal(count, 1);
    assert_near(e->time, b->broken_time[c], 0.0);
    const double *x = w->dem.particles.start + 4 * (int64_t)b->i[c],
                 *y = w->dem.particles.start + 4 * (int64_t)b->j[c];
    for (int a = 0; a < 3; a++) assert_near(e->place[a], 0.5 * (x[a] + y[a]), 0.5e-3);
}

static void every_break_is_listed_once_with_its_time_place_and_cause(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        settings s = plain;
        s.dimension = dimension;
        gn_world *w = lattice(s);
        run_steps(w, 4000);
        size_t broken = 0;
        for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++) {
            if (!w->dem.bonds.contacts.cause[c]) continue;
            check_break(w, c);
            broken++;
        }
        print_message("# %dD: %d + %d broken\n", dimension, (int)w->dem.broken_tension,
                      (int)w->dem.broken_shear);
        assert_true(w->dem.broken_tension > 3 && w->dem.broken_shear > 3);
        assert_int_equal(w->dem.events.count, broken);
        for (size_t k = 1; k < broken; k++)
            assert_true(w->dem.events.rows[k - 1].step <= w->dem.events.rows[k].step);
        world_end(w);
    }
}

/* The sums have the same numbers in another order; in mixed precision single numbers are
 * compared. */
static void energies_of_breaks_add_up_to_the_ledger(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        settings s = plain;
        s.dimension = 3;
        s.precision = mixed ? "mixed" : "double";
        gn_world *w = lattice(s);
        run_steps(w, 4000);
        double sum = 0.0, size = 0.0;
        for (size_t k = 0; k < w->dem.events.count; k++) {
            sum += w->dem.events.rows[k].energy;
            size += fabs(w->dem.events.rows[k].energy);
        }
        assert_true(sum > 0.0);
        assert_near(sum, w->ledger.energy.bond_breaking, (mixed ? 1e-6 : 1e-13) * size);
        world_end(w);
    }
}

static void the_first_softening_and_yield_of_a_bond_are_listed_once(void **state) {
    (void)state;
    settings s = plain;
    s.material = ", fracture_energy: 3, shear_fracture_energy: 3, yield_stress_1: 2e5, "
                 "yield_ratio_1: 3";
    s.law = ", softening: energy";
    gn_world *w = lattice(s);
    run_steps(w, 4000);
    size_t softened = 0, yielded = 0, count;
    for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++) {
        const gn_contacts *b = &w->dem.bonds.contacts;
        gn_bond_condition is = gn_softening_condition(b, c);
        event_of(w, c, GN_EVENT_SOFTENING, &count);
        bool softens = is.tension > 0.0 || is.shear > 0.0;
        assert_true(count <= 1);
        if (!b->cause[c]) assert_int_equal(count, softens);
        softened += count;
        event_of(w, c, GN_EVENT_YIELD, &count);
        assert_true(count <= 1);
        if (!b->cause[c]) assert_int_equal(count, is.permanent != 0.0);
        yielded += count;
    }
    assert_true(softened > 3 && yielded > 3);
    world_end(w);
}

static void threads_do_not_change_the_list(void **state) {
    (void)state;
    settings s = plain;
    s.dimension = 3;
    gn_world *one = lattice(s);
    s.threads = 2;
    gn_world *two = lattice(s);
    run_steps(one, 3000);
    run_steps(two, 3000);
    assert_int_equal(one->dem.events.count, two->dem.events.count);
    assert_true(one->dem.events.count > 3);
    assert_memory_equal(one->dem.events.rows, two->dem.events.rows,
                        one->dem.events.count * sizeof(gn_event));
    world_end(one);
    world_end(two);
}

static void the_list_changes_no_bits_and_is_absent_when_off(void **state) {
    (void)state;
    settings s = plain;
    gn_world *on = lattice(s);
    s.output = ", events: off";
    gn_world *off = lattice(s);
    run_steps(on, 3000);
    run_steps(off, 3000);
    assert_int_equal(gn_world_hash(&on->ctx, &on->dem, &on->boundary, &on->solids, &on->box),
                     gn_world_hash(&off->ctx, &off->dem, &off->boundary, &off->solids, &off->box));
    assert_null(off->dem.bonds.contacts.happened);
    assert_null(off->dem.bonds.contacts.released);
    assert_int_equal(off->dem.events.count, 0);
    world_end(on);
    world_end(off);
}

/* The nearest image is used: between particles at 1 and 9 mm of a period of 10 mm the contact is at
 * 0 or 10 mm, not in the middle. */
static void places_in_a_periodic_box_are_between_the_images(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\nspecimen: {particles: [[1e-3, 3e-3, 1e-3], [9e-3, 3e-3, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, "
        "tensile_strength: 1e6, shear_strength: 1e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
        "periodic: {min: [0, 0], max: [10e-3, 10e-3]}\n"
        "sets: [{name: m, select: {ids: [0]}, motion: {vx: 1, vy: 0}},\n"
        "  {name: n, select: {ids: [1]}, motion: {vx: 0, vy: 0}}]\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    for (int k = 0; k < 3000 && !w->dem.events.count; k++) run_steps(w, 1);
    assert_int_equal(w->dem.events.count, 1);
    const gn_event *e = w->dem.events.rows;
    assert_near(remainder(e->place[0], 10e-3), 0.0, 0.01e-3);
    assert_near(e->place[1], 3e-3, 0.0);
    world_end(w);
}

/* --- files --- */

static void take_steps(gn_run *run, int64_t steps) {
    gneiss_error error = {0};
    if (gn_run_steps(run, steps, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static void start_run(gn_run *run, const char *words, const char *folder) {
    gn_scene scene;
    gneiss_error error = {0};
    if (gn_scene_parse(words, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        (folder ? gn_run_start(&scene, folder, true, run, &error)
                : gn_run_create(&scene, run, &error)) != GNEISS_OK)
        fail_msg("%s", error.message);
}

static void a_resumed_run_has_the_same_list_and_results_hold_it(void **state) {
    (void)state;
    char words[4096], folder[] = "/tmp/gneiss-events-XXXXXX", path[4200];
    gneiss_error error = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(words, sizeof words, pulled, 2, "square", "", "", "", "", "", "", "", 'y', "", "", "",
             1, "double");
    gn_run *run = calloc(1, sizeof *run), *again = calloc(1, sizeof *again);
    start_run(run, words, folder);
    while (run->world.ctx.step < 3000 && !run->world.dem.events.count) take_steps(run, 1);
    assert_true(run->world.dem.events.count > 0);
    assert_int_equal(gn_run_checkpoint(run, &error), GNEISS_OK);
    take_steps(run, 1000);
    size_t count = run->world.dem.events.count;
    gn_event *rows = calloc(count, sizeof *rows);
    memcpy(rows, run->world.dem.events.rows, count * sizeof *rows);
    gn_run_free(run);
    if (gn_run_resume(folder, NULL, 0, again, &error) != GNEISS_OK) fail_msg("%s", error.message);
    assert_true(again->world.dem.events.count > 0 && again->world.dem.events.count < count);
    take_steps(again, 1000);
    assert_int_equal(again->world.dem.events.count, count);
    assert_memory_equal(again->world.dem.events.rows, rows, count * sizeof *rows);
    assert_int_equal(gn_run_checkpoint(again, &error), GNEISS_OK);
    gn_run_free(again);
    gn_h5 *file = NULL;
    size_t there = 0;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    assert_int_equal(gn_h5_open(path, &file, &error), GNEISS_OK);
    double *time = calloc(count, sizeof *time);
    assert_int_equal(gn_h5_rows(file, "events/cause", &there, &error), GNEISS_OK);
    assert_int_equal(there, count);
    assert_int_equal(gn_h5_get(file, "events/time", GN_F64, count, 1, 0, time, &error), GNEISS_OK);
    for (size_t k = 0; k < count; k++) assert_near(time[k], rows[k].time, 0.0);
    gn_h5_close(file);
    free(time);
    free(rows);
    free(run);
    free(again);
    char command[4300];
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* --- energy generated by a break --- */

/* Two spheres that begin to rotate in the same sense, with energy E. 5/7 of it shears their bond to
 * and fro; leap-frog conserves that as 1/2 k_t A^2 (1 - s^2), s the step over its limit, A the
 * largest shear. A bond that breaks at A leaves the velocities of half a step before, with s^2/(1 -
 * s^2) of that energy: 4.3 times as much at s 0.9. */
static void swing(gn_run *run, double safety) {
    char words[2048];
    double mass = sphere_mass(2500.0, 1e-3), k = 1e7, energy = 0.4 * mass * 1e-6; /* 1 rad/s each */
    double largest = sqrt(2.0 * 5.0 / 7.0 * energy / k / (1.0 - safety * safety));
    snprintf(words, sizeof words,
             "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
             "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 1, "
             "bond_tension_limit: 1e9, bond_shear_limit: %.17g}]\n"
             "law: {stiffness: uniform}\nbonds: {}\n"
             "sets: [{name: a, select: {all: true}, initial_spin: [0, 0, 1]}]\n"
             "time: {end: 1, safety: %g}\noutput: {history_rows: 10000000}\nrun: {threads: 1}\n",
             k, 0.97 * k * largest, safety);
    start_run(run, words, NULL);
    gn_world *w = &run->world;
    for (int n = 0; n < 1000 && !w->dem.broken_shear; n++) take_steps(run, 1);
    assert_int_equal(w->dem.broken_shear, 1);
    take_steps(run, 2);
}

static bool warns(const gn_run *run, const char *name) {
    gn_warnings list;
    gneiss_error error = {0};
    assert_int_equal(gn_run_warnings(run, &list, &error), GNEISS_OK);
    for (size_t k = 0; k < list.count; k++)
        if (strcmp(list.warning[k].name, name) == 0) return true;
    return false;
}

static void a_break_that_generates_energy_causes_a_warning(void **state) {
    (void)state;
    gn_run *run = calloc(1, sizeof *run);
    swing(run, 0.9);
    const gn_energy *e = &run->world.ledger.reading;
    /* At the turning point the generated energy is 0.81/0.19 - 1 of it; up to 14 degrees before or
     * after it, where the strength is exceeded as well, the product of both forces is 0.65 to 1.3
     * times that. */
    double made = 5.0 / 7.0 * (0.81 / 0.19 - 1.0), after = e->kinetic + e->rotational;
    assert_true(-e->bond_breaking > 0.6 * made * e->stored_at_start);
    assert_near(after, e->stored_at_start - e->bond_breaking, 1e-6 * after);
    assert_true(warns(run, "energy_gain"));
    assert_false(warns(run, "energy_residual"));
    gn_run_free(run);
    swing(run, 0.45);
    assert_true(run->world.ledger.reading.bond_breaking > 0.0);
    assert_false(warns(run, "energy_gain"));
    gn_run_free(run);
    free(run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_break_is_listed_once_with_its_time_place_and_cause),
        cmocka_unit_test(energies_of_breaks_add_up_to_the_ledger),
        cmocka_unit_test(the_first_softening_and_yield_of_a_bond_are_listed_once),
        cmocka_unit_test(threads_do_not_change_the_list),
        cmocka_unit_test(the_list_changes_no_bits_and_is_absent_when_off),
        cmocka_unit_test(places_in_a_periodic_box_are_between_the_images),
        cmocka_unit_test(a_resumed_run_has_the_same_list_and_results_hold_it),
        cmocka_unit_test(a_break_that_generates_energy_causes_a_warning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
