#include "cli/explain.h"

#include "scene/foreign.h"
#include "scene/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a value that a key accepts ---- */

static bool is_accepted(gn_units *units, const gn_key *key, const char *text) {
    const char *unit = key->unit ? key->unit : "1", *bar = strchr(unit, '|');
    const bool slope = strcmp(unit, GN_SLOPE) == 0;
    char reason[96];
    double value = 0.0;
    return gn_units_read(units, text,
                         slope ? "1"
                         : bar ? "1/s"
                               : unit,
                         &value, reason, sizeof reason) &&
           (!key->range || gn_range_holds(key->range, value));
}

/* Writes the example of the unit, "23 mm", or a number within the range. */
static void write_quantity(const gn_key *key, char *text, size_t size) {
    const char *of_unit = strchr(gn_unit_text(key->unit ? key->unit : "1"), '\'');
    const gn_range range = gn_range_read(key->range);
    gn_units *units = gn_units_new();
    snprintf(text, size, "%.*s", of_unit ? (int)strcspn(of_unit + 1, "'") : 0,
             of_unit ? of_unit + 1 : "");
    if (units && !is_accepted(units, key, text)) {
        const double middle =
            isfinite(range.high) ? 0.5 * (range.low + range.high) : range.low + 1.0;
        snprintf(text, size, "%.3g", isfinite(middle) ? middle : 1.0);
    }
    gn_units_free(units);
}

static void write_whole(const gn_key *key, char *text, size_t size) {
    const gn_range range = gn_range_read(key->range);
    const double usual = key->type == GN_KEY_CELLS ? 10.0 : 4.0;
    const double value = usual < range.low ? range.low : usual > range.high ? range.high : usual;
    snprintf(text, size, "%.0f", value);
}

static void write_choice(const gn_key *key, char *text, size_t size) {
    const gn_choice *choice = key->choices;
    while (choice[1].name && key->fallback && strcmp(choice->name, key->fallback) == 0) choice++;
    snprintf(text, size, "%s", choice->name);
}

static void write_vector(const gn_key *key, int dimension, char *text, size_t size) {
    char one[64];
    const bool plane = dimension == 2 && key->shape_dimension != 3;
    if (key->type == GN_KEY_CELLS)
        write_whole(key, one, sizeof one);
    else if (strcmp(key->name, "min") == 0) /* beside the example of max, which is above 0 */
        snprintf(one, sizeof one, "0");
    else
        write_quantity(key, one, sizeof one);
    if (plane && key->type == GN_KEY_SPIN)
        snprintf(text, size, "%s", one);
    else
        snprintf(text, size, "[%s, %s%s%s]", one, one, plane ? "" : ", ", plane ? "" : one);
}

static void write_points(const gn_key *key, char *text, size_t size) {
    char one[64];
    write_quantity(key, one, sizeof one);
    if (strcmp(key->unit, "1") == 0)
        snprintf(text, size, "[[0.5, 0], [1, 1]]");
    else
        snprintf(text, size, "[[0, 0], [%s, 0], [0, %s]]", one, one);
}

static const char *name_of(const gn_key *key) {
    static const char *const names[][2] = {{"title", "Sandstone, 50 mm"},
                                           {"file", "packing.txt"},
                                           {"surface", "body.stl"},
                                           {"mesh", "body.msh"},
                                           {"from", "runs/first"},
                                           {"directory", "runs/first"},
                                           {"lower", "bottom"},
                                           {"upper", "top"},
                                           {"material", "rock"},
                                           {"tool", "disc"},
                                           {"between", "[rock, steel]"},
                                           {"fields", "[fragment]"},
                                           {"confinement", "[5 MPa, 10 MPa, 20 MPa]"}};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (strcmp(key->name, names[k][0]) == 0) return names[k][1];
    return "rock";
}

/* Writes "{a: 1, b: 2}" with the required keys of a section, or with its first key. */
static void write_section(const gn_section *section, int dimension, char *text, size_t size) {
    char value[512];
    size_t used = (size_t)snprintf(text, size, "{");
    for (size_t k = 0; k < section->key_count && used < size; k++) {
        const gn_key *key = &section->keys[k];
        const bool none_required = used == 1 && k + 1 == section->key_count;
        if (!key->required && !none_required) continue;
        if (none_required) key = section->keys;
        gn_key_example(key, dimension, value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s: %s", used > 1 ? ", " : "",
                                 key->name, value);
    }
    if (used < size) snprintf(text + used, size - used, "}");
}

void gn_key_example(const gn_key *key, int dimension, char *text, size_t size) {
    char inner[1024];
    switch (key->type) {
    case GN_KEY_REAL:
    case GN_KEY_TABLE:
        write_quantity(key, text, size);
        break;
    case GN_KEY_INTEGER:
    case GN_KEY_SEED:
        write_whole(key, text, size);
        break;
    case GN_KEY_CHOICE:
        write_choice(key, text, size);
        break;
    case GN_KEY_VECTOR:
    case GN_KEY_SPIN:
    case GN_KEY_CELLS:
        write_vector(key, dimension, text, size);
        break;
    case GN_KEY_IDS:
        snprintf(text, size, "[0, 1, 2]");
        break;
    case GN_KEY_PARTICLES:
        snprintf(text, size, "1000");
        break;
    case GN_KEY_POINTS:
        write_points(key, text, size);
        break;
    case GN_KEY_SECTION:
    case GN_KEY_LIST:
        write_section(key->section, dimension, inner, sizeof inner);
        snprintf(text, size, key->type == GN_KEY_LIST ? "[%s]" : "%s", inner);
        break;
    default:
        snprintf(text, size, "%s", name_of(key));
    }
}

/* ---- surrounding lines ---- */

static const gn_key *key_named(const gn_section *section, const char *name, size_t length) {
    for (size_t k = 0; k < section->key_count; k++)
        if (strncmp(section->keys[k].name, name, length) == 0 && !section->keys[k].name[length])
            return &section->keys[k];
    return NULL;
}

/* Returns a name for an element of a list. */
static const char *element_name(const char *list) {
    static const char *const names[][2] = {
        {"walls", "top"},    {"bodies", "drum"},  {"sets", "left"},    {"stages", "confine"},
        {"sources", "feed"}, {"sinks", "outlet"}, {"motions", "load"}, {"loads", "weight"}};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (strcmp(list, names[k][0]) == 0) return names[k][1];
    return "rock";
}

/* Prints the sections above a key, with a name for each element of a list. */
static void print_example(const char *path, int dimension) {
    const gn_section *section = &gn_scene_section;
    const char *dash = "";
    char value[1200];
    for (int indent = 4; *path; indent += 2) {
        const size_t length = strcspn(path, ".[");
        const gn_key *key = key_named(section, path, length), *name;
        path += length;
        path += strspn(path, "[]");
        path += *path == '.';
        printf("%*s%s%s:", indent - (int)strlen(dash), "", dash, key->name);
        dash = "";
        if (*path)
            puts("");
        else {
            gn_key_example(key, dimension, value, sizeof value);
            printf(" %s\n", value);
        }
        section = key->section;
        if (key->type != GN_KEY_LIST || !*path) continue;
        indent += 2;
        name = key_named(section, "name", 4);
        if (name && strcmp(path, "name") != 0)
            printf("%*s- name: %s\n", indent, "", element_name(key->name));
        else
            dash = "- ";
    }
}

/* ---- finding the key ---- */

/* Compares a path such as "walls[].motion.vz" with a given one, which may also name an element or
 * leave it out: walls.top.motion.vz, walls[0].motion.vz, walls.motion.vz. */
static bool is_path(const char *own, const char *given) {
    for (;;) {
        const size_t length = strcspn(own, ".[");
        if (strncmp(own, given, length) != 0 || !strchr(".[", given[length])) return false;
        own += length;
        given += length;
        const bool list = *own == '[';
        own += strspn(own, "[]");
        if (*given == '[') given += strcspn(given, "]") + 1;
        if (!*own) return !*given;
        if (*given != '.') return false;
        own++, given++;
        const size_t next = strcspn(own, ".[");
        if (list && (strncmp(own, given, next) != 0 || !strchr(".[", given[next]))) {
            given += strcspn(given, ".");
            given += *given == '.';
        }
    }
}

/* True if a path ends with the given words. */
static bool ends_with(const char *own, const char *given) {
    for (const char *at = own; at; at = strchr(at, '.')) {
        at += *at == '.';
        if (is_path(at, given)) return true;
    }
    return false;
}

enum { FOUND_MOST = 64 };
typedef struct search {
    const char *given;
    bool exact;
    size_t count;
    struct {
        char path[GN_KEY_PATH_SIZE];
        const gn_key *key;
    } found[FOUND_MOST];
} search;

static void look_at(void *context, const char *path, const gn_key *key) {
    search *s = context;
    const bool exact = is_path(path, s->given);
    if (s->exact || s->count == FOUND_MOST || !(exact || ends_with(path, s->given))) return;
    if (exact) s->count = 0;
    s->exact = exact;
    snprintf(s->found[s->count].path, GN_KEY_PATH_SIZE, "%s", path);
    s->found[s->count++].key = key;
}

/* ---- output ---- */

static void print_pages(const char *path) {
    bool any = false;
    for (const gn_key_page *p = gn_key_pages; p->key; p++) {
        if (strcmp(p->key, path) != 0) continue;
        if (!any) fputs("\npages:\n", stdout);
        printf("    %s\n", p->page);
        any = true;
    }
}

static int dimension_of(const char *path) {
    const gn_section *section = &gn_scene_section;
    int dimension = 3;
    while (*path) {
        const size_t length = strcspn(path, ".[");
        const gn_key *key = key_named(section, path, length);
        if (key->shape_dimension) dimension = key->shape_dimension;
        path += length;
        path += strspn(path, "[].");
        section = key->section;
    }
    return dimension;
}

static void print_key(const char *path, const gn_key *key) {
    char type[GN_KEY_TYPE_SIZE], fallback[96];
    gn_key_describe(key, type, sizeof type);
    gn_key_default(key, fallback, sizeof fallback);
    const int dimension = dimension_of(path);
    printf("%s: %s\n\n", path, key->text);
    printf("value:   %s\n", type);
    if (key->unit && key->type != GN_KEY_TREE && key->type != GN_KEY_CHANGES)
        printf("unit:    %s\n", gn_unit_text(key->unit));
    if (*fallback) printf("default: %s\n", fallback);
    if (key->shape_dimension) printf("scenes:  of dimension %d\n", key->shape_dimension);
    for (size_t k = 0; key->section && k < key->section->key_count; k++)
        printf("%s%s%s", k ? ", " : "keys:    ", key->section->keys[k].name,
               k + 1 < key->section->key_count ? "" : "\n");
    if (key->type != GN_KEY_CHANGES) {
        printf("\nexample:\n%s", dimension == 2 ? "    dimension: 2\n" : "");
        print_example(path, dimension);
    }
    print_pages(path);
}

gneiss_status gn_command_explain(const gn_options *options, gneiss_error *error) {
    char nearest[GN_KEY_PATH_SIZE], meaning[GN_FOREIGN_SIZE];
    search s = {.given = options->target};
    gn_scene_visit_keys(look_at, &s);
    if (s.count == 1) {
        print_key(s.found[0].path, s.found[0].key);
        return GNEISS_OK;
    }
    if (s.count) printf("%zu keys have this name; gneiss explain PATH explains one:\n", s.count);
    for (size_t k = 0; k < s.count; k++)
        printf("%s\n    %s\n", s.found[k].path, s.found[k].key->text);
    if (s.count) return GNEISS_OK;
    const gn_foreign_name *foreign = gn_foreign_next(options->target, NULL);
    if (foreign) {
        gn_foreign_describe(foreign, meaning, sizeof meaning);
        printf("%s\n\n", meaning);
        print_key(foreign->key, gn_scene_key_at(foreign->key));
        return GNEISS_OK;
    }
    const bool meant = gn_scene_nearest_key(options->target, nearest, sizeof nearest);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "explain: expected a key such as walls.motion.vz, found '%s'%s%s%s",
                   options->target, meant ? "; did you mean '" : "", meant ? nearest : "",
                   meant ? "'?" : " (gneiss keys TEXT searches them)");
}
