/* The contact kernel: one body, compiled once per instruction set (GN_SIMD, GN_TABLE set by the
 * build) and expanded per kind of list, space and spins with literal arguments, so that what a kind
 * does not have leaves no code. Damping, energies and periods are branches: all contacts of a list
 * take them alike, and kernels of their own would be eight times as much to compile.
 *
 * Per contact: geometry and motion from the rows of the two particles, forces by the law
 * (law_<name>.h). Output: the block's partial sums of force and moment per particle, which
 * motion_template.c adds up. */
#include "kernels/block_rows.h"
#include "kernels/expand.h"
#include "kernels/law_beam.h"
#include "kernels/law_hertz.h"
#include "kernels/law_linear.h"
#include "kernels/law_mohr.h"
#include "kernels/law_rolling.h"
#include "kernels/law_softening.h"

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

/* Velocities belong to the middle of the step that led here, so that what they do to the contact is
 * seen with the normal and the arms of the middle: a cluster that turns as a whole then strains no
 * contact, whatever the angle of a step. (The arms of the force stay at the end, so that force and
 * moment keep the angular momentum.) With arms to the middle of the gap a rigid rotation gives
 * exactly no relative velocity: those arms add up to the length of the middle branch. */
GN_INLINE void find_motion(const gn_contact_args *a, size_t c, stage *g, brief *out, variant w) {
    const int32_t *i = a->contacts->i + c, *j = a->contacts->j + c;
    const pair_geometry *p = &g->geometry;
    gn_v3 v = opening_velocity(a, c, p, w);
    gn_v speed = gn_dot(v, p->n, w.space), rate = g->rate;
    g->speed = speed;
    if (growth_known(w)) g->growth = growth_of(v, speed, rate, w.space);
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

GN_INLINE void law_trial(const gn_contact_args *a, size_t c, const brief *from, stage *g,
                         variant w) {
#define X(name, ...)                                                                               \
    if (w.law == LAW_##name) name##_trial(a, c, from, g, w);
    GN_LAWS(X)
#undef X
}

GN_INLINE contact_force law_force(const gn_contact_args *a, size_t c, size_t end, const stage *g,
                                  lane_sums *e, gn_contact_sums *sums, variant w) {
#define X(name, ...)                                                                               \
    if (w.law == LAW_##name) return name##_force(a, c, end, g, e, sums, w);
    GN_LAWS(X)
#undef X
    __builtin_unreachable();
}

GN_INLINE void find_forces(const gn_contact_args *a, size_t c, size_t end, const stage *g,
                           brief *out, lane_sums *e, gn_contact_sums *sums, variant w) {
    const gn_v zero = gn_set(0.0);
    const pair_geometry *p = &g->geometry;
    contact_force f = law_force(a, c, end, g, e, sums, w);
    gn_v3 force = gn_scale(f.normal, p->n, w.space), moment = {zero, zero, zero};
    if (w.shear) {
        force = gn_axpy(f.shear, f.normal, p->n, w.space);
        if (w.rotation) moment = gn_cross(p->n, f.shear, w.space);
    }
    if (a->measure) measure_contact(e, p, force, w);
    write_rows(out, force, moment, w);
}

GN_INLINE int rolls(contact_law law) {
    return law == LAW_rolling || law == LAW_hertz_rolling;
}

/* Whether contacts exert a couple besides: the same on both particles but for the sign. */
GN_INLINE int exerts_couple(variant w) {
    return (w.law == LAW_beam || rolls(w.law)) && w.rotation;
}

/* Rows of those couples, as the law has left them: x y z 0. */
typedef struct couple_rows {
    _Alignas(64) gn_real row[4 * GN_W];
} couple_rows;

GN_INLINE void write_couples(const gn_contact_args *a, size_t c, couple_rows *out, variant w) {
    const gn_contacts *k = a->contacts;
    gn_v3 m = load_moment(a, rolls(w.law) ? COLUMN(k, roll) : COLUMN(k, moment), c, w);
    gn_v row[4] = {m.x, m.y, m.z, gn_set(0.0)};
    gn_store_rows4(out->row, row);
}

/* Contact k of a vector, whose two rows of sums begin at place[0] and place[1]. Its couple comes
 * right after its force, so that what a particle gets is added in one order whatever the width of
 * vectors. Places 0 to 2 of a row are forces in space; in the plane the third is the moment. */
GN_INLINE void add_row(const stage *g, const brief *from, const couple_rows *couples, size_t k,
                       const uint16_t *place, gn_real *sums, variant w) {
    const size_t moment = w.space ? 4 : 0;
    const gn_real none = 0;
    const gn_real *arm_i = (const gn_real *)&g->geometry.arm_i + k;
    const gn_real *arm_j = (const gn_real *)&g->geometry.arm_j + k;
    const gn_real *row = from->row + (size_t)row_width(w) * k;
    if (w.space && w.rotation)
        gn_add_row8(sums + place[0], sums + place[1], row, arm_i, arm_j, w.shear);
    else
        gn_add_row4(sums + place[0], sums + place[1], row, arm_i, arm_j, w.shear && w.rotation);
    if (exerts_couple(w))
        gn_add_row4(sums + place[0] + moment, sums + place[1] + moment, couples->row + 4 * k, &none,
                    &none, 0);
}

/* Adds the rows of a vector, of contacts from c on, and keeps them if `rows` says where. The force
 * has opposite signs for the two particles; the moment has the same sign, because arm and force
 * both turn round. */
GN_INLINE void add_rows(const gn_contact_args *a, size_t c, size_t end, const stage *g,
                        const brief *from, const couple_rows *couples, gn_real *sums, gn_real *rows,
                        variant w) {
    const size_t count = end - c < GN_W ? end - c : GN_W, width = (size_t)row_width(w);
    if (__builtin_expect(rows != NULL, 0))
        memcpy(rows + width * c, from->row, width * count * sizeof *rows);
    if (!sums) return;
    const uint16_t *place = a->partials->place + 2 * c;
    if (__builtin_expect(count == GN_W, 1)) /* nothing to ask between contacts */
        for (size_t k = 0; k < GN_W; k++) add_row(g, from, couples, k, place + 2 * k, sums, w);
    else
        for (size_t k = 0; k < count; k++) add_row(g, from, couples, k, place + 2 * k, sums, w);
}

/* The vector that entered `lag` turns ago, and whether there is one. */
#define AT(lag)        (&ring[(v - (lag)) % RING])
#define UNDER_WAY(lag) (v - (lag) < vectors) /* below `lag` the difference wraps round */

GN_INLINE void contact_core(const gn_contact_args *a, size_t begin, size_t end,
                            gn_contact_sums *sums, variant w) {
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
    const gn_partials *q = a->partials;
    const size_t width = (size_t)row_width(w);
    gn_real *partial = NULL, *rows = NULL;
#if !GN_MIXED /* output looks at contacts in double */
    rows = gn_contacts_row(a->contacts);
#endif
    if (q) partial = gn_clear_block_rows(q, begin, width * sizeof *partial, COLUMN(q, row));
    const gn_real *const read[3] = {COLUMN(a, pos), COLUMN(a, vel), COLUMN(a, spin)};
    gn_block_particles ahead = gn_block_particles_of(q, begin);
    stage ring[RING];
    brief motion[2], force[2];
    couple_rows couples[2];
    const size_t vectors = (end - begin + GN_W - 1) / GN_W;
    const int kinds = 2 + (w.shear && w.rotation), few = gn_fetch_rate(&ahead, vectors);
    for (int k = 0; k < 12; k++) gn_fetch_ahead(&ahead, read, kinds, few);
    for (size_t v = 0; v < vectors + STAGES - 1; v++) {
        const size_t c = begin + v * GN_W;
        gn_fetch_ahead(&ahead, read, kinds, few);
        brief *even = &force[v % 2], *odd = &force[(v + 1) % 2];
        if (UNDER_WAY(5))
            add_rows(a, c - 5 * GN_W, end, AT(5), odd, &couples[(v + 1) % 2], partial, rows, w);
        if (UNDER_WAY(4)) find_forces(a, c - 4 * GN_W, end, AT(4), even, &e, sums, w);
        if (exerts_couple(w) && UNDER_WAY(4)) write_couples(a, c - 4 * GN_W, &couples[v % 2], w);
        if (UNDER_WAY(1)) find_normal(a, AT(1), w);
        even = &motion[v % 2];
        odd = &motion[(v + 1) % 2];
        if (UNDER_WAY(3)) law_trial(a, c - 3 * GN_W, odd, AT(3), w);
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
    sums->elastic_bending += gn_fold(e.elastic_bending);
#define X(name, text) sums->name += gn_fold(e.name);
    GN_CONTACT_LOSSES(X)
#undef X
}

/* --- the variants --- */

#define X(bit, NAME) | (GN_BUILT(NAME) ? 0 : 1 << (bit))
enum { NOT_BUILT = 0 GN_CONTACT_OPTIONS(X) };
#undef X

/* In mixed precision the branch at the start knows the period. Hertz's law is one of spheres; what
 * rolls turns. */
#define IS_HERTZ(law)  (LAW_##law == LAW_hertz || LAW_##law == LAW_hertz_rolling)
#define IS_ROLLED(law) (LAW_##law == LAW_rolling || LAW_##law == LAW_hertz_rolling)
#define ABSENT(options, law, shear, friction, bonds)                                               \
    (((options)&NOT_BUILT) || (IS_HERTZ(law) && !GN_BIT(options, 0)) ||                            \
     (IS_ROLLED(law) && !GN_BIT(options, 1)) ||                                                    \
     (GN_MIXED && (!GN_BUILT(MIXED) || GN_BIT(options, 4))) || (shear && !GN_BUILT(SHEAR)) ||      \
     (friction && !GN_BUILT(FRICTION)) || (bonds && !GN_BUILT(BONDS)))

#ifndef GN_KERNEL /* for what reads this file by itself */
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
#else
#define KINDS_OF_PART GN_CONTACT_KINDS_2
#endif

/* One body serves all options of a kind in one space, with spins or without: damping, energies and
 * periods are branches that all vectors of a list take alike. So is the friction of bonds, whose
 * frictional kinds have no body of their own. */
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
