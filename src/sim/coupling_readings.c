/* What is read off zones as the run goes on. */
#include "base/memory.h"
#include "sim/coupling_internal.h"

/* Contacts of a particle of a zone carry its part of the body's stress, elements the other part. In
 * the plane elements have a stress across it, which contacts have not. */
gneiss_status gn_coupled_add_stress(const gn_world *w, double *sigma, gneiss_error *error) {
    const gn_coupled *q = w->scene.has_couple ? w->exchange[0].context : NULL;
    if (!q) return GNEISS_OK;
    const gn_fem_solid *b = gn_coupled_solid(w);
    const bool space = b->dimension == 3;
    double(*stress)[6] = gn_alloc_array(b->elements.soa.count + 1, sizeof *stress);
    if (!stress)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stress of %zu elements",
                       b->elements.soa.count);
    gn_fem_element_stress(b, stress);
    for (size_t k = 0; k < q->ties.count; k++) {
        if (q->place[k] < 0) continue;
        const size_t p = (size_t)q->place[k];
        const double share = 1.0 - w->dem.particles.blend[2 * p];
        for (int c = 0; c < 6; c++)
            if (space || c < 2 || c == 3)
                sigma[6 * p + (size_t)c] += share * stress[q->ties.tie[k].element][c];
    }
    gn_free(stress);
    return GNEISS_OK;
}

size_t gn_coupled_lost(const gn_world *w) {
    const gn_coupled *q = w->scene.has_couple ? w->exchange[0].context : NULL;
    size_t count = 0;
    for (size_t k = 0; q && k < q->ties.count; k++) count += q->place[k] < 0;
    return count;
}
