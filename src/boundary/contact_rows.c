/* Rows of contacts with walls and surfaces as the last step left them, and other loads on a
 * particle whose contact closes or opens within a step: the force with which the works of such a
 * contact close depends on the path of the next step. */
#include "boundary/contact_rows.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "frame/frame.h"
#include "kernels/partials.h"
#include "particles/particles.h"
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

/* Returns the index of the side of a row in the numbering of gn_touch_hertz. */
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

/* Returns the gain of energy of a row. The normal force changes at the same overlap, the other
 * forces are kept. Half of the work of the next path is booked with the old force, half with the
 * new one. */
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
    /* The stiffness of moments is the tangential stiffness times the radius squared. */
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

/* Adds the partial sums of a list for a particle. */
static void add_rows(const gn_partials *list, size_t particle, int axes, double force[3]) {
    const size_t block = particle / GN_PARTICLE_BLOCK;
    if (!list->blocks) return;
    for (int32_t k = list->start[block]; k < list->start[block + 1]; k++) {
        if ((size_t)list->share[k].particle != particle) continue;
        const size_t at = (size_t)list->share[k].row * (size_t)list->width;
        for (int a = 0; a < axes; a++)
            force[a] +=
                list->row_f ? (double)list->row_f[at + (size_t)a] : list->row[at + (size_t)a];
    }
}

/* Adds the forces along their normals of the other walls and surfaces on the particle of a row.
 * Contacts on the same surface whose normal is nearly n share the particle's mass with the row. */
static void add_touches(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t row, const double n[3], double force[3]) {
    const gn_wall_contacts *q = &boundary->contacts;
    const size_t walls = ctx->scene.wall_count, end = (size_t)boundary->first[q->i[row] + 1];
    const gn_surface *own =
        (size_t)q->wall[row] < walls ? NULL : gn_surface_of_row(ctx, boundary, row);
    for (size_t c = (size_t)boundary->first[q->i[row]]; c < end;) {
        if ((size_t)q->wall[c] >= walls) {
            bool same = gn_surface_of_row(ctx, boundary, c) == own;
            c = gn_surface_presses(ctx, dem, boundary, c, end, same ? n : NULL, force);
        } else {
            if (c != row) gn_wall_presses(ctx, dem, boundary, c, force);
            c++;
        }
    }
}

/* Returns the body of a row; NULL: it has none. */
static const gn_rigid *body_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                   size_t row) {
    if ((size_t)boundary->contacts.wall[row] < ctx->scene.wall_count) return NULL;
    const gn_surface *s = gn_surface_of_row(ctx, boundary, row);
    return s->body >= 0 ? &boundary->bodies[s->body] : NULL;
}

double gn_other_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, size_t row, const double n[3]) {
    const gn_particles *q = &dem->particles;
    const gn_wall_contacts *list = &boundary->contacts;
    const size_t p = (size_t)list->i[row];
    const int32_t slot = dem->prescribed.count ? q->slot[p] : -1;
    const double inverse = q->vel[4 * p + 3], own = gn_own_share(q, p);
    const double *gravity = ctx->scene.gravity;
    double force[3] = {0, 0, 0}, sum = 0.0;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        add_rows(&dem->list[l].partials, p, (int)ctx->scene.dimension, force);
    add_touches(ctx, dem, boundary, row, n, force);
    const gn_rigid *body = body_of_row(ctx, boundary, row);
    for (int a = 0; a < 3; a++) {
        bool held = slot >= 0 && dem->prescribed.mask[slot] >> a & 1;
        if (q->applied) force[a] += q->applied[4 * p + (size_t)a];
        if (!held && inverse > 0.0) sum -= (inverse * force[a] + own * gravity[a]) * n[a];
        if (body && body->inverse_mass[a] > 0.0) sum += gravity[a] * n[a];
    }
    return sum;
}

/* Half a period of both springs takes at least three steps, as that of a contact alone does
 * (law_linear.c): with fewer steps the predicted closing force grew until particles flew off. */
double gn_held_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, double kn, size_t row, const double n[3]) {
    const size_t p = (size_t)boundary->contacts.i[row];
    const double held = gn_boundary_held_stiffness(boundary, p),
                 inverse = dem->particles.vel[4 * p + 3];
    if (!(held > 0.0) || (kn + held) * inverse * ctx->dt_past * ctx->dt_past > 1.0) return 0.0;
    return boundary->holder.acceleration(boundary->holder.context, p, n);
}
