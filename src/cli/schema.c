/* JSON Schemas (draft 7, which editors support) made from the tables of keys. */
#include "cli/schema.h"

#include "base/version.h"
#include "cli/script.h"
#include "scene/manifest.h"
#include "scene/stages.h"
#include "sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* State of writing a schema. A file has one dimension, which decides the lengths of vectors and the
 * possible shapes. The schema contains the keys of both dimensions and selects them by the value of
 * `dimension`. */
typedef struct schema {
    FILE *out;
    int dimension;
    bool specimen_only; /* keys that `gneiss pack` does not read may have any value */
    bool in_stage;      /* writes keys that a stage may change; none of them is required */
} schema;

/* ---- texts ---- */

/* Regular expressions that ECMA-262 and Python read alike; src/scene/units.c has the grammar. A
 * minus sign is allowed before zero. */
#define DIGITS   "(?:[0-9]+\\.?[0-9]*|\\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
#define NUMBER   "(?!0[xX])" DIGITS
#define ANY_SIGN "^ *[+-]?"
#define NO_MINUS "^ *(?:\\+|-(?=0*\\.?0*(?:[^0-9.]|$)))?"
#define LETTER   "[^\\x00-\\x24\\x26-\\x40\\x5b-\\x5e\\x60\\x7b-\\x7f]"
#define FACTOR   "(?!(?:since|after|from|ref|per)(?!" LETTER "))" LETTER "+(?:\\^?[+-]?[1-9])?"
#define UNIT     "(?: *(?:1/)?" FACTOR "(?: *[./*] *" FACTOR "| +" FACTOR ")*)? *$"

static const struct {
    const char *name, *text, *pattern;
} texts[] = {
    {"quantity", "a number with a unit", ANY_SIGN NUMBER UNIT},
    {"positive_quantity", "a number with a unit, without minus", NO_MINUS NUMBER UNIT},
    {"fraction", "a number or a percentage", ANY_SIGN NUMBER " *%? *$"},
    {"positive_fraction", "a number or a percentage, without minus", NO_MINUS NUMBER " *%? *$"},
    {"number", "a number without unit", ANY_SIGN NUMBER " *$"},
    {"positive_number", "a number without unit and minus", NO_MINUS NUMBER " *$"},
    {"whole", "a whole number", "^[+-]?[0-9]+(?:[eE]\\+?[0-9]+)?$"},
    {"zero", "zero, with or without unit", ANY_SIGN "(?:0+\\.?0*|\\.0+)(?:[eE][+-]?[0-9]+)?" UNIT},
    {"text", "text without control characters", "^[^\\x00-\\x1f\\x7f]*$"},
    {"formula", "a formula of t in SI units", "(?:^|[^A-Za-z0-9_.])t(?![A-Za-z0-9_])"},
    {"name", "a name: not empty, not a number, without . / [ ] = and control characters",
     "^(?! *[+-]?" DIGITS "$)(?! *[+-]?(?:inf|infinity|nan)$)[^./\\[\\]=\\x00-\\x1f\\x7f]+$"},
};
enum { TEXTS = sizeof texts / sizeof *texts };

static void write_quoted(FILE *out, const char *text) {
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') fputc('\\', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

static void write_definitions(FILE *out) {
    for (size_t k = 0; k < TEXTS; k++) {
        fprintf(out,
                "%s\n\"%s\":{\"description\":\"%s\",\"type\":\"string\",\"pattern\":", k ? "," : "",
                texts[k].name, texts[k].text);
        write_quoted(out, texts[k].pattern);
        fputc('}', out);
    }
}

/* ---- values: the alternatives of a key, or of an item in a list ---- */

static void write_limits(FILE *out, const char *range) {
    const gn_range r = gn_range_read(range);
    if (isfinite(r.low))
        fprintf(out, ",\"%s\":%.15g", r.low_open ? "exclusiveMinimum" : "minimum", r.low);
    if (isfinite(r.high))
        fprintf(out, ",\"%s\":%.15g", r.high_open ? "exclusiveMaximum" : "maximum", r.high);
}

static void write_whole(FILE *out, const char *range) {
    fputs("{\"type\":\"integer\"", out);
    write_limits(out, range);
    fputs("},{\"$ref\":\"#/definitions/whole\"}", out);
}

/* Writes the schema of a number in SI, or a text with a unit. */
static void write_number(FILE *out, const char *unit, const char *range) {
    const bool plain = strcmp(unit, GN_PLAIN_NUMBER) == 0, fraction = strcmp(unit, "1") == 0;
    fputs("{\"type\":\"number\"", out);
    write_limits(out, range);
    fprintf(out, "},{\"$ref\":\"#/definitions/%s%s\"}",
            gn_range_read(range).low >= 0.0 ? "positive_" : "",
            plain      ? "number"
            : fraction ? "fraction"
                       : "quantity");
}

static const char *unit_of(const gn_key *key) {
    return key->unit ? key->unit : "1";
}

static void write_word(FILE *out, const char *word) {
    if (word) fprintf(out, ",{\"const\":\"%s\"}", word);
}

static void open_array(FILE *out, size_t least, size_t most) {
    fprintf(out, "{\"type\":\"array\",\"minItems\":%zu", least);
    if (most) fprintf(out, ",\"maxItems\":%zu", most);
    fputs(",\"items\":", out);
}

/* Writes the schema of a list of `count` numbers, each with its unit and range; NULL as a unit:
 * only zero. */
static void write_row(FILE *out, size_t least, size_t count, const char *const units[],
                      const char *const ranges[]) {
    open_array(out, least, count);
    for (size_t k = 0; k < count; k++) {
        fprintf(out, "%s{\"anyOf\":[", k ? "," : "[");
        if (units[k])
            write_number(out, units[k], ranges[k]);
        else
            fputs("{\"const\":0},{\"$ref\":\"#/definitions/zero\"}", out);
        fputs("]}", out);
    }
    fputs("]}", out);
}

static void write_table(FILE *out, const gn_key *key) {
    write_number(out, unit_of(key), key->range);
    fputs(",{\"$ref\":\"#/definitions/formula\"},", out);
    open_array(out, 1, 0);
    write_row(out, 2, 2, (const char *const[]){"s", unit_of(key)},
              (const char *const[]){NULL, key->range});
    fputc('}', out);
}

/* Writes the schema of a vector whose components may vary over time. */
static void write_varying(const schema *s, const gn_key *key) {
    open_array(s->out, s->dimension == 2 ? 2 : 3, 3);
    for (int k = 0; k < 3; k++) {
        fprintf(s->out, "%s{\"anyOf\":[", k ? "," : "[");
        if (k < s->dimension)
            write_table(s->out, key);
        else
            fputs("{\"const\":0},{\"$ref\":\"#/definitions/zero\"}", s->out);
        fputs("]}", s->out);
    }
    fputs("]}", s->out);
}

/* Writes the schema of a vector. In 2D it may have a third component, which is zero; a spin is a
 * number or is directed along z. */
static void write_vector(const schema *s, const gn_key *key) {
    const bool plane = s->dimension == 2 && key->shape_dimension != 3,
               spin = key->type == GN_KEY_SPIN;
    const char *const all = unit_of(key), *const ranges[] = {key->range, key->range, key->range};
    const char *const units[] = {plane && spin ? NULL : all, plane && spin ? NULL : all,
                                 plane && !spin ? NULL : all};
    if (plane && spin) {
        write_number(s->out, all, key->range);
        fputc(',', s->out);
    }
    write_row(s->out, plane && !spin ? 2 : 3, 3, units, ranges);
}

static void write_wholes(FILE *out, size_t least, size_t most, const char *range) {
    open_array(out, least, most);
    fputs("{\"anyOf\":[", out);
    write_whole(out, range);
    fputs("]}}", out);
}

static void write_points(const schema *s, const gn_key *key) {
    const bool particles = key->type == GN_KEY_PARTICLES;
    const char *const units[] = {unit_of(key), unit_of(key), unit_of(key), unit_of(key)};
    const char *const point[] = {key->range, key->range}, *const space[] = {GN_PLACES, GN_PLACES,
                                                                            GN_PLACES, GN_LENGTHS};
    const size_t count = particles ? 1 + (size_t)s->dimension : 2;
    if (particles) {
        write_whole(s->out, key->range);
        fputc(',', s->out);
    }
    open_array(s->out, particles ? 1 : key->number ? key->number : 3, 0);
    write_row(s->out, count, count, units, particles ? space + 4 - count : point);
    fputc('}', s->out);
}

static void write_choices(FILE *out, const gn_choice *choices) {
    fputs("{\"enum\":[", out);
    for (const gn_choice *choice = choices; choice->name; choice++) {
        fprintf(out, "%s\"%s\"", choice == choices ? "" : ",", choice->name);
        if (strcmp(choice->name, "true") == 0 || strcmp(choice->name, "false") == 0)
            fprintf(out, ",%s", choice->name);
    }
    fputs("]}", out);
}

/* Writes the schema of a text. Any scalar is a text in a scene, such as `title: 2024`, but a name
 * must not be a number. */
static void write_text(FILE *out, const gn_key *key) {
    const bool filled = key->presence == GN_PRESENT_TEXT || key->type == GN_KEY_FILE,
               name = key->type == GN_KEY_NAME;
    fprintf(out,
            "{\"allOf\":[{\"$ref\":\"#/definitions/%s\"}],\"maxLength\":%zu%s},"
            "{\"type\":[\"boolean\"%s]}",
            name ? "name" : "text", key->size - 1, filled ? ",\"minLength\":1" : "",
            name ? "" : ",\"number\"");
}

#define SCALAR "{\"type\":[\"string\",\"number\",\"boolean\"]}"
#define WHOLES "{\"type\":\"integer\",\"minimum\":0},{\"type\":\"string\",\"pattern\":\"^[0-9]+$\"}"

/* Returns the schema of a value of free form, by the name of its key; other values may be anything.
 */
static const char *tree_text(const char *name) {
    static const char *const trees[][2] = {
        {"confinement", "{\"type\":\"array\",\"minItems\":3,\"items\":{\"anyOf\":[{\"type\":"
                        "\"number\",\"minimum\":0},{\"$ref\":\"#/definitions/positive_quantity\"}"
                        "]}}"},
        {"seeds", WHOLES ",{\"type\":\"array\",\"minItems\":1,\"items\":{\"anyOf\":[" WHOLES "]}}"},
        {"parameters",
         "{\"type\":\"object\",\"additionalProperties\":{\"anyOf\":[" SCALAR
         ",{\"type\":\"array\",\"minItems\":1},{\"$ref\":\"#/definitions/range\"}]}}"},
        {"of", "{\"type\":\"array\",\"minItems\":1}"}};
    for (size_t k = 0; k < sizeof trees / sizeof *trees; k++)
        if (strcmp(name, trees[k][0]) == 0) return trees[k][1];
    return "{}";
}

/* Writes the schema of lists, and of values that may be lists; other values may be anything. */
static void write_list_value(const schema *s, const gn_key *key) {
    switch (key->type) {
    case GN_KEY_VECTOR:
    case GN_KEY_SPIN:
        if (key->second)
            write_varying(s, key);
        else
            write_vector(s, key);
        break;
    case GN_KEY_CELLS:
        write_wholes(s->out, s->dimension == 2 ? 2 : 3, 3, key->range);
        break;
    case GN_KEY_IDS:
        write_wholes(s->out, 1, 0, key->range);
        break;
    case GN_KEY_TABLE:
        write_table(s->out, key);
        break;
    case GN_KEY_PARTICLES:
    case GN_KEY_POINTS:
        write_points(s, key);
        break;
    case GN_KEY_NAMES:
        fputs(SCALAR ",", s->out);
        open_array(s->out, 1, 0);
        fputs(SCALAR "}", s->out);
        break;
    default:
        fputs(tree_text(key->name), s->out);
    }
}

static void write_alternatives(const schema *s, const gn_key *key) {
    switch (key->type) {
    case GN_KEY_REAL:
        write_number(s->out, unit_of(key), key->range);
        break;
    case GN_KEY_INTEGER:
        write_whole(s->out, key->range);
        break;
    case GN_KEY_SEED:
        fputs(WHOLES, s->out);
        break;
    case GN_KEY_TEXT:
    case GN_KEY_FILE:
    case GN_KEY_NAME:
        write_text(s->out, key);
        break;
    case GN_KEY_CHOICE:
        write_choices(s->out, key->choices);
        break;
    default:
        write_list_value(s, key);
    }
    write_word(s->out, key->word);
    write_word(s->out, key->other_word);
}

/* ---- keys and sections ---- */

/* Writes the default as YAML reads it: a number, true, or a text. */
static void write_default(FILE *out, const gn_key *key) {
    char *rest = NULL;
    if (!key->fallback || key->required || key->type == GN_KEY_VECTOR) return;
    (void)strtod(key->fallback, &rest);
    fputs(",\"default\":", out);
    const bool bare = (*key->fallback && !*rest) || strcmp(key->fallback, "true") == 0 ||
                      strcmp(key->fallback, "false") == 0;
    if (bare)
        fputs(key->fallback, out);
    else
        write_quoted(out, key->fallback);
}

static void write_properties(const schema *s, const gn_section *section, const char *path);

static bool has_required(const gn_section *section) {
    for (size_t k = 0; k < section->key_count; k++)
        if (section->keys[k].required) return true;
    return false;
}

/* Writes the schema of a section. An empty section takes its defaults. A stage removes a section by
 * `off`. */
static void write_section(const schema *s, const gn_key *key, const char *path) {
    const bool removable = s->in_stage && gn_stage_may_change(path),
               optional = s->in_stage ? removable : !has_required(key->section);
    if (key->word || removable)
        fprintf(s->out, ",\"if\":{\"type\":\"string\"},\"then\":{\"enum\":[\"%s\"%s]},\"else\":{",
                removable ? "off" : key->word, removable && key->word ? ",\"none\"" : "");
    else
        fputc(',', s->out);
    fprintf(s->out, "\"type\":%s,", optional ? "[\"object\",\"null\"]" : "\"object\"");
    write_properties(s, key->section, path);
    if (key->word || removable) fputc('}', s->out);
}

/* Writes the schema of a list. A stage refers to items by name: a section has their keys, a list
 * the values of `name`. */
static void write_list(const schema *s, const gn_key *key, const char *path) {
    const gn_range count = gn_range_read(key->range);
    char element[GN_KEY_PATH_SIZE + 2];
    snprintf(element, sizeof element, "%s.*", path);
    if (s->in_stage) {
        fputs(",\"type\":[\"object\",\"array\"],\"additionalProperties\":{\"type\":\"object\",",
              s->out);
        write_properties(s, key->section, element);
        fputs("},\"items\":{\"type\":\"object\",\"required\":[\"name\"],", s->out);
    } else {
        fprintf(s->out, ",\"type\":[\"array\",\"null\"],\"minItems\":%.0f,\"maxItems\":%.0f",
                count.low, count.high);
        fputs(",\"items\":{\"type\":\"object\",", s->out);
    }
    write_properties(s, key->section, element);
    fputc('}', s->out);
}

static void write_key(const schema *s, const gn_key *key, const char *path) {
    char type[GN_KEY_TYPE_SIZE], *text = NULL;
    size_t size = 0;
    gn_key_describe(key, type, sizeof type);
    FILE *both = open_memstream(&text, &size);
    if (!both) return;
    fprintf(both, "%s (%s)", key->text, type);
    fclose(both);
    fprintf(s->out, "\n\"%s\":{\"description\":", key->name);
    write_quoted(s->out, text);
    free(text);
    if (!s->in_stage) write_default(s->out, key);
    if (key->type == GN_KEY_SECTION)
        write_section(s, key, path);
    else if (key->type == GN_KEY_LIST)
        write_list(s, key, path);
    else {
        fputs(",\"anyOf\":[", s->out);
        write_alternatives(s, key);
        fputc(']', s->out);
    }
    fputc('}', s->out);
}

static bool belongs(const schema *s, const gn_key *key, const char *path) {
    if (key->shape_dimension && key->shape_dimension != s->dimension) return false;
    return !s->in_stage || gn_stage_may_hold(path) || strcmp(key->name, "name") == 0;
}

/* Writes the keys of a section, separated by commas; returns their number plus that of the keys
 * written before. */
static size_t write_keys(const schema *s, const gn_section *section, const char *above,
                         size_t count) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char path[GN_KEY_PATH_SIZE];
        snprintf(path, sizeof path, "%s%s%s", above, *above ? "." : "", key->name);
        if (!belongs(s, key, path) || key->type == GN_KEY_CHANGES) continue;
        if (count++) fputc(',', s->out);
        if (s->specimen_only && section == &gn_scene_section && !key->packing)
            fprintf(s->out, "\n\"%s\":{}", key->name);
        else
            write_key(s, key, path);
    }
    return count;
}

static void write_required(const schema *s, const gn_section *section) {
    size_t count = 0;
    if (s->in_stage || (s->specimen_only && section == &gn_scene_section)) return;
    for (size_t k = 0; k < section->key_count; k++)
        if (section->keys[k].required)
            fprintf(s->out, "%s\"%s\"", count++ ? "," : ",\"required\":[", section->keys[k].name);
    if (count) fputc(']', s->out);
}

static void write_properties(const schema *s, const gn_section *section, const char *path) {
    fputs("\"properties\":{", s->out);
    size_t count = write_keys(s, section, path, 0);
    if (section == &gn_stage_section && !s->in_stage) {
        schema stage = *s;
        stage.in_stage = true;
        write_keys(&stage, &gn_scene_section, "", count);
    }
    fputs("},\"additionalProperties\":false", s->out);
    write_required(s, section);
}

/* ---- files ---- */

static void write_head(FILE *out, const char *title, const char *text) {
    fprintf(out,
            "{\"$schema\":\"http://json-schema.org/draft-07/schema#\",\"title\":\"gneiss %s\",\n"
            "\"description\":\"%s\",\"$comment\":\"gneiss %s\",\n\"definitions\":{",
            title, text, gn_version());
    write_definitions(out);
}

static void write_scene(FILE *out, bool specimen_only) {
    write_head(out, specimen_only ? "specimen" : "scene",
               specimen_only ? "a file of gneiss pack" : "a file of gneiss run");
    for (int dimension = 2; dimension <= 3; dimension++) {
        const schema s = {out, dimension, specimen_only, false};
        fprintf(out, ",\n\"in_%dd\":{\"type\":\"object\",", dimension);
        write_properties(&s, &gn_scene_section, "");
        fputc('}', out);
    }
    fputs("},\n\"if\":{\"type\":\"object\",\"required\":[\"dimension\"],\"properties\":{"
          "\"dimension\":{\"enum\":[2,\"2\"]}}},\n\"then\":{\"$ref\":\"#/definitions/in_2d\"},"
          "\"else\":{\"$ref\":\"#/definitions/in_3d\"}}\n",
          out);
}

static void write_sweep(FILE *out) {
    const schema s = {out, 3, false, false};
    write_head(out, "sweep", "a file of gneiss sweep");
    fputs(",\n\"range\":{\"type\":\"object\",", out);
    write_properties(&s, &gn_range_section, "");
    fputs("}},\n\"type\":\"object\",", out);
    write_properties(&s, &gn_sweep_section, "");
    fputs("}\n", out);
}

gneiss_status gn_command_schema(const gn_options *options, gneiss_error *error) {
    const char *of = options->target ? options->target : "scene";
    if (strcmp(of, "scene") == 0 || strcmp(of, "pack") == 0)
        write_scene(stdout, strcmp(of, "pack") == 0);
    else if (strcmp(of, "sweep") == 0)
        write_sweep(stdout);
    else if (strcmp(of, "calibrate") == 0)
        return gn_calibrate_schema(options, error);
    else
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "gneiss schema: expected scene, pack, sweep or calibrate, found '%s'", of);
    return GNEISS_OK;
}
