/* The faces of the joints of a scene: planes, discs, polygons and triangles, in 2D lines. */
#ifndef GN_PARTICLES_JOINT_FACES_H
#define GN_PARTICLES_JOINT_FACES_H

#include "base/error.h"
#include "frame/parts.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A part of a plane. The doubles come first, as checkpoints store them. */
typedef struct gn_joint_face {
    double point[3], normal[3]; /* m; a unit vector */
    double along[3], up[3];     /* unit vectors in the face: along the strike, and up the dip */
    double radius;              /* m, of a disc, of a circle around the corners, half the length;
                                   GN_JOINT_ENDLESS */
    int32_t joint;              /* entry of the scene */
    int32_t patch; /* faces of one patch share their area; those of a surface are one patch */
    int32_t first_corner, corner_count; /* 0: a plane or a disc */
} gn_joint_face;

/* The part of a joint to which the areas of contacts add up. */
typedef struct gn_joint_patch {
    double area;  /* m2 inside of the specimen at the start (2D: m x 1 m) */
    double share; /* area of a contact over the square (2D: the first power) of its smaller radius;
                     0: no contact crossed the patch at the start */
    double reach; /* distance up to which two particles form a contact across the patch once they
                     have slid, over the sum of their radii */
    double dilation, dilation_end; /* 1, m: of the joint */
    double contacts, shared; /* that crossed it at the start, and of these those that also crossed
                                another patch */
} gn_joint_patch;

struct gn_joint_faces {
    size_t count, corner_count, patch_count;
    gn_joint_face *face;
    double *corner; /* [corner_count][2] m, in the frames of the faces */
    gn_joint_patch *patch;
    size_t ids;         /* particles that have lists of near faces, by id */
    size_t *first_near; /* [ids + 1] */
    int32_t *near;      /* faces that were near the particle at the start */
};

/* Makes the faces of a scene from its joints, at the start of a run. */
gneiss_status gn_joint_faces_make(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Lists for each particle the faces that it can meet; needs the faces. */
gneiss_status gn_joint_faces_list_near(const gn_step_context *ctx, gn_dem *dem,
                                       gneiss_error *error);
/* Returns the largest distance of two particles in contact across a joint over the sum of their
 * radii. */
double gn_joint_reach(const gn_step_context *ctx, const gn_joint_faces *faces);
void gn_joint_faces_free(gn_joint_faces **faces);

/* Adds a face with a normal; the rest is set by the caller. NULL: no memory. */
gn_joint_face *gn_joint_faces_add(gn_joint_faces *faces, const double point[3],
                                  const double normal[3], int dimension);

/* Draws the discs (2D: lines) of a network into `faces` (joint_network.c). */
gneiss_status gn_joint_network_draw(const gn_step_context *ctx, const gn_dem *dem, int32_t joint,
                                    gn_joint_faces *faces, gneiss_error *error);
/* Reads discs (2D: lines) from a CSV file (joint_discs.c). */
gneiss_status gn_joint_discs_read(const gn_scene *scene, int32_t joint, gn_joint_faces *faces,
                                  gneiss_error *error);

/* The convex body around the specimen at the start, in a fixed set of directions: of a packed
 * rectangle, disc, box or cylinder itself, else of its spheres. It is exact for boxes along the
 * axes, and within 0.1 % of the section of cylinders along them. */
enum { GN_OUTLINE_TURNS = 64, GN_OUTLINE_MOST = 3 * GN_OUTLINE_TURNS };
typedef struct gn_outline {
    int dimension;
    size_t count;
    double normal[GN_OUTLINE_MOST][3], reach[GN_OUTLINE_MOST]; /* normal.x <= reach, m */
} gn_outline;
void gn_outline_find(const gn_scene *scene, const gn_particles *particles, gn_outline *outline);
/* Computes the area of a face inside of the outline, m2 (2D: m x 1 m). */
gneiss_status gn_joint_face_area(const gn_joint_faces *faces, const gn_joint_face *face,
                                 const gn_outline *outline, double *area, gneiss_error *error);

/* How far two particles on both sides of a face have moved apart since the start, m: along its
 * normal, opening positive, and along the face. */
typedef struct gn_joint_shift {
    double gap, slid;
    bool parted; /* the gap, less the dilation, is beyond the smaller radius */
} gn_joint_shift;
/* Returns the face that lies between two particles, by their sides at the start and where they are
 * now, and sets *shift; -1: none. */
int32_t gn_joint_between(const gn_dem *dem, int32_t i, int32_t j, gn_joint_shift *shift);
/* Tells whether faces of more than one patch lie between two particles. */
bool gn_joint_between_several(const gn_dem *dem, int32_t i, int32_t j);
/* Returns the opening by dilation after a slip, m. */
double gn_joint_dilation(const gn_dem *dem, const gn_joint_face *face, double slip);
/* Returns 1.0 if the normal of a face points from i to j, else -1.0. */
double gn_joint_sense(const gn_dem *dem, const gn_joint_face *face, int32_t i, int32_t j);

#endif
