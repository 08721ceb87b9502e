/* Definitions of laboratory tests and of pressure on a specimen. */
#ifndef GN_SCENE_LABORATORY_H
#define GN_SCENE_LABORATORY_H

#include "scene/values.h"
#include "test_kinds/test_kind.h"

/* Walls, bodies, sets and motions of elements that load the specimen together. */
typedef struct gn_test_end {
    size_t count;
    char (*name)[GN_NAME_SIZE]; /* [count] */
    gn_scene_place where;       /* set for the ends of a test, not for those of a gauge */
} gn_test_end;

/* The distance by which two parts of the specimen separate, such as the sides of a notch's mouth.
 */
typedef struct gn_opening {
    int64_t axis; /* 0 1 2 */
    gn_test_end lower, upper;
} gn_opening;

/* Control of a test: the ends move at the speed at which a measured quantity grows at its given
 * rate. */
typedef struct gn_control {
    double opening, lateral_strain; /* m/s, 1/s: wanted rate of growth of the quantity; that of the
                                       other one is 0 */
    double
        response;   /* s: ratio of the deviation to the rate at which the ends move at full speed */
    double reverse; /* largest reverse speed over the speed of the ends */
} gn_control;

/* A laboratory test: its two ends and the definitions of stress and strain. */
typedef struct gn_test {
    gn_test_kind kind;
    int64_t axis; /* 0 1 2 */
    gn_test_end lower, upper;
    gn_test_sizes given; /* a 0 follows from the specimen (docs/scene.md) */
    double
        centre; /* radius of the region in which the centre stress is read, over that of the disc */
    int64_t normal; /* normal of the plane of a shear test, or of the surface that a tool cuts: 0 1
                       2, -1: not given */
    char tool[GN_NAME_SIZE];  /* the body that cuts; "": none */
    int64_t blocks;           /* number of parts of the path over which means are taken */
    double pressure_exponent; /* exponent psi of the pressure along the rim of a disc cutter */
    bool has_opening;
    gn_opening opening;
    bool has_control;
    gn_control control;
    /* Only used while reading: a scene has one confinement, and gneiss run makes a run for each
     * (src/sweep/load.c). */
    bool has_confinement;
    const struct gn_node *confinement;
    gn_scene_place where;
} gn_test;

typedef enum gn_membrane_faces { GN_FACES_ALL, GN_FACES_SIDES } gn_membrane_faces;
typedef enum gn_membrane_surface { GN_SURFACE_SHAPE, GN_SURFACE_PARTICLES } gn_membrane_surface;

/* Pressure on the surface of the specimen. */
typedef struct gn_membrane_def {
    gn_table pressure; /* Pa */
    double ramp;       /* s, time in which the pressure rises from 0; 0: it is applied at once */
    gn_membrane_surface
        surface; /* surface of specimens with a shape; others have the surface of their particles */
    gn_membrane_faces faces;
    int64_t axis; /* the sides face across this axis: 0 1 2; -1: the axis of the test */
    bool follow;  /* the membrane follows the deformation */
    gn_scene_place where;
} gn_membrane_def;

/* Motion of a pair of sides of a periodic box; without a table the pair is fixed. */
typedef struct gn_box_side {
    gn_table stress; /* Pa, target, compression positive; or */
    bool of_mean;    /* `stress` is the target of the mean of the stresses along all axes */
    gn_table rate;   /* 1/s, rate of change of the length over the length */
    gn_scene_place rate_where;
    double max_rate;   /* 1/s, with `stress` */
    double relaxation; /* share of the stress error that is corrected per step, (0, 1]; 0:
                          automatic, 0.1 */
} gn_box_side;

#endif
