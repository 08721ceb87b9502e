/* Bonds that carry moments (law_beam.h) outside of the kernels. Everything but the moments is as in
 * the linear law: stiffness, strength and dashpots of the pair, walls. The radius of the beam is
 * `bonds.radius_multiplier` times the smaller radius of the two particles (Potyondy and Cundall
 * 2004, eq. 9). */
#include "base/vec3.h"
#include "kernels/combine.h"

#include <math.h>

static void beam_set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                     size_t c) {
    gn_linear_set(model, pair, list, c);
    if (list->mu1) list->mu1[c] = gn_bond_friction(pair);
    if (!list->beam) return;
    list->beam[c] = model->scene->bond_radius_multiplier * fmin(pair->ri, pair->rj);
    list->share[c] = model->scene->bond_moment_share;
}

static bool is_space(const gn_contacts *list) {
    return list->soa.effects & GN_FX_SPACE;
}

/* Computes stiffnesses against bending and twist, N m; both 0 if there are no moments. */
static void stiffness_of(const gn_contacts *list, size_t c, double *bend, double *twist) {
    bool turns = list->beam && list->soa.effects & GN_FX_ROTATION;
    double r2 = turns ? list->beam[c] * list->beam[c] : 0.0;
    *bend = list->kn[c] * r2 * (is_space(list) ? 0.25 : 1.0 / 3.0);
    *twist = is_space(list) && list->kt ? list->kt[c] * r2 * 0.5 : 0.0;
}

static gn_law_moments beam_moments(const gn_contacts *list, size_t c, const double n[3]) {
    gn_law_moments m = {0};
    if (!(list->moment || list->moment_f) || !gn_contact_bonded(list, c)) return m;
    double along = 0.0, across2 = 0.0;
    stiffness_of(list, c, &m.bend, &m.twist);
    for (size_t a = is_space(list) ? 0 : 2; a < 3; a++) {
        size_t at = c + a * list->soa.capacity;
        m.couple[a] = gn_column_value(list->moment, list->moment_f, at);
    }
    if (is_space(list)) along = gn_dot3(m.couple, n);
    for (int a = 0; a < 3; a++)
        across2 += (m.couple[a] - along * n[a]) * (m.couple[a] - along * n[a]);
    m.stored = (m.bend > 0.0 ? 0.5 * across2 / m.bend : 0.0) +
               (m.twist > 0.0 ? 0.5 * along * along / m.twist : 0.0);
    double arm = list->share[c] / list->beam[c];
    m.normal = (is_space(list) ? 4.0 : 3.0) * arm * sqrt(across2);
    m.shear = 2.0 * arm * fabs(along);
    return m;
}

static double criterion(const gn_contacts *list, size_t c, double normal, double bent,
                        double shear) {
    return list->mu1 ? gn_mohr_criterion(list, c, normal, bent, shear)
                     : gn_linear_criterion(list, c, normal, bent, shear);
}

static void beam_release(gn_contacts *list, size_t c) {
    gn_linear_release(list, c);
    for (size_t a = 0; a < 3; a++) {
        if (list->moment) list->moment[c + a * list->soa.capacity] = 0.0;
        if (list->moment_f) list->moment_f[c + a * list->soa.capacity] = 0.0F;
    }
}

const gn_law gn_law_beam = {GN_LINEAR_FUNCTIONS,     .set = beam_set,
                            .held = gn_linear_held,  .weigh = gn_linear_weigh,
                            .release = beam_release, .criterion = criterion,
                            .moments = beam_moments};
