/* Smooth joint (Mas Ivars et al. 2011, Int. J. Rock Mech. Min. Sci. 48): a contact whose branch
 * crosses a joint has the frame of the joint, not that of the branch. With v the relative velocity
 * at the contact point and N the joint's normal,
 *     f_n = k_n g,  dg = N.v dt,   F_t = F_t + k_t (v - N (N.v)) dt,
 * so that particles slide along the joint and do not ride over each other. k_n, k_t and strengths
 * are the joint's per area times the area that the contact stands for. While it is intact the joint
 * breaks by tension, f_n >= R_n, or by shear, |F_t| >= R_t + mu_1 <-f_n>; after that it is open at
 * g >= 0 and slides at |F_t| = mu <-f_n>. A slip ds opens the joint by tan(psi) ds, which presses
 * its sides together, so that the slip of a step follows from both forces after it:
 *     |F_t| - k_t ds = mu (P + k_n tan(psi) ds),   P = <-f_n>,
 *     ds = (|F_t| - mu P)/(k_t + mu k_n tan(psi)).
 * Columns in addition to those of law_mohr.h: plane (N), dilation (tan(psi), slip at which it
 * ends); state: apart (g less the dilation), slip. N does not rotate. There is no dashpot. */
#ifndef GN_KERNELS_LAW_JOINT_H
#define GN_KERNELS_LAW_JOINT_H

#include "kernels/law_mohr.h"

GN_INLINE gn_v3 joint_normal(const gn_contact_args *args, size_t c, variant with) {
    const gn_contacts *list = args->contacts;
    return gn_load3(COLUMN(list, plane) + c, list->soa.capacity, with.space);
}

GN_INLINE void joint_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                           variant with) {
    const gn_contacts *list = args->contacts;
    const gn_v3 n = joint_normal(args, c, with), v = from->motion.relative;
    const gn_v kt = gn_load(COLUMN(list, kt) + gn_column_at(c, args->uniform.kt));
    const gn_v speed = gn_dot(v, n, with.space);
    vector->angle = gn_set(args->dt) * speed; /* the path along the joint's normal */
    vector->before = gn_load3(COLUMN(list, shear) + c, list->soa.capacity, with.space);
    vector->trial = gn_axpy(vector->before, kt * gn_set(args->dt), gn_axmy(v, speed, n, with.space),
                            with.space);
}

/* Computes the normal force of contacts that do not hold; those that closed or opened in the step
 * act for a part of it, as unbonded particles do. Returns the mask of these. */
GN_INLINE gn_m close_joint(gn_v path, contact_state *state) {
    const gn_v zero = gn_set(0.0);
    const gn_m loose = gn_not(state->intact), was = gn_less(state->stretch - path, zero);
    state->touching = gn_less(state->stretch, zero);
    const gn_m before = gn_and(loose, gn_not(state->breaking));
    const gn_m closing = gn_and(before, gn_and(state->touching, gn_not(was)));
    const gn_m opening = gn_and(before, gn_and(was, gn_not(state->touching)));
    const gn_m crosses = gn_or(closing, opening);
    state->normal = gn_keep(gn_or(state->touching, state->intact), state->elastic);
    if (__builtin_expect(gn_bits(crosses) == 0, 1)) return crosses;
    const gn_linear_crossing r =
        gn_linear_cross(state->kn, state->stretch, path, zero, zero, zero, closing, opening,
                        gn_or(state->touching, state->intact));
    state->normal = gn_where(crosses, r.normal, state->normal);
    state->way = gn_where(crosses, r.way, state->way);
    return crosses;
}

/* Rare: lets contacts slide, with dilation; returns the energy of the normal force that dilation
 * or a break by tension releases. */
GN_INLINE gn_v slide_joint(const gn_contact_args *args, size_t c, gn_v path, gn_v size2, gn_v mu,
                           gn_m crosses, contact_state *state, variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0), size = gn_sqrt(size2), slip = gn_load(COLUMN(k, slip) + c);
    const gn_v pressed = gn_max(zero - state->normal, zero);
    const gn_m dilates = gn_and(gn_and(state->slipping, gn_and(state->touching, gn_not(crosses))),
                                gn_less(slip, gn_load(COLUMN(k, dilation) + k->soa.capacity + c)));
    const gn_v tangent = gn_keep(dilates, gn_load(COLUMN(k, dilation) + c));
    const gn_v gives = gn_max(gn_fma(mu * state->kn, tangent, state->kt), gn_set(GN_TINY));
    const gn_v ds = gn_keep(state->slipping, gn_fnma(mu, pressed, size) / gives);
    const gn_v opens = tangent * ds, old = state->kn * (state->stretch - path);
    const gn_v limit = mu * gn_fma(state->kn, opens, pressed);
    state->t = gn_linear_slip(state->trial, size2, limit, state->slipping, with.space);
    state->normal = gn_fnma(state->kn, opens, state->normal);
    state->stretch = state->stretch - opens;
    state->way = gn_where(crosses, state->way, state->stretch);
    gn_store(COLUMN(k, slip) + c, slip + ds);
    return gn_keep(
        gn_or(dilates, state->breaking),
        gn_released(old, state->normal, state->elastic, gn_max(state->kn, gn_set(GN_TINY))));
}

GN_INLINE void release_joint(const gn_contact_args *args, size_t c, gn_v path, contact_state *state,
                             lane_sums *sums, variant with) {
    const gn_contacts *k = args->contacts;
    const gn_m crosses = close_joint(path, state);
    gn_v mu = gn_set(0.0);
    if (with.friction) mu = gn_load(COLUMN(k, mu) + gn_column_at(c, args->uniform.mu));
    const gn_v limit = mu * gn_max(gn_set(0.0) - state->normal, gn_set(0.0));
    const gn_v size2 = gn_dot(state->trial, state->trial, with.space);
    state->slipping = gn_and(gn_not(state->intact), gn_less(limit * limit, size2));
    if (gn_bits(gn_or(state->slipping, state->breaking)) == 0) return;
    const gn_v normal_part = slide_joint(args, c, path, size2, mu, crosses, state, with);
    if (!with.energy) return;
    const gn_v both = normal_part + gn_released3(state->before, state->t, state->trial,
                                                 gn_max(state->kt, gn_set(GN_TINY)), with.space);
    sums->bond_breaking = sums->bond_breaking + gn_keep(state->breaking, both);
    sums->friction =
        sums->friction + gn_keep(gn_and(state->slipping, gn_not(state->breaking)), both);
}

GN_INLINE contact_force joint_force(const gn_contact_args *args, size_t c, size_t end,
                                    const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                    variant with) {
    const gn_contacts *list = args->contacts;
    const gn_v path = vector->angle;
    const gn_v3 n = joint_normal(args, c, with), along = vector->geometry.n;
    contact_state q = state_of(args, c, vector, with);
    q.way = q.stretch = gn_load(COLUMN(list, apart) + c) + path;
    q.normal = q.elastic = q.kn * q.stretch;
    break_mohr(args, c, end, &q, sums);
    if (__builtin_expect(gn_bits(gn_not(q.intact)) != 0, 1))
        release_joint(args, c, path, &q, lanes, with);
    gn_store(COLUMN(list, apart) + c, q.stretch);
    gn_store3(COLUMN(list, shear) + c, list->soa.capacity, q.t, with.space);
    if (args->measure && with.energy) book_elastic(&q, lanes, with);
    const gn_v3 whole = gn_axpy(q.t, q.normal, n, with.space);
    const gn_v part = gn_dot(whole, along, with.space);
    return (contact_force){part, gn_axmy(whole, part, along, with.space), gn_set(0.0)};
}

#endif
