/* What the first conversion will make of the step, before a step is made: where and when the body
 * comes to a limit first if it follows its motions and loads at rest, K u = f(t), and what the step
 * is once the elements have gone that are loaded most there, by the conversion that a run makes. */
#include "base/error.h"
#include "base/memory.h"
#include "conversion/conversion.h"
#include "conversion/conversion_private.h"
#include "conversion/load_course.h"
#include "conversion/rest_state.h"
#include "couple/front.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "solids/elements.h"
#include "timestep/step_limit.h"
#include "world/world.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double largest(const gn_solids *solids, const double *excess, size_t *at) {
    *at = 0;
    for (size_t e = 1; e < gn_conversion_elements(solids); e++)
        if (excess[e] > excess[*at]) *at = e;
    return gn_conversion_elements(solids) ? excess[*at] : 0.0;
}

/* Of displacements, so that turns are small as well. */
static const double small_part = 1e-6;

/* --- when --- */

enum { LOOKS = 8, LOOKS_ALL = 32 };

/* How many times the limit the body is loaded at a time. */
typedef struct look {
    size_t part;
    double time, share;
} look;

typedef struct looks {
    gn_rest *rest;
    size_t count;
    look *look; /* in their order */
} looks;

static gneiss_status look_at(const looks *q, size_t part, double time, look *out,
                             gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    size_t at;
    gn_rest_find(q->rest, part, time);
    const bool any = gn_rest_put(q->rest, small_part);
    gneiss_status status = gn_conversion_look_around(
        &q->rest->w->ctx, &q->rest->w->solids, &q->rest->w->most_loaded, &kind, &excess, error);
    *out = (look){.part = part, .time = time};
    if (status == GNEISS_OK && any)
        out->share = largest(&q->rest->w->solids, excess, &at) / small_part;
    gn_free(kind);
    gn_free(excess);
    return status;
}

/* Through all parts, up to the first look beyond a limit; each part from its start on, when other
 * loads may act at once. */
static gneiss_status look_through(looks *q, gneiss_error *error) {
    const gn_course *c = &q->rest->course;
    const size_t each = c->count * LOOKS <= LOOKS_ALL ? LOOKS
                        : c->count * 2 < LOOKS_ALL    ? LOOKS_ALL / c->count
                                                      : 2;
    q->look = gn_alloc_array(c->count * (each + 1) + 1, sizeof *q->look);
    if (!q->look) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for looks at a body");
    for (size_t part = 0; part < c->count; part++)
        for (size_t k = 0; k <= each; k++) {
            const gn_course_part *p = &c->part[part];
            const double time = p->begin + (p->end - p->begin) * (double)k / (double)each;
            GN_TRY(look_at(q, part, time, &q->look[q->count], error));
            if (q->look[q->count++].share >= 1.0) return GNEISS_OK;
        }
    return GNEISS_OK;
}

/* Halves what lies between two looks, of which only the later one has a share, until that is known
 * to a part of the time since `from`. *high: the later one. */
static gneiss_status close_in(const looks *q, double share, double low, double from, double part,
                              look *high, gneiss_error *error) {
    enum { HALVINGS = 20 };
    for (int k = 0; k < HALVINGS && high->time - low > part * (high->time - from); k++) {
        const gn_course *c = &q->rest->course;
        const double time = 0.5 * (low + high->time);
        size_t at = 0;
        look middle;
        while (at + 1 < c->count && time >= c->part[at].end) at++;
        GN_TRY(look_at(q, at, time, &middle, error));
        if (middle.share >= share)
            *high = middle;
        else
            low = time;
    }
    return GNEISS_OK;
}

/* s: twice what it takes from half of a share to it, which is all of it for a load that grows
 * evenly; 0: it is there at once. */
static gneiss_status find_rise(const looks *q, const look *to, double *rise, gneiss_error *error) {
    size_t k = q->count;
    look half = *to;
    while (k > 0 && (q->look[k - 1].time >= to->time || q->look[k - 1].share >= 0.5 * to->share))
        k--;
    if (k < q->count && q->look[k].time < to->time) half = q->look[k];
    *rise = 0.0;
    if (k == 0) return GNEISS_OK;
    GN_TRY(
        close_in(q, 0.5 * to->share, q->look[k - 1].time, q->look[k - 1].time, 0.05, &half, error));
    *rise = 2.0 * (to->time - half.time);
    return GNEISS_OK;
}

/* The first look beyond a limit, to a hundredth of its time; or that with the most. */
static gneiss_status find_limit(const looks *q, look *found, gneiss_error *error) {
    *found = q->look[0];
    for (size_t k = 1; k < q->count; k++)
        if (q->look[k].share > (1.0 + 1e-6) * found->share) *found = q->look[k];
    if (found->share < 1.0) return GNEISS_OK;
    const double begin = q->rest->course.part[found->part].begin;
    double low = q->count > 1 ? q->look[q->count - 2].time : found->time;
    return close_in(q, 1.0, fmax(low, begin), begin, 0.01, found, error);
}

/* Where the most is below a limit: the time from which on it is there, which may be long before the
 * look that came upon it. */
static gneiss_status find_begin(const looks *q, look *found, gneiss_error *error) {
    const double almost = 0.999, most = found->share;
    double before = 0.0;
    if (!(most > 0.0) || most >= 1.0 || found->time == 0.0) return GNEISS_OK;
    for (size_t k = 0; k < q->count && q->look[k].time < found->time; k++) before = q->look[k].time;
    GN_TRY(close_in(q, almost * most, before, before, 0.01, found, error));
    found->share = most;
    return GNEISS_OK;
}

/* How far the load goes on growing behind the first limit, over it. */
static gneiss_status find_reach(const looks *q, const look *found, double *reach,
                                gneiss_error *error) {
    const gn_course *c = &q->rest->course;
    look end;
    *reach = 1.0;
    for (size_t part = found->part; part < c->count && found->share >= 1.0; part++) {
        GN_TRY(look_at(q, part, c->part[part].end, &end, error));
        *reach = fmax(*reach, end.share);
    }
    return GNEISS_OK;
}

/* --- what a conversion makes of the step --- */

/* Elements that are loaded to `least` of a limit or more go. */
static gneiss_status convert(gn_world *w, double least, gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    bool any = false;
    gneiss_status status =
        gn_conversion_look_around(&w->ctx, &w->solids, &w->most_loaded, &kind, &excess, error);
    for (size_t e = 0; status == GNEISS_OK && e < gn_conversion_elements(&w->solids); e++)
        if (kind[e] == GN_FRONT_READY && excess[e] > 0.0 && excess[e] >= least) {
            kind[e] = GN_FRONT_LEAVING;
            any = true;
        }
    if (any) status = gn_conversion_convert(w, kind, error);
    gn_free(kind);
    gn_free(excess);
    return status;
}

static gneiss_status find_most(const gn_step_context *ctx, const gn_solids *solids,
                               const gn_most_loaded *most_loaded, double *most,
                               gneiss_error *error) {
    uint8_t *kind;
    double *excess;
    size_t at;
    gneiss_status status =
        gn_conversion_look_around(ctx, solids, most_loaded, &kind, &excess, error);
    *most = status == GNEISS_OK ? largest(solids, excess, &at) : 0.0;
    gn_free(kind);
    gn_free(excess);
    return status;
}

static bool is_near(double a, double b) {
    return a < INFINITY && b < INFINITY && fabs(a - b) <= 1e-3 * b;
}

static const char by_collisions[] = "collisions";

static const char *side_of(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                           const gn_zones *zones) {
    const double share = gn_world_nonviscous_share(ctx), elements = gn_elements_stable(solids);
    const int32_t p = dem->limit.sharp_id;
    if (is_near(ctx->dt, dem->resolution.step)) return by_collisions;
    if (is_near(ctx->dt, 0.98 * dem->listed)) return "contacts that may close";
    if (ctx->stable < 0.9 * share * fmin(elements, dem->stable)) return "slaved spins of the zone";
    if (elements <= dem->stable) return "elements that are left, by their rigorous bound";
    return p >= 0 && gn_coupled_has(zones->coupled, p) ? "particles of the zone" : "particles";
}

static gneiss_status keep_places(const gn_solids *solids, gn_foreseen *f, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const size_t size = 4 * b->nodes.soa.count;
    f->place = gn_alloc_array_raw(size + 1, sizeof *f->place);
    if (!f->place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for places of nodes");
    memcpy(f->place, b->nodes.pos, size * sizeof *f->place);
    return GNEISS_OK;
}

/* Of all particles, as if they were awake. */
static gneiss_status find_all(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    gn_resolution collision;
    GN_TRY(gn_conversion_limit(w, &f->all, error));
    gn_conversion_turn_over(&w->ctx, &w->dem);
    gneiss_status status = gn_resolution_listed(&w->ctx, &w->dem, &w->boundary, &w->solids,
                                                &w->zones, &collision, error);
    gn_conversion_turn_over(&w->ctx, &w->dem);
    f->collision = collision.step;
    return status;
}

static gneiss_status keep_found(gn_rest *r, const look *found, gn_foreseen *f,
                                gneiss_error *error) {
    if (!(found->share > 0.0)) return GNEISS_OK;
    gn_rest_find(r, found->part, found->time);
    gn_rest_put(r, found->share >= 1.0 ? 1.001 / found->share : small_part);
    GN_TRY(keep_places(&r->w->solids, f, error));
    f->period = gn_rest_period(r);
    return gn_rest_burst(r, &f->burst, error);
}

static gneiss_status foresee(gn_rest *r, gn_foreseen *f, gneiss_error *error) {
    looks q = {.rest = r};
    look found = {0};
    gneiss_status status = look_through(&q, error);
    if (status == GNEISS_OK) status = find_limit(&q, &found, error);
    if (status == GNEISS_OK) status = find_begin(&q, &found, error);
    if (status == GNEISS_OK) status = find_rise(&q, &found, &f->rise, error);
    if (status == GNEISS_OK) status = find_reach(&q, &found, &f->reach, error);
    if (status == GNEISS_OK) status = keep_found(r, &found, f, error);
    gn_free(q.look);
    f->time = found.share >= 1.0 ? found.time : (double)INFINITY;
    f->stage = found.part;
    f->most = found.share;
    return status;
}

gneiss_status gn_conversion_foresee(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    gn_rest r = {0};
    *f = (gn_foreseen){.time = INFINITY};
    GN_TRY(find_all(w, f, error));
    GN_TRY(gn_course_make(w, GN_SETTLING * gn_wave_travel(&w->ctx, &w->solids), &f->course, error));
    gneiss_status status = gn_rest_make(w, &f->course, &r, error);
    if (status == GNEISS_OK) status = foresee(&r, f, error);
    if (status == GNEISS_OK) gn_rest_put(&r, 0.0);
    gn_rest_free(&r);
    return status;
}

static void note(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                 const gn_zones *zones, gn_foreseen_step *s) {
    *s = (gn_foreseen_step){.dt = ctx->dt,
                            .elements = gn_conversion_elements(solids),
                            .side = side_of(ctx, dem, solids, zones)};
}

/* What a crack wakes on its way are more particles, of which any may be the fastest: of all of them
 * none makes the step shorter than this. */
static void note_least(const gn_step_context *ctx, gn_foreseen *f) {
    const double all = gn_world_nonviscous_share(ctx) * ctx->scene.safety * f->all.sharp;
    if (f->grown.dt > f->first.dt) f->grown = f->first; /* it never rises while a run goes on */
    f->least = f->grown;
    if (ctx->scene.step > 0.0 || fmin(all, f->collision) >= f->least.dt) return;
    f->least.dt = fmin(all, f->collision);
    f->least.side = all <= f->collision ? "particles" : by_collisions;
}

/* Nodes where they were solved for. */
static void put_nodes(const gn_solids *solids, gn_most_loaded *most_loaded, gn_ending *outcome,
                      const gn_foreseen *f) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    memcpy(b->nodes.pos, f->place, 4 * b->nodes.soa.count * sizeof *f->place);
    gn_fem_positions_changed(b);
    gn_fem_to_single(b);
    most_loaded->share = 0.0; /* all is to be looked at, however little it is loaded */
    *outcome->halt = '\0';
}

/* *halt: why the run would end there. A given step that particles do not bear is such a reason. */
static gneiss_status try_first(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    put_nodes(&w->solids, &w->most_loaded, &w->outcome, f);
    GN_TRY(find_most(&w->ctx, &w->solids, &w->most_loaded, &f->most_then, error));
    /* Waves may have been faster. */
    if (gn_conversion_begun(&w->solids)) return GNEISS_OK;
    const gneiss_status status = convert(w, f->most_then, error);
    snprintf(f->halt, sizeof f->halt, "%.400s",
             status == GNEISS_ERROR_UNSTABLE ? error->message : w->outcome.halt);
    return status == GNEISS_ERROR_UNSTABLE ? GNEISS_OK : status;
}

enum { FRONTS = 40 };
static const double next_front = 0.94, some_part = 0.7;

/* Front by front, as the load grows: from what is loaded to a part of the most to the least. Where
 * one would end the run no more is known. */
static gneiss_status follow_fronts(gn_world *w, gn_foreseen *f, double least, gneiss_error *error) {
    while (f->fronts < FRONTS && f->part * next_front >= least && !*f->stop) {
        f->part *= next_front;
        f->fronts++;
        const gneiss_status status = convert(w, f->part * f->most_then, error);
        if (status != GNEISS_OK && status != GNEISS_ERROR_UNSTABLE) return status;
        snprintf(f->stop, sizeof f->stop, "%.400s",
                 status == GNEISS_OK ? w->outcome.halt : error->message);
        if (!*f->stop) note(&w->ctx, &w->dem, &w->solids, &w->zones, &f->grown);
    }
    *w->outcome.halt = '\0';
    return GNEISS_OK;
}

/* What later stages make of the step: one that they give or choose otherwise. Where one does not
 * hold, the run says so. */
static gneiss_status follow_stages(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    for (size_t k = f->stage; k < f->course.count; k++) {
        const gneiss_status status = k > w->stages.now ? gn_world_enter(w, k, error) : GNEISS_OK;
        if (status == GNEISS_ERROR_MEMORY) return status;
        f->course.part[k].later = status == GNEISS_OK ? w->ctx.dt : f->course.part[k].dt;
    }
    return GNEISS_OK;
}

gneiss_status gn_conversion_try(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    if (f->stage > w->stages.now) GN_TRY(gn_world_enter(w, f->stage, error));
    GN_TRY(try_first(w, f, error));
    if (*f->halt) return GNEISS_OK;
    note(&w->ctx, &w->dem, &w->solids, &w->zones, &f->first);
    f->grown = f->first;
    f->part = 1.0;
    return follow_fronts(w, f, some_part, error);
}

gneiss_status gn_conversion_try_more(gn_world *w, gn_foreseen *f, gneiss_error *error) {
    const size_t some = f->grown.elements;
    put_nodes(&w->solids, &w->most_loaded, &w->outcome, f);
    GN_TRY(follow_fronts(w, f, 1.0 / f->reach, error));
    note_least(&w->ctx, f);
    f->some = some;
    return follow_stages(w, f, error);
}

void gn_foreseen_free(gn_foreseen *f) {
    gn_free(f->place);
    gn_course_free(&f->course);
    f->place = NULL;
}
