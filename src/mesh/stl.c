/* Surfaces: corners of triangles of STL, text and binary, and of other formats, welded to a mesh.
 */
#include "mesh/mesh_private.h"

#include "base/memory.h"

#include <locale.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { HEADER_BYTES = 84, FACET_BYTES = 50, FACET_CORNERS = 9 };

static uint32_t little_endian(const unsigned char *b) {
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static gneiss_status read_binary(gn_mesh_source *in, gn_mesh_soup *out) {
    size_t triangles = (in->size - HEADER_BYTES) / FACET_BYTES;
    if (triangles == 0) return gn_mesh_refuse(in, 80, "expected triangles, found a count of 0");
    if (triangles > INT32_MAX / 3)
        return gn_mesh_refuse(in, 80, "expected at most %d triangles, found %zu", INT32_MAX / 3,
                              triangles);
    out->corner = gn_alloc_array(triangles, FACET_CORNERS * sizeof *out->corner);
    if (!out->corner) return gn_mesh_no_memory(in);
    for (size_t t = 0; t < triangles; t++) {
        size_t at = HEADER_BYTES + t * FACET_BYTES + 12; /* position after the normal */
        for (size_t k = 0; k < FACET_CORNERS; k++) {
            uint32_t bits = little_endian(in->bytes + at + 4 * k);
            float value;
            memcpy(&value, &bits, sizeof value);
            double x = (double)value * in->scale;
            if (!isfinite(x))
                return gn_mesh_refuse(in, at + 4 * k,
                                      "expected a finite coordinate, found %g times a scale of %g "
                                      "(triangle %zu)",
                                      (double)value, in->scale, t + 1);
            out->corner[FACET_CORNERS * t + k] = x;
        }
    }
    out->count = 3 * triangles;
    return GNEISS_OK;
}

static bool is_word(const gn_mesh_source *in, size_t start, size_t length, const char *word) {
    return length == strlen(word) &&
           strncasecmp((const char *)in->bytes + start, word, length) == 0;
}

/* Reads these words in this order; line breaks do not matter. */
static gneiss_status expect_words(gn_mesh_source *in, const char *const *words, size_t count) {
    for (size_t k = 0; k < count; k++) {
        size_t start, length;
        gn_mesh_next_row(in);
        GN_TRY(gn_mesh_take_field(in, words[k], &start, &length));
        if (!is_word(in, start, length, words[k]))
            return gn_mesh_refuse(in, start, "expected '%s', found '%s'", words[k],
                                  gn_mesh_show(in, start).text);
    }
    return GNEISS_OK;
}

/* Reads a facet after the word "facet". Normals are skipped: some programs write nan. */
static gneiss_status read_facet(gn_mesh_source *in, gn_mesh_soup *out) {
    static const char *const normal[] = {"normal"}, *const loop[] = {"outer", "loop"},
                             *const vertex[] = {"vertex"}, *const end[] = {"endloop", "endfacet"};
    void *corner = out->corner;
    if (!gn_mesh_grow(&corner, &out->capacity, out->count, out->count + 3, 3 * sizeof(double)))
        return gn_mesh_no_memory(in);
    out->corner = corner;
    GN_TRY(expect_words(in, normal, 1));
    GN_TRY(gn_mesh_skip_numbers(in, "a component of the normal", 3));
    GN_TRY(expect_words(in, loop, 2));
    for (size_t k = 0; k < 3; k++) {
        GN_TRY(expect_words(in, vertex, 1));
        GN_TRY(gn_mesh_take_coordinates(in, out->corner + 3 * (out->count + k)));
    }
    GN_TRY(expect_words(in, end, 2));
    out->count += 3;
    return GNEISS_OK;
}

static void skip_line(gn_mesh_source *in) {
    while (in->at < in->end && in->bytes[in->at] != '\n' && in->bytes[in->at] != '\r') in->at++;
}

/* Reads any number of solids: solid [name] facet ... endsolid [name]. */
static gneiss_status read_text(gn_mesh_source *in, gn_mesh_soup *out) {
    static const char *const solid[] = {"solid"};
    for (gn_mesh_next_row(in); in->at < in->end; gn_mesh_next_row(in)) {
        GN_TRY(expect_words(in, solid, 1));
        skip_line(in);
        for (;;) {
            size_t start, length;
            gn_mesh_next_row(in);
            GN_TRY(gn_mesh_take_field(in, "'facet' or 'endsolid'", &start, &length));
            if (is_word(in, start, length, "endsolid")) break;
            if (!is_word(in, start, length, "facet"))
                return gn_mesh_refuse(in, start, "expected 'facet' or 'endsolid', found '%s'",
                                      gn_mesh_show(in, start).text);
            if (out->count > INT32_MAX - 3)
                return gn_mesh_refuse(in, start, "expected at most %d triangles", INT32_MAX / 3);
            GN_TRY(read_facet(in, out));
        }
        skip_line(in);
    }
    if (out->count == 0) return gn_mesh_refuse(in, in->at, "expected triangles, found none");
    return GNEISS_OK;
}

/* Binary headers may begin with "solid" too, so that the size decides: four characters of a text,
 * read as a count, would imply a file of more than 7 GB. */
static gneiss_status read_corners(gn_mesh_source *in, gn_mesh_soup *out) {
    bool has_count = in->size >= HEADER_BYTES;
    uint64_t count = has_count ? little_endian(in->bytes + 80) : 0;
    uint64_t wanted = HEADER_BYTES + FACET_BYTES * count;
    in->by_offset = true;
    if (has_count && in->size == wanted) return read_binary(in, out);
    in->by_offset = false;
    gn_mesh_next_row(in);
    bool solid = in->size - in->at >= 5 && is_word(in, in->at, 5, "solid");
    const unsigned char *zero = memchr(in->bytes, 0, in->size);
    if (solid && !zero) return read_text(in, out);
    in->by_offset = true;
    if (!has_count)
        return gn_mesh_refuse(in, in->size,
                              "expected an STL text ('solid ...') or at least %d bytes of binary "
                              "STL, found the end of the file",
                              HEADER_BYTES);
    return gn_mesh_refuse(in, 80,
                          "expected an STL text ('solid ...') or a binary STL whose %llu triangles "
                          "take %llu bytes, found a file of %zu bytes",
                          (unsigned long long)count, (unsigned long long)wanted, in->size);
}

typedef gneiss_status corner_reader(gn_mesh_source *in, gn_mesh_soup *out);

/* PLY is recognised by its first word, OBJ by the name of the file. */
static corner_reader *reader_of(const gn_mesh_source *in) {
    const char *dot = strrchr(in->path, '.');
    if (in->size - in->at > 4 && memcmp(in->bytes + in->at, "ply", 3) == 0 &&
        gn_mesh_is_space(in->bytes[in->at + 3]))
        return gn_mesh_ply_corners;
    return dot && strcasecmp(dot, ".obj") == 0 ? gn_mesh_obj_corners : read_corners;
}

gneiss_status gn_mesh_read_surface(const char *path, double scale, gn_mesh *mesh,
                                   gneiss_error *error) {
    *mesh = (gn_mesh){.lines.nodes = 2, .triangles.nodes = 3, .tetrahedra.nodes = 4};
    gn_mesh_source in;
    gn_mesh_soup read = {0};
    gneiss_status status = gn_mesh_source_open(&in, path, scale, error);
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (status == GNEISS_OK && !plain) status = gn_mesh_no_memory(&in);
    if (status == GNEISS_OK) {
        locale_t before = uselocale(plain); /* the calling program may have set a decimal comma */
        status = reader_of(&in)(&in, &read);
        uselocale(before);
    }
    if (status == GNEISS_OK && read.count == 0)
        status = gn_mesh_refuse(&in, in.at, "expected faces, found none");
    if (plain) freelocale(plain);
    gn_mesh_source_close(&in);
    mesh->changes.polygons = read.polygons;
    if (status == GNEISS_OK) status = gn_mesh_weld(read.corner, read.count, path, mesh, error);
    gn_free(read.corner);
    gn_free(read.point);
    if (status != GNEISS_OK) gn_mesh_free(mesh);
    return status;
}
