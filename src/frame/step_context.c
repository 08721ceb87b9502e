#include "frame/step_context.h"

#include "base/point.h"
#include "scene/laboratory.h"
#include "scene/scene.h"

#include <string.h>

static bool in(const gn_test_end *end, const char *name) {
    for (size_t k = 0; k < end->count; k++)
        if (strcmp(end->name[k], name) == 0) return true;
    return false;
}

double gn_control_of(const gn_step_context *ctx, const char *name, int axis) {
    const gn_test *t = &ctx->scene.test;
    if (!t->has_control || axis != (int)t->axis) return 1.0;
    return in(&t->lower, name) || in(&t->upper, name) ? ctx->machine.factor : 1.0;
}

void gn_world_point_out(const gn_step_context *ctx, const double point[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = gn_point_out(ctx->scene.origin[a], point[a]);
}

double gn_finest_reach(double radius) {
    return ldexp(1.0, ilogb(GN_COARSE * radius) + 53);
}
