/* A body of elements at rest under its motions and loads, K u = f, at a time of its course
 * (rest_state.c): what it comes to where it is loaded slowly. */
#ifndef GN_CONVERSION_REST_STATE_H
#define GN_CONVERSION_REST_STATE_H

#include "base/error.h"
#include "conversion/load_course.h"
#include "fem/linear.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct gn_rest {
    gn_world *w;
    gn_course course; /* borrowed */
    gn_fem_linear linear;
    size_t count; /* [nodes][dimension] */
    size_t at;    /* part and time, s, that nodes were solved for */
    double time;
    bool unloaded;  /* by motions alone */
    double inertia; /* 1/s2, which holds what nothing else holds */
    double *u;      /* m, over scale where it is free */
    double *load;   /* N, times scale */
    double *weight; /* preconditioner */
    double *residual, *search, *image, *better;
} gn_rest;

gneiss_status gn_rest_make(gn_world *world, const gn_course *course, gn_rest *rest,
                           gneiss_error *error);
void gn_rest_free(gn_rest *rest);
/* Solves for a time of a part. */
void gn_rest_find(gn_rest *rest, size_t part, double time);
/* Puts nodes where the solution has them, so many times as far; whether any moves. */
bool gn_rest_put(const gn_rest *rest, double times);
/* s: of waves along the longest side of a body, of a bar's speed. */
double gn_wave_travel(const gn_step_context *ctx, const gn_solids *solids);
/* s: the longest period of what the last loads move, by inverse iteration; of a body that nothing
 * holds that of waves along it. 0: nothing moves. The solution is lost. */
double gn_rest_period(gn_rest *rest);
/* Times a limit: of an even wave that the quickest change of a motion, within the time that waves
 * take along the body, would send off, rho c v, pulling or pressing. */
gneiss_status gn_rest_burst(const gn_rest *rest, double *times, gneiss_error *error);

#endif
