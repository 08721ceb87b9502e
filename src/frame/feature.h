/* A feature is a part of a model that only some scenes use. It registers functions (hooks) for
 * places of the step, so that the step does not name it; a scene that does not use it has no cost.
 * The seam between force and motion: blocks of particles and nodes that a feature holds
 * (GN_HOOK_LISTS) wait until all forces of the instant are known; it adds to their loads
 * (GN_HOOK_ACT), and they move. All other blocks move as soon as their forces are complete. */
#ifndef GN_FRAME_FEATURE_H
#define GN_FRAME_FEATURE_H

#include "frame/parts.h"

#include "base/error.h"

#include <stdbool.h>

/* Places of a step, in their order. */
typedef enum gn_hook_place {
    /* Before the lists of the step are checked: the hook may add or remove particles and elements,
       and then rebuilds the lists. */
    GN_HOOK_BEFORE_LISTS,
    /* Whenever lists were made, which may renumber particles: the hook holds the blocks that
       GN_HOOK_ACT needs (gn_hold_particle on world->dem.hold and on the hold of a body of
       elements). Also called when a feature is added to a world that has lists. */
    GN_HOOK_LISTS,
    GN_HOOK_LIMIT,           /* lists are up to date: the hook may lower the step */
    GN_HOOK_REQUEST_READING, /* the hook may set ctx.measure, so that readings are taken at the
                        instant, and ctx.sums */
    GN_HOOK_BEFORE_FORCES,
    /* Forces of contacts, walls and elements are known: the hook adds to the loads of held blocks
       (gn_hold_load). Gravity, applied forces and background damping are added in the motion.
       Velocities are those of the last half step. */
    GN_HOOK_ACT,
    GN_HOOK_WORK,  /* velocities are updated: the hook books the work of the interval before the
                      instant */
    GN_HOOK_MOVED, /* particles, walls and bodies have moved; readings of the instant were taken */
    GN_HOOK_ELEMENTS_MOVED,
    GN_HOOK_ADD_TO_READING, /* when readings are taken: the hook adds to ledger.reading and
                               ledger.stress */
    GN_HOOK_AFTER_STEP,
    GN_HOOK_PLACES
} gn_hook_place;

typedef gneiss_status gn_hook(void *context, gn_world *world, gneiss_error *error);
/* Head of a hook that needs no context. */
#define GN_HOOK(name)                                                                              \
    static gneiss_status name(__attribute__((unused)) void *context, gn_world *world,              \
                              __attribute__((unused)) gneiss_error *error)

typedef struct gn_feature {
    const char *name;
    /* Tells whether the present stage of the scene uses the feature; called whenever lists are made
     * and when a stage begins. NULL: the feature is always used, which holds for those that a
     * program adds to a world. */
    bool (*used)(const gn_world *world);
    gn_hook *hook[GN_HOOK_PLACES]; /* NULL: no hook at this place */
    void *context;                 /* passed to the hooks */
    void (*end)(void *context);    /* called when the world is freed; NULL: not needed */
} gn_feature;

/* The features of scenes, in the order in which their hooks are called at every place; those that
 * were added to a world (world/features.h) come after them. X(name): gn_feature_<name>. */
#define GN_FEATURES(X)                                                                             \
    X(loads)                                                                                       \
    X(conversion)                                                                                  \
    X(indentation)                                                                                 \
    X(bodies)                                                                                      \
    X(debris)                                                                                      \
    X(depth)                                                                                       \
    X(clumps)                                                                                      \
    X(zones)                                                                                       \
    X(gauge)                                                                                       \
    X(control)                                                                                     \
    X(membrane)                                                                                    \
    X(cutting)                                                                                     \
    X(ends)                                                                                        \
    X(box)                                                                                         \
    X(events)                                                                                      \
    X(bridges)

#define X(name) extern const gn_feature gn_feature_##name;
GN_FEATURES(X)
#undef X

#define GN_COUNT_FEATURE(name) +1
enum { GN_FEATURE_COUNT = 0 GN_FEATURES(GN_COUNT_FEATURE) };
#undef GN_COUNT_FEATURE

#endif
