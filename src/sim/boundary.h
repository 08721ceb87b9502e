/* What particles touch besides each other: plane walls, rigid bodies and the surfaces of finite
 * elements, and the contacts with them. */
#ifndef GN_SIM_BOUNDARY_H
#define GN_SIM_BOUNDARY_H

#include "base/vec3.h"
#include "kernels/contact.h"
#include "sim/surface.h"
#include "soa/records.h"

typedef struct gn_wall {
    double point[3], start[3]; /* m; a point of the plane, and where it began */
    double normal[3];          /* unit, to the particles */
    double velocity[3];        /* m/s, over the interval that led here */
    double force[3];           /* N, of the particles on the wall at the last evaluation */
    double stiffness;          /* N/m, sum of the touching contacts; only with a servo */
    double travel;             /* m, path since the lists were made */
} gn_wall;

/* m, of a centre from the plane; negative: behind it. */
static inline double gn_wall_distance(const gn_wall *wall, const double x[3]) {
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = x[a] - wall->point[a];
    return gn_dot3(d, wall->normal);
}

typedef struct gn_boundary {
    gn_wall_contacts contacts; /* of particles with walls and facets */
    int32_t *first;            /* [particles + 1] their first row */
    gn_contact_sums *sums;     /* per block of particles */

    gn_wall *walls;       /* [scene.wall_count] */
    double *wall_normals; /* [walls][4], for measures */
    gn_rigid *bodies;     /* [scene.body_count] */
    size_t surface_count;
    gn_surface *surfaces;     /* first those of bodies, in their order */
    size_t body_vertex_count; /* of all bodies */
    size_t body_corner_count; /* of facets of all bodies */
    int64_t (*body_shape)[3]; /* [bodies]: vertices, facets, facets dropped */
    double *body_vertex;      /* [body_vertex_count][4], m, in the frames */
    int32_t *body_corner;     /* [body_corner_count], within a body */

    double surface_rate; /* 1/s: 1/dt of free bodies, see gn_surfaces_rate */
    double vertex_rate;  /* 1/s: the same of what contacts do to nodes of finite elements */
} gn_boundary;

#endif
