/* Keys of a sweep file, in tables like those of scenes (src/scene/manifest.c). */
#include "base/names.h"
#include "measure/energy.h"
#include "run/quantities.h"
#include "scene/manifest_keys.h"
#include "sweep/range.h"
#include "sweep/sweep.h"
#include "test_kinds/readings.h"

#include <string.h>

static const gn_choice combines[] = {
    {"crossed", GN_COMBINE_CROSSED}, {"zipped", GN_COMBINE_ZIPPED}, {NULL, 0}};
static const gn_choice samplings[] = {
    {"latin", GN_SAMPLING_LATIN}, {"sobol", GN_SAMPLING_SOBOL}, {NULL, 0}};
static const gn_choice spacings[] = {
    {"linear", GN_SPACING_LINEAR}, {"log", GN_SPACING_LOG}, {NULL, 0}};

static const gn_key sampling_keys[] = {
    KEY("method", CHOICE, gn_sweep_file, sampling, .choices = samplings, .required = true,
        .text = "Latin hypercube, or Sobol's sequence with a digital shift"),
    KEY("count", INTEGER, gn_sweep_file, sample_count, .range = "[1, 100000]", .required = true,
        .text = "number of points"),
    KEY("seed", SEED, gn_sweep_file, sample_seed, .fallback = "1", .text = "of the points"),
};
TABLE_OF(sampling);

static const gn_key output_keys[] = {
    KEY("directory", TEXT, gn_sweep_file, directory, .fallback = "",
        .text = "folder of the sweep, relative to the working folder; left out: runs/ and the name "
                "of this file"),
};
TABLE_OF(output);

static const gn_key sweep_keys[] = {
    KEY("title", TEXT, gn_sweep_file, title, .fallback = "", .text = "one line for reports"),
    KEY("scene", FILE, gn_sweep_file, scene, .second = offsetof(gn_sweep_file, scene_path),
        .required = true, .text = "the scene that is varied; relative to the folder of this file"),
    KEY("parameters", TREE, gn_sweep_file, parameters,
        .unit = "section: a key of the scene and its values",
        .text = "keys of the scene, written as for --set, each with a list of values, a range or a "
                "distribution"),
    KEY("combine", CHOICE, gn_sweep_file, combine, .choices = combines, .fallback = "crossed",
        .text = "crossed: every value of a list or range with every value of the others; zipped: "
                "the first values of all together, then the second ones, and so on"),
    SECTION(
        "sampling", sampling_section, PRESENT(ENUM, gn_sweep_file, sampling),
        .text =
            "sampling of distributions; each point is combined with every combination of lists"),
    KEY("seeds", TREE, gn_sweep_file, seeds, .unit = "whole number or list of whole numbers",
        .text = "number of seeds, from run.seed of the scene on, or a list of seeds; every "
                "combination is run with each"),
    ARRAY("readings", NAMES, gn_sweep_file, readings, reading_count,
          PRESENT(COUNT, gn_sweep_file, reading_count),
          .text = "quantities of the summary: readings of a test, energy.TERM, history.COLUMN (its "
                  "last row); left out: all readings, energy.residual and the broken bonds"),
    SECTION("output", output_section, .text = "output of the sweep"),
};

const gn_section gn_sweep_section = {sweep_keys, sizeof sweep_keys / sizeof(gn_key), 0,
                                     GN_NO_WHERE};

static const gn_key range_keys[] = {
    KEY("from", REAL, gn_range_def, from, .unit = "unit of the key",
        .text = "first value; of a distribution the lower end"),
    KEY("to", REAL, gn_range_def, to, .unit = "unit of the key",
        .text = "last value; of a distribution the upper end"),
    KEY("count", INTEGER, gn_range_def, count, .range = "[2, 100000]",
        .text =
            "number of values, both ends included; left out: a distribution, drawn by `sampling`"),
    KEY("spacing", CHOICE, gn_range_def, spacing, .choices = spacings, .fallback = "linear",
        .text = "equal differences or equal ratios; of a distribution: uniform in the value or its "
                "logarithm"),
    KEY("mean", REAL, gn_range_def, mean, .unit = "unit of the key",
        .text = "mean of a normal distribution; from and to, if given, truncate it"),
    KEY("deviation", REAL, gn_range_def, deviation, .unit = "unit of the key",
        .text = "standard deviation of a normal distribution; for a coefficient of friction a "
                "number, not an angle"),
    KEY("of", TREE, gn_range_def, of, .unit = "list of values",
        .text = "a distribution over these values, with equal probabilities"),
};

const gn_section gn_range_section = {range_keys, sizeof range_keys / sizeof(gn_key), 0,
                                     GN_NO_WHERE};

/* ---- names of the readings of a sweep ---- */

static const char *const fixed[] = {
#define X(name, unit, text) #name,
    GN_READINGS(X)
#undef X
#define X(name, kind, text) "energy." #name,
        GN_ENERGY_TERMS(X)
#undef X
            "energy.stored_at_start",
    "energy.residual"};

/* Columns of the whole model; names are borrowed, for advice. */
enum { COLUMNS_MOST = 256 };
typedef struct columns {
    size_t count;
    char name[COLUMNS_MOST][GN_COLUMN_NAME_SIZE];
} columns;

static bool is_ending(const char *name, const char *ending) {
    size_t length = strlen(name), behind = strlen(ending);
    return length > behind && strcmp(name + length - behind, ending) == 0;
}

/* True for columns of a wall, a set, ...: <kind>_<any name>_<quantity>. Only the runs know the
 * names. */
static bool is_of_an_owner(const char *column, const gn_quantity_group *group) {
    size_t length = strlen(group->kind);
    if (strncmp(column, group->kind, length) != 0 || column[length] != '_') return false;
    for (size_t q = 0; q < group->quantity_count; q++) {
        char ending[GN_COLUMN_NAME_SIZE];
        gn_shape_component part[GN_SHAPE_MOST];
        size_t parts = gn_shape_components(group->quantities[q].shape, 3, part);
        for (size_t c = 0; c < parts; c++) {
            snprintf(ending, sizeof ending, "_%s%s", group->quantities[q].name, part[c].suffix);
            if (is_ending(column + length + 1, ending)) return true;
        }
    }
    return false;
}

/* Adds columns; a planar scene has a subset of the columns of a 3D scene. */
static void add_columns(columns *all, const gn_quantity *quantity) {
    gn_shape_component part[GN_SHAPE_MOST];
    size_t parts = gn_shape_components(quantity->shape, 3, part);
    for (size_t c = 0; c < parts && all->count < COLUMNS_MOST; c++)
        snprintf(all->name[all->count++], GN_COLUMN_NAME_SIZE, "history.%s%s", quantity->name,
                 part[c].suffix);
}

static bool is_column(const char *name, columns *all) {
    const char *column = strncmp(name, "history.", 8) == 0 ? name + 8 : "";
    for (size_t k = 0; k < GN_QUANTITY_GROUPS; k++) {
        const gn_quantity_group *group = &gn_quantity_groups[k];
        if (group->kind && is_of_an_owner(column, group)) return true;
        for (size_t q = 0; !group->kind && q < group->quantity_count; q++)
            add_columns(all, &group->quantities[q]);
    }
    for (size_t k = 0; k < all->count; k++)
        if (strcmp(name, all->name[k]) == 0) return true;
    return false;
}

bool gn_reading_known(const char *name, char *advice, size_t size) {
    columns all = {0};
    gn_names names = gn_names_for(name);
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) {
        if (strcmp(name, fixed[k]) == 0) return true;
        gn_names_add(&names, fixed[k]);
    }
    if (is_column(name, &all)) return true;
    for (size_t k = 0; k < all.count; k++) gn_names_add(&names, all.name[k]);
    gn_names_advice(&names, advice, size);
    return false;
}
