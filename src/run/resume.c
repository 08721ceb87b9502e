/* Resume of a run: its newest checkpoint that can be read, and the keys that a resumed run takes.
 */
#include "base/error.h"
#include "io/listing.h"
#include "run/folder.h"
#include "run/run.h"
#include "run/run_private.h"
#include "scene/scene.h"
#include "world/world.h"

#include <stdlib.h>
#include <string.h>

static bool sets(const gn_override *overrides, size_t count, const char *prefix) {
    for (size_t k = 0; k < count; k++)
        if (strncmp(overrides[k].key, prefix, strlen(prefix)) == 0) return true;
    return false;
}

static bool ends_stage(const gn_override *override) {
    return strncmp(override->key, "stages", 6) == 0 && strstr(override->key, ".end");
}

static gneiss_status check_overrides(const gn_override *overrides, size_t count,
                                     gneiss_error *error) {
    static const char *const allowed[] = {"time.", "output.", "run."};
    for (size_t k = 0; k < count; k++) {
        bool known = false;
        for (size_t a = 0; a < 3; a++)
            known = known || strncmp(overrides[k].key, allowed[a], strlen(allowed[a])) == 0;
        known = known || ends_stage(&overrides[k]);
        if (!known)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--set %s: a resumed run takes time.*, output.*, run.* and "
                           "stages.<name>.end.* only",
                           overrides[k].key);
        if (strcmp(overrides[k].key, "output.directory") == 0)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--set output.directory: a resumed run stays in its folder");
        if (strcmp(overrides[k].key, "output.energy") == 0 ||
            strcmp(overrides[k].key, "output.orientation") == 0 ||
            strcmp(overrides[k].key, "output.events") == 0 ||
            strcmp(overrides[k].key, "run.precision") == 0 ||
            sets(&overrides[k], 1, "time.mass_scaling"))
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "--set %s: the key determines the data stored from the start; a resumed "
                           "run cannot change it",
                           overrides[k].key);
    }
    return GNEISS_OK;
}

enum { MOST_CHECKPOINTS = 8 };

/* An unusable checkpoint is read once more before it counts as damaged, because an error may be
 * transient. */
static gneiss_status load_one(const char *directory, int64_t step, const gn_override *overrides,
                              size_t override_count, gn_run *run, gneiss_error *error) {
    char *path = NULL;
    GN_TRY(gn_checkpoint_path(directory, step, &path, error));
    gneiss_status status = gn_checkpoint_load(path, overrides, override_count, run, error);
    if (status == GNEISS_ERROR_INPUT)
        status = gn_checkpoint_load(path, overrides, override_count, run, error);
    free(path);
    return status;
}

static void note_damage(gn_run *run, const gneiss_error *first) {
    snprintf(run->note, sizeof run->note,
             "%.1500s; it is kept under its name with .damaged appended; continuing from the "
             "checkpoint of step %lld",
             first->message, (long long)run->world.ctx.step);
}

/* Loads the newest checkpoint that is not damaged, and tells so in run->note; *damaged is the
 * number of newer ones, which are to be moved aside. A checkpoint that cannot be read now (no
 * descriptors, no memory, an error of the disk) may be intact, and no other is loaded in its place.
 */
static gneiss_status load_newest(const char *directory, const gn_override *overrides,
                                 size_t override_count, gn_run *run,
                                 int64_t steps[MOST_CHECKPOINTS], size_t *damaged,
                                 gneiss_error *error) {
    size_t count = 0;
    GN_TRY(gn_checkpoint_list(directory, steps, MOST_CHECKPOINTS, &count, error));
    if (count == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected checkpoint_<step>.h5 files, found none", directory);
    gneiss_error first = {0}, reading = {0};
    bool same = true;
    for (*damaged = 0; *damaged < count; ++*damaged) {
        gneiss_status status =
            load_one(directory, steps[*damaged], overrides, override_count, run, &reading);
        if (status == GNEISS_OK && *damaged > 0) note_damage(run, &first);
        if (status == GNEISS_OK)
            return gn_folder_check_checkpoint(directory, steps[*damaged], steps + *damaged,
                                              count - *damaged, error);
        if (status != GNEISS_ERROR_INPUT)
            return gn_fail(error, status,
                           "%.1500s\n  it may be intact, and nothing was changed: try again, or "
                           "move it away to continue from an older one",
                           reading.message);
        if (*damaged == 0) first = reading;
        same = same && strcmp(first.message, reading.message) == 0;
    }
    /* If all checkpoints fail with the same error, its cause is elsewhere, for example in an
     * override. */
    return count == 1 || same
               ? gn_fail(error, first.status, "%s", first.message)
               : gn_fail(error, first.status,
                         "%.300s: none of %zu checkpoints can be used; the newest: %.1500s",
                         directory, count, first.message);
}

/* Applies the overrides at once. */
static gneiss_status apply_overrides(gn_run *run, const gn_override *overrides, size_t count,
                                     gneiss_error *error) {
    gn_world *w = &run->world;
    if (sets(overrides, count, "time.step") || sets(overrides, count, "time.safety") ||
        sets(overrides, count, "time.contact_steps") || sets(overrides, count, "time.estimate")) {
        if (gn_world_choose_step(w, error) != GNEISS_OK)
            return error && error->status != GNEISS_ERROR_UNSTABLE ? error->status
                                                                   : GNEISS_ERROR_INPUT;
    }
    if (sets(overrides, count, "time.end") && w->ctx.scene.end < w->ctx.time - 1.5 * w->ctx.dt)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "--set time.end: expected a time after the %.6g s that the run has reached, "
                       "found %.6g s",
                       w->ctx.time, w->ctx.scene.end);
    GN_TRY(gn_check_duration(&w->ctx, error));
    /* A scene that gives another stop condition has no default for the fall from the peak; in the
     * stored scene, `auto` stands for keys that were not given. */
    if (w->ctx.scene.stop_peak_drop < 0.0 && !sets(overrides, count, "time.stop.peak_drop") &&
        (sets(overrides, count, "time.stop.strain") ||
         sets(overrides, count, "time.stop.unbalanced")))
        w->ctx.scene.stop_peak_drop = w->ctx.given.stop_peak_drop = 0.0;
    for (size_t k = 0; k < count; k++) /* the condition is evaluated again */
        if (ends_stage(&overrides[k])) w->stages.state[w->stages.now].ended = 0;
    gn_run_set_intervals(run, sets(overrides, count, "output.history_rows"),
                         sets(overrides, count, "output.snapshots"), false);
    return GNEISS_OK;
}

gneiss_status gn_run_resume(const char *directory, const gn_override *overrides,
                            size_t override_count, gn_run *run, gneiss_error *error) {
    int lock = 0;
    int64_t steps[MOST_CHECKPOINTS];
    size_t damaged = 0;
    memset(run, 0, sizeof *run);
    GN_TRY(check_overrides(overrides, override_count, error));
    if (gn_rank_writes()) GN_TRY(gn_folder_lock(directory, &lock, error));
    gneiss_status status =
        load_newest(directory, overrides, override_count, run, steps, &damaged, error);
    run->folder_lock = lock;
    if (status == GNEISS_OK) status = apply_overrides(run, overrides, override_count, error);
    if (status == GNEISS_OK) {
        snprintf(run->directory, sizeof run->directory, "%s", directory);
        gn_run_take_up(run);
    }
    for (size_t k = 0; status == GNEISS_OK && gn_rank_writes() && k < damaged; k++)
        status = gn_checkpoint_set_aside(directory, steps[k], error);
    if (status == GNEISS_OK) status = gn_output_series(run, error);
    if (status != GNEISS_OK) gn_run_free(run);
    return status;
}

gneiss_status gn_run_load(const char *path, const gn_override *overrides, size_t override_count,
                          gn_run *run, gneiss_error *error) {
    memset(run, 0, sizeof *run);
    GN_TRY(check_overrides(overrides, override_count, error));
    GN_TRY(gn_checkpoint_load(path, overrides, override_count, run, error));
    gneiss_status status = apply_overrides(run, overrides, override_count, error);
    if (status != GNEISS_OK) {
        gn_run_free(run);
        return status;
    }
    gn_run_take_up(run);
    return GNEISS_OK;
}
