/* Meshes with elements that become others, of older formats and in partitions; surfaces of PLY and
 * OBJ. */
#include "mesh_files.h"

#include <math.h>
#include <strings.h>

static int setup(void **state) {
    return make_fixture(state, "m");
}

static void expect_group(const gn_mesh *m, size_t k, int dimension, int tag, const char *name) {
    assert_int_equal(m->groups[k].dimension, dimension);
    assert_int_equal(m->groups[k].tag, tag);
    assert_string_equal(m->groups[k].name, name);
}

/* ---- elements that become others */

static double volume_of(const gn_mesh *m, size_t element) {
    const int32_t *node = m->tetrahedra.node + 4 * element;
    double e[3][3];
    for (int k = 0; k < 3; k++)
        for (int d = 0; d < 3; d++)
            e[k][d] = m->node[3 * node[k + 1] + d] - m->node[3 * node[0] + d];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6.0;
}

/* Two hexahedra, a prism and a pyramid that share faces, with the nodes in a random order: whatever
 * node comes first, faces fit, no element is inverted and the volume is the whole. */
static void solids_are_split_so_that_their_faces_fit(void **state) {
    fixture *f = *state;
    static const double point[16][3] = {
        {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1},     {0, 1, 1},
        {2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}, {3, 0, 0}, {3, 1, 0}, {0.5, 0.5, 2}, {0, 0, 0}};
    static const int hexahedra[2][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 8, 9, 2, 5, 10, 11, 6}};
    static const int prism[6] = {9, 13, 11, 8, 12, 10}, pyramid[5] = {4, 5, 6, 7, 14};
    static const int quadrangle[4] = {0, 4, 7, 3};
    uint32_t seed = 5;
    for (int round = 0; round < 60; round++) {
        int order[15], place[15];
        for (int k = 0; k < 15; k++) order[k] = k;
        for (int k = 14; k > 0 && round; k--) {
            seed = seed * 1664525u + 1013904223u;
            int other = (int)((seed >> 8) % (uint32_t)(k + 1)), swap = order[k];
            order[k] = order[other], order[other] = swap;
        }
        bytes b = {0};
        put_text(&b, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n15\n");
        for (int k = 0; k < 15; k++) {
            const double *x = point[order[k]];
            place[order[k]] = k + 1;
            put_text(&b, "%d %g %g %g\n", k + 1, x[0], x[1], x[2]);
        }
        put_text(&b, "$EndNodes\n$Elements\n5\n");
        for (int h = 0; h < 2; h++) {
            put_text(&b, "1 5 1 7");
            for (int k = 0; k < 8; k++) put_text(&b, " %d", place[hexahedra[h][k]]);
            put_text(&b, "\n");
        }
        put_text(&b, "1 6 1 7");
        for (int k = 0; k < 6; k++) put_text(&b, " %d", place[prism[k]]);
        put_text(&b, "\n1 7 1 7");
        for (int k = 0; k < 5; k++) put_text(&b, " %d", place[pyramid[k]]);
        put_text(&b, "\n1 3 1 2");
        for (int k = 0; k < 4; k++) put_text(&b, " %d", place[quadrangle[k]]);
        put_text(&b, "\n$EndElements\n");
        spill_bytes(f, &b);
        gn_mesh m;
        ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
        assert_int_equal(m.tetrahedra.count, 6 + 6 + 3 + 2);
        assert_int_equal(m.triangles.count, 2);
        double volume = 0.0;
        for (size_t k = 0; k < m.tetrahedra.count; k++) {
            assert_true(volume_of(&m, k) > 1e-3);
            assert_int_equal(m.tetrahedra.group[k], 7);
            volume += volume_of(&m, k);
        }
        assert_true(fabs(volume - (2.0 + 0.5 + 1.0 / 3.0)) < 1e-14);
        char text[GN_MESH_CHANGES_SIZE];
        assert_true(gn_mesh_changed(&m, text, sizeof text));
        assert_string_equal(text, "1 quadrangles split into triangles, 2 hexahedra split into "
                                  "tetrahedra, 1 prisms split into tetrahedra, 1 pyramids split "
                                  "into tetrahedra");
        /* 5 + 4 quadrangles of the hexahedra, 2 triangles and 2 quadrangles of the prism, 4
         * triangles of the pyramid are outside; the group of the quadrangle is found on its
         * triangles. */
        ok(gn_mesh_boundary(&m, 3, "m", error));
        assert_int_equal(m.triangles.count, 2 * (4 + 4 + 2) + 2 + 4);
        int in_group = 0;
        for (size_t k = 0; k < m.triangles.count; k++) in_group += m.triangles.group[k] == 2;
        assert_int_equal(in_group, 2);
        gn_mesh_free(&m);
    }
}

static void elements_of_higher_order_are_their_corners(void **state) {
    fixture *f = *state;
    gn_mesh m;
    char text[GN_MESH_CHANGES_SIZE];
    spill_text(f, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n9 5 5 5\n4 .5 0 0\n1 0 0 0\n"
                  "5 .5 .5 0\n2 1 0 0\n6 0 .5 0\n3 0 1 0\n8 9 9 9\n$EndNodes\n$Elements\n2\n"
                  "1 9 1 3 1 2 3 4 5 6\n2 8 1 4 1 2 4\n$EndElements\n");
    ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
    const double node[5][3] = {{5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
    assert_int_equal(m.node_count, 5); /* nodes that nothing uses stay */
    assert_memory_equal(m.node, node, sizeof node);
    assert_memory_equal(m.triangles.node, ((int32_t[]){1, 2, 3}), 12);
    assert_memory_equal(m.lines.node, ((int32_t[]){1, 2}), 8);
    assert_true(gn_mesh_changed(&m, text, sizeof text));
    assert_string_equal(text,
                        "only the corners of 2 elements of higher order used (3 nodes left out)");
    gn_mesh_free(&m);
    spill_text(
        f, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
           "$Elements\n1\n1 9 0 1 2 3 1 2 7\n$EndElements\n");
    fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT,
          "/m:12:17: expected a node of $Nodes, found node 7");
}

static void older_formats_give_the_same_mesh(void **state) {
    fixture *f = *state;
    static const char nodes[] = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n",
                      elements[] = "$Elements\n2\n1 2 2 4 1 1 2 3\n2 1 2 5 1 1 2\n$EndElements\n";
    static const char *const texts[] = {
        "$MeshFormat\n2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n4 \"rock\"\n5 \"left\"\n"
        "$EndPhysicalNames\n",
        "$MeshFormat\n2.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 4 \"rock\"\n1 5 \"left\"\n"
        "$EndPhysicalNames\n",
        "$MeshFormat\n4 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 4 \"rock\"\n1 5 \"left\"\n"
        "$EndPhysicalNames\n$Entities\n1 1 1 0\n1 0 0 0 0 0 0 0\n"
        "7 0 0 0 1 0 0 1 5 2 1 -1\n1 0 0 0 1 1 0 1 4 1 7\n$EndEntities\n"
        "$Nodes\n2 3\n7 1 0 2\n1 0 0 0\n2 1 0 0\n1 2 1 1\n3 0 1 0 0.5 0.5\n$EndNodes\n"
        "$Elements\n2 2\n1 2 2 1\n1 1 2 3\n7 1 1 1\n2 1 2\n$EndElements\n"};
    for (int k = 0; k < 3; k++) {
        char text[1000];
        gn_mesh m;
        snprintf(text, sizeof text, "%s%s%s", texts[k], k < 2 ? nodes : "", k < 2 ? elements : "");
        spill_text(f, text);
        ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
        assert_int_equal(m.node_count, 3);
        assert_true(m.node[3] == 1 && m.node[7] == 1);
        assert_memory_equal(m.triangles.node, ((int32_t[]){0, 1, 2}), 12);
        assert_int_equal(m.triangles.group[0], 4);
        assert_int_equal(m.lines.group[0], 5);
        assert_int_equal(m.group_count, 2);
        expect_group(&m, 0, 1, 5, "left");
        expect_group(&m, 1, 2, 4, "rock");
        assert_false(gn_mesh_changed(&m, text, sizeof text));
        gn_mesh_free(&m);
    }
}

/* Two triangles in two partitions; gmsh gives the line between them the number of the group
 * `rock`, which is that of `left` among lines. */
static void partitions_are_one_mesh_and_their_interfaces_in_no_group(void **state) {
    fixture *f = *state;
    gn_mesh m;
    spill_text(f, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"left\"\n2 1 "
                  "\"rock\"\n$EndPhysicalNames\n"
                  "$Entities\n0 1 1 0\n1 0 0 0 0 1 0 1 1 0\n1 0 0 0 1 1 0 1 1 0\n$EndEntities\n"
                  "$PartitionedEntities\n2\n1\n5 2\n0 2 2 0\n"
                  "2 1 1 1 1 0 0 0 0 1 0 1 1 0\n3 2 1 2 1 2 0 0 0 1 1 0 1 1 0\n"
                  "2 2 1 1 1 0 0 0 1 1 0 1 1 0\n3 2 1 1 2 0 0 0 1 1 0 1 1 0\n"
                  "$EndPartitionedEntities\n"
                  "$Nodes\n1 4 1 4\n2 2 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
                  "$Elements\n4 4 1 4\n1 2 1 1\n1 1 4\n1 3 1 1\n2 1 3\n2 2 2 1\n3 1 2 3\n"
                  "2 3 2 1\n4 1 3 4\n$EndElements\n");
    ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
    assert_int_equal(m.triangles.count, 2);
    assert_int_equal(m.triangles.group[0], 1);
    assert_int_equal(m.triangles.group[1], 1);
    assert_int_equal(m.lines.count, 2);
    assert_int_equal(m.lines.group[0], 1);
    assert_int_equal(m.lines.group[1], 0);
    assert_int_equal(m.group_count, 2);
    gn_mesh_free(&m);
}

/* ---- surfaces */

static void read_closed(const fixture *f, const char *name, double volume, size_t polygons) {
    gn_mesh m;
    double found;
    char path[160];
    snprintf(path, sizeof path, "%s/%s", f->dir, name);
    ok(gn_mesh_read_surface(path, 1.0, &m, error));
    ok(gn_mesh_close_surface(&m, name, &found, error));
    assert_true(fabs(found - volume) < 1e-6 * volume);
    assert_int_equal(m.changes.polygons, polygons);
    gn_mesh_free(&m);
}

static void spill_named(const fixture *f, const char *name, const void *what, size_t size) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s", f->dir, name);
    spill(path, what, size);
}

/* A step of 2 x 2 x 1 without its corner of 1 x 1 x 1, that is 3 m3: its ends are re-entrant. */
static const char step[] =
    "# a step\nmtllib none.mtl\no step\nv 0 0 0\nv 2 0 0 1.0\nv 2 1 0 0.5 0.5 0.5\nv 1 1 0\nv 1 2 "
    "0\n"
    "v 0 2 0\nvt 0 0\nvn 0 0 1\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\ns off\n"
    "f 6 5 4 3 2 1\nf -6/1 -5/1 -4/1 \\\n -3/1 -2/1 -1/1\ng sides\nf 1//1 2//1 8//1 7//1\n"
    "f 2/1/1 3/1/1 9/1/1 8/1/1\nf 3 4 10 9\nf 4 5 11 10 # inside\nf 5 6 12 11\nf 6 1 7\nf 6 7 12\n"
    "l 1 2\np 1\n";

static void obj_files_are_closed_surfaces(void **state) {
    fixture *f = *state;
    spill_named(f, "a.obj", step, sizeof step - 1);
    read_closed(f, "a.obj", 3.0, 7);
    spill_named(f, "b.OBJ", step, sizeof step - 1);
    read_closed(f, "b.OBJ", 3.0, 7);
}

/* The cube [0, 2]^3 of six quadrangles, with colours and a further kind of elements. */
static void make_ply(bytes *out, const char *format, bool doubles) {
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const bool text = strcmp(format, "ascii") == 0, big = strstr(format, "big") != NULL;
    out->size = 0;
    put_text(out,
             "ply\nformat %s 1.0\ncomment made here\nelement material 1\nproperty int shine\n"
             "element vertex 8\nproperty %s x\nproperty %s y\nproperty %s z\nproperty uchar red\n"
             "element face 6\nproperty list uchar short vertex_indices\nproperty float quality\n"
             "element edge 1\nproperty list uchar int ends\nend_header\n",
             format, doubles ? "double" : "float", doubles ? "float64" : "float32",
             doubles ? "double" : "float");
#define VALUE(type, value)                                                                         \
    do {                                                                                           \
        type one = (type)(value);                                                                  \
        unsigned char raw[sizeof one];                                                             \
        memcpy(raw, &one, sizeof one);                                                             \
        for (size_t byte = 0; big && byte + byte + 1 < sizeof one; byte++) {                       \
            unsigned char swap = raw[byte];                                                        \
            raw[byte] = raw[sizeof one - 1 - byte];                                                \
            raw[sizeof one - 1 - byte] = swap;                                                     \
        }                                                                                          \
        if (text)                                                                                  \
            put_text(out, "%g ", (double)one);                                                     \
        else                                                                                       \
            put(out, raw, sizeof raw);                                                             \
    } while (0)
    VALUE(int32_t, -7);
    if (text) put_text(out, "\n");
    for (int v = 0; v < 8; v++) {
        for (int d = 0; d < 3; d++)
            if (doubles)
                VALUE(double, 2 * (v >> d & 1));
            else
                VALUE(float, 2 * (v >> d & 1));
        VALUE(uint8_t, 200);
        if (text) put_text(out, "\n");
    }
    for (int k = 0; k < 6; k++) {
        VALUE(uint8_t, 4);
        for (int n = 0; n < 4; n++) VALUE(int16_t, face[k][n]);
        VALUE(float, 0.5);
        if (text) put_text(out, "\n");
    }
    VALUE(uint8_t, 2);
    VALUE(int32_t, 1);
    VALUE(int32_t, 2);
    if (text) put_text(out, "\n");
}

static const char *const ply_formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

static void ply_files_of_all_forms_are_closed_surfaces(void **state) {
    fixture *f = *state;
    bytes b;
    for (int k = 0; k < 6; k++) {
        make_ply(&b, ply_formats[k % 3], k < 3);
        spill_named(f, "m", b.at, b.size);
        read_closed(f, "m", 8.0, 6);
    }
}

#define PLY(format, elements) "ply\nformat " format " 1.0\n" elements "end_header\n"
#define VERTEX                "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define FACE                  "element face 1\nproperty list uchar int vertex_indices\n"

static void wrong_surfaces_are_refused_at_their_place(void **state) {
    fixture *f = *state;
    static const struct {
        const char *name, *text, *message;
    } cases[] = {
        {"a.obj", "", "a.obj: expected a mesh, found an empty file"},
        {"a.obj", "v 0 0 0\n", "a.obj:2:1: expected faces, found none"},
        {"a.obj", "v 0 0\n", "a.obj:1:6: expected coordinate z"},
        {"a.obj", "v 0 0 nan\n", "a.obj:1:7: expected coordinate z (a finite number), found 'nan'"},
        {"a.obj", "v 0 0 0\nf 1 1 2\n", "a.obj:2:1: expected corners among 1 vertices, found numb"},
        {"a.obj", "v 0 0 0\nf 1 -2 1\n", "a.obj:2:1: expected corners among 1 vertices"},
        {"a.obj", "v 0 0 0\nf 1 1\n", "a.obj:2:1: expected a face of at least 3 corners, found 2"},
        {"a.obj", "v 0 0 0\nf 1 x 1\n", "a.obj:2:5: expected the number of a vertex, found 'x'"},
        {"a.obj", "v 0 0 0\nf 1 0 1\n", "a.obj:2:5: expected the number of a vertex, found '0'"},
        {"a.obj", "v 0 0 0\nf 1 1.5 1\n", "expected the number of a vertex, found '1.5'"},
        {"a.obj", "v 0 0 0\nf 1 99999999999999999999 1\n", "expected the number of a vertex"},
        {"a.obj",
         "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 1 1 0\nv 1 3 0\nv 4 3 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4 5 6 7 "
         "8\n",
         "a.obj:9:1: expected a face that lines from one corner divide into triangles, found a "
         "re-"},
        {"m", PLY("ascii", VERTEX), "expected an element vertex with x, y and z, and one face"},
        {"m", PLY("ascii", FACE VERTEX),
         "expected an element vertex with x, y and z, and one face"},
        {"m", PLY("text", VERTEX FACE), "m:2:8: expected ascii, binary_little_endian or"},
        {"m", "ply\nelement vertex 3\nend_header\n", "expected a line 'format', found none"},
        {"m", PLY("ascii", "element vertex -3\n"), "m:3:16: expected number of elements from 0"},
        {"m", PLY("ascii", "property float x\n"), "behind an element"},
        {"m", PLY("ascii", "element vertex 1\nproperty real x\n"),
         "m:4:10: expected a type of num"},
        {"m", PLY("ascii", "rubbish\n"), "m:3:1: expected format, element, property or end_header"},
        {"m", "ply\nformat ascii 1.0\n", "expected end_header, found the end of the file"},
        {"m", PLY("ascii", VERTEX FACE) "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
         "m:13:1: expected corners among 3 vertices, found number 3 (base 0)"},
        {"m", PLY("ascii", VERTEX FACE) "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "expected a number, found"},
        {"m", PLY("ascii", VERTEX FACE) "0 0 0\n1 0 inf\n", "m:11:5: expected a finite coordinate"},
        {"m", PLY("ascii", VERTEX FACE) "0 0 0\n1 0 x\n", "m:11:5: expected a number, found 'x'"},
        {"m", PLY("ascii", VERTEX FACE) "0 0 0\n1 0 0\n0 1 0\n-1 0 1\n", "list of at most 1024"},
        {"m", PLY("binary_little_endian", VERTEX FACE) "0123", "m: byte "},
        {"m",
         PLY("ascii", "element vertex 2000000000\nproperty float x\nproperty float y\n"
                      "property float z\n" FACE) "0 0 0\n",
         "expected a number, found the end"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_mesh m;
        char path[160];
        spill_named(f, cases[k].name, cases[k].text, strlen(cases[k].text));
        snprintf(path, sizeof path, "%s/%s", f->dir, cases[k].name);
        fails(gn_mesh_read_surface(path, 1.0, &m, error), GNEISS_ERROR_INPUT, cases[k].message);
        assert_null(m.node);
    }
}

static uint32_t next_random(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*seed >> 33);
}

static void damaged_surfaces_are_sound_or_refused(void **state) {
    fixture *f = *state;
    uint64_t seed = 9;
    bytes whole, b;
    for (int kind = 0; kind < 4; kind++) {
        int refused = 0;
        const char *name = kind ? "m" : "m.obj";
        char path[160];
        snprintf(path, sizeof path, "%s/%s", f->dir, name);
        whole.size = 0;
        if (kind)
            make_ply(&whole, ply_formats[kind - 1], kind == 2);
        else
            put(&whole, step, sizeof step - 1);
        for (int trial = 0; trial < 500; trial++) {
            gneiss_error error = {0};
            gn_mesh m;
            double volume;
            b = whole;
            if (trial % 4 == 0) b.size = next_random(&seed) % whole.size;
            for (uint32_t k = 0; b.size && trial % 4 && k <= next_random(&seed) % 4; k++) {
                uint32_t at = next_random(&seed) % b.size;
                bool digit = b.at[at] >= '0' && b.at[at] <= '9';
                b.at[at] = (unsigned char)(digit ? '0' + next_random(&seed) % 10
                                                 : next_random(&seed) & 0xff);
            }
            spill(path, b.at, b.size);
            if (gn_mesh_read_surface(path, 1.0, &m, &error) == GNEISS_OK) {
                for (size_t k = 0; k < 3 * m.node_count; k++) assert_true(isfinite(m.node[k]));
                (void)gn_mesh_close_surface(&m, "m", &volume, &error);
                gn_mesh_free(&m);
            } else {
                assert_true(strncmp(error.message, path, strlen(path)) == 0);
                assert_null(m.node);
                refused++;
            }
        }
        assert_in_range(refused, 100, 499);
    }
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        WITH(solids_are_split_so_that_their_faces_fit),
        WITH(elements_of_higher_order_are_their_corners),
        WITH(older_formats_give_the_same_mesh),
        WITH(partitions_are_one_mesh_and_their_interfaces_in_no_group),
        WITH(obj_files_are_closed_surfaces),
        WITH(ply_files_of_all_forms_are_closed_surfaces),
        WITH(wrong_surfaces_are_refused_at_their_place),
        WITH(damaged_surfaces_are_sound_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
