/* Physics of a contact at one instant, as pure functions on vectors of lanes (kernels/simd.h).
 * Forces act on the first particle; the normal points from the first to the second, so that a
 * positive normal force is tension. */
#ifndef GN_KERNELS_CONTACT_LAW_H
#define GN_KERNELS_CONTACT_LAW_H

#include "kernels/simd.h"

/* Returns the direction of the branch in the middle of the step, scaled so that its component along
 * n is 1. With v = speed n + across, that branch is d n - dt/2 v = (d - dt/2 speed) middle, so that
 * middle = n - half, where |half| = (dt/2) |across|/(d - dt/2 speed) is the tangent of its angle to
 * n. `rate` is dt/(2 d), and 1/(1 - rate speed) is expanded to second order. */
GN_INLINE gn_v3 gn_middle(gn_v3 v, gn_v3 n, gn_v speed, gn_v rate, int space) {
    gn_v scaled = gn_fma(rate * rate, speed, rate);
    return gn_axmy(gn_scale(gn_fma(scaled, speed, gn_set(1.0)), n, space), scaled, v, space);
}

/* Rotates a vector that is tangential to an earlier normal into the tangent plane of n, by means of
 * `middle`. For a vector across the normal of the last instant, whose angle with n is bisected by
 * `middle`, this is the shortest rotation (Labra et al. 2012, ch. 2), t - (t.n)(n_old + n)/(1 +
 * n_old.n), and preserves |t|. A vector across `middle` itself is rotated by half that angle, and
 * its component in the plane of the rotation grows by the factor 1 + half^2/2. A component along
 * `middle` is removed. */
GN_INLINE gn_v3 gn_turn_with_normal(gn_v3 t, gn_v3 n, gn_v3 middle, int space) {
    return gn_axmy(t, gn_dot(t, n, space), middle, space);
}

/* Rotates a tangential force by `angle` about n (mean spin of the pair): t + a n x t - a^2/2 t,
 * which preserves |t| to fourth order. Only in 3D: in 2D the spin is normal to the plane. */
GN_INLINE gn_v3 gn_turn_about_normal(gn_v3 t, gn_v3 n, gn_v angle) {
    gn_v3 side = gn_cross(n, t, 1);
    gn_v3 turned = gn_axpy(t, angle, side, 1);
    return gn_axpy(turned, gn_set(-0.5) * angle * angle, t, 1);
}

/* Returns the elastic energy that is released when a limit changes the force from `trial` to `now`;
 * `old` is the force before the step: 1/2 (old + now).(trial - now)/k. It closes the trapezoidal
 * work of the step exactly. */
GN_INLINE gn_v gn_released(gn_v old, gn_v now, gn_v trial, gn_v k) {
    return gn_set(0.5) * (old + now) * (trial - now) / k;
}
GN_INLINE gn_v gn_released3(gn_v3 old, gn_v3 now, gn_v3 trial, gn_v k, int space) {
    gn_v work = gn_dot(gn_add(old, now, space), gn_sub(trial, now, space), space);
    return gn_set(0.5) * work / k;
}

/* Returns the elastic tangential force before any limit; `relative` is the velocity at the contact
 * across n, `angle` the twist of the step. The twist is applied halfway through the increment:
 * before or after it, the two tangential directions would drive each other. */
GN_INLINE gn_v3 gn_linear_shear(gn_v3 t, gn_v3 relative, gn_v kt, double dt, gn_v3 n, gn_v angle,
                                int twists, int space) {
    if (!twists) return gn_axpy(t, kt * gn_set(dt), relative, space);
    gn_v half = kt * gn_set(0.5 * dt);
    t = gn_turn_about_normal(gn_axpy(t, half, relative, 1), n, angle);
    return gn_axpy(t, half, relative, 1);
}

/* Radial return: reduces the magnitude of slipping forces, whose square is size2, to the limit. */
GN_INLINE gn_v3 gn_linear_slip(gn_v3 trial, gn_v size2, gn_v limit, gn_m slipping, int space) {
    gn_v factor = gn_where(slipping, limit / gn_sqrt(size2), gn_set(1.0));
    return gn_scale(factor, trial, space);
}

/* The normal force of a linear contact in a step, without the dashpot. */
typedef struct gn_linear_crossing {
    gn_v normal; /* N */
    gn_v share;  /* factor on the dashpot's force */
    gn_v way;    /* m: normal times this is twice the energy of the spring */
} gn_linear_crossing;

/* Computes the force of a contact that closed or opened within the step, which acted for a fraction
 * of it only. Forces are given at the ends of steps and act for half a step on either side. With g
 * the gap before, u the overlap after it closed by p = g + u, the spring's impulse is that of a
 * force which begins at the fraction s = u/p: k u (1 + s)/2, and the dashpot acted for 1/2 + s
 * steps. If it opened by p to the gap s p, the full forces of the last instant, at the overlap (1 -
 * s) p, were too large: k (1 - s) p s/2 of the spring, and 1/2 - s of the dashpot's step are
 * subtracted. The energy of a rebound is then in error by some y^4/40 instead of y^2/4, y = w dt,
 * w^2 = k (1/m_i + 1/m_j); with the factors 1 -+ y^2 s (1 - s)/4, from the trapezoidal sums of this
 * and the next step of an isolated pair, by y^8. (y^2 is limited to 1/2: steps are to resolve a
 * contact.) If other forces lengthen or shorten the path of the next step, by the fraction b of
 * this one, the factors are (1 + b/(1 + s))/(1 + b/2) if it closed, 1/(1 + b/2) if it opened, and
 * y^2 is over (1 + b/2)^2; the dashpot is a part of that, by c dt/m times its share. The energy
 * booked at the instant is that which closes those sums: half the force times the path. `stretch`:
 * negative in compression; `path`: its growth in the step; `quarter_y2`: y^2/4; `bias`: path of the
 * other accelerations in a step over `path`; `drag`: c dt (1/m_i + 1/m_j); `acting`: touches at the
 * end of the step. */
GN_INLINE gn_linear_crossing gn_linear_cross(gn_v kn, gn_v stretch, gn_v path, gn_v quarter_y2,
                                             gn_v bias, gn_v drag, gn_m closing, gn_m opening,
                                             gn_m acting) {
    gn_v half = gn_set(0.5), one = gn_set(1.0), zero = gn_set(0.0);
    gn_v most = zero - gn_max(zero - quarter_y2, gn_set(-0.125));
    gn_v s = gn_where(gn_or(closing, opening), stretch / path, zero);
    /* In single precision, a gap that closed within the rounding of its path has just closed. */
    gn_m within = gn_and(gn_at_least(s, zero), gn_at_least(one, s));
    s = gn_pick(GN_MIXED, gn_where(within, s, one), s);
    gn_v share = gn_where(closing, half + s, half - s), full = kn * stretch;
    gn_v longer = gn_max(gn_set(-0.5), zero - gn_max(gn_set(-0.5), zero - bias)) - share * drag;
    longer = gn_max(gn_set(-1.0), longer);
    gn_v mean = one + half * longer, bend = most * s * (one - s) / (mean * mean);
    gn_v in = half * full * (one + s + longer) / mean * (one - bend);
    gn_v out = gn_set(-0.5) * kn * (stretch - path) * s / mean * (one + bend);
    gn_linear_crossing r = {gn_keep(acting, full), gn_keep(acting, one), stretch};
    r.normal = gn_where(closing, in, gn_where(opening, out, r.normal));
    r.share = gn_where(gn_or(closing, opening), share, r.share);
    r.way = gn_where(closing, path, gn_where(opening, zero - path, r.way));
    return r;
}

#endif
