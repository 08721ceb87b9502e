#include "sim/world.h"

#include "base/ball.h"
#include "base/memory.h"
#include "base/point.h"
#include "base/random.h"
#include "base/timer.h"
#include "sim/origin.h"
#include "sim/parts.h"

#include <math.h>
#include <omp.h>
#include <stddef.h>
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

/* Packing -> particle record, in file order. A shape leaves its volume. */
static gneiss_status load_particles(gn_world *w, gneiss_error *error) {
    gn_packing packing = {0};
    GN_TRY(gn_specimen_make(&w->scene, &packing, &w->volume, error));
    if (packing.count > INT32_MAX - 2 * GN_LANES_MAX) {
        gn_packing_free(&packing);
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "%zu particles are more than the engine can number", packing.count);
    }
    gneiss_status status =
        gn_soa_create(&gn_particle_record, &w->dem.particles, packing.count, w->effects, error);
    if (status == GNEISS_OK) {
        gn_particles *q = &w->dem.particles;
        memcpy(q->pos, packing.sphere, packing.count * 4 * sizeof(double));
        memcpy(q->start, packing.sphere, packing.count * 4 * sizeof(double));
        int material = gn_scene_find_material(&w->scene, w->scene.specimen.material);
        for (size_t p = 0; p < packing.count; p++) {
            q->id[p] = (int32_t)p;
            q->vel[4 * p + 3] = 1.0; /* there; the mass comes when materials are known */
            q->material[p] = material < 0 ? 0 : material;
            q->group[p] = (int32_t)w->scene.specimen.group;
            if (q->slot) q->slot[p] = -1;
            if (q->orientation) q->orientation[4 * p] = 1.0;
        }
    }
    w->dem.radius_min = INFINITY;
    for (size_t p = 0; p < packing.count; p++)
        w->dem.radius_min = fmin(w->dem.radius_min, packing.sphere[4 * p + 3]);
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

/* Length and area of the specimen in a test, from the scene or its extent and volume. */
static void measure_test(gn_world *w) {
    const gn_test *t = &w->scene.test;
    int axis = (int)t->axis;
    if (t->kind == GN_TEST_NONE) return;
    w->test_length = t->length > 0.0 ? t->length : w->upper[axis] - w->lower[axis];
    if (t->area > 0.0)
        w->test_area = t->area;
    else if (t->diameter > 0.0)
        w->test_area =
            w->effects & GN_FX_SPACE ? 0.25 * M_PI * t->diameter * t->diameter : t->diameter;
    else
        w->test_area = w->volume / w->test_length;
}

typedef enum volume_source {
    FROM_ELEMENTS,
    FROM_BOX,
    FROM_SHAPE,
    FROM_TEST,
    FROM_HULL
} volume_source;

static volume_source source_of_volume(const gn_world *w) {
    const gn_test *t = &w->scene.test;
    if (!w->scene.has_specimen) return FROM_ELEMENTS;
    if (w->effects & GN_FX_PERIODIC) return FROM_BOX;
    if (w->scene.specimen.pack.shape != GN_SHAPE_NONE) return FROM_SHAPE;
    bool given = t->kind != GN_TEST_NONE && (t->area > 0.0 || t->diameter > 0.0);
    return given ? FROM_TEST : FROM_HULL;
}

const char *gn_world_volume_source(const gn_world *w) {
    static const char *const names[] = {"the elements", "the periodic box", "the shape",
                                        "length times area of the test",
                                        "the convex hull of the particles"};
    return names[source_of_volume(w)];
}

/* Extent with radii and the volume that density, porosity and average stress refer to. That of a
 * shape is there already. */
static gneiss_status measure_specimen(gn_world *w, gneiss_error *error) {
    volume_source source = source_of_volume(w);
    if (source == FROM_HULL)
        GN_TRY(gn_packing_hull(&w->dem.particles, (int)w->scene.dimension, &w->volume, w->lower,
                               w->upper, error));
    else
        measure_extent(w);
    if (source == FROM_BOX)
        w->volume = w->period[0] * w->period[1] * (w->effects & GN_FX_SPACE ? w->period[2] : 1.0);
    measure_test(w);
    if (source == FROM_TEST) w->volume = w->test_length * w->test_area;
    return GNEISS_OK;
}

double gn_world_porosity(const gn_world *w) {
    double solid = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        solid += gn_ball_volume((int)w->scene.dimension, w->dem.particles.pos[4 * p + 3]);
    return 1.0 - solid / w->volume;
}

double gn_world_mass(const gn_world *w) {
    return w->dem.mass + (w->elements ? w->elements->body.mass : 0.0);
}

static double bulk_factor(const gn_world *w) {
    if (w->scene.specimen.density_basis == GN_DENSITY_PARTICLE) return 1.0;
    double porosity = w->scene.specimen.porosity;
    if (porosity < 0.0) porosity = gn_world_porosity(w);
    return 1.0 / (1.0 - porosity);
}

/* Sphere I = 2/5 m r^2, disc of unit thickness I = 1/2 m r^2. */
static void set_masses(gn_world *w) {
    gn_particles *q = &w->dem.particles;
    double factor = bulk_factor(w);
    for (size_t p = 0; p < q->soa.count; p++) {
        double r = q->pos[4 * p + 3];
        double mass = w->scene.materials[q->material[p]].density * factor *
                      gn_ball_volume((int)w->scene.dimension, r);
        q->vel[4 * p + 3] = 1.0 / mass;
        if (q->spin)
            q->spin[4 * p + 3] = 1.0 / ((w->effects & GN_FX_SPACE ? 0.4 : 0.5) * mass * r * r);
        for (int a = 0; a < (int)w->scene.dimension; a++)
            q->vel[4 * p + a] =
                w->scene.random_velocity *
                gn_random_symmetric(w->scene.seed ^ UINT64_C(0x76656c), 3 * p + (size_t)a);
    }
}

/* From what files show, so that a resumed run has the same bits. */
static void set_domain(gn_world *w) {
    gn_scene *s = &w->scene, *given = &w->given;
    if (s->has_domain || w->effects & GN_FX_PERIODIC) return;
    double size = 0.0;
    for (int a = 0; a < (int)s->dimension; a++) size = fmax(size, w->upper[a] - w->lower[a]);
    for (int a = 0; a < (int)s->dimension; a++) {
        given->domain_min[a] = gn_point_out(s->origin[a], w->lower[a] - 10.0 * size);
        given->domain_max[a] = gn_point_out(s->origin[a], w->upper[a] + 10.0 * size);
        s->domain_min[a] = given->domain_min[a] - s->origin[a];
        s->domain_max[a] = given->domain_max[a] - s->origin[a];
    }
    s->has_domain = given->has_domain = true;
}

/* Wide enough that a quasi-static specimen never rebuilds, narrow enough that few idle pairs are
 * visited. */
static double automatic_skin(const gn_world *w) {
    double sum = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) sum += w->dem.particles.pos[4 * p + 3];
    return 0.15 * sum / (double)w->dem.particles.soa.count;
}

static gneiss_status choose_kernels(gn_world *w, gneiss_error *error) {
    gneiss_status status = gn_kernel_set_choose(gn_isa_name(w->scene.isa), &w->kernels, error);
    gn_scene_place where = w->scene.isa_where;
    if (status != GNEISS_OK && w->scene.isa != GN_ISA_AUTO) {
        gn_fail_context(error, "run."); /* else the environment's is at fault */
        if (where.line)
            gn_fail_context(error, "%s:%d:%d: ", w->scene.source, where.line, where.column);
    }
    GN_TRY(status);
    GN_TRY(gn_contact_kernel_choose(w->kernels, gn_contact_list_effects(w->effects, true),
                                    &w->dem.bond_kernel, error));
    GN_TRY(gn_contact_kernel_choose(w->kernels, gn_contact_list_effects(w->effects, false),
                                    &w->dem.pair_kernel, error));
    return gn_motion_kernel_choose(w->kernels, w->effects, &w->dem.motion_kernel, error);
}

gneiss_status gn_world_use_threads(gn_world *w, int threads, gneiss_error *error) {
    w->threads = threads < GN_THREADS_MAX ? threads : GN_THREADS_MAX;
    gn_deal_free(&w->dem.deal);
    GN_TRY(gn_deal_create(&w->dem.deal, w->threads, error));
    return gn_world_deal_lists(w, error);
}

/* Scene -> effects, threads, kernels, period: everything that does not depend on particles. Resume
 * calls this too, so that a checkpoint goes on with the kernels of its scene. */
gneiss_status gn_world_prepare(gn_world *w, gneiss_error *error) {
    w->effects = gn_scene_effects(&w->scene);
    int threads = w->scene.threads > 0 ? (int)w->scene.threads : omp_get_num_procs();
    GN_TRY(gn_world_use_threads(w, threads, error));
    w->dem.damping_fraction = gn_contact_damping_fraction(&w->scene);
    for (int a = 0; a < 3; a++) w->period[a] = w->scene.periodic_max[a] - w->scene.periodic_min[a];
    return choose_kernels(w, error);
}

static gneiss_status check_specimen(const gn_world *w, gneiss_error *error) {
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        for (int a = 0; w->scene.has_domain && a < (int)w->scene.dimension; a++) {
            double x = w->dem.particles.pos[4 * p + a];
            if (x >= w->scene.domain_min[a] && x <= w->scene.domain_max[a]) continue;
            return gn_fail(
                error, GNEISS_ERROR_INPUT,
                "%s:%d:%d: specimen: expected particles inside the domain, found particle %d at "
                "%c = %.*g m",
                w->scene.source, w->scene.specimen.where.line, w->scene.specimen.where.column,
                w->dem.particles.id[p], "xyz"[a], w -> scene.origin[a] != 0.0 ? 12 : 6,
                gn_point_out(w->scene.origin[a], x));
        }
    return GNEISS_OK;
}

/* A particle must not meet two images of another one: pairs are looked for within a reach. */
static gneiss_status check_period(const gn_world *w, gneiss_error *error) {
    const gn_scene *s = &w->scene;
    if (!(w->effects & GN_FX_PERIODIC)) return GNEISS_OK;
    double radius = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        radius = fmax(radius, w->dem.particles.pos[4 * p + 3]);
    double bonds = 2.0 * radius * (1.0 + s->interaction_range);
    double lists = 2.0 * radius + w->dem.verlet.skin, least = 2.0 * fmax(bonds, lists);
    const char *asks = bonds >= lists  ? ", with bonds.interaction_range"
                       : s->skin > 0.0 ? ", with neighbours.skin"
                                       : "";
    for (int a = 0; a < (int)s->dimension; a++)
        if (w->period[a] < least)
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s:%d:%d: periodic: expected a length of at least %g m along %c (twice "
                           "the reach of the largest particles%s), found %g m",
                           s->source, s->periodic_where.line, s->periodic_where.column, least,
                           "xyz"[a], asks, w -> period[a]);
    return GNEISS_OK;
}

static gneiss_status build_particles(gn_world *w, gneiss_error *error) {
    GN_TRY(load_particles(w, error));
    GN_TRY(gn_origin_check_specimen(w, error));
    GN_TRY(measure_specimen(w, error));
    set_domain(w);
    GN_TRY(check_specimen(w, error));
    GN_TRY(gn_sets_assign(w, error));
    set_masses(w);
    GN_TRY(gn_sets_apply(w, error));
    GN_TRY(gn_walls_create(w, error));
    GN_TRY(gn_bodies_create(w, error));
    GN_TRY(gn_element_contact_create(w, error));
    w->dem.index_of_id = gn_alloc_array(w->dem.particles.soa.count + 1, sizeof *w->dem.index_of_id);
    if (!w->dem.index_of_id)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for particle numbers");
    w->dem.verlet.skin = w->scene.skin > 0.0 ? w->scene.skin : automatic_skin(w);
    w->dem.verlet.skin_start = w->dem.verlet.skin;
    GN_TRY(check_period(w, error));
    GN_TRY(gn_world_rebuild(w, error));
    /* A periodic box has no surface whose displacements would tell its strain. */
    if (!(w->effects & GN_FX_PERIODIC))
        GN_TRY(
            gn_strain_gauge_create(&w->dem.particles, (int)w->scene.dimension, &w->gauge, error));
    return GNEISS_OK;
}

/* Without particles: empty records, so that nothing else needs to know. */
static gneiss_status build_empty(gn_world *w, gneiss_error *error) {
    GN_TRY(gn_soa_create(&gn_particle_record, &w->dem.particles, 0, w->effects, error));
    GN_TRY(gn_soa_create(&gn_contact_record, &w->dem.bonds, 0,
                         gn_contact_list_effects(w->effects, true), error));
    GN_TRY(gn_soa_create(&gn_contact_record, &w->dem.pairs, 0,
                         gn_contact_list_effects(w->effects, false), error));
    w->dem.verlet.skin = w->dem.verlet.skin_start = 1.0;
    return gn_world_restore(w, error);
}

static void measure_body(gn_world *w) {
    const gn_particles *nodes = &w->elements->body.nodes;
    for (size_t a = 0; a < 3; a++) {
        w->lower[a] = INFINITY;
        w->upper[a] = -INFINITY;
        for (size_t n = 0; n < nodes->soa.count; n++) {
            w->lower[a] = fmin(w->lower[a], nodes->start[4 * n + a]);
            w->upper[a] = fmax(w->upper[a], nodes->start[4 * n + a]);
        }
    }
    w->volume = w->elements->body.volume;
    measure_test(w);
}

/* The fastest scene takes a microsecond a step: these are thirty years. */
static const double steps_most = 1e15;

gneiss_status gn_world_check_duration(const gn_world *w, gneiss_error *error) {
    double steps = (w->scene.end - w->time) / w->dt;
    if (steps <= steps_most) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s:%d:%d: time: expected an end within %.0g steps, found %.3g steps of %.4g s "
        "to t = %.4g s: no run comes to its end (time.end, time.safety, time.contact_steps, "
        "time.step)",
        w->scene.source, w->scene.time_where.line, w->scene.time_where.column, steps_most, steps,
        w->dt, w->scene.end);
}

static gneiss_status build(gn_world *w, gneiss_error *error) {
    bool particles = w->given.has_specimen;
    gn_mesh mesh = {0};
    gneiss_status status = gn_origin_enter(w, &mesh, error);
    if (status == GNEISS_OK) status = gn_world_prepare(w, error);
    if (status == GNEISS_OK && w->scene.has_elements)
        status = gn_elements_create(w, w->scene.elements.mesh[0] ? &mesh : NULL, error);
    gn_mesh_free(&mesh);
    GN_TRY(status);
    GN_TRY(particles ? build_particles(w, error) : build_empty(w, error));
    if (!particles) measure_body(w);
    GN_TRY(gn_world_check_step(w, true, error));
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
    gn_elements_free(w);
    gn_soa_destroy(&gn_particle_record, &w->dem.particles);
    gn_soa_destroy(&gn_contact_record, &w->dem.bonds);
    gn_soa_destroy(&gn_contact_record, &w->dem.pairs);
    gn_soa_destroy(&gn_wall_contact_record, &w->boundary.contacts);
    gn_partials_free(&w->dem.bond_partials);
    gn_partials_free(&w->dem.pair_partials);
    gn_strain_gauge_free(&w->gauge);
    for (size_t k = 0; k < w->boundary.surface_count; k++)
        gn_facet_tree_free(&w->boundary.surfaces[k].tree);
    void *blocks[] = {w->boundary.bodies,      w->boundary.surfaces,    w->boundary.body_shape,
                      w->boundary.body_vertex, w->boundary.body_corner, w->boundary.first,
                      w->dem.index_of_id,      w->boundary.walls,       w->boundary.wall_normals,
                      w->dem.channel_set,      w->dem.set_reaction,     w->dem.loose,
                      w->dem.prescribed.set,   w->dem.prescribed.mask,  w->dem.prescribed.velocity,
                      w->dem.prescribed.load,  w->dem.bond_sums,        w->dem.pair_sums,
                      w->boundary.sums,        w->dem.motion_sums};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    gn_deal_free(&w->dem.deal);
    gn_hold_free(&w->dem.hold);
    gn_free(w->exchange);
    gn_scene_free(&w->scene);
    gn_scene_free(&w->given);
    memset(w, 0, sizeof *w);
}

void gn_world_point_out(const gn_world *w, const double point[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = gn_point_out(w->scene.origin[a], point[a]);
}

gn_assembly gn_world_assembly(const gn_world *w) {
    gn_assembly a = {0};
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
    uint64_t h = gn_soa_hash(&gn_particle_record, &w->dem.particles, GN_HASH_SEED);
    h = gn_soa_hash(&gn_contact_record, &w->dem.bonds, h);
    h = gn_soa_hash(&gn_contact_record, &w->dem.pairs, h);
    h = gn_soa_hash(&gn_wall_contact_record, &w->boundary.contacts, h);
    for (size_t k = 0; k < w->scene.wall_count; k++)
        h = gn_hash_bytes(w->boundary.walls[k].point, sizeof w->boundary.walls[k].point, h);
    for (size_t k = 0; k < w->scene.body_count; k++)
        h = gn_hash_bytes(&w->boundary.bodies[k], offsetof(gn_rigid, mass), h);
    if (w->elements) {
        uint64_t body = gn_fem_hash(&w->elements->body);
        h = gn_hash_bytes(&body, sizeof body, h);
    }
    h = gn_hash_bytes(&w->time, sizeof w->time, h);
    return gn_hash_bytes(&w->step, sizeof w->step, h);
}

static size_t list_bytes(const gn_contacts *list, const gn_partials *q) {
    return list->soa.capacity * gn_record_bytes(&gn_contact_record, list->soa.effects) +
           gn_partials_bytes(q, list->soa.count, 2);
}

size_t gn_world_bytes(const gn_world *w) {
    size_t n = w->dem.particles.soa.capacity;
    size_t bytes = n * gn_record_bytes(&gn_particle_record, w->effects);
    bytes += list_bytes(&w->dem.bonds, &w->dem.bond_partials) +
             list_bytes(&w->dem.pairs, &w->dem.pair_partials);
    bytes +=
        w->boundary.contacts.soa.capacity * gn_record_bytes(&gn_wall_contact_record, w->effects);
    if (w->elements) bytes += gn_fem_bytes(&w->elements->body);
    return bytes + n * 2 * sizeof(int32_t);
}
