/* Pieces of a body that its own files share. */
#ifndef GN_FEM_PARTS_H
#define GN_FEM_PARTS_H

#include "fem/body.h"

/* The group called `name`, or with that number; NULL when the mesh has none of `dimension` (-1: of
 * any). */
const gn_mesh_group *gn_fem_find_group(const gn_mesh *mesh, const char *name, int dimension);
gneiss_status gn_fem_no_group(const char *mesh_name, const gn_mesh *mesh, const char *name,
                              int dimension, gneiss_error *error);

/* in[element]: whether an element belongs to a group; elements of one kind. */
void gn_fem_mark_group(const gn_mesh_elements *list, int32_t tag, uint8_t *in);

/* F of an element at the present positions, and its determinant; plane strain has F_zz = 1
 * (stress.c). */
double gn_fem_deformation(const gn_fem_body *body, size_t element, double f[3][3]);

/* m2 of a facet at the start; of a line 1 m thick (loads.c). */
double gn_fem_facet_area(const gn_fem_body *body, const int32_t *node);

static inline gn_mesh_elements *gn_fem_elements_of(gn_mesh *mesh, int dimension) {
    gn_mesh_elements *lists[] = {&mesh->points, &mesh->lines, &mesh->triangles, &mesh->tetrahedra};
    return lists[dimension];
}
static inline const char *gn_fem_kind(int dimension) {
    static const char *const names[] = {"point", "line", "triangle", "tetrahedron"};
    return names[dimension];
}

#endif
