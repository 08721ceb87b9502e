/* Which case of the study of accuracy stands for a scene, and the groups of its laws. */
#ifndef GN_ACCURACY_COVERS_H
#define GN_ACCURACY_COVERS_H

#include "accuracy/causes.h"
#include "world/world.h"

/* Fills what follows from the scene and its specimen; `speed` is NaN. Returns why the study does
 * not cover it; NULL: it does. */
const char *gn_study_covers(const gn_step_context *ctx, const gn_dem *dem, gn_test_groups *groups);

/* Motions of the two ends of the test along its axis, together and in the sense of the test: m/s at
 * a time, the fastest up to time.end, and m up to a time. */
double gn_test_closing(const gn_scene *scene, double time);
double gn_test_fastest(const gn_scene *scene);
double gn_test_path(const gn_scene *scene, double time);

/* kg/m3 of the specimen as a whole. */
double gn_test_bulk(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids);

#endif
