/* Surfaces of PLY (text and binary) and OBJ: corners of triangles. Formats: Turk (1994), "The PLY
 * polygon file format"; Wavefront (1995), "Object files (.obj)". */
#include "base/memory.h"
#include "mesh/mesh_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POLYGON = 1024, PROPERTIES = 64, ELEMENTS = 16 };

/* ---- polygons ---- */

static void normal_of(const double *a, const double *b, const double *c, double n[3]) {
    double u[3], v[3];
    gn_mesh_between(a, b, u);
    gn_mesh_between(a, c, v);
    gn_mesh_cross(u, v, n);
}

/* Tells whether all triangles from corner `first` have the sense of the polygon. */
static bool is_fan(const gn_mesh_soup *soup, const int64_t *corner, int count, int first,
                   const double whole[3]) {
    for (int t = 1; t < count - 1; t++) {
        double n[3];
        normal_of(soup->point + 3 * corner[first], soup->point + 3 * corner[(first + t) % count],
                  soup->point + 3 * corner[(first + t + 1) % count], n);
        if (gn_mesh_dot(n, whole) < 0.0) return false;
    }
    return true;
}

/* Returns the corner from which a polygon is divided into a fan; -1: there is none. */
static int find_fan(const gn_mesh_soup *soup, const int64_t *corner, int count) {
    double whole[3] = {0, 0, 0}, n[3];
    for (int k = 1; k < count - 1; k++) {
        normal_of(soup->point + 3 * corner[0], soup->point + 3 * corner[k],
                  soup->point + 3 * corner[k + 1], n);
        for (int d = 0; d < 3; d++) whole[d] += n[d];
    }
    for (int first = 0; first < count; first++)
        if (is_fan(soup, corner, count, first, whole)) return first;
    return -1;
}

static gneiss_status add_polygon(gn_mesh_source *in, gn_mesh_soup *soup, size_t at,
                                 const int64_t *corner, int count) {
    if (count < 3)
        return gn_mesh_refuse(in, at, "expected a face of at least 3 corners, found %d", count);
    for (int k = 0; k < count; k++)
        if (corner[k] < 0 || corner[k] >= (int64_t)soup->points)
            return gn_mesh_refuse(in, at,
                                  "expected corners among %zu vertices, found number %lld "
                                  "(base 0)",
                                  soup->points, (long long)corner[k]);
    const int first = count == 3 ? 0 : find_fan(soup, corner, count);
    if (first < 0)
        return gn_mesh_refuse(in, at,
                              "expected a face that lines from one corner divide into triangles, "
                              "found a re-entrant one of %d corners; the program that made it can "
                              "triangulate it",
                              count);
    if (soup->count > INT32_MAX - 3 * (size_t)count)
        return gn_mesh_refuse(in, at, "expected at most %d triangles", INT32_MAX / 3);
    void *block = soup->corner;
    const size_t more = 3 * (size_t)(count - 2);
    if (!gn_mesh_grow(&block, &soup->capacity, soup->count, soup->count + more, 3 * sizeof(double)))
        return gn_mesh_no_memory(in);
    soup->corner = block;
    soup->polygons += count > 3;
    for (int t = 1; t < count - 1; t++)
        for (int k = 0; k < 3; k++) {
            const int64_t one = corner[(first + (k ? t + k - 1 : 0)) % count];
            memcpy(soup->corner + 3 * soup->count++, soup->point + 3 * one, 3 * sizeof(double));
        }
    return GNEISS_OK;
}

static gneiss_status add_point(gn_mesh_source *in, gn_mesh_soup *soup, const double x[3]) {
    void *block = soup->point;
    if (!gn_mesh_grow(&block, &soup->point_capacity, soup->points, soup->points + 1,
                      3 * sizeof(double)))
        return gn_mesh_no_memory(in);
    soup->point = block;
    memcpy(soup->point + 3 * soup->points++, x, 3 * sizeof *x);
    return GNEISS_OK;
}

static bool is_line_end(unsigned char c) {
    return c == '\n' || c == '\r';
}

static void skip_line(gn_mesh_source *in) {
    while (in->at < in->end && !is_line_end(in->bytes[in->at])) in->at++;
}

/* ---- OBJ ---- */

/* A backslash at the end of a line continues it. */
static void join_lines(gn_mesh_source *in) {
    for (size_t k = 0; k + 1 < in->size; k++) {
        if (in->bytes[k] != '\\' || !is_line_end(in->bytes[k + 1])) continue;
        bool both = in->bytes[k + 1] == '\r' && in->bytes[k + 2] == '\n';
        memset(in->bytes + k, ' ', both ? 3 : 2);
    }
}

/* Reads a face: vertex, vertex/texture, vertex//normal or all three; negative numbers count from
 * the last vertex. */
static gneiss_status read_face(gn_mesh_source *in, gn_mesh_soup *soup, size_t line) {
    int64_t corner[POLYGON];
    int count = 0;
    for (;;) {
        size_t start = gn_mesh_field_start(in), length;
        if (in->at == in->end || is_line_end(in->bytes[in->at]) || in->bytes[in->at] == '#') break;
        if (count == POLYGON)
            return gn_mesh_refuse(in, start, "expected at most %d corners", POLYGON);
        GN_TRY(gn_mesh_take_field(in, "a corner", &start, &length));
        char *end;
        long long number = strtoll((const char *)in->bytes + start, &end, 10);
        const size_t digits = (size_t)(end - (const char *)in->bytes) - start;
        if (!digits || digits > 18 || (digits < length && *end != '/') || number == 0)
            return gn_mesh_refuse(in, start, "expected the number of a vertex, found '%s'",
                                  gn_mesh_show(in, start).text);
        corner[count++] = number > 0 ? number - 1 : (int64_t)soup->points + number;
    }
    return add_polygon(in, soup, line, corner, count);
}

gneiss_status gn_mesh_obj_corners(gn_mesh_source *in, gn_mesh_soup *soup) {
    join_lines(in);
    for (gn_mesh_next_row(in); in->at < in->end; gn_mesh_next_row(in)) {
        size_t start, length;
        double x[3];
        GN_TRY(gn_mesh_take_field(in, "a line of an OBJ file", &start, &length));
        const char kind = length == 1 ? (char)in->bytes[start] : '#';
        if (kind == 'v') {
            GN_TRY(gn_mesh_take_coordinates(in, x));
            GN_TRY(add_point(in, soup, x));
        }
        if (kind == 'f') GN_TRY(read_face(in, soup, start));
        skip_line(in);
    }
    return GNEISS_OK;
}

/* ---- PLY ---- */

typedef struct ply_type {
    const char *names[2];
    size_t bytes;
    char kind; /* u, i, f */
} ply_type;

static const ply_type ply_types[] = {
    {{"char", "int8"}, 1, 'i'},     {{"uchar", "uint8"}, 1, 'u'},    {{"short", "int16"}, 2, 'i'},
    {{"ushort", "uint16"}, 2, 'u'}, {{"int", "int32"}, 4, 'i'},      {{"uint", "uint32"}, 4, 'u'},
    {{"float", "float32"}, 4, 'f'}, {{"double", "float64"}, 8, 'f'},
};

/* `use`: 0 to 2: a coordinate, 3: the corners of a face, -1: skipped. */
typedef struct ply_property {
    const ply_type *count, *type; /* count NULL: one value */
    int use;
} ply_property;

typedef struct ply_element {
    bool vertex, face;
    int64_t count;
    int first, past; /* properties */
} ply_element;

typedef struct ply {
    gn_mesh_source *in;
    bool text, big;
    ply_element element[ELEMENTS];
    ply_property property[PROPERTIES];
    int elements, properties;
} ply;

static bool is_word(const gn_mesh_source *in, size_t start, size_t length, const char *word) {
    return length == strlen(word) && memcmp(in->bytes + start, word, length) == 0;
}

static gneiss_status take_ply_type(gn_mesh_source *in, const ply_type **type) {
    size_t start, length;
    GN_TRY(gn_mesh_take_field(in, "a type of numbers", &start, &length));
    for (size_t k = 0; k < sizeof ply_types / sizeof *ply_types; k++)
        for (int n = 0; n < 2; n++)
            if (is_word(in, start, length, ply_types[k].names[n])) {
                *type = &ply_types[k];
                return GNEISS_OK;
            }
    return gn_mesh_refuse(in, start, "expected a type of numbers (int, float, ...), found '%s'",
                          gn_mesh_show(in, start).text);
}

static gneiss_status read_property(ply *file) {
    gn_mesh_source *in = file->in;
    ply_property *p = &file->property[file->properties];
    size_t start = in->at, length;
    if (!file->elements || file->properties == PROPERTIES)
        return gn_mesh_refuse(in, start, "expected at most %d properties, behind an element",
                              PROPERTIES);
    *p = (ply_property){.use = -1};
    start = gn_mesh_field_start(in);
    if (in->end - start > 5 && memcmp(in->bytes + start, "list ", 5) == 0) {
        in->at = start + 5;
        GN_TRY(take_ply_type(in, &p->count));
    }
    GN_TRY(take_ply_type(in, &p->type));
    GN_TRY(gn_mesh_take_field(in, "the name of a property", &start, &length));
    ply_element *e = &file->element[file->elements - 1];
    if (e->vertex && !p->count && length == 1 && in->bytes[start] >= 'x' && in->bytes[start] <= 'z')
        p->use = in->bytes[start] - 'x';
    if (e->face && p->count &&
        (is_word(in, start, length, "vertex_indices") ||
         is_word(in, start, length, "vertex_index")))
        p->use = 3;
    e->past = ++file->properties;
    return GNEISS_OK;
}

static gneiss_status read_element(ply *file) {
    gn_mesh_source *in = file->in;
    size_t start = in->at, length;
    if (file->elements == ELEMENTS)
        return gn_mesh_refuse(in, start, "expected at most %d kinds of elements", ELEMENTS);
    ply_element *e = &file->element[file->elements++];
    GN_TRY(gn_mesh_take_field(in, "the name of an element", &start, &length));
    *e = (ply_element){.vertex = is_word(in, start, length, "vertex"),
                       .face = is_word(in, start, length, "face"),
                       .first = file->properties,
                       .past = file->properties};
    return gn_mesh_take_integer(in, "number of elements", 8, 0, INT32_MAX, &e->count);
}

static gneiss_status read_format(ply *file) {
    gn_mesh_source *in = file->in;
    size_t start, length;
    GN_TRY(gn_mesh_take_field(in, "ascii, binary_little_endian or binary_big_endian", &start,
                              &length));
    file->text = is_word(in, start, length, "ascii");
    file->big = is_word(in, start, length, "binary_big_endian");
    if (file->text || file->big || is_word(in, start, length, "binary_little_endian"))
        return GNEISS_OK;
    return gn_mesh_refuse(in, start,
                          "expected ascii, binary_little_endian or binary_big_endian, found '%s'",
                          gn_mesh_show(in, start).text);
}

static gneiss_status read_ply_header(ply *file) {
    gn_mesh_source *in = file->in;
    bool has_format = false;
    for (;;) {
        size_t start, length;
        skip_line(in);
        gn_mesh_next_row(in);
        GN_TRY(gn_mesh_take_field(in, "end_header", &start, &length));
        if (is_word(in, start, length, "end_header")) break;
        if (is_word(in, start, length, "format")) {
            has_format = true;
            GN_TRY(read_format(file));
        } else if (is_word(in, start, length, "element")) {
            GN_TRY(read_element(file));
        } else if (is_word(in, start, length, "property")) {
            GN_TRY(read_property(file));
        } else if (!is_word(in, start, length, "comment") &&
                   !is_word(in, start, length, "obj_info")) {
            return gn_mesh_refuse(in, start,
                                  "expected format, element, property or end_header, found '%s'",
                                  gn_mesh_show(in, start).text);
        }
    }
    if (!has_format) return gn_mesh_refuse(in, in->at, "expected a line 'format', found none");
    if (in->at < in->end && in->bytes[in->at] == '\r') in->at++;
    if (in->at < in->end && in->bytes[in->at] == '\n') in->at++;
    in->by_offset = !file->text;
    return GNEISS_OK;
}

static double number_of(const ply *file, const ply_type *type, const unsigned char *bytes) {
    uint64_t bits = 0;
    for (size_t k = 0; k < type->bytes; k++)
        bits |= (uint64_t)bytes[file->big ? type->bytes - 1 - k : k] << 8 * k;
    if (type->kind == 'f' && type->bytes == 8) {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (type->kind == 'f') {
        uint32_t narrow = (uint32_t)bits;
        float value;
        memcpy(&value, &narrow, sizeof value);
        return (double)value;
    }
    if (type->kind == 'u') return (double)bits;
    const uint64_t sign = UINT64_C(1) << (8 * type->bytes - 1);
    return (double)(int64_t)((bits ^ sign) - sign);
}

static gneiss_status take_number(ply *file, const ply_type *type, const char *what, double *value) {
    gn_mesh_source *in = file->in;
    size_t start = in->at, length;
    if (!file->text) {
        if (in->end - in->at < type->bytes)
            return gn_mesh_refuse(in, in->at, "expected %s, found the end of the file", what);
        *value = number_of(file, type, in->bytes + in->at);
        in->at += type->bytes;
        return GNEISS_OK;
    }
    gn_mesh_next_row(in);
    GN_TRY(gn_mesh_take_field(in, what, &start, &length));
    char *end;
    *value = strtod((const char *)in->bytes + start, &end);
    if ((size_t)(end - (const char *)in->bytes) - start == length) return GNEISS_OK;
    return gn_mesh_refuse(in, start, "expected %s, found '%s'", what, gn_mesh_show(in, start).text);
}

static gneiss_status read_ply_row(ply *file, const ply_element *e, gn_mesh_soup *soup) {
    gn_mesh_source *in = file->in;
    double x[3] = {0, 0, 0}, value = 0.0;
    int64_t corner[POLYGON];
    if (file->text) gn_mesh_next_row(in);
    const size_t row = in->at;
    int corners = 0;
    for (int k = e->first; k < e->past; k++) {
        const ply_property *p = &file->property[k];
        double count = 1.0;
        size_t at = in->at;
        if (p->count) GN_TRY(take_number(file, p->count, "the length of a list", &count));
        if (!(count >= 0.0 && count <= (p->use == 3 ? POLYGON : INT32_MAX)))
            return gn_mesh_refuse(in, at, "expected a list of at most %d entries, found %g",
                                  p->use == 3 ? POLYGON : INT32_MAX, count);
        for (int n = 0; n < (int)count; n++) {
            if (file->text) gn_mesh_next_row(in);
            at = in->at;
            GN_TRY(take_number(file, p->type, "a number", &value));
            if (p->use >= 0 && p->use < 3 && !isfinite(value * in->scale))
                return gn_mesh_refuse(in, at, "expected a finite coordinate, found %g", value);
            if (p->use >= 0 && p->use < 3) x[p->use] = value * in->scale;
            if (p->use == 3) corner[corners++] = value >= 0.0 && value < 9e15 ? (int64_t)value : -1;
        }
    }
    if (e->vertex) return add_point(in, soup, x);
    return e->face ? add_polygon(in, soup, row, corner, corners) : GNEISS_OK;
}

static bool has_use(const ply *file, const ply_element *e, int use) {
    for (int k = e->first; k < e->past; k++)
        if (file->property[k].use == use) return true;
    return false;
}

static gneiss_status check_ply(const ply *file) {
    gn_mesh_source *in = file->in;
    bool vertices = false, faces = false;
    for (int k = 0; k < file->elements; k++) {
        const ply_element *e = &file->element[k];
        vertices |= e->vertex && has_use(file, e, 0) && has_use(file, e, 1) && has_use(file, e, 2);
        faces |= vertices && e->face && has_use(file, e, 3);
    }
    if (faces) return GNEISS_OK;
    return gn_mesh_refuse(in, in->at,
                          "expected an element vertex with x, y and z, and one face with a list "
                          "vertex_indices behind it, found none");
}

gneiss_status gn_mesh_ply_corners(gn_mesh_source *in, gn_mesh_soup *soup) {
    ply *file = calloc(1, sizeof *file);
    if (!file) return gn_mesh_no_memory(in);
    file->in = in;
    gneiss_status status = read_ply_header(file);
    if (status == GNEISS_OK) status = check_ply(file);
    for (int k = 0; status == GNEISS_OK && k < file->elements; k++) {
        const ply_element *e = &file->element[k];
        /* A row without properties takes no bytes; nothing is read of such elements. */
        for (int64_t n = 0; e->past > e->first && status == GNEISS_OK && n < e->count; n++)
            status = read_ply_row(file, e, soup);
    }
    free(file);
    return status;
}
