/* Keys of `sources` and `sinks`. */
#include "scene/manifest_keys.h"

static const gn_choice booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                     {"yes", 1},  {"no", 0},    {NULL, 0}};
static const gn_choice source_sizes[] = {{"uniform", GN_SIZES_UNIFORM},
                                         {"normal", GN_SIZES_NORMAL},
                                         {"sieve", GN_SIZES_SIEVE},
                                         {NULL, 0}};

/* ---- regions ---- */

static const gn_key rectangle_keys[] = {
    KEY("width", REAL, gn_flow_region, size[0], .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "length along x"),
    KEY("height", REAL, gn_flow_region, size[1], .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "length along y"),
};
TABLE_OF(rectangle);

static const gn_key disc_keys[] = {
    KEY("diameter", REAL, gn_flow_region, diameter, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "diameter of the disc"),
};
TABLE_OF(disc);

static const gn_key box_keys[] = {
    KEY("size", VECTOR, gn_flow_region, size, .unit = "m", .range = GN_LENGTHS, .required = true,
        .shape_dimension = 3, .text = "lengths along x, y and z"),
};
TABLE_OF(box);

static const gn_key cylinder_keys[] = {
    KEY("diameter", REAL, gn_flow_region, diameter, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "diameter of the cylinder"),
    KEY("height", REAL, gn_flow_region, height, .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "length along z"),
};
TABLE_OF(cylinder);

/* The keys of a region in the struct of a source or sink. */
#define REGION(STRUCT)                                                                             \
    SECTION("rectangle", rectangle_section, .offset = offsetof(STRUCT, region),                    \
            PRESENT(BOOL, STRUCT, region.has_rectangle), .shape_dimension = 2,                     \
            .text = "2D region; its lower left corner is at the origin"),                          \
        SECTION("disc", disc_section, .offset = offsetof(STRUCT, region),                          \
                PRESENT(BOOL, STRUCT, region.has_disc), .shape_dimension = 2,                      \
                .text = "2D region; its centre is at the origin"),                                 \
        ARRAY("polygon", POINTS, STRUCT, region.corners, region.corner_count, .unit = "m",         \
              .range = GN_PLACES, PRESENT(COUNT, STRUCT, region.corner_count),                     \
              .shape_dimension = 2, .text = "2D region: its corners in either sense of rotation"), \
        SECTION("box", box_section, .offset = offsetof(STRUCT, region),                            \
                PRESENT(BOOL, STRUCT, region.has_box), .shape_dimension = 3,                       \
                .text = "3D region; its lower corner is at the origin"),                           \
        SECTION("cylinder", cylinder_section, .offset = offsetof(STRUCT, region),                  \
                PRESENT(BOOL, STRUCT, region.has_cylinder), .shape_dimension = 3,                  \
                .text = "3D region, axis along z; the centre of its lower end is at the origin"),  \
        KEY("origin", VECTOR, STRUCT, region.origin, .unit = "m", .range = GN_PLACES,              \
            .fallback = "0",                                                                       \
            .text = "position of the origin of a rectangle, disc, box or cylinder")

/* ---- sources ---- */

static const gn_key source_keys[] = {
    KEY("name", NAME, gn_source_def, name, .required = true,
        .text = "name in the columns of the history"),
    REGION(gn_source_def),
    KEY("rate", REAL, gn_source_def, rate, .unit = GN_EVENT_RATE, .range = "[1e-12, 1e12]",
        .word = "none", .fallback = "none", .text = "particles per second; rate or mass_rate"),
    KEY("mass_rate", REAL, gn_source_def, mass_rate, .unit = "kg/s", .range = "[1e-18, 1e18]",
        .word = "none", .fallback = "none",
        .text = "mass of particles per second; rate or mass_rate"),
    KEY("start", REAL, gn_source_def, start, .unit = "s", .range = "[0, 1e18]", .fallback = "0",
        .text = "time of the first particle"),
    KEY("end", REAL, gn_source_def, end, .unit = "s", .range = "(0, 1e18]", .word = "none",
        .fallback = "none", .text = "time after which no more particles are created"),
    KEY("total", INTEGER, gn_source_def, total, .range = "[1, 1e9]", .word = "none",
        .fallback = "none", .text = "total number of particles"),
    KEY("mean_radius", REAL, gn_source_def, mean_radius, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "mean of the radii by number"),
    KEY("sizes", CHOICE, gn_source_def, sizes, .choices = source_sizes, .fallback = "uniform",
        .text = "distribution of the radii between the smallest and the largest: by number, or "
                "sieve: by the curve"),
    KEY("size_ratio", REAL, gn_source_def, size_ratio, .unit = "1", .range = "[1, 100]",
        .fallback = "1", PRESENT(NONE, gn_source_def, sieve_count),
        .text = "largest over smallest radius, with sizes uniform or normal; a sieve curve implies "
                "its own"),
    KEY("size_variation", REAL, gn_source_def, size_variation, .unit = "1", .range = "[0, 1]",
        .word = "auto", .word_value = -1, .fallback = "auto",
        .text = "standard deviation of the radii over their mean, with sizes normal; auto: a sixth "
                "of the range"),
    ARRAY("sieve", POINTS, gn_source_def, sieve, sieve_count, .unit = "1", .range = "[0, 1]",
          .number = 2, PRESENT(COUNT, gn_source_def, sieve_count),
          .text = "with sizes sieve: rows [size over the largest, mass fraction that passes], from "
                  "[smallest, 0] to [1, 1]"),
    KEY("material", TEXT, gn_source_def, material, .fallback = "",
        PRESENT(TEXT, gn_source_def, material),
        .text = "name of the material; may be left out when there is only one"),
    KEY("velocity", VECTOR, gn_source_def, velocity, .unit = "m/s", .range = GN_SPEEDS,
        .fallback = "0", .text = "velocity of new particles"),
    KEY("random_velocity", REAL, gn_source_def, random_velocity, .unit = "m/s", .range = "[0, 3e8]",
        .fallback = "0",
        .text = "random velocity of new particles, added along each axis, uniform in plus or minus "
                "this"),
};
const gn_section gn_source_section = {source_keys, sizeof source_keys / sizeof(gn_key),
                                      sizeof(gn_source_def), offsetof(gn_source_def, where)};

/* ---- sinks ---- */

static const gn_key plane_keys[] = {
    KEY("point", VECTOR, gn_sink_def, point, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "a point of the plane"),
    KEY("normal", VECTOR, gn_sink_def, normal, .unit = "1", .required = true,
        .text = "direction out of the model; of any length"),
};
TABLE_OF(plane);

static const gn_key sink_keys[] = {
    KEY("name", NAME, gn_sink_def, name, .required = true,
        .text = "name in the columns of the history"),
    SECTION("plane", plane_section, PRESENT(BOOL, gn_sink_def, has_plane),
            .text = "particles wholly beyond the plane are removed; plane or a region"),
    REGION(gn_sink_def),
    KEY("remove", CHOICE, gn_sink_def, remove, .choices = booleans, .fallback = "true",
        .text = "false: a plane only counts the centres that cross it, less those that return"),
};
const gn_section gn_sink_section = {sink_keys, sizeof sink_keys / sizeof(gn_key),
                                    sizeof(gn_sink_def), offsetof(gn_sink_def, where)};
