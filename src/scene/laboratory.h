/* Laboratory tests, and pressure on a specimen, as a scene says them. */
#ifndef GN_SCENE_LABORATORY_H
#define GN_SCENE_LABORATORY_H

#include "scene/values.h"
#include "test_kinds/test_kind.h"

/* Walls, bodies, sets, motions of elements that load the specimen together. */
typedef struct gn_test_end {
    size_t count;
    char (*name)[GN_NAME_SIZE]; /* [count] */
    gn_scene_place where;       /* of the two of a test, not of a gauge */
} gn_test_end;

/* How far two parts of the specimen come apart, such as the sides of a notch's mouth. */
typedef struct gn_opening {
    int64_t axis; /* 0 1 2 */
    gn_test_end lower, upper;
} gn_opening;

/* A test whose ends move as fast as something else is to grow. */
typedef struct gn_control {
    double opening, lateral_strain; /* m/s, 1/s: rate at which one of both is to grow; 0: other */
    double response; /* s: how far it may be behind or ahead, times the rate, at full speed */
    double reverse;  /* of the motion of the ends, the most they go back with */
} gn_control;

/* A laboratory test: which two ends load the specimen and how stress and strain are formed. */
typedef struct gn_test {
    gn_test_kind kind;
    int64_t axis; /* 0 1 2 */
    gn_test_end lower, upper;
    gn_test_sizes given; /* a 0 follows from the specimen (docs/scene.md) */
    double centre;       /* radius over that of the disc within which its centre stress is read */
    int64_t normal;      /* of the plane that a shear test shears: 0 1 2, -1: not given */
    bool has_opening;
    gn_opening opening;
    bool has_control;
    gn_control control;
    bool has_confinement; /* while it is read: one scene is one confinement, gneiss run makes */
    const struct gn_node *confinement; /* a run of each (src/sweep/load.c) */
    gn_scene_place where;
} gn_test;

typedef enum gn_membrane_faces { GN_FACES_ALL, GN_FACES_SIDES } gn_membrane_faces;
typedef enum gn_membrane_surface { GN_SURFACE_SHAPE, GN_SURFACE_PARTICLES } gn_membrane_surface;

/* Pressure on the surface of the specimen. */
typedef struct gn_membrane_def {
    gn_table pressure;           /* Pa */
    double ramp;                 /* s in which it comes, from 0; 0: at once */
    gn_membrane_surface surface; /* of specimens with a shape; others have that of particles */
    gn_membrane_faces faces;
    int64_t axis; /* that sides face across: 0 1 2; -1: that of the test */
    bool follow;  /* the deformation */
    gn_scene_place where;
} gn_membrane_def;

/* How a pair of sides of a periodic box moves; neither table: it stands still. */
typedef struct gn_box_side {
    gn_table stress; /* wanted, compression positive, Pa; or */
    gn_table rate;   /* 1/s, of its length over its length */
    gn_scene_place rate_where;
    double max_rate;   /* 1/s, with stress */
    double relaxation; /* share of the missing stress that is made up per step, (0, 1]; 0: 0.1 */
} gn_box_side;

#endif
