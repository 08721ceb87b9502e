/* Definitions of joints. */
#ifndef GN_SCENE_JOINT_DEF_H
#define GN_SCENE_JOINT_DEF_H

#include "scene/place.h"
#include "scene/values.h"

/* m: a joint without an edge, or a dilation without an end. */
#define GN_JOINT_ENDLESS 1e30

/* Joints that are drawn at random. */
typedef struct gn_joint_network {
    bool given;
    double intensity;  /* 1/m: area of joints per volume (P32), 2D: length per area (P21) */
    double fisher;     /* concentration kappa of the normals; infinite: all are parallel */
    double radius_max; /* m; 0: all have the radius of the entry */
    double exponent;   /* of the power law of the radii */
} gn_joint_network;

/* One joint, or several with the same properties. Exactly one of point, trace, surface, discs and
 * network gives their places; orientation by normal, or by dip and dip direction. */
typedef struct gn_joint_def {
    char name[GN_NAME_SIZE];
    bool has_point, has_normal;
    double point[3], normal[3]; /* m; a unit vector once the scene is checked */
    double dip, dip_direction;  /* rad; dip negative: not given */
    double radius;              /* m; 0: without an edge. 2D: half of the length */
    size_t corner_count, trace_count;
    double *corners; /* [corner_count][2] m, along the strike and up the dip from the point */
    double *trace;   /* [trace_count][2] m, corners of a line in the plane of a 2D scene */
    char surface[GN_PATH_SIZE], surface_path[GN_PATH_SIZE];
    char discs[GN_PATH_SIZE], discs_path[GN_PATH_SIZE];
    gn_joint_network network;
    double normal_stiffness, shear_stiffness; /* Pa/m */
    double friction, bond_friction;           /* after the break, and while intact (-1: friction) */
    double cohesion, tensile_strength;        /* Pa */
    double dilation;                          /* tangent of the dilation angle */
    double dilation_end; /* m, slip at which the dilation ends; GN_JOINT_ENDLESS: never */
    gn_scene_place where;
} gn_joint_def;

#endif
