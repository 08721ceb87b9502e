/* Packings whose columns are named by a header. */
#include "base/memory.h"
#include "io/packing_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum kind {
    X,
    Y,
    Z,
    RADIUS,
    DIAMETER,
    ID,
    MATERIAL,
    TYPE,
    MAT_ID,
    GROUP,
    DENSITY,
    VX,
    VY,
    VZ,
    WX,
    WY,
    WZ,
    KINDS,
    SKIPPED = -1,
    UNKNOWN = -2
};

/* Columns that a header may name; `unit` "": a column without unit. */
static const struct {
    const char *name;
    int kind;
    const char *unit;
} names[] = {
    {"x", X, "m"},
    {"y", Y, "m"},
    {"z", Z, "m"},
    {"radius", RADIUS, "m"},
    {"r", RADIUS, "m"},
    {"diameter", DIAMETER, "m"},
    {"d", DIAMETER, "m"},
    {"id", ID, ""},
    {"material", MATERIAL, ""},
    {"type", TYPE, ""},
    {"matId", MAT_ID, ""},
    {"group", GROUP, ""},
    {"vx", VX, "m/s"},
    {"vy", VY, "m/s"},
    {"vz", VZ, "m/s"},
    {"wx", WX, "rad/s"},
    {"wy", WY, "rad/s"},
    {"wz", WZ, "rad/s"},
    {"density", DENSITY, "kg/m3"},
};
enum { NAMES = sizeof names / sizeof *names, MOST_GROUP = 1000000 };

static const char known_names[] = "x y z radius (r) diameter (d) id material type matId group "
                                  "density vx vy vz wx wy wz, or - for "
                                  "a column to skip";

static int find_name(const char *text, size_t length) {
    if (length == 1 && *text == '-') return SKIPPED;
    for (int k = 0; k < NAMES; k++)
        if (strlen(names[k].name) == length && strncasecmp(text, names[k].name, length) == 0)
            return names[k].kind;
    return UNKNOWN;
}

static const char *name_of(int kind) {
    for (int k = 0; k < NAMES; k++)
        if (names[k].kind == kind) return names[k].name;
    return "-";
}

static const char *unit_of(int kind) {
    for (int k = 0; k < NAMES; k++)
        if (names[k].kind == kind) return names[k].unit;
    return "";
}

/* ---- files of other programs ---- */

/* Tells whether a line of the text gives a number of atoms, as the header of LAMMPS data files. */
static bool counts_atoms(const char *text) {
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        const char *at = line + strspn(line, " \t");
        size_t digits = strspn(at, "0123456789");
        const char *word = at + digits + strspn(at + digits, " \t");
        if (digits && strncmp(word, "atoms", 5) == 0 && strchr(" \t\r\n", word[5])) return true;
    }
    return false;
}

static const char *foreign_format(const char *text) {
    static const char *const beginnings[][2] = {{"ITEM:", "a dump of LAMMPS or LIGGGHTS"},
                                                {"# vtk DataFile", "a VTK file"},
                                                {"<?xml", "an XML file, as VTK writes them"},
                                                {"<VTKFile", "a VTK file"},
                                                {"LSMGeometry", "a geometry of ESyS-Particle"}};
    for (size_t k = 0; k < sizeof beginnings / sizeof *beginnings; k++)
        if (strncmp(text, beginnings[k][0], strlen(beginnings[k][0])) == 0) return beginnings[k][1];
    return counts_atoms(text) ? "a data file of LAMMPS or LIGGGHTS" : NULL;
}

gneiss_status gn_packing_refuse_foreign(const gn_packing_reader *in) {
    char text[2048];
    struct stat info;
    if (fstat(fileno(in->file), &info) != 0 || !S_ISREG(info.st_mode)) return GNEISS_OK;
    size_t size = fread(text, 1, sizeof text - 1, in->file);
    rewind(in->file);
    text[size] = '\0';
    const char *found = foreign_format(text);
    if (!found) return GNEISS_OK;
    return gn_fail(in->error, GNEISS_ERROR_INPUT,
                   "%s:1:1: expected rows x y z r or named columns, found %s: gneiss convert %s "
                   "NEW.txt",
                   in->path, found, in->path);
}

/* ---- header ---- */

/* A word of a header: a name, and after it the unit in brackets. */
typedef struct word {
    size_t at, length, unit_at, unit_length; /* base 0; unit_at 0: no unit */
} word;

/* Takes the next word that begins at *at or after it; false: there is none. `broken` if a bracket
 * is not closed. */
static bool next_word(const char *text, size_t *at, char separator, word *out, bool *broken) {
    const char *ends = separator == '_' ? " \t\v\f_" : " \t\v\f,[(";
    size_t k = *at;
    *out = (word){0};
    while (gn_packing_is_blank(text[k]) || text[k] == separator) k++;
    if (!text[k]) return false;
    out->at = k;
    out->length = text[k] == '"' && strchr(text + k + 1, '"')
                      ? (size_t)(strchr(text + k + 1, '"') - (text + k)) + 1
                      : strcspn(text + k, ends);
    k += out->length;
    size_t open = k + strspn(text + k, " \t\v\f");
    if (text[open] == '[' || text[open] == '(') {
        const char *close = strchr(text + open, text[open] == '[' ? ']' : ')');
        *broken = !close;
        if (!close) return true;
        out->unit_at = open + 1;
        out->unit_length = (size_t)(close - text) - open - 1;
        k = (size_t)(close - text) + 1;
    }
    if (text[out->at] == '"' && out->length > 1) {
        out->at++;
        out->length -= 2;
    }
    *at = k;
    return true;
}

/* Reads the unit of a column as its factor to SI. */
static gneiss_status read_unit(gn_packing_reader *in, const word *given, int kind, double *factor) {
    char text[64], reason[128] = "", seen[48];
    const char *unit = unit_of(kind);
    gn_packing_shown(in->text + given->unit_at, given->unit_length, seen);
    if (!*unit)
        return gn_packing_refuse(in, given->unit_at, "expected no unit of %s, found '%s'",
                                 name_of(kind), seen);
    snprintf(text, sizeof text, "1 %.*s", (int)(given->unit_length < 60 ? given->unit_length : 60),
             in->text + given->unit_at);
    if (!in->words->unit(in->words->units, text, unit, factor, reason, sizeof reason))
        return gn_packing_refuse(in, given->unit_at, "expected a unit such as %s, found '%s'%s%s",
                                 unit, seen, *reason ? ": " : "", reason);
    const bool length = strcmp(unit, "m") == 0;
    if (length && in->scale != 1.0)
        return gn_packing_refuse(in, given->unit_at,
                                 "expected units of lengths either in the header or by "
                                 "specimen.scale, found '%s' and a scale of %g",
                                 seen, in->scale);
    in->states_units = in->states_units || length;
    if (isfinite(*factor) && *factor > 0.0) return GNEISS_OK;
    return gn_packing_refuse(in, given->unit_at, "expected a unit such as %s, found '%s'", unit,
                             seen);
}

/* Adds a column; lengths without a unit are multiplied by the scale of the file. */
static gneiss_status add_column(gn_packing_reader *in, const word *given, int kind) {
    double factor = 1.0;
    char seen[48];
    gn_packing_shown(in->text + given->at, given->length, seen);
    if (in->named == GN_PACKING_COLUMNS)
        return gn_packing_refuse(in, given->at, "expected at most %d columns, found '%s' besides",
                                 GN_PACKING_COLUMNS, seen);
    if (kind == UNKNOWN)
        return gn_packing_refuse(in, given->at, "expected a column named %s; found '%s'",
                                 known_names, seen);
    for (size_t k = 0; kind != SKIPPED && k < in->named; k++)
        if (in->column[k].kind == kind)
            return gn_packing_refuse(in, given->at, "expected every column once, found '%s' again",
                                     seen);
    if (kind != SKIPPED && given->unit_at)
        GN_TRY(read_unit(in, given, kind, &factor));
    else if (kind >= 0 && strcmp(unit_of(kind), "m") == 0)
        factor = in->scale;
    else if (kind >= 0 && *unit_of(kind) && in->scale != 1.0 && kind < WX && kind != DENSITY)
        return gn_packing_refuse(in, given->at,
                                 "expected a unit, such as %s[m/s], beside specimen.scale, which "
                                 "is for lengths alone",
                                 seen);
    in->column[in->named++] = (gn_packing_column){kind, factor};
    return GNEISS_OK;
}

static bool has(const gn_packing_reader *in, int kind) {
    for (size_t k = 0; k < in->named; k++)
        if (in->column[k].kind == kind) return true;
    return false;
}

/* Checks a header that has been read completely. */
static gneiss_status check_header(const gn_packing_reader *in, size_t end) {
    static const int exclusive[][2] = {
        {RADIUS, DIAMETER}, {MATERIAL, TYPE}, {MATERIAL, MAT_ID}, {TYPE, MAT_ID}};
    for (int kind = X; kind <= Z; kind++)
        if (!has(in, kind) && (kind != Z || in->dimension == 3))
            return gn_packing_refuse(in, end, "expected a column %s, found none", name_of(kind));
    if (!has(in, RADIUS) && !has(in, DIAMETER))
        return gn_packing_refuse(in, end, "expected a column radius or diameter, found none");
    for (size_t k = 0; k < sizeof exclusive / sizeof *exclusive; k++)
        if (has(in, exclusive[k][0]) && has(in, exclusive[k][1]))
            return gn_packing_refuse(in, end, "expected one of the columns %s and %s, found both",
                                     name_of(exclusive[k][0]), name_of(exclusive[k][1]));
    return GNEISS_OK;
}

/* Reads all words from position *at. */
static gneiss_status read_header(gn_packing_reader *in, size_t at, char separator) {
    word next;
    bool broken = false;
    while (next_word(in->text, &at, separator, &next, &broken)) {
        if (broken)
            return gn_packing_refuse(in, next.at + next.length,
                                     "expected a unit in brackets, found no closing one");
        GN_TRY(add_column(in, &next, find_name(in->text + next.at, next.length)));
    }
    return check_header(in, at);
}

/* Tells whether all words from position `at` are names of columns that include x, y and a radius.
 * The plain rows x y z r and x y r are excluded. */
static bool names_columns(const gn_packing_reader *in, size_t at, char separator) {
    static const int plain[2][4] = {{X, Y, Z, RADIUS}, {X, Y, RADIUS, UNKNOWN}};
    bool seen[KINDS] = {false}, broken = false, is_plain[2] = {true, true};
    size_t count = 0;
    word next;
    while (next_word(in->text, &at, separator, &next, &broken)) {
        int kind = find_name(in->text + next.at, next.length);
        if (kind == UNKNOWN || broken) return false;
        if (kind >= 0) seen[kind] = true;
        for (int p = 0; p < 2; p++)
            is_plain[p] = is_plain[p] && count < 4 && plain[p][count] == kind;
        count++;
    }
    if ((count == 4 && is_plain[0]) || (count == 3 && is_plain[1])) return false;
    return seen[X] && seen[Y] && (seen[RADIUS] || seen[DIAMETER]);
}

gneiss_status gn_packing_comment_header(gn_packing_reader *in) {
    static const char yade[] = "format";
    size_t at = strspn(in->text, " \t\v\f") + 1;
    char separator = ',';
    at += strspn(in->text + at, " \t\v\f#");
    if (strncmp(in->text + at, yade, sizeof yade - 1) == 0 &&
        gn_packing_is_blank(in->text[at + sizeof yade - 1])) {
        at += sizeof yade - 1;
        separator = '_';
    }
    return names_columns(in, at, separator) ? read_header(in, at, separator) : GNEISS_OK;
}

gneiss_status gn_packing_row_header(gn_packing_reader *in, bool *is_header) {
    size_t at = strspn(in->text, " \t\v\f");
    char first = in->text[at] == '"' ? in->text[at + 1] : in->text[at];
    word next;
    bool broken = false;
    size_t from = at;
    *is_header = false;
    if (!next_word(in->text, &from, ',', &next, &broken)) return GNEISS_OK;
    /* nan and inf begin with letters, but count as numbers (which are not finite). */
    bool letter = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
    bool number = next.length >= 3 && (strncasecmp(in->text + next.at, "nan", 3) == 0 ||
                                       strncasecmp(in->text + next.at, "inf", 3) == 0);
    if ((!letter || number) && find_name(in->text + next.at, next.length) != SKIPPED)
        return GNEISS_OK;
    *is_header = true;
    return read_header(in, at, ',');
}

/* ---- rows ---- */

static gneiss_status read_whole(const gn_packing_reader *in, gn_packing_field field, int kind,
                                double least, double most, double *value) {
    GN_TRY(gn_packing_number(in, field, value));
    if (*value == floor(*value) && *value >= least && *value <= most) return GNEISS_OK;
    return gn_packing_refuse(in, field.at,
                             "expected a whole number from %.0f to %.0f of %s, found "
                             "%.17g",
                             least, most, name_of(kind), *value);
}

static gneiss_status read_material(const gn_packing_reader *in, gn_packing_field field,
                                   double *value) {
    char name[64], seen[48];
    const bool quoted = in->text[field.at] == '"' && field.length > 1;
    const size_t at = field.at + quoted, length = field.length - 2 * quoted;
    snprintf(name, sizeof name, "%.*s", (int)(length < 63 ? length : 63), in->text + at);
    *value = in->words->material(in->words->materials, name);
    if (*value >= 0 && length < 63) return GNEISS_OK;
    return gn_packing_refuse(in, at, "expected the name of a material of the scene, found '%s'",
                             gn_packing_shown(in->text + at, length, seen));
}

static gneiss_status read_field(const gn_packing_reader *in, gn_packing_column column,
                                gn_packing_field field, double *value) {
    const double materials = (double)in->words->material_count, exact = 9007199254740992.0;
    char seen[48];
    switch (column.kind) {
    case MATERIAL:
        return read_material(in, field, value);
    case ID:
        return read_whole(in, field, ID, 0.0, exact, value);
    case GROUP:
        return read_whole(in, field, GROUP, 0.0, MOST_GROUP, value);
    case TYPE:
        GN_TRY(read_whole(in, field, TYPE, 1.0, materials, value));
        *value -= 1.0;
        return GNEISS_OK;
    case MAT_ID:
        return read_whole(in, field, MAT_ID, 0.0, materials - 1.0, value);
    default:
        GN_TRY(gn_packing_number(in, field, value));
    }
    *value *= column.factor;
    if (!isfinite(*value))
        return gn_packing_refuse(in, field.at, "expected a finite number, found '%s' (too large)",
                                 gn_packing_shown(in->text + field.at, field.length, seen));
    const bool positive =
        column.kind == RADIUS || column.kind == DIAMETER || column.kind == DENSITY;
    if (!positive || *value > 0.0) return GNEISS_OK;
    return gn_packing_refuse(in, field.at, "expected a %s > 0, found %g", name_of(column.kind),
                             *value / column.factor);
}

/* Checks a row of a packing in 2D: z is the same in all rows, and no velocity is out of the plane.
 */
static gneiss_status check_plane(gn_packing_reader *in, const gn_packing *packing, int kind,
                                 size_t at, double value) {
    if (in->dimension == 3) return GNEISS_OK;
    if (kind == Z && packing->count == 0) in->plane = value;
    if (kind == Z && value != in->plane)
        return gn_packing_refuse(in, at, "expected z = %g m as above (two dimensions), found %g m",
                                 in->plane, value);
    if ((kind == VZ || kind == WX || kind == WY) && value != 0.0)
        return gn_packing_refuse(in, at, "expected %s = 0 (two dimensions), found %g",
                                 name_of(kind), value);
    return GNEISS_OK;
}

/* Makes the arrays of the columns that the header names. */
static gneiss_status make_columns(gn_packing_reader *in, gn_packing *packing) {
    gn_particle_columns *c = &packing->columns;
    bool moves = false, room = true;
    c->states_units = in->states_units;
    for (int kind = VX; kind <= WZ; kind++) moves = moves || has(in, kind);
    if (has(in, MATERIAL) || has(in, TYPE) || has(in, MAT_ID))
        room = (c->material = gn_alloc(sizeof *c->material));
    if (has(in, GROUP)) room = room && (c->group = gn_alloc(sizeof *c->group));
    if (has(in, DENSITY)) room = room && (c->density = gn_alloc(sizeof *c->density));
    if (moves) room = room && (c->motion = gn_alloc(sizeof *c->motion));
    if (has(in, ID)) room = room && (in->id = gn_alloc(sizeof *in->id));
    return room ? GNEISS_OK : gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory", in->path);
}

static void put_row(gn_packing_reader *in, gn_packing *packing, const double value[KINDS]) {
    gn_particle_columns *c = &packing->columns;
    const size_t p = packing->count++;
    double *sphere = packing->sphere + 4 * p;
    for (int a = 0; a < 2; a++) sphere[a] = value[X + a];
    sphere[2] = in->dimension == 3 ? value[Z] : 0.0;
    sphere[3] = has(in, RADIUS) ? value[RADIUS] : 0.5 * value[DIAMETER];
    if (c->material)
        c->material[p] = (int32_t)value[has(in, MATERIAL) ? MATERIAL
                                        : has(in, TYPE)   ? TYPE
                                                          : MAT_ID];
    if (c->group) c->group[p] = (int32_t)value[GROUP];
    if (c->density) c->density[p] = value[DENSITY];
    for (int a = 0; c->motion && a < 6; a++) c->motion[6 * p + (size_t)a] = value[VX + a];
}

gneiss_status gn_packing_named_row(gn_packing_reader *in, gn_packing *packing) {
    gn_packing_field field[GN_PACKING_COLUMNS + 1];
    double value[KINDS] = {0};
    size_t count;
    GN_TRY(gn_packing_split(in, field, in->named, &count));
    if (count == 0) return GNEISS_OK;
    if (count != in->named)
        return gn_packing_refuse(in, count > in->named ? field[in->named].at : in->length,
                                 "expected %zu columns as in the header, found %s", in->named,
                                 count > in->named ? "more" : "fewer");
    if (packing->count == 0 && !in->capacity) GN_TRY(make_columns(in, packing));
    GN_TRY(gn_packing_grow(in, packing));
    for (size_t k = 0; k < count; k++) {
        const int kind = in->column[k].kind;
        if (kind == SKIPPED) continue;
        GN_TRY(read_field(in, in->column[k], field[k], &value[kind]));
        GN_TRY(check_plane(in, packing, kind, field[k].at, value[kind]));
        if (kind == ID)
            in->id[packing->count] =
                (gn_packing_id){(int64_t)value[ID], packing->count, in->line, field[k].at};
    }
    put_row(in, packing, value);
    return GNEISS_OK;
}

/* ---- order ---- */

static int by_id(const void *a, const void *b) {
    const gn_packing_id *p = a, *q = b;
    if (p->id != q->id) return p->id < q->id ? -1 : 1;
    return p->row < q->row ? -1 : p->row > q->row;
}

/* Sorts the items of a block by id. */
static bool reorder(const gn_packing_id *id, size_t count, void *block, size_t size) {
    char *old, *sorted = gn_alloc_array(count, size);
    memcpy(&old, block, sizeof old);
    if (!old || !sorted) {
        gn_free(sorted);
        return !old;
    }
    for (size_t k = 0; k < count; k++) memcpy(sorted + k * size, old + id[k].row * size, size);
    gn_free(old);
    memcpy(block, &sorted, sizeof sorted);
    return true;
}

gneiss_status gn_packing_sort(gn_packing_reader *in, gn_packing *packing) {
    gn_particle_columns *c = &packing->columns;
    const size_t n = packing->count;
    bool sorted = true;
    if (!in->id) return GNEISS_OK;
    qsort(in->id, n, sizeof *in->id, by_id);
    for (size_t k = 0; k < n; k++) {
        sorted = sorted && in->id[k].row == k;
        c->renumbered = c->renumbered || in->id[k].id != (int64_t)k;
        if (k == 0 || in->id[k].id != in->id[k - 1].id) continue;
        in->line = in->id[k].line;
        return gn_packing_refuse(in, in->id[k].at,
                                 "expected every id once, found %lld again (line "
                                 "%zu)",
                                 (long long)in->id[k].id, in->id[k - 1].line);
    }
    bool room = sorted || (reorder(in->id, n, &packing->sphere, 4 * sizeof(double)) &&
                           reorder(in->id, n, &c->material, sizeof(int32_t)) &&
                           reorder(in->id, n, &c->group, sizeof(int32_t)) &&
                           reorder(in->id, n, &c->density, sizeof(double)) &&
                           reorder(in->id, n, &c->motion, 6 * sizeof(double)));
    return room ? GNEISS_OK
                : gn_fail(in->error, GNEISS_ERROR_MEMORY, "%s: no memory for %zu particles",
                          in->path, n);
}
