/* The limit of the step of particles and elements as one system. */
#include "coupling_helpers.h"
#include "timestep/timestep.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

/* A small disordered packing (x from 4 to 14 mm) beside elements (0 to 10 mm); the outermost
 * particles of the zone have little mass and, in some directions, stiffer neighbours. */
static text *packing_text(const int cells[2], const char *couple, const char *time,
                          const char *rest) {
    text *t = calloc(1, sizeof *t);
    add(t,
        "dimension: 2\n"
        "specimen: {group: 1, rectangle: {width: 10 mm, height: 6 mm}, origin: [4 mm, 0], "
        "mean_radius: 0.7 mm, density_basis: bulk, packing: {overlap: passive, size_variation: "
        "0.2}}\n"
        "materials: [{name: m, density: 7800, contact_modulus: 24e9, kratio: 3, friction: 0, "
        "tensile_strength: 1e15, shear_strength: 1e15}]\n"
        "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.1, passive_gaps: true}\n"
        "elements: {rectangle: {size: [10 mm, 6 mm], cells: [%d, %d]}, materials: "
        "[{young: 25e9, poisson: 0.2, density: 7800}]}\n"
        "couple: {zones: [{edges: [{from: [10 mm, 0], to: [4.5 mm, 0]}]}]%s%s}\n"
        "time: {end: 1%s%s}\n%s",
        cells[0] ? cells[0] : 5, cells[0] ? cells[1] : 3, couple ? ", " : "", couple ? couple : "",
        time ? ", " : "", time ? time : "", rest ? rest : "run: {threads: 1}\n");
    return t;
}

/* A model that is built repeatedly: a lattice or a packing. */
typedef struct model {
    const char *name;
    strip strip;
    bool packed;
    const char *more;
    int cells[2]; /* number of elements beside a packing; 0: 5 by 3, of 1.4 diameters of particles
                   */
} model;

static gn_world *made(const model *m, const char *time, const char *rest) {
    strip s = m->strip;
    s.more = m->more;
    s.time = time;
    s.rest = rest;
    text *t = m->packed ? packing_text(m->cells, m->more, time, rest) : text_of(&s);
    gn_world *w = world_of("%s", t->s);
    free(t);
    return w;
}

#define FLAT                                                                                       \
    { .length = 8e-3, .zone = 4e-3, .side = 2e-3, .rows = 2 }
#define DEEP                                                                                       \
    { .length = 6e-3, .zone = 2e-3, .side = 1e-3, .rows = 2, .space = true }
#define NO_STRIP                                                                                   \
    { .length = 0.0 }

static const model models[] = {
    {"lumped", FLAT, false, NULL, {0}},
    {"slaved", FLAT, false, "spins: slaved", {0}},
    {"consistent", FLAT, false, "constraint: consistent", {0}},
    {"penalty", FLAT, false, "constraint: penalty", {0}},
    {"lumped, packing", NO_STRIP, true, NULL, {0}},
    {"consistent, packing", NO_STRIP, true, "constraint: consistent, spins: slaved", {0}},
    {"penalty, packing", NO_STRIP, true, "constraint: penalty", {0}},
    {"lumped, in space", DEEP, false, NULL, {0}},
};
enum { MODELS = sizeof models / sizeof *models };

/* --- the matrix of the running model --- */

/* Velocities of all independent unknowns, by their number: nodes first. */
typedef struct unknowns {
    size_t count;
    double *value[4096];
} unknowns;

static void add_rows(unknowns *u, double *rows, size_t p, size_t from, size_t to) {
    for (size_t a = from; a < to; a++) {
        assert_true(u->count < 4096);
        u->value[u->count++] = rows + 4 * p + a;
    }
}

static unknowns *unknowns_of(gn_world *w) {
    unknowns *u = calloc(1, sizeof *u);
    gn_particles *nodes = &w->solids.elements[0]->solid.nodes, *q = &w->dem.particles;
    const size_t dim = (size_t)w->ctx.scene.dimension;
    const bool springs = w->ctx.scene.couple.constraint == GN_COUPLE_PENALTY,
               slaved = w->ctx.scene.couple.spins == GN_COUPLE_SLAVED;
    for (size_t n = 0; n < nodes->soa.count; n++) add_rows(u, nodes->vel, n, 0, dim);
    for (size_t id = 0; id < q->soa.count; id++) {
        const size_t p = (size_t)w->dem.index_of_id[id];
        const bool tied = tied_by_zone(w, p);
        if (!tied || springs) add_rows(u, q->vel, p, 0, dim);
        if (!tied || !slaved) add_rows(u, q->spin, p, dim == 3 ? 0 : 2, 3);
    }
    return u;
}

/* Column j of M^-1 K: the decrease of velocities in a step after one in which only j moved. Steps
 * and paths are small, so that only the linear part remains: strains of 1e-6. */
static void column_of(const model *m, const char *time, size_t j, double *column, size_t count) {
    const double speed = 1.0; /* m/s, or rad/s for rotations */
    gn_world *w = made(m, time, NULL);
    unknowns *u = unknowns_of(w);
    double *before = calloc(count, sizeof *before);
    assert_int_equal(u->count, count);
    *u->value[j] = speed;
    run_steps(w, 1);
    free(u);
    u = unknowns_of(w);
    for (size_t i = 0; i < count; i++) before[i] = *u->value[i];
    run_steps(w, 1);
    free(u);
    u = unknowns_of(w);
    for (size_t i = 0; i < count; i++)
        column[i] = (before[i] - *u->value[i]) / (w->ctx.dt * w->ctx.dt * speed);
    free(u);
    free(before);
    world_end(w);
}

/* Largest eigenvalue of a matrix without negative eigenvalues: tr(A^m)^(1/m) is between it and
 * n^(1/m) times it, m = 2^20. */
static double largest_eigenvalue(double *a, size_t n) {
    double log_scale = 0.0, power = 1.0, *b = calloc(n * n, sizeof *b);
    for (int round = 0; round < 20; round++) {
        double trace = 0.0;
        for (size_t k = 0; k < n; k++) trace += a[k * n + k];
        assert_true(trace > 0.0);
        log_scale += log(trace) / power;
        memset(b, 0, n * n * sizeof *b);
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < n; k++) {
                double x = a[i * n + k] / (trace * trace);
                for (size_t j = 0; x != 0.0 && j < n; j++) b[i * n + j] += x * a[k * n + j];
            }
        memcpy(a, b, n * n * sizeof *b);
        power *= 2.0;
    }
    free(b);
    double trace = 0.0;
    for (size_t k = 0; k < n; k++) trace += a[k * n + k];
    return exp(log_scale + log(trace) / power);
}

static double dense_limit(const model *m, double limit) {
    char time[64];
    snprintf(time, sizeof time, "step: %.17g", 1e-3 * limit);
    gn_world *w = made(m, time, NULL);
    unknowns *u = unknowns_of(w);
    const size_t n = u->count;
    free(u);
    world_end(w);
    double *a = calloc(n * n, sizeof *a), *column = calloc(n, sizeof *column);
    for (size_t j = 0; j < n; j++) {
        column_of(m, time, j, column, n);
        for (size_t i = 0; i < n; i++) a[i * n + j] = column[i];
    }
    double found = 2.0 / sqrt(largest_eigenvalue(a, n));
    free(a);
    free(column);
    return found;
}

/* Lanczos stops at 1e-3 of the square of the frequency. */
static void the_limit_of_both_as_one_is_that_of_the_whole_matrix(void **state) {
    (void)state;
    for (int k = 0; k < MODELS; k++) {
        gn_world *w = made(&models[k], NULL, NULL);
        const double sharp = gn_timestep_sharp_limit(&w->ctx, &w->solids),
                     bound = gn_timestep_bound(&w->ctx, &w->dem, &w->solids, &w->zones);
        const double sides = fmin(w->ctx.choice.limit.sharp, w->solids.elements[0]->limit.sharp);
        const gn_whole_limit *whole = gn_coupled_whole(&w->ctx, &w->zones);
        assert_non_null(whole);
        assert_true(sharp == whole->sharp);
        double dense = dense_limit(&models[k], sharp);
        print_message("# %s: sharp %.6g s, dense %.6g s, bound %.3f, sides %.3f of it; %s\n",
                      models[k].name, sharp, dense, bound / dense, sides / dense,
                      gn_side_text(whole->side));
        assert_near(sharp, dense, 1e-3 * dense);
        assert_true(bound <= dense * (1.0 + 1e-6));
        world_end(w);
    }
}

/* The result does not depend on whether a given step requires the limit. */
static void springs_of_a_zone_do_not_depend_on_how_the_step_is_given(void **state) {
    (void)state;
    double stiffness[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = made(&models[6], k ? "step: 1e-9" : NULL, NULL);
        const gn_coupled *q = w->zones.coupled;
        stiffness[k] = q->stiffness[q->ties.count / 2];
        world_end(w);
    }
    assert_true(stiffness[0] > 0.0 && stiffness[0] == stiffness[1]);
}

/* --- sharpness of the limit --- */

/* Returns the energy after a number of steps at a fraction of the sharp limit, over that at the
 * start; INFINITY if the run failed. */
static double energy_at(const model *m, double part, int steps) {
    char time[96];
    gneiss_error error = {0};
    gn_world *w = made(m, NULL, NULL);
    double limit = gn_timestep_sharp_limit(&w->ctx, &w->solids), grown = 0.0;
    const double space = w->ctx.scene.dimension == 3 ? 1.0 : 0.0;
    world_end(w);
    snprintf(time, sizeof time, "step: %.17g, on_unstable: warn", part * limit);
    w = made(m, time, NULL);
    set_fields(w, stir, &space);
    run_steps(w, 1);
    gn_energy e = measured_step(w);
    const double start = gn_energy_stored(&e);
    for (int k = 0; k < steps && isfinite(grown); k++)
        if (gn_world_step(w, k == steps - 1, &error) != GNEISS_OK) grown = INFINITY;
    if (isfinite(grown)) grown = fabs(gn_energy_stored(&w->ledger.reading)) / start;
    world_end(w);
    return grown;
}

/* Just below the limit, velocities of the fastest modes reach 1/sqrt(1 - 0.99^2) = 7 times their
 * initial values, and the small part of the energy that is in them grows 50 times. */
static void both_as_one_are_stable_up_to_their_sharp_limit(void **state) {
    (void)state;
    for (int k = 0; k < MODELS; k++) {
        double below = energy_at(&models[k], 0.99, 5000), above = energy_at(&models[k], 1.05, 2000);
        print_message("# %s: energy %.3g times at 0.99, %.3g at 1.05\n", models[k].name, below,
                      above);
        assert_true(below < 10.0);
        assert_true(above > 1e3);
    }
}

/* The part of the energy in the fastest modes oscillates, at most 50 times that energy. */
static void a_million_steps_at_0_99_of_the_limit_keep_the_energy(void **state) {
    (void)state;
    const model small[] = {
        {"small", {.length = 4e-3, .zone = 2e-3, .side = 1e-3, .rows = 1}, false, NULL, {0}},
        {"consistent",
         {.length = 4e-3, .zone = 2e-3, .side = 1e-3, .rows = 1},
         false,
         "constraint: consistent",
         {0}}};
    for (int k = 0; k < 2; k++) {
        double grown = energy_at(&small[k], 0.99, k ? 100000 : 1000000);
        print_message("# energy %.9g times at the end\n", grown);
        assert_near(grown, 1.0, 1e-4);
    }
}

static void an_automatic_step_is_that_of_both_as_one(void **state) {
    (void)state;
    for (int k = 0; k < MODELS; k++) {
        gn_world *w = made(&models[k], NULL, NULL);
        const double sharp = gn_timestep_sharp_limit(&w->ctx, &w->solids);
        assert_near(w->ctx.stable, sharp, 1e-12 * sharp);
        assert_near(w->ctx.dt, w->ctx.scene.safety * sharp, 1e-12 * sharp);
        world_end(w);
    }
}

/* The outermost particles of the zone of a packing would require a smaller step on their own;
 * springs are softer than the bound has to assume. */
static void both_as_one_may_hold_more_than_each_by_itself(void **state) {
    (void)state;
    for (int k = 4; k < 7; k++) {
        gn_world *w = made(&models[k], NULL, NULL);
        double sides =
            gn_limit_of_all(&w->ctx, &w->dem, &w->solids, &w->zones, w->ctx.choice.stable);
        print_message("# %s: %.3f of what each holds\n", models[k].name,
                      gn_timestep_sharp_limit(&w->ctx, &w->solids) / sides);
        assert_true(gn_timestep_sharp_limit(&w->ctx, &w->solids) > 1.01 * sides);
        world_end(w);
    }
}

/* The elements are ten times as stiff, the particles unchanged. */
static void the_side_with_the_fastest_mode_is_named(void **state) {
    (void)state;
    char who[128];
    gn_world *w = made(&models[0], NULL, NULL);
    assert_true(gn_coupled_whole(&w->ctx, &w->zones)->side == GN_SIDE_PARTICLES);
    assert_non_null(strstr(gn_whole_culprit(gn_coupled_whole(&w->ctx, &w->zones), who, sizeof who),
                           "the particles, particle "));
    assert_null(gn_timestep_elements_lead(&w->ctx, &w->solids, &w->zones));
    world_end(w);
}

static void the_limit_is_the_same_on_any_number_of_threads(void **state) {
    (void)state;
    for (int k = 0; k < MODELS; k++) {
        gn_world *a = made(&models[k], NULL, "run: {threads: 1}\n"),
                 *b = made(&models[k], NULL, "run: {threads: 2}\n");
        assert_true(gn_timestep_sharp_limit(&a->ctx, &a->solids) ==
                        gn_timestep_sharp_limit(&b->ctx, &b->solids) &&
                    a->ctx.dt == b->ctx.dt);
        world_end(a);
        world_end(b);
    }
}

/* Dashpots of contacts and of springs lower the limit: at 0.99 of it energies decrease, at 1.05
 * they grow. */
static double damped_energy(const char *more, double part, int steps) {
    char time[96];
    gneiss_error error = {0};
    strip s = FLAT;
    s.more = more;
    s.rest = "damping: {contact: {restitution: 0.5}}\nrun: {threads: 1}\n";
    gn_world *w = strip_of(&s);
    const double limit = w->ctx.stable;
    assert_true(limit <= gn_timestep_sharp_limit(&w->ctx, &w->solids) * (1.0 + 1e-12));
    world_end(w);
    snprintf(time, sizeof time, "step: %.17g, on_unstable: warn", part * limit);
    s.time = time;
    w = stirred(&s);
    gn_energy e = measured_step(w);
    double start = gn_energy_stored(&e), grown = 0.0;
    for (int k = 0; k < steps && isfinite(grown); k++)
        if (gn_world_step(w, k == steps - 1, &error) != GNEISS_OK) grown = INFINITY;
    if (isfinite(grown)) grown = fabs(gn_energy_stored(&w->ledger.reading)) / start;
    world_end(w);
    return grown;
}

static void dashpots_are_in_the_limit_of_both_as_one(void **state) {
    (void)state;
    const char *more[] = {NULL, "constraint: penalty, penalty_damping: 0.3"};
    for (int k = 0; k < 2; k++) {
        double below = damped_energy(more[k], 0.99, 3000),
               above = damped_energy(more[k], 1.05, 3000);
        print_message("# energy %.3g times at 0.99, %.3g at 1.05\n", below, above);
        assert_true(below < 1.0);
        assert_true(above > 1e3);
    }
}

/* --- steps that collisions ask for --- */

/* m/s2, along an axis, acceleration of a particle of a zone by a force of 1 N on it. */
static double moved_by(gn_world *w, size_t k, int axis) {
    gn_coupled *q = w->zones.coupled;
    gn_fem_solid *b = &w->solids.elements[0]->solid;
    double sum = 0.0;
    memset(q->load, 0, q->ties.count * sizeof *q->load);
    if (q->turn) memset(q->turn, 0, q->ties.count * sizeof *q->turn);
    q->load[k][axis] = 1.0;
    for (size_t n = 0; n < q->ties.nodes; n++)
        memset(gn_hold_load(&b->hold, 4, (size_t)q->ties.node[n]), 0, 3 * sizeof(double));
    gn_coupled_add_to_nodes(&w->ctx, &w->dem, &w->solids, q);
    if (q->before) gn_masses_correct(&w->ctx, &w->solids, q);
    for (int a = 0; a < q->ties.corners; a++) {
        const size_t node = (size_t)q->ties.tie[k].node[a];
        sum += q->ties.tie[k].shape[a] * gn_hold_load(&b->hold, 4, node)[axis] *
               b->nodes.vel[4 * node + 3];
    }
    return sum;
}

/* The resistance to the force is the mass of the nodes: with lumped masses exactly the lump, with
 * consistent masses never less than the mass that was removed. */
static void particles_of_zones_give_way_as_their_nodes_do(void **state) {
    (void)state;
    for (int k = 0; k < MODELS; k++) {
        gn_world *w = made(&models[k], NULL, NULL);
        const gn_coupled *q = w->zones.coupled;
        const size_t n = w->dem.particles.soa.count;
        double *inverse = calloc(n, sizeof *inverse), least = INFINITY, most = 0.0;
        run_steps(w, 1);
        for (size_t p = 0; p < n; p++) inverse[p] = w->dem.particles.vel[4 * p + 3];
        gn_coupled_inverse_masses(&w->ctx, &w->dem, &w->solids, &w->zones, inverse);
        for (size_t t = 0; !q->stiffness && t < q->ties.count; t++) {
            const size_t p = (size_t)q->place[t];
            const double part = moved_by(w, t, (int)(t % 2)) / inverse[p];
            least = fmin(least, part);
            most = fmax(most, part);
        }
        print_message("# %s: %.6g to %.6g of what is taken\n", models[k].name, least, most);
        assert_true(most <= 1.0 + 1e-9 && (!isfinite(least) || least > 0.1));
        if (!q->stiffness && !q->before) assert_near(least, 1.0, 1e-12);
        for (size_t p = 0; p < n; p++)
            if (!tied_by_zone(w, p) || q->stiffness)
                assert_true(inverse[p] == w->dem.particles.vel[4 * p + 3]);
        free(inverse);
        world_end(w);
    }
}

/* s: the step that collisions of a lattice with softening bonds require. */
static double asked_by_softening(const char *couple) {
    gn_world *w = world_of(
        "dimension: 2\n"
        "specimen: {group: 1, lattice: {kind: square, radius: 0.25 mm, cells: [20, 12], "
        "origin: [4 mm, 0]}}\n"
        "materials: [{name: m, density: 7800, contact_modulus: 24e9, kratio: 3, friction: 0.5, "
        "tensile_strength: 4e6, shear_strength: 12e6, fracture_energy: 20}]\n"
        "law: {stiffness: harmonic, softening: energy}\n"
        "bonds: {interaction_range: 0.1}\n%s"
        "time: {end: 1}\nrun: {threads: 1}\n",
        couple);
    const double step = w->ctx.choice.resolution.step;
    world_end(w);
    return step;
}

/* If bonds soften, the shortest period must last five steps. With the masses of particles at the
 * edge of a zone, which touch others with weighted contacts, it would not, but these particles move
 * with nodes. */
static void bonds_of_a_zone_that_soften_ask_for_no_shorter_step_than_others(void **state) {
    (void)state;
    static const char *const with[] = {"", ", constraint: consistent", ", spins: slaved"};
    const double alone = asked_by_softening("");
    assert_true(isfinite(alone));
    for (int k = 0; k < 3; k++) {
        char couple[400];
        snprintf(couple, sizeof couple,
                 "elements: {rectangle: {size: [10 mm, 6 mm], cells: [10, 6]}, materials: "
                 "[{young: 25e9, poisson: 0.2, density: 7800}]}\n"
                 "couple: {zones: [{edges: [{from: [10 mm, 0], to: [4.25 mm, 0]}]}]%s}\n",
                 with[k]);
        const double step = asked_by_softening(couple);
        print_message("# softening%s: %.3f of the step without a zone\n", with[k], step / alone);
        assert_true(step >= alone);
    }
}

/* --- elements that are small beside the particles that they turn --- */

#define CONSISTENT "constraint: consistent, spins: slaved"
#define STRIP(h)                                                                                   \
    { .length = 6e-3, .zone = 3e-3, .side = (h), .rows = 3 }
#define SOLID(h)                                                                                   \
    { .length = 4e-3, .zone = 2e-3, .side = (h), .rows = 1, .space = true }

static const model turned_models[] = {
    {"lattice, cells 0.5", STRIP(0.5e-3), false, CONSISTENT, {0}},
    {"lattice, cells 1.0",
     {.length = 6e-3, .zone = 4e-3, .side = 1e-3, .rows = 3},
     false,
     CONSISTENT,
     {0}},
    {"lattice, cells 1.5", STRIP(1.5e-3), false, CONSISTENT, {0}},
    {"packing, cells 0.4", NO_STRIP, true, CONSISTENT, {18, 11}},
    {"packing, cells 0.7", NO_STRIP, true, CONSISTENT, {10, 6}},
    {"in space, cells 0.5", SOLID(0.5e-3), false, CONSISTENT, {0}},
    {"in space, cells 1.0", SOLID(1e-3), false, CONSISTENT, {0}},
    {"lumped lattice, cells 0.5", STRIP(0.5e-3), false, "spins: slaved", {0}},
    {"lumped packing, cells 0.7", NO_STRIP, true, "spins: slaved", {10, 6}},
    {"lumped in space, cells 0.5", SOLID(0.5e-3), false, "spins: slaved", {0}},
};
enum { TURNED = sizeof turned_models / sizeof *turned_models };

/* Elements that rotate particles without moving them have only the nodes' own mass. */
static void small_elements_that_turn_particles_are_in_bound_and_step(void **state) {
    (void)state;
    for (int k = 0; k < TURNED; k++) {
        const model *m = &turned_models[k];
        gn_world *w = made(m, NULL, NULL);
        const double sharp = gn_timestep_sharp_limit(&w->ctx, &w->solids),
                     bound = gn_timestep_bound(&w->ctx, &w->dem, &w->solids, &w->zones);
        const double sides = gn_limit_of_all(&w->ctx, &w->dem, &w->solids, &w->zones,
                                             w->ctx.choice.stable),
                     stable = w->ctx.stable;
        const double dt = w->ctx.dt, safety = w->ctx.scene.safety;
        world_end(w);
        w = made(m, "estimate: bound", NULL);
        const double careful = w->ctx.dt;
        world_end(w);
        const double dense = dense_limit(m, sharp);
        print_message("# %s: sharp %.6g s, dense %.6g s, bound %.3f, sides %.3f of it\n", m->name,
                      sharp, dense, bound / dense, sides / dense);
        assert_near(sharp, dense, 1e-3 * dense);
        assert_true(bound <= dense * (1.0 + 1e-6) && sides <= dense * (1.0 + 1e-6));
        assert_true(bound > 0.05 * dense);
        assert_true(stable <= sharp && dt <= safety * sharp);
        assert_near(careful, safety * bound, 1e-9 * bound);
        assert_true(energy_at(m, safety, 2000) < 10.0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_limit_of_both_as_one_is_that_of_the_whole_matrix),
        cmocka_unit_test(springs_of_a_zone_do_not_depend_on_how_the_step_is_given),
        cmocka_unit_test(both_as_one_are_stable_up_to_their_sharp_limit),
        cmocka_unit_test(a_million_steps_at_0_99_of_the_limit_keep_the_energy),
        cmocka_unit_test(an_automatic_step_is_that_of_both_as_one),
        cmocka_unit_test(both_as_one_may_hold_more_than_each_by_itself),
        cmocka_unit_test(the_side_with_the_fastest_mode_is_named),
        cmocka_unit_test(the_limit_is_the_same_on_any_number_of_threads),
        cmocka_unit_test(small_elements_that_turn_particles_are_in_bound_and_step),
        cmocka_unit_test(dashpots_are_in_the_limit_of_both_as_one),
        cmocka_unit_test(particles_of_zones_give_way_as_their_nodes_do),
        cmocka_unit_test(bonds_of_a_zone_that_soften_ask_for_no_shorter_step_than_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
