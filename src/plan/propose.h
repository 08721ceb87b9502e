/* The cheapest settings of a test whose reading is to be right within a given error: from the laws
 * of the study of accuracy, an estimate from the specimen, and what a step costs here. */
#ifndef GN_PLAN_PROPOSE_H
#define GN_PLAN_PROPOSE_H

#include "accuracy/covers.h"
#include "plan/cost.h"
#include "plan/estimate.h"

typedef struct gn_wanted {
    double error;        /* relative, of 95 of 100 tests */
    const char *reading; /* "strength", "stiffness" */
    bool any_particles;  /* the number of particles may be changed: contacts are calibrated anew */
} gn_wanted;

typedef struct gn_proposal {
    double pace;      /* of the loading, over that of the scene */
    double particles; /* of one packing */
    int packings;     /* whose mean is taken */
    double safety;
    double masses;   /* the step over that without added mass, by whatever estimate the scene has */
    double of_bound; /* the same over the bound's, which it is by if it is to be another */
    double added;    /* mass over the particles' own */
    bool mixed, first_break;
    double cell; /* elements: the side of a cell over that of the scene; layers: 1/cell as many */
    gn_error_causes causes;
    double error;
    double steps;   /* of one run */
    double seconds; /* of a processor, one thread, all packings, packing them included */
} gn_proposal;

enum { GN_PLAN_FACTORS = 5 };

typedef struct gn_plan {
    gn_wanted wanted;
    const char *reading; /* as the study calls it */
    gn_test_groups groups;
    gn_estimate estimate;
    gn_cost cost[2]; /* in double and mixed precision */
    bool mixed_known;
    double unscaled;                                          /* s: the step without added mass */
    double of_bound[GN_PLAN_FACTORS], added[GN_PLAN_FACTORS]; /* see gn_proposal */
    double setup;            /* s of a processor that the world took */
    const char *no_statics;  /* why steps cannot begin at the first break; NULL: they can */
    gn_proposal as_is, best; /* what the scene asks for; what is proposed */
    bool reached;            /* the error that is wanted */
    const char *absent;      /* why nothing can be planned; NULL: it can */
} gn_plan;

/* `setup`: s of a processor that gn_world_create took. */
gneiss_status gn_plan_make(const gn_world *world, const gn_wanted *wanted, double setup,
                           gn_plan *plan, gneiss_error *error);

/* Steps and seconds of a proposal for elements from the world that was made of it. */
void gn_plan_correct(const gn_step_context *ctx, const gn_solids *solids, const gn_plan *plan,
                     gn_proposal *proposal);

#endif
