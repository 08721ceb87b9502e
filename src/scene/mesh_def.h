/* Definitions of built-in meshes. */
#ifndef GN_SCENE_MESH_DEF_H
#define GN_SCENE_MESH_DEF_H

#include <stdint.h>

typedef enum gn_diagonals { GN_DIAGONALS_ALTERNATING, GN_DIAGONALS_PARALLEL } gn_diagonals;

/* A beam with supports below, a load above mid-span and a notch below mid-span. */
typedef struct gn_beam_def {
    double length, height, thickness; /* m; thickness 0 in 2D */
    double span;                      /* m between the supports; 0: the length */
    double notch_width, notch_depth;  /* m; depth 0: no notch */
    double cell;                      /* m, largest side of a cell */
    int64_t notch_cells;              /* number of cells across half the width of the notch */
    double growth;    /* ratio of the sizes of successive cells away from the notch */
    double origin[3]; /* m, lower corner */
    gn_diagonals diagonals;
} gn_beam_def;

#endif
