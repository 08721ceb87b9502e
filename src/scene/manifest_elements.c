/* Keys of finite elements. */
#include "scene/manifest_keys.h"

static const gn_choice formulations[] = {
    {"displacement", GN_FORMULATION_DISPLACEMENT}, {"mixed", GN_FORMULATION_PRESSURE}, {NULL, 0}};

static const gn_choice diagonals[] = {
    {"alternating", GN_DIAGONALS_ALTERNATING}, {"parallel", GN_DIAGONALS_PARALLEL}, {NULL, 0}};

/* ---- meshes ---- */

static const gn_key block_keys[] = {
    KEY("size", VECTOR, gn_scene, elements.size, .unit = "m", .required = true,
        .text = "lengths along the axes"),
    KEY("cells", CELLS, gn_scene, elements.cells, .range = "[1, 1e6]", .required = true,
        .text = "cells along the axes, of two triangles or five (parallel: six) tetrahedra each"),
    KEY("origin", VECTOR, gn_scene, elements.origin, .unit = "m", .range = GN_PLACES,
        .fallback = "0", .text = "lower corner"),
    KEY("distortion", REAL, gn_scene, elements.distortion, .unit = "1", .range = "[0, 0.25)",
        .fallback = "0",
        .text = "random shift of the nodes over the sides of a cell; in 3D below 1/6"),
    KEY("diagonals", CHOICE, gn_scene, elements.diagonals, .choices = diagonals,
        .fallback = "alternating",
        .text = "diagonals of the cells: alternating prefers no direction; parallel gives equal "
                "masses to all inner nodes of equal cells, for waves only some elements long and "
                "for coupling zones"),
};
TABLE_OF(block);

static const gn_key beam_keys[] = {
    KEY("length", REAL, gn_scene, elements.beam.length, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "length along x"),
    KEY("height", REAL, gn_scene, elements.beam.height, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "height, along y"),
    KEY("thickness", REAL, gn_scene, elements.beam.thickness, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none", .text = "thickness, along z; needed in 3D"),
    KEY("span", REAL, gn_scene, elements.beam.span, .unit = "m", .range = GN_LENGTHS,
        .word = "auto", .fallback = "auto", .text = "distance of the supports; auto: the length"),
    KEY("notch_depth", REAL, gn_scene, elements.beam.notch_depth, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none",
        .text = "depth of the notch in the lower side at mid-span"),
    KEY("notch_width", REAL, gn_scene, elements.beam.notch_width, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none", .text = "width of the notch; needed with notch_depth"),
    KEY("cell", REAL, gn_scene, elements.beam.cell, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "largest side of a cell"),
    KEY("notch_cells", INTEGER, gn_scene, elements.beam.notch_cells, .range = "[1, 1000]",
        .fallback = "1",
        .text = "cells over half the width of the notch; they set the size of the cells at its "
                "tip"),
    KEY("growth", REAL, gn_scene, elements.beam.growth, .unit = "1", .range = "[1.01, 3]",
        .fallback = "1.2", .text = "ratio of neighbouring cells away from the notch"),
    KEY("origin", VECTOR, gn_scene, elements.beam.origin, .unit = "m", .range = GN_PLACES,
        .fallback = "0", .text = "lower corner"),
    KEY("diagonals", CHOICE, gn_scene, elements.beam.diagonals, .choices = diagonals,
        .fallback = "alternating",
        .text = "as for a rectangle or box; parallel ones are mirrored at mid-span"),
};
TABLE_OF(beam);

/* ---- materials, motions, loads ---- */

static const gn_key material_keys[] = {
    KEY("group", TEXT, gn_element_material, group, .fallback = "",
        PRESENT(TEXT, gn_element_material, group), PLACED(gn_element_material, group_where),
        .text = "group of elements in the mesh, by name or number; left out: all elements"),
    KEY("young", REAL, gn_element_material, young, .unit = "Pa", .range = GN_MODULI,
        .required = true, .text = "Young's modulus"),
    KEY("poisson", REAL, gn_element_material, poisson, .unit = "1", .range = "(-1, 0.5]",
        .required = true,
        .text = "Poisson's ratio, below 0.5: an incompressible material has no stable step in an "
                "explicit scheme"),
    KEY("density", REAL, gn_element_material, density, .unit = "kg/m3", .range = GN_DENSITIES,
        .required = true, .text = "mass density"),
};
ELEMENTS_OF(material, gn_element_material);

#define REGION_BOX(STRUCT, NAME)                                                                   \
    static const gn_key NAME##_keys[] = {                                                          \
        KEY("min", VECTOR, STRUCT, region.box_min, .unit = "m", .required = true,                  \
            .text = "lower corner"),                                                               \
        KEY("max", VECTOR, STRUCT, region.box_max, .unit = "m", .required = true,                  \
            .text = "upper corner"),                                                               \
    };                                                                                             \
    TABLE_OF(NAME)

#define CHANNEL(NAME, FIELD, STRUCT, UNIT, RANGE, WORD, TEXT)                                      \
    KEY(NAME, TABLE, STRUCT, FIELD, .unit = UNIT, .range = RANGE, .word = WORD, .fallback = WORD,  \
        .text = TEXT)

REGION_BOX(gn_element_motion, motion_box);

static const gn_key velocity_keys[] = {
    CHANNEL("vx", velocity[0], gn_motion, "m/s", GN_SPEEDS, "free", "prescribed velocity along x"),
    CHANNEL("vy", velocity[1], gn_motion, "m/s", GN_SPEEDS, "free", "prescribed velocity along y"),
    CHANNEL("vz", velocity[2], gn_motion, "m/s", GN_SPEEDS, "free", "prescribed velocity along z"),
};
TABLE_OF(velocity);

static const gn_key motion_keys[] = {
    KEY("name", NAME, gn_element_motion, name, .required = true,
        .text = "name by which the rest of the scene and the columns of the history refer to it"),
    KEY("group", TEXT, gn_element_motion, region.group, .fallback = "",
        PRESENT(TEXT, gn_element_motion, region.group),
        PLACED(gn_element_motion, region.group_where),
        .text = "nodes of a group of the mesh, by name or number"),
    SECTION("box", motion_box_section, PRESENT(BOOL, gn_element_motion, region.has_box),
            .text = "nodes that start in a box, boundary included; instead of group"),
    SECTION("motion", velocity_section, .offset = offsetof(gn_element_motion, motion),
            .text = "each component free, constant or a table [[time, value], ...]; all free: only "
                    "the displacement is recorded"),
};
ELEMENTS_OF(motion, gn_element_motion);

REGION_BOX(gn_element_load, load_box);

static const gn_key traction_keys[] = {
    CHANNEL("tx", traction[0], gn_element_load, "Pa", GN_TRACTIONS, "none", "component along x"),
    CHANNEL("ty", traction[1], gn_element_load, "Pa", GN_TRACTIONS, "none", "component along y"),
    CHANNEL("tz", traction[2], gn_element_load, "Pa", GN_TRACTIONS, "none", "component along z"),
};
TABLE_OF(traction);

static const gn_key force_keys[] = {
    CHANNEL("fx", force[0], gn_element_load, "N", GN_FORCES, "none", "component along x"),
    CHANNEL("fy", force[1], gn_element_load, "N", GN_FORCES, "none", "component along y"),
    CHANNEL("fz", force[2], gn_element_load, "N", GN_FORCES, "none", "component along z"),
};
TABLE_OF(force);

static const gn_key load_keys[] = {
    KEY("name", TEXT, gn_element_load, name, .fallback = "",
        .text = "name for --set; may be left out"),
    KEY("group", TEXT, gn_element_load, region.group, .fallback = "",
        PRESENT(TEXT, gn_element_load, region.group), PLACED(gn_element_load, region.group_where),
        .text = "nodes or facets of a group of the mesh, by name or number"),
    SECTION("box", load_box_section, PRESENT(BOOL, gn_element_load, region.has_box),
            .text = "nodes that start in a box, or facets of the mesh that lie entirely in it; "
                    "instead of group"),
    SECTION("traction", traction_section, PRESENT(BOOL, gn_element_load, has_traction),
            .text = "force per area on facets, of fixed direction; each component constant or a "
                    "table"),
    SECTION("force", force_section, PRESENT(BOOL, gn_element_load, has_force),
            .text = "total force, distributed by area over the facets of a group of facets, "
                    "otherwise by mass; each component constant or a table"),
};
ELEMENTS_OF(load, gn_element_load);

static const gn_key contact_keys[] = {
    KEY("group", TEXT, gn_scene, elements.contact.group, .fallback = "",
        PRESENT(TEXT, gn_scene, elements.contact.group),
        PLACED(gn_scene, elements.contact.group_where),
        .text = "facets of a group of the mesh, by name or number; left out: the whole boundary"),
    KEY("stiffness", REAL, gn_scene, elements.contact.stiffness, .unit = "N/m", .range = GN_SPRINGS,
        .word = "none", .fallback = "none",
        .text = "penalty stiffness k_n; needed by every law but hertz"),
    KEY("material", TEXT, gn_scene, elements.contact.material, .fallback = "",
        PRESENT(TEXT, gn_scene, elements.contact.material),
        .text = "with hertz: name of the material; left out: rigid, with its own friction and the "
                "restitution of the particles"),
    KEY("kratio", REAL, gn_scene, elements.contact.kratio, .unit = "1", .range = GN_RATIOS,
        .word = "none", .fallback = "none", .text = "k_n/k_t of the surface; needed with friction"),
    KEY("friction", REAL, gn_scene, elements.contact.friction, .unit = GN_SLOPE,
        .range = GN_FRICTIONS, .fallback = "0", .text = "Coulomb friction coefficient"),
};
TABLE_OF(contact);

/* ---- all ---- */

static const gn_key elements_keys[] = {
    KEY("mesh", FILE, gn_scene, elements.mesh, .second = offsetof(gn_scene, elements.mesh_path),
        PRESENT(TEXT, gn_scene, elements.mesh), PLACED(gn_scene, elements.mesh_where),
        .text = "gmsh .msh file, format 2.2 or 4.1, linear triangles (3D: tetrahedra)"),
    KEY("scale", REAL, gn_scene, elements.scale, .unit = "1", .range = GN_SCALES, .fallback = "1",
        PRESENT(BOOL, gn_scene, elements.scale_given),
        .text = "lengths in the file times this give metres"),
    SECTION("rectangle", block_section, PRESENT(BOOL, gn_scene, elements.has_rectangle),
            .shape_dimension = 2, .text = "built-in 2D mesh; groups body, x_lower, x_upper, ..."),
    SECTION("box", block_section, PRESENT(BOOL, gn_scene, elements.has_box), .shape_dimension = 3,
            .text = "built-in 3D mesh; groups body, x_lower, x_upper, y_lower, ..."),
    SECTION("beam", beam_section, PRESENT(BOOL, gn_scene, elements.has_beam),
            .text = "built-in mesh of a beam for bending, with an optional notch; groups also "
                    "support_left, support_right, supports, load, notch, mouth_left, mouth_right"),
    KEY("formulation", CHOICE, gn_scene, elements.formulation, .choices = formulations,
        .fallback = "displacement",
        .text = "displacement, or mixed displacement and pressure for nearly incompressible "
                "materials"),
    ARRAY("materials", LIST, gn_scene, elements.materials, elements.material_count,
          .section = &material_section, .range = "[1, 1000]", .required = true,
          .text = "materials of elements; a later one overrides an earlier one"),
    ARRAY("motions", LIST, gn_scene, elements.motions, elements.motion_count,
          .section = &motion_section, .range = "[0, 10000]",
          .text = "nodes that move as prescribed, or are only observed; a later one overrides an "
                  "earlier one"),
    ARRAY("loads", LIST, gn_scene, elements.loads, elements.load_count, .section = &load_section,
          .range = "[0, 10000]", .text = "tractions and forces, which add up"),
    SECTION("contact", contact_section, PRESENT(BOOL, gn_scene, elements.has_contact),
            .text = "contact of particles with the surface; without it they pass through"),
};
const gn_section gn_elements_section = {elements_keys, sizeof elements_keys / sizeof(gn_key), 0,
                                        offsetof(gn_scene, elements.where)};
