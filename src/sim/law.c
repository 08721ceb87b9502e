/* Parameters of contacts from materials and radii: Rojek et al. 2012, sec. 2, models 1, 2, 3, 3a,
 * 3b, 3c.
 *
 * A contact is seen as a bar between the centres. In 3D its section is (2r)^2 and its length 2r, so
 * that k_n = 2 E_c r and R = 4 sigma_c r^2; in 2D (unit thickness) the section is 2r x 1 m, so that
 * k_n = E_c x 1 m whatever r, and R = 2 sigma_c r x 1 m. */
#include "sim/dashpot.h"
#include "sim/parts.h"

#include <math.h>

double gn_contact_damping_fraction(const gn_scene *scene) {
    if (scene->restitution < 0.0) return scene->damping_fraction;
    if (scene->restitution >= 1.0) return 0.0;
    if (scene->restitution == 0.0) return 1.0; /* critical: it closes and does not come back */
    double l = log(scene->restitution);
    return -l / sqrt(M_PI * M_PI + l * l);
}

/* Springs in series for two materials; the same material gives its own value back exactly. */
static double series(double a, double b) {
    return a == b ? a : 2.0 * a * b / (a + b);
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

typedef struct effective_radius {
    double stiffness; /* k_n = 2 E_c times this */
    double strength2; /* R = 4 sigma_c times this (3D) */
    double strength1; /* R = 2 sigma_c times this (2D) */
} effective_radius;

static effective_radius radius_of(const gn_world *w, double ri, double rj) {
    double mean = 0.5 * (ri + rj), harmonic = 2.0 * ri * rj / (ri + rj), least = smaller(ri, rj);
    switch (w->scene.stiffness) {
    case GN_STIFFNESS_ARITHMETIC:
        return (effective_radius){mean, mean * mean, mean};
    case GN_STIFFNESS_HARMONIC:
        return (effective_radius){harmonic, least * least, least};
    case GN_STIFFNESS_MEAN_RADIUS:
    case GN_STIFFNESS_MEAN_ARITHMETIC:
    case GN_STIFFNESS_MEAN_HARMONIC:
        return (effective_radius){w->dem.derived.radius, w->dem.derived.radius2,
                                  sqrt(w->dem.derived.radius2)};
    case GN_STIFFNESS_UNIFORM:
        break;
    }
    return (effective_radius){0, 0, 0};
}

static void set_kn_and_strength(const gn_world *w, const gn_material *a, const gn_material *b,
                                double ri, double rj, gn_contact_parameters *p) {
    if (w->scene.stiffness == GN_STIFFNESS_UNIFORM) {
        p->kn = series(a->normal_stiffness, b->normal_stiffness);
        p->rn = smaller(a->bond_tension_limit, b->bond_tension_limit);
        p->rt = smaller(a->bond_shear_limit, b->bond_shear_limit);
        return;
    }
    effective_radius r = radius_of(w, ri, rj);
    double modulus = series(a->contact_modulus, b->contact_modulus);
    bool space = w->effects & GN_FX_SPACE;
    double section = space ? 4.0 * r.strength2 : 2.0 * r.strength1;
    p->kn = space ? 2.0 * modulus * r.stiffness : modulus;
    p->rn = smaller(a->tensile_strength, b->tensile_strength) * section;
    p->rt = smaller(a->shear_strength, b->shear_strength) * section;
}

double gn_inverse_mass_along(const gn_world *w, size_t p, const double n[3]) {
    double inverse = w->dem.particles.vel[4 * p + 3];
    int32_t slot = w->dem.prescribed.count ? w->dem.particles.slot[p] : -1;
    return slot < 0 ? inverse : gn_free_share(w->dem.prescribed.mask[slot], n) * inverse;
}

/* Of the pair along the line between its centres, where it is now. */
static double pair_inverse_mass(const gn_world *w, int32_t i, int32_t j) {
    const double *pos = w->dem.particles.pos;
    double n[3], length2 = gn_branch(w, pos + 4 * (int64_t)i, pos + 4 * (int64_t)j, n);
    double scale = length2 > 0.0 ? 1.0 / sqrt(length2) : 0.0;
    for (int a = 0; a < 3; a++) n[a] *= scale;
    return gn_inverse_mass_along(w, (size_t)i, n) + gn_inverse_mass_along(w, (size_t)j, n);
}

gn_contact_parameters gn_contact_law(const gn_world *w, int32_t i, int32_t j) {
    const gn_particles *q = &w->dem.particles;
    const gn_material *a = &w->scene.materials[q->material[i]];
    const gn_material *b = &w->scene.materials[q->material[j]];
    gn_contact_parameters p = {0};
    set_kn_and_strength(w, a, b, q->pos[4 * (int64_t)i + 3], q->pos[4 * (int64_t)j + 3], &p);
    /* Each material's k_t/k_n; two different ones act in series as the normal springs do. */
    double ta = a->kratio > 0.0 ? 1.0 / a->kratio : 0.0,
           tb = b->kratio > 0.0 ? 1.0 / b->kratio : 0.0;
    p.kt = ta + tb > 0.0 ? p.kn * series(ta, tb) : 0.0;
    p.mu = smaller(a->friction, b->friction);
    if (w->dem.damping_fraction > 0.0)
        p.cn = gn_dashpot(p.kn, pair_inverse_mass(w, i, j), w->dem.damping_fraction, w->dt);
    return p;
}

/* Averages over particles (3a) or over contacts (3b, 3c), in list order. */
gneiss_status gn_law_derive(gn_world *w, const gn_pair_list *pairs, gneiss_error *error) {
    gn_stiffness_model model = w->scene.stiffness;
    const double *pos = w->dem.particles.pos;
    double sum = 0.0, sum2 = 0.0;
    size_t count = pairs->count;
    if (model == GN_STIFFNESS_MEAN_RADIUS) {
        count = w->dem.particles.soa.count;
        for (size_t p = 0; p < count; p++) {
            sum += pos[4 * p + 3];
            sum2 += pos[4 * p + 3] * pos[4 * p + 3];
        }
    } else if (model == GN_STIFFNESS_MEAN_ARITHMETIC || model == GN_STIFFNESS_MEAN_HARMONIC) {
        for (size_t c = 0; c < count; c++) {
            double ri = pos[4 * (int64_t)pairs->pair[c][0] + 3],
                   rj = pos[4 * (int64_t)pairs->pair[c][1] + 3];
            double mean = 0.5 * (ri + rj), least = smaller(ri, rj);
            bool arithmetic = model == GN_STIFFNESS_MEAN_ARITHMETIC;
            sum += arithmetic ? mean : 2.0 * ri * rj / (ri + rj);
            sum2 += arithmetic ? mean * mean : least * least;
        }
    } else {
        return GNEISS_OK;
    }
    if (count == 0)
        return gn_fail(
            error, GNEISS_ERROR_INPUT,
            "%s:%d:%d: law.stiffness: expected contacts to average over, found none between the "
            "particles of the specimen",
            w->scene.source, w->scene.law_where.line, w->scene.law_where.column);
    w->dem.derived = (gn_derived){sum / (double)count, sum2 / (double)count};
    return GNEISS_OK;
}
