/* The part of a world that consists of particles: their records, contacts and lists, prescribed
 * motions, and the step that they allow. */
#ifndef GN_PARTICLES_PARTICLES_H
#define GN_PARTICLES_PARTICLES_H

#include "frame/parts.h"

#include "base/error.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "io/packing.h"
#include "kernels/dispatch.h"
#include "kernels/motion.h"
#include "limit/step_limits.h"
#include "neigh/neigh.h"
#include "particles/active_pairs.h"
#include "particles/clumps.h"
#include "particles/contact_lists.h"
#include "particles/events.h"
#include "particles/flow.h"
#include "sched/deal.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* State of the Verlet lists. */
typedef struct gn_verlet {
    double skin;       /* m, present value */
    double skin_start; /* m, value at the start */
    double widened;    /* m, the largest value that was needed beyond the scene's; 0: never */
    double drift;      /* m, bound on any particle's path since `ref` was set */
    double reach; /* gap up to which listed pairs attract each other, over the sum of their radii */
    double closed; /* m, bound on how much two unlisted particles have approached each other since
                      then */
    int64_t rebuilds;
    int64_t last_step; /* step of the last rebuild */
    bool forced;       /* the lists are made for a source or a thin sink alone */
} gn_verlet;

/* Sums of a step over all blocks. */
typedef struct gn_dem_sums {
    gn_contact_sums list[GN_LIST_COUNT]; /* sums of each contact list */
    gn_contact_sums contacts;            /* sums of all lists */
    gn_contact_sums walls;               /* sums of contacts with walls and facets */
    gn_motion_sums motion;
    double step_change[2]; /* J, energy added by the change of the step, by half */
} gn_dem_sums;

/* Masses raised for a longer step, as of the last construction of the lists. */
typedef struct gn_raised_masses {
    double added;   /* kg */
    double largest; /* the largest ratio of a raised mass to the particle's own */
    int64_t count;  /* number of particles with raised masses */
} gn_raised_masses;

/* A particle of a body that converts (conversion.h). */
typedef struct gn_dormant_particle {
    /* 1/kg, 1/(kg m2): values when it is released; 0: it is active */
    double inverse_mass, inverse_inertia;
    int32_t element; /* element that contains the particle at the start, by its index in the mesh */
} gn_dormant_particle;

/* Scratch for counting fragments (fragments.c), with bonds. */
typedef struct gn_pieces {
    int32_t *parent, *members; /* [particles] */
    double *volume;            /* [particles] m3, in 2D m2 */
} gn_pieces;

/* The contact of a particle with the largest relative overlap so far, in doubles, as checkpoints
 * store it. */
typedef struct gn_depth {
    double excess;  /* overlap over the smaller radius, divided by the ratio from which it is too
                       large */
    double share;   /* overlap over the smaller radius; 0: none */
    double overlap; /* m */
    double time;    /* s, time at which it was found */
    double first, second; /* id of the particle; id of the other one, or -1 - index of a wall;
                             surfaces follow the walls */
    double looked;        /* step of the last check of overlaps */
} gn_depth;

struct gn_dem {
    gn_particles particles;
    union {
        struct { /* the contact lists by name */
#define X(NAME, name) gn_contact_list name;
            GN_CONTACT_LISTS(X)
#undef X
        };
        gn_contact_list list[GN_LIST_COUNT];
    };
    gn_joint_faces *joint_faces; /* faces of the joints; NULL: the scene has none */
    double joint_change;  /* J, energy of joints' contacts that began less that of those that ended
                             when the lists were made; not booked yet */
    gn_contacts prepared; /* bonds of all particles at full weight, with couple.convert */
    gn_dormant_particle *dormant; /* [particles] by id, with couple.convert; else NULL */
    uint8_t *still; /* [motion_blocks] it has no active particle, with couple.convert; else NULL */
    int32_t *index_of_id; /* [ids] row of an id; -1: removed together with its row */
    int64_t ids, made; /* number of ids given so far; number of particles of the specimen, whose ids
                          come first */
    gn_derived derived;
    gn_prescription prescribed;
    int32_t *channel_set; /* [prescribed.count][6] set that drives a channel, -1: free */
    double *set_reaction; /* [scene.set_count][6] N, N m: reactions to the prescribed motion */
    gn_verlet verlet;
    void *ways; /* displacements per cell, scratch of src/particles/travel.c */
    size_t ways_room;
    double radius_min; /* m */
    double mass; /* kg, without added mass, of the particles present when the lists were made */
    gn_raised_masses raised;
    double damping_fraction; /* fraction of critical damping of compressed contacts; with Hertz's
                                law the largest */
    double damping_least;    /* the least damping fraction of any contact */
    /* [materials][gn_scene_sides] pairs of materials with walls, bodies and other sides; NULL
     * without GN_FX_HERTZ */
    gn_hertz_pair *hertz;
    /* [walls, bodies, sets] m/s, the largest speed at which contacts of each were evaluated; NULL
     * without GN_FX_HERTZ */
    double *driven;

    gn_motion_kernel *motion_kernel;
    gn_deal deal;         /* distribution of the work of a step among the threads */
    gn_hold hold;         /* blocks that wait for a feature */
    gn_active_pairs near; /* active pairs */
    gn_motion_sums *motion_sums;
    size_t motion_blocks;
    gn_dem_sums done; /* sums of the last step */
    /* [particles][4] velocities and spins before the step, if its length differs from the last one;
     * else NULL */
    double *vel_past, *spin_past;
    gn_pieces pieces;
    double *around;    /* [particles][2] force N and area m2 summed over the bonds of each particle,
                          with law.confinement: mean; else NULL */
    bool pressed;      /* an overlap exceeded the expected one in the last step */
    double speed_most; /* m/s, largest in the last step; 0: unknown (start, resume) */

    gn_depth depth; /* contact with the largest relative overlap so far */
    uint8_t *loose; /* [ids] 1: not bonded at the start, see collisions.c */

    int64_t broken_tension, broken_shear, bonds_at_start;
    int64_t broken_joints; /* contacts across joints that have broken */
    gn_events events;
    gn_flow flow;
    gn_clumps clumps;
    int64_t lost;          /* particles that left the domain */
    int64_t contact_steps; /* number of contacts processed, summed over steps */
};

/* Returns how many bonds and contacts across joints have broken. */
static inline int64_t gn_dem_breaks(const gn_dem *dem) {
    return dem->broken_tension + dem->broken_shear + dem->broken_joints;
}

/* Sets the kernels and threads that follow from the effects of the world, also of a resumed one. */
gneiss_status gn_dem_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gneiss_status gn_dem_use_threads(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Creates the particles of a packing, in its order, without mass. */
gneiss_status gn_dem_create(const gn_step_context *ctx, gn_dem *dem, const gn_packing *packing,
                            gneiss_error *error);
/* Sets masses, sets and skin, when the specimen is measured. */
gneiss_status gn_dem_complete(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Creates empty records, so that other code needs no special case. */
gneiss_status gn_dem_create_empty(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Takes the kernel and the parameters of contacts from the scene of another stage. */
gneiss_status gn_dem_take_effects(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_dem_free(gn_dem *dem);

/* Computes how far particles have moved since the lists were made, for verlet.drift and
 * verlet.closed (travel.c). */
void gn_dem_look_at_travel(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box);

/* Updates the coefficients of dashpots after the step has changed (lists.c). */
void gn_dem_step_changed(const gn_step_context *ctx, gn_dem *dem);

uint64_t gn_dem_hash(const gn_step_context *ctx, const gn_dem *dem, uint64_t h);
size_t gn_dem_bytes(const gn_step_context *ctx, const gn_dem *dem);

/* Writes the vector from x to the nearest image of y, m; returns the square of its length. */
static inline double gn_branch(const gn_step_context *ctx, const double *x, const double *y,
                               double d[3]) {
    double d2 = 0.0;
    for (int a = 0; a < 3; a++) {
        d[a] = gn_nearest(y[a] - x[a], ctx->period[a]);
        d2 += d[a] * d[a];
    }
    return d2;
}
/* Returns the particle's own fraction of its mass: the rest was added for a longer step and has no
 * weight. */
static inline double gn_own_share(const gn_particles *particles, size_t p) {
    return particles->own_share ? particles->own_share[p] : 1.0;
}
/* Returns the squared length of the projection of a unit vector onto the free components; bit k of
 * `mask` is set if component k is held. */
static inline double gn_free_share(uint8_t mask, const double n[3]) {
    double free = 0.0;
    for (int a = 0; a < 3; a++)
        if (!(mask >> a & 1)) free += n[a] * n[a];
    return free;
}

/* Returns the arguments of the kernel of a list in the coming step. */
gn_contact_args gn_dem_contact_args(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_periodic_box *box, const gn_contact_list *list,
                                    bool measure);
/* Distributes the lists among ranks and threads. */
gneiss_status gn_dem_deal(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Returns the mean radius over all rows of particles, m. */
double gn_dem_mean_radius(const gn_dem *dem);

#endif
