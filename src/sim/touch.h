/* Contacts of particles with walls and surfaces, as the contact law sees them. What a contact is
 * like is for walls.c and surfaces.c to find out. */
#ifndef GN_SIM_TOUCH_H
#define GN_SIM_TOUCH_H

#include "base/vec3.h"
#include "kernels/law.h"
#include "sim/internal.h"

static inline gn_touch_side gn_wall_side(const gn_wall_def *def) {
    return (gn_touch_side){def->stiffness, def->kratio, def->friction, 1.0};
}

/* `part`: see gn_touch_side. */
static inline gn_touch_side gn_surface_side(const gn_surface *surface, double part) {
    return (gn_touch_side){surface->stiffness, surface->kratio, surface->friction, part};
}

/* See gn_law.touch. `body`: that the surface belongs to, NULL: none. */
static inline double gn_touch_force(const gn_world *w, const gn_touch_side *side, size_t particle,
                                    const gn_rigid *body, gn_touch *touch, double *fd,
                                    double *shear, size_t stride, double t[3],
                                    gn_contact_sums *sums) {
    if (gn_touch_crosses(touch, touch->speed * w->dt_past))
        touch->other = gn_other_acceleration(w, particle, body, touch->n);
    gn_touch_step step = {w->dt_past, w->dem.damping_fraction, w->effects & GN_FX_CONTACT_DAMPING,
                          w->effects & GN_FX_SPACE, w->dem.particles.spin != NULL};
    return gn_law_of(w->effects)->touch(&step, side, touch, fd, shear, stride, t, sums);
}

/* The largest stiffness of such a contact; `overlap`: how far it can be pressed, m. */
static inline gn_law_spring gn_touch_spring(const gn_world *w, const gn_touch_side *side,
                                            double inverse_mass, double overlap) {
    gn_law_spring s =
        gn_law_of(w->effects)->touch_spring(side, inverse_mass, w->dem.damping_fraction, overlap);
    if (!(w->effects & GN_FX_WALL_SHEAR)) s.kt = 0.0;
    return s;
}

#endif
