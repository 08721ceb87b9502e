/* Columns of the history that finite elements add. */
#include "run/record_parts.h"

#include <string.h>

/* Particles have the columns strain_.. and stress_.. when both are there. */
static bool beside_particles(const gn_world *w) {
    return w->scene.has_specimen;
}

gneiss_status gn_elements_add_columns(const gn_world *w, gn_history *h, gneiss_error *error) {
    if (!w->elements) return GNEISS_OK;
    if (beside_particles(w)) {
        GN_TRY(gn_record_add_tensor(w, h, "elements_strain", "1",
                                    "average strain of the finite elements, tension positive",
                                    error));
        GN_TRY(gn_record_add_tensor(w, h, "elements_stress", "Pa",
                                    "average stress of the finite elements, tension positive",
                                    error));
    }
    for (size_t k = 0; k < w->scene.elements.motion_count; k++) {
        const char *name = w->scene.elements.motions[k].name;
        GN_TRY(gn_record_add_vector(w, h, "motion", name, "displacement", "m",
                                    "mean displacement of the nodes", error));
        if (w->elements->motion[k] < 0) continue;
        GN_TRY(gn_record_add_vector(w, h, "motion", name, "reaction", "N",
                                    "force that the prescribed motion supplies to the nodes",
                                    error));
    }
    return GNEISS_OK;
}

enum { GRADIENT = 9 };

size_t gn_elements_before_size(const gn_world *w) {
    return w->elements ? GRADIENT + 3 * w->scene.elements.motion_count : 0;
}

void gn_elements_read_before(const gn_world *w, double *before) {
    if (!w->elements) return;
    gn_fem_mean_gradient(&w->elements->body, (const double(*)[3])w->elements->weight, before);
    for (size_t k = 0; k < w->scene.elements.motion_count; k++)
        gn_elements_travel(w, k, before + GRADIENT + 3 * k);
}

static double *put_vector(const gn_world *w, double *row, const double v[3]) {
    for (int64_t a = 0; a < w->scene.dimension; a++) *row++ = v[a];
    return row;
}

double *gn_elements_put(const gn_world *w, const double *before, double *row) {
    if (!w->elements) return row;
    if (beside_particles(w)) {
        row = gn_record_put_tensor(w, row, before);
        row = gn_record_put_tensor(w, row, w->elements->stress);
    }
    for (size_t k = 0; k < w->scene.elements.motion_count; k++) {
        double force[3];
        row = put_vector(w, row, before + GRADIENT + 3 * k);
        if (w->elements->motion[k] < 0) continue;
        gn_elements_reaction(w, k, force);
        row = put_vector(w, row, force);
    }
    return row;
}
