/* Problems of a cutting test that are known before it runs: its tool, its path and its numbers. */
#include "laboratory/cutting.h"

#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "surfaces/body_shape.h"

#include <math.h>
#include <stdio.h>

/* Largest number of stages through which a prescribed motion is followed. */
enum { STAGES_FOLLOWED = 64 };

typedef struct cut {
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_boundary *boundary;
    const gn_cutting *state;
    const gn_body_def *def;
    size_t tool;
    int axis, normal, side;
    gn_place_text place; /* place of the section `test` */
} cut;

static cut cut_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                  const gn_cutting *c) {
    const gn_test *t = &ctx->scene.test;
    const size_t tool = (size_t)gn_scene_find_body(&ctx->scene, t->tool);
    return (cut){.ctx = ctx,
                 .dem = dem,
                 .boundary = boundary,
                 .state = c,
                 .def = &ctx->scene.bodies[tool],
                 .tool = tool,
                 .axis = (int)t->axis,
                 .normal = (int)t->normal,
                 .side = 3 - (int)t->axis - (int)t->normal,
                 .place = gn_scene_at(&ctx->scene, t->where, "test")};
}

/* --- depth --- */

/* Finds the extent of the tool along an axis at its start, m. */
static void extent_at_start(const cut *q, int axis, double *low, double *high) {
    const gn_rigid *body = &q->boundary->bodies[q->tool];
    size_t first = 0;
    double corner[3];
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t k = 0; k < q->tool; k++) first += (size_t)q->boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)q->boundary->body_shape[q->tool][0]; n++) {
        gn_rigid_place(body, q->boundary->body_vertex + 4 * n, corner);
        const double at = corner[axis] - body->position[axis] + body->start[axis];
        *low = fmin(*low, at);
        *high = fmax(*high, at);
    }
}

double gn_cutting_depth_at_start(const gn_step_context *ctx, const gn_boundary *boundary,
                                 const gn_cutting *c) {
    const cut q = cut_of(ctx, NULL, boundary, c);
    double low, high;
    extent_at_start(&q, q.normal, &low, &high);
    return c->outward > 0.0 ? c->surface - low : high - c->surface;
}

static const char *side_of(double depth) {
    return depth < 0.0 ? "above" : "below";
}

bool gn_cutting_depth_differs(const gn_step_context *ctx, const double depth[2], char *text,
                              size_t size) {
    const double given = ctx->scene.test.given.depth, limit = 0.05 * given;
    const char *place = gn_scene_at(&ctx->scene, ctx->scene.test.where, "test").text;
    if (!(fabs(depth[0] - given) > limit || fabs(depth[1] - given) > limit)) return false;
    if (fabs(depth[1] - depth[0]) > 0.01 * given)
        snprintf(text, size,
                 "%s: depth is %.4g m, the tool is %.4g m %s the surface of the rock where means "
                 "begin and %.4g m %s it where they end: specific_energy and predictions refer to "
                 "depth",
                 place, given, fabs(depth[0]), side_of(depth[0]), fabs(depth[1]),
                 side_of(depth[1]));
    else
        snprintf(text, size,
                 "%s: depth is %.4g m, the tool begins %.4g m %s the surface of the rock", place,
                 given, fabs(depth[0]), side_of(depth[0]));
    return true;
}

/* The prescribed motion of the tool up to a time. */
typedef struct course {
    double start[STAGES_FOLLOWED]; /* s, starts of the stages */
    double came, rise;             /* m, path along the cut, and displacement out of the rock */
} course;

/* Follows the motion that a scene prescribes until the tool has moved by `path` or the time ends.
 */
static void follow_scene(const cut *q, const gn_scene *scene, double from, double to, double path,
                         course *c) {
    enum { PARTS = 4000 };
    const gn_table *velocity = scene->bodies[q->tool].motion.velocity;
    const double part = (to - from) / PARTS;
    for (int k = 0; k < PARTS && c->came < path; k++) {
        const double begin = from + k * part, end = from + (k + 1) * part;
        c->came += q->state->direction * gn_table_between(velocity + q->axis, begin, end);
        c->rise += q->state->outward * gn_table_between(velocity + q->normal, begin, end);
    }
}

/* Sets the start of a table: times in a table that a stage gives count from the start of the stage.
 */
static void start_table(void *context, gn_table *table) {
    const course *c = context;
    if (table->stage) gn_table_delay(table, c->start[table->stage - 1]);
}

/* Follows the prescribed motion through all stages; returns false if the duration of a stage before
 * the end of that path is unknown. */
static bool follow(const cut *q, double path, course *c) {
    const gn_scene *given = &q->ctx->given;
    *c = (course){0};
    if (!given->stage_count) {
        follow_scene(q, &q->ctx->scene, 0.0, q->ctx->scene.end, path, c);
        return q->state->direction != 0.0;
    }
    if (given->stage_count > STAGES_FOLLOWED || q->state->direction == 0.0) return false;
    for (size_t s = 0; s < given->stage_count && c->came < path; s++) {
        gn_scene stage;
        const bool last = s + 1 == given->stage_count;
        const double length = gn_stage_length(&given->stages[s], q->ctx->dt),
                     end = fmin(given->end, c->start[s] + length);
        if (!last && !isfinite(length)) return false;
        if (gn_scene_stage(given, s, &stage, NULL) != GNEISS_OK) return false;
        gn_scene_tables(&stage, start_table, c);
        follow_scene(q, &stage, c->start[s], end, path, c);
        gn_scene_free(&stage);
        if (!last) c->start[s + 1] = end;
    }
    return true;
}

static bool depth_differs(const cut *q, char *text, size_t size) {
    course at[2];
    double depth[2];
    if ((q->def->free && !q->def->motion.velocity[q->normal].count) ||
        !follow(q, q->state->begin, &at[0]) || !follow(q, q->state->end, &at[1]))
        return false;
    for (int k = 0; k < 2; k++)
        depth[k] = gn_cutting_depth_at_start(q->ctx, q->boundary, q->state) - at[k].rise;
    return gn_cutting_depth_differs(q->ctx, depth, text, size);
}

static bool is_short(const cut *q, char *text, size_t size) {
    course c;
    if (!follow(q, q->state->end, &c)) return false;
    const double came = c.came;
    if (came > (1.0 - 1e-3) * q->state->end) return false;
    snprintf(text, size,
             "%s: until time.end (%g s) the tool moves %.4g m, means are taken from %.4g m to "
             "%.4g m of its path: they will be those of a part of it, or absent",
             q->place.text, q->ctx->scene.end, came, q->state->begin, q->state->end);
    return true;
}

/* --- tool --- */

static bool is_locked(const cut *q, char *text, size_t size) {
    if (!q->def->has_disc_cutter || (q->def->free && !q->def->motion.spin[1].count)) return false;
    snprintf(text, size,
             "%s: the disc cutter '%s' cannot turn about its axis, so that it scrapes (free: true "
             "without motion.wy lets it roll)",
             q->place.text, q->def->name);
    return true;
}

/* Tells whether the axis of a disc cutter, which is y turned by its rotation, is not across the
 * cut. */
static bool is_skew(const cut *q, char *text, size_t size) {
    double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (!q->def->has_disc_cutter || q->ctx->scene.dimension == 2) return false;
    if (q->def->has_rotation) gn_rotation_matrix(q->def->rotation, m);
    const double across = fmin(1.0, fabs(m[3 * q->side + 1]));
    if (across > 0.9) return false;
    snprintf(text, size,
             "%s: the axis of the disc cutter '%s' is %.0f degrees off %c, the direction across "
             "the cut, so that it does not roll along the cut (rotation turns it)",
             q->place.text, q->def->name, acos(across) * 180.0 / M_PI, "xyz"[q->side]);
    return true;
}

static bool is_beside(const cut *q, char *text, size_t size) {
    double low, high;
    const int a = q->side;
    if (q->ctx->scene.dimension == 2) return false;
    extent_at_start(q, a, &low, &high);
    const double least = q->ctx->lower[a], most = q->ctx->upper[a];
    if (high > least && low < most) return false;
    snprintf(text, size,
             "%s: the tool '%s' passes beside the rock: along %c it is from %.4g m to %.4g m, the "
             "particles are from %.4g m to %.4g m",
             q->place.text, q->def->name, "xyz"[a], low + q->ctx->scene.origin[a],
             high + q->ctx->scene.origin[a], least + q->ctx->scene.origin[a],
             most + q->ctx->scene.origin[a]);
    return true;
}

static bool is_wide(const cut *q, char *text, size_t size) {
    const double most = 1.5, width = q->ctx->upper[q->side] - q->ctx->lower[q->side],
                 spacing = q->ctx->scene.test.given.spacing,
                 tool = q->def->has_chisel ? q->def->scale * q->def->tool.width : 0.0;
    if (q->ctx->scene.dimension == 2 || fmax(spacing, tool) <= most * width) return false;
    if (spacing > most * width)
        snprintf(text, size,
                 "%s: spacing is %.4g m, the rock is %.4g m wide across the cut: specific_energy "
                 "refers to rock that is not there",
                 q->place.text, spacing, width);
    else
        snprintf(text, size,
                 "%s: the tool '%s' is %.4g m wide, the rock is %.4g m wide across the cut",
                 q->place.text, q->def->name, tool, width);
    return true;
}

/* --- numbers --- */

/* Finds the extent of the part of the tool that is below the surface, or above it by less than
 * `reach`, when the tool is at the depth of the test but otherwise at its start. */
static void extent_in_rock(const cut *q, double reach, double low[3], double high[3]) {
    const gn_rigid *body = &q->boundary->bodies[q->tool];
    const double sink =
        q->ctx->scene.test.given.depth - gn_cutting_depth_at_start(q->ctx, q->boundary, q->state);
    size_t first = 0;
    for (size_t k = 0; k < q->tool; k++) first += (size_t)q->boundary->body_shape[k][0];
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (size_t n = first; n < first + (size_t)q->boundary->body_shape[q->tool][0]; n++) {
        double at[3];
        gn_rigid_place(body, q->boundary->body_vertex + 4 * n, at);
        for (int a = 0; a < 3; a++) at[a] += body->start[a] - body->position[a];
        at[q->normal] -= q->state->outward * sink;
        if (q->state->outward * (at[q->normal] - q->state->surface) > reach) continue;
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], at[a]);
            high[a] = fmax(high[a], at[a]);
        }
    }
}

void gn_cutting_find_track(const gn_step_context *ctx, const gn_boundary *boundary, gn_cutting *c) {
    const cut q = cut_of(ctx, NULL, boundary, c);
    double low[3], high[3];
    extent_in_rock(&q, 0.0, low, high);
    const bool met = low[q.side] <= high[q.side];
    c->track[0] = met ? low[q.side] : 0.0;
    c->track[1] = met ? high[q.side] : 0.0;
}

/* Tells whether a particle lies, at the start, in the section that the tool cuts. */
static bool is_in_track(const cut *q, const double *place) {
    const double radius = place[3],
                 top = q->state->outward * (place[q->normal] - q->state->surface) + radius;
    if (top < -q->ctx->scene.test.given.depth) return false;
    return q->ctx->scene.dimension == 2 || (place[q->side] + radius > q->state->track[0] &&
                                            place[q->side] - radius < q->state->track[1]);
}

double gn_cutting_path_to_held(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_cutting *c) {
    const cut q = cut_of(ctx, dem, boundary, c);
    const gn_particles *particles = &dem->particles;
    double low[3], high[3], least = INFINITY;
    extent_in_rock(&q, 0.0, low, high);
    const double front = c->direction > 0.0 ? high[q.axis] : -low[q.axis];
    for (size_t p = 0; p < particles->soa.count && dem->prescribed.count; p++) {
        const int32_t slot = particles->slot[p];
        const double *place = particles->start + 4 * p;
        const double ahead = c->direction * place[q.axis] - front;
        if (slot < 0 || !(dem->prescribed.mask[slot] & 1u << q.axis)) continue;
        if (ahead > 0.0 && is_in_track(&q, place)) least = fmin(least, ahead - place[3]);
    }
    return fmax(0.0, least);
}

static bool is_held(const cut *q, char *text, size_t size) {
    const double held = gn_cutting_path_to_held(q->ctx, q->dem, q->boundary, q->state),
                 least = GN_CUT_DEPTHS_TO_HELD * q->ctx->scene.test.given.depth;
    if (q->state->direction == 0.0 || held - q->state->end >= least * (1.0 - 1e-9)) return false;
    snprintf(text, size,
             "%s: after a path of %.4g m the tool reaches particles that are held along the cut, "
             "and the path of the means ends at %.4g m: nearer to them than %g depths (%.4g m) "
             "rock cannot move away, so that forces rise and the run may fail (a smaller "
             "test.length, or sets that do not hold what is in the way)",
             q->place.text, held, q->state->end, GN_CUT_DEPTHS_TO_HELD, least);
    return true;
}

/* Finds the side of couple.convert.box that the zone around the tool reaches first. Sides at the
 * surface of the body do not count. Returns the path of the tool up to this, m; infinite: there is
 * no such side. */
static double path_in_reserve(const cut *q, int *axis, int *upper) {
    const gn_convert_def *def = &q->ctx->scene.couple.convert;
    const double around = def->near_bodies + def->width;
    double low[3], high[3], least = INFINITY;
    extent_in_rock(q, def->near_bodies, low, high);
    for (int a = 0; a < (int)q->ctx->scene.dimension; a++)
        for (int side = 0; side < 2; side++) {
            const double sign = side ? 1.0 : -1.0, origin = q->ctx->scene.origin[a],
                         box = (side ? def->box_max[a] : def->box_min[a]) - origin,
                         beyond = sign * (q->state->elements[side][a] - box);
            double path = sign * (box - (side ? high[a] : low[a])) - around;
            if (beyond <= 1e-6 * around || (a == q->axis && sign != q->state->direction)) continue;
            if (a != q->axis) path = path < 0.0 ? 0.0 : INFINITY;
            if (path >= least) continue;
            least = path;
            *axis = a;
            *upper = side;
        }
    return least;
}

static bool leaves_reserve(const cut *q, char *text, size_t size) {
    const gn_couple_def *couple = &q->ctx->scene.couple;
    int axis = 0, upper = 0;
    if (!couple->has_convert || !(couple->convert.near_bodies > 0.0) || q->state->direction == 0.0)
        return false;
    const double path = path_in_reserve(q, &axis, &upper);
    if (!(path < q->state->end)) return false;
    snprintf(
        text, size,
        "%s: elements within couple.convert.bodies (%.4g m) of '%s' convert, and their zone of "
        "couple.convert.width (%.4g m) would cross the %s %c side of couple.convert.box after "
        "a path of %.4g m, before means end at %.4g m: the run ends there or sooner; a larger "
        "box with a packing that fills it is needed%s",
        q->place.text, couple->convert.near_bodies, q->def->name, couple->convert.width,
        upper ? "upper" : "lower", "xyz"[axis], fmax(0.0, path), q -> state -> end,
        axis == q -> axis ? ", or a smaller test.length" : "");
    return true;
}

static bool has_odd_values(const cut *q, char *text, size_t size) {
    const gn_test_sizes *t = &q->ctx->scene.test.given;
    const double path = q->state->end - q->state->begin;
    if (t->compressive_strength > 0.0 && t->tensile_strength > t->compressive_strength)
        snprintf(text, size,
                 "%s: compressive_strength is %.4g Pa, below tensile_strength of %.4g Pa",
                 q->place.text, t->compressive_strength, t->tensile_strength);
    else if (path > 0.0 && t->peak_window > path)
        snprintf(text, size,
                 "%s: peak_window is %.4g m, longer than the path of the means of %.4g m: peaks "
                 "will be those means",
                 q->place.text, t->peak_window, path);
    else
        return false;
    return true;
}

static bool is_coarse(const cut *q, char *text, size_t size) {
    const double least = 2.0, depth = q->ctx->scene.test.given.depth;
    const size_t count = q->dem->particles.soa.count;
    double sum = 0.0;
    for (size_t p = 0; p < count; p++) sum += q->dem->particles.pos[4 * p + 3];
    const double diameter = count ? 2.0 * sum / (double)count : 0.0;
    if (!(least * diameter > depth * (1.0 + 1e-9))) return false;
    snprintf(text, size,
             "%s: depth is %.4g m, %.2g mean diameters of particles (%.4g m): grains cannot be "
             "crushed, and below about %g diameters forces depend on their size",
             q->place.text, depth, depth / diameter, diameter, least);
    return true;
}

bool gn_cutting_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_cutting *c, gn_cutting_doubt doubt, char *text, size_t size) {
    static bool (*const applies[GN_CUT_DOUBTS])(const cut *, char *, size_t) = {
        [GN_CUT_LOCKED] = is_locked,    [GN_CUT_SKEW] = is_skew,
        [GN_CUT_BESIDE] = is_beside,    [GN_CUT_WIDE] = is_wide,
        [GN_CUT_HELD] = is_held,        [GN_CUT_VALUES] = has_odd_values,
        [GN_CUT_PARTICLES] = is_coarse, [GN_CUT_RESERVE] = leaves_reserve,
        [GN_CUT_DEPTH] = depth_differs, [GN_CUT_SHORT] = is_short};
    const cut q = cut_of(ctx, dem, boundary, c);
    return applies[doubt](&q, text, size);
}
