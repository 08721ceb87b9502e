/* What is read of particles that sleep: they are where the elements have the body. */
#include "base/memory.h"
#include "sim/conversion.h"
#include "sim/coupling_internal.h"

#include <math.h>

int32_t *gn_conversion_places(const gn_world *w) {
    size_t count;
    return gn_converts(w) ? gn_fem_places(gn_coupled_solid(w), &count) : NULL;
}

void gn_conversion_travel(const gn_world *w, const int32_t *places, size_t p, double u[3]) {
    const gn_particles *q = &w->dem.particles;
    for (size_t a = 0; a < 3; a++) u[a] = q->pos[4 * p + a] - q->start[4 * p + a];
    if (!gn_is_asleep(w, p)) return;
    u[0] = u[1] = u[2] = NAN; /* no memory */
    if (!places) return;
    const gn_fem_solid *b = gn_coupled_solid(w);
    gn_tie tie = gn_tie_at(b, places[gn_home_id(w, p)], q->start + 4 * p);
    const gn_ties one = {.corners = b->dimension + 1, .count = 1, .tie = &tie};
    gn_tie_travel(&one, 0, &b->nodes, u);
}

void gn_conversion_gradient(const gn_world *w, double gradient[9]) {
    gn_strain_gauge_read(&w->gauge, &w->dem.particles, w->dem.index_of_id, gradient);
    int32_t *places = gn_conversion_places(w);
    for (size_t k = 0; gn_converts(w) && k < w->gauge.count; k++) {
        const int32_t p = w->dem.index_of_id[w->gauge.id[k]];
        double u[3];
        if (p < 0 || !gn_is_asleep(w, (size_t)p)) continue;
        gn_conversion_travel(w, places, (size_t)p, u);
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++) gradient[3 * a + c] += u[a] * w->gauge.weight[3 * k + c];
    }
    gn_free(places);
}
