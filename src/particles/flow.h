/* Particles that enter and leave: sources, sinks, and particles that left the domain. The part of
 * particles (particles.h) owns all of it. Sources and sinks act when lists are made, so that other
 * code treats new particles like all others. */
#ifndef GN_PARTICLES_FLOW_H
#define GN_PARTICLES_FLOW_H

#include "frame/parts.h"

#include "base/error.h"
#include "pack/domain.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All members are doubles, so that checkpoints store them directly. */
typedef struct gn_source_state {
    double number, mass;  /* number of particles that entered; their mass, kg */
    double momentum[3];   /* N s */
    double energy;        /* J */
    double sizes, places; /* count of random numbers drawn for radii, and for places */
    double radius;        /* m, of the next particle, which waits for room; 0: not drawn yet */
    double full;          /* number of checks at which there was no room for a particle */
} gn_source_state;
typedef struct gn_sink_state {
    double number, mass;       /* number of particles that left; their mass, kg */
    double momentum[3];        /* N s */
    double energy;             /* J, kinetic */
    double row_mass, row_time; /* values at the last row of the history; not part of the state */
} gn_sink_state;

/* A particle that left the domain. */
typedef struct gn_lost {
    double id, time, place[3], velocity[3]; /* s; m, in the user's coordinates; m/s */
} gn_lost;

typedef struct gn_flow {
    gn_source_state *sources; /* [scene.source_count] */
    gn_sink_state *sinks;     /* [scene.sink_count] */
    gn_domain **region;       /* [sources + sinks] regions, relative to the origin; NULL: a plane */
    size_t regions;
    double *unit; /* m [sources]: unit of the drawn sizes */
    gn_lost *lost;
    size_t lost_count, lost_room;
    double largest; /* m: largest radius when the lists were made; with sinks */
} gn_flow;

/* A particle that enters. */
typedef struct gn_arrival {
    double sphere[4], velocity[3]; /* m, m/s */
    size_t source;
} gn_arrival;

/* Creates the regions from the scene, also for a resumed world. */
gneiss_status gn_flow_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Sets all counts to zero. */
gneiss_status gn_flow_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_flow_free(gn_flow *flow);

/* Return the smallest (largest) radius that a source may create, m; INFINITY (0) without sources.
 */
double gn_flow_least_radius(const gn_step_context *ctx, const gn_dem *dem);
double gn_flow_largest_radius(const gn_step_context *ctx, const gn_dem *dem);
/* Returns the largest radius of present particles and of those that a source may create, m. */
double gn_flow_widest_radius(const gn_step_context *ctx, const gn_dem *dem);
/* gn_flow_listed stores the largest radius for sinks when lists have been made; gn_flow_mean_radius
 * returns the mean radius over sources; gn_flow_bounds returns the box around all sources, which is
 * empty if there are none. */
void gn_flow_listed(const gn_step_context *ctx, gn_dem *dem);
double gn_flow_mean_radius(const gn_step_context *ctx);
void gn_flow_bounds(const gn_step_context *ctx, const gn_dem *dem, double lower[3],
                    double upper[3]);

/* Tells whether a particle is inside the region of a sink. */
bool gn_sink_has(const gn_step_context *ctx, const gn_dem *dem, size_t sink, const double x[4]);
/* Counts the particles that have crossed sinks since the lists were made, for sinks that do not
 * remove particles. */
void gn_flow_count(const gn_step_context *ctx, gn_dem *dem);
gneiss_status gn_flow_note_lost(const gn_step_context *ctx, gn_dem *dem, size_t particle,
                                gneiss_error *error);
/* To be called when a row of the history was written. */
void gn_flow_row(const gn_step_context *ctx, gn_dem *dem);
/* Returns the number of particles in the model. */
size_t gn_dem_present_count(const gn_dem *dem);

uint64_t gn_flow_hash(const gn_step_context *ctx, const gn_dem *dem, uint64_t h);

#endif
