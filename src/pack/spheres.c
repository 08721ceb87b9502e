#include "pack/spheres.h"

#include <string.h>

gneiss_status gn_particles_of_spheres(const double *row, size_t count, gn_particles *particles,
                                      gneiss_error *error) {
    *particles = (gn_particles){0};
    GN_TRY(gn_soa_create(&gn_particle_record, particles, count, 0, error));
    memcpy(particles->pos, row, count * 4 * sizeof *row);
    for (size_t k = 0; k < count; k++) {
        particles->id[k] = (int32_t)k;
        particles->vel[4 * k + 3] = 1.0;
    }
    return GNEISS_OK;
}
