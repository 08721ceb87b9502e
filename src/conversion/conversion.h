/* Elements that turn into particles during a run. The body is packed at the start. Its particles
 * are dormant: they have no mass and no contacts, their blocks are skipped, and they do not move;
 * their bonds are formed and stored. Where stresses are high (couple/front.h) elements are removed,
 * and the particles in them are activated with the displacement and velocity of the elements and
 * half the curl of the velocity. So are the particles of the new zone between both, which follow
 * nodes as in any other zone (zones.h). */
#ifndef GN_CONVERSION_CONVERSION_H
#define GN_CONVERSION_CONVERSION_H

#include "base/error.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "limit/step_limits.h"
#include "particles/particles.h"
#include "zones/zones.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The parts of a model whose elements convert; world/convertible.h makes it. */
typedef struct gn_convertible {
    gn_step_context *ctx;
    gn_dem *dem;
    gn_boundary *boundary;
    gn_solids *solids;
    gn_zones *zones;
    gn_conversions *converted;
    gn_most_loaded *most_loaded;
    gn_ledger *ledger;
    gn_ending *outcome;
    gneiss_status (*rebuild)(gn_world *world, gneiss_error *error); /* rebuilds all lists */
    gn_world *world;                                                /* passed to `rebuild` */
} gn_convertible;

/* Finds the element that contains each particle. Must be called before bonds are formed. */
gneiss_status gn_conversion_prepare(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gneiss_error *error);
/* Stores the bonds and makes all particles dormant. */
gneiss_status gn_conversion_deactivate_all(const gn_step_context *ctx, gn_dem *dem,
                                           const gn_boundary *boundary, const gn_solids *solids,
                                           gn_conversions *converted, gneiss_error *error);
/* Called between two steps: evaluates the stresses at a fixed interval of steps, and converts
 * elements beyond their limits. */
gneiss_status gn_conversion_check_limits(const gn_convertible *model, gneiss_error *error);
/* Returns the element that was nearest to a limit so far, including the present state. */
gneiss_status gn_conversion_most_loaded(const gn_step_context *ctx, const gn_solids *solids,
                                        const gn_most_loaded *most_loaded, gn_most_loaded *most,
                                        gneiss_error *error);
/* gn_conversion_kinds sets kind[elements]; gn_conversion_convert converts the elements marked as
 * GN_FRONT_LEAVING, with the neighbours that have to convert as well, and updates `kind`. If one of
 * these may not convert, nothing is converted, and outcome->halt gives the reason. */
gneiss_status gn_conversion_kinds(const gn_step_context *ctx, const gn_solids *solids,
                                  uint8_t *kind, gneiss_error *error);
gneiss_status gn_conversion_convert(const gn_convertible *model, uint8_t *kind,
                                    gneiss_error *error);
/* Converts the elements that are loaded to at least the fraction `part` of a limit. */
gneiss_status gn_conversion_convert_above(const gn_convertible *model, double part,
                                          gneiss_error *error);

/* Tests a conversion without performing it; only outcome->halt and `kind` change. *rings: number of
 * rings of neighbouring elements that would convert as well. */
gneiss_status gn_conversion_dry_run(const gn_convertible *model, uint8_t *kind, int *rings,
                                    gneiss_error *error);

/* Tells whether outcome->halt reports that conversion reached the end of couple.convert.box.
 */
bool gn_conversion_ended_at_box(const gn_ending *outcome);
/* Tells whether outcome->halt reports too few particles for the mass of the converting elements. */
bool gn_conversion_lacked_mass(const gn_ending *outcome);
/* Tells whether outcome->halt reports elements with nodes of a motion that only records
 * displacements. */
bool gn_conversion_reached_watched(const gn_ending *outcome);
/* Writes a warning about recording motions that prevent elements from converting; "" if there are
 * none. Returns `text`. */
const char *gn_conversion_watches(const gn_step_context *ctx, const gn_solids *solids, char *text,
                                  size_t size);
/* Tells whether outcome->halt reports driven or loaded nodes that would be left with too little
 * mass. */
bool gn_conversion_left_light_nodes(const gn_ending *outcome);

/* Result of trial conversions at single places of an unconverted body: the number of places, how
 * many of them require neighbouring elements to convert as well, and how many have too few
 * particles nevertheless. Places at the end of the box are not counted (conversion_limits.c). */
typedef struct gn_conversion_places_checked {
    size_t looked, along, too_few;
} gn_conversion_places_checked;
gneiss_status gn_conversion_check_places(const gn_convertible *model,
                                         gn_conversion_places_checked *seen, gneiss_error *error);

/* Properties of the elements in the box and of the dormant particles in them (conversion_setup.c);
 * at the start all particles are dormant. */
typedef struct gn_conversion_figures {
    size_t elements, held, particles; /* `held`: elements with nodes of motions and loads */
    double element, diameter;         /* m, means */
    double smallest;                  /* m, smallest size of an element (`element` is the mean) */
    double side;                      /* m, the shortest side of the body of elements */
    double mass;                      /* mass of the particles over that of the elements */
    size_t materials; /* number of materials of the elements; the packing in each of them */
    gn_zone_material material[GN_ZONE_MATERIALS];
} gn_conversion_figures;
gneiss_status gn_conversion_measure(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    gn_conversion_figures *figures, gneiss_error *error);

/* Computes the limits for all elements; each element is treated as separate from the others. */
gneiss_status gn_conversion_limit(const gn_convertible *model, gn_step_limit *limit,
                                  gneiss_error *error);

#endif
