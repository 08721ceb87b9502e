#include "laboratory/cutting.h"

#include "base/ball.h"
#include "base/new.h"
#include "base/sort.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/overlap.h"
#include "frame/frame.h"
#include "laboratory/laboratory.h"
#include "particles/fragments.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "surfaces/body_shape.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* Number of steps between two samples of the contacts of the tool. */
enum { SAMPLE_EVERY = 10 };

static size_t tool_of(const gn_step_context *ctx) {
    return (size_t)gn_scene_find_body(&ctx->scene, ctx->scene.test.tool);
}

static const gn_body_def *definition(const gn_step_context *ctx) {
    return &ctx->scene.bodies[tool_of(ctx)];
}

/* Returns the radius of the tool, m; 0: it is no disc cutter. */
static double radius_of(const gn_step_context *ctx) {
    const gn_body_def *def = definition(ctx);
    return def->has_disc_cutter ? 0.5 * def->scale * def->tool.diameter : 0.0;
}

/* Returns the arc of a disc cutter that is in the rock, rad. */
static double arc_of(const gn_step_context *ctx) {
    return acos(fmax(-1.0, 1.0 - ctx->scene.test.given.depth / radius_of(ctx)));
}

/* --- the start --- */

/* Returns the sense of the first velocity along the cut that a scene prescribes; 0: there is none.
 */
static double direction_in(const gn_scene *scene) {
    const gn_body_def *def = &scene->bodies[gn_scene_find_body(scene, scene->test.tool)];
    const gn_table *along = &def->motion.velocity[scene->test.axis];
    for (size_t k = 0; k < along->count; k++)
        if (along->value[k] != 0.0) return copysign(1.0, along->value[k]);
    return 0.0;
}

/* Finds the sense of the first velocity that any stage prescribes. */
static gneiss_status find_direction(const gn_step_context *ctx, double *direction,
                                    gneiss_error *error) {
    *direction = direction_in(&ctx->scene);
    for (size_t k = 1; k < ctx->given.stage_count && *direction == 0.0; k++) {
        gn_scene stage;
        GN_TRY(gn_scene_stage(&ctx->given, k, &stage, error));
        *direction = direction_in(&stage);
        gn_scene_free(&stage);
    }
    return GNEISS_OK;
}

static gneiss_status fail(const gn_step_context *ctx, const char *key, gneiss_error *error,
                          const char *format, ...) __attribute__((format(printf, 4, 5)));
static gneiss_status fail(const gn_step_context *ctx, const char *key, gneiss_error *error,
                          const char *format, ...) {
    char text[256];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s",
                   gn_scene_at(&ctx->scene, ctx->scene.test.where, key).text, text);
}

/* Refuses a path of the means that is empty, or along which the tool leaves the rock or reaches
 * held particles; `held`: they come first. */
static gneiss_status check_path(const gn_step_context *ctx, const gn_cutting *c, double exit,
                                bool held, gneiss_error *error) {
    const char *where =
        held ? "reaches particles that are held along the cut" : "begins to leave the rock";
    if (!(exit > c->begin))
        return fail(ctx, "test.run_in", error,
                    "expected a tool that is in the rock after run_in, found that its contact %s "
                    "after a path of %.6g m, at or before %.6g m",
                    where, fmax(0.0, exit), c->begin);
    if (c->end > exit * (1.0 + 1e-9))
        return fail(ctx, "test.length", error,
                    "expected at most %.6g m, after which the contact of the tool %s, found %.6g m",
                    exit - c->begin, where, c->end - c->begin);
    return GNEISS_OK;
}

/* Finds the path of the means: from where the whole contact is in the particles to where it begins
 * to leave them, or to some depths before held particles that it reaches later, unless the scene
 * gives it. The contact of a disc reaches ahead of its axis. */
static gneiss_status find_path(gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                               gn_cutting *c, gneiss_error *error) {
    const gn_test *t = &ctx->scene.test;
    const int axis = (int)t->axis;
    const double radius = radius_of(ctx), ahead = radius > 0.0 ? radius * sin(arc_of(ctx)) : 0.0,
                 start = boundary->bodies[tool_of(ctx)].start[axis];
    const double entry = c->direction > 0.0 ? ctx->lower[axis] - start : start - ctx->upper[axis];
    const double exit =
        (c->direction > 0.0 ? ctx->upper[axis] - start : start - ctx->lower[axis]) - ahead;
    double held = gn_cutting_path_to_held(ctx, dem, boundary, c);
    c->begin = t->given.run_in > 0.0 ? t->given.run_in : fmax(0.0, entry);
    held = held > c->begin ? held : INFINITY; /* gn_cutting_doubts reports particles before that */
    const double clear = held - GN_CUT_DEPTHS_TO_HELD * t->given.depth;
    c->end = t->given.length > 0.0 ? c->begin + t->given.length
                                   : fmin(exit, clear > c->begin ? clear : held);
    ctx->test_length = c->end;
    return check_path(ctx, c, fmin(exit, held), held < exit, error);
}

static gneiss_status check_inside(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, gneiss_error *error) {
    size_t count, first = 0;
    double place[3];
    GN_TRY(gn_body_holds(dem, boundary, tool_of(ctx), &count, &first, error));
    if (!count) return GNEISS_OK;
    gn_user_point(ctx, dem->particles.pos + 4 * first, place);
    return fail(ctx, "test.tool", error,
                "expected a tool that begins outside of the rock, found %zu particles with their "
                "centres inside '%s', the first one at (%.4g, %.4g, %.4g) m",
                count, ctx->scene.test.tool, place[0], place[1], place[2]);
}

gneiss_status gn_cutting_begin(gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                               const gn_solids *solids, gn_cutting *c, gneiss_error *error) {
    double lower[3], upper[3];
    const int normal = (int)ctx->scene.test.normal;
    if (!gn_scene_test(&ctx->scene)->tool) return GNEISS_OK;
    gn_tested_extent(ctx, solids, lower, upper);
    const double place = boundary->bodies[tool_of(ctx)].start[normal];
    *c = (gn_cutting){.moves = direction_in(&ctx->scene) != 0.0};
    GN_TRY(find_direction(ctx, &c->direction, error));
    for (int a = 0; a < 3 && ctx->scene.has_couple; a++) {
        c->elements[0][a] = INFINITY;
        c->elements[1][a] = -INFINITY;
    }
    if (ctx->scene.has_couple) gn_elements_extent(solids, c->elements[0], c->elements[1]);
    c->outward = place > 0.5 * (lower[normal] + upper[normal]) ? 1.0 : -1.0;
    c->surface = c->outward > 0.0 ? upper[normal] : lower[normal];
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        c->solid += gn_ball_volume((int)ctx->scene.dimension, dem->particles.pos[4 * p + 3]);
    c->loose = c->solid - gn_dem_anchored_volume(ctx, dem);
    GN_TRY(check_inside(ctx, dem, boundary, error));
    gn_cutting_find_track(ctx, boundary, c);
    return c->direction != 0.0 ? find_path(ctx, dem, boundary, c, error) : GNEISS_OK;
}

/* --- path and forces --- */

double gn_cutting_path(const gn_step_context *ctx, const gn_boundary *boundary,
                       const gn_cutting *c) {
    const gn_rigid *b = &boundary->bodies[tool_of(ctx)];
    return c->direction * (b->position[ctx->scene.test.axis] - b->start[ctx->scene.test.axis]);
}

/* Computes the components of a vector in the axes of the tool. The side axis is the vector product
 * of normal and motion. */
static void in_axes(const gn_step_context *ctx, const gn_cutting *c, const double f[3],
                    double out[GN_CUT_AXES]) {
    const int axis = (int)ctx->scene.test.axis, normal = (int)ctx->scene.test.normal,
              side = 3 - axis - normal;
    const double turn = (normal + 1) % 3 == axis ? 1.0 : -1.0;
    out[GN_CUT_NORMAL] = c->outward * f[normal];
    out[GN_CUT_ROLLING] = -c->direction * f[axis];
    out[GN_CUT_SIDE] = turn * c->outward * c->direction * f[side];
}

void gn_cutting_force(const gn_step_context *ctx, const gn_boundary *boundary, const gn_cutting *c,
                      double force[GN_CUT_AXES]) {
    in_axes(ctx, c, boundary->bodies[tool_of(ctx)].force, force);
}

/* Adds the force of a contact of a disc cutter to the bin of its angle. */
static void add_to_rim(const gn_step_context *ctx, const gn_boundary *boundary, size_t k,
                       gn_cutting *c) {
    const gn_wall_contacts *q = &boundary->contacts;
    const double *centre = boundary->bodies[tool_of(ctx)].position;
    const int axis = (int)ctx->scene.test.axis, normal = (int)ctx->scene.test.normal;
    const double *f = q->row + 8 * k, on_tool[3] = {-f[0], -f[1], -f[2]};
    const double along =
                     c->direction * (q->touch[k + (size_t)axis * q->soa.capacity] - centre[axis]),
                 down =
                     c->outward * (centre[normal] - q->touch[k + (size_t)normal * q->soa.capacity]);
    const double bin = (atan2(along, down) / arc_of(ctx) + 0.5) * GN_RIM_BINS_OF_ARC;
    double part[GN_CUT_AXES], *sum = c->rim[(size_t)fmax(0.0, fmin(GN_RIM_BINS - 1.0, floor(bin)))];
    in_axes(ctx, c, on_tool, part);
    for (int a = 0; a < GN_CUT_AXES; a++) sum[a] += part[a];
}

/* Samples the contacts of the tool. Those of a particle with several facets follow each other, and
 * its cross-section (2D: diameter times 1 m) counts once. */
static void sample(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   gn_cutting *c) {
    const gn_wall_contacts *q = &boundary->contacts;
    const size_t walls = ctx->scene.wall_count, tool = tool_of(ctx);
    const bool disc = radius_of(ctx) > 0.0;
    int32_t last = -1;
    for (size_t k = 0; k < q->soa.count; k++) {
        const double *f = q->row + 8 * k;
        if ((size_t)q->wall[k] < walls || !(gn_dot3(f, f) > 0.0)) continue;
        if (gn_surface_of_row(ctx, boundary, k)->body != (int32_t)tool) continue;
        if (disc) add_to_rim(ctx, boundary, k, c);
        if (q->i[k] == last) continue;
        last = q->i[k];
        const double radius = dem->particles.pos[4 * (size_t)last + 3];
        c->touched += ctx->scene.dimension == 2 ? 2.0 * radius : M_PI * radius * radius;
    }
    c->samples += 1.0;
}

void gn_cutting_add(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    gn_cutting *c) {
    double force[GN_CUT_AXES];
    if (c->moves == 0.0 && direction_in(&ctx->scene) != 0.0) {
        c->loose = c->solid - gn_dem_anchored_volume(ctx, dem);
        c->moves = 1.0;
    }
    gn_cutting_force(ctx, boundary, c, force);
    for (int a = 0; a < GN_CUT_AXES; a++) {
        c->seen[a] = c->impulse[a] + 0.5 * ctx->dt_past * force[a];
        c->impulse[a] = c->seen[a] + 0.5 * ctx->dt * force[a];
    }
    if (c->moves == 0.0) return;
    const double path = gn_cutting_path(ctx, boundary, c), place[2] = {c->begin, c->end};
    for (int k = (int)c->reached; k < 2 && path >= place[k]; k++) {
        if (ctx->effects & GN_FX_BONDS) {
            c->removed[k] = gn_cutting_removed(ctx, dem, c);
            c->beside[k] = gn_cutting_beside(ctx, dem, c);
        }
        c->reached = k + 1;
    }
    if (ctx->step % SAMPLE_EVERY == 0 && path >= c->begin && path <= c->end)
        sample(ctx, dem, boundary, c);
}

/* --- volume of the cut --- */

double gn_cutting_removed(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *c) {
    if (!(c->solid > 0.0)) return 0.0;
    const double removed = c->solid - gn_dem_anchored_volume(ctx, dem) - c->loose;
    /* A difference by rounding of the two sums does not count as removed rock. */
    return fmax(0.0, removed - 1e-12 * c->solid) * ctx->volume / c->solid;
}

double gn_cutting_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *c) {
    const int side = 3 - (int)ctx->scene.test.axis - (int)ctx->scene.test.normal;
    if (ctx->scene.dimension == 2 || !(c->solid > 0.0)) return 0.0;
    return gn_dem_loose_volume_outside(ctx, dem, side, c->track[0], c->track[1]) * ctx->volume /
           c->solid;
}

/* Returns the depth, m, at the start above which 95 % of the broken bonds lie; NaN: there are none,
 * or there is no memory. */
static double damage_depth(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *c) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    const size_t normal = (size_t)ctx->scene.test.normal;
    GN_FREED double *depth = NULL;
    size_t count = 0;
    if (!(ctx->effects & GN_FX_BONDS) || !bonds->soa.count ||
        gn_new(&depth, bonds->soa.count, "depths of bonds", NULL) != GNEISS_OK)
        return NAN;
    for (size_t k = 0; k < bonds->soa.count; k++) {
        if (!gn_broken(bonds->cause[k])) continue;
        const double *start = dem->particles.start;
        depth[count++] =
            c->outward * (c->surface - 0.5 * (start[4 * (size_t)bonds->i[k] + normal] +
                                              start[4 * (size_t)bonds->j[k] + normal]));
    }
    return count ? gn_ranked_number(depth, count, (size_t)(0.95 * (double)(count - 1))) : NAN;
}

/* Tells whether a chisel or a wedge cuts in the sense in which its rake angle is given. */
static bool cuts_ahead(const gn_step_context *ctx, const gn_body_def *def, const gn_cutting *c) {
    double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (def->has_rotation) gn_rotation_matrix(def->rotation, m);
    return c->direction * m[3 * ctx->scene.test.axis] > 0.999;
}

gn_cut gn_cutting_describe(const gn_step_context *ctx, const gn_dem *dem, const gn_cutting *c) {
    const gn_test *t = &ctx->scene.test;
    if (!gn_scene_test(&ctx->scene)->tool) return (gn_cut){0};
    const gn_body_def *def = definition(ctx);
    const double scale = def->scale;
    const bool over = c->reached > 1.0;
    const double now[2] = {over ? c->removed[1] : gn_cutting_removed(ctx, dem, c),
                           over ? c->beside[1] : gn_cutting_beside(ctx, dem, c)};
    gn_cut cut = {.depth = t->given.depth,
                  .spacing = t->given.spacing,
                  .begin = c->begin,
                  .end = c->end,
                  .window =
                      t->given.peak_window > 0.0 ? t->given.peak_window : 0.25 * t->given.depth,
                  .blocks = (int)t->blocks,
                  .compressive = t->given.compressive_strength,
                  .tensile = t->given.tensile_strength,
                  .exponent = t->pressure_exponent,
                  .friction = atan(def->friction),
                  .damage_depth = damage_depth(ctx, dem, c),
                  .contact_area = c->touched / c->samples,
                  .removed = now[0] - c->removed[0],
                  .removed_beside = now[1] - c->beside[0]};
    switch (gn_body_tool(def)) {
    case GN_TOOL_DISC_CUTTER:
        cut.tool = GN_CUT_DISC;
        cut.radius = radius_of(ctx);
        cut.tip_width = scale * def->tool.tip_width;
        break;
    case GN_TOOL_CHISEL:
    case GN_TOOL_WEDGE:
        cut.tool = cuts_ahead(ctx, def, c) || def->has_wedge ? GN_CUT_CHISEL : GN_CUT_OTHER;
        cut.rake = def->has_wedge ? -0.5 * def->tool.angle : def->tool.rake;
        cut.width = ctx->scene.dimension == 2 ? 1.0 : scale * def->tool.width;
        break;
    case GN_TOOL_PICK:
        cut.tool = GN_CUT_PICK;
        cut.half_angle = 0.5 * def->tool.angle;
        break;
    case GN_TOOL_NONE:
        break;
    }
    if (ctx->scene.dimension == 2) cut.width = 1.0;
    return cut;
}
