/* Bonds that soften in tension and shear and yield under pressure (Santasusana 2013, sec. 4.7, eq.
 * 4.36-4.45), with the Mohr-Coulomb strength of law_mohr.h.
 *
 * Normal force, u the stretch beyond the permanent one u_p, k = k_n:
 *     tension  (1 - d) k u, at most the line R_n (u_f - u)/(u_f - u_l), u_l = R_n/k. On the line
 *              d = 1 - f/(k u) = u_f (u - u_l)/(u (u_f - u_l)): linear softening, eq. 4.43.
 *              (Eq. 4.39, d = (u - u_l)/(u_f - u_l), is a parabola that rises above R_n.) Unloading
 *              follows the secant; d never decreases; the bond breaks at u_f.
 *     compression  k u, at most a line of up to four pieces over the whole path, with the
 *              stiffnesses k, k/Y_1, k/Y_2, k/Y_3 and kinks at the forces F_i. Stretch beyond it
 *              is added to u_p; unloading and reloading have the stiffness k.
 * Shear: trial |F_t| beyond the surface
 *     S = (1 - D) C + ((1 - kappa) mu_1 + kappa mu_2) N, D = max(d, kappa), N = <-f_n>
 * slips by ds and returns along its direction onto S - H ds with kappa += ds/u_s, so that it
 * softens linearly to the friction of the broken bond without a jump; the bond breaks at
 * kappa = 1. If the slope H of S is not below k_t, it breaks at once.
 *
 * With quadratic coupling one damage kappa reduces both strengths, R_n and C by 1 - kappa, and the
 * tensile stiffness by 1 - d = (1 - kappa)/(1 + (n - 1) kappa), n = u_f/u_l, which in pure tension
 * is the line above. If (f_n/R_n)^2 + (|F_t|/C)^2 >= 1 in tension, kappa grows so that the forces
 * return to that ellipse, with openings u_f and slips u_s per kappa along its normal: with the
 * ratios a = f_n/R_n and b = |F_t|/C to the remaining strengths, du_i = a u_f dkappa, ds = b u_s
 * dkappa. At a fixed ratio of the two that dissipates a^2 G_n + b^2 G_t.
 *
 * Everything has a closed form from the state at the start of the step, kinks within a step
 * included. Losses are the trapezoidal work of the step minus the change of stored energy, so that
 * the ledger closes; if a kink lies within a step, they differ from the energy of the path by
 * the square of the step.
 *
 * Columns in addition to those of the Mohr-Coulomb law: soft = 1 - d, kappa, plastic = u_p, yields
 * (the compressive force at which u_p grows), parameters fade and crush (below). rn, rt and mu1 are
 * those of the damaged bond: R_n on the line, (1 - D) C, and the friction in S. Their changes are
 * rare and computed in double precision, lane by lane; in mixed precision both forms are written.
 * kappa grows by small increments and is double in either; d is recomputed from the stretch. */
#ifndef GN_KERNELS_LAW_SOFTENING_H
#define GN_KERNELS_LAW_SOFTENING_H

#include "kernels/law_linear.h"
#include "kernels/softening.h"

/* Input and output of the rare branch, lane by lane. */
typedef struct soft_lanes {
    gn_real stretch[GN_W], normal[GN_W], shear[3][GN_W], broken[GN_W];
    gn_real was[GN_W], before[3][GN_W]; /* values at the start of the step, if one damage variable
                                           applies to tension and shear */
    unsigned tension, sheared;          /* lanes that break */
} soft_lanes;

static inline void write_softened(const gn_contacts *list, size_t c,
                                  const gn_softening_bond *bond) {
    list->soft[c] = bond->soft;
    list->rn[c] = bond->rn;
    list->rt[c] = bond->rt;
    list->mu1[c] = bond->mu1;
    list->kappa[c] = bond->kappa;
#if GN_MIXED
    list->soft_f[c] = (float)bond->soft;
    list->rn_f[c] = (float)bond->rn;
    list->rt_f[c] = (float)bond->rt;
    list->mu1_f[c] = (float)bond->mu1;
#endif
}

/* Records an event. */
static inline void note_beginning(const gn_contacts *list, size_t c, gn_happening what,
                                  gn_contact_sums *sums) {
    if (!list->happened || list->cause[c] != GN_INTACT) return;
    list->happened[c] |= (uint8_t)what;
    sums->began++;
}

/* Rare: softens bonds at their strength or beyond it. */
static __attribute__((noinline)) void soften(const gn_contact_args *args, size_t c, size_t end,
                                             unsigned lanes, soft_lanes *q, gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    q->tension = q->sheared = 0;
    for (size_t lane = 0; lane < GN_W; lane++) {
        q->broken[lane] = 0;
        if (c + lane >= end || !(lanes >> lane & 1)) continue;
        gn_softening_bond b = gn_softening_bond_of(k, c + lane);
        gn_softening_way way = {.u = {q->was[lane], q->stretch[lane]}};
        for (int x = 0; x < 3; x++) {
            way.t[0][x] = q->before[x][lane];
            way.t[1][x] = q->shear[x][lane];
        }
        double normal = q->normal[lane], t[3];
        bool whole = gn_softening_whole(&b);
        gn_cause cause = gn_soften(&b, &way, &normal, t);
        if (cause == GN_INTACT) {
            if (whole && !gn_softening_whole(&b))
                note_beginning(k, c + lane, GN_HAPPENED_SOFTENING, sums);
            write_softened(k, c + lane, &b);
            q->normal[lane] = (gn_real)normal;
            for (int x = 0; x < 3; x++) q->shear[x][lane] = (gn_real)t[x];
            continue;
        }
        q->broken[lane] = 1;
        *(cause == GN_BROKEN_TENSION ? &q->tension : &q->sheared) |= 1u << lane;
    }
}

/* Rare: computes the permanent stretch of yielding bonds from the total stretch, so that errors do
 * not accumulate. */
static __attribute__((noinline)) gn_v yield_more(const gn_contact_args *args, size_t c, gn_v kn,
                                                 gn_v stretch, gn_v now, gn_m yielding,
                                                 gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    const size_t stride = k->soa.capacity;
    gn_v path = gn_set(0.0) - kn * stretch, force = path;
    for (size_t n = 0; n < 3; n++) {
        gn_v kink = gn_load(COLUMN(k, crush) + c + n * stride);
        gn_v less = gn_load(COLUMN(k, crush) + c + (n + 3) * stride);
        force = gn_fnma(less, gn_max(path - kink, gn_set(0.0)), force);
    }
    gn_v plastic = gn_where(yielding, stretch + force / kn, now);
    unsigned begun = gn_bits(gn_and(yielding, gn_at_least(now, gn_set(0.0))));
    for (size_t lane = 0; begun && lane < GN_W; lane++)
        if (begun >> lane & 1) note_beginning(k, c + lane, GN_HAPPENED_YIELD, sums);
    gn_store(COLUMN(k, plastic) + c, plastic);
    gn_store(COLUMN(k, yields) + c, gn_where(yielding, force, gn_load(COLUMN(k, yields) + c)));
    return plastic;
}

/* The state of a vector in addition to its contact_state. */
typedef struct soft_state {
    gn_v soft, shift; /* values at the start of the step */
    gn_v line;        /* force at which the bond would yield in compression then, if it can */
    gn_v3 slipped;    /* tangential force of bonds that softened */
    gn_v stored;      /* twice the energy of the normal spring, for contacts in `crossing` */
    gn_m bonds;       /* the bond is intact at the start of the step */
    gn_m yielding, softening, crossing;
} soft_state;

/* Computes the permanent stretch of bonds in compression and its change in this step. */
GN_INLINE void press(const gn_contact_args *args, size_t c, const stage *vector,
                     contact_state *state, soft_state *soft, gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    soft->shift = soft->line = gn_set(0.0);
    soft->yielding = gn_m_none();
    if (!(k->soa.effects & GN_FX_YIELD)) return;
    gn_v now = soft->shift = gn_load(COLUMN(k, plastic) + c);
    state->elastic = state->kn * (vector->geometry.stretch - now);
    soft->line = gn_load(COLUMN(k, yields) + c);
    soft->yielding = gn_less(state->elastic + soft->line, gn_set(0.0));
    if (__builtin_expect(gn_bits(soft->yielding) != 0, 0))
        now = yield_more(args, c, state->kn, vector->geometry.stretch, now, soft->yielding, sums);
    state->way = state->stretch = vector->geometry.stretch - now;
    state->normal = state->elastic = state->kn * state->stretch;
}

/* Rare: returns the growth of the distance in the step. */
static __attribute__((noinline)) gn_v whole_path(const gn_contact_args *args, size_t c,
                                                 const stage *vector, variant with) {
    if (growth_known(with)) return gn_set(args->dt) * vector->growth;
    return loose_path(args, c, vector, gn_m_none());
}

/* Returns the tangential force at the start of the step, after the rotation of both ends. */
GN_INLINE gn_v3 sheared_before(const stage *vector, const contact_state *state, variant with) {
    bool turns = with.space && with.rotation;
    return turns ? gn_turn_about_normal(state->before, vector->geometry.n, vector->angle)
                 : state->before;
}

/* Computes damage, and which bonds break in this step. */
GN_INLINE void damage(const gn_contact_args *args, size_t c, size_t end, const stage *vector,
                      contact_state *state, soft_state *bond, gn_contact_sums *sums, variant with) {
    const gn_contacts *k = args->contacts;
    const gn_v zero = gn_set(0.0);
    gn_v rn = gn_load(COLUMN(k, rn) + c), rt = gn_load(COLUMN(k, rt) + c);
    bond->soft = gn_load(COLUMN(k, soft) + c);
    bond->bonds = state->intact = gn_less(zero, rn);
    state->normal = gn_where(gn_and(state->intact, gn_less(zero, state->elastic)),
                             bond->soft * state->elastic, state->elastic);
    gn_v strength = gn_fma(gn_load(COLUMN(k, mu1) + c), pressed_of(args, c, state->normal), rt);
    strength = gn_max(strength, zero);
    gn_v strength2 = strength * strength;
    if (k->soa.effects & GN_FX_COUPLED_QUADRATIC) {
        gn_v share = gn_max(state->normal, zero) / rn;
        strength2 = gn_fnma(strength2, share * share, strength2);
    }
    gn_m beyond = gn_at_least(gn_dot(state->trial, state->trial, 1), strength2);
    bond->softening = gn_and(state->intact, gn_or(beyond, gn_at_least(state->normal, rn)));
    bond->slipped = state->trial;
    if (__builtin_expect(gn_bits(bond->softening) == 0, 1)) return;
    soft_lanes l = {0};
    if (k->soa.effects & GN_FX_COUPLED_QUADRATIC) {
        gn_v3 before = sheared_before(vector, state, with);
        gn_store(l.was, vector->geometry.stretch - whole_path(args, c, vector, with) - bond->shift);
        gn_store(l.before[0], before.x);
        gn_store(l.before[1], before.y);
        gn_store(l.before[2], before.z);
    }
    gn_store(l.stretch, state->stretch);
    gn_store(l.normal, state->normal);
    gn_store(l.shear[0], state->trial.x);
    gn_store(l.shear[1], state->trial.y);
    gn_store(l.shear[2], state->trial.z);
    soften(args, c, end, gn_bits(bond->softening), &l, sums);
    state->breaking = gn_and(bond->softening, gn_less(zero, gn_load(l.broken)));
    state->intact = gn_and(state->intact, gn_not(state->breaking));
    bond->softening = gn_and(bond->softening, gn_not(state->breaking));
    state->normal = gn_where(state->intact, gn_load(l.normal), state->elastic);
    bond->slipped = (gn_v3){gn_load(l.shear[0]), gn_load(l.shear[1]), gn_load(l.shear[2])};
    if (l.tension | l.sheared) record_breaks(args, c, end, l.tension, l.sheared, sums);
}

/* Finds contacts that may have passed the state of zero normal force. It finds more of them than
 * may_cross, by an upper bound of the particles' motion, but needs no division; where every bond is
 * damaged all of them are tested, and almost none is near that state. */
GN_INLINE gn_m near_no_force(const gn_contact_args *args, const stage *vector,
                             const contact_state *state) {
    double fastest = args->speed_most > 0.0 ? 2.0 * args->speed_most : (double)INFINITY;
    double most = args->dt > 0.0 ? args->dt * fastest : 0.0;
    gn_v rounding = gn_set(2.0 * GN_OVERLAP_ROUNDING + 0x1p-40),
         distance = vector->geometry.distance;
    gn_v size = gn_max(state->stretch, gn_set(0.0) - state->stretch) - gn_set(1.01 * most);
    gn_v beyond = gn_fnma(rounding, distance, size) * distance;
    return gn_not(gn_less(gn_set(1.03 * most * most), beyond));
}

/* Rare: a damaged bond is a two-sided spring of stiffness (1 - d) k in parallel with one of d k
 * that acts in compression only. The latter closes or opens within a step as any contact does. */
GN_INLINE void cross_softened(const gn_contact_args *args, size_t c, const stage *vector,
                              contact_state *contact, soft_state *soft) {
    gn_m weak = gn_and(contact->intact, gn_less(soft->soft, gn_set(1.0)));
    weak = gn_and(weak, gn_not(gn_or(soft->softening, soft->yielding)));
    soft->crossing = gn_m_none();
    soft->stored = gn_set(0.0);
    if (__builtin_expect(gn_bits(weak) == 0, 1)) return;
    weak = gn_and(weak, near_no_force(args, vector, contact));
    if (__builtin_expect(gn_bits(weak) == 0, 1)) return;
    contact->beyond =
        gn_fma(gn_set(GN_OVERLAP_ROUNDING), vector->geometry.distance, contact->stretch);
    contact->touching = gn_less(contact->beyond, gn_set(0.0));
    stage seen = *vector; /* rate and growth share their storage */
    seen.rate = gn_set(0.5 * args->dt) / gn_max(vector->geometry.distance, gn_set(GN_TINY));
    soft->crossing = gn_and(weak, may_cross(args, &seen, contact));
    if (__builtin_expect(gn_bits(soft->crossing) == 0, 1)) return;
    gn_v gone = (gn_set(1.0) - soft->soft) * contact->kn;
    /* The dashpot belongs to the two-sided bond. */
    crossing_state state = {.kn = gone,
                            .cn = gn_set(0.0),
                            .stretch = contact->stretch,
                            .beyond = contact->beyond,
                            .elastic = gone * contact->stretch,
                            .touching = contact->touching,
                            .loose = soft->crossing,
                            .breaking = gn_m_none()};
    crossing r = cross(args, c, &seen, &state);
    /* Contacts that were only near the transition act as in any other step, whatever other lanes
     * do. */
    gn_m as_ever =
        gn_and(gn_at_least(r.of.way, contact->stretch), gn_at_least(contact->stretch, r.of.way));
    soft->crossing = gn_and(soft->crossing, gn_not(as_ever));
    gn_v whole = soft->soft * contact->elastic;
    contact->normal = gn_where(soft->crossing, whole + r.of.normal, contact->normal);
    soft->stored = gn_fma(whole, contact->stretch, r.of.normal * r.of.way);
}

/* Rare: books the losses of bonds that soften, yield or break, and of slipping contacts. */
GN_INLINE void book_softening(const gn_contact_args *args, size_t c, const stage *vector,
                              const contact_state *state, const soft_state *soft, lane_sums *sums,
                              variant with) {
    const gn_v half = gn_set(0.5), zero = gn_set(0.0);
    gn_v path = whole_path(args, c, vector, with),
         was = vector->geometry.stretch - path - soft->shift;
    gn_v old = state->kn * was,
         twice = gn_where(soft->crossing, soft->stored, state->normal * state->way);
    old = gn_where(gn_less(zero, was), gn_keep(soft->bonds, soft->soft * old), old);
    gn_v normal = half * (gn_fma(old + state->normal, path, old * was) - twice);
    gn_m crushed = gn_and(soft->yielding, gn_not(state->breaking));
    sums->plasticity = sums->plasticity + gn_keep(crushed, normal);
    if (!gn_bits(gn_or(gn_or(state->slipping, state->breaking), soft->softening))) return;
    gn_v3 before = sheared_before(vector, state, with);
    gn_v shear = gn_released3(before, state->t, state->trial, gn_max(state->kt, gn_set(GN_TINY)),
                              with.space);
    gn_v both = normal + shear;
    sums->bond_breaking = sums->bond_breaking + gn_keep(state->breaking, both);
    if (gn_bits(state->breaking)) note_released(args, c, gn_bits(state->breaking), both);
    sums->friction =
        sums->friction + gn_keep(gn_and(state->slipping, gn_not(state->breaking)), shear);
    sums->damage = sums->damage + gn_keep(soft->softening, gn_where(crushed, shear, both));
}

/* Rare: handles broken bonds that yield in the step. A contact that was in compression before acts
 * as usual, even if it moved by less than it yields. A contact that closed within the step, at the
 * fraction s = u/p of its path, acted from there on: the elastic part of its force, as of
 * gn_linear_cross, is reduced by the yield, and the loss is (F_0 + F) du/2 between the forces F_0
 * and F, over the path. */
GN_INLINE void close_yielding(const stage *vector, gn_v path, gn_m yielding, const soft_state *soft,
                              contact_state *state) {
    const gn_v zero = gn_set(0.0), half = gn_set(0.5);
    gn_v u = vector->geometry.stretch - soft->shift, before = u - path;
    gn_m closed = gn_and(yielding, gn_at_least(before, zero));
    gn_m pressed = gn_and(yielding, gn_less(before, zero));
    state->normal = gn_where(pressed, state->elastic, state->normal);
    state->share = gn_where(pressed, gn_set(1.0), state->share);
    state->way = gn_where(pressed, state->stretch, state->way);
    gn_v lost = half * (state->elastic - soft->line) * (u - state->stretch);
    gn_v normal = state->normal + lost / path;
    state->normal = gn_where(closed, normal, state->normal);
    state->share = gn_where(closed, half + u / path, state->share);
    state->way = gn_where(closed, state->way - gn_set(2.0) * lost / normal, state->way);
}

GN_INLINE void softening_trial(const gn_contact_args *args, size_t c, const brief *from,
                               stage *vector, variant with) {
    linear_trial(args, c, from, vector, with);
}

GN_INLINE contact_force softening_force(const gn_contact_args *args, size_t c, size_t end,
                                        const stage *vector, lane_sums *lanes,
                                        gn_contact_sums *sums, variant with) {
    contact_state q = state_of(args, c, vector, with);
    soft_state s;
    press(args, c, vector, &q, &s, sums);
    damage(args, c, end, vector, &q, &s, sums, with);
    cross_softened(args, c, vector, &q, &s);
    gn_v path = gn_set(args->dt) * gn_pick(growth_known(with), vector->growth, vector->speed),
         total = q.normal;
    if (__builtin_expect(gn_bits(gn_not(q.intact)) == 0, 1)) {
        if (with.damping) total = damped(args, c, vector->growth, path, &q, lanes, with);
        q.t = s.slipped;
    } else {
        gn_v held = q.normal;
        q.beyond = gn_fma(gn_set(GN_OVERLAP_ROUNDING), vector->geometry.distance, q.stretch);
        q.touching = gn_less(q.beyond, gn_set(0.0));
        path = find_normal_force(args, c, vector, &q, with);
        gn_m loose = gn_and(s.yielding, gn_not(gn_or(q.intact, q.breaking)));
        if (__builtin_expect(gn_bits(loose) != 0, 0)) close_yielding(vector, path, loose, &s, &q);
        total = q.normal = gn_where(q.intact, held, q.normal);
        if (with.damping) {
            gn_v speed = gn_where(q.intact, vector->growth, vector->speed);
            total = damped(args, c, speed, path, &q, lanes, with);
        }
        limit_shear(args, c, total, &q, with);
        q.t.x = gn_where(q.intact, s.slipped.x, q.t.x);
        q.t.y = gn_where(q.intact, s.slipped.y, q.t.y);
        if (with.space) q.t.z = gn_where(q.intact, s.slipped.z, q.t.z);
    }
    gn_m lost = gn_or(gn_or(q.slipping, q.breaking), gn_or(s.softening, s.yielding));
    if (__builtin_expect(gn_bits(lost) != 0, 0) && with.energy)
        book_softening(args, c, vector, &q, &s, lanes, with);
    gn_store3(COLUMN(args->contacts, shear) + c, args->contacts->soa.capacity, q.t, with.space);
    if (args->measure && with.energy) {
        book_elastic(&q, lanes, with);
        lanes->elastic_normal = lanes->elastic_normal +
                                gn_keep(s.crossing, gn_set(0.5) * (s.stored - q.normal * q.way));
    }
    return (contact_force){total, q.t, gn_set(0.0)};
}

#endif
