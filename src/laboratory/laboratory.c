#include "laboratory/laboratory.h"

#include "base/error.h"
#include "base/memory.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "laboratory/ends.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/laboratory.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "test_kinds/readings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns the mean section, m2, across an axis from the particles' volume, enlarged by the ratio of
 * the sides if they fill a part of the body (`couple`). */
static double mean_section(const gn_step_context *ctx, const gn_solids *solids, int axis) {
    double section = ctx->volume / (ctx->upper[axis] - ctx->lower[axis]);
    for (int a = 0; ctx->scene.has_couple && a < (int)ctx->scene.dimension; a++)
        if (a != axis) section *= gn_tested_side(ctx, solids, a) / (ctx->upper[a] - ctx->lower[a]);
    return section;
}

/* Returns the section, m2, from the area or the diameter in the scene; 0: neither is given. */
static double given_section(const gn_step_context *ctx) {
    const double area = ctx->scene.test.given.area, d = ctx->scene.test.given.diameter;
    if (area > 0.0) return area;
    return ctx->effects & GN_FX_SPACE ? 0.25 * M_PI * d * d : d;
}

/* Returns the extent, m, along the axis; for loose grains, which fill the space between the ends,
 * the distance of the ends. */
static double prism_length(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(ctx, dem, boundary, solids, &lower, &upper, away);
    double length = gn_tested_side(ctx, solids, (int)ctx->scene.test.axis);
    if (ctx->effects & GN_FX_BONDS || !dem->particles.soa.count) return length;
    return length + (away[0] ? 0.0 : lower) + (away[1] ? 0.0 : upper);
}

static void add_prism(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids, gn_tested_specimen *x) {
    if (!(x->length > 0.0)) x->length = prism_length(ctx, dem, boundary, solids);
    x->height = x->length;
    if (x->section > 0.0) return;
    x->section =
        ctx->scene.has_couple ? mean_section(ctx, solids, x->axis) : ctx->volume / x->length;
}

/* Adds the sheared part. With periodic sides it is between the ends, over the whole box. Other ends
 * may hold most of the height, but the section is the mean one all the same. */
static void add_sheared(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, gn_tested_specimen *x) {
    const int normal = (int)ctx->scene.test.normal;
    const bool periodic = gn_scene_test(&ctx->scene)->periodic_sides;
    x->height = x->length > 0.0 ? x->length : x->side[normal];
    if (!(x->length > 0.0))
        x->length = periodic ? gn_ends_gap(ctx, dem, boundary, solids)
                             : gn_ends_free(ctx, dem, boundary, solids);
    if (!(x->section > 0.0))
        x->section = periodic ? gn_box_section(ctx) : mean_section(ctx, solids, normal);
}

gn_tested_shape gn_test_shape(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids) {
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    const gn_test *t = &ctx->scene.test;
    double lower[3], upper[3];
    gn_tested_specimen x = {.dimension = (int)ctx->scene.dimension,
                            .axis = (int)t->axis,
                            .length = t->given.length,
                            .section = given_section(ctx)};
    gn_tested_extent(ctx, solids, lower, upper);
    for (int a = 0; a < 3; a++) x.side[a] = upper[a] - lower[a];
    if (d->tool) {
        const gn_body_def *tool = ctx->scene.bodies + gn_scene_find_body(&ctx->scene, t->tool);
        if (tool->has_chisel || tool->has_wedge) x.tool_width = tool->scale * tool->tool.width;
    }
    if (d->prism) add_prism(ctx, dem, boundary, solids, &x);
    if (d->sheared) add_sheared(ctx, dem, boundary, solids, &x);
    return d->shape(&t->given, &x); // cppcheck-suppress returnDanglingLifetime
}

const char *gn_test_area_source(const gn_step_context *ctx) {
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    const bool given = d->takes & GN_TAKES(area) && given_section(ctx) > 0.0;
    return given ? "" : d->area_source;
}

/* --- the stress in the middle of a disc --- */

/* Centre and radius of a region. */
typedef struct region {
    double centre[2], radius;
} region;

static region region_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids) {
    gn_tested_shape s = gn_test_shape(ctx, dem, boundary, solids);
    region r = {.radius = 0.5 * s.diameter * ctx->scene.test.centre};
    double lower[3], upper[3];
    gn_tested_extent(ctx, solids, lower, upper);
    for (int a = 0; a < 2; a++) r.centre[a] = 0.5 * (lower[a] + upper[a]);
    return r;
}

/* Returns the fraction of the segment from x along l that is inside the region: |x + q l - centre|
 * < radius. */
static double share_inside(const region *r, const double x[3], const double l[3]) {
    double d[2] = {x[0] - r->centre[0], x[1] - r->centre[1]};
    double a = l[0] * l[0] + l[1] * l[1], b = d[0] * l[0] + d[1] * l[1];
    double c = d[0] * d[0] + d[1] * d[1] - r->radius * r->radius, root = b * b - a * c;
    if (!(a > 0.0)) return c < 0.0 ? 1.0 : 0.0;
    if (!(root > 0.0)) return 0.0;
    double low = fmax(0.0, (-b - sqrt(root)) / a), high = fmin(1.0, (-b + sqrt(root)) / a);
    return fmax(0.0, high - low);
}

/* Lists the contacts that are inside the region in part, in their order. */
static size_t choose(const gn_step_context *ctx, const gn_dem *dem, const region *r,
                     const gn_contacts *list, int32_t *chosen) {
    size_t count = 0;
    for (size_t c = 0; c < list->soa.count; c++) {
        const double *x = dem->particles.pos + 4 * (size_t)list->i[c];
        const double *y = dem->particles.pos + 4 * (size_t)list->j[c];
        double l[3];
        gn_branch(ctx, x, y, l);
        if (share_inside(r, x, l) > 0.0) chosen[count++] = (int32_t)c;
    }
    return count;
}

static void add_contacts(const gn_step_context *ctx, const gn_dem *dem, const region *r,
                         const gn_contacts *part, double sigma[9]) {
    const size_t width = (size_t)gn_contacts_row_width(part);
    for (size_t c = 0; c < part->soa.count; c++) {
        const double *x = dem->particles.pos + 4 * (size_t)part->i[c];
        const double *y = dem->particles.pos + 4 * (size_t)part->j[c];
        const double *f = gn_contacts_row(part) + width * c;
        double l[3];
        gn_branch(ctx, x, y, l);
        double share = share_inside(r, x, l);
        for (int a = 0; a < (int)ctx->scene.dimension; a++)
            for (int b = 0; b < (int)ctx->scene.dimension; b++)
                sigma[3 * a + b] += share * f[a] * l[b];
    }
}

/* Adds the contacts of a list. Without memory the reading is not a number. */
static bool add_list(const gn_step_context *ctx, const gn_dem *dem, const gn_periodic_box *box,
                     const region *r, const gn_contacts *list, double sigma[9]) {
    gn_contacts part = {0};
    if (!list->soa.count) return true;
    int32_t *chosen = gn_alloc_array(list->soa.count + 1, sizeof *chosen);
    if (!chosen) return false;
    size_t count = choose(ctx, dem, r, list, chosen);
    bool held = gn_contacts_observe(ctx, dem, box, list, chosen, count, &part, NULL) == GNEISS_OK;
    if (held) add_contacts(ctx, dem, r, &part, sigma);
    gn_soa_destroy(&gn_contact_record, &part);
    gn_free(chosen);
    return held;
}

void gn_test_centre_stress(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids,
                           const gn_periodic_box *box, double sigma[9]) {
    const region r = region_of(ctx, dem, boundary, solids);
    double volume =
        M_PI * r.radius * r.radius * gn_test_shape(ctx, dem, boundary, solids).thickness;
    memset(sigma, 0, 9 * sizeof *sigma);
    bool held = true;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        held = held && add_list(ctx, dem, box, &r, &dem->list[l].contacts, sigma);
    for (int k = 0; k < 9; k++) sigma[k] = held ? sigma[k] / volume : NAN;
}

/* Relative tolerances: surfaces are known to within a radius. Deviations beyond the first are
 * reported; beyond the second they are refused. */
static const double tolerance = 0.1, nonsense = 2.0;

/* A size given for a test, and the range of its value in the specimen. */
typedef struct size_given {
    const char *key, *unit;
    double given, low, high;
} size_given;

enum { SIZES_MOST = 3 };

static double extent(const gn_step_context *ctx, int axis) {
    return ctx->upper[axis] - ctx->lower[axis];
}

/* Returns a length. The surface of particles that were not packed into a shape is known to within a
 * radius. */
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

/* Tells whether a group that does not bond may form a notch in any shape. */
static bool cut_by_groups(const gn_scene *s) {
    bool cut = false;
    for (size_t k = 0; k < s->set_count; k++) cut = cut || s->sets[k].group >= 0;
    return cut;
}

/* Returns the section across an axis: at most that of the bounding box. For prismatic shapes it is
 * the mean section; for others, which may have a waist, there is no lower limit. */
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
    /* An unbonded initial state becomes a different specimen if stages bond it. */
    if (ctx->given.stage_count && ctx->given.bonds != GN_SWITCH_ON) return 0;
    /* If there are particles and elements, either may be the specimen. */
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
        /* The length may also be the distance between the ends; that of sets is known to within a
         * radius at each side. */
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

/* A beam, a pull-out test and a sheared specimen have lengths and areas of their own;
 * gn_geometry_doubts warns of these. */
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

void gn_tested_extent(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                      double upper[3]) {
    memcpy(lower, ctx->lower, sizeof ctx->lower);
    memcpy(upper, ctx->upper, sizeof ctx->upper);
    if (ctx->scene.has_couple) gn_elements_extent(solids, lower, upper);
}

double gn_tested_side(const gn_step_context *ctx, const gn_solids *solids, int axis) {
    double lower[3], upper[3];
    gn_tested_extent(ctx, solids, lower, upper);
    return upper[axis] - lower[axis];
}

/* Under the force F a bar whose section A(x) varies shortens by F/E times the integral of 1/A, so
 * that E = F/d L m, with m the mean of 1/A over the strained length L and d the shortening. The
 * mean strain of the volume is F/(E V/L), because the integral of A F/(E A) is F L/E. Both hold for
 * slender bars, in which the stress is uniform over every section. */

enum { SLABS_LEAST = 4, SLABS_MOST = 64 };

/* Product of the means of A and of 1/A from which a section counts as varying; packings of a prism
 * have up to 1.005. */
static const double varying = 1.02;
/* Ratio of the narrowest to the mean section below which stresses are not those of a bar. */
static const double pointed = 0.2;

typedef struct slabs {
    size_t count;
    double lower, thick;       /* m, along the axis */
    double volume[SLABS_MOST]; /* m3 */
} slabs;

/* Returns the volume of a ball (2D: disc) below the height h over its centre. */
static double below(int dimension, double r, double h) {
    const double t = fmax(-r, fmin(r, h));
    if (dimension == 2) return t * sqrt(r * r - t * t) + r * r * (asin(t / r) + 0.5 * M_PI);
    return M_PI * (r * r * (t + r) - (t * t * t + r * r * r) / 3.0);
}

static void add_ball(slabs *s, int dimension, double x, double r) {
    const double first = floor((x - r - s->lower) / s->thick),
                 last = floor((x + r - s->lower) / s->thick);
    for (double k = fmax(first, 0.0); k <= last && k < (double)s->count; k++) {
        const double low = s->lower + k * s->thick - x;
        s->volume[(size_t)k] += below(dimension, r, low + s->thick) - below(dimension, r, low);
    }
}

/* Adds an element as if its section were uniform. */
static void add_element(slabs *s, double low, double high, double volume) {
    for (size_t k = 0; k < s->count; k++) {
        const double from = s->lower + (double)k * s->thick,
                     shared = fmin(high, from + s->thick) - fmax(low, from);
        if (shared > 0.0) s->volume[k] += volume * shared / (high - low);
    }
}

static void add_elements(const gn_solids *solids, int axis, slabs *s) {
    for (size_t m = 0; m < solids->count; m++) {
        const gn_fem_solid *q = &solids->elements[m]->solid;
        for (size_t e = 0; e < q->elements.soa.count; e++) {
            double low = INFINITY, high = -INFINITY;
            for (int a = 0; a <= q->dimension; a++) {
                const size_t n = (size_t)gn_elements_node(&q->elements, a)[e];
                low = fmin(low, q->nodes.start[4 * n + (size_t)axis]);
                high = fmax(high, q->nodes.start[4 * n + (size_t)axis]);
            }
            add_element(s, low, high, q->elements.volume[e]);
        }
    }
}

/* Returns the innermost position, m, of an end that holds a part of the specimen. `sense` +1: the
 * lower end. */
static double inner(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    const gn_test_end *end, double sense, double surface) {
    const int axis = (int)ctx->scene.test.axis;
    const gn_particles *q = &dem->particles;
    double place = sense * surface;
    for (size_t k = 0; k < end->count; k++) {
        const int set = gn_scene_find_set(&ctx->scene, end->name[k]),
                  motion = gn_scene_find_element_motion(&ctx->scene, end->name[k]);
        for (size_t p = 0; set >= 0 && p < q->soa.count; p++)
            if (gn_set_selected(ctx, dem, (size_t)set, p))
                place = fmax(place, sense * q->start[4 * p + (size_t)axis]);
        if (motion < 0) continue;
        const gn_particles *nodes;
        const gn_fem_set *held = gn_elements_motion_set(solids, (size_t)motion, &nodes);
        for (size_t n = 0; n < held->count; n++)
            place = fmax(place, sense * nodes->start[4 * (size_t)held->node[n] + (size_t)axis]);
    }
    return sense * place;
}

static slabs slabs_of(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids) {
    const int axis = (int)ctx->scene.test.axis;
    const gn_particles *q = &dem->particles;
    const double lower = inner(ctx, dem, solids, &ctx->scene.test.lower, 1.0, ctx->lower[axis]),
                 upper = inner(ctx, dem, solids, &ctx->scene.test.upper, -1.0, ctx->upper[axis]);
    slabs s = {.count = SLABS_MOST, .lower = lower};
    if (q->soa.count)
        s.count =
            (size_t)fmax(0.0, fmin(SLABS_MOST, (upper - lower) / (4.0 * gn_dem_mean_radius(dem))));
    if (s.count < SLABS_LEAST || !(upper > lower)) return (slabs){0};
    s.thick = (upper - lower) / (double)s.count;
    for (size_t p = 0; p < q->soa.count; p++)
        add_ball(&s, (int)ctx->scene.dimension, q->pos[4 * p + (size_t)axis], q->pos[4 * p + 3]);
    if (!q->soa.count) add_elements(solids, axis, &s);
    return s;
}

/* Tells whether a section is smaller than others before and after it: the body is not convex. */
static bool has_waist(const slabs *s) {
    double before = 0.0;
    for (size_t k = 0; k < s->count; k++) {
        double behind = 0.0;
        for (size_t m = k + 1; m < s->count; m++) behind = fmax(behind, s->volume[m]);
        if (s->volume[k] < 0.9 * fmin(before, behind)) return true;
        before = fmax(before, s->volume[k]);
    }
    return false;
}

/* --- parts of a bar that are not slender --- */

/* Returns half of the width, or the radius of a circle of the same area. */
static double half_width(const slabs *s, size_t k, int dimension, double solid) {
    const double area = s->volume[k] / s->thick / solid;
    return dimension == 2 ? 0.5 * area : sqrt(area / M_PI);
}

/* Tangent of the angle between the axis and the cone within which stress spreads into a wider part.
 * A plate that is twice as wide beside a waist of 0.4 of its length is less stiff than by the
 * formula of a slender bar, by 0.11 if made of finite elements and 0.22 if made of 1600 discs; a
 * cylinder of spheres with a waist of 0.55 by 0.35. */
static const double spreads_elements = 0.4, spreads_particles = 0.2;

/* Returns the share by which the integral of 1/A is too small, because corners outside of the cone
 * carry no stress. Where the section changes more slowly, shear stresses add their energy, E/G c
 * (slope)^2 with E/G of 2.5, and c of 1/3 in the plane and 1/2 around the axis. */
static double spread_of(const slabs *s, int dimension, double solid, double spreads) {
    const double shear = 2.5 / (dimension == 2 ? 3.0 : 2.0);
    double slender = 0.0, real = 0.0;
    for (size_t k = 0; k < s->count; k++) {
        const double own = half_width(s, k, dimension, solid);
        double bears = own, slope = 0.0;
        for (size_t m = 0; m < s->count; m++) {
            const double apart = s->thick * (m > k ? (double)(m - k) : (double)(k - m));
            bears = fmin(bears, half_width(s, m, dimension, solid) + spreads * apart);
        }
        if (k > 0 && k + 1 < s->count)
            slope =
                (half_width(s, k + 1, dimension, solid) - half_width(s, k - 1, dimension, solid)) /
                (2.0 * s->thick);
        const double slow = fabs(slope) < spreads ? shear * slope * slope : 0.0;
        slender += pow(own, 1 - dimension);
        real += pow(bears, 1 - dimension) * (1.0 + slow);
    }
    return real / slender - 1.0;
}

/* Tells whether the section is needed and known; it matters to tests that read the modulus of a
 * prism. */
static bool is_known(const gn_step_context *ctx, const gn_solids *solids) {
    const bool read = gn_scene_tested(&ctx->scene) &&
                      gn_reading_belongs(GN_READING_young_modulus, ctx->scene.test.kind, false);
    const bool both = ctx->scene.has_specimen && solids->count;
    return read && !both && !ctx->scene.has_couple && !(ctx->effects & GN_FX_PERIODIC) &&
           !gn_scene_has_flow(&ctx->scene);
}

gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids) {
    const gn_bar_section even = {.uneven = 1.0};
    if (!is_known(ctx, solids)) return even;
    const slabs s = slabs_of(ctx, dem, solids);
    double sum = 0.0, inverse = 0.0, least = INFINITY;
    for (size_t k = 0; k < s.count; k++) {
        sum += s.volume[k] / (double)s.count;
        inverse += 1.0 / s.volume[k] / (double)s.count;
        least = fmin(least, s.volume[k]);
    }
    if (!s.count || !(sum * inverse > varying)) return even;
    const bool grains = dem->particles.soa.count;
    const double solid = grains ? 1.0 - gn_dem_porosity(ctx, dem) : 1.0;
    const bool waist = has_waist(&s);
    const gn_volume_source source = gn_volume_source_of(ctx, dem, boundary, solids);
    return (gn_bar_section){.mean = sum / s.thick / solid,
                            .narrowest = least / s.thick / solid,
                            .uneven = sum * inverse,
                            .length = s.thick * (double)s.count,
                            .waist = waist,
                            .guessed = source == GN_VOLUME_OF_TEST ||
                                       (waist && source == GN_VOLUME_OF_HULL),
                            .spread = spread_of(&s, (int)ctx->scene.dimension, solid,
                                                grains ? spreads_particles : spreads_elements)};
}

double gn_section_by_ends(const gn_step_context *ctx, const gn_bar_section *section) {
    const gn_bar_section *x = section;
    if (!(x->mean > 0.0)) return 1.0;
    if (!(x->narrowest > pointed * x->mean)) return NAN;
    if (x->guessed != 0.0) return 1.0;
    return ctx->test_area / x->mean * x->uneven * x->length / ctx->test_length;
}

double gn_section_by_mean(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_bar_section *section) {
    const gn_bar_section *x = section;
    if (!(x->mean > 0.0)) return 1.0;
    if (!(x->narrowest > pointed * x->mean)) return NAN;
    if (dem->particles.soa.count && x->waist != 0.0) return NAN;
    if (x->guessed != 0.0) return 1.0;
    return ctx->test_area * gn_tested_side(ctx, solids, (int)ctx->scene.test.axis) / ctx->volume;
}

gn_volume_source gn_volume_source_of(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids) {
    if (!ctx->scene.has_specimen) return GN_VOLUME_OF_ELEMENTS;
    if (ctx->effects & GN_FX_PERIODIC) return GN_VOLUME_OF_BOX;
    if (!gn_scene_starts_filled(&ctx->scene)) return GN_VOLUME_OF_SOURCES;
    if (ctx->scene.specimen.pack.shape != GN_SHAPE_NONE) return GN_VOLUME_OF_SHAPE;
    if (gn_scene_from_packing(&ctx->scene)) return GN_VOLUME_OF_PACKING;
    bool given =
        gn_scene_tested(&ctx->scene) && gn_test_shape(ctx, dem, boundary, solids).volume > 0.0;
    return given ? GN_VOLUME_OF_TEST : GN_VOLUME_OF_HULL;
}

const char *gn_volume_source_text(const gn_step_context *ctx, gn_volume_source source) {
    static const char *const names[] = {"the elements",
                                        "the periodic box",
                                        "the box about the sources",
                                        "the shape",
                                        "the shape that was packed",
                                        "length times area of the test",
                                        "the convex hull of the particles"};
    if (source == GN_VOLUME_OF_TEST && gn_scene_test(&ctx->scene)->disc)
        return "the disc of the test";
    return names[source];
}
