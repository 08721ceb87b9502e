#include "drive/servo.h"

#include "base/vec3.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <math.h>

static void add_list(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                     bool all, size_t count, const double (*n)[3], double *spring,
                     double *dashpot) {
    const gn_particles *q = &dem->particles;
    const gn_law *law = gn_law_of(list->soa.effects);
    for (size_t c = 0; c < list->soa.count; c++) {
        const double *x = q->pos + 4 * (size_t)list->i[c], *y = q->pos + 4 * (size_t)list->j[c];
        double l[3], length = sqrt(gn_branch(ctx, x, y, l));
        double rest = list->length0 ? list->length0[c] : x[3] + y[3];
        if (!all && length >= rest && !gn_contact_bonded(list, c)) continue;
        double overlap = fmax(rest - length, 0.0) + (all ? dem->verlet.skin : 0.0);
        gn_law_spring k = law->spring(list, c, overlap);
        for (size_t a = 0; a < count; a++) {
            double along = gn_dot3(l, n[a]);
            spring[a] += (k.kn + k.kt) * along * along;
            dashpot[a] += k.cn * along * along;
        }
    }
}

void gn_servo_answers(const gn_step_context *ctx, const gn_dem *dem, bool all, size_t count,
                      const double (*n)[3], double *spring, double *dashpot) {
    for (size_t a = 0; a < count; a++) spring[a] = dashpot[a] = 0.0;
    for (int l = 0; l < GN_LIST_COUNT; l++)
        add_list(ctx, dem, &dem->list[l].contacts, all, count, n, spring, dashpot);
}

double gn_servo_answer(double share, double uniform) {
    const double of_uniform = 0.25;
    return of_uniform * share * fmin(1.0, uniform);
}

/* Returns the smaller of two values of one sign, 0 if the signs differ. */
static double common(double x, double y) {
    return x > 0.0 ? fmax(0.0, fmin(x, y)) : fmin(0.0, fmax(x, y));
}

double gn_servo_speed(gn_servo_state *s, const gn_servo_look *look) {
    double speed = s->base + look->pace * (look->wanted - look->found);
    if (fabs(speed) > look->most) {
        s->expected = look->found;
        return copysign(look->most, speed);
    }
    const double droop = common(s->expected - look->found, look->wanted - look->found);
    s->base += 0.5 * look->answer * look->pace * droop;
    s->expected += look->answer * (look->wanted - s->expected);
    return speed;
}

/* Returns the largest stable share. The wall moves by rho (F* - F)/K, with K = sum k + c/dt. The
 * force F responds with sum g (w - x), g(z) = k + c (1 - 1/z)/dt, the displacements x with M (z - 2
 * + 1/z)/dt^2 x = forces. Eliminating w leaves the equations of the particles at a wall at rest,
 * except that the springs at the wall are in series with a dashpot, the servo: their part G = sum g
 * along (g) becomes G (z - 1)/(z - 1 + rho G/K). On the unit circle the imaginary part of this has
 * one sign, so that nothing crosses the circle except at z = -1. There the part is 1/(1 - r/2)
 * times that of a wall at rest, with r = rho (sum k + 2 c/dt)/K. The stiffness times that factor
 * must stay below 4 M/dt^2. With a wall at rest it may be at most 4 M/limit^2, of which dashpots
 * take 2 c/dt. With s = dt/limit this requires r <= 2 (1 - s^2), with dashpots r <= 2 (1 - s). The
 * number of particles does not matter, because the bound assumes that all of the fastest mode is at
 * the wall. r = 1 makes up all that is missing in one step; more is never useful. Where the step is
 * at its limit, a little of the share must remain to move the wall. */
double gn_servo_share(const gn_step_context *ctx, const gn_dem *dem) {
    double share = fmin(1.0, ctx->dt / ctx->stable);
    bool dashpots = dem->damping_fraction > 0.0;
    return fmax(0.01, fmin(1.0, 2.0 * (1.0 - (dashpots ? share : share * share))));
}
