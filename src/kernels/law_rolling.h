/* Rolling and twisting resistance of unbonded contacts, in addition to the linear law or that of
 * Hertz: elastic-plastic (type C of Ai, Chen, Rotter and Ooi 2011, Powder Technology 206, 269-282,
 * without its dashpot). The relative rotation of the two particles is w = w_j - w_i; across the
 * normal it is rolling, along it twisting. Each has a moment that grows by k_r w dt and stays below
 * a limit: |M_r| <= mu_r R f, |M_t| <= mu_t R f, k_r = k_t R^2, f the compressive force, R the
 * reduced radius (at a plane that of the particle), k_t the tangential stiffness. Both are equal
 * and opposite on the two particles, and vanish in rigid rotation of the pair. By Hertz's law k_t
 * follows the overlap: moments shrink with the contact as tangential forces do (hertz.h).
 *
 * Columns in addition to those of the law: rolling (mu_r R), twisting (mu_t R), reduced (R); state:
 * roll, the moment on the first particle, both parts together; in 2D only its third component is
 * used. */
#ifndef GN_KERNELS_LAW_ROLLING_H
#define GN_KERNELS_LAW_ROLLING_H

#include "kernels/law_beam.h"
#include "kernels/law_hertz.h"

/* Effect of the overlap on the tangential spring: k_t is multiplied by `root`; `past` and `now` are
 * its inverse in the last step and in this one. For the linear law all are 1. */
typedef struct roll_grip {
    gn_v root, past, now;
} roll_grip;

/* Moments of the last step, rotated, and relative rotations of the ends. */
typedef struct roll_step {
    beam_parts before, way;
} roll_step;

GN_INLINE roll_step roll_step_of(const gn_contact_args *args, size_t c, const stage *vector,
                                 variant with) {
    const gn_v zero = gn_set(0.0), dt = gn_set(args->dt);
    const gn_v3 n = vector->geometry.n, none = {zero, zero, zero};
    const gn_v3 old = load_moment(args, COLUMN(args->contacts, roll), c, with),
                spin = relative_spin(args, c);
    roll_step s = {{old, zero}, {none, zero}};
    if (!with.space) {
        s.way.bend.z = dt * spin.z;
        return s;
    }
    const gn_v3 middle = middle_again(args, c, vector, with);
    const gn_v q = mirror_factor(middle);
    s.before = parts_turned(old, n, middle, q);
    s.before.bend = gn_turn_about_normal(s.before.bend, n, vector->angle);
    beam_parts rate = turn_rate(spin, n, middle, q);
    s.way.bend = gn_linear_shear(none, rate.bend, gn_set(1.0), args->dt, n, vector->angle, 1, 1);
    s.way.twist = dt * rate.twist;
    return s;
}

/* Computes the moment on the first particle under the compressive force `pressed` >= 0, and stores
 * it in its column. */
GN_INLINE void roll(const gn_contact_args *args, size_t c, const stage *vector, gn_v pressed,
                    roll_grip grip, lane_sums *sums, variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0);
    gn_v reduced = gn_load(COLUMN(k, reduced) + gn_column_at(c, args->uniform.reduced));
    gn_v kt = gn_load(COLUMN(k, kt) + gn_column_at(c, args->uniform.kt));
    gn_v kr = kt * reduced * reduced, stiff = kr * grip.root;
    const roll_step s = roll_step_of(args, c, vector, with);
    gn_v limit = pressed * gn_load(COLUMN(k, rolling) + gn_column_at(c, args->uniform.rolling));
    gn_v3 bend = gn_hertz_rescaled(s.before.bend, grip.past, grip.root, 1);
    bend = gn_axpy(bend, stiff, s.way.bend, 1);
    gn_v size2 = gn_dot(bend, bend, 1);
    gn_m over = gn_less(limit * limit, size2);
    if (gn_bits(over)) bend = gn_linear_slip(bend, size2, limit, over, 1);
    gn_v3 left = {zero, zero, s.before.twist}, now = {zero, zero, zero}, way = now;
    gn_v twist = zero;
    if (with.space) {
        limit = pressed * gn_load(COLUMN(k, twisting) + gn_column_at(c, args->uniform.twisting));
        left = gn_hertz_rescaled(left, grip.past, grip.root, 1);
        twist = gn_fma(stiff, s.way.twist, left.z);
        twist = zero - gn_max(zero - gn_max(twist, zero - limit), zero - limit);
    }
    if (with.energy) {
        left.z = s.before.twist;
        now.z = twist;
        way.z = s.way.twist;
        sums->rolling = sums->rolling +
                        gn_hertz_lost(s.before.bend, bend, s.way.bend, grip.past, grip.now, kr, 1) +
                        gn_hertz_lost(left, now, way, grip.past, grip.now, kr, 1);
        gn_v both = gn_dot(bend, bend, 1) + twist * twist;
        if (args->measure)
            sums->elastic_bending =
                sums->elastic_bending + gn_set(0.5) * both * grip.now / gn_max(kr, gn_set(GN_TINY));
    }
    store_moment(args, COLUMN(k, roll), c,
                 with.space ? gn_axpy(bend, twist, vector->geometry.n, 1) : bend, with);
}

/* Returns the compressive force, which is zero where the dashpot causes tension. */
GN_INLINE gn_v pressing(const stage *vector, gn_v normal) {
    gn_v beyond =
        gn_fma(gn_set(GN_OVERLAP_ROUNDING), vector->geometry.distance, vector->geometry.stretch);
    return gn_keep(gn_less(beyond, gn_set(0.0)), gn_max(gn_set(0.0) - normal, gn_set(0.0)));
}

GN_INLINE void rolling_trial(const gn_contact_args *args, size_t c, const brief *from,
                             stage *vector, variant with) {
    linear_trial(args, c, from, vector, with);
}

GN_INLINE contact_force rolling_force(const gn_contact_args *args, size_t c, size_t end,
                                      const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                      variant with) {
    const gn_v one = gn_set(1.0);
    contact_force f = linear_force(args, c, end, vector, lanes, sums, with);
    roll(args, c, vector, pressing(vector, f.normal), (roll_grip){one, one, one}, lanes, with);
    return f;
}

GN_INLINE void hertz_rolling_trial(const gn_contact_args *args, size_t c, const brief *from,
                                   stage *vector, variant with) {
    hertz_trial(args, c, from, vector, with);
}

GN_INLINE contact_force hertz_rolling_force(const gn_contact_args *args, size_t c, size_t end,
                                            const stage *vector, lane_sums *lanes,
                                            gn_contact_sums *sums, variant with) {
    const gn_v past = gn_load(COLUMN(args->contacts, closeness) + c);
    contact_force f = hertz_force(args, c, end, vector, lanes, sums, with);
    const gn_v now = gn_load(COLUMN(args->contacts, closeness) + c), one = gn_set(1.0);
    gn_v root = gn_keep(gn_less(gn_set(0.0), now), one / gn_max(now, gn_set(GN_TINY)));
    roll(args, c, vector, pressing(vector, f.normal), (roll_grip){root, past, now}, lanes, with);
    return f;
}

#endif
