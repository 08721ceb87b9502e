/* Contacts of particles with walls and surfaces, as the contact law sees them. What a contact is
 * like is for walls.c and surfaces.c to find out. */
#ifndef GN_SIM_TOUCH_H
#define GN_SIM_TOUCH_H

#include "base/vec3.h"
#include "kernels/law.h"
#include "scene/sides.h"
#include "sim/internal.h"

/* What the particle's material and that of a wall, body or finite elements, counted through, are to
 * each other. Nothing takes the address of what these return: it is made where it is used. */
static inline gn_hertz_pair gn_touch_hertz(const gn_world *w, size_t place, int32_t material) {
    if (!(w->effects & GN_FX_HERTZ)) return (gn_hertz_pair){0};
    return w->dem.hertz[(size_t)material * gn_scene_sides(&w->scene) + place];
}

/* Coefficients of rolling (`twisting` false) and twisting. */
static inline double gn_touch_rolling(const gn_world *w, size_t place, int32_t material,
                                      bool twisting) {
    if (!(w->effects & GN_FX_ROLLING)) return 0.0;
    gn_scene_surface s = gn_scene_surface_at(&w->scene, place);
    if (w->effects & GN_FX_HERTZ && *s.material && place + 1 < gn_scene_sides(&w->scene)) {
        gn_hertz_pair pair = gn_touch_hertz(w, place, material);
        return twisting ? pair.twisting : pair.rolling;
    }
    return twisting ? s.twisting : s.rolling;
}

static inline gn_touch_side gn_wall_side_of(const gn_world *w, size_t wall, int32_t material) {
    const gn_wall_def *def = &w->scene.walls[wall];
    return (gn_touch_side){.stiffness = def->stiffness,
                           .kratio = def->kratio,
                           .friction = def->friction,
                           .part = 1.0,
                           .hertz = gn_touch_hertz(w, wall, material),
                           .rolling = gn_touch_rolling(w, wall, material, false),
                           .twisting = gn_touch_rolling(w, wall, material, true)};
}

static inline gn_touch_side gn_wall_side(const gn_world *w, size_t wall, size_t particle) {
    gn_touch_side side = gn_wall_side_of(w, wall, w->dem.particles.material[particle]);
    side.radius = w->dem.particles.pos[4 * particle + 3];
    return side;
}

/* `part`: see gn_touch_side. */
static inline gn_touch_side gn_surface_side(const gn_world *w, const gn_surface *surface,
                                            size_t particle, double part) {
    size_t bodies = w->scene.body_count;
    size_t place = w->scene.wall_count + (surface->body >= 0 ? (size_t)surface->body : bodies);
    const int32_t material = w->dem.particles.material[particle];
    const double radius = w->dem.particles.pos[4 * particle + 3];
    gn_touch_side side = {.stiffness = surface->stiffness,
                          .kratio = surface->kratio,
                          .friction = surface->friction,
                          .part = part,
                          .radius = radius,
                          .hertz = gn_touch_hertz(w, place, material),
                          .rolling = gn_touch_rolling(w, place, material, false),
                          .twisting = gn_touch_rolling(w, place, material, true)};
    if (!gn_surface_patched(surface, radius)) return side;
    /* Facets of a patch add up across as well. */
    side.part = 1.0;
    side.stiffness *= part;
    side.hertz.modulus *= part;
    side.hertz.shear_modulus *= part;
    return side;
}

/* m: how far a particle may be pressed into a wall or surface before the lists are made again, from
 * the present overlap; by Hertz's law until the step is looked at again. */
static inline double gn_touch_reach(const gn_world *w, size_t particle, double overlap) {
    if (w->effects & GN_FX_HERTZ) return gn_pressed_touch(w, particle);
    return overlap + w->dem.verlet.skin;
}

/* Of the step that led here, of a particle. */
static inline gn_touch_step gn_touch_step_of(const gn_world *w) {
    return (gn_touch_step){.dt = w->dt_past,
                           .damping_fraction = w->dem.damping_fraction,
                           .damping = w->effects & GN_FX_CONTACT_DAMPING,
                           .space = w->effects & GN_FX_SPACE,
                           .spins = w->dem.particles.spin != NULL,
                           .pulls = !(w->effects & GN_FX_NO_PULL)};
}

/* See gn_law.touch. `row`: of the contact. */
static inline double gn_touch_force(const gn_world *w, const gn_touch_side *side, size_t row,
                                    gn_touch *touch, double *fd, double *shear, size_t stride,
                                    double t[3], gn_contact_sums *sums) {
    size_t particle = (size_t)w->boundary.contacts.i[row];
    const gn_touch_step step = gn_touch_step_of(w);
    if (gn_touch_crosses(touch, touch->speed * w->dt_past) && !(w->effects & GN_FX_HERTZ))
        touch->other = gn_other_acceleration(w, row, touch->n) +
                       gn_held_acceleration(w, side->part * side->stiffness, row, touch->n);
    if (w->effects & GN_FX_HERTZ) touch->most = gn_pressed_touch(w, particle);
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

/* What a row needs to know of the wall or surface that it is a contact with (touch.c). */
typedef struct gn_row_side {
    double n[3], v[3]; /* from the particle into it, 0: did not touch; its velocity, m/s */
    gn_touch_side law;
} gn_row_side;
gn_row_side gn_row_side_of(const gn_world *world, size_t row);
/* J by which contacts with walls and surfaces hold more by Hertz's law as it is now than by what
 * particles and sides were to each other before, as gn_touch_hertz counts them. */
double gn_touches_gain(const gn_world *world, const gn_hertz_pair *before);

#endif
