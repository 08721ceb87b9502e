/* Creation of particles from a packing, and sums over all particles. */
#include "base/ball.h"
#include "base/error.h"
#include "base/new.h"
#include "base/random.h"
#include "frame/frame.h"
#include "frame/periodic_box.h"
#include "io/packing.h"
#include "kernels/dispatch.h"
#include "kernels/partials.h"
#include "neigh/neigh.h"
#include "particles/active_pairs.h"
#include "particles/bridges.h"
#include "particles/events.h"
#include "particles/flow.h"
#include "particles/fragments.h"
#include "particles/from_run.h"
#include "particles/joint_faces.h"
#include "particles/law.h"
#include "particles/observe.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/scene.h"
#include "sched/deal.h"
#include "sched/hold.h"
#include "soa/field.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

gneiss_status gn_dem_use_threads(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_deal_free(&dem->deal);
    GN_TRY(gn_deal_create(&dem->deal, ctx->threads, error));
    return gn_dem_deal(ctx, dem, error);
}

gneiss_status gn_dem_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    dem->damping_fraction = gn_contact_damping_fraction(&ctx->scene);
    GN_TRY(gn_hertz_prepare(ctx, dem, error));
    GN_TRY(gn_flow_prepare(ctx, dem, error));
    GN_TRY(gn_dem_use_threads(ctx, dem, error));
    GN_TRY(gn_lists_choose_kernels(ctx, dem, error));
    return gn_motion_kernel_choose(ctx->kernels, ctx->effects, &dem->motion_kernel, error);
}

/* --- create, free --- */

gneiss_status gn_dem_create(const gn_step_context *ctx, gn_dem *dem, const gn_packing *packing,
                            gneiss_error *error) {
    gn_particles *q = &dem->particles;
    int material = gn_scene_find_material(&ctx->scene, ctx->scene.specimen.material);
    if (packing->count > INT32_MAX - 2 * GN_LANES_MAX)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%zu particles are more than the engine can number", packing->count);
    GN_TRY(gn_soa_create(&gn_particle_record, q, packing->count, ctx->effects, error));
    const size_t drives = ctx->scene.wall_count + ctx->scene.body_count + ctx->scene.set_count;
    if (ctx->effects & GN_FX_HERTZ) dem->driven = gn_alloc_array(drives + 1, sizeof(double));
    if (ctx->effects & GN_FX_HERTZ && !dem->driven)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu motions", drives);
    const gn_particle_columns *own = &ctx->scene.specimen.packed_columns;
    if (packing->count) { /* all particles may come from sources */
        memcpy(q->pos, packing->sphere, packing->count * 4 * sizeof(double));
        memcpy(q->start, packing->sphere, packing->count * 4 * sizeof(double));
    }
    dem->radius_min = gn_flow_least_radius(ctx, dem);
    dem->ids = dem->made = (int64_t)packing->count;
    for (size_t p = 0; p < packing->count; p++) {
        dem->radius_min = fmin(dem->radius_min, packing->sphere[4 * p + 3]);
        q->id[p] = (int32_t)p;
        /* The place of 1/m holds a density until materials are known; inf: that of the material. */
        const bool listed = p < ctx->scene.specimen.packed_count;
        q->vel[4 * p + 3] = own->density && listed ? own->density[p] : INFINITY;
        for (size_t a = 0; own->motion && listed && a < 3; a++) {
            q->vel[4 * p + a] = own->motion[6 * p + a];
            if (q->spin) q->spin[4 * p + a] = own->motion[6 * p + 3 + a];
        }
        q->material[p] = own->material && listed ? own->material[p] : material < 0 ? 0 : material;
        q->group[p] = own->group && listed ? own->group[p] : (int32_t)ctx->scene.specimen.group;
        if (q->slot) q->slot[p] = -1;
        if (q->orientation) q->orientation[4 * p] = 1.0;
        if (q->own_share) q->own_share[p] = 1.0;
    }
    gn_clumps_enter(dem);
    return GNEISS_OK;
}

static double bulk_factor(const gn_step_context *ctx, const gn_dem *dem) {
    if (ctx->scene.specimen.density_basis == GN_DENSITY_PARTICLE) return 1.0;
    double porosity = ctx->scene.specimen.porosity;
    if (porosity < 0.0) porosity = gn_dem_porosity(ctx, dem);
    return 1.0 / (1.0 - porosity);
}

/* Sphere I = 2/5 m r^2, disc of unit thickness I = 1/2 m r^2. */
static void set_masses(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    double factor = bulk_factor(ctx, dem);
    for (size_t p = 0; p < q->soa.count; p++) {
        double r = q->pos[4 * p + 3];
        double own = q->vel[4 * p + 3];
        double density =
            isfinite(own) ? own : ctx->scene.materials[q->material[p]].density * factor;
        double mass = density * gn_ball_volume((int)ctx->scene.dimension, r);
        q->vel[4 * p + 3] = 1.0 / mass;
        if (q->spin)
            q->spin[4 * p + 3] = 1.0 / ((ctx->effects & GN_FX_SPACE ? 0.4 : 0.5) * mass * r * r);
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            double *v = &q->vel[4 * p + a];
            double random =
                ctx->scene.random_velocity *
                gn_random_symmetric(ctx->scene.seed ^ UINT64_C(0x76656c), 3 * p + (size_t)a);
            *v = *v != 0.0 ? *v + random : random;
        }
    }
}

/* Particles from another run keep their velocities. */
static gneiss_status take_velocities(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_particles *q = &dem->particles;
    gn_from_run from;
    if (!ctx->scene.specimen.from[0] || !ctx->scene.specimen.from_velocities) return GNEISS_OK;
    GN_TRY(gn_from_run_read(&ctx->scene, &from, error));
    for (size_t p = 0; from.motion && from.count == q->soa.count && p < from.count; p++)
        for (size_t a = 0; a < 3; a++) {
            q->vel[4 * p + a] += from.motion[6 * p + a];
            if (q->spin) q->spin[4 * p + a] = from.motion[6 * p + 3 + a];
        }
    gn_from_run_free(&from);
    return GNEISS_OK;
}

/* Returns a skin that is wide enough for a quasi-static specimen never to rebuild its lists, and
 * narrow enough for few listed pairs to be apart. */
static double automatic_skin(const gn_step_context *ctx, const gn_dem *dem) {
    double sum = 0.0;
    if (!dem->particles.soa.count) return 0.15 * gn_flow_mean_radius(ctx);
    for (size_t p = 0; p < dem->particles.soa.count; p++) sum += dem->particles.pos[4 * p + 3];
    return 0.15 * sum / (double)dem->particles.soa.count;
}

/* Refuses a box so narrow that a particle could touch two images of another one; pairs are searched
 * within a reach. */
static gneiss_status check_period(const gn_step_context *ctx, const gn_dem *dem,
                                  gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    if (!(ctx->effects & GN_FX_PERIODIC)) return GNEISS_OK;
    double radius = gn_flow_largest_radius(ctx, dem);
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        radius = fmax(radius, dem->particles.pos[4 * p + 3]);
    double bonds = 2.0 * radius * (1.0 + s->interaction_range);
    double lists = 2.0 * radius + dem->verlet.skin, least = 2.0 * fmax(bonds, lists);
    const char *asks = bonds >= lists  ? ", with bonds.interaction_range"
                       : s->skin > 0.0 ? ", with neighbours.skin"
                                       : "";
    for (int a = 0; a < (int)s->dimension; a++)
        if (gn_scene_periodic_along(s, a) && ctx->period[a] < least)
            return gn_fail(error, ctx->step > 0 ? GNEISS_ERROR_UNSTABLE : GNEISS_ERROR_INPUT,
                           "%s: expected a length of at least %g m along %c (twice "
                           "the reach of the largest particles%s), found %g m",
                           gn_scene_at(s, s->periodic_where, "periodic").text, least, "xyz"[a],
                           asks, ctx -> period[a]);
    return GNEISS_OK;
}

gneiss_status gn_dem_complete(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_dem *d = dem;
    GN_TRY(gn_sets_assign(ctx, dem, error));
    set_masses(ctx, dem);
    gn_clumps_complete(dem);
    GN_TRY(take_velocities(ctx, dem, error));
    GN_TRY(gn_sets_apply(ctx, dem, error));
    GN_TRY(gn_flow_create(ctx, dem, error));
    GN_TRY(gn_new(&d->index_of_id, d->particles.soa.count + 1, "particle numbers", error));
    GN_TRY(gn_pieces_create(ctx, dem, error));
    d->verlet.skin = ctx->scene.skin > 0.0 ? ctx->scene.skin : automatic_skin(ctx, dem);
    d->verlet.skin_start = d->verlet.skin;
    gn_bridges_begin(ctx, dem);
    return check_period(ctx, dem, error);
}

gneiss_status gn_dem_create_empty(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    GN_TRY(gn_soa_create(&gn_particle_record, &dem->particles, 0, ctx->effects, error));
    for (int l = 0; l < GN_LIST_COUNT; l++) GN_TRY(gn_list_create_empty(ctx, dem, l, error));
    dem->verlet.skin = dem->verlet.skin_start = 1.0;
    return GNEISS_OK;
}

gneiss_status gn_dem_take_effects(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    GN_TRY(gn_motion_kernel_choose(ctx->kernels, ctx->effects, &dem->motion_kernel, error));
    /* Effects that differ between stages have no storage; output names those of the present stage.
     */
    dem->particles.soa.effects = ctx->effects;
    gn_lists_set_effects(ctx, dem);
    if (dem->dormant) dem->prepared.soa.effects = dem->bonds.contacts.soa.effects;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        if (gn_list_kinds[l]->of_materials)
            GN_TRY(gn_contacts_take_materials(ctx, dem, &dem->list[l].contacts, error));
    return GNEISS_OK;
}

void gn_dem_free(gn_dem *dem) {
    gn_soa_destroy(&gn_particle_record, &dem->particles);
    for (int l = 0; l < GN_LIST_COUNT; l++) gn_contact_list_free(&dem->list[l]);
    gn_soa_destroy(&gn_contact_record, &dem->prepared);
    gn_joint_faces_free(&dem->joint_faces);
    gn_deal_free(&dem->deal);
    gn_hold_free(&dem->hold);
    gn_events_free(&dem->events);
    gn_flow_free(&dem->flow);
    gn_clumps_free(&dem->clumps);
    gn_active_pairs_free(&dem->near);
    void *blocks[] = {
        dem->index_of_id,    dem->channel_set,     dem->set_reaction,    dem->loose,
        dem->prescribed.set, dem->prescribed.mask, dem->prescribed.load, dem->prescribed.velocity,
        dem->motion_sums,    dem->vel_past,        dem->spin_past,       dem->around,
        dem->pieces.parent,  dem->pieces.members,  dem->pieces.volume,   dem->still,
        dem->dormant,        dem->hertz,           dem->driven,          dem->ways};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    *dem = (gn_dem){0};
}

/* --- hash and sums of the part --- */

uint64_t gn_dem_hash(const gn_step_context *ctx, const gn_dem *dem, uint64_t h) {
    gn_active_pairs_settle(ctx, dem);
    h = gn_soa_hash(&gn_particle_record, &dem->particles, h);
    if (dem->clumps.count) h = gn_clumps_hash(&dem->clumps, h);
    for (int l = 0; l < GN_LIST_COUNT; l++)
        h = gn_soa_hash(&gn_contact_record, &dem->list[l].contacts, h);
    return gn_flow_hash(ctx, dem, h);
}

static size_t list_bytes(const gn_contact_list *list) {
    const gn_soa *soa = &list->contacts.soa;
    return soa->capacity * gn_record_bytes(&gn_contact_record, soa->effects) +
           gn_partials_bytes(&list->partials, soa->count, 2);
}

size_t gn_dem_bytes(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_dem *d = dem;
    size_t each = gn_record_bytes(&gn_particle_record, ctx->effects) + 2 * sizeof(int32_t);
    size_t bytes = d->particles.soa.capacity * each + gn_active_pairs_bytes(dem);
    for (int l = 0; l < GN_LIST_COUNT; l++) bytes += list_bytes(&d->list[l]);
    return bytes +
           d->prepared.soa.capacity * gn_record_bytes(&gn_contact_record, d->prepared.soa.effects);
}

gneiss_status gn_dem_deal(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_deal_list lists[GN_LIST_COUNT];
    for (int l = 0; l < GN_LIST_COUNT; l++)
        lists[l] = (gn_deal_list){&dem->list[l].partials, dem->list[l].contacts.i};
    if (ctx->ranks) GN_TRY(gn_ranks_plan(ctx->ranks, &dem->particles, lists, GN_LIST_COUNT, error));
    return gn_deal_lists(&dem->deal, lists, GN_LIST_COUNT, dem->motion_blocks, error);
}

/* --- arguments of kernels --- */

gn_contact_args gn_dem_contact_args(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_periodic_box *box, const gn_contact_list *list,
                                    bool measure) {
    gn_contact_args a = {0};
    a.pos = dem->particles.pos;
    a.vel = dem->particles.vel;
    a.spin = dem->particles.spin;
    a.pos_f = dem->particles.travel_f;
    a.vel_f = dem->particles.vel_f;
    a.spin_f = dem->particles.spin_f;
    a.contacts = &list->contacts;
    a.uniform = list->uniform;
    a.partials = &list->partials;
    a.dt = ctx->dt_past;
    a.speed_most = dem->speed_most;
    a.flows = gn_box_moved(box);
    memcpy(a.flow, box->flow, sizeof a.flow);
    if (a.flows && a.speed_most > 0.0) a.speed_most += 0.5 * gn_box_speed(box);
    a.arm_factor = ctx->scene.contact_arm == GN_ARM_MIDPOINT ? 0.5 : 0.0;
    memcpy(a.period, ctx->period, sizeof a.period);
    for (int k = 0; k < 3; k++)
        a.inverse_period[k] = ctx->period[k] > 0.0 ? 1.0 / ctx->period[k] : 0.0;
    memcpy(a.gravity, ctx->scene.gravity, sizeof a.gravity);
    if (ctx->effects & GN_FX_GRAVITY) a.own = dem->particles.own_share;
    if (dem->prescribed.count) {
        a.slot = dem->particles.slot;
        a.held = dem->prescribed.mask;
    }
    a.cohesion = (int)ctx->scene.cohesion;
    a.rupture = gn_bridge_rupture(&ctx->scene);
    a.time = ctx->time;
    a.measure = measure;
    return a;
}
