/* Keys of a sweep file, in tables like those of scenes (src/scene/manifest.c). */
#include "scene/manifest_keys.h"
#include "sweep/range.h"
#include "sweep/sweep.h"

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
        .text = "combination of lists and ranges: every value with every other, or the first with "
                "the first and so on"),
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
