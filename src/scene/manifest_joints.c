/* Keys of `joints`. */
#include "scene/manifest_keys.h"

#include <math.h>

#define GN_AREA_STIFFNESSES "[1e-9, 1e24]" /* Pa/m */

static const gn_key network_keys[] = {
    REAL("intensity", gn_joint_network, intensity, "1/m", "[1e-9, 1e9]", REQUIRED,
         "area of joints per volume of the specimen (P32); in 2D length per area (P21)"),
    REAL("fisher", gn_joint_network, fisher, "1", "[0, 1e6]", OR("parallel", (double)INFINITY),
         "concentration kappa of Fisher's distribution of the normals about that of the entry; 0: "
         "uniform; in 2D of von Mises' distribution of twice the angle"),
    REAL("radius_max", gn_joint_network, radius_max, "m", GN_LENGTHS, OR("equal", 0),
         "largest radius; equal: all joints have `radius`"),
    REAL("exponent", gn_joint_network, exponent, "1", "[0, 20]", BY("3"),
         "D of the power law between `radius` and radius_max: the number of joints larger than r "
         "falls as r^-D"),
};
TABLE_OF(network);

static const gn_key joint_keys[] = {
    NAME("name", gn_joint_def, name, REQUIRED, "name in the columns of the history"),
    VECTOR("point", gn_joint_def, point, "m", GN_PLACES, PRESENT(BOOL, gn_joint_def, has_point),
           "a point of the joint, the centre of a disc; point, trace, surface, discs or network"),
    VECTOR("normal", gn_joint_def, normal, "1", NULL, PRESENT(BOOL, gn_joint_def, has_normal),
           "normal of the joint, of any length; normal or dip"),
    REAL("dip", gn_joint_def, dip, "rad", "[0, 1.5707963267948966]", OR("none", -1),
         "angle of the joint to the plane of x and y; in 2D to x, downwards along x"),
    REAL("dip_direction", gn_joint_def, dip_direction, "rad", "[-7, 7]", BY("0"),
         "direction of the steepest descent, from y towards x; 3D"),
    REAL("radius", gn_joint_def, radius, "m", GN_LENGTHS, OR("none", 0),
         "radius of a disc, in 2D half of the length; none: the joint has no edge; of a network "
         "the smallest radius"),
    ARRAY("polygon", POINTS, gn_joint_def, corners, corner_count, .unit = "m", .range = GN_PLACES,
          PRESENT(COUNT, gn_joint_def, corner_count), .shape_dimension = 3,
          .text = "corners of the joint in its plane in either sense of rotation: rows [along the "
                  "strike, up the dip] from `point`"),
    ARRAY("trace", POINTS, gn_joint_def, trace, trace_count, .unit = "m", .range = GN_PLACES,
          .number = 2, PRESENT(COUNT, gn_joint_def, trace_count), .shape_dimension = 2,
          .text = "corners of a line in a 2D scene: rows [x, y]"),
    KEY("surface", FILE, gn_joint_def, surface, .second = offsetof(gn_joint_def, surface_path),
        PRESENT(TEXT, gn_joint_def, surface), .shape_dimension = 3,
        .text = "STL, PLY or OBJ file of a surface of triangles, in m"),
    KEY("discs", FILE, gn_joint_def, discs, .second = offsetof(gn_joint_def, discs_path),
        PRESENT(TEXT, gn_joint_def, discs),
        .text = "CSV file of discs: rows x, y, z, dip, dip direction, radius in m and degrees; in "
                "2D of lines: x, y, dip, half of the length"),
    SECTION("network", network_section, .offset = offsetof(gn_joint_def, network),
            PRESENT(BOOL, gn_joint_def, network.given),
            .text = "discs (in 2D lines) drawn at random by run.seed, with the mean normal and the "
                    "smallest radius of the entry"),
    REAL("normal_stiffness", gn_joint_def, normal_stiffness, "Pa/m", GN_AREA_STIFFNESSES, REQUIRED,
         "normal stress per closure"),
    REAL("shear_stiffness", gn_joint_def, shear_stiffness, "Pa/m", GN_AREA_STIFFNESSES, REQUIRED,
         "shear stress per shear displacement before sliding"),
    REAL("friction", gn_joint_def, friction, GN_SLOPE, GN_FRICTIONS, BY("0"),
         "Coulomb friction coefficient once the joint is broken (residual)"),
    REAL("bond_friction", gn_joint_def, bond_friction, GN_SLOPE, GN_FRICTIONS, OR("friction", -1),
         "coefficient of friction that adds to the cohesion of the intact joint"),
    REAL("cohesion", gn_joint_def, cohesion, "Pa", GN_PRESSURES, BY("0"),
         "shear strength of the intact joint without normal stress"),
    REAL("tensile_strength", gn_joint_def, tensile_strength, "Pa", GN_PRESSURES, BY("0"),
         "tensile strength of the intact joint"),
    REAL("dilation", gn_joint_def, dilation, GN_SLOPE, "[0, 10]", BY("0"),
         "opening per slip while the joint slides closed, or the angle of dilation"),
    REAL("dilation_end", gn_joint_def, dilation_end, "m", "[0, 1e9]", OR("none", GN_JOINT_ENDLESS),
         "slip at which the dilation ends"),
};
const gn_section gn_joint_section = {KEYS_OF(joint), sizeof(gn_joint_def),
                                     offsetof(gn_joint_def, where)};
