/* The particles of another run at its end, from its results.h5, or those of a packing, as the
 * specimen of this one. */
#ifndef GN_PARTICLES_FROM_RUN_H
#define GN_PARTICLES_FROM_RUN_H

#include "base/error.h"
#include "scene/scene.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_from_run {
    size_t count;        /* particles, without removed ones */
    double *sphere;      /* [count][4] x y z r, m, in the user's coordinates */
    double *motion;      /* [count][6] m/s, rad/s; NULL unless requested, and for a packing */
    size_t bonds;        /* bonds, and overlaps that are free of stress; 0 unless requested */
    int32_t (*bond)[2];  /* [bonds] by place in `sphere` */
    double *rest_length; /* [bonds] m, stress-free distance */
    uint8_t *holds;      /* [bonds] 1: intact; 0: broken, dissolved or never a bond */
    double volume;       /* m3 (2D: m2) of the packed body; 0 for a run */
} gn_from_run;

/* Reads the run that specimen.from names, with the data that the scene requests. */
gneiss_status gn_from_run_read(const gn_scene *scene, gn_from_run *from, gneiss_error *error);
void gn_from_run_free(gn_from_run *from);

#endif
