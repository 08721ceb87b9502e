/* The gmsh program as a mesher, if it is installed. */
#ifndef GN_MESH_GMSH_H
#define GN_MESH_GMSH_H

#include "mesh/mesh.h"

#include <stdbool.h>

/* Tells by the extension whether a file is a geometry that gmsh has to mesh: .geo, .step, .stp,
 * .brep, .iges, .igs. */
bool gn_is_geometry(const char *path);

/* Writes the command that gn_mesh_geometry would run, for messages. FILE stands for the mesh. */
void gn_mesh_geometry_command(const char *path, int dimension, char *text, size_t size);

/* Meshes a geometry with the program `gmsh` found in PATH (`gmsh -2|-3 FILE`), in a temporary
 * folder that is removed afterwards, and reads the mesh as gn_mesh_read_msh does. Elements are
 * linear, even if the geometry requests a higher order. A geometry can make gmsh execute commands,
 * so that the caller needs the user's permission (gn_scene.allow_gmsh). GNEISS_ERROR_INPUT: gmsh is
 * not installed, or has refused the geometry (with the last line of its output). */
gneiss_status gn_mesh_geometry(const char *path, int dimension, double scale, gn_mesh *mesh,
                               gneiss_error *error);

#endif
