#include "plan/rewrite.h"

#include "base/memory.h"
#include "io/files.h"
#include "scene/manifest.h"
#include "scene/tree.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const size_t size_limit = (size_t)16 << 20;

/* A text that is changed at one place after another; it is parsed anew before each change, so that
 * places always refer to the present text. */
typedef struct scene_draft {
    char *text;
    const char *name;
} scene_draft;

/* --- places --- */

static char *place_in(const scene_draft *draft, gn_scene_place where) {
    char *at = draft->text;
    for (int line = 1; line < where.line && at; line++) {
        at = strchr(at, '\n');
        if (at) at++;
    }
    for (int column = 1; at && column < where.column && *at; column++) {
        at++;
        while ((*at & 0xc0) == 0x80) at++; /* columns count characters */
    }
    return at;
}

static char *line_start(const scene_draft *draft, char *at) {
    while (at > draft->text && at[-1] != '\n') at--;
    return at;
}

/* Skips a quoted text that begins here. */
static char *skip_quotes(char *at) {
    char quote = *at++;
    while (*at && *at != quote) at += *at == '\\' && quote == '"' && at[1] ? 2 : 1;
    return *at ? at + 1 : at;
}

/* Skips to the end of the bracket that opens here. */
static char *skip_brackets(char *at) {
    int depth = 0;
    while (*at) {
        if (*at == '"' || *at == '\'') {
            at = skip_quotes(at);
            continue;
        }
        if (*at == '#' && (at[-1] == ' ' || at[-1] == '\n')) {
            at += strcspn(at, "\n");
            continue;
        }
        depth += (*at == '[' || *at == '{') - (*at == ']' || *at == '}');
        at++;
        if (depth == 0) break;
    }
    return at;
}

/* Returns the end of a node's value; NULL: it spans several lines without brackets. */
static char *value_end(const gn_node *node, char *at) {
    if (*at == '"' || *at == '\'') return skip_quotes(at);
    if (*at == '[' || *at == '{') return skip_brackets(at);
    size_t length = node->kind == GN_NODE_SCALAR ? strlen(node->text) : 0;
    return length && strncmp(at, node->text, length) == 0 ? at + length : NULL;
}

/* --- changes --- */

/* Replaces [from, to) by `fresh`. */
static gneiss_status splice(scene_draft *draft, const char *from, const char *to, const char *fresh,
                            gneiss_error *error) {
    size_t before = (size_t)(from - draft->text), length = strlen(fresh), rest = strlen(to);
    char *text = malloc(before + length + rest + 1);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: no memory", draft->name);
    snprintf(text, before + length + rest + 1, "%.*s%s%s", (int)before, draft->text, fresh, to);
    free(draft->text);
    draft->text = text;
    return GNEISS_OK;
}

static gneiss_status replace(scene_draft *draft, const gn_node *node, const char *value, bool *done,
                             gneiss_error *error) {
    char *at = place_in(draft, node->where);
    if (at && at > draft->text && (at[-1] == '"' || at[-1] == '\'')) at--;
    char *end = at ? value_end(node, at) : NULL;
    *done = end != NULL;
    return end ? splice(draft, at, end, value, error) : GNEISS_OK;
}

/* Writes "a.b.c" and a value as "a: {b: {c: value}}". */
static void nested(const char *rest, const char *value, char *text, size_t size) {
    size_t used = 0;
    int depth = 0;
    for (const char *step = rest; step && used < size;) {
        size_t length = strcspn(step, ".");
        bool more = step[length] == '.';
        used += (size_t)snprintf(text + used, size - used, "%.*s: %s", (int)length, step,
                                 more ? "{" : value);
        depth += more;
        step = more ? step + length + 1 : NULL;
    }
    while (depth-- > 0 && used < size) used += (size_t)snprintf(text + used, size - used, "}");
}

/* Adds a key that the map lacks: after its brace, or as a line before its first key. */
static gneiss_status insert(scene_draft *draft, const gn_node *map, const char *rest,
                            const char *value, bool *done, gneiss_error *error) {
    char fresh[4096], line[4200];
    char *at = place_in(draft, map->where);
    nested(rest, value, fresh, sizeof fresh);
    *done = false;
    if (at && *at == '{') {
        snprintf(line, sizeof line, "%s%s", fresh, map->count ? ", " : "");
        *done = true;
        return splice(draft, at + 1, at + 1, line, error);
    }
    char *first = map->first ? place_in(draft, map->first->key_where) : NULL;
    if (!first) return GNEISS_OK;
    char *start = line_start(draft, first);
    for (const char *c = start; c < first; c++)
        if (*c != ' ') return GNEISS_OK; /* after the dash of a list */
    snprintf(line, sizeof line, "%*s%s\n", (int)(first - start), "", fresh);
    *done = true;
    return splice(draft, start, start, line, error);
}

/* Returns the node at a place as gn_tree_place spells it, or the last map on the way and the
 * remaining path. */
static const gn_node *walk(const gn_node *root, const char *place, const char **rest) {
    const gn_node *at = root;
    *rest = place;
    while (**rest) {
        size_t length = strcspn(*rest, ".");
        char step[256];
        snprintf(step, sizeof step, "%.*s", (int)length, *rest);
        const gn_node *next = at->kind == GN_NODE_LIST ? gn_node_item(at, strtoul(step, NULL, 10))
                                                       : gn_node_child(at, step);
        if (!next) return at;
        at = next;
        *rest += length + ((*rest)[length] == '.');
    }
    return at;
}

static gneiss_status change(scene_draft *draft, const gn_override *override, bool *done,
                            gneiss_error *error) {
    gn_tree *tree = NULL;
    char place[512];
    const char *rest;
    GN_TRY(gn_tree_read(draft->text, strlen(draft->text), draft->name, &tree, error));
    gn_tree_place(tree, override->key, place, sizeof place);
    const gn_node *node = walk(gn_tree_root(tree), place, &rest);
    gneiss_status status = GNEISS_OK;
    *done = false;
    if (!*rest)
        status = replace(draft, node, override->value, done, error);
    else if (node->kind == GN_NODE_MAP)
        status = insert(draft, node, rest, override->value, done, error);
    gn_tree_free(tree);
    return status;
}

/* --- files that the scene names --- */

/* Adapts paths that are relative to the old folder. */
static gneiss_status resolve_files(scene_draft *draft, const gn_section *section, const char *base,
                                   const char *path, gneiss_error *error);

static gneiss_status resolve_file(scene_draft *draft, const char *key, const char *written,
                                  const char *resolved, gneiss_error *error) {
    char absolute[PATH_MAX], quoted[PATH_MAX + 2];
    bool done;
    if (!*written || *written == '/' || !realpath(resolved, absolute)) return GNEISS_OK;
    snprintf(quoted, sizeof quoted, "\"%s\"", absolute);
    return change(draft, &(gn_override){key, quoted}, &done, error);
}

static gneiss_status resolve_list(scene_draft *draft, const gn_key *key, const char *base,
                                  const char *path, gneiss_error *error) {
    const char *array;
    char element[640];
    memcpy(&array, base + key->offset, sizeof array);
    size_t count = *(const size_t *)(base + key->second);
    for (size_t k = 0; k < count; k++) {
        snprintf(element, sizeof element, "%s.%zu", path, k);
        GN_TRY(resolve_files(draft, key->section, array + k * key->section->size, element, error));
    }
    return GNEISS_OK;
}

static gneiss_status resolve_files(scene_draft *draft, const gn_section *section, const char *base,
                                   const char *path, gneiss_error *error) {
    char name[512];
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        snprintf(name, sizeof name, "%s%s%s", path, *path ? "." : "", key->name);
        if (!gn_key_present(key, base)) continue;
        if (key->type == GN_KEY_FILE)
            GN_TRY(resolve_file(draft, name, base + key->offset, base + key->second, error));
        else if (key->type == GN_KEY_SECTION)
            GN_TRY(resolve_files(draft, key->section, base + key->offset, name, error));
        else if (key->type == GN_KEY_LIST)
            GN_TRY(resolve_list(draft, key, base, name, error));
    }
    return GNEISS_OK;
}

/* --- the whole text --- */

static void folder_of(const char *path, char folder[GN_PATH_SIZE]) {
    const char *slash = strrchr(path, '/');
    int keep = !slash ? 1 : slash == path ? 1 : (int)(slash - path);
    snprintf(folder, GN_PATH_SIZE, "%.*s", keep, slash ? path : ".");
}

static bool same_folder(const char *a, const char *b) {
    char one[PATH_MAX], two[PATH_MAX], first[GN_PATH_SIZE], second[GN_PATH_SIZE];
    folder_of(a, first);
    folder_of(b, second);
    return realpath(first, one) && realpath(second, two) && strcmp(one, two) == 0;
}

/* True if the text, in its own folder, gives the same scene as the original with its overrides. */
static bool is_equivalent(const scene_draft *draft, const char *target, const char *wanted) {
    char folder[GN_PATH_SIZE], *found = NULL;
    gn_scene *scene = gn_alloc(sizeof *scene);
    folder_of(target, folder);
    if (scene &&
        gn_scene_parse(draft->text, draft->name, folder, NULL, 0, scene, NULL) == GNEISS_OK) {
        found = gn_scene_write(scene);
        gn_scene_free(scene);
    }
    bool same = found && strcmp(found, wanted) == 0;
    free(found);
    gn_free(scene);
    return same;
}

static gneiss_status edit_draft(scene_draft *draft, const gn_scene *scene,
                                const gn_override *overrides, size_t count, const char *target,
                                bool *done, gneiss_error *error) {
    *done = true;
    for (size_t k = 0; k < count && *done; k++) {
        bool root = !strchr(overrides[k].key, '.');
        GN_TRY(change(draft, &overrides[k], done, error));
        *done |= root;
    }
    if (*done && !same_folder(draft->name, target))
        GN_TRY(resolve_files(draft, &gn_scene_section, (const char *)scene, "", error));
    return GNEISS_OK;
}

static gneiss_status rewrite(const char *path, const gn_scene *scene, const char *wanted,
                             const gn_override *overrides, size_t count, const char *target,
                             bool *plain, gneiss_error *error) {
    scene_draft d = {.name = path};
    bool done;
    GN_TRY(gn_read_text_file(path, size_limit, &d.text, error));
    gneiss_status status = edit_draft(&d, scene, overrides, count, target, &done, error);
    *plain = status == GNEISS_OK && !(done && is_equivalent(&d, target, wanted));
    if (status == GNEISS_OK)
        status = gn_write_text_file(target, *plain ? wanted : d.text, GN_DURABLE, error);
    free(d.text);
    return status;
}

gneiss_status gn_scene_rewrite(const char *path, const gn_override *overrides, size_t count,
                               const char *target, bool force, bool *plain, gneiss_error *error) {
    if (!force && access(target, F_OK) == 0)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.300s: expected no file, found one: --force replaces it", target);
    gn_scene *scene = gn_alloc(sizeof *scene);
    if (!scene) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory");
    gneiss_status status = gn_scene_load(path, overrides, count, scene, error);
    char *wanted = NULL;
    if (status == GNEISS_OK) {
        wanted = gn_scene_write(scene);
        status = wanted ? rewrite(path, scene, wanted, overrides, count, target, plain, error)
                        : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the scene text");
        gn_scene_free(scene);
    }
    free(wanted);
    gn_free(scene);
    return status;
}
