#include "mesh_files.h"

#include <locale.h>

static int setup(void **state) {
    return make_fixture(state, "m");
}

/* ---- .msh */

static void expect_elements(const gn_mesh_elements *e, int dimension) {
    size_t count = 0, also = 0;
    assert_int_equal(e->nodes, dimension + 1);
    for (int k = 0; k < SAMPLE_ELEMENTS; k++) {
        if (sample[k].dimension != dimension) continue;
        assert_in_range(count + 1, 1, e->count);
        assert_memory_equal(e->node + e->nodes * count, sample[k].node, 4 * e->nodes);
        assert_int_equal(e->group[count], sample[k].group[0]);
        if (sample[k].group[1]) {
            assert_in_range(also + 1, 1, e->also_count);
            assert_int_equal(e->also[also].element, count);
            assert_int_equal(e->also[also++].group, sample[k].group[1]);
        }
        count++;
    }
    assert_int_equal(e->count, count);
    assert_int_equal(e->also_count, also);
}

static void expect_group(const gn_mesh *m, size_t k, int dimension, int tag, const char *name) {
    assert_int_equal(m->groups[k].dimension, dimension);
    assert_int_equal(m->groups[k].tag, tag);
    assert_string_equal(m->groups[k].name, name);
}

/* The file at the fixture's path is the sample. */
static void expect_sample(const fixture *f) {
    gn_mesh m;
    ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
    assert_int_equal(m.node_count, SAMPLE_NODES);
    assert_memory_equal(m.node, sample_node, sizeof sample_node);
    expect_elements(&m.points, 0);
    expect_elements(&m.lines, 1);
    expect_elements(&m.triangles, 2);
    expect_elements(&m.tetrahedra, 3);
    assert_int_equal(m.group_count, 4);
    expect_group(&m, 0, 0, 9, "tip");
    expect_group(&m, 1, 1, 5, "");
    expect_group(&m, 2, 3, 1, "rock");
    expect_group(&m, 3, 3, 6, "all of it");
    gn_mesh_free(&m);
    assert_null(m.node);
}

static const struct kind {
    int version;
    bool binary;
} kinds[4] = {{2, false}, {2, true}, {4, false}, {4, true}};

static void the_four_formats_give_the_same_mesh(void **state) {
    fixture *f = *state;
    bytes b;
    for (int k = 0; k < 4; k++) {
        make_msh(&b, kinds[k].version, kinds[k].binary);
        spill_bytes(f, &b);
        expect_sample(f);
    }
}

static void coordinates_are_scaled(void **state) {
    fixture *f = *state;
    bytes b;
    gn_mesh m;
    for (int k = 0; k < 4; k++) {
        make_msh(&b, kinds[k].version, kinds[k].binary);
        spill_bytes(f, &b);
        ok(gn_mesh_read_msh(f->path, 1e-3, &m, error));
        for (int n = 0; n < SAMPLE_NODES; n++)
            for (int d = 0; d < 3; d++) assert_true(m.node[3 * n + d] == 1e-3 * sample_node[n][d]);
        gn_mesh_free(&m);
        fails(gn_mesh_read_msh(f->path, 0.0, &m, error), GNEISS_ERROR_INPUT, "scale > 0, found 0");
        fails(gn_mesh_read_msh(f->path, 1e308 * 10, &m, error), GNEISS_ERROR_INPUT, "scale > 0");
    }
}

static void sections_stand_in_any_order_and_unknown_ones_are_skipped(void **state) {
    fixture *f = *state;
    for (int k = 0; k < 4; k++) {
        bytes b = {0};
        bool binary = kinds[k].binary;
        put_text(&b, "$Comments\n2.2 $Nodes $EndNothing\n$EndComments\n\n");
        if (kinds[k].version == 4) {
            put_elements_4(&b, binary);
            put_head(&b, "4.1", binary);
            put_nodes_4(&b, binary);
            put_entities_4(&b, binary);
        } else {
            put_elements_2(&b, binary);
            put_head(&b, "2.2", binary);
            put_nodes_2(&b, binary);
        }
        put_text(&b, "$NodeData\n1\n\"a\"\n$EndNodeData\n");
        put_names(&b);
        put_text(&b, "$NodeData\n1\n\"b\"\n$EndNodeData");
        spill_bytes(f, &b);
        expect_sample(f);
    }
}

static void lines_may_end_in_all_ways(void **state) {
    fixture *f = *state;
    static const char *const ends[] = {"\r\n", "\r", " \t\n\n"};
    bytes b;
    for (int version = 2; version <= 4; version += 2) {
        make_msh(&b, version, false);
        for (int e = 0; e < 3; e++) {
            bytes other = {0};
            put_text(&other, "\xef\xbb\xbf");
            for (size_t k = 0; k < b.size; k++)
                if (b.at[k] == '\n')
                    put_text(&other, "%s", ends[e]);
                else
                    put(&other, &b.at[k], 1);
            spill_bytes(f, &other);
            expect_sample(f);
        }
    }
}

/* A minimal system has no locale with a decimal comma: one is made. */
static void set_decimal_comma(fixture *f) {
    char command[1200];
    spill_text(
        f, "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \"\"\ngrouping -1\nEND LC_NUMERIC\n");
    /* The program reports the categories that are left out, also by its exit code. */
    snprintf(command, sizeof command, "localedef -c --no-archive -i %s %s/comma 2>/dev/null",
             f->path, f->dir);
    (void)!system(command);
    setenv("LOCPATH", f->dir, 1);
    assert_non_null(setlocale(LC_NUMERIC, "comma"));
    assert_string_equal(localeconv()->decimal_point, ",");
}

static void a_decimal_comma_of_the_locale_changes_nothing(void **state) {
    fixture *f = *state;
    bytes b;
    make_msh(&b, 4, false); /* the file is written before the locale with a decimal comma is set */
    set_decimal_comma(f);
    spill_bytes(f, &b);
    expect_sample(f);
    setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
}

static void a_negative_physical_tag_turns_the_element(void **state) {
    fixture *f = *state;
    gn_mesh m;
    spill_text(f, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
                  "$Entities\n0 1 1 0\n1 0 0 0 0 0 0 1 -4 0\n1 0 0 0 0 0 0 2 -5 3 0\n$EndEntities\n"
                  "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
                  "$Elements\n2 2 1 2\n1 1 1 1\n1 1 2\n2 1 2 1\n2 1 2 3\n$EndElements\n");
    ok(gn_mesh_read_msh(f->path, 1.0, &m, error));
    assert_memory_equal(m.lines.node, ((int32_t[]){1, 0}), 8);
    assert_memory_equal(m.triangles.node, ((int32_t[]){0, 2, 1}), 12);
    assert_int_equal(m.lines.group[0], 4);
    assert_int_equal(m.triangles.group[0], 5);
    assert_int_equal(m.triangles.also[0].group, 3);
    gn_mesh_free(&m);
}

#define HEAD2  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define HEAD4  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NODES2 HEAD2 "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n"
#define NODES4                                                                                     \
    HEAD4 "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n$Elements\n"
#define END "\n$EndElements\n"

static void wrong_texts_are_refused_at_line_and_column(void **state) {
    fixture *f = *state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "/m: expected a mesh, found an empty file"},
        {"\xff\xfe$", "found UTF-16"},
        {"rubbish\n", "/m:1:1: expected a section ($Nodes, ...), found 'rubbish'"},
        {"$\n", "/m:1:1: expected the name of a section"},
        {"$EndNodes\n", "/m:1:1: expected the name of a section"},
        {"$Nodes\n1\n", "/m:1:1: expected $EndNodes behind $Nodes"},
        {"$Nodes 5\n$EndNodes", "/m:1:8: expected the end of the line behind $Nodes"},
        {"$Nodes\n$EndNodes\n", "/m: expected a gmsh mesh of format 2.0 to 4.1, found no $Mesh"},
        {HEAD2 HEAD2, "/m:4:1: expected one section $MeshFormat, found a second"},
        {"$MeshFormat\n3 0 8\n$EndMeshFormat\n", "/m:2:1: expected format 2.0 to 2.2, 4.0 or 4.1"},
        {"$MeshFormat\n4.1 2 8\n$EndMeshFormat\n", "/m:2:5: expected file type"},
        {"$MeshFormat\n4.1 0 4\n$EndMeshFormat\n", "data of 8 bytes, found 4"},
        {"$MeshFormat\n4.1 0\n$EndMeshFormat\n", "/m:2:6: expected data size, found the end of th"},
        {HEAD2, "/m: expected a section $Nodes, found none"},
        {HEAD2 "$Nodes\n$EndNodes\n", "/m: expected a section $Elements, found none"},
        {HEAD2 "$Nodes\n0\n$EndNodes\n$Elements\n0" END, "expected nodes, found a count of 0"},
        {HEAD2 "$Nodes\n1\n1 0 nan 0\n$EndNodes\n$Elements\n0" END,
         "/m:6:5: expected coordinate y (a finite number), found 'nan'"},
        {HEAD2 "$Nodes\n1\n1 0x1 0 0\n$EndNodes\n$Elements\n0" END,
         "/m:6:3: expected coordinate x"},
        {HEAD2 "$Nodes\n1\n1 0 0 1e999\n$EndNodes\n$Elements\n0" END, "/m:6:7: expected coordi"},
        {HEAD2 "$Nodes\n1\n1 0 0 \n$EndNodes\n$Elements\n0" END, "/m:6:7: expected coordinate z"},
        {HEAD2 "$Nodes\n1\n1 0 0 0\n2\n$EndNodes\n$Elements\n0" END,
         "/m:7:1: expected the end of $Nodes, found '2'"},
        {HEAD2 "$Nodes\n2\n1 0 0 0\n$EndNodes\n$Elements\n0" END,
         "/m:5:2: expected at most 1 nodes"},
        {HEAD2 "$Nodes\n2\n1 0 0 0\n\n\n\n\n\n\n\n\n$EndNodes\n$Elements\n0" END,
         "expected tag of a node, found the end of $Nodes"},
        {HEAD2 "$Nodes\n2\n5 0 0 0\n5 1 0 0\n$EndNodes\n$Elements\n0" END,
         "/m:7:1: expected every node once, found node 5 again"},
        {HEAD2 "$Nodes\n1\n0 0 0 0\n$EndNodes\n$Elements\n0" END, "of at least 1, found 0"},
        {HEAD2 "$Nodes\n1\n1.5 0 0 0\n$EndNodes\n$Elements\n0" END, "tag of a node, found '1.5'"},
        {HEAD2 "$Nodes\n1\n9999999999999999999 0 0\n$EndNodes\n$Elements\n0" END, "tag of a node"},
        {NODES2 "0" END, "expected lines, triangles or tetrahedra, found none"},
        {NODES2 "1\n1 15 0 1" END, "expected lines, triangles or tetrahedra, found none"},
        {NODES2 "1\n1 2 0 1 2 4" END, "/m:12:11: expected a node of $Nodes, found node 4"},
        {NODES2 "1\n1 2 0 1 2 1" END, "/m:12:11: expected different nodes in an element, found n"},
        {NODES2 "1\n1 2 0 1 2" END, "/m:12:10: expected node of an element, found the end of t"},
        {NODES2 "1\n1 3 0 1 2 3" END, "/m:12:12: expected node of an element, found the end"},
        {NODES2 "1\n1 2 -1 1 2 3" END, "/m:12:5: expected number of tags from 0"},
        {NODES2 "1\n1 2 2 1 2 3\n" END, "/m:12:12: expected node of an element, found the end of"},
        {NODES2 "9\n1 2 0 1 2 3" END, "/m:11:2: expected at most 1 elements"},
        {NODES2 "1\n1 2 0 1 2 3\n2 2 0 1 2 3" END, "/m:13:1: expected the end of $Elements, foun"},
        {NODES4 "1 1 1 1\n1 1 2 1\n1 1 2 3" END,
         "/m:16:1: expected elements of dimension 1, found"},
        {NODES4 "1 2 1 1\n2 1 2 1\n1 1 2 3\n" END, "expected 1 elements more, found the last blo"},
        {NODES4 "1 1 1 1\n2 1 2 2\n1 1 2 3\n" END, "in the block from 0 to 1, found 2"},
        {NODES4 "1 1 1 1\n2 1 2 1\n1 1 2 9\n" END,
         "/m:17:7: expected a node of $Nodes, found node"},
        {HEAD4 "$Nodes\n1 1 1 1\n2 1 0 2\n1\n0 0 0\n$EndNodes\n$Elements\n0 0 0 0" END,
         "/m:6:7: expected 1 nodes in all, found 0 and 2 more"},
        {HEAD4 "$Nodes\n1 2 1 1\n2 1 0 1\n1\n0 0 0\n$EndNodes\n$Elements\n0 0 0 0" END,
         "expected 2 nodes in all, found 1"},
        {HEAD4 "$Entities\n0 0 1 0\n1 0 0 0 0 0 0 0 0\n$EndEntities\n"
               "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
               "$Elements\n1 1 1 1\n2 8 2 1\n1 1 2 3" END,
         "/m:20:1: expected an entity of $Entities, found entity 8 of dimension 2"},
        {HEAD4 "$Entities\n2 0 0 0\n1 0 0 0 0\n1 0 0 0 0\n$EndEntities\n$Nodes\n$EndNodes\n"
               "$Elements" END,
         "/m:7:1: expected every entity once, found entity 1 of dimension 0 again"},
        {HEAD2 "$PhysicalNames\n1\n2 1 rock\n$EndPhysicalNames\n$Nodes\n$EndNodes\n$Elements" END,
         "/m:6:5: expected a name in double quotes, found 'rock'"},
        {HEAD2 "$PhysicalNames\n1\n2 1 \"rock\n$EndPhysicalNames\n$Nodes\n$EndNodes\n$Elements" END,
         "/m:6:5: expected a second quote"},
        {HEAD2 "$PhysicalNames\n2\n2 1 \"a\"\n2 1 \"b\"\n$EndPhysicalNames\n$Nodes\n$EndNodes\n"
               "$Elements" END,
         "/m:7:1: expected one name of group 1 of dimension 2, found a second"},
        {HEAD2 "$PhysicalNames\n1\n2 1 \"0123456789012345678901234567890123456789012345678901234"
               "567890123\"\n$EndPhysicalNames\n$Nodes\n$EndNodes\n$Elements" END,
         "/m:6:5: expected a name of at most 63 bytes, found 64"},
        {"$NOD\n3\n1 0 0 0\n2 1 0 0\n3 1 1 0\n$ENDNOD\n$ELM\n1\n1 2 1 1 3 1 2 3\n$ENDELM\n",
         "/m:1:1: expected format 2.0 to 4.1, found a section $NOD of format 1; gmsh -save"},
    };
    gn_mesh m;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        spill_text(f, cases[k].text);
        fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, cases[k].message);
        assert_null(m.node);
    }
}

static void elements_of_other_kinds_are_named(void **state) {
    fixture *f = *state;
    static const struct {
        int type;
        const char *message;
    } cases[] = {{0, "of type 0"}, {-5, "of type -5"}, {34, "of type 34"}, {140, "of type 140"}};
    gn_mesh m;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[512];
        snprintf(text, sizeof text, NODES2 "1\n1 %d 0 1 2 3" END, cases[k].type);
        spill_text(f, text);
        fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, cases[k].message);
        snprintf(text, sizeof text, NODES4 "1 1 1 1\n2 1 %d 1\n1 1 2 3" END, cases[k].type);
        spill_text(f, text);
        fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, cases[k].message);
    }
}

static void files_that_are_not_there_are_refused(void **state) {
    fixture *f = *state;
    gn_mesh m;
    fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, "cannot be opened");
    fails(gn_mesh_read_msh(f->dir, 1.0, &m, error), GNEISS_ERROR_INPUT, "found a folder");
    fails(gn_mesh_read_surface(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, "cannot be opened");
    fails(gn_mesh_read_surface("/dev/null", 1.0, &m, error), GNEISS_ERROR_INPUT, "no regular file");
}

/* Returns the position at which the data of a section begin. */
static size_t section_start(const bytes *b, const char *name) {
    const unsigned char *found = b->at;
    while (memcmp(found, name, strlen(name)) != 0) found++;
    return (size_t)(found - b->at) + strlen(name) + 1;
}

static void expect_binary_fault(fixture *f, int version, const char *section, size_t behind,
                                const void *value, size_t size, const char *message) {
    bytes b;
    gn_mesh m;
    make_msh(&b, version, true);
    memcpy(b.at + section_start(&b, section) + behind, value, size);
    spill_bytes(f, &b);
    fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, message);
}

static void wrong_binaries_are_refused_at_section_and_byte(void **state) {
    fixture *f = *state;
    const int32_t swapped = 0x01000000, minus = -1, stranger = 12345, second = 7;
    const int64_t many = INT64_C(1) << 61;
    const double no_number = NAN;
    expect_binary_fault(f, 2, "$MeshFormat", 8, &swapped, 4, "byte 20: expected the byte order of");
    expect_binary_fault(f, 2, "$Nodes", 2 + 4 + 8, &no_number, 8, "expected coordinate y");
    expect_binary_fault(f, 2, "$Nodes", 2 + 28, &second, 4, "$Nodes, byte ");
    expect_binary_fault(f, 2, "$Nodes", 2 + 28, &second, 4, "found node 7 again");
    expect_binary_fault(f, 2, "$Elements", 2 + 4, &minus, 4, "$Elements, byte ");
    expect_binary_fault(f, 2, "$Elements", 2 + 8, &stranger, 4, "expected at most 0 elements");
    expect_binary_fault(f, 2, "$Elements", 2 + 24, &stranger, 4, "$Nodes, found node 12345");
    expect_binary_fault(f, 4, "$Entities", 8, &many, 8, "$Entities, byte ");
    expect_binary_fault(f, 4, "$Entities", 8, &many, 8, "found a count of 2305843009213693952");
    expect_binary_fault(f, 4, "$Entities", 32 + 28, &many, 8, "physical tags (what the section");
    expect_binary_fault(f, 4, "$Nodes", 0, &many, 8, "at most 11 blocks");
    expect_binary_fault(f, 4, "$Nodes", 8, &many, 8, "nodes (what the section has room for)");
    expect_binary_fault(f, 4, "$Nodes", 32 + 12, &many, 8, "expected 5 nodes in all, found 0 and");
    expect_binary_fault(f, 4, "$Elements", 8, &many, 8, "elements (what the section has room for)");
    expect_binary_fault(f, 4, "$Elements", 32 + 12, &many, 8, "in the block from 0 to 5, found");
}

static void huge_counts_in_texts_are_refused(void **state) {
    fixture *f = *state;
    static const char *const cases[] = {
        HEAD2 "$Nodes\n4000000000000000000\n1 0 0 0\n$EndNodes\n$Elements\n0" END,
        HEAD2 "$PhysicalNames\n999999999\n$EndPhysicalNames\n$Nodes\n$EndNodes\n$Elements\n" END,
        HEAD4 "$Entities\n0 0 99999999999 0\n$EndEntities\n$Nodes\n$EndNodes\n$Elements\n" END,
        HEAD4 "$Nodes\n1 4000000000 1 1\n2 1 0 1\n1\n0 0 0\n$EndNodes\n$Elements\n0 0 0 0" END,
        NODES2 "2000000000\n" END,
        NODES4 "1 99999999999 1 1\n" END,
    };
    gn_mesh m;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        spill_text(f, cases[k]);
        fails(gn_mesh_read_msh(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, "expected at most ");
    }
}

/* ---- STL */

static void stl_texts_and_binaries_give_the_same_welded_mesh(void **state) {
    fixture *f = *state;
    float corner[12 * 9];
    bytes b;
    cube_corners(-1.0f / 3.0f, 2.0f, corner);
    for (int kind = 0; kind < 3; kind++) {
        gn_mesh m;
        if (kind == 0) make_stl_text(&b, corner, 12);
        if (kind == 1) make_stl_binary(&b, corner, 12, "made by hand");
        if (kind == 2) make_stl_binary(&b, corner, 12, "solid in name only");
        spill_bytes(f, &b);
        ok(gn_mesh_read_surface(f->path, 0.5, &m, error));
        assert_int_equal(m.node_count, 8);
        assert_int_equal(m.triangles.count, 12);
        assert_int_equal(m.group_count, 0);
        for (int k = 0; k < 36; k++)
            for (int d = 0; d < 3; d++)
                assert_close(m.node[3 * m.triangles.node[k] + d], 0.5 * corner[3 * k + d], 1e-8);
        gn_mesh_free(&m);
    }
}

static void several_solids_in_any_letters_are_one_surface(void **state) {
    fixture *f = *state;
    gn_mesh m;
    spill_text(f, "\r\nSOLID\r\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 Vertex 1 0 0\r\n"
                  "vertex 0 1 0 ENDLOOP ENDFACET\r\nENDSOLID\r\nsolid empty\nendsolid empty\n"
                  "solid c\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\n"
                  "vertex 0 1 0\nendloop\nendfacet\nendsolid");
    ok(gn_mesh_read_surface(f->path, 1.0, &m, error));
    assert_int_equal(m.node_count, 4);
    assert_int_equal(m.triangles.count, 2);
    gn_mesh_free(&m);
}

static void corners_are_welded_by_distance_alone(void **state) {
    fixture *f = *state;
    /* Every triangle has slightly different coordinates of the cube's corners, by up to 0.4e-6 of
     * its size, and so on both sides of the borders of any grid. */
    for (double size = 1e-6; size < 1e9; size *= 1e4) {
        bytes b = {0};
        gn_mesh m;
        put_text(&b, "solid\n");
        for (int t = 0; t < 12; t++) {
            put_text(&b, "facet normal 0 0 0\nouter loop\n");
            for (int k = 0; k < 3; k++) {
                put_text(&b, "vertex ");
                for (int d = 0; d < 3; d++) {
                    double off = 0.2e-6 * size * ((t + 5 * k + 3 * d) % 3 - 1);
                    put_number(&b, false, cube_corner(cube_triangle[t][k], d, 0.0, size) + off);
                }
                put_text(&b, "\n");
            }
            put_text(&b, "endloop\nendfacet\n");
        }
        put_text(&b, "endsolid\n");
        spill_bytes(f, &b);
        ok(gn_mesh_read_surface(f->path, 1.0, &m, error));
        assert_int_equal(m.node_count, 8);
        gn_mesh_free(&m);
    }
}

static void corners_farther_apart_stay_apart_and_degenerate_triangles_go(void **state) {
    fixture *f = *state;
    static const float corner[4][9] = {
        {0, 0, 0, 1, 0, 0, 0, 1, 0},
        {0, 0, 3e-6f, 1, 0, 3e-6f, 0, 1, 3e-6f}, /* a sheet above the first */
        {0, 0, 0, 0, 5e-7f, 0, 0.5, 0.25,
         0}, /* a needle with a far corner that no other element has */
        {0, 0, 0, 1, 0, 0, 1, 5e-7f, 0}};
    bytes b;
    gn_mesh m;
    make_stl_binary(&b, corner[0], 4, "");
    spill_bytes(f, &b);
    ok(gn_mesh_read_surface(f->path, 1.0, &m, error));
    assert_int_equal(m.node_count, 6);
    assert_int_equal(m.triangles.count, 2);
    gn_mesh_free(&m);
}

static void wrong_stl_files_are_refused(void **state) {
    fixture *f = *state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "/m: expected a mesh, found an empty file"},
        {"rubbish", "/m: byte 7: expected an STL text ('solid ...') or at least 84 bytes"},
        {"solid\nendsolid\n", "/m:3:1: expected triangles, found none"},
        {"solid\n", "/m:2:1: expected 'facet' or 'endsolid', found the end of the file"},
        {"solid\nfacet normal 0 0\nouter", "/m:2:17: expected a component of the normal, found"},
        {"solid\nfacet normal 0 0 1\ninner", "/m:3:1: expected 'outer', found 'inner'"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 inf 0", "/m:4:10: expected coordinate y"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
         "vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
         "/m:7:1: expected 'endloop', found 'vertex'"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 0 "
         "0\nendloop\n"
         "endfacet\nendsolid\n",
         "expected triangles with three corners apart, found none in 1"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 0 0\nvertex 1 0 "
         "0\nendloop\n"
         "endfacet\nendsolid\n",
         "expected a surface with an extent"},
    };
    gn_mesh m;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        spill_text(f, cases[k].text);
        fails(gn_mesh_read_surface(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT, cases[k].message);
        assert_null(m.node);
    }
}

static void a_binary_stl_must_have_the_size_of_its_count(void **state) {
    fixture *f = *state;
    float corner[12 * 9];
    bytes b;
    gn_mesh m;
    cube_corners(0, 1, corner);
    make_stl_binary(&b, corner, 12, "solid");
    const uint32_t counts[] = {0, 11, 13, UINT32_MAX};
    for (int k = 0; k < 4; k++) {
        memcpy(b.at + 80, &counts[k], 4);
        spill_bytes(f, &b);
        fails(gn_mesh_read_surface(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT,
              "bytes, found a file of 684 bytes");
    }
    make_stl_binary(&b, corner, 0, "");
    spill_bytes(f, &b);
    fails(gn_mesh_read_surface(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT,
          "/m: byte 80: expected triangles, found a count of 0");
    corner[10] = NAN;
    make_stl_binary(&b, corner, 12, "");
    spill_bytes(f, &b);
    fails(gn_mesh_read_surface(f->path, 1.0, &m, error), GNEISS_ERROR_INPUT,
          "/m: byte 150: expected a finite coordinate, found nan times a scale of 1 (triangle 2)");
}

/* ---- damaged files */

typedef gneiss_status reader(const char *path, double scale, gn_mesh *mesh, gneiss_error *error);

static void expect_valid(const gn_mesh_elements *e, size_t node_count) {
    for (size_t k = 0; k < e->count * e->nodes; k++)
        assert_true(e->node[k] >= 0 && (size_t)e->node[k] < node_count);
    for (size_t k = 0; k < e->count; k++) assert_true(e->group[k] >= 0);
    for (size_t k = 0; k < e->also_count; k++) assert_true(e->also[k].element < e->count);
}

/* Returns true if the damaged file was read; its content is consistent then, and the later
 * processing succeeds. */
static bool read_damaged(const fixture *f, reader *read) {
    gn_mesh m;
    gneiss_error error = {0};
    double volume;
    gneiss_status status = read(f->path, 1.0, &m, &error);
    if (status != GNEISS_OK) {
        assert_int_equal(status, GNEISS_ERROR_INPUT);
        assert_true(strncmp(error.message, f->path, strlen(f->path)) == 0);
        assert_null(m.node);
        return false;
    }
    for (size_t k = 0; k < 3 * m.node_count; k++) assert_true(isfinite(m.node[k]));
    expect_valid(&m.lines, m.node_count);
    expect_valid(&m.triangles, m.node_count);
    expect_valid(&m.tetrahedra, m.node_count);
    (void)gn_mesh_boundary(&m, 2, "m", &error);
    (void)gn_mesh_boundary(&m, 3, "m", &error);
    (void)gn_mesh_close_surface(&m, "m", &volume, &error);
    gn_mesh_free(&m);
    return true;
}

enum { DAMAGED_FILES = 6 };

static reader *make_damaged(bytes *b, int kind) {
    float corner[12 * 9];
    cube_corners(0, 1, corner);
    if (kind == 4) make_stl_text(b, corner, 12);
    if (kind == 5) make_stl_binary(b, corner, 12, "solid");
    if (kind >= 4) return gn_mesh_read_surface;
    make_msh(b, kinds[kind].version, kinds[kind].binary);
    return gn_mesh_read_msh;
}

static void files_cut_at_any_byte_are_refused(void **state) {
    fixture *f = *state;
    bytes b;
    for (int kind = 0; kind < DAMAGED_FILES; kind++) {
        reader *read = make_damaged(&b, kind);
        /* The last line of a text may lack its line break, that of an STL text also the name. */
        size_t whole = b.size - (kind == 4 ? strlen(" a b\n") : kind == 5 ? 0 : 1);
        for (size_t size = 0; size <= b.size; size++) {
            spill(f->path, b.at, size);
            if (read_damaged(f, read) != (size >= whole))
                fail_msg("file %d cut at %zu of %zu", kind, size, b.size);
        }
    }
}

static uint32_t next_random(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*seed >> 33);
}

static void flipped_bytes_never_crash(void **state) {
    fixture *f = *state;
    uint64_t seed = 1;
    bytes whole, b;
    for (int kind = 0; kind < DAMAGED_FILES; kind++) {
        reader *read = make_damaged(&whole, kind);
        int refused = 0;
        for (int trial = 0; trial < 400; trial++) {
            b = whole;
            for (uint32_t k = 0; k <= next_random(&seed) % 4; k++) {
                uint32_t at = next_random(&seed) % b.size;
                unsigned char other = next_random(&seed) & 0xff;
                /* Replacing digits by digits reaches later checks than arbitrary bytes, which the
                 * first check finds. */
                bool digit = b.at[at] >= '0' && b.at[at] <= '9';
                b.at[at] = digit ? '0' + other % 10 : other;
            }
            spill_bytes(f, &b);
            refused += !read_damaged(f, read);
        }
        assert_in_range(refused, 1, 399); /* some changes are detected, others are harmless */
    }
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        WITH(the_four_formats_give_the_same_mesh),
        WITH(coordinates_are_scaled),
        WITH(sections_stand_in_any_order_and_unknown_ones_are_skipped),
        WITH(lines_may_end_in_all_ways),
        WITH(a_decimal_comma_of_the_locale_changes_nothing),
        WITH(a_negative_physical_tag_turns_the_element),
        WITH(wrong_texts_are_refused_at_line_and_column),
        WITH(elements_of_other_kinds_are_named),
        WITH(files_that_are_not_there_are_refused),
        WITH(wrong_binaries_are_refused_at_section_and_byte),
        WITH(huge_counts_in_texts_are_refused),
        WITH(stl_texts_and_binaries_give_the_same_welded_mesh),
        WITH(several_solids_in_any_letters_are_one_surface),
        WITH(corners_are_welded_by_distance_alone),
        WITH(corners_farther_apart_stay_apart_and_degenerate_triangles_go),
        WITH(wrong_stl_files_are_refused),
        WITH(a_binary_stl_must_have_the_size_of_its_count),
        WITH(files_cut_at_any_byte_are_refused),
        WITH(flipped_bytes_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
