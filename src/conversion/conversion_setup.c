/* Preparation of a body whose elements convert: checks, dormant particles, and the properties that
 * `gneiss check` prints. */
#include "base/ball.h"
#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "conversion/conversion.h"
#include "conversion/conversion_private.h"
#include "couple/front.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "kernels/partials.h"
#include "limit/step_limits.h"
#include "neigh/neigh.h"
#include "particles/dormant.h"
#include "particles/lists.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/records.h"
#include "solids/dormant_places.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

#include <math.h>
#include <string.h>

static gneiss_status refuse(const gn_step_context *ctx, gn_scene_place where, const char *key,
                            const char *message, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s", gn_scene_at(&ctx->scene, where, key).text,
                   message);
}

/* --- at the start --- */

/* Refuses laws whose springs between particles do not follow from a strain of the body. */
static gneiss_status check_law(const gn_step_context *ctx, gneiss_error *error) {
    const gn_effects without = GN_FX_BOND_MOMENTS | GN_FX_ROLLING | GN_FX_HERTZ | GN_FX_CONFINED;
    if (!(ctx->effects & GN_FX_BONDS))
        return refuse(ctx, ctx->scene.couple.convert.where, "bonds",
                      "expected bonds beside couple.convert, found none", error);
    if (!(ctx->effects & without)) return GNEISS_OK;
    const bool moments = ctx->effects & GN_FX_BOND_MOMENTS, rolling = ctx->effects & GN_FX_ROLLING;
    return refuse(ctx, moments ? ctx->scene.couple.convert.where : ctx->scene.law_where,
                  moments   ? "bonds.radius_multiplier"
                  : rolling ? "materials"
                            : "law",
                  "expected linear contacts without moments, resistance to rolling and confined "
                  "friction beside couple.convert, found others",
                  error);
}

/* Refuses a zone as wide as the body, because no element would be left after the first conversion.
 */
static gneiss_status check_width(const gn_step_context *ctx, const gn_solids *solids,
                                 gneiss_error *error) {
    const double side = gn_elements_longest_side(ctx, solids);
    char message[160];
    if (ctx->scene.couple.convert.width < side) return GNEISS_OK;
    snprintf(message, sizeof message,
             "expected a zone that is narrower than the body of %g m, found %g m", side,
             ctx->scene.couple.convert.width);
    return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.width", message, error);
}

static gneiss_status find_homes(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                                const gn_ties *ties, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const gn_elements *elements = &gn_coupled_solid(solids)->elements;
    char at[GN_POINT_SIZE], message[256];
    GN_TRY(gn_dormant_create(dem, error));
    for (size_t k = 0; k < ties->count; k++) /* particles are still in the order of their ids */
        gn_dormant_of(dem, (size_t)ties->tie[k].id)->element = elements->id[ties->tie[k].element];
    for (size_t p = 0; p < q->soa.count; p++) {
        q->blend[2 * p] = q->blend[2 * p + 1] = 1.0;
        if (gn_dormant_of(dem, p)->element >= 0) continue;
        snprintf(message, sizeof message,
                 "expected every particle in an element, found particle %d at %s m in none",
                 q->id[p], gn_point_text(ctx->scene.origin, q->start + 4 * p, at));
        return refuse(ctx, ctx->scene.specimen.where, "specimen", message, error);
    }
    return GNEISS_OK;
}

/* Checks that the elements that may convert contain particles. */
static gneiss_status check_filled(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  gneiss_error *error) {
    gn_conversion_figures f;
    char message[200];
    GN_TRY(gn_conversion_measure(ctx, dem, boundary, solids, &f, error));
    if (!f.elements)
        return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.box",
                      "expected elements of which all nodes start in the box, found none", error);
    if (fabs(f.mass - 1.0) <= 0.1) return GNEISS_OK;
    snprintf(message, sizeof message,
             "expected particles that weigh what the elements in the box do (to a tenth: a packing "
             "that fills it, density_basis bulk, one density), found %g times as much",
             f.mass);
    return refuse(ctx, ctx->scene.specimen.where, "specimen", message, error);
}

/* Refuses a box in which every possible conversion would have a zone that reaches elements outside
 * of it: the first conversion would end the run. Elements that only motions and loads keep from
 * converting do not count here. */
static gneiss_status check_room(const gn_step_context *ctx, const gn_solids *solids,
                                gneiss_error *error) {
    const double width = ctx->scene.couple.convert.width, enough = (1.0 - 1e-9) * width;
    char message[256];
    double room = 0.0;
    size_t ready = 0;
    uint8_t *kind = gn_alloc(gn_elements_left_count(solids) + 1);
    gneiss_status status =
        kind ? gn_conversion_kinds(ctx, solids, kind, error) : gn_conversion_no_memory(error);
    if (status == GNEISS_OK)
        status = gn_front_room(gn_coupled_solid(solids), kind, enough, &room, error);
    for (size_t e = 0; status == GNEISS_OK && e < gn_elements_left_count(solids); e++)
        ready += kind[e] == GN_FRONT_READY;
    gn_free(kind);
    if (status != GNEISS_OK || !ready || room >= enough) return status;
    snprintf(
        message, sizeof message,
        "expected a zone that is no wider than the %.4g m that are left between some element "
        "and what is outside of couple.convert.box (or a larger box, with a packing that fills "
        "it), found %g m",
        room, width);
    return refuse(ctx, ctx->scene.couple.convert.where, "couple.convert.width", message, error);
}

gneiss_status gn_conversion_prepare(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gneiss_error *error) {
    gn_ties ties;
    GN_TRY(gn_zones_check_law(ctx, error));
    GN_TRY(check_law(ctx, error));
    GN_TRY(check_width(ctx, solids, error));
    GN_TRY(gn_ties_find(gn_coupled_solid(solids), &dem->particles, &ties, error));
    gneiss_status status = find_homes(ctx, dem, solids, &ties, error);
    gn_ties_free(&ties);
    if (status == GNEISS_OK) status = check_filled(ctx, dem, boundary, solids, error);
    return status == GNEISS_OK ? check_room(ctx, solids, error) : status;
}

/* Stores the difference between particles and elements; if everything has converted, there is none.
 */
static gneiss_status keep_difference(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids,
                                     gn_conversions *converted, gneiss_error *error) {
    gn_conversion_figures f;
    GN_TRY(gn_conversion_measure(ctx, dem, boundary, solids, &f, error));
    for (size_t k = f.materials; k-- > 0;) {
        const gn_zone_material *m = &f.material[k];
        if (!gn_zone_differs(m)) continue;
        memcpy(converted->differs.modulus, m->modulus, sizeof m->modulus);
        memcpy(converted->differs.density, m->density, sizeof m->density);
        memcpy(converted->differs.tension, m->tension, sizeof m->tension);
    }
    return GNEISS_OK;
}

/* --- properties of the box --- */

/* Computes the mean side of the bounding boxes of the elements in the scene's box, and their mass,
 * kg. */
static double measure_elements(const gn_fem_solid *solid, const uint8_t *kind,
                               gn_conversion_figures *figures) {
    double mass = 0.0, sum = 0.0, least = INFINITY;
    for (size_t e = 0; e < solid->elements.soa.count; e++) {
        double side = 0.0;
        if (kind[e] == GN_FRONT_FIXED) continue;
        for (int k = 0; k < solid->dimension; k++) {
            double lower = INFINITY, upper = -INFINITY;
            for (int a = 0; a <= solid->dimension; a++) {
                double x =
                    solid->nodes
                        .start[4 * (size_t)gn_elements_node(&solid->elements, a)[e] + (size_t)k];
                lower = fmin(lower, x);
                upper = fmax(upper, x);
            }
            side += (upper - lower) / solid->dimension;
        }
        sum += side;
        least = fmin(least, side);
        mass += solid->density[solid->elements.material[e]] * solid->elements.volume[e];
        figures->elements++;
        figures->held += kind[e] == GN_FRONT_HELD;
    }
    figures->element = figures->elements ? sum / (double)figures->elements : 0.0;
    figures->smallest = figures->elements ? least : 0.0;
    return mass;
}

enum { STRAINS = 6 };

/* Sums over elements and particles in the box, by material of the elements: stiffnesses, kg, m3 of
 * spheres. */
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

/* Returns the element of a particle. At the start all particles count; later active particles,
 * whose bonds are no longer stored, have none. */
static int32_t element_of(const boxed *q, int32_t p) {
    if (q->dem->prepared.soa.capacity && !gn_is_dormant(q->dem, (size_t)p)) return -1;
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

/* Adds masses, volumes and the moduli of elements over active and dormant particles. */
static void add_particles(boxed *q) {
    const gn_particles *a = &q->dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(q->solids);
    for (size_t p = 0; p < a->soa.count; p++) {
        const int32_t e = element_of(q, (int32_t)p);
        if (e < 0) continue;
        const size_t k = material_of(q, e);
        gn_zone_material *m = &q->figures->material[k];
        q->mass[k] += 1.0 / (gn_is_dormant(q->dem, p) ? gn_dormant_of(q->dem, p)->inverse_mass
                                                      : a->vel[4 * p + 3]);
        q->volume[k] += gn_ball_volume(b->dimension, a->pos[4 * p + 3]);
        m->modulus[1] += b->elements.lambda[e] + 2.0 * b->elements.mu[e];
        m->density[1] += b->density[b->elements.material[e]];
        m->particles++;
        q->figures->diameter += 2.0 * a->pos[4 * p + 3];
        q->figures->particles++;
    }
}

/* Adds a spring, whose energy at the strain e is 1/2 l^2 (k_n (n.e n)^2 + k_t |e n - (n.e n) n|^2).
 */
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

/* Adds the stiffness of bonds against strain; half of a bond belongs to each end. */
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

/* Computes the modulus, Pa, of the packing in tension along each axis with free sides (plane strain
 * in 2D); 0: it has no stiffness. */
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

/* Returns the Young's modulus of the elements of a material, Pa. */
static double young_of(const boxed *q, int32_t material) {
    const gn_elements *of = &gn_coupled_solid(q->solids)->elements;
    size_t e = 0;
    while (e + 1 < of->soa.count && of->material[e] != material) e++;
    const double lambda = of->lambda[e], mu = of->mu[e];
    if (q->ctx->scene.dimension == 2) return 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu);
    return mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
}

/* Returns the mass of the particles in these elements, kg. */
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

/* Largest overlap over r_i + r_j that counts as rounding of a packing; it corresponds to a stress
 * of some 1e-6 of the modulus. */
static const double overlap_most = 1e-6;

static bool is_bonded(const gn_contacts *bonds, int32_t i, int32_t j) {
    const size_t at = gn_contacts_from(bonds, i, j);
    return at < bonds->soa.count && bonds->i[at] == i && bonds->j[at] == j;
}

/* Returns the overlap of two particles over r_i + r_j. */
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
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected a bond between all particles that overlap, found %zu pairs "
        "without one, particles %d and %d by %.3g %% of r_i + r_j: they would push each "
        "other apart once they are active (one cohesive group, bonds.overlap_range 1, or "
        "specimen.packing.overlap none)",
        gn_scene_at(&ctx->scene, ctx->scene.couple.convert.where, "couple.convert").text, count,
        a < b ? a : b, a < b ? b : a, 100.0 * most);
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

/* Checks by the bonds of all particles that released particles are loaded only by the strain of the
 * body. */
static gneiss_status check_neighbours(const gn_step_context *ctx, const gn_dem *dem,
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

gneiss_status gn_conversion_deactivate_all(const gn_step_context *ctx, gn_dem *dem,
                                           const gn_boundary *boundary, const gn_solids *solids,
                                           gn_conversions *converted, gneiss_error *error) {
    GN_TRY(check_neighbours(ctx, dem, error));
    GN_TRY(gn_dormant_deactivate_all(ctx, dem, error));
    return keep_difference(ctx, dem, boundary, solids, converted, error);
}

/* --- all particles active --- */

gneiss_status gn_conversion_limit(const gn_convertible *model, gn_step_limit *limit,
                                  gneiss_error *error) {
    const gn_step_limit before = model->ctx->choice.limit;
    const double stable = model->ctx->choice.stable;
    bool due;
    gn_dormant_swap(model->ctx, model->dem);
    gneiss_status status =
        gn_timestep_particle_limit(model->ctx, model->dem, model->boundary, model->solids,
                                   model->zones, model->ledger, true, &due, error);
    gn_dormant_swap(model->ctx, model->dem);
    *limit = model->ctx->choice.limit;
    model->ctx->choice.limit = before;
    model->ctx->choice.stable = stable;
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
                                    gn_conversion_figures *figures, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    size_t count;
    uint8_t *kind = gn_alloc(b->elements.soa.count + 1);
    int32_t *place = gn_fem_places(b, &count);
    *figures = (gn_conversion_figures){.side = shortest_side(ctx, solids)};
    gneiss_status status = kind && place
                               ? gn_conversion_kinds(ctx, solids, kind, error)
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to check elements");
    if (status == GNEISS_OK) {
        const double elements = measure_elements(b, kind, figures);
        boxed q = {.ctx = ctx,
                   .dem = dem,
                   .boundary = boundary,
                   .solids = solids,
                   .kind = kind,
                   .place = place,
                   .figures = figures};
        figures->mass = measure_particles(&q) / elements;
    }
    gn_free(kind);
    gn_free(place);
    return status;
}
