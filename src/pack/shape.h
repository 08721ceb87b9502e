/* The shape of a specimen that is to be filled. */
#ifndef GN_PACK_SHAPE_H
#define GN_PACK_SHAPE_H

#include "pack/domain.h"
#include "scene/scene.h"

typedef struct gn_pack_shape {
    gn_domain *domain;
    gn_mesh mesh;                     /* mesh of a mesh shape, with its elements; otherwise empty */
    double *node_size;                /* [mesh.node_count] mean length of the edges at a node, m */
    const gn_refinement *refinements; /* borrowed from the scene */
    size_t refinement_count;
    char changes[GN_MESH_CHANGES_SIZE]; /* gn_mesh_changed of the file */
} gn_pack_shape;

/* Creates a shape and reads its files. `scene` must outlive the shape. */
gneiss_status gn_pack_shape_create(const gn_scene *scene, gn_pack_shape *shape,
                                   gneiss_error *error);
void gn_pack_shape_free(gn_pack_shape *shape);

/* Returns the facets of a surface or mesh shape, oriented outward: triangles, in 2D lines with the
 * body on their left. The caller frees them. */
gneiss_status gn_pack_shape_facets(const gn_scene *scene, gn_mesh *mesh, gneiss_error *error);

/* Returns GNEISS_ERROR_INPUT if gmsh would have to mesh the shape and the user did not permit this
 * (gn_scene.allow_gmsh): the message gives the command. */
gneiss_status gn_pack_check_geometry(const gn_scene *scene, gneiss_error *error);

/* Returns the wanted size of particles at x over that far from all refinements, (0, 1]. */
double gn_pack_shape_size(const gn_pack_shape *shape, const double x[3]);

#endif
