/* A scene as a plain struct: the contents of a scene file in SI units, with defaults filled in. The
 * manifest in scene/manifest.h drives parsing, defaults, range checks and the key reference. */
#ifndef GN_SCENE_SCENE_H
#define GN_SCENE_SCENE_H

#include "base/effects.h"
#include "base/error.h"
#include "base/instruction_sets.h"
#include "base/particle_columns.h"
#include "scene/clump_def.h"
#include "scene/couple_def.h"
#include "scene/flow_def.h"
#include "scene/joint_def.h"
#include "scene/laboratory.h"
#include "scene/mesh_def.h"
#include "scene/tool_def.h"
#include "scene/values.h"

#include <stdio.h>

/* Limits of coordinates and sizes in a scene and in the files that it names (manifest_keys.h). */
static const double GN_PLACE_MOST = 1e9;    /* m, on either side of the origin */
static const double GN_LENGTH_LEAST = 1e-9; /* m */

/* Relation of normal stiffness and bond strength to the radii (Rojek et al. 2012, sec. 2). */
typedef enum gn_stiffness_model {
    GN_STIFFNESS_UNIFORM,         /* given k_n, R_n and R_t, the same for every contact */
    GN_STIFFNESS_ARITHMETIC,      /* model 1: mean radius of the pair */
    GN_STIFFNESS_HARMONIC,        /* model 2: harmonic mean radius of the pair */
    GN_STIFFNESS_MEAN_RADIUS,     /* model 3a: uniform, from the mean over particles */
    GN_STIFFNESS_MEAN_ARITHMETIC, /* model 3b: uniform, mean over contacts of model 1 */
    GN_STIFFNESS_MEAN_HARMONIC,   /* model 3c: uniform, mean over contacts of model 2 */
    GN_STIFFNESS_DEMPACK,         /* by area (Santasusana 2013): Dempack's section times gamma */
    GN_STIFFNESS_POLYHEDRON,      /* by area: sections of virtual polyhedra about the particles */
    GN_STIFFNESS_HERTZ            /* no bonds: stiffness from the overlap of spheres, E and nu */
} gn_stiffness_model;

/* Attraction of unbonded spheres (kernels/cohesion.h). */
typedef enum gn_cohesion {
    GN_COHESION_NONE,
    GN_COHESION_JKR,
    GN_COHESION_DMT,
    GN_COHESION_LIQUID /* liquid bridges */
} gn_cohesion;

/* How gamma is determined if the scene does not give it. */
typedef enum gn_gamma_rule {
    GN_GAMMA_VOLUME,  /* sum of sections times lengths = dimension times volume */
    GN_GAMMA_POROSITY /* 40 e/n_c (Santasusana 2013, 4.5) */
} gn_gamma_rule;

/* Distribution of the random factor, with mean 1, that multiplies a property of each bond. */
typedef enum gn_scatter_kind {
    GN_SCATTER_NONE,
    GN_SCATTER_WEIBULL, /* Weibull of modulus m, scale 1/Gamma(1 + 1/m) */
    GN_SCATTER_NORMAL   /* normal of mean 1, restricted to (0, 2) */
} gn_scatter_kind;
typedef struct gn_scatter {
    gn_scatter_kind kind;
    double modulus, deviation;
} gn_scatter;

typedef enum gn_background_damping {
    GN_BACKGROUND_NONE,
    GN_BACKGROUND_VISCOUS,              /* coefficient in 1/s */
    GN_BACKGROUND_NONVISCOUS_VECTOR,    /* coefficient is a fraction in [0, 1) */
    GN_BACKGROUND_NONVISCOUS_COMPONENT, /* coefficient is a fraction in [0, 1) */
} gn_background_damping;

/* The velocity whose sign determines the direction of nonviscous_component damping. */
typedef enum gn_damped_velocity {
    GN_VELOCITY_HALF_STEP, /* the velocity of the last half step */
    GN_VELOCITY_INSTANT /* the velocity at the instant: that of the last half step plus dt F/(2 m)
                         */
} gn_damped_velocity;

typedef enum gn_lattice_kind {
    GN_LATTICE_NONE,
    GN_LATTICE_SQUARE,    /* 2D */
    GN_LATTICE_HEXAGONAL, /* 2D */
    GN_LATTICE_CUBIC,     /* 3D */
    GN_LATTICE_FCC,       /* 3D */
    GN_LATTICE_HCP        /* 3D */
} gn_lattice_kind;

/* Shapes that are packed with particles. */
typedef enum gn_shape_kind {
    GN_SHAPE_NONE,
    GN_SHAPE_RECTANGLE, /* 2D */
    GN_SHAPE_DISC,      /* 2D */
    GN_SHAPE_POLYGON,   /* 2D */
    GN_SHAPE_BOX,       /* 3D */
    GN_SHAPE_CYLINDER,  /* 3D, axis along z */
    GN_SHAPE_SURFACE,   /* 3D */
    GN_SHAPE_MESH       /* 2D: triangles, 3D: tetrahedra */
} gn_shape_kind;

typedef enum gn_overlap_kind {
    GN_OVERLAP_NONE,
    GN_OVERLAP_PASSIVE /* neighbours overlap; their bonds form free of stress */
} gn_overlap_kind;

typedef enum gn_pack_start {
    GN_START_RANDOM, /* well-spread random points */
    GN_START_NODES   /* the inner nodes of the mesh */
} gn_pack_start;

typedef enum gn_contact_arm {
    GN_ARM_MIDPOINT, /* contact point at r_i + u_n/2 from i: conserves energy */
    GN_ARM_RADIUS    /* contact point at r_i from i, as Rojek et al. 2012 */
} gn_contact_arm;

/* Effect of tension on the strength of a bond in shear. */
typedef enum gn_coupling {
    GN_COUPLING_NONE,
    GN_COUPLING_QUADRATIC, /* the bond breaks when the squares of both ratios of force to strength
                              add up to 1 */
    GN_COUPLING_LINEAR /* the strength decreases by mu_1 f_n under tension, as it increases under
                          pressure */
} gn_coupling;
typedef enum gn_confinement { GN_CONFINEMENT_OWN, GN_CONFINEMENT_MEAN } gn_confinement;
/* How the elongation (in shear: the slip) is determined at which a bond has lost all of its
 * strength. */
typedef enum gn_softening {
    GN_SOFTENING_NONE,   /* the bond breaks at once */
    GN_SOFTENING_ENERGY, /* the bond breaks when it has dissipated a given energy per area */
    GN_SOFTENING_STRAIN, /* the bond breaks at a given strain, relative to its length (in shear: to
                            the root of its area) */
    GN_SOFTENING_RATIO   /* the bond breaks at a given multiple of the elastic limit */
} gn_softening;
/* Shape of the curve along which the strength of a bond decreases to zero. */
typedef enum gn_softening_curve {
    GN_SOFTENING_LINEAR,
    GN_SOFTENING_BILINEAR /* first steep, then flat (Petersson 1981) */
} gn_softening_curve;
typedef enum gn_fracture { GN_FRACTURE_CONTACT, GN_FRACTURE_BODY } gn_fracture;
typedef enum gn_precision { GN_PRECISION_DOUBLE, GN_PRECISION_MIXED } gn_precision;
/* State at which explicit steps begin. */
typedef enum gn_start { GN_START_REST, GN_START_FIRST_BREAK } gn_start;
typedef enum gn_step_estimate { GN_STEP_SHARP, GN_STEP_BOUND } gn_step_estimate;
/* Gravity on particles with raised mass: refused, or acting on their own mass. */
typedef enum gn_scaled_gravity { GN_GRAVITY_REFUSED, GN_GRAVITY_OWN } gn_scaled_gravity;
typedef enum gn_policy { GN_POLICY_STOP, GN_POLICY_WARN } gn_policy;
typedef enum gn_lost_policy { GN_LOST_STOP, GN_LOST_REMOVE } gn_lost_policy;
typedef enum gn_density_basis { GN_DENSITY_PARTICLE, GN_DENSITY_BULK } gn_density_basis;
typedef enum gn_switch { GN_SWITCH_AUTO, GN_SWITCH_ON, GN_SWITCH_OFF } gn_switch;

typedef struct gn_material {
    char name[GN_NAME_SIZE];
    double density;          /* kg/m3 */
    double contact_modulus;  /* E_c, Pa; for models that depend on size or packing */
    double normal_stiffness; /* k_n, N/m; for the uniform model */
    double kratio;           /* kappa = k_n/k_t, as in PFC; 0: no tangential spring */
    double young, poisson;   /* E, Pa, and nu; for laws by area and Hertz's law */
    double alpha, beta;      /* factors of E in k_n and of G in k_t; for laws by area */
    double friction, rolling_friction, twisting_friction; /* mu, mu_r, mu_t */
    double adhesion;           /* w, J/m2, with law.cohesion jkr and dmt */
    double restitution;        /* for Hertz's law; negative: that of the scene */
    double tensile_strength;   /* sigma_c of the contact, Pa; for models that depend on size */
    double shear_strength;     /* tau_c of the contact, Pa */
    double bond_tension_limit; /* R_n, N; for the uniform model */
    double bond_shear_limit;   /* R_t, N; for the uniform model */
    gn_scatter strength_scatter, stiffness_scatter;
    double bond_friction;                          /* mu_1 of intact bonds */
    double fracture_energy, shear_fracture_energy; /* J/m2, per area of a bond; 0: none */
    double fracture_strain, shear_fracture_strain;
    double fracture_ratio;
    double yield_stress[3],
        yield_ratio[3]; /* Pa; ratio of k_n to the stiffness beyond yield; 0: none */
    gn_scene_place where;
} gn_material;

/* A contact between two materials whose values differ from those that follow from both. */
/* J/m2: shear_fracture_energy follows from fracture_energy, strengths and stiffnesses. */
#define GN_SHEAR_ENERGY_AUTO (-1.0)
#define GN_COMBINED          (-2.0) /* the pair states no value */
typedef struct gn_contact_def {
    size_t between_count;
    char (*between)[GN_NAME_SIZE]; /* [between_count], one or two names */
    double friction, kratio, contact_modulus, normal_stiffness, young, poisson, alpha, beta,
        tensile_strength, shear_strength, bond_tension_limit, bond_shear_limit, bond_friction,
        fracture_energy, shear_fracture_energy, restitution, rolling_friction, twisting_friction,
        adhesion;
    gn_scene_place where;
} gn_contact_def;

typedef struct gn_lattice {
    gn_lattice_kind kind;
    double radius;    /* m */
    int64_t cells[3]; /* unit cells along x, y, z (z ignored in 2D) */
    double origin[3]; /* m, lower corner of the first cell */
    double spacing;   /* distance of nearest neighbours over twice the radius; 1: they just touch */
    double
        jitter; /* random shift of each centre, uniform in a cube of +- jitter times the radius */
} gn_lattice;

/* Refinement of a packing: particles are smaller inside and near a box, or near the boundary. */
typedef struct gn_refinement {
    bool has_region;
    double lower[3], upper[3]; /* corners of the box, which may have zero lengths, m */
    bool boundary;             /* near the boundary instead of a box */
    double size;               /* size of particles there over the size elsewhere, (0, 1] */
    double distance;           /* m, distance over which the size grows to that elsewhere */
    gn_scene_place where;
} gn_refinement;

/* A shape that is filled with particles, and the settings of the fit. */
typedef struct gn_pack_def {
    gn_shape_kind shape;
    double size[3];  /* m, of rectangle (two sides) and box */
    double diameter; /* m, of disc and cylinder */
    double height;   /* m, of cylinder */
    size_t corner_count;
    double *corners;            /* [corner_count][2], m, of polygon */
    char surface[GN_PATH_SIZE]; /* path as written; "" if the shape is another one */
    char surface_path[GN_PATH_SIZE];
    char mesh[GN_PATH_SIZE]; /* path as written; "" if the shape is another one */
    char mesh_path[GN_PATH_SIZE];
    bool has_region; /* Only the part inside a box is packed; rectangles and boxes are cut to it
                        once they are read (check.c). The box is in coordinates of the scene and is
                        not shifted. */
    double region_min[3], region_max[3]; /* m */
    double origin[3]; /* m, see docs/scene.md; 0 with a polygon. With a surface or mesh it is added
                         to the coordinates in the file, see gn_scene_shift */
    int64_t count;    /* number of particles; 0: not given */
    double mean_radius;    /* m; 0: not given */
    double size_ratio;     /* largest over smallest radius */
    double size_variation; /* standard deviation of the radii over their mean; -1: automatic */
    gn_pack_sizes sizes;
    size_t sieve_count;
    double *sieve; /* [sieve_count][2]: size over the largest, share of the mass that passes */
    gn_overlap_kind overlap;
    double overlap_size; /* over r_i + r_j; -1: automatic */
    double gap;          /* largest gap over r_i + r_j of pairs that are closed; -1: automatic */
    gn_pack_start start;
    double jiggle; /* random shift of nodes of the mesh over their spacing */
    size_t refinement_count;
    gn_refinement *refinements;
    int64_t iterations; /* largest number of iterations of the fit; 0: automatic */
    double residual;   /* root mean square gap over r_i + r_j at which the fit ends; 0: automatic */
    double time_limit; /* s of wall time; 0: none */
} gn_pack_def;

/* `gneiss pack` writes this file to its folder; it identifies a specimen as a packing. */
#define GN_PACKING_FILE "packing.h5"

typedef struct gn_specimen {
    char file[GN_PATH_SIZE]; /* path as written; "" if there is another source */
    char path[GN_PATH_SIZE]; /* resolved: relative to the scene file's folder */
    /* Results of another run, or a packing, as written and resolved. */
    char from[GN_PATH_SIZE], from_path[GN_PATH_SIZE];
    gn_scene_place from_where;
    bool from_velocities, from_bonds; /* further quantities that are taken over */
    double scale; /* factor by which lengths in a file, surface or mesh are multiplied to give
                     metres */
    bool scale_given;
    gn_lattice lattice;
    size_t particle_count; /* inline particles */
    double *particles;     /* [particle_count][4]: x y z r, m (2D: x y 0 r) */
    gn_pack_def pack;
    /* Particles of a file or shape after reading or packing (not a key): like `particles`, but
     * relative to the scene's origin. */
    size_t packed_count;
    double *packed;
    gn_particle_columns packed_columns; /* of a file */
    double packed_volume; /* m3 (2D: m2), volume of that shape; 0: the source is a file or run */
    char material[GN_NAME_SIZE];
    int64_t group;                  /* cohesive group; 0: never bonded */
    gn_density_basis density_basis; /* bulk: the density of particles is density/(1 - porosity) */
    double porosity;                /* with `bulk`; negative: it is measured */
    gn_scene_place where;
} gn_specimen;

/* A named selection of particles, and the actions on it. All given conditions must hold for a
 * particle to be selected. If two sets give the same property, the later one applies. */
typedef struct gn_set_def {
    char name[GN_NAME_SIZE];
    bool all;
    bool has_box;
    double box_min[3], box_max[3]; /* m, box that contains the centres */
    size_t id_count;
    int64_t *ids;        /* indices from 0, in the order of the specimen file */
    int64_t end_axis;    /* -1 none, else 0 1 2 */
    bool end_upper;      /* the upper end instead of the lower one */
    double end_depth;    /* m */
    bool end_by_surface; /* the surface of the particle, not its centre, must be within the depth */
    char material[GN_NAME_SIZE]; /* "": unchanged */
    int64_t group;               /* negative: unchanged */
    double initial_velocity[3], initial_spin[3];
    bool has_initial_velocity, has_initial_spin;
    double force[3];             /* N in total, distributed by mass */
    gn_table force_over_time[3]; /* a component that varies; see gn_scene_set_time */
    bool has_force;
    gn_motion motion;
    gn_scene_place where;
} gn_set_def;

typedef struct gn_servo {
    bool active;
    gn_table force;      /* target normal force, compression positive, N; or */
    gn_table stress;     /* Pa, target stress on the area */
    bool of_mean;        /* `stress` is the target of the mean of the stresses along all axes */
    double area;         /* m2 (2D: m x 1 m); 0: the section between walls that face each other */
    double max_velocity; /* m/s */
    double relaxation;   /* share of the force error that is corrected per step, (0, 1] */
} gn_servo;

typedef struct gn_wall_def {
    char name[GN_NAME_SIZE],
        material[GN_NAME_SIZE]; /* with a material: contacts by Hertz's law; "": rigid */
    double point[3];            /* m */
    double normal[3]; /* towards the particles; of any length in the file, a unit vector here */
    double stiffness; /* penalty k_n, N/m */
    double kratio;    /* k_n/k_t; used if friction > 0 */
    double friction, rolling_friction, twisting_friction;
    bool passive; /* particles that overlap the wall at the start are stress-free there */
    gn_motion motion;
    gn_servo servo;
    gn_scene_place where;
} gn_wall_def;

/* A tube, a funnel or, with both ends closed, a cylinder or a truncated cone; axis along z. */
typedef struct gn_body_cylinder {
    double diameter, upper_diameter, height; /* m; upper_diameter 0: the same */
    int64_t sides;
    bool open; /* the surface has no end faces */
} gn_body_cylinder;

/* A rigid body: its surface, its contact parameters and its motion. */
typedef struct gn_body_def {
    char name[GN_NAME_SIZE],
        material[GN_NAME_SIZE]; /* with a material: contacts by Hertz's law; "": rigid */
    char surface[GN_PATH_SIZE]; /* path as written; "" if the shape is another one */
    char surface_path[GN_PATH_SIZE];
    bool has_box, has_cylinder;
    double box_size[3]; /* m */
    gn_body_cylinder cylinder;
    bool has_disc_cutter, has_chisel, has_wedge, has_pick;
    gn_tool_def tool;
    size_t polygon_count, polyline_count;
    double *polygon, *polyline; /* [count][2], m */
    double scale; /* factor by which lengths of the shape are multiplied to give metres */
    bool scale_given;
    double origin[3]; /* m, position of the shape's own origin */
    bool has_rotation;
    double rotation[3]; /* rad, rotation vector about the shape's own origin, applied before the
                           translation */
    double stiffness;   /* penalty k_n, N/m */
    double kratio;      /* k_n/k_t; used if friction > 0 */
    double friction, rolling_friction, twisting_friction;
    bool has_reference;
    double reference[3];  /* m: centre of rotation for a prescribed spin */
    bool free;            /* components without a prescribed motion follow the forces */
    double density, mass; /* kg/m3; kg; of a free body; exactly one of them is nonzero */
    bool has_inertia;
    double inertia[3]; /* kg m2 about the centre of mass, for rotation about x y z at the start; 2D:
                          the third */
    bool has_initial_velocity, has_initial_spin;
    double initial_velocity[3], initial_spin[3];
    double force[3]; /* N, on the centre of mass of a free body, in its free directions */
    gn_table force_over_time[3]; /* a component that varies; see gn_scene_set_time */
    bool has_force;
    gn_motion motion;
    gn_scene_place where;
} gn_body_def;

static inline gn_tool_kind gn_body_tool(const gn_body_def *body) {
    return body->has_disc_cutter ? GN_TOOL_DISC_CUTTER
           : body->has_chisel    ? GN_TOOL_CHISEL
           : body->has_wedge     ? GN_TOOL_WEDGE
           : body->has_pick      ? GN_TOOL_PICK
                                 : GN_TOOL_NONE;
}

/* Material of linear finite elements. */
typedef struct gn_element_material {
    char group[GN_NAME_SIZE];       /* group of elements, by name or tag; "": all elements */
    gn_scene_place group_where;     /* line 0: not in the file */
    double young, poisson, density; /* Pa, -, kg/m3 */
    gn_scene_place where;
} gn_element_material;

/* Nodes (for tractions: facets), selected either by a group of the mesh or by a box about their
 * initial positions. */
typedef struct gn_region {
    char group[GN_NAME_SIZE]; /* name or tag; "": box */
    gn_scene_place group_where;
    bool has_box;
    double box_min[3], box_max[3]; /* m, boundary included */
} gn_region;

/* Nodes with a prescribed motion. If no component is prescribed, the mean displacement of the nodes
 * is only recorded. */
typedef struct gn_element_motion {
    char name[GN_NAME_SIZE];
    gn_region region;
    gn_motion motion; /* velocities only */
    gn_scene_place where;
} gn_element_motion;

typedef struct gn_element_load {
    char name[GN_NAME_SIZE]; /* "": none */
    gn_region region;
    bool has_traction, has_force; /* exactly one is true */
    gn_table traction[3];         /* Pa, of fixed direction, on facets */
    gn_table force[3]; /* N in total; distributed by area (facets) or by mass (other nodes) */
    gn_scene_place where;
} gn_element_load;

typedef enum gn_formulation { GN_FORMULATION_DISPLACEMENT, GN_FORMULATION_PRESSURE } gn_formulation;

/* Contact parameters of particles on the surface of finite elements. */
typedef struct gn_element_contact_def {
    char group[GN_NAME_SIZE]; /* group of facets; "": the whole boundary */
    gn_scene_place group_where;
    char material[GN_NAME_SIZE]; /* material of the surface, as for walls */
    double stiffness;            /* penalty k_n, N/m */
    double kratio;               /* k_n/k_t; used if friction > 0 */
    double friction;
} gn_element_contact_def;

/* A body of finite elements: exactly one of mesh, rectangle, box, beam. */
typedef struct gn_element_def {
    char mesh[GN_PATH_SIZE]; /* path as written; "" if there is another source */
    char mesh_path[GN_PATH_SIZE];
    gn_scene_place mesh_where;
    double scale; /* factor by which lengths in the file are multiplied to give metres */
    bool scale_given;
    bool has_rectangle, has_box, has_beam;
    double size[3], origin[3]; /* m, of a rectangle or box */
    int64_t cells[3];
    double distortion;      /* random shift of inner nodes over the sides of a cell */
    gn_diagonals diagonals; /* of a rectangle or box */
    gn_beam_def beam;
    gn_formulation formulation;
    size_t material_count;
    gn_element_material *materials; /* to an element applies the last material that names it */
    size_t motion_count;
    gn_element_motion *motions; /* a later motion overrides an earlier one */
    size_t load_count;
    gn_element_load *loads; /* loads add up */
    bool has_contact;
    gn_element_contact_def contact;
    gn_scene_place where;
} gn_element_def;

/* Notes on a valid scene that probably does not mean what was intended: "FILE:LINE:COLUMN: KEY:
 * ...", each once. `idle` notes are about keys that change nothing in the scene; `key_at` is the
 * offset at which KEY begins. */
enum { GN_SCENE_NOTES_MAX = 12, GN_SCENE_NOTE_SIZE = 480 };
typedef struct gn_scene_notes {
    size_t count;
    bool idle[GN_SCENE_NOTES_MAX];
    int key_at[GN_SCENE_NOTES_MAX];
    char text[GN_SCENE_NOTES_MAX][GN_SCENE_NOTE_SIZE];
} gn_scene_notes;

/* A function of a program that changes the particles of a specimen before masses, bonds and lists
 * are made (not a key). `position` [count][4] m: centre x y z relative to `origin`, and radius. */
typedef struct gn_preparation {
    gneiss_status (*act)(void *context, size_t count, double *position, int32_t *material,
                         int32_t *group, const double origin[3], gneiss_error *error);
    void *context;
} gn_preparation;

typedef struct gn_scene {
    char source[GN_PATH_SIZE]; /* the scene file, for messages */
    char *overridden;          /* keys given on the command line, one per line, for messages */
    bool allow_gmsh; /* the user permits gmsh, which may execute commands, to mesh a geometry (not a
                        key, because a file cannot permit it) */
    gn_preparation preparation; /* act NULL: none */
    gn_scene_notes notes;       /* notes for the user */
    char title[256];
    int64_t dimension; /* 2 or 3 */
    bool has_origin;
    double origin[3]; /* m: positions in computations are relative to it */

    bool has_specimen;   /* particles exist, at the start or later */
    bool specimen_given; /* particles other than those of clumps exist at the start */
    gn_specimen specimen;
    size_t material_count;
    gn_material *materials;
    size_t contact_count;
    gn_contact_def *contacts; /* at most one for each pair of materials */
    bool has_elements;
    gn_element_def elements;
    bool has_couple;
    gn_couple_def couple;

    bool has_law;
    gn_scene_place law_where;
    gn_stiffness_model stiffness;
    double gamma; /* 0: by gamma_rule */
    gn_gamma_rule gamma_rule;
    gn_contact_arm contact_arm;
    gn_coupling coupling;
    gn_confinement confinement; /* stress on which the friction mu_1 of a bond depends */
    gn_softening softening;
    gn_softening_curve softening_curve;
    double kink_stress;             /* bilinear: share of the strength at the kink */
    double initial_energy;          /* bilinear: share of the energy under the first line */
    gn_fracture fracture_energy_of; /* area to which fracture energies refer */
    bool pull;                      /* Hertz's law: the dashpot may cause tension */
    gn_cohesion cohesion;
    double surface_tension; /* N/m, of the liquid */
    double contact_angle;   /* rad */
    double liquid_content;  /* volume of the liquid over that of the particles at the start */
    gn_switch rotation;     /* auto: on */

    gn_switch bonds;               /* on if the scene has a `bonds` section */
    double interaction_range;      /* beta: pairs with gaps up to beta (r_i + r_j) are bonded */
    double overlap_range;          /* pairs with overlaps up to this times (r_i + r_j) are bonded */
    double bond_radius_multiplier; /* beam radius over the smaller radius; 0: no moments */
    double bond_moment_share;      /* share of moments in the strength of a bond */
    bool passive_gaps;             /* bonds are stress-free at the distance where they form */

    gn_background_damping background;
    double background_coefficient;
    double background_spin; /* coefficient for spins; -1: that for velocities */
    gn_damped_velocity background_velocity;
    double restitution;      /* c_r in [0, 1]; negative: contact damping is given by a fraction */
    double damping_fraction; /* alpha, fraction of critical damping; 0 and restitution < 0: no
                                contact damping */

    double gravity[3];             /* m/s2 */
    gn_table gravity_over_time[3]; /* a component that varies; see gn_scene_set_time */
    double random_velocity;        /* m/s, components uniform in +- this at the start */
    bool has_pulse;
    gn_pulse pulse;

    bool has_periodic;
    double periodic_min[3], periodic_max[3]; /* m */
    gn_box_side box[3];                      /* motion of the sides across x, y, z */
    int64_t periodic_open;                   /* axis along which the box is open: 0 1 2; -1: none */
    gn_scene_place periodic_where;
    bool has_domain;
    double domain_min[3], domain_max[3]; /* m; default: ten times the specimen's box */
    gn_lost_policy lost;

    size_t set_count;
    gn_set_def *sets;
    size_t wall_count;
    gn_wall_def *walls;
    size_t body_count;
    gn_body_def *bodies;
    size_t joint_count;
    gn_joint_def *joints;
    size_t source_count, sink_count;
    gn_source_def *sources;
    gn_sink_def *sinks;
    bool has_clumps;
    gn_clumps_def clumps;
    bool has_membrane;
    gn_membrane_def membrane;
    gn_test test;

    gn_scene_place time_where;
    double step;          /* dt, s; 0: automatic */
    double safety;        /* fraction of 2/w_max */
    double contact_steps; /* least duration of a collision in steps; 0: GN_STEPS_PER_CONTACT */
    gn_step_estimate estimate;
    bool has_mass_scaling;
    double scaled_step;   /* s, target of mass scaling; 0: scaled_factor */
    double scaled_factor; /* ratio of the target to the step without mass scaling */
    gn_scaled_gravity scaled_gravity;
    gn_scene_place scaling_where;
    gn_policy on_unstable; /* reaction to a step above its limit */
    double end;            /* s */
    gn_start start;        /* the run begins at rest, or where the static analysis ends */
    gn_scene_place start_where;
    double start_fraction;  /* fraction of the time of the first break; with GN_START_FIRST_BREAK */
    double stop_peak_drop;  /* stop once the stress has fallen by this fraction of its peak; 0: off,
                               below 0: the scene gives no end (scene/stages.h) */
    double stop_strain;     /* 0: off */
    double stop_unbalanced; /* stop once the unbalanced force ratio is below this; 0: off */

    gn_switch energy, orientation, events, contact_rows;
    double burst_reach; /* in mean diameters of bonded particles */
    size_t field_count;
    char (*fields)[GN_NAME_SIZE]; /* fields requested in addition to the default ones */
    unsigned asked;               /* the same fields as bits GN_ASKED(name) (base/asked.h) */

    double skin; /* m; 0: automatic */

    char output_directory[GN_PATH_SIZE]; /* "" : runs/<scene name> */
    int64_t history_rows;                /* requested rows up to `end` */
    bool has_structure; /* the structure is measured in a box, otherwise in the whole specimen */
    double structure_min[3], structure_max[3]; /* m */
    int64_t snapshots;      /* requested snapshots up to `end`; 0: only the last state */
    double checkpoint_wall; /* s of wall time between checkpoints; 0: on a signal and at the end */
    uint64_t seed;
    int64_t threads; /* 0: all cores */
    gn_precision precision;
    gn_isa isa;
    gn_scene_place isa_where;
    double residual_warning; /* residual of the energy ledger above which a run warns; 0: off */
    double residual_limit;   /* residual of the energy ledger above which a run stops; 0: off */

    bool loads_vary;             /* gravity or a force of a set or body varies over time */
    struct gn_formula *formulas; /* all formulas of tables */

    size_t stage_count; /* 0: the run has no stages */
    struct gn_stage *stages;
    size_t bonds_stage;    /* number of the last stage, from 1, that changes bonds; 0: none does */
    size_t membrane_stage; /* number of the last stage, from 1, that changes the membrane; 0: none
                              does */
    gn_effects united;     /* effects of all stages together */
} gn_scene;

/* One override from the command line: `--set time.end=2ms` is {"time.end", "2ms"}. */
typedef struct gn_override {
    const char *key, *value;
} gn_override;

/* Reads a scene file, applies overrides and checks the result. On failure the scene owns nothing
 * and `error` states file:line:column, key, expected and found value. The status is GNEISS_ERROR_IO
 * if an existing file cannot be read, else GNEISS_ERROR_INPUT. */
gneiss_status gn_scene_load(const char *path, const gn_override *overrides, size_t override_count,
                            gn_scene *scene, gneiss_error *error);

/* Parses a scene as gn_scene_load does, from text. Relative paths in it start at `folder`; `name`
 * appears in messages. */
gneiss_status gn_scene_parse(const char *text, const char *name, const char *folder,
                             const gn_override *overrides, size_t override_count, gn_scene *scene,
                             gneiss_error *error);

/* Parses text that gn_scene_write wrote, to resume a run: the files that it names need not exist.
 */
gneiss_status gn_scene_parse_saved(const char *text, const char *name, const gn_override *overrides,
                                   size_t override_count, gn_scene *scene, gneiss_error *error);

/* Reads only the keys of a packing: `title`, `dimension`, `specimen`, `output` and `run`. The
 * specimen must be a shape; its material is not looked up. Of other sections only the names are
 * checked; their members stay zero. */
gneiss_status gn_scene_load_specimen(const char *path, const gn_override *overrides,
                                     size_t override_count, gn_scene *scene, gneiss_error *error);

void gn_scene_free(gn_scene *scene);
/* Frees the scene that *scene points to, and its block (GN_FREED_BY); *scene may be NULL. */
void gn_scene_delete(gn_scene **scene);

/* Makes a deep copy, without specimen.packed. On failure the copy owns nothing. */
gneiss_status gn_scene_copy(const gn_scene *from, gn_scene *to, gneiss_error *error);

/* Subtracts scene->origin from the points of the scene; a world computes with the result. Boxes of
 * sets and regions stay as they are, because they are compared with positions in the user's
 * coordinates: relative ones may round differently from the corners of a box. Coordinates in files
 * are shifted by their readers (a surface or mesh to pack finds the shift in specimen.pack.origin),
 * and specimen.packed is relative already. */
void gn_scene_shift(gn_scene *scene);

/* Returns the resolved scene as YAML that gn_scene_parse reads back to the same struct bit for bit
 * (%.17g, SI, absolute specimen path). The caller frees the text with free(). NULL: out of memory.
 */
char *gn_scene_write(const gn_scene *scene);

/* Writes only `dimension`, `specimen` and `run.seed`, which gn_scene_load_specimen needs. */
char *gn_scene_write_specimen(const gn_scene *scene);

/* gn_scene_effects returns the effects that the scene needs; the second function returns those of
 * them that this build omits. */
gn_effects gn_scene_effects(const gn_scene *scene);
gn_effects gn_scene_not_built(const gn_scene *scene);

/* Prints the key reference: plain text for the terminal, or Markdown for docs/keys.md. The words
 * `sought` [sought_count] (none: every key) restrict it to keys that contain all of them, in upper
 * or lower case: first keys that begin with them, then keys with them in the name, then keys with
 * them in the text or a synonym. Returns the number of keys printed. */
size_t gn_scene_print_keys(FILE *out, bool markdown, const char *const *sought,
                           size_t sought_count);

/* Finds the key of which `sought`, a name or a full path, is probably a misspelling. Returns false
 * and "" if none is similar enough. */
bool gn_scene_nearest_key(const char *sought, char *name, size_t size);

/* Sets the components of gravity and of the forces of sets and bodies that vary over time to their
 * values at a time. In a scene that was read they have the first value that is not 0. */
void gn_scene_set_time(gn_scene *scene, double time);

/* Return the index of the entry with a name; -1: there is none. */
int gn_scene_find_wall(const gn_scene *scene, const char *name);
int gn_scene_find_body(const gn_scene *scene, const char *name);
/* A body's rotation follows its prescribed motion alone; forces alone; or forces about some axes of
 * space and the motion about the others. */
typedef enum gn_spins { GN_SPINS_PRESCRIBED, GN_SPINS_FREE, GN_SPINS_SOME } gn_spins;
gn_spins gn_body_spin_kind(const gn_scene *scene, const gn_body_def *body);
/* True if mass, centre and inertia of a body are those of its closed surface. */
bool gn_body_mass_is_from_surface(const gn_body_def *body);
int gn_scene_find_set(const gn_scene *scene, const char *name);
int gn_scene_find_material(const gn_scene *scene, const char *name);
int gn_scene_find_clump_shape(const gn_scene *scene, const char *name);
/* Returns the entry of `contacts` for two materials; NULL: none. */
const gn_contact_def *gn_scene_find_contact(const gn_scene *scene, const gn_material *first,
                                            const gn_material *second);
static inline bool gn_scene_tested(const gn_scene *scene) {
    return scene->test.kind != GN_TEST_NONE;
}
static inline const gn_test_descriptor *gn_scene_test(const gn_scene *scene) {
    return gn_test_of(scene->test.kind);
}
/* True if the membrane lies on the surface of a shape, not on the loaded particles. */
static inline bool gn_scene_membrane_on_shape(const gn_scene *scene) {
    return scene->specimen.pack.shape != GN_SHAPE_NONE &&
           scene->membrane.surface == GN_SURFACE_SHAPE;
}
static inline int gn_scene_membrane_axis(const gn_scene *scene) {
    return (int)(scene->membrane.axis >= 0 ? scene->membrane.axis : scene->test.axis);
}
/* The place with which a message begins: "FILE:LINE:COLUMN: PATH", or "--set KEY: PATH" if the
 * command line gave the value at the path or around it (if the path is that of a key, also values
 * below it). */
typedef struct gn_place_text {
    char text[GN_PATH_SIZE + 512];
} gn_place_text;
gn_place_text gn_scene_at(const gn_scene *scene, gn_scene_place where, const char *path);
/* True if the box is periodic along an axis. */
static inline bool gn_scene_periodic_along(const gn_scene *scene, int axis) {
    return scene->has_periodic && axis < scene->dimension && axis != scene->periodic_open;
}
/* True for a box that is periodic along some axes and open along another one. */
static inline bool gn_scene_half_periodic(const gn_scene *scene) {
    return scene->has_periodic && scene->periodic_open >= 0;
}
/* True if sides of the periodic box move. */
static inline bool gn_scene_box_moves(const gn_scene *scene) {
    bool moves = false;
    for (int a = 0; scene->has_periodic && a < 3; a++)
        moves |= scene->box[a].stress.count || scene->box[a].rate.count;
    return moves;
}
/* True if there is gravity at some time. */
static inline bool gn_scene_has_gravity(const gn_scene *scene) {
    bool acts = false;
    for (int a = 0; a < 3; a++)
        acts = acts || scene->gravity[a] != 0.0 || scene->gravity_over_time[a].count;
    return acts;
}
/* Returns the coefficient of the background damping of spins. */
static inline double gn_scene_spin_damping(const gn_scene *scene) {
    return scene->background_spin >= 0 ? scene->background_spin : scene->background_coefficient;
}
/* True if stiffness follows from E, nu and sections. */
static inline bool gn_scene_by_area(const gn_scene *scene) {
    return scene->stiffness == GN_STIFFNESS_DEMPACK || scene->stiffness == GN_STIFFNESS_POLYHEDRON;
}
/* True if particles exist at the start. */
static inline bool gn_scene_starts_filled(const gn_scene *scene) {
    return scene->specimen_given || scene->has_clumps;
}
/* True if particles enter or leave during the run. */
static inline bool gn_scene_has_flow(const gn_scene *scene) {
    return scene->has_specimen && (scene->source_count || scene->sink_count);
}
int gn_scene_find_element_motion(const gn_scene *scene, const char *name);

/* Returns the reason why the scene cannot have time.start: first_break; NULL: the scene shows none.
 */
const char *gn_scene_statics_refusal(const gn_scene *scene);

/* Returns the reason why a small loading of the scene's test cannot be followed by equilibria
 * without steps (static/first_break.h); NULL: the scene shows none. */
const char *gn_scene_loading_refusal(const gn_scene *scene);

/* True if specimen.from is a packing, not the results of a run. */
bool gn_scene_from_packing(const gn_scene *scene);

/* True if a part of the end loads the specimen along the axis of the test. Sets and nodes without
 * prescribed motion and force are only observed. */
bool gn_scene_end_drives(const gn_scene *scene, const gn_test_end *end);

#endif
