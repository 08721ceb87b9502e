/* Gather and integrate: central differences (leap-frog) with variable step, in one pass over particles.
 * One body, expanded per variant and compiled per instruction set, as contact_template.c. */
#include "kernels/contact.h"
#include "kernels/expand.h"
#include "kernels/motion.h"

#include <math.h>

#define GN_INLINE static inline __attribute__((always_inline))

typedef struct variant {
    int space, rotation, viscous, vector, component, gravity, energy;
} variant;

/* A row of four doubles in a register. */
typedef double row __attribute__((vector_size(32), aligned(8)));

typedef struct load {
    row force, moment; /* xyz in the first three; 2D: moment z */
} load;

/* Adds one contact: sign +1 for its first particle, -1 for its second; the moment has the same sign for
 * both because arm and force both turn round. */
GN_INLINE void add_contact(const double *rows, int64_t c, int second, double radius, load *sum, variant w) {
    int width = w.space && w.rotation ? 8 : 4;
    row r = *(const row *)(rows + width * c);
    if (w.space && w.rotation) {
        double arm = radius + r[3];
        row moment = *(const row *)(rows + width * c + 4);
        sum->moment += moment * (row){arm, arm, arm, arm};
    } else if (w.rotation) {
        sum->moment[2] += (radius + r[2]) * r[3];
    }
    if (second)
        sum->force -= r;
    else
        sum->force += r;
}

GN_INLINE void add_contacts(const gn_contacts *contacts, const gn_incidence *of, size_t p, double radius,
                            load *sum, variant w) {
    const double *rows = gn_contacts_row(contacts);
    for (int32_t c = of->first[p]; c < of->first[p + 1]; c++) add_contact(rows, c, 0, radius, sum, w);
    for (int32_t k = of->second_first[p]; k < of->second_first[p + 1]; k++)
        add_contact(rows, of->second[k], 1, radius, sum, w);
}

GN_INLINE load gather(const gn_motion_args *a, size_t p, variant w) {
    load sum = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    double radius = a->particles->pos[4 * p + 3];
    if (a->bonds->soa.count) add_contacts(a->bonds, a->bonds_of, p, radius, &sum, w);
    if (a->pairs->soa.count) add_contacts(a->pairs, a->pairs_of, p, radius, &sum, w);
    if (a->wall_contacts) {
        for (int32_t c = a->wall_first[p]; c < a->wall_first[p + 1]; c++) {
            const double *r = a->wall_contacts->row + 8 * (int64_t)c;
            sum.force += *(const row *)r;
            sum.moment += *(const row *)(r + 4);
        }
    }
    if (!w.space) sum.force[2] = 0.0; /* the slot held the half gap */
    return sum;
}



/* Background damping on a force (or moment) f for a velocity v of an item of mass m; into d. */
GN_INLINE void background(const gn_motion_args *a, const double f[3], const double v[3], double m,
                          const double *v_new, double d[3], variant w) {
    for (int k = 0; k < 3; k++) d[k] = 0.0;
    if (w.viscous) {
        for (int k = 0; k < 3; k++) d[k] = -a->damping * m * 0.5 * (v[k] + v_new[k]);
    } else if (w.vector) {
        double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (!(speed > 0.0)) return; /* at rest: nothing to oppose */
        double size = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
        double factor = -a->damping * size / speed;
        for (int k = 0; k < 3; k++) d[k] = factor * v[k];
    } else if (w.component) {
        for (int k = 0; k < 3; k++)
            d[k] = v[k] > 0.0 ? -a->damping * fabs(f[k]) : v[k] < 0.0 ? a->damping * fabs(f[k]) : 0.0;
    }
}

/* New velocity from force f, with damping; d gets the damping force. Viscous damping is taken at the
 * middle of the kick, -a m (v + v_new)/2, which is stable for any coefficient. */
GN_INLINE void kick(const gn_motion_args *a, const double f[3], const double v[3], double inverse_mass,
                    double interval, double v_new[3], double d[3], variant w) {
    double m = inverse_mass > 0.0 ? 1.0 / inverse_mass : 0.0;
    if (w.viscous) {
        double half = 0.5 * a->damping * interval;
        for (int k = 0; k < 3; k++)
            v_new[k] = (v[k] * (1.0 - half) + interval * inverse_mass * f[k]) / (1.0 + half);
        background(a, f, v, m, v_new, d, w);
        return;
    }
    background(a, f, v, m, v_new, d, w);
    for (int k = 0; k < 3; k++) v_new[k] = v[k] + interval * inverse_mass * (f[k] + d[k]);
}

GN_INLINE double half_work(const double f[3], const double v[3], double dt) {
    return 0.5 * dt * (f[0] * v[0] + f[1] * v[1] + f[2] * v[2]);
}

/* Overrides prescribed components (first: 0 for velocity, 3 for spin) and notes the load it took. */
GN_INLINE void prescribe(const gn_motion_args *a, int32_t slot, int first, const double f[3],
                         const double v[3], double inverse_mass, double interval, double v_new[3],
                         double d[3], gn_motion_sums *s) {
    gn_prescription *q = a->prescribed;
    double supplied[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        if (!(q->mask[slot] >> (first + k) & 1)) continue;
        d[k] = 0.0; /* no background damping on what is driven */
        v_new[k] = q->velocity[6 * slot + first + k];
        double inertia = inverse_mass > 0.0 && a->dt_past > 0.0
                             ? (v_new[k] - v[k]) / (interval * inverse_mass)
                             : 0.0;
        supplied[k] = inertia - f[k];
        q->load[6 * slot + first + k] = supplied[k];
    }
    s->prescribed[0] += half_work(supplied, v, a->dt_past);
    s->prescribed[1] += half_work(supplied, v_new, a->dt);
}

/* Turns a quaternion by the spin over dt (exponential map, renormalised). */
GN_INLINE void turn_orientation(double q[4], const double spin[3], double dt) {
    double x = 0.5 * dt * spin[0], y = 0.5 * dt * spin[1], z = 0.5 * dt * spin[2];
    double r[4] = {q[0] - x * q[1] - y * q[2] - z * q[3], q[1] + x * q[0] + y * q[3] - z * q[2],
                   q[2] + y * q[0] + z * q[1] - x * q[3], q[3] + z * q[0] + x * q[2] - y * q[1]};
    double scale = 1.0 / sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    for (int k = 0; k < 4; k++) q[k] = scale * r[k];
}

/* Velocity before the instant for the kinetic energy 1/2 m v(-) v(+), which is exactly conserved with the
 * elastic energy of a linear system; at the start v(-) is what a full kick would have come from. */
GN_INLINE double kinetic(const gn_motion_args *a, const double v[3], const double v_new[3], double mass) {
    double s = 0.0;
    for (int k = 0; k < 3; k++) {
        double before = a->dt_past > 0.0 ? v[k] : 2.0 * v[k] - v_new[k];
        s += before * v_new[k];
    }
    return 0.5 * mass * s;
}

GN_INLINE void move_particle(const gn_motion_args *a, size_t p, gn_motion_sums *s, variant w) {
    gn_particles *q = a->particles;
    double inverse_mass = q->vel[4 * p + 3];
    double interval = 0.5 * (a->dt_past + a->dt);
    load sum = gather(a, p, w);
    double v[3], v_new[3], f[3], d[3];
    for (int k = 0; k < 3; k++) {
        v[k] = q->vel[4 * p + k];
        f[k] = sum.force[k];
    }
    double mass = inverse_mass > 0.0 ? 1.0 / inverse_mass : 0.0;
    if (w.gravity)
        for (int k = 0; k < 3; k++) f[k] += mass * a->gravity[k];
    if (q->applied)
        for (int k = 0; k < 3; k++) f[k] += q->applied[4 * p + k];
    kick(a, f, v, inverse_mass, interval, v_new, d, w);
    int32_t slot = a->prescribed ? q->slot[p] : -1;
    if (slot >= 0) prescribe(a, slot, 0, f, v, inverse_mass, interval, v_new, d, s);

    if (w.energy) {
        s->damping[0] -= half_work(d, v, a->dt_past);
        s->damping[1] -= half_work(d, v_new, a->dt);
        if (w.gravity) {
            double weight[3] = {mass * a->gravity[0], mass * a->gravity[1], mass * a->gravity[2]};
            s->gravity[0] += half_work(weight, v, a->dt_past);
            s->gravity[1] += half_work(weight, v_new, a->dt);
        }
        if (q->applied) {
            s->applied[0] += half_work(q->applied + 4 * p, v, a->dt_past);
            s->applied[1] += half_work(q->applied + 4 * p, v_new, a->dt);
        }
    }
    if (a->measure) {
        s->kinetic += kinetic(a, v, v_new, mass);
        if (slot < 0) s->resultant += sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    }
    double speed2 = v_new[0] * v_new[0] + v_new[1] * v_new[1] + v_new[2] * v_new[2];
    if (speed2 > s->speed2) s->speed2 = speed2;
    if (!(speed2 < 1e300) && s->bad < 0) s->bad = (int64_t)p;
    for (int k = 0; k < 3; k++) {
        q->vel[4 * p + k] = v_new[k];
        q->pos[4 * p + k] += a->dt * v_new[k];
    }
    if (!w.rotation) return;

    double inverse_inertia = q->spin[4 * p + 3];
    double o[3], o_new[3], m[3], dm[3];
    for (int k = 0; k < 3; k++) {
        o[k] = q->spin[4 * p + k];
        m[k] = sum.moment[k];
    }
    kick(a, m, o, inverse_inertia, interval, o_new, dm, w);
    if (slot >= 0) prescribe(a, slot, 3, m, o, inverse_inertia, interval, o_new, dm, s);
    if (w.energy) {
        s->damping[0] -= half_work(dm, o, a->dt_past);
        s->damping[1] -= half_work(dm, o_new, a->dt);
    }
    if (a->measure)
        s->rotational += kinetic(a, o, o_new, inverse_inertia > 0.0 ? 1.0 / inverse_inertia : 0.0);
    for (int k = 0; k < 3; k++) q->spin[4 * p + k] = o_new[k];
    if (q->orientation) turn_orientation(q->orientation + 4 * p, o_new, a->dt);
}

GN_INLINE void motion_core(const gn_motion_args *a, size_t begin, size_t end, gn_motion_sums *sums,
                           variant w) {
    for (size_t p = begin; p < end; p++) move_particle(a, p, sums, w);
}

/* --- the variants ---------------------------------------------------------------------------------- */

#define SENSELESS(v) (GN_BIT(v, 2) + GN_BIT(v, 3) + GN_BIT(v, 4) > 1)

#define WRAPPER(v)                                                                                 \
    static void motion_##v(const gn_motion_args *a, size_t begin, size_t end,                      \
                           gn_motion_sums *sums) {                                                 \
        if (SENSELESS(v)) return;                                                                  \
        motion_core(a, begin, end, sums,                                                           \
                    (variant){GN_BIT(v, 0), GN_BIT(v, 1), GN_BIT(v, 2), GN_BIT(v, 3),              \
                              GN_BIT(v, 4), GN_BIT(v, 5), GN_BIT(v, 6)});                          \
    }
GN_EACH_128(WRAPPER)

#define ENTRY(v) SENSELESS(v) ? 0 : motion_##v,
gn_motion_kernel *const GN_TABLE(motion)[GN_MOTION_VARIANTS] = {GN_EACH_128(ENTRY)};
