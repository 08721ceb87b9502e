/* Bonds that carry moments, in the contact kernel: the linear brittle law, with the bond a beam of
 * circular section of radius R between the two particles (the parallel bond of Potyondy and Cundall
 * 2004, Int. J. Rock Mech. Min. Sci. 41, eq. 10-19; with R_b = R). A spring of k_n per area over
 * the section has a bending stiffness of k_n I/A, one of k_t per area a twisting stiffness of k_t
 * J/A: with A = pi R^2, I = pi R^4/4 and J = pi R^4/2 these are k_n R^2/4 and k_t R^2/2; in 2D, for
 * a section 2R x 1 m, k_n R^2/3 and no twist. Moments are incremental: k (w_j - w_i) dt, bending
 * across the normal and twist along it. The extreme fibre has the normal stress f_n/A + s |M_b| R/I
 * and the shear stress |F_t|/A + s |M_t| R/J, with s the fraction of moments in the strength, and
 * the bond breaks when they reach R_n/A or R_t/A. With the friction of law_mohr.h R_t is R_t + mu_1
 * <-f_n>. With quadratic coupling it breaks where the sum of the squares of both ratios is 1, and
 * the larger one is the cause.
 *
 * Columns: those of the linear law and beam (R), share (s); state: moment, that on the first
 * particle, bending and twist together. In 2D only its third component is used. */
#ifndef GN_KERNELS_LAW_BEAM_H
#define GN_KERNELS_LAW_BEAM_H

#include "kernels/law_linear.h"

/* Stiffnesses against bending and twist, N m. */
typedef struct beam_stiffness {
    gn_v bend, twist;
} beam_stiffness;

GN_INLINE gn_v beam_radius(const gn_contact_args *args, size_t c) {
    return gn_load(COLUMN(args->contacts, beam) + gn_column_at(c, args->uniform.beam));
}

GN_INLINE beam_stiffness stiffness_of_beam(const gn_contact_args *args, size_t c, variant with) {
    const gn_contacts *k = args->contacts;
    gn_v radius = beam_radius(args, c), r2 = radius * radius;
    gn_v kn = gn_load(COLUMN(k, kn) + gn_column_at(c, args->uniform.kn));
    beam_stiffness s = {kn * r2 * gn_set(with.space ? 0.25 : 1.0 / 3.0), gn_set(0.0)};
    if (with.space)
        s.twist = gn_load(COLUMN(k, kt) + gn_column_at(c, args->uniform.kt)) * r2 * gn_set(0.5);
    return s;
}

/* Loads moments from three columns, the first of which is `column`; in 2D only the third is
 * used. */
GN_INLINE gn_v3 load_moment(const gn_contact_args *args, const gn_real *column, size_t c,
                            variant with) {
    const gn_real *at = column + c;
    uint64_t stride = args->contacts->soa.capacity;
    gn_v3 m = {gn_set(0.0), gn_set(0.0), gn_load(at + 2 * stride)};
    if (with.space) m = gn_load3(at, stride, 1);
    return m;
}

GN_INLINE void store_moment(const gn_contact_args *args, gn_real *column, size_t c, gn_v3 m,
                            variant with) {
    gn_real *at = column + c;
    uint64_t stride = args->contacts->soa.capacity;
    if (with.space)
        gn_store3(at, stride, m, 1);
    else
        gn_store(at + 2 * stride, m.z);
}

/* A moment or a rotation, across the normal (in 2D: out of the plane) and along it. */
typedef struct beam_parts {
    gn_v3 bend;
    gn_v twist;
} beam_parts;

/* Splits a moment of this instant; or one of the last instant, when the normal was the mirror image
 * q m - n of the present one, with q = 2/|m|^2 and m = `middle`. The bending part is then rotated
 * as gn_turn_with_normal does it, written out here. */
GN_INLINE beam_parts parts_of(gn_v3 moment, gn_v3 n) {
    beam_parts p = {.twist = gn_dot(moment, n, 1)};
    p.bend = gn_axmy(moment, p.twist, n, 1);
    return p;
}
GN_INLINE beam_parts parts_turned(gn_v3 moment, gn_v3 n, gn_v3 middle, gn_v q) {
    gn_v along = gn_dot(moment, n, 1);
    gn_v twist = gn_fma(q, gn_dot(moment, middle, 1), gn_set(0.0) - along);
    gn_v left = gn_fnma(twist, q - gn_set(1.0), along);
    gn_v3 bend = gn_axpy(moment, twist, n, 1);
    return (beam_parts){gn_axmy(bend, gn_fma(twist, q, left), middle, 1), twist};
}

/* Returns the rate of relative rotation of the two ends, in the directions of this instant. Its
 * component across the middle normal is rotated and shortened by the cosine of half the angle, and
 * so is its component along that normal: the work of a moment that rotates with the bond then
 * equals the energy of the springs, for any angle. */
GN_INLINE beam_parts turn_rate(gn_v3 spin, gn_v3 n, gn_v3 middle, gn_v q) {
    gn_v along = gn_set(0.5) * q * gn_dot(spin, middle, 1);
    gn_v3 across = gn_axmy(spin, along, middle, 1);
    return (beam_parts){gn_axmy(across, gn_dot(spin, n, 1) - along, n, 1), along};
}

/* Returns 2/|m|^2, with |m|^2 = 1 + tan^2(angle/2) for the angle of the step; the square of tan^2
 * is negligible. */
GN_INLINE gn_v mirror_factor(gn_v3 middle) {
    gn_v e = gn_dot(middle, middle, 1) - gn_set(1.0);
    return gn_fma(gn_set(2.0) * e, e - gn_set(1.0), gn_set(2.0));
}

GN_INLINE gn_v3 relative_spin(const gn_contact_args *args, size_t c) {
    gn_v spin[4];
    gn_rows4_less(COLUMN(args, spin), args->contacts->j + c, args->contacts->i + c, spin);
    return (gn_v3){spin[0], spin[1], spin[2]};
}

/* Stores the elastic moment in its column; beam_force limits it later. */
GN_INLINE void beam_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                          variant with) {
    const gn_v3 n = vector->geometry.n, middle = from->motion.middle;
    linear_trial(args, c, from, vector, with);
    if (!with.rotation) return;
    beam_stiffness k = stiffness_of_beam(args, c, with);
    gn_v3 spin = relative_spin(args, c),
          m = load_moment(args, COLUMN(args->contacts, moment), c, with);
    if (with.space) {
        gn_v q = mirror_factor(middle);
        beam_parts p = parts_turned(m, n, middle, q), r = turn_rate(spin, n, middle, q);
        gn_v twist = gn_fma(k.twist * gn_set(args->dt), r.twist, p.twist);
        gn_v3 bend = gn_linear_shear(p.bend, r.bend, k.bend, args->dt, n, vector->angle, 1, 1);
        m = gn_axpy(bend, twist, n, 1);
    } else {
        m.z = gn_fma(k.bend * gn_set(args->dt), spin.z, m.z);
    }
    store_moment(args, COLUMN(args->contacts, moment), c, m, with);
}

/* Quadratic coupling: finds the bonds that reach their strength in this step, and among them those
 * with the larger ratio in tension. Strengths and forces are multiplied by the radius R of the
 * beam; `pull` is the tension at the extreme fibre. */
GN_INLINE gn_m break_beams_coupled(gn_v strength, gn_v shear_strength, gn_v pull, gn_v sheared,
                                   gn_m *in_tension) {
    gn_v share = gn_max(pull, gn_set(0.0)) / strength, share2 = share * share;
    gn_v whole2 = shear_strength * shear_strength, size2 = sheared * sheared;
    gn_m beyond = gn_at_least(size2, whole2 * (gn_set(1.0) - share2));
    *in_tension = gn_or(*in_tension, gn_and(beyond, gn_at_least(share2 * whole2, size2)));
    return beyond;
}

/* Finds the intact bonds that reach their strength at the extreme fibre in this step; tension takes
 * precedence. The condition f_n + z s |M_b|/R >= R_n, z = A R^2/I, and the similar one in shear are
 * evaluated without roots or divisions. */
GN_INLINE void break_beams(const gn_contact_args *args, size_t c, size_t end,
                           const beam_parts *moment, contact_state *state, gn_contact_sums *sums,
                           variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0), radius = beam_radius(args, c);
    gn_v share = gn_load(COLUMN(k, share) + gn_column_at(c, args->uniform.share));
    gn_v rn = gn_load(COLUMN(k, rn) + c), left = radius * (rn - state->elastic);
    gn_v bent = gn_set(with.space ? 4.0 : 3.0) * share;
    gn_v bend2 =
        gn_pick(with.space, gn_dot(moment->bend, moment->bend, 1), moment->bend.z * moment->bend.z);
    state->intact = gn_less(zero, rn);
    gn_m in_tension = gn_or(gn_at_least(zero, left), gn_at_least(bent * bent * bend2, left * left));
    gn_v strength = gn_load(COLUMN(k, rt) + c);
    if (COLUMN(k, mu1)) {
        gn_v mu1 = gn_load(COLUMN(k, mu1) + gn_column_at(c, args->uniform.mu1));
        strength = gn_max(gn_fma(mu1, pressed_of(args, c, state->elastic), strength), zero);
    }
    left = radius * strength;
    if (with.space)
        left = gn_fnma(gn_set(2.0) * share, gn_max(moment->twist, zero - moment->twist), left);
    gn_v pull2 = radius * radius * gn_dot(state->trial, state->trial, with.space);
    gn_m in_shear = gn_or(gn_at_least(zero, left), gn_at_least(pull2, left * left));
    if (k->soa.effects & GN_FX_COUPLED_QUADRATIC) {
        gn_v pull = gn_fma(bent, gn_sqrt(bend2), radius * state->elastic);
        gn_v sheared = gn_sqrt(pull2) + (radius * strength - left);
        in_shear = gn_or(in_shear, break_beams_coupled(radius * rn, radius * strength, pull,
                                                       sheared, &in_tension));
    }
    in_tension = gn_and(state->intact, in_tension);
    in_shear = gn_and(gn_and(state->intact, gn_not(in_tension)), in_shear);
    state->breaking = gn_or(in_tension, in_shear);
    state->intact = gn_and(state->intact, gn_not(state->breaking));
    if (__builtin_expect(gn_bits(state->breaking) != 0, 0))
        record_breaks(args, c, end, gn_bits(in_tension), gn_bits(in_shear), sums);
}

/* Returns half of the product of two moments over the stiffness, which for equal moments is the
 * stored energy. */
GN_INLINE gn_v moment_work(const beam_parts *moment, const beam_parts *of, beam_stiffness stiffness,
                           variant with) {
    const gn_v half = gn_set(0.5), tiny = gn_set(GN_TINY);
    if (!with.space) return half * moment->bend.z * of->bend.z / gn_max(stiffness.bend, tiny);
    return half * gn_dot(moment->bend, of->bend, 1) / gn_max(stiffness.bend, tiny) +
           half * moment->twist * of->twist / gn_max(stiffness.twist, tiny);
}

/* Computes the middle normal again, as find_motion does. */
GN_INLINE gn_v3 middle_again(const gn_contact_args *args, size_t c, const stage *vector,
                             variant with) {
    gn_v pi[4], pj[4], distance = vector->geometry.distance;
    gn_rows4(COLUMN(args, pos), args->contacts->i + c, pi);
    gn_rows4(COLUMN(args, pos), args->contacts->j + c, pj);
    gn_v rate = gn_set(0.5 * args->dt) * (gn_set(1.0) / gn_max(distance, gn_set(GN_TINY)));
    rate = gn_keep(gn_less(gn_set(0.05) * (pi[3] + pj[3]), distance), rate);
    return gn_middle(opening_velocity(args, c, &vector->geometry, with), vector->geometry.n,
                     vector->speed, rate, 1);
}

/* Rare: returns the energy that the moments of breaking bonds release: half of the product of the
 * present moments and those of the last instant, over the stiffness. The moments of the last
 * instant are recomputed. */
GN_INLINE gn_v released_moments(const gn_contact_args *args, size_t c, const stage *vector,
                                const beam_parts *moment, variant with) {
    const gn_v dt = gn_set(args->dt);
    const gn_v3 n = vector->geometry.n, spin = relative_spin(args, c);
    beam_stiffness k = stiffness_of_beam(args, c, with);
    beam_parts before = *moment;
    if (with.space) {
        gn_v3 middle = middle_again(args, c, vector, with);
        beam_parts r = turn_rate(spin, n, middle, mirror_factor(middle));
        gn_v half = k.bend * gn_set(0.5) * dt;
        gn_v3 first = gn_turn_about_normal(gn_scale(half, r.bend, 1), n, vector->angle);
        before.bend = gn_sub(gn_axmy(moment->bend, half, r.bend, 1), first, 1);
        before.twist = gn_fnma(k.twist * dt, r.twist, moment->twist);
    } else {
        before.bend.z = gn_fnma(k.bend * dt, spin.z, moment->bend.z);
    }
    return moment_work(&before, moment, k, with);
}

GN_INLINE contact_force beam_force(const gn_contact_args *args, size_t c, size_t end,
                                   const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                   variant with) {
    if (!with.rotation) return linear_force(args, c, end, vector, lanes, sums, with);
    const gn_v3 n = vector->geometry.n;
    gn_v3 moment = load_moment(args, COLUMN(args->contacts, moment), c, with);
    beam_parts m = {moment, gn_set(0.0)};
    if (with.space) m = parts_of(moment, n);
    contact_state q = state_of(args, c, vector, with);
    break_beams(args, c, end, &m, &q, sums, with);
    contact_force f = act_of(args, c, vector, &q, lanes, with);
    if (__builtin_expect(gn_bits(gn_not(q.intact)) != 0, 0)) {
        if (gn_bits(q.breaking) && with.energy) {
            gn_v released = released_moments(args, c, vector, &m, with);
            lanes->bond_breaking = lanes->bond_breaking + gn_keep(q.breaking, released);
            note_released(args, c, gn_bits(q.breaking), released);
        }
        gn_v3 kept = {gn_keep(q.intact, moment.x), gn_keep(q.intact, moment.y),
                      gn_keep(q.intact, moment.z)};
        store_moment(args, COLUMN(args->contacts, moment), c, kept, with);
    }
    if (args->measure && with.energy)
        lanes->elastic_bending =
            lanes->elastic_bending +
            gn_keep(q.intact, moment_work(&m, &m, stiffness_of_beam(args, c, with), with));
    return f;
}

#endif
