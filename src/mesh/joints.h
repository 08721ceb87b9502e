/* Tells whether the elements of a mesh are there once and joined. */
#ifndef GN_MESH_JOINTS_H
#define GN_MESH_JOINTS_H

#include "mesh/mesh.h"

/* What may be meant, and is worth a word. Places in m, relative to the origin of the mesh. */
typedef struct gn_mesh_joints {
    size_t elements;
    size_t parts;       /* of elements that share nodes with each other */
    size_t least;       /* elements of the smallest part */
    double least_at[3]; /* a node of it */
    size_t together;    /* places where two nodes of one part lie: not joined there */
    double together_at[3];
    size_t hanging; /* nodes on a side of an element of their part that does not have them */
    double hanging_at[3];
} gn_mesh_joints;

/* Looks at the elements of the highest dimension (2: triangles, 3: tetrahedra), in n log n.
 * GNEISS_ERROR_INPUT, with a count and the first place: elements that are there twice; more than
 * one element on a side of a face; elements that lie over each other; parts that touch without
 * sharing the nodes (their nodes are at one place, or on a side of an element of the other part).
 * `origin`: of the places, for messages. */
gneiss_status gn_mesh_check_joints(const gn_mesh *mesh, int dimension, const double origin[3],
                                   const char *name, gn_mesh_joints *joints, gneiss_error *error);

/* The same of elements that are there twice or lie over each other alone: for bodies that are
 * filled with particles, whose parts may touch. */
gneiss_status gn_mesh_check_overlap(const gn_mesh *mesh, int dimension, const double origin[3],
                                    const char *name, gneiss_error *error);

#endif
