#include "run/run.h"
#include "base/error.h"
#include "base/timer.h"
#include "io/io.h"
#include "io/snapshot.h"
#include "run/folder.h"
#include "run/kept.h"
#include "run/part_files.h"
#include "run/run_private.h"
#include "run/spacing.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/world.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Numbers of steps between updates of the stability limit (fewer with finite elements, because
 * their limit decreases with strain), and between readings of the clock. */
enum { WATCH_INTERVAL = 2000, WATCH_ELEMENTS = 500, CLOCK_INTERVAL = 16 };

/* --- setting up --- */

/* Returns the time to the end of the run, or of the stage, s. */
static double span_of(const gn_run *run) {
    return gn_run_staged(run) ? gn_run_stage_duration(run) : run->world.ctx.scene.end;
}

/* Returns the number of steps between rows or snapshots if `wanted` are requested in `span` s; the
 * first one is always taken. */
static int64_t interval(const gn_run *run, double span, int64_t wanted) {
    double steps = wanted > 0 ? span / run->world.ctx.dt / (double)wanted : INFINITY;
    return steps < 1.0 ? 1 : steps < 1e18 ? (int64_t)steps : INT64_MAX;
}

/* Sets the intervals of rows and snapshots. `begins`: a run or a stage begins, and they may be
 * closer at first. */
void gn_run_set_intervals(gn_run *run, bool history, bool snapshots, bool begins) {
    const gn_scene *s = &run->world.ctx.scene;
    if (history) {
        gn_run_space_rows(run, interval(run, span_of(run), s->history_rows));
        if (!begins) run->history_halvings = 0;
    }
    if (!snapshots) return;
    run->snapshot_span = span_of(run);
    run->snapshot_interval = s->snapshots > 0 ? interval(run, run->snapshot_span, s->snapshots) : 0;
    const int64_t every = run->snapshot_interval, step = run->world.ctx.step;
    if (every) run->snapshot_next = step / every * every + (step % every ? every : 0);
    gn_kept_begin(run, begins);
}

/* Sets the step of the next snapshots after some were written: the remaining ones are distributed
 * evenly up to the end with the present step. */
static gneiss_status next_snapshot(gn_run *run, gneiss_error *error) {
    const gn_world *w = &run->world;
    const bool regular = run->kept.due & GN_KEPT_REGULAR;
    if (regular && !run->kept.part)
        run->snapshot_interval = interval(run, run->snapshot_span, w->ctx.scene.snapshots);
    GN_TRY(gn_kept_note(run, error));
    if (regular) gn_kept_plan(run);
    return GNEISS_OK;
}

void gn_run_set_clock(gn_run *run) {
    run->wall_start = gn_now();
    run->cpu_start = gn_process_time();
    double every = run->directory[0] ? run->world.ctx.scene.checkpoint_wall : 0.0;
    run->next_checkpoint = every > 0.0 ? run->wall_start + every : INFINITY;
}

static gneiss_status open_folder(gn_run *run, bool force, gneiss_error *error) {
    if (!gn_rank_writes()) return GNEISS_OK;
    GN_TRY(gn_make_directory(run->directory, error));
    GN_TRY(gn_folder_lock(run->directory, &run->folder_lock, error));
    if (!force) GN_TRY(gn_folder_check(run->directory, error));
    return gn_folder_clear(run->directory, &run->world.ctx.scene, error);
}

gneiss_status gn_run_create(gn_scene *scene, gn_run *run, gneiss_error *error) {
    memset(run, 0, sizeof *run);
    run->bad_since = -1;
    double start = gn_now(), cpu_start = gn_process_time();
    GN_TRY(gn_world_create(scene, &run->world, error));
    gneiss_status status = gn_run_begin_history(run, error);
    if (status != GNEISS_OK) {
        gn_run_free(run);
        return status;
    }
    gn_run_set_intervals(run, true, true, true);
    gn_run_set_clock(run);
    run->wall_start = start;
    run->cpu_start = cpu_start;
    return GNEISS_OK;
}

gneiss_status gn_run_start(gn_scene *scene, const char *directory, bool force, gn_run *run,
                           gneiss_error *error) {
    GN_TRY(gn_run_create(scene, run, error));
    gneiss_status status =
        gn_folder_choose(&run->world.ctx.scene, directory, run->directory, error);
    if (status == GNEISS_OK) status = open_folder(run, force, error);
    if (status != GNEISS_OK) {
        gn_run_free(run);
        return status;
    }
    double start = run->wall_start, cpu_start = run->cpu_start;
    gn_run_set_clock(run);
    run->wall_start = start;
    run->cpu_start = cpu_start;
    return GNEISS_OK;
}

/* --- stop conditions --- */

static double last(const gn_run *run, const char *column) {
    const double *values = gn_history_column(&run->history, column);
    return values && run->history.row_count ? values[run->history.row_count - 1] : NAN;
}

static void stop(gn_run *run, const char *format, double value) {
    run->finished = true;
    snprintf(run->stop_reason, sizeof run->stop_reason, format, value);
}

/* A fall of the stress counts only after the first bond has broken (without bonds, after this
 * number of rows), because the first rows of a dynamic test oscillate about zero. */
enum { ROWS_BEFORE_PEAK = 20 };

/* Ends the run if the model itself requires it. */
static void check_halt(gn_run *run) {
    if (!run->world.outcome.halt[0] || run->finished) return;
    run->finished = true;
    snprintf(run->stop_reason, sizeof run->stop_reason, "%s", run->world.outcome.halt);
}

static void stop_by_kind(gn_run *run, const char *format, double value) {
    stop(run, format, value);
    const size_t used = strlen(run->stop_reason);
    snprintf(run->stop_reason + used, sizeof run->stop_reason - used, ", as %s tests end",
             gn_scene_test(&run->world.ctx.scene)->name);
}

static int64_t broken(const gn_run *run) {
    return gn_dem_breaks(&run->world.dem);
}

/* Tells whether enough bonds have broken to sever a section of the specimen: a tenth of the N^((d -
 * 1)/d) bonds through a section, N being all bonds. This excludes the few bonds that a platen
 * breaks on first contact. */
static bool broken_through(const gn_run *run) {
    const double d = (double)run->world.ctx.scene.dimension,
                 section = pow((double)run->world.dem.bonds.contacts.soa.count, (d - 1.0) / d);
    return broken(run) > 0 && (double)broken(run) >= 0.1 * section;
}

/* Returns the number of rows that cover the time of `rows` rows at the default of a thousand rows,
 * if more or fewer are requested. */
static size_t rows_of_thousand(const gn_run *run, size_t rows) {
    const double wanted = (double)run->world.ctx.scene.history_rows * (double)rows / 1000.0;
    return wanted < 1.0 ? 1 : wanted < (double)rows ? (size_t)wanted : rows;
}

/* Tells whether the test has at least `count` samples before `end`, and computes their mean stress.
 */
static bool mean_before(const gn_run *run, size_t end, size_t count, double *mean) {
    const double *stress = run->samples.stress;
    if (!run->beginning.begun || end < run->beginning.least + count) return false;
    *mean = 0.0;
    for (size_t k = end - count; k < end; k++) *mean += stress[k] / (double)count;
    return true;
}

/* Updates the peak, the largest mean stress of `count` successive samples since the test began. In
 * the first call that finds that the test has begun, and in the first call of a resumed run, all
 * means since the beginning are computed. Returns the last mean. */
static double look_for_peak(gn_run *run, size_t count) {
    const size_t samples = run->samples.count;
    const bool before = run->beginning.begun;
    double mean = NAN;
    gn_beginning_update(&run->beginning, run->samples.strain, run->samples.stress, samples);
    if (!run->beginning.begun) return NAN;
    if (!before) run->peak = 0.0;
    for (size_t end = before ? samples : run->beginning.least + 1; end <= samples; end++)
        if (mean_before(run, end, count, &mean)) run->peak = fmax(run->peak, mean);
    return mean;
}

/* Applies the default stop criterion of this test kind. A specimen that did not break has no peak.
 * Means of rows are compared, so that vibrations do not end a test. */
static void check_end_of_test(gn_run *run, const gn_stops *stops) {
    const double mean = look_for_peak(run, rows_of_thousand(run, GN_ROWS_HELD));
    const bool fell = run->samples.count > rows_of_thousand(run, ROWS_BEFORE_PEAK) &&
                      broken_through(run) && run->peak > 0.0 && gn_run_loaded(run, run->peak) &&
                      mean < (1.0 - stops->peak_drop) * run->peak;
    if (stops->peak_drop > 0.0 && fell)
        stop_by_kind(run, "stress fell by %g of its peak", stops->peak_drop);
}

/* Applies the stop criterion of the scene: the first fall of a single row ends the test. */
static void check_fall(gn_run *run, double peak_drop) {
    const double stress = look_for_peak(run, 1);
    const bool counts = run->world.ctx.effects & GN_FX_BONDS
                            ? broken(run) > 0
                            : run->samples.count > ROWS_BEFORE_PEAK;
    if (counts && run->peak > 0.0 && gn_run_loaded(run, run->peak) &&
        stress < (1.0 - peak_drop) * run->peak)
        stop(run, "stress fell by %g of its peak", peak_drop);
}

static void check_stop_conditions(gn_run *run) {
    const gn_scene *s = &run->world.ctx.scene;
    const gn_stops stops = gn_scene_stops(s);
    if (gn_run_staged(run)) {
        gn_run_stage_row(run);
        return;
    }
    if (stops.by_kind)
        check_end_of_test(run, &stops);
    else if (stops.peak_drop > 0.0)
        check_fall(run, stops.peak_drop);
    if (gn_scene_tested(s) && !(stops.by_kind && run->finished) && stops.strain > 0.0 &&
        last(run, "strain") >= stops.strain)
        (stops.strain_by_kind ? stop_by_kind
                              : stop)(run,
                                      gn_scene_test(s)->tool && stops.strain == 1.0
                                          ? "the tool has reached the end of its path"
                                          : "strain reached %g",
                                      stops.strain);
    if (gn_run_balanced(run, run->samples.count, s->stop_unbalanced))
        stop(run, "unbalanced force ratio fell below %g", s->stop_unbalanced);
}

/* A run that had ended remains ended unless the overrides change that. */
void gn_run_take_up(gn_run *run) {
    gn_run_set_clock(run);
    if (last(run, "step") == (double)(run->world.ctx.step - 1) &&
        gn_run_is_sample(run, run->history.row_count - 1))
        check_stop_conditions(run);
    check_halt(run);
    if (gn_run_staged(run)) gn_run_stage_time(run);
}

void gn_run_free(gn_run *run) {
    gn_world_free(&run->world);
    gn_run_end_history(run);
    gn_samples_free(&run->samples);
    gn_kept_free(&run->kept);
    gn_snapshot_times_free(&run->snapshot_times);
    if (run->folder_lock > 0) close(run->folder_lock);
    memset(run, 0, sizeof *run);
}

/* --- running --- */

/* Tells whether to rewrite the series files, which are written as a whole: when the number of
 * snapshots has grown by one thirty-second, or when snapshots were removed. */
static bool series_is_due(const gn_run *run) {
    const size_t count = run->snapshot_times.count, written = run->series_length;
    return count < 64 || count <= written || 32 * (count - written) >= count;
}

static gneiss_status write_files(gn_run *run, gneiss_error *error) {
    gn_ranks_whole(run->world.ctx.ranks);
    GN_TRY(gn_output_snapshot(run, "", error));
    GN_TRY(gn_output_elements_snapshot(&run->world, run->directory, "elements", error));
    GN_TRY(gn_bodies_snapshot(&run->world, run->directory, "bodies", error));
    const gn_world *w = &run->world;
    return gn_snapshot_times_add(&run->snapshot_times, w->ctx.step, w->ctx.time, error);
}

static gneiss_status write_snapshots(gn_run *run, gneiss_error *error) {
    GN_TRY(write_files(run, error));
    GN_TRY(next_snapshot(run, error));
    return series_is_due(run) ? gn_output_series(run, error) : GNEISS_OK;
}

static gneiss_status write_last_snapshots(gn_run *run, gneiss_error *error) {
    GN_TRY(write_files(run, error));
    GN_TRY(gn_kept_finish(run, error));
    return gn_output_series(run, error);
}

typedef struct beginning {
    gn_run *run;
    const gn_first_break_watch *watch;
} beginning;

/* Appends a row for every intermediate state except the last, which the first step reads. */
static gneiss_status note_state(void *context, const gn_first_break *so_far, gneiss_error *error) {
    const beginning *b = context;
    gn_world *w = &b->run->world;
    gneiss_status status = gn_history_record_state(w, &b->run->history, error); /* 0 steps done */
    if (status != GNEISS_OK || !b->watch) return status;
    return b->watch->state(b->watch->context, so_far, error);
}

gneiss_status gn_run_begin(gn_run *run, const gn_first_break_watch *watch, gneiss_error *error) {
    gn_world *w = &run->world;
    if (w->ctx.scene.start != GN_START_FIRST_BREAK || w->ctx.step > 0) return GNEISS_OK;
    beginning b = {run, watch};
    double start = gn_now();
    gneiss_status status =
        gn_first_break_start(w, &(gn_first_break_watch){note_state, &b}, &run->first_break, error);
    w->ctx.seconds[GN_PHASE_setup] += gn_now() - start;
    if (status != GNEISS_OK && run->directory[0])
        (void)rmdir(run->directory); /* the folder is still empty */
    return status;
}

/* Enters a stage that is due. *first: set if a row and snapshots are due because of it. */
static gneiss_status go_to_stage(gn_run *run, bool *first, gneiss_error *error) {
    bool entered;
    GN_TRY(gn_run_stages_go(run, &entered, error));
    if (!entered) return GNEISS_OK;
    gn_run_set_intervals(run, true, true, true);
    *first = true;
    return GNEISS_OK;
}

static gneiss_status after_row(gn_run *run, gneiss_error *error) {
    const size_t row = run->history.row_count - 1;
    const bool sample = gn_run_is_sample(run, row);
    if (sample) {
        GN_TRY(gn_run_add_sample(run, row, error));
        GN_TRY(gn_run_check_ledger(run, error));
        check_stop_conditions(run);
    }
    gn_kept_row(run, sample);
    return gn_run_thin_rows(run, error);
}

static gneiss_status one_step(gn_run *run, gneiss_error *error) {
    gn_world *w = &run->world;
    GN_TRY(gn_run_drop_end_row(run, error));
    GN_TRY(gn_run_begin(run, NULL, error));
    bool first = w->ctx.step == w->ctx.first_step;
    const bool before = run->finished;
    if (gn_run_staged(run)) GN_TRY(go_to_stage(run, &first, error));
    if (run->finished && !before) return GNEISS_OK; /* the last stage has no steps */
    if (run->directory[0] && run->snapshot_interval && gn_kept_is_due(run, first)) {
        double start = gn_now();
        gneiss_status status = write_snapshots(run, error);
        w->ctx.seconds[GN_PHASE_output] += gn_now() - start;
        GN_TRY(gn_run_rescue(run, true, status, error));
    }
    if (first || gn_run_row_is_due(run)) {
        GN_TRY(gn_history_record_step(w, &run->history, error));
        GN_TRY(after_row(run, error));
    } else if (gn_run_time_left(run) <= 1.5 * w->ctx.dt) {
        const bool row = gn_run_has_end_row(run);
        GN_TRY(gn_history_record_last_step(w, row ? &run->history : NULL, error));
        run->history_end_row = row;
    } else {
        GN_TRY(gn_world_step(w, false, error));
    }
    if (w->ctx.step % (w->solids.count ? WATCH_ELEMENTS : WATCH_INTERVAL) == 0)
        GN_TRY(gn_timestep_check(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, &w->ledger,
                                 false, error));
    if (w->outcome.halt[0] && !run->finished && last(run, "step") != (double)(w->ctx.step - 1)) {
        GN_TRY(
            gn_history_record_step(w, &run->history, error)); /* the row of the step that failed */
        GN_TRY(gn_run_check_ledger(run, error));
    }
    check_halt(run);
    if (gn_run_staged(run)) gn_run_stage_time(run);
    if (!run->finished && w->ctx.time >= w->ctx.scene.end - 0.5 * w->ctx.dt)
        gn_run_out_of_time(run);
    return GNEISS_OK;
}

/* Writes a file although an earlier one failed for lack of space: `before` is the status of the
 * earlier ones, and the first error is returned. After other errors nothing more is written. */
static gneiss_status also_write(gneiss_status before,
                                gneiss_status (*write)(const gn_run *, gneiss_error *),
                                const gn_run *run, gneiss_error *error) {
    gneiss_error later = {0};
    if (before != GNEISS_OK && before != GNEISS_ERROR_IO) return before;
    gneiss_status status = write(run, before == GNEISS_OK ? error : &later);
    return before == GNEISS_OK ? status : before;
}

gneiss_status gn_run_checkpoint(gn_run *run, gneiss_error *error) {
    double start = gn_now();
    gneiss_status status = gn_checkpoint_save(run, error);
    status = also_write(status, gn_output_results, run, error);
    if (status == GNEISS_OK && run->directory[0] && run->series_length < run->snapshot_times.count)
        status = gn_output_series(run, error);
    run->world.ctx.seconds[GN_PHASE_output] += gn_now() - start;
    double every = run->world.ctx.scene.checkpoint_wall;
    run->next_checkpoint = every > 0.0 ? gn_now() + every : INFINITY;
    return gn_run_rescue(run, false, status, error);
}

static bool checkpoint_is_due(const gn_run *run, double now) {
    return run->directory[0] && now >= run->next_checkpoint;
}

typedef struct decision {
    bool stops, saves, pauses; /* on a signal; a checkpoint; the time of the call is over */
} decision;

/* All ranks do the same: a signal to any of them stops all, the clock is that of rank 0. */
static decision decide(const gn_run *run, decision own) {
    const bool writes = gn_rank_writes();
    int64_t value[3] = {own.stops, writes && own.saves, writes && own.pauses};
    if (!run->world.ctx.ranks) return own;
    run->world.ctx.ranks->transport->most(value, 3);
    return (decision){value[0] > 0, value[1] > 0, value[2] > 0};
}

gneiss_status gn_run_advance(gn_run *run, double seconds, const volatile sig_atomic_t *interrupt,
                             gneiss_error *error) {
    double until = gn_now() + seconds;
    if (!run->finished && run->world.ctx.time >= run->world.ctx.scene.end - 0.5 * run->world.ctx.dt)
        gn_run_out_of_time(run);
    while (!run->finished) {
        GN_TRY(one_step(run, error));
        const bool asked = interrupt && *interrupt;
        run->interrupted = asked && !run->world.ctx.ranks;
        if (run->interrupted) return GNEISS_OK;
        if (run->world.ctx.step % CLOCK_INTERVAL) continue;
        const double now = gn_now();
        const decision d =
            decide(run, (decision){asked, checkpoint_is_due(run, now), now >= until});
        run->interrupted = d.stops;
        if (d.saves) GN_TRY(gn_run_checkpoint(run, error));
        if (d.stops || d.pauses) return GNEISS_OK;
    }
    return GNEISS_OK;
}

gneiss_status gn_run_some_steps(gn_run *run, int64_t *steps, const volatile sig_atomic_t *interrupt,
                                gneiss_error *error) {
    while (*steps > 0) {
        GN_TRY(one_step(run, error));
        --*steps;
        if (run->world.ctx.step % CLOCK_INTERVAL == 0 && checkpoint_is_due(run, gn_now()))
            GN_TRY(gn_run_checkpoint(run, error));
        if (interrupt && *interrupt) return GNEISS_OK;
    }
    return GNEISS_OK;
}

gneiss_status gn_run_steps(gn_run *run, int64_t steps, gneiss_error *error) {
    return gn_run_some_steps(run, &steps, NULL, error);
}

/* Returns the time (s) at which the strain limit is reached at the mean strain rate so far;
 * INFINITY: there is no limit or no strain. */
static double end_by_strain(const gn_run *run) {
    const gn_world *w = &run->world;
    const bool staged = gn_run_staged(run);
    const double stop =
        staged ? w->ctx.scene.stages[w->stages.now].strain : gn_scene_stops(&w->ctx.scene).strain;
    const double from = staged ? w->stages.state[w->stages.now].time : 0.0,
                 grown =
                     last(run, "strain") - (staged ? w->stages.state[w->stages.now].strain : 0.0);
    if (!gn_scene_tested(&w->ctx.scene) || !(stop > 0.0) || !(grown > 0.0)) return INFINITY;
    return from + (w->ctx.time - from) * stop / grown;
}

/* Returns the time (s) that remains to the expected end; *at_most: it is a bound, because the run
 * may end before. */
static double time_to_go(const gn_run *run, bool *at_most) {
    const gn_world *w = &run->world;
    const double bound = gn_run_time_left(run);
    const bool last_stage = !gn_run_staged(run) || w->stages.now + 1 == w->ctx.scene.stage_count;
    *at_most = gn_run_may_end_early(run) || !last_stage;
    if (!last_stage) return bound;
    double end = end_by_strain(run);
    if (run->expected_end > w->ctx.time) end = fmin(end, run->expected_end);
    if (!(end - w->ctx.time < bound)) return bound;
    *at_most = false;
    return fmax(0.0, end - w->ctx.time);
}

gn_progress gn_run_progress(const gn_run *run) {
    const gn_world *w = &run->world;
    gn_progress p = {0};
    p.step = w->ctx.step;
    p.time = w->ctx.time;
    p.end = w->ctx.scene.end;
    p.stages = w->ctx.scene.stage_count;
    p.stage_index = w->stages.now;
    p.stage = p.stages ? w->ctx.scene.stages[w->stages.now].name : NULL;
    p.seconds = run->wall_before + gn_now() - run->wall_start;
    p.cpu_seconds = run->cpu_before + gn_process_time() - run->cpu_start;
    double rate = p.seconds > 0.0 ? (double)(w->ctx.step - w->ctx.first_step) / p.seconds : 0.0;
    p.particle_steps_per_second = rate * (double)w->dem.particles.soa.count;
    p.element_steps_per_second = rate * (double)gn_elements_totals(&w->solids).elements;
    p.contact_steps_per_second = p.seconds > 0.0 ? (double)w->dem.contact_steps / p.seconds : 0.0;
    const double left = time_to_go(run, &p.eta_at_most);
    p.eta = rate > 0.0 ? fmax(0.0, left / w->ctx.dt / rate) : NAN;
    p.unbalanced = w->ledger.unbalanced;
    p.residual = w->ctx.effects & GN_FX_ENERGY ? gn_energy_residual(&w->ledger.reading) : NAN;
    p.broken = w->dem.broken_tension + w->dem.broken_shear;
    p.stress = last(run, "stress");
    p.strain = last(run, "strain");
    p.finished = run->finished;
    return p;
}

/* --- ending --- */

/* The summary is written only after the results, so that it never describes another state. */
static gneiss_status write_results(const gn_run *run, gneiss_error *error) {
    GN_TRY(gn_output_results(run, error));
    return gn_output_summary(run, error);
}

gneiss_status gn_run_finish(gn_run *run, gneiss_error *error) {
    double start = gn_now();
    gneiss_status status = write_last_snapshots(run, error);
    bool save = status == GNEISS_ERROR_MEMORY;
    status = also_write(status, gn_checkpoint_save, run, error);
    run->world.ctx.seconds[GN_PHASE_output] += gn_now() - start;
    if (status == GNEISS_OK)
        status = gn_timestep_update_reported_limit(&run->world.ctx, &run->world.dem,
                                                   &run->world.boundary, &run->world.solids,
                                                   &run->world.zones, &run->world.ledger, error);
    status = also_write(status, write_results, run, error);
    return gn_run_rescue(run, save, status, error);
}

gneiss_status gn_run_write_failure(gn_run *run, const char *message, gneiss_error *error) {
    gn_ranks_whole(run->world.ctx.ranks);
    snprintf(run->stop_reason, sizeof run->stop_reason, "failed: %s", message);
    run->finished = false;
    run->world.outcome.bad = true;
    GN_TRY(gn_output_snapshot(run, "failed_", error));
    GN_TRY(gn_output_elements_snapshot(&run->world, run->directory, "failed_elements", error));
    GN_TRY(gn_bodies_snapshot(&run->world, run->directory, "failed_bodies", error));
    if (run->series_length < run->snapshot_times.count) GN_TRY(gn_output_series(run, error));
    return gn_output_results(run, error);
}
