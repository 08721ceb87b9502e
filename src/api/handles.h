/* What the opaque handles of the public API stand for. */
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
    gneiss_error failure; /* what ended it for good; status GNEISS_OK: nothing */
};

/* GNEISS_ERROR_INPUT unless `pointer` is there; `what` is the name of the argument. */
gneiss_status gn_api_require(const void *pointer, const char *what, gneiss_error *error);

#endif
