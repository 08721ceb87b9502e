#include "laboratory/laboratory.h"

#include "base/memory.h"
#include "frame/periodic_box.h"
#include "frame/step_context.h"
#include "laboratory/ends.h"
#include "laboratory/geometry.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* m2: the mean section across an axis of the particles' volume, and of the body that they fill a
 * part of (`couple`) as much as its sides are longer than theirs. */
static double mean_section(const gn_step_context *ctx, const gn_solids *solids, int axis) {
    double section = ctx->volume / (ctx->upper[axis] - ctx->lower[axis]);
    for (int a = 0; ctx->scene.has_couple && a < (int)ctx->scene.dimension; a++)
        if (a != axis) section *= gn_world_side(ctx, solids, a) / (ctx->upper[a] - ctx->lower[a]);
    return section;
}

/* m2: the section of the area or the diameter of the scene; 0: neither is given. */
static double given_section(const gn_step_context *ctx) {
    const double area = ctx->scene.test.given.area, d = ctx->scene.test.given.diameter;
    if (area > 0.0) return area;
    return ctx->effects & GN_FX_SPACE ? 0.25 * M_PI * d * d : d;
}

/* m: the extent along the axis; the distance of the ends for loose grains, which fill the space
 * between them. */
static double prism_length(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(ctx, dem, boundary, solids, &lower, &upper, away);
    double length = gn_world_side(ctx, solids, (int)ctx->scene.test.axis);
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

/* Between periodic sides the ends leave what is sheared between them, over all of the box. Other
 * ends may hold most of the height, of which the section is the mean all the same. */
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
    gn_world_body(ctx, solids, lower, upper);
    for (int a = 0; a < 3; a++) x.side[a] = upper[a] - lower[a];
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

/* The middle of the disc, its radius, and of what is in it. */
typedef struct region {
    double centre[2], radius;
} region;

static region region_of(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids) {
    gn_tested_shape s = gn_test_shape(ctx, dem, boundary, solids);
    region r = {.radius = 0.5 * s.diameter * ctx->scene.test.centre};
    double lower[3], upper[3];
    gn_world_body(ctx, solids, lower, upper);
    for (int a = 0; a < 2; a++) r.centre[a] = 0.5 * (lower[a] + upper[a]);
    return r;
}

/* Share of the way from x along l that lies in the region: |x + q l - centre| < radius. */
static double share_inside(const region *r, const double x[3], const double l[3]) {
    double d[2] = {x[0] - r->centre[0], x[1] - r->centre[1]};
    double a = l[0] * l[0] + l[1] * l[1], b = d[0] * l[0] + d[1] * l[1];
    double c = d[0] * d[0] + d[1] * d[1] - r->radius * r->radius, root = b * b - a * c;
    if (!(a > 0.0)) return c < 0.0 ? 1.0 : 0.0;
    if (!(root > 0.0)) return 0.0;
    double low = fmax(0.0, (-b - sqrt(root)) / a), high = fmin(1.0, (-b + sqrt(root)) / a);
    return fmax(0.0, high - low);
}

/* Contacts of a list with a share inside, in their order. */
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

/* Without memory for it the reading is not a number. */
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
