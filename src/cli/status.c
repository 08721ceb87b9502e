#include "cli/status.h"

#include "cli/log.h"
#include "cli/progress.h"
#include "io/io.h"
#include "run/status.h"
#include "scene/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { STATUS_MOST = 1 << 16 };

static const char *text_of(const gn_node *root, const char *key) {
    const gn_node *node = gn_node_child(root, key);
    return node && node->kind == GN_NODE_SCALAR ? node->text : "";
}

/* True if the process of the run exists. It must have begun at the recorded time, because systems
 * use process numbers again. */
static bool is_alive(const gn_node *root) {
    char host[256] = "";
    (void)gethostname(host, sizeof host - 1);
    if (strcmp(text_of(root, "host"), host) == 0) {
        const int64_t began = strtoll(text_of(root, "pid_start"), NULL, 10);
        return began != 0 && gn_process_start(strtoll(text_of(root, "pid"), NULL, 10)) == began;
    }
    return (double)time(NULL) - strtod(text_of(root, "heartbeat_unix"), NULL) < GN_STATUS_LOST;
}

static void print_object(const gn_node *root, const char *state) {
    gn_json *json = gn_json_begin();
    for (const gn_node *node = root->first; node; node = node->next) {
        char *rest = NULL;
        if (node->kind != GN_NODE_SCALAR) continue;
        const double number = strtod(node->text, &rest);
        if (strcmp(node->key, "state") == 0)
            gn_json_text(json, "state", state);
        else if (strcmp(node->text, "true") == 0 || strcmp(node->text, "false") == 0)
            gn_json_bool(json, node->key, *node->text == 't');
        else if (strcmp(node->text, "null") == 0)
            gn_json_number(json, node->key, NAN);
        else if (*node->text && !*rest)
            gn_json_number(json, node->key, number);
        else
            gn_json_text(json, node->key, node->text);
    }
    gn_print_object("result", gn_json_finish(json, false));
}

static void print_text(const gn_node *root, const char *state, const char *directory) {
    char left[32];
    printf("%s: %s, step %s, t = %.4g s of %.4g s, %.3g %%", directory, state,
           text_of(root, "step"), strtod(text_of(root, "time"), NULL),
           strtod(text_of(root, "end"), NULL), 100.0 * strtod(text_of(root, "share"), NULL));
    if (strcmp(state, "running") == 0 && strcmp(text_of(root, "seconds_left"), "null") != 0)
        printf(", %s%s left", strcmp(text_of(root, "at_most"), "true") == 0 ? "at most " : "",
               gn_format_seconds(strtod(text_of(root, "seconds_left"), NULL), left, sizeof left));
    if (strcmp(state, "killed") == 0 || strcmp(state, "stopped") == 0)
        printf("; gneiss resume %s continues it from the last checkpoint", directory);
    if (*text_of(root, "message")) printf(": %s", text_of(root, "message"));
    printf("\n");
}

gneiss_status gn_command_status(const gn_options *options, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32], *text = NULL;
    gn_tree *tree = NULL;
    gn_status_path(options->target, path);
    if (access(path, F_OK) != 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected the folder of a run that has begun, found no status.json "
                       "(gneiss run writes it, worlds of the C API and of Python do not)",
                       options->target);
    GN_TRY(gn_read_text_file(path, STATUS_MOST, &text, error));
    gneiss_status status = gn_tree_read(text, strlen(text), path, &tree, error);
    free(text);
    GN_TRY(status);
    const gn_node *root = gn_tree_root(tree);
    const char *state = text_of(root, "state");
    if (strcmp(state, "running") == 0 && !is_alive(root)) state = "killed";
    if (options->log)
        print_object(root, state);
    else
        print_text(root, state, options->target);
    gn_tree_free(tree);
    return GNEISS_OK;
}
