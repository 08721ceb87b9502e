/* Keys of `sources` and `sinks`. */
#include "scene/manifest_keys.h"

static const gn_choice source_sizes[] = {{"uniform", GN_SIZES_UNIFORM},
                                         {"normal", GN_SIZES_NORMAL},
                                         {"sieve", GN_SIZES_SIEVE},
                                         {NULL, 0}};

/* ---- regions ---- */

static const gn_key rectangle_keys[] = {
    REAL("width", gn_flow_region, size[0], "m", GN_LENGTHS, REQUIRED, "length along x"),
    REAL("height", gn_flow_region, size[1], "m", GN_LENGTHS, REQUIRED, "length along y"),
};
TABLE_OF(rectangle);

static const gn_key disc_keys[] = {
    REAL("diameter", gn_flow_region, diameter, "m", GN_LENGTHS, REQUIRED, "diameter of the disc"),
};
TABLE_OF(disc);

static const gn_key box_keys[] = {
    VECTOR("size", gn_flow_region, size, "m", GN_LENGTHS, REQUIRED, "lengths along x, y and z",
           .shape_dimension = 3),
};
TABLE_OF(box);

static const gn_key cylinder_keys[] = {
    REAL("diameter", gn_flow_region, diameter, "m", GN_LENGTHS, REQUIRED,
         "diameter of the cylinder"),
    REAL("height", gn_flow_region, height, "m", GN_LENGTHS, REQUIRED, "length along z"),
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
    NAME("name", gn_source_def, name, REQUIRED, "name in the columns of the history"),
    REGION(gn_source_def),
    REAL("rate", gn_source_def, rate, GN_EVENT_RATE, "[1e-12, 1e12]", OR("none", 0),
         "particles per second; rate or mass_rate"),
    REAL("mass_rate", gn_source_def, mass_rate, "kg/s", "[1e-18, 1e18]", OR("none", 0),
         "mass of particles per second; rate or mass_rate"),
    REAL("start", gn_source_def, start, "s", "[0, 1e18]", BY("0"), "time of the first particle"),
    REAL("end", gn_source_def, end, "s", "(0, 1e18]", OR("none", 0),
         "time after which no more particles are created"),
    INTEGER("total", gn_source_def, total, "[1, 1e9]", OR("none", 0), "total number of particles"),
    REAL("mean_radius", gn_source_def, mean_radius, "m", GN_LENGTHS, REQUIRED,
         "mean of the radii by number"),
    CHOICE("sizes", gn_source_def, sizes, source_sizes, BY("uniform"),
           "distribution of the radii between the smallest and the largest: by number, or sieve: "
           "by the curve"),
    REAL(
        "size_ratio", gn_source_def, size_ratio, "1", "[1, 100]", BY("1"),
        "largest over smallest radius, with sizes uniform or normal; a sieve curve implies its own",
        PRESENT(NONE, gn_source_def, sieve_count)),
    REAL("size_variation", gn_source_def, size_variation, "1", "[0, 1]", OR("auto", -1),
         "standard deviation of the radii over their mean, with sizes normal; auto: a sixth of the "
         "range"),
    ARRAY("sieve", POINTS, gn_source_def, sieve, sieve_count, .unit = "1", .range = "[0, 1]",
          .number = 2, PRESENT(COUNT, gn_source_def, sieve_count),
          .text = "with sizes sieve: rows [size over the largest, mass fraction that passes], from "
                  "[smallest, 0] to [1, 1]"),
    TEXT("material", gn_source_def, material, BY(""),
         "name of the material; may be left out when there is only one",
         PRESENT(TEXT, gn_source_def, material)),
    VECTOR("velocity", gn_source_def, velocity, "m/s", GN_SPEEDS, BY("0"),
           "velocity of new particles"),
    REAL("random_velocity", gn_source_def, random_velocity, "m/s", "[0, 3e8]", BY("0"),
         "random velocity of new particles, added along each axis, uniform in plus or minus this"),
};
const gn_section gn_source_section = {KEYS_OF(source), sizeof(gn_source_def),
                                      offsetof(gn_source_def, where)};

/* ---- sinks ---- */

static const gn_key plane_keys[] = {
    VECTOR("point", gn_sink_def, point, "m", GN_PLACES, REQUIRED, "a point of the plane"),
    VECTOR("normal", gn_sink_def, normal, "1", NULL, REQUIRED,
           "direction out of the model; of any length"),
};
TABLE_OF(plane);

static const gn_key sink_keys[] = {
    NAME("name", gn_sink_def, name, REQUIRED, "name in the columns of the history"),
    SECTION("plane", plane_section, PRESENT(BOOL, gn_sink_def, has_plane),
            .text = "particles wholly beyond the plane are removed; plane or a region"),
    REGION(gn_sink_def),
    CHOICE("remove", gn_sink_def, remove, gn_booleans, BY("true"),
           "false: a plane only counts the centres that cross it, less those that return"),
};
const gn_section gn_sink_section = {KEYS_OF(sink), sizeof(gn_sink_def),
                                    offsetof(gn_sink_def, where)};
