/* Parameters by area (Santasusana 2013, ch. 4): a bond is a bar of section A between the centres,
 * k_n = alpha E A/L, k_t = beta G A/L, G = E/(2 (1 + nu)), R_n = sigma A, R_t = tau A, L the
 * distance at which it has no normal force. The section of a bond is found once, when it is made
 * (src/particles/bond_sections.c); pairs that come into contact later have gamma times Dempack's
 * section, and L = r_i + r_j. */
#include "kernels/combine.h"

double gn_dempack_area(int dimension, double ri, double rj) {
    double r = 2.0 * ri * rj / (ri + rj);
    return dimension == 3 ? M_PI * r * r : 2.0 * r;
}

/* Computes alpha E and beta G of a pair; for two materials each factor is that of both in series.
 */
static void moduli(const gn_law_pair *pair, double *normal, double *shear) {
    const gn_material *a = pair->a, *b = pair->b;
    double young = GN_OWN(pair, young, gn_series(a->young, b->young));
    double poisson = GN_OWN(pair, poisson, 0.5 * (a->poisson + b->poisson));
    double ga = a->young / (2.0 * (1.0 + a->poisson)), gb = b->young / (2.0 * (1.0 + b->poisson));
    bool own = pair->own && (pair->own->young != GN_COMBINED || pair->own->poisson != GN_COMBINED);
    *normal = GN_OWN(pair, alpha, gn_series(a->alpha, b->alpha)) * young;
    *shear = GN_OWN(pair, beta, gn_series(a->beta, b->beta)) *
             (own ? young / (2.0 * (1.0 + poisson)) : gn_series(ga, gb));
}

gn_area_parameters gn_area_parameters_of(const gn_law_model *model, const gn_law_pair *pair) {
    const gn_material *a = pair->a, *b = pair->b;
    double area = pair->area > 0.0
                      ? pair->area
                      : model->derived.gamma *
                            gn_dempack_area((int)model->scene->dimension, pair->ri, pair->rj);
    double length = pair->length > 0.0 ? pair->length : pair->ri + pair->rj, normal, shear;
    moduli(pair, &normal, &shear);
    return (gn_area_parameters){
        normal * area / length, shear * area / length,
        GN_OWN(pair, tensile_strength, gn_smaller(a->tensile_strength, b->tensile_strength)) * area,
        GN_OWN(pair, shear_strength, gn_smaller(a->shear_strength, b->shear_strength)) * area};
}

/* With x = r_i/r_j, k_n is proportional to x^2/(1 + x)^3 (2D: x/(1 + x)^2), and k_n (1/m_i + 1/m_j)
 * may have its maximum between the least and the greatest radius. It is replaced by the upper bound
 * x/(1 + x)/4 (2D: 1/4), equal at x = 1, whose maximum is at one of these radii: see
 * gn_linear_meeting. */
gn_area_parameters gn_area_meeting(const gn_law_model *model, const gn_law_pair *pair) {
    gn_area_parameters p = gn_area_parameters_of(model, pair);
    double x = pair->ri / pair->rj, over = 0.25 * (1.0 + x) * (1.0 + x) / x;
    p.kn *= over;
    p.kt *= over;
    return p;
}
