/* The linear law (law_linear.h) with bonds whose shear strength depends on the normal force
 * (Mohr-Coulomb; Santasusana 2013, eq. 4.36, with the strength in place of the force):
 *     S = R_t + mu_1 <-f_n>,
 * so that pressure increases it. Tension does not reduce it without coupling:
 *     quadratic  (f_n/R_n)^2 + (|F_t|/S)^2 >= 1 breaks,
 *     linear     S = R_t - mu_1 f_n (as YADE's JCFpm), never below 0.
 * f_n is that of the spring, or with `confinement: mean` -A p, p the pressure around the bond
 * (column confined, src/particles/confinement.c). A broken bond follows the linear law with
 * friction mu, the second coefficient. Columns in addition to those of the linear law: mu1. */
#ifndef GN_KERNELS_LAW_MOHR_H
#define GN_KERNELS_LAW_MOHR_H

#include "kernels/law_linear.h"

/* Finds the bonds that break under both loads. The ratios of tension and of shear to strength are
 * compared by their squares; if both contribute, the larger one is the cause. */
GN_INLINE gn_m break_coupled(gn_v rn, gn_v size2, gn_v *strength2, const contact_state *state) {
    gn_v share = gn_max(state->elastic, gn_set(0.0)) / rn, share2 = share * share;
    gn_v whole = *strength2;
    *strength2 = whole * (gn_set(1.0) - share2);
    gn_m together = gn_and(state->intact, gn_at_least(size2, *strength2));
    return gn_and(together, gn_at_least(share2 * whole, size2));
}

/* Finds the intact bonds that reach their strength in this step; tension takes precedence. */
GN_INLINE void break_mohr(const gn_contact_args *args, size_t c, size_t end, contact_state *state,
                          gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    const gn_effects fx = k->soa.effects;
    gn_v rn = gn_load(COLUMN(k, rn) + c), rt = gn_load(COLUMN(k, rt) + c);
    gn_v mu1 = gn_load(COLUMN(k, mu1) + gn_column_at(c, args->uniform.mu1));
    gn_v size2 = gn_dot(state->trial, state->trial, 1);
    state->intact = gn_less(gn_set(0.0), rn);
    gn_m in_tension = gn_and(state->intact, gn_at_least(state->elastic, rn));
    gn_v strength = gn_fma(mu1, pressed_of(args, c, state->elastic), rt);
    strength = gn_max(strength, gn_set(0.0));
    gn_v strength2 = strength * strength;
    if (fx & GN_FX_COUPLED_QUADRATIC)
        in_tension = gn_or(in_tension, break_coupled(rn, size2, &strength2, state));
    gn_m strong = gn_at_least(size2, strength2);
    gn_m in_shear = gn_and(gn_and(state->intact, gn_not(in_tension)), strong);
    state->breaking = gn_or(in_tension, in_shear);
    state->intact = gn_and(state->intact, gn_not(state->breaking));
    if (__builtin_expect(gn_bits(state->breaking) != 0, 0))
        record_breaks(args, c, end, gn_bits(in_tension), gn_bits(in_shear), sums);
}

GN_INLINE void mohr_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                          variant with) {
    linear_trial(args, c, from, vector, with);
}

GN_INLINE contact_force mohr_force(const gn_contact_args *args, size_t c, size_t end,
                                   const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                   variant with) {
    contact_state q = state_of(args, c, vector, with);
    break_mohr(args, c, end, &q, sums);
    return act_of(args, c, vector, &q, lanes, with);
}

#endif
