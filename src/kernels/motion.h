/* Second pass of a step: add up the partial sums of each particle in fixed order and integrate.
 * Sums over particles are kept per block and merged in block order. */
#ifndef GN_KERNELS_MOTION_H
#define GN_KERNELS_MOTION_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"
#include "soa/records.h"

/* Prescribed particles, by slot. */
typedef struct gn_prescription {
    size_t count;
    int32_t *set;     /* [count] the set that takes the reaction */
    uint8_t *mask;    /* [count] bit k: component k of v xyz, w xyz is prescribed */
    double *velocity; /* [count][6] for the coming half step; free components unused */
    double *load;     /* [count][6] out: what the prescription had to supply (N, N m) */
} gn_prescription;

/* Blocks of particles that wait with their motion: their loads are added up and kept here, where
 * an exchange between parts of a model may add to them; then they move (sched/hold.h). */
typedef struct gn_hold {
    size_t blocks, count, room;
    int32_t *slot;  /* [blocks] place among those held, -1: moves at once */
    int32_t *block; /* [count] */
    double *load;   /* [room][GN_BLOCK_LOAD] N and N m, in rows as those of gn_partials */
} gn_hold;

/* Doubles that a block's loads take, whatever the width of a row. */
enum { GN_BLOCK_LOAD = 8 * GN_PARTICLE_BLOCK };

/* The two passes of a block that is held. */
typedef enum gn_motion_pass { GN_PASS_GATHER, GN_PASS_MOVE } gn_motion_pass;

typedef struct gn_motion_args {
    gn_particles *particles;
    const gn_partials *bonds, *pairs;
    const gn_wall_contacts *wall_contacts; /* NULL when absent */
    const int32_t *wall_first;             /* [particles + 1] */
    gn_prescription *prescribed;           /* NULL when absent */
    double dt_past, dt; /* s: the interval that led here (0 at the start) and the coming one */
    double gravity[3];
    double damping;      /* coefficient of the background damping */
    double damping_spin; /* the same of spins */
    /* Non-viscous, per component: the sign is that of v + damping_lead interval F/m. 0: of the last
     * half step; 0.5: of the instant, if nothing were damped. */
    double damping_lead;
    bool measure;         /* also sum kinetic energies and resultants */
    bool changes;         /* also find by how much velocities change at most */
    const gn_hold *hold;  /* NULL: all blocks move at once */
    gn_motion_pass pass;  /* of blocks that are held */
    const double *origin; /* rows [n][4] that travel_f is counted from; NULL: `ref` */
} gn_motion_args;

/* What a block of particles sums up, X(merge, name, unit, text); merging blocks in their order is
 * to ADD, to take the MOST, or the FIRST that is not negative. HALVES are added: works of the
 * background damping and so on are split in the halves 1/2 F dt v before and after the instant: a
 * reading takes the first half only, so that it is trapezoidal at every instant. */
#define GN_MOTION_SUMS(X)                                                                          \
    X(ADD, kinetic, "J", "1/2 m v(-)v(+), with `measure`")                                         \
    X(ADD, rotational, "J", "the same of rotation, with `measure`")                                \
    X(ADD, resultant, "N", "sum of |F| over free particles, with `measure`")                       \
    X(HALVES, damping, "J", "dissipated")                                                          \
    X(HALVES, gravity, "J", "work")                                                                \
    X(HALVES, applied, "J", "work")                                                                \
    X(HALVES, prescribed, "J", "work")                                                             \
    X(MOST, speed2, "m2/s2", "largest")                                                            \
    X(MOST, spin2, "1/s2", "largest, with `measure`")                                              \
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

/* NULL entries: more than one kind of background damping. */
#define X(set, lanes, has) extern gn_motion_kernel *const gn_motion_table_##set[GN_MOTION_VARIANTS];
GN_INSTRUCTION_SETS(X)
#undef X

#endif
