/* Rolling and twisting resistance (law_rolling.h) with the linear law and that of Hertz, outside of
 * the kernels. For two materials the smaller coefficient is used, as for friction. */
#include "base/vec3.h"
#include "kernels/combine.h"
#include "kernels/law_scalar.h"

#include "kernels/hertz.h"

/* --- parameters --- */

void gn_rolling_set(const gn_law_pair *pair, gn_contacts *list, size_t c) {
    double radius = pair->ri * pair->rj / (pair->ri + pair->rj);
    double rolling = GN_OWN(pair, rolling_friction,
                            gn_smaller(pair->a->rolling_friction, pair->b->rolling_friction));
    double twisting = GN_OWN(pair, twisting_friction,
                             gn_smaller(pair->a->twisting_friction, pair->b->twisting_friction));
    list->reduced[c] = radius;
    list->rolling[c] = rolling * radius;
    list->twisting[c] = twisting * radius;
}

static void set_linear(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                       size_t c) {
    gn_linear_set(model, pair, list, c);
    gn_rolling_set(pair, list, c);
}

static void set_hertz(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                      size_t c) {
    gn_hertz_set(model, pair, list, c);
    gn_rolling_set(pair, list, c);
}

/* --- forces and energy of a contact --- */

/* Returns the moments with the stiffness kr; for the limit of the step it is that of a contact at
 * its largest overlap. */
static gn_law_moments moments_of(const gn_contacts *list, size_t c, double kr, double most) {
    gn_law_moments m = {.bend = most, .twist = most};
    double size2 = 0.0;
    for (size_t a = 0; a < 3; a++) {
        size_t at = c + a * list->soa.capacity;
        m.couple[a] = gn_column_value(list->roll, list->roll_f, at);
        size2 += m.couple[a] * m.couple[a];
    }
    if (size2 > 0.0) m.stored = 0.5 * size2 / kr;
    if (!(list->rolling[c] > 0.0)) m.bend = 0.0;
    if (!(list->twisting[c] > 0.0)) m.twist = 0.0;
    return m;
}

static gn_law_moments linear_moments(const gn_contacts *list, size_t c, const double n[3]) {
    (void)n;
    double kr = list->kt[c] * list->reduced[c] * list->reduced[c];
    return moments_of(list, c, kr, kr);
}

gn_law_moments gn_hertz_moments(const gn_contacts *list, size_t c, const double n[3]) {
    (void)n;
    double kr = list->kt[c] * list->reduced[c] * list->reduced[c];
    double closeness = gn_column_value(list->closeness, list->closeness_f, c);
    return moments_of(list, c, closeness > 0.0 ? kr / closeness : kr, kr * sqrt(list->most[c]));
}

/* --- walls and surfaces --- */

/* The counterpart of roll_grip for one contact. */
typedef struct grip {
    double kt, root, past, now;
} grip;

/* Returns a moment after a further rotation `way`; its magnitude is limited to `limit`. */
static gn_v3 turn_on(gn_v3 before, gn_v3 way, double kr, double limit, const grip *hold,
                     gn_contact_sums *sums) {
    gn_v3 m =
        gn_axpy(gn_hertz_rescaled(before, hold->past, hold->root, 1), kr * hold->root, way, 1);
    double size2 = gn_dot(m, m, 1);
    if (limit * limit < size2) m = gn_linear_slip(m, size2, limit, true, 1);
    sums->rolling += gn_hertz_lost(before, m, way, hold->past, hold->now, kr, 1);
    if (kr > 0.0) sums->elastic_normal += 0.5 * gn_dot(m, m, 1) * hold->now / kr;
    return m;
}

static void touch_roll(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                       double pressed, const grip *hold, gn_contact_sums *sums) {
    double kr = hold->kt * side->radius * side->radius, *roll = touch->roll;
    size_t stride = touch->roll_stride;
    gn_v3 n = gn_v3_of(touch->n), old = {roll[0], roll[stride], roll[2 * stride]};
    gn_v3 spin = gn_v3_of(touch->spin), bend = spin, twist = {0.0, 0.0, 0.0};
    gn_v3 bent = old, twisted = twist;
    if (step->space) {
        twist = gn_scale(gn_dot(spin, n, 1), n, 1);
        bend = gn_sub(spin, twist, 1);
        twisted = gn_scale(gn_dot(old, n, 1), n, 1);
        bent = gn_turn_about_normal(gn_sub(old, twisted, 1), n, 0.5 * step->dt * touch->twist);
    }
    bent = turn_on(bent, gn_scale(step->dt, bend, 1), kr, side->rolling * side->radius * pressed,
                   hold, sums);
    if (step->space)
        twisted = turn_on(twisted, gn_scale(step->dt, twist, 1), kr,
                          side->twisting * side->radius * pressed, hold, sums);
    gn_v3 m = gn_add(bent, twisted, 1);
    touch->couple[0] = roll[0] = m.x;
    touch->couple[1] = roll[stride] = m.y;
    touch->couple[2] = roll[2 * stride] = m.z;
}

static double pressing(const gn_touch *touch, double total) {
    return touch->gap < -touch->rounding ? fmax(-total, 0.0) : 0.0;
}

static double touch_linear(const gn_touch_step *step, const gn_touch_side *side,
                           const gn_touch *touch, double *fd, double *shear, size_t stride,
                           double t[3], gn_contact_sums *sums) {
    double total = gn_linear_touch(step, side, touch, fd, shear, stride, t, sums);
    grip g = {side->kratio > 0.0 ? side->stiffness / side->kratio : 0.0, 1.0, 1.0, 1.0};
    if (touch->roll && step->spins) touch_roll(step, side, touch, pressing(touch, total), &g, sums);
    return total;
}

void gn_hertz_touch_roll(const gn_touch_step *step, const gn_touch_side *side,
                         const gn_touch *touch, double pressed, double root, double past,
                         gn_contact_sums *sums) {
    grip g = {8.0 * side->hertz.shear_modulus * sqrt(side->radius), root, past,
              root > 0.0 ? 1.0 / root : 0.0};
    if (touch->closeness) *touch->closeness = g.now; /* also needed without friction */
    if (touch->roll && step->spins) touch_roll(step, side, touch, pressed, &g, sums);
}

static double touch_hertz(const gn_touch_step *step, const gn_touch_side *side,
                          const gn_touch *touch, double *fd, double *shear, size_t stride,
                          double t[3], gn_contact_sums *sums) {
    double past = touch->closeness ? *touch->closeness : 0.0;
    double total = gn_hertz_touch(step, side, touch, fd, shear, stride, t, sums);
    double root = touch->gap < -touch->rounding ? sqrt(-touch->gap) : 0.0;
    gn_hertz_touch_roll(step, side, touch, pressing(touch, total), root, past, sums);
    return total;
}

const gn_law gn_law_rolling = {GN_LINEAR_SPRINGS,
                               .set = set_linear,
                               .held = gn_linear_held,
                               .release = gn_linear_release,
                               .criterion = gn_linear_criterion,
                               .touch = touch_linear,
                               .moments = linear_moments};
const gn_law gn_law_hertz_rolling = {GN_HERTZ_FUNCTIONS, .set = set_hertz, .touch = touch_hertz,
                                     .moments = gn_hertz_moments};
