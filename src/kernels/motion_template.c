/* Gather and integrate: central differences (leap-frog) with variable step. The partial sums of a
 * block of particles are added up in the L1 cache, then the block is integrated lane by lane. One
 * body, expanded per variant and compiled per instruction set, as contact_template.c. */
#include "kernels/expand.h"
#include "kernels/motion.h"
#include "kernels/simd.h"

#include <math.h>
#include <string.h>

typedef struct variant {
    int space, rotation, viscous, vector, component, gravity, energy;
} variant;

/* --- gather --- */

/* Loads of a block of particles, in rows as those of gn_partials. */
typedef struct block_load {
    _Alignas(64) double row[GN_BLOCK_LOAD];
} block_load;

GN_INLINE int row_width(variant w) {
    return gn_row_width(w.space, w.rotation);
}

/* A row in a register. */
typedef double row4 __attribute__((vector_size(32), aligned(8)));
typedef double row8 __attribute__((vector_size(64), aligned(8)));
typedef float row4_f __attribute__((vector_size(16), aligned(4)));
typedef float row8_f __attribute__((vector_size(32), aligned(4)));

/* Sums are in double also when rows are not. */
GN_INLINE void add_row(const gn_partials *from, int64_t row, int single, double *to, variant w) {
    const bool wide = w.space && w.rotation;
    if (wide && single)
        *(row8 *)to += __builtin_convertvector(*(const row8_f *)(from->row_f + 8 * row), row8);
    else if (wide)
        *(row8 *)to += *(const row8 *)(from->row + 8 * row);
    else if (single)
        *(row4 *)to += __builtin_convertvector(*(const row4_f *)(from->row_f + 4 * row), row4);
    else
        *(row4 *)to += *(const row4 *)(from->row + 4 * row);
}

GN_INLINE void add_rows(const gn_partials *from, int single, size_t begin, double *load,
                        variant w) {
    const int32_t *start = from->start + begin / GN_PARTICLE_BLOCK;
    for (int32_t k = start[0]; k < start[1]; k++) {
        gn_share s = from->share[k];
        add_row(from, s.row, single, load + row_width(w) * (s.particle - (int64_t)begin), w);
    }
}

GN_INLINE void add_shares(const gn_partials *from, size_t begin, double *load, variant w) {
    if (!from->blocks) return;
    if (GN_BUILT(MIXED) && from->row_f)
        add_rows(from, 1, begin, load, w);
    else
        add_rows(from, 0, begin, load, w);
}

GN_INLINE void add_walls(const gn_motion_args *a, size_t begin, size_t end, double *load,
                         variant w) {
    const gn_wall_contacts *walls = a->wall_contacts;
    for (int32_t c = a->wall_first[begin]; c < a->wall_first[end]; c++) {
        double *to = load + (size_t)row_width(w) * ((size_t)walls->i[c] - begin);
        const double *row = walls->row + 8 * (int64_t)c;
        if (w.space && w.rotation) { /* what is fourth of four is nothing in both */
            *(row8 *)to += *(const row8 *)row;
        } else if (w.space) {
            *(row4 *)to += *(const row4 *)row;
        } else {
            for (int k = 0; k < 2; k++) to[k] += row[k];
            if (w.rotation) to[2] += row[6];
        }
    }
}

GN_INLINE void gather_block(const gn_motion_args *a, size_t begin, size_t end, double *row,
                            variant w) {
    memset(row, 0, GN_PARTICLE_BLOCK * (size_t)row_width(w) * sizeof *row);
    add_shares(a->bonds, begin, row, w);
    add_shares(a->pairs, begin, row, w);
    if (GN_BUILT(WALLS) && a->wall_contacts) add_walls(a, begin, end, row, w);
}

/* Consecutive rows of four as four columns. */
GN_INLINE void load_rows(const double *rows, size_t p, gn_v out[4]) {
    gn_rows4_every(rows + 4 * p, 1, out);
}

/* Forces or moments (`part` 0 or 1) of GN_W particles of a block, from its k-th on. */
GN_INLINE gn_v3 load_of(const double *sum, size_t k, int part, variant w) {
    gn_v r[4], zero = gn_set(0.0);
    if (w.space && w.rotation) {
        gn_rows4_every(sum + 8 * k + 4 * part, 2, r);
        return (gn_v3){r[0], r[1], r[2]};
    }
    load_rows(sum, k, r);
    if (part) return (gn_v3){zero, zero, r[2]};
    return (gn_v3){r[0], r[1], gn_pick(w.space, r[2], zero)};
}

/* --- integration --- */

/* Translation or rotation of GN_W particles. */
typedef struct motion {
    gn_v3 v, v_new; /* velocity (spin) at the half steps before and after */
    gn_v3 f, d;     /* force (moment) without background damping, and background damping */
    gn_v inverse;   /* 1/m (inertia); 0 for removed particles */
} motion;

/* m, 0 for removed particles; only where it is called for, as it takes a division. */
GN_INLINE gn_v mass_of(const motion *q) {
    return gn_keep(gn_less(gn_set(0.0), q->inverse), gn_set(1.0) / q->inverse);
}

GN_INLINE gn_v absolute(gn_v a) {
    return gn_max(a, gn_set(0.0) - a);
}

GN_INLINE gn_v opposing(double damping, gn_v f, gn_v v) {
    gn_v zero = gn_set(0.0), size = gn_set(damping) * absolute(f);
    return gn_where(gn_less(zero, v), zero - size, gn_keep(gn_less(v, zero), size));
}

/* Background damping and new velocity. Viscous damping is taken at the middle of the kick,
 * -a m (v + v_new)/2, which is stable for any coefficient. At rest the non-viscous kinds have
 * nothing to oppose. */
GN_INLINE void kick(const gn_motion_args *a, double damping, motion *q, double interval, int space,
                    variant w) {
    gn_v zero = gn_set(0.0), rate = gn_set(interval) * q->inverse;
    q->d = (gn_v3){zero, zero, zero};
    if (w.viscous) {
        double half = 0.5 * damping * interval;
        gn_v3 kept = gn_scale(gn_set(1.0 - half), q->v, space);
        q->v_new = gn_scale(gn_set(1.0 / (1.0 + half)), gn_axpy(kept, rate, q->f, space), space);
        q->d = gn_scale(gn_set(-0.5 * damping) * mass_of(q), gn_add(q->v, q->v_new, space), space);
        return;
    }
    if (w.vector) {
        gn_v speed = gn_sqrt(gn_dot(q->v, q->v, space)), size = gn_sqrt(gn_dot(q->f, q->f, space));
        gn_v factor = gn_keep(gn_less(zero, speed), gn_set(-damping) * size / speed);
        q->d = gn_scale(factor, q->v, space);
    } else if (w.component) {
        gn_v3 v = gn_axpy(q->v, gn_set(a->damping_lead) * rate, q->f, space);
        q->d.x = opposing(damping, q->f.x, v.x);
        q->d.y = opposing(damping, q->f.y, v.y);
        if (space) q->d.z = opposing(damping, q->f.z, v.z);
    }
    q->v_new = gn_axpy(q->v, rate, gn_add(q->f, q->d, space), space);
}

GN_INLINE gn_v half_work(gn_v3 f, gn_v3 v, double dt, int space) {
    return gn_set(0.5 * dt) * gn_dot(f, v, space);
}

/* Kinetic energy 1/2 m v(-) v(+), which is exactly conserved with the elastic energy of a linear
 * system; at the start v(-) is what a full kick would have come from. */
GN_INLINE gn_v kinetic(const gn_motion_args *a, const motion *q, int space) {
    gn_v3 before = q->v;
    if (!(a->dt_past > 0.0)) before = gn_sub(gn_scale(gn_set(2.0), q->v, space), q->v_new, space);
    return gn_set(0.5) * mass_of(q) * gn_dot(before, q->v_new, space);
}

/* Lane sums over a block. */
typedef struct lane_sums {
    gn_v kinetic, rotational, resultant, damping[2], gravity[2], applied[2], speed2, spin2, change2;
} lane_sums;

/* Work of a force, and what background damping takes, in the halves before and after the instant.
 */
GN_INLINE void book_work(gn_v halves[2], const gn_motion_args *a, gn_v3 f, const motion *q) {
    halves[0] = halves[0] + half_work(f, q->v, a->dt_past, 1);
    halves[1] = halves[1] + half_work(f, q->v_new, a->dt, 1);
}
GN_INLINE void book_loss(gn_v halves[2], const gn_motion_args *a, const motion *q) {
    halves[0] = halves[0] - half_work(q->d, q->v, a->dt_past, 1);
    halves[1] = halves[1] - half_work(q->d, q->v_new, a->dt, 1);
}

/* --- prescribed particles, lane by lane --- */

/* Overrides prescribed components (first: 0 for velocity, 3 for spin) of one particle and notes the
 * load it took. Nothing that is driven has background damping. */
GN_INLINE void prescribe_lane(const gn_motion_args *a, int32_t slot, int first, double interval,
                              int lane, double inverse, double v[3][GN_W], double v_new[3][GN_W],
                              double f[3][GN_W], double d[3][GN_W], double work[2]) {
    gn_prescription *q = a->prescribed;
    const bool accelerates = inverse > 0.0 && a->dt_past > 0.0;
    for (int k = 0; k < 3; k++) {
        if (!(q->mask[slot] >> (first + k) & 1)) continue;
        const double before = v[k][lane], now = q->velocity[6 * slot + first + k];
        double inertia = 0.0;
        /* Most keep their velocity. */
        if (accelerates && now != before) inertia = (now - before) / (interval * inverse);
        const double supplied = inertia - f[k][lane];
        d[k][lane] = 0.0;
        v_new[k][lane] = now;
        q->load[6 * slot + first + k] = supplied;
        work[0] += 0.5 * a->dt_past * supplied * before;
        work[1] += 0.5 * a->dt * supplied * now;
    }
}

/* Damping against the velocity sees what is free to move alone: the reaction of a component that is
 * driven is no force out of balance. */
static void damp_free(double damping, unsigned held, double rate, int lane, const double v[3][GN_W],
                      double v_new[3][GN_W], const double f[3][GN_W], double d[3][GN_W]) {
    double force2 = 0.0, speed2 = 0.0;
    for (int k = 0; k < 3; k++) {
        if (held >> k & 1) continue;
        force2 += f[k][lane] * f[k][lane];
        speed2 += v[k][lane] * v[k][lane];
    }
    const double factor = speed2 > 0.0 ? -damping * sqrt(force2) / sqrt(speed2) : 0.0;
    for (int k = 0; k < 3; k++) {
        if (held >> k & 1) continue;
        d[k][lane] = factor * v[k][lane];
        v_new[k][lane] = v[k][lane] + rate * (f[k][lane] + d[k][lane]);
    }
}

static void unpack(gn_v3 a, double out[3][GN_W]) {
    gn_store(out[0], a.x);
    gn_store(out[1], a.y);
    gn_store(out[2], a.z);
}

static gn_v3 pack(double in[3][GN_W]) {
    return (gn_v3){gn_load(in[0]), gn_load(in[1]), gn_load(in[2])};
}

/* Some of the lanes are prescribed. `vector`: coefficient of damping against the velocity, 0: none.
 * By value: a motion whose address is known has to live in memory. */
static __attribute__((noinline)) motion prescribe(const gn_motion_args *a, size_t p, int first,
                                                  double vector, double interval, motion m,
                                                  gn_motion_sums *s) {
    motion *q = &m;
    double v[3][GN_W], v_new[3][GN_W], f[3][GN_W], d[3][GN_W], inverse[GN_W];
    unpack(q->v, v);
    unpack(q->v_new, v_new);
    unpack(q->f, f);
    unpack(q->d, d);
    gn_store(inverse, q->inverse);
    double work[2] = {s->prescribed[0], s->prescribed[1]};
    for (int lane = 0; lane < GN_W && p + (size_t)lane < a->particles->soa.count; lane++) {
        int32_t slot = a->particles->slot[p + (size_t)lane];
        if (slot < 0) continue;
        const unsigned held = (unsigned)a->prescribed->mask[slot] >> first & 7;
        if (vector != 0.0 && held != 0 && held != 7)
            damp_free(vector, held, interval * inverse[lane], lane, v, v_new, f, d);
        prescribe_lane(a, slot, first, interval, lane, inverse[lane], v, v_new, f, d, work);
    }
    s->prescribed[0] = work[0];
    s->prescribed[1] = work[1];
    q->v_new = pack(v_new);
    q->d = pack(d);
    return m;
}

/* Only if all are negative so are all their common bits. */
GN_INLINE bool any_prescribed(const gn_motion_args *a, size_t p) {
    const int32_t *slot = a->particles->slot + p;
    const size_t left = a->particles->soa.count - p;
    int32_t common = -1;
    if (__builtin_expect(left >= GN_W, 1))
        for (int lane = 0; lane < GN_W; lane++) common &= slot[lane];
    else
        for (size_t lane = 0; lane < left; lane++) common &= slot[lane];
    return common >= 0;
}

/* 1 for lanes whose resultant counts (free particles), else 0. */
static gn_v free_lanes(const gn_motion_args *a, size_t p, bool prescribed) {
    double lanes[GN_W];
    for (int lane = 0; lane < GN_W; lane++) {
        bool inside = p + (size_t)lane < a->particles->soa.count;
        bool driven = prescribed && inside && a->particles->slot[p + (size_t)lane] >= 0;
        lanes[lane] = driven ? 0.0 : 1.0;
    }
    return gn_load(lanes);
}

/* --- one group of lanes --- */

static void note_bad(const gn_motion_args *a, size_t p, unsigned bad, gn_motion_sums *s) {
    for (int lane = 0; lane < GN_W && s->bad < 0; lane++)
        if (bad >> lane & 1 && p + (size_t)lane < a->particles->soa.count)
            s->bad = (int64_t)p + lane;
}

/* Turns a quaternion by the spin over dt (first order in the angle, renormalised). */
static void turn_orientation(double q[4], const double spin[3], double dt) {
    double x = 0.5 * dt * spin[0], y = 0.5 * dt * spin[1], z = 0.5 * dt * spin[2];
    double r[4] = {q[0] - x * q[1] - y * q[2] - z * q[3], q[1] + x * q[0] + y * q[3] - z * q[2],
                   q[2] + y * q[0] + z * q[1] - x * q[3], q[3] + z * q[0] + x * q[2] - y * q[1]};
    double scale = 1.0 / sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int k = 0; k < 4; k++) q[k] = scale * r[k];
}

GN_INLINE void translate(const gn_motion_args *a, size_t p, const double *sum, size_t k,
                         bool prescribed, lane_sums *e, gn_motion_sums *s, variant w) {
    gn_particles *q = a->particles;
    double interval = 0.5 * (a->dt_past + a->dt);
    gn_v x[4], v[4];
    load_rows(q->pos, p, x);
    load_rows(q->vel, p, v);
    motion m = {.inverse = v[3], .v = {v[0], v[1], v[2]}, .f = load_of(sum, k, 0, w)};
    gn_v3 weight = {gn_set(0.0), gn_set(0.0), gn_set(0.0)}, applied = weight;
    if (w.gravity) {
        gn_v3 g = {gn_set(a->gravity[0]), gn_set(a->gravity[1]), gn_set(a->gravity[2])};
        gn_v own = mass_of(&m);
        if (GN_BUILT(MASS_SCALING) && q->own_share) own = gn_load(q->own_share + p) * own;
        weight = gn_scale(own, g, 1);
        m.f = gn_add(m.f, weight, 1);
    }
    const bool pushed = GN_BUILT(APPLIED) && q->applied;
    if (pushed) {
        gn_v r[4];
        load_rows(q->applied, p, r);
        applied = (gn_v3){r[0], r[1], r[2]};
        m.f = gn_add(m.f, applied, 1);
    }
    m.v_new = m.v;
    kick(a, a->damping, &m, interval, 1, w);
    if (prescribed) m = prescribe(a, p, 0, w.vector ? a->damping : 0.0, interval, m, s);

    if (w.energy) {
        book_loss(e->damping, a, &m);
        if (w.gravity) book_work(e->gravity, a, weight, &m);
        if (pushed) book_work(e->applied, a, applied, &m);
    }
    if (a->measure) {
        e->kinetic = e->kinetic + kinetic(a, &m, 1);
        e->resultant = e->resultant + free_lanes(a, p, prescribed) * gn_sqrt(gn_dot(m.f, m.f, 1));
    }
    gn_v speed2 = gn_dot(m.v_new, m.v_new, 1);
    e->speed2 = gn_max(e->speed2, speed2);
    if (a->changes) {
        gn_v3 change = gn_sub(m.v_new, m.v, 1);
        e->change2 = gn_max(e->change2, gn_dot(change, change, 1));
    }
    unsigned bad = gn_bits(gn_not(gn_less(speed2, gn_set(1e300))));
    if (__builtin_expect(bad != 0, 0)) note_bad(a, p, bad, s);
    gn_v velocity[4] = {m.v_new.x, m.v_new.y, m.v_new.z, v[3]}, dt = gn_set(a->dt);
    gn_v place[4] = {gn_fma(dt, m.v_new.x, x[0]), gn_fma(dt, m.v_new.y, x[1]),
                     gn_fma(dt, m.v_new.z, x[2]), x[3]};
    gn_store_rows4(q->vel + 4 * p, velocity);
    gn_store_rows4(q->pos + 4 * p, place);
    if (GN_BUILT(MIXED) && q->travel_f) {
        gn_v ref[4];
        load_rows(a->origin ? a->origin : q->ref, p, ref);
        gn_v travel[4] = {place[0] - ref[0], place[1] - ref[1], place[2] - ref[2], x[3]};
        gn_store_rows4_single(q->travel_f + 4 * p, travel);
        gn_store_rows4_single(q->vel_f + 4 * p, velocity);
    }
}

GN_INLINE void rotate(const gn_motion_args *a, size_t p, const double *sum, size_t k,
                      bool prescribed, lane_sums *e, gn_motion_sums *s, variant w) {
    gn_particles *q = a->particles;
    double interval = 0.5 * (a->dt_past + a->dt);
    gn_v o[4];
    load_rows(q->spin, p, o);
    motion m = {.inverse = o[3], .v = {o[0], o[1], o[2]}, .f = load_of(sum, k, 1, w)};
    m.v_new = m.v;
    kick(a, a->damping_spin, &m, interval, 1, w);
    if (prescribed) m = prescribe(a, p, 3, w.vector ? a->damping_spin : 0.0, interval, m, s);
    if (w.energy) book_loss(e->damping, a, &m);
    if (a->measure) {
        e->rotational = e->rotational + kinetic(a, &m, 1);
        e->spin2 = gn_max(gn_dot(m.v_new, m.v_new, 1), e->spin2);
    }
    gn_v spin[4] = {m.v_new.x, m.v_new.y, m.v_new.z, o[3]};
    gn_store_rows4(q->spin + 4 * p, spin);
    spin[3] = gn_set(0.0);
    if (GN_BUILT(MIXED) && q->spin_f) gn_store_rows4_single(q->spin_f + 4 * p, spin);
    if (!GN_BUILT(ORIENTATION) || !q->orientation) return;
    for (size_t lane = 0; lane < GN_W && p + lane < q->soa.count; lane++)
        turn_orientation(q->orientation + 4 * (p + lane), q->spin + 4 * (p + lane), a->dt);
}

GN_INLINE void motion_block(const gn_motion_args *a, size_t begin, size_t end, lane_sums *e,
                            gn_motion_sums *s, variant w) {
    block_load own;
    const int32_t slot = a->hold ? a->hold->slot[begin / GN_PARTICLE_BLOCK] : -1;
    double *sum = slot < 0 ? own.row : a->hold->load + GN_BLOCK_LOAD * (int64_t)slot;
    if (slot < 0 || a->pass == GN_PASS_GATHER) gather_block(a, begin, end, sum, w);
    if (slot >= 0 && a->pass == GN_PASS_GATHER) return;
    for (size_t p = begin; p < end; p += GN_W) {
        bool prescribed = GN_BUILT(PRESCRIBED) && a->prescribed && any_prescribed(a, p);
        translate(a, p, sum, p - begin, prescribed, e, s, w);
        if (w.rotation) rotate(a, p, sum, p - begin, prescribed, e, s, w);
    }
}

GN_INLINE void motion_core(const gn_motion_args *a, size_t begin, size_t end, gn_motion_sums *s,
                           variant w) {
    gn_v zero = gn_set(0.0);
    lane_sums e = {zero, zero, zero, {zero, zero}, {zero, zero}, {zero, zero}, zero, zero, zero};
    for (size_t b = begin; b < end; b += GN_PARTICLE_BLOCK)
        motion_block(a, b, b + GN_PARTICLE_BLOCK < end ? b + GN_PARTICLE_BLOCK : end, &e, s, w);
    s->kinetic += gn_fold(e.kinetic);
    s->rotational += gn_fold(e.rotational);
    s->resultant += gn_fold(e.resultant);
    for (int h = 0; h < 2; h++) {
        s->damping[h] += gn_fold(e.damping[h]);
        s->gravity[h] += gn_fold(e.gravity[h]);
        s->applied[h] += gn_fold(e.applied[h]);
    }
    double speed2[GN_W], spin2[GN_W], change2[GN_W];
    gn_store(speed2, e.speed2);
    gn_store(spin2, e.spin2);
    gn_store(change2, e.change2);
    for (int k = 0; k < GN_W; k++) {
        s->speed2 = speed2[k] > s->speed2 ? speed2[k] : s->speed2;
        s->spin2 = spin2[k] > s->spin2 ? spin2[k] : s->spin2;
        s->change2 = change2[k] > s->change2 ? change2[k] : s->change2;
    }
}

/* --- the variants --- */

#define X(bit, NAME) | (GN_BUILT(NAME) ? 0 : 1 << (bit))
enum { NOT_BUILT = 0 GN_MOTION_EFFECTS(X) };
#undef X

#define SENSELESS(v) (GN_BIT(v, 2) + GN_BIT(v, 3) + GN_BIT(v, 4) > 1 || ((v)&NOT_BUILT))

/* One body serves all variants in one space, with spins or without: damping, gravity and energies
 * are branches that all blocks take alike. */
#define HAS(NAME, v, bit) (GN_BUILT(NAME) && GN_BIT(v, bit))
#define BODY(number)                                                                               \
    static __attribute__((noinline)) void motion_body_##number(                                    \
        const gn_motion_args *a, size_t begin, size_t end, gn_motion_sums *sums, unsigned v) {     \
        if ((number)&NOT_BUILT) return;                                                            \
        motion_core(a, begin, end, sums,                                                           \
                    (variant){GN_BIT(number, 0), GN_BIT(number, 1), HAS(VISCOUS, v, 2),            \
                              HAS(NONVISCOUS_VECTOR, v, 3), HAS(NONVISCOUS_COMPONENT, v, 4),       \
                              HAS(GRAVITY, v, 5), HAS(ENERGY, v, 6)});                             \
    }
#define EACH_BODY(X) X(0) X(1) X(2) X(3)
EACH_BODY(BODY)

#define WRAPPER(v)                                                                                 \
    static void motion_##v(const gn_motion_args *a, size_t begin, size_t end,                      \
                           gn_motion_sums *sums) {                                                 \
        if (((v)&3) == 0) motion_body_0(a, begin, end, sums, v);                                   \
        if (((v)&3) == 1) motion_body_1(a, begin, end, sums, v);                                   \
        if (((v)&3) == 2) motion_body_2(a, begin, end, sums, v);                                   \
        if (((v)&3) == 3) motion_body_3(a, begin, end, sums, v);                                   \
    }
GN_EACH_128(WRAPPER)

#define ENTRY(v) SENSELESS(v) ? 0 : motion_##v,
gn_motion_kernel *const GN_TABLE(motion)[GN_MOTION_VARIANTS] = {GN_EACH_128(ENTRY)};
