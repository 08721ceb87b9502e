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
    int32_t *belongs; /* [count] by id: role of a particle, see strain_gauge.c */
    size_t count;     /* 0: there are no bonds */
};

/* Creates the gauge for the initial state; changes nothing else. */
gneiss_status gn_gauge_create(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error);

/* Records, once contacts are known, the fragments that are separate from the start: they never
 * belonged to the specimen, so that they cannot detach from it. */
void gn_gauge_note_apart(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge);

/* Updates the gauge every 100 steps. Particles detached from a bonded specimen are excluded
 * permanently, and the gauge is rebuilt from the rest, with the positions at the start; it is empty
 * when less than half of the volume is left. Nothing can detach before a bond has broken, been
 * dissolved or been removed. In a model with finite elements, which may connect separate parts,
 * only removed particles are excluded. */
gneiss_status gn_gauge_update(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error);

/* Excludes removed particles at once. */
gneiss_status gn_gauge_leave(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                             gneiss_error *error);

/* Computes the mean displacement gradient of the particles (gn_strain_gauge_read); dormant
 * particles have the displacements of their elements. */
void gn_gauge_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_gauge *gauge, double gradient[9]);

#endif
