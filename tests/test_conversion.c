/* Finite elements that convert to particles during a run. */
#include "base/memory.h"
#include "conversion_helpers.h"
#include "limit/springs.h"
#include "particles/dormant.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "parts.h"
#include "run/spacing.h"
#include "run/warnings.h"
#include "run_helpers.h"
#include "solids/dormant_places.h"
#include "timestep/timestep_private.h"

#include <unistd.h>

/* --- rigid motion --- */

static void assert_rigid(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    size_t free = 0, tied = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        double u[3] = {0}, v[3] = {0};
        if (!is_active(w, p)) continue;
        move_rigidly(q->start + 4 * p, turned, u, v);
        *(is_tied(w, p) ? &tied : &free) += 1;
        for (size_t a = 0; a < 3; a++) {
            assert_near(q->pos[4 * p + a], q->start[4 * p + a] + u[a], 1e-16);
            assert_near(q->vel[4 * p + a], v[a], 1e-12 * 3.0);
            if (q->spin) assert_near(q->spin[4 * p + a], a == 2 ? turned[3] : 0.0, 1e-12 * 50.0);
        }
    }
    assert_true(free > 0 && tied > 0);
}

/* Rounding of coordinates of some cm, multiplied by stiffnesses. */
static void assert_no_force(const gn_world *w) {
    const gn_contacts *lists[] = {&w->dem.bonds.contacts, &w->dem.pairs.contacts};
    const double rounding = 64.0 * 2.2e-16 * 0.04;
    for (int l = 0; l < 2; l++)
        for (size_t c = 0; c < lists[l]->soa.count; c++) {
            const gn_contacts *k = lists[l];
            double d[3], shear[3];
            double length = sqrt(gn_branch(&w->ctx, w->dem.particles.pos + 4 * k->i[c],
                                           w->dem.particles.pos + 4 * k->j[c], d));
            if (k->length0) assert_near(length, k->length0[c], rounding);
            if (k->shear) assert_near(shear_of(k, c, shear), 0.0, k->kn[c] * rounding);
        }
}

static void convert_moving(const block *s) {
    gn_world *w = block_of(s);
    set_elements(w, move_rigidly, turned);
    const whole before = whole_of(w);
    convert(w, 8e-3, 12e-3, 0.0, 1.0);
    const whole after = whole_of(w);
    assert_rigid(w);
    assert_no_force(w);
    assert_near(after.mass, before.mass, 1e-12 * before.mass);
    for (int a = 0; a < 3; a++) {
        assert_near(after.moment[a], before.moment[a], 1e-12 * before.mass * 0.04);
        assert_near(after.momentum[a], before.momentum[a], 1e-12 * before.mass * 5.0);
    }
    /* The angular momentum of a rigid motion by v0 and w is x0 x v0 m + w I about the origin. */
    assert_near(after.turning[2] - before.turning[2], turned[3] * (after.inertia - before.inertia),
                1e-11 * before.mass * 0.04 * 5.0);
    const double more = 0.5 * turned[3] * turned[3] * (after.inertia - before.inertia);
    assert_near(after.energy - before.energy, more, 1e-11 * before.energy);
    assert_near(w->ledger.energy.conversion, -more, 1e-11 * before.energy);
    world_end(w);
}

static void a_block_that_moves_and_turns_becomes_particles_that_do(void **state) {
    (void)state;
    convert_moving(&plate);
    convert_moving(&cube);
}

static void a_block_at_rest_becomes_particles_at_rest(void **state) {
    (void)state;
    gn_world *w = block_of(&plate);
    convert(w, 8e-3, 12e-3, 0.0, 1.0);
    run_steps(w, 100);
    const gn_particles *all[] = {&w->dem.particles, &w->solids.elements[0]->solid.nodes};
    for (int k = 0; k < 2; k++)
        for (size_t p = 0; p < all[k]->soa.count; p++)
            for (size_t a = 0; a < 3; a++) {
                assert_near(all[k]->pos[4 * p + a], all[k]->start[4 * p + a], 1e-15);
                assert_near(all[k]->vel[4 * p + a], 0.0, 1e-9);
            }
    world_end(w);
}

/* Blocks that also contain active particles are included. */
static void dormant_particles_have_no_contacts_and_do_not_move(void **state) {
    (void)state;
    block s = plate;
    s.rest = "gravity: [0, -9.81]\nrun: {threads: 1}\n";
    gn_world *w = block_of(&s);
    run_steps(w, 10);
    assert_int_equal(w->dem.contact_steps, 0);
    convert(w, 14e-3, 16e-3, 0.0, 2e-3);
    run_steps(w, 100);
    const gn_particles *q = &w->dem.particles;
    const gn_contacts *lists[] = {&w->dem.bonds.contacts, &w->dem.pairs.contacts};
    size_t asleep = 0, mixed = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_is_dormant(&w->dem, p)) continue;
        asleep++;
        mixed += !w->dem.still[p / GN_PARTICLE_BLOCK];
        for (size_t a = 0; a < 3; a++) {
            assert_true(q->pos[4 * p + a] == q->start[4 * p + a]);
            assert_true(q->vel[4 * p + a] == 0.0);
        }
    }
    assert_true(asleep > mixed && mixed > 0);
    assert_int_equal(asleep + gn_dem_present_count(&w->dem), q->soa.count);
    for (int l = 0; l < 2; l++)
        for (size_t c = 0; c < lists[l]->soa.count; c++)
            assert_false(gn_is_dormant(&w->dem, (size_t)lists[l]->i[c]) ||
                         gn_is_dormant(&w->dem, (size_t)lists[l]->j[c]));
    world_end(w);
}

/* --- strain --- */

/* Each bond carries the stress of the elements over the section of a lattice plane, up to the
 * square of the strain and the rounding of places, and has its share of it. */
static void assert_strained(const gn_world *w, const double gradient[9], double size) {
    const gn_contacts *k = &w->dem.bonds.contacts;
    const double section = w->ctx.scene.dimension == 3 ? spacing * spacing : spacing;
    size_t free = 0;
    for (size_t c = 0; c < k->soa.count; c++) {
        const double *a = w->dem.particles.pos + 4 * k->i[c],
                     *b = w->dem.particles.pos + 4 * k->j[c];
        double d[3], shear[3], length = sqrt(gn_branch(&w->ctx, a, b, d));
        const double part =
            0.5 * (w->dem.particles.blend[2 * k->i[c]] + w->dem.particles.blend[2 * k->j[c]]);
        shear_of(k, c, shear);
        free += part == 1.0;
        for (int r = 0; r < 3; r++) {
            double stress = 0.0,
                   force = k->kn[c] * (length - k->length0[c]) * d[r] / length + shear[r];
            for (int m = 0; m < 3; m++)
                stress +=
                    modulus * 0.5 * (gradient[3 * r + m] + gradient[3 * m + r]) * d[m] / length;
            assert_near(force / (part * modulus * section), stress / modulus,
                        4.0 * size * size + 64.0 * 2.2e-16 * 0.03 / spacing);
        }
    }
    assert_true(free > 0);
}

/* Particles move with their elements, without relaxation; the imbalance that then remains, as at
 * free sides, is tested in test_relaxation.c. */
static block unrelaxed(const block *s) {
    block as_it_is = *s;
    as_it_is.convert = "stress: 1e30, relax: none";
    return as_it_is;
}

static void a_strained_block_becomes_particles_under_its_stress(void **state) {
    (void)state;
    const double gradients[3][9] = {
        {1e-6, 0, 0, 0, -2e-6, 0, 0, 0, 0},
        {0, 2e-6, 0, 0, 0, 0, 0, 0, 0}, /* this field shears and rotates */
        {1e-6, 3e-6, 0, -1e-6, 2e-6, 0, 0, 0, 0}};
    for (int k = 0; k < 6; k++) {
        const block s = unrelaxed(k / 3 ? &cube : &plate);
        gn_world *w = block_of(&s);
        set_elements(w, strain, gradients[k % 3]);
        convert(w, 8e-3, 12e-3, 0.0, 1.0);
        assert_strained(w, gradients[k % 3], 4e-6);
        world_end(w);
    }
}

/* Particles of a zone get new weights as the front advances: in the end they carry the whole
 * stress. */
static void a_zone_that_is_passed_carries_all_of_the_stress(void **state) {
    (void)state;
    const double gradient[9] = {1e-6, 2e-6, 0, 0, 2e-6, 0, 0, 0, 0};
    const block s = unrelaxed(&plate);
    gn_world *w = block_of(&s);
    set_elements(w, strain, gradient);
    for (int k = 4; k < 8; k++) {
        convert(w, 2e-3 * k, 2e-3 * k + 2e-3, 0.0, 1.0);
        assert_strained(w, gradient, 4e-6);
    }
    world_end(w);
}

/* --- invariants --- */

/* Linear momentum is conserved to rounding at all times; energy is conserved including what
 * conversions book, apart from half a step of work at each. */
static void converting_keeps_momentum_and_books_energy(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        const double depth = space;
        gn_world *w = block_of(space ? &cube : &plate);
        set_elements(w, stir, &depth);
        measured_step(w);
        const whole before = whole_of(w);
        double worst = 0.0;
        for (int k = 0; k < 4; k++) {
            run_steps(w, 50);
            convert(w, (6 + 2 * k) * 1e-3, (8 + 2 * k) * 1e-3, 0.0, 1.0);
            for (int m = 0; m < 20; m++) {
                gn_energy e = measured_step(w);
                worst = fmax(worst, fabs(gn_energy_residual(&e)));
            }
        }
        const whole after = whole_of(w);
        assert_near(after.mass, before.mass, 1e-12 * before.mass);
        for (int a = 0; a < 3; a++)
            assert_near(after.momentum[a], before.momentum[a], 1e-12 * before.mass * 5e-3);
        assert_true(worst < 1e-5);
        world_end(w);
    }
}

static void bounds_of(const gn_fem_solid *b, size_t e, double low[3], double high[3]) {
    for (int k = 0; k < b->dimension; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (int a = 0; a <= b->dimension; a++) {
            const double x =
                b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + (size_t)k];
            low[k] = fmin(low[k], x);
            high[k] = fmax(high[k], x);
        }
    }
}

/* Finds the element nearest to a point among those in which no particle starts. */
static void find_empty(const gn_world *w, const double near[3], double low[3], double high[3]) {
    const gn_fem_solid *b = &w->solids.elements[0]->solid;
    double least = INFINITY;
    size_t mesh;
    gn_free(gn_fem_places(b, &mesh));
    uint8_t *holds = calloc(mesh, 1);
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        holds[gn_dormant_element(&w->dem, p)] = 1;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double lower[3] = {0.0}, upper[3] = {0.0}, d2 = 0.0;
        bounds_of(b, e, lower, upper);
        for (int k = 0; k < b->dimension; k++)
            d2 += pow(0.5 * (lower[k] + upper[k]) - near[k], 2.0);
        if (holds[b->elements.id[e]] || d2 >= least) continue;
        least = d2;
        memcpy(low, lower, sizeof lower);
        memcpy(high, upper, sizeof upper);
    }
    free(holds);
    assert_true(least < INFINITY);
}

static void turn_alone(const double *x, const void *of, double u[3], double v[3]) {
    (void)of;
    move_rigidly(x, turned, u, v);
}

static void assert_driven_go_on(const gn_world *w, double speed) {
    const gn_fem_solid *b = &w->solids.elements[0]->solid;
    for (size_t n = 0; b->prescribed.count && n < b->nodes.soa.count; n++)
        if (b->nodes.slot[n] >= 0) assert_true(b->nodes.vel[4 * n] == speed);
}

/* m/s: the most that the velocity of a node changes by as the elements between two corners convert.
 */
static double most_changed(gn_world *w, const double low[3], const double high[3]) {
    const gn_particles *nodes = &w->solids.elements[0]->solid.nodes;
    const size_t count = nodes->soa.count;
    gneiss_error error = {0};
    double *before = malloc(4 * (count + 1) * sizeof *before), most = 0.0;
    memcpy(before, nodes->vel, 4 * count * sizeof *before);
    if (convert_box(w, low, high, &error) != GNEISS_OK) fail_msg("%s", error.message);
    for (size_t n = 0; n < 4 * count; n++)
        if (n % 4 < 3 && nodes->vel[n / 4 * 4 + 3] > 0.0)
            most = fmax(most, fabs(nodes->vel[n] - before[n]));
    free(before);
    return most;
}

/* A row of elements smaller than particles converts, far from the origin, in a vibrating body: only
 * a few particles and nodes can correct the missing momentum each time, and none of them may get a
 * large velocity. */
static void conversion_creates_no_spurious_velocities(void **state) {
    (void)state;
    static const double rows[3][2] = {{28e-3, 14e-3}, {29.9e-3, 8e-3}, {20e-3, 15.9e-3}};
    const block small[] = {
        {.cells = {15, 8, 0}, .finer = 3, .distortion = 0.2},
        {.cells = {15, 8, 0}, .finer = 4, .distortion = 0.2},
        {.cells = {15, 8, 0}, .finer = 4, .distortion = 0.2, .couple = ", spins: slaved"}};
    for (int k = 0; k < 9; k++) {
        const double depth = 0.0;
        gn_world *w = block_of(&small[k / 3]);
        set_elements(w, stir, &depth);
        measured_step(w);
        for (int m = 0; m < 6; m++) {
            const double near[3] = {rows[k % 3][0] - 0.4e-3 * m, rows[k % 3][1] - 0.3e-3 * m, 0.0};
            const whole before = whole_of(w);
            double low[3] = {0.0}, high[3] = {0.0};
            find_empty(w, near, low, high);
            const double most = most_changed(w, low, high),
                         speed = sqrt(2.0 * before.energy / before.mass);
            if (!(most <= 0.1 * speed)) fail_msg("%d %d: %g of %g m/s", k, m, most, speed);
            assert_true(fabs(gn_energy_residual(&w->ledger.reading)) < 1e-5);
            measured_step(w);
        }
        world_end(w);
    }
}

static void convert_small(const block *s, field *motion, const double near[3]) {
    const double depth = s->space;
    gn_world *w = block_of(s);
    gneiss_error error = {0};
    set_elements(w, motion, &depth);
    measured_step(w);
    const whole before = whole_of(w);
    const double size = sqrt(2.0 * before.mass * before.energy);
    const size_t elements = gn_elements_left_count(&w->solids);
    double low[3] = {0.0}, high[3] = {0.0}, worst = 0.0;
    find_empty(w, near, low, high);
    if (convert_box(w, low, high, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const whole after = whole_of(w);
    assert_int_equal(w->outcome.halt[0], 0);
    assert_true(gn_elements_left_count(&w->solids) < elements);
    assert_true(gn_dem_present_count(&w->dem) > 0 &&
                gn_dem_present_count(&w->dem) < w->dem.particles.soa.count);
    assert_near(after.mass, before.mass, 1e-12 * before.mass);
    for (int a = 0; a < 3; a++) assert_near(after.momentum[a], before.momentum[a], 1e-12 * size);
    assert_driven_go_on(w, 3.0);
    for (int m = 0; m < 10; m++) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    if (!(worst < 1e-7)) fail_msg("%g", worst);
    world_end(w);
}

/* Elements smaller than a particle, which release none, in the middle, at an edge and at a corner;
 * beside driven nodes, whose motion does not change. */
static void small_elements_keep_mass_and_momentum(void **state) {
    (void)state;
    static const double places[3][3] = {{15e-3, 8e-3, 7e-3}, {15e-3, 0, 0}, {0, 0, 0}};
    field *motions[] = {turn_alone, stir, turn_and_stretch};
    const block small[] = {
        {.cells = {15, 8, 0}, .finer = 3},
        {.cells = {15, 8, 0}, .finer = 4, .distortion = 0.2},
        {.cells = {15, 8, 0},
         .finer = 3,
         .elements = ", motions: [{name: top, box: {min: [13 mm, 15.9 mm], max: [17 mm, 17 mm]}, "
                     "motion: {vx: 3}}]"},
        {.cells = {15, 7, 7}, .finer = 2, .space = true}};
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 3; m++)
            for (int p = 0; p < 3; p++) {
                double near[3];
                memcpy(near, places[p], sizeof near);
                if (k == 2) near[1] = 11e-3;
                if (k == 2 && (m < 2 || p == 1))
                    continue; /* the particle moves with the driven nodes */
                if (k == 3 && p < 2 && m != 1) continue; /* large */
                convert_small(&small[k], motions[m], near);
            }
}

/* --- where --- */

static bool any_element_between(const gn_world *w, double from, double to) {
    const gn_fem_solid *b = &w->solids.elements[0]->solid;
    bool found = false;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double centre = 0.0;
        for (int a = 0; a <= b->dimension; a++)
            centre += b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e]] /
                      (b->dimension + 1);
        found = found || (centre > from && centre < to);
    }
    return found;
}

/* Two zones need more than twice the width of one between them: the elements there convert too. */
static void two_converting_places_that_join_leave_no_element_between_them(void **state) {
    (void)state;
    gn_world *w = block_of(&plate);
    convert(w, 4e-3, 8e-3, 0.0, 1.0);
    assert_true(any_element_between(w, 8e-3, 30e-3));
    convert(w, 16e-3, 20e-3, 0.0, 1.0);
    assert_false(any_element_between(w, 4e-3, 20e-3));
    assert_true(any_element_between(w, 20e-3, 30e-3));
    run_steps(w, 100);
    world_end(w);
}

/* The bound that is updated from one conversion to the next equals the bound of all elements. */
static void the_bound_of_the_remaining_elements_is_that_of_all_elements(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        block s = space ? cube : plate;
        s.distortion = space ? 0.15 : 0.24;
        gn_world *w = block_of(&s);
        gn_element_model *q = w->solids.elements[0];
        const double start = q->limit.bound;
        for (int k = 0; k < 6; k++) {
            const double from = 2e-3 * k, low = space ? 0.0 : 2e-3 * (k % 3);
            convert(w, from - 1e-3, from + 3e-3, low - 1e-3, low + 5e-3);
            gn_fem_limit all = {0};
            assert_int_equal(gn_fem_bound(&q->solid, &all, NULL), GNEISS_OK);
            assert_int_equal(q->limit.bound_element, all.bound_element);
            assert_true(q->limit.bound == all.bound);
            run_steps(w, 3);
        }
        assert_true(q->limit.bound != start);
        world_end(w);
    }
}

static gneiss_status find_with_all(const gn_spectrum *spectrum, void *context,
                                   gneiss_error *error) {
    gn_springs all;
    gneiss_status status = gn_springs_build(spectrum, NULL, &all, error);
    double *mode = calloc(all.particles * (size_t)all.dofs, sizeof *mode);
    if (status == GNEISS_OK) status = gn_springs_mode(&all, 1e-3, mode, context, error);
    gn_springs_free(&all);
    free(mode);
    return status;
}

/* The limit of the particles is computed from the active ones: it equals that of the full
 * operator. */
static void the_limit_of_active_particles_is_that_of_the_full_operator(void **state) {
    (void)state;
    for (int space = 0; space < 2; space++) {
        const block s = {.cells = {space ? 20 : 40, space ? 4 : 8, 4}, .space = space};
        gn_world *w = block_of(&s);
        convert(w, -1e-3, space ? 3e-3 : 9e-3, -1e-3, space ? 3e-3 : 9e-3);
        assert_true(gn_dem_present_count(&w->dem) >= 64 &&
                    3 * gn_dem_present_count(&w->dem) <= w->dem.particles.soa.count);
        gn_step_limit all = {.bound = w->ctx.choice.limit.bound};
        assert_int_equal(gn_timestep_with_spectrum(&w->ctx, &w->dem, &w->boundary, false,
                                                   find_with_all, &all, NULL),
                         GNEISS_OK);
        assert_true(w->ctx.choice.limit.iterations > 0 &&
                    w->ctx.choice.limit.iterations == all.iterations);
        assert_true(w->ctx.choice.limit.sharp == all.sharp &&
                    w->ctx.choice.limit.sharp_low == all.sharp_low);
        assert_true(w->ctx.dt <= w->ctx.scene.safety * all.sharp);
        world_end(w);
    }
}

/* A remainder at the end of the block that is thinner than a zone converts too. */
static void a_remnant_thinner_than_a_zone_converts_too(void **state) {
    (void)state;
    gn_world *w = block_of(&plate);
    convert(w, 4e-3, 8e-3, 0.0, 1.0);
    assert_false(any_element_between(w, 0.0, 8e-3));
    assert_true(any_element_between(w, 8e-3, 30e-3));
    world_end(w);
}

/* A corner, and a place in the middle of an edge with elements on all other sides. */
static void a_corner_and_an_edge_convert(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double from = k % 2 ? 14e-3 : 0.0;
        gn_world *w = block_of(k / 2 ? &cube : &plate);
        size_t elements = gn_elements_left_count(&w->solids);
        if (k / 2)
            from > 0.0 ? convert(w, 8e-3, 12e-3, 0.0, 2e-3) : convert(w, 0.0, 2e-3, 0.0, 2e-3);
        else
            convert(w, from, from + 2e-3, 0.0, 2e-3);
        assert_true(gn_elements_left_count(&w->solids) < elements);
        assert_true(gn_elements_left_count(&w->solids) > 0);
        assert_true(gn_dem_present_count(&w->dem) > 0);
        run_steps(w, 100);
        gn_energy e = measured_step(w);
        assert_near(gn_energy_stored(&e), 0.0, 1e-15);
        world_end(w);
    }
}

static void all_of_a_body_can_convert(void **state) {
    (void)state;
    const double depth = 0.0;
    gn_world *w = block_of(&plate);
    set_elements(w, stir, &depth);
    measured_step(w);
    const whole before = whole_of(w);
    convert(w, 0.0, 30e-3, 0.0, 1.0);
    assert_int_equal(gn_elements_left_count(&w->solids), 0);
    assert_int_equal(gn_dem_present_count(&w->dem), 30 * 16);
    run_steps(w, 200);
    const whole after = whole_of(w);
    gn_energy e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
    for (int a = 0; a < 3; a++)
        assert_near(after.momentum[a], before.momentum[a], 1e-12 * before.mass * 5e-3);
    world_end(w);
}

/* --- by themselves --- */

static const char *const ends =
    ", motions: [{name: left, box: {min: [-1 mm, -1], max: [0.1 mm, 1]}, motion: {vx: 0}}, "
    "{name: right, box: {min: [29.9 mm, -1], max: [31 mm, 1]}, motion: {vx: %g}}]";

static block pulled(char *elements, size_t size, double speed) {
    block s = plate;
    snprintf(elements, size, ends, speed);
    s.elements = elements;
    return s;
}

static void part_ways(const double *x, const void *of, double u[3], double v[3]) {
    (void)u;
    v[0] = x[0] > 0.014 ? *(const double *)of : -*(const double *)of;
}

/* Two halves that move apart at v each pull with rho c v at each other. */
static void elements_convert_where_their_stress_is_beyond_the_limit(void **state) {
    (void)state;
    const double speed = 0.01, wave = sqrt(density * modulus) * speed;
    for (int reached = 0; reached < 2; reached++) {
        char limit[96];
        block s = {.cells = {30, 8, 0}, .convert = limit};
        snprintf(limit, sizeof limit, "every: 2, stress: %g", wave * (reached ? 0.8 : 3.0));
        gn_world *w = block_of(&s);
        set_elements(w, part_ways, &speed);
        while (w->ctx.time < 6e-3 / sqrt(modulus / density)) run_steps(w, 1);
        assert_int_equal(gn_elements_left_count(&w->solids) < 2 * 30 * 8, reached);
        assert_int_equal(gn_dem_present_count(&w->dem) > 0, reached);
        if (reached) assert_false(any_element_between(w, 14e-3, 16e-3));
        assert_true(any_element_between(w, 30e-3, 60e-3));
        world_end(w);
    }
}

static void limits_are_those_of_principal_stress_and_of_coulomb(void **state) {
    (void)state;
    gn_convert_def def = {.stress = 2e6};
    const double weak[6] = {1e6, 0, -1e6, 0, 0, 0}, pull[6] = {1e6, -5e6, 0, 0, 0, 0},
                 shear[6] = {0, 0, 0, 3e6, 0, 0}, press[6] = {-1e6, -9e6, -1e6, 0, 0, 0};
    assert_near(gn_front_excess(&def, weak, 1.0), 0.0, 0.0);
    assert_near(gn_front_excess(&def, pull, 1.0), 0.5, 1e-12);
    assert_near(gn_front_excess(&def, shear, 1.0), 1.5, 1e-12);
    assert_near(gn_front_excess(&def, press, 1.0), -0.5, 1e-12);
    /* tan(phi) = 3/4: sin = 0.6, cos = 0.8. Half the difference is 4 MPa, the mean -5 MPa. */
    def = (gn_convert_def){.has_mohr = true, .cohesion = 1e6, .friction = 0.75};
    assert_near(gn_front_excess(&def, press, 1.0), (4.0 - 5.0 * 0.6) / 0.8, 1e-12);
    assert_near(gn_front_excess(&def, shear, 1.0), 3.0 / 0.8, 1e-12);
}

static void friction_of_a_limit_may_be_an_angle(void **state) {
    (void)state;
    block s = plate;
    s.convert = "mohr_coulomb: {cohesion: 1 MPa, friction: 30 deg}";
    gn_world *w = block_of(&s);
    assert_near(w->ctx.scene.couple.convert.friction, tan(pi / 6.0), 1e-15);
    world_end(w);
}

static void a_bond_that_breaks_in_a_zone_converts_its_elements(void **state) {
    (void)state;
    block s = plate;
    s.convert = "every: 10, stress: 1e30";
    gn_world *w = block_of(&s);
    convert(w, 2e-3, 4e-3, 0.0, 1.0);
    size_t elements = gn_elements_left_count(&w->solids);
    for (size_t c = 0; c < w->dem.bonds.contacts.soa.count; c++) {
        const size_t i = (size_t)w->dem.bonds.contacts.i[c];
        if (!is_tied(w, i) || w->dem.particles.blend[2 * i] < 0.3) continue;
        w->dem.bonds.contacts.cause[c] = GN_BROKEN_TENSION;
        w->dem.bonds.contacts.rn[c] = -w->dem.bonds.contacts.rn[c];
        break;
    }
    run_steps(w, 11);
    assert_true(gn_elements_left_count(&w->solids) < elements);
    assert_int_equal(gn_coupled_broken(&w->dem), 0);
    world_end(w);
}

/* --- stops --- */

/* Nothing has changed, and the model continues as before. */
static void assert_halted(gn_world *w, const double low[3], const double high[3],
                          const char *words) {
    gneiss_error error = {0};
    const size_t elements = gn_elements_left_count(&w->solids);
    const uint64_t before = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    assert_int_equal(convert_box(w, low, high, &error), GNEISS_OK);
    if (!strstr(w->outcome.halt, words)) fail_msg("%s", w->outcome.halt);
    assert_int_equal(gn_elements_left_count(&w->solids), elements);
    assert_int_equal(gn_dem_present_count(&w->dem), 0);
    assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == before);
    for (size_t n = 0; n < w->solids.elements[0]->solid.nodes.soa.count; n++)
        assert_true(w->solids.elements[0]->solid.nodes.blend[2 * n] == 1.0);
    run_steps(w, 10);
}

static void where_no_packing_is_ready_conversion_stops(void **state) {
    (void)state;
    block s = plate;
    const double low[3] = {12e-3, 0.0, 0.0}, high[3] = {18e-3, 1.0, 0.0};
    s.box = "{min: [7 mm, -1], max: [23 mm, 1]}";
    gn_world *w = block_of(&s);
    assert_halted(w, low, high, "is not in couple.convert.box");
    world_end(w);
}

static void driven_elements_do_not_convert(void **state) {
    (void)state;
    char elements[512];
    block s = pulled(elements, sizeof elements, 0.0);
    const double low[3] = {2e-3, 0.0, 0.0}, high[3] = {6e-3, 1.0, 0.0};
    gn_world *w = block_of(&s);
    assert_halted(w, low, high, "has nodes of a motion or a load");
    world_end(w);
}

/* Nodes of a zone are driven fast: half a step of work by the jump of their reactions is booked
 * with the conversion. */
static void jumps_of_reactions_are_booked(void **state) {
    (void)state;
    block s = plate;
    s.elements = ", motions: [{name: top, box: {min: [13 mm, 15.9 mm], max: [17 mm, 17 mm]}, "
                 "motion: {vx: 1, vy: 3}}]";
    gn_world *w = block_of(&s);
    double worst = 0.0;
    measured_step(w);
    run_steps(w, 40);
    convert(w, 4e-3, 10e-3, 0.0, 1.0);
    for (int m = 0; m < 10; m++) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    assert_int_equal(w->outcome.halt[0], 0);
    if (!(worst < 1e-5)) fail_msg("%g", worst);
    world_end(w);
}

/* --- means --- */

/* Means of strain, stress and gauge displacement over the specimen, particles and elements
 * together. The strain is uniform. */
static void assert_means(gn_world *w, const double gradient[9]) {
    double found[9], u[3] = {0.0}, v[3];
    const double x[3] = {0.5 * 25e-3, 0.5 * 15e-3,
                         0.0}; /* centroid of the particles, which reach from 10 to 15 mm */
    gn_gauge_gradient(&w->ctx, &w->dem, &w->solids, &w->gauge, found);
    for (int k = 0; k < 9; k++) assert_near(found[k], gradient[k], 1e-14);
    gn_energy e = measured_step(w);
    (void)e;
    for (int a = 0; a < 2; a++)
        for (int c = 0; c < 2; c++)
            assert_near(w->ledger.stress[3 * a + c],
                        0.5 * modulus * (gradient[3 * a + c] + gradient[3 * c + a]),
                        0.08 * modulus *
                            3e-6); /* the outermost particles have bonds on their inner side only */
    strain(x, gradient, u, v);
    assert_near(gn_set_travel(&w->ctx, &w->dem, &w->solids, 0, 0), u[0], 1e-3 * 3e-8);
}

static void means_are_those_of_elements_and_particles_together(void **state) {
    (void)state;
    const double gradient[9] = {1e-6, 3e-6, 0, -1e-6, 2e-6, 0, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        block s = unrelaxed(&plate);
        s.rest = "sets: [{name: gauge, select: {box: {min: [10 mm, 7 mm], max: [15 mm, 8 mm]}}}]\n"
                 "run: {threads: 1}\n";
        gn_world *w = block_of(&s);
        set_elements(w, strain, gradient);
        if (k) convert(w, k == 1 ? 8e-3 : 0.0, k == 1 ? 12e-3 : 30e-3, 0.0, 1.0);
        assert_means(w, gradient);
        world_end(w);
    }
}

/* --- the same bits --- */

static gn_run *busy_run(bool space, int threads, const char *precision) {
    char rest[512];
    block s = {.cells = {space ? 24 : 30, space ? 2 : 4, space ? 2 : 0}, .space = space};
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    snprintf(rest, sizeof rest,
             "damping: {contact: {restitution: 0.8}, background: {model: nonviscous_component, "
             "coefficient: 0.1}}\ngravity: [0, -9.81%s]\nrun: {threads: %d, precision: %s}\n",
             space ? ", 0" : "", threads, precision);
    s.rest = rest;
    s.convert = "every: 40, most: 0.05, stress: 3 kPa, by: nodes";
    text *t = text_of(&s);
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    const double depth = space;
    set_elements(&run->world, stir, &depth);
    return run;
}

static void threads_and_resumption_amid_conversion_give_the_same_bits(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        const char *precision = k % 2 ? "mixed" : "double";
        gn_run *a = busy_run(k / 2, 1, precision), *b = busy_run(k / 2, 2, precision);
        const size_t elements = gn_elements_left_count(&a->world.solids);
        run_steps(&a->world, 85);
        run_steps(&b->world, 85);
        const size_t then = gn_elements_left_count(&a->world.solids);
        assert_true(then < elements);
        gn_run *const all[] = {a, b, resumed_of(a)};
        for (int r = 0; r < 3; r++) {
            gn_world *w = &all[r]->world;
            run_steps(w, 100);
            gn_energy e = measured_step(w);
            assert_true(gn_elements_left_count(&w->solids) < then);
            assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
            assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) ==
                        gn_world_hash(&a->world.ctx, &a->world.dem, &a->world.boundary,
                                      &a->world.solids, &a->world.box));
            assert_memory_equal(&w->zones.state, &a->world.zones.state, sizeof w->zones.state);
        }
        assert_true(a->world.converted.corrected.scale > 0.0);
        for (int r = 0; r < 3; r++) run_end(all[r]);
    }
}

/* --- warnings --- */

/* A translating and rotating block, one corner of which converts. */
static gn_run *turned_run(const block *s) {
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    text *t = text_of(s);
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    set_elements(&run->world, move_rigidly, turned);
    convert(&run->world, 0.0, 2e-3, 0.0, 2e-3);
    assert_string_equal(run->world.outcome.halt, "");
    return run;
}

static const char *said_of(const gn_run *run, const char *name, gn_warnings *list) {
    gneiss_error error = {0};
    assert_int_equal(gn_run_warnings(run, list, &error), GNEISS_OK);
    for (size_t k = 0; k < list->count; k++)
        if (strcmp(list->warning[k].name, name) == 0) return list->warning[k].text;
    return NULL;
}

/* A rigid rotation gains as much angular momentum as inertia: 1 % and more for a small body of
 * elements no larger than particles, far less for a larger body with larger elements. */
static void a_run_reports_the_change_of_angular_momentum_by_conversion(void **state) {
    (void)state;
    const block blocks[] = {{.cells = {15, 8, 0}},
                            {.cells = {4, 4, 0}, .finer = 2, .distortion = 0.2, .thin = 2e-3}};
    for (int k = 0; k < 2; k++) {
        gn_warnings list;
        gn_run *run = turned_run(&blocks[k]);
        const gn_corrections *c = &run->world.converted.corrected;
        const char *said = said_of(run, "conversion_missed", &list);
        double share = 0.0, inertia = 0.0;
        print_message("# %g of %g N m s, inertia %g: %s\n", c->most, c->scale, c->inertia,
                      said ? said : "");
        assert_near(c->most, fabs(c->inertia) * c->scale, 1e-3 * c->most);
        assert_true((k == 1) == (said != NULL));
        assert_true((k == 1) == (c->most > 0.01 * c->scale));
        if (said) {
            assert_int_equal(sscanf(strstr(said, "in total, "), "in total, %lf %%", &share), 1);
            assert_int_equal(sscanf(strstr(said, "inertia by "), "inertia by %lf %%", &inertia), 1);
            assert_near(share, 100.0 * c->most / c->scale, 0.05 * share);
            assert_near(fabs(inertia), share, 0.06 * share);
        }
        run_end(run);
    }
}

/* If warnings exceed the room, later ones overwrite the last. */
static void a_full_list_of_warnings_takes_no_more(void **state) {
    (void)state;
    struct {
        gn_warnings list;
        uint64_t guard;
    } *q = calloc(1, sizeof *q);
    q->guard = 0x5a5a5a5a5a5a5a5aULL;
    for (int k = 0; k < GN_WARNINGS_MAX + 2; k++)
        gn_warn(&q->list, k == GN_WARNINGS_MAX + 1 ? "last" : "one", "%700d", k);
    assert_int_equal(q->list.count, GN_WARNINGS_MAX);
    assert_string_equal(q->list.warning[GN_WARNINGS_MAX - 1].name, "last");
    assert_true(q->guard == 0x5a5a5a5a5a5a5a5aULL);
    free(q);
}

/* Largest and least time between two rows of the history; returns how many there are. */
static size_t rows_of(const gn_run *run, double gap[2]) {
    const double *t = gn_history_column(&run->history, "time");
    const size_t rows = run->history.row_count;
    gap[0] = INFINITY;
    gap[1] = 0.0;
    for (size_t k = 1; k < rows; k++) {
        gap[0] = fmin(gap[0], t[k] - t[k - 1]);
        gap[1] = fmax(gap[1], t[k] - t[k - 1]);
    }
    return rows;
}

static void finish(gn_run *run) {
    gneiss_error error = {0};
    for (int k = 0; k < 10000 && !run->finished; k++)
        if (gn_run_steps(run, 1, &error) != GNEISS_OK) fail_msg("%s", error.message);
    assert_true(run->finished);
}

/* Steps become shorter with the first particles: rows keep their requested number and their spacing
 * in time, also in a run resumed between them. */
static void rows_stay_evenly_apart_when_steps_become_shorter(void **state) {
    (void)state;
    enum { ROWS = 40 };
    char path[] = "/tmp/gneiss-rows-XXXXXX";
    gneiss_error error = {0};
    double gap[2];
    close(mkstemp(path));
    gn_run *run = busy_run(false, 1, "double"), *again = calloc(1, sizeof *again);
    const double step = run->world.ctx.dt, end = 1000.0 * step;
    run->world.ctx.scene.end = end;
    gn_run_space_rows(run, 1000 / ROWS);
    if (gn_run_steps(run, 500, &error) != GNEISS_OK) fail_msg("%s", error.message);
    if (gn_checkpoint_write(run, path, &error) != GNEISS_OK ||
        gn_checkpoint_load(path, NULL, 0, again, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    again->world.ctx.scene.end = end;
    finish(run);
    finish(again);
    assert_true(run->world.ctx.dt < 0.9 * step);
    const size_t rows = rows_of(run, gap);
    assert_true(rows + 1 >= ROWS && rows <= ROWS + 1);
    assert_close(gap[0], end / ROWS, 1.5 * run->world.ctx.dt * ROWS / end);
    assert_close(gap[1], end / ROWS, 1.5 * run->world.ctx.dt * ROWS / end);
    assert_int_equal(again->history.row_count, rows);
    assert_true(gn_world_hash(&again->world.ctx, &again->world.dem, &again->world.boundary,
                              &again->world.solids, &again->world.box) ==
                gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                              &run->world.solids, &run->world.box));
    gn_run_free(run);
    gn_run_free(again);
    free(run);
    free(again);
    unlink(path);
}

/* A row at a conversion counts the remaining elements and the active particles after it. */
static void a_row_at_a_conversion_counts_both_sides_after_it(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_run *run = busy_run(false, 1, "double");
    gn_run_space_rows(run, 1);
    if (gn_run_steps(run, 90, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const double *elements = gn_history_column(&run->history, "elements"),
                 *particles = gn_history_column(&run->history, "particles");
    size_t changed = 0;
    for (size_t k = 1; k < run->history.row_count; k++) {
        assert_int_equal(elements[k]<elements[k - 1], particles[k]> particles[k - 1]);
        changed += elements[k] < elements[k - 1];
    }
    assert_true(changed > 0);
    run_end(run);
}

/* --- refused input --- */

static void assert_refused(const block *s, const char *from, const char *to, const char *words) {
    text *t = text_of(s);
    assert_change_refused(t->s, from, to, words);
    free(t);
}

static void invalid_conversions_are_refused(void **state) {
    (void)state;
    assert_refused(&plate, "stress: 1e30", "every: 10", "expected a limit, stress or mohr_coulomb");
    assert_refused(&plate, "width: 0.006", "width: 0", "couple.convert.width");
    assert_refused(&plate, "stress: 1e30", "stress: 1e30, most: 0", "couple.convert.most");
    assert_refused(&plate, "stress: 1e30", "mohr_coulomb: {friction: 1}", "cohesion");
    assert_refused(&plate, "max: [1, 1]", "max: [-2, 1]", "box.max");
    assert_refused(&plate, "min: [-1, -1]", "min: [0.5, -1]",
                   "expected elements of which all nodes");
    assert_refused(
        &plate, "couple: {", "initial: {random_velocity: 1}\ncouple: {",
        "initial.random_velocity: expected no initial.random_velocity beside couple.convert");
    assert_refused(&plate, "couple: {", "couple: {constraint: penalty, ",
                   "couple.constraint: expected no couple.constraint but lumped");
    assert_refused(&plate, "couple: {", "couple: {penalty: 2, ",
                   "needs constraint: penalty; found lumped");
    assert_refused(&plate, "couple: {",
                   "sets: [{name: a, select: {all: true}, motion: {vx: 0}}]\ncouple: {",
                   "sets[0].motion: expected no sets with motion or force");
    assert_refused(&plate, "couple: {",
                   "sets: [{name: a, select: {all: true}, initial_velocity: [1, 0]}]\ncouple: {",
                   "sets[0].initial_velocity: expected none beside couple.convert");
    assert_refused(&plate, "couple: {", "couple: {zones: [{edges: [{from: [0, 0], to: [1, 0]}]}], ",
                   "expected no couple.zones");
    assert_refused(&plate, "time: {",
                   "walls: [{name: a, point: [0, 0], normal: [1, 0], stiffness: 1, servo: {force: "
                   "1, max_velocity: 1}}]\ntime: {",
                   "walls: expected no servo of walls");
    assert_refused(&plate, "time: {",
                   "walls: [{name: a, point: [0, 0], normal: [1, 0], stiffness: 1}, {name: b, "
                   "point: [0.03, 0], normal: [-1, 0], stiffness: 1}]\n"
                   "test: {kind: compression, axis: x, lower: a, upper: b}\ntime: {",
                   "test.lower: expected motions of elements");
    assert_refused(&plate, "lattice: {", "lattice: {origin: [1 mm, 0], ",
                   "expected every particle in an element, found particle");
    assert_refused(&plate, "density: 9931", "density: 4931", "weigh what the elements");
    assert_refused(&plate, "width: 0.006", "width: 0.03",
                   "couple.convert.width: expected a zone that is narrower than the body of 0.03");
}

/* Such packings would push particles apart on activation, without any strain of the elements. */
static void conversion_packings_under_stress_are_refused(void **state) {
    (void)state;
    static const char range[] = "interaction_range: 0.01";
    static const char *const changed[] = {"overlap_range: 0.005   ", "passive_gaps: false    "};
    static const char *const words[] = {"expected a bond between all particles that overlap",
                                        "expected bonds that are free of stress as they are"};
    text *t = text_of(&plate);
    char *bonds = strstr(t->s, range);
    for (int k = 0; k < 2; k++) {
        memcpy(bonds, changed[k], sizeof range - 1);
        assert_change_refused(t->s, "kind: square,", "kind: square, spacing: 0.99,", words[k]);
    }
    free(t);
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_that_moves_and_turns_becomes_particles_that_do),
        cmocka_unit_test(a_block_at_rest_becomes_particles_at_rest),
        cmocka_unit_test(dormant_particles_have_no_contacts_and_do_not_move),
        cmocka_unit_test(a_strained_block_becomes_particles_under_its_stress),
        cmocka_unit_test(a_zone_that_is_passed_carries_all_of_the_stress),
        cmocka_unit_test(converting_keeps_momentum_and_books_energy),
        cmocka_unit_test(conversion_creates_no_spurious_velocities),
        cmocka_unit_test(two_converting_places_that_join_leave_no_element_between_them),
        cmocka_unit_test(the_bound_of_the_remaining_elements_is_that_of_all_elements),
        cmocka_unit_test(the_limit_of_active_particles_is_that_of_the_full_operator),
        cmocka_unit_test(a_remnant_thinner_than_a_zone_converts_too),
        cmocka_unit_test(a_corner_and_an_edge_convert),
        cmocka_unit_test(all_of_a_body_can_convert),
        cmocka_unit_test(elements_convert_where_their_stress_is_beyond_the_limit),
        cmocka_unit_test(limits_are_those_of_principal_stress_and_of_coulomb),
        cmocka_unit_test(friction_of_a_limit_may_be_an_angle),
        cmocka_unit_test(a_bond_that_breaks_in_a_zone_converts_its_elements),
        cmocka_unit_test(where_no_packing_is_ready_conversion_stops),
        cmocka_unit_test(driven_elements_do_not_convert),
        cmocka_unit_test(jumps_of_reactions_are_booked),
        cmocka_unit_test(means_are_those_of_elements_and_particles_together),
        cmocka_unit_test(a_run_reports_the_change_of_angular_momentum_by_conversion),
        cmocka_unit_test(a_full_list_of_warnings_takes_no_more),
        cmocka_unit_test(threads_and_resumption_amid_conversion_give_the_same_bits),
        cmocka_unit_test(rows_stay_evenly_apart_when_steps_become_shorter),
        cmocka_unit_test(a_row_at_a_conversion_counts_both_sides_after_it),
        cmocka_unit_test(invalid_conversions_are_refused),
        cmocka_unit_test(conversion_packings_under_stress_are_refused),
    };
    const struct CMUnitTest long_tests[] = {
        cmocka_unit_test(small_elements_keep_mass_and_momentum),
    };
    return run_part(argc, tests, long_tests);
}
