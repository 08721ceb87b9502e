/* Places in the scene that the parameters write: keys have several spellings. */
#include "sweep/expand.h"

#include <string.h>

enum { OVERRIDES_MOST = 64, PLACES_MOST = OVERRIDES_MOST + GN_SWEEP_PARAMETERS_MAX };

typedef struct writer {
    const char *key;
    const gn_sweep_parameter *parameter; /* NULL: of the command line */
    char place[GN_KEY_PATH_SIZE];
} writer;

/* True if `part` is `whole` or a part of it. */
static bool holds(const char *whole, const char *part) {
    size_t length = strlen(whole);
    return strncmp(whole, part, length) == 0 && (part[length] == '.' || !part[length]);
}

/* A part of a value that is equal in every run may be varied: --set gravity=[0, 0, 0] and
 * gravity[2]. */
static bool conflicts(const writer *before, const writer *now) {
    if (holds(now->place, before->place)) return true;
    return before->parameter && before->parameter->count > 1 && holds(before->place, now->place);
}

static gneiss_status refuse(const gn_sweep *sweep, const writer *before, const writer *now,
                            gneiss_error *error) {
    const gn_sweep_parameter *parameter = now->parameter, *other = before->parameter;
    if (!other)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s:%d:%d: parameters.%s: given on the command line as well: --set %s",
                       sweep->source, parameter->where.line, parameter->where.column,
                       parameter->key, before->key);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s:%d:%d: parameters.%s: expected once, found again; first given as %s in line "
                   "%d, column %d",
                   sweep->source, parameter->where.line, parameter->where.column, parameter->key,
                   other->key, other->where.line, other->where.column);
}

static gneiss_status check_one(const gn_sweep *sweep, const gn_tree *tree, writer *all,
                               size_t count, gneiss_error *error) {
    writer *now = &all[count];
    gn_tree_place(tree, now->key, now->place, sizeof now->place);
    for (size_t k = 0; now->parameter && k < count; k++)
        if (conflicts(&all[k], now)) return refuse(sweep, &all[k], now, error);
    return GNEISS_OK;
}

/* Overrides are applied in their order, so that names are those at that moment. An override that
 * cannot be applied is reported when the scene is read. */
static gneiss_status check_run(const gn_sweep *sweep, size_t run, gneiss_error *error) {
    writer all[PLACES_MOST];
    gn_tree *tree = NULL;
    size_t first = sweep->override_count < OVERRIDES_MOST ? sweep->override_count : OVERRIDES_MOST;
    if (gn_tree_read(sweep->scene_text, strlen(sweep->scene_text), sweep->scene, &tree, NULL) !=
        GNEISS_OK)
        return GNEISS_OK;
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < first + sweep->parameter_count; k++) {
        const gn_sweep_parameter *parameter = k < first ? NULL : &sweep->parameters[k - first];
        gn_override put = parameter ? (gn_override){parameter->key,
                                                    gn_sweep_value_of(sweep, run, k - first)->text}
                                    : sweep->overrides[k];
        all[k] = (writer){.key = put.key ? put.key : "", .parameter = parameter};
        status = check_one(sweep, tree, all, k, error);
        if (status == GNEISS_OK && gn_tree_override(tree, &put, NULL) != GNEISS_OK) break;
    }
    gn_tree_free(tree);
    return status;
}

/* Places differ between runs only if names do. */
gneiss_status gn_sweep_check_places(const gn_sweep *sweep, gneiss_error *error) {
    bool names = false;
    for (size_t p = 0; p < sweep->parameter_count; p++) {
        const char *dot = strrchr(sweep->parameters[p].key, '.');
        names |= dot && strcmp(dot, ".name") == 0;
    }
    for (size_t run = 0; run < (names ? sweep->run_count : 1); run++)
        GN_TRY(check_run(sweep, run, error));
    return GNEISS_OK;
}
