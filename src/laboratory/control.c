#include "laboratory/control.h"

#include "conversion/conversion.h"
#include "frame/step_context.h"
#include "laboratory/ends.h"
#include "measure/measure.h"
#include "scene/laboratory.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* Steps from one look to the next. */
enum { LOOK_INTERVAL = 10 };

/* Extension across the axis positive. */
static double lateral_strain(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             const gn_gauge *gauge) {
    double gradient[9], g[9], sum = 0.0;
    int dimension = (int)ctx->scene.dimension;
    gn_conversion_gradient(ctx, dem, solids, gauge, gradient);
    gn_strain_of(gradient, g);
    for (int a = 0; a < dimension; a++)
        if (a != (int)ctx->scene.test.axis) sum += g[4 * a];
    return sum / (dimension - 1);
}

static double reading(const gn_world *w) {
    return w->ctx.scene.test.control.opening > 0.0
               ? gn_ends_opening(w)
               : lateral_strain(&w->ctx, &w->dem, &w->solids, &w->gauge);
}

static double rate(const gn_control *c) {
    return c->opening > 0.0 ? c->opening : c->lateral_strain;
}

/* At full speed at the start: both readings begin at 0. */
void gn_control_create(gn_step_context *ctx) {
    const gn_control *c = &ctx->scene.test.control;
    ctx->machine = (gn_machine){.wanted = rate(c) * c->response, .factor = 1.0};
}

/* What is wanted grows at the rate, but is never ahead by more than the motion makes up at full
 * speed: a reading that lags behind while all is elastic finds no backlog to jump to when it lets
 * go. The factor is the distance over that, so it is 1 as long as the reading lags, falls as it
 * comes near, and is bounded both ways whatever the reading does. */
void gn_control_look(gn_world *w) {
    const gn_control *c = &w->ctx.scene.test.control;
    gn_machine *m = &w->ctx.machine;
    if (!w->ctx.scene.test.has_control || w->ctx.step % LOOK_INTERVAL != 0) return;
    const double now = reading(w), most = rate(c) * c->response;
    if (isnan(now)) return; /* too little is left of the specimen to be read */
    m->wanted = fmin(m->wanted + rate(c) * (w->ctx.time - m->looked), now + most);
    m->looked = w->ctx.time;
    m->factor = fmax(-c->reverse, fmin(1.0, (m->wanted - now) / most));
}
