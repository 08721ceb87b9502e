#include "sweep/outcome.h"

#include "base/printable.h"
#include "io/checkpoint_files.h"
#include "io/files.h"
#include "io/h5.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const names[] = {"new", "interrupted", "done", "failed"};

const char *gn_run_state_name(gn_run_state state) {
    return names[state];
}

bool gn_run_folder(const char *directory, uint64_t hash, char folder[GN_PATH_SIZE]) {
    int length = snprintf(folder, GN_PATH_SIZE, "%s/%016" PRIx64, directory, hash);
    return length > 0 && length < GN_PATH_SIZE - 64;
}

static void outcome_path(const char *folder, char *path, size_t size) {
    snprintf(path, size, "%s/outcome.json", folder);
}

/* Parses outcome.json, as JSON is YAML. *results (malloc'ed, NULL: missing) is the digest of the
 * results at the end of the run. */
static bool parse(const char *text, const char *path, gn_outcome *outcome, char **results) {
    gn_tree *tree = NULL;
    if (gn_tree_read(text, strlen(text), path, &tree, NULL) != GNEISS_OK) return false;
    const gn_node *root = gn_tree_root(tree), *state = gn_node_child(root, "status"),
                  *code = gn_node_child(root, "code"), *message = gn_node_child(root, "message"),
                  *digest = gn_node_child(root, "results");
    bool known = state && code && state->kind == GN_NODE_SCALAR && code->kind == GN_NODE_SCALAR;
    bool done = known && strcmp(state->text, names[GN_RUN_DONE]) == 0;
    known = done || (known && strcmp(state->text, names[GN_RUN_FAILED]) == 0);
    if (known) {
        outcome->state = done ? GN_RUN_DONE : GN_RUN_FAILED;
        outcome->code = (int)strtol(code->text, NULL, 10);
        if (message && message->kind == GN_NODE_SCALAR)
            snprintf(outcome->message, sizeof outcome->message, "%s", message->text);
        gn_make_printable(outcome->message);
        if (digest && digest->kind == GN_NODE_SCALAR) *results = strdup(digest->text);
    }
    gn_tree_free(tree);
    return known;
}

/* True if the end of the path of the scene, FOLDER/scene.yaml, matches the run's folder. */
static bool of_folder(const char *scene_file, const char *folder) {
    const char *slash = strrchr(folder, '/'), *own = slash ? slash + 1 : folder;
    char tail[GN_PATH_SIZE];
    snprintf(tail, sizeof tail, "%.200s/scene.yaml", own);
    size_t length = strlen(scene_file), behind = strlen(tail);
    if (length < behind || strcmp(scene_file + length - behind, tail) != 0) return false;
    return length == behind || scene_file[length - behind - 1] == '/';
}

static gneiss_status check_owner(const gn_h5 *file, const char *path, const char *folder,
                                 gneiss_error *error) {
    char *scene = NULL;
    GN_TRY(gn_h5_get_attribute_text(file, "/", "scene_file", &scene, error));
    gneiss_status status = of_folder(scene, folder)
                               ? GNEISS_OK
                               : gn_fail(error, GNEISS_ERROR_INPUT,
                                         "%.200s: it belongs to another run (%.200s)", path, scene);
    free(scene);
    return status;
}

/* "": results of a version that wrote no digests. */
static gneiss_status digest_of_results(const gn_h5 *file, char digest[24], gneiss_error *error) {
    int64_t value = 0;
    digest[0] = '\0';
    if (!gn_h5_has_digests(file)) return GNEISS_OK;
    GN_TRY(gn_h5_get_attribute_i64(file, "/", "digest_of_names", &value, 1, error));
    snprintf(digest, 24, "%016" PRIx64, (uint64_t)value);
    return GNEISS_OK;
}

/* Checks all contents, also those that no summary reads: they count as results of the run. */
static gneiss_status check_contents(gn_h5 *file, const char *path, const char *folder,
                                    const char *results, bool *replaced, gneiss_error *error) {
    char *hash = NULL, digest[24];
    GN_TRY(gn_h5_check_names(file, false, error));
    GN_TRY(gn_h5_get_attribute_text(file, "/", "state_hash", &hash, error));
    free(hash);
    GN_TRY(check_owner(file, path, folder, error));
    GN_TRY(gn_h5_check_values(file, error));
    GN_TRY(digest_of_results(file, digest, error));
    *replaced = strcmp(results ? results : "", digest) != 0;
    if (!*replaced) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.200s: they differ from the results at the end of the run%s", path,
                   results ? "" : ", which outcome.json does not name");
}

/* Results may be missing or different if the disk was full, the file was removed or replaced, or a
 * copy was truncated. */
static bool has_results(const char *folder, const char *results, bool *replaced,
                        gneiss_error *trouble) {
    char path[GN_PATH_SIZE + 32];
    gn_h5 *file = NULL;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    gneiss_status status = gn_h5_open(path, &file, trouble);
    if (status == GNEISS_OK)
        status = check_contents(file, path, folder, results, replaced, trouble);
    gn_h5_close(file);
    return status == GNEISS_OK;
}

/* Marks the results as unusable: the run is computed again, from its last checkpoint if there is
 * one. */
static void mark_lost(gn_outcome *outcome, const char *what, const gneiss_error *trouble) {
    *outcome = (gn_outcome){.lost = true};
    snprintf(outcome->message, sizeof outcome->message, "its %s cannot be read: %.500s", what,
             trouble->message);
}

/* An unreadable checkpoint is left to `resume`. */
static bool is_foreign(const char *folder, int64_t step, gneiss_error *trouble) {
    char *path = NULL, *scene = NULL;
    if (gn_checkpoint_path(folder, step, &path, NULL) != GNEISS_OK) return false;
    bool read = gn_h5_peek_text(path, "/", "scene_file", &scene, NULL) == GNEISS_OK;
    bool foreign = read && !of_folder(scene, folder);
    if (foreign)
        gn_fail(trouble, GNEISS_ERROR_INPUT, "%.200s: it belongs to another run (%.200s)", path,
                scene);
    free(scene);
    free(path);
    return foreign;
}

enum { CHECKPOINTS_MOST = 16 };

gneiss_status gn_outcome_rename_foreign(const char *folder, gneiss_error *error) {
    int64_t step[CHECKPOINTS_MOST];
    size_t count = 0;
    gneiss_error trouble;
    GN_TRY(gn_checkpoint_list(folder, step, CHECKPOINTS_MOST, &count, error));
    for (size_t k = 0; k < count; k++)
        if (is_foreign(folder, step[k], &trouble))
            GN_TRY(gn_checkpoint_set_aside(folder, step[k], error));
    return GNEISS_OK;
}

/* Sets the state by the existence of a checkpoint to resume from; checkpoints of another run do not
 * count. */
static gneiss_status look_for_checkpoints(const char *folder, gn_outcome *outcome,
                                          gneiss_error *error) {
    int64_t step[CHECKPOINTS_MOST];
    size_t count = 0;
    gneiss_error trouble = {0};
    if (access(folder, F_OK) != 0) return GNEISS_OK;
    GN_TRY(gn_checkpoint_list(folder, step, CHECKPOINTS_MOST, &count, error));
    for (size_t k = 0; k < count; k++) {
        if (!is_foreign(folder, step[k], &trouble))
            outcome->state = GN_RUN_INTERRUPTED;
        else if (!outcome->lost)
            mark_lost(outcome, "checkpoint", &trouble);
    }
    return GNEISS_OK;
}

/* *known is false, and outcome->lost true, if outcome.json exists and cannot be read. */
static void read_outcome(const char *folder, gn_outcome *outcome, char **results, bool *known) {
    char path[GN_PATH_SIZE + 32], *text = NULL;
    gneiss_error trouble = {0};
    outcome_path(folder, path, sizeof path);
    *known = false;
    if (access(path, F_OK) != 0) return;
    if (gn_read_text_file(path, 1 << 16, &text, &trouble) == GNEISS_OK)
        *known = parse(text, path, outcome, results);
    if (!*known && text)
        gn_fail(&trouble, GNEISS_ERROR_INPUT,
                "%.300s: expected status (done, failed) and code, found others", path);
    free(text);
    if (!*known) mark_lost(outcome, "outcome", &trouble);
}

gneiss_status gn_outcome_read(const char *folder, gn_outcome *outcome, gneiss_error *error) {
    char *results = NULL;
    bool known, replaced = false;
    gneiss_error trouble = {0};
    *outcome = (gn_outcome){0};
    read_outcome(folder, outcome, &results, &known);
    bool whole = known && (outcome->state != GN_RUN_DONE ||
                           has_results(folder, results, &replaced, &trouble));
    free(results);
    if (whole) return GNEISS_OK;
    if (known) mark_lost(outcome, "results", &trouble);
    outcome->replaced = replaced;
    return replaced ? GNEISS_OK : look_for_checkpoints(folder, outcome, error);
}

/* "" if they cannot be read, which the next call finds. */
static void digest_in_folder(const char *folder, char digest[24]) {
    char path[GN_PATH_SIZE + 32];
    gn_h5 *file = NULL;
    digest[0] = '\0';
    snprintf(path, sizeof path, "%s/results.h5", folder);
    if (gn_h5_open(path, &file, NULL) != GNEISS_OK) return;
    if (digest_of_results(file, digest, NULL) != GNEISS_OK) digest[0] = '\0';
    gn_h5_close(file);
}

/* The file is not synced: if a power failure loses it, the run is resumed from its last checkpoint,
 * at its end. */
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *outcome, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], digest[24] = "";
    if (outcome->state == GN_RUN_DONE) digest_in_folder(folder, digest);
    gn_json *json = gn_json_begin();
    gn_json_text(json, "status", names[outcome->state]);
    gn_json_integer(json, "code", outcome->code);
    gn_json_text(json, "message", outcome->message);
    if (*digest) gn_json_text(json, "results", digest);
    char *text = gn_json_finish(json, true);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for outcome.json");
    outcome_path(folder, path, sizeof path);
    gneiss_status status = gn_write_text_file(path, text, GN_RENAMED, error);
    free(text);
    return status;
}

void gn_outcome_remove(const char *folder, bool lost) {
    char path[GN_PATH_SIZE + 32];
    outcome_path(folder, path, sizeof path);
    (void)unlink(path);
    snprintf(path, sizeof path, "%s/results.h5", folder);
    if (lost) (void)unlink(path);
}

bool gn_outcome_is_final(const gn_outcome *outcome) {
    return outcome->state == GN_RUN_DONE ||
           (outcome->state == GN_RUN_FAILED && outcome->code == GNEISS_ERROR_UNSTABLE);
}
