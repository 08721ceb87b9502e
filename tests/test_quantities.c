/* docs/quantities*.md agree with the tables of quantities, and a history has the quantities of the
 * tables. `test_quantities docs` writes the pages. */
#include "world_helpers.h"

#include "run/history_rows.h"
#include "run/output_table.h"
#include "run/part_files.h"
#include "run/quantities.h"
#include "test_kinds/readings.h"

#include <unistd.h>

static void history_row(FILE *file, const gn_quantity_group *group, const gn_quantity *q) {
    gn_shape_component part[GN_SHAPE_MOST];
    gn_shape_components(q->shape, 3, part);
    bool more = q->shape != GN_SCALAR;
    char when[256];
    fprintf(file, "| `%s%s%s%s`%s | %s | %s | %s |\n", group->kind ? group->kind : "",
            group->kind ? "_<name>_" : "", q->name, part[0].suffix, more ? " .." : "", q->unit,
            q->text, gn_condition_text(q->when, when, sizeof when));
}

static void field_rows(FILE *file, const gn_output_table *table) {
    static const char *const where[] = {"", "results.h5", "snapshots", "both"};
    fprintf(file, "\n| field | components | unit | is | in |\n| --- | --- | --- | --- | --- |\n");
    for (size_t k = 0; k < table->count; k++) {
        const gn_output_field *f = &table->fields[k];
        fprintf(file, "| `%s` | %zu | %s | %s | %s |\n", f->name, f->components, f->unit, f->text,
                f->where >> GN_ASKED_SHIFT == 0 ? where[f->where]
                : f->where & GN_IN_RESULTS      ? "results.h5; on request both"
                                                : "on request both");
    }
}

/* Writes the data that results.h5 has of a group of owners in addition to a table of fields. */
static void owner_rows(FILE *file, const char *ends) {
    for (int g = 0; g < GN_QUANTITY_GROUPS; g++) {
        const gn_quantity_group *group = &gn_quantity_groups[g];
        if (!group->ends || strcmp(group->ends, ends) != 0) continue;
        for (size_t k = 0; k < group->quantity_count; k++) {
            gn_shape_component part[GN_SHAPE_MOST];
            const gn_quantity *q = &group->quantities[k];
            fprintf(file, "| `%s` | %zu | %s | %s | results.h5 |\n", q->name,
                    gn_shape_components(q->shape, 3, part), q->unit, q->text);
        }
    }
}

/* The kinds of tests that have a reading. */
static const char *tests_of(gn_reading which, char *of, size_t size) {
    if (gn_reading_belongs(which, GN_TEST_NONE, true) &&
        !gn_reading_belongs(which, GN_TEST_NONE, false))
        return "scenes with couple.zones";
    size_t used = 0, count = 0;
    of[0] = 0;
    for (int k = 1; k < GN_TEST_KINDS; k++)
        if (gn_reading_belongs(which, (gn_test_kind)k, false)) {
            used += (size_t)snprintf(of + used, size - used, "%s%s", count ? ", " : "",
                                     gn_test_of((gn_test_kind)k)->name);
            count++;
        }
    if (count == GN_TEST_KINDS - 1) snprintf(of, size, "all tests");
    return of;
}

#define HEAD(TITLE, SOURCES)                                                                       \
    "# " TITLE                                                                                     \
    "\n\nWritten by `build/tests/test_quantities docs` from the tables that also drive "           \
    "what is measured and written\n(" SOURCES ").\n\n"

static void write_history(FILE *file) {
    fputs(HEAD("Quantities", "src/run/quantities.c, src/measure/energy.h"), file);
    fputs(
        "[Readings](quantities-readings.md) and [fields](quantities-fields.md) have pages of their "
        "own; [results-h5.md](results-h5.md) says where they stand.\n\n"
        "## History\n\nA row is of the instant at which a "
        "step starts. `_x ..` stands for the components that the dimension has: `_x _y _z`,\nof "
        "moments in 2D `_z`; `_xx ..` for `_xx _yy _zz _xy _yz _xz`.\n\n| column | unit | is | "
        "there |\n| --- | --- | --- | --- |\n",
        file);
    for (int g = 0; g < GN_QUANTITY_GROUPS; g++)
        for (size_t k = 0; k < gn_quantity_groups[g].quantity_count; k++)
            history_row(file, &gn_quantity_groups[g], &gn_quantity_groups[g].quantities[k]);
    gn_energy_figure figure[GN_ENERGY_FIGURES];
    gn_energy_figures(&(gn_energy){0}, figure);
    fputs("\n## Energy\n\nThe ledger at the last measured instant: that of the last step, or of a "
          "row that ended the run.\n\n| term | kind | unit | is |\n| --- | --- | --- | --- |\n",
          file);
    for (int k = 0; k < GN_ENERGY_FIGURES; k++)
        fprintf(file, "| `%s` | %s | %s | %s |\n", figure[k].name,
                figure[k].kind ? figure[k].kind : "", figure[k].unit, figure[k].text);
}

static void write_readings(FILE *file) {
    char of[256];
    fputs(HEAD("Readings, a table", "src/test_kinds/readings.h"), file);
    fputs("When they are there, and how they are read: [readings.md](readings.md).\n\n"
          "| reading | unit | is | of |\n| --- | --- | --- | --- |\n",
          file);
#define X(name, unit, text)                                                                        \
    fprintf(file, "| `%s` | %s | %s | %s |\n", #name, unit, text,                                  \
            tests_of(GN_READING_##name, of, sizeof of));
    GN_READINGS(X)
#undef X
}

static void write_fields(FILE *file) {
    static const struct {
        const char *title;
        const gn_output_table *table;
    } tables[] = {{"Particles", &gn_particle_outputs},
                  {"Bonds", &gn_bond_outputs},
                  {"Contacts", &gn_contact_outputs},
                  {"Events", &gn_event_outputs},
                  {"Bursts", &gn_burst_outputs},
                  {"Fragments", &gn_fragment_outputs},
                  {"Rim", &gn_rim_outputs},
                  {"Nodes", &gn_node_outputs},
                  {"Elements", &gn_element_outputs},
                  {"Bodies", &gn_body_outputs},
                  {"Vertices of bodies", &gn_vertex_outputs},
                  {"Facets of bodies", &gn_facet_outputs}};
    fputs(HEAD("Fields", "src/run/output_fields.c, output_contacts.c, events.c, "
                         "output_fragments.c, output_elements.c, output_bodies.c"),
          file);
    fputs("Data of particles, bonds, elements and bodies in results.h5 and snapshots "
          "([results-h5.md](results-h5.md)).\n",
          file);
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
        fprintf(file, "\n## %s\n", tables[k].title);
        field_rows(file, tables[k].table);
        if (tables[k].table == &gn_body_outputs) owner_rows(file, "bodies");
    }
    fputs("\n## Motions\n\n| field | components | unit | is | in |\n| --- | --- | --- | --- | --- "
          "|\n",
          file);
    owner_rows(file, "motions");
}

static const struct {
    const char *name;
    void (*write)(FILE *file);
} pages[] = {{"quantities.md", write_history},
             {"quantities-readings.md", write_readings},
             {"quantities-fields.md", write_fields}};
enum { PAGES = sizeof pages / sizeof *pages };

static void docs_quantities_are_up_to_date(void **state) {
    (void)state;
    enum { MOST = 1 << 16 };
    for (int k = 0; k < PAGES; k++) {
        char path[4096], *wanted = NULL, *there = calloc(1, MOST);
        size_t size = 0;
        FILE *made = open_memstream(&wanted, &size);
        assert_non_null(made);
        pages[k].write(made);
        assert_int_equal(fclose(made), 0);
        snprintf(path, sizeof path, "%s/docs/%s", test_source(), pages[k].name);
        FILE *file = fopen(path, "r");
        if (!file) fail_msg("%s is missing", path);
        there[fread(there, 1, MOST - 1, file)] = 0;
        fclose(file);
        if (strcmp(wanted, there) != 0)
            fail_msg("%s: stale: build/tests/test_quantities docs", path);
        free(wanted);
        free(there);
    }
}

static const char scene[] =
    "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1e-3, cells: [4, 4%s]}}\n"
    "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
    "sets:\n  - {name: still, select: {ids: [0]}, motion: {vx: 0}}\n"
    "  - {name: free, select: {ids: [1]}}\n"
    "walls:\n  - {name: low, point: [0, 0, 0], normal: [0, %d, %d], stiffness: 1e6}\n"
    "time: {end: 1}\nrun: {threads: 1}\n";

/* A vector has as many columns as there are dimensions, a tensor three or six. */
static void columns_follow_the_table(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        gn_world *w = d == 2 ? world_of(scene, 2, "square", "", 1, 0)
                             : world_of(scene, 3, "cubic", ", 4", 0, 1);
        gn_history h;
        gneiss_error error = {0};
        assert_int_equal(gn_history_create_columns(w, &h, &error), GNEISS_OK);
        const char *there[] = {"step",
                               "strain_xy",
                               "wall_low_force_y",
                               "damage",
                               "energy_friction",
                               "energy_residual",
                               "stress_yy",
                               "set_still_reaction_x",
                               "unbalanced"};
        const char *absent[] = {"strain", "set_free_reaction_x", "elements_strain_xx"};
        for (size_t k = 0; k < sizeof there / sizeof *there; k++) {
            assert_int_equal(gn_history_record_step(w, &h, &error), GNEISS_OK);
            if (!gn_history_column(&h, there[k])) fail_msg("no %s", there[k]);
        }
        for (size_t k = 0; k < sizeof absent / sizeof *absent; k++)
            if (gn_history_column(&h, absent[k])) fail_msg("%s", absent[k]);
        assert_true(!gn_history_column(&h, "strain_zz") == (d == 2));
        assert_true(!gn_history_column(&h, "wall_low_displacement_z") == (d == 2));
        assert_true(gn_history_column(&h, "step")[4] == 4.0);
        gn_history_free(&h);
        world_end(w);
    }
}

static const char owners[] =
    "specimen: {particles: [[0, 0, 0, 1e-3]]}\n"
    "materials: [{name: m, density: 2650, normal_stiffness: 1e6, kratio: 2, friction: 0.5}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
    "bodies:\n"
    "  - {name: still, box: {size: [2e-3, 2e-3, 2e-3]}, origin: [9e-3, 0, 0], stiffness: 1e6}\n"
    "  - {name: goes, box: {size: [2e-3, 2e-3, 2e-3]}, origin: [-9e-3, 0, 0], stiffness: 1e6, "
    "motion: {vx: 0.1}}\n"
    "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n";

/* A quantity that the history has of bodies is in results.h5 without further work, a row for each
 * in the order of the scene. */
static void results_have_the_final_quantities_of_bodies(void **state) {
    (void)state;
    char path[] = "/tmp/gneiss-quantities-XXXXXX";
    gneiss_error error = {0};
    gn_h5 *file = NULL;
    gn_world *w = world_of("%s", owners);
    double displacement[2][3];
    close(mkstemp(path));
    run_steps(w, 10);
    assert_int_equal(gn_h5_create(path, &file, &error), GNEISS_OK);
    assert_int_equal(gn_owners_results(w, file, &error), GNEISS_OK);
    assert_int_equal(gn_h5_commit(&file, GN_DURABLE, &error), GNEISS_OK);
    assert_int_equal(gn_h5_open(path, &file, &error), GNEISS_OK);
    assert_int_equal(gn_h5_get(file, "bodies/displacement", GN_F64, 2, 3, 0, displacement, &error),
                     GNEISS_OK);
    assert_near(displacement[0][0], 0.0, 0.0);
    /* Ten steps, each of which rounds a coordinate of 9 mm by half of 1.7e-18 m. */
    assert_near(displacement[1][0], 1e-6, 9e-18);
    assert_near(displacement[1][1], 0.0, 0.0);
    for (size_t g = 0; g < GN_QUANTITY_GROUPS; g++)
        for (size_t k = 0; k < gn_quantity_groups[g].quantity_count; k++) {
            char name[96];
            snprintf(name, sizeof name, "bodies/%s", gn_quantity_groups[g].quantities[k].name);
            bool of_bodies =
                gn_quantity_groups[g].ends && strcmp(gn_quantity_groups[g].ends, "bodies") == 0;
            if (of_bodies && !gn_h5_has(file, name)) fail_msg("no %s", name);
        }
    gn_h5_close(file);
    unlink(path);
    world_end(w);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(docs_quantities_are_up_to_date),
        cmocka_unit_test(columns_follow_the_table),
        cmocka_unit_test(results_have_the_final_quantities_of_bodies),
    };
    if (argc < 2) return cmocka_run_group_tests(tests, NULL, NULL);
    for (int k = 0; k < PAGES; k++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", argv[1], pages[k].name);
        FILE *file = fopen(path, "w");
        if (!file) return 1;
        pages[k].write(file);
        if (fclose(file) != 0) return 1;
    }
    return 0;
}
