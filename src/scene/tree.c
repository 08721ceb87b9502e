#include "scene/tree.h"

#include "base/memory.h"
#include "base/names.h"
#include "scene/manifest.h"

#include <errno.h>
#include <libfyaml.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_SIZE = 1 << 16, DEPTH_LIMIT = 32 };

/* Nodes and texts are stored in chunks that are freed together, so that no failure can leak one. */
typedef struct chunk {
    struct chunk *next;
    size_t used, size;
    _Alignas(16) char bytes[];
} chunk;

struct gn_tree {
    chunk *chunks;
    gn_node *root;
    char name[GN_PATH_SIZE];
};

static void *tree_alloc(gn_tree *tree, size_t bytes) {
    bytes = (bytes + 15) / 16 * 16;
    chunk *top = tree->chunks;
    if (!top || top->size - top->used < bytes) {
        size_t size = bytes > CHUNK_SIZE ? bytes : CHUNK_SIZE;
        chunk *fresh = gn_alloc(sizeof(chunk) + size);
        if (!fresh) return NULL;
        fresh->size = size;
        fresh->next = top;
        tree->chunks = top = fresh;
    }
    void *block = top->bytes + top->used;
    top->used += bytes;
    return block;
}

static const char *tree_text(gn_tree *tree, const char *text, size_t length) {
    char *copy = tree_alloc(tree, length + 1);
    if (copy && length) memcpy(copy, text, length);
    return copy;
}

static gn_node *tree_node(gn_tree *tree, gn_node_kind kind, gn_scene_place where) {
    gn_node *node = tree_alloc(tree, sizeof *node);
    if (!node) return NULL;
    node->kind = kind;
    node->where = node->key_where = where;
    return node;
}

static void append(gn_node *parent, gn_node *child) {
    if (parent->last)
        parent->last->next = child;
    else
        parent->first = child;
    parent->last = child;
    parent->count++;
}

gn_node *gn_tree_add(gn_tree *tree, gn_node *map, const gn_node *value) {
    gn_node *node = tree_alloc(tree, sizeof *node);
    if (!node) return NULL;
    *node = *value;
    node->next = NULL;
    append(map, node);
    return node;
}

gn_node *gn_tree_add_map(gn_tree *tree, gn_node *map, const gn_node *like) {
    gn_node *node = gn_tree_add(tree, map, like);
    if (!node) return NULL;
    node->kind = GN_NODE_MAP;
    node->first = node->last = NULL;
    node->count = 0;
    return node;
}

/* ---- reading ---- */

typedef struct tree_builder {
    gn_tree *tree;
    struct fy_parser *parser;
    struct fy_diag *diag;
    gneiss_error *error;
    const char *set; /* present override; NULL: the file */
    int depth;
} tree_builder;

static gn_scene_place event_where(struct fy_event *event) {
    const struct fy_mark *mark = event ? fy_event_start_mark(event) : NULL;
    return mark ? (gn_scene_place){mark->line + 1, mark->column + 1} : (gn_scene_place){1, 1};
}

static gneiss_status fail_at(tree_builder *builder, gn_scene_place where, const char *text) {
    if (builder->set)
        return gn_fail(builder->error, GNEISS_ERROR_INPUT, "--set %s: %s", builder->set, text);
    return gn_fail(builder->error, GNEISS_ERROR_INPUT, "%s:%d:%d: %s", builder->tree->name,
                   where.line, where.column, text);
}

static gneiss_status fail_memory(tree_builder *builder) {
    return gn_fail(builder->error, GNEISS_ERROR_MEMORY, "%s: out of memory while reading the scene",
                   builder->tree->name);
}

static gneiss_status fail_syntax(tree_builder *builder) {
    void *iterator = NULL;
    struct fy_diag_error *first = fy_diag_errors_iterate(builder->diag, &iterator);
    if (!first) return fail_at(builder, (gn_scene_place){1, 1}, "not valid YAML");
    char text[512];
    snprintf(text, sizeof text, "not valid YAML: %s", first->msg ? first->msg : "unknown reason");
    char *slip = strstr(text, "indendation"); /* the library's misspelling */
    if (slip) slip[5] = 't';
    return fail_at(
        builder,
        (gn_scene_place){first->line > 0 ? first->line : 1, first->column > 0 ? first->column : 1},
        text);
}

static gneiss_status next_event(tree_builder *builder, struct fy_event **event) {
    *event = fy_parser_parse(builder->parser);
    return *event ? GNEISS_OK : fail_syntax(builder);
}

static gneiss_status read_scalar(tree_builder *builder, struct fy_event *event, gn_node **node) {
    struct fy_token *token = event->scalar.value;
    enum fy_scalar_style style = token ? fy_token_scalar_style(token) : FYSS_PLAIN;
    gn_scene_place where = event_where(event);
    if (style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED)
        where.column--; /* the place of the opening quote */
    if (event->scalar.tag) return fail_at(builder, where, "YAML tags are not part of a scene");
    size_t length = 0;
    const char *text = token ? fy_token_get_text(token, &length) : "";
    if (!text) return fail_memory(builder);
    if (memchr(text, 0, length))
        return fail_at(builder, where, "expected text, found a NUL character in it");
    bool nothing =
        length == 0 && style == FYSS_PLAIN; /* for this error the library reports no place */
    *node = tree_node(builder->tree, nothing ? GN_NODE_NULL : GN_NODE_SCALAR, where);
    if (!*node) return fail_memory(builder);
    (*node)->set = builder->set;
    (*node)->text = tree_text(builder->tree, text, length);
    return (*node)->text ? GNEISS_OK : fail_memory(builder);
}

static gneiss_status read_node(tree_builder *builder, struct fy_event *event, gn_node **node);

/* Reads up to the end of the list or map that `open` began. */
static gneiss_status read_children(tree_builder *builder, gn_node *open, enum fy_event_type end) {
    for (;;) {
        struct fy_event *event;
        GN_TRY(next_event(builder, &event));
        if (event->type == end) {
            fy_parser_event_free(builder->parser, event);
            return GNEISS_OK;
        }
        gn_node *key = NULL, *child = NULL;
        gneiss_status status = GNEISS_OK;
        if (open->kind == GN_NODE_MAP) {
            if (event->type == FYET_SCALAR)
                status = read_scalar(builder, event, &key);
            else
                status = fail_at(builder, event_where(event),
                                 "expected a key, found something else than text");
            fy_parser_event_free(builder->parser, event);
            GN_TRY(status);
            GN_TRY(next_event(builder, &event));
        }
        status = read_node(builder, event, &child);
        fy_parser_event_free(builder->parser, event);
        GN_TRY(status);
        if (key) {
            child->key = key->text;
            child->key_where = key->where;
        }
        if (child->kind == GN_NODE_NULL) child->where = key ? key->where : open->where;
        append(open, child);
    }
}

static gneiss_status read_open(tree_builder *builder, struct fy_event *event, gn_node **node) {
    bool map = event->type == FYET_MAPPING_START;
    struct fy_token *tag = map ? event->mapping_start.tag : event->sequence_start.tag;
    gn_scene_place where = event_where(event);
    if (tag) return fail_at(builder, where, "YAML tags are not part of a scene");
    if (builder->depth >= DEPTH_LIMIT) return fail_at(builder, where, "nested too deeply");
    *node = tree_node(builder->tree, map ? GN_NODE_MAP : GN_NODE_LIST, where);
    if (!*node) return fail_memory(builder);
    (*node)->set = builder->set;
    builder->depth++;
    gneiss_status status =
        read_children(builder, *node, map ? FYET_MAPPING_END : FYET_SEQUENCE_END);
    builder->depth--;
    return status;
}

static gneiss_status read_node(tree_builder *builder, struct fy_event *event, gn_node **node) {
    gn_scene_place where = event_where(event);
    switch (event->type) {
    case FYET_SCALAR:
        return read_scalar(builder, event, node);
    case FYET_MAPPING_START:
    case FYET_SEQUENCE_START:
        return read_open(builder, event, node);
    case FYET_ALIAS:
        where.column--; /* the place of the star */
        return fail_at(builder, where, "YAML aliases are not part of a scene; repeat the value");
    default:
        return fail_at(builder, where, "expected a value, found the end of the document");
    }
}

/* Reads the whole stream, which has one document or none (*node then remains NULL). */
static gneiss_status read_stream(tree_builder *builder, gn_node **node) {
    *node = NULL;
    for (;;) {
        struct fy_event *event = fy_parser_parse(builder->parser);
        /* The parser also returns NULL after the last event; only a diagnostic tells that there was
         * an error. */
        if (!event)
            return fy_parser_get_stream_error(builder->parser) || fy_diag_got_error(builder->diag)
                       ? fail_syntax(builder)
                       : GNEISS_OK;
        gneiss_status status = GNEISS_OK;
        bool last = event->type == FYET_STREAM_END;
        if (event->type == FYET_SCALAR || event->type == FYET_MAPPING_START ||
            event->type == FYET_SEQUENCE_START || event->type == FYET_ALIAS)
            status = read_node(builder, event, node);
        else if (event->type == FYET_DOCUMENT_START && *node)
            status = fail_at(builder, event_where(event),
                             "expected one YAML document, found a second one");
        fy_parser_event_free(builder->parser, event);
        if (status != GNEISS_OK || last) return status;
    }
}

static gneiss_status read_yaml(gn_tree *tree, const char *text, size_t length, const char *set,
                               gn_node **node, gneiss_error *error) {
    tree_builder b = {.tree = tree, .error = error, .set = set};
    struct fy_diag_cfg diag_cfg;
    fy_diag_cfg_default(&diag_cfg);
    diag_cfg.fp = NULL;
    diag_cfg.level = FYET_ERROR;
    errno = 0;
    b.diag = fy_diag_create(&diag_cfg);
    if (!b.diag) return fail_memory(&b);
    /* Errors are collected, so that the library prints nothing to stderr. */
    fy_diag_set_collect_errors(b.diag, true);
    struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_JSON_NONE | FYPCF_ALLOW_DUPLICATE_KEYS,
                               .diag = b.diag};
    gneiss_status status;
    b.parser = fy_parser_create(&cfg);
    if (!b.parser || fy_parser_set_string(b.parser, text, length))
        status = fail_memory(&b);
    else
        status = read_stream(&b, node);
    /* The library reports lack of memory like any other error, or as a shorter text. */
    if (errno == ENOMEM) status = fail_memory(&b);
    if (b.parser) fy_parser_destroy(b.parser);
    fy_diag_destroy(b.diag);
    return status;
}

/* Returns the length of the UTF-8 sequence at `bytes` (Unicode 15, table 3-7), 0 if it is invalid
 * or a control character. */
static size_t utf8_length(const unsigned char *bytes, size_t left) {
    if (bytes[0] < 0x80)
        return bytes[0] >= 0x20 || bytes[0] == '\t' || bytes[0] == '\n' || bytes[0] == '\r' ? 1 : 0;
    size_t length = bytes[0] >= 0xc2 && bytes[0] < 0xe0   ? 2
                    : bytes[0] >= 0xe0 && bytes[0] < 0xf0 ? 3
                                                          : 4;
    if (bytes[0] < 0xc2 || bytes[0] > 0xf4 || length > left) return 0;
    for (size_t k = 1; k < length; k++)
        if ((bytes[k] & 0xc0) != 0x80) return 0;
    if (bytes[0] == 0xe0 && bytes[1] < 0xa0) return 0;
    if (bytes[0] == 0xed && bytes[1] > 0x9f) return 0;
    if (bytes[0] == 0xf0 && bytes[1] < 0x90) return 0;
    if (bytes[0] == 0xf4 && bytes[1] > 0x8f) return 0;
    return length;
}

static gneiss_status check_characters(const char *text, size_t length, const char *name,
                                      gneiss_error *error) {
    const unsigned char *s = (const unsigned char *)text;
    int line = 1, column = 1;
    for (size_t k = 0; k < length;) {
        size_t step = utf8_length(s + k, length - k);
        if (step == 0)
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "%s:%d:%d: expected UTF-8 text, found the byte 0x%02x: is this a scene file?", name,
                line, column, s[k]);
        column++;
        if (s[k] == '\n') {
            line++;
            column = 1;
        }
        k += step;
    }
    return GNEISS_OK;
}

gneiss_status gn_tree_read(const char *text, size_t length, const char *name, gn_tree **tree,
                           gneiss_error *error) {
    GN_TRY(check_characters(text, length, name, error));
    gn_tree *fresh = gn_alloc(sizeof *fresh);
    if (!fresh) return gn_fail(error, GNEISS_ERROR_MEMORY, "%s: out of memory", name);
    snprintf(fresh->name, sizeof fresh->name, "%s", name);
    gneiss_status status = read_yaml(fresh, text, length, NULL, &fresh->root, error);
    if (status == GNEISS_OK && (!fresh->root || fresh->root->kind != GN_NODE_MAP)) {
        gn_scene_place at = fresh->root ? fresh->root->where : (gn_scene_place){1, 1};
        status =
            gn_fail(error, GNEISS_ERROR_INPUT,
                    "%s:%d:%d: expected keys and their values such as 'title: a name', found %s",
                    name, at.line, at.column,
                    !fresh->root || fresh->root->kind == GN_NODE_NULL ? "an empty file"
                    : fresh->root->kind == GN_NODE_LIST               ? "a list"
                                                                      : "plain text");
    }
    if (status == GNEISS_OK)
        *tree = fresh;
    else
        gn_tree_free(fresh);
    return status;
}

void gn_tree_free(gn_tree *tree) {
    if (!tree) return;
    for (chunk *top = tree->chunks; top;) {
        chunk *next = top->next;
        gn_free(top);
        top = next;
    }
    gn_free(tree);
}

const gn_node *gn_tree_root(const gn_tree *tree) {
    return tree->root;
}

/* ---- looking up ---- */

static gn_node *child_span(const gn_node *map, const char *key, size_t length) {
    if (!map || map->kind != GN_NODE_MAP) return NULL;
    for (gn_node *child = map->first; child; child = child->next)
        if (strncmp(child->key, key, length) == 0 && child->key[length] == '\0') return child;
    return NULL;
}

const gn_node *gn_node_child(const gn_node *map, const char *key) {
    return child_span(map, key, strlen(key));
}

const gn_node *gn_node_find(const gn_node *map, const char *path) {
    while (map && *path) {
        size_t length = strcspn(path, ".");
        map = child_span(map, path, length);
        path += length + (path[length] == '.');
    }
    return map;
}

const gn_node *gn_node_item(const gn_node *list, size_t index) {
    if (!list || list->kind != GN_NODE_LIST || index >= list->count) return NULL;
    const gn_node *child = list->first;
    while (index--) child = child->next;
    return child;
}

/* ---- overrides ---- */

static gneiss_status fail_override(const gn_override *override, gneiss_error *error,
                                   const char *format, int length, const char *step) {
    char text[512];
    snprintf(text, sizeof text, format, length, step);
    return gn_fail(error, GNEISS_ERROR_INPUT, "--set %s: %s", override->key, text);
}

static gn_node *list_element(const gn_node *list, const char *step, size_t length) {
    if (strspn(step, "0123456789") >= length) {
        size_t index = 0;
        for (size_t k = 0; k < length && index <= list->count; k++)
            index = 10 * index + (size_t)(step[k] - '0');
        return (gn_node *)gn_node_item(list, index);
    }
    for (gn_node *child = list->first; child; child = child->next) {
        const gn_node *name = gn_node_child(child, "name");
        if (name && name->kind == GN_NODE_SCALAR && strncmp(name->text, step, length) == 0 &&
            name->text[length] == '\0')
            return child;
    }
    return NULL;
}

gn_node *gn_node_element(const gn_node *list, const char *name) {
    return list_element(list, name, strlen(name));
}

/* Fails with a message that lists the names of the list's elements. */
static gneiss_status no_such_element(const gn_node *list, const char *step, int shown,
                                     const gn_override *override, gneiss_error *error) {
    char wanted[96], advice[GN_ADVICE_SIZE] = "";
    snprintf(wanted, sizeof wanted, "%.*s", shown, step);
    gn_names names = gn_names_for(wanted);
    for (const gn_node *child = list->first; child; child = child->next) {
        const gn_node *name = gn_node_child(child, "name");
        if (name && name->kind == GN_NODE_SCALAR) gn_names_add(&names, name->text);
    }
    if (names.known[0]) gn_names_advice(&names, advice, sizeof advice);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "--set %s: no element '%s' in this list (index base 0, or name)%s",
                   override->key, wanted, advice);
}

/* Descends by one step of the key of an override; creates missing sections. */
static gneiss_status descend(gn_tree *tree, gn_node **at, const char *step, size_t length,
                             const gn_override *override, gneiss_error *error) {
    gn_node *node = *at, *child = NULL;
    int shown = length < 80 ? (int)length : 80;
    /* The section is empty in the file, or switched off. */
    const bool none = node->kind == GN_NODE_SCALAR && strcmp(node->text, "none") == 0;
    if (node->kind == GN_NODE_NULL || (none && *step != '[')) node->kind = GN_NODE_MAP;
    if (node->kind == GN_NODE_SCALAR)
        return fail_override(override, error, "'%.*s' is below a value, not in a section", shown,
                             step);
    if (node->kind == GN_NODE_LIST) {
        child = list_element(node, step, length);
        if (!child) return no_such_element(node, step, shown, override, error);
    } else {
        child = child_span(node, step, length);
    }
    if (!child) {
        child = tree_node(tree, GN_NODE_NULL, (gn_scene_place){0, 0});
        if (!child)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
        child->key = tree_text(tree, step, length);
        child->text = "";
        child->set = tree_text(tree, override->key, strlen(override->key));
        if (!child->key || !child->set)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
        append(node, child);
    }
    *at = child;
    return GNEISS_OK;
}

/* Makes the value of an override. Lists and sections are parsed as YAML; all other values are taken
 * literally, so that the shell needs no nested quotes. */
static gneiss_status override_value(gn_tree *tree, const gn_override *override, gn_node **value,
                                    gneiss_error *error) {
    const char *set = tree_text(tree, override->key, strlen(override->key));
    if (!set) return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
    const char *text = override->value;
    size_t length = strlen(text);
    if (check_characters(text, length, "", NULL) != GNEISS_OK)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set %s: expected UTF-8 text in the value",
                       override->key);
    while (length && (*text == ' ' || *text == '\t')) text++, length--;
    while (length && (text[length - 1] == ' ' || text[length - 1] == '\t')) length--;
    if (length && (*text == '[' || *text == '{'))
        return read_yaml(tree, text, length, set, value, error);
    *value = tree_node(tree, length ? GN_NODE_SCALAR : GN_NODE_NULL, (gn_scene_place){0, 0});
    if (!*value)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
    (*value)->set = set;
    (*value)->text = tree_text(tree, text, length);
    if ((*value)->text) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
}

/* Makes a list of defaults if the file omits it, because an override changes only one component. */
static gneiss_status default_list(gn_tree *tree, gn_node *node, const char *step,
                                  const gn_override *override, gneiss_error *error) {
    char path[256];
    int length = (int)(step - override->key) - 1;
    snprintf(path, sizeof path, "%.*s", length, override->key);
    const gn_key *key = length < (int)sizeof path ? gn_scene_key_at(path) : NULL;
    if (!key || !key->fallback || (key->type != GN_KEY_VECTOR && key->type != GN_KEY_SPIN))
        return fail_override(override, error,
                             "expected an existing list, such as by --set %.*s=[...]",
                             length < 200 ? length : 200, override->key);
    node->kind = GN_NODE_LIST;
    while (node->count < 3) {
        gn_node *item = tree_node(tree, GN_NODE_SCALAR, (gn_scene_place){0, 0});
        if (!item)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "--set %s: out of memory", override->key);
        item->text = key->fallback;
        item->set = node->set ? node->set : tree_text(tree, override->key, strlen(override->key));
        append(node, item);
    }
    return GNEISS_OK;
}

/* Returns the step of a key that begins at `from`, and advances `from` beyond it; returns false if
 * the text is not a key. */
static bool next_step(const char *key, const char **from, const char **step, size_t *length) {
    const char *at = *from;
    bool bracket = *at == '[' && at > key;
    if (bracket || (*at == '.' && at > key)) at++;
    *step = at;
    *length = strcspn(at, bracket ? "]" : ".[]");
    bool closed = bracket ? at[*length] == ']' : at[*length] != ']';
    *from = at + *length + bracket;
    return *length > 0 && closed && (!bracket || !**from || strchr(".[", **from));
}

void gn_tree_place(const gn_tree *tree, const char *key, char *place, size_t size) {
    const gn_node *at = tree->root;
    const char *step;
    size_t length, used = 0;
    place[0] = '\0';
    for (const char *from = key; *from && next_step(key, &from, &step, &length) && used < size;) {
        const gn_node *list = at && at->kind == GN_NODE_LIST ? at : NULL;
        at = list ? list_element(list, step, length) : child_span(at, step, length);
        size_t index = 0;
        for (const gn_node *item = at && list ? list->first : NULL; item && item != at;
             item = item->next)
            index++;
        used += (size_t)(at && list
                             ? snprintf(place + used, size - used, "%s%zu", used ? "." : "", index)
                             : snprintf(place + used, size - used, "%s%.*s", used ? "." : "",
                                        (int)length, step));
    }
}

/* Removes places, because those in the text of an override are not places in the file. */
static void forget_places(gn_node *node) {
    node->where = node->key_where = (gn_scene_place){0, 0};
    for (gn_node *child = node->first; child; child = child->next) forget_places(child);
}

gneiss_status gn_tree_override(gn_tree *tree, const gn_override *override, gneiss_error *error) {
    if (!override->key || !override->value || !*override->key)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: expected key=value such as time.end=2ms");
    if (check_characters(override->key, strlen(override->key), "", NULL) != GNEISS_OK)
        return gn_fail(error, GNEISS_ERROR_INPUT, "--set: expected UTF-8 text in the key");
    gn_node *at = tree->root, *value = NULL;
    for (const char *from = override->key, *step; *from;) {
        size_t length;
        if (!next_step(override->key, &from, &step, &length))
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "--set %s: expected a key such as walls.top.motion.vz or materials[0].density",
                override->key);
        if (at->kind == GN_NODE_NULL && strspn(step, "0123456789") >= length)
            GN_TRY(default_list(tree, at, step, override, error));
        GN_TRY(descend(tree, &at, step, length, override, error));
    }
    GN_TRY(override_value(tree, override, &value, error));
    if (!value) return gn_fail(error, GNEISS_ERROR_INPUT, "--set %s: no value", override->key);
    forget_places(value);
    /* The new value replaces the old one in its parent. */
    at->kind = value->kind;
    at->text = value->text;
    at->set = value->set;
    at->where = at->key_where = (gn_scene_place){0, 0};
    at->count = value->count;
    at->first = value->first;
    at->last = value->last;
    return GNEISS_OK;
}
