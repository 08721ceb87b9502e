/* Checks of pairs of materials and of properties that are drawn for each bond. */
#include "scene/check.h"

#include "scene/sides.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

gneiss_status gn_check_scatter(const check *section, const char *key, const gn_scatter *scatter) {
    char path[GN_KEY_PATH_SIZE];
    bool weibull = scatter->kind == GN_SCATTER_WEIBULL;
    const char *needed = weibull ? "modulus" : "deviation",
               *other = weibull ? "deviation" : "modulus";
    if (scatter->kind == GN_SCATTER_NONE) return GNEISS_OK;
    snprintf(path, sizeof path, "%s.%s", key, needed);
    if (!((weibull ? scatter->modulus : scatter->deviation) > 0))
        return gn_check_fail(section, path, "required by the distribution, but not given");
    snprintf(path, sizeof path, "%s.%s", key, other);
    if ((weibull ? scatter->deviation : scatter->modulus) > 0)
        return gn_check_fail(section, path,
                             "expected to be left out with this distribution, found it "
                             "given");
    return GNEISS_OK;
}

/* Returns the first key that this law.stiffness does not read; NULL: none. */
static const char *unread(const gn_scene *scene, const gn_contact_def *contact) {
    bool area = gn_scene_by_area(scene), uniform = scene->stiffness == GN_STIFFNESS_UNIFORM;
    bool hertz = gn_scene_hertz(scene), strength = !uniform && !hertz;
    bool energy = scene->softening == GN_SOFTENING_ENERGY, adheres = gn_scene_adheres(scene);
    const struct {
        bool read;
        double value;
        const char *key;
    } keys[] = {{!area && !hertz, contact->kratio, "kratio"},
                {!area && strength, contact->contact_modulus, "contact_modulus"},
                {uniform, contact->normal_stiffness, "normal_stiffness"},
                {area || hertz, contact->young, "young"},
                {area || hertz, contact->poisson, "poisson"},
                {hertz, contact->restitution, "restitution"},
                {adheres, contact->adhesion, "adhesion"},
                {area, contact->alpha, "alpha"},
                {area, contact->beta, "beta"},
                {strength, contact->tensile_strength, "tensile_strength"},
                {strength, contact->shear_strength, "shear_strength"},
                {uniform, contact->bond_tension_limit, "bond_tension_limit"},
                {uniform, contact->bond_shear_limit, "bond_shear_limit"},
                {energy, contact->fracture_energy, "fracture_energy"},
                {energy, contact->shear_fracture_energy, "shear_fracture_energy"}};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (!keys[k].read && keys[k].value != GN_COMBINED) return keys[k].key;
    return NULL;
}

static const gn_material *material_of(const gn_scene *scene, const gn_contact_def *contact,
                                      size_t which) {
    size_t at = which < contact->between_count ? which : 0;
    return &scene->materials[gn_scene_find_material(scene, contact->between[at])];
}

/* True if the contacts of two materials have a tangential spring; `contact`: the entry of the pair,
 * or NULL. */
static bool has_spring(const gn_scene *scene, const gn_material *first, const gn_material *second,
                       const gn_contact_def *contact) {
    const bool area = gn_scene_by_area(scene);
    const double own = !contact ? GN_COMBINED : area ? contact->beta : contact->kratio;
    if (gn_scene_hertz(scene)) return true;
    if (own != GN_COMBINED) return own > 0.0;
    return area ? first->beta > 0.0 && second->beta > 0.0
                : first->kratio > 0.0 && second->kratio > 0.0;
}

/* Tells whether any pair with the material has a spring; a pair may have one although the material
 * has none. */
static bool has_spring_in_a_pair(const gn_scene *scene, const gn_material *material) {
    for (size_t k = 0; k < scene->contact_count; k++) {
        const gn_contact_def *contact = &scene->contacts[k];
        bool names = false;
        for (size_t n = 0; n < contact->between_count; n++)
            names |= strcmp(contact->between[n], material->name) == 0;
        if (names && (gn_scene_by_area(scene) ? contact->beta : contact->kratio) > 0.0) return true;
    }
    return false;
}

static gneiss_status no_grip(const check *section, const gn_scene *scene, const char *key) {
    return gn_check_needs(section, key, "0: without a tangential spring contacts have no friction",
                          "%s above 0", gn_scene_by_area(scene) ? "beta" : "kratio");
}

bool gn_material_has_spring(const gn_scene *scene, const gn_material *material) {
    return has_spring(scene, material, material, NULL) || has_spring_in_a_pair(scene, material);
}

/* Tells whether a missing spring may be added later. Later stages may add a spring, or friction to
 * the springs of the base. In a scene with stages, friction of the base may therefore be given
 * without a spring; friction that a stage gives requires a spring in that stage. */
static bool may_come_later(const check *section, const gn_scene *scene, const char *key) {
    const gn_node *node = gn_node_find(section->map, key);
    return scene->stage_count && !(node && node->stage);
}

gneiss_status gn_check_grip(const check *section, const gn_scene *scene,
                            const gn_material *material) {
    if (gn_material_has_spring(scene, material)) return GNEISS_OK;
    if (material->friction > 0 && !may_come_later(section, scene, "friction"))
        return no_grip(section, scene, "friction");
    if (scene->stage_count) return GNEISS_OK;
    return material->bond_friction > 0 && scene->bonds == GN_SWITCH_ON
               ? no_grip(section, scene, "bond_friction")
               : GNEISS_OK;
}

/* Refuses friction of the materials of a pair whose entry removes the spring. */
static gneiss_status check_inherited_grip(const check *section, const gn_scene *scene,
                                          const gn_contact_def *contact, const gn_material *first,
                                          const gn_material *second) {
    const char *spring = gn_scene_by_area(scene) ? "beta" : "kratio";
    const bool bonds = scene->bonds == GN_SWITCH_ON;
    const struct {
        const char *key;
        double own, of_both;
    } keys[] = {{"friction", contact->friction, fmin(first->friction, second->friction)},
                {"rolling_friction", contact->rolling_friction,
                 fmin(first->rolling_friction, second->rolling_friction)},
                {"twisting_friction", contact->twisting_friction,
                 fmin(first->twisting_friction, second->twisting_friction)},
                {"bond_friction", contact->bond_friction,
                 bonds ? fmin(first->bond_friction, second->bond_friction) : 0.0}};
    if (!gn_check_given(section, spring)) return GNEISS_OK;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (keys[k].own == GN_COMBINED && keys[k].of_both > 0.0)
            return gn_check_fail(section, spring,
                                 "expected a value above 0, or %s: 0, found 0 and a %s "
                                 "of %.4g by the materials: without a tangential spring contacts "
                                 "have no friction",
                                 keys[k].key, keys[k].key, keys[k].of_both);
    return GNEISS_OK;
}

static gneiss_status check_grip_of_pair(const check *section, const gn_scene *scene,
                                        const gn_contact_def *contact, const gn_material *first,
                                        const gn_material *second) {
    if (has_spring(scene, first, second, contact)) return GNEISS_OK;
    if (contact->friction > 0 && !may_come_later(section, scene, "friction"))
        return no_grip(section, scene, "friction");
    if (scene->stage_count) return GNEISS_OK;
    if (contact->rolling_friction > 0) return no_grip(section, scene, "rolling_friction");
    if (contact->twisting_friction > 0) return no_grip(section, scene, "twisting_friction");
    if (contact->bond_friction > 0 && scene->bonds == GN_SWITCH_ON)
        return no_grip(section, scene, "bond_friction");
    return check_inherited_grip(section, scene, contact, first, second);
}

static const char of_moments[] = "with bonds.radius_multiplier (the twisting stiffness of a bond "
                                 "follows from its shear stiffness)";
static const char of_softening[] = "beside bonds that soften or yield";

static gneiss_status need_shear(const check *section, const gn_scene *scene, double kratio,
                                double beta, const char *reason) {
    bool area = gn_scene_by_area(scene);
    if ((area ? beta : kratio) != 0.0) return GNEISS_OK;
    return gn_check_fail(section, area ? "beta" : "kratio",
                         "expected a tangential spring %s, found 0", reason);
}

static bool inelastic(const gn_scene *scene) {
    bool found = scene->softening != GN_SOFTENING_NONE;
    for (size_t k = 0; k < scene->material_count; k++)
        found = found || scene->materials[k].yield_stress[0] > 0;
    return found;
}

/* Checks that an element of `contacts` has a tangential spring if the law of bonds needs one. */
static gneiss_status check_shear_of_pair(const check *section, const gn_scene *scene,
                                         const gn_contact_def *contact) {
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (scene->bond_radius_multiplier > 0)
        GN_TRY(need_shear(section, scene, contact->kratio, contact->beta, of_moments));
    return inelastic(scene)
               ? need_shear(section, scene, contact->kratio, contact->beta, of_softening)
               : GNEISS_OK;
}

gneiss_status gn_check_contact(const check *section, const gn_scene *scene, size_t index) {
    const gn_contact_def *contact = &scene->contacts[index];
    if (contact->between_count > 2)
        return gn_check_fail(section, "between", "expected one or two materials, found %zu",
                             contact->between_count);
    if (!gn_check_names_are_valid(section, "materials")) return GNEISS_OK;
    for (size_t k = 0; k < contact->between_count; k++)
        GN_TRY(gn_check_material_name(section, scene, "between", contact->between[k]));
    const gn_material *first = material_of(scene, contact, 0), *b = material_of(scene, contact, 1);
    if (gn_scene_find_contact(scene, first, b) != contact)
        return gn_check_fail(section, "between",
                             "expected a unique pair, found '%s' and '%s' a second time",
                             first->name, b->name);
    if (contact->kratio > 0 && contact->kratio < 1e-6)
        return gn_check_fail(section, "kratio",
                             "expected 0 (no tangential spring) or at least 1e-6, found %g",
                             contact->kratio);
    GN_TRY(check_shear_of_pair(section, scene, contact));
    if (gn_check_is_valid(section, "law.stiffness"))
        GN_TRY(check_grip_of_pair(section, scene, contact, first, b));
    const char *key = gn_check_is_valid(section, "law.stiffness") ? unread(scene, contact) : NULL;
    if (!key) return GNEISS_OK;
    return gn_check_fail(section, key,
                         "expected a value that this law.stiffness and law.softening read, found "
                         "one that they ignore");
}

gneiss_status gn_check_gamma(const check *section, const gn_scene *scene) {
    bool area = gn_scene_by_area(scene);
    if (!area && scene->gamma > 0)
        return gn_check_needs(section, "law.gamma", "another", "stiffness dempack or polyhedron");
    if (scene->gamma_rule != GN_GAMMA_VOLUME && scene->stiffness == GN_STIFFNESS_POLYHEDRON)
        return gn_check_fail(section, "law.gamma_rule",
                             "expected volume beside stiffness polyhedron (whose bonds have "
                             "individual sections, without gamma), found porosity");
    if (scene->gamma_rule != GN_GAMMA_VOLUME && (!area || scene->gamma > 0))
        return gn_check_needs(section, "law.gamma_rule", area ? "a number" : "another", "%s",
                              area ? "gamma auto" : "stiffness dempack or polyhedron");
    return GNEISS_OK;
}

/* ---- cross-key checks of bonds that soften, yield or carry moments ---- */

/* Checks that the material has the values that softening requires. */
static gneiss_status check_softening(const check *section, const gn_scene *scene,
                                     const gn_material *material) {
    switch (scene->softening) {
    case GN_SOFTENING_NONE:
        return GNEISS_OK;
    case GN_SOFTENING_ENERGY:
        return gn_check_required(section, material->fracture_energy, "fracture_energy",
                                 "by softening energy");
    case GN_SOFTENING_STRAIN:
        return gn_check_required(section, material->fracture_strain, "fracture_strain",
                                 "by softening strain");
    case GN_SOFTENING_RATIO:
        return gn_check_required(section, material->fracture_ratio, "fracture_ratio",
                                 "by softening ratio");
    }
    return GNEISS_OK;
}

static gneiss_status check_yield(const check *section, const gn_material *material) {
    for (int k = 0; k < 3; k++) {
        char stress[32], ratio[32];
        snprintf(stress, sizeof stress, "yield_stress_%d", k + 1);
        snprintf(ratio, sizeof ratio, "yield_ratio_%d", k + 1);
        double limit = material->yield_stress[k], before = k ? material->yield_stress[k - 1] : 0.0;
        if (limit > 0)
            GN_TRY(gn_check_required(section, material->yield_ratio[k], ratio,
                                     "beside its yield_stress"));
        if (!(limit > 0) && material->yield_ratio[k] > 0)
            return gn_check_fail(section, stress, "required beside its yield_ratio, but not given");
        if (limit > 0 && k && !(before > 0)) {
            char missing[32];
            snprintf(missing, sizeof missing, "yield_stress_%d", k);
            return gn_check_fail(section, missing, "required beside %s, but not given", stress);
        }
        if (limit > 0 && k && !(limit > before))
            return gn_check_fail(section, stress,
                                 "expected more than yield_stress_%d, found %g Pa and %g Pa", k,
                                 limit, before);
    }
    return GNEISS_OK;
}

/* Checks the laws of bonds that soften, yield or carry moments. */
gneiss_status gn_check_bonds_of(const check *section, const gn_scene *scene,
                                const gn_material *material) {
    if (scene->bond_radius_multiplier > 0)
        GN_TRY(need_shear(section, scene, material->kratio, material->beta, of_moments));
    GN_TRY(check_softening(section, scene, material));
    GN_TRY(check_yield(section, material));
    if (scene->softening == GN_SOFTENING_NONE && !(material->yield_stress[0] > 0)) return GNEISS_OK;
    return need_shear(section, scene, material->kratio, material->beta, of_softening);
}

static bool frictional(const gn_scene *scene) {
    bool found = false;
    for (size_t k = 0; k < scene->material_count; k++)
        found = found || scene->materials[k].bond_friction > 0;
    for (size_t k = 0; k < scene->contact_count; k++)
        found = found || scene->contacts[k].bond_friction > 0;
    return found;
}

/* Checks the curve of softening. The bilinear curve divides an energy between two lines; no other
 * curve has the keys of a kink. */
static gneiss_status check_curve(const check *section, const gn_scene *scene) {
    if (scene->softening_curve == GN_SOFTENING_BILINEAR) {
        if (scene->softening == GN_SOFTENING_ENERGY) return GNEISS_OK;
        return gn_check_fail(section, "law.softening_curve",
                             "expected softening energy beside bilinear, found another");
    }
    if (scene->kink_stress > 0.0 &&
        fabs(scene->kink_stress - 1.0 / 3.0) > 1e-12) /* 0: the scene has no section `law` */
        return gn_check_needs(section, "law.kink_stress", "linear", "softening_curve bilinear");
    if (scene->initial_energy > 0.0 && scene->initial_energy != 0.6)
        return gn_check_needs(section, "law.initial_energy", "linear", "softening_curve bilinear");
    return GNEISS_OK;
}

/* Checks that a scene that gives the stress on which mu_1 acts also gives a mu_1. */
gneiss_status gn_check_coupling(const check *section, const gn_scene *scene) {
    if (scene->fracture_energy_of == GN_FRACTURE_BODY && scene->softening != GN_SOFTENING_ENERGY)
        return gn_check_fail(section, "law.fracture_energy_of",
                             "expected softening energy beside body, found another");
    if (scene->has_law) GN_TRY(check_curve(section, scene));
    if (scene->bonds != GN_SWITCH_ON || frictional(scene)) return GNEISS_OK;
    if (scene->coupling == GN_COUPLING_LINEAR)
        return gn_check_fail(section, "law.coupling",
                             "expected a bond_friction above 0 beside linear (tension lowers the "
                             "shear strength by mu_1 f_n), found none");
    if (scene->confinement == GN_CONFINEMENT_MEAN)
        return gn_check_fail(section, "law.confinement",
                             "expected a bond_friction above 0 beside mean, found none");
    return GNEISS_OK;
}

static const char *beside_moments(const gn_scene *scene) {
    if (scene->softening != GN_SOFTENING_NONE) return "law.softening";
    for (size_t k = 0; k < scene->material_count; k++)
        if (scene->materials[k].yield_stress[0] > 0) return "yield_stress_1";
    return NULL;
}

/* Checks bonds with moments, which require spins and are a separate law of bonds. */
gneiss_status gn_check_moments(const check *section, const gn_scene *scene) {
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (!(scene->bond_radius_multiplier > 0)) {
        if (!gn_check_given(section, "bonds.moment_share") ||
            gn_check_given(section, "bonds.radius_multiplier"))
            return GNEISS_OK;
        return gn_check_needs(section, "bonds.moment_share", "none",
                              "a radius_multiplier above 0 (otherwise bonds carry no moments)");
    }
    if (scene->rotation == GN_SWITCH_OFF)
        return gn_check_fail(section, "bonds.radius_multiplier",
                             "expected 0 with law.rotation: off, found %g: particles without "
                             "rotation cannot bend or twist a bond",
                             scene->bond_radius_multiplier);
    const char *other = beside_moments(scene);
    if (!other) return GNEISS_OK;
    return gn_check_fail(section, "bonds.radius_multiplier",
                         "expected 0 beside %s (damage and yield are defined for the forces of a "
                         "bond, not for its moments), found %g",
                         other, scene->bond_radius_multiplier);
}

/* ---- checks of Hertz's law, and of the contact parameters of walls and surfaces for any law ----
 */

gneiss_status gn_check_hertz_material(const check *section, const gn_material *material) {
    GN_TRY(gn_check_required(section, material->young, "young", "by law.stiffness hertz"));
    return gn_check_required(section, material->poisson + 1.0, "poisson", "by law.stiffness hertz");
}

static gneiss_status check_rolling(const check *section, const gn_scene *scene) {
    if (!gn_scene_has_rolling(scene)) return GNEISS_OK;
    if (scene->rotation == GN_SWITCH_OFF)
        return gn_check_fail(section, "law.rotation",
                             "expected spins beside rolling_friction or twisting_friction, found "
                             "off");
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    return gn_check_fail(section, "bonds",
                         "expected no bonds beside rolling_friction or twisting_friction, because "
                         "broken bonds would have no such resistance, found some");
}

/* Refuses parts that attractive contacts do not work beside. */
static gneiss_status check_cohesive_company(const check *section, const gn_scene *scene) {
    const bool liquid = scene->cohesion == GN_COHESION_LIQUID;
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->body_count > 0, "rigid bodies, whose facets have no attraction"},
                  {scene->has_elements, "finite elements"},
                  {scene->has_membrane, "a membrane"},
                  {scene->precision == GN_PRECISION_MIXED, "mixed precision"},
                  {gn_scene_box_moves(scene), "a periodic box whose sides move"},
                  {liquid && scene->source_count > 0, "sources, whose particles would be dry"},
                  {liquid && (scene->sink_count > 0 || scene->lost == GN_LOST_REMOVE),
                   "particles that are removed, with the liquid of their bridges"},
                  {scene->joint_count > 0, "joints, whose contacts have no attraction"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, "law.cohesion", "expected none beside it, found %s",
                                 others[k].what);
    return GNEISS_OK;
}

static bool any_adheres(const gn_scene *scene) {
    bool found = false;
    for (size_t k = 0; k < scene->material_count; k++)
        found = found || scene->materials[k].adhesion > 0;
    for (size_t k = 0; k < scene->contact_count; k++)
        found = found || scene->contacts[k].adhesion > 0;
    return found;
}

/* Checks the keys of attractive contacts. */
static gneiss_status check_cohesion(const check *section, const gn_scene *scene) {
    const bool liquid = scene->cohesion == GN_COHESION_LIQUID;
    const struct {
        double value;
        const char *key;
    } of_liquid[] = {{scene->surface_tension, "law.surface_tension"},
                     {scene->contact_angle, "law.contact_angle"},
                     {scene->liquid_content, "law.liquid_content"}};
    for (size_t k = 0; !liquid && k < sizeof of_liquid / sizeof *of_liquid; k++)
        if (of_liquid[k].value > 0.0)
            return gn_check_fail(section, of_liquid[k].key,
                                 "expected law.cohesion liquid beside it, found another");
    if (scene->cohesion == GN_COHESION_NONE) return GNEISS_OK;
    if (!gn_scene_hertz(scene))
        return gn_check_fail(section, "law.cohesion",
                             "expected law.stiffness hertz beside it, found another");
    if (liquid) {
        GN_TRY(gn_check_required(section, scene->surface_tension, "law.surface_tension",
                                 "by cohesion liquid"));
        GN_TRY(gn_check_required(section, scene->liquid_content, "law.liquid_content",
                                 "by cohesion liquid"));
    } else if (!any_adheres(scene)) {
        return gn_check_fail(section, "law.cohesion",
                             "expected a material or a pair with an adhesion above 0, found none");
    }
    return check_cohesive_company(section, scene);
}

gneiss_status gn_check_hertz(const check *section, const gn_scene *scene) {
    GN_TRY(check_rolling(section, scene));
    GN_TRY(check_cohesion(section, scene));
    if (!gn_scene_hertz(scene)) {
        if (scene->pull || !gn_check_given(section, "law.pull")) return GNEISS_OK;
        return gn_check_needs(section, "law.pull", "another", "law.stiffness hertz");
    }
    if (scene->dimension != 3)
        return gn_check_fail(section, "law.stiffness",
                             "expected a 3D scene beside hertz, the law of spheres (the force of "
                             "discs does not follow from their overlap alone), found a 2D one");
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    return gn_check_fail(section, "law.stiffness",
                         "expected a law with tension beside bonds, found hertz");
}

static gneiss_status not_read(const check *section, const char *key, double value,
                              const char *why) {
    if (!(value > 0)) return GNEISS_OK;
    return gn_check_fail(section, key, "expected none %s, found %g", why, value);
}

/* Checks springs of bodies: contacts of a body with walls and other bodies have the body's own
 * stiffness. */
static gneiss_status check_body_springs(const check *section, const gn_scene *scene,
                                        gn_side_keys side) {
    int m = *side.material ? gn_scene_find_material(scene, side.material) : -1;
    double friction = m >= 0 ? scene->materials[m].friction : side.friction;
    if (!(side.stiffness > 0))
        return not_read(section, "kratio", side.kratio,
                        "without a stiffness of contacts with walls and other bodies");
    return friction > 0
               ? gn_check_required(section, side.kratio, "kratio", "by stiffness and friction")
               : GNEISS_OK;
}

/* Checks the side of a surface: by Hertz's law it has a material or is rigid; otherwise it has a
 * stiffness. */
gneiss_status gn_check_side(const check *section, const gn_scene *scene, const char *prefix,
                            gn_side_keys side) {
    char stiffness[64], kratio[64], friction[64], material[64];
    const bool rolls = side.rolling > 0 || side.twisting > 0;
    snprintf(stiffness, sizeof stiffness, "%sstiffness", prefix);
    snprintf(kratio, sizeof kratio, "%skratio", prefix);
    snprintf(friction, sizeof friction, "%sfriction", prefix);
    snprintf(material, sizeof material, "%smaterial", prefix);
    if (!gn_check_is_valid(section, "law.stiffness")) return GNEISS_OK;
    if (!gn_scene_hertz(scene)) {
        GN_TRY(gn_check_required(section, side.stiffness, stiffness, "by this law.stiffness"));
        if (side.friction > 0)
            GN_TRY(gn_check_required(section, side.kratio, kratio, "by friction"));
        if (rolls) GN_TRY(gn_check_required(section, side.kratio, kratio, "by rolling_friction"));
        if (!*side.material) return GNEISS_OK;
        return gn_check_needs(section, material, "another", "law.stiffness hertz");
    }
    const char *why = "beside law.stiffness hertz, which has E and nu of the material";
    if (!side.body) {
        GN_TRY(not_read(section, stiffness, side.stiffness, why));
        GN_TRY(not_read(section, kratio, side.kratio, why));
    }
    if (*side.material) {
        GN_TRY(gn_check_material_name(section, scene, material, side.material));
        GN_TRY(not_read(section, friction, side.friction, "beside a material, which has its own"));
        const char *own = side.rolling > 0 ? "rolling_friction" : "twisting_friction";
        GN_TRY(not_read(section, own, fmax(side.rolling, side.twisting),
                        "beside a material, which has its own"));
    }
    return side.body ? check_body_springs(section, scene, side) : GNEISS_OK;
}

/* ---- checks that the sides of a periodic box can move as the scene states ---- */

/* Refuses parts that cannot be combined with a box whose sides move, because only particles follow
 * its deformation. */
static gneiss_status check_company(const check *section, const gn_scene *scene) {
    bool prescribed = false;
    for (size_t k = 0; k < scene->set_count; k++)
        for (int a = 0; a < 3; a++)
            prescribed |=
                scene->sets[k].motion.velocity[a].count || scene->sets[k].motion.spin[a].count;
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->wall_count > 0, "walls"},
                  {scene->has_elements, "finite elements"},
                  {prescribed, "a set whose motion is prescribed"},
                  {scene->has_pulse, "initial.pulse"}};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, "periodic",
                                 "expected only particles in a box whose sides move, found %s",
                                 others[k].what);
    if (scene->precision != GN_PRECISION_MIXED) return GNEISS_OK;
    return gn_check_fail(section, "run.precision",
                         "expected double beside a periodic box whose sides move, found mixed");
}

/* Checks the corners of the box, except along an open axis. */
static gneiss_status check_corners(const check *section, const gn_scene *scene) {
    double high[3];
    for (int a = 0; a < 3; a++)
        high[a] = a == scene->periodic_open ? INFINITY : scene->periodic_max[a];
    if (scene->has_periodic)
        GN_TRY(gn_check_box(section, scene, "periodic.max", scene->periodic_min, high));
    if (!gn_scene_half_periodic(scene)) return GNEISS_OK;
    if (scene->periodic_open >= scene->dimension)
        return gn_check_fail(section, "periodic.open", "expected x or y in a 2D scene, found z");
    if (gn_scene_box_moves(scene))
        return gn_check_fail(section, "periodic.open",
                             "expected none in a box whose sides move, found %c",
                             "xyz"[scene->periodic_open]);
    return GNEISS_OK;
}

/* Refuses keys that only servos have, and sides without a motion. */
static gneiss_status check_idle(const check *section, const gn_box_side *side, const char *key) {
    const gn_node *given = gn_node_find(section->map, key);
    const char *idle = side->max_rate > 0 ? "max_rate" : side->relaxation > 0 ? "relaxation" : NULL;
    char more[48];
    if (given && given->kind == GN_NODE_MAP && !given->count)
        return gn_check_fail(section, key, "expected stress or rate, found neither");
    if (side->of_mean && !side->stress.count) idle = "stress_of";
    if (side->stress.count || !idle) return GNEISS_OK;
    snprintf(more, sizeof more, "%s.%s", key, idle);
    return gn_check_fail(section, more, "expected stress (a servo) for this side, found %s",
                         side->rate.count ? "a rate" : "none");
}

gneiss_status gn_check_box_sides(const check *section, const gn_scene *scene) {
    GN_TRY(check_corners(section, scene));
    for (int a = 0; a < 3; a++) {
        const gn_box_side *side = &scene->box[a];
        char key[32], more[48];
        snprintf(key, sizeof key, "periodic.%c", "xyz"[a]);
        snprintf(more, sizeof more, "%s.max_rate", key);
        GN_TRY(check_idle(section, side, key));
        if (!side->stress.count && !side->rate.count) continue;
        if (a >= scene->dimension)
            return gn_check_fail(section, key, "expected x or y in a 2D scene, found z");
        if (side->stress.count && side->rate.count)
            return gn_check_fail(section, key, "expected stress or rate, found both");
        if (side->stress.count && !(side->max_rate > 0))
            return gn_check_fail(section, more, "required beside stress, but not given");
    }
    return gn_scene_box_moves(scene) ? check_company(section, scene) : GNEISS_OK;
}
