#include "cli/wrong_file.h"

#include "io/files.h"
#include "scene/tree.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SIZE_MOST = 16 << 20 };

typedef enum kind { OTHER, SCENE, SWEEP, PACKING } kind;

static bool has_any(const gn_node *root, const char *const *keys) {
    for (; *keys; keys++)
        if (gn_node_child(root, *keys)) return true;
    return false;
}

/* The kind follows from top-level keys that no other kind has. */
static kind kind_of_root(const gn_node *root) {
    static const char *const sweep[] = {"parameters", "seeds", "sampling", "combine", NULL},
                             *const scene[] = {"materials", "law",  "time",   "elements", "walls",
                                               "bodies",    "test", "stages", NULL};
    if (!root || root->kind != GN_NODE_MAP) return OTHER;
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

static const char *const takes_scene[] = {"run", "check", "plan", NULL},
                         *const takes_folder[] = {"resume", "report", NULL},
                         *const takes_file[] = {"run", "check", "plan", "pack", "sweep", NULL};

/* NULL: the command accepts such a file, and the problem is another. */
static const char *found_text(const gn_options *options, kind found) {
    const bool sweep = strcmp(options->command, "sweep") == 0;
    if (found == SWEEP && !sweep)
        return "a sweep file, which names a scene and values of its keys: gneiss sweep";
    if (found == SCENE && (sweep || is_one_of(options->command, takes_folder)))
        return "a scene: gneiss run";
    if (found == PACKING && strcmp(options->command, "pack") != 0)
        return "a specimen alone, without materials and time: gneiss pack";
    return NULL;
}

static const char *expected_text(const gn_options *options) {
    return is_one_of(options->command, takes_scene)    ? "a scene"
           : is_one_of(options->command, takes_folder) ? "a folder of results"
           : strcmp(options->command, "sweep") == 0    ? "a sweep file"
                                                       : "a scene or a specimen";
}

void gn_name_wrong_file(const gn_options *options, gneiss_error *error) {
    struct stat status;
    if (!options->command || !options->target || stat(options->target, &status) != 0) return;
    if (S_ISDIR(status.st_mode) && is_one_of(options->command, takes_file)) {
        gn_fail(error, GNEISS_ERROR_INPUT,
                "%.1000s: expected a %s file, found a folder: gneiss resume continues a run, "
                "gneiss report shows it",
                options->target, strcmp(options->command, "sweep") == 0 ? "sweep" : "scene");
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
