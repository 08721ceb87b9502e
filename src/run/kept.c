#include "run/kept.h"

#include "base/new.h"
#include "io/listing.h"
#include "run/part_files.h"
#include "run/spacing.h"
#include "run/stages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An interval has at most PARTS parts. While the run advances, up to LEAST_COUNT regular snapshots
 * are kept even if fewer are requested, because one of them should be near half of the peak. A file
 * takes tens of milliseconds, so that intervals allow at most MOST_WRITTEN snapshots up to
 * time.end. */
enum {
    PARTS = 1 << GN_SNAPSHOT_HALVINGS,
    LEAST_STEPS = 40,
    LEAST_COUNT = 12,
    MOST_WRITTEN = 128,
    ROWS_BEFORE = 100,
    STEPS_BEFORE = 300 /* least number of steps between candidates when rows are far apart */
};

/* Factors by which stress and time grow from one candidate of the peak to the next, before and
 * after a bond has broken, and after the stress has fallen. A fall by the fraction FALL marks a
 * peak. */
static const double GROWTH_WHOLE = 1.5, GROWTH_BROKEN = 1.25, GROWTH_FALLEN = 1.01, FALL = 0.01;

/* --- state --- */

/* Tells whether the run, or its stage, has a peak: the test must have one, and the stage must be
 * the last or one whose readings are computed. */
static bool has_peak(const gn_run *run) {
    const gn_scene *s = &run->world.ctx.scene;
    if (!(gn_scene_test(s)->peak_drop > 0.0)) return false;
    if (!gn_run_staged(run)) return true;
    const gn_stage *e = &s->stages[run->world.stages.now];
    return e->strain > 0.0 || e->stress > 0.0 || e->peak_drop > 0.0 ||
           run->world.stages.now + 1 == s->stage_count;
}

static double last_in(const gn_run *run, const char *column) {
    const double *value = gn_history_column(&run->history, column);
    return value && run->history.row_count ? value[run->history.row_count - 1] : NAN;
}

static int64_t halvings_of(const gn_run *run) {
    const int64_t wanted = run->world.ctx.scene.snapshots;
    int64_t most = 0;
    while (most < GN_SNAPSHOT_HALVINGS && wanted << (most + 1) <= MOST_WRITTEN) most++;
    return gn_halvings(run->snapshot_interval, LEAST_STEPS, most);
}

void gn_kept_begin(gn_run *run, bool closer) {
    gn_kept *k = &run->kept;
    gn_kept_snapshot *list = k->list;
    const size_t capacity = k->capacity;
    *k = (gn_kept){.list = list, .capacity = capacity, .base = run->world.ctx.step};
    if (closer && run->snapshot_interval && (gn_run_may_end_early(run) || has_peak(run)))
        k->halvings = halvings_of(run);
}

void gn_kept_resume(gn_run *run) {
    const gn_samples *samples = &run->samples;
    gn_beginning_update(&run->kept.beginning, samples->strain, samples->stress, samples->count);
}

void gn_kept_free(gn_kept *kept) {
    gn_free(kept->list);
    *kept = (gn_kept){0};
}

/* --- the peak --- */

/* Returns the last candidate for the snapshot at the peak; NULL: there is none. */
static const gn_kept_snapshot *candidate(const gn_kept *kept, gn_kept_kind kind) {
    for (size_t n = kept->count; n > 0; n--)
        if (kept->list[n - 1].kind == (double)kind) return &kept->list[n - 1];
    return NULL;
}

static bool bonds_hold(const gn_run *run) {
    const gn_dem *d = &run->world.dem;
    return run->world.ctx.effects & GN_FX_BONDS && gn_dem_breaks(d) == 0;
}

/* Tells whether the stress begins to fall from the peak, or has grown enough since the last
 * candidate. */
static bool is_candidate(gn_run *run, double stress) {
    gn_kept *k = &run->kept;
    const gn_kept_snapshot *before = candidate(k, GN_KEPT_PEAK);
    const double least = before ? before->stress : 0.0;
    const double growth = bonds_hold(run) ? GROWTH_WHOLE : GROWTH_BROKEN;
    const double from = before ? before->step : 0.0, now = (double)run->world.ctx.step;
    if (stress < (1.0 - FALL) * k->peak && !k->fell) {
        k->fell = 1;
        return stress > GROWTH_FALLEN * least;
    }
    return stress > growth * least && now > growth * from;
}

/* Tells whether the ends carry no load at first. The test then begins as soon as they move, which
 * the rows show before the samples do. */
static bool begins_unloaded(const gn_run *run) {
    const double *stress = gn_history_column(&run->history, "stress");
    return stress && run->history.row_count && !(stress[0] > 0.0);
}

static bool has_moved(const gn_run *run) {
    const double *strain = gn_history_column(&run->history, "strain");
    return strain && strain[run->history.row_count - 1] > strain[0];
}

/* Tells whether the test has begun; earlier rows do not belong to it. */
static bool has_begun(gn_run *run, bool sample) {
    gn_kept *k = &run->kept;
    const int64_t rows = (int64_t)run->history.row_count - run->history_begin;
    if (gn_run_staged(run)) return rows > 1;
    const bool before = k->beginning.begun;
    if (sample)
        gn_beginning_update(&k->beginning, run->samples.strain, run->samples.stress,
                            run->samples.count);
    if (begins_unloaded(run)) return k->beginning.begun || has_moved(run);
    if (k->beginning.begun && !before) k->peak = 0.0;
    return k->beginning.begun;
}

void gn_kept_row(gn_run *run, bool sample) {
    gn_kept *k = &run->kept;
    if (!run->directory[0] || !run->snapshot_interval || !has_peak(run) || !has_begun(run, sample))
        return;
    const double stress = last_in(run, "stress");
    if (stress > k->peak) {
        k->peak = stress;
        k->fell = k->halved = 0;
    }
    const int64_t rows = (int64_t)run->history.row_count - run->history_begin;
    const bool early = rows < ROWS_BEFORE && run->world.ctx.step < STEPS_BEFORE;
    if (early || !(k->peak > 0.0) || !gn_run_loaded(run, k->peak)) return;
    if (is_candidate(run, stress)) k->due |= GN_KEPT_PEAK;
    if (stress <= 0.5 * k->peak && !k->halved) {
        k->halved = 1;
        k->due |= GN_KEPT_HALF;
    }
}

/* --- removal --- */

/* Removes the files of a step unless another entry refers to them as well. */
static gneiss_status remove_files(const gn_run *run, double step, gneiss_error *error) {
    static const char *const names[] = {"particles", "bonds", "contacts", "bodies"};
    const gn_kept *k = &run->kept;
    if (!gn_rank_writes()) return GNEISS_OK;
    for (size_t n = 0; n < k->count; n++)
        if (k->list[n].step == step) return GNEISS_OK;
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        GN_TRY(gn_step_remove(run->directory, names[n], (int64_t)step, ".hdf", error));
    for (size_t n = 0; n < run->world.solids.count; n++) {
        char file[GN_ELEMENT_PATH];
        GN_TRY(gn_step_remove(run->directory, gn_output_elements_file(n, "elements", file),
                              (int64_t)step, ".hdf", error));
    }
    return GNEISS_OK;
}

static gneiss_status drop(gn_run *run, size_t at, gneiss_error *error) {
    gn_kept *k = &run->kept;
    const double step = k->list[at].step;
    memmove(k->list + at, k->list + at + 1, (k->count - at - 1) * sizeof *k->list);
    k->count--;
    return remove_files(run, step, error);
}

/* --- regular snapshots --- */

static int64_t part_size(const gn_kept *kept) {
    return PARTS >> kept->halvings;
}

static bool is_on_grid(const gn_kept *kept, const gn_kept_snapshot *snapshot) {
    return snapshot->kind == GN_KEPT_REGULAR && (int64_t)snapshot->part % part_size(kept) == 0;
}

static size_t count_regular(const gn_kept *kept) {
    size_t count = 0;
    for (size_t n = 0; n < kept->count; n++) count += is_on_grid(kept, &kept->list[n]);
    return count;
}

/* Returns the snapshot before the peak with a stress nearest to `share` of the peak; k->count:
 * there is none. */
static size_t nearest_before(const gn_kept *kept, double share) {
    const gn_kept_snapshot *peak = candidate(kept, GN_KEPT_PEAK);
    size_t nearest = kept->count;
    for (size_t n = 0; n < kept->count; n++) {
        const double kind = kept->list[n].kind;
        if (kind != GN_KEPT_REGULAR && kind != GN_KEPT_BEFORE) continue;
        if (peak && kept->list[n].step > peak->step) continue;
        const double off = fabs(kept->list[n].stress - share * kept->peak);
        if (nearest == kept->count || off < fabs(kept->list[nearest].stress - share * kept->peak))
            nearest = n;
    }
    return nearest;
}

/* Tells whether a snapshot is needed: it is the nearest to half of the peak, or, if the candidate
 * of the peak has a lower stress, the nearest to the peak. */
static bool is_needed(const gn_kept *kept, size_t at) {
    const gn_kept_snapshot *peak = candidate(kept, GN_KEPT_PEAK);
    if (!(kept->peak > 0.0)) return false;
    if (at == nearest_before(kept, 0.5)) return true;
    return at == nearest_before(kept, 1.0) && !(peak && peak->stress >= kept->list[at].stress);
}

static gneiss_status thin(gn_run *run, gneiss_error *error) {
    gn_kept *k = &run->kept;
    k->halvings--;
    for (size_t n = k->count; n > 0; n--)
        if (k->list[n - 1].kind == GN_KEPT_REGULAR && !is_on_grid(k, &k->list[n - 1]) &&
            !is_needed(k, n - 1))
            GN_TRY(drop(run, n - 1, error));
    return GNEISS_OK;
}

void gn_kept_plan(gn_run *run) {
    gn_kept *k = &run->kept;
    k->part = k->halvings ? (k->part / part_size(k) + 1) * part_size(k) : PARTS;
    if (k->part >= PARTS) k->part = 0;
    const int64_t whole = run->snapshot_interval / PARTS, rest = run->snapshot_interval % PARTS,
                  steps =
                      k->part ? k->part * whole + k->part * rest / PARTS : run->snapshot_interval;
    run->snapshot_next = steps > INT64_MAX - k->base ? INT64_MAX : k->base + steps;
}

static size_t most_regular(const gn_run *run) {
    const int64_t wanted = run->world.ctx.scene.snapshots;
    return (size_t)(wanted > LEAST_COUNT ? wanted : LEAST_COUNT);
}

/* Tells whether the thinning that follows would remove the snapshot at once. */
static bool is_superfluous(const gn_run *run) {
    const gn_kept *k = &run->kept;
    return k->halvings > 0 && k->part % (2 * part_size(k)) != 0 &&
           count_regular(k) + 1 > most_regular(run);
}

bool gn_kept_is_due(gn_run *run, bool first) {
    gn_kept *k = &run->kept;
    if (first) k->part = 0;
    if (first || run->world.ctx.step >= run->snapshot_next) {
        if (is_superfluous(run))
            gn_kept_plan(run);
        else
            k->due |= GN_KEPT_REGULAR;
    }
    return k->due != 0;
}

/* --- written snapshots --- */

static gneiss_status add(gn_run *run, gn_kept_kind kind, gneiss_error *error) {
    gn_kept *k = &run->kept;
    GN_TRY(gn_grow(&k->list, k->count, k->count + 1, &k->capacity, "snapshots", error));
    const double stress = last_in(run, "stress");
    k->list[k->count++] = (gn_kept_snapshot){(double)run->world.ctx.step,
                                             kind == GN_KEPT_REGULAR ? (double)k->part : 0.0,
                                             isnan(stress) ? 0.0 : stress, (double)kind};
    return GNEISS_OK;
}

static gneiss_status note_regular(gn_run *run, gneiss_error *error) {
    gn_kept *k = &run->kept;
    GN_TRY(add(run, GN_KEPT_REGULAR, error));
    while (k->halvings > 0 && count_regular(k) > most_regular(run)) GN_TRY(thin(run, error));
    return GNEISS_OK;
}

/* Keeps the former candidates that are nearest to half of the peak. `over`: no higher peak can
 * follow, for which former candidates above half would be needed. */
static gneiss_status drop_former(gn_run *run, bool over, gneiss_error *error) {
    gn_kept *k = &run->kept;
    const size_t nearest = nearest_before(k, 0.5);
    if (nearest == k->count) return GNEISS_OK;
    const double stress = k->list[nearest].stress, step = k->list[nearest].step;
    for (size_t n = k->count; n > 0; n--) {
        const gn_kept_snapshot *s = &k->list[n - 1];
        if (s->kind != GN_KEPT_BEFORE || s->step == step) continue;
        if (over || s->stress <= stress) GN_TRY(drop(run, n - 1, error));
    }
    return GNEISS_OK;
}

/* Replaces the previous snapshot of the same kind; a new peak also replaces those after an earlier
 * peak. */
static gneiss_status replace(gn_run *run, gn_kept_kind kind, gneiss_error *error) {
    gn_kept *k = &run->kept;
    const double now = (double)run->world.ctx.step;
    for (size_t n = k->count; n > 0; n--) {
        gn_kept_snapshot *s = &k->list[n - 1];
        const bool same = s->kind == (double)kind && s->step < now;
        if (same && kind == GN_KEPT_PEAK)
            s->kind = GN_KEPT_BEFORE;
        else if (same || (kind == GN_KEPT_PEAK && s->kind == GN_KEPT_HALF))
            GN_TRY(drop(run, n - 1, error));
    }
    return kind == GN_KEPT_PEAK ? drop_former(run, false, error) : GNEISS_OK;
}

gneiss_status gn_kept_note(gn_run *run, gneiss_error *error) {
    static const gn_kept_kind tested[] = {GN_KEPT_PEAK, GN_KEPT_HALF};
    gn_kept *k = &run->kept;
    const int64_t due = k->due;
    k->due = 0;
    for (size_t n = 0; n < 2; n++) {
        if (!(due & (int64_t)tested[n])) continue;
        GN_TRY(add(run, tested[n], error));
        GN_TRY(replace(run, tested[n], error));
    }
    if (!(due & GN_KEPT_REGULAR)) return GNEISS_OK;
    if (!k->part) k->base = run->world.ctx.step;
    return note_regular(run, error);
}

gneiss_status gn_kept_finish(gn_run *run, gneiss_error *error) {
    gn_kept *k = &run->kept;
    const int64_t wanted = run->world.ctx.scene.snapshots;
    while (k->halvings > 0 && (int64_t)count_regular(k) > wanted) GN_TRY(thin(run, error));
    return drop_former(run, true, error);
}
