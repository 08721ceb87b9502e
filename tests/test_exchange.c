/* The seam between force and motion: an exchange adds to the loads of held blocks. */
#include "world_helpers.h"

#include "run/part_files.h"
#include "timestep/timestep.h"
#include "world/features.h"

#include <unistd.h>

/* Points of two parts of the world at the same positions move together: both get the force that
 * makes their next velocities equal. */
typedef struct tie {
    int part[2]; /* -1: particles; else a solid of elements */
    size_t count;
    int32_t point[64][2]; /* particles by id, nodes by index */
    double force[64][3];  /* N, force on the first of the two in the last step */
} tie;

/* One side of a tie. */
typedef struct end {
    const gn_particles *points;
    gn_hold *hold;
    size_t place;
    int width;
} end;

static end end_of(gn_world *w, const tie *t, size_t k, int side) {
    const bool space = w->ctx.scene.dimension == 3;
    int part = t->part[side];
    int32_t point = t->point[k][side];
    if (part < 0)
        return (end){&w->dem.particles, &w->dem.hold, (size_t)w->dem.index_of_id[point],
                     gn_row_width(space, true)};
    gn_fem_solid *b = &w->solids.elements[part]->solid;
    return (end){&b->nodes, &b->hold, (size_t)point, gn_row_width(space, false)};
}

static gneiss_status tie_mark(void *context, gn_world *w, gneiss_error *error) {
    const tie *t = context;
    for (size_t k = 0; k < t->count; k++)
        for (int side = 0; side < 2; side++) {
            end e = end_of(w, t, k, side);
            GN_TRY(gn_hold_particle(e.hold, e.place, error));
        }
    return GNEISS_OK;
}

static gneiss_status tie_act(void *context, gn_world *w, gneiss_error *error) {
    tie *t = context;
    (void)error;
    double interval = 0.5 * (w->ctx.dt_past + w->ctx.dt);
    for (size_t k = 0; k < t->count; k++) {
        end a = end_of(w, t, k, 0), b = end_of(w, t, k, 1);
        const double *v = a.points->vel + 4 * a.place, *u = b.points->vel + 4 * b.place;
        double *f = gn_hold_load(a.hold, a.width, a.place);
        double *g = gn_hold_load(b.hold, b.width, b.place);
        for (int c = 0; c < (int)w->ctx.scene.dimension; c++) {
            double gap = (u[c] + interval * u[3] * g[c]) - (v[c] + interval * v[3] * f[c]);
            double force = gap / (interval * (v[3] + u[3]));
            f[c] += force;
            g[c] -= force;
            t->force[k][c] = force;
        }
    }
    return GNEISS_OK;
}

/* Waves along two axes. */
static void stir(const gn_world *w, const gn_particles *q) {
    const int64_t up = w->ctx.scene.dimension - 1;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p;
        double *v = q->vel + 4 * p;
        v[0] = 0.02 * sin(900.0 * x[up]);
        v[up] = 0.03 * cos(700.0 * x[0]);
    }
}

/* Waves in a bonded lattice beside a block of elements, whose top nodes are the centres of the
 * lowest layer of particles. */
static gn_world *solids(int dimension, double step, int threads) {
    text *t = calloc(1, sizeof *t);
    int layers = dimension == 3 ? 6 : 1;
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < layers; y++)
            for (int x = 0; x < 6; x++) {
                if (dimension == 3)
                    add(t, "    - [%g, %g, %g, 5e-4]\n", 1e-3 * x, 1e-3 * y, 3e-3 + 1e-3 * z);
                else
                    add(t, "    - [%g, %g, 5e-4]\n", 1e-3 * x, 3e-3 + 1e-3 * z);
            }
    gn_world *w =
        world_of("dimension: %d\nspecimen:\n  group: 1\n  particles:\n%smaterials: [{name: m, "
                 "density: 2500, "
                 "contact_modulus: 2e8, kratio: 2, friction: 0.5, tensile_strength: 1e15, "
                 "shear_strength: 1e15}]\n"
                 "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.01}\n"
                 "elements: {%s, materials: [{young: 1e8, poisson: 0.2, density: 2000}]}\n"
                 "time: {step: %g, end: 1}\nrun: {threads: %d}\n",
                 dimension, t->s,
                 dimension == 3 ? "box: {size: [5e-3, 5e-3, 3e-3], cells: [5, 5, 3]}"
                                : "rectangle: {size: [5e-3, 3e-3], cells: [5, 3]}",
                 step, threads);
    free(t);
    stir(w, &w->dem.particles);
    stir(w, &w->solids.elements[0]->solid.nodes);
    return w;
}

/* The lattice of solids() with a second, softer block of elements below the first one. */
typedef struct two_blocks {
    gn_world *w;
    gn_element_def def;
    gn_element_material material;
    tie upper, lower;
} two_blocks;

static void tie_make(tie *t, gn_world *w, int first, int second) {
    gneiss_error error = {0};
    *t = (tie){.part = {first, second}};
    size_t n[2];
    const gn_particles *q[2];
    for (int side = 0; side < 2; side++)
        q[side] =
            t->part[side] < 0 ? &w->dem.particles : &w->solids.elements[t->part[side]]->solid.nodes;
    for (n[0] = 0; n[0] < q[0]->soa.count; n[0]++)
        for (n[1] = 0; n[1] < q[1]->soa.count; n[1]++) {
            const double *x = q[0]->pos + 4 * n[0], *y = q[1]->pos + 4 * n[1];
            double d2 = 0.0;
            for (int a = 0; a < (int)w->ctx.scene.dimension; a++)
                d2 += (x[a] - y[a]) * (x[a] - y[a]);
            if (d2 > 1e-20) continue;
            for (int side = 0; side < 2; side++)
                t->point[t->count][side] =
                    t->part[side] < 0 ? q[side]->id[n[side]] : (int32_t)n[side];
            t->count++;
        }
    assert_int_equal(t->count, w->ctx.scene.dimension == 3 ? 36 : 6);
    const gn_feature tied = {.hook = {[GN_HOOK_LISTS] = tie_mark, [GN_HOOK_ACT] = tie_act},
                             .context = t};
    if (gn_feature_add(w, tied, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static two_blocks *stack(int dimension, double step, int threads) {
    two_blocks *s = calloc(1, sizeof *s);
    gneiss_error error = {0};
    s->w = solids(dimension, step, threads);
    s->def = s->w->ctx.scene.elements;
    s->material = s->def.materials[0];
    s->material.young *= 0.5;
    s->def.materials = &s->material;
    s->def.origin[dimension - 1] -= 3e-3;
    if (gn_elements_add(&s->w->ctx, &s->w->solids, &s->def, NULL, &error) != GNEISS_OK ||
        gn_timestep_check(&s->w->ctx, &s->w->dem, &s->w->boundary, &s->w->solids, &s->w->zones,
                          &s->w->ledger, true, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    stir(s->w, &s->w->solids.elements[1]->solid.nodes);
    tie_make(&s->upper, s->w, -1, 0);
    tie_make(&s->lower, s->w, 0, 1);
    return s;
}

static void stack_end(two_blocks *s) {
    world_end(s->w);
    free(s);
}

static void add_momentum(const gn_particles *q, double sum[6], double *size) {
    for (size_t p = 0; p < q->soa.count; p++) {
        const double *x = q->pos + 4 * p, *v = q->vel + 4 * p, m = 1.0 / v[3];
        const double *o = q->spin ? q->spin + 4 * p : NULL;
        for (int a = 0; a < 3; a++) {
            int c = (a + 1) % 3, d = (a + 2) % 3;
            sum[a] += m * v[a];
            sum[3 + a] += m * (x[c] * v[d] - x[d] * v[c]) + (o ? o[a] / o[3] : 0.0);
            *size += m * fabs(v[a]);
        }
    }
}

static void momentum_of(const gn_world *w, double sum[6], double *size) {
    memset(sum, 0, 6 * sizeof *sum);
    *size = 0.0;
    add_momentum(&w->dem.particles, sum, size);
    for (size_t k = 0; k < w->solids.count; k++)
        add_momentum(&w->solids.elements[k]->solid.nodes, sum, size);
}

static void assert_together(gn_world *w, const tie *t) {
    for (size_t k = 0; k < t->count; k++) {
        end a = end_of(w, t, k, 0), b = end_of(w, t, k, 1);
        for (size_t c = 0; c < (size_t)w->ctx.scene.dimension; c++) {
            assert_near(a.points->vel[4 * a.place + c], b.points->vel[4 * b.place + c], 1e-14);
            assert_near(a.points->pos[4 * a.place + c], b.points->pos[4 * b.place + c], 1e-15);
        }
    }
}

static double largest_of(const tie *t, double most) {
    for (size_t k = 0; k < t->count; k++) most = fmax(most, fabs(t->force[k][0]));
    return most;
}

/* Returns the largest error of the ledger, over the energy of the parts at the start. */
static double run_steps_tied(gn_world *w, int steps) {
    gn_energy e = measured_step(w);
    double before[6], after[6], size, scale = gn_energy_stored(&e), worst = 0.0;
    momentum_of(w, before, &size);
    for (int n = 0; n < steps; n++) {
        e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)) * gn_energy_scale(&e));
    }
    momentum_of(w, after, &size);
    for (int a = 0; a < 6; a++) /* rounding of this number of steps; arms are 6 mm */
        assert_near(after[a], before[a], 2.2e-16 * steps * 10.0 * size * (a < 3 ? 1.0 : 6e-3));
    return worst / scale;
}

static double run_tied(int dimension, double step, int steps) {
    gn_world *w = solids(dimension, step, 2);
    tie t;
    tie_make(&t, w, -1, 0);
    double lost = run_steps_tied(w, steps);
    assert_true(largest_of(&t, 0.0) > 0.0);
    assert_together(w, &t);
    world_end(w);
    return lost;
}

static double run_stack(int dimension, double step, int steps) {
    two_blocks *s = stack(dimension, step, 2);
    double lost = run_steps_tied(s->w, steps);
    assert_true(largest_of(&s->upper, 0.0) > 0.0 && largest_of(&s->lower, 0.0) > 0.0);
    assert_together(s->w, &s->upper);
    assert_together(s->w, &s->lower);
    stack_end(s);
    return lost;
}

static void tied_bodies_keep_momentum_and_energy(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        double coarse = run_tied(dimension, 4e-7, 2000), fine = run_tied(dimension, 2e-7, 4000);
        /* The elements' law is not linear: the residual is of second order. */
        assert_true(coarse < 1e-4);
        assert_true(fine < 0.35 * coarse);
    }
}

static void two_bodies_of_elements_keep_momentum_and_energy(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        double coarse = run_stack(dimension, 4e-7, 2000), fine = run_stack(dimension, 2e-7, 4000);
        assert_true(coarse < 1e-4);
        assert_true(fine < 0.35 * coarse);
    }
}

static uint64_t stack_after(int threads, int steps) {
    two_blocks *s = stack(3, 4e-7, threads);
    run_steps(s->w, steps);
    uint64_t hash =
        gn_world_hash(&s->w->ctx, &s->w->dem, &s->w->boundary, &s->w->solids, &s->w->box);
    stack_end(s);
    return hash;
}

static void two_bodies_of_elements_give_the_same_bits_on_any_number_of_threads(void **state) {
    (void)state;
    uint64_t one = stack_after(1, 300);
    for (int threads = 2; threads <= 4; threads++) assert_true(stack_after(threads, 300) == one);
}

/* Quantities of the elements include all solids. */
static void a_world_sums_over_its_bodies_of_elements(void **state) {
    (void)state;
    two_blocks *s = stack(3, 4e-7, 1);
    gn_world *w = s->w;
    gn_fem_solid *a = &w->solids.elements[0]->solid, *b = &w->solids.elements[1]->solid;
    gn_element_totals t = gn_elements_totals(&w->solids);
    assert_int_equal(t.nodes, a->nodes.soa.count + b->nodes.soa.count);
    assert_int_equal(t.elements, a->elements.soa.count + b->elements.soa.count);
    assert_near(t.mass, a->mass + b->mass, 1e-15 * t.mass);
    assert_near(gn_world_mass(&w->dem, &w->solids), w->dem.mass + t.mass,
                1e-15 * gn_world_mass(&w->dem, &w->solids));
    assert_true(w->solids.elements[1]->stable >
                w->solids.elements[0]->stable); /* the second solid is half as stiff */
    assert_true(gn_elements_stable(&w->solids) == w->solids.elements[0]->stable);
    uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    b->nodes.pos[0] += 1e-9;
    assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) != hash);
    stack_end(s);
}

static size_t rows_of(const gn_h5 *file, const char *name) {
    gneiss_error error = {0};
    size_t rows = 0;
    if (gn_h5_rows(file, name, &rows, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return rows;
}

typedef gneiss_status writer(const gn_world *w, gn_h5 *file, gneiss_error *error);

/* Checks the rows that a writer leaves in a file for three data sets: that of the first solid, of
 * the second, and one that a third solid does not have. */
static void assert_bodies_in_file(const gn_world *w, writer *write, const char *name) {
    char path[] = "/tmp/gneiss-two-bodies-XXXXXX", second[64], third[64];
    gneiss_error error = {0};
    gn_h5 *file = NULL;
    snprintf(second, sizeof second, "elements_2/%s", name);
    snprintf(third, sizeof third, "elements_3/%s", name);
    close(mkstemp(path));
    assert_int_equal(gn_h5_create(path, &file, &error), GNEISS_OK);
    assert_int_equal(write(w, file, &error), GNEISS_OK);
    assert_int_equal(gn_h5_commit(&file, GN_DURABLE, &error), GNEISS_OK);
    assert_int_equal(gn_h5_open_whole(path, &file, &error), GNEISS_OK);
    assert_int_equal(rows_of(file, name), w->solids.elements[0]->solid.nodes.soa.count);
    assert_int_equal(rows_of(file, second), w->solids.elements[1]->solid.nodes.soa.count);
    assert_false(gn_h5_has(file, third));
    gn_h5_close(file);
    unlink(path);
}

/* The first solid has the same names as if it were the only one. */
static void files_distinguish_bodies_of_elements(void **state) {
    (void)state;
    two_blocks *s = stack(2, 4e-7, 1);
    assert_bodies_in_file(s->w, gn_output_elements_results, "nodes/id");
    assert_bodies_in_file(s->w, gn_checkpoint_put_elements, "mesh_nodes/pos");
    stack_end(s);
}

static uint64_t hash_after(int threads, bool tied, int steps) {
    gn_world *w = solids(3, 4e-7, threads);
    tie t;
    if (tied) tie_make(&t, w, -1, 0);
    run_steps(w, steps);
    uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    world_end(w);
    return hash;
}

static void an_exchange_gives_the_same_bits_on_any_number_of_threads(void **state) {
    (void)state;
    uint64_t one = hash_after(1, true, 300);
    for (int threads = 2; threads <= 4; threads++)
        assert_true(hash_after(threads, true, 300) == one);
    assert_true(hash_after(1, false, 300) != one);
}

static gneiss_status nothing(void *context, gn_world *w, gneiss_error *error) {
    (void)context;
    (void)w;
    (void)error;
    return GNEISS_OK;
}

static void waiting_changes_no_bit(void **state) {
    (void)state;
    gn_world *w = solids(3, 4e-7, 2);
    tie t;
    tie_make(&t, w, -1, 0);
    w->features.added[0].hook[GN_HOOK_ACT] = nothing;
    run_steps(w, 300);
    assert_true(w->dem.hold.count > 0 && w->solids.elements[0]->solid.hold.count > 0);
    assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) ==
                hash_after(1, false, 300));
    world_end(w);
}

static gneiss_status refuse(void *context, gn_world *w, gneiss_error *error) {
    (void)context;
    return gn_fail(error, GNEISS_ERROR_UNSTABLE, "step %lld: refused", (long long)w->ctx.step);
}

static void an_exchange_may_stop_the_run(void **state) {
    (void)state;
    gn_world *w = solids(2, 4e-7, 1);
    gneiss_error error = {0};
    const gn_feature stop = {.hook = {[GN_HOOK_ACT] = refuse}};
    assert_int_equal(gn_feature_add(w, stop, &error), GNEISS_OK);
    assert_int_equal(gn_world_step(w, false, &error), GNEISS_ERROR_UNSTABLE);
    assert_string_equal(error.message, "step 0: refused");
    world_end(w);
}

static void assert_uses(const gn_world *w, const char *names) {
    text *used = calloc(1, sizeof *used);
    for (size_t k = 0; k < w->features.used_count; k++)
        add(used, "%s%s", k ? " " : "", w->features.used[k]->name);
    assert_string_equal(used->s, names);
    free(used);
}

static void a_world_uses_the_features_of_its_scene(void **state) {
    (void)state;
    gn_world *w = solids(3, 4e-7, 1);
    assert_uses(w, "depth gauge events");
    assert_false(w->features.holds);
    world_end(w);
    w = world_of("specimen: {particles: [[0, 0, 0, 1e-3]]}\ngravity: [0, 0, -9.81]\n"
                 "materials: [{name: m, density: 2500, young: 1e9, poisson: 0.2}]\n"
                 "law: {stiffness: hertz}\nwalls: [{name: floor, point: [0, 0, -2e-3], "
                 "normal: [0, 0, 1]}]\ntime: {end: 1}\n");
    assert_uses(w, "indentation bodies debris depth gauge");
    world_end(w);
}

/* The places of a step at which a feature was called, in their order. */
static gneiss_status note(char **calls, char place) {
    *(*calls)++ = place;
    return GNEISS_OK;
}
#define NOTE(name, place)                                                                          \
    static gneiss_status name(void *calls, gn_world *w, gneiss_error *error) {                     \
        (void)w, (void)error;                                                                      \
        return note(calls, place);                                                                 \
    }
NOTE(before_lists, '1')
NOTE(limit, '2')
NOTE(reading, '3')
NOTE(before_forces, '4')
NOTE(at_act, '5')
NOTE(work, '6')
NOTE(moved, '7')
NOTE(elements_moved, '8')
NOTE(read_all, '9')
NOTE(after_step, '.')

static void a_feature_is_called_at_every_place_of_a_step(void **state) {
    (void)state;
    char places[64] = "", *calls = places;
    const gn_feature probe = {.hook = {[GN_HOOK_BEFORE_LISTS] = before_lists,
                                       [GN_HOOK_LIMIT] = limit,
                                       [GN_HOOK_REQUEST_READING] = reading,
                                       [GN_HOOK_BEFORE_FORCES] = before_forces,
                                       [GN_HOOK_ACT] = at_act,
                                       [GN_HOOK_WORK] = work,
                                       [GN_HOOK_MOVED] = moved,
                                       [GN_HOOK_ELEMENTS_MOVED] = elements_moved,
                                       [GN_HOOK_ADD_TO_READING] = read_all,
                                       [GN_HOOK_AFTER_STEP] = after_step},
                              .context = &calls};
    gn_world *w = solids(2, 4e-7, 1);
    gneiss_error error = {0};
    assert_int_equal(gn_feature_add(w, probe, &error), GNEISS_OK);
    assert_int_equal(gn_world_step(w, true, &error), GNEISS_OK);
    assert_int_equal(gn_world_step(w, false, &error), GNEISS_OK);
    assert_string_equal(places, "123456789.12345678.");
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tied_bodies_keep_momentum_and_energy),
        cmocka_unit_test(two_bodies_of_elements_keep_momentum_and_energy),
        cmocka_unit_test(two_bodies_of_elements_give_the_same_bits_on_any_number_of_threads),
        cmocka_unit_test(a_world_sums_over_its_bodies_of_elements),
        cmocka_unit_test(files_distinguish_bodies_of_elements),
        cmocka_unit_test(an_exchange_gives_the_same_bits_on_any_number_of_threads),
        cmocka_unit_test(waiting_changes_no_bit),
        cmocka_unit_test(an_exchange_may_stop_the_run),
        cmocka_unit_test(a_world_uses_the_features_of_its_scene),
        cmocka_unit_test(a_feature_is_called_at_every_place_of_a_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
