/* Parallel regions may get fewer threads than requested (OMP_THREAD_LIMIT, OMP_DYNAMIC, the
 * caller's own region), and the number may change from step to step: every kind of loop gives the
 * same bits. */
#include "smaller_team.h"
#include "world_helpers.h"

#include <omp.h>

enum { THREADS = 4, OVERRIDES = 8 };

typedef struct team_case {
    const char *what, *file;
    int rounds, steps; /* steps of a round */
    gn_override with[OVERRIDES];
} team_case;

static const team_case cases[] = {
    {"bonds, pairs, walls", "tests/scenes/ucs-small.yaml", 30, 10, {{0}}},
    {"mixed precision", "tests/scenes/ucs-small.yaml", 20, 10, {{"run.precision", "mixed"}}},
    {"sets of particles", "tests/scenes/lattice-small.yaml", 20, 10, {{0}}},
    {"nothing in touch",
     "tests/scenes/lattice-small.yaml",
     20,
     10,
     {{"specimen.lattice.cells", "[16, 16, 16]"},
      {"specimen.lattice.spacing", "1.5"},
      {"walls.top.point", "[0, 0, 1 m]"},
      {"gravity", "[0, 0, -9.81]"}}},
    {"raised masses", "tests/scenes/ucs-small.yaml", 10, 5, {{"time.mass_scaling.factor", "1.5"}}},
    {"elements", "tests/scenes/beam-small.yaml", 20, 5, {{0}}},
    {"elements, mixed precision",
     "tests/scenes/beam-small.yaml",
     10,
     5,
     {{"run.precision", "mixed"}}},
    {"elements, mixed form",
     "tests/scenes/beam-small.yaml",
     20,
     5,
     {{"elements.formulation", "mixed"}}},
    {"elements that turn into particles",
     "scenes/bending-adaptive.yaml",
     30,
     5,
     {{"specimen.mean_radius", "1.3 mm"},
      {"couple.convert.stress", "10 Pa"},
      {"couple.convert.every", "20"},
      {"elements.motions.load.motion.vy", "-1 m/s"}}},
    {"zones", "scenes/bending-coupled.yaml", 20, 5, {{0}}},
    {"a membrane, a packing", "scenes/triaxial.yaml", 20, 5, {{"specimen.particles", "600"}}},
    {"particles on elements", "scenes/block-on-bed.yaml", 20, 5, {{0}}},
    {"bodies, near pairs", "scenes/drum.yaml", 20, 10, {{0}}},
    {"sources", "scenes/pour-into-hopper.yaml", 20, 10, {{0}}},
    {"a box that moves", "scenes/periodic-box.yaml", 20, 5, {{0}}},
};

/* A running world, whose regions get fewer threads round by round. */
typedef struct course {
    const team_case *of;
    bool alone; /* made with teams of one thread */
    int limits[5], limit_count;
    gn_world *w;
    int came; /* the largest team since the last reset */
} course;

static void make(void *context) {
    course *c = context;
    char path[4096], threads[16];
    gn_override with[OVERRIDES + 1];
    size_t count = 0;
    gneiss_error error = {0};
    gn_scene *scene = calloc(1, sizeof *scene);
    for (; count < OVERRIDES && c->of->with[count].key; count++) with[count] = c->of->with[count];
    snprintf(threads, sizeof threads, "%d", THREADS);
    with[count++] = (gn_override){"run.threads", threads};
    snprintf(path, sizeof path, "%s/%s", test_source(), c->of->file);
    c->w = calloc(1, sizeof *c->w);
    if (gn_scene_load(path, with, count, scene, &error) != GNEISS_OK ||
        gn_world_create(scene, c->w, &error) != GNEISS_OK)
        fail_msg("%s: %s", c->of->what, error.message);
    free(scene);
}

static void go_on(void *context) {
    course *c = context;
    gneiss_error error = {0};
    c->came = 0;
#pragma omp parallel num_threads(THREADS)
#pragma omp single
    c->came = omp_get_num_threads();
    for (int k = 0; k < c->of->steps; k++)
        if (gn_world_step(c->w, k == 0, &error) != GNEISS_OK)
            fail_msg("%s: step %d: %s", c->of->what, (int)c->w->ctx.step, error.message);
    gn_active_pairs_settle(&c->w->ctx, &c->w->dem);
}

static void assert_alike(const course *a, const course *b, int round) {
    const gn_world *v = a->w, *w = b->w;
    if (gn_world_hash(&v->ctx, &v->dem, &v->boundary, &v->solids, &v->box) !=
        gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box))
        fail_msg("%s: other bits after %d rounds", a->of->what, round);
    if (!(v->ctx.dt == w->ctx.dt && v->ctx.stable == w->ctx.stable))
        fail_msg("%s: steps %.17g, %.17g of limits %.17g, %.17g", a->of->what, v->ctx.dt, w->ctx.dt,
                 v->ctx.stable, w->ctx.stable);
    if (memcmp(&v->ledger.reading, &w->ledger.reading, sizeof v->ledger.reading) != 0)
        fail_msg("%s: another ledger after %d rounds", a->of->what, round);
}

static int limit_of(const course *c, int round) {
    return c->limits[round % c->limit_count];
}

static void run_alike(const team_case *of) {
    course all[] = {{of, .limits = {THREADS}, .limit_count = 1},
                    {of, .alone = true, .limits = {1}, .limit_count = 1},
                    {of, .limits = {2, 1, THREADS, 3, 1}, .limit_count = 5}};
    enum { COURSES = sizeof all / sizeof *all };
    for (int k = 0; k < COURSES; k++) {
        if (all[k].alone)
            in_a_region(make, &all[k]);
        else
            make(&all[k]);
        assert_int_equal(all[k].w->ctx.threads, THREADS);
    }
    for (int round = 0; round < of->rounds; round++)
        for (int k = 0; k < COURSES; k++) {
            in_teams_of(limit_of(&all[k], round), go_on, &all[k]);
            assert_true(all[k].came <= limit_of(&all[k], round));
            assert_alike(&all[0], &all[k], round);
        }
    for (int k = 0; k < COURSES; k++) world_end(all[k].w);
}

static void a_team_that_is_smaller_than_asked_leaves_the_same_bits(void **state) {
    (void)state;
    setenv("GNEISS_CACHE", "off", 1);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        print_message("# %s\n", cases[k].what);
        run_alike(&cases[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_team_that_is_smaller_than_asked_leaves_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
