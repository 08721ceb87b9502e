/* What is read of particles that sleep: they are where the elements have the body. */
#include "base/memory.h"
#include "conversion/conversion.h"
#include "couple/ties.h"
#include "fem/solid.h"
#include "laboratory/strain_gauge.h"
#include "measure/measure.h"
#include "particles/dem.h"
#include "soa/records.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

int32_t *gn_conversion_places(const gn_step_context *ctx, const gn_solids *solids) {
    size_t count;
    return gn_converts(ctx) ? gn_fem_places(gn_coupled_solid(solids), &count) : NULL;
}

size_t gn_conversion_asleep(const gn_dem *dem) {
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++) count += gn_particle_is_dormant(dem, p);
    return count;
}

bool gn_conversion_begun(const gn_solids *solids) {
    size_t count = 0;
    gn_free(gn_fem_places(gn_coupled_solid(solids), &count));
    return gn_conversion_elements(solids) < count;
}

/* Where one that sleeps is in the elements; false: not without their places. */
static bool find_dormant(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                         size_t p, gn_tie *tie, gn_ties *one) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    if (!places) return false;
    *tie = gn_tie_at(b, places[gn_dormant_element(dem, p)], dem->particles.start + 4 * p);
    *one = (gn_ties){.corners = b->dimension + 1, .count = 1, .tie = tie};
    return true;
}

void gn_conversion_travel(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                          size_t p, double u[3]) {
    const gn_particles *q = &dem->particles;
    gn_tie tie;
    gn_ties one;
    for (size_t a = 0; a < 3; a++) u[a] = q->pos[4 * p + a] - q->start[4 * p + a];
    if (!gn_particle_is_dormant(dem, p)) return;
    u[0] = u[1] = u[2] = NAN; /* no memory */
    if (find_dormant(dem, solids, places, p, &tie, &one))
        gn_tie_travel(&one, 0, &gn_coupled_solid(solids)->nodes, u);
}

void gn_conversion_velocity(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                            size_t p, double v[3]) {
    gn_tie tie;
    gn_ties one;
    memcpy(v, dem->particles.vel + 4 * p, 3 * sizeof *v);
    if (gn_particle_is_dormant(dem, p) && find_dormant(dem, solids, places, p, &tie, &one))
        gn_tie_mean(&one, 0, gn_coupled_solid(solids)->nodes.vel, v);
}

void gn_conversion_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_gauge *gauge, double gradient[9]) {
    gn_strain_gauge_read(&gauge->weights, &dem->particles, dem->index_of_id, gradient);
    int32_t *places = gn_conversion_places(ctx, solids);
    for (size_t k = 0; gn_converts(ctx) && k < gauge->weights.count; k++) {
        const int32_t p = dem->index_of_id[gauge->weights.id[k]];
        double u[3];
        if (p < 0 || !gn_particle_is_dormant(dem, (size_t)p)) continue;
        gn_conversion_travel(dem, solids, places, (size_t)p, u);
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++)
                gradient[3 * a + c] += u[a] * gauge->weights.weight[3 * k + c];
    }
    gn_free(places);
}
