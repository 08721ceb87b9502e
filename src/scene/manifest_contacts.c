/* Keys of `contacts` and of distributions of bond properties. */
#include "scene/manifest_keys.h"

static const gn_choice distributions[] = {
    {"weibull", GN_SCATTER_WEIBULL}, {"normal", GN_SCATTER_NORMAL}, {NULL, 0}};

static const gn_key scatter_keys[] = {
    KEY("distribution", CHOICE, gn_scatter, kind, .choices = distributions, .required = true,
        .text = "distribution of the factor of a bond"),
    KEY("modulus", REAL, gn_scatter, modulus, .unit = GN_PLAIN_NUMBER, .range = "[0.5, 1e4]",
        .word = "none", .fallback = "none", .text = "Weibull modulus; needed by weibull"),
    KEY("deviation", REAL, gn_scatter, deviation, .unit = "1", .range = "[1e-6, 0.33]",
        .word = "none", .fallback = "none",
        .text =
            "standard deviation over the mean; needed by normal, which is truncated at 0 and 2"),
};
const gn_section gn_scatter_section = {scatter_keys, sizeof scatter_keys / sizeof(gn_key), 0,
                                       GN_NO_WHERE};

#define VALUE(NAME, FIELD, UNIT, RANGE, TEXT)                                                      \
    KEY(NAME, REAL, gn_contact_def, FIELD, .unit = UNIT, .range = RANGE, .word = "combined",       \
        .word_value = GN_COMBINED, .fallback = "combined", .text = TEXT)

static const gn_key contact_keys[] = {
    ARRAY("between", NAMES, gn_contact_def, between, between_count, .required = true,
          .text = "the two materials, in either order; one name: that material with itself"),
    VALUE("friction", friction, GN_SLOPE, GN_FRICTIONS,
          "friction coefficient, instead of the smaller"),
    VALUE("kratio", kratio, "1", "[0, 1e12]", "k_n/k_t; 0: no tangential spring"),
    VALUE("contact_modulus", contact_modulus, "Pa", GN_MODULI, "E_c, instead of both in series"),
    VALUE("normal_stiffness", normal_stiffness, "N/m", GN_SPRINGS,
          "k_n, instead of both in series"),
    VALUE("young", young, "Pa", GN_MODULI,
          "E of laws by area and hertz, instead of both in series"),
    VALUE("poisson", poisson, "1", "(-1, 0.5]",
          "nu of laws by area and hertz, instead of the mean (of each)"),
    VALUE("alpha", alpha, "1", "[1e-6, 1e6]",
          "factor in laws by area, instead of the harmonic mean"),
    VALUE("beta", beta, "1", "[0, 1e6]", "factor in laws by area, instead of the harmonic mean"),
    VALUE("tensile_strength", tensile_strength, "Pa", GN_STRENGTHS,
          "sigma_c of a bond, instead of the smaller"),
    VALUE("shear_strength", shear_strength, "Pa", GN_STRENGTHS,
          "tau_c of a bond, instead of the smaller"),
    VALUE("bond_tension_limit", bond_tension_limit, "N", GN_BREAKING,
          "R_n of the uniform law, instead of the smaller"),
    VALUE("bond_shear_limit", bond_shear_limit, "N", GN_BREAKING,
          "R_t of the uniform law, instead of the smaller"),
    VALUE("bond_friction", bond_friction, GN_SLOPE, GN_FRICTIONS,
          "mu_1 of a bond, instead of the smaller"),
    VALUE("rolling_friction", rolling_friction, "1", GN_FRICTIONS, "mu_r, instead of the smaller"),
    VALUE("twisting_friction", twisting_friction, "1", GN_FRICTIONS,
          "mu_t, instead of the smaller"),
    VALUE("restitution", restitution, "1", "[0, 1]",
          "restitution coefficient with hertz, instead of the smaller"),
    VALUE("fracture_energy", fracture_energy, "J/m2", GN_TOUGHNESSES,
          "G_f of a bond in tension, with softening energy, instead of the smaller"),
    VALUE("shear_fracture_energy", shear_fracture_energy, "J/m2", GN_TOUGHNESSES,
          "G_f of a bond in shear, with softening energy, instead of the smaller"),
};
const gn_section gn_contact_section = {contact_keys, sizeof contact_keys / sizeof(gn_key),
                                       sizeof(gn_contact_def), offsetof(gn_contact_def, where)};
