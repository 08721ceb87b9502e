/* The linear brittle law in the contact kernel: linear normal law with a stress-free length,
 * viscous normal damping, incremental tangential law with radial return, brittle uncoupled bond
 * (Rojek et al. 2012, eq. 15-16). Columns: kn, kt, mu, cn, rn, rt; state: shear, fd, rn < 0 once
 * broken. */
#ifndef GN_KERNELS_LAW_LINEAR_H
#define GN_KERNELS_LAW_LINEAR_H

#include "kernels/contact_internal.h"

#include <math.h>
#include <stdbool.h>

/* Returns the tangential force before any limit; *turned: the force of the last step, rotated
 * across the new normal. */
GN_INLINE gn_v3 shear_trial(const gn_contact_args *args, const pair_geometry *geometry,
                            const pair_motion *motion_of, gn_v3 *turned, gn_v angle, gn_v kt,
                            variant with) {
    gn_v3 t = gn_turn_with_normal(*turned, geometry->n, motion_of->middle, with.space);
    *turned = t;
    return gn_linear_shear(t, motion_of->relative, kt, args->dt, geometry->n, angle,
                           with.space && with.rotation, with.space);
}

/* Returns the compression on which the friction of a bond depends: its own normal force, or that by
 * the mean stress around it. Tension counts only if it reduces the strength. */
GN_INLINE gn_v pressed_of(const gn_contact_args *args, size_t c, gn_v normal) {
    const gn_contacts *k = args->contacts;
    gn_v least = gn_set(k->soa.effects & GN_FX_COUPLED_LINEAR ? -(double)INFINITY : 0.0);
    gn_v pressed = gn_set(0.0) - normal;
    if (k->soa.effects & GN_FX_CONFINED) pressed = gn_load(COLUMN(k, confined) + c);
    return gn_max(pressed, least);
}

/* Rare: records which bonds broke and why. */
static __attribute__((noinline)) void record_breaks(const gn_contact_args *args, size_t c,
                                                    size_t end, unsigned tension, unsigned shear,
                                                    gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    for (size_t lane = 0; lane < GN_W && c + lane < end; lane++) {
        unsigned bit = 1u << lane;
        if (!((tension | shear) & bit)) continue;
        k->rn[c + lane] = -k->rn[c + lane];
#if GN_MIXED
        k->rn_f[c + lane] = -k->rn_f[c + lane];
#endif
        k->broken_time[c + lane] = args->time;
        k->cause[c + lane] = tension & bit ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR;
        if (k->happened) k->happened[c + lane] |= GN_HAPPENED_BREAK;
        if (k->released) k->released[c + lane] = 0.0;
        sums->broken_tension += tension & bit ? 1 : 0;
        sums->broken_shear += tension & bit ? 0 : 1;
    }
}

/* Rare: records the energy that breaking bonds release, for the list of events; contributions are
 * added up. */
static __attribute__((noinline)) void note_released(const gn_contact_args *args, size_t c,
                                                    unsigned lanes, gn_v energy) {
    double *released = args->contacts->released;
    gn_real part[GN_W];
    if (!released) return;
    gn_store(part, energy);
    for (size_t lane = 0; lane < GN_W; lane++)
        if (lanes >> lane & 1) released[c + lane] += part[lane];
}

/* Forces of a contact before and after its limits. */
typedef struct contact_state {
    gn_v kn, kt, stretch, elastic,
        normal;  /* elastic: k_n stretch; normal: the part of it that acts */
    gn_v beyond; /* the stretch and the rounding of positions */
    gn_v way;    /* m; half of normal times this is the energy of the spring */
    gn_v share;  /* factor on the dashpot's force */
    gn_v3 before, trial,
        t; /* tangential force of the last step, rotated; before limits; after them */
    gn_m touching, intact, breaking, slipping;
} contact_state;

/* Applies the Coulomb limit to all contacts but intact bonds; open contacts lose their force.
 * Magnitudes are compared by their squares, so that the root and the division are needed only if a
 * contact of the vector slips. */
GN_INLINE void limit_shear(const gn_contact_args *args, size_t c, gn_v total, contact_state *state,
                           variant with) {
    const gn_contacts *k = args->contacts;
    gn_v limit = gn_set(0.0);
    if (with.friction)
        limit =
            gn_keep(state->touching, gn_load(COLUMN(k, mu) + gn_column_at(c, args->uniform.mu)) *
                                         gn_max(gn_set(0.0) - total, gn_set(0.0)));
    gn_v size2 = gn_dot(state->trial, state->trial, with.space);
    state->slipping = gn_and(gn_not(state->intact), gn_less(limit * limit, size2));
    state->t = state->trial;
    if (gn_bits(state->slipping))
        state->t = gn_linear_slip(state->trial, size2, limit, state->slipping, with.space);
}

/* Tells whether all contacts of a vector are intact bonds, which is the common case. */
GN_INLINE bool all_hold(const gn_contact_args *args, size_t c, const contact_state *state,
                        variant with) {
    const gn_contacts *k = args->contacts;
    gn_v rn = gn_load(COLUMN(k, rn) + c);
    gn_m hold = gn_and(gn_less(gn_set(0.0), rn), gn_less(state->elastic, rn));
    if (with.shear) {
        gn_v rt = gn_load(COLUMN(k, rt) + c);
        hold = gn_and(hold, gn_less(gn_dot(state->trial, state->trial, with.space), rt * rt));
    }
    return gn_bits(gn_not(hold)) == 0;
}

/* Finds the intact bonds that reach their strength in this step; tension takes precedence. */
GN_INLINE void break_bonds(const gn_contact_args *args, size_t c, size_t end, contact_state *state,
                           gn_contact_sums *sums, variant with) {
    const gn_contacts *k = args->contacts;
    gn_v rn = gn_load(COLUMN(k, rn) + c);
    state->intact = gn_less(gn_set(0.0), rn);
    gn_m in_tension = gn_and(state->intact, gn_at_least(state->elastic, rn)),
         in_shear = gn_m_none();
    if (with.shear) {
        gn_v rt = gn_load(COLUMN(k, rt) + c);
        gn_m strong = gn_at_least(gn_dot(state->trial, state->trial, with.space), rt * rt);
        in_shear = gn_and(gn_and(state->intact, gn_not(in_tension)), strong);
    }
    state->breaking = gn_or(in_tension, in_shear);
    state->intact = gn_and(state->intact, gn_not(state->breaking));
    if (__builtin_expect(gn_bits(state->breaking) != 0, 0))
        record_breaks(args, c, end, gn_bits(in_tension), gn_bits(in_shear), sums);
}

/* Rare: books the energy that slipping and breaking contacts release. */
GN_INLINE void book_release(const gn_contact_args *args, size_t c, const stage *vector, gn_v path,
                            const contact_state *state, lane_sums *sums, variant with) {
    gn_v shear_part = gn_set(0.0), normal_part = gn_set(0.0);
    if (with.shear) {
        gn_v3 before = state->before;
        if (with.space && with.rotation)
            before = gn_turn_about_normal(before, vector->geometry.n, vector->angle);
        shear_part = gn_released3(before, state->t, state->trial,
                                  gn_max(state->kt, gn_set(GN_TINY)), with.space);
    }
    if (with.bonds) {
        gn_v old = state->kn * (state->stretch - path);
        normal_part = gn_released(old, state->normal, state->elastic, state->kn);
    }
    gn_v both = shear_part + normal_part;
    sums->bond_breaking = sums->bond_breaking + gn_keep(state->breaking, both);
    if (with.bonds && gn_bits(state->breaking))
        note_released(args, c, gn_bits(state->breaking), both);
    sums->friction =
        sums->friction + gn_keep(gn_and(state->slipping, gn_not(state->breaking)), shear_part);
}

/* In measured steps: books the energy stored in the springs. */
GN_INLINE void book_elastic(const contact_state *state, lane_sums *sums, variant with) {
    gn_v half = gn_set(0.5);
    sums->elastic_normal = sums->elastic_normal + half * state->normal * state->way;
    if (with.shear)
        sums->elastic_shear = sums->elastic_shear + half * gn_dot(state->t, state->t, with.space) /
                                                        gn_max(state->kt, gn_set(GN_TINY));
}

/* Input and output of the rare branch. It does not include the state of the vector, which would
 * have to leave the registers if its address were taken. */
typedef struct crossing_state {
    gn_v kn, cn, stretch, beyond, elastic;
    gn_m touching, loose, breaking;
} crossing_state;
typedef struct crossing {
    gn_linear_crossing of;
    gn_v elastic;
} crossing;

/* Mobility of the two ends along the normal if components of particles are prescribed, and the
 * acceleration of their gap by other forces. */
typedef struct end_sums {
    gn_v inverse_mass, acceleration;
} end_sums;

/* Tells whether any end in a vector has prescribed components; the AND of all slots is negative
 * only if none has. */
GN_INLINE bool any_held(const gn_contact_args *args, size_t c) {
    const int32_t *i = args->contacts->i + c, *j = args->contacts->j + c;
    int32_t common = -1;
    for (int lane = 0; args->slot && lane < GN_W; lane++)
        common &= args->slot[i[lane]] & args->slot[j[lane]];
    return common >= 0;
}

static end_sums ends_of(const gn_contact_args *args, size_t c, gn_v3 normal, gn_v mi, gn_v mj) {
    gn_real n[3][GN_W], mass[2][GN_W], inverse[GN_W], acceleration[GN_W];
    if (!args->own && !any_held(args, c)) return (end_sums){mi + mj, gn_set(0.0)};
    gn_store(n[0], normal.x);
    gn_store(n[1], normal.y);
    gn_store(n[2], normal.z);
    gn_store(mass[0], mi);
    gn_store(mass[1], mj);
    for (size_t lane = 0; lane < GN_W; lane++) {
        inverse[lane] = acceleration[lane] = 0;
        for (int end = 0; end < 2; end++) {
            const int32_t p = (end ? args->contacts->j : args->contacts->i)[c + lane];
            const int32_t slot = args->slot ? args->slot[p] : -1;
            const unsigned held = slot < 0 ? 0u : args->held[slot];
            const gn_real falls = args->own ? (gn_real)args->own[p] : 1;
            gn_real share = 0, weight = 0;
            for (int k = 0; k < 3; k++) {
                if (held >> k & 1) continue;
                share += n[k][lane] * n[k][lane];
                weight += falls * (gn_real)args->gravity[k] * n[k][lane];
            }
            inverse[lane] += (held & 7) ? share * mass[end][lane] : mass[end][lane];
            acceleration[lane] += end ? weight : -weight;
        }
    }
    return (end_sums){gn_load(inverse), gn_load(acceleration)};
}

/* Adds the rounding of the path to a stretch. In single precision the displacements of the two
 * particles and their velocities are rounded separately, however similar they are, which affects
 * the path of a step. Otherwise chance would decide whether a contact that began at 0 counts as
 * begun, or as open again. `speeds`: sum over both ends. In double precision the error is within
 * GN_OVERLAP_ROUNDING. */
GN_INLINE gn_v with_path_rounding(const gn_contact_args *args, gn_v of, gn_v speeds) {
    return gn_pick(GN_MIXED, gn_fma(gn_set(0x1p-20 * args->dt), speeds, of), of);
}

/* Adds an upper bound of the rounding of the path of any contact. */
GN_INLINE gn_v with_most_path_rounding(const gn_contact_args *args, gn_v of) {
    double speeds = args->speed_most > 0.0 ? 4.0 * args->speed_most : (double)INFINITY;
    double most =
        args->dt > 0.0 ? 0x1p-20 * args->dt * speeds : 0.0; /* no motion before the start */
    return gn_pick(GN_MIXED, gn_set(most) + of, of);
}

/* Handles contacts that closed or opened within the step; contacts that did neither may be
 * included. */
static __attribute__((noinline)) crossing cross(const gn_contact_args *args, size_t c,
                                                const stage *vector, const crossing_state *state) {
    gn_v vi[4], vj[4];
    gn_rows4(COLUMN(args, vel), args->contacts->i + c, vi);
    gn_rows4(COLUMN(args, vel), args->contacts->j + c, vj);
    gn_v3 v = {vj[0] - vi[0], vj[1] - vi[1], vj[2] - vi[2]};
    gn_v side2 = gn_set(args->dt * args->dt) * across2_of(v, vector->speed, 1);
    end_sums ends = ends_of(args, c, vector->geometry.n, vi[3], vj[3]);
    gn_v quarter_y2 = gn_set(0.25 * args->dt * args->dt) * state->kn * ends.inverse_mass;
    /* Up to rounding, this is the distance at the previous instant. */
    gn_v along = gn_set(args->dt) * vector->speed, left = vector->geometry.distance - along;
    gn_v past = gn_max(left + gn_sqrt(gn_fma(left, left, side2)), gn_set(GN_TINY));
    gn_v path = along - side2 / past, before = state->stretch - path;
    gn_v3 of_i = {vi[0], vi[1], vi[2]}, of_j = {vj[0], vj[1], vj[2]};
    gn_v speeds = gn_sqrt(gn_dot(of_i, of_i, 1)) + gn_sqrt(gn_dot(of_j, of_j, 1));
    gn_m touched = gn_less(with_path_rounding(args, state->beyond, speeds), path);
    gn_m opening = gn_and(gn_and(state->loose, touched), gn_not(state->touching));
    gn_m closing = gn_and(gn_and(state->loose, state->touching), gn_not(touched));
    /* A bond that breaks in this step was a two-sided spring until now, unless it was stretched
     * only within the rounding; then it may be ignored. */
    gn_m never = gn_less(before, state->beyond - state->stretch);
    closing = gn_and(closing, gn_or(gn_not(state->breaking), never));
    gn_m acting = gn_not(gn_and(state->loose, gn_not(state->touching)));
    crossing r;
    gn_m moves = gn_not(gn_and(gn_at_least(path, gn_set(0.0)), gn_at_least(gn_set(0.0), path)));
    gn_v bias = gn_keep(moves, gn_set(args->dt * args->dt) * ends.acceleration / path);
    gn_v drag = gn_set(args->dt) * state->cn * ends.inverse_mass;
    r.of = gn_linear_cross(state->kn, state->stretch, path, quarter_y2, bias, drag, closing,
                           opening, acting);
    /* No energy remains that could be released. */
    r.elastic = gn_where(opening, r.of.normal, state->elastic);
    return r;
}

/* Returns the normal path in the step; unbonded contacts and broken bonds, which are rare here,
 * need more than the normal speed. In 2D the third component is 0. */
static __attribute__((noinline)) gn_v loose_path(const gn_contact_args *args, size_t c,
                                                 const stage *vector, gn_m intact) {
    const variant space = {.space = 1, .periodic = 1}; /* correct also without a moving box */
    gn_v3 v = opening_velocity(args, c, &vector->geometry, space);
    return gn_set(args->dt) *
           gn_where(intact, vector->speed, growth_of(v, vector->speed, vector->rate, 1));
}

/* Finds contacts that may have closed or opened within the step, by the normal speed alone and an
 * upper bound of the motion across the normal; some of them did neither. Most contacts are far from
 * either. */
GN_INLINE gn_m may_cross(const gn_contact_args *args, const stage *vector,
                         const contact_state *state) {
    gn_v along = gn_set(args->dt) * vector->speed, before = state->beyond - along;
    gn_v rounding = gn_fma(gn_set(0x1p-20), gn_max(along, gn_set(0.0) - along),
                           gn_set(0x1p-47) * vector->geometry.distance);
    rounding = with_most_path_rounding(args, rounding);
    double fastest = args->speed_most > 0.0 ? 2.0 * args->speed_most : (double)INFINITY;
    gn_v across = gn_fma(gn_set(2.02 * args->dt * fastest * fastest), vector->rate, rounding);
    gn_m surely = gn_less(before, gn_set(0.0) - across), apart = gn_at_least(before, rounding);
    return gn_not(gn_or(gn_and(state->touching, surely), gn_and(gn_not(state->touching), apart)));
}

/* Computes the normal force without the dashpot. Only contacts that are closer to a transition than
 * `slack`, the effect of the motion across the normal, are examined exactly; the error of the path
 * is far below it. Lanes are independent: other lanes of the vector must have no effect. */
GN_INLINE void cross_if_near(const gn_contact_args *args, size_t c, const stage *vector, gn_v path,
                             gn_m loose, contact_state *contact, variant with) {
    gn_v before = contact->beyond - path;
    gn_v slack = with_most_path_rounding(args, gn_set(args->dt) * vector->speed - path);
    gn_m surely = gn_less(before, gn_set(0.0) - slack), perhaps = gn_less(before, slack);
    gn_m crosses = gn_or(gn_and(contact->touching, gn_not(surely)),
                         gn_and(perhaps, gn_not(contact->touching)));
    crosses = gn_and(loose, crosses);
    if (__builtin_expect(gn_bits(crosses) == 0, 1)) return;
    gn_v cn = gn_set(0.0);
    if (with.damping) cn = gn_load(COLUMN(args->contacts, cn) + gn_column_at(c, args->uniform.cn));
    crossing_state state = {.kn = contact->kn,
                            .cn = cn,
                            .stretch = contact->stretch,
                            .beyond = contact->beyond,
                            .elastic = contact->elastic,
                            .touching = contact->touching,
                            .loose = loose,
                            .breaking = contact->breaking};
    crossing r = cross(args, c, vector, &state);
    contact->normal = gn_where(crosses, r.of.normal, contact->normal);
    contact->share = gn_where(crosses, r.of.share, contact->share);
    contact->way = gn_where(crosses, r.of.way, contact->way);
    contact->elastic = gn_where(crosses, r.elastic, contact->elastic);
}

/* Computes the normal force without the dashpot, unless all contacts are intact bonds, and the path
 * of the step as far as it is needed. */
GN_INLINE gn_v find_normal_force(const gn_contact_args *args, size_t c, const stage *vector,
                                 contact_state *state, variant with) {
    gn_m loose = gn_not(state->intact), acting = gn_or(state->touching, state->intact),
         asked = loose;
    state->normal = gn_keep(acting, state->elastic);
    state->share = gn_keep(acting, gn_set(1.0));
    gn_v path = gn_set(args->dt) * gn_pick(growth_known(with), vector->growth, vector->speed);
    if (!growth_known(with)) {
        asked = gn_or(gn_and(loose, may_cross(args, vector, state)), state->breaking);
        if (__builtin_expect(gn_bits(asked) == 0, 1)) return path;
        path = gn_where(asked, loose_path(args, c, vector, state->intact), path);
    }
    cross_if_near(args, c, vector, path, asked, state, with);
    return path;
}

/* Adds the dashpot. For a bond `speed` is the mean over the step, so that a damped cluster in rigid
 * rotation dissipates nothing. In a collision it is the speed along the last normal: this includes
 * part of the centrifugal acceleration and is closer to the speed at the end of the step, where the
 * force acts, so that the restitution is right in fast tangential motion. */
GN_INLINE gn_v damped(const gn_contact_args *args, size_t c, gn_v speed, gn_v path,
                      const contact_state *state, lane_sums *sums, variant with) {
    const gn_contacts *k = args->contacts;
    gn_v viscous =
        state->share * gn_load(COLUMN(k, cn) + gn_column_at(c, args->uniform.cn)) * speed;
    if (with.energy) {
        gn_v half = gn_set(0.5) * (gn_load(COLUMN(k, fd) + c) + viscous);
        sums->contact_damping = sums->contact_damping + half * path;
        gn_store(COLUMN(k, fd) + c, viscous);
    }
    return state->normal + viscous;
}

GN_INLINE void linear_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                            variant with) {
    const gn_contacts *list = args->contacts;
    if (!with.shear) return;
    gn_v kt = gn_load(COLUMN(list, kt) + gn_column_at(c, args->uniform.kt));
    vector->before = gn_load3(COLUMN(list, shear) + c, list->soa.capacity, with.space);
    vector->trial = shear_trial(args, &vector->geometry, &from->motion, &vector->before,
                                vector->angle, kt, with);
}

/* Computes the forces of the springs of a contact; a law then limits bonds, and act_of completes
 * the forces. */
GN_INLINE contact_state state_of(const gn_contact_args *args, size_t c, const stage *vector,
                                 variant with) {
    const gn_contacts *list = args->contacts;
    const gn_v stretch = vector->geometry.stretch;
    contact_state q = {.stretch = stretch, .way = stretch, .share = gn_set(1.0)};
    q.kn = gn_load(COLUMN(list, kn) + gn_column_at(c, args->uniform.kn));
    q.intact = q.breaking = q.slipping = gn_m_none();
    q.normal = q.elastic = q.kn * stretch;
    if (with.shear) {
        q.kt = gn_load(COLUMN(list, kt) + gn_column_at(c, args->uniform.kt));
        q.before = vector->before;
        q.t = q.trial = vector->trial;
    }
    return q;
}

/* Completes the force once it is known which bonds hold: dashpot, contacts that open or close,
 * friction, and lost and stored energies. */
GN_INLINE contact_force act_of(const gn_contact_args *args, size_t c, const stage *vector,
                               contact_state *state, lane_sums *sums, variant with) {
    const gn_contacts *list = args->contacts;
    const pair_geometry *p = &vector->geometry;
    gn_v path = gn_set(args->dt) * gn_pick(growth_known(with), vector->growth, vector->speed),
         total = state->normal;
    if (with.bonds && __builtin_expect(gn_bits(gn_not(state->intact)) == 0, 1)) {
        /* Intact bonds have no friction limit and do not open or close. */
        if (with.damping) total = damped(args, c, vector->growth, path, state, sums, with);
    } else {
        state->beyond = gn_fma(gn_set(GN_OVERLAP_ROUNDING), p->distance, state->stretch);
        state->touching = gn_less(state->beyond, gn_set(0.0));
        path = find_normal_force(args, c, vector, state, with);
        total = state->normal;
        if (with.damping) {
            gn_v speed = gn_pick(with.bonds, gn_where(state->intact, vector->growth, vector->speed),
                                 vector->speed);
            total = damped(args, c, speed, path, state, sums, with);
        }
        if (with.shear) limit_shear(args, c, total, state, with);
        if (gn_bits(gn_or(state->slipping, state->breaking)) && with.energy)
            book_release(args, c, vector, path, state, sums, with);
    }
    if (with.shear) gn_store3(COLUMN(list, shear) + c, list->soa.capacity, state->t, with.space);
    if (args->measure && with.energy) book_elastic(state, sums, with);
    return (contact_force){total, state->t, gn_set(0.0)};
}

GN_INLINE contact_force linear_force(const gn_contact_args *args, size_t c, size_t end,
                                     const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                     variant with) {
    contact_state q = state_of(args, c, vector, with);
    if (with.bonds && __builtin_expect(all_hold(args, c, &q, with), 1))
        q.intact = gn_not(gn_m_none());
    else if (with.bonds)
        break_bonds(args, c, end, &q, sums, with);
    return act_of(args, c, vector, &q, lanes, with);
}

#endif
