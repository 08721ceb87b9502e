/* What the contact kernel and its laws share: the switches of a variant and the stages of a vector
 * of contacts. Inside src/kernels/contact_template.c and the laws it includes only. */
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

/* Work is staggered: a vector of contacts goes through six short stages, one per turn of the loop,
 * so that in every turn six vectors advance that do not wait for each other. A vector's own chain
 * of dependent operations (root, division, dot products) is longer than what a core can look ahead.
 */
enum { STAGES = 6, RING = 8 };

typedef struct pair_geometry {
    gn_v3 n; /* normal from i to j; before find_normal the branch, not of unit length */
    gn_v distance, stretch; /* stretch: beyond the distance at which the normal force is zero */
    gn_v arm_i, arm_j;      /* from the centres to the contact; before find_normal the radii */
} pair_geometry;

typedef struct pair_motion {
    gn_v3 middle;   /* see gn_middle */
    gn_v3 relative; /* tangential velocity at the contact, turned from the middle to the end */
} pair_motion;

/* A vector on its way. */
typedef struct stage {
    pair_geometry geometry;
    union {
        gn_v rate;   /* dt/(2 distance) */
        gn_v growth; /* from find_motion on, if growth_known: mean speed at which the distance grew
                      */
    };
    gn_v speed;          /* normal component at the end of the step, opening positive */
    gn_v angle;          /* mean turn of the pair about the normal in the step */
    gn_v3 before, trial; /* see contact_state */
} stage;

/* What only the next stage reads. */
typedef union brief {
    pair_motion motion;
    _Alignas(64) gn_real row[8 * GN_W]; /* force on i, 0, n x F_t, 0 (width 4: see gn_partials) */
} brief;

/* Indices into the ring are shifts then. */
_Static_assert(sizeof(stage) == 16 * sizeof(gn_v), "a stage has a power of two of bytes");
_Static_assert(sizeof(brief) == 8 * sizeof(gn_v) || sizeof(gn_v) < 64, "so has a brief");

/* Lane sums, kept in registers over a block and folded in lane order at its end. */
typedef struct lane_sums {
    gn_v elastic_normal, elastic_shear, elastic_bending;
    gn_v stress[9], force, carrying;
#define X(name, text) gn_v name;
    GN_CONTACT_LOSSES(X)
#undef X
} lane_sums;

/* Of a contact on its first particle: along the normal, and across it. */
typedef struct contact_force {
    gn_v normal;
    gn_v3 shear;
} contact_force;

/* Square of the velocity across the normal. */
GN_INLINE gn_v across2_of(gn_v3 v, gn_v speed, int space) {
    return gn_max(gn_fnma(speed, speed, gn_dot(v, v, space)), gn_set(0.0));
}

/* How fast the distance grew in the step. Before it was |d n - dt v|, with q = d - dt speed the
 * root of q^2 + dt^2 across^2: it grew by dt speed - dt^2 across^2/(2 q) and less. */
GN_INLINE gn_v growth_of(gn_v3 v, gn_v speed, gn_v rate, int space) {
    return gn_fnma(across2_of(v, speed, space), rate, speed);
}

/* The dashpots of bonds follow it, the ledger has the work of all dashpots by it, and those of
 * Hertz's law have to know when they began: it is found where the velocities are at hand. */
GN_INLINE int growth_known(variant w) {
    return w.damping && (w.bonds || w.energy || w.law == LAW_hertz || w.law == LAW_hertz_rolling);
}

/* `p` once its normal is of unit length. */
GN_INLINE gn_v3 opening_velocity(const gn_contact_args *a, size_t c, const pair_geometry *p,
                                 variant w) {
    gn_v opening[4];
    gn_rows4_less(COLUMN(a, vel), a->contacts->j + c, a->contacts->i + c, opening);
    gn_v3 v = {opening[0], opening[1], gn_pick(w.space, opening[2], gn_set(0.0))};
#if !GN_MIXED
    if (w.periodic && a->flows) {
        v.x = v.x + gn_set(a->flow[0]) * (p->distance * p->n.x);
        v.y = v.y + gn_set(a->flow[1]) * (p->distance * p->n.y);
        if (w.space) v.z = v.z + gn_set(a->flow[2]) * (p->distance * p->n.z);
    }
#else
    (void)p;
#endif
    return v;
}

#endif
