/* Cells in rows, columns and layers, split into triangles or tetrahedra: the basis of built-in
 * meshes. */
#ifndef GN_FEM_GRID_H
#define GN_FEM_GRID_H

#include "fem/structured.h"

#include <stdbool.h>
#include <stddef.h>

/* Tags of groups; sides are 2 k + upper above the first. */
enum { GN_GRID_BODY = 1, GN_GRID_SIDE = 2, GN_GRID_HOLE = 8, GN_GRID_GROUPS_MAX = 16 };

typedef struct gn_grid {
    int dimension;
    size_t nodes[3];                     /* per direction; 1 along z in 2D */
    size_t hole_lower[3], hole_upper[3]; /* cells [lower, upper) are left out */
    bool parallel;                       /* all diagonals have one direction */
    size_t turn; /* parallel: cells from here on along x are mirrored; 0: none */
} gn_grid;

/* Allocates the nodes, elements, sides and groups of the grid. On failure *mesh is empty. */
gneiss_status gn_grid_allocate(const gn_grid *grid, gn_mesh *mesh, gneiss_error *error);
/* Fills in elements and facets; nodes inside the hole are not used. */
void gn_grid_fill(const gn_grid *grid, gn_mesh *mesh);
/* Names the groups "x_lower" ... and "body". */
void gn_grid_name_groups(const gn_grid *grid, gn_mesh *mesh);

#endif
