#include "accuracy/covers.h"

#include "scene/acts.h"

#include <math.h>
#include <string.h>

/* --- ends --- */

/* Mean over the parts of an end. */
static double end_of(const gn_scene *scene, const gn_test_end *end, double time, bool path) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        if (!motion) continue;
        const gn_table *table = &motion->velocity[scene->test.axis];
        sum += path ? gn_table_between(table, 0.0, time) : gn_table_at(table, time);
    }
    return end->count ? sum / (double)end->count : 0.0;
}

static double apart(const gn_scene *scene, double time, bool path) {
    const double sign = (double)gn_scene_test(scene)->sign;
    return sign * (end_of(scene, &scene->test.upper, time, path) -
                   end_of(scene, &scene->test.lower, time, path));
}

double gn_test_closing(const gn_scene *scene, double time) {
    return apart(scene, time, false);
}

/* Tables are linear between points, so that the largest value is at one of them. */
static double fastest_at_points(const gn_scene *scene, const gn_test_end *end, double fastest) {
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(scene, end->name[k]);
        const gn_table *table = motion ? &motion->velocity[scene->test.axis] : NULL;
        for (size_t p = 0; table && p < table->count; p++)
            if (table->time[p] <= scene->end)
                fastest = fmax(fastest, gn_test_closing(scene, table->time[p]));
    }
    return fastest;
}

double gn_test_fastest(const gn_scene *scene) {
    double fastest = gn_test_closing(scene, scene->end);
    fastest = fastest_at_points(scene, &scene->test.lower, fastest);
    return fastest_at_points(scene, &scene->test.upper, fastest);
}

double gn_test_path(const gn_scene *scene, double time) {
    return apart(scene, time, true);
}

double gn_test_bulk_density(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_solids *solids) {
    return gn_world_mass(dem, solids) / ctx->volume;
}

/* --- particles --- */

/* Counts particles over the shortest side across the axis of the test. */
static double particles_across(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double shortest = INFINITY, radii = 0.0;
    for (int a = 0; a < ctx->scene.dimension; a++)
        if (a != ctx->scene.test.axis) shortest = fmin(shortest, ctx->upper[a] - ctx->lower[a]);
    for (size_t p = 0; p < q->soa.count; p++) radii += q->pos[4 * p + 3];
    return shortest * (double)q->soa.count / (2.0 * radii);
}

static double damping_of(const gn_scene *scene) {
    switch (scene->background) {
    case GN_BACKGROUND_NONE:
        return 0.0;
    case GN_BACKGROUND_NONVISCOUS_VECTOR:
    case GN_BACKGROUND_NONVISCOUS_COMPONENT:
        return scene->background_coefficient;
    case GN_BACKGROUND_VISCOUS:
        break;
    }
    return -1.0;
}

/* Returns the law of bonds whose packings the study has (validate/accuracy/scatter.py): all uniform
 * laws count as mean_radius, and both laws by area as dempack. */
static const char *bonds_of(const gn_scene *scene) {
    switch (scene->stiffness) {
    case GN_STIFFNESS_HARMONIC:
        return "harmonic";
    case GN_STIFFNESS_ARITHMETIC:
        return "arithmetic";
    case GN_STIFFNESS_UNIFORM:
    case GN_STIFFNESS_MEAN_RADIUS:
    case GN_STIFFNESS_MEAN_ARITHMETIC:
    case GN_STIFFNESS_MEAN_HARMONIC:
        return "mean_radius";
    case GN_STIFFNESS_DEMPACK:
    case GN_STIFFNESS_POLYHEDRON:
        return "dempack";
    case GN_STIFFNESS_HERTZ:
        break;
    }
    return NULL;
}

static const char *cover_particles(const gn_step_context *ctx, const gn_dem *dem,
                                   gn_test_groups *groups) {
    const gn_scene *scene = &ctx->scene;
    const gn_test_descriptor *d = gn_scene_test(scene);
    const bool plane = scene->dimension == 2, crushed = d->sign < 0;
    if (scene->bonds != GN_SWITCH_ON || !dem->bonds_at_start)
        return "the study has no test of unbonded particles";
    if (ctx->effects & (GN_FX_SOFTENING | GN_FX_YIELD | GN_FX_BOND_MOMENTS))
        return "the study has no bonds that soften, yield or carry moments";
    if (!d->study) return "for particles the study covers compression and tension";
    if (scene->has_membrane) return "the study has no test under a membrane";
    if (scene->has_elements) return "the study has no test of coupled particles and elements";
    if (scene->body_count) return "the study has no test with bodies";
    if (scene->has_periodic) return "the study has no periodic test";
    if (plane && scene->specimen.pack.shape == GN_SHAPE_DISC && crushed)
        return "the study predicts no peak of a Brazilian disc";
    groups->study = d->study;
    /* Discs scatter more than spheres, above all in compression. */
    groups->floors = !plane ? groups->study : crushed ? "compression-plane" : "brazilian";
    groups->bonds = bonds_of(scene);
    groups->particles = (double)dem->particles.soa.count;
    groups->across = particles_across(ctx, dem);
    groups->step_ratio = dem->scaling.step > 0.0 ? dem->scaling.step / dem->scaling.unscaled : 1.0;
    groups->first_break = scene->start == GN_START_FIRST_BREAK;
    groups->damping = damping_of(scene);
    return NULL;
}

/* --- elements --- */

static const char *cover_elements(const gn_scene *scene, gn_test_groups *groups) {
    const gn_element_def *elements = &scene->elements;
    bool mixed_form = elements->formulation == GN_FORMULATION_PRESSURE;
    if (elements->has_beam && elements->beam.notch_depth > 0.0) {
        *groups = (gn_test_groups){.study = "notched-elements", .mesh = "cell"};
        groups->cell = elements->beam.cell / elements->beam.height;
        groups->tip = 1.0 / (double)elements->beam.notch_cells;
    } else if (elements->has_rectangle &&
               elements->size[1 - scene->test.axis] >= 4.0 * elements->size[scene->test.axis]) {
        *groups = (gn_test_groups){.study = "cantilever",
                                   .mesh = mixed_form ? "elements, mixed form" : "elements"};
        groups->cell = 1.0 / (double)elements->cells[scene->test.axis];
    } else {
        return "for elements the study covers notched beams and rectangles in bending";
    }
    groups->floors = groups->study;
    groups->packings = 1.0;
    return NULL;
}

const char *gn_study_find_case(const gn_step_context *ctx, const gn_dem *dem,
                               gn_test_groups *groups) {
    const gn_scene *scene = &ctx->scene;
    *groups = (gn_test_groups){.packings = 1.0, .step_ratio = 1.0, .speed = NAN, .across = NAN};
    if (!gn_scene_tested(scene)) return "the scene has no test";
    if (scene->stage_count) return "the study has no test in stages";
    const char *reason =
        scene->has_specimen ? cover_particles(ctx, dem, groups) : cover_elements(scene, groups);
    groups->speed = NAN;
    /* A later reduction of an automatic step does not affect its safety. */
    groups->safety = ctx->step > 0 && scene->step == 0.0 ? scene->safety : ctx->dt / ctx->stable;
    groups->mixed = ctx->effects & GN_FX_MIXED;
    return reason;
}
