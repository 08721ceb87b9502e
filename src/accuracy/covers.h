/* The case of the study of accuracy that represents a scene, and the groups of its laws. */
#ifndef GN_ACCURACY_COVERS_H
#define GN_ACCURACY_COVERS_H

#include "accuracy/causes.h"
#include "frame/parts.h"
#include "scene/scene.h"
#include "world/world.h"

/* Fills the groups that follow from the scene and its specimen; `speed` is NaN. Returns the reason
 * why the study does not cover the scene; NULL: it does. */
const char *gn_study_find_case(const gn_step_context *ctx, const gn_dem *dem,
                               gn_test_groups *groups);

/* Closing motions of the two ends of the test along its axis, in the sense of the test: m/s at a
 * time, the largest up to time.end, and m up to a time. */
double gn_test_closing(const gn_scene *scene, double time);
double gn_test_fastest(const gn_scene *scene);
double gn_test_path(const gn_scene *scene, double time);

/* Bulk density of the specimen, kg/m3. */
double gn_test_bulk_density(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids);

#endif
