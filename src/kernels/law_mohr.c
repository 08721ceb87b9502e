/* Bonds with Mohr-Coulomb strength (law_mohr.h) outside of the kernels. Everything else is the
 * linear law. */
#include "kernels/combine.h"

#include <math.h>

static void set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    gn_linear_set(model, pair, list, c);
    list->mu1[c] = gn_bond_friction(pair);
}

double gn_mohr_strength(const gn_contacts *list, size_t c, double normal) {
    double pressed = -normal;
    if (list->confined) pressed = list->confined[c];
    if (list->confined_f) pressed = (double)list->confined_f[c];
    if (!(list->soa.effects & GN_FX_COUPLED_LINEAR)) pressed = fmax(pressed, 0.0);
    return fmax(0.0, list->rt[c] + list->mu1[c] * pressed);
}

/* Returns the ratio of the load to the strength. With quadratic coupling of tension and shear it is
 * the root of the sum of both squares; for a bond without shear strength it stays infinite. */
double gn_mohr_criterion(const gn_contacts *list, size_t c, double normal, double bent,
                         double shear) {
    const gn_effects fx = list->soa.effects;
    double strength = gn_mohr_strength(list, c, normal);
    double tension = (normal + bent) / list->rn[c];
    double sheared = shear > 0.0 ? shear / strength : 0.0;
    if (fx & GN_FX_COUPLED_QUADRATIC && tension > 0.0) return hypot(tension, sheared);
    return fmax(tension, sheared);
}

const gn_law gn_law_mohr = {GN_LINEAR_FUNCTIONS,          .set = set,
                            .held = gn_linear_held,       .weigh = gn_linear_weigh,
                            .release = gn_linear_release, .criterion = gn_mohr_criterion};
