/* Keys of the section `specimen`, the source of the particles. */
#include "scene/manifest_keys.h"

/* ---- words ---- */

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
    CHOICE("kind", gn_scene, specimen.lattice.kind, lattices, REQUIRED,
           "square and hexagonal in 2D; cubic, fcc and hcp in 3D"),
    REAL("radius", gn_scene, specimen.lattice.radius, "m", GN_LENGTHS, REQUIRED,
         "radius of every particle"),
    CELLS("cells", gn_scene, specimen.lattice.cells, "[1, 100000]", REQUIRED,
          "unit cells along x, y and z"),
    VECTOR("origin", gn_scene, specimen.lattice.origin, "m", GN_PLACES, BY("0"),
           "lower corner of the first cell"),
    REAL("spacing", gn_scene, specimen.lattice.spacing, "1", "[1e-3, 1e6]", BY("1"),
         "distance of nearest neighbours over two radii; 1: just touching"),
    REAL("jitter", gn_scene, specimen.lattice.jitter, "1", "[0, 1)", BY("0"),
         "random shift of each centre along each axis, up to this times the radius"),
};
TABLE_OF(lattice);

static const gn_key rectangle_keys[] = {
    REAL("width", gn_scene, specimen.pack.size[0], "m", GN_LENGTHS, REQUIRED, "length along x"),
    REAL("height", gn_scene, specimen.pack.size[1], "m", GN_LENGTHS, REQUIRED, "length along y"),
};
TABLE_OF(rectangle);

static const gn_key disc_keys[] = {
    REAL("diameter", gn_scene, specimen.pack.diameter, "m", GN_LENGTHS, REQUIRED,
         "diameter of the disc"),
};
TABLE_OF(disc);

static const gn_key body_box_keys[] = {
    VECTOR("size", gn_scene, specimen.pack.size, "m", GN_LENGTHS, REQUIRED,
           "lengths along x, y and z", .shape_dimension = 3),
};
TABLE_OF(body_box);

static const gn_key cylinder_keys[] = {
    REAL("diameter", gn_scene, specimen.pack.diameter, "m", GN_LENGTHS, REQUIRED,
         "diameter of the cylinder"),
    REAL("height", gn_scene, specimen.pack.height, "m", GN_LENGTHS, REQUIRED, "length along z"),
};
TABLE_OF(cylinder);

static const gn_key refinement_keys[] = {
    VECTOR("from", gn_refinement, lower, "m", NULL, PRESENT(BOOL, gn_refinement, has_region),
           "lower corner of a box, which may have zero lengths"),
    VECTOR("to", gn_refinement, upper, "m", NULL, PRESENT(BOOL, gn_refinement, has_region),
           "upper corner; given together with from"),
    CHOICE("boundary", gn_refinement, boundary, gn_booleans, BY("false"),
           "refines at the boundary of the body instead of a box"),
    REAL("size", gn_refinement, size, "1", "[1e-3, 1]", REQUIRED,
         "size of the particles there over that elsewhere"),
    REAL("distance", gn_refinement, distance, "m", GN_LENGTHS, REQUIRED,
         "distance over which the size grows back"),
};
ELEMENTS_OF(refinement, gn_refinement);

static const gn_key region_keys[] = {
    VECTOR("min", gn_scene, specimen.pack.region_min, "m", GN_PLACES, REQUIRED, "lower corner"),
    VECTOR("max", gn_scene, specimen.pack.region_max, "m", GN_PLACES, REQUIRED, "upper corner"),
};
TABLE_OF(region);

static const gn_key packing_keys[] = {
    SECTION("region", region_section, PRESENT(BOOL, gn_scene, specimen.pack.has_region),
            .text = "packs only the part of the body, a rectangle or box, that is in this box; "
                    "volume and porosity are those of the part"),
    REAL("size_ratio", gn_scene, specimen.pack.size_ratio, "1", "[1.2, 100]", BY("6"),
         "requested largest over smallest radius; a sieve curve implies its own",
         PRESENT(NONE, gn_scene, specimen.pack.sieve_count)),
    REAL("size_variation", gn_scene, specimen.pack.size_variation, "1", "[0, 1]", OR("auto", -1),
         "standard deviation of the radii over their mean before the fit; with sizes fitted or "
         "normal"),
    CHOICE("sizes", gn_scene, specimen.pack.sizes, pack_sizes, BY("fitted"),
           "distribution of the radii; fitted: the one that packs best. uniform and normal: by "
           "number, from the smallest to size_ratio times that; sieve: by the curve. The fit then "
           "changes each radius by at most a tenth, and packs less densely",
           PRESENT(ENUM, gn_scene, specimen.pack.sizes)),
    ARRAY("sieve", POINTS, gn_scene, specimen.pack.sieve, specimen.pack.sieve_count, .unit = "1",
          .range = "[0, 1]", .number = 2, PRESENT(COUNT, gn_scene, specimen.pack.sieve_count),
          .text = "with sizes sieve: rows [size over the largest, mass fraction that passes], from "
                  "[smallest, 0] to [1, 1]"),
    CHOICE("overlap", gn_scene, specimen.pack.overlap, overlaps, BY("none"),
           "passive: neighbours overlap by a few per cent, free of stress when bonded with "
           "bonds.passive_gaps"),
    REAL("overlap_size", gn_scene, specimen.pack.overlap_size, "1", "[0, 0.2]", OR("auto", -1),
         "target overlap over the sum of the radii; with overlap passive"),
    REAL("gap", gn_scene, specimen.pack.gap, "1", "[0, 0.5]", OR("auto", -1),
         "pairs up to this gap over the sum of the radii are closed"),
    CHOICE("start", gn_scene, specimen.pack.start, pack_starts, BY("random"),
           "centres at the start: well-spread random points, or the inner nodes of the mesh"),
    REAL("jiggle", gn_scene, specimen.pack.jiggle, "1", "[0, 1]", BY("0.3"),
         "with start: nodes: random shift of the nodes over their spacing"),
    ARRAY("refine", LIST, gn_scene, specimen.pack.refinements, specimen.pack.refinement_count,
          .section = &refinement_section, .range = "[0, 1000]",
          .text = "regions with smaller particles"),
    INTEGER("iterations", gn_scene, specimen.pack.iterations, "[1, 1e6]", OR("auto", 0),
            "largest number of iterations of the fit"),
    REAL("residual", gn_scene, specimen.pack.residual, "1", "(0, 1)", OR("auto", 0),
         "the fit stops once the root mean square gap of the closed pairs, over the sum of their "
         "radii, is below this"),
    REAL("time", gn_scene, specimen.pack.time_limit, "s", "(0, inf)", OR("off", 0),
         "wall time after which the best packing so far is taken; the result then depends on the "
         "machine"),
};
TABLE_OF(packing);

static const gn_key specimen_keys[] = {
    KEY("file", FILE, gn_scene, specimen.file, .second = offsetof(gn_scene, specimen.path),
        PRESENT(TEXT, gn_scene, specimen.file),
        .text = "text file of rows x y z r (2D: x y r), or of columns that its header names (id, "
                "material, "
                "group, density, velocities; units); relative to the folder of the scene"),
    KEY("from", FILE, gn_scene, specimen.from, .second = offsetof(gn_scene, specimen.from_path),
        PRESENT(TEXT, gn_scene, specimen.from), .in_folder = "results.h5",
        PLACED(gn_scene, specimen.from_where),
        .text = "folder of another run, the remaining particles of which are taken in their final "
                "state, or of a packing; relative to the folder of the scene"),
    CHOICE("from_velocities", gn_scene, specimen.from_velocities, from_velocities, BY("keep"),
           "velocities of particles from another run: kept, or zero"),
    CHOICE("from_bonds", gn_scene, specimen.from_bonds, from_bonds, BY("none"),
           "keep: intact bonds of the other run are taken over with their stress-free lengths; "
           "none: bonds form by the section bonds"),
    REAL("scale", gn_scene, specimen.scale, "1", GN_SCALES, BY("1"),
         "lengths in the file, surface or mesh times this give metres",
         PRESENT(BOOL, gn_scene, specimen.scale_given)),
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
        .text = "3D shape: STL, PLY or OBJ file of a closed surface"),
    KEY("mesh", FILE, gn_scene, specimen.pack.mesh,
        .second = offsetof(gn_scene, specimen.pack.mesh_path), SHAPE(MESH, 0),
        .text =
            "2D or 3D shape: gmsh .msh file, whose triangles (3D: tetrahedra) are the body; or "
            "a .geo, .step, .brep or .iges file, which the gmsh program meshes first: only with "
            "--allow-gmsh, as such a file can execute commands"),
    VECTOR("origin", gn_scene, specimen.pack.origin, "m", GN_PLACES, BY("0"),
           "position of the origin of a rectangle, disc, box or cylinder",
           PRESENT(ENUM, gn_scene, specimen.pack.shape)),
    REAL("mean_radius", gn_scene, specimen.pack.mean_radius, "m", GN_LENGTHS, OR("none", 0),
         "mean radius of the particles to pack into a shape, instead of their number"),
    SECTION("packing", packing_section, PRESENT(BESIDE, gn_scene, specimen.pack.shape),
            .text = "settings of the packing of a shape"),
    TEXT("material", gn_scene, specimen.material, BY(""),
         "name of the material; may be left out when there is only one",
         PRESENT(TEXT, gn_scene, specimen.material)),
    INTEGER("group", gn_scene, specimen.group, "[0, 1000000]", BY("1"),
            "cohesive group: bonds form between particles of the same group; 0: never bonded"),
    CHOICE("density_basis", gn_scene, specimen.density_basis, density_bases, BY("particle"),
           "bulk: the material's density is that of the assembly, including voids"),
    REAL("porosity", gn_scene, specimen.porosity, "1", "[0, 1)", OR("measure", -1),
         "with density_basis bulk: particle density is density/(1 - porosity)"),
};
const gn_section gn_specimen_section = {KEYS_OF(specimen), 0, offsetof(gn_scene, specimen.where)};
