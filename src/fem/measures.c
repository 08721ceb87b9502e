/* Averages over the solid, and the effect of strain on its stability limit, in scalar code. */
#include "base/memory.h"
#include "fem/internal.h"
#include "neigh/pairs.h"

#include <math.h>
#include <string.h>

/* --- strain --- */

void gn_fem_strain_weights(const gn_fem_solid *solid, double (*weight)[3]) {
    const gn_elements *q = &solid->elements;
    double gradient[4][3];
    memset(weight, 0, solid->nodes.soa.count * sizeof *weight);
    for (size_t e = 0; e < q->soa.count; e++) {
        gn_fem_gradients(q, e, gradient);
        for (int a = 0; a <= solid->dimension; a++)
            for (int k = 0; k < 3; k++)
                weight[gn_elements_node(q, a)[e]][k] +=
                    q->volume[e] / solid->volume * gradient[a][k];
    }
}

void gn_fem_mean_gradient(const gn_fem_solid *solid, const double (*weight)[3],
                          double gradient[9]) {
    memset(gradient, 0, 9 * sizeof *gradient);
    for (size_t n = 0; n < solid->nodes.soa.count; n++)
        for (size_t a = 0; a < 3; a++) {
            double u = solid->nodes.pos[4 * n + a] - solid->nodes.start[4 * n + a];
            for (size_t b = 0; b < 3; b++) gradient[3 * a + b] += u * weight[n][b];
        }
}

/* --- per element --- */

static double element_force(const gn_fem_solid *solid, size_t e, const double s[6]) {
    double gradient[4][3], sum = 0.0;
    gn_fem_gradients(&solid->elements, e, gradient);
    for (int a = 0; a <= solid->dimension; a++) {
        const double *g = gradient[a];
        double f[3] = {s[0] * g[0] + s[3] * g[1] + s[5] * g[2],
                       s[3] * g[0] + s[1] * g[1] + s[4] * g[2],
                       s[5] * g[0] + s[4] * g[1] + s[2] * g[2]};
        sum += sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    }
    return sum * solid->elements.volume[e];
}

double gn_fem_mean_force(const gn_fem_solid *solid, const double (*stress)[6]) {
    size_t count = solid->elements.soa.count, corners = (size_t)solid->dimension + 1;
    double total = 0.0;
    for (size_t e = 0; e < count; e++) total += element_force(solid, e, stress[e]);
    return total / (double)(count * corners);
}

/* Returns a factor by which an element's eigenvalues may have grown. Of the tangent's two parts the
 * material one is that of the reference for the motion F^T H, so that its eigenvalues grow by at
 * most |C| = |I + 2 E| <= 1 + 2 |E|. The geometric one, V sigma : H H^T, has at most
 * |sigma|/(lambda + 2 mu) times the largest eigenvalue of the element, which is at least that of a
 * pressure wave along the same gradient (Bathe 1996, sec. 6.3 for the tangent). Norms are
 * Frobenius'; to first order in the strain.
 *
 * The stress is computed only where the factor may be above `known`: |sigma| <= |F|^2 |S|/det F
 * with |F|^2 <= 1 + 2 |E|, |S| <= 3 (lambda + 2 mu) |E| for every nu, det F^2 >= (1 - 2 |E|)^3,
 * which for |E| <= 1/10 makes the factor at most 1 + 7.1 |E|. */
static double element_stiffening(const gn_fem_solid *solid, size_t e, double known) {
    const gn_elements *q = &solid->elements;
    double f[3][3], s[6], strain2 = 0.0;
    gn_fem_deformation(solid, e, f);
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            double c = f[0][k] * f[0][l] + f[1][k] * f[1][l] + f[2][k] * f[2][l] - (k == l);
            strain2 += 0.25 * c * c;
        }
    const double strain = sqrt(strain2);
    /* in the pressure form, the pressure is independent of the strain */
    const bool elastic = solid->form == GN_FEM_DISPLACEMENT;
    if (elastic && strain <= 0.1 && 1.0 + 7.5 * strain <= known) return known;
    gn_fem_stress_of(solid, e, s);
    double stress2 =
        s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
    return 1.0 + 2.0 * strain + sqrt(stress2) / (q->lambda[e] + 2.0 * q->mu[e]);
}

double gn_fem_stiffening(const gn_fem_solid *solid) {
    double most = 1.0;
    if (solid->form == GN_FEM_PRESSURE) gn_fem_find_pressures(solid);
#pragma omp parallel for reduction(max : most) num_threads(solid->threads) schedule(static)
    for (size_t e = 0; e < solid->elements.soa.count; e++)
        most = fmax(most, element_stiffening(solid, e, most));
    return sqrt(most);
}

size_t gn_fem_bytes(const gn_fem_solid *solid) {
    return solid->nodes.soa.capacity * gn_record_bytes(&gn_particle_record, solid->effects) +
           solid->elements.soa.capacity * gn_record_bytes(&gn_element_record, solid->effects) +
           gn_partials_bytes(&solid->partials, solid->elements.soa.count, solid->dimension + 1);
}

double gn_fem_volume_ratio(const gn_fem_solid *solid, size_t element) {
    double f[3][3];
    return gn_fem_deformation(solid, element, f);
}

/* The trace of an element's stiffness at a node is V |G|^2 (lambda + (1 + d) mu). */
void gn_fem_step_scales(const gn_fem_solid *solid, double *scale) {
    const gn_elements *q = &solid->elements;
    const int d = solid->dimension;
    for (size_t e = 0; e < q->soa.count; e++) {
        double gradient[4][3], sum = 0.0;
        gn_fem_gradients(q, e, gradient);
        for (int a = 0; a <= d; a++)
            for (int k = 0; k < d; k++) sum += gradient[a][k] * gradient[a][k];
        scale[e] = 2.0 / sqrt(sum * (q->lambda[e] + (1 + d) * q->mu[e]) * (d + 1) /
                              solid->density[q->material[e]]);
    }
}
