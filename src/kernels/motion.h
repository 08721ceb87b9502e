/* The second pass of a step: the partial sums of each particle are added up in a fixed order, and
 * its motion is integrated. Sums over particles are kept per block and merged in block order. */
#ifndef GN_KERNELS_MOTION_H
#define GN_KERNELS_MOTION_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"
#include "soa/records.h"

/* Prescribed particles, by slot. */
typedef struct gn_prescription {
    size_t count;
    int32_t *set;     /* [count] the set to which the reaction is added */
    uint8_t *mask;    /* [count] bit k: component k of v xyz, w xyz is prescribed */
    double *velocity; /* [count][6] for the coming half step; free components are not used */
    double *load;     /* [count][6] output: the load that the prescription supplied (N, N m) */
} gn_prescription;

/* Blocks of particles whose motion waits: their loads are added up and stored here, other parts of
 * the model may add to them, and then the blocks move (sched/hold.h). */
typedef struct gn_hold {
    size_t blocks, count, room;
    int32_t *slot;  /* [blocks] index among the held blocks, -1: moves as soon as its forces are
                       complete */
    int32_t *block; /* [count] */
    double *load;   /* [room][GN_BLOCK_LOAD] N and N m, in rows as those of gn_partials */
} gn_hold;

/* Number of doubles in the loads of a block, for any width of a row. */
enum { GN_BLOCK_LOAD = 8 * GN_PARTICLE_BLOCK };

/* The two passes of a held block: adding up loads, and moving. */
typedef enum gn_motion_pass { GN_PASS_GATHER, GN_PASS_MOVE } gn_motion_pass;

typedef struct gn_motion_args {
    gn_particles *particles;
    int lists; /* number of partial sums, which are added up in this order */
    const gn_partials *partials[GN_LISTS_MOST];
    const gn_wall_contacts *wall_contacts; /* NULL when absent */
    const int32_t *wall_first;             /* [particles + 1] */
    gn_prescription *prescribed;           /* NULL when absent */
    double dt_past, dt; /* s: the interval that led here (0 at the start), and the coming one */
    double gravity[3];
    double damping;      /* coefficient of the background damping */
    double damping_spin; /* coefficient of the background damping of spins */
    /* Non-viscous damping of a component depends on the sign of v + damping_lead interval F/m. 0:
     * the velocity of the last half step; 0.5: that of the instant, without damping. */
    double damping_lead;
    bool measure;         /* kinetic energies and resultants are summed as well */
    bool changes;         /* the largest change of velocity is found as well */
    const gn_hold *hold;  /* NULL: all blocks move at once */
    gn_motion_pass pass;  /* pass of the held blocks */
    const double *origin; /* rows [n][4] relative to which travel_f is computed; NULL: `ref` */
} gn_motion_args;

/* Sums of a block of particles, X(merge, name, unit, text); blocks are merged in their order by
 * ADD, MOST (maximum), or FIRST (first non-negative). HALVES are added: works of the background
 * damping etc. are split in the halves 1/2 F dt v before and after the instant, and a reading takes
 * the first half only, so that it is trapezoidal at every instant. */
#define GN_MOTION_SUMS(X)                                                                          \
    X(ADD, kinetic, "J", "1/2 m v(-)v(+), with `measure`")                                         \
    X(ADD, rotational, "J", "kinetic energy of rotation, with `measure`")                          \
    X(ADD, resultant, "N", "sum of |F| over free particles, with `measure`")                       \
    X(HALVES, damping, "J", "dissipated")                                                          \
    X(HALVES, gravity, "J", "work")                                                                \
    X(HALVES, applied, "J", "work")                                                                \
    X(HALVES, prescribed, "J", "work")                                                             \
    X(MOST, speed2, "m2/s2", "largest")                                                            \
    X(MOST, spin2, "1/s2", "largest value, with `measure`")                                        \
    X(MOST, change2, "m2/s2", "largest change of a velocity, with `changes`")                      \
    X(FIRST, bad, "1", "a particle whose velocity is not finite, or -1")

typedef struct gn_motion_sums {
#define GN_SUM_ADD(name)           double name;
#define GN_SUM_HALVES(name)        double name[2];
#define GN_SUM_MOST(name)          double name;
#define GN_SUM_FIRST(name)         int64_t name;
#define X(merge, name, unit, text) GN_SUM_##merge(name)
    GN_MOTION_SUMS(X)
#undef X
#undef GN_SUM_ADD
#undef GN_SUM_HALVES
#undef GN_SUM_MOST
#undef GN_SUM_FIRST
} gn_motion_sums;

static inline void gn_motion_sums_add(gn_motion_sums *total, const gn_motion_sums *block) {
#define GN_SUM_ADD(name) total->name += block->name;
#define GN_SUM_HALVES(name)                                                                        \
    for (int half = 0; half < 2; half++) total->name[half] += block->name[half];
#define GN_SUM_MOST(name)          total->name = block->name > total->name ? block->name : total->name;
#define GN_SUM_FIRST(name)         total->name = total->name < 0 ? block->name : total->name;
#define X(merge, name, unit, text) GN_SUM_##merge(name)
    GN_MOTION_SUMS(X)
#undef X
#undef GN_SUM_ADD
#undef GN_SUM_HALVES
#undef GN_SUM_MOST
#undef GN_SUM_FIRST
}

typedef void gn_motion_kernel(const gn_motion_args *args, size_t begin, size_t end,
                              gn_motion_sums *sums);

/* The effects that change a motion kernel, by bit. */
#define GN_MOTION_EFFECTS(X)                                                                       \
    X(0, SPACE)                                                                                    \
    X(1, ROTATION)                                                                                 \
    X(2, VISCOUS)                                                                                  \
    X(3, NONVISCOUS_VECTOR)                                                                        \
    X(4, NONVISCOUS_COMPONENT)                                                                     \
    X(5, GRAVITY)                                                                                  \
    X(6, ENERGY)

enum { GN_MOTION_VARIANTS = 128 };

unsigned gn_motion_variant(gn_effects effects);
gn_effects gn_motion_variant_effects(unsigned variant);
void gn_motion_variant_name(unsigned variant, char *name, size_t size);

/* Entries with more than one kind of background damping are NULL. */
#define X(set, lanes, has) extern gn_motion_kernel *const gn_motion_table_##set[GN_MOTION_VARIANTS];
GN_INSTRUCTION_SETS(X)
#undef X

#endif
