/* Shapes of rigid bodies: facets, volume and moments. */
#ifndef GN_SURFACES_BODY_SHAPE_H
#define GN_SURFACES_BODY_SHAPE_H

#include "mesh/mesh.h"
#include "scene/scene.h"

/* A shape with vertices in the scene's frame; facets are segments (2D) or triangles. */
typedef struct gn_body_shape {
    size_t vertices, facets, dropped; /* dropped: facets without area (2D: without length) */
    size_t cavities;                  /* number of closed surfaces inside others */
    double *vertex;                   /* [vertices][4], m, the fourth 0 */
    int32_t *corner;                  /* [facets][2 or 3] */
    double volume;                    /* m3 (2D: m2 x 1 m), of closed shapes */
    double centre[3];                 /* centre of mass, m */
    double moment[9];                 /* m5: inertia about the centre over density */
} gn_body_shape;

/* Makes the shape of body `index` of the scene. With `free`, the shape must be closed, and its
 * volume, centre and moment are computed (GNEISS_ERROR_INPUT names the open edge). */
gneiss_status gn_body_shape_make(const gn_scene *scene, size_t index, gn_body_shape *shape,
                                 gneiss_error *error);
/* Makes the shape of a closed surface that gn_mesh_close_surface has oriented, with its volume,
 * centre and moment. */
gneiss_status gn_body_shape_of_mesh(const gn_mesh *mesh, gn_body_shape *shape, gneiss_error *error);
void gn_body_shape_free(gn_body_shape *shape);

/* Computes the rotation matrix (rows) of a rotation vector, axis times angle. */
void gn_rotation_matrix(const double vector[3], double matrix[9]);

#endif
