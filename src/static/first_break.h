/* Where a quasi-static test breaks first, and the equilibrium shortly before, without steps. */
#ifndef GN_STATIC_FIRST_BREAK_H
#define GN_STATIC_FIRST_BREAK_H

#include "world/world.h"

typedef struct gn_first_break {
    double time;     /* s, at which the first bond breaks, if all goes on as at the start */
    int64_t i, j;    /* its particles, by id */
    double place[3]; /* m, between them, as the user sees it */
    double start;    /* s: the time of the state that was found */
    int64_t steps;   /* that it would have taken, of the step that the world has now */
    int64_t increments, solutions, iterations; /* states on the way, linear systems, their steps */
    double unbalanced; /* mean load on a particle over the mean contact force, at the start */
    double
        shortfall; /* J, by how much trapezoidal sums of the works would have missed the energy */
} gn_first_break;

/* Told of every state on the way, the first and the last among them, with the reading of the world
 * up to date: the world is not to be changed. */
typedef struct gn_first_break_watch {
    gneiss_status (*state)(void *context, const gn_first_break *so_far, gneiss_error *error);
    void *context;
} gn_first_break_watch;

/* Takes a world that has not made a step to the equilibrium at scene.start_fraction of the time of
 * the first break; the next step goes on from there, with the velocities of steady loading.
 * GNEISS_ERROR_INPUT, with the place of time.start: there is none. */
gneiss_status gn_first_break_start(gn_world *world, const gn_first_break_watch *watch,
                                   gn_first_break *found, gneiss_error *error);

#endif
