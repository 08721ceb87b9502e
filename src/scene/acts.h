/* Queries about the loads, motions and supports of a specimen (acts.c). */
#ifndef GN_SCENE_ACTS_H
#define GN_SCENE_ACTS_H

#include "scene/scene.h"

/* True if the table has a nonzero value. */
bool gn_table_is_nonzero(const gn_table *table);

/* True if a specimen at rest may be loaded by a membrane, a servo, or by sides, walls, sets, bodies
 * or elements that move or carry a load. Gravity is not considered. */
bool gn_scene_has_load(const gn_scene *scene);

/* True if a part of the scene may approach the specimen; walls and sides that only recede do not
 * count. */
bool gn_scene_may_compress(const gn_scene *scene);

/* True if the specimen may be loaded without the motions of the ends of the test, or (`membrane`)
 * without the membrane. */
bool gn_scene_has_other_load(const gn_scene *scene, bool membrane);

/* Returns the motion of the wall, body, set or nodes of this name; NULL: none. */
const gn_motion *gn_scene_end_motion(const gn_scene *scene, const char *name);

/* True if the scene prescribes a nonzero velocity of a part of an end along the axis of the test at
 * some time. */
bool gn_scene_end_moves(const gn_scene *scene, const gn_test_end *end);

/* True if `name` is among the first `parts` of an end of a test. */
bool gn_test_end_has(const gn_test_end *end, size_t parts, const char *name);
/* True if `name` is a part of either end of the test. */
bool gn_scene_is_end(const gn_scene *scene, const char *name);

/* True if parts of the scene hold the specimen on both sides along an axis: walls that face it,
 * sides of a periodic box, or fixed bodies, sets or elements. Ends of the test do not count, except
 * bodies without `box`. In a scene with stages a wall with a servo and a set without a motion may
 * become fixed later. */
bool gn_scene_is_held_along(const gn_scene *scene, int axis);

/* True if a single object other than the ends of the test is fixed, which means at rest along the
 * axis. Its position is not examined (laboratory/check_ends.c does that). In a scene with stages
 * walls and bodies may come to rest later. */
bool gn_scene_wall_is_fixed(const gn_scene *scene, size_t wall, int axis);
bool gn_scene_body_is_fixed(const gn_scene *scene, size_t body, int axis);
bool gn_scene_set_is_fixed(const gn_scene *scene, size_t set, int axis);
bool gn_scene_motion_is_fixed(const gn_scene *scene, size_t motion, int axis);

/* True if the ends of a shear test are free to separate: across the sheared plane one of them is
 * neither held nor loaded by itself. Walls beside them are not examined (laboratory/check_ends.c
 * does that). */
bool gn_scene_shear_ends_may_separate(const gn_scene *scene);

/* True if a part of an end of a shear test is held or loaded across the sheared plane. */
bool gn_scene_end_has_normal_load(const gn_scene *scene, const gn_test_end *end);

/* Pairs of walls whose distances span the section of a wall. */
typedef struct gn_facing {
    size_t count; /* 1 in 2D, 2 in 3D */
    size_t pair[2][2];
} gn_facing;

/* True if the wall stands across the open axis of a periodic box, so that it closes the box. */
bool gn_wall_covers_open_axis(const gn_scene *scene, size_t wall);

/* Returns the first wall whose normal has the direction of an axis, in its sense or (`sense` < 0)
 * against it; -1: none. */
int gn_scene_wall_facing(const gn_scene *scene, int axis, double sense);

/* Finds the first such pairs in the scene; returns false if there are none. */
bool gn_facing_find(const gn_scene *scene, size_t wall, gn_facing *facing);

#endif
