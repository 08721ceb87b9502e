/* Checkpoints hold the whole state that determines the further run, so that a resumed run gives the
 * same bits. The parts of the world have files of their own (checkpoint_dem.c, checkpoint_flow.c,
 * checkpoint_boundary.c, checkpoint_elements.c); checkpoint_ranges.c checks what is read. */
#include "base/error.h"
#include "base/new.h"
#include "base/printable.h"
#include "base/version.h"
#include "io/atomic_file.h"
#include "io/h5_pieces.h"
#include "io/listing.h"
#include "measure/measure.h"
#include "run/checkpoint_internal.h"
#include "run/kept.h"
#include "run/part_files.h"
#include "run/run.h"
#include "run/spacing.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "world/origin.h"
#include "world/world.h"
#include "zones/zones.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT = 23 };

#define DOUBLES(member)      GN_PIECE_DOUBLES("", gn_run, member)
#define LIMIT(member)        GN_PIECE_ANY("", gn_run, member)
#define INTEGER(member)      GN_PIECE_INTEGER("", gn_run, member)
#define MEASURED(name, text) DOUBLES(world.ledger.name),

static const gn_piece pieces[] = {
    INTEGER(world.ctx.step),
    INTEGER(world.ctx.first_step),
    DOUBLES(world.ctx.time),
    DOUBLES(world.ctx.dt_past),
    DOUBLES(world.ctx.dt),
    LIMIT(world.ctx.stable),
    INTEGER(world.ctx.dt_lowered),
    DOUBLES(world.ledger.energy),
    DOUBLES(world.ledger.reading),
    GN_MEASURED(MEASURED) DOUBLES(world.ledger.stress),
    DOUBLES(world.ctx.seconds),
    DOUBLES(world.zones.state),
    DOUBLES(world.converted),
    DOUBLES(world.ctx.period),
    DOUBLES(world.box),
    DOUBLES(world.ctx.machine),
    DOUBLES(world.approach),
    DOUBLES(world.cutting),
    DOUBLES(world.section),
    DOUBLES(world.ctx.volume),
    DOUBLES(world.ctx.lower),
    DOUBLES(world.ctx.upper),
    DOUBLES(world.ctx.test_length),
    DOUBLES(world.ctx.test_area),
    DOUBLES(world.gauge.weights.volume),
    INTEGER(history_interval),
    DOUBLES(history_spacing),
    INTEGER(history_end_row),
    INTEGER(history_halvings),
    INTEGER(history_begin),
    INTEGER(snapshot_interval),
    INTEGER(snapshot_next),
    DOUBLES(snapshot_span),
    INTEGER(kept.halvings),
    INTEGER(kept.base),
    INTEGER(kept.part),
    DOUBLES(kept.peak),
    INTEGER(kept.fell),
    INTEGER(kept.halved),
    INTEGER(kept.due),
    DOUBLES(peak),
    INTEGER(bad_since),
    LIMIT(first_break.time),
    INTEGER(first_break.i),
    INTEGER(first_break.j),
    DOUBLES(first_break.place),
    DOUBLES(first_break.start),
    INTEGER(first_break.steps),
    INTEGER(first_break.increments),
    INTEGER(first_break.solutions),
    INTEGER(first_break.iterations),
    DOUBLES(first_break.unbalanced),
    DOUBLES(first_break.shortfall),
};
enum { PIECES = sizeof pieces / sizeof *pieces };

_Static_assert(sizeof(gn_energy) % 8 == 0, "made of doubles only");
_Static_assert(sizeof(((gn_run *)0)->world.ctx.seconds) == GN_PHASE_COUNT * 8,
               "one double a phase");

/* --- variable-size arrays --- */

gneiss_status gn_checkpoint_put_arrays(gn_h5 *file, const gn_checkpoint_array *arrays, size_t count,
                                       gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        char path[128];
        snprintf(path, sizeof path, "arrays/%s", arrays[k].name);
        const char *data = *arrays[k].data;
        GN_TRY(gn_h5_put(file, path, arrays[k].type, arrays[k].rows, arrays[k].components,
                         arrays[k].size, data ? data + arrays[k].offset : NULL, NULL, NULL, error));
    }
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_get_arrays(const gn_h5 *file, const gn_checkpoint_array *arrays,
                                       size_t count, gneiss_error *error) {
    for (size_t k = 0; k < count; k++) {
        char path[128];
        snprintf(path, sizeof path, "arrays/%s", arrays[k].name);
        const size_t item = gn_type_size(arrays[k].type) * arrays[k].components;
        if (!arrays[k].offset)
            *arrays[k].data =
                gn_alloc_array(arrays[k].rows + 1, arrays[k].size ? arrays[k].size : item);
        if (!*arrays[k].data)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", arrays[k].name);
        GN_TRY(gn_h5_get(file, path, arrays[k].type, arrays[k].rows, arrays[k].components,
                         arrays[k].size, (char *)*arrays[k].data + arrays[k].offset, error));
    }
    return GNEISS_OK;
}

enum { GAUGE_ARRAYS = 3 };

static void list_gauge(gn_strain_gauge *gauge, int32_t **belongs, size_t gauged,
                       gn_checkpoint_array out[GAUGE_ARRAYS]) {
    out[0] = GN_CHECKPOINT_ARRAY("gauge_id", GN_I32, gauge->count, 1, &gauge->id);
    out[1] = GN_CHECKPOINT_ARRAY("gauge_weight", GN_F64, gauge->count, 3, &gauge->weight);
    out[2] = GN_CHECKPOINT_ARRAY("gauge_belongs", GN_I32, gauged, 1, belongs);
}

/* --- writing --- */

static gneiss_status put_history(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    for (size_t c = 0; c < run->history.column_count; c++) {
        const gn_column *column = &run->history.columns[c];
        char path[160];
        snprintf(path, sizeof path, "history/%s", column->name);
        gn_h5_demand_finite(file, !column->absent);
        GN_TRY(gn_h5_put(file, path, GN_F64, run->history.row_count, 1, 0, column->value, NULL,
                         NULL, error));
    }
    gn_h5_demand_finite(file, true);
    return GNEISS_OK;
}

enum { STAGE_ARRAYS = 2 };

static void list_stages(gn_stage_state **stages, size_t count,
                        gn_checkpoint_array out[STAGE_ARRAYS]) {
    out[0] = GN_CHECKPOINT_MEMBERS("stages", GN_F64, count, offsetof(gn_stage_state, step) / 8,
                                   stages, gn_stage_state, time);
    out[1] = GN_CHECKPOINT_MEMBERS("stage_numbers", GN_I64, count,
                                   (sizeof(gn_stage_state) - offsetof(gn_stage_state, step)) / 8,
                                   stages, gn_stage_state, step);
}

static gneiss_status put_stages(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    int64_t stage = (int64_t)world->stages.now;
    gn_stage_state *stages = world->stages.state;
    gn_checkpoint_array arrays[STAGE_ARRAYS];
    list_stages(&stages, world->ctx.given.stage_count, arrays);
    if (!world->ctx.given.stage_count) return GNEISS_OK;
    GN_TRY(gn_h5_attribute_i64(file, "/", "stage", &stage, 1, error));
    return gn_checkpoint_put_arrays(file, arrays, STAGE_ARRAYS, error);
}

enum { KEPT_NUMBERS = sizeof(gn_kept_snapshot) / sizeof(double) };

static gneiss_status put_kept(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_kept_snapshot none = {0}, *list = run->kept.list ? run->kept.list : &none;
    gn_checkpoint_array array =
        GN_CHECKPOINT_ARRAY("kept", GN_F64, run->kept.count, KEPT_NUMBERS, &list);
    return gn_checkpoint_put_arrays(file, &array, 1, error);
}

static gneiss_status put_all(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    const int64_t format = FORMAT, hash = (int64_t)gn_world_hash(&w->ctx, &w->dem, &w->boundary,
                                                                 &w->solids, &w->box);
    const gn_progress progress = gn_run_progress(run);
    const gn_h5_attribute list[] = {{"format", .whole = &format},
                                    {"state_hash", .whole = &hash},
                                    {"version", .text = gn_version()},
                                    {"scene_file", .text = w->ctx.scene.source},
                                    {"seconds", .number = &progress.seconds},
                                    {"cpu_seconds", .number = &progress.cpu_seconds}};
    GN_TRY(gn_h5_attributes(file, "/", list, sizeof list / sizeof *list, error));
    if (w->outcome.halt[0]) GN_TRY(gn_h5_attribute_text(file, "/", "halt", w->outcome.halt, error));
    GN_TRY(gn_scene_results(w, file, error));
    GN_TRY(put_stages(w, file, error));
    gn_strain_gauge gauge = w->gauge.weights; /* list_gauge returns pointers that are not const */
    int32_t *belongs = w->gauge.belongs;
    gn_checkpoint_array arrays[GAUGE_ARRAYS];
    list_gauge(&gauge, &belongs, w->gauge.count, arrays);
    GN_TRY(gn_h5_put_pieces(file, "run", pieces, PIECES, run, error));
    GN_TRY(gn_checkpoint_put_arrays(file, arrays, GAUGE_ARRAYS, error));
    GN_TRY(put_kept(run, file, error));
    GN_TRY(gn_checkpoint_put_particles(w, file, error));
    GN_TRY(gn_checkpoint_put_boundary(w, file, error));
    GN_TRY(gn_checkpoint_put_elements(w, file, error));
    return put_history(run, file, error);
}

gneiss_status gn_checkpoint_write(const gn_run *run, const char *path, gneiss_error *error) {
    gn_h5 *file = NULL;
    GN_TRY(gn_h5_create(path, &file, error));
    gn_h5_demand_finite(file, true);
    gneiss_status status = put_all(run, file, error);
    if (status != GNEISS_OK) {
        gn_h5_close(file);
        return status;
    }
    return gn_h5_commit(&file, GN_DURABLE, error);
}

gneiss_status gn_checkpoint_save(const gn_run *run, gneiss_error *error) {
    char *path = NULL;
    gn_ranks_whole(run->world.ctx.ranks);
    if (!gn_rank_writes()) {
        gn_checkpoint_pass_particles(&run->world);
        return GNEISS_OK;
    }
    GN_TRY(gn_checkpoint_path(run->directory, run->world.ctx.step, &path, error));
    gneiss_status status = gn_checkpoint_write(run, path, error);
    free(path);
    GN_TRY(status);
    return gn_checkpoint_prune(run->directory, 2, error);
}

/* --- reading --- */

static gneiss_status get_gauge(gn_world *world, const gn_h5 *file, gneiss_error *error) {
    gn_checkpoint_array arrays[GAUGE_ARRAYS];
    GN_TRY(gn_h5_rows(file, "arrays/gauge_id", &world->gauge.weights.count, error));
    GN_TRY(gn_h5_rows(file, "arrays/gauge_belongs", &world->gauge.count, error));
    list_gauge(&world->gauge.weights, &world->gauge.belongs, world->gauge.count, arrays);
    return gn_checkpoint_get_arrays(file, arrays, GAUGE_ARRAYS, error);
}

static gneiss_status get_history(gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_history *h = &run->history;
    size_t rows = 0;
    GN_FREED double *table = NULL;
    GN_TRY(gn_run_begin_history(run, error));
    GN_TRY(gn_h5_rows(file, "history/step", &rows, error));
    GN_TRY(gn_new(&table, rows * h->column_count, "values of the history", error));
    for (size_t c = 0; c < h->column_count; c++) {
        char path[160];
        snprintf(path, sizeof path, "history/%s", h->columns[c].name);
        gn_h5_demand_finite(file, !h->columns[c].absent);
        GN_TRY(gn_h5_get(file, path, GN_F64, rows, 1, h->column_count * sizeof *table, table + c,
                         error));
    }
    gn_h5_demand_finite(file, true);
    for (size_t r = 0; r < rows; r++)
        GN_TRY(gn_history_append(h, table + r * h->column_count, error));
    return GNEISS_OK;
}

static gneiss_status check_format(const gn_h5 *file, const char *path, gneiss_error *error) {
    int64_t format = 0;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "format", &format, 1, error));
    if (format == FORMAT) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a checkpoint of format %d, found format %lld", path, FORMAT,
                   (long long)format);
}

static gneiss_status check_gauge(const gn_world *world, const char *path, gneiss_error *error) {
    size_t n = world->dem.particles.soa.count;
    bool good = !world->gauge.count || world->gauge.count == (size_t)world->dem.ids;
    for (size_t k = 0; k < world->gauge.weights.count; k++)
        good = good && world->gauge.weights.id[k] >= 0 && (size_t)world->gauge.weights.id[k] < n;
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected particle numbers below %zu, found others", path, n);
}

static bool kept_is_good(const gn_run *run) {
    bool good = true;
    for (size_t n = 0; n < run->kept.count; n++) {
        const gn_kept_snapshot *s = &run->kept.list[n];
        good = good && s->step >= 0.0 && s->step <= (double)run->world.ctx.step &&
               s->step == floor(s->step) && s->part >= 0.0 &&
               s->part < (1 << GN_SNAPSHOT_HALVINGS) &&
               (s->kind == GN_KEPT_PEAK || s->kind == GN_KEPT_HALF || s->kind == GN_KEPT_REGULAR ||
                s->kind == GN_KEPT_BEFORE);
    }
    return good;
}

static gneiss_status get_kept(gn_run *run, const gn_h5 *file, const char *path,
                              gneiss_error *error) {
    gn_kept *k = &run->kept;
    GN_TRY(gn_h5_rows(file, "arrays/kept", &k->count, error));
    k->capacity = k->count;
    gn_checkpoint_array array =
        GN_CHECKPOINT_ARRAY("kept", GN_F64, k->count, KEPT_NUMBERS, &k->list);
    GN_TRY(gn_checkpoint_get_arrays(file, &array, 1, error));
    return kept_is_good(run) ? GNEISS_OK
                             : gn_fail(error, GNEISS_ERROR_INPUT,
                                       "%s: arrays/kept: expected snapshots of earlier steps, "
                                       "found others",
                                       path);
}

/* Checks that the spacings of rows and snapshots are those of the requested numbers, halved or not.
 */
static bool spacing_is_good(const gn_run *run) {
    const gn_kept *k = &run->kept;
    return run->history_halvings >= 0 &&
           run->history_halvings <= gn_row_halvings(run->history_interval) &&
           run->history_begin >= 0 && run->history_end_row >= 0 && run->history_end_row <= 1 &&
           k->halvings >= 0 && k->halvings <= GN_SNAPSHOT_HALVINGS && k->part >= 0 &&
           k->part < (1 << GN_SNAPSHOT_HALVINGS) && k->base >= 0 && k->due >= 0 &&
           k->due <= (GN_KEPT_PEAK | GN_KEPT_HALF | GN_KEPT_REGULAR);
}

static gneiss_status check_numbers(const gn_run *run, const char *path, gneiss_error *error) {
    const gn_world *w = &run->world;
    bool good = run->history_interval > 0 && run->history_spacing >= 0.0 &&
                run->snapshot_interval >= 0 && spacing_is_good(run) && run->snapshot_next >= 0 &&
                run->snapshot_span >= 0.0 && w->ctx.step >= 0 && isfinite(w->ctx.time) &&
                w->ctx.dt > 0.0 && isfinite(w->ctx.dt) && isfinite(w->ctx.dt_past);
    return good ? GNEISS_OK
                : gn_fail(error, GNEISS_ERROR_INPUT,
                          "%s: expected positive steps and intervals, found others", path);
}

/* Checks that the saved step is similar to the earlier ones and that rates are possible with it;
 * with values far from these a run would never end. */
static gneiss_status check_pace(const gn_world *world, const char *path, gneiss_error *error) {
    const double far = 1e5, steps = (double)(world->ctx.step - world->ctx.first_step);
    const double least = steps > 0.0 ? world->ctx.time / steps / far : 0.0,
                 most = far / world->ctx.dt;
    const struct {
        const char *name;
        double value;
    } rates[] = {{"world_dem_surface_rate", world->ctx.choice.surface_rate},
                 {"world_dem_vertex_rate", world->ctx.choice.vertex_rate},
                 {"world_zones_state", world->zones.state.rate[0]},
                 {"world_zones_state", world->zones.state.rate[1]}};
    if (world->ctx.dt < least)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: run/world_ctx_dt: expected at least %.3g s, 1e-5 of the mean step so far, "
            "found %.3g s",
            path, least, world->ctx.dt);
    for (size_t k = 0; k < sizeof rates / sizeof *rates; k++)
        if (!(rates[k].value <= most))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: run/%s: expected a rate of at most %.3g 1/s, 1e5 of that of the "
                           "time step, found %.3g",
                           path, rates[k].name, most, rates[k].value);
    return GNEISS_OK;
}

/* Checks that the rows at which stages begin increase, and that the cause that ended a stage is a
 * known one. */
static gneiss_status check_stages(const gn_run *run, const char *path, gneiss_error *error) {
    const gn_world *w = &run->world;
    int64_t least = 0;
    for (size_t k = 0; k < w->ctx.given.stage_count && k <= w->stages.now; k++) {
        const gn_stage_state *s = &w->stages.state[k];
        bool good = s->row >= least && s->row <= (int64_t)run->history.row_count && s->step >= 0 &&
                    s->step <= w->ctx.step && s->ended >= 0 && s->ended <= GN_STAGE_ASKED;
        least = s->row;
        if (!good)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: arrays/stages: expected steps, rows of the history and causes of "
                           "an end in row %zu, found %lld, %lld, %lld",
                           path, k, (long long)s->step, (long long)s->row, (long long)s->ended);
    }
    return GNEISS_OK;
}

static gneiss_status get_stages(gn_world *world, const gn_h5 *file, const char *path,
                                gneiss_error *error) {
    int64_t stage = 0;
    gn_checkpoint_array arrays[STAGE_ARRAYS];
    list_stages(&world->stages.state, world->ctx.given.stage_count, arrays);
    if (!world->ctx.given.stage_count) return GNEISS_OK;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "stage", &stage, 1, error));
    if (stage < 0 || (size_t)stage >= world->ctx.given.stage_count)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s: expected a stage below %zu, found %lld",
                       path, world->ctx.given.stage_count, (long long)stage);
    world->stages.now = (size_t)stage;
    return gn_checkpoint_get_arrays(file, arrays, STAGE_ARRAYS, error);
}

/* Reads the scene. Messages name the checkpoint, because lines of its text are not those of the
 * scene file. */
static gneiss_status get_scene(gn_world *world, const gn_h5 *file, const char *path,
                               const gn_override *overrides, size_t count, gneiss_error *error) {
    GN_FREED char *text = NULL, *source = NULL;
    GN_TRY(gn_h5_get_text(file, "scene", &text, error));
    GN_TRY(gn_h5_get_attribute_text(file, "/", "scene_file", &source, error));
    GN_TRY(gn_scene_parse_saved(text, path, overrides, count, &world->ctx.given, error));
    snprintf(world->ctx.given.source, sizeof world->ctx.given.source, "%s",
             gn_make_printable(source));
    GN_TRY(get_stages(world, file, path, error));
    return gn_origin_shift(world, error);
}

static gneiss_status load(gn_run *run, gn_h5 *file, const char *path, const gn_override *overrides,
                          size_t count, gneiss_error *error) {
    gn_world *w = &run->world;
    GN_TRY(check_format(file, path, error));
    GN_TRY(gn_h5_check_names(file, true, error));
    gn_h5_demand_finite(file, true);
    GN_TRY(get_scene(w, file, path, overrides, count, error));
    GN_TRY(gn_world_prepare(&w->ctx, &w->dem, &w->box, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "seconds", &run->wall_before, 1, error));
    GN_TRY(gn_h5_get_attribute_f64(file, "/", "cpu_seconds", &run->cpu_before, 1, error));
    gneiss_error unsaid;
    char *halt = NULL; /* only if the model ended the run itself */
    if (gn_h5_get_attribute_text(file, "/", "halt", &halt, &unsaid) == GNEISS_OK)
        snprintf(w->outcome.halt, sizeof w->outcome.halt, "%s", gn_make_printable(halt));
    free(halt);
    GN_TRY(gn_h5_get_pieces(file, "run", pieces, PIECES, run, error));
    GN_TRY(check_numbers(run, path, error));
    GN_TRY(get_gauge(w, file, error));
    GN_TRY(gn_checkpoint_get_particles(w, file, path, error));
    GN_TRY(gn_checkpoint_get_boundary(w, file, path, error));
    GN_TRY(gn_checkpoint_get_elements(w, file, path, error));
    GN_TRY(check_pace(w, path, error));
    GN_TRY(check_gauge(w, path, error));
    GN_TRY(get_kept(run, file, path, error));
    GN_TRY(get_history(run, file, error));
    GN_TRY(check_stages(run, path, error));
    GN_TRY(gn_run_rebuild_samples(run, error));
    gn_kept_resume(run);
    GN_TRY(gn_checkpoint_get_surfaces(w, path, error));
    GN_TRY(gn_coupled_resume(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, error));
    GN_TRY(gn_world_restore(w, error));
    GN_TRY(gn_check_duration(&w->ctx, error));
    uint64_t hash = 0;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "state_hash", (int64_t *)&hash, 1, error));
    if (hash != gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: the state does not have the hash it was saved with", path);
    return GNEISS_OK;
}

gneiss_status gn_checkpoint_load(const char *path, const gn_override *overrides,
                                 size_t override_count, gn_run *run, gneiss_error *error) {
    gn_h5 *file = NULL;
    memset(run, 0, sizeof *run);
    GN_TRY(gn_h5_open_whole(path, &file, error));
    gneiss_status status = load(run, file, path, overrides, override_count, error);
    gn_h5_close(file);
    if (status != GNEISS_OK) gn_run_free(run);
    return status;
}
