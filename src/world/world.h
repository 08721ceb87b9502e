/* The world owns everything of a running model. Flow: gn_world_create (scene -> particles, bonds,
 * lists, step), gn_world_step (one step), gn_world_free. Readers are in src/run. */
#ifndef GN_WORLD_WORLD_H
#define GN_WORLD_WORLD_H

#include "base/error.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "conversion/records.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "frame/phases.h"
#include "laboratory/cutting.h"
#include "laboratory/ends.h"
#include "laboratory/laboratory.h"
#include "laboratory/strain_gauge.h"
#include "membrane/membrane.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "solids/solids.h"
#include "world/features.h"
#include "zones/zone_state.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State of a stage of the scene. */
typedef struct gn_stage_state {
    double time;   /* s: time at which it began */
    double strain; /* strain of the test in its first row */
    double peak;   /* Pa, largest stress of the test during the stage */
    int64_t step;  /* step at which it began */
    int64_t row;   /* rows of the history before it */
    int64_t ended; /* gn_stage_cause; 0: not yet */
} gn_stage_state;

/* The present stage of the scene, and the states of all stages. */
struct gn_stages {
    size_t now;            /* base 0 */
    gn_stage_state *state; /* [given.stage_count] */
};

/* The scene, the clock and the ledger, and the parts, which own their state and have the same
 * functions: create, refresh, forces, move, book, measure, limit, check, hash, bytes, save, load,
 * free, as far as they apply (docs/design.md). The world calls them in turn. */
struct gn_world {
    gn_step_context ctx;
    gn_dem dem;               /* particles and their contacts */
    gn_boundary boundary;     /* walls, bodies and facets that they touch */
    gn_solids solids;         /* bodies of finite elements */
    gn_membrane membrane;     /* around the specimen */
    gn_zones zones;           /* particles and elements that share one body */
    gn_conversions converted; /* sums over conversions */
    gn_features features;     /* parts of the step that only some scenes use */

    gn_periodic_box box;        /* motion of the sides of a periodic box */
    gn_gauge gauge;             /* average strain */
    gn_approach approach;       /* approach of the ends of the test to the specimen */
    gn_cutting cutting;         /* state of the tool of the test */
    gn_bar_section section;     /* section of the specimen of the test */
    gn_most_loaded most_loaded; /* element nearest to a limit of couple.convert since the run began
                                   or was resumed */
    gn_stages stages;
    gn_ledger ledger;
    gn_ending outcome;
};

/* Builds the world; takes over the contents of `scene` (also on failure, when they are freed).
 * After a failure there is nothing to free. */
gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error);

void gn_world_free(gn_world *world);
/* Frees the world that *world points to, and its block (GN_FREED_BY); *world may be NULL. */
void gn_world_delete(gn_world **world);

/* Sets effects, threads and kernels from world->ctx.scene; gn_world_create and resume call it. */
gneiss_status gn_world_prepare(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                               gneiss_error *error);

/* Enters a stage of the scene, between two steps; the step is chosen again (stages.c). */
gneiss_status gn_world_enter(gn_world *world, size_t stage, gneiss_error *error);

/* Chooses the step as at the start. */
gneiss_status gn_world_choose_step(gn_world *world, gneiss_error *error);

/* Advances by one step. Forces, wall forces, reactions and, with `measure`, `reading` and
 * `unbalanced` are those of the instant at which the step starts; positions, velocities and time
 * are those at its end. GNEISS_ERROR_UNSTABLE: the state is the last computed one. */
gneiss_status gn_world_step(gn_world *world, bool measure, gneiss_error *error);

/* Rebuilds the lists of all parts (refresh.c); at the start, forms bonds as well. */
gneiss_status gn_world_rebuild(gn_world *world, gneiss_error *error);

/* Restores null particles, padding, partial and block sums after the records of a checkpoint were
 * read. */
gneiss_status gn_world_restore(gn_world *world, gneiss_error *error);

/* Returns the parts of the world that conversion uses; valid as long as the world. */
gn_convertible gn_world_convertible(gn_world *world);

/* Rebuilds the lists if the displacement bound requires it. */
gneiss_status gn_world_refresh_lists(gn_world *world, gneiss_error *error);

/* Rebuilds the lists in any case. */
gneiss_status gn_world_renew_lists(gn_world *world, gneiss_error *error);

/* Returns the mass of particles and elements, kg, without mass added for a longer step. */
double gn_world_mass(const gn_dem *dem, const gn_solids *solids);

/* Returns the hash of the state: particles, contacts, walls, time. */
uint64_t gn_world_hash(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_periodic_box *box);

/* Returns the number of bytes held by particles, contacts and lists. */
size_t gn_world_bytes(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids);

/* Makes the scene of stage world->stages.now, relative to the origin, from world->ctx.given, and
 * allocates the states of stages (stages.c). */
gneiss_status gn_stages_scene(gn_world *world, gn_scene *scene, gneiss_error *error);

/* Returns GNEISS_ERROR_INPUT if the first stage waits for a state that no loaded contact can
 * produce. */
gneiss_status gn_stages_check_first(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_stages *stages,
                                    gneiss_error *error);

/* Starts the wave with which the scene begins; lists must have been made (pulse.c). */
gneiss_status gn_pulse_start(gn_world *world, gneiss_error *error);

/* Only one step of GN_BOOKED is timed, and its times are multiplied by GN_BOOKED, because reading
 * the clock after every block costs a percent of a step. The number is prime, so that timed steps
 * do not coincide with regular readings. */
enum { GN_BOOKED = 7 };

#endif
