/* Bonds that soften and yield (law_softening.h) outside of the kernels. Areas are those from which
 * strengths follow (gn_linear_section). For two materials the weaker strength, the smaller energy,
 * strain and ratio, and the lower compression curve are used. */
#include "kernels/combine.h"
#include "kernels/softening.h"
#include "soa/bond_causes.h"

#include <math.h>

/* Returns the stretch, m, at which the force of a bond with strength R and stiffness k has
 * decreased to zero. */
static double end_of(const gn_law_model *model, double area, double strength, double limit,
                     double energy, double strained, double ratio) {
    switch (model->scene->softening) {
    case GN_SOFTENING_NONE:
        return 0.0;
    case GN_SOFTENING_ENERGY:
        return 2.0 * energy / (model->derived.cut > 0.0 ? model->derived.cut : 1.0) * area /
               strength;
    case GN_SOFTENING_STRAIN:
        return strained;
    case GN_SOFTENING_RATIO:
        return (1.0 + ratio) * limit;
    }
    return 0.0;
}

/* If shear_fracture_energy is auto, it is this factor times fracture_energy. The bonds of a rough
 * crack open and slip at the same time, and with this factor those of a notched beam dissipate
 * their fracture energy (docs/physics.md). */
#define SHEAR_SHARE 2.0
/* The automatic shear energy is at least the elastic energy at the strength plus this fraction of
 * the dissipation in tension after the strength was reached, so that a bond that softens in tension
 * also softens in shear. */
#define LEAST_SHARE 0.5

typedef struct ends {
    double first;         /* fraction of the energies under the first line */
    double end, pulled;   /* m, opening at the end of a single line, and at the elastic limit */
    double pull, shear;   /* N, strengths */
    double sheared, area; /* m, the elastic limit in shear; m2 */
} ends;

/* Returns the slip at which a single line ends, m. */
static double slip_of(const gn_law_model *model, const gn_material *a, const ends *limits) {
    const bool by_energy = model->scene->softening == GN_SOFTENING_ENERGY;
    if (by_energy && a->shear_fracture_energy == GN_SHEAR_ENERGY_AUTO) {
        const double beyond = limits->first * limits->end - limits->pulled,
                     weight = limits->pull / limits->shear;
        if (!(beyond > 0.0)) return 0.0;
        return fmax(SHEAR_SHARE * weight * limits->end,
                    (limits->sheared + LEAST_SHARE * weight * beyond) / limits->first);
    }
    return end_of(model, limits->area, limits->shear, limits->sheared, a->shear_fracture_energy,
                  a->shear_fracture_strain * sqrt(limits->area), a->fracture_ratio);
}

/* Sets the second line, which begins where the fraction `kink` of the strengths is lost. The first
 * line, whose end dissipates a fraction of the fracture energy, is already set; `all` and
 * `all_slip`, m, are the ends of a single line that dissipates all of it. From the kink, at the
 * opening w_k (the stretch is larger by the elastic part), the second line continues to w_c = (all
 * - w_k)/kink, so that the area under both lines is that under the single one. */
static void bend(double kink, double all, double all_slip, gn_contacts *list, size_t c) {
    const size_t stride = list->soa.capacity;
    double *fade = list->fade + c;
    const double rest = kink * list->rn[c];
    const double opening = (1.0 - kink) * fade[GN_FADE_END * stride];
    const double slip = (1.0 - kink) * fade[GN_FADE_SLIP * stride];
    const double end = (all - opening) / kink;
    fade[GN_FADE_KINK * stride] = 1.0 - kink;
    if (opening > 0.0) {
        fade[GN_FADE_SLOPE_SECOND * stride] = rest / (end - opening - rest / list->kn[c]);
        fade[GN_FADE_END_SECOND * stride] = end;
    }
    if (slip > 0.0) fade[GN_FADE_SLIP_SECOND * stride] = ((all_slip - slip) / kink - slip) / kink;
}

static void set_fade(const gn_law_model *model, const gn_law_pair *pair, double area,
                     gn_contacts *list, size_t c) {
    const gn_material *a = pair->a, *b = pair->b;
    const size_t stride = list->soa.capacity;
    double rn = list->rn[c], rt = list->rt[c], pulled = rn / list->kn[c],
           sheared = rt / list->kt[c];
    double ratio = fmin(a->fracture_ratio, b->fracture_ratio);
    double end = end_of(model, area, rn, pulled,
                        GN_OWN(pair, fracture_energy, fmin(a->fracture_energy, b->fracture_energy)),
                        fmin(a->fracture_strain, b->fracture_strain) * list->length0[c], ratio);
    const bool bilinear = model->scene->softening_curve == GN_SOFTENING_BILINEAR;
    const ends known = {
        bilinear ? model->scene->initial_energy : 1.0, end, pulled, rn, rt, sheared, area};
    double slip = fmin(slip_of(model, a, &known), slip_of(model, b, &known));
    const double own = GN_OWN(pair, shear_fracture_energy, GN_COMBINED);
    if (own != GN_COMBINED) slip = end_of(model, area, rt, sheared, own, 0.0, ratio);
    const double all = end, all_slip = slip;
    if (bilinear) end *= model->scene->initial_energy, slip *= model->scene->initial_energy;
    bool softens = end > pulled;
    list->fade[c + GN_FADE_SLOPE * stride] = softens ? rn / (end - pulled) : 0.0;
    list->fade[c + GN_FADE_END * stride] = softens ? end : 0.0;
    list->fade[c + GN_FADE_COHESION * stride] = rt;
    list->fade[c + GN_FADE_SLIP * stride] = slip > sheared ? slip : 0.0;
    list->fade[c + GN_FADE_FRICTION * stride] = list->mu1[c];
    for (size_t k = GN_FADE_KINK; k < GN_FADES; k++) list->fade[c + k * stride] = 0.0;
    if (bilinear) bend(model->scene->kink_stress, all, all_slip, list, c);
}

static const double never = 1e30; /* N, more than any force, also in single precision */

/* Writes the compression curve as a deviation from the elastic line: at each kink the fraction
 * 1/Y_before - 1/Y is subtracted from the elastic force beyond that at the kink. */
static void set_crush(const gn_material *material, double area, gn_contacts *list, size_t c) {
    const size_t stride = list->soa.capacity;
    double elastic = 0.0, stress = 0.0, ratio = 1.0;
    for (size_t n = 0; n < GN_KINKS; n++) {
        bool bends = material->yield_stress[n] > 0.0;
        elastic = bends ? elastic + (material->yield_stress[n] - stress) * ratio : 0.0;
        list->crush[c + n * stride] = bends ? elastic * area : never;
        list->crush[c + (n + GN_KINKS) * stride] =
            bends ? 1.0 / ratio - 1.0 / material->yield_ratio[n] : 0.0;
        if (!bends) continue;
        stress = material->yield_stress[n];
        ratio = material->yield_ratio[n];
    }
    double first = list->crush[c];
    if (list->yields) list->yields[c] = first;
    if (list->yields_f) list->yields_f[c] = (float)first;
}

/* Returns the material that yields first; one that does not yield counts as stronger. */
static const gn_material *weaker(const gn_material *a, const gn_material *b) {
    if (!(a->yield_stress[0] > 0.0)) return b;
    return b->yield_stress[0] > 0.0 && b->yield_stress[0] < a->yield_stress[0] ? b : a;
}

static void set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    gn_linear_set(model, pair, list, c);
    list->mu1[c] = gn_bond_friction(pair);
    list->soft[c] = 1.0;
    list->kappa[c] = 0.0;
    double area = gn_linear_section(model, pair);
    set_fade(model, pair, area, list, c);
    if (list->crush) set_crush(weaker(pair->a, pair->b), area, list, c);
}

/* Scales the forces of kinks and limits; stretches stay unchanged. */
static void weigh(gn_contacts *list, size_t c, double part) {
    const size_t stride = list->soa.capacity;
    gn_linear_weigh(list, c, part);
    list->fade[c + GN_FADE_SLOPE * stride] *= part;
    list->fade[c + GN_FADE_SLOPE_SECOND * stride] *= part;
    list->fade[c + GN_FADE_COHESION * stride] *= part;
    for (size_t n = 0; list->crush && n < GN_KINKS; n++) list->crush[c + n * stride] *= part;
    if (list->yields) list->yields[c] *= part;
    if (list->yields_f) list->yields_f[c] *= (float)part;
}

static double permanent(const gn_contacts *list, size_t c) {
    return gn_column_value(list->plastic, list->plastic_f, c);
}

static gn_law_held held(const gn_contacts *list, size_t c, double length, double stretch) {
    double u = stretch - permanent(list, c);
    gn_law_held h = gn_linear_held(list, c, length, u);
    if (!gn_contact_bonded(list, c) || !(u > 0.0)) return h;
    double gone = (1.0 - list->soft[c]) * h.normal;
    h.normal -= gone;
    h.stored -= 0.5 * gone * u;
    return h;
}

/* Returns the larger of two ratios: of the stretch to that at which softening ends, and of the
 * force to the present strength. */
static double criterion(const gn_contacts *list, size_t c, double normal, double bent,
                        double shear) {
    (void)bent; /* bonds of this law have no moments */
    double strength = gn_mohr_strength(list, c, normal);
    double end = gn_softening_end(list->fade + c, list->soa.capacity);
    double tension =
        end > 0.0 ? normal / (list->soft[c] * list->kn[c] * end) : normal / list->rn[c];
    double sheared = shear > 0.0 ? shear / strength : 0.0;
    if (list->soa.effects & GN_FX_COUPLED_QUADRATIC && tension > 0.0)
        return hypot(tension, sheared);
    return fmax(tension, sheared);
}

gn_bond_condition gn_softening_condition(const gn_contacts *list, size_t c) {
    gn_cause cause = (gn_cause)list->cause[c];
    return (gn_bond_condition){cause == GN_BROKEN_TENSION ? 1.0 : 1.0 - list->soft[c],
                               cause == GN_BROKEN_SHEAR ? 1.0 : list->kappa[c], permanent(list, c)};
}

size_t gn_softening_too_long(const gn_contacts *list) {
    size_t count = 0;
    for (size_t c = 0; list->fade && c < list->soa.count; c++)
        count += list->cause[c] != GN_BOND_NEVER &&
                 !(list->fade[c + GN_FADE_END * list->soa.capacity] > 0.0);
    return count;
}

size_t gn_softening_brittle_in_shear(const gn_contacts *list) {
    const size_t stride = list->soa.capacity;
    size_t count = 0;
    for (size_t c = 0; list->fade && c < list->soa.count; c++)
        count += list->fade[c + GN_FADE_END * stride] > 0.0 &&
                 !(list->fade[c + GN_FADE_SLIP * stride] > 0.0);
    return count;
}

const gn_law gn_law_softening = {
    GN_LINEAR_FUNCTIONS,   .set = set, .held = held, .weigh = weigh, .release = gn_linear_release,
    .criterion = criterion};
