/* The world owns everything of a running model. Flow: gn_world_create (scene -> particles, bonds,
 * lists, step), gn_world_step (one step), readers (record.h, output.h), gn_world_free. */
#ifndef GN_SIM_WORLD_H
#define GN_SIM_WORLD_H

#include "kernels/dispatch.h"
#include "limit/timestep.h"
#include "measure/energy.h"
#include "measure/measure.h"
#include "neigh/pairs.h"
#include "scene/scene.h"
#include "sched/deal.h"
#include "sched/hold.h"
#include "sim/elements.h"
#include "sim/surface.h"

/* X(name, text): what the seconds of a run are booked under. */
#define GN_PHASES(X)                                                                               \
    X(bonds, "bond kernels")                                                                       \
    X(pairs, "unbonded contact kernels")                                                           \
    X(walls, "wall contacts and wall motion")                                                      \
    X(motion, "gather, damping, integration")                                                      \
    X(elements, "finite elements: forces, motion, readings")                                       \
    X(lists, "neighbour search and lists")                                                         \
    X(step_limit, "stability limit")                                                               \
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

typedef struct gn_wall {
    double point[3], start[3]; /* m; a point of the plane, and where it began */
    double normal[3];          /* unit, to the particles */
    double velocity[3];        /* m/s, over the interval that led here */
    double force[3];           /* N, of the particles on the wall at the last evaluation */
    double stiffness;          /* N/m, sum of the touching contacts; only with a servo */
    double travel;             /* m, path since the lists were made */
} gn_wall;

/* State of the Verlet lists. */
typedef struct gn_verlet {
    double skin;       /* m, as it is now */
    double skin_start; /* m, as it was at the start */
    double drift;      /* m, bound on any particle's path since `ref` was set */
    int64_t rebuilds;
    int64_t last_step; /* step of the last rebuild */
} gn_verlet;

/* Uniform contact parameters derived from the packing (models 3a, 3b, 3c); 0 when not used. */
typedef struct gn_derived {
    double radius;  /* m: stiffness is 2 E_c radius */
    double radius2; /* m2: strengths are 4 sigma_c radius2, 4 tau_c radius2 */
} gn_derived;

/* The shortest collision that a step has to resolve, by ids of particles; `second` < 0: wall -1 -
 * second, behind the walls surfaces. */
typedef struct gn_resolution {
    double step;    /* s: what it allows; INFINITY: nothing can collide */
    double contact; /* s: how long it lasts */
    int64_t first, second;
} gn_resolution;

/* X(name, text): numbers of the last measured step that no sum over the state gives afterwards;
 * checkpoints have them. */
#define GN_MEASURED(X) X(unbalanced, "mean resultant over mean contact force")

struct gn_world {
    gn_scene scene; /* its points relative to scene.origin, as all points of the world */
    gn_scene given; /* the same as the user sees it, for files */
    gn_effects effects;
    const gn_kernel_set *kernels;
    gn_contact_kernel *bond_kernel, *pair_kernel;
    gn_motion_kernel *motion_kernel;
    int threads;
    gn_deal deal;                 /* of steps among the threads */
    gn_hold hold;                 /* particles that wait for an exchange */
    struct gn_exchange *exchange; /* [exchange_count] sim/exchange.h */
    size_t exchange_count;

    gn_particles particles;
    gn_contacts bonds, pairs;
    gn_wall_contacts wall_contacts;
    gn_partials bond_partials, pair_partials;
    gn_uniform bond_uniform, pair_uniform;
    int32_t *wall_first;  /* [particles + 1] */
    int32_t *index_of_id; /* [particles] */
    gn_derived derived;
    gn_element_model *elements; /* NULL: none */

    gn_wall *walls;       /* [scene.wall_count] */
    double *wall_normals; /* [walls][4], for measures */
    gn_rigid *bodies;     /* [scene.body_count] */
    size_t surface_count;
    gn_surface *surfaces;     /* first those of bodies, in their order */
    size_t body_vertex_count; /* of all bodies */
    size_t body_corner_count; /* of facets of all bodies */
    int64_t (*body_shape)[3]; /* [bodies]: vertices, facets, facets dropped */
    double *body_vertex;      /* [body_vertex_count][4], m, in the frames */
    int32_t *body_corner;     /* [body_corner_count], within a body */
    gn_prescription prescribed;
    int32_t *channel_set; /* [prescribed.count][6] set that drives a channel, -1: free */
    double *set_reaction; /* [scene.set_count][6] N, N m: what the prescription supplied */

    gn_contact_sums *bond_sums, *pair_sums; /* per block of contacts */
    gn_contact_sums *wall_sums;             /* per block of particles */
    gn_motion_sums *motion_sums;
    size_t motion_blocks;

    gn_verlet verlet;
    gn_strain_gauge gauge;
    double period[3];
    double damping_fraction;   /* of critical, of contacts that are pressed */
    double volume;             /* m3 (2D: m2 x 1 m): of the specimen at the start */
    double lower[3], upper[3]; /* m: extent of the specimen at the start, radii included */
    double test_length, test_area;
    double radius_min;    /* m */
    double particle_mass; /* kg, of those that were there when the lists were made */

    int64_t step;
    double time;        /* s */
    double dt_past, dt; /* s: interval that led here, coming interval */
    double speed_most;  /* m/s, of the fastest particle in the last; 0: not known (start, resume) */
    gn_step_limit limit; /* last full estimate */
    double stable; /* s: what the step is held against: sharp limit or bound, less the share that
                    * non-viscous damping takes */
    double stable_particles; /* s: the same of the particles alone, damping left out */
    double surface_rate;     /* 1/s: 1/dt of free bodies, see gn_surfaces_rate */
    double vertex_rate;      /* 1/s: the same of what contacts do to nodes of finite elements */
    double listed;       /* s: the limit with all listed contacts in touch, where it was found to be
                          * within a hundredth of the step or below it; else INFINITY */
    double listed_holds; /* s: step of the particles alone at which all that is listed holds */
    gn_resolution resolution; /* the shortest so far */
    int64_t dt_lowered;       /* times that the step was lowered while running */
    uint8_t *loose;           /* [particles] by id: not bonded at the start, see resolution.c */

    gn_energy energy;  /* running totals */
    gn_energy reading; /* the ledger at the last measured instant */
    int64_t broken_tension, broken_shear, bonds_at_start;
    double
        stress[9]; /* Pa, average over the specimen at the last measured step, tension positive */
#define X(name, text) double name;
    GN_MEASURED(X)
#undef X
    int64_t lost;          /* removed particles */
    int64_t contact_steps; /* contacts worked on, summed over steps */
    double seconds[GN_PHASE_COUNT];
    bool bad; /* the run failed: its state is written as it is, for looking at */
};

/* A point of the world as the user sees it. */
void gn_world_point_out(const gn_world *world, const double point[3], double out[3]);

/* Builds the world; takes over the contents of `scene` (also on failure, when they are freed). On
 * failure nothing is held. */
gneiss_status gn_world_create(gn_scene *scene, gn_world *world, gneiss_error *error);
void gn_world_free(gn_world *world);

/* Effects, threads and kernels from world->scene; gn_world_create and resume call it. */
gneiss_status gn_world_prepare(gn_world *world, gneiss_error *error);

/* Another number of threads from now on; results stay the same. */
gneiss_status gn_world_use_threads(gn_world *world, int threads, gneiss_error *error);

/* Advances by one step. Forces, wall forces, reactions and, with `measure`, `reading` and
 * `unbalanced` are those of the instant at which the step starts; positions, velocities and time
 * are those at its end. GNEISS_ERROR_UNSTABLE: the state is the last computed one. */
gneiss_status gn_world_step(gn_world *world, bool measure, gneiss_error *error);

/* Makes the lists anew (lists.c). `first`: at the start, when bonds are formed as well. */
gneiss_status gn_world_rebuild(gn_world *world, gneiss_error *error);

/* After the records of a checkpoint were read: null particles, padding, partial and block sums. */
gneiss_status gn_world_restore(gn_world *world, gneiss_error *error);

/* Rebuilds if the displacement bound says so. */
gneiss_status gn_world_refresh_lists(gn_world *world, gneiss_error *error);

/* Refuses a run that no machine would bring to its end: more than 1e15 steps. */
gneiss_status gn_world_check_duration(const gn_world *world, gneiss_error *error);

/* Checks the stability limit and lowers an automatic step (dt.c). `full`: Lanczos even if the
 * rigorous bound is above the step. */
gneiss_status gn_world_check_step(gn_world *world, bool full, gneiss_error *error);

/* The same for what the lists, just made, let happen before they are made again. */
gneiss_status gn_world_check_lists(gn_world *world, gneiss_error *error);

/* What is to be said of a given step: that it does not resolve collisions, or that contacts which
 * may form need a smaller one. "" : nothing. */
const char *gn_world_step_warning(const gn_world *world, char *text, size_t size);

/* Steps that a collision must last. */
double gn_world_contact_steps(const gn_world *world);

/* The largest share of the missing force that a servo wall takes up in a step and is stable. */
double gn_world_servo_relaxation(const gn_world *world, size_t wall);

/* Who the shortest collision is between. */
const char *gn_resolution_text(const gn_world *world, char *text, size_t size);

/* What non-viscous damping leaves of the limit, 1 without it. */
double gn_world_nonviscous_share(const gn_world *world);

/* The lists with the forces of the present positions in their rows (velocities and tangential
 * forces of the last step): for output. The world is not changed; the copies are the caller's. */
typedef struct gn_observed {
    gn_contacts bonds, pairs;
} gn_observed;
gneiss_status gn_world_observe(const gn_world *world, gn_observed *observed, gneiss_error *error);
void gn_observed_free(gn_observed *observed);

/* The view that measures and the time step estimate work on. */
gn_assembly gn_world_assembly(const gn_world *world);

/* What world->volume is the volume of: "the shape", "the convex hull of the particles", ... */
const char *gn_world_volume_source(const gn_world *world);

/* Of particles and elements, kg. */
double gn_world_mass(const gn_world *world);

/* 1 - volume of the particles (overlaps counted twice) over that of the specimen. */
double gn_world_porosity(const gn_world *world);

/* Hash of the state: particles, contacts, walls, time. */
uint64_t gn_world_hash(const gn_world *world);

/* Bytes held by particles, contacts and lists. */
size_t gn_world_bytes(const gn_world *world);

#endif
