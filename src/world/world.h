/* The world owns everything of a running model. Flow: gn_world_create (scene -> particles, bonds,
 * lists, step), gn_world_step (one step), gn_world_free. Readers are in src/run. */
#ifndef GN_WORLD_WORLD_H
#define GN_WORLD_WORLD_H

#include "boundary/boundary.h"
#include "drive/box.h"
#include "drive/control.h"
#include "frame/ledger.h"
#include "frame/step_context.h"
#include "laboratory/strain_gauge.h"
#include "particles/dem.h"
#include "solids/elements.h"
#include "world/features.h"
#include "zones/zone_state.h"

/* X(name, text): what the seconds of a run are booked under. */
#define GN_PHASES(X)                                                                               \
    X(bonds, "bond kernels")                                                                       \
    X(pairs, "unbonded contact kernels")                                                           \
    X(walls, "wall contacts and wall motion")                                                      \
    X(motion, "gather, damping, integration")                                                      \
    X(waiting, "waiting for the other threads")                                                    \
    X(elements, "finite elements: forces, motion, readings")                                       \
    X(exchange, "zones of particles and elements")                                                 \
    X(lists, "neighbour search and lists")                                                         \
    X(step_limit, "stability limit")                                                               \
    X(conversion, "elements that turn into particles")                                             \
    X(measure, "readings and history")                                                             \
    X(output, "snapshots, checkpoints, results")                                                   \
    X(setup, "specimen, bonds, first lists and limit")

typedef enum gn_phase {
#define X(name, text) GN_PHASE_##name,
    GN_PHASES(X)
#undef X
        GN_PHASE_COUNT
} gn_phase;

const char *gn_phase_name(gn_phase phase);
const char *gn_phase_text(gn_phase phase);

/* How a stage of the scene went; doubles, as checkpoints have it. */
typedef struct gn_stage_state {
    double time, step; /* s, steps: when it began */
    double row;        /* rows of the history before it */
    double ended;      /* gn_stage_cause; 0: not yet */
    double strain;     /* of the test in its first row */
    double peak;       /* Pa, largest stress of the test in it */
} gn_stage_state;

/* The stage of the scene that runs, and how each went. */
struct gn_stages {
    size_t now;            /* base 0 */
    gn_stage_state *state; /* [given.stage_count] */
};

/* The scene, the clock and the ledger, and the parts, which own their state and show the same face:
 * create, refresh, forces, move, book, measure, limit, check, hash, bytes, save, load, free, as far
 * as they apply (docs/design.md). The world calls them in turn. */
struct gn_world {
    gn_step_context ctx;
    gn_dem dem;           /* particles and their contacts */
    gn_boundary boundary; /* walls, bodies and facets that they touch */
    gn_solids solids;     /* bodies of finite elements */
    gn_zones zones;       /* particles and elements as one body; conversions */
    gn_features features; /* what only some scenes use */

    gn_periodic_box box;        /* motion of the sides of a periodic box */
    gn_gauge gauge;             /* average strain */
    gn_approach approach;       /* of the ends of the test to the specimen */
    gn_bar_section section;     /* of the specimen of the test */
    gn_most_loaded most_loaded; /* element nearest to a limit of couple.convert since the run began
                                   or was resumed */
    gn_stages stages;
    gn_ledger ledger;
    gn_ending outcome;
    double seconds[GN_PHASE_COUNT];
};

/* A point of the world as the user sees it. */
void gn_world_point_out(const gn_step_context *ctx, const double point[3], double out[3]);

/* Builds the world; takes over the contents of `scene` (also on failure, when they are freed). On
 * failure nothing is held. */
gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error);
void gn_world_free(gn_world *world);

/* Effects, threads and kernels from world->scene; gn_world_create and resume call it. */
gneiss_status gn_world_prepare(gn_step_context *ctx, gn_dem *dem, gn_periodic_box *box,
                               gneiss_error *error);

/* Goes over to a stage of the scene, between two steps; the step is chosen anew (stages.c). */
gneiss_status gn_world_enter(gn_world *world, size_t stage, gneiss_error *error);
/* Chooses the step as at the start. */
gneiss_status gn_world_choose_step(gn_world *world, gneiss_error *error);

/* Another number of threads from now on; results stay the same. */
gneiss_status gn_world_use_threads(gn_step_context *ctx, gn_dem *dem, int threads,
                                   gneiss_error *error);

/* Advances by one step. Forces, wall forces, reactions and, with `measure`, `reading` and
 * `unbalanced` are those of the instant at which the step starts; positions, velocities and time
 * are those at its end. GNEISS_ERROR_UNSTABLE: the state is the last computed one. */
gneiss_status gn_world_step(gn_world *world, bool measure, gneiss_error *error);

/* Makes the lists of all parts anew (refresh.c); at the start, forms bonds as well. */
gneiss_status gn_world_rebuild(gn_world *world, gneiss_error *error);

/* After the records of a checkpoint were read: null particles, padding, partial and block sums. */
gneiss_status gn_world_restore(gn_world *world, gneiss_error *error);

/* Rebuilds if the displacement bound says so. */
gneiss_status gn_world_refresh_lists(gn_world *world, gneiss_error *error);
/* The same whether it is due or not. */
gneiss_status gn_world_renew_lists(gn_world *world, gneiss_error *error);

/* Refuses a run that no machine would bring to its end: more than 1e15 steps. */
gneiss_status gn_world_check_duration(const gn_step_context *ctx, gneiss_error *error);

/* s: the limits of the particles and all bodies of elements, each by itself: the least, undamped.
 */
double gn_world_sharp_limit(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_zones *zones);
double gn_world_bound(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                      const gn_zones *zones);

/* Checks the stability limit and lowers an automatic step (step_limit.c). `full`: Lanczos even if
 * the rigorous bound is above the step. */
gneiss_status gn_world_check_step(gn_world *world, bool full, gneiss_error *error);

/* Finds the limit of loose grains as they lie at the end of a run, long after the last look maybe:
 * for what is written, when the state has been saved. The step stays. */
gneiss_status gn_world_last_look(gn_world *world, gneiss_error *error);

/* What gn_world_check_step does after a step in which bonds broke, for a specimen that may have
 * come apart by it. */
gneiss_status gn_world_check_apart(gn_world *world, int64_t broken_before, gneiss_error *error);

/* The same after a step that was measured because of debris: what of it makes energy counts. */
gneiss_status gn_world_check_debris(gn_world *world, gneiss_error *error);

/* The same for what the lists, just made, let happen before they are made again. */
gneiss_status gn_world_check_lists(gn_world *world, gneiss_error *error);
/* Lowers an automatic step as bodies ask for that move far in it (body_paths.h). */
void gn_world_follow_bodies(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary);

/* What is to be said of a given step: that it does not resolve collisions, or that contacts which
 * may form need a smaller one. "" : nothing. */
const char *gn_world_step_warning(const gn_step_context *ctx, const gn_dem *dem, char *text,
                                  size_t size);

/* Which free body is so light, or stiff, that its contacts ask for steps a thousand times shorter
 * than those of all else. "": none. */
const char *gn_world_light_body(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, char *text, size_t size);

/* Steps that a collision must last. */
double gn_world_contact_steps(const gn_step_context *ctx);

/* The largest share of the missing force that a servo wall takes up in a step and is stable. */
double gn_world_servo_relaxation(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, size_t wall);

/* Who the shortest collision is between. */
const char *gn_resolution_text(const gn_step_context *ctx, const gn_dem *dem, char *text,
                               size_t size);

/* What non-viscous damping leaves of the limit, 1 without it. */
double gn_world_nonviscous_share(const gn_step_context *ctx);
/* Of a scene that calls for these effects. */
double gn_scene_nonviscous_share(const gn_scene *scene, gn_effects effects);

/* The lists with the forces of the present positions in their rows (velocities and tangential
 * forces of the last step): for output. The world is not changed; the copies are the caller's. */
typedef struct gn_observed {
    gn_contacts bonds, pairs;
} gn_observed;
gneiss_status gn_world_observe(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_periodic_box *box, gn_observed *observed,
                               gneiss_error *error);
void gn_observed_free(gn_observed *observed);

/* What acts on every particle at the present positions, N and N m, [particles][6] each, in their
 * order: all of it but what zones of elements do and what prescribes a motion supplies, background
 * damping included; background damping. Of walls and surfaces as the last step found it. */
gneiss_status gn_world_loads(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_periodic_box *box, double *total,
                             double *damping, gneiss_error *error);

/* The view that measures and the time step estimate work on. */
gn_assembly gn_world_assembly(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_boundary *boundary);

/* Tells whether no shape measures world->volume: it is the length of the test times its area, or
 * that of the convex hull of the particles. */
bool gn_world_volume_is_of_test(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids);
bool gn_world_volume_is_of_hull(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids);
/* What world->volume is the volume of: "the shape", "the convex hull of the particles", ... */
const char *gn_world_volume_source(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids);

/* Of particles and elements, kg, without what was added for a longer step. */
double gn_world_mass(const gn_dem *dem, const gn_solids *solids);
/* m; of all rows of particles. */
double gn_world_mean_radius(const gn_dem *dem);
/* m: extent at the start of what is tested: of the particles, radii included, and of the elements
 * that are one body with them (`couple`), which may be packed in a part of it alone. */
void gn_world_body(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                   double upper[3]);
double gn_world_side(const gn_step_context *ctx, const gn_solids *solids, int axis);

/* 1 - volume of the particles (overlaps counted twice) over that of the specimen. */
double gn_world_porosity(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_solids *solids);

/* Hash of the state: particles, contacts, walls, time. */
uint64_t gn_world_hash(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_periodic_box *box);

/* Bytes held by particles, contacts and lists. */
size_t gn_world_bytes(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      const gn_solids *solids);

/* specimen.c: whether the radii of a packing came out narrower than they were asked for; `text`
 * then says so. Without sources and sinks, so that it is said of the specimen. */
bool gn_specimen_is_narrow(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
