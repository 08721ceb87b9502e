/* The two ends of a test. */
#ifndef GN_LABORATORY_ENDS_H
#define GN_LABORATORY_ENDS_H

#include "base/error.h"
#include "frame/frame.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Approach of the ends of a test to the specimen (ends.c). */
struct gn_approach {
    double away[2]; /* 1: the lower (upper) end began away from the specimen, and was not loaded
                       when the other end first was */
    double gap;     /* m, gaps at the start of the ends that were away */
    double way;     /* m, travel of both ends when the last of them touched the specimen */
};

/* Returns the change of the distance of the ends, m, positive in the sense of the test. In shear,
 * walls along the plane that do not move along it do not count if there are other parts. */
double gn_ends_deflection(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids);
/* Returns the change of the distance since both ends touched the specimen, m; 0 before that. */
double gn_ends_shortening(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_boundary *boundary, const gn_solids *solids,
                          const gn_approach *approach);
/* Returns the opening of the gauge of the test, m. */
double gn_ends_opening(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids);
/* Computes the forces, N, of the ends of a shear test across the plane, pressing positive; an end
 * that is neither held nor pressed there gets the force of the other. The dilation is the change of
 * distance of the ends, m. */
void gn_ends_normals(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, double *lower, double *upper);
double gn_ends_dilation(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids);
/* Returns the distance, m, between the innermost positions of both ends along the normal of a shear
 * test, at the start: centres of sets, planes of walls, corners of bodies, nodes of elements
 * without particles. Not positive: the ends overlap or are empty; infinite: an end is not known,
 * such as bodies that have not been created yet. */
double gn_ends_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids);
/* Returns the distance of the ends, m, if it is more than a particle and less than the height of
 * the specimen along the normal, else that height. */
double gn_ends_free(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    const gn_solids *solids);
/* Tells whether nothing prevents the ends of a shear test from separating, so that there is no
 * normal stress; `text` then states it with its place. */
bool gn_shear_is_unsupported(const gn_step_context *ctx, const gn_dem *dem, char *text,
                             size_t size);
/* Tells whether a wall that is an end of a test begins deep inside its specimen, far away from it,
 * or tilted; `text` then states it with its place. */
bool gn_ends_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    char *text, size_t size);
/* Returns GNEISS_ERROR_INPUT if both ends are on one side, share particles or nodes, or the upper
 * one is below the other; the scene is checked for walls before. Call after all parts are made. */
gneiss_status gn_ends_check(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            gneiss_error *error);
/* Returns GNEISS_ERROR_INPUT if at a side of the specimen of an oedometer test no body is nearer to
 * it than a tenth of its width. Call after all parts are made. */
gneiss_status gn_sides_check(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids,
                             gneiss_error *error);
/* Computes the forces of the ends along the axis, N, positive in the sense of the test. An end that
 * is only observed (its load is a traction) gets the force of the other one. */
void gn_ends_forces(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    const gn_solids *solids, double *lower, double *upper);

/* Computes the distances from both ends to the specimen at the start, m, not below 0; tells whether
 * they are so large that the ends begin away from it. Only for ends that press along the axis
 * alone. */
void gn_ends_gaps(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                  const gn_solids *solids, double *lower, double *upper, bool away[2]);
/* Records after all parts are made whether the ends are away from the specimen. */
void gn_ends_begin(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids, gn_approach *approach);
/* Records, once forces are known, at which positions the ends touched the specimen. `still`: the
 * state is an equilibrium, which may be far beyond the first contact. */
void gn_ends_note_contact(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          gn_solids *solids, gn_approach *approach, bool still);

void gn_control_create(gn_step_context *ctx);
/* Updates the control by the reading at intervals of steps, before the forces of a step. */
void gn_control_update(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, gn_solids *solids,
                       gn_gauge *gauge);

/* Returns the mean displacement of a set since the start along an axis, m. */
double gn_set_travel(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     size_t set, int axis);

#endif
