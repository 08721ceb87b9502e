/* Definitions of the opaque handles of the public API. */
#ifndef GN_API_HANDLES_H
#define GN_API_HANDLES_H

#include "gneiss/gneiss.h"
#include "run/run.h"

struct gneiss_scene {
    gn_scene scene;
    char *text; /* the resolved scene */
    gneiss_prepare *prepare;
    void *context; /* context of prepare */
};

/* A hook of a program: a call between steps, or a field of force. */
typedef struct gn_api_hook {
    int64_t number;
    gneiss_call *call; /* NULL: removed */
    int64_t every;     /* number of steps; 0: none */
    double *times;     /* [time_count] s */
    size_t time_count, next;
    gneiss_force *force;  /* NULL: removed */
    gneiss_record record; /* particles or nodes, on which the field acts */
    double stiffness;     /* N/m */
    void *context;
} gn_api_hook;

/* The hooks of a world, which are one feature of it (frame/feature.h). */
typedef struct gn_api_hooks {
    bool added;  /* the feature has been added to the world */
    bool inside; /* a call is running, so that the world must not be advanced */
    bool acting; /* a field of force is being evaluated, so that nothing may be changed */
    volatile sig_atomic_t due;
    int64_t numbers; /* number of hooks added so far */
    size_t count;
    gn_api_hook *hook; /* [count] */
    double *load;      /* [load_count][6] N, N m: sum of all fields on particles, then on nodes */
    double *force, *moment; /* [load_count][3] scratch for a single field */
    size_t load_count;      /* number of particles and nodes */
    double lightest[2];     /* 1/kg: largest inverse mass of particles, and of nodes */
} gn_api_hooks;

struct gneiss_world {
    gn_run run;           /* directory "": nothing is written */
    gneiss_error failure; /* error that ended the world permanently; status GNEISS_OK: none */
    gn_api_hooks hooks;
};

void gn_api_hooks_free(gn_api_hooks *hooks);
/* Runs the calls that are due. GNEISS_INTERRUPTED: one of them has ended the advance. */
gneiss_status gn_api_hooks_call(gneiss_world *world, gneiss_error *error);
/* Fails if called inside a field of force. */
gneiss_status gn_api_require_whole(const gneiss_world *world, gneiss_error *error);
/* Fails if called inside a field of force, or after the world has failed. */
gneiss_status gn_api_require_good(const gneiss_world *world, gneiss_error *error);

/* Fails with GNEISS_ERROR_INPUT if `pointer` is NULL; `what` is the name of the argument. */
gneiss_status gn_api_require(const void *pointer, const char *what, gneiss_error *error);

#endif
