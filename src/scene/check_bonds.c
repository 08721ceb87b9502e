/* Cross-key checks of bonds that soften, yield or carry moments. */
#include "scene/check.h"

#include <math.h>
#include <stdio.h>

/* Checks that the material has the values that softening reads. */
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

static gneiss_status need_shear(const check *section, const gn_scene *scene, double kratio,
                                double beta, const char *reason) {
    bool area = gn_scene_by_area(scene);
    if ((area ? beta : kratio) != 0.0) return GNEISS_OK;
    return gn_check_fail(section, area ? "beta" : "kratio",
                         "expected a tangential spring %s, found 0", reason);
}

static const char of_moments[] = "with bonds.radius_multiplier (the twisting stiffness of a bond "
                                 "follows from its shear stiffness)";
static const char of_softening[] = "beside bonds that soften or yield";

static bool inelastic(const gn_scene *scene) {
    bool found = scene->softening != GN_SOFTENING_NONE;
    for (size_t k = 0; k < scene->material_count; k++)
        found = found || scene->materials[k].yield_stress[0] > 0;
    return found;
}

gneiss_status gn_check_shear_of_pair(const check *section, const gn_scene *scene,
                                     const gn_contact_def *contact) {
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (scene->bond_radius_multiplier > 0)
        GN_TRY(need_shear(section, scene, contact->kratio, contact->beta, of_moments));
    return inelastic(scene)
               ? need_shear(section, scene, contact->kratio, contact->beta, of_softening)
               : GNEISS_OK;
}

/* Checks laws of bonds that soften, yield or carry moments. */
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

/* The bilinear curve divides an energy between two lines; no other curve reads the keys of its
 * kink. */
static gneiss_status check_curve(const check *section, const gn_scene *scene) {
    if (scene->softening_curve == GN_SOFTENING_BILINEAR) {
        if (scene->softening == GN_SOFTENING_ENERGY) return GNEISS_OK;
        return gn_check_fail(section, "law.softening_curve",
                             "expected softening energy beside bilinear, found another");
    }
    if (scene->kink_stress > 0.0 &&
        fabs(scene->kink_stress - 1.0 / 3.0) > 1e-12) /* 0: no law section */
        return gn_check_fail(section, "law.kink_stress",
                             "expected softening_curve bilinear beside it, found linear");
    if (scene->initial_energy > 0.0 && scene->initial_energy != 0.6)
        return gn_check_fail(section, "law.initial_energy",
                             "expected softening_curve bilinear beside it, found linear");
    return GNEISS_OK;
}

/* Checks that a stress that mu_1 acts on comes with a mu_1. */
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

/* Moments need spins, and are a separate law of bonds. */
gneiss_status gn_check_moments(const check *section, const gn_scene *scene) {
    if (scene->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (!(scene->bond_radius_multiplier > 0)) {
        if (!gn_check_given(section, "bonds.moment_share") ||
            gn_check_given(section, "bonds.radius_multiplier"))
            return GNEISS_OK;
        return gn_check_fail(section, "bonds.moment_share",
                             "expected a radius_multiplier above 0 beside it (otherwise bonds "
                             "carry no moments), found none");
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
