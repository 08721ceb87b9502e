/* The cell of a particle at the start: the points that were nearer to its surface than to that of
 * any other particle, found by voxels. Voxel faces are parallel to the axes, but only their vector
 * sum is used, which for a part of any surface depends on the edge of the part alone. */
#ifndef GN_MEMBRANE_CELLS_H
#define GN_MEMBRANE_CELLS_H

#include "base/error.h"
#include "frame/parts.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Particles by cells of a grid: those of cell k are item[first[k] .. first[k + 1]). */
typedef struct gn_start_grid {
    const gn_particles *particles;
    double lower[3], cell, radius_max;
    int64_t n[3];
    int32_t *first, *item;
} gn_start_grid;

/* Makes the grid of the particles p for which of[p] is true; with NULL, of all particles. */
gneiss_status gn_start_grid_make(const gn_step_context *ctx, const gn_dem *dem, double cell,
                                 const bool *of, gn_start_grid *grid, gneiss_error *error);
void gn_start_grid_free(gn_start_grid *grid);

/* Returns the particle whose surface was nearest to x; of two at equal distance, that with the
 * smaller id; -1: none. With a vector `along`, distances across it count four times. */
int32_t gn_start_grid_nearest(const gn_start_grid *grid, const double x[3], const double *along);

/* Calls a function for every particle in the cells within `reach` of x along each axis. */
void gn_start_grid_visit(const gn_start_grid *grid, const double x[3], double reach,
                         void (*see)(void *context, int32_t particle), void *context);

/* A face between two cells. */
typedef struct gn_cell_face {
    int32_t particle; /* neighbour on its other side */
    double area[3];   /* m2, out of the cell; 2D: 1 m thick */
    double point[3];  /* m, middle of the face */
    double sum;       /* m2, sum of the areas of its voxel faces; 0: it is empty */
} gn_cell_face;

typedef struct gn_cell {
    const gn_start_grid *all; /* grid with every particle */
    double around; /* m: largest distance from the surface of the particle at which points of its
                      cell are sought */
    double width;  /* m, size of the voxels of small particles */
    size_t count, capacity; /* of `face` */
    gn_cell_face *face;
    size_t voxels;
    int32_t *owner; /* [voxels] index in `face`, or one of the values below */
} gn_cell;
enum { GN_CELL_OWN = -1, GN_CELL_OUTSIDE = -2 };

/* Finds the faces of the cell of a particle, clipped by planes, which are rows of an outward normal
 * and the offset along it. The memory of *cell is reused. */
gneiss_status gn_cell_find(gn_cell *cell, int dimension, size_t particle, size_t plane_count,
                           const double (*plane)[4], gneiss_error *error);
void gn_cell_free(gn_cell *cell);

#endif
