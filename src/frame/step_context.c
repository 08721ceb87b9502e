#include "frame/frame.h"

#include "base/point.h"
#include "scene/laboratory.h"
#include "scene/scene.h"

#include <math.h>
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

void gn_user_point(const gn_step_context *ctx, const double point[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = gn_point_out(ctx->scene.origin[a], point[a]);
}

double gn_finest_reach(double radius) {
    return ldexp(1.0, ilogb(GN_COARSE * radius) + 53);
}

/* Non-viscous damping of coefficient a multiplies the resultant by 1 + a while it decelerates a
 * particle and by 1 - a while it accelerates it. In the fastest mode, whose displacement changes
 * sign from step to step, the resultant always decelerates: the effective stiffness is 1 + a times
 * the undamped one, and the limit decreases by the factor 1/sqrt(1 + a). Dashpot forces are part of
 * the resultant; with K and C both multiplied by 1 + a, the limit is that of K and sqrt(1 + a) C,
 * divided by sqrt(1 + a). (Measured: at 0.9 of the undamped limit and a = 0.7 the kinetic energy
 * 1/2 m v(-) v(+) becomes negative, and bonds break before any load.) */
static double scene_nonviscous_share(const gn_scene *s, gn_effects effects) {
    bool active = effects & (GN_FX_NONVISCOUS_VECTOR | GN_FX_NONVISCOUS_COMPONENT);
    double spin = effects & GN_FX_ROTATION ? gn_scene_spin_damping(s) : 0.0;
    return active ? 1.0 / sqrt(1.0 + fmax(s->background_coefficient, spin)) : 1.0;
}

double gn_nonviscous_share(const gn_step_context *ctx) {
    return scene_nonviscous_share(&ctx->scene, ctx->effects);
}

/* Largest number of steps. The fastest scene takes a microsecond a step, so that these are thirty
 * years. */
static const double steps_most = 1e15;

gneiss_status gn_check_duration(const gn_step_context *ctx, gneiss_error *error) {
    double steps = (ctx->scene.end - ctx->time) / ctx->dt;
    if (steps <= steps_most) return GNEISS_OK;
    return gn_fail(
        error, GNEISS_ERROR_INPUT,
        "%s: expected an end within %.0g steps, found %.3g steps of %.4g s "
        "to t = %.4g s: no run comes to its end (time.end, time.safety, time.contact_steps, "
        "time.step)",
        gn_scene_at(&ctx->scene, ctx->scene.time_where, "time").text, steps_most, steps, ctx->dt,
        ctx->scene.end);
}
