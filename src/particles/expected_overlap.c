#include "particles/expected_overlap.h"

#include "base/vec3.h"
#include "frame/frame.h"
#include "kernels/law.h"
#include "particles/particles.h"

#include <math.h>

/* Returns the energy per mass, J/kg, that gravity and applied forces add until the next lists. */
static double fall(const gn_step_context *ctx, const gn_dem *dem) {
    const double *g = ctx->scene.gravity;
    double pull = ctx->effects & GN_FX_GRAVITY ? sqrt(gn_dot3(g, g)) : 0.0;
    return (pull + ctx->choice.push) * dem->verlet.skin;
}

double gn_sudden_pull(int cohesion, double adhesion, double radius) {
    if (cohesion != GN_COHESION_DMT && cohesion != GN_COHESION_LIQUID) return 0.0;
    return gn_cohesion_most(cohesion, adhesion, radius);
}

/* The energy of the contact is 4/15 kn u^(5/2), and the attraction does the work A u: the overlap
 * is at most the sum of those by the energy alone and by the attraction alone, (15/4 A/kn)^(2/3).
 */
double gn_expected_overlap(const gn_step_context *ctx, const gn_dem *dem, double kn, double pull,
                           double inverse_mass, double speed2, double radius, double known) {
    if (!(inverse_mass > 0.0)) return known;
    if (ctx->choice.gain > 0.0)
        speed2 = (sqrt(speed2) + ctx->choice.gain) * (sqrt(speed2) + ctx->choice.gain);
    double energy = (0.5 * speed2 + fall(ctx, dem)) / inverse_mass, u = known * radius;
    if (pull > 0.0)
        return fmax(known, (pow(3.75 * energy / kn, 0.4) + cbrt(14.0625 * pull / kn * pull / kn)) /
                               radius);
    if (energy <= 4.0 / 15.0 * kn * u * u * sqrt(u)) return known;
    return pow(3.75 * energy / kn, 0.4) / radius;
}

double gn_pair_radius(const gn_particles *particles, size_t i, size_t j) {
    double ri = particles->pos[4 * i + 3], rj = particles->pos[4 * j + 3];
    return ri * rj / (ri + rj);
}

double gn_relative_speed2(const double *a, const double *b) {
    double v[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return gn_dot3(v, v);
}

double gn_pressed_meeting(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                          double kn, double pull) {
    const gn_particles *q = &dem->particles;
    const double *vi = q->vel + 4 * i, *vj = q->vel + 4 * j;
    double radius = gn_pair_radius(q, i, j),
           known = fmax(fmax(q->pressed[i], q->pressed[j]), GN_OVERLAP_LEAST);
    return radius * gn_expected_overlap(ctx, dem, kn, pull, vi[3] + vj[3],
                                        gn_relative_speed2(vi, vj), radius, known);
}

double gn_pressed_touch(const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    return q->pos[4 * p + 3] * fmax(q->pressed[p], GN_OVERLAP_LEAST);
}
