/* What is ready to be converted, for who checks a scene. */
#include "base/memory.h"
#include "couple/front.h"
#include "sim/conversion_internal.h"

#include <math.h>

/* The mean side of the boxes about elements in the box of the scene; kg of these. */
static double measure_elements(const gn_fem_solid *b, const uint8_t *kind,
                               gn_conversion_figures *f) {
    double mass = 0.0, sum = 0.0;
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        if (kind[e] == GN_FRONT_FIXED) continue;
        for (int k = 0; k < b->dimension; k++) {
            double lower = INFINITY, upper = -INFINITY;
            for (int a = 0; a <= b->dimension; a++) {
                double x =
                    b->nodes.start[4 * (size_t)gn_elements_node(&b->elements, a)[e] + (size_t)k];
                lower = fmin(lower, x);
                upper = fmax(upper, x);
            }
            sum += (upper - lower) / b->dimension;
        }
        mass += b->density[b->elements.material[e]] * b->elements.volume[e];
        f->elements++;
        f->held += kind[e] == GN_FRONT_HELD;
    }
    f->element = f->elements ? sum / (double)f->elements : 0.0;
    return mass;
}

/* kg of the particles in these, awake or not. */
static double measure_particles(const gn_world *w, const uint8_t *kind, const int32_t *place,
                                gn_conversion_figures *f) {
    const gn_particles *q = &w->dem.particles;
    double mass = 0.0, sum = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const int32_t e = place[gn_home_id(w, p)];
        if (e < 0 || kind[e] == GN_FRONT_FIXED) continue;
        mass += 1.0 / (gn_is_asleep(w, p) ? gn_sleeper_of(w, p)->mass : q->vel[4 * p + 3]);
        sum += 2.0 * q->pos[4 * p + 3];
        f->particles++;
    }
    f->diameter = f->particles ? sum / (double)f->particles : 0.0;
    return mass;
}

static void swap(double *a, double *b) {
    const double before = *a;
    *a = *b;
    *b = before;
}

void gn_conversion_turn_over(gn_world *w) {
    gn_particles *q = &w->dem.particles;
    const gn_contacts bonds = w->dem.bonds;
    if (!gn_converts(w)) return;
    for (size_t p = 0; p < q->soa.count; p++) {
        swap(q->vel + 4 * p + 3, &gn_sleeper_of(w, p)->mass);
        if (q->spin) swap(q->spin + 4 * p + 3, &gn_sleeper_of(w, p)->inertia);
    }
    w->dem.bonds = w->dem.prepared;
    w->dem.prepared = bonds;
}

gneiss_status gn_conversion_limit(gn_world *w, gn_step_limit *limit, gneiss_error *error) {
    const gn_step_limit before = w->dem.limit;
    const double stable = w->dem.stable;
    bool due;
    gn_conversion_turn_over(w);
    gneiss_status status = gn_dem_limit(w, true, &due, error);
    gn_conversion_turn_over(w);
    *limit = w->dem.limit;
    w->dem.limit = before;
    w->dem.stable = stable;
    return status;
}

gneiss_status gn_conversion_measure(const gn_world *w, gn_conversion_figures *f,
                                    gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(w);
    size_t count;
    uint8_t *kind = gn_alloc(b->elements.soa.count + 1);
    int32_t *place = gn_fem_places(b, &count);
    *f = (gn_conversion_figures){0};
    gneiss_status status =
        kind && place ? gn_conversion_kinds(w, kind, error)
                      : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at elements");
    if (status == GNEISS_OK) {
        const double elements = measure_elements(b, kind, f);
        f->mass = measure_particles(w, kind, place, f) / elements;
    }
    gn_free(kind);
    gn_free(place);
    return status;
}
