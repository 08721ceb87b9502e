/* Selection of kernels by instruction set (at run time) and by effects. */
#ifndef GN_KERNELS_DISPATCH_H
#define GN_KERNELS_DISPATCH_H

#include "base/instruction_sets.h"
#include "kernels/contact.h"
#include "kernels/element.h"
#include "kernels/motion.h"
#include "kernels/near.h"
#include "kernels/pressure.h"

/* Kernels of one instruction set. */
typedef struct gn_kernel_set {
    const char *name;
    int lanes;                           /* doubles in a register */
    bool (*supported)(void);             /* whether this machine supports it */
    gn_contact_kernel *const *contact;   /* [GN_CONTACT_VARIANTS] */
    gn_contact_kernel *const *mixed;     /* kernels in mixed precision */
    gn_motion_kernel *const *motion;     /* [GN_MOTION_VARIANTS] */
    gn_element_kernel *const *element;   /* [GN_ELEMENT_VARIANTS] */
    gn_element_kernel *const *single;    /* [2] triangles, tetrahedra, in mixed precision */
    gn_dilation_kernel *const *dilation; /* [2] triangles, tetrahedra */
    gn_pressure_kernel *const *pressure; /* [GN_PRESSURE_PASSES] */
    const gn_near_kernels *near;
} gn_kernel_set;

#define X(set, lanes, has) +1
enum { GN_KERNEL_SETS = GN_INSTRUCTION_SETS(X) };
#undef X

/* Returns a set of kernels; sets are ordered from narrow to wide vectors, index in [0,
 * GN_KERNEL_SETS). */
const gn_kernel_set *gn_kernel_set_at(int index);

/* Tells whether this machine can run a set. */
bool gn_kernel_set_supported(const gn_kernel_set *set);

/* Finds the set called `name`; for "auto" or NULL, the one named by GNEISS_ISA in the environment,
 * else the widest that the machine supports. Fails with a list of the supported sets if the name is
 * unknown or not supported. */
gneiss_status gn_kernel_set_choose(const char *name, const gn_kernel_set **set,
                                   gneiss_error *error);

/* Finds the kernel of a set for effects (GN_FX_MIXED: in mixed precision); fails with the variant's
 * name if there is none. */
gneiss_status gn_contact_kernel_choose(const gn_kernel_set *set, gn_effects list_effects,
                                       gn_contact_kernel **kernel, gneiss_error *error);
gneiss_status gn_motion_kernel_choose(const gn_kernel_set *set, gn_effects effects,
                                      gn_motion_kernel **kernel, gneiss_error *error);

#endif
