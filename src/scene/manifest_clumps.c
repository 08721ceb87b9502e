/* Keys of `clumps`. */
#include "scene/manifest_keys.h"

static const gn_key shape_keys[] = {
    NAME("name", gn_clump_shape_def, name, REQUIRED,
         "name by which placed, filled and file refer to it"),
    ARRAY("spheres", PARTICLES, gn_clump_shape_def, spheres, sphere_count,
          .number = offsetof(gn_clump_shape_def, fill), .range = "[1, 10000]", .unit = "m",
          PRESENT(ROWS, gn_clump_shape_def, sphere_count),
          .text = "rows [x, y, z, r] (2D: [x, y, r]) in the frame of the shape, which may overlap; "
                  "with surface: the number of spheres that fill it"),
    KEY("surface", FILE, gn_clump_shape_def, surface,
        .second = offsetof(gn_clump_shape_def, surface_path),
        PRESENT(TEXT, gn_clump_shape_def, surface), .shape_dimension = 3,
        .text = "closed surface (STL, PLY, OBJ) that is filled with spheres; mass, centre and "
                "inertia are those of the surface"),
    REAL("scale", gn_clump_shape_def, scale, "1", GN_SCALES, BY("1"),
         "lengths of the rows or of the surface times this give metres"),
    TEXT("material", gn_clump_shape_def, material, BY(""),
         "name of the material; may be left out when there is only one",
         PRESENT(TEXT, gn_clump_shape_def, material)),
};
ELEMENTS_OF(shape, gn_clump_shape_def);

static const gn_key placed_keys[] = {
    TEXT("shape", gn_placed_clump_def, shape, REQUIRED, "name of its shape"),
    VECTOR("centre", gn_placed_clump_def, centre, "m", GN_PLACES, REQUIRED,
           "position of its centre of mass"),
    SPIN("rotation", gn_placed_clump_def, rotation, "rad", GN_TURNS,
         PRESENT(BOOL, gn_placed_clump_def, has_rotation),
         "rotation vector (axis times angle) from the frame of the shape; in 2D one number"),
    VECTOR("velocity", gn_placed_clump_def, velocity, "m/s", GN_SPEEDS, BY("0"),
           "velocity of the centre at the start"),
    SPIN("spin", gn_placed_clump_def, spin, "rad/s", GN_SPINS,
         PRESENT(BOOL, gn_placed_clump_def, has_spin), "spin at the start; in 2D one number"),
};
ELEMENTS_OF(placed, gn_placed_clump_def);

static const gn_key box_keys[] = {
    VECTOR("min", gn_filled_clumps_def, box_min, "m", GN_PLACES, REQUIRED, "lower corner"),
    VECTOR("max", gn_filled_clumps_def, box_max, "m", GN_PLACES, REQUIRED, "upper corner"),
};
TABLE_OF(box);

static const gn_key filled_keys[] = {
    ARRAY("shapes", NAMES, gn_filled_clumps_def, shapes, shape_count, .required = true,
          .text = "names of one or several shapes, drawn with equal probability"),
    SECTION("box", box_section, .required = true, .text = "box that contains all spheres"),
    INTEGER("count", gn_filled_clumps_def, count, "[1, 1e7]", REQUIRED, "number of clumps"),
    VECTOR("velocity", gn_filled_clumps_def, velocity, "m/s", GN_SPEEDS, BY("0"),
           "velocity at the start"),
};
ELEMENTS_OF(filled, gn_filled_clumps_def);

static const gn_key clumps_keys[] = {
    ARRAY("shapes", LIST, gn_clumps_def, shapes, shape_count, .section = &shape_section,
          .range = "[1, 1000]", .required = true, .text = "shapes of clumps"),
    ARRAY("placed", LIST, gn_clumps_def, placed, placed_count, .section = &placed_section,
          .range = "[0, 1000000]", .text = "clumps one by one"),
    KEY("file", FILE, gn_clumps_def, file, .second = offsetof(gn_clumps_def, path),
        PRESENT(TEXT, gn_clumps_def, file),
        .text = "text file of rows: name of a shape, centre x y z in m, and as far as given the "
                "orientation as a unit quaternion w x y z, velocity x y z in m/s, spin x y z in "
                "rad/s"),
    ARRAY("filled", LIST, gn_clumps_def, filled, filled_count, .section = &filled_section,
          .range = "[0, 1000]",
          .text = "boxes filled at random by run.seed, with random orientations, so that clumps do "
                  "not overlap each other"),
};
const gn_section gn_clumps_section = {KEYS_OF(clumps), 0, offsetof(gn_clumps_def, where)};
