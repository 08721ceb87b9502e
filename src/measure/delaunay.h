/* Delaunay triangulation and convex hull by Qhull (Barber, Dobkin and Huhdanpaa 1996). */
#ifndef GN_MEASURE_DELAUNAY_H
#define GN_MEASURE_DELAUNAY_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Simplices in the order of Qhull, which depends on the order of the points alone. Neighbours have
 * the same orientation: a common face is seen from opposite sides. Points on a common sphere
 * (lattices) give simplices without volume as well; they keep the triangulation closed. */
typedef struct gn_triangulation {
    int dimension;
    size_t count;
    int32_t *vertex; /* [count][dimension + 1] indices of points; gn_alloc'ed */
} gn_triangulation;

/* Triangulates `points` [count][dimension], finite. Fewer than dimension + 1 points, or all on a
 * plane (2D: a line) within 1e-9 of their extent: no simplices and GNEISS_OK. */
gneiss_status gn_delaunay(const double *points, size_t count, int dimension,
                          gn_triangulation *triangulation, gneiss_error *error);
void gn_triangulation_free(gn_triangulation *triangulation);

/* Computes the faces of the convex hull (2D: edges), [count][dimension] corners each, in no order,
 * if they are certainly the outside of the triangulation: no other point lies on one, and no two of
 * them in a plane, within 1e-9 of the extent. Otherwise, as for lattices, count is 0 with
 * GNEISS_OK. It is some ten times as fast as a triangulation of 1e5 points. `volume` is that of the
 * hull. */
gneiss_status gn_hull_faces(const double *points, size_t count, int dimension,
                            gn_triangulation *faces, double *volume, gneiss_error *error);

/* Computes any triangles (2D: edges) that cover the hull, with its volume (2D: area) and surface
 * (2D: length). */
gneiss_status gn_hull_measure(const double *points, size_t count, int dimension,
                              gn_triangulation *faces, double *volume, double *surface,
                              gneiss_error *error);

/* Computes any triangles (2D: edges) that cover the hull. */
gneiss_status gn_hull_triangles(const double *points, size_t count, int dimension,
                                gn_triangulation *faces, gneiss_error *error);

/* Computes the volume (area) of the convex hull; 0 if gn_delaunay gives no simplices. */
gneiss_status gn_hull_volume(const double *points, size_t count, int dimension, double *volume,
                             gneiss_error *error);

#endif
