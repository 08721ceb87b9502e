/* Physics of a contact at one instant, as pure functions on vectors of lanes (kernels/simd.h).
 * Sign: forces act on the first particle; the normal points from the first to the second, so that a
 * positive normal force is tension. */
#ifndef GN_KERNELS_CONTACT_LAW_H
#define GN_KERNELS_CONTACT_LAW_H

#include "kernels/simd.h"

/* The normal from the middle of a step to its end. With v = speed n + across the branch of the
 * middle is d n - dt/2 v, so that it stands at tan(angle) = (dt/2) |across|/(d - dt/2 speed) to n;
 * `rate` is dt/(2 d), and 1/(1 - rate speed) is taken to second order. */
GN_INLINE gn_v3 gn_half_turn(gn_v3 across, gn_v speed, gn_v rate, int space) {
    return gn_scale(gn_fma(rate * rate, speed, rate), across, space);
}

/* Rare: half a step turns the normal by more than a twentieth. Beyond 45 degrees, as where centres
 * (nearly) coincide, there is no telling which way it went: it has not turned then. */
static __attribute__((noinline)) void gn_wide_turn(gn_m wide, gn_v3 *half, gn_v *half2,
                                                   gn_v *shrink) {
    gn_m known = gn_at_least(gn_set(1.0), *half2);
    half->x = gn_keep(known, half->x);
    half->y = gn_keep(known, half->y);
    half->z = gn_keep(known, half->z);
    *half2 = gn_keep(known, *half2);
    *shrink = gn_where(wide, gn_set(1.0) / gn_sqrt(gn_set(1.0) + *half2), *shrink);
}

/* The unit normal in the middle of the step, (n - half)/sqrt(1 + half^2); the root up to half^6. */
GN_INLINE gn_v3 gn_middle_normal(gn_v3 n, gn_v3 *half, int space, gn_v *half2) {
    gn_v h2 = gn_dot(*half, *half, space);
    gn_v shrink = gn_fma(gn_fma(h2, gn_set(0.375), gn_set(-0.5)), h2, gn_set(1.0));
    gn_m wide = gn_not(gn_at_least(gn_set(2.5e-3), h2));
    if (__builtin_expect(gn_bits(wide) != 0, 0)) gn_wide_turn(wide, half, &h2, &shrink);
    *half2 = h2;
    return gn_scale(shrink, gn_sub(n, *half, space), space);
}

/* Turns a vector across the normal of an earlier instant into the tangent plane of n, by the
 * shortest rotation (Labra et al. 2012, ch. 2): t - (t.n)(n_old + n)/(1 + n_old.n), where the last
 * quotient is n less the tangent of half the angle along the way that n went. It keeps |t|, and
 * n_old need not be stored. */
GN_INLINE gn_v3 gn_turn_with_normal(gn_v3 t, gn_v3 n, gn_v3 half, int space) {
    gn_v along = gn_dot(t, n, space);
    return gn_axmy(t, along, gn_sub(n, half, space), space);
}

/* Turns a tangential force by `angle` about n (mean spin of the pair): sine and cosine to fifth
 * order, so that |t| is kept to sixth. Only in 3D: in 2D the spin is normal to the plane. */
GN_INLINE gn_v3 gn_turn_about_normal(gn_v3 t, gn_v3 n, gn_v angle) {
    gn_v a2 = angle * angle;
    gn_v sine = gn_fma(gn_fma(a2, gn_set(1.0 / 120.0), gn_set(-1.0 / 6.0)) * a2, angle, angle);
    gn_v less = gn_fma(a2, gn_set(1.0 / 24.0), gn_set(-0.5)) * a2; /* cos - 1 */
    gn_v3 turned = gn_axpy(t, sine, gn_cross(n, t, 1), 1);
    return gn_axpy(turned, less, t, 1);
}

/* Elastic energy that a jump of force from `trial` to `now` releases when the force was `old`
 * before the step: 1/2 (old + now).(trial - now)/k. It closes the trapezoidal work of the step
 * exactly. */
GN_INLINE gn_v gn_released(gn_v old, gn_v now, gn_v trial, gn_v k) {
    return gn_set(0.5) * (old + now) * (trial - now) / k;
}
GN_INLINE gn_v gn_released3(gn_v3 old, gn_v3 now, gn_v3 trial, gn_v k, int space) {
    gn_v work = gn_dot(gn_add(old, now, space), gn_sub(trial, now, space), space);
    return gn_set(0.5) * work / k;
}

#endif
