/* Packings whose columns a header names. */
#include "io_helpers.h"

#include "base/memory.h"
#include "io/packing.h"

#include <math.h>
#include <string.h>

static bool unit(void *units, const char *text, const char *wanted, double *value, char *reason,
                 size_t size) {
    static const struct {
        const char *text, *wanted;
        double value;
    } known[] = {{"1 mm", "m", 1e-3},     {"1 m", "m", 1.0},         {"1 g/cm3", "kg/m3", 1000.0},
                 {"1 mm/s", "m/s", 1e-3}, {"1 kg/m3", "kg/m3", 1.0}, {"1 rad/s", "rad/s", 1.0}};
    (void)units;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(text, known[k].text) == 0 && strcmp(wanted, known[k].wanted) == 0) {
            *value = known[k].value;
            return true;
        }
    snprintf(reason, size, "unknown");
    return false;
}

static int material(const void *materials, const char *name) {
    (void)materials;
    return strcmp(name, "rock") == 0 ? 0 : strcmp(name, "soft clay") == 0 ? 1 : -1;
}

static const gn_packing_words words = {.unit = unit, .material = material, .material_count = 2};

static gneiss_status read_text(fixture *f, const char *text, size_t size, int dimension,
                               double scale, gn_packing *p, gneiss_error *error) {
    FILE *file = fopen(f->path, "wb");
    assert_non_null(file);
    if (size) assert_int_equal(fwrite(text, 1, size, file), size);
    fclose(file);
    return gn_packing_read_columns(f->path, dimension, scale, &words, p, error);
}

static gn_packing read_good(fixture *f, const char *text, int dimension) {
    gn_packing p;
    gneiss_error error = {0};
    if (read_text(f, text, strlen(text), dimension, 1.0, &p, &error))
        fail_msg("%s: %s", text, error.message);
    return p;
}

static void columns_come_in_any_order_with_units(void **state) {
    gn_packing p =
        read_good(*state,
                  "# by hand\n"
                  "\"group\", vx[mm/s],material,z [mm], y(mm), x[mm] ,Diameter [mm], -, wz, "
                  "density[g/cm3]\n"
                  "3,10,\"soft clay\",3,2,1,0.5,nothing,7,2.5 # one\n\n"
                  "0,20,rock,6,5,4,1,\"a b\",8,2\n",
                  3);
    const double spheres[2][4] = {{1 * 1e-3, 2 * 1e-3, 3 * 1e-3, 0.5 * (0.5 * 1e-3)},
                                  {4 * 1e-3, 5 * 1e-3, 6 * 1e-3, 0.5 * (1 * 1e-3)}};
    const double motion[2][6] = {{10 * 1e-3, 0, 0, 0, 0, 7}, {20 * 1e-3, 0, 0, 0, 0, 8}};
    assert_int_equal(p.count, 2);
    assert_memory_equal(p.sphere, spheres, sizeof spheres);
    assert_memory_equal(p.columns.motion, motion, sizeof motion);
    assert_int_equal(p.columns.material[0], 1);
    assert_int_equal(p.columns.material[1], 0);
    assert_int_equal(p.columns.group[0], 3);
    assert_int_equal(p.columns.group[1], 0);
    assert_true(p.columns.density[0] == 2500.0 && p.columns.density[1] == 2000.0);
    assert_true(p.columns.states_units);
    assert_false(p.columns.renumbered);
    gn_packing_free(&p);
}

/* A header that names what rows without a header hold changes no bit. */
static void plain_rows_are_read_alike_with_a_header(void **state) {
    static const char rows[] = "0.1 0.2 0.3 1e-3\n-4.7 .5 6. 2E-3\n";
    static const char *const headers[] = {"",
                                          "x y z r\n",
                                          "X\tY\tZ\tRadius\n",
                                          "# x y z r [mm]\n",
                                          "#format x_y_z_r\n",
                                          "# r is the radius\n",
                                          "# x y r\n",
                                          "\xef\xbb\xbfx,y , z,r\r\n"};
    gn_packing plain = read_good(*state, rows, 3);
    for (size_t k = 0; k < sizeof headers / sizeof *headers; k++) {
        char text[256];
        snprintf(text, sizeof text, "%s%s", headers[k], rows);
        gn_packing p = read_good(*state, text, 3);
        assert_int_equal(p.count, 2);
        assert_memory_equal(p.sphere, plain.sphere, 8 * sizeof(double));
        assert_null(p.columns.material);
        assert_null(p.columns.motion);
        gn_packing_free(&p);
    }
    gn_packing_free(&plain);
}

static void comments_and_yade_name_columns(void **state) {
    static const char *const texts[] = {"#format x_y_z_r_matId\n# two materials\n1\t2\t3\t4\t1\n",
                                        "# id radius x y z type\n7 4 1 2 3 2\n",
                                        "#\n#  x  y  z  radius  material\n1 2 3 4 \"soft clay\"\n",
                                        "#format id_x_y_z_r_matId\n0 1 2 3 4 1\n"};
    const double sphere[4] = {1, 2, 3, 4};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        gn_packing p = read_good(*state, texts[k], 3);
        assert_int_equal(p.count, 1);
        assert_memory_equal(p.sphere, sphere, sizeof sphere);
        assert_non_null(p.columns.material);
        assert_int_equal(p.columns.material[0], 1);
        gn_packing_free(&p);
    }
}

static void rows_are_sorted_by_id(void **state) {
    enum { COUNT = 3000 }; /* more than the reader's first room */
    static char text[COUNT * 40 + 64];
    size_t used = (size_t)sprintf(text, "id x y z r group density vy\n");
    for (int k = 0; k < COUNT; k++) {
        int id = (k * 1009) % COUNT;
        used += (size_t)sprintf(text + used, "%d %d 0 0 1 %d %d %d\n", id, id, id % 7, id + 1, -id);
    }
    gn_packing p = read_good(*state, text, 3);
    assert_int_equal(p.count, COUNT);
    for (int k = 0; k < COUNT; k++) {
        assert_true(p.sphere[4 * k] == k && p.columns.group[k] == k % 7);
        assert_true(p.columns.density[k] == k + 1 && p.columns.motion[6 * k + 1] == -k);
    }
    assert_false(p.columns.renumbered);
    gn_packing_free(&p);
    p = read_good(*state, "x y z r id\n1 0 0 1 30\n2 0 0 1 10\n3 0 0 1 20\n", 3);
    assert_true(p.columns.renumbered);
    assert_true(p.sphere[0] == 2 && p.sphere[4] == 3 && p.sphere[8] == 1);
    gn_packing_free(&p);
}

/* A scale is for lengths: velocities beside it have units of their own. */
static void a_scale_goes_with_units_of_velocities(void **state) {
    gn_packing p;
    gneiss_error error = {0};
    const char text[] = "x y z r vx[mm/s] density[g/cm3]\n1 2 3 4 5 6\n";
    assert_int_equal(read_text(*state, text, strlen(text), 3, 0.001, &p, &error), GNEISS_OK);
    assert_true(fabs(p.sphere[0] - 0.001) < 1e-18 && fabs(p.sphere[3] - 0.004) < 1e-18);
    assert_true(fabs(p.columns.motion[0] - 0.005) < 1e-18);
    assert_true(fabs(p.columns.density[0] - 6000.0) < 1e-9);
    assert_false(p.columns.states_units); /* of lengths */
    gn_packing_free(&p);
}

static void two_dimensions_stay_in_their_plane(void **state) {
    gn_packing p = read_good(*state, "r x y vx vy wz\n1 2 3 4 5 6\n", 2);
    const double motion[6] = {4, 5, 0, 0, 0, 6};
    assert_true(p.sphere[0] == 2 && p.sphere[2] == 0 && p.sphere[3] == 1);
    assert_memory_equal(p.columns.motion, motion, sizeof motion);
    gn_packing_free(&p);
    p = read_good(*state, "r x y z vz\n1 2 3 7 0\n1 5 3 7 0\n", 2);
    assert_true(p.sphere[2] == 0 && p.sphere[6] == 0);
    gn_packing_free(&p);
}

static void wrong_columns_are_refused_at_line_and_column(void **state) {
    fixture *f = *state;
    static const struct {
        int dimension;
        double scale;
        const char *text, *message;
    } cases[] = {
        {3, 1, "x y z w\n1 2 3 4", "a.txt:1:7: expected a column named x y z radius"},
        {3, 1, "x y z\n1 2 3\n", "a.txt:1:6: expected a column radius or diameter, found none"},
        {3, 1, "x y r\n1 2 3\n", "a.txt:1:6: expected a column z, found none"},
        {3, 1, "x y z r r\n1 2 3\n", "a.txt:1:9: expected every column once, found 'r' again"},
        {3, 1, "x y z r d\n1 2 3\n", "expected one of the columns radius and diameter, found both"},
        {3, 1, "x y z r type matId\n1 2 3\n", "expected one of the columns type and matId"},
        {3, 1, "x[kg] y z r\n1 2 3 4", "a.txt:1:3: expected a unit such as m, found 'kg': unknown"},
        {3, 1, "x[mm y z r\n1 2 3 4", "a.txt:1:2: expected a unit in brackets, found no closing"},
        {3, 1, "x y z r id[mm]\n1 2 3 4 5", "a.txt:1:12: expected no unit of id, found 'mm'"},
        {3, 2, "x[mm] y z r\n1 2 3 4",
         "units of lengths either in the header or by specimen.scale, found 'mm'"},
        {3, 2, "x y z r vx\n1 2 3 4 5", "a.txt:1:9: expected a unit, such as vx[m/s], beside"},
        {3, 1, "x y z r\n1 2 3", "a.txt:2:6: expected 4 columns as in the header, found fewer"},
        {3, 1, "x y z r\n1 2 3 4 5", "a.txt:2:9: expected 4 columns as in the header, found more"},
        {3, 1, "x y z r\n1 2 3 4,", "a.txt:2:9: expected 4 columns as in the header, found more"},
        {3, 1, "x,y,z,r\n1,,3,4", "a.txt:2:3: expected a number, found nothing beside the comma"},
        {3, 1, "x y z r\n1 nan 3 4", "a.txt:2:3: expected a finite decimal number, found 'nan'"},
        {3, 1, "x y z r\n1 1e999 3 4", "a.txt:2:3: expected a finite number, found '1e999'"},
        {3, 1e308, "x y z r\n1 20 3 4", "a.txt:2:3: expected a finite number, found '20'"},
        {3, 1, "x y z r\n1 2 3 0", "a.txt:2:7: expected a radius > 0, found 0"},
        {3, 1, "x y z r density\n1 2 3 4 -5", "a.txt:2:9: expected a density > 0, found -5"},
        {3, 1, "x y z r id\n1 2 3 4 1\n2 2 2 2 2\n3 3 3 3 1\n",
         "a.txt:4:9: expected every id once, found 1 again (line 2)"},
        {3, 1, "x y z r id\n1 2 3 4 1.5\n", "a.txt:2:9: expected a whole number from 0 to"},
        {3, 1, "x y z r id\n1 2 3 4 -1\n", "a.txt:2:9: expected a whole number from 0 to"},
        {3, 1, "x y z r group\n1 2 3 4 1000001\n", "from 0 to 1000000 of group, found 1000001"},
        {3, 1, "x y z r type\n1 2 3 4 0\n",
         "a.txt:2:9: expected a whole number from 1 to 2 of type"},
        {3, 1, "x y z r matId\n1 2 3 4 2\n",
         "expected a whole number from 0 to 1 of matId, found 2"},
        {3, 1, "x y z r material\n1 2 3 4 iron\n",
         "a.txt:2:9: expected the name of a material of the scene, found 'iron'"},
        {3, 1, "x y z r material\n1 2 3 4 \"\"\n", "a.txt:2:10: expected the name of a material"},
        {3, 1, "x y z r", "a.txt:2:1: no particles: expected lines below the header"},
        {3, 1, "x y z r\nx y z r\n", "a.txt:2:1: expected a finite decimal number, found 'x'"},
        {3, 1, "1 2 3 4 5\n", "a.txt:1:9: expected x y z r, found a column more"},
        {2, 1, "x y z r\n1 2 3 4\n1 2 4 4\n", "a.txt:3:5: expected z = 3 m as above (two dim"},
        {2, 1, "x y r vz\n1 2 3 4\n", "a.txt:2:7: expected vz = 0 (two dimensions), found 4"},
        {3, 1, "ITEM: TIMESTEP\n0\n", "found a dump of LAMMPS or LIGGGHTS: gneiss convert"},
        {3, 1, "anything at all\n\n 12 atoms\n", "found a data file of LAMMPS or LIGGGHTS"},
        {3, 1, "LSMGeometry 1.2\n", "found a geometry of ESyS-Particle"},
        {3, 1, "# vtk DataFile Version 3.0\n", "found a VTK file"},
        {3, 1, "<?xml version=\"1.0\"?>\n", "found an XML file, as VTK writes them"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_packing p;
        fails(read_text(f, cases[k].text, strlen(cases[k].text), cases[k].dimension, cases[k].scale,
                        &p, error),
              GNEISS_ERROR_INPUT, cases[k].message);
        assert_null(p.sphere);
        assert_null(p.columns.motion);
    }
    gn_packing p;
    static char wide[400];
    for (int k = 0; k < 66; k++) strcat(wide, "- ");
    fails(read_text(f, wide, strlen(wide), 3, 1.0, &p, error), GNEISS_ERROR_INPUT,
          "a.txt:1:129: expected at most 64 columns");
}

static uint32_t next(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* Damaged files are read as something sound or refused with their place. */
static void damaged_files_are_sound_or_refused(void **state) {
    fixture *f = *state;
    static const char good[] =
        "id,material,x[mm],y[mm],z[mm],radius[mm],density[g/cm3],vx[mm/s],group\n"
        "0,rock,1,2,3,0.5,2.5,10,1\n2,\"soft clay\",4,5,6,0.5,2.5,-1e1,1\n1,rock,7,8,9,1,2,0,0\n";
    static const char alphabet[] = "0123456789.,-+eExyzridn[]()\"# \t\r\n_\xef\xbb\xbf";
    uint32_t seed = 7;
    int read = 0, refused = 0;
    for (int round = 0; round < 1200; round++) {
        char text[sizeof good + 8];
        size_t size = round % 3 ? sizeof good - 1 : next(&seed) % sizeof good;
        memcpy(text, good, size);
        for (uint32_t k = 0, changes = next(&seed) % 4; size && k < changes; k++)
            text[next(&seed) % size] =
                round % 2 ? (char)next(&seed) : alphabet[next(&seed) % (sizeof alphabet - 1)];
        gn_packing p;
        gneiss_error error = {0};
        gneiss_status status = read_text(f, text, size, 3, 1.0, &p, &error);
        read += status == GNEISS_OK;
        refused += status != GNEISS_OK;
        if (status != GNEISS_OK) {
            assert_int_equal(status, GNEISS_ERROR_INPUT);
            assert_non_null(strstr(error.message, "a.txt:"));
        }
        for (size_t k = 0; status == GNEISS_OK && k < p.count; k++) {
            assert_true(p.sphere[4 * k + 3] > 0 && isfinite(p.sphere[4 * k] + p.sphere[4 * k + 1]));
            if (p.columns.material) assert_in_range(p.columns.material[k], 0, 1);
            if (p.columns.density) assert_true(p.columns.density[k] > 0);
        }
        gn_packing_free(&p);
    }
    assert_true(read > 200 && refused > 400);
}

static int setup(void **state) {
    return make_fixture(state, "a.txt");
}

int main(void) {
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        WITH(columns_come_in_any_order_with_units),
        WITH(plain_rows_are_read_alike_with_a_header),
        WITH(comments_and_yade_name_columns),
        WITH(rows_are_sorted_by_id),
        WITH(two_dimensions_stay_in_their_plane),
        WITH(a_scale_goes_with_units_of_velocities),
        WITH(wrong_columns_are_refused_at_line_and_column),
        WITH(damaged_files_are_sound_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
