/* Keys of `bodies`, `contacts` and `couple`, and of distributions of bond properties. */
#include "scene/manifest_keys.h"

static const gn_key box_keys[] = {
    VECTOR("size", gn_body_def, box_size, "m", GN_LENGTHS, REQUIRED, "lengths along x, y and z",
           .shape_dimension = 3),
};
TABLE_OF(box);

static const gn_key cylinder_keys[] = {
    REAL("diameter", gn_body_cylinder, diameter, "m", GN_LENGTHS, REQUIRED,
         "diameter at the lower end, through the corners"),
    REAL("upper_diameter", gn_body_cylinder, upper_diameter, "m", GN_LENGTHS, OR("same", 0),
         "diameter at the upper end: a truncated cone, or a funnel when open"),
    REAL("height", gn_body_cylinder, height, "m", GN_LENGTHS, REQUIRED, "length along z"),
    INTEGER("sides", gn_body_cylinder, sides, "[3, 10000]", BY("32"),
            "sides of the polygon that represents the circle"),
    CHOICE("open", gn_body_cylinder, open, gn_booleans, BY("false"),
           "without end faces: a tube or a funnel"),
};
TABLE_OF(cylinder);

#define GN_WIDE_ANGLE    "(0, 3.14159265358979324]" /* rad, angle between the two faces of a tool */
#define TOOL_FACET(TEXT) REAL("facet", gn_tool_def, facet, "m", GN_LENGTHS, OR("auto", 0), TEXT)
#define TOOL_ROUNDING                                                                              \
    REAL("tip_radius", gn_tool_def, tip_radius, "m", "[0, 1e9]", BY("0"),                          \
         "radius of the rounding of the edges of the tip; 0: sharp")

static const gn_key disc_cutter_keys[] = {
    REAL("diameter", gn_tool_def, diameter, "m", GN_LENGTHS, REQUIRED, "diameter of the tip"),
    REAL("tip_width", gn_tool_def, tip_width, "m", GN_LENGTHS, REQUIRED,
         "width of the tip along y, between its edges before rounding"),
    TOOL_ROUNDING,
    REAL("bevel_angle", gn_tool_def, bevel_angle, "rad", GN_WIDE_ANGLE, BY("180 deg"),
         "angle between the two faces of the tip, which meet in a ridge; 180 deg: a flat tip"),
    REAL("flank_angle", gn_tool_def, flank_angle, "rad", "[0, 1.5]", BY("0"),
         "angle of the flanks with the plane of the ring"),
    REAL("bore", gn_tool_def, bore, "m", GN_LENGTHS, OR("auto", 0),
         "inner diameter of the ring; auto: half of the outer one"),
    TOOL_FACET("size of the facets at the tip, which grow along the flanks; auto: a sixth of the "
               "tip width"),
};
TABLE_OF(disc_cutter);

static const gn_key chisel_keys[] = {
    REAL("width", gn_tool_def, width, "m", GN_LENGTHS, OR("none", 0),
         "width along y; needed in 3D, in 2D 1 m"),
    REAL("rake_angle", gn_tool_def, rake, "rad", "(-1.5, 1.5)", REQUIRED,
         "angle by which the front face leans back from the normal of the rock; negative: forward"),
    REAL("clearance_angle", gn_tool_def, clearance, "rad", "[0, 1.5)", REQUIRED,
         "angle between the lower face and the cut"),
    REAL("height", gn_tool_def, height, "m", GN_LENGTHS, REQUIRED, "height above the edge"),
    REAL("length", gn_tool_def, length, "m", GN_LENGTHS, REQUIRED,
         "length of the lower face along x"),
    TOOL_ROUNDING,
};
TABLE_OF(chisel);

static const gn_key wedge_keys[] = {
    REAL("width", gn_tool_def, width, "m", GN_LENGTHS, OR("none", 0),
         "width along y; needed in 3D, in 2D 1 m"),
    REAL("angle", gn_tool_def, angle, "rad", GN_WIDE_ANGLE, REQUIRED,
         "angle between the two faces"),
    REAL("height", gn_tool_def, height, "m", GN_LENGTHS, REQUIRED, "height above the edge"),
    TOOL_ROUNDING,
};
TABLE_OF(wedge);

static const gn_key pick_keys[] = {
    REAL("angle", gn_tool_def, angle, "rad", GN_WIDE_ANGLE, REQUIRED,
         "angle of the tip, twice that of the cone with its axis"),
    REAL("diameter", gn_tool_def, diameter, "m", GN_LENGTHS, REQUIRED,
         "diameter of the cylinder behind the cone"),
    REAL("height", gn_tool_def, height, "m", GN_LENGTHS, REQUIRED, "height above the tip"),
    TOOL_ROUNDING,
    TOOL_FACET("size of the facets at the tip; auto: a twelfth of the diameter"),
};
TABLE_OF(pick);

#define TOOL(KIND, DIMENSION, TEXT)                                                                \
    SECTION(#KIND, KIND##_section, .offset = offsetof(gn_body_def, tool),                          \
            PRESENT(BOOL, gn_body_def, has_##KIND), .shape_dimension = (DIMENSION), .text = TEXT)

static const gn_key motion_keys[] = {
    CHANNEL(gn_motion, "vx", velocity[0], "m/s", GN_SPEEDS, "free",
            "velocity of the reference point along x"),
    CHANNEL(gn_motion, "vy", velocity[1], "m/s", GN_SPEEDS, "free",
            "velocity of the reference point along y"),
    CHANNEL(gn_motion, "vz", velocity[2], "m/s", GN_SPEEDS, "free",
            "velocity of the reference point along z"),
    CHANNEL(gn_motion, "wx", spin[0], "rad/s", GN_SPINS, "free", "spin about x"),
    CHANNEL(gn_motion, "wy", spin[1], "rad/s", GN_SPINS, "free", "spin about y"),
    CHANNEL(gn_motion, "wz", spin[2], "rad/s", GN_SPINS, "free", "spin about z"),
};
TABLE_OF(motion);

static const gn_key body_keys[] = {
    NAME("name", gn_body_def, name, REQUIRED, "name by which the rest of the scene refers to it"),
    KEY("surface", FILE, gn_body_def, surface, .second = offsetof(gn_body_def, surface_path),
        PRESENT(TEXT, gn_body_def, surface), .shape_dimension = 3,
        .text = "3D shape: STL, PLY or OBJ file; a free body needs a closed surface that does not "
                "intersect "
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
    TOOL(disc_cutter, 3,
         "3D shape: ring of constant cross section, axis along y; its centre is its origin"),
    TOOL(chisel, 0,
         "shape: tool that cuts towards x, rock below it (in 3D below z, in 2D below y); the "
         "middle of its edge is its origin"),
    TOOL(wedge, 0,
         "shape: symmetric tool with its edge along y, rock below it; the middle of its edge is "
         "its origin"),
    TOOL(pick, 3,
         "3D shape: cone with its axis along z, rock below it; its lowest point is its origin"),
    REAL("scale", gn_body_def, scale, "1", GN_SCALES, BY("1"),
         "lengths of the shape times this give metres", PRESENT(BOOL, gn_body_def, scale_given)),
    VECTOR("origin", gn_body_def, origin, "m", GN_PLACES, BY("0"),
           "position of the shape's origin"),
    SPIN("rotation", gn_body_def, rotation, "rad", GN_TURNS,
         PRESENT(BOOL, gn_body_def, has_rotation),
         "rotation vector (axis times angle) of the shape about its origin, applied before the "
         "shift; in 2D one number"),
    REAL("stiffness", gn_body_def, stiffness, "N/m", GN_SPRINGS, OR("none", 0),
         "penalty stiffness k_n; needed by every law but hertz, where it holds for contacts with "
         "walls and other bodies (without it a free body has contacts with particles only)"),
    TEXT("material", gn_body_def, material, BY(""),
         "with hertz: name of the material; left out: rigid, with its own friction and the "
         "restitution of the particles",
         PRESENT(TEXT, gn_body_def, material)),
    REAL("kratio", gn_body_def, kratio, "1", GN_RATIOS, OR("none", 0),
         "k_n/k_t of the surface; needed with friction, with hertz only together with stiffness"),
    SIDE_FRICTIONS(gn_body_def),
    VECTOR("reference", gn_body_def, reference, "m", GN_PLACES,
           PRESENT(BOOL, gn_body_def, has_reference),
           "centre of rotation and reference of moments; default: the origin, for free bodies the "
           "centre of mass; given with mass and inertia it is the centre of mass"),
    CHOICE("free", gn_body_def, free, gn_booleans, BY("false"),
           "components that motion leaves free follow the forces of particles and gravity"),
    REAL("density", gn_body_def, density, "kg/m3", GN_DENSITIES, OR("none", 0),
         "mass density; a free body needs it or its mass"),
    REAL("mass", gn_body_def, mass, "kg", GN_MASSES, OR("none", 0),
         "mass of a free body, instead of its density"),
    SPIN("inertia", gn_body_def, inertia, "kg m2", GN_INERTIAS,
         PRESENT(BOOL, gn_body_def, has_inertia),
         "moments of inertia of a free body about its centre of mass along x, y, z, which are its "
         "principal axes at the start; in 2D one number; default: those of the shape with uniform "
         "density"),
    VECTOR("initial_velocity", gn_body_def, initial_velocity, "m/s", GN_SPEEDS,
           PRESENT(BOOL, gn_body_def, has_initial_velocity),
           "velocity of a free body at the start"),
    SPIN("initial_spin", gn_body_def, initial_spin, "rad/s", GN_SPINS,
         PRESENT(BOOL, gn_body_def, has_initial_spin),
         "spin of a free body at the start; in 2D one number"),
    VARYING("force", gn_body_def, force, "N", GN_FORCES, PRESENT(BOOL, gn_body_def, has_force),
            "force on the centre of mass of a free body, along directions without prescribed "
            "motion"),
    SECTION("motion", motion_section, .offset = offsetof(gn_body_def, motion),
            .text =
                "prescribed motion of the body; components left out are zero, in a free body free"),
};
const gn_section gn_body_section = {KEYS_OF(body), sizeof(gn_body_def),
                                    offsetof(gn_body_def, where)};

/* ---- keys of `contacts` and of distributions of bond properties ---- */

static const gn_choice distributions[] = {
    {"weibull", GN_SCATTER_WEIBULL}, {"normal", GN_SCATTER_NORMAL}, {NULL, 0}};

static const gn_key scatter_keys[] = {
    CHOICE("distribution", gn_scatter, kind, distributions, REQUIRED,
           "distribution of the factor of a bond"),
    REAL("modulus", gn_scatter, modulus, GN_PLAIN_NUMBER, "[0.5, 1e4]", OR("none", 0),
         "Weibull modulus; needed by weibull"),
    REAL("deviation", gn_scatter, deviation, "1", "[1e-6, 0.33]", OR("none", 0),
         "standard deviation over the mean; needed by normal, which is truncated at 0 and 2"),
};
const gn_section gn_scatter_section = {KEYS_OF(scatter), 0, GN_NO_WHERE};

#define VALUE(NAME, FIELD, UNIT, RANGE, TEXT)                                                      \
    KEY(NAME, REAL, gn_contact_def, FIELD, .unit = UNIT, .range = RANGE, .word = "combined",       \
        .word_value = GN_COMBINED, .fallback = "combined", .text = TEXT)

static const gn_key contact_keys[] = {
    ARRAY("between", NAMES, gn_contact_def, between, between_count, .required = true,
          .text = "the two materials, in either order; one name: that material with itself"),
    VALUE("friction", friction, GN_SLOPE, GN_FRICTIONS,
          "friction coefficient, instead of the smaller"),
    VALUE("kratio", kratio, "1", "[0, 1e12]", "k_n/k_t; 0: no tangential spring"),
    VALUE("contact_modulus", contact_modulus, "Pa", GN_MODULI, "E_c, instead of both in series"),
    VALUE("normal_stiffness", normal_stiffness, "N/m", GN_SPRINGS,
          "k_n, instead of both in series"),
    VALUE("young", young, "Pa", GN_MODULI,
          "E of laws by area and hertz, instead of both in series"),
    VALUE("poisson", poisson, "1", "(-1, 0.5]",
          "nu of laws by area and hertz, instead of the values of both materials"),
    VALUE("alpha", alpha, "1", "[1e-6, 1e6]",
          "factor in laws by area, instead of the harmonic mean"),
    VALUE("beta", beta, "1", "[0, 1e6]", "factor in laws by area, instead of the harmonic mean"),
    VALUE("tensile_strength", tensile_strength, "Pa", GN_STRENGTHS,
          "sigma_c of a bond, instead of the smaller"),
    VALUE("shear_strength", shear_strength, "Pa", GN_STRENGTHS,
          "tau_c of a bond, instead of the smaller"),
    VALUE("bond_tension_limit", bond_tension_limit, "N", GN_BREAKING,
          "R_n of the uniform law, instead of the smaller"),
    VALUE("bond_shear_limit", bond_shear_limit, "N", GN_BREAKING,
          "R_t of the uniform law, instead of the smaller"),
    VALUE("bond_friction", bond_friction, GN_SLOPE, GN_FRICTIONS,
          "mu_1 of a bond, instead of the smaller"),
    VALUE("adhesion", adhesion, "J/m2", "[0, 1e6]", "w, instead of the geometric mean"),
    VALUE("rolling_friction", rolling_friction, "1", GN_FRICTIONS, "mu_r, instead of the smaller"),
    VALUE("twisting_friction", twisting_friction, "1", GN_FRICTIONS,
          "mu_t, instead of the smaller"),
    VALUE("restitution", restitution, "1", "[0, 1]",
          "restitution coefficient with hertz, instead of the smaller"),
    VALUE("fracture_energy", fracture_energy, "J/m2", GN_TOUGHNESSES,
          "G_f of a bond in tension, with softening energy, instead of the smaller"),
    VALUE("shear_fracture_energy", shear_fracture_energy, "J/m2", GN_TOUGHNESSES,
          "G_f of a bond in shear, with softening energy, instead of the smaller"),
};
const gn_section gn_contact_section = {KEYS_OF(contact), sizeof(gn_contact_def),
                                       offsetof(gn_contact_def, where)};

/* ---- keys of coupling zones and of conversion ---- */

static const gn_choice constraints[] = {{"lumped", GN_COUPLE_LUMPED},
                                        {"consistent", GN_COUPLE_CONSISTENT},
                                        {"penalty", GN_COUPLE_PENALTY},
                                        {NULL, 0}};
static const gn_choice spins[] = {
    {"free", GN_COUPLE_FREE}, {"slaved", GN_COUPLE_SLAVED}, {NULL, 0}};

static const gn_key edge_keys[] = {
    VECTOR("from", gn_couple_edge, from, "m", GN_PLACES, REQUIRED,
           "point of the plane (2D: line) where the elements end, among the particles"),
    VECTOR(
        "to", gn_couple_edge, to, "m", GN_PLACES, REQUIRED,
        "the opposite point on the plane where the particles end, through their outermost centres"),
};
ELEMENTS_OF(edge, gn_couple_edge);

static const gn_key zone_keys[] = {
    ARRAY("edges", LIST, gn_couple_zone, edges, edge_count, .section = &edge_section,
          .range = "[1, 100]", .required = true,
          .text = "one edge, or one for each side of particles that elements surround; particles "
                  "that surround elements need a zone for each side"),
};
ELEMENTS_OF(zone, gn_couple_zone);

static const gn_choice by[] = {
    {"elements", GN_CONVERT_ELEMENTS}, {"nodes", GN_CONVERT_NODES}, {NULL, 0}};

static const gn_key convert_box_keys[] = {
    VECTOR("min", gn_scene, couple.convert.box_min, "m", NULL, REQUIRED, "lower corner"),
    VECTOR("max", gn_scene, couple.convert.box_max, "m", NULL, REQUIRED, "upper corner"),
};
TABLE_OF(convert_box);

static const gn_key mohr_keys[] = {
    REAL("cohesion", gn_scene, couple.convert.cohesion, "Pa", GN_STRENGTHS, REQUIRED,
         "shear strength of a plane without pressure"),
    REAL("friction", gn_scene, couple.convert.friction, GN_SLOPE, "[0, 100]", BY("0"),
         "tan(phi), or the angle phi: increase of the shear strength over the pressure"),
};
TABLE_OF(mohr);

static const gn_key convert_keys[] = {
    SECTION("box", convert_box_section, PRESENT(BOOL, gn_scene, couple.convert.has_box),
            .text = "elements whose nodes all start in this box, boundary included, can convert; "
                    "default: specimen.packing.region"),
    REAL("width", gn_scene, couple.convert.width, "m", GN_LENGTHS, REQUIRED,
         "width of the zone between particles and elements: at least three elements and six "
         "particles"),
    REAL("stress", gn_scene, couple.convert.stress, "Pa", GN_STRENGTHS, OR("none", 0),
         "largest principal stress, tension positive, at which an element converts"),
    SECTION("mohr_coulomb", mohr_section, PRESENT(BOOL, gn_scene, couple.convert.has_mohr),
            .text = "converts elements under compression: limit of (s1 - s3)/2 + (s1 + s3)/2 "
                    "sin(phi) over cohesion cos(phi)"),
    REAL("bodies", gn_scene, couple.convert.near_bodies, "m", GN_LENGTHS, OR("none", 0),
         "distance from a body at which elements convert, so that it touches particles alone; "
         "needed beside bodies: they have no contact with elements"),
    CHOICE(
        "by", gn_scene, couple.convert.by, by, BY("elements"),
        "stresses that are compared with the limits: of each element, or averaged from its nodes"),
    INTEGER("every", gn_scene, couple.convert.every, "[1, 1000000]", BY("50"),
            "steps between two evaluations of the limits"),
    REAL("most", gn_scene, couple.convert.most, "1", "(0, 1]", BY("10 %"),
         "largest fraction of the convertible elements that one evaluation converts, those with "
         "the highest stresses first; thin remnants are added to it"),
    REAL("relax", gn_scene, couple.convert.relax, "1", "[1e-8, 1]", BY("1e-3"),
         "relaxation tolerance of newly released particles: they are equilibrated, with all others "
         "fixed, to a residual of this fraction of the mean contact force",
         .word = "none"),
    INTEGER("relax_iterations", gn_scene, couple.convert.relax_iterations, "[1, 1000000]",
            BY("1000"), "largest number of iterations of relax"),
};
static const gn_section convert_section = {KEYS_OF(convert), 0,
                                           offsetof(gn_scene, couple.convert.where)};

static const gn_key couple_keys[] = {
    ARRAY("zones", LIST, gn_scene, couple.zones, couple.zone_count, .section = &zone_section,
          .range = "[0, 1000]",
          .text = "zones in which particles and elements overlap; at least one without convert"),
    SECTION(
        "convert", convert_section, PRESENT(BOOL, gn_scene, couple.has_convert),
        .text =
            "starts with elements everywhere, which turn into particles where stresses are high"),
    CHOICE("constraint", gn_scene, couple.constraint, constraints, BY("lumped"),
           "particles of a zone follow the nodes, which take their mass lumped or consistently; or "
           "springs connect both"),
    CHOICE("spins", gn_scene, couple.spins, spins, BY("free"),
           "spins of particles of a zone: free, or half the curl of the nodes' velocity"),
    REAL("penalty", gn_scene, couple.penalty, "1", "[1e-3, 1e3]", BY("1"),
         "stiffness of the springs over its automatic value, from the stiffest particles and their "
         "masses"),
    REAL("penalty_damping", gn_scene, couple.penalty_damping, "1", "[0, 1]", BY("0"),
         "dashpots in parallel with the springs, as a fraction of critical damping"),
};
const gn_section gn_couple_section = {KEYS_OF(couple), 0, offsetof(gn_scene, couple.where)};
