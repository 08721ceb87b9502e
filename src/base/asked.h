/* Optional fields of particles and bonds, which files contain only on request (`output.fields`). */
#ifndef GN_BASE_ASKED_H
#define GN_BASE_ASKED_H

#include "base/effects.h"

/* X(name of the field, effects that it requires, what a scene without these effects lacks) */
#define GN_ASKED_FIELDS(X)                                                                         \
    X(spin, GN_FX_ROTATION, "particles that rotate (law.rotation)")                                \
    X(group, 0, "")                                                                                \
    X(material, 0, "")                                                                             \
    X(skin, GN_FX_MEMBRANE, "a membrane")                                                          \
    X(total_force, 0, "")                                                                          \
    X(total_moment, GN_FX_ROTATION, "particles that rotate (law.rotation)")                        \
    X(damping_force, 0, "")                                                                        \
    X(damping_moment, GN_FX_ROTATION, "particles that rotate (law.rotation)")                      \
    X(fragment, GN_FX_BONDS, "bonds")                                                              \
    X(fragment_size, GN_FX_BONDS, "bonds")                                                         \
    X(area, GN_FX_AREA, "sections of bonds (law.stiffness dempack or polyhedron)")                 \
    X(shear_stress, GN_FX_AREA, "sections of bonds (law.stiffness dempack or polyhedron)")

#define X(name, needs, lacks) GN_ASKED_INDEX_##name,
enum { GN_ASKED_FIELDS(X) GN_ASKED_COUNT };
#undef X
#define GN_ASKED(name) (1u << GN_ASKED_INDEX_##name)

/* The fields that require one more evaluation of all contact forces. */
enum {
    GN_ASKED_LOADS = GN_ASKED(total_force) | GN_ASKED(total_moment) | GN_ASKED(damping_force) |
                     GN_ASKED(damping_moment)
};

#endif
