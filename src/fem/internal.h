/* Functions shared by the files of a solid. */
#ifndef GN_FEM_INTERNAL_H
#define GN_FEM_INTERNAL_H

#include "base/eigen.h"
#include "base/point.h"
#include "fem/linear.h"

/* Returns the group with that name or number; NULL if the mesh has no such group of `dimension`
 * (-1: any). */
const gn_mesh_group *gn_fem_find_group(const gn_mesh *mesh, const char *name, int dimension);
gneiss_status gn_fem_no_group(const char *mesh_name, const gn_mesh *mesh, const char *name,
                              int dimension, gneiss_error *error);

/* Tells whether a position is in a box that is given in absolute coordinates. */
static inline bool gn_fem_between(const gn_fem_solid *solid, const double *x, int axis,
                                  double lower, double upper) {
    double seen = gn_point_out(solid->origin[axis], x[axis]);
    return seen >= lower && seen <= upper;
}

/* Marks the elements of a group in in[element]; all elements have one kind. */
void gn_fem_mark_group(const gn_mesh_elements *list, int32_t tag, uint8_t *in);

/* Computes F of an element at the present positions, and returns its determinant; plane strain has
 * F_zz = 1 (stress.c). */
double gn_fem_deformation(const gn_fem_solid *solid, size_t element, double f[3][3]);

/* Returns the inverse mass of a node without the masses that it carries, 1/kg. */
static inline double gn_fem_own_inverse(const gn_fem_solid *solid, size_t node) {
    double inverse = solid->nodes.vel[4 * node + 3];
    return solid->carried ? 1.0 / (1.0 / inverse - solid->carried[node]) : inverse;
}

/* --- pressure form (pressure.c) --- */

/* Returns the largest eigenvalue of the stabilising term over the lumped pressure mass of a single
 * element. */
double gn_fem_stabiliser_eigenvalue(const gn_elements *elements, size_t e);
/* Sets weights, rows and the rate of the stabilising pressure; to be called before anything is
 * prescribed. */
gneiss_status gn_fem_pressure_prepare(gn_fem_solid *solid, gneiss_error *error);

gn_dilation_args gn_fem_dilation_args(const gn_fem_solid *solid);
gn_pressure_args gn_fem_pressure_args(gn_fem_solid *solid, double dt, bool measure);
/* Computes solid->pressure at the present positions. */
void gn_fem_find_pressures(const gn_fem_solid *solid);

/* --- the solid linearised at its start (linear.h, limit.c) --- */

void gn_fem_gradients(const gn_elements *elements, size_t e, double gradient[4][3]);
void gn_fem_known_free(struct gn_fem_bound_cache *known);

/* Pressure form (pressure.c): operator and metric for the unknowns M^1/2 u, [nodes][dimension], and
 * q, [nodes]. */
void gn_fem_linear_pressure(const void *system, const double *x, double *out);
void gn_fem_linear_metric(const void *system, const double *x, double *out);

static inline gn_mesh_elements *gn_fem_elements_of(gn_mesh *mesh, int dimension) {
    gn_mesh_elements *lists[] = {&mesh->points, &mesh->lines, &mesh->triangles, &mesh->tetrahedra};
    return lists[dimension];
}
static inline const char *gn_fem_kind(int dimension) {
    static const char *const names[] = {"point", "line", "triangle", "tetrahedron"};
    return names[dimension];
}

#endif
