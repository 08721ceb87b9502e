#include "timestep/depth.h"

#include "base/error.h"
#include "boundary/boundary.h"
#include "boundary/surface.h"
#include "boundary/surfaces.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "particles/law.h"
#include "soa/records.h"
#include "timestep/surface_limit.h"
#include "timestep/timestep_private.h"

#include <math.h>

/* Looks cost a third of a step. */
enum { LOOK_INTERVAL = 50 };

/* m: a smaller overlap is less than what is known. */
static double least(const gn_dem *dem, double radius) {
    return dem->depth.excess * GN_DEPTH_LOOSE * radius;
}

static void note(const gn_step_context *ctx, gn_dem *dem, double overlap, double radius, size_t p,
                 double second) {
    gn_depth *d = &dem->depth;
    const double id = dem->particles.id[p];
    bool loose = dem->loose[(size_t)id] || (second >= 0.0 && dem->loose[(size_t)second]);
    double excess = overlap / radius / (loose ? GN_DEPTH_LOOSE : GN_DEPTH_BONDED);
    if (!(excess > d->excess)) return;
    *d = (gn_depth){excess,
                    overlap / radius,
                    overlap,
                    ctx->time,
                    second >= 0.0 ? fmin(id, second) : id,
                    second >= 0.0 ? fmax(id, second) : second,
                    d->looked};
}

static void look_at_pairs(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const gn_contacts *k = &dem->pairs.contacts;
    for (size_t c = 0; c < k->soa.count; c++) {
        const size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        const double *a = q->pos + 4 * i, *b = q->pos + 4 * j;
        const double radius = fmin(a[3], b[3]), most = a[3] + b[3] - least(dem, radius);
        double d[3], d2 = gn_branch(ctx, a, b, d);
        if (!(most > 0.0 && d2 < most * most)) continue;
        if (!(gn_inverse_mass_along(dem, i, d) + gn_inverse_mass_along(dem, j, d) > 0.0)) continue;
        /* Elements stand for their bond as yet: the packing's own overlap, without force. */
        if (q->blend && !(q->blend[2 * i] + q->blend[2 * j] > 0.0)) continue;
        note(ctx, dem, a[3] + b[3] - sqrt(d2), radius, i, q->id[j]);
    }
}

static size_t look_at_surface(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                              size_t row) {
    const size_t p = (size_t)boundary->contacts.i[row];
    const double radius = dem->particles.pos[4 * p + 3];
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    size_t count = 0;
    row = gn_surface_contacts_at(ctx, dem, boundary, row, 0.0, found, &count);
    for (size_t k = 0; k < count; k++) {
        const gn_surface *s = found[k].surface;
        const double overlap = -found[k].contact.overlap;
        if (!(overlap > least(dem, radius))) continue;
        if (!(gn_inverse_mass_along(dem, p, found[k].contact.n) > 0.0 ||
              gn_surface_yields(boundary, s)))
            continue;
        note(ctx, dem, overlap, radius, p,
             -1.0 - (double)ctx->scene.wall_count - (double)(s - boundary->surfaces));
    }
    return row;
}

static void look_at_walls(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary) {
    const gn_wall_contacts *k = &boundary->contacts;
    for (size_t c = 0; ctx->effects & GN_FX_WALLS && c < k->soa.count;) {
        const size_t wall = (size_t)k->wall[c], p = (size_t)k->i[c];
        if (wall >= ctx->scene.wall_count) {
            c = look_at_surface(ctx, dem, boundary, c);
            continue;
        }
        const gn_wall *of = &boundary->walls[wall];
        const double *x = dem->particles.pos + 4 * p;
        const double overlap = x[3] + k->gap0[c] - gn_wall_distance(of, x);
        if (overlap > least(dem, x[3]) && gn_inverse_mass_along(dem, p, of->normal) > 0.0)
            note(ctx, dem, overlap, x[3], p, -1.0 - (double)wall);
        c++;
    }
}

gneiss_status gn_depth_look(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                            gneiss_error *error) {
    GN_TRY(gn_loose_find(ctx, dem, error));
    look_at_pairs(ctx, dem);
    look_at_walls(ctx, dem, boundary);
    dem->depth.looked = (double)ctx->step;
    return GNEISS_OK;
}

gneiss_status gn_depth_look_again(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error) {
    bool due = (double)ctx->step - dem->depth.looked >= LOOK_INTERVAL;
    return due && ctx->scene.has_specimen ? gn_depth_look(ctx, dem, boundary, error) : GNEISS_OK;
}

const char *gn_depth_text(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size) {
    const gn_depth *d = &dem->depth;
    const size_t walls = ctx->scene.wall_count,
                 k = d->second < 0.0 ? (size_t)(-1.0 - d->second) : 0;
    if (d->second >= 0.0)
        snprintf(text, size, "particles %.0f and %.0f", d->first, d->second);
    else if (k < walls)
        snprintf(text, size, "particle %.0f and wall '%.60s'", d->first, ctx->scene.walls[k].name);
    else if (k - walls < ctx->scene.body_count)
        snprintf(text, size, "particle %.0f and body '%.60s'", d->first,
                 ctx->scene.bodies[k - walls].name);
    else
        snprintf(text, size, "particle %.0f and the finite elements", d->first);
    return text;
}
