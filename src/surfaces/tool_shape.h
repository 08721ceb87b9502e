/* Surfaces of cutting tools. */
#ifndef GN_SURFACES_TOOL_SHAPE_H
#define GN_SURFACES_TOOL_SHAPE_H

#include "base/error.h"
#include "mesh/mesh.h"
#include "scene/tool_def.h"

#include <stddef.h>

/* Makes the closed surface of a tool in space, with normals outward. The origin is the centre of a
 * disc cutter, and the lowest point of other tools. GNEISS_ERROR_INPUT names the key of a size that
 * does not fit the others. On failure *mesh is empty. */
gneiss_status gn_tool_mesh(gn_tool_kind kind, const gn_tool_def *tool, gn_mesh *mesh,
                           gneiss_error *error);

/* Makes the closed outline of a chisel or a wedge in the plane, with x along the cut and y upward:
 * *points [*count][2], m, to be freed by gn_free. */
gneiss_status gn_tool_outline(gn_tool_kind kind, const gn_tool_def *tool, double **points,
                              size_t *count, gneiss_error *error);

#endif
