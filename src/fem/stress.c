/* Stresses at the present positions, for output, in scalar code. */
#include "base/memory.h"
#include "fem/internal.h"

#include <string.h>

double gn_fem_deformation(const gn_fem_solid *solid, size_t e, double f[3][3]) {
    const gn_elements *q = &solid->elements;
    const double *first = solid->nodes.pos + 4 * (size_t)gn_elements_node(q, 0)[e];
    memset(f, 0, 9 * sizeof(double));
    f[2][2] = solid->dimension == 2 ? 1.0 : 0.0;
    for (int a = 1; a <= solid->dimension; a++) {
        const double *x = solid->nodes.pos + 4 * (size_t)gn_elements_node(q, a)[e];
        for (int i = 0; i < solid->dimension; i++)
            for (int k = 0; k < solid->dimension; k++)
                f[i][k] += (x[i] - first[i]) * gn_elements_gradient(q, a, k)[e];
    }
    return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) -
           f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
           f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
}

static inline void second_piola(const gn_elements *elements, size_t e, bool pressure,
                                double f[3][3], double s[3][3]) {
    double trace = 0.0;
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            double c = f[0][k] * f[0][l] + f[1][k] * f[1][l] + f[2][k] * f[2][l] - (k == l);
            s[k][l] = elements->mu[e] * c;
            if (k == l) trace += 0.5 * c;
        }
    const double lambda = pressure ? -2.0 / 3.0 * elements->mu[e] : elements->lambda[e];
    for (int k = 0; k < 3; k++) s[k][k] += lambda * trace;
}

/* Returns the mean over the nodes; zero in the displacement form, whose pressure is part of S. */
static double mean_pressure(const gn_fem_solid *solid, size_t e) {
    double sum = 0.0;
    if (solid->form != GN_FEM_PRESSURE) return 0.0;
    for (int a = 0; a <= solid->dimension; a++)
        sum += solid->pressure[gn_elements_node(&solid->elements, a)[e]];
    return sum / (solid->dimension + 1);
}

void gn_fem_stress_of(const gn_fem_solid *solid, size_t e, double stress[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    double f[3][3], s[3][3], det = gn_fem_deformation(solid, e, f);
    second_piola(&solid->elements, e, solid->form == GN_FEM_PRESSURE, f, s);
    const double pressure = mean_pressure(solid, e);
    for (int c = 0; c < 6; c++) {
        double sum = 0.0;
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) sum += f[row[c]][k] * s[k][l] * f[column[c]][l];
        stress[c] = sum / det + (c < 3 ? pressure : 0.0);
    }
}

void gn_fem_element_stress(const gn_fem_solid *solid, double (*stress)[6]) {
    if (solid->form == GN_FEM_PRESSURE) gn_fem_find_pressures(solid);
#pragma omp parallel for num_threads(solid->threads) schedule(static)
    for (size_t e = 0; e < solid->elements.soa.count; e++) gn_fem_stress_of(solid, e, stress[e]);
}

gneiss_status gn_fem_nodal_stress(const gn_fem_solid *solid, const double (*element)[6],
                                  double (*nodal)[6], gneiss_error *error) {
    const gn_elements *q = &solid->elements;
    const size_t nodes = solid->nodes.soa.count;
    double *volume = gn_alloc_array(nodes + 1, sizeof *volume);
    if (!volume) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes", nodes);
    memset(nodal, 0, nodes * sizeof *nodal);
    for (size_t e = 0; e < q->soa.count; e++)
        for (int a = 0; a <= solid->dimension; a++) {
            size_t n = (size_t)gn_elements_node(q, a)[e];
            volume[n] += q->volume[e];
            for (int c = 0; c < 6; c++) nodal[n][c] += q->volume[e] * element[e][c];
        }
    for (size_t n = 0; n < nodes; n++) /* without elements: zero */
        for (int c = 0; c < 6 && volume[n] > 0.0; c++) nodal[n][c] /= volume[n];
    gn_free(volume);
    return GNEISS_OK;
}

gneiss_status gn_fem_nodal_pressure(const gn_fem_solid *solid, double *pressure,
                                    gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count, elements = solid->elements.soa.count;
    if (solid->form == GN_FEM_PRESSURE) {
        gn_fem_find_pressures(solid);
        memcpy(pressure, solid->pressure, nodes * sizeof *pressure);
        return GNEISS_OK;
    }
    double(*stress)[6] = gn_alloc_array(elements + nodes + 1, sizeof *stress);
    if (!stress) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu nodes", nodes);
    gn_fem_element_stress(solid, stress);
    double(*nodal)[6] = stress + elements;
    gneiss_status status = gn_fem_nodal_stress(solid, (const double(*)[6])stress, nodal, error);
    for (size_t n = 0; n < nodes; n++)
        pressure[n] = (nodal[n][0] + nodal[n][1] + nodal[n][2]) / 3.0;
    gn_free(stress);
    return status;
}

/* f_a = -V F S grad N_a. */
void gn_fem_force_of(const gn_fem_solid *solid, size_t e, double force[4][3]) {
    double f[3][3], s[3][3], g[4][3];
    gn_fem_deformation(solid, e, f);
    second_piola(&solid->elements, e, false, f, s);
    gn_fem_gradients(&solid->elements, e, g);
    for (int a = 0; a <= solid->dimension; a++)
        for (int i = 0; i < 3; i++) {
            force[a][i] = 0.0;
            for (int k = 0; i < solid->dimension && k < solid->dimension; k++)
                for (int l = 0; l < solid->dimension; l++)
                    force[a][i] -= solid->elements.volume[e] * f[i][k] * s[k][l] * g[a][l];
        }
}

/* Returns half of S : E of the St Venant-Kirchhoff law. */
static double energy_density(const gn_fem_solid *solid, size_t e, double f[3][3]) {
    double s[3][3], energy = 0.0;
    second_piola(&solid->elements, e, false, f, s);
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            energy += 0.25 * s[k][l] *
                      (f[0][k] * f[0][l] + f[1][k] * f[1][l] + f[2][k] * f[2][l] - (k == l));
    return energy;
}

static double element_energy(const gn_fem_solid *solid, size_t e, double f[3][3]) {
    return solid->elements.volume[e] * energy_density(solid, e, f);
}

double gn_fem_energy_density(const gn_fem_solid *solid, size_t e) {
    double f[3][3];
    gn_fem_deformation(solid, e, f);
    return energy_density(solid, e, f);
}

void gn_fem_gradient_of(const gn_fem_solid *solid, size_t e, double f[3][3]) {
    gn_fem_deformation(solid, e, f);
}

/* Returns the energy after the displacements of the velocities over `ahead` s. */
static double energy_ahead(const gn_fem_solid *solid, size_t e, double ahead) {
    const gn_elements *q = &solid->elements;
    double f[3][3], g[4][3];
    gn_fem_deformation(solid, e, f);
    if (ahead == 0.0) return element_energy(solid, e, f);
    gn_fem_gradients(q, e, g);
    for (int a = 0; a <= solid->dimension; a++) {
        const size_t n = (size_t)gn_elements_node(q, a)[e];
        for (int i = 0; i < solid->dimension; i++)
            for (int k = 0; k < solid->dimension; k++)
                f[i][k] += ahead * solid->nodes.vel[4 * n + (size_t)i] * g[a][k];
    }
    return element_energy(solid, e, f);
}

/* Threads compute the energies of single elements, which are summed in their order. */
double gn_fem_elastic_energy(const gn_fem_solid *solid, const int32_t *element, size_t count,
                             double ahead) {
    enum { SOME = 4096 };
    double sum = 0.0, held[SOME];
    for (size_t from = 0; from < count; from += SOME) {
        const size_t now = count - from < SOME ? count - from : SOME;
#pragma omp parallel for num_threads(solid->threads) schedule(static)
        for (size_t k = 0; k < now; k++)
            held[k] = energy_ahead(solid, (size_t)element[from + k], ahead);
        for (size_t k = 0; k < now; k++) sum += held[k];
    }
    return sum;
}
