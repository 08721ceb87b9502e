#include "world/world.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/point.h"
#include "base/threads.h"
#include "base/timer.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "frame/frame.h"
#include "inflow/sources.h"
#include "io/packing.h"
#include "kernels/dispatch.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "laboratory/strain_gauge.h"
#include "measure/measure.h"
#include "membrane/membrane.h"
#include "mesh/mesh.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "particles/specimen.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/features.h"
#include "world/origin.h"
#include "world/particle_step.h"
#include "world/ranks.h"
#include "world/scale.h"
#include "zones/zones.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

/* Creates the particles of the specimen, and sets the volume if the specimen has a shape. */
static gneiss_status load_specimen(gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_packing packing = {0};
    if (!gn_scene_starts_filled(&ctx->scene)) return gn_dem_create(ctx, dem, &packing, error);
    if (ctx->scene.specimen_given)
        GN_TRY(gn_specimen_make(&ctx->scene, &packing, &ctx->volume, error));
    gneiss_status status = gn_clumps_make(ctx, &packing, &dem->clumps, error);
    if (status == GNEISS_OK) status = gn_dem_create(ctx, dem, &packing, error);
    if (status == GNEISS_OK) status = gn_specimen_prepare(ctx, dem, error);
    ctx->given.preparation = (gn_preparation){0};
    gn_packing_free(&packing);
    gn_free(ctx->scene.specimen.packed); /* used here only */
    gn_particle_columns_free(&ctx->scene.specimen.packed_columns);
    ctx->scene.specimen.packed = NULL;
    ctx->scene.specimen.packed_count = 0;
    return status;
}

static void measure_extent(gn_step_context *ctx, gn_dem *dem) {
    for (int a = 0; a < 3; a++) {
        ctx->lower[a] = INFINITY;
        ctx->upper[a] = -INFINITY;
        for (size_t p = 0; p < dem->particles.soa.count; p++) {
            const double *x = dem->particles.pos + 4 * p;
            double r = a < (int)ctx->scene.dimension ? x[3] : 0.0;
            ctx->lower[a] = fmin(ctx->lower[a], x[a] - r);
            ctx->upper[a] = fmax(ctx->upper[a], x[a] + r);
        }
    }
}

static gneiss_status measure_test(gn_step_context *ctx, const gn_dem *dem,
                                  const gn_boundary *boundary, const gn_solids *solids,
                                  gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    if (!gn_scene_tested(s)) return GNEISS_OK;
    gn_tested_shape shape = gn_test_shape(ctx, dem, boundary, solids);
    ctx->test_length = shape.length;
    ctx->test_area = shape.area;
    if (gn_scene_test(s)->beam && s->test.given.notch >= shape.height)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected a notch that is less deep than the beam, which is %.6g m high, "
            "found %.6g m",
            gn_scene_at(s, s->test.where, "test.notch").text, shape.height, s->test.given.notch);
    bool sound = shape.length > 0.0 && isfinite(shape.length);
    if (!gn_scene_test(s)->periodic_sides || sound) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected an upper end above the lower one along %c, with "
                   "something to shear between them, found %s",
                   gn_scene_at(s, s->test.where, "test").text, "xyz"[s->test.normal],
                   isfinite(shape.length) ? "ends that overlap" : "an end without particles");
}

/* Returns the volume of a periodic box; along an open axis its extent is that of the particles. */
static double box_volume(const gn_step_context *ctx) {
    int64_t open = ctx->scene.periodic_open;
    return gn_box_section(ctx) * (open >= 0 ? ctx->upper[open] - ctx->lower[open] : 1.0);
}

/* Computes the extent with radii, and the volume to which density, porosity and average stress
 * refer, unless a shape has set it. */
static gneiss_status measure_specimen(gn_step_context *ctx, gn_dem *dem,
                                      const gn_boundary *boundary, const gn_solids *solids,
                                      gneiss_error *error) {
    gn_volume_source source = gn_volume_source_of(ctx, dem, boundary, solids);
    if (!gn_scene_starts_filled(&ctx->scene))
        gn_flow_bounds(ctx, dem, ctx->lower, ctx->upper);
    else if (source == GN_VOLUME_OF_HULL)
        GN_TRY(gn_packing_hull(&dem->particles, (int)ctx->scene.dimension, &ctx->volume, ctx->lower,
                               ctx->upper, error));
    else
        measure_extent(ctx, dem);
    if (source == GN_VOLUME_OF_SOURCES)
        ctx->volume = (ctx->upper[0] - ctx->lower[0]) * (ctx->upper[1] - ctx->lower[1]) *
                      (ctx->effects & GN_FX_SPACE ? ctx->upper[2] - ctx->lower[2] : 1.0);
    if (source == GN_VOLUME_OF_BOX) ctx->volume = box_volume(ctx);
    GN_TRY(measure_test(ctx, dem, boundary, solids, error));
    if (source == GN_VOLUME_OF_TEST) ctx->volume = gn_test_shape(ctx, dem, boundary, solids).volume;
    return GNEISS_OK;
}

double gn_world_mass(const gn_dem *dem, const gn_solids *solids) {
    return dem->mass + gn_elements_totals(solids).mass;
}

/* Computes the domain from values in the output files, so that a resumed run has the same bits. */
static void set_domain(gn_step_context *ctx, const gn_dem *dem) {
    gn_scene *s = &ctx->scene, *given = &ctx->given;
    if (s->has_domain || (ctx->effects & GN_FX_PERIODIC && !gn_scene_half_periodic(s))) return;
    double size = 0.0, lower[3], upper[3];
    gn_flow_bounds(ctx, dem, lower, upper);
    for (int a = 0; a < 3; a++) {
        lower[a] = fmin(lower[a], ctx->lower[a]);
        upper[a] = fmax(upper[a], ctx->upper[a]);
    }
    for (int a = 0; a < (int)s->dimension; a++) size = fmax(size, upper[a] - lower[a]);
    for (int a = 0; a < (int)s->dimension; a++) {
        given->domain_min[a] = gn_point_out(s->origin[a], lower[a] - 10.0 * size);
        given->domain_max[a] = gn_point_out(s->origin[a], upper[a] + 10.0 * size);
        s->domain_min[a] = given->domain_min[a] - s->origin[a];
        s->domain_max[a] = given->domain_max[a] - s->origin[a];
    }
    s->has_domain = given->has_domain = true;
}

static gneiss_status choose_kernels(gn_step_context *ctx, gneiss_error *error) {
    gneiss_status status = gn_kernel_set_choose(gn_isa_name(ctx->scene.isa), &ctx->kernels, error);
    gn_scene_place where = ctx->scene.isa_where;
    if (status != GNEISS_OK && ctx->scene.isa != GN_ISA_AUTO) {
        gn_fail_context(error, "run."); /* otherwise an environment variable is at fault */
        if (where.line)
            gn_fail_context(error, "%s:%d:%d: ", ctx->scene.source, where.line, where.column);
    }
    return status;
}

static gneiss_status check_built(const gn_scene *scene, gneiss_error *error) {
    char names[GN_EFFECT_NAMES_SIZE];
    const gn_effects missing = gn_scene_not_built(scene);
    if (!missing) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a scene without %s, which this build leaves out (option 'without' "
                   "of meson), found one that calls for it",
                   scene->source, gn_effect_names(missing, ", ", names));
}

/* Sets effects, threads, kernels and period from the scene: everything that does not depend on
 * particles. A resume calls this too, so that a checkpoint uses the kernels of its scene. */
gneiss_status gn_world_prepare(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                               gneiss_error *error) {
    GN_TRY(check_built(&ctx->scene, error));
    ctx->effects = gn_scene_effects(&ctx->scene);
    GN_TRY(gn_threads_find(ctx->scene.threads, &ctx->threads, error));
    GN_TRY(gn_ranks_create(&ctx->ranks, error));
    GN_TRY(gn_world_check_ranks(ctx, error));
    for (int a = 0; a < 3; a++)
        ctx->period[a] = a == ctx->scene.periodic_open
                             ? 0.0
                             : ctx->scene.periodic_max[a] - ctx->scene.periodic_min[a];
    gn_box_create(ctx, box);
    gn_control_create(ctx);
    GN_TRY(choose_kernels(ctx, error));
    return gn_dem_prepare(ctx, dem, error);
}

static gneiss_status check_specimen(const gn_step_context *ctx, const gn_dem *dem,
                                    gneiss_error *error) {
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        for (int a = 0; ctx->scene.has_domain && a < (int)ctx->scene.dimension; a++) {
            double x = dem->particles.pos[4 * p + a];
            if (x >= ctx->scene.domain_min[a] && x <= ctx->scene.domain_max[a]) continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected particles inside the domain, found particle %d at "
                           "%c = %.*g m",
                           gn_scene_at(&ctx->scene, ctx->scene.specimen.where, "specimen").text,
                           dem->particles.id[p], "xyz"[a], ctx -> scene.origin[a] != 0.0 ? 12 : 6,
                           gn_point_out(ctx->scene.origin[a], x));
        }
    return GNEISS_OK;
}

/* Refuses a specimen all of whose particles are in sinks at the start, which remove them. */
static gneiss_status check_some_left(const gn_step_context *ctx, const gn_dem *dem,
                                     gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        if (gn_particle_is_active(&dem->particles, p)) return GNEISS_OK;
    if (s->source_count || !s->sink_count) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s:%d:%d: sinks: expected a specimen of which something lies outside of them, "
                   "found all of its %lld particles inside",
                   s->source, s->sinks[0].where.line, s->sinks[0].where.column,
                   (long long)dem->ids);
}

static gneiss_status build_particles(gn_world *world, gneiss_error *error) {
    GN_TRY(load_specimen(&world->ctx, &world->dem, error));
    GN_TRY(gn_origin_check_specimen(&world->ctx, &world->dem, error));
    GN_TRY(measure_specimen(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    set_domain(&world->ctx, &world->dem);
    GN_TRY(check_specimen(&world->ctx, &world->dem, error));
    GN_TRY(gn_dem_complete(&world->ctx, &world->dem, error));
    GN_TRY(gn_membrane_create(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                              &world->solids, error));
    if (gn_converts(&world->ctx))
        GN_TRY(gn_conversion_prepare(&world->ctx, &world->dem, &world->boundary, &world->solids,
                                     error));
    GN_TRY(gn_coupled_create(&world->ctx, &world->dem, &world->boundary, &world->solids,
                             &world->zones, error));
    GN_TRY(
        gn_boundary_create(&world->ctx, &world->dem, &world->boundary, world->solids.count, error));
    GN_TRY(gn_bodies_check_speeds(&world->ctx, &world->boundary, error));
    /* The sheared volume is the one that bodies leave free. */
    if (gn_scene_test(&world->ctx.scene)->sheared)
        GN_TRY(measure_test(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    GN_TRY(gn_element_contact_create(&world->ctx, &world->boundary, &world->solids, error));
    GN_TRY(gn_flow_arrive(&world->ctx, &world->dem, &world->boundary, &world->ledger, true, error));
    GN_TRY(gn_world_arrange_particles(world, error));
    GN_TRY(gn_world_rebuild(world, error));
    GN_TRY(gn_membrane_update_bearers(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                                      &world->solids, error));
    return check_some_left(&world->ctx, &world->dem, error);
}

static gneiss_status build_empty(gn_world *world, gneiss_error *error) {
    world->ctx.choice.stable = INFINITY;
    GN_TRY(gn_dem_create_empty(&world->ctx, &world->dem, error));
    return gn_world_restore(world, error);
}

/* Measures the elements, which are the specimen in a model without particles. */
static gneiss_status measure_elements(gn_step_context *ctx, const gn_dem *dem,
                                      const gn_boundary *boundary, const gn_solids *solids,
                                      gneiss_error *error) {
    for (size_t a = 0; a < 3; a++) {
        ctx->lower[a] = INFINITY;
        ctx->upper[a] = -INFINITY;
    }
    gn_elements_extent(solids, ctx->lower, ctx->upper);
    ctx->volume = gn_elements_totals(solids).volume;
    return measure_test(ctx, dem, boundary, solids, error);
}

typedef struct gauge_work {
    gn_world *w;
    gneiss_status status;
    gneiss_error error;
} gauge_work;

static void *make_gauge(void *context) {
    gauge_work *k = context;
    gn_world *w = k->w;
    k->status = gn_gauge_create(&w->ctx, &w->dem, &w->gauge, &k->error);
    return NULL;
}

/* Computes the strain gauge and the step, the two longest parts of the set-up, at the same time:
 * Qhull uses one thread only, and the other threads compute the step. */
static gneiss_status make_gauge_and_step(gn_world *world, bool particles, gneiss_error *error) {
    gauge_work gauge = {world, GNEISS_OK, {0}};
    pthread_t thread;
    const int threads = world->ctx.threads;
    /* A fully periodic box has no surface whose displacements give its strain; with sources or
     * sinks there is no fixed set of particles either. */
    bool box = world->ctx.effects & GN_FX_PERIODIC && !gn_scene_half_periodic(&world->ctx.scene);
    bool wanted = particles && !box && !gn_scene_has_flow(&world->ctx.scene),
         beside = wanted && threads > 1;
    if (beside) beside = pthread_create(&thread, NULL, make_gauge, &gauge) == 0;
    if (wanted && !beside) make_gauge(&gauge);
    world->ctx.threads = beside ? threads - 1 : threads;
    gneiss_status status = GNEISS_OK;
    if (beside || gauge.status == GNEISS_OK)
        status = gn_timestep_check(&world->ctx, &world->dem, &world->boundary, &world->solids,
                                   &world->zones, &world->ledger, true, error);
    if (beside) (void)pthread_join(thread, NULL);
    world->ctx.threads = threads;
    if (gauge.status == GNEISS_OK) gn_gauge_note_apart(&world->ctx, &world->dem, &world->gauge);
    if (gauge.status == GNEISS_OK) return status;
    return gn_fail(error, gauge.status, "%s", gauge.error.message);
}

static gneiss_status build(gn_world *world, gneiss_error *error) {
    bool particles = world->ctx.given.has_specimen;
    gn_mesh mesh = {0};
    gneiss_status status = gn_origin_enter(world, &mesh, error);
    if (status == GNEISS_OK)
        status = gn_world_prepare(&world->ctx, &world->dem, &world->box, error);
    if (status == GNEISS_OK)
        status = gn_elements_create(&world->ctx, &world->solids,
                                    world->ctx.scene.elements.mesh[0] ? &mesh : NULL, error);
    gn_mesh_free(&mesh);
    GN_TRY(status);
    GN_TRY(particles ? build_particles(world, error) : build_empty(world, error));
    if (!particles)
        GN_TRY(measure_elements(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    GN_TRY(gn_ends_check(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    gn_ends_begin(&world->ctx, &world->dem, &world->boundary, &world->solids, &world->approach);
    world->section = gn_section_of(&world->ctx, &world->dem, &world->boundary, &world->solids);
    GN_TRY(gn_geometry_check(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    GN_TRY(gn_sides_check(&world->ctx, &world->dem, &world->boundary, &world->solids, error));
    GN_TRY(gn_cutting_begin(&world->ctx, &world->dem, &world->boundary, &world->solids,
                            &world->cutting, error));
    GN_TRY(gn_stages_check_first(&world->ctx, &world->dem, &world->solids, &world->stages, error));
    GN_TRY(gn_pulse_start(world, error));
    GN_TRY(make_gauge_and_step(world, particles, error));
    GN_TRY(gn_timestep_scale_masses(&world->ctx, &world->dem, &world->boundary, &world->solids,
                                    &world->zones, &world->ledger, error));
    /* The step is now also limited by the resolution of collisions. */
    GN_TRY(gn_check_duration(&world->ctx, error));
    return gn_origin_check(&world->ctx, &world->dem, &world->boundary, &world->solids, error);
}

gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error) {
    memset(world, 0, sizeof *world);
    world->ctx.given = *scene;
    memset(scene, 0, sizeof *scene);
    double start = gn_now();
    gneiss_status status = build(world, error);
    if (status == GNEISS_ERROR_INPUT) gn_scale_explain(&world->ctx, &world->solids, error);
    /* First lists and the first stability limit are set-up, not part of the run. */
    memset(world->ctx.seconds, 0, sizeof world->ctx.seconds);
    world->ctx.seconds[GN_PHASE_setup] = gn_now() - start;
    if (status != GNEISS_OK) gn_world_free(world);
    return status;
}

void gn_world_free(gn_world *world) {
    gn_ranks_free(world->ctx.ranks);
    gn_boundary_free(&world->boundary);
    gn_elements_free(&world->solids);
    gn_dem_free(&world->dem);
    gn_membrane_free(&world->membrane);
    gn_strain_gauge_free(&world->gauge.weights);
    gn_free(world->gauge.belongs);
    gn_features_free(&world->features);
    gn_coupled_free(world->zones.coupled);
    gn_free(world->stages.state);
    gn_scene_free(&world->ctx.scene);
    gn_scene_free(&world->ctx.given);
    memset(world, 0, sizeof *world);
}

void gn_world_delete(gn_world **world) {
    if (*world) gn_world_free(*world);
    gn_free(*world);
}

uint64_t gn_world_hash(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_periodic_box *box) {
    uint64_t h = gn_dem_hash(ctx, dem, GN_HASH_SEED);
    h = gn_boundary_hash(ctx, boundary, h);
    h = gn_elements_hash(solids, h);
    if (gn_box_moves(ctx, box)) h = gn_hash_bytes(ctx->period, sizeof ctx->period, h);
    h = gn_hash_bytes(&ctx->time, sizeof ctx->time, h);
    return gn_hash_bytes(&ctx->step, sizeof ctx->step, h);
}

size_t gn_world_bytes(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids) {
    return gn_dem_bytes(ctx, dem) + gn_boundary_bytes(ctx, boundary) + gn_elements_bytes(solids);
}
