/* What goes with Hertz's law, and what walls and surfaces say of their contacts by any. */
#include "scene/check.h"
#include "scene/sides.h"

#include <math.h>
#include <stdio.h>

gneiss_status gn_check_hertz_material(const check *c, const gn_material *m) {
    GN_TRY(gn_check_need(c, m->young, "young", "by law.stiffness hertz"));
    return gn_check_need(c, m->poisson + 1.0, "poisson", "by law.stiffness hertz");
}

static gneiss_status check_rolling(const check *c, const gn_scene *s) {
    if (!gn_scene_rolls(s)) return GNEISS_OK;
    if (s->rotation == GN_SWITCH_OFF)
        return gn_check_fail(c, "law.rotation",
                             "expected spins beside rolling_friction or twisting_friction, found "
                             "off");
    if (s->bonds != GN_SWITCH_ON) return GNEISS_OK;
    return gn_check_fail(c, "bonds",
                         "expected no bonds beside rolling_friction or twisting_friction, which "
                         "pairs that have broken would not have, found some");
}

gneiss_status gn_check_hertz(const check *c, const gn_scene *s) {
    GN_TRY(check_rolling(c, s));
    if (!gn_scene_hertz(s)) {
        if (s->pull || !gn_check_given(c, "law.pull")) return GNEISS_OK;
        return gn_check_fail(c, "law.pull",
                             "expected law.stiffness hertz beside it, found another");
    }
    if (s->dimension != 3)
        return gn_check_fail(c, "law.stiffness",
                             "expected a 3D scene beside hertz, the law of spheres (the force of "
                             "discs does not follow from their overlap alone), found a 2D one");
    if (s->bonds != GN_SWITCH_ON) return GNEISS_OK;
    return gn_check_fail(c, "law.stiffness",
                         "expected a law with tension beside bonds, found hertz");
}

static gneiss_status not_read(const check *c, const char *key, double value, const char *why) {
    if (!(value > 0)) return GNEISS_OK;
    return gn_check_fail(c, key, "expected none %s, found %g", why, value);
}

/* A body meets walls and other bodies by a stiffness of its own. */
static gneiss_status check_body_springs(const check *c, const gn_scene *s, gn_side_keys side) {
    int m = *side.material ? gn_scene_find_material(s, side.material) : -1;
    double friction = m >= 0 ? s->materials[m].friction : side.friction;
    if (!(side.stiffness > 0))
        return not_read(c, "kratio", side.kratio,
                        "without a stiffness, by which a body meets walls and others");
    return friction > 0 ? gn_check_need(c, side.kratio, "kratio", "by stiffness and friction")
                        : GNEISS_OK;
}

/* With Hertz's law of a material or rigid, else of a stiffness. */
gneiss_status gn_check_side(const check *c, const gn_scene *s, const char *prefix,
                            gn_side_keys side) {
    char stiffness[64], kratio[64], friction[64], material[64];
    const bool rolls = side.rolling > 0 || side.twisting > 0;
    snprintf(stiffness, sizeof stiffness, "%sstiffness", prefix);
    snprintf(kratio, sizeof kratio, "%skratio", prefix);
    snprintf(friction, sizeof friction, "%sfriction", prefix);
    snprintf(material, sizeof material, "%smaterial", prefix);
    if (!gn_check_sound(c, "law.stiffness")) return GNEISS_OK;
    if (!gn_scene_hertz(s)) {
        GN_TRY(gn_check_need(c, side.stiffness, stiffness, "by this law.stiffness"));
        if (side.friction > 0) GN_TRY(gn_check_need(c, side.kratio, kratio, "by friction"));
        if (rolls) GN_TRY(gn_check_need(c, side.kratio, kratio, "by rolling_friction"));
        if (!*side.material) return GNEISS_OK;
        return gn_check_fail(c, material, "expected law.stiffness hertz beside it, found another");
    }
    const char *why = "beside law.stiffness hertz, which has E and nu of the material";
    if (!side.body) {
        GN_TRY(not_read(c, stiffness, side.stiffness, why));
        GN_TRY(not_read(c, kratio, side.kratio, why));
    }
    if (*side.material) {
        GN_TRY(gn_check_material_name(c, s, material, side.material));
        GN_TRY(not_read(c, friction, side.friction, "beside a material, which has its own"));
        const char *own = side.rolling > 0 ? "rolling_friction" : "twisting_friction";
        GN_TRY(not_read(c, own, fmax(side.rolling, side.twisting),
                        "beside a material, which has its own"));
    }
    return side.body ? check_body_springs(c, s, side) : GNEISS_OK;
}
