/* Definitions of rigid clumps of particles. */
#ifndef GN_SCENE_CLUMP_DEF_H
#define GN_SCENE_CLUMP_DEF_H

#include "scene/place.h"
#include "scene/values.h"

/* A shape of clumps: rows of spheres, or a closed surface that is filled with a number of them. */
typedef struct gn_clump_shape_def {
    char name[GN_NAME_SIZE], material[GN_NAME_SIZE];
    size_t sphere_count;
    double *spheres; /* [sphere_count][4]: x y z r, m (2D: x y 0 r), in the frame of the shape */
    int64_t fill;    /* number of spheres in the surface */
    char surface[GN_PATH_SIZE], surface_path[GN_PATH_SIZE]; /* as written ("": none), resolved */
    double scale; /* factor by which lengths of rows or surface are multiplied to give metres */
    gn_scene_place where;
} gn_clump_shape_def;

/* A single clump. */
typedef struct gn_placed_clump_def {
    char shape[GN_NAME_SIZE];
    bool has_rotation, has_spin;
    double centre[3];            /* m, of mass */
    double rotation[3];          /* rad, rotation vector from the frame of the shape */
    double velocity[3], spin[3]; /* m/s, rad/s */
    gn_scene_place where;
} gn_placed_clump_def;

/* A box that is filled with clumps at random positions, with random orientations. */
typedef struct gn_filled_clumps_def {
    size_t shape_count;
    char (*shapes)[GN_NAME_SIZE];  /* [shape_count], drawn with equal probability */
    double box_min[3], box_max[3]; /* m, box that contains all spheres */
    int64_t count;
    double velocity[3]; /* m/s */
    gn_scene_place where;
} gn_filled_clumps_def;

typedef struct gn_clumps_def {
    size_t shape_count, placed_count, filled_count;
    gn_clump_shape_def *shapes;
    gn_placed_clump_def *placed;
    gn_filled_clumps_def *filled;
    char file[GN_PATH_SIZE], path[GN_PATH_SIZE]; /* as written ("": none), resolved */
    gn_scene_place where;
} gn_clumps_def;

#endif
