/* Physics of a contact at one instant, as pure functions on vectors of lanes (kernels/simd.h).
 * Sign: forces act on the first particle; the normal points from the first to the second, so that a
 * positive normal force is tension. */
#ifndef GN_KERNELS_CONTACT_LAW_H
#define GN_KERNELS_CONTACT_LAW_H

#include "kernels/simd.h"

/* Direction of the branch in the middle of the step, of the length at which its component along n
 * is 1: with v = speed n + across that branch is d n - dt/2 v = (d - dt/2 speed) middle, so that
 * middle = n - half, |half| = (dt/2) |across|/(d - dt/2 speed) the tangent of the angle to n.
 * `rate` is dt/(2 d), and 1/(1 - rate speed) is taken to second order. */
GN_INLINE gn_v3 gn_middle(gn_v3 v, gn_v3 n, gn_v speed, gn_v rate, int space) {
    gn_v scaled = gn_fma(rate * rate, speed, rate);
    return gn_axmy(gn_scale(gn_fma(scaled, speed, gn_set(1.0)), n, space), scaled, v, space);
}

/* Takes a vector across an earlier normal into the tangent plane of n, along `middle`.
 * Across the normal of the last instant, which `middle` halves the angle to, that is the shortest
 * rotation (Labra et al. 2012, ch. 2), t - (t.n)(n_old + n)/(1 + n_old.n), and keeps |t|. Across
 * `middle` itself it turns by half that angle and stretches, by a factor 1 + half^2/2, what lies in
 * the plane of the turn. Whatever is along `middle` drops out. */
GN_INLINE gn_v3 gn_turn_with_normal(gn_v3 t, gn_v3 n, gn_v3 middle, int space) {
    return gn_axmy(t, gn_dot(t, n, space), middle, space);
}

/* Turns a tangential force by `angle` about n (mean spin of the pair): t + a n x t - a^2/2 t, which
 * keeps |t| to fourth order. Only in 3D: in 2D the spin is normal to the plane. */
GN_INLINE gn_v3 gn_turn_about_normal(gn_v3 t, gn_v3 n, gn_v angle) {
    gn_v3 side = gn_cross(n, t, 1);
    gn_v3 turned = gn_axpy(t, angle, side, 1);
    return gn_axpy(turned, gn_set(-0.5) * angle * angle, t, 1);
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
