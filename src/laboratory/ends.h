/* The two ends of a test. */
#ifndef GN_LABORATORY_ENDS_H
#define GN_LABORATORY_ENDS_H

#include "base/error.h"
#include "frame/parts.h"
#include "frame/step_context.h"

#include <stdbool.h>
#include <stddef.h>

/* How the ends of a test come to its specimen (ends.c). */
struct gn_approach {
    double
        away[2]; /* 1: the lower (upper) end began away, and has not yet borne when the other did */
    double gap;  /* m, at the start, of the ends that were away */
    double way;  /* m, of both ends when the last of them touched it */
};

/* Change of the distance of the ends, m, positive in the sense of the test. In shear walls along
 * the plane that are not moved along it do not count beside others. */
double gn_ends_deflection(const gn_world *world);
/* The same since both ends have touched the specimen, m; 0 before that. */
double gn_ends_shortening(const gn_world *world);
/* Of the gauge of the test, m. */
double gn_ends_opening(const gn_world *world);
/* Of a shear test: forces of the ends across the plane, pressing positive, N; an end that neither
 * holds nor presses there has that of the other. How far the ends come apart, m. */
void gn_ends_normals(const gn_world *world, double *lower, double *upper);
double gn_ends_dilation(const gn_world *world);
/* Between the innermost places of both ends along the normal of a shear test, at the start, m: of
 * sets centres, of walls their plane, of bodies corners, of elements without particles nodes. Not
 * positive: the ends overlap or are empty; infinite: nothing is known of an end, as of bodies that
 * are not made yet. */
double gn_ends_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids);
/* m: the same where it is more than a particle and less than the height of the specimen along the
 * normal, else that height. */
double gn_ends_free(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    const gn_solids *solids);
/* Whether nothing keeps the ends of a shear test from coming apart, so that there is no normal
 * stress; `text` then says so with its place. */
bool gn_shear_is_loose(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);
/* Whether a wall that is an end of a test begins deep inside its specimen or far away from it, or
 * stands tilted; `text` then says so with its place. */
bool gn_ends_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    char *text, size_t size);
/* GNEISS_ERROR_INPUT where both ends are on one side, share particles or nodes, or the upper one is
 * below the other; of walls the scene is checked before. After all parts are made. */
gneiss_status gn_ends_check(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            gneiss_error *error);
/* GNEISS_ERROR_INPUT where nothing stands beside the specimen of an oedometer test, at one of its
 * sides or nearer than a tenth of its width. After all parts are made. */
gneiss_status gn_sides_check(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids,
                             gneiss_error *error);
/* Forces of the ends along the axis, N, positive in the sense of the test. An end that is only
 * watched (what loads it is a traction) has the force of the other one. */
void gn_ends_forces(const gn_world *world, double *lower, double *upper);

/* Distances from both ends to the specimen at the start, m, not below 0; whether they are so large
 * that the ends begin away from it. Ends that press along the axis alone. */
void gn_ends_gaps(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                  const gn_solids *solids, double *lower, double *upper, bool away[2]);
/* After all parts are made: notes whether the ends are away from the specimen. */
void gn_ends_begin(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids, gn_approach *approach);
/* Once forces are known: notes where the ends have touched it. `still`: in an equilibrium, which
 * may be far beyond the first touch. */
void gn_ends_look(gn_world *world, bool still);

void gn_control_create(gn_step_context *ctx);
/* Looks at the reading every so many steps; before the forces of a step. */
void gn_control_look(gn_world *world);

/* Mean displacement of a set from the start along an axis, m. */
double gn_set_travel(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     size_t set, int axis);

#endif
