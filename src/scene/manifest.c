#include "scene/manifest_keys.h"

/* ---- words ---- */

const gn_choice gn_switches[] = {
    {"auto", GN_SWITCH_AUTO}, {"on", GN_SWITCH_ON},  {"off", GN_SWITCH_OFF}, {"true", GN_SWITCH_ON},
    {"false", GN_SWITCH_OFF}, {"yes", GN_SWITCH_ON}, {"no", GN_SWITCH_OFF},  {NULL, 0}};
const gn_choice gn_booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                 {"yes", 1},  {"no", 0},    {NULL, 0}};
const gn_choice gn_held_stresses[] = {{"side", 0}, {"mean", 1}, {NULL, 0}};
static const gn_choice stiffness_models[] = {{"uniform", GN_STIFFNESS_UNIFORM},
                                             {"arithmetic", GN_STIFFNESS_ARITHMETIC},
                                             {"harmonic", GN_STIFFNESS_HARMONIC},
                                             {"mean_radius", GN_STIFFNESS_MEAN_RADIUS},
                                             {"mean_arithmetic", GN_STIFFNESS_MEAN_ARITHMETIC},
                                             {"mean_harmonic", GN_STIFFNESS_MEAN_HARMONIC},
                                             {"dempack", GN_STIFFNESS_DEMPACK},
                                             {"polyhedron", GN_STIFFNESS_POLYHEDRON},
                                             {"hertz", GN_STIFFNESS_HERTZ},
                                             {NULL, 0}};
static const gn_choice cohesions[] = {{"none", GN_COHESION_NONE},
                                      {"jkr", GN_COHESION_JKR},
                                      {"dmt", GN_COHESION_DMT},
                                      {"liquid", GN_COHESION_LIQUID},
                                      {NULL, 0}};
static const gn_choice gamma_rules[] = {
    {"volume", GN_GAMMA_VOLUME}, {"porosity", GN_GAMMA_POROSITY}, {NULL, 0}};
static const gn_choice contact_arms[] = {
    {"midpoint", GN_ARM_MIDPOINT}, {"radius", GN_ARM_RADIUS}, {NULL, 0}};
static const gn_choice couplings[] = {{"none", GN_COUPLING_NONE},
                                      {"quadratic", GN_COUPLING_QUADRATIC},
                                      {"linear", GN_COUPLING_LINEAR},
                                      {NULL, 0}};
static const gn_choice confinements[] = {
    {"own", GN_CONFINEMENT_OWN}, {"mean", GN_CONFINEMENT_MEAN}, {NULL, 0}};
static const gn_choice softenings[] = {{"none", GN_SOFTENING_NONE},
                                       {"energy", GN_SOFTENING_ENERGY},
                                       {"strain", GN_SOFTENING_STRAIN},
                                       {"ratio", GN_SOFTENING_RATIO},
                                       {NULL, 0}};
static const gn_choice curves[] = {
    {"linear", GN_SOFTENING_LINEAR}, {"bilinear", GN_SOFTENING_BILINEAR}, {NULL, 0}};
static const gn_choice fractures[] = {
    {"contact", GN_FRACTURE_CONTACT}, {"body", GN_FRACTURE_BODY}, {NULL, 0}};
static const gn_choice backgrounds[] = {
    {"none", GN_BACKGROUND_NONE},
    {"viscous", GN_BACKGROUND_VISCOUS},
    {"nonviscous_vector", GN_BACKGROUND_NONVISCOUS_VECTOR},
    {"nonviscous_component", GN_BACKGROUND_NONVISCOUS_COMPONENT},
    {NULL, 0}};
static const gn_choice damped_velocities[] = {
    {"half_step", GN_VELOCITY_HALF_STEP}, {"instant", GN_VELOCITY_INSTANT}, {NULL, 0}};
static const gn_choice lost_policies[] = {
    {"stop", GN_LOST_STOP}, {"remove", GN_LOST_REMOVE}, {NULL, 0}};
const gn_choice gn_axes[] = {{"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
static const gn_choice sides[] = {{"lower", 0}, {"upper", 1}, {NULL, 0}};
static const gn_choice measures[] = {{"centre", 0}, {"surface", 1}, {NULL, 0}};
static const gn_choice precisions[] = {
    {"double", GN_PRECISION_DOUBLE}, {"mixed", GN_PRECISION_MIXED}, {NULL, 0}};
#define X(name) {#name, GN_ISA_##name},
static const gn_choice isas[] = {{"auto", GN_ISA_AUTO}, GN_KNOWN_INSTRUCTION_SETS(X){NULL, 0}};
#undef X

/* ---- materials ---- */

#define SCATTER(NAME, FIELD, TEXT)                                                                 \
    SECTION(NAME, gn_scatter_section, .offset = offsetof(gn_material, FIELD),                      \
            PRESENT(ENUM, gn_material, FIELD.kind), .text = TEXT)

static const gn_key material_keys[] = {
    NAME("name", gn_material, name, REQUIRED, "name by which the rest of the scene refers to it"),
    REAL("density", gn_material, density, "kg/m3", GN_DENSITIES, REQUIRED,
         "mass density, of particles or of the bulk (specimen.density_basis)"),
    REAL("contact_modulus", gn_material, contact_modulus, "Pa", GN_MODULI, OR("none", 0),
         "E_c: normal stiffness over radius; needed by every law but uniform, hertz and those by "
         "area"),
    REAL("normal_stiffness", gn_material, normal_stiffness, "N/m", GN_SPRINGS, OR("none", 0),
         "k_n of every contact; needed by the uniform law"),
    REAL("kratio", gn_material, kratio, "1", "[0, 1e12]", OR("none", -1),
         "k_n/k_t; 0: no tangential spring; needed by every law but those by area and hertz"),
    REAL("young", gn_material, young, "Pa", GN_MODULI, OR("none", 0),
         "E: k_n = alpha E A/L; needed by laws by area and hertz"),
    REAL("poisson", gn_material, poisson, "1", "(-1, 0.5]", OR("none", -2),
         "nu: k_t = beta G A/L with G = E/(2 (1 + nu)); needed by laws by area and hertz"),
    REAL("alpha", gn_material, alpha, "1", "[1e-6, 1e6]", BY("1"),
         "factor of E in k_n; laws by area"),
    REAL("beta", gn_material, beta, "1", "[0, 1e6]", BY("1"),
         "factor of G in k_t; 0: no tangential spring; laws by area"),
    REAL("friction", gn_material, friction, GN_SLOPE, GN_FRICTIONS, BY("0"),
         "Coulomb friction coefficient"),
    REAL("rolling_friction", gn_material, rolling_friction, "1", GN_FRICTIONS, BY("0"),
         "mu_r: contacts resist rolling up to the moment mu_r R |f_n|, R the reduced radius; 0: no "
         "resistance"),
    REAL("twisting_friction", gn_material, twisting_friction, "1", GN_FRICTIONS, BY("0"),
         "mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced radius; 0: "
         "no resistance"),
    REAL(
        "adhesion", gn_material, adhesion, "J/m2", "[0, 1e6]", BY("0"),
        "with law.cohesion jkr and dmt: work of adhesion w of two surfaces of this material, twice "
        "its surface energy; of two materials the geometric mean"),
    REAL("restitution", gn_material, restitution, "1", "[0, 1]", OR("none", -1),
         "with hertz: restitution coefficient of its contacts, the smaller one of two materials; "
         "none: that of damping.contact"),
    REAL("tensile_strength", gn_material, tensile_strength, "Pa", GN_STRENGTHS, OR("none", 0),
         "sigma_c of a bond; needed with bonds by every law but uniform"),
    REAL("shear_strength", gn_material, shear_strength, "Pa", GN_STRENGTHS, OR("none", 0),
         "tau_c of a bond; needed with bonds by every law but uniform"),
    REAL("bond_tension_limit", gn_material, bond_tension_limit, "N", GN_BREAKING, OR("none", 0),
         "R_n: normal force at which a bond breaks; needed with bonds by the uniform law"),
    REAL("bond_shear_limit", gn_material, bond_shear_limit, "N", GN_BREAKING, OR("none", 0),
         "R_t: shear force at which a bond breaks; needed with bonds by the uniform law"),
    SCATTER("strength_scatter", strength_scatter,
            "random factor of mean 1, drawn for each bond, of its strengths in tension and shear"),
    SCATTER("stiffness_scatter", stiffness_scatter,
            "random factor of mean 1, drawn for each bond, of its normal and tangential stiffness"),
    REAL("bond_friction", gn_material, bond_friction, GN_SLOPE, GN_FRICTIONS, BY("0"),
         "mu_1: a bond under compression |f_n| has its shear strength raised by mu_1 |f_n|; once "
         "broken it has friction instead"),
    REAL("fracture_energy", gn_material, fracture_energy, "J/m2", GN_TOUGHNESSES, OR("none", 0),
         "G_f in tension, per area of a bond; needed with softening energy"),
    REAL("shear_fracture_energy", gn_material, shear_fracture_energy, "J/m2", GN_TOUGHNESSES,
         OR("auto", GN_SHEAR_ENERGY_AUTO),
         "G_f in shear without pressure, per area of a bond; auto: bonds soften over the same "
         "multiple of the elastic limit as in tension; none: brittle in shear",
         .other_word = "none", .other_value = 0),
    REAL("fracture_strain", gn_material, fracture_strain, GN_STRAIN, GN_BREAKING, OR("none", 0),
         "eps_f: elongation of a bond over its length at the end of softening; needed with "
         "softening strain"),
    REAL("shear_fracture_strain", gn_material, shear_fracture_strain, GN_STRAIN, GN_BREAKING,
         OR("none", 0),
         "slip of a bond over the root of its area at the end of softening in shear; none: brittle "
         "in shear"),
    REAL("fracture_ratio", gn_material, fracture_ratio, "1", GN_BREAKING, OR("none", 0),
         "softening ends at 1 + this times the elastic limit, in tension and in shear; needed with "
         "softening ratio"),
    REAL("yield_stress_1", gn_material, yield_stress[0], "Pa", GN_STRENGTHS, OR("none", 0),
         "compressive stress of a bond above which its loading stiffness is k_n/yield_ratio_1; it "
         "unloads with k_n"),
    REAL("yield_ratio_1", gn_material, yield_ratio[0], "1", "[1, 1e9]", OR("none", 0),
         "k_n over the loading stiffness above yield_stress_1; needed with it"),
    REAL("yield_stress_2", gn_material, yield_stress[1], "Pa", GN_STRENGTHS, OR("none", 0),
         "compressive stress of a bond, above yield_stress_1, above which its loading stiffness is "
         "k_n/yield_ratio_2"),
    REAL("yield_ratio_2", gn_material, yield_ratio[1], "1", "[1, 1e9]", OR("none", 0),
         "k_n over the loading stiffness above yield_stress_2; needed with it"),
    REAL("yield_stress_3", gn_material, yield_stress[2], "Pa", GN_STRENGTHS, OR("none", 0),
         "compressive stress of a bond, above yield_stress_2, above which its loading stiffness is "
         "k_n/yield_ratio_3"),
    REAL("yield_ratio_3", gn_material, yield_ratio[2], "1", "[1, 1e9]", OR("none", 0),
         "k_n over the loading stiffness above yield_stress_3; needed with it"),
};
ELEMENTS_OF(material, gn_material);

/* ---- law, bonds, damping ---- */

static const gn_key law_keys[] = {
    CHOICE("stiffness", gn_scene, stiffness, stiffness_models, REQUIRED,
           "stiffness and bond strength from the radii (Rojek et al. 2012, sec. 2), or from E, nu "
           "and sections of the bonds (dempack, polyhedron: Santasusana 2013); hertz: unbonded "
           "spheres, by Hertz and Mindlin from E and nu"),
    REAL("gamma", gn_scene, gamma, "1", "[1e-6, 1e6]", OR("auto", 0),
         "section of a bond over Dempack's pi (2 r_i r_j/(r_i + r_j))^2 (2D: 4 r_i r_j/(r_i + r_j) "
         "times 1 m); with polyhedron, of pairs that come into contact later"),
    CHOICE("gamma_rule", gn_scene, gamma_rule, gamma_rules, BY("volume"),
           "rule for gamma: auto; volume: the sum of sections times lengths equals the dimension "
           "times the volume; porosity: 40 e/n_c (Santasusana 2013)"),
    CHOICE("contact_arm", gn_scene, contact_arm, contact_arms, BY("midpoint"),
           "contact point: midpoint of the gap, or one radius from the centre"),
    CHOICE("pull", gn_scene, pull, gn_booleans, BY("true"),
           "with hertz: the dashpot may exert tension at the end of a collision; false: the total "
           "force is cut off at zero, and the dashpot is adjusted to keep the restitution"),
    CHOICE(
        "cohesion", gn_scene, cohesion, cohesions, BY("none"),
        "with hertz: attraction of particles; jkr: Johnson, Kendall and Roberts 1971, with necks; "
        "dmt: constant pull-off force while they touch; liquid: bridges of liquid (Willett et al. "
        "2000)"),
    REAL("surface_tension", gn_scene, surface_tension, "N/m", "(0, 100]", OR("none", 0),
         "surface tension of the liquid; needed by cohesion liquid"),
    REAL(
        "contact_angle", gn_scene, contact_angle, "rad", "[0, 0.8726646259971648]", BY("0"),
        "angle of the liquid on the particles, with cohesion liquid; at most 50 degrees, the range "
        "of the fit"),
    REAL("liquid_content", gn_scene, liquid_content, "1", "(0, 0.5]", OR("none", 0),
         "volume of the liquid over that of the particles at the start; needed by cohesion liquid"),
    CHOICE("rotation", gn_scene, rotation, gn_switches, BY("auto"), "particles rotate; auto: on"),
    CHOICE("coupling", gn_scene, coupling, couplings, BY("none"),
           "reduction of a bond's shear strength by tension; quadratic: the bond breaks when the "
           "squares of force over strength add up to 1; linear: by mu_1 f_n"),
    CHOICE("confinement", gn_scene, confinement, confinements, BY("own"),
           "normal force that the friction of bonds (bond_friction) acts on: own: that of the "
           "bond; mean: that of the mean stress around its two particles"),
    CHOICE("softening", gn_scene, softening, softenings, BY("none"),
           "behaviour of bonds beyond their strength: none: they break at once; else they soften "
           "up to the fracture energy, strain or ratio of the material"),
    CHOICE("softening_curve", gn_scene, softening_curve, curves, BY("linear"),
           "with softening energy: linear, or bilinear: steep first, then flat, as for concrete"),
    REAL("kink_stress", gn_scene, kink_stress, "1", "[0.01, 0.99]", BY("0.3333333333333333"),
         "bilinear: fraction of the strength at the kink; Petersson: a third"),
    REAL("initial_energy", gn_scene, initial_energy, "1", "[0.01, 0.99]", BY("0.6"),
         "bilinear: fraction of the fracture energy under the first line, extended to zero; "
         "Petersson: 0.6"),
    CHOICE("fracture_energy_of", gn_scene, fracture_energy_of, fractures, BY("contact"),
           "area that fracture energies refer to: contact: that of a bond; body: that of a plane "
           "through the specimen, whose bonds have a larger total area"),
};
static const gn_section law_section = {KEYS_OF(law), 0, offsetof(gn_scene, law_where)};

static const gn_key bonds_keys[] = {
    CHOICE("enabled", gn_scene, bonds, gn_switches, BY("auto"),
           "auto: on when the scene has a bonds section"),
    REAL("interaction_range", gn_scene, interaction_range, "1", "[0, 100]", BY("0.05"),
         "bonds form at gaps up to this times the sum of the radii"),
    REAL("overlap_range", gn_scene, overlap_range, "1", "[0, 1]", BY("1"),
         "bonds form at overlaps up to this times the sum of the radii; 1: unlimited (but centres "
         "of bonded particles are at least 0.01 of the smaller radius apart)"),
    CHOICE("passive_gaps", gn_scene, passive_gaps, gn_booleans, BY("true"),
           "bonds are free of stress at the distance at which they form, and so are initial "
           "overlaps of particles without bonds"),
    REAL("radius_multiplier", gn_scene, bond_radius_multiplier, "1", "[0, 100]", BY("0"),
         "bonds carry bending and twisting moments as beams (PFC's parallel bonds, pb_rmul) of "
         "this times the smaller radius of the two particles; 0: no moments"),
    REAL("moment_share", gn_scene, bond_moment_share, "1", "[0, 1]", BY("1"),
         "share of moments in the strength of bonds with radius_multiplier (PFC's moment "
         "contribution, pb_mcf)"),
};
TABLE_OF(bonds);

static const gn_key background_keys[] = {
    CHOICE("model", gn_scene, background, backgrounds, BY("none"),
           "viscous: -a m v; nonviscous_vector: -a |F| v/|v|; nonviscous_component: -a |F_k| "
           "sign(v_k)"),
    REAL("coefficient", gn_scene, background_coefficient, "1/s|1", "[0, 1e15]", BY("0"),
         "a: in 1/s with viscous, otherwise a fraction in [0, 1)"),
    REAL("rotation", gn_scene, background_spin, "1/s|1", "[0, 1e15]", OR("same", -1),
         "a for spins, with -a I w and moments in place of forces; same: the value of coefficient "
         "(Labra 2012, eq. 2.38-2.41, has a separate one)"),
    CHOICE("velocity", gn_scene, background_velocity, damped_velocities, BY("half_step"),
           "with nonviscous_component: velocity whose sign counts, that of the last half step or "
           "that at the instant, v + dt F/(2 m), as in YADE"),
};
TABLE_OF(background);

static const gn_key contact_keys[] = {
    REAL("restitution", gn_scene, restitution, "1", "[0, 1]", OR("none", -1),
         "restitution coefficient of a free collision"),
    REAL("fraction", gn_scene, damping_fraction, "1", "(0, 1]", OR("none", 0),
         "normal damping as a fraction of critical; instead of restitution"),
};
TABLE_OF(contact);

static const gn_key damping_keys[] = {
    SECTION("background", background_section, .text = "damping of the motion of every particle"),
    SECTION("contact", contact_section, .text = "normal viscous damping in contacts"),
};
TABLE_OF(damping);

/* ---- surroundings ---- */

static const gn_key pulse_keys[] = {
    VECTOR("direction", gn_scene, pulse.direction, "1", NULL, REQUIRED,
           "direction of propagation and of displacement; of any length"),
    VECTOR("centre", gn_scene, pulse.centre, "m", GN_PLACES, REQUIRED,
           "a point of the plane of the crest"),
    REAL("length", gn_scene, pulse.length, "m", GN_LENGTHS, REQUIRED,
         "length of the wave from front to end"),
    REAL("size", gn_scene, pulse.size, "m", "[-1e9, 1e9]", REQUIRED, "displacement at the crest"),
    REAL("speed", gn_scene, pulse.speed, "m/s", GN_SPEEDS, REQUIRED, "wave speed, sqrt(M/rho)"),
};
TABLE_OF(pulse);

static const gn_key initial_keys[] = {
    REAL("random_velocity", gn_scene, random_velocity, "m/s", "[0, 3e8]", BY("0"),
         "velocity components drawn uniformly from +- this at the start"),
    SECTION("pulse", pulse_section, PRESENT(BOOL, gn_scene, has_pulse),
            .text = "an initial plane wave of the shape 1 + cos, in particles and elements"),
};
TABLE_OF(initial);

#define SIDE(AXIS, K)                                                                              \
    static const gn_key side_##AXIS##_keys[] = {                                                   \
        KEY("stress", TABLE, gn_scene, box[K].stress, .unit = "Pa", .range = GN_TRACTIONS,         \
            .word = "none", .fallback = "none",                                                    \
            .text = "target mean normal stress of the specimen along this axis, compression "      \
                    "positive; constant or a table; stress or rate"),                              \
        CHOICE("stress_of", gn_scene, box[K].of_mean, gn_held_stresses, BY("side"),                \
               "side: stress is that along this axis; mean: it is the mean over all axes, which "  \
               "the sides with this word hold by equal stresses of their own"),                    \
        KEY("rate", TABLE, gn_scene, box[K].rate, .unit = "1/s", .range = "[-1e6, 1e6]",           \
            .word = "none", .fallback = "none",                                                    \
            .text = "prescribed growth of the length of the box over its length",                  \
            PLACED(gn_scene, box[K].rate_where)),                                                  \
        KEY("max_rate", REAL, gn_scene, box[K].max_rate, .unit = "1/s", .range = "(0, 1e6]",       \
            .word = "none", .fallback = "none",                                                    \
            .text = "needed with stress: largest relative rate at which the box may shorten or "   \
                    "lengthen"),                                                                   \
        KEY("relaxation", REAL, gn_scene, box[K].relaxation, .unit = "1", .range = "(0, 1]",       \
            .word = "auto", .fallback = "auto",                                                    \
            .text = "with stress: fraction of the stress error corrected per step; reduced where " \
                    "stability of the time step requires it; auto: 0.1"),                          \
    };                                                                                             \
    TABLE_OF(side_##AXIS)
SIDE(x, 0);
SIDE(y, 1);
SIDE(z, 2);

static const gn_key periodic_keys[] = {
    VECTOR("min", gn_scene, periodic_min, "m", GN_PLACES, REQUIRED,
           "lower corner of the periodic box"),
    VECTOR("max", gn_scene, periodic_max, "m", GN_PLACES, REQUIRED,
           "upper corner of the periodic box"),
    CHOICE("open", gn_scene, periodic_open, gn_axes_or_none, BY("none"),
           "axis along which the box is open, as between two plates; min and max are not read "
           "along it"),
    SECTION("x", side_x_section,
            .text =
                "motion of the sides across x by a stress or a rate; the lower corner is fixed"),
    SECTION("y", side_y_section,
            .text =
                "motion of the sides across y by a stress or a rate; the lower corner is fixed"),
    SECTION("z", side_z_section,
            .text =
                "motion of the sides across z by a stress or a rate; the lower corner is fixed"),
};
static const gn_section periodic_section = {KEYS_OF(periodic), 0,
                                            offsetof(gn_scene, periodic_where)};

static const gn_key domain_keys[] = {
    VECTOR("min", gn_scene, domain_min, "m", NULL, PRESENT(BOOL, gn_scene, has_domain),
           "lower corner; default: the box of the specimen, enlarged by ten times its largest side "
           "on every side"),
    VECTOR("max", gn_scene, domain_max, "m", NULL, PRESENT(BOOL, gn_scene, has_domain),
           "upper corner; given together with min"),
    CHOICE("lost", gn_scene, lost, lost_policies, BY("stop"),
           "reaction to a particle that leaves the domain; default in cutting tests: remove"),
};
TABLE_OF(domain);

/* ---- sets and walls ---- */

static const gn_key set_motion_keys[] = {
    CHANNEL(gn_motion, "vx", velocity[0], "m/s", GN_SPEEDS, "free", "prescribed velocity along x"),
    CHANNEL(gn_motion, "vy", velocity[1], "m/s", GN_SPEEDS, "free", "prescribed velocity along y"),
    CHANNEL(gn_motion, "vz", velocity[2], "m/s", GN_SPEEDS, "free", "prescribed velocity along z"),
    CHANNEL(gn_motion, "wx", spin[0], "rad/s", GN_SPINS, "free", "prescribed spin about x"),
    CHANNEL(gn_motion, "wy", spin[1], "rad/s", GN_SPINS, "free", "prescribed spin about y"),
    CHANNEL(gn_motion, "wz", spin[2], "rad/s", GN_SPINS, "free", "prescribed spin about z"),
};
TABLE_OF(set_motion);

static const gn_key wall_motion_keys[] = {
    CHANNEL(gn_motion, "vx", velocity[0], "m/s", GN_SPEEDS, "free", "velocity along x"),
    CHANNEL(gn_motion, "vy", velocity[1], "m/s", GN_SPEEDS, "free", "velocity along y"),
    CHANNEL(gn_motion, "vz", velocity[2], "m/s", GN_SPEEDS, "free", "velocity along z"),
};
TABLE_OF(wall_motion);

static const gn_key box_keys[] = {
    VECTOR("min", gn_set_def, box_min, "m", NULL, REQUIRED, "lower corner"),
    VECTOR("max", gn_set_def, box_max, "m", NULL, REQUIRED, "upper corner"),
};
TABLE_OF(box);

static const gn_key end_keys[] = {
    CHOICE("axis", gn_set_def, end_axis, gn_axes, REQUIRED, "axis along which the ends lie"),
    CHOICE("side", gn_set_def, end_upper, sides, REQUIRED, "lower or upper end"),
    REAL("depth", gn_set_def, end_depth, "m", GN_LENGTHS, REQUIRED,
         "depth of the layer at the end of the specimen"),
    CHOICE(
        "by", gn_set_def, end_by_surface, measures, BY("centre"),
        "a particle is selected if its centre, or any part of its surface, lies within the depth"),
};
TABLE_OF(end);

static const gn_key select_keys[] = {
    CHOICE("all", gn_set_def, all, gn_booleans, BY("false"), "every particle"),
    SECTION("box", box_section, PRESENT(BOOL, gn_set_def, has_box),
            .text = "particles whose centres lie in a box"),
    ARRAY("ids", IDS, gn_set_def, ids, id_count, .range = "[0, 1e15]",
          PRESENT(COUNT, gn_set_def, id_count),
          .text = "indices of particles, base 0, in the order of the specimen"),
    SECTION("end", end_section, PRESENT(AXIS, gn_set_def, end_axis),
            .text = "particles at one end of the specimen"),
};
TABLE_OF(select);

static const gn_key set_keys[] = {
    NAME("name", gn_set_def, name, REQUIRED, "name by which the rest of the scene refers to it"),
    SECTION("select", select_section, .required = true,
            .text = "selection of particles; of several conditions all must hold"),
    TEXT("material", gn_set_def, material, BY(""), "name of another material than the specimen's",
         PRESENT(TEXT, gn_set_def, material)),
    INTEGER("group", gn_set_def, group, "[0, 1000000]", OR("keep", -1),
            "another cohesive group than the specimen's"),
    VECTOR("initial_velocity", gn_set_def, initial_velocity, "m/s", GN_SPEEDS,
           PRESENT(BOOL, gn_set_def, has_initial_velocity), "velocity at the start"),
    SPIN("initial_spin", gn_set_def, initial_spin, "rad/s", GN_SPINS,
         PRESENT(BOOL, gn_set_def, has_initial_spin), "spin at the start; in 2D one number"),
    VARYING("force", gn_set_def, force, "N", GN_FORCES, PRESENT(BOOL, gn_set_def, has_force),
            "total force on the set, distributed by mass"),
    SECTION("motion", set_motion_section, .offset = offsetof(gn_set_def, motion),
            .text =
                "prescribed motion; each channel free, constant or a table [[time, value], ...]"),
};
ELEMENTS_OF(set, gn_set_def);

static const gn_key servo_keys[] = {
    TABLE("force", gn_wall_def, servo.force, "N", GN_FORCES, OR("none", 0),
          "target normal force, compression positive; constant or a table; force or stress"),
    TABLE("stress", gn_wall_def, servo.stress, "Pa", GN_TRACTIONS, OR("none", 0),
          "target normal stress on the area of the wall, compression positive; constant or a "
          "table; force or stress"),
    CHOICE(
        "stress_of", gn_wall_def, servo.of_mean, gn_held_stresses, BY("side"),
        "side: stress is that on this wall; mean: it is the mean over all axes of a box of walls, "
        "which the walls with this word hold by equal stresses of their own"),
    REAL("area", gn_wall_def, servo.area, "m2", GN_AREAS, OR("auto", 0),
         "area for stress; auto: the current section between the walls that face each other across "
         "this one"),
    REAL("max_velocity", gn_wall_def, servo.max_velocity, "m/s", "(0, inf)", REQUIRED,
         "largest velocity of the wall"),
    REAL("relaxation", gn_wall_def, servo.relaxation, "1", "(0, 1]", BY("0.1"),
         "fraction of the force error corrected per step; reduced where stability of the time step "
         "requires it"),
};
TABLE_OF(servo);

static const gn_key wall_keys[] = {
    NAME("name", gn_wall_def, name, REQUIRED, "name by which the rest of the scene refers to it"),
    VECTOR("point", gn_wall_def, point, "m", GN_PLACES, REQUIRED, "a point of the plane"),
    VECTOR("normal", gn_wall_def, normal, "1", NULL, REQUIRED,
           "towards the particles; of any length"),
    REAL("stiffness", gn_wall_def, stiffness, "N/m", GN_SPRINGS, OR("none", 0),
         "penalty stiffness k_n; needed by every law but hertz"),
    TEXT("material", gn_wall_def, material, BY(""),
         "with hertz: name of the wall's material; left out: rigid, with its own friction and the "
         "restitution of the particles",
         PRESENT(TEXT, gn_wall_def, material)),
    REAL("kratio", gn_wall_def, kratio, "1", GN_RATIOS, OR("none", 0),
         "k_n/k_t of the wall; needed with friction"),
    SIDE_FRICTIONS(gn_wall_def),
    CHOICE("passive", gn_wall_def, passive, gn_booleans, BY("false"),
           "initial overlaps of particles with the wall are free of stress, as bonds with "
           "passive_gaps: a platen on a cut face"),
    SECTION("motion", wall_motion_section, .offset = offsetof(gn_wall_def, motion),
            .text = "velocity of the wall; free components are zero"),
    SECTION("servo", servo_section, PRESENT(BOOL, gn_wall_def, servo.active),
            .text = "moves the wall along its normal so that it carries a target force"),
};
ELEMENTS_OF(wall, gn_wall_def);

/* ---- neighbours, run ---- */

static const gn_key neighbours_keys[] = {
    REAL("skin", gn_scene, skin, "m", "[1e-12, 1e9]", OR("auto", 0),
         "extra distance of the neighbour list, so that it is rebuilt rarely; raised to the "
         "largest relative displacement of two particles in a step"),
};
TABLE_OF(neighbours);

static const gn_key run_keys[] = {
    KEY("seed", SEED, gn_scene, seed, .fallback = "1", .text = "seed of all random numbers"),
    INTEGER("threads", gn_scene, threads, "[0, 1024]", OR("auto", 0),
            "number of threads; auto or 0: all cores"),
    CHOICE("precision", gn_scene, precision, precisions, BY("double"),
           "precision of the kernels of contacts and elements (displacement form); mixed: single, "
           "with positions and motion in double"),
    CHOICE("isa", gn_scene, isa, isas, BY("auto"),
           "instruction set of the kernels; auto: the widest one of the machine",
           PLACED(gn_scene, isa_where)),
    REAL("residual_warning", gn_scene, residual_warning, "1", "(0, inf)", BY("1 %"),
         "residual of the energy ledger, over the energy exchanged, above which a run ends with a "
         "warning",
         .word = "off"),
    REAL("residual_limit", gn_scene, residual_limit, "1", "(0, inf)", BY("10 %"),
         "residual of the energy ledger, over the energy exchanged, above which a run is invalid: "
         "it stops, or ends, with exit code 5",
         .word = "off"),
};
TABLE_OF(run);

static const gn_key scene_keys[] = {
    TEXT("title", gn_scene, title, BY(""), "one line for reports", .packing = true),
    INTEGER("dimension", gn_scene, dimension, "[2, 3]", BY("3"),
            "2: discs in plane strain; 3: spheres", .packing = true),
    VECTOR("origin", gn_scene, origin, "m", GN_PLACES, PRESENT(BOOL, gn_scene, has_origin),
           "origin of the coordinates of the computation; left out: near the model if that lies "
           "far from 0, else 0",
           .packing = true),
    SECTION("specimen", gn_specimen_section, PRESENT(BOOL, gn_scene, specimen_given),
            .packing = true,
            .text = "the particles at the start; specimen, sources, elements or several of them"),
    ARRAY("materials", LIST, gn_scene, materials, material_count, .section = &material_section,
          .range = "[1, 1000]", PRESENT(COUNT, gn_scene, material_count),
          .text = "materials of particles; needed with a specimen"),
    ARRAY("contacts", LIST, gn_scene, contacts, contact_count, .section = &gn_contact_section,
          .range = "[0, 10000]",
          .text = "values of contacts between two materials (or one with itself) that replace "
                  "those from the materials"),
    SECTION("law", law_section, PRESENT(BOOL, gn_scene, has_law),
            .text = "the contact law; needed with a specimen"),
    SECTION("elements", gn_elements_section, PRESENT(BOOL, gn_scene, has_elements),
            .text = "finite elements: linear triangles in plane strain or tetrahedra"),
    SECTION("couple", gn_couple_section, PRESENT(BOOL, gn_scene, has_couple),
            .text = "coupling of particles and elements in zones that both share"),
    SECTION("bonds", bonds_section, .text = "brittle bonds between particles of one group"),
    SECTION("damping", damping_section, .text = "dissipation in addition to friction and breakage"),
    VARYING("gravity", gn_scene, gravity, "m/s2", GN_ACCELERATIONS, BY("0"),
            "acceleration of free fall"),
    SECTION("initial", initial_section, .text = "the state at the start"),
    SECTION("periodic", periodic_section, PRESENT(BOOL, gn_scene, has_periodic),
            .text = "a periodic box"),
    SECTION("domain", domain_section, .text = "region of space that particles must not leave"),
    ARRAY("sets", LIST, gn_scene, sets, set_count, .section = &set_section, .range = "[0, 10000]",
          .text =
              "selections of particles and actions on them; a later one overrides an earlier one"),
    ARRAY("walls", LIST, gn_scene, walls, wall_count, .section = &wall_section,
          .range = "[0, 10000]", .text = "plane walls"),
    ARRAY("bodies", LIST, gn_scene, bodies, body_count, .section = &gn_body_section,
          .range = "[0, 1000]", .text = "rigid bodies with a surface of triangles (2D: segments)"),
    ARRAY("joints", LIST, gn_scene, joints, joint_count, .section = &gn_joint_section,
          .range = "[0, 10000]",
          .text = "joints in the specimen; contacts that cross one follow the law of the joint"),
    ARRAY("sources", LIST, gn_scene, sources, source_count, .section = &gn_source_section,
          .range = "[0, 1000]", .text = "regions where particles are created during the run"),
    ARRAY("sinks", LIST, gn_scene, sinks, sink_count, .section = &gn_sink_section,
          .range = "[0, 1000]",
          .text = "regions where particles are removed and counted; each sink takes those that "
                  "earlier ones leave"),
    SECTION("clumps", gn_clumps_section, .offset = offsetof(gn_scene, clumps),
            PRESENT(BOOL, gn_scene, has_clumps),
            .text = "rigid clumps of particles that may overlap within one"),
    SECTION("membrane", gn_membrane_section, PRESENT(BOOL, gn_scene, has_membrane),
            .text = "pressure on the surface of the specimen"),
    SECTION("test", gn_test_section, PRESENT(ENUM, gn_scene, test.kind),
            .text = "a laboratory test, for which stress and strain are read"),
    SECTION("time", gn_time_section, .required = true, .text = "step and duration"),
    ARRAY("stages", LIST, gn_scene, stages, stage_count, .section = &gn_stage_section,
          .range = "[1, 1000]", PRESENT(COUNT, gn_scene, stage_count),
          .text = "consecutive stages of the run; left out: one stage"),
    SECTION("output", gn_output_section, .packing = true, .text = "files that a run writes"),
    SECTION("neighbours", neighbours_section, .text = "the neighbour list"),
    SECTION("run", run_section, .packing = true, .text = "execution of the run; no physics"),
};

const gn_section gn_scene_section = {KEYS_OF(scene), 0, GN_NO_WHERE};
