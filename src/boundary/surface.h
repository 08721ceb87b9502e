/* Surfaces of triangles (segments in the plane) that particles touch: of rigid bodies, and of
 * objects whose vertices move by themselves (nodes of finite elements). */
#ifndef GN_BOUNDARY_SURFACE_H
#define GN_BOUNDARY_SURFACE_H

#include "base/error.h"
#include "frame/parts.h"
#include "kernels/motion.h"
#include "surfaces/facet.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A rigid body. Its frame has its origin at the reference point (of a free body: the centre of
 * mass) and, for a free body, its axes along the principal axes. All members are doubles, as in
 * checkpoints. */
typedef struct gn_rigid {
    double position[3], start[3];  /* m, of the reference point */
    double turn[4], turn_start[4]; /* quaternions w x y z that rotate from the body's frame, now and
                                      at the start */
    double axes[9];                /* the orientation as a matrix, rows: x = position + axes X */
    double velocity[3], velocity_past[3]; /* m/s, over the last interval; before the kick */
    double spin[3], spin_past[3];         /* rad/s */
    double momentum[3], momentum_past[3]; /* N m s about the centre of mass, if any spin is free */
    double force[3], moment[3]; /* N, N m about the reference point, exerted by all contacts */
    double mass, inertia[3];    /* kg; kg m2 about the axes of the frame */
    double inverse_mass[3];     /* 1/kg along x y z; 0: prescribed */
    double inverse_inertia[3];  /* 1/(kg m2) about the axes of the frame; 0: prescribed */
    double held[3]; /* 1: bearings prescribe the spin about this axis of space, while another axis
                       is free; else 0 */
    double volume;  /* m3, of a free body */
    double reach;   /* m, distance of the farthest vertex from the reference point */
    double travel;  /* m, bound on the path of any vertex since the lists were made */
    double ref_position[3], ref_axes[9]; /* position when the lists were made */
} gn_rigid;

/* Functions of a body whose surface deforms, for contacts; solids provide them. */
typedef struct gn_deforming_body {
    /* Stores the present positions as those of the lists. */
    void (*refer)(gn_element_model *elements);
    /* Returns a bound on the path of any node since then, m. `exact`: evaluates all nodes. */
    double (*travel)(gn_element_model *elements, bool exact);
    /* Returns the inverse mass, 1/kg, of the whole body along n at a point of a facet. */
    double (*inverse_mass)(const gn_surface *surface, int32_t facet, const double weight[3],
                           const double n[3]);
} gn_deforming_body;

struct gn_surface {
    gn_facet_set facets;    /* arrays are borrowed; of a rigid body: positions in its frame */
    const double *velocity; /* [vertices][4], m/s, 1/kg; NULL: rigid */
    const int32_t *slot;    /* [vertices] index in `prescribed`, -1: free; NULL: rigid */
    const gn_prescription *prescribed; /* prescribed vertices; borrowed; NULL: rigid */
    double *force; /* [vertices][4], N, force of the particles on each vertex; NULL: rigid */
    int32_t body;  /* rigid body of the surface; -1: vertices are nodes of `elements` */
    gn_element_model *elements;
    const gn_deforming_body *deforming; /* NULL: rigid */
    int32_t first;                      /* index of its first facet among all facets */
    double stiffness, kratio, friction;
    double facet_size; /* m, mean at the start, of a surface whose vertices move independently; else
                          0 */
    gn_facet_tree tree;
    size_t vertices;
};

/* Tells whether all facets inside a particle of this radius press on it (patch.h). A smaller
 * particle touches facets at their nearest points and is rarely between several. */
static inline bool gn_surface_patched(const gn_surface *surface, double radius) {
    const double facets = 3.0;
    return surface->body < 0 && radius > facets * surface->facet_size;
}

/* Returns v . I^-1 v for the inertia I about the centre of mass. */
double gn_rigid_compliance(const gn_rigid *body, const double v[3]);
/* Creates the surfaces of bodies from the arrays that checkpoints also store. */
gneiss_status gn_bodies_surfaces(const gn_step_context *ctx, gn_boundary *boundary,
                                 size_t deforming, gneiss_error *error);
/* Computes the rotation since the start, w x y z with w >= 0. */
void gn_rigid_orientation(const gn_rigid *body, double turn[4]);

/* Returns the surface of a row. */
const gn_surface *gn_surface_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t row);
/* gn_rigid_place converts a point from the body's frame to space; the other functions convert a
 * direction to space and back. */
void gn_rigid_place(const gn_rigid *body, const double local[3], double point[3]);
void gn_rigid_direct(const gn_rigid *body, const double local[3], double direction[3]);
void gn_rigid_local(const gn_rigid *body, const double direction[3], double local[3]);

#endif
