#include "io/io.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct buffer {
    char *data;
    size_t size, capacity;
    bool failed;
} buffer;

/* The text is built on one line; gn_json_finish indents it. */
struct gn_json {
    buffer text;
    buffer open;  /* the open levels, as the characters that close them */
    bool has_one; /* the innermost object or array is not empty */
};

static void append(buffer *to, const char *text, size_t size) {
    if (to->failed) return;
    if (to->size + size + 1 > to->capacity) {
        size_t capacity = 2 * (to->size + size + 1);
        char *more = realloc(to->data, capacity);
        if (!more) {
            to->failed = true;
            return;
        }
        to->data = more;
        to->capacity = capacity;
    }
    memcpy(to->data + to->size, text, size);
    to->size += size;
    to->data[to->size] = '\0';
}

static void append_char(buffer *to, char character) {
    append(to, &character, 1);
}

static char innermost(const gn_json *json) {
    return json->open.size ? json->open.data[json->open.size - 1] : '\0';
}

/* Returns the length of the UTF-8 character at `text`; 0: it is not a valid one (RFC 3629: shortest
 * form, no surrogates). */
static size_t utf8_length(const unsigned char *text) {
    unsigned char first = text[0];
    if (first < 0x80) return 1;
    size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4) return 0;
    for (size_t k = 1; k < length; k++)
        if ((text[k] & 0xc0) != 0x80) return 0;
    bool overlong = (first == 0xe0 && text[1] < 0xa0) || (first == 0xf0 && text[1] < 0x90);
    bool beyond = (first == 0xed && text[1] > 0x9f) || (first == 0xf4 && text[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}

static void append_quoted(buffer *to, const char *text) {
    append_char(to, '"');
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        size_t length = utf8_length(c);
        char escape[8];
        if (length == 0) {
            append(to, "\\ufffd", 6);
            length = 1;
        } else if (*c == '"' || *c == '\\') {
            append(to, (char[]){'\\', (char)*c}, 2);
        } else if (*c == '\n') {
            append(to, "\\n", 2);
        } else if (*c < 0x20 || *c == 0x7f) {
            append(to, escape, (size_t)snprintf(escape, sizeof escape, "\\u%04x", *c));
        } else {
            append(to, (const char *)c, length);
        }
        c += length;
    }
    append_char(to, '"');
}

/* Writes the prefix of a value: a comma, and its key inside an object. */
static void begin_value(gn_json *json, const char *key) {
    if (json->has_one) append_char(&json->text, ',');
    json->has_one = true;
    if (innermost(json) != '}') return;
    append_quoted(&json->text, key ? key : "");
    append_char(&json->text, ':');
}

static void open_value(gn_json *json, char opening, char closing) {
    append_char(&json->text, opening);
    append_char(&json->open, closing);
    json->has_one = false;
}

gn_json *gn_json_begin(void) {
    gn_json *json = calloc(1, sizeof *json);
    if (json) open_value(json, '{', '}');
    return json;
}

void gn_json_object(gn_json *json, const char *key) {
    if (!json) return;
    begin_value(json, key);
    open_value(json, '{', '}');
}

void gn_json_array(gn_json *json, const char *key) {
    if (!json) return;
    begin_value(json, key);
    open_value(json, '[', ']');
}

static void close_innermost(gn_json *json) {
    append_char(&json->text, innermost(json));
    json->open.size--;
    json->has_one = true;
}

void gn_json_end(gn_json *json) {
    if (json && json->open.size > 1)
        close_innermost(json); /* gn_json_finish closes the outermost object */
}

static void append_raw(gn_json *json, const char *key, const char *text) {
    if (!json) return;
    begin_value(json, key);
    append(&json->text, text, strlen(text));
}

/* Writes the shortest form that reads back as the same double. */
static void format_number(char text[40], double value) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 40, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    /* A program that uses the library may have set a locale with a decimal comma. */
    char *comma = strchr(text, ',');
    if (comma) *comma = '.';
}

void gn_json_number(gn_json *json, const char *key, double value) {
    char text[40] = "null";
    if (isfinite(value)) format_number(text, value);
    append_raw(json, key, text);
}

void gn_json_numbers(gn_json *json, const gn_json_pair *pairs, size_t count) {
    for (size_t k = 0; k < count; k++) gn_json_number(json, pairs[k].key, pairs[k].value);
}

void gn_json_integer(gn_json *json, const char *key, int64_t value) {
    char text[24];
    snprintf(text, sizeof text, "%" PRId64, value);
    append_raw(json, key, text);
}

void gn_json_text(gn_json *json, const char *key, const char *value) {
    if (!json) return;
    begin_value(json, key);
    if (value)
        append_quoted(&json->text, value);
    else
        append(&json->text, "null", 4);
}

void gn_json_bool(gn_json *json, const char *key, bool value) {
    append_raw(json, key, value ? "true" : "false");
}

static void new_line(buffer *to, size_t depth) {
    append_char(to, '\n');
    for (size_t k = 0; k < depth; k++) append(to, "  ", 2);
}

/* Indents by two blanks per level; empty objects and arrays stay on one line; the text ends with a
 * newline. */
static buffer indent(const buffer *text) {
    buffer to = {0};
    size_t depth = 0;
    bool quoted = false;
    for (const char *c = text->data; *c; c++) {
        bool opens = *c == '{' || *c == '[', closes = *c == '}' || *c == ']';
        bool empty = opens && (c[1] == '}' || c[1] == ']');
        if (!quoted && closes) new_line(&to, --depth);
        append_char(&to, *c);
        if (quoted && *c == '\\')
            append_char(&to, *++c);
        else if (*c == '"')
            quoted = !quoted;
        if (quoted || *c == '"') continue;
        if (empty)
            append_char(&to, *++c);
        else if (opens)
            new_line(&to, ++depth);
        else if (*c == ',')
            new_line(&to, depth);
        else if (*c == ':')
            append_char(&to, ' ');
    }
    append_char(&to, '\n');
    return to;
}

char *gn_json_finish(gn_json *json, bool pretty) {
    if (!json) return NULL;
    while (json->open.size > 0 && !json->open.failed) close_innermost(json);
    buffer text = json->text;
    text.failed = text.failed || json->open.failed;
    if (pretty && !text.failed) {
        text = indent(&json->text);
        free(json->text.data);
    }
    free(json->open.data);
    free(json);
    if (!text.failed) return text.data;
    free(text.data);
    return NULL;
}
