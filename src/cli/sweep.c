#include "cli/sweep.h"

#include "base/new.h"
#include "base/timer.h"
#include "cli/plan.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "cli/sweep_show.h"
#include "io/io.h"
#include "pack/shape.h"
#include "run/folder.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char nothing_begun[] = "gneiss: interrupted: no run had begun\n";

/* ---- options ---- */

/* --threads and --set run.threads= apply to the whole sweep; the other overrides are passed to the
 * scene. */
static gneiss_status take_threads(const gn_options *options, gn_override *kept, size_t *count,
                                  int *threads, gneiss_error *error) {
    *count = 0;
    *threads = 0;
    for (size_t k = 0; k < options->override_count; k++) {
        const gn_override *given = &options->overrides[k];
        if (strcmp(given->key, "run.threads") != 0) {
            kept[(*count)++] = *given;
            continue;
        }
        char *rest;
        long value = strtol(given->value, &rest, 10);
        bool word = strcmp(given->value, "auto") == 0;
        if (!word && (!*given->value || *rest || value < 0 || value > 1024))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--threads: expected a whole number in [0, 1024], found '%s'",
                           given->value);
        *threads = word ? 0 : (int)value;
    }
    return GNEISS_OK;
}

static bool read_number(const char *text, long least, long *value) {
    char *rest;
    errno = 0;
    *value = text && *text ? strtol(text, &rest, 10) : -1;
    return text && *text && !*rest && !errno && *value >= least;
}

/* Reads the number of this part from Slurm's variables of a job array, which may be numbered in
 * steps. */
static gneiss_status shard_of_slurm(gn_sweep_way *way, gneiss_error *error) {
    long id, first = 0, step = 1, count;
    const char *lowest = getenv("SLURM_ARRAY_TASK_MIN"), *every = getenv("SLURM_ARRAY_TASK_STEP");
    bool known = read_number(getenv("SLURM_ARRAY_TASK_ID"), 0, &id) &&
                 read_number(getenv("SLURM_ARRAY_TASK_COUNT"), 1, &count) &&
                 (!lowest || read_number(lowest, 0, &first)) &&
                 (!every || read_number(every, 1, &step));
    long place = known ? (id - first) / step : -1;
    if (!known || place < 0 || place >= count)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "--array: expected I/N, or SLURM_ARRAY_TASK_ID and SLURM_ARRAY_TASK_COUNT in "
            "the environment");
    way->shard = (size_t)place;
    way->shards = (size_t)count;
    return GNEISS_OK;
}

/* Reads "2/8": the second of eight. */
static gneiss_status read_shard(const gn_options *options, gn_sweep_way *way, gneiss_error *error) {
    if (!options->array) return GNEISS_OK;
    if (!*options->array) return shard_of_slurm(way, error);
    char first[16] = "";
    long place, count;
    size_t length = strcspn(options->array, "/");
    if (length < sizeof first) memcpy(first, options->array, length);
    if (!options->array[length] || !read_number(first, 1, &place) ||
        !read_number(options->array + length + 1, 1, &count) || place > count)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "--array: expected I/N such as 2/8, with I from 1 to N, found '%s'",
                       options->array);
    way->shard = (size_t)(place - 1);
    way->shards = (size_t)count;
    return GNEISS_OK;
}

static gneiss_status read_way(const gn_options *options, gn_sweep_way *way, gneiss_error *error) {
    long jobs = 0;
    if (options->jobs && !(read_number(options->jobs, 1, &jobs) && jobs <= 1024))
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "--jobs: expected a whole number in [1, 1024], found '%s'", options->jobs);
    way->jobs = (int)jobs;
    way->program = "/proc/self/exe";
    way->force = options->force;
    way->allow_gmsh = options->allow_gmsh;
    return read_shard(options, way, error);
}

static gneiss_status choose_folder(const gn_options *options, const gn_sweep *sweep,
                                   char folder[GN_PATH_SIZE], gneiss_error *error) {
    const char *suffix = sweep->text ? "" : sweep->parameter_count ? "-confinements" : "-seeds";
    const char *slash = strrchr(sweep->source, '/'), *name = slash ? slash + 1 : sweep->source,
               *dot = strrchr(name, '.'), *wanted = options->out ? options->out : sweep->directory;
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    int used = *wanted ? snprintf(folder, GN_PATH_SIZE, "%s", wanted)
                       : snprintf(folder, GN_PATH_SIZE, "runs/%.*s%s", length, name, suffix);
    if (used >= 0 && used < GN_PATH_SIZE - 128) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.200s...: expected an output folder of less than %d characters", folder,
                   GN_PATH_SIZE - 128);
}

/* ---- --dry-run ---- */

/* Returns the wall time of a run on one thread from a few of its steps; NaN if the specimen must be
 * packed first. */
static gneiss_status estimate(const gn_sweep *sweep, size_t run, bool allow_gmsh, double *seconds,
                              gneiss_error *error) {
    GN_FREED gn_scene *scene = NULL;
    GN_FREED_BY(gn_world_delete) gn_world *world = NULL;
    *seconds = NAN;
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(gn_new(&world, 1, "a model", error));
    GN_TRY(gn_sweep_scene(sweep, run, scene, error));
    scene->allow_gmsh = allow_gmsh;
    if (scene->specimen.pack.shape != GN_SHAPE_NONE) {
        gn_scene_free(scene);
        return GNEISS_OK;
    }
    double start = gn_now();
    scene->threads = 1;
    GN_TRY(gn_world_create(scene, world, error));
    double made = gn_now() - start;
    GN_TRY(gn_plan_seconds(world, seconds, error));
    *seconds += made;
    return GNEISS_OK;
}

/* Returns a stride that visits all of `count` items, with long intervals between neighbours. */
static size_t stride_through(size_t count) {
    size_t stride = (size_t)(0.618 * (double)count) + 1;
    for (;; stride++) {
        size_t a = stride, b = count;
        while (b) {
            size_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1) return stride;
    }
}

/* Estimates as many runs as fit into a second, distributed over all of them; others take the mean.
 * A scene that cannot be made fails when it is run. */
static void estimate_some(const gn_sweep *sweep, const gn_summary *summary, const gn_sweep_way *way,
                          double *seconds) {
    const double budget = 1.0; /* s */
    double start = gn_now();
    size_t stride = stride_through(sweep->run_count);
    for (size_t n = 0; n < sweep->run_count; n++) {
        gneiss_error unused = {0};
        size_t k = n * stride % sweep->run_count;
        seconds[k] = summary->runs[k].seconds;
        bool wanted =
            gn_sweep_run_in_shard(sweep, way, k) && !gn_outcome_is_final(&summary->runs[k].outcome);
        if (!wanted || gn_now() - start > budget) continue;
        if (estimate(sweep, k, way->allow_gmsh, &seconds[k], &unused) != GNEISS_OK)
            seconds[k] = NAN;
    }
}

static gneiss_status dry_run(const gn_sweep *sweep, const gn_sweep_way *way, gneiss_error *error) {
    GN_FREED_BY(gn_summary_free) gn_summary m = {0};
    GN_FREED double *seconds = NULL;
    GN_TRY(gn_summary_make(sweep, way->directory, &m, error));
    GN_TRY(gn_new(&seconds, sweep->run_count, "estimates", error));
    estimate_some(sweep, &m, way, seconds);
    gn_sweep_print_plan(sweep, &m, way, seconds);
    return GNEISS_OK;
}

/* ---- the command ---- */

static gneiss_status summarise(const gn_options *options, const gn_sweep *sweep,
                               const gn_sweep_way *way, gneiss_error *error) {
    gn_summary m;
    GN_TRY(gn_summary_make(sweep, way->directory, &m, error));
    gneiss_status status = gn_summary_write(&m, error);
    if (status == GNEISS_OK) {
        gn_sweep_print_summary(options, &m);
        if (m.done == 0 && m.failed > 0)
            status = gn_fail(error, GNEISS_ERROR_UNSTABLE, "none of %zu runs was completed",
                             sweep->run_count);
    }
    gn_summary_free(&m);
    return status;
}

/* Carries out a sweep whose folder is locked. An interrupted sweep writes a summary as well; a part
 * of a sweep leaves the summary to the call that collects the parts. */
static gneiss_status carry_out(const gn_options *options, const gn_sweep *sweep, gn_sweep_way *way,
                               gneiss_error *error) {
    gn_sweep_display display;
    gneiss_status status = GNEISS_OK;
    if (!options->force) GN_TRY(gn_summary_check_folder(way->directory, error));
    if (!options->collect) {
        way->interrupted = gn_signals_set_flag();
        gn_sweep_display_begin(&display, options, sweep, way);
        status = gn_sweep_work(sweep, way, error);
        gn_sweep_display_end(&display);
    }
    if (status != GNEISS_OK && status != GNEISS_INTERRUPTED) return status;
    gneiss_error second = {0};
    gneiss_status summary = way->shards ? GNEISS_OK : summarise(options, sweep, way, &second);
    if (status == GNEISS_OK && summary != GNEISS_OK)
        return gn_fail(error, summary, "%s", second.message);
    return status;
}

/* Refuses a geometry without permission to mesh once, not in every run. */
static gneiss_status check_geometry(const gn_options *options, const gn_sweep *sweep,
                                    gneiss_error *error) {
    GN_FREED_BY(gn_scene_delete) gn_scene *scene = NULL;
    GN_TRY(gn_new(&scene, 1, "a scene", error));
    GN_TRY(gn_sweep_scene(sweep, 0, scene, error));
    scene->allow_gmsh = options->allow_gmsh;
    return gn_pack_check_geometry(scene, error);
}

static gneiss_status sweep_into(const gn_options *options, const gn_sweep *sweep, gn_sweep_way way,
                                gneiss_error *error) {
    char folder[GN_PATH_SIZE];
    int lock = 0;
    GN_TRY(choose_folder(options, sweep, folder, error));
    way.directory = folder;
    if (!options->collect && sweep->run_count) GN_TRY(check_geometry(options, sweep, error));
    if (options->dry_run) return dry_run(sweep, &way, error);
    if (sweep->seed_count > 1 && !sweep->draws)
        fprintf(stderr, "gneiss: warning: seeds: this scene draws no random numbers, so that all "
                        "seeds give the same\n");
    bool there = access(folder, F_OK) == 0;
    if (!options->collect) GN_TRY(gn_make_directory(folder, error));
    GN_TRY(way.shards ? gn_folder_share(folder, &lock, error)
                      : gn_folder_lock(folder, &lock, error));
    gneiss_status status = carry_out(options, sweep, &way, error);
    if (status != GNEISS_OK && !there) (void)rmdir(folder); /* removes the folder if it is empty */
    if (lock > 0) close(lock);
    return status;
}

/* Carries out a sweep. `alone`: the file is a single scene; *wanted: the scene needs several runs.
 */
static gneiss_status command(const gn_options *options, bool alone, bool *wanted,
                             gneiss_error *error) {
    gn_override overrides[GN_MAX_OVERRIDES];
    size_t count;
    gn_sweep_way way = {0};
    *wanted = !alone;
    gn_sweep *sweep = calloc(1, sizeof *sweep);
    if (!sweep) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    gneiss_status status = take_threads(options, overrides, &count, &way.threads, error);
    if (status == GNEISS_OK) status = read_way(options, &way, error);
    gn_signals_end_at_once(nothing_begun, NULL);
    if (status == GNEISS_OK)
        status =
            alone ? gn_sweep_of_scene(options->target, overrides, count, options->seeds, sweep,
                                      wanted, error)
                  : gn_sweep_load(options->target, overrides, count, options->seeds, sweep, error);
    /* An error in a scene that is run once is reported by that run. */
    bool reported = status == GNEISS_ERROR_MEMORY || !alone || options->seeds || *wanted;
    if (status != GNEISS_OK && !reported) status = GNEISS_OK;
    if (status == GNEISS_OK && *wanted) {
        gn_print_notes(&sweep->notes);
        status = sweep_into(options, sweep, way, error);
        gn_sweep_free(sweep);
    }
    free(sweep);
    return status;
}

gneiss_status gn_command_sweep(const gn_options *options, gneiss_error *error) {
    bool wanted;
    return command(options, false, &wanted, error);
}

gneiss_status gn_command_several(const gn_options *options, bool *wanted, gneiss_error *error) {
    return command(options, true, wanted, error);
}
