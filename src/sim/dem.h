/* Particles: their records, contacts and lists, what drives them, and the step that they allow. */
#ifndef GN_SIM_DEM_H
#define GN_SIM_DEM_H

#include "kernels/dispatch.h"
#include "limit/timestep.h"
#include "neigh/pairs.h"
#include "sched/deal.h"
#include "sched/hold.h"

/* State of the Verlet lists. */
typedef struct gn_verlet {
    double skin;       /* m, as it is now */
    double skin_start; /* m, as it was at the start */
    double widened;    /* m, the widest that it had to be beyond the scene's; 0: never */
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

typedef struct gn_dem {
    gn_particles particles;
    gn_contacts bonds, pairs;
    gn_partials bond_partials, pair_partials;
    gn_uniform bond_uniform, pair_uniform;
    int32_t *index_of_id; /* [particles] */
    gn_derived derived;
    gn_prescription prescribed;
    int32_t *channel_set; /* [prescribed.count][6] set that drives a channel, -1: free */
    double *set_reaction; /* [scene.set_count][6] N, N m: what the prescription supplied */
    gn_verlet verlet;
    double radius_min;       /* m */
    double mass;             /* kg, of those that were there when the lists were made */
    double damping_fraction; /* of critical, of contacts that are pressed */

    gn_contact_kernel *bond_kernel, *pair_kernel;
    gn_motion_kernel *motion_kernel;
    gn_deal deal;                           /* of steps among the threads */
    gn_hold hold;                           /* particles that wait for an exchange */
    gn_contact_sums *bond_sums, *pair_sums; /* per block of contacts */
    gn_motion_sums *motion_sums;
    size_t motion_blocks;
    double speed_most; /* m/s, of the fastest in the last step; 0: not known (start, resume) */

    gn_step_limit limit; /* last full estimate */
    double stable;       /* s: the limit of the particles alone, damping left out */
    double listed;       /* s: the limit with all listed contacts in touch, where it was found to be
                          * within a hundredth of the step or below it; else INFINITY */
    double listed_holds; /* s: step of the particles alone at which all that is listed holds */
    gn_resolution resolution; /* the shortest so far */
    uint8_t *loose;           /* [particles] by id: not bonded at the start, see resolution.c */

    int64_t broken_tension, broken_shear, bonds_at_start;
    int64_t lost;          /* removed particles */
    int64_t contact_steps; /* contacts worked on, summed over steps */
} gn_dem;

#endif
