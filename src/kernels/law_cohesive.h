/* Attraction of unbonded spheres beside Hertz-Mindlin contacts (cohesion.h), with or without
 * resistance to rolling. The dashpot is that of Hertz's law for the overlap, so that necks and
 * bridges have none. The tangential stiffness follows the radius of the contact, by JKR that of its
 * circle, in a neck too.
 *
 * Friction: the solids press each other with the force f + P, where f is the compressive force in
 * total and P is 2 A by JKR (Thornton 1991), A by DMT, and the force of the liquid bridge. |F_t| <=
 * mu (f + P), and moments of rolling are limited alike.
 *
 * An attraction begins and ends with a jump. The force of the step in which it began (ended) is
 * multiplied by the share of time for which it acted, 1/2 + s (1/2 - s), where s is the part of the
 * step's path beyond the jump; otherwise its impulse would depend on the phase of the steps. The
 * ledger books the loss of the contact in closed form.
 *
 * Columns in addition to those of Hertz's law: adhesion (A), span (with liquid -2 R, by DMT 0);
 * state: bridge, onset. Without
 * liquid `bridge` is 1 while the particles adhere. With liquid it is the volume, which
 * particles/bridges.c sets: pairs that touch ask for a bridge by `onset`, and ruptured bridges
 * report it. */
#ifndef GN_KERNELS_LAW_COHESIVE_H
#define GN_KERNELS_LAW_COHESIVE_H

#include "kernels/cohesion.h"
#include "kernels/law_rolling.h"
#include "scene/scene.h"

#if GN_MIXED
/* There are no such kernels in single precision. */
#define NONE(name)                                                                                 \
    GN_INLINE void name##_trial(const gn_contact_args *args, size_t c, const brief *from,          \
                                stage *vector, variant with) {                                     \
        (void)args, (void)c, (void)from, (void)vector, (void)with;                                 \
    }                                                                                              \
    GN_INLINE contact_force name##_force(const gn_contact_args *args, size_t c, size_t end,        \
                                         const stage *vector, lane_sums *lanes,                    \
                                         gn_contact_sums *sums, variant with) {                    \
        (void)args, (void)c, (void)end, (void)vector, (void)lanes, (void)sums, (void)with;         \
        __builtin_unreachable();                                                                   \
    }
NONE(cohesive)
NONE(cohesive_rolling)
#undef NONE
#else

/* The attraction of a vector of pairs. */
typedef struct attraction {
    gn_m grips;        /* the solids touch */
    gn_v normal;       /* N, force without the dashpot, tension positive */
    gn_v root;         /* m^1/2, root of the overlap, by JKR that of the circle of the contact */
    gn_v beside;       /* N, P above */
    gn_v stored, lost; /* J */
} attraction;

/* A pair before its attraction is known. */
typedef struct meeting_pair {
    gn_hertz_press press; /* Hertz's force for the overlap */
    gn_v stretch, overlap, adhesion, span, bridge, path;
    gn_m touches;
} meeting_pair;

/* Returns the factor on a force that began within the step, or that ended; `beyond`: path from the
 * jump to the end of the step. Without a path it acts in full. */
GN_INLINE gn_v began_share(gn_v beyond, gn_v path, gn_v sign) {
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    gn_v way = gn_max(path, zero - path);
    gn_v s = beyond / gn_max(way, gn_set(GN_TINY));
    s = zero - gn_max(zero - gn_max(s, zero), zero - one);
    return gn_where(gn_less(zero, way), gn_fma(sign, s, gn_set(0.5)), gn_max(sign, zero));
}

/* Computes the attraction by JKR or DMT, and stores whether the particles adhere. */
GN_INLINE attraction adhere(const gn_contact_args *args, size_t c, const meeting_pair *p, int jkr) {
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    const gn_m before = gn_less(zero, p->bridge);
    const gn_v reach = jkr ? p->span : zero;
    const gn_m necked = gn_and(before, gn_less(p->stretch, reach));
    const gn_m acts = gn_or(p->touches, necked);
    const gn_m starts = gn_and(acts, gn_not(before)), ends = gn_and(before, gn_not(acts));
    attraction a = {acts, zero, p->press.root, zero, zero, zero};
    gn_v normal = p->press.normal + p->adhesion, first = p->adhesion, last = first;
    gn_v stored = gn_hertz_stored(p->press.normal, p->overlap) - p->adhesion * p->overlap;
    a.beside = p->adhesion;
    if (jkr) {
        const gn_m sticks = gn_less(zero, p->span);
        gn_v s = gn_jkr_root(zero - p->stretch, p->span), held = p->span * p->adhesion;
        a.root = gn_where(sticks, gn_jkr_width(s, p->span), p->press.root);
        normal = gn_where(sticks, p->adhesion * gn_jkr_pull(s), p->press.normal);
        stored = gn_where(sticks, held * gn_jkr_stored(s), stored);
        first = gn_set(8.0 / 9.0) * p->adhesion;
        last = gn_set(5.0 / 9.0) * p->adhesion;
        a.beside = gn_set(2.0) * p->adhesion;
        a.lost = gn_keep(starts, gn_set(GN_JKR_FORMED) * held) +
                 gn_keep(ends, gn_set(GN_JKR_SEPARATED) * held);
    }
    gn_v extra = first * (began_share(p->overlap, p->path, one) - one);
    gn_v tail = last * began_share(p->stretch - reach, p->path, zero - one);
    a.normal = gn_keep(acts, normal) + gn_keep(starts, extra) + gn_keep(ends, tail);
    a.root = gn_keep(acts, a.root);
    a.beside = gn_keep(acts, a.beside);
    a.stored = gn_keep(acts, stored);
    gn_store(args->contacts->bridge + c, gn_keep(acts, one));
    return a;
}

/* Three of the functions that bridges need, lane by lane: cube roots and arcs have no vector form.
 * `bridge`: volumes, 0: none. */
typedef struct bridge_lanes {
    _Alignas(64) gn_real stretch[GN_W], path[GN_W], bridge[GN_W], span[GN_W], out[GN_W];
} bridge_lanes;

GN_INLINE bridge_lanes lanes_of(const meeting_pair *p, gn_m which) {
    bridge_lanes l;
    gn_store(l.stretch, p->stretch);
    gn_store(l.path, p->path);
    gn_store(l.bridge, gn_keep(which, p->bridge));
    gn_store(l.span, p->span);
    return l; // cppcheck-suppress uninitvar
}

/* Computes the energies of bridges over A, m. */
static __attribute__((noinline)) void bridge_energies(bridge_lanes *l, double rupture) {
    for (int k = 0; k < GN_W; k++)
        l->out[k] = l->bridge[k] > 0
                        ? (gn_real)gn_bridge_energy((double)l->stretch[k], (double)l->span[k],
                                                    (double)l->bridge[k], rupture)
                        : 0;
}

/* Rare: computes the forces over A of bridges that ruptured within the step. */
static __attribute__((noinline)) void bridge_tails(bridge_lanes *l, double rupture) {
    for (int k = 0; k < GN_W; k++)
        l->out[k] = l->bridge[k] > 0
                        ? (gn_real)gn_bridge_tail((double)l->stretch[k], (double)l->path[k],
                                                  (double)l->span[k], (double)l->bridge[k], rupture)
                        : 0;
}

/* Rare: counts pairs whose bridge is to form or has ruptured. */
static __attribute__((noinline)) void count_wetting(unsigned which, size_t c, size_t end,
                                                    gn_contact_sums *sums) {
    for (size_t lane = 0; lane < GN_W && c + lane < end; lane++) sums->wetting += which >> lane & 1;
}

/* Computes the attraction by liquid bridges, and asks for those that are to form or have
 * ruptured. */
GN_INLINE attraction wet(const gn_contact_args *args, size_t c, size_t end, const meeting_pair *p,
                         gn_contact_sums *sums, int stores) {
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    const gn_v onset = gn_load(args->contacts->onset + c), gap = gn_max(p->stretch, zero);
    const gn_m bridged = gn_less(zero, p->bridge);
    const gn_m apart = gn_less(gn_set(args->rupture) * p->bridge, gap * gap * gap);
    const gn_m holds = gn_and(bridged, gn_not(apart)), ends = gn_and(bridged, apart);
    const gn_m bare = gn_and(p->touches, gn_not(bridged));
    const gn_m asks = gn_and(bare, gn_less(onset, gn_set(GN_BRIDGE_DRY)));
    attraction a = {p->touches, p->press.normal, p->press.root, zero, zero, zero};
    gn_v pull = gn_keep(holds, p->adhesion * gn_bridge_pull(gap, p->span, p->bridge));
    gn_v late = gn_keep(holds, gn_max(onset, zero)), now = gn_keep(bare, gn_max(onset, zero));
    a.beside = pull;
    a.normal = a.normal + gn_fma(late, pull, pull);
    if (__builtin_expect(gn_bits(gn_or(asks, ends)) != 0, 0)) {
        bridge_lanes l = lanes_of(p, ends);
        bridge_tails(&l, args->rupture);
        a.normal = a.normal + p->adhesion * gn_load(l.out);
        now = gn_where(asks, gn_set(-0.5) - began_share(p->overlap, p->path, one), now);
        now = gn_where(ends, gn_set(GN_BRIDGE_RUPTURED), now);
        count_wetting(gn_bits(gn_or(asks, ends)), c, end, sums);
    }
    if (stores) {
        bridge_lanes l = lanes_of(p, holds);
        bridge_energies(&l, args->rupture);
        a.stored =
            gn_fma(p->adhesion, gn_load(l.out), gn_hertz_stored(p->press.normal, p->overlap));
    }
    gn_store(args->contacts->onset + c, now);
    return a;
}

GN_INLINE attraction attraction_of(const gn_contact_args *args, size_t c, size_t end,
                                   const meeting_pair *p, gn_contact_sums *sums, variant with) {
    if (args->cohesion == GN_COHESION_LIQUID)
        return wet(args, c, end, p, sums, args->measure && with.energy);
    return args->cohesion == GN_COHESION_JKR ? adhere(args, c, p, 1) : adhere(args, c, p, 0);
}

GN_INLINE void cohesive_trial(const gn_contact_args *args, size_t c, const brief *from,
                              stage *vector, variant with) {
    hertz_trial(args, c, from, vector, with);
}

/* Computes the force of a vector of pairs; *solids: the force with which the solids press each
 * other, N >= 0; *root: see attraction. */
GN_INLINE contact_force cohesive_forces(const gn_contact_args *args, size_t c, size_t end,
                                        const stage *vector, lane_sums *lanes,
                                        gn_contact_sums *sums, gn_v *solids, gn_v *root,
                                        variant with) {
    const gn_contacts *k = args->contacts;
    const pair_geometry *s = &vector->geometry;
    const gn_v zero = gn_set(0.0);
    gn_v beyond = gn_fma(gn_set(GN_OVERLAP_ROUNDING), s->distance, s->stretch);
    gn_v kn = gn_load(COLUMN(k, kn) + gn_column_at(c, args->uniform.kn));
    meeting_pair p = {.stretch = s->stretch, .touches = gn_less(beyond, zero)};
    p.overlap = gn_keep(p.touches, zero - s->stretch);
    p.press = gn_hertz_normal(kn, p.overlap);
    p.adhesion = gn_load(k->adhesion + gn_column_at(c, args->uniform.adhesion));
    p.span = gn_load(k->span + gn_column_at(c, args->uniform.span));
    p.span = gn_max(p.span, zero - p.span);
    p.bridge = gn_load(k->bridge + c);
    p.path = gn_set(args->dt) * vector->growth;
    gn_m over = gn_less(gn_load(COLUMN(k, most) + c), p.overlap);
    if (__builtin_expect(gn_bits(over) != 0, 0)) count_pressed(gn_bits(over), c, end, sums);
    attraction a = attraction_of(args, c, end, &p, sums, with);
    contact_force f = {a.normal, {zero, zero, zero}, a.beside};
    if (with.damping)
        f.normal = f.normal + hertz_viscous(args, c, vector, kn, beyond, &p.press, lanes, with);
    *root = p.press.root = a.root;
    *solids = gn_keep(a.grips, gn_max(a.beside - f.normal, zero));
    if (with.shear)
        f.shear = hertz_shear(args, c, vector, &p.press, f.normal - a.beside, a.grips, lanes, with);
    if (with.energy) {
        if (args->dt > 0.0) lanes->cohesion = lanes->cohesion + a.lost;
        if (args->measure) lanes->elastic_normal = lanes->elastic_normal + a.stored;
    }
    return f;
}

GN_INLINE contact_force cohesive_force(const gn_contact_args *args, size_t c, size_t end,
                                       const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                       variant with) {
    gn_v solids, root;
    return cohesive_forces(args, c, end, vector, lanes, sums, &solids, &root, with);
}

GN_INLINE void cohesive_rolling_trial(const gn_contact_args *args, size_t c, const brief *from,
                                      stage *vector, variant with) {
    hertz_trial(args, c, from, vector, with);
}

GN_INLINE contact_force cohesive_rolling_force(const gn_contact_args *args, size_t c, size_t end,
                                               const stage *vector, lane_sums *lanes,
                                               gn_contact_sums *sums, variant with) {
    const gn_v past = gn_load(COLUMN(args->contacts, closeness) + c);
    gn_v solids, root;
    contact_force f = cohesive_forces(args, c, end, vector, lanes, sums, &solids, &root, with);
    const gn_v now = gn_load(COLUMN(args->contacts, closeness) + c);
    root = gn_keep(gn_less(gn_set(0.0), now), root);
    roll(args, c, vector, solids, (roll_grip){root, past, now}, lanes, with);
    return f;
}

#endif
#endif
