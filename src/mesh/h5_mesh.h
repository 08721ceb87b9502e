/* Meshes in HDF5 files. */
#ifndef GN_MESH_H5_MESH_H
#define GN_MESH_H5_MESH_H

#include "io/h5.h"
#include "mesh/mesh.h"

/* Writes nodes, elements and groups of a mesh under group `name`. */
gneiss_status gn_h5_put_mesh(gn_h5 *file, const char *name, const gn_mesh *from,
                             gneiss_error *error);
/* Reads a mesh written by gn_h5_put_mesh and checks its indices. On failure *mesh is empty. */
gneiss_status gn_h5_get_mesh(const gn_h5 *file, const char *name, gn_mesh *mesh,
                             gneiss_error *error);

#endif
