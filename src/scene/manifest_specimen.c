/* Keys of the section `specimen`, the source of the particles. */
#include "scene/manifest_keys.h"

/* ---- words ---- */

static const gn_choice booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                     {"yes", 1},  {"no", 0},    {NULL, 0}};
static const gn_choice lattices[] = {
    {"square", GN_LATTICE_SQUARE}, {"hexagonal", GN_LATTICE_HEXAGONAL},
    {"cubic", GN_LATTICE_CUBIC},   {"fcc", GN_LATTICE_FCC},
    {"hcp", GN_LATTICE_HCP},       {NULL, 0}};
static const gn_choice overlaps[] = {
    {"none", GN_OVERLAP_NONE}, {"passive", GN_OVERLAP_PASSIVE}, {NULL, 0}};
static const gn_choice pack_starts[] = {
    {"random", GN_START_RANDOM}, {"nodes", GN_START_NODES}, {NULL, 0}};
static const gn_choice density_bases[] = {
    {"particle", GN_DENSITY_PARTICLE}, {"bulk", GN_DENSITY_BULK}, {NULL, 0}};

static const gn_choice from_velocities[] = {{"rest", 0}, {"keep", 1}, {NULL, 0}};
static const gn_choice from_bonds[] = {{"none", 0}, {"keep", 1}, {NULL, 0}};

static const gn_choice pack_sizes[] = {{"fitted", GN_SIZES_FITTED},
                                       {"uniform", GN_SIZES_UNIFORM},
                                       {"normal", GN_SIZES_NORMAL},
                                       {"sieve", GN_SIZES_SIEVE},
                                       {NULL, 0}};

/* ---- keys ---- */

static const gn_key lattice_keys[] = {
    KEY("kind", CHOICE, gn_scene, specimen.lattice.kind, .choices = lattices, .required = true,
        .text = "square and hexagonal in 2D; cubic, fcc and hcp in 3D"),
    KEY("radius", REAL, gn_scene, specimen.lattice.radius, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "radius of every particle"),
    KEY("cells", CELLS, gn_scene, specimen.lattice.cells, .range = "[1, 100000]", .required = true,
        .text = "unit cells along x, y and z"),
    KEY("origin", VECTOR, gn_scene, specimen.lattice.origin, .unit = "m", .range = GN_PLACES,
        .fallback = "0", .text = "lower corner of the first cell"),
    KEY("spacing", REAL, gn_scene, specimen.lattice.spacing, .unit = "1", .range = "[1e-3, 1e6]",
        .fallback = "1", .text = "distance of nearest neighbours over two radii; 1: just touching"),
    KEY("jitter", REAL, gn_scene, specimen.lattice.jitter, .unit = "1", .range = "[0, 1)",
        .fallback = "0",
        .text = "random shift of each centre along each axis, up to this times the radius"),
};
TABLE_OF(lattice);

static const gn_key rectangle_keys[] = {
    KEY("width", REAL, gn_scene, specimen.pack.size[0], .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "length along x"),
    KEY("height", REAL, gn_scene, specimen.pack.size[1], .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "length along y"),
};
TABLE_OF(rectangle);

static const gn_key disc_keys[] = {
    KEY("diameter", REAL, gn_scene, specimen.pack.diameter, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "diameter of the disc"),
};
TABLE_OF(disc);

static const gn_key body_box_keys[] = {
    KEY("size", VECTOR, gn_scene, specimen.pack.size, .unit = "m", .range = GN_LENGTHS,
        .required = true, .shape_dimension = 3, .text = "lengths along x, y and z"),
};
TABLE_OF(body_box);

static const gn_key cylinder_keys[] = {
    KEY("diameter", REAL, gn_scene, specimen.pack.diameter, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "diameter of the cylinder"),
    KEY("height", REAL, gn_scene, specimen.pack.height, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "length along z"),
};
TABLE_OF(cylinder);

static const gn_key refinement_keys[] = {
    KEY("from", VECTOR, gn_refinement, lower, .unit = "m", PRESENT(BOOL, gn_refinement, has_region),
        .text = "lower corner of a box, which may have zero lengths"),
    KEY("to", VECTOR, gn_refinement, upper, .unit = "m", PRESENT(BOOL, gn_refinement, has_region),
        .text = "upper corner; given together with from"),
    KEY("boundary", CHOICE, gn_refinement, boundary, .choices = booleans, .fallback = "false",
        .text = "refines at the boundary of the body instead of a box"),
    KEY("size", REAL, gn_refinement, size, .unit = "1", .range = "[1e-3, 1]", .required = true,
        .text = "size of the particles there over that elsewhere"),
    KEY("distance", REAL, gn_refinement, distance, .unit = "m", .range = GN_LENGTHS,
        .required = true, .text = "distance over which the size grows back"),
};
ELEMENTS_OF(refinement, gn_refinement);

static const gn_key region_keys[] = {
    KEY("min", VECTOR, gn_scene, specimen.pack.region_min, .unit = "m", .range = GN_PLACES,
        .required = true, .text = "lower corner"),
    KEY("max", VECTOR, gn_scene, specimen.pack.region_max, .unit = "m", .range = GN_PLACES,
        .required = true, .text = "upper corner"),
};
TABLE_OF(region);

static const gn_key packing_keys[] = {
    SECTION("region", region_section, PRESENT(BOOL, gn_scene, specimen.pack.has_region),
            .text = "packs only the part of the body, a rectangle or box, that is in this box; "
                    "volume and porosity are those of the part"),
    KEY("size_ratio", REAL, gn_scene, specimen.pack.size_ratio, .unit = "1", .range = "[1.2, 100]",
        .fallback = "6", PRESENT(NONE, gn_scene, specimen.pack.sieve_count),
        .text = "requested largest over smallest radius; a sieve curve implies its own"),
    KEY("size_variation", REAL, gn_scene, specimen.pack.size_variation, .unit = "1",
        .range = "[0, 1]", .word = "auto", .word_value = -1, .fallback = "auto",
        .text =
            "standard deviation of the radii over their mean before the fit; with sizes fitted or "
            "normal"),
    KEY("sizes", CHOICE, gn_scene, specimen.pack.sizes, .choices = pack_sizes, .fallback = "fitted",
        PRESENT(ENUM, gn_scene, specimen.pack.sizes),
        .text = "distribution of the radii; fitted: the one that packs best. uniform and normal: "
                "by number, from the smallest to size_ratio times that; sieve: by the curve. The "
                "fit then changes each radius by at most a tenth, and packs less densely"),
    ARRAY("sieve", POINTS, gn_scene, specimen.pack.sieve, specimen.pack.sieve_count, .unit = "1",
          .range = "[0, 1]", .number = 2, PRESENT(COUNT, gn_scene, specimen.pack.sieve_count),
          .text = "with sizes sieve: rows [size over the largest, mass fraction that passes], from "
                  "[smallest, 0] to [1, 1]"),
    KEY("overlap", CHOICE, gn_scene, specimen.pack.overlap, .choices = overlaps, .fallback = "none",
        .text = "passive: neighbours overlap by a few per cent, free of stress when bonded with "
                "bonds.passive_gaps"),
    KEY("overlap_size", REAL, gn_scene, specimen.pack.overlap_size, .unit = "1",
        .range = "[0, 0.2]", .word = "auto", .word_value = -1, .fallback = "auto",
        .text = "target overlap over the sum of the radii; with overlap passive"),
    KEY("gap", REAL, gn_scene, specimen.pack.gap, .unit = "1", .range = "[0, 0.5]", .word = "auto",
        .word_value = -1, .fallback = "auto",
        .text = "pairs up to this gap over the sum of the radii are closed"),
    KEY("start", CHOICE, gn_scene, specimen.pack.start, .choices = pack_starts,
        .fallback = "random",
        .text = "centres at the start: well-spread random points, or the inner nodes of the mesh"),
    KEY("jiggle", REAL, gn_scene, specimen.pack.jiggle, .unit = "1", .range = "[0, 1]",
        .fallback = "0.3",
        .text = "with start: nodes: random shift of the nodes over their spacing"),
    ARRAY("refine", LIST, gn_scene, specimen.pack.refinements, specimen.pack.refinement_count,
          .section = &refinement_section, .range = "[0, 1000]",
          .text = "regions with smaller particles"),
    KEY("iterations", INTEGER, gn_scene, specimen.pack.iterations, .range = "[1, 1e6]",
        .word = "auto", .fallback = "auto", .text = "largest number of iterations of the fit"),
    KEY("residual", REAL, gn_scene, specimen.pack.residual, .unit = "1", .range = "(0, 1)",
        .word = "auto", .fallback = "auto",
        .text = "the fit stops once the root mean square gap of the closed pairs, over the sum of "
                "their radii, is below this"),
    KEY("time", REAL, gn_scene, specimen.pack.time_limit, .unit = "s", .range = "(0, inf)",
        .word = "off", .fallback = "off",
        .text = "wall time after which the best packing so far is taken; the result then depends "
                "on the machine"),
};
TABLE_OF(packing);

static const gn_key specimen_keys[] = {
    KEY("file", FILE, gn_scene, specimen.file, .second = offsetof(gn_scene, specimen.path),
        PRESENT(TEXT, gn_scene, specimen.file),
        .text = "text file of rows x y z r (2D: x y r); relative to the folder of the scene"),
    KEY("from", FILE, gn_scene, specimen.from, .second = offsetof(gn_scene, specimen.from_path),
        PRESENT(TEXT, gn_scene, specimen.from), .in_folder = "results.h5",
        PLACED(gn_scene, specimen.from_where),
        .text = "folder of another run, whose particles at the end are taken without removed ones; "
                "or of a packing; relative to the folder of the scene"),
    KEY("from_velocities", CHOICE, gn_scene, specimen.from_velocities, .choices = from_velocities,
        .fallback = "keep", .text = "velocities of particles from another run: kept, or zero"),
    KEY("from_bonds", CHOICE, gn_scene, specimen.from_bonds, .choices = from_bonds,
        .fallback = "none",
        .text = "keep: intact bonds of the other run are taken over with their stress-free "
                "lengths; none: bonds form by the section bonds"),
    KEY("scale", REAL, gn_scene, specimen.scale, .unit = "1", .range = GN_SCALES, .fallback = "1",
        PRESENT(BOOL, gn_scene, specimen.scale_given),
        .text = "lengths in the file, surface or mesh times this give metres"),
    ARRAY("particles", PARTICLES, gn_scene, specimen.particles, specimen.particle_count,
          .unit = "m", .number = offsetof(gn_scene, specimen.pack.count), .range = "[4, 1e8]",
          PRESENT(ROWS, gn_scene, specimen.particle_count),
          .text = "rows [x, y, z, r] of particles, in 2D [x, y, r]; or the number of particles to "
                  "pack into a shape"),
    SECTION("lattice", lattice_section, PRESENT(ENUM, gn_scene, specimen.lattice.kind),
            .text = "a regular arrangement of equal particles"),
    SECTION("rectangle", rectangle_section, SHAPE(RECTANGLE, 2),
            .text = "2D shape; its lower left corner is at the origin"),
    SECTION("disc", disc_section, SHAPE(DISC, 2), .text = "2D shape; its centre is at the origin"),
    ARRAY("polygon", POINTS, gn_scene, specimen.pack.corners, specimen.pack.corner_count,
          .unit = "m", .range = GN_PLACES, SHAPE(POLYGON, 2),
          .text = "2D shape: its corners in either sense of rotation"),
    SECTION("box", body_box_section, SHAPE(BOX, 3),
            .text = "3D shape; its lower corner is at the origin"),
    SECTION("cylinder", cylinder_section, SHAPE(CYLINDER, 3),
            .text = "3D shape, axis along z; the centre of its lower end is at the origin"),
    KEY("surface", FILE, gn_scene, specimen.pack.surface,
        .second = offsetof(gn_scene, specimen.pack.surface_path), SHAPE(SURFACE, 3),
        .text = "3D shape: STL file of a closed surface"),
    KEY("mesh", FILE, gn_scene, specimen.pack.mesh,
        .second = offsetof(gn_scene, specimen.pack.mesh_path), SHAPE(MESH, 0),
        .text =
            "2D or 3D shape: gmsh .msh file, whose triangles (3D: tetrahedra) are the body; or "
            "a .geo, .step, .brep or .iges file, which the gmsh program meshes first: only with "
            "--allow-gmsh, as such a file can execute commands"),
    KEY("origin", VECTOR, gn_scene, specimen.pack.origin, .unit = "m", .range = GN_PLACES,
        .fallback = "0", PRESENT(ENUM, gn_scene, specimen.pack.shape),
        .text = "position of the origin of a rectangle, disc, box or cylinder"),
    KEY("mean_radius", REAL, gn_scene, specimen.pack.mean_radius, .unit = "m", .range = GN_LENGTHS,
        .word = "none", .fallback = "none",
        .text = "mean radius of the particles to pack into a shape, instead of their number"),
    SECTION("packing", packing_section, PRESENT(BESIDE, gn_scene, specimen.pack.shape),
            .text = "settings of the packing of a shape"),
    KEY("material", TEXT, gn_scene, specimen.material, .fallback = "",
        PRESENT(TEXT, gn_scene, specimen.material),
        .text = "name of the material; may be left out when there is only one"),
    KEY("group", INTEGER, gn_scene, specimen.group, .range = "[0, 1000000]", .fallback = "1",
        .text = "cohesive group: bonds form between particles of the same group; 0: never bonded"),
    KEY("density_basis", CHOICE, gn_scene, specimen.density_basis, .choices = density_bases,
        .fallback = "particle",
        .text = "bulk: the material's density is that of the assembly, including voids"),
    KEY("porosity", REAL, gn_scene, specimen.porosity, .unit = "1", .range = "[0, 1)",
        .word = "measure", .word_value = -1, .fallback = "measure",
        .text = "with density_basis bulk: particle density is density/(1 - porosity)"),
};
const gn_section gn_specimen_section = {specimen_keys, sizeof specimen_keys / sizeof(gn_key), 0,
                                        offsetof(gn_scene, specimen.where)};
