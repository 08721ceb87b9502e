#include "sim/run.h"

#include "base/timer.h"
#include "io/checkpoint_files.h"
#include "io/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps between looks at the stability limit, and between looks at the clock. */
enum { WATCH_INTERVAL = 2000, CLOCK_INTERVAL = 16 };

/* --- setting up ------------------------------------------------------------------------------------- */

/* runs/<name of the scene file without folder and ending>, unless the scene or the caller says. */
static void choose_directory(const gn_scene *scene, const char *wanted, char *out, size_t size) {
    if (!wanted || !*wanted) wanted = scene->output_directory;
    if (*wanted) {
        snprintf(out, size, "%s", wanted);
        return;
    }
    const char *slash = strrchr(scene->source, '/'), *name = slash ? slash + 1 : scene->source;
    const char *dot = strrchr(name, '.');
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    snprintf(out, size, "runs/%.*s", length, name);
}

static int64_t interval(const gn_world *w, int64_t wanted) {
    double steps = w->scene.end / w->dt / (double)wanted;
    return steps < 1.0 ? 1 : (int64_t)steps;
}

static void set_clock(gn_run *run) {
    run->wall_start = gn_now();
    double every = run->world.scene.checkpoint_wall;
    run->next_checkpoint = every > 0.0 ? run->wall_start + every : INFINITY;
}

gneiss_status gn_run_start(gn_scene *scene, const char *directory, gn_run *run, gneiss_error *error) {
    memset(run, 0, sizeof *run);
    double start = gn_now();
    choose_directory(scene, directory, run->directory, sizeof run->directory);
    GN_TRY(gn_world_create(scene, &run->world, error));
    gneiss_status status = gn_record_create(&run->world, &run->history, error);
    if (status == GNEISS_OK) status = gn_make_directory(run->directory, error);
    /* A checkpoint of an earlier run in this folder must not be taken for one of this run. */
    if (status == GNEISS_OK) status = gn_checkpoint_prune(run->directory, 0, error);
    if (status != GNEISS_OK) {
        gn_run_free(run);
        return status;
    }
    run->history_interval = interval(&run->world, run->world.scene.history_rows);
    if (run->world.scene.snapshots > 0)
        run->snapshot_interval = interval(&run->world, run->world.scene.snapshots);
    set_clock(run);
    run->wall_start = start;
    return GNEISS_OK;
}

gneiss_status gn_run_resume(const char *directory, const gn_override *overrides, size_t override_count,
                            gn_run *run, gneiss_error *error) {
    static const char *const allowed[] = {"time.", "output.", "run."};
    for (size_t k = 0; k < override_count; k++) {
        bool known = false;
        for (size_t a = 0; a < 3; a++)
            known = known || strncmp(overrides[k].key, allowed[a], strlen(allowed[a])) == 0;
        if (!known)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--set %s: a resumed run takes time.*, output.* and run.* only", overrides[k].key);
    }
    int64_t steps[8];
    size_t count = 0;
    GN_TRY(gn_checkpoint_list(directory, steps, 8, &count, error));
    if (count == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected checkpoint_<step>.h5 files, found none",
                       directory);
    /* A damaged checkpoint gives way to the one before it. */
    gneiss_error first = {0};
    for (size_t k = 0; k < count; k++) {
        char *path = NULL;
        GN_TRY(gn_checkpoint_path(directory, steps[k], &path, error));
        gneiss_status status = gn_checkpoint_load(path, overrides, override_count, run, error);
        free(path);
        if (status == GNEISS_OK) {
            snprintf(run->directory, sizeof run->directory, "%s", directory);
            set_clock(run);
            return gn_output_series(run, error);
        }
        if (k == 0 && error) first = *error;
    }
    if (error) *error = first;
    return first.status != GNEISS_OK ? first.status : GNEISS_ERROR_INPUT;
}

void gn_run_free(gn_run *run) {
    gn_world_free(&run->world);
    gn_history_free(&run->history);
    memset(run, 0, sizeof *run);
}

/* --- running ---------------------------------------------------------------------------------------- */

static double last(const gn_run *run, const char *column) {
    const double *values = gn_history_column(&run->history, column);
    return values && run->history.row_count ? values[run->history.row_count - 1] : NAN;
}

static void stop(gn_run *run, const char *format, double value) {
    run->finished = true;
    snprintf(run->stop_reason, sizeof run->stop_reason, format, value);
}

/* The first rows of a dynamic test swing through zero; a peak counts once something has broken (or, without
 * bonds, after this many rows). */
enum { ROWS_BEFORE_PEAK = 20 };

static void check_stop_conditions(gn_run *run) {
    const gn_scene *s = &run->world.scene;
    if (s->test.kind != GN_TEST_NONE) {
        double stress = last(run, "stress"), strain = last(run, "strain");
        bool counts = run->world.effects & GN_FX_BONDS
                          ? run->world.broken_tension + run->world.broken_shear > 0
                          : run->history.row_count > ROWS_BEFORE_PEAK;
        if (counts) run->peak = fmax(run->peak, stress);
        if (s->stop_peak_drop > 0.0 && run->peak > 0.0 && stress < (1.0 - s->stop_peak_drop) * run->peak)
            stop(run, "stress fell by %g of its peak", s->stop_peak_drop);
        if (s->stop_strain > 0.0 && strain >= s->stop_strain) stop(run, "strain reached %g", s->stop_strain);
    }
    if (s->stop_unbalanced > 0.0 && run->history.row_count > ROWS_BEFORE_PEAK &&
        run->world.unbalanced < s->stop_unbalanced)
        stop(run, "unbalanced force ratio fell below %g", s->stop_unbalanced);
}

static gneiss_status one_step(gn_run *run, gneiss_error *error) {
    gn_world *w = &run->world;
    if (run->snapshot_interval && w->step % run->snapshot_interval == 0) {
        double start = gn_now();
        gneiss_status status = gn_output_snapshot(run, "particles", "bonds", error);
        if (status == GNEISS_OK) status = gn_output_series(run, error);
        w->seconds[GN_PHASE_output] += gn_now() - start;
        GN_TRY(status);
    }
    if (w->step % run->history_interval == 0) {
        GN_TRY(gn_record_step(w, &run->history, error));
        check_stop_conditions(run);
    } else {
        GN_TRY(gn_world_step(w, false, error));
    }
    if (w->step % WATCH_INTERVAL == 0) GN_TRY(gn_world_check_step(w, false, error));
    if (!run->finished && w->time >= w->scene.end - 0.5 * w->dt) stop(run, "t = %g s reached", w->scene.end);
    return GNEISS_OK;
}

gneiss_status gn_run_checkpoint(gn_run *run, gneiss_error *error) {
    double start = gn_now();
    gneiss_status status = gn_checkpoint_save(run, error);
    if (status == GNEISS_OK) status = gn_output_results(run, error);
    run->world.seconds[GN_PHASE_output] += gn_now() - start;
    double every = run->world.scene.checkpoint_wall;
    run->next_checkpoint = every > 0.0 ? gn_now() + every : INFINITY;
    return status;
}

gneiss_status gn_run_advance(gn_run *run, double seconds, const volatile sig_atomic_t *interrupt,
                             gneiss_error *error) {
    double until = gn_now() + seconds;
    if (!run->finished && run->world.time >= run->world.scene.end - 0.5 * run->world.dt)
        stop(run, "t = %g s reached", run->world.scene.end);
    for (int64_t k = 1; !run->finished; k++) {
        GN_TRY(one_step(run, error));
        if (interrupt && *interrupt) return GNEISS_OK;
        if (k % CLOCK_INTERVAL) continue;
        double now = gn_now();
        if (now >= run->next_checkpoint) GN_TRY(gn_run_checkpoint(run, error));
        if (now >= until) return GNEISS_OK;
    }
    return GNEISS_OK;
}

gn_progress gn_run_progress(const gn_run *run) {
    const gn_world *w = &run->world;
    gn_progress p = {0};
    p.step = w->step;
    p.time = w->time;
    p.end = w->scene.end;
    p.seconds = run->wall_before + gn_now() - run->wall_start;
    double rate = p.seconds > 0.0 ? (double)w->step / p.seconds : 0.0;
    p.particle_steps_per_second = rate * (double)w->particles.soa.count;
    p.contact_steps_per_second = p.seconds > 0.0 ? (double)w->contact_steps / p.seconds : 0.0;
    p.eta = rate > 0.0 ? (w->scene.end - w->time) / w->dt / rate : NAN;
    p.unbalanced = w->unbalanced;
    p.residual = w->effects & GN_FX_ENERGY ? gn_energy_residual(&w->reading) : NAN;
    p.broken = w->broken_tension + w->broken_shear;
    p.stress = last(run, "stress");
    p.strain = last(run, "strain");
    p.finished = run->finished;
    return p;
}

/* --- ending ----------------------------------------------------------------------------------------- */

gneiss_status gn_run_finish(gn_run *run, gneiss_error *error) {
    double start = gn_now();
    gneiss_status status = gn_output_snapshot(run, "particles", "bonds", error);
    if (status == GNEISS_OK) status = gn_output_series(run, error);
    if (status == GNEISS_OK) status = gn_checkpoint_save(run, error);
    run->world.seconds[GN_PHASE_output] += gn_now() - start;
    if (status == GNEISS_OK) status = gn_output_results(run, error);
    if (status == GNEISS_OK) status = gn_output_summary(run, error);
    return status;
}

gneiss_status gn_run_write_failure(gn_run *run, const char *message, gneiss_error *error) {
    snprintf(run->stop_reason, sizeof run->stop_reason, "failed: %s", message);
    run->finished = false;
    GN_TRY(gn_output_snapshot(run, "failed_particles", "failed_bonds", error));
    return gn_output_results(run, error);
}
