/* The summary of a run, summary.json (docs/results.md). */
#include "base/effects.h"
#include "base/error.h"
#include "base/resident.h"
#include "base/vec3.h"
#include "base/version.h"
#include "io/io.h"
#include "particles/dormant.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "run/budget.h"
#include "run/output_fields.h"
#include "run/output_table.h"
#include "run/run.h"
#include "run/stages.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
        {"added_kinetic", gn_timestep_added_kinetic(&world->dem)},
        {"particles", (double)raised->count}, {"largest_factor", raised->largest},
        {"dt_wanted", s->step > 0.0 ? s->step : s->unscaled}, {"dt_without", s->unscaled});
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
