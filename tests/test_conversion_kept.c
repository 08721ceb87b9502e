/* What conversions keep, and the step that they leave. */
#include "conversion_helpers.h"

/* --- the step --- */

/* Elements of the size of a particle, with which slaved spins weigh most. */
static const block spinning = {.cells = {10, 6, 0}, .finer = 2, .couple = ", spins: slaved"};

static gn_world *spun(const char *time) {
    const double flat = 0.0;
    block s = spinning;
    s.time = time;
    gn_world *w = block_of(&s);
    convert(w, 8e-3, 10e-3, 0.0, 1.0);
    set_elements(w, stir, &flat);
    set_field(&w->dem.particles, stir, &flat);
    run_steps(w, 1);
    return w;
}

/* The energy after so many steps over that at the start; INFINITY when the run has gone bad. */
static double energy_after(gn_world *w, int steps) {
    gneiss_error error = {0};
    gn_energy e = measured_step(w);
    const double start = gn_energy_stored(&e);
    double grown = 0.0;
    for (int k = 0; k < steps && isfinite(grown); k++)
        if (gn_world_step(w, k == steps - 1, &error) != GNEISS_OK) grown = INFINITY;
    if (isfinite(grown)) grown = gn_energy_stored(&w->reading) / start;
    world_end(w);
    return grown;
}

/* They bring springs without inertia: with what particles and elements hold each by itself the
 * model is unstable. */
static void slaved_spins_of_new_zones_are_in_the_step(void **state) {
    (void)state;
    char time[96];
    gn_world *w = spun(NULL);
    const double stable = w->stable, sides = fmin(w->dem.stable, gn_elements_stable(w));
    assert_true(stable < 0.5 * sides);
    assert_near(w->dt, w->scene.safety * stable, 1e-12 * stable);
    assert_near(energy_after(w, 2000), 1.0, 1e-4);
    snprintf(time, sizeof time, ", step: %.17g, on_unstable: warn", 0.99 * stable);
    assert_near(energy_after(spun(time), 2000), 1.0, 1e-4);
    snprintf(time, sizeof time, ", step: %.17g, on_unstable: warn", 0.9 * sides);
    assert_true(energy_after(spun(time), 2000) > 10.0);
}

/* --- momenta --- */

static void stretch(const double *x, const void *of, double u[3], double v[3]) {
    (void)of;
    (void)u;
    v[0] = 2.0 + 300.0 * x[0] - 40.0 * x[1];
    v[1] = 90.0 * x[0] - 150.0 * x[1];
}

static void shear_about_x(const double *x, const void *of, double u[3], double v[3]) {
    (void)of;
    move_rigidly(x, turned, u, v);
    v[1] += 60.0 * x[2];
    v[2] += 200.0 * x[1] + 30.0 * x[0];
}

/* N m s: of how much angular momentum rounding is. */
static double turning_scale(const whole *s) {
    return sqrt(2.0 * s->mass * s->energy) * 0.03;
}

static void assert_kept(const block *s, field *motion, const double low[3], const double high[3],
                        bool turning) {
    const double depth = s->space;
    gneiss_error error = {0};
    gn_world *w = block_of(s);
    set_elements(w, motion, &depth);
    measured_step(w);
    const whole before = whole_of(w);
    const double size = sqrt(2.0 * before.mass * before.energy);
    if (convert_box(w, low, high, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const whole after = whole_of(w);
    assert_int_equal(w->halt[0], 0);
    assert_near(after.mass, before.mass, 1e-12 * before.mass);
    for (int a = 0; a < 3; a++) {
        assert_near(after.moment[a], before.moment[a], 1e-12 * before.mass * 0.03);
        assert_near(after.momentum[a], before.momentum[a], 1e-12 * size);
        assert_near(after.turning[a], before.turning[a],
                    (turning ? 1e-12 : 1e-3) * turning_scale(&before));
    }
    assert_true(fabs(w->energy.conversion) < 0.05 * before.energy);
    for (int k = 0; k < 5; k++) measured_step(w);
    assert_near(gn_energy_residual(&w->reading), 0.0, 1e-5);
    world_end(w);
}

/* Of blocks that are stretched, sheared, turn, and vibrate (with waves of three elements, of which
 * particles have a fortieth less energy), in the middle, at an edge and at a corner. Where masses
 * would have to change by more than half to keep the inertia, as at corners and edges of elements
 * of two particles, angular momentum is not that of before. */
static void conversions_keep_both_momenta(void **state) {
    (void)state;
    static const double boxes[3][2][3] = {{{12e-3, 6e-3, 0.0}, {16e-3, 10e-3, 1.0}},
                                          {{12e-3, 0.0, 0.0}, {16e-3, 2e-3, 1.0}},
                                          {{0.0, 0.0, 0.0}, {2e-3, 2e-3, 1.0}}};
    field *motions[] = {stretch, turn_and_stretch, stir, shear_about_x};
    const block blocks[] = {
        {.cells = {15, 8, 0}},
        {.cells = {15, 8, 0}, .couple = ", spins: slaved"},
        {.cells = {15, 8, 0}, .finer = 2, .distortion = 0.2},
        {.cells = {15, 8, 0},
         .elements = ", motions: [{name: top, box: {min: [12 mm, 15.9 mm], max: [18 mm, 17 mm]}, "
                     "motion: {vx: 3}}]"},
        {.cells = {12, 6, 6}, .space = true}};
    for (int k = 0; k < 5; k++)
        for (int m = 0; m < 4; m++)
            for (int b = 0; b < 3; b++) {
                if (m == 3 && !blocks[k].space) continue;
                if (k == 3 && (m != 1 || b != 0)) continue; /* moves as what is driven */
                assert_kept(&blocks[k], motions[m], boxes[b][0], boxes[b][1],
                            k != 2 && b < (blocks[k].space ? 1 : 2));
            }
}

/* --- a disordered packing --- */

static gn_world *packed(void) {
    return world_of(
        "dimension: 2\n"
        "specimen: {group: 1, rectangle: {width: 30 mm, height: 16 mm}, mean_radius: 0.5 mm, "
        "density_basis: bulk, packing: {overlap: passive, size_variation: 0.2}}\n"
        "materials: [{name: m, density: 7800, contact_modulus: 24e9, kratio: 3, friction: 0, "
        "tensile_strength: 1e15, shear_strength: 1e15}]\n"
        "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.1, passive_gaps: true}\n"
        "elements: {rectangle: {size: [30 mm, 16 mm], cells: [15, 8]}, materials: [{young: 24e9, "
        "poisson: 0.2, density: 7800}]}\n"
        "couple: {convert: {box: {min: [-1, -1], max: [1, 1]}, width: 6 mm, stress: 1e30, relax: "
        "none}}\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
}

/* Particles of a packing that follow a strain bear what their affine modulus makes of it: of a
 * whole body that converts the mean stress is that of the elements times the quotient of both
 * moduli, and so is the energy, whose difference is booked. Both are
 * sums over the same bonds, the moduli those along the axes. The packing's error is that of its
 * modulus, 24 % here. */
static void a_packing_takes_the_stress_that_its_modulus_makes_of_the_strain(void **state) {
    (void)state;
    const double size = 1e-6, m = 24e9 * 0.8 / (1.2 * 0.6), volume = 30e-3 * 16e-3;
    double quotient = 0.0, stress = 0.0, energy = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        double gradient[9] = {0.0};
        gn_conversion_figures f;
        gneiss_error error = {0};
        gn_world *w = packed();
        gradient[4 * axis] = size;
        assert_int_equal(gn_conversion_measure(w, &f, &error), GNEISS_OK);
        quotient = f.material[0].modulus[0] / f.material[0].modulus[1];
        assert_near(f.material[0].modulus[1], m, 1e-9 * m);
        set_elements(w, strain, gradient);
        convert(w, 0.0, 1.0, 0.0, 1.0);
        assert_int_equal(gn_conversion_elements(w), 0);
        const double booked = w->energy.conversion;
        measured_step(w);
        stress += 0.5 * w->stress[4 * axis] / (m * size);
        energy += 0.5 * (1.0 - booked / (0.5 * m * size * size * volume));
        assert_near(w->reading.conversion, booked, 1e-12 * fabs(booked));
        world_end(w);
    }
    print_message("# quotient of moduli %.4f, of stresses %.4f, of energies %.4f\n", quotient,
                  stress, energy);
    assert_true(quotient > 1.1);
    assert_near(stress, quotient, 0.01 * quotient);
    assert_near(energy, quotient, 0.01 * quotient);
    assert_near(energy, stress, 1e-5 * stress); /* square of strains */
}

/* --- elements without particles --- */

/* A quarter of the spacing: between four particles, of which none is in it nor in a thin zone. */
static const double between[2][3] = {{2e-3, 2e-3, 0.0}, {2.25e-3, 2.25e-3, 1.0}};

static void those_around_go_along_and_what_the_body_has_is_kept(void **state) {
    (void)state;
    gneiss_error error = {0};
    const block fine = {.cells = {5, 4, 0}, .finer = 8, .thin = 1.2e-3};
    const double flat = 0.0;
    gn_world *w = block_of(&fine);
    set_elements(w, stretch, &flat);
    measured_step(w);
    const whole before = whole_of(w);
    const size_t elements = gn_conversion_elements(w);
    assert_int_equal(convert_box(w, between[0], between[1], &error), GNEISS_OK);
    const whole now = whole_of(w);
    print_message("# %zu elements gone\n", elements - gn_conversion_elements(w));
    assert_string_equal(w->halt, "");
    assert_true(elements - gn_conversion_elements(w) > 2);
    assert_near(now.mass, before.mass, 1e-12 * before.mass);
    const double size = sqrt(2.0 * before.mass * before.energy);
    for (int a = 0; a < 3; a++) assert_near(now.momentum[a], before.momentum[a], 1e-12 * size);
    world_end(w);
}

static void too_few_particles_end_the_run_and_leave_it_as_it_was(void **state) {
    (void)state;
    gneiss_error error = {0};
    const block fine = {.cells = {5, 4, 0}, .finer = 8, .thin = 0.3e-3};
    const double flat = 0.0;
    gn_world *w = block_of(&fine);
    set_elements(w, stretch, &flat);
    measured_step(w);
    const size_t elements = gn_conversion_elements(w);
    const uint64_t hash = gn_world_hash(w);
    assert_int_equal(convert_box(w, between[0], between[1], &error), GNEISS_OK);
    assert_true(gn_conversion_was_thin(w) && !gn_conversion_left_box(w));
    assert_true(gn_conversion_elements(w) == elements && gn_world_hash(w) == hash);
    assert_false(gn_conversion_begun(w));
    world_end(w);
}

/* --- elements that may not go --- */

/* Least, over the nodes of elements with nodes of a motion or a load, of what they weigh over what
 * the elements at them do as whole ones. */
static double least_held(const gn_world *w) {
    const gn_fem_solid *b = &w->elements[0]->solid;
    double *mass = calloc(b->nodes.soa.count, sizeof *mass), least = INFINITY;
    uint8_t *kind = calloc(b->elements.soa.count + 1, 1);
    assert_int_equal(gn_conversion_kinds(w, kind, NULL), GNEISS_OK);
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double part = 0.0;
        for (int a = 0; a <= b->dimension; a++)
            part += b->nodes.blend[2 * (size_t)gn_elements_node(&b->elements, a)[e]];
        for (int a = 0; a <= b->dimension; a++)
            mass[gn_elements_node(&b->elements, a)[e]] += density * b->elements.volume[e] / part;
    }
    for (size_t e = 0; e < b->elements.soa.count; e++)
        for (int a = 0; a <= b->dimension && kind[e] == GN_FRONT_HELD; a++) {
            const size_t n = (size_t)gn_elements_node(&b->elements, a)[e];
            least = fmin(least, 1.0 / (b->nodes.vel[4 * n + 3] * mass[n]));
        }
    free(mass);
    free(kind);
    return least;
}

/* Beside a node at (5, 8) mm that is driven, or that bears a load: elements that are small beside
 * particles, of which none is left at the node next to it, which would hang on one or two of them;
 * elements that are as large as particles, which have theirs. A node keeps r/width at least. */
static void assert_held(bool fine, const char *elements, const char *couple, bool space) {
    gneiss_error error = {0};
    const block s = {.cells = {space ? 5 : 6, 4, space ? 2 : 0},
                     .space = space,
                     .finer = !fine   ? 0
                              : space ? 4
                                      : 8,
                     .thin = 3e-3,
                     .elements = elements,
                     .couple = couple};
    const double side = !fine ? 2e-3 : space ? 0.5e-3 : 0.25e-3, flat = 0.0;
    const double low[3] = {2e-3, 4e-3, 0.0}, high[3] = {6e-3 - side, 8e-3, 1.0};
    gn_world *w = block_of(&s);
    set_elements(w, stretch, &flat);
    measured_step(w);
    const size_t elements_before = gn_conversion_elements(w);
    const uint64_t hash = gn_world_hash(w);
    assert_int_equal(convert_box(w, low, high, &error), GNEISS_OK);
    print_message("# %s: least %.3g %s\n", fine ? "fine" : "coarse", least_held(w), w->halt);
    assert_true(fine == (w->halt[0] != '\0'));
    assert_true(least_held(w) >= 0.5e-3 / s.thin);
    assert_true(fine == (gn_conversion_elements(w) == elements_before));
    if (fine) {
        assert_non_null(strstr(w->halt, "conversion would leave 0.0"));
        assert_non_null(strstr(w->halt, "which has nodes of a motion or a load"));
        assert_true(gn_world_hash(w) == hash);
    }
    world_end(w);
}

static void no_node_of_elements_that_may_not_go_is_left_bare(void **state) {
    (void)state;
    static const char box[] = "box: {min: [5.9 mm, 7.9 mm, 0], max: [6.1 mm, 8.1 mm, %s]}, ";
    char at[96], driven[256], loaded[256];
    for (int space = 0; space < 2; space++)
        for (int fine = 0; fine < 2; fine++) {
            snprintf(at, sizeof at, box, space ? "4.1 mm" : "0");
            snprintf(driven, sizeof driven, ", motions: [{name: top, %smotion: {vx: 0, vy: -1}}]",
                     at);
            snprintf(loaded, sizeof loaded, ", loads: [{%sforce: {fy: -1}}]", at);
            assert_held(fine, driven, NULL, space);
            assert_held(fine, loaded, ", spins: slaved", space);
        }
}

static void places_that_are_looked_at_stay_as_they_were(void **state) {
    (void)state;
    const double thin[] = {0.3e-3, 1.2e-3, 3e-3};
    for (int k = 0; k < 3; k++) {
        gneiss_error error = {0};
        gn_conversion_places_seen seen;
        const block fine = {.cells = {5, 4, 0}, .finer = 8, .thin = thin[k]};
        gn_world *w = block_of(&fine);
        const uint64_t hash = gn_world_hash(w);
        assert_int_equal(gn_conversion_see_places(w, &seen, &error), GNEISS_OK);
        print_message("# zone of %g m: %zu places, at %zu others go along, %zu cannot\n", thin[k],
                      seen.looked, seen.along, seen.too_few);
        assert_true(seen.looked >= 50 && seen.looked <= 100);
        assert_true(k == 0 ? seen.too_few > 0 : seen.too_few == 0);
        assert_true(k == 1 ? seen.along > 0 : k == 0 || seen.along == 0);
        assert_string_equal(w->halt, "");
        assert_true(gn_world_hash(w) == hash && !gn_conversion_begun(w));
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(those_around_go_along_and_what_the_body_has_is_kept),
        cmocka_unit_test(too_few_particles_end_the_run_and_leave_it_as_it_was),
        cmocka_unit_test(no_node_of_elements_that_may_not_go_is_left_bare),
        cmocka_unit_test(places_that_are_looked_at_stay_as_they_were),
        cmocka_unit_test(slaved_spins_of_new_zones_are_in_the_step),
        cmocka_unit_test(conversions_keep_both_momenta),
        cmocka_unit_test(a_packing_takes_the_stress_that_its_modulus_makes_of_the_strain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
