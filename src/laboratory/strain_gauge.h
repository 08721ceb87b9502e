/* Whose displacements tell the average strain of the specimen, while a run goes on. */
#ifndef GN_LABORATORY_STRAIN_GAUGE_H
#define GN_LABORATORY_STRAIN_GAUGE_H

#include "base/error.h"
#include "frame/parts.h"
#include "frame/step_context.h"
#include "measure/measure.h"

#include <stddef.h>
#include <stdint.h>

/* Weights of the particles in the average strain of the specimen. */
struct gn_gauge {
    gn_strain_gauge weights;
    int32_t *belongs; /* [count] by id: 1 if a particle contributes, see strain_gauge.c */
    size_t count;     /* 0: without bonds */
};

/* The gauge of the start (gn_strain_gauge_create). Writes the gauge and world.belongs alone. */
gneiss_status gn_gauge_create(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error);

/* Once it is there, with contacts known: pieces that lie apart from the start were never of the
 * specimen's, so do not come off it. */
void gn_gauge_note_apart(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge);

/* Every 100 steps: what has come off a bonded specimen counts no longer, for good; of what is left
 * there is a new gauge, with the places of the start. None once less than half of the volume is
 * left. Before anything has broken, been dissolved or removed nothing has come off. Beside finite
 * elements, which may hold what looks apart, only what was removed has left. */
gneiss_status gn_gauge_look(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                            gneiss_error *error);

/* The same at once after particles were removed, of these alone. */
gneiss_status gn_gauge_leave(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                             gneiss_error *error);

/* The mean displacement gradient of the particles (gn_strain_gauge_read), those that sleep being
 * where the elements have them. In any world. */
void gn_gauge_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_gauge *gauge, double gradient[9]);

#endif
