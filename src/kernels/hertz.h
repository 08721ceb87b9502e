/* Hertz-Mindlin contacts at one instant, as pure functions on vectors of lanes; walls and surfaces
 * run the scalar instance. With R the reduced radius, u the overlap and a = sqrt(R u) the radius of
 * the contact:
 *     f = 4/3 E* a u, df/du = S_n = 2 E* a, energy 8/15 E* a u^2        (Hertz 1882)
 *     S_t = 8 G* a                                                      (Mindlin 1949, no slip)
 *     1/E* = sum (1 - nu^2)/E, 1/G* = sum (2 - nu)/G, over both sides; a rigid one adds nothing.
 * `kn` is 2 E* sqrt(R), `kt` 8 G* sqrt(R): stiffness over the root of the overlap. */
#ifndef GN_KERNELS_HERTZ_H
#define GN_KERNELS_HERTZ_H

#include "kernels/contact_law.h"

typedef struct gn_hertz_press {
    gn_v root, stiffness, normal; /* m^1/2; N/m, S_n; N, tension positive */
} gn_hertz_press;

/* Of an overlap >= 0. */
GN_INLINE gn_hertz_press gn_hertz_normal(gn_v kn, gn_v overlap) {
    gn_hertz_press p = {.root = gn_sqrt(overlap)};
    p.stiffness = kn * p.root;
    p.normal = gn_set(-2.0 / 3.0) * p.stiffness * overlap;
    return p;
}

/* Of the normal spring, from its force. */
GN_INLINE gn_v gn_hertz_stored(gn_v normal, gn_v overlap) {
    return gn_set(-0.4) * normal * overlap;
}

/* Coefficient of the dashpot, c sqrt(S_n), for which the restitution does not depend on the speed
 * (Tsuji, Tanaka and Ishida 1992; Antypov and Elliott 2011: in x = u^(5/4) over the time that runs
 * with sqrt(5/6 S_n/m) it is the linear oscillator, of damping fraction beta). Forces of a step see
 * the velocity of half a step before, which damps by 1 + beta y/2 = 1 + c sqrt(S_n) dt/(4 m) too
 * much, y = dt sqrt(5/6 S_n/m), as in dashpot.h, whose first term this is. `lag`: c dt/(4 m). */
GN_INLINE gn_v gn_hertz_dashpot(gn_v c, gn_v lag, gn_v stiffness) {
    gn_v root = gn_sqrt(stiffness);
    return c * root / gn_fma(lag, root, gn_set(1.0));
}

/* A contact that closed within the step to the overlap s p, p the path: the dashpot's share of what
 * it does at the overlap p. Its forces go with u^(1/4); with the one of the first instant replaced
 * by this one, steps add up to the integral: by Euler and Maclaurin (Navot 1961) with s^(1/4)
 * replaced by -zeta(-1/4, 1 + s), to 2e-3. Without it the restitution is off by a few percent, by
 * the phase at which a step begins. The spring's u^(3/2) needs none, see law_hertz.h. */
GN_INLINE gn_v gn_hertz_closing(gn_v s) {
    return gn_fma(gn_set(0.122) * s, s - gn_set(1.0), s + gn_set(0.32045));
}

/* The same of one that opened within the step from the overlap a p: added at the first instant
 * behind. */
GN_INLINE gn_v gn_hertz_opening(gn_v a) {
    return gn_hertz_closing(a) - gn_sqrt(gn_sqrt(a));
}

/* What is left of the tangential force of the last step when the contact has shrunk: as much as of
 * its radius, or unloading would give back more than was put in (Thornton, Cummins and Cleary
 * 2013). `closeness`: of the last step. */
GN_INLINE gn_v3 gn_hertz_rescaled(gn_v3 before, gn_v closeness, gn_v root, int space) {
    gn_v share = root * closeness;
    gn_m shrunk = gn_less(share, gn_set(1.0 - (GN_MIXED ? 0x1p-21 : 0x1p-50)));
    return gn_scale(gn_where(shrunk, share, gn_set(1.0)), before, space);
}

/* What the tangential spring lost in a step in which its force came from `before` to `now` along
 * `way`: what it held, S_t/2 times as much as its force squared, and the trapezoidal work, less
 * what it holds. The stiffness is another one with every overlap: what a force that stays holds
 * less when the contact grows is lost as well. */
GN_INLINE gn_v gn_hertz_lost(gn_v3 before, gn_v3 now, gn_v3 way, gn_v closeness_past,
                             gn_v closeness, gn_v kt, int space) {
    gn_v held =
        gn_dot(before, before, space) * closeness_past - gn_dot(now, now, space) * closeness;
    gn_v work = gn_dot(gn_add(before, now, space), way, space);
    return gn_set(0.5) * (held / gn_max(kt, gn_set(GN_TINY)) + work);
}

#endif
