/* Properties of zones that `gneiss check` prints. */
#include "base/ball.h"
#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "couple/zone.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "scene/couple_def.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "zones/zone_state.h"
#include "zones/zones.h"
#include "zones/zones_private.h"

#include <math.h>

/* --- contents of a zone --- */

/* Returns the position of an element in a zone, which is that of its node farthest among the
 * particles, and the extent of the element. */
static double element_place(const gn_fem_solid *b, size_t e, const gn_couple_zone *z,
                            double size[3]) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    double place = INFINITY;
    for (int a = 0; a <= b->dimension; a++) {
        const double *x = b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e];
        place = fmin(place, gn_zone_place(z, b->dimension, x));
        for (int k = 0; k < b->dimension; k++) {
            lower[k] = fmin(lower[k], x[k]);
            upper[k] = fmax(upper[k], x[k]);
        }
    }
    for (int k = 0; k < b->dimension; k++) size[k] = upper[k] - lower[k];
    return place;
}

static bool inside(double place) {
    return place >= -GN_ZONE_ROUNDING && place < 1.0 - GN_ZONE_ROUNDING;
}

/* Returns the zone that a point without weight of the particles belongs to: the point is on its
 * edge or behind it. */
static size_t nearest_zone(const gn_scene *s, const double *x) {
    size_t nearest = 0;
    double least = INFINITY;
    for (size_t k = 0; k < s->couple.zone_count; k++) {
        double place = gn_zone_place(&s->couple.zones[k], (int)s->dimension, x);
        if (place < -GN_ZONE_ROUNDING || place >= least) continue;
        least = place;
        nearest = k;
    }
    return nearest;
}

/* Tells whether a particle in an element belongs to a zone. */
static bool belongs(const gn_scene *s, size_t zone, const double *x) {
    return inside(gn_zone_place(&s->couple.zones[zone], (int)s->dimension, x)) ||
           nearest_zone(s, x) == zone;
}

/* The extent of a zone's elements across its first edge, m. */
typedef struct zone_sides {
    double along[2][3]; /* unit vectors across n */
    double lower[2], upper[2];
    size_t elements;
} zone_sides;

static zone_sides sides_of(const gn_solids *solids, const gn_couple_zone *z) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    zone_sides s = {.lower = {INFINITY, INFINITY}, .upper = {-INFINITY, -INFINITY}};
    double n[3], size[3];
    gn_zone_direction(z, b->dimension, n);
    int least = b->dimension == 2 || fabs(n[2]) <= fmin(fabs(n[0]), fabs(n[1])) ? 2
                : fabs(n[0]) <= fabs(n[1])                                      ? 0
                                                                                : 1;
    double other[3] = {0.0};
    other[least] = 1.0;
    gn_cross3(n, other, s.along[0]);
    double length = sqrt(gn_dot3(s.along[0], s.along[0]));
    for (int k = 0; k < 3; k++) s.along[0][k] /= length;
    gn_cross3(n, s.along[0], s.along[1]);
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        if (!inside(element_place(b, e, z, size))) continue;
        s.elements++;
        for (int a = 0; a <= b->dimension; a++)
            for (int k = 0; k < 2; k++) {
                double at = gn_dot3(
                    s.along[k], b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e]);
                s.lower[k] = fmin(s.lower[k], at);
                s.upper[k] = fmax(s.upper[k], at);
            }
    }
    return s;
}

static bool between_sides(const zone_sides *s, const double *x) {
    for (int k = 0; k < 2; k++) {
        double at = gn_dot3(s->along[k], x), some = 1e-6 * (s->upper[k] - s->lower[k]);
        if (at < s->lower[k] - some || at > s->upper[k] + some) return false;
    }
    return true;
}

/* Tells whether a particle outside of all elements should be in an element of a zone: it is between
 * the zone's planes, not beside the zone's elements, and not in front of those of another zone, as
 * where two sides of a block of elements meet. */
static bool is_missing(const gn_scene *s, const zone_sides *sides, size_t zone, const double *x) {
    const int dimension = (int)s->dimension;
    double place = gn_zone_place(&s->couple.zones[zone], dimension, x);
    if (place < 1e-6 || place > 1.0 - 1e-6) return false;
    if (between_sides(&sides[zone], x)) return true;
    for (size_t k = 0; k < s->couple.zone_count; k++)
        if (gn_zone_place(&s->couple.zones[k], dimension, x) < 0.0 && between_sides(&sides[k], x))
            return false;
    return true;
}

static gneiss_status check_inside(const gn_step_context *ctx, const gn_dem *dem,
                                  const gn_ties *ties, const zone_sides *sides,
                                  gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    char at[GN_POINT_SIZE];
    size_t next = 0;
    for (size_t p = 0; p < q->soa.count; p++) { /* particles are still sorted by their ids */
        if (next < ties->count && ties->tie[next].id == q->id[p]) {
            next++;
            continue;
        }
        for (size_t k = 0; k < ctx->scene.couple.zone_count; k++)
            if (is_missing(&ctx->scene, sides, k, q->start + 4 * p))
                return gn_fail(error, GNEISS_ERROR_INPUT,
                               "%.400s:%d:%d: couple.zones: expected every particle of the zone in "
                               "an element, "
                               "found particle %d at %s m in none",
                               ctx->scene.source, ctx->scene.couple.zones[k].where.line,
                               ctx->scene.couple.zones[k].where.column, q->id[p],
                               gn_point_text(ctx->scene.origin, q->start + 4 * p, at));
    }
    return GNEISS_OK;
}

static gneiss_status check_occupied(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_ties *ties, size_t zone, size_t elements,
                                    gneiss_error *error) {
    const gn_couple_zone *z = &ctx->scene.couple.zones[zone];
    size_t particles = 0;
    for (size_t t = 0; t < ties->count; t++)
        particles += inside(gn_zone_place(z, (int)ctx->scene.dimension,
                                          dem->particles.start + 4 * (size_t)ties->tie[t].id));
    if (elements && particles) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%.400s:%d:%d: couple.zones[%zu]: expected elements, and particles in them, "
                   "between the planes through `from` and `to`, found no %s",
                   ctx->scene.source, z->where.line, z->where.column, zone,
                   elements ? "particle" : "element");
}

/* Checks that particles of zones start at rest, as the nodes do, unless springs connect them;
 * slaved spins must start at rest, too. */
static gneiss_status check_at_rest(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_ties *ties, gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    const bool springs = ctx->scene.couple.constraint == GN_COUPLE_PENALTY,
               slaved = ctx->scene.couple.spins == GN_COUPLE_SLAVED && q->spin;
    for (size_t k = 0; k < ties->count; k++) {
        const int32_t id = ties->tie[k].id;
        const size_t p = 4 * (size_t)id;
        const double *v = q->vel + p, *o = slaved ? q->spin + p : NULL;
        const bool moves = !springs && (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0);
        const bool turns = slaved && (o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0);
        if (!moves && !turns) continue;
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%.400s:%d:%d: couple: expected particles of zones that start at rest, as "
                       "the nodes that move them do, found particle %d with a %s (%s)",
                       ctx->scene.source, ctx->scene.couple.where.line,
                       ctx->scene.couple.where.column, id, moves ? "velocity" : "spin",
                       moves ? "initial_velocity, initial.random_velocity" : "initial_spin");
    }
    return GNEISS_OK;
}

gneiss_status gn_zones_check(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             const gn_ties *ties, gneiss_error *error) {
    const size_t count = ctx->scene.couple.zone_count;
    zone_sides *sides = NULL;
    GN_TRY(gn_new(&sides, count + 1, "zones", error));
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; k < count && status == GNEISS_OK; k++) {
        sides[k] = sides_of(solids, &ctx->scene.couple.zones[k]);
        status = check_occupied(ctx, dem, ties, k, sides[k].elements, error);
    }
    if (status == GNEISS_OK) status = check_inside(ctx, dem, ties, sides, error);
    if (status == GNEISS_OK) status = check_at_rest(ctx, dem, ties, error);
    gn_free(sides);
    return status;
}

/* --- figures --- */

/* Largest share of a wave's energy that a difference may return; 12 % of a modulus cause as much.
 */
static const double returned_most = 1e-3;

/* Computes the mean side of the boxes around a zone's elements and the least weight of a node. */
static void measure_elements(const gn_step_context *ctx, const gn_solids *solids, size_t zone,
                             gn_zone_figures *f) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    double sum = 0.0, size[3];
    size_t count = 0;
    f->least = 1.0;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        double place = element_place(b, e, &ctx->scene.couple.zones[zone], size);
        if (!inside(place)) continue;
        f->least = fmin(f->least, fmax(place, 0.0));
        for (int k = 0; k < b->dimension; k++) sum += size[k] / b->dimension;
        count++;
    }
    f->element = count ? sum / (double)count : 0.0;
}

static gn_zone_material *material_of(const gn_solids *solids, gn_zone_figures *f, const gn_tie *t) {
    const gn_elements *q = &gn_coupled_solid(solids)->elements;
    const int32_t material = q->material[t->element];
    size_t k = 0;
    while (k < f->materials && f->material[k].material != material) k++;
    if (k == f->materials && k < GN_ZONE_MATERIALS) f->material[f->materials++].material = material;
    if (k == GN_ZONE_MATERIALS) k--;
    return &f->material[k];
}

/* Sums over particles: moduli times volume, masses, volumes of spheres. Half of a spring belongs to
 * each end. */
typedef struct zone_sums {
    double stiffness, mass, volume;
} zone_sums;

/* Records whether a particle in a zone is in another zone as well. */
static void look_for_others(const gn_scene *s, size_t zone, const double *x, gn_zone_figures *f) {
    const int dimension = (int)s->dimension;
    if (!inside(gn_zone_place(&s->couple.zones[zone], dimension, x))) return;
    for (size_t k = 0; k < s->couple.zone_count; k++) {
        if (k == zone || !inside(gn_zone_place(&s->couple.zones[k], dimension, x))) continue;
        if (!f->shared) f->other = k;
        f->shared++;
        return;
    }
}

static void add_particle(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                         size_t zone, const gn_tie *t, size_t p, gn_zone_figures *f,
                         zone_sums *sums) {
    const gn_particles *q = &dem->particles;
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const double *blend = q->blend + 2 * p, *x = q->start + 4 * p, r = q->pos[4 * p + 3];
    gn_zone_material *m = material_of(solids, f, t);
    zone_sums *sum = &sums[m - f->material];
    sum->volume += blend[0] * gn_ball_volume(b->dimension, r);
    sum->mass += blend[0] / (q->vel[4 * p + 3] * blend[1]);
    m->particles++;
    m->modulus[1] += b->elements.lambda[t->element] + 2.0 * b->elements.mu[t->element];
    m->density[1] += b->density[b->elements.material[t->element]];
    f->particles++;
    f->diameter += 2.0 * r;
    f->edge = fmin(f->edge, blend[0]);
    double place = gn_zone_place(&ctx->scene.couple.zones[zone], b->dimension, x);
    f->beyond +=
        (place - 1.0) * f->width > 0.5 * r; /* tolerance for the scatter of the outermost centres */
    look_for_others(&ctx->scene, zone, x, f);
}

static void add_particles(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          const gn_zones *zones, size_t zone, gn_zone_figures *f, zone_sums *sums) {
    const gn_coupled *c = zones->coupled;
    f->edge = 1.0;
    for (size_t k = 0; k < c->ties.count; k++) {
        const int32_t p = c->place[k];
        if (p >= 0 && belongs(&ctx->scene, zone, dem->particles.start + 4 * (size_t)p))
            add_particle(ctx, dem, solids, zone, &c->ties.tie[k], (size_t)p, f, sums);
    }
    if (f->particles) f->diameter /= (double)f->particles;
}

/* Adds the bonds of particles in elements. Particles outside of all elements have their whole mass
 * and lie beyond the last node. */
static void add_bonds(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                      const gn_zones *zones, size_t zone, gn_zone_figures *f, zone_sums *sums) {
    const gn_coupled *c = zones->coupled;
    const gn_particles *q = &dem->particles;
    const gn_contacts *bonds = &dem->bonds.contacts;
    double n[3];
    gn_zone_direction(&ctx->scene.couple.zones[zone], (int)ctx->scene.dimension, n);
    for (size_t s = 0; s < bonds->soa.count; s++) {
        double d[3];
        const int32_t end[2] = {bonds->i[s], bonds->j[s]};
        double length2 =
            gn_branch(ctx, q->start + 4 * (size_t)end[0], q->start + 4 * (size_t)end[1], d);
        double along = gn_dot3(d, n) * gn_dot3(d, n) / length2;
        double stiffness =
            length2 * along *
            (bonds->kn[s] * along + (bonds->kt ? bonds->kt[s] * (1.0 - along) : 0.0));
        for (int k = 0; k < 2; k++) {
            const gn_tie *t = gn_coupled_tie(c, q->id[end[k]]);
            if (t && belongs(&ctx->scene, zone, q->start + 4 * (size_t)end[k]))
                sums[material_of(solids, f, t) - f->material].stiffness += 0.5 * stiffness;
        }
    }
}

void gn_zone_compare(gn_zone_material *m, double stiffness, double mass, double volume) {
    m->modulus[0] = volume > 0.0 ? stiffness / volume : 0.0;
    m->density[0] = volume > 0.0 ? mass / volume : 0.0;
    if (!m->particles) return;
    m->modulus[1] /= (double)m->particles;
    m->density[1] /= (double)m->particles;
    double z = sqrt(m->modulus[0] * m->density[0] / (m->modulus[1] * m->density[1]));
    m->returned = (1.0 - z) * (1.0 - z) / ((1.0 + z) * (1.0 + z));
}

/* Tells whether a ratio of moduli returns more than the largest share. */
static bool is_off(double quotient) {
    const double z = sqrt(quotient);
    return (1.0 - z) * (1.0 - z) > returned_most * (1.0 + z) * (1.0 + z);
}

/* Free sides soften a thin body along its axis only; this is included in the mean. */
bool gn_zone_differs(const gn_zone_material *m) {
    double mean = 0.0, most = 0.0;
    int axes = 0;
    if (!(m->modulus[0] > 0.0)) return false;
    for (int a = 0; a < 3; a++) {
        mean += m->tension[a];
        most = fmax(most, m->tension[a]);
        axes += m->tension[a] > 0.0;
    }
    if (m->returned > returned_most) return true;
    if (!axes || !(m->tension[3] > 0.0)) return false;
    most /= m->tension[3];
    return is_off(mean / axes / m->tension[3]) || (most > 1.0 && is_off(most));
}

/* Adds the particles; weights of forces and of masses cancel in the means. */
static void measure_particles(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_solids *solids, const gn_zones *zones, size_t zone,
                              gn_zone_figures *f) {
    zone_sums sums[GN_ZONE_MATERIALS] = {{0}};
    add_particles(ctx, dem, solids, zones, zone, f, sums);
    add_bonds(ctx, dem, solids, zones, zone, f, sums);
    const double solid = 1.0 - gn_dem_porosity(ctx, dem);
    for (size_t k = 0; k < f->materials; k++)
        gn_zone_compare(&f->material[k], sums[k].stiffness, sums[k].mass, sums[k].volume / solid);
}

/* Returns the weight that an element leaves to particles; 0: the element is in no zone, or leaves
 * its whole weight, so that its volume does not show it. */
static double left_by(const gn_step_context *ctx, const gn_solids *solids, size_t zone, size_t e) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    double centre[3] = {0.0}, share = 0.0;
    for (int a = 0; a <= b->dimension; a++) {
        const double *x = b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e];
        for (int k = 0; k < b->dimension; k++) centre[k] += x[k] / (b->dimension + 1);
        share += gn_zones_share(&ctx->scene, x) / (b->dimension + 1);
    }
    return inside(gn_zone_place(&ctx->scene.couple.zones[zone], b->dimension, centre)) &&
                   share > 0.0
               ? 1.0 - share
               : 0.0;
}

/* Computes the mass of the particles over the part of the mass that elements leave to them. In a
 * lattice whose first row lies on the plane through `from` it is too large by half a row. */
static void measure_mass(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                         const gn_zones *zones, size_t zone, gn_zone_figures *f) {
    const gn_coupled *c = zones->coupled;
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_particles *q = &dem->particles;
    double left = 0.0, mass = 0.0;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        const double part =
            left_by(ctx, solids, zone, e); /* the volume of an element includes its own weight */
        left += part / (1.0 - part) * b->density[b->elements.material[e]] * b->elements.volume[e];
    }
    for (size_t k = 0; k < c->ties.count; k++) {
        const size_t p = (size_t)c->place[k];
        if (c->place[k] < 0 || !(left_by(ctx, solids, zone, (size_t)c->ties.tie[k].element) > 0.0))
            continue;
        mass += q->blend[2 * p] / (q->vel[4 * p + 3] * q->blend[2 * p + 1]);
    }
    f->mass = left > 0.0 ? mass / left : 1.0;
}

bool gn_zone_is_off(const gn_zone_figures *f) {
    return f->mass < 0.9 || f->mass > 1.1 + f->diameter / f->width;
}

size_t gn_coupled_broken(const gn_dem *dem) {
    const gn_contacts *bonds = &dem->bonds.contacts;
    const double *blend = dem->particles.blend;
    size_t count = 0;
    for (size_t c = 0; blend && bonds->cause && c < bonds->soa.count; c++)
        count += gn_broken(bonds->cause[c]) &&
                 (blend[2 * (size_t)bonds->i[c]] < 1.0 || blend[2 * (size_t)bonds->j[c]] < 1.0);
    return count;
}

void gn_zone_measure(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     const gn_zones *zones, size_t k, gn_zone_figures *f) {
    *f = (gn_zone_figures){
        .width = gn_zone_width(&ctx->scene.couple.zones[k], (int)ctx->scene.dimension)};
    measure_elements(ctx, solids, k, f);
    measure_particles(ctx, dem, solids, zones, k, f);
    measure_mass(ctx, dem, solids, zones, k, f);
}
