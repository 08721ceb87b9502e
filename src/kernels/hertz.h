/* Hertz-Mindlin contacts at one instant, as pure functions on vectors of lanes; walls and surfaces
 * run the scalar instance. With R the reduced radius, u the overlap and a = sqrt(R u) the radius of
 * the contact:
 *     f = 4/3 E* a u, df/du = S_n = 2 E* a, energy 8/15 E* a u^2        (Hertz 1882)
 *     S_t = 8 G* a                                                      (Mindlin 1949, no slip)
 *     1/E* = sum (1 - nu^2)/E, 1/G* = sum (2 - nu)/G, over both sides; a rigid one adds 0.
 * `kn` is 2 E* sqrt(R), `kt` 8 G* sqrt(R): stiffness divided by the root of the overlap. */
#ifndef GN_KERNELS_HERTZ_H
#define GN_KERNELS_HERTZ_H

#include "kernels/contact_law.h"

typedef struct gn_hertz_press {
    gn_v root, stiffness, normal; /* m^1/2; N/m, S_n; N, tension positive */
} gn_hertz_press;

/* Computes root, stiffness and force of an overlap >= 0. */
GN_INLINE gn_hertz_press gn_hertz_normal(gn_v kn, gn_v overlap) {
    gn_hertz_press p = {.root = gn_sqrt(overlap)};
    p.stiffness = kn * p.root;
    p.normal = gn_set(-2.0 / 3.0) * p.stiffness * overlap;
    return p;
}

/* Returns the energy of the normal spring from its force. */
GN_INLINE gn_v gn_hertz_stored(gn_v normal, gn_v overlap) {
    return gn_set(-0.4) * normal * overlap;
}

/* Returns the coefficient of the dashpot, c sqrt(S_n), for which the restitution does not depend on
 * the speed (Tsuji, Tanaka and Ishida 1992; Antypov and Elliott 2011: in x = u^(5/4), over a time
 * scaled by sqrt(5/6 S_n/m), the contact is the linear oscillator with damping fraction beta).
 * Forces of a step use the velocity of half a step before; this overestimates damping by the factor
 * 1 + beta y/2 = 1 + c sqrt(S_n) dt/(4 m), y = dt sqrt(5/6 S_n/m), which is the first term of
 * dashpot.h. `lag`: c dt/(4 m). */
GN_INLINE gn_v gn_hertz_dashpot(gn_v c, gn_v lag, gn_v stiffness) {
    gn_v root = gn_sqrt(stiffness);
    return c * root / gn_fma(lag, root, gn_set(1.0));
}

/* Returns the factor on the dashpot's force for a contact that closed within the step: its path p
 * in the step led to the overlap s p. The dashpot's force is proportional to u^(1/4). With its
 * first value multiplied by this factor, the sum over the steps equals the integral: by Euler and
 * Maclaurin (Navot 1961), s^(1/4) is replaced by -zeta(-1/4, 1 + s), to 2e-3. Otherwise the
 * restitution would have an error of a few percent that depends on the phase at which a step
 * begins. The spring's u^(3/2) needs no factor, see law_hertz.h. */
GN_INLINE gn_v gn_hertz_closing(gn_v s) {
    return gn_fma(gn_set(0.122) * s, s - gn_set(1.0), s + gn_set(0.32045));
}

/* Returns the factor for a contact that opened within the step, from the overlap a p; the resulting
 * force is added at the first instant after the opening. */
GN_INLINE gn_v gn_hertz_opening(gn_v a) {
    return gn_hertz_closing(a) - gn_sqrt(gn_sqrt(a));
}

/* Returns the tangential force of the last step. If the contact has shrunk, the force is reduced in
 * proportion to its radius; otherwise unloading would return more energy than was stored (Thornton,
 * Cummins and Cleary 2013). `closeness`: that of the last step. */
GN_INLINE gn_v3 gn_hertz_rescaled(gn_v3 before, gn_v closeness, gn_v root, int space) {
    gn_v share = root * closeness;
    gn_m shrunk = gn_less(share, gn_set(1.0 - (GN_MIXED ? 0x1p-21 : 0x1p-50)));
    return gn_scale(gn_where(shrunk, share, gn_set(1.0)), before, space);
}

/* Returns the energy lost by the tangential spring in a step in which its force changed from
 * `before` to `now` along `way`: its energy before (the square of the force over 2 S_t) plus the
 * trapezoidal work, minus its energy now. The stiffness changes with the overlap: the energy of a
 * constant force decreases when the contact grows, and this difference counts as lost as well. */
GN_INLINE gn_v gn_hertz_lost(gn_v3 before, gn_v3 now, gn_v3 way, gn_v closeness_past,
                             gn_v closeness, gn_v kt, int space) {
    gn_v held =
        gn_dot(before, before, space) * closeness_past - gn_dot(now, now, space) * closeness;
    gn_v work = gn_dot(gn_add(before, now, space), way, space);
    return gn_set(0.5) * (held / gn_max(kt, gn_set(GN_TINY)) + work);
}

#endif
