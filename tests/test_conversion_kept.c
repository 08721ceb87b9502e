/* Quantities that conversions preserve, and the step after them. */
#include "conversion_helpers.h"
#include "solids/dormant_places.h"

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

/* Returns the energy after a number of steps over that at the start; INFINITY if the run failed. */
static double energy_after(gn_world *w, int steps) {
    gneiss_error error = {0};
    gn_energy e = measured_step(w);
    const double start = gn_energy_stored(&e);
    double grown = 0.0;
    for (int k = 0; k < steps && isfinite(grown); k++)
        if (gn_world_step(w, k == steps - 1, &error) != GNEISS_OK) grown = INFINITY;
    if (isfinite(grown)) grown = gn_energy_stored(&w->ledger.reading) / start;
    world_end(w);
    return grown;
}

/* Slaved spins add springs without inertia: with the separate limits of particles and elements the
 * model is unstable. */
static void slaved_spins_of_new_zones_are_in_the_step(void **state) {
    (void)state;
    char time[96];
    gn_world *w = spun(NULL);
    const double stable = w->ctx.stable,
                 sides = fmin(w->ctx.choice.stable, gn_elements_stable(&w->solids));
    assert_true(stable < 0.5 * sides);
    assert_near(w->ctx.dt, w->ctx.scene.safety * stable, 1e-12 * stable);
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

/* N m s: scale of the rounding of angular momentum. */
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
    assert_int_equal(w->outcome.halt[0], 0);
    assert_near(after.mass, before.mass, 1e-12 * before.mass);
    for (int a = 0; a < 3; a++) {
        assert_near(after.moment[a], before.moment[a], 1e-12 * before.mass * 0.03);
        assert_near(after.momentum[a], before.momentum[a], 1e-12 * size);
        assert_near(after.turning[a], before.turning[a],
                    (turning ? 1e-12 : 1e-3) * turning_scale(&before));
    }
    assert_true(fabs(w->ledger.energy.conversion) < 0.05 * before.energy);
    for (int k = 0; k < 5; k++) measured_step(w);
    assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-5);
    world_end(w);
}

/* Blocks are stretched, sheared, rotate, and vibrate (with waves of three elements, for which
 * particles have a fortieth less energy), and convert in the middle, at an edge and at a corner.
 * Where masses would have to change by more than half to keep the inertia, as at corners and edges
 * of elements of two particles, angular momentum is not preserved. */
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
                if (k == 3 && (m != 1 || b != 0))
                    continue; /* the particle moves with the driven nodes */
                assert_kept(&blocks[k], motions[m], boxes[b][0], boxes[b][1],
                            k != 2 && b < (blocks[k].space ? 1 : 2));
            }
}

/* --- changes at conversions --- */

static void fly(const double *x, const void *of, double u[3], double v[3]) {
    const double *way = of;
    move_rigidly(x, turned, u, v);
    v[0] += *way;
}

/* Angular momentum and, about the axis z, inertia about its own centre. */
typedef struct own {
    double centre[3], turning[3], inertia;
} own;

static own own_of(const gn_world *w) {
    const whole s = whole_of(w);
    own o = {.inertia = s.inertia};
    double lever[3];
    for (int a = 0; a < 3; a++) o.centre[a] = s.moment[a] / s.mass;
    gn_cross3(o.centre, s.momentum, lever);
    for (int a = 0; a < 3; a++) o.turning[a] = s.turning[a] - lever[a];
    o.inertia -= s.mass * (o.centre[0] * o.centre[0] + o.centre[1] * o.centre[1]);
    return o;
}

/* In 2D, m v r of the velocities minus the rigid motion. */
static double vibration_of(const gn_world *w) {
    const whole s = whole_of(w);
    const own o = own_of(w);
    const double left = s.energy - 0.5 * gn_dot3(s.momentum, s.momentum) / s.mass -
                        0.5 * o.turning[2] * o.turning[2] / o.inertia;
    return sqrt(2.0 * fmax(left, 0.0) * o.inertia);
}

static const double corners[3][2][3] = {{{0.0, 0.0, 0.0}, {2e-3, 2e-3, 2e-3}},
                                        {{12e-3, 6e-3, 0.0}, {16e-3, 10e-3, 4e-3}},
                                        {{26e-3, 0.0, 0.0}, {30e-3, 2e-3, 2e-3}}};

/* Converts at corners and in the middle, and sums the changes of the whole body; [2] N m s: the
 * largest change of angular momentum; the largest angular momentum, or that of its vibration. */
static gn_world *convert_and_sum(const block *s, field *motion, const void *of, own *sum,
                                 double size[2]) {
    gn_world *w = block_of(s);
    gneiss_error error = {0};
    *sum = (own){0};
    set_elements(w, motion, of);
    measured_step(w);
    for (int k = 0; k < 3; k++) {
        const own was = own_of(w);
        const double vibration = vibration_of(w);
        if (convert_box(w, corners[k][0], corners[k][1], &error) != GNEISS_OK)
            fail_msg("%s", error.message);
        const own is = own_of(w);
        for (int a = 0; a < 3; a++) sum->centre[a] += is.centre[a] - was.centre[a];
        for (int a = 0; a < 3; a++) sum->turning[a] += is.turning[a] - was.turning[a];
        sum->inertia += is.inertia / was.inertia - 1.0;
        size[0] = fmax(size[0], sqrt(gn_dot3(sum->turning, sum->turning)));
        size[1] = fmax(size[1], sqrt(gn_dot3(was.turning, was.turning)));
        if (!s->space) size[1] = fmax(size[1], vibration);
    }
    assert_string_equal(w->outcome.halt, "");
    return w;
}

static void changes_of_the_whole_body_by_conversions_are_summed(void **state) {
    (void)state;
    field *motions[] = {fly, turn_and_stretch, stir};
    const block blocks[] = {{.cells = {15, 8, 0}},
                            {.cells = {15, 8, 0}, .couple = ", spins: slaved"},
                            {.cells = {15, 8, 0}, .finer = 2, .distortion = 0.2, .thin = 3e-3},
                            {.cells = {15, 4, 4}, .space = true}};
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 3; m++) {
            const double of = m == 0 ? 20.0 : blocks[k].space;
            double size[2] = {0.0};
            own sum;
            gn_world *w = convert_and_sum(&blocks[k], motions[m], &of, &sum, size);
            const gn_corrections *c = &w->converted.corrected;
            const whole now = whole_of(w);
            const double rounding = 1e-11 * sqrt(2.0 * now.mass * now.energy) * 0.03;
            print_message("# block %d, motion %d: %.3g of %.3g N m s, %.3g m, %.3g\n", k, m,
                          c->most, c->scale, c->centre[0], c->inertia);
            for (int a = 0; a < 3; a++) assert_near(c->turned[a], sum.turning[a], rounding);
            for (int a = 0; a < 3; a++) assert_near(c->centre[a], sum.centre[a], 1e-14);
            if (!blocks[k].space) assert_near(c->inertia, sum.inertia, 1e-11);
            assert_near(c->most, size[0], rounding);
            if (blocks[k].space)
                assert_true(c->scale > size[1] - rounding);
            else
                assert_near(c->scale, size[1], 1e-6 * size[1]);
            world_end(w);
        }
}

/* A translating and rotating body keeps its motion: its angular momentum about its centre changes
 * by the same fraction as its inertia, at any speed. */
static void a_rigidly_moving_body_keeps_its_spin(void **state) {
    (void)state;
    const block s = {.cells = {15, 8, 0}};
    double change[2];
    for (int k = 0; k < 2; k++) {
        const double way = k ? 1000.0 : 0.0;
        double size[2] = {0.0};
        own sum;
        gn_world *w = convert_and_sum(&s, fly, &way, &sum, size);
        const gn_corrections *c = &w->converted.corrected;
        change[k] = c->turned[2];
        assert_true(fabs(c->inertia) > 1e-6);
        assert_near(c->turned[2] / c->scale, c->inertia, 1e-3 * fabs(c->inertia));
        world_end(w);
    }
    assert_near(change[1], change[0], 1e-6 * fabs(change[0]));
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

static double sum_of(const gn_conversion_parts *p) {
    return p->sampled + p->stiffness + p->uneven + p->balance + p->motion + p->step;
}

/* Particles of a packing that follow a strain have the stress of their affine modulus: if a whole
 * body converts, the mean stress is that of the elements times the ratio of both moduli, and so is
 * the energy; the difference is booked. Both are sums over the same bonds, with moduli along the
 * axes. The error of the packing is that of its modulus, 24 % here. */
static void a_packing_takes_the_stress_that_its_modulus_makes_of_the_strain(void **state) {
    (void)state;
    const double size = 1e-6, m = 24e9 * 0.8 / (1.2 * 0.6), volume = 30e-3 * 16e-3;
    double quotient = 0.0, stress = 0.0, energy = 0.0, alike = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        double gradient[9] = {0.0};
        gn_conversion_figures f;
        gneiss_error error = {0};
        gn_world *w = packed();
        gradient[4 * axis] = size;
        assert_int_equal(
            gn_conversion_measure(&w->ctx, &w->dem, &w->boundary, &w->solids, &f, &error),
            GNEISS_OK);
        quotient = f.material[0].modulus[0] / f.material[0].modulus[1];
        assert_near(f.material[0].modulus[1], m, 1e-9 * m);
        set_elements(w, strain, gradient);
        convert(w, 0.0, 1.0, 0.0, 1.0);
        assert_int_equal(gn_elements_left_count(&w->solids), 0);
        const double booked = w->ledger.energy.conversion;
        measured_step(w);
        stress += 0.5 * w->ledger.stress[4 * axis] / (m * size);
        energy += 0.5 * (1.0 - booked / (0.5 * m * size * size * volume));
        const gn_conversion_parts *p = &w->converted.parts;
        alike += 0.5 * p->alike[1] / p->alike[0];
        assert_near(p->stiffness, booked, 1e-5 * fabs(booked));
        assert_near(sum_of(p), booked, 1e-12 * p->alike[0]);
        assert_near(w->ledger.reading.conversion, booked, 1e-12 * fabs(booked));
        world_end(w);
    }
    print_message("# quotient of moduli %.4f, of stresses %.4f, of energies %.4f\n", quotient,
                  stress, energy);
    assert_true(quotient > 1.1);
    assert_near(stress, quotient, 0.01 * quotient);
    assert_near(energy, quotient, 0.01 * quotient);
    assert_near(energy, stress, 1e-5 * stress); /* square of strains */
    assert_near(alike, quotient, 1e-5 * quotient);
}

/* --- causes of the booked energy --- */

static gn_world *lattice_of(double stiffer, double kratio, const char *more) {
    return world_of(
        "dimension: 2\n"
        "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [30, 16]}}\n"
        "materials: [{name: m, density: %.17g, normal_stiffness: %g, kratio: %g, friction: 0.2, "
        "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
        "elements: {rectangle: {size: [30 mm, 16 mm], cells: [15, 8]}, materials: [{young: %g, "
        "poisson: 0, density: %g}]}\n"
        "couple: {convert: {box: {min: [-1, -1], max: [1, 1]}, width: 3 mm, stress: 1e30}%s}\n"
        "time: {end: 1}\nrun: {threads: 1}\n",
        density / (pi / 4.0), stiffer * modulus, kratio, modulus, density, more);
}

/* Inside a body, far from its sides, a lattice has the moduli k_n along its axes and k_t/2 across
 * them, elements E and E/2. In a uniform strain only the volume of a zone is booked, which
 * particles represent in discrete steps. */
static void springs_of_another_stiffness_are_reported_with_their_ratio(void **state) {
    (void)state;
    const struct {
        double stiffer, kratio, gradient[9], alike;
    } cases[] = {{1.0, 1.0, {1e-6}, 1.0},
                 {1.5, 1.0, {1e-6}, 1.5},
                 {0.7, 3.0, {1e-6, 0.0, 0.0, 0.0, 2e-6}, 0.7},
                 {1.0, 4.0, {0.0, 1e-6, 0.0, 1e-6}, 0.25},
                 {1.2, 2.0, {0.0, 2e-6}, 0.6}}; /* this field includes a rotation */
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_world *w = lattice_of(cases[k].stiffer, cases[k].kratio, "");
        set_elements(w, strain, cases[k].gradient);
        convert(w, 12e-3, 18e-3, 6e-3, 10e-3);
        const gn_conversion_parts *p = &w->converted.parts;
        print_message("# held %.6g times as much; stiffness %.3g, volume %.2g, uneven %.2g, "
                      "balance %.2g of %.3g J\n",
                      p->alike[1] / p->alike[0], p->stiffness, p->sampled, p->uneven, p->balance,
                      p->alike[0]);
        /* Volumes are parts of the hull of the discs, which is round at corners. */
        const double hull = w->ctx.volume / (30e-3 * 16e-3);
        assert_near(p->alike[1] * hull, cases[k].alike * p->alike[0], 1e-5 * p->alike[0]);
        assert_near(p->stiffness, p->alike[0] - p->alike[1], 1e-12 * p->alike[0]);
        assert_near(p->uneven, 0.0, 1e-5 * p->alike[0]);
        assert_near(p->sampled, 0.0, 0.05 * p->alike[0]);
        assert_true(p->balance >= 0.0);
        assert_near(sum_of(p), w->ledger.energy.conversion, 1e-12 * p->alike[0]);
        world_end(w);
    }
}

/* A strain that varies along the body differs between the two ends of a bond. */
static void bend(const double *x, const void *of, double u[3], double v[3]) {
    const double *k = of;
    u[0] = k[0] * x[0] * (x[1] - 8e-3);
    u[1] = -0.5 * k[0] * x[0] * x[0];
    v[0] = k[1] * x[1];
    v[1] = -2.0 * k[1] * x[0];
}

/* The parts add up to the booked energy with every other effect present, for one conversion and for
 * several. */
static void parts_of_the_booked_energy_add_up(void **state) {
    (void)state;
    const double still[] = {1e-4, 0.0}, moving[] = {1e-4, 5.0};
    const char *more[] = {", spins: slaved", ""};
    for (int k = 0; k < 4; k++) {
        gn_world *w = k < 2 ? lattice_of(1.3, 2.0, more[k]) : packed();
        set_elements(w, bend, k % 2 ? moving : still);
        run_steps(w, 1);
        convert(w, 12e-3, 16e-3, 6e-3, 16e-3);
        const double first = w->ledger.energy.conversion;
        assert_near(sum_of(&w->converted.parts), first, 1e-10 * fabs(first));
        run_steps(w, 20);
        convert(w, 10e-3, 20e-3, 4e-3, 16e-3);
        const gn_conversion_parts *p = &w->converted.parts;
        print_message("# stiffness %.3g, volume %.2g, uneven %.2g, balance %.2g, motion %.2g, step "
                      "%.2g: %.3g J\n",
                      p->stiffness, p->sampled, p->uneven, p->balance, p->motion, p->step,
                      w->ledger.energy.conversion);
        assert_true(fabs(w->ledger.energy.conversion - first) > 0.1 * fabs(first));
        assert_near(sum_of(p), w->ledger.energy.conversion,
                    1e-10 * fabs(w->ledger.energy.conversion));
        assert_near(p->motion, w->converted.corrected.energy, 1e-12 * fabs(p->motion));
        assert_true(p->uneven != 0.0 && (k < 2) == (p->balance != 0.0));
        world_end(w);
    }
}

/* --- elements without particles --- */

/* Nodes at a quarter of the spacing: between four particles, none of which is in the element or in
 * a thin zone. */
static const double between[2][3] = {{2e-3, 2e-3, 0.0}, {2.25e-3, 2.25e-3, 1.0}};

static void neighbours_convert_as_well_and_the_invariants_of_the_body_are_kept(void **state) {
    (void)state;
    gneiss_error error = {0};
    const block fine = {.cells = {5, 4, 0}, .finer = 8, .thin = 1.2e-3};
    const double flat = 0.0;
    gn_world *w = block_of(&fine);
    set_elements(w, stretch, &flat);
    measured_step(w);
    const whole before = whole_of(w);
    const size_t elements = gn_elements_left_count(&w->solids);
    assert_int_equal(convert_box(w, between[0], between[1], &error), GNEISS_OK);
    const whole now = whole_of(w);
    print_message("# %zu elements gone\n", elements - gn_elements_left_count(&w->solids));
    assert_string_equal(w->outcome.halt, "");
    assert_true(elements - gn_elements_left_count(&w->solids) > 2);
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
    const size_t elements = gn_elements_left_count(&w->solids);
    const uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    assert_int_equal(convert_box(w, between[0], between[1], &error), GNEISS_OK);
    assert_true(gn_conversion_lacked_mass(&w->outcome) && !gn_conversion_ended_at_box(&w->outcome));
    assert_true(gn_elements_left_count(&w->solids) == elements &&
                gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == hash);
    assert_false(gn_elements_have_left(&w->solids));
    world_end(w);
}

/* --- elements that may not go --- */

/* The smallest ratio of the mass of a node to that of the whole elements at it, over nodes of
 * elements that have a node with a motion or a load. */
static double least_held(const gn_world *w) {
    const gn_fem_solid *b = &w->solids.elements[0]->solid;
    double *mass = calloc(b->nodes.soa.count, sizeof *mass), least = INFINITY;
    uint8_t *kind = calloc(b->elements.soa.count + 1, 1);
    assert_int_equal(gn_conversion_kinds(&w->ctx, &w->solids, kind, NULL), GNEISS_OK);
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

/* Beside a node at (5, 8) mm that is driven or loaded: elements that are small relative to
 * particles, none of which remains at the next node, which would be supported by one or two of
 * them; or they are as large as particles, and contain their own. A node keeps at least r/width of
 * its mass. */
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
    const size_t elements_before = gn_elements_left_count(&w->solids);
    const uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    assert_int_equal(convert_box(w, low, high, &error), GNEISS_OK);
    print_message("# %s: least %.3g %s\n", fine ? "fine" : "coarse", least_held(w),
                  w->outcome.halt);
    assert_true(fine == (w->outcome.halt[0] != '\0'));
    assert_true(least_held(w) >= 0.5e-3 / s.thin);
    assert_true(fine == (gn_elements_left_count(&w->solids) == elements_before));
    if (fine) {
        assert_non_null(strstr(w->outcome.halt, "conversion would leave 0.0"));
        assert_non_null(strstr(w->outcome.halt, "which has nodes of a motion or a load"));
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == hash);
    }
    world_end(w);
}

static void nodes_of_elements_that_stay_keep_some_mass(void **state) {
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

/* The nodes at (14, 8) mm are recorded: although they are few, not all of the body can convert. */
static void motions_that_only_record_are_named(void **state) {
    (void)state;
    static const char at[] = "box: {min: [13.9 mm, 7.9 mm, 0], max: [14.1 mm, 8.1 mm, %s]}",
                      aside[] = "{min: [16 mm, -1, -1], max: [1, 1, 1]}";
    for (int space = 0; space < 2; space++)
        for (int k = 0; k < 4; k++) {
            char motions[512], box[128], said[512];
            gneiss_error error = {0};
            const double low[3] = {0.0}, high[3] = {1.0, 1.0, 1.0};
            snprintf(box, sizeof box, at, space ? "1" : "0");
            snprintf(motions, sizeof motions, ", motions: [{name: gauge, %s%s}%s%s%s]", box,
                     k == 1 ? ", motion: {vx: 0}" : "", k == 2 ? ", {name: arm, " : "",
                     k == 2 ? box : "", k == 2 ? ", motion: {vx: 0}}" : "");
            const block s = {.cells = {15, 8, space ? 2 : 0},
                             .space = space,
                             .elements = motions,
                             .box = k < 3   ? NULL
                                    : space ? aside
                                            : "{min: [16 mm, -1], max: [1, 1]}"};
            gn_world *w = block_of(&s);
            assert_string_equal(gn_conversion_watches(&w->ctx, &w->solids, said, sizeof said),
                                said);
            assert_true((k == 0) == (strstr(said, "'gauge', which only watches") != NULL));
            assert_true((k == 0) == (said[0] != '\0'));
            assert_int_equal(convert_box(w, low, high, &error), GNEISS_OK);
            print_message("# %s\n", w->outcome.halt);
            assert_true((k == 0) == gn_conversion_reached_watched(&w->outcome));
            assert_true((k == 0) ==
                        (strstr(w->outcome.halt,
                                "nodes of motion 'gauge', which is only watched") != NULL));
            assert_true((k == 1 || k == 2) ==
                        (strstr(w->outcome.halt, "has nodes of a motion or a load") != NULL));
            world_end(w);
        }
}

static void checking_places_does_not_change_the_state(void **state) {
    (void)state;
    const double thin[] = {0.3e-3, 1.2e-3, 3e-3};
    for (int k = 0; k < 3; k++) {
        gneiss_error error = {0};
        gn_conversion_places_checked seen;
        const block fine = {.cells = {5, 4, 0}, .finer = 8, .thin = thin[k]};
        gn_world *w = block_of(&fine);
        const uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
        const gn_convertible model = gn_world_convertible(w);
        assert_int_equal(gn_conversion_check_places(&model, &seen, &error), GNEISS_OK);
        print_message("# zone of %g m: %zu places, at %zu others go along, %zu cannot\n", thin[k],
                      seen.looked, seen.along, seen.too_few);
        assert_true(seen.looked >= 50 && seen.looked <= 100);
        assert_true(k == 0 ? seen.too_few > 0 : seen.too_few == 0);
        assert_true(k == 1 ? seen.along > 0 : k == 0 || seen.along == 0);
        assert_string_equal(w->outcome.halt, "");
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == hash &&
                    !gn_elements_have_left(&w->solids));
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_convert_as_well_and_the_invariants_of_the_body_are_kept),
        cmocka_unit_test(too_few_particles_end_the_run_and_leave_it_as_it_was),
        cmocka_unit_test(nodes_of_elements_that_stay_keep_some_mass),
        cmocka_unit_test(motions_that_only_record_are_named),
        cmocka_unit_test(checking_places_does_not_change_the_state),
        cmocka_unit_test(slaved_spins_of_new_zones_are_in_the_step),
        cmocka_unit_test(conversions_keep_both_momenta),
        cmocka_unit_test(changes_of_the_whole_body_by_conversions_are_summed),
        cmocka_unit_test(a_rigidly_moving_body_keeps_its_spin),
        cmocka_unit_test(a_packing_takes_the_stress_that_its_modulus_makes_of_the_strain),
        cmocka_unit_test(springs_of_another_stiffness_are_reported_with_their_ratio),
        cmocka_unit_test(parts_of_the_booked_energy_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
