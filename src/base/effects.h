/* Effects that a scene can request. A scene results in a mask of effects: fields without an active
 * effect are not allocated, passes without one are skipped, and the kernel is chosen that has only
 * the active ones. `gneiss plan` prints the mask. One list generates the enum, the names and the
 * texts. */
#ifndef GN_BASE_EFFECTS_H
#define GN_BASE_EFFECTS_H

#include <stdint.h>

/* X(NAME, name, text) */
#define GN_EFFECTS(X)                                                                              \
    X(SPACE, space, "three dimensions (spheres); without it discs in plane strain")                \
    X(ROTATION, rotation, "particle spins and moments")                                            \
    X(PAIRS, pairs, "contacts between unbonded particles")                                         \
    X(SHEAR, shear, "tangential springs (friction or bonds with shear stiffness)")                 \
    X(FRICTION, friction, "Coulomb friction with radial return")                                   \
    X(BONDS, bonds, "brittle bonds")                                                               \
    X(MOHR, mohr, "bonds whose shear strength depends on the normal force (Mohr-Coulomb)")         \
    X(SOFTENING, softening, "bonds that soften before they break, or yield under pressure")        \
    X(YIELD, yield, "bonds that yield under pressure")                                             \
    X(COUPLED_QUADRATIC, coupled_quadratic,                                                        \
      "bonds that fail by tension and shear combined (quadratic criterion)")                       \
    X(COUPLED_LINEAR, coupled_linear, "bonds whose shear strength tension reduces by mu_1 f_n")    \
    X(CONTACT_DAMPING, contact_damping, "normal viscous damping in contacts (restitution)")        \
    X(VISCOUS, viscous, "background damping -a m v")                                               \
    X(NONVISCOUS_VECTOR, nonviscous_vector, "background damping -a |F| v/|v|")                     \
    X(NONVISCOUS_COMPONENT, nonviscous_component, "background damping -a |F_k| sign(v_k)")         \
    X(GRAVITY, gravity, "uniform body acceleration")                                               \
    X(APPLIED, applied, "forces applied to particle sets")                                         \
    X(PRESCRIBED, prescribed, "prescribed motion of particle sets, with reactions")                \
    X(WALLS, walls, "contacts with walls")                                                         \
    X(WALL_SHEAR, wall_shear, "friction on walls and surfaces")                                    \
    X(PERIODIC, periodic, "periodic box")                                                          \
    X(ORIENTATION, orientation, "particle orientations (quaternions) for output")                  \
    X(ENERGY, energy, "energy ledger")                                                             \
    X(MIXED, mixed, "forces in single precision, sums and state in double")                        \
    X(CONTACT_FORCES, contact_forces,                                                              \
      "forces stored per contact, for a moving periodic box and during output")                    \
    X(PRESSURE, pressure, "finite elements with pressures at their nodes (mixed form)")            \
    X(ELEMENTS, elements, "finite elements")                                                       \
    X(FACETS, facets, "surfaces of triangles or segments, with walls")                             \
    X(MASS_SCALING, mass_scaling, "added particle mass, for a longer step")                        \
    X(AREA, area, "bonds with sections of their own (laws by area)")                               \
    X(BOND_MOMENTS, bond_moments, "bending and twisting moments in bonds")                         \
    X(MEMBRANE, membrane, "pressure on the surface of the specimen")                               \
    X(EVENTS, events, "events: where and when bonds broke, began to soften or to yield")           \
    X(CONFINED, confined, "bonds whose shear strength follows the mean stress around them")        \
    X(HERTZ, hertz, "Hertz-Mindlin contacts of particles that are not bonded")                     \
    X(NO_PULL, no_pull, "contacts whose dashpot never exerts tension")                             \
    X(ROLLING, rolling, "contacts that resist rolling and twisting")                               \
    X(OVERLAP, overlap, "coupling zones of particles and finite elements")                         \
    X(COHESION, cohesion, "contacts that attract each other (JKR, DMT, liquid bridges)")           \
    X(JOINTS, joints, "contacts across joints (smooth joints)")                                    \
    X(CLUMPS, clumps, "rigid clumps of particles")

typedef enum gn_effect_index {
#define X(NAME, name, text) GN_FX_INDEX_##NAME,
    GN_EFFECTS(X)
#undef X
        GN_EFFECT_COUNT
} gn_effect_index;

/* Effects that a build omits (the option `without` of meson), as bits. Their constants are 0, so
 * that nothing sets them and code guarded by a test of them is not compiled. Only the manifest of
 * records and the scene reader know all effects (GN_EVERY_EFFECT): a field that requires an omitted
 * effect has no storage, and a scene that requests one is refused. */
#ifndef GN_WITHOUT
#define GN_WITHOUT 0
#endif
#ifdef GN_EVERY_EFFECT
#define GN_BUILT_BITS -1LL
#else
#define GN_BUILT_BITS ~(GN_WITHOUT)
#endif
#define GN_BUILT(NAME) (GN_FX_##NAME != 0)

typedef enum gn_effect {
#define X(NAME, name, text) GN_FX_##NAME = (1LL << GN_FX_INDEX_##NAME) & GN_BUILT_BITS,
    GN_EFFECTS(X)
#undef X
        GN_FX_ALWAYS = 0
} gn_effect;

typedef uint64_t gn_effects; /* a set of gn_effect bits */
_Static_assert(GN_EFFECT_COUNT <= 63, "effects are bits of a long long");

/* Returns "friction", ...; index in [0, GN_EFFECT_COUNT). */
const char *gn_effect_name(gn_effect_index index);
const char *gn_effect_text(gn_effect_index index);

/* Writes the names of a set of effects to `text`, with `between` between two, and returns it. */
enum { GN_EFFECT_NAMES_SIZE = 1024 };
const char *gn_effect_names(gn_effects effects, const char *between,
                            char text[GN_EFFECT_NAMES_SIZE]);

#endif
