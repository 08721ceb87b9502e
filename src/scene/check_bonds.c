/* What materials have to say of bonds that soften or yield, and what does not go together. */
#include "scene/check.h"

#include <stdio.h>

static gneiss_status need(const check *c, double value, const char *key, const char *reason) {
    if (value > 0) return GNEISS_OK;
    return gn_check_fail(c, key, "required %s, but not given", reason);
}

/* What the material needs to soften. */
static gneiss_status check_softening(const check *c, const gn_scene *s, const gn_material *m) {
    switch (s->softening) {
    case GN_SOFTENING_NONE:
        return GNEISS_OK;
    case GN_SOFTENING_ENERGY:
        return need(c, m->fracture_energy, "fracture_energy", "by softening energy");
    case GN_SOFTENING_STRAIN:
        return need(c, m->fracture_strain, "fracture_strain", "by softening strain");
    case GN_SOFTENING_RATIO:
        return need(c, m->fracture_ratio, "fracture_ratio", "by softening ratio");
    }
    return GNEISS_OK;
}

static gneiss_status check_yield(const check *c, const gn_material *m) {
    for (int k = 0; k < 3; k++) {
        char stress[32], ratio[32];
        snprintf(stress, sizeof stress, "yield_stress_%d", k + 1);
        snprintf(ratio, sizeof ratio, "yield_ratio_%d", k + 1);
        double limit = m->yield_stress[k], before = k ? m->yield_stress[k - 1] : 0.0;
        if (limit > 0) GN_TRY(need(c, m->yield_ratio[k], ratio, "beside its yield_stress"));
        if (!(limit > 0) && m->yield_ratio[k] > 0)
            return gn_check_fail(c, stress, "required beside its yield_ratio, but not given");
        if (limit > 0 && k && !(before > 0 && limit > before))
            return gn_check_fail(c, stress,
                                 "expected more than yield_stress_%d, found %g Pa and %g Pa", k,
                                 limit, before);
    }
    return GNEISS_OK;
}

/* Laws of bonds that soften or yield. */
gneiss_status gn_check_bonds_of(const check *c, const gn_scene *s, const gn_material *m) {
    GN_TRY(check_softening(c, s, m));
    GN_TRY(check_yield(c, m));
    if (s->softening == GN_SOFTENING_NONE && !(m->yield_stress[0] > 0)) return GNEISS_OK;
    if (!(m->kratio > 0))
        return gn_check_fail(c, "kratio",
                             "expected a tangential spring beside bonds that soften or yield, "
                             "found 0");
    return GNEISS_OK;
}

/* How tension and shear damage a bond together is defined for each by itself only. */
gneiss_status gn_check_coupling(const check *c, const gn_scene *s) {
    bool inelastic = s->softening != GN_SOFTENING_NONE;
    for (size_t k = 0; k < s->material_count; k++)
        inelastic = inelastic || s->materials[k].yield_stress[0] > 0;
    if (s->coupling != GN_COUPLING_QUADRATIC || !inelastic) return GNEISS_OK;
    return gn_check_fail(c, "law.coupling",
                         "expected none or linear beside bonds that soften or yield, found "
                         "quadratic");
}
