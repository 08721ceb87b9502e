/* Delaunay triangulation and convex hull by Qhull (Barber, Dobkin and Huhdanpaa 1996). */
#ifndef GN_MEASURE_DELAUNAY_H
#define GN_MEASURE_DELAUNAY_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Simplices in the order of Qhull, which depends on the order of the points alone. Neighbours are
 * turned the same way round: a face shared by two of them is seen from opposite sides. Points that
 * lie on a common sphere (lattices) give simplices without volume as well; they keep the
 * triangulation closed. */
typedef struct gn_triangulation {
    int dimension;
    size_t count;
    int32_t *vertex; /* [count][dimension + 1] places in the list of points; gn_alloc'ed */
} gn_triangulation;

/* `points` [count][dimension], finite. Fewer than dimension + 1 points, or all on a plane (2D: a
 * line) to within 1e-9 of their extent: no simplices and GNEISS_OK. */
gneiss_status gn_delaunay(const double *points, size_t count, int dimension,
                          gn_triangulation *triangulation, gneiss_error *error);
void gn_triangulation_free(gn_triangulation *triangulation);

/* The faces of the convex hull (2D: edges), [count][dimension] corners each, in no order, where
 * they are the outside of the triangulation beyond doubt: none of the other points lies on one, and
 * no two of them in a plane, to within 1e-9 of the extent. Else, as for lattices, count 0 and
 * GNEISS_OK. Some ten times as fast as a triangulation of 1e5 points. `volume`: of the hull. */
gneiss_status gn_hull_faces(const double *points, size_t count, int dimension,
                            gn_triangulation *faces, double *volume, gneiss_error *error);

/* Any triangles (2D: edges) that cover the hull, with its volume (2D: area) and surface (2D:
 * length); as gn_hull_triangles, which has the faces alone. */
gneiss_status gn_hull_measure(const double *points, size_t count, int dimension,
                              gn_triangulation *faces, double *volume, double *surface,
                              gneiss_error *error);

/* Any triangles (2D: edges) that cover the hull; as above. */
gneiss_status gn_hull_triangles(const double *points, size_t count, int dimension,
                                gn_triangulation *faces, gneiss_error *error);

/* Volume (area) of the convex hull; 0 where gn_delaunay gives no simplices. */
gneiss_status gn_hull_volume(const double *points, size_t count, int dimension, double *volume,
                             gneiss_error *error);

#endif
