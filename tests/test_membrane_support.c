/* Particles that support a membrane, and patches that are updated when single grains have moved. */
#include "world/space.h"
#include "world_helpers.h"

#include "membrane/membrane.h"

static const double pitch = 2e-3;

#define BONDS "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.01}\n"
#define MATERIAL                                                                                   \
    "materials: [{name: m, density: 2650, contact_modulus: 1e10, kratio: 2, friction: 0.5, "       \
    "tensile_strength: 3e11, shear_strength: 3e11}]\nmembrane: {pressure: 7 MPa}\n"                \
    "time: {end: 1}\nrun: {threads: 1}\n"
#define MATTER BONDS MATERIAL

static void press_at(gn_world *w, int64_t step) {
    gneiss_error error = {0};
    w->ctx.step = step;
    if (gn_membrane_apply(&w->ctx, &w->dem, &w->membrane, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
}

static bool *held_of(const gn_world *w) {
    gneiss_error error = {0};
    bool *held = calloc(w->dem.particles.soa.count + 1, sizeof *held);
    assert_non_null(held);
    if (gn_membrane_find_supported(&w->ctx, &w->dem, held, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    return held;
}

/* A corner on two contacts (2D) or three (3D) is held. */
static void corners_of_lattices_are_held(void **state) {
    (void)state;
    static const char *const lattices[] = {"square", "hexagonal", "cubic", "fcc"};
    for (int k = 0; k < 4; k++) {
        gn_world *w = world_of("dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1 mm, cells: "
                               "[5, 4, %d]}}\n" MATTER,
                               k < 2 ? 2 : 3, lattices[k], k < 2 ? 1 : 4);
        bool *held = held_of(w);
        for (size_t p = 0; p < w->dem.particles.soa.count; p++) assert_true(held[p]);
        free(held);
        world_end(w);
    }
}

/* Positions in pitches. */
static void add_grain(text *t, double x, double y, double z) {
    add(t, "%s[%.17g, %.17g, %.17g, 1e-3]", t->used ? ", " : "", pitch * x, pitch * y, pitch * z);
}

/* A cube of 4 x 4 x 4 with grains on its upper side, from id 64 on: one on a grain of the cube, one
 * on top of that, one on two grains, one in the hollow between four. */
static gn_world *with_grains_on_top(const char *bonds) {
    text t = {0};
    for (int p = 0; p < 64; p++) add_grain(&t, p % 4, p / 4 % 4, p / 16 % 4);
    add_grain(&t, 0, 0, 4);
    add_grain(&t, 0, 0, 5);
    add_grain(&t, 2.5, 0, 3 + sqrt(0.75));
    add_grain(&t, 1.5, 2.5, 3 + sqrt(0.5));
    return world_of("dimension: 3\nspecimen: {particles: [%s]}\n%s" MATERIAL, t.s, bonds);
}

/* The pressure on pivoting particles is transferred to supported particles, in balance, and the
 * mean stress is the pressure, apart from the change of areas that removes the moment of the
 * transfer: less than that of one face displaced by one pitch, of 64 cells. */
static void pivoting_particles_carry_no_pressure(void **state) {
    (void)state;
    gn_world *w = with_grains_on_top(BONDS);
    const gn_particles *q = &w->dem.particles;
    bool *held = held_of(w);
    double sum[3] = {0}, stress[9] = {0};
    for (size_t p = 0; p < q->soa.count; p++) {
        const bool pivots = q->id[p] >= 64 && q->id[p] < 67;
        assert_true(held[p] == !pivots);
        if (pivots) assert_true(q->skin[4 * p + 3] == 0);
        if (q->id[p] == 67) assert_true(q->skin[4 * p + 3] > 0);
    }
    press_at(w, 1);
    for (size_t p = 0; p < q->soa.count; p++)
        for (int k = 0; k < 9; k++) {
            stress[k] += q->applied[4 * p + k / 3] * q->pos[4 * p + k % 3] /
                         gn_membrane_volume(&w->ctx, &w->membrane);
            if (k < 3) sum[k] += q->applied[4 * p + k];
        }
    gn_membrane_stress(&w->ctx, &w->membrane,
                       gn_space_volume(&w->ctx, &w->dem, &w->membrane, &w->boundary, &w->solids,
                                       &w->box, &w->approach),
                       stress);
    for (int k = 0; k < 3; k++) assert_near(sum[k], 0, 1e-9);
    for (int k = 0; k < 9; k++) assert_near(stress[k], k % 4 == 0 ? -7e6 : 0, 7e6 / 64);
    free(held);
    world_end(w);
}

/* Bonds with moments, and grains without rotation, need only one contact for support. */
static void particles_that_cannot_pivot_support_the_membrane(void **state) {
    (void)state;
    static const char *const bonds[] = {
        "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.01, radius_multiplier: 1}\n",
        "law: {stiffness: harmonic, rotation: off}\nbonds: {interaction_range: 0.01}\n"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = with_grains_on_top(bonds[k]);
        bool *held = held_of(w);
        for (size_t p = 0; p < w->dem.particles.soa.count; p++) assert_true(held[p]);
        free(held);
        world_end(w);
    }
}

/* --- following --- */

/* Tips whose grains roll away by four radii and more would have patches 250 radii wide. */
static void grains_that_roll_stretch_no_patch(void **state) {
    (void)state;
    gn_world *w = world_of("dimension: 2\nspecimen: {polygon: [[0, 0], [0.04, 0], [0.005, 0.02]], "
                           "particles: 500}\n" MATTER);
    gn_particles *q = &w->dem.particles;
    bool *held = held_of(w);
    const double whole = gn_membrane_area(&w->dem);
    double *start = calloc(q->soa.count, sizeof *start);
    size_t loose = 0;
    assert_non_null(start);
    for (size_t p = 0; p < q->soa.count; p++) {
        start[p] = q->skin[4 * p + 3];
        if (held[p]) continue;
        loose++;
        q->pos[4 * p + 1] -= 4.4 * q->pos[4 * p + 3];
    }
    assert_true(loose > 0);
    for (int look = 1; look <= 40; look++) press_at(w, 100 * look);
    assert_close(gn_membrane_area(&w->dem), whole, 1e-9);
    for (size_t p = 0; p < q->soa.count; p++)
        assert_near(q->skin[4 * p + 3], start[p], 1e-9 * whole);
    assert_true(w->membrane.state->unlike == 0);
    free(start);
    free(held);
    world_end(w);
}

/* If the surroundings of a patch, a corner of a block, have been stretched to five times their
 * length, the patch follows the skin as a whole, and the share of such patches is recorded. */
static void the_stretch_of_a_patch_is_limited(void **state) {
    (void)state;
    gn_world *w = world_of("dimension: 2\nspecimen: {lattice: {kind: square, radius: 1 mm, cells: "
                           "[24, 24]}}\n" MATTER);
    gn_particles *q = &w->dem.particles;
    double most = 0;
    for (size_t p = 0; p < q->soa.count; p++)
        if (q->start[4 * p] < 5.5 * pitch && q->start[4 * p + 1] < 5.5 * pitch)
            q->pos[4 * p] = q->start[4 * p] + 4 * (q->start[4 * p] - 5.5 * pitch);
    for (int look = 1; look <= 40; look++) press_at(w, 100 * look);
    for (size_t p = 0; p < q->soa.count; p++) most = fmax(most, q->skin[4 * p + 3]);
    assert_true(w->membrane.state->unlike > 0 && w->membrane.state->unlike < 0.2);
    assert_true(most < 3 * 1.1 * sqrt(2) * pitch);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_of_lattices_are_held),
        cmocka_unit_test(pivoting_particles_carry_no_pressure),
        cmocka_unit_test(particles_that_cannot_pivot_support_the_membrane),
        cmocka_unit_test(grains_that_roll_stretch_no_patch),
        cmocka_unit_test(the_stretch_of_a_patch_is_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
