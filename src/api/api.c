/* Public API of scenes and worlds. It checks arguments and manages handles; a run does the work.
 */
#include "api/handles.h"
#include "base/new.h"
#include "base/timer.h"
#include "conversion/conversion.h"
#include "particles/dormant.h"
#include "timestep/timestep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)GNEISS_F64 == (int)GN_F64 && (int)GNEISS_I64 == (int)GN_I64 &&
                   (int)GNEISS_I32 == (int)GN_I32 && (int)GNEISS_U8 == (int)GN_U8 &&
                   (int)GNEISS_F32 == (int)GN_F32,
               "public and inner types have the same numbers");

const char *gneiss_version(void) {
    return gn_version();
}

const char *gneiss_build(void) {
    return gn_build();
}

const char *gneiss_status_name(gneiss_status status) {
    return gn_status_name(status);
}

/* --- arguments --- */

gneiss_status gn_api_require(const void *pointer, const char *what, gneiss_error *error) {
    if (pointer) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "argument %s: expected a pointer, found NULL", what);
}

/* Checks that names of the files of a run fit after the path. */
static gneiss_status require_path(const char *path, const char *what, gneiss_error *error) {
    GN_TRY(gn_api_require(path, what, error));
    if (strlen(path) < GN_PATH_SIZE - 64) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "argument %s: expected a path of less than %d characters, found %zu", what,
                   GN_PATH_SIZE - 64, strlen(path));
}

/* "key=value" strings, split. The values point into the caller's strings. */
typedef struct override_list {
    gn_override *items;
    size_t count;
} override_list;

static void free_overrides(override_list *list) {
    for (size_t k = 0; k < list->count; k++) free((char *)(uintptr_t)list->items[k].key);
    free(list->items);
    *list = (override_list){0};
}

static gneiss_status cut_override(const char *text, size_t index, gn_override *out,
                                  gneiss_error *error) {
    const char *equals = text ? strchr(text, '=') : NULL;
    if (!equals || equals == text)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "overrides[%zu]: expected \"key=value\", found %s%.200s%s", index,
                       text ? "\"" : "", text ? text : "NULL", text ? "\"" : "");
    out->key = strndup(text, (size_t)(equals - text));
    out->value = equals + 1;
    return out->key ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for overrides");
}

static gneiss_status make_overrides(const char *const *texts, size_t count, override_list *list,
                                    gneiss_error *error) {
    *list = (override_list){0};
    if (count == 0) return GNEISS_OK;
    GN_TRY(gn_api_require(texts, "overrides", error));
    list->items = calloc(count, sizeof *list->items);
    if (!list->items) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for overrides");
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k < count && status == GNEISS_OK; k++) {
        status = cut_override(texts[k], k, &list->items[k], error);
        if (status == GNEISS_OK) list->count++;
    }
    if (status != GNEISS_OK) free_overrides(list);
    return status;
}

/* --- scenes --- */

/* Reads a scene for both functions of the API; `text` NULL: from the file `name`. */
static gneiss_status read_scene(const char *text, const char *name, const char *folder,
                                const override_list *list, gneiss_scene *scene,
                                gneiss_error *error) {
    if (text)
        GN_TRY(gn_scene_parse(text, name, folder, list->items, list->count, &scene->scene, error));
    else
        GN_TRY(gn_scene_load(name, list->items, list->count, &scene->scene, error));
    scene->text = gn_scene_write(&scene->scene);
    if (scene->text) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory for the scene text", name);
}

static gneiss_status make_scene(const char *text, const char *name, const char *folder,
                                const char *const *overrides, size_t override_count,
                                gneiss_scene **out, gneiss_error *error) {
    override_list list;
    GN_TRY(make_overrides(overrides, override_count, &list, error));
    gneiss_scene *scene = calloc(1, sizeof *scene);
    gneiss_status status = scene ? read_scene(text, name, folder, &list, scene, error)
                                 : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a scene");
    free_overrides(&list);
    if (status == GNEISS_OK)
        *out = scene;
    else
        gneiss_scene_free(scene);
    return status;
}

gneiss_status gneiss_scene_load(const char *path, const char *const *overrides,
                                size_t override_count, gneiss_scene **scene, gneiss_error *error) {
    GN_TRY(gn_api_require(scene, "scene", error));
    *scene = NULL;
    GN_TRY(gn_api_require(path, "path", error));
    return make_scene(NULL, path, NULL, overrides, override_count, scene, error);
}

gneiss_status gneiss_scene_parse(const char *text, const char *name, const char *folder,
                                 const char *const *overrides, size_t override_count,
                                 gneiss_scene **scene, gneiss_error *error) {
    GN_TRY(gn_api_require(scene, "scene", error));
    *scene = NULL;
    GN_TRY(gn_api_require(text, "text", error));
    return make_scene(text, name ? name : "scene", folder, overrides, override_count, scene, error);
}

const char *gneiss_scene_text(const gneiss_scene *scene) {
    return scene ? scene->text : NULL;
}

void gneiss_scene_allow_gmsh(gneiss_scene *scene, int allow) {
    if (scene) scene->scene.allow_gmsh = allow != 0;
}

static gneiss_status prepare(void *context, size_t count, double *position, int32_t *material,
                             int32_t *group, const double origin[3], gneiss_error *error) {
    const gneiss_scene *scene = context;
    gneiss_specimen specimen = {
        count, position, material, group, {origin[0], origin[1], origin[2]}};
    if (scene->prepare(scene->context, &specimen) == 0) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: the specimen was refused by its preparation",
                   scene->scene.source);
}

void gneiss_scene_prepare(gneiss_scene *scene, gneiss_prepare *own, void *context) {
    if (!scene) return;
    scene->prepare = own;
    scene->context = context;
    scene->scene.preparation = own ? (gn_preparation){prepare, scene} : (gn_preparation){0};
}

void gneiss_scene_free(gneiss_scene *scene) {
    if (!scene) return;
    gn_scene_free(&scene->scene);
    free(scene->text);
    free(scene);
}

/* --- worlds --- */

static gneiss_status new_world(gneiss_world **world, gneiss_error *error) {
    return gn_new(world, 1, "a world", error);
}

/* Gives the world to the caller, or frees its handle on failure; a failed run owns nothing. */
static gneiss_status hand_over(gneiss_status status, gneiss_world *made, gneiss_world **world) {
    if (status == GNEISS_OK)
        *world = made;
    else
        free(made);
    return status;
}

gneiss_status gneiss_world_create(const gneiss_scene *scene, const char *folder,
                                  gneiss_world **world, gneiss_error *error) {
    gneiss_world *made;
    GN_FREED_BY(gn_scene_delete) gn_scene *copy = NULL; /* too large for a small stack */
    GN_TRY(gn_api_require(world, "world", error));
    *world = NULL;
    GN_TRY(gn_api_require(scene, "scene", error));
    if (folder) GN_TRY(require_path(folder, "folder", error));
    GN_TRY(gn_new(&copy, 1, "a copy of the scene", error));
    GN_TRY(gn_scene_copy(&scene->scene, copy, error));
    GN_TRY(new_world(&made, error));
    gneiss_status status = folder ? gn_run_start(copy, folder, false, &made->run, error)
                                  : gn_run_create(copy, &made->run, error);
    return hand_over(status, made, world);
}

void gneiss_world_free(gneiss_world *world) {
    if (!world) return;
    gn_run_free(&world->run);
    gn_api_hooks_free(&world->hooks);
    free(world);
}

gneiss_status gn_api_require_whole(const gneiss_world *world, gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    if (!world->hooks.acting) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected only reading calls inside a field of force, found another");
}

gneiss_status gn_api_require_good(const gneiss_world *world, gneiss_error *error) {
    GN_TRY(gn_api_require_whole(world, error));
    if (world->failure.status == GNEISS_OK) return GNEISS_OK;
    return gn_fail(error, world->failure.status, "%s", world->failure.message);
}

/* Does the same as gn_api_require_good, for functions that must not be called inside a call between
 * steps. */
static gneiss_status require_free(const gneiss_world *world, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    if (!world->hooks.inside) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected no advance of a world inside a call of its own hooks, found one");
}

/* Appends to the message where the bad state was stored. */
static void keep_bad_state(gneiss_world *world) {
    gneiss_error second = {0}, first = world->failure;
    if (!world->run.directory[0]) return;
    if (gn_run_write_failure(&world->run, first.message, &second) == GNEISS_OK)
        gn_fail(&world->failure, first.status,
                "%.1500s\n  the state is in %.300s (failed_*.hdf, results.h5)", first.message,
                world->run.directory);
}

/* Called after an advance. An output that could not be written leaves the world intact; any other
 * error ends it permanently. */
static gneiss_status settle(gneiss_world *world, gneiss_status status, const gneiss_error *found,
                            gneiss_error *error) {
    if (status == GNEISS_OK) return GNEISS_OK;
    if (status == GNEISS_ERROR_IO) return gn_fail(error, status, "%s", found->message);
    world->failure = *found;
    if (status == GNEISS_ERROR_UNSTABLE) keep_bad_state(world);
    return gn_fail(error, status, "%s", world->failure.message);
}

gneiss_status gneiss_world_step(gneiss_world *world, int64_t steps, gneiss_error *error) {
    gneiss_error found = {0};
    GN_TRY(require_free(world, error));
    if (steps < 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument steps: expected a number of at least 0, found %lld",
                       (long long)steps);
    while (steps > 0) {
        gneiss_status status = gn_run_some_steps(&world->run, &steps, &world->hooks.due, &found);
        if (status != GNEISS_OK) return settle(world, status, &found, error);
        GN_TRY(gn_api_hooks_call(world, error));
    }
    return GNEISS_OK;
}

gneiss_status gneiss_world_advance(gneiss_world *world, double seconds, gneiss_error *error) {
    gneiss_error found = {0};
    GN_TRY(require_free(world, error));
    if (!(seconds >= 0.0))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument seconds: expected a number of at least 0, found %g", seconds);
    const double until = gn_now() + seconds;
    bool more = true;
    while (more) {
        gneiss_status status =
            gn_run_advance(&world->run, until - gn_now(), &world->hooks.due, &found);
        if (status != GNEISS_OK) return settle(world, status, &found, error);
        more = world->hooks.due && !world->run.finished;
        GN_TRY(gn_api_hooks_call(world, error));
    }
    return GNEISS_OK;
}

gneiss_status gneiss_world_finish(gneiss_world *world, gneiss_error *error) {
    gneiss_error found = {0};
    GN_TRY(require_free(world, error));
    if (world->run.directory[0]) {
        gneiss_status status = gn_run_finish(&world->run, &found);
        if (status == GNEISS_ERROR_UNSTABLE) return settle(world, status, &found, error);
        if (status != GNEISS_OK) return gn_fail(error, status, "%s", found.message);
    }
    return gn_run_check_final_ledger(&world->run, error);
}

gneiss_status gneiss_world_run(gneiss_world *world, gneiss_error *error) {
    GN_TRY(gneiss_world_advance(world, INFINITY, error));
    return gneiss_world_finish(world, error);
}

/* --- saving and resuming --- */

gneiss_status gneiss_world_save(const gneiss_world *world, const char *path, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    GN_TRY(require_path(path, "path", error));
    return gn_checkpoint_write(&world->run, path, error);
}

gneiss_status gneiss_world_checkpoint(gneiss_world *world, gneiss_error *error) {
    GN_TRY(gn_api_require_good(world, error));
    if (!world->run.directory[0])
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "expected a world with an output folder, found one without "
                       "(gneiss_world_save writes to any file)");
    return gn_run_checkpoint(&world->run, error);
}

typedef gneiss_status going_on(const char *path, const gn_override *overrides, size_t count,
                               gn_run *run, gneiss_error *error);

static gneiss_status go_on(going_on *how, const char *path, const char *what,
                           const char *const *overrides, size_t override_count,
                           gneiss_world **world, gneiss_error *error) {
    override_list list;
    gneiss_world *made;
    GN_TRY(gn_api_require(world, "world", error));
    *world = NULL;
    GN_TRY(require_path(path, what, error));
    GN_TRY(make_overrides(overrides, override_count, &list, error));
    gneiss_status status = new_world(&made, error);
    if (status == GNEISS_OK) status = how(path, list.items, list.count, &made->run, error);
    free_overrides(&list);
    return hand_over(status, made, world);
}

gneiss_status gneiss_world_load(const char *path, const char *const *overrides,
                                size_t override_count, gneiss_world **world, gneiss_error *error) {
    return go_on(gn_run_load, path, "path", overrides, override_count, world, error);
}

gneiss_status gneiss_world_resume(const char *folder, const char *const *overrides,
                                  size_t override_count, gneiss_world **world,
                                  gneiss_error *error) {
    return go_on(gn_run_resume, folder, "folder", overrides, override_count, world, error);
}

const char *gneiss_world_note(const gneiss_world *world) {
    return world ? world->run.note : "";
}

/* --- state --- */

gneiss_status gneiss_world_progress(const gneiss_world *world, gneiss_progress *progress,
                                    gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(progress, "progress", error));
    gn_progress p = gn_run_progress(&world->run);
    *progress = (gneiss_progress){
        .step = p.step,
        .time = p.time,
        .end = p.end,
        .dt = world->run.world.ctx.dt,
        .wall_seconds = p.seconds,
        .eta = p.eta,
        .unbalanced = p.unbalanced,
        .energy_residual = p.residual,
        .stress = p.stress,
        .strain = p.strain,
        .finished = p.finished,
        .stop_reason = world->run.stop_reason,
        .stage = (int32_t)p.stage_index,
        .stages = (int32_t)p.stages,
        .stage_name = p.stage ? p.stage : "",
    };
    return GNEISS_OK;
}

gneiss_status gneiss_world_limits(const gneiss_world *world, gneiss_limits *limits,
                                  gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(limits, "limits", error));
    const gn_world *w = &world->run.world;
    *limits = (gneiss_limits){
        w->ctx.dt, w->ctx.stable, gn_timestep_sharp_limit(&w->ctx, &w->solids),
        gn_timestep_bound(&w->ctx, &w->dem, &w->solids, &w->zones),
        w->ctx.scene.has_specimen ? w->ctx.choice.limit.literature : (double)INFINITY};
    return GNEISS_OK;
}

gneiss_status gneiss_world_counts(const gneiss_world *world, gneiss_counts *counts,
                                  gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(counts, "counts", error));
    const gn_world *w = &world->run.world;
    *counts = (gneiss_counts){
        .particles = (int64_t)w->dem.particles.soa.count,
        .bonds = (int64_t)w->dem.bonds.contacts.soa.count,
        .pairs = (int64_t)w->dem.pairs.contacts.soa.count,
        .wall_contacts = (int64_t)w->boundary.contacts.soa.count,
        .walls = (int64_t)w->ctx.scene.wall_count,
        .sets = (int64_t)w->ctx.scene.set_count,
        .broken_tension = w->dem.broken_tension,
        .broken_shear = w->dem.broken_shear,
        .removed = w->dem.lost,
        .list_rebuilds = w->dem.verlet.rebuilds,
        .history_rows = (int64_t)world->run.history.row_count,
    };
    return GNEISS_OK;
}

gneiss_status gneiss_world_element_counts(const gneiss_world *world, gneiss_element_counts *counts,
                                          gneiss_error *error) {
    GN_TRY(gn_api_require(world, "world", error));
    GN_TRY(gn_api_require(counts, "counts", error));
    const gn_world *w = &world->run.world;
    const gn_element_totals t = gn_elements_totals(&w->solids);
    *counts = (gneiss_element_counts){(int64_t)t.nodes, (int64_t)t.elements,
                                      (int64_t)gn_dormant_count(&w->dem)};
    return GNEISS_OK;
}

int64_t gneiss_world_steps(const gneiss_world *world) {
    return world ? world->run.world.ctx.step : 0;
}

double gneiss_world_time(const gneiss_world *world) {
    return world ? world->run.world.ctx.time : 0.0;
}

uint64_t gneiss_world_hash(const gneiss_world *world) {
    return world ? gn_world_hash(&world->run.world.ctx, &world->run.world.dem,
                                 &world->run.world.boundary, &world->run.world.solids,
                                 &world->run.world.box)
                 : 0;
}
