#include "zones/zones.h"
#include "base/error.h"
#include "base/new.h"
#include "base/point.h"
#include "base/vec3.h"
#include "couple/consistent.h"
#include "couple/zone.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "particles/dormant.h"
#include "particles/lists.h"
#include "particles/motion.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/couple_def.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "zones/zone_state.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

/* --- creation --- */

void gn_coupled_free(gn_coupled *coupled) {
    if (!coupled) return;
    gn_ties_free(&coupled->ties);
    gn_consistent_free(&coupled->consistent);
    void *blocks[] = {coupled->turn,      coupled->before, coupled->stiffness,
                      coupled->viscosity, coupled->stored, coupled->lost,
                      coupled->drag,      coupled->twist,  coupled->sum};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_free(coupled->place);
    gn_free(coupled->load);
    gn_free(coupled);
}

static gneiss_status refuse(const gn_step_context *ctx, gn_scene_place where, const char *key,
                            const char *message, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_INPUT, "%.400s:%d:%d: couple%s: %s", ctx->scene.source,
                   where.line, where.column, key, message);
}

/* Checks that elements end at the edge towards the particles, as the scene states it. */
static gneiss_status check_end(const gn_step_context *ctx, const gn_solids *solids, size_t zone,
                               gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_couple_zone *z = &ctx->scene.couple.zones[zone];
    char at[GN_POINT_SIZE], message[256];
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        const double *beyond = NULL;
        bool inside = false;
        for (int a = 0; a <= b->dimension; a++) {
            const double *x = b->nodes.start + 4 * (size_t)gn_elements_node(&b->elements, a)[e];
            double place = gn_zone_place(z, b->dimension, x);
            if (place < -GN_ZONE_ROUNDING) beyond = x;
            inside = inside || (place >= -GN_ZONE_ROUNDING && place < 1.0);
        }
        if (!beyond || !inside) continue;
        snprintf(message, sizeof message,
                 "expected elements that end on the plane through `from`, found one that leads on "
                 "to %s m",
                 gn_point_text(ctx->scene.origin, beyond, at));
        return refuse(ctx, z->where, ".zones", message, error);
    }
    return GNEISS_OK;
}

static bool all_zero(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return false;
    return true;
}

/* Returns the set that applies a nonzero force to a particle; -1: none does. */
static int32_t pushed_by(const gn_step_context *ctx, const gn_dem *dem, size_t p) {
    const double *force = dem->particles.applied;
    bool pushed = false;
    for (size_t a = 0; force && a < 3; a++) pushed = pushed || force[4 * p + a] != 0.0;
    for (size_t k = 0; pushed && k < ctx->scene.set_count; k++) {
        const gn_set_def *s = &ctx->scene.sets[k];
        if (s->has_force && gn_dot3(s->force, s->force) > 0.0 && gn_set_selected(ctx, dem, k, p))
            return (int32_t)k;
    }
    return -1;
}

/* Returns the set whose motion drives a particle; -1: none does. */
static int32_t moved_by(const gn_step_context *ctx, const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    for (int k = 0; k < 6 && q->slot && q->slot[p] >= 0; k++) {
        const int32_t set = dem->channel_set[6 * q->slot[p] + k];
        if (set < 0) continue;
        const gn_motion *m = &ctx->scene.sets[set].motion;
        if (!all_zero(k < 3 ? &m->velocity[k] : &m->spin[k - 3])) return set;
    }
    return -1;
}

/* Checks that no loads and motions act on particles of zones, because they belong to nodes;
 * particles may be held where nodes are held. */
static gneiss_status check_free(const gn_step_context *ctx, const gn_dem *dem, const gn_tie *tie,
                                gneiss_error *error) {
    const size_t p = (size_t)tie->id;
    const int32_t pushed = pushed_by(ctx, dem, p),
                  set = pushed >= 0 ? pushed : moved_by(ctx, dem, p);
    char key[64];
    if (set < 0) return GNEISS_OK;
    const gn_set_def *s = &ctx->scene.sets[set];
    snprintf(key, sizeof key, "sets[%d].%s", (int)set, pushed >= 0 ? "force" : "motion");
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected particles of zones that no set pushes or moves (they follow the nodes: "
        "use elements.loads, elements.motions), found particle %d of set '%s'",
        gn_scene_at(&ctx->scene, s->where, key).text, tie->id, s->name);
}

gneiss_status gn_zones_check_law(const gn_step_context *ctx, gneiss_error *error) {
    for (int bonds = 0; bonds < 2; bonds++)
        if (!gn_law_of(gn_contact_list_effects(ctx->effects, bonds))->weigh)
            return refuse(ctx, ctx->scene.couple.where, "",
                          "expected a contact law that can have a part of a contact, found one "
                          "that cannot",
                          error);
    return GNEISS_OK;
}

static bool is_in(const gn_fem_set *set, int32_t node) {
    bool in = false;
    for (size_t k = 0; k < set->count; k++) in = in || set->node[k] == node;
    return in;
}

/* Refuses viscous damping with consistent masses at driven nodes: damping of masses shared with
 * other nodes would be part of the reactions. */
static gneiss_status check_damped(const gn_step_context *ctx, const gn_solids *solids,
                                  const gn_ties *ties, gneiss_error *error) {
    const gn_element_model *q = solids->elements[0];
    char message[256];
    if (!(ctx->effects & GN_FX_VISCOUS)) return GNEISS_OK;
    for (size_t k = 0; k < q->def->motion_count; k++) {
        bool moves = ctx->scene.stage_count > 0;
        for (int a = 0; a < 3; a++)
            moves = moves || !all_zero(&q->def->motions[k].motion.velocity[a]);
        if (q->motion[k] < 0 || !moves) continue;
        for (size_t n = 0; n < ties->nodes; n++) {
            if (!is_in(&q->motion_set[k], ties->node[n])) continue;
            snprintf(message, sizeof message,
                     "expected no driven nodes in zones of consistent masses beside background "
                     "damping, found node %d of motion '%s'",
                     q->solid.nodes.id[ties->node[n]], q->def->motions[k].name);
            return refuse(ctx, ctx->scene.couple.where, ".constraint", message, error);
        }
    }
    return GNEISS_OK;
}

/* Finds the ties of the active particles in the remaining elements. */
static gneiss_status find_active_ties(const gn_dem *dem, const gn_solids *solids, gn_ties *ties,
                                      gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    size_t count;
    int32_t *place = gn_fem_places(gn_coupled_solid(solids), &count);
    int32_t *element = gn_alloc_array(q->soa.count + 1, sizeof *element);
    gneiss_status status =
        place && element ? GNEISS_OK
                         : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to convert elements");
    for (size_t p = 0; status == GNEISS_OK && p < q->soa.count; p++) {
        const bool awake = dem->prepared.soa.capacity && gn_particle_is_active(q, p);
        if (gn_dormant_element(dem, p) >= count)
            status = gn_fail(error, GNEISS_ERROR_INPUT,
                             "expected particles in the %zu elements of the mesh, found number %zu",
                             count, gn_dormant_element(dem, p));
        else
            element[p] = awake ? place[gn_dormant_element(dem, p)] : -1;
    }
    if (status == GNEISS_OK)
        status = gn_ties_take(gn_coupled_solid(solids), q, element, ties, error);
    gn_free(place);
    gn_free(element);
    return status;
}

static gneiss_status find(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                          gn_coupled **out, gneiss_error *error) {
    gn_coupled *q = *out = gn_alloc_array(1, sizeof *q);
    if (!q) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for zones");
    if (ctx->scene.couple.has_convert)
        GN_TRY(find_active_ties(dem, solids, &q->ties, error));
    else
        GN_TRY(gn_ties_find(gn_coupled_solid(solids), &dem->particles, &q->ties, error));
    GN_TRY(gn_new(&q->place, q->ties.count + 1, "particles of zones", error));
    GN_TRY(gn_new(&q->load, q->ties.count + 1, "particles of zones", error));
    for (size_t k = 0; k < q->ties.count; k++) q->place[k] = q->ties.tie[k].id;
    if (ctx->scene.couple.constraint == GN_COUPLE_CONSISTENT) {
        q->before = gn_alloc_array(q->ties.nodes + 1, 3 * sizeof *q->before);
        if (!q->before)
            return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes of zones",
                           q->ties.nodes);
        GN_TRY(gn_consistent_create(&q->ties, &q->consistent, error));
        GN_TRY(check_damped(ctx, solids, &q->ties, error));
    }
    if (ctx->scene.couple.spins == GN_COUPLE_SLAVED && ctx->effects & GN_FX_ROTATION) {
        GN_TRY(gn_new(&q->turn, q->ties.count + 1, "particles of zones", error));
    }
    if (ctx->scene.couple.constraint == GN_COUPLE_PENALTY) GN_TRY(gn_penalty_create(q, error));
    return q->ties.count || ctx->scene.couple.has_convert
               ? GNEISS_OK
               : refuse(ctx, ctx->scene.couple.where, "",
                        "expected particles in elements, found none", error);
}

/* Computes the weights of particles. The force weight is 1 - element weight; the mass weight is at
 * least r/width, so that no particle is without mass. */
static void weigh(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                  const gn_ties *ties) {
    const gn_particles *q = &dem->particles, *nodes = &gn_coupled_solid(solids)->nodes;
    const double width = gn_zones_width(&ctx->scene);
    for (size_t p = 0; p < q->soa.count; p++) q->blend[2 * p] = q->blend[2 * p + 1] = 1.0;
    for (size_t k = 0; k < ties->count; k++) {
        const gn_tie *t = &ties->tie[k];
        const size_t p = (size_t)t->id;
        double elements = 0.0;
        for (int a = 0; a < ties->corners; a++)
            elements +=
                t->shape[a] * gn_zones_share(&ctx->scene, nodes->start + 4 * (size_t)t->node[a]);
        q->blend[2 * p] = fmin(fmax(1.0 - elements, 0.0), 1.0);
        q->blend[2 * p + 1] = fmin(fmax(q->blend[2 * p], q->pos[4 * p + 3] / width), 1.0);
        q->vel[4 * p + 3] /= q->blend[2 * p + 1];
        if (q->spin) q->spin[4 * p + 3] /= q->blend[2 * p + 1];
    }
}

/* Computes the lumped masses that nodes carry, kg: sum of m_i N_a(X_i), which preserves the mass
 * and its centre. */
static void sum_carried(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q) {
    for (size_t n = 0; n < q->ties.nodes; n++) {
        double *carried = &gn_coupled_solid(solids)->carried[q->ties.node[n]];
        *carried = 0.0;
        for (int32_t s = q->ties.first[n]; s < q->ties.first[n + 1]; s++) {
            const gn_tie_share *share = &q->ties.share[s];
            const int32_t p = dem->index_of_id[q->ties.tie[share->tie].id];
            if (q->place[share->tie] < 0 || p < 0)
                continue; /* the particle is removed, or will be */
            double mass = 1.0 / dem->particles.vel[4 * (size_t)p + 3];
            *carried += mass * q->ties.tie[share->tie].shape[share->corner];
        }
    }
}

static gneiss_status lump(const gn_dem *dem, const gn_solids *solids, const gn_coupled *q,
                          gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    GN_TRY(gn_new(&b->carried, b->nodes.soa.count + 1, "masses of nodes", error));
    sum_carried(dem, solids, q);
    return GNEISS_OK;
}

static void load_nodes(gn_fem_solid *b) {
    for (size_t n = 0; n < b->nodes.soa.count; n++) {
        double *inverse = b->nodes.vel + 4 * n + 3;
        if (b->carried[n] > 0.0) *inverse = 1.0 / (1.0 / *inverse + b->carried[n]);
    }
}

/* --- part in a step --- */

/* Assembles the consistent masses of the particles in the model; loads are used as scratch. */
static void weigh_consistent(const gn_dem *dem, gn_coupled *q) {
    double *mass = &q->load[0][0];
    for (size_t k = 0; k < q->ties.count; k++)
        mass[k] = q->place[k] >= 0 ? 1.0 / dem->particles.vel[4 * (size_t)q->place[k] + 3] : 0.0;
    gn_consistent_assemble(&q->consistent, mass);
}

static void find_places(const gn_dem *dem, gn_coupled *q) {
    for (size_t k = 0; k < q->ties.count; k++) {
        const int32_t p = dem->index_of_id[q->ties.tie[k].id];
        q->place[k] = p >= 0 && gn_particle_is_active(&dem->particles, p) ? p : -1;
    }
}

gneiss_status gn_zones_hold(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                            gn_zones *zones, gneiss_error *error) {
    gn_coupled *q = zones->coupled;
    gn_fem_solid *b = gn_coupled_solid(solids);
    find_places(dem, q);
    for (size_t k = 0; k < q->ties.count; k++)
        if (q->place[k] >= 0) GN_TRY(gn_hold_particle(&dem->hold, (size_t)q->place[k], error));
    if (q->stiffness)
        gn_penalty_set(ctx, dem, solids, zones, q); /* particles may have left */
    else if (!b->carried)
        GN_TRY(lump(dem, solids, q, error)); /* after a resume the nodes have this mass already */
    if (q->before) weigh_consistent(dem, q);
    for (size_t n = 0; n < q->ties.nodes; n++)
        GN_TRY(gn_hold_particle(&b->hold, (size_t)q->ties.node[n], error));
    return GNEISS_OK;
}

/* Takes the force off a particle, so that its own motion and energy are zero, because its mass and
 * its weight are at the nodes. */
static void take(const gn_step_context *ctx, gn_dem *dem, int width, size_t p, double load[3]) {
    const gn_particles *q = &dem->particles;
    double *row = gn_hold_load(&dem->hold, width, p), *v = q->vel + 4 * p;
    const double mass = v[3] > 0.0 ? 1.0 / v[3] : 0.0;
    for (size_t a = 0; a < (size_t)ctx->scene.dimension; a++) {
        load[a] = row[a];
        row[a] = ctx->effects & GN_FX_GRAVITY ? -(mass * ctx->scene.gravity[a]) : 0.0;
        v[a] = 0.0;
    }
    gn_dem_clear_past(dem, p, false);
}

void gn_zones_add_to_reading(const gn_zones *zones, gn_ledger *ledger) {
    const gn_coupled *q = zones->coupled;
    for (int k = 0; k < 9; k++) ledger->stress[k] += zones->state.stress[k];
    if (q->stiffness)
        gn_penalty_book(q, &ledger->reading);
    else
        ledger->reading.kinetic += q->kinetic;
}

static inline __attribute__((always_inline)) void hand_to_node(const gn_coupled *q, size_t n,
                                                               double *row, int dimension) {
    for (int32_t s = q->ties.first[n]; s < q->ties.first[n + 1]; s++) {
        const gn_tie_share *share = &q->ties.share[s];
        const double shape = q->ties.tie[share->tie].shape[share->corner];
        for (int a = 0; a < dimension; a++) row[a] += shape * q->load[share->tie][a];
        if (!q->turn) continue;
        for (int a = 0; a < dimension; a++) row[a] += q->turn[share->tie][share->corner][a];
    }
}

void gn_coupled_add_to_nodes(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             gn_coupled *q) {
    gn_fem_solid *b = gn_coupled_solid(solids);
#pragma omp parallel for schedule(static) num_threads(gn_coupled_team(ctx, dem, q->ties.nodes))
    for (size_t n = 0; n < q->ties.nodes; n++) {
        double *row = gn_hold_load(&b->hold, 4, (size_t)q->ties.node[n]);
        if (b->dimension == 2)
            hand_to_node(q, n, row, 2);
        else
            hand_to_node(q, n, row, 3);
    }
}

static void hand_over(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                      gn_coupled *q) {
    const int width = gn_row_width(ctx->scene.dimension == 3, ctx->effects & GN_FX_ROTATION);
    if (q->before) gn_masses_store(solids, q);
#pragma omp parallel for schedule(static) num_threads(gn_coupled_team(ctx, dem, q->ties.count))
    for (size_t k = 0; k < q->ties.count; k++) {
        q->load[k][0] = q->load[k][1] = q->load[k][2] = 0.0;
        if (q->place[k] >= 0) take(ctx, dem, width, (size_t)q->place[k], q->load[k]);
        if (q->turn) memset(q->turn[k], 0, sizeof q->turn[k]);
        if (q->turn && q->place[k] >= 0) gn_spins_take_moment(dem, solids, q, width, k);
    }
    gn_coupled_add_to_nodes(ctx, dem, solids, q);
    if (q->before) gn_masses_correct(ctx, solids, q);
}

/* Computes velocity and displacement at a tie. */
static inline __attribute__((always_inline)) void follow_nodes(const gn_tie *t,
                                                               const gn_particles *nodes,
                                                               size_t dimension, double v[3],
                                                               double u[3]) {
    for (int c = 0; c < 3; c++) v[c] = u[c] = 0.0;
    for (size_t a = 0; a <= dimension; a++)
        for (size_t c = 0; c < dimension; c++) {
            const size_t at = 4 * (size_t)t->node[a] + c;
            v[c] += t->shape[a] * nodes->vel[at];
            u[c] += t->shape[a] * (nodes->pos[at] - nodes->start[at]);
        }
}

/* Moves a particle with its nodes; returns the square of its speed. */
static double place(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                    const gn_coupled *q, size_t k) {
    const gn_particles *nodes = &gn_coupled_solid(solids)->nodes, *a = &dem->particles;
    const size_t p = (size_t)q->place[k];
    double v[3], u[3];
    if (q->ties.corners == 3)
        follow_nodes(&q->ties.tie[k], nodes, 2, v, u);
    else
        follow_nodes(&q->ties.tie[k], nodes, 3, v, u);
    for (size_t c = 0; c < (size_t)ctx->scene.dimension; c++) {
        a->vel[4 * p + c] = v[c];
        a->pos[4 * p + c] = a->start[4 * p + c] + u[c];
        if (!a->travel_f) continue;
        a->vel_f[4 * p + c] = (float)v[c];
        a->travel_f[4 * p + c] = (float)(a->pos[4 * p + c] - a->ref[4 * p + c]);
    }
    if (q->turn) gn_spins_set(ctx, dem, solids, q, k);
    return gn_dot3(v, v);
}

static double place_all(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                        const gn_coupled *q) {
    double most = 0.0;
#pragma omp parallel for schedule(static) num_threads(gn_coupled_team(ctx, dem, q->ties.count))    \
    reduction(max                                                                                  \
              : most)
    for (size_t k = 0; k < q->ties.count; k++) {
        double speed2 = q->place[k] >= 0 ? place(ctx, dem, solids, q, k) : 0.0;
        most = speed2 > most ? speed2 : most;
    }
    return sqrt(most);
}

void gn_coupled_follow(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones) {
    gn_coupled *q = zones->coupled;
    find_places(dem, q);
    place_all(ctx, dem, solids, q);
}

void gn_coupled_begin(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                      gn_zones *zones) {
    gn_coupled *q = zones->coupled;
    const gn_particles *nodes = &gn_coupled_solid(solids)->nodes;
    find_places(dem, q);
    for (size_t k = 0; k < q->ties.count; k++) {
        double u[3], v[3];
        gn_tie_travel(&q->ties, k, nodes, u);
        gn_tie_mean(&q->ties, k, nodes->vel, v);
        if (q->place[k] >= 0 && (gn_dot3(u, u) > 0.0 || gn_dot3(v, v) > 0.0))
            place(ctx, dem, solids, q, k);
    }
}

/* The stored largest speed includes that of these particles. */
static gneiss_status follow(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                            gn_coupled *q, gneiss_error *error) {
    if (q->before) gn_masses_book(ctx, solids, q);
    double speed = place_all(ctx, dem, solids, q), before = sqrt(dem->done.motion.speed2);
    if (!(speed > before)) return GNEISS_OK;
    gn_dem_count_speed(ctx, dem, speed, before);
    if (ctx->dt * speed <= 0.5 * dem->radius_min) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_UNSTABLE,
        "step %lld, t = %g s: couple: elements moved a particle of a zone farther in one "
        "step than half the smallest radius: %g m/s, smallest radius %g m; the step is "
        "%.3g s, its stability limit was estimated as %.3g s",
        (long long)ctx->step, ctx->time, speed, dem->radius_min, ctx->dt, ctx->stable);
}

void gn_zones_act(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                  gn_ledger *ledger) {
    if (zones->coupled->stiffness)
        gn_penalty_act(ctx, dem, solids, zones->coupled, ledger);
    else
        hand_over(ctx, dem, solids, zones->coupled);
}

gneiss_status gn_zones_elements_moved(const gn_step_context *ctx, gn_dem *dem,
                                      const gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                      gneiss_error *error) {
    if (!zones->coupled->stiffness) return follow(ctx, dem, solids, zones->coupled, error);
    gn_penalty_follow(ctx, dem, solids, zones->coupled, ledger);
    return GNEISS_OK;
}

/* --- creation at the start and after a conversion --- */

static gneiss_status prepare(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                             gn_coupled **q, gneiss_error *error) {
    GN_TRY(gn_zones_check_law(ctx, error));
    if (ctx->scene.couple.has_convert) {
        GN_TRY(find(ctx, dem, solids, q, error));
        return lump(dem, solids, *q, error);
    }
    for (size_t k = 0; k < ctx->scene.couple.zone_count; k++)
        GN_TRY(check_end(ctx, solids, k, error));
    GN_TRY(find(ctx, dem, solids, q, error));
    for (size_t k = 0; k < (*q)->ties.count; k++)
        GN_TRY(check_free(ctx, dem, &(*q)->ties.tie[k], error));
    GN_TRY(gn_zones_check(ctx, dem, solids, &(*q)->ties, error));
    weigh(ctx, dem, solids, &(*q)->ties);
    /* Particles are numbered when they are sorted for the first time. */
    gn_dem_number_ids(dem);
    if (!(*q)->stiffness) {
        GN_TRY(lump(dem, solids, *q, error));
        load_nodes(gn_coupled_solid(solids));
        place_all(ctx, dem, solids, *q);
    }
    return GNEISS_OK;
}

static gneiss_status take_over(gn_dem *dem, gn_boundary *boundary, const gn_solids *solids,
                               gn_zones *zones, gn_coupled *q, gneiss_status status) {
    if (status != GNEISS_OK) {
        gn_coupled_free(q);
        return status;
    }
    zones->coupled = q;
    if (q->stiffness) gn_penalty_hold(dem, boundary, solids, zones);
    return GNEISS_OK;
}

gneiss_status gn_coupled_create(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error) {
    gn_coupled *q = NULL;
    if (!ctx->scene.has_couple) return GNEISS_OK;
    gneiss_status status = prepare(ctx, dem, solids, &q, error);
    return take_over(dem, boundary, solids, zones, q, status);
}

gneiss_status gn_coupled_resume(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error) {
    gn_coupled *q = NULL;
    if (!ctx->scene.has_couple) return GNEISS_OK;
    gneiss_status status = find(ctx, dem, solids, &q, error);
    return take_over(dem, boundary, solids, zones, q, status);
}

/* --- particles that leave --- */

/* Returns the kinetic energy of the masses that nodes carry, J. */
static double carried_energy(const gn_solids *solids, const gn_coupled *q) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    double sum = 0.0;
    for (size_t n = 0; n < q->ties.nodes; n++) {
        const double *v = b->nodes.vel + 4 * (size_t)q->ties.node[n];
        sum += 0.5 * b->carried[q->ties.node[n]] * gn_dot3(v, v);
    }
    return sum;
}

/* Returns the energy, J, that is booked as removed with a particle although it is the nodes'. */
static double energy_of_nodes(const gn_dem *dem, const gn_coupled *q, size_t p) {
    const double *v = dem->particles.vel + 4 * p, *o = dem->particles.spin + 4 * p;
    double sum = 0.0;
    if (!q->before && !q->stiffness) sum += 0.5 * gn_dot3(v, v) / v[3];
    if (q->turn) sum += 0.5 * gn_dot3(o, o) / o[3];
    return sum;
}

void gn_coupled_remove(gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones, gn_ledger *ledger, const int32_t *gone) {
    gn_coupled *q = ctx->scene.has_couple ? zones->coupled : NULL;
    if (!q) return;
    gn_fem_solid *b = gn_coupled_solid(solids);
    ctx->choice.whole = -fabs(ctx->choice.whole); /* the limit of the coupled system is outdated */
    const bool lumped = !q->before && !q->stiffness;
    double before = lumped ? carried_energy(solids, q) : 0.0;
    for (size_t k = 0; k < q->ties.count; k++) {
        if (q->place[k] < 0 || !gone[q->place[k]]) continue;
        ledger->energy.removed -= energy_of_nodes(dem, q, (size_t)q->place[k]);
        if (q->stiffness) ledger->energy.removed += q->stored[k];
        if (q->stiffness) q->stored[k] = 0.0;
        q->place[k] = -1;
    }
    if (!b->carried) return;
    for (size_t n = 0; n < q->ties.nodes; n++) {
        double *inverse = b->nodes.vel + 4 * (size_t)q->ties.node[n] + 3;
        *inverse = 1.0 / (1.0 / *inverse - b->carried[q->ties.node[n]]);
    }
    sum_carried(dem, solids, q);
    load_nodes(b);
    if (lumped) ledger->energy.removed += before - carried_energy(solids, q);
}

gneiss_status gn_coupled_recreate(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                                  gn_zones *zones, gneiss_error *error) {
    gn_coupled *q = NULL;
    gneiss_status status = find(ctx, dem, solids, &q, error);
    if (status != GNEISS_OK) {
        gn_coupled_free(q);
        return status;
    }
    gn_coupled_free(zones->coupled);
    zones->coupled = q;
    return gn_coupled_weigh(dem, solids, zones, error);
}

gneiss_status gn_coupled_weigh(const gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                               gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    gn_free(b->carried);
    b->carried = NULL;
    GN_TRY(lump(dem, solids, zones->coupled, error));
    gn_fem_apply_weights(b);
    return GNEISS_OK;
}

/* --- membership --- */

const gn_tie *gn_coupled_tie(const gn_coupled *q, int32_t id) {
    size_t low = 0, high = q->ties.count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (q->ties.tie[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < q->ties.count && q->ties.tie[low].id == id ? &q->ties.tie[low] : NULL;
}

bool gn_coupled_has(const gn_coupled *q, int32_t id) {
    return gn_coupled_tie(q, id) != NULL;
}
