/* Records of the conversions of a run. */
#ifndef GN_CONVERSION_RECORDS_H
#define GN_CONVERSION_RECORDS_H

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
struct gn_conversions {
    gn_relaxations relaxed;
    gn_corrections corrected;
    gn_conversion_parts parts;
    gn_packing_differs differs;
};

#endif
