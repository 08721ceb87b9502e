/* A scene file with other values, as its author wrote it: comments, order and units stay. */
#ifndef GN_PLAN_REWRITE_H
#define GN_PLAN_REWRITE_H

#include "scene/scene.h"

/* Writes the scene of `path` with `overrides` to `target`, whole or not at all. Paths in it stay
 * right where the folder is another one. *plain: it could not be kept as it was written, and is the
 * resolved scene without comments. GNEISS_ERROR_INPUT: there is a file already, unless `force`. */
gneiss_status gn_scene_rewrite(const char *path, const gn_override *overrides, size_t count,
                               const char *target, bool force, bool *plain, gneiss_error *error);

#endif
