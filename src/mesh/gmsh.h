/* The gmsh program as a mesher, when it is installed. */
#ifndef GN_MESH_GMSH_H
#define GN_MESH_GMSH_H

#include "mesh/mesh.h"

#include <stdbool.h>

/* Whether a file is a geometry that gmsh would have to mesh, by the end of its name: .geo, .step,
 * .stp, .brep, .iges, .igs. */
bool gn_is_geometry(const char *path);

/* The command that gn_mesh_geometry would run, for messages. FILE stands for the mesh. */
void gn_mesh_geometry_command(const char *path, int dimension, char *text, size_t size);

/* Meshes a geometry with the program `gmsh` found in PATH (`gmsh -2|-3 FILE`), in a temporary
 * folder that is removed again, and reads the mesh as gn_mesh_read_msh does. Elements are linear,
 * also where the geometry asks for a higher order. A geometry can make gmsh execute commands: the
 * caller has the user's permission (gn_scene.allow_gmsh). GNEISS_ERROR_INPUT: gmsh is not
 * installed, or refused the geometry (with the last line that it said). */
gneiss_status gn_mesh_geometry(const char *path, int dimension, double scale, gn_mesh *mesh,
                               gneiss_error *error);

#endif
