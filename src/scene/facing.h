/* Walls that face each other (facing.c). */
#ifndef GN_SCENE_FACING_H
#define GN_SCENE_FACING_H

#include "scene/scene.h"

/* Pairs of walls whose distances span the section of a wall. */
typedef struct gn_facing {
    size_t count; /* 1 in 2D, 2 in 3D */
    size_t pair[2][2];
} gn_facing;

/* True if the wall stands across the open axis of a periodic box and so closes the box. */
bool gn_wall_covers_open_axis(const gn_scene *scene, size_t wall);

/* Finds the first such pairs in the scene; false: there are none. */
bool gn_facing_find(const gn_scene *scene, size_t wall, gn_facing *facing);

#endif
