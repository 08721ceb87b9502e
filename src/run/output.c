/* The world as files: snapshots, results.h5, summary.json (docs/results.md). */
#include "base/effects.h"
#include "base/error.h"
#include "base/new.h"
#include "base/resident.h"
#include "base/timer.h"
#include "base/vec3.h"
#include "base/version.h"
#include "conversion/conversion.h"
#include "io/atomic_file.h"
#include "io/io.h"
#include "io/snapshot.h"
#include "membrane/membrane.h"
#include "particles/dormant.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "run/budget.h"
#include "run/output_contacts.h"
#include "run/output_fields.h"
#include "run/output_table.h"
#include "run/part_files.h"
#include "run/run.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "scene/values.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/space.h"
#include "world/world.h"
#include "zones/zone_state.h"

#include <math.h>
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
        GN_TRY(gn_snapshot_series(run->directory, gn_elements_file(k, "elements", name),
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

static void effect_names(gn_effects effects, char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < GN_EFFECT_COUNT && used < size; k++)
        if (effects >> k & 1)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " " : "",
                                     gn_effect_name((gn_effect_index)k));
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

/* Reports the corrections of the momentum that changes of the particles' masses would have
 * caused. */
static void summary_corrections(const gn_world *world, gn_json *json) {
    const gn_corrections *c = &world->converted.corrected;
    const gn_conversion_parts *p = &world->converted.parts;
    if (!gn_converts(&world->ctx)) return;
    gn_json_object(json, "conversions");
    GN_JSON_NUMBERS(json, {"count", (double)c->count}, {"wider", (double)c->wider},
                    {"missed", (double)c->missed}, {"least", c->missed > 0.0 ? c->least : 1.0},
                    {"kinetic", c->energy}, {"turned", sqrt(gn_dot3(c->turned, c->turned))},
                    {"turned_most", c->scale > 0.0 ? c->most / c->scale : 0.0},
                    {"centre", sqrt(gn_dot3(c->centre, c->centre))}, {"inertia", c->inertia});
    gn_json_object(json, "booked");
    GN_JSON_NUMBERS(json, {"sampled", p->sampled}, {"stiffness", p->stiffness},
                    {"uneven", p->uneven}, {"balance", p->balance}, {"motion", p->motion},
                    {"step", p->step});
    gn_json_end(json);
    gn_json_number(json, "held", p->alike[0] > 0.0 ? p->alike[1] / p->alike[0] : 1.0);
    gn_json_end(json);
}

/* Reports the relaxations of converted particles. */
static void summary_relaxation(const gn_world *world, gn_json *json) {
    const gn_relaxations *r = &world->converted.relaxed;
    if (!gn_converts(&world->ctx) || !(world->ctx.scene.couple.convert.relax > 0.0)) return;
    gn_json_object(json, "relaxation");
    GN_JSON_NUMBERS(json, {"count", (double)r->count}, {"iterations", (double)r->iterations},
                    {"missed", (double)r->missed}, {"broke", (double)r->stopped_by_bond_failure},
                    {"loose", (double)r->unsupported}, {"tired", (double)r->hit_iteration_limit},
                    {"kept", (double)r->kept}, {"worst", r->worst});
    gn_json_end(json);
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
    char effects[512], hash[24];
    effect_names(w->ctx.effects, effects, sizeof effects);
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
    GN_TRY(gn_elements_results(w, file, error));
    GN_TRY(gn_bodies_results(w, file, error));
    GN_TRY(gn_owners_results(w, file, error));
    GN_TRY(put_state(w, file, error));
    GN_TRY(gn_fragments_results(w, file, error));
    GN_TRY(gn_rim_results(w, file, error));
    GN_TRY(gn_events_results(w, file, error));
    GN_TRY(gn_output_lost(w, file, error));
    return gn_h5_commit(&file, GN_DURABLE, error);
}

/* --- summary.json --- */

static size_t touching(const gn_contacts *list) {
    size_t count = 0;
    for (size_t c = 0; c < list->soa.count; c++) count += gn_contact_carries(list, c);
    return count;
}

static gneiss_status summary_warnings(const gn_run *run, gn_json *json, gneiss_error *error) {
    gn_warnings list;
    GN_TRY(gn_run_warnings(run, &list, error));
    gn_json_array(json, "warnings");
    for (size_t k = 0; k < list.count; k++) {
        gn_json_object(json, NULL);
        gn_json_text(json, "name", list.warning[k].name);
        gn_json_text(json, "text", list.warning[k].text);
        gn_json_end(json);
    }
    gn_json_end(json);
    return GNEISS_OK;
}

/* Writes the readings that belong to the test as numbers, null for an absent one, and the reason
 * for it. */
static void summary_of(const gn_run *run, const gn_readings *readings, gn_json *json) {
    gn_json_object(json, "readings");
#define X(name, unit, text)                                                                        \
    if (gn_run_reads(run, GN_READING_##name)) gn_json_number(json, #name, readings->name);
    GN_READINGS(X)
#undef X
    gn_json_end(json);
    gn_json_object(json, "absent");
#define X(name, unit, text)                                                                        \
    if (gn_run_reads(run, GN_READING_##name) && readings->reason[GN_READING_##name][0])            \
        gn_json_text(json, #name, readings->reason[GN_READING_##name]);
    GN_READINGS(X)
#undef X
    gn_json_end(json);
}

static gneiss_status summary_readings(const gn_run *run, gn_json *json, gneiss_error *error) {
    const gn_readings *r;
    const gn_budget *budget;
    GN_TRY(gn_run_readings(run, &r, error));
    GN_TRY(gn_run_budget(run, &budget, error));
    summary_of(run, r, json);
    gn_budget_summary(budget, r, json);
    return GNEISS_OK;
}

static void summary_counts(const gn_world *world, size_t contacts, gn_json *json) {
    gn_json_object(json, "counts");
    bool flows = gn_scene_has_flow(&world->ctx.scene);
    gn_json_integer(
        json, "particles",
        (int64_t)(flows ? gn_dem_present_count(&world->dem) : world->dem.particles.soa.count));
    if (gn_converts(&world->ctx))
        gn_json_integer(json, "asleep", (int64_t)gn_dormant_count(&world->dem));
    GN_JSON_NUMBERS(
        json, {"contacts", (double)contacts}, {"bonds", (double)world->dem.bonds_at_start},
        {"broken_tension", (double)world->dem.broken_tension},
        {"broken_shear", (double)world->dem.broken_shear}, {"removed", (double)world->dem.lost});
    if (world->ctx.scene.body_count) {
        GN_JSON_NUMBERS(json, {"bodies", (double)world->ctx.scene.body_count},
                        {"facets", (double)world->boundary.body_corner_count /
                                       (double)world->ctx.scene.dimension});
    }
    if (world->solids.count) {
        gn_element_totals t = gn_elements_totals(&world->solids);
        GN_JSON_NUMBERS(json, {"nodes", (double)t.nodes}, {"elements", (double)t.elements});
    }
    gn_json_end(json);
}

static void summary_step(const gn_world *world, gn_json *json) {
    GN_JSON_NUMBERS(json, {"steps", (double)world->ctx.step}, {"time", world->ctx.time},
                    {"dt", world->ctx.dt}, {"dt_limit", world->ctx.stable},
                    {"dt_limit_sharp", gn_timestep_sharp_limit(&world->ctx, &world->solids)},
                    {"dt_limit_bound",
                     gn_timestep_bound(&world->ctx, &world->dem, &world->solids, &world->zones)},
                    {"dt_resolution", world->ctx.choice.resolution.step});
}

/* Reports the mass that was added for a longer step. */
static void summary_mass_scaling(const gn_world *world, gn_json *json) {
    const gn_mass_scaling *s = &world->ctx.choice.scaling;
    const gn_raised_masses *raised = &world->dem.raised;
    if (!(world->ctx.effects & GN_FX_MASS_SCALING)) return;
    gn_json_object(json, "mass_scaling");
    GN_JSON_NUMBERS(
        json, {"added_mass", raised->added}, {"added_share", raised->added / world->dem.mass},
        {"added_kinetic", gn_dem_added_kinetic(&world->dem)}, {"particles", (double)raised->count},
        {"largest_factor", raised->largest}, {"dt_wanted", s->step > 0.0 ? s->step : s->unscaled},
        {"dt_without", s->unscaled});
    gn_json_end(json);
}

/* Reports the stages that have begun: their begin, their end, and their readings. */
static gneiss_status summary_stages(const gn_run *run, gn_json *json, gneiss_error *error) {
    const gn_world *w = &run->world;
    if (!gn_run_staged(run)) return GNEISS_OK;
    gn_json_array(json, "stages");
    for (size_t k = 0; k <= w->stages.now; k++) {
        const gn_stage_state *s = &w->stages.state[k];
        char reason[96];
        gn_readings r;
        GN_TRY(gn_run_stage_readings(run, k, &r, error));
        gn_json_object(json, NULL);
        gn_json_text(json, "name", w->ctx.scene.stages[k].name);
        GN_JSON_NUMBERS(json, {"step", (double)s->step}, {"time", s->time},
                        {"row", (double)s->row});
        gn_json_text(json, "ended",
                     gn_stage_reason(&w->ctx.scene.stages[k], (gn_stage_cause)s->ended, reason,
                                     sizeof reason));
        summary_of(run, &r, json);
        gn_json_end(json);
    }
    gn_json_end(json);
    return GNEISS_OK;
}

/* Returns the largest memory of the process since its start, bytes. */
static int64_t peak_memory(void) {
    gn_resident r;
    return gn_resident_read(&r) ? (int64_t)r.peak : 0;
}

/* Reports the static solution from which the run began. */
static void summary_start(const gn_run *run, gn_json *json) {
    const gn_first_break *b = &run->first_break;
    if (!b->steps) return;
    gn_json_object(json, "first_break");
    GN_JSON_NUMBERS(json, {"time", b->time}, {"first", (double)b->i}, {"second", (double)b->j},
                    {"start", b->start}, {"steps", (double)b->steps},
                    {"solutions", (double)b->solutions}, {"iterations", (double)b->iterations},
                    {"unbalanced", b->unbalanced}, {"shortfall", b->shortfall});
    gn_json_end(json);
}

/* Reports the cost of the run and its parts. */
static void summary_cost(const gn_run *run, gn_json *json) {
    const gn_world *w = &run->world;
    gn_progress p = gn_run_progress(run);
    gn_json_integer(json, "list_rebuilds", w->dem.verlet.rebuilds);
    gn_json_object(json, "seconds");
    for (int k = 0; k < GN_PHASE_COUNT; k++)
        gn_json_number(json, gn_phase_name((gn_phase)k), w->ctx.seconds[k]);
    GN_JSON_NUMBERS(json, {"total", p.seconds}, {"cpu", p.cpu_seconds});
    gn_json_end(json);
    GN_JSON_NUMBERS(json, {"peak_memory", (double)peak_memory()},
                    {"particle_steps_per_second",
                     (double)w->dem.particles.soa.count * (double)w->ctx.step / p.seconds},
                    {"contact_steps_per_second", (double)w->dem.contact_steps / p.seconds});
    if (w->solids.count)
        gn_json_number(json, "element_steps_per_second", p.element_steps_per_second);
    gn_json_integer(json, "threads", w->ctx.threads);
    gn_json_text(json, "isa", w->ctx.kernels->name);
    gn_json_text(json, "precision", w->ctx.effects & GN_FX_MIXED ? "mixed" : "double");
    gn_json_text(json, "version", gn_version());
    gn_json_text(json, "build", gn_build());
}

gneiss_status gn_output_summary(const gn_run *run, gneiss_error *error) {
    const gn_world *w = &run->world;
    gn_observed seen;
    gn_ranks_whole(w->ctx.ranks);
    if (!gn_rank_writes()) return GNEISS_OK;
    GN_TRY(gn_dem_observe(&w->ctx, &w->dem, &w->box, &seen, error));
    size_t contacts = 0;
    for (int l = 0; l < GN_LIST_COUNT; l++) contacts += touching(&seen.list[l]);
    gn_observed_free(&seen);
    char hash[24], path[GN_PATH_SIZE + 32];
    snprintf(
        hash, sizeof hash, "%016llx",
        (unsigned long long)gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box));
    gn_json *j = gn_json_begin();
    gn_json_text(j, "title", w->ctx.scene.title);
    gneiss_status status = summary_readings(run, j, error);
    if (status == GNEISS_OK) status = summary_stages(run, j, error);
    summary_counts(w, contacts, j);
    summary_corrections(w, j);
    summary_relaxation(w, j);
    gn_output_flow(run, j);
    gn_json_number(j, "volume", w->ctx.volume);
    gn_json_text(j, "volume_of",
                 gn_volume_source_text(
                     &w->ctx, gn_volume_source_of(&w->ctx, &w->dem, &w->boundary, &w->solids)));
    gn_json_number(j, "energy_residual",
                   w->ctx.effects & GN_FX_ENERGY ? gn_energy_residual(&w->ledger.reading) : NAN);
    if (status == GNEISS_OK) status = summary_warnings(run, j, error);
    gn_json_text(j, "state_hash", hash);
    gn_json_bool(j, "finished", run->finished);
    gn_json_text(j, "stop_reason", run->stop_reason);
    summary_start(run, j);
    summary_step(w, j);
    summary_mass_scaling(w, j);
    summary_cost(run, j);
    char *text = gn_json_finish(j, true);
    if (status != GNEISS_OK) free(text);
    GN_TRY(status);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for summary.json");
    snprintf(path, sizeof path, "%s/summary.json", run->directory);
    status = gn_write_text_file(path, text, GN_DURABLE, error);
    free(text);
    return status;
}
