/* Pieces of a solid that its own files share. */
#ifndef GN_FEM_INTERNAL_H
#define GN_FEM_INTERNAL_H

#include "base/eigen.h"
#include "base/point.h"
#include "fem/linear.h"

/* The group called `name`, or with that number; NULL when the mesh has none of `dimension` (-1: of
 * any). */
const gn_mesh_group *gn_fem_find_group(const gn_mesh *mesh, const char *name, int dimension);
gneiss_status gn_fem_no_group(const char *mesh_name, const gn_mesh *mesh, const char *name,
                              int dimension, gneiss_error *error);

/* Whether a coordinate lies between two as the user sees them. */
static inline bool gn_fem_between(const gn_fem_solid *solid, const double *x, int axis,
                                  double lower, double upper) {
    double seen = gn_point_out(solid->origin[axis], x[axis]);
    return seen >= lower && seen <= upper;
}

/* in[element]: whether an element belongs to a group; elements of one kind. */
void gn_fem_mark_group(const gn_mesh_elements *list, int32_t tag, uint8_t *in);

/* F of an element at the present positions, and its determinant; plane strain has F_zz = 1
 * (stress.c). */
double gn_fem_deformation(const gn_fem_solid *solid, size_t element, double f[3][3]);

/* m2 of a facet at the start; of a line 1 m thick (loads.c). */
double gn_fem_facet_area(const gn_fem_solid *solid, const int32_t *node);

/* 1/kg of a node without what it carries. */
static inline double gn_fem_own_inverse(const gn_fem_solid *solid, size_t node) {
    double inverse = solid->nodes.vel[4 * node + 3];
    return solid->carried ? 1.0 / (1.0 / inverse - solid->carried[node]) : inverse;
}

/* --- the parallel part of a step (sweep.c) --- */

/* Forces of the present instant, and nodes (with the stabilising pressure) over the coming
 * interval; leaves the sums of all blocks. */
void gn_fem_sweep(gn_fem_solid *solid, double dt, bool measure);
/* Moves the nodes that gn_fem_sweep left. */
void gn_fem_sweep_held(gn_fem_solid *solid, double dt, bool measure);

/* --- pressure form (pressure.c) --- */

/* Bulk modulus, Pa. */
double gn_fem_bulk(const gn_elements *q, size_t e);
/* Largest eigenvalue of the stabilising term over the lumped pressure mass of an element alone. */
double gn_fem_stabiliser_eigenvalue(const gn_elements *q, size_t e);
/* Weights, rows and the rate of the stabilising pressure; nothing may be prescribed yet. */
gneiss_status gn_fem_pressure_prepare(gn_fem_solid *solid, gneiss_error *error);

gn_dilation_args gn_fem_dilation_args(const gn_fem_solid *solid);
gn_pressure_args gn_fem_pressure_args(gn_fem_solid *solid, double dt, bool measure);
/* solid->pressure of the present positions. */
void gn_fem_find_pressures(const gn_fem_solid *solid);

/* --- the solid linearised at its start (linear.h, limit.c) --- */

void gn_fem_gradients(const gn_elements *q, size_t e, double gradient[4][3]);
/* Fills y->stiffness (bound.c). */
void gn_fem_sum_stiffness(gn_fem_linear *y);
/* Sets the bound and its element. */
gneiss_status gn_fem_find_bound(const gn_fem_linear *y, gn_fem_limit *limit, gneiss_error *error);
/* Of which nothing is known yet (limit.c). */
gn_fem_limit gn_fem_limit_none(void);
void gn_fem_known_free(struct gn_fem_known *known);

/* Of the pressure form (linear_pressure.c): operator and metric over M^1/2 u and q,
 * [nodes][dimension] and [nodes]. */
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
