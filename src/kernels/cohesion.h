/* Attraction of two spheres at one instant, as pure functions on vectors of lanes; walls run the
 * scalar instance. R is the reduced radius, w the work of adhesion (J/m2), u the overlap, negative
 * for a gap.
 *
 * JKR (Johnson, Kendall and Roberts 1971): with the radius a of the contact
 *     u = a^2/R - sqrt(2 pi w a/E*),  f = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3), compression > 0.
 * Both end where du/da = 0, at the radius a_1 = (pi w R^2/(8 E*))^(1/3) and the gap 3 a_1^2/R (the
 * `span`). With s = sqrt(a/a_1) >= 1 and the pull-off force A = 3/2 pi w R (the `adhesion`)
 *     u = span (s^4 - 4 s)/3,  f = A (s^6 - 6 s^3)/9,
 *     energy = A span/36 (8/15 s^10 - 16/3 s^7 + 8 s^4), 0 for separated spheres.
 * The largest attraction is A, at s^3 = 3; 5/9 A is left at the separation. A contact that forms at
 * u = 0, where s^3 = 4, loses the energy that it has there, and one that separates that of s = 1.
 *
 * DMT (Derjaguin, Muller and Toporov 1975), in the form of a constant attraction A = 2 pi w R
 * beside Hertz's force while the spheres touch (Maugis 2000).
 *
 * Liquid bridge of volume V at the gap D (Willett et al. 2000, Langmuir 16, 9396, eq. 12; D is
 * twice their half-separation): attraction A/(1 + 1.05 x + 2.5 x^2), x = D sqrt(r/V), A = 2 pi r
 * gamma cos theta, with r = 2 R for unequal spheres (Derjaguin's approximation), which is the
 * `span`. Spheres that touch attract each other by A. It ruptures at D = (1 + theta/2) V^(1/3)
 * (Lian, Thornton and Adams 1993). */
#ifndef GN_KERNELS_COHESION_H
#define GN_KERNELS_COHESION_H

#include "kernels/hertz.h"

#include <math.h>

/* Energies over A span that a JKR contact loses when it forms and when it separates; their sum is
 * 7.09 (w^5 R^4/E*^2)^(1/3) (Thornton and Ning 1998). The first is 8/15 of the cube root of 4. */
#define GN_JKR_FORMED    (8.0 / 15.0 * 1.5874010519681994)
#define GN_JKR_SEPARATED (4.0 / 45.0)

/* Values of `onset` of a pair with liquid: from -2 to -1 it touches and asks for a bridge, whose
 * force will be late by -1/2 minus this, in steps; between 0 and GN_BRIDGE_DRY the force of a new
 * bridge is late by this. */
#define GN_BRIDGE_RUPTURED (-4.0)
#define GN_BRIDGE_DRY      8.0 /* the particles touch, and had no liquid */

/* Returns s of an overlap u >= -span. With t = s - 1, 3 (u + span)/span = t^2 (t^2 + 4 t + 6); the
 * root of this is solved by Newton's method, which converges for any h > 0 because its slope has
 * the sign and the order of that at the solution. */
GN_INLINE gn_v gn_jkr_root(gn_v overlap, gn_v span) {
    gn_v least = gn_where(gn_less(gn_set(0.0), span), span, gn_set(1.0));
    gn_v h = gn_sqrt(gn_max(gn_set(3.0) * (overlap + least) / least, gn_set(0.0)));
    gn_v t = h / (gn_set(2.449489742783178) + gn_sqrt(h));
    for (int k = 0; k < 5; k++) {
        gn_v q = gn_sqrt(gn_fma(t, t + gn_set(4.0), gn_set(6.0)));
        t = t - gn_fma(t, q, gn_set(0.0) - h) * q /
                    gn_fma(gn_set(2.0) * t, t + gn_set(3.0), gn_set(6.0));
    }
    return t + gn_set(1.0);
}

/* Returns the force of a JKR contact over A, tension positive. */
GN_INLINE gn_v gn_jkr_pull(gn_v s) {
    gn_v cube = s * s * s;
    return gn_set(1.0 / 9.0) * cube * (gn_set(6.0) - cube);
}

/* Returns its energy over A span. */
GN_INLINE gn_v gn_jkr_stored(gn_v s) {
    gn_v cube = s * s * s;
    gn_v sum = gn_fma(gn_fma(gn_set(8.0 / 15.0), cube, gn_set(-16.0 / 3.0)), cube, gn_set(8.0));
    return gn_set(1.0 / 36.0) * s * cube * sum;
}

/* Returns the root of the radius of a JKR contact over that of R, which takes the place of the root
 * of the overlap in Hertz's law: a^2 = R root^2. */
GN_INLINE gn_v gn_jkr_width(gn_v s, gn_v span) {
    return s * s * gn_sqrt(gn_set(1.0 / 3.0) * gn_max(span, gn_set(0.0)));
}

/* Returns the force of a bridge over A at a gap >= 0. */
GN_INLINE gn_v gn_bridge_pull(gn_v gap, gn_v span, gn_v volume) {
    gn_v x = gap * gn_sqrt(span / gn_max(volume, gn_set(GN_TINY)));
    return gn_set(1.0) / gn_fma(gn_fma(gn_set(2.5), x, gn_set(1.05)), x, gn_set(1.0));
}

/* Returns the energy of a bridge over A, m: minus the work to its rupture. In an overlap it
 * decreases by A u. `rupture`: (1 + theta/2)^3. */
static inline double gn_bridge_energy(double gap, double span, double volume, double rupture) {
    const double root = sqrt(10.0 - 1.05 * 1.05), scale = sqrt(volume / span);
    const double open = fmax(gap, 0.0) / scale, most = cbrt(rupture * volume) / scale;
    const double angle = atan((5.0 * most + 1.05) / root) - atan((5.0 * open + 1.05) / root);
    return fmin(gap, 0.0) - scale * 2.0 / root * fmax(angle, 0.0);
}

/* Returns the force over A of a bridge that ruptured within the step, multiplied by the share of
 * the step for which it acted; `path`: growth of the gap in the step, m. */
static inline double gn_bridge_tail(double gap, double path, double span, double volume,
                                    double rupture) {
    const double most = cbrt(rupture * volume), x = most * sqrt(span / volume);
    const double s = path > 0.0 ? fmin(fmax((gap - most) / path, 0.0), 1.0) : 0.5;
    return (0.5 - s) / (1.0 + (1.05 + 2.5 * x) * x);
}

#endif
