/* What of a scene moves or loads a specimen, and what holds it (acts.c). */
#ifndef GN_SCENE_ACTS_H
#define GN_SCENE_ACTS_H

#include "scene/scene.h"

/* Whether a value of it is other than 0. */
bool gn_table_acts(const gn_table *table);

/* Whether a specimen that is at rest may be pressed: a membrane, a servo, sides, walls, sets,
 * bodies or elements that move or are loaded. Gravity is not looked at. */
bool gn_scene_presses(const gn_scene *scene);

/* The same of what comes closer alone, as walls and sides do that do not only part. */
bool gn_scene_squeezes(const gn_scene *scene);

/* The same without the motions of the ends of the test, or (`membrane`) without the membrane. */
bool gn_scene_presses_beside(const gn_scene *scene, bool membrane);

/* The motion of a wall, a body, a set or nodes by name; NULL: there is none of that name. */
const gn_motion *gn_scene_end_motion(const gn_scene *scene, const char *name);

/* Whether a part of an end ever has a prescribed velocity along the axis of the test. */
bool gn_scene_end_moves(const gn_scene *scene, const gn_test_end *end);

/* Whether a name is among the first `parts` of an end of a test. */
bool gn_scene_in_end(const gn_test_end *end, size_t parts, const char *name);
/* Tells whether it is the name of a part of either end of the test. */
bool gn_scene_is_end(const gn_scene *scene, const char *name);

/* Whether something beside the ends of the test, or a body that is one and no box, holds the
 * specimen at both sides along an axis: walls that face it, sides of a periodic box, bodies, sets
 * or elements that are held there. Of a scene with stages a wall with a servo and a set without a
 * motion may be so later. */
bool gn_scene_stands(const gn_scene *scene, int axis);

/* The same of one thing: beside the ends, and at rest along the axis. Where it is is not looked at
 * (laboratory/check_ends.c does). Of stages walls and bodies may come to rest. */
bool gn_scene_wall_stands(const gn_scene *scene, size_t wall, int axis);
bool gn_scene_body_stands(const gn_scene *scene, size_t body, int axis);
bool gn_scene_set_stands(const gn_scene *scene, size_t set, int axis);
bool gn_scene_motion_stands(const gn_scene *scene, size_t motion, int axis);

/* Whether the ends of a shear test are free to come apart: across the sheared plane one of them is
 * neither held nor pressed by itself. Walls beside them are not looked at
 * (laboratory/check_ends.c does). */
bool gn_scene_shears_loose(const gn_scene *scene);

/* Whether a part of an end of a shear test is held or pressed across the sheared plane. */
bool gn_scene_end_bears(const gn_scene *scene, const gn_test_end *end);

#endif
