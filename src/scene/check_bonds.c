/* What materials have to say of bonds that soften or yield, and what does not go together. */
#include "scene/check.h"

#include <math.h>
#include <stdio.h>

/* What the material needs to soften. */
static gneiss_status check_softening(const check *c, const gn_scene *s, const gn_material *m) {
    switch (s->softening) {
    case GN_SOFTENING_NONE:
        return GNEISS_OK;
    case GN_SOFTENING_ENERGY:
        return gn_check_need(c, m->fracture_energy, "fracture_energy", "by softening energy");
    case GN_SOFTENING_STRAIN:
        return gn_check_need(c, m->fracture_strain, "fracture_strain", "by softening strain");
    case GN_SOFTENING_RATIO:
        return gn_check_need(c, m->fracture_ratio, "fracture_ratio", "by softening ratio");
    }
    return GNEISS_OK;
}

static gneiss_status check_yield(const check *c, const gn_material *m) {
    for (int k = 0; k < 3; k++) {
        char stress[32], ratio[32];
        snprintf(stress, sizeof stress, "yield_stress_%d", k + 1);
        snprintf(ratio, sizeof ratio, "yield_ratio_%d", k + 1);
        double limit = m->yield_stress[k], before = k ? m->yield_stress[k - 1] : 0.0;
        if (limit > 0)
            GN_TRY(gn_check_need(c, m->yield_ratio[k], ratio, "beside its yield_stress"));
        if (!(limit > 0) && m->yield_ratio[k] > 0)
            return gn_check_fail(c, stress, "required beside its yield_ratio, but not given");
        if (limit > 0 && k && !(before > 0)) {
            char missing[32];
            snprintf(missing, sizeof missing, "yield_stress_%d", k);
            return gn_check_fail(c, missing, "required beside %s, but not given", stress);
        }
        if (limit > 0 && k && !(limit > before))
            return gn_check_fail(c, stress,
                                 "expected more than yield_stress_%d, found %g Pa and %g Pa", k,
                                 limit, before);
    }
    return GNEISS_OK;
}

static gneiss_status need_shear(const check *c, const gn_scene *s, double kratio, double beta,
                                const char *reason) {
    bool area = gn_scene_by_area(s);
    if ((area ? beta : kratio) != 0.0) return GNEISS_OK;
    return gn_check_fail(c, area ? "beta" : "kratio", "expected a tangential spring %s, found 0",
                         reason);
}

static const char of_moments[] =
    "with bonds.radius_multiplier (the twist of a bond has the stiffness of its shear)";
static const char of_softening[] = "beside bonds that soften or yield";

static bool inelastic(const gn_scene *s) {
    bool found = s->softening != GN_SOFTENING_NONE;
    for (size_t k = 0; k < s->material_count; k++)
        found = found || s->materials[k].yield_stress[0] > 0;
    return found;
}

gneiss_status gn_check_shear_of_pair(const check *c, const gn_scene *s, const gn_contact_def *d) {
    if (s->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (s->bond_radius_multiplier > 0) GN_TRY(need_shear(c, s, d->kratio, d->beta, of_moments));
    return inelastic(s) ? need_shear(c, s, d->kratio, d->beta, of_softening) : GNEISS_OK;
}

/* Laws of bonds that soften or yield, and of such that carry moments. */
gneiss_status gn_check_bonds_of(const check *c, const gn_scene *s, const gn_material *m) {
    if (s->bond_radius_multiplier > 0) GN_TRY(need_shear(c, s, m->kratio, m->beta, of_moments));
    GN_TRY(check_softening(c, s, m));
    GN_TRY(check_yield(c, m));
    if (s->softening == GN_SOFTENING_NONE && !(m->yield_stress[0] > 0)) return GNEISS_OK;
    return need_shear(c, s, m->kratio, m->beta, of_softening);
}

static bool frictional(const gn_scene *s) {
    bool found = false;
    for (size_t k = 0; k < s->material_count; k++)
        found = found || s->materials[k].bond_friction > 0;
    for (size_t k = 0; k < s->contact_count; k++) found = found || s->contacts[k].bond_friction > 0;
    return found;
}

/* Two lines share out an energy, and what they are drawn by is read by no other curve. */
static gneiss_status check_curve(const check *c, const gn_scene *s) {
    if (s->softening_curve == GN_SOFTENING_BILINEAR) {
        if (s->softening == GN_SOFTENING_ENERGY) return GNEISS_OK;
        return gn_check_fail(c, "law.softening_curve",
                             "expected softening energy beside bilinear, found another");
    }
    if (s->kink_stress > 0.0 && fabs(s->kink_stress - 1.0 / 3.0) > 1e-12) /* 0: no law section */
        return gn_check_fail(c, "law.kink_stress",
                             "expected softening_curve bilinear beside it, found linear");
    if (s->initial_energy > 0.0 && s->initial_energy != 0.6)
        return gn_check_fail(c, "law.initial_energy",
                             "expected softening_curve bilinear beside it, found linear");
    return GNEISS_OK;
}

/* What acts on mu_1 needs one. */
gneiss_status gn_check_coupling(const check *c, const gn_scene *s) {
    if (s->fracture_energy_of == GN_FRACTURE_BODY && s->softening != GN_SOFTENING_ENERGY)
        return gn_check_fail(c, "law.fracture_energy_of",
                             "expected softening energy beside body, found another");
    if (s->has_law) GN_TRY(check_curve(c, s));
    if (s->bonds != GN_SWITCH_ON || frictional(s)) return GNEISS_OK;
    if (s->coupling == GN_COUPLING_LINEAR)
        return gn_check_fail(c, "law.coupling",
                             "expected a bond_friction above 0 beside linear (tension takes mu_1 "
                             "f_n from the strength in shear), found none");
    if (s->confinement == GN_CONFINEMENT_MEAN)
        return gn_check_fail(c, "law.confinement",
                             "expected a bond_friction above 0 beside mean, found none");
    return GNEISS_OK;
}

static const char *beside_moments(const gn_scene *s) {
    if (s->softening != GN_SOFTENING_NONE) return "law.softening";
    for (size_t k = 0; k < s->material_count; k++)
        if (s->materials[k].yield_stress[0] > 0) return "yield_stress_1";
    return NULL;
}

/* Moments need spins, and are a law of bonds of their own. */
gneiss_status gn_check_moments(const check *c, const gn_scene *s) {
    if (s->bonds != GN_SWITCH_ON) return GNEISS_OK;
    if (!(s->bond_radius_multiplier > 0)) {
        if (!gn_check_given(c, "bonds.moment_share") ||
            gn_check_given(c, "bonds.radius_multiplier"))
            return GNEISS_OK;
        return gn_check_fail(c, "bonds.moment_share",
                             "expected a radius_multiplier above 0 beside it (without one bonds "
                             "carry no moments), found none");
    }
    if (s->rotation == GN_SWITCH_OFF)
        return gn_check_fail(c, "bonds.radius_multiplier",
                             "expected 0 where particles do not spin (law.rotation: off), found "
                             "%g: what does not turn cannot bend or twist a bond",
                             s->bond_radius_multiplier);
    const char *other = beside_moments(s);
    if (!other) return GNEISS_OK;
    return gn_check_fail(c, "bonds.radius_multiplier",
                         "expected 0 beside %s (damage and yield are laws of the forces of a bond "
                         "alone; what they would do to its moments is not defined), found %g",
                         other, s->bond_radius_multiplier);
}
