/* Definitions of the opaque handles of the public API. */
#ifndef GN_API_HANDLES_H
#define GN_API_HANDLES_H

#include "gneiss/gneiss.h"
#include "run/run.h"

struct gneiss_scene {
    gn_scene scene;
    char *text; /* the resolved scene */
};

struct gneiss_world {
    gn_run run;           /* directory "": nothing is written */
    gneiss_error failure; /* error that ended the world permanently; status GNEISS_OK: none */
};

/* Fails with GNEISS_ERROR_INPUT if `pointer` is NULL; `what` is the name of the argument. */
gneiss_status gn_api_require(const void *pointer, const char *what, gneiss_error *error);

#endif
