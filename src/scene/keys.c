#define _GNU_SOURCE /* strcasestr */
#include "base/names.h"
#include "scene/foreign.h"
#include "scene/manifest.h"
#include "scene/problems.h"
#include "scene/units.h"

#include <string.h>

typedef struct key_printer {
    FILE *out;
    bool markdown;
    const char *const *sought; /* [sought_count]; none: every key */
    size_t sought_count;
    int rank; /* rank of the keys that are printed at present */
    size_t count;
} key_printer;

/* Writes "number in (0, inf) m, or auto", "one of square, hexagonal", ... */
static void describe_numbers(char *text, size_t size, const char *noun, const gn_key *key) {
    const char *unit = key->unit && gn_unit_is_shown(key->unit) ? key->unit : "";
    if (strcmp(unit, GN_SLOPE) == 0)
        unit = "or an angle";
    else if (strchr(unit, '|'))
        unit = "1/s or 1";
    snprintf(text, size, "%s%s%s%s%s%s%s%s%s", noun, *unit ? ", " : "", unit,
             key->range ? ", in " : "", key->range ? key->range : "", key->word ? ", or " : "",
             key->word ? key->word : "", key->other_word ? ", or " : "",
             key->other_word ? key->other_word : "");
}

static void describe_choices(char *text, size_t size, const gn_key *key) {
    text[0] = '\0';
    for (const gn_choice *choice = key->choices; choice->name; choice++) {
        if (gn_choice_name(key->choices, choice->value) != choice->name) continue;
        size_t used = strlen(text);
        snprintf(text + used, size - used, "%s%s", used ? ", " : "", choice->name);
    }
}

static const char *vector_text(const gn_key *key) {
    return key->second ? "[x, y, z], in 2D [x, y], of numbers, formulas of t or tables"
           : key->shape_dimension == 3 ? "[x, y, z]"
                                       : "[x, y, z], in 2D [x, y]";
}

void gn_key_describe(const gn_key *key, char *text, size_t size) {
    switch (key->type) {
    case GN_KEY_REAL:
        describe_numbers(text, size, "number", key);
        return;
    case GN_KEY_INTEGER:
    case GN_KEY_SEED:
        describe_numbers(text, size, "whole number", key);
        return;
    case GN_KEY_TEXT:
        describe_numbers(text, size, "text", key);
        return;
    case GN_KEY_NAME:
        describe_numbers(text, size, "name", key);
        return;
    case GN_KEY_FILE:
        describe_numbers(text, size, "file", key);
        return;
    case GN_KEY_CHOICE:
        describe_choices(text, size, key);
        return;
    case GN_KEY_VECTOR:
        describe_numbers(text, size, vector_text(key), key);
        return;
    case GN_KEY_SPIN:
        describe_numbers(text, size, "[x, y, z], in 2D a number", key);
        return;
    case GN_KEY_CELLS:
        describe_numbers(text, size, "[x, y, z], in 2D [x, y]", key);
        return;
    case GN_KEY_TABLE:
        describe_numbers(text, size, "number, formula of t or table [[time, value], ...]", key);
        return;
    case GN_KEY_IDS:
        describe_numbers(text, size, "list of whole numbers", key);
        return;
    case GN_KEY_PARTICLES:
        snprintf(text, size, "list of rows, %s, or a whole number in %s", key->unit, key->range);
        return;
    case GN_KEY_POINTS:
        describe_numbers(text, size,
                         key->number == 2 ? "list of at least 2 points [x, y]"
                                          : "list of at least 3 points [x, y]",
                         key);
        return;
    case GN_KEY_NAMES:
        snprintf(text, size, "name or list of names");
        return;
    case GN_KEY_TREE:
    case GN_KEY_CHANGES:
        snprintf(text, size, "%s", key->unit);
        return;
    case GN_KEY_SECTION:
        snprintf(text, size, "section");
        return;
    case GN_KEY_LIST:
        describe_numbers(text, size, "list of sections", key);
    }
}

/* Escapes bars, which would end the cell of a Markdown table. */
static void print_cell(FILE *out, const char *text) {
    fputs("| ", out);
    for (; *text; text++) {
        if (*text == '|') fputc('\\', out);
        fputc(*text, out);
    }
    fputc(' ', out);
}

void gn_key_default(const gn_key *key, char *text, size_t size) {
    if (key->required)
        snprintf(text, size, "required");
    else if (key->type == GN_KEY_VECTOR && key->fallback)
        snprintf(text, size, "[%s, %s, %s]", key->fallback, key->fallback, key->fallback);
    else
        snprintf(text, size, "%s", key->fallback ? key->fallback : "");
}

static void print_key(key_printer *printer, const char *path, const gn_key *key) {
    char type[GN_KEY_TYPE_SIZE], fallback[96];
    gn_key_describe(key, type, sizeof type);
    gn_key_default(key, fallback, sizeof fallback);
    printer->count++;
    if (printer->markdown) {
        fprintf(printer->out, "| `%s` ", path);
        print_cell(printer->out, type);
        print_cell(printer->out, fallback);
        print_cell(printer->out, key->text);
        fputs("|\n", printer->out);
        return;
    }
    fprintf(printer->out, "%s\n    %s%s%s\n    %s\n", path, type,
            !*fallback      ? ""
            : key->required ? "; "
                            : "; default ",
            fallback, key->text);
}

/* Synonyms used in the field and by other programs, with the parts of key paths to which they
 * correspond. */
static const struct {
    const char *word, *parts[4];
} synonyms[] = {
    {"cmod", {"test.opening", "test.control.opening", "elements.beam.notch"}},
    {"ctod", {"test.opening", "test.control.opening", "elements.beam.notch"}},
    {"crack mouth", {"test.opening", "test.control.opening", "elements.beam.notch"}},
    {"confining", {"membrane.pressure", "test.confinement", "servo.stress", "membrane.ramp"}},
    {"cell pressure", {"membrane.pressure", "test.confinement", "servo.stress", "membrane.ramp"}},
    {"cell", {"membrane", "test.confinement"}},
    {"jacket", {"membrane"}},
    {"restart", {"output.checkpoint", "specimen.from"}},
    {"resume", {"output.checkpoint", "specimen.from"}},
    {"vtk", {"output.snapshots", "output.fields", "output.contacts"}},
    {"paraview", {"output.snapshots", "output.fields", "output.contacts"}},
    {"dump", {"output.snapshots", "output.history_rows", "output.checkpoint"}},
    {"clump", {"bodies", "bodies[].free"}},
    {"rigid", {"bodies"}},
    {"cluster", {"group", "bonds"}},
    {"joint", {"group", "contacts[].between", "bonds.passive_gaps"}},
    {"fault", {"group", "contacts[].between", "bonds.passive_gaps"}},
    {"cement", {"bonds", "tensile_strength", "shear_strength"}},
    {"cohesion", {"shear_strength", "mohr_coulomb", "group"}},
    {"ucs", {"test.kind", "tensile_strength", "shear_strength"}},
    {"platen", {"walls", "test.lower", "test.upper"}},
    {"dilat", {"test.kind", "test.control.lateral_strain"}},
    {"loading rate",
     {"walls[].motion", "sets[].motion", "elements.motions[].motion", "servo.max_"}},
    {"strain rate", {"periodic.x.rate", "periodic.y.rate", "periodic.z.rate", "walls[].motion"}},
    {"local damping", {"damping.background"}},
    {"global damping", {"damping.background"}},
    {"gf", {"fracture_energy"}},
    {"toughness", {"fracture_energy"}},
    {"bts", {"test.kind", "tensile_strength"}},
    {"flat joint", {"bonds.radius_multiplier", "bonds.moment_share", "yield_stress"}},
    {"parallel bond", {"bonds.radius_multiplier", "bonds.moment_share"}},
    {"weibull", {"strength_scatter", "stiffness_scatter"}},
    {"timestep", {"time.step", "time.safety"}},
    {"cores", {"run.threads"}},
    {"openmp", {"run.threads"}},
};

static bool is_synonym(const char *word, const char *path) {
    for (size_t k = 0; k < sizeof synonyms / sizeof *synonyms; k++)
        for (size_t n = 0; n < 4 && synonyms[k].parts[n]; n++)
            if (strncasecmp(word, synonyms[k].word, strlen(synonyms[k].word)) == 0 &&
                strstr(path, synonyms[k].parts[n]))
                return true;
    return false;
}

/* Tells whether another program has the name for what this key gives. */
static bool is_foreign(const char *name, const char *path) {
    for (const gn_foreign_name *f = gn_foreign_next(name, NULL); f; f = gn_foreign_next(name, f))
        if (strcmp(path, f->key) == 0) return true;
    return false;
}

enum { RANK_START, RANK_NAME, RANK_TEXT, RANKS };

/* Returns how well a key matches a word, 0 best; RANKS: not at all. */
static int rank_of_word(const char *word, const char *path, const gn_key *key) {
    char type[GN_KEY_TYPE_SIZE];
    if (strncasecmp(path, word, strlen(word)) == 0 || is_foreign(word, path)) return RANK_START;
    if (strcasestr(path, word)) return RANK_NAME;
    gn_key_describe(key, type, sizeof type);
    return strcasestr(key->text, word) || strcasestr(type, word) || is_synonym(word, path)
               ? RANK_TEXT
               : RANKS;
}

enum { TERM_SIZE = 256 };

/* Writes the words as one term, such as "crack mouth". */
static void join_words(const key_printer *printer, char term[TERM_SIZE]) {
    *term = '\0';
    for (size_t k = 0, used = 0; k < printer->sought_count && used < TERM_SIZE; k++)
        used += (size_t)snprintf(term + used, TERM_SIZE - used, "%s%s", k ? " " : "",
                                 printer->sought[k]);
}

static bool is_term(const key_printer *printer, const char *path) {
    char term[TERM_SIZE];
    join_words(printer, term);
    return printer->sought_count > 1 && (is_synonym(term, path) || is_foreign(term, path));
}

/* Prints what the term means in other programs. */
static void print_foreign(const key_printer *printer) {
    char term[TERM_SIZE], text[GN_FOREIGN_SIZE];
    join_words(printer, term);
    const gn_foreign_name *first = gn_foreign_next(term, NULL);
    for (const gn_foreign_name *f = first; f; f = gn_foreign_next(term, f)) {
        gn_foreign_describe(f, text, sizeof text);
        fprintf(printer->out, "%s\n", text);
    }
    if (first) fputc('\n', printer->out);
}

/* A key must contain all of several words; its rank is the lowest one. */
static int rank_of(const key_printer *printer, const char *path, const gn_key *key) {
    int rank = RANK_START;
    for (size_t k = 0; k < printer->sought_count; k++) {
        const int word = rank_of_word(printer->sought[k], path, key);
        if (word > rank) rank = word;
    }
    return rank == RANKS && is_term(printer, path) ? RANK_TEXT : rank;
}

static void visit_section(const gn_section *section, const char *above, gn_key_visit *visit,
                          void *context) {
    for (size_t k = 0; k < section->key_count; k++) {
        const gn_key *key = &section->keys[k];
        char path[GN_KEY_PATH_SIZE];
        snprintf(path, sizeof path, "%s%s%s", above, *above ? "." : "", key->name);
        visit(context, path, key);
        if (!key->section) continue;
        if (key->type == GN_KEY_LIST) strncat(path, "[]", sizeof path - strlen(path) - 1);
        visit_section(key->section, path, visit, context);
    }
}

void gn_scene_visit_keys(gn_key_visit *visit, void *context) {
    visit_section(&gn_scene_section, "", visit, context);
}

static void print_ranked(void *printer, const char *path, const gn_key *key) {
    if (rank_of(printer, path, key) == ((key_printer *)printer)->rank)
        print_key(printer, path, key);
}

size_t gn_scene_print_keys(FILE *out, bool markdown, const char *const *sought,
                           size_t sought_count) {
    key_printer p = {
        .out = out, .markdown = markdown, .sought = sought, .sought_count = sought_count};
    if (markdown)
        fputs("# Keys of a scene\n\n"
              "Written by `gneiss keys --markdown` from the table that also drives the reading of "
              "scenes.\n"
              "A number may carry a unit, as in `23 mm`; without one it is in SI. `[]` stands for "
              "an element\n"
              "of a list; `--set` reaches it by index or name, as in `walls.top.motion.vz=0.1`.\n\n"
              "| key | value | default | meaning |\n| --- | --- | --- | --- |\n",
              out);
    print_foreign(&p);
    for (p.rank = 0; p.rank < RANKS; p.rank++)
        visit_section(&gn_scene_section, "", print_ranked, &p);
    return p.count;
}

void gn_section_print_keys(FILE *out, const gn_section *section) {
    key_printer p = {.out = out, .markdown = true};
    visit_section(section, "", print_ranked, &p);
}

/* ---- one key ---- */

static const gn_key *key_named(const gn_section *section, const char *name, size_t length) {
    for (size_t k = 0; section && k < section->key_count; k++)
        if (strncmp(section->keys[k].name, name, length) == 0 && !section->keys[k].name[length])
            return &section->keys[k];
    return NULL;
}

/* A step of a path is the name of a key in a section, any element of a list, or a component of a
 * value of several numbers; "materials.rock.friction" and "materials[0].friction" are equal. */
const gn_key *gn_scene_key_at(const char *path) {
    const gn_section *section = &gn_scene_section;
    const gn_key *key = NULL;
    while (*path) {
        bool inside = key && !section; /* inside a list or a value */
        size_t length = strcspn(path, ".[]");
        if (!inside) {
            key = key_named(section, path, length);
            if (!key && section == &gn_stage_section)
                key = key_named(&gn_scene_section, path, length);
            if (!key) return NULL;
        }
        section = inside || key->type == GN_KEY_SECTION ? key->section : NULL;
        path += length;
        path += *path == ']';
        path += *path == '.' || *path == '[';
    }
    return key;
}

/* ---- misspelt keys ---- */

typedef struct key_slip {
    gn_names names;
    char *name;
    size_t size;
} key_slip;

/* Offers a candidate, which is copied because a path is temporary. */
static void offer(key_slip *slip, const char *name) {
    size_t least = slip->names.least;
    gn_names_add(&slip->names, name);
    if (slip->names.least < least) snprintf(slip->name, slip->size, "%s", name);
}

static void offer_key(void *slip, const char *path, const gn_key *key) {
    offer(slip, key->name);
    offer(slip, path);
}

bool gn_scene_nearest_key(const char *sought, char *name, size_t size) {
    key_slip s = {gn_names_for(sought), name, size};
    *name = '\0';
    gn_scene_visit_keys(offer_key, &s);
    return *name != '\0';
}
