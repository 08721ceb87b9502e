/* The `gneiss` program. */
#include "base/new.h"
#include "base/printable.h"
#include "base/threads.h"
#include "base/timer.h"
#include "base/version.h"
#include "cli/commit.h"
#include "cli/explain.h"
#include "cli/generate.h"
#include "cli/help.h"
#include "cli/log.h"
#include "cli/options.h"
#include "cli/pack.h"
#include "cli/plan.h"
#include "cli/plan_accuracy.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "cli/schema.h"
#include "cli/script.h"
#include "cli/signals.h"
#include "cli/status.h"
#include "cli/stiffness.h"
#include "cli/sweep.h"
#include "conversion/conversion.h"
#include "io/io.h"
#include "ranks/program.h"
#include "run/folder.h"
#include "run/status.h"
#include "scene/tree.h"
#include "sweep/sweep.h"
#include "timestep/timestep.h"
#include "world/scale.h"

#include <malloc.h>
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- files and folders that are given to the wrong command ---- */

enum { SIZE_MOST = 16 << 20 };

typedef enum kind { OTHER, SCENE, SWEEP, PACKING, TARGETS } kind;

static bool has_any(const gn_node *root, const char *const *keys) {
    for (; *keys; keys++)
        if (gn_node_child(root, *keys)) return true;
    return false;
}

/* Returns the kind of a file, which follows from top-level keys that no other kind has. */
static kind kind_of_root(const gn_node *root) {
    static const char *const sweep[] = {"parameters", "seeds", "sampling", "combine", NULL},
                             *const scene[] = {"materials", "law",  "time",   "elements", "walls",
                                               "bodies",    "test", "stages", NULL};
    if (!root || root->kind != GN_NODE_MAP) return OTHER;
    if (gn_node_child(root, "targets")) return TARGETS;
    const bool swept = gn_node_child(root, "scene") || has_any(root, sweep);
    if (has_any(root, scene)) return swept ? OTHER : SCENE;
    if (gn_node_child(root, "specimen")) return swept ? OTHER : PACKING;
    return swept ? SWEEP : OTHER;
}

static kind kind_of_file(const char *path) {
    char *text = NULL;
    gneiss_error unsaid = {0};
    gn_tree *tree = NULL;
    kind found = OTHER;
    if (gn_read_text_file(path, SIZE_MOST, &text, &unsaid) != GNEISS_OK) return OTHER;
    if (gn_tree_read(text, strlen(text), path, &tree, &unsaid) == GNEISS_OK) {
        found = kind_of_root(gn_tree_root(tree));
        gn_tree_free(tree);
    }
    free(text);
    return found;
}

static bool is_one_of(const char *name, const char *const *list) {
    for (; *list; list++)
        if (strcmp(name, *list) == 0) return true;
    return false;
}

static const char *const takes_scene[] = {"run", "check", "plan", "stiffness", NULL},
                         *const takes_folder[] = {"resume", "report", "view", "status", NULL},
                         *const takes_file[] = {"run",  "check", "plan",      "stiffness",
                                                "pack", "sweep", "calibrate", NULL};

/* Returns what was found instead of a file for this command; NULL: the command accepts such a file,
 * and the error has another cause. */
static const char *found_text(const gn_options *options, kind found) {
    const bool sweep = strcmp(options->command, "sweep") == 0,
               calibrate = strcmp(options->command, "calibrate") == 0;
    if (found == TARGETS && !calibrate) return "wanted readings of a material: gneiss calibrate";
    if (found == SWEEP && !sweep)
        return "a sweep file, which names a scene and values of its keys: gneiss sweep";
    if (found == SCENE && (sweep || calibrate || is_one_of(options->command, takes_folder)))
        return "a scene: gneiss run";
    if (found == PACKING && strcmp(options->command, "pack") != 0)
        return "a specimen alone, without materials and time: gneiss pack";
    return NULL;
}

static const char *expected_text(const gn_options *options) {
    return is_one_of(options->command, takes_scene)     ? "a scene"
           : is_one_of(options->command, takes_folder)  ? "a folder of results"
           : strcmp(options->command, "sweep") == 0     ? "a sweep file"
           : strcmp(options->command, "calibrate") == 0 ? "a file of targets"
                                                        : "a scene or a specimen";
}

/* After an input error: if the file or folder belongs to another command, replaces the message by
 * one that names that command. */
static void name_wrong_file(const gn_options *options, gneiss_error *error) {
    struct stat status;
    if (!options->command || !options->target || stat(options->target, &status) != 0) return;
    if (S_ISDIR(status.st_mode) && is_one_of(options->command, takes_file)) {
        gn_fail(error, GNEISS_ERROR_INPUT,
                "%.1000s: expected a %s file, found a folder: gneiss resume continues a run, "
                "gneiss report shows it",
                options->target,
                strcmp(options->command, "sweep") == 0       ? "sweep"
                : strcmp(options->command, "calibrate") == 0 ? "targets"
                                                             : "scene");
        return;
    }
    if (!S_ISREG(status.st_mode)) return;
    const char *found = found_text(options, kind_of_file(options->target));
    if (!found && is_one_of(options->command, takes_folder))
        gn_fail(error, GNEISS_ERROR_INPUT, "%.1000s: expected %s, found a file", options->target,
                expected_text(options));
    if (found)
        gn_fail(error, GNEISS_ERROR_INPUT, "%.1000s: expected %s, found %s %.1000s",
                options->target, expected_text(options), found, options->target);
}

/* Names an override in a message by the option that gave it. */
static void name_option(const gn_options *options, gneiss_error *error) {
    char place[64], text[GNEISS_MESSAGE_SIZE];
    for (size_t k = 0; k < options->override_count; k++) {
        if (!options->option[k]) continue;
        snprintf(place, sizeof place, "--set %s:", options->overrides[k].key);
        for (char *at = error->message; (at = strstr(at, place)); at++) {
            snprintf(text, sizeof text, "%.*s%s:%s", (int)(at - error->message), error->message,
                     options->option[k], at + strlen(place));
            memcpy(error->message, text, sizeof text);
        }
    }
}

enum { LONG_RUN = 60 }; /* s of computing; results that took longer are replaced only on request */

static const char nothing_lost[] =
    "gneiss: interrupted: before the first step; there is nothing to save\n";

static gneiss_status finish(const gn_options *options, gn_run *run, gneiss_error *error) {
    gneiss_status status = gn_run_finish(run, error);
    if (status != GNEISS_OK) return status;
    GN_TRY(gn_print_summary(options, run, error));
    GN_TRY(gn_print_warnings(run, error));
    if (options->json && gn_rank_writes()) {
        char path[GN_PATH_SIZE + 32], *text = NULL;
        snprintf(path, sizeof path, "%s/summary.json", run->directory);
        GN_TRY(gn_read_text_file(path, 1 << 20, &text, error));
        gn_print_object("result", text);
    }
    return gn_run_check_final_ledger(run, error);
}

/* Stores the failed state for inspection; the message of the first error is kept. */
static gneiss_status fail(gn_run *run, gneiss_error *error) {
    gneiss_error second = {0};
    gneiss_status status = error->status;
    if (gn_run_write_failure(run, error->message, &second) == GNEISS_OK) {
        char first[GNEISS_MESSAGE_SIZE];
        memcpy(first, error->message, sizeof first);
        gn_fail(error, status, "%.1500s\n  the state is in %.300s (failed_*.hdf, results.h5)",
                first, run->directory);
    }
    return status;
}

/* *shown: a progress line is on the terminal, and the cursor is at its end. */
static gneiss_status advance(const gn_options *options, gn_run *run, bool *shown,
                             gneiss_error *error) {
    char light[GNEISS_MESSAGE_SIZE];
    if (run->note[0]) fprintf(stderr, "gneiss: warning: %s\n", run->note);
    if (*gn_timestep_light_body(&run->world.ctx, &run->world.dem, &run->world.boundary, light,
                                sizeof light))
        fprintf(stderr, "gneiss: warning: %s\n", light);
    if (run->world.ctx.step == 0 &&
        gn_scale_doubts(&run->world.ctx, &run->world.dem, &run->world.boundary, &run->world.solids,
                        light, sizeof light))
        fprintf(stderr, "gneiss: warning: %s\n", light);
    if (gn_stage_is_overlong(&run->world, light, sizeof light))
        fprintf(stderr, "gneiss: warning: %s\n", light);
    if (*gn_elements_doubts(&run->world.ctx, &run->world.dem, &run->world.boundary,
                            &run->world.solids, light, sizeof light))
        fprintf(stderr, "gneiss: warning: %s\n", light);
    for (size_t k = 0; run->world.ctx.step == 0 && k < run->world.solids.count; k++)
        if (gn_mesh_changed(&run->world.solids.elements[k]->solid.mesh, light, sizeof light))
            fprintf(stderr, "gneiss: note: elements.mesh: %s\n", light);
    if (*gn_conversion_watches(&run->world.ctx, &run->world.solids, light, sizeof light))
        fprintf(stderr, "gneiss: warning: %s\n", light);
    GN_TRY(gn_print_start(options, run, error));
    GN_TRY(gn_print_initial_state(options, run, error));
    GN_TRY(gn_predict_end(options, run, error));
    const volatile sig_atomic_t *interrupted = gn_signals_set_flag();
    double written = gn_now();
    if (!run->finished) gn_status_write(run, GNEISS_OK, "");
    while (!run->finished) {
        double pause = isatty(STDERR_FILENO) || options->json ? 0.5 : 5.0;
        gneiss_status status = gn_run_advance(run, pause, interrupted, error);
        if (status == GNEISS_ERROR_UNSTABLE) return fail(run, error);
        GN_TRY(status);
        gn_print_progress(options, run);
        *shown = !run->finished;
        if (!run->finished && gn_now() - written >= GN_STATUS_EVERY) {
            gn_status_write(run, GNEISS_OK, "");
            written = gn_now();
        }
        if (!run->interrupted || run->finished) continue;
        snprintf(run->stop_reason, sizeof run->stop_reason, "interrupted");
        status = gn_run_checkpoint(run, error);
        if (status == GNEISS_ERROR_UNSTABLE) return fail(run, error);
        GN_TRY(status);
        return gn_fail(error, GNEISS_INTERRUPTED, "at step %lld; continue with: gneiss resume %s",
                       (long long)run->world.ctx.step, run->directory);
    }
    gneiss_status status = finish(options, run, error);
    return status == GNEISS_ERROR_UNSTABLE ? fail(run, error) : status;
}

static gneiss_status go(const gn_options *options, gn_run *run, gneiss_error *error) {
    bool shown = false;
    const bool over = run->finished; /* a finished run is not changed */
    gneiss_status status = advance(options, run, &shown, error);
    if (status != GNEISS_OK && shown) gn_end_progress_line(options);
    if (!over) gn_status_write(run, status, error->message);
    return status;
}

/* Reads the scene, which is on the heap because it is too large for a small stack. */
static gneiss_status load_scene(const gn_options *options, gn_scene **scene, gneiss_error *error) {
    GN_TRY(gn_new(scene, 1, "a scene", error));
    GN_TRY(
        gn_scene_load(options->target, options->overrides, options->override_count, *scene, error));
    (*scene)->allow_gmsh = options->allow_gmsh;
    gn_print_notes(&(*scene)->notes);
    return GNEISS_OK;
}

/* Refuses to replace results of hours of computing, or a folder with other files. This is checked
 * before anything is computed. */
static gneiss_status check_replacing(const gn_options *options, const gn_scene *scene,
                                     gneiss_error *error) {
    char folder[GN_PATH_SIZE], text[32];
    GN_TRY(gn_folder_choose(scene, options->out, folder, error));
    double seconds = 0.0;
    if (options->force || !gn_rank_writes()) return GNEISS_OK;
    GN_TRY(gn_folder_check(folder, error));
    GN_TRY(gn_folder_finished(folder, &seconds, error));
    if (!(seconds > LONG_RUN)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.300s: expected no results or those of a short run, found those of a finished "
                   "run that took %s: --force replaces them, --out chooses another folder",
                   folder, gn_format_seconds(seconds, text, sizeof text));
}

static gneiss_status start(const gn_options *options, gn_scene *scene, gn_run *run,
                           gneiss_error *error) {
    gneiss_status status = check_replacing(options, scene, error);
    if (status == GNEISS_OK) status = gn_pack_ahead(options, scene, error);
    if (status != GNEISS_OK) {
        gn_scene_free(scene);
        return status;
    }
    GN_TRY(gn_run_start(scene, options->out, options->force, run, error));
    run->cpu_start =
        0.0; /* the process has done nothing else, so that the packing made before counts too */
    return GNEISS_OK;
}

static gneiss_status command_run(const gn_options *options, gneiss_error *error) {
    GN_FREED gn_scene *scene = NULL;
    GN_FREED gn_run *run = NULL;
    GN_TRY(gn_new(&run, 1, "a run", error));
    gn_signals_end_at_once(nothing_lost, NULL);
    GN_TRY(load_scene(options, &scene, error));
    GN_TRY(start(options, scene, run, error));
    gneiss_status status = go(options, run, error);
    gn_run_free(run);
    return status;
}

static gneiss_status command_resume(const gn_options *options, gneiss_error *error) {
    char shown[GN_PATH_SIZE];
    GN_FREED gn_run *run = NULL;
    GN_TRY(gn_new(&run, 1, "a run", error));
    gn_signals_end_at_once(nothing_lost, NULL);
    GN_TRY(gn_run_resume(options->target, options->overrides, options->override_count, run, error));
    run->world.ctx.given.allow_gmsh = run->world.ctx.scene.allow_gmsh = options->allow_gmsh;
    const int64_t before = run->world.ctx.step;
    gneiss_status status = go(options, run, error);
    if (status == GNEISS_OK && run->world.ctx.step == before)
        fprintf(stderr, "gneiss: %s: finished before (%s): no step was taken%s\n",
                gn_printable(options->target, shown, sizeof shown), run->stop_reason,
                !options->override_count ? ""
                : run->world.outcome.halt[0]
                    ? "; the model itself ended it, which no setting changes"
                    : "; a later time.end or removing the stop condition continues it");
    gn_run_free(run);
    return status;
}

/* Tells whether several ranks share one run. */
static bool shares_run(void) {
    return gn_transport_now() && gn_transport_now()->count > 1;
}

/* Several confinements in a scene give several scenes; an error in one of them is reported as `run`
 * reports it. */
static gneiss_status check_confinements(const gn_options *options, bool *several,
                                        gneiss_error *error) {
    GN_FREED gn_sweep *sweep = NULL;
    GN_TRY(gn_new(&sweep, 1, "a sweep", error));
    GN_TRY(gn_sweep_of_scene(options->target, options->overrides, options->override_count, NULL,
                             sweep, several, error));
    if (*several) gn_sweep_free(sweep);
    return GNEISS_OK;
}

/* Prints the result of `plan` and `check` as JSON. */
static void print_model(const gn_world *world, int warnings) {
    const gn_scene *scene = &world->ctx.scene;
    gn_json *json = gn_json_begin();
    gn_json_integer(json, "warnings", warnings);
    gn_json_integer(json, "dimension", scene->dimension);
    GN_JSON_NUMBERS(json, {"particles", (double)world->dem.particles.soa.count},
                    {"bonds", (double)world->dem.bonds_at_start},
                    {"walls", (double)scene->wall_count}, {"bodies", (double)scene->body_count},
                    {"solids", (double)world->solids.count}, {"dt", world->ctx.dt},
                    {"stability_limit", world->ctx.stable}, {"end", scene->end},
                    {"steps", ceil(scene->end / world->ctx.dt)});
    gn_print_object("result", gn_json_finish(json, false));
}

/* Carries out `plan` and `check`, which build the world and write nothing but a planned scene.
 * `packings`: see gn_plan_accuracy. */
static gneiss_status look(const gn_options *options, bool plan, int *packings,
                          gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_FREED_BY(gn_world_delete) gn_world *world = NULL;
    int warnings = 0;
    bool several = false;
    char shown[GN_PATH_SIZE];
    GN_TRY(gn_new(&world, 1, "a model", error));
    gn_signals_end_at_once(nothing_lost, NULL);
    GN_TRY(load_scene(options, &scene, error));
    GN_TRY(check_confinements(options, &several, error));
    GN_TRY(gn_pack_ahead(options, scene, error));
    double before = gn_process_time();
    GN_TRY(gn_world_create(scene, world, error));
    double setup = gn_process_time() - before;
    if (options->error > 0.0) return gn_plan_accuracy(options, world, setup, packings, error);
    if (!plan) GN_TRY(gn_print_check(world, &warnings, error));
    GN_TRY(gn_print_plan(world, error));
    if (!plan)
        printf("%s: %s\n", gn_printable(options->target, shown, sizeof shown),
               warnings ? "can run; see the warnings above" : "can run");
    if (options->log) print_model(world, warnings);
    return GNEISS_OK;
}

static gneiss_status command_run_once_or_more(const gn_options *options, gneiss_error *error) {
    bool several = false;
    if (shares_run()) {
        GN_TRY(check_confinements(options, &several, error));
        return several ? gn_fail(error, GNEISS_ERROR_INPUT,
                                 "%.1000s: expected one run for several ranks of MPI, found "
                                 "several confinements",
                                 options->target)
                       : command_run(options, error);
    }
    GN_TRY(gn_command_several(options, &several, error));
    if (several) return GNEISS_OK;
    if (options->jobs || options->dry_run)
        return gn_fail(error, GNEISS_ERROR_INPUT, GN_ONLY_SEVERAL, "run",
                       options->jobs ? "--jobs" : "--dry-run");
    return command_run(options, error);
}

/* --- run --error --- */

/* Makes the path of the planned scene, <folder>.yaml beside the folder of the results. *reading:
 * the reading of the plan. */
static gneiss_status planned_paths(const gn_options *options, char folder[GN_PATH_SIZE],
                                   char file[GN_PATH_SIZE], const char **reading,
                                   gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    char own[GN_PATH_SIZE];
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(
        gn_scene_load(options->target, options->overrides, options->override_count, scene, error));
    *reading = gn_planned_reading(options, scene);
    GN_TRY(gn_folder_choose(scene, options->out, own, error));
    size_t length = strlen(own);
    while (length > 1 && own[length - 1] == '/') own[--length] = '\0';
    const char *ending = options->out ? "" : "-planned";
    if (snprintf(folder, GN_PATH_SIZE, "%s%s", own, ending) >= GN_PATH_SIZE ||
        snprintf(file, GN_PATH_SIZE, "%s%s.yaml", own, ending) >= GN_PATH_SIZE)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%.300s: expected a shorter path", own);
    return GNEISS_OK;
}

static gneiss_status check_planned_options(const gn_options *options, gneiss_error *error) {
    const char *refused = options->write     ? "--write: the scene is written beside the results"
                          : options->seeds   ? "--seeds: the plan chooses the number of packings"
                          : options->dry_run ? "--dry-run: gneiss plan --error prints the plan"
                                             : NULL;
    if (!refused) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT, "gneiss run --error and %s", refused);
}

/* Writes the planned scene; frees the specimen of the plan before the run. */
static gneiss_status plan_ahead(const gn_options *options, const char *file, int *packings,
                                gneiss_error *error) {
    char parent[GN_PATH_SIZE];
    gn_options plan = *options;
    plan.write = file;
    plan.force = plan.force || gn_plan_wrote(file, options->target);
    snprintf(parent, sizeof parent, "%s", file);
    char *slash = strrchr(parent, '/');
    if (slash && slash > parent) {
        *slash = '\0';
        GN_TRY(gn_make_directory(parent, error));
    }
    return look(&plan, true, packings, error);
}

/* Does the same as `gneiss plan --error --write` followed by `gneiss run` of its scene. The written
 * scene contains the overrides; the number of threads also decides how many runs are made at the
 * same time. */
static gneiss_status command_run_planned(const gn_options *options, gneiss_error *error) {
    char folder[GN_PATH_SIZE], file[GN_PATH_SIZE], seeds[16];
    int packings = 1;
    gn_options run = *options;
    GN_TRY(check_planned_options(options, error));
    GN_TRY(planned_paths(options, folder, file, &run.reading, error));
    GN_TRY(plan_ahead(options, file, &packings, error));
    run.reached = options->error;
    run.error = 0.0;
    run.target = file;
    run.out = folder;
    run.override_count = 0;
    for (size_t k = 0; k < options->override_count; k++)
        if (strcmp(options->overrides[k].key, "run.threads") == 0)
            run.overrides[run.override_count++] = options->overrides[k];
    snprintf(seeds, sizeof seeds, "%d", packings);
    if (packings > 1)
        run.seeds = seeds;
    else
        run.jobs = NULL;
    return command_run_once_or_more(&run, error);
}

/* Runs of several scenes are processes of their own. */
static gneiss_status check_ranks(const gn_options *options, gneiss_error *error) {
    const bool runs = strcmp(options->command, "run") == 0;
    if (!shares_run() || strcmp(options->command, "resume") == 0) return GNEISS_OK;
    if (runs && !options->seeds && !options->jobs && !options->dry_run && !(options->error > 0.0))
        return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "expected gneiss run of one scene or gneiss resume for several ranks of MPI, "
                   "found gneiss %s%s",
                   options->command, runs ? " with --seeds, --jobs, --dry-run or --error" : "");
}

static gneiss_status command_run_all(const gn_options *options, gneiss_error *error) {
    return options->error > 0.0 ? command_run_planned(options, error)
                                : command_run_once_or_more(options, error);
}

/* Symbols of the linker: the start of the program in memory, and the end of its machine code. */
extern const char __executable_start[], etext[];

/* Prints the version and the variants of kernels, whose numbers are those of one instruction set.
 */
static void print_info(void) {
    size_t contact = 0, motion = 0;
    const gn_kernel_set *set = gn_kernel_set_at(0);
    for (int k = 0; k < GN_CONTACT_VARIANTS; k++) contact += set->contact[k] != NULL;
    for (int k = 0; k < GN_MOTION_VARIANTS; k++) motion += set->motion[k] != NULL;
    gn_print_version(stdout);
    printf("threads           %d\n", gn_threads_of(0));
    printf("instruction sets ");
    for (int k = 0; k < GN_KERNEL_SETS; k++) {
        set = gn_kernel_set_at(k);
        printf(" %s%s", set->name, gn_kernel_set_supported(set) ? "" : " (not on this machine)");
    }
    printf("\nprecision         double mixed\n");
    printf("kernel variants   %zu contact, %zu motion, %d element, for each instruction set\n",
           contact, motion, GN_ELEMENT_VARIANTS);
    printf("code              %.1f MB, most of it kernels\n",
           (double)((uintptr_t)etext - (uintptr_t)__executable_start) * 1e-6);
    printf("finite elements   triangles in plane strain, tetrahedra; displacement, mixed\n");
}

static void print_info_object(void) {
    gn_json *json = gn_json_begin();
    gn_json_text(json, "version", gn_version());
    gn_json_text(json, "commit", gn_commit());
    gn_json_text(json, "build", gn_build());
    gn_json_integer(json, "threads", gn_threads_of(0));
    gn_json_array(json, "instruction_sets");
    for (int k = 0; k < GN_KERNEL_SETS; k++)
        if (gn_kernel_set_supported(gn_kernel_set_at(k)))
            gn_json_text(json, NULL, gn_kernel_set_at(k)->name);
    gn_json_end(json);
    gn_print_object("result", gn_json_finish(json, false));
}

static gneiss_status command_info(const gn_options *options) {
    if (options->log)
        print_info_object();
    else
        print_info();
    return GNEISS_OK;
}

static gneiss_status command_help(const gn_options *options, gneiss_error *error) {
    if (options->target && strcmp(options->target, "exit-codes") == 0) {
        gn_print_exit_codes(stdout);
        return GNEISS_OK;
    }
    const gn_command *command = options->target ? gn_command_named(options->target) : NULL;
    if (options->target && !command) return gn_no_command(options->target, error);
    (options->manual ? gn_print_manual : gn_print_help)(stdout, command);
    return GNEISS_OK;
}

/* Returns the reason why no key exists for a term of the field or of another program; NULL:
 * unknown. */
static const char *not_modelled(const char *word) {
    static const char functions[] =
        "functions between steps are those of the Python module (docs/python.md) and the C API";
    static const char *const words[][2] = {
        {"fish", functions},
        {"pyrunner", functions},
        {"callback", functions},
        {"water", "no water or other fluid is modelled: stresses are effective ones"},
        {"pore", "no water or other fluid is modelled: stresses are effective ones"},
        {"fluid", "no water or other fluid is modelled: stresses are effective ones"},
        {"temperature", "no temperature is modelled"},
        {"thermal", "no temperature is modelled"}};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strncasecmp(word, words[k][0], strlen(words[k][0])) == 0) return words[k][1];
    return NULL;
}

static gneiss_status command_keys(const gn_options *options, gneiss_error *error) {
    char nearest[256], sought[256] = "";
    if (gn_scene_print_keys(stdout, options->markdown, (const char *const *)options->words,
                            options->word_count) > 0)
        return GNEISS_OK;
    for (size_t k = 0, used = 0; k < options->word_count && used < sizeof sought; k++)
        used += (size_t)snprintf(sought + used, sizeof sought - used, "%s%s", k ? " " : "",
                                 options->words[k]);
    const char *absent = not_modelled(sought);
    if (absent)
        return gn_fail(error, GNEISS_ERROR_INPUT, "keys: no key concerns '%s': %s", sought, absent);
    bool meant =
        options->word_count == 1 && gn_scene_nearest_key(options->target, nearest, sizeof nearest);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "keys: expected %s that a key or its description contains, found '%s'%s%s%s",
                   options->word_count > 1 ? "words" : "a text", sought,
                   meant ? "; did you mean '" : "", meant ? nearest : "", meant ? "'?" : "");
}

static gneiss_status dispatch(const gn_options *options, gneiss_error *error) {
    GN_TRY(check_ranks(options, error));
    if (strcmp(options->command, "run") == 0) return command_run_all(options, error);
    if (strcmp(options->command, "sweep") == 0) return gn_command_sweep(options, error);
    if (strcmp(options->command, "pack") == 0) return gn_command_pack(options, error);
    if (strcmp(options->command, "resume") == 0) return command_resume(options, error);
    if (strcmp(options->command, "check") == 0) return look(options, false, NULL, error);
    if (strcmp(options->command, "plan") == 0) return look(options, true, NULL, error);
    if (strcmp(options->command, "stiffness") == 0) return gn_command_stiffness(options, error);
    if (strcmp(options->command, "status") == 0) return gn_command_status(options, error);
    if (strcmp(options->command, "report") == 0) return gn_command_report(options, error);
    if (strcmp(options->command, "view") == 0) return gn_command_view(options, error);
    if (strcmp(options->command, "calibrate") == 0) return gn_command_calibrate(options, error);
    if (strcmp(options->command, "convert") == 0) return gn_command_convert(options, error);
    if (strcmp(options->command, "explain") == 0) return gn_command_explain(options, error);
    if (strcmp(options->command, "completion") == 0) return gn_command_completion(options, error);
    if (strcmp(options->command, "schema") == 0) return gn_command_schema(options, error);
    if (strcmp(options->command, "info") == 0) return command_info(options);
    if (strcmp(options->command, "help") == 0) return command_help(options, error);
    if (strcmp(options->command, "version") == 0) {
        gn_print_version(stdout);
        return GNEISS_OK;
    }
    return command_keys(options, error);
}

/* Starts the program again with a short spin of waiting threads. Threads synchronise twice a step.
 * By default the OpenMP library spins for a long time while it waits, and on a shared machine the
 * spinning thread delays the one that it waits for. A short spin before blocking costs little on an
 * idle machine. The library reads this setting before main, hence the second start. If threads are
 * bound to cores, the library has already bound this thread to one core, and a second start would
 * inherit only that core. */
static void spin_briefly(char **argv) {
    static const char *const given[] = {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "OMP_PROC_BIND",
                                        "OMP_PLACES", "GOMP_CPU_AFFINITY"};
    for (size_t k = 0; k < sizeof given / sizeof *given; k++)
        if (getenv(given[k])) return;
    setenv("GOMP_SPINCOUNT", "20000", 1);
    execv("/proc/self/exe", argv); /* on failure the default remains */
}

static bool finished; /* true when main returns: no library has ended the program */

/* Corrects the exit code if a library ended the program for lack of memory: UDUNITS-2 calls
 * exit(2), which would count as an input error, and the OpenMP library exit(1). They have printed
 * the reason. */
static void report_library_exit(void) {
    if (finished) return;
    fputs("gneiss: out of memory: a library ended the program\n", stderr);
    _exit(GNEISS_ERROR_MEMORY);
}

/* Makes the allocator return large blocks to the system when they are freed. By default glibc keeps
 * blocks of up to 32 MB once some were freed, and files that are formed in memory leave unused
 * space: the same run took 118 or 268 MB. */
static void give_back_large_blocks(void) {
#ifdef __GLIBC__
    (void)mallopt(M_MMAP_THRESHOLD, 4 << 20);
#endif
}

/* Begins the log before the options are read, so that a mistake in them is reported as an object as
 * well. */
static gn_log *begin_log(int argc, char **argv) {
    const gn_command *command = NULL;
    bool wanted = false;
    for (int k = 1; k < argc; k++) {
        wanted =
            wanted || strcmp(argv[k], "--log=json") == 0 ||
            (k + 1 < argc && strcmp(argv[k], "--log") == 0 && strcmp(argv[k + 1], "json") == 0);
        if (!command) command = gn_command_named(argv[k]);
    }
    return wanted ? gn_log_begin(command ? command->name : "gneiss") : NULL;
}

/* Ends the program with a status; prints the message of an error, which was not printed before. */
static void leave(gn_log *log, gneiss_status status, gneiss_error *error) {
    /* A flush before may have failed and left nothing to write now. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == GNEISS_OK)
        status = gn_fail(error, GNEISS_ERROR_IO, "standard output cannot be written");
    if (status != GNEISS_OK && error->message[0])
        fprintf(stderr, "gneiss: %s: %s\n", gn_status_name(status), error->message);
    if (!gn_log_end(log, status) && status == GNEISS_OK) status = GNEISS_ERROR_IO;
    gn_program_end((int)status, error->message);
    finished = true;
    /* HDF5 may hold files that it could not close for lack of memory; its clean-up would fail on
     * them. */
    if (status == GNEISS_ERROR_MEMORY) _exit((int)status);
    exit((int)status);
}

int main(int argc, char **argv) {
    spin_briefly(argv);
    gn_program_begin(&argc, &argv);
    give_back_large_blocks();
    (void)atexit(report_library_exit);
    omp_set_dynamic(0); /* results do not depend on the number of threads, but the speed does:
                           OMP_DYNAMIC is ignored */
    gneiss_error error = {0};
    gn_options options;
    bool done = false;
    signal(SIGXFSZ,
           SIG_IGN); /* a write beyond the file size limit fails and does not end the program */
    gn_log *log = begin_log(argc, argv);
    gneiss_status status = gn_options_parse(argc, argv, &options, &done, &error);
    if (status == GNEISS_OK && !done) {
        status = dispatch(&options, &error);
        if (status == GNEISS_ERROR_INPUT) {
            name_option(&options, &error);
            name_wrong_file(&options, &error);
        }
    }
    gn_options_free(&options);
    leave(log, status, &error);
}
