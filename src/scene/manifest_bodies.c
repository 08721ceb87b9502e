/* Keys of `bodies`. */
#include "scene/manifest_keys.h"

static const gn_choice booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                     {"yes", 1},  {"no", 0},    {NULL, 0}};

static const gn_key box_keys[] = {
    KEY("size", VECTOR, gn_body_def, box_size, .unit = "m", .range = GN_LENGTHS, .required = true,
        .shape_dimension = 3, .text = "lengths along x, y and z"),
};
TABLE_OF(box);

static const gn_key cylinder_keys[] = {
    KEY("diameter", REAL, gn_body_cylinder, diameter, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "diameter at the lower end, through the corners"),
    KEY("upper_diameter", REAL, gn_body_cylinder, upper_diameter, .unit = "m", .range = GN_LENGTHS,
        .word = "same", .fallback = "same",
        .text = "diameter at the upper end: a truncated cone, or a funnel when open"),
    KEY("height", REAL, gn_body_cylinder, height, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "length along z"),
    KEY("sides", INTEGER, gn_body_cylinder, sides, .range = "[3, 10000]", .fallback = "32",
        .text = "sides of the polygon that represents the circle"),
    KEY("open", CHOICE, gn_body_cylinder, open, .choices = booleans, .fallback = "false",
        .text = "without end faces: a tube or a funnel"),
};
TABLE_OF(cylinder);

#define CHANNEL(NAME, FIELD, UNIT, RANGE, TEXT)                                                    \
    KEY(NAME, TABLE, gn_motion, FIELD, .unit = UNIT, .range = RANGE, .word = "free",               \
        .fallback = "free", .text = TEXT)

static const gn_key motion_keys[] = {
    CHANNEL("vx", velocity[0], "m/s", GN_SPEEDS, "velocity of the reference point along x"),
    CHANNEL("vy", velocity[1], "m/s", GN_SPEEDS, "velocity of the reference point along y"),
    CHANNEL("vz", velocity[2], "m/s", GN_SPEEDS, "velocity of the reference point along z"),
    CHANNEL("wx", spin[0], "rad/s", GN_SPINS, "spin about x"),
    CHANNEL("wy", spin[1], "rad/s", GN_SPINS, "spin about y"),
    CHANNEL("wz", spin[2], "rad/s", GN_SPINS, "spin about z"),
};
TABLE_OF(motion);

static const gn_key body_keys[] = {
    KEY("name", NAME, gn_body_def, name, .required = true,
        .text = "name by which the rest of the scene refers to it"),
    KEY("surface", FILE, gn_body_def, surface, .second = offsetof(gn_body_def, surface_path),
        PRESENT(TEXT, gn_body_def, surface), .shape_dimension = 3,
        .text = "3D shape: STL file; a free body needs a closed surface that does not intersect "
                "itself, unless mass, inertia and reference are given"),
    SECTION("box", box_section, PRESENT(BOOL, gn_body_def, has_box), .shape_dimension = 3,
            .text = "3D shape; its lower corner is its origin"),
    SECTION("cylinder", cylinder_section, .offset = offsetof(gn_body_def, cylinder),
            PRESENT(BOOL, gn_body_def, has_cylinder), .shape_dimension = 3,
            .text = "3D shape, axis along z; the centre of its lower end is its origin"),
    ARRAY("polygon", POINTS, gn_body_def, polygon, polygon_count, .unit = "m", .range = GN_PLACES,
          PRESENT(COUNT, gn_body_def, polygon_count), .shape_dimension = 2,
          .text = "2D shape: closed line through its corners"),
    ARRAY("polyline", POINTS, gn_body_def, polyline, polyline_count, .unit = "m",
          .range = GN_PLACES, .number = 2, PRESENT(COUNT, gn_body_def, polyline_count),
          .shape_dimension = 2, .text = "2D shape: open line through its points"),
    KEY("scale", REAL, gn_body_def, scale, .unit = "1", .range = GN_SCALES, .fallback = "1",
        PRESENT(BOOL, gn_body_def, scale_given),
        .text = "lengths of the shape times this give metres"),
    KEY("origin", VECTOR, gn_body_def, origin, .unit = "m", .range = GN_PLACES, .fallback = "0",
        .text = "position of the shape's origin"),
    KEY("rotation", SPIN, gn_body_def, rotation, .unit = "rad", .range = GN_TURNS,
        PRESENT(BOOL, gn_body_def, has_rotation),
        .text = "rotation vector (axis times angle) of the shape about its origin, applied before "
                "the shift; in 2D one number"),
    KEY("stiffness", REAL, gn_body_def, stiffness, .unit = "N/m", .range = GN_SPRINGS,
        .word = "none", .fallback = "none",
        .text = "penalty stiffness k_n; needed by every law but hertz, where it holds for contacts "
                "with walls and other bodies (without it a free body has contacts with particles "
                "only)"),
    KEY("material", TEXT, gn_body_def, material, .fallback = "",
        PRESENT(TEXT, gn_body_def, material),
        .text = "with hertz: name of the material; left out: rigid, with its own friction and the "
                "restitution of the particles"),
    KEY("kratio", REAL, gn_body_def, kratio, .unit = "1", .range = GN_RATIOS, .word = "none",
        .fallback = "none",
        .text = "k_n/k_t of the surface; needed with friction, with hertz only together with "
                "stiffness"),
    KEY("friction", REAL, gn_body_def, friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0", .text = "Coulomb friction coefficient"),
    KEY("rolling_friction", REAL, gn_body_def, rolling_friction, .unit = "1", .range = GN_FRICTIONS,
        .fallback = "0", .text = "mu_r, as for materials"),
    KEY("twisting_friction", REAL, gn_body_def, twisting_friction, .unit = "1",
        .range = GN_FRICTIONS, .fallback = "0",
        .text = "mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced "
                "radius; 0: no resistance"),
    KEY("reference", VECTOR, gn_body_def, reference, .unit = "m", .range = GN_PLACES,
        PRESENT(BOOL, gn_body_def, has_reference),
        .text = "centre of rotation and reference of moments; default: the origin, for free bodies "
                "the centre of mass; given with mass and inertia it is the centre of mass"),
    KEY("free", CHOICE, gn_body_def, free, .choices = booleans, .fallback = "false",
        .text = "components that motion leaves free follow the forces of particles and gravity"),
    KEY("density", REAL, gn_body_def, density, .unit = "kg/m3", .range = GN_DENSITIES,
        .word = "none", .fallback = "none",
        .text = "mass density; a free body needs it or its mass"),
    KEY("mass", REAL, gn_body_def, mass, .unit = "kg", .range = GN_MASSES, .word = "none",
        .fallback = "none", .text = "mass of a free body, instead of its density"),
    KEY("inertia", SPIN, gn_body_def, inertia, .unit = "kg m2", .range = GN_INERTIAS,
        PRESENT(BOOL, gn_body_def, has_inertia),
        .text = "moments of inertia of a free body about its centre of mass along x, y, z, which "
                "are its principal axes at the start; in 2D one number; default: those of the "
                "shape with uniform density"),
    KEY("initial_velocity", VECTOR, gn_body_def, initial_velocity, .unit = "m/s",
        .range = GN_SPEEDS, PRESENT(BOOL, gn_body_def, has_initial_velocity),
        .text = "velocity of a free body at the start"),
    KEY("initial_spin", SPIN, gn_body_def, initial_spin, .unit = "rad/s", .range = GN_SPINS,
        PRESENT(BOOL, gn_body_def, has_initial_spin),
        .text = "spin of a free body at the start; in 2D one number"),
    SECTION("motion", motion_section, .offset = offsetof(gn_body_def, motion),
            .text =
                "prescribed motion of the body; components left out are zero, in a free body free"),
};
const gn_section gn_body_section = {body_keys, sizeof body_keys / sizeof(gn_key),
                                    sizeof(gn_body_def), offsetof(gn_body_def, where)};
