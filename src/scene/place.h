/* Positions in a scene file. */
#ifndef GN_SCENE_PLACE_H
#define GN_SCENE_PLACE_H

/* Position of a value in the scene file, for messages after parsing. Line 0: not in a file. */
typedef struct gn_scene_place {
    int line, column; /* base 1 */
} gn_scene_place;

#endif
