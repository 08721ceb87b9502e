/* The first bond failure of a quasi-static test, and the equilibrium shortly before it, without
 * time steps. */
#ifndef GN_STATIC_FIRST_BREAK_H
#define GN_STATIC_FIRST_BREAK_H

#include "frame/parts.h"
#include "world/world.h"

typedef struct gn_first_break {
    double time;  /* s, time at which the first bond fails if loading continues as at the start */
    int64_t i, j; /* ids of the particles of the bond */
    double place[3]; /* m, midpoint of its particles in absolute coordinates */
    double start;    /* s: time of the resulting state */
    int64_t steps;   /* number of time steps replaced, of the present length */
    /* states on the path, linear systems, and their iterations */
    int64_t increments, solutions, iterations;
    /* mean unbalanced load of a particle over the mean contact force, at the start */
    double unbalanced;
    double shortfall; /* J, difference of the energies to trapezoidal sums of the works */
} gn_first_break;

/* A callback for every state on the path, including the first and the last, with up-to-date
 * readings of the world, which it must not change. */
typedef struct gn_first_break_watch {
    gneiss_status (*state)(void *context, const gn_first_break *so_far, gneiss_error *error);
    void *context;
} gn_first_break_watch;

/* Advances a world that has made no step to the equilibrium at scene.start_fraction of the time of
 * the first failure; the next step continues from there, with the velocities of steady loading.
 * GNEISS_ERROR_INPUT, with the place of time.start: there is no such equilibrium. */
gneiss_status gn_first_break_start(gn_world *world, const gn_first_break_watch *watch,
                                   gn_first_break *found, gneiss_error *error);

/* Advances a world that has made no step through equilibria, without steps, for the elastic
 * constants of a test: its largest prescribed displacement grows `count` times by `path`/`count`,
 * m. Bonds do not break, whatever their strength. `watch` is called with the first state, under the
 * loads at the start, and with each later one. Motions become steady and slow; their displacements
 * are those of the scene's motions when the largest reaches `path`. GNEISS_ERROR_INPUT: no
 * displacement reaches `path`, or there is no equilibrium. */
gneiss_status gn_static_loading(gn_world *world, double path, int count,
                                const gn_first_break_watch *watch, gn_first_break *found,
                                gneiss_error *error);

#endif
