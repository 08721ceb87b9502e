/* Elements that turn into particles while a run goes on. The body is packed at the start: its
 * particles are asleep, without mass, contacts and blocks to work on, and follow nothing; the bonds
 * of all of them are formed and put by. Where stresses are high (couple/front.h) elements go, the
 * particles in them wake, with the displacements, velocities and half the curl of what they were
 * in, and so do those of a new zone between both, in which particles follow nodes as in any other
 * zone (zones.h). */
#ifndef GN_CONVERSION_CONVERSION_H
#define GN_CONVERSION_CONVERSION_H

#include "base/error.h"
#include "couple/ties.h"
#include "frame/parts.h"
#include "frame/step_context.h"
#include "limit/step_limits.h"
#include "particles/dem.h"
#include "zones/zones.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static inline bool gn_converts(const gn_step_context *ctx) {
    return ctx->scene.has_couple && ctx->scene.couple.has_convert;
}
/* Whether elements convert, and have all of the body at both places. */
static inline bool gn_conversion_hides(const gn_step_context *ctx, const gn_dem *dem, int32_t i,
                                       int32_t j) {
    const double *part = dem->particles.blend;
    return gn_converts(ctx) && !(part[2 * (size_t)i] + part[2 * (size_t)j] > 0.0);
}

/* Before bonds are formed: which element each particle is in. */
gneiss_status gn_conversion_prepare(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gneiss_error *error);
/* Puts the bonds by and the particles to sleep. */
gneiss_status gn_conversion_lay_down(const gn_step_context *ctx, gn_dem *dem,
                                     const gn_boundary *boundary, const gn_solids *solids,
                                     gn_zones *zones, gneiss_error *error);
/* Marks the blocks of particles that all sleep, when lists are made. */
gneiss_status gn_conversion_find_still(gn_dem *dem, gneiss_error *error);
/* Of the particles that are awake in elements that are there. */
gneiss_status gn_conversion_ties(const gn_dem *dem, const gn_solids *solids, gn_ties *ties,
                                 gneiss_error *error);

/* Between two steps: every so many of them looks at the stresses, and converts. */
gneiss_status gn_conversion_look(gn_world *world, gneiss_error *error);
/* What came nearest to a limit so far, the present state included. */
gneiss_status gn_conversion_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                                        const gn_most_loaded *most_loaded, gn_most_loaded *most,
                                        gneiss_error *error);
/* Whether any element has been converted. */
bool gn_conversion_begun(const gn_solids *solids);
/* Converts what is marked as GN_FRONT_LEAVING, and what goes with it. `kind` [elements]: as
 * gn_conversion_kinds has it, and changed. Where more would have to go than may, nothing goes, and
 * world->halt says what. */
gneiss_status gn_conversion_kinds(const gn_step_context *ctx, const gn_solids *solids,
                                  uint8_t *kind, gneiss_error *error);
gneiss_status gn_conversion_convert(gn_world *world, uint8_t *kind, gneiss_error *error);
/* Converts the elements that are loaded to at least this part of a limit. */
gneiss_status gn_conversion_convert_above(gn_world *world, double part, gneiss_error *error);

/* What that would come to, with nothing changed but world->halt and `kind`: how many rings of
 * elements would go along. */
gneiss_status gn_conversion_rehearse(gn_world *world, uint8_t *kind, int *rings,
                                     gneiss_error *error);

/* Whether world->halt says that conversion came to the end of couple.convert.box. */
bool gn_conversion_left_box(const gn_ending *outcome);
/* That particles are too few for the mass of what would go. */
bool gn_conversion_was_thin(const gn_ending *outcome);
/* That it came to elements whose nodes a motion only watches. */
bool gn_conversion_met_watched(const gn_ending *outcome);
/* What is to be said of motions that only watch nodes of elements which would convert otherwise,
 * in `text`, which it returns; "" where none does. */
const char *gn_conversion_watches(const gn_step_context *ctx, const gn_solids *solids, char *text,
                                  size_t size);
/* Whether nodes of what is driven or loaded would have had too little of the body. */
bool gn_conversion_left_bare(const gn_ending *outcome);

/* Places of an unconverted body that may convert, looked at by themselves: how many there are; how
 * many of them take elements around along, and at how many particles are too few all the same;
 * those where the box ends count for nothing (conversion_check.c). */
typedef struct gn_conversion_places_seen {
    size_t looked, along, too_few;
} gn_conversion_places_seen;
gneiss_status gn_conversion_see_places(gn_world *world, gn_conversion_places_seen *seen,
                                       gneiss_error *error);

/* What is in the box (conversion_check.c): elements, and the particles that sleep in them, at the
 * start all. */
typedef struct gn_conversion_figures {
    size_t elements, held, particles; /* held: of motions and loads */
    double element, diameter;         /* m, means */
    double smallest;  /* m, of elements: the least of what `element` is the mean of */
    double side;      /* m, the shortest of the body of elements */
    double mass;      /* of the particles over that of the elements */
    size_t materials; /* of the elements, with the packing in each */
    gn_zone_material material[GN_ZONE_MATERIALS];
} gn_conversion_figures;
gneiss_status gn_conversion_measure(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gn_conversion_figures *figures, gneiss_error *error);

/* For who looks at a scene at its start, when all of the particles sleep: the body as though they
 * were all awake and bonded; a second call puts that back. Else nothing is done. */
void gn_conversion_turn_over(const gn_step_context *ctx, gn_dem *dem);
/* The limits that all of them would have by themselves. */
gneiss_status gn_conversion_limit(gn_world *world, gn_step_limit *limit, gneiss_error *error);

/* Particles that sleep (conversion_readings.c). */
size_t gn_conversion_asleep(const gn_dem *dem);
/* Elements that are there. */
size_t gn_conversion_elements(const gn_solids *solids);

/* [elements of the mesh] places of those that are there, for gn_conversion_travel (gn_fem_places);
 * NULL where nothing converts, or without memory. The caller's. */
int32_t *gn_conversion_places(const gn_step_context *ctx, const gn_solids *solids);
/* m: how far a particle has come; one that sleeps is where the elements have the body, not a number
 * without their places. In any world (conversion_readings.c). */
void gn_conversion_travel(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                          size_t p, double u[3]);
/* m/s: the same of its velocity. */
void gn_conversion_velocity(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                            size_t p, double v[3]);
/* The mean displacement gradient of the particles (gn_strain_gauge_read), those that sleep being
 * where the elements have them. In any world. */
void gn_conversion_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_gauge *gauge, double gradient[9]);

#endif
