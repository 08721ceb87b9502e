/* The particles whose displacements give the average strain of the specimen during a run. */
#ifndef GN_LABORATORY_STRAIN_GAUGE_H
#define GN_LABORATORY_STRAIN_GAUGE_H

#include "base/error.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "measure/measure.h"

#include <stddef.h>
#include <stdint.h>

/* Weights of the particles in the average strain of the specimen. */
struct gn_gauge {
    gn_strain_gauge weights;
    int32_t *belongs; /* [count] by id: 1 if a particle contributes, see strain_gauge.c */
    size_t count;     /* 0: without bonds */
};

/* Creates the gauge for the initial state. Writes the gauge only. */
gneiss_status gn_gauge_create(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error);

/* Records, once contacts are known, the pieces that are separate from the start: they never
 * belonged to the specimen and do not detach from it. */
void gn_gauge_note_apart(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge);

/* Updates the gauge every 100 steps: particles detached from a bonded specimen are left out
 * permanently, and the gauge is rebuilt from the rest, with the positions of the start; it is empty
 * when less than half of the volume is left. Nothing can detach before a bond has broken, been
 * dissolved or been removed. In a model with finite elements, which may connect separate parts,
 * only removed particles are left out. */
gneiss_status gn_gauge_update(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error);

/* Leaves out removed particles at once. */
gneiss_status gn_gauge_leave(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                             gneiss_error *error);

/* Returns the mean displacement gradient of the particles (gn_strain_gauge_read); dormant ones have
 * the displacements of their elements. */
void gn_gauge_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_gauge *gauge, double gradient[9]);

#endif
