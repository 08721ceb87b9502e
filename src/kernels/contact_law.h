/* Physics of a contact at one instant, as pure functions on vectors of lanes (kernels/simd.h).
 * Sign: forces act on the first particle; the normal points from the first to the second, so that a
 * positive normal force is tension. */
#ifndef GN_KERNELS_CONTACT_LAW_H
#define GN_KERNELS_CONTACT_LAW_H

#include "kernels/simd.h"

/* Turns the tangential force of the last step into the present tangent plane (Labra et al. 2012,
 * ch. 2). With s = dt v_perp/d the normal turned by n - n_old = s + O(s^2); the rotation about
 * n_old x n takes t to t - (t.n)(n_old + n)/(1 + n_old.n) = t - (t.n)(n - s/2) up to third order.
 * It keeps |t| to fourth order, so nothing is lost in a full turn, and n_old need not be stored.
 * `across` is v_perp, `rate` is dt/(2 d). */
GN_INLINE gn_v3 gn_turn_with_normal(gn_v3 t, gn_v3 n, gn_v3 across, gn_v rate, int space) {
    gn_v along = gn_dot(t, n, space);
    gn_v3 axis = gn_axmy(n, rate, across, space);
    return gn_axmy(t, along, axis, space);
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
