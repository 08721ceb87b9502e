/* Declarations shared by the contact kernel and its laws: the switches of a variant and the stages
 * of a vector of contacts. Private to src/kernels/contact_template.c and the laws it includes. */
#ifndef GN_KERNELS_CONTACT_INTERNAL_H
#define GN_KERNELS_CONTACT_INTERNAL_H

#include "kernels/contact.h"
#include "kernels/contact_law.h"

#define X(name, ...) LAW_##name,
typedef enum contact_law { GN_LAWS(X) } contact_law;
#undef X

/* Literal switches of a variant. */
typedef struct variant {
    contact_law law;
    int space, rotation, shear, friction, bonds, damping, energy, periodic;
} variant;

/* A column in the precision of the kernel. */
#if GN_MIXED
#define COLUMN(list, name) ((list)->name##_f)
#else
#define COLUMN(list, name) ((list)->name)
#endif

/* The loop is pipelined: a vector of contacts passes through six short stages, one per iteration,
 * so that every iteration advances six independent vectors. The chain of dependent operations of
 * one vector (root, division, dot products) is longer than the instruction window of a core. */
enum { STAGES = 6, RING = 8 };

typedef struct pair_geometry {
    gn_v3 n;                /* normal from i to j; before find_normal the branch, not normalised */
    gn_v distance, stretch; /* stretch: distance less that of zero normal force */
    gn_v arm_i, arm_j;      /* arms from the centres to the contact; before find_normal the radii */
} pair_geometry;

typedef struct pair_motion {
    gn_v3 middle;   /* see gn_middle */
    gn_v3 relative; /* tangential velocity at the contact, rotated from the middle to the end */
} pair_motion;

/* A vector in the pipeline. */
typedef struct stage {
    pair_geometry geometry;
    union {
        gn_v rate; /* dt/(2 distance) */
        /* mean rate at which the distance grew, from find_motion on, if growth_known */
        gn_v growth;
    };
    gn_v speed;          /* normal velocity at the end of the step, opening positive */
    gn_v angle;          /* mean rotation of the pair about the normal in the step */
    gn_v3 before, trial; /* see contact_state */
} stage;

/* Data that only the next stage reads. */
typedef union brief {
    pair_motion motion;
    _Alignas(64) gn_real row[8 * GN_W]; /* force on i, 0, n x F_t, 0 (width 4: see gn_partials) */
} brief;

/* Indices into the ring are then shifts. */
_Static_assert(sizeof(stage) == 16 * sizeof(gn_v), "a stage has a power of two of bytes");
_Static_assert(sizeof(brief) == 8 * sizeof(gn_v) || sizeof(gn_v) < 64,
               "a brief has a power of two of bytes");

/* Data of the sums of a block, one value per lane; they stay in registers and are added up in lane
 * order at the end. */
typedef struct lane_sums {
    gn_v elastic_normal, elastic_shear, elastic_bending;
    gn_v stress[9], force, carrying;
#define X(name, text) gn_v name;
    GN_CONTACT_LOSSES(X)
#undef X
} lane_sums;

/* The force of a contact on its first particle: its component along the normal, the vector across
 * it, and the attraction that presses the two solids in addition to -normal. */
typedef struct contact_force {
    gn_v normal;
    gn_v3 shear;
    gn_v beside;
} contact_force;

/* Returns the square of the velocity across the normal. */
GN_INLINE gn_v across2_of(gn_v3 v, gn_v speed, int space) {
    return gn_max(gn_fnma(speed, speed, gn_dot(v, v, space)), gn_set(0.0));
}

/* Returns the rate at which the distance d grew in the step. Before the step the distance was |d n
 * - dt v|, which is the root of q^2 + dt^2 across^2 with q = d - dt speed; to leading order it grew
 * by dt speed - dt^2 across^2/(2 q). */
GN_INLINE gn_v growth_of(gn_v3 v, gn_v speed, gn_v rate, int space) {
    return gn_fnma(across2_of(v, speed, space), rate, speed);
}

GN_INLINE int coheres(contact_law law) {
    return law == LAW_cohesive || law == LAW_cohesive_rolling;
}

/* Tells whether the growth is computed, while the velocities are loaded. It is needed for the
 * dashpots of bonds, for the work of all dashpots in the ledger, and for the instants at which
 * dashpots of Hertz's law and attractive forces began to act. */
GN_INLINE int growth_known(variant with) {
    return coheres(with.law) ||
           (with.damping &&
            (with.bonds || with.energy || with.law == LAW_hertz || with.law == LAW_hertz_rolling));
}

/* Returns the velocity at which the contact opens; the normal of `geometry` has unit length. */
GN_INLINE gn_v3 opening_velocity(const gn_contact_args *args, size_t c,
                                 const pair_geometry *geometry, variant with) {
    gn_v opening[4];
    gn_rows4_less(COLUMN(args, vel), args->contacts->j + c, args->contacts->i + c, opening);
    gn_v3 v = {opening[0], opening[1], gn_pick(with.space, opening[2], gn_set(0.0))};
#if !GN_MIXED
    if (with.periodic && args->flows) {
        v.x = v.x + gn_set(args->flow[0]) * (geometry->distance * geometry->n.x);
        v.y = v.y + gn_set(args->flow[1]) * (geometry->distance * geometry->n.y);
        if (with.space) v.z = v.z + gn_set(args->flow[2]) * (geometry->distance * geometry->n.z);
    }
#else
    (void)geometry;
#endif
    return v;
}

#endif
