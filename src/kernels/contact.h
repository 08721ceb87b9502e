/* Contacts between particles: arguments and results of a kernel, and the table of variants. */
#ifndef GN_KERNELS_CONTACT_H
#define GN_KERNELS_CONTACT_H

#include "base/instruction_sets.h"
#include "kernels/laws.h"
#include "kernels/partials.h"
#include "soa/records.h"

#include <stdbool.h>

_Static_assert(GN_CONTACT_BLOCK_LEAST % GN_LANES_MAX == 0, "a block holds whole vectors");

/* Columns of parameters that may be the same for all contacts of a list. Per column: all bits are
 * set if they are, and the kernel then reads the first item repeatedly instead of streaming the
 * column; else 0. */
#define GN_UNIFORM_COLUMNS(X)                                                                      \
    X(kn)                                                                                          \
    X(kt)                                                                                          \
    X(mu) X(cn) X(mu1) X(beam) X(share) X(lag) X(rolling) X(twisting) X(reduced) X(adhesion) X(span)
typedef struct gn_uniform {
#define X(name) size_t name;
    GN_UNIFORM_COLUMNS(X)
#undef X
} gn_uniform;

/* An overlap within this fraction of the distance (at a wall: of the radius) is due to rounding of
 * positions and counts as none. Whether a contact that begins at 0 has begun is then decided alike
 * in this step and in the next one, which uses the previous stretch. */
#define GN_OVERLAP_ROUNDING 0x1p-48

/* The particles whose contacts are summed in the sums of the structure: those with centres in a
 * box, m. */
typedef struct gn_structure_box {
    bool used;  /* the sums are formed */
    bool whole; /* the box is unlimited */
    double low[3], high[3];
} gn_structure_box;
static inline bool gn_in_structure(const gn_structure_box *box, const double x[3]) {
    bool in = true;
    for (int a = 0; a < 3; a++) in = in && box->low[a] <= x[a] && x[a] <= box->high[a];
    return in;
}

typedef struct gn_contact_args {
    const double *pos, *vel, *spin; /* particle rows [n][4]; spin NULL without rotation */
    /* rows in mixed precision; pos_f: displacement, see records.h */
    const float *pos_f, *vel_f, *spin_f;
    /* fields of the contacts may be written, the record may not; rows of contacts only if the list
     * stores forces */
    const gn_contacts *contacts;
    gn_uniform uniform;
    const gn_partials
        *partials;     /* partial sums of `contacts`, in which forces are summed; NULL: none */
    double dt;         /* s, the interval that led to these positions; 0 at the start */
    double speed_most; /* m/s, largest speed of a particle in that interval; 0: unknown */
    double arm_factor; /* 0.5: contact point at r + gap/2; 0: at r */
    double period[3], inverse_period[3]; /* m, 1/m, with GN_FX_PERIODIC */
    /* 1/s: relative growth of branches with the box in the interval dt, if `flows` */
    double flow[3];
    /* the sides of the periodic box moved: velocities are relative to the mean flow (drive/box.h)
     */
    bool flows;
    /* [particles] slot of a particle with prescribed components, -1: it has none; NULL: no particle
     * has any */
    const int32_t *slot;
    const uint8_t *held; /* [slots] prescribed components, see gn_prescription.mask */
    double gravity[3];   /* m/s2 */
    const double *own; /* [particles] fraction of gravity that accelerates each particle; NULL: 1 */
    int cohesion;      /* gn_cohesion, with GN_FX_COHESION */
    double rupture;    /* (1 + theta/2)^3, with liquid bridges; see cohesion.h */
    double time;       /* s, time of the instant */
    bool measure;      /* the sums for readings are computed as well, see gn_contact_sums */
    gn_structure_box structure;
} gn_contact_args;

/* Energy losses of a block of contacts in a step: X(name, text), J. Lanes sum up each loss under
 * its name, and it is added to the ledger's term of the same name. */
#define GN_CONTACT_LOSSES(X)                                                                       \
    X(friction, "dissipated in this step")                                                         \
    X(contact_damping, "dissipated in this step")                                                  \
    X(bond_breaking, "released in this step")                                                      \
    X(damage, "dissipated in this step")                                                           \
    X(plasticity, "dissipated in this step")                                                       \
    X(rolling, "dissipated in this step")                                                          \
    X(cohesion, "dissipated in this step")

/* Other sums of a block: X(type, name, unit, text), V(type, name, components, unit, text). */
#define GN_CONTACT_SUMS(X, V)                                                                      \
    X(double, elastic_normal, "J", "stored; with `measure` and energies")                          \
    X(double, elastic_shear, "J", "stored; with `measure` and energies")                           \
    X(double, elastic_bending, "J", "stored; with `measure` and energies")                         \
    V(double, stress, 9, "N m", "f_a l_b, l = x_j - x_i; with `measure`")                          \
    X(double, force, "N", "sum of |f|; with `measure`")                                            \
    X(double, carrying, "1", "contacts that carry force; with `measure`")                          \
    V(double, fabric, 9, "1", "n_a n_b, as `ends`")                                                \
    X(double, ends, "1", "ends in `structure` of contacts that carry force or are bonds")          \
    X(double, loose_ends, "1", "such ends of contacts that are not intact bonds")                  \
    X(double, sliding_ends, "1", "such ends of contacts at their limit of friction")               \
    X(int64_t, broken_tension, "1", "bonds broken in this step")                                   \
    X(int64_t, broken_shear, "1", "bonds broken in this step")                                     \
    X(int64_t, began, "1", "bonds that began to soften or to yield in this step; with events")     \
    X(int64_t, pressed, "1",                                                                       \
      "contacts with an overlap beyond that for which the step was checked")                       \
    X(int64_t, wetting, "1", "contacts whose liquid bridge is to form or has ruptured in this step")

typedef struct gn_contact_sums {
#define X(type, name, unit, text)             type name;
#define V(type, name, components, unit, text) type name[components];
    GN_CONTACT_SUMS(X, V)
#undef X
#undef V
#define X(name, text) double name;
    GN_CONTACT_LOSSES(X)
#undef X
} gn_contact_sums;

static inline void gn_contact_sums_add(gn_contact_sums *total, const gn_contact_sums *block) {
#define X(type, name, unit, text) total->name += block->name;
#define V(type, name, components, unit, text)                                                      \
    for (int k = 0; k < (components); k++) total->name[k] += block->name[k];
    GN_CONTACT_SUMS(X, V)
#undef X
#undef V
#define X(name, text) total->name += block->name;
    GN_CONTACT_LOSSES(X)
#undef X
}

/* Processes contacts [begin, end) of one block of the partial sums (without partial sums, `begin`
 * may be any multiple of GN_LANES_MAX); vectors may extend past `end` into padding. Sets the
 * block's partial sums and adds to *sums. */
typedef void gn_contact_kernel(const gn_contact_args *args, size_t begin, size_t end,
                               gn_contact_sums *sums);

/* Options of any kind, by the bits of a variant's number. */
#define GN_CONTACT_OPTIONS(X)                                                                      \
    X(0, SPACE)                                                                                    \
    X(1, ROTATION)                                                                                 \
    X(2, CONTACT_DAMPING)                                                                          \
    X(3, ENERGY)                                                                                   \
    X(4, PERIODIC)

#define X(number, ...) +1
enum { GN_CONTACT_VARIANTS = 32 * (0 GN_CONTACT_KINDS(X)) }; /* 32 * kind + options */
#undef X

/* Return the number of the variant for an effects mask (GN_CONTACT_VARIANTS for a kind without
 * kernels), and the mask of a variant. */
unsigned gn_contact_variant(gn_effects effects);
gn_effects gn_contact_variant_effects(unsigned variant);

/* Writes "contact_bond_frictional_space_rotation_energy" into `name`. */
void gn_contact_variant_name(unsigned variant, char *name, size_t size);

/* Returns the effects of a list of contacts under a scene's effects. For pairs the effects of bonds
 * are cleared, and the tangential spring with them if nothing could load it (no friction). */
gn_effects gn_contact_list_effects(gn_effects scene_effects, bool bonds);

/* One table per instruction set and precision. In mixed precision entries of periodic boxes are
 * NULL: the initial branch contains the image. */
#define X(set, lanes, has)                                                                         \
    extern gn_contact_kernel *const gn_contact_table_##set[GN_CONTACT_VARIANTS];                   \
    extern gn_contact_kernel *const gn_contact_table_##set##_mixed[GN_CONTACT_VARIANTS];
GN_INSTRUCTION_SETS(X)
#undef X

#endif
