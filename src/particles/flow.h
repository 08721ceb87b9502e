/* Particles that come and go: sources, sinks, and those that left the domain. The part of particles
 * (dem.h) owns all of it. Both act when lists are made, so that nothing else has to know: what is
 * near, what touches and what the step must hold follow as for particles that were there before. */
#ifndef GN_PARTICLES_FLOW_H
#define GN_PARTICLES_FLOW_H

#include "frame/parts.h"

#include "base/error.h"
#include "pack/domain.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Doubles only: checkpoints store them as they are. */
typedef struct gn_source_state {
    double number, mass;  /* that came in; kg */
    double momentum[3];   /* N s */
    double energy;        /* J */
    double sizes, places; /* random numbers used for radii, and for places */
    double radius;        /* m, of the next one, which waits for room; 0: not drawn yet */
    double full;          /* looks at which there was no room for it */
} gn_source_state;
typedef struct gn_sink_state {
    double number, mass;       /* that went out; kg */
    double momentum[3];        /* N s */
    double energy;             /* J, kinetic */
    double row_mass, row_time; /* at the last row of the history: no state */
} gn_sink_state;

/* A particle that left the domain. */
typedef struct gn_lost {
    double id, time, place[3], velocity[3]; /* s; m, as the user sees it; m/s */
} gn_lost;

typedef struct gn_flow {
    gn_source_state *sources; /* [scene.source_count] */
    gn_sink_state *sinks;     /* [scene.sink_count] */
    gn_domain **region;       /* [sources + sinks] relative to the origin; NULL: a plane */
    size_t regions;
    double *unit; /* m [sources]: of the sizes that are drawn */
    gn_lost *lost;
    size_t lost_count, lost_room;
    double largest; /* m: radius, when the lists were made; with sinks */
    bool forced;    /* the lists are made for a source or a thin sink alone */
} gn_flow;

/* A particle that comes in. */
typedef struct gn_arrival {
    double sphere[4], velocity[3]; /* m, m/s */
    size_t source;
} gn_arrival;

/* Regions, from the scene: also of a world that is resumed. */
gneiss_status gn_flow_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Nothing has come nor gone. */
gneiss_status gn_flow_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_flow_free(gn_flow *flow);

/* m: the smallest (largest) radius that a source may bring; INFINITY (0) without sources. The mean
 * over sources; the box about all of them, which is empty without. */
double gn_flow_least_radius(const gn_step_context *ctx, const gn_dem *dem);
double gn_flow_largest_radius(const gn_step_context *ctx, const gn_dem *dem);
double gn_flow_mean_radius(const gn_step_context *ctx);
void gn_flow_bounds(const gn_step_context *ctx, const gn_dem *dem, double lower[3],
                    double upper[3]);

/* Tells whether a source has a particle that is due and the lists are old enough to be rebuilt for
 * it. */
bool gn_flow_due(const gn_step_context *ctx, const gn_dem *dem);
/* Lets in what is due and finds room. At the start (`first`) there must be particles then. */
gneiss_status gn_flow_arrive(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gn_ledger *ledger, bool first, gneiss_error *error);
/* s by which what came in is behind what should have; whether that is more than a hundredth of the
 * time and more than one particle. */
double gn_flow_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);
bool gn_flow_is_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);
/* Particles that source k brings between two looks, which lack at the end of a run in which it
 * still feeds; 0: at most one, or a hundredth of what it brings. */
double gn_flow_late(const gn_step_context *ctx, const gn_dem *dem, size_t k);
/* Particles that source k brings until time.end by its rate, at most its total. */
double gn_flow_expected(const gn_step_context *ctx, const gn_dem *dem, size_t k);
/* Tells whether a source will bring more particles until time.end, and has not waited for room
 * since it last looked. */
bool gn_flow_brings(const gn_step_context *ctx, const gn_dem *dem);
/* The wall that has all of the region of source k behind it; NULL: none has. */
const char *gn_flow_wall_before(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k);

/* Tells whether a particle is inside the region of a sink. */
bool gn_sink_has(const gn_step_context *ctx, const gn_dem *dem, size_t sink, const double x[4]);
/* m: the least extent of its region, of a polygon at most that; INFINITY: a plane. */
double gn_sink_width(const gn_step_context *ctx, const gn_dem *dem, size_t sink);
/* Tells whether a particle is where a sink has it, or was there at any time of the last step if the
 * sink is thin. */
bool gn_sink_takes(const gn_step_context *ctx, const gn_dem *dem, size_t sink, size_t particle);
/* Tells whether a sink that is thin beside the ways on which lists stand has a particle to remove;
 * such sinks are looked at in every step. */
bool gn_sinks_are_due(const gn_step_context *ctx, const gn_dem *dem);
/* The lists are made. */
void gn_sinks_listed(const gn_step_context *ctx, gn_dem *dem);
/* Tells whether there are particles that never are wholly inside of a sink; then the text says so.
 */
bool gn_sink_is_too_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink, char *text,
                         size_t size);
/* Counts particles that cross planes which do not remove: since the lists were made. */
void gn_flow_count(const gn_step_context *ctx, gn_dem *dem);
gneiss_status gn_flow_note_lost(const gn_step_context *ctx, gn_dem *dem, size_t particle,
                                gneiss_error *error);
/* A row of the history has been written. */
void gn_flow_row(const gn_step_context *ctx, gn_dem *dem);
/* Particles that are there. */
size_t gn_world_present(const gn_dem *dem);

/* removal.c: room for those that come in, behind the others; the lists have to be made anew. */
gneiss_status gn_dem_grow(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          const gn_arrival *arrivals, size_t count, gneiss_error *error);
/* Leaves out the rows of particles that are gone, once they are many, but for those that have
 * bonds. Before anything is removed that the lists still hold. */
gneiss_status gn_dem_drop(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          gneiss_error *error);

uint64_t gn_flow_hash(const gn_step_context *ctx, const gn_dem *dem, uint64_t h);

#endif
