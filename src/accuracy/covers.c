#include "accuracy/covers.h"

#include "scene/acts.h"

#include <math.h>
#include <string.h>

/* --- ends --- */

/* Mean over the parts of an end. */
static double end_of(const gn_scene *s, const gn_test_end *end, double time, bool path) {
    double sum = 0.0;
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(s, end->name[k]);
        if (!motion) continue;
        const gn_table *table = &motion->velocity[s->test.axis];
        sum += path ? gn_table_between(table, 0.0, time) : gn_table_at(table, time);
    }
    return end->count ? sum / (double)end->count : 0.0;
}

static double apart(const gn_scene *s, double time, bool path) {
    const gn_test_descriptor *d = gn_scene_test(s);
    double sign = d->study ? d->sign : 1.0;
    return sign * (end_of(s, &s->test.upper, time, path) - end_of(s, &s->test.lower, time, path));
}

double gn_test_closing(const gn_scene *s, double time) {
    return apart(s, time, false);
}

/* Tables are straight from one point to the next, so that the fastest is at one of them. */
static double fastest_at_points(const gn_scene *s, const gn_test_end *end, double fastest) {
    for (size_t k = 0; k < end->count; k++) {
        const gn_motion *motion = gn_scene_end_motion(s, end->name[k]);
        const gn_table *table = motion ? &motion->velocity[s->test.axis] : NULL;
        for (size_t p = 0; table && p < table->count; p++)
            if (table->time[p] <= s->end)
                fastest = fmax(fastest, gn_test_closing(s, table->time[p]));
    }
    return fastest;
}

double gn_test_fastest(const gn_scene *s) {
    double fastest = gn_test_closing(s, s->end);
    fastest = fastest_at_points(s, &s->test.lower, fastest);
    return fastest_at_points(s, &s->test.upper, fastest);
}

double gn_test_path(const gn_scene *s, double time) {
    return apart(s, time, true);
}

double gn_test_bulk(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids) {
    return gn_world_mass(dem, solids) / ctx->volume;
}

/* --- particles --- */

/* Over the shortest side across the axis of the test. */
static double particles_across(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    double shortest = INFINITY, radii = 0.0;
    for (int a = 0; a < ctx->scene.dimension; a++)
        if (a != ctx->scene.test.axis) shortest = fmin(shortest, ctx->upper[a] - ctx->lower[a]);
    for (size_t p = 0; p < q->soa.count; p++) radii += q->pos[4 * p + 3];
    return shortest * (double)q->soa.count / (2.0 * radii);
}

static double damping_of(const gn_scene *s) {
    switch (s->background) {
    case GN_BACKGROUND_NONE:
        return 0.0;
    case GN_BACKGROUND_NONVISCOUS_VECTOR:
    case GN_BACKGROUND_NONVISCOUS_COMPONENT:
        return s->background_coefficient;
    case GN_BACKGROUND_VISCOUS:
        break;
    }
    return -1.0;
}

/* What the study has packings of (validate/accuracy/scatter.py): means over the pairs are as
 * uniform as that over the particles, and areas as areas. */
static const char *bonds_of(const gn_scene *s) {
    switch (s->stiffness) {
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
                                   gn_test_groups *g) {
    const gn_scene *s = &ctx->scene;
    const gn_test_descriptor *d = gn_scene_test(s);
    const bool plane = s->dimension == 2, crushed = d->sign < 0;
    if (s->bonds != GN_SWITCH_ON || !dem->bonds_at_start)
        return "the study has no test of grains without bonds";
    if (ctx->effects & (GN_FX_SOFTENING | GN_FX_YIELD | GN_FX_BOND_MOMENTS))
        return "the study has no bonds that soften, yield or carry moments";
    if (!d->study) return "of tests of particles the study has compression and tension";
    if (s->has_membrane) return "the study has no test under a membrane";
    if (s->has_elements) return "the study has no test of particles and elements together";
    if (s->body_count) return "the study has no test with bodies";
    if (s->has_periodic) return "the study has no periodic test";
    if (plane && s->specimen.pack.shape == GN_SHAPE_DISC && crushed)
        return "the study foretells no peak of a disc that is pressed across";
    g->study = d->study;
    /* Discs scatter more than spheres, above all where they are crushed. */
    g->floors = !plane ? g->study : crushed ? "compression-plane" : "brazilian";
    g->bonds = bonds_of(s);
    g->particles = (double)dem->particles.soa.count;
    g->across = particles_across(ctx, dem);
    g->masses = dem->scaling.step > 0.0 ? dem->scaling.step / dem->scaling.unscaled : 1.0;
    g->first_break = s->start == GN_START_FIRST_BREAK;
    g->damping = damping_of(s);
    return NULL;
}

/* --- elements --- */

static const char *cover_elements(const gn_scene *s, gn_test_groups *g) {
    const gn_element_def *e = &s->elements;
    bool mixed_form = e->formulation == GN_FORMULATION_PRESSURE;
    if (e->has_beam && e->beam.notch_depth > 0.0) {
        *g = (gn_test_groups){.study = "notched-elements", .mesh = "cell"};
        g->cell = e->beam.cell / e->beam.height;
        g->tip = 1.0 / (double)e->beam.notch_cells;
    } else if (e->has_rectangle && e->size[1 - s->test.axis] >= 4.0 * e->size[s->test.axis]) {
        *g = (gn_test_groups){.study = "cantilever",
                              .mesh = mixed_form ? "elements, mixed form" : "elements"};
        g->cell = 1.0 / (double)e->cells[s->test.axis];
    } else {
        return "the study has notched beams and rectangles that are bent, of elements";
    }
    g->floors = g->study;
    g->packings = 1.0;
    return NULL;
}

const char *gn_study_covers(const gn_step_context *ctx, const gn_dem *dem, gn_test_groups *g) {
    const gn_scene *s = &ctx->scene;
    *g = (gn_test_groups){.packings = 1.0, .masses = 1.0, .speed = NAN, .across = NAN};
    if (!gn_scene_tested(s)) return "the scene has no test";
    if (s->stage_count) return "the study has no test in stages";
    const char *reason = s->has_specimen ? cover_particles(ctx, dem, g) : cover_elements(s, g);
    g->speed = NAN;
    /* What an automatic step was lowered to later on says nothing of its safety. */
    g->safety = ctx->step > 0 && s->step == 0.0 ? s->safety : ctx->dt / ctx->stable;
    g->mixed = ctx->effects & GN_FX_MIXED;
    return reason;
}
