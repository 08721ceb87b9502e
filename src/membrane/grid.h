/* Particles of a membrane's specimen by where they were at the start. */
#ifndef GN_MEMBRANE_GRID_H
#define GN_MEMBRANE_GRID_H

#include "base/error.h"
#include "frame/parts.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stdint.h>

/* Particles by cells of a grid: those of cell k are item[first[k] .. first[k + 1]). */
typedef struct gn_start_grid {
    const gn_particles *particles;
    double lower[3], cell, radius_max;
    int64_t n[3];
    int32_t *first, *item;
} gn_start_grid;

/* Of all particles p, or of those of which of[p]. */
gneiss_status gn_start_grid_make(const gn_step_context *ctx, const gn_dem *dem, double cell,
                                 const bool *of, gn_start_grid *grid, gneiss_error *error);
void gn_start_grid_free(gn_start_grid *grid);

/* The particle whose surface was nearest to x, of two alike that of the smaller id; -1: none. With
 * `along`, a vector, what lies along it from x: ways across count four times. */
int32_t gn_start_grid_nearest(const gn_start_grid *grid, const double x[3], const double *along);

/* Calls with every particle of the cells within `reach` of x along each axis. */
void gn_start_grid_visit(const gn_start_grid *grid, const double x[3], double reach,
                         void (*see)(void *context, int32_t particle), void *context);

#endif
