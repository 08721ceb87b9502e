/* By Hertz's law the stiffness of a contact grows with its overlap. The step is chosen for an
 * expected overlap: the larger one of growth times the present overlap, and of the overlap in a
 * collision at the present speeds of the contact itself and of its neighbours. Kernels count the
 * contacts that exceed it; if there are any, all contacts are checked again before the next step.
 * The expected overlap of a contact never decreases, as an automatic step never increases. */
#include "timestep/indentation.h"
#include "base/error.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/contact_rows.h"
#include "boundary/surfaces.h"
#include "frame/frame.h"
#include "particles/active_pairs.h"
#include "particles/depth.h"
#include "particles/expected_overlap.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "timestep/timestep.h"
#include "timestep/timestep_private.h"

#include <math.h>

/* factor on the present overlap; margin added to an expected overlap that grows */
static const double growth = 1.2, reserve = 1.25;

/* Returns the largest acceleration by applied forces, m/s2. */
static double applied(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double most2 = 0.0;
    for (size_t p = 0; ctx->effects & GN_FX_APPLIED && p < q->soa.count; p++) {
        const double *f = q->applied + 4 * p, inverse = q->vel[4 * p + 3];
        most2 = fmax(most2, gn_dot3(f, f) * inverse * inverse);
    }
    return sqrt(most2);
}

/* --- expected overlaps --- */

static void raise(gn_dem *dem, size_t p, double to) {
    double *known = &dem->particles.pressed[p];
    if (to > *known) *known = reserve * to;
}

static void update_pairs(gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const gn_contacts *k = &dem->pairs.contacts;
    for (size_t c = 0; c < k->soa.count; c++) {
        size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        const double *vi = q->vel + 4 * i, *vj = q->vel + 4 * j;
        double d[3], radius = gn_pair_radius(q, i, j), known = fmin(q->pressed[i], q->pressed[j]);
        double gap = sqrt(gn_branch(ctx, q->pos + 4 * i, q->pos + 4 * j, d)) - q->pos[4 * i + 3] -
                     q->pos[4 * j + 3];
        known = fmax(known, growth * -gap / radius);
        const double pull = k->adhesion && !(k->span[c] > 0.0) ? k->adhesion[c] : 0.0;
        known = gn_expected_overlap(ctx, dem, k->kn[c], pull, vi[3] + vj[3],
                                    gn_relative_speed2(vi, vj), radius, known);
        raise(dem, i, known);
        raise(dem, j, known);
    }
}

static void keep_pairs(gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    gn_contacts *k = &dem->pairs.contacts;
    for (size_t c = 0; c < k->soa.count; c++) {
        size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        k->most[c] = gn_pair_radius(q, i, j) * fmax(q->pressed[i], q->pressed[j]);
        if (k->most_f) k->most_f[c] = (float)k->most[c];
    }
}

/* Updates the expected overlap of a particle by its contact with an object that moves at `v` and
 * counts as infinitely heavy. */
static void consider(gn_step_context *ctx, gn_dem *dem, size_t p, const gn_touch_side *side,
                     const double v[3], double overlap) {
    const double *own = dem->particles.vel + 4 * p;
    double kn = gn_law_of(ctx->effects)->touch_spring(side, 1.0, 0.0, 1.0).kn;
    double known = fmax(dem->particles.pressed[p], growth * overlap / side->radius);
    const double pull = gn_sudden_pull(side->hertz.cohesion, side->hertz.adhesion, side->radius);
    raise(dem, p,
          gn_expected_overlap(ctx, dem, kn, pull, own[3], gn_relative_speed2(own, v), side->radius,
                              known));
}

/* Returns the velocity of the surface at the contact. */
static void surface_velocity(const gn_dem *dem, const gn_boundary *boundary,
                             const gn_surface_contact *c, double v[3]) {
    const gn_surface *s = c->surface;
    const double *x = dem->particles.pos + 4 * c->particle;
    v[0] = v[1] = v[2] = 0.0;
    if (s->body < 0) {
        for (int k = 0; k < c->parts; k++)
            for (int a = 0; a < 3; a++)
                v[a] += c->weight[k] * s->velocity[4 * (int64_t)c->vertex[k] + a];
        return;
    }
    const gn_rigid *b = &boundary->bodies[s->body];
    double lever[3];
    for (int a = 0; a < 3; a++) lever[a] = x[a] + c->contact.arm[a] - b->position[a];
    gn_cross3(b->spin, lever, v);
    for (int a = 0; a < 3; a++) v[a] += b->velocity[a];
}

static size_t update_surface(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, size_t row) {
    size_t count = 0, p = (size_t)boundary->contacts.i[row];
    const gn_surface *s = gn_surface_of_row(ctx, boundary, row);
    gn_touch_side side = gn_surface_side(ctx, dem, s, p, 1.0);
    double v[3];
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    row = gn_surface_contacts_at(ctx, dem, boundary, row, dem->verlet.skin, found, &count);
    for (size_t k = 0; k < count; k++) {
        surface_velocity(dem, boundary, &found[k], v);
        consider(ctx, dem, p, &side, v, fmax(-found[k].contact.overlap, 0.0));
    }
    return row;
}

static void update_walls(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary) {
    const gn_wall_contacts *k = &boundary->contacts;
    for (size_t c = 0; ctx->effects & GN_FX_WALLS && c < k->soa.count;) {
        size_t wall = (size_t)k->wall[c], p = (size_t)k->i[c];
        if (wall >= ctx->scene.wall_count) {
            c = update_surface(ctx, dem, boundary, c);
            continue;
        }
        gn_touch_side side = gn_wall_side(ctx, dem, wall, p);
        const double *x = dem->particles.pos + 4 * p;
        double gap = gn_wall_distance(&boundary->walls[wall], x) - x[3] - k->gap0[c];
        consider(ctx, dem, p, &side, boundary->walls[wall].velocity, fmax(-gap, 0.0));
        c++;
    }
}

void gn_pressed_update(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary) {
    if (!(ctx->effects & GN_FX_HERTZ)) return;
    ctx->choice.push = applied(ctx, dem);
    for (size_t p = 0; p < dem->particles.soa.count; p++) raise(dem, p, GN_OVERLAP_LEAST);
    update_pairs(ctx, dem);
    update_walls(ctx, dem, boundary);
    keep_pairs(dem);
    gn_active_pairs_repack(ctx, dem);
}

/* --- prescribed motions --- */

/* The prescribed motion of a wall, body or set. Its speed, and its change of speed, are those of
 * the coming step, at the middle of which tables are evaluated. */
typedef struct drive {
    const gn_motion *motion;
    const char *name;
    const double *now; /* velocity in the last step; NULL: that of the table */
    double reach;      /* m, lever arm of a spin */
} drive;

static double speed_of(const gn_step_context *ctx, const drive *d, double *change) {
    const double next = ctx->time + 0.5 * ctx->dt, last = ctx->time - 0.5 * ctx->dt_past;
    double v[3], turn[3], by[3];
    for (int a = 0; a < 3; a++) {
        const gn_table *t = &d->motion->velocity[a], *s = &d->motion->spin[a];
        const double factor = gn_control_of(ctx, d->name, a);
        v[a] = t->count ? factor * gn_table_at(t, next) : d->now ? d->now[a] : 0.0;
        by[a] = t->count ? v[a] - (d->now ? d->now[a] : factor * gn_table_at(t, last)) : 0.0;
        turn[a] = s->count ? gn_table_at(s, next) : 0.0;
    }
    const double spin = sqrt(gn_dot3(turn, turn)) * d->reach;
    *change = sqrt(gn_dot3(by, by)) + spin;
    return sqrt(gn_dot3(v, v)) + spin;
}

/* Returns the speed of a wall; a servo may reach its largest velocity in one step. */
static double speed_of_wall(const gn_step_context *ctx, const gn_boundary *boundary, size_t k,
                            double *change) {
    const gn_wall_def *def = &ctx->scene.walls[k];
    const drive d = {&def->motion, def->name, boundary->walls[k].velocity, 0.0};
    if (!def->servo.active) return speed_of(ctx, &d, change);
    return *change = def->servo.max_velocity;
}

static double speed_of_body(const gn_step_context *ctx, const gn_boundary *boundary, size_t k,
                            double *change) {
    const gn_rigid *b = &boundary->bodies[k];
    const drive d = {&ctx->scene.bodies[k].motion, ctx->scene.bodies[k].name, b->velocity,
                     b->reach};
    return speed_of(ctx, &d, change);
}

static double speed_of_set(const gn_step_context *ctx, size_t k, double *change) {
    const drive d = {&ctx->scene.sets[k].motion, ctx->scene.sets[k].name, NULL, 0.0};
    return speed_of(ctx, &d, change);
}

/* Returns the largest change of velocity in the coming step over all objects that become faster
 * than at their last check. A motion that slows down and speeds up again is covered by that check.
 */
static double driven_gain(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary) {
    const size_t count[] = {ctx->scene.wall_count, ctx->scene.body_count, ctx->scene.set_count};
    double gain = 0.0, *known = dem->driven;
    for (int kind = 0; kind < 3; kind++)
        for (size_t k = 0; k < count[kind]; k++, known++) {
            double change, now = kind == 0   ? speed_of_wall(ctx, boundary, k, &change)
                                 : kind == 1 ? speed_of_body(ctx, boundary, k, &change)
                                             : speed_of_set(ctx, k, &change);
            if (!(now > 1.1 * *known)) continue;
            *known = now;
            gain = fmax(gain, change);
        }
    return gain;
}

/* Lowers the step before a prescribed motion begins, because the step may be long if nothing moves
 * yet. */
static gneiss_status check_driven(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                  gneiss_error *error) {
    if (!dem->driven) return GNEISS_OK;
    ctx->choice.gain = driven_gain(ctx, dem, boundary);
    gneiss_status status =
        ctx->choice.gain > 0.0
            ? gn_timestep_check_lists(ctx, dem, boundary, solids, zones, ledger, error)
            : GNEISS_OK;
    ctx->choice.gain = 0.0;
    return status;
}

gneiss_status gn_pressed_check(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                               gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                               gneiss_error *error) {
    GN_TRY(check_driven(ctx, dem, boundary, solids, zones, ledger, error));
    if (!dem->pressed) return GNEISS_OK;
    return gn_timestep_check_lists(ctx, dem, boundary, solids, zones, ledger, error);
}

/* Number of steps between two checks, each of which takes a third of the time of a step. */
enum { LOOK_INTERVAL = 50 };

static void record_pairs(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    const gn_contacts *k = &dem->pairs.contacts;
    for (size_t c = 0; c < k->soa.count; c++) {
        const size_t i = (size_t)k->i[c], j = (size_t)k->j[c];
        const double *a = q->pos + 4 * i, *b = q->pos + 4 * j;
        const double radius = fmin(a[3], b[3]), most = a[3] + b[3] - gn_depth_known(dem, radius);
        double d[3], d2 = gn_branch(ctx, a, b, d);
        if (!(most > 0.0 && d2 < most * most)) continue;
        if (!(gn_inverse_mass_along(dem, i, d) + gn_inverse_mass_along(dem, j, d) > 0.0)) continue;
        /* Elements still represent the bond: the overlap is that of the packing and has no force.
         */
        if (q->blend && !(q->blend[2 * i] + q->blend[2 * j] > 0.0)) continue;
        gn_depth_note(ctx, dem, a[3] + b[3] - sqrt(d2), radius, i, q->id[j]);
    }
}

static size_t record_surface(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             size_t row) {
    const size_t p = (size_t)boundary->contacts.i[row];
    const double radius = dem->particles.pos[4 * p + 3];
    gn_surface_contact found[GN_SURFACE_CONTACTS];
    size_t count = 0;
    row = gn_surface_contacts_at(ctx, dem, boundary, row, 0.0, found, &count);
    for (size_t k = 0; k < count; k++) {
        const gn_surface *s = found[k].surface;
        const double overlap = -found[k].contact.overlap;
        if (!(overlap > gn_depth_known(dem, radius))) continue;
        if (!(gn_inverse_mass_along(dem, p, found[k].contact.n) > 0.0 ||
              gn_surface_yields(boundary, s)))
            continue;
        gn_depth_note(ctx, dem, overlap, radius, p,
                      -1.0 - (double)ctx->scene.wall_count - (double)(s - boundary->surfaces));
    }
    return row;
}

static void record_walls(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary) {
    const gn_wall_contacts *k = &boundary->contacts;
    for (size_t c = 0; ctx->effects & GN_FX_WALLS && c < k->soa.count;) {
        const size_t wall = (size_t)k->wall[c], p = (size_t)k->i[c];
        if (wall >= ctx->scene.wall_count) {
            c = record_surface(ctx, dem, boundary, c);
            continue;
        }
        const gn_wall *of = &boundary->walls[wall];
        const double *x = dem->particles.pos + 4 * p;
        const double overlap = x[3] + k->gap0[c] - gn_wall_distance(of, x);
        if (overlap > gn_depth_known(dem, x[3]) && gn_inverse_mass_along(dem, p, of->normal) > 0.0)
            gn_depth_note(ctx, dem, overlap, x[3], p, -1.0 - (double)wall);
        c++;
    }
}

gneiss_status gn_depth_update(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                              gneiss_error *error) {
    GN_TRY(gn_depth_begin(ctx, dem, error));
    record_pairs(ctx, dem);
    record_walls(ctx, dem, boundary);
    return GNEISS_OK;
}

gneiss_status gn_depth_update_when_due(const gn_step_context *ctx, gn_dem *dem,
                                       gn_boundary *boundary, gneiss_error *error) {
    bool due = (double)ctx->step - dem->depth.looked >= LOOK_INTERVAL;
    if (due) gn_ranks_whole(ctx->ranks);
    return due && ctx->scene.has_specimen ? gn_depth_update(ctx, dem, boundary, error) : GNEISS_OK;
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
