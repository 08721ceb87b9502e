/* Meshes: gmsh .msh 2.0 to 4.1 (text and binary); STL, PLY (text and binary) and OBJ as welded
 * triangles. */
#ifndef GN_MESH_MESH_H
#define GN_MESH_MESH_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_MESH_NAME_SIZE = 64, GN_MESH_CHANGES_SIZE = 400 };

/* A physical group: `tag` > 0 as in the file, `name` "" if it has none. */
typedef struct gn_mesh_group {
    int dimension; /* dimension of its elements: 0, 1, 2, 3 */
    int32_t tag;
    char name[GN_MESH_NAME_SIZE];
} gn_mesh_group;

/* Membership of an element in a further group, beside gn_mesh_elements.group. */
typedef struct gn_mesh_membership {
    size_t element;
    int32_t group;
} gn_mesh_membership;

/* Elements of one kind: node indices from 0, in the file's order. */
typedef struct gn_mesh_elements {
    size_t count;
    int nodes;      /* number of nodes per element: 1 point, 2 line, 3 triangle, 4 tetrahedron */
    int32_t *node;  /* [count][nodes]; gn_alloc'ed, as all below */
    int32_t *group; /* [count] tag of the first physical group, 0: none */
    size_t also_count;
    gn_mesh_membership *also; /* further groups, sorted by element; NULL if there are none */
} gn_mesh_elements;

/* Numbers of elements of a file that became others, and of nodes that were dropped. */
typedef struct gn_mesh_changes {
    size_t split[4];     /* quadrangles, hexahedra, prisms, pyramids */
    size_t polygons;     /* faces of a surface with more than three corners */
    size_t higher_order; /* elements of which only the corners are used */
    size_t nodes;        /* nodes between these corners, which are left out */
    size_t degenerate;   /* triangles without area */
} gn_mesh_changes;

typedef struct gn_mesh {
    size_t node_count;
    double *node;            /* [node_count][3], m; gn_alloc'ed */
    gn_mesh_elements points; /* only points that belong to groups */
    gn_mesh_elements lines, triangles, tetrahedra;
    size_t group_count;
    gn_mesh_group *groups; /* groups by dimension, then tag; gn_alloc'ed */
    size_t cavities;       /* found by gn_mesh_close_surface */
    gn_mesh_changes changes;
} gn_mesh;

/* Writes what became of elements as a sentence; returns false if nothing was changed. */
bool gn_mesh_changed(const gn_mesh *mesh, char *text, size_t size);

/* Reads a gmsh .msh file of format 2.0 to 2.2, 4.0 or 4.1, text or binary, in one part or
 * partitioned. Lines, triangles and tetrahedra are kept, points if they belong to a group.
 * Quadrangles, hexahedra, prisms and pyramids are split by the diagonals from their node that comes
 * first in the file, so that neighbours fit. Of elements of higher order the corners are used.
 * Other types are refused. `changes` counts all that. Elements that are repeated for a further
 * group become one with all its groups; a solid element that is merely repeated is kept twice.
 * Nodes that no element uses are kept. `scale` multiplies coordinates. A negative physical tag
 * (reversed orientation) reverses the element and is stored positive, so that both formats of one
 * mesh read alike. Unknown sections are skipped. All errors of content are GNEISS_ERROR_INPUT with
 * file:line:column (text) or file, section and byte (binary): expected, found. On failure *mesh is
 * empty. */
gneiss_status gn_mesh_read_msh(const char *path, double scale, gn_mesh *mesh, gneiss_error *error);

/* Reads a surface into nodes and triangles: STL or PLY, text or binary, or OBJ (by its ending).
 * Faces with more than three corners are divided from one of them. Corners closer than 1e-6 of the
 * surface's extent (longest side of its box) are welded to the first of them (grid hash, so that
 * the time is linear); triangles that become degenerate by that are dropped. The file's normals are
 * not used. Errors are those of gn_mesh_read_msh. */
gneiss_status gn_mesh_read_surface(const char *path, double scale, gn_mesh *mesh,
                                   gneiss_error *error);

/* Checks that the triangles are a closed surface (every edge in exactly two triangles), orients all
 * of them with their normals outward, and computes the enclosed volume, m3. There may be several
 * bodies and cavities: a component inside an odd number of others bounds a cavity, and its normals
 * point into the cavity. GNEISS_ERROR_INPUT gives the coordinates of the first edge in one or more
 * than two triangles, and the number of such edges. `name`: of the mesh, for messages. Intersecting
 * surfaces are not detected. */
gneiss_status gn_mesh_close_surface(gn_mesh *mesh, const char *name, double *volume,
                                    gneiss_error *error);

/* Computes the boundary of the tetrahedra as triangles with outward normals (3D), or of the
 * triangles as lines with the domain on their left (2D, all z equal), and replaces `triangles`
 * (`lines`) by it. A boundary face that was among those keeps its groups. Inverted elements are
 * reversed. GNEISS_ERROR_INPUT if there are no such elements, one has no volume, a face belongs to
 * more than two elements, or two elements are on the same side of a face; *mesh then keeps its
 * faces. */
gneiss_status gn_mesh_boundary(gn_mesh *mesh, int dimension, const char *name, gneiss_error *error);

void gn_mesh_free(gn_mesh *mesh);

#endif
