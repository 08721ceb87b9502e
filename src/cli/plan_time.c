#include "cli/plan_time.h"

#include "base/timer.h"

#include <math.h>

gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error) {
    enum { WARM_UP = 20, PACED = 192 };
    double start = gn_now();
    int steps = 0;
    for (bool warm = false; !warm || gn_now() - start < 0.25;) {
        if (!warm && (steps == PACED || (steps >= WARM_UP && gn_now() - start > 1.0))) {
            warm = true;
            start = gn_now();
            steps = 0;
        }
        if (steps > 0 && world->ctx.time >= until) break;
        /* Failure in a later step is left to the run. */
        gneiss_status status = gn_world_step(world, false, error);
        if (status == GNEISS_ERROR_UNSTABLE && steps > 0) break;
        GN_TRY(status);
        steps++;
    }
    *seconds = (gn_now() - start) / steps;
    return GNEISS_OK;
}

gneiss_status gn_time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error) {
    const double work = 2e7; /* element and particle steps */
    const double size =
        (double)(world->dem.particles.soa.count + gn_elements_totals(&world->solids).elements);
    const int most = (int)fmin(fmax(work / fmax(size, 1.0), 20.0), 400.0);
    double start = gn_now();
    int steps = -most / 4; /* warm-up */
    for (; steps < most; steps++) {
        if (steps == 0) start = gn_now();
        gneiss_status status = gn_world_step(world, false, error);
        if (status == GNEISS_ERROR_UNSTABLE) break;
        GN_TRY(status);
    }
    *seconds = steps > 0 ? (gn_now() - start) / steps : 0.0;
    return GNEISS_OK;
}
