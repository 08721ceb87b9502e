/* What a test will show before it is run, from its specimen: bonds in uniform strain, brought to
 * what the tests of the study of accuracy found beside the same estimate. */
#ifndef GN_PLAN_ESTIMATE_H
#define GN_PLAN_ESTIMATE_H

#include "world/world.h"

typedef struct gn_estimate {
    const char *study;             /* the case of the study that stands for the scene */
    const char *absent;            /* why there is no estimate; NULL: there is one */
    bool elements;                 /* a mesh: of what follows only closing, path and rows hold */
    double modulus, poisson, bulk; /* Pa, -, kg/m3; foretold E, the ratio of uniform strain */
    double uniform;                /* Pa: E of uniform strain */
    double wave;                   /* m/s: root of E over bulk density */
    double breaking;    /* strain that brings a twentieth of the bonds to their strength, uniform */
    double body_strain; /* at the peak, without the ends; INFINITY: nothing can break */
    double strength;    /* Pa */
    double strain;      /* between the ends at the peak, or INFINITY */
    double compliance;  /* 1/Pa: strain that walls take by the particles near them at the start */
    double ends;        /* 1/Pa: what they will take */
    double first_break; /* strain */
    double closing;     /* m/s: both ends together, the fastest */
    double path;        /* strain up to time.end */
    double end;         /* strain at which the run is foretold to end */
    double speed;       /* the group of the velocity's law */
    double across;      /* particles across the test's axis */
    double radius;      /* m, mean */
} gn_estimate;

/* Only `absent` and what it needs when the scene is no test that the study stands for. */
gneiss_status gn_estimate_make(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, gn_estimate *estimate, gneiss_error *error);

/* s: when the run is foretold to end; 0: not known. */
double gn_estimate_end(const gn_step_context *ctx, const gn_estimate *estimate);

#endif
