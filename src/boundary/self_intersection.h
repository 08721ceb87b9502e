#ifndef GN_BOUNDARY_SELF_INTERSECTION_H
#define GN_BOUNDARY_SELF_INTERSECTION_H

#include "base/error.h"
#include "scene/scene.h"
#include "surfaces/body_shape.h"

#include <stddef.h>

/* GNEISS_ERROR_INPUT where the surface of a body that is weighed (gn_body_mass_is_from_surface)
 * cuts itself, with the place. Bodies for contact alone may. */
gneiss_status gn_body_check_cuts(const gn_scene *scene, size_t index, const gn_body_shape *shape,
                                 gneiss_error *error);

/* Closed parts of the surface of a weighed body that lie in others and count as cavities, whichever
 * way their normals point in the file, which is read anew; 0 also where it cannot be read. */
size_t gn_body_cavities(const gn_scene *scene, size_t index);

#endif
