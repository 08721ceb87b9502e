/* Records of the conversions of a run. */
#ifndef GN_CONVERSION_RECORDS_H
#define GN_CONVERSION_RECORDS_H

/* Moduli, Pa, and densities, kg/m3, of the particles and elements at the start, for the first
 * packed material in which they differ (gn_zone_differs); 0: they differ in none. Doubles, as in
 * checkpoints. */
typedef struct gn_packing_differs {
    double modulus[2], density[2], tension[4]; /* as in gn_zone_material.tension */
} gn_packing_differs;

/* Sums over the relaxations of newly released particles (conversion_relaxation.c) since the start,
 * in doubles as in checkpoints. */
typedef struct gn_relaxations {
    double count,
        iterations; /* relaxations of particles that were not in balance; total of iterations */
    double missed;  /* relaxations that did not reach the requested ratio */
    double stopped_by_bond_failure, unsupported,
        hit_iteration_limit; /* number of these by the cause that came first */
    double kept;             /* particles that were held for one of the first two causes */
    double worst, time;      /* the largest remaining ratio; its time, s */
} gn_relaxations;

/* Sums of the corrections of velocities by conversions (conversion_momentum.c) since the start, in
 * doubles as in checkpoints. */
typedef struct gn_corrections {
    double count, wider;  /* conversions; those in which momentum could not be restored by nodes and
                             particles of changed weight alone */
    double missed, least; /* conversions that did not restore all of the angular momentum; the
                             smallest restored fraction */
    double energy;        /* J: kinetic energy of all corrections, masses included */
    double turned[3]; /* kg m2/s: vector sum of the changes of angular momentum about the centre of
                         mass */
    double most;      /* the largest magnitude of `turned` */
    double scale;     /* largest m v of the body, or m v r (gn_tally_turns) */
    double centre[3]; /* m: vector sum of the displacements of the centre of mass */
    double inertia;   /* sum of the relative changes of the polar moment about the centre of mass */
} gn_corrections;

/* J: energy booked by conversions since the start, by cause (conversion_energy.c). The sum of the
 * causes is gn_energy.conversion, with the same sign; doubles, as checkpoints store them. */
typedef struct gn_conversion_parts {
    double sampled;   /* the volume that particles represent differs from that of the elements */
    double stiffness; /* springs store another energy than elements at the same strain */
    double uneven;   /* the strain differs between the two ends of a bond, or the bond had broken or
                        slipped before */
    double balance;  /* energy that relaxation removed */
    double motion;   /* change of the kinetic energy */
    double step;     /* half a step of the power of springs, those of walls excluded */
    double alike[2]; /* energies that elements and springs would store at the same strain of the
                        converted part; their difference is `stiffness` */
} gn_conversion_parts;

/* Doubles only, as checkpoints store them. */
struct gn_conversions {
    gn_relaxations relaxed;
    gn_corrections corrected;
    gn_conversion_parts parts;
    gn_packing_differs differs;
};

#endif
