/* Rows of contacts with walls and surfaces as the last step left them. */
#include "boundary/contact_rows.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "boundary/surface_lists.h"
#include "frame/step_context.h"
#include "kernels/law.h"
#include "particles/dem.h"
#include "scene/sides.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

gn_row_side gn_row_side_of(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, size_t row) {
    const gn_wall_contacts *k = &boundary->contacts;
    size_t wall = (size_t)k->wall[row];
    gn_row_side s;
    if (wall < ctx->scene.wall_count) {
        for (int a = 0; a < 3; a++) s.n[a] = -boundary->walls[wall].normal[a];
        memcpy(s.v, boundary->walls[wall].velocity, sizeof s.v);
        s.law = gn_wall_side(ctx, dem, wall, (size_t)k->i[row]);
    } else {
        for (size_t a = 0; a < 3; a++) s.n[a] = k->normal[row + a * k->soa.capacity];
        double part = sqrt(gn_dot3(s.n, s.n));
        for (int a = 0; part > 0.0 && a < 3; a++) s.n[a] /= part;
        gn_surface_velocity(ctx, boundary, row, s.v);
        s.law = gn_surface_side(ctx, dem, gn_surface_of_row(ctx, boundary, row), (size_t)k->i[row],
                                part);
    }
    return s;
}

/* As gn_touch_hertz counts them. */
static size_t place_of(const gn_step_context *ctx, const gn_boundary *boundary, size_t c) {
    size_t wall = (size_t)boundary->contacts.wall[c], bodies = ctx->scene.body_count;
    if (wall < ctx->scene.wall_count) return wall;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, c);
    return ctx->scene.wall_count + (s->body >= 0 ? (size_t)s->body : bodies);
}

static double square_of(const double *column, size_t c, size_t stride) {
    double sum = 0.0;
    for (size_t a = 0; column && a < 3; a++) sum += column[c + a * stride] * column[c + a * stride];
    return sum;
}

/* The normal force is another one at the same overlap, the others are carried over. Of the work in
 * the path that follows half is booked with the force that was there, half with the new one. */
static double gain_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      size_t c, const gn_row_side *s, const gn_hertz_pair *before) {
    const gn_wall_contacts *k = &boundary->contacts;
    const gn_law *law = gn_law_of(ctx->effects);
    const double *force = k->row + 8 * c, *vel = dem->particles.vel + 4 * (int64_t)k->i[c];
    double pressed = (k->fd ? k->fd[c] : 0.0) - gn_dot3(force, s->n), path = 0.0;
    gn_touch_side old = s->law;
    old.hertz = *before;
    if (!(pressed > 0.0)) return 0.0;
    for (int a = 0; a < 3; a++) path -= ctx->dt_past * (s->v[a] - vel[a]) * s->n[a];
    double now = pressed * (s->law.hertz.modulus / old.hertz.modulus);
    /* Moments have the tangential stiffness times the radius squared. */
    double shear2 = square_of(k->shear, c, k->soa.capacity) +
                    square_of(k->roll, c, k->soa.capacity) / (old.radius * old.radius);
    return law->touch_stored(&s->law, now, shear2) - law->touch_stored(&old, pressed, shear2) +
           0.5 * (now - pressed) * path;
}

double gn_touches_gain(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_hertz_pair *before) {
    const gn_wall_contacts *k = &boundary->contacts;
    const size_t sides = gn_scene_sides(&ctx->scene);
    double sum = 0.0;
    for (size_t c = 0; c < k->soa.count; c++) {
        gn_row_side s = gn_row_side_of(ctx, dem, boundary, c);
        const size_t material = (size_t)dem->particles.material[k->i[c]];
        if (gn_dot3(s.n, s.n) > 0.0)
            sum += gain_of(ctx, dem, boundary, c, &s,
                           &before[material * sides + place_of(ctx, boundary, c)]);
    }
    return sum;
}
