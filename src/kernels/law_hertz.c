/* Hertz-Mindlin contacts (law_hertz.h) outside of the kernels. For two materials E* and G* are
 * those of both in series, friction and restitution the smaller. */
#include "kernels/combine.h"
#include "kernels/law_scalar.h"

#include "kernels/hertz.h"

/* --- parameters --- */

/* Least restitution that is distinguished if the dashpot must not cause tension, because the fit
 * has no bound below it. */
static const double least_fitted = 0.05;

/* Returns c/sqrt(m S_n) for a restitution e: 2 sqrt(5/6) beta, with beta = -ln e/sqrt(pi^2 + ln^2
 * e) of the linear oscillator (Antypov and Elliott 2011), and beta = 1 at e = 0. If the total force
 * must not become tensile, it follows from the polynomial of Thornton, Cummins and Cleary 2013 (eq.
 * 20). */
static double damping_of(double e, bool pulls) {
    static const double h[] = {-6.918798, -16.41105, 146.8049,  -796.4559, 2928.711,
                               -7206.864, 11494.29,  -11342.18, 6276.757,  -1489.915};
    double p = 0.0, log_e = log(e);
    if (e >= 1.0) return 0.0;
    if (pulls)
        return 2.0 * sqrt(5.0 / 6.0) * (e > 0.0 ? -log_e / sqrt(M_PI * M_PI + log_e * log_e) : 1.0);
    e = fmax(e, least_fitted);
    for (int k = 9; k >= 0; k--) p = e * (h[k] + p);
    return 2.0 * sqrt(fmax(1.0 / (1.0 - (1.0 + e) * (1.0 + e) * exp(p)) - 1.0, 0.0));
}

/* Returns the damping of a material, or of the scene. */
static double damping_by(const gn_scene *scene, const gn_material *material) {
    double e = material->restitution >= 0.0 ? material->restitution : scene->restitution;
    if (e >= 0.0) return damping_of(e, scene->pull);
    return 2.0 * sqrt(5.0 / 6.0) * scene->damping_fraction;
}

/* Returns the work of adhesion of two materials; one side of a rigid wall counts as the
 * particle's. */
static double adhesion_of(const gn_scene *scene, const gn_material *a, const gn_material *b,
                          const gn_contact_def *own) {
    if (scene->cohesion == GN_COHESION_NONE) return 0.0;
    if (scene->cohesion == GN_COHESION_LIQUID)
        return scene->surface_tension * cos(scene->contact_angle);
    if (own && own->adhesion != GN_COMBINED) return own->adhesion;
    return b ? sqrt(a->adhesion) * sqrt(b->adhesion) : a->adhesion;
}

gn_hertz_pair gn_hertz_pair_of(const gn_scene *scene, const gn_material *a, const gn_material *b,
                               const gn_contact_def *own) {
    const gn_material *side[] = {a, b};
    gn_hertz_pair p = {.friction = a->friction, .damping = damping_by(scene, a)};
    double give = 0.0, give_across = 0.0;
    for (int k = 0; k < 2 && side[k]; k++) {
        double young = side[k]->young, poisson = side[k]->poisson;
        if (own && own->young != GN_COMBINED) young = own->young;
        if (own && own->poisson != GN_COMBINED) poisson = own->poisson;
        give += (1.0 - poisson * poisson) / young;
        give_across += (2.0 - poisson) * 2.0 * (1.0 + poisson) / young;
    }
    p.modulus = 1.0 / give;
    p.shear_modulus = 1.0 / give_across;
    p.cohesion = (int)scene->cohesion;
    p.adhesion = adhesion_of(scene, a, b, own);
    p.rolling = a->rolling_friction;
    p.twisting = a->twisting_friction;
    if (b) p.friction = gn_smaller(a->friction, b->friction);
    if (b) p.rolling = gn_smaller(a->rolling_friction, b->rolling_friction);
    if (b) p.twisting = gn_smaller(a->twisting_friction, b->twisting_friction);
    if (b) p.damping = fmax(p.damping, damping_by(scene, b));
    if (own && own->friction != GN_COMBINED) p.friction = own->friction;
    if (own && own->rolling_friction != GN_COMBINED) p.rolling = own->rolling_friction;
    if (own && own->twisting_friction != GN_COMBINED) p.twisting = own->twisting_friction;
    if (own && own->restitution != GN_COMBINED)
        p.damping = damping_of(own->restitution, scene->pull);
    return p;
}

typedef struct parameters {
    double kn, kt, mu, cn, lag;
} parameters;

static parameters parameters_of(const gn_law_model *model, const gn_law_pair *ends) {
    gn_hertz_pair pair = gn_hertz_pair_of(model->scene, ends->a, ends->b, ends->own);
    double root = sqrt(ends->ri * ends->rj / (ends->ri + ends->rj));
    parameters p = {.kn = 2.0 * pair.modulus * root,
                    .kt = 8.0 * pair.shear_modulus * root,
                    .mu = pair.friction};
    if (!(ends->inverse_mass > 0.0)) return p;
    p.cn = pair.damping / sqrt(ends->inverse_mass);
    p.lag = 0.25 * p.cn * model->dt * ends->inverse_mass;
    return p;
}

bool gn_hertz_derive(const gn_scene *scene, const gn_particles *particles, const int32_t (*pair)[2],
                     size_t count, gn_derived *derived) {
    (void)scene, (void)particles, (void)pair, (void)count, (void)derived;
    return true;
}

void gn_hertz_set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    parameters p = parameters_of(model, pair);
    list->kn[c] = p.kn;
    if (list->kt) list->kt[c] = p.kt;
    if (list->mu) list->mu[c] = p.mu;
    if (list->cn) list->cn[c] = p.cn;
    if (list->lag) list->lag[c] = p.lag;
}

void gn_hertz_set_dashpot(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                          size_t c) {
    if (!list->cn) return;
    parameters p = parameters_of(model, pair);
    list->cn[c] = p.cn;
    list->lag[c] = p.lag;
    if (list->cn_f) list->cn_f[c] = (float)p.cn;
    if (list->lag_f) list->lag_f[c] = (float)p.lag;
}

/* --- springs --- */

/* At a given overlap S_n (1/m_i + 1/m_j), as a function of x = r_i/r_j, is proportional to
 * sqrt(x/(1 + x)) (A/x^3 + B), which decreases and then increases. */
gn_law_spring gn_hertz_meeting(const gn_law_model *model, const gn_law_pair *pair, double overlap) {
    parameters p = parameters_of(model, pair);
    double root = sqrt(overlap);
    return (gn_law_spring){p.kn * root, p.mu > 0.0 ? p.kt * root : 0.0, p.cn * sqrt(p.kn * root)};
}

gn_law_spring gn_hertz_spring(const gn_contacts *list, size_t c, double overlap) {
    double most = list->most[c], root = sqrt(most > 0.0 ? most : overlap);
    double kn = list->kn[c] * root;
    return (gn_law_spring){kn, list->mu && list->mu[c] > 0.0 ? list->kt[c] * root : 0.0,
                           list->cn ? list->cn[c] * sqrt(kn) : 0.0};
}

/* --- forces and energy of a contact --- */

gn_law_held gn_hertz_held(const gn_contacts *list, size_t c, double length, double stretch) {
    double shear2 = 0.0, overlap = stretch < -GN_OVERLAP_ROUNDING * length ? -stretch : 0.0;
    gn_hertz_press p = gn_hertz_normal(list->kn[c], overlap);
    gn_law_held h = {.normal = p.normal, .viscous = gn_column_value(list->fd, list->fd_f, c)};
    for (size_t a = 0; a < 3; a++) {
        h.shear[a] = gn_column_value(list->shear, list->shear_f, c + a * list->soa.capacity);
        shear2 += h.shear[a] * h.shear[a];
    }
    h.stored = gn_hertz_stored(p.normal, overlap);
    /* A contact that has opened since the last forces has no energy. */
    const double kt = list->kt[c] * p.root;
    if (shear2 > 0.0 && kt > 0.0) h.stored += 0.5 * shear2 / kt;
    return h;
}

double gn_hertz_area(const gn_law_pair *pair, double overlap) {
    return M_PI * fmax(overlap, 0.0) / (1.0 / pair->ri + 1.0 / pair->rj);
}

/* --- walls and surfaces --- */

static double kn_of(const gn_touch_side *side) {
    return 2.0 * side->part * side->hertz.modulus * sqrt(side->radius);
}
static double kt_of(const gn_touch_side *side) {
    return 8.0 * side->hertz.shear_modulus * sqrt(side->radius);
}

gn_law_spring gn_hertz_touch_spring(const gn_touch_side *side, double inverse_mass,
                                    double damping_fraction, double overlap) {
    (void)damping_fraction; /* damping is a parameter of every pair */
    double root = sqrt(overlap), kn = kn_of(side) * root;
    double kt = side->hertz.friction > 0.0 ? kt_of(side) * root : 0.0;
    return (gn_law_spring){kn, kt, side->hertz.damping * sqrt(kn / inverse_mass)};
}

double gn_hertz_touch_stored(const gn_touch_side *side, double normal, double shear2) {
    double kn = kn_of(side), overlap = cbrt(pow(1.5 * fabs(normal) / kn, 2.0));
    double kt = kt_of(side) * sqrt(overlap);
    return 0.4 * fabs(normal) * overlap + (shear2 > 0.0 && kt > 0.0 ? 0.5 * shear2 / kt : 0.0);
}

static double touch_viscous(const gn_touch_step *step, const gn_touch_side *side,
                            const gn_touch *touch, const gn_hertz_press *press) {
    const double inverse = gn_touch_damped(touch);
    if (!(inverse > 0.0)) return 0.0;
    double c = side->hertz.damping / sqrt(inverse);
    double lag = 0.25 * c * step->dt * inverse, path = touch->speed * step->dt;
    double coefficient = gn_hertz_dashpot(c, lag, press->stiffness);
    if (gn_touch_crosses(touch, path)) {
        double most = gn_hertz_dashpot(c, lag, kn_of(side) * sqrt(fabs(path)));
        double over = touch->gap / fabs(path);
        if (path < 0.0)
            coefficient = most * gn_hertz_closing(fmin(fmax(-over, 0.0), 1.0));
        else
            coefficient =
                step->pulls ? most * gn_hertz_opening(fmin(fmax(1.0 - over, 0.0), 1.0)) : 0.0;
    }
    double viscous = coefficient * touch->speed;
    return step->pulls ? viscous : fmin(viscous, -press->normal);
}

/* Replaces the tangential force of the last step, in *shear, by that of this one; adds its energy
 * to *elastic. */
static double touch_shear(const gn_touch_step *step, const gn_touch_side *side,
                          const gn_touch *touch, const gn_hertz_press *press, double limit,
                          double *shear, size_t stride, double t[3], double *elastic) {
    bool twists = step->spins || touch->twist != 0.0;
    double angle = 0.5 * step->dt * touch->twist, kt = kt_of(side), past = *touch->closeness;
    gn_v3 n = gn_v3_of(touch->n), none = {0.0, 0.0, 0.0};
    gn_v3 before = {shear[0], shear[stride], shear[2 * stride]};
    if (twists) before = gn_turn_about_normal(before, n, angle);
    gn_v3 way =
        gn_linear_shear(none, gn_v3_of(touch->relative), 1.0, step->dt, n, angle, twists, 1);
    gn_v3 now = gn_axpy(gn_hertz_rescaled(before, past, press->root, 1), kt * press->root, way, 1);
    double size2 = gn_dot(now, now, 1);
    if (limit * limit < size2) now = gn_linear_slip(now, size2, limit, true, 1);
    double closeness = press->root > 0.0 ? 1.0 / press->root : 0.0;
    t[0] = shear[0] = now.x;
    t[1] = shear[stride] = now.y;
    t[2] = shear[2 * stride] = now.z;
    *touch->closeness = closeness;
    *elastic += 0.5 * gn_dot(now, now, 1) * closeness / kt;
    return gn_hertz_lost(before, now, way, past, closeness, kt, 1);
}

double gn_hertz_touch_by(const gn_touch_step *step, const gn_touch_side *side,
                         const gn_touch *touch, const gn_touch_press *press, double *fd,
                         double *shear, size_t stride, double t[3], gn_contact_sums *sums) {
    double overlap = touch->gap < -touch->rounding ? -touch->gap : 0.0;
    gn_hertz_press p = gn_hertz_normal(kn_of(side), overlap);
    double total = press->normal, elastic = press->stored;
    if (step->damping) {
        double viscous = touch_viscous(step, side, touch, &p);
        if (fd) {
            sums->contact_damping += 0.5 * (*fd + viscous) * touch->speed * step->dt;
            *fd = viscous;
        }
        total += viscous;
    }
    t[0] = t[1] = t[2] = 0.0;
    p.root = press->root;
    if (shear)
        sums->friction += touch_shear(step, side, touch, &p,
                                      side->hertz.friction * fmax(press->beside - total, 0.0),
                                      shear, stride, t, &elastic);
    sums->elastic_normal += elastic;
    sums->pressed += overlap > touch->checked_overlap;
    return total;
}

double gn_hertz_touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                      double *fd, double *shear, size_t stride, double t[3],
                      gn_contact_sums *sums) {
    double overlap = touch->gap < -touch->rounding ? -touch->gap : 0.0;
    gn_hertz_press p = gn_hertz_normal(kn_of(side), overlap);
    gn_touch_press press = {
        .normal = p.normal, .root = p.root, .stored = gn_hertz_stored(p.normal, overlap)};
    return gn_hertz_touch_by(step, side, touch, &press, fd, shear, stride, t, sums);
}

const gn_law gn_law_hertz = {GN_HERTZ_FUNCTIONS, .set = gn_hertz_set, .touch = gn_hertz_touch};
