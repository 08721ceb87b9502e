/* Adds up partial sums and integrates the motion by central differences (leap-frog) with variable
 * step. The partial sums of a block of particles are added up in the L1 cache, then the block is
 * integrated lane by lane. One body is expanded per variant and compiled per instruction set, as
 * contact_template.c. */
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

GN_INLINE int row_width(variant with) {
    return gn_row_width(with.space, with.rotation);
}

/* A row in a register. */
typedef double row4 __attribute__((vector_size(32), aligned(8)));
typedef double row8 __attribute__((vector_size(64), aligned(8)));
typedef float row4_f __attribute__((vector_size(16), aligned(4)));
typedef float row8_f __attribute__((vector_size(32), aligned(4)));

/* Sums are in double even if rows are not. */
GN_INLINE void add_row(const gn_partials *from, int64_t row, int single, double *to, variant with) {
    const bool wide = with.space && with.rotation;
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
                        variant with) {
    const int32_t *start = from->start + begin / GN_PARTICLE_BLOCK;
    for (int32_t k = start[0]; k < start[1]; k++) {
        gn_share s = from->share[k];
        add_row(from, s.row, single, load + row_width(with) * (s.particle - (int64_t)begin), with);
    }
}

GN_INLINE void add_shares(const gn_partials *from, size_t begin, double *load, variant with) {
    if (!from->blocks) return;
    if (GN_BUILT(MIXED) && from->row_f)
        add_rows(from, 1, begin, load, with);
    else
        add_rows(from, 0, begin, load, with);
}

GN_INLINE void add_walls(const gn_motion_args *args, size_t begin, size_t end, double *load,
                         variant with) {
    const gn_wall_contacts *walls = args->wall_contacts;
    for (int32_t c = args->wall_first[begin]; c < args->wall_first[end]; c++) {
        double *to = load + (size_t)row_width(with) * ((size_t)walls->i[c] - begin);
        const double *row = walls->row + 8 * (int64_t)c;
        if (with.space && with.rotation) { /* the fourth number of each half is zero */
            *(row8 *)to += *(const row8 *)row;
        } else if (with.space) {
            *(row4 *)to += *(const row4 *)row;
        } else {
            for (int k = 0; k < 2; k++) to[k] += row[k];
            if (with.rotation) to[2] += row[6];
        }
    }
}

GN_INLINE void gather_block(const gn_motion_args *args, size_t begin, size_t end, double *row,
                            variant with) {
    memset(row, 0, GN_PARTICLE_BLOCK * (size_t)row_width(with) * sizeof *row);
    for (int l = 0; l < args->lists; l++) add_shares(args->partials[l], begin, row, with);
    if (GN_BUILT(WALLS) && args->wall_contacts) add_walls(args, begin, end, row, with);
}

/* Loads consecutive rows of four as four columns. */
GN_INLINE void load_rows(const double *rows, size_t p, gn_v out[4]) {
    gn_rows4_every(rows + 4 * p, 1, out);
}

/* Returns forces or moments (`part` 0 or 1) of GN_W particles of a block, from its k-th on. */
GN_INLINE gn_v3 load_of(const double *sum, size_t k, int part, variant with) {
    gn_v r[4], zero = gn_set(0.0);
    if (with.space && with.rotation) {
        gn_rows4_every(sum + 8 * k + 4 * part, 2, r);
        return (gn_v3){r[0], r[1], r[2]};
    }
    load_rows(sum, k, r);
    if (part) return (gn_v3){zero, zero, r[2]};
    return (gn_v3){r[0], r[1], gn_pick(with.space, r[2], zero)};
}

/* --- integration --- */

/* Translation or rotation of GN_W particles. */
typedef struct motion {
    gn_v3 v, v_new; /* velocity (or spin) at the half steps before and after */
    gn_v3 f, d;     /* force (or moment) without background damping; background damping */
    gn_v inverse;   /* 1/m (inertia); 0 for removed particles */
} motion;

/* Returns the mass, kg; 0 for removed particles. It is computed only where it is needed, because it
 * takes a division. */
GN_INLINE gn_v mass_of(const motion *state) {
    return gn_keep(gn_less(gn_set(0.0), state->inverse), gn_set(1.0) / state->inverse);
}

GN_INLINE gn_v absolute(gn_v a) {
    return gn_max(a, gn_set(0.0) - a);
}

GN_INLINE gn_v opposing(double damping, gn_v f, gn_v v) {
    gn_v zero = gn_set(0.0), size = gn_set(damping) * absolute(f);
    return gn_where(gn_less(zero, v), zero - size, gn_keep(gn_less(v, zero), size));
}

/* Computes background damping and the new velocity. Viscous damping is evaluated at the middle of
 * the kick, -a m (v + v_new)/2, which is stable for any coefficient. Non-viscous damping vanishes
 * at rest. */
GN_INLINE void kick(const gn_motion_args *args, double damping, motion *state, double interval,
                    int space, variant with) {
    gn_v zero = gn_set(0.0), rate = gn_set(interval) * state->inverse;
    state->d = (gn_v3){zero, zero, zero};
    if (with.viscous) {
        double half = 0.5 * damping * interval;
        gn_v3 kept = gn_scale(gn_set(1.0 - half), state->v, space);
        state->v_new =
            gn_scale(gn_set(1.0 / (1.0 + half)), gn_axpy(kept, rate, state->f, space), space);
        state->d = gn_scale(gn_set(-0.5 * damping) * mass_of(state),
                            gn_add(state->v, state->v_new, space), space);
        return;
    }
    if (with.vector) {
        gn_v speed = gn_sqrt(gn_dot(state->v, state->v, space)),
             size = gn_sqrt(gn_dot(state->f, state->f, space));
        gn_v factor = gn_keep(gn_less(zero, speed), gn_set(-damping) * size / speed);
        state->d = gn_scale(factor, state->v, space);
    } else if (with.component) {
        gn_v3 v = gn_axpy(state->v, gn_set(args->damping_lead) * rate, state->f, space);
        state->d.x = opposing(damping, state->f.x, v.x);
        state->d.y = opposing(damping, state->f.y, v.y);
        if (space) state->d.z = opposing(damping, state->f.z, v.z);
    }
    state->v_new = gn_axpy(state->v, rate, gn_add(state->f, state->d, space), space);
}

GN_INLINE gn_v half_work(gn_v3 f, gn_v3 v, double dt, int space) {
    return gn_set(0.5 * dt) * gn_dot(f, v, space);
}

/* Returns the kinetic energy 1/2 m v(-) v(+); its sum with the elastic energy of a linear system is
 * exactly conserved. At the start v(-) is the velocity before a full kick. */
GN_INLINE gn_v kinetic(const gn_motion_args *args, const motion *state, int space) {
    gn_v3 before = state->v;
    if (!(args->dt_past > 0.0))
        before = gn_sub(gn_scale(gn_set(2.0), state->v, space), state->v_new, space);
    return gn_set(0.5) * mass_of(state) * gn_dot(before, state->v_new, space);
}

/* Lane sums over a block; FIRST has none, and works of prescribed components are added without
 * them. */
#define SUM_ADD(name)    gn_v name;
#define SUM_HALVES(name) gn_v name[2];
#define SUM_MOST(name)   gn_v name;
#define SUM_FIRST(name)
typedef struct lane_sums {
#define X(merge, name, unit, text) SUM_##merge(name)
    GN_MOTION_SUMS(X)
#undef X
} lane_sums;

/* Books the works of a force and of background damping in the halves before and after the instant.
 */
GN_INLINE void book_work(gn_v halves[2], const gn_motion_args *args, gn_v3 f, const motion *state) {
    halves[0] = halves[0] + half_work(f, state->v, args->dt_past, 1);
    halves[1] = halves[1] + half_work(f, state->v_new, args->dt, 1);
}
GN_INLINE void book_loss(gn_v halves[2], const gn_motion_args *args, const motion *state) {
    halves[0] = halves[0] - half_work(state->d, state->v, args->dt_past, 1);
    halves[1] = halves[1] - half_work(state->d, state->v_new, args->dt, 1);
}

/* --- prescribed particles, lane by lane --- */

/* Replaces the prescribed components (first: 0 for velocity, 3 for spin) of one particle and
 * records the loads that this requires. Prescribed components have no background damping. */
GN_INLINE void prescribe_lane(const gn_motion_args *args, int32_t slot, int first, double interval,
                              int lane, double inverse, double v[3][GN_W], double v_new[3][GN_W],
                              double f[3][GN_W], double d[3][GN_W], double work[2]) {
    gn_prescription *q = args->prescribed;
    const bool accelerates = inverse > 0.0 && args->dt_past > 0.0;
    for (int k = 0; k < 3; k++) {
        if (!(q->mask[slot] >> (first + k) & 1)) continue;
        const double before = v[k][lane], now = q->velocity[6 * slot + first + k];
        double inertia = 0.0;
        /* Most prescribed components keep their velocity. */
        if (accelerates && now != before) inertia = (now - before) / (interval * inverse);
        const double supplied = inertia - f[k][lane];
        d[k][lane] = 0.0;
        v_new[k][lane] = now;
        q->load[6 * slot + first + k] = supplied;
        work[0] += 0.5 * args->dt_past * supplied * before;
        work[1] += 0.5 * args->dt * supplied * now;
    }
}

/* Damps the free components against the velocity of the free components alone, because the reaction
 * of a prescribed component is no unbalanced force. */
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

/* Handles a vector with prescribed lanes. `vector`: coefficient of damping against the velocity, 0:
 * none. The motion is passed by value, since taking its address would force it into memory. */
static __attribute__((noinline)) motion prescribe(const gn_motion_args *args, size_t p, int first,
                                                  double vector, double interval, motion state,
                                                  gn_motion_sums *sums) {
    motion *q = &state;
    double v[3][GN_W], v_new[3][GN_W], f[3][GN_W], d[3][GN_W], inverse[GN_W];
    unpack(q->v, v);
    unpack(q->v_new, v_new);
    unpack(q->f, f);
    unpack(q->d, d);
    gn_store(inverse, q->inverse);
    double work[2] = {sums->prescribed[0], sums->prescribed[1]};
    for (int lane = 0; lane < GN_W && p + (size_t)lane < args->particles->soa.count; lane++) {
        int32_t slot = args->particles->slot[p + (size_t)lane];
        if (slot < 0) continue;
        const unsigned held = (unsigned)args->prescribed->mask[slot] >> first & 7;
        if (vector != 0.0 && held != 0 && held != 7)
            damp_free(vector, held, interval * inverse[lane], lane, v, v_new, f, d);
        prescribe_lane(args, slot, first, interval, lane, inverse[lane], v, v_new, f, d, work);
    }
    sums->prescribed[0] = work[0];
    sums->prescribed[1] = work[1];
    q->v_new = pack(v_new);
    q->d = pack(d);
    return state;
}

/* Returns the prescribed components of GN_W particles together, as bits of a mask, with the bit
 * DRIVEN if any component is prescribed. The AND of all slots is negative only if no particle has a
 * slot. */
enum { DRIVEN = 1 << 6 };
GN_INLINE unsigned prescribed_components(const gn_motion_args *args, size_t p) {
    const int32_t *slot = args->particles->slot + p;
    const size_t left = args->particles->soa.count - p;
    int32_t common = -1;
    if (__builtin_expect(left >= GN_W, 1))
        for (int lane = 0; lane < GN_W; lane++) common &= slot[lane];
    else
        for (size_t lane = 0; lane < left; lane++) common &= slot[lane];
    if (common < 0) return 0;
    unsigned held = DRIVEN;
    for (size_t lane = 0; lane < GN_W && lane < left; lane++)
        if (slot[lane] >= 0) held |= args->prescribed->mask[slot[lane]];
    return held;
}

/* Returns 1 for lanes whose resultant counts, which are those of free particles, else 0. */
static gn_v free_lanes(const gn_motion_args *args, size_t p, bool prescribed) {
    double lanes[GN_W];
    for (int lane = 0; lane < GN_W; lane++) {
        bool inside = p + (size_t)lane < args->particles->soa.count;
        bool driven = prescribed && inside && args->particles->slot[p + (size_t)lane] >= 0;
        lanes[lane] = driven ? 0.0 : 1.0;
    }
    return gn_load(lanes);
}

/* --- one group of lanes --- */

static void note_bad(const gn_motion_args *args, size_t p, unsigned bad, gn_motion_sums *sums) {
    for (int lane = 0; lane < GN_W && sums->bad < 0; lane++)
        if (bad >> lane & 1 && p + (size_t)lane < args->particles->soa.count)
            sums->bad = (int64_t)p + lane;
}

/* Rotates a quaternion by the spin over dt (first order in the angle, renormalised). */
static void turn_orientation(double q[4], const double spin[3], double dt) {
    double x = 0.5 * dt * spin[0], y = 0.5 * dt * spin[1], z = 0.5 * dt * spin[2];
    double r[4] = {q[0] - x * q[1] - y * q[2] - z * q[3], q[1] + x * q[0] + y * q[3] - z * q[2],
                   q[2] + y * q[0] + z * q[1] - x * q[3], q[3] + z * q[0] + x * q[2] - y * q[1]};
    double scale = 1.0 / sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int k = 0; k < 4; k++) q[k] = scale * r[k];
}

GN_INLINE void translate(const gn_motion_args *args, size_t p, const double *sum, size_t k,
                         unsigned held, lane_sums *sums, gn_motion_sums *total, variant with) {
    gn_particles *q = args->particles;
    double interval = 0.5 * (args->dt_past + args->dt);
    gn_v x[4], v[4];
    load_rows(q->pos, p, x);
    load_rows(q->vel, p, v);
    motion m = {.inverse = v[3], .v = {v[0], v[1], v[2]}, .f = load_of(sum, k, 0, with)};
    gn_v3 weight = {gn_set(0.0), gn_set(0.0), gn_set(0.0)}, applied = weight;
    if (with.gravity) {
        gn_v3 g = {gn_set(args->gravity[0]), gn_set(args->gravity[1]), gn_set(args->gravity[2])};
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
    kick(args, args->damping, &m, interval, 1, with);
    if (held & 7) m = prescribe(args, p, 0, with.vector ? args->damping : 0.0, interval, m, total);

    if (with.energy) {
        book_loss(sums->damping, args, &m);
        if (with.gravity) book_work(sums->gravity, args, weight, &m);
        if (pushed) book_work(sums->applied, args, applied, &m);
    }
    if (args->measure) {
        sums->kinetic = sums->kinetic + kinetic(args, &m, 1);
        sums->resultant =
            sums->resultant + free_lanes(args, p, held != 0) * gn_sqrt(gn_dot(m.f, m.f, 1));
    }
    gn_v speed2 = gn_dot(m.v_new, m.v_new, 1);
    sums->speed2 = gn_max(sums->speed2, speed2);
    if (args->changes) {
        gn_v3 change = gn_sub(m.v_new, m.v, 1);
        sums->change2 = gn_max(sums->change2, gn_dot(change, change, 1));
    }
    unsigned bad = gn_bits(gn_not(gn_less(speed2, gn_set(1e300))));
    if (__builtin_expect(bad != 0, 0)) note_bad(args, p, bad, total);
    gn_v velocity[4] = {m.v_new.x, m.v_new.y, m.v_new.z, v[3]}, dt = gn_set(args->dt);
    gn_v place[4] = {gn_fma(dt, m.v_new.x, x[0]), gn_fma(dt, m.v_new.y, x[1]),
                     gn_fma(dt, m.v_new.z, x[2]), x[3]};
    gn_store_rows4(q->vel + 4 * p, velocity);
    gn_store_rows4(q->pos + 4 * p, place);
    if (GN_BUILT(MIXED) && q->travel_f) {
        gn_v ref[4];
        load_rows(args->origin ? args->origin : q->ref, p, ref);
        gn_v travel[4] = {place[0] - ref[0], place[1] - ref[1], place[2] - ref[2], x[3]};
        gn_store_rows4_single(q->travel_f + 4 * p, travel);
        gn_store_rows4_single(q->vel_f + 4 * p, velocity);
    }
}

GN_INLINE void rotate(const gn_motion_args *args, size_t p, const double *sum, size_t k,
                      unsigned held, lane_sums *sums, gn_motion_sums *total, variant with) {
    gn_particles *q = args->particles;
    double interval = 0.5 * (args->dt_past + args->dt);
    gn_v o[4];
    load_rows(q->spin, p, o);
    motion m = {.inverse = o[3], .v = {o[0], o[1], o[2]}, .f = load_of(sum, k, 1, with)};
    m.v_new = m.v;
    kick(args, args->damping_spin, &m, interval, 1, with);
    if (held >> 3 & 7)
        m = prescribe(args, p, 3, with.vector ? args->damping_spin : 0.0, interval, m, total);
    if (with.energy) book_loss(sums->damping, args, &m);
    if (args->measure) {
        sums->rotational = sums->rotational + kinetic(args, &m, 1);
        sums->spin2 = gn_max(gn_dot(m.v_new, m.v_new, 1), sums->spin2);
    }
    gn_v spin[4] = {m.v_new.x, m.v_new.y, m.v_new.z, o[3]};
    gn_store_rows4(q->spin + 4 * p, spin);
    spin[3] = gn_set(0.0);
    if (GN_BUILT(MIXED) && q->spin_f) gn_store_rows4_single(q->spin_f + 4 * p, spin);
    if (!GN_BUILT(ORIENTATION) || !q->orientation) return;
    for (size_t lane = 0; lane < GN_W && p + lane < q->soa.count; lane++)
        turn_orientation(q->orientation + 4 * (p + lane), q->spin + 4 * (p + lane), args->dt);
}

GN_INLINE void motion_block(const gn_motion_args *args, size_t begin, size_t end, lane_sums *sums,
                            gn_motion_sums *total, variant with) {
    block_load own;
    const int32_t slot = args->hold ? args->hold->slot[begin / GN_PARTICLE_BLOCK] : -1;
    double *sum = slot < 0 ? own.row : args->hold->load + GN_BLOCK_LOAD * (int64_t)slot;
    if (slot < 0 || args->pass == GN_PASS_GATHER) gather_block(args, begin, end, sum, with);
    if (slot >= 0 && args->pass == GN_PASS_GATHER) return;
    for (size_t p = begin; p < end; p += GN_W) {
        unsigned held = 0;
        if (GN_BUILT(PRESCRIBED) && args->prescribed) held = prescribed_components(args, p);
        translate(args, p, sum, p - begin, held, sums, total, with);
        if (with.rotation) rotate(args, p, sum, p - begin, held, sums, total, with);
    }
}

GN_INLINE void motion_core(const gn_motion_args *args, size_t begin, size_t end,
                           gn_motion_sums *sums, variant with) {
    lane_sums e;
#define START_ADD(name)    e.name = gn_set(0.0);
#define START_HALVES(name) e.name[0] = e.name[1] = gn_set(0.0);
#define START_MOST(name)   e.name = gn_set(0.0);
#define START_FIRST(name)
#define X(merge, name, unit, text) START_##merge(name)
    GN_MOTION_SUMS(X)
#undef X
    for (size_t b = begin; b < end; b += GN_PARTICLE_BLOCK)
        motion_block(args, b, b + GN_PARTICLE_BLOCK < end ? b + GN_PARTICLE_BLOCK : end, &e, sums,
                     with);
#define FOLD_ADD(name) sums->name += gn_fold(e.name);
#define FOLD_HALVES(name)                                                                          \
    for (int h = 0; h < 2; h++) sums->name[h] += gn_fold(e.name[h]);
#define FOLD_MOST(name)                                                                            \
    gn_store(lane, e.name);                                                                        \
    for (int k = 0; k < GN_W; k++) sums->name = lane[k] > sums->name ? lane[k] : sums->name;
#define FOLD_FIRST(name)
    double lane[GN_W];
#define X(merge, name, unit, text) FOLD_##merge(name)
    GN_MOTION_SUMS(X)
#undef X
}

/* --- the variants --- */

#define X(bit, NAME) | (GN_BUILT(NAME) ? 0 : 1 << (bit))
enum { NOT_BUILT = 0 GN_MOTION_EFFECTS(X) };
#undef X

#define SENSELESS(v) (GN_BIT(v, 2) + GN_BIT(v, 3) + GN_BIT(v, 4) > 1 || ((v)&NOT_BUILT))

/* All variants of one dimension share two bodies, with and without rotation: damping, gravity and
 * energies are branches that all blocks take alike. */
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
