/* The setting in which the parts of a world work: the scene, the clock, the kernels and the extent
 * of the specimen. Parts read it; the world, the step limit, the control and the box change it
 * between the steps. */
#ifndef GN_FRAME_STEP_CONTEXT_H
#define GN_FRAME_STEP_CONTEXT_H

#include "base/effects.h"
#include "frame/parts.h"
#include "kernels/dispatch.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/* Control of the ends of a test (drive/control.h). */
typedef struct gn_machine {
    double wanted; /* of the reading: m or 1 */
    double factor; /* of the prescribed motion of the ends along the axis */
    double looked; /* s: time of the last reading */
} gn_machine;

struct gn_step_context {
    gn_scene scene; /* of the stage; its points relative to scene.origin, as all points of the
                       world */
    gn_scene given; /* the same as the user sees it, for files */
    gn_effects effects;
    const gn_kernel_set *kernels;
    int threads;

    int64_t step;
    int64_t first_step; /* 0, or the step that it began with in an equilibrium (src/static) */
    double time;        /* s */
    double dt_past, dt; /* s: interval that led here, coming interval */
    double stable;      /* s: upper bound of the step: sharp limit or bound, less the share that
                         * non-viscous damping takes */
    int64_t dt_lowered; /* number of times that the step was lowered while running */

    gn_machine machine;        /* control of the ends of the test */
    bool measure;              /* the instant of the step is read */
    bool sums;                 /* sums over contacts are asked for, whether or not it is read */
    double period[3];          /* m: present sides of a periodic box; 0: not periodic */
    double volume;             /* m3 (2D: m2 x 1 m): specimen at the start; present periodic box */
    double lower[3], upper[3]; /* m: extent of the specimen at the start, radii included */
    double test_length, test_area; /* m, m2 (2D: m x 1 m) */
};

/* The end of a run by the model itself. */
struct gn_ending {
    bool bad;       /* the run failed: its state is written as it is, for inspection */
    char halt[256]; /* reason why the run is to end here with a valid model; "": none */
};

#endif
