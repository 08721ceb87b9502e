/* Overlaps of particles with walls and surfaces, for `gneiss check` and for warnings at the start
 * of a run; and surfaces of bodies that intersect themselves. */
#ifndef GN_BOUNDARY_OVERLAP_H
#define GN_BOUNDARY_OVERLAP_H

#include "base/error.h"
#include "frame/parts.h"
#include "scene/scene.h"
#include "surfaces/body_shape.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_overlap {
    size_t touching; /* number of particles that overlap */
    double deepest;  /* m */
    size_t inside; /* number of particles with their centre inside (or behind a wall); 0 for an open
                      surface */
} gn_overlap;

/* Finds the overlap of every surface at the present positions: overlap [surfaces]. */
gneiss_status gn_boundary_overlaps(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, gn_overlap *overlap,
                                   gneiss_error *error);
/* Counts the particles whose centre is inside a body with a closed surface; *first: the first of
 * them. */
gneiss_status gn_body_holds(const gn_dem *dem, const gn_boundary *boundary, size_t body,
                            size_t *count, size_t *first, gneiss_error *error);
/* Returns the overlap of particles with a wall. */
gn_overlap gn_wall_overlap(const gn_dem *dem, const gn_boundary *boundary, size_t wall);
/* Tells whether a wall, a body or elements, other than the ends of the test, overlap particles at
 * the start under a stress that nothing inside the specimen balances; `text` then says which.
 * `overlap`: from gn_boundary_overlaps. */
bool gn_overlap_bursts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_periodic_box *box, const gn_overlap *overlap, char *text,
                       size_t size);

/* Returns GNEISS_ERROR_INPUT, with the place, if the surface of a body intersects itself although
 * the body's mass follows from it (gn_body_mass_is_from_surface). The surfaces of other bodies may
 * do so. */
gneiss_status gn_body_check_cuts(const gn_scene *scene, size_t index, const gn_body_shape *shape,
                                 gneiss_error *error);

/* Returns the number of closed parts of the surface of such a body that lie inside other parts and
 * count as cavities, whatever the direction of their normals in the file. The file is read again; 0
 * also if it cannot be read. */
size_t gn_body_cavities(const gn_scene *scene, size_t index);

#endif
