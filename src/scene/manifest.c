#include "scene/manifest_keys.h"

/* ---- words ---- */

static const gn_choice switches[] = {
    {"auto", GN_SWITCH_AUTO}, {"on", GN_SWITCH_ON},  {"off", GN_SWITCH_OFF}, {"true", GN_SWITCH_ON},
    {"false", GN_SWITCH_OFF}, {"yes", GN_SWITCH_ON}, {"no", GN_SWITCH_OFF},  {NULL, 0}};
static const gn_choice booleans[] = {{"true", 1}, {"false", 0}, {"on", 1}, {"off", 0},
                                     {"yes", 1},  {"no", 0},    {NULL, 0}};
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
static const gn_choice axes[] = {{"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
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
    KEY("name", NAME, gn_material, name, .required = true,
        .text = "name by which the rest of the scene refers to it"),
    KEY("density", REAL, gn_material, density, .unit = "kg/m3", .range = GN_DENSITIES,
        .required = true,
        .text = "mass density, of particles or of the bulk (specimen.density_basis)"),
    KEY("contact_modulus", REAL, gn_material, contact_modulus, .unit = "Pa", .range = GN_MODULI,
        .word = "none", .fallback = "none",
        .text = "E_c: normal stiffness over radius; needed by every law but uniform, hertz and "
                "those by area"),
    KEY("normal_stiffness", REAL, gn_material, normal_stiffness, .unit = "N/m", .range = GN_SPRINGS,
        .word = "none", .fallback = "none",
        .text = "k_n of every contact; needed by the uniform law"),
    KEY("kratio", REAL, gn_material, kratio, .unit = "1", .range = "[0, 1e12]", .word = "none",
        .word_value = -1, .fallback = "none",
        .text =
            "k_n/k_t; 0: no tangential spring; needed by every law but those by area and hertz"),
    KEY("young", REAL, gn_material, young, .unit = "Pa", .range = GN_MODULI, .word = "none",
        .fallback = "none", .text = "E: k_n = alpha E A/L; needed by laws by area and hertz"),
    KEY("poisson", REAL, gn_material, poisson, .unit = "1", .range = "(-1, 0.5]", .word = "none",
        .word_value = -2, .fallback = "none",
        .text = "nu: k_t = beta G A/L with G = E/(2 (1 + nu)); needed by laws by area and hertz"),
    KEY("alpha", REAL, gn_material, alpha, .unit = "1", .range = "[1e-6, 1e6]", .fallback = "1",
        .text = "factor of E in k_n; laws by area"),
    KEY("beta", REAL, gn_material, beta, .unit = "1", .range = "[0, 1e6]", .fallback = "1",
        .text = "factor of G in k_t; 0: no tangential spring; laws by area"),
    KEY("friction", REAL, gn_material, friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0", .text = "Coulomb friction coefficient"),
    KEY("rolling_friction", REAL, gn_material, rolling_friction, .unit = "1", .range = GN_FRICTIONS,
        .fallback = "0",
        .text = "mu_r: contacts resist rolling up to the moment mu_r R |f_n|, R the reduced "
                "radius; 0: no resistance"),
    KEY("twisting_friction", REAL, gn_material, twisting_friction, .unit = "1",
        .range = GN_FRICTIONS, .fallback = "0",
        .text = "mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced "
                "radius; 0: no resistance"),
    KEY("restitution", REAL, gn_material, restitution, .unit = "1", .range = "[0, 1]",
        .word = "none", .word_value = -1, .fallback = "none",
        .text = "with hertz: restitution coefficient of its contacts, the smaller one of two "
                "materials; none: that of damping.contact"),
    KEY("tensile_strength", REAL, gn_material, tensile_strength, .unit = "Pa",
        .range = GN_STRENGTHS, .word = "none", .fallback = "none",
        .text = "sigma_c of a bond; needed with bonds by every law but uniform"),
    KEY("shear_strength", REAL, gn_material, shear_strength, .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "tau_c of a bond; needed with bonds by every law but uniform"),
    KEY("bond_tension_limit", REAL, gn_material, bond_tension_limit, .unit = "N",
        .range = GN_BREAKING, .word = "none", .fallback = "none",
        .text = "R_n: normal force at which a bond breaks; needed with bonds by the uniform law"),
    KEY("bond_shear_limit", REAL, gn_material, bond_shear_limit, .unit = "N", .range = GN_BREAKING,
        .word = "none", .fallback = "none",
        .text = "R_t: shear force at which a bond breaks; needed with bonds by the uniform law"),
    SCATTER("strength_scatter", strength_scatter,
            "random factor of mean 1, drawn for each bond, of its strengths in tension and shear"),
    SCATTER("stiffness_scatter", stiffness_scatter,
            "random factor of mean 1, drawn for each bond, of its normal and tangential stiffness"),
    KEY("bond_friction", REAL, gn_material, bond_friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0",
        .text = "mu_1: a bond under compression |f_n| has its shear strength raised by mu_1 |f_n|; "
                "once broken it has friction instead"),
    KEY("fracture_energy", REAL, gn_material, fracture_energy, .unit = "J/m2",
        .range = GN_TOUGHNESSES, .word = "none", .fallback = "none",
        .text = "G_f in tension, per area of a bond; needed with softening energy"),
    KEY("shear_fracture_energy", REAL, gn_material, shear_fracture_energy, .unit = "J/m2",
        .range = GN_TOUGHNESSES, .word = "auto", .word_value = GN_SHEAR_ENERGY_AUTO,
        .other_word = "none", .other_value = 0, .fallback = "auto",
        .text = "G_f in shear without pressure, per area of a bond; auto: bonds soften over the "
                "same multiple of the elastic limit as in tension; none: brittle in shear"),
    KEY("fracture_strain", REAL, gn_material, fracture_strain, .unit = GN_STRAIN,
        .range = GN_BREAKING, .word = "none", .fallback = "none",
        .text = "eps_f: elongation of a bond over its length at the end of softening; needed with "
                "softening strain"),
    KEY("shear_fracture_strain", REAL, gn_material, shear_fracture_strain, .unit = GN_STRAIN,
        .range = GN_BREAKING, .word = "none", .fallback = "none",
        .text = "slip of a bond over the root of its area at the end of softening in shear; none: "
                "brittle in shear"),
    KEY("fracture_ratio", REAL, gn_material, fracture_ratio, .unit = "1", .range = GN_BREAKING,
        .word = "none", .fallback = "none",
        .text =
            "softening ends at 1 + this times the elastic limit, in tension and in shear; needed "
            "with softening ratio"),
    KEY("yield_stress_1", REAL, gn_material, yield_stress[0], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond above which its loading stiffness is "
                "k_n/yield_ratio_1; it unloads with k_n"),
    KEY("yield_ratio_1", REAL, gn_material, yield_ratio[0], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none",
        .text = "k_n over the loading stiffness above yield_stress_1; needed with it"),
    KEY("yield_stress_2", REAL, gn_material, yield_stress[1], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond, above yield_stress_1, above which its loading "
                "stiffness is k_n/yield_ratio_2"),
    KEY("yield_ratio_2", REAL, gn_material, yield_ratio[1], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none",
        .text = "k_n over the loading stiffness above yield_stress_2; needed with it"),
    KEY("yield_stress_3", REAL, gn_material, yield_stress[2], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond, above yield_stress_2, above which its loading "
                "stiffness is k_n/yield_ratio_3"),
    KEY("yield_ratio_3", REAL, gn_material, yield_ratio[2], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none",
        .text = "k_n over the loading stiffness above yield_stress_3; needed with it"),
};
ELEMENTS_OF(material, gn_material);

/* ---- law, bonds, damping ---- */

static const gn_key law_keys[] = {
    KEY("stiffness", CHOICE, gn_scene, stiffness, .choices = stiffness_models, .required = true,
        .text = "stiffness and bond strength from the radii (Rojek et al. 2012, sec. 2), or from "
                "E, nu and sections of the bonds (dempack, polyhedron: Santasusana 2013); hertz: "
                "unbonded spheres, by Hertz and Mindlin from E and nu"),
    KEY("gamma", REAL, gn_scene, gamma, .unit = "1", .range = "[1e-6, 1e6]", .word = "auto",
        .fallback = "auto",
        .text = "section of a bond over Dempack's pi (2 r_i r_j/(r_i + r_j))^2 (2D: 4 r_i r_j/(r_i "
                "+ r_j) times 1 m); with polyhedron, of pairs that come into contact later"),
    KEY("gamma_rule", CHOICE, gn_scene, gamma_rule, .choices = gamma_rules, .fallback = "volume",
        .text = "rule for gamma: auto; volume: the sum of sections times lengths equals the "
                "dimension times the volume; porosity: 40 e/n_c (Santasusana 2013)"),
    KEY("contact_arm", CHOICE, gn_scene, contact_arm, .choices = contact_arms,
        .fallback = "midpoint",
        .text = "contact point: midpoint of the gap, or one radius from the centre"),
    KEY("pull", CHOICE, gn_scene, pull, .choices = booleans, .fallback = "true",
        .text =
            "with hertz: the dashpot may exert tension at the end of a collision; false: the total "
            "force is cut off at zero, and the dashpot is adjusted to keep the restitution"),
    KEY("rotation", CHOICE, gn_scene, rotation, .choices = switches, .fallback = "auto",
        .text = "particles rotate; auto: on"),
    KEY("coupling", CHOICE, gn_scene, coupling, .choices = couplings, .fallback = "none",
        .text = "reduction of a bond's shear strength by tension; quadratic: the bond breaks when "
                "the squares of force over strength add up to 1; linear: by mu_1 f_n"),
    KEY("confinement", CHOICE, gn_scene, confinement, .choices = confinements, .fallback = "own",
        .text = "normal force that the friction of bonds (bond_friction) acts on: own: that of the "
                "bond; mean: that of the mean stress around its two particles"),
    KEY("softening", CHOICE, gn_scene, softening, .choices = softenings, .fallback = "none",
        .text = "behaviour of bonds beyond their strength: none: they break at once; else they "
                "soften up to the fracture energy, strain or ratio of the material"),
    KEY("softening_curve", CHOICE, gn_scene, softening_curve, .choices = curves,
        .fallback = "linear",
        .text =
            "with softening energy: linear, or bilinear: steep first, then flat, as for concrete"),
    KEY("kink_stress", REAL, gn_scene, kink_stress, .unit = "1", .range = "[0.01, 0.99]",
        .fallback = "0.3333333333333333",
        .text = "bilinear: fraction of the strength at the kink; Petersson: a third"),
    KEY("initial_energy", REAL, gn_scene, initial_energy, .unit = "1", .range = "[0.01, 0.99]",
        .fallback = "0.6",
        .text = "bilinear: fraction of the fracture energy under the first line, extended to zero; "
                "Petersson: 0.6"),
    KEY("fracture_energy_of", CHOICE, gn_scene, fracture_energy_of, .choices = fractures,
        .fallback = "contact",
        .text = "area that fracture energies refer to: contact: that of a bond; body: that of a "
                "plane through the specimen, whose bonds have a larger total area"),
};
static const gn_section law_section = {law_keys, sizeof law_keys / sizeof(gn_key), 0,
                                       offsetof(gn_scene, law_where)};

static const gn_key bonds_keys[] = {
    KEY("enabled", CHOICE, gn_scene, bonds, .choices = switches, .fallback = "auto",
        .text = "auto: on when the scene has a bonds section"),
    KEY("interaction_range", REAL, gn_scene, interaction_range, .unit = "1", .range = "[0, 100]",
        .fallback = "0.05", .text = "bonds form at gaps up to this times the sum of the radii"),
    KEY("overlap_range", REAL, gn_scene, overlap_range, .unit = "1", .range = "[0, 1]",
        .fallback = "1",
        .text = "bonds form at overlaps up to this times the sum of the radii; 1: unlimited (but "
                "centres of bonded particles are at least 0.01 of the smaller radius apart)"),
    KEY("passive_gaps", CHOICE, gn_scene, passive_gaps, .choices = booleans, .fallback = "true",
        .text = "bonds are free of stress at the distance at which they form, and so are initial "
                "overlaps of particles without bonds"),
    KEY("radius_multiplier", REAL, gn_scene, bond_radius_multiplier, .unit = "1",
        .range = "[0, 100]", .fallback = "0",
        .text =
            "bonds carry bending and twisting moments as beams (PFC's parallel bonds, pb_rmul) of "
            "this times the smaller radius of the two particles; 0: no moments"),
    KEY("moment_share", REAL, gn_scene, bond_moment_share, .unit = "1", .range = "[0, 1]",
        .fallback = "1",
        .text = "share of moments in the strength of bonds with radius_multiplier (PFC's moment "
                "contribution, pb_mcf)"),
};
TABLE_OF(bonds);

static const gn_key background_keys[] = {
    KEY("model", CHOICE, gn_scene, background, .choices = backgrounds, .fallback = "none",
        .text = "viscous: -a m v; nonviscous_vector: -a |F| v/|v|; nonviscous_component: -a |F_k| "
                "sign(v_k)"),
    KEY("coefficient", REAL, gn_scene, background_coefficient, .unit = "1/s|1",
        .range = "[0, 1e15]", .fallback = "0",
        .text = "a: in 1/s with viscous, otherwise a fraction in [0, 1)"),
    KEY("rotation", REAL, gn_scene, background_spin, .unit = "1/s|1", .range = "[0, 1e15]",
        .word = "same", .word_value = -1, .fallback = "same",
        .text = "a for spins, with -a I w and moments in place of forces; same: the value of "
                "coefficient (Labra 2012, eq. 2.38-2.41, has a separate one)"),
    KEY("velocity", CHOICE, gn_scene, background_velocity, .choices = damped_velocities,
        .fallback = "half_step",
        .text = "with nonviscous_component: velocity whose sign counts, that of the last half step "
                "or that at the instant, v + dt F/(2 m), as in YADE"),
};
TABLE_OF(background);

static const gn_key contact_keys[] = {
    KEY("restitution", REAL, gn_scene, restitution, .unit = "1", .range = "[0, 1]", .word = "none",
        .word_value = -1, .fallback = "none",
        .text = "restitution coefficient of a free collision"),
    KEY("fraction", REAL, gn_scene, damping_fraction, .unit = "1", .range = "(0, 1]",
        .word = "none", .fallback = "none",
        .text = "normal damping as a fraction of critical; instead of restitution"),
};
TABLE_OF(contact);

static const gn_key damping_keys[] = {
    SECTION("background", background_section, .text = "damping of the motion of every particle"),
    SECTION("contact", contact_section, .text = "normal viscous damping in contacts"),
};
TABLE_OF(damping);

/* ---- surroundings ---- */

static const gn_key pulse_keys[] = {
    KEY("direction", VECTOR, gn_scene, pulse.direction, .unit = "1", .required = true,
        .text = "direction of propagation and of displacement; of any length"),
    KEY("centre", VECTOR, gn_scene, pulse.centre, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "a point of the plane of the crest"),
    KEY("length", REAL, gn_scene, pulse.length, .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "length of the wave from front to end"),
    KEY("size", REAL, gn_scene, pulse.size, .unit = "m", .range = "[-1e9, 1e9]", .required = true,
        .text = "displacement at the crest"),
    KEY("speed", REAL, gn_scene, pulse.speed, .unit = "m/s", .range = GN_SPEEDS, .required = true,
        .text = "wave speed, sqrt(M/rho)"),
};
TABLE_OF(pulse);

static const gn_key initial_keys[] = {
    KEY("random_velocity", REAL, gn_scene, random_velocity, .unit = "m/s", .range = "[0, 3e8]",
        .fallback = "0", .text = "velocity components drawn uniformly from +- this at the start"),
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

static const gn_choice open_axes[] = {{"none", -1}, {"x", 0}, {"y", 1}, {"z", 2}, {NULL, 0}};
static const gn_key periodic_keys[] = {
    KEY("min", VECTOR, gn_scene, periodic_min, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "lower corner of the periodic box"),
    KEY("max", VECTOR, gn_scene, periodic_max, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "upper corner of the periodic box"),
    KEY("open", CHOICE, gn_scene, periodic_open, .choices = open_axes, .fallback = "none",
        .text = "axis along which the box is open, as between two plates; min and max are not read "
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
static const gn_section periodic_section = {periodic_keys, sizeof periodic_keys / sizeof(gn_key), 0,
                                            offsetof(gn_scene, periodic_where)};

static const gn_key domain_keys[] = {
    KEY("min", VECTOR, gn_scene, domain_min, .unit = "m", PRESENT(BOOL, gn_scene, has_domain),
        .text = "lower corner; default: the box of the specimen, enlarged by ten times its largest "
                "side on every side"),
    KEY("max", VECTOR, gn_scene, domain_max, .unit = "m", PRESENT(BOOL, gn_scene, has_domain),
        .text = "upper corner; given together with min"),
    KEY("lost", CHOICE, gn_scene, lost, .choices = lost_policies, .fallback = "stop",
        .text = "reaction to a particle that leaves the domain"),
};
TABLE_OF(domain);

/* ---- sets and walls ---- */

#define CHANNEL(NAME, FIELD, UNIT, RANGE, TEXT)                                                    \
    KEY(NAME, TABLE, gn_motion, FIELD, .unit = UNIT, .range = RANGE, .word = "free",               \
        .fallback = "free", .text = TEXT)

static const gn_key set_motion_keys[] = {
    CHANNEL("vx", velocity[0], "m/s", GN_SPEEDS, "prescribed velocity along x"),
    CHANNEL("vy", velocity[1], "m/s", GN_SPEEDS, "prescribed velocity along y"),
    CHANNEL("vz", velocity[2], "m/s", GN_SPEEDS, "prescribed velocity along z"),
    CHANNEL("wx", spin[0], "rad/s", GN_SPINS, "prescribed spin about x"),
    CHANNEL("wy", spin[1], "rad/s", GN_SPINS, "prescribed spin about y"),
    CHANNEL("wz", spin[2], "rad/s", GN_SPINS, "prescribed spin about z"),
};
TABLE_OF(set_motion);

static const gn_key wall_motion_keys[] = {
    CHANNEL("vx", velocity[0], "m/s", GN_SPEEDS, "velocity along x"),
    CHANNEL("vy", velocity[1], "m/s", GN_SPEEDS, "velocity along y"),
    CHANNEL("vz", velocity[2], "m/s", GN_SPEEDS, "velocity along z"),
};
TABLE_OF(wall_motion);

static const gn_key box_keys[] = {
    KEY("min", VECTOR, gn_set_def, box_min, .unit = "m", .required = true, .text = "lower corner"),
    KEY("max", VECTOR, gn_set_def, box_max, .unit = "m", .required = true, .text = "upper corner"),
};
TABLE_OF(box);

static const gn_key end_keys[] = {
    KEY("axis", CHOICE, gn_set_def, end_axis, .choices = axes, .required = true,
        .text = "axis along which the ends lie"),
    KEY("side", CHOICE, gn_set_def, end_upper, .choices = sides, .required = true,
        .text = "lower or upper end"),
    KEY("depth", REAL, gn_set_def, end_depth, .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "depth of the layer at the end of the specimen"),
    KEY("by", CHOICE, gn_set_def, end_by_surface, .choices = measures, .fallback = "centre",
        .text = "a particle is selected if its centre, or any part of its surface, lies within the "
                "depth"),
};
TABLE_OF(end);

static const gn_key select_keys[] = {
    KEY("all", CHOICE, gn_set_def, all, .choices = booleans, .fallback = "false",
        .text = "every particle"),
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
    KEY("name", NAME, gn_set_def, name, .required = true,
        .text = "name by which the rest of the scene refers to it"),
    SECTION("select", select_section, .required = true,
            .text = "selection of particles; of several conditions all must hold"),
    KEY("material", TEXT, gn_set_def, material, .fallback = "", PRESENT(TEXT, gn_set_def, material),
        .text = "name of another material than the specimen's"),
    KEY("group", INTEGER, gn_set_def, group, .range = "[0, 1000000]", .word = "keep",
        .word_value = -1, .fallback = "keep", .text = "another cohesive group than the specimen's"),
    KEY("initial_velocity", VECTOR, gn_set_def, initial_velocity, .unit = "m/s", .range = GN_SPEEDS,
        PRESENT(BOOL, gn_set_def, has_initial_velocity), .text = "velocity at the start"),
    KEY("initial_spin", SPIN, gn_set_def, initial_spin, .unit = "rad/s", .range = GN_SPINS,
        PRESENT(BOOL, gn_set_def, has_initial_spin), .text = "spin at the start; in 2D one number"),
    KEY("force", VECTOR, gn_set_def, force, .unit = "N", .range = GN_FORCES,
        PRESENT(BOOL, gn_set_def, has_force),
        .text = "total force on the set, distributed by mass"),
    SECTION("motion", set_motion_section, .offset = offsetof(gn_set_def, motion),
            .text =
                "prescribed motion; each channel free, constant or a table [[time, value], ...]"),
};
ELEMENTS_OF(set, gn_set_def);

static const gn_key servo_keys[] = {
    KEY("force", TABLE, gn_wall_def, servo.force, .unit = "N", .range = GN_FORCES, .word = "none",
        .fallback = "none",
        .text = "target normal force, compression positive; constant or a table; force or stress"),
    KEY("stress", TABLE, gn_wall_def, servo.stress, .unit = "Pa", .range = GN_TRACTIONS,
        .word = "none", .fallback = "none",
        .text = "target normal stress on the area of the wall, compression positive; constant or a "
                "table; force or stress"),
    KEY("area", REAL, gn_wall_def, servo.area, .unit = "m2", .range = GN_AREAS, .word = "auto",
        .fallback = "auto",
        .text = "area for stress; auto: the current section between the walls that face each other "
                "across this one"),
    KEY("max_velocity", REAL, gn_wall_def, servo.max_velocity, .unit = "m/s", .range = "(0, inf)",
        .required = true, .text = "largest velocity of the wall"),
    KEY("relaxation", REAL, gn_wall_def, servo.relaxation, .unit = "1", .range = "(0, 1]",
        .fallback = "0.1",
        .text = "fraction of the force error corrected per step; reduced where stability of the "
                "time step requires it"),
};
TABLE_OF(servo);

static const gn_key wall_keys[] = {
    KEY("name", NAME, gn_wall_def, name, .required = true,
        .text = "name by which the rest of the scene refers to it"),
    KEY("point", VECTOR, gn_wall_def, point, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "a point of the plane"),
    KEY("normal", VECTOR, gn_wall_def, normal, .unit = "1", .required = true,
        .text = "towards the particles; of any length"),
    KEY("stiffness", REAL, gn_wall_def, stiffness, .unit = "N/m", .range = GN_SPRINGS,
        .word = "none", .fallback = "none",
        .text = "penalty stiffness k_n; needed by every law but hertz"),
    KEY("material", TEXT, gn_wall_def, material, .fallback = "",
        PRESENT(TEXT, gn_wall_def, material),
        .text = "with hertz: name of the wall's material; left out: rigid, with its own friction "
                "and the restitution of the particles"),
    KEY("kratio", REAL, gn_wall_def, kratio, .unit = "1", .range = GN_RATIOS, .word = "none",
        .fallback = "none", .text = "k_n/k_t of the wall; needed with friction"),
    KEY("friction", REAL, gn_wall_def, friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0", .text = "Coulomb friction coefficient"),
    KEY("rolling_friction", REAL, gn_wall_def, rolling_friction, .unit = "1", .range = GN_FRICTIONS,
        .fallback = "0", .text = "mu_r, as for materials"),
    KEY("twisting_friction", REAL, gn_wall_def, twisting_friction, .unit = "1",
        .range = GN_FRICTIONS, .fallback = "0",
        .text = "mu_t: contacts resist twisting up to the moment mu_t R |f_n|, R the reduced "
                "radius; 0: no resistance"),
    KEY("passive", CHOICE, gn_wall_def, passive, .choices = booleans, .fallback = "false",
        .text = "initial overlaps of particles with the wall are free of stress, as bonds with "
                "passive_gaps: a platen on a cut face"),
    SECTION("motion", wall_motion_section, .offset = offsetof(gn_wall_def, motion),
            .text = "velocity of the wall; free components are zero"),
    SECTION("servo", servo_section, PRESENT(BOOL, gn_wall_def, servo.active),
            .text = "moves the wall along its normal so that it carries a target force"),
};
ELEMENTS_OF(wall, gn_wall_def);

/* ---- neighbours, run ---- */

static const gn_key neighbours_keys[] = {
    KEY("skin", REAL, gn_scene, skin, .unit = "m", .range = "[1e-12, 1e9]", .word = "auto",
        .fallback = "auto",
        .text = "extra distance of the neighbour list, so that it is rebuilt rarely; raised to the "
                "largest relative displacement of two particles in a step"),
};
TABLE_OF(neighbours);

static const gn_key run_keys[] = {
    KEY("seed", SEED, gn_scene, seed, .fallback = "1", .text = "seed of all random numbers"),
    KEY("threads", INTEGER, gn_scene, threads, .range = "[0, 1024]", .word = "auto",
        .fallback = "auto", .text = "number of threads; auto or 0: all cores"),
    KEY("precision", CHOICE, gn_scene, precision, .choices = precisions, .fallback = "double",
        .text = "precision of the kernels of contacts and elements (displacement form); mixed: "
                "single, with positions and motion in double"),
    KEY("isa", CHOICE, gn_scene, isa, .choices = isas, .fallback = "auto",
        PLACED(gn_scene, isa_where),
        .text = "instruction set of the kernels; auto: the widest one of the machine"),
    KEY("residual_warning", REAL, gn_scene, residual_warning, .unit = "1", .range = "(0, inf)",
        .word = "off", .fallback = "1 %",
        .text = "residual of the energy ledger, over the energy exchanged, above which a run ends "
                "with a warning"),
    KEY("residual_limit", REAL, gn_scene, residual_limit, .unit = "1", .range = "(0, inf)",
        .word = "off", .fallback = "10 %",
        .text = "residual of the energy ledger, over the energy exchanged, above which a run is "
                "invalid: it stops, or ends, with exit code 5"),
};
TABLE_OF(run);

static const gn_key scene_keys[] = {
    KEY("title", TEXT, gn_scene, title, .fallback = "", .packing = true,
        .text = "one line for reports"),
    KEY("dimension", INTEGER, gn_scene, dimension, .range = "[2, 3]", .fallback = "3",
        .packing = true, .text = "2: discs in plane strain; 3: spheres"),
    KEY("origin", VECTOR, gn_scene, origin, .unit = "m", .range = GN_PLACES,
        PRESENT(BOOL, gn_scene, has_origin), .packing = true,
        .text = "origin of the coordinates of the computation; left out: near the model if that "
                "lies far from 0, else 0"),
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
    KEY("gravity", VECTOR, gn_scene, gravity, .unit = "m/s2", .range = GN_ACCELERATIONS,
        .fallback = "0", .text = "acceleration of free fall"),
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
    ARRAY("sources", LIST, gn_scene, sources, source_count, .section = &gn_source_section,
          .range = "[0, 1000]", .text = "regions where particles are created during the run"),
    ARRAY("sinks", LIST, gn_scene, sinks, sink_count, .section = &gn_sink_section,
          .range = "[0, 1000]",
          .text = "regions where particles are removed and counted; each sink takes those that "
                  "earlier ones leave"),
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

const gn_section gn_scene_section = {scene_keys, sizeof scene_keys / sizeof(gn_key), 0,
                                     GN_NO_WHERE};
