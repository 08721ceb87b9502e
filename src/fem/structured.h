/* Built-in meshes of boxes and rectangles. */
#ifndef GN_FEM_STRUCTURED_H
#define GN_FEM_STRUCTURED_H

#include "mesh/mesh.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct gn_structured {
    double lower[3], size[3]; /* m; in 2D the plane is z = 0 */
    int32_t cells[3];         /* number of cells per direction, > 0 */
    /* random displacement of nodes as a fraction of a cell's sides, < 1/4 in 2D, < 1/6 in 3D, so
     * that no element inverts; nodes on the boundary move along it. 0: none */
    double distortion;
    uint64_t seed; /* seed of the distortion */
    bool parallel; /* the diagonals of all cells have the same direction */
} gn_structured;

/* Makes a mesh of cells that are split into two triangles (five tetrahedra). The split is mirrored
 * from cell to cell like a chess-board, so that no direction is preferred; masses of inner nodes
 * differ by 2 : 1 (5 : 1). With `parallel`, cells are split into two triangles (six tetrahedra)
 * around the diagonal from the lower to the upper corner (Kuhn 1960), so that all inner nodes have
 * the same mass. Groups: "body" and, per side, "x_lower", "x_upper", "y_lower", ... of lines
 * (triangles). On failure *mesh is empty. */
gneiss_status gn_mesh_rectangle(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error);
gneiss_status gn_mesh_box(const gn_structured *spec, gn_mesh *mesh, gneiss_error *error);

/* A beam along x for bending, supported from below at both ends of the span and loaded from above
 * at mid-span, with a notch at mid-span that is cut from below. */
typedef struct gn_structured_beam {
    double lower[3];
    double length, height, thickness; /* m; thickness 0: 2D */
    double span;                      /* m, between the supports, <= length */
    double notch_width, notch_depth;  /* m; depth 0: none */
    double cell;                      /* m, largest side of a cell */
    int64_t notch_cells;              /* cells across half the width of the notch, > 0 */
    double growth; /* ratio by which cell sides grow away from the tip of the notch, > 1 */
    bool parallel; /* diagonals have one direction in each half */
} gn_structured_beam;

/* Makes a mesh of such cells, symmetric about mid-span (parallel diagonals are mirrored there, and
 * masses stay equal), graded along x and y from the tip of the notch. Groups are those of
 * gn_mesh_rectangle and "notch" (its faces); further groups, of points in 2D and of lines along z
 * in 3D, are "support_left", "support_right", "supports" (both), "load" and, with a notch,
 * "mouth_left", "mouth_right". On failure *mesh is empty. */
gneiss_status gn_mesh_beam(const gn_structured_beam *spec, gn_mesh *mesh, gneiss_error *error);

#endif
