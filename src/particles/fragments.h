/* Pieces that bonds hold together. */
#ifndef GN_PARTICLES_FRAGMENTS_H
#define GN_PARTICLES_FRAGMENTS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gn_fragments {
    double count;   /* of two or more particles; NaN: no bonds */
    double largest; /* share of the particles' volume that the largest has */
} gn_fragments;
/* Once the particles are there. */
gneiss_status gn_pieces_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gn_fragments gn_world_fragments(const gn_step_context *ctx, const gn_dem *dem);

/* Volume of the particles, m3 (2D: m2 x 1 m), in pieces that are anchored: a particle of theirs has
 * a prescribed velocity, or elements have a share of it. If there is none, that of the largest
 * piece. Dormant particles count as anchored. 0: no bonds. */
double gn_world_anchored_volume(const gn_step_context *ctx, const gn_dem *dem);

/* A piece, one particle or more. */
typedef struct gn_fragment {
    double volume;      /* m3, in 2D m2 x 1 m, of its particles */
    double mass;        /* kg, without what was added for a longer step */
    double centre[3];   /* m, of mass, as the user sees it; in periodic boxes of the images next to
                           its first particle */
    double velocity[3]; /* m/s, of that, half a step before the instant */
    int32_t particles, first; /* the least of their ids */
} gn_fragment;

typedef struct gn_fragment_list {
    gn_fragment *row; /* the largest volume first, of the same the least id */
    size_t count;
    int32_t *of; /* [particles] row, -1: removed or dormant */
} gn_fragment_list;

/* With bonds, else there are none. The caller frees, also on failure. */
gneiss_status gn_fragments_list(const gn_step_context *ctx, const gn_dem *dem,
                                gn_fragment_list *list, gneiss_error *error);
void gn_fragments_free(gn_fragment_list *list);

/* Bodies: what bonds that hold and contacts that touch keep together. members[p] is how many
 * particles the body of p has, 0 of particles that have left; NULL without bonds. Until the next
 * call of either. */
const int32_t *gn_world_bodies(const gn_step_context *ctx, const gn_dem *dem);

/* Tells whether a bond has broken or was dissolved, or a particle has left the domain. */
bool gn_world_has_loosened(const gn_dem *dem);

/* A body with fewer particles than this share of the largest one's has come off it. */
enum { GN_CHIP = 10 };

/* Bodies as the membrane sees them: group[p] is a particle that stands for the body of p, and for
 * bodies of less than 1/chip of the largest one's particles that of the largest. Returns how many
 * there are; 1 without bonds, and before there are any. `group` [particles]. */
size_t gn_world_body_groups(const gn_step_context *ctx, const gn_dem *dem, int32_t chip,
                            int32_t *group);

#endif
