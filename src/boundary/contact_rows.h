/* Contacts of particles with walls and surfaces, as the contact law sees them; walls.c and
 * surfaces.c find their geometry. */
#ifndef GN_BOUNDARY_CONTACT_ROWS_H
#define GN_BOUNDARY_CONTACT_ROWS_H

#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "particles/bridges.h"
#include "particles/expected_overlap.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/sides.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns the effective Hertz-Mindlin parameters of a particle's material and a wall, body or body
 * of elements, which are numbered consecutively. The functions of this header return values whose
 * address is never taken, so that compilers build them in place. */
static inline gn_hertz_pair gn_touch_hertz(const gn_step_context *ctx, const gn_dem *dem,
                                           size_t place, int32_t material) {
    if (!(ctx->effects & GN_FX_HERTZ)) return (gn_hertz_pair){0};
    return dem->hertz[(size_t)material * gn_scene_sides(&ctx->scene) + place];
}

/* Returns the coefficient of rolling, or of twisting if `twisting`. */
static inline double gn_touch_rolling(const gn_step_context *ctx, const gn_dem *dem, size_t place,
                                      int32_t material, bool twisting) {
    if (!(ctx->effects & GN_FX_ROLLING)) return 0.0;
    gn_scene_surface s = gn_scene_surface_at(&ctx->scene, place);
    if (ctx->effects & GN_FX_HERTZ && *s.material && place + 1 < gn_scene_sides(&ctx->scene)) {
        gn_hertz_pair pair = gn_touch_hertz(ctx, dem, place, material);
        return twisting ? pair.twisting : pair.rolling;
    }
    return twisting ? s.twisting : s.rolling;
}

static inline gn_touch_side gn_wall_side_of(const gn_step_context *ctx, const gn_dem *dem,
                                            size_t wall, int32_t material) {
    const gn_wall_def *def = &ctx->scene.walls[wall];
    return (gn_touch_side){.stiffness = def->stiffness,
                           .kratio = def->kratio,
                           .friction = def->friction,
                           .part = 1.0,
                           .hertz = gn_touch_hertz(ctx, dem, wall, material),
                           .rolling = gn_touch_rolling(ctx, dem, wall, material, false),
                           .twisting = gn_touch_rolling(ctx, dem, wall, material, true)};
}

static inline gn_touch_side gn_wall_side(const gn_step_context *ctx, const gn_dem *dem, size_t wall,
                                         size_t particle) {
    gn_touch_side side = gn_wall_side_of(ctx, dem, wall, dem->particles.material[particle]);
    side.radius = dem->particles.pos[4 * particle + 3];
    return side;
}

/* Returns the side of a surface; `part`: see gn_touch_side. */
static inline gn_touch_side gn_surface_side(const gn_step_context *ctx, const gn_dem *dem,
                                            const gn_surface *surface, size_t particle,
                                            double part) {
    size_t bodies = ctx->scene.body_count;
    size_t place = ctx->scene.wall_count + (surface->body >= 0 ? (size_t)surface->body : bodies);
    const int32_t material = dem->particles.material[particle];
    const double radius = dem->particles.pos[4 * particle + 3];
    gn_touch_side side = {.stiffness = surface->stiffness,
                          .kratio = surface->kratio,
                          .friction = surface->friction,
                          .part = part,
                          .radius = radius,
                          .hertz = gn_touch_hertz(ctx, dem, place, material),
                          .rolling = gn_touch_rolling(ctx, dem, place, material, false),
                          .twisting = gn_touch_rolling(ctx, dem, place, material, true)};
    if (!gn_surface_patched(surface, radius)) return side;
    /* Tangential stiffnesses of the facets of a patch add up too. */
    side.part = 1.0;
    side.stiffness *= part;
    side.hertz.modulus *= part;
    side.hertz.shear_modulus *= part;
    return side;
}

/* Returns the largest overlap, m, of a particle with a wall or surface before the lists are
 * rebuilt, from the present overlap; by Hertz's law, before the next check of the step. */
static inline double gn_touch_reach(const gn_step_context *ctx, const gn_dem *dem, size_t particle,
                                    double overlap) {
    if (ctx->effects & GN_FX_HERTZ) return gn_pressed_touch(dem, particle);
    return overlap + dem->verlet.skin;
}

/* Returns the last step, as contacts of a particle require it. */
static inline gn_touch_step gn_touch_step_of(const gn_step_context *ctx, const gn_dem *dem) {
    return (gn_touch_step){.dt = ctx->dt_past,
                           .damping_fraction = dem->damping_fraction,
                           .damping = ctx->effects & GN_FX_CONTACT_DAMPING,
                           .space = ctx->effects & GN_FX_SPACE,
                           .spins = dem->particles.spin != NULL,
                           .pulls = !(ctx->effects & GN_FX_NO_PULL),
                           .rupture = gn_bridge_rupture(&ctx->scene)};
}

/* Returns the force of a contact, see gn_law.touch. `row`: the row of the contact. */
static inline double gn_touch_force(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_touch_side *side,
                                    size_t row, gn_touch *touch, double *fd, double *shear,
                                    size_t stride, double t[3], gn_contact_sums *sums) {
    size_t particle = (size_t)boundary->contacts.i[row];
    const gn_touch_step step = gn_touch_step_of(ctx, dem);
    if (gn_touch_crosses(touch, touch->speed * ctx->dt_past) && !(ctx->effects & GN_FX_HERTZ))
        touch->other_acceleration =
            gn_other_acceleration(ctx, dem, boundary, row, touch->n) +
            gn_held_acceleration(ctx, dem, boundary, side->part * side->stiffness, row, touch->n);
    if (ctx->effects & GN_FX_HERTZ) touch->checked_overlap = gn_pressed_touch(dem, particle);
    return gn_law_of(ctx->effects)->touch(&step, side, touch, fd, shear, stride, t, sums);
}

/* Returns the largest stiffness of a contact with this side; `overlap`: its largest overlap, m. */
static inline gn_law_spring gn_touch_spring(const gn_step_context *ctx, const gn_dem *dem,
                                            const gn_touch_side *side, double inverse_mass,
                                            double overlap) {
    gn_law_spring s =
        gn_law_of(ctx->effects)->touch_spring(side, inverse_mass, dem->damping_fraction, overlap);
    if (!(ctx->effects & GN_FX_WALL_SHEAR)) s.kt = 0.0;
    return s;
}

/* The wall or surface of a row, as the contact force requires it (contact_rows.c). */
typedef struct gn_row_side {
    double n[3], v[3]; /* normal from the particle into the object, 0: no contact; velocity of the
                          object, m/s */
    gn_touch_side law;
} gn_row_side;
gn_row_side gn_row_side_of(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, size_t row);
/* Returns the energy, J, that contacts with walls and surfaces gain if the Hertz parameters change
 * from `before`, ordered as by gn_touch_hertz, to the present ones. */
double gn_touches_gain(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_hertz_pair *before);

#endif
