/* Prediction of a test from its specimen before it is run: bonds in uniform strain, scaled by the
 * ratio of tests of the study of accuracy to the same estimate. */
#ifndef GN_PLAN_ESTIMATE_H
#define GN_PLAN_ESTIMATE_H

#include "frame/parts.h"
#include "world/world.h"

typedef struct gn_estimate {
    const char *study;  /* case of the study that represents the scene */
    const char *absent; /* reason why there is no estimate; NULL: there is one */
    bool elements;      /* the scene is a mesh: only closing, path and rows are valid */
    double modulus, poisson, bulk_density; /* Pa; 1; kg/m3: predicted E, Poisson's ratio in uniform
                                              strain, bulk density */
    double uniform_modulus;                /* Pa, E in uniform strain */
    double wave_speed;                     /* m/s, root of E over bulk density */
    double
        breaking_strain; /* uniform strain at which a twentieth of the bonds reaches its strength */
    double body_strain; /* strain of the specimen at the peak, without the ends; INFINITY: there are
                           no bonds that can break */
    double strength;    /* Pa */
    double strain;      /* strain between the ends at the peak, or INFINITY */
    double compliance;  /* 1/Pa: strain by the walls, with the particles initially near them */
    double predicted_compliance; /* 1/Pa: predicted strain by the walls */
    double first_break;          /* strain */
    double closing_velocity;     /* m/s, largest closing velocity of both ends */
    double path_strain;          /* strain up to time.end */
    double end_strain;           /* predicted strain at the end of the run */
    double speed;                /* dimensionless group of the velocity law */
    double across;               /* number of particles across the test's axis */
    double radius;               /* m, mean */
} gn_estimate;

/* Computes the estimate. If the scene is not a test that the study covers, only `absent` and the
 * members that it concerns are set. */
gneiss_status gn_estimate_make(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, gn_estimate *estimate, gneiss_error *error);

/* Returns the predicted end of the run, s; 0: unknown. */
double gn_estimate_end(const gn_step_context *ctx, const gn_estimate *estimate);

#endif
