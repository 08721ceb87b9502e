/* Attraction of unbonded spheres (law_cohesive.h) outside of the kernels. The work of adhesion of
 * two materials is the geometric mean, E* that of Hertz's law. */
#include "kernels/combine.h"
#include "kernels/law_scalar.h"

#include "kernels/cohesion.h"

double gn_cohesion_most(int cohesion, double adhesion, double radius) {
    static const double factor[] = {[GN_COHESION_NONE] = 0.0,
                                    [GN_COHESION_JKR] = 1.5,
                                    [GN_COHESION_DMT] = 2.0,
                                    [GN_COHESION_LIQUID] = 4.0};
    return factor[cohesion] * M_PI * adhesion * radius;
}

double gn_cohesion_span(int cohesion, double adhesion, double modulus, double radius) {
    if (cohesion == GN_COHESION_LIQUID) return -2.0 * radius;
    if (cohesion != GN_COHESION_JKR) return 0.0;
    double a = cbrt(M_PI * adhesion * radius * radius / (8.0 * modulus));
    return 3.0 * a * a / radius;
}

/* --- parameters --- */

static double span_of(const gn_hertz_pair *pair, double radius) {
    return gn_cohesion_span(pair->cohesion, pair->adhesion, pair->modulus, radius);
}

static double reduced_of(const gn_law_pair *pair) {
    return pair->ri * pair->rj / (pair->ri + pair->rj);
}

static void set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    const gn_hertz_pair p = gn_hertz_pair_of(model->scene, pair->a, pair->b, pair->own);
    const double radius = reduced_of(pair);
    gn_hertz_set(model, pair, list, c);
    list->adhesion[c] = gn_cohesion_most(p.cohesion, p.adhesion, radius);
    list->span[c] = span_of(&p, radius);
}

static void set_rolling(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                        size_t c) {
    set(model, pair, list, c);
    gn_rolling_set(pair, list, c);
}

static void release(gn_contacts *list, size_t c) {
    gn_linear_release(list, c);
    list->adhesion[c] = list->span[c] = list->bridge[c] = list->onset[c] = 0.0;
}

/* --- springs --- */

/* Returns the factor on the stiffness of Hertz's law at an overlap, by which the circle of a JKR
 * contact is wider. Its normal stiffness is S_n (s^3 - 3)/(s^3 - 1), which is less. In tension it
 * decreases to 0 at the largest attraction; beyond that the force falls as the contact opens, which
 * does not limit the step. */
static double wider(double span, double overlap) {
    if (!(span > 0.0) || !(overlap > 0.0)) return 1.0;
    return gn_jkr_width(gn_jkr_root(overlap, span), span) / sqrt(overlap);
}

static gn_law_spring widened(gn_law_spring spring, double span, double overlap) {
    const double factor = wider(span, overlap);
    return (gn_law_spring){factor * spring.kn, factor * spring.kt, spring.cn};
}

static gn_law_spring meeting(const gn_law_model *model, const gn_law_pair *pair, double overlap) {
    const gn_hertz_pair p = gn_hertz_pair_of(model->scene, pair->a, pair->b, pair->own);
    return widened(gn_hertz_meeting(model, pair, overlap), span_of(&p, reduced_of(pair)), overlap);
}

static gn_law_spring spring(const gn_contacts *list, size_t c, double overlap) {
    const double most = list->most[c];
    return widened(gn_hertz_spring(list, c, overlap), list->span[c], most > 0.0 ? most : overlap);
}

static gn_law_spring touch_spring(const gn_touch_side *side, double inverse_mass,
                                  double damping_fraction, double overlap) {
    return widened(gn_hertz_touch_spring(side, inverse_mass, damping_fraction, overlap),
                   span_of(&side->hertz, side->radius), overlap);
}

/* --- forces and energy of a contact --- */

/* Without the energy of a bridge, which depends on the contact angle. */
static gn_law_held held(const gn_contacts *list, size_t c, double length, double stretch) {
    const double most = list->adhesion[c], span = list->span[c], bridge = list->bridge[c];
    gn_law_held h = gn_hertz_held(list, c, length, stretch);
    if (!(bridge > 0.0)) return h;
    if (span > 0.0) {
        const double s = gn_jkr_root(-stretch, span), shear = h.stored,
                     width = gn_jkr_width(s, span);
        const double open = stretch < 0.0 ? sqrt(-stretch) : 0.0;
        h.normal = most * gn_jkr_pull(s);
        h.stored = most * span * gn_jkr_stored(s);
        if (open > 0.0)
            h.stored +=
                (shear - gn_hertz_stored(-2.0 / 3.0 * list->kn[c] * open * -stretch, -stretch)) *
                open / width;
    } else if (span < 0.0) {
        h.normal += most * gn_bridge_pull(fmax(stretch, 0.0), -span, bridge);
    } else {
        h.normal += most;
        h.stored += most * fmin(stretch, 0.0);
    }
    return h;
}

/* Returns the attraction that presses the solids of a contact in addition to its force, N. */
static double beside_of(const gn_contacts *list, size_t c) {
    if (!(list->bridge[c] > 0.0)) return 0.0;
    return list->span[c] > 0.0 ? 2.0 * list->adhesion[c] : list->adhesion[c];
}

static bool slips(const gn_contacts *list, size_t c, double normal, double shear) {
    return gn_linear_slips(list, c, normal - beside_of(list, c), shear);
}

static gn_law_moments moments(const gn_contacts *list, size_t c, const double n[3]) {
    gn_law_moments m = gn_hertz_moments(list, c, n);
    const double factor = wider(list->span[c], list->most[c]);
    m.bend *= factor;
    m.twist *= factor;
    return m;
}

/* --- walls --- */

static double share_of(double beyond, double path) {
    const double way = fabs(path);
    return way > 0.0 ? fmin(fmax(beyond / way, 0.0), 1.0) : 0.5;
}

/* Sets the force of JKR or DMT. */
static void adhere(const gn_touch_side *side, const gn_touch *touch, double path,
                   gn_touch_press *press, gn_contact_sums *sums) {
    const double most = gn_cohesion_most(side->hertz.cohesion, side->hertz.adhesion, side->radius);
    const double span = span_of(&side->hertz, side->radius), held = most * span;
    const bool before = *touch->bridge > 0.0, jkr = span > 0.0;
    const bool acts = touch->gap < -touch->rounding || (before && touch->gap < span);
    const bool timed = path != 0.0;
    *touch->bridge = acts;
    if (!acts && !before) return;
    if (!acts) {
        press->normal = (jkr ? 5.0 / 9.0 : 1.0) * most * (0.5 - share_of(touch->gap - span, path));
        sums->cohesion += GN_JKR_SEPARATED * held;
        return;
    }
    press->beside = jkr ? 2.0 * most : most;
    if (jkr) {
        const double s = gn_jkr_root(-touch->gap, span);
        press->normal = most * gn_jkr_pull(s);
        press->stored = held * gn_jkr_stored(s);
        press->root = gn_jkr_width(s, span);
    } else {
        press->normal += most;
        press->stored += most * fmin(touch->gap, 0.0);
    }
    if (before || !timed) return;
    press->normal += (jkr ? 8.0 / 9.0 : 1.0) * most * (share_of(-touch->gap, path) - 0.5);
    sums->cohesion += GN_JKR_FORMED * held;
}

/* Sets the force of a bridge. A wall has no film of its own: the bridge takes half of the
 * particle's liquid (Shi and McCarthy 2008, for a sphere of infinite radius) and returns it. */
static void wet(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                double path, gn_touch_press *press, gn_contact_sums *sums) {
    const double most = gn_cohesion_most(side->hertz.cohesion, side->hertz.adhesion, side->radius);
    const double span = 2.0 * side->radius, gap = fmax(touch->gap, 0.0);
    double *volume = touch->bridge, late = 1.0;
    if (!(*volume > 0.0)) {
        if (!(touch->gap < -touch->rounding) || !(*touch->film > 0.0)) return;
        *volume = 0.5 * *touch->film;
        *touch->film -= *volume;
        if (path != 0.0) late = 0.5 + share_of(-touch->gap, path);
        if (step->dt > 0.0)
            sums->cohesion -= most * gn_bridge_energy(0.0, span, *volume, step->rupture);
    }
    if (gap * gap * gap > step->rupture * *volume) {
        press->normal += most * gn_bridge_tail(gap, path, span, *volume, step->rupture);
        *touch->film += *volume;
        *volume = 0.0;
        return;
    }
    press->beside = most * gn_bridge_pull(gap, span, *volume);
    press->normal += late * press->beside;
    press->stored += most * gn_bridge_energy(touch->gap, span, *volume, step->rupture);
}

static gn_touch_press press_of(const gn_touch_step *step, const gn_touch_side *side,
                               const gn_touch *touch, gn_contact_sums *sums) {
    const double overlap = touch->gap < -touch->rounding ? -touch->gap : 0.0;
    const double path = step->dt * touch->speed;
    gn_hertz_press p =
        gn_hertz_normal(2.0 * side->part * side->hertz.modulus * sqrt(side->radius), overlap);
    gn_touch_press press = {
        .normal = p.normal, .root = p.root, .stored = gn_hertz_stored(p.normal, overlap)};
    if (side->hertz.cohesion == GN_COHESION_LIQUID)
        wet(step, side, touch, path, &press, sums);
    else
        adhere(side, touch, path, &press, sums);
    return press;
}

static double touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *at,
                    double *fd, double *shear, size_t stride, double t[3], gn_contact_sums *sums) {
    const gn_touch_press press = press_of(step, side, at, sums);
    return gn_hertz_touch_by(step, side, at, &press, fd, shear, stride, t, sums);
}

static double touch_rolling(const gn_touch_step *step, const gn_touch_side *side,
                            const gn_touch *at, double *fd, double *shear, size_t stride,
                            double t[3], gn_contact_sums *sums) {
    const double past = at->closeness ? *at->closeness : 0.0;
    const gn_touch_press press = press_of(step, side, at, sums);
    const double total = gn_hertz_touch_by(step, side, at, &press, fd, shear, stride, t, sums);
    const double pressed = press.root > 0.0 ? fmax(press.beside - total, 0.0) : 0.0;
    gn_hertz_touch_roll(step, side, at, pressed, press.root, past, sums);
    return total;
}

#define COMMON                                                                                     \
    .derive = gn_hertz_derive, .set_dashpot = gn_hertz_set_dashpot, .meeting = meeting,            \
    .spring = spring, .held = held, .release = release, .criterion = gn_linear_criterion,          \
    .slips = slips, .touch_spring = touch_spring, .touch_stored = gn_hertz_touch_stored,           \
    .area = gn_hertz_area
const gn_law gn_law_cohesive = {COMMON, .set = set, .touch = touch};
const gn_law gn_law_cohesive_rolling = {COMMON, .set = set_rolling, .touch = touch_rolling,
                                        .moments = moments};
