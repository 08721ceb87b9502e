/* Checks that the elements of a mesh are unique and connected. */
#ifndef GN_MESH_JOINTS_H
#define GN_MESH_JOINTS_H

#include "mesh/mesh.h"

/* Findings that may be intended and are reported. Positions in m, relative to the origin of the
 * mesh. */
typedef struct gn_mesh_joints {
    size_t elements;
    size_t parts;       /* groups of elements connected by shared nodes */
    size_t least;       /* elements of the smallest part */
    double least_at[3]; /* a node of the smallest part */
    size_t together;    /* positions with two nodes of one part, which are unconnected */
    double together_at[3];
    size_t hanging; /* nodes on a side of an element of their part that is not among its nodes */
    double hanging_at[3];
} gn_mesh_joints;

/* Checks the elements of the highest dimension (2: triangles, 3: tetrahedra), in n log n.
 * GNEISS_ERROR_INPUT, with a count and the first position: duplicate elements; more than one
 * element on a side of a face; overlapping elements; parts that touch without shared nodes (their
 * nodes coincide, or lie on a side of an element of the other part). `origin` is that of positions
 * in messages. */
gneiss_status gn_mesh_check_joints(const gn_mesh *mesh, int dimension, const double origin[3],
                                   const char *name, gn_mesh_joints *joints, gneiss_error *error);

/* Checks only for duplicate and overlapping elements: for bodies that are filled with particles,
 * whose parts may touch. */
gneiss_status gn_mesh_check_overlap(const gn_mesh *mesh, int dimension, const double origin[3],
                                    const char *name, gneiss_error *error);

#endif
