#include "frame/step_change.h"

#include "base/memory.h"
#include "frame/frame.h"

#include <string.h>

/* Copies rows before a step whose length differs from the last one. If memory is lacking, the
 * change of energy appears in the residual. */
double *gn_rows_copy(const gn_particles *of, const double *rows) {
    const size_t count = of->soa.count;
    double *copy = rows ? gn_alloc_array(count, 4 * sizeof *copy) : NULL;
    if (copy) memcpy(copy, rows, count * 4 * sizeof *copy);
    return copy;
}

/* Leap-frog conserves 1/2 m v(-) v(+) plus the energy of springs, which depends on the step. The
 * kick is (dt- + dt+)/2 F/m, but the booked works are 1/2 F dt- v(-) and 1/2 F dt+ v(+). The change
 * is booked in two halves, -+ (dt- - dt+)/(2 (dt- + dt+)) m v(-+).(v(+) - v(-)), whose sum is F^2
 * (dt-^2 - dt+^2)/(8 m): an oscillation gains energy if the step becomes shorter. */
void gn_rows_add_step_change(const gn_step_context *ctx, const double *past, const double *now,
                             size_t count, double halves[2]) {
    const double factor = 0.5 * (ctx->dt_past - ctx->dt) / (ctx->dt_past + ctx->dt);
    for (size_t p = 0; past && p < count; p++) {
        const double *a = past + 4 * p, *b = now + 4 * p;
        if (!(b[3] > 0.0)) continue;
        for (int k = 0; k < 3; k++) {
            double change = factor / b[3] * (b[k] - a[k]);
            halves[GN_HALF_BEFORE] -= change * a[k];
            halves[GN_HALF_AFTER] += change * b[k];
        }
    }
}
