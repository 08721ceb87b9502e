/* Records: particles, contacts between particles, contacts with walls, finite elements; one list
 * each. The nodes of finite elements are particles without radius; `start` is their reference
 * position.
 *
 * Particles: X(name, ctype, type, components, layout, role, needs, unless, unit, text).
 * The other lists describe a column further:
 *   Y(X, name, ctype, type, components, layout, role, care, single, needs, unless, unit, text)
 * care    GN_KEPT: the column is copied to a rebuilt list if the contact is still in it; otherwise
 *         the new list computes it or starts from zero.
 *         GN_ODD: the column changes sign when the two ends change places.
 *         GN_WRITTEN: kernels write the column, as all columns of the role GN_STATE.
 * single  The column in mixed precision. NONE: unchanged. BESIDE: name_f exists as well and is
 *         converted from it when lists are built. INSTEAD: name_f replaces it.
 * Saving and hashing follow from the role. */
#ifndef GN_SOA_RECORDS_H
#define GN_SOA_RECORDS_H

#include "soa/field.h"

/* Fields ending in _f are the working set of mixed precision: the particle data that contact and
 * element kernels read (displacement since the lists were built, for nodes since the start, so that
 * single precision resolves it) and their columns. */
#define GN_PARTICLE_FIELDS(X)                                                                      \
    X(pos, double, GN_F64, 4, GN_ROWS, GN_STATE, 0, 0, "m", "centre x y z, radius")                \
    X(vel, double, GN_F64, 4, GN_ROWS, GN_STATE, 0, 0, "m/s, 1/kg",                                \
      "velocity at the last half step, inverse mass (0: removed)")                                 \
    X(spin, double, GN_F64, 4, GN_ROWS, GN_STATE, GN_FX_ROTATION, 0, "rad/s, 1/(kg m2)",           \
      "angular velocity at the last half step, inverse moment of inertia")                         \
    X(orientation, double, GN_F64, 4, GN_ROWS, GN_STATE, GN_FX_ORIENTATION, 0, "1",                \
      "quaternion w x y z from the start")                                                         \
    X(applied, double, GN_F64, 4, GN_ROWS, GN_SAVED, GN_FX_APPLIED, 0, "N", "applied force")       \
    X(load, double, GN_F64, 4, GN_ROWS, GN_SAVED, GN_FX_MEMBRANE, 0, "N",                          \
      "applied force without that of the membrane")                                                \
    X(skin, double, GN_F64, 4, GN_ROWS, GN_SAVED, GN_FX_MEMBRANE, 0, "m2, m2",                     \
      "area of the membrane on the particle, without the rigid motion of the skin; its size, "     \
      "negative: detached")                                                                        \
    X(start, double, GN_F64, 4, GN_ROWS, GN_SAVED, 0, 0, "m", "centre at the start")               \
    X(ref, double, GN_F64, 4, GN_ROWS, GN_SAVED, 0, 0, "m", "centre when the pair list was built") \
    X(own_share, double, GN_F64, 1, GN_ROWS, GN_SAVED, GN_FX_MASS_SCALING, 0, "1",                 \
      "true mass over mass; the rest was added for a longer step")                                 \
    X(id, int32_t, GN_I32, 1, GN_ROWS, GN_STATE, 0, 0, "1", "place in the specimen, base 0")       \
    X(material, int32_t, GN_I32, 1, GN_ROWS, GN_SAVED, 0, 0, "1", "material, base 0")              \
    X(group, int32_t, GN_I32, 1, GN_ROWS, GN_SAVED, 0, 0, "1", "cohesive group, 0: none")          \
    X(bonds0, int32_t, GN_I32, 1, GN_ROWS, GN_SAVED, GN_FX_BONDS, 0, "1", "bonds at the start")    \
    X(slot, int32_t, GN_I32, 1, GN_ROWS, GN_SAVED, GN_FX_PRESCRIBED, 0, "1",                       \
      "place in the list of prescribed particles, -1: none")                                       \
    X(marks, int32_t, GN_I32, 2, GN_ROWS, GN_SAVED, 0, 0, "1",                                     \
      "hashes of its active and its near contacts at the last check of the step")                  \
    X(pressed, double, GN_F64, 1, GN_ROWS, GN_SAVED, GN_FX_HERTZ, 0, "1",                          \
      "largest overlap expected of its contacts, over the radius of the contact")                  \
    X(film, double, GN_F64, 1, GN_ROWS, GN_STATE, GN_FX_COHESION, 0, "m3",                         \
      "volume of the liquid film on the particle")                                                 \
    X(travel_f, float, GN_F32, 4, GN_ROWS, GN_SCRATCH, GN_FX_MIXED, 0, "m",                        \
      "centre minus ref (nodes: start) x y z, radius")                                             \
    X(vel_f, float, GN_F32, 4, GN_ROWS, GN_SCRATCH, GN_FX_MIXED, 0, "m/s, 1/kg",                   \
      "velocity x y z, inverse mass")                                                              \
    X(spin_f, float, GN_F32, 4, GN_ROWS, GN_SCRATCH, GN_FX_MIXED | GN_FX_ROTATION, 0, "rad/s",     \
      "angular velocity x y z, 0")                                                                 \
    X(placed_p, double, GN_F64, 4, GN_ROWS, GN_SAVED, GN_FX_PRESSURE, 0, "m, Pa",                  \
      "centre x y z, stabilising pressure; during a step the pressure")                            \
    X(smooth, double, GN_F64, 4, GN_ROWS, GN_STATE, GN_FX_PRESSURE, 0, "Pa/m, Pa",                 \
      "projected gradient x y z of the stabilising pressure, that pressure")                       \
    X(smooth_rate, double, GN_F64, 4, GN_ROWS, GN_STATE, GN_FX_PRESSURE, 0, "Pa/(m s), Pa/s",      \
      "rates of the projected gradient and of that pressure at the last half step")                \
    X(lumped, double, GN_F64, 4, GN_ROWS, GN_SAVED, GN_FX_PRESSURE, 0, "Pa/m3, Pa/m5, m3, m3/s",   \
      "inverse lumped masses of pressure and projection, stabilising term, its past rate")         \
    X(mean_rate, double, GN_F64, 1, GN_ROWS, GN_SAVED, GN_FX_PRESSURE, 0, "Pa/s",                  \
      "mean rate of the stabilising pressure at the last instant")                                 \
    X(blend, double, GN_F64, 2, GN_ROWS, GN_SAVED, GN_FX_OVERLAP, 0, "1, 1",                       \
      "weight of its forces in a coupling zone; weight of its mass")                               \
    X(clump, int32_t, GN_I32, 1, GN_ROWS, GN_SAVED, GN_FX_CLUMPS, 0, "1", "clump, -1: none")

/* Y expands to the column itself and to its single precision form. Both end in X(name, ctype, type,
 * components, layout, role, care, needs, unless, unit, text, single_of), with `soa` for a column
 * that is not the single precision form of another. */
#define GN_COLUMN(X, name, ctype, type, components, layout, role, care, single, needs, unless,     \
                  unit, text)                                                                      \
    X(name, ctype, type, components, layout, role, care, needs, GN_UNLESS_##single(unless), unit,  \
      text, soa)
#define GN_UNLESS_NONE(unless)    unless
#define GN_UNLESS_BESIDE(unless)  unless
#define GN_UNLESS_INSTEAD(unless) (unless) | GN_FX_MIXED /* must be the only condition */

#define GN_SINGLE(X, name, ctype, type, components, layout, role, care, single, needs, unless,     \
                  unit, text)                                                                      \
    GN_SINGLE_##single(X, name, components, layout, role, care, needs, unless, unit, text)
#define GN_SINGLE_NONE(X, name, components, layout, role, care, needs, unless, unit, text)
#define GN_SINGLE_BESIDE(X, name, components, layout, role, care, needs, unless, unit, text)       \
    X(name##_f, float, GN_F32, components, layout, GN_SCRATCH, 0, (needs) | GN_FX_MIXED, unless,   \
      unit, "as " #name, name)
#define GN_SINGLE_INSTEAD(X, name, components, layout, role, care, needs, unless, unit, text)      \
    X(name##_f, float, GN_F32, components, layout, role, care, (needs) | GN_FX_MIXED, unless,      \
      unit, text, name)

/* Contacts between particles, sorted by (i, j), i < j. The normal points from i to j. Bonds and
 * unbonded pairs are two records of this kind; pairs are created with GN_FX_BONDS cleared. */
#define GN_CONTACT_COLUMNS(Y, X)                                                                   \
    Y(X, i, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1", "first particle")        \
    Y(X, j, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1", "second particle")       \
    Y(X, kn, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, 0, 0, "N/m",                \
      "normal stiffness")                                                                          \
    Y(X, kt, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_SHEAR, 0, "N/m",      \
      "tangential stiffness")                                                                      \
    Y(X, mu, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_FRICTION, 0, "1",     \
      "friction coefficient")                                                                      \
    Y(X, cn, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_CONTACT_DAMPING, 0,   \
      "N s/m", "normal viscous coefficient")                                                       \
    Y(X, length0, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, BESIDE, GN_FX_BONDS, 0, "m",   \
      "distance of the centres at which the normal force is zero")                                 \
    Y(X, rn, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, BESIDE, GN_FX_BONDS, 0, "N",        \
      "tensile strength; negative once broken")                                                    \
    Y(X, rt, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, BESIDE, GN_FX_BONDS | GN_FX_SHEAR,  \
      0, "N", "shear strength")                                                                    \
    Y(X, mu1, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_MOHR, 0, "1",        \
      "friction coefficient of the intact bond")                                                   \
    Y(X, section, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE,                          \
      GN_FX_BONDS | GN_FX_CONFINED, 0, "m2", "section to which the strengths of the bond refer")   \
    Y(X, confined, double, GN_F64, 1, GN_COLUMNS, GN_SCRATCH, 0, INSTEAD,                          \
      GN_FX_BONDS | GN_FX_CONFINED, 0, "N", "mean pressure around the bond times its section")     \
    Y(X, soft, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, BESIDE, GN_FX_SOFTENING, 0, "1",  \
      "remaining fraction of the bond's stiffness in tension")                                     \
    Y(X, kappa, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_SOFTENING, 0, "1",   \
      "damage of the bond in shear")                                                               \
    Y(X, fade, double, GN_F64, 9, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_SOFTENING, 0,         \
      "N/m, m, N, m, 1", "softening parameters, see law_softening.h")                              \
    Y(X, plastic, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD, GN_FX_YIELD, 0, "m",  \
      "permanent stretch, at which the normal force is zero")                                      \
    Y(X, yields, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD, GN_FX_YIELD, 0, "N",   \
      "current yield force in compression")                                                        \
    Y(X, crush, double, GN_F64, 6, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_YIELD, 0, "N, 1",  \
      "yield parameters, see law_softening.h")                                                     \
    Y(X, shear, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT | GN_ODD, INSTEAD, GN_FX_SHEAR,   \
      0, "N", "tangential force on the first particle")                                            \
    Y(X, beam, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_BOND_MOMENTS, 0,    \
      "m", "effective radius of the section for moments")                                          \
    Y(X, share, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_BOND_MOMENTS, 0,   \
      "1", "fraction of moments in the strength criterion")                                        \
    Y(X, moment, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT | GN_ODD, INSTEAD,               \
      GN_FX_BOND_MOMENTS | GN_FX_ROTATION, 0, "N m",                                               \
      "moment on the first particle besides that of the tangential force; 2D: its third "          \
      "component")                                                                                 \
    Y(X, fd, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT | GN_WRITTEN, INSTEAD,               \
      GN_FX_CONTACT_DAMPING | GN_FX_ENERGY, 0, "N", "viscous normal force of the last step")       \
    Y(X, lag, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE,                            \
      GN_FX_HERTZ | GN_FX_CONTACT_DAMPING, 0, "(m/N)^1/2",                                         \
      "time lag of the velocity for the dashpot, see law_hertz.h")                                 \
    Y(X, closeness, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD,                     \
      GN_FX_HERTZ | GN_FX_SHEAR, 0, "m^-1/2",                                                      \
      "inverse square root of the overlap in the last step; 0: open")                              \
    Y(X, reduced, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_ROLLING, 0, "m", \
      "reduced radius")                                                                            \
    Y(X, rolling, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_ROLLING, 0, "m", \
      "rolling resistance: largest moment over the compressive force")                             \
    Y(X, twisting, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_ROLLING, 0,     \
      "m", "twisting resistance: largest moment over the compressive force")                       \
    Y(X, roll, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT | GN_ODD, INSTEAD, GN_FX_ROLLING,  \
      0, "N m", "rolling and twisting resistance: moment on the first particle")                   \
    Y(X, most, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_HERTZ, 0, "m",      \
      "overlap up to which the step was checked; 0: not yet")                                      \
    Y(X, adhesion, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_COHESION, 0, "N", \
      "largest attraction of the two particles")                                                   \
    Y(X, span, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_COHESION, 0, "m",     \
      "length of the attraction, see law_cohesive.h")                                              \
    Y(X, bridge, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_COHESION, 0, "m3",  \
      "volume of the liquid bridge; without liquid 1 while the particles adhere; 0: none")         \
    Y(X, onset, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_COHESION, 0, "1",    \
      "state of a bridge that forms or ruptures, see law_cohesive.h")                              \
    Y(X, cause, uint8_t, GN_U8, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_BONDS, 0, "1",       \
      "0 intact, 1 broken in tension, 2 broken in shear, 3 removed with a particle")               \
    Y(X, broken_time, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_BONDS, 0, "s", \
      "time at which the bond broke or was removed; 0 while it is intact")                         \
    Y(X, area, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_BONDS | GN_FX_AREA,   \
      0, "m2", "section of the bond: 3D, in 2D width times 1 m")                                   \
    Y(X, plane, double, GN_F64, 3, GN_COLUMNS, GN_SAVED, GN_KEPT | GN_ODD, BESIDE, GN_FX_JOINTS,   \
      0, "1", "normal of the joint, from the side of the first particle to the other")             \
    Y(X, dilation, double, GN_F64, 2, GN_COLUMNS, GN_SAVED, GN_KEPT, BESIDE, GN_FX_JOINTS, 0,      \
      "1, m", "tangent of the dilation angle; slip at which the dilation ends")                    \
    Y(X, apart, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD, GN_FX_JOINTS, 0, "m",   \
      "gap of the joint along its normal, less the dilation")                                      \
    Y(X, slip, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, INSTEAD, GN_FX_JOINTS, 0, "m",    \
      "path of sliding along the joint")                                                           \
    Y(X, joint, int32_t, GN_I32, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_JOINTS, 0, "1",     \
      "face of a joint that the contact crosses, base 0")                                          \
    Y(X, patch, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE, GN_FX_JOINTS, 0, "m2",     \
      "area of the joint that the contact stands for")                                             \
    Y(X, looked, float, GN_F32, 3, GN_COLUMNS, GN_SAVED, GN_KEPT | GN_ODD, NONE, 0, 0, "1",        \
      "normal at the last check of the step; 0: not yet")

/* Work columns of contacts, which lists and kernels fill. */
#define GN_CONTACT_WORK(Y, X)                                                                      \
    Y(X, branch_f, float, GN_F32, 3, GN_COLUMNS, GN_SCRATCH, 0, NONE, GN_FX_MIXED, 0, "m",         \
      "vector from i to j when the lists were built")                                              \
    Y(X, stretch_f, float, GN_F32, 1, GN_COLUMNS, GN_SCRATCH, 0, NONE, GN_FX_MIXED, 0, "m",        \
      "distance minus that of zero force when the lists were built")                               \
    Y(X, happened, uint8_t, GN_U8, 1, GN_COLUMNS, GN_SCRATCH, 0, NONE, GN_FX_BONDS | GN_FX_EVENTS, \
      0, "1", "events of the bond in this step, see gn_happening")                                 \
    Y(X, released, double, GN_F64, 1, GN_COLUMNS, GN_SCRATCH, 0, NONE,                             \
      GN_FX_BONDS | GN_FX_EVENTS | GN_FX_ENERGY, 0, "J", "energy released by its failure")         \
    Y(X, row4, double, GN_F64, 4, GN_ROWS, GN_SCRATCH, 0, NONE, GN_FX_CONTACT_FORCES,              \
      GN_FX_SPACE | GN_FX_ROTATION, "N, N",                                                        \
      "force on the first particle x y z 0; 2D: x y, moment z, 0")                                 \
    Y(X, row8, double, GN_F64, 8, GN_ROWS, GN_SCRATCH, 0, NONE,                                    \
      GN_FX_CONTACT_FORCES | GN_FX_SPACE | GN_FX_ROTATION, 0, "N, N",                              \
      "force on the first particle x y z 0, n x F_t x y z 0")

/* Contacts of particles with plane walls and with facets of surfaces, sorted by (i, wall). The
 * normal points from the particle to the wall. A particle's facets of one surface are processed
 * together. */
#define GN_WALL_CONTACT_COLUMNS(Y, X)                                                              \
    Y(X, i, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1", "particle")              \
    Y(X, wall, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1",                       \
      "wall, base 0; from the number of walls on: facet, numbered over all surfaces")              \
    Y(X, gap0, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, 0, 0, "m",                  \
      "gap at which the normal force is zero; negative for passive walls")                         \
    Y(X, shear, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_WALL_SHEAR, 0, "N",  \
      "tangential force on the particle")                                                          \
    Y(X, fd, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, GN_KEPT, NONE,                               \
      GN_FX_CONTACT_DAMPING | GN_FX_ENERGY, 0, "N", "viscous normal force of the last step")       \
    Y(X, closeness, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE,                        \
      GN_FX_HERTZ | GN_FX_WALL_SHEAR, 0, "m^-1/2",                                                 \
      "inverse square root of the overlap in the last step; 0: open")                              \
    Y(X, roll, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_ROLLING, 0, "N m",    \
      "rolling and twisting resistance: moment on the particle")                                   \
    Y(X, bridge, double, GN_F64, 1, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_COHESION, 0, "m3",  \
      "volume of the liquid bridge; without liquid 1 while both adhere; 0: none")                  \
    Y(X, normal, double, GN_F64, 3, GN_COLUMNS, GN_STATE, GN_KEPT, NONE, GN_FX_FACETS, 0, "1",     \
      "normal of a facet contact in the last step times its fraction of the stiffness; 0: none")   \
    Y(X, touch, double, GN_F64, 3, GN_COLUMNS, GN_SAVED, 0, NONE, GN_FX_FACETS, 0, "m",            \
      "point of a facet on which the force acts")                                                  \
    Y(X, row, double, GN_F64, 8, GN_ROWS, GN_SAVED, 0, NONE, 0, 0, "N, N m",                       \
      "force on the particle x y z, 0, moment x y z, 0")

/* Linear finite elements, sorted by their nodes: tetrahedra, or triangles in plane strain (1 m
 * thick). N_a is the shape function of node a; gradients are stored for all nodes but the first,
 * whose gradient is minus their sum. */
#define GN_ELEMENT_COLUMNS(Y, X)                                                                   \
    Y(X, node, int32_t, GN_I32, 3, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1", "nodes 0 1 2")        \
    Y(X, node3, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, GN_FX_SPACE, 0, "1", "node 3")  \
    Y(X, gradient2, double, GN_F64, 4, GN_COLUMNS, GN_SAVED, 0, BESIDE, 0, GN_FX_SPACE, "1/m",     \
      "dN/dX of nodes 1 2 at the start: 1x 1y 2x 2y")                                              \
    Y(X, gradient3, double, GN_F64, 9, GN_COLUMNS, GN_SAVED, 0, BESIDE, GN_FX_SPACE, 0, "1/m",     \
      "dN/dX of nodes 1 2 3 at the start: 1x 1y 1z 2x ...")                                        \
    Y(X, volume, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, 0, BESIDE, 0, 0, "m3",                   \
      "volume at the start")                                                                       \
    Y(X, lambda, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, 0, BESIDE, 0, 0, "Pa",                   \
      "first Lame constant")                                                                       \
    Y(X, mu, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, 0, BESIDE, 0, 0, "Pa", "shear modulus")      \
    Y(X, tau, double, GN_F64, 1, GN_COLUMNS, GN_SAVED, 0, NONE, GN_FX_PRESSURE, 0, "m2/Pa",        \
      "weight of the stabilising term")                                                            \
    Y(X, material, int32_t, GN_I32, 1, GN_COLUMNS, GN_SAVED, 0, NONE, 0, 0, "1",                   \
      "material, base 0")                                                                          \
    Y(X, id, int32_t, GN_I32, 1, GN_COLUMNS, GN_STATE, 0, NONE, 0, 0, "1",                         \
      "place in the mesh, base 0")

/* Additional columns, appended by code that compiles all users of a record by value; kernels take
 * pointers and do not depend on them (tests/more_columns.h). */
#ifndef GN_MORE_CONTACT_COLUMNS
#define GN_MORE_CONTACT_COLUMNS(Y, X)
#define GN_MORE_WALL_CONTACT_COLUMNS(Y, X)
#endif

#define GN_CONTACT_FIELDS(X)                                                                       \
    GN_CONTACT_COLUMNS(GN_COLUMN, X)                                                               \
    GN_CONTACT_COLUMNS(GN_SINGLE, X)                                                               \
    GN_CONTACT_WORK(GN_COLUMN, X)                                                                  \
    GN_MORE_CONTACT_COLUMNS(GN_COLUMN, X) GN_MORE_CONTACT_COLUMNS(GN_SINGLE, X)
#define GN_WALL_CONTACT_FIELDS(X)                                                                  \
    GN_WALL_CONTACT_COLUMNS(GN_COLUMN, X) GN_MORE_WALL_CONTACT_COLUMNS(GN_COLUMN, X)
#define GN_ELEMENT_FIELDS(X) GN_ELEMENT_COLUMNS(GN_COLUMN, X) GN_ELEMENT_COLUMNS(GN_SINGLE, X)

#define GN_DECLARE_POINTER(name, ctype, ...) ctype *name;

typedef struct gn_particles {
    gn_soa soa;
    GN_PARTICLE_FIELDS(GN_DECLARE_POINTER)
} gn_particles;

typedef struct gn_contacts {
    gn_soa soa;
    GN_CONTACT_FIELDS(GN_DECLARE_POINTER)
} gn_contacts;

typedef struct gn_wall_contacts {
    gn_soa soa;
    GN_WALL_CONTACT_FIELDS(GN_DECLARE_POINTER)
} gn_wall_contacts;

typedef struct gn_elements {
    gn_soa soa;
    GN_ELEMENT_FIELDS(GN_DECLARE_POINTER)
} gn_elements;

#undef GN_DECLARE_POINTER

/* The reason why a bond does not hold. GN_BOND_LEFT: it was intact until its particle was
 * removed. */
typedef enum gn_cause {
    GN_INTACT = 0,
    GN_BROKEN_TENSION = 1,
    GN_BROKEN_SHEAR = 2,
    GN_BOND_LEFT = 3
} gn_cause;
/* Bits of events that happen to a bond for the first time. */
typedef enum gn_happening {
    GN_HAPPENED_BREAK = 1,
    GN_HAPPENED_SOFTENING = 2,
    GN_HAPPENED_YIELD = 4
} gn_happening;
static inline bool gn_broken(uint8_t cause) {
    return cause == GN_BROKEN_TENSION || cause == GN_BROKEN_SHEAR;
}

extern const gn_record gn_particle_record;
extern const gn_record gn_contact_record;
extern const gn_record gn_wall_contact_record;
extern const gn_record gn_element_record;

/* Returns the doubles in a row of forces: 8 with rotation in space, else 4. Rows of gn_partials
 * have the same width. */
static inline int gn_row_width(bool space, bool rotation) {
    return space && rotation ? 8 : 4;
}

/* Returns the rows written by the contact kernel, whichever width is active; NULL if they are not
 * stored. */
static inline double *gn_contacts_row(const gn_contacts *contacts) {
    return contacts->row8 ? contacts->row8 : contacts->row4;
}
static inline int gn_contacts_row_width(const gn_contacts *contacts) {
    return gn_row_width(contacts->soa.effects & GN_FX_SPACE,
                        contacts->soa.effects & GN_FX_ROTATION);
}

/* Tells whether contact c is an intact bond. */
static inline bool gn_contact_bonded(const gn_contacts *contacts, size_t c) {
    return contacts->cause && contacts->cause[c] == GN_INTACT;
}

/* Tells whether contact c carries force. In 2D the third entry of a row is not a force. */
static inline bool gn_contact_carries(const gn_contacts *contacts, size_t c) {
    const double *row = gn_contacts_row(contacts) + (size_t)gn_contacts_row_width(contacts) * c;
    bool space = contacts->soa.effects & GN_FX_SPACE;
    return row[0] != 0.0 || row[1] != 0.0 || (space && row[2] != 0.0);
}

/* Padding contacts refer to two null particles behind the last one, which are separated, at rest
 * and without radius. */
static inline int32_t gn_null_first(const gn_particles *p) {
    return (int32_t)p->soa.count;
}
static inline int32_t gn_null_second(const gn_particles *p) {
    return (int32_t)p->soa.count + 1;
}

/* Sets the distance of the null particles (below half of any periodic length). */
void gn_particles_set_null(gn_particles *particles, double distance);

/* Makes the padding of a contact list refer to the null particles. */
void gn_contacts_pad(gn_contacts *contacts, const gn_particles *particles);

static inline int gn_elements_dimension(const gn_elements *elements) {
    return elements->soa.effects & GN_FX_SPACE ? 3 : 2;
}

/* Returns the column of node a of all elements. */
static inline int32_t *gn_elements_node(const gn_elements *elements, int a) {
    return a == 3 ? elements->node3 : elements->node + (size_t)a * elements->soa.capacity;
}

/* Returns the column of dN_a/dX_k, a > 0. */
static inline double *gn_elements_gradient(const gn_elements *elements, int a, int k) {
    int dimension = gn_elements_dimension(elements);
    double *first = dimension == 3 ? elements->gradient3 : elements->gradient2;
    return first + (size_t)(dimension * (a - 1) + k) * elements->soa.capacity;
}

/* Makes the padding of elements refer to a null node (zero volume and no force). */
void gn_elements_pad(gn_elements *elements, const gn_particles *nodes);

#endif
