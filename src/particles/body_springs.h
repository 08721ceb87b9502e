/* Springs of rigid bodies in contact with plane walls and with each other: the springs of both
 * sides in series, normal and tangential. Under Hertz's law, where walls and bodies have materials
 * or are rigid, a body may have an additional stiffness for these contacts; without one it is rigid
 * in them. */
#ifndef GN_PARTICLES_BODY_SPRINGS_H
#define GN_PARTICLES_BODY_SPRINGS_H

#include "kernels/law.h"
#include "scene/scene.h"

#include <stddef.h>

/* Walls and bodies are numbered consecutively, as in gn_scene_surface_at. */
typedef struct gn_body_spring {
    gn_touch_side side; /* stiffness 0: they have no contact; kratio 0: no tangential spring */
    double damping;     /* fraction of the critical damping, of dashpots */
} gn_body_spring;
gn_body_spring gn_body_spring_of(const gn_scene *scene, size_t place, size_t other);

/* Returns the largest damping fraction of these contacts. */
double gn_body_damping_most(const gn_scene *scene);

#endif
