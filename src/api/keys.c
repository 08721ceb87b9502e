/* Public API: the keys of scene files. */
#include "api/handles.h"
#include "scene/manifest.h"

#include <string.h>

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

gneiss_status gneiss_key_at(size_t index, gneiss_key *out, gneiss_error *error) {
    GN_TRY(gn_api_require(out, "key", error));
    char path[sizeof out->path];
    const gn_key *key = gn_scene_key_number(index, path, sizeof path);
    if (!key)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "argument index: expected less than the number of keys, found %zu", index);
    *out = (gneiss_key){.kind = kind_of(key),
                        .unit = key->unit && key->type != GN_KEY_TREE ? key->unit : "1",
                        .word = key->word ? key->word : "",
                        .text = key->text,
                        .required = key->required};
    memcpy(out->path, path, sizeof path);
    gn_key_describe(key, out->value, sizeof out->value, out->fallback, sizeof out->fallback);
    return GNEISS_OK;
}
