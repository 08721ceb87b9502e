/* The world owns everything of a running model. Flow: gn_world_create (scene -> particles, bonds,
 * lists, step), gn_world_step (one step), gn_world_free. Readers are in src/run. */
#ifndef GN_WORLD_WORLD_H
#define GN_WORLD_WORLD_H

#include "boundary/boundary.h"
#include "drive/box.h"
#include "drive/control.h"
#include "measure/energy.h"
#include "measure/measure.h"
#include "particles/dem.h"
#include "scene/scene.h"
#include "solids/elements.h"

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

/* X(name, text): numbers of the last measured step that no sum over the state gives afterwards;
 * checkpoints have them. */
#define GN_MEASURED(X) X(unbalanced, "mean resultant over mean contact force")

/* How a stage of the scene went; doubles, as checkpoints have it. */
typedef struct gn_stage_state {
    double time, step; /* s, steps: when it began */
    double row;        /* rows of the history before it */
    double ended;      /* gn_stage_cause; 0: not yet */
    double strain;     /* of the test in its first row */
    double peak;       /* Pa, largest stress of the test in it */
} gn_stage_state;

/* The scene, the clock and the ledger, and the parts, which own their state and show the same face:
 * create, refresh, forces, move, book, measure, limit, check, hash, bytes, save, load, free, as far
 * as they apply (docs/design.md). The world calls them in turn. */
/* The element that came nearest to a limit of couple.convert: its part of it, when and where at the
 * start, relative to the origin. Nothing moves by it. */
typedef struct gn_most_loaded {
    double share, time, place[3];
    int32_t element;
} gn_most_loaded;

/* Of the first packed material that differs from the elements (gn_zone_differs), at the start: Pa
 * and kg/m3 of its particles and of theirs; 0: none differs. Doubles, as checkpoints have it. */
typedef struct gn_packing_differs {
    double modulus[2], density[2], tension[4]; /* tension: as gn_zone_material has it */
} gn_packing_differs;

/* What relaxations of converted particles came to (conversion_relaxation.c), since the start;
 * doubles, as checkpoints have it. */
typedef struct gn_relaxations {
    double count, iterations;   /* that had something to do; of all of them */
    double missed;              /* did not come to the ratio wanted, */
    double broke, loose, tired; /* of these, as bonds would have broken; as nothing holds who would
                                   go far; as iterations were used up: the first of these */
    double kept;                /* of particles that did not go on, for one of the first two */
    double worst, time;         /* the largest ratio that was left, and s, when */
} gn_relaxations;

/* What conversions did to velocities (conversion_momentum.c), since the start; doubles, as
 * checkpoints have it. */
typedef struct gn_corrections {
    double count, wider;  /* conversions; of these, where others than who weighs something else made
                             up for momentum */
    double missed, least; /* where angular momentum was not all made up for; the least part that was
                             in these */
    double energy;        /* J: kinetic, that all of this took, masses included */
    double turned[3];     /* kg m2/s: what came of it to the angular momentum about the centre of
                             mass, a vector sum; */
    double most;          /* the largest that this was; */
    double scale;         /* the largest that the body had, or m v r of it (gn_tally_turns) */
    double centre[3];     /* m: by what the centre of mass moved, a vector sum */
    double inertia;       /* sum of changes of the polar moment about it, each of what it was */
} gn_corrections;

/* J: what conversions booked, by what made it (conversion_energy_parts.c), since the start, with
 * the sign of gn_energy.conversion, which their sum is; doubles, as checkpoints have it. */
typedef struct gn_conversion_parts {
    double sampled;   /* particles stand for another volume than elements lose */
    double stiffness; /* their springs hold another energy in the same strain */
    double uneven;    /* and another where the strain is another at both ends, or they broke or
                         slid before */
    double balance;   /* taken by bringing them into balance */
    double motion;    /* kinetic */
    double step;      /* half a step of the powers of springs, walls left out */
    double alike[2];  /* what elements and springs would hold of the part that changed hands in the
                         same strain: their difference is `stiffness` */
} gn_conversion_parts;

struct gn_world {
    gn_scene scene; /* that of the stage; its points relative to scene.origin, as all points of the
                       world */
    gn_scene given; /* the same as the user sees it, for files */
    gn_effects effects;
    const gn_kernel_set *kernels;
    int threads;

    gn_dem dem;                  /* particles and their contacts */
    gn_boundary boundary;        /* walls, bodies and facets that they touch */
    gn_element_model **elements; /* [element_count] bodies of finite elements */
    size_t element_count;
    struct gn_exchange *exchange; /* [exchange_count] world/exchange.h */
    size_t exchange_count;

    struct gn_coupled *coupled; /* ties and masses of zones (zones/zones.h); NULL: none */
    struct {
        double frequency; /* rad/s, of the particles, by which springs of zones are chosen */
        double rate[2];   /* 1/s: what these take of the steps of particles and elements */
        double turned;    /* what slaved spins add, of the square of the particles' frequency */
        double whole;     /* s: sharp limit of particles and elements as one; 0: not looked for */
        double stress[9]; /* Pa: what elements have of the mean stress of the particles' volume, at
                           * the last measured instant */
        gn_relaxations relaxed;
        gn_corrections corrected;
        gn_conversion_parts parts;
        gn_packing_differs differs;
    } couple;

    gn_most_loaded most_loaded; /* of what looks found since the run began or was resumed */

    gn_strain_gauge gauge;
    int32_t *belongs;     /* [gauged] by id: whether a particle counts in it, see strain_gauge.c */
    size_t gauged;        /* 0: without bonds */
    double period[3];     /* m: of a periodic box, as it is now */
    gn_box box;           /* how its sides moved (box.h) */
    gn_approach approach; /* of the ends of the test to the specimen */
    gn_bar_section section;    /* of the specimen of the test */
    gn_machine machine;        /* what controls the ends of the test (control.h) */
    double volume;             /* m3 (2D: m2 x 1 m): of the specimen at the start; of a periodic box
                                  now */
    double lower[3], upper[3]; /* m: extent of the specimen at the start, radii included */
    double test_length, test_area;

    size_t stage;           /* of the scene, base 0 */
    gn_stage_state *stages; /* [given.stage_count] */

    int64_t step;
    int64_t first_step; /* 0, or the step that it began with in an equilibrium (src/static) */
    double time;        /* s */
    double dt_past, dt; /* s: interval that led here, coming interval */
    double stable; /* s: what the step is held against: sharp limit or bound, less the share that
                    * non-viscous damping takes */
    int64_t dt_lowered; /* times that the step was lowered while running */

    gn_energy energy;  /* running totals */
    gn_energy reading; /* the ledger at the last measured instant */
    /* Pa, average over the specimen at the last measured step, tension positive */
    double stress[9];
#define X(name, text) double name;
    GN_MEASURED(X)
#undef X
    gn_balance balance; /* at the last measured step; no state */
    double seconds[GN_PHASE_COUNT];
    bool bad; /* the run failed: its state is written as it is, for looking at */
    char
        halt[256]; /* why the run is to end here, with the model as good as it was; "": it is not */
};

/* A point of the world as the user sees it. */
void gn_world_point_out(const gn_world *world, const double point[3], double out[3]);

/* Builds the world; takes over the contents of `scene` (also on failure, when they are freed). On
 * failure nothing is held. */
gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error);
void gn_world_free(gn_world *world);

/* Effects, threads and kernels from world->scene; gn_world_create and resume call it. */
gneiss_status gn_world_prepare(gn_world *world, gneiss_error *error);

/* Goes over to a stage of the scene, between two steps; the step is chosen anew (stages.c). */
gneiss_status gn_world_enter(gn_world *world, size_t stage, gneiss_error *error);
/* Chooses the step as at the start. */
gneiss_status gn_world_choose_step(gn_world *world, gneiss_error *error);

/* Another number of threads from now on; results stay the same. */
gneiss_status gn_world_use_threads(gn_world *world, int threads, gneiss_error *error);

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
gneiss_status gn_world_check_duration(const gn_world *world, gneiss_error *error);

/* s: the limits of the particles and all bodies of elements, each by itself: the least, undamped.
 */
double gn_world_sharp_limit(const gn_world *world);
double gn_world_bound(const gn_world *world);

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
void gn_world_follow_bodies(gn_world *world);

/* What is to be said of a given step: that it does not resolve collisions, or that contacts which
 * may form need a smaller one. "" : nothing. */
const char *gn_world_step_warning(const gn_world *world, char *text, size_t size);

/* Which free body is so light, or stiff, that its contacts ask for steps a thousand times shorter
 * than those of all else. "": none. */
const char *gn_world_light_body(const gn_world *world, char *text, size_t size);

/* Steps that a collision must last. */
double gn_world_contact_steps(const gn_world *world);

/* The largest share of the missing force that a servo wall takes up in a step and is stable. */
double gn_world_servo_relaxation(const gn_world *world, size_t wall);

/* Who the shortest collision is between. */
const char *gn_resolution_text(const gn_world *world, char *text, size_t size);

/* What non-viscous damping leaves of the limit, 1 without it. */
double gn_world_nonviscous_share(const gn_world *world);
/* Of a scene that calls for these effects. */
double gn_scene_nonviscous_share(const gn_scene *scene, gn_effects effects);

/* The lists with the forces of the present positions in their rows (velocities and tangential
 * forces of the last step): for output. The world is not changed; the copies are the caller's. */
typedef struct gn_observed {
    gn_contacts bonds, pairs;
} gn_observed;
gneiss_status gn_world_observe(const gn_world *world, gn_observed *observed, gneiss_error *error);
void gn_observed_free(gn_observed *observed);

/* What acts on every particle at the present positions, N and N m, [particles][6] each, in their
 * order: all of it but what zones of elements do and what prescribes a motion supplies, background
 * damping included; background damping. Of walls and surfaces as the last step found it. */
gneiss_status gn_world_loads(const gn_world *world, double *total, double *damping,
                             gneiss_error *error);

/* The view that measures and the time step estimate work on. */
gn_assembly gn_world_assembly(const gn_world *world);

/* Tells whether no shape measures world->volume: it is the length of the test times its area, or
 * that of the convex hull of the particles. */
bool gn_world_volume_is_of_test(const gn_world *world);
bool gn_world_volume_is_of_hull(const gn_world *world);
/* What world->volume is the volume of: "the shape", "the convex hull of the particles", ... */
const char *gn_world_volume_source(const gn_world *world);

/* Of particles and elements, kg, without what was added for a longer step. */
double gn_world_mass(const gn_world *world);
/* m; of all rows of particles. */
double gn_world_mean_radius(const gn_world *world);
/* m: extent at the start of what is tested: of the particles, radii included, and of the elements
 * that are one body with them (`couple`), which may be packed in a part of it alone. */
void gn_world_body(const gn_world *world, double lower[3], double upper[3]);
double gn_world_side(const gn_world *world, int axis);

/* 1 - volume of the particles (overlaps counted twice) over that of the specimen. */
double gn_world_porosity(const gn_world *world);

/* Hash of the state: particles, contacts, walls, time. */
uint64_t gn_world_hash(const gn_world *world);

/* Bytes held by particles, contacts and lists. */
size_t gn_world_bytes(const gn_world *world);

/* specimen.c: whether the radii of a packing came out narrower than they were asked for; `text`
 * then says so. Without sources and sinks, so that it is said of the specimen. */
bool gn_specimen_is_narrow(const gn_world *world, char *text, size_t size);

#endif
