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
        .text = "what the rest of the scene calls it"),
    KEY("density", REAL, gn_material, density, .unit = "kg/m3", .range = GN_DENSITIES,
        .required = true,
        .text = "mass density, of particles or of the bulk (specimen.density_basis)"),
    KEY("contact_modulus", REAL, gn_material, contact_modulus, .unit = "Pa", .range = GN_MODULI,
        .word = "none", .fallback = "none",
        .text = "E_c: normal stiffness over radius; needed by every law but uniform, hertz and "
                "those by "
                "area"),
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
        .text =
            "mu_r: contacts resist rolling up to the moment mu_r R |f_n|, R the reduced radius; "
            "0: they roll freely"),
    KEY("twisting_friction", REAL, gn_material, twisting_friction, .unit = "1",
        .range = GN_FRICTIONS, .fallback = "0", .text = "the same against twisting"),
    KEY("restitution", REAL, gn_material, restitution, .unit = "1", .range = "[0, 1]",
        .word = "none", .word_value = -1, .fallback = "none",
        .text =
            "with hertz: restitution coefficient of its contacts, of two the smaller; none: that "
            "of damping.contact"),
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
    SCATTER(
        "strength_scatter", strength_scatter,
        "strengths of a bond, in tension and shear, times a number drawn for it, 1 in the mean"),
    SCATTER("stiffness_scatter", stiffness_scatter,
            "both stiffnesses of a bond times a number drawn for it, 1 in the mean"),
    KEY("bond_friction", REAL, gn_material, bond_friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0",
        .text = "mu_1: a bond pressed by |f_n| holds mu_1 |f_n| more in shear; once broken it has "
                "friction instead"),
    KEY("fracture_energy", REAL, gn_material, fracture_energy, .unit = "J/m2",
        .range = GN_TOUGHNESSES, .word = "none", .fallback = "none",
        .text = "G_f in tension, per area of a bond; needed with softening energy"),
    KEY("shear_fracture_energy", REAL, gn_material, shear_fracture_energy, .unit = "J/m2",
        .range = GN_TOUGHNESSES, .word = "auto", .word_value = GN_SHEAR_ENERGY_AUTO,
        .other_word = "none", .other_value = 0, .fallback = "auto",
        .text = "the same in shear without pressure; auto: bonds soften over as many elastic "
                "limits as in tension; none: brittle in shear"),
    KEY("fracture_strain", REAL, gn_material, fracture_strain, .unit = GN_STRAIN,
        .range = GN_BREAKING, .word = "none", .fallback = "none",
        .text = "eps_f: stretch of a bond over its length where its softening ends; needed with "
                "softening strain"),
    KEY("shear_fracture_strain", REAL, gn_material, shear_fracture_strain, .unit = GN_STRAIN,
        .range = GN_BREAKING, .word = "none", .fallback = "none",
        .text = "the same in shear, over the root of its area; none: brittle in shear"),
    KEY("fracture_ratio", REAL, gn_material, fracture_ratio, .unit = "1", .range = GN_BREAKING,
        .word = "none", .fallback = "none",
        .text =
            "softening ends at 1 + this times the elastic limit, in tension and in shear; needed "
            "with softening ratio"),
    KEY("yield_stress_1", REAL, gn_material, yield_stress[0], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond from which on it loads with k_n/yield_ratio_1; it "
                "unloads with k_n"),
    KEY("yield_ratio_1", REAL, gn_material, yield_ratio[0], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none", .text = "needed with yield_stress_1"),
    KEY("yield_stress_2", REAL, gn_material, yield_stress[1], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond from which on it loads with k_n/yield_ratio_2, above "
                "the one before"),
    KEY("yield_ratio_2", REAL, gn_material, yield_ratio[1], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none", .text = "needed with yield_stress_2"),
    KEY("yield_stress_3", REAL, gn_material, yield_stress[2], .unit = "Pa", .range = GN_STRENGTHS,
        .word = "none", .fallback = "none",
        .text = "compressive stress of a bond from which on it loads with k_n/yield_ratio_3, above "
                "the one before"),
    KEY("yield_ratio_3", REAL, gn_material, yield_ratio[2], .unit = "1", .range = "[1, 1e9]",
        .word = "none", .fallback = "none", .text = "needed with yield_stress_3"),
};
ELEMENTS_OF(material, gn_material);

/* ---- law, bonds, damping ---- */

static const gn_key law_keys[] = {
    KEY("stiffness", CHOICE, gn_scene, stiffness, .choices = stiffness_models, .required = true,
        .text = "how stiffness and bond strength follow from the radii (Rojek et al. 2012, sec. "
                "2), or from E, nu and sections of the bonds (dempack, polyhedron: Santasusana "
                "2013); hertz: spheres that are not bonded, by Hertz and Mindlin from E and nu"),
    KEY("gamma", REAL, gn_scene, gamma, .unit = "1", .range = "[1e-6, 1e6]", .word = "auto",
        .fallback = "auto",
        .text = "section of a bond over Dempack's pi (2 r_i r_j/(r_i + r_j))^2 (2D: 4 r_i r_j/(r_i "
                "+ r_j) times 1 m); with polyhedron, of pairs that meet later"),
    KEY("gamma_rule", CHOICE, gn_scene, gamma_rule, .choices = gamma_rules, .fallback = "volume",
        .text = "gamma when it is auto; volume: such that sections times lengths add up to the "
                "dimension times the volume; porosity: 40 e/n_c of the source"),
    KEY("contact_arm", CHOICE, gn_scene, contact_arm, .choices = contact_arms,
        .fallback = "midpoint",
        .text = "contact point: midpoint of the gap, or one radius from the centre"),
    KEY("pull", CHOICE, gn_scene, pull, .choices = booleans, .fallback = "true",
        .text =
            "with hertz, whether the dashpot may pull at the end of a collision; false: the sum "
            "of both forces is cut at zero, and the dashpot is as strong as that asks for"),
    KEY("rotation", CHOICE, gn_scene, rotation, .choices = switches, .fallback = "auto",
        .text = "whether particles spin; auto: on"),
    KEY("coupling", CHOICE, gn_scene, coupling, .choices = couplings, .fallback = "none",
        .text = "what tension takes from a bond's strength in shear; quadratic: the bond breaks "
                "where the squares of force over strength add up to 1; linear: it takes mu_1 f_n"),
    KEY("confinement", CHOICE, gn_scene, confinement, .choices = confinements, .fallback = "own",
        .text = "what the friction of bonds (bond_friction) sees: own: the normal force of the "
                "bond; mean: the mean stress around its two particles"),
    KEY("softening", CHOICE, gn_scene, softening, .choices = softenings, .fallback = "none",
        .text = "bonds beyond their strength: none: they break at once; else they soften linearly, "
                "down to the fracture energy, strain or ratio of the material"),
    KEY("softening_curve", CHOICE, gn_scene, softening_curve, .choices = curves,
        .fallback = "linear",
        .text = "how bonds soften by energy: linear, or bilinear: steep first, then flat, as "
                "concrete does"),
    KEY("kink_stress", REAL, gn_scene, kink_stress, .unit = "1", .range = "[0.01, 0.99]",
        .fallback = "0.3333333333333333",
        .text = "bilinear: share of the strength where the two lines meet; Petersson: a third"),
    KEY("initial_energy", REAL, gn_scene, initial_energy, .unit = "1", .range = "[0.01, 0.99]",
        .fallback = "0.6",
        .text = "bilinear: share of the fracture energy under the first line drawn to its end; "
                "Petersson: 0.6"),
    KEY("fracture_energy_of", CHOICE, gn_scene, fracture_energy_of, .choices = fractures,
        .fallback = "contact",
        .text = "what the fracture energies of materials are per area of: contact: of a bond; "
                "body: of a plane through the specimen, which cuts more bond area than its own"),
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
                "centres "
                "of bonded particles stand apart by 0.01 of the smaller radius)"),
    KEY("passive_gaps", CHOICE, gn_scene, passive_gaps, .choices = booleans, .fallback = "true",
        .text = "bonds are free of stress at the distance where they form, and so are the overlaps "
                "of the start between particles that are not bonded"),
    KEY("radius_multiplier", REAL, gn_scene, bond_radius_multiplier, .unit = "1",
        .range = "[0, 100]", .fallback = "0",
        .text =
            "bonds carry bending and twisting moments as beams (PFC's parallel bonds, pb_rmul) of "
            "this times the smaller radius of the two particles; 0: no moments"),
    KEY("moment_share", REAL, gn_scene, bond_moment_share, .unit = "1", .range = "[0, 1]",
        .fallback = "1",
        .text =
            "share of moments in the strength of such bonds (PFC's moment contribution, pb_mcf)"),
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
        .text = "a of spins: -a I w and so on with moments; same: the coefficient (Labra 2012, eq. "
                "2.38-2.41, has one of its own)"),
    KEY("velocity", CHOICE, gn_scene, background_velocity, .choices = damped_velocities,
        .fallback = "half_step",
        .text = "with nonviscous_component, whose sign counts: that of the last half step, or of "
                "the instant, v + dt F/(2 m), as in YADE"),
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
        .text = "in which it runs and in which it moves the body; of any length"),
    KEY("centre", VECTOR, gn_scene, pulse.centre, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "a point of the plane of its crest"),
    KEY("length", REAL, gn_scene, pulse.length, .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "from its front to its end"),
    KEY("size", REAL, gn_scene, pulse.size, .unit = "m", .range = "[-1e9, 1e9]", .required = true,
        .text = "displacement at the crest"),
    KEY("speed", REAL, gn_scene, pulse.speed, .unit = "m/s", .range = GN_SPEEDS, .required = true,
        .text = "of the wave, sqrt(M/rho)"),
};
TABLE_OF(pulse);

static const gn_key initial_keys[] = {
    KEY("random_velocity", REAL, gn_scene, random_velocity, .unit = "m/s", .range = "[0, 3e8]",
        .fallback = "0", .text = "velocity components drawn uniformly from +- this at the start"),
    SECTION("pulse", pulse_section, PRESENT(BOOL, gn_scene, has_pulse),
            .text =
                "a plane wave of the shape 1 + cos that is under way at the start, in particles "
                "and elements"),
};
TABLE_OF(initial);

#define SIDE(AXIS, K)                                                                              \
    static const gn_key side_##AXIS##_keys[] = {                                                   \
        KEY("stress", TABLE, gn_scene, box[K].stress, .unit = "Pa", .range = GN_TRACTIONS,         \
            .word = "none", .fallback = "none",                                                    \
            .text = "wanted mean normal stress of the specimen along this axis, compression "      \
                    "positive; constant or a table; stress or rate"),                              \
        KEY("rate", TABLE, gn_scene, box[K].rate, .unit = "1/s", .range = "[-1e6, 1e6]",           \
            .word = "none", .fallback = "none",                                                    \
            .text = "prescribed growth of the length of the box over its length",                  \
            PLACED(gn_scene, box[K].rate_where)),                                                  \
        KEY("max_rate", REAL, gn_scene, box[K].max_rate, .unit = "1/s", .range = "(0, 1e6]",       \
            .word = "none", .fallback = "none",                                                    \
            .text = "needed with stress: most by which the box may shorten or grow"),              \
        KEY("relaxation", REAL, gn_scene, box[K].relaxation, .unit = "1", .range = "(0, 1]",       \
            .word = "auto", .fallback = "auto",                                                    \
            .text = "with stress: share of what is missing that is made up per step; less where "  \
                    "that would not be stable with the time step; auto: 0.1"),                     \
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
        .text = "axis along which the box has no sides, as between two plates; min and max have no "
                "use along it"),
    SECTION("x", side_x_section,
            .text = "how the length of the box along x follows a stress or a "
                    "rate; its lower corner stands still"),
    SECTION("y", side_y_section, .text = "the same along y"),
    SECTION("z", side_z_section, .text = "the same along z"),
};
static const gn_section periodic_section = {periodic_keys, sizeof periodic_keys / sizeof(gn_key), 0,
                                            offsetof(gn_scene, periodic_where)};

static const gn_key domain_keys[] = {
    KEY("min", VECTOR, gn_scene, domain_min, .unit = "m", PRESENT(BOOL, gn_scene, has_domain),
        .text =
            "lower corner; without it the box of the specimen, enlarged by ten times its largest "
            "side on every side"),
    KEY("max", VECTOR, gn_scene, domain_max, .unit = "m", PRESENT(BOOL, gn_scene, has_domain),
        .text = "upper corner; given together with min"),
    KEY("lost", CHOICE, gn_scene, lost, .choices = lost_policies, .fallback = "stop",
        .text = "what happens to a run when a particle leaves the domain"),
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
        .text = "along which the specimen has two ends"),
    KEY("side", CHOICE, gn_set_def, end_upper, .choices = sides, .required = true,
        .text = "which end"),
    KEY("depth", REAL, gn_set_def, end_depth, .unit = "m", .range = GN_LENGTHS, .required = true,
        .text = "how far from the end of the specimen"),
    KEY("by", CHOICE, gn_set_def, end_by_surface, .choices = measures, .fallback = "centre",
        .text = "what lies within the depth: the centre or any part of the surface"),
};
TABLE_OF(end);

static const gn_key select_keys[] = {
    KEY("all", CHOICE, gn_set_def, all, .choices = booleans, .fallback = "false",
        .text = "every particle"),
    SECTION("box", box_section, PRESENT(BOOL, gn_set_def, has_box),
            .text = "particles whose centres lie in a box"),
    ARRAY("ids", IDS, gn_set_def, ids, id_count, .range = "[0, 1e15]",
          PRESENT(COUNT, gn_set_def, id_count),
          .text = "particles by index, base 0, in the order of the specimen"),
    SECTION("end", end_section, PRESENT(AXIS, gn_set_def, end_axis),
            .text = "particles at one end of the specimen"),
};
TABLE_OF(select);

static const gn_key set_keys[] = {
    KEY("name", NAME, gn_set_def, name, .required = true,
        .text = "what the rest of the scene calls it"),
    SECTION("select", select_section, .required = true,
            .text = "which particles; of several conditions all must hold"),
    KEY("material", TEXT, gn_set_def, material, .fallback = "", PRESENT(TEXT, gn_set_def, material),
        .text = "name of another material than the specimen's"),
    KEY("group", INTEGER, gn_set_def, group, .range = "[0, 1000000]", .word = "keep",
        .word_value = -1, .fallback = "keep", .text = "another cohesive group than the specimen's"),
    KEY("initial_velocity", VECTOR, gn_set_def, initial_velocity, .unit = "m/s", .range = GN_SPEEDS,
        PRESENT(BOOL, gn_set_def, has_initial_velocity), .text = "velocity at the start"),
    KEY("initial_spin", SPIN, gn_set_def, initial_spin, .unit = "rad/s", .range = GN_SPINS,
        PRESENT(BOOL, gn_set_def, has_initial_spin), .text = "spin at the start; in 2D one number"),
    KEY("force", VECTOR, gn_set_def, force, .unit = "N", .range = GN_FORCES,
        PRESENT(BOOL, gn_set_def, has_force), .text = "total force on the set, shared out by mass"),
    SECTION("motion", set_motion_section, .offset = offsetof(gn_set_def, motion),
            .text =
                "prescribed motion; each channel free, constant or a table [[time, value], ...]"),
};
ELEMENTS_OF(set, gn_set_def);

static const gn_key servo_keys[] = {
    KEY("force", TABLE, gn_wall_def, servo.force, .unit = "N", .range = GN_FORCES, .word = "none",
        .fallback = "none",
        .text = "wanted normal force, compression positive; constant or a table; force or stress"),
    KEY("stress", TABLE, gn_wall_def, servo.stress, .unit = "Pa", .range = GN_TRACTIONS,
        .word = "none", .fallback = "none", .text = "the same over the area of the wall"),
    KEY("area", REAL, gn_wall_def, servo.area, .unit = "m2", .range = GN_AREAS, .word = "auto",
        .fallback = "auto",
        .text =
            "with stress; auto: between the walls that face each other across this one, as they "
            "stand at the time"),
    KEY("max_velocity", REAL, gn_wall_def, servo.max_velocity, .unit = "m/s", .range = "(0, inf)",
        .required = true, .text = "limit of the wall's velocity"),
    KEY("relaxation", REAL, gn_wall_def, servo.relaxation, .unit = "1", .range = "(0, 1]",
        .fallback = "0.1",
        .text = "fraction of the force error corrected per step; less where that would not be "
                "stable with the time step"),
};
TABLE_OF(servo);

static const gn_key wall_keys[] = {
    KEY("name", NAME, gn_wall_def, name, .required = true,
        .text = "what the rest of the scene calls it"),
    KEY("point", VECTOR, gn_wall_def, point, .unit = "m", .range = GN_PLACES, .required = true,
        .text = "a point of the plane"),
    KEY("normal", VECTOR, gn_wall_def, normal, .unit = "1", .required = true,
        .text = "into the side where the particles are; of any length"),
    KEY("stiffness", REAL, gn_wall_def, stiffness, .unit = "N/m", .range = GN_SPRINGS,
        .word = "none", .fallback = "none",
        .text = "penalty stiffness k_n; needed by every law but hertz"),
    KEY("material", TEXT, gn_wall_def, material, .fallback = "",
        PRESENT(TEXT, gn_wall_def, material),
        .text =
            "with hertz: what it is made of; left out: rigid, with a friction of its own and the "
            "restitution of the particles"),
    KEY("kratio", REAL, gn_wall_def, kratio, .unit = "1", .range = GN_RATIOS, .word = "none",
        .fallback = "none", .text = "k_n/k_t of the wall; needed with friction"),
    KEY("friction", REAL, gn_wall_def, friction, .unit = GN_SLOPE, .range = GN_FRICTIONS,
        .fallback = "0", .text = "Coulomb friction coefficient"),
    KEY("rolling_friction", REAL, gn_wall_def, rolling_friction, .unit = "1", .range = GN_FRICTIONS,
        .fallback = "0", .text = "mu_r, as of materials"),
    KEY("twisting_friction", REAL, gn_wall_def, twisting_friction, .unit = "1",
        .range = GN_FRICTIONS, .fallback = "0", .text = "the same against twisting"),
    KEY("passive", CHOICE, gn_wall_def, passive, .choices = booleans, .fallback = "false",
        .text = "particles that overlap the wall at the start are stress-free there, as bonds with "
                "passive_gaps: a platen laid on a cut face"),
    SECTION("motion", wall_motion_section, .offset = offsetof(gn_wall_def, motion),
            .text = "how the wall moves; a free channel stands still"),
    SECTION("servo", servo_section, PRESENT(BOOL, gn_wall_def, servo.active),
            .text = "moves the wall along its normal so that it carries a wanted force"),
};
ELEMENTS_OF(wall, gn_wall_def);

/* ---- neighbours, run ---- */

static const gn_key neighbours_keys[] = {
    KEY("skin", REAL, gn_scene, skin, .unit = "m", .range = "[1e-12, 1e9]", .word = "auto",
        .fallback = "auto",
        .text = "extra distance of the neighbour list, to rebuild it seldom; raised to what may "
                "come apart in a step"),
};
TABLE_OF(neighbours);

static const gn_key run_keys[] = {
    KEY("seed", SEED, gn_scene, seed, .fallback = "1", .text = "of every random number"),
    KEY("threads", INTEGER, gn_scene, threads, .range = "[0, 1024]", .word = "auto",
        .fallback = "auto", .text = "auto or 0: all cores"),
    KEY("precision", CHOICE, gn_scene, precision, .choices = precisions, .fallback = "double",
        .text = "of the kernels of contacts and elements (displacement form); mixed: single, with "
                "positions and motion in double"),
    KEY("isa", CHOICE, gn_scene, isa, .choices = isas, .fallback = "auto",
        PLACED(gn_scene, isa_where),
        .text = "instruction set of the kernels; auto: the widest the machine has"),
    KEY("residual_warning", REAL, gn_scene, residual_warning, .unit = "1", .range = "(0, inf)",
        .word = "off", .fallback = "1 %",
        .text = "a run whose energy ledger leaves more than this unexplained, over the energy that "
                "has gone through, ends with a warning"),
    KEY("residual_limit", REAL, gn_scene, residual_limit, .unit = "1", .range = "(0, inf)",
        .word = "off", .fallback = "10 %",
        .text =
            "a run that leaves more than this unexplained has gone bad: it stops, or ends, with "
            "exit code 5"),
};
TABLE_OF(run);

static const gn_key scene_keys[] = {
    KEY("title", TEXT, gn_scene, title, .fallback = "", .packing = true,
        .text = "one line for reports"),
    KEY("dimension", INTEGER, gn_scene, dimension, .range = "[2, 3]", .fallback = "3",
        .packing = true, .text = "2: discs in plane strain; 3: spheres"),
    KEY("origin", VECTOR, gn_scene, origin, .unit = "m", .range = GN_PLACES,
        PRESENT(BOOL, gn_scene, has_origin), .packing = true,
        .text = "point that positions are computed relative to; left out: near the model if that "
                "lies far from 0, else 0"),
    SECTION("specimen", gn_specimen_section, PRESENT(BOOL, gn_scene, specimen_given),
            .packing = true,
            .text = "the particles at the start; specimen, sources, elements or several of them"),
    ARRAY("materials", LIST, gn_scene, materials, material_count, .section = &material_section,
          .range = "[1, 1000]", PRESENT(COUNT, gn_scene, material_count),
          .text = "what particles are made of; needed with a specimen"),
    ARRAY("contacts", LIST, gn_scene, contacts, contact_count, .section = &gn_contact_section,
          .range = "[0, 10000]",
          .text = "contacts between two materials (or one with itself) that differ from what the "
                  "materials say"),
    SECTION("law", law_section, PRESENT(BOOL, gn_scene, has_law),
            .text = "the contact law; needed with a specimen"),
    SECTION("elements", gn_elements_section, PRESENT(BOOL, gn_scene, has_elements),
            .text = "finite elements: linear triangles in plane strain or tetrahedra"),
    SECTION("couple", gn_couple_section, PRESENT(BOOL, gn_scene, has_couple),
            .text = "particles and elements as one body: zones that both share"),
    SECTION("bonds", bonds_section, .text = "brittle bonds between particles of one group"),
    SECTION("damping", damping_section, .text = "dissipation besides friction and breakage"),
    KEY("gravity", VECTOR, gn_scene, gravity, .unit = "m/s2", .range = GN_ACCELERATIONS,
        .fallback = "0", .text = "acceleration of free fall"),
    SECTION("initial", initial_section, .text = "the state at the start"),
    SECTION("periodic", periodic_section, PRESENT(BOOL, gn_scene, has_periodic),
            .text = "a periodic box"),
    SECTION("domain", domain_section, .text = "where particles may be"),
    ARRAY("sets", LIST, gn_scene, sets, set_count, .section = &set_section, .range = "[0, 10000]",
          .text = "selections of particles and what is done to them; a later one goes over an "
                  "earlier one"),
    ARRAY("walls", LIST, gn_scene, walls, wall_count, .section = &wall_section,
          .range = "[0, 10000]", .text = "plane walls"),
    ARRAY("bodies", LIST, gn_scene, bodies, body_count, .section = &gn_body_section,
          .range = "[0, 1000]", .text = "rigid bodies with a surface of triangles (2D: segments)"),
    ARRAY("sources", LIST, gn_scene, sources, source_count, .section = &gn_source_section,
          .range = "[0, 1000]", .text = "where particles come in while the run goes on"),
    ARRAY("sinks", LIST, gn_scene, sinks, sink_count, .section = &gn_sink_section,
          .range = "[0, 1000]",
          .text = "where particles are removed and counted; a later one has those that an earlier "
                  "one leaves"),
    SECTION("membrane", gn_membrane_section, PRESENT(BOOL, gn_scene, has_membrane),
            .text = "pressure on the surface of the specimen"),
    SECTION("test", gn_test_section, PRESENT(ENUM, gn_scene, test.kind),
            .text = "a laboratory test: where stress and strain are read"),
    SECTION("time", gn_time_section, .required = true, .text = "step and duration"),
    ARRAY("stages", LIST, gn_scene, stages, stage_count, .section = &gn_stage_section,
          .range = "[1, 1000]", PRESENT(COUNT, gn_scene, stage_count),
          .text = "what the run goes through one after the other; left out: one stage"),
    SECTION("output", gn_output_section, .packing = true, .text = "what is written"),
    SECTION("neighbours", neighbours_section, .text = "the neighbour list"),
    SECTION("run", run_section, .packing = true, .text = "how the run is carried out; no physics"),
};

const gn_section gn_scene_section = {scene_keys, sizeof scene_keys / sizeof(gn_key), 0,
                                     GN_NO_WHERE};
