/* The origin of the coordinates in computations. A double has 16 digits: the farther a model is
 * from 0, the fewer of them resolve its motion. Points are converted to coordinates relative to an
 * origin near the model (gn_origin_enter, gn_scene_shift) and back to the user's coordinates for
 * output (gn_user_point, gn_point_text). */
#ifndef GN_WORLD_ORIGIN_H
#define GN_WORLD_ORIGIN_H

#include "frame/parts.h"

#include "base/error.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

/* Sets scene->origin unless the scene gives it: exactly 0 if the model lies within 1000 times its
 * extent of 0; otherwise a point near its middle, a multiple of a power of two, so that subtracting
 * it from nearby points is exact. `mesh`: the elements' file as read; NULL: it is read if it is
 * needed. */
gneiss_status gn_origin_choose(gn_scene *scene, const gn_mesh *mesh, gneiss_error *error);

/* Reads the specimen's and the elements' files, chooses the origin of world->ctx.given and makes
 * world->ctx.scene from it. The caller frees *mesh: the elements' file, relative to the origin. */
gneiss_status gn_origin_enter(gn_world *world, gn_mesh *mesh, gneiss_error *error);

/* Makes world->ctx.scene from world->ctx.given, which contains its origin. */
gneiss_status gn_origin_shift(gn_world *world, gneiss_error *error);

/* Refuses a specimen whose positions are too coarse although the origin was subtracted: the spacing
 * of doubles there exceeds 1e-8 of the smallest radius. */
gneiss_status gn_origin_check_specimen(const gn_step_context *ctx, const gn_dem *dem,
                                       gneiss_error *error);
/* Refuses elements whose coordinates are too coarse for their least height, reference points of
 * bodies that are too coarse, and motions of less than 50 spacings of doubles in a step. Called
 * once the step is known. */
gneiss_status gn_origin_check(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary, const gn_solids *solids,
                              gneiss_error *error);

#endif
