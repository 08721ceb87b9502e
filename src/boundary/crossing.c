/* Loads beside a contact that closes or opens within a step: the force with which the works of such
 * a contact close depends on the path of the next step. */
#include "boundary/boundary.h"
#include "boundary/boundary_private.h"
#include "boundary/surface.h"
#include "boundary/surface_lists.h"
#include "frame/step_context.h"
#include "kernels/partials.h"
#include "particles/dem.h"
#include "soa/records.h"
#include "zones/zones.h"

/* Adds what the blocks of a list exert on a particle. */
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

/* Adds what the other walls and surfaces do to the particle of a row along their normals. What has
 * nearly the normal n of the row, on the same surface, shares the particle's mass with it. */
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

/* The body that a row is about, NULL: none. */
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

/* Three steps to the half wave of both, as of a contact alone (law_linear.c): with fewer, what is
 * foretold of the next step grew until particles flew off. */
double gn_held_acceleration(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            const gn_zones *zones, double kn, size_t row, const double n[3]) {
    const size_t p = (size_t)boundary->contacts.i[row];
    const double held = gn_penalty_stiffness(ctx, dem, zones, p),
                 inverse = dem->particles.vel[4 * p + 3];
    if (!(held > 0.0) || (kn + held) * inverse * ctx->dt_past * ctx->dt_past > 1.0) return 0.0;
    return gn_penalty_opens(ctx, dem, solids, zones, p, n);
}
