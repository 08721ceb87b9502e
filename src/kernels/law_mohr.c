/* Bonds with Mohr-Coulomb strength (law_mohr.h) for all but the kernels. All else is the linear
 * law's. */
#include "kernels/combine.h"

#include <math.h>

/* Of two materials the weaker one, as with all strengths. */
static void set(const gn_law_model *m, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    gn_linear_set(m, pair, list, c);
    list->mu1[c] =
        GN_OWN(pair, bond_friction, fmin(pair->a->bond_friction, pair->b->bond_friction));
}

/* With tension and shear coupled by squares the root of their sum; of a bond without strength in
 * shear left infinite. */
static double criterion(const gn_contacts *list, size_t c, double normal, double shear) {
    const gn_effects fx = list->soa.effects;
    double pressed = fx & GN_FX_COUPLED_LINEAR ? -normal : fmax(0.0, -normal);
    double strength = fmax(0.0, list->rt[c] + list->mu1[c] * pressed);
    double tension = normal / list->rn[c];
    double sheared = shear > 0.0 ? shear / strength : 0.0;
    if (fx & GN_FX_COUPLED_QUADRATIC && tension > 0.0) return hypot(tension, sheared);
    return fmax(tension, sheared);
}

const gn_law gn_law_mohr = {.derive = gn_linear_derive,
                            .set = set,
                            .set_dashpot = gn_linear_set_dashpot,
                            .weigh = gn_linear_weigh,
                            .meeting = gn_linear_meeting,
                            .spring = gn_linear_spring,
                            .held = gn_linear_held,
                            .release = gn_linear_release,
                            .criterion = criterion,
                            .slips = gn_linear_slips,
                            .touch_spring = gn_linear_touch_spring,
                            .touch_stored = gn_linear_touch_stored,
                            .touch = gn_linear_touch};
