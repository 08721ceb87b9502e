/* Mesh files made by hand: one small mesh in both versions of .msh and in STL, as text and binary.
 */
#ifndef GN_TESTS_MESH_FILES_H
#define GN_TESTS_MESH_FILES_H

#include "io_helpers.h"

#include "base/memory.h"
#include "mesh/mesh.h"

/* Bytes that grow up to a limit that no test reaches. */
typedef struct bytes {
    unsigned char at[1 << 16];
    size_t size;
} bytes;

static inline void put(bytes *out, const void *what, size_t size) {
    assert_true(out->size + size <= sizeof out->at);
    memcpy(out->at + out->size, what, size);
    out->size += size;
}

__attribute__((format(printf, 2, 3))) static inline void put_text(bytes *out, const char *format,
                                                                  ...) {
    char line[4096];
    va_list args;
    va_start(args, format);
    int size = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    assert_in_range(size, 0, sizeof line - 1);
    put(out, line, (size_t)size);
}

static inline void spill(const char *path, const void *what, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    if (size) assert_int_equal(fwrite(what, 1, size, f), size);
    fclose(f);
}

static inline void spill_bytes(const fixture *f, const bytes *b) {
    spill(f->path, b->at, b->size);
}

static inline void spill_text(const fixture *f, const char *text) {
    spill(f->path, text, strlen(text));
}

/* Appends an integer of that width, or a number, in the byte order of the format. */
static inline void put_int(bytes *out, bool binary, size_t width, int64_t value) {
    if (binary)
        put(out, &value, width); /* little endian, as are the machines on which this test runs */
    else
        put_text(out, "%lld ", (long long)value);
}

static inline void put_number(bytes *out, bool binary, double value) {
    if (binary)
        put(out, &value, sizeof value);
    else
        put_text(out, "%.17g ", value);
}

static inline void put_line_end(bytes *out, bool binary) {
    if (!binary) put_text(out, "\n");
}

/* The sample: two tetrahedra, a triangle of both, a line, a point; five nodes with sparse tags. */
enum { SAMPLE_NODES = 5, SAMPLE_ELEMENTS = 5 };
static const double sample_node[SAMPLE_NODES][3] = {
    {0.1, 0, 0}, {1, 1e-3, 0}, {0, 1, 0}, {0.25, 0.25, 1.0 / 3.0}, {0.5, 0.5, -1}};
static const int64_t sample_tag[SAMPLE_NODES] = {7, 100, 3, 2000, 41};
typedef struct sample_element {
    int dimension, type;
    int32_t node[4]; /* base 0 */
    int32_t group[2];
} sample_element;
static const sample_element sample[SAMPLE_ELEMENTS] = {
    {0, 15, {4}, {9}},         {1, 1, {2, 0}, {5}},
    {2, 2, {0, 1, 2}, {0}},    {3, 4, {0, 1, 2, 3}, {1, 6}},
    {3, 4, {0, 1, 2, 4}, {1}},
};

static inline void put_head(bytes *out, const char *version, bool binary) {
    int32_t one = 1;
    put_text(out, "$MeshFormat\n%s %d 8\n", version, binary);
    if (binary) {
        put(out, &one, 4);
        put_text(out, "\n");
    }
    put_text(out, "$EndMeshFormat\n");
}

static inline void put_names(bytes *out) {
    put_text(out, "$PhysicalNames\n3\n0 9 \"tip\"\n3 6 \"all of it\"\n3 1 \"rock\"\n"
                  "$EndPhysicalNames\n");
}

static inline void put_nodes_2(bytes *out, bool binary) {
    put_text(out, "$Nodes\n%d\n", SAMPLE_NODES);
    for (int k = 0; k < SAMPLE_NODES; k++) {
        put_int(out, binary, 4, sample_tag[k]);
        for (int d = 0; d < 3; d++) put_number(out, binary, sample_node[k][d]);
        put_line_end(out, binary);
    }
    put_text(out, "%s$EndNodes\n", binary ? "\n" : "");
}

static inline void put_element_2(bytes *out, bool binary, const sample_element *e, int32_t group) {
    if (binary) {
        put_int(out, binary, 4, e->type);
        put_int(out, binary, 4, 1);
        put_int(out, binary, 4, 2);
        put_int(out, binary, 4, 1);
    } else {
        put_text(out, "1 %d 2 ", e->type);
    }
    put_int(out, binary, 4, group);
    put_int(out, binary, 4, 1);
    for (int k = 0; k <= e->dimension; k++) put_int(out, binary, 4, sample_tag[e->node[k]]);
    put_line_end(out, binary);
}

/* An element of two groups is written twice. */
static inline void put_elements_2(bytes *out, bool binary) {
    put_text(out, "$Elements\n%d\n", SAMPLE_ELEMENTS + 1);
    for (int k = 0; k < SAMPLE_ELEMENTS; k++) {
        put_element_2(out, binary, &sample[k], sample[k].group[0]);
        if (sample[k].group[1]) put_element_2(out, binary, &sample[k], sample[k].group[1]);
    }
    put_text(out, "%s$EndElements\n", binary ? "\n" : "");
}

/* Every element is an entity of its own. */
static inline void put_entities_4(bytes *out, bool binary) {
    put_text(out, "$Entities\n");
    for (int d = 0; d < 4; d++) put_int(out, binary, 8, d == 3 ? 2 : 1);
    put_line_end(out, binary);
    for (int k = 0; k < SAMPLE_ELEMENTS; k++) {
        const sample_element *e = &sample[k];
        int groups = (e->group[0] != 0) + (e->group[1] != 0);
        put_int(out, binary, 4, k);
        for (int d = 0; d < (e->dimension ? 6 : 3); d++) put_number(out, binary, d);
        put_int(out, binary, 8, groups);
        for (int g = 0; g < groups; g++) put_int(out, binary, 4, e->group[g]);
        if (e->dimension) {
            put_int(out, binary, 8, 1);
            put_int(out, binary, 4, -k);
        }
        put_line_end(out, binary);
    }
    put_text(out, "%s$EndEntities\n", binary ? "\n" : "");
}

/* Two blocks, the second with a parametric coordinate. */
static inline void put_nodes_4(bytes *out, bool binary) {
    const int first[] = {0, 2, SAMPLE_NODES};
    put_text(out, "$Nodes\n");
    for (int k = 0; k < 4; k++) put_int(out, binary, 8, (const int[]){2, SAMPLE_NODES, 3, 2000}[k]);
    put_line_end(out, binary);
    for (int b = 0; b < 2; b++) {
        for (int k = 0; k < 3; k++) put_int(out, binary, 4, b); /* dimension, tag, parametric */
        put_int(out, binary, 8, first[b + 1] - first[b]);
        put_line_end(out, binary);
        for (int k = first[b]; k < first[b + 1]; k++) {
            put_int(out, binary, 8, sample_tag[k]);
            put_line_end(out, binary);
        }
        for (int k = first[b]; k < first[b + 1]; k++) {
            for (int d = 0; d < 3; d++) put_number(out, binary, sample_node[k][d]);
            if (b) put_number(out, binary, 77.0);
            put_line_end(out, binary);
        }
    }
    put_text(out, "%s$EndNodes\n", binary ? "\n" : "");
}

static inline void put_elements_4(bytes *out, bool binary) {
    put_text(out, "$Elements\n");
    for (int k = 0; k < 4; k++)
        put_int(out, binary, 8, (const int[]){SAMPLE_ELEMENTS, SAMPLE_ELEMENTS, 1, 5}[k]);
    put_line_end(out, binary);
    for (int k = 0; k < SAMPLE_ELEMENTS; k++) {
        const sample_element *e = &sample[k];
        put_int(out, binary, 4, e->dimension);
        put_int(out, binary, 4, k);
        put_int(out, binary, 4, e->type);
        put_int(out, binary, 8, 1);
        put_line_end(out, binary);
        put_int(out, binary, 8, k + 1);
        for (int n = 0; n <= e->dimension; n++) put_int(out, binary, 8, sample_tag[e->node[n]]);
        put_line_end(out, binary);
    }
    put_text(out, "%s$EndElements\n", binary ? "\n" : "");
}

/* The sample in version 2 or 4. */
static inline void make_msh(bytes *out, int version, bool binary) {
    out->size = 0;
    put_head(out, version == 2 ? "2.2" : "4.1", binary);
    put_names(out);
    if (version == 4) put_entities_4(out, binary);
    if (version == 4)
        put_nodes_4(out, binary);
    else
        put_nodes_2(out, binary);
    if (version == 4)
        put_elements_4(out, binary);
    else
        put_elements_2(out, binary);
}

/* Triangles as [count][3][3]. */
static inline void make_stl_binary(bytes *out, const float *corner, uint32_t count,
                                   const char *head) {
    char header[80] = {0};
    memcpy(header, head, strlen(head));
    out->size = 0;
    put(out, header, sizeof header);
    put(out, &count, 4);
    for (uint32_t t = 0; t < count; t++) {
        put(out, (const float[3]){0}, 12);
        put(out, corner + 9 * t, 36);
        put(out, "\0", 2);
    }
}

static inline void make_stl_text(bytes *out, const float *corner, uint32_t count) {
    out->size = 0;
    put_text(out, "solid a b\n");
    for (uint32_t t = 0; t < count; t++) {
        put_text(out, "  facet normal nan 0 1\n    outer loop\n");
        for (int k = 0; k < 3; k++) {
            const float *x = corner + 9 * t + 3 * k;
            put_text(out, "      vertex %.9g %.9g %.9g\n", x[0], x[1], x[2]);
        }
        put_text(out, "    endloop\n  endfacet\n");
    }
    put_text(out, "endsolid a b\n");
}

static const int cube_triangle[12][3] = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6},
                                         {0, 1, 5}, {0, 5, 4}, {2, 7, 3}, {2, 6, 7},
                                         {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

/* Corner number k of a cube from `low` to `high`: bits are x, y, z. */
static inline double cube_corner(int k, int d, double low, double high) {
    return k >> d & 1 ? high : low;
}

static inline void cube_corners(float low, float high, float corner[12 * 9]) {
    for (int t = 0; t < 12; t++)
        for (int k = 0; k < 3; k++)
            for (int d = 0; d < 3; d++)
                corner[9 * t + 3 * k + d] = (float)cube_corner(cube_triangle[t][k], d, low, high);
}

#endif
