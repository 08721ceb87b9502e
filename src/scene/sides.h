/* What particles touch besides each other, and which contacts there are. */
#ifndef GN_SCENE_SIDES_H
#define GN_SCENE_SIDES_H

#include "scene/scene.h"

/* Whether stiffness follows from the overlap (Hertz-Mindlin); whether any contact resists rolling
 * or twisting. */
static inline bool gn_scene_hertz(const gn_scene *scene) {
    return scene->stiffness == GN_STIFFNESS_HERTZ;
}
bool gn_scene_rolls(const gn_scene *scene);

/* Walls, bodies, finite elements, counted through. */
typedef struct gn_scene_surface {
    const char *material; /* "": none */
    double friction, rolling, twisting;
} gn_scene_surface;
gn_scene_surface gn_scene_side(const gn_scene *scene, size_t place);
static inline size_t gn_scene_sides(const gn_scene *scene) {
    return scene->wall_count + scene->body_count + 1;
}

#endif
