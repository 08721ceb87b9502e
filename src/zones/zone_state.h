/* State of the zones that particles and elements share, and records of conversions. */
#ifndef GN_ZONES_ZONE_STATE_H
#define GN_ZONES_ZONE_STATE_H

#include "frame/parts.h"
#include "zones/zones.h"

#include <stdint.h>

/* The element that came nearest to a limit of couple.convert: its part of it, when and where at the
 * start, relative to the origin. Nothing moves by it. */
struct gn_most_loaded {
    double share, time, place[3];
    int32_t element;
};

/* Moduli, Pa, and densities, kg/m3, of the particles and elements of the first packed material that
 * differs (gn_zone_differs), at the start; 0: none differs. Doubles, as in checkpoints. */
typedef struct gn_packing_differs {
    double modulus[2], density[2], tension[4]; /* tension: as gn_zone_material has it */
} gn_packing_differs;

/* Sums over the relaxations of newly released particles (conversion_relaxation.c) since the start,
 * in doubles as in checkpoints. */
typedef struct gn_relaxations {
    double count, iterations; /* relaxations of particles out of balance; their iterations */
    double missed;            /* did not reach the requested ratio, */
    double stopped_by_bond_failure, unsupported, hit_iteration_limit; /* first cause of these */
    double kept;        /* particles that were held, by one of the first two causes */
    double worst, time; /* the largest remaining ratio; its time, s */
} gn_relaxations;

/* Sums of the corrections of velocities by conversions (conversion_momentum.c) since the start, in
 * doubles as in checkpoints. */
typedef struct gn_corrections {
    double count, wider; /* conversions; those in which more than the nodes and particles of changed
                             weight compensated for momentum */
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

/* J: what conversions booked, by what made it (conversion_energy.c), since the start, with
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

/* Doubles alone, as checkpoints hold it. */
typedef struct gn_zone_state {
    double frequency; /* rad/s, largest of the particles, which sets the springs of zones */
    double rate[2];   /* 1/s: what springs add to the rates 1/dt of particles and elements */
    double turned;    /* what slaved spins add, over the square of the particles' frequency */
    double whole;     /* s: sharp limit of particles and elements as one; 0: not looked for */
    double stress[9]; /* Pa: what elements have of the mean stress of the particles' volume, at
                       * the last measured instant */
    gn_relaxations relaxed;
    gn_corrections corrected;
    gn_conversion_parts parts;
    gn_packing_differs differs;
} gn_zone_state;

struct gn_zones {
    struct gn_coupled *coupled; /* ties and masses (zones/zones.h); NULL: none */
    gn_zone_state state;
};

#endif
