/* The linear brittle law (law_linear.h) outside of the kernels. Parameters from materials and
 * radii: Rojek et al. 2012, sec. 2, models 1, 2, 3, 3a, 3b, 3c.
 *
 * A contact is modelled as a bar between the centres. In 3D its section is (2r)^2 and its length
 * 2r, so that k_n = 2 E_c r and R = 4 sigma_c r^2; in 2D (unit thickness) the section is 2r x 1 m,
 * so that k_n = E_c x 1 m for any r, and R = 2 sigma_c r x 1 m. */
#include "kernels/combine.h"
#include "kernels/dashpot.h"
#include "kernels/law_scalar.h"

#include <math.h>

/* --- parameters --- */

typedef struct parameters {
    double kn, kt, mu, cn;
    double rn, rt; /* of bonds */
} parameters;

typedef struct effective_radius {
    double stiffness; /* k_n = 2 E_c times this */
    double strength2; /* R = 4 sigma_c times this (3D) */
    double strength1; /* R = 2 sigma_c times this (2D) */
} effective_radius;

static effective_radius radius_of(const gn_law_model *model, double ri, double rj) {
    double mean = 0.5 * (ri + rj), harmonic = 2.0 * ri * rj / (ri + rj), least = gn_smaller(ri, rj);
    switch (model->scene->stiffness) {
    case GN_STIFFNESS_ARITHMETIC:
        return (effective_radius){mean, mean * mean, mean};
    case GN_STIFFNESS_HARMONIC:
        return (effective_radius){harmonic, least * least, least};
    case GN_STIFFNESS_MEAN_RADIUS:
    case GN_STIFFNESS_MEAN_ARITHMETIC:
    case GN_STIFFNESS_MEAN_HARMONIC:
        return (effective_radius){model->derived.radius, model->derived.radius2,
                                  sqrt(model->derived.radius2)};
    case GN_STIFFNESS_UNIFORM:
    case GN_STIFFNESS_DEMPACK:
    case GN_STIFFNESS_POLYHEDRON:
    case GN_STIFFNESS_HERTZ:
        break;
    }
    return (effective_radius){0, 0, 0};
}

static double section_of(const gn_law_model *model, effective_radius r) {
    return model->scene->dimension == 3 ? 4.0 * r.strength2 : 2.0 * r.strength1;
}

double gn_linear_section(const gn_law_model *model, const gn_law_pair *pair) {
    const double width = pair->ri + pair->rj;
    if (pair->area > 0.0) return pair->area;
    if (gn_scene_by_area(model->scene))
        return model->derived.gamma *
               gn_dempack_area((int)model->scene->dimension, pair->ri, pair->rj);
    if (model->scene->stiffness != GN_STIFFNESS_UNIFORM)
        return section_of(model, radius_of(model, pair->ri, pair->rj));
    return model->scene->dimension == 3 ? width * width : width;
}

static void set_kn_and_strength(const gn_law_model *model, const gn_law_pair *pair,
                                parameters *values) {
    const gn_material *a = pair->a, *b = pair->b;
    if (model->scene->stiffness == GN_STIFFNESS_UNIFORM) {
        values->kn =
            GN_OWN(pair, normal_stiffness, gn_series(a->normal_stiffness, b->normal_stiffness));
        values->rn = GN_OWN(pair, bond_tension_limit,
                            gn_smaller(a->bond_tension_limit, b->bond_tension_limit));
        values->rt =
            GN_OWN(pair, bond_shear_limit, gn_smaller(a->bond_shear_limit, b->bond_shear_limit));
        return;
    }
    effective_radius r = radius_of(model, pair->ri, pair->rj);
    double modulus =
        GN_OWN(pair, contact_modulus, gn_series(a->contact_modulus, b->contact_modulus));
    bool space = model->scene->dimension == 3;
    double section = section_of(model, r);
    values->kn = space ? 2.0 * modulus * r.stiffness : modulus;
    values->rn =
        GN_OWN(pair, tensile_strength, gn_smaller(a->tensile_strength, b->tensile_strength)) *
        section;
    values->rt =
        GN_OWN(pair, shear_strength, gn_smaller(a->shear_strength, b->shear_strength)) * section;
}

/* Returns the tangential stiffness. Each material has its own k_t/k_n; two different materials act
 * in series, as their normal springs do. */
static double shear_of(const gn_law_pair *pair, double kn) {
    double ka = GN_OWN(pair, kratio, pair->a->kratio), kb = GN_OWN(pair, kratio, pair->b->kratio);
    double ta = ka > 0.0 ? 1.0 / ka : 0.0, tb = kb > 0.0 ? 1.0 / kb : 0.0;
    return ta + tb > 0.0 ? kn * gn_series(ta, tb) : 0.0;
}

/* Applies random factors. If both materials have their own scatter, both factors are computed from
 * the same random number, and the smaller one is used. */
static void scatter(const gn_law_model *model, const gn_law_pair *pair, parameters *values) {
    enum { STRENGTH = 1, STIFFNESS = 2 };
    const uint64_t seed = model->scene->seed;
    double stiffness =
        gn_smaller(gn_scatter_factor(&pair->a->stiffness_scatter, seed, pair->draw_id, STIFFNESS),
                   gn_scatter_factor(&pair->b->stiffness_scatter, seed, pair->draw_id, STIFFNESS));
    double strength =
        gn_smaller(gn_scatter_factor(&pair->a->strength_scatter, seed, pair->draw_id, STRENGTH),
                   gn_scatter_factor(&pair->b->strength_scatter, seed, pair->draw_id, STRENGTH));
    values->kn *= stiffness;
    values->kt *= stiffness;
    values->rn *= strength;
    values->rt *= strength;
}

static parameters parameters_of(const gn_law_model *model, const gn_law_pair *pair, bool meeting) {
    const gn_material *a = pair->a, *b = pair->b;
    parameters p = {0};
    if (gn_scene_by_area(model->scene)) {
        gn_area_parameters by =
            meeting ? gn_area_meeting(model, pair) : gn_area_parameters_of(model, pair);
        p = (parameters){.kn = by.kn, .kt = by.kt, .rn = by.rn, .rt = by.rt};
    } else {
        set_kn_and_strength(model, pair, &p);
        p.kt = shear_of(pair, p.kn);
    }
    p.mu = GN_OWN(pair, friction, gn_smaller(a->friction, b->friction));
    if (pair->draw_id) scatter(model, pair, &p);
    if (model->damping_fraction > 0.0)
        p.cn = gn_dashpot(p.kn, pair->inverse_mass, model->damping_fraction, model->dt);
    return p;
}

void gn_linear_set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                   size_t c) {
    parameters p = parameters_of(model, pair, false);
    list->kn[c] = p.kn;
    if (list->kt) list->kt[c] = p.kt;
    if (list->mu) list->mu[c] = p.mu;
    if (list->cn) list->cn[c] = p.cn;
    if (list->rn) list->rn[c] = p.rn;
    if (list->rt) list->rt[c] = p.rt;
    if (list->section) list->section[c] = gn_linear_section(model, pair);
}

void gn_linear_set_dashpot(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                           size_t c) {
    if (!list->cn) return;
    list->cn[c] = parameters_of(model, pair, false).cn;
    if (list->cn_f) list->cn_f[c] = (float)list->cn[c];
}

/* Multiplies these parameters by `part`; every force, and every limit of a force, is proportional
 * to them. */
void gn_linear_weigh(gn_contacts *list, size_t c, double part) {
    double *columns[] = {list->kn, list->kt, list->cn, list->rn, list->rt};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
        if (columns[k]) columns[k][c] *= part;
}

/* Averages over particles (3a) or over contacts (3b, 3c). */
bool gn_linear_derive(const gn_scene *scene, const gn_particles *particles,
                      const int32_t (*pair)[2], size_t count, gn_derived *derived) {
    gn_stiffness_model model = scene->stiffness;
    const double *pos = particles->pos;
    double sum = 0.0, sum2 = 0.0;
    if (model == GN_STIFFNESS_MEAN_RADIUS) {
        count = particles->soa.count;
        for (size_t p = 0; p < count; p++) {
            sum += pos[4 * p + 3];
            sum2 += pos[4 * p + 3] * pos[4 * p + 3];
        }
    } else if (model == GN_STIFFNESS_MEAN_ARITHMETIC || model == GN_STIFFNESS_MEAN_HARMONIC) {
        for (size_t c = 0; c < count; c++) {
            double ri = pos[4 * (int64_t)pair[c][0] + 3], rj = pos[4 * (int64_t)pair[c][1] + 3];
            double mean = 0.5 * (ri + rj), least = gn_smaller(ri, rj);
            bool arithmetic = model == GN_STIFFNESS_MEAN_ARITHMETIC;
            sum += arithmetic ? mean : 2.0 * ri * rj / (ri + rj);
            sum2 += arithmetic ? mean * mean : least * least;
        }
    } else {
        return true;
    }
    if (count > 0)
        *derived = (gn_derived){.radius = sum / (double)count, .radius2 = sum2 / (double)count};
    return count > 0;
}

/* --- springs --- */

/* As a function of x = r_i/r_j, k_n (1/m_i + 1/m_j) is proportional to (1 + x)(A/x^3 + B)
 * (arithmetic), x/(1 + x) (A/x^3 + B) (harmonic) or A/x^d + B; each of them decreases and then
 * increases, or only decreases. */
gn_law_spring gn_linear_meeting(const gn_law_model *model, const gn_law_pair *pair,
                                double overlap) {
    (void)overlap;
    parameters p = parameters_of(model, pair, true);
    return (gn_law_spring){p.kn, p.mu > 0.0 ? p.kt : 0.0, p.cn};
}

gn_law_spring gn_linear_spring(const gn_contacts *list, size_t c, double overlap) {
    (void)overlap;
    bool holds = gn_contact_bonded(list, c) || (list->mu && list->mu[c] > 0.0);
    return (gn_law_spring){list->kn[c], holds && list->kt ? list->kt[c] : 0.0,
                           list->cn ? list->cn[c] : 0.0};
}

/* --- forces and energy of a contact --- */

gn_law_held gn_linear_held(const gn_contacts *list, size_t c, double length, double stretch) {
    double kt = list->kt ? list->kt[c] : 0.0, shear2 = 0.0;
    bool acts = stretch < -GN_OVERLAP_ROUNDING * length || gn_contact_bonded(list, c);
    gn_law_held h = {.normal = acts ? list->kn[c] * stretch : 0.0,
                     .viscous = gn_column_value(list->fd, list->fd_f, c)};
    for (size_t a = 0; a < 3; a++) {
        h.shear[a] = gn_column_value(list->shear, list->shear_f, c + a * list->soa.capacity);
        shear2 += h.shear[a] * h.shear[a];
    }
    h.stored = 0.5 * h.normal * stretch + (kt > 0.0 ? 0.5 * shear2 / kt : 0.0);
    return h;
}

/* For kernels, a released contact is a broken bond without stiffness. */
void gn_linear_release(gn_contacts *list, size_t c) {
    if (list->rn) list->rn[c] = -fabs(list->rn[c]);
    list->kn[c] = 0.0;
    if (list->kt) list->kt[c] = 0.0;
    for (size_t a = 0; a < 3; a++) {
        if (list->shear) list->shear[c + a * list->soa.capacity] = 0.0;
        if (list->shear_f) list->shear_f[c + a * list->soa.capacity] = 0.0F;
    }
    if (list->cn) list->cn[c] = 0.0;
    if (list->fd) list->fd[c] = 0.0;
    if (list->fd_f) list->fd_f[c] = 0.0F;
}

double gn_linear_criterion(const gn_contacts *list, size_t c, double normal, double bent,
                           double shear) {
    double ratio = (normal + bent) / list->rn[c];
    return list->rt ? fmax(ratio, shear / list->rt[c]) : ratio;
}

/* The force of a sliding contact is at its limit, up to rounding (in mixed precision, of single
 * precision). */
bool gn_linear_slips(const gn_contacts *list, size_t c, double normal, double shear) {
    return list->mu && shear > 0.0 && shear >= list->mu[c] * fmax(-normal, 0.0) * (1.0 - 1e-6);
}

/* --- walls and surfaces --- */

static double touch_kt(const gn_touch_side *side) {
    return side->kratio > 0.0 ? side->stiffness / side->kratio : 0.0;
}

gn_law_spring gn_linear_touch_spring(const gn_touch_side *side, double inverse_mass,
                                     double damping_fraction, double overlap) {
    (void)overlap;
    double kn = side->part * side->stiffness;
    return (gn_law_spring){kn, side->friction > 0.0 ? touch_kt(side) : 0.0,
                           2.0 * damping_fraction * sqrt(kn / inverse_mass)};
}

/* Contacts that share their normal stiffness each have the full tangential stiffness. */
double gn_linear_touch_stored(const gn_touch_side *side, double normal, double shear2) {
    double kn = side->part * side->stiffness, kt = touch_kt(side);
    double stored = kn > 0.0 ? 0.5 * normal * normal / kn : 0.0;
    return kt > 0.0 ? stored + 0.5 * shear2 / kt : stored;
}

/* Applies Coulomb friction with radial return; returns the dissipated energy. */
static double touch_friction(const gn_touch_step *step, const gn_touch *touch, double kt,
                             double limit, double *shear, size_t stride, double t[3],
                             double *elastic) {
    bool space = step->space, twists = space && (step->spins || touch->twist != 0.0);
    double angle = 0.5 * step->dt * touch->twist, lost = 0.0;
    gn_v3 old = {shear[0], shear[stride], shear[2 * stride]}, n = gn_v3_of(touch->n);
    gn_v3 trial =
        gn_linear_shear(old, gn_v3_of(touch->relative), kt, step->dt, n, angle, twists, space);
    gn_v3 now = trial;
    double size2 = gn_dot(trial, trial, 1);
    if (limit * limit < size2) {
        now = gn_linear_slip(trial, size2, limit, true, 1);
        lost = gn_released3(twists ? gn_turn_about_normal(old, n, angle) : old, now, trial, kt, 1);
    }
    t[0] = shear[0] = now.x;
    t[1] = shear[stride] = now.y;
    t[2] = shear[2 * stride] = now.z;
    *elastic += 0.5 * gn_dot(now, now, 1) / kt;
    return lost;
}

/* Returns the root of b x^2 - a x + c = 0, b >= 0, that has the smaller absolute value, limited to
 * +-most; without a root, the place where the left side is smallest. */
static double smaller_root(double a, double b, double c, double most) {
    double square = a * a - 4.0 * b * c;
    double root = square > 0.0 ? 2.0 * c / (a + copysign(sqrt(square), a)) : 0.5 * a / b;
    return fmax(-most, fmin(most, root));
}

/* Returns the force of a contact that closed by the path p > 0 to the overlap u. It is the force f
 * with which the trapezoidal works of this step and of the next one, of path q, equal the energy of
 * the spring after both, at the overlap u + q: f (p + q) = k u (u + q), where q = p - other dt^2 -
 * f dt^2/m. (gn_linear_cross is the first order of this, without other forces.) If the contact
 * opens again in the next step, this holds together with the correction made then; the force may be
 * slightly tensile. */
static double closing_force(double kn, const gn_touch *touch, double p, double dt) {
    double u = -touch->gap, free = p - touch->other_acceleration * dt * dt,
           give = dt * dt * touch->inverse_mass;
    double full = kn * u;
    return smaller_root(p + free + full * give, give, full * (u + free), full);
}

/* Returns the correction for a contact that opened by the path p > 0 to the gap s p, from the
 * overlap u = (1 - s) p. By f (p + q) = k u (p - u) it subtracts the work that the full force of
 * the last instant did beyond the opening. */
static double opening_force(double kn, const gn_touch *touch, double p, double dt) {
    double u = p - touch->gap, free = p + touch->other_acceleration * dt * dt,
           give = dt * dt * touch->inverse_mass;
    return smaller_root(p + free, give, kn * u * touch->gap, kn * u);
}

/* Largest (w dt)^2 for which the works of a crossing are closed exactly: three steps per contact,
 * which automatic steps provide (src/timestep/collisions.c). With a longer prescribed step the full
 * force acts at any overlap, because fractions of steps that do not resolve the contact made
 * platens chatter. */
static const double crossing_resolved = 1.0;

/* Computes the normal force without the dashpot, and the factor on the dashpot's force. The normal
 * of a plane or facet does not rotate within a step, so that the path is along it. For the next
 * step the dashpot counts among the other forces. */
static gn_linear_crossing touch_normal(double kn, double cn, const gn_touch *touch, double path,
                                       double dt) {
    bool touching = touch->gap < -touch->rounding;
    bool resolved = dt * dt * kn * touch->inverse_mass <= crossing_resolved;
    if (!resolved || !gn_touch_crosses(touch, path))
        return touching ? (gn_linear_crossing){kn * touch->gap, 1.0, touch->gap}
                        : (gn_linear_crossing){0.0, 0.0, 0.0};
    double s = touch->gap / path, share = touching ? 0.5 + s : 0.5 - s;
    gn_touch now = *touch;
    now.other_acceleration -= share * cn * touch->speed * touch->inverse_mass;
    if (touching) return (gn_linear_crossing){-closing_force(kn, &now, -path, dt), share, path};
    return (gn_linear_crossing){opening_force(kn, &now, path, dt), share, -path};
}

double gn_linear_press(const gn_touch_step *step, const gn_touch_side *side,
                       const gn_touch *touch) {
    double path = touch->speed * step->dt, kn = side->part * side->stiffness, cn = 0.0;
    if (step->damping)
        cn = gn_dashpot(kn, gn_touch_damped(touch), step->damping_fraction, step->dt);
    gn_linear_crossing normal = touch_normal(kn, cn, touch, path, step->dt);
    return normal.normal + normal.share * cn * touch->speed;
}

double gn_linear_touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                       double *fd, double *shear, size_t stride, double t[3],
                       gn_contact_sums *sums) {
    bool touching = touch->gap < -touch->rounding;
    double path = touch->speed * step->dt, elastic = 0.0, kn = side->part * side->stiffness;
    double cn = step->damping
                    ? gn_dashpot(kn, gn_touch_damped(touch), step->damping_fraction, step->dt)
                    : 0.0;
    gn_linear_crossing normal = touch_normal(kn, cn, touch, path, step->dt);
    double total = normal.normal;
    if (step->damping) {
        double viscous = 0.0;
        if (normal.share != 0.0) viscous = normal.share * touch->speed * cn;
        if (fd) {
            sums->contact_damping += 0.5 * (*fd + viscous) * path;
            *fd = viscous;
        }
        total += viscous;
    }
    t[0] = t[1] = t[2] = 0.0;
    double kt = touch_kt(side);
    if (shear && kt > 0.0)
        sums->friction +=
            touch_friction(step, touch, kt, touching ? side->friction * fmax(-total, 0.0) : 0.0,
                           shear, stride, t, &elastic);
    sums->elastic_normal += 0.5 * normal.normal * normal.way + elastic;
    return total;
}

const gn_law gn_law_linear = {GN_LINEAR_FUNCTIONS,          .set = gn_linear_set,
                              .held = gn_linear_held,       .weigh = gn_linear_weigh,
                              .release = gn_linear_release, .criterion = gn_linear_criterion};
