#include "run/spacing.h"

#include "base/error.h"
#include "base/new.h"
#include "conversion/conversion.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>

/* Least number of steps between rows that are thinned later; a row costs some 20 us. With
 * GN_ROW_HALVINGS the run may end at 1/32 of time.end before there are fewer rows than requested.
 */
enum { LEAST_STEPS = 5 };

bool gn_run_may_end_early(const gn_run *run) {
    return gn_scene_may_end_early(&run->world.ctx.scene, run->world.stages.now);
}

int64_t gn_halvings(int64_t interval, int64_t least, int64_t most) {
    int64_t halvings = 0;
    if (interval > INT64_MAX >> 16) return 0; /* none are requested */
    while (halvings < most && interval >> (halvings + 1) >= least) halvings++;
    return halvings;
}

int64_t gn_row_halvings(int64_t interval) {
    return gn_halvings(interval, LEAST_STEPS, GN_ROW_HALVINGS);
}

/* Tells whether rows may be closer together at first; otherwise they are at equal times. Equal
 * times are needed if elements convert, and for sinks, whose rates are means from row to row. */
static bool adapts(const gn_world *world, size_t stage) {
    return world->ctx.scene.history_rows > 0 && !gn_converts(&world->ctx) &&
           !gn_scene_has_flow(&world->ctx.scene) &&
           gn_scene_may_end_early(&world->ctx.scene, stage);
}

static double rows_expected(const gn_world *world, size_t stage) {
    const gn_scene *s = &world->ctx.scene;
    const gn_stage *e = s->stage_count ? &s->stages[stage] : NULL;
    const double wanted = (double)s->history_rows;
    double steps =
        fmin(1e15, (e && e->time >= 0.0 ? fmin(e->time, s->end) : s->end) / world->ctx.dt);
    if (e && e->steps >= 0) steps = fmin(steps, (double)e->steps);
    if (!(wanted > 0.0) || steps <= wanted || !adapts(world, stage)) return fmin(wanted, steps);
    const int64_t interval = (int64_t)(steps / wanted);
    const double closest = (double)(interval >> gn_row_halvings(interval));
    return fmin(1.25 * wanted, steps / 8.0 / closest);
}

double gn_run_rows_expected(const gn_world *world) {
    double rows = 1.0;
    for (size_t k = 0; k < world->ctx.scene.stage_count || k == 0; k++)
        rows += rows_expected(world, k);
    return rows;
}

void gn_run_space_rows(gn_run *run, int64_t interval) {
    run->history_interval = interval;
    run->history_spacing = interval < INT64_MAX ? (double)interval * run->world.ctx.dt : 0.0;
    run->history_end_row = 0;
    run->history_begin = (int64_t)run->history.row_count;
    run->history_halvings =
        adapts(&run->world, run->world.stages.now) ? gn_row_halvings(interval) : 0;
}

/* Returns the steps between rows with the remaining halvings. The spacing is a power of two times
 * the closest one, so that the rows that are kept are rows of the former spacing. */
static int64_t spacing_of(const gn_run *run) {
    const int64_t first = gn_row_halvings(run->history_interval);
    return run->history_interval >> first << (first - run->history_halvings);
}

static bool is_spaced(const gn_run *run, int64_t step) {
    return step % run->history_interval == 0 ||
           (run->history_halvings && step % spacing_of(run) == 0);
}

/* Tells whether rows are at multiples of the spacing. Rows that will be thinned remain so even if a
 * resumed run has lost the condition that may end it early. */
static bool goes_by_steps(const gn_run *run) {
    return run->history_halvings > 0 || adapts(&run->world, run->world.stages.now);
}

/* Rows that may be removed are at multiples of the interval. All others are at equal time intervals
 * from the last one, because the step may have become shorter. */
bool gn_run_row_is_due(const gn_run *run) {
    const gn_world *w = &run->world;
    const size_t rows = run->history.row_count;
    if (goes_by_steps(run) || !rows) return is_spaced(run, w->ctx.step);
    const double last = gn_history_column(&run->history, "time")[rows - 1];
    return run->history_spacing > 0.0 &&
           w->ctx.time - last > run->history_spacing - 0.5 * w->ctx.dt;
}

/* --- the row of the last step --- */

bool gn_run_has_end_row(const gn_run *run) {
    const gn_scene *s = &run->world.ctx.scene;
    return !run->finished && s->history_rows > 0 && gn_scene_has_flow(s) &&
           !gn_converts(&run->world.ctx);
}

gneiss_status gn_run_drop_end_row(gn_run *run, gneiss_error *error) {
    if (!run->history_end_row || run->finished || !run->history.row_count) return GNEISS_OK;
    run->history_end_row = 0;
    run->history.row_count--;
    return gn_run_rebuild_samples(run, error);
}

/* --- samples --- */

/* The first row of all, or of a stage, is a sample as well. */
bool gn_run_is_sample(const gn_run *run, size_t row) {
    if (row <= (size_t)run->history_begin || !goes_by_steps(run)) return true;
    const double step = gn_history_column(&run->history, "step")[row];
    return (int64_t)step % run->history_interval == 0;
}

size_t gn_run_sample_count(const gn_run *run, size_t begin, size_t most) {
    size_t samples = 0;
    for (size_t row = run->history.row_count; row > begin && samples < most; row--)
        samples += gn_run_is_sample(run, row - 1);
    return samples;
}

size_t gn_run_sample_row(const gn_run *run, size_t back) {
    size_t row = run->history.row_count;
    while (row > 0 && back > 0) back -= gn_run_is_sample(run, --row);
    return row;
}

static gneiss_status grow(gn_samples *samples, gneiss_error *error) {
    const size_t capacity = samples->capacity ? 2 * samples->capacity : 256;
    double *stress = realloc(samples->stress, capacity * sizeof *stress);
    if (stress) samples->stress = stress;
    double *strain = realloc(samples->strain, capacity * sizeof *strain);
    if (strain) samples->strain = strain;
    if (!stress || !strain)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu rows of stress", capacity);
    samples->capacity = capacity;
    return GNEISS_OK;
}

gneiss_status gn_run_add_sample(gn_run *run, size_t row, gneiss_error *error) {
    gn_samples *samples = &run->samples;
    const double *stress = gn_history_column(&run->history, "stress"),
                 *strain = gn_history_column(&run->history, "strain");
    if (samples->count == samples->capacity) GN_TRY(grow(samples, error));
    samples->stress[samples->count] = stress ? stress[row] : NAN;
    samples->strain[samples->count] = strain ? strain[row] : NAN;
    samples->count++;
    return GNEISS_OK;
}

gneiss_status gn_run_rebuild_samples(gn_run *run, gneiss_error *error) {
    run->samples.count = 0;
    for (size_t row = 0; row < run->history.row_count; row++)
        if (gn_run_is_sample(run, row)) GN_TRY(gn_run_add_sample(run, row, error));
    return GNEISS_OK;
}

void gn_samples_free(gn_samples *samples) {
    free(samples->stress);
    free(samples->strain);
    *samples = (gn_samples){0};
}

/* --- thinning --- */

static gneiss_status thin(gn_run *run, gneiss_error *error) {
    gn_history *h = &run->history;
    const double *step = gn_history_column(h, "step");
    const size_t begin = (size_t)run->history_begin;
    GN_FREED bool *keep = NULL;
    GN_TRY(gn_new(&keep, h->row_count, "rows", error));
    for (size_t row = begin; row < h->row_count; row++)
        keep[row] = row == begin || is_spaced(run, (int64_t)step[row]);
    gn_history_keep(h, begin, keep);
    return GNEISS_OK;
}

gneiss_status gn_run_thin_rows(gn_run *run, gneiss_error *error) {
    const int64_t wanted = run->world.ctx.scene.history_rows;
    while (run->history_halvings > 0 &&
           (int64_t)run->history.row_count - run->history_begin >= 2 * wanted) {
        run->history_halvings--;
        GN_TRY(thin(run, error));
    }
    return GNEISS_OK;
}
