/* Runs from scene texts, and comparison of bits over threads and resumption. */
#ifndef GN_TESTS_RUN_HELPERS_H
#define GN_TESTS_RUN_HELPERS_H

#include "world_helpers.h"

#include "run/run.h"

#include <unistd.h>

__attribute__((format(printf, 1, 2))) static inline gn_run *run_of(const char *format, ...) {
    text *t = calloc(1, sizeof *t);
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    va_list args;
    va_start(args, format);
    int length = vsnprintf(t->s, sizeof t->s, format, args);
    va_end(args);
    assert_in_range(length, 1, sizeof t->s - 1);
    if (gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    free(t);
    return run;
}

static inline void run_end(gn_run *run) {
    gn_run_free(run);
    free(run);
}

/* Writes a checkpoint of a run and returns the run resumed from it. */
static inline gn_run *resumed_of(const gn_run *run) {
    char path[] = "/tmp/gneiss_XXXXXX";
    gn_run *resumed = calloc(1, sizeof *resumed);
    gneiss_error error = {0};
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    if (gn_checkpoint_write(run, path, &error) != GNEISS_OK ||
        gn_checkpoint_load(path, NULL, 0, resumed, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    unlink(path);
    return resumed;
}

/* Advances two runs of one scene, for example on one and on two threads, by `before` steps, and
 * starts a third from a checkpoint of the first; then advances all of them by `after` steps and a
 * measured one, which must give the same bits. Frees the runs; returns the ledger of the measured
 * step, whose residual must be below `residual`. */
static inline gn_energy end_alike(gn_run *one, gn_run *two, int64_t before, int64_t after,
                                  double residual) {
    gn_run *all[] = {one, two, NULL};
    gn_energy e = {0};
    for (int k = 0; k < 2; k++) run_steps(&all[k]->world, before);
    all[2] = resumed_of(one);
    for (int k = 0; k < 3; k++) {
        run_steps(&all[k]->world, after);
        e = measured_step(&all[k]->world);
        assert_true(fabs(gn_energy_residual(&e)) < residual);
        assert_int_equal(gn_world_hash(&all[k]->world.ctx, &all[k]->world.dem,
                                       &all[k]->world.boundary, &all[k]->world.solids,
                                       &all[k]->world.box),
                         gn_world_hash(&one->world.ctx, &one->world.dem, &one->world.boundary,
                                       &one->world.solids, &one->world.box));
    }
    for (int k = 0; k < 3; k++) run_end(all[k]);
    return e;
}

/* Compares an uninterrupted run, `after` steps beyond the time of another run of the same scene,
 * with the other run resumed up to there: the same bits, energies included. Frees the runs. */
static inline void end_resumed_alike(gn_run *straight, gn_run *stopped, int64_t after) {
    gn_run *resumed = resumed_of(stopped);
    run_steps(&straight->world, stopped->world.ctx.step + after);
    assert_true(gn_world_hash(&stopped->world.ctx, &stopped->world.dem, &stopped->world.boundary,
                              &stopped->world.solids, &stopped->world.box) ==
                gn_world_hash(&resumed->world.ctx, &resumed->world.dem, &resumed->world.boundary,
                              &resumed->world.solids, &resumed->world.box));
    run_steps(&resumed->world, after);
    assert_true(gn_world_hash(&straight->world.ctx, &straight->world.dem, &straight->world.boundary,
                              &straight->world.solids, &straight->world.box) ==
                gn_world_hash(&resumed->world.ctx, &resumed->world.dem, &resumed->world.boundary,
                              &resumed->world.solids, &resumed->world.box));
    assert_true(memcmp(&straight->world.ledger.energy, &resumed->world.ledger.energy,
                       sizeof(gn_energy)) == 0);
    run_end(straight);
    run_end(stopped);
    run_end(resumed);
}

#endif
