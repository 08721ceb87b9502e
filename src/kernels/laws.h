/* The contact laws, and the kinds of contact lists that have kernels. With GN_LAW_FORCES, which the
 * contact kernel defines, their forces as well. */
#ifndef GN_KERNELS_LAWS_H
#define GN_KERNELS_LAWS_H

#include "base/effects.h"

/* The contact laws: X(name, effects that select it, lists that have it), with laws that need more
 * effects first. Lists for which no effect selects another law have the linear one. The files of a
 * law are law_<name>.h and law_<name>.c, see law.h. */
#define GN_LAWS(X)                                                                                 \
    X(joint, GN_FX_JOINTS | GN_FX_MOHR, GN_LAW_OF_JOINTS)                                          \
    X(softening, GN_FX_SOFTENING | GN_FX_MOHR, GN_LAW_OF_BONDS)                                    \
    X(beam, GN_FX_BOND_MOMENTS, GN_LAW_OF_BONDS)                                                   \
    X(mohr, GN_FX_MOHR, GN_LAW_OF_BONDS)                                                           \
    X(cohesive_rolling, GN_FX_HERTZ | GN_FX_COHESION | GN_FX_ROLLING, GN_LAW_OF_PAIRS)             \
    X(cohesive, GN_FX_HERTZ | GN_FX_COHESION, GN_LAW_OF_PAIRS)                                     \
    X(hertz_rolling, GN_FX_HERTZ | GN_FX_ROLLING, GN_LAW_OF_PAIRS)                                 \
    X(hertz, GN_FX_HERTZ, GN_LAW_OF_PAIRS)                                                         \
    X(rolling, GN_FX_ROLLING, GN_LAW_OF_PAIRS)                                                     \
    X(linear, GN_FX_ALWAYS, GN_LAW_OF_ALL)
enum { GN_LAW_OF_ALL, GN_LAW_OF_BONDS, GN_LAW_OF_PAIRS, GN_LAW_OF_JOINTS };

/* The kinds of lists that have kernels. X(number, name, body, law, then SHEAR, FRICTION, BONDS as 0
 * or 1: effects that define the kind in addition to those of the law). The list is in parts that
 * are compiled separately, in parallel. `body` is the kind whose code also serves this one, because
 * friction of broken bonds is a branch that few vectors take. */
#define GN_CONTACT_KINDS_0(X)                                                                      \
    X(0, smooth, smooth, linear, 0, 0, 0)                                                          \
    X(1, frictional, frictional, linear, 1, 1, 0)                                                  \
    X(2, bond_normal, bond_normal, linear, 0, 0, 1)                                                \
    X(3, bond, bond, linear, 1, 0, 1)                                                              \
    X(4, bond_frictional, bond, linear, 1, 1, 1)
#define GN_CONTACT_KINDS_1(X)                                                                      \
    X(5, mohr, mohr, mohr, 1, 0, 1)                                                                \
    X(6, mohr_frictional, mohr, mohr, 1, 1, 1)                                                     \
    X(7, softening, softening, softening, 1, 0, 1)                                                 \
    X(8, softening_frictional, softening, softening, 1, 1, 1)
#define GN_CONTACT_KINDS_2(X)                                                                      \
    X(9, beam, beam, beam, 1, 0, 1)                                                                \
    X(10, beam_frictional, beam, beam, 1, 1, 1)                                                    \
    X(11, hertz, hertz, hertz, 0, 0, 0)                                                            \
    X(12, hertz_frictional, hertz_frictional, hertz, 1, 1, 0)                                      \
    X(13, rolling, rolling, rolling, 1, 1, 0)                                                      \
    X(14, hertz_rolling, hertz_rolling, hertz_rolling, 1, 1, 0)
#define GN_CONTACT_KINDS_3(X)                                                                      \
    X(15, cohesive, cohesive, cohesive, 0, 0, 0)                                                   \
    X(16, cohesive_frictional, cohesive_frictional, cohesive, 1, 1, 0)                             \
    X(17, cohesive_rolling, cohesive_rolling, cohesive_rolling, 1, 1, 0)                           \
    X(18, joint, joint, joint, 1, 0, 1)                                                            \
    X(19, joint_frictional, joint, joint, 1, 1, 1)
#define GN_CONTACT_KINDS(X)                                                                        \
    GN_CONTACT_KINDS_0(X)                                                                          \
    GN_CONTACT_KINDS_1(X)                                                                          \
    GN_CONTACT_KINDS_2(X)                                                                          \
    GN_CONTACT_KINDS_3(X)

#endif

#ifdef GN_LAW_FORCES
#undef GN_LAW_FORCES
#include "kernels/law_beam.h"
#include "kernels/law_cohesive.h"
#include "kernels/law_hertz.h"
#include "kernels/law_joint.h"
#include "kernels/law_linear.h"
#include "kernels/law_mohr.h"
#include "kernels/law_rolling.h"
#include "kernels/law_softening.h"
#endif
