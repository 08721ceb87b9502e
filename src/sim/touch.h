/* The contact law of particles with walls and surfaces: penalty spring, dashpot, Coulomb friction.
 * What a contact is like is for walls.c and surfaces.c to find out. */
#ifndef GN_SIM_TOUCH_H
#define GN_SIM_TOUCH_H

#include "base/vec3.h"
#include "sim/dashpot.h"
#include "sim/world.h"

#include <math.h>

typedef struct gn_touch_law {
    double stiffness, friction;
    double kt; /* N/m, tangential; 0: none */
} gn_touch_law;

/* A contact at one instant. Normal from the particle into the wall, as for a second particle. */
typedef struct gn_touch {
    double n[3];
    double gap;          /* m, negative while it presses */
    double rounding;     /* m, of the gap: an overlap within it is none */
    double speed;        /* m/s, of the wall against the particle along n */
    double relative[3];  /* m/s, the same across n, at the point of contact */
    double twist;        /* rad/s, sum of both spins about n */
    double inverse_mass; /* 1/kg, sum over both sides */
} gn_touch;

/* Coulomb friction with radial return; returns the dissipated energy. `shear` [3] columns of
 * `stride`: the force of the last step, across the normal of this one; then the new one. Turns of
 * the normal are the caller's: here the old force only follows the spins about the normal. */
static inline double gn_touch_friction(const gn_world *w, const gn_touch *s, double kt,
                                       double limit, double *shear, size_t stride, double t[3],
                                       double *elastic) {
    double old[3], trial[3], side[3], size2 = 0.0;
    for (int a = 0; a < 3; a++) old[a] = shear[(size_t)a * stride];
    if ((w->particles.spin || s->twist != 0.0) && w->effects & GN_FX_SPACE) {
        double angle = 0.5 * w->dt_past * s->twist;
        gn_cross3(s->n, old, side);
        for (int a = 0; a < 3; a++) old[a] += angle * side[a] - 0.5 * angle * angle * old[a];
    }
    for (int a = 0; a < 3; a++) {
        trial[a] = old[a] + kt * w->dt_past * s->relative[a];
        size2 += trial[a] * trial[a];
    }
    double size = sqrt(size2), scale = size > limit ? limit / size : 1.0, lost = 0.0, now2 = 0.0;
    for (int a = 0; a < 3; a++) {
        t[a] = scale * trial[a];
        shear[(size_t)a * stride] = t[a];
        if (scale < 1.0) lost += 0.5 * (old[a] + t[a]) * (trial[a] - t[a]) / kt;
        now2 += t[a] * t[a];
    }
    *elastic += 0.5 * now2 / kt;
    return lost;
}

/* What acts along the normal but for the dashpot, and the dashpot's share of a step. */
typedef struct gn_touch_normal {
    double force, way, share; /* N; m: force times way is twice the energy; - */
} gn_touch_normal;

/* A contact that closed or opened within the step: see the kernel of particles
 * (kernels/contact_template.c, cross). */
static inline gn_touch_normal gn_touch_normal_of(double stiffness, const gn_touch *t, double path,
                                                 double dt) {
    double gap = t->gap, before = gap - path, s = gap / path;
    bool touching = gap < -t->rounding, touched = before < -t->rounding;
    if (touching && touched) return (gn_touch_normal){stiffness * gap, gap, 1.0};
    double bend = fmin(0.25 * dt * dt * stiffness * t->inverse_mass, 0.125) * s * (1.0 - s);
    if (touching)
        return (gn_touch_normal){0.5 * stiffness * gap * (1.0 + s) * (1.0 - bend), path, 0.5 + s};
    if (touched)
        return (gn_touch_normal){-0.5 * stiffness * before * s * (1.0 + bend), -path, 0.5 - s};
    return (gn_touch_normal){0.0, 0.0, 0.0};
}

/* Force on the particle: the returned value along n, and t across it. `fd` (may be NULL): viscous
 * force of the last step, then of this one; `shear` may be NULL. Energies go to *sums. */
static inline double gn_touch_force(const gn_world *w, const gn_touch_law *law, const gn_touch *s,
                                    double *fd, double *shear, size_t stride, double t[3],
                                    gn_contact_sums *sums) {
    bool touching = s->gap < -s->rounding;
    double path = s->speed * w->dt_past, elastic = 0.0;
    gn_touch_normal normal = gn_touch_normal_of(law->stiffness, s, path, w->dt_past);
    double total = normal.force;
    if (w->effects & GN_FX_CONTACT_DAMPING) {
        double viscous = 0.0;
        if (normal.share != 0.0)
            viscous = normal.share * s->speed *
                      gn_dashpot(law->stiffness, s->inverse_mass, w->damping_fraction, w->dt_past);
        if (fd) {
            sums->contact_damping += 0.5 * (*fd + viscous) * path;
            *fd = viscous;
        }
        total += viscous;
    }
    t[0] = t[1] = t[2] = 0.0;
    if (shear && law->kt > 0.0)
        sums->friction +=
            gn_touch_friction(w, s, law->kt, touching ? law->friction * fmax(-total, 0.0) : 0.0,
                              shear, stride, t, &elastic);
    sums->elastic_normal += 0.5 * normal.force * normal.way + elastic;
    return total;
}

#endif
