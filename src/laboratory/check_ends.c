/* Checks of the two ends of a test at the start: one below and one above, walls at the specimen,
 * sides of an oedometer. */
#include "base/error.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/acts.h"
#include "scene/laboratory.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"

#include <math.h>
#include <stdio.h>

/* Positions of an end along a direction at the start: centres of particles, nodes, corners of
 * bodies, points of walls across it. */
typedef struct reach {
    double low, high, sum; /* m */
    size_t count;          /* 0: no extent is known */
    bool bodies;           /* the end consists of bodies alone */
} reach;

static void add(reach *r, double x) {
    r->low = fmin(r->low, x);
    r->high = fmax(r->high, x);
    r->sum += x;
    r->count++;
}

static double middle(const reach *r) {
    return r->sum / (double)r->count;
}

static void add_wall(const gn_wall_def *wall, int way, reach *r) {
    if (fabs(wall->normal[way]) > 0.9) add(r, wall->point[way]);
    r->bodies = false;
}

static void add_body(const gn_boundary *boundary, size_t body, int way, reach *r) {
    size_t first = 0;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&boundary->bodies[body], boundary->body_vertex + 4 * n, corner);
        add(r, corner[way]);
    }
}

static void add_set(const gn_step_context *ctx, const gn_dem *dem, size_t set, int way, reach *r) {
    const gn_particles *q = &dem->particles;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_set_selected(ctx, dem, set, p)) add(r, q->start[4 * p + (size_t)way]);
    r->bodies = false;
}

static void add_motion(const gn_solids *solids, size_t motion, int way, reach *r) {
    const gn_particles *nodes;
    const gn_fem_set *set = gn_elements_motion_set(solids, motion, &nodes);
    for (size_t k = 0; k < set->count; k++)
        add(r, nodes->start[4 * (size_t)set->node[k] + (size_t)way]);
    r->bodies = false;
}

static const reach nowhere = {.low = INFINITY, .high = -INFINITY, .bodies = true};

static void add_part(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, const char *name, int way, reach *r) {
    const gn_scene *s = &ctx->scene;
    const int wall = gn_scene_find_wall(s, name), body = gn_scene_find_body(s, name),
              set = gn_scene_find_set(s, name), motion = gn_scene_find_element_motion(s, name);
    if (wall >= 0) add_wall(&s->walls[wall], way, r);
    if (body >= 0) add_body(boundary, (size_t)body, way, r);
    if (set >= 0) add_set(ctx, dem, (size_t)set, way, r);
    if (motion >= 0) add_motion(solids, (size_t)motion, way, r);
}

static reach reach_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids, const gn_test_end *end, int way) {
    reach r = nowhere;
    for (size_t k = 0; k < end->count; k++)
        add_part(ctx, dem, boundary, solids, end->name[k], way, &r);
    return r;
}

/* --- errors --- */

static gneiss_status fail(const gn_step_context *ctx, int way, const reach *lower,
                          const reach *upper, const char *what, gneiss_error *error) {
    const gn_test *t = &ctx->scene.test;
    const double origin = ctx->scene.origin[way];
    const gn_scene_place where = t->upper.where.line ? t->upper.where : t->where;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected an end above the lower one along %c, found %s: lower is at %.4g "
                   "to %.4g m, upper at %.4g to %.4g m",
                   gn_scene_at(&ctx->scene, where, "test.upper").text, "xyz"[way], what,
                   gn_point_out(origin, lower->low), gn_point_out(origin, lower->high),
                   gn_point_out(origin, upper->low), gn_point_out(origin, upper->high));
}

static int64_t shared_particles(const gn_step_context *ctx, const gn_dem *dem, size_t one,
                                size_t other) {
    int64_t shared = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        shared += gn_set_selected(ctx, dem, one, p) && gn_set_selected(ctx, dem, other, p);
    return shared;
}

static int64_t shared_nodes(const gn_solids *solids, size_t one, size_t other) {
    const gn_particles *nodes;
    const gn_fem_set *a = gn_elements_motion_set(solids, one, &nodes),
                     *b = gn_elements_motion_set(solids, other, &nodes);
    int64_t shared = 0;
    for (size_t k = 0, m = 0; k < a->count; k++) {
        while (m < b->count && b->node[m] < a->node[k]) m++;
        shared += m < b->count && b->node[m] == a->node[k];
    }
    return shared;
}

/* Refuses a particle or node that belongs to both ends, because neither would load it. */
static gneiss_status check_shared(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_solids *solids, const char *lower, const char *upper,
                                  gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    int sets[] = {gn_scene_find_set(s, lower), gn_scene_find_set(s, upper)},
        motions[] = {gn_scene_find_element_motion(s, lower),
                     gn_scene_find_element_motion(s, upper)};
    int64_t shared = 0;
    if (sets[0] >= 0 && sets[1] >= 0)
        shared = shared_particles(ctx, dem, (size_t)sets[0], (size_t)sets[1]);
    else if (motions[0] >= 0 && motions[1] >= 0)
        shared = shared_nodes(solids, (size_t)motions[0], (size_t)motions[1]);
    if (!shared) return GNEISS_OK;
    const gn_scene_place where = s->test.upper.where.line ? s->test.upper.where : s->test.where;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected another part of the specimen than the lower end, found '%s' and "
                   "'%s' with %lld %s in common",
                   gn_scene_at(s, where, "test.upper").text, lower, upper, (long long)shared,
                   sets[0] >= 0 ? "particles" : "nodes");
}

static bool at_one_height(const gn_step_context *ctx, int way, const reach *lower,
                          const reach *upper) {
    return fabs(middle(upper) - middle(lower)) < (ctx->upper[way] - ctx->lower[way]) / 3.0;
}

/* Tells whether neither end is above the other and both are in the same outer third of the
 * specimen. */
static bool on_one_side(const gn_step_context *ctx, int way, const reach *lower,
                        const reach *upper) {
    const double low = ctx->lower[way], high = ctx->upper[way], third = (high - low) / 3.0;
    const double l = middle(lower), u = middle(upper);
    return u <= lower->high && l >= upper->low &&
           ((l < low + third && u < low + third) || (l > high - third && u > high - third));
}

/* Tells whether an end is below or above the whole specimen. */
static bool beside(const gn_step_context *ctx, int way, const reach *r) {
    return r->bodies && (r->high <= ctx->lower[way] || r->low >= ctx->upper[way]);
}

/* Bits of a set of faces: the lower and the upper one. */
enum { LOWER_FACE = 1, UPPER_FACE = 2 };

/* Returns the faces across a direction at which a part of an end is: the part is in the outer
 * third, and at least as far out as the outermost particles there. */
static int face_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids, int way, const char *name) {
    const double low = ctx->lower[way], high = ctx->upper[way], third = (high - low) / 3.0,
                 slack =
                     dem->particles.soa.count ? 2.0 * gn_dem_mean_radius(dem) : 1e-6 * (high - low);
    reach r = nowhere;
    add_part(ctx, dem, boundary, solids, name, way, &r);
    if (!r.count) return 0;
    return (r.low <= low + slack && r.high < low + third ? LOWER_FACE : 0) |
           (r.high >= high - slack && r.low > high - third ? UPPER_FACE : 0);
}

/* Tells whether all parts of both ends are at the same face, with nothing between them. */
static bool on_one_face(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, int way) {
    const gn_test_end *ends[] = {&ctx->scene.test.lower, &ctx->scene.test.upper};
    int faces = LOWER_FACE | UPPER_FACE;
    for (int e = 0; e < 2; e++)
        for (size_t k = 0; k < ends[e]->count; k++)
            faces &= face_of(ctx, dem, boundary, solids, way, ends[e]->name[k]);
    return faces != 0;
}

/* Returns the error in the positions of the ends. Those of a general test may bend a beam
 * transversely or pull an inclusion out, so that they are refused only if they are upside down, at
 * the same face, or press from one side alone. */
static const char *wrong(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_solids *solids, int way, const reach *lower, const reach *upper) {
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    if (d->beam && at_one_height(ctx, way, lower, upper) &&
        gn_bending_outside(ctx, dem, boundary, solids))
        return "supports and load side by side along the beam";
    if (upper->high < lower->low) return "them the other way round";
    if (!d->general && on_one_side(ctx, way, lower, upper))
        return "both on one side of the specimen";
    if (on_one_face(ctx, dem, boundary, solids, way)) return "both at one face of the specimen";
    const bool pressed = d->sign < 0 && beside(ctx, way, lower) && beside(ctx, way, upper);
    if (pressed && (middle(lower) > ctx->lower[way]) == (middle(upper) > ctx->lower[way]))
        return "both on one side of the specimen";
    return NULL;
}

/* Tells whether a wall other than the ends touches the specimen and presses on it, or is fixed. */
static bool wall_bears(const gn_step_context *ctx, const gn_dem *dem, size_t wall, double sense) {
    const gn_scene *s = &ctx->scene;
    const gn_wall_def *def = &s->walls[wall];
    const int way = (int)s->test.normal;
    const double face = sense < 0.0 ? ctx->upper[way] : ctx->lower[way];
    if (!(sense * def->normal[way] > 0.9)) return false;
    return def->servo.active || fabs(def->point[way] - face) < gn_dem_mean_radius(dem);
}

/* Tells whether walls can load the end: it is neither held nor pressed, and there are particles,
 * because only they touch walls. */
static bool walls_bear(const gn_step_context *ctx, const gn_dem *dem) {
    bool below = gn_scene_end_has_normal_load(&ctx->scene, &ctx->scene.test.lower),
         above = gn_scene_end_has_normal_load(&ctx->scene, &ctx->scene.test.upper);
    for (size_t k = 0; dem->particles.soa.count && k < ctx->scene.wall_count; k++) {
        below = below || wall_bears(ctx, dem, k, 1.0);
        above = above || wall_bears(ctx, dem, k, -1.0);
    }
    return below && above;
}

bool gn_shear_is_unsupported(const gn_step_context *ctx, const gn_dem *dem, char *text,
                             size_t size) {
    const gn_test *t = &ctx->scene.test;
    if (!gn_scene_shear_ends_may_separate(&ctx->scene) || walls_bear(ctx, dem)) return false;
    snprintf(text, size,
             "%s: nothing presses the ends together along %c, and one of them is free there: the "
             "strength is that without a normal stress (a force of its set, a wall with a servo "
             "or, for a constant height, v%c: 0)",
             gn_scene_at(&ctx->scene, t->where, "test").text, "xyz"[t->normal], "xyz"[t->normal]);
    return true;
}

gneiss_status gn_ends_check(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            gneiss_error *error) {
    const gn_test *t = &ctx->scene.test;
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    const int way = (int)(d->sheared ? t->normal : t->axis);
    if (!d->ends) return GNEISS_OK;
    for (size_t k = 0; k < t->lower.count; k++)
        for (size_t m = 0; m < t->upper.count; m++)
            GN_TRY(check_shared(ctx, dem, solids, t->lower.name[k], t->upper.name[m], error));
    const reach lower = reach_of(ctx, dem, boundary, solids, &t->lower, way),
                upper = reach_of(ctx, dem, boundary, solids, &t->upper, way);
    if (!lower.count || !upper.count) return GNEISS_OK;
    const char *what = wrong(ctx, dem, boundary, solids, way, &lower, &upper);
    return what ? fail(ctx, way, &lower, &upper, what, error) : GNEISS_OK;
}

/* --- walls that are ends of a test, relative to the specimen at the start --- */

/* A flat removes little of a disc: one of 30 degrees removes 1.7 % of the diameter. */
static const double deep = 0.025, far = 0.1, tilted = 2.0; /* shares of the extent, degrees */

static int way_of(const gn_step_context *ctx) {
    return (int)ctx->scene.test.axis;
}

/* Returns the component along the axis of the mean normal of an end's walls; 1: there are none. */
static double cosine_of(const gn_step_context *ctx, const gn_test_end *end) {
    double sum[3] = {0.0};
    size_t walls = 0;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(&ctx->scene, end->name[k]);
        for (int a = 0; wall >= 0 && a < 3; a++) sum[a] += ctx->scene.walls[wall].normal[a];
        walls += wall >= 0;
    }
    const double length = sqrt(gn_dot3(sum, sum));
    return walls && length > 0.0 ? fmin(1.0, fabs(sum[way_of(ctx)]) / length) : 1.0;
}

/* Returns the depth, m, of a wall inside the specimen; negative: it is outside. */
static double depth_of(const gn_step_context *ctx, const gn_wall_def *wall) {
    const int way = way_of(ctx);
    return wall->normal[way] > 0.0 ? wall->point[way] - ctx->lower[way]
                                   : ctx->upper[way] - wall->point[way];
}

/* Tells whether a wall may come into contact later: the specimen falls or flows in, or the wall has
 * a stage or a servo. */
static bool may_come(const gn_step_context *ctx, const gn_wall_def *wall) {
    const gn_scene *s = &ctx->scene;
    return wall->servo.active || s->source_count || gn_dot3(s->gravity, s->gravity) > 0.0;
}

static bool doubt_of_wall(const gn_step_context *ctx, const gn_dem *dem, const gn_wall_def *wall,
                          char *text, size_t size) {
    const int way = way_of(ctx);
    const double extent = ctx->upper[way] - ctx->lower[way], depth = depth_of(ctx, wall),
                 radius = dem->particles.soa.count ? gn_dem_mean_radius(dem) : 0.0;
    const bool inside = depth > fmax(deep * extent, radius),
               outside = -depth > fmax(far * extent, radius) && !may_come(ctx, wall);
    if (fabs(wall->normal[way]) <= 0.9 || (!inside && !outside)) return false;
    snprintf(text, size,
             "wall '%.60s', an end, begins %.4g m %s the specimen, which is %.4g m long along %c",
             wall->name, fabs(depth), inside ? "inside" : "away from", extent, "xyz"[way]);
    return true;
}

static bool doubt_of_end(const gn_step_context *ctx, const gn_dem *dem, const gn_test_end *end,
                         char *text, size_t size) {
    const double tilt = acos(cosine_of(ctx, end)) * 180.0 / M_PI;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(&ctx->scene, end->name[k]);
        if (wall < 0) continue;
        if (doubt_of_wall(ctx, dem, &ctx->scene.walls[wall], text, size)) return true;
        if (tilt <= tilted) continue;
        snprintf(text, size,
                 "wall '%.60s', an end, is tilted by %.3g degrees against the axis of the test, %c",
                 end->name[k], tilt, "xyz"[way_of(ctx)]);
        return true;
    }
    return false;
}

bool gn_ends_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    char *text, size_t size) {
    const gn_test *t = &ctx->scene.test;
    const gn_test_end *ends[] = {&t->lower, &t->upper};
    char doubt[240];
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    if (!d->ends || d->sign > 0 || d->beam) return false;
    /* An unbonded initial state becomes a different specimen if stages bond it. */
    if (ctx->given.stage_count && ctx->given.bonds != GN_SWITCH_ON) return false;
    /* If there are particles and elements, either may be the specimen. */
    if (!dem->particles.soa.count == !solids->count) return false;
    for (int e = 0; e < 2; e++) {
        if (!doubt_of_end(ctx, dem, ends[e], doubt, sizeof doubt)) continue;
        const gn_scene_place where = ends[e]->where.line ? ends[e]->where : t->where;
        snprintf(text, size, "%s: %s",
                 gn_scene_at(&ctx->scene, where, e ? "test.upper" : "test.lower").text, doubt);
        return true;
    }
    return false;
}

/* --- walls at both sides of the specimen of an oedometer --- */

/* A wall whose distance from the specimen exceeds this share of the specimen's width, or a
 * particle, does not hold it. */
static const double near_by = 0.1;

static double reach_beside(const gn_step_context *ctx, const gn_dem *dem, int a) {
    const double share = near_by * (ctx->upper[a] - ctx->lower[a]);
    return dem->particles.soa.count ? fmax(share, 2.0 * gn_dem_mean_radius(dem)) : share;
}

/* Returns the face of the specimen at a side; `sense` -1: the lower side, +1: the upper one. */
static double face(const gn_step_context *ctx, int a, int sense) {
    return sense < 0 ? ctx->lower[a] : ctx->upper[a];
}

static bool wall_beside(const gn_step_context *ctx, const gn_dem *dem, size_t wall, int a,
                        int sense) {
    const gn_wall_def *def = &ctx->scene.walls[wall];
    const gn_particles *q = &dem->particles;
    double gap = INFINITY;
    if (!gn_scene_wall_is_fixed(&ctx->scene, wall, a) || -sense * def->normal[a] <= 0.1)
        return false;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3];
        for (int b = 0; b < 3; b++) d[b] = q->pos[4 * p + b] - def->point[b];
        gap = fmin(gap, gn_dot3(d, def->normal) - q->pos[4 * p + 3]);
    }
    if (!q->soa.count) gap = sense * (def->point[a] - face(ctx, a, sense));
    return gap <= reach_beside(ctx, dem, a);
}

static bool body_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t body, int a, int sense) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t first = 0;
    if (!gn_scene_body_is_fixed(&ctx->scene, body, a)) return false;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&boundary->bodies[body], boundary->body_vertex + 4 * n, corner);
        for (int b = 0; b < 3; b++) low[b] = fmin(low[b], corner[b]);
        for (int b = 0; b < 3; b++) high[b] = fmax(high[b], corner[b]);
    }
    const double at = face(ctx, a, sense);
    bool beside =
        low[a] <= at + reach_beside(ctx, dem, a) && high[a] >= at - reach_beside(ctx, dem, a);
    for (int b = 0; b < (int)ctx->scene.dimension; b++)
        beside = beside && low[b] <= ctx->upper[b] + reach_beside(ctx, dem, b) &&
                 high[b] >= ctx->lower[b] - reach_beside(ctx, dem, b);
    return beside;
}

static bool at_face(const gn_step_context *ctx, const gn_dem *dem, double x, int a, int sense) {
    return sense * (face(ctx, a, sense) - x) <= reach_beside(ctx, dem, a);
}

static bool set_beside(const gn_step_context *ctx, const gn_dem *dem, size_t set, int a,
                       int sense) {
    const gn_particles *q = &dem->particles;
    bool beside = false;
    if (!gn_scene_set_is_fixed(&ctx->scene, set, a)) return false;
    for (size_t p = 0; p < q->soa.count; p++)
        beside = beside || (gn_set_selected(ctx, dem, set, p) &&
                            at_face(ctx, dem, q->start[4 * p + a], a, sense));
    return beside;
}

static bool motion_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          size_t motion, int a, int sense) {
    const gn_particles *nodes;
    const gn_fem_set *set = gn_elements_motion_set(solids, motion, &nodes);
    bool beside = false;
    if (!gn_scene_motion_is_fixed(&ctx->scene, motion, a)) return false;
    for (size_t k = 0; k < set->count; k++)
        beside = beside ||
                 at_face(ctx, dem, nodes->start[4 * (size_t)set->node[k] + (size_t)a], a, sense);
    return beside;
}

static bool held_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, int a, int sense) {
    const gn_scene *s = &ctx->scene;
    bool held = false;
    for (size_t k = 0; !held && k < s->wall_count; k++) held = wall_beside(ctx, dem, k, a, sense);
    for (size_t k = 0; !held && k < s->body_count; k++)
        held = body_beside(ctx, dem, boundary, k, a, sense);
    for (size_t k = 0; !held && k < s->set_count; k++) held = set_beside(ctx, dem, k, a, sense);
    for (size_t k = 0; !held && k < s->elements.motion_count; k++)
        held = motion_beside(ctx, dem, solids, k, a, sense);
    return held;
}

gneiss_status gn_sides_check(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids,
                             gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    /* Stages may move sides closer; with particles, elements may be the sides. */
    if (!gn_scene_test(s)->sides_stand || s->stage_count || s->source_count ||
        (s->has_specimen && solids->count))
        return GNEISS_OK;
    for (int a = 0; a < (int)s->dimension; a++)
        for (int sense = -1; sense <= 1; sense += 2) {
            if (a == s->test.axis || gn_scene_periodic_along(s, a) ||
                held_beside(ctx, dem, boundary, solids, a, sense))
                continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected something that stands beside the specimen of an %s "
                           "test at its %s side along %c, %.4g m (a wall, a body, a set that is "
                           "held there), found none within %.2g m",
                           gn_scene_at(s, s->test.where, "test.kind").text, gn_scene_test(s)->name,
                           sense < 0 ? "lower" : "upper", "xyz"[a],
                           gn_point_out(s->origin[a], face(ctx, a, sense)),
                           reach_beside(ctx, dem, a));
        }
    return GNEISS_OK;
}
