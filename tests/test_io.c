#include "io_helpers.h"

#include "io/h5.h"
#include "io/io.h"
#include "io/listing.h"
#include "io/packing.h"
#include "io/snapshot.h"

#include <dirent.h>
#include <fcntl.h>
#include <hdf5.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static int setup(void **state) {
    return make_fixture(state, "a.txt");
}

static void spill(const char *path, const void *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    if (size) assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

static bool exists(const char *dir, const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    return access(path, F_OK) == 0;
}

/* ---- text files and folders */

static void a_text_file_is_written_and_read(void **state) {
    fixture *f = *state;
    char *text;
    ok(gn_write_text_file(f->path, "old", GN_DURABLE, error));
    ok(gn_write_text_file(f->path, "new\ntext", GN_DURABLE, error));
    ok(gn_read_text_file(f->path, 100, &text, error));
    assert_string_equal(text, "new\ntext");
    free(text);
    ok(gn_read_text_file(f->path, 8, &text, error));
    free(text);
    assert_int_equal(entries(f->dir, false), 1);
    ok(gn_write_text_file(f->path, "", GN_DURABLE, error));
    ok(gn_read_text_file(f->path, 0, &text, error));
    assert_string_equal(text, "");
    free(text);
}

static void texts_that_cannot_be_read_are_named(void **state) {
    fixture *f = *state;
    char *text;
    fails(gn_read_text_file(f->path, 9, &text, error), GNEISS_ERROR_IO,
          "a.txt: cannot be opened: No");
    fails(gn_read_text_file(f->dir, 9, &text, error), GNEISS_ERROR_INPUT, "found a folder");
    spill(f->path, "0123456789", 10);
    fails(gn_read_text_file(f->path, 9, &text, error), GNEISS_ERROR_INPUT, "at most 9 bytes");
    spill(f->path, "01\0003", 4);
    fails(gn_read_text_file(f->path, 9, &text, error), GNEISS_ERROR_INPUT, "a zero byte at 2");
    assert_null(text);
    fails(gn_read_text_file("/dev/zero", 99999, &text, error), GNEISS_ERROR_INPUT, "at most 99999");
}

static void a_full_disk_leaves_the_old_text(void **state) {
    fixture *f = *state;
    struct rlimit before, small;
    char *text;
    ok(gn_write_text_file(f->path, "old", GN_DURABLE, error));
    getrlimit(RLIMIT_FSIZE, &before);
    small = before;
    small.rlim_cur = 5;
    signal(SIGXFSZ, SIG_IGN);
    gneiss_error why = {0};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    gneiss_status status = gn_write_text_file(f->path, "longer than five", GN_DURABLE, &why);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_DFL);
    assert_int_equal(status, GNEISS_ERROR_IO);
    assert_non_null(strstr(why.message, "a.txt: cannot be written: File too large"));
    ok(gn_read_text_file(f->path, 100, &text, error));
    assert_string_equal(text, "old");
    free(text);
    assert_int_equal(entries(f->dir, false), 1);
}

static void folders_are_made_with_their_parents(void **state) {
    fixture *f = *state;
    char path[128];
    snprintf(path, sizeof path, "%s/x//y/z/", f->dir);
    ok(gn_make_directory(path, error));
    ok(gn_make_directory(path, error));
    assert_true(exists(f->dir, "x/y/z"));
    ok(gn_make_directory("/", error));
    ok(gn_make_directory(".", error));
    assert_int_equal(entries(path, false), 0);
}

static void folders_that_cannot_be_made_are_named(void **state) {
    fixture *f = *state;
    char path[128];
    spill(f->path, "x", 1);
    fails(gn_make_directory(f->path, error), GNEISS_ERROR_IO, "there is a file of this name");
    snprintf(path, sizeof path, "%s/deeper/still", f->path);
    fails(gn_make_directory(path, error), GNEISS_ERROR_IO, "a.txt: cannot be made a folder");
    fails(gn_make_directory("", error), GNEISS_ERROR_INPUT, "found nothing");
    fails(gn_make_directory("/proc/gneiss", error), GNEISS_ERROR_IO,
          "/proc/gneiss: cannot be made");
    fails(gn_make_directory("/proc", error), GNEISS_ERROR_IO,
          "/proc: nothing can be written there");
}

/* ---- JSON */

static void json_nests_and_escapes(void **state) {
    (void)state;
    gn_json *json = gn_json_begin();
    gn_json_text(json, "a\"b", "tab\there\nline\x01 \\ \xc2\xb5");
    gn_json_array(json, "list");
    gn_json_integer(json, NULL, INT64_MIN);
    gn_json_bool(json, NULL, true);
    gn_json_object(json, NULL);
    gn_json_end(json);
    gn_json_array(json, NULL);
    gn_json_text(json, NULL, NULL);
    gn_json_end(json);
    gn_json_end(json);
    gn_json_number(json, "x", 0.1);
    gn_json_object(json, "open");
    gn_json_bool(json, "f", false);
    char *text = gn_json_finish(json, false);
    assert_string_equal(text, "{\"a\\\"b\":\"tab\\u0009here\\nline\\u0001 \\\\ \xc2\xb5\","
                              "\"list\":[-9223372036854775808,true,{},[null]],\"x\":0.1,"
                              "\"open\":{\"f\":false}}");
    free(text);
}

static void json_is_indented_on_request(void **state) {
    (void)state;
    gn_json *json = gn_json_begin();
    gn_json_text(json, "a", "{[,:\\\"");
    gn_json_array(json, "none");
    gn_json_end(json);
    gn_json_object(json, "o");
    gn_json_integer(json, "n", 1);
    gn_json_integer(json, "m", 2);
    char *text = gn_json_finish(json, true);
    assert_string_equal(text, "{\n  \"a\": \"{[,:\\\\\\\"\",\n  \"none\": [],\n  \"o\": {\n"
                              "    \"n\": 1,\n    \"m\": 2\n  }\n}\n");
    free(text);
}

static void json_numbers_read_back_exactly(void **state) {
    (void)state;
    const double values[] = {0.0,     -0.0, 1e-320,       1.7976931348623157e308,
                             1.0 / 3, 1e22, 123456789.125};
    for (size_t k = 0; k < 7; k++) {
        gn_json *json = gn_json_begin();
        gn_json_number(json, "v", values[k]);
        char *text = gn_json_finish(json, false);
        double back = strtod(text + 5, NULL);
        assert_memory_equal(&back, &values[k], sizeof back);
        free(text);
    }
    gn_json *json = gn_json_begin();
    gn_json_number(json, "v", NAN);
    gn_json_number(json, "w", -INFINITY);
    char *text = gn_json_finish(json, false);
    assert_string_equal(text, "{\"v\":null,\"w\":null}");
    free(text);
}

static void json_stays_valid_when_misused(void **state) {
    (void)state;
    gn_json *json = gn_json_begin();
    gn_json_end(json);
    gn_json_integer(json, NULL, 1);
    gn_json_array(json, "a");
    gn_json_integer(json, "ignored", 2);
    gn_json_end(json);
    gn_json_end(json);
    /* Latin-1, a surrogate, an overlong form and a cut character are not UTF-8. */
    gn_json_text(json, "t", "\xb5|\xed\xa0\x80|\xc0\x80|\xe2\x82");
    char *text = gn_json_finish(json, false);
    assert_string_equal(text, "{\"\":1,\"a\":[2],\"t\":\"\\ufffd|\\ufffd\\ufffd\\ufffd|"
                              "\\ufffd\\ufffd|\\ufffd\\ufffd\"}");
    free(text);
    gn_json_integer(NULL, "a", 1);
    assert_null(gn_json_finish(NULL, true));
}

/* ---- packings */

static gneiss_status read_text(fixture *f, const char *text, size_t size, int dimension,
                               gn_packing *p, gneiss_error *error) {
    spill(f->path, text, size);
    return gn_packing_read(f->path, dimension, 1.0, p, error);
}

static void expect_packing(fixture *f, const char *text, int dimension, size_t count,
                           const double (*rows)[4]) {
    gn_packing p;
    gneiss_error error = {0};
    if (read_text(f, text, strlen(text), dimension, &p, &error))
        fail_msg("%s: %s", text, error.message);
    assert_int_equal(p.count, count);
    assert_memory_equal(p.sphere, rows, count * sizeof *rows);
    gn_packing_free(&p);
    assert_null(p.sphere);
}

static void packings_are_read_in_all_their_spellings(void **state) {
    fixture *f = *state;
    const double two[2][4] = {{1, -2, 3e-3, 4}, {0.5, 6, 7, 8}};
    expect_packing(f, "1 -2 3e-3 4\n.5 6. 7 8\n", 3, 2, two);
    expect_packing(f, "1 -2 3e-3 4\r\n.5 6 7 8", 3, 2, two);
    expect_packing(f, "1 -2 3e-3 4\r.5 6 7 8\r", 3, 2, two);
    expect_packing(
        f, "\xef\xbb\xbf# x y z r\n\n1\t-2\t3E-3\t4  # comment\n  \t\n 5e-1,6 , 7,\t8 \n#end", 3, 2,
        two);
    expect_packing(f,
                   "# d\xe9"
                   "but\n+1,-2,+3e-03,4#\n0.5 6 7 8#5 6\n",
                   3, 2, two);
    const double flat[2][4] = {{1, 2, 0, 3}, {4, 5, 0, 6}};
    expect_packing(f, "1 2 3\n4 5 6\n", 2, 2, flat);
    expect_packing(f, "1 2 7 3\n4 5 7 6\n", 2, 2, flat);
}

static void the_scale_multiplies_everything(void **state) {
    fixture *f = *state;
    gn_packing p;
    const double row[4] = {0.5, -1, 1.5, 2};
    spill(f->path, "1 -2 3 4", 8);
    ok(gn_packing_read(f->path, 3, 0.5, &p, error));
    assert_memory_equal(p.sphere, row, sizeof row);
    gn_packing_free(&p);
    fails(gn_packing_read(f->path, 3, 0.0, &p, error), GNEISS_ERROR_INPUT, "scale > 0, found 0");
    fails(gn_packing_read(f->path, 3, 1e308, &p, error), GNEISS_ERROR_INPUT,
          "1:3: expected a finite");
    fails(gn_packing_read(f->path, 4, 1.0, &p, error), GNEISS_ERROR_INTERNAL, "2 or 3");
}

static void a_decimal_comma_of_the_locale_changes_nothing(void **state) {
    fixture *f = *state;
    const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE.utf8"};
    const char *set = NULL;
    for (int k = 0; k < 3 && !set; k++) set = setlocale(LC_NUMERIC, names[k]);
    if (!set) return; /* a minimal system has no such locale: the test has nothing to check there */
    const double row[1][4] = {{1.5, 2.5, 3.5, 4.5}};
    expect_packing(f, "1.5 2.5 3.5 4.5", 3, 1, row);
    gn_json *json = gn_json_begin();
    gn_json_number(json, "v", 1.5);
    char *text = gn_json_finish(json, false);
    setlocale(LC_NUMERIC, "C");
    assert_string_equal(text, "{\"v\":1.5}");
    free(text);
}

static void wrong_packings_are_refused_at_line_and_column(void **state) {
    fixture *f = *state;
    static const struct {
        int dimension;
        const char *text, *message;
    } cases[] = {
        {3, "", "a.txt:1:1: no particles"},
        {3, "# nothing\n\n", "a.txt:3:1: no particles"},
        {3, "1 2 3 4\n1 2 3\n", "a.txt:2:6: expected 4 columns x y z r, found 3"},
        {3, "1 2 3", "a.txt:1:6: expected 4 columns x y z r, found 3"},
        {3, "1 2 3 4 5", "a.txt:1:9: expected x y z r, found a column more"},
        {3, "1 2 3 4 0\n", "a.txt:1:9: expected x y z r, found a column more"},
        {3, "1 2 3 4,\n", "a.txt:1:9: expected x y z r, found a column more"},
        {3, "\n 1 2 x 4", "a.txt:2:6: expected a finite decimal number, found 'x'"},
        {3, "x y z r\n", "a.txt:1:1: expected a finite decimal number, found 'x'"},
        {3, "1 nan 2 3", "a.txt:1:3: expected a finite decimal number, found 'nan'"},
        {3, "1 2 3 inf", "a.txt:1:7: expected a finite decimal number, found 'inf'"},
        {3, "1 -infinity 3 1", "a.txt:1:3: expected a finite decimal number, found '-infinity'"},
        {3, "1 2 0x1p3 1", "a.txt:1:5: expected a finite decimal number, found '0x1p3'"},
        {3, "1 2 1e400 1", "a.txt:1:5: expected a finite number, found '1e400' (too large)"},
        {3, "1 2 3 0", "a.txt:1:7: expected a radius > 0, found 0"},
        {3, "1 2 3 -0.5", "a.txt:1:7: expected a radius > 0, found -0.5"},
        {3, "1 2 3 1e-400", "a.txt:1:7: expected a radius > 0, found 0"},
        {3, "1,,2,3", "a.txt:1:3: expected a number, found nothing beside the comma"},
        {3, ",1,2,3", "a.txt:1:1: expected a number, found nothing beside the comma"},
        {3, "1 2 3,", "a.txt:1:7: expected a number, found nothing beside the comma"},
        {3, "1;2;3;4", "a.txt:1:1: expected a finite decimal number, found '1;2;3;4'"},
        {3, "1 2 3 1.2.3", "found '1.2.3'"},
        {3, "1 2 3 1e", "found '1e'"},
        {3, "1 2 3 .", "found '.'"},
        {3, "1 2 3 1d-3", "found '1d-3'"},
        {3, "1 2 3 \x01\x80", "a.txt:1:7: expected a finite decimal number, found '\?\?'"},
        {3,
         "\xff\xfe"
         "1",
         "a.txt:1:1: expected plain text, found UTF-16"},
        {2, "1 2", "a.txt:1:4: expected 3 columns x y r, found 2"},
        {2, "1 2 3\n1 2 0 3", "a.txt:2:7: expected 3 columns as in the lines above, found 4"},
        {2, "1 2 0 3\n1 2 3", "a.txt:2:6: expected 4 columns as in the lines above, found 3"},
        {2, "1 2 0 3\n1 2 0.5 3", "a.txt:2:5: expected z = 0 as above (two dimensions), found 0.5"},
        {2, "1 2 -3", "a.txt:1:5: expected a radius > 0, found -3"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_packing p;
        const char *text = cases[k].text;
        fails(read_text(f, text, strlen(text), cases[k].dimension, &p, error), GNEISS_ERROR_INPUT,
              cases[k].message);
        assert_null(p.sphere);
    }
}

static void what_is_no_packing_at_all_is_refused(void **state) {
    fixture *f = *state;
    gn_packing p;
    static char line[70000];
    fails(gn_packing_read(f->path, 3, 1, &p, error), GNEISS_ERROR_INPUT,
          "a.txt: cannot be opened: No such");
    fails(gn_packing_read(f->dir, 3, 1, &p, error), GNEISS_ERROR_INPUT, "found a folder");
    fails(read_text(f, "1 2\0 3 4", 8, 3, &p, error), GNEISS_ERROR_INPUT,
          "1:4: expected text, found a zero");
    fails(gn_packing_read("/dev/zero", 3, 1, &p, error), GNEISS_ERROR_INPUT, "zero byte");
    memset(line, '1', sizeof line);
    fails(read_text(f, line, sizeof line, 3, &p, error), GNEISS_ERROR_INPUT, "at most 65536 bytes");
    uint32_t seed = 1;
    for (int round = 0; round < 300; round++) {
        static const char alphabet[] = "0123456789.,-+eExn# \t\r\n\xef\xbb\xbf";
        char noise[300];
        for (size_t k = 0; k < sizeof noise; k++) {
            seed = seed * 1664525 + 1013904223;
            noise[k] =
                round % 2 ? (char)(seed >> 24) : alphabet[(seed >> 16) % (sizeof alphabet - 1)];
        }
        if (read_text(f, noise, sizeof noise, 2 + round % 3 / 2, &p, NULL) == GNEISS_OK)
            for (size_t k = 0; k < p.count; k++) assert_true(p.sphere[4 * k + 3] > 0);
        gn_packing_free(&p);
    }
}

static void the_shared_specimens_are_read(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t count;
    } files[] = {{"rock-a", 10225}, {"rock-b", 2000}, {"rock-c", 6000}};
    for (int k = 0; k < 3; k++) {
        char path[512];
        gn_packing p;
        snprintf(path, sizeof path, "%s/scenes/specimens/%s.txt", test_source(), files[k].name);
        ok(gn_packing_read(path, 3, 1.0, &p, error));
        assert_int_equal(p.count, files[k].count);
        gn_packing_free(&p);
    }
}

/* ---- snapshots */

static const double points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
static const double speed[4] = {1, 2, 3, 4}, stress[4][9] = {{1, 2, 3}, {4}, {5}, {6, 7}};
static const int32_t lines[3][2] = {{0, 1}, {1, 2}, {0, 3}};
static const double force[3] = {7, 8, 9};

static gn_snapshot particles_at(int64_t step, double time) {
    static const gn_snapshot_array arrays[] = {{"speed", "m/s", 1, speed, false},
                                               {"stress", "Pa", 9, stress[0], false}};
    return (gn_snapshot){.time = time,
                         .step = step,
                         .point_count = 4,
                         .points = points[0],
                         .point_array_count = 2,
                         .point_arrays = arrays};
}

static void read_i64(gn_h5 *file, const char *name, size_t rows, const int64_t *expected) {
    int64_t found[16];
    ok(gn_h5_get(file, name, GN_I64, rows, 1, 0, found, error));
    assert_memory_equal(found, expected, rows * sizeof *found);
}

static void particles_are_vertices(void **state) {
    fixture *f = *state;
    char path[128];
    double xyz[4][3], tensor[4][9], time;
    uint8_t types[4];
    gn_h5 *file;
    gn_snapshot s = particles_at(1200, 0.25);
    ok(gn_snapshot_write(f->dir, "particles", &s, error));
    snprintf(path, sizeof path, "%s/particles_0000001200.hdf", f->dir);
    ok(gn_h5_open(path, &file, error));
    read_i64(file, "VTKHDF/NumberOfPoints", 1, (int64_t[]){4});
    read_i64(file, "VTKHDF/NumberOfCells", 1, (int64_t[]){4});
    read_i64(file, "VTKHDF/NumberOfConnectivityIds", 1, (int64_t[]){4});
    read_i64(file, "VTKHDF/Connectivity", 4, (int64_t[]){0, 1, 2, 3});
    read_i64(file, "VTKHDF/Offsets", 5, (int64_t[]){0, 1, 2, 3, 4});
    read_i64(file, "VTKHDF/FieldData/Step", 1, (int64_t[]){1200});
    ok(gn_h5_get(file, "VTKHDF/Types", GN_U8, 4, 1, 0, types, error));
    for (int k = 0; k < 4; k++) assert_int_equal(types[k], 1);
    ok(gn_h5_get(file, "VTKHDF/Points", GN_F64, 4, 3, 0, xyz, error));
    assert_memory_equal(xyz, points, sizeof xyz);
    ok(gn_h5_get(file, "VTKHDF/PointData/stress", GN_F64, 4, 9, 0, tensor, error));
    assert_memory_equal(tensor, stress, sizeof tensor);
    ok(gn_h5_get(file, "VTKHDF/FieldData/TimeValue", GN_F64, 1, 1, 0, &time, error));
    assert_true(time == 0.25);
    gn_h5_close(file);
}

static void bonds_are_lines_also_when_none_is_left(void **state) {
    fixture *f = *state;
    char path[128];
    uint8_t types[3];
    double values[3];
    gn_h5 *file;
    const gn_snapshot_array arrays[] = {{"force", "N", 1, force, false}};
    gn_snapshot s = {.point_count = 4,
                     .points = points[0],
                     .line_count = 3,
                     .lines = lines[0],
                     .line_array_count = 1,
                     .line_arrays = arrays};
    ok(gn_snapshot_write(f->dir, "bonds", &s, error));
    snprintf(path, sizeof path, "%s/bonds_0000000000.hdf", f->dir);
    ok(gn_h5_open(path, &file, error));
    read_i64(file, "VTKHDF/NumberOfCells", 1, (int64_t[]){3});
    read_i64(file, "VTKHDF/Connectivity", 6, (int64_t[]){0, 1, 1, 2, 0, 3});
    read_i64(file, "VTKHDF/Offsets", 4, (int64_t[]){0, 2, 4, 6});
    ok(gn_h5_get(file, "VTKHDF/Types", GN_U8, 3, 1, 0, types, error));
    for (int k = 0; k < 3; k++) assert_int_equal(types[k], 3);
    ok(gn_h5_get(file, "VTKHDF/CellData/force", GN_F64, 3, 1, 0, values, error));
    assert_memory_equal(values, force, sizeof values);
    gn_h5_close(file);

    s.line_count = 0;
    ok(gn_snapshot_write(f->dir, "bonds", &s, error));
    ok(gn_h5_open(path, &file, error));
    read_i64(file, "VTKHDF/NumberOfCells", 1, (int64_t[]){0});
    read_i64(file, "VTKHDF/Offsets", 1, (int64_t[]){0});
    gn_h5_close(file);
}

/* The reader of ParaView 5.11 requires the type as a string of fixed length, in ASCII. */
static void the_type_is_a_fixed_ascii_string(void **state) {
    fixture *f = *state;
    char path[128], type[17] = "";
    int version[2];
    gn_snapshot s = particles_at(0, 0);
    ok(gn_snapshot_write(f->dir, "p", &s, error));
    snprintf(path, sizeof path, "%s/p_0000000000.hdf", f->dir);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t attribute = H5Aopen_by_name(file, "VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
    hid_t stored = H5Aget_type(attribute);
    assert_int_equal(H5Tget_class(stored), H5T_STRING);
    assert_int_equal(H5Tis_variable_str(stored), 0);
    assert_int_equal(H5Tget_cset(stored), H5T_CSET_ASCII);
    assert_int_equal(H5Tget_size(stored), 16);
    assert_true(H5Aread(attribute, stored, type) >= 0);
    assert_string_equal(type, "UnstructuredGrid");
    hid_t second = H5Aopen_by_name(file, "VTKHDF", "Version", H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Aread(second, H5T_NATIVE_INT, version) >= 0);
    assert_true(version[0] == 1 && version[1] == 0);
    H5Aclose(second), H5Tclose(stored), H5Aclose(attribute), H5Fclose(file);
}

static void a_snapshot_that_makes_no_sense_is_refused(void **state) {
    fixture *f = *state;
    const int32_t wrong[2] = {0, 4};
    gn_snapshot s = {.point_count = 4, .points = points[0], .line_count = 1, .lines = wrong};
    fails(gn_snapshot_write(f->dir, "p", &s, error), GNEISS_ERROR_INTERNAL,
          "a point below 4, found 4");
    s = particles_at(-1, 0);
    fails(gn_snapshot_write(f->dir, "p", &s, error), GNEISS_ERROR_INTERNAL, "step -1");
    s = particles_at(1, 0);
    fails(gn_snapshot_write(f->path, "p", &s, error), GNEISS_ERROR_IO, "No such file or directory");
    assert_int_equal(entries(f->dir, false), 0);
}

static void the_series_is_made_from_the_files(void **state) {
    fixture *f = *state;
    char path[128], *text;
    const int64_t steps[] = {20000000000, 0, 500, 900};
    const double at[] = {3, 0, 0.1, 0.2};
    gn_snapshot_times times = {0}, later = {0};
    for (int k = 0; k < 4; k++) {
        gn_snapshot s = particles_at(steps[k], at[k]);
        ok(gn_snapshot_write(f->dir, "p", &s, error));
        ok(gn_snapshot_write(f->dir, "p_q", &s,
                             error)); /* another series whose name begins alike */
    }
    snprintf(path, sizeof path, "%s/p_0000000700.hdf.tmp", f->dir);
    spill(path, "cut", 3);
    snprintf(path, sizeof path, "%s/p.hdf.series", f->dir);
    ok(gn_snapshot_series(f->dir, "p", INT64_MAX, &times, error));
    ok(gn_read_text_file(path, 10000, &text, error));
    assert_non_null(strstr(text, "\"name\": \"p_20000000000.hdf\",\n      \"time\": 3\n"));
    free(text);

    ok(gn_snapshot_series(f->dir, "p", 500, &times, error));
    ok(gn_read_text_file(path, 10000, &text, error));
    assert_string_equal(text,
                        "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n"
                        "    {\n      \"name\": \"p_0000000000.hdf\",\n      \"time\": 0\n    },\n"
                        "    {\n      \"name\": \"p_0000000500.hdf\",\n      \"time\": 0.1\n    }\n"
                        "  ]\n}\n");
    free(text);
    assert_false(exists(f->dir, "p_0000000900.hdf"));
    assert_false(exists(f->dir, "p_20000000000.hdf"));
    assert_false(exists(f->dir, "p_0000000700.hdf.tmp"));
    assert_true(exists(f->dir, "p_q_0000000900.hdf"));

    snprintf(path, sizeof path, "%s/p_0000000500.hdf", f->dir);
    assert_int_equal(truncate(path, 2000), 0);
    fails(gn_snapshot_series(f->dir, "p", 500, &later, error), GNEISS_ERROR_INPUT,
          "p_0000000500.hdf: is damaged");
    /* Entries that are known already are not read again. */
    ok(gn_snapshot_series(f->dir, "p", 500, &times, error));
    ok(gn_snapshot_times_add(&later, 500, 0.4, error));
    ok(gn_snapshot_times_add(&later, 500, 0.3, error));
    ok(gn_snapshot_times_add(&later, 100, 0.2, error));
    assert_int_equal(later.step[1], 100);
    ok(gn_snapshot_series(f->dir, "p", 500, &later, error));
    snprintf(path, sizeof path, "%s/p.hdf.series", f->dir);
    ok(gn_read_text_file(path, 10000, &text, error));
    assert_non_null(strstr(text, "\"name\": \"p_0000000500.hdf\",\n      \"time\": 0.3\n"));
    free(text);
    gn_snapshot_times_free(&times);
    gn_snapshot_times_free(&later);
    fails(gn_snapshot_series(f->path, "p", 500, &times, error), GNEISS_ERROR_IO,
          "cannot be listed");
}

/* ---- checkpoints */

static void checkpoint(fixture *f, int64_t step) {
    char *path;
    ok(gn_checkpoint_path(f->dir, step, &path, error));
    spill(path, "x", 1);
    free(path);
}

static void checkpoints_are_listed_newest_first(void **state) {
    fixture *f = *state;
    int64_t steps[8];
    size_t count;
    char *path, name[160];
    ok(gn_checkpoint_path("out", 42, &path, error));
    assert_string_equal(path, "out/checkpoint_0000000042.h5");
    free(path);
    fails(gn_checkpoint_path("out", -1, &path, error), GNEISS_ERROR_INTERNAL, "-1");

    ok(gn_checkpoint_list(f->dir, steps, 8, &count, error));
    assert_int_equal(count, 0);
    checkpoint(f, 7), checkpoint(f, 123456789012), checkpoint(f, 9999999999), checkpoint(f, 0);
    static const char *const others[] = {"checkpoint_12.h5", "checkpoint_00000000012.h5",
                                         "checkpoint_0000000012.h5x", "checkpoint_0000000013",
                                         "my_checkpoint_0000000012.h5"};
    for (int k = 0; k < 5; k++) {
        snprintf(name, sizeof name, "%s/%s", f->dir, others[k]);
        spill(name, "x", 1);
    }
    snprintf(name, sizeof name, "%s/checkpoint_0000000099.h5.tmp", f->dir);
    spill(name, "x", 1);
    ok(gn_checkpoint_list(f->dir, steps, 8, &count, error));
    assert_int_equal(count, 4);
    assert_memory_equal(steps, ((int64_t[]){123456789012, 9999999999, 7, 0}), 4 * sizeof *steps);
    assert_int_not_equal(access(name, F_OK), 0);
    ok(gn_checkpoint_list(f->dir, steps, 2, &count, error));
    assert_int_equal(count, 2);
    assert_int_equal(steps[0], 123456789012);
    fails(gn_checkpoint_list(f->path, steps, 2, &count, error), GNEISS_ERROR_IO, "No such file");
    assert_int_equal(count, 0);
}

static void pruning_keeps_the_newest(void **state) {
    fixture *f = *state;
    int64_t steps[8];
    size_t count;
    for (int64_t k = 0; k < 5; k++) checkpoint(f, 1000 * k);
    spill(f->path, "other", 5);
    ok(gn_checkpoint_prune(f->dir, 9, error));
    assert_int_equal(entries(f->dir, false), 6);
    ok(gn_checkpoint_prune(f->dir, 2, error));
    ok(gn_checkpoint_list(f->dir, steps, 8, &count, error));
    assert_int_equal(count, 2);
    assert_true(steps[0] == 4000 && steps[1] == 3000);
    ok(gn_checkpoint_prune(f->dir, 0, error));
    assert_int_equal(entries(f->dir, false), 1);
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        WITH(a_text_file_is_written_and_read),
        WITH(texts_that_cannot_be_read_are_named),
        WITH(a_full_disk_leaves_the_old_text),
        WITH(folders_are_made_with_their_parents),
        WITH(folders_that_cannot_be_made_are_named),
        cmocka_unit_test(json_nests_and_escapes),
        cmocka_unit_test(json_is_indented_on_request),
        cmocka_unit_test(json_numbers_read_back_exactly),
        cmocka_unit_test(json_stays_valid_when_misused),
        WITH(packings_are_read_in_all_their_spellings),
        WITH(the_scale_multiplies_everything),
        WITH(a_decimal_comma_of_the_locale_changes_nothing),
        WITH(wrong_packings_are_refused_at_line_and_column),
        WITH(what_is_no_packing_at_all_is_refused),
        cmocka_unit_test(the_shared_specimens_are_read),
        WITH(particles_are_vertices),
        WITH(bonds_are_lines_also_when_none_is_left),
        WITH(the_type_is_a_fixed_ascii_string),
        WITH(a_snapshot_that_makes_no_sense_is_refused),
        WITH(the_series_is_made_from_the_files),
        WITH(checkpoints_are_listed_newest_first),
        WITH(pruning_keeps_the_newest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
