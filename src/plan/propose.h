/* Cheapest settings of a test whose reading has at most a given error: from the laws of the study
 * of accuracy, an estimate from the specimen, and the cost of a step on this machine. */
#ifndef GN_PLAN_PROPOSE_H
#define GN_PLAN_PROPOSE_H

#include "accuracy/accuracy.h"
#include "plan/cost.h"
#include "plan/estimate.h"

typedef struct gn_wanted {
    double error;        /* relative, at 95 % confidence */
    const char *reading; /* "strength", "stiffness" */
    bool any_particles;  /* the number of particles may change, with recalibrated contacts */
} gn_wanted;

typedef struct gn_proposal {
    double pace;      /* ratio of the loading speed to that of the scene */
    double particles; /* number of particles in one packing */
    int packings;     /* number of packings that are averaged */
    double safety;
    double
        step_ratio; /* ratio of the step to that without added mass, by the scene's own estimate */
    double bound_step_ratio; /* the same ratio by the bound, which is used for other factors */
    double added_mass;       /* ratio of the added mass to the particles' own */
    bool mixed, first_break;
    double cell; /* elements: ratio of the cell side to that of the scene; there are 1/cell times as
                    many layers */
    gn_error_causes causes;
    double error;
    double steps;   /* number of steps of one run */
    double seconds; /* s of processor time on one thread, of all packings, including their fit */
} gn_proposal;

enum { GN_PLAN_FACTORS = 5 };

typedef struct gn_plan {
    gn_wanted wanted;
    const char *reading; /* name of the reading in the study */
    gn_test_groups groups;
    gn_estimate estimate;
    gn_cost cost[2]; /* in double and in mixed precision */
    bool mixed_known;
    double unscaled_step; /* s: the step without added mass */
    double bound_step_ratio[GN_PLAN_FACTORS], added_mass[GN_PLAN_FACTORS]; /* see gn_proposal */
    double setup; /* s of processor time to create the world */
    const char
        *statics_refusal; /* reason why steps cannot begin at the first break; NULL: they can */
    gn_proposal current, best; /* settings of the scene; proposed settings */
    bool reached;              /* the requested error is reached */
    const char *absent;        /* reason why there is no plan; NULL: there is one */
} gn_plan;

/* Makes a plan. `setup`: s of processor time of gn_world_create. */
gneiss_status gn_plan_make(const gn_world *world, const gn_wanted *wanted, double setup,
                           gn_plan *plan, gneiss_error *error);

/* Corrects steps and seconds of a proposal for elements by the world that was created from it. */
void gn_plan_correct(const gn_step_context *ctx, const gn_solids *solids, const gn_plan *plan,
                     gn_proposal *proposal);

#endif
