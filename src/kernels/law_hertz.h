/* Hertz-Mindlin contacts without slip in the contact kernel, for unbonded pairs (hertz.h; Thornton,
 * Cummins and Cleary 2013, Powder Technology 233, 30-46).
 *
 * A contact that closes or opens within a step needs no fraction of it (gn_linear_cross): force and
 * stiffness begin at 0. With N steps from touching to separation each of the two ends misses
 * zeta(-3/2, s) (2.94/N)^(5/2)/0.4 of the energy, s the phase: together 0.3 % at most at thirteen
 * steps, of either sign and 0 in the mean.
 *
 * Columns: kn (2 E* sqrt(R)), kt (8 G* sqrt(R)), mu, cn (of the dashpot over sqrt(S_n)), lag; most,
 * the overlap up to which the step was checked; state: shear, fd, closeness. */
#ifndef GN_KERNELS_LAW_HERTZ_H
#define GN_KERNELS_LAW_HERTZ_H

#include "kernels/contact_internal.h"
#include "kernels/hertz.h"

/* Sets `before` to the tangential force of the last step, rotated, and `trial` to the displacement
 * across the normal, not yet multiplied by the stiffness, which depends on the overlap. */
GN_INLINE void hertz_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                           variant with) {
    const gn_contacts *list = args->contacts;
    const gn_v zero = gn_set(0.0);
    const gn_v3 n = vector->geometry.n, none = {zero, zero, zero};
    const int twists = with.space && with.rotation;
    if (!with.shear) return;
    gn_v3 t = gn_load3(COLUMN(list, shear) + c, list->soa.capacity, with.space);
    t = gn_turn_with_normal(t, n, from->motion.middle, with.space);
    vector->before = twists ? gn_turn_about_normal(t, n, vector->angle) : t;
    vector->trial = gn_linear_shear(none, from->motion.relative, gn_set(1.0), args->dt, n,
                                    vector->angle, twists, with.space);
}

/* Quantities of a contact's dashpot. */
typedef struct hertz_pot {
    gn_v kn, c, lag, path, coefficient; /* path of the step */
} hertz_pot;

/* Rare: computes the dashpot's coefficients for contacts that closed or opened within the step. */
static __attribute__((noinline)) gn_v hertz_crossing(const hertz_pot *pot, gn_v stretch,
                                                     gn_m closing, gn_m opening) {
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    gn_v way = gn_max(pot->path, zero - pot->path);
    gn_v most = gn_hertz_dashpot(pot->c, pot->lag, pot->kn * gn_sqrt(way));
    gn_v over = stretch / gn_max(way, gn_set(GN_TINY));
    gn_v s = zero - gn_max(zero - gn_max(zero - over, zero), zero - one);
    gn_v left = zero - gn_max(zero - gn_max(one - over, zero), zero - one);
    gn_v r = gn_where(closing, most * gn_hertz_closing(s), pot->coefficient);
    return gn_where(opening, most * gn_hertz_opening(left), r);
}

/* Returns the dashpot's force along the normal; it uses the speed along the last normal, as
 * `damped` of the linear law does. `beyond`: the stretch plus the rounding of positions. */
GN_INLINE gn_v hertz_viscous(const gn_contact_args *args, size_t c, const stage *vector, gn_v kn,
                             gn_v beyond, const gn_hertz_press *press, lane_sums *sums,
                             variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0), path = gn_set(args->dt) * vector->growth;
    const int pulls = !(k->soa.effects & GN_FX_NO_PULL);
    gn_v cn = gn_load(COLUMN(k, cn) + gn_column_at(c, args->uniform.cn));
    gn_v lag = gn_load(COLUMN(k, lag) + gn_column_at(c, args->uniform.lag));
    hertz_pot pot = {kn, cn, lag, path, gn_hertz_dashpot(cn, lag, press->stiffness)};
    gn_m touching = gn_less(beyond, zero), touched = gn_less(beyond, path);
    gn_m closing = gn_and(touching, gn_not(touched)), opening = gn_and(touched, gn_not(touching));
    if (__builtin_expect(gn_bits(gn_or(closing, opening)) != 0, 0)) {
        if (!pulls) opening = gn_m_none();
        pot.coefficient = hertz_crossing(&pot, vector->geometry.stretch, closing, opening);
    }
    gn_v viscous = pot.coefficient * vector->speed;
    if (!pulls) viscous = zero - gn_max(zero - viscous, press->normal); /* no tension in total */
    if (with.energy) {
        gn_v half = gn_set(0.5);
        sums->contact_damping =
            sums->contact_damping + half * (gn_load(COLUMN(k, fd) + c) + viscous) * path;
        gn_store(COLUMN(k, fd) + c, viscous);
    }
    return viscous;
}

GN_INLINE gn_v3 hertz_shear(const gn_contact_args *args, size_t c, const stage *vector,
                            const gn_hertz_press *press, gn_v total, gn_m touching, lane_sums *sums,
                            variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    gn_v kt = gn_load(COLUMN(k, kt) + gn_column_at(c, args->uniform.kt));
    gn_v mu = gn_load(COLUMN(k, mu) + gn_column_at(c, args->uniform.mu));
    gn_v past = gn_load(COLUMN(k, closeness) + c);
    gn_v now = gn_keep(touching, one / gn_max(press->root, gn_set(GN_TINY)));
    gn_v3 t = gn_hertz_rescaled(vector->before, past, press->root, with.space);
    t = gn_axpy(t, kt * press->root, vector->trial, with.space);
    gn_v limit = gn_keep(touching, mu * gn_max(zero - total, zero));
    gn_v size2 = gn_dot(t, t, with.space);
    gn_m slipping = gn_less(limit * limit, size2);
    if (gn_bits(slipping)) t = gn_linear_slip(t, size2, limit, slipping, with.space);
    if (with.energy) {
        sums->friction = sums->friction +
                         gn_hertz_lost(vector->before, t, vector->trial, past, now, kt, with.space);
        if (args->measure)
            sums->elastic_shear = sums->elastic_shear + gn_set(0.5) * gn_dot(t, t, with.space) *
                                                            now / gn_max(kt, gn_set(GN_TINY));
    }
    gn_store(COLUMN(k, closeness) + c, now);
    gn_store3(COLUMN(k, shear) + c, k->soa.capacity, t, with.space);
    return t;
}

/* Rare: counts contacts with an overlap beyond that for which the step was checked. */
static __attribute__((noinline)) void count_pressed(unsigned over, size_t c, size_t end,
                                                    gn_contact_sums *sums) {
    for (size_t lane = 0; lane < GN_W && c + lane < end; lane++) sums->pressed += over >> lane & 1;
}

GN_INLINE contact_force hertz_force(const gn_contact_args *args, size_t c, size_t end,
                                    const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                    variant with) {
    const gn_contacts *k = args->contacts;
    const pair_geometry *s = &vector->geometry;
    const gn_v zero = gn_set(0.0);
    gn_v beyond = gn_fma(gn_set(GN_OVERLAP_ROUNDING), s->distance, s->stretch);
    gn_m touching = gn_less(beyond, zero);
    gn_v overlap = gn_keep(touching, zero - s->stretch);
    gn_v kn = gn_load(COLUMN(k, kn) + gn_column_at(c, args->uniform.kn));
    gn_hertz_press p = gn_hertz_normal(kn, overlap);
    gn_m over = gn_less(gn_load(COLUMN(k, most) + c), overlap);
    if (__builtin_expect(gn_bits(over) != 0, 0)) count_pressed(gn_bits(over), c, end, sums);
    contact_force f = {p.normal, {zero, zero, zero}, zero};
    if (with.damping)
        f.normal = p.normal + hertz_viscous(args, c, vector, kn, beyond, &p, lanes, with);
    if (with.shear) f.shear = hertz_shear(args, c, vector, &p, f.normal, touching, lanes, with);
    if (args->measure && with.energy)
        lanes->elastic_normal = lanes->elastic_normal + gn_hertz_stored(p.normal, overlap);
    return f;
}

#endif
