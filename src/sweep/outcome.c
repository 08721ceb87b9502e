#include "sweep/outcome.h"

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

/* JSON is YAML. */
static bool parse(const char *text, const char *path, gn_outcome *o) {
    gn_tree *tree = NULL;
    if (gn_tree_read(text, strlen(text), path, &tree, NULL) != GNEISS_OK) return false;
    const gn_node *root = gn_tree_root(tree), *state = gn_node_child(root, "status"),
                  *code = gn_node_child(root, "code"), *message = gn_node_child(root, "message");
    bool known = state && code && state->kind == GN_NODE_SCALAR && code->kind == GN_NODE_SCALAR;
    bool done = known && strcmp(state->text, names[GN_RUN_DONE]) == 0;
    known = done || (known && strcmp(state->text, names[GN_RUN_FAILED]) == 0);
    if (known) {
        o->state = done ? GN_RUN_DONE : GN_RUN_FAILED;
        o->code = (int)strtol(code->text, NULL, 10);
        if (message && message->kind == GN_NODE_SCALAR)
            snprintf(o->message, sizeof o->message, "%s", message->text);
    }
    gn_tree_free(tree);
    return known;
}

/* The disk was full, somebody took the file away, a copy was cut off. */
static bool has_results(const char *folder, gneiss_error *trouble) {
    char path[GN_PATH_SIZE + 32], *hash = NULL;
    snprintf(path, sizeof path, "%s/results.h5", folder);
    gneiss_status status = gn_h5_peek_text(path, "/", "state_hash", &hash, trouble);
    free(hash);
    return status == GNEISS_OK;
}

/* Its results are to be computed again: from its last checkpoint, if there is one. */
static void lose(gn_outcome *o, const gneiss_error *trouble) {
    *o = (gn_outcome){.lost = true};
    snprintf(o->message, sizeof o->message, "its results cannot be read: %.500s", trouble->message);
}

gneiss_status gn_outcome_read(const char *folder, gn_outcome *o, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], *text = NULL;
    int64_t step;
    size_t checkpoints = 0;
    *o = (gn_outcome){0};
    outcome_path(folder, path, sizeof path);
    if (access(path, F_OK) == 0 && gn_read_text_file(path, 1 << 16, &text, NULL) == GNEISS_OK) {
        bool known = parse(text, path, o);
        free(text);
        gneiss_error trouble = {0};
        bool lost = known && o->state == GN_RUN_DONE && !has_results(folder, &trouble);
        if (known && !lost) return GNEISS_OK;
        if (lost) lose(o, &trouble);
    }
    if (access(folder, F_OK) != 0) return GNEISS_OK;
    GN_TRY(gn_checkpoint_list(folder, &step, 1, &checkpoints, error));
    if (checkpoints) o->state = GN_RUN_INTERRUPTED;
    return GNEISS_OK;
}

/* Not synced: where a power cut takes it, the run is taken up from its last checkpoint, at its end.
 */
gneiss_status gn_outcome_write(const char *folder, const gn_outcome *o, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    gn_json *j = gn_json_begin();
    gn_json_text(j, "status", names[o->state]);
    gn_json_integer(j, "code", o->code);
    gn_json_text(j, "message", o->message);
    char *text = gn_json_finish(j, true);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for outcome.json");
    outcome_path(folder, path, sizeof path);
    gneiss_status status = gn_write_text_file(path, text, GN_RENAMED, error);
    free(text);
    return status;
}

void gn_outcome_forget(const char *folder, bool lost) {
    char path[GN_PATH_SIZE + 32];
    outcome_path(folder, path, sizeof path);
    (void)unlink(path);
    snprintf(path, sizeof path, "%s/results.h5", folder);
    if (lost) (void)unlink(path);
}

bool gn_outcome_stands(const gn_outcome *o) {
    return o->state == GN_RUN_DONE ||
           (o->state == GN_RUN_FAILED && o->code == GNEISS_ERROR_UNSTABLE);
}
