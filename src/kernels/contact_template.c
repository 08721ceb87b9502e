/* The contact kernel: one body, compiled once per instruction set (GN_SIMD, GN_TABLE set by the
 * build) and expanded once per variant with literal arguments, so that an effect that is off leaves
 * no code.
 *
 * Per contact: geometry from the rows of the two particles, linear normal law with a stress-free
 * length, incremental tangential law with radial return, brittle uncoupled bond (Rojek et al. 2012,
 * eq. 15-16), viscous normal damping. Output: the block's partial sums of force and moment per
 * particle, which motion_template.c adds up. */
#include "kernels/block_rows.h"
#include "kernels/contact.h"
#include "kernels/contact_law.h"
#include "kernels/expand.h"

#include <math.h>
#include <string.h>

/* Literal switches of a variant. */
typedef struct variant {
    int space, rotation, shear, friction, bonds, damping, energy, periodic;
} variant;

/* A column in the precision of the kernel. */
#if GN_MIXED
#define COLUMN(list, name) ((list)->name##_f)
#else
#define COLUMN(list, name) ((list)->name)
#endif

/* Work is staggered: a vector of contacts goes through six short stages, one per turn of the loop,
 * so that in every turn six vectors advance that do not wait for each other. A vector's own chain
 * of dependent operations (root, division, dot products) is longer than what a core can look ahead.
 */
enum { STAGES = 6, RING = 8 };

typedef struct pair_geometry {
    gn_v3 n; /* normal from i to j; before find_normal the branch, not of unit length */
    gn_v distance, stretch; /* stretch: beyond the distance at which the normal force is zero */
    gn_v arm_i, arm_j;      /* from the centres to the contact; before find_normal the radii */
} pair_geometry;

typedef struct pair_motion {
    gn_v3 middle;   /* see gn_middle */
    gn_v3 relative; /* tangential velocity at the contact, turned from the middle to the end */
} pair_motion;

/* A vector on its way. */
typedef struct stage {
    pair_geometry geometry;
    union {
        gn_v rate; /* dt/(2 distance) */
        gn_v path; /* from find_motion on, if path_known: by how much the distance grew */
    };
    gn_v speed;          /* normal component at the end of the step, opening positive */
    gn_v angle;          /* mean turn of the pair about the normal in the step */
    gn_v3 before, trial; /* see contact_state */
} stage;

/* What only the next stage reads. */
typedef union brief {
    pair_motion motion;
    _Alignas(64) gn_real row[8 * GN_W]; /* force on i, 0, n x F_t, 0 (width 4: see gn_partials) */
} brief;

/* Indices into the ring are shifts then. */
_Static_assert(sizeof(stage) == 16 * sizeof(gn_v), "a stage has a power of two of bytes");
_Static_assert(sizeof(brief) == 8 * sizeof(gn_v) || sizeof(gn_v) < 64, "so has a brief");

#if !GN_MIXED
GN_INLINE gn_v3 nearest_image(gn_v3 d, const double *period, const double *inverse, int space) {
    gn_v3 r = d;
    r.x = gn_fnma(gn_set(period[0]), gn_round(d.x * gn_set(inverse[0])), d.x);
    r.y = gn_fnma(gn_set(period[1]), gn_round(d.y * gn_set(inverse[1])), d.y);
    if (space) r.z = gn_fnma(gn_set(period[2]), gn_round(d.z * gn_set(inverse[2])), d.z);
    return r;
}
#endif

/* From i to j, its length, and the stretch. Sums over the two ends are written symmetrically, so
 * that exchanging i and j mirrors every bit. */
#if GN_MIXED
/* Single precision resolves neither positions nor the difference of two lengths. Both come from the
 * branch D and the stretch s of the instant when the lists were made (computed in double) and from
 * the travel u since then: |D + u|^2 - |D|^2 = (2 D + u).u has the relative precision of u. */
GN_INLINE gn_v3 branch(const gn_contact_args *a, size_t c, const gn_v pi[4], const gn_v pj[4],
                       gn_v *distance, gn_v *stretch, variant w) {
    const gn_contacts *list = a->contacts;
    gn_v3 u = {pj[0] - pi[0], pj[1] - pi[1], gn_pick(w.space, pj[2] - pi[2], gn_set(0.0))};
    gn_v3 start = gn_load3(list->branch_f + c, list->soa.capacity, w.space);
    gn_v3 d = gn_add(start, u, w.space);
    gn_v grown = gn_dot(gn_add(start, d, w.space), u, w.space);
    gn_v free = pi[3] + pj[3], before = gn_load(list->stretch_f + c);
    if (w.bonds) free = gn_load(list->length0_f + c);
    *distance = gn_sqrt(gn_dot(d, d, w.space));
    *stretch = before + grown / gn_max(*distance + (free + before), gn_set(GN_TINY));
    return d;
}
#else
GN_INLINE gn_v3 branch(const gn_contact_args *a, size_t c, const gn_v pi[4], const gn_v pj[4],
                       gn_v *distance, gn_v *stretch, variant w) {
    gn_v3 d = {pj[0] - pi[0], pj[1] - pi[1], gn_pick(w.space, pj[2] - pi[2], gn_set(0.0))};
    if (w.periodic) d = nearest_image(d, a->period, a->inverse_period, w.space);
    gn_v free = pi[3] + pj[3];
    if (w.bonds) free = gn_load(a->contacts->length0 + c);
    *distance = gn_sqrt(gn_dot(d, d, w.space));
    *stretch = *distance - free;
    return d;
}
#endif

GN_INLINE void find_branch(const gn_contact_args *a, size_t c, stage *g, variant w) {
    const int32_t *i = a->contacts->i + c, *j = a->contacts->j + c;
    gn_v pi[4], pj[4];
    gn_rows4(COLUMN(a, pos), i, pi);
    gn_rows4(COLUMN(a, pos), j, pj);
    pair_geometry *s = &g->geometry;
    s->n = branch(a, c, pi, pj, &s->distance, &s->stretch, w);
    s->arm_i = pi[3];
    s->arm_j = pj[3];
}

GN_INLINE void find_normal(const gn_contact_args *a, stage *g, variant w) {
    pair_geometry *s = &g->geometry;
    gn_v distance = s->distance;
    /* Coincident centres have no direction: the tiny floor gives a zero normal and no force. */
    gn_v inverse = gn_set(1.0) / gn_max(distance, gn_set(GN_TINY));
    s->n = gn_scale(inverse, s->n, w.space);
    /* Of centres that (nearly) coincide there is no telling which way the normal goes. */
    gn_m apart = gn_less(gn_set(0.05) * (s->arm_i + s->arm_j), distance);
    g->rate = gn_keep(apart, gn_set(0.5 * a->dt) * inverse);
    if (w.shear && w.rotation) {
        gn_v half = gn_set(a->arm_factor) * (distance - (s->arm_i + s->arm_j));
        s->arm_i = s->arm_i + half;
        s->arm_j = s->arm_j + half;
    }
}

/* Square of the velocity across the normal. */
GN_INLINE gn_v across2_of(gn_v3 v, gn_v speed, int space) {
    return gn_max(gn_fnma(speed, speed, gn_dot(v, v, space)), gn_set(0.0));
}

/* By how much the distance grew in the step. Before it was |d n - dt v|, with q = d - dt speed the
 * root of q^2 + dt^2 across^2: by dt speed - dt^2 across^2/(2 q) and less. */
GN_INLINE gn_v path_of(const gn_contact_args *a, gn_v3 v, gn_v speed, gn_v rate, int space) {
    return gn_set(a->dt) * gn_fnma(across2_of(v, speed, space), rate, speed);
}

/* Every pair with a dashpot books its path, so that it is found where the velocities are at hand.
 */
GN_INLINE int path_known(variant w) {
    return !w.bonds && w.damping;
}

GN_INLINE gn_v3 opening_velocity(const gn_contact_args *a, size_t c, variant w) {
    gn_v opening[4];
    gn_rows4_less(COLUMN(a, vel), a->contacts->j + c, a->contacts->i + c, opening);
    return (gn_v3){opening[0], opening[1], gn_pick(w.space, opening[2], gn_set(0.0))};
}

/* Velocities belong to the middle of the step that led here, so that what they do to the contact is
 * seen with the normal and the arms of the middle: a cluster that turns as a whole then strains no
 * contact, whatever the angle of a step. (The arms of the force stay at the end, so that force and
 * moment keep the angular momentum.) With arms to the middle of the gap a rigid rotation gives
 * exactly no relative velocity: those arms add up to the length of the middle branch. */
GN_INLINE void find_motion(const gn_contact_args *a, size_t c, stage *g, brief *out, variant w) {
    const int32_t *i = a->contacts->i + c, *j = a->contacts->j + c;
    const pair_geometry *p = &g->geometry;
    gn_v3 v = opening_velocity(a, c, w);
    gn_v speed = gn_dot(v, p->n, w.space), rate = g->rate;
    g->speed = speed;
    if (path_known(w)) g->path = path_of(a, v, speed, rate, w.space);
    if (!w.shear) return;
    gn_v3 middle = gn_middle(v, p->n, speed, rate, w.space);
    if (w.rotation) {
        gn_v wi[4], wj[4];
        gn_rows4(COLUMN(a, spin), i, wi);
        gn_rows4(COLUMN(a, spin), j, wj);
        gn_v back = gn_set(0.5 * a->dt * a->arm_factor) * speed;
        gn_v ai = p->arm_i - back, aj = p->arm_j - back;
        gn_v3 sum = {gn_set(0.0), gn_set(0.0), ai * wi[2] + aj * wj[2]};
        if (w.space) {
            sum.x = ai * wi[0] + aj * wj[0];
            sum.y = ai * wi[1] + aj * wj[1];
            gn_v3 spins = {wi[0] + wj[0], wi[1] + wj[1], wi[2] + wj[2]};
            g->angle = gn_set(a->dt) * (gn_set(0.5) * gn_dot(spins, middle, 1));
        }
        v = gn_less_spin_cross(v, sum, middle, w.space);
    }
    out->motion.middle = middle;
    out->motion.relative = gn_turn_with_normal(v, p->n, middle, w.space);
}

/* Elastic tangential force before any limit. The twist comes halfway through the increment: one
 * before or after it would let the two tangential directions drive each other. */
GN_INLINE gn_v3 shear_trial(const gn_contact_args *a, const pair_geometry *p, const pair_motion *s,
                            gn_v3 *turned, gn_v angle, gn_v kt, variant w) {
    gn_v3 t = gn_turn_with_normal(*turned, p->n, s->middle, w.space);
    *turned = t;
    if (!(w.space && w.rotation)) return gn_axpy(t, kt * gn_set(a->dt), s->relative, w.space);
    gn_v half = kt * gn_set(0.5 * a->dt);
    t = gn_turn_about_normal(gn_axpy(t, half, s->relative, 1), p->n, angle);
    return gn_axpy(t, half, s->relative, 1);
}

/* Rare: writes down which bonds broke and why. */
static __attribute__((noinline)) void record_breaks(const gn_contact_args *a, size_t c, size_t end,
                                                    unsigned tension, unsigned shear,
                                                    gn_contact_sums *sums) {
    const gn_contacts *k = a->contacts;
    for (size_t lane = 0; lane < GN_W && c + lane < end; lane++) {
        unsigned bit = 1u << lane;
        if (!((tension | shear) & bit)) continue;
        k->rn[c + lane] = -k->rn[c + lane];
#if GN_MIXED
        k->rn_f[c + lane] = -k->rn_f[c + lane];
#endif
        k->broken_time[c + lane] = a->time;
        k->cause[c + lane] = tension & bit ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR;
        sums->broken_tension += tension & bit ? 1 : 0;
        sums->broken_shear += tension & bit ? 0 : 1;
    }
}

GN_INLINE int row_width(variant w) {
    return gn_row_width(w.space, w.rotation);
}

GN_INLINE void write_rows(brief *g, gn_v3 force, gn_v3 moment, variant w) {
    gn_v zero = gn_set(0.0);
    if (w.space && w.rotation) {
        gn_v row[8] = {force.x, force.y, force.z, zero, moment.x, moment.y, moment.z, zero};
        gn_store_rows8(g->row, row);
    } else {
        gn_v row[4] = {force.x, force.y, gn_pick(w.space, force.z, moment.z), zero};
        gn_store_rows4(g->row, row);
    }
}

/* Lane sums, kept in registers over a block and folded in lane order at its end. */
typedef struct lane_sums {
    gn_v elastic_normal, elastic_shear, friction, damping, breaking;
    gn_v stress[9], force, carrying;
} lane_sums;

/* What a reading needs of each contact; only in steps that are measured. */
GN_INLINE void measure_contact(lane_sums *e, const pair_geometry *s, gn_v3 f, variant w) {
    gn_v3 l = gn_scale(s->distance, s->n, w.space);
    const gn_v from[3] = {f.x, f.y, f.z}, to[3] = {l.x, l.y, l.z};
    int dimension = w.space ? 3 : 2;
    for (int a = 0; a < dimension; a++)
        for (int b = 0; b < dimension; b++)
            e->stress[3 * a + b] = e->stress[3 * a + b] + from[a] * to[b];
    gn_v size = gn_sqrt(gn_dot(f, f, w.space));
    e->force = e->force + size;
    e->carrying = e->carrying + gn_keep(gn_less(gn_set(0.0), size), gn_set(1.0));
}

/* Forces of a contact before and after its limits. */
typedef struct contact_state {
    gn_v kn, kt, stretch, elastic, normal; /* elastic: k_n stretch; normal: what acts of it */
    gn_v beyond;                           /* the stretch and the rounding of positions */
    gn_v way;                              /* normal times this is twice the energy of the spring */
    gn_v share;                            /* of the dashpot's force */
    gn_v3 before, trial, t;                /* tangential: last step's, turned; unlimited; acting */
    gn_m touching, intact, breaking, slipping;
} contact_state;

/* Coulomb limit for whatever is not an intact bond; open contacts lose their force. Sizes are
 * compared by their squares, so that only a vector with a slipping contact pays for the root and
 * the division. */
GN_INLINE void limit_shear(const gn_contact_args *a, size_t c, gn_v total, contact_state *q,
                           variant w) {
    const gn_contacts *k = a->contacts;
    gn_v limit = gn_set(0.0);
    if (w.friction)
        limit = gn_keep(q->touching, gn_load(COLUMN(k, mu) + gn_column_at(c, a->uniform.mu)) *
                                         gn_max(gn_set(0.0) - total, gn_set(0.0)));
    gn_v size2 = gn_dot(q->trial, q->trial, w.space);
    q->slipping = gn_and(gn_not(q->intact), gn_less(limit * limit, size2));
    q->t = q->trial;
    if (gn_bits(q->slipping)) {
        gn_v factor = gn_where(q->slipping, limit / gn_sqrt(size2), gn_set(1.0));
        q->t = gn_scale(factor, q->trial, w.space);
    }
}

/* Which intact bonds reach their strength in this step; tension counts first. */
GN_INLINE void break_bonds(const gn_contact_args *a, size_t c, size_t end, contact_state *q,
                           gn_contact_sums *sums, variant w) {
    const gn_contacts *k = a->contacts;
    gn_v rn = gn_load(COLUMN(k, rn) + c);
    q->intact = gn_less(gn_set(0.0), rn);
    gn_m in_tension = gn_and(q->intact, gn_at_least(q->elastic, rn)), in_shear = gn_m_none();
    if (w.shear) {
        gn_v rt = gn_load(COLUMN(k, rt) + c);
        gn_m strong = gn_at_least(gn_dot(q->trial, q->trial, w.space), rt * rt);
        in_shear = gn_and(gn_and(q->intact, gn_not(in_tension)), strong);
    }
    q->breaking = gn_or(in_tension, in_shear);
    q->intact = gn_and(q->intact, gn_not(q->breaking));
    if (__builtin_expect(gn_bits(q->breaking) != 0, 0))
        record_breaks(a, c, end, gn_bits(in_tension), gn_bits(in_shear), sums);
}

/* Rare: energy that slipping and breaking contacts release. */
GN_INLINE void book_release(const stage *g, gn_v path, const contact_state *q, lane_sums *e,
                            variant w) {
    gn_v shear_part = gn_set(0.0), normal_part = gn_set(0.0);
    if (w.shear) {
        gn_v3 before = q->before;
        if (w.space && w.rotation) before = gn_turn_about_normal(before, g->geometry.n, g->angle);
        shear_part = gn_released3(before, q->t, q->trial, gn_max(q->kt, gn_set(GN_TINY)), w.space);
    }
    if (w.bonds) {
        gn_v old = q->kn * (q->stretch - path);
        normal_part = gn_released(old, q->normal, q->elastic, q->kn);
    }
    e->breaking = e->breaking + gn_keep(q->breaking, shear_part + normal_part);
    e->friction = e->friction + gn_keep(gn_and(q->slipping, gn_not(q->breaking)), shear_part);
}

/* In measured steps: energy stored in the springs. */
GN_INLINE void book_elastic(const contact_state *q, lane_sums *e, variant w) {
    gn_v half = gn_set(0.5);
    e->elastic_normal = e->elastic_normal + half * q->normal * q->way;
    if (w.shear)
        e->elastic_shear =
            e->elastic_shear + half * gn_dot(q->t, q->t, w.space) / gn_max(q->kt, gn_set(GN_TINY));
}

/* What a rare branch reads and gives, apart from the state of the vector: an address of that would
 * keep all of it out of registers. */
typedef struct crossing_state {
    gn_v kn, stretch, beyond, elastic;
    gn_m touching, loose, breaking;
} crossing_state;
typedef struct crossing {
    gn_v normal, share, way, elastic;
} crossing;

/* A contact that closed or opened within the step acted for a part of it only. Forces stand at the
 * ends of steps and count for half a step on either side; with g the gap before, u the overlap
 * after it closed by p = g + u, the spring's impulse is that of a force which begins at the share s
 * = u/p: k u (1 + s)/2, and the dashpot acted for 1/2 + s steps. Where it opened by p to the gap s
 * p, the full forces of the last instant, at the overlap (1 - s) p, were too much: taken back are
 * k (1 - s) p s/2 of the spring, and of the dashpot's step 1/2 - s. So the energy of a rebound is
 * off by some y^4/40 instead of y^2/4, y = w dt, w^2 = k (1/m_i + 1/m_j); with the factors 1 -+ y^2
 * s (1 - s)/4, from the trapezoidal sums of this and the next step of a pair that meets alone, by
 * y^8. (y^2 is taken as 1/2 at most: steps are to resolve a contact, and a particle that is held
 * counts with its own mass here.) The energy that is booked with the instant is what closes those
 * sums: half the force times the path. */
static __attribute__((noinline)) crossing cross(const gn_contact_args *a, size_t c, const stage *g,
                                                const crossing_state *q) {
    gn_v half = gn_set(0.5), one = gn_set(1.0), zero = gn_set(0.0), vi[4], vj[4];
    gn_rows4(COLUMN(a, vel), a->contacts->i + c, vi);
    gn_rows4(COLUMN(a, vel), a->contacts->j + c, vj);
    gn_v3 v = {vj[0] - vi[0], vj[1] - vi[1], vj[2] - vi[2]};
    gn_v side2 = gn_set(a->dt * a->dt) * across2_of(v, g->speed, 1);
    gn_v quarter_y2 = gn_set(0.25 * a->dt * a->dt) * q->kn * (vi[3] + vj[3]);
    quarter_y2 = zero - gn_max(zero - quarter_y2, gn_set(-0.125));
    /* Up to rounding the stretch that was found a step ago. */
    gn_v along = gn_set(a->dt) * g->speed, left = g->geometry.distance - along;
    gn_v past = gn_max(left + gn_sqrt(gn_fma(left, left, side2)), gn_set(GN_TINY));
    gn_v path = along - side2 / past, before = q->stretch - path;
    gn_m touched = gn_less(q->beyond, path);
    gn_m opening = gn_and(gn_and(q->loose, touched), gn_not(q->touching));
    gn_m closing = gn_and(gn_and(q->loose, q->touching), gn_not(touched));
    /* A bond that breaks in this step was a spring both ways until now, unless by no more than that
     * rounding: then it may as well never have been there. */
    gn_m never = gn_less(before, q->beyond - q->stretch);
    closing = gn_and(closing, gn_or(gn_not(q->breaking), never));
    gn_v s = gn_where(gn_or(closing, opening), q->stretch / path, zero);
    gn_v bend = quarter_y2 * s * (one - s), full = q->kn * q->stretch;
    gn_v in = half * full * (one + s) * (one - bend);
    gn_v out = gn_set(-0.5) * q->kn * before * s * (one + bend);
    gn_m acting = gn_not(gn_and(q->loose, gn_not(q->touching)));
    crossing r = {gn_keep(acting, full), gn_keep(acting, one), q->stretch, q->elastic};
    r.normal = gn_where(closing, in, gn_where(opening, out, r.normal));
    r.share = gn_where(closing, half + s, gn_where(opening, half - s, r.share));
    r.way = gn_where(closing, path, gn_where(opening, zero - path, r.way));
    r.elastic = gn_where(opening, r.normal, r.elastic); /* nothing is left to release */
    return r;
}

/* Rare: the path of those that are not bonded (any more); of an intact bond the first term is all
 * that anything asks for. In the plane the third component is 0. */
static __attribute__((noinline)) gn_v loose_path(const gn_contact_args *a, size_t c, const stage *g,
                                                 gn_m intact) {
    const variant space = {.space = 1};
    gn_v3 v = opening_velocity(a, c, space);
    return gn_where(intact, gn_set(a->dt) * g->speed, path_of(a, v, g->speed, g->rate, 1));
}

/* Those that may have closed or opened within the step, and maybe more: by the normal speed alone
 * and the most that any particle moves across a normal. Most contacts are far from either. */
GN_INLINE gn_m may_cross(const gn_contact_args *a, const stage *g, const contact_state *q) {
    gn_v along = gn_set(a->dt) * g->speed, before = q->beyond - along;
    gn_v rounding = gn_fma(gn_set(0x1p-20), gn_max(along, gn_set(0.0) - along),
                           gn_set(0x1p-47) * g->geometry.distance);
    double fastest = a->speed_most > 0.0 ? 2.0 * a->speed_most : (double)INFINITY;
    gn_v across = gn_fma(gn_set(2.02 * a->dt * fastest * fastest), g->rate, rounding);
    gn_m surely = gn_less(before, gn_set(0.0) - across), apart = gn_at_least(before, rounding);
    return gn_not(gn_or(gn_and(q->touching, surely), gn_and(gn_not(q->touching), apart)));
}

/* What acts along the normal but for the dashpot, of a contact whose path is known to much less
 * than the way across the normal takes from it, `slack`: what is nearer to a change is looked at.
 */
GN_INLINE void cross_if_near(const gn_contact_args *a, size_t c, const stage *g, gn_v path,
                             gn_m loose, contact_state *q) {
    gn_v slack = gn_set(a->dt) * g->speed - path, before = q->beyond - path;
    gn_m surely = gn_less(before, gn_set(0.0) - slack), perhaps = gn_less(before, slack);
    gn_m crosses = gn_or(gn_and(q->touching, gn_not(surely)), gn_and(perhaps, gn_not(q->touching)));
    if (__builtin_expect(gn_bits(gn_and(loose, crosses)) == 0, 1)) return;
    crossing_state state = {q->kn,       q->stretch, q->beyond,  q->elastic,
                            q->touching, loose,      q->breaking};
    crossing r = cross(a, c, g, &state);
    q->normal = r.normal;
    q->share = r.share;
    q->way = r.way;
    q->elastic = r.elastic;
}

/* What acts along the normal but for the dashpot, where not all are intact bonds; the path of the
 * step, as far as anything asks for it. */
GN_INLINE gn_v find_normal_force(const gn_contact_args *a, size_t c, const stage *g,
                                 contact_state *q, variant w) {
    gn_m loose = gn_not(q->intact), acting = gn_or(q->touching, q->intact);
    q->normal = gn_keep(acting, q->elastic);
    q->share = gn_keep(acting, gn_set(1.0));
    gn_v path = gn_pick(path_known(w), g->path, gn_set(a->dt) * g->speed);
    if (!w.damping) {
        gn_m asked = gn_or(gn_and(loose, may_cross(a, g, q)), q->breaking);
        if (__builtin_expect(gn_bits(asked) == 0, 1)) return path;
    }
    if (!path_known(w)) path = loose_path(a, c, g, q->intact);
    cross_if_near(a, c, g, path, loose, q);
    return path;
}

GN_INLINE gn_v damped(const gn_contact_args *a, size_t c, gn_v speed, gn_v path,
                      const contact_state *q, lane_sums *e, variant w) {
    const gn_contacts *k = a->contacts;
    gn_v viscous = q->share * gn_load(COLUMN(k, cn) + gn_column_at(c, a->uniform.cn)) * speed;
    if (w.energy) {
        gn_v half = gn_set(0.5) * (gn_load(COLUMN(k, fd) + c) + viscous);
        e->damping = e->damping + half * path;
        gn_store(COLUMN(k, fd) + c, viscous);
    }
    return q->normal + viscous;
}

GN_INLINE void find_trial(const gn_contact_args *a, size_t c, const brief *from, stage *g,
                          variant w) {
    const gn_contacts *list = a->contacts;
    if (!w.shear) return;
    gn_v kt = gn_load(COLUMN(list, kt) + gn_column_at(c, a->uniform.kt));
    g->before = gn_load3(COLUMN(list, shear) + c, list->soa.capacity, w.space);
    g->trial = shear_trial(a, &g->geometry, &from->motion, &g->before, g->angle, kt, w);
}

GN_INLINE void find_forces(const gn_contact_args *a, size_t c, size_t end, const stage *g,
                           brief *out, lane_sums *e, gn_contact_sums *sums, variant w) {
    const gn_contacts *list = a->contacts;
    const gn_v zero = gn_set(0.0), one = gn_set(1.0);
    const pair_geometry *p = &g->geometry;
    contact_state q = {.stretch = p->stretch, .way = p->stretch, .share = one};
    q.kn = gn_load(COLUMN(list, kn) + gn_column_at(c, a->uniform.kn));
    q.intact = q.breaking = q.slipping = gn_m_none();
    q.normal = q.elastic = q.kn * q.stretch;
    if (w.shear) {
        q.kt = gn_load(COLUMN(list, kt) + gn_column_at(c, a->uniform.kt));
        q.before = g->before;
        q.t = q.trial = g->trial;
    }
    if (w.bonds) break_bonds(a, c, end, &q, sums, w);
    gn_v path = gn_set(a->dt) * g->speed, total = q.normal;
    if (w.bonds && __builtin_expect(gn_bits(gn_not(q.intact)) == 0, 1)) {
        /* Bonds that hold have nothing to limit. */
        if (w.damping) total = damped(a, c, g->speed, path, &q, e, w);
    } else {
        /* An overlap within the rounding of the positions is none: whether contacts that begin at 0
         * have begun is then the same in the next step, from the stretch before that. */
        q.beyond = gn_fma(gn_set(0x1p-48), p->distance, q.stretch);
        q.touching = gn_less(q.beyond, zero);
        path = find_normal_force(a, c, g, &q, w);
        total = q.normal;
        if (w.damping) total = damped(a, c, g->speed, path, &q, e, w);
        if (w.shear) limit_shear(a, c, total, &q, w);
        if (w.energy && gn_bits(gn_or(q.slipping, q.breaking))) book_release(g, path, &q, e, w);
    }
    if (w.shear) gn_store3(COLUMN(list, shear) + c, list->soa.capacity, q.t, w.space);
    if (w.energy && a->measure) book_elastic(&q, e, w);

    gn_v3 force = gn_scale(total, p->n, w.space), moment = {zero, zero, zero};
    if (w.shear) {
        force = gn_axpy(q.t, total, p->n, w.space);
        if (w.rotation) moment = gn_cross(p->n, q.t, w.space);
    }
    if (a->measure) measure_contact(e, p, force, w);
    write_rows(out, force, moment, w);
}

/* Adds the rows of a vector, of contacts from c on. The force has opposite signs for the two
 * particles; the moment has the same sign, because arm and force both turn round. */
GN_INLINE void add_rows(const gn_contact_args *a, size_t c, size_t end, const stage *g,
                        const brief *from, gn_real *sums, variant w) {
    size_t width = (size_t)row_width(w), count = end - c < GN_W ? end - c : GN_W;
#if !GN_MIXED /* output looks at contacts in double */
    double *rows = gn_contacts_row(a->contacts);
    if (rows) memcpy(rows + width * c, from->row, width * count * sizeof *rows);
#endif
    if (!sums) return;
    const uint16_t *place = a->partials->place + 2 * c;
    const gn_real *arm_i = (const gn_real *)&g->geometry.arm_i;
    const gn_real *arm_j = (const gn_real *)&g->geometry.arm_j;
    for (size_t k = 0; k < count; k++) {
        const gn_real *row = from->row + width * k;
        gn_real *i = sums + place[2 * k], *j = sums + place[2 * k + 1];
        if (w.space && w.rotation)
            gn_add_row8(i, j, row, arm_i + k, arm_j + k, w.shear);
        else
            gn_add_row4(i, j, row, arm_i + k, arm_j + k, w.shear && w.rotation);
    }
}

/* The vector that entered `lag` turns ago, and whether there is one. */
#define AT(lag)        (&ring[(v - (lag)) % RING])
#define UNDER_WAY(lag) (v >= (lag) && v < vectors + (lag))

GN_INLINE void contact_core(const gn_contact_args *a, size_t begin, size_t end,
                            gn_contact_sums *sums, variant w) {
    const gn_v zero = gn_set(0.0);
    lane_sums e = {.elastic_normal = zero, .elastic_shear = zero, .friction = zero};
    e.damping = e.breaking = e.force = e.carrying = zero;
    for (int k = 0; k < 9; k++) e.stress[k] = zero;
    const gn_partials *q = a->partials;
    const size_t width = (size_t)row_width(w);
    gn_real *partial = NULL;
    if (q) partial = gn_clear_block_rows(q, begin, width * sizeof *partial, COLUMN(q, row));
    const gn_real *const read[3] = {COLUMN(a, pos), COLUMN(a, vel), COLUMN(a, spin)};
    gn_block_particles ahead = gn_block_particles_of(q, begin);
    stage ring[RING];
    brief motion[2], rows[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    for (size_t v = 0; v < vectors + STAGES - 1; v++) {
        const size_t c = begin + v * GN_W;
        gn_fetch_ahead(&ahead, read, 2 + (w.shear && w.rotation), (GN_W + 1) / 2);
        brief *even = &rows[v % 2], *odd = &rows[(v + 1) % 2];
        if (UNDER_WAY(5)) add_rows(a, c - 5 * GN_W, end, AT(5), odd, partial, w);
        if (UNDER_WAY(4)) find_forces(a, c - 4 * GN_W, end, AT(4), even, &e, sums, w);
        if (UNDER_WAY(1)) find_normal(a, AT(1), w);
        even = &motion[v % 2];
        odd = &motion[(v + 1) % 2];
        if (UNDER_WAY(3)) find_trial(a, c - 3 * GN_W, odd, AT(3), w);
        if (v < vectors) find_branch(a, c, AT(0), w);
        if (UNDER_WAY(2)) find_motion(a, c - 2 * GN_W, AT(2), even, w);
    }
    if (a->measure) {
        for (int k = 0; k < 9; k++) sums->stress[k] += gn_fold(e.stress[k]);
        sums->force += gn_fold(e.force);
        sums->carrying += gn_fold(e.carrying);
    }
    if (!w.energy) return;
    sums->elastic_normal += gn_fold(e.elastic_normal);
    sums->elastic_shear += gn_fold(e.elastic_shear);
    sums->friction += gn_fold(e.friction);
    sums->contact_damping += gn_fold(e.damping);
    sums->bond_breaking += gn_fold(e.breaking);
}

/* --- the variants
 * ---------------------------------------------------------------------------------- */

/* Not worth a kernel: friction without shear, or shear that neither friction nor bonds load. In
 * mixed precision the branch at the start knows the image: periodic boxes need no kernel. */
#define SENSELESS(v)                                                                               \
    ((GN_BIT(v, 3) && !GN_BIT(v, 2)) || (GN_BIT(v, 2) && !GN_BIT(v, 3) && !GN_BIT(v, 4)) ||        \
     (GN_MIXED && GN_BIT(v, 7)))

#define WRAPPER(v)                                                                                 \
    static void contact_##v(const gn_contact_args *a, size_t begin, size_t end,                    \
                            gn_contact_sums *sums) {                                               \
        if (SENSELESS(v)) return;                                                                  \
        contact_core(a, begin, end, sums,                                                          \
                     (variant){GN_BIT(v, 0), GN_BIT(v, 1), GN_BIT(v, 2), GN_BIT(v, 3),             \
                               GN_BIT(v, 4), GN_BIT(v, 5), GN_BIT(v, 6), GN_BIT(v, 7)});           \
    }
GN_EACH_256(WRAPPER)

#define ENTRY(v) SENSELESS(v) ? 0 : contact_##v,
gn_contact_kernel *const GN_TABLE(contact)[GN_CONTACT_VARIANTS] = {GN_EACH_256(ENTRY)};
