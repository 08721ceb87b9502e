/* Readings of a run: of its whole history, or of the rows of one stage. */
#include "accuracy/accuracy.h"
#include "laboratory/cutting.h"
#include "laboratory/laboratory.h"
#include "particles/bursts.h"
#include "particles/fragments.h"
#include "run/budget.h"
#include "run/run.h"
#include "run/stages.h"
#include "zones/zones.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The state for which readings were computed. They are the same as long as these numbers are. */
typedef struct state {
    int64_t step, broken, lost;
    size_t rows, stage;
} state;

struct gn_run_read {
    bool known;
    state of;
    gn_readings readings;
    gn_budget *budget; /* budget of these readings; NULL: not computed yet */
};

gneiss_status gn_run_begin_history(gn_run *run, gneiss_error *error) {
    run->read = calloc(1, sizeof *run->read);
    if (!run->read) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for readings");
    return gn_history_create_columns(&run->world, &run->history, error);
}

void gn_run_end_history(gn_run *run) {
    if (run->read) free(run->read->budget);
    free(run->read);
    gn_history_free(&run->history);
}

/* --- readings of a part of the rows --- */

/* Returns the share of the load that has returned: at the end of the rows of a stage that is over,
 * else at present. */
static double returned(const gn_world *world, const gn_history *rows, bool over) {
    if (!world->ctx.scene.couple.zone_count) return NAN;
    if (!over) return gn_coupled_returned_share(&world->ctx, &world->solids, &world->ledger, 0);
    const double *column = gn_history_column(rows, "returned_energy");
    return column && rows->row_count ? column[rows->row_count - 1] : NAN;
}

/* s: the interval in which bursts are counted, excluding its end. */
typedef struct span {
    double from, until;
} span;

static size_t sizes_of(const gn_bursts *bursts, span when, int32_t *size) {
    size_t count = 0;
    for (size_t k = 0; k < bursts->count; k++) {
        const double at = bursts->row[k].time;
        if (at >= when.from && at < when.until) size[count++] = bursts->row[k].size;
    }
    return count;
}

/* Returns the share by which the stiffness of a slender bar is too large, which the error budget
 * may contain. */
static double by_ends(const gn_world *world) {
    const double most = 0.05;
    gn_test_groups groups;
    const gn_bar_section *x = &world->section;
    if (x->guessed == 0.0 && x->spread > most &&
        gn_study_find_case(&world->ctx, &world->dem, &groups))
        return NAN;
    return gn_section_by_ends(&world->ctx, &world->section);
}

static gn_tested tested_of(const gn_world *world, const gn_history *rows, bool over) {
    const gn_test *t = &world->ctx.scene.test;
    const gn_fragments pieces = gn_dem_fragments(&world->ctx, &world->dem);
    return (gn_tested){
        .kind = t->kind,
        .dimension = (int)world->ctx.scene.dimension,
        .axis = (int)t->axis,
        .sign = gn_scene_test(&world->ctx.scene)->sign,
        .notched = t->given.notch > 0.0,
        .by_ends = by_ends(world),
        .by_mean = gn_section_by_mean(&world->ctx, &world->dem, &world->solids, &world->section),
        .under_gravity = gn_scene_has_gravity(&world->ctx.scene),
        .attracts = world->ctx.effects & GN_FX_COHESION,
        .conversion_halted = !over && world->outcome.halt[0],
        .fragments = pieces.count,
        .largest_fragment = pieces.largest,
        .cut = gn_cutting_describe(&world->ctx, &world->dem, &world->cutting),
        .zones = world->ctx.scene.couple.zone_count > 0,
        .returned_energy = returned(world, rows, over),
        .section =
            gn_scene_tested(&world->ctx.scene)
                ? gn_test_shape(&world->ctx, &world->dem, &world->boundary, &world->solids).section
                : NAN,
        .elastic = !world->ctx.scene.has_specimen,
        .one_sided = !gn_scene_end_drives(&world->ctx.scene, &t->lower) ||
                     !gn_scene_end_drives(&world->ctx.scene, &t->upper),
        .no_bursts = world->ctx.effects & GN_FX_BONDS
                         ? "with output.events: off no breaks are recorded"
                         : "the scene has no bonds"};
}

/* Computes readings; `over`: the rows end before the end of the run. */
static gneiss_status compute(const gn_world *world, const gn_history *rows, span when, bool over,
                             gn_readings *readings, gneiss_error *error) {
    gn_tested tested = tested_of(world, rows, over);
    gn_bursts bursts;
    gneiss_status status = gn_bursts_find(&world->ctx, &world->dem, &bursts, error);
    int32_t *size = calloc(bursts.count + 1, sizeof *size);
    if (status == GNEISS_OK && !size)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu bursts", bursts.count);
    if (status == GNEISS_OK) {
        tested.bursts = world->ctx.effects & GN_FX_EVENTS ? size : NULL;
        tested.burst_count = sizes_of(&bursts, when, size);
        gn_readings_compute(rows, &tested, readings);
        /* A quotient by zero is not a reading. */
#define X(name, unit, text)                                                                        \
    if (!isfinite(readings->name)) readings->name = NAN;
        GN_READINGS(X)
#undef X
    }
    free(size);
    gn_bursts_free(&bursts);
    return status;
}

static size_t rows_of(const gn_run *run, size_t stage, size_t *begin) {
    *begin = (size_t)run->world.stages.state[stage].row;
    size_t end = run->history.row_count;
    if (stage < run->world.stages.now) end = (size_t)run->world.stages.state[stage + 1].row;
    return end - *begin;
}

/* Tells whether the readings of a stage count a column from the start of the stage, while the
 * history counts it from the start of the run: strains, displacements of the ends and of the gauge,
 * broken bonds. A loss of volume becomes relative to the volume at the start of the stage. */
static bool counts_from_start(const char *name) {
    static const char *const whole[] = {
        "strain",    "volumetric_strain", "lateral_strain", "dilation",     "deflection",
        "opening",   "strain_xx",         "strain_yy",      "strain_zz",    "strain_xy",
        "strain_yz", "strain_xz",         "broken_tension", "broken_shear", "broken_joints"};
    for (size_t k = 0; k < sizeof whole / sizeof *whole; k++)
        if (strcmp(name, whole[k]) == 0) return true;
    return false;
}

/* Copies the rows of a stage to a table of its own, with such columns relative to the first row,
 * which is of the instant of the change. */
static gneiss_status part_of(const gn_run *run, size_t stage, gn_history *part,
                             gneiss_error *error) {
    const gn_history *all = &run->history;
    size_t begin, rows = rows_of(run, stage, &begin), own = 0;
    for (size_t c = 0; c < all->column_count; c++) own += counts_from_start(all->columns[c].name);
    *part = *all;
    part->row_count = rows;
    part->columns = calloc(all->column_count + 1, sizeof *part->columns);
    double *values = calloc(own * rows + 1, sizeof *values);
    if (!part->columns || !values) {
        free(part->columns);
        free(values);
        gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for readings of a stage");
        return GNEISS_ERROR_MEMORY;
    }
    part->columns[all->column_count].value = values;
    for (size_t c = 0; c < all->column_count; c++) {
        part->columns[c] = all->columns[c];
        if (rows) part->columns[c].value += begin;
        if (!rows || !counts_from_start(all->columns[c].name)) continue;
        const double *from = part->columns[c].value;
        const gn_test_descriptor *d = gn_scene_test(&run->world.ctx.scene);
        const bool relative =
            ((d->isotropic || d->enclosed) && strcmp(all->columns[c].name, "strain") == 0) ||
            (d->enclosed && strcmp(all->columns[c].name, "volumetric_strain") == 0);
        /* The remaining volume or length, to which a loss is relative. */
        const double left = relative ? 1.0 - from[0] : 1.0;
        for (size_t r = 0; r < rows; r++) values[r] = (from[r] - from[0]) / left;
        part->columns[c].value = values;
        values += rows;
    }
    return GNEISS_OK;
}

/* Returns the stage whose readings are those of the run. */
static size_t stage_read(const gn_run *run) {
    size_t stage = run->world.stages.now, begin;
    while (stage > 0 && !rows_of(run, stage, &begin)) stage--;
    return stage;
}

/* Marks readings of fragments as absent, because the world contains only the present fragments. */
static void leave_fragments(gn_readings *readings) {
    const gn_reading list[] = {GN_READING_fragments, GN_READING_largest_fragment};
    for (size_t k = 0; k < 2; k++)
        if (!readings->reason[list[k]][0])
            snprintf(readings->reason[list[k]], GN_REASON_SIZE,
                     "fragments are counted at the end of the run, which is in another stage");
    readings->fragments = readings->largest_fragment = NAN;
}

static gneiss_status compute_stage(const gn_run *run, size_t stage, gn_readings *readings,
                                   gneiss_error *error) {
    gn_history part;
    GN_TRY(part_of(run, stage, &part, error));
    const gn_world *w = &run->world;
    const bool over = stage < w->stages.now;
    const span when = {w->stages.state[stage].time,
                       over ? w->stages.state[stage + 1].time : INFINITY};
    gneiss_status status = compute(w, &part, when, over, readings, error);
    if (stage != stage_read(run)) leave_fragments(readings);
    free(part.columns[part.column_count].value);
    free(part.columns);
    return status;
}

/* --- readings of the run --- */

static bool same(const state *a, const state *b) {
    return a->step == b->step && a->broken == b->broken && a->lost == b->lost &&
           a->rows == b->rows && a->stage == b->stage;
}

gneiss_status gn_run_readings(const gn_run *run, const gn_readings **readings,
                              gneiss_error *error) {
    const gn_world *w = &run->world;
    struct gn_run_read *read = run->read;
    const state now = {w->ctx.step, gn_dem_breaks(&w->dem), w->dem.lost, run->history.row_count,
                       w->stages.now};
    *readings = &read->readings;
    if (read->known && same(&read->of, &now)) return GNEISS_OK;
    read->known = false;
    free(read->budget);
    read->budget = NULL;
    if (gn_run_staged(run))
        GN_TRY(compute_stage(run, stage_read(run), &read->readings, error));
    else
        GN_TRY(
            compute(w, &run->history, (span){-INFINITY, INFINITY}, false, &read->readings, error));
    read->known = true;
    read->of = now;
    return GNEISS_OK;
}

bool gn_run_reads(const gn_run *run, gn_reading which) {
    const gn_scene *s = &run->world.ctx.scene;
    return gn_reading_belongs(which, s->test.kind, s->couple.zone_count > 0);
}

gneiss_status gn_run_budget(const gn_run *run, const gn_budget **budget, gneiss_error *error) {
    const gn_readings *r;
    GN_TRY(gn_run_readings(run, &r, error));
    if (!run->read->budget)
        GN_TRY(gn_budget_create(&run->world, &run->history, r, &run->read->budget, error));
    *budget = run->read->budget;
    return GNEISS_OK;
}

gneiss_status gn_run_stage_readings(const gn_run *run, size_t stage, gn_readings *readings,
                                    gneiss_error *error) {
    const gn_readings *r;
    if (stage != stage_read(run)) return compute_stage(run, stage, readings, error);
    GN_TRY(gn_run_readings(run, &r, error));
    *readings = *r;
    return GNEISS_OK;
}
