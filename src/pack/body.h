/* From the request of a scene to the body that is to be filled. */
#ifndef GN_PACK_BODY_H
#define GN_PACK_BODY_H

#include "pack/domain.h"
#include "scene/scene.h"

typedef struct gn_body {
    gn_domain *domain;
    gn_mesh mesh;                     /* of a mesh shape, with its elements; else empty */
    double *node_size;                /* [mesh.node_count] mean length of the edges at a node, m */
    const gn_refinement *refinements; /* borrowed from the scene */
    size_t refinement_count;
} gn_body;

/* Reads what files it needs. `scene` must outlive the body. */
gneiss_status gn_body_create(const gn_scene *scene, gn_body *body, gneiss_error *error);
void gn_body_free(gn_body *body);

/* Size of particles wanted at x over that far from every refinement, (0, 1]. */
double gn_body_size(const gn_body *body, const double x[3]);

#endif
