/* The forces of a membrane: Nanson's formula under any affine motion, balance, and particles that
 * detach. */
#include "world_helpers.h"

#include "membrane/membrane.h"
#include "world/space.h"

static const char scene[] =
    "dimension: %d\nspecimen: {%s, particles: 80, packing: {size_ratio: 2}}\n"
    "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
    "sets: [{name: s, select: {ids: [5]}, force: [3, 0%s]}]\n"
    "membrane: {pressure: 7 MPa, follow: %s}\ntime: {end: 1}\nrun: {threads: 1}\n";

static gn_world *specimen(int dimension, bool follow) {
    return world_of(scene, dimension,
                    dimension == 2 ? "rectangle: {width: 0.03, height: 0.02}"
                                   : "box: {size: [0.02, 0.03, 0.02]}",
                    dimension == 2 ? "" : ", 0", follow ? "true" : "false");
}

static void move(gn_world *w, const double f[9]) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            q->pos[4 * p + a] = 0.004 + gn_dot3(f + 3 * a, q->start + 4 * p);
}

static void press(gn_world *w) {
    gneiss_error error = {0};
    if (gn_membrane_apply(&w->ctx, &w->dem, &w->membrane, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
}

/* Areas of the start, to be freed. */
static double *areas(const gn_world *w) {
    const size_t bytes = 4 * w->dem.particles.soa.count * sizeof(double);
    double *kept = malloc(bytes);
    assert_non_null(kept);
    memcpy(kept, w->dem.particles.skin, bytes);
    return kept;
}

/* Applied forces are those of the sets minus the pressure times J F^-T A, with A the initial areas;
 * frees these. */
static void expect_forces(const gn_world *w, const double f[9], double *start, double pressure,
                          double allowed) {
    const gn_particles *q = &w->dem.particles;
    double turn[9], size = 0;
    gn_cofactor3(f, turn);
    for (size_t p = 0; p < q->soa.count; p++) size = fmax(size, pressure * start[4 * p + 3]);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) {
            double load = a == 0 && q->id[p] == 5 ? 3 : 0;
            double want = load - pressure * gn_dot3(turn + 3 * a, start + 4 * p);
            assert_near(q->applied[4 * p + a], want, allowed * size);
        }
    free(start);
}

/* The force of the membrane on a particle. */
static void force_on(const gn_world *w, size_t p, double force[3]) {
    const gn_particles *q = &w->dem.particles;
    for (int a = 0; a < 3; a++) force[a] = q->applied[4 * p + a] - q->load[4 * p + a];
}

/* Forces and moments of the membrane sum to zero, to rounding relative to the largest possible
 * values. */
static void expect_balance(const gn_world *w, double pressure) {
    const gn_particles *q = &w->dem.particles;
    double sum[3] = {0}, moment[3] = {0}, force[3], turn[3], reach = 0;
    const double most = pressure * gn_membrane_area(&w->dem);
    for (size_t p = 0; p < q->soa.count; p++) {
        force_on(w, p, force);
        gn_cross3(q->pos + 4 * p, force, turn);
        for (int a = 0; a < 3; a++) {
            sum[a] += force[a];
            moment[a] += turn[a];
            reach = fmax(reach, fabs(q->pos[4 * p + a]));
        }
    }
    assert_true(most > 0);
    for (int a = 0; a < 3; a++) {
        assert_near(sum[a], 0, 1e-12 * most);
        assert_near(moment[a], 0, 1e-11 * most * reach);
    }
}

static const double rotation[2][9] = {{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1},
                                      {0.6, 0, 0.8, 0.64, 0.6, -0.48, -0.48, 0.8, 0.36}};
static const double turned[2][9] = {{0.2, -1.1, 0, 0.9, 0.3, 0, 0, 0, 1},
                                    {1.1, 0.2, 0, -0.3, 0.9, 0.1, 0, 0.05, 1.2}};

static void flatten(gn_world *w) {
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) w->dem.particles.pos[4 * p + 2] = 0;
}

/* For any packing, areas are changed by the smallest amount that removes the moment at the present
 * positions: exactly under a rigid rotation. The test compares at the start, between updates, and
 * at an update. */
static void areas_follow_an_affine_motion_as_nanson_says(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++)
        for (int step = 0; step < 102; step += 50)
            for (int stretched = 0; stretched < 2; stretched++) {
                gn_world *w = specimen(d, true);
                double *start = areas(w);
                w->ctx.step = step;
                move(w, stretched ? turned[d - 2] : rotation[d - 2]);
                if (d == 2) flatten(w);
                press(w);
                expect_forces(w, stretched ? turned[d - 2] : rotation[d - 2], start, 7e6,
                              stretched ? 0.02 : 1e-9);
                if (step != 50) expect_balance(w, 7e6);
                world_end(w);
            }
}

static void dead_loads_stay_what_they_are(void **state) {
    (void)state;
    const double none[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    gn_world *w = specimen(3, false);
    double *start = areas(w);
    w->ctx.step = 100;
    move(w, turned[1]);
    press(w);
    expect_forces(w, none, start, 7e6, 1e-9);
    world_end(w);
}

/* Over a closed surface the sums of areas and of their moments are zero. */
static void forces_and_moments_are_in_balance(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = specimen(d, true);
        const gn_particles *q = &w->dem.particles;
        double sum[3] = {0}, moment[3] = {0}, size = 0, turn[3];
        for (size_t p = 0; p < q->soa.count; p++) {
            size += q->skin[4 * p + 3];
            gn_cross3(q->pos + 4 * p, q->skin + 4 * p, turn);
            for (int a = 0; a < 3; a++) sum[a] += q->skin[4 * p + a], moment[a] += turn[a];
        }
        for (int a = 0; a < 3; a++) {
            assert_near(sum[a], 0, 1e-12 * size);
            assert_near(moment[a], 0, 1e-12 * size * 0.03);
        }
        world_end(w);
    }
}

/* A cube of spheres, without a given shape; HALF is the distance from its centre to that of the
 * outermost spheres. */
#define SIDE 12
static const double pitch = 2e-3, half = 0.5 * SIDE * 2e-3;

static gn_world *lattice_of(int dimension, int side) {
    return world_of(
        "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1 mm, cells: [%d, %d, %d]}}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: "
        "0.5, tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\n"
        "bonds: {interaction_range: 0.1}\nmembrane: {pressure: 7 MPa}\n"
        "time: {end: 1}\nrun: {threads: 1}\n",
        dimension, dimension == 3 ? "cubic" : "square", side, side, dimension == 3 ? side : 1);
}

static gn_world *block(void) {
    return lattice_of(3, SIDE);
}

/* The body is wider by `most` in the middle than at the ends. */
static double width(double most, double z) {
    return 1.05 + most * cos(0.5 * pi * z / half);
}

static void bulge(gn_world *w, double shorter, double most, const double centre[3]) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->start + 4 * p;
        double f = width(most, x[2] - centre[2]);
        q->pos[4 * p] = centre[0] + f * (x[0] - centre[0]);
        q->pos[4 * p + 1] = centre[1] + f * (x[1] - centre[1]);
        q->pos[4 * p + 2] = centre[2] + shorter * (x[2] - centre[2]);
    }
}

/* N along x on the half at larger x, of the middle half of its height. */
static double force_across(const gn_world *w, const double centre[3]) {
    const gn_particles *q = &w->dem.particles;
    double sum = 0, force[3];
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->start + 4 * p;
        if (x[0] < centre[0] || fabs(x[2] - centre[2]) > 0.5 * half) continue;
        force_on(w, p, force);
        sum += force[0];
    }
    return sum;
}

/* Pa: the virial of forces at the centres with the distances to the surface, over the enclosed
 * volume. */
static void mean_stress(const gn_world *w, double stress[9]) {
    const gn_particles *q = &w->dem.particles;
    const double volume = gn_space_volume(&w->ctx, &w->dem, &w->membrane, &w->boundary, &w->solids,
                                          &w->box, &w->approach);
    double force[3];
    for (int k = 0; k < 9; k++) stress[k] = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        force_on(w, p, force);
        for (int k = 0; k < 9; k++) stress[k] += force[k / 3] * q->pos[4 * p + k % 3] / volume;
    }
    gn_membrane_stress(&w->ctx, &w->membrane,
                       gn_space_volume(&w->ctx, &w->dem, &w->membrane, &w->boundary, &w->solids,
                                       &w->box, &w->approach),
                       stress);
}

/* In a lattice of n^3 spheres each chain along an axis carries the pressure on a face of a cell, so
 * that the stress is the pressure in every cell: the surface is that of n^3 cells. (Areas from the
 * directions in which a ball touches a particle, scaled to the hull, were 0.87 of a face for 12^3
 * and 0.76 for 5^3, and the excess at edges reached the middle only partly.) */
static void a_lattice_is_pressed_on_the_faces_of_its_cells(void **state) {
    (void)state;
    for (int side = 5; side <= 9; side += 4)
        for (int dimension = 2; dimension <= 3; dimension++) {
            gn_world *w = lattice_of(dimension, side);
            const gn_particles *q = &w->dem.particles;
            const double face = pow(pitch, dimension - 1), last = 0.5 * (side - 1) * pitch;
            double centre[3] = {0};
            for (size_t p = 0; p < q->soa.count; p++)
                for (int a = 0; a < 3; a++) centre[a] += q->start[4 * p + a] / (double)q->soa.count;
            for (size_t p = 0; p < q->soa.count; p++)
                for (int a = 0; a < dimension; a++) {
                    const double at = q->start[4 * p + a] - centre[a];
                    const double want = fabs(at) > 0.9 * last ? copysign(face, at) : 0;
                    assert_near(q->skin[4 * p + a], want, 0.005 * face);
                }
            assert_close(w->membrane.state->enclosed, pow(side * pitch, dimension), 0.005);
            world_end(w);
        }
}

/* For any stretch the mean stress over the enclosed volume is the pressure. */
static void a_stretched_block_has_the_pressure(void **state) {
    (void)state;
    gn_world *w = block();
    double stress[9];
    for (int step = 0; step < 102; step += 50) {
        w->ctx.step = step;
        move(w, turned[1]);
        press(w);
        mean_stress(w, stress);
        for (int k = 0; k < 9; k++) assert_near(stress[k], k % 4 == 0 ? -7e6 : 0, 1e-3 * 7e6);
    }
    world_end(w);
}

/* The force that presses the two halves of a body together is the pressure times the section
 * between them, for a block that is a third shorter and bulges to one and a half of its width. */
static void the_pressure_is_held_where_a_block_bulges(void **state) {
    (void)state;
    gn_world *w = block();
    const gn_particles *q = &w->dem.particles;
    double centre[3] = {0}, wide = 0;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) centre[a] += q->start[4 * p + a] / (double)q->soa.count;
    press(w);
    const double before = force_across(w, centre);
    for (int row = 0; row < SIDE / 2; row++)
        wide += width(0.45, ((double)row - 0.25 * SIDE + 0.5) * pitch) / (0.5 * SIDE);
    bulge(w, 0.67, 0.45, centre);
    for (int look = 1; look <= 40;
         look++) { /* each update changes areas by a fraction of the difference */
        w->ctx.step = 100 * look;
        press(w);
    }
    assert_near(force_across(w, centre) / before, 0.67 * wide, 0.03 * 0.67 * wide);
    expect_balance(w, 7e6);
    world_end(w);
}

/* --- detached parts --- */

static void cut_out(gn_world *w, bool (*part)(const gn_particles *q, size_t p)) {
    const gn_particles *q = &w->dem.particles;
    gn_contacts *bonds = &w->dem.bonds.contacts;
    for (size_t c = 0; c < bonds->soa.count; c++)
        if (part(q, (size_t)bonds->i[c]) != part(q, (size_t)bonds->j[c]))
            bonds->cause[c] = GN_BROKEN_TENSION, w->dem.broken_tension++;
}

/* A corner of the upper side, two particles deep. */
static bool of_a_chip(const gn_particles *q, size_t p) {
    const double *x = q->start + 4 * p;
    return x[0] < 3.5 * pitch && x[1] < 3.5 * pitch && x[2] > (SIDE - 2) * pitch;
}

static void lift(gn_world *w, double way) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        if (of_a_chip(q, p)) q->pos[4 * p + 2] = q->start[4 * p + 2] + way;
}

static double chips_share(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double sum = 0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (of_a_chip(q, p)) sum += fmax(q->skin[4 * p + 3], 0);
    return sum;
}

/* The pressure on a detached chip acts on the particles below it, and the body keeps the required
 * mean stress; the chip is no longer loaded, also when it returns. */
static void pressure_of_a_detached_chip_acts_on_particles_below_it(void **state) {
    (void)state;
    gn_world *w = block();
    const gn_particles *q = &w->dem.particles;
    double stress[9], force[3];
    const double whole = gn_membrane_area(&w->dem), share = chips_share(w);
    assert_true(share > 0.02 * whole);
    cut_out(w, of_a_chip);
    lift(w, -1e-6);
    w->ctx.step = 100;
    press(w); /* the chip is cut off, but still lies on the body */
    assert_close(chips_share(w), share, 1e-3);
    lift(w, 0.5e-3);
    w->ctx.step = 150;
    press(w); /* no update is due at this step */
    assert_close(chips_share(w), share, 1e-3);
    w->ctx.step = 200;
    press(w);
    assert_true(chips_share(w) == 0);
    assert_close(gn_membrane_area(&w->dem), whole, 0.02);
    expect_balance(w, 7e6);
    double below = 0, upper = 0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->start + 4 * p;
        force_on(w, p, force);
        if (of_a_chip(q, p)) assert_true(force[0] == 0 && force[1] == 0 && force[2] == 0);
        if (x[2] > 0.5 * SIDE * pitch) upper += force[2];
        if (x[0] < 3.5 * pitch && x[1] < 3.5 * pitch && x[2] > (SIDE - 3) * pitch)
            below += force[2];
    }
    assert_near(upper, -7e6 * pow(SIDE * pitch, 2), 0.1 * fabs(upper));
    assert_near(below, -7e6 * pow(3 * pitch, 2), 0.1 * fabs(below) + 7e6 * pow(pitch, 2));
    mean_stress(w, stress);
    /* volume of the rest over that at the start, after 3 x 3 x 2 spheres were removed */
    const double left = 1 - 18 / pow(SIDE, 3);
    for (int k = 0; k < 9; k++) assert_near(stress[k], k % 4 == 0 ? -7e6 * left : 0, 0.01 * 7e6);
    lift(w, 0);
    w->ctx.step = 300;
    press(w);
    assert_true(chips_share(w) == 0);
    world_end(w);
}

/* Both halves on the sides of a crack are loaded. */
static bool of_the_upper_half(const gn_particles *q, size_t p) {
    return q->start[4 * p + 2] > 0.5 * SIDE * pitch;
}

static void halves_keep_the_membrane(void **state) {
    (void)state;
    gn_world *w = block();
    gn_particles *q = &w->dem.particles;
    const double whole = gn_membrane_area(&w->dem);
    cut_out(w, of_the_upper_half);
    for (size_t p = 0; p < q->soa.count; p++)
        if (of_the_upper_half(q, p)) q->pos[4 * p + 2] += 1e-3;
    w->ctx.step = 100;
    press(w);
    for (size_t p = 0; p < q->soa.count; p++) assert_true(q->skin[4 * p + 3] >= 0);
    assert_close(gn_membrane_area(&w->dem), whole, 0.05);
    expect_balance(w, 7e6);
    world_end(w);
}

/* Dead loads do not change; those of detached particles remain at their position. */
static void dead_loads_are_transferred(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = specimen(d, false);
        gn_particles *q = &w->dem.particles;
        gn_contacts *bonds = &w->dem.bonds.contacts;
        const double whole = gn_membrane_area(&w->dem);
        size_t p = 0;
        while (!(q->skin[4 * p + 3] > 0 && q->bonds0[p] > 0)) p++;
        for (size_t c = 0; c < bonds->soa.count; c++)
            if (bonds->i[c] == (int32_t)p || bonds->j[c] == (int32_t)p)
                bonds->cause[c] = GN_BROKEN_TENSION, w->dem.broken_tension++;
        for (int a = 0; a < d; a++) q->pos[4 * p + a] += 0.1;
        w->ctx.step = 100;
        press(w);
        assert_true(q->skin[4 * p + 3] < 0 && q->applied[4 * p + 1] == 0);
        assert_close(gn_membrane_area(&w->dem), whole,
                     0.1); /* the area is that of the exposed surface */
        /* the forces would be in balance if all particles were at their initial positions */
        for (int a = 0; a < d; a++) q->pos[4 * p + a] = q->start[4 * p + a];
        expect_balance(w, 7e6);
        world_end(w);
    }
}

/* --- layers --- */

typedef bool (*layer)(const gn_particles *q, size_t p, const double centre[3]);

/* Detaches all particles of a layer; each then lies alone, far from all others. */
static void take_off(gn_world *w, layer of, const double centre[3]) {
    gn_particles *q = &w->dem.particles;
    gn_contacts *bonds = &w->dem.bonds.contacts;
    for (size_t c = 0; c < bonds->soa.count; c++)
        if (of(q, (size_t)bonds->i[c], centre) || of(q, (size_t)bonds->j[c], centre))
            bonds->cause[c] = GN_BROKEN_TENSION, w->dem.broken_tension++;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++)
            if (of(q, p, centre)) q->pos[4 * p + a] += 3.0 * (q->start[4 * p + a] - centre[a]);
}

static bool of_the_faces(const gn_particles *q, size_t p, const double centre[3]) {
    double far = 0;
    for (int a = 0; a < 3; a++) far = fmax(far, fabs(q->start[4 * p + a] - centre[a]));
    return far > half - pitch;
}

static void middle_of(const gn_world *w, double centre[3]) {
    const gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) centre[a] += q->start[4 * p + a] / (double)q->soa.count;
}

/* Computes the stress of the membrane with all particles at their initial positions, over a volume,
 * m3. */
static void stress_at_start(gn_world *w, double volume, double stress[9]) {
    gn_particles *q = &w->dem.particles;
    for (size_t p = 0; p < q->soa.count; p++)
        memcpy(q->pos + 4 * p, q->start + 4 * p, 3 * sizeof *q->pos);
    mean_stress(w, stress);
    for (int k = 0; k < 9; k++) stress[k] *= gn_membrane_volume(&w->ctx, &w->membrane) / volume;
}

/* A block without a shape has cubic cells: the remaining one has ten per side, twelve edges with
 * the areas of two sides and eight corners with those of three. */
static void a_block_that_lost_its_faces_has_the_pressure_on_the_smaller_one(void **state) {
    (void)state;
    gn_world *w = block();
    const gn_particles *q = &w->dem.particles;
    const double left = SIDE - 2, face = pitch * pitch;
    double centre[3] = {0}, stress[9];
    middle_of(w, centre);
    take_off(w, of_the_faces, centre);
    w->ctx.step = 100;
    press(w);
    stress_at_start(w, pow(left * pitch, 3), stress);
    for (int k = 0; k < 9; k++) assert_near(stress[k], k % 4 == 0 ? -7e6 : 0, 0.005 * 7e6);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < 3; a++) {
            const double at = (q->start[4 * p + a] - centre[a]) / pitch;
            double want = fabs(at) > 0.5 * left - 1 ? copysign(face, at) : 0;
            if (of_the_faces(q, p, centre)) want = 0;
            assert_near(q->skin[4 * p + a], want, 0.005 * face);
        }
    const double inside = 6 * pow(left - 2, 2), edges = 12 * (left - 2) * sqrt(2);
    assert_close(gn_membrane_area(&w->dem), (inside + edges + 8 * sqrt(3)) * face, 0.005);
    expect_balance(w, 7e6);
    world_end(w);
}

/* Bodies of size 1 mm about the origin of their axis, and the depth of a position in them. */
typedef struct packed_body {
    int dimension;
    const char *shape;
    double centre[3];
    double (*depth)(const double x[3]);
} packed_body;

static double in_a_disc(const double x[3]) {
    return 1e-2 - hypot(x[0], x[1]);
}
static double in_a_cylinder(const double x[3]) {
    return fmin(1e-2 - hypot(x[0], x[1]), 1.2e-2 - fabs(x[2] - 1.2e-2));
}
static double in_a_box(const double x[3]) {
    return fmin(fmin(x[0], 2e-2 - x[0]), fmin(fmin(x[1], 2e-2 - x[1]), fmin(x[2], 2e-2 - x[2])));
}
static const packed_body bodies[] = {
    {2, "disc: {diameter: 0.02}", {0}, in_a_disc},
    {3, "cylinder: {diameter: 0.02, height: 0.024}", {0, 0, 1.2e-2}, in_a_cylinder},
    {3, "box: {size: [0.02, 0.02, 0.02]}", {1e-2, 1e-2, 1e-2}, in_a_box},
};
static double (*depth_now)(const double x[3]);

static bool of_the_shell(const gn_particles *q, size_t p, const double centre[3]) {
    (void)centre;
    return depth_now(q->start + 4 * p) < 1e-2 / 8;
}

/* Returns the volume, m3, of the points in a body that are nearest to the surface of a remaining
 * particle. */
static double volume_left(const gn_world *w, const packed_body *b) {
    const gn_particles *q = &w->dem.particles;
    const int n = b->dimension == 3 ? 40 : 200, high = b->dimension == 3 ? n : 1;
    const double width = 2.4e-2 / n;
    size_t found = 0;
    for (int v = 0; v < n * n * high; v++) {
        const double x[3] = {b->centre[0] + (v % n + 0.5) * width - 1.2e-2,
                             b->centre[1] + (v / n % n + 0.5) * width - 1.2e-2,
                             high > 1 ? b->centre[2] + (v / n / n + 0.5) * width - 1.2e-2 : 0};
        double least = INFINITY;
        size_t nearest = 0;
        for (size_t p = 0; p < q->soa.count && b->depth(x) > 0; p++) {
            const double *y = q->start + 4 * p;
            const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
            if (length3(d) - q->pos[4 * p + 3] >= least) continue;
            least = length3(d) - q->pos[4 * p + 3];
            nearest = p;
        }
        found += least < INFINITY && !of_the_shell(q, nearest, b->centre);
    }
    return (double)found * pow(width, b->dimension);
}

/* The mean stress of the remaining body is the pressure, for any packing: its surface is closed,
 * and areas times positions add up to the volume. */
static void a_body_without_its_shell_has_the_mean_stress(void **state) {
    (void)state;
    for (int follows = 0; follows < 2; follows++)
        for (size_t k = 0; k < sizeof bodies / sizeof *bodies; k++) {
            const packed_body *b = &bodies[k];
            double stress[9];
            gn_world *w = world_of(
                "dimension: %d\nspecimen: {%s, particles: %d, packing: {size_ratio: 2}}\n"
                "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: "
                "0.5, tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\n"
                "bonds: {}\nmembrane: {pressure: 7 MPa, follow: %s}\ntime: {end: 1}\n"
                "run: {threads: 1}\n",
                b->dimension, b->shape, b->dimension == 2 ? 400 : 1000, follows ? "true" : "false");
            depth_now = b->depth;
            const double volume = volume_left(w, b);
            assert_true(volume < 0.9 * w->ctx.volume);
            take_off(w, of_the_shell, b->centre);
            w->ctx.step = 100;
            press(w);
            stress_at_start(w, volume, stress);
            for (int c = 0; c < (b->dimension == 3 ? 9 : 5); c++)
                if (b->dimension == 3 || c % 3 < 2)
                    assert_near(stress[c], c % 4 == 0 ? -7e6 : 0, 0.02 * 7e6);
            expect_balance(w, 7e6);
            world_end(w);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_follow_an_affine_motion_as_nanson_says),
        cmocka_unit_test(dead_loads_stay_what_they_are),
        cmocka_unit_test(forces_and_moments_are_in_balance),
        cmocka_unit_test(a_lattice_is_pressed_on_the_faces_of_its_cells),
        cmocka_unit_test(a_stretched_block_has_the_pressure),
        cmocka_unit_test(the_pressure_is_held_where_a_block_bulges),
        cmocka_unit_test(pressure_of_a_detached_chip_acts_on_particles_below_it),
        cmocka_unit_test(halves_keep_the_membrane),
        cmocka_unit_test(a_block_that_lost_its_faces_has_the_pressure_on_the_smaller_one),
        cmocka_unit_test(a_body_without_its_shell_has_the_mean_stress),
        cmocka_unit_test(dead_loads_are_transferred),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
