#include "sim/world.h"

#include "base/ball.h"
#include "base/memory.h"
#include "base/point.h"
#include "base/threads.h"
#include "base/timer.h"
#include "sim/coupling.h"
#include "sim/ends.h"
#include "sim/exchange.h"
#include "sim/gauge.h"
#include "sim/geometry.h"
#include "sim/internal.h"
#include "sim/laboratory.h"
#include "sim/membrane.h"
#include "sim/origin.h"
#include "sim/section.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

static const char *const phase_names[] = {
#define X(name, text) #name,
    GN_PHASES(X)
#undef X
};
static const char *const phase_texts[] = {
#define X(name, text) text,
    GN_PHASES(X)
#undef X
};

const char *gn_phase_name(gn_phase phase) {
    return phase_names[phase];
}
const char *gn_phase_text(gn_phase phase) {
    return phase_texts[phase];
}

/* A shape leaves its volume. */
static gneiss_status load_specimen(gn_world *w, gneiss_error *error) {
    gn_packing packing = {0};
    if (!w->scene.specimen_given) return gn_dem_create(w, &packing, error);
    GN_TRY(gn_specimen_make(&w->scene, &packing, &w->volume, error));
    gneiss_status status = gn_dem_create(w, &packing, error);
    gn_packing_free(&packing);
    gn_free(w->scene.specimen.packed); /* was needed for this alone */
    w->scene.specimen.packed = NULL;
    w->scene.specimen.packed_count = 0;
    return status;
}

static void measure_extent(gn_world *w) {
    for (int a = 0; a < 3; a++) {
        w->lower[a] = INFINITY;
        w->upper[a] = -INFINITY;
        for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
            const double *x = w->dem.particles.pos + 4 * p;
            double r = a < (int)w->scene.dimension ? x[3] : 0.0;
            w->lower[a] = fmin(w->lower[a], x[a] - r);
            w->upper[a] = fmax(w->upper[a], x[a] + r);
        }
    }
}

static gneiss_status measure_test(gn_world *w, gneiss_error *error) {
    const gn_scene *s = &w->scene;
    if (s->test.kind == GN_TEST_NONE) return GNEISS_OK;
    gn_tested_shape shape = gn_test_shape(w);
    w->test_length = shape.length;
    w->test_area = shape.area;
    if (s->test.kind == GN_TEST_BENDING && s->test.notch >= shape.height)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s: expected a notch that is less deep than the beam, which is %.6g m high, "
            "found %.6g m",
            gn_scene_at(s, s->test.where, "test.notch").text, shape.height, s->test.notch);
    bool sound = shape.length > 0.0 && isfinite(shape.length);
    if (s->test.kind != GN_TEST_SIMPLE_SHEAR || sound) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected an upper end above the lower one along %c, with "
                   "something to shear between them, found %s",
                   gn_scene_at(s, s->test.where, "test").text, "xyz"[s->test.normal],
                   isfinite(shape.length) ? "ends that overlap" : "an end without particles");
}

typedef enum volume_source {
    FROM_ELEMENTS,
    FROM_BOX,
    FROM_SOURCES,
    FROM_SHAPE,
    FROM_PACKING,
    FROM_TEST,
    FROM_HULL
} volume_source;

static volume_source source_of_volume(const gn_world *w) {
    if (!w->scene.has_specimen) return FROM_ELEMENTS;
    if (w->effects & GN_FX_PERIODIC) return FROM_BOX;
    if (!w->scene.specimen_given) return FROM_SOURCES;
    if (w->scene.specimen.pack.shape != GN_SHAPE_NONE) return FROM_SHAPE;
    if (gn_scene_from_packing(&w->scene)) return FROM_PACKING;
    bool given = w->scene.test.kind != GN_TEST_NONE && gn_test_shape(w).volume > 0.0;
    return given ? FROM_TEST : FROM_HULL;
}

bool gn_world_volume_is_of_test(const gn_world *w) {
    return source_of_volume(w) == FROM_TEST;
}

bool gn_world_volume_is_of_hull(const gn_world *w) {
    return source_of_volume(w) == FROM_HULL;
}

const char *gn_world_volume_source(const gn_world *w) {
    static const char *const names[] = {"the elements",
                                        "the periodic box",
                                        "the box about the sources",
                                        "the shape",
                                        "the shape that was packed",
                                        "length times area of the test",
                                        "the convex hull of the particles"};
    volume_source source = source_of_volume(w);
    if (source == FROM_TEST && w->scene.test.kind == GN_TEST_BRAZILIAN)
        return "the disc of the test";
    return names[source];
}

/* Along an axis without sides as far as the particles reach. */
static double box_volume(const gn_world *w) {
    int64_t open = w->scene.periodic_open;
    return gn_box_section(w) * (open >= 0 ? w->upper[open] - w->lower[open] : 1.0);
}

/* Extent with radii and the volume that density, porosity and average stress refer to. That of a
 * shape is there already. */
static gneiss_status measure_specimen(gn_world *w, gneiss_error *error) {
    volume_source source = source_of_volume(w);
    if (!w->scene.specimen_given)
        gn_flow_bounds(w, w->lower, w->upper);
    else if (source == FROM_HULL)
        GN_TRY(gn_packing_hull(&w->dem.particles, (int)w->scene.dimension, &w->volume, w->lower,
                               w->upper, error));
    else
        measure_extent(w);
    if (source == FROM_SOURCES)
        w->volume = (w->upper[0] - w->lower[0]) * (w->upper[1] - w->lower[1]) *
                    (w->effects & GN_FX_SPACE ? w->upper[2] - w->lower[2] : 1.0);
    if (source == FROM_BOX) w->volume = box_volume(w);
    GN_TRY(measure_test(w, error));
    if (source == FROM_TEST) w->volume = gn_test_shape(w).volume;
    return GNEISS_OK;
}

double gn_world_porosity(const gn_world *w) {
    double solid = 0.0;
    if (source_of_volume(w) == FROM_SOURCES)
        return 0.0; /* a volume of their own is all they have */
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        solid += gn_ball_volume((int)w->scene.dimension, w->dem.particles.pos[4 * p + 3]);
    return 1.0 - solid / w->volume;
}

void gn_world_body(const gn_world *w, double lower[3], double upper[3]) {
    memcpy(lower, w->lower, sizeof w->lower);
    memcpy(upper, w->upper, sizeof w->upper);
    if (w->scene.has_couple) gn_elements_extent(w, lower, upper);
}

double gn_world_side(const gn_world *w, int axis) {
    double lower[3], upper[3];
    gn_world_body(w, lower, upper);
    return upper[axis] - lower[axis];
}

double gn_world_mean_radius(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) sum += q->pos[4 * p + 3];
    return sum / (double)q->soa.count;
}

double gn_world_mass(const gn_world *w) {
    return w->dem.mass + gn_elements_totals(w).mass;
}

/* From what files show, so that a resumed run has the same bits. */
static void set_domain(gn_world *w) {
    gn_scene *s = &w->scene, *given = &w->given;
    if (s->has_domain || (w->effects & GN_FX_PERIODIC && !gn_scene_half_periodic(s))) return;
    double size = 0.0, lower[3], upper[3];
    gn_flow_bounds(w, lower, upper);
    for (int a = 0; a < 3; a++) {
        lower[a] = fmin(lower[a], w->lower[a]);
        upper[a] = fmax(upper[a], w->upper[a]);
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

static gneiss_status choose_kernels(gn_world *w, gneiss_error *error) {
    gneiss_status status = gn_kernel_set_choose(gn_isa_name(w->scene.isa), &w->kernels, error);
    gn_scene_place where = w->scene.isa_where;
    if (status != GNEISS_OK && w->scene.isa != GN_ISA_AUTO) {
        gn_fail_context(error, "run."); /* else the environment's is at fault */
        if (where.line)
            gn_fail_context(error, "%s:%d:%d: ", w->scene.source, where.line, where.column);
    }
    return status;
}

gneiss_status gn_world_use_threads(gn_world *w, int threads, gneiss_error *error) {
    w->threads = threads < GN_THREADS_MAX ? threads : GN_THREADS_MAX;
    return gn_dem_use_threads(w, error);
}

static gneiss_status check_built(const gn_scene *s, gneiss_error *error) {
    char names[256] = "";
    gn_effects missing = gn_scene_not_built(s);
    for (int k = 0; k < GN_EFFECT_COUNT; k++)
        if (missing >> k & 1) {
            size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "",
                     gn_effect_name((gn_effect_index)k));
        }
    if (!missing) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s: expected a scene without %s, which this build leaves out (option 'without' "
                   "of meson), found one that calls for it",
                   s->source, names);
}

/* Scene -> effects, threads, kernels, period: everything that does not depend on particles. Resume
 * calls this too, so that a checkpoint goes on with the kernels of its scene. */
gneiss_status gn_world_prepare(gn_world *w, gneiss_error *error) {
    GN_TRY(check_built(&w->scene, error));
    w->effects = gn_scene_effects(&w->scene);
    w->threads = gn_threads_of(w->scene.threads);
    for (int a = 0; a < 3; a++)
        w->period[a] =
            a == w->scene.periodic_open ? 0.0 : w->scene.periodic_max[a] - w->scene.periodic_min[a];
    gn_box_create(w);
    gn_control_create(w);
    GN_TRY(choose_kernels(w, error));
    return gn_dem_prepare(w, error);
}

static gneiss_status check_specimen(const gn_world *w, gneiss_error *error) {
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        for (int a = 0; w->scene.has_domain && a < (int)w->scene.dimension; a++) {
            double x = w->dem.particles.pos[4 * p + a];
            if (x >= w->scene.domain_min[a] && x <= w->scene.domain_max[a]) continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected particles inside the domain, found particle %d at "
                           "%c = %.*g m",
                           gn_scene_at(&w->scene, w->scene.specimen.where, "specimen").text,
                           w->dem.particles.id[p], "xyz"[a], w -> scene.origin[a] != 0.0 ? 12 : 6,
                           gn_point_out(w->scene.origin[a], x));
        }
    return GNEISS_OK;
}

/* Sinks take at the start what is in them. */
static gneiss_status check_some_left(const gn_world *w, gneiss_error *error) {
    const gn_scene *s = &w->scene;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        if (w->dem.particles.vel[4 * p + 3] != 0.0) return GNEISS_OK;
    if (s->source_count || !s->sink_count) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_INPUT,
                   "%s:%d:%d: sinks: expected a specimen of which something lies outside of them, "
                   "found all of its %lld particles inside",
                   s->source, s->sinks[0].where.line, s->sinks[0].where.column,
                   (long long)w->dem.ids);
}

static gneiss_status build_particles(gn_world *w, gneiss_error *error) {
    GN_TRY(load_specimen(w, error));
    GN_TRY(gn_origin_check_specimen(w, error));
    GN_TRY(measure_specimen(w, error));
    set_domain(w);
    GN_TRY(check_specimen(w, error));
    GN_TRY(gn_dem_complete(w, error));
    GN_TRY(gn_membrane_create(w, error));
    GN_TRY(gn_coupled_create(w, error));
    GN_TRY(gn_boundary_create(w, error));
    /* What bodies leave free to be sheared. */
    if (w->scene.test.kind == GN_TEST_SHEAR) GN_TRY(measure_test(w, error));
    GN_TRY(gn_element_contact_create(w, error));
    GN_TRY(gn_flow_arrive(w, true, error));
    GN_TRY(gn_dem_arrange(w, error));
    GN_TRY(gn_world_rebuild(w, error));
    GN_TRY(gn_membrane_bear(w, error));
    return check_some_left(w, error);
}

static gneiss_status build_empty(gn_world *w, gneiss_error *error) {
    GN_TRY(gn_dem_create_empty(w, error));
    return gn_world_restore(w, error);
}

/* Without particles the elements are the specimen. */
static gneiss_status measure_elements(gn_world *w, gneiss_error *error) {
    for (size_t a = 0; a < 3; a++) {
        w->lower[a] = INFINITY;
        w->upper[a] = -INFINITY;
    }
    gn_elements_extent(w, w->lower, w->upper);
    w->volume = gn_elements_totals(w).volume;
    return measure_test(w, error);
}

/* The fastest scene takes a microsecond a step: these are thirty years. */
static const double steps_most = 1e15;

gneiss_status gn_world_check_duration(const gn_world *w, gneiss_error *error) {
    double steps = (w->scene.end - w->time) / w->dt;
    if (steps <= steps_most) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected an end within %.0g steps, found %.3g steps of %.4g s "
        "to t = %.4g s: no run comes to its end (time.end, time.safety, time.contact_steps, "
        "time.step)",
        gn_scene_at(&w->scene, w->scene.time_where, "time").text, steps_most, steps, w->dt,
        w->scene.end);
}

typedef struct gauge_work {
    gn_world *w;
    gneiss_status status;
    gneiss_error error;
} gauge_work;

static void *make_gauge(void *context) {
    gauge_work *k = context;
    gn_world *w = k->w;
    k->status = gn_gauge_create(w, &k->error);
    return NULL;
}

/* The strain gauge and the step: the two longest parts of setting up. Qhull has one thread only,
 * so that the other threads do the step meanwhile. */
static gneiss_status make_gauge_and_step(gn_world *w, bool particles, gneiss_error *error) {
    gauge_work gauge = {w, GNEISS_OK, {0}};
    pthread_t thread;
    const int threads = w->threads;
    /* A box that is periodic all round has no surface whose displacements would tell its strain;
     * what comes and goes has none. */
    bool box = w->effects & GN_FX_PERIODIC && !gn_scene_half_periodic(&w->scene);
    bool wanted = particles && !box && !gn_scene_has_flow(&w->scene),
         beside = wanted && threads > 1;
    if (beside) beside = pthread_create(&thread, NULL, make_gauge, &gauge) == 0;
    if (wanted && !beside) make_gauge(&gauge);
    w->threads = beside ? threads - 1 : threads;
    gneiss_status status = GNEISS_OK;
    if (beside || gauge.status == GNEISS_OK) status = gn_world_check_step(w, true, error);
    if (beside) (void)pthread_join(thread, NULL);
    w->threads = threads;
    if (gauge.status == GNEISS_OK) gn_gauge_note_apart(w);
    if (gauge.status == GNEISS_OK) return status;
    return gn_fail(error, gauge.status, "%s", gauge.error.message);
}

static gneiss_status build(gn_world *w, gneiss_error *error) {
    bool particles = w->given.has_specimen;
    gn_mesh mesh = {0};
    gneiss_status status = gn_origin_enter(w, &mesh, error);
    if (status == GNEISS_OK) status = gn_world_prepare(w, error);
    if (status == GNEISS_OK)
        status = gn_elements_create(w, w->scene.elements.mesh[0] ? &mesh : NULL, error);
    gn_mesh_free(&mesh);
    GN_TRY(status);
    GN_TRY(particles ? build_particles(w, error) : build_empty(w, error));
    if (!particles) GN_TRY(measure_elements(w, error));
    GN_TRY(gn_ends_check(w, error));
    gn_ends_begin(w);
    w->section = gn_section_of(w);
    GN_TRY(gn_geometry_check(w, error));
    GN_TRY(gn_sides_check(w, error));
    GN_TRY(gn_stages_check_first(w, error));
    GN_TRY(gn_pulse_start(w, error));
    GN_TRY(make_gauge_and_step(w, particles, error));
    GN_TRY(gn_dem_scale_masses(w, error));
    /* Of the step that is left when collisions have to be resolved, too. */
    GN_TRY(gn_world_check_duration(w, error));
    return gn_origin_check(w, error);
}

gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error) {
    memset(world, 0, sizeof *world);
    world->given = *scene;
    memset(scene, 0, sizeof *scene);
    double start = gn_now();
    gneiss_status status = build(world, error);
    /* First lists and the first stability limit are set-up, not part of the run. */
    memset(world->seconds, 0, sizeof world->seconds);
    world->seconds[GN_PHASE_setup] = gn_now() - start;
    if (status != GNEISS_OK) gn_world_free(world);
    return status;
}

void gn_world_free(gn_world *w) {
    gn_boundary_free(&w->boundary);
    gn_elements_free(w);
    gn_dem_free(&w->dem);
    gn_strain_gauge_free(&w->gauge);
    gn_free(w->belongs);
    gn_exchanges_free(w);
    gn_free(w->stages);
    gn_scene_free(&w->scene);
    gn_scene_free(&w->given);
    memset(w, 0, sizeof *w);
}

void gn_world_point_out(const gn_world *w, const double point[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = gn_point_out(w->scene.origin[a], point[a]);
}

gn_assembly gn_world_assembly(const gn_world *w) {
    gn_assembly a = {0};
    gn_near_settle(w);
    a.dimension = (int)w->scene.dimension;
    a.particles = &w->dem.particles;
    a.bonds = &w->dem.bonds;
    a.pairs = &w->dem.pairs;
    a.wall_contacts = w->effects & GN_FX_WALLS ? &w->boundary.contacts : NULL;
    a.wall_count = w->scene.wall_count;
    a.wall_normals = w->boundary.wall_normals;
    a.periodic = w->effects & GN_FX_PERIODIC;
    memcpy(a.period, w->period, sizeof a.period);
    return a;
}

uint64_t gn_world_hash(const gn_world *w) {
    uint64_t h = gn_dem_hash(w, GN_HASH_SEED);
    h = gn_boundary_hash(w, h);
    h = gn_elements_hash(w, h);
    if (gn_box_moves(w)) h = gn_hash_bytes(w->period, sizeof w->period, h);
    h = gn_hash_bytes(&w->time, sizeof w->time, h);
    return gn_hash_bytes(&w->step, sizeof w->step, h);
}

size_t gn_world_bytes(const gn_world *w) {
    return gn_dem_bytes(w) + gn_boundary_bytes(w) + gn_elements_bytes(w);
}
