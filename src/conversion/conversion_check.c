/* What is ready to be converted, for who checks a scene. */
#include "base/ball.h"
#include "base/error.h"
#include "base/memory.h"
#include "conversion/conversion.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "limit/step_limits.h"
#include "neigh/pairs.h"
#include "particles/dem.h"
#include "particles/lists.h"
#include "particles/observe.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "timestep/step_limit.h"
#include "world/world.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

/* --- what is in the box --- */

/* The mean side of the boxes about elements in the box of the scene; kg of these. */
static double measure_elements(const gn_fem_solid *b, const uint8_t *kind,
                               gn_conversion_figures *f) {
    double mass = 0.0, sum = 0.0, least = INFINITY;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double side = 0.0;
        if (kind[e] == GN_FRONT_FIXED) continue;
        for (int k = 0; k < b->dimension; k++) {
            double lower = INFINITY, upper = -INFINITY;
            for (int a = 0; a <= b->dimension; a++) {
                double x =
                    b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + (size_t)k];
                lower = fmin(lower, x);
                upper = fmax(upper, x);
            }
            side += (upper - lower) / b->dimension;
        }
        sum += side;
        least = fmin(least, side);
        mass += b->density[b->elements.material[e]] * b->elements.volume[e];
        f->elements++;
        f->held += kind[e] == GN_FRONT_HELD;
    }
    f->element = f->elements ? sum / (double)f->elements : 0.0;
    f->smallest = f->elements ? least : 0.0;
    return mass;
}

enum { STRAINS = 6 };

/* Sums by material of the elements: stiffnesses, kg, m3 of spheres. */
typedef struct boxed {
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_boundary *boundary;
    const gn_solids *solids;
    const uint8_t *kind;
    const int32_t *place;
    gn_conversion_figures *figures;
    double stiffness[GN_ZONE_MATERIALS], mass[GN_ZONE_MATERIALS], volume[GN_ZONE_MATERIALS];
    double tensor[GN_ZONE_MATERIALS][STRAINS][STRAINS]; /* N m, by xx yy zz 2xy 2yz 2zx */
} boxed;

/* Who has woken has bonds that are no longer put by. At the start, before any sleeps, all count. */
static int32_t element_of(const boxed *q, int32_t p) {
    if (q->dem->prepared.soa.capacity && !gn_particle_is_dormant(q->dem, (size_t)p)) return -1;
    const int32_t e = q->place[gn_dormant_element(q->dem, (size_t)p)];
    return e < 0 || q->kind[e] == GN_FRONT_FIXED ? -1 : e;
}

static size_t material_of(const boxed *q, int32_t e) {
    gn_conversion_figures *f = q->figures;
    const int32_t material = gn_coupled_solid(q->solids)->elements.material[e];
    size_t k = 0;
    while (k < f->materials && f->material[k].material != material) k++;
    if (k == f->materials && k < GN_ZONE_MATERIALS) f->material[f->materials++].material = material;
    return k < GN_ZONE_MATERIALS ? k : k - 1;
}

/* Masses, volumes and the elements' moduli, of particles awake or not. */
static void add_particles(boxed *q) {
    const gn_particles *a = &q->dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(q->solids);
    for (size_t p = 0; p < a->soa.count; p++) {
        const int32_t e = element_of(q, (int32_t)p);
        if (e < 0) continue;
        const size_t k = material_of(q, e);
        gn_zone_material *m = &q->figures->material[k];
        q->mass[k] +=
            1.0 / (gn_particle_is_dormant(q->dem, p) ? gn_dormant_of(q->dem, p)->inverse_mass
                                                     : a->vel[4 * p + 3]);
        q->volume[k] += gn_ball_volume(b->dimension, a->pos[4 * p + 3]);
        m->modulus[1] += b->elements.lambda[e] + 2.0 * b->elements.mu[e];
        m->density[1] += b->density[b->elements.material[e]];
        m->particles++;
        q->figures->diameter += 2.0 * a->pos[4 * p + 3];
        q->figures->particles++;
    }
}

/* Adds a spring: with the strain e it holds 1/2 l^2 (k_n (n.e n)^2 + k_t |e n - (n.e n) n|^2). */
static void add_spring(double sum[STRAINS][STRAINS], const double l[3], double length2, double kn,
                       double kt) {
    const double n[3] = {l[0] / sqrt(length2), l[1] / sqrt(length2), l[2] / sqrt(length2)};
    const double along[STRAINS] = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                                   n[0] * n[1], n[1] * n[2], n[2] * n[0]};
    const double of[3][STRAINS] = {{n[0], 0.0, 0.0, 0.5 * n[1], 0.0, 0.5 * n[2]},
                                   {0.0, n[1], 0.0, 0.5 * n[0], 0.5 * n[2], 0.0},
                                   {0.0, 0.0, n[2], 0.0, 0.5 * n[1], 0.5 * n[0]}};
    for (int a = 0; a < STRAINS; a++)
        for (int b = 0; b < STRAINS; b++) {
            double pull = 0.0;
            for (int k = 0; k < 3; k++) pull += of[k][a] * of[k][b];
            sum[a][b] += length2 * ((kn - kt) * along[a] * along[b] + kt * pull);
        }
}

/* Of a strain along one axis, the mean over the axes; springs count half for each end. */
static void add_bonds(boxed *q) {
    const gn_contacts *list = &q->dem->prepared;
    const double *start = q->dem->particles.start;
    const int d = (int)q->ctx->scene.dimension;
    for (size_t c = 0; c < list->soa.count; c++) {
        const int32_t end[2] = {list->i[c], list->j[c]};
        const double kt = list->kt ? list->kt[c] : 0.0;
        double l[3], sum = 0.0;
        const double length2 =
            gn_branch(q->ctx, start + 4 * (size_t)end[0], start + 4 * (size_t)end[1], l);
        for (int a = 0; a < d; a++) {
            const double along = l[a] * l[a] / length2;
            sum += length2 * along * (list->kn[c] * along + kt * (1.0 - along)) / d;
        }
        for (int k = 0; k < 2; k++) {
            const int32_t e = element_of(q, end[k]);
            if (e < 0) continue;
            q->stiffness[material_of(q, e)] += 0.5 * sum;
            add_spring(q->tensor[material_of(q, e)], l, length2, 0.5 * list->kn[c], 0.5 * kt);
        }
    }
}

/* Pa: what it takes to stretch the packing along each axis whose sides are free; 0: nothing holds
 * it. In the plane that of plane strain. */
static void find_tension(const boxed *q, size_t k, double volume, double tension[3]) {
    const size_t d = (size_t)q->ctx->scene.dimension, n = d == 3 ? STRAINS : 3;
    const size_t of[2][STRAINS] = {{0, 1, 3}, {0, 1, 2, 3, 4, 5}};
    for (size_t axis = 0; axis < d; axis++) {
        double m[GN_BASIS_MOST][GN_BASIS_MOST] = {{0.0}}, f[GN_BASIS_MOST] = {0.0};
        for (size_t a = 0; a < n; a++)
            for (size_t b = 0; b < n; b++) m[a][b] = q->tensor[k][of[d == 3][a]][of[d == 3][b]];
        f[axis] = volume;
        tension[axis] = gn_solve_positive(n, m, f) && f[axis] > 0.0 ? 1.0 / f[axis] : 0.0;
    }
}

/* Pa, of the elements: the same. */
static double young_of(const boxed *q, int32_t material) {
    const gn_elements *of = &gn_coupled_solid(q->solids)->elements;
    size_t e = 0;
    while (e + 1 < of->soa.count && of->material[e] != material) e++;
    const double lambda = of->lambda[e], mu = of->mu[e];
    if (q->ctx->scene.dimension == 2) return 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu);
    return mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}

/* kg of the particles in these elements. */
static double measure_particles(boxed *q) {
    const double solid = 1.0 - gn_dem_porosity(q->ctx, q->dem);
    gn_conversion_figures *f = q->figures;
    double mass = 0.0;
    add_particles(q);
    add_bonds(q);
    f->diameter = f->particles ? f->diameter / (double)f->particles : 0.0;
    for (size_t k = 0; k < f->materials; k++) {
        mass += q->mass[k];
        gn_zone_compare(&f->material[k], q->stiffness[k], q->mass[k], q->volume[k] / solid);
        find_tension(q, k, q->volume[k] / solid, f->material[k].tension);
        f->material[k].tension[3] =
            f->material[k].particles ? young_of(q, f->material[k].material) : 0.0;
    }
    return mass;
}

/* --- neighbours --- */

/* Of r_i + r_j: what pushes less than some 1e-6 of the modulus is rounding of a packing. */
static const double overlap_most = 1e-6;

static bool is_bonded(const gn_contacts *bonds, int32_t i, int32_t j) {
    const size_t at = gn_contacts_from(bonds, i, j);
    return at < bonds->soa.count && bonds->i[at] == i && bonds->j[at] == j;
}

/* What of r_i + r_j two particles overlap by. */
static double overlap_of(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j) {
    const double *a = dem->particles.pos + 4 * (size_t)i, *b = dem->particles.pos + 4 * (size_t)j;
    double d[3];
    return 1.0 - sqrt(gn_branch(ctx, a, b, d)) / (a[3] + b[3]);
}

static gneiss_status refuse_overlaps(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_pair_list *pairs, gneiss_error *error) {
    size_t count = 0, deepest = 0;
    double most = overlap_most;
    for (size_t c = 0; c < pairs->count; c++) {
        const int32_t i = pairs->pair[c][0], j = pairs->pair[c][1];
        const double overlap = overlap_of(ctx, dem, i, j);
        if (!(overlap > overlap_most) || is_bonded(&dem->bonds.contacts, i, j)) continue;
        count++;
        if (overlap > most) deepest = c;
        most = fmax(most, overlap);
    }
    if (!count) return GNEISS_OK;
    const int32_t a = dem->particles.id[pairs->pair[deepest][0]],
                  b = dem->particles.id[pairs->pair[deepest][1]];
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a bond between all particles that overlap, found %zu pairs "
                   "without one, particles %d and %d by %.3g %% of r_i + r_j: they would push each "
                   "other apart as they wake (one cohesive group, bonds.overlap_range 1, or "
                   "specimen.packing.overlap none)",
                   gn_scene_at(&ctx->scene, ctx->scene.couple.convert.where, "couple.convert").text,
                   count, a < b ? a : b, a < b ? b : a, 100.0 * most);
}

static gneiss_status check_free_of_stress(const gn_step_context *ctx, const gn_dem *dem,
                                          gneiss_error *error) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    for (size_t c = 0; !ctx->scene.passive_gaps && c < bonds->soa.count; c++) {
        const double overlap = overlap_of(ctx, dem, bonds->i[c], bonds->j[c]);
        const int32_t a = dem->particles.id[bonds->i[c]], b = dem->particles.id[bonds->j[c]];
        if (fabs(overlap) <= overlap_most) continue;
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected bonds that are free of stress as they are, found that of "
            "particles %d and %d with %s of %.3g %% of r_i + r_j (bonds.passive_gaps)",
            gn_scene_at(&ctx->scene, ctx->scene.couple.convert.where, "couple.convert").text,
            a < b ? a : b, a < b ? b : a, overlap > 0.0 ? "an overlap" : "a gap",
            100.0 * fabs(overlap));
    }
    return GNEISS_OK;
}

gneiss_status gn_conversion_check_neighbours(const gn_step_context *ctx, const gn_dem *dem,
                                             gneiss_error *error) {
    const gn_pair_query query = {&dem->particles, (int)ctx->scene.dimension, 0.0, 0.0, false, {0.0},
                                 ctx->threads};
    gn_pair_list pairs = {0};
    GN_TRY(check_free_of_stress(ctx, dem, error));
    gneiss_status status = gn_pairs_find(&query, &pairs, error);
    if (status == GNEISS_OK) status = refuse_overlaps(ctx, dem, &pairs, error);
    gn_pair_list_free(&pairs);
    return status;
}

/* --- all of them awake --- */

static void swap(double *a, double *b) {
    const double before = *a;
    *a = *b;
    *b = before;
}

void gn_conversion_turn_over(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    const gn_contacts bonds = dem->bonds.contacts;
    if (!gn_converts(ctx)) return;
    for (size_t p = 0; p < q->soa.count; p++) {
        swap(q->vel + 4 * p + 3, &gn_dormant_of(dem, p)->inverse_mass);
        if (q->spin) swap(q->spin + 4 * p + 3, &gn_dormant_of(dem, p)->inverse_inertia);
    }
    dem->bonds.contacts = dem->prepared;
    dem->prepared = bonds;
}

gneiss_status gn_conversion_limit(gn_world *w, gn_step_limit *limit, gneiss_error *error) {
    const gn_step_limit before = w->dem.limit;
    const double stable = w->dem.stable;
    bool due;
    gn_conversion_turn_over(&w->ctx, &w->dem);
    gneiss_status status = gn_dem_limit(w, true, &due, error);
    gn_conversion_turn_over(&w->ctx, &w->dem);
    *limit = w->dem.limit;
    w->dem.limit = before;
    w->dem.stable = stable;
    return status;
}

static double shortest_side(const gn_step_context *ctx, const gn_solids *solids) {
    double side[3], least = INFINITY;
    gn_elements_sides(solids, side);
    for (int a = 0; a < (int)ctx->scene.dimension; a++) least = fmin(least, side[a]);
    return least;
}

gneiss_status gn_conversion_measure(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gn_conversion_figures *f, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    size_t count;
    uint8_t *kind = gn_alloc(b->elements.soa.count + 1);
    int32_t *place = gn_fem_places(b, &count);
    *f = (gn_conversion_figures){.side = shortest_side(ctx, solids)};
    gneiss_status status =
        kind && place ? gn_conversion_kinds(ctx, solids, kind, error)
                      : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at elements");
    if (status == GNEISS_OK) {
        const double elements = measure_elements(b, kind, f);
        boxed q = {.ctx = ctx,
                   .dem = dem,
                   .boundary = boundary,
                   .solids = solids,
                   .kind = kind,
                   .place = place,
                   .figures = f};
        f->mass = measure_particles(&q) / elements;
    }
    gn_free(kind);
    gn_free(place);
    return status;
}

/* --- places --- */

static gneiss_status see(gn_world *w, const uint8_t *ready, size_t e, uint8_t *kind,
                         gn_conversion_places_seen *seen, gneiss_error *error) {
    int rings;
    memcpy(kind, ready, gn_conversion_elements(&w->solids));
    kind[e] = GN_FRONT_LEAVING;
    GN_TRY(gn_conversion_rehearse(w, kind, &rings, error));
    const bool thin = gn_conversion_was_thin(&w->outcome), halted = *w->outcome.halt;
    *w->outcome.halt = '\0';
    if (halted && !thin) return GNEISS_OK;
    seen->looked++;
    seen->too_few += thin;
    seen->along += rings > 0 && !thin;
    return GNEISS_OK;
}

/* Evenly over the list; of large bodies fewer, as each looks at all of them. */
gneiss_status gn_conversion_see_places(gn_world *w, gn_conversion_places_seen *seen,
                                       gneiss_error *error) {
    const size_t elements = gn_conversion_elements(&w->solids),
                 size = elements + w->dem.particles.soa.count;
    const size_t most = size < 100000 ? 100 : size < 1000000 ? 25 : 6;
    uint8_t *ready = gn_alloc(elements + 1), *kind = gn_alloc(elements + 1);
    size_t count = 0, at = 0;
    *seen = (gn_conversion_places_seen){0};
    gneiss_status status =
        ready && kind ? gn_conversion_kinds(&w->ctx, &w->solids, ready, error)
                      : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at elements");
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++)
        count += ready[e] == GN_FRONT_READY;
    const size_t stride = count > most ? (count + most - 1) / most : 1;
    for (size_t e = 0; status == GNEISS_OK && e < elements; e++)
        if (ready[e] == GN_FRONT_READY && at++ % stride == 0)
            status = see(w, ready, e, kind, seen, error);
    gn_free(ready);
    gn_free(kind);
    return status;
}
