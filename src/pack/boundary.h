/* The boundary of a shape in small pieces. */
#ifndef GN_PACK_BOUNDARY_H
#define GN_PACK_BOUNDARY_H

#include "scene/scene.h"

typedef struct gn_piece_of_boundary {
    double point[3];
    double area[3]; /* m2, along the outward normal; 2D: 1 m thick */
} gn_piece_of_boundary;

typedef struct gn_boundary_pieces {
    size_t count, capacity;
    gn_piece_of_boundary *piece; /* gn_alloc'ed */
} gn_boundary_pieces;

/* Cuts the boundary of scene->specimen.pack into pieces of about `size` m. Their areas add up to
 * that of the boundary: exactly if it is flat or a circle, and for a file to that of its facets. */
gneiss_status gn_boundary_pieces_make(const gn_scene *scene, double size,
                                      gn_boundary_pieces *pieces, gneiss_error *error);
void gn_boundary_pieces_free(gn_boundary_pieces *pieces);

#endif
