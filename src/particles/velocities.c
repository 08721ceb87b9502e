/* Velocities that are set from outside, between two steps. */
#include "particles/velocities.h"

#include "base/vec3.h"
#include "frame/frame.h"
#include "particles/motion.h"
#include "particles/particles.h"
#include "soa/particle_state.h"

#include <math.h>

static bool is_prescribed(const gn_dem *dem, size_t p, int component) {
    const int32_t slot = dem->particles.slot ? dem->particles.slot[p] : -1;
    return slot >= 0 && dem->prescribed.mask[slot] >> component & 1;
}

/* Writes a row of velocities or spins. Returns the growth of its kinetic energy, J. */
static double set_row(const gn_dem *dem, size_t p, int first, int axes, const double value[3],
                      double *row, float *single) {
    const double before = gn_dot3(row, row);
    for (int a = first == 3 && axes == 2 ? 2 : 0; a < (first == 3 ? 3 : axes); a++) {
        if (is_prescribed(dem, p, first + a)) continue;
        row[a] = value[a];
        if (single) single[a] = (float)value[a];
    }
    return 0.5 * (gn_dot3(row, row) - before) / row[3];
}

double gn_dem_set_velocities(const gn_step_context *ctx, gn_dem *dem, const double *velocity,
                             const double *spin) {
    const gn_particles *q = &dem->particles;
    const int axes = (int)ctx->scene.dimension;
    double gained = 0.0, most = dem->done.motion.speed2;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_particle_is_active(q, p)) continue;
        gained += set_row(dem, p, 0, axes, velocity + 3 * p, q->vel + 4 * p,
                          q->vel_f ? q->vel_f + 4 * p : NULL);
        if (spin && q->spin && q->spin[4 * p + 3] > 0.0)
            gained += set_row(dem, p, 3, axes, spin + 3 * p, q->spin + 4 * p,
                              q->spin_f ? q->spin_f + 4 * p : NULL);
        most = fmax(most, gn_dot3(q->vel + 4 * p, q->vel + 4 * p));
    }
    dem->done.motion.speed2 = most;
    gn_dem_forget_speed(ctx, dem);
    return gained;
}
