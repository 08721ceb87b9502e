/* Known limits of the step, which the folder timestep writes; a world without
 * particles has only `stable`. */
#ifndef GN_FRAME_STEP_CHOICE_H
#define GN_FRAME_STEP_CHOICE_H

#include "limit/step_limits.h"

#include <stdbool.h>
#include <stdint.h>

/* The shortest collision that a step has to resolve, by ids of particles. A `second` below 0 is
 * wall number -1 - second; surfaces are numbered after the walls. */
typedef struct gn_resolution {
    double step;    /* s: the step that resolves it; INFINITY: no collision is possible */
    double contact; /* s, duration of the collision */
    int64_t first, second;
} gn_resolution;

/* Masses raised for a longer step (mass_scaling.c); see also gn_raised_masses. */
typedef struct gn_mass_scaling {
    double unscaled; /* s, step without raised masses */
    double step;     /* s: the step for which masses were raised; 0: none was */
    double reached;  /* s: the step reached at the start */
} gn_mass_scaling;

typedef struct gn_step_choice {
    gn_step_limit limit; /* limit of the particles, last full estimate */
    double stable;       /* s: the limit of the particles alone, without damping */
    double listed; /* s: the limit with all listed contacts closed, if it exceeds the step by about
                      a hundredth or less; else INFINITY */
    double listed_holds; /* s: known to be stable for particles with all listed contacts */
    double whole;        /* s: sharp limit of the coupled system of particles and elements; 0: not
                            searched; negative: outdated, because nodes have lost mass */
    gn_resolution resolution; /* the shortest collision so far */
    gn_mass_scaling scaling;
    double surface_rate; /* 1/s: 1/dt of free bodies, see gn_timestep_boundary_limit */
    double
        vertex_rate; /* 1/s, the same rate for nodes of finite elements in contact with particles */
    double gain;     /* m/s, largest change of a prescribed velocity in the coming step; else 0 */
    double push;     /* m/s2, largest acceleration by applied forces at the last check */
    bool debris_reported; /* the residual of the ledger is attributed to debris, which is being
                             resolved */
    bool debris_read;     /* the step is measured because of debris */
    int64_t broken_without_debris; /* bonds that were broken when no debris was found (debris.c) */
} gn_step_choice;

#endif
