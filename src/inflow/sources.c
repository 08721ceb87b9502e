/* Particles of sources: those that are due and have room. */
#include "inflow/sources.h"
#include "base/ball.h"
#include "base/error.h"
#include "base/new.h"
#include "base/random.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "inflow/free_space.h"
#include "inflow/removal.h"
#include "pack/domain.h"
#include "pack/sizes.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "particles/rows.h"
#include "scene/flow_def.h"
#include "scene/scene.h"

#include <string.h>

/* Least number of steps between two insertions. Making lists costs as much as some fifteen steps,
 * and flows require it every hundred or so anyway. */
enum { STEPS_BETWEEN = 50 };
/* Number of positions that are tried for a particle before it has to wait, and number of points
 * drawn to find one in the region. */
enum { TRIES = 100, SAMPLES = 10000 };

/* --- times --- */

/* Returns the time, s, during which the source has been active. */
static double running(const gn_source_def *d, double time) {
    double until = d->end > 0.0 ? fmin(time, d->end) : time;
    return until - d->start;
}

/* Return the inflow so far in the unit of the rate, and the rate. */
static double amount(const gn_source_def *d, const gn_source_state *s) {
    return d->mass_rate > 0.0 ? s->mass : s->number;
}
static double rate(const gn_source_def *d) {
    return d->mass_rate > 0.0 ? d->mass_rate : d->rate;
}

/* Tells whether a source is finished. Particles that are due by its end enter later when there is
 * room. The first particle is due at the start, so that the one after the last would be due at the
 * end. */
static bool is_done(const gn_source_def *d, const gn_source_state *s) {
    if (d->total > 0 && s->number >= (double)d->total) return true;
    return d->end > 0.0 && amount(d, s) >= rate(d) * (d->end - d->start) * (1.0 - 1e-12);
}

static bool due(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    const gn_source_state *s = &dem->flow.sources[k];
    if (ctx->time < d->start || is_done(d, s)) return false;
    return amount(d, s) <= rate(d) * running(d, ctx->time);
}

bool gn_flow_due(const gn_step_context *ctx, const gn_dem *dem) {
    if (!gn_scene_has_flow(&ctx->scene) || ctx->step - dem->verlet.last_step < STEPS_BETWEEN)
        return false;
    for (size_t k = 0; k < ctx->scene.source_count; k++)
        if (due(ctx, dem, k)) return true;
    return false;
}

double gn_flow_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    const gn_source_state *s = &dem->flow.sources[k];
    if (d->total > 0 && s->number >= (double)d->total) return 0.0;
    return fmax(0.0, running(d, ctx->time) - amount(d, s) / rate(d));
}

bool gn_flow_brings(const gn_step_context *ctx, const gn_dem *dem) {
    for (size_t k = 0; gn_scene_has_flow(&ctx->scene) && k < ctx->scene.source_count; k++) {
        const gn_source_def *d = &ctx->scene.sources[k];
        const gn_source_state *s = &dem->flow.sources[k];
        const bool waits = gn_flow_behind(ctx, dem, k) > 2.0 * STEPS_BETWEEN * ctx->dt;
        if (!is_done(d, s) && !waits && d->start + amount(d, s) / rate(d) <= ctx->scene.end)
            return true;
    }
    return false;
}

/* Returns the amount of one particle in the unit of the rate. */
static double one(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_state *s = &dem->flow.sources[k];
    if (!(ctx->scene.sources[k].mass_rate > 0.0)) return 1.0;
    return s->number > 0.0 ? s->mass / s->number : 0.0;
}

bool gn_flow_is_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    const double behind = gn_flow_behind(ctx, dem, k);
    return behind > 0.01 * fmax(0.0, running(d, ctx->time)) && behind * rate(d) > one(ctx, dem, k);
}

double gn_flow_late(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    const double most = running(d, ctx->scene.end) * rate(d),
                 late = STEPS_BETWEEN * ctx->dt * rate(d);
    const bool over = d->end > 0.0 && d->end + STEPS_BETWEEN * ctx->dt < ctx->scene.end;
    const bool full = d->total > 0 && most - late > (double)d->total * one(ctx, dem, k);
    if (over || full || !(most > 0.0) || !(one(ctx, dem, k) > 0.0)) return 0.0;
    return late > one(ctx, dem, k) && late > 0.01 * most
               ? fmin(late / one(ctx, dem, k), gn_flow_expected(ctx, dem, k))
               : 0.0;
}

double gn_flow_expected(const gn_step_context *ctx, const gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    if (!(one(ctx, dem, k) > 0.0)) return 0.0;
    const double fed = fmax(0.0, running(d, ctx->scene.end)) * rate(d) / one(ctx, dem, k);
    return d->total > 0 ? fmin(fed, (double)d->total) : fed;
}

/* --- sizes and positions --- */

/* Random numbers of a source, separate for sizes, places and velocities. */
enum { FOR_SIZES, FOR_PLACES, FOR_VELOCITIES, PURPOSES };
static uint64_t seed_of(const gn_step_context *ctx, size_t k, int purpose) {
    return gn_random_bits(ctx->scene.seed ^ UINT64_C(0x736f75726365),
                          PURPOSES * (uint64_t)k + (uint64_t)purpose);
}

static double draw_radius(const gn_step_context *ctx, gn_dem *dem, size_t k) {
    const gn_source_def *d = &ctx->scene.sources[k];
    gn_source_state *s = &dem->flow.sources[k];
    const gn_sizes sizes = {d->sizes,       d->size_ratio, d->size_variation,
                            d->sieve_count, d->sieve,      (int)ctx->scene.dimension};
    gn_drawn drawn = {seed_of(ctx, k, FOR_SIZES), (uint64_t)s->sizes};
    double radius = dem->flow.unit[k] * gn_sizes_draw(&sizes, &drawn);
    s->sizes = (double)drawn.count;
    return radius;
}

/* Draws a position uniformly in the region; returns false if none was found, because the region
 * fills almost nothing of its bounding box. */
static bool draw_place(const gn_step_context *ctx, gn_dem *dem, size_t k, double x[3]) {
    double lower[3], upper[3];
    gn_source_state *s = &dem->flow.sources[k];
    const uint64_t seed = seed_of(ctx, k, FOR_PLACES);
    gn_domain_bounds(dem->flow.region[k], lower, upper);
    for (int n = 0; n < SAMPLES; n++) {
        for (int a = 0; a < 3; a++)
            x[a] = lower[a] + (upper[a] - lower[a]) * 0.5 *
                                  (1.0 + gn_random_symmetric(seed, (uint64_t)s->places++));
        if (gn_domain_depth(dem->flow.region[k], x) >= 0.0) return true;
    }
    return false;
}

static void draw_velocity(const gn_step_context *ctx, const gn_dem *dem, size_t k, double v[3]) {
    const gn_source_def *d = &ctx->scene.sources[k];
    const uint64_t from = 3 * (uint64_t)dem->flow.sources[k].number;
    for (int a = 0; a < 3; a++) {
        v[a] = d->velocity[a];
        if (a < (int)ctx->scene.dimension && d->random_velocity > 0.0)
            v[a] += d->random_velocity *
                    gn_random_symmetric(seed_of(ctx, k, FOR_VELOCITIES), from + (uint64_t)a);
    }
}

/* --- insertion --- */

typedef struct arrivals {
    gn_arrival *item;
    size_t count, space;
} arrivals;

static gneiss_status keep(arrivals *list, const gn_arrival *a, gneiss_error *error) {
    GN_TRY(
        gn_grow(&list->item, list->count, list->count + 1, &list->space, "new particles", error));
    list->item[list->count++] = *a;
    return GNEISS_OK;
}

/* Books the energy of a new particle: at the start as stored, later as inflow. */
static void book(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger, const gn_arrival *a) {
    gn_source_state *s = &dem->flow.sources[a->source];
    const gn_source_def *d = &ctx->scene.sources[a->source];
    int material = gn_scene_find_material(&ctx->scene, d->material);
    double mass = ctx->scene.materials[material].density *
                  gn_ball_volume((int)ctx->scene.dimension, a->sphere[3]);
    double energy = 0.5 * mass * gn_dot3(a->velocity, a->velocity);
    s->number += 1.0;
    s->radius = 0.0;
    s->mass += mass;
    s->energy += energy;
    for (int c = 0; c < 3; c++) s->momentum[c] += mass * a->velocity[c];
    if (ctx->step > 0) ledger->energy.inserted += energy;
}

/* Finds room for a particle. If there is none, the particle keeps its radius, so that crowding does
 * not favour small ones. */
static bool find_place(const gn_step_context *ctx, gn_dem *dem, size_t k, const gn_room *room,
                       double sphere[4]) {
    gn_source_state *s = &dem->flow.sources[k];
    if (!(s->radius > 0.0)) s->radius = draw_radius(ctx, dem, k);
    sphere[3] = s->radius;
    for (int n = 0; n < TRIES; n++) {
        if (!draw_place(ctx, dem, k, sphere)) break;
        if (gn_room_free(room, sphere)) return true;
    }
    s->full += 1.0;
    return false;
}

static gneiss_status let_in(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger, size_t k,
                            gn_room *room, arrivals *list, gneiss_error *error) {
    while (due(ctx, dem, k)) {
        gn_arrival a = {.source = k};
        if (!find_place(ctx, dem, k, room, a.sphere)) return GNEISS_OK;
        draw_velocity(ctx, dem, k, a.velocity);
        GN_TRY(gn_room_take(room, a.sphere, error));
        GN_TRY(keep(list, &a, error));
        book(ctx, dem, ledger, &a);
    }
    return GNEISS_OK;
}

static gneiss_status find_arrivals(const gn_step_context *ctx, gn_dem *dem,
                                   const gn_boundary *boundary, gn_ledger *ledger, arrivals *list,
                                   gneiss_error *error) {
    double lower[3], upper[3];
    gn_room room;
    gn_flow_bounds(ctx, dem, lower, upper);
    GN_TRY(gn_room_open(ctx, dem, boundary, lower, upper, gn_flow_largest_radius(ctx, dem), &room,
                        error));
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < ctx->scene.source_count; k++)
        status = let_in(ctx, dem, ledger, k, &room, list, error);
    gn_room_close(&room);
    return status;
}

const char *gn_flow_wall_before(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k) {
    double bound[2][3];
    gn_domain_bounds(dem->flow.region[k], bound[0], bound[1]);
    for (size_t i = 0; i < ctx->scene.wall_count; i++) {
        double farthest = -INFINITY;
        for (int c = 0; c < 8; c++) {
            const double x[3] = {bound[c & 1][0], bound[c >> 1 & 1][1], bound[c >> 2][2]};
            farthest = fmax(farthest, gn_wall_distance(&boundary->walls[i], x));
        }
        if (farthest < gn_flow_least_radius(ctx, dem)) return ctx->scene.walls[i].name;
    }
    return NULL;
}

static gneiss_status nothing_came(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, gneiss_error *error) {
    size_t k = 0;
    while (ctx->scene.sources[k].start > 0.0) k++;
    const gn_source_def *d = &ctx->scene.sources[k];
    const char *wall = gn_flow_wall_before(ctx, dem, boundary, k);
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected room for a first particle, radius %g m, in source '%s', found "
                   "%s%s%s",
                   gn_scene_at(&ctx->scene, d->where, "sources").text, dem->flow.sources[k].radius,
                   d->name, wall ? "all of it behind wall '" : "", wall ? wall : "",
                   wall ? "', whose normal points to where particles may be"
                        : "walls or bodies wherever it was tried");
}

gneiss_status gn_flow_arrive(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gn_ledger *ledger, bool first, gneiss_error *error) {
    arrivals list = {0};
    bool any = false;
    for (size_t k = 0; gn_scene_has_flow(&ctx->scene) && k < ctx->scene.source_count; k++)
        any = any || due(ctx, dem, k);
    if (!any) return GNEISS_OK;
    gneiss_status status = find_arrivals(ctx, dem, boundary, ledger, &list, error);
    if (status == GNEISS_OK && list.count)
        status = gn_dem_grow(ctx, dem, list.item, list.count, error);
    if (list.count) gn_boundary_resized(boundary);
    gn_free(list.item);
    GN_TRY(status);
    return first && !dem->particles.soa.count ? nothing_came(ctx, dem, boundary, error) : GNEISS_OK;
}
