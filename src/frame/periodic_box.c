#include "frame/periodic_box.h"

#include "base/error.h"
#include "frame/frame.h"
#include "scene/laboratory.h"
#include "scene/scene.h"

#include <math.h>

bool gn_box_moved(const gn_periodic_box *box) {
    for (int a = 0; a < 3; a++)
        if (box->flow[a] != 0.0) return true;
    return false;
}

bool gn_box_moves(const gn_step_context *ctx, const gn_periodic_box *box) {
    return ctx->effects & GN_FX_PERIODIC && (gn_scene_box_moves(&ctx->scene) || gn_box_moved(box));
}

double gn_box_strain(const gn_step_context *ctx, const gn_periodic_box *box, int axis) {
    double start = box->start[axis];
    return start > 0.0 ? ctx->period[axis] / start - 1.0 : 0.0;
}

double gn_box_section(const gn_step_context *ctx) {
    double area = 1.0;
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        if (gn_scene_periodic_along(&ctx->scene, a)) area *= ctx->period[a];
    return area;
}

double gn_box_speed(const gn_periodic_box *box) {
    double most = 0.0;
    for (int a = 0; a < 3; a++) most = fmax(most, fabs(box->flow[a]));
    return most * box->reach;
}

gneiss_status gn_box_narrowed(const gn_step_context *ctx, const gn_periodic_box *box,
                              gneiss_status found, gneiss_error *error) {
    char was[GNEISS_MESSAGE_SIZE];
    int least = -1;
    if (found != GNEISS_ERROR_INPUT || ctx->step == 0 || !gn_box_moved(box)) return found;
    for (int a = 0; a < (int)ctx->scene.dimension; a++)
        if (ctx->period[a] > 0.0 && (least < 0 || ctx->period[a] < ctx->period[least])) least = a;
    if (least < 0) return found;
    const bool servo = ctx->scene.box[least].stress.count > 0;
    snprintf(was, sizeof was, "%s", error->message);
    return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                   "step %lld, t = %g s: %s of side '%c' has shrunk the box to %.3g of its length "
                   "(%s)%s",
                   (long long)ctx->step, ctx->time, servo ? "the servo" : "the rate", "xyz"[least],
                   1.0 + gn_box_strain(ctx, box, least), was,
                   servo ? ": the particles in the box do not carry the stress" : "");
}
