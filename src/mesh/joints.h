/* Checks that the elements of a mesh are unique and connected. */
#ifndef GN_MESH_JOINTS_H
#define GN_MESH_JOINTS_H

#include "mesh/mesh.h"

/* Findings that may be intended and are only reported. Positions are in m, relative to the origin
 * of the mesh. */
typedef struct gn_mesh_joints {
    size_t elements;
    size_t parts;       /* groups of elements connected by shared nodes */
    size_t least;       /* number of elements of the smallest part */
    double least_at[3]; /* position of a node of the smallest part */
    size_t together;    /* number of positions with two nodes of one part, which are not connected
                           there */
    double together_at[3];
    size_t hanging; /* number of nodes on a side of an element of their part that is not connected
                       to them */
    double hanging_at[3];
} gn_mesh_joints;

/* Checks the elements of the highest dimension (2: triangles, 3: tetrahedra), in n log n.
 * GNEISS_ERROR_INPUT, with a count and the first position: duplicate elements; more than one
 * element on one side of a face; overlapping elements; parts that touch without shared nodes (their
 * nodes coincide, or lie on a side of an element of the other part). `origin`: origin of positions
 * in messages. */
gneiss_status gn_mesh_check_joints(const gn_mesh *mesh, int dimension, const double origin[3],
                                   const char *name, gn_mesh_joints *joints, gneiss_error *error);

/* Checks for duplicate and overlapping elements only, in bodies that are filled with particles,
 * whose parts may touch. */
gneiss_status gn_mesh_check_overlap(const gn_mesh *mesh, int dimension, const double origin[3],
                                    const char *name, gneiss_error *error);

#endif
