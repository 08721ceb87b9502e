/* Search for positions where a new particle touches nothing. */
#ifndef GN_INFLOW_FREE_SPACE_H
#define GN_INFLOW_FREE_SPACE_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_room {
    const gn_step_context *ctx;
    const gn_dem *dem;
    const gn_boundary *boundary;
    size_t count, space;
    double *sphere;  /* [count][4] particles around the box, and their images */
    double most;     /* m, the largest of their radii */
    double lower[3]; /* m, corner of the first cell */
    double cell;     /* m, size of a cell */
    int64_t cells[3];
    int32_t *first, *next; /* [cells] first sphere of a cell, [space] next sphere of the same cell;
                              -1: no more */
} gn_room;

/* Prepares a search for centres in the box, of spheres with radii up to `radius`. */
gneiss_status gn_room_open(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const double lower[3],
                           const double upper[3], double radius, gn_room *room,
                           gneiss_error *error);
void gn_room_close(gn_room *room);

/* Tells whether a sphere touches no particle and no surface, and is on the side of all walls on
 * which particles are. */
bool gn_room_free(const gn_room *room, const double sphere[4]);
/* Marks a position as occupied. */
gneiss_status gn_room_take(gn_room *room, const double sphere[4], gneiss_error *error);

#endif
