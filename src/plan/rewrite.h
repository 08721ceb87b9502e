/* A scene file with changed values that keeps comments, order and units. */
#ifndef GN_PLAN_REWRITE_H
#define GN_PLAN_REWRITE_H

#include "scene/scene.h"

/* Writes the scene of `path` with `overrides` to `target`, completely or not at all. Paths in it
 * stay valid in another folder. *plain: the form could not be kept, and the file is the resolved
 * scene without comments. GNEISS_ERROR_INPUT: the file exists, unless `force`. */
gneiss_status gn_scene_rewrite(const char *path, const gn_override *overrides, size_t count,
                               const char *target, bool force, bool *plain, gneiss_error *error);

#endif
