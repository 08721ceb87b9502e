/* Stresses at the present positions, for output, in scalar code. */
#include "fem/internal.h"

#include "base/new.h"
#include "neigh/neigh.h"

#include <math.h>
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

/* Returns the mean of the nodes' pressures; zero in the displacement form, where the pressure is
 * part of S. */
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
    GN_FREED double *volume = NULL;
    GN_TRY(gn_new(&volume, nodes, "nodes", error));
    memset(nodal, 0, nodes * sizeof *nodal);
    for (size_t e = 0; e < q->soa.count; e++)
        for (int a = 0; a <= solid->dimension; a++) {
            size_t n = (size_t)gn_elements_node(q, a)[e];
            volume[n] += q->volume[e];
            for (int c = 0; c < 6; c++) nodal[n][c] += q->volume[e] * element[e][c];
        }
    for (size_t n = 0; n < nodes; n++) /* nodes without elements have zero stress */
        for (int c = 0; c < 6 && volume[n] > 0.0; c++) nodal[n][c] /= volume[n];
    return GNEISS_OK;
}

gneiss_status gn_fem_nodal_pressure(const gn_fem_solid *solid, double *pressure,
                                    gneiss_error *error) {
    const size_t nodes = solid->nodes.soa.count, elements = solid->elements.soa.count;
    GN_FREED double(*stress)[6] = NULL;
    if (solid->form == GN_FEM_PRESSURE) {
        gn_fem_find_pressures(solid);
        memcpy(pressure, solid->pressure, nodes * sizeof *pressure);
        return GNEISS_OK;
    }
    GN_TRY(gn_new(&stress, elements + nodes, "elements and nodes", error));
    gn_fem_element_stress(solid, stress);
    double(*nodal)[6] = stress + elements;
    GN_TRY(gn_fem_nodal_stress(solid, (const double(*)[6])stress, nodal, error));
    for (size_t n = 0; n < nodes; n++)
        pressure[n] = (nodal[n][0] + nodal[n][1] + nodal[n][2]) / 3.0;
    return GNEISS_OK;
}

/* Computes f_a = -V F S grad N_a. */
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

/* Returns the energy of an element after its nodes have moved for `ahead` s at their velocities. */
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

/* Threads compute the energies of single elements, which are then summed in order. */
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

/* ---- averages over the solid, and the effect of strain on its stability limit, in scalar code
 * ---- */

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

/* The trace of the stiffness block of an element at a node is V |G|^2 (lambda + (1 + d) mu). */
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

/* ---- contact facets of a solid ---- */

static gneiss_status facets_of_group(const gn_fem_solid *solid, const char *group, int32_t **corner,
                                     size_t *count, gneiss_error *error) {
    gn_mesh mesh = solid->mesh;
    const gn_mesh_elements *list = gn_fem_elements_of(&mesh, solid->dimension - 1);
    const gn_mesh_group *found = gn_fem_find_group(&mesh, group, solid->dimension - 1);
    size_t nodes = (size_t)solid->dimension;
    if (!found) return gn_fem_no_group(solid->name, &mesh, group, solid->dimension - 1, error);
    uint8_t *in = gn_alloc_array(list->count + 1, sizeof *in);
    *corner = gn_alloc_array(nodes * list->count + 1, sizeof **corner);
    if (in && *corner) {
        gn_fem_mark_group(list, found->tag, in);
        for (size_t f = 0; f < list->count; f++)
            if (in[f])
                memcpy(*corner + nodes * (*count)++, list->node + nodes * f,
                       nodes * sizeof **corner);
    }
    gneiss_status status =
        in && *corner ? GNEISS_OK : gn_no_memory(error, "the surface of a solid");
    gn_free(in);
    if (status == GNEISS_OK && !*count)
        return gn_fem_no_group(solid->name, &solid->mesh, group, solid->dimension - 1, error);
    return status;
}

/* gn_mesh_boundary replaces the listed facets, so that it gets a copy of the mesh. */
static gneiss_status all_facets(const gn_fem_solid *solid, int32_t **corner, size_t *count,
                                gneiss_error *error) {
    const int dimension = solid->dimension;
    gn_mesh from = solid->mesh;
    GN_FREED_BY(gn_mesh_free)
    gn_mesh mesh = {.lines.nodes = 2,
                    .triangles.nodes = 3,
                    .tetrahedra.nodes = 4,
                    .node_count = from.node_count};
    const gn_mesh_elements *solids = gn_fem_elements_of(&from, dimension);
    gn_mesh_elements *copy = gn_fem_elements_of(&mesh, dimension),
                     *facets = gn_fem_elements_of(&mesh, dimension - 1);
    const size_t nodes = ((size_t)dimension + 1) * solids->count;
    copy->count = solids->count;
    GN_TRY(gn_new(&mesh.node, 3 * from.node_count, "coordinates of nodes", error));
    GN_TRY(gn_new(&copy->node, nodes, "nodes of elements", error));
    GN_TRY(gn_new(&copy->group, solids->count, "elements", error));
    memcpy(mesh.node, from.node, 3 * from.node_count * sizeof *mesh.node);
    memcpy(copy->node, solids->node, nodes * sizeof *copy->node);
    GN_TRY(gn_mesh_boundary(&mesh, dimension, solid->name, error));
    *corner = facets->node;
    *count = facets->count;
    facets->node = NULL;
    return GNEISS_OK;
}

gneiss_status gn_fem_surface(const gn_fem_solid *solid, const char *group, int32_t **corner,
                             size_t *count, gneiss_error *error) {
    *corner = NULL;
    *count = 0;
    return group ? facets_of_group(solid, group, corner, count, error)
                 : all_facets(solid, corner, count, error);
}
