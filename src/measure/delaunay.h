/* Delaunay triangulation and convex hull by Qhull (Barber, Dobkin and Huhdanpaa 1996). */
#ifndef GN_MEASURE_DELAUNAY_H
#define GN_MEASURE_DELAUNAY_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Simplices in the order of Qhull, which depends on the order of the points alone. All have the
 * same orientation, so that neighbours see their common face from opposite sides. Points on a
 * common sphere (lattices) also give simplices without volume, which keep the triangulation closed.
 */
typedef struct gn_triangulation {
    int dimension;
    size_t count;
    int32_t *vertex; /* [count][dimension + 1] indices of points; gn_alloc'ed */
} gn_triangulation;

/* Triangulates `points` [count][dimension], finite. If there are fewer than dimension + 1 points,
 * or all lie on a plane (2D: a line) within 1e-9 of their extent: no simplices and GNEISS_OK. */
gneiss_status gn_delaunay(const double *points, size_t count, int dimension,
                          gn_triangulation *triangulation, gneiss_error *error);
void gn_triangulation_free(gn_triangulation *triangulation);

/* Computes the faces of the convex hull (2D: edges), [count][dimension] corners each, in no
 * particular order, provided that they certainly are the outside of the triangulation: within 1e-9
 * of the extent, no other point lies on a face, and no two faces lie in a plane. Otherwise, as for
 * lattices, count is 0 with GNEISS_OK. For 1e5 points this is some ten times as fast as a
 * triangulation. `volume` is that of the hull. */
gneiss_status gn_hull_faces(const double *points, size_t count, int dimension,
                            gn_triangulation *faces, double *volume, gneiss_error *error);

/* Computes the volume (2D: area) and surface (2D: length) of the hull from any triangles (2D:
 * edges) that cover it. */
gneiss_status gn_hull_measure(const double *points, size_t count, int dimension,
                              gn_triangulation *faces, double *volume, double *surface,
                              gneiss_error *error);

/* Computes any triangles (2D: edges) that cover the hull. */
gneiss_status gn_hull_triangles(const double *points, size_t count, int dimension,
                                gn_triangulation *faces, gneiss_error *error);

/* Computes the volume (area) of the convex hull; 0 if gn_delaunay finds no simplices. */
gneiss_status gn_hull_volume(const double *points, size_t count, int dimension, double *volume,
                             gneiss_error *error);

#endif
