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

static inline gn_mesh_elements *gn_fem_elements_of(gn_mesh *mesh, int dimension) {
    return dimension == 3 ? &mesh->tetrahedra : dimension == 2 ? &mesh->triangles : &mesh->lines;
}
static inline const char *gn_fem_kind(int dimension) {
    return dimension == 3 ? "tetrahedron" : dimension == 2 ? "triangle" : "line";
}

#endif
