#include "scene/read.h"

#include "base/memory.h"
#include "base/names.h"
#include "base/printable.h"
#include "scene/foreign.h"
#include "scene/formula.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

/* Describes the value of a node, for use after "found". */
static const char *found(const gn_node *node, char *buffer, size_t size) {
    if (node->kind == GN_NODE_NULL) return "nothing";
    if (node->kind == GN_NODE_LIST) return "a list";
    if (node->kind == GN_NODE_MAP) return "a section";
    snprintf(buffer, size, "'%.60s'%s", node->text, strlen(node->text) > 60 ? "..." : "");
    for (char *c = buffer; *c; c++)
        if ((unsigned char)*c < 0x20) *c = ' ';
    return buffer;
}

static gneiss_status unexpected(const gn_reader *reader, const gn_node *node, const char *expected,
                                const char *reason) {
    char buffer[80];
    return gn_read_fail(reader, node, node->where, reader->path, "expected %s, found %s%s",
                        expected, found(node, buffer, sizeof buffer), reason);
}

static gneiss_status no_memory(const gn_reader *reader) {
    return gn_fail(reader->error, GNEISS_ERROR_MEMORY, "%s: out of memory while reading %s",
                   reader->name, reader->path);
}

/* Appends to the path of the current key and returns the previous length, with which it is
 * restored. */
static size_t path_push_name(gn_reader *reader, const char *name) {
    size_t before = reader->path_length;
    snprintf(reader->path + before, sizeof reader->path - before, "%s%s", before ? "." : "", name);
    reader->path_length = strlen(reader->path);
    return before;
}

static size_t path_push_index(gn_reader *reader, size_t index) {
    size_t before = reader->path_length;
    snprintf(reader->path + before, sizeof reader->path - before, "[%zu]", index);
    reader->path_length = strlen(reader->path);
    return before;
}

static void path_pop(gn_reader *reader, size_t length) {
    reader->path_length = length;
    reader->path[length] = '\0';
}

/* ---- numbers ---- */

bool gn_read_quantity(const gn_reader *reader, const char *text, const char *unit, double *value,
                      char *reason, size_t reason_size) {
    /* The alternatives of "1/s|1" are separate units. */
    const char *bar = strchr(unit, '|');
    if (strcmp(unit, GN_SLOPE) == 0)
        return gn_units_read_slope(reader->units, text, value, reason, reason_size);
    if (!bar) return gn_units_read(reader->units, text, unit, value, reason, reason_size);
    char other[96];
    return gn_units_read(reader->units, text, "1/s", value, reason, reason_size) ||
           gn_units_read(reader->units, text, bar + 1, value, other, sizeof other);
}

static bool is_word(const gn_key *key, const gn_node *node) {
    return key->word && node->kind == GN_NODE_SCALAR && strcmp(node->text, key->word) == 0;
}

/* Returns " or 'off' or 'auto'". */
static const char *words_of(const gn_key *key, char text[80]) {
    const char *other = key->other_word;
    *text = '\0';
    if (key->word)
        snprintf(text, 80, " or '%s'%s%s%s", key->word, other ? " or '" : "", other ? other : "",
                 other ? "'" : "");
    return text;
}

static gneiss_status out_of_range(const gn_reader *reader, const gn_key *key, const gn_node *node,
                                  const char *reason) {
    char expected[160], words[80];
    const char *unit =
        key->unit && gn_unit_is_shown(key->unit) && !strchr(key->unit, '|') ? key->unit : "";
    snprintf(expected, sizeof expected, "a value in %s%s%s%s", key->range, *unit ? " " : "", unit,
             words_of(key, words));
    return unexpected(reader, node, expected, reason);
}

/* Reads a number in `unit`; words are not accepted. */
static gneiss_status read_number(const gn_reader *reader, const gn_key *key, const char *unit,
                                 const gn_node *node, double *value) {
    char reason[96] = "", expected[160], words[80];
    if (node->kind == GN_NODE_SCALAR &&
        gn_read_quantity(reader, node->text, unit, value, reason, sizeof reason)) {
        if (key->range && !gn_range_holds(key->range, *value))
            return out_of_range(reader, key, node, "");
        const char *note = gn_unit_note(node->text);
        if (note) gn_read_note(reader, node, reader->path, false, note);
        return GNEISS_OK;
    }
    snprintf(expected, sizeof expected, "%s%s", gn_unit_text(unit), words_of(key, words));
    return unexpected(reader, node, expected, reason);
}

static bool is_other_word(const gn_key *key, const gn_node *node) {
    return key->other_word && node->kind == GN_NODE_SCALAR &&
           strcmp(node->text, key->other_word) == 0;
}

static gneiss_status read_real(const gn_reader *reader, const gn_key *key, const gn_node *node,
                               double *value) {
    if (is_other_word(key, node)) {
        *value = key->other_value;
        return GNEISS_OK;
    }
    if (is_word(key, node)) {
        *value = key->word_value;
        return GNEISS_OK;
    }
    return read_number(reader, key, key->unit, node, value);
}

static gneiss_status read_integer(const gn_reader *reader, const gn_key *key, const gn_node *node,
                                  int64_t *value) {
    if (is_word(key, node)) {
        *value = (int64_t)key->word_value;
        return GNEISS_OK;
    }
    char expected[160];
    const char *text = node->kind == GN_NODE_SCALAR ? node->text : "";
    if (gn_units_read_whole(text, value) &&
        (!key->range || gn_range_holds(key->range, (double)*value)))
        return GNEISS_OK;
    snprintf(expected, sizeof expected, "a whole number%s%s%s%s%s", key->range ? " in " : "",
             key->range ? key->range : "", key->word ? " or '" : "", key->word ? key->word : "",
             key->word ? "'" : "");
    return unexpected(reader, node, expected, "");
}

static gneiss_status read_seed(const gn_reader *reader, const gn_node *node, uint64_t *value) {
    char *rest = NULL;
    errno = 0;
    const char *text = node->kind == GN_NODE_SCALAR ? node->text : "";
    bool digits = *text && strspn(text, "0123456789") == strlen(text);
    if (digits) *value = strtoull(text, &rest, 10);
    if (digits && !*rest && !errno) return GNEISS_OK;
    return unexpected(reader, node, "a whole number from 0 to 18446744073709551615", "");
}

/* ---- texts and words ---- */

static gneiss_status read_text(const gn_reader *reader, const gn_key *key, const gn_node *node,
                               char *text) {
    if (node->kind != GN_NODE_SCALAR) return unexpected(reader, node, "text", "");
    size_t length = strlen(node->text);
    if (length >= key->size) {
        char expected[64];
        snprintf(expected, sizeof expected, "at most %zu bytes of text", key->size - 1);
        return unexpected(reader, node, expected, "");
    }
    /* An empty text would mean that the key is absent, so that it is refused as a mistake. */
    if (!length && key->type == GN_KEY_TEXT && key->presence == GN_PRESENT_TEXT && node->key)
        return unexpected(reader, node, "a name, or the key left out", "");
    if (key->type == GN_KEY_TEXT && gn_has_control(node->text))
        return unexpected(reader, node, "text without control characters", "");
    memcpy(text, node->text, length + 1);
    return GNEISS_OK;
}

/* Reads a name, which must be usable in an override (walls.top.motion.vz) and in the path of a data
 * set of results.h5 (history/wall_top_force_z). */
static gneiss_status read_name(const gn_reader *reader, const gn_key *key, const gn_node *node,
                               char *name) {
    GN_TRY(read_text(reader, key, node, name));
    char *rest;
    (void)strtod(name, &rest);
    /* A name that could be read as a number, and an empty one, are refused. */
    if (*rest && !strpbrk(name, "./[]=\n\t") && !gn_has_control(name)) return GNEISS_OK;
    return unexpected(reader, node,
                      "a name (not empty, not a number, without . / [ ] = and control characters)",
                      "");
}

static gneiss_status read_choice(const gn_reader *reader, const gn_key *key, const gn_node *node,
                                 void *at) {
    if (node->kind == GN_NODE_SCALAR)
        for (const gn_choice *choice = key->choices; choice->name; choice++)
            if (strcmp(choice->name, node->text) == 0) {
                gn_choice_store(key, at, choice->value);
                return GNEISS_OK;
            }
    char expected[256] = "one of", advice[96] = "";
    gn_names names = gn_names_for(node->kind == GN_NODE_SCALAR ? node->text : "");
    for (const gn_choice *choice = key->choices; choice->name; choice++) {
        gn_names_add(&names, choice->name);
        if (gn_choice_name(key->choices, choice->value) != choice->name) continue;
        size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s %s", used > 6 ? "," : "",
                 choice->name);
    }
    if (names.nearest) gn_names_advice(&names, advice, sizeof advice);
    return unexpected(reader, node, expected, advice);
}

/* The file is only opened here, to test it; its contents are read when the particles are created.
 */
static gneiss_status read_file(const gn_reader *reader, const gn_key *key, const gn_node *node,
                               char *file, char *path) {
    GN_TRY(read_text(reader, key, node, file));
    const char *why = gn_find_file(reader->folder, file, key->in_folder, path);
    if (!why) return GNEISS_OK;
    return gn_read_fail(reader, node, node->where, reader->path, "cannot open '%.300s': %s", file,
                        why);
}

/* ---- vectors and tables ---- */

static gneiss_status read_table_row(gn_reader *reader, const gn_key *key, const gn_node *row,
                                    size_t index, gn_table *table) {
    static const gn_key time = {.name = "time", .unit = "s"};
    if (row->kind != GN_NODE_LIST || row->count != 2)
        return unexpected(reader, row, "a row [time, value]", "");
    GN_TRY(read_number(reader, &time, "s", row->first, &table->time[index]));
    GN_TRY(read_number(reader, key, key->unit, row->last, &table->value[index]));
    if (index > 0 && table->time[index] <= table->time[index - 1])
        return unexpected(reader, row->first, "a time after that of the previous row", "");
    return GNEISS_OK;
}

/* Samples a formula from 0 to the end of the scene, at uneven distances, so that an oscillation of
 * any frequency is seen. Values that are not finite count as 0 here: whether they occur is known
 * when they are needed. */
static gneiss_status sample(const gn_reader *reader, const gn_key *key, const gn_node *node,
                            gn_table *table) {
    const double end = reader->end > 0.0 ? reader->end : 1.0;
    for (size_t k = 0; k < table->count; k++) {
        const double golden = 0.61803398874989485 * (double)k, last = (double)(table->count - 1),
                     uneven = (double)k < last ? 0.5 * (golden - floor(golden)) : 0.0;
        table->time[k] = end * ((double)k + uneven) / last;
        table->value[k] = gn_formula_at(table->formula, table->time[k]);
        if (!key->range || gn_range_holds(key->range, table->value[k])) continue;
        char reason[96];
        snprintf(reason, sizeof reason, ", which is %g at t = %g s", table->value[k],
                 table->time[k]);
        return out_of_range(reader, key, node, reason);
    }
    return GNEISS_OK;
}

static gneiss_status make_table(const gn_reader *reader, const gn_node *node, size_t count,
                                gn_table *table) {
    table->count = count;
    table->stage = node->stage;
    table->time = gn_alloc_array(count, sizeof(double));
    table->value = gn_alloc_array(count, sizeof(double));
    return table->time && table->value ? GNEISS_OK : no_memory(reader);
}

static gneiss_status read_formula(const gn_reader *reader, const gn_key *key, const gn_node *node,
                                  gn_table *table) {
    char reason[96];
    GN_TRY(make_table(reader, node, GN_FORMULA_POINTS, table));
    table->formula =
        gn_formula_add(&reader->scene->formulas, node->text, reader->path, reason, sizeof reason);
    if (table->formula) return sample(reader, key, node, table);
    return *reason ? unexpected(reader, node,
                                "a formula of t in SI units such as '0.1*sin(2*pi*t)'", reason)
                   : no_memory(reader);
}

/* A text that is a quantity is no formula: 't' is also the unit tonne. */
static bool is_formula(const gn_reader *reader, const gn_key *key, const gn_node *node) {
    char reason[96];
    double value;
    return node->kind == GN_NODE_SCALAR && gn_formula_is(node->text) &&
           !gn_read_quantity(reader, node->text, key->unit, &value, reason, sizeof reason);
}

static gneiss_status read_table(gn_reader *reader, const gn_key *key, const gn_node *node,
                                gn_table *table) {
    if (is_word(key, node)) return GNEISS_OK;
    if (is_formula(reader, key, node)) return read_formula(reader, key, node, table);
    bool constant = node->kind == GN_NODE_SCALAR;
    if (!constant && (node->kind != GN_NODE_LIST || node->count == 0)) {
        char expected[160];
        snprintf(expected, sizeof expected, "%s%s, a formula of t or a table [[time, value], ...]",
                 gn_unit_text(key->unit), key->word ? ", 'free'" : "");
        return unexpected(reader, node, expected, "");
    }
    GN_TRY(make_table(reader, node, constant ? 1 : node->count, table));
    if (constant) return read_number(reader, key, key->unit, node, &table->value[0]);
    size_t index = 0;
    for (const gn_node *row = node->first; row; row = row->next, index++) {
        size_t mark = path_push_index(reader, index);
        GN_TRY(read_table_row(reader, key, row, index, table));
        path_pop(reader, mark);
    }
    return GNEISS_OK;
}

/* Reads a component that varies over time; the vector gets its first value that is not 0. */
static gneiss_status read_varying(gn_reader *reader, const gn_key *key, const gn_node *node,
                                  gn_table *table, double *value) {
    GN_TRY(read_table(reader, key, node, table));
    for (size_t k = 0; k < table->count && *value == 0.0; k++) *value = table->value[k];
    reader->scene->loads_vary = true;
    return GNEISS_OK;
}

static gneiss_status read_component(gn_reader *reader, const gn_key *key, const gn_node *node,
                                    size_t index, char *base) {
    size_t mark = path_push_index(reader, index);
    void *at = base + key->offset;
    gn_table *table;
    const bool varies = gn_key_tables(key, base, &table) == 3 &&
                        (node->kind == GN_NODE_LIST || is_formula(reader, key, node));
    gneiss_status status =
        key->type == GN_KEY_CELLS ? read_integer(reader, key, node, (int64_t *)at + index)
        : varies ? read_varying(reader, key, node, table + index, (double *)at + index)
                 : read_number(reader, key, key->unit, node, (double *)at + index);
    path_pop(reader, mark);
    return status;
}

static gneiss_status read_vector(gn_reader *reader, const gn_key *key, const gn_node *node,
                                 char *base) {
    void *at = base + key->offset;
    bool plane = reader->scene->dimension == 2;
    if (plane && key->type == GN_KEY_SPIN && node->kind == GN_NODE_SCALAR)
        return read_number(reader, key, key->unit, node, (double *)at + 2);
    bool short_form = plane && key->type != GN_KEY_SPIN && node->count == 2;
    if (node->kind != GN_NODE_LIST || !(node->count == 3 || short_form))
        return unexpected(reader, node,
                          !plane                     ? "a list of 3 components"
                          : key->type == GN_KEY_SPIN ? "a spin about z such as '30 deg/s'"
                                                     : "a list of 2 components",
                          node->kind == GN_NODE_LIST ? " of another length" : "");
    size_t index = 0;
    for (const gn_node *item = node->first; item; item = item->next)
        GN_TRY(read_component(reader, key, item, index++, base));
    if (key->type == GN_KEY_CELLS) {
        if (short_form) ((int64_t *)at)[2] = 1;
        return GNEISS_OK;
    }
    double *v = at;
    bool in_plane = key->type == GN_KEY_SPIN ? v[0] == 0 && v[1] == 0 : v[2] == 0;
    if (plane && !in_plane)
        return unexpected(reader, node, "nothing out of the plane of a 2D scene", "");
    return GNEISS_OK;
}

/* ---- arrays ---- */

/* Stores a zeroed array and its count, whose offset is key->second. */
static gneiss_status make_array(const gn_reader *reader, const gn_key *key, const gn_node *node,
                                size_t size, char *base, void **array) {
    *array = gn_alloc_array(node->count, size);
    if (!*array) return no_memory(reader);
    memcpy(base + key->offset, array, sizeof *array);
    memcpy(base + key->second, &node->count, sizeof node->count);
    return GNEISS_OK;
}

static gneiss_status read_ids(gn_reader *reader, const gn_key *key, const gn_node *node,
                              char *base) {
    if (node->kind != GN_NODE_LIST || !node->count)
        return unexpected(reader, node, "a list of particle indices",
                          node->count ? "" : " without any");
    void *array;
    GN_TRY(make_array(reader, key, node, sizeof(int64_t), base, &array));
    size_t index = 0;
    for (const gn_node *item = node->first; item; item = item->next, index++) {
        size_t mark = path_push_index(reader, index);
        GN_TRY(read_integer(reader, key, item, (int64_t *)array + index));
        path_pop(reader, mark);
    }
    return GNEISS_OK;
}

/* Reads a list of names; a single name stands for a list of one, whose node is then the item. */
static gneiss_status read_names(gn_reader *reader, const gn_key *key, const gn_node *node,
                                char *base) {
    const gn_key name = {.size = GN_NAME_SIZE};
    gn_node list = {.count = 1};
    if (node->kind != GN_NODE_SCALAR && (node->kind != GN_NODE_LIST || !node->count))
        return unexpected(reader, node, "a name or a list of names", "");
    if (node->kind == GN_NODE_LIST) list = *node;
    void *names;
    GN_TRY(make_array(reader, key, &list, GN_NAME_SIZE, base, &names));
    for (const gn_node *item = list.first ? list.first : node; item; item = item->next) {
        GN_TRY(read_text(reader, &name, item, names));
        names = (char *)names + GN_NAME_SIZE;
        if (!list.first) break; /* a single name: the node's siblings are other keys */
    }
    return GNEISS_OK;
}

static gneiss_status read_particle(gn_reader *reader, const gn_key *key, const gn_node *row,
                                   double particle[4]) {
    const gn_key coordinate = {.unit = key->unit, .range = GN_PLACES},
                 radius = {.unit = key->unit, .range = GN_LENGTHS};
    bool plane = reader->scene->dimension == 2;
    if (row->kind != GN_NODE_LIST || row->count != (plane ? 3 : 4))
        return unexpected(reader, row, plane ? "a row [x, y, r]" : "a row [x, y, z, r]", "");
    size_t index = 0;
    for (const gn_node *item = row->first; item; item = item->next, index++) {
        size_t slot = plane && index == 2 ? 3 : index;
        GN_TRY(read_number(reader, slot == 3 ? &radius : &coordinate, key->unit, item,
                           &particle[slot]));
    }
    return GNEISS_OK;
}

/* Fails at a value that is neither a list nor a number in the range. */
static gneiss_status no_particles(const gn_reader *reader, const gn_key *key, const gn_node *node) {
    char expected[96];
    snprintf(expected, sizeof expected, "a list of particles or a whole number in %s", key->range);
    bool empty = node->kind == GN_NODE_LIST;
    return unexpected(reader, node, expected, empty ? " without any" : "");
}

static gneiss_status read_particles(gn_reader *reader, const gn_key *key, const gn_node *node,
                                    char *base) {
    if (node->kind == GN_NODE_SCALAR) {
        gneiss_error unused = {0};
        gn_reader quiet = *reader;
        quiet.error = &unused;
        if (read_integer(&quiet, key, node, (int64_t *)(base + key->number)) == GNEISS_OK)
            return GNEISS_OK;
    }
    if (node->kind != GN_NODE_LIST || !node->count) return no_particles(reader, key, node);
    void *array;
    GN_TRY(make_array(reader, key, node, 4 * sizeof(double), base, &array));
    size_t index = 0;
    for (const gn_node *row = node->first; row; row = row->next, index++) {
        size_t mark = path_push_index(reader, index);
        GN_TRY(read_particle(reader, key, row, (double *)array + 4 * index));
        path_pop(reader, mark);
    }
    return GNEISS_OK;
}

static gneiss_status read_points(gn_reader *reader, const gn_key *key, const gn_node *node,
                                 char *base) {
    size_t least = key->number ? key->number : 3;
    if (node->kind != GN_NODE_LIST || node->count < least) {
        char expected[64], reason[32] = "";
        snprintf(expected, sizeof expected, "a list of at least %zu points [x, y]", least);
        if (node->kind == GN_NODE_LIST) snprintf(reason, sizeof reason, " of %zu", node->count);
        return unexpected(reader, node, expected, reason);
    }
    void *array;
    GN_TRY(make_array(reader, key, node, 2 * sizeof(double), base, &array));
    double *point = array;
    size_t index = 0;
    for (const gn_node *row = node->first; row; row = row->next, index++, point += 2) {
        size_t mark = path_push_index(reader, index);
        if (row->kind != GN_NODE_LIST || row->count != 2)
            return unexpected(reader, row, "a point [x, y]", "");
        GN_TRY(read_number(reader, key, key->unit, row->first, &point[0]));
        GN_TRY(read_number(reader, key, key->unit, row->last, &point[1]));
        path_pop(reader, mark);
    }
    return GNEISS_OK;
}

static gneiss_status read_section(gn_reader *reader, const gn_section *section, const gn_node *map,
                                  char *base);

static gneiss_status read_element(gn_reader *reader, const gn_section *section, const gn_node *item,
                                  char *base) {
    if (item->kind != GN_NODE_MAP) return unexpected(reader, item, "a section", "");
    return read_section(reader, section, item, base);
}

static gneiss_status read_list(gn_reader *reader, const gn_key *key, const gn_node *node,
                               char *base) {
    if (node->kind == GN_NODE_NULL) return GNEISS_OK;
    if (node->kind != GN_NODE_LIST) return unexpected(reader, node, "a list of sections", "");
    if (!gn_range_holds(key->range, (double)node->count)) {
        char expected[64], reason[32];
        snprintf(expected, sizeof expected, "a number of elements in %s", key->range);
        snprintf(reason, sizeof reason, " of %zu", node->count);
        return unexpected(reader, node, expected, reason);
    }
    void *array;
    GN_TRY(make_array(reader, key, node, key->section->size, base, &array));
    size_t index = 0;
    for (const gn_node *item = node->first; item; item = item->next, index++) {
        size_t mark = path_push_index(reader, index);
        GN_TRY(
            gn_read_keep_problem(reader, read_element(reader, key->section, item,
                                                      (char *)array + index * key->section->size)));
        path_pop(reader, mark);
    }
    return GNEISS_OK;
}

/* ---- keys and sections ---- */

/* Refuses a shape of another dimension before its value is read, because the value may be invalid
 * there. */
static gneiss_status wrong_shape(const gn_reader *reader, const gn_key *key, const gn_node *node) {
    char names[GN_SHAPE_NAMES_SIZE];
    if (!key->shape)
        return gn_read_fail(reader, node, node->key_where, reader->path,
                            "expected in a %dD scene only, found in a %dD one",
                            key->shape_dimension, (int)reader->scene->dimension);
    gn_shape_names(reader->scene->dimension, names);
    return gn_read_fail(reader, node, node->key_where, reader->path,
                        "expected a shape of a %dD scene: %s, found %s",
                        (int)reader->scene->dimension, names, key->name);
}

/* Reads a section that is given by a word: each key gets the value of its own word. */
static gneiss_status read_words(gn_reader *reader, const gn_section *section, char *base) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        const gn_node word = {.kind = GN_NODE_SCALAR, .text = key->word};
        GN_TRY(read_real(reader, key, &word, (double *)(base + key->offset)));
    }
    return GNEISS_OK;
}

static gneiss_status read_key(gn_reader *reader, const gn_key *key, const gn_node *node,
                              char *base) {
    char *at = base + key->offset;
    if (key->shape_dimension && key->shape_dimension != reader->scene->dimension)
        return wrong_shape(reader, key, node);
    switch (key->type) {
    case GN_KEY_REAL:
        return read_real(reader, key, node, (double *)at);
    case GN_KEY_INTEGER:
        return read_integer(reader, key, node, (int64_t *)at);
    case GN_KEY_SEED:
        return read_seed(reader, node, (uint64_t *)at);
    case GN_KEY_TEXT:
        return read_text(reader, key, node, at);
    case GN_KEY_NAME:
        return read_name(reader, key, node, at);
    case GN_KEY_FILE:
        return read_file(reader, key, node, at, base + key->second);
    case GN_KEY_CHOICE:
        return read_choice(reader, key, node, at);
    case GN_KEY_VECTOR:
    case GN_KEY_SPIN:
    case GN_KEY_CELLS:
        return read_vector(reader, key, node, base);
    case GN_KEY_TABLE:
        return read_table(reader, key, node, (gn_table *)at);
    case GN_KEY_IDS:
        return read_ids(reader, key, node, base);
    case GN_KEY_NAMES:
        return read_names(reader, key, node, base);
    case GN_KEY_PARTICLES:
        return read_particles(reader, key, node, base);
    case GN_KEY_POINTS:
        return read_points(reader, key, node, base);
    case GN_KEY_LIST:
        return read_list(reader, key, node, base);
    case GN_KEY_CHANGES:
        return GNEISS_OK;
    case GN_KEY_TREE:
        memcpy(at, &node, sizeof node);
        return GNEISS_OK;
    case GN_KEY_SECTION:
        if (is_word(key, node)) return read_words(reader, key->section, at);
        if (key->word && node->kind == GN_NODE_SCALAR)
            return unexpected(reader, node, "a section or 'none'", "");
        return read_section(reader, key->section, node, at);
    }
    return GNEISS_OK;
}

/* Reads the default of a key by the same code as a value of the file. */
static gneiss_status read_fallback(gn_reader *reader, const gn_key *key, char *base) {
    if (key->presence == GN_PRESENT_AXIS) *(int64_t *)(base + key->present_at) = -1;
    if (key->type == GN_KEY_SECTION &&
        (key->presence == GN_PRESENT_ALWAYS || key->presence == GN_PRESENT_BESIDE))
        return read_section(reader, key->section, NULL, base + key->offset);
    if (!key->fallback) return GNEISS_OK;
    gn_node node = {.kind = GN_NODE_SCALAR, .text = key->fallback};
    if (key->type != GN_KEY_VECTOR) return read_key(reader, key, &node, base);
    for (size_t k = 0; k < 3; k++) GN_TRY(read_component(reader, key, &node, k, base));
    return GNEISS_OK;
}

/* Returns the name of the key at the end of a path if the section has it, else NULL. */
static const char *own_key(const gn_section *section, const char *path) {
    const char *dot = strrchr(path, '.'), *name = dot ? dot + 1 : path;
    for (size_t k = 0; k < section->key_count; k++)
        if (strcmp(section->keys[k].name, name) == 0) return section->keys[k].name;
    return NULL;
}

/* Writes what an unknown key may stand for: a name of another program, or a misspelt one. */
static void advise(const gn_section *section, const char *key, gn_names *names, char *text,
                   size_t size) {
    const gn_foreign_name *foreign = gn_foreign_next(key, NULL);
    if (foreign) {
        names->nearest = own_key(section, foreign->key);
        gn_foreign_describe(foreign, text, size);
    } else if (names->nearest) {
        snprintf(text, size, "did you mean '%s'?", names->nearest);
    } else {
        snprintf(text, size, "expected one of %s", names->known);
    }
}

/* Reports an unknown key. The key that was probably intended counts as having a problem, or else
 * every key of the section. */
static gneiss_status unknown_key(gn_reader *reader, const gn_section *section,
                                 const gn_node *node) {
    gn_names names = gn_names_for(node->key);
    char advice[512];
    for (size_t k = 0; k < section->key_count; k++) gn_names_add(&names, section->keys[k].name);
    for (size_t k = 0; section == &gn_stage_section && k < gn_scene_section.key_count; k++)
        gn_names_add(&names, gn_scene_section.keys[k].name);
    size_t mark = path_push_name(reader, node->key);
    advise(section, node->key, &names, advice, sizeof advice);
    gneiss_status status = gn_read_fail(reader, node, node->key_where, reader->path,
                                        "unknown key '%.60s'; %s", node->key, advice);
    path_pop(reader, mark);
    if (names.nearest) path_push_name(reader, names.nearest);
    if (names.nearest || section != &gn_scene_section)
        gn_problem_place(reader->problems, reader->problems->at, reader->path);
    path_pop(reader, mark);
    return gn_read_keep_problem(reader, status);
}

static gneiss_status repeated_key(gn_reader *reader, const gn_node *first, const gn_node *node) {
    size_t mark = path_push_name(reader, node->key);
    gneiss_status status =
        gn_read_fail(reader, node, node->key_where, reader->path,
                     "expected once, found again; first given in line %d", first->key_where.line);
    path_pop(reader, mark);
    return gn_read_keep_problem(reader, status);
}

/* Finds the node of each key of the section; unknown and repeated keys are skipped. */
static gneiss_status match_keys(gn_reader *reader, const gn_section *section, const gn_node *map,
                                const gn_node *nodes[]) {
    for (const gn_node *child = map ? map->first : NULL; child; child = child->next) {
        size_t k = 0;
        while (k < section->key_count && strcmp(section->keys[k].name, child->key) != 0) k++;
        if (k == section->key_count && section == &gn_stage_section && gn_scene_key_at(child->key))
            continue; /* stages.c handles it */
        if (k == section->key_count)
            GN_TRY(unknown_key(reader, section, child));
        else if (nodes[k])
            GN_TRY(repeated_key(reader, nodes[k], child));
        else
            nodes[k] = child;
    }
    return GNEISS_OK;
}

/* Reads the key of a section at the reader's path; `node` NULL: not given. */
static gneiss_status read_member(gn_reader *reader, const gn_key *key, const gn_node *node,
                                 const gn_node *map, char *base) {
    if (!node && key->required) {
        gn_scene_place where = map ? map->key_where : (gn_scene_place){1, 1};
        if (gn_problem_at(reader->problems, reader->path)) return GNEISS_OK; /* a misspelt key */
        return gn_read_fail(reader, map, where, reader->path, "required, but not given");
    }
    /* The override that created the node could not be read. */
    if (node && node->set && gn_problem_at(reader->problems, reader->path)) return GNEISS_OK;
    if (node && key->place_at && !node->set)
        *(gn_scene_place *)(base + key->place_at) = node->where;
    GN_TRY(node ? read_key(reader, key, node, base) : read_fallback(reader, key, base));
    if (node && key->presence == GN_PRESENT_BOOL) *(bool *)(base + key->present_at) = true;
    return GNEISS_OK;
}

/* Reads a section. With `map` NULL it was not given and its keys take their defaults; an empty
 * section counts as given. */
static gneiss_status read_section(gn_reader *reader, const gn_section *section, const gn_node *map,
                                  char *base) {
    const gn_node *nodes[GN_SECTION_KEYS_MAX] = {NULL};
    if (map && map->kind != GN_NODE_MAP && map->kind != GN_NODE_NULL)
        return unexpected(reader, map, "a section", "");
    GN_TRY(match_keys(reader, section, map, nodes));
    if (map && section->where != GN_NO_WHERE)
        *(gn_scene_place *)(base + section->where) = map->key ? map->key_where : map->where;
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        if (reader->specimen_only && section == &gn_scene_section && !key->packing) continue;
        size_t mark = path_push_name(reader, key->name);
        GN_TRY(gn_read_keep_problem(reader, read_member(reader, key, nodes[k], map, base)));
        path_pop(reader, mark);
        /* Otherwise the number of components of vectors and the possible shapes are unknown. */
        if (gn_problem_at(reader->problems, "dimension")) return GNEISS_OK;
    }
    return GNEISS_OK;
}

gneiss_status gn_read_keys(gn_reader *reader, const gn_section *section, const gn_node *map,
                           void *base) {
    return read_section(reader, section, map, base);
}

gneiss_status gn_read_scene(gn_reader *reader, const gn_node *root) {
    char reason[96];
    const gn_node *end = gn_node_find(root, "time.end");
    if (!end || end->kind != GN_NODE_SCALAR ||
        !gn_units_read(reader->units, end->text, "s", &reader->end, reason, sizeof reason))
        reader->end = 0.0;
    return read_section(reader, &gn_scene_section, root, (char *)reader->scene);
}
