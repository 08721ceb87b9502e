/* What materials say of each other, and what is drawn bond by bond. */
#include "scene/check.h"
#include "scene/sides.h"

#include <math.h>
#include <string.h>

gneiss_status gn_check_scatter(const check *c, const char *key, const gn_scatter *scatter) {
    char path[GN_KEY_PATH_SIZE];
    bool weibull = scatter->kind == GN_SCATTER_WEIBULL;
    const char *needed = weibull ? "modulus" : "deviation",
               *other = weibull ? "deviation" : "modulus";
    if (scatter->kind == GN_SCATTER_NONE) return GNEISS_OK;
    snprintf(path, sizeof path, "%s.%s", key, needed);
    if (!((weibull ? scatter->modulus : scatter->deviation) > 0))
        return gn_check_fail(c, path, "required by the distribution, but not given");
    snprintf(path, sizeof path, "%s.%s", key, other);
    if ((weibull ? scatter->deviation : scatter->modulus) > 0)
        return gn_check_fail(c, path,
                             "expected to be left out with this distribution, found it "
                             "given");
    return GNEISS_OK;
}

/* The first key that this law.stiffness does not read; NULL: none. */
static const char *unread(const gn_scene *s, const gn_contact_def *d) {
    bool area = gn_scene_by_area(s), uniform = s->stiffness == GN_STIFFNESS_UNIFORM;
    bool hertz = gn_scene_hertz(s), strength = !uniform && !hertz;
    bool energy = s->softening == GN_SOFTENING_ENERGY;
    const struct {
        bool read;
        double value;
        const char *key;
    } keys[] = {{!area && !hertz, d->kratio, "kratio"},
                {!area && strength, d->contact_modulus, "contact_modulus"},
                {uniform, d->normal_stiffness, "normal_stiffness"},
                {area || hertz, d->young, "young"},
                {area || hertz, d->poisson, "poisson"},
                {hertz, d->restitution, "restitution"},
                {area, d->alpha, "alpha"},
                {area, d->beta, "beta"},
                {strength, d->tensile_strength, "tensile_strength"},
                {strength, d->shear_strength, "shear_strength"},
                {uniform, d->bond_tension_limit, "bond_tension_limit"},
                {uniform, d->bond_shear_limit, "bond_shear_limit"},
                {energy, d->fracture_energy, "fracture_energy"},
                {energy, d->shear_fracture_energy, "shear_fracture_energy"}};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (!keys[k].read && keys[k].value != GN_COMBINED) return keys[k].key;
    return NULL;
}

static const gn_material *material_of(const gn_scene *s, const gn_contact_def *d, size_t which) {
    size_t at = which < d->between_count ? which : 0;
    return &s->materials[gn_scene_find_material(s, d->between[at])];
}

/* Tells whether the contacts of two materials have a tangential spring; `d`, NULL: what a pair
 * says. */
static bool has_spring(const gn_scene *s, const gn_material *a, const gn_material *b,
                       const gn_contact_def *d) {
    const bool area = gn_scene_by_area(s);
    const double own = !d ? GN_COMBINED : area ? d->beta : d->kratio;
    if (gn_scene_hertz(s)) return true;
    if (own != GN_COMBINED) return own > 0.0;
    return area ? a->beta > 0.0 && b->beta > 0.0 : a->kratio > 0.0 && b->kratio > 0.0;
}

/* A pair of materials may have a spring where neither of them does. */
static bool has_spring_in_a_pair(const gn_scene *s, const gn_material *m) {
    for (size_t k = 0; k < s->contact_count; k++) {
        const gn_contact_def *d = &s->contacts[k];
        bool names = false;
        for (size_t n = 0; n < d->between_count; n++) names |= strcmp(d->between[n], m->name) == 0;
        if (names && (gn_scene_by_area(s) ? d->beta : d->kratio) > 0.0) return true;
    }
    return false;
}

static gneiss_status no_grip(const check *c, const gn_scene *s, const char *key) {
    return gn_check_fail(c, key,
                         "expected %s above 0 beside it, found 0: without a tangential spring "
                         "contacts have no friction",
                         gn_scene_by_area(s) ? "beta" : "kratio");
}

bool gn_material_has_spring(const gn_scene *s, const gn_material *m) {
    return has_spring(s, m, m, NULL) || has_spring_in_a_pair(s, m);
}

/* Stages may bring a spring, or a friction to the springs of the base, so that friction of the base
 * may stand in a scene with stages; friction that a stage itself gives needs a spring there. */
static bool may_come_later(const check *c, const gn_scene *s, const char *key) {
    const gn_node *node = gn_node_find(c->map, key);
    return s->stage_count && !(node && node->stage);
}

gneiss_status gn_check_grip(const check *c, const gn_scene *s, const gn_material *m) {
    if (gn_material_has_spring(s, m)) return GNEISS_OK;
    if (m->friction > 0 && !may_come_later(c, s, "friction")) return no_grip(c, s, "friction");
    if (s->stage_count) return GNEISS_OK;
    return m->bond_friction > 0 && s->bonds == GN_SWITCH_ON ? no_grip(c, s, "bond_friction")
                                                            : GNEISS_OK;
}

/* A friction that the materials of a pair have, where the pair itself takes the spring away. */
static gneiss_status check_inherited_grip(const check *c, const gn_scene *s,
                                          const gn_contact_def *d, const gn_material *a,
                                          const gn_material *b) {
    const char *spring = gn_scene_by_area(s) ? "beta" : "kratio";
    const bool bonds = s->bonds == GN_SWITCH_ON;
    const struct {
        const char *key;
        double own, of_both;
    } keys[] = {
        {"friction", d->friction, fmin(a->friction, b->friction)},
        {"rolling_friction", d->rolling_friction, fmin(a->rolling_friction, b->rolling_friction)},
        {"twisting_friction", d->twisting_friction,
         fmin(a->twisting_friction, b->twisting_friction)},
        {"bond_friction", d->bond_friction,
         bonds ? fmin(a->bond_friction, b->bond_friction) : 0.0}};
    if (!gn_check_given(c, spring)) return GNEISS_OK;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (keys[k].own == GN_COMBINED && keys[k].of_both > 0.0)
            return gn_check_fail(c, spring,
                                 "expected a value above 0, or %s: 0 beside it, found 0 and a %s "
                                 "of %.4g by the materials: without a tangential spring contacts "
                                 "have no friction",
                                 keys[k].key, keys[k].key, keys[k].of_both);
    return GNEISS_OK;
}

static gneiss_status check_grip_of_pair(const check *c, const gn_scene *s, const gn_contact_def *d,
                                        const gn_material *a, const gn_material *b) {
    if (has_spring(s, a, b, d)) return GNEISS_OK;
    if (d->friction > 0 && !may_come_later(c, s, "friction")) return no_grip(c, s, "friction");
    if (s->stage_count) return GNEISS_OK;
    if (d->rolling_friction > 0) return no_grip(c, s, "rolling_friction");
    if (d->twisting_friction > 0) return no_grip(c, s, "twisting_friction");
    if (d->bond_friction > 0 && s->bonds == GN_SWITCH_ON) return no_grip(c, s, "bond_friction");
    return check_inherited_grip(c, s, d, a, b);
}

gneiss_status gn_check_contact(const check *c, const gn_scene *s, size_t index) {
    const gn_contact_def *d = &s->contacts[index];
    if (d->between_count > 2)
        return gn_check_fail(c, "between", "expected one or two materials, found %zu",
                             d->between_count);
    if (!gn_check_named(c, "materials")) return GNEISS_OK;
    for (size_t k = 0; k < d->between_count; k++)
        GN_TRY(gn_check_material_name(c, s, "between", d->between[k]));
    const gn_material *a = material_of(s, d, 0), *b = material_of(s, d, 1);
    if (gn_scene_find_contact(s, a, b) != d)
        return gn_check_fail(c, "between",
                             "expected a pair of its own, found '%s' and '%s' a "
                             "second time",
                             a->name, b->name);
    if (d->kratio > 0 && d->kratio < 1e-6)
        return gn_check_fail(
            c, "kratio", "expected 0 (no tangential spring) or at least 1e-6, found %g", d->kratio);
    GN_TRY(gn_check_shear_of_pair(c, s, d));
    if (gn_check_sound(c, "law.stiffness")) GN_TRY(check_grip_of_pair(c, s, d, a, b));
    const char *key = gn_check_sound(c, "law.stiffness") ? unread(s, d) : NULL;
    if (!key) return GNEISS_OK;
    return gn_check_fail(
        c, key,
        "expected a value that this law.stiffness and law.softening read, found one "
        "that they do not");
}

gneiss_status gn_check_gamma(const check *c, const gn_scene *s) {
    bool area = gn_scene_by_area(s);
    if (!area && s->gamma > 0)
        return gn_check_fail(c, "law.gamma",
                             "expected stiffness dempack or polyhedron beside it, found another");
    if (s->gamma_rule != GN_GAMMA_VOLUME && s->stiffness == GN_STIFFNESS_POLYHEDRON)
        return gn_check_fail(c, "law.gamma_rule",
                             "expected volume beside stiffness polyhedron (whose bonds have "
                             "sections of their own, without gamma), found porosity");
    if (s->gamma_rule != GN_GAMMA_VOLUME && (!area || s->gamma > 0))
        return gn_check_fail(c, "law.gamma_rule", "expected %s beside it, found %s",
                             area ? "gamma auto" : "stiffness dempack or polyhedron",
                             area ? "a number" : "another");
    return GNEISS_OK;
}
