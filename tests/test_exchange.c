/* The seam between force and motion: an exchange adds to the loads of what waits for it. */
#include "world_helpers.h"

#include "sim/exchange.h"

/* A particle and a node at the same place move as one: both get the force that makes their next
 * velocities equal. */
typedef struct tie {
    size_t count;
    int32_t id[64];      /* of particles */
    int32_t node[64];    /* by place */
    double force[64][3]; /* N, on the particles, of the last step */
} tie;

static gneiss_status tie_mark(void *context, gn_world *w, gneiss_error *error) {
    const tie *t = context;
    for (size_t k = 0; k < t->count; k++) {
        GN_TRY(gn_hold_particle(&w->dem.hold, (size_t)w->dem.index_of_id[t->id[k]], error));
        GN_TRY(gn_hold_particle(&w->elements->body.hold, (size_t)t->node[k], error));
    }
    return GNEISS_OK;
}

static gneiss_status tie_act(void *context, gn_world *w, gneiss_error *error) {
    tie *t = context;
    (void)error;
    const bool space = w->scene.dimension == 3;
    const gn_particles *nodes = &w->elements->body.nodes;
    double interval = 0.5 * (w->dt_past + w->dt);
    for (size_t k = 0; k < t->count; k++) {
        size_t p = (size_t)w->dem.index_of_id[t->id[k]], n = (size_t)t->node[k];
        const double *v = w->dem.particles.vel + 4 * p, *u = nodes->vel + 4 * n;
        double *f = gn_hold_load(&w->dem.hold, gn_row_width(space, true), p);
        double *g = gn_hold_load(&w->elements->body.hold, gn_row_width(space, false), n);
        for (int a = 0; a < (space ? 3 : 2); a++) {
            double gap = (u[a] + interval * u[3] * g[a]) - (v[a] + interval * v[3] * f[a]);
            double force = gap / (interval * (v[3] + u[3]));
            f[a] += force;
            g[a] -= force;
            t->force[k][a] = force;
        }
    }
    return GNEISS_OK;
}

/* Waves in a bonded lattice beside a block of elements, whose top nodes are the centres of the
 * lowest layer of particles. */
static gn_world *bodies(int dimension, double step, int threads) {
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
    gn_particles *all[2] = {&w->dem.particles, &w->elements->body.nodes};
    for (int b = 0; b < 2; b++)
        for (size_t p = 0; p < all[b]->soa.count; p++) {
            const double *x = all[b]->pos + 4 * p;
            double *v = all[b]->vel + 4 * p;
            v[0] = 0.02 * sin(900.0 * x[dimension - 1]);
            v[dimension - 1] = 0.03 * cos(700.0 * x[0]);
        }
    return w;
}

static void tie_make(tie *t, gn_world *w) {
    gneiss_error error = {0};
    const gn_particles *nodes = &w->elements->body.nodes;
    *t = (tie){0};
    for (size_t k = 0; k < w->dem.particles.soa.count; k++)
        for (size_t n = 0; n < nodes->soa.count; n++) {
            const double *x = pos_of(w, (int)k), *y = nodes->pos + 4 * n;
            double d2 = 0.0;
            for (int a = 0; a < (int)w->scene.dimension; a++) d2 += (x[a] - y[a]) * (x[a] - y[a]);
            if (d2 > 1e-20) continue;
            t->id[t->count] = (int32_t)k;
            t->node[t->count++] = (int32_t)n;
        }
    if (gn_exchange_add(w, (gn_exchange){t, tie_mark, tie_act, NULL}, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
}

static void momentum_of(const gn_world *w, double sum[6], double *size) {
    const gn_particles *all[2] = {&w->dem.particles, &w->elements->body.nodes};
    memset(sum, 0, 6 * sizeof *sum);
    *size = 0.0;
    for (int b = 0; b < 2; b++)
        for (size_t p = 0; p < all[b]->soa.count; p++) {
            const double *x = all[b]->pos + 4 * p, *v = all[b]->vel + 4 * p, m = 1.0 / v[3];
            const double *o = all[b]->spin ? all[b]->spin + 4 * p : NULL;
            for (int a = 0; a < 3; a++) {
                int c = (a + 1) % 3, d = (a + 2) % 3;
                sum[a] += m * v[a];
                sum[3 + a] += m * (x[c] * v[d] - x[d] * v[c]) + (o ? o[a] / o[3] : 0.0);
                *size += m * fabs(v[a]);
            }
        }
}

static double run_tied(int dimension, double step, int steps, double *largest_force) {
    gn_world *w = bodies(dimension, step, 2);
    tie t;
    tie_make(&t, w);
    assert_int_equal(t.count, dimension == 3 ? 36 : 6);
    gn_energy e = measured_step(w);
    double before[6], after[6], size, scale = gn_energy_stored(&e), worst = 0.0;
    momentum_of(w, before, &size);
    *largest_force = 0.0;
    for (int n = 0; n < steps; n++) {
        e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)) * gn_energy_scale(&e));
        for (size_t k = 0; k < t.count; k++)
            *largest_force = fmax(*largest_force, fabs(t.force[k][0]));
    }
    momentum_of(w, after, &size);
    for (int a = 0; a < 6; a++) /* roundings of so many steps, arms of 6 mm */
        assert_near(after[a], before[a], 2.2e-16 * steps * 10.0 * size * (a < 3 ? 1.0 : 6e-3));
    for (size_t k = 0; k < t.count; k++)
        for (int a = 0; a < dimension; a++) {
            size_t n = 4 * (size_t)t.node[k] + (size_t)a;
            const gn_particles *nodes = &w->elements->body.nodes;
            assert_near(vel_of(w, t.id[k])[a], nodes->vel[n], 1e-14);
            assert_near(pos_of(w, t.id[k])[a], nodes->pos[n], 1e-15);
        }
    world_end(w);
    return worst / scale;
}

static void tied_bodies_keep_momentum_and_energy(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        double force, coarse = run_tied(dimension, 4e-7, 2000, &force);
        assert_true(force > 0.0);
        double fine = run_tied(dimension, 2e-7, 4000, &force);
        /* The elements' law is not linear: what the ledger leaves is of second order. */
        assert_true(coarse < 1e-4);
        assert_true(fine < 0.35 * coarse);
    }
}

static uint64_t hash_after(int threads, bool tied, int steps) {
    gn_world *w = bodies(3, 4e-7, threads);
    tie t;
    if (tied) tie_make(&t, w);
    run_steps(w, steps);
    uint64_t hash = gn_world_hash(w);
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
    gn_world *w = bodies(3, 4e-7, 2);
    tie t;
    tie_make(&t, w);
    w->exchange[0].act = nothing;
    run_steps(w, 300);
    assert_true(w->dem.hold.count > 0 && w->elements->body.hold.count > 0);
    assert_true(gn_world_hash(w) == hash_after(1, false, 300));
    world_end(w);
}

static gneiss_status refuse(void *context, gn_world *w, gneiss_error *error) {
    (void)context;
    return gn_fail(error, GNEISS_ERROR_UNSTABLE, "step %lld: refused", (long long)w->step);
}

static void an_exchange_may_stop_the_run(void **state) {
    (void)state;
    gn_world *w = bodies(2, 4e-7, 1);
    gneiss_error error = {0};
    assert_int_equal(gn_exchange_add(w, (gn_exchange){NULL, nothing, refuse, NULL}, &error),
                     GNEISS_OK);
    assert_int_equal(gn_world_step(w, false, &error), GNEISS_ERROR_UNSTABLE);
    assert_string_equal(error.message, "step 0: refused");
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tied_bodies_keep_momentum_and_energy),
        cmocka_unit_test(an_exchange_gives_the_same_bits_on_any_number_of_threads),
        cmocka_unit_test(waiting_changes_no_bit),
        cmocka_unit_test(an_exchange_may_stop_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
