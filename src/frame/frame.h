/* The data that all parts of a world share: the scene, the clock, the kernels and the extent of the
 * specimen. Parts read it; the world, the step limit, the control and the box change it between the
 * steps. */
#ifndef GN_FRAME_FRAME_H
#define GN_FRAME_FRAME_H

#include "base/effects.h"
#include "base/error.h"
#include "frame/ledger.h"
#include "frame/parts.h"
#include "frame/phases.h"
#include "frame/step_choice.h"
#include "kernels/dispatch.h"
#include "ranks/ranks.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/* Control of the ends of a test (laboratory/ends.h). */
typedef struct gn_machine {
    double wanted; /* target of the reading: m or 1 */
    double
        factor; /* factor by which the prescribed motion of the ends along the axis is multiplied */
    double looked; /* s: time of the last reading */
} gn_machine;

struct gn_step_context {
    gn_scene scene; /* scene of the stage; its points, like all points of the world, are relative to
                       scene.origin */
    gn_scene given; /* the scene in the user's coordinates, for files */
    gn_effects effects;
    const gn_kernel_set *kernels;
    int threads;
    gn_ranks *ranks; /* the processes that share the work; NULL: this one is alone */

    int64_t step;
    int64_t first_step; /* 0, or the step at which the run began in an equilibrium (src/static) */
    double time;        /* s */
    double dt_past, dt; /* s: interval that led here, coming interval */
    double stable;      /* s: upper bound of the step: sharp limit or bound, reduced for non-viscous
                           damping */
    gn_step_choice choice; /* limits found so far */
    int64_t dt_lowered;    /* number of times that the step was lowered while running */

    double seconds[GN_PHASE_COUNT]; /* s of run time by phase */
    gn_machine machine;             /* control of the ends of the test */
    bool measure;                   /* readings are taken at the instant of the step */
    bool sums;                      /* sums over contacts are requested, with or without readings */
    double period[3];               /* m: present sides of a periodic box; 0: not periodic */
    double volume;             /* m3 (2D: m2 x 1 m): specimen at the start; present periodic box */
    double lower[3], upper[3]; /* m: extent of the specimen at the start, radii included */
    double test_length, test_area; /* m, m2 (2D: m x 1 m) */
};

/* Tells whether elements turn into particles in the scene. */
static inline bool gn_converts(const gn_step_context *ctx) {
    return ctx->scene.has_couple && ctx->scene.couple.has_convert;
}

/* End of a run requested by the model. */
struct gn_ending {
    bool bad;       /* the run failed: its state is written for inspection */
    char halt[256]; /* reason to end the run with a valid model; "": none */
};

/* Returns the factor of the prescribed velocity of a wall, set, body or motion of elements along an
 * axis: 1 unless it is an end of a controlled test. */
double gn_control_of(const gn_step_context *ctx, const char *name, int axis);

/* Converts a point of the world to the user's coordinates. */
void gn_user_point(const gn_step_context *ctx, const double point[3], double out[3]);

/* Positions are too coarse if the spacing of doubles there exceeds this fraction of a length. */
#define GN_COARSE 1e-8
/* Returns the largest coordinate, m, at which places of particles of that radius are fine enough.
 */
double gn_finest_reach(double radius);

/* Returns the fraction of the limit that remains with non-viscous damping; 1 without it. */
double gn_nonviscous_share(const gn_step_context *ctx);

/* Refuses a run that no machine would bring to its end: more than 1e15 steps. */
gneiss_status gn_check_duration(const gn_step_context *ctx, gneiss_error *error);

#endif
