/* The contact kernel: one body, compiled once per instruction set (GN_SIMD, GN_TABLE set by the
 * build) and expanded per kind of list, space and spins with literal arguments, so that absent
 * features of a kind generate no code. Damping, energies and periods are branches: all contacts of
 * a list take the same one, and separate kernels would be eight times as much to compile.
 *
 * Per contact: geometry and motion from the rows of the two particles, forces by the law
 * (law_<name>.h). Output: the block's partial sums of force and moment per particle, which
 * motion_template.c adds up. */
#include "kernels/block_rows.h"
#include "kernels/expand.h"
#define GN_LAW_FORCES
#include "kernels/laws.h"

#include <string.h>

#if !GN_MIXED
GN_INLINE gn_v3 nearest_image(gn_v3 d, const double *period, const double *inverse, int space) {
    gn_v3 r = d;
    r.x = gn_fnma(gn_set(period[0]), gn_round(d.x * gn_set(inverse[0])), d.x);
    r.y = gn_fnma(gn_set(period[1]), gn_round(d.y * gn_set(inverse[1])), d.y);
    if (space) r.z = gn_fnma(gn_set(period[2]), gn_round(d.z * gn_set(inverse[2])), d.z);
    return r;
}
#endif

/* Computes the branch from i to j, its length, and the stretch. Sums over the two ends are written
 * symmetrically, so that exchanging i and j mirrors every bit. */
#if GN_MIXED
/* Single precision resolves neither positions nor the difference of two lengths. Both are computed
 * from the branch D and the stretch s of the instant when the lists were built (in double) and from
 * the displacement u since then: |D + u|^2 - |D|^2 = (2 D + u).u has the relative precision of
 * u. */
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
GN_INLINE gn_v3 branch(const gn_contact_args *args, size_t c, const gn_v pi[4], const gn_v pj[4],
                       gn_v *distance, gn_v *stretch, variant with) {
    gn_v3 d = {pj[0] - pi[0], pj[1] - pi[1], gn_pick(with.space, pj[2] - pi[2], gn_set(0.0))};
    if (with.periodic) d = nearest_image(d, args->period, args->inverse_period, with.space);
    gn_v free = pi[3] + pj[3];
    if (with.bonds) free = gn_load(args->contacts->length0 + c);
    *distance = gn_sqrt(gn_dot(d, d, with.space));
    *stretch = *distance - free;
    return d;
}
#endif

GN_INLINE void find_branch(const gn_contact_args *args, size_t c, stage *vector, variant with) {
    const int32_t *i = args->contacts->i + c, *j = args->contacts->j + c;
    gn_v pi[4], pj[4];
    gn_rows4(COLUMN(args, pos), i, pi);
    gn_rows4(COLUMN(args, pos), j, pj);
    pair_geometry *s = &vector->geometry;
    s->n = branch(args, c, pi, pj, &s->distance, &s->stretch, with);
    s->arm_i = pi[3];
    s->arm_j = pj[3];
}

GN_INLINE void find_normal(const gn_contact_args *args, stage *vector, variant with) {
    pair_geometry *s = &vector->geometry;
    gn_v distance = s->distance;
    /* Coincident centres have no direction: GN_TINY gives a zero normal and no force. */
    gn_v inverse = gn_set(1.0) / gn_max(distance, gn_set(GN_TINY));
    s->n = gn_scale(inverse, s->n, with.space);
    /* Where centres nearly coincide, the direction of the normal is undefined. */
    gn_m apart = gn_less(gn_set(0.05) * (s->arm_i + s->arm_j), distance);
    vector->rate = gn_keep(apart, gn_set(0.5 * args->dt) * inverse);
    if (with.shear && with.rotation) {
        gn_v half = gn_set(args->arm_factor) * (distance - (s->arm_i + s->arm_j));
        s->arm_i = s->arm_i + half;
        s->arm_j = s->arm_j + half;
    }
}

/* Velocities belong to the middle of the step that led here, so that they are evaluated with the
 * normal and the arms of the middle: in rigid rotation of a cluster, contacts are then not
 * strained, for any angle of a step. (The arms of the force are those of the end of the step, so
 * that force and moment preserve the angular momentum.) Arms to the middle of the gap add up to the
 * length of the middle branch, so that a rigid rotation gives exactly no relative velocity. */
GN_INLINE void find_motion(const gn_contact_args *args, size_t c, stage *vector, brief *out,
                           variant with) {
    const int32_t *i = args->contacts->i + c, *j = args->contacts->j + c;
    const pair_geometry *p = &vector->geometry;
    gn_v3 v = opening_velocity(args, c, p, with);
    gn_v speed = gn_dot(v, p->n, with.space), rate = vector->rate;
    vector->speed = speed;
    if (growth_known(with)) vector->growth = growth_of(v, speed, rate, with.space);
    if (!with.shear) return;
    gn_v3 middle = gn_middle(v, p->n, speed, rate, with.space);
    if (with.rotation) {
        gn_v wi[4], wj[4];
        gn_rows4(COLUMN(args, spin), i, wi);
        gn_rows4(COLUMN(args, spin), j, wj);
        gn_v back = gn_set(0.5 * args->dt * args->arm_factor) * speed;
        gn_v ai = p->arm_i - back, aj = p->arm_j - back;
        gn_v3 sum = {gn_set(0.0), gn_set(0.0), ai * wi[2] + aj * wj[2]};
        if (with.space) {
            sum.x = ai * wi[0] + aj * wj[0];
            sum.y = ai * wi[1] + aj * wj[1];
            gn_v3 spins = {wi[0] + wj[0], wi[1] + wj[1], wi[2] + wj[2]};
            vector->angle = gn_set(args->dt) * (gn_set(0.5) * gn_dot(spins, middle, 1));
        }
        v = gn_less_spin_cross(v, sum, middle, with.space);
    }
    out->motion.middle = middle;
    if (with.law == LAW_joint) { /* its normal is not that of the branch */
        out->motion.relative = v;
        return;
    }
    out->motion.relative = gn_turn_with_normal(v, p->n, middle, with.space);
}

GN_INLINE int row_width(variant with) {
    return gn_row_width(with.space, with.rotation);
}

GN_INLINE void write_rows(brief *to, gn_v3 force, gn_v3 moment, variant with) {
    gn_v zero = gn_set(0.0);
    if (with.space && with.rotation) {
        gn_v row[8] = {force.x, force.y, force.z, zero, moment.x, moment.y, moment.z, zero};
        gn_store_rows8(to->row, row);
    } else {
        gn_v row[4] = {force.x, force.y, gn_pick(with.space, force.z, moment.z), zero};
        gn_store_rows4(to->row, row);
    }
}

/* Adds a contact's contributions to readings; only in measured steps. */
GN_INLINE void measure_contact(lane_sums *sums, const pair_geometry *geometry, gn_v3 f,
                               variant with) {
    gn_v3 l = gn_scale(geometry->distance, geometry->n, with.space);
    const gn_v from[3] = {f.x, f.y, f.z}, to[3] = {l.x, l.y, l.z};
    int dimension = with.space ? 3 : 2;
    for (int a = 0; a < dimension; a++)
        for (int b = 0; b < dimension; b++)
            sums->stress[3 * a + b] = sums->stress[3 * a + b] + from[a] * to[b];
    gn_v size = gn_sqrt(gn_dot(f, f, with.space));
    sums->force = sums->force + size;
    sums->carrying = sums->carrying + gn_keep(gn_less(gn_set(0.0), size), gn_set(1.0));
}

/* Forces of a vector of contacts, for the sums of the structure. */
typedef struct structure_lanes {
    _Alignas(64) gn_real n[3][GN_W], normal[GN_W], shear[GN_W], limit[GN_W];
} structure_lanes;

/* Returns how many ends of a contact are in the box of the structure. */
static inline double ends_inside(const gn_contact_args *args, size_t at) {
    const gn_contacts *k = args->contacts;
    if (args->structure.whole) return 2.0;
    return (double)gn_in_structure(&args->structure, args->pos + 4 * (size_t)k->i[at]) +
           (double)gn_in_structure(&args->structure, args->pos + 4 * (size_t)k->j[at]);
}

/* Adds to the sums of the structure, contact by contact; in rows of the history only. A sliding
 * contact is at its limit up to rounding. */
static __attribute__((noinline, unused)) void add_structure(const gn_contact_args *args, size_t c,
                                                            size_t end, const structure_lanes *l,
                                                            gn_contact_sums *sums) {
    const gn_contacts *k = args->contacts;
    const size_t count = end - c < GN_W ? end - c : GN_W;
    double *f = sums->fabric, xx = f[0], xy = f[1], xz = f[2], yy = f[4], yz = f[5], zz = f[8];
    for (size_t lane = 0; lane < count; lane++) {
        const bool bond = k->cause && k->cause[c + lane] == GN_INTACT;
        if (!bond && !(l->normal[lane] != 0 || l->shear[lane] > 0)) continue;
        const double ends = ends_inside(args, c + lane), x = (double)l->n[0][lane],
                     y = (double)l->n[1][lane], z = (double)l->n[2][lane];
        sums->ends += ends;
        if (!bond) {
            sums->loose_ends += ends;
            if (l->shear[lane] > 0 && l->shear[lane] >= l->limit[lane] * (1 - 1e-6))
                sums->sliding_ends += ends;
        }
        xx += ends * x * x;
        xy += ends * x * y;
        xz += ends * x * z;
        yy += ends * y * y;
        yz += ends * y * z;
        zz += ends * z * z;
    }
    const double all[9] = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
    memcpy(f, all, sizeof all);
}

GN_INLINE void read_structure(const gn_contact_args *args, size_t c, size_t end, gn_v3 n,
                              const contact_force *f, gn_contact_sums *sums, variant with) {
    const gn_v zero = gn_set(0.0);
    structure_lanes l;
    gn_v shear = zero, limit = zero;
    if (with.shear) shear = gn_sqrt(gn_dot(f->shear, f->shear, with.space));
    if (with.friction)
        limit = gn_load(COLUMN(args->contacts, mu) + gn_column_at(c, args->uniform.mu)) *
                gn_max(f->beside - f->normal, zero);
    gn_store(l.n[0], n.x);
    gn_store(l.n[1], n.y);
    gn_store(l.n[2], gn_pick(with.space, n.z, zero));
    gn_store(l.normal, f->normal);
    gn_store(l.shear, shear);
    gn_store(l.limit, limit);
    add_structure(args, c, end, &l, sums);
}

GN_INLINE void law_trial(const gn_contact_args *args, size_t c, const brief *from, stage *vector,
                         variant with) {
#define X(name, ...)                                                                               \
    if (with.law == LAW_##name) name##_trial(args, c, from, vector, with);
    GN_LAWS(X)
#undef X
}

GN_INLINE contact_force law_force(const gn_contact_args *args, size_t c, size_t end,
                                  const stage *vector, lane_sums *lanes, gn_contact_sums *sums,
                                  variant with) {
#define X(name, ...)                                                                               \
    if (with.law == LAW_##name) return name##_force(args, c, end, vector, lanes, sums, with);
    GN_LAWS(X)
#undef X
    __builtin_unreachable();
}

GN_INLINE void find_forces(const gn_contact_args *args, size_t c, size_t end, const stage *vector,
                           brief *out, lane_sums *lanes, gn_contact_sums *sums, variant with) {
    const gn_v zero = gn_set(0.0);
    const pair_geometry *p = &vector->geometry;
    contact_force f = law_force(args, c, end, vector, lanes, sums, with);
    gn_v3 force = gn_scale(f.normal, p->n, with.space), moment = {zero, zero, zero};
    if (with.shear) {
        force = gn_axpy(f.shear, f.normal, p->n, with.space);
        if (with.rotation) moment = gn_cross(p->n, f.shear, with.space);
    }
    if (args->measure) measure_contact(lanes, p, force, with);
    if (__builtin_expect(args->structure.used, 0))
        read_structure(args, c, end, p->n, &f, sums, with);
    write_rows(out, force, moment, with);
}

GN_INLINE int rolls(contact_law law) {
    return law == LAW_rolling || law == LAW_hertz_rolling || law == LAW_cohesive_rolling;
}

/* Tells whether contacts also exert a couple: equal and opposite moments on both particles. */
GN_INLINE int exerts_couple(variant with) {
    return (with.law == LAW_beam || rolls(with.law)) && with.rotation;
}

/* Rows of the couples, as the law has stored them: x y z 0. */
typedef struct couple_rows {
    _Alignas(64) gn_real row[4 * GN_W];
} couple_rows;

GN_INLINE void write_couples(const gn_contact_args *args, size_t c, couple_rows *out,
                             variant with) {
    const gn_contacts *k = args->contacts;
    gn_v3 m = load_moment(args, rolls(with.law) ? COLUMN(k, roll) : COLUMN(k, moment), c, with);
    gn_v row[4] = {m.x, m.y, m.z, gn_set(0.0)};
    gn_store_rows4(out->row, row);
}

/* Adds contact k of a vector to its two rows of sums, which begin at place[0] and place[1]. Its
 * couple follows its force immediately, so that the contributions to a particle are added in the
 * same order for any width of vectors. Numbers 0 to 2 of a row are forces in space; in 2D the third
 * is the moment. */
GN_INLINE void add_row(const stage *vector, const brief *from, const couple_rows *couples, size_t k,
                       const uint16_t *place, gn_real *sums, variant with) {
    const size_t moment = with.space ? 4 : 0;
    const gn_real none = 0;
    const gn_real *arm_i = (const gn_real *)&vector->geometry.arm_i + k;
    const gn_real *arm_j = (const gn_real *)&vector->geometry.arm_j + k;
    const gn_real *row = from->row + (size_t)row_width(with) * k;
    if (with.space && with.rotation)
        gn_add_row8(sums + place[0], sums + place[1], row, arm_i, arm_j, with.shear);
    else
        gn_add_row4(sums + place[0], sums + place[1], row, arm_i, arm_j,
                    with.shear && with.rotation);
    if (exerts_couple(with))
        gn_add_row4(sums + place[0] + moment, sums + place[1] + moment, couples->row + 4 * k, &none,
                    &none, 0);
}

/* Adds the rows of a vector of contacts, from c on, and stores them if `rows` is given. The force
 * has opposite signs for the two particles; the moment has the same sign for both, because arm and
 * force are both reversed. */
GN_INLINE void add_rows(const gn_contact_args *args, size_t c, size_t end, const stage *vector,
                        const brief *from, const couple_rows *couples, gn_real *sums, gn_real *rows,
                        variant with) {
    const size_t count = end - c < GN_W ? end - c : GN_W, width = (size_t)row_width(with);
    if (__builtin_expect(rows != NULL, 0))
        memcpy(rows + width * c, from->row, width * count * sizeof *rows);
    if (!sums) return;
    const uint16_t *place = args->partials->place + 2 * c;
    if (__builtin_expect(count == GN_W, 1)) /* this saves a test per contact */
        for (size_t k = 0; k < GN_W; k++)
            add_row(vector, from, couples, k, place + 2 * k, sums, with);
    else
        for (size_t k = 0; k < count; k++)
            add_row(vector, from, couples, k, place + 2 * k, sums, with);
}

/* The vector that entered `lag` iterations ago, and whether it exists. */
#define AT(lag)        (&ring[(v - (lag)) % RING])
#define UNDER_WAY(lag) (v - (lag) < vectors) /* unsigned: wraps around below `lag` */

GN_INLINE void contact_core(const gn_contact_args *args, size_t begin, size_t end,
                            gn_contact_sums *sums, variant with) {
    const gn_v zero = gn_set(0.0);
    lane_sums e = {.elastic_normal = zero,
                   .elastic_shear = zero,
                   .elastic_bending = zero,
                   .force = zero,
                   .carrying = zero};
#define X(name, text) e.name = zero;
    GN_CONTACT_LOSSES(X)
#undef X
    for (int k = 0; k < 9; k++) e.stress[k] = zero;
    const gn_partials *q = args->partials;
    const size_t width = (size_t)row_width(with);
    gn_real *partial = NULL, *rows = NULL;
#if !GN_MIXED /* output evaluates contacts in double */
    rows = gn_contacts_row(args->contacts);
#endif
    if (q) partial = gn_clear_block_rows(q, begin, width * sizeof *partial, COLUMN(q, row));
    const gn_real *const read[3] = {COLUMN(args, pos), COLUMN(args, vel), COLUMN(args, spin)};
    gn_block_particles ahead = gn_block_particles_of(q, begin);
    stage ring[RING];
    brief motion[2], force[2];
    couple_rows couples[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    const int kinds = 2 + (with.shear && with.rotation), few = gn_fetch_rate(&ahead, vectors);
    for (int k = 0; k < 12; k++) gn_fetch_ahead(&ahead, read, kinds, few);
    for (size_t v = 0; v < vectors + STAGES - 1; v++) {
        const size_t c = begin + v * GN_W;
        gn_fetch_ahead(&ahead, read, kinds, few);
        brief *even = &force[v % 2], *odd = &force[(v + 1) % 2];
        if (UNDER_WAY(5))
            add_rows(args, c - 5 * GN_W, end, AT(5), odd, &couples[(v + 1) % 2], partial, rows,
                     with);
        if (UNDER_WAY(4)) find_forces(args, c - 4 * GN_W, end, AT(4), even, &e, sums, with);
        if (exerts_couple(with) && UNDER_WAY(4))
            write_couples(args, c - 4 * GN_W, &couples[v % 2], with);
        if (UNDER_WAY(1)) find_normal(args, AT(1), with);
        even = &motion[v % 2];
        odd = &motion[(v + 1) % 2];
        if (UNDER_WAY(3)) law_trial(args, c - 3 * GN_W, odd, AT(3), with);
        if (v < vectors) find_branch(args, c, AT(0), with);
        if (UNDER_WAY(2)) find_motion(args, c - 2 * GN_W, AT(2), even, with);
    }
    if (args->measure) {
        for (int k = 0; k < 9; k++) sums->stress[k] += gn_fold(e.stress[k]);
        sums->force += gn_fold(e.force);
        sums->carrying += gn_fold(e.carrying);
    }
    if (!with.energy) return;
    sums->elastic_normal += gn_fold(e.elastic_normal);
    sums->elastic_shear += gn_fold(e.elastic_shear);
    sums->elastic_bending += gn_fold(e.elastic_bending);
#define X(name, text) sums->name += gn_fold(e.name);
    GN_CONTACT_LOSSES(X)
#undef X
}

/* --- the variants --- */

#define X(bit, NAME) | (GN_BUILT(NAME) ? 0 : 1 << (bit))
enum { NOT_BUILT = 0 GN_CONTACT_OPTIONS(X) };
#undef X

/* In mixed precision the initial branch contains the period. Hertz's law applies to spheres only;
 * rolling requires rotation; volumes of liquid and joints need double precision. */
#define IS_COHESIVE(law) (LAW_##law == LAW_cohesive || LAW_##law == LAW_cohesive_rolling)
#define IS_HERTZ(law)    (LAW_##law == LAW_hertz || LAW_##law == LAW_hertz_rolling || IS_COHESIVE(law))
#define IS_ROLLED(law)                                                                             \
    (LAW_##law == LAW_rolling || LAW_##law == LAW_hertz_rolling ||                                 \
     LAW_##law == LAW_cohesive_rolling)
#define ABSENT(options, law, shear, friction, bonds)                                               \
    (((options)&NOT_BUILT) || (IS_HERTZ(law) && !GN_BIT(options, 0)) ||                            \
     (IS_ROLLED(law) && !GN_BIT(options, 1)) ||                                                    \
     (IS_COHESIVE(law) && (GN_MIXED || !GN_BUILT(COHESION))) ||                                    \
     (GN_MIXED && LAW_##law == LAW_joint) ||                                                       \
     (GN_MIXED && (!GN_BUILT(MIXED) || GN_BIT(options, 4))) || (shear && !GN_BUILT(SHEAR)) ||      \
     (friction && !GN_BUILT(FRICTION)) || (bonds && !GN_BUILT(BONDS)))

#ifndef GN_KERNEL /* for tools that read this file on its own */
#define GN_KERNEL(variant) gn_contact_##variant
#endif
#define DECLARE(options, name, body, law, shear, friction, bonds)                                  \
    gn_contact_kernel GN_KERNEL(name##_##options);
#define X(number, ...) GN_EACH_32(DECLARE, __VA_ARGS__)
GN_CONTACT_KINDS(X)
#undef X

/* The kinds that this part of the build compiles. */
#if GN_PART == 0
#define KINDS_OF_PART GN_CONTACT_KINDS_0
#elif GN_PART == 1
#define KINDS_OF_PART GN_CONTACT_KINDS_1
#elif GN_PART == 2
#define KINDS_OF_PART GN_CONTACT_KINDS_2
#else
#define KINDS_OF_PART GN_CONTACT_KINDS_3
#endif

/* All options of a kind share one body per dimension and rotation: damping, energies and periods
 * are branches that all vectors of a list take alike. Frictional kinds of bonds have no body of
 * their own either, because their friction is such a branch. */
enum { FRICTION_BIT = 5 };
#define BODY(number, name, body, law, shear, friction, bonds)                                      \
    static __attribute__((noinline, unused)) void name##_body_##number(                            \
        const gn_contact_args *a, size_t begin, size_t end, gn_contact_sums *sums,                 \
        unsigned options) {                                                                        \
        if (ABSENT(number, law, shear, friction, bonds) || (friction && bonds)) return;            \
        contact_core(a, begin, end, sums,                                                          \
                     (variant){LAW_##law, GN_BIT(number, 0), GN_BIT(number, 1), shear,             \
                               shear && bonds                                                      \
                                   ? GN_BUILT(FRICTION) && GN_BIT(options, FRICTION_BIT)           \
                                   : friction,                                                     \
                               bonds, GN_BUILT(CONTACT_DAMPING) && GN_BIT(options, 2),             \
                               GN_BUILT(ENERGY) && GN_BIT(options, 3),                             \
                               !GN_MIXED && GN_BUILT(PERIODIC) && GN_BIT(options, 4)});            \
    }
#define X(number, ...)                                                                             \
    BODY(0, __VA_ARGS__) BODY(1, __VA_ARGS__) BODY(2, __VA_ARGS__) BODY(3, __VA_ARGS__)
KINDS_OF_PART(X)
#undef X

#define WRAPPER(options, name, body, law, shear, friction, bonds)                                  \
    void GN_KERNEL(name##_##options)(const gn_contact_args *a, size_t begin, size_t end,           \
                                     gn_contact_sums *sums) {                                      \
        const unsigned all = (options) | (friction) << FRICTION_BIT;                               \
        if (((options)&3) == 0) body##_body_0(a, begin, end, sums, all);                           \
        if (((options)&3) == 1) body##_body_1(a, begin, end, sums, all);                           \
        if (((options)&3) == 2) body##_body_2(a, begin, end, sums, all);                           \
        if (((options)&3) == 3) body##_body_3(a, begin, end, sums, all);                           \
    }
#define X(number, ...) GN_EACH_32(WRAPPER, __VA_ARGS__)
KINDS_OF_PART(X)
#undef X

#if GN_PART == 0
#define ENTRY(options, name, body, law, shear, friction, bonds)                                    \
    ABSENT(options, law, shear, friction, bonds) ? 0 : GN_KERNEL(name##_##options),
#define X(number, ...) GN_EACH_32(ENTRY, __VA_ARGS__)
gn_contact_kernel *const GN_TABLE(contact)[GN_CONTACT_VARIANTS] = {GN_CONTACT_KINDS(X)};
#undef X
#endif
