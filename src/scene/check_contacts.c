/* Checks of pairs of materials and of properties that are drawn for each bond. */
#include "scene/check.h"
#include "scene/sides.h"

#include <math.h>
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
    bool energy = scene->softening == GN_SOFTENING_ENERGY;
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

/* A pair of materials may have a spring where neither of them does. */
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
    return gn_check_fail(section, key,
                         "expected %s above 0 beside it, found 0: without a tangential spring "
                         "contacts have no friction",
                         gn_scene_by_area(scene) ? "beta" : "kratio");
}

bool gn_material_has_spring(const gn_scene *scene, const gn_material *material) {
    return has_spring(scene, material, material, NULL) || has_spring_in_a_pair(scene, material);
}

/* Later stages may add a spring, or friction to the springs of the base. Friction of the base may
 * therefore stand without a spring in a scene with stages; friction that a stage itself gives needs
 * a spring there. */
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
                                 "expected a value above 0, or %s: 0 beside it, found 0 and a %s "
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
    GN_TRY(gn_check_shear_of_pair(section, scene, contact));
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
        return gn_check_fail(section, "law.gamma",
                             "expected stiffness dempack or polyhedron beside it, found another");
    if (scene->gamma_rule != GN_GAMMA_VOLUME && scene->stiffness == GN_STIFFNESS_POLYHEDRON)
        return gn_check_fail(section, "law.gamma_rule",
                             "expected volume beside stiffness polyhedron (whose bonds have "
                             "individual sections, without gamma), found porosity");
    if (scene->gamma_rule != GN_GAMMA_VOLUME && (!area || scene->gamma > 0))
        return gn_check_fail(section, "law.gamma_rule", "expected %s beside it, found %s",
                             area ? "gamma auto" : "stiffness dempack or polyhedron",
                             area ? "a number" : "another");
    return GNEISS_OK;
}
