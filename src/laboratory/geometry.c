#include "laboratory/geometry.h"

#include "base/error.h"
#include "frame/step_context.h"
#include "laboratory/bending.h"
#include "laboratory/ends.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "scene/laboratory.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A surface is where it is found to a radius; what is off by less is a matter of taste. */
static const double tolerance = 0.1, nonsense = 2.0;

/* A number of a test, and what of it the specimen has, from the least that it may be taken for to
 * the most. */
typedef struct size_given {
    const char *key, *unit;
    double given, low, high;
} size_given;

enum { SIZES_MOST = 3 };

static double extent(const gn_step_context *ctx, int axis) {
    return ctx->upper[axis] - ctx->lower[axis];
}

/* Of particles that are not packed into a shape the surface is known to a radius. */
static size_given length_along(const gn_step_context *ctx, const gn_dem *dem, const char *key,
                               double given, int axis) {
    size_given s = {key, "m", given, extent(ctx, axis), extent(ctx, axis)};
    if (ctx->scene.specimen.pack.shape == GN_SHAPE_NONE && dem->particles.soa.count)
        s.low -= 2.0 * gn_dem_mean_radius(dem);
    return s;
}

static double solid_volume(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double r = q->pos[4 * p + 3];
        sum += ctx->scene.dimension == 2 ? M_PI * r * r : 4.0 / 3.0 * M_PI * r * r * r;
    }
    return sum;
}

/* A group of its own may cut a notch into any shape. */
static bool cut_by_groups(const gn_scene *s) {
    bool cut = false;
    for (size_t k = 0; k < s->set_count; k++) cut = cut || s->sets[k].group >= 0;
    return cut;
}

/* The section across an axis: no more than that of the box about it. Of what is the same all along
 * it is the mean one; of others, which may have a waist, nothing is known of the least. */
static size_given section_across(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_solids *solids, int axis) {
    const gn_test *t = &ctx->scene.test;
    const gn_shape_kind shape = ctx->scene.specimen.pack.shape;
    const bool space = ctx->scene.dimension == 3;
    size_given s = {"area", "m2", t->given.area, 0.0, 1.0};
    if (t->given.diameter > 0.0) {
        s.key = space ? "the area of a circle of diameter" : "the area by diameter, 1 m thick,";
        s.given = space ? 0.25 * M_PI * t->given.diameter * t->given.diameter : t->given.diameter;
    }
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        if (a != axis) s.high *= extent(ctx, a);
    const bool prism = shape == GN_SHAPE_BOX || shape == GN_SHAPE_RECTANGLE ||
                       (shape == GN_SHAPE_CYLINDER && axis == 2);
    if (prism && !solids->count && !cut_by_groups(&ctx->scene)) {
        if (shape == GN_SHAPE_CYLINDER) s.high *= M_PI / 4.0;
        s.low = s.high;
    } else if (shape == GN_SHAPE_NONE && !solids->count && !cut_by_groups(&ctx->scene)) {
        s.low = fmin(s.high, solid_volume(ctx, dem) / extent(ctx, axis));
    }
    return s;
}

static size_t sizes_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, size_given sizes[SIZES_MOST]) {
    const gn_test *t = &ctx->scene.test;
    size_t count = 0;
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    const int way = (int)(d->sheared ? t->normal : t->axis);
    /* What begins loose is another specimen once stages have settled and bonded it. */
    if (ctx->given.stage_count && ctx->given.bonds != GN_SWITCH_ON) return 0;
    /* Of particles beside elements either may be what is tested. */
    if (!dem->particles.soa.count == !solids->count) return 0;
    if (d->disc) {
        if (t->given.diameter > 0.0)
            sizes[count++] = length_along(ctx, dem, "diameter", t->given.diameter, way);
        if (t->given.thickness > 0.0 && ctx->scene.dimension == 3)
            sizes[count++] = length_along(ctx, dem, "thickness", t->given.thickness, 2);
        return count;
    }
    if (!(d->prism || d->sheared) || ctx->scene.source_count) return 0;
    if (t->given.length > 0.0 && !gn_scene_periodic_along(&ctx->scene, way)) {
        sizes[count] = length_along(ctx, dem, "length", t->given.length, way);
        /* Or what the ends leave between them, of sets to a radius at each side. */
        const double gap = d->sheared ? gn_ends_gap(ctx, dem, boundary, solids) : INFINITY,
                     sides = dem->particles.soa.count ? 2.0 * gn_dem_mean_radius(dem) : 0.0;
        sizes[count].low = fmin(sizes[count].low, fmax(0.0, gap - sides));
        count++;
    }
    if ((t->given.area > 0.0 || t->given.diameter > 0.0) && !ctx->scene.has_periodic)
        sizes[count++] = section_across(ctx, dem, solids, way);
    return count;
}

static bool beyond(const size_given *s, double slack) {
    return s->given * (1.0 + slack) < s->low || s->given > s->high * (1.0 + slack);
}

static int told(const size_given *s, char *text, size_t size) {
    if (s->high - s->low > 1e-6 * s->high)
        return snprintf(text, size, "%s is %.4g %s, the specimen has %.4g to %.4g %s", s->key,
                        s->given, s->unit, s->low, s->high, s->unit);
    return snprintf(text, size, "%s is %.4g %s, the specimen has %.4g %s", s->key, s->given,
                    s->unit, s->high, s->unit);
}

bool gn_geometry_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, char *text, size_t size) {
    size_given sizes[SIZES_MOST];
    if (gn_scene_test(&ctx->scene)->beam)
        return gn_bending_doubts(ctx, dem, boundary, solids, text, size);
    const size_t count = sizes_of(ctx, dem, boundary, solids, sizes);
    const gn_scene_place where = ctx->scene.test.where;
    size_t used = 0;
    bool any = false;
    *text = '\0';
    for (size_t k = 0; k < count; k++) {
        if (!beyond(&sizes[k], tolerance) || used >= size) continue;
        int more = any ? snprintf(text + used, size - used, "; ")
                       : snprintf(text, size, "%s: ", gn_scene_at(&ctx->scene, where, "test").text);
        used += more > 0 ? (size_t)more : 0;
        if (used < size) more = told(&sizes[k], text + used, size - used);
        used += more > 0 ? (size_t)more : 0;
        any = true;
    }
    return any;
}

/* A bar that the ends of a general test bend, or something that is pulled out of a block, has
 * lengths and areas of its own, as a sheared specimen has: gn_geometry_doubts warns of these. */
gneiss_status gn_geometry_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids,
                                gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    size_given sizes[SIZES_MOST];
    char text[256];
    const gn_test_descriptor *d = gn_scene_test(s);
    if (d->general || d->sheared) return GNEISS_OK;
    const size_t count = sizes_of(ctx, dem, boundary, solids, sizes);
    for (size_t k = 0; k < count; k++) {
        if (!beyond(&sizes[k], nonsense - 1.0)) continue;
        told(&sizes[k], text, sizeof text);
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%s: expected the size of the specimen at the start, found less than half "
                       "or more than twice of it: %s",
                       gn_scene_at(s, s->test.where, "test").text, text);
    }
    return GNEISS_OK;
}

void gn_world_body(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                   double upper[3]) {
    memcpy(lower, ctx->lower, sizeof ctx->lower);
    memcpy(upper, ctx->upper, sizeof ctx->upper);
    if (ctx->scene.has_couple) gn_elements_extent(solids, lower, upper);
}

double gn_world_side(const gn_step_context *ctx, const gn_solids *solids, int axis) {
    double lower[3], upper[3];
    gn_world_body(ctx, solids, lower, upper);
    return upper[axis] - lower[axis];
}
