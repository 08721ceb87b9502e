/* Fragments: particles connected by bonds. */
#ifndef GN_PARTICLES_FRAGMENTS_H
#define GN_PARTICLES_FRAGMENTS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_fragments {
    double count;   /* number of fragments of two or more particles; NaN: no bonds */
    double largest; /* share of the particles' volume in the largest fragment */
} gn_fragments;
/* Allocates the scratch of the functions below. To be called when the number of particles is known.
 * */
gneiss_status gn_pieces_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gn_fragments gn_dem_fragments(const gn_step_context *ctx, const gn_dem *dem);

/* Returns the volume of the particles, m3 (2D: m2 x 1 m), in anchored fragments. A fragment is
 * anchored if one of its particles has a prescribed velocity, shares its material with elements, or
 * is dormant. If none is anchored, returns the volume of the largest fragment. 0: no bonds. */
double gn_dem_anchored_volume(const gn_step_context *ctx, const gn_dem *dem);
/* Returns the volume, m3, of the particles that are in no anchored fragment and whose centres were
 * outside of low <= x <= high along an axis at the start. */
double gn_dem_loose_volume_outside(const gn_step_context *ctx, const gn_dem *dem, int axis,
                                   double low, double high);

/* A fragment, one particle or more. */
typedef struct gn_fragment {
    double volume;      /* m3, in 2D m2 x 1 m, of its particles */
    double mass;        /* kg, without mass added for a longer step */
    double centre[3];   /* m, centre of mass in the user's coordinates; in a periodic box, of the
                           images nearest to its first particle */
    double velocity[3]; /* m/s, velocity of the centre, half a step before the instant */
    int32_t particles, first; /* number of particles; the smallest of their ids */
} gn_fragment;

typedef struct gn_fragment_list {
    gn_fragment *row; /* sorted by volume, the largest first, then by least id */
    size_t count;
    int32_t *of; /* [particles] row, -1: removed or dormant */
} gn_fragment_list;

/* Lists the fragments; empty without bonds. The caller frees the list, also on failure. */
gneiss_status gn_fragments_list(const gn_step_context *ctx, const gn_dem *dem,
                                gn_fragment_list *list, gneiss_error *error);
void gn_fragments_free(gn_fragment_list *list);

/* Returns the sizes of bodies, which are particles connected by intact bonds and touching contacts:
 * members[p] is the number of particles of the body of p, 0 for removed particles; NULL without
 * bonds. Valid until the next call of this function or of gn_fragments_list. */
const int32_t *gn_dem_body_sizes(const gn_step_context *ctx, const gn_dem *dem);

/* Tells whether a bond has broken or was dissolved, or a particle has left the domain. */
bool gn_dem_has_loosened(const gn_dem *dem);

/* A body with fewer particles than the largest one over this number counts as detached from it. */
enum { GN_CHIP = 10 };

/* Finds bodies for the membrane: group[p] is a representative of the body of p. Bodies with less
 * than 1/chip of the particles of the largest body count as part of it. Returns the number of
 * bodies; 1 without bonds, and before bonds are formed. `group` [particles]. */
size_t gn_dem_body_groups(const gn_step_context *ctx, const gn_dem *dem, int32_t chip,
                          int32_t *group);

#endif
