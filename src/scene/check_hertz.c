/* Checks of Hertz's law, and of the contact parameters of walls and surfaces for any law. */
#include "scene/check.h"
#include "scene/sides.h"

#include <math.h>
#include <stdio.h>

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
                         "expected no bonds beside rolling_friction or twisting_friction, which "
                         "broken pairs would lack, found some");
}

gneiss_status gn_check_hertz(const check *section, const gn_scene *scene) {
    GN_TRY(check_rolling(section, scene));
    if (!gn_scene_hertz(scene)) {
        if (scene->pull || !gn_check_given(section, "law.pull")) return GNEISS_OK;
        return gn_check_fail(section, "law.pull",
                             "expected law.stiffness hertz beside it, found another");
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

/* Contacts of a body with walls and other bodies have the body's own stiffness. */
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

/* With Hertz's law a surface has a material or is rigid; otherwise it has a stiffness. */
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
        return gn_check_fail(section, material,
                             "expected law.stiffness hertz beside it, found another");
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
