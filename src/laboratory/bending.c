
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "laboratory/laboratory.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/solids.h"

#include <math.h>
#include <stdio.h>

/* Relative tolerance. It is small because stress is proportional to the span, and inversely
 * proportional to the thickness and to the square of the height. */
static const double tolerance = 0.01;

/* Positions along the beam of the parts of an end: of all parts, and of those on either side of
 * their middle. */
typedef struct places {
    bool known; /* a wall has no position along itself */
    double low, high, left_high, right_low;
} places;

typedef struct visit {
    places *into;
    bool sides; /* the middle is known, so that parts are sorted by side */
    double middle;
} visit;

static void add(const visit *v, double centre, double reach) {
    places *p = v->into;
    double low = centre - reach, high = centre + reach;
    if (!v->sides) {
        p->low = fmin(p->low, low);
        p->high = fmax(p->high, high);
        p->known = true;
    } else if (centre < v->middle) {
        p->left_high = fmax(p->left_high, high);
    } else {
        p->right_low = fmin(p->right_low, low);
    }
}

static void visit_set(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t axis,
                      const visit *v) {
    const gn_particles *q = &dem->particles;
    for (size_t p = 0; p < q->soa.count; p++)
        if (gn_set_selected(ctx, dem, set, p)) add(v, q->start[4 * p + axis], q->pos[4 * p + 3]);
}

static void visit_motion(const gn_solids *solids, size_t motion, size_t axis, const visit *v) {
    const gn_particles *nodes;
    const gn_fem_set *set = gn_elements_motion_set(solids, motion, &nodes);
    for (size_t k = 0; k < set->count; k++)
        add(v, nodes->start[4 * (size_t)set->node[k] + axis], 0);
}

/* The position of a body along the beam is that of its reference point, plus and minus its reach,
 * whatever its orientation. */
static void visit_body(const gn_boundary *boundary, size_t body, size_t axis, const visit *v) {
    size_t first = 0;
    double reach = 0.0;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        const double *x = boundary->body_vertex + 4 * n;
        reach = fmax(reach, sqrt(gn_dot3(x, x)));
    }
    add(v, boundary->bodies[body].start[axis], reach);
}

/* Visits the parts of an end; returns false if one of them is a wall. */
static bool visit_end(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids, const gn_test_end *end, size_t axis,
                      const visit *v) {
    const gn_scene *s = &ctx->scene;
    for (size_t k = 0; k < end->count; k++) {
        int set = gn_scene_find_set(s, end->name[k]), body = gn_scene_find_body(s, end->name[k]),
            motion = gn_scene_find_element_motion(s, end->name[k]);
        if (set >= 0)
            visit_set(ctx, dem, (size_t)set, axis, v);
        else if (motion >= 0)
            visit_motion(solids, (size_t)motion, axis, v);
        else if (body >= 0)
            visit_body(boundary, (size_t)body, axis, v);
        else
            return false;
    }
    return true;
}

static places places_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, const gn_test_end *end, size_t axis) {
    places p = {.low = INFINITY, .high = -INFINITY, .left_high = -INFINITY, .right_low = INFINITY};
    visit v = {.into = &p};
    if (!visit_end(ctx, dem, boundary, solids, end, axis, &v)) p.known = false;
    if (!p.known) return p;
    v.sides = true;
    v.middle = 0.5 * (p.low + p.high);
    visit_end(ctx, dem, boundary, solids, end, axis, &v);
    return p;
}

typedef struct report {
    char *text;
    size_t size, used, before; /* the message begins with the place */
} report;

/* Compares a value of the test with its range in the specimen. */
static void hold(report *r, const char *key, double given, double low, double high,
                 const char *what) {
    const double slack = tolerance * fmax(fabs(given), fabs(high));
    if ((given >= low - slack && given <= high + slack) || r->used >= r->size) return;
    const char *between = r->used > r->before ? "; " : "";
    int more =
        high - low > slack
            ? snprintf(r->text + r->used, r->size - r->used, "%s%s is %.4g m, %s %.4g to %.4g m",
                       between, key, given, what, low, high)
            : snprintf(r->text + r->used, r->size - r->used, "%s%s is %.4g m, %s %.4g m", between,
                       key, given, what, high);
    r->used += more > 0 ? (size_t)more : 0;
}

/* Returns the axis of the beam: in 2D the one across the load; in 3D the longer of the two sides
 * across the load. */
static size_t along_beam(const gn_step_context *ctx, const gn_solids *solids) {
    size_t axis = (size_t)ctx->scene.test.axis, a = (axis + 1) % 3, b = (axis + 2) % 3;
    if (ctx->scene.dimension == 2) return 1 - axis;
    return gn_tested_side(ctx, solids, (int)a) >= gn_tested_side(ctx, solids, (int)b) ? a : b;
}

static void hold_spans(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, size_t along, const places *supports, report *r) {
    const gn_test *t = &ctx->scene.test;
    const places loads = places_of(ctx, dem, boundary, solids, &t->upper, along);
    if (supports->known)
        hold(r, "span", t->given.span, supports->right_low - supports->left_high,
             supports->high - supports->low, "the supports are apart by");
    if (!loads.known) return;
    const double apart = loads.right_low - loads.left_high;
    if (t->given.load_span > 0.0 || (t->upper.count > 1 && apart > tolerance * t->given.span))
        hold(r, "load_span", t->given.load_span, fmax(0.0, apart), loads.high - loads.low,
             "the loads are apart by");
    if (!supports->known || r->used >= r->size) return;
    /* A single particle, node or body is on one side only. */
    const bool two = isfinite(supports->left_high) && isfinite(supports->right_low);
    const double slack = tolerance * t->given.span,
                 low = two ? 0.5 * (supports->low + supports->right_low) : supports->low,
                 high = two ? 0.5 * (supports->left_high + supports->high) : supports->high;
    if (loads.low <= high + slack && loads.high >= low - slack) return;
    int more =
        snprintf(r->text + r->used, r->size - r->used,
                 "%sthe load is at %.4g to %.4g m along %c, mid-span at %.4g m",
                 r->used > r->before ? "; " : "", gn_point_out(ctx->scene.origin[along], loads.low),
                 gn_point_out(ctx->scene.origin[along], loads.high), "xyz"[along],
                 gn_point_out(ctx->scene.origin[along], 0.5 * (low + high)));
    r->used += more > 0 ? (size_t)more : 0;
}

/* Checks the extent. The surface of particles that were not packed into a shape is known to within
 * a radius. */
static void hold_extent(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                        const char *key, double given, size_t axis, report *r) {
    const gn_pack_def *pack = &ctx->scene.specimen.pack;
    double low = gn_tested_side(ctx, solids, (int)axis), high = low;
    if (!(given > 0.0)) return;
    /* Extent of the elements, or of a body with particles, which protrude a little. */
    if (ctx->scene.has_couple) {
        double side[3];
        gn_elements_sides(solids, side);
        hold(r, key, given, side[axis], high, "the specimen has");
        return;
    }
    if (pack->shape == GN_SHAPE_NONE && dem->particles.soa.count) {
        low -= 2.0 * gn_dem_mean_radius(dem);
    } else if (pack->shape == GN_SHAPE_RECTANGLE || pack->shape == GN_SHAPE_BOX) {
        low = high = fmax(high, pack->size[axis]);
    } else if (pack->shape == GN_SHAPE_POLYGON) {
        double least = ctx->lower[axis], most = ctx->upper[axis];
        for (size_t k = 0; k < pack->corner_count; k++) {
            least = fmin(least, pack->corners[2 * k + axis]);
            most = fmax(most, pack->corners[2 * k + axis]);
        }
        low = high = most - least;
    }
    hold(r, key, given, low, high, "the specimen has");
}

/* Returns the depth of the deepest corner of an outline between the supports that is neither a
 * lowest nor a highest one; below 0: no notch is recognised. */
static double notch_of(const gn_step_context *ctx, size_t along, const places *supports) {
    const gn_scene *s = &ctx->scene;
    const gn_pack_def *pack = &s->specimen.pack;
    const size_t axis = (size_t)s->test.axis;
    double deepest = 0.0, least = INFINITY, most = -INFINITY;
    if (s->has_elements && s->elements.has_beam) return s->elements.beam.notch_depth;
    if (pack->shape != GN_SHAPE_POLYGON || !supports->known) return -1.0;
    for (size_t k = 0; k < pack->corner_count; k++) {
        least = fmin(least, pack->corners[2 * k + axis]);
        most = fmax(most, pack->corners[2 * k + axis]);
    }
    for (size_t k = 0; k < pack->corner_count; k++) {
        const double *x = pack->corners + 2 * k;
        bool between = x[along] > supports->left_high && x[along] < supports->right_low;
        if (between && x[axis] < most) deepest = fmax(deepest, x[axis] - least);
    }
    return deepest;
}

bool gn_bending_outside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids) {
    const size_t along = along_beam(ctx, solids);
    const places supports = places_of(ctx, dem, boundary, solids, &ctx->scene.test.lower, along),
                 loads = places_of(ctx, dem, boundary, solids, &ctx->scene.test.upper, along);
    if (!supports.known || !loads.known) return false;
    return loads.high < supports.low || loads.low > supports.high;
}

bool gn_bending_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, char *text, size_t size) {
    const gn_test *t = &ctx->scene.test;
    const int place = snprintf(text, size, "%s: ", gn_scene_at(&ctx->scene, t->where, "test").text);
    const size_t before = place > 0 ? (size_t)place : 0;
    report r = {text, size, before, before};
    const size_t along = along_beam(ctx, solids), axis = (size_t)t->axis;
    const places supports = places_of(ctx, dem, boundary, solids, &t->lower, along);
    hold_spans(ctx, dem, boundary, solids, along, &supports, &r);
    hold_extent(ctx, dem, solids, "height", t->given.height, axis, &r);
    if (ctx->scene.dimension == 3)
        hold_extent(ctx, dem, solids, "thickness", t->given.thickness, 3 - axis - along, &r);
    const double notch = notch_of(ctx, along, &supports);
    /* In a shape without a notch, groups that do not bond may form one. */
    const bool whole = notch == 0.0 && ctx->scene.has_elements && ctx->scene.elements.has_beam &&
                       !ctx->scene.has_specimen;
    if (notch > 0.0 || whole)
        hold(&r, "notch", t->given.notch, notch, notch, "the specimen has one of");
    return r.used > before;
}
