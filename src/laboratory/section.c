/* A bar whose section A(x) varies is shortened by F/E times the integral of 1/A under the force F,
 * so that E = F/d L m with m the mean of 1/A over the length L that is strained. The mean strain of
 * the volume is F/(E V/L), as the integral of A F/(E A) is F L/E. Both hold for slender bars, in
 * which the stress is uniform over every section. */
#include "laboratory/section.h"

#include "fem/solid.h"
#include "frame/step_context.h"
#include "laboratory/geometry.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "particles/sets.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "test_kinds/readings.h"
#include "world/world.h"

#include <math.h>

enum { SLABS_LEAST = 4, SLABS_MOST = 64 };

/* Mean of A times mean of 1/A from which a section varies: packings of a prism have up to 1.005. */
static const double varying = 1.02;
/* Narrowest over mean section below which stresses are not those of a bar. */
static const double pointed = 0.2;

typedef struct slabs {
    size_t count;
    double lower, thick;       /* m, along the axis */
    double volume[SLABS_MOST]; /* m3 of solid */
} slabs;

/* Volume of a ball (2D: disc) below the height h over its centre. */
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

/* As if it had the same section all along. */
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

/* m: the innermost place of an end that holds a part of the specimen. `sense` +1: the lower end. */
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

/* Tells whether a section is less than others before and behind it: the body is not convex. */
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

/* --- where the bar is not slender --- */

/* Half the width, or the radius of the circle of the same area. */
static double half_width(const slabs *s, size_t k, int dimension, double solid) {
    const double area = s->volume[k] / s->thick / solid;
    return dimension == 2 ? 0.5 * area : sqrt(area / M_PI);
}

/* Tangent of the angle to the axis of the cone within which stress spreads into a wider part. A
 * plate twice as wide beside a waist of 0.4 of its length is less stiff than a slender bar by 0.11
 * of finite elements and 0.22 of 1600 discs, a cylinder of spheres with a waist of 0.55 by 0.35. */
static const double spreads_elements = 0.4, spreads_particles = 0.2;

/* Share by which the integral of 1/A is too small: corners beside the cone bear nothing. Where the
 * section changes more slowly than that, shear stresses add their energy, E/G c (slope)^2 with E/G
 * of 2.5 and c of 1/3 in the plane and 1/2 round the axis. */
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

/* The section matters to tests that read the modulus of a prism. */
static bool is_known(const gn_step_context *ctx, const gn_solids *solids) {
    const bool read = gn_scene_tested(&ctx->scene) &&
                      gn_reading_belongs(GN_READING_young_modulus, ctx->scene.test.kind, false);
    const bool both = ctx->scene.has_specimen && solids->count;
    return read && !both && !ctx->scene.has_couple && !(ctx->effects & GN_FX_PERIODIC) &&
           !gn_scene_has_flow(&ctx->scene);
}

gn_bar_section gn_section_of(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_solids *solids) {
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
    return (gn_bar_section){.mean = sum / s.thick / solid,
                            .narrowest = least / s.thick / solid,
                            .uneven = sum * inverse,
                            .length = s.thick * (double)s.count,
                            .waist = waist,
                            .guessed = ctx->volume_source == GN_VOLUME_OF_TEST ||
                                       (waist && ctx->volume_source == GN_VOLUME_OF_HULL),
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
    return ctx->test_area * gn_world_side(ctx, solids, (int)ctx->scene.test.axis) / ctx->volume;
}
