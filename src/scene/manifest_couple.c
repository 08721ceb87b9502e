/* The keys of zones that particles and elements share. */
#include "scene/manifest_keys.h"

static const gn_choice constraints[] = {{"lumped", GN_COUPLE_LUMPED},
                                        {"consistent", GN_COUPLE_CONSISTENT},
                                        {"penalty", GN_COUPLE_PENALTY},
                                        {NULL, 0}};
static const gn_choice spins[] = {
    {"free", GN_COUPLE_FREE}, {"slaved", GN_COUPLE_SLAVED}, {NULL, 0}};

static const gn_key edge_keys[] = {
    KEY("from", VECTOR, gn_couple_edge, from, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "point of the plane (2D: line) where the elements end, among the particles"),
    KEY("to", VECTOR, gn_couple_edge, to, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "the point straight across, on the plane where the particles end: through their "
                "outermost centres"),
};
ELEMENTS_OF(edge, gn_couple_edge);

static const gn_key zone_keys[] = {
    ARRAY("edges", LIST, gn_couple_zone, edges, edge_count, .section = &edge_section,
          .range = "[1, 100]", .required = true,
          .text = "one, or several sides of particles that elements surround; particles that "
                  "surround elements take a zone for each side"),
};
ELEMENTS_OF(zone, gn_couple_zone);

static const gn_key couple_keys[] = {
    ARRAY("zones", LIST, gn_scene, couple.zones, couple.zone_count, .section = &zone_section,
          .range = "[1, 1000]", .required = true,
          .text = "where particles and elements are at the same places"),
    KEY("constraint", CHOICE, gn_scene, couple.constraint, .choices = constraints,
        .fallback = "lumped",
        .text = "particles of a zone follow the nodes, with the mass that this gives to nodes "
                "lumped or consistent; or springs between both"),
    KEY("spins", CHOICE, gn_scene, couple.spins, .choices = spins, .fallback = "free",
        .text = "of particles of a zone: free, or half the curl of the nodes' velocity"),
    KEY("penalty", REAL, gn_scene, couple.penalty, .unit = "1", .range = "[1e-3, 1e3]",
        .fallback = "1",
        .text = "stiffness of the springs over that of the stiffest particles beside their masses"),
    KEY("penalty_damping", REAL, gn_scene, couple.penalty_damping, .unit = "1", .range = "[0, 1]",
        .fallback = "0", .text = "dashpots beside the springs, over critical damping"),
};
const gn_section gn_couple_section = {couple_keys, sizeof couple_keys / sizeof(gn_key), 0,
                                      offsetof(gn_scene, couple.where)};
