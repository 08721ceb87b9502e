/* Objects other than particles that particles touch, and the kinds of contacts. */
#ifndef GN_SCENE_SIDES_H
#define GN_SCENE_SIDES_H

#include "scene/scene.h"

/* gn_scene_hertz: true if stiffness follows from the overlap (Hertz-Mindlin); gn_scene_has_rolling:
 * true if any contact resists rolling or twisting. */
static inline bool gn_scene_hertz(const gn_scene *scene) {
    return scene->stiffness == GN_STIFFNESS_HERTZ;
}
bool gn_scene_has_rolling(const gn_scene *scene);
/* Tells whether surfaces have a work of adhesion. */
static inline bool gn_scene_adheres(const gn_scene *scene) {
    return scene->cohesion == GN_COHESION_JKR || scene->cohesion == GN_COHESION_DMT;
}

/* A wall, body or the surface of finite elements, by a running index. */
typedef struct gn_scene_surface {
    const char *material; /* "": none */
    double friction, rolling, twisting;
} gn_scene_surface;
gn_scene_surface gn_scene_surface_at(const gn_scene *scene, size_t place);
static inline size_t gn_scene_sides(const gn_scene *scene) {
    return scene->wall_count + scene->body_count + 1;
}

#endif
