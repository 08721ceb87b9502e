#include "laboratory/laboratory.h"

#include "base/memory.h"
#include "laboratory/ends.h"

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

/* From the diameter; 0: not given. */
static double given_section(const gn_step_context *ctx) {
    double d = ctx->scene.test.diameter;
    return ctx->effects & GN_FX_SPACE ? 0.25 * M_PI * d * d : d;
}

/* Of loose grains, which fill the space between their ends, the distance of these. */
static double prism_length(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const gn_solids *solids) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(ctx, dem, boundary, solids, &lower, &upper, away);
    double length = gn_world_side(ctx, solids, (int)ctx->scene.test.axis);
    if (ctx->effects & GN_FX_BONDS || !dem->particles.soa.count) return length;
    return length + (away[0] ? 0.0 : lower) + (away[1] ? 0.0 : upper);
}

/* A prism, loaded along its axis. */
static gn_tested_shape prism(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    gn_tested_shape s = {0};
    s.length = t->length > 0.0 ? t->length : prism_length(ctx, dem, boundary, solids);
    if (t->area > 0.0)
        s.area = t->area;
    else if (t->diameter > 0.0)
        s.area = given_section(ctx);
    else
        s.area = ctx->scene.has_couple ? mean_section(ctx, solids, (int)t->axis)
                                       : ctx->volume / s.length;
    s.section = s.area;
    if (t->area > 0.0 || t->diameter > 0.0) s.volume = s.length * s.area;
    return s;
}

/* Across the load, in the middle of a disc under two opposite line loads P there is the tension
 * 2 P/(pi D t) (Hondros 1959, Aust. J. Appl. Sci. 10, 243-268; ISRM 1978). */
static gn_tested_shape disc(const gn_step_context *ctx, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    gn_tested_shape s = {0};
    s.diameter = t->diameter > 0.0 ? t->diameter : gn_world_side(ctx, solids, (int)t->axis);
    s.thickness = ctx->scene.dimension == 2 ? 1.0
                  : t->thickness > 0.0      ? t->thickness
                                            : gn_world_side(ctx, solids, 2);
    s.length = s.diameter;
    s.area = 0.5 * M_PI * s.diameter * s.thickness;
    s.section = s.diameter * s.thickness;
    if (t->diameter > 0.0 && (ctx->scene.dimension == 2 || t->thickness > 0.0))
        s.volume = 0.25 * M_PI * s.diameter * s.diameter * s.thickness;
    return s;
}

/* The shorter of the sides that the load is not along. */
static double beam_thickness(const gn_step_context *ctx, const gn_solids *solids) {
    int axis = (int)ctx->scene.test.axis;
    return fmin(gn_world_side(ctx, solids, (axis + 1) % 3),
                gn_world_side(ctx, solids, (axis + 2) % 3));
}

/* A beam of width b on supports S apart, F shared by loads a = (S - s)/2 from them. In the fibre
 * below mid-span the stress is M (h/2)/I = 3 F a/(b h^2), with what the notch leaves of the height;
 * loads that went down by d strain it by 3 h d/(a (3 S - 4 a)) without a notch. With one load that
 * is 3 F S/(2 b h^2) and 6 h d/S^2. */
static gn_tested_shape beam(const gn_step_context *ctx, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    gn_tested_shape s = {0};
    s.height = t->height > 0.0 ? t->height : gn_world_side(ctx, solids, (int)t->axis);
    s.thickness = ctx->scene.dimension == 2 ? 1.0
                  : t->thickness > 0.0      ? t->thickness
                                            : beam_thickness(ctx, solids);
    double arm = 0.5 * (t->span - t->load_span), left = s.height - t->notch;
    s.length = arm * (3.0 * t->span - 4.0 * arm) / (3.0 * s.height);
    s.area = s.thickness * left * left / (3.0 * arm);
    s.section = s.thickness * left;
    return s;
}

/* Sheared between its ends: the section is across the normal, the strain that angle. Ends may hold
 * most of the height, of which the section is the mean all the same. */
static gn_tested_shape sheared(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    const double height = gn_world_side(ctx, solids, (int)t->normal);
    gn_tested_shape s = {0};
    s.length = t->length > 0.0 ? t->length : gn_ends_free(ctx, dem, boundary, solids);
    s.area = t->area > 0.0 ? t->area : given_section(ctx);
    if (s.area > 0.0) s.volume = (t->length > 0.0 ? t->length : height) * s.area;
    if (!(s.area > 0.0)) s.area = mean_section(ctx, solids, (int)t->normal);
    s.section = s.area;
    return s;
}

/* The same between periodic sides: what is sheared is what ends that are moved leave between them,
 * over all of the box. */
static gn_tested_shape simply_sheared(const gn_step_context *ctx, const gn_dem *dem,
                                      const gn_boundary *boundary, const gn_solids *solids) {
    const gn_test *t = &ctx->scene.test;
    double length = t->length > 0.0 ? t->length : gn_ends_gap(ctx, dem, boundary, solids),
           area = gn_box_section(ctx);
    return (gn_tested_shape){.length = length, .area = area, .section = area};
}

gn_tested_shape gn_test_shape(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids) {
    switch (ctx->scene.test.kind) {
    case GN_TEST_BRAZILIAN:
        return disc(ctx, solids);
    case GN_TEST_BENDING:
        return beam(ctx, solids);
    case GN_TEST_SHEAR:
        return sheared(ctx, dem, boundary, solids);
    case GN_TEST_SIMPLE_SHEAR:
        return simply_sheared(ctx, dem, boundary, solids);
    case GN_TEST_HYDROSTATIC: /* of stresses and strains, not of forces and ways */
        return (gn_tested_shape){.length = 1.0, .area = 1.0, .section = 1.0};
    case GN_TEST_NONE:
    case GN_TEST_COMPRESSION:
    case GN_TEST_TENSION:
    case GN_TEST_TRIAXIAL:
    case GN_TEST_BIAXIAL:
    case GN_TEST_OEDOMETER:
    case GN_TEST_KINDS:
        break;
    }
    return prism(ctx, dem, boundary, solids);
}

const char *gn_test_area_source(const gn_step_context *ctx) {
    const gn_test *t = &ctx->scene.test;
    switch (t->kind) {
    case GN_TEST_BRAZILIAN:
        return "pi/2 times diameter and thickness: the force over it is 2 P/(pi D t)";
    case GN_TEST_BENDING:
        return "the force over it is the stress in the fibre below mid-span";
    case GN_TEST_SIMPLE_SHEAR:
        return "the section of the periodic box";
    case GN_TEST_HYDROSTATIC:
    case GN_TEST_NONE:
        return "";
    case GN_TEST_SHEAR:
    case GN_TEST_COMPRESSION:
    case GN_TEST_TENSION:
    case GN_TEST_TRIAXIAL:
    case GN_TEST_BIAXIAL:
    case GN_TEST_OEDOMETER:
    case GN_TEST_KINDS:
        break;
    }
    if (t->area > 0.0 || t->diameter > 0.0) return "";
    return t->kind == GN_TEST_SHEAR ? "that volume over the height" : "that volume over the length";
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
    bool held = add_list(ctx, dem, box, &r, &dem->bonds, sigma) &&
                add_list(ctx, dem, box, &r, &dem->pairs, sigma);
    for (int k = 0; k < 9; k++) sigma[k] = held ? sigma[k] / volume : NAN;
}
