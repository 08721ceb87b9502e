#include "solids/dormant_places.h"

#include "base/memory.h"
#include "couple/ties.h"
#include "frame/frame.h"
#include "particles/dormant.h"
#include "particles/particles.h"
#include "solids/solids.h"

#include <math.h>
#include <string.h>

size_t gn_elements_left_count(const gn_solids *solids) {
    return gn_coupled_solid(solids)->elements.soa.count;
}

/* Finds the position of a dormant particle in the elements; returns false without `places`. */
static bool find_dormant(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                         size_t p, gn_tie *tie, gn_ties *one) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    if (!places) return false;
    *tie = gn_tie_at(b, places[gn_dormant_element(dem, p)], dem->particles.start + 4 * p);
    *one = (gn_ties){.corners = b->dimension + 1, .count = 1, .tie = tie};
    return true;
}

bool gn_elements_have_left(const gn_solids *solids) {
    size_t count = 0;
    gn_free(gn_fem_places(gn_coupled_solid(solids), &count));
    return gn_elements_left_count(solids) < count;
}

int32_t *gn_element_places(const gn_step_context *ctx, const gn_solids *solids) {
    size_t count;
    return gn_converts(ctx) ? gn_fem_places(gn_coupled_solid(solids), &count) : NULL;
}

void gn_particle_travel(const gn_dem *dem, const gn_solids *solids, const int32_t *places, size_t p,
                        double u[3]) {
    const gn_particles *q = &dem->particles;
    gn_tie tie;
    gn_ties one;
    for (size_t a = 0; a < 3; a++) u[a] = q->pos[4 * p + a] - q->start[4 * p + a];
    if (!gn_is_dormant(dem, p)) return;
    u[0] = u[1] = u[2] = NAN; /* without memory */
    if (find_dormant(dem, solids, places, p, &tie, &one))
        gn_tie_travel(&one, 0, &gn_coupled_solid(solids)->nodes, u);
}

void gn_particle_velocity(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                          size_t p, double v[3]) {
    gn_tie tie;
    gn_ties one;
    memcpy(v, dem->particles.vel + 4 * p, 3 * sizeof *v);
    if (gn_is_dormant(dem, p) && find_dormant(dem, solids, places, p, &tie, &one))
        gn_tie_mean(&one, 0, gn_coupled_solid(solids)->nodes.vel, v);
}
