/* The world as files: snapshots and results.h5 (docs/results.md). */
#include "base/effects.h"
#include "base/error.h"
#include "base/new.h"
#include "base/version.h"
#include "io/snapshot.h"
#include "membrane/membrane.h"
#include "particles/particles.h"
#include "run/budget.h"
#include "run/output_contacts.h"
#include "run/output_fields.h"
#include "run/output_table.h"
#include "run/part_files.h"
#include "run/run.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "world/space.h"
#include "world/world.h"

#include <stdlib.h>
#include <string.h>

/* --- snapshots --- */

static gneiss_status write_bonds(const gn_run *run, const gn_output_view *view, const char *name,
                                 const gn_snapshot *points, gneiss_error *error) {
    const gn_world *w = &run->world;
    const size_t count = w->dem.bonds.contacts.soa.count;
    const gn_output_source bonds = gn_output_bonds(view);
    gn_output_arrays lines;
    int32_t *ends = calloc(count + 1, 2 * sizeof *ends);
    if (!ends) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of bonds");
    for (size_t c = 0; c < count; c++) gn_output_bond_ends(view, c, ends + 2 * c);
    gneiss_status status = gn_output_arrays_read(&bonds, &lines, error);
    if (status == GNEISS_OK) {
        gn_snapshot s = *points;
        s.point_array_count = 0;
        s.line_count = count;
        s.lines = ends;
        s.line_arrays = lines.of;
        s.line_array_count = lines.count;
        status = gn_snapshot_write(run->directory, name, &s, error);
        gn_output_arrays_free(&lines);
    }
    free(ends);
    return status;
}

static bool shows_contacts(const gn_world *world) {
    return world->ctx.scene.contact_rows == GN_SWITCH_ON && world->dem.particles.soa.count;
}

static gneiss_status write_snapshot(const gn_run *run, const gn_output_view *view,
                                    const char *before, gneiss_error *error) {
    const gn_world *w = &run->world;
    const size_t count = w->dem.particles.soa.count;
    const gn_output_source particles = gn_output_particles(view);
    gn_output_arrays points;
    double *place = calloc(count + 1, 3 * sizeof *place);
    if (!place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of particles");
    for (size_t p = 0; p < count; p++) gn_output_place(view, p, place + 3 * (size_t)view->row[p]);
    gneiss_status status = gn_output_arrays_read(&particles, &points, error);
    if (status == GNEISS_OK) {
        gn_snapshot s = {.bad = w->outcome.bad,
                         .time = w->ctx.time,
                         .step = w->ctx.step,
                         .point_count = count,
                         .points = place};
        s.point_arrays = points.of;
        s.point_array_count = points.count;
        char name[64];
        snprintf(name, sizeof name, "%sparticles", before);
        status = gn_snapshot_write(run->directory, name, &s, error);
        snprintf(name, sizeof name, "%sbonds", before);
        if (status == GNEISS_OK && w->ctx.effects & GN_FX_BONDS)
            status = write_bonds(run, view, name, &s, error);
        snprintf(name, sizeof name, "%scontacts", before);
        if (status == GNEISS_OK && shows_contacts(w))
            status = gn_output_contacts_snapshot(view, run->directory, name, &s, error);
        gn_output_arrays_free(&points);
    }
    free(place);
    return status;
}

gneiss_status gn_output_snapshot(const gn_run *run, const char *before, gneiss_error *error) {
    gn_observed seen;
    gn_output_view view;
    if (!run->world.dem.particles.soa.count || !gn_rank_writes()) return GNEISS_OK;
    GN_TRY(gn_dem_observe(&run->world.ctx, &run->world.dem, &run->world.box, &seen, error));
    gneiss_status status = gn_output_view_make(&run->world, &seen, &view, error);
    if (status == GNEISS_OK) {
        status = write_snapshot(run, &view, before, error);
        gn_output_view_free(&view);
    }
    gn_observed_free(&seen);
    return status;
}

static gneiss_status write_series(gn_run *run, gneiss_error *error) {
    gn_snapshot_times *times = &run->snapshot_times;
    if (run->world.ctx.scene.body_count)
        GN_TRY(gn_snapshot_series(run->directory, "bodies", run->world.ctx.step, times, error));
    for (size_t k = 0; k < run->world.solids.count; k++) {
        char name[GN_ELEMENT_PATH];
        GN_TRY(gn_snapshot_series(run->directory, gn_output_elements_file(k, "elements", name),
                                  run->world.ctx.step, times, error));
    }
    if (!run->world.dem.particles.soa.count) return GNEISS_OK;
    GN_TRY(gn_snapshot_series(run->directory, "particles", run->world.ctx.step, times, error));
    if (shows_contacts(&run->world))
        GN_TRY(gn_snapshot_series(run->directory, "contacts", run->world.ctx.step, times, error));
    if (!(run->world.ctx.effects & GN_FX_BONDS)) return GNEISS_OK;
    return gn_snapshot_series(run->directory, "bonds", run->world.ctx.step, times, error);
}

gneiss_status gn_output_series(gn_run *run, gneiss_error *error) {
    if (gn_rank_writes()) GN_TRY(write_series(run, error));
    run->series_length = run->snapshot_times.count;
    return GNEISS_OK;
}

/* --- results.h5 --- */

static gneiss_status put_scalar(gn_h5 *file, const char *group, const char *name, double value,
                                const char *unit, const char *text, gneiss_error *error) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s", group, name);
    return gn_h5_put(file, path, GN_F64, 1, 1, 0, &value, unit, text, error);
}

/* Writes warnings as lines "name: text"; "" if there are none. */
static gneiss_status put_warnings(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_warnings list;
    GN_TRY(gn_run_warnings(run, &list, error));
    const size_t size = sizeof list;
    char *text = calloc(1, size); /* the stack already holds the list */
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for warnings");
    for (size_t k = 0, used = 0; k < list.count; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s: %s", used ? "\n" : "",
                                 list.warning[k].name, list.warning[k].text);
    const gneiss_status status = gn_h5_attribute_text(file, "/", "warnings", text, error);
    free(text);
    return status;
}

/* Writes the names of the stages, one line each; the history holds the stage of each row. */
static gneiss_status put_stages(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_scene *s = &run->world.ctx.scene;
    size_t used = 0, size = s->stage_count * (GN_NAME_SIZE + 1);
    GN_FREED char *text = NULL;
    if (!s->stage_count) return GNEISS_OK;
    GN_TRY(gn_new(&text, size, "bytes of the names of stages", error));
    for (size_t k = 0; k < s->stage_count; k++)
        used +=
            (size_t)snprintf(text + used, size - used, "%s%s", k ? "\n" : "", s->stages[k].name);
    return gn_h5_attribute_text(file, "/", "stages", text, error);
}

/* Writes the columns that a report uses as strain and stress of the test, and the readings that it
 * shows first, as lines "name: text". */
static gneiss_status put_test(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    const gn_test_descriptor *d = gn_scene_test(&world->ctx.scene);
    char figures[512] = "";
    if (!gn_scene_tested(&world->ctx.scene)) return GNEISS_OK;
    for (size_t used = 0, k = 0; d->figures[k].name && used < sizeof figures; k++)
        used += (size_t)snprintf(figures + used, sizeof figures - used, "%s%s: %s", k ? "\n" : "",
                                 gn_reading_name((gn_reading)d->figures[k].reading),
                                 d->figures[k].name);
    const gn_h5_attribute list[] = {
        {"test_strain", .text = d->strain_name ? d->strain_name : "axial strain"},
        {"test_stress", .text = d->stress_name ? d->stress_name : "axial stress"},
        {"test_figures", .text = figures}};
    return gn_h5_attributes(file, "/", list, sizeof list / sizeof *list, error);
}

/* Writes the mass that was added for a longer step. */
static gneiss_status put_mass_scaling(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    const gn_mass_scaling *s = &world->ctx.choice.scaling;
    if (!(world->ctx.effects & GN_FX_MASS_SCALING)) return GNEISS_OK;
    const gn_h5_attribute list[] = {{"added_mass", .number = &world->dem.raised.added},
                                    {"own_mass", .number = &world->dem.mass},
                                    {"dt_without_added_mass", .number = &s->unscaled}};
    return gn_h5_attributes(file, "/", list, sizeof list / sizeof *list, error);
}

/* Writes the volume and the membrane stress that enter the mean stress of the specimen. */
static gneiss_status put_space(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    const double volume =
        gn_space_volume(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                        &world->solids, &world->box, &world->approach);
    const bool membrane = world->ctx.effects & GN_FX_MEMBRANE;
    double stress[9] = {0};
    if (!membrane && volume == world->ctx.volume) return GNEISS_OK;
    gn_membrane_stress(&world->ctx, &world->membrane, volume, stress);
    const gn_h5_attribute list[] = {{"stress_volume", .number = &volume},
                                    {"membrane_stress", .number = stress, .count = 9}};
    return gn_h5_attributes(file, "/", list, membrane ? 2 : 1, error);
}

gneiss_status gn_scene_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    GN_FREED char *scene = gn_scene_write(&world->ctx.given);
    return scene ? gn_h5_put_text(file, "scene", scene, error)
                 : gn_no_memory(error, "the text of the scene");
}

static gneiss_status put_header(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    char effects[GN_EFFECT_NAMES_SIZE], hash[24];
    gn_effect_names(w->ctx.effects, " ", effects);
    snprintf(
        hash, sizeof hash, "%016llx",
        (unsigned long long)gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box));
    const int64_t threads = w->ctx.threads, finished = run->finished, steps = w->ctx.step;
    const gn_progress progress = gn_run_progress(run);
    const gn_h5_attribute list[] = {
        {"title", .text = w->ctx.scene.title},
        {"scene_file", .text = w->ctx.scene.source},
        {"version", .text = gn_version()},
        {"build", .text = gn_build()},
        {"isa", .text = w->ctx.kernels->name},
        {"precision", .text = w->ctx.effects & GN_FX_MIXED ? "mixed" : "double"},
        {"effects", .text = effects},
        {"state_hash", .text = hash},
        {"stop_reason", .text = run->stop_reason},
        {"threads", .whole = &threads},
        {"finished", .whole = &finished},
        {"dimension", .whole = &w->ctx.scene.dimension},
        {"steps", .whole = &steps},
        {"dt", .number = &w->ctx.dt},
        {"volume", .number = &w->ctx.volume},
        {"volume_of",
         .text = gn_volume_source_text(
             &w->ctx, gn_volume_source_of(&w->ctx, &w->dem, &w->boundary, &w->solids))},
        {"seconds", .number = &progress.seconds},
        {"cpu_seconds", .number = &progress.cpu_seconds},
        {"origin", .number = w->ctx.scene.origin, .count = 3},
    };
    GN_TRY(gn_h5_attributes(file, "/", list, sizeof list / sizeof *list, error));
    GN_TRY(put_test(w, file, error));
    GN_TRY(put_mass_scaling(w, file, error));
    GN_TRY(put_space(w, file, error));
    GN_TRY(put_stages(run, file, error));
    GN_TRY(put_warnings(run, file, error));
    return gn_scene_results(w, file, error);
}

/* Writes one reading; an absent one is NaN and has a reason. */
static gneiss_status put_reading(gn_h5 *file, const char *group, const char *name, double value,
                                 const char *unit, const char *text, const char *reason,
                                 gneiss_error *error) {
    char path[GN_NAME_SIZE + 160];
    snprintf(path, sizeof path, "%s/%s", group, name);
    GN_TRY(gn_h5_put(file, path, GN_F64, 1, 1, 0, &value, unit, text, error));
    return *reason ? gn_h5_attribute_text(file, path, "absent", reason, error) : GNEISS_OK;
}

/* Writes the readings that belong to the test. */
static gneiss_status put_group(const gn_run *run, gn_h5 *file, const char *group,
                               const gn_readings *readings, gneiss_error *error) {
    bool demanded = gn_h5_demand_finite(file, false);
#define X(name, unit, text)                                                                        \
    if (gn_run_reads(run, GN_READING_##name))                                                      \
        GN_TRY(put_reading(file, group, #name, readings->name, unit, text,                         \
                           readings->reason[GN_READING_##name], error));
    GN_READINGS(X)
#undef X
    gn_h5_demand_finite(file, demanded);
    return GNEISS_OK;
}

/* Writes the readings of all stages that have begun. */
static gneiss_status put_stage_readings(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    for (size_t k = 0; gn_run_staged(run) && k <= w->stages.now; k++) {
        char group[GN_NAME_SIZE + 32];
        gn_readings r;
        GN_TRY(gn_run_stage_readings(run, k, &r, error));
        snprintf(group, sizeof group, "stages/%s/readings", w->ctx.scene.stages[k].name);
        GN_TRY(put_group(run, file, group, &r, error));
    }
    return GNEISS_OK;
}

static gneiss_status put_readings(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_readings *r;
    const gn_budget *budget;
    GN_TRY(gn_run_readings(run, &r, error));
    GN_TRY(gn_run_budget(run, &budget, error));
    GN_TRY(put_group(run, file, "readings", r, error));
    GN_TRY(gn_budget_results(budget, r, file, error));
    return put_stage_readings(run, file, error);
}

static gneiss_status put_energy(gn_h5 *file, const gn_energy_figure *figure, gneiss_error *error) {
    char path[160];
    GN_TRY(
        put_scalar(file, "energy", figure->name, figure->value, figure->unit, figure->text, error));
    snprintf(path, sizeof path, "energy/%s", figure->name);
    return figure->kind ? gn_h5_attribute_text(file, path, "kind", figure->kind, error) : GNEISS_OK;
}

static gneiss_status put_tables(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    for (size_t c = 0; c < run->history.column_count; c++) {
        const gn_column *column = &run->history.columns[c];
        char path[160];
        snprintf(path, sizeof path, "history/%s", column->name);
        gn_h5_demand_finite(file, !column->absent && !w->outcome.bad);
        GN_TRY(gn_h5_put(file, path, GN_F64, run->history.row_count, 1, 0, column->value,
                         column->unit, column->text, error));
    }
    gn_h5_demand_finite(file, !w->outcome.bad);
    GN_TRY(put_readings(run, file, error));
    gn_energy_figure figure[GN_ENERGY_FIGURES];
    gn_energy_figures(&w->ledger.reading, figure);
    for (int k = 0; w->ctx.effects & GN_FX_ENERGY && k < GN_ENERGY_FIGURES; k++)
        GN_TRY(put_energy(file, &figure[k], error));
    for (int k = 0; k < GN_PHASE_COUNT; k++)
        GN_TRY(put_scalar(file, "profile", gn_phase_name((gn_phase)k), w->ctx.seconds[k], "s",
                          gn_phase_text((gn_phase)k), error));
    return GNEISS_OK;
}

static gneiss_status put_state(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    GN_FREED_BY(gn_observed_free) gn_observed seen = {0};
    GN_FREED_BY(gn_output_view_free) gn_output_view view = {0};
    if (!world->dem.particles.soa.count && !(world->ctx.effects & GN_FX_BONDS)) return GNEISS_OK;
    GN_TRY(gn_dem_observe(&world->ctx, &world->dem, &world->box, &seen, error));
    GN_TRY(gn_output_view_make(world, &seen, &view, error));
    const gn_output_source particles = gn_output_particles(&view), bonds = gn_output_bonds(&view);
    if (world->dem.particles.soa.count) GN_TRY(gn_output_put(&particles, file, error));
    if (world->ctx.effects & GN_FX_BONDS) GN_TRY(gn_output_put(&bonds, file, error));
    return shows_contacts(world) ? gn_output_contacts_put(&view, file, error) : GNEISS_OK;
}

gneiss_status gn_output_results(const gn_run *run, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    const gn_world *w = &run->world;
    GN_FREED_BY(gn_h5_close_at) gn_h5 *file = NULL;
    gn_ranks_whole(w->ctx.ranks);
    if (!gn_rank_writes()) return GNEISS_OK;
    snprintf(path, sizeof path, "%s/results.h5", run->directory);
    GN_TRY(gn_h5_create(path, &file, error));
    gn_h5_demand_finite(file, !w->outcome.bad);
    GN_TRY(put_header(run, file, error));
    GN_TRY(put_tables(run, file, error));
    GN_TRY(gn_output_elements_results(w, file, error));
    GN_TRY(gn_bodies_results(w, file, error));
    GN_TRY(gn_owners_results(w, file, error));
    GN_TRY(put_state(w, file, error));
    GN_TRY(gn_fragments_results(w, file, error));
    GN_TRY(gn_rim_results(w, file, error));
    GN_TRY(gn_events_results(w, file, error));
    GN_TRY(gn_output_lost(w, file, error));
    return gn_h5_commit(&file, GN_DURABLE, error);
}
