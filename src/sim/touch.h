/* The contact law of particles with walls and surfaces: the linear law of particles, one contact at
 * a time. What a contact is like is for walls.c and surfaces.c to find out. */
#ifndef GN_SIM_TOUCH_H
#define GN_SIM_TOUCH_H

#include "base/vec3.h"
#include "kernels/law_scalar.h"
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
    bool space = w->effects & GN_FX_SPACE,
         twists = space && (w->dem.particles.spin || s->twist != 0.0);
    double angle = 0.5 * w->dt_past * s->twist, lost = 0.0;
    gn_v3 old = {shear[0], shear[stride], shear[2 * stride]}, n = gn_v3_of(s->n);
    gn_v3 trial =
        gn_linear_shear(old, gn_v3_of(s->relative), kt, w->dt_past, n, angle, twists, space);
    gn_v3 now = trial;
    double size2 = gn_dot(trial, trial, 1);
    if (limit * limit < size2) {
        now = gn_linear_slip(trial, size2, limit, true, 1);
        lost = gn_released3(twists ? gn_turn_about_normal(old, n, angle) : old, now, trial, kt, 1);
    }
    t[0] = shear[0] = now.x;
    t[1] = shear[stride] = now.y;
    t[2] = shear[2 * stride] = now.z;
    *elastic += 0.5 * gn_dot(now, now, 1) / kt;
    return lost;
}

/* Whether it closed or opened within the step, when its gap grew by `path`. */
static inline bool gn_touch_crosses(const gn_touch *t, double path) {
    return (t->gap < -t->rounding) != (t->gap - path < -t->rounding);
}

/* What acts along the normal but for the dashpot, whose share of the step is given back too. A
 * plane's or facet's normal does not turn within a step: the path is all along it. */
static inline gn_linear_crossing gn_touch_normal(double stiffness, const gn_touch *t, double path,
                                                 double dt) {
    bool touching = t->gap < -t->rounding;
    if (!gn_touch_crosses(t, path))
        return touching ? (gn_linear_crossing){stiffness * t->gap, 1.0, t->gap}
                        : (gn_linear_crossing){0.0, 0.0, 0.0};
    double quarter_y2 = 0.25 * dt * dt * stiffness * t->inverse_mass;
    return gn_linear_cross(stiffness, t->gap, path, quarter_y2, touching, !touching, touching);
}

/* Force on the particle: the returned value along n, and t across it. `fd` (may be NULL): viscous
 * force of the last step, then of this one; `shear` may be NULL. Energies go to *sums. */
static inline double gn_touch_force(const gn_world *w, const gn_touch_law *law, const gn_touch *s,
                                    double *fd, double *shear, size_t stride, double t[3],
                                    gn_contact_sums *sums) {
    bool touching = s->gap < -s->rounding;
    double path = s->speed * w->dt_past, elastic = 0.0;
    gn_linear_crossing normal = gn_touch_normal(law->stiffness, s, path, w->dt_past);
    double total = normal.normal;
    if (w->effects & GN_FX_CONTACT_DAMPING) {
        double viscous = 0.0;
        if (normal.share != 0.0)
            viscous =
                normal.share * s->speed *
                gn_dashpot(law->stiffness, s->inverse_mass, w->dem.damping_fraction, w->dt_past);
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
    sums->elastic_normal += 0.5 * normal.normal * normal.way + elastic;
    return total;
}

#endif
