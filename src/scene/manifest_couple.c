/* Keys of coupling zones and of conversion. */
#include "scene/manifest_keys.h"

static const gn_choice constraints[] = {
    {"lumped", GN_COUPLE_LUMPED}, {"consistent", GN_COUPLE_CONSISTENT}, {NULL, 0}};

static const gn_key edge_keys[] = {
    KEY("from", VECTOR, gn_couple_edge, from, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "point of the plane (2D: line) where the elements end, among the particles"),
    KEY("to", VECTOR, gn_couple_edge, to, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "the opposite point on the plane where the particles end, through their outermost "
                "centres"),
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
    KEY("min", VECTOR, gn_scene, couple.convert.box_min, .unit = "m", .required = true,
        .text = "lower corner"),
    KEY("max", VECTOR, gn_scene, couple.convert.box_max, .unit = "m", .required = true,
        .text = "upper corner"),
};
TABLE_OF(convert_box);

static const gn_key mohr_keys[] = {
    KEY("cohesion", REAL, gn_scene, couple.convert.cohesion, .unit = "Pa", .range = GN_STRENGTHS,
        .required = true, .text = "shear strength of a plane without pressure"),
    KEY("friction", REAL, gn_scene, couple.convert.friction, .unit = GN_SLOPE, .range = "[0, 100]",
        .fallback = "0",
        .text = "tan(phi), or the angle phi: increase of the shear strength over the pressure"),
};
TABLE_OF(mohr);

static const gn_key convert_keys[] = {
    SECTION("box", convert_box_section, PRESENT(BOOL, gn_scene, couple.convert.has_box),
            .text = "elements whose nodes all start in this box, boundary included, can convert; "
                    "default: specimen.packing.region"),
    KEY("width", REAL, gn_scene, couple.convert.width, .unit = "m", .range = GN_LENGTHS,
        .required = true,
        .text = "width of the zone between particles and elements: at least three elements and six "
                "particles"),
    KEY("stress", REAL, gn_scene, couple.convert.stress, .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "largest principal stress, tension positive, at which an element converts"),
    SECTION("mohr_coulomb", mohr_section, PRESENT(BOOL, gn_scene, couple.convert.has_mohr),
            .text = "converts elements under compression: limit of (s1 - s3)/2 + (s1 + s3)/2 "
                    "sin(phi) over cohesion cos(phi)"),
    KEY("by", CHOICE, gn_scene, couple.convert.by, .choices = by, .fallback = "elements",
        .text = "stresses that are compared with the limits: of each element, or averaged from its "
                "nodes"),
    KEY("every", INTEGER, gn_scene, couple.convert.every, .range = "[1, 1000000]", .fallback = "50",
        .text = "steps between two evaluations of the limits"),
    KEY("most", REAL, gn_scene, couple.convert.most, .unit = "1", .range = "(0, 1]",
        .fallback = "10 %",
        .text = "largest fraction of the convertible elements that one evaluation converts, those "
                "with the highest stresses first; thin remnants are added to it"),
    KEY("relax", REAL, gn_scene, couple.convert.relax, .unit = "1", .range = "[1e-8, 1]",
        .word = "none", .fallback = "1e-3",
        .text = "relaxation tolerance of newly released particles: they are equilibrated, with all "
                "others fixed, to a residual of this fraction of the mean contact force"),
    KEY("relax_iterations", INTEGER, gn_scene, couple.convert.relax_iterations,
        .range = "[1, 1000000]", .fallback = "1000",
        .text = "largest number of iterations of relax"),
};
static const gn_section convert_section = {convert_keys, sizeof convert_keys / sizeof(gn_key), 0,
                                           offsetof(gn_scene, couple.convert.where)};

static const gn_key couple_keys[] = {
    ARRAY("zones", LIST, gn_scene, couple.zones, couple.zone_count, .section = &zone_section,
          .range = "[0, 1000]",
          .text = "zones in which particles and elements overlap; at least one without convert"),
    SECTION(
        "convert", convert_section, PRESENT(BOOL, gn_scene, couple.has_convert),
        .text =
            "starts with elements everywhere, which turn into particles where stresses are high"),
    KEY("constraint", CHOICE, gn_scene, couple.constraint, .choices = constraints,
        .fallback = "lumped",
        .text = "particles of a zone follow the nodes, which take their mass lumped or "
                "consistently"),
};
const gn_section gn_couple_section = {couple_keys, sizeof couple_keys / sizeof(gn_key), 0,
                                      offsetof(gn_scene, couple.where)};
