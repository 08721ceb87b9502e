/* Keys of finite elements. */
#include "scene/manifest_keys.h"

static const gn_choice formulations[] = {
    {"displacement", GN_FORMULATION_DISPLACEMENT}, {"mixed", GN_FORMULATION_PRESSURE}, {NULL, 0}};

static const gn_choice diagonals[] = {
    {"alternating", GN_DIAGONALS_ALTERNATING}, {"parallel", GN_DIAGONALS_PARALLEL}, {NULL, 0}};

/* ---- meshes ---- */

static const gn_key block_keys[] = {
    VECTOR("size", gn_scene, elements.size, "m", NULL, REQUIRED, "lengths along the axes"),
    CELLS("cells", gn_scene, elements.cells, "[1, 1e6]", REQUIRED,
          "cells along the axes, of two triangles or five (parallel: six) tetrahedra each"),
    VECTOR("origin", gn_scene, elements.origin, "m", GN_PLACES, BY("0"), "lower corner"),
    REAL("distortion", gn_scene, elements.distortion, "1", "[0, 0.25)", BY("0"),
         "random shift of the nodes over the sides of a cell; in 3D below 1/6"),
    CHOICE(
        "diagonals", gn_scene, elements.diagonals, diagonals, BY("alternating"),
        "diagonals of the cells: alternating prefers no direction; parallel gives equal masses to "
        "all inner nodes of equal cells, for waves only some elements long and for coupling zones"),
};
TABLE_OF(block);

static const gn_key beam_keys[] = {
    REAL("length", gn_scene, elements.beam.length, "m", GN_LENGTHS, REQUIRED, "length along x"),
    REAL("height", gn_scene, elements.beam.height, "m", GN_LENGTHS, REQUIRED, "height, along y"),
    REAL("thickness", gn_scene, elements.beam.thickness, "m", GN_LENGTHS, OR("none", 0),
         "thickness, along z; needed in 3D"),
    REAL("span", gn_scene, elements.beam.span, "m", GN_LENGTHS, OR("auto", 0),
         "distance of the supports; auto: the length"),
    REAL("notch_depth", gn_scene, elements.beam.notch_depth, "m", GN_LENGTHS, OR("none", 0),
         "depth of the notch in the lower side at mid-span"),
    REAL("notch_width", gn_scene, elements.beam.notch_width, "m", GN_LENGTHS, OR("none", 0),
         "width of the notch; needed with notch_depth"),
    REAL("cell", gn_scene, elements.beam.cell, "m", GN_LENGTHS, REQUIRED, "largest side of a cell"),
    INTEGER("notch_cells", gn_scene, elements.beam.notch_cells, "[1, 1000]", BY("1"),
            "cells over half the width of the notch; they set the size of the cells at its tip"),
    REAL("growth", gn_scene, elements.beam.growth, "1", "[1.01, 3]", BY("1.2"),
         "ratio of neighbouring cells away from the notch"),
    VECTOR("origin", gn_scene, elements.beam.origin, "m", GN_PLACES, BY("0"), "lower corner"),
    CHOICE("diagonals", gn_scene, elements.beam.diagonals, diagonals, BY("alternating"),
           "as for a rectangle or box; parallel ones are mirrored at mid-span"),
};
TABLE_OF(beam);

/* ---- materials, motions, loads ---- */

static const gn_key material_keys[] = {
    TEXT("group", gn_element_material, group, BY(""),
         "group of elements in the mesh, by name or number; left out: all elements",
         PRESENT(TEXT, gn_element_material, group), PLACED(gn_element_material, group_where)),
    REAL("young", gn_element_material, young, "Pa", GN_MODULI, REQUIRED, "Young's modulus"),
    REAL("poisson", gn_element_material, poisson, "1", "(-1, 0.5]", REQUIRED,
         "Poisson's ratio, below 0.5: an incompressible material has no stable step in an explicit "
         "scheme"),
    REAL("density", gn_element_material, density, "kg/m3", GN_DENSITIES, REQUIRED, "mass density"),
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

REGION_BOX(gn_element_motion, motion_box);

static const gn_key velocity_keys[] = {
    CHANNEL(gn_motion, "vx", velocity[0], "m/s", GN_SPEEDS, "free", "prescribed velocity along x"),
    CHANNEL(gn_motion, "vy", velocity[1], "m/s", GN_SPEEDS, "free", "prescribed velocity along y"),
    CHANNEL(gn_motion, "vz", velocity[2], "m/s", GN_SPEEDS, "free", "prescribed velocity along z"),
};
TABLE_OF(velocity);

static const gn_key motion_keys[] = {
    NAME("name", gn_element_motion, name, REQUIRED,
         "name by which the rest of the scene and the columns of the history refer to it"),
    TEXT("group", gn_element_motion, region.group, BY(""),
         "nodes of a group of the mesh, by name or number",
         PRESENT(TEXT, gn_element_motion, region.group),
         PLACED(gn_element_motion, region.group_where)),
    SECTION("box", motion_box_section, PRESENT(BOOL, gn_element_motion, region.has_box),
            .text = "nodes that start in a box, boundary included; instead of group"),
    SECTION("motion", velocity_section, .offset = offsetof(gn_element_motion, motion),
            .text = "each component free, constant or a table [[time, value], ...]; all free: only "
                    "the displacement is recorded"),
};
ELEMENTS_OF(motion, gn_element_motion);

REGION_BOX(gn_element_load, load_box);

static const gn_key traction_keys[] = {
    CHANNEL(gn_element_load, "tx", traction[0], "Pa", GN_TRACTIONS, "none", "component along x"),
    CHANNEL(gn_element_load, "ty", traction[1], "Pa", GN_TRACTIONS, "none", "component along y"),
    CHANNEL(gn_element_load, "tz", traction[2], "Pa", GN_TRACTIONS, "none", "component along z"),
};
TABLE_OF(traction);

static const gn_key force_keys[] = {
    CHANNEL(gn_element_load, "fx", force[0], "N", GN_FORCES, "none", "component along x"),
    CHANNEL(gn_element_load, "fy", force[1], "N", GN_FORCES, "none", "component along y"),
    CHANNEL(gn_element_load, "fz", force[2], "N", GN_FORCES, "none", "component along z"),
};
TABLE_OF(force);

static const gn_key load_keys[] = {
    TEXT("name", gn_element_load, name, BY(""), "name for --set; may be left out"),
    TEXT("group", gn_element_load, region.group, BY(""),
         "nodes or facets of a group of the mesh, by name or number",
         PRESENT(TEXT, gn_element_load, region.group), PLACED(gn_element_load, region.group_where)),
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
    TEXT("group", gn_scene, elements.contact.group, BY(""),
         "facets of a group of the mesh, by name or number; left out: the whole boundary",
         PRESENT(TEXT, gn_scene, elements.contact.group),
         PLACED(gn_scene, elements.contact.group_where)),
    REAL("stiffness", gn_scene, elements.contact.stiffness, "N/m", GN_SPRINGS, OR("none", 0),
         "penalty stiffness k_n; needed by every law but hertz"),
    TEXT("material", gn_scene, elements.contact.material, BY(""),
         "with hertz: name of the material; left out: rigid, with its own friction and the "
         "restitution of the particles",
         PRESENT(TEXT, gn_scene, elements.contact.material)),
    REAL("kratio", gn_scene, elements.contact.kratio, "1", GN_RATIOS, OR("none", 0),
         "k_n/k_t of the surface; needed with friction"),
    REAL("friction", gn_scene, elements.contact.friction, GN_SLOPE, GN_FRICTIONS, BY("0"),
         "Coulomb friction coefficient"),
};
TABLE_OF(contact);

/* ---- all ---- */

static const gn_key elements_keys[] = {
    KEY("mesh", FILE, gn_scene, elements.mesh, .second = offsetof(gn_scene, elements.mesh_path),
        PRESENT(TEXT, gn_scene, elements.mesh), PLACED(gn_scene, elements.mesh_where),
        .text = "gmsh .msh file of triangles (3D: tetrahedra); quadrangles, hexahedra, prisms and "
                "pyramids are split, and of elements of higher order the corners are used"),
    REAL("scale", gn_scene, elements.scale, "1", GN_SCALES, BY("1"),
         "lengths in the file times this give metres",
         PRESENT(BOOL, gn_scene, elements.scale_given)),
    SECTION("rectangle", block_section, PRESENT(BOOL, gn_scene, elements.has_rectangle),
            .shape_dimension = 2, .text = "built-in 2D mesh; groups body, x_lower, x_upper, ..."),
    SECTION("box", block_section, PRESENT(BOOL, gn_scene, elements.has_box), .shape_dimension = 3,
            .text = "built-in 3D mesh; groups body, x_lower, x_upper, y_lower, ..."),
    SECTION("beam", beam_section, PRESENT(BOOL, gn_scene, elements.has_beam),
            .text = "built-in mesh of a beam for bending, with an optional notch; groups also "
                    "support_left, support_right, supports, load, notch, mouth_left, mouth_right"),
    CHOICE("formulation", gn_scene, elements.formulation, formulations, BY("displacement"),
           "displacement, or mixed displacement and pressure for nearly incompressible materials"),
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
const gn_section gn_elements_section = {KEYS_OF(elements), 0, offsetof(gn_scene, elements.where)};
