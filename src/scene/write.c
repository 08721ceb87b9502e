#include "scene/formula.h"
#include "scene/manifest.h"
#include "scene/tree.h"

#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes a number; %.17g reproduces the same double. */
static void write_number(FILE *out, double value) {
    fprintf(out, "%.17g", value);
}

static void write_numbers(FILE *out, const double *values, size_t count) {
    for (size_t k = 0; k < count; k++) fprintf(out, "%s%.17g", k ? ", " : "[", values[k]);
    fputc(']', out);
}

static void write_text(FILE *out, const char *text) {
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\') fputc('\\', out);
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            fprintf(out, "\\x%02x", (unsigned)(unsigned char)*c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

static void write_table(FILE *out, const gn_key *key, const gn_table *table) {
    if (table->formula) {
        write_text(out, gn_formula_text(table->formula));
    } else if (table->count == 0) {
        fputs(key->word ? key->word : "[]", out);
    } else if (table->count == 1 && table->time[0] == 0 && !signbit(table->time[0])) {
        write_number(out, table->value[0]);
    } else {
        for (size_t k = 0; k < table->count; k++)
            fprintf(out, "%s[%.17g, %.17g]", k ? ", " : "[", table->time[k], table->value[k]);
        fputc(']', out);
    }
}

/* Writes a vector, whose components may vary over time. */
static void write_vector(FILE *out, const gn_key *key, const char *base) {
    const double *value = (const double *)(const void *)(base + key->offset);
    const gn_table *over_time = (const gn_table *)(const void *)(base + key->second);
    for (int a = 0; a < 3; a++) {
        fputs(a ? ", " : "[", out);
        if (key->second && over_time[a].count)
            write_table(out, key, &over_time[a]);
        else
            write_number(out, value[a]);
    }
    fputc(']', out);
}

static void write_integers(FILE *out, const int64_t *values, size_t count) {
    for (size_t k = 0; k < count; k++) fprintf(out, "%s%" PRId64, k ? ", " : "[", values[k]);
    fputc(']', out);
}

static void write_names(FILE *out, const char (*names)[GN_NAME_SIZE], size_t count) {
    for (size_t k = 0; k < count; k++) {
        if (count > 1) fputs(k ? ", " : "[", out);
        write_text(out, names[k]);
    }
    if (count > 1) fputc(']', out);
}

static void write_points(FILE *out, const double *points, size_t count) {
    for (size_t k = 0; k < count; k++) {
        fputs(k ? ", " : "[", out);
        write_numbers(out, points + 2 * k, 2);
    }
    fputc(']', out);
}

/* Writes rows of particles, or their requested number. */
static void write_particles(FILE *out, const gn_key *key, const char *base, bool plane,
                            int indent) {
    const double *particles;
    memcpy(&particles, base + key->offset, sizeof particles);
    size_t count = *(const size_t *)(base + key->second);
    if (!count) fprintf(out, " %" PRId64, *(const int64_t *)(base + key->number));
    for (size_t k = 0; k < count; k++) {
        const double *p = particles + 4 * k;
        double row[4] = {p[0], p[1], plane ? p[3] : p[2], p[3]};
        fprintf(out, "\n%*s- ", indent + 2, "");
        write_numbers(out, row, plane ? 3 : 4);
    }
}

/* Writes a node in one line. A quoted scalar is read back as the same text. */
static void write_node(FILE *out, const gn_node *node) {
    bool map = node->kind == GN_NODE_MAP;
    if (node->kind == GN_NODE_NULL) return;
    if (node->kind == GN_NODE_SCALAR) {
        write_text(out, node->text);
        return;
    }
    fputc(map ? '{' : '[', out);
    for (const gn_node *child = node->first; child; child = child->next) {
        if (child != node->first) fputs(", ", out);
        if (map) {
            write_text(out, child->key);
            fputs(": ", out);
        }
        write_node(out, child);
    }
    fputc(map ? '}' : ']', out);
}

char *gn_node_write(const gn_node *map, const gn_section *without) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return NULL;
    for (const gn_node *child = map->first; child; child = child->next) {
        bool own = false;
        for (size_t k = 0; k < without->key_count; k++)
            own = own || strcmp(without->keys[k].name, child->key) == 0;
        if (own) continue;
        write_text(out, child->key);
        fputs(": ", out);
        write_node(out, child);
        fputc('\n', out);
    }
    bool failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
    if (!failed) return text;
    free(text);
    return NULL;
}

static void write_real(FILE *out, const gn_key *key, double value) {
    if (key->word && value == key->word_value)
        fputs(key->word, out);
    else if (key->other_word && value == key->other_value)
        fputs(key->other_word, out);
    else
        write_number(out, value);
}

static void write_value(FILE *out, const gn_key *key, const char *base, bool plane, int indent) {
    const char *at = base + key->offset;
    const void *array = NULL;
    if (gn_key_element_size(key)) memcpy(&array, at, sizeof array);
    switch (key->type) {
    case GN_KEY_REAL:
        write_real(out, key, *(const double *)at);
        break;
    case GN_KEY_INTEGER:
        if (key->word && (double)*(const int64_t *)at == key->word_value)
            fputs(key->word, out);
        else
            fprintf(out, "%" PRId64, *(const int64_t *)at);
        break;
    case GN_KEY_SEED:
        fprintf(out, "%" PRIu64, *(const uint64_t *)at);
        break;
    case GN_KEY_TEXT:
    case GN_KEY_NAME:
        write_text(out, at);
        break;
    case GN_KEY_FILE:
        write_text(out, base + key->second);
        break;
    case GN_KEY_CHOICE:
        fputs(gn_choice_name(key->choices, gn_choice_load(key, at)), out);
        break;
    case GN_KEY_VECTOR:
        write_vector(out, key, base);
        break;
    case GN_KEY_SPIN:
        write_numbers(out, (const double *)at, 3);
        break;
    case GN_KEY_CELLS:
        write_integers(out, (const int64_t *)at, 3);
        break;
    case GN_KEY_TABLE:
        write_table(out, key, (const gn_table *)at);
        break;
    case GN_KEY_IDS:
        write_integers(out, array, *(const size_t *)(base + key->second));
        break;
    case GN_KEY_NAMES:
        write_names(out, array, *(const size_t *)(base + key->second));
        break;
    case GN_KEY_PARTICLES:
        write_particles(out, key, base, plane, indent);
        break;
    case GN_KEY_POINTS:
        write_points(out, array, *(const size_t *)(base + key->second));
        break;
    case GN_KEY_TREE: /* no key of a scene is of this type */
    case GN_KEY_CHANGES:
    case GN_KEY_SECTION:
    case GN_KEY_LIST:
        break;
    }
}

static void write_section(FILE *out, const gn_section *section, const char *base, bool plane,
                          int indent, bool element);

static void write_list(FILE *out, const gn_key *key, const char *base, bool plane, int indent) {
    const char *array;
    memcpy(&array, base + key->offset, sizeof array);
    size_t count = *(const size_t *)(base + key->second);
    fputs(count ? "\n" : " []\n", out);
    for (size_t k = 0; k < count; k++)
        write_section(out, key->section, array + k * key->section->size, plane, indent + 4, true);
}

/* Writes changes on separate lines, indented like the other keys of the element. */
static void write_changes(FILE *out, const gn_key *key, const char *base, int indent) {
    const char *line;
    memcpy(&line, base + key->offset, sizeof line);
    for (; line && *line; line += strcspn(line, "\n") + 1)
        fprintf(out, "%*s%.*s\n", indent, "", (int)strcspn(line, "\n"), line);
}

/* Writes a section; `element`: its first key follows the dash of a list. */
static void write_section(FILE *out, const gn_section *section, const char *base, bool plane,
                          int indent, bool element) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        if (!gn_key_present(key, base)) continue;
        if (key->type == GN_KEY_CHANGES) {
            write_changes(out, key, base, indent);
            continue;
        }
        if (element)
            fprintf(out, "%*s- %s:", indent - 2, "", key->name);
        else
            fprintf(out, "%*s%s:", indent, "", key->name);
        element = false;
        if (key->type == GN_KEY_SECTION) {
            fputc('\n', out);
            write_section(out, key->section, base + key->offset, plane, indent + 2, false);
        } else if (key->type == GN_KEY_LIST) {
            write_list(out, key, base, plane, indent);
        } else {
            if (key->type != GN_KEY_PARTICLES) fputc(' ', out);
            write_value(out, key, base, plane, indent);
            fputc('\n', out);
        }
    }
}

static void write_all(FILE *out, const gn_scene *scene) {
    write_section(out, &gn_scene_section, (const char *)scene, scene->dimension == 2, 0, false);
}

static void write_specimen(FILE *out, const gn_scene *scene) {
    fprintf(out, "dimension: %" PRId64 "\nspecimen:\n", scene->dimension);
    write_section(out, &gn_specimen_section, (const char *)scene, scene->dimension == 2, 2, false);
    fprintf(out, "run:\n  seed: %" PRIu64 "\n", scene->seed);
}

static char *write_with(void (*write)(FILE *out, const gn_scene *scene), const gn_scene *scene) {
    char *text = NULL;
    size_t size = 0;
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    FILE *out = c_locale ? open_memstream(&text, &size) : NULL;
    if (!out) {
        if (c_locale) freelocale(c_locale);
        return NULL;
    }
    locale_t previous = uselocale(c_locale);
    write(out, scene);
    bool failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
    uselocale(previous);
    freelocale(c_locale);
    if (!failed) return text;
    free(text);
    return NULL;
}

char *gn_scene_write(const gn_scene *scene) {
    return write_with(write_all, scene);
}

char *gn_scene_write_specimen(const gn_scene *scene) {
    return write_with(write_specimen, scene);
}
