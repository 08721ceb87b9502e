/* Public API: the keys of scene files. */
#include "api/handles.h"
#include "scene/manifest.h"

#include <stdbool.h>
#include <stdio.h>

static const char *kind_of(const gn_key *key) {
    switch (key->type) {
    case GN_KEY_REAL:
        return "number";
    case GN_KEY_INTEGER:
    case GN_KEY_SEED:
        return "integer";
    case GN_KEY_TEXT:
    case GN_KEY_NAME:
    case GN_KEY_FILE:
        return "text";
    case GN_KEY_CHOICE:
        return "choice";
    case GN_KEY_VECTOR:
        return key->second ? "tables" : "vector";
    case GN_KEY_CELLS:
        return "vector";
    case GN_KEY_SPIN:
        return "spin";
    case GN_KEY_TABLE:
        return "table";
    case GN_KEY_IDS:
        return "numbers";
    case GN_KEY_PARTICLES:
    case GN_KEY_POINTS:
        return "rows";
    case GN_KEY_NAMES:
        return "names";
    case GN_KEY_SECTION:
        return "section";
    case GN_KEY_LIST:
        return "list";
    case GN_KEY_TREE:
    case GN_KEY_CHANGES:
        break;
    }
    return "tree";
}

/* Search for the key at an index in the list of all keys. */
typedef struct sought {
    size_t left; /* number of keys that precede it */
    bool found;
    gneiss_key *out;
} sought;

static void look_at(void *context, const char *path, const gn_key *key) {
    sought *s = context;
    if (s->found || s->left-- > 0) return;
    gneiss_key *out = s->out;
    *out = (gneiss_key){.kind = kind_of(key),
                        .unit = key->unit && key->type != GN_KEY_TREE ? key->unit : "1",
                        .word = key->word ? key->word : "",
                        .text = key->text,
                        .required = key->required};
    snprintf(out->path, sizeof out->path, "%s", path);
    gn_key_describe(key, out->value, sizeof out->value);
    snprintf(out->fallback, sizeof out->fallback, "%s", key->fallback ? key->fallback : "");
    s->found = true;
}

gneiss_status gneiss_key_at(size_t index, gneiss_key *key, gneiss_error *error) {
    sought s = {index, false, key};
    GN_TRY(gn_api_require(key, "key", error));
    gn_scene_visit_keys(look_at, &s);
    if (s.found) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "argument index: expected less than %zu, the number of keys, found %zu",
                   index - s.left, index);
}
